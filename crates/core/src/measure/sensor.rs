//! All measures of one sensor, from any estimator.

use crate::measure::cell_colours::NONUNIFORMITY;
use crate::measure::evidence::Evidence;
use crate::measure::light::LightSelection;
use crate::measure::{
    IntensityTable, Measure, Replicates, SensorMap, SensorPaths, SensorSpectrum, Status, angular,
    colour, flux, map, paths, readout,
};
use crate::scene::{Scene, SensorId, SensorKind};
use crate::transport::{Bias, Estimate, Findings, Resolution};
use indexmap::IndexMap;
use ndarray::{Array2, Zip};

/// The measures of a sensor.
pub(crate) struct SensorMeasures {
    /// Measures by the last part of their dotted names.
    pub(crate) values: IndexMap<String, Measure>,
    /// One map, or one for each view, of all light and of each light group.
    pub(crate) maps: Vec<SensorMap>,
    /// Tables of a goniometer, likewise.
    pub(crate) intensities: Vec<IntensityTable>,
    /// Its spectrum, where light has one.
    pub(crate) spectrum: Option<SensorSpectrum>,
    pub(crate) paths: SensorPaths,
}

/// Measures a sensor.
pub(crate) fn measures(scene: &Scene, findings: &Findings, id: SensorId) -> SensorMeasures {
    let photons = Evidence::new(scene, &findings.photons);
    let estimate = findings.estimate(scene, id);
    let mut found = by_evidence(&photons.by(estimate.readings, (estimate.estimator, id)), id);
    let Some(bias) = estimate.bias else {
        found.values.values_mut().for_each(|measure| judge(measure, &estimate));
        return found;
    };
    let other = by_evidence(&photons.by(bias.other, (estimate.estimator, id)), id);
    for (name, measure) in &mut found.values {
        set_bias(measure, &estimate, &bias, &other.values[name]);
    }
    let of_cells = |own: &Array2<f64>, other: &Array2<f64>| {
        Some(Zip::from(own).and(other).map_collect(|&own, &other| bias.of(own, other)))
    };
    for (own, other) in found.maps.iter_mut().zip(&other.maps) {
        own.biases = of_cells(&own.values, &other.values);
    }
    for (own, other) in found.intensities.iter_mut().zip(&other.intensities) {
        own.biases = of_cells(&own.values, &other.values);
    }
    found
}

/// One measure of a sensor, at no more cost than it needs: its flux needs no maps.
pub(crate) fn value_of(
    scene: &Scene,
    findings: &Findings,
    id: SensorId,
    name: &str,
) -> Option<Measure> {
    let photons = Evidence::new(scene, &findings.photons);
    let estimate = findings.estimate(scene, id);
    let of = |readings| one_value(&photons.by(readings, (estimate.estimator, id)), id, name);
    let mut value = of(estimate.readings)?;
    match &estimate.bias {
        None => judge(&mut value, &estimate),
        Some(bias) => {
            set_bias(&mut value, &estimate, bias, &of(bias.other)?);
        }
    }
    Some(value)
}

/// Flux of every cell of a sensor, view by view, with its standard error, lm or W.
pub(crate) fn cell_fluxes(scene: &Scene, findings: &Findings, id: SensorId) -> Vec<(f64, f64)> {
    let photons = Evidence::new(scene, &findings.photons);
    let estimate = findings.estimate(scene, id);
    let cells = scene.sensors[id.index()].cells();
    photons.by(estimate.readings, (estimate.estimator, id)).cell_flux(
        id,
        LightSelection::All,
        0..cells,
    )
}

