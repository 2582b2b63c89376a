//! What is in a scene: solids with volumes, faces with areas, sources with etendue, sensors with cells.

use crate::number::format_value;
use crate::scene::{Emission, FaceId, MediumId, Owner, Scene, Seeing, SensorKind};
use std::f64::consts::PI;
use std::fmt::Write;

/// The list that `check` prints.
pub fn inventory(scene: &Scene) -> String {
    let mut text = String::new();
    bodies(scene, &mut text);
    faces(scene, &mut text);
    sources(scene, &mut text);
    for sensor in &scene.sensors {
        let what = match &sensor.kind {
            SensorKind::Surface(surface) => {
                let kind = match &surface.seeing {
                    Seeing::All => "",
                    Seeing::Views(_) => "luminance over ",
                    Seeing::Pixels(_) => "image through ",
                };
                format!("{kind}{} mm²", format_value(surface.area()))
            }
            SensorKind::Goniometer(goniometer) => match goniometer.radius {
                Some(radius) => format!("goniometer of radius {} mm", format_value(radius)),
                None => "far-field goniometer".into(),
            },
        };
        _ = writeln!(text, "sensor {}: {what}, {} cells", sensor.name, sensor.cells());
    }
    text
}

/// Media and the solids of them.
fn bodies(scene: &Scene, text: &mut String) {
    for medium in &scene.media {
        let (index, absorption) = (medium.index(0.0), medium.absorption(0.0));
        _ = write!(text, "medium {}: index {index}, absorption {absorption} /mm", medium.name());
        if let Some(scattering) = medium.scattering() {
            let (coefficient, g) = (scattering.coefficient(), scattering.anisotropy());
            _ = write!(text, ", scattering {coefficient} /mm, anisotropy {g}");
        }
        _ = writeln!(text);
    }
    for solid in &scene.solids {
        let medium = scene.media[solid.medium.index()].name();
        let volume =
            solid.volume.map_or("unknown".into(), |volume| format!("{} mm³", format_value(volume)));
        _ = writeln!(
            text,
            "solid {}: {medium}, priority {}, volume {volume}",
            solid.name, solid.priority
        );
    }
}

/// Faces, and the patterns on them.
fn faces(scene: &Scene, text: &mut String) {
    for (index, face) in scene.faces.iter().enumerate() {
        let area = format_value(scene.face_area(FaceId::new(index)));
        let kind = match face.owner {
            Owner::Solid(_) => "face",
            Owner::Sheet => "sheet",
            Owner::Port => "open port",
        };
        let finish = face.back.map_or("polished", |finish| &scene.finishes[finish.index()].name);
        let finish = if face.owner == Owner::Port { String::new() } else { format!(", {finish}") };
        _ = writeln!(text, "{kind} {}: {area} mm²{finish}", face.name);
    }
    for pattern in &scene.patterns {
        let face = &scene.faces[pattern.face.index()];
        let (count, area) = (pattern.field.count(), pattern.field.area());
        let share = 100.0 * area / scene.face_area(pattern.face);
        let finish = &scene.finishes[pattern.back.index()].name;
        _ = writeln!(
            text,
            "pattern {} on {}: {count} elements, {} mm², {share:.3} % of the face, {finish}",
            pattern.name,
            face.name,
            format_value(area)
        );
    }
    for relief in &scene.reliefs {
        let wall = &scene.faces[relief.wall.index()].name;
        _ = writeln!(
            text,
            "relief {} on {wall}: {} elements, up to {} mm, {} mm³",
            relief.name,
            relief.field.count(),
            format_value(relief.height()),
            format_value(relief.volume())
        );
    }
}

/// Sources with their flux and, where they have an area, the etendue G = n² A Ω (projected).
fn sources(scene: &Scene, text: &mut String) {
    let unit = scene.unit.flux();
    for source in &scene.sources {
        _ = write!(text, "source {}: {} {unit}", source.name, format_value(source.flux));
        if let Some(area) = source.emitter.area() {
            _ = write!(text, ", area {} mm²", format_value(area));
            let projected = match source.emission {
                Emission::Lambertian | Emission::Cone { .. } | Emission::Sky(_) => {
                    source.emission.projected_solid_angle()
                }
                // Light in every direction of the half space, however it is spread.
                Emission::CosinePower(_) | Emission::Isotropic => Some(PI),
                Emission::Collimated { .. } => Some(0.0),
            };
            let index = scene.media[MediumId::index(scene.surroundings)].index(0.0);
            if let Some(projected) = projected {
                _ = write!(
                    text,
                    ", etendue {} mm² sr",
                    format_value(index * index * area * projected)
                );
            }
        }
        _ = writeln!(text);
    }
}
