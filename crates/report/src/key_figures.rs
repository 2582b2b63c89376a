//! The figures of a sensor that a reader looks for first, whatever the format of the report.

use lumiduct_base::number::format_value;
use lumiduct_core::measure::{Measure, Measures, SensorMap, Status};

/// A figure: what it is, in words, and its value.
pub(crate) struct KeyFigure<'r> {
    /// Such as `mean illuminance`.
    pub(crate) label: String,
    /// Its value.
    pub(crate) measure: &'r Measure,
    /// Whether it is among the few that a terminal shows.
    pub(crate) is_brief: bool,
}

/// The last parts of the names of measures, what a reader calls them, and whether a terminal shows them.
const FIGURES: [(&str, &str, bool); 17] = [
    ("flux", "flux", true),
    ("efficiency", "efficiency", true),
    ("transmission", "transmission", true),
    ("illuminance_avg", "mean illuminance", true),
    ("irradiance_avg", "mean irradiance", true),
    ("intensity_max", "peak intensity", true),
    ("beam_angle", "beam angle", true),
    ("field_angle", "field angle", false),
    ("radiant_flux", "radiant flux", false),
    ("radiant_efficiency", "radiant efficiency", false),
    ("colour_u", "u'", true),
    ("colour_v", "v'", true),
    ("colour_temperature", "colour temperature", true),
    ("duv", "Duv", false),
    ("colour_rendering_ra", "Ra", false),
    ("colour_rendering_r9", "R9", false),
    ("colour_nonuniformity", "colour nonuniformity Δu'v'", true),
];

/// Flux, efficiency, and the main figures of the kind of sensor.
pub(crate) fn key_figures<'r>(measures: &'r Measures, sensor: &str) -> Vec<KeyFigure<'r>> {
    let value = |name: &str| measures.values.get(&format!("{sensor}.{name}"));
    let mut figures: Vec<KeyFigure<'r>> = FIGURES
        .iter()
        .filter_map(|(name, label, is_brief)| {
            let (label, measure) = ((*label).to_owned(), value(name)?);
            // Saturated colours have no colour temperature.
            (measure.status != Status::Undefined).then_some(())?;
            Some(KeyFigure { label, measure, is_brief: *is_brief })
        })
        .collect();
    let is_own = |map: &&SensorMap| map.sensor == sensor && map.light.is_none();
    for map in measures.maps.iter().filter(is_own) {
        let view = map.view.map_or(String::new(), |view| format!(".{view}"));
        let named = |name: &str, label: String, is_brief: bool| {
            Some(KeyFigure { label, measure: value(&format!("{name}{view}"))?, is_brief })
        };
        let of_view = view_words(map);
        if map.quantity == "luminance" || map.quantity == "radiance" {
            let label = format!("mean {}{of_view}", map.quantity);
            figures.extend(named(&format!("{}_avg", map.quantity), label, true));
        }
        if !is_one_cell(map) {
            let label = format!("uniformity min/avg{of_view}");
            figures.extend(named("uniformity_min_avg", label, false));
            if map.view.is_some() {
                let label = format!("colour nonuniformity Δu'v'{of_view}");
                figures.extend(named("colour_nonuniformity", label, false));
            }
        }
    }
    figures
}

/// Where a view looks from: ` at 30° from the normal, azimuth 0°`.
pub(crate) fn view_words(map: &SensorMap) -> String {
    map.seen_from_deg.map_or(String::new(), |angles| {
        let [theta, phi] = angles.map(|angle| format_value((1e6 * angle).round() / 1e6));
        if theta == "0" {
            " along the normal".to_owned()
        } else {
            format!(" at {theta}° from the normal, azimuth {phi}°")
        }
    })
}

/// Whether a map is a single value, which has no shape and is even.
pub(crate) fn is_one_cell(map: &SensorMap) -> bool {
    map.values.len() == 1
}

/// Measures that are redundant for a single cell: extremes and uniformity.
const OF_SEVERAL_CELLS: [&str; 11] = [
    "uniformity",
    "cv",
    "cell.",
    "illuminance_m",
    "illuminance_c",
    "irradiance_m",
    "irradiance_c",
    "luminance_m",
    "luminance_c",
    "radiance_m",
    "radiance_c",
];

/// Whether a report shows a measure: `rest` is its name without the sensor's.
pub(crate) fn is_shown(measures: &Measures, sensor: &str, rest: &str) -> bool {
    let mut maps = measures.maps.iter().filter(|map| map.sensor == sensor).peekable();
    let one_cell = maps.peek().is_some() && maps.all(is_one_cell);
    !one_cell || !OF_SEVERAL_CELLS.iter().any(|start| rest.starts_with(start))
}

/// The subject of a measure, which decides where it is listed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Listed {
    /// What the sensor reads.
    Reading,
    /// How the light reached it.
    Journey,
    /// One of many cells or rings.
    Cell,
}

/// Where a measure is listed: `rest` is its name without the sensor's.
pub(crate) fn listed(rest: &str) -> Listed {
    if rest.starts_with("cell.") || rest.starts_with("ring.") {
        Listed::Cell
    } else if rest.starts_with("bounces_") || rest.starts_with("share_deeper_") {
        Listed::Journey
    } else {
        Listed::Reading
    }
}
