//! The effect of the acting finish on a path at an interface, for photons and for gather paths.
//!
//! It combines the finish, the normal and the indices; the physics is in `optics`.

use crate::optics::{
    FaceMueller, Faces, Finish, FinishModel, Incidence, Lobe, Scattered, Side, Stokes,
    scatter_at_faces,
};
use crate::rng::{Numbers, Sampler};
use crate::scene::shape::Toward;
use crate::scene::{FaceId, FinishId, Interface, MediumId, Patch, Scene, Surface};
use crate::transport::{Path, Vertex};
use glam::DVec3;
use lumiduct_base::math::unit;

/// The smooth interface of two media, where no finish is declared.
static SMOOTH: Finish = Finish::Smooth;

/// Applies the acting finish.
#[inline(always)]
pub(super) fn scatter_photon(
    scene: &Scene,
    path: &mut Path,
    interface: &Interface<'_>,
    point: DVec3,
    dir: DVec3,
    sampler: &mut Sampler<impl Numbers>,
) -> Option<Scattered> {
    let toward = interface.acting.toward;
    let wavelength = path.wavelength;
    let index = |medium: MediumId| scene.media[medium.index()].index(wavelength);
    let (index_from, index_to) = (index(interface.from), index(interface.to));
    let finish = finish_of(scene, interface.finish);
    match scene.surface(interface.acting.prim) {
        Surface::Patch(patch) => {
            let normal = patch.shape.normal_against(toward, point);
            let (grain, s_share) = (grain(finish, patch, point), Incidence::UNPOLARISED);
            let incidence =
                Incidence { dir, normal, index_from, index_to, wavelength, grain, s_share };
            send(finish, &incidence, &mut path.stokes, sampler)
        }
        Surface::Triangle(body, triangle) => {
            let facing = |outward: DVec3| match toward {
                Toward::Front => -outward,
                Toward::Back => outward,
            };
            let facet = facing(body.facet_normal(triangle));
            let shading = facing(body.shading_normal(triangle, point));
            // An interpolated normal may face away from grazing light; then the facet's normal is
            // used.
            let normal = if shading.dot(dir) < 0.0 { shading } else { facet };
            let (grain, s_share) = (DVec3::ZERO, Incidence::UNPOLARISED);
            let incidence =
                Incidence { dir, normal, index_from, index_to, wavelength, grain, s_share };
            let out = send(finish, &incidence, &mut path.stokes, sampler)?;
            Some(kept_on_its_side(out, facet))
        }
    }
}

/// Sends a photon on, with its polarisation if that is followed.
#[inline(always)]
fn send(
    finish: &Finish,
    incidence: &Incidence,
    stokes: &mut Option<Stokes>,
    sampler: &mut Sampler<impl Numbers>,
) -> Option<Scattered> {
    match stokes {
        None => finish.scatter(incidence, sampler),
        Some(stokes) => send_polarised(finish, incidence, stokes, sampler),
    }
}

#[inline(never)]
fn send_polarised(
    finish: &Finish,
    incidence: &Incidence,
    stokes: &mut Stokes,
    sampler: &mut Sampler<impl Numbers>,
) -> Option<Scattered> {
    let s_share = stokes.s_share(incidence.dir, incidence.normal);
    let incidence = Incidence { s_share, ..*incidence };
    let out = finish.scatter(&incidence, sampler)?;
    *stokes = stokes.after(action(finish, &incidence, &out), &incidence, &out);
    Some(out)
}

/// The action of a finish on polarised light that it sent on; `None` if that is depolarised, as all scattered light is.
fn action(finish: &Finish, light: &Incidence, out: &Scattered) -> Option<FaceMueller> {
    match out.lobe {
        Lobe::Specular => finish.mueller(light, out.side),
        Lobe::Diffuse => None,
    }
}

/// The grain direction of a finish on a patch. Meshes have none; finishes with a grain are refused
/// there.
#[inline(always)]
fn grain(finish: &Finish, patch: &Patch, point: DVec3) -> DVec3 {
    if finish.has_grain() { patch.along(point) } else { DVec3::ZERO }
}

#[inline]
fn finish_of(scene: &Scene, finish: Option<FinishId>) -> &Finish {
    finish.map_or(&SMOOTH, |finish| &scene.finishes[finish.index()].finish)
}

/// The finishes of a face beside its patterns, for light travelling toward one of its sides.
pub(super) fn faces_of(scene: &Scene, face: FaceId, toward: Toward) -> Faces<'_> {
    let face = &scene.faces[face.index()];
    Faces {
        own: finish_of(scene, face.finish_against(toward)),
        behind: finish_of(scene, face.finish_against(toward.opposite())),
    }
}

/// An interface as a path meets it.
#[derive(Debug, Clone, Copy)]
pub struct MetInterface<'s> {
    /// The finishes that act on light from either side.
    pub faces: Faces<'s>,
    /// Incidence of the path about the acting normal.
    pub incidence: Incidence,
    /// The normal of the surface itself, on the side the path comes from: a facet's, for a mesh.
    pub facet: DVec3,
    /// The interpolated normal of a mesh on that side, which acts on light that comes from above it; otherwise the same.
    pub shading: DVec3,
}

