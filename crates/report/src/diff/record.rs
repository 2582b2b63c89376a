//! The record of a comparison, from which all its formats are made.

use crate::diff::{DiffRow, Judgement, Limits, MapDiff, MapLimit};

/// Two reports side by side.
#[derive(Debug)]
pub struct Diff {
    /// Names of both.
    pub names: [String; 2],
    /// Facts of both, a line each.
    pub facts: [String; 2],
    /// Limits beyond which two values differ.
    pub limits: Limits,
    /// The measures that both have, the worst first.
    pub rows: Vec<DiffRow>,
    /// Names of measures that only one of them has.
    pub only_in: [Vec<String>; 2],
    /// The maps that both have.
    pub maps: Vec<MapDiff>,
    /// Names of measures that checks of either judge, in order.
    pub checks: Vec<String>,
}

impl Diff {
    /// How many measures have this judgement.
    pub(crate) fn count(&self, wanted: Judgement) -> usize {
        self.rows.iter().filter(|row| row.judgement == wanted).count()
    }

    /// Whether no measure, and no map that counts, differs by more than the limits allow.
    pub fn is_within(&self) -> bool {
        self.count(Judgement::Beyond) == 0 && self.maps_that_count().all(MapDiff::is_noise)
    }

    /// The maps that count.
    pub(crate) fn maps_that_count(&self) -> impl Iterator<Item = &MapDiff> {
        let maps = match self.limits.maps {
            MapLimit::Told => &[][..],
            MapLimit::Noise => &self.maps,
        };
        maps.iter()
    }
}
