//! Spectra of sources, and what of them is outside of the tables of media and finishes.

use crate::keys::{Key, Places};
use crate::library;
use crate::lower::context::{Context, FinishTable};
use crate::lower::laws::index_table;
use crate::problems::Problems;
use crate::spec::SceneSpec;
use crate::spec::spectrum::{IndexLawSpec, IndexSpec, SpectrumSpec};
use lumiduct_base::number::{format_percent, format_value};
use lumiduct_core::colour::{
    DaylightPhase, NoSpectrum, PhosphorWhite, SpectralDraw, SpectralTable, Spectrum, blackbody,
    equal_energy, gaussian, illuminant_a, illuminant_d65,
};
use lumiduct_core::optics::{CoefficientLaw, Fluorescence, Medium, REFERENCE_WAVELENGTH};
use lumiduct_core::scene::Scene;
use lumiduct_files::spectral::SpectralColumn;
use std::sync::Arc;

/// Share of light beyond a table that is worth a remark, 1.
const BEYOND: f64 = 1e-3;
/// Share that is all the light of a spectrum, up to rounding, 1.
const ALL: f64 = 1.0 - 1e-9;

/// Whether any source has a spectrum.
pub(super) fn is_spectral(spec: &SceneSpec) -> bool {
    spec.sources.values().any(|source| source.spectrum().is_some())
}

impl Context<'_> {
    /// The spectrum of the source that is lowered next.
    pub(super) fn lower_spectrum(&mut self, spec: Option<&SpectrumSpec>, key: &Key) {
        self.spectrum = None;
        if !is_spectral(self.spec) {
            return;
        }
        let Some(spec) = spec else {
            let with = self.spec.sources.iter().find(|(_, source)| source.spectrum().is_some());
            let with = with.map_or("", |(name, _)| name.as_str());
            let message = format!("has no `spectrum`, but `sources.{with}` has one");
            self.problems.error(key, message).hint(
                "give every source a spectrum, such as spectrum = \"cie_d65\" or { blackbody_k = 2700 }",
            );
            return;
        };
        let key = key.field("spectrum");
        if let Some(spectrum) = self.spectrum(spec, &key) {
            self.spectrum = Some(Arc::new(SpectralDraw::new(spectrum)));
        }
    }

    pub(super) fn spectrum(&mut self, spec: &SpectrumSpec, key: &Key) -> Option<Spectrum> {
        let (made, key) = match spec {
            SpectrumSpec::CieA => (Spectrum::of_law(illuminant_a), key.clone()),
            SpectrumSpec::CieD65 => (Spectrum::of_law(illuminant_d65), key.clone()),
            SpectrumSpec::EqualEnergy => (Spectrum::of_law(equal_energy), key.clone()),
            SpectrumSpec::BlackbodyK(kelvin) => {
                (Spectrum::of_law(|nm| blackbody(nm, *kelvin)), key.field("blackbody_k"))
            }
            SpectrumSpec::DaylightK(kelvin) => {
                let phase = DaylightPhase::new(*kelvin)?;
                (Spectrum::of_law(|nm| phase.at(nm)), key.field("daylight_k"))
            }
            SpectrumSpec::PhosphorWhiteK(kelvin) => {
                let led = PhosphorWhite::new(*kelvin)?;
                (Spectrum::of_law(|nm| led.at(nm)), key.field("phosphor_white_k"))
            }
            SpectrumSpec::Peak(peak) => {
                let law = |nm| gaussian(nm, peak.peak_nm, peak.fwhm_nm);
                (Spectrum::of_law(law), key.field("peak"))
            }
            SpectrumSpec::LineNm(nm) => (Spectrum::line(*nm), key.field("line_nm")),
            SpectrumSpec::ByNm(rows) => {
                let key = key.field("by_nm");
                self.note_left_out(rows, &key);
                (Spectrum::new(rows), key)
            }
            SpectrumSpec::Csv(file) => {
                let key = key.field("csv");
                let found = self.read_by_wavelength(file, SpectralColumn::Second, &key)?;
                self.note_left_out(&found.rows, &key);
                (Spectrum::new(&found.rows), key)
            }
            SpectrumSpec::Sum(parts) => {
                let key = key.field("sum");
                let made = parts.iter().enumerate().map(|(index, part)| {
                    let key = key.index(index).field("spectrum");
                    Some((part.share, self.spectrum(&part.spectrum, &key)?))
                });
                let made: Vec<_> = made.collect::<Option<_>>()?;
                (Spectrum::sum(&made), key)
            }
        };
        match made {
            Ok(spectrum) => Some(spectrum),
            Err(reason) => {
                let hint = match reason {
                    NoSpectrum::TooShort => "give two or more pairs of wavelength and value",
                    NoSpectrum::NotAscending => "sort it by wavelength, in nm",
                    NoSpectrum::Negative => "set negative readings to 0",
                    NoSpectrum::Dark => "only visible light is computed; wavelengths are in nm",
                };
                self.refuse(&key, format!("is not a spectrum: {reason}"), hint)
            }
        }
    }

    /// Notes radiant flux of a table that is not visible.
    fn note_left_out(&mut self, rows: &[[f64; 2]], key: &Key) {
        // What is not a spectrum is reported as such.
        let share = if rows.len() < 2 { 1.0 } else { Spectrum::visible_share(rows) };
        if share > 0.0 && share < 1.0 - BEYOND {
            let message = format!(
                "{} of its radiant flux is not visible and left out",
                format_percent(1.0 - share)
            );
            self.problems
                .warning(key, message)
                .hint("a `flux_w` is the flux from 377.5 to 782.5 nm");
        }
    }
}

