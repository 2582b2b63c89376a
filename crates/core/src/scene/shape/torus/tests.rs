//! Crossings of tori, their chart and their area.

use crate::scene::shape::testing::{
    Truth, assert_bounds_are_tight, assert_crossings_match_a_scan,
    assert_first_crossings_are_those_of_all, assert_grazing_rays_come_back,
    assert_hit_from_far_away, assert_samples_are_uniform, assert_scales,
    assert_starting_on_it_drops_only_the_start, bounce, crossings_of, tilted,
};
use crate::scene::shape::torus::*;
use crate::scene::shape::{Cylinder, Shape};
use std::f64::consts::PI;

/// Signed distance to the wall of the whole torus.
fn distance(frame: &Frame, major: f64, minor: f64, p: DVec3) -> f64 {
    let p = frame.point_to_local(p);
    (p.truncate().length() - major).hypot(p.z) - minor
}

/// Depth of a point inside the arc, as a length.
fn inside_arc(frame: &Frame, angle: f64, p: DVec3) -> f64 {
    let p = frame.point_to_local(p);
    let theta = p.y.atan2(p.x).rem_euclid(TAU);
    p.length() * theta.min(angle - theta).max(-(TAU - theta))
}

#[test]
fn arcs_of_thin_and_fat_tubes_keep_the_contract_of_shapes() {
    for (major, minor, angle) in
        [(8.0, 1.5, 0.25 * TAU), (8.0, 0.1, 4.0), (3.0, 2.9, 2.0), (3.0, 1.0, TAU)]
    {
        let frame = tilted(1.0);
        let shape = Shape::Torus(Torus::new(frame, major, minor, angle).with_section_zero(0.4));
        let implicit = |p: DVec3| distance(&frame, major, minor, p);
        let inside_trim = |p: DVec3| if angle < TAU { inside_arc(&frame, angle, p) } else { 1.0 };
        let truth = Truth { shape: &shape, implicit: &implicit, inside_trim: &inside_trim };
        assert_crossings_match_a_scan(&truth, 400);
        assert_starting_on_it_drops_only_the_start(&shape, 4000);
        assert_first_crossings_are_those_of_all(&shape, 20_000);
        assert_hit_from_far_away(&truth, 1.0);
        assert_samples_are_uniform(&truth, 1e-14 * (major + 6.0));
        assert_bounds_are_tight(&shape, 1e-4);
    }
}

#[test]
fn the_unit_of_length_does_not_matter() {
    assert_scales(|scale| Shape::Torus(Torus::new(tilted(scale), 8.0 * scale, 1.5 * scale, 2.0)));
}

#[test]
fn a_thousand_mirror_bounces_inside_stay_on_the_wall_and_keep_their_skew() {
    for (major, minor) in [(8.0, 1.5), (8.0, 0.2), (3.0, 2.7)] {
        let frame = tilted(1.0);
        let shape = Shape::Torus(Torus::new(frame, major, minor, TAU));
        for path in 0..20 {
            let mut skew = None;
            let (mut off, mut drift) = (0.0f64, 0.0f64);
            bounce(&shape, Toward::Front, &[], path, |ray| {
                off = off.max(distance(&frame, major, minor, ray.origin()).abs());
                let now = (ray.origin() - frame.origin).cross(ray.dir()).dot(frame.z);
                drift = drift.max((now - *skew.get_or_insert(now)).abs());
            });
            assert!(off < 2e-13 && drift < 1e-12 * major, "off {off}, skew {drift}");
        }
    }
}

#[test]
fn a_ray_that_grazes_the_wall_inward_always_comes_back_to_it() {
    for (major, minor) in [(8.0, 1.5), (8.0, 0.2), (3.0, 2.7)] {
        let shape = Shape::Torus(Torus::new(tilted(1.0), major, minor, TAU));
        assert_grazing_rays_come_back(&shape);
    }
}

#[test]
fn the_chart_continues_that_of_a_straight_leg() {
    // A leg along +y whose profile x axis is 0.7 rad from outward, then an arc about z from x.
    let profile_x = DVec3::new((0.7f64).cos(), 0.0, -(0.7f64).sin());
    let end = DVec3::new(8.0, 0.0, 0.0);
    let leg_frame = Frame::from_axis_and_x(end - 10.0 * DVec3::Y, DVec3::Y, profile_x).unwrap();
    let leg = Shape::Cylinder(Cylinder::new(leg_frame, 1.5, 10.0));
    let zero = (-profile_x.z).atan2(profile_x.x);
    let bend = Shape::Torus(Torus::new(Frame::WORLD, 8.0, 1.5, 1.0).with_section_zero(zero));
    for i in 0..50 {
        let p = bend.sample([(f64::from(i) + 0.5) / 50.0, 0.0]);
        let (on_leg, on_bend) = (leg.chart(p), bend.chart(p));
        assert!((on_leg.x - on_bend.x).abs() < 1e-13, "{on_leg} {on_bend}");
        assert!((on_leg.y - 10.0).abs() < 1e-13 && on_bend.y.abs() < 1e-13);
    }
}

#[test]
fn the_area_is_pappus() {
    let torus = Torus::new(Frame::WORLD, 8.0, 1.5, 0.25 * TAU);
    assert!((torus.area() - 0.25 * TAU * 8.0 * TAU * 1.5).abs() < 1e-12);
    // The outer half of the section is larger by 4 r² per radian.
    let outer =
        |u: f64| ChartRect { min: DVec2::new(u, 0.0), max: DVec2::new(u + 0.75 * PI, 100.0) };
    let outer_half = torus.area_in(outer(0.0)) + torus.area_in(outer(2.25 * PI));
    assert!((outer_half - 0.5 * PI * (8.0 * PI * 1.5 + 2.0 * 2.25)).abs() < 1e-12);
}

#[test]
fn a_ray_along_the_axis_misses_and_one_through_the_equator_crosses_four_times() {
    let shape = Shape::Torus(Torus::new(Frame::WORLD, 8.0, 1.5, TAU));
    let along_axis = Ray::new(DVec3::ZERO, DVec3::Z);
    assert!(crossings_of(&shape, &along_axis, RayStart::Elsewhere).is_empty());
    let equator = Ray::new(DVec3::ZERO, DVec3::X);
    let found: Vec<f64> =
        crossings_of(&shape, &equator, RayStart::Elsewhere).iter().map(|c| c.t).collect();
    for (t, expected) in found.iter().zip([-9.5, -6.5, 6.5, 9.5]) {
        assert!((t - expected).abs() < 1e-14);
    }
    assert_eq!(found.len(), 4);
    let from_outermost = Ray::new(9.5 * DVec3::X, -DVec3::X);
    assert_eq!(crossings_of(&shape, &from_outermost, RayStart::On).len(), 3);
    for tangent in [DVec3::Y, DVec3::Z] {
        let touching =
            |x: f64| crossings_of(&shape, &Ray::new(x * DVec3::X, tangent), RayStart::On);
        assert!(touching(9.5).is_empty(), "only the start");
        let through = touching(6.5);
        assert!(through.iter().all(|crossing| crossing.t.abs() > 1.0), "{through:?}");
    }
}
