//! The totals of a sensor: flux, efficiency, transmission, and depth of the paths.
//!
//! These come from the scalars alone and cost next to nothing, whatever the size of the map.

use crate::measure::evidence::Evidence;
use crate::measure::{Measure, Status};
use crate::scene::{Scene, Seeing, SensorId, SensorKind, Sides, SourceId};
use crate::transport::TAILS;
use indexmap::IndexMap;
use lumiduct_base::units::MM2_PER_M2;

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

/// Light that is measured separately: from a source, or from a light group.
struct LightPart<'a> {
    name: &'a str,
    sources: Vec<SourceId>,
    /// Emitted flux, lm or W.
    emitted: f64,
}

/// All sources, then all light groups.
fn parts(scene: &Scene) -> Vec<LightPart<'_>> {
    let sources = scene.sources.iter().enumerate().map(|(index, source)| LightPart {
        name: &source.name,
        sources: vec![SourceId::new(index)],
        emitted: source.flux,
    });
    let groups = scene.light.groups().iter().map(|group| LightPart {
        name: &group.name,
        sources: group.sources.clone(),
        emitted: scene.flux_of(&group.sources),
    });
    sources.chain(groups).collect()
}

/// The same, except the only source of a scene, which is all light.
fn parts_beside_all(scene: &Scene) -> Vec<LightPart<'_>> {
    let is_all =
        |part: &LightPart<'_>| scene.sources.len() == 1 && part.name == scene.sources[0].name;
    parts(scene).into_iter().filter(|part| !is_all(part)).collect()
}

impl LightPart<'_> {
    /// Its share of the flux on a sensor, times a factor that leads to `unit`.
    fn sum(&self, evidence: &Evidence<'_>, id: SensorId, factor: f64, unit: &str) -> Measure {
        if self.emitted == 0.0 {
            // No source flux gives no flux, and no path is needed to know it.
            return evidence.no_light(unit);
        }
        evidence.sum(&self.slots(evidence, id), factor, unit)
    }

    fn slots(&self, evidence: &Evidence<'_>, id: SensorId) -> Vec<usize> {
        self.sources.iter().map(|&source| evidence.layout.sensor_flux(id, source)).collect()
    }

    fn efficiency(&self, evidence: &Evidence<'_>, id: SensorId) -> Measure {
        if self.emitted == 0.0 {
            return evidence.measure(0.0, f64::INFINITY, "1", Status::NoSignal);
        }
        self.sum(evidence, id, 1.0 / self.emitted, "1")
    }

    /// Its share of all light on a sensor.
    fn share(&self, evidence: &Evidence<'_>, id: SensorId, all: &[usize]) -> Measure {
        if self.emitted == 0.0 {
            return evidence.no_light("1");
        }
        evidence.ratio(&self.slots(evidence, id), all)
    }
}

/// Flux, and its ratio to the emitted flux: the efficiency.
fn by_source(evidence: &Evidence<'_>, id: SensorId, out: &mut IndexMap<String, Measure>) {
    let scene = evidence.scene;
    let unit = scene.unit.flux();
    let all = evidence.layout.flux_slots(id);
    out.insert("flux".into(), evidence.sum(&all, 1.0, unit));
    out.insert("efficiency".into(), evidence.sum(&all, 1.0 / scene.source_flux(), "1"));
    for part in parts(scene) {
        out.insert(format!("flux.from.{}", part.name), part.sum(evidence, id, 1.0, unit));
    }
    for part in parts_beside_all(scene) {
        out.insert(format!("efficiency.from.{}", part.name), part.efficiency(evidence, id));
        // Light that never shines together has no shares.
        if scene.light.weathers().len() < 2 {
            out.insert(format!("share.from.{}", part.name), part.share(evidence, id, &all));
        }
    }
}

/// Flux through the entry port, and the sensor's flux over it: the transmission.
fn entering(evidence: &Evidence<'_>, id: SensorId, out: &mut IndexMap<String, Measure>) {
    let scene = evidence.scene;
    if scene.sensors[id.index()].entering.is_none() {
        return;
    }
    let entering = |sources: &mut dyn Iterator<Item = SourceId>| -> Vec<usize> {
        sources.map(|source| evidence.layout.entering(id, source)).collect()
    };
    let all = entering(&mut (0..scene.sources.len()).map(SourceId::new));
    let photons = evidence.of_photons();
    out.insert("entering_flux".into(), photons.sum(&all, 1.0, scene.unit.flux()));
    let transmission = evidence.ratio_to_photons(&evidence.layout.flux_slots(id), &all);
    out.insert("transmission".into(), transmission);
    for part in parts_beside_all(scene) {
        let own = entering(&mut part.sources.iter().copied());
        let own = evidence.ratio_to_photons(&part.slots(evidence, id), &own);
        out.insert(format!("transmission.from.{}", part.name), own);
    }
}

