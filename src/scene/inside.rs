//! Which solids a path is in, and which medium that makes.

use crate::scene::SolidId;
use smallvec::SmallVec;

/// The set of solids that a point lies in.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Inside(SmallVec<[SolidId; 4]>);

impl Inside {
    /// Whether the point lies in no solid.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Whether the point lies in `solid`.
    #[inline]
    pub fn contains(&self, solid: SolidId) -> bool {
        self.0.contains(&solid)
    }

    /// Adds a solid.
    #[inline]
    pub fn enter(&mut self, solid: SolidId) {
        if !self.contains(solid) {
            self.0.push(solid);
        }
    }

    /// Removes a solid.
    #[inline]
    pub fn leave(&mut self, solid: SolidId) {
        self.0.retain(|inside| *inside != solid);
    }

    /// The solids, in the order in which they were entered.
    #[inline]
    pub fn iter(&self) -> impl Iterator<Item = SolidId> + '_ {
        self.0.iter().copied()
    }
}

impl FromIterator<SolidId> for Inside {
    fn from_iter<I: IntoIterator<Item = SolidId>>(solids: I) -> Self {
        let mut inside = Self::default();
        for solid in solids {
            inside.enter(solid);
        }
        inside
    }
}
