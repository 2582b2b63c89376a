//! From readings to photometric measures with uncertainty.
//!
//! Pure functions of a scene and its readings: the same readings give the same bits. Each quantity
//! has a dotted name, such as `exit.flux` or `balance.leaked`, and the set of names depends on the
//! scene alone, not on what was counted. Output units are applied here: lx, cd, cd/m², deg (W/m²,
//! W/sr, W/(m² sr) in radiometric runs). This layer does not know how light was traced, and draws
//! and writes nothing.

mod angular;
mod balance;
mod beam;
mod cell_colours;
mod cells;
mod check;
mod colour;
mod colour_spread;
mod evidence;
mod extremes;
mod flux;
#[cfg(test)]
mod laws;
mod light;
mod map;
mod multiscale;
mod noise;
mod noisy;
mod paths;
mod points;
mod readout;
mod replicates;
#[cfg(test)]
pub(crate) mod samples;
mod sensor;
mod smoothing;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod trials;
mod uniformity;
mod value;

pub use angular::{IntensityTable, PlaneCurve};
pub use balance::Balance;
pub use cell_colours::ColourTable;
pub use cells::not_below_zero;
pub use check::{CheckOutcome, Verdict, nearest, shortfall, verdict};
pub use colour::SensorSpectrum;
pub use map::{MapAxes, SensorMap};
pub use paths::{Action, ClassExtent, LostPaths, PathClass, PathStep, SensorPaths, strongest};
pub use replicates::Replicates;
pub use uniformity::{Statistic, Uniformity};
pub use value::{Measure, Status};

use crate::measure::evidence::Evidence;
use crate::plan::Estimator;
use crate::scene::{Scene, SensorId, SourceId};
use crate::transport::{Account, EstimatorChoice, Findings, Layout, Readings};
use indexmap::IndexMap;
use lumiduct_base::units::FluxUnit;
use serde::Serialize;

/// Everything measured in a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Measures {
    /// All measures by their dotted names, sensor by sensor, then the balance.
    pub values: IndexMap<String, Measure>,
    /// Where the light went.
    pub balance: Balance,
    /// Maps of surface sensors, one for each view of a luminance sensor: of all light, then of each
    /// light group.
    pub maps: Vec<SensorMap>,
    /// Intensities of goniometers: of all light, then of each light group.
    pub intensities: Vec<IntensityTable>,
    /// Spectra of the light on sensors, where light has one. They are tables of their own (`SENSOR.spectrum.csv`).
    #[serde(skip)]
    pub spectra: Vec<SensorSpectrum>,
    /// How each sensor was estimated, by its name.
    pub estimators: IndexMap<String, Estimator>,
    /// Findings of the pilot about each sensor; empty unless the run is to choose.
    pub choices: IndexMap<String, EstimatorChoice>,
    /// How the values of sensors were computed, where there is something to say.
    pub accounts: Vec<Account>,
    /// How the light reached each sensor.
    pub sensor_paths: Vec<SensorPaths>,
    /// Whether fluxes are luminous or radiant.
    pub unit: FluxUnit,
    /// Elevation of each sun above the horizon, deg, by the name of its source.
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    pub sun_elevations_deg: IndexMap<String, f64>,
    /// Sources of each light group, by its name.
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    pub light_groups: IndexMap<String, Vec<String>>,
    /// Weathers whose light the totals of all sources sum, though no two of them shine at the same
    /// time.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub weathers: Vec<String>,
    /// Flux of all sources, lm or W.
    pub source_flux: f64,
    /// Batches traced.
    pub batches: u64,
    /// Photon and gather paths traced.
    pub paths: u64,
    /// Their segments; a row of bounces taken in one step counts as one.
    pub segments: u64,
}

