//! Luminaires as a scene file states them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::spec::daylight::enabled;
use crate::spec::placement::{ContactSpec, PlacementSpec};
use crate::spec::spectrum::SpectrumSpec;
use crate::spec::sweep::AreaSpec;
use indexmap::IndexMap;

/// A luminaire from a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LuminaireSpec {
    /// The file. A relative path is relative to the scene file.
    pub file: String,
    /// Total luminous flux. Omitted: that of the intensities in the file.
    #[schemars(range(min = 0.0))]
    pub flux_lm: Option<f64>,
    /// Where its light starts.
    #[serde(default)]
    pub extent: LuminaireExtent,
    /// Spectrum of its light, as of other sources.
    pub spectrum: Option<SpectrumSpec>,
    /// How light starts where the opening touches a face: `optical` starts it beyond the face, as through glue; `air`
    /// lets it cross the face first. Omitted: `optical`.
    pub contact: Option<ContactSpec>,
    /// The light group, as of other sources.
    pub group: Option<String>,
    /// Whether it emits. A disabled source is dark, as with a flux of 0.
    #[serde(default = "enabled")]
    pub enabled: bool,
    /// Position of the middle of the opening.
    pub at: Option<PlacementSpec>,
}

/// Where the light of a luminaire starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LuminaireExtent {
    /// On the luminous opening in the file: evenly over a flat one that shines to one side, with the same distribution everywhere; of
    /// one that shines to both sides, of a box or of an upright cylinder, evenly over what is seen from each direction.
    #[default]
    Opening,
    /// At its middle.
    Point,
}

/// Luminaire files of what a goniometer measures, for lighting programs: a table of luminous intensities whose interpolation
/// fits the cells best, without overshoot at edges of the light; at a finite distance, of illuminance times distance squared. The polar axis is the nadir; C0 is along the local +x, C90 along the local -y.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LuminaireExportSpec {
    /// The files: `SENSOR.ies` in IES LM-63-2002 or, with `ies_2019`, in LM-63-2019, which says that the values are computed;
    /// `SENSOR.ldt` in EULUMDAT; with `tm33`, `SENSOR.xml` in TM-33-18.
    #[serde(default = "all_formats")]
    #[schemars(length(min = 1))]
    pub formats: Vec<ExportFormat>,
    /// Step of γ in the table; it divides 180 and has two or more cells of the goniometer. Omitted: the smallest such step.
    #[schemars(extend("exclusiveMinimum" = 0.0), range(max = 180.0))]
    pub gamma_step_deg: Option<f64>,
    /// Step of C in the table, likewise of 360. Not used under rotational symmetry.
    #[schemars(extend("exclusiveMinimum" = 0.0), range(max = 360.0))]
    pub c_step_deg: Option<f64>,
    /// The symmetry of the luminaire. Planes that it takes as equal are averaged, and all formats except TM-33 list them once. Omitted: `none`;
    /// `rotational` for a goniometer without sectors.
    pub symmetry: Option<ExportSymmetry>,
    /// What intensities refer to: with `relative`, to lamps with the flux of all sources.
    #[serde(default)]
    pub photometry: ExportPhotometry,
    /// Number of lamps. Only for relative photometry. Omitted: 1.
    #[schemars(range(min = 1, max = 10_000))]
    pub lamps: Option<u32>,
    /// The luminous opening: its width along the local x (C0 to C180), its height along the local y (C90 to C270). Omitted: a
    /// point.
    pub opening: Option<AreaSpec>,
    /// Input power in W. Omitted: not known.
    #[schemars(range(min = 0.0))]
    pub power_w: Option<f64>,
    /// Texts by their keyword in LM-63, such as `MANUFAC`, `LUMCAT`, `LUMINAIRE`, `LAMP`, `ISSUEDATE`. Omitted ones: `LUMINAIRE` is the
    /// title of the scene, `TEST` has its hash.
    #[serde(default)]
    pub texts: IndexMap<String, String>,
}

/// A format of a luminaire file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ExportFormat {
    /// IES LM-63-2002.
    Ies,
    /// IES LM-63-2019.
    #[serde(rename = "ies_2019")]
    Ies2019,
    /// EULUMDAT.
    Ldt,
    /// ANSI/IES TM-33-18.
    Tm33,
}

/// The symmetry of a luminaire.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ExportSymmetry {
    /// None: planes over the whole circle.
    None,
    /// About the axis.
    Rotational,
    /// About the planes C0-C180 and C90-C270.
    Quadrants,
    /// About the plane C0-C180.
    AboutC0,
    /// About the plane C90-C270.
    AboutC90,
}

/// What luminous intensities refer to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ExportPhotometry {
    /// The luminaire itself, as is usual for LEDs.
    #[default]
    Absolute,
    /// Its lamps.
    Relative,
}

fn all_formats() -> Vec<ExportFormat> {
    vec![ExportFormat::Ies, ExportFormat::Ldt]
}
