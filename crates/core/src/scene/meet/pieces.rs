//! Queries on surfaces, whether they are analytic patches or triangles of a mesh.

use crate::scene::mesh::MeshBody;
use crate::scene::shape::{ChartRect, Region, Shape};
use crate::scene::{FaceId, MeshPieces, Owner, Patch, PieceRange, PrimId, Scene, SmoothId};
use glam::{DVec2, DVec3};
use lumiduct_base::math::Frame;

/// A surface that a ray can hit.
#[derive(Debug, Clone, Copy)]
pub enum Surface<'s> {
    /// An analytic piece.
    Patch(&'s Patch),
    /// A triangle of a mesh, by its number there.
    Triangle(&'s MeshBody, usize),
}

impl Surface<'_> {
    /// The face that it belongs to.
    #[inline]
    pub fn face(self) -> FaceId {
        match self {
            Self::Patch(patch) => patch.face,
            Self::Triangle(body, triangle) => body.faces[body.mesh.face_of(triangle)],
        }
    }

    /// The owner of its face.
    #[inline]
    pub fn owner(self) -> Owner {
        match self {
            Self::Patch(patch) => patch.owner,
            Self::Triangle(body, _) => Owner::Solid(body.solid),
        }
    }
}

impl Scene {
    /// The surface with a number.
    #[inline]
    pub fn surface(&self, prim: PrimId) -> Surface<'_> {
        let index = prim.index();
        match self.patches.get(index) {
            Some(patch) => Surface::Patch(patch),
            None => {
                let bodies = if self.is_copied(prim) { &self.copies } else { &self.meshes };
                let body = match bodies.as_slice() {
                    [body] => body,
                    bodies => &bodies[bodies.partition_point(|body| body.first <= index) - 1],
                };
                Surface::Triangle(body, index - body.first)
            }
        }
    }

    /// The face that a surface belongs to.
    #[inline]
    pub(crate) fn face_of(&self, prim: PrimId) -> FaceId {
        self.surface(prim).face()
    }

    /// Unit normal of the front at a point of a surface: of the triangle itself, for a mesh.
    #[inline]
    pub fn normal(&self, prim: PrimId, point: DVec3) -> DVec3 {
        match self.surface(prim) {
            Surface::Patch(patch) => patch.shape.normal(point),
            Surface::Triangle(body, triangle) => body.facet_normal(triangle),
        }
    }

    /// The smooth surface that a piece belongs to.
    #[inline]
    pub(crate) fn smooth(&self, prim: PrimId) -> SmoothId {
        match self.surface(prim) {
            // Patches are numbered within their face.
            Surface::Patch(patch) => SmoothId::of(patch.face.index() as u32, patch.smooth),
            // Triangles are numbered within their body; bodies count down from the largest number.
            Surface::Triangle(body, triangle) => {
                let before =
                    |bodies: &[MeshBody]| bodies.partition_point(|other| other.first < body.first);
                let place = before(&self.meshes) + before(&self.copies);
                SmoothId::of(u32::MAX - place as u32, body.mesh.smooth_id(triangle))
            }
        }
    }

    /// Unrolled coordinates of a point on its face, mm.
    #[inline]
    pub(crate) fn chart(&self, prim: PrimId, point: DVec3) -> DVec2 {
        match self.surface(prim) {
            Surface::Patch(patch) => patch.chart(point),
            Surface::Triangle(body, triangle) => body.planes[body.mesh.face_of(triangle)]
                .map_or(DVec2::ZERO, |plane| plane.point_to_local(point).truncate()),
        }
    }

    /// The face with a name such as `pipe.exit`.
    pub fn face_named(&self, name: &str) -> Option<FaceId> {
        self.faces.iter().position(|face| face.name == name).map(FaceId::new)
    }

    /// The analytic pieces of a face; none for a face of a mesh.
    pub fn face_patches(&self, face: FaceId) -> &[Patch] {
        match &self.faces[face.index()].extent {
            PieceRange::Patches(range) => &self.patches[range.clone()],
            PieceRange::Ports(range) => &self.ports[range.clone()],
            PieceRange::Mesh(_) => &[],
        }
    }

    /// Area of a face, mm².
    pub fn face_area(&self, face: FaceId) -> f64 {
        let patches: f64 = self.face_patches(face).iter().map(Patch::area).sum();
        patches + self.mesh_pieces(face).map(|(body, index)| body.face_area(index)).sum::<f64>()
    }

    /// Area of the part of a face whose chart lies in `rect`, mm².
    pub fn face_area_in(&self, face: FaceId, rect: ChartRect) -> f64 {
        match self.charted_mesh(face) {
            Some((body, index)) => {
                body.planes[index].map_or(0.0, |plane| body.mesh.chart_area_in(index, &plane, rect))
            }
            None => self.face_patches(face).iter().map(|patch| patch.area_in(rect)).sum(),
        }
    }

    /// Area of the chart within `rect` that a face fills, mm²; 0 for a curved face of a mesh, which has no chart.
    pub fn face_charted_in(&self, face: FaceId, rect: ChartRect) -> f64 {
        match self.charted_mesh(face) {
            // Charts of flat faces keep areas.
            Some(_) => self.face_area_in(face, rect),
            None => self.face_patches(face).iter().map(|patch| patch.charted_in(rect)).sum(),
        }
    }

    /// The rectangle that a face's chart covers, mm; `None` for a curved face of a mesh.
    pub fn face_rect(&self, face: FaceId) -> Option<ChartRect> {
        match self.charted_mesh(face) {
            Some((body, index)) => {
                body.planes[index].map(|plane| body.mesh.chart_bounds(index, &plane))
            }
            None => {
                self.face_patches(face).iter().map(Patch::chart_bounds).reduce(ChartRect::union)
            }
        }
    }

    /// The frame of a flat face: its middle, z along the outward normal, and the axes of its chart.
    pub fn face_plane(&self, face: FaceId) -> Option<Frame> {
        if let Some((body, index)) = self.charted_mesh(face) {
            return body.planes[index];
        }
        match self.face_patches(face) {
            [Patch { shape: Shape::Flat(flat), .. }] => Some(*flat.frame()),
            _ => None,
        }
    }

    /// Radius of a face that is one flat disk, mm.
    pub fn face_disk_radius(&self, face: FaceId) -> Option<f64> {
        match self.face_patches(face) {
            [Patch { shape: Shape::Flat(flat), .. }] => match flat.region() {
                Region::Annulus { inner, outer } if *inner == 0.0 => Some(*outer),
                Region::Annulus { .. }
                | Region::Rectangle { .. }
                | Region::Polygon(_)
                | Region::Holed(_)
                | Region::Ellipse { .. }
                | Region::Sector { .. } => None,
            },
            _ => None,
        }
    }

    /// The owner of a face.
    #[inline]
    pub fn owner(&self, face: FaceId) -> Owner {
        self.faces[face.index()].owner
    }

    /// Whether a surface is a triangle of a copy of a mesh.
    pub(crate) fn is_copied(&self, prim: PrimId) -> bool {
        prim.index() >= self.first_of_copies
    }

    /// The bodies of triangles that a face is part of, with its number in each.
    pub(crate) fn mesh_pieces(&self, face: FaceId) -> impl Iterator<Item = (&MeshBody, usize)> {
        let pieces = match &self.faces[face.index()].extent {
            PieceRange::Mesh(pieces) => Some(pieces),
            PieceRange::Patches(_) | PieceRange::Ports(_) => None,
        };
        pieces.into_iter().flat_map(|MeshPieces { own, copies }| {
            let own = own.iter().map(|(mesh, face)| (&self.meshes[*mesh], *face));
            own.chain(copies.iter().flat_map(|(copies, face)| {
                self.copies[copies.clone()].iter().map(|copy| (copy, *face))
            }))
        })
    }

    /// The mesh of a face that is part of no other, with its number there.
    fn charted_mesh(&self, face: FaceId) -> Option<(&MeshBody, usize)> {
        let mut pieces = self.mesh_pieces(face);
        pieces.next().filter(|_| pieces.next().is_none())
    }
}
