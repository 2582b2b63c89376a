//! Ray files as a scene file states them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::spec::daylight::enabled;
use crate::spec::placement::{ContactSpec, PlacementSpec};
use crate::spec::spectrum::SpectrumSpec;

/// Ray files of the light that a sensor counts. Positions and directions are those of the scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RayExportSpec {
    /// Number of rays. Omitted: 100,000.
    #[schemars(range(min = 1, max = 20_000_000))]
    pub count: Option<u32>,
    /// The files, named after the sensor.
    #[serde(default = "tm25_only")]
    #[schemars(length(min = 1))]
    pub formats: Vec<RayExportFormat>,
}

/// A format of a ray file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RayExportFormat {
    /// IES TM-25: `SENSOR.tm25ray`.
    Tm25,
    /// Binary source file of OpticStudio: `SENSOR.sdf`.
    Zemax,
    /// CSV: `SENSOR.rays.csv`.
    Csv,
}

fn tm25_only() -> Vec<RayExportFormat> {
    vec![RayExportFormat::Tm25]
}

/// Rays from a file. Without `flux_lm` and `flux_w` the flux is the luminous one of the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RaysSpec {
    /// The file. A relative path is relative to the scene file.
    pub file: String,
    /// Total luminous flux. Omitted: that of the file, which must then be in lm, or in W with a `spectrum`.
    #[schemars(range(min = 0.0))]
    pub flux_lm: Option<f64>,
    /// Total radiant flux, in a scene in W, or with a `spectrum`.
    #[schemars(range(min = 0.0))]
    pub flux_w: Option<f64>,
    /// Most rays that are kept in memory (36 bytes each, more while the file is read). If the file has more, that many are drawn at random, the same
    /// ones in every run. Omitted: 10 million.
    #[schemars(range(min = 1, max = 1_000_000_000))]
    pub max_rays: Option<u32>,
    /// Replaces the individual rays by a luminance distribution on a plane, fitted to them, which paths from sensors can meet, so that `backward` and
    /// `gather` work. A remark gives the error of the fit. Rays that do not cross the plane where rays start are left out with their flux.
    #[serde(default)]
    pub fitted: bool,
    /// Height of the plane of the fit along the z axis of the file. Omitted: the height of the point with the least mean squared distance
    /// from the rays, extended to lines (their waist).
    pub fitted_at_mm: Option<f64>,
    /// Spectrum of its light, as of other sources.
    pub spectrum: Option<SpectrumSpec>,
    /// How rays start that touch a face: `optical` starts them beyond the face, as through glue; `air` lets them cross
    /// the face first. Omitted: `optical`.
    pub contact: Option<ContactSpec>,
    /// The light group, as of other sources.
    pub group: Option<String>,
    /// Whether it emits. A disabled source is dark, as with a flux of 0.
    #[serde(default = "enabled")]
    pub enabled: bool,
    /// The frame of the file: its z axis is the axis, its x axis the local +x.
    pub at: Option<PlacementSpec>,
}
