//! The counts of a run: one serialisable value that can be added to another of the same scene.
//!
//! Scalars (the balance, the flux on each sensor) are summed in [`GROUPS`] groups of batches, so that errors of ratios
//! and other functions of them follow from the groups. Maps keep a sum and a sum of squares over batches per cell.
//! Batches are folded in a fixed binary tree over their index: a range of batches gives the same bits wherever it was
//! traced.

use crate::scene::{LightGroups, Scene, SensorId};
use crate::tally::Tally;
use crate::transport::tally::controls::Controls;
use crate::transport::tally::sensor_reading::{DetectedLight, SensorReading};
use crate::transport::{Layout, Loss};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Number of groups of batches; batch i belongs to group i mod 128. With fewer batches each is a group of its own.
pub const GROUPS: u64 = 128;
/// With fewer groups of batches than this that contain anything, the error bar is not trustworthy:
/// the spread of ten samples is itself known to a quarter, 1/sqrt(2 · 9).
pub(crate) const MIN_LIT_GROUPS: usize = 10;
/// Places of leaks that are kept.
const LEAK_LIMIT: usize = 8;
/// Format of the serialised readings.
const FORMAT: u32 = 6;

/// Sums over the batches of one group.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Group {
    /// Number of the group.
    pub group: u64,
    /// Number of batches in it.
    pub batches: u64,
    /// The scalars in the order of [`Layout`], lm or W.
    pub sums: Vec<f64>,
}

/// A point where a path was lost.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Leak {
    /// Start of the last segment, mm, relative to the scene's origin.
    pub point: DVec3,
    /// Its direction.
    pub dir: DVec3,
}

/// Everything counted in a range of batches.
///
/// Every batch carries the whole flux of the sources, divided among its paths. So the mean of a sum over
/// batches is a flux, in lm or W, and nothing is normalised afterwards.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Readings {
    /// Version of this format.
    pub format: u32,
    /// Seed of the random streams.
    pub seed: u64,
    /// Paths in every batch.
    pub batch_paths: u64,
    /// The batches counted.
    pub batches: Range<u64>,
    /// Scalars by group of batches, ascending. These are not light groups.
    pub groups: Vec<Group>,
    /// One for each sensor.
    pub sensors: Vec<SensorReading>,
    /// Surprises at the choices of photons.
    pub controls: Controls,
    /// Segments traced: the work done.
    pub segments: u64,
    /// Places of sources and sensors that vertices were joined to, be they visible or not.
    pub joins: u64,
    /// The first places of leaks.
    pub leaks: Vec<Leak>,
}

impl Readings {
    /// An empty batch.
    pub fn of_batch(
        scene: &Scene,
        layout: &Layout,
        seed: u64,
        batch_paths: u64,
        batch: u64,
    ) -> Self {
        Self {
            format: FORMAT,
            seed,
            batch_paths,
            batches: batch..batch + 1,
            groups: vec![Group {
                group: batch % GROUPS,
                batches: 1,
                sums: vec![0.0; layout.len()],
            }],
            sensors: scene
                .sensors
                .iter()
                .map(|sensor| SensorReading::new(scene, (sensor.cells(), batch_paths)))
                .collect(),
            controls: Controls::default(),
            segments: 0,
            joins: 0,
            leaks: Vec::new(),
        }
    }

    /// Batches with these sums, and without cells.
    #[cfg(test)]
    pub(crate) fn of_groups(groups: Vec<Group>) -> Self {
        let [first, last] =
            [groups.first(), groups.last()].map(|group| group.map_or(0, |own| own.group));
        Self {
            format: FORMAT,
            seed: 0,
            batch_paths: 1,
            batches: first..last + 1,
            groups,
            sensors: Vec::new(),
            controls: Controls::default(),
            segments: 0,
            joins: 0,
            leaks: Vec::new(),
        }
    }

    /// Number of batches.
    pub fn batch_count(&self) -> u64 {
        self.batches.end - self.batches.start
    }

    /// Number of paths.
    pub fn paths(&self) -> u64 {
        self.batch_count() * self.batch_paths
    }

    /// Number of paths that could bring light to a sensor; of all paths where the readings have no cells.
    pub(crate) fn paths_for(&self, id: SensorId) -> u64 {
        self.sensors.get(id.index()).map_or_else(|| self.paths(), |own| own.paths)
    }

    /// Ends a batch: squares are computed.
    pub fn close_batch(&mut self) {
        self.sensors.iter_mut().for_each(SensorReading::close_batch);
    }

    /// A batch with `a` times the counts of this one and `b` times those of another of the same
    /// paths; not yet closed.
    pub fn combined(&self, [a, b]: [f64; 2], other: &Self) -> Self {
        let mut sum = self.clone();
        for (own, other) in sum.groups.iter_mut().zip(&other.groups) {
            own.sums
                .iter_mut()
                .zip(&other.sums)
                .for_each(|(own, other)| *own = a * *own + b * other);
        }
        for (own, other) in sum.sensors.iter_mut().zip(&other.sensors) {
            own.combine([a, b], other);
        }
        sum
    }

