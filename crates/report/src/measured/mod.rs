//! A measured map or luminaire beside the computed one of a report: alignment, scale, and what is left.
//!
//! Reading is [`compare_measured`]; the rest is pure. The measured values are taken as exact: no file states their errors. Nothing is
//! changed silently: the shift and the scale that were found are part of every format, and the differences are given without
//! them, too.

mod align;
mod computed;
mod figures;
mod intensities;
mod map_file;
mod page;
mod pictures;
mod resample;
mod sphere_cells;

pub use align::{FoundScale, FoundShift};
pub use figures::{DifferenceFigures, SideFigures};
pub use map_file::MatrixPlace;
pub(crate) use page::verdict;
pub use page::{measured_files, measured_text};

use crate::diff::{ComparedReport, Content, MapTable, read};
use crate::measured::align::{LEAST_COVER, MapPair};
use crate::measured::computed::{Comparable, ComputedCells, chosen};
use crate::measured::figures::{difference_figures, side_figures};
use crate::measured::intensities::{lamp_remark, measured_sphere, sphere_of};
use crate::measured::map_file::{comparable, expect_place, placed, refused};
use crate::measured::resample::coarsened;
use crate::measured::sphere_cells::sphere_of_cells;
use lumiduct_base::error::{Error, Result};
use lumiduct_base::number::format_percent;
use lumiduct_files::luminaire;
use lumiduct_files::measured::{
    self, MeasuredError, MeasuredGrid, MeasuredMap, MeasuredValues, StatedUnit,
};
use ndarray::{Array2, Axis, Slice};
use std::path::Path;

/// File name extensions of measured files.
const ENDINGS: [&str; 3] = ["ies", "ldt", "csv"];

/// How a measured file is compared.
#[derive(Debug, Clone, Default)]
pub struct MeasuredOptions {
    /// The sensor, or one of its tables, such as `exit.illuminance`.
    pub sensor: Option<String>,
    /// Size and direction of a plain matrix.
    pub place: MatrixPlace,
    /// Take the places of the file as they are.
    pub no_align: bool,
    /// Take the values of the file as they are.
    pub no_scale: bool,
    /// Largest rms difference after alignment and scale, over the largest computed cell, 1.
    pub limit: Option<f64>,
}

/// A computed map and the measured one.
#[derive(Debug)]
pub struct MeasuredDiff {
    /// Name of the scene.
    pub scene: String,
    /// Sensor and quantity: `exit.illuminance`.
    pub name: String,
    /// Facts of the report and of the measured file, a line each.
    pub facts: [String; 2],
    /// Unit of the values.
    pub unit: String,
    /// Sentences for the user.
    pub remarks: Vec<String>,
    /// The alignment.
    pub shift: FoundShift,
    /// The scale; `None` if it was not to be applied.
    pub scale: Option<FoundScale>,
    /// The differences as the file is.
    pub before: DifferenceFigures,
    /// The differences after alignment and scale.
    pub after: DifferenceFigures,
    /// Figures of the computed map and of the measured one as the file is.
    pub sides: [SideFigures; 2],
    /// Largest `rms_of_max` after alignment and scale, 1.
    pub limit: Option<f64>,
    /// The computed cells.
    pub(crate) computed: ComputedCells,
    /// Measured means over these cells: as the file is, and after alignment and division by the scale.
    pub(crate) measured: [Array2<f64>; 2],
}

impl MeasuredDiff {
    /// Whether the difference is within the limit; true without one.
    pub fn is_within(&self) -> bool {
        self.limit.is_none_or(|limit| self.after.rms_of_max <= limit)
    }
}

/// Whether a path has the name of a measured file, not of a folder.
pub fn is_measured(path: &Path) -> bool {
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    ENDINGS.contains(&ending.as_str()) && !path.is_dir()
}

/// Compares a table of the report in a folder with a measured file.
///
/// # Errors
///
/// [`Error::Usage`] if the folder holds no report of a run, the file is not usable, they do not fit, or several tables fit;
/// [`Error::Io`] if a file of the report cannot be read.
pub fn compare_measured(
    folder: &Path,
    file: &Path,
    options: &MeasuredOptions,
) -> Result<MeasuredDiff> {
    let report = read(folder)?;
    let Content::Run(files) = &report.content else {
        let folder = folder.display();
        return Err(Error::Usage(format!(
            "{folder} holds the results of a study; a measured file is compared with the report of a run"
        )));
    };
    let mut remarks = Vec::new();
    let ending = file.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let (computed, grid) = if ending == "csv" {
        read_map(file, &files.maps, options, &mut remarks)?
    } else {
        let sources = files.measures.get("balance.emitted").map(|own| own.value);
        read_luminaire(file, &files.maps, sources, options, &mut remarks)?
    };
    let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    compared(&report, computed, &grid, &name, options, remarks)
}

