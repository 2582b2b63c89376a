use super::*;
use crate::optics::Medium;
use crate::rng::{Dimension, Sampler};
use crate::scene::pattern::{Columns, RowPositions, TableAlong};
use crate::scene::shape::{Flat, RayStart, Region, Shape};
use crate::scene::{
    Accel, Builder, FacePiece, FaceSpec, Inside, Owner, PrimId, Ray, Scene, Solid, SolidId,
    StartSurfaces,
};
use lumiduct_base::math::{Aabb, Frame, uniform_sphere};
use lumiduct_base::units::FluxUnit;
use std::f64::consts::PI;

/// Half of the size of a slab, mm.
const HALF: DVec3 = DVec3::new(10.0, 10.0, 1.0);

fn cap(radius: f64, height: f64, way: Way, round: Option<f64>) -> Element {
    let size = CapSize::Sphere(TableAlong::constant(radius));
    Element { form: ElementForm::Cap { size, height: TableAlong::constant(height) }, way, round }
}

fn wedge(height: f64, slopes: [f64; 2], span: WedgeSpan, way: Way, round: Option<f64>) -> Element {
    Element {
        form: ElementForm::Wedge { height: TableAlong::constant(height), slopes, span },
        way,
        round,
    }
}

/// A slab about the origin with a relief on its upper wall, 20 x 20 elements 1 mm apart.
fn slab(element: Element) -> Scene {
    let mut builder = Builder::new(DVec3::ZERO, Medium::new("air", 1.0, 0.0), FluxUnit::Lumen);
    let medium = builder.add_medium(Medium::new("glass", 1.5, 0.0));
    let volume = Some(8.0 * HALF.element_product());
    let bounds = Aabb::EMPTY;
    let solid = Solid { name: "slab".into(), medium, priority: 0, bounds, volume };
    let owner = Owner::Solid(builder.add_solid(solid));
    let mut walls = Vec::new();
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        for sign in [-1.0, 1.0] {
            let normal = sign * DVec3::AXES[axis];
            let x = DVec3::AXES[(axis + 1) % 3];
            let frame = Frame::from_axis_and_x(HALF * normal, normal, x).unwrap();
            let [half_x, half_y] = [frame.x, frame.y].map(|side| HALF.dot(side.abs()));
            let shape = Shape::Flat(Flat::new(frame, Region::Rectangle { half_x, half_y }));
            walls.push(builder.add_face(FaceSpec {
                name: format!("slab.{name}{sign}"),
                owner,
                front: None,
                back: None,
                pieces: vec![FacePiece::whole(shape)],
            }));
        }
    }
    let wall = walls[5];
    let ground = ReliefWall::of(&builder.scene().face_patches(wall)[0]).unwrap();
    let field = ElementField {
        rows: RowPositions::Even { first: -9.5, pitch: 1.0, count: 20 },
        columns: Columns { first: -9.5, pitch: 1.0, count: 20, shift: 0.0 },
        outline: ElementOutline::Relief(Box::new(element.clone())),
        period: None,
    };
    let relief = Relief::new("slab.relief".into(), wall, element, field, ground);
    builder.add_relief(relief, &[], [None; 2]);
    builder.build()
}

fn slabs() -> Vec<Scene> {
    let within = WedgeSpan::Within(0.9);
    vec![
        slab(cap(0.5, 0.4, Way::Into, None)),
        slab(cap(0.5, 0.5, Way::OutOf, None)),
        slab(wedge(0.3, [1.0, 1.5], within, Way::Into, None)),
        slab(wedge(0.3, [0.0, 1.5], within, Way::OutOf, None)),
    ]
}

#[test]
fn the_tree_finds_what_asking_every_surface_finds() {
    for scene in slabs() {
        assert!(matches!(scene.accel, Accel::Tree(_)));
        let mut by_scan = scene.clone();
        by_scan.accel = Accel::Scan(scene.patches.len());
        by_scan.loose = (0..scene.patches.len()).map(PrimId::new).collect();
        let mut met = 0;
        for index in 0..1500 {
            let mut sampler = Sampler::for_path(31, 0, index);
            let mut pair = || sampler.pair(Dimension::EmitPosition);
            let [u, v] = pair();
            // From the middle of the slab, and from above it.
            let (height, solids) =
                if index % 2 == 0 { (0.3, vec![SolidId::new(0)]) } else { (1.8, Vec::new()) };
            let start = DVec3::new(19.0 * u - 9.5, 19.0 * v - 9.5, height);
            let inside: Inside = solids.into_iter().collect();
            let ray = Ray::new(start, uniform_sphere(pair()));
            let find = |scene: &Scene| scene.find_next(&ray, &StartSurfaces::default(), &inside);
            let (found, expected) = (find(&scene), find(&by_scan));
            assert_eq!(found.is_some(), expected.is_some());
            if let (Some(found), Some(expected)) = (found, expected) {
                assert_eq!(found.nearest(), expected.nearest());
                assert_eq!(found.distance(), expected.distance());
                met += 1;
            }
        }
        assert!(met > 900, "{met}");
    }
}

