//! A cut through the scene: the lines in which a plane meets every face, as points.
//!
//! The plane is scanned by two families of parallel rays; where one family runs along a surface the
//! other crosses it. That works for every kind of surface, without a formula for each.

use crate::optics::Finish;
use crate::scene::pattern::ActingPart;
use crate::scene::shape::{ChartRect, Crossing, RayStart};
use crate::scene::{FaceId, PrimId, Ray, Scene, Surface};
use glam::{DVec2, DVec3};
use lumiduct_base::math::Frame;

/// Rays of each family across the picture.
const RAYS: usize = 1200;

/// The points of one face in the plane of a section.
#[derive(Debug, Clone)]
pub struct SectionOutline {
    /// The face.
    pub face: FaceId,
    /// Points in the axes of the section, mm.
    pub points: Vec<DVec2>,
}

impl Scene {
    /// Where every face meets the plane z = 0 of `plane`, within `window` of its axes, mm.
    pub fn section(&self, plane: &Frame, window: ChartRect) -> Vec<SectionOutline> {
        let mut outlines: Vec<SectionOutline> = (0..self.faces.len())
            .map(|face| SectionOutline { face: FaceId::new(face), points: Vec::new() })
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
                self.every_crossing(&ray, |prim, face, t| {
                    let point = plane.point_to_local(ray.at(t)).truncate();
                    let is_shown = point.cmpge(window.min).all() && point.cmple(window.max).all();
                    if is_shown && !self.is_open(prim, ray.at(t)) {
                        outlines[face.index()].points.push(point);
                    }
                });
            }
        }
        outlines.retain(|outline| !outline.points.is_empty());
        outlines
    }

    /// Calls `visit` for every crossing of a ray's line with every face, ports included.
    fn every_crossing(&self, ray: &Ray, mut visit: impl FnMut(Option<PrimId>, FaceId, f64)) {
        self.all_crossings(ray, |prim, crossing| {
            visit(Some(prim), self.face_of(prim), crossing.t);
        });
        for port in &self.ports {
            let visit = |crossing: Crossing| visit(None, port.face, crossing.t);
            port.shape.crossings(ray, RayStart::Elsewhere, visit);
        }
    }

    /// Whether there is a hole of a pattern at a point of a surface.
    fn is_open(&self, prim: Option<PrimId>, point: DVec3) -> bool {
        let Some(Surface::Patch(patch)) = prim.map(|prim| self.surface(prim)) else { return false };
        let numbers = &self.faces[patch.face.index()].patterns;
        let mut parts = numbers.iter().filter_map(|&number| {
            let pattern = &self.patterns[number];
            let part = pattern.part(number, patch.chart(point), || DVec2::ZERO)?;
            Some((part, &self.finishes[pattern.front.index()].finish))
        });
        matches!(parts.next(), Some((ActingPart::Element(_), Finish::Open)))
    }
}
