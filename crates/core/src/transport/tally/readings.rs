//! The counts of a run: one serialisable value that can be added to another of the same scene.
//!
//! Scalars (the balance, the flux on each sensor) are summed in [`GROUPS`] groups of batches, so that errors of ratios
//! and other functions of them follow from the groups. Maps keep a sum and a sum of squares over batches per cell.
//! Batches are folded in a fixed binary tree over their index: a range of batches gives the same bits wherever it was
//! traced.

use crate::scene::{LightGroupId, LightGroups, Scene, SensorId, SourceId};
use crate::tally::Tally;
use crate::transport::{Cells, Layout, Loss, TAILS};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use smallvec::SmallVec;
use std::collections::BTreeMap;
use std::ops::Range;

/// Number of groups of batches; batch i belongs to group i mod 128. A full set of groups is needed for an error bar.
pub const GROUPS: u64 = 128;
/// With fewer groups of batches than this that contain anything, the error bar is not trustworthy:
/// the spread of ten samples is itself known to a quarter, 1/sqrt(2 · 9).
pub(crate) const MIN_LIT_GROUPS: usize = 10;
/// Bins of the histogram of depths: depths 0 to 1023 one by one, then one for each doubling.
pub(crate) const DEPTH_BINS: usize = 1024 + 32;
/// Path classes kept per sensor; the weakest beyond that are summed as one.
const CLASS_LIMIT: usize = 256;
/// Places of leaks that are kept.
const LEAK_LIMIT: usize = 8;
/// Format of the serialised readings.
const FORMAT: u32 = 3;

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

/// One step of a path class: a face, and whether the light was reflected or transmitted there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct ClassStep {
    /// Index of the face.
    pub face: u32,
    /// Whether the light was transmitted.
    pub transmitted: bool,
}

/// A path class: the steps of a path, with repeats of a step counted once; `None` ends a trail that
/// was cut off.
pub(crate) type Trail = SmallVec<[Option<ClassStep>; 8]>;

/// Flux of a path class.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct ClassSum {
    /// Sum of the flux over batches, lm or W.
    pub flux: f64,
    /// Sum of flux times depth.
    pub depth_weighted: f64,
}

