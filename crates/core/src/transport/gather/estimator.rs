//! The gather estimator of some sensors, and the records of a pass that wait for its photons.

use crate::plan::RunPlan;
use crate::scene::{Arrivals, Scene, SensorId};
use crate::transport::backward::paths::Backward;
use crate::transport::connect::vertex::scatters;
use crate::transport::gather::bias::Judged;
use crate::transport::gather::records::Records;
use crate::transport::gather::settings::{GatherSettings, SensorGroup, WAVE_PASSES};
use crate::transport::gather::shares::MergedRecord;
use crate::transport::gather::surfaces::SurfaceNumbers;
use crate::transport::gather::watched::WatchedLegs;
use crate::transport::photon_pilot::PhotonPilot;
use crate::transport::walk::emitters::Emitters;
use crate::transport::{Layout, Readings, Stage};
use smallvec::SmallVec;

/// Shared data of all passes of a run.
#[derive(Debug)]
pub(crate) struct Gather<'s> {
    pub(super) scene: &'s Scene,
    pub(super) layout: Layout,
    pub(super) emitters: Emitters<'s>,
    pub(super) surfaces: SurfaceNumbers,
    pub(super) sensors: Vec<(SensorId, Arrivals<'s>)>,
    pub(super) seed: u64,
    pub(crate) settings: GatherSettings,
    /// Merged: weights and connections of its gather paths beyond their records.
    pub(crate) merging: Option<Backward<'s>>,
}

/// What gather paths are combined with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Combination {
    /// Nothing: they end at records.
    Alone,
    /// Forward and backward: they go on to the sources.
    Merged,
}

impl<'s> Gather<'s> {
    /// Prepares gather paths from a group of sensors, alone or merged.
    pub(crate) fn prepare(
        scene: &'s Scene,
        plan: &RunPlan,
        (group, combination): (&SensorGroup, Combination),
        pilot: PhotonPilot,
    ) -> Self {
        let SensorGroup { sensors, mut settings, .. } = group.clone();
        if combination == Combination::Merged && plan.gather.records.is_none() {
            // Merged gather paths continue as far as photons do.
            let most = match pilot.pass_work {
                Some(_) => settings.photons / settings.all_sensors,
                None => u64::MAX,
            };
            // Where light is scattered, each may leave records at all vertices up to D.
            let vertices = if scatters(scene) { u64::from(settings.depth) + 1 } else { 1 };
            settings.gather_paths = (settings.gather_paths / vertices).min(most).max(1);
        }
        let alone = Self::new(scene, &sensors, plan.seed, settings);
        match combination {
            Combination::Alone => alone,
            Combination::Merged => alone.merged(plan.bounce_limit),
        }
    }

    /// The same, merged, with gather paths up to this many interfaces.
    pub(super) fn merged(self, bounce_limit: u32) -> Self {
        let sensors: Vec<SensorId> = self.sensors().collect();
        Self { merging: Some(Backward::new(self.scene, &sensors, self.seed, bounce_limit)), ..self }
    }

    /// Prepares gather paths from some sensors.
    pub(crate) fn new(
        scene: &'s Scene,
        sensors: &[SensorId],
        seed: u64,
        settings: GatherSettings,
    ) -> Self {
        Self {
            scene,
            layout: Layout::new(scene),
            emitters: Emitters::new(scene),
            surfaces: SurfaceNumbers::new(scene),
            sensors: sensors.iter().map(|&id| (id, Arrivals::new(scene, id))).collect(),
            seed,
            settings,
            merging: None,
        }
    }

    /// Passes that share photons and records. With spectra one: passes of a block would have to share wavelengths, and their spread would not
    /// contain the scatter by wavelength.
    pub(crate) fn passes_together(&self) -> u64 {
        if self.scene.is_spectral() { 1 } else { WAVE_PASSES }
    }

    /// Gather paths of a pass from all of its sensors.
    pub(crate) fn batch_paths(&self, stage: u32) -> u64 {
        self.settings.gather_paths(stage) * self.sensors.len() as u64
    }

    /// The sensors.
    pub(crate) fn sensors(&self) -> impl Iterator<Item = SensorId> {
        self.sensors.iter().map(|(id, _)| *id)
    }

    /// How many times the window should shrink after the last of the stages, which is in progress: 0 where noise limits all
    /// sensors, or, with fewer passes than planned, where the bias of each is within two standard errors. Of several sensors
    /// that bias limits, the smallest number counts.
    pub(crate) fn shrinks(&self, stages: &[Stage], photons: &Readings) -> u32 {
        let Some((stage, earlier)) = stages.split_last() else { return 0 };
        let passes = stage.counts.first().batch_count();
        let is_complete = passes >= self.settings.planned_passes(stage.number);
        let wanted = self.sensors.iter().filter_map(|(id, _)| {
            let slots = self.layout.flux_slots(*id);
            let judged = Judged::new((stage, earlier.last()), photons, &slots);
            let limits =
                if is_complete { judged.is_limiting() } else { judged.is_plainly_limiting() };
            limits.then(|| judged.shrinks(self.settings.variance_growth(stage.number)))
        });
        if self.settings.has_stages() { wanted.min().unwrap_or(0) } else { 0 }
    }
}

/// Gather paths that have ended, and their records, ready for photons.
#[derive(Debug)]
pub(super) struct WaitingRecords<'s> {
    pub(super) paths: Vec<RecordedPath<'s>>,
    pub(super) records: Records<'s>,
    pub(super) watched: WatchedLegs,
}

/// A gather path that has ended in records.
#[derive(Debug)]
pub(super) struct RecordedPath<'s> {
    /// Its number among those of its sensor.
    pub(super) index: u64,
    pub(super) sensor: SensorId,
    /// Its pass in the block.
    pub(super) pass: usize,
    pub(super) cells: SmallVec<[usize; 1]>,
    /// Merged: what weights its only record.
    pub(super) merged: Option<MergedRecord<'s>>,
}
