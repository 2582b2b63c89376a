//! Reference values that a function of the library gives without noise, met to 1e-6.

use crate::run::scene_file;
use glam::DVec3;
use lumiduct_baselines::sppm_area_ratio;
use lumiduct_core::optics::fresnel::{
    Polarised, brewster_angle, conductor, critical_angle, dielectric,
};
use lumiduct_core::transport::{Track, TrackEnd, tracks};
use lumiduct_input::{self as input, Job, Settings};
use std::f64::consts::FRAC_PI_6;

/// Largest relative deviation.
pub(crate) const LIMIT: f64 = 1e-6;

/// Index of PMMA in the reference.
const PMMA: f64 = 1.49;
/// Evaporated aluminium at 550 nm: `McPeak` et al., ACS Photonics 2 (2015) 326, n and k.
const ALUMINIUM: [f64; 2] = [0.789405353, 5.851936501];
/// Thickness of the plate that shifts a beam, mm.
const PLATE_MM: f64 = 20.0;
/// Length of the rod in which the path length of a ray is measured, mm.
const ROD_MM: f64 = 10.0;
/// The scene of the prism, of any spectrum.
const PRISM: &str = "../dispersion_prism";
/// Paths that are searched for one that passes straight through.
const TRACKS: usize = 100;

/// A value of a function and that of the reference.
#[derive(Debug)]
pub(crate) struct Computed {
    pub(crate) case: &'static str,
    pub(crate) name: String,
    pub(crate) expected: f64,
    pub(crate) ours: f64,
}

impl Computed {
    /// Deviation over value.
    pub(crate) fn deviation(&self) -> f64 {
        self.ours / self.expected - 1.0
    }
}

/// All of them.
pub(crate) fn computed() -> Vec<Computed> {
    let mut all = interface();
    all.extend(metal());
    all.extend(shift());
    all.push(way());
    all.extend(schedule());
    all.extend(prism());
    all
}

/// FR-01: an interface of air and PMMA from both sides.
fn interface() -> Vec<Computed> {
    let value =
        |name: &str, expected, ours| Computed { case: "FR-01", name: name.into(), expected, ours };
    let outside = |degrees: f64| dielectric(degrees.to_radians().cos(), 1.0, PMMA);
    let inside = |degrees: f64| dielectric(degrees.to_radians().cos(), PMMA, 1.0);
    let critical = critical_angle(PMMA, 1.0).expect("PMMA is denser than air").to_degrees();
    let mut all = both("FR-01", "", 0.0, outside(0.0), [0.03872518185, 0.03872518185]);
    all.extend(both("FR-01", "", 30.0, outside(30.0), [0.05610120626, 0.02435129838]));
    all.extend(both("FR-01", "", 60.0, outside(60.0), [0.1730980056, 0.001944938051]));
    all.extend(both("FR-01", "", 75.0, outside(75.0), [0.3949937123, 0.1073188617]));
    all.extend(both("FR-01", "", 85.0, outside(85.0), [0.729578074, 0.4937329602]));
    all.push(value("Brewster", 56.13282089, brewster_angle(1.0, PMMA).to_degrees()));
    all.push(value("critical", 42.15518425, critical));
    all.extend(both("FR-01", "_inside", 40.0, inside(40.0), [0.356998354, 0.07984100068]));
    all.push(value("R_inside(43)", 1.0, inside(43.0).unpolarised()));
    all
}

/// FR-08: a metal mirror.
fn metal() -> Vec<Computed> {
    let [n, k] = ALUMINIUM;
    [
        (0.0, [0.9156778846, 0.9156778846]),
        (45.0, [0.940016689, 0.8836313756]),
        (60.0, [0.9573467775, 0.8457037939]),
        (75.0, [0.977744248, 0.7757706775]),
        (85.0, [0.9924556002, 0.8004005682]),
    ]
    .into_iter()
    .flat_map(|(degrees, expected): (f64, _)| {
        both("FR-08", "", degrees, conductor(degrees.to_radians().cos(), 1.0, n, k), expected)
    })
    .collect()
}

/// Reflectances for s and p.
fn both(
    case: &'static str,
    what: &str,
    degrees: f64,
    ours: Polarised,
    [s, p]: [f64; 2],
) -> Vec<Computed> {
    vec![
        Computed { case, name: format!("Rs{what}({degrees})"), expected: s, ours: ours.s },
        Computed { case, name: format!("Rp{what}({degrees})"), expected: p, ours: ours.p },
    ]
}

