//! The other commands.

use crate::*;

#[test]
fn a_check_lists_the_scene_and_draws_it() {
    let place = Place::new();
    let said = place.good("check rod.toml");
    for words in ["Short rod", "rod.exit", "12.57 mm²", "etendue", "rod.check.png"] {
        assert!(said.contains(words), "no {words} in {said}");
    }
    assert!(fs::read(place.path("rod.check.png")).unwrap().starts_with(b"\x89PNG"));
    place.good("check rod.toml");
    let longer = "check rod.toml -D solids.rod.cylinder.length_mm=20";
    place.good(longer);
    place.good(&format!("{longer} -o pictures/rod.png"));
    let longest = "check rod.toml -D solids.rod.cylinder.length_mm=40 -o pictures/rod.png";
    assert!(place.bad(2, longest).contains("--overwrite"));
    place.good(&format!("{longest} --overwrite"));
}

#[test]
fn a_check_tells_where_the_sun_stands() {
    // Reda & Andreas, Solar Position Algorithm (NREL/TP-560-34302, 2008), table A5.1: zenith 50.11162 deg, azimuth 194.34024 deg.
    let when = "when = { date = \"2003-10-17\", time = \"12:30:30\", utc_offset_h = -7, latitude_deg = 39.742476, \
                longitude_deg = -105.1786 }\naim = \"rod\"\n";
    let place = Place::with(&format!(
        "[sources.sun.sun]\nilluminance_lx = 1000\n{when}[sources.sky.sky]\nmodel = \"clear\"\nzenith_luminance_cd_m2 = 1\n{when}"
    ));
    let said = place.good("check rod.toml");
    let angles = "sun 39.89 deg above the horizon, azimuth 194.34 deg";
    assert_eq!(said.matches(angles).count(), 2, "{said}");
}

#[test]
fn luminaires_are_converted_and_described() {
    let place = Place::new();
    let lamp = "IESNA91\n[LUMINAIRE] lamp\n[_SITE] roof\nTILT=NONE\n2 500 1 3 2 1 2 0.1 0.6 0\n1 1 9\n0 45 90\n0 90\n300 200 0\n280 150 0\n";
    fs::write(place.path("lamp.ies"), lamp).unwrap();
    let said = place.good("convert lamp.ies out/lamp.ldt");
    for words in [
        "luminaire: lamp",
        "2 with 1000 lm",
        "four equal quadrants",
        "600 mm along C0",
        "EULUMDAT has no field for the texts of _SITE",
    ] {
        assert!(said.contains(words), "no {words} in {said}");
    }
    place.good("convert out/lamp.ldt back.ies");
    let description = |file: &str| place.good(&format!("convert {file}"));
    assert_eq!(description("back.ies"), description("lamp.ies"));
    fs::write(place.path("back.ies"), "other").unwrap();
    assert!(place.bad(2, "convert lamp.ies back.ies").contains("--overwrite"));
    let said = place.bad(2, "convert back.ies");
    assert!(said.contains("back.ies") && said.contains("line 1"), "{said}");
    assert!(place.bad(2, "convert lamp.ies lamp.txt").contains(".ies or .ldt"));
    // The edition of 2019, there and back.
    place.good("convert lamp.ies new.ies --edition 2019");
    let text = fs::read_to_string(place.path("new.ies")).unwrap();
    assert!(text.starts_with("IES:LM-63-2019\r\n") && text.contains("1 1.00001 9\r\n"), "{text}");
    let said = place.bad(2, "convert lamp.ies lamp.ldt --edition 2019");
    assert!(said.contains("for .ies files only"), "{said}");
    // TM-33 is written and not read; other files of that ending are BSDFs.
    let said = place.good("convert lamp.ies lamp.xml");
    for words in ["with its 2 lamps as one emitter of 1000 lm", "lamp.xml (TM-33)"] {
        assert!(said.contains(words), "no {words} in {said}");
    }
    let text = fs::read_to_string(place.path("lamp.xml")).unwrap();
    assert!(text.contains("<IntData h=\"270\" v=\"45\">150</IntData>\r\n"), "{text}");
    for (command, words) in [
        ("convert lamp.xml", "TM-33 files are only written"),
        ("convert lamp.xml new.ies --overwrite", "luminaires are read from .ies and .ldt"),
    ] {
        let said = place.bad(2, command);
        assert!(said.contains(words), "{said}");
    }
    let said = place.bad(2, "convert lamp.ies lamp.xml --edition 2019");
    assert!(said.contains("for .ies files only"), "{said}");
}

