//! One batch of photons, with an optional observer.

use crate::rng::{Points, stream};
use crate::scene::SourceId;
use crate::transport::forward::Forward;
use crate::transport::forward::counter::PhotonCounter;
use crate::transport::stop::{Pace, StopSignal};
use crate::transport::{Observer, Readings, Unobserved};

/// Path classes are sampled from one path in this many: they are shares for the reader, not
/// measures.
const CLASS_EVERY: u64 = 8;

impl Forward<'_> {
    /// Traces one batch; `None` if it was stopped.
    pub fn batch(&self, batch: u64, signal: &StopSignal) -> Option<Readings> {
        self.batch_observed(batch, &mut Unobserved, &Pace::new(signal))
    }

    /// Traces one batch while `observer` sees its photons; `None` if it was stopped.
    pub fn batch_observed(
        &self,
        batch: u64,
        observer: &mut impl Observer,
        pace: &Pace<'_>,
    ) -> Option<Readings> {
        let batch_paths = self.shares.iter().sum();
        let readings = Readings::of_batch(self.scene, &self.layout, self.seed, batch_paths, batch);
        let mut counter = PhotonCounter::new(self, readings, observer, pace);
        counter.wavelengths = self.wavelengths(batch);
        let mut index = batch * batch_paths;
        for ((source, &paths), flux) in self.shares.iter().enumerate().zip(self.photon_fluxes()) {
            let of_source = stream::PHOTON_POINTS + source as u64;
            let mut points = Points::of_batch((self.seed, of_source, batch), paths);
            let source = SourceId::new(source);
            for place in 0..paths {
                // A part of the batch without gaps: every eighth Sobol point would leave out most of the first coordinate.
                // Another part in every batch, so that a source with few paths also gets its share of classes.
                let part = CLASS_EVERY * place / paths;
                counter.classed = (part + batch).is_multiple_of(CLASS_EVERY);
                counter.trace(source, flux, index, &mut points);
                index += 1;
                if pace.is_stopped() {
                    return None;
                }
            }
            counter.end_source();
        }
        Some(counter.finish())
    }

    /// Flux of one photon of each source, lm or W; 0 for dark sources, which have no photons. The photons of
    /// a batch share the whole flux of their source, so the mean over batches is a flux.
    pub(crate) fn photon_fluxes(&self) -> Vec<f64> {
        let sources = self.scene.sources.iter().zip(&self.shares);
        sources.map(|(source, &paths)| source.flux / paths.max(1) as f64).collect()
    }
}
