//! Shared functions of convex surfaces: the box from the reach in each direction, and the front
//! side.

use crate::scene::shape::Toward;
use glam::DVec3;
use lumiduct_base::math::{Aabb, Frame};

/// The box around a shape given in `frame`; `reach(e)` is the largest `p · e` over its points, in the frame, mm.
pub(super) fn box_by_reach(frame: &Frame, reach: impl Fn(DVec3) -> f64) -> Aabb {
    let upward = DVec3::AXES.map(|axis| reach(frame.to_local(axis)));
    let downward = DVec3::AXES.map(|axis| reach(frame.to_local(-axis)));
    Aabb {
        min: frame.origin - DVec3::from_array(downward),
        max: frame.origin + DVec3::from_array(upward),
    }
}

/// Sine of the angle between a unit direction and the z axis: a circle of radius r about z reaches r times as far.
pub(super) fn across(e: DVec3) -> f64 {
    e.truncate().length()
}

/// The front normal of a surface that outward rays cross `leaving`.
#[inline]
pub(super) fn front(outward: DVec3, leaving: Toward) -> DVec3 {
    match leaving {
        Toward::Front => outward,
        Toward::Back => -outward,
    }
}
