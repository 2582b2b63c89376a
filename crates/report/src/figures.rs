//! The pictures of a report and their contents.

use crate::by_light::{from_light, sum_over_weathers};
use crate::cell_grid::CellGrid;
use crate::csv::{intensity_name, map_name, map_words};
use crate::key_figures::is_one_cell;
use crate::png::{
    AxisScale, Bar, BarChart, ColourMap, ErrorForm, HeatMap, LinePlot, PlotSeries, PolarCurve,
    PolarPlot, SeriesForm, SeriesPoint, bar_chart, heat_map, line_plot, polar_plot,
    true_colour_map,
};
use crate::{OutputFile, Report};
use lumiduct_base::error::Result;
use lumiduct_base::number::{format_percent, format_value, format_with_error};
use lumiduct_core::measure::{
    Balance, IntensityTable, MapAxes, PlaneCurve, SensorMap, SensorPaths, SensorSpectrum,
    not_below_zero,
};
use ndarray::Axis;

/// All pictures of a report.
pub(crate) fn files(report: &Report) -> Result<Vec<OutputFile>> {
    let measures = &report.measures;
    let mut files = Vec::new();
    for map in measures.maps.iter().filter(|map| !is_one_cell(map)) {
        files.push(OutputFile { name: format!("{}.png", map_name(map)), bytes: map_picture(map)? });
        match &map.axes {
            MapAxes::Cartesian { .. } | MapAxes::Angular { .. } => {
                files.extend(in_true_colour(&map_name(map), sensor_map(map))?);
            }
            MapAxes::Polar { .. } => {}
        }
    }
    for table in &measures.intensities {
        let name = intensity_name(table);
        let bytes = polar_plot(&intensity_plot(table))?;
        files.push(OutputFile { name: format!("{name}.png"), bytes });
        if has_sectors(table) {
            files.extend(in_true_colour(&name, directions_map(table))?);
        }
    }
    for spectrum in &measures.spectra {
        let bytes = line_plot(&spectrum_plot(spectrum))?;
        files.push(OutputFile { name: format!("{}.spectrum.png", spectrum.sensor), bytes });
    }
    for paths in measures.sensor_paths.iter().filter(|paths| !paths.depths.is_empty()) {
        let bytes = line_plot(&bounce_plot(paths, measures.unit.flux(), BOUNCES_SHOWN))?;
        files.push(OutputFile { name: format!("{}.bounces.png", paths.sensor), bytes });
    }
    let bytes = balance_picture(&measures.balance, measures.source_flux, measures.unit.flux())?;
    files.push(OutputFile { name: "balance.png".into(), bytes });
    Ok(files)
}

/// The map of a sensor in the plane of its face, or of its image.
pub(crate) fn sensor_map(map: &SensorMap) -> HeatMap {
    drawn(&map.into(), format!("{}: {}", map.sensor, map_words(map)), mean_words(map))
}

/// The picture of a map in its own colours; `None` without colours.
fn in_true_colour(name: &str, map: HeatMap) -> Result<Option<OutputFile>> {
    let Some(colours) = map.cells.colours.clone() else { return Ok(None) };
    let subtitle = "as a screen shows its light (sRGB, white of D65)".to_owned();
    let map = HeatMap { title: format!("{}, true colour", map.title), subtitle, ..map };
    let bytes = true_colour_map(&map, &colours)?;
    Ok(Some(OutputFile { name: format!("{name}.colour.png"), bytes }))
}

/// Whether a goniometer resolves azimuths.
pub(crate) fn has_sectors(table: &IntensityTable) -> bool {
    table.values.ncols() > 1
}

/// The intensity of a goniometer by both of its angles.
pub(crate) fn directions_map(table: &IntensityTable) -> HeatMap {
    let subtitle = sum_over_weathers(table.weathers).unwrap_or_default();
    drawn(&table.into(), intensity_title(table), subtitle)
}

fn drawn(grid: &CellGrid<'_>, title: String, subtitle: String) -> HeatMap {
    HeatMap {
        title,
        subtitle,
        quantity: grid.quantity.to_owned(),
        unit: grid.unit.to_owned(),
        places: grid.kind.places,
        cells: grid.cells(),
        colours: ColourMap::Sequential,
        limits: None,
    }
}

fn mean_words(map: &SensorMap) -> String {
    let average = &map.summary.all.avg;
    format!("mean {} {}", format_with_error(average.value, average.std_error), map.unit)
}

fn map_picture(map: &SensorMap) -> Result<Vec<u8>> {
    match &map.axes {
        MapAxes::Cartesian { .. } | MapAxes::Angular { .. } => heat_map(&sensor_map(map)),
        MapAxes::Polar { radius_mm, sector_deg } => line_plot(&LinePlot {
            title: format!("{}: {}", map.sensor, map_words(map)),
            subtitle: mean_words(map),
            x_label: "radius in mm".into(),
            y_label: format!("{} in {}", map.quantity, map.unit),
            scale: AxisScale::Linear,
            series: map
                .values
                .axis_iter(Axis(1))
                .zip(map.std_errors.axis_iter(Axis(1)))
                .enumerate()
                .map(|(sector, (values, errors))| {
                    let [from, to] = [sector_deg[sector], sector_deg[sector + 1]];
                    let rings = radius_mm.windows(2).zip(values.iter().zip(errors));
                    let point = |(ring, (&y, &std_error)): (&[f64], (&f64, &f64))| SeriesPoint {
                        x: 0.5 * (ring[0] + ring[1]),
                        y: not_below_zero(y),
                        std_error,
                    };
                    let points = rings.map(point).collect();
                    let name = format!("{from:.0}° to {to:.0}°");
                    PlotSeries::new(name, points, SeriesForm::Line, ErrorForm::Bars)
                })
                .collect(),
        }),
    }
}

