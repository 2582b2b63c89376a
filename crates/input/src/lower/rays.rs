//! Rays from files: read, placed, and made sources; and rays of sensors for files.

use crate::export::RayExport;
use crate::keys::Key;
use crate::lower::context::Context;
use crate::lower::place::Facing;
use crate::lower::sources::PlacedSource;
use crate::spec::rays::{RayExportFormat, RaysSpec};
use crate::spec::sensor::SensorSpec;
use glam::Vec3;
use lumiduct_base::math::Frame;
use lumiduct_base::number::{format_percent, format_value};
use lumiduct_base::units::FluxUnit;
use lumiduct_core::scene::{
    Emission, EmittedRay, Emitter, FitQuality, FittedLight, RaySet, SensorId,
};
use lumiduct_files::rays::{RayFormat, RaySample, RaySetInfo, sample};
use std::sync::Arc;

/// Rays that are kept unless the scene says how many.
const MAX_RAYS: usize = 10_000_000;
/// Rays in a file that is written, unless the scene says how many.
const EXPORTED_RAYS: usize = 100_000;
/// Share of the flux that a fit may leave out, 1.
const MOST_LEFT_OUT: f64 = 0.02;
/// Seed of the drawing, the same for all scenes, so that designs have the same rays.
const SEED: u64 = 0;

