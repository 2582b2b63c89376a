//! Sensors that photons are joined to.

use crate::rng::{Dimension, Sampler};
use crate::scene::shape::Toward;
use crate::scene::{
    CountedLight, FaceArea, FaceId, Goniometer, Passage, Place, Scene, Seeing, SensorId,
    SensorKind, SurfaceSensor, Views,
};
use crate::transport::Vertex;
use crate::transport::connect::target::{Importance, Joinable, Targets};
use crate::transport::connect::vertex::TurnAt;
use glam::DVec3;
use lumiduct_base::math::{Aabb, uniform_sphere};
use smallvec::{SmallVec, smallvec};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Share of the joins that are spread evenly over the sensors, 1: each needs joins for an error of its own, also a small
/// one beside large ones.
const EVENLY: f64 = 0.5;
/// Largest number of joins at a vertex. With four joins instead of one, scenes with ten and with a hundred sensors reach the
/// same error in half of the time (benches/results/2026-11-24.md).
const MOST_JOINS: usize = 4;

/// The sensors of an estimator that points can be drawn on.
#[derive(Debug)]
pub(crate) struct SensorTargets<'s> {
    targets: Targets<SensorTarget<'s>>,
    /// Those that separate directions of light that leaves their faces.
    leaving: BTreeMap<SensorId, LeavingTarget<'s>>,
    /// The same by face.
    leaving_of: BTreeMap<FaceId, Vec<(SensorId, LeavingTarget<'s>)>>,
}

/// A sensor that sees light in some directions as it leaves a face.
#[derive(Debug, Clone, Copy)]
struct LeavingTarget<'s> {
    sensor: &'s SurfaceSensor,
    views: &'s Views,
}

/// A sensor that vertices are joined to.
#[derive(Debug)]
struct SensorTarget<'s> {
    id: SensorId,
    extent: SensorExtent<'s>,
    /// Its area, mm².
    area: f64,
    /// A ball around it, mm.
    center: DVec3,
    reach: f64,
}

