//! Media, finishes and emissions that scenes can name without defining them, with the sources of their numbers.
//!
//! An entry has the keys that a scene would give it, so that the spec types of scenes read it. Nothing is known here of
//! what the numbers mean.

use crate::spec::finish::FinishSpec;
use crate::spec::source::EmissionSpec;
use indexmap::IndexMap;
use lumiduct_core::colour::SpectralTable;
use lumiduct_core::optics::{CoefficientLaw, IndexLaw};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::sync::LazyLock;

static MEDIA: LazyLock<IndexMap<String, LibraryMedium>> = LazyLock::new(|| {
    toml::from_str(include_str!("../library/media.toml")).expect("a test reads the library")
});

static FINISHES: LazyLock<IndexMap<String, LibraryEntry<FinishSpec>>> =
    LazyLock::new(|| entries(include_str!("../library/finishes.toml")));

static EMISSIONS: LazyLock<IndexMap<String, LibraryEntry<EmissionSpec>>> =
    LazyLock::new(|| entries(include_str!("../library/emissions.toml")));

/// A medium of the library.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LibraryMedium {
    /// What it is.
    pub description: String,
    index: LibraryIndex,
    absorption_per_mm: Option<LibraryAbsorption>,
    /// The wavelengths for which its index was measured, nm.
    pub range_nm: [f64; 2],
    /// Where its numbers are from.
    pub source: String,
    /// The licence of its numbers.
    pub licence: String,
}

/// The law of an index, as in a scene.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum LibraryIndex {
    Sellmeier(Vec<[f64; 2]>),
    Powers(Vec<(f64, i32)>),
}

/// An absorption by wavelength, as in a scene.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum LibraryAbsorption {
    ByNm(Vec<[f64; 2]>),
}

impl LibraryMedium {
    /// Its index by wavelength.
    pub fn law(&self) -> IndexLaw {
        match &self.index {
            LibraryIndex::Sellmeier(terms) => IndexLaw::Sellmeier(terms.clone()),
            LibraryIndex::Powers(terms) => IndexLaw::Powers(terms.clone()),
        }
    }

    /// Its absorption by wavelength; `None` where it is not known, as of plastics, whose grades differ.
    pub fn absorption(&self) -> Option<CoefficientLaw> {
        let LibraryAbsorption::ByNm(rows) = self.absorption_per_mm.as_ref()?;
        let table = SpectralTable::new(rows.clone()).expect("a test reads the library");
        Some(CoefficientLaw::Table(table))
    }
}

/// An entry of the library that has the keys of a table of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct LibraryEntry<Spec> {
    /// What it is.
    pub description: String,
    /// Where its numbers are from.
    pub source: String,
    /// The licence of its numbers.
    pub licence: String,
    /// Its keys and values in TOML, on one line, as a scene would define it in place.
    pub keys: String,
    pub(crate) spec: Spec,
}

/// An entry as it is in the file.
#[derive(Deserialize)]
struct WrittenEntry {
    description: String,
    source: String,
    licence: String,
    #[serde(flatten)]
    keys: toml::Table,
}

fn entries<Spec: DeserializeOwned>(text: &str) -> IndexMap<String, LibraryEntry<Spec>> {
    let written: IndexMap<String, WrittenEntry> =
        toml::from_str(text).expect("a test reads the library");
    let entry = |WrittenEntry { description, source, licence, keys }| LibraryEntry {
        description,
        source,
        licence,
        keys: toml::Value::Table(keys.clone()).to_string(),
        spec: keys.try_into().expect("a test reads the library"),
    };
    written.into_iter().map(|(name, written)| (name, entry(written))).collect()
}

/// All media of the library by name, in its order.
pub fn media() -> &'static IndexMap<String, LibraryMedium> {
    &MEDIA
}

/// All finishes of the library by name, in its order.
pub fn finishes() -> &'static IndexMap<String, LibraryEntry<FinishSpec>> {
    &FINISHES
}

