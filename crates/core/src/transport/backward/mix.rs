//! Forward and backward mixed: each counts the light of a path in proportion to how well it samples
//! it.
//!
//! Both know the ends of every path that they find, and therefore the weights of docs/method.md,
//! eq. (21), without a window. The path between the ends does not matter, so finishes may scatter.
//! Sources that rays cannot meet are left to photons. `backward` counts the share of gather paths.

use crate::plan::Estimator;
use crate::transport::backward::estimator::{Backward, Weights, paths_for, work_of_one};
use crate::transport::forward;
use crate::transport::gather::merge::{Etendues, NO_WINDOW};
use crate::transport::stop::Pace;
use crate::transport::tally::readings::DetectedLight;
use crate::transport::tally::work;
use crate::transport::task::Task;
use crate::transport::trial::{BATCHES, Trials, Tried};
use crate::transport::walk::follow::{arrivals_of, etendue_of};
use crate::transport::{Detection, Event, Observer, Path, Readings};
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Counts the share of photons on the mixed sensors, beside that of gather paths.
pub(crate) struct Mixing<'m, 's> {
    backward: &'m Backward<'s>,
    photon_fluxes: &'m [f64],
    /// Etendue represented by the current photon, mm² sr; 0 if no gather path could meet it.
    photon: f64,
    /// Counts of the batch, not closed.
    pub(crate) readings: Readings,
}

impl<'m, 's> Mixing<'m, 's> {
    /// The gather paths of a batch, traced, and ready for its photons; `None` if stopped.
    pub(crate) fn begin(backward: &'m Backward<'s>, task: Task<'m>) -> Option<Self> {
        let readings = backward.trace(task)?;
        Some(Self { backward, photon_fluxes: task.photon_fluxes, photon: 0.0, readings })
    }
}

/// Tries photons and gather paths with half of the work each; `None` if stopped.
pub(crate) fn trial(trials: &Trials<'_>) -> Option<Vec<Tried>> {
    let half = 0.5 * trials.effort;
    let forward = forward::photons_for(trials, half);
    let backward = paths_for(trials, half)?.with_weights(Weights::Shared);
    let photon_fluxes = forward.photon_fluxes();
    let traced = |batch| {
        let pace = Pace::new(trials.signal);
        let task = Task { batch, stage: 0, photon_fluxes: &photon_fluxes, pace: &pace };
        let mut mixing = Mixing::begin(&backward, task)?;
        let photons = forward.batch_observed(batch, &mut mixing, &pace)?;
        mixing.readings.close_batch();
        Some((work::of_photons(&photons), mixing.readings))
    };
    let both: Option<Vec<(f64, Readings)>> = (0..BATCHES).into_par_iter().map(traced).collect();
    let (by_photons, batches): (Vec<f64>, Vec<Readings>) = both?.into_iter().unzip();
    let work = by_photons.iter().sum::<f64>() + work_of_one(&backward, &batches);
    Some(trials.judged(&batches, work, Estimator::Mix))
}

impl Observer for Mixing<'_, '_> {
    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()> {
        match event {
            Event::Start(start) => {
                let emitted = self.backward.emitters.emitted(start.source, path, start.shape);
                let flux = self.photon_fluxes[start.source.index()];
                self.photon = if emitted > 0.0 { flux / emitted } else { 0.0 };
            }
            Event::Detect(light) => self.detect(path, light),
            Event::Travel(_)
            | Event::Collide(_)
            | Event::Arrive(_)
            | Event::Depart(..)
            | Event::Absorbed(_)
            | Event::Meet(_)
            | Event::Roulette(_)
            | Event::Escaped(_)
            | Event::Cut(_)
            | Event::Leaked(..) => {}
        }
        ControlFlow::Continue(())
    }
}

impl Mixing<'_, '_> {
    fn detect(&mut self, path: &Path, light: &Detection<'_>) {
        let Backward { scene, layout, sensors, paths, .. } = self.backward;
        let known = arrivals_of(light, sensors);
        let (Some(arrivals), false) = (known, light.cells.is_empty()) else { return };
        let weight = if self.photon > 0.0 {
            let gather = etendue_of(light, scene, arrivals, path.wavelength) / *paths as f64;
            let [weight, ..] =
                Etendues { photon: self.photon, gather, window: NO_WINDOW }.forward();
            weight
        } else {
            1.0
        };
        let (flux, source) = (light.flux * weight, light.source);
        let counted = DetectedLight { flux, depth: path.depth, source };
        self.readings.count((layout, &scene.light), light.sensor, light.cells, &counted);
    }
}
