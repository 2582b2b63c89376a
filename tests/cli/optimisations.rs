//! `lumiduct optimise` as a user runs it: files, exit codes, what is refused, and what a kill leaves.

use crate::*;
use std::process::{Command as Process, Stdio};
use std::thread::sleep;
use std::time::Duration;

/// A short mirror tube with three holes, each over a row of cells.
const TUBE: &str = r#"lumiduct = 1
title = "Tube with holes"
[finishes.mirror]
specular = { reflectance = 0.98 }
[sheets.duct.tube]
profile = { circle = { radius_mm = 10 } }
path = [{ straight_mm = 90 }]
finish = "mirror"
[patterns.holes]
on = "duct.wall"
finish = "open"
element = { circle = { diameter_mm = 4 } }
layout = { row = { pitch_mm = 30, around_deg = 270 } }
[patterns.bars]
on = "duct.wall"
finish = "open"
element = { rectangle = { width_mm = 2, length_mm = 2 } }
layout = { row = { positions_mm = [40], around_deg = 90 } }
[sources.led.disk]
radius_mm = 10
at = { face = "duct.entry" }
flux_lm = 100
[sensors]
wall = { plane = { cells = [1, 3] }, on = "duct.wall", counts = "leaving", side = "front" }
many = { plane = { cells = [1, 500] }, on = "duct.wall", counts = "leaving", side = "front" }
whole = { plane = { cells = [4, 1] }, on = "duct.wall", counts = "leaving", side = "front" }
high = { plane = { rectangle = { width_mm = 10, height_mm = 200 }, cells = [1, 4] }, at = { position_mm = [0, -15, 45], axis = [0, 1, 0], x_axis = [1, 0, 0] } }
exit = { plane = { rings = 2, sectors = 1 }, on = "duct.exit", counts = "leaving" }
far = { goniometer = { c_step_deg = 90, gamma_step_deg = 10 } }
eye = { luminance = { rectangle = { width_mm = 4, height_mm = 80 }, cells = [1, 3], directions = [{ theta_deg = 0, phi_deg = 0 }, { theta_deg = 30, phi_deg = 0 }], acceptance_half_angle_deg = 20 }, at = { position_mm = [0, -15, 45], axis = [0, 1, 0], x_axis = [1, 0, 0] } }
"#;

const STUDY: &str = r#"lumiduct_study = 1
title = "Even light"
scene = "tube.toml"
[run]
paths = 400_000
estimator = "forward"
[optimise.pattern_feedback]
pattern = "holes"
vary = "diameter"
limits = { from_mm = 2, to_mm = 8 }
bridge_mm = 1
law = "table"
sensor = "wall"
min_over_max = 0.9
efficiency = "wall.efficiency"
uniformity_weight = 1
efficiency_weight = 0
damping = 0.8
steps = 12
check_estimator = "forward"
"#;

fn tube(study: &str) -> Place {
    let place = Place::new();
    fs::write(place.path("tube.toml"), TUBE).unwrap();
    fs::write(place.path("study.toml"), study).unwrap();
    place
}

/// All files of an optimisation, including its records.
fn results(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = contents(folder);
    for (name, bytes) in contents(&folder.join("steps")) {
        all.insert(format!("steps/{name}"), bytes);
    }
    all
}

#[test]
fn an_optimisation_says_what_it_found_and_leaves_everything_for_the_workshop() {
    let place = tube(STUDY);
    let said = place.good("optimise study.toml");
    assert!(said.contains("The target is reached") && said.contains("after check"), "{said}");
    let folder = place.path("reports/optimisations/study");
    for name in [
        "report.html",
        "report.md",
        "optimised.json",
        "sizes.csv",
        "zones.csv",
        "history.csv",
        "pattern.dxf",
        "pattern.svg",
        "tube_optimised.toml",
        "study.toml",
        "manifest.json",
    ] {
        assert!(folder.join(name).is_file(), "{name}");
    }
    place.good("run reports/optimisations/study/tube_optimised.toml --paths 20k -o again");
    assert!(place.bad(2, "optimise study.toml").contains("--resume"));
    let said = place.good("optimise study.toml --resume");
    assert!(said.contains("identical to the byte"), "{said}");
    let said = place.bad(2, "optimise study.toml --resume --seed 5");
    assert!(said.contains("another optimisation"), "{said}");
    place.good("optimise study.toml --overwrite -q");
}

