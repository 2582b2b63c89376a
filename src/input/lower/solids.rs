//! Closed bodies.

use crate::input::keys::Key;
use crate::input::lower::Context;
use crate::input::lower::place::Facing;
use crate::input::lower::surfaces::{BodyPart, Ends, NamedFace, Surfaces, disk_facing};
use crate::input::problems::name_hint;
use crate::input::spec::finish::FinishRef;
use crate::input::spec::solid::{BoxSpec, CylinderSpec, LensSpec, SolidSpec};
use crate::input::spec::sweep::{
    CircleSpec, LegSpec, ProfileSpec, RectangleSpec, StraightSpec, SweepSpec,
};
use crate::math::{Aabb, Frame};
use crate::scene::shape::{Cylinder, Shape, Sphere};
use crate::scene::{FaceId, FaceSpec, FinishId, Owner, Solid, SolidId};
use indexmap::IndexMap;
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
            let volume = Some(crate::formats::mesh::health(&mesh).signed_volume_mm3);
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
        medium: crate::scene::MediumId,
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
            // Meshes bring their faces from a file.
            SolidSpec::Mesh(_) => None,
        }
    }

    /// A lens: two caps or disks and the edge between them.
    fn lens_surfaces(&mut self, lens: &LensSpec, frame: Frame, key: &Key) -> Option<Surfaces> {
        let rim = 0.5 * lens.diameter_mm;
        for (field, radius) in
            [("entry_radius_mm", lens.entry_radius_mm), ("exit_radius_mm", lens.exit_radius_mm)]
        {
            if let Some(radius) = radius
                && radius.abs() < rim
            {
                self.problems.error(
                    &key.field(field),
                    format!(
                        "a sphere of radius {} mm does not reach the rim at {rim} mm",
                        radius.abs()
                    ),
                );
                return None;
            }
        }
        let thickness = lens.thickness_mm;
        let (entry, entry_edge) = lens_end(frame, 0.0, lens.entry_radius_mm, rim, Ends::Entry);
        let (exit, exit_edge) = lens_end(frame, thickness, lens.exit_radius_mm, rim, Ends::Exit);
        let edge = exit_edge - entry_edge;
        // A hemisphere's rim meets its flat side: no edge is left but rounding.
        let no_edge = 1e-12 * lens.diameter_mm;
        if edge < -no_edge {
            self.problems
                .error(
                    &key.field("thickness_mm"),
                    format!("the two ends cross before the rim, by {:.6} mm", -edge),
                )
                .hint("make the lens thicker, its diameter smaller or its ends flatter");
            return None;
        }
        let mut faces = vec![NamedFace::end("entry", entry), NamedFace::end("exit", exit)];
        if edge > no_edge {
            let wall = Cylinder::new(frame.shifted(entry_edge * frame.z), rim, edge);
            faces.push(NamedFace::wall("wall", Shape::Cylinder(wall)));
        }
        Some(Surfaces { faces, volume: None })
    }

    /// Finishes by face name: `wall` stands for all walls, a side's own name wins over it.
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
                let hint = name_hint(name, known.iter().copied());
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

/// One end of a lens with its vertex at `vertex` on the axis, and where it meets the rim.
fn lens_end(frame: Frame, vertex: f64, radius: Option<f64>, rim: f64, end: Ends) -> (Shape, f64) {
    let Some(radius) = radius else { return (disk_facing(frame, vertex, rim, end), vertex) };
    let size = radius.abs();
    let sag = rim * rim / (size + (size * size - rim * rim).sqrt());
    let center = frame.shifted((vertex + radius) * frame.z);
    // Seen from the centre the vertex lies against the axis for a positive radius.
    let (shape, edge) = if radius > 0.0 {
        (Sphere::zone(center, size, -size, sag - size), vertex + sag)
    } else {
        (Sphere::zone(center, size, size - sag, size), vertex - sag)
    };
    // Convex ends face away from their centre, as a sphere does.
    let convex = (end == Ends::Entry) == (radius > 0.0);
    (Shape::Sphere(if convex { shape } else { shape.inward() }), edge)
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
