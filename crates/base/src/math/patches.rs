//! Patches of directions: divisions of a hemisphere.
//!
//! A direction is given by its direction cosines along the face, a point of the unit disk. There cos θ dω is an area, so a patch of
//! directions is an area of the disk, and its projected solid angle is that area.

use crate::math::circle;
use glam::DVec2;
use std::f64::consts::{FRAC_PI_4, PI, TAU};

/// A division of the hemisphere.
#[derive(Debug, Clone, PartialEq)]
pub enum DirectionPatches {
    /// Rings of sectors.
    Rings(RingPatches),
    /// Patches of one projected solid angle, `side` by `side`: a square grid under the map of Shirley and Chiu, the second
    /// coordinate fastest.
    Squares {
        /// Patches along each coordinate, at least 1.
        side: usize,
    },
}

impl DirectionPatches {
    /// Number of patches.
    pub fn count(&self) -> usize {
        match self {
            Self::Rings(rings) => rings.count(),
            Self::Squares { side } => side * side,
        }
    }

    /// Projected solid angle of a patch, sr.
    pub fn projected(&self, patch: usize) -> f64 {
        match self {
            Self::Rings(rings) => rings.projected(rings.ring_and_sector(patch)[0]),
            Self::Squares { side } => PI / (side * side) as f64,
        }
    }

    /// The patch of a direction.
    pub fn patch(&self, cosines: DVec2) -> usize {
        match self {
            Self::Rings(rings) => {
                let ring = rings.ring(cosines.length_squared());
                rings.first[ring] + rings.sector(ring, turns(cosines))
            }
            Self::Squares { side } => {
                let line = |at: f64| ((at * *side as f64) as usize).min(side - 1);
                let at = square_of_disk(cosines);
                line(at.x) * side + line(at.y)
            }
        }
    }

    /// A direction of a patch, uniform over its projected solid angle; `u` in 0..1.
    pub fn direction(&self, patch: usize, u: [f64; 2]) -> DVec2 {
        match self {
            Self::Rings(rings) => {
                let [ring, sector] = rings.ring_and_sector(patch);
                rings.radius(ring, u[0]) * circle(rings.turns(ring, sector, u[1]))
            }
            Self::Squares { side } => {
                let at = DVec2::new((patch / side) as f64 + u[0], (patch % side) as f64 + u[1]);
                disk_of_square(at / *side as f64)
            }
        }
    }
}

/// Rings between polar angles, each divided into sectors of one size. Sector k of n lies about the azimuth 2πk/n.
#[derive(Debug, Clone, PartialEq)]
pub struct RingPatches {
    /// Squared sines of the polar angles between rings, from 0 to 1.
    sines_squared: Vec<f64>,
    sectors: Vec<usize>,
    /// The first patch of each ring, and the number of all.
    first: Vec<usize>,
}

impl RingPatches {
    /// Rings between polar angles that increase from 0 to a right angle, rad, and the number of sectors of each. `None` if the
    /// angles are not of this form, a ring is too narrow to have an area, or the numbers are not one for each ring.
    pub fn new(angles: &[f64], sectors: Vec<usize>) -> Option<Self> {
        let [from, .., to] = angles else { return None };
        let is_whole = *from == 0.0 && (to - 2.0 * FRAC_PI_4).abs() < 1e-9;
        let grows = angles.windows(2).all(|pair| pair[1] > pair[0]);
        let is_usable = is_whole && grows && !sectors.contains(&0);
        if !is_usable || sectors.len() + 1 != angles.len() {
            return None;
        }
        let mut sines_squared: Vec<f64> = angles.iter().map(|angle| angle.sin().powi(2)).collect();
        sines_squared[sectors.len()] = 1.0;
        if sines_squared.windows(2).any(|pair| pair[1] <= pair[0]) {
            return None;
        }
        let mut first = vec![0];
        for count in &sectors {
            first.push(first[first.len() - 1] + count);
        }
        Some(Self { sines_squared, sectors, first })
    }

    /// Number of rings.
    pub fn rings(&self) -> usize {
        self.sectors.len()
    }

