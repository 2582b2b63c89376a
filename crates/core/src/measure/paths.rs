//! How the light reached a sensor: how many interfaces it met, and at which faces.

use crate::measure::evidence::Evidence;
use crate::scene::{Scene, SensorId};
use crate::transport::{ClassSum, Loss, Trail};
use serde::Serialize;

/// Depths from here on share bins: one bin for each doubling.
const SINGLE_DEPTHS: usize = 1024;
/// Path classes reported individually, for each sensor.
const CLASSES: usize = 20;

/// How the light reached a sensor.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SensorPaths {
    /// Name of the sensor.
    pub sensor: String,
    /// Flux by the number of interfaces met, from zero to the deepest with any flux. It is a table
    /// of its own (`SENSOR.bounces.csv`) and not part of the machine-readable record.
    #[serde(skip)]
    pub depths: Vec<DepthBin>,
    /// The strongest path classes, in descending order, and all others as one: a sample of the
    /// photons that reached the sensor, as shares without error bars.
    pub classes: Vec<PathClass>,
    /// Losses of the gather paths from the sensor; `None` where there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost: Option<LostPaths>,
}

/// Gather paths that ended early, by throughput, as shares of all that were drawn, including those
/// that miss the sensor or its aim. What they would have met is unknown.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LostPaths {
    /// Cut by the bounce limit, 1.
    pub cut: f64,
    /// Lost through holes in the geometry, 1.
    pub leaked: f64,
}

/// Flux of the paths that met some number of interfaces.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DepthBin {
    /// Smallest number of interfaces.
    pub from: u64,
    /// Largest number of interfaces.
    pub to: u64,
    /// Mean flux, lm or W.
    pub flux: f64,
    /// Its standard error.
    pub std_error: f64,
}

/// Paths that met the same faces in the same order, with repeats of a step counted once.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PathClass {
    /// The steps.
    pub steps: Vec<PathStep>,
    /// Whether the steps are complete.
    pub extent: ClassExtent,
    /// Share of the sensor's flux, 1.
    pub share: f64,
    /// Mean number of interfaces met.
    pub bounces_mean: f64,
}

/// A face, and what happened there.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct PathStep {
    /// Name of the face.
    pub face: String,
    /// Reflected or transmitted.
    pub action: Action,
}

/// What happened to light at a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Action {
    /// Light was reflected.
    Reflected,
    /// Light was transmitted.
    Transmitted,
}

/// Whether the steps of a class are complete.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ClassExtent {
    /// They are complete.
    Whole,
    /// Only the first steps are kept.
    CutOff,
    /// All the weaker classes together.
    Others,
}

/// The paths of a sensor.
pub(crate) fn paths(evidence: &Evidence<'_>, id: SensorId) -> SensorPaths {
    let (scene, readings) = (evidence.scene, evidence.readings);
    let reading = &readings.sensors[id.index()];
    let batches = readings.batch_count();
    let bin = |bin: usize| reading.depths.mean(bin, batches);
    let lit = (0..reading.depths.count()).rev().find(|&depth| bin(depth).0 != 0.0);
    let depths = (0..lit.map_or(0, |last| last + 1)).map(|index| {
        let (flux, std_error) = bin(index);
        let (from, to) = depths_of_bin(index);
        DepthBin { from, to, flux, std_error }
    });
    let by_class = &evidence.of_photons().readings.sensors[id.index()].classes;
    let total: f64 = by_class.values().map(|class| class.flux).sum();
    let lit = by_class.iter().filter(|(_, sum)| sum.flux > 0.0);
    let mut classes: Vec<PathClass> =
        lit.map(|(trail, sum)| class(scene, trail, sum, total)).collect();
    // A stable sort: classes of equal share keep the order of their faces.
    classes.sort_by(|a, b| b.share.total_cmp(&a.share));
    SensorPaths {
        sensor: scene.sensors[id.index()].name.clone(),
        depths: depths.collect(),
        classes: strongest(&classes, CLASSES),
        lost: lost(evidence, id),
    }
}

