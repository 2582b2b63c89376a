//! Faces: the named parts of solids and sheets, and the smooth pieces they are made of.

use crate::scene::shape::Shape;
use crate::scene::{FaceId, FinishId, SolidId};
use glam::{DVec2, DVec3};
use std::ops::Range;

/// What a face belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Owner {
    /// The boundary of a solid; its front is outside.
    Solid(SolidId),
    /// An open, two-sided sheet.
    Sheet,
    /// Nothing is there: the open end of a tube, or a virtual sensor.
    Port,
}

/// A named part of a solid or sheet, such as `pipe.exit`.
#[derive(Debug, Clone)]
pub struct Face {
    /// Dotted name.
    pub name: String,
    /// What it belongs to.
    pub owner: Owner,
    /// Finish met from the front; `None` is the smooth interface of the two media, not declared.
    pub front: Option<FinishId>,
    /// Finish met from the back.
    pub back: Option<FinishId>,
    /// Its pieces in the scene's table of patches (of ports, for a port).
    pub patches: Range<usize>,
}

/// A smooth piece of a face.
#[derive(Debug, Clone)]
pub struct Patch {
    /// The surface.
    pub shape: Shape,
    /// The face it belongs to.
    pub face: FaceId,
    /// What the face belongs to.
    pub owner: Owner,
    /// Tangent-continuous patches share this number.
    pub smooth: u32,
    /// Leads from the shape's chart to that of the whole face, mm.
    pub chart_offset: DVec2,
}

impl Patch {
    /// Unrolled coordinates on the face, mm.
    pub fn chart(&self, p: DVec3) -> DVec2 {
        self.shape.chart(p) + self.chart_offset
    }
}
