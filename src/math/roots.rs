//! Real roots of polynomials, accurate to rounding also where textbook formulas cancel.

use smallvec::SmallVec;

/// The real roots of a polynomial in ascending order.
pub type Roots = SmallVec<[f64; 4]>;

/// Real roots of `a t² + 2 b t + c` (note the halved middle coefficient), ascending; a double root is given twice.
/// The form that never subtracts nearly equal numbers (Press et al., Numerical Recipes, 3rd ed., eq. 5.6.4).
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
