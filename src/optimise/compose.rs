//! From what was found to the record of the report and to the scene that is ready to run.

use crate::optimise::bounds::{FoundFace, unrolled};
use crate::optimise::law::SizeLaw;
use crate::optimise::measure::Measurements;
use crate::optimise::search::SearchEnd;
use crate::pipeline::VERSION;
use lumiduct_base::error::Result;
use lumiduct_base::units::FluxUnit;
use lumiduct_core::plan::Request;
use lumiduct_core::scene::{Seeing, Sensor, SensorKind};
use lumiduct_input::{LawKind, LightTarget, Move, PatternFeedback, Vary, load, rewritten_scene};
use lumiduct_report::optimise::{JudgedStep, OptimisationIdentity, OptimisationReport};
use std::path::Path;

/// What was found, before it is composed.
pub(crate) struct Found {
    pub(crate) identity: OptimisationIdentity,
    pub(crate) end: SearchEnd,
    pub(crate) checks: Vec<JudgedStep>,
    /// The value of the key that varies; `None` for the scene as it is.
    pub(crate) setting: Option<String>,
}

/// The record that all pages and tables are made of.
pub(crate) fn report(
    measurements: &Measurements<'_>,
    found: Found,
    law: &SizeLaw,
) -> Result<OptimisationReport> {
    let Found { identity, end, checks, setting } = found;
    let (study, feedback) = (measurements.study, measurements.feedback);
    let line = setting.map(|setting| format!("{}={setting}", feedback.key));
    let design = load(&study.scene, &study.common.with(line))?;
    measurements.expect_unchanged(&design)?;
    let FoundFace { elements, shape, size_mm, is_round } =
        unrolled(&design.scene, &feedback.pattern);
    let sensor = &study.base.scene.sensors[feedback.sensor.index()];
    let (quantity, unit) = quantity(sensor, study.base.scene.unit);
    Ok(OptimisationReport {
        identity,
        version: VERSION.to_owned(),
        title: study.title.clone(),
        description: study.description.clone(),
        scene: study.base.name.clone(),
        overrides: study.common.overrides.clone(),
        pattern: feedback.pattern.clone(),
        key: feedback.key.clone(),
        length: length_name(feedback.vary).to_owned(),
        settings: settings(feedback, &study.base.run.estimator, study.base.run.seed),
        sensor: sensor.name.clone(),
        quantity: quantity.to_owned(),
        unit: unit.to_owned(),
        goal: feedback.min_over_max,
        zones: measurements.zones.described(),
        points_mm: law.points.clone(),
        steps: end.steps,
        best: end.best,
        checks,
        active_limits: end.active_limits,
        ending: end.ending,
        shape,
        face_mm: size_mm,
        is_round,
        elements,
    })
}

/// Name and unit of what a sensor measures.
fn quantity(sensor: &Sensor, unit: FluxUnit) -> (&'static str, &'static str) {
    let is_luminance = match &sensor.kind {
        SensorKind::Surface(surface) => match surface.seeing {
            Seeing::All => false,
            Seeing::Views(_) | Seeing::Pixels(_) => true,
        },
        SensorKind::Goniometer(_) => false,
    };
    if is_luminance {
        (unit.luminance_name(), unit.luminance())
    } else {
        (unit.illuminance_name(), unit.illuminance())
    }
}

fn length_name(vary: Vary) -> &'static str {
    match vary {
        Vary::Diameter => "diameter",
        Vary::Radius => "radius",
        Vary::Depth => "depth",
        Vary::Height => "height",
        Vary::Pitch => "pitch",
    }
}

/// The settings in words.
fn settings(feedback: &PatternFeedback, estimator: &Request, seed: u64) -> Vec<String> {
    let [from, to] = feedback.limits;
    let law = match feedback.law {
        LawKind::Table => "a table with a value for each zone".to_owned(),
        LawKind::Spline(knots) => format!("a monotone spline through {knots} points"),
    };
    let target = match &feedback.target {
        LightTarget::Uniform => "the same light in all zones",
        LightTarget::Profile(_) => "the light of a profile",
    };
    vec![
        format!("{} of `{}`, key `{}`", length_name(feedback.vary), feedback.pattern, feedback.key),
        format!("limits: {from} to {to} mm, bridges of at least {} mm", feedback.bridge),
        format!("law: {law}"),
        format!(
            "target: {target}, smallest over largest ratio of at least {}",
            feedback.min_over_max
        ),
        format!(
            "weights: {} for the deviations, {} for the efficiency `{}`",
            feedback.uniformity_weight, feedback.efficiency_weight, feedback.efficiency
        ),
        format!("share of a correction that a step makes: {}", feedback.damping),
        format!(
            "{} paths in the last measurements, estimator `{}`, seed {seed}; checks with seed {} and also by `{}`",
            feedback.paths,
            estimator.name(),
            seed.wrapping_add(1),
            feedback.check_estimator.name()
        ),
    ]
}

/// The scene with the result, ready to run from the folder of the results: its name and its text.
pub(crate) fn found_scene(
    measurements: &Measurements<'_>,
    report: &OptimisationReport,
    setting: Option<&str>,
) -> Result<(String, String)> {
    let study = measurements.study;
    let line = setting.map(|setting| format!("{}={setting}", measurements.feedback.key));
    let way =
        Move { from: study.scene.parent().unwrap_or(Path::new("")), to: measurements.store.path() };
    let comment = [
        format!(
            "Found by the optimisation `{}` (digest {}): {}.",
            study.name,
            study.hash,
            report.ending.words()
        ),
        match setting {
            Some(_) => format!(
                "It is the scene `{}` with another {} of `{}`.",
                study.base.name, report.length, report.pattern
            ),
            None => format!(
                "It is the scene `{}` as it was: no better design was found.",
                study.base.name
            ),
        },
    ];
    let overrides = study.common.with(line).overrides;
    let text = rewritten_scene(&study.base.text, &overrides, way, &comment)?;
    Ok((format!("{}_optimised.toml", study.base.name), text))
}
