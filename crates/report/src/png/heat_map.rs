//! False-colour maps: a value per cell of a rectangle.

use crate::png::axis::{AxisScale, PlotAxis};
use crate::png::canvas::Canvas;
use crate::png::colour_bar::{BAR_WIDTH, BarScale, ColourBar, Colouring, TIP};
use crate::png::geometry::Rect;
use crate::png::layout::{
    Aspect, Header, MARGIN, PlotAxes, PlotSize, SQUEEZED_REMARK, plot_size, remark,
};
use crate::png::marked_axis::MarkedAxis;
use crate::png::palette::{ColourMap, NEUTRAL, Rgb};
use crate::png::text::TICK;
use crate::png::true_colour::on_screen;
use glam::DVec3;
use lumiduct_base::error::Result;
use lumiduct_base::number::format_value;
use ndarray::Array2;
use serde::Serialize;

/// A value per cell of a rectangle.
#[derive(Debug, Clone)]
pub(crate) struct HeatMap {
    /// What is shown.
    pub title: String,
    /// How it was found; may be empty.
    pub subtitle: String,
    /// What is mapped, such as `illuminance`.
    pub quantity: String,
    /// Unit of the values; may be empty.
    pub unit: String,
    /// What the places are called.
    pub places: MapPlaces,
    /// The cells.
    pub cells: MapCells,
    /// How fractions become colours.
    pub colours: ColourMap,
    /// Values at the ends of the colour bar; `None` takes them from the data.
    pub limits: Option<[f64; 2]>,
}

/// The coordinates of a map, across and up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MapPlaces {
    /// How places are drawn.
    pub geometry: MapGeometry,
    /// Names and units of the axes: "x in mm".
    pub labels: [&'static str; 2],
    /// Names of both coordinates of a cell.
    pub names: [&'static str; 2],
    /// Their units.
    pub units: [&'static str; 2],
}

/// How the places of a map are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum MapGeometry {
    /// As they are.
    Cartesian,
    /// By the tangents of their angles.
    Angular,
    /// Rings and sectors on a disk.
    Polar,
    /// Angles as they are.
    Directions,
}

/// The cells of a map, `[[row, column]]`: row 0 is drawn at the bottom, column 0 at the left.
#[derive(Debug, Clone)]
pub(crate) struct MapCells {
    /// Edges of the columns.
    pub x: Vec<f64>,
    /// Edges of the rows.
    pub y: Vec<f64>,
    /// Values; non-finite where there is none, which is drawn grey.
    pub values: Array2<f64>,
    /// Standard errors.
    pub errors: Array2<f64>,
    /// Bias indicators, where a bias is possible.
    pub biases: Option<Array2<f64>>,
    /// Colours, where light has some.
    pub colours: Option<MapColours>,
}

/// The colours of the cells of a map.
#[derive(Debug, Clone)]
pub(crate) struct MapColours {
    /// Tristimulus values X, Y, Z; Y is the value of the cell.
    pub stimuli: Array2<DVec3>,
    /// Standard errors of u' and v'; `None` for joined cells.
    pub uv_errors: Option<[Array2<f64>; 2]>,
}

/// Largest size of the map itself, pixels.
const MOST: [f64; 2] = [640.0, 600.0];
/// Maps of a greater aspect ratio are squeezed.
const LONGEST: f64 = 4.0;
/// Space between the map and the colour bar, pixels.
const BAR_GAP: f64 = 26.0;

/// Draws a map with axes, colour bar and a line with the least and greatest of its cells.
///
/// A linear bar ends at zero where the values come near it. Up to one cell in a thousand that
/// exceeds the others tenfold does not stretch the bar, which then has a tip. A logarithmic bar
/// spans at most six decades.
pub(crate) fn heat_map(map: &HeatMap) -> Result<Vec<u8>> {
    let size = size_of(map);
    let values = finite(&map.cells.values);
    let bar = ColourBar::new(bar_scale(map, &values, AxisScale::Linear, size))?;
    let colours = map.cells.values.mapv(|value| bar.colour_of(value));
    picture(map, &colours, Some(&bar))
}

/// Draws a map as a screen can show these colours, without a bar.
pub(crate) fn true_colour_map(map: &HeatMap, colours: &MapColours) -> Result<Vec<u8>> {
    picture(map, &on_screen(&colours.stimuli), None)
}

fn picture(map: &HeatMap, colours: &Array2<Rgb>, bar: Option<&ColourBar>) -> Result<Vec<u8>> {
    let size = size_of(map);
    let (axes, _) = map_axes(map);
    let frame = PlotAxes::new(axes, [size.width, size.height])?;
    let values = finite(&map.cells.values);

    let left = MARGIN + frame.left_margin();
    let beside = bar.map_or(0.0, |bar| BAR_GAP + bar.width());
    let content = left + size.width + beside + MARGIN;
    let width = content.max(620.0).ceil();
    let left = (left + 0.5 * (width - content)).round();
    let header = Header::new(&map.title, &map.subtitle, width - 2.0 * MARGIN)?;
    let above = TICK.line_step() + TIP + 2.0;
    let top = (MARGIN + header.height() + above).round();
    let remarks = remarks(&values, &map.unit, size.aspect);
    let below = frame.bottom_margin() + 14.0 + remarks.len() as f64 * TICK.line_step();
    let height = top + size.height + below + MARGIN - 6.0;

    let mut canvas = Canvas::new(width as usize, height.ceil() as usize);
    let area = Rect::new(left, top, size.width, size.height);
    header.draw(&mut canvas, MARGIN, MARGIN - 4.0)?;
    draw_cells(&mut canvas, area, colours);
    frame.draw(&mut canvas, area)?;
    if let Some(bar) = bar {
        bar.draw(&mut canvas, Rect::new(area.right + BAR_GAP, top, BAR_WIDTH, size.height))?;
    }
    for (index, text) in remarks.iter().enumerate() {
        let y = area.bottom + frame.bottom_margin() + 14.0 + (index + 1) as f64 * TICK.line_step();
        let text = TICK.fit(text, width - 2.0 * MARGIN)?;
        remark(&mut canvas, &text, [MARGIN, y - 5.0])?;
    }
    canvas.into_png()
}

/// The size of a map in its picture, pixels.
fn size_of(map: &HeatMap) -> PlotSize {
    let (_, size) = map_axes(map);
    whole_cells(size, &map.cells.values)
}

/// The axes of a map, and the size at which it is drawn, pixels.
fn map_axes(map: &HeatMap) -> ([MarkedAxis; 2], PlotSize) {
    let MapCells { x, y, .. } = &map.cells;
    let ends = |edges: &[f64]| match edges {
        [first, .., last] => [*first, *last],
        [_] | [] => [0.0, 1.0],
    };
    let scale = map.places.geometry.scale();
    let ranges = match map.places.geometry {
        MapGeometry::Polar => [[-ends(y)[1], ends(y)[1]]; 2],
        MapGeometry::Cartesian | MapGeometry::Angular | MapGeometry::Directions => {
            [ends(x), ends(y)]
        }
    };
    let [x, y] = ranges.map(|[min, max]| PlotAxis::new(min, max, scale));
    let size = plot_size([x, y], MOST, LONGEST);
    let [x_label, y_label] = map.places.labels;
    let x = MarkedAxis::level(x, x_label, size.width);
    ([x, MarkedAxis::upright(y, y_label, size.height)], size)
}

impl MapGeometry {
    /// How places become fractions of both axes.
    pub(crate) fn scale(self) -> AxisScale {
        match self {
            Self::Angular => AxisScale::Tangent,
            Self::Cartesian | Self::Polar | Self::Directions => AxisScale::Linear,
        }
    }
}

/// A map without its cells: the description shared by pictures and pages.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MapFrame {
    /// Its axes.
    pub(crate) axes: [MarkedAxis; 2],
    /// Its bar on a linear scale.
    pub(crate) bar: BarScale,
    /// Its bar on a logarithmic scale; `None` for a map with colours for both sides of zero.
    pub(crate) log_bar: Option<BarScale>,
}

