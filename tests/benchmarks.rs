//! The benchmark scenes with exact values: each must pass its own checks, lose nothing and close its balance.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking and shows its figures"
)]

use lumiduct::input::{self, Settings};
use lumiduct::measure::Outcome;
use lumiduct::pipeline;
use lumiduct::transport::Interrupt;
use std::path::Path;

#[test]
fn benchmark_scenes_agree_with_their_exact_values_and_close_their_balance() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/validation");
    let mut failures = Vec::new();
    for name in
        ["b1_p10_r95", "b1_p10_r99", "b1_p100_r95", "b2_l60", "b2_l60_absorbing", "b3", "b4"]
    {
        let settings = Settings { paths: Some(1_000_000), ..Settings::default() };
        let job = input::load(&folder.join(format!("{name}.toml")), &settings).unwrap();
        let traced = pipeline::trace(&job, &Interrupt::default(), &mut |_| {});
        let report = pipeline::compose(&job, &traced.readings, traced.stop);
        let value = |measure: &str| report.measures.values[measure].value;
        if value("balance.leaked") != 0.0 || value("balance.residual").abs() > 1e-9 {
            failures.push(format!(
                "{name}: leaked {}, residual {}",
                value("balance.leaked"),
                value("balance.residual")
            ));
        }
        let flux = &report.measures.values["exit.flux"];
        for check in report.checks.iter().filter(|result| result.check.measure == "exit.flux") {
            let expected = check.check.equals.unwrap();
            let sigmas = (flux.value - expected) / flux.std_error;
            println!(
                "{name}: {} ± {}, expected {expected}, {sigmas:.2} sigmas",
                flux.value, flux.std_error
            );
            // The run must be good enough to notice a fault of half a percent.
            if sigmas.abs() > 4.0 || flux.std_error > 0.0025 * expected {
                failures.push(format!(
                    "{name}: {} ± {}, expected {expected}",
                    flux.value, flux.std_error
                ));
            }
        }
        assert!(
            report
                .checks
                .iter()
                .any(|r| r.check.measure == "exit.flux" && r.verdict.outcome != Outcome::Unknown)
        );
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}
