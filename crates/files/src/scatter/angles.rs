//! An isotropic distribution function by angles, linear between them, averaged over patches.
//!
//! The mean over a patch is exact: it is a sum of the values, with the means of the hat functions of each angle as weights. No peak is
//! lost between points, and the share of light is that of the function.

use crate::scatter::data::BsdfMatrix;
use lumiduct_base::math::{PatchPairs, RingPatches};
use lumiduct_base::number::format_value;
use std::f64::consts::FRAC_PI_2;

/// Widths of patches that are tried, deg. With the last one, patches are few, whatever the angles of a file.
const STEPS_DEG: [f64; 6] = [1.0, 1.5, 2.0, 3.0, 4.0, 6.0];
/// Most pairs of patches, unless the widest patches make more.
const MOST_PAIRS: usize = 1 << 19;
/// Fewest sectors of a ring.
const FEWEST_SECTORS: usize = 8;

/// Values over a grid of increasing angles, deg.
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
    /// Line of the first value, from 1.
    pub(super) line: usize,
}

/// Rings of arriving light, and rings and sectors of leaving light.
struct SamplePatches {
    incident: RingPatches,
    leaving: RingPatches,
    /// Polar angles of their edges, rad.
    edges: [Vec<f64>; 2],
    step_deg: f64,
}

impl SampledScatter {
    /// The function over rings and sectors, and what is assumed.
    pub(super) fn matrix(&self) -> Option<(BsdfMatrix, Vec<String>)> {
        let mut steps = STEPS_DEG.iter().filter_map(|step| self.patches(*step)).peekable();
        let patches = loop {
            let patches = steps.next()?;
            let pairs = patches.incident.rings() * patches.leaving.count();
            if pairs <= MOST_PAIRS || steps.peek().is_none() {
                break patches;
            }
        };
        let values = self.means(&patches);
        let remarks = self.remarks(patches.step_deg);
        let SamplePatches { incident, leaving, .. } = patches;
        let pairs = PatchPairs::Isotropic { incident, leaving };
        Some((BsdfMatrix { pairs, values, line: self.line }, remarks))
    }

    fn remarks(&self, step_deg: f64) -> Vec<String> {
        let mut remarks = Vec::new();
        let is_half = self.is_half();
        let last_azimuth = if is_half { 180.0 } else { 360.0 };
        let beyond = |name: &str, angles: &[f64], last: f64| {
            let ends = [angles[0], angles[angles.len() - 1]];
            (angles.len() > 1 && (ends[0] > 0.0 || ends[1] < last)).then(|| {
                let [first, last] = ends;
                format!(
                    "beyond {name} of {first} to {last} deg the value at the nearest angle is used"
                )
            })
        };
        remarks.extend(beyond("theta_i", &self.incident, 90.0));
        remarks.extend(beyond("theta_s", &self.polar, 90.0));
        for (name, angles) in [("theta_i", &self.incident), ("theta_s", &self.polar)] {
            if let [angle] = angles[..] {
                remarks.push(format!(
                    "{name} is given at {angle} deg only; these values are used at all {name}"
                ));
            }
        }
        if let [angle] = self.azimuth[..] {
            remarks.push(format!(
                "phi_s is given at {angle} deg only; these values are used at all phi_s"
            ));
        } else if is_half {
            remarks.extend(beyond("phi_s", &self.azimuth, last_azimuth));
            remarks.push(
                "azimuths up to 180 deg are given; the other half is taken as their mirror image"
                    .to_owned(),
            );
        }
        let finest = |angles: &[f64]| {
            angles.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min)
        };
        let finest = [&self.incident, &self.polar, &self.azimuth].map(|angles| finest(angles));
        if finest.into_iter().any(|spacing| spacing < step_deg) {
            let step = format_value(step_deg);
            remarks.push(format!("its values are averaged over patches of {step} deg"));
        }
        remarks
    }

    /// Whether azimuths are given for one side of the plane of incidence alone.
    pub(super) fn is_half(&self) -> bool {
        self.azimuth[self.azimuth.len() - 1] <= 180.0
    }

    /// Rings and sectors of about this width, deg.
    fn patches(&self, step_deg: f64) -> Option<SamplePatches> {
        let edges = [&self.incident, &self.polar].map(|angles| edges(angles, step_deg));
        let spacing = self.azimuth.windows(2).map(|pair| pair[1] - pair[0]);
        let width = (0.5 * spacing.fold(30.0, f64::min)).max(step_deg);
        let sectors = |pair: &[f64]| {
            let sine = (0.5 * (pair[0] + pair[1])).sin();
            ((360.0 / width * sine).ceil() as usize).max(FEWEST_SECTORS)
        };
        let sectors = edges[1].windows(2).map(sectors).collect();
        let ones = vec![1; edges[0].len() - 1];
        let incident = RingPatches::new(&edges[0], ones)?;
        let leaving = RingPatches::new(&edges[1], sectors)?;
        Some(SamplePatches { incident, leaving, edges, step_deg })
    }

    /// Means over all pairs of patches.
    fn means(&self, patches: &SamplePatches) -> Vec<f64> {
        let [of_incident, of_polar] = [(&self.incident, 0), (&self.polar, 1)]
            .map(|(angles, side)| ring_weights(angles, &patches.edges[side]));
        let azimuths = self.azimuth_knots();
        let leaving = &patches.leaving;
        let columns = self.azimuth.len();
        let mut all = vec![0.0; of_incident.len() * leaving.count()];
        let mut first = 0;
        // The weights of one ring at a time: those of all would be many for thousands of azimuths.
        for (ring, polar) in of_polar.iter().enumerate() {
            let sectors = sector_weights(&azimuths, leaving.sectors(ring));
            // Means over its sectors for light from each angle of the table.
            let of_angle = |angle: usize| -> Vec<f64> {
                let mut around = vec![0.0; columns];
                for (row, weight) in polar {
                    let at = (angle * self.polar.len() + row) * columns;
                    add(&mut around, &self.values[at..at + columns], *weight);
                }
                let mean = |weights: &Vec<Weight>| {
                    weights.iter().map(|(column, weight)| weight * around[*column]).sum()
                };
                sectors.iter().map(mean).collect()
            };
            let of_angles: Vec<Vec<f64>> = (0..self.incident.len()).map(of_angle).collect();
            for (arriving, incident) in of_incident.iter().enumerate() {
                let to = arriving * leaving.count() + first;
                let values = &mut all[to..to + sectors.len()];
                incident
                    .iter()
                    .for_each(|(angle, weight)| add(values, &of_angles[*angle], *weight));
            }
            first += sectors.len();
        }
        all
    }

    /// Azimuths, deg, each with the place of its values: those of 0 to 360 deg, and the same a turn before and a turn after.
    fn azimuth_knots(&self) -> Vec<Knot> {
        let count = self.azimuth.len();
        let own: Vec<Knot> = self.azimuth.iter().copied().zip(0..count).collect();
        let mut once: Vec<Knot> = own.iter().copied().filter(|(at, _)| *at < 360.0).collect();
        if self.is_half() {
            let other = own.iter().rev().filter(|(at, _)| *at > 0.0 && *at < 180.0);
            once.extend(other.map(|(at, place)| (360.0 - at, *place)));
        }
        if once.is_empty() {
            // 360 deg alone.
            once = own;
        }
        let turn = |by: f64| once.iter().map(move |(at, place)| (at + by, *place));
        turn(-360.0).chain(turn(0.0)).chain(turn(360.0)).collect()
    }
}

