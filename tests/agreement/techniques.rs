//! Each technique of `mis` alone, over the paths that it can find, against photons or gather paths that count the same
//! paths: F, FC, B, BC and VM of docs/method.md, eq. (30) and (31).

use crate::finishes::{tube, window};
use crate::trial::{Gathering, SIGMAS, Way, load};
use crate::volumes::block;
use lumiduct_core::plan::RunPlan;
use lumiduct_core::scene::{SensorId, SourceId};
use lumiduct_core::transport::Technique::{
    GatherPath, JoinedGatherPath, JoinedPhoton, Pair, Photon,
};
use lumiduct_core::transport::{Layout, Orders, Run, Sharing, Technique};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// What is compared: a technique, and another that counts the same paths.
const PAIRS: [[Technique; 2]; 6] = [
    [JoinedPhoton, Photon],
    [JoinedPhoton, GatherPath],
    [JoinedGatherPath, GatherPath],
    [JoinedGatherPath, Photon],
    [Pair, Photon],
    [Pair, GatherPath],
];
/// Waves of 4 passes of a run.
const WAVES: u64 = 8;
/// Share of |E0 - E1| that bias leaves in E0 at most, and its largest part of a value that passes, 1: docs/method.md.
const BIAS_SHARE: f64 = 2.0 / 3.0;
const MOST_BIAS: f64 = 0.05;

/// Light that a technique has counted: E0, its standard error, and the bias of pairs, lm.
#[derive(Debug)]
struct Counted {
    value: f64,
    error: f64,
    bias: f64,
}

/// The flux on every sensor from every source by one technique, in full, over the paths that another can find.
fn counted(text: &str, seed: u64, [counts, of]: [Technique; 2]) -> BTreeMap<String, Counted> {
    let gathering = Gathering { records: 1000, photons: 3000, ..Gathering::to_depth(1) };
    let job = load(text, Way::Merged(gathering));
    let (scene, layout) = (&job.scene, Layout::new(&job.scene));
    let mut run = Run::new(scene, &RunPlan { seed, ..job.run.clone() });
    run.share_by(Sharing::Only { counts, of });
    (0..WAVES).for_each(|_| run.next_wave());
    let mut fluxes = BTreeMap::new();
    for found in &run.findings().others {
        let orders = Orders::of(&found.stages[0].counts);
        for id in found.sensors.iter().copied() {
            for source in (0..scene.sources.len()).map(SourceId::new) {
                let slot = layout.sensor_flux(id, source);
                let [second, fourth] = [orders.second, orders.fourth].map(|one| one.scalar(slot));
                let (value, error) = (fourth.mean(), fourth.std_error());
                let bias = BIAS_SHARE * (value - second.mean()).abs();
                fluxes.insert(name(scene, id, source), Counted { value, error, bias });
            }
        }
    }
    fluxes
}

fn name(scene: &lumiduct_core::scene::Scene, sensor: SensorId, source: SourceId) -> String {
    format!("{} from {}", scene.sensors[sensor.index()].name, scene.sources[source.index()].name)
}

