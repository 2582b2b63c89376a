//! Formats of meshes, and the units of their lengths.

use std::fmt;

/// The length unit of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LengthUnit {
    /// 1 mm.
    Millimetre,
    /// 10 mm.
    Centimetre,
    /// 1,000 mm, as glTF prescribes.
    Metre,
    /// 25.4 mm.
    Inch,
}

impl LengthUnit {
    /// Millimetres in one unit.
    pub fn millimetres(self) -> f64 {
        match self {
            Self::Millimetre => 1.0,
            Self::Centimetre => 10.0,
            Self::Metre => 1000.0,
            Self::Inch => 25.4,
        }
    }
}

/// File formats of meshes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeshFormat {
    /// glTF 2.0, as JSON or as GLB.
    Gltf,
    /// Stereolithography, binary or ASCII.
    Stl,
    /// Wavefront OBJ.
    Obj,
}

impl fmt::Display for MeshFormat {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::Gltf => "glTF",
            Self::Stl => "STL",
            Self::Obj => "OBJ",
        })
    }
}
