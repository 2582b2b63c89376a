//! Points drawn evenly over faces, and the density this gives for the directions toward them.
//!
//! It knows faces of all kinds: analytic pieces, open ports, and faces of meshes. It does not know
//! sensors or paths.

use crate::scene::mesh::MeshBody;
use crate::scene::shape::{Crossing, RayStart};
use crate::scene::{FaceId, Patch, PieceRange, PrimId, Ray, Scene};
use glam::{DVec2, DVec3};

/// Some faces as one area.
#[derive(Debug, Clone)]
pub struct FaceArea<'s> {
    scene: &'s Scene,
    pieces: Vec<AreaPiece<'s>>,
    /// Area up to and including each piece, mm².
    area_up_to: Vec<f64>,
    /// The pieces that are not copies of meshes.
    single: Vec<AreaPiece<'s>>,
    /// The faces that copies of meshes are part of.
    copied: Vec<FaceId>,
}

/// A part of the area.
#[derive(Debug, Clone, Copy)]
enum AreaPiece<'s> {
    /// An analytic piece; a port is not a surface of the scene.
    Patch(&'s Patch, Option<PrimId>),
    /// A face of a mesh, by its number there.
    Mesh(&'s MeshBody, usize),
}

/// A point of the area.
#[derive(Debug, Clone, Copy)]
pub struct AreaPoint {
    /// Position, mm.
    pub point: DVec3,
    /// Unit normal of the front.
    pub normal: DVec3,
    /// Unrolled coordinates on the face, mm.
    pub uv: DVec2,
    /// The surface it lies on; `None` on a port.
    pub prim: Option<PrimId>,
}

impl<'s> FaceArea<'s> {
    /// The area of some faces of a scene.
    pub fn new(scene: &'s Scene, faces: &[FaceId]) -> Self {
        let pieces: Vec<AreaPiece<'s>> =
            faces.iter().flat_map(|&face| pieces_of(scene, face)).collect();
        let mut area = 0.0;
        let area_up_to = pieces
            .iter()
            .map(|piece| {
                area += piece.area();
                area
            })
            .collect();
        let is_copied = |face: &FaceId| scene.mesh_pieces(*face).any(|(body, _)| body.is_copy());
        let copied = faces.iter().copied().filter(is_copied).collect();
        let single = pieces.iter().copied().filter(|piece| !piece.is_copy()).collect();
        Self { scene, pieces, area_up_to, single, copied }
    }

    /// Its patch, with the surface it is, if it has no other piece.
    pub(crate) fn only_patch(&self) -> Option<(&'s Patch, Option<PrimId>)> {
        match self.pieces[..] {
            [AreaPiece::Patch(patch, prim)] => Some((patch, prim)),
            _ => None,
        }
    }

    /// The whole area, mm², including the positions that [`Self::sample`] finds occupied by others.
    pub fn area(&self) -> f64 {
        self.area_up_to.last().copied().unwrap_or(0.0)
    }

    /// A point, uniform over the area for uniform `u`; `None` where there is no area, or a relief
    /// occupies the position.
    pub fn sample(&self, u: [f64; 2]) -> Option<AreaPoint> {
        let area = Some(self.area()).filter(|area| *area > 0.0)?;
        let wanted = (u[0] * area).min(area.next_down());
        let index = self.area_up_to.partition_point(|up_to| *up_to <= wanted);
        let before = if index == 0 { 0.0 } else { self.area_up_to[index - 1] };
        // The remainder of the first number is again uniform within the piece.
        let rest = (wanted - before) / (self.area_up_to[index] - before);
        self.pieces[index].sample(self.scene, [rest.clamp(0.0, 1.0), u[1]])
    }

    /// Density over solid angle, 1/sr, with which a line from the ray's origin to a point drawn
    /// from the area has the ray's direction: Σ t²/(A |cos|) over all points where the ray meets
    /// the area.
    pub(crate) fn density_toward(&self, ray: &Ray) -> f64 {
        let mut sum = 0.0;
        self.crossings(ray, |t, normal| {
            if t > 0.0 {
                sum += t * t / ray.dir().dot(normal).abs();
            }
        });
        sum / self.area()
    }

    /// Density over area across the ray's line, 1/mm², with which a line of its direction through a
    /// point drawn from the area coincides with it: Σ 1/(A |cos|) over all points where the ray
    /// meets the area.
    pub(crate) fn density_across(&self, ray: &Ray) -> f64 {
        let mut sum = 0.0;
        self.crossings(ray, |t, normal| {
            if t > 0.0 {
                sum += 1.0 / ray.dir().dot(normal).abs();
            }
        });
        sum / self.area()
    }

    /// Every point where a ray meets the area ahead, and many behind: distance along the ray, mm, and unit normal.
    fn crossings(&self, ray: &Ray, mut visit: impl FnMut(f64, DVec3)) {
        let Self { scene, single, copied, .. } = self;
        single.iter().for_each(|piece| piece.crossings(ray, &mut visit));
        if !copied.is_empty() {
            scene.all_crossings(ray, |prim, Crossing { t, .. }| {
                if scene.is_copied(prim) && copied.contains(&scene.face_of(prim)) {
                    visit(t, scene.normal(prim, ray.at(t)));
                }
            });
        }
    }
}

fn pieces_of(scene: &Scene, face: FaceId) -> Vec<AreaPiece<'_>> {
    match &scene.faces[face.index()].extent {
        PieceRange::Patches(range) => range
            .clone()
            .map(|index| AreaPiece::Patch(&scene.patches[index], Some(PrimId::new(index))))
            .collect(),
        PieceRange::Ports(range) => {
            scene.ports[range.clone()].iter().map(|patch| AreaPiece::Patch(patch, None)).collect()
        }
        PieceRange::Mesh(_) => {
            scene.mesh_pieces(face).map(|(body, face)| AreaPiece::Mesh(body, face)).collect()
        }
    }
}

