//! `SENSOR.npz`: the maps and intensities of a sensor as arrays that numpy reads, units in their names.

use crate::cell_grid::CellGrid;
use crate::csv::{intensity_name, map_name};
use crate::{OutputFile, Report};
use lumiduct_base::error::{Error, Result};
use lumiduct_core::measure::Measures;
use ndarray::Array2;
use std::io::{Cursor, Write};
use zip::ZipWriter;
use zip::result::ZipResult;
use zip::write::SimpleFileOptions;

/// A file for each sensor with more than one cell.
pub(crate) fn files(report: &Report) -> Result<Vec<OutputFile>> {
    let measures = &report.measures;
    let mut files = Vec::new();
    for paths in &measures.sensor_paths {
        let grids = grids(measures, &paths.sensor);
        if !grids.is_empty() {
            let name = format!("{}.npz", paths.sensor);
            let bytes = arrays(&grids).map_err(|reason| Error::Output {
                what: name.clone(),
                reason: reason.to_string(),
            })?;
            files.push(OutputFile { name, bytes });
        }
    }
    Ok(files)
}

/// The grids of a sensor, each with the first part of the names of its arrays.
fn grids<'a>(measures: &'a Measures, sensor: &str) -> Vec<(String, CellGrid<'a>)> {
    let prefix = format!("{sensor}.");
    let own = |name: String| name.strip_prefix(&prefix).unwrap_or(&name).to_owned();
    let maps = measures.maps.iter().filter(|map| map.sensor == sensor && map.values.len() > 1);
    let maps = maps.map(|map| (own(map_name(map)), map.into()));
    let tables = measures.intensities.iter().filter(|table| table.sensor == sensor);
    let tables = tables.map(|table| (own(intensity_name(table)), table.into()));
    maps.chain(tables).collect()
}

/// All arrays. Edges and shares are those of the first grid, as all grids of a sensor have the same.
fn arrays(grids: &[(String, CellGrid<'_>)]) -> ZipResult<Vec<u8>> {
    let mut out = Arrays(ZipWriter::new(Cursor::new(Vec::new())));
    if let Some((_, CellGrid { kind, x, y, values, on_sensor, .. })) = grids.first() {
        for ((head, unit), edges) in kind.heads.iter().zip(kind.places.units).zip([x, y]) {
            out.add(&format!("{head}_edges_{unit}"), &format!("{},", edges.len()), *edges)?;
        }
        if let Some(shares) = on_sensor {
            out.add("on_sensor", &shape(values), *shares)?;
        }
    }
    for (name, grid) in grids {
        let (shape, unit) = (shape(grid.values), plain(grid.unit));
        out.add(&format!("{name}_{unit}"), &shape, grid.values)?;
        out.add(&format!("{name}.std_error_{unit}"), &shape, grid.std_errors)?;
        if let Some(biases) = grid.biases {
            out.add(&format!("{name}.bias_{unit}"), &shape, biases)?;
        }
        for (head, values) in grid.colour_columns() {
            out.add(&format!("{name}.{head}"), &shape, values)?;
        }
    }
    Ok(out.0.finish()?.into_inner())
}

/// Length of the header of an array, bytes: all before the numbers is a multiple of 64.
const HEADER: usize = 118;

/// An archive of arrays: each a file in NPY format 1.0 (numpy enhancement proposal 1).
struct Arrays(ZipWriter<Cursor<Vec<u8>>>);

impl Arrays {
    /// Adds an array of this shape, row by row.
    fn add<'a>(
        &mut self,
        name: &str,
        shape: &str,
        numbers: impl IntoIterator<Item = &'a f64>,
    ) -> ZipResult<()> {
        // Without a time of its own an entry has the first day of 1980.
        self.0.start_file(format!("{name}.npy"), SimpleFileOptions::default())?;
        let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({shape}), }}");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((HEADER as u16).to_le_bytes());
        bytes.extend(format!("{header:<width$}\n", width = HEADER - 1).bytes());
        bytes.extend(numbers.into_iter().flat_map(|number| number.to_le_bytes()));
        self.0.write_all(&bytes)?;
        Ok(())
    }
}

fn shape(values: &Array2<f64>) -> String {
    let (rows, columns) = values.dim();
    format!("{rows}, {columns}")
}

/// A unit without letters that file names and programs may not have: `cd_per_m2`.
fn plain(unit: &str) -> String {
    unit.replace('/', "_per_").replace('²', "2")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read;
    use zip::ZipArchive;

    #[test]
    fn an_array_has_the_header_of_numpy_and_no_time() {
        let mut out = Arrays(ZipWriter::new(Cursor::new(Vec::new())));
        out.add("illuminance_lx", "2, 3", &[1.0, 2.0, 3.0, 4.0, 5.0, 6.5]).unwrap();
        let bytes = out.0.finish().unwrap().into_inner();
        let mut archive = ZipArchive::new(Cursor::new(bytes)).unwrap();
        let mut file = archive.by_name("illuminance_lx.npy").unwrap();
        assert_eq!(file.last_modified().map(|time| time.year()), Some(1980));
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).unwrap();
        assert_eq!(&bytes[..10], b"\x93NUMPY\x01\x00\x76\x00");
        let (head, numbers) = bytes.split_at(128);
        let head = std::str::from_utf8(&head[10..]).unwrap();
        assert!(head.starts_with("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), } "));
        assert!(head.ends_with(" \n"), "{head:?}");
        let numbers: Vec<f64> =
            numbers.as_chunks::<8>().0.iter().map(|own| f64::from_le_bytes(*own)).collect();
        assert_eq!(numbers, [1.0, 2.0, 3.0, 4.0, 5.0, 6.5]);
    }

    #[test]
    fn units_are_plain_words() {
        assert_eq!(
            ["lx", "cd/m²", "W/m²", "W/sr"].map(plain),
            ["lx", "cd_per_m2", "W_per_m2", "W_per_sr"]
        );
    }
}
