//! The surfaces that a ray starts on.

use crate::scene::{Hits, PrimId};

/// Start of a ray: on no surface, on one, or rarely on several that meet there.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct StartSurfaces {
    first: Option<PrimId>,
    /// On the heap, so that a test of the usual one costs one comparison.
    others: Box<[PrimId]>,
}

impl StartSurfaces {
    /// On the surfaces of a hit.
    #[inline(always)]
    pub fn hits(hits: &Hits) -> Self {
        let others = match hits.others() {
            [] => Box::default(),
            others => others.iter().map(|hit| hit.prim).collect(),
        };
        Self { first: Some(hits.nearest().prim), others }
    }

    /// Whether the ray starts on this surface.
    #[inline(always)]
    pub(crate) fn contains(&self, prim: PrimId) -> bool {
        self.first == Some(prim) || (!self.others.is_empty() && self.others.contains(&prim))
    }

    /// The surfaces.
    pub fn iter(&self) -> impl Iterator<Item = PrimId> {
        self.first.iter().chain(&self.others).copied()
    }
}

impl From<Option<PrimId>> for StartSurfaces {
    fn from(first: Option<PrimId>) -> Self {
        Self { first, others: Box::default() }
    }
}
