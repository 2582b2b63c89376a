//! A distribution function f(i→o) that is constant over pairs of patches.
//!
//! Directions are those of travel, by their direction cosines along the face: light that goes straight on, or is mirrored, keeps
//! them. A photon leaves into a patch of projected solid angle `Ω_o` with the share `f Ω_o`, a gather path
//! collects from a patch `f Ω_i` times its basic radiance; both are drawn exactly.

use crate::optics::bsdf::cumulative::CumulativeRows;
use glam::DVec2;
use lumiduct_base::math::{DirectionPatches, PatchPairs, circle, turns};

/// A distribution function from patches to patches.
#[derive(Debug, Clone, PartialEq)]
pub struct BsdfTable {
    pairs: PatchPairs,
    /// For each patch of arriving light, the share of its flux that leaves into each patch.
    leaving: CumulativeRows,
    /// For each patch of leaving light the weight of each patch of arriving light. Without grain: for each ring, by ring and
    /// sector.
    arriving: CumulativeRows,
}

/// Where a direction is in a table: finding it takes longer than the value of two places.
pub(crate) struct PatchPlace {
    /// The patch; without grain the ring.
    patch: usize,
    /// The azimuth, in turns from 0 to 1; 0 with grain.
    turns: f64,
}

impl BsdfTable {
    /// From values, 1/sr: for each patch of arriving light one for each patch of leaving light. `None` if their number is
    /// wrong, or one is negative or not finite.
    pub fn new(pairs: PatchPairs, values: &[f64]) -> Option<Self> {
        let [incident, leaving] = pairs.counts();
        let are_usable = values.iter().all(|value| value.is_finite() && *value >= 0.0);
        if values.len() != incident * leaving || !are_usable {
            return None;
        }
        let value = |from: usize, to: usize| values[from * leaving + to];
        let solid: Vec<f64> = (0..leaving).map(|to| pairs.leaving_projected(to)).collect();
        let row = |from: usize| (0..leaving).map(|to| value(from, to) * solid[to]).collect();
        let leaving_rows = match &pairs {
            PatchPairs::Fixed { leaving, .. } => fixed_rows(leaving, (0..incident).map(row)),
            PatchPairs::Isotropic { .. } => CumulativeRows::new((0..incident).map(row)),
        };
        let solid: Vec<f64> = (0..incident).map(|from| pairs.incident_projected(from)).collect();
        let arriving_rows = match &pairs {
            PatchPairs::Fixed { incident: patches, .. } => {
                let row =
                    |to: usize| (0..incident).map(|from| value(from, to) * solid[from]).collect();
                fixed_rows(patches, (0..leaving).map(row))
            }
            PatchPairs::Isotropic { leaving, .. } => {
                CumulativeRows::new((0..leaving.rings()).map(|ring| {
                    let count = leaving.sectors(ring);
                    let column = |at: usize| {
                        let (from, sector) = (at / count, at % count);
                        value(from, leaving.first(ring) + sector) * solid[from] / count as f64
                    };
                    (0..incident * count).map(column).collect()
                }))
            }
        };
        Some(Self { pairs, leaving: leaving_rows, arriving: arriving_rows })
    }

    /// Numbers that are stored for both directions of paths.
    #[cfg(test)]
    pub(crate) fn stored_weights(&self) -> usize {
        self.leaving.runs() + self.arriving.runs()
    }

    /// Whether it has axes of its own on the face.
    pub fn has_grain(&self) -> bool {
        match self.pairs {
            PatchPairs::Fixed { .. } => true,
            PatchPairs::Isotropic { .. } => false,
        }
    }

    /// The middle of each patch of arriving light, and of each patch of leaving light.
    pub fn directions(&self) -> [Vec<DVec2>; 2] {
        let middles = |patches: &DirectionPatches| {
            (0..patches.count()).map(|patch| patches.direction(patch, [0.5; 2])).collect()
        };
        match &self.pairs {
            PatchPairs::Fixed { incident, leaving } => [incident, leaving].map(middles),
            PatchPairs::Isotropic { incident, leaving } => {
                let rings = 0..incident.rings();
                let ahead = rings.map(|ring| DVec2::new(incident.radius(ring, 0.5), 0.0));
                [ahead.collect(), middles(&DirectionPatches::Rings(leaving.clone()))]
            }
        }
    }