/// Flux that met the sensor but does not count: only photons can measure it.
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

/// Mean illuminance of a surface sensor, or mean luminance of an image, where all counted light
/// gives one mean: a sensor with views has one for each view.
fn density(evidence: &Evidence<'_>, id: SensorId, out: &mut IndexMap<String, Measure>) {
    let SensorKind::Surface(surface) = &evidence.scene.sensors[id.index()].kind else { return };
    let unit = evidence.scene.unit;
    let (name, symbol, etendue) = match &surface.seeing {
        Seeing::All => (unit.illuminance_name(), unit.illuminance(), surface.area()),
        Seeing::Pixels(pixels) => {
            let projected: f64 = pixels.projected.iter().sum();
            (unit.luminance_name(), unit.luminance(), surface.area() * projected)
        }
        Seeing::Views(_) => return,
    };
    let factor = MM2_PER_M2 / etendue;
    if matches!(surface.seeing, Seeing::All) {
        // The mean of an image is read from its map.
        let mean = evidence.sum(&evidence.layout.flux_slots(id), factor, symbol);
        out.insert(format!("{name}_avg"), mean);
    }
    for part in parts_beside_all(evidence.scene) {
        let mean = part.sum(evidence, id, factor, symbol);
        out.insert(format!("{name}_avg.from.{}", part.name), mean);
    }
}

/// Mean number of interfaces met before the sensor, and the share of the flux that met more than a
/// given number.
fn depths(evidence: &Evidence<'_>, id: SensorId, out: &mut IndexMap<String, Measure>) {
    let flux = evidence.layout.flux_slots(id);
    let layout = evidence.layout;
    let tails = (0..).zip(TAILS).map(|(tail, depth)| (layout.deeper(id, tail), f64::from(depth)));
    let mean = evidence.mean_number(&[layout.depth_weighted(id)], &flux, tails);
    out.insert("bounces_mean".into(), mean);
    for (tail, depth) in TAILS.iter().enumerate() {
        let share = evidence.ratio(&[layout.deeper(id, tail)], &flux);
        out.insert(format!("share_deeper_than_{depth}"), share);
    }
}

#[cfg(test)]
mod tests {
    use crate::measure::samples::{add, light_groups, readings, rectangle, scene};
    use crate::measure::{Measures, Status, measure};
    use crate::scene::{SensorId, SourceId};

    fn exit() -> SensorId {
        SensorId::new(0)
    }

    /// Two sources; the exit gets 0.6 of 3 lm and 0.1 of 1 lm, with a swing that both fluxes share.
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
    fn light_groups_add_up_their_sources_and_dark_sources_are_exactly_nothing() {
        let sources = [("red", 3.0), ("blue", 1.0), ("off", 0.0)];
        let mut scene = scene(&sources, vec![("exit", rectangle(10.0, 1, 1))]);
        scene.light = light_groups(&[("colours", &[0, 1]), ("spare", &[2])]);
        let readings = readings(&scene, 128, |index, layout, batch| {
            let swing = if index % 2 == 0 { 0.9 } else { 1.1 };
            for (source, flux) in [(0, 1.5), (1, 0.5)] {
                add(batch, layout.sensor_flux(exit(), SourceId::new(source)), flux * swing);
                add(batch, layout.entering(exit(), SourceId::new(source)), 2.0 * flux * swing);
            }
        });
        let measures = measure(&scene, &readings);
        for (name, value, relative) in [
            ("flux.from.colours", 2.0, 0.1 / 127f64.sqrt()),
            ("efficiency.from.colours", 0.5, 0.1 / 127f64.sqrt()),
            ("share.from.blue", 0.25, 0.0),
            ("share.from.colours", 1.0, 0.0),
            ("transmission.from.colours", 0.5, 0.0),
            ("illuminance_avg.from.colours", 20_000.0, 0.1 / 127f64.sqrt()),
        ] {
            let found = &measures.values[&format!("exit.{name}")];
            assert!((found.value / value - 1.0).abs() < 1e-12, "{name}: {found}");
            assert!((found.std_error / value - relative).abs() < 1e-12, "{name}: {found}");
        }
        for name in ["off", "spare"] {
            for what in ["flux", "share", "illuminance_avg"] {
                let found = &measures.values[&format!("exit.{what}.from.{name}")];
                assert_eq!((found.value, found.std_error), (0.0, 0.0), "{what}.from.{name}");
                assert_eq!(found.status, Status::Ok, "{what}.from.{name}");
            }
            let efficiency = &measures.values[&format!("exit.efficiency.from.{name}")];
            assert_eq!((efficiency.value, efficiency.status), (0.0, Status::NoSignal));
        }
        assert_eq!(measures.light_groups["colours"], ["red", "blue"]);
        let numbers = || measures.values.values().flat_map(|m| [m.value, m.std_error]);
        assert!(numbers().all(|number| !number.is_nan()));
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
