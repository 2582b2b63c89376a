//! Zones: cells of a sensor at the same place along a face, in the order of their places, and what light is wanted there.

use lumiduct_core::measure::SensorMap;
use lumiduct_input::{LightTarget, PatternFeedback};
use lumiduct_report::optimise::{Uncertain, ZonePlace};

/// The zones of a sensor along a face.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Zones {
    /// Their places along the face, mm, increasing.
    pub(crate) places: Vec<f64>,
    /// Wanted light, relative to its mean over the zones that count; 0 where a zone does not count.
    pub(crate) wanted: Vec<f64>,
    cells: Vec<Vec<usize>>,
}

impl Zones {
    pub(crate) fn of(feedback: &PatternFeedback) -> Self {
        let places: Vec<f64> = feedback.zones.iter().map(|zone| zone.along).collect();
        let wanted = match &feedback.target {
            LightTarget::Uniform => vec![1.0; places.len()],
            LightTarget::Profile(light) => {
                let raw: Vec<f64> = places.iter().map(|place| light.at(*place)).collect();
                let counted = raw.iter().filter(|own| **own > 0.0).count().max(1) as f64;
                let mean = raw.iter().sum::<f64>() / counted;
                raw.into_iter().map(|own| if mean > 0.0 { own / mean } else { 0.0 }).collect()
            }
        };
        let cells = feedback.zones.iter().map(|zone| zone.cells.clone()).collect();
        Self { places, wanted, cells }
    }

    /// The mean light of each zone on a map.
    pub(crate) fn read(&self, map: &SensorMap) -> Vec<Uncertain> {
        let columns = map.values.ncols();
        let read = |cells: &Vec<usize>| {
            let on = cells.iter().map(|cell| {
                let at = (cell / columns, cell % columns);
                let share = map.on_sensor.get(at).copied().unwrap_or(0.0);
                let value = map.values.get(at).copied().unwrap_or(f64::NAN);
                (share, value, map.std_errors.get(at).copied().unwrap_or(0.0))
            });
            let on: Vec<(f64, f64, f64)> = on.filter(|own| own.1.is_finite()).collect();
            let area = on.iter().map(|own| own.0).sum::<f64>().max(f64::MIN_POSITIVE);
            let variance: f64 = on.iter().map(|own| (own.0 * own.2).powi(2)).sum();
            Uncertain {
                value: on.iter().map(|own| own.0 * own.1).sum::<f64>() / area,
                std_error: variance.sqrt() / area,
            }
        };
        self.cells.iter().map(read).collect()
    }

    /// For reports.
    pub(crate) fn described(&self) -> Vec<ZonePlace> {
        let pairs = self.places.iter().zip(&self.wanted);
        pairs.map(|(place, wanted)| ZonePlace { along_mm: *place, wanted: *wanted }).collect()
    }
}
