//! The sun and the sky as a scene file states them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::spec::spectrum::SpectrumSpec;

/// The sun's disk. Exactly one of `elevation_deg`, `elevations_deg` and `when`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(extend("oneOf" = [
    { "required": ["elevation_deg"] },
    { "required": ["elevations_deg"] },
    { "required": ["when"] }
]))]
pub struct SunSpec {
    /// Illuminance from the sun on a plane perpendicular to its light.
    #[schemars(range(min = 0.0))]
    pub illuminance_lx: f64,
    /// The position of the sun.
    #[serde(flatten)]
    pub place: SunPlaceSpec,
    /// Several elevations, each a separate source: `sun` at 7.5 deg becomes `sun_7_5`.
    #[schemars(length(min = 1), extend("items" = {
        "type": "number", "exclusiveMinimum": 0.0, "maximum": 90.0
    }))]
    pub elevations_deg: Option<Vec<f64>>,
    /// Half of the angular diameter of the disk. Omitted: the mean over the year.
    #[serde(default = "mean_half_angle")]
    #[schemars(extend("exclusiveMinimum" = 0.0), range(max = 5.0))]
    pub half_angle_deg: f64,
    /// Keys of all daylight.
    #[serde(flatten)]
    pub common: DaylightCommonSpec,
}

/// The light of the sky without the sun's disk; exactly one of `zenith_luminance_cd_m2` and `horizontal_illuminance_lx`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(extend("oneOf" = [
    { "required": ["zenith_luminance_cd_m2"] },
    { "required": ["horizontal_illuminance_lx"] }
]))]
pub struct SkySpec {
    /// Distribution of luminance over the sky.
    pub model: SkyModelSpec,
    /// Luminance of the zenith.
    #[schemars(range(min = 0.0))]
    pub zenith_luminance_cd_m2: Option<f64>,
    /// Illuminance on a horizontal plane in the open, from the sky alone.
    #[schemars(range(min = 0.0))]
    pub horizontal_illuminance_lx: Option<f64>,
    /// The position of the sun, for a sky that is brighter near it.
    #[serde(flatten)]
    pub place: SunPlaceSpec,
    /// Keys of all daylight.
    #[serde(flatten)]
    pub common: DaylightCommonSpec,
}

/// What the sun and the sky have in common.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DaylightCommonSpec {
    /// The light group. Omitted: a sun and the skies around it form one group if there is other daylight or another
    /// source.
    pub group: Option<String>,
    /// Spectrum of its light, as of other sources.
    pub spectrum: Option<SpectrumSpec>,
    /// Whether it emits. A disabled source is dark, as with an amount of 0.
    #[serde(default = "enabled")]
    pub enabled: bool,
    /// What it shines on: a flat face or port such as `duct.entry`, on which its light starts, or a solid or sheet such
    /// as a collector dome, at which light comes from outside the scene.
    pub aim: String,
}

/// The position of the sun.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SunPlaceSpec {
    /// Elevation above the horizon.
    #[schemars(extend("exclusiveMinimum" = 0.0), range(max = 90.0))]
    pub elevation_deg: Option<f64>,
    /// Azimuth from north, clockwise seen from above. Omitted: 180, south.
    pub azimuth_deg: Option<f64>,
    /// Date, time and place instead of angles.
    pub when: Option<WhenSpec>,
}

/// A moment and a place on earth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WhenSpec {
    /// Date as "2026-06-21", in quotes.
    pub date: String,
    /// Time of the clock as "14:30" or "14:30:15", in quotes.
    pub time: String,
    /// Hours by which that clock is ahead of UTC: 1 for Central European Time, 2 for its summer time, -5 for Eastern
    /// Standard Time.
    #[schemars(range(min = -12.0, max = 14.0))]
    pub utc_offset_h: f64,
    /// Latitude, north positive.
    #[schemars(range(min = -90.0, max = 90.0))]
    pub latitude_deg: f64,
    /// Longitude, east positive.
    #[schemars(range(min = -180.0, max = 180.0))]
    pub longitude_deg: f64,
}

/// A standard sky.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SkyModelSpec {
    /// The same luminance everywhere.
    Uniform,
    /// The traditional overcast sky of the CIE, three times as bright at the zenith as at the horizon.
    Overcast,
    /// The clear sky of the CIE, type 12, for a low turbidity; needs the sun.
    Clear,
    /// A type of CIE S 011 (ISO 15469), 1 to 15; all but 1, 3 and 5 need the sun.
    CieType(#[schemars(range(min = 1, max = 15))] u32),
}

/// Sources emit unless they are disabled.
pub(super) fn enabled() -> bool {
    true
}

fn mean_half_angle() -> f64 {
    lumiduct_core::optics::sun::HALF_ANGLE_DEG
}
