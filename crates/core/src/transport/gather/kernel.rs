//! Kernels of higher order: weights of the pairs within one window that remove the bias of smooth light.
//!
//! With s = (distance/r)² and t = (1 - cos α)/(1 - cos θₘₐₓ) a window is the unit square. The mean of the light over all
//! azimuths is a polynomial in s and t, whose value at 0 is wanted. Sums over pairs with the weight 1 give the estimate of
//! second order, E1, whose bias starts with s and t. The weights
//!
//! `K₄ = k₄(s) + k₄(t) - 1` and `K₆ = k₆(s) + k₆(t) - 1 + (k₄(s) - 1)(k₄(t) - 1)`
//!
//! have the mean 1, and K₄ no first moments, K₆ no first and second moments, if k₄ and k₆ are the polynomials of first and
//! second degree with these properties in one variable (docs/method.md, eq. 24). So E0, of fourth order, has no bias of
//! second order, and E00, of sixth order, none of fourth. A ball, and a cone that is cut, have polynomials of their own
//! moments; a disk that is cut also has a linear term across, since the light no longer balances about its middle.

use glam::{DMat4, DVec2, DVec4};

/// Estimates that are counted: E1, E0 and E00.
pub(crate) const ORDERS: usize = 3;
/// Moments of a variable that its kernels follow from: the means of its powers 0 to 4.
pub(crate) const MOMENTS: usize = 5;

/// Least variance of a variable over the square of its mean, and least determinant of its moments over the cube of the
/// variance, from which kernels follow, 1: an even distribution has 1/3 and 4/5.
const LEAST_SPREAD: [f64; 2] = [0.02, 0.05];
/// Places of a cut disk, and the determinant of their products, from which its kernels follow: a whole disk has 1/192, its
/// half 1e-3, its quarter 4e-5.
const LEAST_PLACES: f64 = 12.0;
const LEAST_CUT_DETERMINANT: f64 = 1e-5;

/// The polynomials of one variable, k₄ as `k` and k₆ as `q`, by their coefficients.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kernels {
    k: [f64; 2],
    q: [f64; 3],
}

/// Sums over the places of a disk that is cut: products of 1, s and the two coordinates across, in radii.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CutDisk {
    products: DMat4,
    /// The number of places.
    places: f64,
}

impl CutDisk {
    pub(crate) const EMPTY: Self = Self { products: DMat4::ZERO, places: 0.0 };

    pub(crate) fn add(&mut self, across: DVec2) {
        let terms = DVec4::new(1.0, across.length_squared(), across.x, across.y);
        self.products +=
            DMat4::from_cols(terms * terms.x, terms * terms.y, terms * terms.z, terms * terms.w);
        self.places += 1.0;
    }

    pub(crate) fn places(&self) -> f64 {
        self.places
    }

    /// Kernels of s, and the slope of the linear term, per radius, without first moments over the places. The sixth order
    /// is the fourth.
    pub(crate) fn kernels(&self) -> (Kernels, DVec2) {
        // The first column of the inverse: a mean of 1, and none of the other terms.
        let means = self.products * (1.0 / self.places.max(1.0));
        if self.places < LEAST_PLACES || means.determinant() < LEAST_CUT_DETERMINANT {
            return (Kernels::NONE, DVec2::ZERO);
        }
        let DVec4 { x: one, y: s, z, w } = means.inverse().x_axis;
        (Kernels { k: [one, s], q: [one, s, 0.0] }, DVec2::new(z, w))
    }
}

impl Kernels {
    /// For a variable that is distributed evenly from 0 to 1, as s on a whole disk and t in a whole cone.
    pub const EVEN: Self = Self { k: [4.0, -6.0], q: [9.0, -36.0, 30.0] };
    /// For a variable without influence.
    pub const NONE: Self = Self { k: [1.0, 0.0], q: [1.0, 0.0, 0.0] };

    /// For a variable with these means of its powers; no influence where the moments are too close to singular.
    pub(crate) fn of_moments(means: [f64; MOMENTS]) -> Self {
        let [m1, m2, m3, m4] = [1, 2, 3, 4].map(|power| means[power] / means[0]);
        // Cofactors of the first row of the Hankel matrix of the moments.
        let [c0, c1, c2] = [m2 * m4 - m3 * m3, m2 * m3 - m1 * m4, m1 * m3 - m2 * m2];
        let (two, three) = (m2 - m1 * m1, c0 + m1 * c1 + m2 * c2);
        let [least_variance, least_determinant] = LEAST_SPREAD;
        if two > least_variance * m1 * m1 && three > least_determinant * two.powi(3) {
            Self { k: [m2 / two, -m1 / two], q: [c0 / three, c1 / three, c2 / three] }
        } else {
            Self::NONE
        }
    }

    /// k₄ and k₆.
    #[inline]
    pub(crate) fn at(&self, u: f64) -> [f64; 2] {
        let ([k0, k1], [q0, q1, q2]) = (self.k, self.q);
        [k0 + k1 * u, q0 + u * (q1 + q2 * u)]
    }
}