/// Notes media whose tables end within the light of the sources, and those that disperse light without a spectrum.
pub(super) fn note_tables(
    spec: &SceneSpec,
    places: &Places,
    scene: &Scene,
    problems: &mut Problems,
) {
    let spectra: Vec<&Spectrum> = lit_spectra(scene).collect();
    for (name, medium) in &spec.media {
        let Some(made) = scene.media.iter().find(|own| own.name() == name) else { continue };
        let scattering = made.turbidity().map(|own| &own.coefficient);
        let dye = made.fluorescence().map(Fluorescence::absorption_law);
        let is_formula = matches!(medium.index, IndexSpec::Law(_));
        let tables = [
            (["index"].as_slice(), is_formula, index_table(made.index_law())),
            (&["absorption_per_mm"], false, coefficient_table(made.absorption_law())),
            (&["scattering", "per_mm"], false, scattering.and_then(coefficient_table)),
            (&["fluorescence", "absorption_per_mm"], false, dye.and_then(coefficient_table)),
        ];
        for (fields, is_formula, table) in tables {
            let key = fields.iter().fold(Key::of(&["media", name]), |key, field| key.field(field));
            let is_listed = places.is_in_another_file(&key)
                || fields == ["index"]
                    && matches!(medium.index, IndexSpec::Law(IndexLawSpec::Library(_)));
            if (is_formula || table.is_some()) && spectra.is_empty() && !is_listed {
                problems
                    .warning(&key, "no source has a spectrum: its value at 555 nm applies")
                    .hint("give every source a `spectrum`");
            }
            let Some(table) = table else { continue };
            let [first, last] = table.range();
            let range = format!("{} to {} nm", format_value(first), format_value(last));
            if spectra.is_empty() {
                if !(first..=last).contains(&REFERENCE_WAVELENGTH) {
                    problems
                        .error(&key, format!("{range} does not include 555 nm"))
                        .hint("light without a spectrum has this wavelength; tables are in nm");
                }
                continue;
            }
            let sources = spectra.iter().map(|own| share_beyond(table, own)).fold(0.0, f64::max);
            let emitted = emissions(scene).map(|own| share_beyond(table, own)).fold(0.0, f64::max);
            let is_dark = |own: &Spectrum| own.share([first, last]) <= 0.0;
            let is_unused = lit_spectra(scene).chain(emissions(scene)).all(is_dark);
            if sources >= ALL || is_unused {
                problems
                    .error(
                        &key,
                        format!("a source emits no light from {range}, where it has values"),
                    )
                    .hint("give values for its wavelengths; they are in nm");
            } else if sources > BEYOND {
                let message = format!(
                    "{} of the light of a source is outside of {range}; there the value at the end applies",
                    format_percent(sources)
                );
                problems.warning(&key, message);
            } else if emitted > BEYOND {
                let message = format!(
                    "{} of the light of fluorescence is outside of {range}; there the value at the end applies",
                    format_percent(emitted)
                );
                problems.warning(&key, message);
            }
        }
    }
}

