//! Optimisations against what is known in closed form, and how they end.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, and so do its helpers")]

use lumiduct::optimise::{FinishedOptimisation, OptimisationOptions, run_optimisation};
use lumiduct::study::OnExisting;
use lumiduct_core::transport::Interrupt;
use lumiduct_input::StudySettings;
use lumiduct_report::optimise::Ending;
use std::fs;
use tempfile::TempDir;

/// EX-01: a perfect mirror duct, closed by a perfect mirror, with holes of 0.2 % of its section in each of four zones.
const LOSSLESS: &str = r#"
lumiduct = 1
title = "Small holes in a perfect mirror duct"
[finishes]
mirror = { specular = { reflectance = 1 } }
[sheets.duct.tube]
profile = { rectangle = { width_mm = 10, height_mm = 10 } }
path = [{ straight_mm = 40 }]
finish = "mirror"
[patterns.holes]
on = "duct.wall_plus_x"
finish = "open"
element = { circle = { diameter_mm = 0.5 } }
layout = { row = { positions_mm = [5, 15, 25, 35] } }
[sheets.cover.rectangle]
width_mm = 10
height_mm = 10
finish = "mirror"
at = { face = "duct.exit" }
[sources.led.face]
of = "duct.entry"
side = "back"
flux_lm = 1000
[sensors]
wall = { plane = { cells = [1, 4] }, on = "duct.wall_plus_x", counts = "leaving", side = "front" }
"#;

/// EX-02: a tube of 50 mm diameter and reflectance 0.98 with a dark end, and three small holes, each in a zone of its own.
const LOSSY: &str = r#"
lumiduct = 1
title = "Small holes along a lossy mirror tube"
[finishes.mirror]
specular = { reflectance = 0.98 }
[sheets.duct.tube]
profile = { circle = { radius_mm = 25 } }
path = [{ straight_mm = 500 }]
finish = "mirror"
[patterns.holes]
on = "duct.wall"
finish = "open"
element = { circle = { diameter_mm = 4 } }
layout = { row = { positions_mm = [50, 200, 400], around_deg = 270 } }
[sources.led.disk]
radius_mm = 25
at = { face = "duct.entry" }
flux_lm = 1000
[sensors]
wall = { plane = { cells = [1, 3] }, on = "duct.wall", counts = "leaving", side = "front" }
"#;

fn study(paths: u64, keys: &str) -> String {
    format!(
        "lumiduct_study = 1\ntitle = \"Holes\"\nscene = \"scene.toml\"\n[run]\npaths = {paths}\nseed = 3\nestimator = \"forward\"\n\
         [optimise.pattern_feedback]\npattern = \"holes\"\nvary = \"diameter\"\nsensor = \"wall\"\ncheck_estimator = \"forward\"\n{keys}\n"
    )
}

fn place(scene: &str, study: &str) -> TempDir {
    let place = tempfile::tempdir().unwrap();
    fs::write(place.path().join("scene.toml"), scene).unwrap();
    fs::write(place.path().join("study.toml"), study).unwrap();
    place
}

fn run(place: &TempDir, folder: &str, existing: OnExisting) -> FinishedOptimisation {
    let options = OptimisationOptions {
        settings: StudySettings::default(),
        dir: Some(place.path().join(folder)),
        existing,
    };
    let path = place.path().join("study.toml");
    run_optimisation(&path, &options, &Interrupt::default(), &|_| {})
        .unwrap_or_else(|e| panic!("{e}"))
}

fn found(scene: &str, study: &str) -> FinishedOptimisation {
    run(&place(scene, study), "out", OnExisting::Keep)
}

fn diameters(found: &FinishedOptimisation) -> Vec<f64> {
    found.report.elements.iter().map(|own| own.length_mm).collect()
}

/// In a duct without loss every hole that is small enough shows the luminance of the source from all directions, once directly and once
/// by the mirror: its flux is pi L A (1 + 1)/2 wherever it is (reference case EX-01). So equal holes give equal light, and what the zones
/// differ is noise: 14 % of few paths, 4 % of all.
#[test]
fn a_lossless_duct_needs_no_correction() {
    for seed in 1..=4 {
        let keys = "limits = { from_mm = 0.2, to_mm = 0.9 }\nmin_over_max = 0.9";
        let study = study(400_000, keys).replace("seed = 3", &format!("seed = {seed}"));
        let after = diameters(&found(LOSSLESS, &study));
        for diameter in &after {
            assert!((diameter / 0.5 - 1.0).abs() < 0.01, "seed {seed}: {after:?}");
        }
    }
}

