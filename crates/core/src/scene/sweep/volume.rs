//! The volume that a sweep encloses, in closed form.

use crate::scene::sweep::Profile;
use crate::scene::sweep::path::{PieceForm, SweptPath};
use glam::DVec2;

/// Volume of all pieces of `path`, mm³.
pub(super) fn volume(profile: &Profile, path: &SweptPath) -> f64 {
    let area = profile.area();
    path.pieces
        .iter()
        .map(|piece| {
            let scale = piece.start.scale;
            match &piece.form {
                PieceForm::Prism { floor, ceiling } => {
                    let below = slanted(profile, floor.toward, |q| floor.highest(q) - floor.height);
                    let above =
                        slanted(profile, ceiling.toward, |q| ceiling.lowest(q) - ceiling.height);
                    area * scale.powi(2) * (ceiling.height - floor.height)
                        + scale.powi(3) * (above - below)
                }
                PieceForm::Taper { length, end_scale } => {
                    area * length * (scale * scale + scale * end_scale + end_scale * end_scale)
                        / 3.0
                }
                // Pappus: area times the path length of its centroid.
                PieceForm::Bend { angle, radius, toward } => {
                    let moment: f64 = profile.half_moments(*toward).iter().sum();
                    angle * (area * scale.powi(2) * radius - scale.powi(3) * moment)
                }
                PieceForm::Corner { .. } => 0.0,
            }
        })
        .sum()
}

/// Integral over the profile at the entry, mm³, of a rise that is linear on either side of the path
/// in the direction `toward`: of the planes of a mitre, one applies over the outer half and one
/// over the inner half.
fn slanted(profile: &Profile, toward: DVec2, rise: impl Fn(DVec2) -> f64) -> f64 {
    let [outer, inner] = profile.half_moments(toward);
    inner * rise(toward) - outer * rise(-toward)
}