/// An interface as a gather path meets it at a vertex.
pub fn facing<'s>(scene: &'s Scene, path: &Path, vertex: &Vertex<'_>) -> MetInterface<'s> {
    let interface = vertex.interface;
    let toward = interface.acting.toward;
    let faces = Faces {
        own: finish_of(scene, interface.finish),
        behind: finish_of(scene, scene.finish_behind(interface)),
    };
    let (shading, facet, grain) = match scene.surface(interface.acting.prim) {
        Surface::Patch(patch) => {
            let normal = patch.shape.normal_against(toward, vertex.point);
            // The finish behind acts on light that comes through.
            let either = if faces.own.has_grain() { faces.own } else { faces.behind };
            (normal, normal, grain(either, patch, vertex.point))
        }
        Surface::Triangle(body, triangle) => {
            let sign = match toward {
                Toward::Front => -1.0,
                Toward::Back => 1.0,
            };
            let facet = sign * body.facet_normal(triangle);
            (sign * body.shading_normal(triangle, vertex.point), facet, DVec3::ZERO)
        }
    };
    let index = |medium: MediumId| scene.media[medium.index()].index(path.wavelength);
    let normal = acting_normal(vertex.dir, shading, facet);
    let s_share = match &path.stokes {
        None => Incidence::UNPOLARISED,
        Some(stokes) => stokes.s_share(vertex.dir, normal),
    };
    MetInterface {
        faces,
        incidence: Incidence {
            dir: vertex.dir,
            normal,
            index_from: index(interface.from),
            index_to: index(interface.to),
            wavelength: path.wavelength,
            grain,
            s_share,
        },
        facet,
        shading,
    }
}

/// The normal that acts on light: an interpolated one may face away from grazing light.
fn acting_normal(dir: DVec3, shading: DVec3, facet: DVec3) -> DVec3 {
    if shading.dot(dir) < 0.0 { shading } else { facet }
}

/// Sends a gather path on, with its polarisation if that is followed, or absorbs it.
#[inline(always)]
pub(super) fn send_gather_path(
    scene: &Scene,
    path: &mut Path,
    vertex: &Vertex<'_>,
    sampler: &mut Sampler<impl Numbers>,
) -> Option<Scattered> {
    let met = facing(scene, path, vertex);
    let out = scatter_at_faces(met.faces, &met.incidence, sampler)?;
    if let Some(stokes) = &mut path.stokes {
        *stokes = met.leaving(stokes, &out);
    }
    Some(met.corrected(out))
}

/// Where a gather path whose polarisation is ignored goes on, if it is not absorbed.
pub fn scatter_gather_path(
    scene: &Scene,
    path: &Path,
    vertex: &Vertex<'_>,
    sampler: &mut Sampler<impl Numbers>,
) -> Option<Scattered> {
    let met = facing(scene, path, vertex);
    let out = scatter_at_faces(met.faces, &met.incidence, sampler)?;
    Some(met.corrected(out))
}

impl<'s> MetInterface<'s> {
    /// The finish that acts on light of this unit direction, from whichever side, and its incidence.
    pub(crate) fn acting_on(&self, dir: DVec3) -> (&'s Finish, Incidence) {
        let Incidence { index_from, index_to, .. } = self.incidence;
        if dir.dot(self.facet) < 0.0 {
            let normal = acting_normal(dir, self.shading, self.facet);
            return (self.faces.own, Incidence { dir, normal, ..self.incidence });
        }
        let normal = acting_normal(dir, -self.shading, -self.facet);
        let (index_from, index_to) = (index_to, index_from);
        (self.faces.behind, Incidence { dir, normal, index_from, index_to, ..self.incidence })
    }

    /// The polarisation of a gather path that is sent on. The face acts on the light that comes the other way, and by reciprocity
    /// alike on the path.
    fn leaving(&self, stokes: &Stokes, out: &Scattered) -> Stokes {
        let (finish, light) = self.acting_on(-unit(out.dir));
        stokes.after(action(finish, &light, out), &self.incidence, out)
    }

    /// Effect of an interpolated normal on basic radiance. Flux through the facet is conserved and
    /// solid angles turn about the acting normal n, so that `L* |cos_f| dω n²` is, with `cos_f` to
    /// the facet: the factor is `|cos_f(i)/cos_n(i)| |cos_n(o)/cos_f(o)|`, i where the path
    /// continues, o where it came from (Veach, thesis 1997, 5.3).
    pub fn corrected(&self, out: Scattered) -> Scattered {
        let Incidence { dir, normal, .. } = self.incidence;
        if normal == self.facet {
            return out;
        }
        let before = out.dir.normalize();
        let kept = kept_on_its_side(Scattered { dir: before, ..out }, self.facet);
        let cos = |dir: DVec3, normal: DVec3| dir.dot(normal).abs();
        let factor = cos(kept.dir, self.facet) / cos(before, normal) * cos(dir, normal)
            / cos(dir, self.facet);
        // Light along the facet itself carries no radiance.
        let factor = if factor.is_finite() { factor } else { 0.0 };
        Scattered { factor: out.factor * factor, ..kept }
    }
}

/// With an interpolated normal light may go into the facet instead of leaving it: it is then
/// mirrored once more about the facet.
fn kept_on_its_side(out: Scattered, facet: DVec3) -> Scattered {
    let along = out.dir.dot(facet);
    let wrong = match out.side {
        Side::Reflected => along < 0.0,
        Side::Transmitted => along > 0.0,
    };
    if wrong { Scattered { dir: out.dir - 2.0 * along * facet, ..out } } else { out }
}
