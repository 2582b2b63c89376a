//! The keys of a sensor fit its kind and place, and its number of cells is within limits.

use crate::check::scene::Scene;
use crate::keys::Key;
use crate::problems::Problems;
use crate::spec::sensor::{
    GoniometerSpec, ImageSpec, LuminanceSpec, PassageSpec, PlaneSpec, SensorKind, SensorSpec,
};

/// Most cells of a sensor.
pub(crate) const MAX_CELLS: f64 = 1e8;

pub(crate) fn check(scene: Scene<'_>, problems: &mut Problems) {
    for (name, sensor) in &scene.spec.sensors {
        let key = Key::of(&["sensors", name]);
        check_place(&key, sensor, problems);
        check_passage(&key, sensor, problems);
        match sensor.kind() {
            Some(SensorKind::Plane(plane)) => {
                let area =
                    Area { rectangle: plane.rectangle.is_some(), disk: plane.disk.is_some() };
                check_area(&key, "plane", area, sensor, problems);
                check_plane(&key.field("plane"), plane, problems);
                check_absorbing(&key, sensor, problems);
            }
            Some(SensorKind::Goniometer(goniometer)) => {
                check_goniometer(&key.field("goniometer"), goniometer, problems);
                check_free(&key, "a `goniometer`", sensor, problems);
            }
            Some(SensorKind::Luminance(luminance)) => {
                let area = Area {
                    rectangle: luminance.rectangle.is_some(),
                    disk: luminance.disk.is_some(),
                };
                check_area(&key, "luminance", area, sensor, problems);
                check_luminance(&key.field("luminance"), luminance, problems);
                if sensor.absorbing {
                    problems.error(
                        &key.field("absorbing"),
                        "is for a `plane` only, found with `luminance`",
                    );
                }
            }
            Some(SensorKind::Image(image)) => {
                check_image(&key, image, sensor, problems);
                check_free(&key, "an `image`", sensor, problems);
            }
            None => {}
        }
    }
}

fn check_place(key: &Key, sensor: &SensorSpec, problems: &mut Problems) {
    if sensor.on.is_some() && sensor.at.is_some() {
        let message = "a sensor stands at a place or is `on` a face, not both";
        problems.error(&key.field("at"), message).hint("remove `at` or `on`");
    }
    if sensor.on.is_some() && sensor.counts.is_none() {
        let message = "a sensor `on` a face needs `counts`";
        problems
            .error(&key.field("on"), message)
            .hint("add counts = \"leaving\" or counts = \"incident\"");
    }
    if sensor.on.is_some() && sensor.aim.is_some() {
        let message = "a sensor `on` a face is lit through that face, and takes no `aim`";
        problems.error(&key.field("aim"), message).hint("remove `aim`");
    }
    if sensor.on.is_none() && sensor.counts.is_some() {
        problems
            .error(&key.field("counts"), "is only for a sensor `on` a face")
            .hint("add `on` or remove `counts`");
    }
}

/// First passages are defined for a surface that light can meet from anywhere.
fn check_passage(key: &Key, sensor: &SensorSpec, problems: &mut Problems) {
    if sensor.passage == PassageSpec::Every {
        return;
    }
    let key = key.field("passage");
    match sensor.kind() {
        Some(SensorKind::Plane(_)) if sensor.aim.is_some() => {
            let message = "a sensor with an `aim` counts every passage";
            problems.error(&key, message).hint("remove `passage` or `aim`");
        }
        Some(SensorKind::Plane(_)) | None => {}
        Some(
            kind @ (SensorKind::Goniometer(_) | SensorKind::Luminance(_) | SensorKind::Image(_)),
        ) => {
            let message = format!("\"first\" is for a `plane` only, found with `{}`", kind.name());
            problems.error(&key, message).hint("remove `passage`");
        }
    }
}

/// The shapes that a sensor gives for its area.
struct Area {
    rectangle: bool,
    disk: bool,
}

fn check_area(key: &Key, kind: &str, area: Area, sensor: &SensorSpec, problems: &mut Problems) {
    let key = key.field(kind);
    if sensor.on.is_some() {
        for (name, is_given) in [("rectangle", area.rectangle), ("disk", area.disk)] {
            if is_given {
                let message =
                    format!("a sensor `on` a face has the area of the face, not a {name}");
                problems.error(&key.field(name), message).hint(format!("remove `{name}`"));
            }
        }
    } else if area.rectangle && area.disk {
        problems.error(&key.field("disk"), "takes exactly one of `rectangle`, `disk`, found both");
    } else if !area.rectangle && !area.disk {
        let problem =
            problems.error(&key, "needs exactly one of `rectangle`, `disk`, or `on` beside it");
        problem.hint("such as rectangle = { width_mm = 10, height_mm = 10 }");
    }
}

