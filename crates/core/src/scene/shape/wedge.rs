//! A range of azimuths that trims surfaces of revolution.

use glam::{DVec2, DVec3};
use lumiduct_base::math::{Aabb, Frame};
use std::f64::consts::{PI, TAU};

/// The azimuths from +x counter-clockwise to an angle below a whole turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wedge {
    angle: f64,
    /// Direction of the last azimuth.
    end: DVec2,
    width: Width,
}

/// Whether a wedge is an intersection or a union of two half planes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Width {
    /// At most half a turn: the points in both half planes.
    Narrow,
    /// More than half a turn: the points in either.
    Wide,
}

impl Wedge {
    /// The azimuths in [0, `angle`], rad; `None` for a whole turn, which trims nothing.
    pub(crate) fn new(angle: f64) -> Option<Self> {
        let width = if angle <= PI { Width::Narrow } else { Width::Wide };
        (angle < TAU).then(|| Self { angle, end: DVec2::from_angle(angle), width })
    }

    /// The last azimuth, rad.
    #[inline]
    pub(crate) fn angle(&self) -> f64 {
        self.angle
    }

    /// Whether a point's azimuth is within the wedge.
    #[inline]
    pub(crate) fn contains(&self, p: DVec2) -> bool {
        let (after_start, before_end) = (p.y >= 0.0, self.end.perp_dot(p) <= 0.0);
        match self.width {
            Width::Narrow => after_start && before_end,
            Width::Wide => after_start || before_end,
        }
    }

    /// The part of a span of a line in which it may be within the wedge, with a margin for rounding, in units of the size of
    /// the shape; it may end before it starts. A line along an end plane, and a wide wedge, clip nothing.
    #[inline]
    pub(crate) fn clip(&self, [lo, hi]: [f64; 2], from: DVec2, dir: DVec2) -> [f64; 2] {
        const MARGIN: f64 = 1e-9;
        if self.width == Width::Wide {
            return [lo, hi];
        }
        let clip = |[lo, hi]: [f64; 2], height: f64, slope: f64| {
            let at = -height / slope;
            let room = MARGIN * (1.0 + at.abs());
            if height.abs() <= MARGIN || !at.is_finite() {
                [lo, hi]
            } else if slope > 0.0 {
                [lo.max(at - room), hi]
            } else {
                [lo, hi.min(at + room)]
            }
        };
        let span = clip([lo, hi], from.y, dir.y);
        clip(span, -self.end.perp_dot(from), -self.end.perp_dot(dir))
    }

    /// Azimuth of a point of the wedge, rad; points that rounding has put outside get the nearer end.
    pub(crate) fn azimuth(&self, p: DVec2) -> f64 {
        let azimuth = azimuth(p);
        if azimuth <= self.angle {
            azimuth
        } else if azimuth - self.angle < TAU - azimuth {
            self.angle
        } else {
            0.0
        }
    }

    /// The smallest and the largest of `x cos φ + y sin φ` over the azimuths φ of the wedge.
    pub(super) fn range(&self, direction: DVec2) -> [f64; 2] {
        let (first, last) = (direction.x, direction.dot(self.end));
        let reach = direction.length();
        let min = if self.contains(-direction) { -reach } else { first.min(last) };
        let max = if self.contains(direction) { reach } else { first.max(last) };
        [min, max]
    }
}

/// Azimuth of a point from +x counter-clockwise, rad, in [0, 2π].
pub(super) fn azimuth(p: DVec2) -> f64 {
    p.y.atan2(p.x).rem_euclid(TAU)
}

/// The last azimuth of an optional wedge, rad: a whole turn without one.
pub(super) fn turn(wedge: Option<&Wedge>) -> f64 {
    wedge.map_or(TAU, Wedge::angle)
}

