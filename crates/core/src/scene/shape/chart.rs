//! The rectangle into which a chart unrolls a surface.

use glam::DVec2;

/// A rectangle of the unrolled surface, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChartRect {
    /// Smallest (u, v).
    pub min: DVec2,
    /// Largest (u, v).
    pub max: DVec2,
}

impl ChartRect {
    /// The smallest rectangle around both.
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The common part of both rectangles; empty if they do not overlap.
    pub(crate) fn intersection(&self, other: &Self) -> Self {
        Self { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    /// Whether the rectangle has no area.
    pub(crate) fn is_empty(&self) -> bool {
        !self.min.cmplt(self.max).all()
    }

    /// Area of the rectangle itself, mm²; 0 when it is empty.
    pub(crate) fn area(&self) -> f64 {
        (self.max - self.min).max(DVec2::ZERO).element_product()
    }

    /// The point at these shares of width and height.
    pub(crate) fn at(&self, shares: [f64; 2]) -> DVec2 {
        self.min + DVec2::from(shares) * (self.max - self.min)
    }

    /// The corners, counter-clockwise from the smallest.
    pub(crate) fn corners(&self) -> [DVec2; 4] {
        let (min, max) = (self.min, self.max);
        [min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)]
    }
}
