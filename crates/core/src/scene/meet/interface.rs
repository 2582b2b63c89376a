//! From the surfaces that meet at one point to the one interface that light sees.
//!
//! All entries and exits are applied first; the interface is then between the medium before and the
//! medium after. A face inside a solid of higher priority has no effect; of several faces, a
//! declared finish acts before an undeclared one, a sheet before a solid, the higher priority
//! before the lower.

use crate::scene::pattern::ActingPart;
use crate::scene::shape::Toward;
use crate::scene::{
    FaceId, FinishId, Hits, Inside, MediumId, Owner, Patch, PrimHit, Scene, Surface,
};
use glam::{DVec2, DVec3};
use std::cmp::Reverse;

/// Step along a direction for its slope on a chart, as a share of the scene's size, 1.
const SLOPE_STEP: f64 = 1e-7;

/// The interface where faces meet.
#[derive(Debug, Clone, Copy)]
pub struct Interface<'h> {
    /// The surface whose normal and finish act.
    pub acting: &'h PrimHit,
    /// The acting part: the face, or an element of a pattern on it.
    pub part: ActingPart,
    /// Its declared finish on the side the light comes from; `None` is the smooth interface of the media.
    pub finish: Option<FinishId>,
    /// The medium the light comes from.
    pub from: MediumId,
    /// The medium behind.
    pub to: MediumId,
    /// Invisible if nothing happens to light here: equal media and no finish, or a face buried in
    /// another solid.
    pub visibility: Visibility,
}

/// Point and direction of an arriving path.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MeetingPoint {
    /// Position, mm.
    pub point: DVec3,
    /// Unit direction of travel.
    pub dir: DVec3,
}

/// Whether an interface has any effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Visibility {
    /// A finish or a step of the index acts.
    Visible,
    /// Light goes straight on.
    Invisible,
}

