//! Cones of directions that are cut by the horizon of a surface, or where its total reflection begins.
//!
//! Radiance may jump at such an edge, so only photons on the same side as the axis count. Kernels follow from the moments
//! of t over that side, with directions weighted by projected solid angle.

use crate::transport::gather::kernel::{Kernels, MOMENTS};
use std::f64::consts::PI;

/// A cone, as seen by photons of one place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CutCone {
    /// Projected solid angle of its part, sr.
    pub(crate) projected: f64,
    pub(crate) kernels: Kernels,
}

/// Nodes and weights of Gauss's rule with eight points on [0, 1], by pairs about the middle (Abramowitz & Stegun 1964,
/// table 25.4).
const NODES: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (0.960_289_856_497_536_2, 0.101_228_536_290_376_3),
];

impl CutCone {
    /// The part of a cone of this half-angle, rad, whose directions have cosines to the normal in a range; `cos_axis` is
    /// that of the axis.
    pub(crate) fn new(cos_axis: f64, half_angle: f64, [least, most]: [f64; 2]) -> Self {
        let sin_axis = ((1.0 - cos_axis) * (1.0 + cos_axis)).max(0.0).sqrt();
        // Height of the cone's cap, 1 - cos θ.
        let cap = 2.0 * (0.5 * half_angle).sin().powi(2);
        // ∫ cos θ dφ along the part of the ring at t.
        let ring = |t: f64| {
            let drop = cap * t;
            let sin = (drop * (2.0 - drop)).sqrt();
            // Along the ring cos θ is `middle + swing cos φ`.
            let (middle, swing) = ((1.0 - drop) * cos_axis, sin * sin_axis);
            let azimuth = |cos: f64| {
                let reach = cos - middle;
                if reach >= swing {
                    0.0
                } else if reach <= -swing {
                    PI
                } else {
                    (reach / swing).acos()
                }
            };
            let [from, to] = [azimuth(most), azimuth(least)];
            2.0 * (middle * (to - from) + swing * (to.sin() - from.sin()))
        };
        // Rings about the axis begin to cross an edge where they touch it.
        let touching = |edge: f64| {
            // 1 - cos of the angle between them, without cancellation.
            let sin_edge = ((1.0 - edge) * (1.0 + edge)).max(0.0).sqrt();
            let drop = 0.5 * ((edge - cos_axis).powi(2) + (sin_edge - sin_axis).powi(2));
            (drop / cap).clamp(0.0, 1.0)
        };
        let [near, far] = [touching(least), touching(most)];
        let mut moments = [0.0; MOMENTS];
        for [from, to] in
            [[0.0, near.min(far)], [near.min(far), near.max(far)], [near.max(far), 1.0]]
        {
            for (x, weight) in NODES.into_iter().flat_map(|(x, weight)| [(-x, weight), (x, weight)])
            {
                // From there on the ring's part changes with the root of the distance.
                let root = 0.5 * (1.0 + x);
                let t = from + (to - from) * root * root;
                let mut power = weight * root * (to - from) * cap * ring(t);
                for moment in &mut moments {
                    *moment += power;
                    power *= t;
                }
            }
        }
        Self { projected: moments[0], kernels: Kernels::of_moments(moments) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumiduct_base::math::projected_cap;

    #[test]
    fn a_cone_at_the_horizon_has_its_projected_solid_angle() {
        for half_angle in [1e-3f64, 0.05, 0.5] {
            for elevation in [0.05, 0.3, 0.7, 1.0, 3.0] {
                let cos_axis = (elevation * half_angle).sin();
                let cut = CutCone::new(cos_axis, half_angle, [0.0, 1.0]);
                let expected = projected_cap(cos_axis, half_angle);
                let error = cut.projected / expected - 1.0;
                assert!(error.abs() < 1e-5, "{half_angle}, {elevation}: {error}");
            }
        }
    }

    #[test]
    fn a_whole_cone_that_is_narrow_has_the_kernels_of_an_even_one() {
        let CutCone { kernels, .. } = CutCone::new(0.7, 1e-3, [0.0, 1.0]);
        let [[k, q], [even_k, even_q]] = [kernels.at(0.3), Kernels::EVEN.at(0.3)];
        assert!((k - even_k).abs() < 1e-6 && (q - even_q).abs() < 1e-4, "{k}, {q}");
    }

    #[test]
    fn an_edge_divides_a_cone_into_two_sides() {
        let (cos_axis, half_angle, edge) = (0.6, 0.02, 0.59);
        let [below, above, whole] = [[0.0, edge], [edge, 1.0], [0.0, 1.0]]
            .map(|range| CutCone::new(cos_axis, half_angle, range).projected);
        assert!((below + above - whole).abs() < 1e-12 && below < above, "{below}, {above}");
    }
}
