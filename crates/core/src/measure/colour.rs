//! Colour of all light on a sensor, from its tristimulus values: CIE 1931 observer, and chromaticities of the CIE 1964 observer.

use crate::colour::{
    Chromaticity, ColourRendering, DominantWavelength, WavelengthKind, colour_rendering,
    correlated_colour_temperature, dominant_wavelength,
};
use crate::measure::evidence::Evidence;
use crate::measure::{Measure, Status};
use crate::optics::{Fluorescence, Medium};
use crate::scene::SensorId;
use crate::transport::{BIN_WIDTH, FIRST_BIN, SPECTRUM_BINS, Stimulus};
use indexmap::IndexMap;

/// A function of a chromaticity, which may be undefined.
type OfChromaticity = fn(Chromaticity) -> Option<f64>;

/// The last parts of the names of measures that follow from the chromaticity, their units and values.
const CHROMATIC: [(&str, &str, OfChromaticity); 8] = [
    ("colour_x", "1", |of| Some(of.x)),
    ("colour_y", "1", |of| Some(of.y)),
    ("colour_u", "1", |of| Some(of.uv_1976()[0])),
    ("colour_v", "1", |of| Some(of.uv_1976()[1])),
    ("dominant_wavelength", "nm", |of| Some(dominant(of)?.nm)),
    ("excitation_purity", "1", |of| Some(dominant(of)?.purity)),
    ("colour_temperature", "K", |of| Some(correlated_colour_temperature(of)?.kelvin)),
    ("duv", "1", |of| Some(correlated_colour_temperature(of)?.duv)),
];

/// How many of them, from the first, there are for the CIE 1964 observer, too, and what their names end with.
const WIDE_FIELD: (usize, &str) = (4, "_10deg");

/// A colour rendering index of those of a spectrum.
type OfRendering = fn(&ColourRendering) -> f64;

/// The last parts of the names of colour rendering indices, and their values; R9 is that of saturated red, which Ra leaves out.
const RENDERING: [(&str, OfRendering); 2] =
    [("colour_rendering_ra", |of| of.general), ("colour_rendering_r9", |of| of.special[8])];

/// All measures of the colour of a sensor's light, by the last part of their dotted names; nothing without spectra.
pub(crate) fn totals(evidence: &Evidence<'_>, id: SensorId) -> IndexMap<String, Measure> {
    let chromatic = CHROMATIC.map(|(name, ..)| name);
    let names =
        ["radiant_flux", "radiant_efficiency", "luminous_efficacy"].into_iter().chain(chromatic);
    let names = names.chain(RENDERING.map(|(name, _)| name)).map(str::to_owned);
    let (count, ending) = WIDE_FIELD;
    let wide = chromatic[..count].iter().map(|name| format!("{name}{ending}"));
    let names = names.chain(wide);
    names.filter_map(|name| total(evidence, id, &name).map(|found| (name, found))).collect()
}

/// One of them, at no more cost than it needs.
pub(crate) fn total(evidence: &Evidence<'_>, id: SensorId, name: &str) -> Option<Measure> {
    evidence.scene.is_spectral().then_some(())?;
    let stimuli = SensorStimuli { evidence, id };
    if let Some((_, index)) = RENDERING.into_iter().find(|(own, _)| *own == name) {
        return Some(stimuli.rendering(index));
    }
    let (count, ending) = WIDE_FIELD;
    if let Some(name) = name.strip_suffix(ending) {
        let (_, unit, value) = CHROMATIC[..count].iter().find(|(own, ..)| *own == name)?;
        return Some(stimuli.in_wide_field(unit, *value));
    }
    match name {
        "radiant_flux" => Some(stimuli.radiant_flux(1.0, "W")),
        "radiant_efficiency" => {
            Some(stimuli.radiant_flux(evidence.scene.source_watts().recip(), "1"))
        }
        "luminous_efficacy" => Some(stimuli.measure("lm/W", |[_, y, _], watts| Some(y / watts))),
        _ => {
            let (_, unit, value) = CHROMATIC.into_iter().find(|(own, ..)| *own == name)?;
            Some(stimuli.measure(unit, |xyz, _| value(Chromaticity::from_tristimulus(xyz)?)))
        }
    }
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
    let nm: Vec<f64> = (0..SPECTRUM_BINS).map(|bin| FIRST_BIN + BIN_WIDTH * bin as f64).collect();
    let is_dark = |nm: f64| {
        let range = [nm - 0.5 * BIN_WIDTH, nm + 0.5 * BIN_WIDTH];
        let sources = evidence.scene.sources.iter().filter(|source| source.is_lit());
        let emitted = sources.filter_map(|source| Some(source.spectrum.as_ref()?.spectrum()));
        let converted = evidence.scene.media.iter().filter_map(Medium::fluorescence);
        let mut spectra = emitted.chain(converted.map(Fluorescence::emission));
        spectra.all(|own| own.share(range) == 0.0)
    };
    let band = |(bin, nm): (usize, &f64)| {
        if is_dark(*nm) {
            return evidence.no_light("W/nm");
        }
        stimuli.radiant(evidence.layout.spectrum(id, bin), 1.0 / BIN_WIDTH, "W/nm")
    };
    let bands: Vec<Measure> = nm.iter().enumerate().map(band).collect();
    Some(SensorSpectrum {
        sensor: evidence.scene.sensors[id.index()].name.clone(),
        nm,
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
    /// Radiant flux times a factor that leads to `unit`.
    fn radiant_flux(&self, factor: f64, unit: &str) -> Measure {
        self.radiant(self.evidence.layout.stimulus(self.id, Stimulus::Radiant), factor, unit)
    }

    /// A sum of radiant flux times a factor that leads to `unit`; where nothing was counted, its error is that of a path of mean
    /// efficacy.
    fn radiant(&self, slot: usize, factor: f64, unit: &str) -> Measure {
        let found = self.evidence.sum(&[slot], factor, unit);
        if found.status != Status::NoSignal {
            return found;
        }
        let scene = self.evidence.scene;
        let path = scene.source_flux() * scene.luminous_gain();
        Measure { std_error: found.std_error * scene.source_watts() / path, ..found }
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

    /// A function of the chromaticity for the CIE 1964 observer.
    fn in_wide_field(&self, unit: &str, value: OfChromaticity) -> Measure {
        let &Self { evidence, id } = self;
        let slots = [Stimulus::X10, Stimulus::Y10, Stimulus::Z10]
            .map(|stimulus| evidence.layout.stimulus(id, stimulus));
        let found = evidence.function(&evidence.layout.flux_slots(id), unit, |flux| {
            Chromaticity::from_tristimulus(slots.map(flux)).and_then(value).unwrap_or(f64::NAN)
        });
        self.defined(found)
    }

    fn rendering(&self, index: OfRendering) -> Measure {
        let &Self { evidence, id } = self;
        let luminous = evidence.layout.flux_slots(id);
        let found = evidence.function(&luminous, "1", |flux| {
            let spectrum =
                std::array::from_fn(|bin| flux(evidence.layout.spectrum(id, bin)) / BIN_WIDTH);
            colour_rendering(&spectrum).map_or(f64::NAN, |found| index(&found))
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
