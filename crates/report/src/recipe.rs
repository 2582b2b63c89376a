//! Everything that determines the bytes of a report, which distinguishes a rerun over its own
//! report from a run over another one.

use crate::Manifest;
use crate::output::SUMMARY;
use lumiduct_core::plan::{Estimator, GatherPlan, NUMERICS, Request, RunPlan};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// The identity of a run: two runs of one recipe write the same bytes, with the same binary on the
/// same kind of machine. Its field names in files are fixed, independent of the code.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Recipe {
    /// Version of the numerics.
    #[serde(rename = "numerics")]
    pub numerics: u32,
    /// Identifies scene file, included files, meshes and overrides.
    #[serde(rename = "scene")]
    pub scene_hash: String,
    /// How it is traced, and when it stops.
    #[serde(rename = "plan")]
    pub plan: RunPlan,
}

/// Contents of the folder of a report.
#[derive(Debug, PartialEq)]
pub(crate) enum FoundIdentity {
    /// The whole report of a run.
    Report(Box<Recipe>),
    /// The report of a run that was stopped.
    Partial,
    /// A report without the identity of its run, as from older versions of the program.
    Older,
    /// Anything else.
    Other,
}

impl Recipe {
    /// The recipe of a scene and a plan, with the present numerics.
    pub fn new(scene_hash: &str, plan: &RunPlan) -> Self {
        Self { numerics: NUMERICS, scene_hash: scene_hash.to_owned(), plan: plan.clone() }
    }

    /// How a different recipe differs from this one.
    pub fn difference_of(&self, other: &Self) -> &'static str {
        let (plan, own) = (&other.plan, &self.plan);
        if other.numerics != self.numerics {
            "a report of another version of the program, with other numerics"
        } else if other.scene_hash != self.scene_hash {
            "a report of a different scene: the file, a file that it names, or -D differs"
        } else if method(plan) != method(own) {
            "a report with a different estimator or different estimator settings"
        } else if plan.seed != own.seed {
            "a report with a different seed"
        } else {
            "a report with different stop rules"
        }
    }
}

/// How light is estimated.
fn method(plan: &RunPlan) -> (Request, &[Option<Estimator>], GatherPlan) {
    (plan.estimator, &plan.sensor_estimators, plan.gather)
}

impl FoundIdentity {
    /// The contents of a folder that is not empty.
    pub(crate) fn read(folder: &Path) -> Self {
        let bytes = fs::read(folder.join(SUMMARY)).ok();
        let summary: Option<Value> = bytes.and_then(|bytes| serde_json::from_slice(&bytes).ok());
        let Some(run) = summary.as_ref().and_then(|summary| summary.get("run")) else {
            return Self::Other;
        };
        let Some(identity) = run.get("identity") else { return Self::Older };
        if Manifest::expect(folder).is_err() {
            return Self::Other;
        }
        if run.get("partial").and_then(Value::as_bool) != Some(false) {
            return Self::Partial;
        }
        match Recipe::deserialize(identity) {
            Ok(recipe) => Self::Report(Box::new(recipe)),
            Err(_) => Self::Older,
        }
    }
}
