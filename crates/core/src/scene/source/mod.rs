//! Sources: where light starts.

pub(crate) mod emission;
pub(crate) mod fitted;
pub(crate) mod light_group;
pub(crate) mod measured;
pub(crate) mod opening;
pub(crate) mod radiance;
pub(crate) mod rays;
pub(crate) mod sky;

use crate::colour::SpectralDraw;
use crate::scene::shape::{Flat, Region, Shape, Sphere};
use crate::scene::{
    DrawnWavelength, Emission, FittedLight, Inside, LuminousOpening, PrimId, Ray, RaySet, SolidId,
};
use glam::DVec3;
use lumiduct_base::math::{Aabb, Frame};
use std::sync::Arc;

/// A source of light.
#[derive(Debug, Clone)]
pub struct Source {
    /// Name in the scene file.
    pub name: String,
    /// Emitted flux, lm or W.
    pub flux: f64,
    /// The emitting geometry.
    pub emitter: Emitter,
    /// The directions of its light; not used for rays and what is fitted to them, which have their own.
    pub emission: Emission,
    /// Its spectrum; all lit sources of a scene have one, or none has.
    pub spectrum: Option<Arc<SpectralDraw>>,
    /// How the solids around a start point are found.
    pub start: StartSolids,
    /// For each of its shapes, the surface of the scene that coincides with it, if any: light does
    /// not meet it at its start.
    pub on: Vec<PrimId>,
    /// For a sun, its elevation above the horizon, rad.
    pub elevation: Option<f64>,
    /// For daylight that depends on the sun, the position of the sun.
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

/// The geometry of a source.
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
    /// The far distance: a sphere around everything that shines inward, at a smaller concentric
    /// one.
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
    /// An opening that emits to several sides; the emission is that of the whole opening, in its frame.
    Opening(LuminousOpening),
    /// The inside of a solid.
    Volume {
        /// The solid.
        solid: SolidId,
        /// Box around it, mm.
        bounds: Aabb,
    },
    /// Given rays.
    Rays {
        /// The rays.
        rays: Arc<RaySet>,
        /// The frame that they refer to.
        frame: Frame,
        /// Box around their starts, mm.
        bounds: Aabb,
    },
    /// Light fitted to rays, from both sides of a rectangle.
    Fitted {
        /// The light.
        light: Arc<FittedLight>,
        /// The frame of the rays.
        frame: Frame,
        /// The rectangle with its area, mm².
        shapes: [(Shape, f64); 1],
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
pub enum StartSolids {
    /// The source touches no solid: all paths start outside.
    Outside,
    /// Tested for every path, just ahead of the start: a source on a face emits beyond it.
    Ahead,
    /// Tested for every path, just behind the start: light must still cross a face that the source
    /// lies on.
    Behind,
}

/// The start of a photon path.
#[derive(Debug, Clone)]
pub struct Emitted {
    /// Position and direction.
    pub ray: Ray,
    /// The solids it starts in.
    pub inside: Inside,
    /// The surface of the scene that it starts on.
    pub on: Option<PrimId>,
    /// The index of the shape of a surface source that it starts on; 0 for other sources.
    pub shape: usize,
    /// Its wavelength.
    pub wavelength: DrawnWavelength,
}

impl Source {
    /// Whether it emits at all: false for one that is switched off, or of zero flux.
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

    /// The far distance, shining at a sphere of radius `reach` from a concentric one of larger
    /// `radius`; all in mm.
    pub fn far(center: DVec3, reach: f64, radius: f64) -> Self {
        let frame = Frame { origin: center, ..Frame::WORLD };
        let shape = Shape::Sphere(Sphere::zone(frame, radius, -radius, radius).inward());
        let area = shape.area();
        Self::Far { shapes: [(shape, area)], center, radius, reach }
    }

    /// The emitter of given rays in a frame.
    pub fn rays(rays: Arc<RaySet>, frame: Frame) -> Self {
        let bounds = rays.bounds(&frame);
        Self::Rays { rays, frame, bounds }
    }

    /// The emitter of light fitted to rays in a frame.
    pub fn fitted(light: Arc<FittedLight>, frame: Frame) -> Self {
        let [half_x, half_y] = light.half().to_array();
        let middle = frame.point_to_world(light.middle());
        let flat =
            Flat::new(Frame { origin: middle, ..frame }, Region::Rectangle { half_x, half_y });
        let shape = Shape::Flat(flat);
        let area = shape.area();
        Self::Fitted { light, frame, shapes: [(shape, area)] }
    }

    /// Emitting area, mm²; `None` for points, lines, volumes, rays, the rectangle of a fit, which may be dark in parts, and the far distance.
    pub fn area(&self) -> Option<f64> {
        match self {
            Self::Point(_)
            | Self::Line { .. }
            | Self::Volume { .. }
            | Self::Far { .. }
            | Self::Rays { .. }
            | Self::Fitted { .. } => None,
            Self::Surface { shapes, .. } => shapes.last().map(|(_, area)| *area),
            Self::Opening(opening) => Some(opening.area()),
        }
    }

    /// The frame of a point or of rays; `None` for all others.
    pub fn point(&self) -> Option<&Frame> {
        match self {
            Self::Point(frame) | Self::Rays { frame, .. } => Some(frame),
            Self::Line { .. }
            | Self::Surface { .. }
            | Self::Opening(_)
            | Self::Fitted { .. }
            | Self::Volume { .. }
            | Self::Far { .. } => None,
        }
    }

    /// The ends of a line; `None` for all others.
    pub fn line(&self) -> Option<[DVec3; 2]> {
        match self {
            Self::Line { frame, length } => {
                let half = 0.5 * length * frame.z;
                Some([frame.origin - half, frame.origin + half])
            }
            Self::Point(_)
            | Self::Surface { .. }
            | Self::Opening(_)
            | Self::Volume { .. }
            | Self::Far { .. }
            | Self::Rays { .. }
            | Self::Fitted { .. } => None,
        }
    }

    /// The surfaces of a source within the scene, which pictures draw and which light meets as its body; none for all
    /// others.
    pub fn shapes(&self) -> &[(Shape, f64)] {
        match self {
            Self::Surface { shapes, .. } => shapes,
            Self::Opening(opening) => opening.shapes(),
            Self::Fitted { shapes, .. } => shapes,
            Self::Point(_)
            | Self::Line { .. }
            | Self::Volume { .. }
            | Self::Far { .. }
            | Self::Rays { .. } => &[],
        }
    }

    /// The direction along which a point, a flat surface, or the axis of rays or of an opening shines; `None` for all others.
    pub fn axis(&self) -> Option<DVec3> {
        match self {
            Self::Point(frame) | Self::Rays { frame, .. } | Self::Fitted { frame, .. } => {
                Some(frame.z)
            }
            Self::Opening(opening) => Some(opening.frame().z),
            Self::Surface { shapes, side, .. } => {
                let [(shape, _)] = shapes.as_slice() else { return None };
                let normals =
                    [[0.1, 0.1], [0.9, 0.1], [0.5, 0.9]].map(|u| shape.normal(shape.sample(u)));
                let is_flat = normals.iter().all(|normal| normal.dot(normals[0]) > 1.0 - 1e-9);
                let along = match side {
                    EmitSide::Front => normals[0],
                    EmitSide::Back => -normals[0],
                };
                is_flat.then_some(along)
            }
            Self::Line { .. } | Self::Volume { .. } | Self::Far { .. } => None,
        }
    }

    /// Effective number of rays, as of [`RaySet`], if its light is known by rays alone.
    pub fn effective_rays(&self) -> Option<f64> {
        match self {
            Self::Rays { rays, .. } => Some(rays.effective_count()),
            Self::Fitted { light, .. } => Some(light.quality().effective_rays),
            Self::Point(_)
            | Self::Line { .. }
            | Self::Surface { .. }
            | Self::Opening(_)
            | Self::Volume { .. }
            | Self::Far { .. } => None,
        }
    }

    /// Whether it is the sky or the sun, outside of everything.
    pub fn is_far(&self) -> bool {
        match self {
            Self::Far { .. } => true,
            Self::Point(_)
            | Self::Line { .. }
            | Self::Surface { .. }
            | Self::Opening(_)
            | Self::Volume { .. }
            | Self::Rays { .. }
            | Self::Fitted { .. } => false,
        }
    }

    /// Whether it is a thing of its own: not the sky, and not the inside of a solid.
    pub(crate) fn is_thing(&self) -> bool {
        match self {
            Self::Point(_)
            | Self::Line { .. }
            | Self::Surface { .. }
            | Self::Opening(_)
            | Self::Rays { .. }
            | Self::Fitted { .. } => true,
            Self::Volume { .. } | Self::Far { .. } => false,
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
            Self::Surface { .. } | Self::Opening(_) => {
                let shapes = self.shapes().iter();
                shapes.fold(Aabb::EMPTY, |bounds, (shape, _)| bounds.union(shape.bounds()))
            }
            Self::Fitted { shapes: [(shape, _)], .. } => shape.bounds(),
            Self::Volume { bounds, .. } | Self::Rays { bounds, .. } => *bounds,
            Self::Far { center, radius, .. } => Aabb::of([*center]).grown(*radius),
        }
    }
}
