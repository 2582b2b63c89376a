//! Forward and backward mixed: each counts the light of a path in proportion to how well it samples
//! it.
//!
//! Both know the ends of every path that they find, and therefore the weights of docs/method.md,
//! eq. (21), without a window. The path between the ends does not matter, so finishes may scatter.
//! Sources that rays cannot meet are left to photons. `backward` counts the share of gather paths.

use crate::transport::backward::estimator::Backward;
use crate::transport::gather::merge::{Etendues, NO_WINDOW};
use crate::transport::tally::readings::Counted;
use crate::transport::walk::follow::{arrivals_of, etendue_of};
use crate::transport::{Detection, Event, Observer, Path, Readings};
use std::ops::ControlFlow;

/// Counts the share of photons on the mixed sensors.
pub(crate) struct Mixing<'m, 's> {
    backward: &'m Backward<'s>,
    photon_fluxes: &'m [f64],
    /// Etendue represented by the current photon, mm² sr; 0 if no gather path could meet it.
    photon: f64,
    readings: &'m mut Readings,
}

impl<'m, 's> Mixing<'m, 's> {
    /// `photon_fluxes` are those of one photon of each source, lm or W.
    pub(crate) fn new(
        backward: &'m Backward<'s>,
        photon_fluxes: &'m [f64],
        readings: &'m mut Readings,
    ) -> Self {
        Self { backward, photon_fluxes, photon: 0.0, readings }
    }
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
        let Backward { scene, layout, sensors, mixed, paths, .. } = self.backward;
        let known = arrivals_of(light, sensors).filter(|_| mixed.contains(&light.sensor));
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
        let counted = Counted { flux, depth: path.depth, source };
        self.readings.count(layout, light.sensor, light.cells, &counted);
    }
}