    /// The patches of arriving and of leaving light. Without grain the rings alone count.
    pub fn divisions(&self) -> [DirectionPatches; 2] {
        match &self.pairs {
            PatchPairs::Fixed { incident, leaving } => [incident.clone(), leaving.clone()],
            PatchPairs::Isotropic { incident, leaving } => {
                [incident, leaving].map(|rings| DirectionPatches::Rings(rings.clone()))
            }
        }
    }

    /// All values times a factor.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let [leaving, arriving] = [&self.leaving, &self.arriving].map(|rows| rows.scaled(factor));
        Self { pairs: self.pairs.clone(), leaving, arriving }
    }

    /// Share of light from a direction that leaves in any direction, 1.
    pub(crate) fn share(&self, from: DVec2) -> f64 {
        self.leaving.total(self.pairs.incident(from))
    }

    /// The distribution function, 1/sr.
    pub(crate) fn value(&self, from: DVec2, to: DVec2) -> f64 {
        self.value_at(&self.incident_place(from), &self.leaving_place(to))
    }

    /// The distribution function between places, 1/sr.
    pub(crate) fn value_at(&self, from: &PatchPlace, to: &PatchPlace) -> f64 {
        let column = match &self.pairs {
            PatchPairs::Fixed { .. } => to.patch,
            PatchPairs::Isotropic { leaving, .. } => {
                let turn = (to.turns - from.turns).rem_euclid(1.0);
                leaving.first(to.patch) + leaving.sector(to.patch, turn)
            }
        };
        self.leaving.weight(from.patch, column) / self.pairs.leaving_projected(column)
    }

    /// The place of a direction of arriving light.
    pub(crate) fn incident_place(&self, from: DVec2) -> PatchPlace {
        PatchPlace { patch: self.pairs.incident(from), turns: self.turns_of(from) }
    }

    /// The place of a direction of leaving light.
    pub(crate) fn leaving_place(&self, to: DVec2) -> PatchPlace {
        PatchPlace { patch: self.arriving_row(to), turns: self.turns_of(to) }
    }

    fn turns_of(&self, cosines: DVec2) -> f64 {
        if self.has_grain() { 0.0 } else { turns(cosines) }
    }

    /// A direction in which light leaves; its density is `f cos θ_o` over the share.
    pub(crate) fn leave(&self, from: DVec2, u: [f64; 2]) -> DVec2 {
        let (patch, rest) = self.leaving.sample(self.pairs.incident(from), u[0]);
        let u = [rest, u[1]];
        match &self.pairs {
            PatchPairs::Fixed { leaving, .. } => leaving.direction(patch, u),
            PatchPairs::Isotropic { leaving, .. } => {
                let [ring, sector] = leaving.ring_and_sector(patch);
                let turn = turns(from) + leaving.turns(ring, sector, u[1]);
                leaving.radius(ring, u[0]) * circle(turn.rem_euclid(1.0))
            }
        }
    }

    /// `∫ f cos θ_i dω_i` over all light that leaves in a direction, 1.
    pub(crate) fn collected_share(&self, to: DVec2) -> f64 {
        self.arriving.total(self.arriving_row(to))
    }

    /// A direction from which light comes that leaves in a direction; its density is `f cos θ_i` over
    /// [`BsdfTable::collected_share`].
    pub(crate) fn arrive(&self, to: DVec2, u: [f64; 2]) -> DVec2 {
        let row = self.arriving_row(to);
        let (column, rest) = self.arriving.sample(row, u[0]);
        match &self.pairs {
            PatchPairs::Fixed { incident, .. } => incident.direction(column, [rest, u[1]]),
            PatchPairs::Isotropic { incident, leaving } => {
                let count = leaving.sectors(row);
                let turn = turns(to) - leaving.turns(row, column % count, u[1]);
                incident.radius(column / count, rest) * circle(turn.rem_euclid(1.0))
            }
        }
    }

    fn arriving_row(&self, to: DVec2) -> usize {
        match &self.pairs {
            PatchPairs::Fixed { leaving, .. } => leaving.patch(to),
            PatchPairs::Isotropic { leaving, .. } => leaving.ring(to.length_squared()),
        }
    }
}

/// Rows over patches in axes of the face. Squares are often parts of a coarser tree; rings stay as they are, so that their sums
/// round in one way.
fn fixed_rows(columns: &DirectionPatches, rows: impl Iterator<Item = Vec<f64>>) -> CumulativeRows {
    match columns {
        DirectionPatches::Squares { .. } => CumulativeRows::merged(rows),
        DirectionPatches::Rings(_) => CumulativeRows::new(rows),
    }
}
