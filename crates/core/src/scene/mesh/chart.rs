//! Flat faces of a mesh unroll into their plane.

use crate::scene::mesh::Mesh;
use crate::scene::shape::ChartRect;
use glam::{DVec2, DVec3};
use lumiduct_base::math::Frame;
use lumiduct_base::mesh::area_vector;
use smallvec::SmallVec;

/// A triangle cut by the four sides of a rectangle has at most seven corners.
type Outline = SmallVec<[DVec2; 8]>;

impl Mesh {
    /// The plane of a flat face: origin at the centroid, z outward. `None` if a vertex lies off the
    /// plane by more than single precision explains (2^-22 of the largest coordinate in the file),
    /// or if facets face opposite ways.
    pub(crate) fn chart_plane(&self, face: usize) -> Option<Frame> {
        let triangles = || self.face_triangles(face).iter().map(|index| *index as usize);
        let normal = triangles().map(|triangle| area_vector(self.corners(triangle))).sum::<DVec3>();
        let normal = normal.try_normalize()?;
        let center = triangles()
            .map(|triangle| self.area(triangle) * self.corners(triangle).iter().sum::<DVec3>())
            .sum::<DVec3>()
            / (3.0 * self.face_area(face));
        let flat = triangles().all(|triangle| {
            let corners = self.corners(triangle);
            area_vector(corners).dot(normal) >= 0.0
                && corners.iter().all(|p| (*p - center).dot(normal).abs() <= self.flatness)
        });
        flat.then(|| Frame::from_axis(center, normal))
    }

    /// The rectangle that a face covers in the plane z = 0 of a frame, mm.
    pub(crate) fn chart_bounds(&self, face: usize, plane: &Frame) -> ChartRect {
        let empty = ChartRect { min: DVec2::INFINITY, max: DVec2::NEG_INFINITY };
        self.outlines(face, plane)
            .flatten()
            .fold(empty, |rect, p| ChartRect { min: rect.min.min(p), max: rect.max.max(p) })
    }

    /// Area of a flat face whose chart in `plane` lies in `rect`, mm².
    pub(crate) fn chart_area_in(&self, face: usize, plane: &Frame, rect: ChartRect) -> f64 {
        self.outlines(face, plane)
            .map(|triangle| {
                let outline = clip(triangle.into_iter().collect(), |p| p.x - rect.min.x);
                let outline = clip(outline, |p| rect.max.x - p.x);
                let outline = clip(outline, |p| p.y - rect.min.y);
                area(&clip(outline, |p| rect.max.y - p.y))
            })
            .sum()
    }

    fn outlines(&self, face: usize, plane: &Frame) -> impl Iterator<Item = [DVec2; 3]> {
        self.face_triangles(face).iter().map(move |triangle| {
            self.corners(*triangle as usize).map(|p| plane.point_to_local(p).truncate())
        })
    }
}

/// The part of a convex outline where `inside` is not negative; `inside` is linear
/// (Sutherland & Hodgman, Commun. ACM 17 (1974) 32).
fn clip(outline: Outline, inside: impl Fn(DVec2) -> f64) -> Outline {
    let mut kept = Outline::new();
    for (index, &to) in outline.iter().enumerate() {
        let from = outline[(index + outline.len() - 1) % outline.len()];
        let (at_from, at_to) = (inside(from), inside(to));
        if (at_from < 0.0) != (at_to < 0.0) {
            kept.push(from + at_from / (at_from - at_to) * (to - from));
        }
        if at_to >= 0.0 {
            kept.push(to);
        }
    }
    kept
}

/// Area of a counter-clockwise outline, mm².
fn area(outline: &[DVec2]) -> f64 {
    let Some((first, rest)) = outline.split_first() else { return 0.0 };
    rest.windows(2).map(|pair| 0.5 * (pair[0] - *first).perp_dot(pair[1] - *first)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumiduct_base::mesh::bodies::{Normals, rod};
    use std::f64::consts::TAU;

    fn placed_rod() -> Mesh {
        let at = Frame::from_axis(DVec3::new(100.0, 20.0, -3.0), DVec3::new(1.0, -2.0, 0.7));
        Mesh::new(&rod(2.0, 40.0, 96, Normals::Smooth), &at)
    }

    #[test]
    fn caps_are_flat_and_the_wall_is_not() {
        let mesh = placed_rod();
        let names: Vec<_> = mesh.face_names().collect();
        assert_eq!(names, ["wall", "entry", "exit"]);
        assert_eq!(mesh.chart_plane(0), None);
        let [entry, exit] = [1, 2].map(|face| mesh.chart_plane(face).unwrap());
        assert!((exit.z - DVec3::new(1.0, -2.0, 0.7).normalize()).length() < 1e-14);
        assert!((entry.z + exit.z).length() < 1e-14);
        assert!((exit.origin - entry.origin - 40.0 * exit.z).length() < 1e-12);
    }

    #[test]
    fn cells_of_a_flat_face_add_up_to_its_area() {
        let mesh = placed_rod();
        let plane = mesh.chart_plane(2).unwrap();
        let bounds = mesh.chart_bounds(2, &plane);
        assert!((bounds.max - DVec2::splat(2.0)).length() < 0.01, "{bounds:?}");
        let (n, size) = (7, bounds.max - bounds.min);
        let corner =
            |i: usize, j: usize| bounds.min + DVec2::new(i as f64, j as f64) / n as f64 * size;
        let cell =
            |k: usize| ChartRect { min: corner(k / n, k % n), max: corner(k / n + 1, k % n + 1) };
        let sum: f64 = (0..n * n).map(|k| mesh.chart_area_in(2, &plane, cell(k))).sum();
        // A regular polygon of 96 corners: n/2 r² sin(2π/n).
        let expected = 48.0 * 4.0 * (TAU / 96.0).sin();
        assert!((sum - expected).abs() < 1e-12 && (mesh.face_area(2) - expected).abs() < 1e-12);
        let middle = cell(24);
        let whole = (middle.max - middle.min).element_product();
        assert!((mesh.chart_area_in(2, &plane, middle) - whole).abs() < 1e-13);
        // The outermost corner cell of a disk is cut.
        assert!(mesh.chart_area_in(2, &plane, cell(0)) < 0.2 * whole);
    }
}
