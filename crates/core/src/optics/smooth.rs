//! The smooth interface of two media: its shares and its discrete directions.

use crate::optics::fresnel;
use crate::optics::incidence::{Incidence, Shares, Side};
use glam::DVec3;

/// Fresnel's shares; between equal indices all light passes, even along the face.
pub(crate) fn smooth(incidence: &Incidence) -> Shares {
    let Incidence { index_from, index_to, .. } = *incidence;
    let reflected = if index_from == index_to {
        0.0
    } else {
        fresnel::dielectric(incidence.cos(), index_from, index_to).unpolarised()
    };
    Shares { reflected, transmitted: 1.0 - reflected }
}

/// The discrete direction of a smooth interface, a unit vector up to rounding: mirrored, or
/// refracted (`None` under total reflection).
pub(crate) fn smooth_direction(incidence: &Incidence, side: Side) -> Option<DVec3> {
    let Incidence { dir, normal, index_from, index_to, .. } = *incidence;
    match side {
        Side::Reflected => Some(fresnel::mirrored(dir, normal)),
        Side::Transmitted if index_from == index_to => Some(dir),
        Side::Transmitted => {
            let cos_i = incidence.cos();
            let cos_t = fresnel::cos_transmitted(cos_i, index_from, index_to)?;
            Some(fresnel::refracted(dir, normal, cos_i, cos_t, index_from / index_to))
        }
    }
}