#[test]
fn the_light_of_a_lossless_duct_is_confirmed_to_be_even() {
    let keys = "limits = { from_mm = 0.2, to_mm = 0.9 }\nmin_over_max = 0.93";
    let report = found(LOSSLESS, &study(1_200_000, keys)).report;
    assert_eq!(report.ending, Ending::Reached, "{:?}", report.steps);
    assert!(report.steps.iter().all(|own| own.measured.values == [0.5; 4]), "{:?}", report.steps);
}

/// The flux of a small hole is the illuminance of the wall times its area, so equal light needs d ∝ E^(-1/2). The fluxes of
/// equal holes at 50, 200 and 400 mm are those of reference case EX-02, 0.04338667763, 0.03391713481 and 0.02670282502 lm.
#[test]
fn holes_of_a_lossy_tube_follow_from_the_illuminance_of_its_wall() {
    let found = found(
        LOSSY,
        &study(9_600_000, "limits = { from_mm = 2, to_mm = 8 }\nmin_over_max = 0.96\ndamping = 1"),
    );
    assert_eq!(found.report.ending, Ending::Reached, "{:?}", found.report.steps);
    let flux = [0.043_386_677_63_f64, 0.033_917_134_81, 0.026_702_825_02];
    let expected = flux.map(|flux| flux.powf(-0.5));
    let after = diameters(&found);
    // Sizes are known but for a common factor.
    let log_mean = |sizes: &[f64]| sizes.iter().map(|own| own.ln()).sum::<f64>() / 3.0;
    let factor = (log_mean(&after) - log_mean(&expected)).exp();
    for (found, expected) in after.iter().zip(expected) {
        let off = found / (factor * expected) - 1.0;
        assert!(off.abs() < 0.01, "{after:?}: {off}");
    }
}

/// A flat mirror duct, as a plate in total reflection. By both signs of its components across, light meets the walls evenly at all places.
const FLAT: &str = r#"
lumiduct = 1
title = "A flat duct lit along one edge"
[finishes]
mirror = { specular = { reflectance = 0.98 } }
[sheets]
plate = { tube = { profile = { rectangle = { width_mm = 24, height_mm = 2 } }, path = [{ straight_mm = 80 }], finish = "mirror" } }
[patterns.holes]
on = "plate.wall_minus_y"
finish = "open"
element = { circle = { diameter_mm = 0.3 } }
layout = { grid = { across_pitch_mm = 2, pitch_mm = 2.5 } }
[sources]
SOURCES
[sensors]
wall = { plane = { cells = [1, 8] }, on = "plate.wall_minus_y", counts = "leaving", side = "front" }
"#;

/// Light falls as exp(-κ z) along such a duct, with κ the number of bounces per length times -ln ρ. From one meeting with the wall of the holes to the next
/// it shifts by 2.31 mm across and 6.13 mm along, so that no hole takes light that another would let out, and equal light needs areas ∝ exp(κ z).
#[test]
fn holes_of_an_edge_lit_slab_follow_from_the_law_of_extraction() {
    let [tilt, azimuth] = [37_f64, 60.0_f64];
    let source = |turned: f64| {
        format!(
            "led_{turned} = {{ face = {{ of = \"plate.entry\", side = \"back\", flux_lm = 250, emission = \"collimated\", \
             tilt_deg = {tilt}, azimuth_deg = {turned} }} }}\n"
        )
    };
    let sources = [azimuth, 180.0 - azimuth, 180.0 + azimuth, 360.0 - azimuth].map(source).concat();
    let keys = "limits = { from_mm = 0.1, to_mm = 0.8 }\nmin_over_max = 0.96\ndamping = 1";
    let report = found(&FLAT.replace("SOURCES", &sources), &study(600_000, keys)).report;
    assert_eq!(report.ending, Ending::Reached, "{:?}", report.steps);
    let (sin, cos) = azimuth.to_radians().sin_cos();
    let kappa = -tilt.to_radians().tan() * (cos / 24.0 + sin / 2.0) * 0.98_f64.ln();
    // Beyond the middles of the first and the last zone, sizes stay the same; areas are known but for a common factor.
    let inner = report.elements.iter().filter(|own| (5.0..75.0).contains(&own.along_mm));
    let logs: Vec<f64> = inner.map(|own| own.length_mm.ln() - 0.5 * kappa * own.along_mm).collect();
    let mean = logs.iter().sum::<f64>() / logs.len() as f64;
    assert!(logs.iter().all(|log| (log - mean).abs() < 0.01), "{mean}: {logs:?}");
}

