//! The counts of one sensor, and the light that it counts.

use crate::scene::{LightGroupId, Scene, SensorId, SourceId};
use crate::transport::tally::cell_stimuli::CellStimuli;
use crate::transport::tally::cells::Cells;
use crate::transport::tally::colour::{Stimuli, Stimulus};
use crate::transport::{Layout, TAILS};
use serde::{Deserialize, Serialize};
use smallvec::SmallVec;
use std::collections::BTreeMap;

/// Bins of the histogram of depths: depths 0 to 1023 one by one, then one for each doubling.
pub(crate) const DEPTH_BINS: usize = 1024 + 32;
/// Path classes kept per sensor; the weakest beyond that are summed as one.
const CLASS_LIMIT: usize = 256;

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
    /// Paths that could bring it light.
    pub paths: u64,
    /// Flux per cell, lm or W.
    pub cells: Cells,
    /// The part of it from each light group.
    pub groups: Vec<Cells>,
    /// Tristimulus values of all of it; `None` without spectra.
    pub stimuli: Option<CellStimuli>,
    /// Flux per depth of path, lm or W.
    pub depths: Cells,
    /// Flux by path class.
    #[serde(with = "pairs")]
    pub classes: BTreeMap<Trail, ClassSum>,
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
    /// Its wavelength, nm.
    pub wavelength: f64,
}

/// Adds light to the scalars of a sensor.
#[inline(always)]
fn count_totals(sums: &mut [f64], layout: &Layout, id: SensorId, light: &DetectedLight) {
    let &DetectedLight { flux, depth, source, .. } = light;
    sums[layout.sensor_flux(id, source)] += flux;
    sums[layout.depth_weighted(id)] += flux * f64::from(depth);
    for (tail, _) in TAILS.iter().enumerate().take_while(|(_, tail)| depth > **tail) {
        sums[layout.deeper(id, tail)] += flux;
    }
}

impl SensorReading {
    /// Nothing counted yet on a sensor of a scene with this many cells, by a batch of this many paths.
    pub(crate) fn new(scene: &Scene, (cells, paths): (usize, u64)) -> Self {
        Self {
            paths,
            cells: Cells::new(cells),
            groups: scene.light.ids().map(|_| Cells::new(cells)).collect(),
            stimuli: scene.is_spectral().then(|| CellStimuli::new(cells)),
            depths: Cells::new(DEPTH_BINS),
            classes: BTreeMap::new(),
        }
    }

    /// Ends a batch: squares are computed.
    pub(crate) fn close_batch(&mut self) {
        self.cells.close_batch();
        self.groups.iter_mut().for_each(Cells::close_batch);
        self.stimuli.iter_mut().for_each(CellStimuli::close_batch);
        self.depths.close_batch();
    }

    /// Multiplies the flux of all cells and depths of batches that have ended; colours of cells do not depend on it.
    pub(crate) fn scale(&mut self, factor: f64) {
        self.cells.scale(factor);
        self.groups.iter_mut().for_each(|cells| cells.scale(factor));
        self.depths.scale(factor);
    }

    /// Makes it `a` times its counts and `b` times those of another.
    pub(crate) fn combine(&mut self, shares: [f64; 2], other: &Self) {
        self.each(other, |own, other| *own = own.combined(shares, other));
        let stimuli = self.stimuli.iter_mut().zip(&other.stimuli);
        stimuli.for_each(|(own, other)| *own = own.combined(shares, other));
    }

    /// Adds the counts of the batches that follow.
    pub(crate) fn merge(&mut self, later: &Self) {
        self.paths += later.paths;
        self.each(later, Cells::merge);
        self.stimuli.iter_mut().zip(&later.stimuli).for_each(|(own, later)| own.merge(later));
        merge_classes(&mut self.classes, &later.classes);
    }

    /// All fluxes of cells, each with those of another reading.
    fn each(&mut self, other: &Self, mut act: impl FnMut(&mut Cells, &Cells)) {
        act(&mut self.cells, &other.cells);
        self.groups.iter_mut().zip(&other.groups).for_each(|(own, other)| act(own, other));
        act(&mut self.depths, &other.depths);
    }

    /// Counts light in a cell, as all light, as that of the light groups of its source, and by its colour.
    #[inline]
    pub(crate) fn add_to_cell(
        &mut self,
        cell: usize,
        light: &DetectedLight,
        groups: &[LightGroupId],
    ) {
        self.cells.add(cell, light.flux);
        if let Some(stimuli) = &mut self.stimuli {
            stimuli.add(cell, light.flux, light.wavelength);
        }
        for group in groups {
            self.groups[group.index()].add(cell, light.flux);
        }
    }

    /// Counts light on the sensor as a whole: in its scalars among `sums`, by depth and by wavelength.
    #[inline]
    pub(crate) fn add(
        &mut self,
        sums: &mut [f64],
        layout: &Layout,
        id: SensorId,
        light: &DetectedLight,
    ) {
        count_totals(sums, layout, id, light);
        self.depths.add(Self::depth_bin(light.depth), light.flux);
        if layout.has_colours() {
            let stimuli = Stimuli::of(light.flux, light.wavelength);
            for (stimulus, value) in Stimulus::ALL.into_iter().zip(stimuli.values) {
                sums[layout.stimulus(id, stimulus)] += value;
            }
            let [_, _, radiant, ..] = stimuli.values;
            sums[layout.spectrum(id, stimuli.bin)] += radiant;
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
