//! Values of the gather method: which stage gives them, and whether their bias is known.
//!
//! Within nested windows of size 1, 1/√2 and 1/2 the same photons give E1, E2 and E3. A bias that
//! scales with the square of the window, as that of a smooth field does, gives (E1 - E2)/(E2 - E3)
//! = 2. If this holds, within its error and above the noise, the value is E0, which is free of such
//! a bias. Where all differences are noise the value is also E0, but the bias is not resolved.
//! Where they follow another law the value is E3, and its bias is not resolved. |E1 - E2| is the
//! indicator of bias in all cases. The decision is made once per sensor and stage, from its flux,
//! never per cell.

use crate::measure::evidence::{Evidence, MIN_LIT_GROUPS};
use crate::measure::flux::flux_slots;
use crate::measure::{Measure, Status};
use crate::plan::Estimator;
use crate::scene::SensorId;
use crate::tally::Tally;
use crate::transport::{Findings, Group, Readings, Stage, Windows};
use serde::Serialize;

/// Standard errors that E2 - E3 must exceed to count as more than noise.
const OUT_OF_NOISE: f64 = 2.0;
/// Standard errors within which (E1 - E2) - 2 (E2 - E3) must vanish.
const WITHIN: f64 = 2.0;
/// Deviation of the ratio from 2 that is accepted however well it is known, 1: higher orders of the
/// window's size.
const RATIO_TOLERANCE: f64 = 0.15;

/// What is known about the bias of a sensor's values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Resolution {
    /// It scales with the square of the window: it has been removed by extrapolation, and the rest
    /// is smaller.
    Resolved,
    /// The windows agree within their noise; a bias that scales with the square of the window would
    /// have been removed by extrapolation.
    InNoise,
    /// They differ, but not as the square of the window.
    NotResolved,
}

/// How the values of a gathered sensor were found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GatheredFacts {
    /// Name of the sensor.
    pub sensor: String,
    /// Deepest vertex at which its gather paths ended; the first surface has depth 0.
    pub depth: u32,
    /// The stage that gave the values, from 0.
    pub stage: u32,
    /// Whether their bias is resolved.
    pub resolution: Resolution,
    /// The flux from photons of the same run on the sensor, with its standard error: unbiased,
    /// mostly with more noise; lm or W.
    pub by_photons: [f64; 2],
    /// Difference of the gathered flux from that, in total errors of both, 1; `None` where either
    /// has found too little to decide. A merged flux contains part of the same photons, which makes
    /// this smaller.
    pub off: Option<f64>,
    /// The last finished stage and the one after it, as far as it has got.
    pub stages: Vec<StageFacts>,
}

/// A stage, and the flux of a sensor within its nested windows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StageFacts {
    /// Number of the stage, from 0.
    pub number: u32,
    /// Radius of its widest window, mm.
    pub radius_mm: f64,
    /// Half-angle of its widest window, deg.
    pub angle_deg: f64,
    /// Passes.
    pub passes: u64,
    /// Gather paths of a pass from each sensor.
    pub gather_paths: u64,
    /// E1, E2 and E3, the flux within windows of size 1, 1/√2 and 1/2, and E0, free of a bias that
    /// scales with their square; lm or W.
    pub flux: [f64; 4],
    /// Their standard errors, same layout.
    pub std_errors: [f64; 4],
}

/// The stage that gives a sensor's values.
pub(crate) struct Judged<'a> {
    photons: Evidence<'a>,
    estimator: Estimator,
    pub(crate) stage: &'a Stage,
    pub(crate) resolution: Resolution,
}

/// The stage with the smallest total error of a sensor's flux.
pub(crate) fn judged<'a>(
    photons: Evidence<'a>,
    findings: &'a Findings,
    id: SensorId,
) -> Option<Judged<'a>> {
    let slots = flux_slots(&photons, id);
    let estimator = findings.estimator(id);
    let stages = findings.gathered.as_ref()?.stages.iter();
    let with_error = stages.map(|stage| {
        let resolution = resolution(&stage.windows, &slots);
        let judged = Judged { photons, estimator, stage, resolution };
        (total_error(&stage.windows, resolution, &slots), judged)
    });
    with_error.min_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, judged)| judged)
}