impl MapFrame {
    /// The frame of a map.
    pub(crate) fn new(map: &HeatMap) -> Self {
        let (axes, size) = map_axes(map);
        let values = finite(&map.cells.values);
        let bar = |scale: AxisScale| bar_scale(map, &values, scale, size);
        let log_bar = match map.colours {
            ColourMap::Sequential => Some(bar(AxisScale::Log)),
            ColourMap::Diverging => None,
        };
        Self { axes, bar: bar(AxisScale::Linear), log_bar }
    }
}

fn bar_scale(map: &HeatMap, values: &[f64], scale: AxisScale, size: PlotSize) -> BarScale {
    let (unit, colours, limits) = (map.unit.as_str(), map.colours, map.limits);
    BarScale::new(&Colouring { values, unit, scale, colours, limits }, size.height)
}

/// A size at which every cell has the same number of pixels, if one is close.
fn whole_cells(size: PlotSize, values: &Array2<f64>) -> PlotSize {
    let (rows, columns) = values.dim();
    if rows == 0 || columns == 0 {
        return size;
    }
    let cell = [size.width / columns as f64, size.height / rows as f64];
    // Rounded down, so that the map always fits.
    let whole = cell.map(f64::floor);
    let near = cell.iter().zip(whole).all(|(cell, whole)| whole >= 0.8 * cell);
    // Square cells stay square; others may change their aspect by less than 1 %.
    let same = whole[0] * cell[1] / (whole[1] * cell[0]);
    if near && (same - 1.0).abs() < 0.01 {
        PlotSize { width: whole[0] * columns as f64, height: whole[1] * rows as f64, ..size }
    } else {
        size
    }
}

fn draw_cells(canvas: &mut Canvas, area: Rect, colours: &Array2<Rgb>) {
    let (rows, columns) = colours.dim();
    if rows == 0 || columns == 0 {
        return canvas.bitmap(area, |_, _| NEUTRAL);
    }
    let (width, height) = (area.width() as usize, area.height() as usize);
    canvas.bitmap(area, |x, y| {
        let row = rows - 1 - (2 * y + 1) * rows / (2 * height);
        let column = (2 * x + 1) * columns / (2 * width);
        colours[[row, column]]
    });
}

