//! The contribution of each source or light group to each sensor, and the wording where totals sum
//! over weathers.

use crate::key_figures::{is_one_cell, view_words};
use crate::words::quantity;
use lumiduct_core::measure::{Measure, Measures, SensorMap};

/// Least number of sources and groups that are compared.
const SEVERAL: usize = 2;

/// Text before the table by source.
pub(crate) const HEAD: &str = "Efficiency is the fraction of a source's light that reaches the sensor. \
    Share is the fraction of the sensor's light that comes from the source; for a source meant for another \
    sensor it is the crosstalk.";

/// A source or light group at a sensor.
pub(crate) struct LightShare<'a> {
    /// Name of the source or group.
    pub(crate) name: &'a str,
    /// Flux over the emission of the source or group.
    pub(crate) efficiency: &'a Measure,
    /// Share of all light on the sensor; `None` where that sums over weathers.
    pub(crate) share: Option<&'a Measure>,
}

/// Light groups and ungrouped sources, in the order of the sources; dark ones are left out.
fn names(measures: &Measures) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    let lit = measures.balance.emitted_by_source.iter().filter(|(_, flux)| flux.value > 0.0);
    for (source, _) in lit {
        let group = measures.light_groups.iter().find(|(_, sources)| sources.contains(source));
        let name = group.map_or(source, |(group, _)| group).as_str();
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

/// The contributions of sources and groups to a sensor; empty unless there are several.
pub(crate) fn shares<'a>(measures: &'a Measures, sensor: &str) -> Vec<LightShare<'a>> {
    let names = names(measures);
    if names.len() < SEVERAL {
        return Vec::new();
    }
    let of = |name: &str, what: &str| measures.values.get(&format!("{sensor}.{what}.from.{name}"));
    let share = |name: &'a str| {
        let efficiency = of(name, "efficiency")?;
        Some(LightShare { name, efficiency, share: of(name, "share") })
    };
    names.into_iter().filter_map(share).collect()
}

/// A matrix with its head: sensors in rows, sources and light groups in columns.
pub(crate) struct LightMatrix {
    pub(crate) head: Vec<String>,
    pub(crate) rows: Vec<Vec<String>>,
}

/// Efficiencies of all sources and groups on all sensors, with the shares where meaningful, and the
/// uniformity of maps by group; `None` unless there are several sources.
pub(crate) fn matrix(measures: &Measures) -> Option<LightMatrix> {
    let sensors = || measures.sensor_paths.iter().map(|paths| paths.sensor.as_str());
    let all: Vec<(&str, Vec<LightShare<'_>>)> =
        sensors().map(|sensor| (sensor, shares(measures, sensor))).collect();
    let (_, first) = all.iter().find(|(_, shares)| !shares.is_empty())?;
    let head = ["sensor", ""].into_iter().chain(first.iter().map(|share| share.name));
    let head = head.map(str::to_owned).collect();
    let mut rows = Vec::new();
    for (sensor, shares) in &all {
        let row = |what: &str, cells: Vec<String>| {
            [sensor.to_string(), what.to_owned()].into_iter().chain(cells).collect()
        };
        let efficiencies = shares.iter().map(|share| quantity(share.efficiency)).collect();
        rows.push(row("efficiency", efficiencies));
        let own: Option<Vec<String>> =
            shares.iter().map(|share| share.share.map(quantity)).collect();
        rows.extend(own.map(|cells| row("share", cells)));
        let even = uniformities(measures, sensor, shares).into_iter();
        rows.extend(even.map(|(what, cells)| row(&what, cells)));
    }
    Some(LightMatrix { head, rows })
}

/// What is measured and its value for each group, for every map with several cells; nothing for
/// sources that are in no group.
fn uniformities(
    measures: &Measures,
    sensor: &str,
    shares: &[LightShare<'_>],
) -> Vec<(String, Vec<String>)> {
    let is_own = |map: &&SensorMap| map.sensor == sensor && map.light.is_none();
    let maps = measures.maps.iter().filter(is_own).filter(|map| !is_one_cell(map));
    let row = |map: &SensorMap| {
        let view = map.view.map_or(String::new(), |view| format!(".{view}"));
        let of = |name: &str| format!("{sensor}.uniformity_min_avg{view}.from.{name}");
        let found: Vec<_> =
            shares.iter().map(|share| measures.values.get(&of(share.name))).collect();
        let cells = found.iter().map(|own| own.map_or(String::new(), quantity)).collect();
        let is_known = found.iter().any(Option::is_some);
        is_known.then(|| (format!("uniformity min/avg{}", view_words(map)), cells))
    };
    maps.filter_map(row).collect()
}

/// " from red", where a map shows the light of a group alone.
pub(crate) fn from_light(light: Option<&str>) -> String {
    light.map_or(String::new(), |name| format!(" from {name}"))
}

/// "sum over 2 weathers", where the sources never shine all together.
pub(crate) fn sum_over_weathers(count: usize) -> Option<String> {
    (count > 1).then(|| format!("sum over {count} weathers"))
}

/// The sentence about totals that sum over weathers.
pub(crate) fn remark_on_weathers(measures: &Measures) -> Option<String> {
    let words = sum_over_weathers(measures.weathers.len())?;
    let is_measured = |name: &&String| {
        measures.light_groups.contains_key(*name)
            || measures.balance.emitted_by_source.contains_key(*name)
    };
    let example = measures.weathers.iter().find(is_measured);
    let example = example.map_or(String::new(), |name| format!(", such as flux.from.{name}"));
    Some(format!(
        "totals of all sources are a {words} that never occur together ({}): this holds for flux, \
            illuminance, maps and everything derived from them; read the measures of one weather{example}, \
            or give the scene only one",
        measures.weathers.join(", ")
    ))
}

/// The sentence before the measures of a sensor.
pub(crate) fn remark_on_totals(measures: &Measures) -> Option<String> {
    let words = sum_over_weathers(measures.weathers.len())?;
    Some(format!(
        "Every value without `from` in its name is a {words}: {}.",
        measures.weathers.join(", ")
    ))
}
