//! Media: clear ones and those that scatter.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::spec::PREDEFINED_MEDIA;
use crate::spec::finish::ScatteringSpec;
use lumiduct_core::optics::{Medium, VolumeScattering};
use lumiduct_core::scene::MediumId;

impl Context<'_> {
    pub(super) fn lower_media(&mut self) {
        let spec = self.spec;
        for (name, medium) in &spec.media {
            let clear = Medium::new(name, medium.index, medium.absorption_per_mm);
            let made = match medium.scattering {
                Some(ScatteringSpec { per_mm, anisotropy }) => {
                    clear.with_scattering(VolumeScattering::new(per_mm, anisotropy))
                }
                None => clear,
            };
            self.media.insert(name.clone(), self.builder.add_medium(made));
        }
        let (key, name) = (Key::of(&["surroundings"]), &spec.surroundings);
        if let Some(surroundings) = self.medium(name, &key) {
            self.builder.set_surroundings(surroundings);
        }
        if spec.media.get(name).is_some_and(|medium| medium.scattering.is_some()) {
            self.problems
                .error(&key, format!("`{name}` scatters: light would never leave the scene"))
                .hint("put a solid of this medium around the scene");
        }
    }

    /// The medium of a name.
    pub(super) fn medium(&mut self, name: &str, key: &Key) -> Option<MediumId> {
        let medium = self.media.get(name).copied();
        if medium.is_none() {
            self.require_known(["medium", "media"], name, &PREDEFINED_MEDIA, key);
        }
        medium
    }
}
