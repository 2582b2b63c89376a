//! Light groups, dark sources, weathers, and returning light: how they are reported.

use crate::Place;
use std::fs;

/// Two lamps over two ports, each with its own wall.
const LAMPS: &str = r#"
lumiduct = 1
title = "Two lamps"
[sources]
left.disk = { radius_mm = 1, flux_lm = 2 }
right.disk = { radius_mm = 1, flux_lm = 1, at = { position_mm = [10, 0, 0] } }
[sensors]
below_left = { plane = { disk = { radius_mm = 2 } }, at = { position_mm = [0, 0, 3] }, side = "back" }
below_right = { plane = { disk = { radius_mm = 2 } }, at = { position_mm = [10, 0, 3] }, side = "back" }
[run]
paths = 20_000
"#;

/// A tube under an overcast sky, a clear one and its sun.
const WEATHERS: &str = r#"
lumiduct = 1
title = "Three lights, two weathers"
[finishes.mirror]
specular = { reflectance = 0.9 }
[sheets.duct.tube]
profile = { circle = { radius_mm = 5 } }
path = [{ straight_mm = 20 }]
finish = "mirror"
at = { axis = [0, 0, -1] }
[sources]
overcast.sky = { model = "overcast", horizontal_illuminance_lx = 10_000, aim = "duct.entry" }
clear.sky = { model = "clear", horizontal_illuminance_lx = 12_000, aim = "duct.entry", elevation_deg = 60 }
sun.sun = { illuminance_lx = 85_000, aim = "duct.entry", elevation_deg = 60 }
[sensors]
exit = { plane = { cells = [2, 2] }, on = "duct.exit", counts = "leaving", entering = "duct.entry" }
[run]
paths = 20_000
estimator = "forward"
"#;

fn page(place: &Place, name: &str) -> String {
    fs::read_to_string(place.path(&format!("reports/{name}/report.md"))).unwrap()
}

#[test]
fn each_lamp_has_its_efficiency_and_its_crosstalk() {
    let place = Place::new();
    fs::write(place.path("lamps.toml"), LAMPS).unwrap();
    let said = place.good("run lamps.toml");
    assert!(said.contains("    from left: efficiency 0."), "{said}");
    assert!(said.contains(" of the light on below_right\n"), "{said}");
    let page = page(&place, "lamps");
    assert!(page.contains("| sensor |  | left | right |"), "{page}");
    assert!(page.contains("| below_left | efficiency | 0."), "{page}");
    assert!(page.contains("| below_right | share | 0."), "{page}");
    let measures = &place.summary("reports/lamps")["measures"];
    let value = |name: &str| measures[name]["value"].as_f64().unwrap();
    let shares = value("below_left.share.from.left") + value("below_left.share.from.right");
    assert!((shares - 1.0).abs() < 1e-9, "{shares}");
    assert!(value("below_left.share.from.right") < 0.1);
}

