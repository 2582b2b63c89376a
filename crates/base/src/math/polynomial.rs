//! Real roots of cubics and quartics, one by one.
//!
//! No tolerances: roots are located by sign changes, so they are consistent (between two upward
//! crossings there is one downward), also for rays that graze a surface.

use crate::math::{bracketed_root, quadratic};
use std::ops::ControlFlow;

/// How a function changes its sign at a root.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SignChange {
    /// From negative.
    Rise,
    /// To negative.
    Fall,
}

/// A sign change of a polynomial, and where it is.
pub type Root = (f64, SignChange);

/// Visits real roots of `Σ coefficients[i] tⁱ`, up to t³, in the finite interval [`lo`, `hi`]; see [`quartic`].
#[inline]
pub fn cubic(
    coefficients: [f64; 4],
    interval: [f64; 2],
    is_wanted: impl Fn(SignChange) -> bool,
    visit: impl FnMut(Root) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let critical =
        |[_, c, b, a]: [f64; 4], [lo, hi]: [f64; 2]| critical_of_cubic([c, b, a], lo, hi);
    visit_roots((coefficients, interval), critical, is_wanted, visit)
}

/// Visits real roots of `Σ coefficients[i] tⁱ`, up to t⁴, in the finite interval [`lo`, `hi`] in ascending order: those of a
/// wanted sign change, until the visitor breaks. An interval that ends before it starts is empty.
///
/// The roots are the places where the sign changes, zero counting as positive: a root of even order
/// is visited twice or not at all, and a root at an end only if the polynomial is negative next to
/// it. Between two neighbouring roots of its derivative a polynomial is monotonic, so each piece
/// contains one root or none. Leading coefficients may be zero or tiny; the zero polynomial and one
/// with non-finite coefficients have no roots.
#[inline]
pub fn quartic(
    coefficients: [f64; 5],
    interval: [f64; 2],
    is_wanted: impl Fn(SignChange) -> bool,
    visit: impl FnMut(Root) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let critical = |terms, [lo, hi]: [f64; 2]| critical_of_quartic(terms, lo, hi);
    visit_roots((coefficients, interval), critical, is_wanted, visit)
}

/// Visits roots in units of the interval and of the largest term: nothing that matters overflows or underflows. The units
/// are powers of two, which do not round.
#[inline]
fn visit_roots<const N: usize, const PIECES: usize>(
    (mut terms, [lo, hi]): ([f64; N], [f64; 2]),
    critical: impl FnOnce([f64; N], [f64; 2]) -> [f64; PIECES],
    is_wanted: impl Fn(SignChange) -> bool,
    mut visit: impl FnMut(Root) -> ControlFlow<()>,
) -> ControlFlow<()> {
    if lo > hi {
        return ControlFlow::Continue(());
    }
    let unit = power_of_two_below(lo.abs().max(hi.abs()));
    let (mut power, mut sum) = (1.0, 0.0);
    for term in &mut terms {
        *term *= power;
        power *= unit;
        sum += term.abs();
    }
    if sum == 0.0 || !sum.is_finite() {
        return ControlFlow::Continue(());
    }
    let scale = 1.0 / power_of_two_below(sum);
    let terms = terms.map(|term| term * scale);
    let interval = [lo / unit, hi / unit];
    let critical = critical(terms, interval);
    visit_pieces((&terms, interval), &critical, is_wanted, |(t, change)| visit((t * unit, change)))
}

/// The largest power of two not above `x` > 0; the smallest normal number for zero and subnormal ones.
#[inline]
fn power_of_two_below(x: f64) -> f64 {
    const EXPONENT_BITS: u64 = 0x7ff0_0000_0000_0000;
    f64::from_bits(x.max(f64::MIN_POSITIVE).to_bits() & EXPONENT_BITS)
}

/// Where the derivative of `d + c t + b t² + a t³` is zero, in ascending order; points outside the interval, infinite or NaN
/// for a = 0, do not split it and are moved to its ends.
#[inline]
fn critical_of_cubic([c, b, a]: [f64; 3], lo: f64, hi: f64) -> [f64; 2] {
    quadratic(3.0 * a, b, c).map_or([hi; 2], |all| all.map(|t| t.max(lo).min(hi)))
}