#[test]
fn a_target_out_of_reach_ends_with_exit_code_1_and_the_reason() {
    for (from, to, words) in [
        ("from_mm = 2, to_mm = 8", "from_mm = 3.9, to_mm = 4.1", "within the limits"),
        ("from_mm = 2, to_mm = 8", "from_mm = 8, to_mm = 2", "contradict each other"),
        ("bridge_mm = 1", "bridge_mm = 29", "the bridges leave 1.0000 mm"),
        ("uniformity_weight = 1", "uniformity_weight = 0", "nothing is wanted"),
        ("paths = 400_000", "paths = 1_000", "noise"),
    ] {
        let place =
            tube(&STUDY.replace(from, to).replace("min_over_max = 0.9", "min_over_max = 0.97"));
        let output = place.run("optimise study.toml -o out");
        let said = String::from_utf8(output.stdout.clone()).unwrap();
        assert_eq!(code(&output), 1, "{to}: {said}{}", errors(&output));
        assert!(said.contains("not reached") && said.contains(words), "{to}: {said}");
        assert!(place.path("out/report.html").is_file());
    }
}

#[test]
fn a_killed_optimisation_goes_on_to_the_same_bytes_on_any_number_of_threads() {
    let place = tube(&STUDY.replace("paths = 400_000", "paths = 800_000"));
    place.good("optimise study.toml -o whole --threads 3");
    let mut child = Process::new(env!("CARGO_BIN_EXE_lumiduct"))
        .current_dir(place.0.path())
        .args(["optimise", "study.toml", "-o", "cut", "--threads", "1"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let second = place.path("cut/steps/0002.json");
    while !second.is_file() && child.try_wait().unwrap().is_none() {
        sleep(Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(!place.path("cut/report.html").exists());
    place.good("optimise study.toml -o cut --resume");
    assert_eq!(results(&place.path("whole")), results(&place.path("cut")));
    // A changed record is refused by its name.
    fs::write(&second, "{}").unwrap();
    assert!(place.bad(2, "optimise study.toml -o cut --resume").contains("0002.json"));
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_the_best_and_resuming_ends_with_the_same_bytes() {
    let place = tube(&STUDY.replace("paths = 400_000", "paths = 800_000"));
    place.good("optimise study.toml -o whole");
    let mut child = Process::new(env!("CARGO_BIN_EXE_lumiduct"))
        .current_dir(place.0.path())
        .args(["optimise", "study.toml", "-o", "cut"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    while !place.path("cut/steps/0003.json").is_file() && child.try_wait().unwrap().is_none() {
        sleep(Duration::from_millis(2));
    }
    send_ctrl_c(&child);
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let summary: Value =
        serde_json::from_slice(&fs::read(place.path("cut/optimised.json")).unwrap()).unwrap();
    assert_eq!(summary["ending"]["kind"], "interrupted");
    assert!(place.path("cut/tube_optimised.toml").is_file());
    place.good("optimise study.toml -o cut --resume");
    assert_eq!(results(&place.path("whole")), results(&place.path("cut")));
}

#[test]
fn bad_optimisations_are_refused_with_the_line_to_change_and_write_nothing() {
    for (from, to, words) in [
        (
            "lumiduct_study = 1",
            "lumiduct_study = 2",
            "study.toml:1: `lumiduct_study`: format version 2",
        ),
        ("lumiduct_study = 1", "lumiduct = 1", "study.toml:1: `lumiduct`: this is a scene"),
        ("\"Even light\"", "\"Even\\nlight\"", "a title must be one line"),
        ("title =", "titel =", "title"),
        ("title = \"Even light\"", "title = \"Even light\"\ndescription = 3", "study.toml:3"),
        ("tube.toml", "tub.toml", "study.toml:3: `scene`: there is no file"),
        ("[run]", "[set]\n\"sources.led.flux\" = 3\n[run]", "study.toml:5"),
        ("[run]", "[set]\n\"run.seed\" = 3\n[run]", "under `run` of the study"),
        ("paths = 400_000", "paths = 0", "study.toml:5: `run.paths`"),
        ("paths = 400_000", "paths = 400_000\nseed = -1", "`run.seed`"),
        ("estimator = \"forward\"\n[", "estimator = \"forwards\"\n[", "forward"),
        ("[optimise.pattern_feedback]", "[optimise.pattern]", "pattern_feedback"),
        (
            "pattern = \"holes\"",
            "pattern = \"hole\"",
            "study.toml:8: `optimise.pattern_feedback.pattern`: the scene has no",
        ),
        ("pattern = \"holes\"", "pattern = \"bars\"", "its sizes and its pitch are fixed"),
        ("vary = \"diameter\"", "vary = \"depth\"", "it has diameter_mm, pitch_mm"),
        ("vary = \"diameter\"", "vary = \"size\"", "diameter"),
        ("from_mm = 2, ", "", "from_mm"),
        ("from_mm = 2", "from_mm = 0", "above 0"),
        ("to_mm = 8", "to_mm = -8", "above 0"),
        ("to_mm = 8", "to = 8", "to_mm"),
        ("bridge_mm = 1", "bridge_mm = -1", "study.toml:11"),
        ("law = \"table\"", "law = \"straight\"", "study.toml:12"),
        ("law = \"table\"", "law = { spline = { knots = 1 } }", "2 to 200"),
        ("sensor = \"wall\"", "sensor = \"wal\"", "did you mean `wall`?"),
        ("sensor = \"wall\"", "sensor = \"far\"", "directions, not places"),
        ("sensor = \"wall\"", "sensor = \"whole\"", "divide it along the face"),
        ("sensor = \"wall\"", "sensor = \"high\"", "make it shorter"),
        ("sensor = \"wall\"", "sensor = \"many\"", "500 zones along the face, and at most 400"),
        ("sensor = \"wall\"", "sensor = \"exit\"", "no columns and rows"),
        ("sensor = \"wall\"", "sensor = \"wall\"\nview = 0", "leave `view` out"),
        ("sensor = \"wall\"", "sensor = \"eye\"\nview = 2", "the sensor has 2 directions"),
        ("sensor = \"wall\"", "sensor = \"wall\"\ntarget = \"even\"", "uniform"),
        (
            "sensor = \"wall\"",
            "sensor = \"wall\"\ntarget = { profile = { file = \"no.csv\" } }",
            "study.toml:14: `optimise.pattern_feedback.target.profile.file`",
        ),
        ("min_over_max = 0.9", "min_over_max = 1", "below 1"),
        ("min_over_max = 0.9\n", "", "min_over_max"),
        (
            "\"wall.efficiency\"",
            "\"wall.eficiency\"",
            "study.toml:15: `optimise.pattern_feedback.efficiency`",
        ),
        ("\"wall.efficiency\"", "\"wall.flux\"", "`wall.flux` is no efficiency"),
        ("uniformity_weight = 1", "uniformity_weight = -1", "study.toml:16"),
        ("efficiency_weight = 0", "efficiency_weight = -1", "study.toml:17"),
        ("damping = 0.8", "damping = 1.1", "study.toml:18"),
        ("steps = 12", "steps = 0", "study.toml:19"),
        ("check_estimator = \"forward\"", "check_estimator = \"other\"", "study.toml:20"),
        ("check_estimator = \"forward\"", "bridge = 1", "bridge_mm"),
    ] {
        let text = STUDY.replacen(from, to, 1);
        assert_ne!(text, STUDY, "{from}");
        let place = tube(&text);
        let said = place.bad(2, "optimise study.toml");
        assert!(said.contains(words), "{to}: no {words} in {said}");
        assert!(!place.path("reports").exists(), "{to}");
    }
}

#[test]
fn a_scene_with_batches_of_its_own_is_refused() {
    let place = tube(STUDY);
    fs::write(place.path("tube.toml"), format!("{TUBE}[run]\nbatches = 8\n")).unwrap();
    let said = place.bad(2, "optimise study.toml");
    assert!(said.contains("remove `batches` from [run] of the scene"), "{said}");
}

#[test]
fn bad_profiles_are_refused_at_their_line() {
    let keys = "sensor = \"wall\"\ntarget = { profile = { file = \"light.csv\" } }";
    for (table, words) in [
        ("along_mm,flux\n1,2\n", "light.csv:1: a column is missing"),
        ("along_mm,light\n1,2\n1,3\n", "light.csv:3: the position is not greater"),
        ("along_mm,light\n1,-2\n", "light.csv:2: the light is below 0"),
        ("along_mm,light\n1,a\n", "light.csv:2: a cell of this row is not a finite number"),
        ("along_mm,light\n1\n", "different number of cells"),
        ("along_mm,light\n", "there are no rows"),
    ] {
        let place = tube(&STUDY.replace("sensor = \"wall\"", keys));
        fs::write(place.path("light.csv"), table).unwrap();
        let said = place.bad(2, "optimise study.toml");
        assert!(said.contains(words), "{table}: no {words} in {said}");
    }
}

#[test]
fn studies_of_the_other_kind_are_sent_to_their_command() {
    let place = tube(STUDY);
    assert!(place.bad(2, "batch study.toml").contains("lumiduct optimise"));
    assert!(place.bad(2, "check study.toml").contains("lumiduct optimise"));
    let plan = crate::batches::STUDY.trim_start();
    fs::write(place.path("plan.toml"), plan).unwrap();
    assert!(place.bad(2, "optimise plan.toml").contains("lumiduct batch"));
    assert!(place.good("list").contains("study: Even light"));
    assert!(place.good("schema optimisation").contains("pattern_feedback"));
}

/// A bar with a relief, which is to be filled in, and an index in a file beside it.
const BAR: &str = r#"lumiduct = 1
title = "Bar with a relief"
[media.acrylic]
index = { csv = "media/index.csv" }
[finishes]
white = { lambertian = { reflectance = 0.95 } }
[solids.bar.box]
size_mm = [8, 5, 60]
medium = "acrylic"
[reliefs.marks]
on = "bar.wall_minus_y"
element = ELEMENT
layout = { row = { pitch_mm = 3 } }
[sheets.back.rectangle]
width_mm = 8
height_mm = 60
finish = "white"
at = { position_mm = [0, -2.6, 30], axis = [0, 1, 0] }
[sources.led.rectangle]
width_mm = 6
height_mm = 3.5
at = { face = "bar.entry", gap_mm = 0.1 }
flux_lm = 100
[sensors]
wall = { plane = { cells = [1, 4] }, on = "bar.wall_plus_y", counts = "leaving" }
"#;

/// Runs an optimisation to its end; smallest over largest ratio at its start and of its best step.
fn ratios(place: &Place, folder: &str) -> [f64; 2] {
    let output = place.run(&format!("optimise study.toml -q -o {folder}"));
    assert!([0, 1].contains(&code(&output)), "{}", errors(&output));
    let file = place.path(folder).join("optimised.json");
    let summary: Value = serde_json::from_slice(&fs::read(file).unwrap()).unwrap();
    let steps = summary["steps"].as_array().unwrap();
    let best = summary["best"].as_u64().unwrap() as usize;
    [0, best].map(|step| steps[step]["misfit"]["min_over_max"]["value"].as_f64().unwrap())
}

#[test]
fn every_length_of_an_element_can_be_found() {
    for (vary, element, limits) in [
        ("depth", "{ groove = { depth_mm = 0.3, angle_deg = 90 } }", "from_mm = 0.05, to_mm = 1"),
        ("height", "{ ridge = { height_mm = 0.3, angle_deg = 90 } }", "from_mm = 0.05, to_mm = 1"),
        (
            "radius",
            "{ dimple = { radius_mm = 0.8, depth_mm = 0.3 } }",
            "from_mm = 0.31, to_mm = 1.4",
        ),
        ("pitch", "{ groove = { depth_mm = 0.3, angle_deg = 90 } }", "from_mm = 1.5, to_mm = 8"),
    ] {
        let place = Place::new();
        let study = STUDY
            .replace("tube.toml", "bar.toml")
            .replace("\"holes\"", "\"marks\"")
            .replace("vary = \"diameter\"", &format!("vary = \"{vary}\""))
            .replace("from_mm = 2, to_mm = 8", limits)
            .replace("bridge_mm = 1\n", "")
            .replace("400_000", "200_000");
        fs::create_dir(place.path("media")).unwrap();
        fs::write(place.path("media/index.csv"), "lambda_nm,n\n400,1.49\n800,1.49\n").unwrap();
        fs::write(place.path("bar.toml"), BAR.replace("ELEMENT", element)).unwrap();
        fs::write(place.path("study.toml"), study).unwrap();
        let [before, after] = ratios(&place, "deep/down/out");
        assert!(after > before + 0.05, "{vary}: {before} {after}");
        // The scene that was found reads its table from where it lies now.
        let scene = fs::read_to_string(place.path("deep/down/out/bar_optimised.toml")).unwrap();
        assert!(scene.contains("\"../../../media/index.csv\""), "{scene}");
        place.good("run deep/down/out/bar_optimised.toml --paths 20k -o again --overwrite");
    }
}

#[test]
fn luminance_from_a_direction_is_made_even() {
    let place = tube(&STUDY.replace("sensor = \"wall\"", "sensor = \"eye\"\nview = 1"));
    let [before, after] = ratios(&place, "out");
    assert!(after > before + 0.05, "{before} {after}");
    let page = fs::read_to_string(place.path("out/report.md")).unwrap();
    assert!(page.contains("luminance"), "{page}");
}
