//! The local axes of a face: u and v of its unrolled coordinates, and its normal.
//!
//! Maps, patterns and places of a face all refer to them; they are found from the chart itself, whatever the shape.

use crate::scene::shape::{ChartRect, Shape};
use crate::scene::{FaceId, Patch, Scene};
use glam::{DVec2, DVec3};

/// Steps of a grid in search of the origin of a chart, along each side.
const STEPS: u32 = 16;
/// How often the grid is made finer.
const ROUNDS: u32 = 24;
/// Size of the grid against the one before it, 1.
const FINER: f64 = 0.35;
/// Step by which the sense of u is found, in sizes of the chart, 1.
const STEP: f64 = 1e-6;

/// Where the unrolled coordinates of a face are counted from, and which way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FaceAxes {
    /// The point with (u, v) = [`Self::at`], mm.
    pub origin: DVec3,
    /// Coordinates of the origin, mm: (0, 0), or what comes nearest to it on a face that does not reach so far.
    pub at: DVec2,
    /// Unit tangent along which u grows.
    pub u: DVec3,
    /// Unit tangent along which v grows.
    pub v: DVec3,
    /// Unit normal: the front.
    pub normal: DVec3,
    /// What the coordinates cover, mm.
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
    let origin = match (&patch.shape, &patch.chart) {
        // The middle of a ring is none of its points.
        (Shape::Flat(flat), None) => flat.frame().origin,
        (
            Shape::Flat(_)
            | Shape::Cylinder(_)
            | Shape::Cone(_)
            | Shape::Torus(_)
            | Shape::Sphere(_)
            | Shape::Paraboloid(_)
            | Shape::ParabolicCylinder(_)
            | Shape::CompoundParabola(_),
            _,
        ) => nearest_to_origin(patch),
    };
    let (normal, v) = (patch.shape.normal(origin), patch.along(origin));
    let across = v.cross(normal);
    let step = STEP * (rect.max - rect.min).max_element();
    let at = patch.chart(origin);
    let [ahead, behind] = [1.0, -1.0].map(|sign| {
        let moved = patch.chart(origin + sign * step * across).x - at.x;
        sign * moved
    });
    // On one side of the origin there may be the seam, where u jumps by a turn.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::{Settings, load};

    /// Every kind of shape and of chart, all of them somewhere off the axes of the scene.
    const FACES: &str = r#"
lumiduct = 1
title = "axes"
[media.glass]
index = 1.5
[finishes]
film = { specular = { reflectance = 0.9 } }
[solids.rod.cylinder]
radius_mm = 2
length_mm = 10
medium = "glass"
at = { position_mm = [3, -1, 2], axis = [1, 2, -1] }
[solids.bar.box]
size_mm = [4, 3, 20]
medium = "glass"
at = { position_mm = [30, 0, 0], axis = [1, 0, 1] }
[solids.bent.sweep]
profile = { rectangle = { width_mm = 4, height_mm = 2 } }
path = [{ straight_mm = 8 }, { bend_deg = 60, radius_mm = 9, toward_deg = 90 }, { straight_mm = 5 }]
medium = "glass"
at = { position_mm = [-30, 0, 0] }
[solids.dome.sphere]
radius_mm = 5
medium = "glass"
at = { position_mm = [0, 40, 0], axis = [0, 1, 1] }
[solids.head.lens]
diameter_mm = 4
thickness_mm = 1.6
exit_radius_mm = -2.5
medium = "glass"
at = { position_mm = [0, -40, 0], axis = [1, 1, 0] }
[sheets.funnel.tube]
profile = { circle = { radius_mm = 4 } }
path = [{ straight_mm = 10, end_scale = 0.5 }, { bend_deg = 90, radius_mm = 8, toward_deg = 30 }]
finish = "film"
at = { position_mm = [60, 0, 0] }
[sheets.ring.annulus]
inner_radius_mm = 3
outer_radius_mm = 6
finish = "film"
at = { position_mm = [80, 0, 0], axis = [0, 1, 0] }
[sources.led.point]
at = { position_mm = [0, 0, 100] }
flux_lm = 1
[sensors]
free = { plane = { rectangle = { width_mm = 3, height_mm = 2 }, cells = [3, 2] }, at = { position_mm = [0, 0, 50], axis = [1, 0, 1], roll_deg = 20 } }
"#;

    fn faces() -> Scene {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("axes.toml");
        std::fs::write(&path, FACES).unwrap();
        load(&path, &Settings::default()).unwrap().scene
    }

    #[test]
    fn axes_are_those_of_the_chart() {
        let scene = faces();
        for (index, face) in scene.faces.iter().enumerate() {
            let axes = scene.face_axes(FaceId::new(index)).unwrap();
            let (size, name) = ((axes.rect.max - axes.rect.min).length(), &face.name);
            let wanted = DVec2::ZERO.clamp(axes.rect.min, axes.rect.max);
            assert!(axes.at.distance(wanted) < 1e-6 * size, "{name}: {axes:?}");
            assert!(axes.u.dot(axes.v).abs() + axes.u.dot(axes.normal).abs() < 1e-9, "{name}");
            // A step inward from the origin, where the face goes on.
            let patches = scene.face_patches(FaceId::new(index));
            let middle = 0.5 * (axes.rect.min + axes.rect.max);
            let inward = middle - axes.at;
            let inward = DVec2::new(1f64.copysign(inward.x), 1f64.copysign(inward.y));
            let step = 1e-4 * size;
            let point = axes.origin + step * (inward.x * axes.u + inward.y * axes.v);
            let moved = patches
                .iter()
                .map(|patch| (patch.chart(point) - axes.at) * inward)
                .min_by(|a, b| a.length().total_cmp(&b.length()))
                .unwrap();
            assert!(moved.cmpgt(DVec2::splat(0.3 * step)).all(), "{name}: {moved} of {step}");
        }
    }

    #[test]
    fn directions_and_placements_at_flat_faces_have_the_axes_of_maps() {
        let scene = faces();
        let mut flat = 0;
        for index in 0..scene.faces.len() {
            let face = FaceId::new(index);
            let (Some(axes), Some(plane)) = (scene.face_axes(face), scene.face_plane(face)) else {
                continue;
            };
            let name = &scene.faces[index].name;
            flat += 1;
            assert!(axes.normal.distance(plane.z) < 1e-12, "{name}");
            assert!(axes.u.distance(plane.x) < 1e-9, "{name}: u {} x {}", axes.u, plane.x);
            assert!(axes.v.distance(plane.y) < 1e-9, "{name}: v {} y {}", axes.v, plane.y);
        }
        assert!(flat > 10);
    }
}
