//! Solids as a scene file states them.

use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::spec::finish::FinishRef;
use crate::spec::placement::PlacementSpec;
use crate::spec::sweep::{CompoundParabolicSpec, ParaboloidSpec, ProfileSpec, SweepSpec};

/// A closed body filled with a medium. A table with exactly one of these keys.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SolidSpec {
    /// A profile carried along a path. Faces `entry`, `exit` and `wall`. The wall of a rectangle is also
    /// `wall_plus_x`, `wall_plus_y`, `wall_minus_x` and `wall_minus_y`, that of a polygon also `wall_1`, `wall_2`
    /// and so on, one per side.
    Sweep(ShapedSolidSpec<SweepSpec>),
    /// A cylinder or a frustum of a cone, from the position along the axis. Faces `entry`, `exit`, `wall`.
    Cylinder(ShapedSolidSpec<CylinderSpec>),
    /// A box, from the position along the axis. Faces `entry`, `exit`, `wall`, and the four walls as for a rectangle.
    Box(ShapedSolidSpec<BoxSpec>),
    /// A straight tube with a solid wall, from the position along the axis, optionally with prisms on its outside. Faces
    /// `entry` and `exit` (the ends of the wall), `inner` and `outer`; `wall` is both.
    Tube(ShapedSolidSpec<TubeSolidSpec>),
    /// A sphere about the position. Face `surface`.
    Sphere(ShapedSolidSpec<SphereSpec>),
    /// A lens with spherical or flat ends, the vertex of the entry at the position. Faces `entry`, `exit`, `wall`.
    Lens(ShapedSolidSpec<LensSpec>),
    /// A compound parabolic concentrator. Faces `entry` (the small end), `exit` (the wide end), `wall`.
    CompoundParabolic(ShapedSolidSpec<CompoundParabolicSpec>),
    /// A paraboloid. Faces `wall`, `exit`, and `entry` if there is a hole.
    Paraboloid(ShapedSolidSpec<ParaboloidSpec>),
    /// A closed triangle mesh from a file. Its faces are named as its materials, or `surface` if it has none.
    Mesh(ShapedSolidSpec<MeshSpec>),
}

impl SolidSpec {
    /// The key of the kind, such as `sweep`.
    pub(crate) fn kind(&self) -> &'static str {
        self.entry().0
    }

    /// The keys that every kind has.
    pub(crate) fn common(&self) -> &SolidCommonSpec {
        self.entry().1
    }

    fn entry(&self) -> (&'static str, &SolidCommonSpec) {
        match self {
            Self::Sweep(solid) => ("sweep", &solid.common),
            Self::Cylinder(solid) => ("cylinder", &solid.common),
            Self::Box(solid) => ("box", &solid.common),
            Self::Tube(solid) => ("tube", &solid.common),
            Self::Sphere(solid) => ("sphere", &solid.common),
            Self::Lens(solid) => ("lens", &solid.common),
            Self::CompoundParabolic(solid) => ("compound_parabolic", &solid.common),
            Self::Paraboloid(solid) => ("paraboloid", &solid.common),
            Self::Mesh(solid) => ("mesh", &solid.common),
        }
    }
}

/// A shape filled with a medium.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "{Shape}Solid")]
pub struct ShapedSolidSpec<Shape> {
    /// Keys of the shape.
    #[serde(flatten)]
    pub shape: Shape,
    /// Keys of every solid.
    #[serde(flatten)]
    pub common: SolidCommonSpec,
}

/// What every solid has.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SolidCommonSpec {
    /// Name of the medium inside.
    pub medium: String,
    /// Where solids overlap, the medium of the one with the higher priority counts.
    #[serde(default)]
    pub priority: i32,
    /// Finish by face name. A face that is not named is `polished`.
    #[serde(default)]
    pub faces: IndexMap<String, FinishRef>,
    /// Position of the solid.
    pub at: Option<PlacementSpec>,
}

/// A straight tube with a wall; the bore is centred on the axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TubeSolidSpec {
    /// Cross-section of the bore.
    pub inner: ProfileSpec,
    /// The outside.
    pub outer: TubeOuterSpec,
    /// Length along the axis.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub length_mm: f64,
}

/// The outside of a tube. A table with exactly one of these keys.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TubeOuterSpec {
    /// Parallel to the bore, at this wall thickness.
    WallMm(#[schemars(extend("exclusiveMinimum" = 0.0))] f64),
    /// Prisms along the tube, side by side all around.
    Prisms(TubePrismsSpec),
}

