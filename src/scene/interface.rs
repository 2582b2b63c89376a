//! From the surfaces that meet at one place to the one interface that light sees.
//!
//! All enterings and leavings are applied first; the interface is then between the medium before and the medium
//! after. A face inside a solid of higher priority does nothing; of several faces, a declared finish acts before an
//! undeclared one, a sheet before a solid, the higher priority before the lower.

use crate::scene::shape::Toward;
use crate::scene::{FaceId, FinishId, Hits, Inside, MediumId, Owner, PrimHit, Scene};

/// What light sees where faces meet.
#[derive(Debug, Clone, Copy)]
pub struct Interface<'h> {
    /// The surface whose normal and finish act.
    pub acting: &'h PrimHit,
    /// Its declared finish on the side the light comes from; `None` is the smooth interface of the media.
    pub finish: Option<FinishId>,
    /// The medium the light comes from.
    pub from: MediumId,
    /// The medium behind.
    pub to: MediumId,
    /// Whether nothing happens to light here: equal media and no finish, or a face buried in another solid.
    pub visibility: Visibility,
}

/// Whether an interface does anything.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Visibility {
    /// A finish or a step of the index acts.
    Visible,
    /// Light goes straight on.
    Invisible,
}

impl Scene {
    /// The interface at a hit, for a path inside `inside` in medium `from`.
    #[inline(always)]
    pub fn interface<'h>(&self, hits: &'h Hits, inside: &Inside, from: MediumId) -> Interface<'h> {
        // One face, and no solid around it but perhaps its own: the usual case needs no ranks.
        let hit = hits.nearest();
        let to = match (hit.owner, hits.others()) {
            (Owner::Sheet | Owner::Port, []) => from,
            (Owner::Solid(solid), []) if inside.holds_no_other(solid) => match hit.toward {
                Toward::Front => self.surroundings,
                Toward::Back => self.solids[solid.index()].medium,
            },
            (Owner::Solid(_) | Owner::Sheet | Owner::Port, _) => {
                return self.interface_of_several(hits, inside, from);
            }
        };
        self.interface_of(hit, self.declared_finish(hit), from, to)
    }

    /// The interface where several faces or solids meet.
    #[inline(never)]
    fn interface_of_several<'h>(
        &self,
        hits: &'h Hits,
        inside: &Inside,
        from: MediumId,
    ) -> Interface<'h> {
        let to = self.medium_beyond(hits, inside, from);
        let claim = |hit: &PrimHit| {
            let finish = self.declared_finish(hit);
            (self.rank(hit, hits, inside).map(|rank| (finish.is_some(), rank)), finish)
        };
        let mut acting = hits.nearest();
        let (mut best, mut finish) = claim(acting);
        for hit in hits.others() {
            let other = claim(hit);
            if other.0 > best {
                (best, finish) = other;
                acting = hit;
            }
        }
        let interface = self.interface_of(acting, finish, from, to);
        if best.is_none() {
            return Interface { visibility: Visibility::Invisible, ..interface };
        }
        interface
    }

    #[inline(always)]
    fn interface_of<'h>(
        &self,
        acting: &'h PrimHit,
        finish: Option<FinishId>,
        from: MediumId,
        to: MediumId,
    ) -> Interface<'h> {
        let passes = finish.is_none() && (from == to || self.same_index(from, to));
        let visibility = if passes { Visibility::Invisible } else { Visibility::Visible };
        Interface { acting, finish, from, to, visibility }
    }

    /// The medium behind a hit: solids that the path was in are left, others are entered.
    fn medium_beyond(&self, hits: &Hits, inside: &Inside, from: MediumId) -> MediumId {
        let entered = hits.all().filter_map(|hit| match hit.owner {
            Owner::Solid(solid) if !inside.contains(solid) => Some(solid),
            Owner::Solid(_) | Owner::Sheet | Owner::Port => None,
        });
        if hits.all().any(|hit| matches!(hit.owner, Owner::Solid(_))) {
            self.medium_of(inside.iter().filter(|solid| !hits.meet(*solid)).chain(entered))
        } else {
            from
        }
    }

    /// The finish that the acting face declares for light arriving from behind the interface.
    pub fn finish_behind(&self, interface: &Interface<'_>) -> Option<FinishId> {
        self.finish_against(interface.acting.face, interface.acting.toward.opposite())
    }

    /// The finish that a face declares for light arriving at it.
    #[inline]
    fn declared_finish(&self, hit: &PrimHit) -> Option<FinishId> {
        self.finish_against(hit.face, hit.toward)
    }

    #[inline]
    fn finish_against(&self, face: FaceId, toward: Toward) -> Option<FinishId> {
        let face = &self.faces[face.index()];
        match toward {
            // Light going toward the front meets the back.
            Toward::Front => face.back,
            Toward::Back => face.front,
        }
    }

    /// How strongly a face claims to act; `None` when it is buried in a solid of higher priority.
    fn rank(&self, hit: &PrimHit, hits: &Hits, inside: &Inside) -> Option<i64> {
        match hit.owner {
            Owner::Sheet | Owner::Port => Some(i64::MAX),
            Owner::Solid(solid) => {
                let priority = self.solids[solid.index()].priority;
                let buried = inside.iter().any(|other| {
                    other != solid
                        && self.solids[other.index()].priority > priority
                        && !hits.meet(other)
                });
                (!buried).then_some(i64::from(priority))
            }
        }
    }

    /// Two media of equal index at every wavelength make no interface.
    fn same_index(&self, a: MediumId, b: MediumId) -> bool {
        // The index is constant; the wavelength does not matter.
        let index = |medium: MediumId| self.media[medium.index()].index(0.0);
        index(a) == index(b)
    }
}
