//! What a sensor has counted altogether: flux, efficiency, transmission, and how deep the paths went.
//!
//! These come from the scalars alone and cost next to nothing, whatever the size of the map.

use crate::measure::Measure;
use crate::measure::evidence::Evidence;
use crate::scene::{Seeing, SensorId, SensorKind, Sides, SourceId};
use crate::transport::TAILS;
use crate::units::MM2_PER_M2;
use indexmap::IndexMap;

/// The totals of a sensor, by the last part of their dotted names.
pub(crate) fn totals(evidence: &Evidence<'_>, id: SensorId) -> IndexMap<String, Measure> {
    let mut out = IndexMap::new();
    by_source(evidence, id, &mut out);
    entering(evidence, id, &mut out);
    elsewhere(evidence, id, &mut out);
    density(evidence, id, &mut out);
    depths(evidence, id, &mut out);
    out
}

/// The scalars that make the flux on a sensor: one per source.
pub(crate) fn flux_slots(evidence: &Evidence<'_>, id: SensorId) -> Vec<usize> {
    (0..evidence.scene.sources.len())
        .map(|source| evidence.layout.sensor_flux(id, SourceId::new(source)))
        .collect()
}

/// Flux, and over what the sources emit: the efficiency.
fn by_source(evidence: &Evidence<'_>, id: SensorId, out: &mut IndexMap<String, Measure>) {
    let scene = evidence.scene;
    let unit = scene.unit.flux();
    let all = flux_slots(evidence, id);
    out.insert("flux".into(), evidence.sum(&all, 1.0, unit));
    out.insert("efficiency".into(), evidence.sum(&all, 1.0 / scene.source_flux(), "1"));
    for (source, &slot) in scene.sources.iter().zip(&all) {
        let name = &source.name;
        out.insert(format!("flux.from.{name}"), evidence.sum(&[slot], 1.0, unit));
        if scene.sources.len() > 1 {
            let own = evidence.sum(&[slot], 1.0 / source.flux, "1");
            out.insert(format!("efficiency.from.{name}"), own);
        }
    }
}

/// Flux through the entry port, and the sensor's flux over it: the transmission.
fn entering(evidence: &Evidence<'_>, id: SensorId, out: &mut IndexMap<String, Measure>) {
    let scene = evidence.scene;
    if scene.sensors[id.index()].entering.is_none() {
        return;
    }
    let sources = || (0..scene.sources.len()).map(SourceId::new);
    let entering: Vec<usize> =
        sources().map(|source| evidence.layout.entering(id, source)).collect();
    let leaving = flux_slots(evidence, id);
    let photons = evidence.of_photons();
    out.insert("entering_flux".into(), photons.sum(&entering, 1.0, scene.unit.flux()));
    out.insert("transmission".into(), evidence.ratio_to_photons(&leaving, &entering));
    if scene.sources.len() > 1 {
        for (place, source) in scene.sources.iter().enumerate() {
            let [out_slot, in_slot] = [&leaving, &entering].map(|slots| &slots[place..=place]);
            let own = evidence.ratio_to_photons(out_slot, in_slot);
            out.insert(format!("transmission.from.{}", source.name), own);
        }
    }
}

/// Flux that met the sensor but does not count: only photons know it.
fn elsewhere(evidence: &Evidence<'_>, id: SensorId, out: &mut IndexMap<String, Measure>) {
    let evidence = &evidence.of_photons();
    let sensor = &evidence.scene.sensors[id.index()];
    let unit = evidence.scene.unit.flux();
    if !sensor.aim.is_empty() {
        let slot = evidence.layout.outside_aim(id);
        out.insert("flux_outside_aim".into(), evidence.sum(&[slot], 1.0, unit));
    }
    match &sensor.kind {
        SensorKind::Surface(surface) if surface.sides != Sides::Both => {
            let slot = evidence.layout.other_side(id);
            out.insert("flux_other_side".into(), evidence.sum(&[slot], 1.0, unit));
        }
        SensorKind::Surface(_) | SensorKind::Goniometer(_) => {}
    }
}

