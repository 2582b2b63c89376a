//! The local axes of a face: u and v of its unrolled coordinates, and its normal.
//!
//! Maps, patterns and positions on a face all refer to them; they are found from the chart itself,
//! whatever the shape.

use crate::scene::shape::ChartRect;
use crate::scene::{FaceId, Patch, Scene};
use glam::{DVec2, DVec3};

/// Steps of a grid in search of the origin of a chart, along each side.
const STEPS: u32 = 16;
/// Number of refinements of the grid.
const ROUNDS: u32 = 24;
/// Size of the grid relative to the previous one, 1.
const FINER: f64 = 0.35;
/// Step by which the sense of u is found, in sizes of the chart, 1.
const STEP: f64 = 1e-6;

/// Origin and directions of the unrolled coordinates of a face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FaceAxes {
    /// The point with (u, v) = [`Self::at`], mm.
    pub origin: DVec3,
    /// Coordinates of the origin, mm: (0, 0), or the nearest point to it on a face that does not
    /// reach that far.
    pub at: DVec2,
    /// Unit tangent along which u grows.
    pub u: DVec3,
    /// Unit tangent along which v grows.
    pub v: DVec3,
    /// Unit normal: the front.
    pub normal: DVec3,
    /// The range of the coordinates, mm.
    pub rect: ChartRect,
}

impl Scene {
    /// The axes of a face; `None` for a curved face of a mesh, which has no unrolled coordinates.
    pub fn face_axes(&self, face: FaceId) -> Option<FaceAxes> {
        let rect = self.face_rect(face)?;
        let beyond = |patch: &&Patch| {
            let own = patch.chart_bounds();
            DVec2::ZERO.clamp(own.min, own.max).length()
        };
        let nearest = self
            .face_patches(face)
            .iter()
            .min_by(|one, other| beyond(one).total_cmp(&beyond(other)));
        match nearest {
            Some(patch) => Some(patch_axes(patch, rect)),
            None => self.face_plane(face).map(|plane| FaceAxes {
                origin: plane.origin,
                at: DVec2::ZERO,
                u: plane.x,
                v: plane.y,
                normal: plane.z,
                rect,
            }),
        }
    }
}

fn patch_axes(patch: &Patch, rect: ChartRect) -> FaceAxes {
    let origin = match patch.shape.as_flat() {
        // The middle of a ring is not one of its points.
        Some(flat) if patch.chart.is_none() => flat.frame().origin,
        Some(_) | None => nearest_to_origin(patch),
    };
    let (normal, v) = (patch.shape.normal(origin), patch.along(origin));
    let across = v.cross(normal);
    let step = STEP * (rect.max - rect.min).max_element();
    let at = patch.chart(origin);
    let [ahead, behind] = [1.0, -1.0].map(|sign| {
        let moved = patch.chart(origin + sign * step * across).x - at.x;
        sign * moved
    });
    // The seam, where u jumps by a turn, may lie on one side of the origin.
    let grows = if ahead.abs() < behind.abs() { ahead } else { behind };
    FaceAxes { origin, at, u: if grows < 0.0 { -across } else { across }, v, normal, rect }
}

/// The point of a patch whose coordinates come nearest to (0, 0).
fn nearest_to_origin(patch: &Patch) -> DVec3 {
    let off = |place: DVec2| patch.chart(patch.shape.sample(place.to_array())).length_squared();
    let (mut best, mut size) = (DVec2::splat(0.5), 1.0);
    for _ in 0..ROUNDS {
        let first = best - 0.5 * size;
        let places = (0..=STEPS).flat_map(|row| (0..=STEPS).map(move |column| (column, row)));
        let places = places.map(|(column, row)| {
            let share = DVec2::new(f64::from(column), f64::from(row)) / f64::from(STEPS);
            (first + size * share).clamp(DVec2::ZERO, DVec2::ONE)
        });
        let nearer = places.min_by(|one, other| off(*one).total_cmp(&off(*other)));
        best = nearer.filter(|place| off(*place) < off(best)).unwrap_or(best);
        size *= FINER;
    }
    patch.shape.sample(best.to_array())
}
