//! Luminaires from files: read, placed, and made sources.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::lower::place::Facing;
use crate::lower::sources::PlacedSource;
use crate::spec::luminaire::{LuminaireExtent, LuminaireSpec};
use lumiduct_base::math::Frame;
use lumiduct_base::number::{format_exact, format_percent};
use lumiduct_core::scene::shape::{Flat, Region, Shape};
use lumiduct_core::scene::{Emission, EmitSide, Emitter, MeasuredEmission};
use lumiduct_files::luminaire::{self, Intensities, Luminaire, Opening, ReadLuminaire};
use std::sync::Arc;

/// Angle γ up to which a flat opening emits, deg.
const HORIZON: f64 = 90.0;
/// Share of the light above the horizon that is no more than rounding, 1.
const NO_LIGHT: f64 = 1e-6;

impl Context<'_> {
    pub(super) fn lower_luminaire(
        &mut self,
        name: &str,
        spec: &LuminaireSpec,
        key: &Key,
    ) -> Option<()> {
        let frame = self.place(spec.at.as_ref(), key, Facing::Toward);
        let luminaire = self.read_luminaire(spec, &key.field("file"));
        self.may_build(key)?;
        let ReadLuminaire { luminaire, table_line, .. } = luminaire?;
        let Luminaire { opening, intensities, .. } = luminaire;
        let (emitter, highest) = self.luminous_extent(spec, &opening, frame?, key);
        self.check_upward_light(&intensities, highest, key)?;
        let Some(table) = table(&intensities, highest) else {
            let message = format!(
                "`{}`: line {table_line}: the table from here on emits no light",
                spec.file
            );
            return self.refuse(&key.field("file"), message, "give a file with intensities");
        };
        let flux = match spec.flux_lm {
            Some(flux) => self.carried([flux, flux], &key.field("flux_lm"))?,
            None => {
                let flux = intensities.flux_between(0.0, highest);
                self.carried([flux, flux], &key.field("file"))?
            }
        };
        let placed = PlacedSource {
            name,
            enabled: spec.enabled,
            flux,
            emitter,
            emission: Emission::Measured(Arc::new(table)),
            on: Vec::new(),
            contact: spec.contact,
            group: spec.group.as_ref(),
        };
        self.add_placed(placed, key);
        Some(())
    }

    /// Reads the file; problems and remarks are noted at its key.
    fn read_luminaire(&mut self, spec: &LuminaireSpec, key: &Key) -> Option<ReadLuminaire> {
        self.may_build(key)?;
        let path = self.places.folder(key).join(&spec.file);
        match luminaire::read(&path) {
            Ok(read) => {
                for remark in &read.remarks {
                    self.problems.warning(key, format!("`{}`: {remark}", spec.file));
                }
                self.add_to_hash(&read.luminaire);
                Some(read)
            }
            Err(error) => {
                self.problems.error(key, format!("`{}`: {error}", spec.file));
                None
            }
        }
    }

    /// The hash of the scene contains what is used of the file.
    fn add_to_hash(&mut self, luminaire: &Luminaire) {
        let Luminaire { opening, intensities, .. } = luminaire;
        let &Opening { is_round, along_c0_mm, along_c90_mm, height_mm } = opening;
        let sizes = [along_c0_mm, along_c90_mm, height_mm, f64::from(u8::from(is_round))];
        let planes = intensities.circle();
        let angles = intensities.angles_deg();
        let values = planes
            .iter()
            .flat_map(|plane| angles.iter().map(|angle| intensities.at(*plane, *angle)));
        let all = sizes.into_iter().chain(planes.iter().copied()).chain(angles.iter().copied());
        all.chain(values).for_each(|number| self.meshes.add(&number.to_le_bytes()));
    }

    /// Where its light starts, and up to which angle γ, deg.
    fn luminous_extent(
        &mut self,
        spec: &LuminaireSpec,
        opening: &Opening,
        frame: Frame,
        key: &Key,
    ) -> (Emitter, f64) {
        let &Opening { is_round, along_c0_mm, along_c90_mm, height_mm } = opening;
        let has_area = along_c0_mm > 0.0 && along_c90_mm > 0.0;
        let is_upright = !has_area && (along_c0_mm > 0.0 || along_c90_mm > 0.0);
        if spec.extent == LuminaireExtent::Opening && is_upright {
            let message = "its opening is a line or stands upright; its light is taken to start at the middle";
            self.problems.warning(&key.field("file"), message).hint("give extent = \"point\"");
        }
        if spec.extent == LuminaireExtent::Point || !has_area {
            return (Emitter::Point(frame), 2.0 * HORIZON);
        }
        if height_mm > 0.0 {
            let height = format_exact(height_mm);
            let message = format!("its opening is {height} mm high and is taken as flat");
            self.problems.warning(&key.field("file"), message);
        }
        let (half_x, half_y) = (0.5 * along_c0_mm, 0.5 * along_c90_mm);
        let region = match is_round {
            true if half_x == half_y => Region::Annulus { inner: 0.0, outer: half_x },
            true => Region::Ellipse { half_x, half_y },
            false => Region::Rectangle { half_x, half_y },
        };
        let shape = Shape::Flat(Flat::new(frame, region));
        (Emitter::surface(vec![shape], EmitSide::Front, Some(frame)), HORIZON)
    }

    /// Refuses light that the extent cannot emit.
    fn check_upward_light(
        &mut self,
        intensities: &Intensities,
        highest: f64,
        key: &Key,
    ) -> Option<()> {
        let lost = intensities.flux_between(highest, 2.0 * HORIZON) / intensities.flux();
        if lost > NO_LIGHT {
            let share = format_percent(lost);
            let message = format!(
                "the luminaire sends {share} of its light above 90 deg, and its opening is flat"
            );
            return self.refuse(&key.field("file"), message, "give extent = \"point\"");
        }
        Some(())
    }
}

/// The distribution up to an angle γ in degrees; `None` without light.
fn table(intensities: &Intensities, highest: f64) -> Option<MeasuredEmission> {
    let planes = intensities.circle();
    let own = intensities.angles_deg();
    let below = own.iter().copied().filter(|angle| *angle < highest);
    let cut = own.iter().any(|angle| *angle >= highest).then_some(highest);
    let angles: Vec<f64> = below.chain(cut).collect();
    let values = planes
        .iter()
        .flat_map(|plane| angles.iter().map(|angle| intensities.at(*plane, *angle)))
        .collect();
    let radians = |degrees: &[f64]| degrees.iter().map(|angle| angle.to_radians()).collect();
    MeasuredEmission::new(radians(&planes), radians(&angles), values)
}