    /// Adds the batches that follow directly.
    pub fn merge(mut self, later: &Self) -> Self {
        debug_assert_eq!(self.batches.end, later.batches.start, "batches are merged in order");
        self.batches.end = later.batches.end;
        self.segments += later.segments;
        self.joins += later.joins;
        for group in &later.groups {
            match self.groups.binary_search_by_key(&group.group, |own| own.group) {
                Ok(place) => {
                    let own = &mut self.groups[place];
                    own.batches += group.batches;
                    own.sums.iter_mut().zip(&group.sums).for_each(|(own, sum)| *own += sum);
                }
                Err(place) => self.groups.insert(place, group.clone()),
            }
        }
        for (own, later) in self.sensors.iter_mut().zip(&later.sensors) {
            own.merge(later);
        }
        self.controls.merge(&later.controls);
        let room = LEAK_LIMIT.saturating_sub(self.leaks.len());
        self.leaks.extend(later.leaks.iter().take(room).cloned());
        self
    }

    /// The scalars of all groups except one, without cells.
    pub(crate) fn without_group(&self, left_out: u64) -> Self {
        let kept = self.groups.iter().filter(|group| group.group != left_out);
        self.with_groups(kept.cloned().collect())
    }

    /// The scalars of other groups, without cells.
    pub(super) fn with_groups(&self, groups: Vec<Group>) -> Self {
        Self {
            groups,
            sensors: Vec::new(),
            controls: Controls::default(),
            leaks: Vec::new(),
            batches: self.batches.clone(),
            ..*self
        }
    }

    /// Counts light that gather paths, or photons at their records, bring to some cells of a sensor, in a
    /// batch. `groups` are the light groups of the scene.
    pub fn count(
        &mut self,
        (layout, groups): (&Layout, &LightGroups),
        id: SensorId,
        cells: &[usize],
        light: &DetectedLight,
    ) {
        let reading = &mut self.sensors[id.index()];
        for &cell in cells {
            reading.add_to_cell(cell, light, groups.of(light.source));
        }
        reading.add(&mut self.groups[0].sums, layout, id, light);
    }

    /// Counts a gather path that was lost: its throughput over the number of all that were drawn from the sensor.
    pub(crate) fn count_lost(&mut self, layout: &Layout, id: SensorId, share: f64, loss: Loss) {
        self.groups[0].sums[layout.lost_paths(id, loss)] += share;
    }

    /// Groups of batches in which any of some scalars is not zero.
    pub(crate) fn lit_groups(&self, slots: &[usize]) -> usize {
        let lit = |sums: &[f64]| slots.iter().any(|&slot| sums[slot] != 0.0);
        self.groups.iter().filter(|group| lit(&group.sums)).count()
    }

    /// The sum of some scalars as a mean over groups, with its standard error.
    pub(crate) fn sum(&self, slots: &[usize]) -> Tally {
        self.function(|flux| slots.iter().map(|&slot| flux(slot)).sum())
    }

    /// A scalar as a mean over groups, with its standard error.
    pub fn scalar(&self, slot: usize) -> Tally {
        self.function(|sums| sums(slot))
    }

    /// A function of scalars for each group, as a tally: valid for sums and differences.
    pub fn function(&self, f: impl Fn(&dyn Fn(usize) -> f64) -> f64) -> Tally {
        let of_group = |group: &Group| f(&|slot| group.sums[slot] / group.batches as f64);
        let first = self.groups.first().map(|group| group.batches);
        if self.groups.iter().all(|group| Some(group.batches) == first) {
            return Tally::of(self.groups.iter().map(of_group));
        }
        // A run that was stopped in a wave has more batches in some groups than in others.
        Tally::weighted(self.groups.iter().map(|group| (of_group(group), group.batches)))
    }

    /// Any smooth function of mean scalars, with its standard error by the delete-one-group
    /// jackknife (Miller, Biometrika 61 (1974) 1): valid for ratios.
    pub(crate) fn jackknife(&self, f: impl Fn(&dyn Fn(usize) -> f64) -> f64) -> (f64, f64) {
        let batches: u64 = self.groups.iter().map(|group| group.batches).sum();
        let total = |slot: usize| self.groups.iter().map(|group| group.sums[slot]).sum::<f64>();
        let value = f(&|slot| total(slot) / batches as f64);
        let without = Tally::of(self.groups.iter().map(|group| {
            f(&|slot| (total(slot) - group.sums[slot]) / (batches - group.batches).max(1) as f64)
        }));
        // The jackknife's variance is (g - 1)² that of the mean of the leave-one-out values.
        let groups = self.groups.len() as f64;
        (value, without.std_error() * (groups - 1.0))
    }
}
