//! Photons that stream past the records of a pass: each is counted by every record that takes it.

use crate::optics::Incidence;
use crate::scene::shape::Toward;
use crate::scene::{MediumId, Scene, SourceId, Visibility};
use crate::transport::estimate::{Arriving, Kernel};
use crate::transport::forward::PhotonWatcher;
use crate::transport::gather::{Ended, Gather, Waiting};
use crate::transport::readings::Counted;
use crate::transport::records::Slot;
use crate::transport::window::NESTED;
use crate::transport::work::RecordWork;
use crate::transport::{Path, Readings, Vertex};

/// Photons that stream past the records.
pub(super) struct Stream<'p, 's> {
    pub(super) gather: &'p Gather<'s>,
    pub(super) kernel: Kernel,
    pub(super) waiting: &'p Waiting<'s>,
    pub(super) windows: &'p mut [Readings; NESTED],
    pub(super) work: RecordWork,
}

impl PhotonWatcher for Stream<'_, '_> {
    #[inline(always)]
    fn arrive(&mut self, path: &Path, vertex: &Vertex<'_>, flux: f64, source: SourceId) {
        if self.may_take(vertex) {
            self.look_up(path, vertex, flux * vertex.throughput, source, |_| [1.0; NESTED]);
        }
    }
}

impl Stream<'_, '_> {
    /// Whether there may be records for a photon.
    #[inline(always)]
    pub(super) fn may_take(&self, vertex: &Vertex<'_>) -> bool {
        let surface = self.gather.surfaces.of(vertex.interface.acting.prim);
        vertex.interface.visibility == Visibility::Visible
            && self.waiting.records.may_take(surface, vertex.point, vertex.dir)
    }

    /// `weigh` tells how much counts within each window of what a gather path and the photon bring together, 1.
    #[inline(never)]
    pub(super) fn look_up(
        &mut self,
        path: &Path,
        vertex: &Vertex<'_>,
        flux: f64,
        source: SourceId,
        weigh: impl Fn(&Ended) -> [f64; NESTED],
    ) {
        let Gather { scene, surfaces, layout, .. } = self.gather;
        let surface = surfaces.of(vertex.interface.acting.prim);
        // Most photons that pass the filter are near no record after all.
        let mut known = None;
        let (kernel, windows, work) = (&self.kernel, &mut *self.windows, &mut self.work);
        work.look_ups += 1;
        self.waiting.records.visit(surface, vertex.point, vertex.dir, |record| {
            let photon = known.get_or_insert_with(|| arriving(scene, surface, path, vertex));
            let Some(shares) = kernel.flux(record, photon) else { return };
            work.pairs += 1;
            let ended = &self.waiting.paths[record.path as usize];
            let (Ended { sensor, cells, .. }, weights) = (ended, weigh(ended));
            let depth = path.depth + record.depth;
            for ((readings, share), weight) in windows.iter_mut().zip(shares).zip(weights) {
                if share > 0.0 {
                    let light = Counted { flux: flux * share * weight, depth, source };
                    readings.count(layout, *sensor, cells, &light);
                }
            }
        });
        work.near += u64::from(known.is_some());
    }
}

/// A photon as records take it.
fn arriving(scene: &Scene, surface: Slot, path: &Path, vertex: &Vertex<'_>) -> Arriving {
    let interface = vertex.interface;
    let index = |medium: MediumId| scene.media[medium.index()].index(path.wavelength);
    let outward = scene.normal(interface.acting.prim, vertex.point);
    Arriving {
        surface,
        medium: interface.from,
        point: vertex.point,
        incidence: Incidence {
            dir: vertex.dir,
            normal: match interface.acting.toward {
                Toward::Front => -outward,
                Toward::Back => outward,
            },
            index_from: index(interface.from),
            index_to: index(interface.to),
        },
    }
}
