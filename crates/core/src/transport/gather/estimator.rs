//! Shared data of all passes of gathering, the definition of one pass, and the records that wait
//! for its photons.

use crate::scene::{Arrivals, Scene, SensorId};
use crate::transport::gather::merge::Etendues;
use crate::transport::gather::records::Records;
use crate::transport::gather::surfaces::Surfaces;
use crate::transport::gather::window::{ESTIMATES, Window};
use crate::transport::tally::work::RecordWork;
use crate::transport::walk::emitters::Emitters;
use crate::transport::{Layout, Readings};
use smallvec::SmallVec;

/// Shared data of all passes of a run.
#[derive(Debug)]
pub(crate) struct Gather<'s> {
    pub(super) scene: &'s Scene,
    pub(super) layout: Layout,
    pub(super) emitters: Emitters<'s>,
    pub(super) surfaces: Surfaces,
    pub(super) sensors: Vec<(SensorId, Arrivals<'s>)>,
    pub(super) seed: u64,
    /// Vertex at which gather paths end, D.
    pub(crate) depth: u32,
    /// Merged with forward and backward: gather paths continue from vertex D, up to this many
    /// interfaces.
    pub(crate) merging: Option<u32>,
}

/// One pass: its number, its window, and its gather paths of each sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pass {
    pub(crate) batch: u64,
    pub(crate) window: Window,
    pub(crate) gather_paths: u64,
}

/// Counts of a pass.
#[derive(Debug)]
pub(crate) struct PassReadings {
    /// Counts by photons in the sensors' cells, and the balance.
    pub(crate) photons: Readings,
    /// Counts by records: E1, E2, E3 and E0; not yet closed.
    pub(crate) windows: [Readings; ESTIMATES],
    /// Work in addition to tracing.
    pub(crate) work: RecordWork,
}

impl<'s> Gather<'s> {
    /// Prepares gather paths from some sensors that end at vertex `depth`.
    pub(crate) fn new(scene: &'s Scene, sensors: &[SensorId], seed: u64, depth: u32) -> Self {
        Self {
            scene,
            layout: Layout::new(scene),
            emitters: Emitters::new(scene),
            surfaces: Surfaces::new(scene),
            sensors: sensors.iter().map(|&id| (id, Arrivals::new(scene, id))).collect(),
            seed,
            depth,
            merging: None,
        }
    }

    /// Number of sensors it estimates.
    pub(crate) fn sensors(&self) -> u64 {
        self.sensors.len() as u64
    }
}

/// Gather paths that have ended, and their records, ready for photons.
#[derive(Debug)]
pub(super) struct Waiting<'s> {
    pub(super) paths: Vec<Ended>,
    pub(super) records: Records<'s>,
}

/// A gather path that has ended in records.
#[derive(Debug)]
pub(super) struct Ended {
    /// Its number among those of its sensor.
    pub(super) index: u64,
    pub(super) sensor: SensorId,
    pub(super) cells: SmallVec<[usize; 1]>,
    /// Merged: the etendues that weight its only record; the photon's part is still missing.
    pub(super) etendues: Option<Etendues>,
}
