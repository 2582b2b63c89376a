//! Unified glare ratings of a luminaire in standard rooms (CIE 117:1995), for the UGR table of its page.
//!
//! Rooms, luminaires and observer are those of the table in CIE 190:2010. Its method takes the light on the walls and the position
//! index from tables; here they are computed: the light by form factors, and the index by the formula of Guth. Both agree with the
//! tables, and ratings differ by some 0.2 from those of the tables.

use lumiduct_files::luminaire::Intensities;
use std::f64::consts::{FRAC_PI_2, PI};

/// Rooms: width across the view and length along it, in heights of the luminaires above the eye (CIE 190:2010).
pub(crate) const ROOMS: [[f64; 2]; 19] = [
    [2.0, 2.0],
    [2.0, 3.0],
    [2.0, 4.0],
    [2.0, 6.0],
    [2.0, 8.0],
    [2.0, 12.0],
    [4.0, 2.0],
    [4.0, 3.0],
    [4.0, 4.0],
    [4.0, 6.0],
    [4.0, 8.0],
    [4.0, 12.0],
    [8.0, 4.0],
    [8.0, 6.0],
    [8.0, 8.0],
    [8.0, 12.0],
    [12.0, 4.0],
    [12.0, 6.0],
    [12.0, 8.0],
];
/// Reflectances of ceiling, walls and the plane at the height of the eye, 1 (CIE 190:2010).
pub(crate) const REFLECTANCES: [[f64; 3]; 5] =
    [[0.7, 0.5, 0.2], [0.7, 0.3, 0.2], [0.5, 0.5, 0.2], [0.5, 0.3, 0.2], [0.3, 0.3, 0.2]];
/// Height of the luminaires above the eye, m, and their distance from each other, in heights (CIE 190:2010).
const HEIGHT_M: f64 = 2.0;
const SPACING: f64 = 0.25;
/// Luminaires further to the side than this, in distances along the view, or seen at larger angles γ in degrees, do not count
/// (CIE 117:1995, section 4.5).
const FURTHEST_ASIDE: f64 = 3.0;
const LARGEST_ANGLE: f64 = 85.0;
/// Steps of the integrals over γ from 0° to 90°, and over a quarter of C.
const ZONES: u32 = 90;
const DIRECTIONS: u32 = 90;
/// Reflections that are followed: 0.7 to this power is less than a part in ten thousand million.
const REFLECTIONS: u32 = 66;

/// The C plane that lies along the view.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ViewPlane {
    /// C0.
    C0,
    /// C90.
    C90,
}

/// Ratings in a room by reflectances, of a luminaire that is symmetric about C0 and C90 and has a flat opening of an area in m².
pub(crate) fn ratings(
    intensities: &Intensities,
    area_m2: f64,
    room: [f64; 2],
    view: ViewPlane,
) -> [f64; 5] {
    let luminaires = grid(room);
    let count = luminaires.len() as f64;
    let glare: f64 =
        luminaires.iter().map(|place| glare_of(intensities, area_m2, *place, view)).sum();
    let walls_m2 = 2.0 * (room[0] + room[1]) * HEIGHT_M * HEIGHT_M;
    let direct = direct_flux(intensities, room);
    REFLECTANCES.map(|reflectances| {
        // CIE 117:1995, eq. 4.1: the background has the luminance E/π of the indirect light at the eye, here that on the walls.
        let indirect = indirect_on_walls(direct, reflectances, room);
        let background = count * indirect / walls_m2 / PI;
        8.0 * (0.25 * glare / background).log10()
    })
}

/// The luminaires, as distances to the side of the eye and along the view, in heights. The eye is at the middle of a wall.
fn grid([width, length]: [f64; 2]) -> Vec<[f64; 2]> {
    let [across, along] = [width, length].map(|size| (size / SPACING).round() as u32);
    let place = |number: u32| (f64::from(number) + 0.5) * SPACING;
    let row = |n: u32| (0..across).map(move |m| [place(m) - 0.5 * width, place(n)]);
    (0..along).flat_map(row).collect()
}

/// L² ω / p² of a luminaire, cd²/m⁴ sr: its luminance is I over the projected area, and its solid angle that area over r².
fn glare_of(
    intensities: &Intensities,
    area_m2: f64,
    [aside, ahead]: [f64; 2],
    view: ViewPlane,
) -> f64 {
    let distance = (1.0 + aside * aside + ahead * ahead).sqrt();
    let angle = aside.hypot(ahead).atan().to_degrees();
    if aside.abs() > FURTHEST_ASIDE * ahead || angle > LARGEST_ANGLE {
        return 0.0;
    }
    let turned = aside.abs().atan2(ahead).to_degrees();
    let plane = match view {
        ViewPlane::C0 => turned,
        ViewPlane::C90 => 90.0 - turned,
    };
    let intensity = intensities.at(plane, angle);
    let projected = area_m2 / distance;
    let index = position_index(aside.abs(), ahead);
    (intensity / (HEIGHT_M * distance * index)).powi(2) / projected
}

