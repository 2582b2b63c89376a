//! The one bounce loop, at interfaces and within media. Visitors see what happens and decide nothing but when to end.
//!
//! It does not know what is counted: the forward estimator counts photons, a gather path would look for its end.

use crate::optics::{Lobe, Scattered, Side, VolumeScattering};
use crate::rng::{Dimension, Numbers, Sampler};
use crate::scene::{Hits, Interface, MediumId, Meeting, On, Ray, Scene, Visibility};
use crate::transport::Path;
use crate::transport::scatter::{scatter, scatter_radiance};
use glam::DVec3;
use std::ops::ControlFlow;

/// Below this throughput a path survives with probability throughput/threshold and then has the threshold's:
/// the mean is kept, and mirrors above it cost no random number. 1. Chosen by measurement: docs/speed.md.
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
    /// Where, mm.
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
    /// Where, mm.
    pub point: DVec3,
    /// Unit direction of travel before it.
    pub dir: DVec3,
    /// The medium.
    pub medium: MediumId,
    /// How it scatters.
    pub scattering: &'a VolumeScattering,
    /// Throughput, before and after.
    pub throughput: f64,
}

/// How a path goes on from a vertex.
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
    /// It is going to be scattered within a medium, which absorbs nothing by that.
    Collide(&'a Collision<'a>),
    /// It met an interface; nothing has been decided.
    Arrive(&'a Vertex<'a>),
    /// The interface sent it on; what its throughput lost, the acting face absorbed.
    Depart(&'a Vertex<'a>, &'a Departure),
    /// The acting face absorbed all of it.
    Absorbed(&'a Vertex<'a>),
    /// Roulette took this throughput away; negative where a survivor gained it.
    Roulette(f64),
    /// It left the scene.
    Escaped(f64),
    /// It met the bounce limit with this throughput.
    Cut(f64),
    /// It was inside a solid and met nothing: a hole in the geometry, at the ray's origin.
    Leaked(&'a Ray, f64),
}

/// What a path carries from interface to interface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Carries {
    /// Flux, with the light: photon paths.
    Flux,
    /// Basic radiance L/n², against the light: gather paths.
    Radiance,
}

/// Someone who watches a path; a closure is one, of photon paths.
pub trait Visitor {
    /// What the paths carry that it watches.
    const CARRIES: Carries = Carries::Flux;

    /// Throughput below which roulette ends paths, 1.
    #[inline(always)]
    fn roulette_below(&self) -> f64 {
        ROULETTE_BELOW
    }

    /// Sees what happens; a break ends the path. Inlined into the loop it saves a tenth of a mirror bounce.
    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()>;
}

impl<F: FnMut(&Path, Event<'_>) -> ControlFlow<()>> Visitor for F {
    #[inline]
    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()> {
        self(path, event)
    }
}

/// Follows a path until it ends or the visitor breaks.
#[inline]
pub fn walk<V: Visitor>(
    scene: &Scene,
    mut path: Path,
    bounce_limit: u32,
    sampler: &mut Sampler<impl Numbers>,
    visitor: &mut V,
) {
    // A copy of the path's that no visitor sees: it stays in registers from bounce to bounce.
    let mut ray = path.ray;
    loop {
        let hits = scene.find_next(&ray, &path.on, &path.inside);
        let medium = &scene.media[path.medium.index()];
        let mut length = hits.as_ref().map_or(f64::INFINITY, Hits::distance);
        let mut scattered = None;
        // Clear media draw nothing; a path that meets no surface has left all bodies, or leaks.
        if let (Some(scattering), Some(_)) = (medium.scattering(), &hits) {
            let free = scattering.free_path(sampler.one(Dimension::FreePath));
            if free < length {
                (length, scattered) = (free, Some(scattering));
            }
        }
        let arriving = path.throughput * medium.transmittance(path.wavelength, length);
        let segment = Segment {
            ray: &path.ray,
            length,
            medium: path.medium,
            throughput: path.throughput,
            arriving,
        };
        if visitor.see(&path, Event::Travel(&segment)).is_break() {
            return;
        }
        path.throughput = arriving;
        let Some(hits) = &hits else {
            leave(&path, visitor);
            return;
        };
        let next = match scattered {
            None => bounce(scene, &mut path, &ray, hits, sampler, visitor),
            Some(scattering) => collide(scattering, &mut path, ray.at(length), sampler, visitor),
        };
        match next {
            ControlFlow::Continue(next) => ray = next,
            ControlFlow::Break(()) => return,
        }
        if path.depth >= bounce_limit {
            _ = visitor.see(&path, Event::Cut(path.throughput));
            return;
        }
        if path.throughput < visitor.roulette_below()
            && roulette(&mut path, sampler, visitor).is_break()
        {
            return;
        }
    }
}

