//! What decides the bytes of a report, so that a run over its own report is told from a run over another one.

use crate::report::SUMMARY;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Two runs of one recipe write the same bytes, with the same binary on the same kind of machine.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Recipe {
    /// Version of the program.
    pub version: String,
    /// Identifies scene file, included files, meshes and overrides.
    pub scene_hash: String,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Name of the estimator that was asked for.
    pub estimator: String,
    /// Wishes for the gather estimator, in words.
    pub gather: String,
    /// The stop rules, in words.
    pub asked: String,
}

impl Recipe {
    /// How another recipe, which is not the same, differs from this one.
    pub(crate) fn difference_of(&self, other: &Self) -> &'static str {
        if other.version != self.version {
            "a report by another version of the program"
        } else if other.scene_hash != self.scene_hash {
            "a report of another scene: the file, a file that it names, or -D differs"
        } else if (&other.estimator, &other.gather) != (&self.estimator, &self.gather) {
            "a report with another estimator or other wishes for it"
        } else if other.seed != self.seed {
            "a report with another seed"
        } else {
            "a report with other stop rules"
        }
    }

    /// The recipe of the report in a folder; `None` if there is no report, or a partial one.
    pub(crate) fn read(folder: &Path) -> Option<Self> {
        let summary: Value = serde_json::from_slice(&fs::read(folder.join(SUMMARY)).ok()?).ok()?;
        let text = |place| summary.pointer(place).and_then(Value::as_str).map(str::to_owned);
        if summary.pointer("/run/partial")?.as_bool()? {
            return None;
        }
        Some(Self {
            version: text("/run/version")?,
            scene_hash: text("/scene/hash")?,
            seed: summary.pointer("/run/seed")?.as_u64()?,
            estimator: text("/run/estimator")?,
            gather: text("/run/gather").unwrap_or_default(),
            asked: text("/run/asked")?,
        })
    }
}
