//! Meshes of simple bodies of known volume and area, for tests and benches.
//!
//! Sizes are mm. All functions panic on sizes that are non-finite or beyond
//! `mesh::MAX_COORDINATE_MM`.

use crate::mesh::{MeshBuilder, TriangleMesh};
use glam::DVec3;
use std::f64::consts::TAU;

/// Whether a mesh carries the normals of the surface it approximates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Normals {
    /// Normals of the surface.
    Smooth,
    /// No normals.
    None,
}

/// A mesh under construction whose sizes are known to be valid.
#[derive(Default)]
pub(super) struct BodyBuilder(MeshBuilder);

impl BodyBuilder {
    pub(super) fn add(&mut self, corners: [DVec3; 3], normals: Option<[DVec3; 3]>, face: &str) {
        self.0.add(corners, normals, face).expect("sizes are finite and moderate");
    }

    pub(super) fn finish(self) -> TriangleMesh {
        self.0.finish().expect("every body has triangles")
    }
}

/// A closed box from the origin to `size`, one face per side, no normals.
pub fn block(size: DVec3) -> TriangleMesh {
    let mut builder = BodyBuilder::default();
    let corner = |bits: usize| {
        DVec3::new((bits & 1) as f64, (bits >> 1 & 1) as f64, (bits >> 2 & 1) as f64) * size
    };
    let sides = [
        ("minus_z", [0, 2, 3, 1]),
        ("plus_z", [4, 5, 7, 6]),
        ("minus_y", [0, 1, 5, 4]),
        ("plus_y", [2, 6, 7, 3]),
        ("minus_x", [0, 4, 6, 2]),
        ("plus_x", [1, 3, 7, 5]),
    ];
    for (name, quad) in sides {
        let [a, b, c, d] = quad.map(corner);
        builder.add([a, b, c], None, name);
        builder.add([a, c, d], None, name);
    }
    builder.finish()
}

/// A sphere about the origin: an icosahedron with each triangle split into four, `level` times.
pub fn icosphere(radius: f64, level: u32, normals: Normals) -> TriangleMesh {
    let golden = 0.5 * (1.0 + 5.0f64.sqrt());
    let mut corners = Vec::new();
    for axis in 0..3 {
        for (a, b) in [(-1.0, -golden), (-1.0, golden), (1.0, -golden), (1.0, golden)] {
            let v = [0.0, a, b];
            corners.push(DVec3::new(v[(3 - axis) % 3], v[(4 - axis) % 3], v[(5 - axis) % 3]));
        }
    }
    let mut triangles = Vec::new();
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                let (a, b, c) = (corners[i], corners[j], corners[k]);
                // Edges have length 2, all other distances are longer.
                if [(a, b), (b, c), (c, a)].iter().all(|(p, q)| p.distance(*q) < 2.1) {
                    let outward = (b - a).cross(c - a).dot(a) > 0.0;
                    triangles.push(if outward { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    for _ in 0..level {
        triangles = triangles.into_iter().flat_map(split).collect();
    }
    let mut builder = BodyBuilder::default();
    for triangle in triangles {
        let unit = triangle.map(DVec3::normalize);
        let normals = (normals == Normals::Smooth).then_some(unit);
        builder.add(unit.map(|p| radius * p), normals, "");
    }
    builder.finish()
}

fn split([a, b, c]: [DVec3; 3]) -> [[DVec3; 3]; 4] {
    // Sums commute exactly, so neighbours get the same midpoint.
    let middle = |p: DVec3, q: DVec3| (p.normalize() + q.normalize()).normalize();
    let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
}

/// A closed round rod of `sides` facets along +z, faces entry, exit and wall; caps have flat normals if any.
pub fn rod(radius: f64, length: f64, sides: u32, normals: Normals) -> TriangleMesh {
    let mut builder = BodyBuilder::default();
    let rim = |side: u32, z: f64| {
        let (sin, cos) = (TAU * f64::from(side % sides) / f64::from(sides)).sin_cos();
        DVec3::new(radius * cos, radius * sin, z)
    };
    let wall = |corners: [DVec3; 3]| {
        (normals == Normals::Smooth).then_some(corners.map(|p| DVec3::new(p.x, p.y, 0.0)))
    };
    let cap = |normal: DVec3| (normals == Normals::Smooth).then_some([normal; 3]);
    for side in 0..sides {
        let [a, b, c, d] =
            [(0, 0.0), (1, 0.0), (1, length), (0, length)].map(|(step, z)| rim(side + step, z));
        for corners in [[a, b, c], [a, c, d]] {
            builder.add(corners, wall(corners), "wall");
        }
        builder.add([DVec3::ZERO, b, a], cap(-DVec3::Z), "entry");
        builder.add([length * DVec3::Z, d, c], cap(DVec3::Z), "exit");
    }
    builder.finish()
}
