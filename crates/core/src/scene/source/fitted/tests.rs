use super::*;
use crate::rng::{Dimension, Sampler};
use crate::scene::{EmittedRay, RaySet};
use crate::tally::Tally;
use glam::{DVec2, DVec3, Vec3};
use lumiduct_base::math::{cosine_hemisphere, disk};
use std::f64::consts::PI;

/// Rays of flux 1 from a law for one: start, mm, and unit direction.
fn rays(count: u64, law: impl Fn(&mut Sampler) -> [DVec3; 2]) -> RaySet {
    let rays = (0..count).map(|index| {
        let [start, dir] = law(&mut Sampler::for_path(11, 0, index));
        ray(start.as_vec3(), dir.as_vec3(), 1.0)
    });
    RaySet::new(rays).unwrap()
}

fn ray(position: Vec3, direction: Vec3, flux: f32) -> EmittedRay {
    EmittedRay { position, direction, flux }
}

/// A Lambertian disk of radius 1 mm at z = 0.5 mm, its rays given at other heights.
fn lambertian(sampler: &mut Sampler) -> [DVec3; 2] {
    let place = disk(sampler.pair(Dimension::EmitPosition)) + 0.5 * DVec3::Z;
    let dir = cosine_hemisphere(sampler.pair(Dimension::EmitDirection));
    [place + sampler.one(Dimension::Design) * dir, dir]
}

/// Places on the rectangle of a fit and directions toward both sides, spread evenly over the etendue.
fn everywhere(light: &FittedLight, index: u64) -> [DVec3; 2] {
    let mut sampler = Sampler::for_path(12, 0, index);
    let u = DVec2::from_array(sampler.pair(Dimension::EmitPosition));
    let dir = cosine_hemisphere(sampler.pair(Dimension::EmitDirection));
    let sign = if index.is_multiple_of(2) { 1.0 } else { -1.0 };
    let place = light.middle() + (light.half() * (2.0 * u - DVec2::ONE)).extend(0.0);
    [place, DVec3::new(dir.x, dir.y, sign * dir.z)]
}

#[test]
fn a_lambertian_disk_has_its_luminance_inside_and_none_beside_it() {
    let light = FittedLight::new(&rays(40_000, lambertian), None).unwrap();
    assert!((light.middle().z - 0.5).abs() < 0.02, "{}", light.middle());
    let [mut inside, mut squares, mut beside] = [Tally::default(); 3];
    for index in (0..40_000).step_by(2) {
        let [place, dir] = everywhere(&light, index);
        let radius = place.truncate().length();
        // Flux over etendue.
        let relative = light.luminance(place, dir) * PI * PI;
        if radius < 0.9 {
            inside.add(relative);
            squares.add((relative - 1.0).powi(2));
        } else if radius > 1.1 {
            beside.add(relative);
        }
        assert_eq!(light.luminance(place, DVec3::new(dir.x, dir.y, -dir.z)), 0.0);
    }
    assert!((inside.mean() - 1.0).abs() < 0.02, "{inside:?}");
    assert!(squares.mean().sqrt() < 0.1, "{squares:?}");
    assert!(beside.mean() < 0.02, "{beside:?}");
}

