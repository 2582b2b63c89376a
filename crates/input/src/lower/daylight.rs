//! The sun and the sky: where their light starts, its directions, and its flux.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::lower::sun::{SOUTH_DEG, Sun};
use crate::lower::weathers::{Daylight, Member, group};
use crate::problems::name_hint;
use crate::spec::daylight::{SkyModelSpec, SkySpec, SunSpec};
use glam::DVec3;
use lumiduct_base::math::{Aabb, Frame};
use lumiduct_base::units::per_m2_to_per_mm2;
use lumiduct_core::optics::SkyModel;
use lumiduct_core::scene::mesh::MeshBody;
use lumiduct_core::scene::shape::Shape;
use lumiduct_core::scene::{
    Emission, EmitSide, Emitter, EmitterKind, FaceId, Owner, Sky, Source, SourceId, StartSolids,
    SunAngles,
};
use std::f64::consts::{FRAC_PI_2, PI};

/// Ratio of the sphere from which light starts to what it must contain, 1.
const ROOM: f64 = 1.01;
/// Areas of surfaces that differ by at most this, relative, are the same.
const SAME_AREA: f64 = 1e-9;
/// Type number of the clear sky of low turbidity, CIE S 011/E:2003.
const CLEAR: usize = 12;

/// Where light from infinity starts.
#[derive(Clone)]
struct Aim {
    emitter: Emitter,
    kind: EmitterKind,
    /// The frame that laws of emission refer to.
    frame: Frame,
    /// The area that multiplies luminance times projected solid angle, mm².
    area: f64,
    start: StartSolids,
}

/// A ball around a thing that light is aimed at.
struct Ball {
    center: DVec3,
    /// mm
    radius: f64,
}

/// Emission of a daylight source.
#[derive(Debug)]
struct FarLight {
    emission: Emission,
    /// lm
    flux: f64,
    /// Elevation of a sun, rad.
    elevation: Option<f64>,
    sun: Option<SunAngles>,
}

