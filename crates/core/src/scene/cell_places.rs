//! Where the cells of a sensor lie along a straight face that carries a pattern.

use crate::scene::{FaceId, Grid, Scene, SurfaceSensor};
use glam::DVec3;

impl Scene {
    /// Length of a face along its chart, mm; `None` without a chart.
    pub fn face_length(&self, face: FaceId) -> Option<f64> {
        self.face_rect(face).map(|rect| rect.max.y - rect.min.y)
    }

    /// Position of the middle of every cell of a sensor along a face, mm from the start of the face: its foot on the straight
    /// line along which the face runs. `None` for a polar grid, for cells on several faces, or where sensor or
    /// face have no axes.
    pub fn cell_places(&self, sensor: &SurfaceSensor, face: FaceId) -> Option<Vec<f64>> {
        let ground = self.face_axes(face)?;
        let middles = self.cell_middles(sensor)?;
        let start = ground.at.y - ground.rect.min.y;
        Some(middles.map(|point| start + (point - ground.origin).dot(ground.v)).collect())
    }

    /// Middles of the cells, mm; on a round wall their positions along it alone are exact. The cells lie in the chart of their face.
    fn cell_middles(&self, sensor: &SurfaceSensor) -> Option<impl Iterator<Item = DVec3>> {
        let [face] = sensor.faces.as_slice() else { return None };
        let own = self.face_axes(*face)?;
        let grid = match &sensor.grid {
            Grid::Cartesian { .. } => sensor.grid.clone(),
            Grid::Polar { .. } => return None,
        };
        Some((0..grid.cells()).map(move |cell| {
            let from = grid.center(cell) - own.at;
            own.origin + from.x * own.u + from.y * own.v
        }))
    }
}