/// A profile of wanted light is met as a uniform one is.
#[test]
fn a_profile_of_light_is_followed() {
    let keys = "limits = { from_mm = 2, to_mm = 8 }\nmin_over_max = 0.9\ntarget = { profile = { file = \"light.csv\" } }";
    let place = place(LOSSY, &study(400_000, keys));
    // The light of a tube that falls: twice as much at the first hole as at the last.
    fs::write(place.path().join("light.csv"), "along_mm,light\n83,2\n417,1\n").unwrap();
    let found = run(&place, "out", OnExisting::Keep);
    assert_eq!(found.report.ending, Ending::Reached, "{:?}", found.report.ending);
    // The check has other random numbers than the search, and errors of 3 % at each hole.
    let check = found.report.checks.last().unwrap();
    let [first, _, last] = check.measured.zones.as_slice() else { panic!("{:?}", check.measured) };
    let ratio = first.value / last.value;
    assert!((ratio / 2.0 - 1.0).abs() < 0.12, "{ratio}");
}

fn ending(paths: u64, keys: &str) -> (Ending, usize) {
    let report = found(LOSSY, &study(paths, keys)).report;
    (report.ending, report.steps.len())
}

#[test]
fn what_cannot_be_reached_ends_with_the_best_and_the_reason() {
    // Too little room for the last hole.
    let (end, steps) =
        ending(300_000, "limits = { from_mm = 4, to_mm = 4.2 }\nmin_over_max = 0.97");
    assert!(matches!(end, Ending::Unreachable(_)), "{end:?}");
    assert!(end.words().contains("within the limits") && steps <= 20, "{}", end.words());
    // Limits that contradict each other, and bridges that leave no room.
    for keys in [
        "limits = { from_mm = 5, to_mm = 4 }\nmin_over_max = 0.9",
        "limits = { from_mm = 2, to_mm = 8 }\nbridge_mm = 149\nmin_over_max = 0.9",
    ] {
        let (end, steps) = ending(20_000, keys);
        assert!(matches!(end, Ending::ContradictingLimits(_)) && steps == 1, "{end:?}");
    }
    // Deviations without a weight: all openings grow, and the light stays as uneven as it is.
    let keys = "limits = { from_mm = 2, to_mm = 4.5 }\nmin_over_max = 0.97\nuniformity_weight = 0\nefficiency_weight = 1";
    let (end, _) = ending(100_000, keys);
    assert!(matches!(end, Ending::NoProgress(_)), "{end:?}");
    assert!(end.words().contains("`uniformity_weight` is 0"), "{}", end.words());
    // Nothing is wanted.
    let keys = "limits = { from_mm = 2, to_mm = 8 }\nmin_over_max = 0.9\nuniformity_weight = 0";
    let (end, steps) = ending(100_000, keys);
    assert!(matches!(end, Ending::ZeroWeight(_)) && steps == 1, "{end:?}");
    // Too few paths to see anything.
    let keys = "limits = { from_mm = 2, to_mm = 8 }\nmin_over_max = 0.98";
    let (end, _) = ending(2_000, keys);
    assert!(matches!(end, Ending::HiddenByNoise(_)), "{end:?}");
    // One step, although the few paths of the first measurement happen to see what is wanted.
    let keys = "limits = { from_mm = 2, to_mm = 8 }\nmin_over_max = 0.1\nsteps = 1";
    let (end, steps) = ending(100_000, keys);
    assert!(matches!(end, Ending::OutOfSteps(_)) && steps == 1, "{end:?}");
    // Too few steps.
    let keys = "limits = { from_mm = 2, to_mm = 8 }\nmin_over_max = 0.99\nsteps = 2\ndamping = 0.1";
    let (end, steps) = ending(200_000, keys);
    assert!(matches!(end, Ending::OutOfSteps(_)) && steps == 2, "{end:?}");
}