#[test]
fn starts_are_drawn_by_the_luminance_to_both_sides() {
    // Three quarters forward, narrower on the left; one quarter back.
    let light = FittedLight::new(
        &rays(20_000, |sampler| {
            let u = sampler.pair(Dimension::EmitPosition);
            let [square, turns] = sampler.pair(Dimension::EmitDirection);
            let start = DVec3::new(3.0 * u[0], u[1] * u[1], 0.0);
            let dir = cosine_hemisphere([square * (0.2 + 0.8 * u[0]), turns]);
            let is_back = sampler.one(Dimension::Design) < 0.25;
            [start, if is_back { DVec3::new(dir.x, dir.y, -dir.z) } else { dir }]
        }),
        Some(0.0),
    )
    .unwrap();
    assert!((light.sides[1].share - 0.25).abs() < 0.015, "{}", light.sides[1].share);
    let regions: [fn(DVec3, DVec3) -> bool; 4] = [
        |_, dir| dir.z < 0.0,
        |place, dir| place.x < 1.0 && dir.x > 0.5,
        |place, dir| place.y < 0.1 && dir.z > 0.9,
        |place, dir| place.x + place.y > 2.0 && dir.y < dir.x,
    ];
    let etendue = 2.0 * PI * 4.0 * light.half().x * light.half().y;
    for (number, is_in) in regions.into_iter().enumerate() {
        let count = 200_000;
        let drawn = Tally::of((0..count).map(|index| {
            let [place, dir] = light.sample(&mut Sampler::for_path(5, 0, index));
            f64::from(u8::from(is_in(place, dir)))
        }));
        let integral = Tally::of((0..count).map(|index| {
            let [place, dir] = everywhere(&light, index);
            if is_in(place, dir) { etendue * light.luminance(place, dir) } else { 0.0 }
        }));
        let error = drawn.std_error().hypot(integral.std_error());
        assert!(
            (drawn.mean() - integral.mean()).abs() < 4.0 * error,
            "{number}: {drawn:?} {integral:?}"
        );
    }
}

#[test]
fn light_whose_direction_follows_its_place_is_found_though_each_alone_is_even() {
    let converging = |sampler: &mut Sampler| {
        let [x, y] = sampler.pair(Dimension::EmitPosition).map(|u| 2.0 * u - 1.0);
        let across = DVec2::new(-0.5 * x, 0.2 * (2.0 * sampler.one(Dimension::Design) - 1.0));
        let dir = across.extend((1.0 - across.length_squared()).sqrt());
        [DVec3::new(x, y, 0.0), dir]
    };
    let light = FittedLight::new(&rays(60_000, converging), Some(0.0)).unwrap();
    let toward = |x: f64| {
        light.luminance(DVec3::new(0.6, 0.1, 0.0), DVec3::new(x, 0.0, (1.0 - x * x).sqrt()))
    };
    assert!(toward(-0.3) > 20.0 * toward(-0.1), "{} {}", toward(-0.3), toward(-0.1));
    assert!(toward(-0.3) > 20.0 * toward(0.3), "{} {}", toward(-0.3), toward(0.3));
}

/// Root mean square of the relative error of the fit to a lamp with I ∝ cos³θ whose luminance falls linearly along x, and what the
/// fit says about one box.
fn error_of_fit(count: u64) -> (f64, f64) {
    let lamp = rays(count, |sampler| {
        let [u, y] = sampler.pair(Dimension::EmitPosition);
        // Density 1 - x / 2 over -1 to 1.
        let x = 2.0 - (9.0 - 8.0 * u).sqrt();
        let [square, turns] = sampler.pair(Dimension::EmitDirection);
        // sin² with density ∝ cos² of the angle: cos⁴ is even.
        let dir = cosine_hemisphere([1.0 - (1.0 - square).sqrt(), turns]);
        [DVec3::new(x, 2.0 * y - 1.0, 0.0), dir]
    });
    let light = FittedLight::new(&lamp, Some(0.0)).unwrap();
    let squares = Tally::of((0..20_000).map(|index| {
        let [place, dir] = light.sample(&mut Sampler::for_path(6, 0, index));
        let truth = (0.25 - 0.125 * place.x) * 2.0 * dir.z * dir.z / PI;
        (truth / light.luminance(place, dir) - 1.0).powi(2)
    }));
    let FitQuality { sampling, variation: [place, direction], .. } = *light.quality();
    (squares.mean().sqrt(), (sampling.powi(2) + place.powi(2) + direction.powi(2)).sqrt())
}

#[test]
fn the_fit_gets_better_with_more_rays_and_is_better_than_it_says_of_a_box() {
    let [few, many] = [2_000, 128_000].map(error_of_fit);
    assert!(few.0 < few.1 && many.0 < many.1, "{few:?} {many:?}");
    assert!(many.0 < 0.5 * few.0 && many.1 < 0.5 * few.1, "{few:?} {many:?}");
}