    /// Number of sectors of a ring.
    pub fn sectors(&self, ring: usize) -> usize {
        self.sectors[ring]
    }

    /// Number of patches.
    pub fn count(&self) -> usize {
        self.first[self.rings()]
    }

    /// The first patch of a ring.
    pub fn first(&self, ring: usize) -> usize {
        self.first[ring]
    }

    /// Projected solid angle of each patch of a ring, sr.
    pub fn projected(&self, ring: usize) -> f64 {
        PI * (self.sines_squared[ring + 1] - self.sines_squared[ring]) / self.sectors[ring] as f64
    }

    /// The ring of a direction whose polar angle has this squared sine.
    pub fn ring(&self, square: f64) -> usize {
        self.sines_squared.partition_point(|edge| *edge <= square).clamp(1, self.rings()) - 1
    }

    /// The sector of an azimuth, in whole turns from 0 to 1.
    pub fn sector(&self, ring: usize, turns: f64) -> usize {
        let count = self.sectors[ring];
        (turns * count as f64 + 0.5) as usize % count
    }

    /// Sine of a polar angle within a ring, uniform in projected solid angle.
    pub fn radius(&self, ring: usize, u: f64) -> f64 {
        let [from, to] = [self.sines_squared[ring], self.sines_squared[ring + 1]];
        (from + u * (to - from)).sqrt()
    }

    /// An azimuth within a sector, in turns from 0 to 1.
    pub fn turns(&self, ring: usize, sector: usize, u: f64) -> f64 {
        ((sector as f64 + u - 0.5) / self.sectors[ring] as f64).rem_euclid(1.0)
    }

    /// Ring and sector of a patch.
    pub fn ring_and_sector(&self, patch: usize) -> [usize; 2] {
        let ring = self.first.partition_point(|first| *first <= patch) - 1;
        [ring, patch - self.first[ring]]
    }
}

/// Patches of light that arrives at a face and of light that leaves it.
#[derive(Debug, Clone, PartialEq)]
pub enum PatchPairs {
    /// Of both directions in axes of the face.
    Fixed {
        /// Of arriving light.
        incident: DirectionPatches,
        /// Of leaving light.
        leaving: DirectionPatches,
    },
    /// Of a face without grain: azimuths of leaving light count from that of arriving light.
    Isotropic {
        /// Of arriving light: the rings alone count.
        incident: RingPatches,
        /// Of leaving light.
        leaving: RingPatches,
    },
}

impl PatchPairs {
    /// Number of patches of arriving and of leaving light.
    pub fn counts(&self) -> [usize; 2] {
        match self {
            Self::Fixed { incident, leaving } => [incident.count(), leaving.count()],
            Self::Isotropic { incident, leaving } => [incident.rings(), leaving.count()],
        }
    }

    /// Projected solid angle of a patch of leaving light, sr.
    pub fn leaving_projected(&self, patch: usize) -> f64 {
        match self {
            Self::Fixed { leaving, .. } => leaving.projected(patch),
            Self::Isotropic { leaving, .. } => leaving.projected(leaving.ring_and_sector(patch)[0]),
        }
    }

    /// Projected solid angle of a patch of arriving light, sr: of a whole ring without grain.
    pub fn incident_projected(&self, patch: usize) -> f64 {
        match self {
            Self::Fixed { incident, .. } => incident.projected(patch),
            Self::Isotropic { incident, .. } => {
                incident.projected(patch) * incident.sectors(patch) as f64
            }
        }
    }

    /// The patch of arriving light.
    pub fn incident(&self, from: DVec2) -> usize {
        match self {
            Self::Fixed { incident, .. } => incident.patch(from),
            Self::Isotropic { incident, .. } => incident.ring(from.length_squared()),
        }
    }
}

