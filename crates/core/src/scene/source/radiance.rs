//! Luminance of the surfaces of sources.

use crate::scene::EmitterKind;
use crate::scene::shape::Shape;
use crate::scene::source::{EmitSide, Emitter, Source};
use glam::DVec3;
use lumiduct_base::math::Frame;
use std::f64::consts::PI;

/// The factors of a radiance, lm/(mm² sr). Estimators multiply them in orders of their own, which determine the last digits of reports.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Radiance {
    /// Flux per area of the emitter, lm/mm²; of the far distance, across its light.
    pub(crate) exitance: f64,
    /// Density of directions, 1/sr; where there is no cosine, over projected solid angle.
    pub(crate) density: f64,
    /// Of the angle to the normal; 1 for the far distance and for a fit.
    pub(crate) cosine: f64,
}

impl Radiance {
    const NONE: Self = Self { exitance: 0.0, density: 0.0, cosine: 1.0 };

    /// The product, lm/(mm² sr).
    pub(crate) fn value(self) -> f64 {
        self.exitance * (self.density / self.cosine)
    }
}

impl Source {
    /// Radiance from a point on one of the source's shapes toward `out`; none for a source without surfaces, and
    /// against its emission.
    pub(crate) fn radiance(&self, shape: &Shape, point: DVec3, out: DVec3) -> Radiance {
        match &self.emitter {
            Emitter::Surface { shapes, side, frame } => {
                let normal = side.of(shape.normal(point));
                let cosine = out.dot(normal);
                if cosine <= 0.0 {
                    return Radiance::NONE;
                }
                let own = || Frame::from_axis(DVec3::ZERO, normal).to_local(out);
                let local = frame.as_ref().map_or_else(own, |frame| frame.to_local(out));
                let area = shapes.last().map_or(0.0, |(_, area)| *area);
                let density = self.emission.density(EmitterKind::Surface, local).unwrap_or(0.0);
                Radiance { exitance: self.flux / area, density, cosine }
            }
            // Along all lines that pass the middle at no more than the reach.
            Emitter::Far { center, reach, .. } => {
                let from = point - center;
                let is_inward = out.dot(from) < 0.0;
                if !is_inward || from.reject_from_normalized(out).length() > *reach {
                    return Radiance::NONE;
                }
                let density = self.emission.density(EmitterKind::Far, out).unwrap_or(0.0);
                Radiance { exitance: self.flux / (PI * reach * reach), density, cosine: 1.0 }
            }
            Emitter::Fitted { light, frame, shapes: [(_, area)] } => {
                let luminance = light.luminance(frame.point_to_local(point), frame.to_local(out));
                Radiance { exitance: self.flux / area, density: luminance * area, cosine: 1.0 }
            }
            Emitter::Point(_)
            | Emitter::Line { .. }
            | Emitter::Volume { .. }
            | Emitter::Rays { .. } => Radiance::NONE,
        }
    }
}

impl EmitSide {
    /// The normal of the side that shines, from that of the surface.
    pub(crate) fn of(self, normal: DVec3) -> DVec3 {
        match self {
            Self::Front => normal,
            Self::Back => -normal,
        }
    }
}