/// Whether the bias of a sensor's flux in the stage in progress is above its noise.
pub(crate) fn is_held_by_bias(photons: Evidence<'_>, findings: &Findings, id: SensorId) -> bool {
    let slots = flux_slots(&photons, id);
    let stage = findings.gathered.as_ref().and_then(|gathered| gathered.stages.last());
    stage.is_some_and(|stage| {
        let resolution = resolution(&stage.windows, &slots);
        let apart = difference(&stage.windows, &slots, |[e1, e2, _]| e1 - e2).mean().abs();
        resolution == Resolution::NotResolved
            || apart > flux(chosen(&stage.windows, resolution), &slots).std_error()
    })
}

impl<'a> Judged<'a> {
    /// The evidence for the value, and that within the wide and the middle window.
    pub(crate) fn evidences(&self) -> [Evidence<'a>; 3] {
        let Windows { wide, middle, .. } = &self.stage.windows;
        [chosen(&self.stage.windows, self.resolution), wide, middle]
            .map(|readings| self.photons.by(readings, self.estimator))
    }

    /// How the values were found; `None` if nothing was gathered.
    pub(crate) fn facts(&self, findings: &Findings, id: SensorId) -> Option<GatheredFacts> {
        let gathered = findings.gathered.as_ref()?;
        let slots = flux_slots(&self.photons, id);
        let windows = &self.stage.windows;
        let by_photons = flux(self.photons.readings, &slots);
        let is_lit = |readings: &Readings| {
            let is_lit = |group: &&Group| slots.iter().any(|&slot| group.sums[slot] != 0.0);
            readings.groups.iter().filter(is_lit).count() >= MIN_LIT_GROUPS
        };
        let own = total_error(windows, self.resolution, &slots);
        let value = flux(chosen(windows, self.resolution), &slots).mean();
        let error = by_photons.std_error().hypot(own * value);
        Some(GatheredFacts {
            sensor: self.photons.scene.sensors[id.index()].name.clone(),
            depth: gathered.settings.depth,
            stage: self.stage.number,
            resolution: self.resolution,
            by_photons: [by_photons.mean(), by_photons.std_error()],
            off: (is_lit(self.photons.readings) && is_lit(&windows.narrow))
                .then(|| (value - by_photons.mean()) / error),
            stages: gathered.stages.iter().map(|stage| stage_facts(stage, &slots)).collect(),
        })
    }

    /// Sets the bias of a measure from its values within the two wider windows.
    pub(crate) fn tell_bias(&self, measure: &mut Measure, wide: &Measure, middle: &Measure) {
        if measure.estimator != self.estimator {
            return;
        }
        let delta = (wide.value - middle.value).abs();
        if delta.is_finite() {
            measure.bias = Some(measure.bias.unwrap_or(0.0).hypot(delta));
        }
        measure.status = measure.status.worst(match self.resolution {
            Resolution::Resolved => Status::Ok,
            Resolution::InNoise => Status::BiasInNoise,
            Resolution::NotResolved => Status::BiasNotResolved,
        });
    }
}

fn stage_facts(stage: &Stage, slots: &[usize]) -> StageFacts {
    let Windows { wide, middle, narrow, extrapolated } = &stage.windows;
    let found = [wide, middle, narrow, extrapolated].map(|readings| flux(readings, slots));
    StageFacts {
        number: stage.number,
        radius_mm: stage.window.radius,
        angle_deg: stage.window.theta_max.to_degrees(),
        passes: wide.batch_count(),
        gather_paths: stage.gather_paths,
        flux: found.each_ref().map(Tally::mean),
        std_errors: found.each_ref().map(Tally::std_error),
    }
}

/// Whether the bias of the sum of some scalars is resolved.
fn resolution(windows: &Windows, slots: &[usize]) -> Resolution {
    let outer = difference(windows, slots, |[e1, e2, _]| e1 - e2);
    let inner = difference(windows, slots, |[_, e2, e3]| e2 - e3);
    let curved = difference(windows, slots, |[e1, e2, e3]| e1 - 3.0 * e2 + 2.0 * e3);
    let is_seen = |tally: &Tally| tally.mean().abs() > OUT_OF_NOISE * tally.std_error();
    let room = (WITHIN * curved.std_error()).max(RATIO_TOLERANCE * inner.mean().abs());
    // Noise alone must not make the ratio acceptable: both differences have one sign.
    let quadratic = curved.mean().abs() <= room && outer.mean() * inner.mean() > 0.0;
    if is_seen(&inner) && quadratic {
        Resolution::Resolved
    } else if is_seen(&inner) || is_seen(&outer) {
        Resolution::NotResolved
    } else {
        Resolution::InNoise
    }
}

