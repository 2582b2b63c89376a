//! Triangle meshes from files: glTF and GLB, STL, OBJ.
//!
//! All readers give the same [`TriangleMesh`]: millimetres in f64, positions welded where they coincide exactly,
//! normals per corner, and a face name for every triangle. A reader never trusts a count or an index of the file:
//! broken or hostile data is a [`MeshError`], never a panic. Whether the mesh is closed and the right way out is
//! asked afterwards ([`lumiduct_base::mesh::health()`]). What a face does to light is not known here.

mod from_gltf;
mod from_obj;
mod from_stl;
mod gltf_buffers;
mod gltf_copies;
mod gltf_nodes;
#[cfg(test)]
mod samples;

use lumiduct_base::mesh::{TriangleMesh, UnusableMesh};
use lumiduct_base::text::visible;
use std::fmt;
use std::fs;
use std::io::Read;
use std::path::Path;

/// Longest file that is read, bytes: 50 million triangles of binary STL fit in.
pub const MAX_FILE_BYTES: u64 = 4 << 30;
/// Most memory that copies of the meshes of a file may take, bytes.
pub const MAX_COPIES_BYTES: u64 = 1 << 30;
/// Memory of a triangle while a scene is made of it, bytes: measured, 345 with normals (200 copies of 1,024 triangles against 50).
pub(crate) const TRIANGLE_BYTES: u64 = 350;

/// The length that 1 in the file stands for.
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

/// File formats that hold meshes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeshFormat {
    /// glTF 2.0, as JSON or as GLB.
    Gltf,
    /// Stereolithography, binary or ASCII.
    Stl,
    /// Wavefront OBJ.
    Obj,
}

impl MeshFormat {
    /// The format that the ending of a file name stands for.
    pub fn of(path: &Path) -> Result<Self, MeshError> {
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        match ending.as_str() {
            "glb" | "gltf" => Ok(Self::Gltf),
            "stl" => Ok(Self::Stl),
            "obj" => Ok(Self::Obj),
            _ if is_cad_ending(&ending) => Err(MeshError::CadFile { ending }),
            _ => Err(MeshError::UnknownFormat { ending }),
        }
    }
}

/// Whether an ending in small letters is that of a CAD file with exact surfaces or a model tree.
fn is_cad_ending(ending: &str) -> bool {
    ["step", "stp", "p21", "iges", "igs", "x_t", "x_b", "sat", "sldprt", "sldasm", "ipt", "3dm"]
        .contains(&ending)
}

/// The message for a mesh or CAD file given in place of a scene; `None` for any other ending.
pub fn no_scene(path: &Path) -> Option<String> {
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    match MeshFormat::of(path) {
        Ok(format) => Some(format!(
            "this is a mesh ({format}), not a scene: name it in a scene as solids.NAME.mesh.file; docs/cad.md has an example"
        )),
        Err(_) if is_cad_ending(&ending) => Some(
            "this is a CAD file, not a scene: docs/cad.md explains how to make a mesh of it and name that in a scene".into(),
        ),
        Err(_) => None,
    }
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

/// Why a mesh could not be read.
#[derive(Debug, thiserror::Error)]
pub enum MeshError {
    /// The operating system refuses the file.
    #[error("the file cannot be read: {0}; check the name and the permissions")]
    Unreadable(#[from] std::io::Error),
    /// The ending of the name is none of a mesh.
    #[error("`.{ending}` is not the ending of a known mesh format; use .glb, .gltf, .stl or .obj")]
    UnknownFormat {
        /// The ending, without its dot.
        ending: String,
    },
    /// The file is one of CAD, which has to become a mesh first.
    #[error(
        "`.{ending}` is a CAD file, which is not read: docs/cad.md tells how to make a mesh of it"
    )]
    CadFile {
        /// The ending, without its dot.
        ending: String,
    },
    /// The file is not what its format prescribes.
    #[error("not a usable {format} file: {problem}; export the mesh again")]
    Broken {
        /// The format.
        format: MeshFormat,
        /// What is wrong, with the place.
        problem: String,
    },
    /// The file is right, but uses something that is not read here.
    #[error("{what}; {remedy}")]
    Unsupported {
        /// What the file uses.
        what: String,
        /// What to change on export.
        remedy: &'static str,
    },
    /// A buffer of a glTF file lies in another file, which cannot be read.
    #[error(
        "the buffer file `{uri}` cannot be read: {source}; keep it beside the .gltf file or export a .glb"
    )]
    BufferFile {
        /// The name as the file gives it.
        uri: String,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// The file, or the files together, are longer than [`MAX_FILE_BYTES`].
    #[error("the file has more than {} GiB; export a coarser mesh with smooth normals", MAX_FILE_BYTES >> 30)]
    FileTooLong,
    /// Nodes of a glTF file repeat its meshes so often that the copies take more than [`MAX_COPIES_BYTES`].
    #[error(
        "its {nodes} nodes repeat meshes to {triangles} triangles, about {} MiB in memory, and copies may take {} MiB; \
         export fewer copies", bytes >> 20, MAX_COPIES_BYTES >> 20
    )]
    TooManyCopies {
        /// Nodes with a mesh.
        nodes: usize,
        /// Triangles of all of them.
        triangles: u64,
        /// Memory that they would take, bytes.
        bytes: u64,
    },
    /// The triangles make no mesh that can be traced.
    #[error(transparent)]
    Unusable(#[from] UnusableMesh),
}

