//! Finds the plain legs of a scene: where along a straight wall nothing else can be met.

mod duct;
mod elements;
mod prism;
#[cfg(test)]
mod tests;

use crate::scene::plain_leg::LegSection;
use crate::scene::shape::{Cylinder, Shape, Toward};
use crate::scene::{CountedLight, Emitter, Patch, PlainLeg, PrimId, Scene, SensorKind};
use glam::{DVec2, DVec3};
use lumiduct_base::math::Aabb;
use smallvec::SmallVec;

/// Tolerances of the scene by which other surfaces must be away.
const CLEAR: f64 = 4.0;
/// Most pairs of patches among which plain legs are looked for.
const MOST_PAIRS: usize = 10_000_000;

impl PlainLeg {
    /// The leg within a wall of a scene, if any part of it is plain.
    fn of(scene: &Scene, prim: PrimId) -> Option<Self> {
        let patch = &scene.patches[prim.index()];
        let mut leg = match &patch.shape {
            Shape::Cylinder(wall) if wall.is_uncut() => Self {
                frame: *wall.frame(),
                section: LegSection::Round {
                    radius: wall.radius(),
                    wall: prim,
                    elements: elements::on_round_wall(scene, patch, wall.radius())?,
                },
                is_one_face: true,
                spans: SmallVec::from_elem(wall.heights(), 1),
            },
            Shape::Flat(_) => duct::within(scene, prim).or_else(|| prism::within(scene, prim))?,
            Shape::Cylinder(_)
            | Shape::Cone(_)
            | Shape::Torus(_)
            | Shape::Sphere(_)
            | Shape::Paraboloid(_)
            | Shape::ParabolicCylinder(_)
            | Shape::CompoundParabola(_) => return None,
        };
        let is_free = match &leg.section {
            LegSection::Round { .. } => patch.trim.is_none() && !counts_within(scene, &leg, patch),
            LegSection::Rectangle { .. } | LegSection::Polygon { .. } => {
                leg.walls().iter().all(|wall| is_bare(scene, &scene.patches[wall.index()]))
            }
        };
        if !is_free {
            return None;
        }
        leg.leave_out_all(scene);
        (!leg.spans.is_empty()).then_some(leg)
    }

    /// Leaves out every part where something else may be met.
    fn leave_out_all(&mut self, scene: &Scene) {
        let walls = self.walls();
        let margin = CLEAR * scene.tolerance;
        let others = scene.patches.iter().enumerate();
        let others = others.filter(|(index, _)| !walls.contains(&PrimId::new(*index)));
        let shapes = others.map(|(_, patch)| &patch.shape);
        let ports = scene.ports.iter().map(|patch| &patch.shape);
        for shape in shapes.chain(ports) {
            if !self.is_clear_of(shape, margin) {
                self.leave_out(shape.bounds(), margin);
            }
        }
        scene.mesh_bodies().for_each(|body| self.leave_out(body.bounds(), margin));
        for source in &scene.sources {
            // Light from far comes from outside of everything.
            if !matches!(source.emitter, Emitter::Far { .. }) {
                self.leave_out(source.emitter.bounds(), margin);
            }
        }
        for sensor in &scene.sensors {
            if let SensorKind::Goniometer(goniometer) = &sensor.kind
                && let Some(radius) = goniometer.radius
                && self.may_touch_sphere(goniometer.frame.origin, radius, margin)
            {
                self.spans.clear();
            }
        }
        self.spans = self.spans.iter().map(|[low, high]| [low + margin, high - margin]).collect();
        self.spans.retain(|[low, high]| low < high);
    }

    /// Radius of a circle around the section, mm.
    fn radius(&self) -> f64 {
        match &self.section {
            LegSection::Round { radius, .. } => *radius,
            LegSection::Rectangle { half, .. } => half.length(),
            LegSection::Polygon { radius, .. } => *radius,
        }
    }

    /// Whether a shape is known to be away from the wall and its inside.
    fn is_clear_of(&self, shape: &Shape, margin: f64) -> bool {
        let reach = self.radius() + margin;
        match shape {
            Shape::Flat(flat) => {
                let plane = flat.frame();
                let lean = plane.z.dot(self.frame.z).abs() * self.extent();
                (plane.origin - self.frame.origin).dot(plane.z).abs() > reach + lean
            }
            Shape::Cylinder(other) => self.is_beside(other, reach),
            Shape::Cone(_)
            | Shape::Torus(_)
            | Shape::Sphere(_)
            | Shape::Paraboloid(_)
            | Shape::ParabolicCylinder(_)
            | Shape::CompoundParabola(_) => false,
        }
    }

    /// Greatest distance of a point of the axis within the spans from the frame's origin, mm.
    fn extent(&self) -> f64 {
        self.spans.iter().flatten().fold(0.0, |most, z| z.abs().max(most))
    }

