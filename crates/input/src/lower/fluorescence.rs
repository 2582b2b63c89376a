//! Fluorescence of media.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::lower::laws::whole_nm;
use crate::lower::spectra::is_spectral;
use crate::spec::medium::FluorescenceSpec;
use lumiduct_base::number::format_value;
use lumiduct_core::colour::SpectralDraw;
use lumiduct_core::optics::Fluorescence;

impl Context<'_> {
    /// What a medium absorbs and emits at other wavelengths, never with more power than it absorbs.
    pub(super) fn lower_fluorescence(
        &mut self,
        spec: &FluorescenceSpec,
        key: &Key,
    ) -> Option<Fluorescence> {
        if !is_spectral(self.spec) {
            let message = "changes the wavelength of light, but no source has a `spectrum`";
            let hint =
                "give every source a spectrum, such as { peak = { peak_nm = 450, fwhm_nm = 20 } }";
            return self.refuse(key, message, hint);
        }
        let absorption =
            self.absorption_law(&spec.absorption_per_mm, &key.field("absorption_per_mm"));
        let emission = self.spectrum(&spec.emission, &key.field("emission"));
        let (absorption, emission) = (absorption?, emission?);
        let mean = emission.mean_wavelength();
        let made = Fluorescence::new(absorption, spec.quantum_yield, SpectralDraw::new(emission));
        let absorbs = |nm: &f64| made.absorption_law().at(*nm) > 0.0;
        let gains = |nm: &f64| made.power_yield(*nm) > 1.0;
        if let Some(nm) = whole_nm().filter(absorbs).find(gains) {
            let message = format!(
                "would emit more power than it absorbs at {nm} nm: {} photons of {} nm, on average, for each",
                format_value(spec.quantum_yield),
                format_value(mean)
            );
            let hint = format!(
                "let absorption_per_mm end in 0 at {} nm, or lower quantum_yield",
                format_value(mean / spec.quantum_yield)
            );
            return self.refuse(key, message, hint);
        }
        Some(made)
    }
}
