//! An isotropic distribution function by angles, linear between them, averaged over patches.

use crate::scatter::data::BsdfMatrix;
use lumiduct_base::math::{DirectionPatches, PatchPairs, RingPatches, turns};

/// Widths of patches that are tried, deg.
const STEPS_DEG: [f64; 6] = [1.0, 1.5, 2.0, 3.0, 4.0, 6.0];
/// Most pairs of patches.
const MOST_PAIRS: usize = 1 << 19;
/// Points along each axis at which a patch is averaged.
const POINTS: usize = 2;

/// Values over a grid of angles, deg, each of which grows.
#[derive(Debug)]
pub(super) struct SampledScatter {
    /// Polar angles of arriving light.
    pub(super) incident: Vec<f64>,
    /// Polar angles of leaving light.
    pub(super) polar: Vec<f64>,
    /// Azimuths of leaving light: 0 for light that is mirrored or goes straight on.
    pub(super) azimuth: Vec<f64>,
    /// Values, 1/sr, the azimuth fastest.
    pub(super) values: Vec<f64>,
}

impl SampledScatter {
    /// What is assumed where angles are missing.
    pub(super) fn add_remarks(&self, remarks: &mut Vec<String>) {
        for (name, angles) in [("theta_i", &self.incident), ("theta_s", &self.polar)] {
            let [first, last] = [angles[0], angles[angles.len() - 1]];
            if first > 0.0 || last < 90.0 {
                remarks.push(format!(
                    "beyond {name} of {first} to {last} deg the value at the nearest of them is used"
                ));
            }
        }
        match &self.azimuth[..] {
            [_] => {
                remarks.push("one azimuth is given, so that scatter is the same at all".to_owned());
            }
            azimuths if azimuths[azimuths.len() - 1] <= 180.0 => {
                remarks.push("azimuths up to 180 deg are given; the other half is taken as their mirror image".to_owned());
            }
            _ => {}
        }
    }

    /// The function over rings and sectors.
    pub(super) fn matrix(&self) -> BsdfMatrix {
        let pairs = STEPS_DEG.iter().filter_map(|step| self.patches(*step));
        let fits = |(incident, leaving): &(RingPatches, RingPatches)| {
            let leaving = DirectionPatches::Rings(leaving.clone());
            incident.rings() * leaving.count() <= MOST_PAIRS
        };
        let mut pairs = pairs.peekable();
        let last = loop {
            match pairs.next() {
                Some(pair) if fits(&pair) || pairs.peek().is_none() => break pair,
                Some(_) => {}
                None => unreachable!("angles from 0 to 90 deg make rings"),
            }
        };
        let (incident, leaving) = last;
        let patches = DirectionPatches::Rings(leaving.clone());
        let mut values = Vec::with_capacity(incident.rings() * patches.count());
        let middle = |index: usize| (index as f64 + 0.5) / POINTS as f64;
        for ring in 0..incident.rings() {
            for patch in 0..patches.count() {
                let mut sum = 0.0;
                for point in 0..POINTS.pow(3) {
                    let [a, b, c] =
                        [point / POINTS / POINTS, point / POINTS % POINTS, point % POINTS]
                            .map(middle);
                    let from = incident.radius(ring, a).asin().to_degrees();
                    let to = patches.direction(patch, [b, c]);
                    let polar = to.length().min(1.0).asin().to_degrees();
                    sum += self.at([from, polar, 360.0 * turns(to)]);
                }
                values.push(sum / POINTS.pow(3) as f64);
            }
        }
        BsdfMatrix { pairs: PatchPairs::Isotropic { incident, leaving }, values }
    }

    /// Rings and sectors of about this width, deg, with an edge at each angle.
    fn patches(&self, step: f64) -> Option<(RingPatches, RingPatches)> {
        let incident = edges(&self.incident, step);
        let polar = edges(&self.polar, step);
        let spacing = self.azimuth.windows(2).map(|pair| pair[1] - pair[0]);
        let spacing = spacing.fold(30.0, f64::min).max(2.0 * step);
        let sectors = |pair: &[f64]| {
            let sine = (0.5 * (pair[0] + pair[1])).sin();
            ((720.0 / spacing * sine).ceil() as usize).max(8)
        };
        let sectors = polar.windows(2).map(sectors).collect();
        let ones = vec![1; incident.len() - 1];
        Some((RingPatches::new(&incident, ones)?, RingPatches::new(&polar, sectors)?))
    }

    /// The value at polar angles of arriving and leaving light and an azimuth, deg.
    fn at(&self, [from, to, turn]: [f64; 3]) -> f64 {
        let is_half = self.azimuth[self.azimuth.len() - 1] <= 180.0;
        let turn = if is_half && turn > 180.0 { 360.0 - turn } else { turn };
        let around =
            if is_half { between(&self.azimuth, turn) } else { around(&self.azimuth, turn) };
        let [count_to, count_turn] = [self.polar.len(), self.azimuth.len()];
        let mut sum = 0.0;
        for (i, a) in between(&self.incident, from) {
            for (j, b) in between(&self.polar, to) {
                for (k, c) in around {
                    sum += a * b * c * self.values[(i * count_to + j) * count_turn + k];
                }
            }
        }
        sum
    }
}

/// Polar angles from 0 to a right angle, rad, among them those given, deg, no further apart than a step.
fn edges(angles: &[f64], step: f64) -> Vec<f64> {
    let mut given = vec![0.0];
    given.extend(angles.iter().copied().filter(|angle| *angle > 0.0 && *angle < 90.0));
    given.push(90.0);
    let mut all = vec![0.0];
    for pair in given.windows(2) {
        let parts = ((pair[1] - pair[0]) / step).ceil().max(1.0) as u32;
        let part =
            |number: u32| pair[0] + (pair[1] - pair[0]) * f64::from(number) / f64::from(parts);
        all.extend((1..=parts).map(|number| part(number).to_radians()));
    }
    all
}

/// The two angles about a value, with their weights; the nearest alone beyond the ends.
fn between(angles: &[f64], value: f64) -> [(usize, f64); 2] {
    let above = angles.partition_point(|angle| *angle <= value);
    if above == 0 || above == angles.len() {
        return [(above.saturating_sub(1), 1.0), (0, 0.0)];
    }
    let [low, high] = [angles[above - 1], angles[above]];
    let share = (value - low) / (high - low);
    [(above - 1, 1.0 - share), (above, share)]
}

/// As [`between`], of angles around a circle, deg.
fn around(angles: &[f64], value: f64) -> [(usize, f64); 2] {
    let last = angles.len() - 1;
    let above = angles.partition_point(|angle| *angle <= value);
    if above > 0 && above <= last {
        return between(angles, value);
    }
    let gap = angles[0] + 360.0 - angles[last];
    if gap <= 0.0 {
        return [(0, 1.0), (0, 0.0)];
    }
    let share = (value - angles[last]).rem_euclid(360.0) / gap;
    [(last, 1.0 - share), (0, share)]
}
