//! STL, binary and ASCII. The names of ASCII solids become faces; the normals in the file are facet
//! normals and are ignored.
//!
//! Layout: 3D Systems, Stereolithography Interface Specification (1988). Many binary files start with "solid" as
//! ASCII ones do, so the length decides: 84 bytes and 50 for every triangle.

use crate::mesh::error::MeshError;
use crate::mesh::format::{LengthUnit, MeshFormat};
use glam::DVec3;
use lumiduct_base::mesh::{MAX_TRIANGLES, MeshBuilder, TriangleMesh, UNNAMED_FACE, UnusableMesh};

/// Bytes before the first triangle of a binary file: a comment of 80 and the count.
const HEADER: usize = 84;
/// Bytes of a triangle of a binary file: normal, three vertices, attribute.
const RECORD: usize = 50;
/// Bytes of the normal, which comes first.
const NORMAL: usize = 12;

/// Reads an STL file of either kind.
pub(crate) fn read(bytes: &[u8], unit: LengthUnit) -> Result<TriangleMesh, MeshError> {
    let starts_as_text = bytes.trim_ascii_start().get(..5).is_some_and(is_solid);
    if starts_as_text && binary_count(bytes).is_none_or(|count| binary_length(count) != bytes.len())
    {
        read_ascii(&String::from_utf8_lossy(bytes), unit)
    } else {
        read_binary(bytes, unit)
    }
}

fn is_solid(word: &[u8]) -> bool {
    word.eq_ignore_ascii_case(b"solid")
}

fn binary_count(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(80..HEADER)?;
    Some(u32::from_le_bytes([count[0], count[1], count[2], count[3]]) as usize)
}

fn binary_length(count: usize) -> usize {
    // At most 2^32 · 50: no overflow.
    HEADER + count * RECORD
}

fn read_binary(bytes: &[u8], unit: LengthUnit) -> Result<TriangleMesh, MeshError> {
    let count = binary_count(bytes).ok_or_else(|| broken("it ends within its header".into()))?;
    if count > MAX_TRIANGLES && bytes.len() >= binary_length(count) {
        return Err(UnusableMesh::TooManyTriangles.into());
    }
    if bytes.len() < binary_length(count) {
        let held = bytes.len().saturating_sub(HEADER) / RECORD;
        return Err(broken(format!("it announces {count} triangles and holds {held}")));
    }
    let mut builder = MeshBuilder::default();
    for record in bytes[HEADER..binary_length(count)].chunks_exact(RECORD) {
        let (numbers, _attribute) = record[NORMAL..].as_chunks::<4>();
        let coordinate = |index: usize| f64::from(f32::from_le_bytes(numbers[index]));
        let corner = |index: usize| {
            DVec3::new(coordinate(index), coordinate(index + 1), coordinate(index + 2))
                * unit.millimetres()
        };
        builder.add([corner(0), corner(3), corner(6)], None, UNNAMED_FACE)?;
    }
    Ok(builder.finish()?)
}

fn read_ascii(text: &str, unit: LengthUnit) -> Result<TriangleMesh, MeshError> {
    let mut builder = MeshBuilder::default();
    let mut face = String::new();
    let mut corners = Vec::new();
    let mut ended = false;
    for (line, content) in text.lines().enumerate() {
        let at = |problem: &str| broken(format!("line {}: {problem}", line + 1));
        let mut words = content.split_whitespace();
        let Some(word) = words.next() else { continue };
        match word.to_ascii_lowercase().as_str() {
            "solid" => {
                face = words.collect::<Vec<_>>().join(" ");
                ended = false;
            }
            "vertex" => {
                let vertex =
                    vertex(words).ok_or_else(|| at("expected `vertex` and three numbers"))?;
                corners.push(vertex * unit.millimetres());
            }
            "endloop" => {
                let triangle = <[DVec3; 3]>::try_from(corners.as_slice())
                    .map_err(|_| at("expected three vertices in a loop"))?;
                builder.add(triangle, None, &face)?;
                corners.clear();
            }
            "endsolid" => ended = true,
            "facet" | "outer" | "endfacet" => {}
            _ => return Err(at("expected facet, outer, vertex, endloop, endfacet or endsolid")),
        }
    }
    if !ended || !corners.is_empty() {
        return Err(broken("it ends before `endsolid`".into()));
    }
    Ok(builder.finish()?)
}

