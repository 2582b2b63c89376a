//! Gather paths from some sensors: what all batches of a run share.
//!
//! This module traces nothing.

use crate::rng::{Dimension, Points, Sampler, StratumShares, stream};
use crate::scene::{Arrivals, Scene, SensorId, Strata};
use crate::transport::Layout;
use crate::transport::connect::passage::RecordPlaces;
use crate::transport::connect::sensors::SensorTargets;
use crate::transport::connect::sources::{SourcePoint, SourceTargets};
use crate::transport::connect::vertex::TurnAt;
use crate::transport::connect::weights::Sharing;
use crate::transport::trial::strata::{PAIR, TriedStrata};
use crate::transport::walk::emitters::Emitters;

/// Gather paths of a batch from each sensor where no number is given: they measure their work.
const PILOT_PATHS: u64 = 64;
/// First of the batches that do not count: of pilots, and of learning.
pub(super) const UNCOUNTED_BATCH: u64 = 1 << 40;

/// Shared data of all batches of a run.
#[derive(Debug)]
pub(crate) struct Backward<'s> {
    pub(crate) scene: &'s Scene,
    pub(crate) layout: Layout,
    pub(crate) emitters: Emitters<'s>,
    /// What vertices of gather paths, and of photons, are joined to.
    pub(crate) joined_sources: SourceTargets<'s>,
    pub(crate) joined_sensors: SensorTargets<'s>,
    /// Sorted by id.
    pub(crate) sensors: Vec<(SensorId, Arrivals<'s>)>,
    /// The strata of each, where gather paths start in every cell equally often.
    pub(crate) strata: Vec<Strata<'s>>,
    pub(crate) seed: u64,
    pub(crate) bounce_limit: u32,
    /// Gather paths per batch of each sensor, before they are divided evenly among its cells.
    pub(crate) paths: u64,
    /// The same of a batch of a run for each sensor alone, in a trial.
    of_run: Option<Vec<u64>>,
    pub(crate) weights: Weights,
    /// How all techniques that find a path divide its light.
    pub(crate) sharing: Sharing,
}

/// How the light of gather paths counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Weights {
    /// In full.
    Full,
    /// In shares, as photons count the rest.
    Shared,
}

/// Batches whose photons and gather paths find light together.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SharedBatches {
    /// Their number.
    pub(crate) batches: f64,
    /// Where their gather paths leave records, if they do.
    pub(crate) places: Option<RecordPlaces>,
}

impl SharedBatches {
    /// A batch alone, without records.
    pub(crate) const ALONE: Self = Self { batches: 1.0, places: None };
}

impl<'s> Backward<'s> {
    /// Prepares gather paths from some sensors, a few a batch from each.
    pub(crate) fn new(
        scene: &'s Scene,
        sensors: &[SensorId],
        seed: u64,
        bounce_limit: u32,
    ) -> Self {
        let mut sensors: Vec<_> =
            sensors.iter().map(|&id| (id, Arrivals::new(scene, id))).collect();
        sensors.sort_by_key(|(id, _)| *id);
        Self {
            scene,
            layout: Layout::new(scene),
            emitters: Emitters::new(scene),
            joined_sources: SourceTargets::new(scene),
            joined_sensors: SensorTargets::new(scene, sensors.iter().map(|(id, _)| *id)),
            sensors,
            strata: Vec::new(),
            seed,
            bounce_limit,
            paths: PILOT_PATHS,
            of_run: None,
            weights: Weights::Full,
            sharing: Sharing::default(),
        }
    }

    /// The same with about this many paths per batch from each sensor.
    pub(crate) fn with_paths(self, paths: u64) -> Self {
        Self { paths: Points::even_count(paths), ..self }
    }

    /// The same with paths in proportion to these numbers, new and old.
    pub(crate) fn resized(self, [new, old]: [u64; 2]) -> Self {
        let paths = self.paths * new / old;
        self.with_paths(paths)
    }

    /// The same from every cell of a sensor equally often. Photons that share light with gather paths do not know this.
    pub(crate) fn in_cells(self) -> Self {
        let strata = self.sensors.iter().map(|(_, arrivals)| arrivals.strata()).collect();
        Self { strata, ..self }
    }

    /// The same as a trial of batches with so many paths from a sensor with this many strata: in some of them, if they are many.
    pub(crate) fn trying(self, paths: impl Fn(u64) -> u64) -> Self {
        let of_run = (0..self.sensors.len()).map(|sensor| paths(self.strata_count(sensor)));
        Self { of_run: Some(of_run.collect()), ..self }
    }

    /// The same with other weights.
    pub(crate) fn with_weights(self, weights: Weights) -> Self {
        Self { weights, ..self }
    }

    /// The sensors.
    pub(crate) fn sensors(&self) -> impl Iterator<Item = SensorId> {
        self.sensors.iter().map(|(id, _)| *id)
    }

    /// Gather paths of all sensors in a batch.
    pub(crate) fn batch_paths(&self) -> u64 {
        (0..self.sensors.len()).map(|sensor| self.shares(sensor).paths).sum()
    }

    /// The gather paths of a batch from a sensor, by its place among the sensors.
    pub(crate) fn shares(&self, sensor: usize) -> StratumShares {
        let strata = self.strata_count(sensor);
        match &self.of_run {
            None => StratumShares::of(strata, self.paths),
            Some(of_run) => StratumShares::of(strata, of_run[sensor]).for_trial(self.paths),
        }
    }

    /// Strata of a sensor, by its place among the sensors; 1 where nothing is divided.
    fn strata_count(&self, sensor: usize) -> u64 {
        self.strata.get(sensor).map_or(1, Strata::count) as u64
    }

    /// The shares of one batch. In a trial, each pair of batches takes the same randomly drawn strata.
    pub(crate) fn shares_of_batch(&self, sensor: usize, batch: u64) -> StratumShares {
        let shares = self.shares(sensor);
        if self.of_run.is_none() {
            return shares;
        }
        let of_sensor = stream::TRIED_CELLS + self.sensors[sensor].0.index() as u64;
        let mut pair = Sampler::for_path(self.seed, of_sensor, batch / PAIR as u64);
        shares.turned(pair.one(Dimension::GatherCell))
    }

    /// The strata of a sensor that a trial takes, by its place among the sensors; `None` if the run will not have paths in all.
    pub(crate) fn tried_strata(&self, sensor: usize) -> Option<TriedStrata> {
        let strata = self.strata_count(sensor);
        let each_of_run = StratumShares::of(strata, self.of_run.as_ref()?[sensor]).each();
        let shares = self.shares(sensor);
        let tried = TriedStrata { share: shares.share(), each: shares.each(), each_of_run };
        (strata > 1 && each_of_run > 0).then_some(tried)
    }

    /// The etendue of a gather path joined to a source at a turn over that of one that meets its
    /// place; infinite if it is not joined.
    pub(crate) fn joined_to_source(
        &self,
        sensor: SensorId,
        turn: Option<TurnAt<'s>>,
        place: &SourcePoint,
    ) -> f64 {
        // The light of a join could have passed the sensor before.
        if self.scene.sensors[sensor.index()].counts_first_passage() {
            return f64::INFINITY;
        }
        self.joined_sources.joined_ratio(turn, place)
    }
}
