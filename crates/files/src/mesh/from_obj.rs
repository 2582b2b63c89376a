//! Wavefront OBJ: vertices, normals, polygons, and the names of materials or groups.
//!
//! Materials are used by name only, so the .mtl file is not needed; without materials the names of
//! `g` and `o` count. Curves, lines, points and texture coordinates are ignored. Source: Wavefront,
//! Advanced Visualizer manual, appendix B1 (version 3.0).

use crate::mesh::error::MeshError;
use crate::mesh::format::{LengthUnit, MeshFormat};
use glam::DVec3;
use lumiduct_base::mesh::{MeshBuilder, TriangleMesh, UNNAMED_FACE, area_vector};

/// Polygons with more corners are fanned from the first corner only: trying all takes quadratic
/// time.
const MAX_FANS: usize = 64;

/// What gives a face its name.
#[derive(Clone, Copy, PartialEq, Eq)]
enum NamedBy {
    Material,
    Group,
}

#[derive(Clone, Copy)]
struct Corner {
    position: DVec3,
    normal: Option<DVec3>,
}

/// Reads an OBJ file.
pub(crate) fn read(bytes: &[u8], unit: LengthUnit) -> Result<TriangleMesh, MeshError> {
    let text = String::from_utf8_lossy(bytes);
    let named_by = if text.lines().any(|line| line.trim_start().starts_with("usemtl ")) {
        NamedBy::Material
    } else {
        NamedBy::Group
    };
    let mut builder = MeshBuilder::default();
    let (mut positions, mut normals) = (Vec::new(), Vec::new());
    let mut face = UNNAMED_FACE;
    for (line, content) in text.lines().enumerate() {
        let at = |problem: &str| MeshError::Broken {
            format: MeshFormat::Obj,
            problem: format!("line {}: {problem}", line + 1),
        };
        if content.trim_end().ends_with('\\') {
            return Err(MeshError::Unsupported {
                what: format!("line {} of the OBJ file is continued by a backslash", line + 1),
                remedy: "export every face in one line",
            });
        }
        let (word, rest) = content.trim().split_once(char::is_whitespace).unwrap_or((content, ""));
        match word {
            "v" => {
                let position = vector(rest).ok_or_else(|| at("expected `v` and three numbers"))?;
                positions.push(position * unit.millimetres());
            }
            "vn" => {
                let normal = vector(rest).ok_or_else(|| at("expected `vn` and three numbers"))?;
                normals.push(normal);
            }
            "usemtl" if named_by == NamedBy::Material => face = rest,
            "g" | "o" if named_by == NamedBy::Group => face = rest,
            "f" => {
                let polygon = rest
                    .split_whitespace()
                    .map(|corner| parse_corner(corner, &positions, &normals))
                    .collect::<Option<Vec<_>>>()
                    .ok_or_else(|| at("a corner names a vertex or normal that does not exist"))?;
                if polygon.len() < 3 {
                    return Err(at("a face needs three corners"));
                }
                add_polygon(&mut builder, &polygon, face)?;
            }
            _ => {}
        }
    }
    Ok(builder.finish()?)
}

fn vector(text: &str) -> Option<DVec3> {
    let mut numbers = text.split_whitespace().map(str::parse::<f64>);
    let mut next = || numbers.next()?.ok();
    Some(DVec3::new(next()?, next()?, next()?))
}

/// `position`, `position/texture`, `position//normal` or `position/texture/normal`.
fn parse_corner(text: &str, positions: &[DVec3], normals: &[DVec3]) -> Option<Corner> {
    let mut parts = text.split('/');
    let position = *entry(positions, parts.next()?)?;
    let normal = match parts.nth(1) {
        None | Some("") => None,
        Some(index) => Some(*entry(normals, index)?),
    };
    Some(Corner { position, normal })
}

/// Entries count from 1, or backwards from -1, the latest.
fn entry<'a>(list: &'a [DVec3], index: &str) -> Option<&'a DVec3> {
    let index: i64 = index.parse().ok()?;
    let from_end = usize::try_from(index.unsigned_abs()).ok()?;
    if index > 0 { list.get(from_end - 1) } else { list.get(list.len().checked_sub(from_end)?) }
}

/// Cuts a polygon into a fan of triangles from a corner that sees all the others.
fn add_polygon(builder: &mut MeshBuilder, polygon: &[Corner], face: &str) -> Result<(), MeshError> {
    let start = fan_start(polygon).ok_or_else(|| MeshError::Unsupported {
        what: format!("a face with {} corners is not convex", polygon.len()),
        remedy: "triangulate the mesh on export",
    })?;
    for [a, b, c] in fan(polygon, start) {
        let normals = match (a.normal, b.normal, c.normal) {
            (Some(a), Some(b), Some(c)) => Some([a, b, c]),
            _ => None,
        };
        builder.add([a, b, c].map(|corner| corner.position), normals, face)?;
    }
    Ok(())
}

fn fan(polygon: &[Corner], start: usize) -> impl Iterator<Item = [Corner; 3]> {
    let corner = move |step: usize| polygon[(start + step) % polygon.len()];
    (1..polygon.len() - 1).map(move |step| [corner(0), corner(step), corner(step + 1)])
}

