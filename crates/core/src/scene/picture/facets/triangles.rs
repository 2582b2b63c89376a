//! A surface as triangles with the lines along its rims.

use crate::scene::relief::Trim;
use glam::DVec3;

/// A surface as triangles.
#[derive(Debug, Clone, Default)]
pub struct Triangulation {
    /// Corners, mm.
    pub points: Vec<DVec3>,
    /// Triangles, as numbers of corners.
    pub triangles: Vec<[usize; 3]>,
    /// Lines along the rims, as numbers of corners.
    pub rims: Vec<Vec<usize>>,
}

impl Triangulation {
    /// Adds another surface.
    pub fn append(&mut self, other: Self) {
        let first = self.points.len();
        self.points.extend(other.points);
        self.triangles.extend(other.triangles.iter().map(|corners| corners.map(|i| first + i)));
        let rims = other.rims.into_iter();
        self.rims.extend(rims.map(|rim| rim.into_iter().map(|i| first + i).collect()));
    }

    /// The mean of the corners, mm; `None` without any.
    pub fn middle(&self) -> Option<DVec3> {
        let count = self.points.len() as f64;
        (!self.points.is_empty()).then(|| self.points.iter().sum::<DVec3>() / count)
    }

    pub(super) fn keep(&mut self, trim: &Trim) {
        let points = &self.points;
        self.triangles
            .retain(|corners| trim.keeps(corners.iter().map(|i| points[*i]).sum::<DVec3>() / 3.0));
        self.rims.retain(|rim| rim.iter().all(|i| trim.keeps(points[*i])));
    }
}
