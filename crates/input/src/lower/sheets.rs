//! Open sheets and hollow ducts.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::lower::place::Facing;
use crate::lower::surfaces::{BodyPart, NamedFace, Surfaces};
use crate::spec::sheet::{DuctCommonSpec, SheetCommon, SheetCommonSpec, SheetSpec};
use indexmap::IndexMap;
use lumiduct_base::math::Frame;
use lumiduct_core::scene::Owner;
use lumiduct_core::scene::shape::{Flat, ParabolicCylinder, Region, Shape, Sphere};

impl Context<'_> {
    /// Builds a sheet or duct with its faces.
    pub(super) fn lower_sheet(&mut self, name: &str) {
        let spec = self.spec;
        let sheet = &spec.sheets[name];
        let key = Key::of(&["sheets", name, sheet.kind()]);
        let common = sheet.common();
        let Some(frame) = self.place(common.at(), &key, Facing::Away) else { return };
        let Some(surfaces) = self.sheet_surfaces(sheet, frame, &key) else { return };
        match common {
            SheetCommon::Sheet(common) => self.add_sheet(name, surfaces, common, &key),
            SheetCommon::Duct(common) => self.add_duct(name, surfaces, common, &key),
        }
    }

    fn add_sheet(&mut self, name: &str, surfaces: Surfaces, common: &SheetCommonSpec, key: &Key) {
        let front = self.finish(&common.finish);
        let back = self.declared_behind(front, common.back.as_ref(), &key.field("back")).or(front);
        self.add_faces(name, Owner::Sheet, surfaces.faces, |_, _| (front, back));
    }

    fn add_duct(&mut self, name: &str, surfaces: Surfaces, common: &DuctCommonSpec, key: &Key) {
        let inner = self.finish(&common.finish);
        let finishes =
            self.face_finishes(name, &surfaces.faces, &common.faces, &key.field("faces"));
        let black = self.finishes.get("black").copied();
        let mut outer = IndexMap::new();
        for face in surfaces.faces.iter().filter(|face| face.part == BodyPart::Wall) {
            let inside = finishes.get(&face.name).copied().or(inner);
            let declared = common.outer.as_ref();
            let outside = self.declared_behind(inside, declared, &key.field("outer")).or(black);
            outer.insert(face.name.clone(), outside);
        }
        self.add_faces(name, Owner::Sheet, surfaces.faces, |part, face| match part {
            // The front is outside.
            BodyPart::Wall => {
                (outer.get(face).copied().flatten(), finishes.get(face).copied().or(inner))
            }
            BodyPart::End => (None, None),
        });
    }

    fn sheet_surfaces(&mut self, sheet: &SheetSpec, frame: Frame, key: &Key) -> Option<Surfaces> {
        let flat = |region| Some(single(Shape::Flat(Flat::new(frame, region))));
        match sheet {
            SheetSpec::Disk(disk) => {
                flat(Region::Annulus { inner: 0.0, outer: disk.shape.radius_mm })
            }
            SheetSpec::Annulus(ring) => {
                let (inner, outer) = (ring.shape.inner_radius_mm, ring.shape.outer_radius_mm);
                flat(Region::Annulus { inner, outer })
            }
            SheetSpec::Rectangle(r) => flat(Region::Rectangle {
                half_x: 0.5 * r.shape.width_mm,
                half_y: 0.5 * r.shape.height_mm,
            }),
            SheetSpec::SphericalCap(cap) => {
                let radius = cap.shape.sphere.radius_mm;
                let z_min = radius * cap.shape.half_angle_deg.to_radians().cos();
                Some(single(Shape::Sphere(Sphere::zone(frame, radius, z_min, radius))))
            }
            SheetSpec::ParabolicCylinder(trough) => {
                let spec = &trough.shape;
                let shape = ParabolicCylinder::new(
                    frame,
                    spec.focal_length_mm,
                    spec.x_min_mm,
                    spec.x_max_mm,
                    spec.length_mm,
                );
                Some(single(Shape::ParabolicCylinder(shape)))
            }
            SheetSpec::Tube(tube) => self.sweep_surfaces(&tube.shape, frame, key),
            SheetSpec::CompoundParabolic(cpc) => self.compound_parabolic(&cpc.shape, frame, key),
            SheetSpec::Paraboloid(paraboloid) => Some(self.paraboloid(&paraboloid.shape, frame)),
        }
    }
}

/// A sheet of one face.
fn single(shape: Shape) -> Surfaces {
    Surfaces { faces: vec![NamedFace::wall("surface", shape)], volume: None }
}