/// FR-06: how far a plate shifts a beam, seen on a traced path.
fn shift() -> Vec<Computed> {
    [(30.0, 3.829981074), (45.0, 6.517428752), (60.0, 10.17789387)]
        .into_iter()
        .map(|(degrees, expected)| {
            let overrides = [
                format!("sources.led.disk.tilt_deg={degrees}"),
                format!("solids.plate.box.size_mm=[2000, 2000, {PLATE_MM}]"),
            ];
            // Start, entry, exit and a point behind: not reflected at either face.
            let straight = track("fr_02", &overrides, |track| track.points.len() == 4);
            let [start, entry, exit] = [0, 1, 2].map(|point| straight.points[point]);
            let ours = (exit - start).cross((entry - start).normalize()).length();
            Computed { case: "FR-06", name: format!("shift({degrees})"), expected, ours }
        })
        .collect()
}

/// FR-07: indices of N-BK7, and how far a prism of 60 degrees turns light, seen on traced paths.
fn prism() -> Vec<Computed> {
    [
        ("C", 656.2725, [1.514322347, 38.4291367, 38.42983932]),
        ("d", 587.5618, [1.516800035, 38.64669851, 38.64830707]),
        ("F", 486.1327, [1.52237629, 39.13810874, 39.14318266]),
    ]
    .into_iter()
    .flat_map(|(line, nm, [index, least, at_49]): (_, f64, [f64; 3])| {
        let spectrum = format!("sources.beam.disk.spectrum={{line_nm={nm}}}");
        let job = job(PRISM, std::slice::from_ref(&spectrum));
        let glass = job.scene.media.iter().find(|medium| medium.name() == "bk7");
        let found = glass.expect("the scene has it").index(nm);
        let turned = |incidence: f64| {
            let (y, x) = (incidence - FRAC_PI_6).sin_cos();
            let axis = format!("sources.beam.disk.at.axis=[{x}, {y}, 0]");
            // Start, entry, exit and a point behind.
            let overrides = [spectrum.clone(), axis];
            let straight = track(PRISM, &overrides, |track| track.points.len() == 4);
            let [first, last] =
                [0, 2].map(|at| (straight.points[at + 1] - straight.points[at]).normalize());
            first.angle_between(last).to_degrees()
        };
        // Light parallel to the base turns least.
        let symmetric = (found * FRAC_PI_6.sin()).asin();
        [
            (format!("n_{line}"), index, found),
            (format!("dmin_{line}"), least, turned(symmetric)),
            (format!("dev49_{line}"), at_49, turned(49.0_f64.to_radians())),
        ]
    })
    .map(|(name, expected, ours)| Computed { case: "FR-07", name, expected, ours })
    .collect()
}

/// SR-02: the path length of a ray through a rod over the rod's length.
fn way() -> Computed {
    let track = track("sr_02", &["sources.led.face.tilt_deg=40".to_owned()], |track| {
        track.points.iter().any(|point| is_at_exit(*point))
    });
    let exit = track.points.iter().position(|point| is_at_exit(*point)).expect("it was chosen");
    let way: f64 = track.points[..=exit].windows(2).map(|ends| ends[0].distance(ends[1])).sum();
    Computed { case: "SR-02", name: "path/L(40)".into(), expected: 1.108450528, ours: way / ROD_MM }
}

/// ES-03: the radii of progressive photon mapping, as the baseline has them.
fn schedule() -> Vec<Computed> {
    [
        ("2/3", 2.0 / 3.0, [0.5085158403, 0.2383887855, 0.11076091]),
        ("0.7", 0.7, [0.5458591632, 0.2761550889, 0.1385361635]),
    ]
    .into_iter()
    .flat_map(|(name, alpha, expected)| {
        // The reference counts passes from 1.
        [10, 100, 1000].into_iter().zip(expected).map(move |(n, expected)| Computed {
            case: "ES-03",
            name: format!("r2(N={n},alpha={name})"),
            expected,
            ours: sppm_area_ratio(n - 1, alpha),
        })
    })
    .collect()
}

/// The exit of the rod is normal to z; 1e-9 of its length for rounding.
fn is_at_exit(point: DVec3) -> bool {
    (point.z - ROD_MM).abs() < 1e-9 * ROD_MM
}

/// The first path of a scene that escapes as wanted.
fn track(scene: &str, overrides: &[String], wanted: impl Fn(&Track) -> bool) -> Track {
    let job = job(scene, overrides);
    tracks(&job.scene, job.run.seed, job.run.bounce_limit, TRACKS)
        .into_iter()
        .find(|track| track.end == TrackEnd::Escaped && wanted(track))
        .expect("one of many paths goes straight through")
}

/// A scene with overrides.
fn job(scene: &str, overrides: &[String]) -> Job {
    let settings = Settings { overrides: overrides.to_vec(), ..Settings::default() };
    match input::load(&scene_file(scene), &settings) {
        Ok(job) => job,
        Err(error) => panic!("{error}"),
    }
}
