//! The angles at which gather paths start, learned before a run from where their light comes.

use crate::scene::{PolarLaw, PolarSquares, SensorId};
use crate::transport::backward::paths::{Backward, UNCOUNTED_BATCH};
use crate::transport::stop::{Pace, StopSignal};
use crate::transport::task::Task;

/// Work from which all sensors of a run learn, ns of the reference machine: a hundredth of a run of a second.
pub(crate) const LEARNING: f64 = 1e7;
/// Least paths of a set from which a sensor learns: eight in a bin.
const LEAST: u64 = 256;
/// Most of them.
const MOST: u64 = 1 << 14;
/// Batches of the two sets.
const BATCHES: [u64; 2] = [UNCOUNTED_BATCH + 1, UNCOUNTED_BATCH + 2];

impl Backward<'_> {
    /// The law of angles of each sensor, learned from at most this many paths of all sensors; the cosine law where these are too few,
    /// as in scenes with very long paths. `None` if the signal stopped it.
    pub(crate) fn learned_laws(&self, paths: f64, signal: &StopSignal) -> Option<Vec<PolarLaw>> {
        let mut laws = vec![PolarLaw::Cosine; self.sensors.len()];
        let seeing = |place: &usize| self.sensors[*place].1.see_half_spaces();
        let seeing: Vec<usize> = (0..laws.len()).filter(seeing).collect();
        let each = (paths / (BATCHES.len() * seeing.len().max(1)) as f64) as u64;
        if seeing.is_empty() || each < LEAST {
            return Some(laws);
        }
        let ids: Vec<SensorId> = seeing.iter().map(|&place| self.sensors[place].0).collect();
        let learning = Self::new(self.scene, &ids, self.seed, self.bounce_limit)
            .with_paths(each.min(MOST))
            .with_laws(&vec![PolarLaw::EvenBins; ids.len()]);
        let [one, other] = BATCHES.map(|batch| learning.found_by_angle(batch, signal));
        for (place, sets) in seeing.into_iter().zip(one?.into_iter().zip(other?)) {
            laws[place] = PolarLaw::learned(&sets.into());
        }
        Some(laws)
    }

    /// The same with these laws of the angles of its sensors.
    pub(crate) fn with_laws(mut self, laws: &[PolarLaw]) -> Self {
        for ((_, arrivals), law) in self.sensors.iter_mut().zip(laws) {
            arrivals.set_polar(law.clone());
        }
        self
    }

    /// For each sensor, the sums of squared radiances by angle that the paths of a batch find.
    fn found_by_angle(&self, batch: u64, signal: &StopSignal) -> Option<Vec<PolarSquares>> {
        let pace = Pace::new(signal);
        let mut found = vec![PolarSquares::default(); self.sensors.len()];
        let task = Task { batch, stage: 0, photon_fluxes: &[], pace: &pace };
        self.trace_watched(task, &mut |sensor, arrival, radiance| {
            found[sensor][arrival.polar_bin()] += radiance * radiance;
        })?;
        Some(found)
    }
}