#[test]
fn rays_that_cannot_be_fitted_are_refused_and_what_is_left_out_is_known() {
    let parallel = rays(100, |sampler| [disk(sampler.pair(Dimension::EmitPosition)), DVec3::Z]);
    assert_eq!(FittedLight::new(&parallel, None), Err(NoFit::Parallel));
    let from_a_point = rays(100, |sampler| {
        [DVec3::ZERO, cosine_hemisphere(sampler.pair(Dimension::EmitDirection))]
    });
    assert_eq!(FittedLight::new(&from_a_point, None), Err(NoFit::NoArea));
    assert_eq!(FittedLight::new(&rays(200, lambertian), Some(90.0)), Err(NoFit::NoneNear(90.0)));
    assert_eq!(FittedLight::new(&rays(99, lambertian), None), Err(NoFit::TooFew(99.0)));
    // One that crosses far away, and one that never does.
    let mut lamp: Vec<EmittedRay> = rays(998, lambertian).iter().copied().collect();
    lamp.push(ray(Vec3::new(0.0, 0.0, 1.0), Vec3::new(1.0, 0.0, 1e-3).normalize(), 1.0));
    lamp.push(ray(Vec3::new(0.0, 0.0, 1.0), Vec3::X, 1.0));
    let light = FittedLight::new(&RaySet::new(lamp).unwrap(), Some(0.5)).unwrap();
    assert!((light.quality().left_out - 0.002).abs() < 1e-12, "{:?}", light.quality());
}

#[test]
fn beams_narrower_than_single_precision_and_100_rays_are_fitted() {
    let beam = rays(5_000, |sampler| {
        let across = 1e-5 * disk(sampler.pair(Dimension::EmitDirection));
        [disk(sampler.pair(Dimension::EmitPosition)), (across + DVec3::Z).normalize()]
    });
    for (lamp, height) in [(beam, 0.0), (rays(100, lambertian), 0.5)] {
        let light = FittedLight::new(&lamp, Some(height)).unwrap();
        for index in 0..1000 {
            let [place, dir] = light.sample(&mut Sampler::for_path(1, 0, index));
            assert!(dir.is_normalized() && dir.z > 0.0 && place.is_finite());
            let luminance = light.luminance(place, dir);
            assert!(luminance.is_finite() && luminance > 0.0, "{place} {dir}");
        }
    }
}

#[test]
fn rays_of_unequal_flux_give_the_same_luminance() {
    // The same lamp, by bright rays on the left and by ten times as many dim ones on the right; then one with 5 % of all flux.
    let mut index = 0;
    let mut lamp = Vec::new();
    while lamp.len() < 40_000 {
        let mut sampler = Sampler::for_path(11, 0, index);
        index += 1;
        let [start, dir] = lambertian(&mut sampler);
        let flux = if (start - (start.z - 0.5) / dir.z * dir).x < 0.0 { 10.0 } else { 1.0 };
        if sampler.one(Dimension::Roulette) * flux < 1.0 {
            lamp.push(ray(start.as_vec3(), dir.as_vec3(), flux as f32));
        }
    }
    let light = |lamp: &[EmittedRay]| {
        FittedLight::new(&RaySet::new(lamp.iter().copied()).unwrap(), Some(0.5)).unwrap()
    };
    let means = |light: &FittedLight| {
        [-0.4, 0.4].map(|x| {
            Tally::of((0..4_000).map(|index| {
                let [_, dir] = everywhere(light, 2 * index);
                light.luminance(DVec3::new(x, 0.2, 0.5), dir) * PI * PI
            }))
            .mean()
        })
    };
    let [left, right] = means(&light(&lamp));
    assert!((left - 1.0).abs() < 0.05 && (right - 1.0).abs() < 0.05, "{left} {right}");
    let all: f32 = lamp.iter().map(|ray| ray.flux).sum();
    lamp.push(ray(Vec3::new(0.9, 0.0, 0.5), Vec3::Z, all / 19.0));
    let [left, right] = means(&light(&lamp));
    assert!((left - 0.95).abs() < 0.05 && (right - 0.95).abs() < 0.05, "{left} {right}");
}
