//! The keys of a source fit its kind and its emission.

use crate::check::scene::Scene;
use crate::keys::Key;
use crate::problems::Problems;
use crate::spec::source::{BodySpec, EmissionSpec, SourceCommonSpec, SourceSpec};

pub(crate) fn check(scene: Scene<'_>, problems: &mut Problems) {
    for (name, source) in &scene.spec.sources {
        let key = Key::of(&["sources", name, source.kind()]);
        if let (Some(common), Some(extent)) = (source.common(), extent(source)) {
            let kind = Kind { common, extent, name: source.kind() };
            check_amount(&key, &kind, problems);
            check_direction(&key, common, problems);
            check_place(&key, &kind, problems);
        }
    }
    check_units(scene, problems);
}

/// The extent of a kind of source.
#[derive(Clone, Copy, PartialEq)]
enum Extent {
    Point,
    Line,
    Area,
    Face,
    Volume,
}

/// The keys specific to a kind of source.
struct Kind<'a> {
    common: &'a SourceCommonSpec,
    extent: Extent,
    name: &'static str,
}

/// `None` for the sun and the sky, which emit from infinity.
fn extent(source: &SourceSpec) -> Option<Extent> {
    let extent = match source {
        SourceSpec::Point(_) => Extent::Point,
        SourceSpec::Line(_) => Extent::Line,
        SourceSpec::Disk(_)
        | SourceSpec::Rectangle(_)
        | SourceSpec::Sphere(_)
        | SourceSpec::Cylinder(_) => Extent::Area,
        SourceSpec::Face(_) => Extent::Face,
        SourceSpec::Volume(_) => Extent::Volume,
        SourceSpec::Sun(_) | SourceSpec::Sky(_) => return None,
    };
    Some(extent)
}

fn check_amount(key: &Key, kind: &Kind<'_>, problems: &mut Problems) {
    let Kind { common, extent, name } = *kind;
    if common.luminance_cd_m2.is_some() && extent != Extent::Area && extent != Extent::Face {
        let message = format!("a {name} has no area and so no luminance");
        problems.error(&key.field("luminance_cd_m2"), message).hint("give `flux_lm`");
    }
    if common.intensity_cd.is_some() && extent != Extent::Point {
        let message = format!("is for a `point` only, found with `{name}`");
        let hint = match extent {
            Extent::Area | Extent::Face => "give `flux_lm` or `luminance_cd_m2`",
            Extent::Point | Extent::Line | Extent::Volume => "give `flux_lm`",
        };
        problems.error(&key.field("intensity_cd"), message).hint(hint);
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

fn check_place(key: &Key, kind: &Kind<'_>, problems: &mut Problems) {
    let Kind { common, extent, name } = *kind;
    let is_in_place = extent == Extent::Face || extent == Extent::Volume;
    if is_in_place && common.at.is_some() {
        problems
            .error(&key.field("at"), format!("a {name} is where its solid is"))
            .hint("remove `at`");
    }
    if common.body != BodySpec::Transparent && extent != Extent::Area {
        let message = format!("a {name} has no body of its own that light could meet");
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
    let is_radiant = |source: &SourceSpec| source.common().is_some_and(|c| c.flux_w.is_some());
    let luminous = sources().find(|(_, source)| !is_radiant(source));
    let Some((luminous, _)) = luminous else { return };
    for (name, source) in sources().filter(|(_, source)| is_radiant(source)) {
        let key = Key::of(&["sources", name, source.kind(), "flux_w"]);
        let message =
            format!("a scene has sources in W or in lm, not both; `sources.{luminous}` is in lm");
        problems.error(&key, message);
    }
}
