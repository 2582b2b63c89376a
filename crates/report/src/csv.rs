//! Tables: one file for each map, intensity distribution and histogram, a row for each cell, units in the header.

use crate::by_light::{from_light, sum_over_weathers};
use crate::cell_grid::CellGrid;
use crate::{OutputFile, Report};
use csv::Writer;
use lumiduct_base::error::{Error, Result};
use lumiduct_base::number::format_value;
use lumiduct_base::text::spreadsheet_cell;
use lumiduct_core::measure::{IntensityTable, SensorMap};

/// All tables of a report except those for spreadsheets.
pub(crate) fn files(report: &Report) -> Result<Vec<OutputFile>> {
    let measures = &report.measures;
    let mut files = Vec::new();
    for map in &measures.maps {
        files.push(grid_table(&map_name(map), &map.into())?);
    }
    for table in &measures.intensities {
        files.push(grid_table(&intensity_name(table), &table.into())?);
    }
    for spectrum in &measures.spectra {
        let bands = spectrum.nm.iter().zip(spectrum.values.iter().zip(&spectrum.std_errors));
        let rows = bands.map(|(nm, (value, error))| numbers([*nm, *value, *error]));
        let header = ["nm", "radiant_flux_W_per_nm", "std_error_W_per_nm"];
        files.push(table(format!("{}.spectrum.csv", spectrum.sensor), &header, rows)?);
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

/// A row for each cell that has a value.
fn grid_table(name: &str, grid: &CellGrid<'_>) -> Result<OutputFile> {
    let CellGrid { kind, quantity, unit, x, y, .. } = grid;
    let mut header: Vec<String> = kind.columns.iter().map(|name| (*name).to_owned()).collect();
    header.extend([format!("{quantity}_{unit}"), format!("std_error_{unit}")]);
    header.extend(grid.biases.map(|_| format!("bias_{unit}")));
    header.extend(grid.on_sensor.map(|_| "on_sensor".to_owned()));
    header.extend(grid.colour_columns().map(|(name, _)| name.replace('.', "_")));
    let cells = grid.values.indexed_iter().filter(|(_, value)| value.is_finite());
    let rows = cells.map(|(at, value)| {
        let ends = [[x[at.1], x[at.1 + 1]], [y[at.0], y[at.0 + 1]]];
        let mut row = match kind.columns.len() {
            2 => ends.map(|[from, to]| 0.5 * (from + to)).to_vec(),
            _ => ends.concat(),
        };
        row.extend([*value, grid.std_errors[at]]);
        row.extend([grid.biases, grid.on_sensor].into_iter().flatten().map(|of| of[at]));
        row.extend(grid.colour_columns().map(|(_, of)| of[at]));
        numbers(row)
    });
    table(format!("{name}.csv"), &header, rows)
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
