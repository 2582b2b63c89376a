use crate::measure::noise::Noise;
use crate::measure::samples::{goniometer, readings, scene};
use crate::measure::{Status, measure};
use crate::scene::{Scene, SensorKind};
use crate::transport::Findings;
use glam::DVec3;
use std::f64::consts::PI;

/// Readings without noise of an intensity I(C, γ) [cd], exact over each cell for intensities ∝ cos^m γ.
fn cosine_power(scene: &Scene, m: f64) -> Findings {
    let SensorKind::Goniometer(sphere) = &scene.sensors[0].kind else { panic!("no sphere") };
    let edge = |ring: usize| {
        let cos = (std::f64::consts::PI * ring as f64 / sphere.gamma_cells as f64).cos();
        cos.max(0.0).powf(m + 1.0)
    };
    readings(scene, 2, |_, _, batch| {
        for cell in 0..sphere.cells() {
            let ring = cell / sphere.c_cells;
            let flux = (edge(ring) - edge(ring + 1)) / sphere.c_cells as f64;
            batch.sensors[0].cells.add(cell, flux);
        }
    })
}

#[test]
fn a_cosine_power_source_has_its_axis_intensity_and_half_angle() {
    let scene = scene(&[("led", 1.0)], vec![("far", goniometer(8, 720))]);
    let measures = measure(&scene, &cosine_power(&scene, 5.0));
    let value = |name: &str| measures.values[name].value;
    // I₀ = (m + 1)/2π per lumen.
    let axis = 6.0 / std::f64::consts::TAU;
    assert!((value("far.intensity_axis") / axis - 1.0).abs() < 5e-5);
    assert!((value("far.intensity_max") / axis - 1.0).abs() < 5e-5);
    // acos(0.5^(1/5)) = 29.477 deg.
    for name in ["far.beam_angle", "far.beam_angle.c0", "far.beam_angle.c90"] {
        assert!((value(name) - 2.0 * 29.477).abs() < 3e-3, "{name}: {}", value(name));
    }
    let tenth = 2.0 * 0.1f64.powf(0.2).acos().to_degrees();
    assert!((value("far.field_angle") - tenth).abs() < 3e-3);
}

#[test]
fn a_peak_of_few_counts_is_right_within_its_error_or_a_bound() {
    let scene = scene(&[("led", 1.0)], vec![("far", goniometer(24, 90))]);
    let exactly = cosine_power(&scene, 20.0);
    let peak = measure(&scene, &exactly).values["far.intensity_max"].value;
    let SensorKind::Goniometer(sphere) = &scene.sensors[0].kind else { panic!("no sphere") };
    let edge = |ring: usize| (PI * ring as f64 / 90.0).cos().max(0.0).powi(21) / 24.0;
    let share = |cell: usize| edge(cell / 24) - edge(cell / 24 + 1);
    for (stream, counts, most) in [(1, 1e4, 1.6), (5, 1e4, 1.6), (3, 1e5, 1.4), (4, 1e6, 1.1)] {
        let mut noise = Noise::of_stream(stream);
        let counted = readings(&scene, 128, |_, _, batch| {
            for cell in 0..sphere.cells() {
                let found = noise.poisson(share(cell) * counts / 128.0);
                batch.sensors[0].cells.add(cell, found * 128.0 / counts);
            }
        });
        let found = &measure(&scene, &counted).values["far.intensity_max"];
        assert!(found.value < most * peak, "{counts} counts: {found}, {peak} expected");
        let is_off = (found.value - peak).abs() > 3.0 * found.total_error();
        assert!(!is_off, "{counts} counts: {found}, {peak} expected");
        assert_eq!(found.status == Status::Ok, counts > 1e4, "{counts} counts: {found}");
    }
}

#[test]
fn zones_and_rings_add_up_to_all_of_the_flux() {
    let scene = scene(&[("led", 1.0)], vec![("far", goniometer(24, 90))]);
    let measures = measure(&scene, &cosine_power(&scene, 1.0));
    let zones = (0..18).map(|zone| format!("far.zonal_flux.{}-{}", 10 * zone, 10 * zone + 10));
    let total: f64 = zones.map(|name| measures.values[&name].value).sum();
    assert!((total - 1.0).abs() < 1e-12);
    // Lambertian: sin² 20° - sin² 10°.
    let second = 20f64.to_radians().sin().powi(2) - 10f64.to_radians().sin().powi(2);
    assert!((measures.values["far.zonal_flux.10-20"].value - second).abs() < 1e-12);
    let table = &measures.intensities[0];
    assert_eq!(table.values.dim(), (90, 24));
    assert_eq!(table.ring_values[40], measures.values["far.ring.40"].value);
    assert!((table.values[[40, 3]] - table.ring_values[40]).abs() < 1e-12);
    assert_eq!((table.gamma_deg[1], table.c_deg[1]), (2.0, 15.0));
}

#[test]
fn zones_that_do_not_fit_the_rings_are_left_out() {
    let scene = scene(&[("led", 1.0)], vec![("far", goniometer(3, 12))]);
    let measures = measure(&scene, &cosine_power(&scene, 1.0));
    assert!(measures.values.keys().all(|name| !name.contains("zonal_flux")));
    // Three sectors are too few to separate planes.
    assert!(measures.values.keys().all(|name| !name.ends_with(".c0")));
}

#[test]
fn c_is_counted_as_in_luminaire_files() {
    // Counter-clockwise for an eye that looks along the pole, +z: from +x over -y.
    let SensorKind::Goniometer(sphere) = goniometer(8, 2) else { panic!("no sphere") };
    for (x, y, sector) in [(1.0, -0.1, 0), (0.1, -1.0, 1), (-0.1, -1.0, 2), (0.1, 1.0, 6)] {
        assert_eq!(sphere.cell(DVec3::new(x, y, 0.1)), sector, "{x} {y}");
    }
}