/// Compares all sensors; at least so many comparisons must find light.
fn each_agrees(what: &str, text: &str, lit: usize) {
    let text =
        format!("{text}far = {{ goniometer = {{ c_step_deg = 90, gamma_step_deg = 30 }} }}\n");
    let both = |[own, other]: [Technique; 2]| {
        [counted(&text, 1, [own, own]), counted(&text, 2, [other, own])]
    };
    let runs: Vec<_> = PAIRS.into_par_iter().map(both).collect();
    let (mut compared, mut failed) = (0, Vec::new());
    for (pair, [own, other]) in PAIRS.iter().zip(&runs) {
        // Gather paths from the far field meet too little to be compared. Joins alone to a sensor, or a source, within a
        // medium that scatters have infinite variance, by light that is scattered close to it.
        let by_photons = [JoinedPhoton, Photon].iter().all(|one| pair.contains(one));
        let by_records = pair.contains(&Pair);
        let is_compared = |name: &str| {
            (by_photons || !name.starts_with("far")) && (by_records || !name.starts_with("inside"))
        };
        for (name, own) in own.iter().filter(|(name, _)| is_compared(name)) {
            let other = &other[name];
            if own.value == 0.0 && other.value == 0.0 {
                continue;
            }
            let noise = own.error.hypot(other.error);
            let room = SIGMAS * noise + own.bias.min(MOST_BIAS * other.value.abs());
            let line = format!(
                "{what}, {pair:?}, {name}: {:.5} ± {:.5}, expected {:.5} ± {:.5}, off by {:+.2} sigmas, bias {:.5}",
                own.value,
                own.error,
                other.value,
                other.error,
                (own.value - other.value) / noise,
                own.bias
            );
            println!("{line}");
            compared += 1;
            if (own.value - other.value).abs() > room || !noise.is_finite() {
                failed.push(line);
            }
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
    assert!(compared >= lit, "{what}: only {compared} comparisons");
}

#[test]
fn each_alone_in_tubes() {
    each_agrees("mirror", &tube("{ specular = { reflectance = 0.9 } }"), 4);
    each_agrees("narrow", &tube("{ gaussian = { sigma_deg = 1, reflectance = 0.9 } }"), 13);
    each_agrees("broad", &tube("{ gaussian = { sigma_deg = 15, reflectance = 0.9 } }"), 13);
    each_agrees("facets", &tube("{ ggx = { roughness = 0.2, reflectance = 0.9 } }"), 13);
    each_agrees("white", &tube("{ lambertian = { reflectance = 0.8 } }"), 13);
    each_agrees(
        "mirror, narrow and broad",
        &tube(
            "{ mixture = [{ weight = 2, finish = { specular = { reflectance = 0.95 } } }, { weight = 1, finish = { gaussian = { sigma_deg = 2, reflectance = 0.9 } } }, { weight = 1, finish = { gaussian = { sigma_deg = 20, reflectance = 0.9 } } }] }",
        ),
        13,
    );
}

/// Two lamps of one spectrum and one of another, on walls that reflect them differently.
#[test]
fn each_alone_with_spectra() {
    let lamp = |name: &str, x: f64, spectrum: &str| {
        format!(
            "[sources.{name}.disk]\nradius_mm = 2\nflux_lm = 10\n{spectrum}\nat = {{ position_mm = [{x}, 0, 0.1] }}\n"
        )
    };
    let red = "spectrum = { peak = { peak_nm = 630, fwhm_nm = 18 } }";
    let others = lamp("right", 2.0, red) + &lamp("line", 0.0, "spectrum = { line_nm = 546.1 }");
    for (what, lit, reflectance) in [
        ("mirror", 12, "specular = { reflectance = { by_nm = [[500, 0.7], [600, 0.9]] } }"),
        ("white", 30, "lambertian = { reflectance = { by_nm = [[500, 0.7], [600, 0.9]] } }"),
    ] {
        let text = tube(&format!("{{ {reflectance} }}"))
            .replace("flux_lm = 10", &format!("flux_lm = 10\n{red}"))
            .replace("[sensors]", &format!("{others}[sensors]"));
        each_agrees(what, &text, lit);
    }
}

#[test]
fn each_alone_in_windows() {
    let open = "{ open = {} }";
    for (what, finish) in [
        ("diffuser", "{ lambertian = { reflectance = 0.2, transmittance = 0.6 } }"),
        (
            "haze",
            "{ abg = { a = 0.01, b = 0.02, g = 2, reflectance = 0.08, transmittance = 0.9, scatters = \"transmitted\" } }",
        ),
    ] {
        each_agrees(what, &window(finish, open), 10);
    }
}

#[test]
fn each_alone_in_media() {
    each_agrees("isotropic", &block("{ per_mm = 0.2 }"), 12);
    each_agrees("forward scattering", &block("{ per_mm = 0.6, anisotropy = 0.85 }"), 12);
}