fn lost(evidence: &Evidence<'_>, id: SensorId) -> Option<LostPaths> {
    let share = |loss| evidence.readings.scalar(evidence.layout.lost_paths(id, loss)).mean();
    let lost = LostPaths { cut: share(Loss::Cut), leaked: share(Loss::Leaked) };
    (lost.cut > 0.0 || lost.leaked > 0.0).then_some(lost)
}

/// The first `count` of sorted classes, and all others as one at the end.
pub fn strongest(classes: &[PathClass], count: usize) -> Vec<PathClass> {
    let (named, mut rest): (Vec<&PathClass>, Vec<&PathClass>) =
        classes.iter().partition(|class| class.extent != ClassExtent::Others);
    rest.extend(named.iter().skip(count));
    let mut kept: Vec<PathClass> = named.into_iter().take(count).cloned().collect();
    let share: f64 = rest.iter().map(|class| class.share).sum();
    if share > 0.0 {
        let bounces: f64 = rest.iter().map(|class| class.share * class.bounces_mean).sum();
        kept.push(PathClass {
            steps: Vec::new(),
            extent: ClassExtent::Others,
            share,
            bounces_mean: bounces / share,
        });
    }
    kept
}

/// Smallest and largest depth of a bin of the histogram.
fn depths_of_bin(bin: usize) -> (u64, u64) {
    if bin < SINGLE_DEPTHS {
        return (bin as u64, bin as u64);
    }
    let from = (SINGLE_DEPTHS as u64) << (bin - SINGLE_DEPTHS);
    (from, 2 * from - 1)
}

fn class(scene: &Scene, trail: &Trail, sum: &ClassSum, total: f64) -> PathClass {
    let steps = trail.iter().flatten().map(|step| PathStep {
        face: scene.faces[step.face as usize].name.clone(),
        action: if step.transmitted { Action::Transmitted } else { Action::Reflected },
    });
    PathClass {
        extent: match trail.as_slice() {
            [None] => ClassExtent::Others,
            [.., None] => ClassExtent::CutOff,
            [.., Some(_)] | [] => ClassExtent::Whole,
        },
        steps: steps.collect(),
        share: sum.flux / total,
        bounces_mean: sum.depth_weighted / sum.flux,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::tally::sensor_reading::{DEPTH_BINS, SensorReading};

    #[test]
    fn the_strongest_classes_stay_and_the_others_are_one_with_all_their_light() {
        let class = |face: &str, extent, share, bounces_mean| {
            let steps = vec![PathStep { face: face.to_owned(), action: Action::Reflected }];
            PathClass { steps, extent, share, bounces_mean }
        };
        let classes = [
            class("a", ClassExtent::Whole, 0.4, 1.0),
            class("", ClassExtent::Others, 0.3, 10.0),
            class("b", ClassExtent::CutOff, 0.2, 2.0),
            class("c", ClassExtent::Whole, 0.1, 6.0),
        ];
        let [first, second, others] = &strongest(&classes, 2)[..] else { panic!("not three") };
        assert_eq!((first, second), (&classes[0], &classes[2]));
        assert_eq!((others.extent, others.steps.len()), (ClassExtent::Others, 0));
        assert!((others.share - 0.4).abs() < 1e-15 && (others.bounces_mean - 9.0).abs() < 1e-14);
        assert_eq!(strongest(&classes[..1], 2), classes[..1]);
        assert_eq!(strongest(&strongest(&classes, 3), 2), strongest(&classes, 2));
    }

    #[test]
    fn bins_hold_the_depths_that_are_counted_in_them() {
        for depth in [0, 1, 1023, 1024, 2047, 2048, 100_000, u32::MAX] {
            let (from, to) = depths_of_bin(SensorReading::depth_bin(depth));
            assert!(from <= u64::from(depth) && u64::from(depth) <= to, "{depth}");
        }
        for bin in 1..DEPTH_BINS {
            assert_eq!(depths_of_bin(bin - 1).1 + 1, depths_of_bin(bin).0);
        }
    }
}
