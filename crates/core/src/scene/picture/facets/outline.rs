//! Outlines of the elements of patterns, for pictures alone.

use crate::scene::pattern::{ElementOutline, Pattern};
use crate::scene::picture::facets::{FaceFacets, Triangulation};
use crate::scene::shape::{Cylinder, Shape};
use crate::scene::{FaceId, Scene};
use glam::{DMat2, DVec2, DVec3};
use lumiduct_base::math::Frame;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Corners of a round outline.
const ROUND: usize = 12;
/// Sides of a rectangle have a corner after each such share of the face that they lie on, 1,
/// because it may be curved.
const SIDE: f64 = 1.0 / 24.0;

impl Scene {
    /// The outlines of the elements of a pattern; beyond `most`, only those of every second, third
    /// and so on. Elements with relief are pieces of their face, and have none here.
    pub fn element_outlines(&self, pattern: &Pattern, most: usize) -> FaceFacets {
        let mut facets = Triangulation::default();
        if let ElementOutline::Relief(_) = pattern.field.outline {
            return FaceFacets { facets, one_in: 1 };
        }
        let one_in = (pattern.field.count().div_ceil(most as u64)).max(1) as usize;
        let Some(unrolled) = UnrolledFace::of(self, pattern.face) else {
            return FaceFacets { facets, one_in };
        };
        let size = self.face_rect(pattern.face).map_or(DVec2::INFINITY, |rect| rect.max - rect.min);
        for (place, middle) in pattern.field.places().step_by(one_in) {
            let corners = corners(&pattern.field.outline, place, size);
            let from = facets.points.len();
            facets.rims.push((from..from + corners.len()).chain([from]).collect());
            facets.points.extend(corners.into_iter().map(|from| unrolled.point(middle + from)));
        }
        FaceFacets { facets, one_in }
    }
}

/// Corners of the outline of an element in a row, mm from its middle. One that goes all around a
/// face is as wide as the face.
fn corners(outline: &ElementOutline, place: f64, size: DVec2) -> Vec<DVec2> {
    let half = 0.5 * outline.size(place).min(size);
    match outline {
        ElementOutline::Circle { .. } => (0..ROUND)
            .map(|corner| half * DVec2::from_angle(corner as f64 / ROUND as f64 * TAU))
            .collect(),
        ElementOutline::Rectangle { .. } | ElementOutline::Relief(_) => {
            let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
            let corners = corners.map(|corner| half * DVec2::from(corner));
            let side = |index: usize| {
                let (from, to) = (corners[index], corners[(index + 1) % 4]);
                let steps = ((to - from) / (SIDE * size)).abs().max_element().ceil().max(1.0);
                (0..steps as usize).map(move |step| from.lerp(to, step as f64 / steps))
            };
            (0..4).flat_map(side).collect()
        }
    }
}

/// A face with the inverse of its unrolled coordinates, which are those of its shape up to
/// position, scale and order.
struct UnrolledFace<'a> {
    surface: PatternSurface<'a>,
    /// A point of the shape, in its own coordinates, mm, with its unrolled coordinates.
    from: [DVec2; 2],
    /// Own coordinates for unrolled ones.
    back: DMat2,
}

/// A surface that patterns may lie on.
enum PatternSurface<'a> {
    Plane(Frame),
    Wall(&'a Cylinder),
}

impl<'a> UnrolledFace<'a> {
    fn of(scene: &'a Scene, face: FaceId) -> Option<Self> {
        let patch = scene.face_patches(face).first();
        let surface = match patch.map(|patch| &patch.shape) {
            Some(Shape::Cylinder(wall)) => PatternSurface::Wall(wall),
            Some(_) | None => PatternSurface::Plane(scene.face_plane(face)?),
        };
        // Far from the seam of a round wall.
        let (start, step) = match &surface {
            PatternSurface::Plane(_) => (DVec2::ZERO, 1.0),
            PatternSurface::Wall(wall) => {
                (DVec2::new(FRAC_PI_2 * wall.radius(), 0.0), wall.radius())
            }
        };
        let chart = |own: DVec2| match patch {
            Some(patch) => patch.chart(surface.point(own)),
            None => own,
        };
        let along = |axis: DVec2| (chart(start + step * axis) - chart(start)) / step;
        let back = DMat2::from_cols(along(DVec2::X), along(DVec2::Y)).inverse();
        let from = [start, chart(start)];
        Some(Self { surface, from, back })
    }

    /// The point with these unrolled coordinates, mm.
    fn point(&self, at: DVec2) -> DVec3 {
        let [own, start] = self.from;
        self.surface.point(own + self.back * (at - start))
    }
}

impl PatternSurface<'_> {
    fn point(&self, own: DVec2) -> DVec3 {
        match self {
            Self::Plane(frame) => frame.point_to_world(own.extend(0.0)),
            Self::Wall(wall) => wall.unrolled(own),
        }
    }
}
