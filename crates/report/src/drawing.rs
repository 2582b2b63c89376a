//! The scene for drawing in three dimensions: faces as triangles, sources and sensors by name, and
//! some paths of light.
//!
//! Plain data in the user's coordinates. The view is not known here.

use crate::upright::is_lit_from_above;
use glam::DVec3;
use lumiduct_base::math::Aabb;
use lumiduct_core::scene::mesh::MeshBody;
use lumiduct_core::scene::{
    Face, FaceFacets, FaceId, Fineness, Owner, Scene, SensorKind, SourceId, Triangulation,
    shape_facets,
};
use lumiduct_core::transport::{Track, TrackEnd};
use serde::Serialize;
use std::collections::BTreeSet;

/// Invisible deviation of chords, as a share of the size of the scene, 1.
const DEVIATION: f64 = 2e-4;
/// Edge of the cubes in which mesh vertices are merged, likewise.
const MESH_CELL: f64 = 0.004;
/// Most pieces of a face that are drawn.
const PATCHES: usize = 500;
/// Most faces that are drawn: more make an unusable page of many megabytes.
const FACES: usize = 1500;
/// Most elements of a pattern that are drawn.
const ELEMENTS: usize = 600;
/// Most points of a path that are drawn.
const POINTS: usize = 100;
/// Paths are drawn up to this distance from the middle, in radii of the scene, 1.
const REACH: f64 = 1.25;

/// Everything drawn of a scene.
#[derive(Debug, Clone)]
pub struct SceneDrawing {
    /// Middle of all faces, mm.
    pub middle: DVec3,
    /// Radius of a ball around all faces, mm.
    pub radius: f64,
    /// Faces, and the surfaces of sources.
    pub faces: Vec<DrawnFace>,
    /// Names and their places.
    pub marks: Vec<NameMark>,
    /// Paths of light.
    pub paths: Vec<DrawnPath>,
    /// Whether +z is up, as light comes from above.
    pub is_upright: bool,
    /// Remarks on what was left out.
    pub remarks: Vec<String>,
}

/// A face, the elements of a pattern, or the surface of a source.
#[derive(Debug, Clone)]
pub struct DrawnFace {
    /// Its name.
    pub name: String,
    /// What it is.
    pub role: Role,
    /// Its triangles, mm.
    pub facets: Triangulation,
}

/// The kind of a drawn thing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// A face of a solid.
    Solid,
    /// A sheet.
    Sheet,
    /// An open port.
    Port,
    /// Elements of a pattern.
    Pattern,
    /// A face that a sensor lies on, or a sensor in free space.
    Sensor,
    /// A source.
    Source,
}

/// A name at a place.
#[derive(Debug, Clone)]
pub struct NameMark {
    /// The name.
    pub name: String,
    /// Kind of the named thing.
    pub role: Role,
    /// Where, mm.
    pub at: DVec3,
}

/// A path of light.
#[derive(Debug, Clone)]
pub struct DrawnPath {
    /// Its points, mm.
    pub points: Vec<DVec3>,
    /// Its fate.
    pub fate: Fate,
    /// The same in words: `absorbed by pipe.wall`.
    pub end: String,
}

/// The fate of a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Fate {
    /// A sensor counted it at its end, or after it had left all surfaces.
    Counted,
    /// A face absorbed it, or faces and media absorbed it gradually.
    Absorbed,
    /// It left the scene.
    Escaped,
    /// It leaked, or was cut off.
    Lost,
}

/// A scene with some paths, ready to be drawn.
pub fn drawing(scene: &Scene, tracks: &[Track]) -> SceneDrawing {
    let size = solid_bounds(scene).diagonal();
    let fineness =
        Fineness { deviation: DEVIATION * size, mesh_cell: MESH_CELL * size, patches: PATCHES };
    let mut remarks = Vec::new();
    let mut faces = faces(scene, &fineness, &mut remarks);
    faces.extend(elements(scene, &mut remarks));
    faces.extend(sources(scene, fineness.deviation));
    let points = faces.iter().flat_map(|face| face.facets.points.iter().copied());
    let bounds = Aabb::of(points.chain(small_sources(scene)));
    let (middle, radius) = (bounds.center(), 0.5 * bounds.diagonal());
    let paths: Vec<(SourceId, DrawnPath)> = tracks
        .iter()
        .map(|track| (track.source, path(scene, track, middle, REACH * radius)))
        .filter(|(_, path)| path.points.len() > 1)
        .collect();
    if tracks.iter().any(|track| track.points.len() > POINTS) {
        remarks.push(format!("only the first {POINTS} points of each path are drawn"));
    }
    let marks = marks(scene, &faces, &paths);
    faces.retain(|face| !face.facets.points.is_empty());
    let mut drawing = SceneDrawing {
        middle,
        radius,
        faces,
        marks,
        paths: paths.into_iter().map(|(_, path)| path).collect(),
        is_upright: is_lit_from_above(scene),
        remarks,
    };
    drawing.shift(scene.origin);
    drawing
}

