//! Properties of whole sweeps, for every kind of profile on every kind of path.

use super::testing::*;
use super::*;
use crate::rng::{Dimension, Sampler};
use crate::scene::Ray;
use crate::scene::shape::{ChartRect, RayStart, Toward};
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

#[test]
fn every_line_goes_in_and_out_by_turns_through_a_closed_sweep() {
    for_all(|name, _, _, sweep| {
        let (surfaces, bounds) = (surfaces(sweep), bounds(sweep));
        let mut seen = 0;
        for index in 0..3000 {
            let ray = ray_through(&bounds, &mut Sampler::for_path(SEED, 0, index));
            let found = crossings(&surfaces, &ray);
            let turns = [Toward::Back, Toward::Front].into_iter().cycle().zip(&found);
            let by_turns = turns.into_iter().all(|(toward, crossing)| toward == crossing.toward);
            assert!(found.len().is_multiple_of(2) && by_turns, "{name}: {ray:?} {found:?}");
            seen += found.len();
            // From between two crossings the next surface is an exit, whatever the direction.
            for pair in found.chunks(2) {
                let inside = ray.at(0.5 * (pair[0].t + pair[1].t));
                let dir = direction_of(&mut Sampler::for_path(SEED, 1, index));
                let ahead = crossings(&surfaces, &Ray::new(inside, dir));
                let first = ahead.iter().find(|crossing| crossing.t > 0.0);
                assert_eq!(first.map(|c| c.toward), Some(Toward::Front), "{name}: {inside} {dir}");
            }
        }
        assert!(seen > 500, "{name}: only {seen} crossings");
    });
}

/// Calls `visit` with points that fill a surface evenly, and the area of each.
fn scan(shape: &Shape, n: u32, mut visit: impl FnMut(DVec3, f64)) {
    let area = shape.area() / f64::from(n);
    for i in 0..n {
        let golden = ((f64::from(i) + 0.5) * 0.618_033_988_749_894_9).fract();
        visit(shape.sample([(f64::from(i) + 0.5) / f64::from(n), golden]), area);
    }
}

#[test]
fn areas_and_normals_close_and_enclose_the_volume() {
    for_all(|name, _, _, sweep| {
        let center = bounds(sweep).center();
        let (mut area, mut vector_area, mut volume) = (0.0, DVec3::ZERO, 0.0);
        for shape in surfaces(sweep) {
            area += shape.area();
            scan(shape, 4000, |p, element| {
                vector_area += element * shape.normal(p);
                volume += element * shape.normal(p).dot(p - center) / 3.0;
            });
        }
        assert!(vector_area.length() < 1e-3 * area, "{name}: {vector_area} of {area}");
        assert!((volume / sweep.volume - 1.0).abs() < 3e-3, "{name}: {volume} {}", sweep.volume);
    });
}

#[test]
fn samples_lie_on_their_surface_and_in_its_box() {
    for_all(|name, _, _, sweep| {
        let size = bounds(sweep).diagonal();
        for shape in surfaces(sweep) {
            let bounds = shape.bounds().grown(1e-12 * size);
            scan(shape, 100, |p, _| {
                let ray = Ray::new(p - shape.normal(p), shape.normal(p));
                let mut hit = false;
                shape.crossings(&ray, RayStart::Elsewhere, |crossing| {
                    hit |= (crossing.t - 1.0).abs() < 1e-9 && crossing.toward == Toward::Front;
                });
                assert!(hit && bounds.contains(p), "{name}: {p} {shape:?}");
            });
        }
    });
}

#[test]
fn cells_of_the_chart_have_the_area_of_the_points_that_fall_into_them() {
    for_all(|name, _, _, sweep| {
        let bounds = ChartRect { min: DVec2::ZERO, max: DVec2::new(sweep.perimeter, sweep.length) };
        let n = 5;
        let step = bounds.max / f64::from(n);
        for part in sweep.parts.iter().filter(|part| part.wall != Wall::Mitre) {
            let (mut counts, samples) = (vec![0.0; 25], 4000);
            scan(&part.shape, samples, |p, element| {
                let at = (part.chart.of(part.shape.chart(p)) / step)
                    .floor()
                    .clamp(DVec2::ZERO, DVec2::splat(4.0));
                counts[(at.y as usize) * 5 + at.x as usize] += element;
            });
            let (area, mut sum) = (part.shape.area(), 0.0);
            for (i, counted) in (0i32..).zip(&counts) {
                // The walls outside of a corner may run beyond the ends of the path.
                let beyond = |k: i32| {
                    if k == 0 {
                        -1e3
                    } else if k == n {
                        1e3
                    } else {
                        f64::from(k)
                    }
                };
                let (k, j) = (i % n, i / n);
                let cell = |u: i32, v: i32| step * DVec2::new(f64::from(u), beyond(v));
                let exact = part
                    .chart
                    .area_in(&part.shape, ChartRect { min: cell(k, j), max: cell(k + 1, j + 1) });
                assert!(
                    (exact - counted).abs() < 0.01 * area,
                    "{name} {i}: {exact} {counted} of {area}"
                );
                sum += exact;
            }
            assert!((sum / area - 1.0).abs() < 1e-9, "{name}: {sum} {area} {part:?}");
        }
    });
}

