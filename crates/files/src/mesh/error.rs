//! Errors of reading a mesh, and limits of its size.

use crate::mesh::format::MeshFormat;
use lumiduct_base::mesh::{MAX_SHOWN_TRIANGLES, UnusableMesh};

/// Longest file that is read, bytes: enough for 50 million triangles of binary STL.
pub const MAX_FILE_BYTES: u64 = 4 << 30;
/// Most memory that copies of the meshes of a file may take, bytes.
pub const MAX_COPIES_BYTES: u64 = 1 << 30;
/// Why a mesh could not be read.
#[derive(Debug, thiserror::Error)]
pub enum MeshError {
    /// The operating system refuses the file.
    #[error("the file cannot be read: {0}; check the name and the permissions")]
    Unreadable(#[from] std::io::Error),
    /// The file name extension is not one of a mesh format.
    #[error("`.{ending}` is not the ending of a known mesh format; use .glb, .gltf, .stl or .obj")]
    UnknownFormat {
        /// The extension, without its dot.
        ending: String,
    },
    /// The file is a CAD file, which must be converted to a mesh first.
    #[error(
        "`.{ending}` is a CAD file, which is not read: docs/cad.md explains how to make a mesh of it"
    )]
    CadFile {
        /// The extension, without its dot.
        ending: String,
    },
    /// The file violates its format.
    #[error("not a usable {format} file: {problem}; export the mesh again")]
    Broken {
        /// The format.
        format: MeshFormat,
        /// What is wrong, with the place.
        problem: String,
    },
    /// The file is valid, but uses an unsupported feature.
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
        /// The name as given in the file.
        uri: String,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// The file, or the files together, are longer than [`MAX_FILE_BYTES`].
    #[error("the file has more than {} GiB; export a coarser mesh with smooth normals", MAX_FILE_BYTES >> 30)]
    FileTooLong,
    /// Nodes of a glTF file repeat its meshes so often that the copies take more than [`MAX_COPIES_BYTES`], and they cannot share
    /// their triangles.
    #[error(
        "its {nodes} nodes repeat meshes that are open, distorted or near other parts to {triangles} triangles, about {} MiB in \
         memory, and such copies may take {} MiB; export fewer copies, or closed ones that are only moved, turned and scaled and \
         whose boxes do not overlap",
        bytes >> 20, MAX_COPIES_BYTES >> 20
    )]
    TooManyCopies {
        /// Nodes with a mesh.
        nodes: usize,
        /// Triangles of all of them.
        triangles: u64,
        /// Memory that they would take, bytes.
        bytes: u64,
    },
    /// The nodes of a glTF file show more triangles than [`MAX_SHOWN_TRIANGLES`].
    #[error(
        "its {nodes} nodes show {triangles} triangles, and at most {} million may be shown; export fewer copies",
        MAX_SHOWN_TRIANGLES / 1_000_000
    )]
    TooManyShown {
        /// Nodes with a mesh.
        nodes: usize,
        /// Triangles of all of them.
        triangles: u64,
    },
    /// The triangles make no mesh that can be traced.
    #[error(transparent)]
    Unusable(#[from] UnusableMesh),
}