/// A direction within each overlap of patches of several divisions, also where one is turned by half a turn. Of squares, the middles
/// of the smallest: others are multiples of them.
pub fn common_directions(divisions: &[DirectionPatches]) -> Vec<DVec2> {
    let (mut rings, mut finest) = (Vec::new(), 0);
    for division in divisions {
        match division {
            DirectionPatches::Rings(own) => rings.push(own),
            DirectionPatches::Squares { side } => finest = finest.max(*side),
        }
    }
    let squares = DirectionPatches::Squares { side: finest };
    let mut all: Vec<DVec2> =
        (0..squares.count()).map(|patch| squares.direction(patch, [0.5; 2])).collect();
    let edges = rings.iter().flat_map(|own| own.sines_squared.iter().copied());
    for square in middles(edges.collect()) {
        // Edges are odd multiples of half a sector, and even ones where half a turn is half a sector more.
        let turns = rings.iter().flat_map(|own| {
            let halves = 2 * own.sectors[own.ring(square)];
            (0..=halves).map(move |half| half as f64 / halves as f64)
        });
        let turns = turns.collect();
        all.extend(middles(turns).into_iter().map(|turn| square.sqrt() * circle(turn)));
    }
    all
}

/// Numbers halfway between neighbours, of numbers in any order and several times.
fn middles(mut edges: Vec<f64>) -> Vec<f64> {
    /// Edges closer than this are the same.
    const SAME: f64 = 1e-9;
    edges.sort_by(f64::total_cmp);
    let pairs = edges.windows(2).filter(|pair| pair[1] - pair[0] > SAME);
    pairs.map(|pair| 0.5 * (pair[0] + pair[1])).collect()
}

/// The azimuth of a direction, in turns from 0 to 1.
pub fn turns(cosines: DVec2) -> f64 {
    (cosines.y.atan2(cosines.x) / TAU).rem_euclid(1.0)
}

/// The point of the unit disk for one of the unit square, a map that keeps shares of area (P. Shirley and K. Chiu, A low distortion
/// map between disk and square, Journal of Graphics Tools 2(3), 1997). The middle of the right edge is at the azimuth 0.
fn disk_of_square(at: DVec2) -> DVec2 {
    let DVec2 { x: a, y: b } = 2.0 * at - DVec2::ONE;
    let (radius, angle) = match (a > -b, a > b) {
        (true, true) => (a, b / a),
        (true, false) => (b, 2.0 - a / b),
        (false, false) if a < b => (-a, 4.0 + b / a),
        (false, _) if b == 0.0 => (0.0, 0.0),
        (false, _) => (-b, 6.0 - a / b),
    };
    radius * circle((angle / 8.0).rem_euclid(1.0))
}

