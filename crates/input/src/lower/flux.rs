//! The flux of a source, from the amount of light given in the file.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::lower::spectra::is_spectral;
use crate::spec::SceneSpec;
use crate::spec::source::{SourceCommonSpec, SourceSpec};
use lumiduct_base::number::format_value;
use lumiduct_base::units::{FluxUnit, per_m2_to_per_mm2};
use lumiduct_core::scene::{Emission, Emitter};

/// Least flux of a source that is not dark, lm or W: the squares of its shares in 1e9 cells are not
/// subnormal.
const LEAST_FLUX: f64 = 1e-30;
/// Largest flux of a source, lm or W: sums of squares are far from overflow.
const LARGEST_FLUX: f64 = 1e30;

/// Lumens, unless a source without a spectrum is given in watts.
pub(super) fn unit(spec: &SceneSpec) -> FluxUnit {
    let is_radiant = spec.sources.values().any(SourceSpec::is_radiant);
    if is_radiant && !is_spectral(spec) { FluxUnit::Watt } else { FluxUnit::Lumen }
}

impl Context<'_> {
    /// Flux in lm or W from whichever amount is given.
    pub(super) fn flux(
        &mut self,
        common: &SourceCommonSpec,
        emitter: &Emitter,
        law: &Emission,
        key: &Key,
    ) -> Option<f64> {
        if let Some(flux) = self.given_flux([common.flux_lm, common.flux_w], key) {
            return flux;
        }
        if let Some(luminance) = common.luminance_cd_m2 {
            let per_luminance = emitter.area().zip(law.projected_solid_angle());
            let key = key.field("luminance_cd_m2");
            let Some((area, projected)) = per_luminance else {
                let message = "needs a source with an area and a `lambertian` or cone emission";
                return self.refuse(&key, message, "give flux_lm instead");
            };
            let flux = per_m2_to_per_mm2(luminance) * area * projected;
            return self.carried([luminance, flux], &key);
        }
        let (intensity, key) = match (common.intensity_cd, common.intensity_mcd) {
            (Some(intensity), _) => (intensity, key.field("intensity_cd")),
            (None, intensity) => (1e-3 * intensity?, key.field("intensity_mcd")),
        };
        let per_intensity = emitter.point().and_then(|_| law.flux_per_peak_intensity());
        let Some(per_intensity) = per_intensity else {
            let message = "needs a `point` source that is not collimated";
            return self.refuse(&key, message, "give flux_lm instead");
        };
        self.carried([intensity, intensity * per_intensity], &key)
    }

    /// The flux by `flux_lm` or `flux_w`, if one is given; with a spectrum in lm.
    pub(super) fn given_flux(
        &mut self,
        [flux_lm, flux_w]: [Option<f64>; 2],
        key: &Key,
    ) -> Option<Option<f64>> {
        let efficacy = self.spectrum.as_ref().map_or(1.0, |own| own.spectrum().efficacy());
        let of_radiant = flux_w.map(|flux| ("flux_w", flux, efficacy * flux));
        let (name, stated, flux) = flux_lm.map(|flux| ("flux_lm", flux, flux)).or(of_radiant)?;
        Some(self.carried([stated, flux], &key.field(name)))
    }

    /// The flux, lm or W, of a given amount; an error where its squares, or sums of them, underflow
    /// or overflow.
    pub(super) fn carried(&mut self, [stated, flux]: [f64; 2], amount: &Key) -> Option<f64> {
        if stated == 0.0 || (LEAST_FLUX..=LARGEST_FLUX).contains(&flux) {
            return Some(flux);
        }
        let unit = self.builder.scene().unit.flux();
        let found = format_value(flux);
        let message = format!("makes a source of {found} {unit}, which cannot be counted");
        let hint = format!(
            "expected 0, or an amount that makes {LEAST_FLUX:e} to {LARGEST_FLUX:e} {unit}"
        );
        self.refuse(amount, message, hint)
    }
}