/// Counts of one sensor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SensorReading {
    /// Flux per cell, lm or W.
    pub cells: Cells,
    /// The part of it from each light group.
    pub groups: Vec<Cells>,
    /// Flux per depth of path, lm or W.
    pub depths: Cells,
    /// Flux by path class.
    #[serde(with = "pairs")]
    pub classes: BTreeMap<Trail, ClassSum>,
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
        let sensor = |cells| SensorReading {
            cells: Cells::new(cells),
            groups: scene.light.ids().map(|_| Cells::new(cells)).collect(),
            depths: Cells::new(DEPTH_BINS),
            classes: BTreeMap::new(),
        };
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
            sensors: scene.sensors.iter().map(|s| sensor(s.cells())).collect(),
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

    /// Ends a batch: squares are computed.
    pub fn close_batch(&mut self) {
        for sensor in &mut self.sensors {
            sensor.cells.close_batch();
            sensor.groups.iter_mut().for_each(Cells::close_batch);
            sensor.depths.close_batch();
        }
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
            own.cells = own.cells.combined([a, b], &other.cells);
            for (own, other) in own.groups.iter_mut().zip(&other.groups) {
                *own = own.combined([a, b], other);
            }
            own.depths = own.depths.combined([a, b], &other.depths);
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
        for (own, other) in self.sensors.iter_mut().zip(&later.sensors) {
            own.cells.merge(&other.cells);
            own.groups.iter_mut().zip(&other.groups).for_each(|(own, other)| own.merge(other));
            own.depths.merge(&other.depths);
            merge_classes(&mut own.classes, &other.classes);
        }
        let room = LEAK_LIMIT.saturating_sub(self.leaks.len());
        self.leaks.extend(later.leaks.iter().take(room).cloned());
        self
    }

    /// The scalars of all groups except one, without cells.
    pub(crate) fn without_group(&self, left_out: u64) -> Self {
        let kept = self.groups.iter().filter(|group| group.group != left_out);
        Self {
            groups: kept.cloned().collect(),
            sensors: Vec::new(),
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
            reading.add(cell, light.flux, groups.of(light.source));
        }
        reading.depths.add(SensorReading::depth_bin(light.depth), light.flux);
        count_totals(&mut self.groups[0].sums, layout, id, light);
    }

    /// Counts a gather path of this throughput that was lost, as a share of all that were drawn.
    pub(crate) fn count_lost(
        &mut self,
        layout: &Layout,
        id: SensorId,
        throughput: f64,
        loss: Loss,
    ) {
        self.groups[0].sums[layout.lost_paths(id, loss)] += throughput / self.batch_paths as f64;
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

/// Light that has reached a sensor.
#[derive(Debug, Clone, Copy)]
pub struct DetectedLight {
    /// Its flux, lm or W.
    pub flux: f64,
    /// Depth of its path: visible interfaces met before it, and scatterings within media.
    pub depth: u32,
    /// Its source.
    pub source: SourceId,
}

/// Adds light to the scalars of a sensor.
#[inline(always)]
pub(crate) fn count_totals(sums: &mut [f64], layout: &Layout, id: SensorId, light: &DetectedLight) {
    let &DetectedLight { flux, depth, source } = light;
    sums[layout.sensor_flux(id, source)] += flux;
    sums[layout.depth_weighted(id)] += flux * f64::from(depth);
    for (tail, _) in TAILS.iter().enumerate().take_while(|(_, tail)| depth > **tail) {
        sums[layout.deeper(id, tail)] += flux;
    }
}

impl SensorReading {
    /// Counts flux in a cell, of all light and of the light groups of its source.
    #[inline]
    pub(crate) fn add(&mut self, cell: usize, flux: f64, groups: &[LightGroupId]) {
        self.cells.add(cell, flux);
        for group in groups {
            self.groups[group.index()].add(cell, flux);
        }
    }

    /// The bin of the histogram of depths.
    #[inline]
    pub(crate) fn depth_bin(depth: u32) -> usize {
        let depth = depth as usize;
        if depth < 1024 { depth } else { 1024 + depth.ilog2() as usize - 10 }
    }
}

fn merge_classes(own: &mut BTreeMap<Trail, ClassSum>, other: &BTreeMap<Trail, ClassSum>) {
    for (trail, sum) in other {
        let own = own.entry(trail.clone()).or_default();
        own.flux += sum.flux;
        own.depth_weighted += sum.depth_weighted;
    }
    if own.len() > 2 * CLASS_LIMIT {
        let mut by_flux: Vec<_> = std::mem::take(own).into_iter().collect();
        by_flux.sort_by(|a, b| b.1.flux.total_cmp(&a.1.flux).then_with(|| a.0.cmp(&b.0)));
        for (place, (trail, sum)) in by_flux.into_iter().enumerate() {
            let key = if place < CLASS_LIMIT { trail } else { SmallVec::from_slice(&[None]) };
            let own = own.entry(key).or_default();
            own.flux += sum.flux;
            own.depth_weighted += sum.depth_weighted;
        }
    }
}

/// Maps with non-string keys, as lists of pairs.
mod pairs {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};
    use std::collections::BTreeMap;

    pub(super) fn serialize<K: Serialize, V: Serialize, S: Serializer>(
        map: &BTreeMap<K, V>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(map)
    }

    pub(super) fn deserialize<
        'de,
        K: Deserialize<'de> + Ord,
        V: Deserialize<'de>,
        D: Deserializer<'de>,
    >(
        deserializer: D,
    ) -> Result<BTreeMap<K, V>, D::Error> {
        Ok(Vec::<(K, V)>::deserialize(deserializer)?.into_iter().collect())
    }
}
