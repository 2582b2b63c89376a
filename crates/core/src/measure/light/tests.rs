use crate::measure::samples::{
    add, disk, goniometer, image, light_groups, luminance, readings, rectangle, rings, scene,
};
use crate::measure::{Measures, SensorMap, Status, measure, names, value_of};
use crate::optics::REFERENCE_WAVELENGTH;
use crate::rng::{Dimension, Sampler};
use crate::scene::{Scene, SensorId, SourceId};
use crate::transport::tally::sensor_reading::DetectedLight;
use crate::transport::{Findings, Readings};

/// Groups of the first two of four sources, of three, and of the last, which is dark. The second
/// source is in two of them.
fn grouped() -> Scene {
    let mut scene = scene(
        &[("red", 2.0), ("green", 1.0), ("blue", 1.0), ("spare", 0.0)],
        vec![
            ("exit", rectangle(2.0, 6, 4)),
            ("port", disk(1.0, 12)),
            ("rings", rings(1.0, 5, 6)),
            ("eye", luminance(1.0, 3, 3, &[0.1, 0.2])),
            ("camera", image(4, 3)),
            ("far", goniometer(8, 36)),
        ],
    );
    scene.light =
        light_groups(&[("warm", &[0, 1]), ("lit", &[0, 1, 2]), ("cold", &[1]), ("dark", &[3])]);
    scene
}

/// Counts light of a source in a cell.
fn count(batch: &mut Readings, id: SensorId, cell: usize, of: (f64, SourceId), scene: &Scene) {
    let (flux, source) = of;
    let light = DetectedLight { flux, depth: 0, source, wavelength: REFERENCE_WAVELENGTH };
    batch.sensors[id.index()].add_to_cell(cell, &light, scene.light.of(source));
}

/// Uneven light of the three sources on every sensor, another for each, with noise.
fn some_light(scene: &Scene) -> Findings {
    readings(scene, 128, |index, layout, batch| {
        let mut sampler = Sampler::for_path(1, 7, index);
        for id in (0..scene.sensors.len()).map(SensorId::new) {
            for source in 0..3 {
                let light = SourceId::new(source);
                let mut total = 0.0;
                for cell in 0..scene.sensors[id.index()].cells() {
                    let level = 1.0 + 0.3 * ((cell * (source + 2)) % 5) as f64;
                    let flux = 1e-5 * level * (0.5 + sampler.one(Dimension::Resampling));
                    count(batch, id, cell, (flux, light), scene);
                    total += flux;
                }
                add(batch, layout.sensor_flux(id, light), total);
            }
        }
    })
}

fn found() -> Measures {
    let scene = grouped();
    measure(&scene, &some_light(&scene))
}

/// The map of some light on a sensor in the first view.
fn map<'m>(measures: &'m Measures, sensor: &str, light: Option<&str>) -> &'m SensorMap {
    let is_wanted = |map: &&SensorMap| map.sensor == sensor && map.light.as_deref() == light;
    measures.maps.iter().find(is_wanted).unwrap()
}

#[test]
fn every_group_has_the_measures_of_maps_and_spheres_but_not_those_of_cells() {
    let scene = grouped();
    let found = names(&scene);
    for name in [
        "exit.illuminance_avg.from.warm",
        "exit.illuminance_min.from.warm",
        "exit.illuminance_max.from.dark",
        "exit.illuminance_center.from.cold",
        "exit.uniformity_min_avg.from.warm",
        "exit.uniformity9_max_min.from.warm",
        "exit.uniformity13_min_max.from.warm",
        "exit.cv.from.lit",
        "port.uniformity_min_max.from.warm",
        "rings.illuminance_center.from.warm",
        "eye.luminance_avg.0.from.warm",
        "eye.luminance_max.1.from.warm",
        "eye.uniformity_min_avg.1.from.cold",
        "camera.luminance_avg.from.warm",
        "camera.luminance_min.from.warm",
        "far.intensity_max.from.warm",
        "far.intensity_axis.from.warm",
        "far.beam_angle.from.warm",
        "far.beam_angle.c90.from.warm",
        "far.field_angle.c0.from.cold",
    ] {
        assert!(found.iter().any(|own| own == name), "{name} is missing");
    }
    let is_of_group = |name: &&String| name.contains(".from.");
    for name in found.iter().filter(is_of_group) {
        let part = name.split('.').nth(1).unwrap();
        assert!(!["cell", "ring", "zonal_flux"].contains(&part), "{name}");
        // Single sources have no maps.
        assert!(!name.contains("illuminance_min.from.red"), "{name}");
    }
}

