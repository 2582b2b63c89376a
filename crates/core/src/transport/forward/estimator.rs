//! The forward estimator: photon paths from the sources, counted where they meet a sensor.
//!
//! Every photon carries flux; sensors sum it per cell. Flux absorbed by surfaces and media, escaped
//! flux and cut flux are counted independently, so that the balance is a check, not an assumption.

use crate::scene::{Scene, Wavelengths};
use crate::transport::Layout;
use crate::transport::forward::sensor_table::SensorTable;
use crate::transport::forward::surprises::Surprises;

/// Shared data of all batches of a run.
#[derive(Debug)]
pub struct Forward<'s> {
    pub(crate) scene: &'s Scene,
    pub(crate) layout: Layout,
    pub(crate) sensors: SensorTable<'s>,
    pub(super) surprises: Surprises,
    pub(crate) seed: u64,
    pub(crate) bounce_limit: u32,
    /// Paths per batch of each source.
    pub(crate) shares: Vec<u64>,
    wavelengths: WavelengthSharing,
}

/// How the photons of a batch draw their wavelengths.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum WavelengthSharing {
    /// From all of a spectrum.
    Free,
    /// From those that the photons and records of a pass share.
    ByPass,
}

impl<'s> Forward<'s> {
    /// Prepares a run with `batch_paths` paths a batch, divided among the sources by flux.
    pub fn new(scene: &'s Scene, seed: u64, bounce_limit: u32, batch_paths: u64) -> Self {
        Self {
            scene,
            layout: Layout::new(scene),
            sensors: SensorTable::new(scene),
            surprises: Surprises::new(scene),
            seed,
            bounce_limit,
            shares: shares(scene, batch_paths),
            wavelengths: WavelengthSharing::Free,
        }
    }

    /// The same with batches that are passes, whose photons meet records.
    pub(crate) fn of_passes(self) -> Self {
        Self { wavelengths: WavelengthSharing::ByPass, ..self }
    }

    /// The wavelengths of the photons of a batch.
    pub(super) fn wavelengths(&self, batch: u64) -> Wavelengths {
        match self.wavelengths {
            WavelengthSharing::Free => Wavelengths::All,
            WavelengthSharing::ByPass => Wavelengths::of_pass(self.seed, batch),
        }
    }

    /// The same with another number of paths a batch.
    pub(crate) fn with_paths(&self, batch_paths: u64) -> Self {
        let wavelengths = self.wavelengths;
        Self { wavelengths, ..Self::new(self.scene, self.seed, self.bounce_limit, batch_paths) }
    }
}

/// Paths per batch of each source, by flux: none for a dark one, at least one for each other, and
/// the remainder of rounding to those that miss the largest part of a path. Their sum is
/// `batch_paths` unless there are more sources than that.
pub(super) fn shares(scene: &Scene, batch_paths: u64) -> Vec<u64> {
    let total = scene.source_flux();
    let wanted: Vec<f64> =
        scene.sources.iter().map(|source| batch_paths as f64 * source.flux / total).collect();
    let places = (0..wanted.len()).filter(|&place| scene.sources[place].is_lit());
    let mut shares = vec![0; wanted.len()];
    places.clone().for_each(|place| shares[place] = (wanted[place].floor() as u64).max(1));
    let missing = |shares: &[u64], place: usize| wanted[place] - shares[place] as f64;
    loop {
        let sum: u64 = shares.iter().sum();
        let by_missing =
            |a: &usize, b: &usize| missing(&shares, *a).total_cmp(&missing(&shares, *b));
        if sum < batch_paths {
            let Some(most) = places.clone().max_by(by_missing) else { return shares };
            shares[most] += 1;
        } else if sum > batch_paths {
            let shared = places.clone().filter(|place| shares[*place] > 1);
            let Some(least) = shared.min_by(by_missing) else { return shares };
            shares[least] -= 1;
        } else {
            return shares;
        }
    }
}
