//! The errors that runs state are those they have: over many seeds, deviations from the truth are as large.

use crate::connections::{LIT_DISC, flux_of_lit_disc};
use crate::trial::{Gathering, Way, load, measures_of_paths};
use lumiduct_core::measure;
use lumiduct_core::plan::RunPlan;
use lumiduct_core::scene::{SensorId, SourceId};
use lumiduct_core::transport::{Layout, Orders, Run};
use rayon::prelude::*;

/// Seeds of a comparison.
pub(crate) const SEEDS: u64 = 200;

/// Checks that deviations over stated errors, one for each seed from 1, have the mean 0 and this mean square.
pub(crate) fn assert_calibrated(
    what: &str,
    expected_square: f64,
    deviation: impl Fn(u64) -> f64 + Sync + Send,
) {
    let deviations: Vec<f64> = (1..=SEEDS).into_par_iter().map(deviation).collect();
    let mean_of =
        |power| deviations.iter().map(|z: &f64| z.powi(power)).sum::<f64>() / SEEDS as f64;
    let [mean, square] = [1, 2].map(mean_of);
    println!("{what}: mean {mean:.3}, mean square {square:.3} over {SEEDS} seeds");
    // Of normal deviations the mean has an error of 1/√n, the mean square of √(2/n).
    let error = (SEEDS as f64).sqrt().recip();
    assert!(mean.abs() < 4.0 * error, "{what}: {mean}");
    let off = square / expected_square - 1.0;
    assert!(off.abs() < 4.0 * 2f64.sqrt() * error, "{what}: {square}");
}

/// Waves of 4 passes of a gathered run.
const WAVES: u64 = 16;

/// Checks the stated errors of gathered runs of a scene with one sensor and one source, whose flux is known.
fn assert_gathered(what: &str, text: &str, way: Way, flux: f64) {
    let passes = 4.0 * WAVES as f64;
    let job = load(text, way);
    let slot = Layout::new(&job.scene).sensor_flux(SensorId::new(0), SourceId::new(0));
    // Of t with n - 1 degrees of freedom the mean square is (n - 1)/(n - 3).
    assert_calibrated(
        &format!("{}, {what}", way.name()),
        (passes - 1.0) / (passes - 3.0),
        |seed| {
            let mut run = Run::new(&job.scene, &RunPlan { seed, ..job.run.clone() });
            (0..WAVES).for_each(|_| run.next_wave());
            let findings = run.findings();
            let orders = Orders::of(&findings.others[0].stages[0].counts);
            orders.fourth.scalar(slot).sigmas_from(flux)
        },
    );
}

/// Light that fills a mirror tube: windows have no bias. Limited by records, by photons and by pairs, which four passes
/// share.
#[test]
fn errors_of_gathered_light_are_calibrated() {
    let text = r#"
[finishes]
mirror = { specular = { reflectance = 1 } }
[sheets.tube.tube]
profile = { circle = { radius_mm = 5 } }
path = [{ straight_mm = 12 }]
finish = "mirror"
[sources.lamp.disk]
radius_mm = 5
flux_lm = 10
[sensors]
exit = { plane = {}, on = "tube.exit", counts = "incident", side = "both" }
"#;
    for (limit, [records, photons]) in
        [("records", [10, 200]), ("photons", [200, 10]), ("pairs", [40, 40])]
    {
        let gathering = Gathering { depth: 1, radius_mm: 1.0, angle_deg: 10.0, records, photons };
        for way in [Way::Gather(gathering), Way::Merged(gathering)] {
            assert_gathered(&format!("limited by {limit}"), text, way, 10.0);
        }
    }
}

/// All five techniques at once, on light that is scattered by one disc.
#[test]
fn errors_of_merged_light_are_calibrated() {
    let gathering =
        Gathering { depth: 0, radius_mm: 0.5, angle_deg: 10.0, records: 100, photons: 100 };
    assert_gathered("lit disc", LIT_DISC, Way::Merged(gathering), flux_of_lit_disc());
}

/// Daylight from a lamp through a yellow filter, part of which goes beside the sensor: noise of places and of wavelengths.
#[test]
fn errors_of_coloured_light_are_calibrated() {
    let text = r#"
[finishes.yellow.specular]
reflectance = 0
transmittance = { by_nm = [[400, 0.0], [480, 0.1], [560, 0.8], [700, 0.9]] }
[sheets.filter.disk]
radius_mm = 4
finish = "yellow"
at = { position_mm = [0, 0, 1] }
[sources.lamp.disk]
radius_mm = 2
flux_lm = 10
spectrum = "cie_d65"
[sensors]
beyond = { plane = { disk = { radius_mm = 2 } }, at = { position_mm = [0.5, 0, 3], axis = [0, 0, -1] } }
"#;
    // Its errors are far smaller than those of a single wave.
    let truth = measures_of_paths(text, Way::Forward, 4_000_000).values;
    let job = load(text, Way::Forward);
    let runs: Vec<Vec<f64>> = (1..=SEEDS)
        .into_par_iter()
        .map(|seed| {
            let mut run = Run::new(&job.scene, &RunPlan { seed, ..job.run.clone() });
            run.next_wave();
            let found = measure::measure(&job.scene, &run.findings()).values;
            let sigmas = |name: &&str| {
                let [own, truth] = [&found[*name], &truth[*name]];
                (own.value - truth.value) / own.std_error.hypot(truth.std_error)
            };
            MEASURES.iter().map(sigmas).collect()
        })
        .collect();
    for (place, name) in MEASURES.iter().enumerate() {
        // Of t with 127 degrees of freedom.
        assert_calibrated(name, 127.0 / 125.0, |seed| runs[seed as usize - 1][place]);
    }
}

/// What is judged: a sum, and two ratios.
const MEASURES: [&str; 3] = ["beyond.flux", "beyond.colour_x", "beyond.colour_y"];
