//! Cuts of a cylinder, its crossings and its chart.

use crate::scene::Ray;
use crate::scene::shape::cylinder::*;
use std::f64::consts::{PI, TAU};

fn frame() -> Frame {
    Frame::from_axis(DVec3::new(0.4, -0.2, 1.0), DVec3::new(0.2, 0.5, 0.9))
}

/// Cut at its upper end by a mitre and at its lower end by an oblique plane.
fn mitred() -> Cylinder {
    let f = frame();
    let plane = |z: f64, normal: DVec3| {
        HalfSpace::behind(f.point_to_world(DVec3::new(0.0, 0.0, z)), f.to_world(normal))
    };
    let cuts = vec![
        plane(5.0, DVec3::new(1.0, 0.0, 1.0)),
        plane(5.0, DVec3::new(-1.0, 0.0, 1.0)),
        plane(0.0, DVec3::new(0.2, 0.3, -1.0)),
    ];
    Cylinder::cut(f, 1.5, -1.0, 5.0, cuts)
}

fn walls() -> Vec<(Cylinder, f64)> {
    vec![
        (Cylinder::new(frame(), 1.5, 5.0), TAU * 7.5),
        (Cylinder::sector(frame(), 1.5, 1.0, 3.0, 2.0).inward(), 6.0),
        (Cylinder::sector(frame(), 1.5, 1.0, 3.0, 4.5), 13.5),
        // The mitre subtracts the mean of r |cos φ| = 2r/π from the height, the tilt of the
        // lower end nothing.
        (mitred(), TAU * 1.5 * (5.0 - 2.0 * 1.5 / PI)),
    ]
}

#[test]
fn areas_of_cells_add_up_and_the_whole_is_exact() {
    for (wall, area) in walls() {
        assert!((wall.area() - area).abs() < 1e-12 * area, "{} {area}", wall.area());
        let (bounds, n) = (wall.chart_bounds(), 7);
        let step = (bounds.max - bounds.min) / f64::from(n);
        let sum: f64 = (0..n * n)
            .map(|i| {
                let min = bounds.min + step * DVec2::new(f64::from(i % n), f64::from(i / n));
                wall.area_in(ChartRect { min, max: min + step })
            })
            .sum();
        assert!((sum - area).abs() < 1e-12 * area);
    }
}

#[test]
fn samples_lie_on_the_wall_and_fill_a_cell_by_its_area() {
    for (wall, area) in walls() {
        let (n, bounds) = (20_000u32, wall.chart_bounds());
        let middle = 0.5 * (bounds.min + bounds.max);
        let mut inside = 0u32;
        for i in 0..n {
            let u = [
                (f64::from(i) + 0.5) / f64::from(n),
                ((f64::from(i) + 0.5) * 0.618_033_988_749_894_9).fract(),
            ];
            let p = wall.sample(u);
            let ray = Ray::new(p - 1e-3 * wall.normal(p), wall.normal(p));
            let mut found = false;
            wall.crossings(&ray, RayStart::Elsewhere, |crossing| {
                found |= (crossing.t - 1e-3).abs() < 1e-12 && crossing.toward == Toward::Front;
            });
            assert!(found, "{p}");
            inside += u32::from(wall.chart(p).cmple(middle).all());
        }
        let share = wall.area_in(ChartRect { min: bounds.min, max: middle }) / area;
        let found = f64::from(inside) / f64::from(n);
        assert!((found - share).abs() < 2e-3, "{found} {share}");
    }
}

#[test]
fn a_ray_from_the_wall_finds_the_other_side_and_its_own_place_is_no_crossing() {
    let f = frame();
    let whole = Cylinder::new(f, 2.0, 10.0);
    let half = Cylinder::sector(f, 2.0, 0.0, 10.0, PI).inward();
    let from = f.point_to_world(DVec3::new(0.0, -2.0, 5.0));
    let ray = Ray::new(from, f.to_world(DVec3::new(0.1, 1.0, 0.3)));
    for (wall, start, count, toward) in [
        (&whole, RayStart::On, 1, Toward::Front),
        (&whole, RayStart::Elsewhere, 2, Toward::Front),
        (&half, RayStart::Elsewhere, 1, Toward::Back),
    ] {
        let mut found = Vec::new();
        wall.crossings(&ray, start, |crossing| found.push(crossing));
        assert_eq!(found.len(), count);
        let last = found.last().unwrap();
        assert!(((ray.at(last.t) - f.origin).dot(f.y) - 2.0).abs() < 0.1);
        assert_eq!(last.toward, toward);
    }
}
