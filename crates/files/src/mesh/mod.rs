//! Triangle meshes from files: glTF and GLB, STL, OBJ.
//!
//! All readers give the same [`MeshAssembly`]: millimetres in f64, positions welded where they
//! coincide exactly, normals per corner, and a face name for every triangle. A reader never trusts
//! a count or an index of the file: broken or hostile data gives a [`MeshError`], never a panic.
//! Whether the mesh is closed and the right way out is checked afterwards
//! ([`MeshAssembly::health`]). This module knows no optical properties.

mod error;
mod file;
mod format;
mod from_gltf;
mod from_obj;
mod from_stl;
mod gltf_buffers;
mod gltf_copies;
mod gltf_nodes;
mod gltf_primitive;
#[cfg(test)]
mod samples;

pub use error::{MAX_COPIES_BYTES, MAX_FILE_BYTES, MeshError};
pub use file::no_scene;
pub use format::{LengthUnit, MeshFormat};

use crate::bytes::read_file;
use lumiduct_base::mesh::MeshAssembly;
use lumiduct_base::text::visible;
use std::path::Path;

/// Reads a mesh whose lengths are in `unit`; the file name extension gives the format.
///
/// # Errors
///
/// As [`MeshFormat::of`] and [`parse`]; [`MeshError::Unreadable`] or [`MeshError::FileTooLong`] if the file cannot be read.
pub fn read(path: &Path, unit: LengthUnit) -> Result<MeshAssembly, MeshError> {
    let format = MeshFormat::of(path)?;
    let bytes = read_file(path, MAX_FILE_BYTES)?.ok_or(MeshError::FileTooLong)?;
    parse(&bytes, format, path.parent().unwrap_or_else(|| Path::new("")), unit)
}

/// Reads the bytes of a mesh whose lengths are in `unit`. The buffers of glTF may be files in `folder`.
///
/// # Errors
///
/// [`MeshError::BufferFile`] if the file of a buffer cannot be read; [`MeshError::Broken`] if the bytes violate their
/// format; [`MeshError::Unsupported`], [`MeshError::TooManyCopies`], [`MeshError::TooManyShown`] or [`MeshError::Unusable`] if their content makes no
/// mesh that can be traced.
pub fn parse(
    bytes: &[u8],
    format: MeshFormat,
    folder: &Path,
    unit: LengthUnit,
) -> Result<MeshAssembly, MeshError> {
    let mut assembly = match format {
        MeshFormat::Gltf => from_gltf::read(bytes, folder, unit),
        MeshFormat::Stl => from_stl::read(bytes, unit).map(MeshAssembly::from),
        MeshFormat::Obj => from_obj::read(bytes, unit).map(MeshAssembly::from),
    }?;
    let bodies = assembly.copied.iter_mut().map(|copied| &mut copied.body);
    let faces = bodies.chain([&mut assembly.mesh]).flat_map(|mesh| &mut mesh.faces);
    faces.for_each(|name| *name = visible(name));
    Ok(assembly)
}