/// Measures everything. Linear in the number of cells.
pub fn measure(scene: &Scene, findings: &Findings) -> Measures {
    let mut values = IndexMap::new();
    let (mut maps, mut intensities, mut sensor_paths) = (Vec::new(), Vec::new(), Vec::new());
    let (mut estimators, mut spectra) = (IndexMap::new(), Vec::new());
    for (index, sensor) in scene.sensors.iter().enumerate() {
        let found = sensor::measures(scene, findings, SensorId::new(index));
        add(&mut values, &sensor.name, found.values);
        maps.extend(found.maps);
        intensities.extend(found.intensities);
        spectra.extend(found.spectrum);
        sensor_paths.push(found.paths);
        estimators.insert(sensor.name.clone(), findings.estimators[index]);
    }
    let names = scene.sensors.iter().map(|sensor| sensor.name.clone());
    let choices = names.zip(findings.choices.iter().cloned());
    let suns = scene.sources.iter().filter_map(|source| {
        // As in the file, without the rounding of radians.
        let degrees = (1e9 * source.elevation?.to_degrees()).round() / 1e9;
        Some((source.name.clone(), degrees))
    });
    let photons = &findings.photons;
    let balance = balance::balance(&Evidence::new(scene, photons));
    values.extend(balance.measures());
    Measures {
        values,
        balance,
        maps,
        intensities,
        spectra,
        estimators,
        choices: choices.collect(),
        accounts: accounts(scene, findings),
        sensor_paths,
        unit: scene.unit,
        sun_elevations_deg: suns.collect(),
        light_groups: light_groups(scene),
        weathers: scene.light.weathers().to_vec(),
        source_flux: scene.source_flux(),
        batches: photons.batch_count(),
        paths: findings.paths,
        segments: findings.segments(),
    }
}

fn light_groups(scene: &Scene) -> IndexMap<String, Vec<String>> {
    let name = |source: &SourceId| scene.sources[source.index()].name.clone();
    let groups = scene.light.groups().iter();
    groups.map(|group| (group.name.clone(), group.sources.iter().map(name).collect())).collect()
}

fn accounts(scene: &Scene, findings: &Findings) -> Vec<Account> {
    let sensors = (0..scene.sensors.len()).map(SensorId::new);
    sensors.filter_map(|id| findings.account(scene, id)).collect()
}

/// One measure by its dotted name, at no more cost than it needs.
pub fn value_of(scene: &Scene, findings: &Findings, name: &str) -> Option<Measure> {
    let (first, rest) = name.split_once('.')?;
    if let Some(index) = scene.sensors.iter().position(|sensor| sensor.name == first) {
        return sensor::value_of(scene, findings, SensorId::new(index), rest);
    }
    balance::balance(&Evidence::new(scene, &findings.photons)).measures().swap_remove(name)
}

/// Flux of every cell of a sensor, of every view in turn, with its standard error, lm or W; the error is
/// infinite after a single batch.
pub fn cell_fluxes(scene: &Scene, findings: &Findings, id: SensorId) -> Vec<(f64, f64)> {
    sensor::cell_fluxes(scene, findings, id)
}

/// The dotted names of all measures of a scene.
pub fn names(scene: &Scene) -> Vec<String> {
    let nothing = Readings::of_batch(scene, &Layout::new(scene), 0, 1, 0);
    measure(scene, &Findings::forward(nothing)).values.into_keys().collect()
}

/// Total error of a measure over its value, which is compared with the target of a run. Infinite
/// where there is no reliable error bar, `None` for an unknown name.
pub fn relative_error(measures: &Measures, name: &str) -> Option<f64> {
    measures.values.get(name).map(Measure::relative_error)
}

fn add(values: &mut IndexMap<String, Measure>, sensor: &str, measures: IndexMap<String, Measure>) {
    values.extend(measures.into_iter().map(|(name, m)| (format!("{sensor}.{name}"), m)));
}

/// Values of a measure in single groups of batches; `None` for those that need a map, whose cells
/// are not kept by group.
pub fn replicates(scene: &Scene, findings: &Findings, name: &str) -> Option<Replicates> {
    let (first, rest) = name.split_once('.')?;
    let found = match scene.sensors.iter().position(|sensor| sensor.name == first) {
        Some(index) => sensor::replicates(scene, findings, SensorId::new(index), rest)?,
        None => balance::replicates(scene, &findings.photons, name)?,
    };
    found.0.iter().all(|(_, value)| value.is_finite()).then_some(found)
}
