//! A cut through the scene: the lines in which a plane meets every face, as points.
//!
//! The plane is scanned by two families of parallel rays; where one family runs along a surface the other crosses it.
//! That serves every kind of surface alike, without a formula for each.

use crate::math::{Aabb, Frame};
use crate::scene::shape::{ChartRect, Start};
use crate::scene::{FaceId, PrimId, Ray, Scene};
use glam::{DVec2, DVec3};

/// Rays of each family across the picture.
const RAYS: usize = 1200;

/// The points of one face in the plane of a section.
#[derive(Debug, Clone)]
pub struct Outline {
    /// The face.
    pub face: FaceId,
    /// Points in the axes of the section, mm.
    pub points: Vec<DVec2>,
}

impl Scene {
    /// The plane through the middle of all solids and sheets that shows most of them: across the shortest side of their
    /// box. x and y of the frame are the axes of the picture, in the order of the coordinates.
    pub fn section_plane(&self) -> Frame {
        let patches = self.patches.iter().map(|patch| patch.shape.bounds());
        let bodies = patches.chain(self.meshes.iter().map(|body| body.bounds()));
        let found = bodies.fold(Aabb::EMPTY, Aabb::union);
        // A scene may have nothing but sources and sensors.
        let bounds = if found.is_empty() { self.bounds } else { found };
        let (size, origin) = (bounds.max - bounds.min, bounds.center());
        let (x, y) = if size.y <= size.x.min(size.z) {
            (DVec3::Z, DVec3::X)
        } else if size.x <= size.z {
            (DVec3::Z, DVec3::Y)
        } else {
            (DVec3::X, DVec3::Y)
        };
        Frame { origin, x, y, z: x.cross(y) }
    }

    /// Where every face meets the plane z = 0 of `plane`, within `window` of its axes, mm.
    pub fn section(&self, plane: &Frame, window: ChartRect) -> Vec<Outline> {
        let mut outlines: Vec<Outline> = (0..self.faces.len())
            .map(|face| Outline { face: FaceId::new(face), points: Vec::new() })
            .collect();
        let size = window.max - window.min;
        for ray in 0..RAYS {
            let share = (ray as f64 + 0.5) / RAYS as f64;
            let starts = [
                (window.min + DVec2::new(0.0, share * size.y), plane.x),
                (window.min + DVec2::new(share * size.x, 0.0), plane.y),
            ];
            for (start, dir) in starts {
                let ray = Ray::new(plane.point_to_world(start.extend(0.0)), dir);
                self.every_crossing(&ray, |face, t| {
                    let point = plane.point_to_local(ray.at(t)).truncate();
                    if point.cmpge(window.min).all() && point.cmple(window.max).all() {
                        outlines[face.index()].points.push(point);
                    }
                });
            }
        }
        outlines.retain(|outline| !outline.points.is_empty());
        outlines
    }

    /// Calls `visit` for every crossing of a ray's line with every face, ports included.
    fn every_crossing(&self, ray: &Ray, mut visit: impl FnMut(FaceId, f64)) {
        self.all_crossings(ray, |prim: PrimId, crossing| visit(self.face_of(prim), crossing.t));
        for port in &self.ports {
            port.shape.crossings(ray, Start::Elsewhere, |crossing| visit(port.face, crossing.t));
        }
    }
}
