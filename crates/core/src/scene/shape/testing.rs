//! Required properties of every shape, for the tests of the shapes.

use crate::rng::{Dimension, Sampler};
use crate::scene::Ray;
use crate::scene::shape::{ChartRect, Crossing, CrossingQuery, HalfSpace, RayStart, Shape, Toward};
use glam::{DVec2, DVec3};
use lumiduct_base::math::{Aabb, Frame, uniform_sphere};

/// Seed of all tests of shapes.
const SEED: u64 = 20_260;

/// Independent description of a shape for a test.
pub(super) struct Truth<'a> {
    pub(super) shape: &'a Shape,
    /// Positive on the front side, negative on the back, at least near the surface.
    pub(super) implicit: &'a dyn Fn(DVec3) -> f64,
    /// Distance by which a point lies inside the trims, mm (any smooth measure); negative outside.
    pub(super) inside_trim: &'a dyn Fn(DVec3) -> f64,
}

/// A general frame, away from the origin.
pub(super) fn tilted(scale: f64) -> Frame {
    Frame::from_axis(scale * DVec3::new(3.0, -2.0, 5.0), DVec3::new(0.3, 0.9, -0.4))
}

/// All crossings, sorted.
pub(super) fn crossings_of(shape: &Shape, ray: &Ray, start: RayStart) -> Vec<Crossing> {
    let mut all = Vec::new();
    shape.crossings(ray, start, |crossing| all.push(crossing));
    all.sort_by(|a, b| a.t.total_cmp(&b.t));
    all
}

/// A ray from one to another point of a box.
fn ray_in(bounds: &Aabb, sampler: &mut Sampler) -> Ray {
    let mut point = || {
        let u = DVec3::from_array([(); 3].map(|()| sampler.one(Dimension::EmitPosition)));
        bounds.min + u * (bounds.max - bounds.min)
    };
    let (from, to) = (point(), point());
    Ray::new(from, to - from)
}

/// The first crossing that is wanted, within any span and in any direction, is the first such of all crossings; half of the rays
/// start on the surface, and some of them graze it.
pub(super) fn assert_first_crossings_are_those_of_all(shape: &Shape, rays: u64) {
    let bounds = shape.bounds();
    let size = bounds.diagonal();
    for path in 0..rays {
        let mut sampler = Sampler::for_path(SEED, 0, path);
        let ray = ray_in(&bounds, &mut sampler);
        let mut number = || sampler.one(Dimension::Lobe);
        let (ray, start) = if path % 2 == 0 {
            (ray, RayStart::Elsewhere)
        } else {
            let point = shape.sample([number(), number()]);
            let normal = shape.normal(point);
            let tilt = if path % 4 == 1 { 1.0 } else { 1e-6 * number() };
            let along = ray.dir() - ray.dir().dot(normal) * normal;
            (Ray::new(point, along + tilt * ray.dir().dot(normal) * normal), RayStart::On)
        };
        let [min, max] = [-0.3 * size * number(), size * number()];
        for toward in [None, Some(Toward::Front), Some(Toward::Back)] {
            let wanted = CrossingQuery { toward, min, max };
            let first = shape.first_crossing(&ray, start, &wanted).map(|found| found.t);
            let all = crossings_of(shape, &ray, start);
            let listed = all.iter().find(|crossing| wanted.includes(crossing)).map(|own| own.t);
            let apart = first.zip(listed).map_or(0.0, |(first, listed)| (first - listed).abs());
            let same = first.is_some() == listed.is_some() && apart < 1e-9 * size;
            assert!(same, "{path}: {first:?}, but {listed:?} in {all:?}");
        }
    }
}

