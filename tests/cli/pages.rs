//! Contents and order of the pages of a run.

use crate::*;

/// A lamp in the open: one cell above it, and spheres about it whose intensity is the same everywhere.
const LAMP: &str = r#"
lumiduct = 1
title = "Lamp"
[sources.lamp.point]
flux_lm = 10
emission = "isotropic"
[sensors]
cell = { plane = { rectangle = { width_mm = 4, height_mm = 4 } }, at = { position_mm = [0, 0, 5], axis = [0, 0, -1] } }
all = { goniometer = { c_step_deg = 90, gamma_step_deg = 30 } }
[run]
paths = 100_000
estimator = "forward"
"#;

fn lamp() -> Place {
    let place = Place::new();
    fs::write(place.path("lamp.toml"), LAMP).unwrap();
    place
}

/// Where `words` begin on a page, which must contain them.
fn at(page: &str, words: &str) -> usize {
    page.find(words).unwrap_or_else(|| panic!("no {words} in {page}"))
}

#[test]
fn a_single_cell_has_no_map_and_no_uniformity() {
    let place = lamp();
    place.good("run lamp.toml -o out -q");
    assert!(!names(&place.path("out")).iter().any(|name| name == "cell.illuminance.png"));
    for name in ["report.md", "report.html"] {
        let page = fs::read_to_string(place.path("out").join(name)).unwrap();
        assert!(page.contains("cell.illuminance_avg"), "{page}");
        for absent in ["cell.uniformity_min_avg", "cell.cv", "cell.illuminance_max"] {
            assert!(!page.contains(absent), "{absent} in {name}");
        }
    }
    // Programs and checks still find them.
    assert!(place.summary("out")["measures"]["cell.uniformity_min_avg"].is_object());
}

#[test]
fn a_beam_without_an_edge_has_no_angle() {
    let place = lamp();
    let said = place.good("run lamp.toml -o out");
    assert!(said.contains("beam angle none"), "{said}");
    let page = fs::read_to_string(place.path("out/report.md")).unwrap();
    assert!(page.contains("| all.beam_angle | none ("), "{page}");
    assert_eq!(place.summary("out")["measures"]["all.beam_angle"]["value"], 360.0);
}

#[test]
fn a_page_goes_from_the_verdict_to_how_it_was_computed() {
    let place = Place::with("[[check]]\nmeasure = \"exit.efficiency\"\nmin = 0.5\n");
    place.good("run rod.toml -o out -q");
    let markdown = fs::read_to_string(place.path("out/report.md")).unwrap();
    let html = fs::read_to_string(place.path("out/report.html")).unwrap();
    let order = [
        "The check passed",
        "Checks",
        "Results",
        "Sensor exit",
        "Sensor far",
        "Scene",
        "Flux balance",
        "Computation",
        "Estimators",
        "Run",
    ];
    for (page, start, end) in [(&markdown, "# ", "\n"), (&html, ">", "<")] {
        let places: Vec<usize> =
            order[1..].iter().map(|title| at(page, &format!("{start}{title}{end}"))).collect();
        assert!(at(page, order[0]) < places[0] && places.is_sorted(), "{places:?}");
    }
    let words = ["forward", "pilot", "segments"];
    let first = words.map(|word| at(&markdown, word)).into_iter().min().unwrap();
    assert!(first > at(&markdown, "## Computation"), "jargon before its place: {markdown}");
}

/// The smallest PNG file: one pixel.
const PIXEL: &str = "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==";