/// All emissions of the library by name, in its order.
pub fn emissions() -> &'static IndexMap<String, LibraryEntry<EmissionSpec>> {
    &EMISSIONS
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn media_have_the_indices_of_their_sources_at_the_d_line() {
        let names: Vec<&str> = media().keys().map(String::as_str).collect();
        assert_eq!(
            names,
            ["pmma", "pc", "ps", "bk7", "fused_silica", "water", "pure_water", "cop"]
        );
        // Catalogue values of index and Abbe number; one-term laws have the index within 1e-3 and the Abbe number within 8 %.
        for (name, index, abbe) in [
            ("pmma", 1.4918, 57.4),
            ("pc", 1.585, 30.0),
            ("ps", 1.592, 30.9),
            ("bk7", 1.5168, 64.17),
            ("fused_silica", 1.45846, 67.8),
            ("water", 1.33336, 55.7),
            ("pure_water", 1.33336, 55.7),
            ("cop", 1.531, 56.0),
        ] {
            let law = media()[name].law();
            let found = [law.at(587.5618), law.abbe_number()];
            assert!((found[0] - index).abs() < 1.5e-3, "{name}: {found:?}");
            assert!((found[1] / abbe - 1.0).abs() < 0.08, "{name}: {found:?}");
        }
    }

    #[test]
    fn only_pure_water_absorbs_and_least_at_420_nm() {
        let absorbing = media().iter().filter_map(|(name, own)| Some((name, own.absorption()?)));
        let [(name, law)] = absorbing.collect::<Vec<_>>().try_into().unwrap();
        assert_eq!(name, "pure_water");
        // Pope & Fry (1997): 0.0204 /m at 500 nm, 0.340 /m at 650 nm.
        assert_eq!([500.0, 650.0].map(|nm| law.at(nm)), [20.4e-6, 340e-6]);
        let all = (400..=700).map(|nm| law.at(f64::from(nm)));
        assert_eq!(all.fold(1.0, f64::min), law.at(420.0));
    }

    #[test]
    fn metals_reflect_what_their_descriptions_say() {
        for (name, reflectance) in [("aluminium", "91.5 %"), ("silver", "98.4 %")] {
            let entry = &finishes()[name];
            let FinishSpec::Metal(metal) = &entry.spec else { panic!("{name} is no metal") };
            let share = |n: f64| (n - 1.0).powi(2) + metal.k.powi(2);
            // Born & Wolf, 7th ed., 14.2: at normal incidence.
            let found = format!("{:.1} %", 100.0 * share(metal.n) / share(-metal.n));
            assert_eq!(found, reflectance, "{name}");
            assert!(entry.description.contains(&found), "{name}");
        }
    }

    #[test]
    fn an_entry_keeps_its_keys_as_a_scene_would_have_them() {
        assert_eq!(finishes()["esr"].keys, "{ specular = { reflectance = 0.98 } }");
    }

    #[test]
    fn every_entry_says_where_its_numbers_are_from() {
        for (name, medium) in media() {
            let texts = [&medium.description, &medium.source, &medium.licence];
            assert!(texts.iter().all(|text| text.len() > 5), "{name}");
            let [first, last] = medium.range_nm;
            assert!(first < 550.0 && last > 650.0, "{name}");
        }
        assert!(!media().is_empty() && !finishes().is_empty() && !emissions().is_empty());
        finishes().iter().for_each(|(name, entry)| assert_is_cited(name, entry));
        emissions().iter().for_each(|(name, entry)| assert_is_cited(name, entry));
    }

    fn assert_is_cited<Spec>(name: &str, entry: &LibraryEntry<Spec>) {
        let texts = [&entry.description, &entry.source, &entry.licence];
        assert!(texts.iter().all(|text| text.len() > 5), "{name}");
    }

    #[test]
    fn names_of_emissions_end_in_their_viewing_angle() {
        for (name, entry) in emissions() {
            let EmissionSpec::ViewingAngleDeg(angle) = entry.spec else { panic!("{name}") };
            assert!(name.ends_with(&format!("_{angle}deg")), "{name}: {angle}");
            assert!(entry.description.contains(&format!("{angle} deg")), "{name}: {angle}");
        }
    }
}
