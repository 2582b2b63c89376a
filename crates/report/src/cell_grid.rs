//! A map of a sensor or the intensity of a goniometer as a grid of cells: one description for
//! tables, spreadsheets, pictures and pages.

use crate::png::{MapCells, MapColours, MapGeometry, MapPlaces};
use glam::DVec3;
use lumiduct_core::colour::Chromaticity;
use lumiduct_core::measure::{ColourTable, IntensityTable, MapAxes, SensorMap, not_below_zero};
use ndarray::{Array2, Zip};

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
    /// Chromaticities, where light has a colour.
    pub(crate) colours: Option<&'a ColourTable>,
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
            colours: map.colours.as_ref(),
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
            colours: table.colours.as_ref(),
            on_sensor: None,
        }
    }
}

impl<'a> CellGrid<'a> {
    /// Chromaticities and their errors with their names in tables; none without colours.
    pub(crate) fn colour_columns(&self) -> impl Iterator<Item = (&'static str, &'a Array2<f64>)> {
        let columns = self.colours.map(|own| {
            [
                ("colour_u", &own.u),
                ("colour_v", &own.v),
                ("colour_u.std_error", &own.u_std_errors),
                ("colour_v.std_error", &own.v_std_errors),
            ]
        });
        columns.into_iter().flatten()
    }

    /// The cells for pictures and pages, which show no light below zero.
    pub(crate) fn cells(&self) -> MapCells {
        MapCells {
            x: self.x.to_vec(),
            y: self.y.to_vec(),
            values: self.values.mapv(not_below_zero),
            errors: self.std_errors.clone(),
            biases: self.biases.cloned(),
            colours: self.colours.map(|colours| MapColours {
                stimuli: stimuli(self.values, colours),
                uv_errors: Some([colours.u_std_errors.clone(), colours.v_std_errors.clone()]),
            }),
        }
    }
}

/// Tristimulus values of cells from their chromaticities, with Y in the unit of their values; dark cells have none, and those outside of the
/// sensor are NaN.
fn stimuli(values: &Array2<f64>, colours: &ColourTable) -> Array2<DVec3> {
    Zip::from(values).and(&colours.u).and(&colours.v).map_collect(|&value, &u, &v| {
        if value <= 0.0 || (value.is_finite() && v.is_nan()) {
            return DVec3::ZERO;
        }
        DVec3::from_array(Chromaticity::from_uv_1976([u, v]).tristimulus(value))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn stimuli_have_their_chromaticity_and_value() {
        let u = array![[0.2, f64::NAN, f64::NAN]];
        let v = array![[0.5, f64::NAN, f64::NAN]];
        let colours = ColourTable { u_std_errors: u.clone(), v_std_errors: v.clone(), u, v };
        let found = stimuli(&array![[3.0, 0.0, f64::NAN]], &colours);
        let colour = Chromaticity::from_tristimulus(found[[0, 0]].to_array()).unwrap();
        let [u, v] = colour.uv_1976();
        assert!((u - 0.2).abs() < 1e-12 && (v - 0.5).abs() < 1e-12);
        assert!((found[[0, 0]].y - 3.0).abs() < 1e-12);
        assert_eq!(found[[0, 1]], DVec3::ZERO);
        assert!(found[[0, 2]].is_nan());
    }
}
