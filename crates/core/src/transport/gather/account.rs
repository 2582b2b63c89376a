//! How gathered values were computed, in words and numbers for a report.

use crate::plan::Estimator;
use crate::scene::{Scene, SensorId};
use crate::tally::sigmas;
use crate::transport::estimate::{Account, AccountEntry, Resolution};
use crate::transport::gather::bias::{Judged, best};
use crate::transport::gather::settings::GatherSettings;
use crate::transport::gather::stages::Orders;
use crate::transport::{Layout, Readings, Stage};
use lumiduct_base::number::{format_value, format_with_error};

/// Difference, in errors, between a gathered flux and that of photons above which there is a
/// warning.
const WORTH_A_REMARK: f64 = 4.0;

/// How the values of a sensor were computed; `None` before the first pass.
pub(crate) fn account(
    (scene, settings): (&Scene, &GatherSettings),
    estimator: Estimator,
    (stages, photons): (&[Stage], &Readings),
    id: SensorId,
) -> Option<Account> {
    let slots = Layout::new(scene).flux_slots(id);
    let judged = best(stages, photons, &slots)?;
    let Judged { stage, resolution, flux: value, .. } = judged;
    let sensor = scene.sensors[id.index()].name.clone();
    let by_photons = photons.sum(&slots);
    let off_photons =
        judged.off_photons.map(|[off, error]| sigmas(off, value.std_error().hypot(error), 0.0));
    let flux = format_with_error(by_photons.mean(), by_photons.std_error());
    let compared = off_photons.map(|off| {
        format!(
            "Photons of this run that reached the sensor itself carried {flux} {}: {:.1} standard errors from the value.",
            scene.unit.flux(),
            off.abs()
        )
    });
    let warning = off_photons.filter(|off| off.abs() > WORTH_A_REMARK).map(|off| {
        format!(
            "the gathered flux of sensor `{sensor}` is {:.1} standard errors {} the flux that photons of the same \
                run carried there ({flux}); its bias includes this difference: a feature of the light is smaller \
                than the windows; use a smaller radius_mm or angle_deg, or another estimator",
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
    let window = settings.window.of_stage(stage.number);
    format!(
        "Gathered at depth {}: the values come from stage {}, with {} passes and windows of {} mm and {} deg.",
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
            "Bias resolved: E0 and E1 differ, and E00 gives no sign that higher orders diverge. The value is E0, the estimate of fourth order."
        }
        Resolution::InNoise => {
            "Bias not resolved from noise: E0 and E1 agree within their errors. The value is E0, the estimate of fourth order."
        }
        Resolution::NotResolved => {
            "Bias not resolved: E0 and E1 differ, and higher orders do not converge, so that the light has a feature smaller \
                than the windows. The value is E0, the estimate of fourth order, and its bias is not a bound."
        }
    }
}

fn columns(scene: &Scene) -> Vec<String> {
    let e1 = format!("E1 in {}", scene.unit.flux());
    let names = ["stage", "passes", "gather paths", "radius in mm", "angle in deg", &e1];
    names.into_iter().chain(["E0", "E00"]).map(str::to_owned).collect()
}

/// A stage, and the flux of a sensor by each order.
fn row(settings: &GatherSettings, stage: &Stage, slots: &[usize]) -> Vec<AccountEntry> {
    let window = settings.window.of_stage(stage.number);
    let Orders { second, fourth, sixth } = Orders::of(&stage.counts);
    let measured = [second, fourth, sixth].map(|readings| {
        let flux = readings.sum(slots);
        AccountEntry::Measured { value: flux.mean(), std_error: flux.std_error() }
    });
    let own = [
        AccountEntry::Count(u64::from(stage.number)),
        AccountEntry::Count(second.batch_count()),
        AccountEntry::Count(settings.gather_paths(stage.number)),
        AccountEntry::Number(window.radius),
        AccountEntry::Number(window.theta_max.to_degrees()),
    ];
    own.into_iter().chain(measured).collect()
}
