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
        let Some(axis) = DVec3::from(space.axis).try_normalize() else {
            self.problems
                .error(&key.field("axis"), "a direction of length zero")
                .hint("for example [0, 0, 1]");
            return None;
        };
        let frame = match space.x_axis {
            None => Frame::from_axis(origin, axis),
            Some(x) => match Frame::from_axis_and_x(origin, axis, DVec3::from(x)) {
                Some(frame) => frame,
                None => {
                    self.problems
                        .error(&key.field("x_axis"), "is parallel to the axis, or of length zero");
                    return None;
                }
            },
        };
        Some(rolled(frame, space.roll_deg))
    }

    fn at_face(&mut self, at: &FacePlacementSpec, key: &Key, facing: Facing) -> Option<Frame> {
        let faces = self.faces_named(&at.face, &key.field("face"))?;
        let scene = self.builder.scene();
        let plane = match faces.as_slice() {
            [face] => scene.face_plane(*face),
            _ => None,
        };
        let Some(plane) = plane else {
            self.problems
                .error(&key.field("face"), format!("`{}` is not a single flat face", at.face))
                .hint("use position_mm and axis instead");
            return None;
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
