//! Tables by angles.

use crate::scatter::tests::{csv_of, good, refused, shares};
use crate::scatter::{ScatterFormat, is_scatter_table};
use glam::DVec2;
use lumiduct_base::math::{DirectionPatches, PatchPairs};
use std::fmt::Write;

#[test]
fn angles_of_a_csv_are_interpolated_and_turn_with_the_light() {
    let file = good(&csv_of(|_, s, phi| 0.1 + s * 1e-3 + phi * 1e-4), ScatterFormat::Csv);
    let matrix = file.front.reflection.clone().unwrap();
    assert_eq!(file.back.reflection, file.front.reflection);
    let words = file.remarks.join("; ");
    for part in ["theta_i of 0 to 80", "mirror image", "both sides"] {
        assert!(words.contains(part), "{words}");
    }
    let PatchPairs::Isotropic { incident, leaving } = &matrix.pairs else { panic!("no grain") };
    let patches = DirectionPatches::Rings(leaving.clone());
    let [_, count] = matrix.pairs.counts();
    for (polar, phi) in [(10.0f64, 3.0f64), (44.0, 90.0), (70.0, 177.0), (70.0, 230.0)] {
        let (sin, cos) = phi.to_radians().sin_cos();
        let patch = patches.patch(polar.to_radians().sin() * DVec2::new(cos, sin));
        let row = incident.ring(0.3);
        let found = matrix.values[row * count + patch];
        let mirrored = if phi > 180.0 { 360.0 - phi } else { phi };
        let expected = 0.1 + polar * 1e-3 + mirrored * 1e-4;
        assert!((found - expected).abs() < 2.5e-3, "{polar} {phi}: {found}, {expected}");
    }
}

#[test]
fn patches_keep_the_light_of_narrow_peaks() {
    // A cone about the direction at 45 deg, of 1.5 deg in polar angle and 0.3 deg in azimuth, linear between angles.
    let polars = [0.0, 44.25, 45.0, 45.75, 90.0];
    let azimuths = [0.0, 0.15, 90.0, 180.0];
    let mut text = "theta_i_deg,theta_s_deg,phi_s_deg,btdf_per_sr\n".to_owned();
    for incident in [0.0, 45.0, 90.0] {
        for polar in polars {
            for phi in azimuths {
                let peak = if polar == 45.0 && phi == 0.0 { 5e3 } else { 0.0 };
                _ = writeln!(text, "{incident},{polar},{phi},{peak}");
            }
        }
    }
    let file = good(&text, ScatterFormat::Csv);
    assert!(file.remarks.iter().any(|own| own.contains("averaged over patches of 2 deg")));
    // The hat over the azimuth has the area 0.15 deg; that over the polar angle by sin θ cos θ = 1/2 cos 2(θ - 45 deg).
    let half = 0.75f64.to_radians();
    let ring = (1.0 - (2.0 * half).cos()) / (4.0 * half);
    let expected = 5e3 * 0.15f64.to_radians() * ring;
    let shares = shares(&file.front.transmission.unwrap());
    assert!(shares.len() >= 45);
    for share in shares {
        assert!((share / expected - 1.0).abs() < 1e-9, "{share} {expected}");
    }
}

#[test]
fn large_tables_take_little_time_and_space() {
    // A megabyte of angles of one kind each.
    let head = "theta_i_deg,theta_s_deg,phi_s_deg,brdf_per_sr\n";
    let spread = |count: u32, row: fn(f64) -> String| -> String {
        let rows = (0..count).map(|n| row(89.0 * f64::from(n) / f64::from(count)));
        head.to_owned() + &rows.collect::<String>()
    };
    for (text, most) in [
        (spread(50_000, |at| format!("{at:.5},0,0,.1\n")), 1 << 20),
        (spread(50_000, |at| format!("0,{at:.5},0,.1\n")), 1 << 20),
        (spread(50_000, |at| format!("0,45,{:.5},.1\n", 4.0 * at)), 1 << 20),
        (spread(25_000, |at| format!("0,{at:.5},0,.1\n0,{at:.5},180,.1\n")), 1 << 20),
    ] {
        let file = good(&text, ScatterFormat::Csv);
        let matrix = file.front.reflection.unwrap();
        assert!(matrix.values.len() < most, "{}", matrix.values.len());
        assert!(matrix.values.iter().all(|value| (value - 0.1).abs() < 1e-9));
    }
    // Angles that make no grid: each row has others.
    let zenith: String =
        (0..2900).map(|n| format!("{0},0,0,.1\n0,0,{0},.1\n", 0.03 * f64::from(n + 1))).collect();
    refused(&(head.to_owned() + &zenith), ScatterFormat::Csv, &["each combination"]);
}

