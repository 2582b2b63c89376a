//! One period of a prism film in its cross-section, and what light does there from interface to interface.
//!
//! Lengths are in pitches. x runs across the prisms, y from the flat face into the film, w along
//! the prisms: the flat face is y = 0, valleys are at x = 0 (and 1, 2, ...) and y = base, tips at x
//! = ½ and y = top. The third component of a direction never changes its magnitude, so a step is
//! plane geometry; Fresnel's equations use all three components. This module knows neither finishes
//! nor pitches in mm.

use crate::optics::fresnel;
use glam::{DVec2, DVec3};

/// A prism film in its cross-section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cell {
    /// Thickness between the flat face and the valleys, pitches.
    pub(super) base: f64,
    /// Height of the tips above the flat face, pitches.
    pub(super) top: f64,
    /// Outward unit normal of the facet that rises from a valley to the tip at larger x; the normal
    /// of the other one is mirrored.
    pub(super) facet: DVec2,
    /// Share of a facet that is rounded, half of it at each end; light that meets it is lost. 1.
    pub(super) rounded: f64,
}

/// Refractive indices: before the flat face, of the film, and between the prisms. 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FilmIndices {
    pub(super) flat: f64,
    pub(super) film: f64,
    pub(super) prisms: f64,
}

/// Position and direction of light in the cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CellLight {
    /// Position, pitches; x is relative to the period of the room.
    at: DVec2,
    /// Unit direction (x, y, w).
    dir: DVec3,
    pub(super) room: CellRoom,
    on: Option<FilmFacet>,
    /// Path length in the film so far, pitches.
    way: f64,
}

/// A part of the cell without inner faces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum CellRoom {
    /// A prism; x in 0..1 between its valleys. The base below it is crossed in one step.
    Prism,
    /// The groove between two prisms, below the tips; x in -½..½ about the valley.
    Groove,
}

/// A facet of a prism, or a side of a groove, by the direction in which it rises.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FilmFacet {
    /// Toward larger x.
    Up,
    /// Toward smaller x.
    Down,
}

/// What happens next to light in the cell.
#[derive(Debug, Clone, Copy)]
pub(super) enum CellStep {
    /// It met an interface: the share `reflectance` is reflected, and the rest is refracted.
    /// `refracted` is `None` under total reflection.
    Met { reflectance: f64, reflected: CellLight, refracted: Option<After> },
    /// It left past the tips.
    Out(Exit),
    /// It met a rounded edge.
    Lost,
}

/// Destination of refracted light.
#[derive(Debug, Clone, Copy)]
pub(super) enum After {
    /// It stays in the cell.
    Inside(CellLight),
    /// It leaves through the flat face.
    Out(Exit),
}

/// Light that leaves the cell.
#[derive(Debug, Clone, Copy)]
pub(super) struct Exit {
    /// Unit direction (x, y, w).
    pub(super) dir: DVec3,
    /// Path length in the film, pitches.
    pub(super) way: f64,
}

impl Cell {
    /// Light that arrives at the flat face at a position in the period: its reflectance, the
    /// direction of the reflected part, and the refracted part.
    #[inline(always)]
    pub(super) fn enter_flat(
        &self,
        x: f64,
        dir: DVec3,
        indices: &FilmIndices,
    ) -> (f64, DVec3, CellLight) {
        let normal = DVec3::NEG_Y;
        let (reflectance, refracted) = split(dir, normal, indices.flat, indices.film);
        // Under total reflection nothing is refracted, and the state has no share.
        let state = self.rise(x, refracted.unwrap_or(dir), 0.0);
        (reflectance, fresnel::mirrored(dir, normal), state)
    }

    /// Light that arrives at the prisms at the level of the tips.
    pub(super) fn enter_prisms(&self, x: f64, dir: DVec3) -> CellLight {
        let at = DVec2::new(x - 0.5, self.top);
        CellLight { at, dir, room: CellRoom::Groove, on: None, way: 0.0 }
    }

    /// The next thing that happens.
    // A step is inlined as one piece, so that states stay in registers.
    #[inline(always)]
    pub(super) fn step(&self, state: &CellLight, indices: &FilmIndices) -> CellStep {
        let meets = |facet: FilmFacet| self.distance(state, facet);
        let (up, down) = (meets(FilmFacet::Up), meets(FilmFacet::Down));
        let (facet, length) = if down < up { (FilmFacet::Down, down) } else { (FilmFacet::Up, up) };
        let dir = state.dir;
        match state.room {
            CellRoom::Prism => {
                let to_base = (self.base - state.at.y) / dir.y;
                if dir.y < 0.0 && to_base <= length {
                    return self.meet_flat(state, indices);
                }
                let reached = CellLight { way: state.way + length, ..*state };
                self.meet(&reached, facet, length, [indices.film, indices.prisms])
            }
            CellRoom::Groove => {
                let to_tips = (self.top - state.at.y) / dir.y;
                if dir.y > 0.0 && to_tips <= length {
                    return CellStep::Out(Exit { dir, way: state.way });
                }
                self.meet(state, facet, length, [indices.prisms, indices.film])
            }
        }
    }

