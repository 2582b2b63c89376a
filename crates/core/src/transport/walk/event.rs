//! Events of a path, and its observers.
//!
//! The bounce loop makes most events. The photon counter adds `Start` and `Detect`, and the follower of a
//! gather path adds `Meet`. Both have an observer of their own, and pass on to it only the events that it
//! needs: the photon counter `Arrive`, `Depart` and `Collide`; the follower, once the path has passed the aim
//! of its sensor, the same and `Cut` and `Leaked`. One trait serves them all.

use crate::optics::{Lobe, Side, VolumeScattering};
use crate::scene::{FaceId, Hits, Interface, MediumId, Ray, RowReach, SensorId, SourceId};
use crate::transport::walk::Path;
use glam::DVec3;
use std::ops::ControlFlow;

/// Below this throughput a path survives with probability throughput/threshold and then has the
/// threshold's, 1: the mean is unchanged, and mirrors above it cost no random number. Chosen by
/// measurement: docs/speed.md.
pub const ROULETTE_BELOW: f64 = 0.1;

/// A straight part of a path, in one medium.
#[derive(Debug)]
pub struct Segment<'a> {
    /// Start and direction.
    pub ray: &'a Ray,
    /// Length, mm; infinite when nothing is hit.
    pub length: f64,
    /// The medium.
    pub medium: MediumId,
    /// Throughput at its start.
    pub throughput: f64,
    /// Throughput at its end.
    pub arriving: f64,
}

/// The meeting of a path with an interface.
#[derive(Debug)]
pub struct Vertex<'a> {
    /// Position, mm.
    pub point: DVec3,
    /// Unit direction of travel before it.
    pub dir: DVec3,
    /// All surfaces that meet there.
    pub hits: &'a Hits,
    /// The interface they make.
    pub interface: &'a Interface<'a>,
    /// Throughput arriving.
    pub throughput: f64,
}

/// A scattering of a path within a medium.
#[derive(Debug)]
pub struct Collision<'a> {
    /// Position, mm.
    pub point: DVec3,
    /// Unit direction of travel before it.
    pub dir: DVec3,
    /// Unit direction of travel after it.
    pub out: DVec3,
    /// The medium.
    pub medium: MediumId,
    /// Its scattering.
    pub scattering: &'a VolumeScattering,
    /// Throughput, before and after.
    pub throughput: f64,
}

/// Light of a photon path that a fluorescent medium absorbs and emits at another wavelength.
#[derive(Debug, Clone, Copy)]
pub struct Conversion {
    /// Position, mm.
    pub point: DVec3,
    /// The medium.
    pub medium: MediumId,
    /// Throughput before it.
    pub absorbed: f64,
    /// Throughput after it: luminous flux, which may be larger than before.
    pub emitted: f64,
    /// Radiant flux that becomes heat, over luminous flux at throughput 1, W/lm.
    pub heat: f64,
}

/// Continuation of a path from a vertex.
#[derive(Debug)]
pub struct Departure {
    /// Unit direction of travel.
    pub dir: DVec3,
    /// Throughput leaving.
    pub throughput: f64,
    /// Reflected or transmitted.
    pub side: Side,
    /// Discrete or drawn.
    pub lobe: Lobe,
    /// Probability with which this side was chosen, given that the light was not absorbed, 1; also 1 where a finish does
    /// not state it.
    pub chance: f64,
}

/// Start of a photon path.
#[derive(Debug, Clone, Copy)]
pub struct Emergence {
    /// Its source.
    pub source: SourceId,
    /// The shape of the source that it starts on.
    pub shape: usize,
    /// Its flux at throughput 1, lm or W.
    pub flux: f64,
}

/// Light of a photon path that a sensor counts.
#[derive(Debug, Clone, Copy)]
pub struct Detection<'a> {
    /// The sensor.
    pub sensor: SensorId,
    /// Its cells that count the light; there may be none.
    pub cells: &'a [usize],
    /// Position on the sensor, mm; for a far field, any point of the path.
    pub point: DVec3,
    /// Unit direction of travel.
    pub dir: DVec3,
    /// Unit normal of the sensor.
    pub normal: DVec3,
    /// The medium it is in.
    pub medium: MediumId,
    /// Its flux, lm or W.
    pub flux: f64,
    /// Its source.
    pub source: SourceId,
}

/// Emission that a gather path meets.
#[derive(Debug, Clone, Copy)]
pub struct MetEmission {
    /// The source that is met.
    pub source: SourceId,
    /// The shape of the source that is met; 0 for a volume.
    pub(crate) shape: usize,
    /// Distance along the segment, mm.
    pub(crate) t: f64,
    /// Basic radiance at the start of the path, lm/(mm² sr): the emitted one times the throughput
    /// up to it.
    pub radiance: f64,
    /// Basic radiance where it is emitted, lm/(mm² sr); for a volume, that of a path of usual
    /// length through it.
    pub(crate) emitted: f64,
}

