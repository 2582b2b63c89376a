//! Rows of mirror bounces on plain walls, taken in one step.
//!
//! All bounces on one wall of a row have the same angle of incidence. After n bounces on a wall of reflectance ρ, and a
//! length ℓ in a medium of absorption coefficient α, a throughput w is w exp(-α ℓ) Π ρⁿ, over all walls. If only walls
//! absorb, or only the medium, the whole loss is theirs. If both do, it can be divided for a round wall, whose chords are
//! all of one length and multiply the throughput by the same q = τ ρ: the medium has absorbed w (1 - τ) (1 - qⁿ)/(1 - q), and
//! the wall the rest. Between flat walls, and where walls of several faces absorb, such a row is taken step by step. No
//! random number is drawn, so the path is the same as step by step except for rounding; roulette waits until hardly anything
//! is left, or until the next bounce that starts no row. In polygons the bounces on one wall have several angles: there all
//! must be mirrored alike, as in total reflection.

#[cfg(test)]
mod tests;

use crate::optics::{Faces, FinishModel, Incidence, Lobe, Scattered};
use crate::scene::{
    AnglesOfRow, BounceRow, BouncesOnWall, PlainLeg, PrimHit, Ray, RowReach, Scene, StartSurfaces,
};
use crate::transport::walk::event::{Carries, Event, Jump, Observer, Vertex};
use crate::transport::walk::path::Path;
use crate::transport::walk::scatter::{faces_of, facing};
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
    let Some((row, losses)) = row(scene, path, vertex, (leg, &reach), V::CARRIES) else {
        return stay;
    };
    path.throughput *= losses.kept;
    path.depth += row.count;
    path.ray = row.ray;
    path.on = StartSurfaces::from(Some(row.last));
    observer.see(path, Event::Jump(&losses.jump))?;
    ControlFlow::Continue(path.ray)
}

/// What a row takes from a path.
struct RowLosses {
    /// Share of the throughput that is left, 1.
    kept: f64,
    jump: Jump,
}

/// The row that follows a vertex, if all of it is known.
fn row(
    scene: &Scene,
    path: &Path,
    vertex: &Vertex<'_>,
    (leg, reach): (&PlainLeg, &RowReach),
    carries: Carries,
) -> Option<(BounceRow, RowLosses)> {
    let medium = &scene.media[path.medium.index()];
    let (wall, met) = (reach.wall, facing(scene, path, vertex));
    if medium.scattering().is_some() {
        return None;
    }
    let PrimHit { face, toward, .. } = *vertex.interface.acting;
    let of_wall = mirrored(faces_of(scene, face, toward), &met.incidence, carries)?;
    let (mut reflected, mut is_one_face, mut walls) = (1.0, true, 0);
    let row = leg.row(reach, |bounces| {
        let &BouncesOnWall { wall: prim, count, dir, angles } = bounces;
        let is_at_one_angle = angles == AnglesOfRow::One;
        let share = if prim == wall && is_at_one_angle {
            of_wall
        } else {
            let patch = &scene.patches[prim.index()];
            is_one_face &= patch.face == face;
            // It is flat.
            let normal = patch.shape.normal(vertex.point);
            let normal = if normal.dot(dir) < 0.0 { normal } else { -normal };
            let incidence = Incidence { dir, normal, ..met.incidence };
            let faces = faces_of(scene, patch.face, toward);
            if !is_at_one_angle && !faces.own.mirrors_alike(&incidence) {
                return None;
            }
            mirrored(faces, &incidence, carries)?
        };
        walls += 1;
        reflected *= share.powi(count as i32);
        Some(())
    })?;
    let (before, transmittance) =
        (path.throughput, medium.transmittance(path.wavelength, row.length));
    let kept = transmittance * reflected;
    let absorbed = before * (1.0 - kept);
    let absorbed_in_medium = match (walls, transmittance < 1.0, reflected < 1.0) {
        (_, false, true) if is_one_face => 0.0,
        (_, _, false) => absorbed,
        (1, true, true) => {
            let chord = medium.transmittance(path.wavelength, row.length / f64::from(row.count));
            // 1 - q is not small: the wall absorbs.
            before * (1.0 - chord) * (1.0 - kept) / (1.0 - chord * of_wall)
        }
        _ => return None,
    };
    let absorbed_by_face = absorbed - absorbed_in_medium;
    let jump = Jump { face, medium: path.medium, absorbed_by_face, absorbed_in_medium };
    Some((row, RowLosses { kept, jump }))
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
