//! Rays from files: read, placed, and made sources; and rays of sensors for files.

use crate::export::RayExport;
use crate::keys::Key;
use crate::lower::context::Context;
use crate::lower::place::Facing;
use crate::lower::sources::PlacedSource;
use crate::spec::rays::{RayExportFormat, RaysSpec};
use crate::spec::sensor::SensorSpec;
use glam::Vec3;
use lumiduct_base::number::format_value;
use lumiduct_base::units::FluxUnit;
use lumiduct_core::scene::{Emission, EmittedRay, Emitter, RaySet, SensorId};
use lumiduct_files::rays::{RayFormat, RaySample, RaySetInfo, sample};
use std::sync::Arc;

/// Rays that are kept unless the scene says how many.
const MAX_RAYS: usize = 10_000_000;
/// Rays in a file that is written, unless the scene says how many.
const EXPORTED_RAYS: usize = 100_000;
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
        let placed = PlacedSource {
            name,
            enabled: spec.enabled,
            flux,
            emitter: Emitter::rays(Arc::new(rays), frame?),
            // Rays have their own directions.
            emission: Emission::Isotropic,
            on: Vec::new(),
            contact: spec.contact,
            group: spec.group.as_ref(),
        };
        self.add_placed(placed, key);
        Some(())
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