impl SceneDrawing {
    fn shift(&mut self, by: DVec3) {
        self.middle += by;
        let faces = self.faces.iter_mut().flat_map(|face| face.facets.points.iter_mut());
        let paths = self.paths.iter_mut().flat_map(|path| path.points.iter_mut());
        faces.chain(paths).chain(self.marks.iter_mut().map(|mark| &mut mark.at)).for_each(|p| {
            *p += by;
        });
    }
}

/// The box around everything that is not at infinity.
fn solid_bounds(scene: &Scene) -> Aabb {
    let patches = scene.patches.iter().chain(&scene.ports).map(|patch| patch.shape.bounds());
    let meshes = scene.mesh_bodies().map(MeshBody::bounds);
    patches.chain(meshes).fold(Aabb::EMPTY, Aabb::union)
}

fn faces(scene: &Scene, fineness: &Fineness, remarks: &mut Vec<String>) -> Vec<DrawnFace> {
    let sensed: BTreeSet<FaceId> = sensed_faces(scene).into_iter().collect();
    let mut faces = Vec::new();
    let one_in = scene.faces.len().div_ceil(FACES).max(1);
    if one_in > 1 {
        remarks.push(format!("only one in {one_in} of the {} faces is drawn", scene.faces.len()));
    }
    for (index, face) in scene.faces.iter().enumerate() {
        let id = FaceId::new(index);
        // Solids are drawn whole or not at all.
        let place = match face.owner {
            Owner::Solid(solid) => solid.index(),
            Owner::Sheet | Owner::Port => index,
        };
        let found = if place % one_in == 0 {
            scene.face_facets(id, fineness)
        } else {
            FaceFacets { facets: Triangulation::default(), one_in: 1 }
        };
        if found.one_in > 1 {
            remarks.push(format!("only one piece in {} of `{}` is drawn", found.one_in, face.name));
        }
        let role = role(face, sensed.contains(&id));
        faces.push(DrawnFace { name: face.name.clone(), role, facets: found.facets });
    }
    faces
}

/// The outlines of the elements of patterns.
fn elements(scene: &Scene, remarks: &mut Vec<String>) -> Vec<DrawnFace> {
    let mut drawn = Vec::new();
    for pattern in &scene.patterns {
        let found = scene.element_outlines(pattern, ELEMENTS);
        if found.one_in > 1 {
            remarks.push(format!(
                "only one in {} of the elements of `{}` is drawn",
                found.one_in, pattern.name
            ));
        }
        if !found.facets.points.is_empty() {
            let (name, role) = (pattern.name.clone(), Role::Pattern);
            drawn.push(DrawnFace { name, role, facets: found.facets });
        }
    }
    drawn
}

/// What a face is drawn as.
pub(crate) fn role(face: &Face, is_sensed: bool) -> Role {
    match face.owner {
        _ if is_sensed => Role::Sensor,
        Owner::Solid(_) => Role::Solid,
        Owner::Sheet => Role::Sheet,
        Owner::Port => Role::Port,
    }
}

pub(crate) fn sensed_faces(scene: &Scene) -> Vec<FaceId> {
    let of = |kind: &SensorKind| match kind {
        SensorKind::Surface(surface) => surface.faces.clone(),
        SensorKind::Goniometer(_) => Vec::new(),
    };
    scene.sensors.iter().flat_map(|sensor| of(&sensor.kind)).collect()
}

/// The surfaces of extended sources.
fn sources(scene: &Scene, deviation: f64) -> Vec<DrawnFace> {
    let mut faces = Vec::new();
    let one_in = scene.sources.len().div_ceil(FACES).max(1);
    for source in scene.sources.iter().step_by(one_in) {
        let mut facets = Triangulation::default();
        for (shape, _) in source.emitter.shapes() {
            facets.append(shape_facets(shape, deviation));
        }
        if let Some(ends) = source.emitter.line() {
            facets.points.extend(ends);
            facets.rims.push(vec![0, 1]);
        }
        if facets.points.is_empty() {
            continue;
        }
        faces.push(DrawnFace { name: source.name.clone(), role: Role::Source, facets });
    }
    faces
}

/// Sources in the scene without a surface.
fn small_sources(scene: &Scene) -> impl Iterator<Item = DVec3> {
    scene.sources.iter().filter_map(|source| Some(source.emitter.point()?.origin))
}

