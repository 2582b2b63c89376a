//! Pictures: pure functions from plain data to the bytes of PNG files.
//!
//! Same data, same bytes: no files, no clock, no system fonts. Knows neither scenes nor readings;
//! data, units and words come from the caller. No other module uses plotters, png or colorous.

mod axis;
mod bar_chart;
mod canvas;
mod colour_bar;
mod cross_section;
mod geometry;
mod heat_map;
mod layout;
mod line_plot;
mod marked_axis;
mod palette;
mod polar_plot;
mod scatter_matrix;
mod text;
mod true_colour;

pub(crate) use axis::AxisScale;
pub(crate) use bar_chart::Bar;
pub(crate) use bar_chart::{BarChart, bar_chart};
pub(crate) use colour_bar::BarScale;
pub(crate) use cross_section::{
    CrossSection, NamedPlace, PlaceOf, RayEnd, RayPath, SurfaceDots, cross_section,
};
pub(crate) use heat_map::{
    HeatMap, MapCells, MapColours, MapFrame, MapGeometry, MapPlaces, heat_map, true_colour_map,
};
pub(crate) use line_plot::{
    ErrorForm, LinePlot, Look, PlotSeries, SeriesForm, SeriesPoint, line_plot, stacked_plots,
};
pub(crate) use line_plot::{ink, line_axes};
pub(crate) use marked_axis::MarkedAxis;
pub(crate) use palette::ColourMap;
pub(crate) use palette::{SeriesInk, curve_colours, series_ink};
pub(crate) use polar_plot::dial_axis;
pub(crate) use polar_plot::{PolarCurve, PolarPlot, polar_plot};
pub(crate) use scatter_matrix::{ScatterColumn, ScatterMatrix, scatter_matrix};
pub(crate) use true_colour::on_screen;

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;

    /// A picture that was read back from its file.
    pub(crate) struct Decoded {
        pub(crate) width: usize,
        pub(crate) height: usize,
        pixels: Vec<u8>,
    }

    impl Decoded {
        pub(crate) fn new(file: &[u8]) -> Self {
            let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
            let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
            let info = reader.next_frame(&mut pixels).unwrap();
            assert_eq!(
                (info.color_type, info.bit_depth),
                (png::ColorType::Rgb, png::BitDepth::Eight)
            );
            Self { width: info.width as usize, height: info.height as usize, pixels }
        }

        pub(crate) fn at(&self, column: usize, row: usize) -> [u8; 3] {
            let start = 3 * (row * self.width + column);
            [self.pixels[start], self.pixels[start + 1], self.pixels[start + 2]]
        }

        /// All places of a colour, (column, row).
        pub(crate) fn places(&self, colour: [u8; 3]) -> Vec<(usize, usize)> {
            (0..self.height)
                .flat_map(|row| (0..self.width).map(move |column| (column, row)))
                .filter(|&(column, row)| self.at(column, row) == colour)
                .collect()
        }

        /// Left, top, right (excluded) and bottom (excluded) of all places of a colour.
        pub(crate) fn bounds(&self, colour: [u8; 3]) -> [usize; 4] {
            let places = self.places(colour);
            let columns = || places.iter().map(|place| place.0);
            let rows = || places.iter().map(|place| place.1);
            [
                columns().min().unwrap(),
                rows().min().unwrap(),
                columns().max().unwrap() + 1,
                rows().max().unwrap() + 1,
            ]
        }

        /// Whether the margins are white.
        fn has_white_margins(&self) -> bool {
            let edge = |column: usize, row: usize| {
                column < 8 || row < 8 || column + 8 >= self.width || row + 8 >= self.height
            };
            (0..self.height)
                .flat_map(|row| (0..self.width).map(move |column| (column, row)))
                .filter(|&(column, row)| edge(column, row))
                .all(|(column, row)| self.at(column, row) == [255, 255, 255])
        }
    }

    const AWKWARD: [f64; 12] = [
        0.0,
        1.0,
        -1.0,
        1e-9,
        1e9,
        1e9 + 1.0,
        1e-320,
        f64::MAX,
        f64::MIN,
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
    ];

    fn text(words: &str) -> String {
        words.to_string()
    }

    fn map(one: f64, other: f64) -> HeatMap {
        let values = Array2::from_shape_vec((1, 2), vec![one, other]).unwrap();
        HeatMap::sample([one, other], [0.0, one], values)
    }

    fn polar(one: f64, other: f64) -> PolarPlot {
        let points = vec![(-10.0, one), (0.0, other), (one, other), (95.0, one)];
        let std_errors = vec![other; 4];
        PolarPlot {
            title: text("Luminous intensity"),
            subtitle: text("sensor far"),
            unit: text("cd"),
            curves: vec![PolarCurve { name: text("C0 / C180"), points, std_errors }],
        }
    }

    fn lines(one: f64, other: f64, scale: AxisScale) -> LinePlot {
        let point = |x: f64, y: f64| SeriesPoint { x, y, std_error: other };
        let series = |form: SeriesForm, errors: ErrorForm| {
            let points = vec![point(one, other), point(other, one), point(1.0, one)];
            PlotSeries::new("section", points, form, errors)
        };
        LinePlot {
            title: text("Sections"),
            subtitle: text("sensor exit"),
            x_label: text("x in mm"),
            y_label: text("illuminance in lx"),
            scale,
            series: vec![
                series(SeriesForm::Line, ErrorForm::Bars),
                series(SeriesForm::Steps, ErrorForm::Band),
                series(SeriesForm::Dots, ErrorForm::Bars),
            ],
        }
    }

    fn bars(one: f64, other: f64) -> BarChart {
        let bar = |name: &str, value: f64| Bar {
            name: name.repeat(20),
            value,
            std_error: Some(other),
            colour: 1,
        };
        BarChart {
            title: text("Flux balance"),
            subtitle: text("source flux 1 lm"),
            unit: text("lm"),
            whole: Some(other),
            bars: vec![bar("absorbed ", one), bar("face_", other)],
        }
    }

    fn section(one: f64, other: f64) -> CrossSection {
        let points = vec![[0.0, 0.0], [one, other], [other, one]];
        CrossSection {
            title: text("Pipe"),
            subtitle: text("plane y = 0"),
            x_label: text("x in mm"),
            y_label: text("z in mm"),
            x_range: [one, other],
            y_range: [-1.0, one],
            outlines: vec![SurfaceDots { name: text("pipe"), colour: 0, points: points.clone() }],
            rays: vec![RayPath { points, end: RayEnd::Escaped }],
            places: vec![NamedPlace { name: text("led"), at: [one, other], of: PlaceOf::Source }],
        }
    }

    /// A picture of each kind with `one` and `other` in place of every number.
    fn pictures(one: f64, other: f64, scale: AxisScale) -> [Vec<u8>; 5] {
        [
            heat_map(&map(one, other)),
            polar_plot(&polar(one, other)),
            line_plot(&lines(one, other, scale)),
            bar_chart(&bars(one, other)),
            cross_section(&section(one, other)),
        ]
        .map(|file| file.unwrap())
    }

    #[test]
    fn pictures_of_nothing_are_still_pictures() {
        let values = Array2::zeros((0, 0));
        let files = [
            heat_map(&HeatMap::sample([1.0, 2.0], [0.0, 1.0], values)),
            polar_plot(&PolarPlot { curves: Vec::new(), ..polar(1.0, 2.0) }),
            line_plot(&LinePlot { series: Vec::new(), ..lines(1.0, 2.0, AxisScale::Log) }),
            bar_chart(&BarChart { bars: Vec::new(), ..bars(1.0, 2.0) }),
            cross_section(&CrossSection {
                outlines: Vec::new(),
                rays: vec![RayPath { points: Vec::new(), end: RayEnd::Lost }],
                ..section(1.0, 2.0)
            }),
        ];
        for file in files {
            assert!(Decoded::new(&file.unwrap()).has_white_margins());
        }
    }

    #[test]
    fn awkward_numbers_still_give_pictures_with_white_margins() {
        for (index, one) in AWKWARD.into_iter().enumerate() {
            let other = AWKWARD[(5 * index + 3) % AWKWARD.len()];
            let scale = if index % 2 == 0 { AxisScale::Linear } else { AxisScale::Log };
            for (kind, file) in pictures(one, other, scale).iter().enumerate() {
                let picture = Decoded::new(file);
                assert!((600..=950).contains(&picture.width), "{kind}: {one} {other}");
                assert!((90..=900).contains(&picture.height), "{kind}: {one} {other}");
                assert!(picture.has_white_margins(), "{kind}: {one} {other}");
            }
        }
    }

    #[test]
    fn other_data_give_another_picture_of_every_kind() {
        let files = pictures(1.0, 2.5, AxisScale::Linear);
        for (file, changed) in files.iter().zip(pictures(1.0, 2.75, AxisScale::Linear)) {
            assert_ne!(*file, changed);
        }
    }
}
