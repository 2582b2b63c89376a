//! The solids that a path is in.

use crate::scene::SolidId;
use crate::scene::shape::Toward;
use smallvec::SmallVec;

/// The set of solids that a point lies in: a bit for each of the first 64, a list for the others.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Inside {
    first: u64,
    others: SmallVec<[SolidId; 2]>,
}

/// The bit of a solid; `None` for one that is listed.
#[inline]
fn bit(solid: SolidId) -> Option<u64> {
    1u64.checked_shl(solid.index() as u32)
}

impl Inside {
    /// Whether the point lies in no solid.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.first == 0 && self.others.is_empty()
    }

    /// Whether the point lies in `solid`.
    #[inline]
    pub fn contains(&self, solid: SolidId) -> bool {
        match bit(solid) {
            Some(bit) => self.first & bit != 0,
            None => self.others.contains(&solid),
        }
    }

    /// How a path may cross the surface of `solid` next: within it only out of it.
    #[inline]
    pub(crate) fn toward(&self, solid: SolidId) -> Toward {
        if self.contains(solid) { Toward::Front } else { Toward::Back }
    }

    /// Whether the point lies in no solid, except perhaps `solid`.
    #[inline]
    pub(crate) fn holds_no_other(&self, solid: SolidId) -> bool {
        self.others.is_empty() && bit(solid).is_some_and(|bit| self.first & !bit == 0)
    }

    /// Adds a solid.
    #[inline]
    pub(crate) fn enter(&mut self, solid: SolidId) {
        match bit(solid) {
            Some(bit) => self.first |= bit,
            None if self.others.contains(&solid) => {}
            None => self.others.push(solid),
        }
    }

    /// Removes a solid.
    #[inline]
    pub(crate) fn leave(&mut self, solid: SolidId) {
        match bit(solid) {
            Some(bit) => self.first &= !bit,
            None => self.others.retain(|inside| *inside != solid),
        }
    }

    /// The solids.
    #[inline]
    pub(crate) fn iter(&self) -> impl Iterator<Item = SolidId> + '_ {
        let mut bits = self.first;
        let first = std::iter::from_fn(move || {
            let index = bits.trailing_zeros();
            bits &= bits.wrapping_sub(1);
            (index < u64::BITS).then(|| SolidId::new(index as usize))
        });
        first.chain(self.others.iter().copied())
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_solids_and_later_ones_are_entered_and_left_alike() {
        let solids = [0, 5, 63, 64, 65, 70_000].map(SolidId::new);
        let mut inside: Inside = solids.into_iter().collect();
        inside.enter(solids[3]);
        assert_eq!(inside.iter().collect::<Vec<_>>(), solids);
        for (count, solid) in solids.into_iter().enumerate() {
            assert!(inside.contains(solid) && !inside.is_empty());
            inside.leave(solid);
            assert!(!inside.contains(solid));
            assert_eq!(inside.iter().count(), solids.len() - 1 - count);
        }
        assert_eq!(inside, Inside::default());
    }
}