#[test]
fn a_csv_needs_every_combination_but_azimuths_of_the_zenith() {
    let all = csv_of(|_, _, _| 0.1);
    let without = |line: &str| all.replacen(&format!("{line}\n"), "", 1);
    good(&without("30,0,90,0.1"), ScatterFormat::Csv);
    refused(&without("30,15,90,0.1"), ScatterFormat::Csv, &["theta_i 30, theta_s 15 and phi_s 90"]);
    for (old, new, parts) in [
        ("30,15,90,0.1", "30,15,90,-0.1", &["line 19", "negative"][..]),
        ("30,15,90,0.1", "30,15,90,nan", &["line 19", "usable"]),
        ("30,15,90,0.1", "30,15,90,x", &["line 19", "`x` is not a number"]),
        ("30,15,90,0.1", "30,95,90,0.1", &["line 19", "theta_s_deg is `95`", "0 to 90"]),
        ("30,15,90,0.1", "30,15,0,0.1", &["line 19", "before"]),
        ("30,15,90,0.1", "30,15,90", &["line 19", "3 columns instead of 4"]),
        ("brdf_per_sr", "f", &["line 2", "no column `brdf_per_sr`"]),
        ("theta_s_deg", "theta", &["line 2", "no column `theta_s_deg`"]),
    ] {
        refused(&all.replacen(old, new, 1), ScatterFormat::Csv, parts);
    }
    refused("theta_i_deg,theta_s_deg,phi_s_deg,btdf_per_sr\n", ScatterFormat::Csv, &["no rows"]);
    refused("", ScatterFormat::Csv, &["line 1", "theta_i_deg"]);
    let head = "theta_i_deg,theta_s_deg,phi_s_deg,btdf_per_sr\n";
    let comma = format!("{head}0,5,45,0,0,1\n");
    refused(&comma, ScatterFormat::Csv, &["line 2", "6 columns instead of 4", "decimal point"]);
    let radians = format!("{head}0,0,0,0.1\n0,0.7,0,0.1\n0,1.5708,0,0.1\n");
    refused(&radians, ScatterFormat::Csv, &["line 1", "could be in radians", "180/π"]);
    // Lines may end in CR.
    let old = all.replace('\n', "\r");
    assert_eq!(good(&old, ScatterFormat::Csv).front, good(&all, ScatterFormat::Csv).front);
    // Azimuths beyond 2π show that a narrow scan is in degrees.
    let narrow = format!("{head}0,0,0,0.1\n0,1.5,0,0.1\n0,0,180,0.1\n0,1.5,180,0.1\n");
    refused(&narrow, ScatterFormat::Csv, &["line 1: theta_s_deg ends at 1.5"]);
    let twice = all.replacen("theta_s_deg", "theta_s_deg, Theta_s_deg", 1);
    refused(&twice, ScatterFormat::Csv, &["line 2: the column `theta_s_deg` is there twice"]);
}

/// A table of values over these angles that change with each of them.
fn changing(incident: &[f64], polar: &[f64], azimuth: &[f64]) -> String {
    let mut text = "# a sample\ntheta_i_deg,theta_s_deg,phi_s_deg,brdf_per_sr\n".to_owned();
    for i in incident {
        for s in polar {
            for phi in azimuth {
                _ = writeln!(text, "{i},{s},{phi},{}", 1e-4 * (1.0 + i + s + phi));
            }
        }
    }
    text
}