#[test]
fn fronts_look_out_of_the_solid_and_surfaces_end_at_the_wall() {
    for scene in slabs() {
        let relief = &scene.reliefs[0];
        let face = scene.face_named("slab.relief").unwrap();
        let solid: Inside = [SolidId::new(0)].into_iter().collect();
        for (index, patch) in scene.face_patches(face).iter().enumerate().take(12) {
            let mut sampler = Sampler::for_path(32, 0, index as u64);
            for _ in 0..50 {
                let point = patch.sample(sampler.pair(Dimension::EmitPosition)).unwrap();
                let height = relief.ground.unroll(point).z;
                let side = relief.element.way.sign() * height;
                assert!((-1e-12..=0.5 + 1e-12).contains(&side), "{side}");
                let out = patch.shape.normal(point);
                for (sign, expected) in [(1.0, Inside::default()), (-1.0, solid.clone())] {
                    let ray = Ray::new(point + 1e-9 * sign * out, DVec3::new(0.13, 0.24, 0.96));
                    let inside = scene.inside_at(&ray, crate::scene::StartSide::Ahead);
                    // Near an edge, a point slightly beyond the surface may be beyond another one.
                    let is_near_an_edge = side < 1e-6 || !(1e-6..0.3 - 1e-6).contains(&side);
                    assert!(inside == expected || is_near_an_edge, "{point} {sign}");
                }
            }
        }
    }
}

#[test]
fn walls_and_elements_add_up_to_the_closed_forms() {
    let areas = |scene: &Scene| {
        let area = |name: &str| scene.face_area(scene.face_named(name).unwrap());
        (area("slab.z1"), area("slab.relief"), scene.solids[0].volume.unwrap())
    };
    let (n, whole) = (400.0, 8.0 * HALF.element_product());
    let (wall, caps, volume) = areas(&slab(cap(0.5, 0.4, Way::Into, None)));
    assert!((wall - (400.0 - n * PI * 0.4 * 0.6)).abs() < 1e-9, "{wall}");
    assert!((caps - n * 2.0 * PI * 0.5 * 0.4).abs() < 1e-9, "{caps}");
    assert!((volume - (whole - n * PI * 0.16 * (0.5 - 0.4 / 3.0))).abs() < 1e-9, "{volume}");
    let (wall, flanks, volume) =
        areas(&slab(wedge(0.3, [1.0, 1.5], WedgeSpan::Within(0.9), Way::OutOf, None)));
    assert!((wall - (400.0 - n * 0.75 * 0.9)).abs() < 1e-9, "{wall}");
    let slants = 0.3 * (2f64.sqrt() + 3.25f64.sqrt());
    assert!((flanks - n * (0.9 * slants + 0.75 * 0.3)).abs() < 1e-8, "{flanks}");
    assert!((volume - (whole + n * 0.5 * 0.3 * 0.75 * 0.9)).abs() < 1e-9, "{volume}");
}

#[test]
fn on_a_very_large_rod_an_element_takes_what_it_takes_of_a_plane() {
    let radius = Some(1e5);
    let pairs = [
        [cap(1.0, 0.6, Way::Into, None), cap(1.0, 0.6, Way::Into, radius)],
        [cap(1.0, 0.6, Way::OutOf, None), cap(1.0, 0.6, Way::OutOf, radius)],
    ];
    for [flat, round] in pairs {
        assert!((round.area(0.0) / flat.area(0.0) - 1.0).abs() < 1e-4);
        assert!((round.volume(0.0) / flat.volume(0.0) - 1.0).abs() < 1e-3);
        assert!((round.size(0.0) - flat.size(0.0)).length() < 1e-5);
    }
}

#[test]
fn rows_may_touch_but_not_overlap() {
    let groove = wedge(0.5, [1.0, 1.0], WedgeSpan::Through(4.0), Way::Into, None);
    assert!(!groove.overlap([0.0, 1.0], DVec2::new(0.0, 1.0)));
    assert!(groove.overlap([0.0, 0.999], DVec2::new(0.0, 0.999)));
    // A deep dimple in a rod is wider inside than on the wall.
    let deep = cap(1.0, 1.0, Way::Into, Some(1.5));
    let wall_alone = 2.0 * 1.5 * (1.0f64 / 1.5 / 2.0).asin() * 2.0;
    assert!(deep.size(0.0).x > 0.95 * wall_alone, "{} {wall_alone}", deep.size(0.0).x);
}

#[test]
fn a_ray_on_the_rim_of_an_element_never_slips_between_it_and_the_wall() {
    let scene = slab(wedge(0.25, [1.0, 1.0], WedgeSpan::Within(1.0), Way::Into, None));
    let inside: Inside = [SolidId::new(0)].into_iter().collect();
    for index in 0..4000u32 {
        // Straight up and at a slant into the rims at v = -9.75, ..., none of which is exact.
        let row = f64::from(index % 20);
        let target = DVec3::new(-9.3 + 0.001 * f64::from(index), row - 9.75, 1.0);
        let from = DVec3::new(target.x, target.y + 0.01 * f64::from(index % 7), -0.9);
        let ray = Ray::new(from, target - from);
        let hits = scene.find_next(&ray, &StartSurfaces::default(), &inside).unwrap();
        assert!((hits.distance() - (target - from).length()).abs() < 1e-9, "{target}");
        let mut around = 0;
        for patch in &scene.patches {
            patch.crossings(&ray, RayStart::Elsewhere, |_| around += 1);
        }
        assert!(around >= 2, "{around}");
    }
}