/// The position index of Guth, 1, of a source one height above the line of sight: with the angle τ in degrees from the vertical plane
/// through the line of sight, and σ in degrees from that line (Levin, J. Illum. Eng. Soc. 4 (1975) 99).
fn position_index(aside: f64, ahead: f64) -> f64 {
    let tau = aside.atan().to_degrees();
    let sigma = aside.hypot(1.0).atan2(ahead).to_degrees();
    let linear = 35.2 - 0.318_89 * tau - 1.22 * (-2.0 * tau / 9.0).exp();
    let square = 21.0 + 0.266_67 * tau - 0.002_963 * tau * tau;
    (1e-3 * linear * sigma + 1e-5 * square * sigma * sigma).exp()
}

/// Flux of a luminaire that goes to the plane of the eye, to the walls and to the ceiling, lm. Luminaires everywhere on the ceiling
/// send light at γ over the length tan γ; the share that reaches the plane is that of places from which this length ends inside.
fn direct_flux(intensities: &Intensities, [width, length]: [f64; 2]) -> [f64; 3] {
    let step = 90.0 / f64::from(ZONES);
    let share = |angle: f64| {
        let reach = angle.to_radians().tan();
        let inside = |number: u32| {
            let turned = FRAC_PI_2 * (f64::from(number) + 0.5) / f64::from(DIRECTIONS);
            let (sin, cos) = turned.sin_cos();
            (1.0 - reach * cos / width).max(0.0) * (1.0 - reach * sin / length).max(0.0)
        };
        (0..DIRECTIONS).map(inside).sum::<f64>() / f64::from(DIRECTIONS)
    };
    let zone = |number: u32| {
        let from = step * f64::from(number);
        intensities.flux_between(from, from + step) * share(from + 0.5 * step)
    };
    let floor: f64 = (0..ZONES).map(zone).sum();
    let down = intensities.flux_between(0.0, 90.0);
    [floor, down - floor, intensities.flux_between(90.0, 180.0)]
}

/// Flux that reaches the walls after reflections, lm, between the plane of the eye, the walls and the ceiling.
fn indirect_on_walls(direct: [f64; 3], [ceiling, walls, floor]: [f64; 3], room: [f64; 2]) -> f64 {
    let across = opposite_factor(room);
    let to_walls = 1.0 - across;
    let from_walls = room[0] * room[1] * to_walls / (2.0 * (room[0] + room[1]));
    let mut incident = direct;
    for _ in 0..REFLECTIONS {
        let [on_floor, on_walls, on_ceiling] =
            [floor * incident[0], walls * incident[1], ceiling * incident[2]];
        incident = [
            direct[0] + from_walls * on_walls + across * on_ceiling,
            direct[1] + to_walls * (on_floor + on_ceiling) + (1.0 - 2.0 * from_walls) * on_walls,
            direct[2] + from_walls * on_walls + across * on_floor,
        ];
    }
    incident[1] - direct[1]
}

