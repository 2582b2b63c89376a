//! Fluxes of sensors adjusted by control variates, where groups of batches show that this pays.

use crate::scene::{Scene, SensorId};
use crate::transport::Layout;
use crate::transport::tally::controls::Controls;
use crate::transport::tally::readings::{Group, Readings};

/// With fewer blocks the slopes are too uncertain.
const MIN_BLOCKS: u64 = 2048;
/// With fewer groups of batches their variances are too uncertain to choose by.
const MIN_GROUPS: usize = 16;
/// Variance of an adjusted flux over that of the counted one, 1, above which the counts stay: choosing the smaller of two
/// equal variances, each with its own error, would make errors too small.
const MOST_VARIANCE: f64 = 0.5;
/// Surprises of a block below this share of its flux are rounding, 1.
const ROUNDING: f64 = 1e-9;

impl Readings {
    /// The same with the scalars of sensors adjusted by surprises, where that at least halves the variance of a sensor's flux. Its
    /// cells are scaled as its flux changes.
    pub(crate) fn adjusted(mut self, scene: &Scene) -> Self {
        let layout = Layout::new(scene);
        if self.controls.blocks < MIN_BLOCKS || self.groups.len() < MIN_GROUPS {
            return self;
        }
        let adjusted = self.with_groups(self.adjusted_groups(&layout));
        let emitted = self.total(layout.emitted_slots());
        for sensor in (0..self.sensors.len()).map(SensorId::new) {
            let flux = layout.flux_slots(sensor);
            let [before, after] = [&self, &adjusted].map(|own| own.total(flux.iter().copied()));
            let [counted, left] = [&self, &adjusted].map(|own| own.sum(&flux).std_error().powi(2));
            // No sensor shows more light than there is because of noise.
            let is_possible = 0.0 < after && (after <= emitted || before > emitted);
            if left <= MOST_VARIANCE * counted && is_possible {
                self.sensors[sensor.index()].scale(after / before);
                let own = layout.slots_of(sensor);
                for (group, adjusted) in self.groups.iter_mut().zip(&adjusted.groups) {
                    group.sums[own.clone()].copy_from_slice(&adjusted.sums[own.clone()]);
                }
            }
        }
        self
    }

    /// The groups with adjusted scalars of sensors, as far as light has met them in every group: what was hardly met has no
    /// error to judge by.
    fn adjusted_groups(&self, layout: &Layout) -> Vec<Group> {
        let is_lit = |slot: &usize| self.groups.iter().all(|group| group.sums[*slot] != 0.0);
        let lit: Vec<usize> = layout.sensor_slots().filter(is_lit).collect();
        let slopes = self.slopes(layout, &lit);
        let mut groups = self.groups.clone();
        for group in &mut groups {
            for (control, slopes) in &slopes {
                let surprise = group.sums[*control];
                let both = lit.iter().zip(slopes);
                both.for_each(|(&slot, slope)| group.sums[slot] -= slope * surprise);
            }
        }
        groups
    }

    /// Sum of some slots over all groups.
    fn total(&self, slots: impl Iterator<Item = usize>) -> f64 {
        slots.map(|slot| self.groups.iter().map(|group| group.sums[slot]).sum::<f64>()).sum()
    }

