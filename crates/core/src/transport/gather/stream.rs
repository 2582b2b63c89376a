//! Photons that stream past the records of a block of passes: each is counted by every record that takes it.
//!
//! Photons that may belong to records are buffered and looked up together.

use crate::optics::{FinishModel, Incidence, Spread};
use crate::scene::shape::Toward;
use crate::scene::{MediumId, PrimHit, PrimId, RowReach, Scene, SourceId, Surface, Visibility};
use crate::transport::backward::mix::MergedPhoton;
use crate::transport::gather::block::CrossedCounts;
use crate::transport::gather::contribution::{PairWeights, PhotonHit, SurfaceHit, VolumeHit};
use crate::transport::gather::estimator::{Gather, RecordedPath, WaitingRecords};
use crate::transport::gather::index::{PhotonKey, TOGETHER};
use crate::transport::gather::stages::Pass;
use crate::transport::stop::Pace;
use crate::transport::tally::Counts;
use crate::transport::tally::sensor_reading::DetectedLight;
use crate::transport::tally::work::RecordWork;
use crate::transport::{Collision, Emergence, Event, Observer, Path, Vertex};
use glam::DVec3;
use std::ops::ControlFlow;

/// Photons that stream past the records.
pub(crate) struct PhotonStream<'p, 's> {
    pub(super) gather: &'p Gather<'s>,
    weights: PairWeights,
    waiting: WaitingRecords<'s>,
    /// Whether records may evaluate a finish with grain.
    has_grain: bool,
    pace: &'p Pace<'p>,
    /// Counts by E1, E0 and E00, with the emission that gather paths met.
    pub(super) counts: CrossedCounts,
    /// The first pass of the block.
    pub(super) first: Pass,
    /// Place in the block of the pass whose photons are traced.
    pub(super) current: usize,
    /// The current photon.
    photon: Photon,
    /// Photons to be looked up, and their keys.
    passing: Vec<Passing>,
    keys: Vec<PhotonKey>,
    /// Merged: what weights these photons.
    merged: Vec<MergedPhoton>,
    work: RecordWork,
}

/// A photon that may belong to records.
#[derive(Debug, Clone, Copy)]
struct Passing {
    at: PhotonPlace,
    /// Wavelength, nm.
    wavelength: f64,
    /// Flux, lm or W.
    flux: f64,
    depth: u32,
    source: SourceId,
}

/// Location of a photon.
#[derive(Debug, Clone, Copy)]
enum PhotonPlace {
    /// At an interface.
    Surface {
        prim: PrimId,
        toward: Toward,
        /// The media before and behind it.
        media: [MediumId; 2],
    },
    /// Within a medium, before it is scattered.
    Medium,
}

impl Observer for PhotonStream<'_, '_> {
    #[inline(always)]
    fn allows_jumps(&self) -> bool {
        true
    }

    #[inline]
    fn limit_row(&self, _: &Path, reach: &mut RowReach) {
        self.waiting.watched.limit(reach);
    }

    #[inline(always)]
    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()> {
        self.offer(path, event, |_| None);
        ControlFlow::Continue(())
    }
}

/// A photon as it starts.
#[derive(Debug, Clone, Copy)]
struct Photon {
    /// Flux at throughput 1, lm or W.
    flux: f64,
    source: SourceId,
}

impl<'p, 's> PhotonStream<'p, 's> {
    /// Takes the photon of an event that may belong to records; `merged` is asked for what weights it, with its
    /// unit direction.
    #[inline(always)]
    pub(super) fn offer(
        &mut self,
        path: &Path,
        event: Event<'_>,
        merged: impl FnOnce(DVec3) -> Option<MergedPhoton>,
    ) {
        match event {
            Event::Start(&Emergence { flux, source, .. }) => self.photon = Photon { flux, source },
            Event::Arrive(vertex) if self.may_take(path, vertex) => {
                self.merged.extend(merged(vertex.dir));
                self.take(path, vertex);
            }
            Event::Collide(collision) if self.may_take_within(path, collision) => {
                self.merged.extend(merged(collision.dir));
                self.collide(path, collision);
            }
            Event::Travel(_)
            | Event::Jump(_)
            | Event::Convert(_)
            | Event::Arrive(_)
            | Event::Collide(_)
            | Event::Depart(..)
            | Event::Absorbed(_)
            | Event::Detect(_)
            | Event::Meet(_)
            | Event::Roulette(_)
            | Event::Escaped(_)
            | Event::Cut(_)
            | Event::Leaked(..) => {}
        }
    }

