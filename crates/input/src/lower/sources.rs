//! Sources in the scene: how their light is spread, and what keys go with which kind.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::lower::emitters::{SourceExtent, patch_range};
use crate::lower::place::Facing;
use crate::lower::spectra::is_spectral;
use crate::lower::surfaces::tilted;
use crate::lower::weathers::{Member, group};
use crate::spec::placement::ContactSpec;
use crate::spec::source::{BodySpec, EmissionSpec, SourceCommonSpec, SourceSpec};
use lumiduct_core::scene::{
    Emission, Emitter, FacePiece, FaceSpec, FinishId, Owner, PrimId, Source, StartSolids,
};

/// The keys of a source, by its kind.
struct SourceKeys<'a> {
    common: &'a SourceCommonSpec,
    extent: SourceExtent,
    kind: &'static str,
}

/// A source in its place.
pub(super) struct PlacedSource<'a> {
    pub(super) name: &'a str,
    pub(super) enabled: bool,
    /// Flux if it is enabled, lm or W.
    pub(super) flux: f64,
    pub(super) emitter: Emitter,
    pub(super) emission: Emission,
    /// The surfaces that it lies on.
    pub(super) on: Vec<PrimId>,
    pub(super) contact: Option<ContactSpec>,
    pub(super) group: Option<&'a String>,
}

impl<'a> Context<'a> {
    pub(super) fn lower_sources(&mut self) {
        self.check_units();
        self.check_names_of_emissions();
        let spec = self.spec;
        for (name, source) in &spec.sources {
            let key = Key::of(&["sources", name, source.kind()]);
            self.lower_spectrum(source.spectrum(), &key);
            if let SourceSpec::Sun(sun) = source {
                self.lower_sun(name, sun, &key);
            } else if let SourceSpec::Sky(sky) = source {
                self.lower_sky(name, sky, &key);
            } else if let SourceSpec::Luminaire(luminaire) = source {
                self.lower_luminaire(name, luminaire, &key);
            } else if let SourceSpec::Rays(rays) = source {
                self.lower_rays(name, rays, &key);
            } else {
                self.lower_source(name, source, &key);
            }
        }
    }

    /// Light in lm and light in W cannot be added without spectra.
    fn check_units(&mut self) {
        if is_spectral(self.spec) {
            return;
        }
        let sources = || self.spec.sources.iter();
        let luminous = sources().find(|(_, source)| !source.is_radiant());
        let Some((luminous, _)) = luminous else { return };
        for (name, source) in sources().filter(|(_, source)| source.is_radiant()) {
            let key = Key::of(&["sources", name, source.kind(), "flux_w"]);
            let message = format!(
                "without spectra a scene has sources in W or in lm, not both; `sources.{luminous}` is in lm"
            );
            self.problems.error(&key, message);
        }
    }

    fn lower_source(&mut self, name: &str, source: &'a SourceSpec, key: &Key) -> Option<()> {
        let (common, extent) = source.common().zip(SourceExtent::of(source))?;
        let keys = SourceKeys { common, extent, kind: source.kind() };
        let amount = self.check_amount(&keys, key);
        self.check_place(&keys, key);
        let emission = self.emission(&keys, key);
        let body = self.body_finish(&common.body, &key.field("body"));
        let frame = self.place(common.at.as_ref(), key, Facing::Toward);
        let emitter = frame.and_then(|frame| self.emitter(source, frame, key));
        self.may_build(key)?;
        let (emitter, mut on) = emitter?;
        let emission = amount.and(emission)?;
        let flux = self.flux(common, &emitter, &emission, key)?;
        if let Some(finish) = body {
            on = self.add_body(name, &emitter, finish);
        }
        if common.contact == Some(ContactSpec::Air) {
            on.clear();
        }
        let &SourceCommonSpec { enabled, contact, .. } = common;
        let group = common.group.as_ref();
        let placed = PlacedSource { name, enabled, flux, emitter, emission, on, contact, group };
        self.add_placed(placed, key);
        Some(())
    }

    /// Adds a source of the scene that is no daylight.
    pub(super) fn add_placed(&mut self, placed: PlacedSource<'_>, key: &Key) {
        // Whether the solids at the start must be found for each path is decided when the scene is
        // complete.
        let start = match placed.contact {
            Some(ContactSpec::Air) => StartSolids::Behind,
            Some(ContactSpec::Optical) | None => StartSolids::Ahead,
        };
        let source = self.builder.add_source(Source {
            name: placed.name.to_owned(),
            flux: if placed.enabled { placed.flux } else { 0.0 },
            emitter: placed.emitter,
            emission: placed.emission,
            start,
            on: placed.on,
            spectrum: self.spectrum.clone(),
            elevation: None,
            sun: None,
        });
        self.members.push(Member { source, group: group(placed.group, key), daylight: None });
    }