impl AreaPiece<'_> {
    fn is_copy(&self) -> bool {
        match self {
            Self::Patch(..) => false,
            Self::Mesh(body, _) => body.is_copy(),
        }
    }

    fn area(&self) -> f64 {
        match self {
            Self::Patch(patch, _) => patch.shape.area(),
            Self::Mesh(body, face) => body.face_area(*face),
        }
    }

    fn sample(&self, scene: &Scene, u: [f64; 2]) -> Option<AreaPoint> {
        match self {
            Self::Patch(patch, prim) => {
                let point = patch.sample(u)?;
                let (normal, uv) = (patch.shape.normal(point), patch.chart(point));
                Some(AreaPoint { point, normal, uv, prim: *prim })
            }
            Self::Mesh(body, face) => {
                let found = body.sample(*face, u)?;
                let prim = PrimId::new(body.first + found.triangle);
                let normal = body.facet_normal(found.triangle);
                let uv = scene.chart(prim, found.point);
                Some(AreaPoint { point: found.point, normal, uv, prim: Some(prim) })
            }
        }
    }

    /// Every point where the ray's line meets it: distance along the ray, mm, and unit normal.
    fn crossings(&self, ray: &Ray, mut visit: impl FnMut(f64, DVec3)) {
        match self {
            Self::Patch(patch, _) => {
                patch.crossings(ray, RayStart::Elsewhere, |Crossing { t, .. }| {
                    visit(t, patch.shape.normal(ray.at(t)));
                });
            }
            Self::Mesh(body, face) => {
                for &triangle in body.mesh.face_triangles(*face) {
                    let triangle = triangle as usize;
                    if let Some(Crossing { t, .. }) = body.mesh.crossing(triangle, ray) {
                        visit(t, body.facet_normal(triangle));
                    }
                }
            }
        }
    }
}
