//! The picture of a check: a cut through the scene, with paths of light, sources and sensors.

use crate::error::Result;
use crate::math::Frame;
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
    let view = View::of(scene);
    let window = view.window(scene);
    let [low, high] = [window.min, window.max].map(|corner| view.shown(corner));
    cross_section(&CrossSection {
        title: title.to_owned(),
        subtitle: format!("{} paths, projected onto the section", tracks.len()),
        x_label: axis_label(view.plane.x),
        y_label: axis_label(view.plane.y),
        x_range: [low[0], high[0]],
        y_range: [low[1], high[1]],
        outlines: view.outlines(scene, window),
        rays: tracks.iter().map(|track| view.ray(scene, track)).collect(),
        places: view.places(scene, tracks),
    })
}

/// Name and unit of an axis of the picture.
fn axis_label(axis: DVec3) -> String {
    let along = axis.abs().to_array().iter().position(|part| *part > 0.5).unwrap_or(0);
    format!("{} in mm", ["x", "y", "z"][along])
}

/// How a scene is looked at.
struct View {
    /// The plane of the cut.
    plane: Frame,
    /// Its origin along its axes, in the user's coordinates, mm.
    origin: DVec2,
}

impl View {
    fn of(scene: &Scene) -> Self {
        let plane = scene.section_plane();
        let origin = plane.origin + scene.origin;
        Self { plane, origin: DVec2::new(origin.dot(plane.x), origin.dot(plane.y)) }
    }

    /// A place of the plane in the user's coordinates, mm.
    fn shown(&self, at: DVec2) -> [f64; 2] {
        (at + self.origin).to_array()
    }

    /// A point of the scene, seen along the normal, mm of the plane.
    fn seen(&self, point: DVec3) -> DVec2 {
        self.plane.point_to_local(point).truncate()
    }

    /// What of the plane is drawn, mm.
    fn window(&self, scene: &Scene) -> ChartRect {
        let corners = [scene.bounds.min, scene.bounds.max].map(|corner| self.seen(corner));
        let margin = DVec2::splat(0.06 * scene.bounds.diagonal());
        ChartRect {
            min: corners[0].min(corners[1]) - margin,
            max: corners[0].max(corners[1]) + margin,
        }
    }

    fn outlines(&self, scene: &Scene, window: ChartRect) -> Vec<Outline> {
        let found = scene.section(&self.plane, window).into_iter().enumerate();
        found
            .map(|(colour, outline)| Outline {
                name: scene.faces[outline.face.index()].name.clone(),
                colour,
                points: outline.points.into_iter().map(|at| self.shown(at)).collect(),
            })
            .collect()
    }

    fn ray(&self, scene: &Scene, track: &Track) -> RayPath {
        RayPath {
            points: track.points.iter().map(|point| self.shown(self.seen(*point))).collect(),
            end: match fate(scene, track).0 {
                // A sphere around everything counts whatever escapes.
                Fate::Counted if !meets_surface(scene, track) => RayEnd::Escaped,
                Fate::Counted => RayEnd::Sensor,
                Fate::Absorbed => RayEnd::Absorbed,
                Fate::Escaped => RayEnd::Escaped,
                Fate::Lost => RayEnd::Lost,
            },
        }
    }

    /// Sources and sensors.
    fn places(&self, scene: &Scene, tracks: &[Track]) -> Vec<NamedPlace> {
        let marks = drawing(scene, tracks).marks.into_iter();
        marks
            .filter_map(|mark| {
                let of = match mark.role {
                    Role::Source => PlaceOf::Source,
                    Role::Sensor => PlaceOf::Sensor,
                    Role::Solid | Role::Sheet | Role::Port | Role::Pattern => return None,
                };
                let at = self.shown(self.seen(mark.at - scene.origin));
                Some(NamedPlace { name: mark.name, at, of })
            })
            .collect()
    }
}

/// Whether a path was counted by a sensor that has a place.
fn meets_surface(scene: &Scene, track: &Track) -> bool {
    track.counted_by.iter().any(|id| match scene.sensors[id.index()].kind {
        SensorKind::Surface(_) => true,
        SensorKind::Goniometer(_) => false,
    })
}