impl Scene {
    /// The interface at a hit, for a path inside `inside` in medium `from` that arrives with
    /// `meeting`.
    #[inline(always)]
    pub(crate) fn interface<'h>(
        &self,
        hits: &'h Hits,
        meeting: &MeetingPoint,
        inside: &Inside,
        from: MediumId,
    ) -> Interface<'h> {
        // One face, and no solid around it except perhaps its own: the usual case needs no ranks.
        let hit = hits.nearest();
        let to = match (hit.owner, hits.others()) {
            (Owner::Sheet | Owner::Port, []) => from,
            (Owner::Solid(solid), []) if inside.holds_no_other(solid) => match hit.toward {
                Toward::Front => self.surroundings,
                Toward::Back => self.solids[solid.index()].medium,
            },
            (Owner::Solid(_) | Owner::Sheet | Owner::Port, _) => {
                return self.interface_of_several(hits, meeting, inside, from);
            }
        };
        self.interface_of(hit, self.declared(hit, meeting), from, to)
    }

    /// The interface where several faces or solids meet.
    #[inline(never)]
    fn interface_of_several<'h>(
        &self,
        hits: &'h Hits,
        meeting: &MeetingPoint,
        inside: &Inside,
        from: MediumId,
    ) -> Interface<'h> {
        let to = self.medium_beyond(hits, inside, from);
        let claim = |hit: &PrimHit| {
            let declared = self.declared(hit, meeting);
            (self.rank(hit, hits, inside).map(|rank| (declared.1.is_some(), rank)), declared)
        };
        let mut acting = hits.nearest();
        let (mut best, mut declared) = claim(acting);
        for hit in hits.others() {
            let other = claim(hit);
            if other.0 > best {
                (best, declared) = other;
                acting = hit;
            }
        }
        let interface = self.interface_of(acting, declared, from, to);
        if best.is_none() {
            return Interface { visibility: Visibility::Invisible, ..interface };
        }
        interface
    }

    #[inline(always)]
    fn interface_of<'h>(
        &self,
        acting: &'h PrimHit,
        (part, finish): (ActingPart, Option<FinishId>),
        from: MediumId,
        to: MediumId,
    ) -> Interface<'h> {
        let passes = finish.is_none() && (from == to || self.same_index(from, to));
        let visibility = if passes { Visibility::Invisible } else { Visibility::Visible };
        Interface { acting, part, finish, from, to, visibility }
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

    /// The finish that acts on light arriving from behind the interface.
    pub(crate) fn finish_behind(&self, interface: &Interface<'_>) -> Option<FinishId> {
        let Interface { acting, part, .. } = interface;
        self.finish_of_part(acting.face, *part, acting.toward.opposite())
    }

    /// The part of a face that acts on arriving light, and its finish.
    #[inline(always)]
    fn declared(&self, hit: &PrimHit, meeting: &MeetingPoint) -> (ActingPart, Option<FinishId>) {
        let face = &self.faces[hit.face.index()];
        if face.patterns.is_empty() {
            return (ActingPart::Face, face.finish_against(hit.toward));
        }
        let part = self.part_at(hit, meeting);
        (part, self.finish_of_part(hit.face, part, hit.toward))
    }

    /// The finish of a part of a face, for light travelling toward one of its sides.
    fn finish_of_part(&self, face: FaceId, part: ActingPart, toward: Toward) -> Option<FinishId> {
        match part {
            ActingPart::Face => self.faces[face.index()].finish_against(toward),
            ActingPart::Element(pattern) => Some(match toward {
                Toward::Front => self.patterns[pattern].back,
                Toward::Back => self.patterns[pattern].front,
            }),
            ActingPart::Bore(pattern) => self.patterns[pattern].wall.map(|wall| wall.bore),
        }
    }

    /// The part of a face with patterns that light meets.
    #[inline(never)]
    fn part_at(&self, hit: &PrimHit, meeting: &MeetingPoint) -> ActingPart {
        // Patterns lie only on patches.
        let Surface::Patch(patch) = self.surface(hit.prim) else { return ActingPart::Face };
        let at = patch.chart(meeting.point);
        let numbers = &self.faces[hit.face.index()].patterns;
        let parts = numbers.iter().filter_map(|&number| {
            let pattern = &self.patterns[number];
            pattern.part(number, at, || self.slope(patch, pattern.field.period, meeting))
        });
        parts.into_iter().next().unwrap_or(ActingPart::Face)
    }

    /// Distance of light along the chart of a patch per mm through it, mm/mm.
    fn slope(&self, patch: &Patch, period: Option<f64>, meeting: &MeetingPoint) -> DVec2 {
        let MeetingPoint { point, dir } = *meeting;
        let normal = patch.shape.normal(point);
        let through = dir.dot(normal);
        let step = SLOPE_STEP * self.bounds.diagonal();
        let mut moved = patch.chart(point + step * (dir - through * normal)) - patch.chart(point);
        if let Some(period) = period {
            moved.x -= period * (moved.x / period).round();
        }
        moved / (step * through.abs())
    }

    /// The face through which light that crosses an interface leaves a solid; of several, the acting one, then that of
    /// the highest priority, then the first of the scene.
    pub(crate) fn face_left(&self, interface: &Interface<'_>, hits: &Hits) -> Option<FaceId> {
        let left = hits.all().filter_map(|hit| match (hit.owner, hit.toward) {
            (Owner::Solid(solid), Toward::Front) => {
                let acts = hit.face == interface.acting.face;
                Some((acts, self.solids[solid.index()].priority, Reverse(hit.face.index())))
            }
            (Owner::Solid(_), Toward::Back) | (Owner::Sheet | Owner::Port, _) => None,
        });
        left.max().map(|(_, _, Reverse(face))| FaceId::new(face))
    }

    /// The precedence of a face; `None` when it is buried in a solid of higher priority.
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
        a == b || self.media[a.index()].index_law() == self.media[b.index()].index_law()
    }
}
