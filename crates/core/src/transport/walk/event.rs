//! Events of a path, and their visitors.

use crate::optics::{Lobe, Side, VolumeScattering};
use crate::scene::{Hits, Interface, MediumId, Ray};
use crate::transport::walk::Path;
use glam::DVec3;
use std::ops::ControlFlow;

/// Below this throughput a path survives with probability throughput/threshold and then has the
/// threshold's: the mean is unchanged, and mirrors above it cost no random number. 1. Chosen by
/// measurement: docs/speed.md.
pub const ROULETTE_BELOW: f64 = 0.1;

/// A straight piece of a path, in one medium.
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
    /// The medium.
    pub medium: MediumId,
    /// Its scattering.
    pub scattering: &'a VolumeScattering,
    /// Throughput, before and after.
    pub throughput: f64,
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
}

/// What happens to a path, in this order: travel, arrive, depart, travel, collide, travel, ...
#[derive(Debug)]
pub enum Event<'a> {
    /// It went straight through a medium.
    Travel(&'a Segment<'a>),
    /// It is about to be scattered within a medium, which absorbs nothing in doing so.
    Collide(&'a Collision<'a>),
    /// It met an interface, which has not acted yet.
    Arrive(&'a Vertex<'a>),
    /// The interface sent it on; the acting face absorbed the loss of throughput.
    Depart(&'a Vertex<'a>, &'a Departure),
    /// The acting face absorbed all of it.
    Absorbed(&'a Vertex<'a>),
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

/// A watcher of a path; a closure is a watcher of photon paths.
pub trait Visitor {
    /// The quantity carried by the paths it watches.
    const CARRIES: Carries = Carries::Flux;

    /// Throughput below which roulette ends paths, 1.
    #[inline(always)]
    fn roulette_below(&self) -> f64 {
        ROULETTE_BELOW
    }

    /// Sees an event; a break ends the path. Inlined into the loop it saves a tenth of a mirror
    /// bounce.
    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()>;
}

impl<F: FnMut(&Path, Event<'_>) -> ControlFlow<()>> Visitor for F {
    #[inline]
    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()> {
        self(path, event)
    }
}
