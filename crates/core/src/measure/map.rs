//! Maps of surface sensors: illuminance per cell, luminance per cell and view, or luminance per
//! pixel of an image, and their uniformity.

#[cfg(test)]
mod tests;

use crate::measure::cell_colours::CellColours;
use crate::measure::cells::SensorCells;
use crate::measure::evidence::Evidence;
use crate::measure::light::LightSelection;
use crate::measure::noisy::{Noisy, WeightedValue};
use crate::measure::uniformity::{Uniformity, UniformitySummary, ValueField, uniformity};
use crate::measure::{ColourTable, Measure, points};
use crate::scene::{Grid, Seeing, SensorId, SurfaceSensor};
use glam::DVec2;
use indexmap::IndexMap;
use ndarray::Array2;
use serde::Serialize;
use std::f64::consts::PI;

/// Values of a surface sensor, cell by cell.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SensorMap {
    /// Name of the sensor.
    pub sensor: String,
    /// View of a luminance sensor, from 0; `None` for all light, and for an image.
    pub view: Option<usize>,
    /// Light group whose light it shows; `None` for the light of all sources.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub light: Option<String>,
    /// Direction of a view: angle from the sensor's normal and azimuth from its local +x, deg.
    pub seen_from_deg: Option<[f64; 2]>,
    /// The mapped quantity, such as `illuminance`.
    pub quantity: String,
    /// Number of weathers whose light is summed; if there are several, they never shine together.
    pub weathers: usize,
    /// Its unit, such as `lx`.
    pub unit: String,
    /// Rows (v, or rings) by columns (u, or sectors), in `unit`; NaN outside the sensor.
    pub values: Array2<f64>,
    /// Standard errors, same layout.
    pub std_errors: Array2<f64>,
    /// Indicators of bias, same layout; `None` for unbiased estimates.
    pub biases: Option<Array2<f64>>,
    /// Colours of the cells, of all light, where it has spectra; they are tables of their own.
    #[serde(skip)]
    pub colours: Option<ColourTable>,
    /// The fraction of each cell that lies on the sensor, 1; 0 outside. Cells with at least half
    /// count individually for the extremes, others together with their neighbours along the rim.
    pub on_sensor: Array2<f64>,
    /// Where the cells are.
    pub axes: MapAxes,
    /// Area of the sensor, mm².
    pub area_mm2: f64,
    /// Extremes and uniformity.
    pub summary: UniformitySummary,
}

/// Positions of the cells of a map, on the unrolled face, or in the field of view of an image.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum MapAxes {
    /// Columns and rows.
    Cartesian {
        /// Edges of the columns, mm.
        u_mm: Vec<f64>,
        /// Edges of the rows, mm.
        v_mm: Vec<f64>,
    },
    /// Columns and rows of pixels of equal size in the tangents of their angles.
    Angular {
        /// Edges of the columns, deg to the right of the axis.
        u_deg: Vec<f64>,
        /// Edges of the rows, deg up from the axis.
        v_deg: Vec<f64>,
    },
    /// Rings and sectors.
    Polar {
        /// Edges of the rings, mm.
        radius_mm: Vec<f64>,
        /// Edges of the sectors, deg from +u.
        sector_deg: Vec<f64>,
    },
}

impl MapAxes {
    /// Unit of the width and height of a cell.
    pub fn unit(&self) -> &'static str {
        match self {
            Self::Cartesian { .. } | Self::Polar { .. } => "mm",
            Self::Angular { .. } => "deg",
        }
    }
}

/// Angle from the normal and azimuth from the local +x of a view of a flat sensor, deg.
fn seen_from(sensor: &SurfaceSensor, view: usize) -> Option<[f64; 2]> {
    match &sensor.seeing {
        Seeing::All | Seeing::Pixels(_) => None,
        Seeing::Views(views) => sensor.frame.map(|frame| {
            let local = frame.to_local(views.directions[view]);
            let aside = local.truncate();
            // Rounding gives the normal itself an azimuth.
            let azimuth = if aside.length() < 1e-9 { 0.0 } else { aside.y.atan2(aside.x) };
            [aside.length().atan2(local.z), azimuth].map(f64::to_degrees)
        }),
    }
}