fn read_map(
    file: &Path,
    tables: &[MapTable],
    options: &MeasuredOptions,
    remarks: &mut Vec<String>,
) -> Result<(ComputedCells, MeasuredGrid)> {
    let refuse = |error| refused(file, error);
    let MeasuredMap { values, unit, remarks: assumed } = measured::read(file).map_err(refuse)?;
    expect_place(&values, options.place).map_err(refuse)?;
    let table = chosen(tables, comparable(&values), options.sensor.as_deref())?;
    let computed = ComputedCells::of(table);
    let plain = |unit: &str| unit.trim().to_lowercase().replace('²', "2").replace(' ', "");
    match &unit {
        Some(StatedUnit { unit, line }) if plain(unit) != plain(&computed.unit) => {
            let why = format!(
                "the values are in `{unit}`, but {} is in {}; convert them, correct the unit here, or name another sensor with --sensor",
                computed.name, computed.unit
            );
            return Err(refuse(MeasuredError::of_line(*line, why)));
        }
        Some(_) => {}
        None => {
            let unit = &computed.unit;
            remarks
                .push(format!("the measured file gives no unit; its values are taken as {unit}"));
        }
    }
    remarks.extend(assumed);
    let grid = match values {
        MeasuredValues::Surface(grid) | MeasuredValues::Image(grid) => {
            coarsened(&grid, computed.edges())
        }
        MeasuredValues::Matrix(matrix) => {
            let mut grid = placed(matrix, options.place).map_err(refuse)?;
            let middle = computed.edges().map(|edges| 0.5 * (edges[0] + edges[edges.len() - 1]));
            grid.x.iter_mut().for_each(|edge| *edge += middle[0]);
            grid.y.iter_mut().for_each(|edge| *edge += middle[1]);
            remarks
                .push("the middle of the matrix is taken as the middle of the sensor".to_owned());
            coarsened(&grid, computed.edges())
        }
        MeasuredValues::Sphere(cells) => sphere_of_cells(&cells, &computed),
        MeasuredValues::Directions(own) => sphere_of(|c, gamma| own.at(c, gamma), &computed),
    };
    Ok((computed, grid))
}

fn read_luminaire(
    file: &Path,
    tables: &[MapTable],
    sources_lm: Option<f64>,
    options: &MeasuredOptions,
    remarks: &mut Vec<String>,
) -> Result<(ComputedCells, MeasuredGrid)> {
    let MatrixPlace { width_mm, height_mm, first_row } = options.place;
    if (width_mm, height_mm, first_row) != (None, None, None) {
        return Err(Error::Usage(
            "--width-mm, --height-mm and --rows are for a plain matrix of numbers, not for a luminaire".to_owned(),
        ));
    }
    let own = luminaire::read(file)
        .map_err(|error| Error::Usage(format!("{}: {error}", file.display())))?;
    let table = chosen(tables, Comparable::Intensities, options.sensor.as_deref())?;
    let computed = ComputedCells::of(table);
    if computed.unit != "cd" {
        return Err(Error::Usage(format!(
            "{} is in {}, but luminaire files are in cd; run the scene in photometric units",
            computed.name, computed.unit
        )));
    }
    remarks.extend(own.remarks);
    remarks.extend(lamp_remark(own.luminaire.lamps, sources_lm));
    let grid = measured_sphere(&own.luminaire.intensities, &computed);
    Ok((computed, grid))
}

