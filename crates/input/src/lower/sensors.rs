//! Sensors: cells on faces and ports, goniometers, directions of view.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::lower::place::Facing;
use crate::lower::sensor_keys::Division;
use crate::lower::surfaces::tilted;
use crate::spec::sensor::{
    CountsSpec, DirectionSpec, GoniometerSpec, ImageSpec, LuminanceSpec, PassageSpec,
    SensorKindSpec, SensorSide, SensorSpec,
};
use glam::DVec2;
use lumiduct_base::math::Frame;
use lumiduct_core::scene::shape::{ChartRect, Flat, Region, Shape};
use lumiduct_core::scene::{
    CountedLight, FaceId, FacePiece, FaceSpec, Goniometer, Grid, Owner, Passage, Pixels, Place,
    Scene, Seeing, Sensor, SensorKind, Sides, SurfaceSensor, Views,
};
use std::f64::consts::PI;

impl Context<'_> {
    pub(super) fn lower_sensors(&mut self) {
        let spec = self.spec;
        for (name, sensor) in &spec.sensors {
            self.lower_sensor(name, sensor, &Key::of(&["sensors", name]));
        }
    }

    fn lower_sensor(&mut self, name: &str, spec: &SensorSpec, key: &Key) -> Option<()> {
        let kind = spec.kind()?;
        self.check_keys(spec, kind, key);
        let inner = key.field(kind.name());
        let made = match kind {
            SensorKindSpec::Plane(plane) => {
                let region = self.region(spec, &plane.area, &inner);
                let division = self.division(plane, &inner);
                let surface = self.surface(name, spec, region, division, key);
                surface.map(SensorKind::Surface)
            }
            SensorKindSpec::Luminance(luminance) => {
                let region = self.region(spec, &luminance.area, &inner);
                self.luminance(name, spec, region, luminance, key).map(SensorKind::Surface)
            }
            SensorKindSpec::Image(image) => {
                self.image(name, spec, image, key).map(SensorKind::Surface)
            }
            SensorKindSpec::Goniometer(goniometer) => {
                self.goniometer(spec, goniometer, key).map(SensorKind::Goniometer)
            }
        };
        let goniometer = match &made {
            Some(SensorKind::Goniometer(goniometer)) => Some(goniometer),
            Some(SensorKind::Surface(_)) | None => None,
        };
        self.lower_luminaire_export(name, spec, goniometer, key);
        let aim = self.aim(spec, key);
        let entering = spec.entering.as_ref();
        let entering = entering.and_then(|face| self.faces_named(face, &key.field("entering")));
        let entering = entering.map(|faces| faces[0]);
        self.may_build(key)?;
        let kind = made?;
        let sensor =
            self.builder.add_sensor(Sensor { name: name.to_owned(), kind, aim: aim?, entering });
        self.lower_ray_export(spec, sensor, key)
    }

    fn aim(&mut self, spec: &SensorSpec, key: &Key) -> Option<Vec<FaceId>> {
        let key = key.field("aim");
        let aims = spec.aim.iter().flatten().enumerate();
        let faces: Vec<_> =
            aims.map(|(index, face)| self.faces_named(face, &key.index(index))).collect();
        Some(faces.into_iter().collect::<Option<Vec<_>>>()?.concat())
    }

    fn luminance(
        &mut self,
        name: &str,
        spec: &SensorSpec,
        region: Option<Region>,
        luminance: &LuminanceSpec,
        key: &Key,
    ) -> Option<SurfaceSensor> {
        let [nx, ny] = luminance.cells;
        let cells = f64::from(nx) * f64::from(ny) * luminance.directions.len() as f64;
        let good = self.check_cells(cells, &key.field("luminance").field("cells"));
        let division = good.map(|()| Division::Cells(luminance.cells));
        let mut sensor = self.surface(name, spec, region, division, key)?;
        let Some(frame) = sensor.frame else {
            let message =
                "a luminance sensor needs a flat face: its directions refer to one normal";
            let hint = "choose an end face, or place a plane with `at`";
            return self.refuse(&key.field("on"), message, hint);
        };
        sensor.seeing = Seeing::Views(views(luminance, &frame));
        Some(sensor)
    }

    fn image(
        &mut self,
        name: &str,
        spec: &SensorSpec,
        image: &ImageSpec,
        key: &Key,
    ) -> Option<SurfaceSensor> {
        let inner = key.field("image");
        let [columns, rows] = image.pixels;
        let good = self.check_cells(f64::from(columns) * f64::from(rows), &inner.field("pixels"));
        if spec.on.is_some() {
            // Reported: an image has no face, and its aperture is flat.
            return None;
        }
        let region = self.region(spec, &image.area, &inner);
        let whole = good.map(|()| Division::Cells([1, 1]));
        let mut sensor = self.surface(name, spec, region, whole, key)?;
        let pixels = image.pixels.map(|count| count as usize);
        let pixels = Pixels::new(&sensor.frame?, pixels, image.pixel_deg.to_radians());
        sensor.seeing = Seeing::Pixels(Box::new(pixels));
        Some(sensor)
    }

    fn goniometer(
        &mut self,
        spec: &SensorSpec,
        goniometer: &GoniometerSpec,
        key: &Key,
    ) -> Option<Goniometer> {
        // The pole points along the light that leaves the face.
        let frame = self.place(spec.at.as_ref(), key, Facing::Away);
        let key = key.field("goniometer");
        let c_cells = self.steps(goniometer.c_step_deg, 360.0, &key.field("c_step_deg"));
        let gamma_cells =
            self.steps(goniometer.gamma_step_deg, 180.0, &key.field("gamma_step_deg"));
        let (c_cells, gamma_cells) = c_cells.zip(gamma_cells)?;
        self.check_cells(c_cells * gamma_cells, &key)?;
        Some(Goniometer {
            frame: frame?,
            c_cells: c_cells.round() as usize,
            gamma_cells: gamma_cells.round() as usize,
            radius: goniometer.radius_mm,
        })
    }

    /// The faces, cells and sides of a surface sensor, on a face or with a region of its own.
    fn surface(
        &mut self,
        name: &str,
        spec: &SensorSpec,
        region: Option<Region>,
        division: Option<Division>,
        key: &Key,
    ) -> Option<SurfaceSensor> {
        let (faces, place) = match &spec.on {
            Some(on) => self.on_faces(on, &key.field("on"))?,
            None => self.own_face(name, spec, region, key)?,
        };
        self.may_build(key)?;
        let division = division?;
        let counts = match spec.counts {
            Some(CountsSpec::Leaving) => CountedLight::Leaving,
            Some(CountsSpec::Incident) | None => CountedLight::Incident,
        };
        let sides = match (spec.side, spec.counts) {
            (Some(SensorSide::Front), _) => Sides::Front,
            (Some(SensorSide::Back), _) => Sides::Back,
            (Some(SensorSide::Both), _) | (None, Some(CountsSpec::Incident)) => Sides::Both,
            (None, Some(CountsSpec::Leaving) | None) => Sides::Front,
        };
        let scene = self.builder.scene();
        let frame = match faces.as_slice() {
            [face] => scene.face_plane(*face),
            _ => None,
        };
        let Some(grid) = grid(scene, &faces, division) else {
            let (message, hint) = match division {
                Division::Rings(..) => (
                    "rings and sectors need a round, flat sensor",
                    "use `cells = [nx, ny]` on a face that is flat or swept",
                ),
                Division::Cells(_) => (
                    "a face of a mesh that is curved, or part of several copies, cannot be unrolled into cells",
                    "use `plane = {}`, one cell over the whole face, or place a `plane` with cells before \
                        it with `at`",
                ),
            };
            return self.refuse(key, message, hint);
        };
        let whole: Vec<Option<f64>> = faces.iter().map(|face| curved_area(scene, *face)).collect();
        let area_in = |rect| {
            let area = |(face, whole): (&FaceId, &Option<f64>)| {
                whole.unwrap_or_else(|| scene.face_area_in(*face, rect))
            };
            faces.iter().zip(&whole).map(area).sum::<f64>()
        };
        let areas = grid.cell_areas(area_in);
        let covered = grid
            .cell_cover(|rect| faces.iter().map(|face| scene.face_charted_in(*face, rect)).sum());
        let seeing = Seeing::All;
        let passage = match spec.passage {
            PassageSpec::Every => Passage::Every,
            PassageSpec::First => Passage::First,
        };
        Some(SurfaceSensor {
            faces,
            place,
            counts,
            sides,
            passage,
            grid,
            areas,
            covered,
            seeing,
            frame,
        })
    }

    fn on_faces(&mut self, on: &str, key: &Key) -> Option<(Vec<FaceId>, Place)> {
        let faces = self.faces_named(on, key)?;
        let scene = self.builder.scene();
        if let Some(relief) = scene.reliefs.iter().find(|relief| relief.name == on) {
            let wall = &scene.faces[relief.wall.index()].name;
            let hint = format!(
                "put the sensor on `{wall}` or on a plane before it; the flux balance has the light that \
                    goes through the relief"
            );
            let message = format!("`{on}` is a relief, which does not unroll into a map");
            return self.refuse(key, message, hint);
        }
        let port = faces.iter().any(|face| scene.faces[face.index()].owner == Owner::Port);
        Some((faces, if port { Place::Port } else { Place::Face }))
    }

    /// The own face of a free sensor: a port that light passes, or a sheet that absorbs.
    fn own_face(
        &mut self,
        name: &str,
        spec: &SensorSpec,
        region: Option<Region>,
        key: &Key,
    ) -> Option<(Vec<FaceId>, Place)> {
        let frame = self.place(spec.at.as_ref(), key, Facing::Toward)?;
        self.may_build(key)?;
        let black = self.finishes.get("black").copied().filter(|_| spec.absorbing);
        let (owner, place) =
            if spec.absorbing { (Owner::Sheet, Place::Face) } else { (Owner::Port, Place::Port) };
        let face = self.builder.add_face(FaceSpec {
            name: name.to_owned(),
            owner,
            front: black,
            back: black,
            pieces: vec![FacePiece::whole(Shape::Flat(Flat::new(frame, region?)))],
        });
        Some((vec![face], place))
    }
}

