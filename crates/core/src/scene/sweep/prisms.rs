//! Outlines around a profile: offset by a wall, and lined with prisms.

use crate::scene::sweep::{Profile, ProfileError};
use glam::DVec2;
use lumiduct_base::math::planar;
use std::f64::consts::PI;

/// Prisms side by side on an outline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prisms {
    /// Number of prisms.
    pub number: PrismNumber,
    /// Angle between the facets of a prism at its tip, rad.
    pub angle: f64,
}

/// Number of prisms on an outline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PrismNumber {
    /// This many around a circle, or on each side of a polygon.
    Count(usize),
    /// As many as fit at this distance from valley to valley, mm.
    Pitch(f64),
}

/// Why a profile cannot be offset or lined with prisms.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum OutlineError {
    /// The outline itself is not a valid profile.
    #[error(transparent)]
    Profile(#[from] ProfileError),
    /// The polygon has an inward corner.
    #[error("a wall around a profile with an inward corner is not supported")]
    NotConvex,
    /// Prisms of this pitch leave a gap.
    #[error(
        "prisms of {pitch} mm do not fit: {fit:.4} of them fit on {length:.6} mm, expected a whole number, \
            such as {nearest} of {better:.6} mm"
    )]
    Gap {
        /// The pitch, mm.
        pitch: f64,
        /// Number that fit.
        fit: f64,
        /// Available length, mm.
        length: f64,
        /// The nearest number of prisms.
        nearest: f64,
        /// Their pitch, mm.
        better: f64,
    },
    /// There are more prisms than a profile may have corners for.
    #[error("{0:.0} prisms on a side or around are too many, expected at most 500 in all")]
    TooMany(f64),
    /// There are too few prisms to go around.
    #[error("{0} prisms do not go around, expected at least 3")]
    TooFew(usize),
}

/// Prisms on an outline: each has two of the corners that a profile may have.
const MOST_PRISMS: f64 = 500.0;
/// Deviation from a whole number of prisms that is taken as rounding, 1.
const WHOLE: f64 = 1e-6;

impl Profile {
    /// The outline at a distance around this profile, mm; corners stay sharp.
    ///
    /// # Errors
    ///
    /// [`OutlineError::NotConvex`] for a polygon with an inward corner, [`OutlineError::Profile`] if what results
    /// is not a valid profile.
    pub fn grown(&self, by: f64) -> Result<Self, OutlineError> {
        match self {
            Self::Circle { radius } => Ok(Self::circle(radius + by)?),
            Self::Polygon { points } => {
                if !planar::is_convex(points) {
                    return Err(OutlineError::NotConvex);
                }
                let count = points.len();
                let grown = (0..count).map(|i| {
                    let before = points[i] - points[(i + count - 1) % count];
                    let after = points[(i + 1) % count] - points[i];
                    // Outward of a counter-clockwise outline is to the right of its edges.
                    let [a, b] = [before, after].map(|edge| -edge.normalize().perp());
                    points[i] + by / (1.0 + a.dot(b)) * (a + b)
                });
                Ok(Self::polygon(grown.collect())?)
            }
        }
    }

    /// This outline lined with prisms all around: its corners, or points of a circle, are valleys.
    /// On a circle a pitch is measured along the arc.
    ///
    /// # Errors
    ///
    /// [`OutlineError::Gap`] if no whole number of prisms of the pitch fits, [`OutlineError::TooMany`] if more than
    /// 500 do, [`OutlineError::TooFew`] if fewer than 3 go around a circle, [`OutlineError::Profile`] if what
    /// results is not a valid profile.
    pub fn with_prisms(&self, prisms: &Prisms) -> Result<Self, OutlineError> {
        let valleys = match self {
            Self::Circle { radius } => {
                let count = number(prisms.number, 2.0 * PI * radius)?;
                if count < 3 {
                    return Err(OutlineError::TooFew(count));
                }
                let step = 2.0 * PI / count as f64;
                (0..count).map(|i| radius * DVec2::from_angle(i as f64 * step)).collect()
            }
            Self::Polygon { points } => {
                let mut valleys = Vec::new();
                for (from, to) in planar::edges(points) {
                    let count = number(prisms.number, from.distance(to))?;
                    valleys.extend((0..count).map(|i| from.lerp(to, i as f64 / count as f64)));
                }
                valleys
            }
        };
        let height = 0.5 / (0.5 * prisms.angle).tan();
        let outline = planar::edges(&valleys).flat_map(|(from, to)| {
            let tip = 0.5 * (from + to) - height * (to - from).perp();
            [from, tip]
        });
        Ok(Self::polygon(outline.collect())?)
    }
}

