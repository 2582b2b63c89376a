//! Counts of a block of W passes, whose photons meet the records of all of them: W² times the pairs of a pass, for W times
//! its photons and records.
//!
//! A pass counts what its records take from all photons of the block. Their mean over the block is the value, but their
//! spread does not contain that of the photons, which they share. To each is therefore added a part of what all
//! records take from its own photons, less the mean of that over the block: docs/method.md, eq. (29).

use crate::scene::{Scene, SensorId};
use crate::transport::gather::kernel::ORDERS;
use crate::transport::tally::sensor_reading::DetectedLight;
use crate::transport::tally::{Counts, merged};
use crate::transport::{Layout, Readings};

/// Counts of the passes of a block; not closed.
#[derive(Debug)]
pub(super) struct CrossedCounts {
    /// By pass: the light that its gather paths met and that its records took.
    passes: Vec<[Readings; ORDERS]>,
    /// By pass: the light that records of all passes take from its photons. Empty for one pass alone.
    by_photons: Vec<[Readings; ORDERS]>,
    /// Flux of each order by sensor, pass of the record and pass of the photon, lm or W.
    pairs: Vec<Vec<[f64; ORDERS]>>,
}

impl CrossedCounts {
    /// Nothing counted yet; `empty` makes readings of a pass, from 0.
    pub(super) fn new(passes: usize, sensors: usize, empty: impl Fn(usize) -> Readings) -> Self {
        let all = |count| -> Vec<[Readings; ORDERS]> {
            (0..count).map(|pass| std::array::from_fn(|_| empty(pass))).collect()
        };
        let crossed = if passes > 1 { passes } else { 0 };
        Self {
            passes: all(passes),
            by_photons: all(crossed),
            pairs: vec![vec![[0.0; ORDERS]; crossed * crossed]; sensors],
        }
    }

    /// Counts of one pass by its gather paths, and by photons without records.
    pub(super) fn pass(&mut self, pass: usize) -> &mut [Readings; ORDERS] {
        &mut self.passes[pass]
    }

    /// Counts light of each order that photons of a pass bring to a record of another.
    pub(super) fn count_pair(
        &mut self,
        (scene, layout): (&Scene, &Layout),
        (id, cells): (SensorId, &[usize]),
        [of_record, of_photon]: [usize; 2],
        light: [DetectedLight; ORDERS],
    ) {
        let share = (self.passes.len() as f64).recip();
        let light = light.map(|light| DetectedLight { flux: light.flux * share, ..light });
        let groups = &scene.light;
        let columns = self.by_photons.get_mut(of_photon).into_iter();
        for orders in std::iter::once(&mut self.passes[of_record]).chain(columns) {
            for (readings, light) in orders.iter_mut().zip(&light) {
                readings.count((layout, groups), id, cells, light);
            }
        }
        if !self.by_photons.is_empty() {
            let pair = &mut self.pairs[id.index()][of_record * self.passes.len() + of_photon];
            pair.iter_mut().zip(&light).for_each(|(sum, light)| *sum += light.flux);
        }
    }

    /// Adds light that was found without records to all orders of a pass.
    pub(super) fn add(&mut self, pass: usize, other: &Readings) {
        for own in &mut self.passes[pass] {
            *own = own.combined([1.0, 1.0], other);
        }
        self.passes[pass][0].segments += other.segments;
        self.passes[pass][0].joins += other.joins;
    }

    /// The counts of all passes.
    pub(super) fn into_counts(self) -> Counts {
        merged(self.into_passes().into_iter().map(Counts::closed))
    }

