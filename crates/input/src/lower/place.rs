//! Placements: frames in space or at a flat face.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::spec::placement::{FacePlacementSpec, PlacementSpec, SpacePlacementSpec};
use glam::DVec3;
use lumiduct_base::math::Frame;

/// The direction in which a thing at a face points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Facing {
    /// Away from the face: a solid or sheet extends from it.
    Away,
    /// At the face: a source shines on it, a sensor looks at it.
    Toward,
}

impl Context<'_> {
    /// The frame of a placement, relative to the scene's origin; by default at the user's origin.
    /// `key` is that of the thing.
    pub(super) fn place(
        &mut self,
        at: Option<&PlacementSpec>,
        key: &Key,
        facing: Facing,
    ) -> Option<Frame> {
        match at {
            None => Some(Frame::WORLD.shifted(-self.builder.scene().origin)),
            Some(PlacementSpec::InSpace(space)) => self.in_space(space, &key.field("at")),
            Some(PlacementSpec::AtFace(at)) => self.at_face(at, &key.field("at"), facing),
        }
    }

    fn in_space(&mut self, space: &SpacePlacementSpec, key: &Key) -> Option<Frame> {
        let origin = DVec3::from(space.position_mm) - self.builder.scene().origin;
        let axis = self.direction(space.axis, &key.field("axis"))?.normalize();
        let frame = match space.x_axis {
            None => Frame::from_axis(origin, axis),
            Some(x_axis) => {
                let key = key.field("x_axis");
                let x_axis = self.direction(x_axis, &key)?;
                let frame = Frame::from_axis_and_x(origin, axis, x_axis);
                if frame.is_none() {
                    let message = "points along the axis, expected another direction";
                    self.problems.error(&key, message);
                }
                frame?
            }
        };
        Some(rolled(frame, space.roll_deg))
    }

    fn direction(&mut self, direction: [f64; 3], key: &Key) -> Option<DVec3> {
        let direction = DVec3::from(direction);
        let largest = direction.abs().max_element();
        if largest == 0.0 {
            self.problems.error(key, "has no direction: all three numbers are 0");
            return None;
        }
        // Of some directions the square overflows or vanishes.
        Some(direction.try_normalize().map_or(direction / largest, |_| direction))
    }

    fn at_face(&mut self, at: &FacePlacementSpec, key: &Key, facing: Facing) -> Option<Frame> {
        let key = key.field("face");
        let faces = self.faces_named(&at.face, &key)?;
        let plane = match faces.as_slice() {
            [face] => self.builder.scene().face_plane(*face),
            _ => None,
        };
        let Some(plane) = plane else {
            let message = format!("`{}` is not a single flat face", at.face);
            return self.refuse(&key, message, "use position_mm and axis instead");
        };
        let origin = plane.origin
            + at.offset_mm[0] * plane.x
            + at.offset_mm[1] * plane.y
            + at.gap_mm * plane.z;
        let frame = match facing {
            Facing::Away => Frame { origin, ..plane },
            // Half a turn about x.
            Facing::Toward => Frame { origin, x: plane.x, y: -plane.y, z: -plane.z },
        };
        Some(rolled(frame, at.roll_deg))
    }
}

/// A frame turned about its axis.
fn rolled(frame: Frame, roll_deg: f64) -> Frame {
    if roll_deg == 0.0 {
        return frame;
    }
    let (sin, cos) = roll_deg.to_radians().sin_cos();
    Frame { x: cos * frame.x + sin * frame.y, y: cos * frame.y - sin * frame.x, ..frame }
}
