//! Straight guides with everything that ends a row of bounces.

use crate::optics::{Finish, Medium};
use crate::scene::pattern::{Columns, ElementField, ElementOutline, Pattern, RowPositions};
use crate::scene::shape::{Cylinder, Flat, Region, Shape};
use crate::scene::{Builder, FaceId, FacePiece, FaceSpec, Owner, Scene, Solid};
use glam::{DVec2, DVec3};
use lumiduct_base::math::{Aabb, Frame};
use lumiduct_base::units::FluxUnit;
use std::f64::consts::TAU;

pub(super) const RADIUS: f64 = 1.5;
const LENGTH: f64 = 90.0;

pub(super) fn frame() -> Frame {
    Frame::from_axis(DVec3::new(0.3, -0.2, 0.5), DVec3::new(0.4, -0.3, 0.8))
}

fn builder(air: f64) -> Builder {
    Builder::new(DVec3::ZERO, Medium::new("air", 1.0, air), FluxUnit::Lumen)
}

fn add(builder: &mut Builder, owner: Owner, finish: Option<Finish>, shape: Shape) {
    let finish = finish.map(|finish| builder.add_finish("wall", finish));
    builder.add_face(FaceSpec {
        name: "pipe.wall".into(),
        owner,
        front: finish,
        back: finish,
        pieces: vec![FacePiece::whole(shape)],
    });
}

fn wall() -> Shape {
    Shape::Cylinder(Cylinder::new(frame(), RADIUS, LENGTH))
}

/// A disk across the axis.
fn across(z: f64, radius: f64) -> Shape {
    let frame = frame().shifted(z * frame().z);
    Shape::Flat(Flat::new(frame, Region::Annulus { inner: 0.0, outer: radius }))
}

/// A metal tube filled with absorbing air, with a small open plate across it.
pub(super) fn tube() -> Scene {
    let mut builder = builder(0.002);
    add(&mut builder, Owner::Sheet, Some(Finish::Metal { n: 1.2, k: 7.0 }), wall());
    add(&mut builder, Owner::Sheet, Some(Finish::Open), across(0.4 * LENGTH, 0.3 * RADIUS));
    builder.build()
}

/// The tube of a mirror with a row of open holes, and two columns of dots that are duller mirrors.
pub(super) fn perforated() -> Scene {
    let mut builder = builder(0.0);
    let mirror = |reflectance| Finish::Specular { reflectance, transmittance: 0.0 };
    add(&mut builder, Owner::Sheet, Some(mirror(0.98)), wall());
    let pattern = |name: &str, finish, columns, outline| Pattern {
        name: name.into(),
        face: FaceId::new(0),
        field: ElementField {
            rows: RowPositions::Even { first: 10.0, pitch: 3.0, count: 25 },
            columns,
            outline,
            period: Some(TAU * RADIUS),
        },
        front: finish,
        back: finish,
        wall: None,
    };
    let one = |first| Columns { first, pitch: 1.0, count: 1, shift: 0.0 };
    let open = builder.add_finish("open", Finish::Open);
    let hole = ElementOutline::Rectangle { width: 1.0, length: 1.5 };
    // It lies across the zero of the chart.
    builder.add_pattern(pattern("holes", open, one(TAU * RADIUS - 0.2), hole));
    let dull = builder.add_finish("dull", mirror(0.7));
    let dot = ElementOutline::Rectangle { width: 0.5, length: 0.5 };
    let two = Columns { pitch: 1.5, count: 2, ..one(4.0) };
    builder.add_pattern(pattern("dots", dull, two, dot));
    builder.build()
}

/// A rod in total reflection, in a wider tube.
pub(super) fn rod() -> Scene {
    let mut builder = builder(0.0);
    let mirror = Finish::Specular { reflectance: 0.9, transmittance: 0.0 };
    let around = Shape::Cylinder(Cylinder::new(frame(), 2.0 * RADIUS, LENGTH));
    add(&mut builder, Owner::Sheet, Some(mirror), around);
    let medium = builder.add_medium(Medium::new("glass", 1.5, 0.003));
    let (name, bounds) = ("pipe".into(), Aabb::EMPTY);
    let solid = builder.add_solid(Solid { name, medium, priority: 0, bounds, volume: None });
    let back = Frame { y: -frame().y, z: -frame().z, ..frame() };
    let entry = Flat::new(back, Region::Annulus { inner: 0.0, outer: RADIUS });
    for shape in [wall(), across(LENGTH, RADIUS), Shape::Flat(entry)] {
        add(&mut builder, Owner::Solid(solid), None, shape);
    }
    builder.build()
}

/// A rectangle about a place, seen from the direction `out`, its first side along the second direction.
fn plate(middle: DVec3, [out, along]: [DVec3; 2], [half_x, half_y]: [f64; 2]) -> Shape {
    let frame = Frame::from_axis_and_x(middle, out, along).unwrap();
    Shape::Flat(Flat::new(frame, Region::Rectangle { half_x, half_y }))
}