impl Context<'_> {
    pub(super) fn lower_rays(&mut self, name: &str, spec: &RaysSpec, key: &Key) -> Option<()> {
        let frame = self.place(spec.at.as_ref(), key, Facing::Toward);
        let sample = self.read_rays(spec, &key.field("file"));
        self.may_build(key)?;
        let RaySample { rays, info, .. } = sample?;
        let flux = self.flux_of_rays(spec, &info, key)?;
        let rays = rays.iter().map(|ray| EmittedRay {
            position: Vec3::from_array(ray.position_mm),
            direction: Vec3::from_array(ray.direction),
            flux: ray.flux,
        });
        let Some(rays) = RaySet::new(rays) else {
            let message = format!("`{}` has no light in the rays that were drawn", spec.file);
            return self.refuse(&key.field("max_rays"), message, "allow more rays");
        };
        let (emitter, share) = self.ray_emitter(rays, frame?, spec, key)?;
        let placed = PlacedSource {
            name,
            enabled: spec.enabled,
            flux: flux * share,
            emitter,
            // Rays have their own directions.
            emission: Emission::Isotropic,
            on: Vec::new(),
            contact: spec.contact,
            group: spec.group.as_ref(),
        };
        self.add_placed(placed, key);
        Some(())
    }

    /// The emitter, and the share of the flux that it has, 1.
    fn ray_emitter(
        &mut self,
        rays: RaySet,
        frame: Frame,
        spec: &RaysSpec,
        key: &Key,
    ) -> Option<(Emitter, f64)> {
        if !spec.fitted {
            if spec.fitted_at_mm.is_some() {
                let message = "is for a fitted source only";
                let hint = "write fitted = true, or remove it";
                return self.refuse(&key.field("fitted_at_mm"), message, hint);
            }
            return Some((Emitter::rays(Arc::new(rays), frame), 1.0));
        }
        let key = key.field("fitted");
        let light = match FittedLight::new(&rays, spec.fitted_at_mm) {
            Ok(light) => light,
            Err(reason) => {
                let message = format!("no luminance can be fitted to `{}`: {reason}", spec.file);
                return self.refuse(&key, message, "use the rays themselves: fitted = false");
            }
        };
        let FitQuality { boxes, sampling, variation: [place, direction], left_out, .. } =
            *light.quality();
        let [sampling, place, direction, out] =
            [sampling, place, direction, left_out].map(format_percent);
        let height = format_value(light.middle().z);
        if left_out > MOST_LEFT_OUT {
            let message = format!(
                "{out} of the flux does not cross the plane z = {height} mm of the file near the starts of the rays"
            );
            let hint = "give another height with `fitted_at_mm`";
            return self.refuse(&key, message, hint);
        }
        let rest = if left_out > 0.0 {
            format!(
                " {out} of the flux crosses the plane far from the starts of the rays and is left out."
            )
        } else {
            String::new()
        };
        let message = format!(
            "luminance over the plane z = {height} mm of `{}` is the mean of 8 densities, each even in some {boxes} boxes of position and \
             direction. In one box the sampling of the rays leaves an error of {sampling}, and luminance varies by {place} over position and \
             {direction} over direction (root mean square); the mean, and light from many boxes, is more certain.{rest}",
            spec.file
        );
        self.problems.warning(&key, message).hint("more rays lower all of these");
        Some((Emitter::fitted(Arc::new(light), frame), 1.0 - left_out))
    }

    /// Reads the file; problems and remarks are noted at its key.
    fn read_rays(&mut self, spec: &RaysSpec, key: &Key) -> Option<RaySample> {
        self.may_build(key)?;
        let most = spec.max_rays.map_or(MAX_RAYS, |rays| rays as usize);
        let path = self.places.folder(key).join(&spec.file);
        let sample = match sample(&path, most, SEED) {
            Ok(sample) => sample,
            Err(error) => {
                self.problems.error(key, format!("`{}`: {error}", spec.file));
                return None;
            }
        };
        for remark in &sample.remarks {
            self.problems.warning(key, format!("`{}`: {remark}", spec.file));
        }
        let (used, all) = (sample.rays.len(), sample.info.count);
        if (used as u64) < all {
            let message = format!(
                "`{}`: {used} of its {all} rays, drawn at random, stand for all",
                spec.file
            );
            self.problems.warning(key, message).hint("allow more with `max_rays`");
        }
        // The hash of the scene contains what is used of the file.
        let fluxes = [sample.info.flux, sample.info.luminous_flux_lm.unwrap_or(0.0)];
        fluxes.iter().for_each(|flux| self.meshes.add(&flux.to_le_bytes()));
        for ray in &sample.rays {
            let numbers = ray.position_mm.into_iter().chain(ray.direction).chain([ray.flux]);
            numbers.for_each(|number| self.meshes.add(&number.to_le_bytes()));
        }
        Some(sample)
    }

    /// Notes the ray files that a sensor is to write.
    pub(super) fn lower_ray_export(
        &mut self,
        spec: &SensorSpec,
        sensor: SensorId,
        key: &Key,
    ) -> Option<()> {
        let Some(own) = &spec.rays else { return Some(()) };
        if spec.plane.is_none() && spec.goniometer.is_none() {
            let message = "is for a `plane` or a `goniometer` only";
            let hint = "remove it, or add a `plane` in the same place";
            return self.refuse(&key.field("rays"), message, hint);
        }
        let formats = own.formats.iter().map(|format| match format {
            RayExportFormat::Tm25 => RayFormat::Tm25,
            RayExportFormat::Zemax => RayFormat::Zemax,
            RayExportFormat::Csv => RayFormat::Csv,
        });
        let count = own.count.map_or(EXPORTED_RAYS, |count| count as usize);
        self.exports.rays.push(RayExport { sensor, formats: formats.collect(), count });
        Some(())
    }

    fn flux_of_rays(&mut self, spec: &RaysSpec, info: &RaySetInfo, key: &Key) -> Option<f64> {
        for (name, flux) in [("flux_lm", spec.flux_lm), ("flux_w", spec.flux_w)] {
            if let Some(flux) = flux {
                return self.carried([flux, flux], &key.field(name));
            }
        }
        let luminous = match info.unit {
            FluxUnit::Lumen => Some(info.flux),
            FluxUnit::Watt => info.luminous_flux_lm,
        };
        let Some(flux) = luminous else {
            let flux = format_value(info.flux);
            let message = format!("`{}` has radiant flux only, {flux} W", spec.file);
            let hint = format!("give `flux_lm`; or, for a scene in W, flux_w = {flux}");
            return self.refuse(&key.field("file"), message, hint);
        };
        self.carried([flux, flux], &key.field("file"))
    }
}
