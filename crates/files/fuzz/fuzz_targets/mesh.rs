//! Whatever a mesh file contains, it is refused, or its corners are finite.

#![no_main]

use libfuzzer_sys::fuzz_target;
use lumiduct_files::mesh::{LengthUnit, MeshFormat, parse};
use std::path::Path;

fuzz_target!(|input: (u8, &[u8])| {
    let (format, bytes) = input;
    let format = [MeshFormat::Gltf, MeshFormat::Stl, MeshFormat::Obj][usize::from(format % 3)];
    if let Ok(mesh) = parse(bytes, format, Path::new("/no/where"), LengthUnit::Metre) {
        assert!(mesh.mesh.positions.iter().all(|corner| corner.is_finite()));
    }
});
