//! Points on the canvas, in pixels: right and down from the upper left corner.

/// A point on the canvas, pixels.
pub(crate) type Point = [f64; 2];

/// An axis-parallel rectangle, pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rect {
    /// Left edge.
    pub(crate) left: f64,
    /// Upper edge.
    pub(crate) top: f64,
    /// Right edge.
    pub(crate) right: f64,
    /// Lower edge.
    pub(crate) bottom: f64,
}

impl Rect {
    /// The rectangle with this corner and size.
    pub(crate) fn new(left: f64, top: f64, width: f64, height: f64) -> Self {
        Self { left, top, right: left + width, bottom: top + height }
    }

    /// Width, pixels.
    pub(crate) fn width(self) -> f64 {
        self.right - self.left
    }

    /// Height, pixels.
    pub(crate) fn height(self) -> f64 {
        self.bottom - self.top
    }

    /// Whether a place lies inside, or on the left or upper edge.
    pub(crate) fn contains(self, p: Point) -> bool {
        self.left <= p[0] && p[0] < self.right && self.top <= p[1] && p[1] < self.bottom
    }

    /// Whether two rectangles share more than an edge.
    pub(crate) fn meets(self, other: Self) -> bool {
        let is_beside = other.right <= self.left || self.right <= other.left;
        let is_above = other.bottom <= self.top || self.bottom <= other.top;
        !is_beside && !is_above
    }

    /// The middle.
    pub(crate) fn middle(self) -> Point {
        [0.5 * (self.left + self.right), 0.5 * (self.top + self.bottom)]
    }

    /// The rectangle with every edge moved out.
    pub(crate) fn grown(self, by: f64) -> Self {
        Self {
            left: self.left - by,
            top: self.top - by,
            right: self.right + by,
            bottom: self.bottom + by,
        }
    }
}

/// Distance of two points, pixels.
pub(crate) fn distance(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// The part of a segment inside a rectangle (Liang & Barsky, ACM Trans. Graphics 3 (1984) 1).
pub(crate) fn clip(from: Point, to: Point, rect: Rect) -> Option<[Point; 2]> {
    let along = [to[0] - from[0], to[1] - from[1]];
    let (mut first, mut last) = (0.0f64, 1.0f64);
    for (axis, low, high) in [(0, rect.left, rect.right), (1, rect.top, rect.bottom)] {
        let (near, far) = if along[axis] >= 0.0 { (low, high) } else { (high, low) };
        if along[axis] != 0.0 {
            first = first.max((near - from[axis]) / along[axis]);
            last = last.min((far - from[axis]) / along[axis]);
        } else if from[axis] < low || from[axis] > high {
            return None;
        }
    }
    let at = |t: f64| [from[0] + t * along[0], from[1] + t * along[1]];
    (first <= last).then(|| [at(first), at(last)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stretch_is_cut_at_the_edges() {
        let rect = Rect::new(0.0, 0.0, 10.0, 5.0);
        assert_eq!(clip([-5.0, 1.0], [15.0, 1.0], rect), Some([[0.0, 1.0], [10.0, 1.0]]));
        assert_eq!(clip([2.0, 9.0], [2.0, -1.0], rect), Some([[2.0, 5.0], [2.0, 0.0]]));
        assert_eq!(clip([-5.0, 1.0], [-1.0, 1.0], rect), None);
        assert_eq!(clip([0.0, 8.0], [8.0, 16.0], rect), None);
        assert_eq!(clip([1.0, 1.0], [2.0, 2.0], rect), Some([[1.0, 1.0], [2.0, 2.0]]));
    }
}
