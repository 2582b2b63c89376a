//! The picture of a check: a cut through the scene, with paths of light, sources and sensors.

use crate::drawing::{Fate, Role, drawing, fate};
use crate::png::{CrossSection, NamedPlace, PlaceOf, RayEnd, RayPath, SurfaceDots, cross_section};
use crate::upright::is_lit_from_above;
use glam::{DVec2, DVec3};
use lumiduct_base::error::{Error, Result};
use lumiduct_base::math::{Aabb, Frame};
use lumiduct_base::number::format_value;
use lumiduct_core::scene::shape::ChartRect;
use lumiduct_core::scene::{Emitter, Scene, SensorKind};
use lumiduct_core::transport::Track;
use std::collections::BTreeSet;

/// Margin around what is shown, in diagonals of its box, 1.
const MARGIN: f64 = 0.06;
/// Margin around the zoomed object, in lengths of its longer side, 1.
const ZOOM_MARGIN: f64 = 0.25;
/// Least shorter side of a zoomed picture, in lengths of the longer side, 1.
const ZOOM_ASPECT: f64 = 0.5;
/// Sine of the angle between a direction and the plane's normal below which they count as parallel:
/// a degree.
const PARALLEL: f64 = 0.017;
/// Coordinates below this share of the size of the scene are 0, 1.
const ROUNDING: f64 = 1e-9;
/// Most listed names of things outside the picture.
const OUTSIDE: usize = 6;

/// How to draw the cut of a check; omitted values are chosen from the scene.
#[derive(Debug, Clone, Default)]
pub struct SectionView {
    /// The plane; by default that of the centre line of the guide.
    pub plane: Option<CutPlane>,
    /// A face, solid, sheet, source or sensor to zoom in on; by default the guide and its
    /// surroundings.
    pub zoom: Option<String>,
    /// The direction that points up in the picture.
    pub up: Option<DVec3>,
}

/// A plane across an axis of the coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CutPlane {
    /// The axis normal to it: 0 is x, 1 is y, 2 is z.
    pub across: usize,
    /// Its place on that axis, mm; `None` is the middle of what is shown.
    pub at_mm: Option<f64>,
}

/// Names of the axes of the coordinates.
const AXES: [&str; 3] = ["x", "y", "z"];

/// The cross-section of a scene with some traced paths.
///
/// # Errors
///
/// [`Error::Usage`] if the part to zoom in on is not in the scene or far away, or the upward direction is
/// perpendicular to the picture; [`Error::Output`] if the picture cannot be drawn.
pub fn scene_picture(
    title: &str,
    scene: &Scene,
    tracks: &[Track],
    wished: &SectionView,
) -> Result<Vec<u8>> {
    let view = View::of(scene, wished)?;
    let [low, high] = [view.window.min, view.window.max].map(|corner| view.shown(corner));
    let (outlines, places) = (view.outlines(scene), view.places(scene, tracks));
    cross_section(&CrossSection {
        title: title.to_owned(),
        subtitle: view.words(scene, tracks.len(), &outlines, &places),
        x_label: format!("{} in mm", axis_name(view.plane.x)),
        y_label: format!("{} in mm", axis_name(view.plane.y)),
        x_range: [low[0], high[0]],
        y_range: [low[1], high[1]],
        outlines,
        rays: tracks.iter().map(|track| view.ray(scene, track)).collect(),
        places,
    })
}

/// The name of a direction: `x`, `-z`, or its components.
fn axis_name(direction: DVec3) -> String {
    let parts = direction.to_array();
    match parts.iter().position(|part| part.abs() > 1.0 - 1e-9) {
        Some(axis) if parts[axis] > 0.0 => AXES[axis].to_owned(),
        Some(axis) => format!("-{}", AXES[axis]),
        None => format!("along {}", triple(direction)),
    }
}

fn triple(v: DVec3) -> String {
    let [x, y, z] = v.to_array().map(|part| format!("{part:.3}"));
    format!("({x}, {y}, {z})")
}

