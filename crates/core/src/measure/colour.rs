//! Colour of all light on a sensor, from its tristimulus values (CIE 1931 observer).

use crate::colour::{
    Chromaticity, DominantWavelength, WavelengthKind, colour_rendering,
    correlated_colour_temperature, dominant_wavelength,
};
use crate::measure::evidence::Evidence;
use crate::measure::{Measure, Status};
use crate::scene::{SensorId, Source};
use crate::transport::{BIN_WIDTH, FIRST_BIN, SPECTRUM_BINS, Stimulus};
use indexmap::IndexMap;

/// The last parts of the dotted names of all of them.
pub(crate) const NAMES: [&str; 11] = [
    "radiant_flux",
    "luminous_efficacy",
    "colour_x",
    "colour_y",
    "colour_u",
    "colour_v",
    "dominant_wavelength",
    "excitation_purity",
    "colour_temperature",
    "duv",
    "colour_rendering_ra",
];

/// The colour of a sensor's light, by the last part of their dotted names; nothing without spectra.
pub(crate) fn totals(evidence: &Evidence<'_>, id: SensorId) -> IndexMap<String, Measure> {
    let mut out = IndexMap::new();
    if !evidence.scene.is_spectral() {
        return out;
    }
    let stimuli = SensorStimuli { evidence, id };
    out.insert("radiant_flux".into(), stimuli.radiant_flux());
    let efficacy = stimuli.measure("lm/W", |[_, y, _], watts| Some(y / watts));
    out.insert("luminous_efficacy".into(), efficacy);
    let mut add = |name: &str, unit, value: &dyn Fn(Chromaticity) -> Option<f64>| {
        let of = |xyz, _| value(Chromaticity::from_tristimulus(xyz)?);
        out.insert(name.into(), stimuli.measure(unit, of));
    };
    add("colour_x", "1", &|of| Some(of.x));
    add("colour_y", "1", &|of| Some(of.y));
    add("colour_u", "1", &|of| Some(of.uv_1976()[0]));
    add("colour_v", "1", &|of| Some(of.uv_1976()[1]));
    add("dominant_wavelength", "nm", &|of| Some(dominant(of)?.nm));
    add("excitation_purity", "1", &|of| Some(dominant(of)?.purity));
    add("colour_temperature", "K", &|of| Some(correlated_colour_temperature(of)?.kelvin));
    add("duv", "1", &|of| Some(correlated_colour_temperature(of)?.duv));
    out.insert("colour_rendering_ra".into(), stimuli.general_rendering());
    out
}

/// The dominant wavelength of a colour against equal energy; purples have none.
fn dominant(of: Chromaticity) -> Option<DominantWavelength> {
    let found = dominant_wavelength(of, Chromaticity::EQUAL_ENERGY);
    found.filter(|found| found.kind == WavelengthKind::Dominant)
}

/// The spectrum of the light on a sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct SensorSpectrum {
    /// Name of the sensor.
    pub sensor: String,
    /// Middle of each band, nm; bands are 5 nm wide.
    pub nm: Vec<f64>,
    /// Radiant flux per wavelength, W/nm.
    pub values: Vec<f64>,
    /// Standard errors, W/nm.
    pub std_errors: Vec<f64>,
}

/// The spectrum of a sensor's light; `None` without spectra.
pub(crate) fn spectrum(evidence: &Evidence<'_>, id: SensorId) -> Option<SensorSpectrum> {
    if !evidence.scene.is_spectral() {
        return None;
    }
    let stimuli = SensorStimuli { evidence, id };
    let band = |bin| stimuli.radiant(evidence.layout.spectrum(id, bin), 1.0 / BIN_WIDTH, "W/nm");
    let bands: Vec<Measure> = (0..SPECTRUM_BINS).map(band).collect();
    Some(SensorSpectrum {
        sensor: evidence.scene.sensors[id.index()].name.clone(),
        nm: (0..SPECTRUM_BINS).map(|bin| FIRST_BIN + BIN_WIDTH * bin as f64).collect(),
        values: bands.iter().map(|band| band.value).collect(),
        std_errors: bands.iter().map(|band| band.std_error).collect(),
    })
}

/// Tristimulus values and radiant flux on a sensor.
struct SensorStimuli<'e, 's> {
    evidence: &'e Evidence<'s>,
    id: SensorId,
}

impl SensorStimuli<'_, '_> {
    fn radiant_flux(&self) -> Measure {
        let slot = self.evidence.layout.stimulus(self.id, Stimulus::Radiant);
        self.radiant(slot, 1.0, "W")
    }

    /// A sum of radiant flux times a factor that leads to `unit`; where nothing was counted, its error is that of a path of mean
    /// efficacy.
    fn radiant(&self, slot: usize, factor: f64, unit: &str) -> Measure {
        let found = self.evidence.sum(&[slot], factor, unit);
        if found.status != Status::NoSignal {
            return found;
        }
        let scene = self.evidence.scene;
        let watts = |source: &Source| {
            source.spectrum.as_ref().map_or(0.0, |own| source.flux / own.spectrum().efficacy())
        };
        let watts: f64 = scene.sources.iter().map(watts).sum();
        Measure { std_error: found.std_error * watts / scene.source_flux(), ..found }
    }

    /// A function of X, Y and Z, lm, and radiant flux, W; it may be undefined for some light.
    fn measure(&self, unit: &str, function: impl Fn([f64; 3], f64) -> Option<f64>) -> Measure {
        let &Self { evidence, id } = self;
        let luminous = evidence.layout.flux_slots(id);
        let [x, z, radiant] = [Stimulus::X, Stimulus::Z, Stimulus::Radiant]
            .map(|stimulus| evidence.layout.stimulus(id, stimulus));
        let found = evidence.function(&luminous, unit, |flux| {
            let y = luminous.iter().map(|&slot| flux(slot)).sum();
            function([flux(x), y, flux(z)], flux(radiant)).unwrap_or(f64::NAN)
        });
        self.defined(found)
    }

    /// The general colour rendering index Ra.
    fn general_rendering(&self) -> Measure {
        let &Self { evidence, id } = self;
        let luminous = evidence.layout.flux_slots(id);
        let found = evidence.function(&luminous, "1", |flux| {
            let spectrum =
                std::array::from_fn(|bin| flux(evidence.layout.spectrum(id, bin)) / BIN_WIDTH);
            colour_rendering(&spectrum).map_or(f64::NAN, |found| found.general)
        });
        self.defined(found)
    }

    fn defined(&self, found: Measure) -> Measure {
        if found.value.is_nan() {
            let unknown = f64::INFINITY;
            return self.evidence.measure(unknown, unknown, &found.unit, Status::Undefined);
        }
        found
    }
}
