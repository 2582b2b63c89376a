//! Which way the triangles of a part of a mesh face, as a cone around their normals.
//!
//! Light within a body only leaves it, so that a box need not be opened if all triangles in it face against the light, as most of
//! those around the start of a ray do. A cone of directions turned by a right angle bounds all lines that cross one of its
//! triangles outward (Shirman & Abi-Ezzi, "The cone of normals technique for fast processing of curved patches", Comput. Graph. Forum
//! 12 (1993) 261).

use crate::scene::crossing::tree::WIDTH;
use crate::scene::shape::Toward;
use glam::DVec3;
use wide::i16x8;

/// Cones of normals are widened by this, rad, far more than rounding can turn a triangle that is seen nearly edge-on.
const MARGIN: f64 = 2e-3;
/// Cones of greater half angles, rad, leave out nothing.
const WIDEST: f64 = 1.5;
/// An axis of length 1 in whole numbers.
const AXIS_UNIT: f64 = 16384.0;
/// A direction of length 1 in whole numbers.
const DIR_UNIT: f64 = 32767.0;
/// The product of both in the units of [`i16x8::mul_keep_high`].
const PRODUCT_UNIT: f64 = AXIS_UNIT * DIR_UNIT / 65536.0;

/// A cone of directions.
#[derive(Debug, Clone, Copy)]
pub(super) struct NormalCone {
    /// Unit vector.
    axis: DVec3,
    /// Half angle, rad.
    angle: f64,
}

impl NormalCone {
    /// All directions.
    pub(super) const ALL: Self = Self { axis: DVec3::Z, angle: f64::INFINITY };

    /// A unit normal.
    pub(super) fn of(normal: DVec3) -> Self {
        Self { axis: normal, angle: MARGIN }
    }

    /// A cone around several: about their mean axis, as wide as the farthest of them needs.
    pub(super) fn around(cones: impl Iterator<Item = Self> + Clone) -> Self {
        let sum: DVec3 = cones.clone().map(|cone| cone.axis).sum();
        let Some(axis) = sum.try_normalize() else { return Self::ALL };
        // By the chord: an angle from a cosine would be uncertain by 1e-8 where it is small.
        let of = |cone: Self| 2.0 * (0.5 * axis.distance(cone.axis)).min(1.0).asin() + cone.angle;
        Self { axis, angle: cones.map(of).fold(0.0, f64::max) }
    }
}

/// The cones of the children of a node.
///
/// A line along the unit vector d can cross a triangle with a normal in the cone around a with half angle α outward only if
/// a·d > −sin α.
#[derive(Debug, Clone)]
pub(super) struct NodeCones {
    axis: [i16x8; 3],
    sine: i16x8,
}

impl NodeCones {
    /// Cones that leave out nothing.
    pub(super) fn new() -> Self {
        Self { axis: [i16x8::ZERO; 3], sine: i16x8::splat(1) }
    }

    /// Sets the cone of a child.
    pub(super) fn set(&mut self, slot: usize, cone: &NormalCone) {
        if cone.angle > WIDEST {
            return;
        }
        let axis = (AXIS_UNIT * cone.axis).round();
        for (own, axis) in self.axis.iter_mut().zip(axis.to_array()) {
            own.as_mut_array()[slot] = axis as i16;
        }
        // Five units cover the rounding of the axis and of the direction, up to 0.43 each, and of three products, up to 1 each.
        self.sine.as_mut_array()[slot] = (PRODUCT_UNIT * cone.angle.sin()).ceil() as i16 + 5;
    }

    /// A bit for each child that a line may cross this way.
    #[inline(always)]
    pub(super) fn faced(&self, way: &FacedWay) -> u32 {
        let ([x, y, z], [dx, dy, dz]) = (&self.axis, way.dir);
        let along = x.mul_keep_high(dx) + y.mul_keep_high(dy) + z.mul_keep_high(dz);
        (along + self.sine).simd_gt(i16x8::ZERO).to_bitmask()
    }
}

/// The direction of a line that crosses triangles one way.
#[derive(Debug, Clone, Copy)]
pub(super) struct FacedWay {
    dir: [i16x8; 3],
}

impl FacedWay {
    /// A line along a unit vector.
    #[inline]
    pub(super) fn new(dir: DVec3, toward: Toward) -> Self {
        let sign = match toward {
            Toward::Front => DIR_UNIT,
            Toward::Back => -DIR_UNIT,
        };
        Self { dir: (sign * dir).to_array().map(|own| i16x8::splat(own as i16)) }
    }
}

const _: () = assert!(WIDTH == 8, "a lane for each child");

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Dimension, Sampler};
    use lumiduct_base::math::{Frame, cone_direction, uniform_sphere};
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn no_line_along_a_normal_is_left_out_and_lines_far_against_all_normals_are() {
        let (mut kept, mut left_out) = (0, 0);
        for index in 0..2000 {
            let mut sampler = Sampler::for_path(62, 0, index);
            let axis = uniform_sphere(sampler.pair(Dimension::EmitPosition));
            let width = 1.4 * sampler.one(Dimension::EmitPosition);
            let frame = Frame::from_axis(DVec3::ZERO, axis);
            let mut normal =
                || frame.to_world(cone_direction(width, sampler.pair(Dimension::EmitDirection)));
            let normals = [normal(), normal(), normal(), normal()];
            let own = NormalCone::around(normals.into_iter().map(NormalCone::of));
            let [wide, one] = [own.angle, NormalCone::of(axis).angle];
            assert!(wide >= one && normals.iter().all(|n| n.angle_between(own.axis) <= wide));
            let mut cones = NodeCones::new();
            let slot = index as usize % WIDTH;
            cones.set(slot, &own);
            for toward in [Toward::Front, Toward::Back] {
                let dir = uniform_sphere(sampler.pair(Dimension::EmitDirection));
                let faced = cones.faced(&FacedWay::new(dir, toward));
                assert_eq!(faced | 1 << slot, 0xff, "cones that are not set leave out nothing");
                let out = if toward == Toward::Front { dir } else { -dir };
                let is_faced = faced & 1 << slot != 0;
                assert!(is_faced || normals.iter().all(|normal| normal.dot(out) < 0.0));
                // Beyond the cone by more than rounding and a degree.
                let is_against = out.angle_between(own.axis) > FRAC_PI_2 + wide + 0.02;
                assert!(!(is_faced && is_against && wide < WIDEST), "{own:?} {out}");
                kept += u32::from(is_faced);
                left_out += u32::from(!is_faced);
            }
        }
        assert!(kept > 1000 && left_out > 500, "{kept} {left_out}");
    }
}
