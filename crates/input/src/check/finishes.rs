//! Finishes return no more light than they receive.

use crate::check::references;
use crate::check::scene::Scene;
use crate::check::surfaces::{self, Law, Least, check_sum};
use crate::keys::Key;
use crate::problems::Problems;
use crate::scatter;
use crate::spec::finish::{FinishRef, FinishSpec};

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