#[derive(Debug)]
enum SensorExtent<'s> {
    Surface(&'s SurfaceSensor, FaceArea<'s>),
    Sphere(&'s Goniometer, f64),
    /// The far distance, in all directions.
    Far(&'s Goniometer),
}

/// A point of a sensor, drawn to be joined to a vertex.
#[derive(Debug, Clone)]
pub(crate) struct SensorPoint {
    pub(crate) sensor: SensorId,
    /// Position, mm; of a far field, that of the vertex.
    pub(crate) point: DVec3,
    /// Unit normal of the sensor.
    pub(crate) normal: DVec3,
    /// Unit direction of light from the vertex.
    pub(crate) dir: DVec3,
    /// Distance from the vertex, mm; infinite for a far field.
    pub(crate) distance: f64,
    /// The cells that count the light.
    pub(crate) cells: SmallVec<[usize; 1]>,
    /// Solid angle of the sensor from the vertex over the density of the draws, sr.
    pub(crate) solid_angle: f64,
}

impl<'s> SensorTargets<'s> {
    /// Those of some sensors that can be joined: not those that count light only on its first
    /// passage or all light that leaves a face.
    pub(crate) fn new(scene: &'s Scene, sensors: impl Iterator<Item = SensorId> + Clone) -> Self {
        let targets = sensors.clone().filter_map(|id| target(scene, id));
        let targets = Targets::new(targets, EVENLY);
        let leaving = sensors.filter_map(|id| Some((id, leaving_target(scene, id)?)));
        let leaving: BTreeMap<SensorId, LeavingTarget<'_>> = leaving.collect();
        let mut leaving_of: BTreeMap<FaceId, Vec<_>> = BTreeMap::new();
        for (&id, target) in &leaving {
            for &face in &target.sensor.faces {
                leaving_of.entry(face).or_default().push((id, *target));
            }
        }
        Self { targets, leaving, leaving_of }
    }

    /// Whether there is none.
    pub(crate) fn is_empty(&self) -> bool {
        self.targets.len() == 0 && self.leaving.is_empty()
    }

    /// A direction for each sensor that sees light as it leaves the face of a vertex.
    pub(crate) fn draw_leaving(
        &self,
        scene: &Scene,
        vertex: &Vertex<'_>,
        sampler: &mut Sampler,
        mut visit: impl FnMut(SensorPoint),
    ) {
        let point = vertex.point;
        for hit in vertex.hits.all() {
            let targets = self.leaving_of.get(&hit.face).into_iter().flatten();
            for &(id, LeavingTarget { sensor, views }) in targets {
                let Some(cell) = sensor.grid.cell(scene.chart(hit.prim, point)) else { continue };
                let normal = scene.normal(hit.prim, point);
                let (dir, accepting) = views.draw(None, sampler);
                if !sensor.sides.include(sensor.counts, Toward::of(dir, normal)) {
                    continue;
                }
                let solid_angle = 1.0 / views.density(accepting.len());
                let cells = accepting.iter().map(|view| view * sensor.grid.cells() + cell);
                let cells = cells.collect();
                let distance = 0.0;
                visit(SensorPoint { sensor: id, point, normal, dir, distance, cells, solid_angle });
            }
        }
    }

    /// Joins at a vertex: one for each sensor, up to a few.
    pub(crate) fn joins(&self) -> usize {
        self.targets.len().min(MOST_JOINS)
    }

    /// A point for one of the joins of a vertex, on a sensor chosen by its chance; `None` where it does not
    /// count light from there.
    pub(crate) fn draw(
        &self,
        vertex: DVec3,
        join: usize,
        sampler: &mut Sampler,
    ) -> Option<SensorPoint> {
        let draw = || (join as f64 + sampler.one(Dimension::GatherPosition)) / self.joins() as f64;
        let target = self.targets.choose(vertex, draw)?;
        let (point, normal, cell) = match &target.extent {
            SensorExtent::Surface(sensor, area) => {
                let drawn = area.sample(sampler.pair(Dimension::GatherPosition))?;
                (drawn.point, drawn.normal, sensor.grid.cell(drawn.uv)?)
            }
            SensorExtent::Sphere(goniometer, radius) => {
                let out = uniform_sphere(sampler.pair(Dimension::GatherPosition));
                let cell = goniometer.cell(out);
                (goniometer.frame.origin + radius * out, out, cell)
            }
            SensorExtent::Far(goniometer) => {
                let dir = uniform_sphere(sampler.pair(Dimension::GatherPosition));
                return Some(SensorPoint {
                    sensor: target.id,
                    point: vertex,
                    normal: dir,
                    dir,
                    distance: f64::INFINITY,
                    cells: smallvec![goniometer.cell(dir)],
                    solid_angle: self.solid_angle(target, vertex, (vertex, dir), dir),
                });
            }
        };
        let offset = point - vertex;
        let distance = offset.length();
        let dir = offset / distance;
        if !dir.is_finite() {
            return None;
        }
        let cells = target.cells(cell, dir, normal)?;
        let solid_angle = self.solid_angle(target, vertex, (point, normal), dir);
        Some(SensorPoint { sensor: target.id, point, normal, dir, distance, cells, solid_angle })
    }

    /// The etendue of a photon joined to a known point of a sensor over that of one that is counted
    /// there; infinite if it cannot be joined.
    pub(crate) fn joined_ratio(
        &self,
        turn: Option<TurnAt<'s>>,
        sensor: SensorId,
        (point, normal): (DVec3, DVec3),
    ) -> f64 {
        let ratio = turn.and_then(|(vertex, [arriving, leaving])| {
            let solid_angle = if let Some(target) = self.leaving.get(&sensor) {
                1.0 / target.views.density(target.views.accepting(leaving).count().max(1))
            } else {
                let target = self.targets.numbered(sensor.index())?;
                self.solid_angle(target, vertex.point, (point, normal), leaving)
            };
            let light = vertex.scattered(arriving, leaving)?;
            Some(light.density / light.albedo * solid_angle)
        });
        ratio.unwrap_or(f64::INFINITY)
    }

    /// `|cos θ| / (d² p)`, sr, with the density p of points of all joins per area; `1/p` of directions, for a far field.
    fn solid_angle(
        &self,
        target: &SensorTarget<'s>,
        vertex: DVec3,
        (point, normal): (DVec3, DVec3),
        dir: DVec3,
    ) -> f64 {
        let chosen = self.targets.chance(target, vertex) * self.joins() as f64;
        let normal = match &target.extent {
            SensorExtent::Surface(..) => normal,
            SensorExtent::Sphere(sphere, radius) => (point - sphere.frame.origin) / *radius,
            SensorExtent::Far(_) => return 4.0 * PI / chosen,
        };
        dir.dot(normal).abs() * target.area / (chosen * point.distance_squared(vertex))
    }
}

impl Joinable for SensorTarget<'_> {
    fn number(&self) -> usize {
        self.id.index()
    }

    /// What it can receive from a point: its solid angle, roughly, sr.
    fn importance(&self) -> Importance {
        let Self { area: strength, center, reach, .. } = *self;
        match self.extent {
            SensorExtent::Far(_) => Importance { anywhere: 4.0 * PI, ..Importance::default() },
            SensorExtent::Surface(..) | SensorExtent::Sphere(..) => {
                Importance { anywhere: 0.0, strength, center, reach }
            }
        }
    }
}

