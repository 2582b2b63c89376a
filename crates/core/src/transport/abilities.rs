//! What each estimator can do: which light it can find, which sensors it can estimate, and whether it follows polarisation.

use crate::plan::Estimator;
use crate::scene::{Scene, Sensor, Source};
use crate::transport::connect::vertex::scatters;
use crate::transport::walk::emitters::invisible;

impl Estimator {
    /// Estimators that a pilot tries, in the order of its report.
    pub const TRIED: [Self; 4] = [Self::Forward, Self::Backward, Self::Mix, Self::Gather];

    /// Whether gather paths must meet a source for its light to count.
    pub fn must_meet_sources(self) -> bool {
        match self {
            Self::Forward | Self::Mix | Self::Mis => false,
            Self::Backward | Self::Gather => true,
        }
    }

    /// Whether photons meet records. Which sensors a photon has passed is then unknown.
    pub fn has_records(self) -> bool {
        match self {
            Self::Forward | Self::Backward | Self::Mix => false,
            Self::Gather | Self::Mis => true,
        }
    }

    /// Whether it can follow polarisation. Records on smooth faces would have to pair photons and gather paths by their polarisation,
    /// which is not done. Joins need not: what scatters depolarises, and between two such places the chances of the faces
    /// are the same both ways.
    pub fn follows_polarisation(self) -> bool {
        !self.has_records()
    }

    /// Whether it can follow light that changes its wavelength in a fluorescent medium. Gather paths have one wavelength from
    /// the sensor to the source.
    pub fn follows_fluorescence(self) -> bool {
        match self {
            Self::Forward => true,
            Self::Backward | Self::Mix | Self::Gather | Self::Mis => false,
        }
    }

    /// Whether a trial in a scene could find more than photons alone do.
    pub(crate) fn is_worth_a_trial(self, scene: &Scene) -> bool {
        let can_meet = |source: &Source| invisible(source, scene).is_none();
        if !scene.polarisation.is_ignored() && !self.follows_polarisation() {
            return false;
        }
        if scene.fluoresces() && !self.follows_fluorescence() {
            return false;
        }
        match self {
            Self::Forward => true,
            Self::Mix => scene.sources.iter().any(can_meet) || scatters(scene),
            Self::Backward => scene.sources.iter().all(can_meet),
            // A pilot judges fluxes, but with the few wavelengths of a pass colours of broad spectra have much larger errors.
            Self::Gather => scene.spectra.are_narrow() && scene.sources.iter().all(can_meet),
            Self::Mis => false,
        }
    }

    /// Whether it can estimate a sensor.
    pub(crate) fn can_estimate(self, sensor: &Sensor) -> bool {
        !self.has_records() || !sensor.counts_first_passage()
    }
}
