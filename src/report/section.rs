//! The picture of a check: a cut through the scene, with paths of light, sources and sensors.

use crate::error::Result;
use crate::report::drawing::{Fate, Role, drawing, fate};
use crate::report::png::{
    CrossSection, NamedPlace, Outline, PlaceOf, RayEnd, RayPath, cross_section,
};
use crate::scene::shape::ChartRect;
use crate::scene::{Scene, SensorKind};
use crate::transport::Track;
use glam::{DVec2, DVec3};

/// The cross-section of a scene with some traced paths.
pub fn scene_picture(title: &str, scene: &Scene, tracks: &[Track]) -> Result<Vec<u8>> {
    let plane = scene.section_plane();
    let to_plane = |point: DVec3| plane.point_to_local(point).truncate();
    let corners = [scene.bounds.min, scene.bounds.max].map(to_plane);
    let margin = DVec2::splat(0.06 * scene.bounds.diagonal());
    let window = ChartRect {
        min: corners[0].min(corners[1]) - margin,
        max: corners[0].max(corners[1]) + margin,
    };
    // Axes show the user's coordinates.
    let origin = DVec2::new(
        (plane.origin + scene.origin).dot(plane.x),
        (plane.origin + scene.origin).dot(plane.y),
    );
    let shown = |point: DVec2| (point + origin).to_array();
    let outlines = scene
        .section(&plane, window)
        .into_iter()
        .enumerate()
        .map(|(colour, outline)| Outline {
            name: scene.faces[outline.face.index()].name.clone(),
            colour,
            points: outline.points.into_iter().map(shown).collect(),
        })
        .collect();
    let rays = tracks
        .iter()
        .map(|track| RayPath {
            points: track.points.iter().map(|point| shown(to_plane(*point))).collect(),
            end: match fate(scene, track).0 {
                // A sphere around everything counts whatever escapes.
                Fate::Counted if !meets_surface(scene, track) => RayEnd::Escaped,
                Fate::Counted => RayEnd::Sensor,
                Fate::Absorbed => RayEnd::Absorbed,
                Fate::Escaped => RayEnd::Escaped,
                Fate::Lost => RayEnd::Lost,
            },
        })
        .collect();
    let places = drawing(scene, tracks).marks.into_iter().filter_map(|mark| {
        let at = shown(to_plane(mark.at - scene.origin));
        let of = match mark.role {
            Role::Source => PlaceOf::Source,
            Role::Sensor => PlaceOf::Sensor,
            Role::Solid | Role::Sheet | Role::Port | Role::Pattern => return None,
        };
        Some(NamedPlace { name: mark.name, at, of })
    });
    let label = |axis: DVec3| {
        let name =
            ["x", "y", "z"][axis.abs().to_array().iter().position(|part| *part > 0.5).unwrap_or(0)];
        format!("{name} in mm")
    };
    let [low, high] = [window.min, window.max].map(shown);
    cross_section(&CrossSection {
        title: title.to_owned(),
        subtitle: format!("{} paths, projected onto the section", tracks.len()),
        x_label: label(plane.x),
        y_label: label(plane.y),
        x_range: [low[0], high[0]],
        y_range: [low[1], high[1]],
        outlines,
        rays,
        places: places.collect(),
    })
}

/// Whether a path was counted by a sensor that has a place.
fn meets_surface(scene: &Scene, track: &Track) -> bool {
    track.counted_by.iter().any(|id| match scene.sensors[id.index()].kind {
        SensorKind::Surface(_) => true,
        SensorKind::Goniometer(_) => false,
    })
}