/// Reads a mesh whose lengths are in `unit`; the ending of the name tells the format.
pub fn read(path: &Path, unit: LengthUnit) -> Result<TriangleMesh, MeshError> {
    let format = MeshFormat::of(path)?;
    let bytes = read_file(path, MAX_FILE_BYTES)?;
    let mut mesh = match format {
        MeshFormat::Gltf => {
            from_gltf::read(&bytes, path.parent().unwrap_or_else(|| Path::new("")), unit)
        }
        MeshFormat::Stl => from_stl::read(&bytes, unit),
        MeshFormat::Obj => from_obj::read(&bytes, unit),
    }?;
    mesh.faces.iter_mut().for_each(|name| *name = visible(name));
    Ok(mesh)
}

/// All bytes of a regular file that has at most `limit` of them.
fn read_file(path: &Path, limit: u64) -> Result<Vec<u8>, MeshError> {
    let about = fs::metadata(path)?;
    // A pipe or a device may never end.
    if !about.is_file() {
        return Err(std::io::Error::other("it is not a regular file").into());
    }
    if about.len() > limit {
        return Err(MeshError::FileTooLong);
    }
    let mut bytes = Vec::new();
    fs::File::open(path)?.take(limit).read_to_end(&mut bytes)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ending_tells_the_format_and_others_are_named() {
        assert_eq!(MeshFormat::of(Path::new("a/B.GLB")).unwrap(), MeshFormat::Gltf);
        assert_eq!(MeshFormat::of(Path::new("rod.Stl")).unwrap(), MeshFormat::Stl);
        let error = MeshFormat::of(Path::new("rod.txt")).unwrap_err().to_string();
        assert_eq!(
            error,
            "`.txt` is not the ending of a known mesh format; use .glb, .gltf, .stl or .obj"
        );
        let error = MeshFormat::of(Path::new("rod.STEP")).unwrap_err().to_string();
        assert!(
            error.starts_with("`.step` is a CAD file") && error.contains("docs/cad.md"),
            "{error}"
        );
        for (name, word) in [("a.stp", "CAD file"), ("a.glb", "a mesh (glTF)")] {
            assert!(no_scene(Path::new(name)).is_some_and(|text| text.contains(word)), "{name}");
        }
        assert_eq!(no_scene(Path::new("a.toml")), None);
    }

    #[test]
    fn a_missing_file_a_folder_and_a_long_file_are_errors() {
        let folder = tempfile::tempdir().unwrap();
        for path in [folder.path(), &folder.path().join("missing.stl")] {
            assert!(matches!(read_file(path, MAX_FILE_BYTES), Err(MeshError::Unreadable(_))));
        }
        let path = folder.path().join("long.stl");
        fs::write(&path, [0; 100]).unwrap();
        assert!(matches!(read_file(&path, 99), Err(MeshError::FileTooLong)));
        assert_eq!(read_file(&path, 100).unwrap().len(), 100);
    }
}
