//! Where a ray crosses a surface, and which crossings matter to the caller.

use glam::DVec3;

/// Whether a ray starts on the surface under test.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RayStart {
    /// The origin is elsewhere: every root counts.
    Elsewhere,
    /// The origin lies on this surface: the root at the origin does not count.
    On,
}

/// A point where a ray crosses a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// Distance along the ray, mm; may be negative.
    pub t: f64,
    /// Direction of the crossing.
    pub toward: Toward,
}

/// The crossings of a ray that matter to the caller.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CrossingQuery {
    /// Only crossings in this direction.
    pub toward: Option<Toward>,
    /// Smallest distance along the ray, mm.
    pub min: f64,
    /// Largest distance, mm.
    pub max: f64,
}

impl CrossingQuery {
    /// Whether a crossing matters.
    #[inline]
    pub(crate) fn includes(&self, crossing: &Crossing) -> bool {
        self.includes_way(crossing.toward) && crossing.t >= self.min && crossing.t <= self.max
    }

    #[inline(always)]
    pub(crate) fn includes_way(&self, toward: Toward) -> bool {
        self.toward != Some(toward.opposite())
    }
}

/// Direction in which a ray crosses a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Toward {
    /// Along the normal: out of a solid.
    Front,
    /// Against the normal: into a solid.
    Back,
}

impl Toward {
    /// The side toward which `dir` leaves a surface with `normal`.
    #[inline]
    pub(crate) fn of(dir: DVec3, normal: DVec3) -> Self {
        if dir.dot(normal) > 0.0 { Self::Front } else { Self::Back }
    }

    /// The opposite direction.
    #[inline]
    pub(crate) fn opposite(self) -> Self {
        match self {
            Self::Front => Self::Back,
            Self::Back => Self::Front,
        }
    }
}