#[test]
fn a_run_writes_what_its_goniometer_measures_as_a_luminaire_file() {
    let place = Place::new();
    let said = place.good("run rod.toml --ies out/lamp.ies");
    let page = fs::read_to_string(place.path("reports/rod/report.md")).unwrap();
    assert!(page.contains("Luminous intensities in cd") && page.contains("\nfar: "), "{page}");
    assert!(said.contains("\nwritten: out/lamp.ies (IES)\n"), "{said}");
    assert!(said.contains("note: luminaire files of `far`: without the key `opening`"), "{said}");
    // The remarks of a file that the report does not have.
    let said = place.good("run rod.toml --ies lamp.xml --overwrite");
    assert!(said.contains("note: TM-33 file: TM-33 requires the date of the report"), "{said}");
    assert!(said.contains("written: lamp.xml (TM-33)"), "{said}");
    let said = place.good("convert out/lamp.ies out/lamp.ldt");
    assert!(said.contains("luminaire: Short rod"), "{said}");
    assert!(said.contains("planes: 2 from 0° to 180°"), "{said}");
    place.good("run rod.toml --ies out/lamp.ies --overwrite -q");
    assert!(place.bad(2, "run rod.toml -o b --ies out/lamp.ies").contains("--overwrite"));
    assert!(place.bad(2, "run rod.toml -o b --ies lamp.txt").contains(".ies or .ldt"));
    assert!(!place.path("b").exists(), "nothing is written");
    // The key has the details; light that goes up is remarked on.
    let with = |keys: &str| {
        let place = Place::new();
        let text = SCENE.replace("gamma_step_deg = 10 }", &format!("gamma_step_deg = 10{keys}"));
        fs::write(place.path("rod.toml"), text).unwrap();
        place
    };
    let keys = " }, luminaire = { formats = [\"ldt\", \"tm33\"], power_w = 2, opening = { disk = { radius_mm = 2 } } }";
    let place = with(keys);
    place.good("run rod.toml -q --ies lamp.ies");
    let folder = place.path("reports/rod");
    let tm33 = fs::read_to_string(folder.join("far.xml")).unwrap();
    assert!(tm33.contains("<Simulation>true</Simulation>"), "{tm33}");
    assert!(folder.join("far.ldt").exists() && !folder.join("far.ies").exists());
    let page = fs::read_to_string(folder.join("report.md")).unwrap();
    for words in
        ["far.ldt and far.xml: ", "lm/W", "a disk of 4 mm", "leaves above 90 deg", "0° to 90°"]
    {
        assert!(page.contains(words), "no {words} in {page}");
    }
    assert!(!page.contains("EN 12464-1"), "a flat opening cannot emit upward");
    assert!(!page.contains("less symmetric"), "the light of the rod is symmetric: {page}");
    // Its axis across the rod, the goniometer sees light on one side.
    let aside = "run rod.toml -o aside -q -D sensors.far.at={position_mm=[0,0,5],axis=[1,0,0]} -D sensors.far.luminaire.symmetry=\"rotational\"";
    place.good(aside);
    let page = fs::read_to_string(place.path("aside/report.md")).unwrap();
    assert!(
        page.contains("the light is less symmetric than `symmetry` says (rotational)"),
        "{page}"
    );
    assert!(fs::read_to_string(place.path("lamp.ies")).unwrap().contains("1 1 2\r\n"));
    let latest = with(" }, luminaire = { formats = [\"ies_2019\"], power_w = 2 }");
    latest.good("run rod.toml -q --ies lamp.ies");
    let files = [latest.path("lamp.ies"), latest.path("reports/rod/far.ies")];
    for text in files.map(|path| fs::read_to_string(path).unwrap()) {
        assert!(text.starts_with("IES:LM-63-2019\r\n"), "{text}");
        assert!(text.contains("1 1.00010 2\r\n"), "computed, not measured");
    }
    assert!(latest.good("convert lamp.ies").contains("intensities: computed"));
    let two = Place::with("[sensors.near]\ngoniometer = {}\n");
    assert!(two.bad(2, "run rod.toml --ies a.ies").contains("several goniometers"));
}

