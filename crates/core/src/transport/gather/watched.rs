//! The parts of plain legs where records wait for photons. A photon goes through them bounce by bounce, and skips the rest.
//!
//! The angle between a photon and the axis of a leg never changes, so it can meet only records that take this angle.

use crate::scene::{PlainLeg, PrimId, RowReach, Scene};
use crate::transport::gather::index::ball;
use crate::transport::gather::records::GatherRecord;
use crate::transport::gather::surfaces::SurfaceNumbers;
use crate::transport::window::Window;
use glam::DVec3;
use smallvec::SmallVec;
use std::f64::consts::PI;

/// Intervals of the angle to the axis, each of 0.7 deg, about the width of usual windows.
const ANGLES: usize = 256;

/// The watched parts of all legs, by wall.
#[derive(Debug)]
pub(super) struct WatchedLegs(Vec<Option<WatchedLeg>>);

/// By the angle to the axis: a part of the leg, mm, that contains all windows for light of this angle.
#[derive(Debug)]
struct WatchedLeg(Box<[[f64; 2]; ANGLES]>);

impl WatchedLegs {
    /// The parts that records with a common window watch.
    pub(super) fn new(
        scene: &Scene,
        surfaces: &SurfaceNumbers,
        records: &[GatherRecord<'_>],
        window: Window,
    ) -> Self {
        let mut legs: Vec<Option<WatchedLeg>> = scene.patches.iter().map(|_| None).collect();
        let crossed = legs_by_piece(scene);
        for record in records.iter().filter(|record| matches!(record, GatherRecord::Surface(_))) {
            let (record, dir) = record.indexed(0);
            // A window may reach any piece of its smooth surface.
            for &piece in surfaces.patches(record.surface) {
                for &wall in &crossed[piece.index()] {
                    let Some(leg) = scene.plain_leg(wall) else { continue };
                    let watched = &mut legs[wall.index()];
                    watched.get_or_insert_with(WatchedLeg::nowhere).add(
                        leg,
                        record.point,
                        dir,
                        window,
                    );
                }
            }
        }
        Self(legs)
    }

    /// Shortens a row so that it ends before its light can meet records.
    #[inline]
    pub(super) fn limit(&self, reach: &mut RowReach) {
        if let Some(Some(WatchedLeg(parts))) = self.0.get(reach.wall.index()) {
            reach.end_before(parts[interval(angle(reach.axial()))]);
        }
    }
}

impl WatchedLeg {
    fn nowhere() -> Self {
        Self(Box::new([[f64::INFINITY, f64::NEG_INFINITY]; ANGLES]))
    }

    fn add(&mut self, leg: &PlainLeg, point: DVec3, dir: Option<DVec3>, window: Window) {
        let (at, reach) = (leg.along(point), ball(window));
        let angles = dir.map_or(0..=ANGLES - 1, |dir| {
            let angle = angle(dir.dot(leg.axis()));
            interval(angle - window.theta_max)..=interval(angle + window.theta_max)
        });
        for part in &mut self.0[angles] {
            *part = [part[0].min(at - reach), part[1].max(at + reach)];
        }
    }
}

/// The legs, by one of their walls, that each piece is a wall of. A row is asked for by the wall that it starts from, and
/// walls of a box belong to legs along different edges.
fn legs_by_piece(scene: &Scene) -> Vec<SmallVec<[PrimId; 4]>> {
    let mut legs = vec![SmallVec::new(); scene.patches.len()];
    for wall in (0..scene.patches.len()).map(PrimId::new) {
        for piece in scene.plain_leg(wall).map(PlainLeg::walls).unwrap_or_default() {
            legs[piece.index()].push(wall);
        }
    }
    legs
}

/// An angle by its cosine, rad.
fn angle(cos: f64) -> f64 {
    cos.clamp(-1.0, 1.0).acos()
}

/// The interval of an angle; the first and the last also contain those beyond them.
fn interval(angle: f64) -> usize {
    ((angle / PI * ANGLES as f64) as usize).min(ANGLES - 1)
}
