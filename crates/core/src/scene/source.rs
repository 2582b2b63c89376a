//! Sources: where light starts.

use crate::rng::{Dimension, Sampler};
use crate::scene::emission::EmitterKind;
use crate::scene::intersect::Just;
use crate::scene::shape::{Shape, Sphere};
use crate::scene::{Emission, Inside, PrimId, Ray, Scene, SolidId};
use glam::DVec3;
use lumiduct_base::math::{Aabb, Frame, disk};

/// A source of light.
#[derive(Debug, Clone)]
pub struct Source {
    /// Name in the scene file.
    pub name: String,
    /// Emitted flux, lm or W.
    pub flux: f64,
    /// What emits.
    pub emitter: Emitter,
    /// In which directions.
    pub emission: Emission,
    /// How the solids around a start point are found.
    pub start: Start,
    /// For each of its shapes the surface of the scene that it is, if it is one: light does not meet it at its start.
    pub on: Vec<PrimId>,
    /// Of a sun, its elevation above the horizon, rad.
    pub elevation: Option<f64>,
    /// Of daylight that depends on the sun, where that stands.
    pub sun: Option<SunAngles>,
}

/// The position of the sun in the sky.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SunAngles {
    /// Elevation above the horizon, rad.
    pub elevation: f64,
    /// Azimuth from north, clockwise seen from above, rad.
    pub azimuth: f64,
}

/// What emits.
#[derive(Debug, Clone)]
pub enum Emitter {
    /// A point; +z of the frame is its axis.
    Point(Frame),
    /// A thin line along z of the frame, centred; Lambertian means intensity ∝ sin of the angle to the line.
    Line {
        /// Middle and direction.
        frame: Frame,
        /// Length, mm.
        length: f64,
    },
    /// Surfaces, emitting along their normals, evenly over their area.
    Surface {
        /// The surfaces with the area up to and including each, mm².
        shapes: Vec<(Shape, f64)>,
        /// Along the normal, or against it.
        side: EmitSide,
        /// For tilted cones and beams: the frame that a flat source's directions refer to.
        frame: Option<Frame>,
    },
    /// The far distance: a sphere around everything that shines inward, at a smaller one about the same middle.
    Far {
        /// The sphere where light starts, its front inside, with its area, mm².
        shapes: [(Shape, f64); 1],
        /// Middle of both.
        center: DVec3,
        /// Radius of the sphere where light starts, mm.
        radius: f64,
        /// Radius of the sphere that all light would pass through, mm.
        reach: f64,
    },
    /// The inside of a solid.
    Volume {
        /// The solid.
        solid: SolidId,
        /// Box around it, mm.
        bounds: Aabb,
    },
}

/// From which side of its surface a source emits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EmitSide {
    /// Along the normal.
    Front,
    /// Against the normal.
    Back,
}

/// How the solids around a start point are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Start {
    /// The source touches no solid: all paths start outside.
    Outside,
    /// Asked for every path, just ahead of the start: a source on a face emits beyond it.
    Ahead,
    /// Asked for every path, just behind the start: light still has to cross a face that the source lies on.
    Behind,
}

/// The start of a photon path.
#[derive(Debug, Clone)]
pub struct Emitted {
    /// Where and in which direction.
    pub ray: Ray,
    /// The solids it starts in.
    pub inside: Inside,
    /// The surface of the scene that it starts on.
    pub on: Option<PrimId>,
    /// The shape of a surface source that it starts on, by its place; 0 of other sources.
    pub shape: usize,
}

impl Source {
    /// Whether it emits at all: one that is switched off, or of zero flux, is there and dark.
    #[inline]
    pub fn is_lit(&self) -> bool {
        self.flux > 0.0
    }
}

impl Emitter {
    /// The emitter made of some surfaces.
    pub fn surface(shapes: Vec<Shape>, side: EmitSide, frame: Option<Frame>) -> Self {
        let mut area = 0.0;
        let shapes = shapes
            .into_iter()
            .map(|shape| {
                area += shape.area();
                (shape, area)
            })
            .collect();
        Self::Surface { shapes, side, frame }
    }

    /// The far distance, shining at a sphere from another one of a larger `radius` about it; all in mm.
    pub fn far(center: DVec3, reach: f64, radius: f64) -> Self {
        let frame = Frame { origin: center, ..Frame::WORLD };
        let shape = Shape::Sphere(Sphere::zone(frame, radius, -radius, radius).inward());
        let area = shape.area();
        Self::Far { shapes: [(shape, area)], center, radius, reach }
    }

    /// Emitting area, mm²; `None` for points, lines, volumes and the far distance.
    pub fn area(&self) -> Option<f64> {
        match self {
            Self::Point(_) | Self::Line { .. } | Self::Volume { .. } | Self::Far { .. } => None,
            Self::Surface { shapes, .. } => shapes.last().map(|(_, area)| *area),
        }
    }