/// Crossings along random lines are those where a dense scan of the implicit function changes its sign.
pub(super) fn assert_crossings_match_a_scan(truth: &Truth, rays: u64) {
    const STEPS: u32 = 4000;
    let bounds = truth.shape.bounds();
    let size = bounds.diagonal();
    let mut seen = 0;
    for index in 0..rays {
        let ray = ray_in(&bounds, &mut Sampler::for_path(SEED, 1, index));
        let found = crossings_of(truth.shape, &ray, RayStart::Elsewhere);
        let step = 2.0 * size / f64::from(STEPS);
        let at = |i: u32| -size + step * (f64::from(i) + 0.31);
        let value = |t: f64| (truth.implicit)(ray.at(t));
        let mut scanned = Vec::new();
        for i in 0..STEPS {
            if (value(at(i)) < 0.0) == (value(at(i + 1)) < 0.0) {
                continue;
            }
            let toward = if value(at(i)) < 0.0 { Toward::Front } else { Toward::Back };
            let (mut lo, mut hi) = (at(i), at(i + 1));
            for _ in 0..60 {
                let middle = 0.5 * (lo + hi);
                if (value(middle) < 0.0) == (toward == Toward::Front) {
                    lo = middle;
                } else {
                    hi = middle;
                }
            }
            let inside = (truth.inside_trim)(ray.at(lo));
            if inside.abs() < 1e-9 * size {
                continue;
            }
            if inside > 0.0 {
                scanned.push(Crossing { t: lo, toward });
            }
        }
        for crossing in &scanned {
            let near = |c: &&Crossing| (c.t - crossing.t).abs() < 1e-7 * size;
            let same = found
                .iter()
                .find(near)
                .unwrap_or_else(|| panic!("{ray:?}: missed {crossing:?} in {found:?}"));
            assert_eq!(same.toward, crossing.toward, "{ray:?}: {scanned:?} {found:?}");
        }
        // A pair closer than a step escapes the scan.
        let hidden = found.windows(2).filter(|pair| pair[1].t - pair[0].t < step).count();
        assert!(found.len() <= scanned.len() + 2 * hidden, "{ray:?}: {scanned:?} {found:?}");
        seen += scanned.len();
    }
    assert!(seen > 20, "only {seen} crossings in {rays} rays: the test tests nothing");
}

/// From a point of the surface, [`Start::On`] gives the crossings of [`Start::Elsewhere`] without
/// the start.
pub(super) fn assert_starting_on_it_drops_only_the_start(shape: &Shape, rays: u64) {
    let size = shape.bounds().diagonal();
    for index in 0..rays {
        let mut sampler = Sampler::for_path(SEED, 2, index);
        let from = shape.sample(sampler.pair(Dimension::EmitPosition));
        let ray = Ray::new(from, uniform_sphere(sampler.pair(Dimension::EmitDirection)));
        // A chord along a grazing ray is as short as the angle is small.
        let grazing = ray.dir().dot(shape.normal(from)).abs();
        if grazing < 1e-3 {
            continue;
        }
        let on = crossings_of(shape, &ray, RayStart::On);
        let mut elsewhere = crossings_of(shape, &ray, RayStart::Elsewhere);
        let start = (0..elsewhere.len())
            .min_by(|&i, &k| elsewhere[i].t.abs().total_cmp(&elsewhere[k].t.abs()));
        // Exactly on the rim of the trim, the start itself may be missing.
        if let Some(start) = start.filter(|&i| elsewhere[i].t.abs() < 1e-11 * size / grazing) {
            assert_eq!(
                elsewhere[start].toward,
                Toward::of(ray.dir(), shape.normal(from)),
                "{ray:?}"
            );
            elsewhere.remove(start);
        }
        assert_eq!(on.len(), elsewhere.len(), "{ray:?}: {on:?} {elsewhere:?}");
        for (a, b) in on.iter().zip(&elsewhere) {
            assert!((a.t - b.t).abs() < 1e-8 * size, "{ray:?}: {on:?} {elsewhere:?}");
            assert_eq!(a.toward, b.toward);
            assert!(a.t.abs() > 1e-6 * size * grazing, "{ray:?}: {on:?}");
        }
    }
}

