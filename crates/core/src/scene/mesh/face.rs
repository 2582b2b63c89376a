//! The faces of a mesh: their triangles, areas, and points on them.

use lumiduct_base::mesh::{TriangleMesh, area_vector};

/// The triangles of one material or group.
#[derive(Debug, Clone)]
pub(super) struct MeshFace {
    pub(super) name: String,
    pub(super) triangles: Vec<u32>,
    /// Area of the triangles up to and including each one, mm².
    area_up_to: Vec<f64>,
}

impl MeshFace {
    /// Area, mm².
    pub(super) fn area(&self) -> f64 {
        self.area_up_to.last().copied().unwrap_or(0.0)
    }

    /// A triangle, with the probability of its share of the area for a uniform `u`, and a number that is uniform again; `None` for a
    /// face without area.
    pub(super) fn pick(&self, u: f64) -> Option<(usize, f64)> {
        let total = self.area_up_to.last().copied().filter(|total| *total > 0.0)?;
        // Below the total even after rounding, so that there is a triangle, and one with an area.
        let wanted = (u * total).min(total.next_down());
        let index = self.area_up_to.partition_point(|area| *area <= wanted);
        let before = if index == 0 { 0.0 } else { self.area_up_to[index - 1] };
        let rest = ((wanted - before) / (self.area_up_to[index] - before)).clamp(0.0, 1.0);
        Some((self.triangles[index] as usize, rest))
    }
}

/// The faces of a mesh whose triangles are given new numbers.
pub(super) fn faces(mesh: &TriangleMesh, number: &[u32]) -> Vec<MeshFace> {
    let empty = |name: &String| MeshFace {
        name: name.clone(),
        triangles: Vec::new(),
        area_up_to: Vec::new(),
    };
    let mut faces: Vec<MeshFace> = mesh.faces.iter().map(empty).collect();
    for (triangle, face) in mesh.face_of.iter().enumerate() {
        let face = &mut faces[*face as usize];
        let before = face.area_up_to.last().copied().unwrap_or(0.0);
        face.triangles.push(number[triangle]);
        face.area_up_to.push(before + 0.5 * area_vector(mesh.corners(triangle)).length());
    }
    faces
}

#[cfg(test)]
mod tests {
    use crate::rng::{Dimension, Sampler};
    use crate::scene::mesh::Mesh;
    use glam::DVec3;
    use lumiduct_base::math::Frame;
    use lumiduct_base::mesh::bodies::block;

    #[test]
    fn samples_are_uniform_over_a_face() {
        let mesh = Mesh::new(&block(DVec3::new(1.0, 2.0, 3.0)), &Frame::WORLD);
        let face = mesh.face_names().position(|name| name == "plus_x").unwrap();
        let n = 20_000u64;
        let mut bins = [0u32; 16];
        for index in 0..n {
            let u = Sampler::for_path(31, 0, index).pair(Dimension::EmitPosition);
            let sample = mesh.sample(face, u).unwrap();
            assert_eq!(mesh.face_of(sample.triangle), face);
            assert!((sample.point.x - 1.0).abs() < 1e-15);
            let (y, z) = (sample.point.y / 2.0 * 4.0, sample.point.z / 3.0 * 4.0);
            bins[(y as usize).min(3) * 4 + (z as usize).min(3)] += 1;
        }
        let expected = n as f64 / 16.0;
        let chi2: f64 = bins.iter().map(|&b| (f64::from(b) - expected).powi(2) / expected).sum();
        // 99.9 % point of chi-square with 15 degrees of freedom: 37.7.
        assert!(chi2 < 37.7, "chi-square {chi2}");
        assert!((mesh.face_area(face) - 6.0).abs() < 1e-14);
    }
}
