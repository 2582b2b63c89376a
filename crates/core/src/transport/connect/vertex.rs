//! Vertices of a path that scatter light into a density of directions, and those at its two ends.

use crate::optics::{FinishModel, Incidence, Lobe, Medium, Side, Spread, VolumeScattering};
use crate::rng::{Dimension, Sampler};
use crate::scene::{Scene, Visibility};
use crate::transport::walk::scatter::{MetInterface, facing};
use crate::transport::window::Window;
use crate::transport::{Collision, Path, Vertex};
use glam::DVec3;
use std::f64::consts::PI;

/// Density relative to that of a diffuser below which joins are left out at random, 1.
const WORTHWHILE: f64 = 0.01;

/// Whether any medium or finish of a scene, on a face or not, scatters light into a density of directions.
pub(crate) fn scatters(scene: &Scene) -> bool {
    scene.finishes.iter().any(|named| named.finish.spread() != Spread::Discrete)
        || turbid_media(scene).next().is_some()
}

/// The names of the media of a scene that scatter light.
pub fn turbid_media(scene: &Scene) -> impl Iterator<Item = &str> {
    scene.media.iter().filter(|medium| medium.turbidity().is_some()).map(Medium::name)
}

/// A vertex that scatters.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ScatteringVertex<'s> {
    /// Position, mm.
    pub(crate) point: DVec3,
    place: VertexPlace<'s>,
}

#[derive(Debug, Clone, Copy)]
enum VertexPlace<'s> {
    Face(MetInterface<'s>),
    Medium { scattering: VolumeScattering, index: f64 },
}

/// Light that a vertex scatters from one direction into another.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ScatteredLight {
    /// Share of the arriving flux that leaves per solid angle, 1/sr.
    pub(crate) density: f64,
    /// Basic radiance that leaves, per solid angle of arriving basic radiance, 1/sr.
    pub(crate) adjoint: f64,
    /// Share of the arriving flux that leaves in any direction, 1: roughly, for weights.
    pub(crate) albedo: f64,
    /// Refractive index of the medium that the light comes from.
    pub(crate) index_from: f64,
    /// Etendue of leaving light per solid angle and area of the face, n² |cos θ|, 1; in a medium, per
    /// solid angle and volume, n² σ, 1/mm.
    projected: f64,
}

impl ScatteredLight {
    /// The probability with which a join is worth its way, if this one is: where a narrow lobe
    /// sends next to nothing, most are left out.
    pub(crate) fn kept(&self, sampler: &mut Sampler) -> Option<f64> {
        let chance = PI * self.density / (WORTHWHILE * self.albedo);
        if chance >= 1.0 {
            return Some(1.0);
        }
        (sampler.one(Dimension::Roulette) < chance).then_some(chance)
    }
}

impl<'s> ScatteringVertex<'s> {
    /// The vertex of a path at a face; `None` where only discrete directions leave.
    pub(crate) fn at_face(scene: &'s Scene, path: &Path, vertex: &Vertex<'_>) -> Option<Self> {
        let finishes = [vertex.interface.finish, scene.finish_behind(vertex.interface)];
        let scatters = finishes
            .into_iter()
            .flatten()
            .any(|finish| scene.finishes[finish.index()].finish.spread() != Spread::Discrete);
        let is_visible = vertex.interface.visibility == Visibility::Visible;
        (is_visible && scatters).then(|| Self::facing(scene, path, vertex))
    }

    /// The vertex of a path at a visible face, even if only discrete directions leave.
    pub(crate) fn facing(scene: &'s Scene, path: &Path, vertex: &Vertex<'_>) -> Self {
        Self::at(vertex.point, facing(scene, path, vertex))
    }

    /// A face that was met at a point, mm.
    pub(crate) fn at(point: DVec3, met: MetInterface<'s>) -> Self {
        Self { point, place: VertexPlace::Face(met) }
    }

    /// The interface, unless it lies within a medium.
    pub(crate) fn face(&self) -> Option<&MetInterface<'s>> {
        match &self.place {
            VertexPlace::Face(met) => Some(met),
            VertexPlace::Medium { .. } => None,
        }
    }

    /// Whether gather paths leave a record here for light that arrives along this direction and is scattered: in a medium,
    /// or by a finish that scatters broadly.
    pub(crate) fn is_broad(&self, arriving: DVec3) -> bool {
        self.face().is_none_or(|met| met.acting_on(arriving).0.spread() == Spread::Broad)
    }

    /// Etendue of the window of a record for scattered light over the density of its direction, G/q,
    /// mm² sr: docs/method.md, eq. (30).
    pub(crate) fn window(&self, [arriving, leaving]: [DVec3; 2], window: Window) -> Option<f64> {
        let light = self.scattered(arriving, leaving)?;
        let extent = match &self.place {
            VertexPlace::Face(_) => window.area(),
            VertexPlace::Medium { .. } => window.volume(),
        };
        Some(light.projected * extent * light.albedo / light.density)
    }

    /// The vertex of a path within a medium.
    pub(crate) fn in_medium(scene: &Scene, path: &Path, collision: &Collision<'_>) -> Self {
        let index = scene.media[collision.medium.index()].index(path.wavelength);
        let scattering = *collision.scattering;
        Self { point: collision.point, place: VertexPlace::Medium { scattering, index } }
    }

    /// What becomes of light that arrives and leaves along these unit directions of travel; `None`
    /// where the vertex does not scatter it so.
    pub(crate) fn scattered(&self, arriving: DVec3, leaving: DVec3) -> Option<ScatteredLight> {
        let light = match &self.place {
            VertexPlace::Face(met) => at_face(met, arriving, leaving)?,
            VertexPlace::Medium { scattering, index } => {
                let density = scattering.phase(arriving.dot(leaving));
                let projected = index * index * scattering.coefficient();
                ScatteredLight {
                    density,
                    adjoint: density,
                    albedo: 1.0,
                    index_from: *index,
                    projected,
                }
            }
        };
        (light.density > 0.0 && light.adjoint.is_finite()).then_some(light)
    }

    /// The side of its face, as the path met it, to which a direction points.
    pub(crate) fn side(&self, dir: DVec3) -> Side {
        match &self.place {
            VertexPlace::Face(met) if dir.dot(met.facet) <= 0.0 => Side::Transmitted,
            VertexPlace::Face(_) | VertexPlace::Medium { .. } => Side::Reflected,
        }
    }
}

