//! Runs that do what they are asked to do.

use crate::*;
use lumiduct::pipeline::{self, Output};
use lumiduct_core::plan::Request;
use lumiduct_core::transport::Interrupt;
use lumiduct_input::Settings;
use lumiduct_report::Existing;

#[test]
fn only_a_sensor_that_was_lit_from_behind_is_told_to_turn() {
    // All light that meets the side of this prism from inside is reflected; the plane faces away
    // from the rod.
    let scene = r#"lumiduct = 1
title = "Total reflection"
[media.glass]
index = 1.6
[solids.rod.box]
size_mm = [4, 4, 20]
medium = "glass"
[sources.beam.face]
of = "rod.entry"
side = "back"
emission = "collimated"
flux_lm = 1
[sheets.mirror.rectangle]
width_mm = 4
height_mm = 4
finish = { specular = { reflectance = 1 } }
at = { position_mm = [0, 0, 20] }
[sensors]
covered = { plane = {}, on = "rod.exit", counts = "leaving" }
[run]
paths = 2000
bounce_limit = 20
"#;
    let place = Place::new();
    fs::write(place.path("prism.toml"), scene).unwrap();
    place.good("run prism.toml -q -o covered");
    let warnings = place.summary("covered")["warnings"].to_string();
    assert!(
        warnings.contains("sensor `covered` counts light that leaves its face, and none did"),
        "{warnings}"
    );
    assert!(!warnings.contains("lit on its other side"), "{warnings}");
    let away = "away = { plane = { disk = { radius_mm = 9 } }, at = { position_mm = [0, 0, 25] } }";
    fs::write(
        place.path("away.toml"),
        SCENE.replace("[sensors]\n", &format!("[sensors]\n{away}\n")),
    )
    .unwrap();
    place.good("run away.toml -q -o away");
    let warnings = place.summary("away")["warnings"].to_string();
    assert!(warnings.contains("sensor `away` was lit on its other side only"), "{warnings}");
}

#[test]
fn a_run_without_pictures_writes_all_else_the_same() {
    let place = Place::new();
    place.good("run rod.toml -q -o drawn");
    place.good("run rod.toml -q -o plain --no-pictures");
    let [drawn, plain] = ["drawn", "plain"].map(|name| names(&place.path(name)));
    let others: Vec<&String> = drawn.iter().filter(|name| !name.ends_with(".png")).collect();
    assert!(others.len() < drawn.len() && others == plain.iter().collect::<Vec<_>>(), "{plain:?}");
    let text =
        |report: &str, name: &str| fs::read_to_string(place.path(report).join(name)).unwrap();
    assert!(text("drawn", "report.md").contains("]("));
    assert!(!text("plain", "report.md").contains("!["), "no links to missing files");
    for name in ["measures.csv", "report.html"] {
        assert_eq!(text("drawn", name), text("plain", name));
    }
    place.good("run rod.toml -q -o drawn --no-pictures --overwrite");
    assert_eq!(names(&place.path("drawn")), plain);
}

#[test]
fn a_run_writes_every_file_of_its_report() {
    let place = Place::new();
    let said = place.good("run rod.toml");
    assert!(said.contains("efficiency") && said.ends_with("reports/rod/report.html\n"), "{said}");
    let expected = [
        "balance.png",
        "exit.bounces.csv",
        "exit.bounces.png",
        "exit.illuminance.csv",
        "exit.illuminance.matrix.csv",
        "exit.illuminance.png",
        "exit.npz",
        "far.bounces.csv",
        "far.bounces.png",
        "far.intensity.csv",
        "far.intensity.matrix.csv",
        "far.intensity.png",
        "far.npz",
        "manifest.json",
        "measures.csv",
        "report.html",
        "report.md",
        "rod.toml",
        "summary.json",
        "timing.csv",
    ];
    let report = place.path("reports/rod");
    assert_eq!(names(&report), expected);
    assert_eq!(
        fs::read(report.join("rod.toml")).unwrap(),
        fs::read(place.path("rod.toml")).unwrap()
    );
    let page = fs::read_to_string(report.join("report.md")).unwrap();
    for picture in expected.iter().filter(|name| name.ends_with(".png")) {
        assert!(page.contains(&format!("({picture})")), "{picture} is not on the page");
        assert!(fs::read(report.join(picture)).unwrap().starts_with(b"\x89PNG"), "{picture}");
    }
    let listed = &place.summary("reports/rod")["files"];
    for name in listed.as_array().unwrap() {
        assert!(expected.contains(&name.as_str().unwrap()), "{name} is named but not there");
    }
}

/// Bytes of a page with two sensors and their plots; most of it is the scene and the scripts.
const PAGE_BYTES: usize = 300_000;

