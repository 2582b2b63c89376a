//! Differences of maps, cell by cell. Maps are read from their tables: places, values and errors.

use crate::OutputFile;
use crate::cell_grid::{ANGLES, GridKind, INTENSITY, RINGS, SURFACE};
use crate::png::{AxisScale, ColourMap, HeatMap, MapCells, MapGeometry, MapPlaces, heat_map};
use csv::ReaderBuilder;
use lumiduct_base::error::Result;
use lumiduct_base::number::format_fixed;
use ndarray::Array2;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Probability that noise alone exceeds the bound of a map.
const FALSE_ALARM: f64 = 1e-3;
/// A cell is judged if its value and error correspond to at least this many counts: with fewer the
/// distribution of its value is too far from normal. Of 200 pairs of maps by noise alone, with 32 batches each, none was beyond
/// the bound (benches/results/2026-11-28.md).
const COUNTS: f64 = 128.0;
/// Share of the cells that may exceed the colour range of a picture, so that a few noisy ones do
/// not drown the others.
const BEYOND_COLOURS: f64 = 0.01;
/// Places closer than this share of the extent of a map are the same: machines round differently.
const SAME_PLACE: f64 = 1e-9;

/// A map as in its table.
#[derive(Debug, Clone)]
pub struct MapTable {
    pub(crate) name: String,
    pub(crate) kind: &'static GridKind,
    pub(crate) unit: String,
    /// Middles of the cells, mm or deg.
    places: Vec<[f64; 2]>,
    /// In `unit`.
    values: Vec<f64>,
    /// Standard error and bias together, in `unit`.
    errors: Vec<f64>,
    /// Number of batches from which the errors are computed; `None` if unknown.
    batches: Option<u64>,
}

impl MapTable {
    /// The table, with the number of batches from which its errors are computed.
    pub(crate) fn with_batches(self, batches: Option<u64>) -> Self {
        Self { batches, ..self }
    }

    /// Reads a table; `None` if it is not that of a map.
    pub(crate) fn parse(name: &str, text: &str) -> std::result::Result<Option<Self>, String> {
        let mut reader = ReaderBuilder::new().from_reader(text.as_bytes());
        let header = reader.headers().map_err(|reason| reason.to_string())?.clone();
        let header: Vec<&str> = header.iter().collect();
        let kinds = [&SURFACE, &ANGLES, &RINGS, &INTENSITY];
        let kind = kinds.into_iter().find(|kind| header.starts_with(kind.columns));
        let Some(kind) = kind else { return Ok(None) };
        let first = kind.columns.len();
        let unit = header.get(first + 1).and_then(|name| name.strip_prefix("std_error_"));
        let unit = unit.ok_or("there is no column of standard errors")?.to_owned();
        // The share of a cell on the sensor may follow too; it is no error.
        let bias = header.iter().skip(first).position(|name| name.starts_with("bias_"));
        let mut map = Self {
            name: name.to_owned(),
            kind,
            unit,
            places: Vec::new(),
            values: Vec::new(),
            errors: Vec::new(),
            batches: None,
        };
        for row in reader.records() {
            let row = row.map_err(|reason| reason.to_string())?;
            let numbers: Vec<f64> =
                row.iter().map(str::parse).collect::<std::result::Result<_, _>>().map_err(
                    |_| format!("`{}` are not numbers", row.iter().collect::<Vec<_>>().join(",")),
                )?;
            let (place, rest) = numbers.split_at(first);
            map.places.push(match place {
                [x, y] => [*x, *y],
                _ => [0.5 * (place[0] + place[1]), 0.5 * (place[2] + place[3])],
            });
            map.values.push(rest[0]);
            map.errors.push(rest[1].hypot(bias.map_or(0.0, |place| rest[place])));
        }
        Ok(Some(map))
    }

    /// Values and errors in rows and columns; NaN where there is no cell.
    pub(crate) fn cells(&self, scale: AxisScale) -> MapCells {
        let columns = lines(&self.places, 0);
        let rows = lines(&self.places, 1);
        let mut values = Array2::from_elem((rows.len(), columns.len()), f64::NAN);
        let mut errors = values.clone();
        let index = |lines: &[f64], at: f64| lines.partition_point(|line| *line < at);
        for (place, (value, error)) in self.places.iter().zip(self.values.iter().zip(&self.errors))
        {
            let at = [index(&rows, place[1]), index(&columns, place[0])];
            (values[at], errors[at]) = (*value, *error);
        }
        let [x, y] = [columns, rows].map(|middles| edges(&middles, scale));
        MapCells { x, y, values, errors, biases: None, colours: None }
    }

