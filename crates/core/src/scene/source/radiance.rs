//! Luminance of the surfaces of sources.

use crate::scene::EmitterKind;
use crate::scene::shape::Shape;
use crate::scene::source::{EmitSide, Emitter, Source};
use glam::DVec3;
use lumiduct_base::math::Frame;
use std::f64::consts::PI;

impl Source {
    /// Radiance, lm/(mm² sr), from a point on one of the source's shapes toward `out`; 0 for a source without surfaces, and
    /// against its emission.
    pub(crate) fn radiance(&self, shape: &Shape, point: DVec3, out: DVec3) -> f64 {
        match &self.emitter {
            Emitter::Surface { shapes, side, frame } => {
                let normal = side.of(shape.normal(point));
                let cosine = out.dot(normal);
                if cosine <= 0.0 {
                    return 0.0;
                }
                let own = || Frame::from_axis(DVec3::ZERO, normal).to_local(out);
                let local = frame.as_ref().map_or_else(own, |frame| frame.to_local(out));
                let area = shapes.last().map_or(0.0, |(_, area)| *area);
                let density = self.emission.density(EmitterKind::Surface, local).unwrap_or(0.0);
                self.flux / area * density / cosine
            }
            Emitter::Opening(opening) => {
                if out.dot(shape.normal(point)) <= 0.0 {
                    return 0.0;
                }
                let local = opening.frame().to_local(out);
                let density = self.emission.density(EmitterKind::Point, local).unwrap_or(0.0);
                self.flux * density / opening.projected_area(out)
            }
            // Along all lines that pass the middle at no more than the reach.
            Emitter::Far { center, reach, .. } => {
                let from = point - center;
                let is_inward = out.dot(from) < 0.0;
                if !is_inward || from.reject_from_normalized(out).length() > *reach {
                    return 0.0;
                }
                let density = self.emission.density(EmitterKind::Far, out).unwrap_or(0.0);
                self.flux / (PI * reach * reach) * density
            }
            Emitter::Fitted { light, frame, .. } => {
                self.flux * light.luminance(frame.point_to_local(point), frame.to_local(out))
            }
            Emitter::Point(_)
            | Emitter::Line { .. }
            | Emitter::Volume { .. }
            | Emitter::Rays { .. } => 0.0,
        }
    }

    /// Projected area times solid angle, over all places and directions from which it may emit, mm² sr; `None` without an area.
    pub fn projected_extent(&self) -> Option<f64> {
        match &self.emitter {
            Emitter::Opening(opening) => Some(opening.projected_extent(self.emission.widest())),
            Emitter::Point(_)
            | Emitter::Line { .. }
            | Emitter::Surface { .. }
            | Emitter::Far { .. }
            | Emitter::Volume { .. }
            | Emitter::Rays { .. }
            | Emitter::Fitted { .. } => {
                Some(self.emitter.area()? * self.emission.projected_extent())
            }
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
