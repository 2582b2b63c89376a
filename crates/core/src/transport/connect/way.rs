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
#[derive(Debug, Clone)]
pub(crate) struct WayEnd {
    /// Share of the flux that arrives, 1.
    pub(crate) transmittance: f64,
    /// Refractive index of the medium there.
    pub(crate) index: f64,
    /// The surfaces that its last piece starts on, and that piece.
    pub(crate) on: StartSurfaces,
    pub(crate) ray: Ray,
    /// Length of that piece, mm.
    pub(crate) length: f64,
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
            let own = &scene.media[medium.index()];
            // Light that leaves a sensor's own face has nowhere to go.
            let hits = if left > 0.0 { scene.find_next(&ray, on, inside) } else { None };
            let hits = hits.filter(|hits| hits.distance() < left - scene.tolerance);
            let piece = hits.as_ref().map_or(left, Hits::distance);
            transmittance *= own.transmittance(*wavelength, piece);
            if let Some(scattering) = own.scattering(*wavelength) {
                transmittance *= (-scattering.coefficient() * piece).exp();
            }
            let Some(hits) = hits else {
                let index = own.index(*wavelength);
                let on = std::mem::take(on);
                let end = WayEnd { transmittance, index, on, ray, length: left };
                return (transmittance > 0.0).then_some(end);
            };
            let point = ray.at(piece);
            let interface = scene.interface(&hits, &MeetingPoint { point, dir }, inside, *medium);
            if interface.visibility == Visibility::Visible {
                return None;
            }
            *on = StartSurfaces::hits(&hits);
            *medium = interface.to;
            hits.cross(inside);
            left -= piece;
            ray = Ray::new(point, dir);
        }
    }
}
