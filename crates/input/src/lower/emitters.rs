//! What emits: the shape and extent of every kind of source but luminaires, rays, the sun and the sky.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::problems::name_hint;
use crate::spec::source::{FaceSide, FaceSourceSpec, SourceSpec};
use lumiduct_base::math::Frame;
use lumiduct_core::scene::shape::{Cylinder, Flat, Region, Shape, Sphere};
use lumiduct_core::scene::{EmitSide, Emitter, PieceRange, PrimId, SolidId};

/// The extent of a kind of source.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SourceExtent {
    Point,
    Line,
    Area,
    Face,
    Volume,
}

impl SourceExtent {
    /// That of a source; `None` for luminaires and rays, whose file knows, and for the sun and the sky, which emit from infinity.
    pub(super) fn of(source: &SourceSpec) -> Option<Self> {
        match source {
            SourceSpec::Point(_) => Some(Self::Point),
            SourceSpec::Line(_) => Some(Self::Line),
            SourceSpec::Disk(_)
            | SourceSpec::Rectangle(_)
            | SourceSpec::Sphere(_)
            | SourceSpec::Cylinder(_) => Some(Self::Area),
            SourceSpec::Face(_) => Some(Self::Face),
            SourceSpec::Volume(_) => Some(Self::Volume),
            SourceSpec::Luminaire(_)
            | SourceSpec::Rays(_)
            | SourceSpec::Sun(_)
            | SourceSpec::Sky(_) => None,
        }
    }

    /// Whether directions are counted from a surface's normal.
    pub(super) fn has_area(self) -> bool {
        self == Self::Area || self == Self::Face
    }
}

impl Context<'_> {
    /// The emitter, and the surfaces of the scene it lies on.
    pub(super) fn emitter(
        &mut self,
        source: &SourceSpec,
        frame: Frame,
        key: &Key,
    ) -> Option<(Emitter, Vec<PrimId>)> {
        let on_its_own = |emitter| Some((emitter, Vec::new()));
        let flat = |region| {
            let shape = Shape::Flat(Flat::new(frame, region));
            on_its_own(Emitter::surface(vec![shape], EmitSide::Front, Some(frame)))
        };
        let round = |shape| on_its_own(Emitter::surface(vec![shape], EmitSide::Front, None));
        match source {
            SourceSpec::Point(_) => on_its_own(Emitter::Point(frame)),
            SourceSpec::Line(line) => {
                on_its_own(Emitter::Line { frame, length: line.shape.length_mm })
            }
            SourceSpec::Disk(disk) => {
                let (inner, outer) = (disk.shape.inner_radius_mm, disk.shape.radius_mm);
                self.require_order(key, ("inner_radius_mm", inner), ("radius_mm", outer))?;
                flat(Region::Annulus { inner, outer })
            }
            SourceSpec::Rectangle(r) => flat(Region::Rectangle {
                half_x: 0.5 * r.shape.width_mm,
                half_y: 0.5 * r.shape.height_mm,
            }),
            SourceSpec::Sphere(sphere) => {
                let radius = sphere.shape.radius_mm;
                round(Shape::Sphere(Sphere::zone(frame, radius, -radius, radius)))
            }
            SourceSpec::Cylinder(cylinder) => {
                let (radius, length) = (cylinder.shape.radius_mm, cylinder.shape.length_mm);
                round(Shape::Cylinder(Cylinder::new(frame, radius, length)))
            }
            SourceSpec::Face(face) => self.face_emitter(&face.shape, &key.field("of")),
            SourceSpec::Volume(volume) => self.volume_emitter(&volume.shape.of, &key.field("of")),
            // Lowered on their own.
            SourceSpec::Luminaire(_)
            | SourceSpec::Rays(_)
            | SourceSpec::Sun(_)
            | SourceSpec::Sky(_) => None,
        }
    }

    fn face_emitter(&mut self, spec: &FaceSourceSpec, key: &Key) -> Option<(Emitter, Vec<PrimId>)> {
        let of = &spec.of;
        let faces = self.faces_named(of, key)?;
        let side = match spec.side {
            FaceSide::Front => EmitSide::Front,
            FaceSide::Back => EmitSide::Back,
        };
        let scene = self.builder.scene();
        let patches = || faces.iter().flat_map(|face| scene.face_patches(*face));
        if patches().any(|patch| patch.trim.is_some()) {
            let hint = "let a plane close to it emit, or leave the relief out";
            return self.refuse(key, format!("`{of}` has a relief; it cannot emit"), hint);
        }
        let shapes: Vec<Shape> = patches().map(|patch| patch.shape.clone()).collect();
        let extents = faces.iter().map(|face| &scene.faces[face.index()].extent);
        let on = extents.flat_map(patch_range).map(PrimId::new).collect();
        // The axes of a flat face are the reference of a tilted beam; z must be the direction of
        // emission.
        let plane = match faces.as_slice() {
            [face] => scene.face_plane(*face),
            _ => None,
        };
        let frame = plane.map(|plane| match side {
            EmitSide::Front => plane,
            EmitSide::Back => Frame { y: -plane.y, z: -plane.z, ..plane },
        });
        if shapes.is_empty() {
            self.problems.error(key, format!("`{of}` is part of a mesh; it cannot emit"));
            return None;
        }
        Some((Emitter::surface(shapes, side, frame), on))
    }

    fn volume_emitter(&mut self, of: &str, key: &Key) -> Option<(Emitter, Vec<PrimId>)> {
        let known = self.names("solids");
        if !known.contains(of) {
            let hint = name_hint(of, known.iter().copied());
            return self.refuse(key, format!("unknown solid `{of}`"), hint);
        }
        let scene = self.builder.scene();
        let index = scene.solids.iter().position(|solid| solid.name == of)?;
        let bounds = scene.solids[index].bounds;
        Some((Emitter::Volume { solid: SolidId::new(index), bounds }, Vec::new()))
    }
}

/// The patches of a face that light can meet.
pub(super) fn patch_range(extent: &PieceRange) -> std::ops::Range<usize> {
    match extent {
        PieceRange::Patches(range) => range.clone(),
        PieceRange::Ports(_) | PieceRange::Mesh(_) => 0..0,
    }
}
