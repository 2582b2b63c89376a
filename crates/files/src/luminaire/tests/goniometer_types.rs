//! Lamps in angles of types A and B against the same lamps in C planes.

use crate::luminaire::front_table::{FrontTable, problem_of_angles};
use crate::luminaire::intensities::{Intensities, PlaneSymmetry};
use crate::luminaire::type_b::{angles_of, direction_of};
use crate::luminaire::{type_a, type_b};
use std::f64::consts::PI;

/// A smooth lamp that aims at a direction, cd: (1 + cos a)² / 4 of 1000, with the angle a from it.
fn smooth(aim: [f64; 3]) -> impl Fn(f64, f64) -> f64 {
    let length = aim.iter().map(|own| own * own).sum::<f64>().sqrt();
    move |plane: f64, angle: f64| {
        let cos: f64 = aim.iter().zip(unit(plane, angle)).map(|(a, b)| a * b / length).sum();
        250.0 * (1.0 + cos) * (1.0 + cos)
    }
}

/// The direction in a C plane at an angle γ: toward C0, toward C90, down.
fn unit(plane: f64, angle: f64) -> [f64; 3] {
    let ((sin_plane, cos_plane), (sin, cos)) =
        (plane.to_radians().sin_cos(), angle.to_radians().sin_cos());
    [sin * cos_plane, sin * sin_plane, cos]
}

fn range(first: f64, last: f64, step: f64) -> Vec<f64> {
    (0..=((last - first) / step).round() as u32).map(|n| first + step * f64::from(n)).collect()
}

/// The table of a lamp, at the C plane and γ of every pair of angles.
fn table(
    horizontal: &[f64],
    vertical: &[f64],
    lamp: impl Fn(f64, f64) -> f64,
    direction: impl Fn(f64, f64) -> [f64; 2],
) -> FrontTable {
    let values = horizontal.iter().flat_map(|h| vertical.iter().map(move |v| (*h, *v)));
    let candela = values.map(|(h, v)| direction(h, v)).map(|[plane, angle]| lamp(plane, angle));
    FrontTable::new(horizontal.to_vec(), vertical.to_vec(), candela.collect())
}

/// LM-63-2002, section 3: horizontal angles clockwise, and the nadir at -90.
fn direction_a(horizontal: f64, vertical: f64) -> [f64; 2] {
    [(-horizontal).rem_euclid(360.0), 90.0 + vertical]
}

/// The difference that a remark states, percent.
fn stated_percent(remarks: &[String]) -> f64 {
    let words = remarks[0].split("up to ").nth(1).unwrap();
    words.split(' ').next().unwrap().parse().unwrap()
}

#[test]
fn points_of_type_b_are_those_of_the_standard() {
    // (V 0, H 0) is the nadir, (V 90, H 0) the photometric horizontal, (V 0, H 90) lies at C270.
    for (horizontal, vertical, direction) in [
        (0.0, 0.0, [0.0, 0.0, 1.0]),
        (0.0, 90.0, [1.0, 0.0, 0.0]),
        (0.0, -90.0, [-1.0, 0.0, 0.0]),
        (90.0, 0.0, [0.0, -1.0, 0.0]),
        (-90.0, 0.0, [0.0, 1.0, 0.0]),
    ] {
        let [plane, angle] = direction_of(horizontal, vertical);
        let found = unit(plane, angle);
        let distance: f64 = found.iter().zip(direction).map(|(a, b)| (a - b).abs()).sum();
        assert!(distance < 1e-12, "{horizontal} {vertical}: {found:?}");
    }
    for plane in range(0.0, 355.0, 5.0) {
        for angle in range(2.5, 87.5, 5.0) {
            let [horizontal, vertical] = angles_of(plane, angle);
            let [c, gamma] = direction_of(horizontal, vertical);
            let apart: f64 =
                unit(c, gamma).iter().zip(unit(plane, angle)).map(|(a, b)| (a - b).abs()).sum();
            assert!(apart < 1e-12, "{plane} {angle}: {c} {gamma}");
        }
    }
}

#[test]
fn a_smooth_lamp_in_type_a_has_the_intensities_of_its_c_planes() {
    let lamp = smooth([1.0, 0.4, -0.3]);
    let horizontal = range(-90.0, 90.0, 7.5);
    let vertical = range(-90.0, 90.0, 5.0);
    let mut remarks = Vec::new();
    let own = table(&horizontal, &vertical, &lamp, direction_a);
    let found = type_a::over_c_planes(&own, &mut remarks).unwrap();
    // The same lamp in C planes that go through every value: what lies between them is the same, too.
    let planes = range(0.0, 352.5, 7.5);
    let angles = range(0.0, 180.0, 5.0);
    let candela = planes.iter().flat_map(|c| angles.iter().map(|gamma| lamp(*c, *gamma))).collect();
    let expected = Intensities::new(PlaneSymmetry::None, planes, angles, candela).unwrap();
    for plane in [0.0, 3.0, 44.0, 89.9, 270.2, 317.0, 359.0] {
        for angle in range(0.0, 180.0, 1.7) {
            let both = [found.at(plane, angle), expected.at(plane, angle)];
            assert!((both[0] - both[1]).abs() < 1e-9, "{plane} {angle}: {both:?}");
        }
    }
    for plane in [90.1, 180.0, 269.9] {
        assert_eq!(found.at(plane, 80.0), 0.0, "behind");
    }
    assert!(remarks[0].contains("type A") && remarks[0].contains("-90° to 90°"), "{remarks:?}");
}

