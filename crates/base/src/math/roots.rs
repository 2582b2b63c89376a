//! Real roots, accurate to rounding also where textbook formulas cancel.
//!
//! No tolerances: roots are located by sign changes, so they are consistent (between two upward
//! crossings there is one downward), also for rays that graze a surface.

use smallvec::SmallVec;

/// The real roots of a polynomial in ascending order.
pub type Roots = SmallVec<[f64; 4]>;

/// Real roots of `a t² + 2 b t + c` (note the halved middle coefficient), ascending; a double root
/// is given twice. Uses the form that never subtracts nearly equal numbers (Press et al., Numerical
/// Recipes, 3rd ed., eq. 5.6.4).
#[inline]
pub fn quadratic(a: f64, half_b: f64, c: f64) -> Option<[f64; 2]> {
    let discriminant = half_b * half_b - a * c;
    if discriminant < 0.0 {
        return None;
    }
    let q = -(half_b + discriminant.sqrt().copysign(half_b));
    if q == 0.0 {
        return Some([0.0, 0.0]);
    }
    let (one, two) = (q / a, c / q);
    Some(if one < two { [one, two] } else { [two, one] })
}

/// Real roots of `Σ coefficients[i] tⁱ`, up to t³, in the finite interval [`lo`, `hi`], ascending; see [`quartic`].
pub fn cubic(coefficients: [f64; 4], lo: f64, hi: f64) -> Roots {
    in_units_of(coefficients, lo, hi, unscaled_cubic)
}

/// Real roots of `Σ coefficients[i] tⁱ`, up to t⁴, in the finite interval [`lo`, `hi`], ascending.
///
/// The roots are the places where the sign changes, zero counting as positive: a root of even order
/// is given twice or not at all, and a root at an end only if the polynomial is negative next to
/// it. Between two neighbouring roots of its derivative a polynomial is monotonic, so each piece
/// contains one root or none. Leading coefficients may be zero or tiny; the zero polynomial and one
/// with non-finite coefficients have no roots.
pub fn quartic(coefficients: [f64; 5], lo: f64, hi: f64) -> Roots {
    in_units_of(coefficients, lo, hi, |[e, d, c, b, a], lo, hi| {
        let critical = unscaled_cubic([d, 2.0 * c, 3.0 * b, 4.0 * a], lo, hi);
        roots_of_pieces([e, d, c, b, a], lo, hi, &critical)
    })
}

/// Roots in units of the interval and of the largest term: nothing that matters overflows or underflows. The units
/// are powers of two, which do not round.
#[inline]
fn in_units_of<const N: usize>(
    mut terms: [f64; N],
    lo: f64,
    hi: f64,
    solve: impl FnOnce([f64; N], f64, f64) -> Roots,
) -> Roots {
    let unit = power_of_two_below(lo.abs().max(hi.abs()));
    let (mut power, mut sum) = (1.0, 0.0);
    for term in &mut terms {
        *term *= power;
        power *= unit;
        sum += term.abs();
    }
    if sum == 0.0 || !sum.is_finite() {
        return Roots::new();
    }
    let scale = 1.0 / power_of_two_below(sum);
    let mut roots = solve(terms.map(|term| term * scale), lo / unit, hi / unit);
    roots.iter_mut().for_each(|root| *root *= unit);
    roots
}

/// The largest power of two not above `x` > 0; the smallest normal number for zero and subnormal ones.
#[inline]
fn power_of_two_below(x: f64) -> f64 {
    const EXPONENT_BITS: u64 = 0x7ff0_0000_0000_0000;
    f64::from_bits(x.max(f64::MIN_POSITIVE).to_bits() & EXPONENT_BITS)
}

#[inline]
fn unscaled_cubic([d, c, b, a]: [f64; 4], lo: f64, hi: f64) -> Roots {
    // Roots of the derivative outside the interval, infinite or NaN for a = 0, do not split it.
    let all = quadratic(3.0 * a, b, c).into_iter().flatten();
    let critical: Roots = all.filter(|t| (lo..=hi).contains(t)).collect();
    roots_of_pieces([d, c, b, a], lo, hi, &critical)
}

/// The roots of a polynomial that is monotonic between the ends and the `critical` points.
#[inline]
fn roots_of_pieces<const N: usize>(
    coefficients: [f64; N],
    lo: f64,
    hi: f64,
    critical: &[f64],
) -> Roots {
    let mut roots = Roots::new();
    let mut left = lo;
    let mut left_is_negative = polynomial(&coefficients, lo).0 < 0.0;
    for &right in critical.iter().chain([&hi]) {
        let right_is_negative = polynomial(&coefficients, right).0 < 0.0;
        if left_is_negative != right_is_negative {
            roots.push(bracketed_root(left, right, |t| polynomial(&coefficients, t)));
        }
        (left, left_is_negative) = (right, right_is_negative);
    }
    roots
}

/// Value and derivative at `t`, by Horner's rule.
#[inline]
fn polynomial<const N: usize>(coefficients: &[f64; N], t: f64) -> (f64, f64) {
    coefficients
        .iter()
        .rev()
        .fold((0.0, 0.0), |(value, slope), c| (value * t + c, slope * t + value))
}