#[test]
fn a_measure_of_a_group_alone_is_the_same_as_among_all() {
    let scene = grouped();
    let readings = some_light(&scene);
    for (name, measure) in measure(&scene, &readings).values {
        assert_eq!(value_of(&scene, &readings, &name), Some(measure), "{name}");
    }
    for name in ["exit.cv.from.red", "exit.cell.0.0.from.warm", "exit.cv.from.", "exit.from.warm"] {
        assert_eq!(value_of(&scene, &readings, name), None, "{name}");
    }
}

#[test]
fn a_group_of_all_lit_sources_measures_the_same_as_all_light() {
    let measures = found();
    let mut compared = 0;
    for (name, own) in &measures.values {
        let Some(all) = name.strip_suffix(".from.lit") else { continue };
        // There is no share of all light, and a dark source changes no sum.
        let Some(all) = measures.values.get(all) else { continue };
        assert_eq!(own, all, "{name}");
        compared += 1;
    }
    assert!(compared > 60, "{compared}");
    for sensor in ["exit", "port", "rings", "eye", "camera"] {
        let [all, own] = [None, Some("lit")].map(|light| map(&measures, sensor, light));
        assert_eq!(own.summary, all.summary, "{sensor}");
    }
}

#[test]
fn a_source_of_two_groups_counts_in_both() {
    let scene = grouped();
    let readings = readings(&scene, 16, |_, _, batch| {
        count(batch, SensorId::new(0), 3, (1e-6, SourceId::new(1)), &scene);
        count(batch, SensorId::new(0), 4, (1e-6, SourceId::new(2)), &scene);
    });
    let measures = measure(&scene, &readings);
    let lit = |light| map(&measures, "exit", light).values.iter().filter(|it| **it > 0.0).count();
    let lights = [None, Some("warm"), Some("lit"), Some("cold"), Some("dark")];
    assert_eq!(lights.map(lit), [2, 1, 2, 1, 0]);
}

#[test]
fn averages_of_groups_lie_between_their_extremes_and_agree_with_their_flux() {
    let measures = found();
    for map in &measures.maps {
        let all = &map.summary.all;
        let what = format!("{} {:?} {:?}", map.sensor, map.view, map.light);
        assert!(all.min.value <= all.avg.value, "{what}: {all:?}");
        assert!(all.avg.value <= all.max.value, "{what}: {all:?}");
    }
    for (name, area) in [("exit.illuminance_avg", 4e-6), ("camera.luminance_avg", 0.0)] {
        for light in ["warm", "cold"] {
            let own = &measures.values[&format!("{name}.from.{light}")];
            let sensor = name.split('.').next().unwrap();
            let avg = map(&measures, sensor, Some(light)).summary.all.avg;
            assert_eq!((own.value, own.std_error), (avg.value, avg.std_error), "{name} {light}");
            let flux = measures.values[&format!("{sensor}.flux.from.{light}")].value;
            let is_flux = area == 0.0 || (own.value * area / flux - 1.0).abs() < 1e-12;
            assert!(is_flux, "{name} {light}: {own}, {flux} lm");
        }
    }
}

#[test]
fn a_dark_group_has_exact_levels_of_zero_and_unknown_ratios() {
    let measures = found();
    let mut levels = 0;
    for (name, own) in measures.values.iter().filter(|(name, _)| name.ends_with(".from.dark")) {
        assert!(!own.value.is_nan() && !own.std_error.is_nan(), "{name}");
        let is_ratio = own.unit == "1" && !name.contains("share");
        if is_ratio || own.unit == "deg" {
            assert_eq!(own.status, Status::NoSignal, "{name}");
        } else {
            let exactly = (own.value, own.std_error, own.bias, own.status);
            assert_eq!(exactly, (0.0, 0.0, None, Status::Ok), "{name}");
            levels += 1;
        }
    }
    assert!(levels > 15, "{levels}");
    let map = map(&measures, "exit", Some("dark"));
    assert!(map.values.iter().chain(&map.std_errors).all(|number| *number == 0.0));
}

#[test]
fn maps_of_all_light_come_first_and_are_the_only_ones_without_a_group_in_json() {
    let measures = found();
    let of_exit = measures.maps.iter().filter(|map| map.sensor == "exit");
    let lights: Vec<_> = of_exit.map(|map| map.light.as_deref()).collect();
    assert_eq!(lights, [None, Some("warm"), Some("lit"), Some("cold"), Some("dark")]);
    let tables: Vec<_> = measures.intensities.iter().map(|table| table.light.as_deref()).collect();
    assert_eq!(tables, lights);
    let json = serde_json::to_value(&measures).unwrap();
    assert!(json["maps"][0].get("light").is_none());
    assert_eq!(json["maps"][1]["light"], "warm");
}
