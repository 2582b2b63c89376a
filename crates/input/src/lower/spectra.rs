//! Spectra of sources, and indices and absorption by wavelength.

use crate::keys::{Key, Places};
use crate::library;
use crate::lower::context::Context;
use crate::lower::media::library_names;
use crate::problems::{Problems, name_hint};
use crate::spec::SceneSpec;
use crate::spec::spectrum::{
    AbsorptionSpec, AbsorptionTableSpec, IndexLawSpec, IndexSpec, SpectrumSpec,
};
use lumiduct_base::number::{format_percent, format_value};
use lumiduct_core::colour::{
    DaylightPhase, NoSpectrum, PhosphorWhite, SpectralDraw, SpectralTable, Spectrum, VISIBLE,
    blackbody, equal_energy, gaussian, illuminant_a, illuminant_d65,
};
use lumiduct_core::optics::{AbsorptionLaw, IndexLaw, REFERENCE_WAVELENGTH};
use lumiduct_core::scene::Scene;
use lumiduct_files::spectral::{self, SpectralColumn, SpectralValues};
use std::f64::consts::PI;
use std::sync::Arc;

/// Refractive indices of media, 1.
const INDICES: std::ops::RangeInclusive<f64> = 1.0..=4.0;
/// Share of light beyond a table that is worth a remark, 1.
const BEYOND: f64 = 1e-3;

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

    fn spectrum(&mut self, spec: &SpectrumSpec, key: &Key) -> Option<Spectrum> {
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

    /// A column of a file; the hash of the scene contains what is used of it.
    fn read_by_wavelength(
        &mut self,
        file: &str,
        column: SpectralColumn<'_>,
        key: &Key,
    ) -> Option<SpectralValues> {
        self.may_build(key)?;
        let path = self.places.folder(key).join(file);
        match spectral::read(&path, column) {
            Ok(found) => {
                found
                    .rows
                    .iter()
                    .flatten()
                    .for_each(|number| self.meshes.add(&number.to_le_bytes()));
                Some(found)
            }
            Err(error) => {
                self.problems.error(key, format!("`{file}`: {error}"));
                None
            }
        }
    }

    /// The index of a medium by wavelength.
    pub(super) fn index_law(&mut self, spec: &IndexSpec, key: &Key) -> Option<IndexLaw> {
        let (law, key) = match spec {
            IndexSpec::Constant(index) => return Some(IndexLaw::Constant(*index)),
            IndexSpec::Law(IndexLawSpec::Cauchy(numbers)) => {
                (IndexLaw::Cauchy(*numbers), key.field("cauchy"))
            }
            IndexSpec::Law(IndexLawSpec::Sellmeier(terms)) => {
                (IndexLaw::Sellmeier(terms.clone()), key.field("sellmeier"))
            }
            IndexSpec::Law(IndexLawSpec::Powers(terms)) => {
                let key = key.field("powers");
                let Some(terms) = whole_powers(terms) else {
                    let message = "has a power that is not a whole number from -20 to 20";
                    return self.refuse(&key, message, "give pairs of coefficient and power");
                };
                (IndexLaw::Powers(terms), key)
            }
            IndexSpec::Law(IndexLawSpec::ByNm(rows)) => {
                let key = key.field("by_nm");
                (IndexLaw::Table(self.spectral_table(rows.clone(), &key)?), key)
            }
            IndexSpec::Law(IndexLawSpec::Library(name)) => {
                let key = key.field("library");
                let Some(known) = library::media().get(name) else {
                    let message = format!("the library has no medium `{}`", name.escape_debug());
                    return self.refuse(&key, message, name_hint(name, library_names()));
                };
                (self.hashed(known.law()), key)
            }
            IndexSpec::Law(IndexLawSpec::Csv(file)) => {
                let key = key.field("csv");
                let found = self.read_by_wavelength(file, SpectralColumn::Named(&["n"]), &key)?;
                (IndexLaw::Table(self.spectral_table(found.rows, &key)?), key)
            }
        };
        if let Some(pole) = pole(&law) {
            let message =
                format!("has no index at {} nm, where its law has a pole", format_value(pole));
            return self.refuse(
                &key,
                message,
                "C is in µm², the square of a wavelength in the ultraviolet or infrared",
            );
        }
        let places = whole_nm().chain(VISIBLE).chain(rows_of(&law));
        let wrong = places.map(|nm| (nm, law.at(nm))).find(|(_, n)| !INDICES.contains(n));
        let Some((nm, index)) = wrong else { return Some(law) };
        let message = format!("makes the index {} at {nm} nm", format_value(index));
        self.refuse(&key, message, "expected 1 to 4 at visible wavelengths; λ is in µm in formulas")
    }

    /// The absorption of a medium by wavelength.
    pub(super) fn absorption_law(
        &mut self,
        spec: &AbsorptionSpec,
        key: &Key,
    ) -> Option<AbsorptionLaw> {
        let (rows, key) = match spec {
            AbsorptionSpec::Constant(absorption) => {
                return Some(AbsorptionLaw::Constant(*absorption));
            }
            AbsorptionSpec::Table(AbsorptionTableSpec::ByNm(rows)) => {
                (rows.clone(), key.field("by_nm"))
            }
            AbsorptionSpec::Table(AbsorptionTableSpec::Csv(file)) => {
                let key = key.field("csv");
                let columns = SpectralColumn::Named(&["absorption_per_mm", "k"]);
                let found = self.read_by_wavelength(file, columns, &key)?;
                let is_extinction = found.name.eq_ignore_ascii_case("k");
                (if is_extinction { by_extinction(&found.rows) } else { found.rows }, key)
            }
        };
        if let Some([nm, value]) = rows.iter().find(|[_, value]| *value < 0.0) {
            let message = format!("is {} /mm at {nm} nm", format_value(*value));
            return self.refuse(&key, message, "expected 0 or more: media do not amplify light");
        }
        Some(AbsorptionLaw::Table(self.spectral_table(rows, &key)?))
    }

    /// A law of the library; the hash of the scene contains its index at every visible nm.
    pub(super) fn hashed(&mut self, law: IndexLaw) -> IndexLaw {
        whole_nm().for_each(|nm| self.meshes.add(&law.at(nm).to_le_bytes()));
        law
    }

    fn spectral_table(&mut self, rows: Vec<[f64; 2]>, key: &Key) -> Option<SpectralTable> {
        let table = SpectralTable::new(rows);
        if table.is_none() {
            let message = "is not a table of two or more ascending wavelengths above 0";
            self.problems.error(key, message).hint("sort it by wavelength, in nm");
        }
        table
    }
}

