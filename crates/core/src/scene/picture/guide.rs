//! The bodies of a scene that guide light, and the plane that contains their centre line: for
//! pictures alone.
//!
//! A guide is a body with an entry, an exit, and walls that are large compared with both. Rooms,
//! panels and boards are not.

use crate::scene::{FaceId, PieceRange, Scene, SensorKind};
use glam::DVec3;
use lumiduct_base::math::{Aabb, Frame};

/// Smallest ratio of the walls of a guide to its ends, by area, 1: a cube has 2.
const LEAST_WALLS: f64 = 2.5;
/// Bodies with less than this share of the largest such ratio do not count as guides, 1.
const LEAST_SHARE: f64 = 0.15;
/// Sine of the angle below which two directions are the same: a degree.
const SAME_DIRECTION: f64 = 0.017;
/// Other bodies are shown with the guides when they are this close, in diagonals of the guides, 1.
const NEAR_BODY: f64 = 0.05;
/// Sources and sensors are shown when they are this close, in the same unit.
const NEAR_MARK: f64 = 0.5;
/// A body is flat if its thickness is less than this share of its size, 1.
const FLAT: f64 = 1e-9;

/// The faces of a solid or of a sheet.
#[derive(Debug, Clone)]
pub struct NamedBody {
    /// Its name.
    pub name: String,
    /// Its faces and open ports.
    pub faces: Vec<FaceId>,
    /// Box around it, mm.
    pub bounds: Aabb,
}

/// The bodies that guide light, and the position of their centre line.
#[derive(Debug, Clone)]
pub struct Guides {
    /// The plane of the centre line: its origin is on the line, z across the plane.
    pub plane: Frame,
    /// Box around the guides and what belongs to them, mm.
    pub bounds: Aabb,
}

impl Scene {
    /// All solids and sheets.
    pub fn bodies(&self) -> Vec<NamedBody> {
        let mut bodies: Vec<NamedBody> = Vec::new();
        for (index, face) in self.faces.iter().enumerate() {
            // The face of a sensor in free space has only the name of the sensor.
            let Some((name, _)) = face.name.split_once('.') else { continue };
            let bounds = self.face_bounds(FaceId::new(index));
            match bodies.iter_mut().find(|body| body.name == name) {
                Some(body) => {
                    body.faces.push(FaceId::new(index));
                    body.bounds = body.bounds.union(bounds);
                }
                None => {
                    let (name, faces) = (name.to_owned(), vec![FaceId::new(index)]);
                    bodies.push(NamedBody { name, faces, bounds });
                }
            }
        }
        bodies
    }

    /// Box around a face, mm.
    pub fn face_bounds(&self, face: FaceId) -> Aabb {
        match &self.faces[face.index()].extent {
            PieceRange::Patches(_) | PieceRange::Ports(_) => self
                .face_patches(face)
                .iter()
                .fold(Aabb::EMPTY, |bounds, patch| bounds.union(patch.shape.bounds())),
            PieceRange::Mesh(_) => {
                let pieces = self.mesh_pieces(face).map(|(body, index)| body.face_bounds(index));
                pieces.fold(Aabb::EMPTY, Aabb::union)
            }
        }
    }

    /// The guides of the scene; if there are none, everything that is not flat; for an empty scene,
    /// its middle.
    pub fn guides(&self) -> Guides {
        let bodies = self.bodies();
        let ratios: Vec<f64> = bodies.iter().map(|body| self.wall_ratio(body)).collect();
        let most = ratios.iter().copied().fold(0.0, f64::max);
        let least = LEAST_WALLS.max(LEAST_SHARE * most);
        let slender: Vec<&NamedBody> = bodies
            .iter()
            .zip(&ratios)
            .filter(|(_, ratio)| **ratio >= least)
            .map(|(body, _)| body)
            .collect();
        let found = if slender.is_empty() { solid_bodies(&bodies) } else { slender };
        let around = |bodies: &[&NamedBody]| {
            bodies.iter().fold(Aabb::EMPTY, |bounds, body| bounds.union(body.bounds))
        };
        let own = around(&found);
        let own = if own.is_empty() { self.bounds } else { own };
        // Light also goes through a pane from one end to the other.
        let led: Vec<&NamedBody> =
            found.iter().copied().filter(|body| self.wall_ratio(body) > 0.0).collect();
        let plane = self.centre_plane(&led, own);
        Guides { plane, bounds: self.with_neighbours(own, &bodies) }
    }

    /// Area of the walls of a body over the area of its ends, 1; 0 for one without an entry or an exit.
    fn wall_ratio(&self, body: &NamedBody) -> f64 {
        let [Some(entry), Some(exit)] = ["entry", "exit"].map(|end| self.end(body, end)) else {
            return 0.0;
        };
        let all: f64 = body.faces.iter().map(|face| self.face_area(*face)).sum();
        let ends = self.face_area(entry) + self.face_area(exit);
        if ends > 0.0 { (all - ends) / ends } else { 0.0 }
    }

    fn end(&self, body: &NamedBody, end: &str) -> Option<FaceId> {
        self.face_named(&format!("{}.{end}", body.name))
    }

    /// The middle of a face and, for a flat one, its normal.
    fn middle(&self, face: FaceId) -> (DVec3, Option<DVec3>) {
        match self.face_plane(face) {
            Some(frame) => (frame.origin, Some(frame.z)),
            None => (self.face_bounds(face).center(), None),
        }
    }

