//! Watchers of the photons of the forward estimator. This module does not know what they do with
//! them.

use crate::scene::{Arrivals, MediumId, Ray, Scene, SensorId, SourceId};
use crate::transport::{Collision, Departure, Path, ROULETTE_BELOW, Vertex};
use glam::DVec3;

/// A watcher of photons that arrive at interfaces.
pub trait PhotonWatcher {
    /// Throughput below which roulette ends photons, 1.
    #[inline(always)]
    fn roulette_below(&self) -> f64 {
        ROULETTE_BELOW
    }

    /// Sees a photon start on one of the shapes of its source.
    #[inline(always)]
    fn start(&mut self, _path: &Path, _source: SourceId, _shape: usize) {}

    /// Sees a photon before the interface acts; `flux` is its flux at throughput 1, lm or W.
    fn arrive(&mut self, path: &Path, vertex: &Vertex<'_>, flux: f64, source: SourceId);

    /// Sees a photon before it is scattered within a medium; `flux` as above.
    #[inline(always)]
    fn collide(&mut self, _path: &Path, _collision: &Collision<'_>, _flux: f64, _source: SourceId) {
    }

    /// Sees how a photon continues.
    #[inline(always)]
    fn depart(&mut self, _path: &Path, _vertex: &Vertex<'_>, _departure: &Departure) {}

    /// Sees a photon that a sensor counts, in these cells; there may be none.
    #[inline(always)]
    fn detect(
        &mut self,
        _path: &Path,
        _light: &Detected,
        _cells: impl Iterator<Item = usize> + Clone,
    ) {
    }
}

/// Light that has reached a sensor.
#[derive(Debug, Clone, Copy)]
pub struct Detected {
    pub(crate) sensor: SensorId,
    /// Position on the sensor, mm; for a far field, any point of its path.
    pub(crate) point: DVec3,
    /// Unit direction of travel.
    pub(crate) dir: DVec3,
    /// Unit normal of the sensor.
    pub(crate) normal: DVec3,
    /// The medium it is in.
    pub(crate) medium: MediumId,
    /// Its flux, lm or W.
    pub(crate) flux: f64,
    pub(crate) source: SourceId,
}

impl Detected {
    /// The gather paths of its sensor, if that is among those given.
    pub(crate) fn arrivals<'a, 's>(
        &self,
        sensors: &'a [(SensorId, Arrivals<'s>)],
    ) -> Option<&'a Arrivals<'s>> {
        sensors.iter().find(|(id, _)| *id == self.sensor).map(|(_, arrivals)| arrivals)
    }

    /// Etendue that a gather path back along the light would represent if the sensor had only one,
    /// mm² sr.
    pub(crate) fn etendue(&self, scene: &Scene, arrivals: &Arrivals<'_>, wavelength: f64) -> f64 {
        let index = scene.media[self.medium.index()].index(wavelength);
        index * index * arrivals.extent(&Ray::new(self.point, -self.dir), self.normal)
    }
}

/// No watcher.
impl PhotonWatcher for () {
    #[inline(always)]
    fn arrive(&mut self, _: &Path, _: &Vertex<'_>, _: f64, _: SourceId) {}
}

/// Two watchers, called in order; only the first sets the roulette threshold.
impl<A: PhotonWatcher, B: PhotonWatcher> PhotonWatcher for (&mut A, &mut B) {
    #[inline(always)]
    fn roulette_below(&self) -> f64 {
        self.0.roulette_below()
    }

    #[inline(always)]
    fn start(&mut self, path: &Path, source: SourceId, shape: usize) {
        self.0.start(path, source, shape);
        self.1.start(path, source, shape);
    }

    #[inline(always)]
    fn arrive(&mut self, path: &Path, vertex: &Vertex<'_>, flux: f64, source: SourceId) {
        self.0.arrive(path, vertex, flux, source);
        self.1.arrive(path, vertex, flux, source);
    }

    #[inline(always)]
    fn collide(&mut self, path: &Path, collision: &Collision<'_>, flux: f64, source: SourceId) {
        self.0.collide(path, collision, flux, source);
        self.1.collide(path, collision, flux, source);
    }

    #[inline(always)]
    fn depart(&mut self, path: &Path, vertex: &Vertex<'_>, departure: &Departure) {
        self.0.depart(path, vertex, departure);
        self.1.depart(path, vertex, departure);
    }

    #[inline(always)]
    fn detect(
        &mut self,
        path: &Path,
        light: &Detected,
        cells: impl Iterator<Item = usize> + Clone,
    ) {
        self.0.detect(path, light, cells.clone());
        self.1.detect(path, light, cells);
    }
}