/// Mean illuminance of a surface sensor; one with views or pixels sees only part of the light that arrives and has none.
fn density(evidence: &Evidence<'_>, id: SensorId, out: &mut IndexMap<String, Measure>) {
    match &evidence.scene.sensors[id.index()].kind {
        SensorKind::Surface(surface) if matches!(surface.seeing, Seeing::All) => {
            let unit = evidence.scene.unit;
            let mean = evidence.sum(
                &flux_slots(evidence, id),
                MM2_PER_M2 / surface.area(),
                unit.illuminance(),
            );
            out.insert(format!("{}_avg", unit.illuminance_name()), mean);
        }
        SensorKind::Surface(_) | SensorKind::Goniometer(_) => {}
    }
}

/// Mean number of interfaces met before the sensor, and the share of the flux that met more than some.
fn depths(evidence: &Evidence<'_>, id: SensorId, out: &mut IndexMap<String, Measure>) {
    let flux = flux_slots(evidence, id);
    let layout = evidence.layout;
    out.insert("bounces_mean".into(), evidence.ratio(&[layout.depth_weighted(id)], &flux));
    for (tail, depth) in TAILS.iter().enumerate() {
        let share = evidence.ratio(&[layout.deeper(id, tail)], &flux);
        out.insert(format!("share_deeper_than_{depth}"), share);
    }
}

#[cfg(test)]
mod tests {
    use crate::measure::samples::{add, readings, rectangle, scene};
    use crate::measure::{Measures, Status, measure};
    use crate::scene::{SensorId, SourceId};

    fn exit() -> SensorId {
        SensorId::new(0)
    }

    /// Two sources, of which the exit gets 0.6 of 3 lm and 0.1 of 1 lm, with a swing that both fluxes share.
    fn measured(batches: u64) -> Measures {
        let scene = scene(&[("led", 3.0), ("lamp", 1.0)], vec![("exit", rectangle(10.0, 1, 1))]);
        let readings = readings(&scene, batches, |index, layout, batch| {
            let swing = if index % 2 == 0 { 0.9 } else { 1.1 };
            add(batch, layout.sensor_flux(exit(), SourceId::new(0)), 1.8 * swing);
            add(batch, layout.sensor_flux(exit(), SourceId::new(1)), 0.1 * swing);
            add(batch, layout.entering(exit(), SourceId::new(0)), 1.9 * swing);
            add(batch, layout.entering(exit(), SourceId::new(1)), 0.1 * swing);
            add(batch, layout.depth_weighted(exit()), 1.9 * 12.0 * swing);
            add(batch, layout.deeper(exit(), 0), 1.9 * 0.25 * swing);
        });
        measure(&scene, &readings)
    }

    #[test]
    fn flux_and_efficiency_are_told_by_source() {
        let measures = measured(128);
        let value = |name: &str| measures.values[name].value;
        for (name, expected) in [
            ("exit.flux", 1.9),
            ("exit.flux.from.led", 1.8),
            ("exit.flux.from.lamp", 0.1),
            ("exit.efficiency", 1.9 / 4.0),
            ("exit.efficiency.from.led", 0.6),
            ("exit.efficiency.from.lamp", 0.1),
            ("exit.entering_flux", 2.0),
            ("exit.transmission.from.led", 1.8 / 1.9),
            ("exit.transmission.from.lamp", 1.0),
            // 1.9 lm on 100 mm².
            ("exit.illuminance_avg", 19_000.0),
            ("exit.bounces_mean", 12.0),
            ("exit.share_deeper_than_10", 0.25),
        ] {
            assert!((value(name) / expected - 1.0).abs() < 1e-12, "{name}: {}", value(name));
        }
        let relative = measures.values["exit.flux"].relative_error();
        assert!((relative - 0.1 / 127f64.sqrt()).abs() < 1e-12);
        assert_eq!(measures.values["exit.flux_other_side"].status, Status::NoSignal);
    }

    #[test]
    fn a_ratio_knows_that_its_two_sides_swing_together() {
        let transmission = &measured(128).values["exit.transmission"];
        assert!((transmission.value - 0.95).abs() < 1e-12);
        assert!(transmission.std_error < 1e-12, "{}", transmission.std_error);
    }

    #[test]
    fn few_batches_have_no_error_bar_to_rely_on() {
        assert_eq!(measured(9).values["exit.flux"].status, Status::TooFew);
        assert_eq!(measured(10).values["exit.flux"].status, Status::Ok);
        let one = measured(1);
        assert_eq!(one.values["exit.flux"].std_error, f64::INFINITY);
        assert_eq!(one.values["exit.transmission"].std_error, f64::INFINITY);
    }
}
