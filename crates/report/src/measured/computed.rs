//! The map or the intensities of a report that a measured file is compared with.

use crate::cell_grid::{ANGLES, GridKind, INTENSITY, RINGS, SURFACE};
use crate::diff::MapTable;
use crate::png::{AxisScale, MapCells};
use lumiduct_base::error::{Error, Result};
use ndarray::Array2;

/// Computed cells.
#[derive(Debug)]
pub(crate) struct ComputedCells {
    /// Sensor and quantity: `exit.illuminance`.
    pub(crate) name: String,
    /// What their places are called.
    pub(crate) kind: &'static GridKind,
    /// Unit of the values.
    pub(crate) unit: String,
    /// Edges, values, and standard errors and biases together.
    pub(crate) cells: MapCells,
    /// Area of each cell on the axes, or its solid angle, sr.
    pub(crate) sizes: Array2<f64>,
}

impl ComputedCells {
    /// The cells of a table.
    pub(crate) fn of(table: &MapTable) -> Self {
        let mut cells = table.cells(AxisScale::Linear);
        let is_intensity = *table.kind == INTENSITY;
        if is_intensity && cells.x.len() == 2 {
            cells.x = vec![0.0, 360.0];
        }
        let widths: Vec<f64> = cells.x.windows(2).map(|ends| ends[1] - ends[0]).collect();
        let heights: Vec<f64> = cells
            .y
            .windows(2)
            .map(|ends| {
                let [from, to] = [ends[0], ends[1]].map(f64::to_radians);
                if is_intensity { (from.cos() - to.cos()).to_radians() } else { ends[1] - ends[0] }
            })
            .collect();
        let sizes = Array2::from_shape_fn(cells.values.dim(), |at| heights[at.0] * widths[at.1]);
        let (name, unit) = (table.name.clone(), table.unit.clone());
        Self { name, kind: table.kind, unit, cells, sizes }
    }

    /// Whether these are luminous intensities, whose angle C closes a circle.
    pub(crate) fn is_intensity(&self) -> bool {
        *self.kind == INTENSITY
    }

    /// The edges of columns and rows.
    pub(crate) fn edges(&self) -> [&[f64]; 2] {
        [&self.cells.x, &self.cells.y]
    }
}

/// What a measured file can be compared with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Comparable {
    /// Intensities of goniometers.
    Intensities,
    /// Maps with places in mm.
    Surfaces,
    /// Maps with places in degrees.
    Images,
}

impl Comparable {
    fn kind(self) -> &'static GridKind {
        match self {
            Self::Intensities => &INTENSITY,
            Self::Surfaces => &SURFACE,
            Self::Images => &ANGLES,
        }
    }

    fn words(self) -> &'static str {
        match self {
            Self::Intensities => "intensities of a goniometer",
            Self::Surfaces => "map with places in mm",
            Self::Images => "map with places in degrees",
        }
    }
}

/// The table of a report that fits; `sensor` is a sensor, or a table such as `exit.illuminance`.
///
/// # Errors
///
/// [`Error::Usage`] if no table fits or several do, with their names.
pub(crate) fn chosen<'a>(
    tables: &'a [MapTable],
    what: Comparable,
    sensor: Option<&str>,
) -> Result<&'a MapTable> {
    let words = what.words();
    let fitting: Vec<&MapTable> = tables.iter().filter(|own| own.kind == what.kind()).collect();
    let names = |tables: &[&MapTable]| -> String {
        tables.iter().map(|table| table.name.as_str()).collect::<Vec<_>>().join(", ")
    };
    if fitting.is_empty() {
        let all: Vec<&MapTable> = tables.iter().collect();
        let rings = if all.iter().any(|table| *table.kind == RINGS) {
            "; maps of rings are not compared"
        } else {
            ""
        };
        let all = if all.is_empty() { "no maps".to_owned() } else { names(&all) };
        return Err(Error::Usage(format!("the report has no {words}: it has {all}{rings}")));
    }
    if let Some(table) = fitting.iter().find(|table| Some(table.name.as_str()) == sensor) {
        return Ok(table);
    }
    // Light groups are compared only by name.
    let is_wanted = |table: &&&MapTable| {
        let mut parts = table.name.split('.');
        let is_sensor = sensor.is_none_or(|sensor| parts.next() == Some(sensor));
        is_sensor && !table.name.contains(".from_")
    };
    let wanted: Vec<&MapTable> = fitting.iter().filter(is_wanted).copied().collect();
    match wanted[..] {
        [only] => Ok(only),
        [] => Err(Error::Usage(format!(
            "--sensor {}: the report has no such {words}; it has {}",
            sensor.unwrap_or_default(),
            names(&fitting)
        ))),
        [_, _, ..] => Err(Error::Usage(format!(
            "the report has several of this kind ({words}); name one with --sensor: {}",
            names(&wanted)
        ))),
    }
}
