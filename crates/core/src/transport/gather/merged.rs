//! Gathering merged with forward and backward: the share of a path that each of the three counts,
//! by the weights of `merge`.
//!
//! Photons that sensors count, gather paths that meet emission, and pairs of photons and records
//! belong to the same passes. The readings of each order contain all light of a sensor. This
//! module does not know how paths are traced.

use crate::scene::Visibility;
use crate::transport::connect::weights::Etendues;
use crate::transport::gather::block::BlockCounts;
use crate::transport::gather::merge::{FacePassage, ROULETTE_BELOW, Recent};
use crate::transport::gather::stream::{Photon, PhotonStream};
use crate::transport::tally::Counts;
use crate::transport::tally::readings::DetectedLight;
use crate::transport::tally::work::RecordWork;
use crate::transport::walk::follow::{arrivals_of, etendue_of};
use crate::transport::walk::scatter::facing;
use crate::transport::{Departure, Detection, Event, MetEmission, Observer, Path, Vertex};
use std::ops::ControlFlow;

/// Weights for the light of one gather path.
#[derive(Debug)]
pub(super) struct Merging<'a> {
    /// Etendue of the path, its share of the block, mm² sr.
    etendue: f64,
    /// Flux of one photon of each source, its share of a pass, lm or W.
    photon_fluxes: &'a [f64],
    /// Passes of the block.
    passes: f64,
    /// G/q of vertex D once the path has passed it, mm² sr.
    window: f64,
}

impl<'a> Merging<'a> {
    /// Weights of a path with this share of its pass, in a block of this many passes.
    pub(super) fn new(etendue: f64, photon_fluxes: &'a [f64], passes: f64) -> Self {
        Self { etendue: etendue / passes, photon_fluxes, passes, window: 0.0 }
    }

    /// The path has passed vertex D: G/q of the side that it took there, mm² sr.
    pub(super) fn pass_vertex_d(&mut self, window: f64) {
        self.window = window;
    }

    /// Etendues that weight a record of vertex D with this G/q, as far as the gather path knows
    /// them.
    pub(super) fn waiting(&self, window: f64) -> Etendues {
        Etendues::unjoined(f64::INFINITY, self.etendue, window)
    }

    /// Share counted by emission that the path has met, 1.
    pub(super) fn weight(&self, met: &MetEmission) -> f64 {
        let photon = self.photon_fluxes[met.source.index()] / (met.emitted * self.passes);
        Etendues::unjoined(photon, self.etendue, self.window).backward()
    }
}

/// Photons that stream past the records, and also count in the cells of sensors.
pub(crate) struct MergedStream<'p, 's> {
    stream: PhotonStream<'p, 's>,
    photon_fluxes: &'p [f64],
    /// Etendue represented by the current photon, its share of the block, mm² sr.
    photon: f64,
    recent: Recent<'s>,
}

impl<'p, 's> MergedStream<'p, 's> {
    /// The records of a block that wait for its photons.
    pub(crate) fn new(stream: PhotonStream<'p, 's>, photon_fluxes: &'p [f64]) -> Self {
        let recent = Recent::new(stream.gather.settings.depth);
        Self { stream, photon_fluxes, photon: f64::INFINITY, recent }
    }

    /// The counts, and the work in addition to tracing.
    pub(super) fn finish(self) -> (BlockCounts, RecordWork) {
        self.stream.finish()
    }

    /// The photons that follow are those of another pass of the block.
    pub(crate) fn begin_pass(&mut self, place: usize) {
        self.stream.begin_pass(place);
    }

    /// The counts of all passes, after their photons.
    pub(crate) fn into_counts(self) -> Counts {
        self.stream.into_counts()
    }
}

impl Observer for MergedStream<'_, '_> {
    fn roulette_below(&self) -> f64 {
        ROULETTE_BELOW
    }

    #[inline(always)]
    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()> {
        match event {
            Event::Start(start) => {
                let gather = self.stream.gather;
                let emitted = gather.emitters.emitted(start.source, path, start.shape);
                let passes = self.stream.counts.passes() as f64;
                self.photon = self.photon_fluxes[start.source.index()] / (emitted * passes);
                self.stream.photon = Photon::of(start, self.photon);
                self.recent.clear();
            }
            Event::Arrive(_) => return self.stream.see(path, event),
            Event::Depart(vertex, departure) => self.depart(path, vertex, departure),
            Event::Detect(light) => self.detect(path, light),
            Event::Travel(_)
            | Event::Collide(_)
            | Event::Absorbed(_)
            | Event::Meet(_)
            | Event::Roulette(_)
            | Event::Escaped(_)
            | Event::Cut(_)
            | Event::Leaked(..) => {}
        }
        ControlFlow::Continue(())
    }
}

impl MergedStream<'_, '_> {
    fn depart(&mut self, path: &Path, vertex: &Vertex<'_>, departure: &Departure) {
        if vertex.interface.visibility == Visibility::Visible {
            let facing = facing(self.stream.gather.scene, path, vertex);
            self.recent.push(FacePassage::of_photon(&facing, departure.side));
        }
    }

    fn detect(&mut self, path: &Path, light: &Detection<'_>) {
        let PhotonStream { gather, first, counts, current, .. } = &mut self.stream;
        let known = arrivals_of(light, &gather.sensors);
        let (Some(arrivals), false) = (known, light.cells.is_empty()) else { return };
        let gathered = etendue_of(light, gather.scene, arrivals, path.wavelength);
        let gathered = gathered / (first.gather_paths * counts.passes() as u64) as f64;
        let window = self.recent.etendue(first.window);
        let weight = Etendues::unjoined(self.photon, gathered, window).forward();
        let (flux, source) = (light.flux * weight, light.source);
        let counted = DetectedLight { flux, depth: path.depth, source };
        for readings in counts.pass(*current) {
            readings.count(
                (&gather.layout, &gather.scene.light),
                light.sensor,
                light.cells,
                &counted,
            );
        }
    }
}