/// Form factor between equal rectangles that face each other at a distance of 1 (Howell, A Catalog of Radiation Heat Transfer
/// Configuration Factors, C-11).
fn opposite_factor([x, y]: [f64; 2]) -> f64 {
    let root = |size: f64| (1.0 + size * size).sqrt();
    let log = 0.5 * ((1.0 + x * x) * (1.0 + y * y) / (1.0 + x * x + y * y)).ln();
    let [of_x, of_y] = [x * root(y) * (x / root(y)).atan(), y * root(x) * (y / root(x)).atan()];
    2.0 / (PI * x * y) * (log + of_x + of_y - x * x.atan() - y * y.atan())
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumiduct_files::luminaire::PlaneSymmetry;

    #[test]
    fn light_on_walls_is_that_of_the_tables() {
        // CIE 190:2010, table 5: the part of the light for the plane, the walls and the ceiling that reaches the walls again.
        for (room, reflectances, expected) in [
            ([2.0, 2.0], [0.7, 0.5, 0.2], [0.220, 0.422, 0.646]),
            ([4.0, 8.0], [0.7, 0.5, 0.2], [0.115, 0.211, 0.307]),
            ([2.0, 12.0], [0.5, 0.3, 0.2], [0.128, 0.140, 0.276]),
            ([12.0, 8.0], [0.3, 0.3, 0.2], [0.049, 0.059, 0.069]),
        ] {
            for (surface, expected) in expected.into_iter().enumerate() {
                let mut direct = [0.0; 3];
                direct[surface] = 1.0;
                let found = indirect_on_walls(direct, reflectances, room);
                assert!((found - expected).abs() < 1.5e-3, "{room:?}: {found} {expected}");
            }
        }
    }

    #[test]
    fn the_position_index_is_that_of_the_table() {
        assert!((position_index(0.0, 1e9) - 1.0).abs() < 1e-6, "on the line of sight");
        // CIE 117:1995, table 4.1: by T/R and H/R.
        for (aside, height, expected) in
            [(0.0, 0.5, 2.86), (0.0, 1.0, 7.0), (1.0, 1.0, 7.0), (2.0, 0.5, 5.8), (3.0, 1.9, 16.0)]
        {
            let found = position_index(aside / height, 1.0 / height);
            assert!((found / expected - 1.0).abs() < 0.1, "{aside} {height}: {found} {expected}");
        }
    }

    #[test]
    fn direct_light_is_shared_as_by_form_factors() {
        // A Lambertian ceiling sends its form factor to the plane below.
        let (intensities, _) = lambertian(100.0);
        for room in [[2.0, 2.0], [4.0, 8.0], [12.0, 8.0]] {
            let [floor, walls, ceiling] = direct_flux(&intensities, room);
            let flux = intensities.flux();
            assert!((floor / flux - opposite_factor(room)).abs() < 1e-3, "{room:?}");
            assert!((floor + walls - flux).abs() < 1e-9 * flux && ceiling == 0.0, "{room:?}");
        }
    }

    #[test]
    fn twice_the_light_adds_as_much_in_every_room() {
        for room in ROOMS {
            let [one, two] = [100.0, 200.0].map(|peak| {
                let (intensities, area) = lambertian(peak);
                ratings(&intensities, area, room, ViewPlane::C0)
            });
            for (one, two) in one.into_iter().zip(two) {
                assert!((two - one - 8.0 * 2f64.log10()).abs() < 1e-9, "{one} {two}");
            }
        }
    }

    #[test]
    fn ratings_are_those_of_the_table_method() {
        // An opening of 1200 mm by 300 mm with wings toward C90, by the tables of CIE 190 (eulumdat-ugr 1.0.2, V. Bersier).
        let range = |count: u32, step: f64| -> Vec<f64> {
            (0..=count).map(|place| step * f64::from(place)).collect()
        };
        let (planes, angles) = (range(6, 15.0), range(90, 1.0));
        let of = |plane: f64, angle: f64| {
            let wings = 2.0 + plane.to_radians().sin().powi(2);
            let (sin, cos) = angle.to_radians().sin_cos();
            400.0 * cos.max(0.0) * (1.0 + wings * sin * sin) * (1.0 - (angle / 90.0).powi(6))
        };
        let candela = planes.iter().flat_map(|plane| angles.iter().map(|angle| of(*plane, *angle)));
        let candela = candela.collect();
        let own = Intensities::new(PlaneSymmetry::Quadrants, planes, angles, candela).unwrap();
        for (room, view, expected) in [
            ([2.0, 2.0], ViewPlane::C0, [15.95, 17.76, 16.32, 18.07, 18.38]),
            ([2.0, 2.0], ViewPlane::C90, [17.23, 19.03, 17.59, 19.35, 19.66]),
            ([4.0, 8.0], ViewPlane::C0, [20.39, 21.37, 20.85, 21.81, 22.27]),
            ([4.0, 8.0], ViewPlane::C90, [21.76, 22.74, 22.21, 23.17, 23.64]),
            ([12.0, 8.0], ViewPlane::C0, [21.06, 21.70, 21.56, 22.19, 22.75]),
            ([12.0, 8.0], ViewPlane::C90, [22.25, 22.89, 22.75, 23.38, 23.93]),
        ] {
            let found = ratings(&own, 0.36, room, view);
            for (found, expected) in found.into_iter().zip(expected) {
                assert!((found - expected).abs() < 0.22, "{room:?} {view:?}: {found} {expected}");
            }
        }
    }

    /// A Lambertian luminaire, and its opening of 0.36 m².
    fn lambertian(peak: f64) -> (Intensities, f64) {
        let angles: Vec<f64> = (0..=90).map(f64::from).collect();
        let of = |angle: &f64| (peak * angle.to_radians().cos()).max(0.0);
        let candela = angles.iter().map(of).collect();
        let planes = vec![0.0];
        let own = Intensities::new(PlaneSymmetry::Rotational, planes, angles, candela).unwrap();
        (own, 0.36)
    }
}
