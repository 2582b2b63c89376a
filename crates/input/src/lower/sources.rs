//! Sources: shapes and laws of emission.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::lower::place::Facing;
use crate::lower::surfaces::tilted;
use crate::lower::weathers::Member;
use crate::problems::name_hint;
use crate::spec::source::{
    BodySpec, ContactSpec, EmissionSpec, FaceSide, SourceCommonSpec, SourceSpec,
};
use lumiduct_base::math::Frame;
use lumiduct_core::scene::shape::{Cylinder, Flat, Region, Shape, Sphere};
use lumiduct_core::scene::{
    Emission, EmitSide, Emitter, FacePiece, FaceSpec, FinishId, Owner, PieceRange, PrimId, SolidId,
    Source, StartSolids,
};

impl Context<'_> {
    pub(super) fn lower_sources(&mut self) {
        let spec = self.spec;
        for (name, source) in &spec.sources {
            let key = Key::of(&["sources", name, source.kind()]);
            match source {
                SourceSpec::Sun(sun) => self.lower_sun(name, sun, &key),
                SourceSpec::Sky(sky) => self.lower_sky(name, sky, &key),
                SourceSpec::Point(_)
                | SourceSpec::Disk(_)
                | SourceSpec::Rectangle(_)
                | SourceSpec::Sphere(_)
                | SourceSpec::Line(_)
                | SourceSpec::Cylinder(_)
                | SourceSpec::Face(_)
                | SourceSpec::Volume(_) => self.lower_source(name, source, &key),
            }
        }
    }

    fn lower_source(&mut self, name: &str, source: &SourceSpec, key: &Key) {
        let Some(common) = source.common() else { return };
        let Some(emission) = self.emission(source, common, key) else { return };
        let Some(frame) = self.place(common.at.as_ref(), key, Facing::Toward) else { return };
        let Some((emitter, mut on)) = self.emitter(source, frame, key) else { return };
        let Some(flux) = self.flux(common, &emitter, emission, key) else { return };
        if let Some(finish) = self.body_finish(&common.body) {
            on = self.add_body(name, &emitter, finish);
        }
        // Whether the solids at the start must be found for each path is decided when the scene is
        // complete.
        let start = match common.contact {
            Some(ContactSpec::Air) => StartSolids::Behind,
            Some(ContactSpec::Optical) | None => StartSolids::Ahead,
        };
        if start == StartSolids::Behind {
            on.clear();
        }
        let source = self.builder.add_source(Source {
            name: name.to_owned(),
            flux: if common.enabled { flux } else { 0.0 },
            emitter,
            emission,
            start,
            on,
            elevation: None,
            sun: None,
        });
        let group = common.group.clone().map(|group| (group, key.field("group")));
        self.members.push(Member { source, group, daylight: None });
    }

    fn emission(
        &mut self,
        source: &SourceSpec,
        common: &SourceCommonSpec,
        key: &Key,
    ) -> Option<Emission> {
        let axis = tilted(common.tilt_deg, common.azimuth_deg);
        let default = if matches!(source, SourceSpec::Volume(_)) {
            EmissionSpec::Isotropic
        } else {
            EmissionSpec::Lambertian
        };
        let emission = match common.emission.unwrap_or(default) {
            EmissionSpec::Lambertian => Emission::Lambertian,
            EmissionSpec::Isotropic => Emission::Isotropic,
            EmissionSpec::Collimated => Emission::Collimated { axis },
            EmissionSpec::CosinePower(power) => Emission::CosinePower(power),
            EmissionSpec::ConeHalfAngleDeg(degrees) => {
                Emission::Cone { half_angle: degrees.to_radians(), axis }
            }
        };
        if let Emission::Cone { half_angle, .. } = emission
            && emits_from_a_surface(source)
        {
            let reach = half_angle.to_degrees() + common.tilt_deg;
            // Rounding of 90 degrees to radians and back.
            if reach > 90.0 + 1e-9 {
                self.problems
                    .error(
                        &key.field("tilt_deg"),
                        format!("the tilted cone reaches {reach} deg, below the surface"),
                    )
                    .hint("keep tilt_deg plus the cone's half-angle at 90 or less");
                return None;
            }
        }
        Some(emission)
    }

    /// The emitter, and the surfaces of the scene it lies on.
    fn emitter(
        &mut self,
        source: &SourceSpec,
        frame: Frame,
        key: &Key,
    ) -> Option<(Emitter, Vec<PrimId>)> {
        let flat = |region| {
            let shape = Shape::Flat(Flat::new(frame, region));
            Some((Emitter::surface(vec![shape], EmitSide::Front, Some(frame)), Vec::new()))
        };
        match source {
            SourceSpec::Point(_) => Some((Emitter::Point(frame), Vec::new())),
            SourceSpec::Line(line) => {
                Some((Emitter::Line { frame, length: line.shape.length_mm }, Vec::new()))
            }
            SourceSpec::Disk(disk) => {
                let (inner, outer) = (disk.shape.inner_radius_mm, disk.shape.radius_mm);
                flat(Region::Annulus { inner, outer })
            }
            SourceSpec::Rectangle(r) => flat(Region::Rectangle {
                half_x: 0.5 * r.shape.width_mm,
                half_y: 0.5 * r.shape.height_mm,
            }),
            SourceSpec::Sphere(sphere) => {
                let radius = sphere.shape.radius_mm;
                let shape = Shape::Sphere(Sphere::zone(frame, radius, -radius, radius));
                Some((Emitter::surface(vec![shape], EmitSide::Front, None), Vec::new()))
            }
            SourceSpec::Cylinder(cylinder) => {
                let shape = Shape::Cylinder(Cylinder::new(
                    frame,
                    cylinder.shape.radius_mm,
                    cylinder.shape.length_mm,
                ));
                Some((Emitter::surface(vec![shape], EmitSide::Front, None), Vec::new()))
            }
            SourceSpec::Face(face) => {
                self.face_emitter(&face.shape.of, face.shape.side, &key.field("of"))
            }
            SourceSpec::Volume(volume) => self.volume_emitter(&volume.shape.of, &key.field("of")),
            // Lowered on their own.
            SourceSpec::Sun(_) | SourceSpec::Sky(_) => None,
        }
    }

    fn face_emitter(
        &mut self,
        of: &str,
        side: FaceSide,
        key: &Key,
    ) -> Option<(Emitter, Vec<PrimId>)> {
        let faces = self.faces_named(of, key)?;
        let side = match side {
            FaceSide::Front => EmitSide::Front,
            FaceSide::Back => EmitSide::Back,
        };
        let scene = self.builder.scene();
        let patches = || faces.iter().flat_map(|face| scene.face_patches(*face));
        if patches().any(|patch| patch.trim.is_some()) {
            self.problems
                .error(key, format!("`{of}` has a relief; it cannot emit"))
                .hint("let a plane close to it emit, or leave the relief out");
            return None;
        }
        let mut shapes = Vec::new();
        let mut on = Vec::new();
        for &face in &faces {
            shapes.extend(scene.face_patches(face).iter().map(|patch| patch.shape.clone()));
            let entry = &scene.faces[face.index()];
            {
                on.extend(patch_range(&entry.extent).map(PrimId::new));
            }
        }
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
        let scene = self.builder.scene();
        if let Some(index) = scene.solids.iter().position(|solid| solid.name == of) {
            let bounds = scene.solids[index].bounds;
            return Some((Emitter::Volume { solid: SolidId::new(index), bounds }, Vec::new()));
        }
        let known: Vec<&str> = scene.solids.iter().map(|solid| solid.name.as_str()).collect();
        let hint = name_hint(of, known.iter().copied());
        self.problems.error(key, format!("unknown solid `{of}`")).hint(hint);
        None
    }

    fn body_finish(&mut self, body: &BodySpec) -> Option<FinishId> {
        match body {
            BodySpec::Transparent => None,
            BodySpec::Absorbing => self.finishes.get("black").copied(),
            BodySpec::Finish(reference) => self.finish(reference),
        }
    }

    /// Makes the emitter's surfaces a sheet that light meets.
    fn add_body(&mut self, name: &str, emitter: &Emitter, finish: FinishId) -> Vec<PrimId> {
        let Emitter::Surface { shapes, .. } = emitter else { return Vec::new() };
        let face = self.builder.add_face(FaceSpec {
            name: format!("{name}.body"),
            owner: Owner::Sheet,
            front: Some(finish),
            back: Some(finish),
            pieces: shapes.iter().map(|(shape, _)| FacePiece::whole(shape.clone())).collect(),
        });
        self.faces.insert(format!("{name}.body"), vec![face]);
        patch_range(&self.builder.scene().faces[face.index()].extent).map(PrimId::new).collect()
    }
}

/// Whether directions are counted from a surface's normal.
pub(super) fn emits_from_a_surface(source: &SourceSpec) -> bool {
    match source {
        SourceSpec::Disk(_)
        | SourceSpec::Rectangle(_)
        | SourceSpec::Sphere(_)
        | SourceSpec::Cylinder(_)
        | SourceSpec::Face(_) => true,
        SourceSpec::Point(_)
        | SourceSpec::Line(_)
        | SourceSpec::Volume(_)
        | SourceSpec::Sun(_)
        | SourceSpec::Sky(_) => false,
    }
}

/// The patches of a face that light can meet.
fn patch_range(extent: &PieceRange) -> std::ops::Range<usize> {
    match extent {
        PieceRange::Patches(range) => range.clone(),
        PieceRange::Ports(_) | PieceRange::Mesh { .. } => 0..0,
    }
}