/// The point of the unit square for one of the unit disk: the inverse of `disk_of_square`.
pub fn square_of_disk(at: DVec2) -> DVec2 {
    let radius = at.length();
    // From an eighth of a turn before the azimuth 0.
    let eighths = (8.0 * turns(at) + 1.0).rem_euclid(8.0);
    let along = |from: f64| (eighths - from) * radius;
    let (a, b) = match (eighths / 2.0) as u32 {
        0 => (radius, along(1.0)),
        1 => (-along(3.0), radius),
        2 => (-radius, -along(5.0)),
        _ => (along(7.0), -radius),
    };
    0.5 * (DVec2::new(a, b) + DVec2::ONE)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn klems() -> RingPatches {
        let angles = [0.0f64, 9.0, 27.0, 45.0, 63.0, 90.0].map(f64::to_radians);
        RingPatches::new(&angles, vec![1, 8, 12, 12, 8]).unwrap()
    }

    #[test]
    fn patches_cover_the_disk_and_find_their_own_directions() {
        for patches in [
            DirectionPatches::Rings(klems()),
            DirectionPatches::Squares { side: 8 },
            DirectionPatches::Squares { side: 1 },
        ] {
            let all = 0..patches.count();
            let sum: f64 = all.clone().map(|patch| patches.projected(patch)).sum();
            assert!((sum - PI).abs() < 1e-12);
            for patch in all {
                for u in [[0.01, 0.02], [0.5, 0.5], [0.99, 0.97], [0.02, 0.98]] {
                    let at = patches.direction(patch, u);
                    assert!(at.length() < 1.0);
                    assert_eq!(patches.patch(at), patch, "{patches:?} {u:?} {at}");
                }
            }
            let edges = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::NEG_X, DVec2::NEG_Y];
            assert!(edges.iter().all(|at| patches.patch(*at) < patches.count()));
        }
    }

    #[test]
    fn directions_are_uniform_over_the_disk() {
        // A fine grid of u has the second moment of the disk, 1/4 along each axis.
        for patches in [DirectionPatches::Rings(klems()), DirectionPatches::Squares { side: 2 }] {
            let mut sum = DVec2::ZERO;
            for patch in 0..patches.count() {
                for point in 0..1600 {
                    let u = [point / 40, point % 40].map(|line| (f64::from(line) + 0.5) / 40.0);
                    let at = patches.direction(patch, u);
                    sum += at * at * patches.projected(patch) / (1600.0 * PI);
                }
            }
            assert!((sum - DVec2::splat(0.25)).abs().max_element() < 2e-4, "{sum}");
        }
    }

    #[test]
    fn common_directions_are_in_every_overlap() {
        let rings = |angles: &[f64], sectors: &[usize]| {
            let angles: Vec<f64> = angles.iter().map(|angle| angle.to_radians()).collect();
            DirectionPatches::Rings(RingPatches::new(&angles, sectors.to_vec()).unwrap())
        };
        let divisions = [
            rings(&[0.0, 30.0, 90.0], &[1, 5]),
            rings(&[0.0, 33.0, 90.0], &[4, 6]),
            rings(&[0.0, 90.0], &[3]),
        ];
        let of = |at: DVec2| divisions.each_ref().map(|own| own.patch(at));
        let turned = |at: DVec2| [divisions[0].patch(-at), divisions[1].patch(at)];
        let common = common_directions(&divisions);
        let disk = DirectionPatches::Squares { side: 300 };
        for at in (0..disk.count()).map(|patch| disk.direction(patch, [0.5; 2])) {
            assert!(common.iter().any(|own| of(*own) == of(at)), "{at}");
            assert!(common.iter().any(|own| turned(*own) == turned(at)), "{at}");
        }
        let squares = [2, 8].map(|side| DirectionPatches::Squares { side });
        assert_eq!(common_directions(&squares).len(), 64);
    }

    #[test]
    fn the_square_map_has_fixed_points_and_an_inverse() {
        let corner = 0.5f64.sqrt();
        for (square, disk) in [
            ([0.5, 0.5], [0.0, 0.0]),
            ([1.0, 0.5], [1.0, 0.0]),
            ([0.5, 1.0], [0.0, 1.0]),
            ([0.0, 0.5], [-1.0, 0.0]),
            ([0.5, 0.0], [0.0, -1.0]),
            ([1.0, 1.0], [corner, corner]),
            ([0.0, 0.0], [-corner, -corner]),
            ([0.75, 0.5], [0.5, 0.0]),
        ] {
            let found = disk_of_square(DVec2::from_array(square));
            assert!((found - DVec2::from_array(disk)).length() < 1e-15, "{square:?}: {found}");
        }
        for point in 0..400 {
            let square =
                DVec2::new(f64::from(point / 20) + 0.3, f64::from(point % 20) + 0.6) / 20.0;
            let back = square_of_disk(disk_of_square(square));
            assert!((back - square).length() < 1e-14, "{square} {back}");
        }
    }

    #[test]
    fn rings_that_do_not_cover_a_hemisphere_are_refused() {
        for (angles, sectors) in [
            (vec![], vec![]),
            (vec![0.0], vec![]),
            (vec![0.0, 1.0], vec![4]),
            (vec![0.1, 2.0 * FRAC_PI_4], vec![4]),
            (vec![0.0, 1.0, 0.5, 2.0 * FRAC_PI_4], vec![1, 2, 3]),
            (vec![0.0, 2.0 * FRAC_PI_4], vec![0]),
            (vec![0.0, 2.0 * FRAC_PI_4], vec![1, 1]),
            (vec![0.0, 2.0 * FRAC_PI_4 - 1e-12, 2.0 * FRAC_PI_4], vec![1, 1]),
            (vec![0.0, f64::NAN, 2.0 * FRAC_PI_4], vec![1, 1]),
        ] {
            assert!(RingPatches::new(&angles, sectors.clone()).is_none(), "{angles:?} {sectors:?}");
        }
    }
}
