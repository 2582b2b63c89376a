//! Virtual sensors: where and how flux is counted. They never bend or stop light unless their face
//! absorbs.

pub(crate) mod grid;
pub(crate) mod pixels;

use crate::rng::{Dimension, Numbers, Sampler};
use crate::scene::shape::Toward;
use crate::scene::{FaceId, Grid, Pixels, Ray};
use glam::DVec3;
use lumiduct_base::math::{Aabb, Frame, cone_direction};
use smallvec::SmallVec;
use std::f64::consts::TAU;

/// A sensor with its name and its aim.
#[derive(Debug, Clone)]
pub struct Sensor {
    /// Name in the scene file.
    pub name: String,
    /// The measured quantity.
    pub kind: SensorKind,
    /// Faces or open ports through which a remote sensor is lit; empty: from anywhere.
    pub aim: Vec<FaceId>,
    /// The port whose entering flux is the reference of the transmission.
    pub entering: Option<FaceId>,
}

/// What a sensor measures.
#[derive(Debug, Clone)]
pub enum SensorKind {
    /// Flux on a surface, divided into cells, or into directions, or into both.
    Surface(SurfaceSensor),
    /// Flux on a goniometric sphere.
    Goniometer(Goniometer),
}

impl Sensor {
    /// Whether a path counts only on its first passage.
    #[inline]
    pub fn counts_first_passage(&self) -> bool {
        match &self.kind {
            SensorKind::Surface(surface) => surface.passage == Passage::First,
            SensorKind::Goniometer(_) => false,
        }
    }

    /// Number of values: cells, times views or pixels for a luminance sensor.
    pub fn cells(&self) -> usize {
        match &self.kind {
            SensorKind::Surface(surface) => surface.cells(),
            SensorKind::Goniometer(goniometer) => goniometer.cells(),
        }
    }
}

/// Flux through or on faces.
#[derive(Debug, Clone)]
pub struct SurfaceSensor {
    /// The faces that form the sensor.
    pub faces: Vec<FaceId>,
    /// Whether they are faces of the scene or a port in free space.
    pub place: Place,
    /// Light that arrives, or light that leaves.
    pub counts: CountedLight,
    /// On which sides.
    pub sides: Sides,
    /// Which of the passages of a path count.
    pub passage: Passage,
    /// The cells, in the chart of the faces.
    pub grid: Grid,
    /// Area of each cell, mm².
    pub areas: Vec<f64>,
    /// The fraction of each cell that lies on the sensor, by area, 1: less than 1 where the rim or
    /// a hole cuts it.
    pub covered: Vec<f64>,
    /// The directions that are separated.
    pub seeing: Seeing,
    /// For drawings and files: middle and axes of a flat sensor.
    pub frame: Option<Frame>,
}

/// Which passages of a path through a sensor count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Passage {
    /// All of them.
    Every,
    /// Only the first: the flux of light that has passed at least once.
    First,
}

impl SurfaceSensor {
    /// Number of values.
    pub(crate) fn cells(&self) -> usize {
        self.grid.cells()
            * match &self.seeing {
                Seeing::All => 1,
                Seeing::Views(views) => views.directions.len(),
                Seeing::Pixels(pixels) => pixels.count(),
            }
    }

    /// Area of the sensor, mm².
    pub fn area(&self) -> f64 {
        self.areas.iter().sum()
    }
}

/// The directions of light that a surface sensor separates.
#[derive(Debug, Clone)]
pub enum Seeing {
    /// None: all light counts equally, as illuminance.
    All,
    /// Some cones, each seen by all cells: luminance by cell and view.
    Views(Views),
    /// The pixels of an image, all seen by the single cell: luminance by direction.
    Pixels(Box<Pixels>),
}

/// Location of a surface sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// On material faces of the scene: counted at the interface.
    Face,
    /// On a port: light passes through it and is counted on its path.
    Port,
}

/// The light that counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CountedLight {
    /// Light before the interface acts.
    Incident,
    /// Light after it: transmitted and reflected.
    Leaving,
}

/// The sides of a face on which light counts: the side it arrives from, or leaves to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sides {
    /// The side of the normal.
    Front,
    /// The other side.
    Back,
    /// Both sides.
    Both,
}

impl Sides {
    /// Whether light travelling `toward` a side counts, arriving (it comes from the opposite side) or leaving.
    #[inline]
    pub(crate) fn include(self, counts: CountedLight, toward: Toward) -> bool {
        let front = match counts {
            CountedLight::Incident => toward == Toward::Back,
            CountedLight::Leaving => toward == Toward::Front,
        };
        match self {
            Self::Front => front,
            Self::Back => !front,
            Self::Both => true,
        }
    }
}

/// The directions of a luminance sensor: unit vectors away from the face, and one acceptance cone.
#[derive(Debug, Clone)]
pub struct Views {
    /// Away from the face: toward the origin of arriving light, or the destination of leaving
    /// light.
    pub directions: Vec<DVec3>,
    /// Half-angle of the acceptance cone, rad.
    pub half_angle: f64,
    /// Projected solid angle of each cone on the face, sr.
    pub projected: Vec<f64>,
}

