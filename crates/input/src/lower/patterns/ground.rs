//! The faces that patterns and reliefs can lie on: those that unroll without stretching.

use crate::keys::Key;
use crate::lower::context::Context;
use glam::DVec2;
use lumiduct_core::scene::shape::{ChartRect, Cylinder, Flat, Region};
use lumiduct_core::scene::sweep::WallChart;
use lumiduct_core::scene::{FaceId, Patch};
use std::f64::consts::TAU;

/// Deviation from a stretch of 1 that counts as rounding, 1.
const ROUNDING: f64 = 1e-6;

/// A face as a pattern sees it.
#[derive(Debug, Clone, Copy)]
pub(in crate::lower) struct PatternGround {
    pub(in crate::lower) face: FaceId,
    pub(in crate::lower) rect: ChartRect,
    /// Radius of a round face that closes on itself, mm.
    pub(in crate::lower) radius: Option<f64>,
}

impl PatternGround {
    pub(in crate::lower) fn size(&self) -> DVec2 {
        self.rect.max - self.rect.min
    }

    /// Circumference, mm.
    pub(in crate::lower) fn period(&self) -> Option<f64> {
        self.radius.map(|radius| TAU * radius)
    }
}

impl Context<'_> {
    /// The face of a pattern: one whose chart is not stretched.
    pub(in crate::lower) fn ground(&mut self, name: &str, key: &Key) -> Option<PatternGround> {
        let faces = self.faces_named(name, key)?;
        let [face] = faces[..] else {
            let message = format!("`{name}` names {} faces, expected one", faces.len());
            return self.refuse(key, message, "name one of them, such as `wall_plus_x`");
        };
        let scene = self.builder.scene();
        let patches = scene.face_patches(face);
        let (true, Some(rect)) =
            (!patches.is_empty() && patches.iter().all(is_unrolled_truly), scene.face_rect(face))
        else {
            let message = format!(
                "`{name}` is neither a flat rectangle nor the wall of a straight round tube or rod"
            );
            let hint = "a pattern needs a face that unrolls without being stretched";
            return self.refuse(key, message, hint);
        };
        let is_round = patches[0].shape.as_cylinder().is_some_and(Cylinder::is_closed);
        let radius = is_round.then(|| (rect.max.x - rect.min.x) / TAU);
        Some(PatternGround { face, rect, radius })
    }
}

/// Whether lengths on a patch are those of its chart.
fn is_unrolled_truly(patch: &Patch) -> bool {
    let keeps_lengths = match &patch.chart {
        None => true,
        Some(WallChart::Along { scale, .. }) => (scale.abs() - DVec2::ONE).length() < ROUNDING,
        Some(WallChart::Across { .. } | WallChart::Trapezoid { .. } | WallChart::Sector { .. }) => {
            false
        }
    };
    let is_rectangle = |flat: &Flat| matches!(flat.region(), Region::Rectangle { .. });
    let is_whole =
        patch.shape.as_cylinder().is_some() || patch.shape.as_flat().is_some_and(is_rectangle);
    keeps_lengths && is_whole
}