/// A box around the arc of `radius` at the height `z` of `frame`, mm.
pub(super) fn arc_bounds(frame: &Frame, radius: f64, z: f64, wedge: Option<&Wedge>) -> Aabb {
    let center = frame.origin + z * frame.z;
    let (mut min, mut max) = (center, center);
    for i in 0..3 {
        // The arc's coordinate i is center + radius (x_i cos φ + y_i sin φ).
        let direction = DVec2::new(frame.x[i], frame.y[i]);
        let [low, high] = match wedge {
            Some(wedge) => wedge.range(direction),
            None => [-direction.length(), direction.length()],
        };
        min[i] += radius * low;
        max[i] += radius * high;
    }
    Aabb { min, max }
}

/// The point of `frame` at `radius`, `azimuth` and height `z`.
pub(super) fn point_on_circle(frame: &Frame, radius: f64, azimuth: f64, z: f64) -> DVec3 {
    frame.point_to_world((radius * DVec2::from_angle(azimuth)).extend(z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_in_the_wedge_when_their_azimuth_is() {
        for angle in [0.3, 1.5, 3.0, 3.3, 5.0, 6.2] {
            let wedge = Wedge::new(angle).unwrap();
            for i in 0..1000 {
                let azimuth = TAU * (f64::from(i) + 0.5) / 1000.0;
                let p = 3.0 * DVec2::from_angle(azimuth);
                assert_eq!(wedge.contains(p), azimuth <= angle, "{azimuth} of {angle}");
            }
        }
        assert!(Wedge::new(TAU).is_none());
    }

    #[test]
    fn every_point_of_a_line_in_the_wedge_is_in_the_clipped_span() {
        for angle in [0.3, 1.0, 0.5 * PI, PI] {
            let wedge = Wedge::new(angle).unwrap();
            let end = DVec2::from_angle(angle);
            let (mut within, mut clipped) = (0, 0);
            for from in [DVec2::ZERO, DVec2::X, 0.7 * end, DVec2::new(-0.4, 0.8)] {
                for off in [-1e-9, 0.0, 1e-9] {
                    for slope in [-1.0, -1e-12, 0.0, 1e-12, 1.0] {
                        for along in [DVec2::X, -DVec2::X, end, -end] {
                            let (from, dir) =
                                (from + off * end.perp(), along + slope * along.perp());
                            let [lo, hi] = wedge.clip([-2.0, 2.0], from, dir);
                            clipped += usize::from(lo > -2.0 || hi < 2.0);
                            for i in 0..=400 {
                                let t = f64::from(i) / 100.0 - 2.0;
                                if wedge.contains(from + t * dir) {
                                    within += 1;
                                    assert!(
                                        lo <= t && t <= hi,
                                        "{t} of [{lo}, {hi}], {from} {dir}"
                                    );
                                }
                            }
                        }
                    }
                }
            }
            assert!(within > 1000 && clipped > 30, "{within} within, {clipped} clipped");
        }
    }

    #[test]
    fn the_box_of_an_arc_touches_it_on_every_side() {
        let frame = Frame::from_axis(DVec3::new(1.0, 2.0, 3.0), DVec3::new(0.3, -0.5, 0.8));
        for angle in [0.5, 2.0, 4.0, TAU] {
            let wedge = Wedge::new(angle);
            let bounds = arc_bounds(&frame, 2.0, 0.7, wedge.as_ref());
            let n = 100_000;
            let arc =
                Aabb::of((0..=n).map(|i| {
                    point_on_circle(&frame, 2.0, angle * f64::from(i) / f64::from(n), 0.7)
                }));
            assert!((bounds.min - arc.min).abs().max_element() < 1e-8);
            assert!((bounds.max - arc.max).abs().max_element() < 1e-8);
        }
    }

    #[test]
    fn the_azimuth_of_a_point_just_outside_is_the_nearer_end() {
        let wedge = Wedge::new(1.0).unwrap();
        assert_eq!(wedge.azimuth(DVec2::new(1.0, -1e-17)), 0.0);
        assert_eq!(wedge.azimuth(DVec2::from_angle(1.0 + 1e-15)), 1.0);
        assert!((wedge.azimuth(DVec2::from_angle(0.4)) - 0.4).abs() < 1e-15);
    }
}