/// Curves through the planes C0-C180 and C90-C270, or the mean over C of a goniometer without sectors.
pub(crate) fn intensity_plot(table: &IntensityTable) -> PolarPlot {
    let curves = if !table.planes.is_empty() {
        let curve = |plane: &PlaneCurve| PolarCurve {
            name: format!("C{} (right) to C{} (left)", plane.c_deg, plane.c_deg + 180.0),
            points: {
                let values = plane.values.iter().copied().map(not_below_zero);
                plane.gamma_deg.iter().copied().zip(values).collect()
            },
            std_errors: plane.std_errors.clone(),
        };
        table.planes.iter().map(curve).collect()
    } else {
        let both = |sign: f64| {
            table
                .ring_gamma_deg
                .iter()
                .zip(&table.ring_values)
                .map(move |(gamma, value)| (sign * gamma, not_below_zero(*value)))
        };
        let (left, right): (Vec<_>, Vec<_>) = (both(-1.0).collect(), both(1.0).collect());
        let points = left.into_iter().rev().chain(right).collect();
        let errors =
            table.ring_std_errors.iter().rev().chain(&table.ring_std_errors).copied().collect();
        vec![PolarCurve { name: "mean over C".into(), points, std_errors: errors }]
    };
    PolarPlot {
        title: intensity_title(table),
        subtitle: where_and_when(table),
        unit: table.unit.clone(),
        curves,
    }
}

/// The spectrum of a sensor's light.
pub(crate) fn spectrum_plot(spectrum: &SensorSpectrum) -> LinePlot {
    let bands = spectrum.nm.iter().zip(spectrum.values.iter().zip(&spectrum.std_errors));
    let points = bands.map(|(&x, (&y, &std_error))| SeriesPoint { x, y, std_error }).collect();
    LinePlot {
        title: format!("{}: spectrum", spectrum.sensor),
        subtitle: "in bands of 5 nm, with one standard error to either side".into(),
        x_label: "wavelength in nm".into(),
        y_label: "radiant flux in W/nm".into(),
        scale: AxisScale::Linear,
        series: vec![PlotSeries::new("", points, SeriesForm::Steps, ErrorForm::Band)],
    }
}

fn intensity_title(table: &IntensityTable) -> String {
    format!("{}: intensity{}", table.sensor, from_light(table.light.as_deref()))
}

/// Distance of an intensity, and its number of weathers: `far field`,
/// `at 50 mm, sum over 2 weathers`.
pub(crate) fn where_and_when(table: &IntensityTable) -> String {
    let distance = table
        .radius_mm
        .map_or("far field".to_owned(), |radius| format!("at {} mm", format_value(radius)));
    let weathers = sum_over_weathers(table.weathers);
    weathers.map_or(distance.clone(), |words| format!("{distance}, {words}"))
}

/// Share of the flux that the histogram of bounces shows; a few paths continue for thousands of
/// bounces.
pub(crate) const BOUNCES_SHOWN: f64 = 0.995;

/// The histogram of bounces of a sensor, up to the given share of its flux.
pub(crate) fn bounce_plot(paths: &SensorPaths, unit: &str, share: f64) -> LinePlot {
    let total: f64 = paths.depths.iter().map(|bin| bin.flux).sum();
    let mut so_far = 0.0;
    let shown = paths.depths.iter().take_while(|bin| {
        let before = so_far;
        so_far += bin.flux;
        before < share * total
    });
    let points: Vec<SeriesPoint> = shown
        .map(|bin| {
            // Bins of several depths show the mean per depth.
            let width = (bin.to - bin.from + 1) as f64;
            SeriesPoint {
                x: 0.5 * (bin.from + bin.to) as f64,
                y: bin.flux / width,
                std_error: bin.std_error / width,
            }
        })
        .collect();
    let deepest = paths.depths.last().map_or(0, |bin| bin.to);
    let shown_to = points.len().checked_sub(1).map_or(0, |last| paths.depths[last].to);
    LinePlot {
        title: format!("{}: flux by number of bounces", paths.sensor),
        subtitle: format!(
            "up to {shown_to} bounces carry {}; the deepest path met {deepest} or fewer",
            format_percent(share)
        ),
        x_label: "interfaces met".into(),
        y_label: format!("flux in {unit}"),
        scale: AxisScale::Linear,
        series: vec![PlotSeries::new(&paths.sensor, points, SeriesForm::Steps, ErrorForm::Hidden)],
    }
}