    fn check_amount(&mut self, keys: &SourceKeys<'_>, key: &Key) -> Option<()> {
        let SourceKeys { common, extent, kind } = *keys;
        if common.luminance_cd_m2.is_some() && !extent.has_area() {
            let message = format!("a {kind} has no area and so no luminance");
            return self.refuse(&key.field("luminance_cd_m2"), message, "give `flux_lm`");
        }
        let intensity = common
            .intensity_cd
            .map(|_| "intensity_cd")
            .or(common.intensity_mcd.map(|_| "intensity_mcd"));
        if let Some(intensity) = intensity
            && extent != SourceExtent::Point
        {
            let message = format!("is for a `point` only, found with `{kind}`");
            let hint = if extent.has_area() {
                "give `flux_lm` or `luminance_cd_m2`"
            } else {
                "give `flux_lm`"
            };
            return self.refuse(&key.field(intensity), message, hint);
        }
        Some(())
    }

    fn check_place(&mut self, keys: &SourceKeys<'_>, key: &Key) {
        let SourceKeys { common, extent, kind } = *keys;
        let is_in_place = extent == SourceExtent::Face || extent == SourceExtent::Volume;
        if is_in_place && common.at.is_some() {
            let message = format!("a {kind} is where its solid is");
            self.problems.error(&key.field("at"), message).hint("remove `at`");
        }
        if common.body != BodySpec::Transparent && extent != SourceExtent::Area {
            let message = format!("a {kind} has no body that light could meet");
            self.problems.error(&key.field("body"), message).hint("remove `body`");
        }
    }

    /// The law of emission, with the axis of a tilted beam.
    fn emission(&mut self, keys: &SourceKeys<'_>, key: &Key) -> Option<Emission> {
        let SourceKeys { common, extent, .. } = *keys;
        let is_volume = extent == SourceExtent::Volume;
        let default = if is_volume { EmissionSpec::Isotropic } else { EmissionSpec::Lambertian };
        let axis = tilted(common.tilt_deg, common.azimuth_deg);
        let spec = match &common.emission {
            Some(reference) => self.emission_spec(reference, &key.field("emission"))?,
            None => default,
        };
        let emission = match spec {
            EmissionSpec::Lambertian => Emission::Lambertian,
            EmissionSpec::Isotropic => Emission::Isotropic,
            EmissionSpec::Collimated => Emission::Collimated { axis },
            EmissionSpec::CosinePower(power) => Emission::CosinePower(power),
            EmissionSpec::ViewingAngleDeg(full) => {
                // cos^m of half the angle is a half.
                Emission::CosinePower(0.5_f64.ln() / (0.5 * full).to_radians().cos().ln())
            }
            EmissionSpec::ConeHalfAngleDeg(degrees) => {
                Emission::Cone { half_angle: degrees.to_radians(), axis }
            }
        };
        let is_about_normal = matches!(emission, Emission::Lambertian | Emission::CosinePower(_));
        if is_volume && is_about_normal {
            let message = "a volume has no normal about which to emit";
            self.problems.error(&key.field("emission"), message).hint("give \"isotropic\"");
        }
        let is_directed = matches!(emission, Emission::Collimated { .. } | Emission::Cone { .. });
        let tilt = key.field("tilt_deg");
        if !is_directed && common.tilt_deg != 0.0 {
            let message = "only a collimated beam or a cone can be tilted";
            return self.refuse(&tilt, message, "turn the source itself with `at`");
        }
        if let Emission::Cone { half_angle, .. } = emission
            && extent.has_area()
        {
            let reach = half_angle.to_degrees() + common.tilt_deg;
            // Rounding of 90 degrees to radians and back.
            if reach > 90.0 + 1e-9 {
                let message = format!("the tilted cone reaches {reach} deg, below the surface");
                let hint = "keep tilt_deg plus the cone's half-angle at 90 or less";
                return self.refuse(&tilt, message, hint);
            }
        }
        Some(emission)
    }

    fn body_finish(&mut self, body: &'a BodySpec, key: &Key) -> Option<FinishId> {
        match body {
            BodySpec::Transparent => None,
            BodySpec::Absorbing => self.finishes.get("black").copied(),
            BodySpec::Finish(reference) => self.finish(reference, key),
        }
    }

    /// Makes the emitter's surfaces a sheet that light meets.
    fn add_body(&mut self, name: &str, emitter: &Emitter, finish: FinishId) -> Vec<PrimId> {
        let shapes = emitter.shapes();
        let name = format!("{name}.body");
        let face = self.builder.add_face(FaceSpec {
            name: name.clone(),
            owner: Owner::Sheet,
            front: Some(finish),
            back: Some(finish),
            pieces: shapes.iter().map(|(shape, _)| FacePiece::whole(shape.clone())).collect(),
        });
        self.faces.insert(name, vec![face]);
        patch_range(&self.builder.scene().faces[face.index()].extent).map(PrimId::new).collect()
    }
}
