//! Parts that continue each other without an edge.

use crate::scene::sweep::path::{PathPiece, PieceForm};
use glam::DVec2;

/// The numbers of the smooth surfaces that the walls of a sweep belong to, along the path.
pub(super) struct SmoothNumbers {
    /// One for each wall.
    ids: Vec<u32>,
    next: u32,
    /// Growth of the scale per length of the previous piece, 1/mm; `None` at the entry.
    growth: Option<f64>,
}

impl SmoothNumbers {
    pub(super) fn new(walls: usize) -> Self {
        Self { ids: (0u32..).take(walls).collect(), next: walls as u32, growth: None }
    }

    /// Advances to the next piece. `turns(wall, toward)` is true if a corner toward an azimuth
    /// changes the direction of a wall; the walls along the plane of the corner continue through
    /// it.
    pub(super) fn enter(&mut self, piece: &PathPiece, turns: impl Fn(usize, DVec2) -> bool) {
        let growth = match &piece.form {
            PieceForm::Corner { toward, .. } => {
                for wall in 0..self.ids.len() {
                    if turns(wall, *toward) {
                        self.ids[wall] = self.fresh();
                    }
                }
                return;
            }
            PieceForm::Taper { length, end_scale } => (end_scale - piece.start.scale) / length,
            PieceForm::Prism { .. } | PieceForm::Bend { .. } => 0.0,
        };
        let before = self.growth.replace(growth).unwrap_or(growth);
        // Equal up to rounding: two legs of one cone.
        if (growth - before).abs() > 1e-9 * growth.abs().max(before.abs()) {
            for wall in 0..self.ids.len() {
                self.ids[wall] = self.fresh();
            }
        }
    }

    /// The number of a wall on the current piece.
    pub(super) fn id(&self, wall: usize) -> u32 {
        self.ids[wall]
    }

    /// A new number.
    pub(super) fn fresh(&mut self) -> u32 {
        self.next += 1;
        self.next - 1
    }
}