/// Ends a path that meets nothing: it has left the scene, or a solid through a hole. The visitor cannot keep it.
fn leave<V: Visitor>(path: &Path, visitor: &mut V) {
    let event = if path.inside.is_empty() {
        Event::Escaped(path.throughput)
    } else {
        Event::Leaked(&path.ray, path.throughput)
    };
    _ = visitor.see(path, event);
}

/// Ends a path of small throughput, or lets it go on with the threshold's.
#[inline(always)]
fn roulette<V: Visitor>(
    path: &mut Path,
    sampler: &mut Sampler<impl Numbers>,
    visitor: &mut V,
) -> ControlFlow<()> {
    let below = visitor.roulette_below();
    let survives = sampler.one(Dimension::Roulette) * below < path.throughput;
    let after = if survives { below } else { 0.0 };
    visitor.see(path, Event::Roulette(path.throughput - after))?;
    path.throughput = after;
    if survives { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
}

/// Takes a path through the interface it has met: the ray on which it goes on.
#[inline(always)]
fn bounce<V: Visitor>(
    scene: &Scene,
    path: &mut Path,
    ray: &Ray,
    hits: &Hits,
    sampler: &mut Sampler<impl Numbers>,
    visitor: &mut V,
) -> ControlFlow<(), Ray> {
    let (point, dir) = (ray.at(hits.distance()), ray.dir());
    let interface = scene.interface(hits, &Meeting { point, dir }, &path.inside, path.medium);
    let vertex = Vertex { point, dir, hits, interface: &interface, throughput: path.throughput };
    visitor.see(path, Event::Arrive(&vertex))?;
    let out = match interface.visibility {
        Visibility::Invisible => straight_on(dir),
        Visibility::Visible => {
            path.depth += 1;
            let out = match V::CARRIES {
                Carries::Flux => scatter(scene, path, &interface, point, dir, sampler),
                Carries::Radiance => scatter_radiance(scene, path, &vertex, sampler),
            };
            let Some(out) = out else {
                visitor.see(path, Event::Absorbed(&vertex))?;
                return ControlFlow::Break(());
            };
            out
        }
    };
    path.on = On::hits(hits);
    let next = Ray::new(point, out.dir);
    path.ray = next;
    path.throughput *= out.factor;
    let Scattered { side, lobe, .. } = out;
    let departure = Departure { dir: next.dir(), throughput: path.throughput, side, lobe };
    visitor.see(path, Event::Depart(&vertex, &departure))?;
    if out.side == Side::Transmitted {
        path.medium = interface.to;
        hits.cross(&mut path.inside);
    }
    ControlFlow::Continue(next)
}

/// Scatters a path within its medium: the ray on which it goes on.
#[inline(never)]
fn collide<V: Visitor>(
    scattering: &VolumeScattering,
    path: &mut Path,
    point: DVec3,
    sampler: &mut Sampler<impl Numbers>,
    visitor: &mut V,
) -> ControlFlow<(), Ray> {
    let (dir, medium, throughput) = (path.ray.dir(), path.medium, path.throughput);
    let collision = Collision { point, dir, medium, scattering, throughput };
    visitor.see(path, Event::Collide(&collision))?;
    path.depth += 1;
    path.on = On::default();
    // The phase function knows but the angle between two directions: radiance goes the same way as flux.
    path.ray = Ray::new(point, scattering.scatter(dir, sampler.pair(Dimension::Scatter)));
    ControlFlow::Continue(path.ray)
}

fn straight_on(dir: DVec3) -> Scattered {
    Scattered { dir, factor: 1.0, side: Side::Transmitted, lobe: Lobe::Specular }
}
