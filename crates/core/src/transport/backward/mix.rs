//! Forward and backward mixed: each counts the light of a path in proportion to how well it samples
//! it.
//!
//! Both know the ends of every path that they find, and therefore the weights of docs/method.md,
//! eq. (21), without a window. The path between the ends does not matter, so finishes may scatter.
//! Sources that rays cannot meet are left to photons. `backward` counts the share of gather paths.

use crate::scene::SourceId;
use crate::transport::backward::estimator::Backward;
use crate::transport::forward::{Detected, PhotonWatcher};
use crate::transport::gather::merge::{Etendues, NO_WINDOW};
use crate::transport::tally::readings::Counted;
use crate::transport::{Path, Readings, Vertex};
use smallvec::SmallVec;

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

impl PhotonWatcher for Mixing<'_, '_> {
    fn start(&mut self, path: &Path, source: SourceId, shape: usize) {
        let emitted = self.backward.emitters.emitted(source, path, shape);
        self.photon =
            if emitted > 0.0 { self.photon_fluxes[source.index()] / emitted } else { 0.0 };
    }

    #[inline(always)]
    fn arrive(&mut self, _: &Path, _: &Vertex<'_>, _: f64, _: SourceId) {}

    fn detect(
        &mut self,
        path: &Path,
        light: &Detected,
        cells: impl Iterator<Item = usize> + Clone,
    ) {
        let Backward { scene, layout, sensors, mixed, paths, .. } = self.backward;
        let known = light.arrivals(sensors).filter(|_| mixed.contains(&light.sensor));
        let cells: SmallVec<[usize; 4]> = cells.collect();
        let (Some(arrivals), false) = (known, cells.is_empty()) else { return };
        let weight = if self.photon > 0.0 {
            let gather = light.etendue(scene, arrivals, path.wavelength) / *paths as f64;
            let [weight, ..] =
                Etendues { photon: self.photon, gather, window: NO_WINDOW }.forward();
            weight
        } else {
            1.0
        };
        let (flux, source) = (light.flux * weight, light.source);
        let counted = Counted { flux, depth: path.depth, source };
        self.readings.count(layout, light.sensor, &cells, &counted);
    }
}
