//! The format of a file by its extension.

use crate::mesh::error::MeshError;
use crate::mesh::format::MeshFormat;
use std::path::Path;

impl MeshFormat {
    /// The format of a file name extension.
    ///
    /// # Errors
    ///
    /// [`MeshError::CadFile`] for the extension of a CAD file, [`MeshError::UnknownFormat`] for any other unknown
    /// one.
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

/// Whether an extension in lower case is that of a CAD file with exact surfaces or a model tree.
fn is_cad_ending(ending: &str) -> bool {
    ["step", "stp", "p21", "iges", "igs", "x_t", "x_b", "sat", "sldprt", "sldasm", "ipt", "3dm"]
        .contains(&ending)
}

/// The message for a mesh or CAD file given in place of a scene; `None` for any other extension.
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
}