/// Follows a mirrored path on the side of the surface away from `leaving`, closed by mirror planes `lids` where the
/// surface is trimmed, and calls `visit` at every hit of the surface.
pub(super) fn bounce(
    shape: &Shape,
    leaving: Toward,
    lids: &[HalfSpace],
    path: u64,
    mut visit: impl FnMut(&Ray),
) {
    const BOUNCES: usize = 1000;
    let mut sampler = Sampler::for_path(SEED, 3, path);
    let p = shape.sample(sampler.pair(Dimension::EmitPosition));
    let mut dir = uniform_sphere(sampler.pair(Dimension::EmitDirection));
    if Toward::of(dir, shape.normal(p)) == leaving {
        dir = -dir;
    }
    let mut ray = Ray::new(p, dir);
    let mut start = RayStart::On;
    let mut hits = 0;
    while hits < BOUNCES {
        let next =
            crossings_of(shape, &ray, start).into_iter().find(|c| c.t > 0.0 && c.toward == leaving);
        let (p, normal);
        if let Some(crossing) = next {
            p = ray.at(crossing.t);
            normal = shape.normal(p);
            start = RayStart::On;
            hits += 1;
        } else {
            let distance = |lid: &HalfSpace| {
                (lid.offset - ray.origin().dot(lid.normal)) / ray.dir().dot(lid.normal)
            };
            let ahead = lids.iter().filter(|lid| ray.dir().dot(lid.normal) > 0.0);
            let lid =
                ahead.min_by(|a, b| distance(a).total_cmp(&distance(b))).expect("a closed room");
            p = ray.at(distance(lid));
            normal = lid.normal;
            start = RayStart::Elsewhere;
        }
        ray = Ray::new(p, ray.dir() - 2.0 * ray.dir().dot(normal) * normal);
        if start == RayStart::On {
            visit(&ray);
        }
    }
}

/// Rays into a closed shape at 1 to 1e-14 rad from the wall meet it again.
pub(super) fn assert_grazing_rays_come_back(shape: &Shape) {
    const RAYS: u64 = 50_000;
    let mut inward = 0;
    for index in 0..RAYS {
        let mut sampler = Sampler::for_path(SEED, 7, index);
        let p = shape.sample(sampler.pair(Dimension::EmitPosition));
        let normal = shape.normal(p);
        let along = uniform_sphere(sampler.pair(Dimension::EmitDirection)).cross(normal);
        let angle = 10f64.powf(-14.0 * sampler.one(Dimension::Scatter));
        let ray = Ray::new(p, along.normalize() - angle * normal);
        // At the smallest angles rounding turns some rays outward.
        if Toward::of(ray.dir(), normal) == Toward::Front || ray.dir().dot(normal) == 0.0 {
            continue;
        }
        inward += 1;
        let comes_back = |c: &Crossing| c.t > 0.0 && c.toward == Toward::Front;
        assert!(crossings_of(shape, &ray, RayStart::On).iter().any(comes_back), "{angle}: {ray:?}");
    }
    assert!(inward > RAYS * 9 / 10);
}

/// Samples lie on the surface, inside its bounds and its chart, and fall into cells of the chart by their areas.
pub(super) fn assert_samples_are_uniform(truth: &Truth, tolerance: f64) {
    const CELLS: usize = 9;
    const SAMPLES: u64 = 40_000;
    let shape = truth.shape;
    let (chart, bounds) = (shape.chart_bounds(), shape.bounds());
    let bounds = bounds.grown(1e-12 * bounds.diagonal());
    let cell_size = (chart.max - chart.min) / CELLS as f64;
    let mut counts = vec![0u32; CELLS * CELLS];
    for index in 0..SAMPLES {
        let p = shape.sample(Sampler::for_path(SEED, 4, index).pair(Dimension::EmitPosition));
        assert!((truth.implicit)(p).abs() < tolerance, "{p}: {}", (truth.implicit)(p));
        assert!(bounds.contains(p), "{p}");
        let cell = ((shape.chart(p) - chart.min) / cell_size).floor();
        assert!(cell.min_element() >= 0.0 && cell.max_element() < CELLS as f64, "{p}: cell {cell}");
        counts[cell.x as usize * CELLS + cell.y as usize] += 1;
    }
    let (mut chi2, mut total) = (0.0, 0.0);
    for (i, &count) in counts.iter().enumerate() {
        let min = chart.min + cell_size * DVec2::new((i / CELLS) as f64, (i % CELLS) as f64);
        let area = shape.area_in(ChartRect { min, max: min + cell_size });
        let expected = area / shape.area() * SAMPLES as f64;
        chi2 += (f64::from(count) - expected).powi(2) / expected;
        total += area;
    }
    assert!((total / shape.area() - 1.0).abs() < 1e-10, "cells {total}, whole {}", shape.area());
    // Mean and standard deviation of chi-square with n degrees of freedom: n, sqrt(2n).
    let degrees = (CELLS * CELLS - 1) as f64;
    assert!((chi2 - degrees).abs() < 4.0 * (2.0 * degrees).sqrt(), "chi-square {chi2}");
}

