//! The wall that a relief lies on, in space: from unrolled coordinates to points, and back.

use glam::{DVec2, DVec3};
use lumiduct_base::math::Frame;

/// A flat wall, or a round one all around.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReliefWall {
    /// For a flat wall, the point (0, 0) of its chart; for a round one, the point of its axis at v
    /// = 0. mm.
    pub(crate) origin: DVec3,
    /// For a flat wall, the direction of u; for a round one, from the axis toward u = 0.
    pub(crate) x: DVec3,
    /// For a flat wall, along it; for a round one, from the axis toward a quarter of a turn.
    pub(crate) y: DVec3,
    /// For a flat wall, out of the solid; for a round one, along its axis.
    pub(crate) z: DVec3,
    pub(crate) radius: Option<f64>,
}

/// A position on a wall: a point and three perpendicular directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Site {
    /// The point, mm.
    pub origin: DVec3,
    /// Across or around.
    pub across: DVec3,
    /// Along.
    pub along: DVec3,
    /// Out of the solid.
    pub out: DVec3,
}

impl Site {
    /// The point at a distance across, along and out of the wall, mm.
    pub fn at(&self, across: f64, along: f64, out: f64) -> DVec3 {
        self.origin + across * self.across + along * self.along + out * self.out
    }

    /// A frame at a point with its z out of the solid, or as given.
    pub(super) fn frame(origin: DVec3, z: DVec3, y: DVec3) -> Frame {
        Frame { origin, x: y.cross(z), y, z }
    }
}

impl ReliefWall {
    /// Whether the wall is flat.
    pub fn is_flat(&self) -> bool {
        self.radius.is_none()
    }

    /// Unrolled coordinates (u, v) of a point, and its height over the wall, mm.
    #[inline]
    pub fn unroll(&self, p: DVec3) -> DVec3 {
        let from = p - self.origin;
        let local = DVec3::new(from.dot(self.x), from.dot(self.y), from.dot(self.z));
        match self.radius {
            None => local,
            Some(radius) => {
                let around = local.y.atan2(local.x).rem_euclid(std::f64::consts::TAU);
                DVec3::new(radius * around, local.z, local.truncate().length() - radius)
            }
        }
    }

    /// The position on the wall with unrolled coordinates (u, v), mm.
    pub fn site(&self, at: DVec2) -> Site {
        match self.radius {
            None => Site {
                origin: self.origin + at.x * self.x + at.y * self.y,
                across: self.x,
                along: self.y,
                out: self.z,
            },
            Some(radius) => {
                let (sin, cos) = (at.x / radius).sin_cos();
                let out = cos * self.x + sin * self.y;
                let across = cos * self.y - sin * self.x;
                let origin = self.origin + radius * out + at.y * self.z;
                Site { origin, across, along: self.z, out }
            }
        }
    }
}
