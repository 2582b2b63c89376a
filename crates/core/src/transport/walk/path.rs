//! The state of a path.

use crate::optics::Stokes;
use crate::plan::Polarisation;
use crate::scene::{Arrival, Emitted, Inside, MediumId, Ray, Scene, SourceId, StartSurfaces};

/// The state a path carries from one interface to the next.
#[derive(Debug, Clone)]
pub struct Path {
    /// Position and direction.
    pub ray: Ray,
    /// Factor accumulated since the start, 1.
    pub throughput: f64,
    /// Wavelength, nm.
    pub wavelength: f64,
    /// Band of the wavelength, as of a [`DrawnWavelength`](crate::scene::DrawnWavelength).
    pub band: u32,
    /// Polarisation, if that is followed.
    pub stokes: Option<Stokes>,
    /// Source of its light; unknown for a gather path.
    pub source: Option<SourceId>,
    /// The solids it is in.
    pub inside: Inside,
    /// The medium it is in.
    pub medium: MediumId,
    /// The surfaces it starts on.
    pub on: StartSurfaces,
    /// Number of visible interfaces met, and of scatterings within media, so far: the depth of its next
    /// vertex. Interfaces at which light only goes straight on are invisible.
    pub depth: u32,
}

impl Path {
    /// A photon path at its source.
    pub fn emitted(scene: &Scene, source: SourceId, emitted: Emitted) -> Self {
        Self {
            ray: emitted.ray,
            throughput: 1.0,
            wavelength: emitted.wavelength.nm,
            band: emitted.wavelength.band,
            stokes: unpolarised(scene),
            source: Some(source),
            medium: scene.medium_in(&emitted.inside),
            inside: emitted.inside,
            on: emitted.on.into(),
            depth: 0,
        }
    }

    /// A gather path at its sensor.
    pub fn arriving(scene: &Scene, arrival: &Arrival) -> Self {
        Self {
            ray: arrival.ray,
            throughput: 1.0,
            wavelength: arrival.wavelength.nm,
            band: arrival.wavelength.band,
            stokes: unpolarised(scene),
            source: None,
            medium: scene.medium_in(&arrival.inside),
            inside: arrival.inside.clone(),
            on: arrival.on.into(),
            depth: 0,
        }
    }

    /// The etendue that the path represents, mm² sr: n² of its medium times `extent`, the integral of |cos θ|
    /// dA dω over the part of the sensor that the path stands for, mm² sr.
    pub fn etendue(&self, scene: &Scene, extent: f64) -> f64 {
        let index = scene.media[self.medium.index()].index(self.wavelength);
        index * index * extent
    }
}

/// The polarisation at the start of a path: neither sources nor sensors prefer any.
fn unpolarised(scene: &Scene) -> Option<Stokes> {
    match scene.polarisation {
        Polarisation::Ignored => None,
        Polarisation::Followed => Some(Stokes::UNPOLARISED),
    }
}
