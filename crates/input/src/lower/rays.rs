//! Rays from files: read, placed, and made sources; and rays of sensors for files.

use crate::export::RayExport;
use crate::keys::Key;
use crate::lower::context::Context;
use crate::lower::place::Facing;
use crate::lower::sources::PlacedSource;
use crate::spec::rays::{RayExportFormat, RaysSpec};
use crate::spec::sensor::SensorSpec;
use glam::Vec3;
use lumiduct_base::number::{format_percent, format_value};
use lumiduct_base::units::FluxUnit;
use lumiduct_core::scene::{
    Emission, EmittedRay, Emitter, FitQuality, FittedLight, NoFit, RaySet, SensorId,
};
use lumiduct_files::rays::{RayFormat, RaySample, RaySetInfo, sample};
use std::sync::Arc;

/// Rays that are kept unless the scene says how many.
const MAX_RAYS: usize = 10_000_000;
/// Rays in a file that is written, unless the scene says how many.
const EXPORTED_RAYS: usize = 100_000;
/// Share of the flux that a fit may leave out, 1.
const MOST_LEFT_OUT: f64 = 0.02;
/// How light that does not cross the plane of a fit may be kept.
const OTHER_HEIGHT: &str =
    "give another height with `fitted_at_mm`, or use the rays themselves: fitted = false";
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
        if !spec.fitted && spec.fitted_at_mm.is_some() {
            let message = "applies only with fitted = true";
            return self.refuse(&key.field("fitted_at_mm"), message, "add it, or remove this key");
        }
        // A dark source has no light to fit.
        let (emitter, flux) = if spec.fitted && spec.enabled && flux > 0.0 {
            let light = self.fit(&rays, spec, &key.field("fitted"))?;
            let share = 1.0 - light.quality().left_out;
            (Emitter::fitted(Arc::new(light), frame?), flux * share)
        } else {
            (Emitter::rays(Arc::new(rays), frame?), flux)
        };
        let placed = PlacedSource {
            name,
            enabled: spec.enabled,
            flux,
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

    /// The luminance fitted to rays; problems and its errors are noted at `key`.
    fn fit(&mut self, rays: &RaySet, spec: &RaysSpec, key: &Key) -> Option<FittedLight> {
        let file = &spec.file;
        let light = match FittedLight::new(rays, spec.fitted_at_mm) {
            Ok(light) => light,
            Err(reason) => {
                let (message, hint) = reason_without_fit(reason);
                return self.refuse(key, format!("`{file}`: {message}"), hint);
            }
        };
        let FitQuality { trees, leaves, sampling, variation: [place, direction], left_out, .. } =
            *light.quality();
        let [sampling, place, direction, out] =
            [sampling, place, direction, left_out].map(format_percent);
        let height = format_value(light.middle().z);
        if left_out > MOST_LEFT_OUT {
            let message = format!(
                "`{file}`: {out} of the flux crosses z = {height} mm outside the area where the rays start, or not at all"
            );
            return self.refuse(key, message, OTHER_HEIGHT);
        }
        let message = format!(
            "luminance on the plane z = {height} mm was fitted to `{file}` as the mean of {trees} piecewise constant densities of about {leaves} cells each. \
             Within one cell, the sampling error is {sampling} (root mean square); luminance varies by {place} with position and {direction} \
             with direction, which the fit averages out. Means over many cells are more accurate"
        );
        self.problems.warning(key, message).hint("a file with more rays reduces these errors");
        if left_out > 0.0 {
            let message = format!(
                "{out} of the flux of `{file}` crosses z = {height} mm outside the area where the rays start, or not at all; the source is without it"
            );
            self.problems.warning(key, message).hint(OTHER_HEIGHT);
        }
        Some(light)
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
                "`{}`: {used} of its {all} rays, drawn at random, are used and carry the flux of all",
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
        if let Some(flux) = self.given_flux([spec.flux_lm, spec.flux_w], key) {
            return flux;
        }
        let efficacy = self.spectrum.as_ref().map(|own| own.spectrum().efficacy());
        let luminous = match info.unit {
            FluxUnit::Lumen => Some(info.flux),
            FluxUnit::Watt => info.luminous_flux_lm.or(efficacy.map(|one| one * info.flux)),
        };
        let Some(flux) = luminous else {
            let flux = format_value(info.flux);
            let message = format!("`{}` has radiant flux only, {flux} W", spec.file);
            let hint =
                format!("give `flux_lm` or a `spectrum`; or, for a scene in W, flux_w = {flux}");
            return self.refuse(&key.field("file"), message, hint);
        };
        self.carried([flux, flux], &key.field("file"))
    }
}

/// Why rays have no fit, and what to do.
fn reason_without_fit(reason: NoFit) -> (String, &'static str) {
    const NO_FIT: &str = "use the rays themselves: fitted = false";
    match reason {
        NoFit::TooFew(rays) => {
            let found = format_value(rays);
            (
                format!("a fit needs at least 100 rays, as an effective number, found {found}"),
                NO_FIT,
            )
        }
        NoFit::Parallel => {
            let message = "the rays are parallel, so they have no waist";
            (message.to_owned(), "give the height of the plane with `fitted_at_mm`")
        }
        NoFit::NoneNear(height) => {
            let height = format_value(height);
            (
                format!("no ray crosses z = {height} mm in the area where the rays start"),
                OTHER_HEIGHT,
            )
        }
        NoFit::NoArea => {
            let message =
                "the rays cross the plane in one point or on one line, which has no luminance";
            (message.to_owned(), NO_FIT)
        }
    }
}