    pub(super) fn new(
        gather: &'p Gather<'s>,
        first: Pass,
        (waiting, pace): (WaitingRecords<'s>, &'p Pace<'p>),
        counts: CrossedCounts,
    ) -> Self {
        Self {
            gather,
            weights: PairWeights::new(first.window),
            work: RecordWork { records: waiting.records.all.len() as u64, ..RecordWork::default() },
            waiting,
            has_grain: records_have_grain(gather.scene),
            pace,
            counts,
            first,
            current: 0,
            photon: Photon { flux: 0.0, source: SourceId::new(0) },
            passing: Vec::with_capacity(TOGETHER),
            keys: Vec::with_capacity(TOGETHER),
            merged: Vec::new(),
        }
    }

    /// The photons that follow are those of another pass of the block.
    pub(crate) fn begin_pass(&mut self, place: usize) {
        self.look_up();
        self.current = place;
    }

    /// Looks up the remaining photons: the counts, and the work in addition to tracing.
    pub(super) fn finish(mut self) -> (CrossedCounts, RecordWork) {
        self.look_up();
        (self.counts, self.work)
    }

    /// The counts of all passes, after their photons.
    pub(crate) fn into_counts(self) -> Counts {
        self.finish().0.into_counts()
    }

    /// Whether there may be records for a photon.
    #[inline(always)]
    fn may_take(&self, path: &Path, vertex: &Vertex<'_>) -> bool {
        vertex.interface.visibility == Visibility::Visible
            && self.waiting.records.may_take(&self.key(path, vertex))
    }

    #[inline(always)]
    fn key(&self, path: &Path, vertex: &Vertex<'_>) -> PhotonKey {
        let surface = self.gather.surfaces.of(vertex.interface.acting.prim);
        PhotonKey { surface, band: path.band, point: vertex.point, dir: vertex.dir }
    }

    /// Takes a photon that is to be looked up.
    #[inline(never)]
    fn take(&mut self, path: &Path, vertex: &Vertex<'_>) {
        let interface = vertex.interface;
        let PrimHit { prim, toward, .. } = *interface.acting;
        let media = [interface.from, interface.to];
        let at = PhotonPlace::Surface { prim, toward, media };
        self.push(path, self.key(path, vertex), at, vertex.throughput);
    }

    fn may_take_within(&self, path: &Path, collision: &Collision<'_>) -> bool {
        self.waiting.records.may_take(&self.key_within(path, collision))
    }

    fn key_within(&self, path: &Path, collision: &Collision<'_>) -> PhotonKey {
        let &Collision { point, dir, medium, .. } = collision;
        PhotonKey { surface: self.gather.surfaces.of_medium(medium), band: path.band, point, dir }
    }

    fn collide(&mut self, path: &Path, collision: &Collision<'_>) {
        let key = self.key_within(path, collision);
        self.push(path, key, PhotonPlace::Medium, collision.throughput);
    }

    fn push(&mut self, path: &Path, key: PhotonKey, at: PhotonPlace, throughput: f64) {
        self.keys.push(key);
        let Photon { flux, source } = self.photon;
        let flux = flux * throughput;
        let &Path { wavelength, depth, .. } = path;
        self.passing.push(Passing { at, wavelength, flux, depth, source });
        if self.passing.len() == TOGETHER {
            self.look_up();
        }
    }

    fn look_up(&mut self) {
        let Gather { scene, layout, merging, .. } = self.gather;
        let places = self.gather.record_places(self.first);
        let (weights, counts, work) = (&self.weights, &mut self.counts, &mut self.work);
        let (passing, keys, pace, has_grain) =
            (&self.passing, &self.keys, self.pace, self.has_grain);
        work.look_ups += passing.len() as u64;
        // Most photons that pass the filter are near no record after all: one bit for each that is.
        let mut near = 0u64;
        let mut known: Option<(usize, PhotonHit)> = None;
        self.waiting.records.visit(keys, |index, record| {
            if pace.spend(1).is_break() {
                return;
            }
            let photon = &passing[index];
            if record.path().band != keys[index].band {
                return;
            }
            if known.as_ref().is_some_and(|(last, _)| *last != index) {
                known = None;
            }
            let (_, met) = known
                .get_or_insert_with(|| (index, arriving((scene, has_grain), &keys[index], photon)));
            near |= 1 << index;
            let Some(shares) = weights.flux(record, met) else { return };
            work.pairs += 1;
            let own = record.path();
            let RecordedPath { sensor, pass, cells, merged, .. } =
                &self.waiting.paths[own.place as usize];
            let weight = match (merging, merged, self.merged.get(index)) {
                (Some(backward), Some(record), Some(photon)) => {
                    record.share((backward, *sensor), places, (photon, keys[index].dir))
                }
                // Gathering alone: pairs count all light of photons.
                (None, None, None) => 1.0,
                _ => unreachable!("merged paths, records and photons go together"),
            };
            let depth = photon.depth + own.depth;
            let light = shares.map(|share| DetectedLight {
                flux: photon.flux * share * weight,
                depth,
                source: photon.source,
                wavelength: photon.wavelength,
            });
            counts.count_pair((scene, layout), (*sensor, cells), [*pass, self.current], light);
        });
        work.near += u64::from(near.count_ones());
        self.passing.clear();
        self.keys.clear();
        self.merged.clear();
    }
}

/// Whether records may evaluate a finish with grain.
fn records_have_grain(scene: &Scene) -> bool {
    let mut finishes = scene.finishes.iter().map(|named| &named.finish);
    finishes.any(|finish| finish.has_grain() && finish.spread() == Spread::Broad)
}

/// A photon in the form that records take, with the grain of its surface if it `has_grain`.
fn arriving((scene, has_grain): (&Scene, bool), key: &PhotonKey, photon: &Passing) -> PhotonHit {
    let &PhotonKey { surface, point, dir, .. } = key;
    let wavelength = photon.wavelength;
    match photon.at {
        PhotonPlace::Medium => PhotonHit::Volume(VolumeHit { medium: surface, point, dir }),
        PhotonPlace::Surface { prim, toward, media: [from, to] } => {
            let index = |medium: MediumId| scene.media[medium.index()].index(wavelength);
            let outward = scene.normal(prim, point);
            let incidence = Incidence {
                dir,
                normal: match toward {
                    Toward::Front => -outward,
                    Toward::Back => outward,
                },
                index_from: index(from),
                index_to: index(to),
                wavelength,
                grain: match scene.surface(prim) {
                    Surface::Patch(patch) if has_grain => patch.along(point),
                    Surface::Patch(_) | Surface::Triangle(..) => DVec3::ZERO,
                },
                s_share: Incidence::UNPOLARISED,
            };
            PhotonHit::Surface(SurfaceHit { surface, medium: from, point, incidence })
        }
    }
}
