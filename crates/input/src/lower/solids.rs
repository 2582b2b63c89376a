//! Closed bodies.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::lower::place::Facing;
use crate::lower::surfaces::{BodyPart, BodySurfaces, NamedFace};
use crate::problems::face_hint;
use crate::spec::solid::{BoxSpec, CylinderSpec, SolidSpec};
use crate::spec::sweep::{
    CircleSpec, LegSpec, ProfileSpec, RectangleSpec, StraightSpec, SweepSpec,
};
use indexmap::IndexMap;
use lumiduct_base::math::{Aabb, Frame};
use lumiduct_core::scene::shape::{Shape, Sphere};
use lumiduct_core::scene::{FaceId, FaceSpec, FinishId, MediumId, Owner, Solid};
use std::f64::consts::PI;

impl<'a> Context<'a> {
    /// Builds a solid with its faces.
    pub(super) fn lower_solid(
        &mut self,
        name: &str,
        solid: &'a SolidSpec,
        key: &Key,
    ) -> Option<()> {
        let common = solid.common();
        let medium = self.medium(&common.medium, &key.field("medium"));
        let declared = self.declared(&common.faces, &key.field("faces"));
        let frame = self.place(common.at.as_ref(), key, Facing::Away);
        // What stands at its faces is checked even if its medium is unknown.
        let medium = medium.unwrap_or(MediumId::new(0));
        let add = |this: &mut Self, volume| {
            this.may_build(key)?;
            Some(this.builder.add_solid(Solid {
                name: name.to_owned(),
                medium,
                priority: common.priority,
                bounds: Aabb::EMPTY,
                volume,
            }))
        };
        if let SolidSpec::Mesh(spec) = solid {
            let (mesh, health) = self.read_mesh(&spec.shape, key)?;
            let finishes = self.mesh_finishes(name, &mesh, &declared, &key.field("faces"));
            let frame = frame?;
            let id = add(self, Some(health.signed_volume_mm3))?;
            self.add_mesh(name, id, mesh, &finishes, &frame);
            return Some(());
        }
        // Whether a shape is possible does not depend on its place.
        let surfaces = self.solid_surfaces(solid, frame.unwrap_or(Frame::WORLD), key)?;
        let finishes = self.face_finishes(name, &surfaces.faces, &declared, &key.field("faces"));
        let id = frame.and_then(|_| add(self, surfaces.volume))?;
        let outside: IndexMap<String, FinishId> =
            finishes.iter().map(|(face, finish)| (face.clone(), self.behind(*finish))).collect();
        self.add_faces(name, Owner::Solid(id), surfaces.faces, |_, face| {
            (outside.get(face).copied(), finishes.get(face).copied())
        });
        Some(())
    }

    fn solid_surfaces(
        &mut self,
        solid: &SolidSpec,
        frame: Frame,
        key: &Key,
    ) -> Option<BodySurfaces> {
        match solid {
            SolidSpec::Sweep(sweep) => self.sweep_surfaces(&sweep.shape, frame, key),
            SolidSpec::Cylinder(cylinder) => {
                self.sweep_surfaces(&cylinder_sweep(&cylinder.shape), frame, key)
            }
            SolidSpec::Box(cuboid) => {
                self.may_build(&key.field("size_mm"))?;
                self.sweep_surfaces(&box_sweep(&cuboid.shape), frame, key)
            }
            SolidSpec::Tube(tube) => self.tube_surfaces(&tube.shape, frame, key),
            SolidSpec::Sphere(sphere) => {
                let radius = sphere.shape.radius_mm;
                let shape = Shape::Sphere(Sphere::zone(frame, radius, -radius, radius));
                let volume = Some(4.0 / 3.0 * PI * radius.powi(3));
                Some(BodySurfaces { faces: vec![NamedFace::wall("surface", shape)], volume })
            }
            SolidSpec::Lens(lens) => self.lens_surfaces(&lens.shape, frame, key),
            SolidSpec::CompoundParabolic(cpc) => self.compound_parabolic(&cpc.shape, frame, key),
            SolidSpec::Paraboloid(paraboloid) => self.paraboloid(&paraboloid.shape, frame, key),
            // The faces of meshes come from a file.
            SolidSpec::Mesh(_) => None,
        }
    }

    /// Finishes by face name: `wall` applies to all walls, the name of a side overrides it. `key`
    /// is that of the table of declared ones.
    pub(super) fn face_finishes(
        &mut self,
        body: &str,
        faces: &[NamedFace],
        declared: &IndexMap<&str, Option<FinishId>>,
        key: &Key,
    ) -> IndexMap<String, FinishId> {
        let known: Vec<&str> = faces.iter().map(|face| face.name.as_str()).collect();
        let mut finishes = IndexMap::new();
        for (&name, &finish) in declared {
            let is_meant = |face: &&NamedFace| {
                face.name == name || (name == "wall" && face.part == BodyPart::Wall)
            };
            let named: Vec<&NamedFace> = faces.iter().filter(is_meant).collect();
            if named.is_empty() {
                self.note_no_face(body, name, &known, key);
            }
            let Some(finish) = finish else { continue };
            for face in named {
                if face.name == name {
                    finishes.insert(face.name.clone(), finish);
                } else {
                    finishes.entry(face.name.clone()).or_insert(finish);
                }
            }
        }
        finishes
    }

    /// Notes a face with a finish that the body does not have.
    pub(super) fn note_no_face(&mut self, body: &str, name: &str, known: &[&str], key: &Key) {
        let hint = face_hint(name, known.iter().copied());
        let message = format!("`{body}` has no face `{name}`");
        self.problems.error(&key.field(name), message).hint(hint);
    }

    /// Adds the faces of a body under their dotted names; `finish` gives the finish of the front and of the back.
    pub(super) fn add_faces(
        &mut self,
        body: &str,
        owner: Owner,
        faces: Vec<NamedFace>,
        finish: impl Fn(BodyPart, &str) -> (Option<FinishId>, Option<FinishId>),
    ) {
        let mut walls: Vec<FaceId> = Vec::new();
        for face in faces {
            let (front, back) = finish(face.part, &face.name);
            let open = owner == Owner::Sheet && face.part == BodyPart::End;
            let name = format!("{body}.{}", face.name);
            let owner = if open { Owner::Port } else { owner };
            let id = self.builder.add_face(FaceSpec {
                name: name.clone(),
                owner,
                front,
                back,
                pieces: face.pieces,
            });
            if face.part == BodyPart::Wall {
                walls.push(id);
            }
            self.faces.insert(name, vec![id]);
        }
        if walls.len() > 1 {
            self.faces.insert(format!("{body}.wall"), walls);
        }
    }
}

fn cylinder_sweep(spec: &CylinderSpec) -> SweepSpec {
    let end_scale = spec.end_radius_mm.map_or(1.0, |end| end / spec.radius_mm);
    straight(
        ProfileSpec::Circle(CircleSpec { radius_mm: spec.radius_mm }),
        spec.length_mm,
        end_scale,
    )
}

fn box_sweep(spec: &BoxSpec) -> SweepSpec {
    let [width_mm, height_mm, length] = spec.size_mm;
    straight(ProfileSpec::Rectangle(RectangleSpec { width_mm, height_mm }), length, 1.0)
}

fn straight(profile: ProfileSpec, straight_mm: f64, end_scale: f64) -> SweepSpec {
    SweepSpec { profile, path: vec![LegSpec::Straight(StraightSpec { straight_mm, end_scale })] }
}
