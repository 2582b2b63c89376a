//! Local frames: +z is the normal.

use glam::DVec3;

/// An orthonormal, right-handed frame at a point; +z of the frame is the normal or axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Origin of the frame in the parent frame, mm.
    pub origin: DVec3,
    /// Unit x axis.
    pub x: DVec3,
    /// Unit y axis.
    pub y: DVec3,
    /// Unit z axis: the normal.
    pub z: DVec3,
}

impl Frame {
    /// The frame of the parent itself.
    pub const WORLD: Self = Self { origin: DVec3::ZERO, x: DVec3::X, y: DVec3::Y, z: DVec3::Z };

    /// A frame whose z is `axis`; x and y are chosen without a seam except at axis = -z
    /// (Duff et al., JCGT 6 (2017) 1, listing 3), and are the parent's x and y for axis = +z.
    pub fn from_axis(origin: DVec3, axis: DVec3) -> Self {
        let z = axis.normalize();
        let sign = 1.0f64.copysign(z.z);
        let a = -1.0 / (sign + z.z);
        let b = z.x * z.y * a;
        let x = DVec3::new(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x).normalize();
        Self { origin, x, y: z.cross(x), z }
    }

    /// A frame whose z is `axis` and whose x lies in the half plane of `axis` and `toward`;
    /// `None` when the two are parallel.
    pub fn from_axis_and_x(origin: DVec3, axis: DVec3, toward: DVec3) -> Option<Self> {
        let z = axis.normalize();
        let x = toward - toward.dot(z) * z;
        // 1e-9 rad: below this the direction of x is rounding noise.
        if x.length() < 1e-9 * toward.length() {
            return None;
        }
        let x = x.normalize();
        Some(Self { origin, x, y: z.cross(x), z })
    }

    /// A direction of the parent in this frame.
    #[inline]
    pub fn to_local(&self, v: DVec3) -> DVec3 {
        DVec3::new(v.dot(self.x), v.dot(self.y), v.dot(self.z))
    }

    /// A direction of this frame in the parent.
    #[inline]
    pub fn to_world(&self, v: DVec3) -> DVec3 {
        v.x * self.x + v.y * self.y + v.z * self.z
    }

    /// A point of the parent in this frame.
    #[inline]
    pub fn point_to_local(&self, p: DVec3) -> DVec3 {
        self.to_local(p - self.origin)
    }

    /// A point of this frame in the parent.
    #[inline]
    pub fn point_to_world(&self, p: DVec3) -> DVec3 {
        self.origin + self.to_world(p)
    }

    /// The same frame at a point shifted by `offset` of the parent.
    pub fn shifted(&self, offset: DVec3) -> Self {
        Self { origin: self.origin + offset, ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig { rng_seed: proptest::test_runner::RngSeed::Fixed(11), ..ProptestConfig::default() })]
        #[test]
        fn frames_are_orthonormal_and_round_trip(x in -1.0..1.0f64, y in -1.0..1.0f64, z in -1.0..1.0f64) {
            prop_assume!(DVec3::new(x, y, z).length() > 1e-3);
            let frame = Frame::from_axis(DVec3::new(3.0, -2.0, 5.0), DVec3::new(x, y, z));
            prop_assert!((frame.x.cross(frame.y) - frame.z).length() < 1e-14);
            let p = DVec3::new(0.3, 0.7, -1.1);
            prop_assert!((frame.point_to_local(frame.point_to_world(p)) - p).length() < 1e-14);
        }
    }

    #[test]
    fn the_frame_of_plus_z_is_the_world() {
        assert_eq!(Frame::from_axis(DVec3::ZERO, DVec3::Z), Frame::WORLD);
    }

    #[test]
    fn a_parallel_x_is_refused() {
        assert!(Frame::from_axis_and_x(DVec3::ZERO, DVec3::Z, DVec3::Z * 3.0).is_none());
    }
}