#[test]
fn a_project_heads_its_report_with_logo_and_date_as_typed() {
    use base64::Engine;
    let place = Place::with(
        "[project]\nclient = \"Lamps & Sons\"\ndate = \"22 Nov\"\ndrawing = \"D-17\"\nlogo = \"art/logo.png\"\n",
    );
    fs::create_dir(place.path("art")).unwrap();
    let pixel = base64::engine::general_purpose::STANDARD.decode(PIXEL).unwrap();
    fs::write(place.path("art/logo.png"), &pixel).unwrap();
    place.good("run rod.toml -o out -q");
    let markdown = fs::read_to_string(place.path("out/report.md")).unwrap();
    assert!(at(&markdown, "Drawing: D-17") < at(&markdown, "## Results"), "{markdown}");
    assert!(markdown.contains("(project_logo.png)"), "{markdown}");
    assert_eq!(fs::read(place.path("out/project_logo.png")).unwrap(), pixel);
    // Templates escape slashes, which browsers read as slashes.
    let html = fs::read_to_string(place.path("out/report.html")).unwrap().replace("&#x2f;", "/");
    assert!(
        html.contains(&format!("data:image/png;base64,{PIXEL}")),
        "the logo is not on the page"
    );
    assert!(html.contains("Client: Lamps &amp; Sons") && html.contains("Date: 22 Nov"));
    let summary = place.summary("out");
    assert_eq!(summary["scene"]["project"]["client"], "Lamps & Sons");
    // A study of the scene has the same head, also when its parts are merged.
    let study = "lumiduct_study = 1\ntitle = \"How long?\"\nscene = \"rod.toml\"\nmeasures = [\"exit.efficiency\"]\nplan = \"grid\"\n\
                 [parameters.length]\nkeys = [\"solids.rod.cylinder.length_mm\"]\nvalues = [5, 10]\n[run]\npaths = 20_000\n";
    fs::write(place.path("study.toml"), study).unwrap();
    for part in ["1/2", "2/2"] {
        place.good(&format!("batch study.toml -q --shard {part} -o {}", part.replace('/', "of")));
    }
    place.good("merge 1of2 2of2 -o study");
    let page = |name: &str| fs::read_to_string(place.path("study").join(name)).unwrap();
    let html = page("study.html").replace("&#x2f;", "/");
    assert!(html.contains(&format!("data:image/png;base64,{PIXEL}")), "the study has no logo");
    assert!(html.contains("Client: Lamps &amp; Sons"), "{html}");
    let markdown = page("study.md");
    assert!(at(&markdown, "Client: Lamps & Sons · Date: 22 Nov") < at(&markdown, "## "));
    assert_eq!(fs::read(place.path("study/project_logo.png")).unwrap(), pixel);
    assert!(!page("study.json").contains(PIXEL) && page("study.json").contains("D-17"));
    // A different logo changes the pages.
    fs::write(place.path("art/logo.png"), [pixel, vec![0]].concat()).unwrap();
    place.good("run rod.toml -o other -q");
    assert_ne!(place.summary("other")["scene"]["hash"], summary["scene"]["hash"]);
}

#[test]
fn a_report_and_a_check_say_alike_what_was_simulated() {
    let place = Place::new();
    place.good("run rod.toml -o out -q");
    let markdown = fs::read_to_string(place.path("out/report.md")).unwrap();
    let html = fs::read_to_string(place.path("out/report.html")).unwrap();
    let check = place.good("check rod.toml");
    let told = [
        "cylinder, radius 2 mm, length 10 mm",
        "face rod.entry, gap 0.1 mm",
        "middle at [0, 0, −0.1] mm",
        "12.57 mm²",
        "1.49",
        "gamma step 10 deg",
        "etendue",
    ];
    for words in told {
        for (name, page) in [("report.md", &markdown), ("report.html", &html), ("check", &check)] {
            assert!(page.contains(words), "no {words} in {name}: {page}");
        }
    }
}

#[test]
fn a_check_counts_the_triangles_and_copies_of_a_mesh() {
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes");
    for (scene, counts) in [
        ("engraved_plate", "unit m, 2560000 triangles, 2000 copies;"),
        ("bent_rod_cad", "unit m, 6266 triangles;"),
    ] {
        let said = Place::new().good(&format!("check {scenes}/{scene}.toml"));
        assert!(said.contains(counts), "{said}");
    }
}

#[test]
fn a_scene_of_thousands_of_solids_is_summarised() {
    let place = Place::new();
    let box_at = |i: usize| {
        format!(
            "[solids.b{i}.box]\nsize_mm = [1, 1, 1]\nmedium = \"acrylic\"\nat = {{ position_mm = [{}, 30, 0] }}\n",
            2 * i
        )
    };
    let rod = fs::read_to_string(place.path("rod.toml")).unwrap();
    let many: String = (0..200).map(box_at).collect();
    fs::write(place.path("many.toml"), format!("{rod}{many}")).unwrap();
    let said = place.good("check many.toml");
    assert!(said.contains("solids: The first 40 of 201."), "{said}");
    assert!(said.contains("solid b38:") && !said.contains("solid b39:"), "{said}");
    assert!(said.lines().count() < 120, "{} lines", said.lines().count());
}