/// The same of `e + d t + c t² + b t³ + a t⁴`.
#[inline]
fn critical_of_quartic([_, d, c, b, a]: [f64; 5], lo: f64, hi: f64) -> [f64; 3] {
    let slope = [d, 2.0 * c, 3.0 * b, 4.0 * a];
    let pieces = critical_of_cubic([slope[1], slope[2], slope[3]], lo, hi);
    let (mut critical, mut found) = ([hi; 3], 0);
    let keep = |(t, _): Root| {
        critical[found] = t;
        found += 1;
        ControlFlow::Continue(())
    };
    let _ = visit_pieces((&slope, [lo, hi]), &pieces, |_| true, keep);
    critical
}

/// Visits roots of a polynomial that is monotonic between the ends and the `critical` points.
#[inline]
fn visit_pieces<const N: usize>(
    (coefficients, [lo, hi]): (&[f64; N], [f64; 2]),
    critical: &[f64],
    is_wanted: impl Fn(SignChange) -> bool,
    mut visit: impl FnMut(Root) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let mut left = lo;
    let mut left_is_negative = polynomial(coefficients, lo).0 < 0.0;
    for &right in critical.iter().chain([&hi]) {
        let right_is_negative = polynomial(coefficients, right).0 < 0.0;
        let change = if left_is_negative { SignChange::Rise } else { SignChange::Fall };
        if left_is_negative != right_is_negative && is_wanted(change) {
            visit((bracketed_root(left, right, |t| polynomial(coefficients, t)), change))?;
        }
        (left, left_is_negative) = (right, right_is_negative);
    }
    ControlFlow::Continue(())
}

