//! The one bounce loop, at interfaces and within media. Observers see events and can only end a
//! path.
//!
//! This module does not know what is counted. Photon paths and gather paths use the same loop: the observer of photon
//! paths counts flux on sensors, that of gather paths finds their ends and the sources that they meet.

use crate::colour::luminous_efficiency;
use crate::optics::{Fluorescence, Lobe, Scattered, Side, Stokes, VolumeScattering};
use crate::rng::{Dimension, Numbers, Sampler};
use crate::scene::{Hits, MeetingPoint, Ray, Scene, StartSurfaces, Visibility};
use crate::transport::walk::event::{
    Carries, Collision, Conversion, Departure, Event, Observer, Segment, Vertex,
};
use crate::transport::walk::jump::jump;
use crate::transport::walk::path::Path;
use crate::transport::walk::scatter::{scatter_photon, send_gather_path};
use glam::DVec3;
use lumiduct_base::math::uniform_sphere;
use std::ops::ControlFlow;

/// Throughput below which roulette ends paths after a row of bounces, 1. A row ends with its leg, or where single bounces
/// begin: roulette would save little there and cost noise, except where rows follow each other for ever.
const ROULETTE_AFTER_ROW: f64 = 1e-6;

/// Follows a path until it ends or the observer breaks.
#[inline]
pub fn walk<V: Observer>(
    scene: &Scene,
    mut path: Path,
    bounce_limit: u32,
    sampler: &mut Sampler<impl Numbers>,
    observer: &mut V,
) {
    // A copy of the path's ray that no observer sees: it stays in registers from bounce to bounce.
    let mut ray = path.ray;
    // By how much conversions have changed the luminous flux of a watt. Roulette acts by radiant flux, or light that the eye
    // hardly sees would be rare and heavy.
    let mut luminous_change = 1.0;
    loop {
        let hits = scene.find_next(&ray, &path.on, &path.inside);
        let medium = &scene.media[path.medium.index()];
        let mut length = hits.as_ref().map_or(f64::INFINITY, Hits::distance);
        let mut within = None;
        // Clear media draw nothing; a path that meets no surface has left all bodies, or leaks.
        if let (Some(scattering), Some(_)) = (medium.scattering(path.wavelength), &hits) {
            let free = scattering.free_path(sampler.one(Dimension::FreePath));
            if free < length {
                (length, within) = (free, Some(Within::Scatters(scattering)));
            }
        }
        if let (Some(fluorescence), Some(_)) = (medium.fluorescence(), &hits) {
            let free = fluorescence.free_path(path.wavelength, || sampler.one(Dimension::FreePath));
            if free < length {
                (length, within) = (free, Some(Within::Converts(fluorescence)));
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
        if observer.see(&path, Event::Travel(&segment)).is_break() {
            return;
        }
        path.throughput = arriving;
        let Some(hits) = &hits else {
            leave(&path, observer);
            return;
        };
        let depth = path.depth;
        let next = match within {
            None => bounce(scene, &mut path, (&ray, hits), bounce_limit, sampler, observer),
            Some(Within::Scatters(scattering)) => {
                collide(&scattering, &mut path, ray.at(length), sampler, observer)
            }
            Some(Within::Converts(fluorescence)) => {
                let before = luminous_efficiency(path.wavelength);
                let next = convert(fluorescence, &mut path, ray.at(length), sampler, observer);
                luminous_change *= luminous_efficiency(path.wavelength) / before;
                next
            }
        };
        match next {
            ControlFlow::Continue(next) => ray = next,
            ControlFlow::Break(()) => return,
        }
        if path.depth >= bounce_limit {
            _ = observer.see(&path, Event::Cut(path.throughput));
            return;
        }
        let took_row = path.depth > depth + 1;
        let below = observer.roulette_below();
        let below = if took_row { below.min(ROULETTE_AFTER_ROW) } else { below };
        let below = below * luminous_change;
        if path.throughput < below && roulette(below, &mut path, sampler, observer).is_break() {
            return;
        }
    }
}

/// What happens to a path within a medium, before it meets an interface.
enum Within<'a> {
    Scatters(VolumeScattering),
    Converts(&'a Fluorescence),
}

/// Ends a path that meets nothing: it has left the scene, or a solid through a hole. The observer
/// cannot prevent it.
fn leave<V: Observer>(path: &Path, observer: &mut V) {
    let event = if path.inside.is_empty() {
        Event::Escaped(path.throughput)
    } else {
        Event::Leaked(&path.ray, path.throughput)
    };
    _ = observer.see(path, event);
}

/// Ends a path of small throughput, or raises its throughput to `below`.
#[inline(always)]
fn roulette<V: Observer>(
    below: f64,
    path: &mut Path,
    sampler: &mut Sampler<impl Numbers>,
    observer: &mut V,
) -> ControlFlow<()> {
    let survives = sampler.one(Dimension::Roulette) * below < path.throughput;
    let after = if survives { below } else { 0.0 };
    observer.see(path, Event::Roulette(path.throughput - after))?;
    path.throughput = after;
    if survives { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
}

/// Takes a path through the interface it has met: the ray on which it continues.
#[inline(always)]
fn bounce<V: Observer>(
    scene: &Scene,
    path: &mut Path,
    (ray, hits): (&Ray, &Hits),
    bounce_limit: u32,
    sampler: &mut Sampler<impl Numbers>,
    observer: &mut V,
) -> ControlFlow<(), Ray> {
    let (point, dir) = (ray.at(hits.distance()), ray.dir());
    let interface = scene.interface(hits, &MeetingPoint { point, dir }, &path.inside, path.medium);
    let vertex = Vertex { point, dir, hits, interface: &interface, throughput: path.throughput };
    observer.see(path, Event::Arrive(&vertex))?;
    let out = match interface.visibility {
        Visibility::Invisible => straight_on(dir),
        Visibility::Visible => {
            path.depth += 1;
            let out = match V::CARRIES {
                Carries::Flux => scatter_photon(scene, path, &interface, point, dir, sampler),
                Carries::Radiance => send_gather_path(scene, path, &vertex, sampler),
            };
            let Some(out) = out else {
                observer.see(path, Event::Absorbed(&vertex))?;
                return ControlFlow::Break(());
            };
            out
        }
    };
    path.on = StartSurfaces::hits(hits);
    let next = Ray::new(point, out.dir);
    path.ray = next;
    path.throughput *= out.factor;
    let Scattered { side, lobe, chance, .. } = out;
    let departure = Departure { dir: next.dir(), throughput: path.throughput, side, lobe, chance };
    observer.see(path, Event::Depart(&vertex, &departure))?;
    if out.side == Side::Transmitted {
        path.medium = interface.to;
        hits.cross(&mut path.inside);
        return ControlFlow::Continue(next);
    }
    if path.stokes.is_none()
        && observer.allows_jumps()
        && let Some(leg) = scene.plain_leg(interface.acting.prim)
    {
        return jump(scene, path, (leg, &vertex, &out), bounce_limit, observer);
    }
    ControlFlow::Continue(next)
}

/// Scatters a path within its medium: the ray on which it continues.
#[inline(never)]
fn collide<V: Observer>(
    scattering: &VolumeScattering,
    path: &mut Path,
    point: DVec3,
    sampler: &mut Sampler<impl Numbers>,
    observer: &mut V,
) -> ControlFlow<(), Ray> {
    let (dir, medium, throughput) = (path.ray.dir(), path.medium, path.throughput);
    // The phase function depends only on the angle between two directions: it is the same for
    // radiance and flux.
    let next = Ray::new(point, scattering.scatter(dir, sampler.pair(Dimension::Scatter)));
    let collision = Collision { point, dir, out: next.dir(), medium, scattering, throughput };
    observer.see(path, Event::Collide(&collision))?;
    path.depth += 1;
    path.stokes = path.stokes.map(|_| Stokes::UNPOLARISED);
    path.on = StartSurfaces::default();
    path.ray = next;
    ControlFlow::Continue(path.ray)
}

/// Has a path absorbed and emitted by its medium: the ray on which it continues.
#[inline(never)]
fn convert<V: Observer>(
    fluorescence: &Fluorescence,
    path: &mut Path,
    point: DVec3,
    sampler: &mut Sampler<impl Numbers>,
    observer: &mut V,
) -> ControlFlow<(), Ray> {
    let out = fluorescence.emit(path.wavelength, sampler.one(Dimension::Wavelength));
    let (medium, absorbed) = (path.medium, path.throughput);
    let (emitted, heat) = (absorbed * out.factor, absorbed * out.heat);
    let conversion = Conversion { point, medium, absorbed, emitted, heat };
    observer.see(path, Event::Convert(&conversion))?;
    path.depth += 1;
    path.wavelength = out.wavelength;
    path.throughput = emitted;
    path.stokes = path.stokes.map(|_| Stokes::UNPOLARISED);
    path.on = StartSurfaces::default();
    path.ray = Ray::new(point, uniform_sphere(sampler.pair(Dimension::Scatter)));
    ControlFlow::Continue(path.ray)
}

fn straight_on(dir: DVec3) -> Scattered {
    Scattered { dir, factor: 1.0, side: Side::Transmitted, lobe: Lobe::Specular, chance: 1.0 }
}
