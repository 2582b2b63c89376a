//! Sources that gather paths are joined to, those that rays cannot meet included.

use crate::rng::{Dimension, Sampler};
use crate::scene::shape::{Crossing, RayStart, Shape};
use crate::scene::{Emitter, EmitterKind, Ray, Scene, Source, SourceId, StartSolids};
use crate::transport::connect::target::{Importance, Joinable, Targets};
use crate::transport::connect::vertex::TurnAt;
use glam::DVec3;
use lumiduct_base::math::Frame;
use std::f64::consts::PI;

/// Share of the joins that are spread evenly over the sources, 1: what a vertex receives is the sum of all.
const EVENLY: f64 = 0.0;

/// The sources of a scene that vertices can be joined to.
#[derive(Debug)]
pub(crate) struct SourceTargets<'s> {
    scene: &'s Scene,
    targets: Targets<SourceTarget<'s>>,
}

/// A source that vertices are joined to.
#[derive(Debug)]
struct SourceTarget<'s> {
    id: SourceId,
    source: &'s Source,
    extent: EmitterExtent<'s>,
    /// A ball around it, mm; of the far distance, the ball that all its light would pass through.
    center: DVec3,
    reach: f64,
}

#[derive(Debug)]
enum EmitterExtent<'s> {
    Point(&'s Frame),
    Line(&'s Frame, f64),
    /// Surfaces whose light has a density of directions.
    Surface(Surfaces<'s>),
    /// A flat beam along one direction.
    Beam(Surfaces<'s>, DVec3),
    /// The sky, or the sun.
    Far,
    /// The far distance along one direction.
    FarBeam,
}

#[derive(Debug, Clone, Copy)]
struct Surfaces<'s> {
    shapes: &'s [(Shape, f64)],
    /// Flux per area, lm/mm².
    exitance: f64,
}

/// A place of a source from which light travels to a vertex.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SourcePoint {
    pub(crate) source: SourceId,
    /// The shape of the source that it lies on; 0 for other sources.
    pub(crate) shape: usize,
    /// Position, mm; of no meaning for the sky.
    pub(crate) point: DVec3,
    /// Unit direction of its light.
    pub(crate) dir: DVec3,
}

impl<'s> SourceTargets<'s> {
    /// Those of a scene.
    pub(crate) fn new(scene: &'s Scene) -> Self {
        let lit = scene.sources.iter().enumerate().filter(|(_, source)| source.is_lit());
        let targets = lit.filter_map(|(index, source)| target(SourceId::new(index), source));
        Self { scene, targets: Targets::new(targets, EVENLY) }
    }

    /// A place for a vertex, on a source chosen roughly in proportion to the light it can send there, and
    /// its distance, mm; `None` where it sends none.
    pub(crate) fn draw(&self, vertex: DVec3, sampler: &mut Sampler) -> Option<(SourcePoint, f64)> {
        let draw = || sampler.one(Dimension::EmitPosition);
        let target = self.targets.choose(vertex, draw)?;
        let at = |shape: usize, point: DVec3| {
            let distance = point.distance(vertex);
            let dir = (vertex - point) / distance;
            let place = SourcePoint { source: target.id, shape, point, dir };
            dir.is_finite().then_some((place, distance))
        };
        match &target.extent {
            EmitterExtent::Point(frame) => at(0, frame.origin),
            EmitterExtent::Line(frame, length) => {
                let along = length * (sampler.one(Dimension::EmitPosition) - 0.5);
                at(0, frame.origin + along * frame.z)
            }
            EmitterExtent::Surface(surfaces) => {
                let (shape, point) = surfaces.sample(sampler);
                at(shape, point)
            }
            EmitterExtent::Beam(surfaces, dir) => {
                let (shape, distance) = surfaces.origin(&Ray::new(vertex, -*dir))?;
                let point = vertex - distance * dir;
                Some((SourcePoint { source: target.id, shape, point, dir: *dir }, distance))
            }
            EmitterExtent::Far | EmitterExtent::FarBeam => {
                let dir = target.source.emission.sample(EmitterKind::Far, sampler);
                let place = SourcePoint { source: target.id, shape: 0, point: vertex, dir };
                Some((place, f64::INFINITY))
            }
        }
    }

    /// What the etendue of a photon is its flux over, at a place in a medium of this index and at a wavelength, nm: basic
    /// radiance, intensity, intensity per length, or irradiance across a beam, lm per mm² sr, sr,
    /// mm sr or mm². `None` for a source that no vertex is joined to.
    pub(crate) fn emitted(&self, place: &SourcePoint, index: f64, wavelength: f64) -> Option<f64> {
        let target = self.target(place.source)?;
        let source = target.source;
        let whole = match &target.extent {
            EmitterExtent::Point(frame) => {
                let local = frame.to_local(place.dir);
                source.flux * source.emission.density(EmitterKind::Point, local)?
            }
            EmitterExtent::Line(frame, length) => {
                source.flux / length * source.emission.density_of_line(frame.to_local(place.dir))?
            }
            EmitterExtent::Surface(surfaces) => {
                source.radiance(surfaces.shape(place), place.point, place.dir) / (index * index)
            }
            EmitterExtent::Beam(surfaces, _) => surfaces.exitance / surfaces.cosine(place),
            EmitterExtent::Far => {
                target.across() * source.emission.density(EmitterKind::Far, place.dir)?
                    / (index * index)
            }
            EmitterExtent::FarBeam => target.across(),
        };
        Some(self.scene.gathered_spectral_weight(place.source, wavelength) * whole)
    }

    /// Normal irradiance at a vertex over n² and [`Self::emitted`], the density of draws
    /// considered; the vertex has light from a medium of this index.
    pub(crate) fn measure(&self, place: &SourcePoint, vertex: DVec3, index: f64) -> Option<f64> {
        let target = self.target(place.source)?;
        let per_chance = 1.0 / self.targets.chance(target, vertex);
        let square = place.point.distance_squared(vertex);
        Some(match &target.extent {
            EmitterExtent::Point(_) => per_chance / (index * index * square),
            EmitterExtent::Line(_, length) => per_chance * length / (index * index * square),
            EmitterExtent::Surface(surfaces) => {
                per_chance * surfaces.area() * surfaces.cosine(place) / square
            }
            EmitterExtent::Beam(..) | EmitterExtent::FarBeam => per_chance / (index * index),
            EmitterExtent::Far => {
                per_chance / target.source.emission.density(EmitterKind::Far, place.dir)?
            }
        })
    }

    /// The etendue of a gather path joined to a known place over that of one that meets it there;
    /// infinite if it cannot be joined.
    pub(crate) fn joined_ratio(&self, turn: Option<TurnAt<'s>>, place: &SourcePoint) -> f64 {
        let ratio = turn.and_then(|(vertex, [arriving, leaving])| {
            let light = vertex.scattered(arriving, leaving)?;
            let measure = self.measure(place, vertex.point, light.index_from)?;
            Some(light.adjoint / light.albedo * measure)
        });
        ratio.unwrap_or(f64::INFINITY)
    }

    fn target(&self, id: SourceId) -> Option<&SourceTarget<'s>> {
        self.targets.numbered(id.index())
    }
}

