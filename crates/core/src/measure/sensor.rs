//! All measures of one sensor, from any estimator.

use crate::measure::evidence::{Evidence, MIN_LIT_GROUPS};
use crate::measure::gathered::{GatheredFacts, Judged, judged};
use crate::measure::{
    IntensityTable, Measure, Replicates, SensorMap, SensorPaths, Status, angular, flux, map, paths,
    readout,
};
use crate::plan::Estimator;
use crate::scene::{Scene, SensorId, SensorKind};
use crate::transport::Findings;
use indexmap::IndexMap;

/// The measures of a sensor.
pub(crate) struct SensorMeasures {
    /// Measures by the last part of their dotted names.
    pub(crate) values: IndexMap<String, Measure>,
    /// One map, or one for each view.
    pub(crate) maps: Vec<SensorMap>,
    /// Table of a goniometer.
    pub(crate) intensity: Option<IntensityTable>,
    pub(crate) paths: SensorPaths,
    /// Facts about a gathered sensor.
    pub(crate) gathered: Option<GatheredFacts>,
}

/// Measures a sensor.
pub(crate) fn measures(scene: &Scene, findings: &Findings, id: SensorId) -> SensorMeasures {
    match evidence(scene, findings, id) {
        Spoken::Plainly(evidence) => {
            let mut found = by_evidence(&evidence, id);
            if is_contradicted(&evidence, id) {
                found.values.values_mut().for_each(distrust);
            }
            found
        }
        Spoken::InWindows(judged) => {
            let [value, wide, middle] = judged.evidences().map(|one| by_evidence(&one, id));
            let mut values = value.values;
            for (name, measure) in &mut values {
                judged.tell_bias(measure, &wide.values[name], &middle.values[name]);
            }
            let mut maps = value.maps;
            for (map, (wide, middle)) in maps.iter_mut().zip(wide.maps.iter().zip(&middle.maps)) {
                map.biases = Some((&wide.values - &middle.values).abs());
            }
            let mut intensity = value.intensity;
            if let (Some(own), Some(wide), Some(middle)) =
                (&mut intensity, wide.intensity, middle.intensity)
            {
                own.biases = Some((wide.values - middle.values).abs());
            }
            let gathered = judged.facts(findings, id);
            SensorMeasures { values, maps, intensity, paths: value.paths, gathered }
        }
    }
}

/// One measure of a sensor, at no more cost than it needs: its flux needs no maps.
pub(crate) fn value_of(
    scene: &Scene,
    findings: &Findings,
    id: SensorId,
    name: &str,
) -> Option<Measure> {
    match evidence(scene, findings, id) {
        Spoken::Plainly(evidence) => {
            let mut value = one_value(&evidence, id, name)?;
            if is_contradicted(&evidence, id) {
                distrust(&mut value);
            }
            Some(value)
        }
        Spoken::InWindows(judged) => {
            let [value, wide, middle] = judged.evidences().map(|one| one_value(&one, id, name));
            let mut value = value?;
            judged.tell_bias(&mut value, &wide?, &middle?);
            Some(value)
        }
    }
}

/// Values, in single groups of batches, of a measure that follows from scalars alone.
pub(crate) fn replicates(
    scene: &Scene,
    findings: &Findings,
    id: SensorId,
    name: &str,
) -> Option<Replicates> {
    let evidence = match evidence(scene, findings, id) {
        Spoken::Plainly(evidence) => evidence,
        Spoken::InWindows(judged) => judged.evidences()[0],
    };
    let value = flux::totals(&evidence, id).swap_remove(name)?.value;
    let without = evidence.readings.groups.iter().map(|group| {
        let [own, photons] = [evidence.readings, evidence.of_photons().readings]
            .map(|readings| readings.without_group(group.group));
        let evidence = Evidence::new(scene, &photons).by(&own, evidence.estimator());
        Some((group.group, flux::totals(&evidence, id).swap_remove(name)?.value))
    });
    Some(Replicates::new(value, &without.collect::<Option<Vec<_>>>()?))
}

/// Standard errors of both by which photons must find more than gather paths to contradict them.
const CONTRADICTED: f64 = 4.0;

/// Possible relative rounding of a flux.
const ROUNDING: f64 = 1e-9;

/// Whether photons found more light of a source on a sensor than gather paths, which almost never
/// meet it.
fn is_contradicted(evidence: &Evidence<'_>, id: SensorId) -> bool {
    match evidence.estimator() {
        Estimator::Backward => {}
        // Photons are included in the count, or its bias is reported by other means.
        Estimator::Forward | Estimator::Mix | Estimator::Gather | Estimator::Mis => return false,
    }
    flux::flux_slots(evidence, id).iter().any(|&slot| {
        let photons = evidence.of_photons();
        let [by_photons, own] = [&photons, evidence].map(|one| one.readings.scalar(slot));
        let error = by_photons.std_error().hypot(own.std_error());
        photons.lit_groups(&[slot]) >= MIN_LIT_GROUPS
            && by_photons.mean() - own.mean() > CONTRADICTED * error + ROUNDING * own.mean().abs()
    })
}

fn distrust(measure: &mut Measure) {
    if measure.estimator == Estimator::Backward {
        measure.status = measure.status.worst(Status::Contradicted);
    }
}

/// The readings that give the values of a sensor.
enum Spoken<'a> {
    /// One set of readings.
    Plainly(Evidence<'a>),
    /// Readings within nested windows.
    InWindows(Judged<'a>),
}

fn evidence<'a>(scene: &'a Scene, findings: &'a Findings, id: SensorId) -> Spoken<'a> {
    let photons = Evidence::new(scene, &findings.photons);
    let estimator = findings.estimator(id);
    match estimator {
        Estimator::Forward => Spoken::Plainly(photons),
        Estimator::Backward | Estimator::Mix => {
            let own = findings.backward.as_ref().map(|own| photons.by(own, estimator));
            Spoken::Plainly(own.unwrap_or(photons))
        }
        Estimator::Gather | Estimator::Mis => match judged(photons, findings, id) {
            Some(judged) => Spoken::InWindows(judged),
            None => Spoken::Plainly(photons),
        },
    }
}

fn by_evidence(evidence: &Evidence<'_>, id: SensorId) -> SensorMeasures {
    let scene = evidence.scene;
    let mut values = flux::totals(evidence, id);
    let (mut maps, mut intensity) = (Vec::new(), None);
    match &scene.sensors[id.index()].kind {
        SensorKind::Surface(surface) => {
            maps = map::maps(evidence, id, surface);
            values.extend(readout::measures(evidence, id, surface, &maps));
        }
        SensorKind::Goniometer(goniometer) => {
            values.extend(angular::measures(evidence, id, goniometer));
            intensity = Some(angular::table(evidence, id, goniometer));
        }
    }
    let paths = paths::paths(evidence, id);
    SensorMeasures { values, maps, intensity, paths, gathered: None }
}

fn one_value(evidence: &Evidence<'_>, id: SensorId, name: &str) -> Option<Measure> {
    flux::totals(evidence, id).swap_remove(name).or_else(|| {
        let mut read = match &evidence.scene.sensors[id.index()].kind {
            SensorKind::Surface(surface) => {
                let maps = map::maps(evidence, id, surface);
                readout::measures(evidence, id, surface, &maps)
            }
            SensorKind::Goniometer(goniometer) => angular::measures(evidence, id, goniometer),
        };
        read.swap_remove(name)
    })
}
