//! Open sheets and hollow ducts.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::lower::place::Facing;
use crate::lower::surfaces::{BodyPart, BodySurfaces, NamedFace};
use crate::spec::sheet::{SheetCommon, SheetSpec};
use indexmap::IndexMap;
use lumiduct_base::math::Frame;
use lumiduct_core::scene::Owner;
use lumiduct_core::scene::shape::{Flat, ParabolicCylinder, Region, Shape, Sphere};

impl<'a> Context<'a> {
    /// Builds a sheet or duct with its faces.
    pub(super) fn lower_sheet(
        &mut self,
        name: &str,
        sheet: &'a SheetSpec,
        key: &Key,
    ) -> Option<()> {
        let common = sheet.common();
        let (front, behind, behind_key) = match common {
            SheetCommon::Sheet(common) => (&common.finish, &common.back, "back"),
            SheetCommon::Duct(common) => (&common.finish, &common.outer, "outer"),
        };
        let front = self.finish(front, &key.field("finish"));
        let declared = match common {
            SheetCommon::Sheet(_) => IndexMap::new(),
            SheetCommon::Duct(common) => self.declared(&common.faces, &key.field("faces")),
        };
        let place = key.field(behind_key);
        let behind = behind.as_ref().and_then(|behind| self.finish(behind, &place));
        let frame = self.place(common.at(), key, Facing::Away);
        // Whether a shape is possible does not depend on its place.
        let surfaces = self.sheet_surfaces(sheet, frame.unwrap_or(Frame::WORLD), key)?;
        match common {
            SheetCommon::Sheet(_) => {
                let back = self.declared_behind(front, behind, &place).or(front);
                self.may_build(key).and(frame)?;
                self.add_faces(name, Owner::Sheet, surfaces.faces, |_, _| (front, back));
            }
            SheetCommon::Duct(_) => {
                let faces = &surfaces.faces;
                let inside = self.face_finishes(name, faces, &declared, &key.field("faces"));
                let black = self.finishes.get("black").copied();
                let walls = faces.iter().filter(|face| face.part == BodyPart::Wall);
                let finishes: IndexMap<String, _> = walls
                    .map(|face| {
                        let inside = inside.get(&face.name).copied().or(front);
                        let outside = self.declared_behind(inside, behind, &place).or(black);
                        // The front is outside.
                        (face.name.clone(), (outside, inside))
                    })
                    .collect();
                self.may_build(key).and(frame)?;
                self.add_faces(name, Owner::Sheet, surfaces.faces, |_, face| {
                    finishes.get(face).copied().unwrap_or_default()
                });
            }
        }
        Some(())
    }

    fn sheet_surfaces(
        &mut self,
        sheet: &SheetSpec,
        frame: Frame,
        key: &Key,
    ) -> Option<BodySurfaces> {
        let flat = |region| Some(single(Shape::Flat(Flat::new(frame, region))));
        match sheet {
            SheetSpec::Disk(disk) => {
                flat(Region::Annulus { inner: 0.0, outer: disk.shape.radius_mm })
            }
            SheetSpec::Annulus(ring) => {
                let (inner, outer) = (ring.shape.inner_radius_mm, ring.shape.outer_radius_mm);
                let (small, large) = (("inner_radius_mm", inner), ("outer_radius_mm", outer));
                self.require_order(key, small, large)?;
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
                let (min, max) = (spec.x_min_mm, spec.x_max_mm);
                self.require_order(key, ("x_min_mm", min), ("x_max_mm", max))?;
                let (focal, length) = (spec.focal_length_mm, spec.length_mm);
                let shape = ParabolicCylinder::new(frame, focal, min, max, length);
                Some(single(Shape::ParabolicCylinder(shape)))
            }
            SheetSpec::Tube(tube) => self.sweep_surfaces(&tube.shape, frame, key),
            SheetSpec::CompoundParabolic(cpc) => self.compound_parabolic(&cpc.shape, frame, key),
            SheetSpec::Paraboloid(paraboloid) => self.paraboloid(&paraboloid.shape, frame, key),
        }
    }
}

/// A sheet of one face.
fn single(shape: Shape) -> BodySurfaces {
    BodySurfaces { faces: vec![NamedFace::wall("surface", shape)], volume: None }
}