fn at_face(met: &MetInterface<'_>, arriving: DVec3, leaving: DVec3) -> Option<ScatteredLight> {
    let (finish, incidence) = met.acting_on(arriving);
    let Incidence { normal, index_from, index_to, .. } = incidence;
    let facet = if arriving.dot(met.facet) < 0.0 { met.facet } else { -met.facet };
    if arriving.dot(normal) >= 0.0 {
        return None;
    }
    let side = if leaving.dot(facet) > 0.0 { Side::Reflected } else { Side::Transmitted };
    let toward = |out: DVec3| {
        let is_there = incidence.side_of(out) == side;
        if is_there { finish.evaluate(&incidence, out) * out.dot(normal).abs() } else { 0.0 }
    };
    let mut density = toward(leaving);
    if normal != facet {
        // Light that an interpolated normal sends into the facet is mirrored about the facet.
        density += toward(leaving - 2.0 * leaving.dot(facet) * facet);
    }
    let index = match side {
        Side::Reflected => index_from,
        Side::Transmitted => index_to,
    };
    let projected = index * index * leaving.dot(facet).abs();
    let arrived = index_from * index_from * arriving.dot(facet).abs();
    Some(ScatteredLight {
        density,
        adjoint: density * arrived / projected,
        albedo: finish.albedo_about(&incidence),
        index_from,
        projected,
    })
}

/// A change of direction of a path.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DirectionChange<'s> {
    /// Where; `None` at a vertex of discrete directions.
    pub(crate) vertex: Option<ScatteringVertex<'s>>,
    /// Unit direction in which the path travelled before it.
    pub(crate) before: DVec3,
}

/// The turns of a path so far: the first, the last, and that at the vertex it has just met.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Turns<'s> {
    first: Option<DirectionChange<'s>>,
    /// Unit direction of the path after its first turn, once it has met another vertex.
    after_first: Option<DVec3>,
    last: Option<DirectionChange<'s>>,
    met: Option<DirectionChange<'s>>,
}

impl<'s> Turns<'s> {
    /// The path meets a vertex as it travels along `dir`.
    pub(crate) fn meet(&mut self, vertex: Option<ScatteringVertex<'s>>, dir: DVec3) {
        if self.first.is_some() {
            self.after_first.get_or_insert(dir);
        }
        self.met = Some(DirectionChange { vertex, before: dir });
    }

    /// The path has left the vertex that it met.
    pub(crate) fn depart(&mut self, lobe: Lobe) {
        let Some(mut met) = self.met.take() else { return };
        if lobe == Lobe::Specular {
            met.vertex = None;
        }
        self.first.get_or_insert(met);
        self.last = Some(met);
    }

    /// Whether it has turned at all.
    pub(crate) fn is_begun(&self) -> bool {
        self.first.is_some()
    }

    /// The first vertex, if it scatters, with the directions of travel before and after it; the
    /// path now travels along `dir`.
    pub(crate) fn first(&self, dir: DVec3) -> Option<TurnAt<'s>> {
        self.first?.at(self.after_first.unwrap_or(dir))
    }

    /// The last vertex, in the same way.
    pub(crate) fn last(&self, dir: DVec3) -> Option<TurnAt<'s>> {
        self.last?.at(dir)
    }

    /// The first vertex of a path that turns into `dir` at the vertex it has met.
    pub(crate) fn first_if_joined(&self, dir: DVec3) -> Option<TurnAt<'s>> {
        if self.first.is_some() { self.first(dir) } else { self.met?.at(dir) }
    }
}

/// A vertex that scatters, with the unit directions of travel before and after it.
pub(crate) type TurnAt<'s> = (ScatteringVertex<'s>, [DVec3; 2]);

impl<'s> DirectionChange<'s> {
    fn at(self, after: DVec3) -> Option<TurnAt<'s>> {
        Some((self.vertex?, [self.before, after]))
    }
}