#[test]
fn angles_that_are_missing_are_named() {
    let (polar, azimuth) = (&[0.0, 45.0, 90.0][..], &[0.0, 90.0, 180.0][..]);
    for (incident, part) in [
        (&[0.0][..], "theta_i_deg is 0 in all rows, but the values change"),
        (
            &[30.0, 60.0, 80.0],
            "theta_i_deg begins at 30, so angles are missing below it; add rows from 0",
        ),
        (
            &[0.0, 30.0, 60.0],
            "theta_i_deg ends at 60, so angles are missing beyond it; add rows up to 90",
        ),
        (&[0.0, 10.0, 70.0, 80.0], "theta_i_deg has no rows between 10 and 70, 60 deg apart"),
    ] {
        refused(&changing(incident, polar, azimuth), ScatterFormat::Csv, &["line 2", part]);
    }
    for (polar, part) in [
        (&[45.0][..], "theta_s_deg is 45 in all rows"),
        (&[25.0, 60.0, 90.0], "theta_s_deg begins at 25"),
        (&[0.0, 40.0, 65.0], "theta_s_deg ends at 65"),
        (&[0.0, 30.0, 80.0], "theta_s_deg has no rows between 30 and 80"),
    ] {
        refused(
            &changing(&[0.0, 45.0, 90.0], polar, azimuth),
            ScatterFormat::Csv,
            &["line 2", part],
        );
    }
    for (azimuth, part) in [
        (&[0.0][..], "phi_s_deg is 0 in all rows"),
        (
            &[0.0, 45.0, 90.0],
            "phi_s_deg from 0 to 90 covers neither a half circle, 0 to 180, nor a whole one",
        ),
        (&[45.0, 90.0, 135.0, 180.0], "phi_s_deg from 45 to 180 covers neither"),
        (&[0.0, 30.0, 60.0, 200.0], "phi_s_deg from 0 to 200 covers neither"),
        // In the plane of incidence alone.
        (&[0.0, 180.0], "phi_s_deg has no rows between 0 and 180"),
        (&[180.0, 240.0, 300.0, 360.0], "phi_s_deg from 180 to 360 covers neither"),
    ] {
        refused(
            &changing(&[0.0, 45.0, 90.0], polar, azimuth),
            ScatterFormat::Csv,
            &["line 2", part],
        );
    }
    // A constant with angles has all of them, too.
    let short =
        changing(&[0.0, 30.0], polar, azimuth).lines().take(2).collect::<Vec<_>>().join("\n");
    refused(
        &(short + "\n0,0,0,.1\n60,0,0,.1\n"),
        ScatterFormat::Csv,
        &["line 2: theta_i_deg ends at 60"],
    );
}

#[test]
fn a_little_beyond_its_angles_a_table_is_constant_with_a_remark() {
    let polar = &[20.0, 45.0, 70.0][..];
    for (azimuth, words) in [
        (&[20.0, 90.0, 160.0][..], "phi_s of 20 to 160 deg"),
        (&[0.0, 90.0, 180.0, 270.0], "theta_s of 20 to 70 deg"),
        (&[0.0, 60.0, 120.0, 180.0, 240.0, 300.0, 360.0], "theta_s of 20 to 70 deg"),
    ] {
        let file = good(&changing(polar, polar, azimuth), ScatterFormat::Csv);
        let remarks = file.remarks.join("; ");
        for part in ["beyond theta_i of 20 to 70 deg the value at the nearest angle", words] {
            assert!(remarks.contains(part), "{part}: {remarks}");
        }
    }
    // A constant needs one angle of each kind.
    let one = "theta_i_deg,theta_s_deg,phi_s_deg,brdf_per_sr\n0,30,0,.1\n";
    let file = good(one, ScatterFormat::Csv);
    assert!(file.front.reflection.unwrap().values.iter().all(|value| (value - 0.1).abs() < 1e-12));
    for name in ["theta_i is given at 0", "theta_s is given at 30", "phi_s is given at 0"] {
        assert!(file.remarks.iter().any(|own| own.contains(name)), "{name}: {:?}", file.remarks);
    }
}

#[test]
fn a_table_of_scatter_is_told_from_one_of_rays() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    for (text, is_scatter) in [
        ("# by angles\n\nTheta_i_deg, theta_s_deg\n", true),
        ("x_mm,y_mm,z_mm,dx,dy,dz,flux_lm\n0,0,0,0,0,1,1\n", false),
        ("# theta_i_deg\nx_mm\n", false),
        ("\u{feff}# by angles\ntheta_i_deg,theta_s_deg\n", true),
        ("", false),
    ] {
        std::fs::write(&path, text).unwrap();
        assert_eq!(is_scatter_table(&path), is_scatter, "{text}");
    }
    assert!(!is_scatter_table(&folder.path().join("none.csv")));
}