/// The corner whose fan's smallest triangle is largest; `None` if every fan folds over.
fn fan_start(polygon: &[Corner]) -> Option<usize> {
    if polygon.len() == 3 {
        return Some(0);
    }
    let vector = |triangle: [Corner; 3]| area_vector(triangle.map(|corner| corner.position));
    let whole: DVec3 = fan(polygon, 0).map(vector).sum();
    let smallest = |start: usize| {
        fan(polygon, start).map(|part| vector(part).dot(whole)).fold(f64::INFINITY, f64::min)
    };
    let starts = if polygon.len() <= MAX_FANS { polygon.len() } else { 1 };
    let (area, start) = (0..starts)
        .map(|start| (smallest(start), start))
        .max_by(|one, other| one.0.total_cmp(&other.0).then(other.1.cmp(&one.1)))?;
    // Corners on a straight side give triangles of zero area, which rounding may invert.
    (area >= -1e-6 * whole.length_squared()).then_some(start)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bytes::tests::mutants;
    use lumiduct_base::mesh::bodies::{Normals, icosphere, rod};
    use lumiduct_base::mesh::health;
    use std::fmt::Write;

    fn read_text(text: &str) -> Result<TriangleMesh, MeshError> {
        read(text.as_bytes(), LengthUnit::Millimetre)
    }

    fn write(mesh: &TriangleMesh) -> String {
        let mut text = String::from("mtllib nowhere.mtl\n");
        for p in &mesh.positions {
            writeln!(text, "v {} {} {}", p.x, p.y, p.z).unwrap();
        }
        for (index, triangle) in mesh.triangles.iter().enumerate() {
            writeln!(text, "usemtl {}", mesh.faces[mesh.face_of[index] as usize]).unwrap();
            let [a, b, c] = triangle.map(|vertex| vertex + 1);
            if let Some(normals) = &mesh.normals {
                for n in normals[index] {
                    writeln!(text, "vn {} {} {}", n.x, n.y, n.z).unwrap();
                }
                writeln!(text, "f {a}//-3 {b}//-2 {c}//-1").unwrap();
            } else {
                writeln!(text, "f {a} {b} {c}").unwrap();
            }
        }
        text
    }

    #[test]
    fn a_rod_comes_back_with_names_normals_and_all_digits() {
        let rod = rod(2.0, 40.0, 24, Normals::Smooth);
        let mesh = read_text(&write(&rod)).unwrap();
        assert_eq!(mesh.faces, ["wall", "entry", "exit"]);
        for triangle in 0..rod.triangles.len() {
            assert_eq!(mesh.corners(triangle), rod.corners(triangle));
        }
        assert!(mesh.normals.is_some());
        assert!(health(&mesh).is_sound());
    }

    #[test]
    fn groups_name_faces_where_there_are_no_materials() {
        let mesh = read_text(
            "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\ng front\nf 1/9/ 2 3 4\no back side\nf 4/1 3 2\n",
        )
        .unwrap();
        assert_eq!(mesh.faces, ["front", "back side"]);
        assert_eq!(mesh.face_of, [0, 0, 1]);
    }

    #[test]
    fn an_l_shaped_face_is_cut_from_its_reflex_corner_and_a_zigzag_is_refused() {
        let corners = "v 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 0\n";
        let mesh = read_text(&format!("{corners}f 1 2 3 4 5 6")).unwrap();
        let area: f64 = (0..mesh.triangles.len())
            .map(|triangle| {
                let area = area_vector(mesh.corners(triangle)).z;
                assert!(area >= 0.0);
                0.5 * area
            })
            .sum();
        assert_eq!(area, 3.0);
        let zigzag = "v 0 0 0\nv 1 3 0\nv 2 0 0\nv 3 3 0\nv 4 0 0\nv 4 4 0\nv 3 7 0\nv 2 4 0\nv 1 7 0\nv 0 4 0\n";
        let error = read_text(&format!("{zigzag}f 1 2 3 4 5 6 7 8 9 10")).unwrap_err();
        assert_eq!(
            error.to_string(),
            "a face with 10 corners is not convex; triangulate the mesh on export"
        );
    }

    #[test]
    fn bad_lines_are_named() {
        for (text, expected) in [
            ("v 1 2\n", "line 1: expected `v` and three numbers"),
            ("v 0 0 0\nf 1 1 2\n", "line 2: a corner names a vertex or normal that does not exist"),
            ("v 0 0 0\nf 1 1 0\n", "line 2: a corner names"),
            ("v 0 0 0\nf 1 1 -2\n", "line 2: a corner names"),
            ("v 0 0 0\nf 1 1 1//9223372036854775807\n", "line 2: a corner names"),
            ("v 0 0 0\nf 1 1 -9223372036854775808\n", "line 2: a corner names"),
            ("v 0 0 0\nf 1 1\n", "line 2: a face needs three corners"),
            ("v 0 0 nan\nf 1 1 1", "triangle 1 has a vertex that is not a finite number"),
            ("v 0 0 1e99\nf 1 1 1", "check the unit"),
            ("# nothing\n", "holds no triangles"),
        ] {
            let error = read_text(text).unwrap_err().to_string();
            assert!(error.contains(expected), "{text}: {error}");
        }
    }

    #[test]
    fn mutated_files_never_panic_and_good_results_are_finite() {
        let original = write(&icosphere(1.0, 0, Normals::Smooth)).into_bytes();
        for bytes in mutants(&original, 20_000, 5) {
            if let Ok(mesh) = read(&bytes, LengthUnit::Metre) {
                assert!(mesh.positions.iter().all(|p| p.is_finite()));
            }
        }
    }
}
