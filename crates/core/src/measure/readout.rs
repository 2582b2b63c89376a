//! The values read from the maps of a sensor: extremes, uniformity, the middle, and single cells
//! and rings by name; cells and rings for all light only.

use crate::measure::cells::SensorCells;
use crate::measure::evidence::{Evidence, status_by_error};
use crate::measure::light::LightSelection;
use crate::measure::map::{SensorMap, map_grid};
use crate::measure::noisy::Noisy;
use crate::measure::uniformity::Statistic;
use crate::measure::{Measure, Status, points};
use crate::scene::{Grid, Seeing, SensorId, SurfaceSensor};
use indexmap::IndexMap;

/// Cells and rings have their own names up to this number.
const NAMED_CELLS: usize = 100;

/// The values read from the maps of some light on a sensor, by the last part of their dotted names.
pub(crate) fn measures(
    evidence: &Evidence<'_>,
    id: SensorId,
    sensor: &SurfaceSensor,
    light: LightSelection,
    maps: &[SensorMap],
) -> IndexMap<String, Measure> {
    let mut out = IndexMap::new();
    let from = light.suffix(evidence.scene);
    for map in maps {
        let view = map.view.map_or(String::new(), |view| format!(".{view}"));
        let seen = SensorCells::of(evidence, id, sensor, light, map.view);
        let mut add = |name: &str, measure| {
            out.insert(format!("{name}{view}{from}"), measure);
        };
        summary_measures(evidence, &sensor.seeing, map, &mut add);
        let middle = points::center(map_grid(sensor));
        if middle.iter().any(|&cell| seen.is_on(cell)) {
            let center = if seen.is_dark {
                evidence.no_light(&map.unit)
            } else {
                cell_measure(evidence, map, seen.mean(middle))
            };
            add(&format!("{}_center", map.quantity), center);
        }
        match light {
            LightSelection::All => cell_measures(evidence, sensor, map, &seen, &mut add),
            LightSelection::Group(_) => {}
        }
    }
    out
}

fn summary_measures(
    evidence: &Evidence<'_>,
    seeing: &Seeing,
    map: &SensorMap,
    add: &mut impl FnMut(&str, Measure),
) {
    let of = |statistic: &Statistic, unit: &str| statistic.measure(evidence, unit);
    let summary = &map.summary;
    let quantity = &map.quantity;
    match seeing {
        // Included in the totals.
        Seeing::All => {}
        Seeing::Pixels(_) if map.light.is_some() => {}
        Seeing::Views(_) | Seeing::Pixels(_) => {
            add(&format!("{quantity}_avg"), of(&summary.all.avg, &map.unit));
        }
    }
    add(&format!("{quantity}_min"), of(&summary.all.min, &map.unit));
    add(&format!("{quantity}_max"), of(&summary.all.max, &map.unit));
    let sets = [("", Some(&summary.all)), ("9", summary.nine.as_ref())];
    for (points, set) in sets.into_iter().chain([("13", summary.thirteen.as_ref())]) {
        let Some(set) = set else { continue };
        add(&format!("uniformity{points}_min_avg"), of(&set.min_avg, "1"));
        add(&format!("uniformity{points}_min_max"), of(&set.min_max, "1"));
        add(&format!("uniformity{points}_max_min"), of(&set.max_min, "1"));
    }
    add("cv", of(&summary.cv, "1"));
}

/// Names for the cells of small grids and the rings of polar ones.
fn cell_measures(
    evidence: &Evidence<'_>,
    sensor: &SurfaceSensor,
    map: &SensorMap,
    seen: &SensorCells<'_>,
    add: &mut impl FnMut(&str, Measure),
) {
    let grid = map_grid(sensor);
    let (columns, rows) = grid.shape();
    if columns * rows <= NAMED_CELLS {
        for cell in (0..columns * rows).filter(|&cell| seen.is_on(cell)) {
            let measure = cell_measure(evidence, map, seen.at(cell));
            add(&format!("cell.{}.{}", cell % columns, cell / columns), measure);
        }
    }
    match grid {
        Grid::Polar { rings, sectors, .. } if *rings <= NAMED_CELLS => {
            for ring in 0..*rings {
                let mean = seen.mean(ring * sectors..(ring + 1) * sectors);
                add(&format!("ring.{ring}"), cell_measure(evidence, map, mean));
            }
        }
        Grid::Polar { .. } | Grid::Cartesian { .. } => {}
    }
}

/// A cell as a measure; where nothing was counted, its error is one count.
fn cell_measure(evidence: &Evidence<'_>, map: &SensorMap, cell: Noisy) -> Measure {
    let status = status_by_error(cell.value, cell.std_error);
    let std_error = if status == Status::NoSignal { cell.count } else { cell.std_error };
    evidence.measure(cell.value, std_error, &map.unit, status)
}
