//! Where a line crosses a torus.

use glam::DVec3;
use lumiduct_base::math::{Root, SignChange, cubic, quartic};
use std::ops::ControlFlow;

/// A line in the frame of a torus of major radius 1 and minor radius `tube`; lengths are in major radii.
///
/// With A = |p|² + 1 - r² the torus is A² = 4 (x² + y²); outside of it A² is larger.
pub(super) struct TorusLine {
    pub(super) from: DVec3,
    pub(super) dir: DVec3,
    pub(super) tube: f64,
}

impl TorusLine {
    /// Visits the wanted crossings in a span of the line, which may be infinite, in ascending order.
    ///
    /// From the line's point q nearest to the centre, q·d = 0, the quartic has no cubic term: A(t) = A + d² t². (d² differs
    /// from 1 by the rounding of the frame.)
    #[inline]
    pub(super) fn visit_all(
        &self,
        [lo, hi]: [f64; 2],
        is_wanted: impl Fn(SignChange) -> bool,
        mut visit: impl FnMut(Root) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let Self { from, dir, tube } = *self;
        let dir2 = dir.length_squared();
        let coarse = -from.dot(dir) / dir2;
        let near = from + coarse * dir;
        // Once more: seen from far away, q·d is not yet zero to rounding.
        let fine = -near.dot(dir) / dir2;
        let (shift, nearest) = (coarse + fine, near + fine * dir);
        let reach = (1.0 + tube) * (1.0 + tube) - nearest.length_squared();
        if reach < 0.0 {
            return ControlFlow::Continue(());
        }
        let half_chord = bracket(reach);
        let span = [(lo - shift).max(-half_chord), (hi - shift).min(half_chord)];
        let across_axis = nearest.truncate();
        let distance = across_axis.length();
        let along = across_axis.dot(dir.truncate());
        let coefficients = [
            // A² - 4ρ² as a product: A - 2ρ is the squared distance to the centre line less r².
            ((distance - 1.0).powi(2) + nearest.z * nearest.z - tube * tube)
                * ((distance + 1.0).powi(2) + nearest.z * nearest.z - tube * tube),
            -8.0 * along,
            2.0 * ((nearest.length_squared() - 1.0 - tube * tube) * dir2 + 2.0 * dir.z * dir.z),
            0.0,
            dir2 * dir2,
        ];
        // (ρ - 1)² + z² - r² and half its derivative.
        let unsquared = |t: f64| {
            let p = nearest + t * dir;
            let distance = p.truncate().length();
            let distance_slope = p.truncate().dot(dir.truncate()) / distance;
            (
                0.5 * ((distance - 1.0).powi(2) + p.z * p.z - tube * tube),
                (distance - 1.0) * distance_slope + p.z * dir.z,
            )
        };
        quartic(coefficients, span, is_wanted, |(t, change)| {
            visit((shift + polished(t, unsquared), change))
        })
    }

    /// Visits the wanted crossings in a span of a line that starts on the torus, in ascending order, except the start.
    ///
    /// On the surface A = 2ρ exactly, and the quartic's constant term is zero; what remains is a cubic, here written so
    /// that its terms are small where the tube is thin. Before the start, its negative
    /// has the sign of the quartic. A tangent touches the torus at the start, which is no crossing.
    #[inline]
    pub(super) fn visit_others(
        &self,
        [lo, hi]: [f64; 2],
        is_wanted: impl Fn(SignChange) -> bool,
        mut visit: impl FnMut(Root) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        /// Distance from the start of a root that is the start, in major radii: far below every other one.
        const AT_START: f64 = 1e-100;
        let Self { from, dir, tube } = *self;
        let dir2 = dir.length_squared();
        let (across_axis, across_dir) = (from.truncate(), dir.truncate());
        let distance = across_axis.length();
        let along = from.dot(dir);
        let (across_along, across_dir2) =
            (across_axis.dot(across_dir), across_dir.length_squared());
        let reach = along * along + (1.0 + tube) * (1.0 + tube) - from.length_squared();
        let half_chord = bracket(reach.max(0.0));
        let (lo, hi) = (lo.max(-along - half_chord), hi.min(-along + half_chord));
        let coefficients = [
            8.0 * (distance * from.z * dir.z + across_along * (distance - 1.0)),
            4.0 * (along * along + (distance - 1.0) * dir2 + dir.z * dir.z),
            4.0 * along * dir2,
            dir2 * dir2,
        ];
        // For F = (ρ - 1)² + z², the change (F(t) - F(0)) / t, written without that difference, and its
        // derivative.
        let unsquared = |t: f64| {
            let now = (across_axis + t * across_dir).length();
            let now_slope = (across_along + t * across_dir2) / now;
            let rise = (2.0 * across_along + t * across_dir2) / (now + distance);
            let rise_slope = (across_dir2 - rise * now_slope) / (now + distance);
            let sum = (now - 1.0) + (distance - 1.0);
            (
                rise * sum + dir.z * (2.0 * from.z + t * dir.z),
                rise_slope * sum + rise * now_slope + dir.z * dir.z,
            )
        };
        // Spans that leave out the start instead would make bends slower by a third.
        let mut visit = |(t, change): Root| {
            if coefficients[0] == 0.0 && t.abs() < AT_START {
                ControlFlow::Continue(())
            } else {
                visit((polished(t, unsquared), change))
            }
        };
        if lo < 0.0 {
            cubic(coefficients.map(|c| -c), [lo, hi.min(0.0)], &is_wanted, &mut visit)?;
        }
        if hi > 0.0 {
            cubic(coefficients, [lo.max(0.0), hi], is_wanted, visit)?;
        }
        ControlFlow::Continue(())
    }
}

/// A root of the squared equation, improved by a step of Newton's method on an unsquared one, which loses fewer digits
/// near the axis and for thin tubes.
#[inline]
fn polished(t: f64, unsquared: impl Fn(f64) -> (f64, f64)) -> f64 {
    // Steps are about 1e-15. They are larger than this only for grazing rays, where two roots
    // nearly meet and the step may miss; there the distance from the surface is already small.
    const LARGEST_STEP: f64 = 1e-11;
    let (value, slope) = unsquared(t);
    let step = value / slope;
    if step.abs() < LARGEST_STEP { t - step } else { t }
}

/// Half an interval that certainly contains all crossings, from the squared half chord of the
/// enclosing sphere.
fn bracket(squared_half_chord: f64) -> f64 {
    // Any margin above rounding works: there are no roots beyond the sphere.
    squared_half_chord.sqrt() + 0.01
}