impl Context<'_> {
    pub(super) fn lower_sun(&mut self, name: &str, spec: &SunSpec, key: &Key) {
        let azimuth = spec.place.azimuth_deg.unwrap_or(SOUTH_DEG);
        let Some(elevations) = &spec.elevations_deg else {
            let sun = self.sun(&spec.place, key);
            let aim = self.aim_of_daylight(&spec.common.aim, key);
            if let Some((sun, aim)) = sun.zip(aim) {
                self.add_sun(name, spec, sun, aim, key);
            }
            return;
        };
        let Some(aim) = self.aim_of_daylight(&spec.common.aim, key) else { return };
        for (index, &elevation) in elevations.iter().enumerate() {
            let own = format!("{name}_{}", elevation.to_string().replace('.', "_"));
            if self.is_taken(&own) {
                let message = format!("makes a source `{own}`, but that name is taken");
                let at = key.field("elevations_deg").index(index);
                let hint = "give each elevation once, and do not use this name elsewhere";
                self.problems.error(&at, message).hint(hint);
            } else {
                self.add_sun(&own, spec, Sun::new(elevation, azimuth), aim.clone(), key);
            }
        }
    }

    /// Whether a name is taken in the file or by a source made so far.
    pub(super) fn is_taken(&self, name: &str) -> bool {
        let spec = self.spec;
        spec.sources.contains_key(name)
            || spec.sensors.contains_key(name)
            || spec.solids.contains_key(name)
            || spec.sheets.contains_key(name)
            || self.builder.scene().sources.iter().any(|source| source.name == name)
    }

    fn add_sun(&mut self, name: &str, spec: &SunSpec, sun: Sun, aim: Aim, key: &Key) -> Option<()> {
        self.may_build(key)?;
        let world = self.sky_frame()?;
        let half_angle = spec.half_angle_deg.to_radians();
        let axis = aim.frame.to_local(-world.to_world(sun.toward));
        if aim.kind == EmitterKind::Surface && axis.z <= half_angle.sin() {
            let message = format!("the sun is not in front of the plane of `{}`", spec.common.aim);
            let hint = "turn the face to the sun, or aim at a solid or sheet by its name";
            return self.refuse(&key.field("aim"), message, hint);
        }
        // E = π L sin²h on a plane normal to the axis.
        let luminance = per_m2_to_per_mm2(spec.illuminance_lx) / (PI * half_angle.sin().powi(2));
        let projected = match aim.kind {
            EmitterKind::Surface => PI * half_angle.sin().powi(2) * axis.z,
            EmitterKind::Far | EmitterKind::Point | EmitterKind::Volume => {
                4.0 * PI * (0.5 * half_angle).sin().powi(2)
            }
        };
        let emission = Emission::Cone { half_angle, axis };
        let per_area = luminance * projected;
        let amount = key.field("illuminance_lx");
        let flux = self.carried([spec.illuminance_lx, per_area * aim.area], &amount)?;
        let flux = if spec.common.enabled { flux } else { 0.0 };
        let angles = Some(sun.angles());
        let light = FarLight { emission, flux, elevation: Some(sun.elevation), sun: angles };
        let source = self.add_daylight(name, aim, light);
        let daylight = Daylight::Sun(sun.toward);
        self.members.push(Member {
            source,
            group: group(spec.common.group.as_ref(), key),
            daylight: Some(daylight),
        });
        Some(())
    }

    pub(super) fn lower_sky(&mut self, name: &str, spec: &SkySpec, key: &Key) -> Option<()> {
        let place = &spec.place;
        self.check_need(spec.model, place, key);
        let has_sun = place.elevation_deg.is_some() || place.when.is_some();
        // Only skies without dependence on the azimuth have none.
        let zenith = Sun::new(FRAC_PI_2.to_degrees(), SOUTH_DEG);
        let sun = if has_sun { self.sun(place, key) } else { Some(zenith) };
        let aim = self.aim_of_daylight(&spec.common.aim, key);
        self.may_build(key)?;
        let (sun, aim) = sun.zip(aim)?;
        let model = match spec.model {
            SkyModelSpec::Uniform => Some(SkyModel::uniform()),
            SkyModelSpec::Overcast => Some(SkyModel::overcast()),
            SkyModelSpec::Clear => SkyModel::of_type(CLEAR, sun.toward),
            SkyModelSpec::CieType(number) => SkyModel::of_type(number as usize, sun.toward),
        }?;
        let world = self.sky_frame()?;
        let local = |axis: DVec3| aim.frame.to_local(axis);
        let axes =
            Frame { origin: DVec3::ZERO, x: local(world.x), y: local(world.y), z: local(world.z) };
        let sky = Sky::new(model, axes);
        if aim.kind == EmitterKind::Surface && !sky.is_seen_by_surface() {
            let message = format!("`{}` faces the ground and sees no sky", spec.common.aim);
            let hint = "turn the face up, or set the direction `up`";
            return self.refuse(&key.field("aim"), message, hint);
        }
        let level = spec.horizontal_illuminance_lx.map(|lx| lx / sky.level_illuminance());
        let zenith = spec.zenith_luminance_cd_m2.or(level)?;
        let per_area = per_m2_to_per_mm2(zenith) * sky.projected_solid_angle(aim.kind);
        let (amount, stated) = match (spec.zenith_luminance_cd_m2, spec.horizontal_illuminance_lx) {
            (Some(stated), _) => ("zenith_luminance_cd_m2", stated),
            (None, stated) => ("horizontal_illuminance_lx", stated.unwrap_or(0.0)),
        };
        let flux = self.carried([stated, per_area * aim.area], &key.field(amount))?;
        let flux = if spec.common.enabled { flux } else { 0.0 };
        let angles = has_sun.then(|| sun.angles());
        let light = FarLight { emission: Emission::Sky(sky), flux, elevation: None, sun: angles };
        let source = self.add_daylight(name, aim, light);
        let daylight = Daylight::of_sky(spec, has_sun.then_some(sun.toward));
        self.members.push(Member {
            source,
            group: group(spec.common.group.as_ref(), key),
            daylight: Some(daylight),
        });
        Some(())
    }

    fn add_daylight(&mut self, name: &str, aim: Aim, light: FarLight) -> SourceId {
        let FarLight { emission, flux, elevation, sun } = light;
        self.builder.add_source(Source {
            name: name.to_owned(),
            flux,
            emitter: aim.emitter,
            emission,
            start: aim.start,
            on: Vec::new(),
            spectrum: self.spectrum.clone(),
            elevation,
            sun,
        })
    }

    /// Where light aimed at a flat face, a solid or a sheet starts.
    fn aim_of_daylight(&mut self, name: &str, key: &Key) -> Option<Aim> {
        let key = key.field("aim");
        if let Some(ball) = self.ball_around(name) {
            return Some(self.aim_at_body(ball));
        }
        let bodies: Vec<&str> =
            self.names("solids").into_iter().chain(self.names("sheets")).collect();
        if bodies.contains(&name) {
            // It could not be built, which has been reported.
            return None;
        }
        if !name.contains('.') {
            let hint = name_hint(name, bodies.iter().copied());
            return self.refuse(&key, format!("unknown solid or sheet `{name}`"), hint);
        }
        let faces = self.faces_named(name, &key)?;
        self.aim_at_face(name, &faces, &key)
    }

    /// A ball around a solid or sheet.
    fn ball_around(&self, name: &str) -> Option<Ball> {
        let scene = self.builder.scene();
        let is_part =
            |face: &str| face.strip_prefix(name).is_some_and(|rest| rest.starts_with('.'));
        let faces = scene.faces.iter().enumerate().filter(|(_, face)| is_part(&face.name));
        let patches = faces.flat_map(|(index, _)| scene.face_patches(FaceId::new(index)));
        let shapes: Vec<&Shape> = patches.map(|patch| &patch.shape).collect();
        let bounds = shapes.iter().fold(Aabb::EMPTY, |sum, shape| sum.union(shape.bounds()));
        let solid = scene.solids.iter().find(|solid| solid.name == name);
        let bounds = solid.map_or(bounds, |solid| solid.bounds);
        if bounds.is_empty() {
            return None;
        }
        let (center, half) = (bounds.center(), 0.5 * (bounds.max - bounds.min));
        // A whole sphere touches the sides of its box, but not the corners.
        let sphere_area = 4.0 * PI * half.x * half.x;
        let is_whole = |shape: &Shape| (shape.area() / sphere_area - 1.0).abs() < SAME_AREA;
        let is_sphere = matches!(shapes.as_slice(), [shape @ Shape::Sphere(_)] if is_whole(shape));
        Some(Ball { center, radius: if is_sphere { half.x } else { half.length() } })
    }

    /// Light starts outside all solids and sheets, so that those in its way cast shadows.
    fn aim_at_body(&self, ball: Ball) -> Aim {
        let Ball { center, radius } = ball;
        let bodies = self.builder.scene();
        let patches = bodies.patches.iter().map(|patch| patch.shape.bounds());
        let all = patches.chain(bodies.mesh_bodies().map(MeshBody::bounds));
        let all = all.fold(Aabb::of([center]).grown(radius), Aabb::union);
        let farthest = (all.max - center).abs().max((all.min - center).abs()).length();
        Aim {
            emitter: Emitter::far(center, radius, ROOM * farthest),
            kind: EmitterKind::Far,
            frame: Frame::WORLD,
            area: PI * radius * radius,
            start: StartSolids::Outside,
        }
    }

    fn aim_at_face(&mut self, name: &str, faces: &[FaceId], key: &Key) -> Option<Aim> {
        let body = name.split('.').next().unwrap_or_default().to_owned();
        let instead = format!("aim at all of it: \"{body}\"");
        let scene = self.builder.scene();
        let (plane, owner) = match faces {
            [face] => (scene.face_plane(*face), scene.faces[face.index()].owner),
            [] | [_, _, ..] => (None, Owner::Sheet),
        };
        let patches = || faces.iter().flat_map(|face| scene.face_patches(*face));
        if patches().any(|patch| patch.trim.is_some()) {
            let message = format!("`{name}` has a relief, on which no light can start");
            return self.refuse(key, message, instead);
        }
        let shapes: Vec<_> = patches().map(|patch| patch.shape.clone()).collect();
        let (Some(plane), false) = (plane, shapes.is_empty()) else {
            let message = format!("`{name}` is not a single flat face");
            return self.refuse(key, message, instead);
        };
        if owner == Owner::Sheet {
            let message =
                format!("`{name}` is a sheet with two sides, on which no light can start");
            return self.refuse(key, message, instead);
        }
        // Half a turn about x: light goes in.
        let frame = Frame { y: -plane.y, z: -plane.z, ..plane };
        let emitter = Emitter::surface(shapes, EmitSide::Back, Some(frame));
        let area = emitter.area()?;
        // It must cross the face, as light from infinity does.
        Some(Aim { emitter, kind: EmitterKind::Surface, frame, area, start: StartSolids::Behind })
    }
}