#[test]
fn neighbours_agree_on_the_chart_where_they_meet() {
    for_all(|name, profile, legs, sweep| {
        if legs.iter().any(|leg| matches!(leg, Leg::Corner { .. })) {
            return;
        }
        let path = path::trace(start(), profile, legs).unwrap();
        let walls = sweep.parts.len() / path.pieces.len();
        for (k, piece) in path.pieces.iter().enumerate().skip(1) {
            let at = |q: DVec2| {
                let q = piece.start.scale * q;
                piece.start.frame.point_to_world(q.extend(0.0))
            };
            for wall in 0..walls {
                for step in 1..8 {
                    let share = f64::from(step) / 8.0;
                    let (p, u) = match profile {
                        Profile::Circle { radius } => {
                            (*radius * DVec2::from_angle(TAU * share), share * sweep.perimeter)
                        }
                        Profile::Polygon { points } => {
                            let to = points[(wall + 1) % points.len()];
                            let before: f64 = points[..=wall]
                                .windows(2)
                                .map(|pair| pair[0].distance(pair[1]))
                                .sum();
                            let length = points[wall].distance(to);
                            (points[wall].lerp(to, share), before + share * length)
                        }
                    };
                    let expected = DVec2::new(u, piece.start.along);
                    for part in
                        [&sweep.parts[(k - 1) * walls + wall], &sweep.parts[k * walls + wall]]
                    {
                        let found = part.chart.of(part.shape.chart(at(p)));
                        assert!((found - expected).length() < 1e-11, "{name}: {found} {expected}");
                    }
                }
            }
        }
    });
}

#[test]
fn a_mirrored_path_stays_inside_for_2000_bounces() {
    for_all(|name, _, _, sweep| {
        let (surfaces, bounds) = (surfaces(sweep), bounds(sweep));
        let tolerance = 1e-12 * bounds.diagonal();
        let port = &sweep.ports[0];
        for index in 0..3 {
            let mut sampler = Sampler::for_path(SEED, 2, index);
            let from = port.shape.sample(sampler.pair(Dimension::EmitPosition));
            let dir = direction_of(&mut sampler);
            let mut ray = Ray::new(from, if dir.dot(port.frame.z) > 0.0 { -dir } else { dir });
            let mut on = surfaces.len() - 2;
            for bounce in 0..2000 {
                let mut nearest = (f64::INFINITY, usize::MAX);
                for (i, shape) in surfaces.iter().enumerate() {
                    let state = if i == on { RayStart::On } else { RayStart::Elsewhere };
                    shape.crossings(&ray, state, |crossing| {
                        if crossing.toward == Toward::Front
                            && crossing.t >= -tolerance
                            && crossing.t < nearest.0
                        {
                            nearest = (crossing.t, i);
                        }
                    });
                }
                assert!(nearest.1 != usize::MAX, "{name}: leak at bounce {bounce}, {ray:?}");
                on = nearest.1;
                let p = ray.at(nearest.0);
                assert!(bounds.grown(1e-9).contains(p), "{name}");
                let normal = surfaces[on].normal(p);
                ray = Ray::new(p, ray.dir() - 2.0 * ray.dir().dot(normal) * normal);
            }
        }
    });
}

