//! How gathered values were computed, in words and numbers for a report.

use crate::plan::Estimator;
use crate::scene::{Scene, SensorId};
use crate::transport::estimate::{Account, AccountEntry, Resolution};
use crate::transport::gather::bias::{Judged, best, chosen, total_error};
use crate::transport::gather::settings::GatherSettings;
use crate::transport::gather::stages::Windows;
use crate::transport::tally::readings::MIN_LIT_GROUPS;
use crate::transport::{Layout, Readings, Stage};
use lumiduct_base::number::{format_value, format_with_error};

/// Difference, in errors, between a gathered flux and that of photons above which there is a
/// warning.
const CONTRADICTED: f64 = 4.0;

/// How the values of a sensor were computed; `None` before the first pass.
pub(crate) fn account(
    (scene, settings): (&Scene, &GatherSettings),
    estimator: Estimator,
    (stages, photons): (&[Stage], &Readings),
    id: SensorId,
) -> Option<Account> {
    let slots = Layout::new(scene).flux_slots(id);
    let judged = best(stages, &slots)?;
    let Judged { stage, windows, resolution } = judged;
    let sensor = scene.sensors[id.index()].name.clone();
    let by_photons = photons.sum(&slots);
    let value = chosen(windows, resolution).sum(&slots).mean();
    let error = by_photons.std_error().hypot(total_error(windows, resolution, &slots) * value);
    let is_lit = |readings: &Readings| readings.lit_groups(&slots) >= MIN_LIT_GROUPS;
    let off_photons =
        (is_lit(photons) && is_lit(windows.narrow)).then(|| (value - by_photons.mean()) / error);
    let flux = format_with_error(by_photons.mean(), by_photons.std_error());
    let compared = off_photons.map(|off| {
        format!(
            "Photons of this run that reached the sensor itself carried {flux} {}: {:.1} errors from the value.",
            scene.unit.flux(),
            off.abs()
        )
    });
    let warning = off_photons.filter(|off| off.abs() > CONTRADICTED).map(|off| {
        format!(
            "the gathered flux of sensor `{sensor}` is {:.1} errors {} the flux that photons of the same \
                run carried there ({flux}): a feature of the light is smaller than the windows; use a \
                smaller radius_mm or angle_deg, or another estimator",
            off.abs(),
            if off > 0.0 { "above" } else { "below" },
        )
    });
    let own = format!("{} {}", origin(settings, stage), of_bias(resolution));
    Some(Account {
        sensor,
        estimator,
        resolution,
        off_photons,
        sentences: std::iter::once(own).chain(compared).collect(),
        columns: columns(scene),
        rows: stages.iter().map(|stage| row(settings, stage, &slots)).collect(),
        warning,
    })
}

/// Where the values come from.
fn origin(settings: &GatherSettings, stage: &Stage) -> String {
    let window = settings.last_pass(stage).window;
    format!(
        "Gathered at depth {}: the values come from stage {}, with {} passes and windows up to {} mm and {} deg.",
        settings.depth,
        stage.number,
        stage.counts.first().batch_count(),
        format_value(window.radius),
        format_value(window.theta_max.to_degrees())
    )
}

fn of_bias(resolution: Resolution) -> &'static str {
    match resolution {
        Resolution::Resolved => {
            "Bias resolved: it scales with the square of the window. The value is E0, which is free of such a bias."
        }
        Resolution::InNoise => {
            "Bias not resolved from noise: the windows agree within their errors. The value is E0, which is free of a bias that scales with the square of the window."
        }
        Resolution::NotResolved => {
            "Bias not resolved: the windows differ, but the bias does not scale with the square of their \
                size. The value is E3, that of the smallest window, and |E1 - E2| is not a bound."
        }
    }
}

fn columns(scene: &Scene) -> Vec<String> {
    let e1 = format!("E1 in {}", scene.unit.flux());
    let names = ["stage", "passes", "gather paths", "radius in mm", "angle in deg", &e1];
    names.into_iter().chain(["E2", "E3", "E0"]).map(str::to_owned).collect()
}

/// A stage, and the flux of a sensor within its nested windows.
fn row(settings: &GatherSettings, stage: &Stage, slots: &[usize]) -> Vec<AccountEntry> {
    let pass = settings.last_pass(stage);
    let Windows { wide, middle, narrow, extrapolated } = Windows::of(&stage.counts);
    let measured = [wide, middle, narrow, extrapolated].map(|readings| {
        let flux = readings.sum(slots);
        AccountEntry::Measured { value: flux.mean(), std_error: flux.std_error() }
    });
    let own = [
        AccountEntry::Count(u64::from(stage.number)),
        AccountEntry::Count(wide.batch_count()),
        AccountEntry::Count(pass.gather_paths),
        AccountEntry::Number(pass.window.radius),
        AccountEntry::Number(pass.window.theta_max.to_degrees()),
    ];
    own.into_iter().chain(measured).collect()
}
