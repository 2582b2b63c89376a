//! Sensors: cells on faces and ports, goniometers, directions of view.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::lower::place::Facing;
use crate::lower::surfaces::tilted;
use crate::spec::sensor::{
    CountsSpec, DirectionSpec, GoniometerSpec, ImageSpec, LuminanceSpec, PassageSpec, PlaneSpec,
    SensorKind as KindSpec, SensorSide, SensorSpec,
};
use crate::spec::sweep::{CircleSpec, RectangleSpec};
use glam::DVec2;
use lumiduct_base::math::Frame;
use lumiduct_core::scene::shape::{ChartRect, Flat, Region, Shape};
use lumiduct_core::scene::{
    CountedLight, FaceId, FacePiece, FaceSpec, Goniometer, Grid, Owner, Passage, Pixels, Place,
    Scene, Seeing, Sensor, SensorKind, Sides, SurfaceSensor, Views,
};
use std::f64::consts::PI;

/// How a sensor is divided.
enum Division {
    Cells([u32; 2]),
    Rings(u32, u32),
}

impl Context<'_> {
    pub(super) fn lower_sensors(&mut self) {
        let spec = self.spec;
        for (name, sensor) in &spec.sensors {
            self.lower_sensor(name, sensor, &Key::of(&["sensors", name]));
        }
    }

    fn lower_sensor(&mut self, name: &str, spec: &SensorSpec, key: &Key) {
        let Some(kind) = spec.kind() else { return };
        let kind = match kind {
            KindSpec::Plane(plane) => {
                let division = division(plane);
                self.surface(name, spec, plane.rectangle, plane.disk, division, key)
                    .map(SensorKind::Surface)
            }
            KindSpec::Luminance(luminance) => {
                self.luminance(name, spec, luminance, key).map(SensorKind::Surface)
            }
            KindSpec::Image(image) => self.image(name, spec, image, key).map(SensorKind::Surface),
            KindSpec::Goniometer(goniometer) => {
                self.goniometer(spec, goniometer, key).map(SensorKind::Goniometer)
            }
        };
        let aim = self.aim(spec, key);
        let entering = match &spec.entering {
            Some(face) => self.faces_named(face, &key.field("entering")).map(|faces| faces[0]),
            None => None,
        };
        let (Some(kind), Some(aim)) = (kind, aim) else { return };
        self.builder.add_sensor(Sensor { name: name.to_owned(), kind, aim, entering });
    }

    fn aim(&mut self, spec: &SensorSpec, key: &Key) -> Option<Vec<FaceId>> {
        let mut faces = Vec::new();
        for (index, face) in spec.aim.iter().flatten().enumerate() {
            faces.extend(self.faces_named(face, &key.field("aim").index(index))?);
        }
        Some(faces)
    }

    fn luminance(
        &mut self,
        name: &str,
        spec: &SensorSpec,
        luminance: &LuminanceSpec,
        key: &Key,
    ) -> Option<SurfaceSensor> {
        let division = Division::Cells(luminance.cells);
        let mut sensor =
            self.surface(name, spec, luminance.rectangle, luminance.disk, division, key)?;
        let Some(frame) = sensor.frame else {
            self.problems
                .error(
                    &key.field("on"),
                    "a luminance sensor needs a flat face: its directions refer to one normal",
                )
                .hint("choose an end face, or a plane of its own by `at`");
            return None;
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
        let whole = Division::Cells([1, 1]);
        let mut sensor = self.surface(name, spec, image.rectangle, image.disk, whole, key)?;
        // Validated: an image has no face, its aperture is flat.
        let frame = sensor.frame?;
        let pixels = image.pixels.map(|count| count as usize);
        sensor.seeing =
            Seeing::Pixels(Box::new(Pixels::new(&frame, pixels, image.pixel_deg.to_radians())));
        Some(sensor)
    }

    fn goniometer(
        &mut self,
        spec: &SensorSpec,
        goniometer: &GoniometerSpec,
        key: &Key,
    ) -> Option<Goniometer> {
        // The pole points along the light that leaves the face.
        let frame = self.place(spec.at.as_ref(), key, Facing::Away)?;
        Some(Goniometer {
            frame,
            // Validated: the steps divide 360 and 180.
            c_cells: (360.0 / goniometer.c_step_deg).round() as usize,
            gamma_cells: (180.0 / goniometer.gamma_step_deg).round() as usize,
            radius: goniometer.radius_mm,
        })
    }

    /// The faces, cells and sides of a surface sensor.
    fn surface(
        &mut self,
        name: &str,
        spec: &SensorSpec,
        rectangle: Option<RectangleSpec>,
        disk: Option<CircleSpec>,
        division: Division,
        key: &Key,
    ) -> Option<SurfaceSensor> {
        let (faces, place) = match &spec.on {
            Some(on) => self.on_faces(on, key)?,
            None => self.own_face(name, spec, rectangle, disk, key)?,
        };
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
        let Some(grid) = grid(scene, &faces, &division) else {
            let (wanted, hint) = match division {
                Division::Rings(..) => (
                    "rings and sectors need a round, flat sensor",
                    "use `cells = [nx, ny]` on a face that is flat or swept",
                ),
                Division::Cells(_) => (
                    "a curved face of a mesh cannot be unrolled into cells",
                    "use `plane = {}`, one cell over the whole face, or put a `plane` with cells of its own before it by `at`",
                ),
            };
            self.problems.error(key, wanted).hint(hint);
            return None;
        };
        let whole: Vec<Option<f64>> = faces.iter().map(|face| curved_area(scene, *face)).collect();
        let area_in = |rect| {
            let area = |(face, whole): (&FaceId, &Option<f64>)| {
                whole.unwrap_or_else(|| scene.face_area_in(*face, rect))
            };
            faces.iter().zip(&whole).map(area).sum::<f64>()
        };
        let areas = grid.cell_areas(area_in);
        let covered = grid.cell_cover(&areas, area_in);
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
        let faces = self.faces_named(on, &key.field("on"))?;
        let scene = self.builder.scene();
        if let Some(relief) = scene.reliefs.iter().find(|relief| relief.name == on) {
            let wall = &scene.faces[relief.wall.index()].name;
            self.problems
                .error(&key.field("on"), format!("`{on}` is a relief, which does not unroll into a map"))
                .hint(format!("put the sensor on `{wall}` or on a plane before it; the balance tells what goes through the relief"));
            return None;
        }
        let port = faces.iter().any(|face| scene.faces[face.index()].owner == Owner::Port);
        Some((faces, if port { Place::Port } else { Place::Face }))
    }

    /// The own face of a free sensor: a port that light passes, or a sheet that absorbs.
    fn own_face(
        &mut self,
        name: &str,
        spec: &SensorSpec,
        rectangle: Option<RectangleSpec>,
        disk: Option<CircleSpec>,
        key: &Key,
    ) -> Option<(Vec<FaceId>, Place)> {
        let frame = self.place(spec.at.as_ref(), key, Facing::Toward)?;
        let region = match (rectangle, disk) {
            (Some(r), _) => {
                Region::Rectangle { half_x: 0.5 * r.width_mm, half_y: 0.5 * r.height_mm }
            }
            (None, Some(disk)) => Region::Annulus { inner: 0.0, outer: disk.radius_mm },
            // Validated: a free sensor has a shape.
            (None, None) => return None,
        };
        let black = self.finishes.get("black").copied().filter(|_| spec.absorbing);
        let (owner, place) =
            if spec.absorbing { (Owner::Sheet, Place::Face) } else { (Owner::Port, Place::Port) };
        let face = self.builder.add_face(FaceSpec {
            name: name.to_owned(),
            owner,
            front: black,
            back: black,
            pieces: vec![FacePiece::whole(Shape::Flat(Flat::new(frame, region)))],
        });
        Some((vec![face], place))
    }
}

fn division(plane: &PlaneSpec) -> Division {
    match (plane.rings, plane.cells) {
        (Some(rings), _) => Division::Rings(rings, plane.sectors.unwrap_or(1)),
        (None, Some(cells)) => Division::Cells(cells),
        // A sensor without cells is one cell.
        (None, None) => Division::Cells([1, 1]),
    }
}

/// The grid over some faces; `None` if rings are requested on a face that is not round and flat, or
/// several cells on one that cannot be unrolled.
fn grid(scene: &Scene, faces: &[FaceId], division: &Division) -> Option<Grid> {
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
            Some(Grid::Cartesian { rect, nu: *nu as usize, nv: *nv as usize })
        }
        Division::Rings(rings, sectors) => {
            let [face] = faces else { return None };
            let radius = scene.face_disk_radius(*face)?;
            Some(Grid::Polar { radius, rings: *rings as usize, sectors: *sectors as usize })
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