    /// Whether cells, quantity and unit equal those of another map.
    fn is_like(&self, other: &Self) -> bool {
        let largest = self.places.iter().flatten().fold(0.0f64, |most, at| most.max(at.abs()));
        let near = |a: f64, b: f64| (a - b).abs() <= SAME_PLACE * largest;
        let mut pairs = self.places.iter().zip(&other.places);
        (self.kind, &self.unit) == (other.kind, &other.unit)
            && self.places.len() == other.places.len()
            && pairs.all(|(a, b)| near(a[0], b[0]) && near(a[1], b[1]))
    }
}

/// The comparison of two maps of one name.
#[derive(Debug)]
pub struct MapDiff {
    /// Sensor and quantity: `exit.illuminance`.
    pub name: String,
    /// The outcome.
    pub outcome: MapOutcome,
}

/// The outcome of comparing two maps.
#[derive(Debug)]
pub enum MapOutcome {
    /// Their cells are not the same.
    OtherCells,
    /// Every cell was compared.
    Compared {
        /// Second map less the first, in its unit, at the places of the first.
        difference: MapTable,
        /// Cells that can be judged: both sides have enough counts.
        judged: usize,
        /// Root of the mean square of all z-scores, differences over their errors, 1; 1 for pure
        /// noise.
        rms: f64,
        /// Largest |z|, 1.
        largest: f64,
        /// What noise alone exceeds in at most one map of a thousand, 1.
        bound: f64,
    },
}

impl MapDiff {
    /// Whether noise alone may explain the difference; false for maps with different cells.
    pub(crate) fn is_noise(&self) -> bool {
        match &self.outcome {
            MapOutcome::OtherCells => false,
            MapOutcome::Compared { judged, largest, bound, .. } => *judged == 0 || largest <= bound,
        }
    }

    /// The line that reports a map.
    pub(crate) fn sentence(&self) -> String {
        let MapOutcome::Compared { difference, judged, rms, largest, bound } = &self.outcome else {
            return "its cells are not the same, so it is not compared".to_owned();
        };
        let all = difference.values.len();
        if *judged == 0 {
            return format!("none of {all} cells has enough counts to be judged");
        }
        let [rms, z, bound] = [(rms, 2), (largest, 1), (bound, 1)]
            .map(|(number, decimals)| format_fixed(*number, decimals));
        format!(
            "rms z {rms}, largest |z| {z}, below {bound} for noise alone; {judged} of {all} cells have enough counts"
        )
    }

    /// Name of the picture.
    pub(crate) fn picture_name(&self) -> String {
        format!("{}.difference.png", self.name)
    }
}

/// Compares maps of the same name.
pub(crate) fn compare(a: &[MapTable], b: &[MapTable]) -> Vec<MapDiff> {
    let partner = |own: &MapTable| b.iter().find(|other| other.name == own.name);
    let pairs = a.iter().filter_map(|own| Some((own, partner(own)?)));
    pairs
        .map(|(a, b)| MapDiff {
            name: a.name.clone(),
            outcome: if a.is_like(b) { difference(a, b) } else { MapOutcome::OtherCells },
        })
        .collect()
}

fn difference(a: &MapTable, b: &MapTable) -> MapOutcome {
    let pair = |own: &[f64], other: &[f64], f: fn(f64, f64) -> f64| -> Vec<f64> {
        own.iter().zip(other).map(|(own, other)| f(*own, *other)).collect()
    };
    let values = pair(&a.values, &b.values, |a, b| b - a);
    let errors = pair(&a.errors, &b.errors, f64::hypot);
    let has_counted = |map: &MapTable, cell: usize| {
        let counts = (map.values[cell] / map.errors[cell]).powi(2);
        counts.is_finite() && counts >= COUNTS
    };
    let scores: Vec<f64> = (0..values.len())
        .filter(|&cell| has_counted(a, cell) && has_counted(b, cell))
        .map(|cell| values[cell] / errors[cell])
        .collect();
    let count = scores.len() as f64;
    let rms = (scores.iter().map(|z| z * z).sum::<f64>() / count.max(1.0)).sqrt();
    let largest = scores.iter().fold(0.0f64, |most, z| most.max(z.abs()));
    let bound = bound(count.max(1.0), a.batches.into_iter().chain(b.batches).min());
    let difference = MapTable { values, errors, ..a.clone() };
    MapOutcome::Compared { difference, judged: scores.len(), rms, largest, bound }
}