/// The grid over some faces; `None` if rings are requested on a face that is not round and flat, or
/// several cells on one that cannot be unrolled.
fn grid(scene: &Scene, faces: &[FaceId], division: Division) -> Option<Grid> {
    let rects: Option<Vec<ChartRect>> = match division {
        Division::Cells([1, 1]) => {
            Some(faces.iter().map(|face| whole_rect(scene, *face)).collect())
        }
        Division::Cells(_) | Division::Rings(..) => {
            faces.iter().map(|face| scene.face_rect(*face)).collect()
        }
    };
    let rect = rects?.into_iter().reduce(ChartRect::union)?;
    match division {
        Division::Cells([nu, nv]) => {
            Some(Grid::Cartesian { rect, nu: nu as usize, nv: nv as usize })
        }
        Division::Rings(rings, sectors) => {
            let [face] = faces else { return None };
            let radius = scene.face_disk_radius(*face)?;
            Some(Grid::Polar { radius, rings: rings as usize, sectors: sectors as usize })
        }
    }
}

/// The rectangle of a face that is one cell. All points of a curved face of a mesh have the
/// coordinates (0, 0), so a square of the same area around them contains all of it.
fn whole_rect(scene: &Scene, face: FaceId) -> ChartRect {
    scene.face_rect(face).unwrap_or_else(|| {
        let max = DVec2::splat(0.5 * scene.face_area(face).sqrt());
        ChartRect { min: -max, max }
    })
}

