//! The few complex numbers that the matrices of thin films need.

use std::ops::{Add, Mul, Sub};

/// A complex number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Complex {
    pub(super) re: f64,
    pub(super) im: f64,
}

impl Complex {
    pub(super) const fn new(re: f64, im: f64) -> Self {
        Self { re, im }
    }

    pub(super) const fn real(re: f64) -> Self {
        Self { re, im: 0.0 }
    }

    /// The same number times i.
    pub(super) fn times_i(self) -> Self {
        Self { re: -self.im, im: self.re }
    }

    pub(super) fn scaled(self, factor: f64) -> Self {
        Self { re: factor * self.re, im: factor * self.im }
    }

    pub(super) fn conjugate(self) -> Self {
        Self { re: self.re, im: -self.im }
    }

    /// Square of the modulus.
    pub(super) fn norm_squared(self) -> f64 {
        self.re * self.re + self.im * self.im
    }

    pub(super) fn inverse(self) -> Self {
        let norm = self.norm_squared();
        Self { re: self.re / norm, im: -self.im / norm }
    }

    /// The square root in the fourth quadrant, of a number whose imaginary part is not positive: of a wave that goes on
    /// or decays.
    pub(super) fn decaying_root(self) -> Self {
        let Self { re, im } = self;
        let modulus = re.hypot(im);
        let large = (0.5 * (modulus + re.abs())).sqrt();
        if large == 0.0 {
            return Self::real(0.0);
        }
        // The smaller part by division: the difference of modulus and real part would cancel.
        let small = 0.5 * im.abs() / large;
        if re >= 0.0 { Self::new(large, -small) } else { Self::new(small, -large) }
    }
}

impl Add for Complex {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }
}

impl Sub for Complex {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self { re: self.re - other.re, im: self.im - other.im }
    }
}

impl Mul for Complex {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self {
            re: self.re * other.re - self.im * other.im,
            im: self.re * other.im + self.im * other.re,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_decay_and_square_to_their_number() {
        for (re, im) in [(2.0, 0.0), (-2.0, 0.0), (1.0, -3.0), (-40.0, -12.0), (1e8, -1e-8)] {
            let number = Complex::new(re, im);
            let root = number.decaying_root();
            let rest = root * root - number;
            assert!(root.re >= 0.0 && root.im <= 0.0, "{root:?}");
            assert!(rest.norm_squared() <= 1e-30 * number.norm_squared(), "{number:?}: {root:?}");
        }
        assert_eq!(Complex::real(0.0).decaying_root(), Complex::real(0.0));
        let one = Complex::new(3.0, -4.0) * Complex::new(3.0, -4.0).inverse();
        assert!((one - Complex::real(1.0)).norm_squared() < 1e-30, "{one:?}");
    }
}