fn marks(scene: &Scene, faces: &[DrawnFace], paths: &[(SourceId, DrawnPath)]) -> Vec<NameMark> {
    let mut marks = Vec::new();
    for (index, source) in scene.sources.iter().enumerate() {
        let drawn = faces.iter().find(|face| face.role == Role::Source && face.name == source.name);
        let starts =
            paths.iter().filter(|(from, _)| from.index() == index).map(|(_, path)| path.points[0]);
        let starts = Triangulation { points: starts.collect(), ..Triangulation::default() };
        let at = drawn.and_then(|face| face.facets.middle()).or_else(|| starts.middle());
        let name = source.name.clone();
        marks.extend(at.map(|at| NameMark { name, role: Role::Source, at }));
    }
    for sensor in &scene.sensors {
        let at = match &sensor.kind {
            SensorKind::Surface(surface) => {
                let mut all = Triangulation::default();
                surface.faces.iter().for_each(|id| {
                    all.points.extend(&faces[id.index()].facets.points);
                });
                all.middle()
            }
            SensorKind::Goniometer(goniometer) => Some(goniometer.frame.origin),
        };
        let name = match &sensor.kind {
            SensorKind::Surface(_) => sensor.name.clone(),
            SensorKind::Goniometer(_) => format!("{} (all around)", sensor.name),
        };
        marks.extend(at.map(|at| NameMark { name, role: Role::Sensor, at }));
    }
    marks
}

fn path(scene: &Scene, track: &Track, middle: DVec3, reach: f64) -> DrawnPath {
    let (fate, end) = fate(scene, track);
    let mut points: Vec<DVec3> = Vec::new();
    for ends in track.points[..track.points.len().min(POINTS)].windows(2) {
        if let Some([from, to]) = within(ends[0], ends[1], middle, reach) {
            if points.last() != Some(&from) {
                points.push(from);
            }
            points.push(to);
        }
    }
    DrawnPath { points, fate, end }
}

/// The part of a straight line within a ball.
fn within(from: DVec3, to: DVec3, middle: DVec3, radius: f64) -> Option<[DVec3; 2]> {
    let (start, along) = (from - middle, to - from);
    let (a, half_b) = (along.length_squared(), start.dot(along));
    let discriminant = half_b * half_b - a * (start.length_squared() - radius * radius);
    if a == 0.0 || discriminant < 0.0 {
        return None;
    }
    let root = discriminant.sqrt();
    let enter = ((-half_b - root) / a).max(0.0);
    let leave = ((-half_b + root) / a).min(1.0);
    (enter < leave).then(|| {
        let at = |share: f64, end: DVec3| {
            if share == share.round() { end } else { from + share * along }
        };
        [at(enter, from), at(leave, to)]
    })
}

/// The fate of a path, and its wording.
pub(crate) fn fate(scene: &Scene, track: &Track) -> (Fate, String) {
    let counted = |id: lumiduct_core::scene::SensorId| {
        (Fate::Counted, format!("counted by {}", scene.sensors[id.index()].name))
    };
    match track.end {
        TrackEnd::Absorbed(face) => {
            let at_its_end =
                track.counted_by.iter().rev().find(|id| match &scene.sensors[id.index()].kind {
                    SensorKind::Surface(surface) => surface.faces.contains(&face),
                    SensorKind::Goniometer(_) => false,
                });
            let name = &scene.faces[face.index()].name;
            at_its_end
                .map_or_else(|| (Fate::Absorbed, format!("absorbed by {name}")), |id| counted(*id))
        }
        TrackEnd::Escaped => {
            // A sensor at a place is more informative than a sphere around everything.
            let surface =
                track.counted_by.iter().rev().find(|id| match &scene.sensors[id.index()].kind {
                    SensorKind::Surface(_) => true,
                    SensorKind::Goniometer(_) => false,
                });
            surface
                .or(track.counted_by.last())
                .map_or((Fate::Escaped, "escaped".into()), |id| counted(*id))
        }
        TrackEnd::Faded => (Fate::Absorbed, "absorbed gradually".into()),
        TrackEnd::Cut => (Fate::Lost, "not followed to its end".into()),
        TrackEnd::Leaked => (Fate::Lost, "leaked".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_at_the_ball_and_those_that_miss_it_are_none() {
        let line = |from: [f64; 3], to: [f64; 3]| {
            within(DVec3::from(from), DVec3::from(to), DVec3::X, 2.0)
        };
        assert_eq!(line([0.0; 3], [1.0, 1.0, 0.0]), Some([DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0)]));
        let [from, to] = line([-9.0, 0.0, 0.0], [9.0, 0.0, 0.0]).unwrap();
        assert!(from.distance(-DVec3::X) < 1e-12 && to.distance(3.0 * DVec3::X) < 1e-12);
        assert_eq!(line([-9.0, 5.0, 0.0], [9.0, 5.0, 0.0]), None);
        assert_eq!(line([0.0; 3], [0.0; 3]), None);
        assert_eq!(line([5.0, 0.0, 0.0], [9.0, 0.0, 0.0]), None);
    }
}