/// The scene with a sphere for its goniometer, and more keys of the sensor.
fn with_sphere(radius_mm: u32, keys: &str) -> Place {
    let place = Place::new();
    let sphere = format!("gamma_step_deg = 10, radius_mm = {radius_mm} }}{keys}");
    let text = SCENE.replace("gamma_step_deg = 10 }", &sphere);
    fs::write(place.path("rod.toml"), text).unwrap();
    place
}

#[test]
fn a_luminaire_file_of_a_sphere_states_its_distance() {
    let place = with_sphere(99, "");
    let said = errors(&place.run("run rod.toml --ies a.ies"));
    let remark = "its files have the intensities at a distance of 99 mm;";
    assert!(said.contains("sensors.far") && said.contains(remark), "{said}");
    assert!(!said.contains("lie within its sphere"), "{said}");
    let text = fs::read_to_string(place.path("a.ies")).unwrap();
    assert!(text.contains("at 99 mm, sensor far\r\n"), "{text}");
    assert!(text.contains("[OTHER] intensities: illuminance at a distance of 99 mm"), "{text}");

    let place = with_sphere(99, ", luminaire = { opening = { disk = { radius_mm = 2 } } }");
    let said = errors(&place.run("check rod.toml"));
    for words in [
        "24.75 times the largest dimension of the luminous opening",
        "a narrow beam may still differ",
    ] {
        assert!(said.contains(words), "no {words} in {said}");
    }
    place.good("run rod.toml -q");
    let page = fs::read_to_string(place.path("reports/rod/report.md")).unwrap();
    assert_eq!(page.matches("a narrow beam may still differ").count(), 1, "{page}");
    assert!(page.contains("An intensity is the illuminance at a distance of 99 mm"), "{page}");
    let ldt = fs::read_to_string(place.path("reports/rod/far.ldt")).unwrap();
    assert!(ldt.contains("at 99 mm, sensor far\r\n"), "{ldt}");

    let said = errors(&with_sphere(3, ", luminaire = {}").run("check rod.toml"));
    assert!(said.contains("all parts of the scene do not lie within its sphere"), "{said}");
    // Of several goniometers, the only one in the far field is written.
    let both = Place::with("[sensors.near]\ngoniometer = { radius_mm = 99 }\n");
    assert!(!errors(&both.run("run rod.toml --ies a.ies")).contains("at a distance of"));
    assert!(both.path("a.ies").exists());
}

#[test]
fn the_schema_is_json_with_a_title() {
    let schema: Value = serde_json::from_str(&Place::new().good("schema")).unwrap();
    assert!(!schema["title"].as_str().unwrap().is_empty());
    assert!(schema["properties"]["solids"].is_object());
}

#[test]
fn completions_and_the_manual_page_know_the_commands() {
    let place = Place::new();
    for arguments in ["completions bash", "completions zsh", "completions fish", "man"] {
        let text = place.good(arguments);
        assert!(text.contains("lumiduct") && text.contains("check"), "{arguments}");
    }
}

#[test]
fn a_list_finds_scenes_and_sensor_files_and_no_reports() {
    let place = Place::new();
    fs::write(place.path("cell.toml"), "plane = { cells = [1, 1] }\n").unwrap();
    place.good("run rod.toml -q");
    let said = place.good("list");
    assert!(said.contains("rod.toml") && said.contains("Short rod"), "{said}");
    assert!(said.contains("cell.toml") && said.contains("sensor file: plane"), "{said}");
    assert_eq!(said.lines().count(), 2, "{said}");
    fs::write(place.path("broken.toml"), "lumiduct = 1\ntitle =\n").unwrap();
    assert!(place.good("list").contains("not valid TOML"), "a broken scene is not passed over");
    assert!(place.bad(2, "list nowhere").contains("nowhere"));
}