/// Prisms along a tube; exactly one of `count` and `pitch_mm`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(extend("oneOf" = [{ "required": ["count"] }, { "required": ["pitch_mm"] }]))]
pub struct TubePrismsSpec {
    /// Thickness of the wall between the bore and the valleys.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub base_mm: f64,
    /// Number of prisms around a round tube, or on each side of a tube with corners.
    #[schemars(range(min = 1, max = 500))]
    pub count: Option<u32>,
    /// Distance from valley to valley, along the arc or the side; a whole number of prisms has to fit.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub pitch_mm: Option<f64>,
    /// Angle between the two facets of a prism at its tip.
    #[serde(default = "right_angle")]
    #[schemars(range(min = 10.0, max = 170.0))]
    pub prism_angle_deg: f64,
}

/// A cylinder or a frustum of a cone; the entry is centred at the position.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CylinderSpec {
    /// Radius, for a frustum that of the entry.
    #[schemars(extend("exclusiveMinimum" = 0.0), range(max = 1e9))]
    pub radius_mm: f64,
    /// Length along the axis.
    #[schemars(extend("exclusiveMinimum" = 0.0), range(max = 1e9))]
    pub length_mm: f64,
    /// Radius of the exit of a frustum. Omitted: the same as that of the entry.
    #[schemars(extend("exclusiveMinimum" = 0.0), range(max = 1e9))]
    pub end_radius_mm: Option<f64>,
}

/// A box; the entry is centred at the position.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BoxSpec {
    /// Full size along the local x, y and z (the axis).
    #[schemars(extend("items" = { "type": "number", "exclusiveMinimum": 0.0, "maximum": 1e9 }))]
    pub size_mm: [f64; 3],
}

/// A sphere about the position.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SphereSpec {
    /// Radius.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub radius_mm: f64,
}

/// A lens about the axis, its entry at the position. Each face is flat, convex or concave, as seen from outside.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LensSpec {
    /// Diameter of the rim.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub diameter_mm: f64,
    /// Thickness on the axis, domes included.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub thickness_mm: f64,
    /// Shape of the entry. Omitted: flat.
    pub entry: Option<LensFaceSpec>,
    /// Shape of the exit. Omitted: flat.
    pub exit: Option<LensFaceSpec>,
    /// Old form of `entry`: its radius of curvature, positive where it is convex.
    pub entry_radius_mm: Option<f64>,
    /// Old form of `exit`: its radius of curvature, negative where it is convex.
    pub exit_radius_mm: Option<f64>,
}

/// A spherical face of a lens. A table with exactly one of these keys.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[expect(clippy::enum_variant_names, reason = "a key ends with its unit")]
pub enum LensFaceSpec {
    /// Convex, with this radius of curvature.
    ConvexRadiusMm(#[schemars(extend("exclusiveMinimum" = 0.0))] f64),
    /// Concave, with this radius of curvature.
    ConcaveRadiusMm(#[schemars(extend("exclusiveMinimum" = 0.0))] f64),
    /// Convex, with this height on the axis above the rim.
    DomeHeightMm(#[schemars(extend("exclusiveMinimum" = 0.0))] f64),
    /// Concave, with this depth on the axis below the rim.
    DishDepthMm(#[schemars(extend("exclusiveMinimum" = 0.0))] f64),
}

impl LensFaceSpec {
    /// The key, as in the file.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::ConvexRadiusMm(_) => "convex_radius_mm",
            Self::ConcaveRadiusMm(_) => "concave_radius_mm",
            Self::DomeHeightMm(_) => "dome_height_mm",
            Self::DishDepthMm(_) => "dish_depth_mm",
        }
    }
}

/// A closed triangle mesh from a glTF, GLB, STL or OBJ file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MeshSpec {
    /// Path of the file, relative to the file that names it.
    pub file: String,
    /// Length unit of the file.
    pub unit: MeshUnit,
    /// Where the normals for mirroring and refraction come from.
    #[serde(default)]
    pub normals: MeshNormals,
}

/// Length unit of a mesh file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MeshUnit {
    /// Millimetres.
    Mm,
    /// Centimetres.
    Cm,
    /// Metres, the unit of glTF.
    M,
    /// Inches of 25.4 mm.
    Inch,
}

/// Where the normals of a mesh come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MeshNormals {
    /// The vertex normals of the file, interpolated; those of the facets where it has none.
    #[default]
    File,
    /// Those of the flat facets.
    Facet,
}

fn right_angle() -> f64 {
    90.0
}
