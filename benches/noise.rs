//! The noise of a sensor's readings.

use lumiduct_core::scene::{Scene, SensorId, SourceId};
use lumiduct_core::tally::Tally;
use lumiduct_core::transport::{Layout, Readings};

/// The flux of a sensor, lm.
pub(crate) fn flux(scene: &Scene, readings: &Readings, sensor: SensorId) -> Tally {
    let layout = Layout::new(scene);
    let sources = 0..scene.sources.len();
    let slots: Vec<usize> =
        sources.map(|source| layout.sensor_flux(sensor, SourceId::new(source))).collect();
    readings.function(|flux| slots.iter().map(|&slot| flux(slot)).sum())
}

/// σ² and mean² of the flux, or their sums over the cells if there are several, the latter less the contribution of noise, lm².
pub(crate) fn noise(scene: &Scene, readings: &Readings, sensor: SensorId) -> [f64; 2] {
    let cells = &readings.sensors[sensor.index()].cells;
    if cells.count() == 1 {
        let flux = flux(scene, readings, sensor);
        return [flux.std_error().powi(2), flux.mean().powi(2)];
    }
    let [mut variance, mut square] = [0.0; 2];
    for cell in 0..cells.count() {
        let (mean, error) = cells.mean(cell, readings.batch_count());
        variance += error * error;
        square += mean * mean - error * error;
    }
    [variance, square]
}
