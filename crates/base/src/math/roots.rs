//! Real roots, accurate to rounding also where textbook formulas cancel.

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

/// The root in [`lo`, `hi`] of a function whose sign differs between the ends (zero counts as positive); `f` gives
/// value and derivative. Newton's method, replaced by bisection where it would leave the bracket or not halve the step.
pub fn bracketed_root(lo: f64, hi: f64, f: impl Fn(f64) -> (f64, f64)) -> f64 {
    // Usually 4 to 8 steps; a root 2^-k of the interval long needs some 2.4 k (Newton's method on t⁴: 3/4 a step).
    const MAX_STEPS: u32 = 1000;
    let (mut lo, mut hi) = (lo, hi);
    let (at_lo, slope) = f(lo);
    if at_lo == 0.0 {
        return lo;
    }
    let rises = at_lo < 0.0;
    let newton = lo - at_lo / slope;
    let mut t = if newton > lo && newton < hi { newton } else { 0.5 * (lo + hi) };
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

    proptest! {
        #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(41), cases: 2000, ..ProptestConfig::default() })]

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
    fn a_convex_function_without_roots_has_none() {
        assert_eq!(convex_roots(-3.0, 5.0, |t| (t * t + 1e-9, 2.0 * t)), [None, None]);
        assert_eq!(
            convex_roots(-3.0, 5.0, |t| ((t - 8.0) * (t - 9.0), 2.0 * t - 17.0)),
            [None, None]
        );
    }
}
