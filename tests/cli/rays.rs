//! Ray files: written by a run, converted, thinned and traced again.

use crate::{Place, code, errors};
use std::fs;

const LAMP: &str = r#"
lumiduct = 1
title = "A lamp"
[sources.lamp.disk]
radius_mm = 1
flux_lm = 2
[sensors.above]
plane = { rectangle = { width_mm = 4, height_mm = 4 } }
at = { position_mm = [0, 0, 1], axis = [0, 0, -1] }
rays = { count = 2000, formats = ["tm25", "zemax", "csv"] }
[run]
paths = 20_000
estimator = "forward"
"#;

#[test]
fn a_run_writes_rays_that_are_converted_thinned_and_traced_again() {
    let place = Place::new();
    fs::write(place.path("lamp.toml"), LAMP).unwrap();
    place.good("run lamp.toml");
    let report = "reports/lamp/above";
    let flux = place.summary("reports/lamp")["measures"]["above.flux"]["value"].as_f64().unwrap();
    let page = fs::read_to_string(place.path("reports/lamp/report.md")).unwrap();
    assert!(page.contains("above.tm25ray and above.sdf and above.rays.csv: 2000 rays"), "{page}");
    for ending in ["tm25ray", "sdf", "rays.csv"] {
        let said = place.good(&format!("convert {report}.{ending}"));
        assert!(said.contains("rays: 2000\n") && said.contains("z 1 to 1 mm"), "{said}");
        assert!(said.contains("mean direction: "), "{said}");
    }
    // The same bytes by another way, and again.
    place.good(&format!("convert {report}.tm25ray out/again.dat"));
    place.good("convert out/again.dat out/again.csv");
    place.good("convert out/again.csv out/last.dat");
    let rays = |file: &str| fs::read(place.path(file)).unwrap()[208..].to_vec();
    assert!(rays("out/again.dat") == rays("out/last.dat"));
    assert!(rays("out/again.dat") == rays(&format!("{report}.sdf")));
    let said = place.good(&format!("convert {report}.tm25ray out/few.csv --rays 100 --seed 3"));
    assert!(said.contains("rays: 100\n"), "{said}");
    assert!(place.bad(2, "convert out/again.csv out/few.csv").contains("--overwrite"));
    assert!(place.bad(2, "convert lamp.ies --rays 3").contains("not a ray file"));
    assert!(place.bad(2, "convert out/few.csv out/few.ies").contains(".tm25ray"));
    let damaged = fs::read(place.path("out/last.dat")).unwrap();
    fs::write(place.path("short.dat"), &damaged[..300]).unwrap();
    assert!(place.bad(2, "convert short.dat short.csv").contains("promises 2000 rays"));
    assert!(!place.path("short.csv").exists());

    let next = "lumiduct = 1\ntitle = \"Next\"\n[sources.lamp.rays]\nfile = \"reports/lamp/above.tm25ray\"\nmax_rays = 1500\n\
         [sensors.above]\nplane = { rectangle = { width_mm = 40, height_mm = 40 } }\nat = { position_mm = [0, 0, 1.5], axis = [0, 0, -1] }\n";
    fs::write(place.path("next.toml"), next).unwrap();
    let output = place.run("run next.toml --paths 4000 --estimator forward");
    assert_eq!(code(&output), 0);
    assert!(errors(&output).contains("1500 of its 2000 rays"), "{}", errors(&output));
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(
        !said.contains("1500 of its 2000 rays"),
        "remarks on the scene are printed once: {said}"
    );
    let summary = place.summary("reports/next");
    let again = summary["measures"]["balance.emitted"]["value"].as_f64().unwrap();
    assert!((again / flux - 1.0).abs() < 1e-6, "{again} {flux}");
    assert!(summary["warnings"].to_string().contains("a sample of the lamp"), "{summary}");
    let said = place.bad(2, "run next.toml --estimator gather -o out/gather");
    assert!(said.contains("a set of rays"), "{said}");
}

#[test]
fn convert_remarks_on_a_header_that_contradicts_its_rays_and_writes_what_can_be_read() {
    let place = Place::new();
    let table = |fluxes: &[&str]| -> String {
        let rows = fluxes.iter().map(|flux| format!("0,0,0,0,0,1,{flux}\n"));
        "x_mm,y_mm,z_mm,dx,dy,dz,flux_lm\n".to_owned() + &rows.collect::<String>()
    };
    fs::write(place.path("a.csv"), table(&["1", "2"])).unwrap();
    let said = place.good("convert a.csv a.tm25ray");
    assert!(!said.contains("remark"), "{said}");
    let mut file = fs::read(place.path("a.tm25ray")).unwrap();
    file[12..16].copy_from_slice(&4f32.to_le_bytes());
    fs::write(place.path("b.tm25ray"), &file).unwrap();
    for arguments in ["convert b.tm25ray", "convert b.tm25ray b.csv --rays 1"] {
        let said = place.good(arguments);
        let remark = "remark: its header states 4 lm, 33.33 % from the 3 lm of its rays";
        assert_eq!(said.matches(remark).count(), 1, "{said}");
    }
    fs::write(place.path("bright.csv"), table(&["1e38"; 4])).unwrap();
    let said = place.bad(2, "convert bright.csv bright.tm25ray");
    assert!(said.contains("bright.csv: ") && said.contains("line 2: its flux is 1e38"), "{said}");
    assert!(!place.path("bright.tm25ray").exists());
    fs::write(place.path("most.csv"), table(&["1e30"; 4])).unwrap();
    place.good("convert most.csv most.tm25ray");
    let said = place.good("convert most.tm25ray most.sdf");
    assert!(said.contains("rays: 4\n") && !said.contains("remark"), "{said}");
    place.good("convert most.sdf");
}

#[test]
fn a_sensor_that_few_photons_reach_writes_fewer_rays_or_none() {
    let place = Place::new();
    let small = LAMP.replace("width_mm = 4, height_mm = 4", "width_mm = 0.05, height_mm = 0.05");
    fs::write(place.path("small.toml"), &small).unwrap();
    let said = place.good("run small.toml");
    assert!(said.contains("rays requested"), "{said}");
    assert!(place.path("reports/small/above.tm25ray").exists());
    fs::write(place.path("dark.toml"), small.replace("axis = [0, 0, -1]", "axis = [0, 0, 1]"))
        .unwrap();
    let said = place.good("run dark.toml");
    assert!(said.contains("no ray file is written"), "{said}");
    assert!(!place.path("reports/dark/above.tm25ray").exists());
}
