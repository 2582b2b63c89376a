//! Where along plain legs records wait for photons: a photon goes there from bounce to bounce, and past the rest in rows.
//!
//! The angle of a photon with the axis of a leg never changes. It meets records only where some take its angle.

use crate::scene::{PlainLeg, RowReach, Scene};
use crate::transport::gather::index::ball;
use crate::transport::gather::records::GatherRecord;
use crate::transport::gather::surfaces::SurfaceNumbers;
use crate::transport::window::Window;
use glam::DVec3;

/// Intervals of the cosine of the angle with the axis, 1: narrower than windows of 0.5 deg.
const ANGLES: usize = 256;

/// Where records are, by wall.
#[derive(Debug)]
pub(super) struct WatchedLegs(Vec<Option<WatchedLeg>>);

/// By the cosine of the angle with the axis: a part of the leg, mm, that contains all windows for light of this angle.
#[derive(Debug)]
struct WatchedLeg(Box<[[f64; 2]; ANGLES]>);

impl WatchedLegs {
    /// The places of some records with a common window.
    pub(super) fn new(
        scene: &Scene,
        surfaces: &SurfaceNumbers,
        records: &[GatherRecord<'_>],
        window: Window,
    ) -> Self {
        let mut legs: Vec<Option<WatchedLeg>> = scene.patches.iter().map(|_| None).collect();
        for record in records.iter().filter(|record| matches!(record, GatherRecord::Surface(_))) {
            let (record, dir) = record.indexed(0);
            // A window lies on all pieces of a smooth surface, and may be met on any wall of a leg.
            for &piece in surfaces.patches(record.surface) {
                let walls = scene.plain_leg(piece).map(PlainLeg::walls).unwrap_or_default();
                for wall in walls {
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

    /// Lets a row of bounces end where its light may meet records.
    #[inline]
    pub(super) fn limit(&self, reach: &mut RowReach) {
        if let Some(Some(WatchedLeg(parts))) = self.0.get(reach.wall.index()) {
            reach.end_before(parts[interval(reach.axial())]);
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
            let axial = dir.dot(leg.axis());
            interval(axial - window.chord())..=interval(axial + window.chord())
        });
        for part in &mut self.0[angles] {
            *part = [part[0].min(at - reach), part[1].max(at + reach)];
        }
    }
}

fn interval(axial: f64) -> usize {
    ((0.5 * (axial + 1.0) * ANGLES as f64) as usize).min(ANGLES - 1)
}
