//! Photon paths as sources start them.

use crate::rng::{Dimension, Numbers, Sampler};
use crate::scene::shape::Shape;
use crate::scene::source::sky::EmitterKind;
use crate::scene::{
    DrawnWavelength, EmitSide, Emitted, Emitter, Inside, Ray, Scene, SolidId, Source, StartSide,
    StartSolids,
};
use glam::DVec3;
use lumiduct_base::math::{Aabb, Frame, disk};

impl Source {
    /// Starts a photon path of a wavelength.
    pub fn emit(
        &self,
        scene: &Scene,
        wavelength: DrawnWavelength,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Emitted {
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
            Emitter::Opening(opening) => {
                let local = self.emission.sample(EmitterKind::Point, sampler);
                let dir = opening.frame().to_world(local);
                let (shape, start) = opening.start(dir, sampler);
                (Ray::new(start, dir), shape)
            }
            Emitter::Far { center, radius, reach, .. } => {
                (self.emit_from_afar(*center, *radius, *reach, sampler), 0)
            }
            Emitter::Volume { solid, bounds } => {
                (self.emit_from_volume(scene, *solid, bounds, sampler), 0)
            }
            Emitter::Rays { rays, frame, .. } => {
                (rays.at(frame, sampler.one(Dimension::EmitPosition)), 0)
            }
            Emitter::Fitted { light, frame, .. } => {
                let [start, dir] = light.sample(sampler);
                (Ray::new(frame.point_to_world(start), frame.to_world(dir)), 0)
            }
        };
        let inside = match self.start {
            StartSolids::Outside => Inside::default(),
            StartSolids::Ahead => scene.inside_at(&ray, StartSide::Ahead),
            StartSolids::Behind => scene.inside_at(&ray, StartSide::Behind),
        };
        // Only surface sources lie on a surface.
        let on = self.on.get(shape).copied();
        Emitted { ray, inside, on, shape, wavelength }
    }

    fn emit_from_line(
        &self,
        frame: &Frame,
        length: f64,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Ray {
        let along = length * (sampler.one(Dimension::EmitPosition) - 0.5);
        let local = self.emission.sample_of_line(sampler);
        Ray::new(frame.origin + along * frame.z, frame.to_world(local))
    }

    fn emit_from_surface(
        &self,
        shape: &Shape,
        side: EmitSide,
        reference: Option<&Frame>,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Ray {
        let point = shape.sample(sampler.pair(Dimension::EmitPosition));
        let normal = side.of(shape.normal(point));
        let frame = match reference {
            Some(reference) => *reference,
            None => Frame::from_axis(DVec3::ZERO, normal),
        };
        Ray::new(point, frame.to_world(self.emission.sample(EmitterKind::Surface, sampler)))
    }

    /// A direction from the law alone, and a line drawn evenly over the disk across it.
    fn emit_from_afar(
        &self,
        center: DVec3,
        radius: f64,
        reach: f64,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Ray {
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
        sampler: &mut Sampler<impl Numbers>,
    ) -> Ray {
        loop {
            let [u, v] = sampler.pair(Dimension::EmitPosition);
            let w = sampler.one(Dimension::EmitPosition);
            let point = bounds.min + DVec3::new(u, v, w) * (bounds.max - bounds.min);
            let local = self.emission.sample(EmitterKind::Volume, sampler);
            let ray = Ray::new(point, local);
            if scene.inside_at(&ray, StartSide::Ahead).contains(solid) {
                return ray;
            }
        }
    }
}

/// One of the shapes, in proportion to their areas; no draw for a single one.
fn choose_shape(shapes: &[(Shape, f64)], sampler: &mut Sampler<impl Numbers>) -> usize {
    let last = shapes.len() - 1;
    if last == 0 {
        return 0;
    }
    let area = sampler.one(Dimension::EmitPosition) * shapes[last].1;
    shapes.partition_point(|(_, up_to)| *up_to <= area).min(last)
}
