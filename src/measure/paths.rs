//! How the light came to a sensor: how many interfaces it met, and by which faces.

use crate::scene::{Scene, SensorId};
use crate::transport::{ClassSum, Readings, Trail};
use serde::Serialize;

/// Depths from here on share a bin with others: one bin for each doubling.
const SINGLE_DEPTHS: usize = 1024;

/// How the light came to a sensor.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SensorPaths {
    /// Name of the sensor.
    pub sensor: String,
    /// Flux by the number of interfaces met, from none up to the deepest that brought any.
    pub depths: Vec<DepthBin>,
    /// Path classes, the strongest first: a sample of the paths, shares without error bars.
    pub classes: Vec<PathClass>,
}

/// Flux of the paths that met some number of interfaces.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DepthBin {
    /// Least number of interfaces.
    pub from: u64,
    /// Greatest number of interfaces.
    pub to: u64,
    /// Mean flux, lm or W.
    pub flux: f64,
    /// Its standard error.
    pub std_error: f64,
}

/// Paths that met the same faces in the same order, the same step in a row counted once.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PathClass {
    /// The steps.
    pub steps: Vec<PathStep>,
    /// Whether the steps are all there are.
    pub extent: Extent,
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
    /// It went back.
    Reflected,
    /// It went through.
    Transmitted,
}

/// Whether the steps of a class are all there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Extent {
    /// They are.
    Whole,
    /// Only the first steps are kept.
    CutOff,
    /// These are all the weaker classes together.
    Others,
}

/// The paths of a sensor.
pub(crate) fn paths(scene: &Scene, readings: &Readings, id: SensorId) -> SensorPaths {
    let reading = &readings.sensors[id.index()];
    let batches = readings.batch_count();
    let bin = |bin: usize| reading.depths.mean(bin, batches);
    let lit = (0..reading.depths.len()).rev().find(|&depth| bin(depth).0 != 0.0);
    let depths = (0..lit.map_or(0, |last| last + 1)).map(|index| {
        let (flux, std_error) = bin(index);
        let (from, to) = depths_of_bin(index);
        DepthBin { from, to, flux, std_error }
    });
    let total: f64 = reading.classes.values().map(|class| class.flux).sum();
    let lit = reading.classes.iter().filter(|(_, sum)| sum.flux > 0.0);
    let mut classes: Vec<PathClass> =
        lit.map(|(trail, sum)| class(scene, trail, sum, total)).collect();
    // A stable sort: classes of equal share keep the order of their faces.
    classes.sort_by(|a, b| b.share.total_cmp(&a.share));
    SensorPaths {
        sensor: scene.sensors[id.index()].name.clone(),
        depths: depths.collect(),
        classes,
    }
}

/// Least and greatest depth of a bin of the histogram.
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
            [None] => Extent::Others,
            [.., None] => Extent::CutOff,
            [.., Some(_)] | [] => Extent::Whole,
        },
        steps: steps.collect(),
        share: sum.flux / total,
        bounces_mean: sum.depth_weighted / sum.flux,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::{DEPTH_BINS, SensorReading};

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