/// Values, in single groups of batches, of a measure that follows from scalars alone.
pub(crate) fn replicates(
    scene: &Scene,
    findings: &Findings,
    id: SensorId,
    name: &str,
) -> Option<Replicates> {
    let photons = Evidence::new(scene, &findings.photons);
    let Estimate { estimator, readings, .. } = findings.estimate(scene, id);
    let value = total(&photons.by(readings, (estimator, id)), id, name)?.value;
    let without = readings.groups.iter().map(|group| {
        let [own, photons] =
            [readings, &findings.photons].map(|readings| readings.without_group(group.group));
        let evidence = Evidence::new(scene, &photons).by(&own, (estimator, id));
        Some((group.group, total(&evidence, id, name)?.value))
    });
    Some(Replicates::new(value, &without.collect::<Option<Vec<_>>>()?))
}

/// Notes a contradiction in a measure by the estimator that is contradicted.
fn judge(measure: &mut Measure, estimate: &Estimate<'_>) {
    if estimate.is_contradicted && measure.estimator == estimate.estimator {
        measure.status = measure.status.worst(Status::Contradicted);
    }
}

/// Sets the bias of a measure by the biased estimator, from its value by the other estimate.
fn set_bias(measure: &mut Measure, estimate: &Estimate<'_>, bias: &Bias<'_>, other: &Measure) {
    if measure.estimator != estimate.estimator {
        return;
    }
    let remaining = bias.of(measure.value, other.value);
    if remaining.is_finite() {
        measure.bias = Some(measure.bias.unwrap_or(0.0).hypot(remaining));
    }
    measure.status = measure.status.worst(match bias.resolution {
        Resolution::Resolved => Status::Ok,
        Resolution::InNoise => Status::BiasInNoise,
        Resolution::NotResolved => Status::BiasNotResolved,
    });
}

fn by_evidence(evidence: &Evidence<'_>, id: SensorId) -> SensorMeasures {
    let scene = evidence.scene;
    let mut values = flux::totals(evidence, id);
    values.extend(colour::totals(evidence, id));
    let (mut maps, mut intensities) = (Vec::new(), Vec::new());
    for light in LightSelection::each(scene) {
        match &scene.sensors[id.index()].kind {
            SensorKind::Surface(surface) => {
                let own = map::maps(evidence, id, surface, light);
                values.extend(readout::measures(evidence, id, surface, light, &own));
                maps.extend(own);
            }
            SensorKind::Goniometer(goniometer) => {
                values.extend(angular::measures(evidence, id, goniometer, light));
                intensities.push(angular::table(evidence, id, goniometer, light));
            }
        }
    }
    values.extend(match &scene.sensors[id.index()].kind {
        SensorKind::Surface(surface) => map::add_colours(evidence, id, surface, &mut maps),
        SensorKind::Goniometer(goniometer) => {
            let all = intensities.iter_mut().find(|own| own.light.is_none());
            all.map(|own| angular::add_colours(evidence, id, goniometer, own)).unwrap_or_default()
        }
    });
    let paths = paths::paths(evidence, id);
    let spectrum = colour::spectrum(evidence, id);
    SensorMeasures { values, maps, intensities, spectrum, paths }
}

/// One measure that follows from scalars alone.
fn total(evidence: &Evidence<'_>, id: SensorId, name: &str) -> Option<Measure> {
    let of_flux = flux::totals(evidence, id).swap_remove(name);
    of_flux.or_else(|| colour::total(evidence, id, name))
}

fn one_value(evidence: &Evidence<'_>, id: SensorId, name: &str) -> Option<Measure> {
    if name.starts_with(NONUNIFORMITY) {
        return by_evidence(evidence, id).values.swap_remove(name);
    }
    total(evidence, id, name).or_else(|| {
        let light = LightSelection::of_measure(evidence.scene, name);
        let mut read = match &evidence.scene.sensors[id.index()].kind {
            SensorKind::Surface(surface) => {
                let maps = map::maps(evidence, id, surface, light);
                readout::measures(evidence, id, surface, light, &maps)
            }
            SensorKind::Goniometer(goniometer) => {
                angular::measures(evidence, id, goniometer, light)
            }
        };
        read.swap_remove(name)
    })
}