impl SensorTarget<'_> {
    /// The cells that count light along `dir`; `None` if none do.
    fn cells(&self, cell: usize, dir: DVec3, normal: DVec3) -> Option<SmallVec<[usize; 1]>> {
        let sensor = match &self.extent {
            SensorExtent::Surface(sensor, _) => sensor,
            SensorExtent::Sphere(..) | SensorExtent::Far(_) => {
                return (dir.dot(normal) > 0.0).then(|| smallvec![cell]);
            }
        };
        if !sensor.sides.include(sensor.counts, Toward::of(dir, normal)) {
            return None;
        }
        let away = match sensor.counts {
            CountedLight::Incident => -dir,
            CountedLight::Leaving => dir,
        };
        let count = sensor.grid.cells();
        let cells: SmallVec<[usize; 1]> = match &sensor.seeing {
            Seeing::All => smallvec![cell],
            Seeing::Views(views) => views.accepting(away).map(|view| view * count + cell).collect(),
            Seeing::Pixels(pixels) => {
                pixels.pixel(away).map(|pixel| pixel * count + cell).into_iter().collect()
            }
        };
        (!cells.is_empty()).then_some(cells)
    }
}

fn leaving_target(scene: &Scene, id: SensorId) -> Option<LeavingTarget<'_>> {
    let SensorKind::Surface(sensor) = &scene.sensors[id.index()].kind else { return None };
    let Seeing::Views(views) = &sensor.seeing else { return None };
    let leaves = sensor.place == Place::Face && sensor.counts == CountedLight::Leaving;
    (leaves && sensor.passage == Passage::Every).then_some(LeavingTarget { sensor, views })
}

fn target(scene: &Scene, id: SensorId) -> Option<SensorTarget<'_>> {
    match &scene.sensors[id.index()].kind {
        SensorKind::Surface(sensor) => {
            let arrives = sensor.place == Place::Port || sensor.counts == CountedLight::Incident;
            if !arrives || sensor.passage == Passage::First {
                return None;
            }
            let bounds = sensor
                .faces
                .iter()
                .fold(Aabb::EMPTY, |bounds, &face| bounds.union(scene.face_bounds(face)));
            let area = FaceArea::new(scene, &sensor.faces);
            (area.area() > 0.0).then(|| SensorTarget {
                id,
                area: area.area(),
                extent: SensorExtent::Surface(sensor, area),
                center: bounds.center(),
                reach: 0.5 * bounds.diagonal(),
            })
        }
        SensorKind::Goniometer(goniometer) => {
            let (extent, radius) = match goniometer.radius {
                Some(radius) => (SensorExtent::Sphere(goniometer, radius), radius),
                None => (SensorExtent::Far(goniometer), f64::INFINITY),
            };
            let (area, center) = (4.0 * PI * radius * radius, goniometer.frame.origin);
            Some(SensorTarget { id, extent, area, center, reach: radius })
        }
    }
}