    /// Light that goes up from a position on the flat face, as it enters a prism.
    #[inline(always)]
    fn rise(&self, x: f64, dir: DVec3, way: f64) -> CellLight {
        let length = self.base / dir.y;
        let x = x + length * dir.x;
        // Within the period; quicker than a remainder.
        let at = DVec2::new(x - x.floor(), self.base);
        CellLight { at, dir, room: CellRoom::Prism, on: None, way: way + length }
    }

    /// Light that comes down to the flat face.
    #[inline(always)]
    fn meet_flat(&self, state: &CellLight, indices: &FilmIndices) -> CellStep {
        let dir = state.dir;
        let length = -state.at.y / dir.y;
        let way = state.way + length;
        let (reflectance, refracted) = split(dir, DVec3::Y, indices.film, indices.flat);
        let reflected =
            self.rise(state.at.x + length * dir.x, fresnel::mirrored(dir, DVec3::Y), way);
        let refracted = refracted.map(|dir| After::Out(Exit { dir, way }));
        CellStep::Met { reflectance, reflected, refracted }
    }

    /// Outward normal of a facet, out of the film.
    #[inline(always)]
    fn normal(&self, facet: FilmFacet) -> DVec3 {
        let DVec2 { x, y } = self.facet;
        match facet {
            FilmFacet::Up => DVec3::new(x, y, 0.0),
            FilmFacet::Down => DVec3::new(-x, y, 0.0),
        }
    }

    /// Distance to a facet, pitches; infinite where light does not go toward it.
    #[inline(always)]
    fn distance(&self, state: &CellLight, facet: FilmFacet) -> f64 {
        if state.on == Some(facet) {
            return f64::INFINITY;
        }
        let normal = self.normal(facet).truncate();
        // The facets of a prism end at its tip; those of a groove end in its valley.
        let (corner, sense) = match state.room {
            CellRoom::Prism => (DVec2::new(0.5, self.top), 1.0),
            CellRoom::Groove => (DVec2::new(0.0, self.base), -1.0),
        };
        let toward = sense * state.dir.truncate().dot(normal);
        let gap = sense * (corner - state.at).dot(normal);
        // Rounding may have put light that travelled along a facet slightly beyond it.
        if toward > 0.0 { (gap / toward).max(0.0) } else { f64::INFINITY }
    }

    /// Light that meets a facet.
    #[inline(always)]
    fn meet(
        &self,
        state: &CellLight,
        facet: FilmFacet,
        length: f64,
        [index_from, index_to]: [f64; 2],
    ) -> CellStep {
        let at = state.at + length * state.dir.truncate();
        let up = (at.y - self.base) / (self.top - self.base);
        let edge = 0.5 * self.rounded;
        let is_rounded = self.rounded > 0.0 && (up < edge || up > 1.0 - edge);
        if is_rounded || !length.is_finite() {
            return CellStep::Lost;
        }
        let normal = match state.room {
            CellRoom::Prism => -self.normal(facet),
            CellRoom::Groove => self.normal(facet),
        };
        let (reflectance, refracted) = split(state.dir, normal, index_from, index_to);
        let here = CellLight { at, on: Some(facet), ..*state };
        let reflected = CellLight { dir: fresnel::mirrored(state.dir, normal), ..here };
        let refracted = refracted.map(|dir| {
            // A facet that rises toward larger x is on the right of its groove and on the left of its prism.
            let (room, x) = match (state.room, facet) {
                (CellRoom::Groove, FilmFacet::Up) => (CellRoom::Prism, at.x),
                (CellRoom::Groove, FilmFacet::Down) => (CellRoom::Prism, at.x + 1.0),
                (CellRoom::Prism, FilmFacet::Up) => (CellRoom::Groove, at.x),
                (CellRoom::Prism, FilmFacet::Down) => (CellRoom::Groove, at.x - 1.0),
            };
            After::Inside(CellLight { at: DVec2::new(x, at.y), dir, room, ..here })
        });
        CellStep::Met { reflectance, reflected, refracted }
    }
}

/// Reflectance for unpolarised light, and the refracted direction unless light is totally reflected. `normal` is on the
/// side that light comes from.
#[inline(always)]
fn split(dir: DVec3, normal: DVec3, index_from: f64, index_to: f64) -> (f64, Option<DVec3>) {
    if index_from == index_to {
        return (0.0, Some(dir));
    }
    let cos_i = (-dir.dot(normal)).clamp(0.0, 1.0);
    match fresnel::cos_transmitted(cos_i, index_from, index_to) {
        None => (1.0, None),
        Some(cos_t) => {
            let reflectance = fresnel::dielectric_refracting(cos_i, cos_t, index_from, index_to);
            let dir = fresnel::refracted(dir, normal, cos_i, cos_t, index_from / index_to);
            (reflectance.unpolarised(), Some(dir))
        }
    }
}
