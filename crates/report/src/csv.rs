//! Tables: one file for each map, intensity distribution and histogram, a row for each cell, units in the header.

use crate::by_light::{from_light, sum_over_weathers};
use crate::{OutputFile, Report};
use csv::Writer;
use lumiduct_base::error::{Error, Result};
use lumiduct_base::number::format_value;
use lumiduct_base::text::spreadsheet_cell;
use lumiduct_core::measure::{IntensityTable, MapAxes, SensorMap};

/// All tables of a report except those for spreadsheets.
pub(crate) fn files(report: &Report) -> Result<Vec<OutputFile>> {
    let measures = &report.measures;
    let mut files = Vec::new();
    for map in &measures.maps {
        files.push(map_table(map)?);
    }
    for table in &measures.intensities {
        files.push(intensity_table(table)?);
    }
    for paths in &measures.sensor_paths {
        let rows = paths
            .depths
            .iter()
            .map(|bin| numbers([bin.from as f64, bin.to as f64, bin.flux, bin.std_error]));
        let unit = measures.unit.flux();
        let header =
            ["bounces_from", "bounces_to", &format!("flux_{unit}"), &format!("std_error_{unit}")];
        files.push(table(format!("{}.bounces.csv", paths.sensor), &header, rows)?);
    }
    Ok(files)
}

/// File name of a map without its extension.
pub(crate) fn map_name(map: &SensorMap) -> String {
    let view = map.view.map_or(String::new(), |view| format!(".view{view}"));
    format!("{}.{}{view}{}", map.sensor, map.quantity, light_part(map.light.as_deref()))
}

/// File name of a table or picture of intensities without its extension.
pub(crate) fn intensity_name(table: &IntensityTable) -> String {
    format!("{}.intensity{}", table.sensor, light_part(table.light.as_deref()))
}

/// The part of a file name that names a light group: `.from_red`. Names have no points, so that no
/// other sensor or view has the same.
fn light_part(light: Option<&str>) -> String {
    light.map_or(String::new(), |name| format!(".from_{name}"))
}

/// What a map shows, in words: its quantity, the light group, and where a view looks from.
pub(crate) fn map_words(map: &SensorMap) -> String {
    let from = map.seen_from_deg.map_or(String::new(), |angles| {
        let [theta, phi] = angles.map(|angle| format_value((1e6 * angle).round() / 1e6));
        format!(", {theta}° from the normal at azimuth {phi}°")
    });
    let view = map.view.map_or(String::new(), |view| format!(" of view {view}"));
    let weathers =
        sum_over_weathers(map.weathers).map_or(String::new(), |words| format!(", {words}"));
    let light = from_light(map.light.as_deref());
    format!("{}{light}{view}{from}{weathers}", map.quantity)
}

fn map_table(map: &SensorMap) -> Result<OutputFile> {
    let (value, error) =
        (format!("{}_{}", map.quantity, map.unit), format!("std_error_{}", map.unit));
    let name = format!("{}.csv", map_name(map));
    let middle = |edges: &[f64], index: usize| 0.5 * (edges[index] + edges[index + 1]);
    let (header, rows, columns) = match &map.axes {
        MapAxes::Cartesian { u_mm, v_mm } => (["u_mm", "v_mm"], v_mm, u_mm),
        MapAxes::Angular { u_deg, v_deg } => (["u_deg", "v_deg"], v_deg, u_deg),
        MapAxes::Polar { radius_mm, sector_deg } => {
            (["sector_deg", "radius_mm"], radius_mm, sector_deg)
        }
    };
    let mut header = vec![header[0].to_owned(), header[1].to_owned(), value, error];
    header.extend(map.biases.is_some().then(|| bias_column(&map.unit)));
    header.push("on_sensor".to_owned());
    let lines =
        map.values.indexed_iter().filter(|(_, value)| value.is_finite()).map(|(at, value)| {
            let (row, column) = at;
            let place = [middle(columns, column), middle(rows, row)];
            let bias = map.biases.as_ref().map(|biases| biases[at]);
            let read = [*value, map.std_errors[at]].into_iter().chain(bias);
            numbers(place.into_iter().chain(read).chain([map.on_sensor[at]]))
        });
    table(name, &header, lines)
}

fn intensity_table(intensity: &IntensityTable) -> Result<OutputFile> {
    let unit = &intensity.unit;
    let mut header = vec![
        "c_from_deg".to_owned(),
        "c_to_deg".to_owned(),
        "gamma_from_deg".to_owned(),
        "gamma_to_deg".to_owned(),
        format!("intensity_{unit}"),
        format!("std_error_{unit}"),
    ];
    header.extend(intensity.biases.is_some().then(|| bias_column(unit)));
    let (c, gamma) = (&intensity.c_deg, &intensity.gamma_deg);
    let rows = intensity.values.indexed_iter().map(|(at, value)| {
        let (ring, sector) = at;
        let place = [c[sector], c[sector + 1], gamma[ring], gamma[ring + 1]];
        let bias = intensity.biases.as_ref().map(|biases| biases[at]);
        numbers(place.into_iter().chain([*value, intensity.std_errors[at]]).chain(bias))
    });
    table(format!("{}.csv", intensity_name(intensity)), &header, rows)
}

/// Header of the column of possible bias on top of the noise.
fn bias_column(unit: &str) -> String {
    format!("bias_{unit}")
}

/// Numbers as a row, with all their digits.
fn numbers(row: impl IntoIterator<Item = f64>) -> Vec<String> {
    row.into_iter().map(|number| number.to_string()).collect()
}

/// A table from a header and rows.
pub(crate) fn table(
    name: String,
    header: &[impl AsRef<str>],
    rows: impl Iterator<Item = Vec<String>>,
) -> Result<OutputFile> {
    let failed = |reason: String| Error::Output { what: name.clone(), reason };
    let mut writer = Writer::from_writer(Vec::new());
    let header = header.iter().map(|cell| spreadsheet_cell(cell.as_ref()));
    writer.write_record(header).map_err(|reason| failed(reason.to_string()))?;
    for row in rows {
        let row = row.iter().map(|cell| spreadsheet_cell(cell));
        writer.write_record(row).map_err(|reason| failed(reason.to_string()))?;
    }
    let bytes = writer.into_inner().map_err(|reason| failed(reason.to_string()))?;
    Ok(OutputFile { name, bytes })
}