/// Four walls of a rectangle about the axis, outward or inward, and its two ends.
fn rectangle([a, b]: [f64; 2], inward: bool) -> [Shape; 6] {
    let f = frame();
    let middle = f.origin + 0.5 * LENGTH * f.z;
    let half = 0.5 * LENGTH;
    let flat = |out: DVec3, along: DVec3, apart: f64, sides: [f64; 2]| {
        plate(middle + apart * out, [if inward { -out } else { out }, along], sides)
    };
    [
        flat(f.x, f.z, a, [half, b]),
        flat(-f.x, f.z, a, [half, b]),
        flat(f.y, f.z, b, [half, a]),
        flat(-f.y, f.z, b, [half, a]),
        flat(f.z, f.x, half, [a, b]),
        flat(-f.z, f.x, half, [a, b]),
    ]
}

/// A rectangular duct of a mirror, of one face.
pub(super) fn duct() -> Scene {
    let mut builder = builder(0.0);
    let finish = builder.add_finish("wall", Finish::Metal { n: 1.2, k: 7.0 });
    let [a, b, c, d, ..] = rectangle([1.5 * RADIUS, 1.1 * RADIUS], true);
    builder.add_face(FaceSpec {
        name: "duct.wall".into(),
        owner: Owner::Sheet,
        front: Some(finish),
        back: Some(finish),
        pieces: [a, b, c, d].map(FacePiece::whole).into(),
    });
    builder.build()
}

/// Such a duct whose walls are faces of their own, of mirrors that differ.
pub(super) fn duct_of_faces() -> Scene {
    let [a, b, c, d, ..] = rectangle([1.5 * RADIUS, 1.1 * RADIUS], true);
    of_faces(&[(a, 0.9), (b, 0.97), (c, 1.0), (d, 0.95)])
}

/// Walls that are faces of their own, each of a mirror of its reflectance.
fn of_faces(walls: &[(Shape, f64)]) -> Scene {
    let mut builder = builder(0.0);
    for (wall, reflectance) in walls {
        let mirror = Finish::Specular { reflectance: *reflectance, transmittance: 0.0 };
        add(&mut builder, Owner::Sheet, Some(mirror), wall.clone());
    }
    builder.build()
}

/// A box of an absorbing medium.
pub(super) fn bar() -> Scene {
    let mut builder = builder(0.0);
    let medium = builder.add_medium(Medium::new("glass", 1.5, 0.003));
    let (name, bounds) = ("bar".into(), Aabb::EMPTY);
    let solid = builder.add_solid(Solid { name, medium, priority: 0, bounds, volume: None });
    for shape in rectangle([1.3 * RADIUS, 1.1 * RADIUS], false) {
        add(&mut builder, Owner::Solid(solid), None, shape);
    }
    builder.build()
}

/// Corners of a polygon that is not regular, mm.
fn corners() -> [DVec2; 5] {
    [[1.5, 0.2], [1.0, 1.6], [-0.9, 1.5], [-1.7, -0.1], [-0.2, -1.8]]
        .map(|p| RADIUS * DVec2::from(p))
}

/// The walls of a prism over it.
fn prism_walls() -> [Shape; 5] {
    let (f, corners) = (frame(), corners());
    std::array::from_fn(|side| {
        let [a, b] = [corners[side], corners[(side + 1) % corners.len()]];
        let out = f.to_world((-(b - a).perp()).extend(0.0).normalize());
        let middle = f.point_to_world((0.5 * (a + b)).extend(0.5 * LENGTH));
        plate(middle, [out, f.z], [0.5 * LENGTH, 0.5 * a.distance(b)])
    })
}

/// They as one face.
fn add_prism(builder: &mut Builder, owner: Owner, finish: Option<Finish>) {
    let finish = finish.map(|finish| builder.add_finish("wall", finish));
    builder.add_face(FaceSpec {
        name: "prism.wall".into(),
        owner,
        front: finish,
        back: finish,
        pieces: prism_walls().map(FacePiece::whole).into(),
    });
}

/// A mirror tube over a polygon.
pub(super) fn mirror_prism() -> Scene {
    let mut builder = builder(0.0);
    let mirror = Finish::Specular { reflectance: 0.97, transmittance: 0.0 };
    add_prism(&mut builder, Owner::Sheet, Some(mirror));
    builder.build()
}

/// Such a tube whose walls are faces of their own, of mirrors that differ.
pub(super) fn mirror_prism_of_faces() -> Scene {
    let [a, b, c, d, e] = prism_walls();
    of_faces(&[(a, 0.9), (b, 0.97), (c, 1.0), (d, 0.95), (e, 0.99)])
}

/// A rod over a polygon, of an absorbing medium.
pub(super) fn glass_prism() -> Scene {
    let mut builder = builder(0.0);
    let medium = builder.add_medium(Medium::new("glass", 1.5, 0.003));
    let (name, bounds) = ("rod".into(), Aabb::EMPTY);
    let solid = builder.add_solid(Solid { name, medium, priority: 0, bounds, volume: None });
    add_prism(&mut builder, Owner::Solid(solid), None);
    let (f, outline) = (frame(), corners().to_vec());
    let mirrored = outline.iter().rev().map(|p| DVec2::new(p.x, -p.y)).collect();
    let back = Frame { y: -f.y, z: -f.z, ..f };
    for (end, outline) in [(f.shifted(LENGTH * f.z), outline), (back, mirrored)] {
        let end = Shape::Flat(Flat::new(end, Region::polygon(outline)));
        add(&mut builder, Owner::Solid(solid), None, end);
    }
    builder.build()
}
