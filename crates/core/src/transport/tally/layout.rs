//! The position of each scalar of the readings in the row of sums.
//!
//! The order is fixed by the scene alone, so that readings made elsewhere from the same scene can be added.

use crate::scene::{FaceId, MediumId, Scene, SensorId, SourceId};
use crate::transport::tally::colour::{SPECTRUM_BINS, Stimulus};
use std::ops::Range;

/// Depths for which the flux of deeper paths is kept, in interfaces met.
pub(crate) const TAILS: [u32; 6] = [10, 50, 100, 200, 500, 1000];

/// Kinds of surprises at the choices of photons; those beyond share the last.
pub(crate) const CONTROLS: usize = 64;

/// A way to lose a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Loss {
    /// By the bounce limit.
    Cut,
    /// Through a hole in the geometry.
    Leaked,
}

/// The position of every scalar.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layout {
    sources: usize,
    faces: usize,
    media: usize,
    /// Media with lines for their fluorescence: all, or none if none has any.
    converting: usize,
    sensors: usize,
    /// Stimuli, and bins of the spectrum, of each sensor: none without spectra.
    colours: usize,
}

impl Layout {
    /// The layout of a scene's readings.
    pub fn new(scene: &Scene) -> Self {
        Self {
            sources: scene.sources.len(),
            faces: scene.faces.len(),
            media: scene.media.len(),
            converting: if scene.fluoresces() { scene.media.len() } else { 0 },
            sensors: scene.sensors.len(),
            colours: if scene.is_spectral() { Stimulus::ALL.len() + SPECTRUM_BINS } else { 0 },
        }
    }

    /// Number of scalars.
    pub(crate) fn len(&self) -> usize {
        self.sensor_slots().end + CONTROLS
    }

    /// All scalars of sensors.
    pub(crate) fn sensor_slots(&self) -> Range<usize> {
        self.sensor_base(0)..self.sensor_base(self.sensors)
    }

    /// All scalars of a sensor.
    pub(crate) fn slots_of(&self, sensor: SensorId) -> Range<usize> {
        self.sensor_base(sensor.index())..self.sensor_base(sensor.index() + 1)
    }

    /// Flux that started, from all sources.
    pub(crate) fn emitted_slots(&self) -> Range<usize> {
        0..self.sources
    }

    /// Surprises of a kind: flux that chance has sent on, less what was to be expected.
    #[inline]
    pub(crate) fn control(&self, kind: usize) -> usize {
        self.sensor_slots().end + kind
    }

    /// Surprises of all kinds.
    pub(crate) fn control_slots(&self) -> Range<usize> {
        self.control(0)..self.control(CONTROLS)
    }

    /// Flux that started, by source.
    pub(crate) fn emitted(&self, source: SourceId) -> usize {
        source.index()
    }

    /// Flux absorbed by a face.
    #[inline]
    pub(crate) fn absorbed_by_face(&self, face: FaceId) -> usize {
        self.sources + face.index()
    }

    /// Flux absorbed in a medium.
    #[inline]
    pub(crate) fn absorbed_in_medium(&self, medium: MediumId) -> usize {
        self.sources + self.faces + medium.index()
    }

    /// Flux that escaped, by the solid face it last left through; `None` if it never left a solid.
    pub(crate) fn escaped(&self, face: Option<FaceId>) -> usize {
        self.sources + self.faces + self.media + face.map_or(self.faces, FaceId::index)
    }

    /// Flux cut by the bounce limit.
    pub(crate) fn cut(&self) -> usize {
        self.sources + 2 * self.faces + self.media + 1
    }

    /// Flux removed by roulette, less the gain of its survivors.
    pub(crate) fn roulette(&self) -> usize {
        self.cut() + 1
    }

    /// Flux lost through holes in the geometry.
    pub(crate) fn leaked(&self) -> usize {
        self.cut() + 2
    }

    /// Flux that fluorescence in a medium absorbed, less what it emitted, which may be more lumens; only in scenes with it.
    pub(crate) fn converted(&self, medium: MediumId) -> usize {
        debug_assert!(medium.index() < self.converting, "a medium fluoresces");
        self.leaked() + 1 + medium.index()
    }

    /// Radiant flux that fluorescence in a medium turned to heat, W; only in scenes with it.
    pub(crate) fn heat(&self, medium: MediumId) -> usize {
        self.converted(medium) + self.converting
    }

    /// Flux on a sensor, by source.
    #[inline]
    pub fn sensor_flux(&self, sensor: SensorId, source: SourceId) -> usize {
        self.sensor_base(sensor.index()) + source.index()
    }

    /// The scalars that make up the flux on a sensor: one per source.
    pub(crate) fn flux_slots(&self, sensor: SensorId) -> Vec<usize> {
        (0..self.sources).map(|source| self.sensor_flux(sensor, SourceId::new(source))).collect()
    }

    /// Flux on a sensor that did not come through its aim.
    pub(crate) fn outside_aim(&self, sensor: SensorId) -> usize {
        self.sensor_base(sensor.index()) + self.sources
    }

    /// Flux on the side of a one-sided sensor that does not count.
    pub(crate) fn other_side(&self, sensor: SensorId) -> usize {
        self.outside_aim(sensor) + 1
    }

    /// Flux on a sensor times the depth of its paths.
    #[inline]
    pub(crate) fn depth_weighted(&self, sensor: SensorId) -> usize {
        self.outside_aim(sensor) + 2
    }

    /// Flux on a sensor from paths deeper than entry `tail` of [`TAILS`].
    #[inline]
    pub(crate) fn deeper(&self, sensor: SensorId, tail: usize) -> usize {
        self.outside_aim(sensor) + 3 + tail
    }

    /// Throughput of the gather paths of a sensor that were lost, per path drawn: a share, not a flux.
    pub(crate) fn lost_paths(&self, sensor: SensorId, loss: Loss) -> usize {
        let first = self.deeper(sensor, TAILS.len());
        match loss {
            Loss::Cut => first,
            Loss::Leaked => first + 1,
        }
    }

    /// Flux that entered through the sensor's entry port, by source.
    pub(crate) fn entering(&self, sensor: SensorId, source: SourceId) -> usize {
        self.lost_paths(sensor, Loss::Leaked) + 1 + source.index()
    }

    /// Whether the colour of light is counted.
    #[inline]
    pub(crate) fn has_colours(&self) -> bool {
        self.colours > 0
    }

    /// A stimulus of the light on a sensor; only in scenes with spectra.
    #[inline]
    pub(crate) fn stimulus(&self, sensor: SensorId, stimulus: Stimulus) -> usize {
        debug_assert!(self.colours > 0, "the scene has spectra");
        self.lost_paths(sensor, Loss::Leaked) + 1 + self.sources + stimulus as usize
    }

    /// Radiant flux on a sensor in a bin of the spectrum, W; only in scenes with spectra.
    #[inline]
    pub(crate) fn spectrum(&self, sensor: SensorId, bin: usize) -> usize {
        self.stimulus(sensor, Stimulus::X) + Stimulus::ALL.len() + bin
    }

    fn sensor_base(&self, sensor: usize) -> usize {
        self.leaked()
            + 1
            + 2 * self.converting
            + sensor * (2 * self.sources + 3 + TAILS.len() + 2 + self.colours)
    }
}
