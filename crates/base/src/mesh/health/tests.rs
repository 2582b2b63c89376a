use super::*;
use crate::mesh::bodies::{BodyBuilder, Normals, block, icosphere, rod};
use glam::DVec2;
use std::f64::consts::{PI, TAU};

#[test]
fn a_block_is_sound_and_has_no_facets() {
    let health = health(&block(DVec3::new(1.0, 2.0, 3.0)));
    assert!(health.is_sound());
    assert!((health.signed_volume_mm3 - 6.0).abs() < 1e-14);
    assert!((health.area_mm2 - 22.0).abs() < 1e-14);
    assert_eq!((health.shells, health.facets), (1, None));
}

#[test]
fn a_missing_triangle_opens_three_edges_and_a_flipped_one_makes_three_inconsistent() {
    let mut mesh = block(DVec3::ONE);
    mesh.triangles[4].swap(0, 1);
    assert_eq!(health(&mesh).inconsistent_edges.count, 3);
    mesh.triangles.remove(4);
    let broken = health(&mesh);
    assert_eq!((broken.open_edges.count, broken.inconsistent_edges.count), (3, 0));
    // The middle of an edge of the unit block.
    let first = broken.open_edges.first.unwrap();
    assert!(first.abs().max_element() <= 1.0 && first.length() > 0.0, "{first}");
    assert!(!broken.is_sound());
}

#[test]
fn an_inside_out_sphere_has_a_negative_volume_and_opposed_normals() {
    let mut mesh = icosphere(2.0, 3, Normals::Smooth);
    let right = health(&mesh);
    assert!((right.signed_volume_mm3 / (PI * 32.0 / 3.0) - 1.0).abs() < 0.02);
    assert_eq!((right.opposed_normals.count, right.facets), (0, None));
    // The middle of an edge lies farthest below the sphere.
    let middles = half_edges(&mesh.triangles).into_iter().map(|edge| {
        let [a, b] = [edge.low, edge.high].map(|end| mesh.positions[end as usize]);
        2.0 - a.midpoint(b).length()
    });
    let deepest = middles.fold(0.0, f64::max);
    assert!((right.sagitta_mm.unwrap() / deepest - 1.0).abs() < 0.01, "{right:?}, {deepest}");
    mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    mesh.normals.iter_mut().flatten().for_each(|normals| normals.swap(1, 2));
    let wrong = health(&mesh);
    assert_eq!(wrong.signed_volume_mm3, -right.signed_volume_mm3);
    assert_eq!(wrong.opposed_normals.count, mesh.triangles.len());
    assert_eq!(wrong.open_edges.count + wrong.inconsistent_edges.count, 0);
    assert!(!wrong.is_sound());
}

#[test]
fn two_blocks_that_share_an_edge_crowd_it_and_apart_they_are_two_shells() {
    for (shift, crowded, shells) in [(1.0, 1, 1), (3.0, 0, 2)] {
        let mut builder = crate::mesh::MeshBuilder::default();
        let mesh = block(DVec3::ONE);
        for triangle in 0..12 {
            let corners = mesh.corners(triangle);
            builder.add(corners, None, "").unwrap();
            let offset = shift * (DVec3::X + DVec3::Y);
            builder.add(corners.map(|p| p + offset), None, "").unwrap();
        }
        let health = health(&builder.finish().unwrap());
        assert_eq!((health.crowded_edges.count, health.shells), (crowded, shells));
    }
}

#[test]
fn a_triangle_without_breadth_is_a_sliver_and_a_long_one_is_none() {
    let long = health(&rod(0.5, 100.0, 64, Normals::Smooth));
    assert_eq!(long.slivers.count, 0);
    let mut mesh = block(DVec3::ONE);
    let between = mesh.positions[0].midpoint(mesh.positions[1]) + 1e-6 * DVec3::ONE;
    mesh.positions.push(between);
    mesh.triangles.push([0, 1, 8]);
    let health = health(&mesh);
    assert_eq!((health.slivers.count, health.degenerate_triangles.count), (1, 0));
    assert_eq!(health.slivers.first, Some(mesh.positions[0]));
}

#[test]
fn collapsed_triangles_are_counted_and_do_no_harm() {
    let mut mesh = block(DVec3::ONE);
    mesh.triangles.push([1, 1, 2]);
    let health = health(&mesh);
    assert_eq!((health.degenerate_triangles.count, health.shells), (1, 1));
    assert!(health.is_sound());
}

#[test]
fn the_facets_of_a_rod_are_found_unless_normals_smooth_them() {
    let faceted = health(&rod(2.0, 40.0, 96, Normals::None)).facets.unwrap();
    assert!((faceted.turn_deg - 3.75).abs() < 1e-9);
    assert!((faceted.per_turn() - 96.0).abs() < 1e-6);
    // Wall without the two caps: 2 r L of 2 r L + 2 r².
    assert!((faceted.area_share - 40.0 / 42.0).abs() < 1e-4);
    assert!((faceted.skew_drift(25.0).unwrap() - 16.0 / 96.0).abs() < 1e-9);
    assert_eq!(faceted.skew_drift(100.0), None, "lost");
    assert_eq!(health(&rod(2.0, 40.0, 96, Normals::Smooth)).facets, None);
}

