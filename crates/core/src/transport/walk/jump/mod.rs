//! Rows of mirror bounces on plain walls, taken in one step.
//!
//! All bounces on one wall of a round or rectangular section have the same angle of incidence. After n bounces on a wall of
//! reflectance ρ, and a length ℓ in a medium of absorption coefficient α, a throughput w is w exp(-α ℓ) Π ρⁿ, over all walls.
//! If only walls absorb, or only the medium, the whole loss is theirs; of flat walls of several faces, each takes its part in
//! the order of the bounces. If both do, the loss can be divided for a round wall, whose chords are all of one length and
//! multiply the throughput by the same q = τ ρ: the medium has absorbed w (1 - τ) (1 - qⁿ)/(1 - q), and the wall the rest.
//! Between flat walls such a row is taken step by step. In polygons the bounces on one wall have several angles: there all
//! must be mirrored alike, as in total reflection. No random number is drawn, so the path is the same as step by step except
//! for rounding; roulette waits until hardly anything is left, or until the next bounce that starts no row.

#[cfg(test)]
mod tests;

use crate::optics::{Faces, FinishModel, Incidence, Lobe, Scattered};
use crate::scene::{
    AnglesOfRow, BounceRow, FaceId, MetWall, PlainLeg, PrimHit, PrimId, Ray, RowReach, Scene,
    StartSurfaces,
};
use crate::transport::walk::event::{Carries, Event, Jump, Observer, Vertex};
use crate::transport::walk::path::Path;
use crate::transport::walk::scatter::{faces_of, facing};
use smallvec::SmallVec;
use std::ops::ControlFlow;