#[test]
fn a_mesh_is_examined_and_one_that_is_no_solid_ends_with_1() {
    let place = Place::new();
    let block = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\n";
    fs::write(place.path("whole.obj"), format!("{block}f 1 4 3\n")).unwrap();
    fs::write(place.path("open.obj"), block).unwrap();
    let said = place.good("mesh whole.obj --unit cm");
    for words in ["a closed solid", "4 triangles", "166.7 mm³", "open edges", "all facets are flat"]
    {
        assert!(said.contains(words), "no {words} in {said}");
    }
    let output = place.run("mesh open.obj");
    assert_eq!(code(&output), 1);
    let said = String::from_utf8_lossy(&output.stdout);
    for words in ["NOT a solid", "open edges                         3, the first at ["] {
        assert!(said.contains(words), "no {words} in {said}");
    }
    assert!(place.bad(2, "mesh nowhere.obj").contains("nowhere.obj"));
    assert!(place.bad(2, "mesh rod.toml").contains(".toml"));
}

#[test]
fn a_check_is_cut_as_it_is_asked_and_writes_a_page() {
    let place = Place::new();
    let cut = |options: &str| {
        place.good(&format!("check rod.toml {options}"));
        fs::read(place.path("rod.check.png")).unwrap()
    };
    let usual = cut("");
    let mut seen = vec![usual.clone()];
    for options in ["--plane xy@z=5", "--plane yz", "--zoom rod.exit", "--zoom rod --up -x"] {
        let picture = cut(options);
        assert!(!seen.contains(&picture), "{options}: as before");
        seen.push(picture);
    }
    assert_eq!(cut(""), usual);
    let said = place.good("check rod.toml --html");
    assert!(said.contains("page: rod.check.html"), "{said}");
    let page = fs::read_to_string(place.path("rod.check.html")).unwrap();
    for words in ["Short rod", "Local axes", "rod.wall", "\"axes\":[{", "nothing was measured"] {
        assert!(page.contains(words), "{words}");
    }
    assert!(page.matches("\"group\":").count() >= 40, "paths");
    // A page at a given place is not replaced unless requested.
    place.good("check rod.toml --html -o shown.png");
    let longer = "check rod.toml --html -o shown.png -D solids.rod.cylinder.length_mm=20";
    assert!(place.bad(2, longer).contains("--overwrite"));
}

#[test]
fn a_cut_that_cannot_be_drawn_says_why() {
    let place = Place::new();
    let said = place.bad(2, "check rod.toml --zoom rod.exti");
    assert!(said.contains("rod.exti") && said.contains("rod.exit"), "{said}");
    assert!(place.bad(2, "check rod.toml --plane xz@x=5").contains("xz@y=5"));
    assert!(place.bad(2, "check rod.toml --up sideways").contains("try x"));
    let along = place.bad(2, "check rod.toml --plane xz --up y");
    assert!(along.contains("--up y") && along.contains("in that plane"), "{along}");
}

#[test]
fn the_library_names_its_entries_with_their_sources_and_scenes_use_them() {
    let place = Place::new();
    let said = place.good("library");
    for words in [
        "pmma: poly(methyl methacrylate)",
        "Abbe number",
        "Malitson",
        "CC0 1.0",
        "esr: multilayer polymer mirror film",
        "  { specular = { reflectance = 0.98 } }",
        "PerkinElmer",
        "smd_0603_120deg: chip LED 0603 (1.6 x 0.8 mm)",
        "{ viewing_angle_deg = 120 }",
    ] {
        assert!(said.contains(words), "no {words} in {said}");
    }
    let said = place.good("check rod.toml -D solids.rod.cylinder.medium=\"pc\"");
    assert!(said.contains("medium pc: index 1.5"), "{said}");
    let place = Place::with(
        "[sheets.screen.rectangle]\nwidth_mm = 9\nheight_mm = 9\nfinish = \"esr\"\nat = { position_mm = [0, 0, -5] }\n\
         [sources.chip.disk]\nradius_mm = 1\nflux_lm = 1\nemission = \"smd_0603_120deg\"\nat = { position_mm = [0, 0, -2] }\n",
    );
    let said = place.good("check rod.toml");
    assert!(said.contains("{ specular = { reflectance = 0.98 } }, of the library"), "{said}");
    assert!(said.contains("emission smd_0603_120deg"), "{said}");
}
