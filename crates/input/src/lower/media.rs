//! Media: clear ones and those that scatter.

use crate::keys::Key;
use crate::library;
use crate::lower::context::Context;
use crate::spec::PREDEFINED_MEDIA;
use crate::spec::medium::{ScatteringCoefficientSpec, ScatteringSpec, ScatteringTableSpec};
use lumiduct_core::optics::{CoefficientLaw, IndexLaw, Medium, Turbidity};
use lumiduct_core::scene::MediumId;
use lumiduct_files::spectral::SpectralColumn;

/// What is wrong with a negative coefficient of scattering.
const TURBID: &str = "expected 0 or more: 0 where the medium is clear";

/// The names of the library.
pub(super) fn library_names() -> impl Iterator<Item = &'static str> + Clone {
    library::media().keys().map(String::as_str)
}

impl Context<'_> {
    pub(super) fn lower_media(&mut self) {
        let spec = self.spec;
        for (name, medium) in &spec.media {
            let key = Key::of(&["media", name]);
            let index = self.index_law(&medium.index, &key.field("index"));
            let absorption = &medium.absorption_per_mm;
            let absorption = self.absorption_law(absorption, &key.field("absorption_per_mm"));
            // A medium with a problem is there, so that its name is known.
            let clear = Medium::dispersive(
                name,
                index.unwrap_or(IndexLaw::Constant(1.0)),
                absorption.unwrap_or(CoefficientLaw::Constant(0.0)),
            );
            let turbidity = medium
                .scattering
                .as_ref()
                .and_then(|spec| self.turbidity(spec, &key.field("scattering")));
            let turbid = match turbidity {
                Some(turbidity) => clear.with_scattering(turbidity),
                None => clear,
            };
            let fluorescence = medium
                .fluorescence
                .as_ref()
                .and_then(|spec| self.lower_fluorescence(spec, &key.field("fluorescence")));
            let made = match fluorescence {
                Some(fluorescence) => turbid.with_fluorescence(fluorescence),
                None => turbid,
            };
            self.media.insert(name.clone(), self.builder.add_medium(made));
        }
        // Media of the library are added before finishes, which depend on the indices beside them.
        for solid in spec.solids.values() {
            let name = &solid.common().medium;
            if library::media().contains_key(name) {
                self.medium(name, &Key::of(&["solids"]));
            }
        }
        let (key, name) = (Key::of(&["surroundings"]), &spec.surroundings);
        if let Some(surroundings) = self.medium(name, &key) {
            self.builder.set_surroundings(surroundings);
        }
        let Some(surroundings) = spec.media.get(name) else { return };
        let endless = [
            (surroundings.scattering.is_some(), "scatters"),
            (surroundings.fluorescence.is_some(), "fluoresces"),
        ];
        for (_, verb) in endless.into_iter().filter(|(is_so, _)| *is_so) {
            self.problems
                .error(&key, format!("`{name}` {verb}: light would never leave the scene"))
                .hint("put a solid of this medium around the scene");
        }
    }

    /// How a medium scatters.
    fn turbidity(
        &mut self,
        ScatteringSpec { per_mm, anisotropy }: &ScatteringSpec,
        key: &Key,
    ) -> Option<Turbidity> {
        let key = key.field("per_mm");
        let coefficient = match per_mm {
            ScatteringCoefficientSpec::Constant(0.0) => return None,
            ScatteringCoefficientSpec::Constant(per_mm) => CoefficientLaw::Constant(*per_mm),
            ScatteringCoefficientSpec::Table(ScatteringTableSpec::ByNm(rows)) => {
                self.coefficients(rows.clone(), &key.field("by_nm"), TURBID)?
            }
            ScatteringCoefficientSpec::Table(ScatteringTableSpec::Csv(file)) => {
                let key = key.field("csv");
                let columns = SpectralColumn::Named(&["scattering_per_mm"]);
                let found = self.read_by_wavelength(file, columns, &key)?;
                self.coefficients(found.rows, &key, TURBID)?
            }
        };
        Some(Turbidity { coefficient, anisotropy: *anisotropy })
    }

    /// The medium of a name: one of the file, or of the library.
    pub(super) fn medium(&mut self, name: &str, key: &Key) -> Option<MediumId> {
        if let Some(medium) = self.media.get(name) {
            return Some(*medium);
        }
        let Some(known) = library::media().get(name) else {
            let predefined: Vec<&str> = library_names().chain(PREDEFINED_MEDIA).collect();
            self.require_known(["medium", "media"], name, &predefined, key);
            return None;
        };
        let index = self.hashed(known.law());
        let absorption = known.absorption().unwrap_or(CoefficientLaw::Constant(0.0));
        if let CoefficientLaw::Table(table) = &absorption {
            let numbers = table.rows().iter().flatten();
            numbers.for_each(|number| self.meshes.add(&number.to_le_bytes()));
        }
        let made = Medium::dispersive(name, index, absorption);
        let medium = self.builder.add_medium(made);
        self.media.insert(name.to_owned(), medium);
        Some(medium)
    }
}
