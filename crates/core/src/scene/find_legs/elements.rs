//! Where the elements of patterns are on a round wall.

use crate::scene::pattern::Columns;
use crate::scene::plain_leg::ElementBand;
use crate::scene::sweep::WallChart;
use crate::scene::{Patch, Scene};
use glam::DVec2;
use std::f64::consts::PI;

/// Margin of a band around its elements, for rounding, relative to the radius of the wall, 1.
const MARGIN: f64 = 1e-9;

/// A band for each pattern on a round wall; `None` where its place on the wall is not known.
pub(super) fn on_round_wall(
    scene: &Scene,
    patch: &Patch,
    radius: f64,
) -> Option<Box<[ElementBand]>> {
    let numbers = &scene.faces[patch.face.index()].patterns;
    if numbers.is_empty() {
        return Some(Box::default());
    }
    // Patterns refer to the chart of the whole guide.
    let (offset, scale) = match patch.chart {
        None => (DVec2::ZERO, DVec2::ONE),
        Some(WallChart::Along { offset, scale }) => (offset, scale),
        Some(WallChart::Across { .. } | WallChart::Trapezoid { .. } | WallChart::Sector { .. }) => {
            return None;
        }
    };
    let fields = numbers.iter().map(|number| &scene.patterns[*number].field);
    let fields = fields.filter(|field| field.count() > 0);
    let bands = fields.map(|field| {
        let Columns { first, pitch, count, shift } = field.columns;
        let [mut along, mut across] = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        let last = first + pitch * (count.max(1) - 1) as f64;
        for row in 0..field.rows.count() {
            let place = field.rows.place(row);
            let half = 0.5 * field.outline.size(place);
            along = [along[0].min(place - half.y), along[1].max(place + half.y)];
            across = [
                across[0].min(first.min(first + shift) - half.x),
                across[1].max(last.max(last + shift) + half.x),
            ];
        }
        let on_wall = |axis: usize, ends: [f64; 2]| {
            let [a, b] = ends.map(|end| (end - offset[axis]) / scale[axis]);
            [a.min(b), a.max(b)]
        };
        let [along, across] = [on_wall(1, along), on_wall(0, across)];
        let margin = MARGIN * radius;
        // More than half a turn either way is all around, as are rings, which have no ends.
        let half = (0.5 * (across[1] - across[0]) + margin) / radius;
        let is_narrow = half < PI;
        ElementBand {
            toward: if is_narrow {
                DVec2::from_angle(0.5 * (across[0] + across[1]) / radius)
            } else {
                DVec2::X
            },
            least: if is_narrow { radius * half.cos() - margin } else { f64::NEG_INFINITY },
            along: [along[0] - margin, along[1] + margin],
        }
    });
    Some(bands.collect())
}