#[test]
fn a_round_light_pipe_is_one_smooth_surface_of_known_size() {
    let legs = [straight(10.0), bend(FRAC_PI_2, 8.0, 0.0), straight(10.0)];
    let profile = Profile::circle(1.5).unwrap();
    let pipe = sweep(Frame::WORLD, &profile, &legs).unwrap();
    let length = 20.0 + 4.0 * PI;
    assert_eq!(pipe.parts.len(), 3);
    assert!(pipe.parts.iter().all(|part| part.smooth == 0 && part.wall == Wall::Round));
    assert!((pipe.length - length).abs() < 1e-12);
    // The inner and the outer half of a bend compensate each other (Pappus).
    assert!((wall_area(&pipe) - TAU * 1.5 * length).abs() < 1e-11);
    assert!((pipe.volume - PI * 2.25 * length).abs() < 1e-11);
    let [entry, exit] = &pipe.ports;
    assert_eq!((entry.frame.origin, entry.frame.z), (DVec3::ZERO, -DVec3::Z));
    assert!((exit.frame.origin - DVec3::new(18.0, 0.0, 18.0)).length() < 1e-14);
    assert_eq!((exit.frame.z, exit.frame.x), (DVec3::X, -DVec3::Z));
}

#[test]
fn smooth_numbers_break_at_edges_only() {
    let square = Profile::rectangle(2.0, 2.0).unwrap();
    let numbers = |legs: &[Leg], wall: usize| -> Vec<u32> {
        let sweep = sweep(Frame::WORLD, &square, legs).unwrap();
        let of_wall = sweep.parts.iter().filter(|part| part.wall == Wall::Edge(wall));
        of_wall.map(|part| part.smooth).collect()
    };
    let bent = [straight(1.0), bend(1.0, 4.0, 0.0), straight(1.0)];
    assert!((0..4).all(|wall| numbers(&bent, wall) == [wall as u32; 3]));
    // The walls at ±y lie in the plane of the corner.
    let cornered = [straight(1.0), corner(1.0, 0.0), straight(1.0)];
    let equal = |wall| numbers(&cornered, wall).windows(2).all(|pair| pair[0] == pair[1]);
    assert_eq!([0, 1, 2, 3].map(equal), [false, true, false, true]);
    let tapered = [straight(1.0), taper(1.0, 0.5)];
    assert!((0..4).all(|wall| numbers(&tapered, wall)[0] != numbers(&tapered, wall)[1]));
}

#[test]
fn a_right_angled_corner_is_a_square_between_its_legs() {
    let legs = [straight(1.0), corner(FRAC_PI_2, 0.0), straight(1.0)];
    let duct = sweep(Frame::WORLD, &Profile::rectangle(1.0, 1.0).unwrap(), &legs).unwrap();
    assert!((duct.volume - 3.0).abs() < 1e-14);
    // Walls of an L of three unit squares, one high: outline 8 less the two ports, and twice 3.
    assert!((wall_area(&duct) - 12.0).abs() < 1e-14);
    assert!((duct.ports[1].frame.origin - DVec3::new(1.5, 0.0, 1.5)).length() < 1e-15);
    let legs = [straight(1.0), mitre(FRAC_PI_2, 0.0), straight(1.0)];
    let mitred = sweep(Frame::WORLD, &Profile::rectangle(1.0, 1.0).unwrap(), &legs).unwrap();
    assert!((mitred.volume - 2.5).abs() < 1e-14);
    let plates: Vec<_> = mitred.parts.iter().filter(|part| part.wall == Wall::Mitre).collect();
    assert_eq!(plates.len(), 1);
    assert!((plates[0].shape.area() - 2.0f64.sqrt()).abs() < 1e-14);
}

#[test]
fn random_paths_are_refused_or_closed() {
    let (mut built, mut refused) = (0, 0);
    for (name, profile) in profiles() {
        for index in 0..300 {
            let mut sampler = Sampler::for_path(SEED, 3, index);
            let count = 1 + index % 5;
            let legs: Vec<Leg> = (0..count).map(|_| random_leg(&mut sampler)).collect();
            let Ok(sweep) = sweep(start(), &profile, &legs) else {
                refused += 1;
                continue;
            };
            built += 1;
            let (surfaces, bounds) = (surfaces(&sweep), bounds(&sweep));
            for ray in 0..200 {
                let ray = ray_through(&bounds, &mut Sampler::for_path(SEED, 4 + index, ray));
                let found = crossings(&surfaces, &ray);
                let turns = [Toward::Back, Toward::Front].into_iter().cycle().zip(&found);
                let by_turns =
                    turns.into_iter().all(|(toward, crossing)| toward == crossing.toward);
                assert!(
                    found.len().is_multiple_of(2) && by_turns,
                    "{name} {index}: {legs:?} {ray:?} {found:?}"
                );
            }
        }
    }
    assert!(built > 300 && refused > 300, "{built} {refused}");
}

fn wall_area(sweep: &Sweep) -> f64 {
    sweep.parts.iter().map(|part| part.shape.area()).sum()
}
