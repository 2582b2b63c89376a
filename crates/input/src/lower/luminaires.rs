//! Luminaires from files: read, placed, and made sources.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::lower::place::Facing;
use crate::lower::sources::PlacedSource;
use crate::spec::luminaire::{LuminaireExtent, LuminaireSpec};
use glam::DVec3;
use lumiduct_base::math::Frame;
use lumiduct_base::number::format_exact;
use lumiduct_core::scene::shape::{Flat, Region, Shape};
use lumiduct_core::scene::{Emission, EmitSide, Emitter, LuminousOpening, MeasuredEmission};
use lumiduct_files::luminaire::{self, Intensities, Luminaire, Opening, ReadLuminaire};
use std::sync::Arc;

/// Angles γ up to which a flat opening emits to one side and to both, deg.
const HORIZON: f64 = 90.0;
const ZENITH: f64 = 180.0;
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
        let (emitter, highest) = self.luminous_extent(spec, &luminaire, frame?, key);
        let intensities = &luminaire.intensities;
        let Some(table) = table(intensities, highest) else {
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
        luminaire: &Luminaire,
        frame: Frame,
        key: &Key,
    ) -> (Emitter, f64) {
        let &Opening { is_round, along_c0_mm, along_c90_mm, height_mm } = &luminaire.opening;
        let sizes = [along_c0_mm, along_c90_mm, height_mm];
        let extended = sizes.iter().filter(|size| **size > 0.0).count();
        if spec.extent == LuminaireExtent::Opening && extended == 1 {
            let message = "its opening is a line; its light is taken to start at the middle";
            self.problems.warning(&key.field("file"), message).hint("give extent = \"point\"");
        }
        if spec.extent == LuminaireExtent::Point || extended < 2 {
            return (Emitter::Point(frame), ZENITH);
        }
        let [half_x, half_y] = [along_c0_mm, along_c90_mm].map(|size| 0.5 * size);
        let round = if half_x == half_y {
            Region::Annulus { inner: 0.0, outer: half_x }
        } else {
            Region::Ellipse { half_x, half_y }
        };
        let is_ellipse = is_round && half_x != half_y;
        if is_ellipse && height_mm > 0.0 {
            let height = format_exact(height_mm);
            let message =
                format!("its opening is an ellipse, {height} mm high, and is taken as flat");
            self.problems.warning(&key.field("file"), message);
        }
        let is_flat = height_mm == 0.0 || is_ellipse;
        if is_flat && upward_share(&luminaire.intensities) <= NO_LIGHT {
            let region = if is_round { round } else { Region::Rectangle { half_x, half_y } };
            let shape = Shape::Flat(Flat::new(frame, region));
            return (Emitter::surface(vec![shape], EmitSide::Front, Some(frame)), HORIZON);
        }
        let opening = match is_round {
            true if is_flat => LuminousOpening::two_sided(frame, round),
            true => LuminousOpening::cylinder(frame, half_x, height_mm),
            false => LuminousOpening::cuboid(frame, DVec3::from_array(sizes)),
        };
        (Emitter::Opening(opening), ZENITH)
    }
}

/// Share of the light above the horizon, 1; 0 in darkness.
fn upward_share(intensities: &Intensities) -> f64 {
    let upward = intensities.flux_between(HORIZON, ZENITH);
    if upward > 0.0 { upward / intensities.flux() } else { 0.0 }
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