/// Share of the light of a spectrum beyond the ends of a table, but for ends where its value is 0.
fn share_beyond(table: &SpectralTable, light: &Spectrum) -> f64 {
    let [first, last] = table.range();
    let before = if table.at(first) == 0.0 { 0.0 } else { light.share([0.0, first]) };
    let after = if table.at(last) == 0.0 { 0.0 } else { light.share([last, f64::INFINITY]) };
    before + after
}

/// The spectra of the sources that shine.
fn lit_spectra(scene: &Scene) -> impl Iterator<Item = &Spectrum> {
    let lit = scene.sources.iter().filter(|source| source.is_lit());
    lit.filter_map(|source| Some(source.spectrum.as_ref()?.spectrum()))
}

/// The spectra of fluorescence.
fn emissions(scene: &Scene) -> impl Iterator<Item = &Spectrum> {
    scene.media.iter().filter_map(Medium::fluorescence).map(Fluorescence::emission)
}

/// Notes finishes whose tables end within the light that meets them.
pub(super) fn note_finish_tables(tables: &[FinishTable], scene: &Scene, problems: &mut Problems) {
    for FinishTable { key, range: [first, last], wavelength } in tables {
        let range = format!("{} to {} nm", format_value(*first), format_value(*last));
        if let Some(nm) = wavelength {
            if !(*first..=*last).contains(nm) {
                let message = format!("{range} does not include {} nm", format_value(*nm));
                problems
                    .error(key, message)
                    .hint("the finish acts at this wavelength; tables are in nm");
            }
            continue;
        }
        let inside = lit_spectra(scene).map(|spectrum| spectrum.share([*first, *last]));
        let inside: Vec<f64> = inside.collect();
        let least = inside.iter().copied().fold(1.0, f64::min);
        if !inside.is_empty() && inside.iter().all(|share| *share <= 0.0) {
            problems
                .error(key, format!("no source emits light from {range}, where it has values"))
                .hint("give values for the wavelengths of the sources; they are in nm");
        } else if least < 1.0 - BEYOND {
            let message = format!(
                "{} of the light of a source is outside of {range}; there the value at the end applies",
                format_percent(1.0 - least)
            );
            problems.warning(key, message);
        }
    }
}

/// Notes light outside of the wavelengths for which media of the library were measured.
pub(super) fn note_library(spec: &SceneSpec, scene: &Scene, problems: &mut Problems) {
    for medium in &scene.media {
        let name = medium.name();
        let own = spec.media.get(name);
        let (named, key) = match own.map(|own| &own.index) {
            None => (name, Key::of(&["media", name])),
            Some(IndexSpec::Law(IndexLawSpec::Library(named))) => {
                (named.as_str(), Key::of(&["media", name, "index", "library"]))
            }
            Some(IndexSpec::Constant(_) | IndexSpec::Law(_)) => continue,
        };
        let Some(known) = library::media().get(named) else { continue };
        let inside = lit_spectra(scene).map(|own| own.share(known.range_nm)).fold(1.0, f64::min);
        if inside < 1.0 - BEYOND {
            let [first, last] = known.range_nm.map(format_value);
            let message = format!(
                "{} of the light of a source is outside of {first} to {last} nm, where the index of `{named}` was measured",
                format_percent(1.0 - inside)
            );
            problems.warning(&key, message).hint("its formula is used there all the same");
        }
    }
}

fn coefficient_table(law: &CoefficientLaw) -> Option<&SpectralTable> {
    match law {
        CoefficientLaw::Table(table) => Some(table),
        CoefficientLaw::Constant(_) => None,
    }
}
