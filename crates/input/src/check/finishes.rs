//! Finishes give back no more light than they get.

use crate::check::surfaces::{self, Law};
use crate::check::{Scene, references};
use crate::keys::Key;
use crate::problems::Problems;
use crate::scatter;
use crate::spec::finish::{FinishRef, FinishSpec};

/// Rounding that a sum of decimal fractions may have.
pub(super) const SUM_TOLERANCE: f64 = 1e-12;

pub(crate) fn check(scene: Scene<'_>, problems: &mut Problems) {
    for (name, finish) in &scene.spec.finishes {
        check_one(scene, &Key::of(&["finishes", name]), finish, problems);
    }
    for (key, finish) in references::finish_refs(scene) {
        if let FinishRef::Inline(finish) = finish {
            check_one(scene, &key, finish, problems);
        }
    }
}

fn check_one(scene: Scene<'_>, key: &Key, finish: &FinishSpec, problems: &mut Problems) {
    match finish {
        FinishSpec::Specular(spec) => {
            let shares = [spec.reflectance, spec.transmittance];
            check_sum(&key.field("specular"), shares, Least::Zero, problems);
        }
        FinishSpec::Lambertian(spec) => {
            let shares = [spec.reflectance, spec.transmittance];
            check_sum(&key.field("lambertian"), shares, Least::AboveZero, problems);
        }
        FinishSpec::Gaussian(spec) => {
            let shares = [spec.reflectance, spec.transmittance];
            if shares.iter().any(Option::is_some) {
                let shares = shares.map(|share| share.unwrap_or(0.0));
                check_sum(&key.field("gaussian"), shares, Least::AboveZero, problems);
            }
        }
        FinishSpec::Ggx(spec) => {
            if spec.reflectance.is_some() && spec.metal.is_some() {
                problems.error(
                    &key.field("ggx").field("metal"),
                    "facets are metal or have a reflectance, not both",
                );
            }
        }
        FinishSpec::Abg(spec) => {
            let haze = Law { key: key.field("abg"), law: scatter::abg(spec), strength: "a" };
            surfaces::check_haze(&haze, &spec.sheet, scene, problems);
        }
        FinishSpec::Harvey(spec) => {
            let haze = Law { key: key.field("harvey"), law: scatter::harvey(spec), strength: "b0" };
            surfaces::check_haze(&haze, &spec.sheet, scene, problems);
        }
        FinishSpec::Tabulated(spec) => {
            surfaces::check_tabulated(&key.field("tabulated"), spec, problems);
        }
        FinishSpec::Coated(spec) => {
            let key = key.field("coated");
            surfaces::check_angles(&key, &spec.angles_deg, problems);
            surfaces::check_values(
                &key,
                "reflectance",
                &spec.angles_deg,
                &spec.reflectance,
                problems,
            );
        }
        FinishSpec::Smooth(_)
        | FinishSpec::Metal(_)
        | FinishSpec::Absorber(_)
        | FinishSpec::Open(_)
        | FinishSpec::PrismFilm(_)
        | FinishSpec::Mixture(_) => {}
    }
}

/// The least that reflectance and transmittance may add up to.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Least {
    Zero,
    AboveZero,
}

pub(super) fn check_sum(
    key: &Key,
    [reflectance, transmittance]: [f64; 2],
    least: Least,
    problems: &mut Problems,
) {
    let sum = reflectance + transmittance;
    if sum > 1.0 + SUM_TOLERANCE {
        let message = format!(
            "reflectance {reflectance} and transmittance {transmittance} add up to {sum}, expected at most 1"
        );
        problems.error(key, message);
    }
    if sum == 0.0 && least == Least::AboveZero {
        let message = "reflectance and transmittance are both 0, expected a sum above 0";
        problems.error(key, message).hint("a finish that absorbs everything is `absorber = {}`");
    }
}