fn check_plane(key: &Key, plane: &PlaneSpec, problems: &mut Problems) {
    match (plane.cells, plane.rings, plane.sectors) {
        // Without a division it is one cell.
        (None, None, None) => {}
        (Some([nx, ny]), None, None) => {
            check_cells(&key.field("cells"), f64::from(nx) * f64::from(ny), problems);
        }
        (None, Some(rings), sectors) => {
            let sectors = sectors.unwrap_or(1);
            check_cells(&key.field("rings"), f64::from(rings) * f64::from(sectors), problems);
            if plane.rectangle.is_some() {
                problems
                    .error(&key.field("rings"), "rings do not fit a rectangle")
                    .hint("give `cells`, or a `disk`");
            }
        }
        (None, None, Some(_)) => {
            problems
                .error(&key.field("sectors"), "needs `rings` beside it")
                .hint("rings = 1 makes plain sectors");
        }
        (Some(_), Some(_), _) | (Some(_), None, Some(_)) => {
            let name = if plane.rings.is_some() { "rings" } else { "sectors" };
            problems.error(&key.field(name), "takes `cells`, or `rings` and `sectors`, not both");
        }
    }
}

fn check_cells(key: &Key, cells: f64, problems: &mut Problems) {
    if cells > MAX_CELLS {
        problems.error(
            key,
            format!("the sensor has {cells:.3e} cells, expected at most {MAX_CELLS:.0e}"),
        );
    }
}

fn check_absorbing(key: &Key, sensor: &SensorSpec, problems: &mut Problems) {
    if sensor.absorbing && sensor.on.is_some() {
        let message = "a sensor `on` a face does not absorb; the finish of the face does";
        problems.error(&key.field("absorbing"), message).hint("give the face the finish \"black\"");
    }
}

fn check_goniometer(key: &Key, goniometer: &GoniometerSpec, problems: &mut Problems) {
    let c = check_step(&key.field("c_step_deg"), goniometer.c_step_deg, 360.0, problems);
    let gamma =
        check_step(&key.field("gamma_step_deg"), goniometer.gamma_step_deg, 180.0, problems);
    if let (Some(c), Some(gamma)) = (c, gamma) {
        check_cells(key, c * gamma, problems);
    }
}

/// The number of steps in a full range, if it is whole.
fn check_step(key: &Key, step: f64, full: f64, problems: &mut Problems) -> Option<f64> {
    let count = full / step;
    // Steps such as 0.1 are not exact in binary; 1e-9 of the range is far below any real step.
    if (count - count.round()).abs() <= 1e-9 * count {
        return Some(count);
    }
    let (fewer, more) = (full / count.floor(), full / count.ceil());
    problems
        .error(key, format!("{step} does not divide {full}"))
        .hint(format!("{more} and {fewer} do"));
    None
}

/// A goniometer is a sphere, and an image looks along its axis: they have no face and no side, and
/// absorb no light.
fn check_free(key: &Key, what: &str, sensor: &SensorSpec, problems: &mut Problems) {
    let given = [
        ("on", sensor.on.is_some()),
        ("side", sensor.side.is_some()),
        ("absorbing", sensor.absorbing),
    ];
    for (name, _) in given.into_iter().filter(|(_, is_given)| *is_given) {
        problems
            .error(&key.field(name), format!("does not go with {what}"))
            .hint(format!("remove `{name}`"));
    }
}

fn check_image(key: &Key, image: &ImageSpec, sensor: &SensorSpec, problems: &mut Problems) {
    // Keys that `on` replaces are reported with `on`.
    if sensor.on.is_none() {
        let area = Area { rectangle: image.rectangle.is_some(), disk: image.disk.is_some() };
        check_area(key, "image", area, sensor, problems);
    }
    let [columns, rows] = image.pixels;
    let pixels = f64::from(columns) * f64::from(rows);
    check_cells(&key.field("image").field("pixels"), pixels, problems);
}

fn check_luminance(key: &Key, luminance: &LuminanceSpec, problems: &mut Problems) {
    let [nx, ny] = luminance.cells;
    let cells = f64::from(nx) * f64::from(ny) * luminance.directions.len() as f64;
    check_cells(&key.field("cells"), cells, problems);
}