/// The grid of a sensor's maps: of its cells, or of the pixels of its image.
pub(crate) fn map_grid(sensor: &SurfaceSensor) -> &Grid {
    match &sensor.seeing {
        Seeing::All | Seeing::Views(_) => &sensor.grid,
        Seeing::Pixels(pixels) => &pixels.grid,
    }
}

/// The map of some light on a surface sensor, or one for each view.
pub(crate) fn maps(
    evidence: &Evidence<'_>,
    id: SensorId,
    sensor: &SurfaceSensor,
    light: LightSelection,
) -> Vec<SensorMap> {
    let map = |view| map(evidence, id, sensor, light, view);
    match &sensor.seeing {
        Seeing::All | Seeing::Pixels(_) => vec![map(None)],
        Seeing::Views(views) => (0..views.directions.len()).map(|view| map(Some(view))).collect(),
    }
}

/// The map of a view, of an image, or of light from everywhere.
fn map(
    evidence: &Evidence<'_>,
    id: SensorId,
    sensor: &SurfaceSensor,
    light: LightSelection,
    view: Option<usize>,
) -> SensorMap {
    let unit = evidence.scene.unit;
    let (quantity, symbol) = match &sensor.seeing {
        Seeing::All => (unit.illuminance_name(), unit.illuminance()),
        Seeing::Views(_) | Seeing::Pixels(_) => (unit.luminance_name(), unit.luminance()),
    };
    let seen = SensorCells::of(evidence, id, sensor, light, view);
    let (columns, rows) = map_grid(sensor).shape();
    let table = |f: &dyn Fn(usize) -> f64| {
        Array2::from_shape_fn((rows, columns), |(row, column)| f(row * columns + column))
    };
    let read = |f: fn(Noisy) -> f64| {
        table(&|cell| if seen.is_on(cell) { f(seen.at(cell)) } else { f64::NAN })
    };
    SensorMap {
        sensor: evidence.scene.sensors[id.index()].name.clone(),
        view,
        light: light.name(evidence.scene).map(str::to_owned),
        seen_from_deg: view.and_then(|view| seen_from(sensor, view)),
        quantity: quantity.to_owned(),
        weathers: light.weathers(evidence.scene),
        unit: symbol.to_owned(),
        values: read(|cell| cell.value),
        std_errors: read(|cell| cell.std_error),
        biases: None,
        colours: None,
        on_sensor: table(&|cell| seen.cover(cell)),
        axes: axes(sensor),
        area_mm2: sensor.area(),
        summary: summary(evidence, sensor, &seen),
    }
}

/// Gives the maps of all light the colours of their cells; how even these are, by the last part of the names of these measures.
pub(crate) fn add_colours(
    evidence: &Evidence<'_>,
    id: SensorId,
    sensor: &SurfaceSensor,
    maps: &mut [SensorMap],
) -> IndexMap<String, Measure> {
    let mut out = IndexMap::new();
    let (columns, rows) = map_grid(sensor).shape();
    for map in maps.iter_mut().filter(|own| own.light.is_none()) {
        let first = map.view.unwrap_or(0) * columns * rows;
        let colours = CellColours::of(evidence, id, first..first + columns * rows);
        if let Some(colours) = colours.as_ref().filter(|_| columns * rows > 1) {
            let seen = SensorCells::of(evidence, id, sensor, LightSelection::All, map.view);
            let level = |cell| seen.is_full(cell).then(|| seen.at(cell));
            let levels: Vec<_> = (0..columns * rows).map(level).collect();
            let view = map.view.map_or(String::new(), |view| format!(".{view}"));
            let spread = colours.spread(evidence, &levels).into_iter();
            out.extend(spread.map(|(name, measure)| (format!("{name}{view}"), measure)));
        }
        map.colours = colours.map(|own| own.table(columns));
    }
    out
}