/// Number of prisms on a length, mm.
fn number(number: PrismNumber, length: f64) -> Result<usize, OutlineError> {
    match number {
        PrismNumber::Count(count) => Ok(count),
        PrismNumber::Pitch(pitch) => {
            let fit = length / pitch;
            let nearest = fit.round().max(1.0);
            if nearest > MOST_PRISMS {
                return Err(OutlineError::TooMany(nearest));
            }
            if (fit - nearest).abs() > WHOLE * nearest {
                let better = length / nearest;
                return Err(OutlineError::Gap { pitch, fit, length, nearest, better });
            }
            Ok(nearest as usize)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    fn right_angled(number: PrismNumber) -> Prisms {
        Prisms { number, angle: FRAC_PI_2 }
    }

    #[test]
    fn right_angled_prisms_on_a_square_add_their_triangles() {
        let square = Profile::rectangle(10.0, 10.0).unwrap();
        let grown = square.grown(1.0).unwrap();
        assert!((grown.area() - 144.0).abs() < 1e-12);
        for number in [PrismNumber::Count(6), PrismNumber::Pitch(2.0)] {
            let outline = grown.with_prisms(&right_angled(number)).unwrap();
            // 24 triangles of base 2 and height 1.
            assert!((outline.area() - 168.0).abs() < 1e-12);
            let Profile::Polygon { points } = &outline else { panic!("a polygon") };
            assert_eq!(points.len(), 48);
        }
    }

    #[test]
    fn prisms_around_a_circle_have_their_valleys_on_it_and_their_angle_at_the_tips() {
        let circle = Profile::circle(5.0).unwrap().grown(0.5).unwrap();
        let outline = circle.with_prisms(&right_angled(PrismNumber::Count(40))).unwrap();
        let Profile::Polygon { points } = &outline else { panic!("a polygon") };
        for valley in points.iter().step_by(2) {
            assert!((valley.length() - 5.5).abs() < 1e-12);
        }
        for tip in points.windows(3).step_by(2) {
            assert!((tip[0] - tip[1]).dot(tip[2] - tip[1]).abs() < 1e-12);
            assert!(tip[1].length() > 5.5);
        }
    }

    #[test]
    fn what_does_not_close_is_refused_with_what_would() {
        let circle = Profile::circle(10.0).unwrap();
        let gap = circle.with_prisms(&right_angled(PrismNumber::Pitch(1.3))).unwrap_err();
        assert!(gap.to_string().contains("48.3322 of them fit"), "{gap}");
        assert!(gap.to_string().contains("48 of 1.308997 mm"), "{gap}");
        let many = circle.with_prisms(&right_angled(PrismNumber::Pitch(1e-9))).unwrap_err();
        assert!(many.to_string().contains("too many"), "{many}");
        let few = circle.with_prisms(&right_angled(PrismNumber::Count(2))).unwrap_err();
        assert!(few.to_string().contains("at least 3"), "{few}");
        let ell = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)];
        let ell = Profile::polygon(ell.map(DVec2::from).to_vec()).unwrap();
        assert_eq!(ell.grown(0.1), Err(OutlineError::NotConvex));
    }
}