#[test]
fn normals_of_the_file_leave_no_facets_of_a_pipe_with_a_mirror_across_its_end() {
    // However coarse the wall is, and however near to 45 degrees it meets the mirror.
    for sides in [12, 24, 96] {
        let smooth = health(&mirror_pipe(sides, Normals::Smooth));
        assert!(smooth.is_sound());
        assert_eq!(smooth.facets, None, "{sides}");
        let faceted = health(&mirror_pipe(sides, Normals::None)).facets.unwrap();
        let ratio = faceted.per_turn() / f64::from(sides);
        assert!((ratio - 1.0).abs() < 1e-3, "{sides}: {faceted:?}");
    }
}

#[test]
fn flat_faces_that_meet_at_an_angle_are_no_curved_wall() {
    // A wedge of 20 degrees, one with a bevel of 30 degrees, and a zigzag of 10 degrees.
    let tilted = |degrees: f64| f64::to_radians(degrees).tan();
    let wedge = vec![[0.0, 0.0], [10.0, 0.0], [10.0, 5.0], [0.0, 5.0 + 10.0 * tilted(20.0)]];
    let bevel = vec![
        [0.0, 0.0],
        [10.0, 0.0],
        [10.0, 4.0],
        [8.0, 4.0 + 2.0 * tilted(30.0)],
        [0.0, 4.0 + 2.0 * tilted(30.0)],
    ];
    let mut zigzag = vec![[0.0, 0.0], [20.0, 0.0]];
    zigzag.extend((0..=20).rev().map(|i| [f64::from(i), 4.0 + f64::from(i % 2) * tilted(10.0)]));
    for outline in [wedge, bevel, zigzag] {
        let found = health(&prism(&outline));
        assert!(found.is_sound(), "{outline:?}");
        assert_eq!(found.facets, None, "{outline:?}");
    }
    let arc = (0..=18).map(|i| (f64::from(i) * 10.0).to_radians().sin_cos());
    let half_round: Vec<[f64; 2]> = arc.map(|(sin, cos)| [5.0 * cos, 5.0 * sin]).collect();
    let facets = health(&prism(&half_round)).facets.unwrap();
    assert!((facets.per_turn() - 36.0).abs() < 1e-6, "{facets:?}");
}

/// A closed pipe of radius 1.5 along +z whose far end is cut by a plane at 45 degrees, faces entry, wall and mirror.
fn mirror_pipe(sides: u32, normals: Normals) -> TriangleMesh {
    let mut builder = BodyBuilder::default();
    // A facet centre, not an edge, lies where the wall meets the plane at 45 degrees.
    let point = |side: u32, far: bool| {
        let (sin, cos) = (TAU * (f64::from(side % sides) + 0.5) / f64::from(sides)).sin_cos();
        let (x, y) = (1.5 * cos, 1.5 * sin);
        let point = DVec3::new(x, y, if far { 20.0 + x } else { 0.0 });
        // As in a GLB: single precision, in metres.
        1000.0 * (1e-3 * point).as_vec3().as_dvec3()
    };
    let given = |corners: [DVec3; 3]| (normals == Normals::Smooth).then_some(corners);
    for side in 0..sides {
        let [a, b] = [side, side + 1].map(|side| point(side, false));
        let [d, c] = [side, side + 1].map(|side| point(side, true));
        for corners in [[a, b, c], [a, c, d]] {
            let across = corners.map(|p| DVec3::new(p.x, p.y, 0.0).normalize());
            builder.add(corners, given(across), "wall");
        }
        builder.add([DVec3::ZERO, b, a], given([-DVec3::Z; 3]), "entry");
        let mirror = DVec3::new(-1.0, 0.0, 1.0).normalize();
        builder.add([20.0 * DVec3::Z, d, c], given([mirror; 3]), "mirror");
    }
    builder.finish()
}

/// A closed prism of length 7 along +z over a counter-clockwise outline, one face, no normals.
fn prism(outline: &[[f64; 2]]) -> TriangleMesh {
    let mut builder = BodyBuilder::default();
    let points: Vec<DVec2> = outline.iter().map(|p| DVec2::from(*p)).collect();
    for triangle in crate::math::planar::triangulate(&points) {
        let [a, b, c] = triangle.map(|p| p.extend(0.0));
        builder.add([a, c, b], None, "");
        builder.add([a, b, c].map(|p| p + 7.0 * DVec3::Z), None, "");
    }
    for (index, from) in points.iter().enumerate() {
        let to = points[(index + 1) % points.len()];
        let [a, b] = [*from, to].map(|p| p.extend(0.0));
        let [d, c] = [a, b].map(|p| p + 7.0 * DVec3::Z);
        builder.add([a, b, c], None, "");
        builder.add([a, c, d], None, "");
    }
    builder.finish()
}