/// Sizes of the scene that lie beyond the limits are no result, even if their light is even enough.
#[test]
fn a_scene_beyond_its_limits_is_brought_within_them() {
    let keys = "limits = { from_mm = 1, to_mm = 3 }\nmin_over_max = 0.3";
    let found = found(LOSSY, &study(200_000, keys));
    assert_eq!(found.report.ending, Ending::Reached, "{:?}", found.report.steps);
    assert!(!found.report.best_step().unwrap().measured.is_start);
    assert!(diameters(&found).iter().all(|own| *own <= 3.0), "{:?}", diameters(&found));
    let held = &found.report.active_limits;
    assert!(
        !held.is_empty() && held.iter().all(|own| own.ends_with("3 mm is the most")),
        "{held:?}"
    );
}

#[test]
fn efficiency_grows_with_a_weight_until_a_limit_holds() {
    let keys = "limits = { from_mm = 2, to_mm = 6 }\nmin_over_max = 0.8";
    let plain = found(LOSSY, &study(120_000, keys)).report;
    let heavy = found(LOSSY, &study(120_000, &format!("{keys}\nefficiency_weight = 100"))).report;
    let efficiency = |own: &lumiduct_report::optimise::OptimisationReport| {
        own.best_step().unwrap().measured.efficiency.value
    };
    assert_eq!((&plain.ending, &heavy.ending), (&Ending::Reached, &Ending::Reached));
    assert!(efficiency(&heavy) > 1.2 * efficiency(&plain), "{}", efficiency(&heavy));
    assert!(!heavy.active_limits.is_empty());
}

#[test]
fn a_resumed_optimisation_ends_with_the_same_bytes_on_any_number_of_threads() {
    let keys = "limits = { from_mm = 2, to_mm = 8 }\nmin_over_max = 0.85";
    let place = place(LOSSY, &study(150_000, keys));
    let read = |folder: &str| {
        let mut files: Vec<(String, Vec<u8>)> = Vec::new();
        for part in ["", "steps"] {
            for entry in fs::read_dir(place.path().join(folder).join(part)).unwrap() {
                let path = entry.unwrap().path();
                if path.is_file() {
                    files.push((
                        path.file_name().unwrap().to_string_lossy().into(),
                        fs::read(&path).unwrap(),
                    ));
                }
            }
        }
        files.sort();
        files
    };
    let whole = run(&place, "whole", OnExisting::Keep);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| run(&place, "single", OnExisting::Keep));
    assert_eq!(read("whole"), read("single"));

    // Stopped after some measurements.
    let (interrupt, options) = (
        Interrupt::default(),
        OptimisationOptions {
            settings: StudySettings::default(),
            dir: Some(place.path().join("cut")),
            existing: OnExisting::Keep,
        },
    );
    let stop = interrupt.clone();
    let watch = move |progress: &lumiduct::optimise::OptimisationProgress| {
        if progress.step == 3 {
            stop.raise();
        }
    };
    let study = place.path().join("study.toml");
    let cut = run_optimisation(&study, &options, &interrupt, &watch).unwrap();
    assert_eq!((&cut.report.ending, cut.report.steps.len()), (&Ending::Interrupted, 2));
    assert!(place.path().join("cut/report.html").is_file());
    // Stopped again at once: the best of the records is kept.
    let options = OptimisationOptions { existing: OnExisting::Resume, ..options };
    let again = run_optimisation(&study, &options, &interrupt, &|_| {}).unwrap();
    assert_eq!(again.report, cut.report);
    let resumed = run(&place, "cut", OnExisting::Resume);
    assert_eq!(resumed.report, whole.report);
    assert_eq!(read("whole"), read("cut"));
}

