//! Requests that cannot be met are refused, sensors in the dark read nothing, and threads change no bit.

use crate::trial::{Gathering, Way, findings, load};
use lumiduct::pipeline::{self, Output};
use lumiduct_core::measure::{self, Status};
use lumiduct_core::plan::Request;
use lumiduct_core::transport::Interrupt;
use lumiduct_input::Settings;
use lumiduct_report::Existing;

const ROD: &str = r#"
[media.acrylic]
index = 1.49
[solids.rod.cylinder]
radius_mm = 2
length_mm = 10
medium = "acrylic"
[finishes.rough]
gaussian = { sigma_deg = 3, reflectance = 0.3, transmittance = 0.5 }
[sheets.film.disk]
radius_mm = 3
finish = "rough"
at = { position_mm = [0, 0, 11] }
[sources.led.disk]
radius_mm = 1
at = { face = "rod.entry", gap_mm = 0.1 }
flux_lm = 10
[sensors]
exit = { plane = { cells = [4, 4] }, on = "rod.exit", counts = "leaving" }
far = { goniometer = { c_step_deg = 90, gamma_step_deg = 30 } }
"#;

fn gather() -> Way {
    Way::Gather(Gathering { records: 300, photons: 500, ..Gathering::to_depth(2) })
}

#[test]
fn findings_have_the_same_bits_on_any_number_of_threads() {
    let merged = Way::Merged(Gathering { records: 300, photons: 500, ..Gathering::to_depth(2) });
    let polished = ROD.replace("gaussian = { sigma_deg = 3,", "specular = {");
    for (way, text) in
        [(Way::Backward, ROD), (Way::Mixed, ROD), (gather(), ROD), (merged, &polished)]
    {
        let job = load(text, way);
        let found = [1, 2, 3, 8].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| serde_json::to_string(&findings(&job, way)).unwrap())
        });
        assert!(found[0].len() > 1000);
        for (other, threads) in found[1..].iter().zip([2, 3, 8]) {
            assert!(*other == found[0], "{} on {threads} threads", way.name());
        }
    }
}

#[test]
fn estimators_that_cannot_meet_a_source_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let scene = dir.path().join("scene.toml");
    for (source, why) in [
        ("point", "it is a point"),
        (
            "line]\nlength_mm = 2\n[sources.other.disk]\nradius_mm = 1\nflux_lm = 1\n[media",
            "it is a line",
        ),
        ("disk]\nradius_mm = 1\nemission = \"collimated\"\n[media", "it shines in one direction"),
    ] {
        let source = source.replacen("]\n", "]\nflux_lm = 1\n", 1);
        let source =
            if source == "point" { "point]\nflux_lm = 1\n[media".to_owned() } else { source };
        let text = format!(
            "lumiduct = 1\ntitle = \"Refused\"\n[sources.lamp.{source}]\n[sensors]\ncell = {{ plane = {{ disk = {{ radius_mm = 1 }} }}, at = {{ position_mm = [0, 0, 5] }} }}\n"
        );
        std::fs::write(&scene, text).unwrap();
        for estimator in [Request::Backward, Request::Gather] {
            let settings = Settings { estimator: Some(estimator), ..Settings::default() };
            let output = Output::new(Some(dir.path().join("report")), Existing::Replace);
            let refused =
                pipeline::run_one(&scene, &settings, &output, &Interrupt::default(), &mut |_| {});
            let message = refused.unwrap_err().to_string();
            let name = estimator.name();
            for word in [why, "lamp", name, "run.estimator"] {
                assert!(message.contains(word), "{name}, {why}: {message}");
            }
        }
    }
}

#[test]
fn a_sensor_that_sees_nothing_reads_nothing() {
    let text = format!(
        "{ROD}dark = {{ plane = {{ disk = {{ radius_mm = 1 }} }}, at = {{ position_mm = [0, 0, 40] }} }}\n"
    );
    for way in [Way::Backward, Way::Mixed, gather()] {
        let job = load(&text, way);
        let found = measure::measure(&job.scene, &findings(&job, way));
        let dark = &found.values["dark.flux"];
        assert_eq!((dark.value, dark.status), (0.0, Status::NoSignal), "{}: {dark}", way.name());
        assert!(found.values["exit.flux"].value > 1.0);
    }
}