    /// The counts of each pass, not closed.
    pub(super) fn into_passes(self) -> Vec<[Readings; ORDERS]> {
        let count = self.passes.len();
        let share_of = |order: usize| {
            let of_sensor = |pairs: &Vec<[f64; ORDERS]>| {
                let pairs: Vec<f64> = pairs.iter().map(|pair| pair[order]).collect();
                photon_share(&pairs, count)
            };
            self.pairs.iter().map(of_sensor).fold(0.0, f64::max)
        };
        let shares: [f64; ORDERS] = std::array::from_fn(share_of);
        let sum = |one: [Readings; ORDERS], other: &[Readings; ORDERS]| {
            std::array::from_fn(|order| one[order].combined([1.0, 1.0], &other[order]))
        };
        let mut photons = self.by_photons.iter();
        let all = photons.next().cloned();
        let all: Option<[Readings; ORDERS]> = all.map(|first| photons.fold(first, sum));
        let Some(all) = all else { return self.passes };
        let with_photons = |(orders, own): ([Readings; ORDERS], &[Readings; ORDERS])| {
            std::array::from_fn(|order| {
                let with = orders[order].combined([1.0, shares[order]], &own[order]);
                with.combined([1.0, -shares[order] / count as f64], &all[order])
            })
        };
        self.passes.into_iter().zip(&self.by_photons).map(with_photons).collect()
    }
}

/// The share η of the light of photons that belongs into the spread of passes, 1: η² is the part of its variance over
/// passes of photons that pairs do not explain, by the mean squares of a two-way layout (Scheffé, The Analysis of Variance,
/// 1959, ch. 7). `pairs` by pass of the record and of the photon.
fn photon_share(pairs: &[f64], passes: usize) -> f64 {
    if passes < 2 {
        return 0.0;
    }
    let count = passes as f64;
    let at = |record: usize, photon: usize| pairs[record * passes + photon];
    let mean = |value: &dyn Fn(usize) -> f64| (0..passes).map(value).sum::<f64>() / count;
    let by_record: Vec<f64> =
        (0..passes).map(|record| mean(&|photon| at(record, photon))).collect();
    let by_photon: Vec<f64> =
        (0..passes).map(|photon| mean(&|record| at(record, photon))).collect();
    let all = mean(&|record| by_record[record]);
    let of_photons = by_photon.iter().map(|own| (own - all).powi(2)).sum::<f64>();
    let left = |record: usize, photon: usize| {
        (at(record, photon) - by_record[record] - by_photon[photon] + all).powi(2)
    };
    let rest: f64 =
        (0..passes).map(|record| (0..passes).map(|photon| left(record, photon)).sum::<f64>()).sum();
    let [of_photons, rest] = [count * of_photons, rest / (count - 1.0)];
    if of_photons > rest { (1.0 - rest / of_photons).sqrt() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::tally::readings::Group;

    #[test]
    fn work_beside_the_records_is_counted_once_for_each_pass() {
        let empty = |pass: usize| {
            Readings::of_groups(vec![Group { group: pass as u64, batches: 1, sums: vec![0.0] }])
        };
        let mut counts = CrossedCounts::new(2, 0, empty);
        for (pass, (segments, joins)) in [(7, 2), (11, 3)].into_iter().enumerate() {
            let other = Readings { segments, joins, ..empty(pass) };
            counts.add(pass, &other);
        }
        let all = counts.into_counts();
        assert_eq!((all.first().segments, all.first().joins), (18, 5));
    }

    #[test]
    fn only_what_photons_have_in_common_is_their_share() {
        // Photons alone differ: all of it. Records alone, or one pair: nothing.
        assert_eq!(photon_share(&[1.0, 2.0, 1.0, 2.0], 2), 1.0);
        assert_eq!(photon_share(&[1.0, 1.0, 2.0, 2.0], 2), 0.0);
        assert_eq!(photon_share(&[0.0, 5.0, 0.0, 0.0], 2), 0.0);
        assert_eq!(photon_share(&[1.0, 3.0, 0.0, 0.0], 2), 0.0, "only one pass has records");
        assert_eq!(photon_share(&[0.0; 4], 2), 0.0, "in the dark");
        assert_eq!(photon_share(&[], 1), 0.0, "a pass alone");
        // Mean squares 1 of photons and 1/4 of the rest.
        let share = photon_share(&[0.5, 2.0, 1.5, 2.0], 2);
        assert!((share * share - 0.75).abs() < 1e-12, "{share}");
    }
}
