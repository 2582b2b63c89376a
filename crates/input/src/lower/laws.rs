//! Indices and absorption by wavelength.

use crate::keys::Key;
use crate::library;
use crate::lower::context::Context;
use crate::lower::media::library_names;
use crate::problems::name_hint;
use crate::spec::spectrum::{AbsorptionSpec, AbsorptionTableSpec, IndexLawSpec, IndexSpec};
use lumiduct_base::number::format_value;
use lumiduct_core::colour::{SpectralTable, VISIBLE};
use lumiduct_core::optics::{CoefficientLaw, IndexLaw};
use lumiduct_files::spectral::{self, SpectralColumn, SpectralValues};
use std::f64::consts::PI;
use std::ops::RangeInclusive;

/// Refractive indices of media, 1.
const INDICES: RangeInclusive<f64> = 1.0..=4.0;

impl Context<'_> {
    /// A column of a file; the hash of the scene contains what is used of it.
    pub(super) fn read_by_wavelength(
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
        match spec {
            IndexSpec::Constant(index) => Some(IndexLaw::Constant(*index)),
            IndexSpec::Law(law) => self.index_law_within(INDICES, law, key),
        }
    }

    /// An index by wavelength, of a material whose indices are within these limits.
    pub(super) fn index_law_within(
        &mut self,
        limits: RangeInclusive<f64>,
        spec: &IndexLawSpec,
        key: &Key,
    ) -> Option<IndexLaw> {
        let (law, key) = match spec {
            IndexLawSpec::Cauchy(numbers) => (IndexLaw::Cauchy(*numbers), key.field("cauchy")),
            IndexLawSpec::Sellmeier(terms) => {
                (IndexLaw::Sellmeier(terms.clone()), key.field("sellmeier"))
            }
            IndexLawSpec::Powers(terms) => {
                let key = key.field("powers");
                let Some(terms) = whole_powers(terms) else {
                    let message = "has a power that is not a whole number from -20 to 20";
                    return self.refuse(&key, message, "give pairs of coefficient and power");
                };
                (IndexLaw::Powers(terms), key)
            }
            IndexLawSpec::ByNm(rows) => {
                let key = key.field("by_nm");
                (IndexLaw::Table(self.spectral_table(rows.clone(), &key)?), key)
            }
            IndexLawSpec::Library(name) => {
                let key = key.field("library");
                let Some(known) = library::media().get(name) else {
                    let message = format!("the library has no medium `{}`", name.escape_debug());
                    return self.refuse(&key, message, name_hint(name, library_names()));
                };
                (self.hashed(known.law()), key)
            }
            IndexLawSpec::Csv(file) => {
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
        let wrong = places.map(|nm| (nm, law.at(nm))).find(|(_, n)| !limits.contains(n));
        let Some((nm, index)) = wrong else { return Some(law) };
        let message = format!("makes the index {} at {nm} nm", format_value(index));
        let (least, most) = (limits.start(), limits.end());
        let hint =
            format!("expected {least} to {most} at visible wavelengths; λ is in µm in formulas");
        self.refuse(&key, message, hint)
    }

    /// The absorption of a medium by wavelength.
    pub(super) fn absorption_law(
        &mut self,
        spec: &AbsorptionSpec,
        key: &Key,
    ) -> Option<CoefficientLaw> {
        let (rows, key) = match spec {
            AbsorptionSpec::Constant(absorption) => {
                return Some(CoefficientLaw::Constant(*absorption));
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
        self.coefficients(rows, &key, "expected 0 or more: media do not amplify light")
    }

    /// A table of coefficients, 1/mm, with a hint for the error where one is negative.
    pub(super) fn coefficients(
        &mut self,
        rows: Vec<[f64; 2]>,
        key: &Key,
        hint: &str,
    ) -> Option<CoefficientLaw> {
        if let Some([nm, value]) = rows.iter().find(|[_, value]| *value < 0.0) {
            let message = format!("is {} /mm at {nm} nm", format_value(*value));
            return self.refuse(key, message, hint);
        }
        Some(CoefficientLaw::Table(self.spectral_table(rows, key)?))
    }

    /// A law of the library; the hash of the scene contains its index at every visible nm.
    pub(super) fn hashed(&mut self, law: IndexLaw) -> IndexLaw {
        whole_nm().for_each(|nm| self.meshes.add(&law.at(nm).to_le_bytes()));
        law
    }

    pub(super) fn spectral_table(
        &mut self,
        rows: Vec<[f64; 2]>,
        key: &Key,
    ) -> Option<SpectralTable> {
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

/// The table of an index that has one.
pub(super) fn index_table(law: &IndexLaw) -> Option<&SpectralTable> {
    match law {
        IndexLaw::Table(table) => Some(table),
        IndexLaw::Constant(_)
        | IndexLaw::Cauchy(_)
        | IndexLaw::Sellmeier(_)
        | IndexLaw::Powers(_) => None,
    }
}