/// The view of a scene.
struct View {
    /// The plane of the cut; x and y are the axes of the picture.
    plane: Frame,
    /// Its origin along its axes, in the user's coordinates, mm.
    origin: DVec2,
    /// The part of the plane that is drawn, mm.
    window: ChartRect,
}

impl View {
    fn of(scene: &Scene, wished: &SectionView) -> Result<Self> {
        let guides = scene.guides();
        let zoom = wished.zoom.as_ref().map(|name| bounds_of(scene, name)).transpose()?;
        let shown = zoom.unwrap_or(guides.bounds);
        let (normal, origin) = match wished.plane {
            Some(cut) => {
                let mut origin = shown.center();
                if let Some(at) = cut.at_mm {
                    origin[cut.across] = at - scene.origin[cut.across];
                }
                (DVec3::AXES[cut.across], origin)
            }
            None => {
                let (normal, origin) = (guides.plane.z, guides.plane.origin);
                let [least, most] = reach(&shown, normal);
                let is_met = (least..=most).contains(&origin.dot(normal));
                (normal, if is_met { origin } else { shown.center() })
            }
        };
        let [x, y] = axes(scene, normal, wished.up)?;
        let plane = Frame { origin, x, y, z: x.cross(y) };
        let window = match zoom {
            Some(zoom) => zoomed(&plane, &zoom),
            None => around(&plane, &shown, MARGIN * shown.diagonal()),
        };
        let origin = origin + scene.origin;
        Ok(Self { plane, origin: DVec2::new(origin.dot(x), origin.dot(y)), window })
    }

    /// The plane, the number of paths, and what is outside the picture.
    fn words(
        &self,
        scene: &Scene,
        paths: usize,
        outlines: &[SurfaceDots],
        places: &[NamedPlace],
    ) -> String {
        let origin = self.plane.origin + scene.origin;
        let across = axis_name(self.plane.z);
        let name = across.trim_start_matches('-');
        let mut words = match AXES.iter().position(|axis| *axis == name) {
            Some(axis) => {
                // Removes rounding noise.
                let rounding = ROUNDING * scene.bounds.diagonal();
                let at = if origin[axis].abs() < rounding { 0.0 } else { origin[axis] };
                format!("cut at {name} = {} mm", format_value(at))
            }
            None => format!("cut through {} mm across {}", triple(origin), triple(self.plane.z)),
        };
        if outlines.is_empty() {
            words += ", which meets nothing";
        }
        words += &format!("; {paths} paths, projected onto it");
        let [low, high] =
            [self.window.min, self.window.max].map(|corner| DVec2::from(self.shown(corner)));
        let is_outside = |place: &&NamedPlace| {
            let at = DVec2::from(place.at);
            at.cmplt(low).any() || at.cmpgt(high).any()
        };
        let outside: BTreeSet<&str> =
            places.iter().filter(is_outside).map(|place| place.name.as_str()).collect();
        if !outside.is_empty() {
            let shown: Vec<&str> = outside.iter().copied().take(OUTSIDE).collect();
            words += &format!("; outside: {}", shown.join(", "));
            if outside.len() > OUTSIDE {
                words += &format!(" and {} more", outside.len() - OUTSIDE);
            }
        }
        words
    }

    /// A place of the plane in the user's coordinates, mm.
    fn shown(&self, at: DVec2) -> [f64; 2] {
        (at + self.origin).to_array()
    }

    /// A point of the scene, seen along the normal, mm of the plane.
    fn seen(&self, point: DVec3) -> DVec2 {
        self.plane.point_to_local(point).truncate()
    }