impl Joinable for SourceTarget<'_> {
    fn number(&self) -> usize {
        self.id.index()
    }

    /// Normal irradiance that it can give a point, roughly, lm/mm².
    fn importance(&self) -> Importance {
        let Self { center, reach, .. } = *self;
        let everywhere = |anywhere| Importance { anywhere, ..Importance::default() };
        match &self.extent {
            EmitterExtent::Far | EmitterExtent::FarBeam => everywhere(self.across()),
            EmitterExtent::Beam(surfaces, _) => everywhere(surfaces.exitance),
            EmitterExtent::Point(_) | EmitterExtent::Line(..) | EmitterExtent::Surface(_) => {
                Importance { anywhere: 0.0, strength: self.source.flux, center, reach }
            }
        }
    }
}

impl SourceTarget<'_> {
    /// Flux of the far distance per area across each direction, lm/mm².
    fn across(&self) -> f64 {
        self.source.flux / (PI * self.reach * self.reach)
    }
}

impl Surfaces<'_> {
    fn area(&self) -> f64 {
        self.shapes.last().map_or(0.0, |(_, area)| *area)
    }

    /// A point, uniform over the area, and its shape.
    fn sample(&self, sampler: &mut Sampler) -> (usize, DVec3) {
        let last = self.shapes.len() - 1;
        let area = sampler.one(Dimension::EmitPosition) * self.area();
        let shape = self.shapes.partition_point(|(_, up_to)| *up_to <= area).min(last);
        (shape, self.shapes[shape].0.sample(sampler.pair(Dimension::EmitPosition)))
    }

    /// The first shape that a ray meets, and its distance, mm.
    fn origin(&self, ray: &Ray) -> Option<(usize, f64)> {
        let mut nearest = None;
        for (shape, (surface, _)) in self.shapes.iter().enumerate() {
            surface.crossings(ray, RayStart::Elsewhere, |Crossing { t, .. }| {
                if t > 0.0 && nearest.is_none_or(|(_, other)| t < other) {
                    nearest = Some((shape, t));
                }
            });
        }
        nearest
    }

    /// The shape that a place is on.
    fn shape(&self, place: &SourcePoint) -> &Shape {
        &self.shapes[place.shape].0
    }

    /// Cosine of the angle between the light and the surface's normal.
    fn cosine(&self, place: &SourcePoint) -> f64 {
        place.dir.dot(self.shape(place).normal(place.point)).abs()
    }
}

