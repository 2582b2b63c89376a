//! The part of a lobe above the horizon.
//!
//! Directions that leave into a medium of index n are the points of a disk of radius n, and the
//! lobe is centred on a point at the distance p from its middle. The part within that disk is
//! `C(p, n) = (1/2π) ∮ (M(d_out) - M(d_in)) dφ`, where the ray of azimuth φ from the centre of the
//! lobe lies in the disk between `d_in` (0 where the centre is in it) and `d_out`, and M(d) is the
//! part of the lobe within the distance d.

use crate::optics::haze::profile::LawProfile;
use std::f64::consts::{FRAC_PI_2, PI};

/// Nodes from the middle of the disk to its rim.
const INSIDE: usize = 97;
/// Nodes from the rim to four times its radius.
const OUTSIDE: usize = 65;
/// Farthest centre of a lobe in radii of the disk: index 4 against index 1.
const FARTHEST: f64 = 4.0;
/// Nodes over the inverse of the index, from 1/4 to 1.
const INDICES: usize = 13;
/// The largest index.
const GREATEST: f64 = 4.0;

/// The indices for which the share above the horizon is needed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum HorizonIndices {
    /// 1, as in air, for sheets.
    One,
    /// 1 to 4, for interfaces.
    Any,
}

/// `C(p, n) / M(n)` in a table: 1 for a lobe in the middle of its disk.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Horizon {
    rows: Vec<IndexRow>,
}

/// The table of one index.
#[derive(Debug, Clone, PartialEq)]
struct IndexRow {
    inside: Vec<f64>,
    outside: Vec<f64>,
}

impl Horizon {
    pub(crate) fn new(profile: &LawProfile, indices: HorizonIndices) -> Self {
        let rows = match indices {
            HorizonIndices::One => vec![IndexRow::new(profile, 1.0)],
            HorizonIndices::Any => {
                (0..INDICES).map(|node| IndexRow::new(profile, 1.0 / inverse_index(node))).collect()
            }
        };
        Self { rows }
    }

    /// The share `C(p, n)/M(n)`, 1, of a lobe centred at `center` from the middle of a disk of radius `index`.
    pub(crate) fn share(&self, center: f64, index: f64) -> f64 {
        let place = center / index;
        let [first, ..] = self.rows.as_slice() else { return 0.0 };
        if self.rows.len() == 1 {
            return first.at(place);
        }
        let node = (index.recip() - GREATEST.recip()) / (1.0 - GREATEST.recip());
        let (node, fraction) = split(node, INDICES);
        let [low, high] = [node, node + 1].map(|node| self.rows[node].at(place));
        low + (high - low) * fraction
    }
}

fn inverse_index(node: usize) -> f64 {
    GREATEST.recip() + (1.0 - GREATEST.recip()) * node as f64 / (INDICES - 1) as f64
}

/// The node below a position in 0..=1 on a grid, and the fraction of the way to the next one.
fn split(place: f64, nodes: usize) -> (usize, f64) {
    let place = place.clamp(0.0, 1.0) * (nodes - 1) as f64;
    let node = (place as usize).min(nodes - 2);
    (node, place - node as f64)
}

impl IndexRow {
    fn new(profile: &LawProfile, index: f64) -> Self {
        let all = profile.within(index);
        let share = |place: f64| above(profile, place * index, index) / all;
        let cube = |node: usize, nodes: usize| (node as f64 / (nodes - 1) as f64).powi(3);
        // Cubes: a narrow lobe is cut within its own width of the rim.
        let inside = (0..INSIDE).map(|node| share(1.0 - cube(node, INSIDE))).collect();
        let outside =
            (0..OUTSIDE).map(|node| share(1.0 + (FARTHEST - 1.0) * cube(node, OUTSIDE))).collect();
        Self { inside, outside }
    }

    fn at(&self, place: f64) -> f64 {
        let (values, from_rim) = if place <= 1.0 {
            (&self.inside, 1.0 - place)
        } else {
            (&self.outside, (place - 1.0) / (FARTHEST - 1.0))
        };
        let (node, fraction) = split(from_rim.cbrt(), values.len());
        values[node] + (values[node + 1] - values[node]) * fraction
    }
}

/// C(p, n) by the midpoint rule; nodes crowd where the ray runs along the rim.
fn above(profile: &LawProfile, center: f64, index: f64) -> f64 {
    let nodes = 128;
    let steps = || (0..nodes).map(|i| (f64::from(i) + 0.5) / f64::from(nodes));
    // Half of the chord, and the distance of its middle from the centre of the lobe, at an azimuth
    // from the nearest rim.
    let chord = |phi: f64| {
        let half = (index * index - (center * phi.sin()).powi(2)).max(0.0).sqrt();
        (half, center * phi.cos())
    };
    if center > index {
        let widest = (index / center).asin();
        let sum: f64 = steps()
            .map(|t| {
                let (half, middle) = chord(widest * (1.0 - t.powi(3)));
                3.0 * t * t * (profile.within(middle + half) - profile.within(middle - half))
            })
            .sum();
        return sum * widest / (PI * f64::from(nodes));
    }
    // From the centre outward to the near rim, and inward to the far one.
    let sum: f64 = steps()
        .map(|t| {
            let (half, middle) = chord(FRAC_PI_2 * (1.0 - t.powi(3)));
            let near = profile.within((half - middle).max(0.0));
            3.0 * t * t * (near + profile.within(half + middle))
        })
        .sum();
    sum / (2.0 * f64::from(nodes))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::HazeLaw;

    /// C(p, n) by a sum over a grid of the disk.
    fn by_grid(law: HazeLaw, center: f64, index: f64) -> f64 {
        let rows = 1500;
        let h = 2.0 * index / f64::from(rows);
        let at = |i: i32| -index + h * (f64::from(i) + 0.5);
        let mut sum = 0.0;
        for (x, y) in (0..rows * rows).map(|cell| (at(cell / rows), at(cell % rows))) {
            if x.hypot(y) < index {
                sum += law.at((x - center).hypot(y));
            }
        }
        sum * h * h
    }

    #[test]
    fn the_share_above_the_horizon_is_that_of_a_sum_over_the_disk() {
        for law in [
            HazeLaw::Abg { a: 0.01, b: 3e-3, g: 2.2 },
            HazeLaw::Abg { a: 0.2, b: 1.0, g: 0.0 },
            HazeLaw::Harvey { b0: 1.0, shoulder: 0.1, slope: -1.5 },
        ] {
            let profile = LawProfile::new(law);
            let horizon = Horizon::new(&profile, HorizonIndices::Any);
            for (center, index) in
                [(0.0, 1.0), (0.7, 1.0), (0.98, 1.0), (1.0, 1.37), (1.2, 1.0), (1.49, 1.1)]
            {
                let expected = by_grid(law, center, index);
                let share = horizon.share(center, index) * profile.within(index);
                let off = (share / expected - 1.0).abs();
                assert!(off < 3e-3, "{law:?} at {center} of {index}: {share}, {expected}");
            }
        }
    }
}
