//! Keys of a source that fit its kind and its emission.

use crate::input::check::Scene;
use crate::input::keys::Key;
use crate::input::problems::Problems;
use crate::input::spec::source::{BodySpec, EmissionSpec, SourceCommonSpec, SourceSpec};

pub(crate) fn check(scene: Scene<'_>, problems: &mut Problems) {
    for (name, source) in &scene.spec.sources {
        let key = Key::of(&["sources", name, source.kind()]);
        check_amount(&key, source, problems);
        check_direction(&key, source.common(), problems);
        check_place(&key, source, problems);
    }
    check_units(scene, problems);
}

/// What a kind of source emits from.
#[derive(Clone, Copy, PartialEq)]
enum Extent {
    Point,
    Line,
    Area,
    Face,
    Volume,
}

fn extent(source: &SourceSpec) -> Extent {
    match source {
        SourceSpec::Point(_) => Extent::Point,
        SourceSpec::Line(_) => Extent::Line,
        SourceSpec::Disk(_)
        | SourceSpec::Rectangle(_)
        | SourceSpec::Sphere(_)
        | SourceSpec::Cylinder(_) => Extent::Area,
        SourceSpec::Face(_) => Extent::Face,
        SourceSpec::Volume(_) => Extent::Volume,
    }
}

fn check_amount(key: &Key, source: &SourceSpec, problems: &mut Problems) {
    let (common, extent) = (source.common(), extent(source));
    if common.luminance_cd_m2.is_some() && extent != Extent::Area && extent != Extent::Face {
        let message = format!("a {} has no area and so no luminance", source.kind());
        problems.error(&key.field("luminance_cd_m2"), message).hint("give `flux_lm`");
    }
    if common.intensity_cd.is_some() && extent != Extent::Point {
        let message = format!("is for a `point` only, found with `{}`", source.kind());
        problems.error(&key.field("intensity_cd"), message).hint("give `flux_lm`");
    }
}

fn check_direction(key: &Key, common: &SourceCommonSpec, problems: &mut Problems) {
    let is_directed = match common.emission {
        Some(EmissionSpec::Collimated | EmissionSpec::ConeHalfAngleDeg(_)) => true,
        Some(EmissionSpec::Lambertian | EmissionSpec::Isotropic | EmissionSpec::CosinePower(_))
        | None => false,
    };
    if !is_directed && common.tilt_deg != 0.0 {
        let message = "only a collimated beam or a cone can be tilted";
        problems.error(&key.field("tilt_deg"), message).hint("turn the source itself with `at`");
    }
}

fn check_place(key: &Key, source: &SourceSpec, problems: &mut Problems) {
    let (common, extent) = (source.common(), extent(source));
    let is_in_place = extent == Extent::Face || extent == Extent::Volume;
    if is_in_place && common.at.is_some() {
        problems
            .error(&key.field("at"), format!("a {} is where its solid is", source.kind()))
            .hint("remove `at`");
    }
    if common.body != BodySpec::Transparent && extent != Extent::Area {
        let message = format!("a {} has no body of its own that light could meet", source.kind());
        problems.error(&key.field("body"), message).hint("remove `body`");
    }
    if extent == Extent::Volume
        && let Some(EmissionSpec::Lambertian | EmissionSpec::CosinePower(_)) = common.emission
    {
        let message = "a volume has no normal that light could be spread about";
        problems.error(&key.field("emission"), message).hint("give \"isotropic\"");
    }
}

/// Light in lm and light in W cannot be added without spectra.
fn check_units(scene: Scene<'_>, problems: &mut Problems) {
    let sources = || scene.spec.sources.iter();
    let luminous = sources().find(|(_, source)| source.common().flux_w.is_none());
    let Some((luminous, _)) = luminous else { return };
    for (name, source) in sources().filter(|(_, source)| source.common().flux_w.is_some()) {
        let key = Key::of(&["sources", name, source.kind(), "flux_w"]);
        let message =
            format!("a scene has sources in W or in lm, not both; `sources.{luminous}` is in lm");
        problems.error(&key, message);
    }
}
