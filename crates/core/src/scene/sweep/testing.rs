//! Profiles and paths for the tests of sweeps, and the surfaces that rays meet there.

use crate::rng::{Dimension, Sampler};
use crate::scene::Ray;
use crate::scene::shape::{Crossing, RayStart, Shape};
use crate::scene::sweep::{CornerKind, Leg, Profile, Sweep, sweep};
use glam::{DVec2, DVec3};
use lumiduct_base::math::{Aabb, Frame, uniform_sphere};
use std::f64::consts::{FRAC_PI_2, PI};

pub(super) const SEED: u64 = 4711;

pub(super) fn start() -> Frame {
    Frame::from_axis(DVec3::new(3.0, -2.0, 5.0), DVec3::new(0.3, 0.4, 0.7))
}

pub(super) fn ell() -> Profile {
    let points = [(-1.0, -1.0), (2.0, -1.0), (2.0, 0.2), (0.4, 0.2), (0.4, 1.5), (-1.0, 1.5)];
    Profile::polygon(points.map(DVec2::from).to_vec()).unwrap()
}

pub(super) fn profiles() -> Vec<(&'static str, Profile)> {
    vec![
        ("circle", Profile::circle(1.5).unwrap()),
        ("rectangle", Profile::rectangle(3.0, 2.0).unwrap()),
        ("triangle", Profile::regular(3, 1.8, 0.3).unwrap()),
        ("hexagon", Profile::regular(6, 1.6, 0.0).unwrap()),
        ("ell", ell()),
    ]
}

pub(super) fn straight(length: f64) -> Leg {
    Leg::Straight { length, end_scale: 1.0 }
}

pub(super) fn taper(length: f64, end_scale: f64) -> Leg {
    Leg::Straight { length, end_scale }
}

pub(super) fn bend(angle: f64, radius: f64, toward: f64) -> Leg {
    Leg::Bend { angle, radius, toward }
}

pub(super) fn corner(angle: f64, toward: f64) -> Leg {
    Leg::Corner { angle, toward, kind: CornerKind::Plain }
}

pub(super) fn mitre(angle: f64, toward: f64) -> Leg {
    Leg::Corner { angle, toward, kind: CornerKind::Mitred }
}

pub(super) fn paths() -> Vec<(&'static str, Vec<Leg>)> {
    vec![
        ("straight", vec![straight(7.0)]),
        ("tapers", vec![taper(4.0, 1.7), straight(1.0), taper(5.0, 0.4)]),
        ("light pipe", vec![straight(10.0), bend(FRAC_PI_2, 8.0, 0.0), straight(10.0)]),
        ("oblique bend", vec![straight(2.0), bend(2.2, 5.0, 0.7), straight(3.0)]),
        ("wide bend", vec![bend(4.2, 6.0, 2.9)]),
        (
            "s",
            vec![bend(1.1, 5.0, 0.0), bend(1.1, 5.0, PI), straight(1.0), bend(0.8, 4.0, FRAC_PI_2)],
        ),
        ("corner", vec![straight(4.0), corner(FRAC_PI_2, 0.0), straight(5.0)]),
        (
            "oblique corners",
            vec![corner(0.6, 1.2), straight(3.0), corner(1.9, -2.0), straight(1.0)],
        ),
        ("acute corner", vec![straight(1.0), corner(2.6, 2.1), straight(1.0)]),
        ("mitre", vec![straight(4.0), mitre(FRAC_PI_2, FRAC_PI_2), straight(4.0)]),
        (
            "two mitres",
            vec![straight(9.0), mitre(1.2, 0.4), straight(14.0), mitre(2.0, 2.0), straight(5.0)],
        ),
        (
            "everything",
            vec![
                straight(3.0),
                taper(4.0, 0.7),
                bend(1.0, 4.0, 0.5),
                corner(0.8, 3.0),
                straight(3.0),
                taper(2.0, 1.3),
                straight(6.0),
                mitre(1.3, 5.0),
                straight(6.0),
                bend(0.7, 5.0, 4.0),
            ],
        ),
    ]
}

/// Calls `test` with every profile on every path.
pub(super) fn for_all(mut test: impl FnMut(&str, &Profile, &[Leg], &Sweep)) {
    for (profile_name, profile) in profiles() {
        for (path_name, legs) in paths() {
            let name = format!("{profile_name}, {path_name}");
            let sweep = sweep(start(), &profile, &legs).unwrap_or_else(|e| panic!("{name}: {e}"));
            test(&name, &profile, &legs, &sweep);
        }
    }
}

pub(super) fn surfaces(sweep: &Sweep) -> Vec<&Shape> {
    sweep.parts.iter().map(|part| &part.shape).chain(sweep.ports.iter().map(|p| &p.shape)).collect()
}

pub(super) fn bounds(sweep: &Sweep) -> Aabb {
    surfaces(sweep).iter().fold(Aabb::EMPTY, |all, shape| all.union(shape.bounds()))
}

pub(super) fn crossings(surfaces: &[&Shape], ray: &Ray) -> Vec<Crossing> {
    let mut found = Vec::new();
    for shape in surfaces {
        shape.crossings(ray, RayStart::Elsewhere, |crossing| found.push(crossing));
    }
    found.sort_by(|a, b| a.t.total_cmp(&b.t));
    found
}

pub(super) fn direction_of(sampler: &mut Sampler) -> DVec3 {
    uniform_sphere(sampler.pair(Dimension::EmitDirection))
}

/// A ray through a random point near the sweep, along a random direction.
pub(super) fn ray_through(bounds: &Aabb, sampler: &mut Sampler) -> Ray {
    let u = DVec3::from_array([(); 3].map(|()| sampler.one(Dimension::EmitPosition)));
    Ray::new(bounds.min + u * (bounds.max - bounds.min), direction_of(sampler))
}

/// Any leg.
pub(super) fn random_leg(sampler: &mut Sampler) -> Leg {
    let mut number = |from: f64, to: f64| from + sampler.one(Dimension::EmitPosition) * (to - from);
    let toward = number(-PI, PI);
    let kind = if number(0.0, 1.0) < 0.5 { CornerKind::Plain } else { CornerKind::Mitred };
    match number(0.0, 4.0) as u32 {
        0 => straight(number(0.1, 12.0)),
        1 => taper(number(0.1, 8.0), number(0.5, 1.5)),
        2 => bend(number(0.1, 6.0), number(2.0, 9.0), toward),
        _ => Leg::Corner { angle: number(0.05, 2.9), toward, kind },
    }
}