#[test]
fn the_page_for_browsers_names_every_measure_and_is_one_small_file() {
    let place = Place::with("[[check]]\nmeasure = \"exit.efficiency\"\nmin = 0.99\n");
    assert_eq!(code(&place.run("run rod.toml -o out -q")), 1);
    let page = fs::read_to_string(place.path("out/report.html")).unwrap();
    for name in place.summary("out")["measures"].as_object().unwrap().keys() {
        assert!(page.contains(&format!("<td>{name}</td>")), "{name} is not on the page");
    }
    assert!(page.contains(r#"<p class="verdict bad">1 of 1 checks missed</p>"#));
    assert!(page.len() < PAGE_BYTES, "{} bytes", page.len());
    // Only pictures in the folder are referenced, and only for readers without scripts.
    for (at, _) in page.match_indices("src=") {
        assert!(page[..at].ends_with("<noscript><img "), "something is loaded");
    }
}

#[test]
fn the_page_for_browsers_draws_60_paths_by_where_they_end() {
    let place = Place::new();
    place.good("run rod.toml -o out -q");
    let page = fs::read_to_string(place.path("out/report.html")).unwrap();
    let data = page.split("id=\"data\">").nth(1).unwrap().split("</script>").next().unwrap();
    let data: Value = serde_json::from_str(data).unwrap();
    let plots = data["plots"].as_array().unwrap();
    let scene = plots.iter().find(|plot| plot["plot"] == "scene").unwrap();
    let groups = scene["groups"].as_array().unwrap();
    let count = |name: &str| {
        let group = groups.iter().find(|group| group["name"] == name);
        group.map_or(0, |group| group["count"].as_u64().unwrap())
    };
    // Nothing absorbs: light leaves by the exit, or otherwise through the sphere around everything.
    assert_eq!(count("counted by exit") + count("counted by far"), 60, "{groups:?}");
    assert!((40..60).contains(&count("counted by exit")), "some 85 % of the flux: {groups:?}");
    let faces = scene["faces"].as_array().unwrap();
    let names: Vec<&str> = faces.iter().map(|face| face["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["rod.wall", "rod.entry", "rod.exit", "led"]);
}

#[test]
fn numbers_in_summary_and_balance_make_sense() {
    let place = Place::new();
    place.good("run rod.toml -o out -q");
    let summary = place.summary("out");
    let measure = |name: &str| summary["measures"][name]["value"].as_f64().unwrap();
    // Fresnel losses at two faces take some 15 % of the flux, and there is no gain.
    assert!((7.0..9.0).contains(&flux(&summary)), "{}", flux(&summary));
    assert!((measure("exit.efficiency") - flux(&summary) / 10.0).abs() < 1e-12);
    assert!(measure("balance.residual").abs() < 1e-9 * 10.0 && measure("balance.leaked") == 0.0);
    assert_eq!(summary["measures"]["exit.flux"]["unit"], "lm");
    let paths = &summary["paths_to_sensors"][0];
    assert!(paths["depths"].is_null(), "the histogram is in exit.bounces.csv");
    let shares = paths["classes"].as_array().unwrap().iter().map(|class| class["share"].as_f64());
    assert!((shares.map(Option::unwrap).sum::<f64>() - 1.0).abs() < 1e-12);
}

#[test]
fn a_missed_check_ends_with_1_and_a_met_one_with_0() {
    let check = |demand: &str| format!("[[check]]\nmeasure = \"exit.efficiency\"\n{demand}\n");
    assert!(Place::with(&check("min = 0.5")).good("run rod.toml").contains("passed"));
    let missed = Place::with(&check("min = 0.99"));
    let output = missed.run("run rod.toml");
    assert_eq!(code(&output), 1);
    assert!(String::from_utf8_lossy(&output.stdout).contains("FAILED"));
    assert!(missed.path("reports/rod/report.md").is_file(), "the report tells what was missed");
    // The standard error of 20,000 paths is some 1e-3.
    let open = Place::with(&check("equals = 0.85\nsigmas = 4\nmax_std_error = 1e-6"));
    assert_eq!(code(&open.run("run rod.toml -q")), 1, "undecided counts as missed");
}

#[test]
fn a_run_off_its_target_ends_with_1_where_there_are_checks() {
    let check = "[[check]]\nmeasure = \"exit.flux\"\nmin = 1\n";
    let place = Place::with(check);
    assert_eq!(code(&place.run("run rod.toml --target 0.0001% --paths 20k -q -o a")), 1);
    assert_eq!(code(&place.run("run rod.toml --target 10% --paths 1M -q -o b")), 0);
    assert_eq!(place.summary("b")["run"]["stopped"], "the target error was reached");
}

#[test]
fn an_override_changes_the_result_and_is_named_in_the_report() {
    let place = Place::new();
    place.good("run rod.toml -o a -q");
    place.good("run rod.toml -o b -q -D sources.led.disk.flux_lm=20 -D title=Twice");
    let (one, two) = (place.summary("a"), place.summary("b"));
    assert!((flux(&two) / flux(&one) - 2.0).abs() < 1e-12, "the same paths with twice the flux");
    assert_eq!(two["scene"]["overrides"][0], "sources.led.disk.flux_lm=20");
    assert_ne!(one["scene"]["hash"], two["scene"]["hash"]);
    let page = fs::read_to_string(place.path("b/report.md")).unwrap();
    assert!(page.starts_with("# Twice") && page.contains("sources.led.disk.flux_lm=20"));
}

#[test]
fn the_same_seed_gives_the_same_bytes_on_any_number_of_threads() {
    let place = Place::new();
    place.good("run rod.toml -o a -q --seed 7 --threads 1");
    place.good("run rod.toml -o b -q --seed 7 --threads 2");
    place.good("run rod.toml -o c -q --seed 8 --threads 2");
    let (one, two, other) =
        (contents(&place.path("a")), contents(&place.path("b")), contents(&place.path("c")));
    assert_eq!(one, two);
    assert_ne!(one["exit.illuminance.csv"], other["exit.illuminance.csv"]);
}

#[test]
fn a_quiet_run_says_nothing() {
    let output = Place::new().run("run rod.toml -q");
    assert!(output.stdout.is_empty() && output.stderr.is_empty());
}

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_a_partial_report_and_ends_with_130() {
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};

    let place = Place::new();
    let mut child = Command::new(env!("CARGO_BIN_EXE_lumiduct"))
        .current_dir(place.0.path())
        .args(["run", "rod.toml", "-o", "out", "--paths", "1G", "--checkpoint", "0.001s"])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    // The first checkpoint is saved after the first batches, so there is something to report.
    let start = Instant::now();
    while !place.path("out/checkpoint.bin").is_file() {
        assert!(start.elapsed() < Duration::from_secs(60), "the run has not begun");
        std::thread::sleep(Duration::from_millis(10));
    }
    send_ctrl_c(&child);
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert_eq!(place.summary("out")["run"]["partial"], true);
    let page = fs::read_to_string(place.path("out/report.md")).unwrap();
    assert!(page.contains("partial"), "the page does not say so");
}

#[test]
fn the_command_in_the_report_of_a_stopped_run_repeats_its_numbers() {
    let place = Place::new();
    // Each batch polls when it begins, so this run is stopped in the middle of its batches, as by
    // Ctrl-C.
    let estimator = Some(Request::Forward);
    let settings = Settings { seed: Some(3), estimator, ..Settings::default() };
    let output = Output::new(Some(place.path("out")), Existing::Keep);
    let interrupt = Interrupt::at_check(70);
    let scene = place.path("rod.toml");
    pipeline::run_one(&scene, &settings, &output, &interrupt, &mut |_| ()).unwrap();
    let summary = place.summary("out");
    assert_eq!(summary["run"]["partial"], true);
    let paths = summary["paths"].as_u64().unwrap();
    assert!(paths < 20_000, "{paths} paths");
    let repeat = summary["run"]["repeat"].as_str().unwrap();
    assert!(repeat.contains(&format!("--paths {paths}")), "{repeat}");
    place.good(&format!("{} -o again -q", repeat.strip_prefix("lumiduct ").unwrap()));
    assert_eq!(place.summary("again")["measures"], summary["measures"], "the same paths again");
}

#[test]
fn what_a_run_did_otherwise_than_asked_is_said() {
    let place = Place::new();
    let said = place.good("run rod.toml -o a --paths 1");
    assert!(said.contains("128 paths were traced although 1 were requested"), "{said}");
    let said = place.good("run rod.toml -o b --target 0.0001% --paths 20k");
    assert!(said.contains("target exit.flux: requested 1×10⁻⁴ %"), "{said}");
    let joined = place.run("check rod.toml -D sources.led.disk.at.gap_mm=0");
    assert!(errors(&joined).contains("optically"), "{}", errors(&joined));
}

#[test]
fn merged_values_name_their_estimator_and_their_windows() {
    let place = Place::new();
    place.good(
        "run rod.toml -o a -q --estimator mis --depth 2 --records 1k --photons 2k --paths 48k",
    );
    let summary = place.summary("a");
    assert_eq!(summary["run"]["estimator"], "mis");
    assert_eq!(summary["estimators"]["exit"], "mis");
    assert_eq!(summary["measures"]["exit.flux"]["estimator"], "mis");
    assert!(summary["measures"]["exit.flux"]["bias"].is_number(), "{summary}");
    let page = fs::read_to_string(place.path("a/report.md")).unwrap();
    assert!(page.contains("| exit | mis |") && page.contains("E1 in lm"), "{page}");
}

#[test]
fn settings_of_gathering_are_reported_and_make_another_report() {
    let place = Place::new();
    let options = "--depth 8 --angle-deg 0.15 --records 10k --photons 1M --schedule fixed";
    let output =
        place.run(&format!("run rod.toml -o a --radius-mm 3 --estimator gather {options}"));
    assert_eq!(code(&output), 0);
    assert!(errors(&output).contains("`--radius-mm`: 3 mm is larger"), "{}", errors(&output));
    let told =
        "depth 8, radius 3 mm, angle 0.15 deg, 10000 records, 1000000 photons, schedule fixed";
    assert_eq!(place.summary("a")["run"]["estimator"], "gather");
    assert_eq!(place.summary("a")["run"]["gather"], told);
    assert!(fs::read_to_string(place.path("a/report.md")).unwrap().contains(told));
    let other =
        place.bad(2, &format!("run rod.toml -o a --radius-mm 2 --estimator gather {options}"));
    assert!(other.contains("different estimator settings"), "{other}");

    let idle = place.run("run rod.toml -o b --estimator forward --depth 8 --records 10k");
    let said = errors(&idle);
    assert!(
        said.contains("without effect with the estimator \"forward\": --depth, --records"),
        "{said}"
    );
}

#[test]
fn a_mesh_that_changed_makes_another_scene() {
    let place = Place::new();
    let hash = |size: f64| {
        fs::write(place.path("box.obj"), cube(size)).unwrap();
        place.good("run rod.toml -o out -q --overwrite");
        place.summary("out")["scene"]["hash"].as_str().unwrap().to_owned()
    };
    let mesh = "[solids.block.mesh]\nfile = \"box.obj\"\nunit = \"mm\"\nmedium = \"acrylic\"\n";
    let far = "at = { position_mm = [90, 0, 0] }\n";
    fs::write(place.path("rod.toml"), format!("{SCENE}{mesh}{far}")).unwrap();
    assert_ne!(hash(1.0), hash(2.0));
}

/// A closed box as an OBJ file.
fn cube(size: f64) -> String {
    let corner = |i: usize| [i & 1, i >> 1 & 1, i >> 2].map(|bit| bit as f64 * size);
    let vertices: String = (0..8).map(corner).map(|[x, y, z]| format!("v {x} {y} {z}\n")).collect();
    let faces = ["1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"];
    vertices + &faces.map(|face| format!("f {face}\n")).concat()
}

#[test]
fn several_suns_make_a_table_and_a_plot_of_the_transmission_by_their_elevations() {
    let place = Place::new();
    let scene = r#"
lumiduct = 1
title = "Tube under sun and sky"
[finishes.mirror]
specular = { reflectance = 0.9 }
[sheets.duct.tube]
profile = { circle = { radius_mm = 5 } }
path = [{ straight_mm = 20 }]
finish = "mirror"
at = { axis = [0, 0, -1] }
[sources]
sun.sun = { elevations_deg = [30, 67.5], illuminance_lx = 80_000, aim = "duct.entry" }
sky.sky = { model = "uniform", horizontal_illuminance_lx = 10_000, aim = "duct.entry" }
[sensors]
exit = { plane = {}, on = "duct.exit", counts = "leaving", entering = "duct.entry" }
[run]
paths = 20_000
"#;
    fs::write(place.path("tube.toml"), scene).unwrap();
    place.good("run tube.toml -q");
    let report = place.path("reports/tube");
    let table = fs::read_to_string(report.join("exit.transmission.csv")).unwrap();
    let lines: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(lines[0], ["source", "elevation_deg", "transmission", "std_error"]);
    // From the zenith down, then the skies.
    let firsts: Vec<&[&str]> = lines[1..].iter().map(|line| &line[..2]).collect();
    assert_eq!(firsts, [["sun_67_5", "67.5"], ["sun_30", "30"], ["sky", ""]]);
    let transmission = |row: usize| lines[row][2].parse::<f64>().unwrap();
    assert!(1.0 > transmission(1) && transmission(1) > transmission(2) && transmission(2) > 0.0);
    let page = fs::read_to_string(report.join("report.md")).unwrap();
    assert!(page.contains("| sun_67_5 | 67.50° | 0."), "{page}");
    assert!(page.contains("(exit.transmission.png)"), "{page}");
    // Without several suns there is no table.
    place.good("run rod.toml -q");
    assert!(!names(&place.path("reports/rod")).iter().any(|name| name.contains("transmission")));
}