    fn outlines(&self, scene: &Scene) -> Vec<SurfaceDots> {
        let found = scene.section(&self.plane, self.window).into_iter().enumerate();
        found
            .map(|(colour, outline)| SurfaceDots {
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
                // A sphere around everything counts all escaping light.
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

/// The axes of a picture: to the right and up. Numbers grow to the right.
fn axes(scene: &Scene, normal: DVec3, up: Option<DVec3>) -> Result<[DVec3; 2]> {
    let across = normal.abs().max_position();
    let usual = match across {
        0 | 1 if is_lit_from_above(scene) => DVec3::Z,
        1 => DVec3::X,
        0 | 2.. => DVec3::Y,
    };
    let wanted = up.unwrap_or(usual);
    let y = wanted - wanted.dot(normal) * normal;
    if y.length() < PARALLEL * wanted.length() {
        return Err(Error::Usage(format!(
            "--up {}: is perpendicular to the picture, whose plane is across {}; name a direction in that plane",
            axis_name(wanted),
            axis_name(normal)
        )));
    }
    let y = y.normalize();
    let x = y.cross(normal);
    let grows = x[x.abs().max_position()] > 0.0;
    Ok([if grows { x } else { -x }, y])
}

/// Least and greatest coordinate of a box along a direction, mm.
fn reach(bounds: &Aabb, along: DVec3) -> [f64; 2] {
    let (middle, half) = (bounds.center().dot(along), 0.5 * (bounds.max - bounds.min));
    let half = half.dot(along.abs());
    [middle - half, middle + half]
}

/// A box in projection, with a margin, mm.
fn around(plane: &Frame, bounds: &Aabb, margin: f64) -> ChartRect {
    let [[left, right], [low, high]] = [plane.x, plane.y]
        .map(|axis| reach(bounds, axis).map(|place| place - plane.origin.dot(axis)));
    let (min, max) = (DVec2::new(left, low), DVec2::new(right, high));
    ChartRect { min: min - margin, max: max + margin }
}

/// A box in projection, with room around it, mm.
fn zoomed(plane: &Frame, bounds: &Aabb) -> ChartRect {
    let close = around(plane, bounds, 0.0);
    let (middle, half) = (0.5 * (close.min + close.max), 0.5 * (close.max - close.min));
    // A point has no size and is shown with a millimetre around it.
    let longest = if half.max_element() > 0.0 { half.max_element() } else { 0.5 };
    let half = half.max(DVec2::splat(ZOOM_ASPECT * longest)) + 2.0 * ZOOM_MARGIN * longest;
    ChartRect { min: middle - half, max: middle + half }
}

/// The box around the face, solid, sheet, source or sensor of this name, mm.
fn bounds_of(scene: &Scene, name: &str) -> Result<Aabb> {
    if let Some(face) = scene.face_named(name) {
        return Ok(scene.face_bounds(face));
    }
    let bodies = scene.bodies();
    if let Some(body) = bodies.iter().find(|body| body.name == name) {
        return Ok(body.bounds);
    }
    let source = scene.sources.iter().find(|source| source.name == name);
    let sensor = scene.sensors.iter().find(|sensor| sensor.name == name);
    let found = match (source.map(|source| &source.emitter), sensor.map(|sensor| &sensor.kind)) {
        (Some(Emitter::Far { .. }), _) => {
            return Err(Error::Usage(format!(
                "--zoom {name}: the source is far away; name a face or a solid"
            )));
        }
        (Some(emitter), _) => emitter.bounds(),
        (None, Some(SensorKind::Surface(surface))) => surface
            .faces
            .iter()
            .fold(Aabb::EMPTY, |bounds, face| bounds.union(scene.face_bounds(*face))),
        (None, Some(SensorKind::Goniometer(goniometer))) => {
            goniometer.bounds().union(Aabb::of([goniometer.frame.origin]))
        }
        (None, None) => return Err(unknown(scene, name)),
    };
    Ok(found)
}

fn unknown(scene: &Scene, name: &str) -> Error {
    let bodies: Vec<String> = scene.bodies().into_iter().map(|body| body.name).collect();
    let faces: Vec<&str> = scene.faces.iter().map(|face| face.name.as_str()).collect();
    let sources = scene.sources.iter().map(|source| source.name.as_str());
    let sensors = scene.sensors.iter().map(|sensor| sensor.name.as_str());
    let all: BTreeSet<&str> = bodies
        .iter()
        .map(String::as_str)
        .chain(faces.iter().copied())
        .chain(sources)
        .chain(sensors)
        .collect();
    let all: Vec<&str> = all.into_iter().collect();
    Error::Usage(format!("--zoom {name}: the scene has {}", all.join(", ")))
}

#[cfg(test)]
pub(super) mod tests;