    /// For every slot of surprises that have happened, the slopes of some scalars against them.
    fn slopes(&self, layout: &Layout, scalars: &[usize]) -> Vec<(usize, Vec<f64>)> {
        let Controls { blocks, squares, products } = &self.controls;
        let first = layout.sensor_slots().start;
        let emitted = self.total(layout.emitted_slots());
        let least = (ROUNDING * emitted).powi(2) / *blocks as f64;
        let kinds = layout.control_slots().zip(squares.iter().zip(products));
        let happened = kinds.filter(|(_, (square, _))| **square > least);
        let of_kind = |(control, (square, products)): (usize, (&f64, &Vec<f64>))| {
            (control, scalars.iter().map(|&slot| products[slot - first] / square).collect())
        };
        happened.map(of_kind).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::samples::{rectangle, scene};
    use crate::rng::{Dimension, Sampler};
    use crate::scene::SourceId;
    use crate::tally::Tally;
    use crate::transport::tally::controls::Blocks;

    /// Paths of a batch, in blocks of one.
    const PATHS: u64 = 200;
    const SENSOR: SensorId = SensorId::new(0);

    /// Batches whose paths each bring `flux` of the number of the path and its two surprises.
    fn readings(flux: impl Fn(u64, [f64; 2]) -> f64) -> (Readings, Scene) {
        let scene = scene(&[("led", 1.0)], vec![("exit", rectangle(1.0, 1, 1))]);
        let layout = Layout::new(&scene);
        let batch = |batch: u64| {
            let mut readings = Readings::of_batch(&scene, &layout, 1, PATHS, batch);
            let mut blocks = Blocks::new(&layout, &readings.groups[0].sums);
            blocks.size = 1;
            for path in 0..PATHS {
                let mut sampler = Sampler::for_path(1, 0, batch * PATHS + path);
                let mut surprise = |chance: f64| {
                    let happens = sampler.one(Dimension::Lobe) < chance;
                    f64::from(u8::from(happens)) - chance
                };
                let surprises = [surprise(0.3), surprise(0.2)];
                let sums = &mut readings.groups[0].sums;
                sums[layout.control(0)] += surprises[0];
                sums[layout.control(3)] += surprises[1];
                sums[layout.sensor_flux(SENSOR, SourceId::new(0))] += flux(path, surprises);
                blocks.count_path(&layout, sums);
            }
            readings.controls = blocks.end_source(&layout, &readings.groups[0].sums);
            readings.close_batch();
            readings
        };
        let all = (0..32).map(batch).reduce(|all, own| all.merge(&own)).unwrap();
        (all, scene)
    }

    /// The flux as counted, and adjusted.
    fn fluxes(flux: impl Fn(u64, [f64; 2]) -> f64) -> [Tally; 2] {
        let (counted, scene) = readings(flux);
        let slots = Layout::new(&scene).flux_slots(SENSOR);
        [counted.sum(&slots), counted.adjusted(&scene).sum(&slots)]
    }

    #[test]
    fn light_that_follows_from_choices_has_no_noise_left() {
        let [counted, adjusted] = fluxes(|_, [one, other]| 2.0 + one - 0.5 * other);
        assert!(counted.std_error() > 0.5, "{counted:?}");
        // Slopes are met but for the chance correlation of the two kinds.
        assert!(adjusted.std_error() < 0.05 * counted.std_error(), "{adjusted:?}");
        assert!((adjusted.mean() - 2.0 * PATHS as f64).abs() < 4.0 * adjusted.std_error());
    }

    #[test]
    fn light_with_noise_of_its_own_stays_as_counted() {
        // Half of the variance and more does not follow from choices.
        let noisy = std::cell::Cell::new(0);
        let [counted, adjusted] = fluxes(|_, [one, _]| {
            noisy.set(noisy.get() + 1);
            Sampler::for_path(2, 0, noisy.get()).one(Dimension::Lobe) + 0.2 * one
        });
        assert_eq!(counted, adjusted);
    }

    #[test]
    fn what_some_groups_have_not_met_stays_as_counted() {
        let (mut counted, scene) = readings(|_, [one, _]| 2.0 + one);
        let layout = Layout::new(&scene);
        let slot = layout.deeper(SENSOR, 0);
        counted.groups.iter_mut().skip(1).for_each(|group| group.sums[slot] = 1.0);
        let adjusted = counted.clone().adjusted(&scene);
        assert_eq!(counted.scalar(slot), adjusted.scalar(slot));
        assert_eq!(adjusted.lit_groups(&[slot]), 31);
        let flux = layout.flux_slots(SENSOR);
        assert!(adjusted.sum(&flux).std_error() < 0.1 * counted.sum(&flux).std_error());
    }

    #[test]
    fn no_sensor_shows_more_light_than_there_is() {
        let (counted, scene) = readings(|_, [one, _]| 2.0 + one);
        let layout = Layout::new(&scene);
        let flux = layout.flux_slots(SENSOR);
        let [before, after] =
            [&counted, &counted.clone().adjusted(&scene)].map(|own| own.sum(&flux).mean());
        assert_ne!(before, after);
        let with_emitted = |flux: f64| {
            let mut readings = counted.clone();
            let slot = layout.emitted(SourceId::new(0));
            readings.groups.iter_mut().for_each(|group| group.sums[slot] = flux);
            readings.adjusted(&scene)
        };
        let between = 0.5 * (before + after);
        let shown = with_emitted(between).sum(&flux).mean();
        assert_eq!(shown, if before < after { before } else { after });
    }
}