/// Aligns, scales and compares.
fn compared(
    report: &ComparedReport,
    computed: ComputedCells,
    grid: &MeasuredGrid,
    file: &str,
    options: &MeasuredOptions,
    mut remarks: Vec<String>,
) -> Result<MeasuredDiff> {
    let pair = MapPair { grid, computed: &computed };
    let as_read = pair.measured([0.0; 2]);
    let cover = pair.cover(&as_read);
    if cover.is_nan() || cover < LEAST_COVER {
        return Err(Error::Usage(format!(
            "{file} covers {} of {}, at least {} are needed; check its size and places, and whether values are missing",
            format_percent(if cover.is_nan() { 0.0 } else { cover }),
            computed.name,
            format_percent(LEAST_COVER)
        )));
    }
    remarks.extend(left_out_remark(&computed, &as_read));
    let wanted = !options.no_align;
    let shift = pair.align([wanted, wanted && !computed.is_intensity()], &mut remarks);
    let aligned = pair.measured(shift.value);
    let found = pair.scale(&aligned).ok_or_else(|| {
        Error::Usage(format!("{file} and {} have no light in common", computed.name))
    })?;
    remarks.splice(0..0, turned_remark(&pair, &[&as_read, &aligned], shift.value));
    let scale = (!options.no_scale).then_some(found);
    let factor = scale.map_or(1.0, |scale| scale.value);
    let values = &computed.cells.values;
    Ok(MeasuredDiff {
        scene: report.name.clone(),
        name: computed.name.clone(),
        facts: [report.facts.clone(), facts_of(grid, &computed, file)],
        unit: computed.unit.clone(),
        remarks,
        shift,
        scale,
        before: difference_figures(&computed, &as_read, 1.0),
        after: difference_figures(&computed, &aligned, factor),
        sides: [values, &as_read].map(|own| side_figures(&computed, own, &as_read)),
        limit: options.limit,
        measured: [as_read, aligned / factor],
        computed,
    })
}

/// A remark on computed cells without a measured value: cells missing in the file, or beyond it.
fn left_out_remark(computed: &ComputedCells, as_read: &Array2<f64>) -> Option<String> {
    let pairs = computed.cells.values.iter().zip(as_read);
    let measured: Vec<f64> = pairs.filter(|(own, _)| own.is_finite()).map(|(_, m)| *m).collect();
    let missing = measured.iter().filter(|value| value.is_nan()).count();
    (missing > 0).then(|| {
        let verbs = if missing == 1 { ["has", "is"] } else { ["have", "are"] };
        format!(
            "{missing} of {} cells of {} {} no measured value for a part or all of the cell, and {} left out",
            measured.len(),
            computed.name,
            verbs[0],
            verbs[1]
        )
    })
}

fn facts_of(grid: &MeasuredGrid, computed: &ComputedCells, file: &str) -> String {
    if computed.is_intensity() {
        return file.to_owned();
    }
    let (rows, columns) = grid.values.dim();
    format!("{file}, read as {columns} by {rows} values")
}

/// A remark where the measured map would fit much better mirrored or turned.
fn turned_remark(
    pair: &MapPair<'_>,
    [as_read, aligned]: &[&Array2<f64>; 2],
    shift: [f64; 2],
) -> Option<String> {
    /// Share of the mismatch that has to go.
    const BETTER: f64 = 0.5;
    /// Mismatch that is no reason for a remark, 1.
    const SMALL: f64 = 1e-3;
    let flipped = |axes: &[usize]| {
        let mut grid = pair.grid.clone();
        for axis in axes {
            grid.values.slice_axis_inplace(Axis(*axis), Slice::new(0, None, -1));
        }
        pair.loss(&MapPair { grid: &grid, ..*pair }.measured([0.0; 2]))
    };
    let others: Vec<(f64, String)> = if pair.computed.is_intensity() {
        let turned = |degrees: f64| {
            let loss = pair.loss(&pair.measured([shift[0] + degrees, 0.0]));
            (loss, format!("turned by a further {degrees}° about the axis C"))
        };
        [90.0, 180.0, 270.0].map(turned).to_vec()
    } else {
        let ways = [
            (&[0][..], "upside down"),
            (&[1], "with left and right exchanged"),
            (&[0, 1], "turned by 180°"),
        ];
        ways.map(|(axes, words)| (flipped(axes), words.to_owned())).to_vec()
    };
    // Turned maps of images and surfaces are not shifted, so that this one is not either.
    let own = pair.loss(if pair.computed.is_intensity() { aligned } else { as_read });
    let (loss, words) = others.into_iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
    (own > SMALL && loss < BETTER * own && loss < pair.loss(aligned)).then(|| {
        format!(
            "the measured values would fit much better {words}: check the directions of the axes"
        )
    })
}

#[cfg(test)]
mod tests;
