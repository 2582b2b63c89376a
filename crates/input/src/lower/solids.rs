//! Closed bodies.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::lower::place::Facing;
use crate::lower::surfaces::{BodyPart, NamedFace, Surfaces};
use crate::problems::face_hint;
use crate::spec::finish::FinishRef;
use crate::spec::solid::{BoxSpec, CylinderSpec, SolidSpec};
use crate::spec::sweep::{
    CircleSpec, LegSpec, ProfileSpec, RectangleSpec, StraightSpec, SweepSpec,
};
use indexmap::IndexMap;
use lumiduct_base::math::{Aabb, Frame};
use lumiduct_core::scene::shape::{Shape, Sphere};
use lumiduct_core::scene::{FaceId, FaceSpec, FinishId, Owner, Solid, SolidId};
use std::f64::consts::PI;

impl Context<'_> {
    /// Builds a solid with its faces.
    pub(super) fn lower_solid(&mut self, name: &str) {
        let spec = self.spec;
        let solid = &spec.solids[name];
        let key = Key::of(&["solids", name, solid.kind()]);
        let common = solid.common();
        let (Some(frame), Some(&medium)) =
            (self.place(common.at.as_ref(), &key, Facing::Away), self.media.get(&common.medium))
        else {
            return;
        };
        if let SolidSpec::Mesh(spec) = solid {
            let Some(mesh) = self.read_mesh(&spec.shape, &key) else { return };
            let volume = Some(lumiduct_base::mesh::health(&mesh).signed_volume_mm3);
            let id = self.add_solid(name, medium, common.priority, volume);
            self.add_mesh(name, id, &mesh, &common.faces, &frame, &key);
            return;
        }
        let Some(surfaces) = self.solid_surfaces(solid, frame, &key) else { return };
        let id = self.add_solid(name, medium, common.priority, surfaces.volume);
        let finishes =
            self.face_finishes(name, &surfaces.faces, &common.faces, &key.field("faces"));
        let outside: IndexMap<String, FinishId> =
            finishes.iter().map(|(face, finish)| (face.clone(), self.behind(*finish))).collect();
        self.add_faces(name, Owner::Solid(id), surfaces.faces, |_, face| {
            (outside.get(face).copied(), finishes.get(face).copied())
        });
    }

    fn add_solid(
        &mut self,
        name: &str,
        medium: lumiduct_core::scene::MediumId,
        priority: i32,
        volume: Option<f64>,
    ) -> SolidId {
        self.builder.add_solid(Solid {
            name: name.to_owned(),
            medium,
            priority,
            bounds: Aabb::EMPTY,
            volume,
        })
    }

    fn solid_surfaces(&mut self, solid: &SolidSpec, frame: Frame, key: &Key) -> Option<Surfaces> {
        match solid {
            SolidSpec::Sweep(sweep) => self.sweep_surfaces(&sweep.shape, frame, key),
            SolidSpec::Cylinder(cylinder) => {
                self.sweep_surfaces(&cylinder_sweep(&cylinder.shape), frame, key)
            }
            SolidSpec::Box(cuboid) => self.sweep_surfaces(&box_sweep(&cuboid.shape), frame, key),
            SolidSpec::Tube(tube) => self.tube_surfaces(&tube.shape, frame, key),
            SolidSpec::Sphere(sphere) => {
                let radius = sphere.shape.radius_mm;
                let shape = Shape::Sphere(Sphere::zone(frame, radius, -radius, radius));
                let volume = Some(4.0 / 3.0 * PI * radius.powi(3));
                Some(Surfaces { faces: vec![NamedFace::wall("surface", shape)], volume })
            }
            SolidSpec::Lens(lens) => self.lens_surfaces(&lens.shape, frame, key),
            SolidSpec::CompoundParabolic(cpc) => self.compound_parabolic(&cpc.shape, frame, key),
            SolidSpec::Paraboloid(paraboloid) => Some(self.paraboloid(&paraboloid.shape, frame)),
            // The faces of meshes come from a file.
            SolidSpec::Mesh(_) => None,
        }
    }

    /// Finishes by face name: `wall` applies to all walls, the name of a side overrides it.
    pub(super) fn face_finishes(
        &mut self,
        body: &str,
        faces: &[NamedFace],
        declared: &IndexMap<String, FinishRef>,
        key: &Key,
    ) -> IndexMap<String, FinishId> {
        let mut finishes = IndexMap::new();
        for (name, reference) in declared {
            let Some(finish) = self.finish(reference) else { continue };
            let named: Vec<&NamedFace> = faces
                .iter()
                .filter(|face| {
                    face.name == *name || (name == "wall" && face.part == BodyPart::Wall)
                })
                .collect();
            if named.is_empty() {
                let known: Vec<&str> = faces.iter().map(|face| face.name.as_str()).collect();
                let hint = face_hint(name, known.iter().copied());
                self.problems
                    .error(&key.field(name), format!("`{body}` has no face `{name}`"))
                    .hint(hint);
            }
            for face in named {
                if face.name == *name {
                    finishes.insert(face.name.clone(), finish);
                } else {
                    finishes.entry(face.name.clone()).or_insert(finish);
                }
            }
        }
        finishes
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
    SweepSpec {
        profile: ProfileSpec::Circle(CircleSpec { radius_mm: spec.radius_mm }),
        path: vec![LegSpec::Straight(StraightSpec { straight_mm: spec.length_mm, end_scale })],
    }
}

fn box_sweep(spec: &BoxSpec) -> SweepSpec {
    let [width_mm, height_mm, length] = spec.size_mm;
    SweepSpec {
        profile: ProfileSpec::Rectangle(RectangleSpec { width_mm, height_mm }),
        path: vec![LegSpec::Straight(StraightSpec { straight_mm: length, end_scale: 1.0 })],
    }
}