#[test]
fn the_scene_that_was_found_runs_and_has_the_sizes_of_the_table() {
    let keys =
        "limits = { from_mm = 2, to_mm = 8 }\nmin_over_max = 0.8\nlaw = { spline = { knots = 3 } }";
    let place = place(&LOSSY.replace("around_deg = 270", "around_deg = 1"), &study(150_000, keys));
    let found = run(&place, "out", OnExisting::Keep);
    let folder = place.path().join("out");
    let scene = folder.join("scene_optimised.toml");
    let job = lumiduct_input::load(&scene, &lumiduct_input::Settings::default()).unwrap();
    let field = &job.scene.patterns[0].field;
    let sizes: Vec<f64> = field.places().map(|(place, _)| field.outline.size(place).y).collect();
    assert_eq!(sizes, diameters(&found));
    let table = fs::read_to_string(folder.join("sizes.csv")).unwrap();
    assert!(table.starts_with("element,across_mm,along_mm,diameter_mm\n1,"), "{table}");
    assert_eq!(table.lines().count(), 4);
    let dxf = fs::read_to_string(folder.join("pattern.dxf")).unwrap();
    let drawn = ["0.4363", "157.51593"].map(|x| dxf.matches(&format!("\n{x}\n")).count());
    assert_eq!(drawn, [3, 3], "holes across the seam at both edges: {dxf}");
    let summary: serde_json::Value =
        serde_json::from_slice(&fs::read(folder.join("optimised.json")).unwrap()).unwrap();
    assert_eq!(summary["ending"]["kind"], "reached");
    // One estimator, before and after.
    assert_eq!(summary["checks"].as_array().unwrap().len(), 2);
    let html = fs::read_to_string(folder.join("report.html")).unwrap();
    assert!(html.contains("Steps of the search") && html.contains("before check forward"));
}

/// A hole may reach to the end of the face and not beyond it.
#[test]
fn a_hole_at_the_end_of_a_face_stays_on_it() {
    let scene = LOSSY.replace("[50, 200, 400]", "[50, 200, 497]");
    let keys = "limits = { from_mm = 5.5, to_mm = 9 }\nmin_over_max = 0.9";
    let found = found(&scene, &study(200_000, keys));
    let after = diameters(&found);
    // The damped steps approach the limit from below.
    assert!(after[2] > 5.95 && after[2] <= 6.0 && after[0] >= 5.5, "{after:?}");
    assert!(matches!(found.report.ending, Ending::Unreachable(_)), "{:?}", found.report.ending);
}

/// Where openings change little in a step they do so by the share that the study asks for, however small.
#[test]
fn a_step_makes_the_share_of_the_correction_that_the_study_asks_for() {
    let changes = |damping: &str| -> Vec<f64> {
        let keys = format!(
            "limits = {{ from_mm = 4, to_mm = 16 }}\nmin_over_max = 0.99\nsteps = 2\ndamping = {damping}"
        );
        let scene = LOSSY.replace("diameter_mm = 4", "diameter_mm = 8");
        let report = found(&scene, &study(480_000, &keys)).report;
        report.steps[1].measured.values.iter().map(|own| (own / 8.0).ln()).collect()
    };
    let (whole, tenth) = (changes("1"), changes("0.1"));
    assert!(whole.iter().any(|own| own.abs() > 0.05), "{whole:?}");
    for (whole, tenth) in whole.iter().zip(&tenth) {
        // Lengths have a resolution of 0.1 micrometres.
        assert!((tenth - 0.1 * whole).abs() < 1e-4, "{whole} {tenth}");
    }
}

#[test]
fn files_of_the_scene_that_change_during_a_search_are_noticed() {
    let scene = format!("{LOSSY}[media.glass]\nindex = {{ csv = \"n.csv\" }}\n");
    let keys = "limits = { from_mm = 2, to_mm = 8 }\nmin_over_max = 0.9";
    let place = place(&scene, &study(50_000, keys));
    let table = place.path().join("n.csv");
    fs::write(&table, "lambda_nm,n\n400,1.5\n800,1.5\n").unwrap();
    let options = OptimisationOptions {
        settings: StudySettings::default(),
        dir: Some(place.path().join("out")),
        existing: OnExisting::Keep,
    };
    let change = |_: &lumiduct::optimise::OptimisationProgress| {
        fs::write(&table, "lambda_nm,n\n400,1.5\n800,1.6\n").unwrap();
    };
    let path = place.path().join("study.toml");
    let refused = run_optimisation(&path, &options, &Interrupt::default(), &change).unwrap_err();
    assert!(refused.to_string().contains("a file that it reads changed"), "{refused}");
}
