//! What a scene file says, key by key: a mirror of the file in types.
//!
//! The JSON Schema, the page `docs/scene_format.md` and the validation of a file are all made from these types, so
//! the comments here are read by users. Nothing is computed here, and no rule that spans several keys is known here
//! (see `input::lower`).

use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub(crate) mod coating;
pub(crate) mod daylight;
pub(crate) mod finish;
pub(crate) mod luminaire;
pub(crate) mod medium;
pub(crate) mod optimise;
pub(crate) mod pattern;
pub(crate) mod placement;
pub(crate) mod rays;
pub(crate) mod relief;
pub(crate) mod run;
pub(crate) mod sensor;
pub(crate) mod sheet;
pub(crate) mod solid;
pub(crate) mod source;
pub(crate) mod spectrum;
pub(crate) mod study;
pub(crate) mod sweep;

use finish::FinishSpec;
use lumiduct_core::plan::Check;
use medium::MediumSpec;
use pattern::PatternSpec;
use relief::ReliefSpec;
use run::RunSpec;
use sensor::SensorSpec;
use sheet::SheetSpec;
use solid::SolidSpec;
use source::{EmissionSpec, SourceSpec};

/// The version of the format that this program reads.
pub(crate) const FORMAT_VERSION: u32 = 1;

/// A scene: a light guide, its sources, its sensors and the expected results.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "Lumiduct scene")]
pub struct SceneSpec {
    /// Version of the scene format.
    #[schemars(extend("const" = 1))]
    pub lumiduct: u32,
    /// One line that names the scene in reports.
    pub title: String,
    /// What the scene is for, in any number of lines.
    pub description: Option<String>,
    /// Project data for the head of the report.
    pub project: Option<ProjectSpec>,
    /// Folder of your own library, relative to this file, with `media.toml`, `finishes.toml` and `emissions.toml` or some of them. An entry `[NAME]`
    /// has the keys of `media.NAME`, `finishes.NAME` or `emissions.NAME`, and may have the texts `description`, `source` and `licence`, a medium also
    /// `range_nm`, which are for readers. Entries of the scene replace those of the folder of the same name, and these replace those that
    /// `lumiduct library` lists. The hash of the scene contains these files as they are.
    pub library: Option<String>,
    /// Name of the medium outside every solid.
    #[serde(default = "air")]
    pub surroundings: String,
    /// Direction to the zenith, for `sun` and `sky`; any length but zero.
    #[serde(default = "plus_z")]
    pub up: [f64; 3],
    /// Direction to the north, or one above or below it.
    #[serde(default = "plus_y")]
    pub north: [f64; 3],
    /// Transparent media by name.
    #[serde(default)]
    pub media: IndexMap<String, MediumSpec>,
    /// Finishes by name: what a face does to light.
    #[serde(default)]
    pub finishes: IndexMap<String, FinishSpec>,
    /// Closed bodies by name, each filled with a medium.
    #[serde(default)]
    pub solids: IndexMap<String, SolidSpec>,
    /// Open surfaces by name: mirrors, baffles, hollow tubes and reflectors.
    #[serde(default)]
    pub sheets: IndexMap<String, SheetSpec>,
    /// Holes, dots and patches on faces by name.
    #[serde(default)]
    pub patterns: IndexMap<String, PatternSpec>,
    /// Dimples, grooves and the like on walls of solids, by name.
    #[serde(default)]
    pub reliefs: IndexMap<String, ReliefSpec>,
    /// Emissions by name: how light of a source is spread over directions.
    #[serde(default)]
    pub emissions: IndexMap<String, EmissionSpec>,
    /// Light sources by name.
    #[serde(default)]
    pub sources: IndexMap<String, SourceSpec>,
    /// Sensors by name.
    #[serde(default)]
    pub sensors: IndexMap<String, SensorSpec>,
    /// How long to compute, and with which random numbers.
    #[serde(default)]
    pub run: RunSpec,
    /// What is expected of the results, in any number of `[[check]]` tables.
    #[serde(default)]
    pub check: Vec<Check>,
}

/// The head of the report.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct ProjectSpec {
    /// Whom the report is for.
    pub client: Option<String>,
    /// Who made it.
    pub author: Option<String>,
    /// A date, shown as it is written here: reports do not read the clock.
    pub date: Option<String>,
    /// Number of the drawing from which the scene was made.
    pub drawing: Option<String>,
    /// A PNG file of at most 1 MB that is shown at the head of the page; relative to this file.
    pub logo: Option<String>,
}

/// Default medium.
pub(crate) const AIR: &str = "air";

/// Default direction up.
pub(crate) const UP: [f64; 3] = [0.0, 0.0, 1.0];

/// Default direction north.
pub(crate) const NORTH: [f64; 3] = [0.0, 1.0, 0.0];

/// Media that need no definition.
pub(crate) const PREDEFINED_MEDIA: [&str; 1] = [AIR];

/// Finishes that need no definition.
pub(crate) const PREDEFINED_FINISHES: [&str; 3] = ["polished", "black", "open"];

fn air() -> String {
    AIR.into()
}

fn plus_z() -> [f64; 3] {
    UP
}

fn plus_y() -> [f64; 3] {
    NORTH
}