/// Combined standard error and bias of the sum of some scalars, relative to it.
fn total_error(windows: &Windows, resolution: Resolution, slots: &[usize]) -> f64 {
    let delta = difference(windows, slots, |[e1, e2, _]| e1 - e2).mean();
    let value = flux(chosen(windows, resolution), slots);
    let error = value.std_error().hypot(delta) / value.mean().abs();
    if error.is_nan() { f64::INFINITY } else { error }
}

/// The readings that give the values.
fn chosen(windows: &Windows, resolution: Resolution) -> &Readings {
    match resolution {
        Resolution::Resolved | Resolution::InNoise => &windows.extrapolated,
        Resolution::NotResolved => &windows.narrow,
    }
}

/// The sum of some scalars.
fn flux(readings: &Readings, slots: &[usize]) -> Tally {
    readings.function(|flux| slots.iter().map(|&slot| flux(slot)).sum())
}

/// A function of the sum of some scalars within the three windows, pass by pass.
fn difference(windows: &Windows, slots: &[usize], f: impl Fn([f64; 3]) -> f64) -> Tally {
    let Windows { wide, middle, narrow, .. } = windows;
    let groups = wide.groups.iter().zip(&middle.groups).zip(&narrow.groups);
    Tally::of(groups.map(|((wide, middle), narrow)| {
        f([wide, middle, narrow].map(|group| {
            slots.iter().map(|&slot| group.sums[slot]).sum::<f64>() / group.batches as f64
        }))
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::samples::{add, readings, rectangle, scene};
    use crate::scene::SourceId;
    use crate::transport::Layout;

    /// Passes that each find these fluxes within the three windows, and some noise.
    fn decided(means: [f64; 3], noise: impl Fn(u64) -> [f64; 3]) -> Resolution {
        let scene = scene(&[("lamp", 10.0)], vec![("cell", rectangle(2.0, 1, 1))]);
        let slot = Layout::new(&scene).sensor_flux(SensorId::new(0), SourceId::new(0));
        let [wide, middle, narrow] = [0, 1, 2].map(|window: usize| {
            let found = readings(&scene, 32, |pass, _, batch| {
                add(batch, slot, means[window] + noise(pass)[window]);
            });
            found.photons
        });
        let extrapolated = middle.combined([2.0, -1.0], &wide);
        resolution(&Windows { wide, middle, narrow, extrapolated }, &[slot])
    }

    /// Plus and minus the size, alternating.
    fn wobble(pass: u64, size: f64) -> f64 {
        if pass.is_multiple_of(2) { size } else { -size }
    }

    #[test]
    fn a_bias_by_the_square_of_the_window_is_resolved() {
        let noise = |pass| [0.0, wobble(pass, 1e-3), wobble(pass / 2, 2e-3)];
        assert_eq!(decided([0.6, 0.8, 0.9], noise), Resolution::Resolved);
        assert_eq!(decided([1.4, 1.2, 1.1], noise), Resolution::Resolved);
    }

    #[test]
    fn a_bias_of_another_law_is_not_resolved() {
        let noise = |pass| [0.0, wobble(pass, 1e-3), wobble(pass / 2, 2e-3)];
        assert_eq!(decided([0.6, 0.7, 0.9], noise), Resolution::NotResolved, "still rising");
        assert_eq!(decided([0.6, 0.9, 0.8], noise), Resolution::NotResolved, "both ways");
    }

    #[test]
    fn windows_that_differ_by_noise_alone_are_told_so() {
        let noise = |pass| [0.0, wobble(pass, 1.0), wobble(pass / 2, 2.0)];
        assert_eq!(decided([0.6, 0.8, 0.9], noise), Resolution::InNoise);
        assert_eq!(decided([0.0; 3], |_| [0.0; 3]), Resolution::InNoise, "in the dark");
    }
}
