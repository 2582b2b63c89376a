//! Tables: one file for each map and intensity distribution, units in the header.

use crate::error::{Error, Result};
use crate::measure::{Axes, IntensityTable, SensorMap};
use crate::report::{OutputFile, Report};
use csv::Writer;

/// All tables of a report.
pub(crate) fn files(report: &Report) -> Result<Vec<OutputFile>> {
    let measures = &report.measures;
    let mut files = vec![values(report)?];
    for map in &measures.maps {
        files.push(map_table(map)?);
    }
    for table in &measures.intensities {
        files.push(intensity_table(table)?);
    }
    for paths in &measures.sensor_paths {
        let rows = paths.depths.iter().map(|bin| {
            [bin.from as f64, bin.to as f64, bin.flux, bin.std_error]
                .map(|number| number.to_string())
        });
        let unit = measures.unit.flux();
        let header =
            ["bounces_from", "bounces_to", &format!("flux_{unit}"), &format!("std_error_{unit}")];
        files.push(table(format!("{}.bounces.csv", paths.sensor), &header, rows)?);
    }
    Ok(files)
}

/// File name of a map without its ending.
pub(crate) fn map_name(map: &SensorMap) -> String {
    let view = map.view.map_or(String::new(), |view| format!(".view{view}"));
    format!("{}.{}{view}", map.sensor, map.quantity)
}

fn values(report: &Report) -> Result<OutputFile> {
    let rows = report.measures.values.iter().map(|(name, measure)| {
        let bias = measure.bias.map_or(String::new(), |bias| bias.to_string());
        [
            name.clone(),
            measure.value.to_string(),
            measure.std_error.to_string(),
            bias,
            measure.unit.clone(),
        ]
    });
    table("measures.csv".into(), &["measure", "value", "std_error", "bias", "unit"], rows)
}

fn map_table(map: &SensorMap) -> Result<OutputFile> {
    let (value, error) =
        (format!("{}_{}", map.quantity, map.unit), format!("std_error_{}", map.unit));
    let name = format!("{}.csv", map_name(map));
    let middle = |edges: &[f64], index: usize| 0.5 * (edges[index] + edges[index + 1]);
    let (header, rows, columns) = match &map.axes {
        Axes::Cartesian { u_mm, v_mm } => (["u_mm", "v_mm"], v_mm, u_mm),
        Axes::Polar { radius_mm, sector_deg } => {
            (["sector_deg", "radius_mm"], radius_mm, sector_deg)
        }
    };
    let lines = map.values.indexed_iter().filter(|(_, value)| value.is_finite()).map(
        |((row, column), value)| {
            [middle(columns, column), middle(rows, row), *value, map.std_errors[[row, column]]]
                .map(|number| number.to_string())
        },
    );
    table(name, &[header[0], header[1], &value, &error], lines)
}

fn intensity_table(intensity: &IntensityTable) -> Result<OutputFile> {
    let unit = &intensity.unit;
    let header = [
        "c_from_deg".to_owned(),
        "c_to_deg".to_owned(),
        "gamma_from_deg".to_owned(),
        "gamma_to_deg".to_owned(),
        format!("intensity_{unit}"),
        format!("std_error_{unit}"),
    ];
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    let (c, gamma) = (&intensity.c_deg, &intensity.gamma_deg);
    let rows = intensity.values.indexed_iter().map(|((ring, sector), value)| {
        [
            c[sector],
            c[sector + 1],
            gamma[ring],
            gamma[ring + 1],
            *value,
            intensity.std_errors[[ring, sector]],
        ]
        .map(|number| number.to_string())
    });
    table(format!("{}.intensity.csv", intensity.sensor), &header, rows)
}

/// A table from a header and rows.
pub(crate) fn table<const N: usize>(
    name: String,
    header: &[&str],
    rows: impl Iterator<Item = [String; N]>,
) -> Result<OutputFile> {
    let failed = |reason: String| Error::Output { what: name.clone(), reason };
    let mut writer = Writer::from_writer(Vec::new());
    writer.write_record(header).map_err(|reason| failed(reason.to_string()))?;
    for row in rows {
        writer.write_record(&row).map_err(|reason| failed(reason.to_string()))?;
    }
    let bytes = writer.into_inner().map_err(|reason| failed(reason.to_string()))?;
    Ok(OutputFile { name, bytes })
}