    /// Whether the wall of a parallel cylinder encloses everything within `reach` of the axis, or is out of it.
    fn is_beside(&self, other: &Cylinder, reach: f64) -> bool {
        let frame = other.frame();
        let [low, high] = other.heights();
        let extent = self.extent() + low.abs().max(high.abs());
        let lean = frame.z.cross(self.frame.z).length() * extent;
        let aside = self.frame.to_local(frame.origin - self.frame.origin).truncate().length();
        aside + reach + lean < other.radius() || aside > reach + other.radius() + lean
    }

    /// Whether a spherical sensor may be met within the wall.
    fn may_touch_sphere(&self, center: DVec3, radius: f64, margin: f64) -> bool {
        let at = self.frame.point_to_local(center);
        let [low, high] =
            self.spans.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |all, span| {
                [all[0].min(span[0]), all[1].max(span[1])]
            });
        let aside = at.truncate().length();
        let nearest =
            (aside - self.radius()).max(0.0).hypot((low - at.z).max(at.z - high).max(0.0));
        let farthest = (aside + self.radius()).hypot((at.z - low).abs().max((high - at.z).abs()));
        radius >= nearest - margin && radius <= farthest + margin
    }

    /// Leaves out where a box may touch the wall or its inside.
    fn leave_out(&mut self, bounds: Aabb, margin: f64) {
        if bounds.is_empty() {
            return;
        }
        let corner = |index: usize| {
            let pick = |bit: usize, low, high| if index & bit == 0 { low } else { high };
            let (min, max) = (bounds.min, bounds.max);
            self.frame.point_to_local(DVec3::new(
                pick(1, min.x, max.x),
                pick(2, min.y, max.y),
                pick(4, min.z, max.z),
            ))
        };
        let local = Aabb::of((0..8).map(corner)).grown(margin);
        let nearest = DVec2::ZERO.clamp(local.min.truncate(), local.max.truncate());
        let is_out = match &self.section {
            LegSection::Round { radius, .. } => nearest.length() > *radius,
            LegSection::Rectangle { half, .. } => nearest.abs().cmpgt(*half).any(),
            LegSection::Polygon { radius, .. } => nearest.length() > *radius,
        };
        if is_out {
            return;
        }
        let [from, to] = [local.min.z, local.max.z];
        let parts = self.spans.iter().flat_map(|&[low, high]| {
            [[low, high.min(from)], [low.max(to), high]].into_iter().filter(|[a, b]| a < b)
        });
        self.spans = parts.collect();
    }
}

/// Whether a sensor on a round wall counts light that the wall mirrors within, or light that enters through it.
fn counts_within(scene: &Scene, leg: &PlainLeg, patch: &Patch) -> bool {
    let on_wall = leg.frame.origin + leg.radius() * leg.frame.x;
    let outward = Toward::of(leg.frame.x, patch.shape.normal(on_wall));
    scene.sensors.iter().any(|sensor| {
        sensor.entering == Some(patch.face)
            || match &sensor.kind {
                // An aim makes a difference to light on the other side, too.
                SensorKind::Surface(surface) if surface.faces.contains(&patch.face) => {
                    let toward = match surface.counts {
                        CountedLight::Incident => outward,
                        CountedLight::Leaving => outward.opposite(),
                    };
                    !sensor.aim.is_empty() || surface.sides.include(surface.counts, toward)
                }
                SensorKind::Surface(_) | SensorKind::Goniometer(_) => false,
            }
    })
}

/// Whether nothing is on a wall: no sensor, pattern or relief.
fn is_bare(scene: &Scene, patch: &Patch) -> bool {
    let is_watched = scene.sensors.iter().any(|sensor| {
        sensor.entering == Some(patch.face)
            || match &sensor.kind {
                SensorKind::Surface(surface) => surface.faces.contains(&patch.face),
                SensorKind::Goniometer(_) => false,
            }
    });
    patch.trim.is_none() && scene.faces[patch.face.index()].patterns.is_empty() && !is_watched
}

impl Scene {
    /// The plain leg of each patch; none in a scene of very many walls, which would take long to find.
    pub(super) fn plain_legs(&self) -> Vec<Option<Box<PlainLeg>>> {
        if self.patches.len().pow(2) > MOST_PAIRS {
            return Vec::new();
        }
        let all = (0..self.patches.len()).map(PrimId::new);
        all.map(|prim| PlainLeg::of(self, prim).map(Box::new)).collect()
    }

    /// The plain leg within a wall.
    #[inline(always)]
    pub(crate) fn plain_leg(&self, prim: PrimId) -> Option<&PlainLeg> {
        self.legs.get(prim.index())?.as_deref()
    }
}