#[test]
fn tables_of_one_side_stand_for_both() {
    let lamp = smooth([1.0, 0.0, 0.4]);
    let vertical = range(-90.0, 90.0, 5.0);
    let [half, whole] = [range(0.0, 90.0, 5.0), range(-90.0, 90.0, 5.0)];
    let pair = |direction: fn(f64, f64) -> [f64; 2]| {
        [&half, &whole].map(|horizontal| table(horizontal, &vertical, &lamp, direction))
    };
    let over = |tables: [FrontTable; 2], is_a: bool| {
        tables.map(|own| match is_a {
            true => type_a::over_c_planes(&own, &mut Vec::new()).unwrap(),
            false => type_b::over_c_planes(&own, &mut Vec::new()).unwrap(),
        })
    };
    for [half, whole] in [over(pair(direction_a), true), over(pair(direction_of), false)] {
        assert_eq!(half.symmetry(), PlaneSymmetry::AboutC0);
        assert!((half.flux() / whole.flux() - 1.0).abs() < 1e-9);
        for plane in range(0.0, 360.0, 8.0) {
            for angle in range(0.0, 90.0, 9.0) {
                let both = [half.at(plane, angle), whole.at(plane, angle)];
                assert!((both[0] - both[1]).abs() < 1e-9, "{plane} {angle}: {both:?}");
            }
        }
    }
}

#[test]
fn a_lambertian_lamp_in_type_b_has_the_intensities_of_its_c_planes() {
    let lamp = |_: f64, angle: f64| 1000.0 * angle.to_radians().cos().max(0.0);
    let mut differences = Vec::new();
    for step in [10.0, 5.0, 2.5] {
        let angles = range(-90.0, 90.0, step);
        let mut remarks = Vec::new();
        let own = table(&angles, &angles, lamp, direction_of);
        let found = type_b::over_c_planes(&own, &mut remarks).unwrap();
        let mut largest: f64 = 0.0;
        for plane in range(0.0, 360.0, 6.0) {
            for angle in range(0.0, 90.0, 1.5) {
                largest = largest.max((found.at(plane, angle) - lamp(plane, angle)).abs());
            }
        }
        differences.push(largest);
        let flux = found.flux() / (1000.0 * PI);
        // Straight lines below a cosine, in two angles: (step/2)² / 2 of it each.
        assert!((flux - 1.0).abs() < 0.3 * step.to_radians().powi(2), "{step}: {flux}");
        // As docs/files.md says.
        let share = stated_percent(&remarks);
        assert!(share > 0.0 && (step > 5.0 || share < 0.125), "{step}: {share}");
    }
    // Interpolation twice, in the angles of the file and in C and γ: its error falls with the square of the step.
    assert!(differences[0] < 1000.0 * 10f64.to_radians().powi(2) / 3.0, "{differences:?}");
    for pair in differences.windows(2) {
        assert!((3.0..5.0).contains(&(pair[0] / pair[1])), "{differences:?}");
    }
}

#[test]
fn the_stated_difference_of_type_b_holds_everywhere() {
    let lamp = smooth([0.5, -0.7, 1.0]);
    let own = table(&range(-90.0, 90.0, 10.0), &range(-90.0, 90.0, 10.0), &lamp, direction_of);
    let mut remarks = Vec::new();
    let found = type_b::over_c_planes(&own, &mut remarks).unwrap();
    let stated = stated_percent(&remarks);
    assert!(stated < 1.0, "{stated} % for steps of 10°");
    for plane in range(0.0, 359.0, 1.3) {
        for angle in range(0.0, 90.0, 1.1) {
            let [horizontal, vertical] = angles_of(plane, angle);
            let apart = (found.at(plane, angle) - own.at(horizontal, vertical)).abs();
            let percent = 100.0 * apart / own.peak();
            assert!(percent < 1.2 * stated, "{plane} {angle}: {percent} and {stated}");
        }
    }
}

#[test]
fn angles_beyond_the_front_are_refused() {
    for (horizontal, vertical, words) in [
        (&[0.0][..], &[0.0, 90.0][..], "one horizontal angle"),
        (&[0.0, 90.0], &[0.0], "one vertical angle"),
        (&[0.0, 180.0], &[0.0, 90.0], "horizontal angles from 0 to 180"),
        (&[0.0, 90.0], &[-100.0, 90.0], "vertical angles from -100"),
        (&[10.0, 90.0], &[0.0, 90.0], "horizontal angles from 10 to 90"),
        (&[-90.0, -10.0], &[0.0, 90.0], "horizontal angles from -90 to -10"),
    ] {
        let problem = problem_of_angles(horizontal, vertical).unwrap();
        assert!(problem.contains(words), "{problem}");
    }
    assert_eq!(problem_of_angles(&[-90.0, 90.0], &[-90.0, 90.0]), None);
}