/// The box touches the surface on all six sides, up to what a dense sampling finds.
pub(super) fn assert_bounds_are_tight(shape: &Shape, slack: f64) {
    let n = 400;
    let edge = |i: u32| f64::from(i) / f64::from(n) * (1.0 - 1e-15);
    let points = (0..=n).flat_map(|i| (0..=n).map(move |k| shape.sample([edge(i), edge(k)])));
    let (sampled, bounds) = (Aabb::of(points), shape.bounds());
    let size = bounds.diagonal();
    assert!(
        (sampled.min - bounds.min).abs().max_element() < slack * size,
        "{sampled:?} {bounds:?}"
    );
    assert!(
        (sampled.max - bounds.max).abs().max_element() < slack * size,
        "{sampled:?} {bounds:?}"
    );
}

/// Rays aimed at points of the surface from far away hit them to the rounding of their origin; `steepness` is the
/// largest gradient of the implicit function on the surface.
pub(super) fn assert_hit_from_far_away(truth: &Truth, steepness: f64) {
    const RAYS: u64 = 300;
    let shape = truth.shape;
    for distance in [1e2, 1e4, 1e6] {
        let rounding = 8.0 * f64::EPSILON * (distance + 100.0);
        let mut found = 0;
        for index in 0..RAYS {
            let mut sampler = Sampler::for_path(SEED, 6, index);
            let target = shape.sample(sampler.pair(Dimension::EmitPosition));
            let dir = uniform_sphere(sampler.pair(Dimension::EmitDirection));
            let ray = Ray::new(target - distance * dir, dir);
            let crossings = crossings_of(shape, &ray, RayStart::Elsewhere);
            for crossing in &crossings {
                let off = (truth.implicit)(ray.at(crossing.t)).abs();
                assert!(off < steepness * rounding, "from {distance}: {off}");
            }
            let cos = dir.dot(shape.normal(target)).abs();
            if crossings.iter().any(|c| (c.t - distance).abs() * cos < 2.0 * rounding) {
                found += 1;
            }
        }
        // Few are so close to a rim or so grazing that they may miss.
        assert!(found >= RAYS - 2, "from {distance}: {found}");
    }
}

/// The same shape a thousand times larger or smaller is crossed at distances a thousand times larger or smaller.
pub(super) fn assert_scales(make: impl Fn(f64) -> Shape) {
    let one = make(1.0);
    let bounds = one.bounds();
    for scale in [1000.0, 0.001] {
        let other = make(scale);
        assert!((other.area() / (one.area() * scale * scale) - 1.0).abs() < 1e-12);
        for index in 0..500 {
            let ray = ray_in(&bounds, &mut Sampler::for_path(SEED, 5, index));
            let a = crossings_of(&one, &ray, RayStart::Elsewhere);
            let b = crossings_of(
                &other,
                &Ray::new(scale * ray.origin(), ray.dir()),
                RayStart::Elsewhere,
            );
            assert_eq!(a.len(), b.len(), "{ray:?}");
            for (a, b) in a.iter().zip(&b) {
                assert_eq!(a.toward, b.toward);
                let close =
                    (a.t - b.t / scale).abs() * ray.dir().dot(one.normal(ray.at(a.t))).abs();
                assert!(close < 1e-13 * bounds.diagonal(), "{ray:?}: {a:?} {b:?}");
            }
        }
    }
}
