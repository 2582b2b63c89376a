//! Sheets as a scene file states them: open, two-sided surfaces and hollow ducts.

use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::spec::finish::FinishRef;
use crate::spec::placement::PlacementSpec;
use crate::spec::solid::SphereSpec;
use crate::spec::sweep::{
    CircleSpec, CompoundParabolicSpec, ParaboloidSpec, RectangleSpec, SweepSpec,
};

/// An open surface without thickness. A table with exactly one of these keys.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SheetSpec {
    /// A disk about the position, facing along the axis. Face `surface`.
    Disk(PlainSheetSpec<CircleSpec>),
    /// A disk with a round hole, facing along the axis. Face `surface`.
    Annulus(PlainSheetSpec<AnnulusSpec>),
    /// A rectangle about the position, facing along the axis. Face `surface`.
    Rectangle(PlainSheetSpec<RectangleSpec>),
    /// The part of a sphere about the axis; the centre of the sphere lies at the position. Face `surface`.
    SphericalCap(PlainSheetSpec<SphericalCapSpec>),
    /// A trough with z = x²/(4 f); its front is the concave side. Face `surface`.
    ParabolicCylinder(PlainSheetSpec<ParabolicCylinderSpec>),
    /// A hollow tube or duct: a profile carried along a path. Faces and wall names as for a `sweep`; `entry` and
    /// `exit` are open ports.
    Tube(DuctSpec<SweepSpec>),
    /// A hollow compound parabolic reflector. Ports `entry` (the small end) and `exit`, face `wall`.
    CompoundParabolic(DuctSpec<CompoundParabolicSpec>),
    /// A paraboloid reflector. Port `exit`, and `entry` if there is a hole; face `wall`.
    Paraboloid(DuctSpec<ParaboloidSpec>),
}

impl SheetSpec {
    /// The key of the kind, such as `disk`.
    pub(crate) fn kind(&self) -> &'static str {
        self.entry().0
    }

    /// The keys that every kind of the sheet's family has.
    pub(crate) fn common(&self) -> SheetCommon<'_> {
        self.entry().1
    }

    fn entry(&self) -> (&'static str, SheetCommon<'_>) {
        use SheetCommon::{Duct, Sheet};
        match self {
            Self::Disk(sheet) => ("disk", Sheet(&sheet.common)),
            Self::Annulus(sheet) => ("annulus", Sheet(&sheet.common)),
            Self::Rectangle(sheet) => ("rectangle", Sheet(&sheet.common)),
            Self::SphericalCap(sheet) => ("spherical_cap", Sheet(&sheet.common)),
            Self::ParabolicCylinder(sheet) => ("parabolic_cylinder", Sheet(&sheet.common)),
            Self::Tube(duct) => ("tube", Duct(&duct.common)),
            Self::CompoundParabolic(duct) => ("compound_parabolic", Duct(&duct.common)),
            Self::Paraboloid(duct) => ("paraboloid", Duct(&duct.common)),
        }
    }
}

/// The common keys of a sheet, by family.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum SheetCommon<'a> {
    /// A plain surface with a front and a back.
    Sheet(&'a SheetCommonSpec),
    /// A hollow duct with an inside and an outside.
    Duct(&'a DuctCommonSpec),
}

impl<'a> SheetCommon<'a> {
    /// Position of the sheet.
    pub(crate) fn at(self) -> Option<&'a PlacementSpec> {
        match self {
            Self::Sheet(common) => common.at.as_ref(),
            Self::Duct(common) => common.at.as_ref(),
        }
    }
}

/// A plain surface with a front and a back.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "{Shape}Sheet")]
pub struct PlainSheetSpec<Shape> {
    /// Keys of the shape.
    #[serde(flatten)]
    pub shape: Shape,
    /// Keys of every plain surface.
    #[serde(flatten)]
    pub common: SheetCommonSpec,
}

/// What every plain surface has.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SheetCommonSpec {
    /// Finish of the front, the side into which the axis points.
    pub finish: FinishRef,
    /// Finish of the back. Omitted: the same as the front; behind a prism film, that film.
    pub back: Option<FinishRef>,
    /// Position of the sheet.
    pub at: Option<PlacementSpec>,
}

/// A hollow duct with an inside and an outside.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "{Shape}Duct")]
pub struct DuctSpec<Shape> {
    /// Keys of the shape.
    #[serde(flatten)]
    pub shape: Shape,
    /// Keys of every duct.
    #[serde(flatten)]
    pub common: DuctCommonSpec,
}

/// What every duct has.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DuctCommonSpec {
    /// Finish of the inside.
    pub finish: FinishRef,
    /// Finish of the outside. Omitted: `black`; behind a prism film, that film.
    pub outer: Option<FinishRef>,
    /// Finish of the inside by wall name, where it differs.
    #[serde(default)]
    pub faces: IndexMap<String, FinishRef>,
    /// Position of the duct.
    pub at: Option<PlacementSpec>,
}

/// A disk with a round hole.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AnnulusSpec {
    /// Radius of the hole; smaller than the outer radius.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub inner_radius_mm: f64,
    /// Radius of the rim.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub outer_radius_mm: f64,
}

/// The part of a sphere within an angle of the axis.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SphericalCapSpec {
    /// The sphere.
    #[serde(flatten)]
    pub sphere: SphereSpec,
    /// Angle between the axis and the rim, seen from the centre; 180 is the whole sphere.
    #[schemars(extend("exclusiveMinimum" = 0.0), range(max = 180.0))]
    pub half_angle_deg: f64,
}

/// A parabolic trough along the local y.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ParabolicCylinderSpec {
    /// Focal length f.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub focal_length_mm: f64,
    /// Where the trough begins, along the local x.
    pub x_min_mm: f64,
    /// Where the trough ends, along the local x; above `x_min_mm`.
    pub x_max_mm: f64,
    /// Full length along the local y.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub length_mm: f64,
}
