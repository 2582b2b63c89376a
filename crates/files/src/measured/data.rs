//! Measured values and their places.

use crate::measured::directions::MeasuredDirections;
use ndarray::Array2;

/// A measured map or distribution of intensity.
#[derive(Debug)]
pub struct MeasuredMap {
    /// Its values and their places.
    pub values: MeasuredValues,
    /// Unit of its values, where the file gives one.
    pub unit: Option<StatedUnit>,
    /// What was assumed.
    pub remarks: Vec<String>,
}

/// A unit that a comment, or the name of a column, gives.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StatedUnit {
    /// The unit, such as `lx` or `cd/m²`.
    pub unit: String,
    /// The line of the comment or of the name, from 1.
    pub line: usize,
}

/// Values by the places that a file gives.
#[derive(Debug)]
pub enum MeasuredValues {
    /// Numbers alone, whose size the file may give.
    Matrix(PlainMatrix),
    /// Cells at u and v, mm.
    Surface(MeasuredGrid),
    /// Cells of an image, deg.
    Image(MeasuredGrid),
    /// Cells of a goniometer, once around C, deg.
    Sphere(MeasuredGrid),
    /// Intensities in single directions.
    Directions(MeasuredDirections),
}

impl MeasuredValues {
    /// Whether any value is above 0.
    pub(crate) fn has_light(&self) -> bool {
        match self {
            Self::Matrix(PlainMatrix { values, .. }) => values.iter().any(|value| *value > 0.0),
            Self::Surface(grid) | Self::Image(grid) | Self::Sphere(grid) => {
                grid.values.iter().any(|value| *value > 0.0)
            }
            Self::Directions(own) => own.peak() > 0.0,
        }
    }
}

/// Values over a rectangle, `[[row, column]]`, rows upwards.
#[derive(Debug, Clone)]
pub struct MeasuredGrid {
    /// Edges of the columns, ascending.
    pub x: Vec<f64>,
    /// Edges of the rows, ascending.
    pub y: Vec<f64>,
    /// Values; NaN where nothing was measured.
    pub values: Array2<f64>,
}

/// Numbers alone.
#[derive(Debug, Clone)]
pub struct PlainMatrix {
    /// Values, `[[row, column]]`, in the order of the file; NaN where nothing was measured.
    pub values: Array2<f64>,
    /// Width along u, where a comment gives it.
    pub width: Option<StatedSize>,
    /// Height along v, where a comment gives it.
    pub height: Option<StatedSize>,
    /// The side of the first row, where a comment gives it.
    pub first_row: Option<StatedFirstRow>,
}

/// A size that a comment gives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StatedSize {
    /// The size, mm, above 0.
    pub size_mm: f64,
    /// The line of the comment, from 1.
    pub line: usize,
}

/// A side of the first row that a comment gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StatedFirstRow {
    /// The side.
    pub side: FirstRow,
    /// The line of the comment, from 1.
    pub line: usize,
}

/// Which side of a plain matrix its first row is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FirstRow {
    /// The top, where v is largest, as in a picture.
    Top,
    /// The bottom, where v is smallest.
    Bottom,
}

impl PlainMatrix {
    /// Cells of one size around zero, of this width and height, mm.
    pub fn centred(self, size_mm: [f64; 2], first_row: FirstRow) -> MeasuredGrid {
        let mut values = self.values;
        if first_row == FirstRow::Top {
            values.invert_axis(ndarray::Axis(0));
        }
        let (rows, columns) = values.dim();
        let [x, y] = [(size_mm[0], columns), (size_mm[1], rows)].map(|(size, count)| {
            (0..=count).map(|edge| size * (edge as f64 / count as f64 - 0.5)).collect()
        });
        MeasuredGrid { x, y, values }
    }
}
