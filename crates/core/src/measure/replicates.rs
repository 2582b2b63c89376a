//! Values of a measure in single groups of batches, so that runs with the same random numbers can
//! be compared.
//!
//! Two designs that are traced with the same random numbers err in the same direction. Group by
//! group their measures vary together, so the difference is known better than either value. A
//! group's part of a measure, which may be a ratio, is its jackknife pseudo-value g θ - (g - 1) θ₋ₖ
//! (Tukey, Ann. Math. Stat. 29 (1958) 614), where θ₋ₖ is the measure without that group.

use serde::{Deserialize, Serialize};

/// Values of a measure in each group of batches, in the unit of the measure: pseudo-values, by
/// group, ascending.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Replicates(pub Vec<(u64, f64)>);

impl Replicates {
    /// Pseudo-values from a value and its values without each group.
    pub(crate) fn new(value: f64, without: &[(u64, f64)]) -> Self {
        let groups = without.len() as f64;
        let pseudo = |&(group, rest): &(u64, f64)| (group, groups * value - (groups - 1.0) * rest);
        Self(without.iter().map(pseudo).collect())
    }

    /// Whether the other values are of the same groups, so that they can be paired.
    pub fn is_paired_with(&self, other: &Self) -> bool {
        self.0.len() > 1
            && self.0.len() == other.0.len()
            && self.0.iter().zip(&other.0).all(|(own, other)| own.0 == other.0)
    }
}