#[test]
fn each_light_group_has_maps_pages_and_differences_of_its_own() {
    let place = Place::new();
    let lamps = LAMPS
        .replace("flux_lm = 2", "flux_lm = 2, group = \"red\"")
        .replace("flux_lm = 1,", "flux_lm = 1, group = \"green\",")
        .replace("disk = { radius_mm = 2 } }", "disk = { radius_mm = 2 }, cells = [3, 3] }")
        + "[sensors.far]\ngoniometer = { c_step_deg = 90, gamma_step_deg = 30 }\n";
    fs::write(place.path("lamps.toml"), lamps).unwrap();
    place.good("run lamps.toml");
    let page = page(&place, "lamps");
    for text in [
        "![illuminance from red](below_left.illuminance.from_red.png)",
        "![intensity from green, far field](far.intensity.from_green.png)",
        "| below_right | uniformity min/avg | ",
    ] {
        assert!(page.contains(text), "{text}: {page}");
    }
    let at = |text: &str| page.find(text).unwrap();
    assert!(at("(below_left.illuminance.png)") < at("(below_left.illuminance.from_red.png)"));
    let html = fs::read_to_string(place.path("reports/lamps/report.html")).unwrap();
    assert!(html.contains("below_left: illuminance from red"));
    assert!(html.contains("far: intensity from green"));
    let matrix = place.path("reports/lamps/below_left.illuminance.from_green.matrix.csv");
    assert!(fs::read_to_string(matrix).unwrap().contains("illuminance in lx"));
    assert!(place.path("reports/lamps/far.intensity.from_red.csv").exists());
    let arrays = fs::read(place.path("reports/lamps/below_left.npz")).unwrap();
    for name in ["illuminance_lx.npy", "illuminance.from_red.std_error_lx.npy", "u_edges_mm.npy"] {
        assert!(arrays.windows(name.len()).any(|bytes| bytes == name.as_bytes()), "no {name}");
    }
    let summary = place.summary("reports/lamps");
    let even = &summary["measures"]["below_left.uniformity_min_avg.from.red"]["value"];
    assert!(even.as_f64().is_some_and(|even| even > 0.0 && even <= 1.0), "{even}");
    place.good("run lamps.toml --seed 2 -o other");
    place.good("diff reports/lamps other -o difference");
    for picture in ["below_left.illuminance.from_red", "far.intensity.from_green"] {
        let path = place.path(&format!("difference/{picture}.difference.png"));
        assert!(path.exists(), "{picture}");
    }
}

#[test]
fn a_lamp_that_is_off_is_dark_and_a_scene_without_light_is_refused() {
    let place = Place::new();
    fs::write(place.path("lamps.toml"), LAMPS).unwrap();
    for dark in ["sources.right.disk.enabled=false", "sources.right.disk.flux_lm=0"] {
        for estimator in ["forward", "backward", "mix", "gather", "mis", "auto"] {
            let out = format!("{estimator}{}", dark.len());
            place.good(&format!(
                "run lamps.toml -D {dark} --estimator {estimator} -o reports/{out} -q"
            ));
            let summary = place.summary(&format!("reports/{out}"));
            let measures = &summary["measures"];
            assert_eq!(measures["below_left.flux.from.right"]["value"], 0.0, "{out}");
            assert_eq!(measures["below_left.flux.from.right"]["std_error"], 0.0, "{out}");
            let flux = measures["below_left.flux.from.left"]["value"].as_f64().unwrap();
            assert!(flux > 0.1 && flux < 2.0, "{out}: {flux}");
            let efficiency = measures["below_left.efficiency"]["value"].as_f64().unwrap();
            assert!((efficiency - 0.5 * flux).abs() < 1e-12, "{out}: {efficiency}");
            let pages = ["report.md", "report.html"];
            for page in pages.map(|name| place.path(&format!("reports/{out}/{name}"))) {
                assert!(!fs::read_to_string(page).unwrap().contains("NaN"), "{out}");
            }
        }
    }
    let both = "run lamps.toml -D sources.left.disk.flux_lm=0 -D sources.right.disk.enabled=false";
    let said = place.bad(2, both);
    assert!(said.contains("lamps.toml:4: `sources`: nothing emits light: every source"), "{said}");
    fs::write(place.path("none.toml"), "lumiduct = 1\ntitle = \"Dark\"\n[sensors]\n").unwrap();
    let said = place.bad(2, "run none.toml");
    assert!(said.contains("none.toml:1: `sources`: nothing emits light"), "{said}");
}