    /// Box around the emitter, mm.
    pub fn bounds(&self) -> Aabb {
        match self {
            Self::Point(frame) => Aabb::of([frame.origin]),
            Self::Line { frame, length } => Aabb::of([
                frame.origin - 0.5 * length * frame.z,
                frame.origin + 0.5 * length * frame.z,
            ]),
            Self::Surface { shapes, .. } => {
                shapes.iter().fold(Aabb::EMPTY, |bounds, (shape, _)| bounds.union(shape.bounds()))
            }
            Self::Volume { bounds, .. } => *bounds,
            Self::Far { center, radius, .. } => Aabb::of([*center]).grown(*radius),
        }
    }
}

impl Source {
    /// Starts a photon path.
    pub fn emit(&self, scene: &Scene, sampler: &mut Sampler) -> Emitted {
        let (ray, shape) = match &self.emitter {
            Emitter::Point(frame) => {
                let dir = frame.to_world(self.emission.sample(EmitterKind::Point, sampler));
                (Ray::new(frame.origin, dir), 0)
            }
            Emitter::Line { frame, length } => (self.emit_from_line(frame, *length, sampler), 0),
            Emitter::Surface { shapes, side, frame } => {
                let shape = choose_shape(shapes, sampler);
                let ray = self.emit_from_surface(&shapes[shape].0, *side, frame.as_ref(), sampler);
                (ray, shape)
            }
            Emitter::Far { center, radius, reach, .. } => {
                (self.emit_from_afar(*center, *radius, *reach, sampler), 0)
            }
            Emitter::Volume { solid, bounds } => {
                (self.emit_from_volume(scene, *solid, bounds, sampler), 0)
            }
        };
        let inside = match self.start {
            Start::Outside => Inside::default(),
            Start::Ahead => scene.inside_at(&ray, Just::Ahead),
            Start::Behind => scene.inside_at(&ray, Just::Behind),
        };
        // Only surface sources lie on anything.
        let on = self.on.get(shape).copied();
        Emitted { ray, inside, on, shape }
    }

    fn emit_from_line(&self, frame: &Frame, length: f64, sampler: &mut Sampler) -> Ray {
        let along = length * (sampler.one(Dimension::EmitPosition) - 0.5);
        let local = match self.emission {
            // A coordinate of a uniform point of the disk has density ∝ sqrt(1 - c²) = sin θ: Lambertian for a thin line.
            Emission::Lambertian => {
                let u = sampler.pair(Dimension::EmitDirection);
                let cos = disk(u).x;
                let around = sampler.one(Dimension::EmitDirection) * std::f64::consts::TAU;
                let sin = (1.0 - cos * cos).sqrt();
                DVec3::new(sin * around.cos(), sin * around.sin(), cos)
            }
            Emission::CosinePower(_)
            | Emission::Cone { .. }
            | Emission::Collimated { .. }
            | Emission::Isotropic
            | Emission::Sky(_) => self.emission.sample(EmitterKind::Point, sampler),
        };
        Ray::new(frame.origin + along * frame.z, frame.to_world(local))
    }

    fn emit_from_surface(
        &self,
        shape: &Shape,
        side: EmitSide,
        reference: Option<&Frame>,
        sampler: &mut Sampler,
    ) -> Ray {
        let point = shape.sample(sampler.pair(Dimension::EmitPosition));
        let normal = match side {
            EmitSide::Front => shape.normal(point),
            EmitSide::Back => -shape.normal(point),
        };
        let frame = match reference {
            Some(reference) => *reference,
            None => Frame::from_axis(DVec3::ZERO, normal),
        };
        Ray::new(point, frame.to_world(self.emission.sample(EmitterKind::Surface, sampler)))
    }

    /// A direction by the law alone, and a line evenly over the disk across it.
    fn emit_from_afar(&self, center: DVec3, radius: f64, reach: f64, sampler: &mut Sampler) -> Ray {
        let dir = self.emission.sample(EmitterKind::Far, sampler);
        let across = reach * disk(sampler.pair(Dimension::EmitPosition));
        let back = (radius * radius - across.length_squared()).sqrt();
        let frame = Frame::from_axis(center, dir);
        Ray::new(frame.point_to_world(across.with_z(-back)), dir)
    }

    fn emit_from_volume(
        &self,
        scene: &Scene,
        solid: SolidId,
        bounds: &Aabb,
        sampler: &mut Sampler,
    ) -> Ray {
        loop {
            let [u, v] = sampler.pair(Dimension::EmitPosition);
            let w = sampler.one(Dimension::EmitPosition);
            let point = bounds.min + DVec3::new(u, v, w) * (bounds.max - bounds.min);
            let local = self.emission.sample(EmitterKind::Volume, sampler);
            let ray = Ray::new(point, local);
            if scene.inside_at(&ray, Just::Ahead).contains(solid) {
                return ray;
            }
        }
    }
}

/// One of the shapes, in proportion to their areas; no draw for a single one.
fn choose_shape(shapes: &[(Shape, f64)], sampler: &mut Sampler) -> usize {
    let last = shapes.len() - 1;
    if last == 0 {
        return 0;
    }
    let area = sampler.one(Dimension::EmitPosition) * shapes[last].1;
    shapes.partition_point(|(_, up_to)| *up_to <= area).min(last)
}
