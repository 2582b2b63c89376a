//! Paths in rows and bounce by bounce end in the same places.

use crate::optics::REFERENCE_WAVELENGTH;
use crate::optics::{Finish, Medium};
use crate::rng::{Dimension, Sampler};
use crate::scene::pattern::{Columns, ElementField, ElementOutline, Pattern, RowPositions};
use crate::scene::shape::{Cylinder, Flat, Region, Shape};
use crate::scene::{
    Builder, FaceId, FacePiece, FaceSpec, Inside, Owner, Ray, RowReach, Scene, Solid, SolidId,
    StartSurfaces,
};
use crate::transport::walk::event::{Carries, Event, Observer};
use crate::transport::walk::path::Path;
use crate::transport::walk::walk;
use glam::{DVec2, DVec3};
use lumiduct_base::math::{Aabb, Frame, cosine_hemisphere, disk};
use lumiduct_base::units::FluxUnit;
use std::f64::consts::TAU;
use std::ops::ControlFlow;

const RADIUS: f64 = 1.5;
const LENGTH: f64 = 90.0;
const PATHS: u64 = 500;
const LIMIT: u32 = 4000;
const MOST_FACES: usize = 8;

fn frame() -> Frame {
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
fn tube() -> Scene {
    let mut builder = builder(0.002);
    add(&mut builder, Owner::Sheet, Some(Finish::Metal { n: 1.2, k: 7.0 }), wall());
    add(&mut builder, Owner::Sheet, Some(Finish::Open), across(0.4 * LENGTH, 0.3 * RADIUS));
    builder.build()
}

/// The tube of a mirror with a row of open holes, and two columns of dots that are duller mirrors.
fn perforated() -> Scene {
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
fn rod() -> Scene {
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

/// Four walls of a rectangle about the axis, outward or inward, and its two ends.
fn rectangle(half: [f64; 2], inward: bool) -> [Shape; 6] {
    let f = frame();
    let middle = f.origin + 0.5 * LENGTH * f.z;
    let flat = |out: DVec3, along: DVec3, apart: f64, sides: [f64; 2]| {
        let normal = if inward { -out } else { out };
        let frame = Frame::from_axis_and_x(middle + apart * out, normal, along).unwrap();
        let [half_x, half_y] = sides;
        Shape::Flat(Flat::new(frame, Region::Rectangle { half_x, half_y }))
    };
    let [a, b] = half;
    [
        flat(f.x, f.z, a, [0.5 * LENGTH, b]),
        flat(-f.x, f.z, a, [0.5 * LENGTH, b]),
        flat(f.y, f.z, b, [0.5 * LENGTH, a]),
        flat(-f.y, f.z, b, [0.5 * LENGTH, a]),
        flat(f.z, f.x, 0.5 * LENGTH, half),
        flat(-f.z, f.x, 0.5 * LENGTH, half),
    ]
}

/// A rectangular duct of a mirror, of one face.
fn duct() -> Scene {
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
fn duct_of_faces() -> Scene {
    let mut builder = builder(0.0);
    let walls = rectangle([1.5 * RADIUS, 1.1 * RADIUS], true).into_iter();
    for (wall, reflectance) in walls.zip([0.9, 0.97, 1.0, 0.95]) {
        let mirror = Finish::Specular { reflectance, transmittance: 0.0 };
        add(&mut builder, Owner::Sheet, Some(mirror), wall);
    }
    builder.build()
}

/// A box of an absorbing medium.
fn bar() -> Scene {
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
        let wall = Frame::from_axis_and_x(middle, out, f.z).unwrap();
        let region = Region::Rectangle { half_x: 0.5 * LENGTH, half_y: 0.5 * a.distance(b) };
        Shape::Flat(Flat::new(wall, region))
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
fn mirror_prism() -> Scene {
    let mut builder = builder(0.0);
    let mirror = Finish::Specular { reflectance: 0.97, transmittance: 0.0 };
    add_prism(&mut builder, Owner::Sheet, Some(mirror));
    builder.build()
}

/// Such a tube whose walls are faces of their own, of mirrors that differ.
fn mirror_prism_of_faces() -> Scene {
    let mut builder = builder(0.0);
    for (wall, reflectance) in prism_walls().into_iter().zip([0.9, 0.97, 1.0, 0.95, 0.99]) {
        let mirror = Finish::Specular { reflectance, transmittance: 0.0 };
        add(&mut builder, Owner::Sheet, Some(mirror), wall);
    }
    builder.build()
}

/// A rod over a polygon, of an absorbing medium.
fn glass_prism() -> Scene {
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

/// What becomes of a path.
#[derive(Debug, Default)]
struct Fate<const JUMPS: bool, const BACK: bool> {
    events: usize,
    end: Option<(Ray, f64, u32)>,
    by_face: [f64; MOST_FACES],
    in_medium: f64,
    /// Throughput that arrives at the first face and that leaves it.
    passed: [f64; 2],
}

impl<const JUMPS: bool, const BACK: bool> Observer for Fate<JUMPS, BACK> {
    const CARRIES: Carries = if BACK { Carries::Radiance } else { Carries::Flux };

    fn roulette_below(&self) -> f64 {
        0.0
    }

    fn allows_jumps(&self) -> bool {
        JUMPS
    }

    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()> {
        self.events += 1;
        match event {
            Event::Travel(segment) if segment.length.is_finite() => {
                self.in_medium += segment.throughput - segment.arriving;
            }
            Event::Depart(vertex, departure) => {
                let face = vertex.interface.acting.face;
                self.by_face[face.index()] += vertex.throughput - departure.throughput;
                if face.index() == 0 {
                    self.passed[0] += vertex.throughput;
                    self.passed[1] += departure.throughput;
                }
            }
            Event::Jump(jump) => {
                for (face, absorbed) in jump.absorbed_by_faces {
                    self.by_face[face.index()] += absorbed;
                }
                self.in_medium += jump.absorbed_in_medium;
                self.passed[0] += jump.arriving;
                self.passed[1] += jump.leaving;
            }
            Event::Escaped(_) => self.end = Some((path.ray, path.throughput, path.depth)),
            _ => {}
        }
        ControlFlow::Continue(())
    }
}

fn start((scene, inside): (&Scene, &Inside), ray: Ray) -> Path {
    Path {
        ray,
        throughput: 1.0,
        wavelength: REFERENCE_WAVELENGTH,
        stokes: None,
        source: None,
        medium: scene.medium_in(inside),
        inside: inside.clone(),
        on: StartSurfaces::default(),
        depth: 0,
    }
}

fn fate<const JUMPS: bool, const BACK: bool>(
    (scene, inside): (&Scene, &Inside),
    (index, limit): (u64, u32),
) -> Fate<JUMPS, BACK> {
    let mut sampler = Sampler::for_path(3, 0, index);
    let at = disk(sampler.pair(Dimension::EmitPosition));
    let dir = cosine_hemisphere(sampler.pair(Dimension::EmitDirection));
    let at = frame().point_to_world(0.999 * RADIUS * at + 0.01 * DVec3::Z);
    let path = start((scene, inside), Ray::new(at, frame().to_world(dir)));
    let mut fate = Fate::default();
    walk(scene, path, limit, &mut sampler, &mut fate);
    fate
}

/// Events with jumps over those without.
fn assert_same_fates<const BACK: bool>(scene: &Scene, inside: &Inside) -> f64 {
    let (mut with, mut without) = (0, 0);
    for index in 0..PATHS {
        let jumped = fate::<true, BACK>((scene, inside), (index, LIMIT));
        let stepped = fate::<false, BACK>((scene, inside), (index, LIMIT));
        (with, without) = (with + jumped.events, without + stepped.events);
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-9;
        let mut by_face = jumped.by_face.iter().zip(stepped.by_face);
        assert!(by_face.all(|(a, b)| near(*a, b)), "{jumped:?} {stepped:?}");
        assert!(near(jumped.in_medium, stepped.in_medium), "{jumped:?} {stepped:?}");
        let (Some((ray, throughput, depth)), Some((ray_0, throughput_0, depth_0))) =
            (jumped.end, stepped.end)
        else {
            assert_eq!(jumped.end.is_some(), stepped.end.is_some());
            continue;
        };
        assert!(ray.origin().distance(ray_0.origin()) < 1e-9, "{ray:?} {ray_0:?}");
        assert!(ray.dir().distance(ray_0.dir()) < 1e-9, "{ray:?} {ray_0:?}");
        assert!((throughput / throughput_0 - 1.0).abs() < 1e-9 || throughput < 1e-200);
        assert_eq!(depth, depth_0);
    }
    with as f64 / without as f64
}

#[test]
fn paths_end_in_the_same_place_with_and_without_jumps() {
    let outside = Inside::default();
    let in_rod: Inside = [SolidId::new(0)].into_iter().collect();
    for events in [
        assert_same_fates::<false>(&tube(), &outside),
        assert_same_fates::<true>(&tube(), &outside),
        assert_same_fates::<false>(&perforated(), &outside),
        assert_same_fates::<true>(&perforated(), &outside),
        assert_same_fates::<false>(&rod(), &in_rod),
        assert_same_fates::<true>(&rod(), &in_rod),
        assert_same_fates::<false>(&duct(), &outside),
        assert_same_fates::<true>(&duct(), &outside),
        assert_same_fates::<false>(&duct_of_faces(), &outside),
        assert_same_fates::<true>(&duct_of_faces(), &outside),
        assert_same_fates::<false>(&bar(), &in_rod),
        assert_same_fates::<true>(&bar(), &in_rod),
        assert_same_fates::<false>(&mirror_prism(), &outside),
        assert_same_fates::<true>(&mirror_prism(), &outside),
        assert_same_fates::<false>(&mirror_prism_of_faces(), &outside),
        assert_same_fates::<true>(&mirror_prism_of_faces(), &outside),
        assert_same_fates::<false>(&glass_prism(), &in_rod),
        assert_same_fates::<true>(&glass_prism(), &in_rod),
    ] {
        assert!(events < 0.5, "jumps leave {events} of all events");
    }
}

#[test]
fn light_that_passes_a_round_wall_is_summed_over_the_bounces_of_a_row() {
    let (scene, outside) = (tube(), Inside::default());
    for index in 0..PATHS {
        let jumped = fate::<true, false>((&scene, &outside), (index, LIMIT));
        let stepped = fate::<false, false>((&scene, &outside), (index, LIMIT));
        for (a, b) in jumped.passed.iter().zip(stepped.passed) {
            assert!((a - b).abs() <= 1e-9 * b.max(1.0), "{jumped:?} {stepped:?}");
        }
    }
}

/// What is left of a path in short rows that follow each other, as between the corners of a ring, where roulette acts.
#[derive(Debug, Default)]
struct InShortRows(Option<f64>);

impl Observer for InShortRows {
    fn allows_jumps(&self) -> bool {
        true
    }

    fn limit_row(&self, _: &Path, reach: &mut RowReach) {
        reach.end_after(6);
    }

    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()> {
        if matches!(event, Event::Roulette(_)) {
            self.0.get_or_insert(path.throughput);
        }
        ControlFlow::Continue(())
    }
}

#[test]
fn roulette_ends_rows_that_follow_each_other_where_hardly_anything_is_left() {
    let (scene, inside) = (duct(), Inside::default());
    for index in 0..PATHS {
        let mut sampler = Sampler::for_path(3, 0, index);
        let across = std::f64::consts::TAU * sampler.one(Dimension::EmitDirection);
        // Almost across the axis: thousands of bounces to the end.
        let dir = DVec3::new(across.cos(), across.sin(), 1e-3);
        let ray = Ray::new(frame().point_to_world(DVec3::Z), frame().to_world(dir.normalize()));
        let mut found = InShortRows::default();
        walk(&scene, start((&scene, &inside), ray), LIMIT, &mut sampler, &mut found);
        assert!(found.0.expect("roulette acts before the end") < 1e-6, "{found:?}");
    }
}

#[test]
fn a_jump_ends_at_the_bounce_limit() {
    let outside = Inside::default();
    let scenes =
        |index| [tube(), duct(), duct_of_faces(), mirror_prism()].map(|scene| (index, scene));
    for (index, scene) in (0..100).flat_map(scenes) {
        let fates = [1, 2, 7].map(|limit| fate::<true, false>((&scene, &outside), (index, limit)));
        let steps = [1, 2, 7].map(|limit| fate::<false, false>((&scene, &outside), (index, limit)));
        for (jumped, stepped) in fates.iter().zip(&steps) {
            for (a, b) in jumped.by_face.iter().zip(stepped.by_face) {
                assert!((a - b).abs() < 1e-12, "{jumped:?} {stepped:?}");
            }
        }
    }
}