/// Colours of the kinds of losses, as indices into the palette.
mod kind {
    pub(super) const ESCAPED: usize = 0;
    pub(super) const FACE: usize = 1;
    pub(super) const MEDIUM: usize = 2;
    pub(super) const LOST: usize = 3;
}

fn balance_picture(balance: &Balance, source_flux: f64, unit: &str) -> Result<Vec<u8>> {
    let mut bars = Vec::new();
    let mut bar = |name: String, measure: &lumiduct_core::measure::Measure, colour: usize| {
        if measure.value != 0.0 {
            bars.push(Bar {
                name,
                value: measure.value,
                std_error: Some(measure.std_error),
                colour,
            });
        }
    };
    for (face, measure) in &balance.escaped {
        bar(format!("escaped by {face}"), measure, kind::ESCAPED);
    }
    bar("escaped, never in a solid".into(), &balance.escaped_directly, kind::ESCAPED);
    for (face, measure) in &balance.absorbed {
        bar(format!("absorbed by {face}"), measure, kind::FACE);
    }
    for (medium, measure) in &balance.absorbed_medium {
        bar(format!("absorbed in {medium}"), measure, kind::MEDIUM);
    }
    for (medium, measure) in &balance.converted {
        let what = if measure.value < 0.0 { "gained" } else { "lost" };
        bar(format!("{what} by conversion in {medium}"), measure, kind::MEDIUM);
    }
    bar("cut by the bounce limit".into(), &balance.cut, kind::LOST);
    bar("leaked".into(), &balance.leaked, kind::LOST);
    bar_chart(&BarChart {
        title: "Where the light went".into(),
        subtitle: format!("of {} {unit} emitted", format_value(source_flux)),
        unit: unit.to_owned(),
        whole: Some(source_flux),
        bars,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::html::data;
    use lumiduct_core::measure::{Measures, measure};
    use lumiduct_core::scene::LightGroups;
    use lumiduct_core::transport::{Findings, Layout, Readings};
    use lumiduct_input::{Settings, load};

    const SCENE: &str = r#"
lumiduct = 1
title = "dim"
[sheets.screen.disk]
radius_mm = 50
finish = "black"
[sources.led.point]
at = { position_mm = [0, 0, 9] }
flux_lm = 1
[sensors]
exit = { plane = { rectangle = { width_mm = 1, height_mm = 1 }, cells = [2, 2] }, at = { position_mm = [0, 0, 5] } }
far = { goniometer = { c_step_deg = 90, gamma_step_deg = 30 } }
"#;

    /// Readings of a plane and a goniometer that negative weights have made negative in the first cell
    /// and the first ring.
    fn dim(weathers: &[&str]) -> Measures {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("dim.toml");
        std::fs::write(&path, SCENE).unwrap();
        let mut scene = load(&path, &Settings::default()).unwrap().scene;
        let weathers = weathers.iter().map(|name| (*name).to_owned()).collect();
        scene.light = LightGroups::new(Vec::new(), weathers);
        let layout = Layout::new(&scene);
        let [one, other] = [0, 1].map(|index| {
            let mut batch = Readings::of_batch(&scene, &layout, 1, 1000, index);
            for (sensor, (cells, dim)) in [(4, 1), (24, 4)].into_iter().enumerate() {
                for cell in 0..cells {
                    let flux = if cell < dim { -2e-6 } else { 3e-6 };
                    batch.sensors[sensor].cells.add(cell, flux);
                }
            }
            batch.close_batch();
            batch
        });
        measure(&scene, &Findings::forward(one.merge(&other)))
    }

    #[test]
    fn pictures_show_no_light_below_zero() {
        let measures = dim(&[]);
        let (map, intensity) = (&measures.maps[0], &measures.intensities[0]);
        assert!(map.values[[0, 0]] < -1.0 && map.std_errors[[0, 0]] >= -map.values[[0, 0]]);
        assert!(intensity.values[[0, 0]] < 0.0);
        assert_eq!(
            (sensor_map(map).cells.values[[0, 0]], directions_map(intensity).cells.values[[0, 0]]),
            (0.0, 0.0)
        );
        assert_eq!(sensor_map(map).cells.values[[1, 1]], map.values[[1, 1]]);
        let lowest = |plot: PolarPlot| {
            let points = plot.curves.into_iter().flat_map(|curve| curve.points);
            points.map(|(_, value)| value).fold(f64::INFINITY, f64::min)
        };
        assert_eq!(lowest(intensity_plot(intensity)), 0.0);
        assert_eq!(data::map(&sensor_map(map))["values"][0], 0.0);
    }

    #[test]
    fn an_intensity_of_several_weathers_says_that_it_adds_them_up() {
        let [one, two] = [&["clear"][..], &["clear", "overcast"]].map(dim);
        assert_eq!(where_and_when(&one.intensities[0]), "far field");
        let words = "far field, sum over 2 weathers";
        assert_eq!(intensity_plot(&two.intensities[0]).subtitle, words);
        assert_eq!(directions_map(&two.intensities[0]).subtitle, "sum over 2 weathers");
        assert_eq!(directions_map(&one.intensities[0]).subtitle, "");
    }
}