/// The root in [`lo`, `hi`] of a function whose sign differs between the ends (zero counts as positive); `f` gives
/// value and derivative. Newton's method, replaced by bisection where it would leave the bracket or not halve the step.
pub fn bracketed_root(lo: f64, hi: f64, f: impl Fn(f64) -> (f64, f64)) -> f64 {
    // Usually 5 to 10 steps; a root 2^-k of the interval long needs some 2.4 k (Newton's method on t⁴: 3/4 a step).
    const MAX_STEPS: u32 = 1000;
    let (mut lo, mut hi) = (lo, hi);
    let at_lo = f(lo).0;
    if at_lo == 0.0 {
        return lo;
    }
    let rises = at_lo < 0.0;
    let mut t = 0.5 * (lo + hi);
    let mut last_step = hi - lo;
    for _ in 0..MAX_STEPS {
        let (value, slope) = f(t);
        if value == 0.0 {
            return t;
        }
        if (value < 0.0) == rises {
            lo = t;
        } else {
            hi = t;
        }
        let newton = t - value / slope;
        let good = newton >= lo && newton <= hi && (newton - t).abs() <= 0.5 * last_step;
        let next = if good { newton } else { 0.5 * (lo + hi) };
        last_step = (next - t).abs();
        t = next;
        if last_step <= f64::EPSILON * t.abs() {
            break;
        }
    }
    t
}

/// Where a convex function falls through zero and where it rises through it again, in [`lo`, `hi`];
/// `f` gives value and derivative (any one-sided one at a kink). If it is not negative at either
/// end, both exist or neither.
///
/// Newton's method never oversteps a root of a convex function from outside: from the two ends it walks to the two
/// roots, or past the other end where there are none.
pub fn convex_roots(lo: f64, hi: f64, f: impl Fn(f64) -> (f64, f64)) -> [Option<f64>; 2] {
    match (f(lo).0 < 0.0, f(hi).0 < 0.0) {
        (true, true) => [None, None],
        // The sign differs between the ends: a root missed by rounding lies at the end where it is
        // negative.
        (true, false) => [None, Some(newton_inward(hi, lo, &f).unwrap_or(lo))],
        (false, true) => [Some(newton_inward(lo, hi, &f).unwrap_or(hi)), None],
        (false, false) => {
            let enter = newton_inward(lo, hi, &f);
            let leave = enter.and_then(|enter| newton_inward(hi, enter, &f));
            [leave.and(enter), leave]
        }
    }
}

/// The root of a convex function that is first met from `from`, where it is not negative, toward `limit`.
fn newton_inward(from: f64, limit: f64, f: impl Fn(f64) -> (f64, f64)) -> Option<f64> {
    // Quadratic convergence, but a factor of 1/2 where two roots nearly meet: 53 steps and a few
    // more.
    const MAX_STEPS: u32 = 128;
    let inward = (limit - from).signum();
    let mut t = from;
    for _ in 0..MAX_STEPS {
        let (value, slope) = f(t);
        if value < 0.0 {
            // One rounding past the root.
            return Some(t);
        }
        if value > 0.0 && slope * inward >= 0.0 {
            return None;
        }
        let next = t - value / slope;
        if (next - limit) * inward > 0.0 {
            return None;
        }
        let step = (next - t) * inward;
        // 0/0: a root of even order.
        if step <= f64::EPSILON * t.abs() || step.is_nan() {
            return Some(t);
        }
        t = next;
    }
    Some(t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    /// The real roots of a polynomial of degree 4 or less; those of degree 3 or less by both functions.
    fn polynomial_roots(coefficients: &[f64], lo: f64, hi: f64) -> Roots {
        let padded = |i: usize| coefficients.get(i).copied().unwrap_or(0.0);
        let roots = quartic(std::array::from_fn(padded), lo, hi);
        if coefficients.len() < 5 {
            let same = cubic(std::array::from_fn(padded), lo, hi);
            assert_eq!(roots.len(), same.len(), "{coefficients:?}");
        }
        roots
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

        #[test]
        fn convex_roots_agree_with_the_quadratic(a in 0.1..10.0f64, left in -1.0..1.0f64, width in 1e-6..2.0f64) {
            let f = |t: f64| (a * (t - left) * (t - left - width), a * (2.0 * t - 2.0 * left - width));
            let [enter, leave] = convex_roots(-4.0, 4.0, f);
            prop_assert!((enter.unwrap() - left).abs() < 1e-14 && (leave.unwrap() - left - width).abs() < 1e-14);
            let middle = left + 0.5 * width;
            prop_assert_eq!(convex_roots(-4.0, middle, f), [enter, None]);
            prop_assert_eq!(convex_roots(middle, 4.0, f)[0], None);
            prop_assert!((convex_roots(middle, 4.0, f)[1].unwrap() - leave.unwrap()).abs() < 1e-14);
        }
    }

    #[test]
    fn a_root_at_an_end_of_its_bracket_is_found_there() {
        let line = |t: f64| (t - 1.0, 1.0);
        assert_eq!(bracketed_root(1.0, 5.0, line), 1.0);
        assert_eq!(bracketed_root(-5.0, 1.0, line), 1.0);
    }

    #[test]
    fn only_roots_inside_the_interval_are_given() {
        let coefficients = with_roots(&[-2.0, -1.0, 1.0, 2.0]);
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

    #[test]
    fn a_convex_function_without_roots_has_none() {
        assert_eq!(convex_roots(-3.0, 5.0, |t| (t * t + 1e-9, 2.0 * t)), [None, None]);
        assert_eq!(
            convex_roots(-3.0, 5.0, |t| ((t - 8.0) * (t - 9.0), 2.0 * t - 17.0)),
            [None, None]
        );
    }
}
