//! Refused input, and files left alone.

use crate::*;

#[test]
fn bad_input_ends_with_2_and_writes_nothing() {
    let place = Place::with("[media.glass]\nindx = 1.5\n");
    let said = place.bad(2, "run rod.toml");
    for words in ["rod.toml:21", "indx", "index"] {
        assert!(said.contains(words), "no {words} in {said}");
    }
    place.bad(2, "check rod.toml");
    assert!(place.bad(2, "run missing.toml").contains("missing.toml"));
    let unknown = Place::with("[[check]]\nmeasure = \"exit.fluxx\"\nmin = 1\n");
    assert!(unknown.bad(2, "run rod.toml").contains("exit.flux"));
    assert_eq!(
        (place.names(), unknown.names()),
        (vec!["rod.toml".into()], vec!["rod.toml".into()])
    );
}

#[test]
fn a_cad_file_or_a_mesh_in_place_of_a_scene_leads_to_the_page_about_cad() {
    let place = Place::new();
    for (name, word) in [("guide.step", "a CAD file"), ("guide.stl", "a mesh (STL)")] {
        fs::write(place.path(name), "ISO-10303-21;\nHEADER;\n").unwrap();
        for command in ["run", "check"] {
            let said = place.bad(2, &format!("{command} {name}"));
            assert!(said.contains(word) && said.contains("docs/cad.md"), "{said}");
            assert_eq!(said.lines().count(), 1, "{said}");
        }
    }
}

#[test]
fn a_bad_command_line_ends_with_2_and_writes_nothing() {
    let place = Place::new();
    for arguments in [
        "",
        "walk rod.toml",
        "run",
        "run rod.toml --pahts 2M",
        "run rod.toml --paths 0",
        "run rod.toml --paths many",
        "run rod.toml --time -1s",
        "run rod.toml --target 0%",
        "run rod.toml --target 0.5",
        "run rod.toml -o rod.toml",
        "run rod.toml --threads 0",
        "run rod.toml --estimator psychic",
        "run rod.toml --schedule sometimes",
        "run rod.toml -D solids.rod.cylinder.length_mm",
        "run rod.toml -D solids.rod.cylinder.lenght_mm=3",
        "run rod.toml -D solids.rod.cylinder.length_mm=-3",
        "completions cobol",
    ] {
        assert!(!place.bad(2, arguments).is_empty(), "{arguments}");
    }
    assert_eq!(place.names(), ["rod.toml"]);
    let help = place.good("run --help");
    assert!(help.contains("Gather:") && help.contains("--estimator <ESTIMATOR>"), "{help}");
    assert!(help.contains("--overwrite") && place.good("--help").contains("Exit codes"));
}

#[test]
fn settings_of_a_repeated_run_are_refused_where_they_would_do_nothing() {
    let place = Place::new();
    for (flags, missing) in [
        ("--time 1s -D run.batches=7", "--paths"),
        ("--target 1% -D run.batches=7", "--paths"),
        ("--paths 2k -D run.planned_paths=9000", "run.batches"),
        ("--time 1s -D run.planned_paths=9000", "run.batches"),
    ] {
        let said = place.bad(2, &format!("run rod.toml {flags}"));
        assert!(said.contains(missing), "{flags}: {said}");
    }
}

#[test]
fn bad_settings_for_gathering_are_refused_with_the_figure_that_is_wrong() {
    let place = Place::new();
    for (flag, key, figure) in [
        ("--depth", "depth", "1001"),
        ("--depth", "depth", "-1"),
        ("--radius-mm", "radius_mm", "0"),
        ("--radius-mm", "radius_mm", "-0.5"),
        ("--radius-mm", "radius_mm", "inf"),
        ("--angle-deg", "angle_deg", "0"),
        ("--angle-deg", "angle_deg", "90"),
        ("--angle-deg", "angle_deg", "120"),
        ("--records", "records", "0"),
        ("--records", "records", "-5"),
        ("--photons", "photons", "0"),
        ("--photons", "photons", "-3"),
    ] {
        let said = place.bad(2, &format!("run rod.toml --estimator gather {flag}={figure}"));
        assert!(said.contains(flag) && said.contains(figure), "{flag}: {said}");
        let said =
            place.bad(2, &format!("run rod.toml --estimator gather -D run.gather.{key}={figure}"));
        assert!(said.contains(&format!("run.gather.{key}")), "{key}: {said}");
        // Non-finite values are reported as such.
        assert!(said.contains(figure) || said.contains("finite"), "{key}: {said}");
    }
    assert_eq!(place.names(), ["rod.toml"]);
}

