//! Straight ways between two points.

use crate::optics::Side;
use crate::scene::{Hits, MeetingPoint, Ray, Scene, StartSurfaces, Visibility};
use crate::transport::{Path, Vertex};
use glam::DVec3;

/// What light meets from a vertex of a path on.
#[derive(Debug, Clone)]
pub(crate) struct WayStart {
    path: Path,
}

/// The end of a straight way.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WayEnd {
    /// Share of the flux that arrives, 1.
    pub(crate) transmittance: f64,
    /// Refractive index of the medium there.
    pub(crate) index: f64,
}

impl WayStart {
    /// From a face to one of its sides.
    pub(crate) fn from_face(path: &Path, vertex: &Vertex<'_>, side: Side) -> Self {
        let mut path = Path { on: StartSurfaces::hits(vertex.hits), ..path.clone() };
        if side == Side::Transmitted {
            path.medium = vertex.interface.to;
            vertex.hits.cross(&mut path.inside);
        }
        Self { path }
    }

    /// From a point within the medium of a path.
    pub(crate) fn within(path: &Path) -> Self {
        Self { path: Path { on: StartSurfaces::default(), ..path.clone() } }
    }

    /// The surfaces that it starts on.
    pub(crate) fn on(&self) -> &StartSurfaces {
        &self.path.on
    }

    /// Goes `length` mm along a unit direction, infinite for a way out of the scene; `None` where a
    /// visible interface is in the way.
    pub(crate) fn go(
        mut self,
        scene: &Scene,
        from: DVec3,
        dir: DVec3,
        length: f64,
    ) -> Option<WayEnd> {
        let Path { inside, medium, on, wavelength, .. } = &mut self.path;
        let (mut ray, mut left, mut transmittance) = (Ray::new(from, dir), length, 1.0);
        loop {
            // Light that leaves a sensor's own face has nowhere to go.
            if left == 0.0 {
                let index = scene.media[medium.index()].index(*wavelength);
                return Some(WayEnd { transmittance, index });
            }
            let hits = scene.find_next(&ray, on, inside);
            let own = &scene.media[medium.index()];
            let distance = hits.as_ref().map_or(f64::INFINITY, Hits::distance);
            let ends = distance >= left - scene.tolerance || hits.is_none();
            let piece = if ends { left } else { distance };
            transmittance *= own.transmittance(*wavelength, piece);
            if let Some(scattering) = own.scattering() {
                transmittance *= (-scattering.coefficient() * piece).exp();
            }
            let Some(hits) = hits.filter(|_| !ends) else {
                let index = own.index(*wavelength);
                return (transmittance > 0.0).then_some(WayEnd { transmittance, index });
            };
            let point = ray.at(distance);
            let interface = scene.interface(&hits, &MeetingPoint { point, dir }, inside, *medium);
            if interface.visibility == Visibility::Visible {
                return None;
            }
            *on = StartSurfaces::hits(&hits);
            *medium = interface.to;
            hits.cross(inside);
            left -= distance;
            ray = Ray::new(point, dir);
        }
    }
}