/// Value and derivative at `t`, by Horner's rule.
#[inline]
fn polynomial<const N: usize>(coefficients: &[f64; N], t: f64) -> (f64, f64) {
    coefficients
        .iter()
        .rev()
        .fold((0.0, 0.0), |(value, slope), c| (value * t + c, slope * t + value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    /// The real roots of a polynomial of degree 4 or less; those of degree 3 or less by both functions.
    fn polynomial_roots(coefficients: &[f64], lo: f64, hi: f64) -> Vec<f64> {
        let padded = |i: usize| coefficients.get(i).copied().unwrap_or(0.0);
        let mut roots = Vec::new();
        let add = |root: Root| {
            roots.push(root);
            ControlFlow::Continue(())
        };
        let _ = quartic(std::array::from_fn(padded), [lo, hi], |_| true, add);
        for wanted in [SignChange::Rise, SignChange::Fall] {
            let mut first = None;
            let _ = quartic(
                std::array::from_fn(padded),
                [lo, hi],
                |change| change == wanted,
                |root| {
                    first = Some(root);
                    ControlFlow::Break(())
                },
            );
            assert_eq!(first, roots.iter().copied().find(|(_, change)| *change == wanted));
        }
        if coefficients.len() < 5 {
            let mut same = 0;
            let _ = cubic(
                std::array::from_fn(padded),
                [lo, hi],
                |_| true,
                |_| {
                    same += 1;
                    ControlFlow::Continue(())
                },
            );
            assert_eq!(roots.len(), same, "{coefficients:?}");
        }
        roots.into_iter().map(|(t, _)| t).collect()
    }

    /// Coefficients of `∏ (t - root)`.
    fn with_roots(roots: &[f64]) -> Vec<f64> {
        roots.iter().fold(vec![1.0], |product, root| {
            let mut next = vec![0.0; product.len() + 1];
            for (i, c) in product.iter().enumerate() {
                next[i + 1] += c;
                next[i] -= root * c;
            }
            next
        })
    }

    /// Least rounding error of a root: an ulp of every term, over the slope.
    fn conditioning(coefficients: &[f64], t: f64) -> f64 {
        let terms: f64 = coefficients.iter().rev().fold(0.0, |sum, c| sum * t.abs() + c.abs());
        let padded = std::array::from_fn(|i| coefficients.get(i).copied().unwrap_or(0.0));
        let slope = polynomial::<5>(&padded, t).1;
        f64::EPSILON * (terms / slope.abs() + t.abs())
    }

    proptest! {
        #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(41), cases: 2000, ..ProptestConfig::default() })]

        // Multiples of 1/64 below 8: all coefficients are exact in f64.
        #[test]
        fn simple_roots_come_back_to_a_few_ulp_at_any_scale(
            numerators in prop::collection::btree_set(-512i32..512, 1..=4), exponent in -200i32..200
        ) {
            let scale = 2f64.powi(exponent);
            let known: Vec<f64> = numerators.iter().map(|&n| f64::from(n) / 64.0 * scale).collect();
            let coefficients = with_roots(&known);
            let found = polynomial_roots(&coefficients, -16.0 * scale, 16.0 * scale);
            prop_assert_eq!(found.len(), known.len());
            for (found, known) in found.iter().zip(&known) {
                prop_assert!((found - known).abs() <= 2.0 * conditioning(&coefficients, *known), "{} {}", found, known);
            }
        }

        #[test]
        fn widely_scaled_roots_are_each_found_to_their_own_digits(
            mantissas in prop::array::uniform4(1.0..2.0f64), signs in prop::array::uniform4(any::<bool>())
        ) {
            let exponents = [-60, -20, 3, 40];
            let known: Vec<f64> =
                (0..4).map(|i| mantissas[i] * 2f64.powi(exponents[i]) * if signs[i] { 1.0 } else { -1.0 }).collect();
            let coefficients = with_roots(&known);
            let found = polynomial_roots(&coefficients, -1e13, 1e13);
            prop_assert_eq!(found.len(), 4);
            for known in known {
                let error = found.iter().map(|t| (t - known).abs()).fold(f64::INFINITY, f64::min);
                prop_assert!(error <= 1e-14 * known.abs(), "{} off by {}", known, error);
            }
        }

        #[test]
        fn near_double_roots_come_in_pairs(a in -512i32..512, b in 513i32..1024, gap in 1i32..24) {
            // The pair is 2^-gap apart; it loses digits as 1/gap.
            let (a, b) = (f64::from(a) / 512.0, f64::from(b) / 512.0);
            let width = 2f64.powi(-gap);
            let coefficients = with_roots(&[a, a + width, b + 1.0]);
            let found = polynomial_roots(&coefficients, -4.0, 4.0);
            prop_assert_eq!(found.len(), 3);
            prop_assert!((found[0] - a).abs() < 1e-14 / width && (found[1] - a - width).abs() < 1e-14 / width);
        }
    }

    #[test]
    fn only_roots_inside_the_interval_are_given() {
        let coefficients = with_roots(&[-2.0, -1.0, 1.0, 2.0]);
        assert!(polynomial_roots(&coefficients, 1.5, 0.5).is_empty());
        assert_eq!(polynomial_roots(&coefficients, -1.5, 1.5).as_slice(), [-1.0, 1.0]);
        assert!(polynomial_roots(&coefficients, 3.0, 9.0).is_empty());
    }

    #[test]
    fn touching_roots_are_given_twice_or_not_at_all() {
        // -(t - 1)² (t² + 1) touches zero from below, its negative from above.
        let below = [-1.0, 2.0, -2.0, 2.0, -1.0];
        let above = below.map(|c| -c);
        assert_eq!(polynomial_roots(&below, -3.0, 3.0).len() % 2, 0);
        assert_eq!(polynomial_roots(&above, -3.0, 3.0).len() % 2, 0);
        // A triple root changes the sign.
        assert_eq!(polynomial_roots(&[-1.0, 3.0, -3.0, 1.0], -3.0, 3.0).len() % 2, 1);
    }

    #[test]
    fn zero_and_tiny_leading_coefficients_lower_the_degree() {
        assert_eq!(polynomial_roots(&[-6.0, 2.0, 0.0, 0.0, 0.0], -9.0, 9.0).as_slice(), [3.0]);
        assert_eq!(
            polynomial_roots(&[-6.0, 2.0, 1e-300, 1e-300, 1e-300], -9.0, 9.0).as_slice(),
            [3.0]
        );
        for nothing in [&[][..], &[1.0], &[0.0; 5], &[f64::NAN, 1.0]] {
            assert!(polynomial_roots(nothing, -1.0, 1.0).is_empty());
        }
    }
}