impl Views {
    /// A direction in the acceptance cone of a view, or of any, and all views that accept it.
    pub(crate) fn draw(
        &self,
        view: Option<usize>,
        sampler: &mut Sampler<impl Numbers>,
    ) -> (DVec3, SmallVec<[usize; 1]>) {
        let count = self.directions.len();
        let view = view.unwrap_or_else(|| match count {
            1 => 0,
            _ => ((sampler.one(Dimension::GatherDirection) * count as f64) as usize).min(count - 1),
        });
        let local = cone_direction(self.half_angle, sampler.pair(Dimension::GatherDirection));
        let away = Frame::from_axis(DVec3::ZERO, self.directions[view]).to_world(local);
        let mut accepting: SmallVec<[usize; 1]> = self.accepting(away).collect();
        if accepting.is_empty() {
            // Drawn exactly on the rim of the cone.
            accepting.push(view);
        }
        (away, accepting)
    }

    /// Density of a direction that this many views accept, where all views are drawn from equally often, 1/sr.
    pub(crate) fn density(&self, accepting: usize) -> f64 {
        let solid_angle = 2.0 * TAU * (0.5 * self.half_angle).sin().powi(2);
        accepting as f64 / (self.directions.len() as f64 * solid_angle)
    }

    /// The views that accept light along `away`, a unit vector away from the face.
    #[inline]
    pub(crate) fn accepting(&self, away: DVec3) -> impl Iterator<Item = usize> + Clone + '_ {
        // |a - b| = 2 sin(θ/2) keeps the digits of narrow cones.
        let reach = 2.0 * (0.5 * self.half_angle).sin();
        self.directions
            .iter()
            .enumerate()
            .filter(move |(_, direction)| away.distance_squared(**direction) <= reach * reach)
            .map(|(view, _)| view)
    }
}

/// A goniometric sphere of type C (CIE 121:1996): γ from the pole (+z of the frame), C about it from +x over -y, counter-clockwise
/// for an eye that looks along the pole, the nadir of a luminaire.
#[derive(Debug, Clone)]
pub struct Goniometer {
    /// Centre, pole (+z) and C0 (+x).
    pub frame: Frame,
    /// Number of sectors in C.
    pub c_cells: usize,
    /// Number of rings in γ, from the pole.
    pub gamma_cells: usize,
    /// Radius, mm; `None` is the far field, where only directions count.
    pub radius: Option<f64>,
}

impl Goniometer {
    /// Number of cells.
    pub(crate) fn cells(&self) -> usize {
        self.c_cells * self.gamma_cells
    }

    /// The cell of a direction of light: ring by ring from the pole.
    #[inline]
    pub(crate) fn cell(&self, dir: DVec3) -> usize {
        let local = self.frame.to_local(dir);
        // atan2 keeps the digits near the poles.
        let gamma = local.truncate().length().atan2(local.z);
        let ring = ((gamma / std::f64::consts::PI * self.gamma_cells as f64) as usize)
            .min(self.gamma_cells - 1);
        ring * self.c_cells + self.sector(local)
    }

    /// The sector in C of a direction in the frame.
    #[inline]
    fn sector(&self, local: DVec3) -> usize {
        if self.c_cells == 1 {
            return 0;
        }
        let c = (-local.y).atan2(local.x).rem_euclid(TAU);
        ((c / TAU * self.c_cells as f64) as usize).min(self.c_cells - 1)
    }

    /// Solid angle of a cell, sr.
    pub(crate) fn solid_angle(&self, cell: usize) -> f64 {
        let edge =
            |ring: usize| (std::f64::consts::PI * ring as f64 / self.gamma_cells as f64).cos();
        let ring = cell / self.c_cells;
        (edge(ring) - edge(ring + 1)) * TAU / self.c_cells as f64
    }

    /// Where a ray leaves the finite sphere within `length`: distance along it, mm, and direction from the centre.
    #[inline]
    pub(crate) fn leaving(&self, ray: &Ray, length: f64) -> Option<(f64, DVec3)> {
        let radius = self.radius?;
        let from = ray.origin() - self.frame.origin;
        let half_b = from.dot(ray.dir());
        let c = from.length_squared() - radius * radius;
        let discriminant = half_b * half_b - c;
        if discriminant < 0.0 {
            return None;
        }
        // The further root is the exit; from a start beyond it, it lies behind.
        let t = -half_b + discriminant.sqrt();
        (t > 0.0 && t <= length).then(|| (t, (ray.at(t) - self.frame.origin) / radius))
    }

    /// Box around a finite sphere, mm; empty for the far field.
    pub fn bounds(&self) -> Aabb {
        self.radius.map_or(Aabb::EMPTY, |radius| Aabb::of([self.frame.origin]).grown(radius))
    }
}
