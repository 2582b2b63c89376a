//! A map of a sensor or the intensity of a goniometer as a grid of cells: one description for
//! tables, spreadsheets, pictures and pages.

use crate::png::{MapCells, MapGeometry, MapPlaces};
use lumiduct_core::measure::{IntensityTable, MapAxes, SensorMap, not_below_zero};
use ndarray::Array2;

/// What the coordinates of a grid are called.
#[derive(Debug, PartialEq)]
pub(crate) struct GridKind {
    /// The first columns of its table: middles of a cell, or from and to of both coordinates.
    pub(crate) columns: &'static [&'static str],
    /// Both coordinates in a spreadsheet.
    pub(crate) heads: [&'static str; 2],
    /// Whether the last row of a spreadsheet is on top, as in a picture.
    pub(crate) is_rising: bool,
    /// The coordinates in pictures and on pages.
    pub(crate) places: MapPlaces,
}

pub(crate) const SURFACE: GridKind = GridKind {
    columns: &["u_mm", "v_mm"],
    heads: ["u", "v"],
    is_rising: true,
    places: MapPlaces {
        geometry: MapGeometry::Cartesian,
        labels: ["u in mm", "v in mm"],
        names: ["u", "v"],
        units: ["mm", "mm"],
    },
};
pub(crate) const ANGLES: GridKind = GridKind {
    columns: &["u_deg", "v_deg"],
    heads: ["right", "up"],
    is_rising: true,
    places: MapPlaces {
        geometry: MapGeometry::Angular,
        labels: ["to the right in deg", "up in deg"],
        names: ["to the right", "up"],
        units: ["deg", "deg"],
    },
};
pub(crate) const RINGS: GridKind = GridKind {
    columns: &["sector_deg", "radius_mm"],
    heads: ["sector", "radius"],
    is_rising: false,
    places: MapPlaces {
        geometry: MapGeometry::Polar,
        labels: ["u in mm", "v in mm"],
        names: ["azimuth", "radius"],
        units: ["deg", "mm"],
    },
};
pub(crate) const INTENSITY: GridKind = GridKind {
    columns: &["c_from_deg", "c_to_deg", "gamma_from_deg", "gamma_to_deg"],
    heads: ["c", "gamma"],
    is_rising: false,
    places: MapPlaces {
        geometry: MapGeometry::Directions,
        labels: ["C in deg", "γ in deg"],
        names: ["C", "γ"],
        units: ["deg", "deg"],
    },
};

/// Values of cells, `[[row, column]]`, with the edges of rows and columns.
pub(crate) struct CellGrid<'a> {
    pub(crate) kind: &'static GridKind,
    pub(crate) quantity: &'a str,
    pub(crate) unit: &'a str,
    /// Edges of the columns.
    pub(crate) x: &'a [f64],
    /// Edges of the rows.
    pub(crate) y: &'a [f64],
    pub(crate) values: &'a Array2<f64>,
    pub(crate) std_errors: &'a Array2<f64>,
    pub(crate) biases: Option<&'a Array2<f64>>,
    /// Share of each cell on the sensor, 1.
    pub(crate) on_sensor: Option<&'a Array2<f64>>,
}

impl<'a> From<&'a SensorMap> for CellGrid<'a> {
    fn from(map: &'a SensorMap) -> Self {
        let (kind, x, y) = match &map.axes {
            MapAxes::Cartesian { u_mm, v_mm } => (&SURFACE, u_mm, v_mm),
            MapAxes::Angular { u_deg, v_deg } => (&ANGLES, u_deg, v_deg),
            MapAxes::Polar { radius_mm, sector_deg } => (&RINGS, sector_deg, radius_mm),
        };
        Self {
            kind,
            quantity: &map.quantity,
            unit: &map.unit,
            x,
            y,
            values: &map.values,
            std_errors: &map.std_errors,
            biases: map.biases.as_ref(),
            on_sensor: Some(&map.on_sensor),
        }
    }
}

impl<'a> From<&'a IntensityTable> for CellGrid<'a> {
    fn from(table: &'a IntensityTable) -> Self {
        Self {
            kind: &INTENSITY,
            quantity: "intensity",
            unit: &table.unit,
            x: &table.c_deg,
            y: &table.gamma_deg,
            values: &table.values,
            std_errors: &table.std_errors,
            biases: table.biases.as_ref(),
            on_sensor: None,
        }
    }
}

impl CellGrid<'_> {
    /// The cells for pictures and pages, which show no light below zero.
    pub(crate) fn cells(&self) -> MapCells {
        MapCells {
            x: self.x.to_vec(),
            y: self.y.to_vec(),
            values: self.values.mapv(not_below_zero),
            errors: self.std_errors.clone(),
            biases: self.biases.cloned(),
        }
    }
}