fn vertex<'a>(mut words: impl Iterator<Item = &'a str>) -> Option<DVec3> {
    let mut next = || words.next()?.parse::<f64>().ok();
    Some(DVec3::new(next()?, next()?, next()?))
}

fn broken(problem: String) -> MeshError {
    MeshError::Broken { format: MeshFormat::Stl, problem }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bytes::tests::mutants;
    use lumiduct_base::mesh::bodies::block;
    use std::fmt::Write;

    fn binary(mesh: &TriangleMesh, header: &[u8]) -> Vec<u8> {
        let mut bytes = header.to_vec();
        bytes.resize(80, b' ');
        bytes.extend((mesh.triangles.len() as u32).to_le_bytes());
        for triangle in 0..mesh.triangles.len() {
            bytes.extend([0; NORMAL]);
            for corner in mesh.corners(triangle) {
                bytes.extend(corner.as_vec3().to_array().iter().flat_map(|c| c.to_le_bytes()));
            }
            bytes.extend([0; 2]);
        }
        bytes
    }

    fn ascii(mesh: &TriangleMesh) -> String {
        let mut text = String::new();
        for (face, name) in mesh.faces.iter().enumerate() {
            writeln!(text, "solid {name}").unwrap();
            for triangle in 0..mesh.triangles.len() {
                if mesh.face_of[triangle] as usize == face {
                    text += "facet normal 0 0 0\nouter loop\n";
                    for c in mesh.corners(triangle) {
                        writeln!(text, "vertex {:e} {:e} {:e}", c.x, c.y, c.z).unwrap();
                    }
                    text += "endloop\nendfacet\n";
                }
            }
            writeln!(text, "endsolid {name}").unwrap();
        }
        text
    }

    #[test]
    fn a_binary_block_comes_back_in_millimetres_with_eight_vertices() {
        let block = block(DVec3::new(1.0, 2.0, 3.0));
        for header in ["", "solid binary files may start like this"] {
            let mesh = read(&binary(&block, header.as_bytes()), LengthUnit::Inch).unwrap();
            assert_eq!(mesh.positions.len(), 8);
            assert_eq!(mesh.triangles.len(), 12);
            assert_eq!(mesh.faces, ["surface"]);
            for triangle in 0..12 {
                assert_eq!(mesh.corners(triangle), block.corners(triangle).map(|c| c * 25.4));
            }
        }
    }

    #[test]
    fn solids_of_an_ascii_file_become_faces() {
        let block = block(DVec3::new(1.0, 2.0, 0.1));
        let mesh = read(ascii(&block).as_bytes(), LengthUnit::Millimetre).unwrap();
        assert_eq!(mesh.faces, block.faces);
        assert_eq!(mesh.positions.len(), 8);
        let upper = ascii(&block).replace("facet", "FACET").replace("solid", "SOLID");
        assert_eq!(read(upper.as_bytes(), LengthUnit::Millimetre).unwrap(), mesh);
    }

    #[test]
    fn truncated_files_say_so() {
        let block = block(DVec3::ONE);
        let bytes = binary(&block, b"");
        let error = read(&bytes[..200], LengthUnit::Metre).unwrap_err().to_string();
        assert!(error.contains("it announces 12 triangles and holds 2"), "{error}");
        let mut huge = bytes.clone();
        huge[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
        let error = read(&huge, LengthUnit::Metre).unwrap_err().to_string();
        assert!(error.contains("announces 4294967295 triangles and holds 12"), "{error}");
        let text = ascii(&block);
        let cut = text.find("endfacet").unwrap();
        let error = read(&text.as_bytes()[..cut], LengthUnit::Metre).unwrap_err().to_string();
        assert!(error.contains("it ends before `endsolid`"), "{error}");
        assert!(matches!(
            read(b"solid nothing\nendsolid", LengthUnit::Metre),
            Err(MeshError::Unusable(UnusableMesh::NoTriangles))
        ));
    }

    #[test]
    fn mutated_files_never_panic_and_good_results_are_finite() {
        let block = block(DVec3::ONE);
        for original in [binary(&block, b"solid"), ascii(&block).into_bytes()] {
            for bytes in mutants(&original, 20_000, 3) {
                if let Ok(mesh) = read(&bytes, LengthUnit::Metre) {
                    assert!(mesh.positions.iter().all(|p| p.is_finite()));
                }
            }
        }
    }
}