/// The area of a curved face of a mesh, mm², which is one cell; `None` for all other faces.
fn curved_area(scene: &Scene, face: FaceId) -> Option<f64> {
    scene.face_rect(face).is_none().then(|| scene.face_area(face))
}

/// The directions of a luminance sensor with the projected solid angle of each cone.
fn views(luminance: &LuminanceSpec, frame: &Frame) -> Views {
    let half_angle = luminance.acceptance_half_angle_deg.to_radians();
    let local = |direction: &DirectionSpec| tilted(direction.theta_deg, direction.phi_deg);
    Views {
        directions: luminance
            .directions
            .iter()
            .map(|direction| frame.to_world(local(direction)))
            .collect(),
        half_angle,
        projected: luminance
            .directions
            .iter()
            .map(|direction| projected_cone(direction.theta_deg.to_radians(), half_angle))
            .collect(),
    }
}

/// Projected solid angle of the part of a cone above the surface, sr: π sin²h cos θ if the whole
/// cone is; else by the midpoint rule over its rings.
fn projected_cone(tilt: f64, half_angle: f64) -> f64 {
    if tilt + half_angle <= 0.5 * PI {
        return PI * half_angle.sin().powi(2) * tilt.cos();
    }
    let (rings, sectors) = (400, 400);
    let step = half_angle / f64::from(rings);
    let mut sum = 0.0;
    for ring in 0..rings {
        let (sin, cos) = (step * (f64::from(ring) + 0.5)).sin_cos();
        for sector in 0..sectors {
            let phi = 2.0 * PI * (f64::from(sector) + 0.5) / f64::from(sectors);
            sum += (cos * tilt.cos() + sin * phi.cos() * tilt.sin()).max(0.0) * sin;
        }
    }
    sum * step * 2.0 * PI / f64::from(sectors)
}