/// The weights of a pair in E1, E0 and E00 from k₄ and k₆ of its position and of its angle.
#[inline]
pub(crate) fn weights_by_order([k_s, q_s]: [f64; 2], [k_t, q_t]: [f64; 2]) -> [f64; ORDERS] {
    [1.0, k_s + k_t - 1.0, q_s + q_t - 1.0 + (k_s - 1.0) * (k_t - 1.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean over the unit square, by Gauss's rule with 4 points: exact to the seventh power.
    fn mean(f: impl Fn(f64, f64) -> f64) -> f64 {
        let nodes = [0.861_136_311_594_052_6, 0.339_981_043_584_856_3];
        let weights = [0.347_854_845_137_453_85, 0.652_145_154_862_546_2];
        let points = || {
            nodes
                .into_iter()
                .zip(weights)
                .flat_map(|(x, w)| [-x, x].map(|x| (0.5 * (1.0 + x), 0.5 * w)))
        };
        points()
            .flat_map(|(s, ws)| points().map(move |(t, wt)| (s, t, ws * wt)))
            .map(|(s, t, w)| w * f(s, t))
            .sum()
    }

    fn even(s: f64, t: f64) -> [f64; ORDERS] {
        weights_by_order(Kernels::EVEN.at(s), Kernels::EVEN.at(t))
    }

    #[test]
    fn kernels_of_an_even_window_are_those_of_the_method() {
        let (s, t) = (0.3, 0.8);
        let [one, fourth, sixth] = even(s, t);
        assert_eq!(one, 1.0);
        assert!((fourth - (7.0 - 6.0 * s - 6.0 * t)).abs() < 1e-12, "{fourth}");
        let expected = 26.0 - 54.0 * s - 54.0 * t + 30.0 * s * s + 36.0 * s * t + 30.0 * t * t;
        assert!((sixth - expected).abs() < 1e-12, "{sixth}");
        let of_moments = Kernels::of_moments([1.0, 0.5, 1.0 / 3.0, 0.25, 0.2]);
        for u in [0.0, 0.4, 1.0] {
            let [[k, q], [expected_k, expected_q]] = [of_moments.at(u), Kernels::EVEN.at(u)];
            assert!((k - expected_k).abs() < 1e-9 && (q - expected_q).abs() < 1e-9, "{k}, {q}");
        }
    }

    #[test]
    fn each_order_removes_the_powers_below_it() {
        for (i, j) in [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)] {
            let with = |order: usize| mean(|s, t| even(s, t)[order] * s.powi(i) * t.powi(j));
            let wanted = if i + j == 0 { 1.0 } else { 0.0 };
            assert!((with(2) - wanted).abs() < 1e-12, "sixth order, s^{i} t^{j}");
            if i + j < 2 {
                assert!((with(1) - wanted).abs() < 1e-12, "fourth order, s^{i} t^{j}");
            }
        }
    }

    #[test]
    fn variances_over_that_of_the_second_order_are_7_and_26() {
        for (order, expected) in [(0, 1.0), (1, 7.0), (2, 26.0)] {
            let square = mean(|s, t| even(s, t)[order].powi(2));
            assert!((square - expected).abs() < 1e-12, "{square}, not {expected}");
        }
    }

    #[test]
    fn a_half_of_a_disk_has_no_first_moments() {
        let places: Vec<DVec2> = (0..4000)
            .map(|place| {
                let turns = f64::from(place) * 0.381_966_011_250_105_1;
                let radius = ((f64::from(place) + 0.5) / 4000.0).sqrt();
                DVec2::from_angle(turns * std::f64::consts::TAU) * radius
            })
            .filter(|place| place.x > 0.2 * place.y)
            .collect();
        let mut cut = CutDisk::EMPTY;
        places.iter().for_each(|place| cut.add(*place));
        let (kernels, slope) = cut.kernels();
        let mean = |f: &dyn Fn(DVec2) -> f64| {
            let weighted = places.iter().map(|&place| {
                let [k, _] = kernels.at(place.length_squared());
                (k + slope.dot(place)) * f(place)
            });
            weighted.sum::<f64>() / places.len() as f64
        };
        let one = mean(&|_| 1.0);
        assert!((one - 1.0).abs() < 1e-9, "{one}, {kernels:?}, {slope}, {cut:?}");
        for moment in [mean(&|at| at.x), mean(&|at| at.y), mean(&DVec2::length_squared)] {
            assert!(moment.abs() < 1e-9, "{moment}");
        }
        let mut line = CutDisk::EMPTY;
        (0..20).for_each(|place| line.add(DVec2::new(0.05 * f64::from(place), 0.0)));
        assert_eq!(line.kernels(), (Kernels::NONE, DVec2::ZERO));
    }

    #[test]
    fn a_cut_window_has_kernels_of_its_own_moments() {
        // Evenly from 0 to c: powers of c over the power and one more.
        let c = 0.6f64;
        let moments = std::array::from_fn(|power| c.powi(power as i32) / (power + 1) as f64);
        let kernels = Kernels::of_moments(moments);
        let [k, q] = kernels.at(0.6 * 0.25);
        let [expected_k, expected_q] = Kernels::EVEN.at(0.25);
        assert!((k - expected_k).abs() < 1e-9 && (q - expected_q).abs() < 1e-9, "{k}, {q}");
        assert_eq!(
            Kernels::of_moments([1.0, 0.5, 0.25, 0.125, 0.0625]),
            Kernels::NONE,
            "one place"
        );
    }
}