/// What the largest |z| of `count` cells exceeds by noise alone in at most one map of a thousand: √(2 ln(n/0.001)) for normally
/// distributed noise; more by Student's distribution, for the map with fewer batches, where errors come from few.
fn bound(count: f64, batches: Option<u64>) -> f64 {
    let normal = (2.0 * (count / FALSE_ALARM).ln()).sqrt();
    let freedom = batches.map(|batches| batches.saturating_sub(1) as f64);
    let student = freedom.and_then(|freedom| StudentsT::new(0.0, 1.0, freedom).ok());
    let student = student.map(|law| -law.inverse_cdf(0.5 * FALSE_ALARM / count));
    student.map_or(normal, |student| student.max(normal))
}

/// Pictures of all maps that were compared.
pub(crate) fn pictures(maps: &[MapDiff]) -> Result<Vec<OutputFile>> {
    let mut files = Vec::new();
    for map in maps {
        if let MapOutcome::Compared { difference, .. } = &map.outcome {
            let bytes = heat_map(&drawn(map, difference))?;
            files.push(OutputFile { name: map.picture_name(), bytes });
        }
    }
    Ok(files)
}

/// The difference of a map for a picture or a page. Rings are unrolled.
pub(crate) fn drawn(map: &MapDiff, difference: &MapTable) -> HeatMap {
    let places = match difference.kind.places {
        rings @ MapPlaces { geometry: MapGeometry::Polar, .. } => MapPlaces {
            geometry: MapGeometry::Directions,
            labels: ["sector in deg", "radius in mm"],
            ..rings
        },
        others => others,
    };
    let limit = limit(&difference.values);
    HeatMap {
        title: format!("{}: difference B − A", map.name),
        subtitle: map.sentence(),
        quantity: "difference B − A".into(),
        unit: difference.unit.clone(),
        places,
        cells: difference.cells(places.geometry.scale()),
        colours: ColourMap::Diverging,
        limits: Some([-limit, limit]),
    }
}

/// The value at the upper end of the colours; its negative is at the lower end.
pub(crate) fn limit(values: &[f64]) -> f64 {
    let mut sizes: Vec<f64> =
        values.iter().filter(|value| value.is_finite()).map(|value| value.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let beyond = (BEYOND_COLOURS * sizes.len() as f64) as usize;
    let limit = sizes.len().checked_sub(beyond + 1).map_or(0.0, |place| sizes[place]);
    // Where hardly any cell differs, the range covers those that do.
    [Some(limit), sizes.last().copied()]
        .into_iter()
        .flatten()
        .find(|size| *size > 0.0)
        .unwrap_or(1.0)
}

/// The middles of all columns or rows, in ascending order.
fn lines(places: &[[f64; 2]], axis: usize) -> Vec<f64> {
    let mut lines: Vec<f64> = places.iter().map(|place| place[axis]).collect();
    lines.sort_by(f64::total_cmp);
    lines.dedup();
    lines
}

/// Edges of at least two cells from their middles: half way between them, with the first and last
/// cell as wide as their neighbours.
pub(crate) fn edges(middles: &[f64], scale: AxisScale) -> Vec<f64> {
    let [to, from]: [fn(f64) -> f64; 2] = match scale {
        AxisScale::Linear | AxisScale::Log => [|place| place, |place| place],
        AxisScale::Tangent => [|deg| deg.to_radians().tan(), |tan| tan.atan().to_degrees()],
    };
    match middles {
        [] => vec![0.0, 1.0],
        [only] => vec![only - 0.5, only + 0.5],
        [_, _, ..] => {
            let places: Vec<f64> = middles.iter().map(|place| to(*place)).collect();
            let last = places.len() - 1;
            let between = places.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
            let first = places[0] - 0.5 * (places[1] - places[0]);
            let end = places[last] + 0.5 * (places[last] - places[last - 1]);
            [first].into_iter().chain(between).chain([end]).map(from).collect()
        }
    }
}
