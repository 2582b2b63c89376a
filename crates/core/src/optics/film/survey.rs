//! Properties of a film over all directions, for its users.

use crate::optics::{Incidence, PrismFilm, REFERENCE_WAVELENGTH};
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

/// Positions in the period that are tried for a leak.
const PLACES: u32 = 64;
/// Azimuths that are tried at each refinement.
const AZIMUTHS: u32 = 180;
/// Narrowest range of azimuths that is refined, rad: below it the angle changes by less than its rounding.
const NARROWEST: f64 = 1e-6;
/// Precision of an angle, rad.
const FINEST: f64 = 1e-12;

/// The largest angle to the prisms, in rad, up to which light that meets the flat face returns from
/// every azimuth about them with no transmission; 0 if there is none. `index` is that of the medium
/// on both sides. It is found by trial, not by formula; rounded edges are left out. Light of one
/// azimuth is assumed to leak at all angles beyond the first.
pub fn acceptance_angle(film: &PrismFilm, index: f64) -> f64 {
    // Rounded edges lose light at every angle: the cone is that of the facets between them.
    let film = &film.with_sharp_edges();
    let mut range = [-FRAC_PI_2, FRAC_PI_2];
    let mut angle = FRAC_PI_2;
    while range[1] - range[0] > NARROWEST {
        let step = (range[1] - range[0]) / f64::from(AZIMUTHS);
        let mut worst = 0.5 * (range[0] + range[1]);
        for place in 0..AZIMUTHS {
            let azimuth = range[0] + (f64::from(place) + 0.5) * step;
            let limit = smallest_leak(film, index, azimuth, angle);
            if limit < angle {
                (angle, worst) = (limit, azimuth);
            }
        }
        range = [worst - 2.0 * step, worst + 2.0 * step]
            .map(|azimuth| azimuth.clamp(-FRAC_PI_2, FRAC_PI_2));
    }
    angle
}

/// The smallest angle to the prisms at which light of an azimuth leaks, by halving an interval that begins at 0; `most`
/// where it does not leak up to there.
fn smallest_leak(film: &PrismFilm, index: f64, azimuth: f64, most: f64) -> f64 {
    let leaks = |angle: f64| film.leaks(&along_prisms(angle, azimuth, index), PLACES);
    if !leaks(most) {
        return most;
    }
    let (mut tight, mut leaking) = (0.0, most);
    while leaking - tight > FINEST {
        let middle = 0.5 * (tight + leaking);
        if leaks(middle) { leaking = middle } else { tight = middle }
    }
    leaking
}

/// Light of unit direction that meets a face z = 0 from above at an angle to the grain, which runs along y, and an azimuth
/// about it from the normal; rad.
pub fn along_prisms(angle: f64, azimuth: f64, index: f64) -> Incidence {
    let (sin, cos) = angle.sin_cos();
    let (sin_azimuth, cos_azimuth) = azimuth.sin_cos();
    Incidence {
        dir: DVec3::new(sin * sin_azimuth, cos, -sin * cos_azimuth).normalize(),
        normal: DVec3::Z,
        index_from: index,
        index_to: index,
        wavelength: REFERENCE_WAVELENGTH,
        grain: DVec3::Y,
        s_share: Incidence::UNPOLARISED,
    }
}