/// A row of mirror bounces between which nothing else happens, taken at once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jump<'a> {
    /// The face of the last bounce before it.
    pub face: FaceId,
    /// The medium.
    pub medium: MediumId,
    /// Throughput that each face absorbed.
    pub absorbed_by_faces: &'a [(FaceId, f64)],
    /// Throughput that the medium absorbed.
    pub absorbed_in_medium: f64,
    /// Throughput that arrives at a round wall, summed over all bounces; 0 at flat walls, on which no sensor is.
    pub arriving: f64,
    /// Throughput that leaves it.
    pub leaving: f64,
}

/// What happens to a path, in this order: travel, arrive, depart, travel, collide, travel, ...
#[derive(Debug, Clone, Copy)]
pub enum Event<'a> {
    /// It starts at a source.
    Start(&'a Emergence),
    /// It went straight through a medium.
    Travel(&'a Segment<'a>),
    /// It is about to be scattered within a medium, which absorbs nothing in doing so.
    Collide(&'a Collision<'a>),
    /// Fluorescence within a medium is about to change its wavelength, direction and throughput.
    Convert(&'a Conversion),
    /// It met an interface, which has not acted yet.
    Arrive(&'a Vertex<'a>),
    /// The interface sent it on; the acting face absorbed the loss of throughput.
    Depart(&'a Vertex<'a>, &'a Departure),
    /// It went from bounce to bounce; only observers that [allow it](Observer::allows_jumps) see this.
    Jump(&'a Jump<'a>),
    /// The acting face absorbed all of it.
    Absorbed(&'a Vertex<'a>),
    /// A sensor counts it.
    Detect(&'a Detection<'a>),
    /// It meets emission.
    Meet(&'a MetEmission),
    /// Roulette removed this throughput; negative where a survivor gained it.
    Roulette(f64),
    /// It left the scene.
    Escaped(f64),
    /// It met the bounce limit with this throughput.
    Cut(f64),
    /// It was inside a solid and met nothing: a hole in the geometry, at the ray's origin.
    Leaked(&'a Ray, f64),
}

/// The quantity a path carries from interface to interface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Carries {
    /// Flux, with the light: photon paths.
    Flux,
    /// Basic radiance L/n², against the light: gather paths.
    Radiance,
}

/// An observer of paths; a closure observes photon paths.
pub trait Observer {
    /// The quantity carried by the paths it observes in the bounce loop.
    const CARRIES: Carries = Carries::Flux;

    /// Throughput below which roulette ends paths, 1.
    #[inline(always)]
    fn roulette_below(&self) -> f64 {
        ROULETTE_BELOW
    }

    /// Whether rows of mirror bounces on plain walls may be taken at once, without an event for each.
    #[inline(always)]
    fn allows_jumps(&self) -> bool {
        false
    }

    /// Shortens a row of mirror bounces so that it ends before the first bounce that the observer must see. Called only if the
    /// observer allows jumps.
    #[inline(always)]
    fn limit_row(&self, _path: &Path, _reach: &mut RowReach) {}

    /// Sees an event; a break ends the path. In a pair of observers, the second does not see an event at which the first ends
    /// the path. Implementations are inlined into the loop, which saves a tenth of a mirror bounce.
    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()>;
}

impl<F: FnMut(&Path, Event<'_>) -> ControlFlow<()>> Observer for F {
    #[inline]
    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()> {
        self(path, event)
    }
}

/// No observer.
#[derive(Debug, Clone, Copy)]
pub struct Unobserved;

impl Observer for Unobserved {
    #[inline(always)]
    fn allows_jumps(&self) -> bool {
        true
    }

    #[inline(always)]
    fn see(&mut self, _: &Path, _: Event<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// An observer that looks at nothing but lets no bounce be left out.
#[derive(Debug, Clone, Copy)]
pub struct Stepping;

impl Observer for Stepping {
    #[inline(always)]
    fn see(&mut self, _: &Path, _: Event<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// Two observers, called in order; only the first sets the roulette threshold.
impl<A: Observer, B: Observer> Observer for (&mut A, &mut B) {
    #[inline(always)]
    fn roulette_below(&self) -> f64 {
        self.0.roulette_below()
    }

    #[inline(always)]
    fn allows_jumps(&self) -> bool {
        self.0.allows_jumps() && self.1.allows_jumps()
    }

    #[inline(always)]
    fn limit_row(&self, path: &Path, reach: &mut RowReach) {
        self.0.limit_row(path, reach);
        self.1.limit_row(path, reach);
    }

    #[inline(always)]
    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()> {
        self.0.see(path, event)?;
        self.1.see(path, event)
    }
}