    /// The plane that contains the axis of the first guide and the first direction off that axis:
    /// to the exit, to its middle, along the axis at its exit, to other guides, to faces with
    /// sensors and patterns, to sources; finally along x or y.
    fn centre_plane(&self, guides: &[&NamedBody], bounds: Aabb) -> Frame {
        let ends = |guide: &NamedBody| {
            ["entry", "exit"].map(|end| self.end(guide, end).map(|face| self.middle(face)))
        };
        let Some((Some((entry, axis)), Some((exit, exit_axis)))) =
            guides.first().map(|guide| ends(guide).into())
        else {
            return plane_of_box(bounds);
        };
        let mut directions: Vec<DVec3> = axis.into_iter().collect();
        directions.extend([exit - entry, guides[0].bounds.center() - entry]);
        directions.extend(exit_axis);
        let others = guides[1..].iter().map(|guide| guide.bounds.center());
        directions.extend(others.map(|middle| middle - guides[0].bounds.center()));
        directions.extend(self.looks(bounds));
        directions.extend([DVec3::X, DVec3::Y, DVec3::Z]);
        let mut units = directions.into_iter().filter_map(DVec3::try_normalize);
        let Some(first) = units.next() else { return plane_of_box(bounds) };
        let across = units.map(|unit| first.cross(unit)).find(|n| n.length() > SAME_DIRECTION);
        let normal = snapped(across.unwrap_or(DVec3::Y).normalize());
        Frame::from_axis(entry, normal)
    }

    /// Directions from which to view sensors and patterns on walls, and directions to sources and
    /// to sensors in free space; only for those that are near.
    fn looks(&self, bounds: Aabb) -> Vec<DVec3> {
        let patterns = self.patterns.iter().map(|pattern| pattern.face);
        let reliefs = self.reliefs.iter().map(|relief| relief.wall);
        let sensed = self.sensors.iter().flat_map(|sensor| match &sensor.kind {
            SensorKind::Surface(surface) => surface.faces.clone(),
            SensorKind::Goniometer(_) => Vec::new(),
        });
        let faces: Vec<FaceId> = patterns.chain(reliefs).chain(sensed).collect();
        let near = bounds.grown(NEAR_MARK * bounds.diagonal());
        let middles: Vec<(DVec3, Option<DVec3>)> = faces
            .iter()
            .map(|face| self.middle(*face))
            .filter(|(middle, _)| near.contains(*middle))
            .collect();
        let sources = self.sources.iter().map(|source| source.emitter.bounds());
        let sources = sources.filter(|found| !found.is_empty()).map(|found| found.center());
        let ways = middles.iter().map(|(middle, _)| *middle).chain(sources);
        let ways = ways.filter(|middle| near.contains(*middle)).map(|at| at - bounds.center());
        middles.iter().filter_map(|(_, normal)| *normal).chain(ways).collect()
    }

    /// A box with the bodies, sources and sensors that are near it and not larger.
    fn with_neighbours(&self, own: Aabb, bodies: &[NamedBody]) -> Aabb {
        let size = own.diagonal();
        let is_near = |other: &Aabb, reach: f64| {
            !other.is_empty()
                && other.diagonal() <= size
                && other.overlaps(&own.grown(reach * size))
        };
        let bodies = bodies.iter().map(|body| body.bounds);
        let things = self.sources.iter().filter(|source| source.emitter.is_thing());
        let emitters = things.map(|source| source.emitter.bounds());
        let sensed = self.sensors.iter().map(|sensor| match &sensor.kind {
            SensorKind::Surface(surface) => {
                let faces = surface.faces.iter();
                faces.fold(Aabb::EMPTY, |bounds, face| bounds.union(self.face_bounds(*face)))
            }
            SensorKind::Goniometer(goniometer) => Aabb::of([goniometer.frame.origin]),
        });
        let found = bodies
            .filter(|found| is_near(found, NEAR_BODY))
            .chain(emitters.chain(sensed).filter(|found| is_near(found, NEAR_MARK)));
        found.fold(own, Aabb::union)
    }
}

/// The bodies that are not flat, without those that contain all the others.
fn solid_bodies(bodies: &[NamedBody]) -> Vec<&NamedBody> {
    let is_flat = |body: &NamedBody| {
        let size = body.bounds.max - body.bounds.min;
        size.min_element() <= FLAT * size.max_element()
    };
    let deep: Vec<&NamedBody> = bodies.iter().filter(|body| !is_flat(body)).collect();
    let deep = if deep.is_empty() { bodies.iter().collect() } else { deep };
    let holds_all = |one: &NamedBody| {
        deep.iter().all(|other| {
            other.name == one.name
                || (one.bounds.contains(other.bounds.min) && one.bounds.contains(other.bounds.max))
        })
    };
    let inner: Vec<&NamedBody> = deep.iter().copied().filter(|body| !holds_all(body)).collect();
    if inner.is_empty() { deep } else { inner }
}

/// The plane through the middle of a box across its shortest side.
fn plane_of_box(bounds: Aabb) -> Frame {
    let size = bounds.max - bounds.min;
    let normal = if size.y <= size.x.min(size.z) {
        DVec3::Y
    } else if size.x <= size.z {
        DVec3::X
    } else {
        DVec3::Z
    };
    Frame::from_axis(bounds.center(), normal)
}

/// A direction without the rounding that keeps it off a coordinate axis.
fn snapped(direction: DVec3) -> DVec3 {
    let rounded = direction.round();
    if (direction - rounded).length() < 1e-9 { rounded } else { direction }
}