/// Lines below the map, from values in ascending order.
fn remarks(values: &[f64], unit: &str, aspect: Aspect) -> Vec<String> {
    let with_unit = |value: f64| format!("{} {unit}", format_value(value)).trim().to_string();
    let mut lines = vec![match (values.first(), values.last()) {
        (Some(&least), Some(&greatest)) => {
            let cells =
                if values.len() == 1 { "1 cell" } else { &format!("{} cells", values.len()) };
            let [least, greatest] = [least, greatest].map(with_unit);
            format!("min {least}   ·   max {greatest}   ·   {cells}")
        }
        (None, _) | (_, None) => "No cell has a value.".to_string(),
    }];
    if aspect == Aspect::Squeezed {
        lines.push(SQUEEZED_REMARK.to_string());
    }
    lines
}

/// The finite values, in ascending order.
fn finite(values: &Array2<f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    values
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::png::tests::Decoded;
    use ndarray::array;

    impl HeatMap {
        /// A map of lx by mm.
        pub(crate) fn sample(x: [f64; 2], y: [f64; 2], values: Array2<f64>) -> Self {
            Self {
                title: "Illuminance".into(),
                subtitle: "sensor exit".into(),
                quantity: "illuminance".into(),
                unit: "lx".into(),
                places: MapPlaces {
                    geometry: MapGeometry::Cartesian,
                    labels: ["x in mm", "y in mm"],
                    names: ["x", "y"],
                    units: ["mm", "mm"],
                },
                cells: MapCells {
                    x: x.to_vec(),
                    y: y.to_vec(),
                    errors: values.clone(),
                    values,
                    biases: None,
                    colours: None,
                },
                colours: ColourMap::Sequential,
                limits: None,
            }
        }
    }

    fn map(values: Array2<f64>) -> HeatMap {
        HeatMap::sample([0.0, 3.0], [0.0, 2.0], values)
    }

    /// Left, top, right and bottom of the cell of a colour, which fills it: pixels of the colour
    /// bar do not count.
    fn cell(picture: &Decoded, colour: [u8; 3]) -> [usize; 4] {
        let same = |x: usize, y: usize| picture.at(x, y) == colour;
        let mut places = picture.places(colour);
        places.retain(|&(x, y)| same(x, y + 8) || same(x, y - 8));
        places.retain(|&(x, y)| same(x + 30, y) || same(x - 30, y));
        let (left, right) = (places.iter().map(|p| p.0).min(), places.iter().map(|p| p.0).max());
        let (top, bottom) = (places.iter().map(|p| p.1).min(), places.iter().map(|p| p.1).max());
        let bounds = [left.unwrap(), top.unwrap(), right.unwrap() + 1, bottom.unwrap() + 1];
        assert_eq!(places.len(), (bounds[2] - bounds[0]) * (bounds[3] - bounds[1]), "{colour:?}");
        bounds
    }

    #[test]
    fn cells_have_their_colour_and_meet_without_seams() {
        let values = [0.0, 2.0, 4.0, 6.0, f64::NAN, 10.0];
        let file = heat_map(&map(array![[0.0, 2.0, 4.0], [6.0, f64::NAN, 10.0]])).unwrap();
        let picture = Decoded::new(&file);
        let scale = |value: f64| ColourMap::Sequential.colour(value / 10.0);
        let colour = |value: f64| if value.is_nan() { NEUTRAL } else { scale(value) };
        let cells = values.map(|value| cell(&picture, colour(value)));
        let [width, height] = [cells[0][2] - cells[0][0], cells[0][3] - cells[0][1]];
        assert_eq!(width, height, "1 mm is as long in both directions");
        for row in 0..2 {
            for column in 0..3 {
                let cell = cells[3 * row + column];
                assert_eq!([cell[2] - cell[0], cell[3] - cell[1]], [width, height]);
                assert_eq!(cell[0], cells[0][0] + column * width);
                // Row 0 is the lowest.
                assert_eq!(cell[3], cells[0][3] - row * height);
            }
        }
    }

    #[test]
    fn what_is_not_finite_is_neutral() {
        let file = heat_map(&map(array![[f64::NAN, f64::INFINITY]])).unwrap();
        let [left, top, right, bottom] = Decoded::new(&file).bounds(NEUTRAL);
        assert_eq!(Decoded::new(&file).places(NEUTRAL).len(), (right - left) * (bottom - top));
        assert!(right - left > 500 && bottom - top > 300);
    }

    #[test]
    fn cells_stay_whole_and_square_where_there_is_room() {
        let size = PlotSize { width: 640.0, height: 600.0, aspect: Aspect::True };
        let whole = whole_cells(size, &Array2::zeros((60, 64)));
        assert_eq!((whole.width, whole.height), (640.0, 600.0));
        let whole = whole_cells(size, &Array2::zeros((90, 96)));
        assert_eq!((whole.width, whole.height), (576.0, 540.0));
        assert_eq!(whole_cells(size, &Array2::zeros((2000, 2000))), size);
        assert_eq!(whole_cells(size, &Array2::zeros((0, 0))), size);
    }
}