#[test]
fn a_sensor_that_sees_no_port_is_told_of() {
    let look = |axis: &str| {
        Place::with(&format!(
            "[sensors.eye]\nat = {{ position_mm = [0, 0, 20], axis = [0, 0, {axis}] }}\n\
             luminance = {{ disk = {{ radius_mm = 1 }}, cells = [1, 1], acceptance_half_angle_deg = 1, \
             directions = [{{ theta_deg = 0, phi_deg = 0 }}] }}\n"
        ))
    };
    let options = "--records 100 --photons 100 --paths 3k";
    let (away, toward) = (look("1"), look("-1"));
    for estimator in ["backward", "gather"] {
        let run = format!("run rod.toml -o {estimator} --estimator {estimator} {options}");
        let output = away.run(&run);
        let said = errors(&output);
        assert_eq!(code(&output), 0, "{said}");
        assert!(
            said.contains("rod.toml:20: warning: `sensors.eye`: sees no port: none of 1000"),
            "{said}"
        );
        let page = fs::read_to_string(away.path(estimator).join("report.md")).unwrap();
        assert!(page.contains("`sensors.eye` sees no port"), "{page}");
        assert!(!errors(&toward.run(&run)).contains("sees no port"));
    }
    let forward = away.run("run rod.toml -o forward --estimator forward --paths 3k");
    assert!(!errors(&forward).contains("sees no port"));
    let checked = away.run("check rod.toml -D run.estimator=\"gather\"");
    assert!(errors(&checked).contains("sees no port"), "{}", errors(&checked));
}

#[test]
fn a_report_is_kept_unless_it_may_be_replaced() {
    let place = Place::new();
    place.good("run rod.toml -o out -q --seed 1");
    let first = contents(&place.path("out"));
    assert!(place.bad(2, "run rod.toml -o out -q --seed 2").contains("--overwrite"));
    assert!(place.bad(2, "run rod.toml -o out -q --time 1s").contains("--overwrite"));
    assert_eq!(contents(&place.path("out")), first);
    place.good("run rod.toml -o out -q --seed 2 --overwrite");
    assert_ne!(contents(&place.path("out"))["summary.json"], first["summary.json"]);
    fs::create_dir(place.path("notes")).unwrap();
    fs::write(place.path("notes/mine.txt"), "mine").unwrap();
    place.bad(2, "run rod.toml -o notes -q");
    assert_eq!(names(&place.path("notes")), ["mine.txt"]);
}

#[test]
fn a_run_over_its_own_report_leaves_it_alone_and_finds_what_was_changed() {
    let place = Place::new();
    place.good("run rod.toml -o out -q");
    let (first, timing) = (contents(&place.path("out")), place.path("out/timing.csv"));
    let seconds = fs::read(&timing).unwrap();
    assert!(place.good("run rod.toml -o out").contains("identical to the byte"));
    assert_eq!((contents(&place.path("out")), fs::read(&timing).unwrap()), (first, seconds));
    fs::write(place.path("out/measures.csv"), "changed").unwrap();
    assert!(place.bad(3, "run rod.toml -o out -q").contains("measures.csv"));
    let output = place.run("run rod.toml -o out");
    let said = String::from_utf8(output.stdout.clone()).unwrap();
    assert!(code(&output) == 3 && said.contains("efficiency") && said.contains("--overwrite"));
    assert_eq!(fs::read(place.path("out/measures.csv")).unwrap(), b"changed");
}