/// An angle, and the place of its value.
type Knot = (f64, usize);

/// The place of a value, and its share in a mean.
type Weight = (usize, f64);

/// Polar angles from 0 to a right angle, rad, at most a step apart: among them those given, deg, as far as they are a step apart.
fn edges(angles_deg: &[f64], step_deg: f64) -> Vec<f64> {
    let mut kept = vec![0.0];
    for angle in angles_deg {
        if *angle >= kept[kept.len() - 1] + step_deg && *angle <= 90.0 - step_deg {
            kept.push(*angle);
        }
    }
    kept.push(90.0);
    let mut all = vec![0.0];
    for pair in kept.windows(2) {
        let parts = ((pair[1] - pair[0]) / step_deg).ceil().max(1.0) as u32;
        let part =
            |number: u32| pair[0] + (pair[1] - pair[0]) * f64::from(number) / f64::from(parts);
        all.extend((1..=parts).map(|number| part(number).to_radians()));
    }
    all
}

/// Shares of the values at angles, deg, in the means over rings by projected solid angle.
fn ring_weights(angles_deg: &[f64], edges: &[f64]) -> Vec<Vec<Weight>> {
    let last = angles_deg.len() - 1;
    let mut knots = vec![(0.0, 0)];
    knots.extend(angles_deg.iter().map(|angle| angle.to_radians()).zip(0..));
    knots.push((FRAC_PI_2, last));
    // Integrals of sin 2θ and of θ sin 2θ.
    let moments = |x: f64| {
        let (sin, cos) = (2.0 * x).sin_cos();
        [-0.5 * cos, 0.25 * sin - 0.5 * x * cos]
    };
    edges.windows(2).map(|pair| hat_weights(&knots, [pair[0], pair[1]], moments)).collect()
}

/// Shares of the values at azimuths in the means over sectors.
fn sector_weights(knots: &[Knot], count: usize) -> Vec<Vec<Weight>> {
    let width = 360.0 / count as f64;
    let moments = |x: f64| [x, 0.5 * x * x];
    let sector = |number: usize| {
        let middle = number as f64 * width;
        hat_weights(knots, [middle - 0.5 * width, middle + 0.5 * width], moments)
    };
    (0..count).map(sector).collect()
}

/// Shares of the values at knots in the mean of the function that is linear between them, over a range within them. `moments` are
/// integrals of the weight of each place, and of the weight times the place.
fn hat_weights(
    knots: &[Knot],
    [from, to]: [f64; 2],
    moments: impl Fn(f64) -> [f64; 2],
) -> Vec<Weight> {
    let [all, _] = difference(moments(from), moments(to));
    let first = knots.partition_point(|(at, _)| *at <= from).saturating_sub(1);
    let mut weights: Vec<Weight> = Vec::new();
    for pair in knots[first..].windows(2) {
        let [(low, left), (high, right)] = [pair[0], pair[1]];
        if low >= to {
            break;
        }
        if high <= low {
            continue;
        }
        let [weight, moment] = difference(moments(low.max(from)), moments(high.min(to)));
        let of_right = (moment - low * weight) / (high - low);
        weights.push((left, (weight - of_right).max(0.0) / all));
        weights.push((right, of_right.max(0.0) / all));
    }
    weights
}

/// Adds values times a weight.
fn add(sums: &mut [f64], values: &[f64], weight: f64) {
    sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
}

fn difference(from: [f64; 2], to: [f64; 2]) -> [f64; 2] {
    [to[0] - from[0], to[1] - from[1]]
}