fn target(id: SourceId, source: &Source) -> Option<SourceTarget<'_>> {
    // Its light must cross a face before it can go anywhere.
    if source.start == StartSolids::Behind {
        return None;
    }
    let bounds = source.emitter.bounds();
    let mut ball = (bounds.center(), 0.5 * bounds.diagonal());
    let extent = match (&source.emitter, source.emission.beam()) {
        (Emitter::Point(frame), None) => EmitterExtent::Point(frame),
        (Emitter::Line { frame, length }, None) => EmitterExtent::Line(frame, *length),
        (Emitter::Fitted { shapes, .. }, _) => {
            let exitance = source.flux / shapes[0].1;
            EmitterExtent::Surface(Surfaces { shapes, exitance })
        }
        (Emitter::Opening(opening), None) => {
            let exitance = source.flux / opening.area();
            EmitterExtent::Surface(Surfaces { shapes: opening.shapes(), exitance })
        }
        (Emitter::Surface { shapes, frame, .. }, beam) => {
            let exitance = source.flux / source.emitter.area()?;
            let surfaces = Surfaces { shapes, exitance };
            match beam {
                None => EmitterExtent::Surface(surfaces),
                Some(axis) => {
                    let normal = source.emitter.axis();
                    let own = || Some(Frame::from_axis(DVec3::ZERO, normal?));
                    let frame = (*frame).or_else(own)?;
                    EmitterExtent::Beam(surfaces, frame.to_world(axis))
                }
            }
        }
        (Emitter::Far { center, reach, .. }, beam) => {
            ball = (*center, *reach);
            beam.map_or(EmitterExtent::Far, |_| EmitterExtent::FarBeam)
        }
        (Emitter::Volume { .. } | Emitter::Rays { .. }, _)
        | (Emitter::Point(_) | Emitter::Line { .. } | Emitter::Opening(_), Some(_)) => {
            return None;
        }
    };
    let (center, reach) = ball;
    Some(SourceTarget { id, source, extent, center, reach })
}