fn summary(
    evidence: &Evidence<'_>,
    sensor: &SurfaceSensor,
    seen: &SensorCells<'_>,
) -> UniformitySummary {
    let parts_of_it = seen.for_extremes();
    let field = ValueField {
        cells: &parts_of_it,
        avg: average(evidence, seen),
        counts: seen.counts_per_cell(parts_of_it.len()),
        batches: evidence.readings.batch_count(),
        is_dark: seen.is_dark,
    };
    let on_points = |points: Option<Vec<Vec<usize>>>| {
        let points = points?;
        points
            .iter()
            .flatten()
            .all(|&cell| seen.is_full(cell))
            .then(|| at_points(&points, seen, &field))
    };
    let grid = map_grid(sensor);
    let (all, cv) = uniformity(&field);
    UniformitySummary {
        cells: parts_of_it.len(),
        cell_size: cell_size(sensor),
        all,
        cv,
        nine: on_points(points::nine(grid)),
        thirteen: on_points(points::thirteen(grid)),
    }
}

/// Average over the sensor with its standard error: from groups of batches where scalars have the same light, otherwise from
/// cells, whose errors below rounding are unknown.
fn average(evidence: &Evidence<'_>, seen: &SensorCells<'_>) -> [f64; 2] {
    if seen.is_dark {
        return [0.0, 0.0];
    }
    if let Some(slots) = &seen.flux_slots {
        let mean = evidence.sum(slots, seen.factor / seen.area, "");
        return [mean.value, mean.std_error];
    }
    let mean = seen.mean(0..seen.areas.len());
    [mean.value, mean.std_error.max(evidence.rounding(mean.value))]
}

fn at_points(points: &[Vec<usize>], seen: &SensorCells<'_>, field: &ValueField<'_>) -> Uniformity {
    let read: Vec<Noisy> = points.iter().map(|cells| seen.mean(cells.iter().copied())).collect();
    let n = read.len() as f64;
    let sum: f64 = read.iter().map(|point| point.value).sum();
    // Points that read the same cells count once for the extremes, since their noise is the same.
    let mut distinct: Vec<WeightedValue> = Vec::new();
    let mut variance = 0.0;
    for (index, point) in read.iter().enumerate() {
        if !points[..index].contains(&points[index]) {
            let times = points.iter().filter(|cells| **cells == points[index]).count() as f64;
            variance += (times * point.std_error).powi(2);
            distinct.push(WeightedValue { read: *point, weight: times });
        }
    }
    uniformity(&ValueField { cells: &distinct, avg: [sum / n, variance.sqrt() / n], ..*field }).0
}

fn axes(sensor: &SurfaceSensor) -> MapAxes {
    let edges = |from: f64, to: f64, bins: usize| -> Vec<f64> {
        (0..=bins).map(|i| from + (to - from) * i as f64 / bins as f64).collect()
    };
    match map_grid(sensor) {
        Grid::Cartesian { rect, nu, nv } => {
            let u = edges(rect.min.x, rect.max.x, *nu);
            let v = edges(rect.min.y, rect.max.y, *nv);
            let angles = |tangents: Vec<f64>| -> Vec<f64> {
                tangents.into_iter().map(|tangent| tangent.atan().to_degrees()).collect()
            };
            match &sensor.seeing {
                Seeing::All | Seeing::Views(_) => MapAxes::Cartesian { u_mm: u, v_mm: v },
                Seeing::Pixels(_) => MapAxes::Angular { u_deg: angles(u), v_deg: angles(v) },
            }
        }
        Grid::Polar { radius, rings, sectors } => MapAxes::Polar {
            radius_mm: edges(0.0, *radius, *rings),
            sector_deg: edges(0.0, 360.0, *sectors),
        },
    }
}

/// Width and height of a cell, mm, or of a pixel in the middle of an image, deg.
fn cell_size(sensor: &SurfaceSensor) -> [f64; 2] {
    match map_grid(sensor) {
        Grid::Cartesian { rect, nu, nv } => {
            let size = (rect.max - rect.min) / DVec2::new(*nu as f64, *nv as f64);
            match &sensor.seeing {
                Seeing::All | Seeing::Views(_) => size.to_array(),
                Seeing::Pixels(_) => {
                    size.to_array().map(|tangent| 2.0 * (0.5 * tangent).atan().to_degrees())
                }
            }
        }
        Grid::Polar { radius, rings, sectors } => {
            // The mean radius of all rings is half the outer one.
            [radius / *rings as f64, PI * radius / *sectors as f64]
        }
    }
}