/// Takes a path that a vertex on a plain leg has just mirrored to the last bounce of the row that follows: the ray from
/// there. It stays where it is if there is no row.
#[inline(never)]
pub(super) fn jump<V: Observer>(
    scene: &Scene,
    path: &mut Path,
    (leg, vertex, out): (&PlainLeg, &Vertex<'_>, &Scattered),
    bounce_limit: u32,
    observer: &mut V,
) -> ControlFlow<(), Ray> {
    let stay = ControlFlow::Continue(path.ray);
    if out.lobe != Lobe::Specular || !vertex.hits.others().is_empty() {
        return stay;
    }
    let most = bounce_limit.saturating_sub(path.depth);
    let Some(mut reach) = leg.reach(&path.ray, (vertex.interface.acting.prim, most)) else {
        return stay;
    };
    observer.limit_row(path, &mut reach);
    if reach.is_too_short() {
        return stay;
    }
    let Some((row, light)) = row(scene, path, vertex, (leg, &reach), V::CARRIES) else {
        return stay;
    };
    path.throughput *= light.kept;
    path.depth += row.count;
    path.ray = row.ray;
    path.on = StartSurfaces::from(Some(row.last));
    let jump = Jump {
        face: vertex.interface.acting.face,
        medium: path.medium,
        absorbed_by_faces: &light.absorbed_by_faces,
        absorbed_in_medium: light.absorbed_in_medium,
        arriving: light.arriving,
        leaving: light.leaving,
    };
    observer.see(path, Event::Jump(&jump))?;
    ControlFlow::Continue(path.ray)
}

/// What becomes of the light of a path on a row.
struct RowLight {
    /// Share of the throughput that is left, 1.
    kept: f64,
    absorbed_by_faces: FaceLosses,
    absorbed_in_medium: f64,
    /// At a round wall, over all bounces.
    arriving: f64,
    leaving: f64,
}

/// Throughput that faces absorb.
type FaceLosses = SmallVec<[(FaceId, f64); 4]>;

/// The row that follows a vertex, if all of it is known.
fn row(
    scene: &Scene,
    path: &Path,
    vertex: &Vertex<'_>,
    (leg, reach): (&PlainLeg, &RowReach),
    carries: Carries,
) -> Option<(BounceRow, RowLight)> {
    let medium = &scene.media[path.medium.index()];
    let (wall, met) = (reach.wall, facing(scene, path, vertex));
    if medium.turbidity().is_some() || medium.fluorescence().is_some() {
        return None;
    }
    let PrimHit { face, toward, .. } = *vertex.interface.acting;
    let of_wall = mirrored(faces_of(scene, face, toward), &met.incidence, carries)?;
    let is_clear = medium.transmittance(path.wavelength, 1.0) == 1.0;
    let face_of = |wall: PrimId| scene.patches[wall.index()].face;
    let share_of = |&MetWall { wall: prim, dir, angles }: &MetWall| {
        if prim == wall && angles == AnglesOfRow::One {
            return Some(of_wall);
        }
        // Only legs of flat walls have others.
        let normal = scene.patches[prim.index()].shape.normal(vertex.point);
        let normal = if normal.dot(dir) < 0.0 { normal } else { -normal };
        let incidence = Incidence { dir, normal, ..met.incidence };
        let faces = faces_of(scene, face_of(prim), toward);
        let share = mirrored(faces, &incidence, carries)?;
        let is_known = match angles {
            AnglesOfRow::One => true,
            AnglesOfRow::ThisAndFlatter => {
                mirrors_alike(faces, &incidence, carries) && (is_clear || share == 1.0)
            }
        };
        is_known.then_some(share)
    };
    let before = path.throughput;
    let mut absorbed_by_faces = FaceLosses::new();
    let row = leg.row(reach, share_of, |wall, absorbed| {
        add_loss(&mut absorbed_by_faces, face_of(wall), before * absorbed);
    })?;
    let transmittance = medium.transmittance(path.wavelength, row.length);
    let kept = transmittance * row.reflected;
    let absorbed = before * (1.0 - kept);
    let (mut arriving, mut leaving) = (0.0, 0.0);
    let absorbed_in_medium = match (row.chord, transmittance < 1.0, row.reflected < 1.0) {
        (_, true, false) => absorbed,
        (None, true, true) => return None,
        (_, false, _) => 0.0,
        (Some(chord), true, true) => {
            let chord = medium.transmittance(path.wavelength, chord);
            // 1 - q is not small: the wall absorbs.
            before * (1.0 - chord) * (1.0 - kept) / (1.0 - chord * of_wall)
        }
    };
    if let Some(chord) = row.chord {
        let chord = medium.transmittance(path.wavelength, chord);
        arriving = before * chord * powers(chord * of_wall, row.count);
        leaving = arriving * of_wall;
        add_loss(&mut absorbed_by_faces, face, absorbed - absorbed_in_medium);
    }
    let light = RowLight { kept, absorbed_by_faces, absorbed_in_medium, arriving, leaving };
    Some((row, light))
}

fn add_loss(losses: &mut FaceLosses, face: FaceId, absorbed: f64) {
    match losses.iter_mut().find(|(own, _)| *own == face) {
        Some((_, sum)) => *sum += absorbed,
        None => losses.push((face, absorbed)),
    }
}

/// The sum of the first powers of a number, from the power 0.
fn powers(q: f64, count: u32) -> f64 {
    if q == 1.0 { f64::from(count) } else { (1.0 - q.powi(count as i32)) / (1.0 - q) }
}

/// The share of arriving light that a wall mirrors, if it only mirrors and no light comes through from behind.
fn mirrored(faces: Faces<'_>, incidence: &Incidence, carries: Carries) -> Option<f64> {
    let is_mirror = faces.own.only_mirrors(incidence)
        && match carries {
            Carries::Flux => true,
            Carries::Radiance => faces.behind.radiance_chances(incidence).transmitted == 0.0,
        };
    is_mirror.then(|| faces.own.shares(incidence).reflected)
}

/// Whether it mirrors light at this and at all flatter angles in the same proportion, seen by gather paths from behind, too,
/// so that no light comes through.
fn mirrors_alike(faces: Faces<'_>, incidence: &Incidence, carries: Carries) -> bool {
    faces.own.mirrors_alike(incidence)
        && match carries {
            Carries::Flux => true,
            Carries::Radiance => faces.behind.mirrors_alike(incidence),
        }
}
