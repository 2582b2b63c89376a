//! Shapes that solids and hollow sheets share: a profile along a path, and the reflectors of revolution.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A profile carried along a path.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SweepSpec {
    /// Cross-section, centred on the path.
    pub profile: ProfileSpec,
    /// Legs of the path, one after the other, from the entry at the position along the axis.
    #[schemars(length(min = 1, max = 1000))]
    pub path: Vec<LegSpec>,
}

/// A cross-section. A table with exactly one of these keys.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ProfileSpec {
    /// A circle.
    Circle(CircleSpec),
    /// A rectangle.
    Rectangle(RectangleSpec),
    /// A regular polygon, given by its circumscribed circle or by its width across flats.
    RegularPolygon(RegularPolygonSpec),
    /// Any polygon that does not cross itself.
    Polygon(PolygonSpec),
}

/// A circle about the axis.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CircleSpec {
    /// Radius.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub radius_mm: f64,
}

/// A rectangle about the axis.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RectangleSpec {
    /// Full width along the local x.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub width_mm: f64,
    /// Full height along the local y.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub height_mm: f64,
}

/// A flat area about a position: of a sensor that is not `on` a face, or of a luminous opening.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AreaSpec {
    /// A rectangular area about the position.
    pub rectangle: Option<RectangleSpec>,
    /// A round area about the position.
    pub disk: Option<CircleSpec>,
}

/// A regular polygon about the axis; exactly one of `radius_mm` and `across_flats_mm`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(extend("oneOf" = [{ "required": ["radius_mm"] }, { "required": ["across_flats_mm"] }]))]
pub struct RegularPolygonSpec {
    /// Number of sides.
    #[schemars(range(min = 3, max = 1000))]
    pub sides: u32,
    /// Radius of the circle through the corners.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub radius_mm: Option<f64>,
    /// Diameter of the circle that touches the sides.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub across_flats_mm: Option<f64>,
    /// Turn about the axis; at 0 one corner lies on the local +x.
    #[serde(default)]
    pub rotation_deg: f64,
}

/// A polygon by its corners, in order, without repeating the first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PolygonSpec {
    /// Corners as `[x, y]`.
    #[schemars(length(min = 3, max = 1000))]
    pub points_mm: Vec<[f64; 2]>,
}

/// One leg of a path: a straight, a bend or a corner.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum LegSpec {
    /// Straight on.
    Straight(StraightSpec),
    /// Along an arc.
    Bend(BendSpec),
    /// A sharp corner.
    Corner(CornerSpec),
}

/// A straight leg; with an end scale it tapers, as a cone or pyramid does.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StraightSpec {
    /// Length along the axis.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub straight_mm: f64,
    /// Size of the section at the end of the leg, relative to its start.
    #[serde(default = "one")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub end_scale: f64,
}

/// A leg along a circular arc.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BendSpec {
    /// Angle turned through.
    #[schemars(extend("exclusiveMinimum" = 0.0), range(max = 360.0))]
    pub bend_deg: f64,
    /// Radius of the centre line.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub radius_mm: f64,
    /// Azimuth, in the cross-section, toward which the path bends: 0 is the local +x, 90 the local +y.
    #[serde(default)]
    pub toward_deg: f64,
}

/// A sharp corner between two legs. The legs end at the sections through its inner edge, as at a bend: with half the
/// profile's width h on the inner side it adds h tan(angle/2) before and after the crossing of the centre lines.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CornerSpec {
    /// Angle turned through.
    #[schemars(extend("exclusiveMinimum" = 0.0, "exclusiveMaximum" = 180.0))]
    pub corner_deg: f64,
    /// Azimuth, in the cross-section, toward which the path turns: 0 is the local +x, 90 the local +y.
    #[serde(default)]
    pub toward_deg: f64,
    /// Whether a flat facet at half the angle, through the crossing of the centre lines, cuts off the outer edge: a fold
    /// mirror, which reflects by its finish in a duct and by total reflection in a solid.
    pub fold_mirror: Option<bool>,
    /// Old name of `fold_mirror`.
    pub mitred: Option<bool>,
}

impl CornerSpec {
    /// Whether the corner has a fold mirror.
    pub(crate) fn has_fold_mirror(&self) -> bool {
        self.fold_mirror.or(self.mitred).unwrap_or(false)
    }
}

/// A compound parabolic concentrator of revolution about the axis; the small end lies at the position.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CompoundParabolicSpec {
    /// Radius of the small end.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub small_radius_mm: f64,
    /// Acceptance half-angle: light that enters the wide end within it reaches the small end.
    #[schemars(extend("exclusiveMinimum" = 0.0, "exclusiveMaximum" = 90.0))]
    pub acceptance_half_angle_deg: f64,
    /// Length along the axis, truncated at the wide end. Omitted: the full length.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub length_mm: Option<f64>,
}

/// A paraboloid of revolution; the vertex lies at the position, and it opens along the axis.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ParaboloidSpec {
    /// Distance of the focus from the vertex.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub focal_length_mm: f64,
    /// Radius of the rim.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub radius_mm: f64,
    /// Radius of the hole at the vertex; 0 is none.
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub hole_radius_mm: f64,
}

fn one() -> f64 {
    1.0
}
