//! Fluorescence of media.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::lower::laws::whole_nm;
use crate::lower::spectra::is_spectral;
use crate::problems::Problems;
use crate::spec::medium::FluorescenceSpec;
use lumiduct_base::number::format_value;
use lumiduct_core::colour::{Spectrum, VISIBLE};
use lumiduct_core::optics::Fluorescence;
use lumiduct_core::scene::{Scene, Source};

/// Emission at an end of the visible range, over its most, from which on it is worth a remark, 1.
const CUT: f64 = 0.01;

impl Context<'_> {
    /// What a medium absorbs and emits at other wavelengths.
    pub(super) fn lower_fluorescence(
        &mut self,
        spec: &FluorescenceSpec,
        key: &Key,
    ) -> Option<Fluorescence> {
        if !is_spectral(self.spec) {
            let key_of = |source: &String| Key::of(&["sources", source, "spectrum"]);
            if self.spec.sources.keys().any(|source| self.places.has(&key_of(source))) {
                // Its error is reported there.
                return None;
            }
            let message = "changes the wavelength of light, but no source has a `spectrum`";
            let hint =
                "give every source a spectrum, such as { peak = { peak_nm = 450, fwhm_nm = 20 } }";
            return self.refuse(key, message, hint);
        }
        let absorption =
            self.absorption_law(&spec.absorption_per_mm, &key.field("absorption_per_mm"));
        let emission = self.spectrum(&spec.emission, &key.field("emission"));
        let (absorption, emission) = (absorption?, emission?);
        let most = whole_nm().map(|nm| emission.at(nm)).fold(0.0, f64::max);
        for nm in VISIBLE.into_iter().filter(|nm| emission.at(*nm) > CUT * most) {
            let nm = format_value(nm);
            self.problems
                .warning(&key.field("emission"), format!("is cut at {nm} nm: only visible light is computed"))
                .hint("`quantum_yield` counts the photons up to there: lower it by the share that is cut");
        }
        Some(Fluorescence::new(absorption, spec.quantum_yield, emission))
    }
}

/// Refuses fluorescence that would emit more power than it absorbs from a source. A dye may do so at the long-wave end of
/// its absorption, where thermal energy makes up the difference, but hardly with all light of a source.
pub(super) fn expect_energy(scene: &Scene, problems: &mut Problems) {
    let media = scene.media.iter().filter_map(|own| Some((own.name(), own.fluorescence()?)));
    for (name, own) in media {
        let gains = |source: &&Source| {
            let from = source.spectrum.as_ref().filter(|_| source.is_lit());
            from.is_some_and(|from| absorbed_wavelength(from.spectrum(), own) > limit(own))
        };
        let Some(source) = scene.sources.iter().find(gains) else { continue };
        let message = format!(
            "would emit more power than it absorbs of the light of `{}`: for each photon {} of {} nm, on average",
            source.name,
            format_value(own.quantum_yield()),
            format_value(own.emission().mean_wavelength())
        );
        let hint = format!(
            "let absorption_per_mm end in 0 near {} nm, or lower quantum_yield",
            format_value(limit(own))
        );
        problems.error(&Key::of(&["media", name, "fluorescence"]), message).hint(hint);
    }
}

/// The wavelength from which on absorbed photons have less energy than those emitted for them, nm.
fn limit(own: &Fluorescence) -> f64 {
    own.emission().mean_wavelength() / own.quantum_yield()
}

/// Mean wavelength of the power that fluorescence absorbs of a thin ray of some light, nm; not a number if it absorbs none.
fn absorbed_wavelength(light: &Spectrum, own: &Fluorescence) -> f64 {
    let absorbed = |nm: f64| own.absorption_law().at(nm);
    light.integral(|nm| nm * absorbed(nm)) / light.integral(absorbed)
}