/// Coefficients with whole powers; `None` if any is not.
fn whole_powers(terms: &[[f64; 2]]) -> Option<Vec<(f64, i32)>> {
    let whole = |power: f64| (power.fract() == 0.0 && power.abs() <= 20.0).then_some(power as i32);
    terms.iter().map(|&[c, power]| Some((c, whole(power)?))).collect()
}

/// A visible wavelength, nm, at which a law has a pole.
fn pole(law: &IndexLaw) -> Option<f64> {
    let IndexLaw::Sellmeier(terms) = law else { return None };
    let places = terms.iter().map(|[_, c]| 1e3 * c.sqrt());
    places.into_iter().find(|nm| (VISIBLE[0]..=VISIBLE[1]).contains(nm))
}

/// The visible wavelengths of a table, nm.
fn rows_of(law: &IndexLaw) -> impl Iterator<Item = f64> {
    let rows = index_table(law).map_or(&[][..], SpectralTable::rows).iter();
    rows.map(|[nm, _]| *nm).filter(|nm| (VISIBLE[0]..=VISIBLE[1]).contains(nm))
}

/// The absorption coefficients, 1/mm, of a table of extinction coefficients k, at its wavelengths and at whole nm between:
/// 4πk/λ (Born & Wolf, 7th ed., 14.1, eq. 19).
fn by_extinction(rows: &[[f64; 2]]) -> Vec<[f64; 2]> {
    const MM_PER_NM: f64 = 1e-6;
    let Some(k) = SpectralTable::new(rows.to_vec()) else { return rows.to_vec() };
    let [first, last] = k.range();
    let mut places: Vec<f64> = rows.iter().map(|[nm, _]| *nm).collect();
    places.extend(whole_nm().filter(|nm| *nm > first && *nm < last));
    places.sort_by(f64::total_cmp);
    places.dedup();
    places.into_iter().map(|nm| [nm, 4.0 * PI * k.at(nm) / (nm * MM_PER_NM)]).collect()
}

/// Every visible whole nm.
pub(super) fn whole_nm() -> impl Iterator<Item = f64> {
    let [first, last] = VISIBLE;
    (first.ceil() as u32..=last as u32).map(f64::from)
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
        let tables = [
            ("index", matches!(medium.index, IndexSpec::Law(_)), index_table(made.index_law())),
            (
                "absorption_per_mm",
                matches!(medium.absorption_per_mm, AbsorptionSpec::Table(_)),
                absorption_table(made.absorption_law()),
            ),
        ];
        for (field, is_law, table) in tables {
            let key = Key::of(&["media", name, field]);
            let is_listed = places.is_in_another_file(&key)
                || field == "index"
                    && matches!(medium.index, IndexSpec::Law(IndexLawSpec::Library(_)));
            if is_law && spectra.is_empty() && !is_listed {
                problems
                    .warning(&key, "no source has a spectrum: its value at 555 nm applies")
                    .hint("give every source a `spectrum`");
            }
            let Some([first, last]) = table.map(SpectralTable::range) else { continue };
            let range = format!("{} to {} nm", format_value(first), format_value(last));
            if spectra.is_empty() {
                if !(first..=last).contains(&REFERENCE_WAVELENGTH) {
                    problems
                        .error(&key, format!("{range} does not include 555 nm"))
                        .hint("light without a spectrum has this wavelength; tables are in nm");
                }
                continue;
            }
            let inside = |spectrum: &&Spectrum| spectrum.share([first, last]);
            let least = spectra.iter().map(inside).fold(1.0, f64::min);
            if least <= 0.0 {
                problems
                    .error(
                        &key,
                        format!("a source emits no light from {range}, where it has values"),
                    )
                    .hint("give values for its wavelengths; they are in nm");
            } else if least < 1.0 - BEYOND {
                let message = format!(
                    "{} of the light of a source is outside of {range}; there the value at the end applies",
                    format_percent(1.0 - least)
                );
                problems.warning(&key, message);
            }
        }
    }
}

/// The spectra of the sources that shine.
fn lit_spectra(scene: &Scene) -> impl Iterator<Item = &Spectrum> {
    let lit = scene.sources.iter().filter(|source| source.is_lit());
    lit.filter_map(|source| Some(source.spectrum.as_ref()?.spectrum()))
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

fn index_table(law: &IndexLaw) -> Option<&SpectralTable> {
    match law {
        IndexLaw::Table(table) => Some(table),
        IndexLaw::Constant(_)
        | IndexLaw::Cauchy(_)
        | IndexLaw::Sellmeier(_)
        | IndexLaw::Powers(_) => None,
    }
}

fn absorption_table(law: &AbsorptionLaw) -> Option<&SpectralTable> {
    match law {
        AbsorptionLaw::Table(table) => Some(table),
        AbsorptionLaw::Constant(_) => None,
    }
}