#[test]
fn no_page_adds_weathers_up_without_saying_so() {
    let place = Place::new();
    fs::write(place.path("tube.toml"), WEATHERS).unwrap();
    let said = place.good("run tube.toml");
    assert!(said.contains("(sum over 2 weathers)"), "{said}");
    assert!(said.contains("never occur together (overcast, clear_and_sun)"), "{said}");
    assert!(said.contains("from clear_and_sun: efficiency 0."), "{said}");
    let page = page(&place, "tube");
    assert!(page.contains("| value ± standard error, sum over 2 weathers |"), "{page}");
    assert!(page.contains("![illuminance, sum over 2 weathers]"), "{page}");
    assert!(page.contains("![illuminance from clear_and_sun]"), "{page}");
    assert!(page.contains("`from` in its name is a sum over 2 weathers"), "{page}");
    let html = fs::read_to_string(place.path("reports/tube/report.html")).unwrap();
    assert!(html.contains("value ± standard error, sum over 2 weathers"));
    let summary = place.summary("reports/tube");
    assert_eq!(summary["sum_over_weathers"], serde_json::json!(["overcast", "clear_and_sun"]));
    let value = |name: &str| summary["measures"][name]["value"].as_f64().unwrap();
    let sum = value("exit.flux.from.clear") + value("exit.flux.from.sun");
    assert!((value("exit.flux.from.clear_and_sun") / sum - 1.0).abs() < 1e-12);
    assert!(summary["measures"].get("exit.share.from.sun").is_none());
    // A single weather, by the scene file or because the others are off, is not a sum.
    for one in [
        "overcast.sky.enabled=false",
        "overcast.sky.group=\"day\" -D sources.clear.sky.group=\"day\"",
    ] {
        let said = place.good(&format!("run tube.toml --overwrite -D sources.{one}"));
        assert!(!said.contains("sum over"), "{said}");
    }
}

#[test]
fn light_that_passes_twice_is_remarked_and_counts_once_if_asked() {
    let place = Place::new();
    let scene = r#"
lumiduct = 1
title = "Open bend"
[finishes.mirror]
specular = { reflectance = 1 }
[sheets.duct.tube]
profile = { rectangle = { width_mm = 10, height_mm = 10 } }
path = [{ bend_deg = 270, radius_mm = 10 }]
finish = "mirror"
[sources.led.face]
of = "duct.entry"
side = "back"
flux_lm = 1
[sensors]
exit = { plane = {}, on = "duct.exit", counts = "leaving", entering = "duct.entry" }
[run]
paths = 200_000
"#;
    fs::write(place.path("bend.toml"), scene).unwrap();
    let said = place.good("run bend.toml");
    assert!(said.contains("the efficiency of sensor `exit` is 1.1"), "{said}");
    assert!(said.contains("write passage = \"first\" in sensors.exit"), "{said}");
    let said = place.good("run bend.toml --overwrite -D sensors.exit.passage=\"first\"");
    assert!(!said.contains("more than once"), "{said}");
    assert!(said.contains("efficiency 1 ± 0") || said.contains("efficiency 1.0"), "{said}");
    for estimator in ["gather", "mis"] {
        let said = place.bad(
            2,
            &format!(
                "run bend.toml --estimator {estimator} -D sensors.exit.passage=\"first\" -o out"
            ),
        );
        assert!(said.contains(&format!("`{estimator}` cannot count first passages")), "{said}");
    }
    let said = place.bad(
        2,
        "compare bend.toml --estimators forward,sppm --time 1s -D sensors.exit.passage=\"first\"",
    );
    assert!(said.contains("sppm cannot count first passages"), "{said}");
}

#[test]
fn estimators_with_records_refuse_to_follow_polarisation() {
    let place = Place::new();
    let followed = "-D run.polarisation=\"followed\"";
    for estimator in ["gather", "mis"] {
        let said = place.bad(2, &format!("run rod.toml --estimator {estimator} {followed}"));
        assert!(said.contains(&format!("`{estimator}` cannot follow polarisation")), "{said}");
        assert!(said.contains("use `auto`, `forward`, `backward` or `mix`"), "{said}");
    }
    let said = place
        .bad(2, &format!("compare rod.toml --estimators forward,backward --time 1s {followed}"));
    assert!(said.contains("methods are compared without polarisation"), "{said}");
    // A pilot tries only those that can.
    place.good(&format!("run rod.toml {followed} --paths 20k -o out"));
    let report = fs::read_to_string(place.path("out/report.md")).unwrap();
    assert!(report.contains("polarisation is followed"), "{report}");
    assert!(!report.contains("treated as unpolarised"), "{report}");
    let summary = fs::read_to_string(place.path("out/summary.json")).unwrap();
    assert!(summary.contains("\"polarisation\": \"followed\""), "{summary}");
}
