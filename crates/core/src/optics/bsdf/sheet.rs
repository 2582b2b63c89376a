//! Tables of a sheet for light that meets either side.

use crate::optics::bsdf::table::{BsdfTable, PatchPlace};
use glam::DVec2;
use lumiduct_base::math::{DirectionPatches, circle};
use lumiduct_base::number::format_percent;
use std::fmt;
use std::sync::Arc;

/// Difference of values that is rounding, relative to them, 1.
const ROUNDING: f64 = 1e-9;
/// Azimuths and rings over which shares are averaged.
const AZIMUTHS: u32 = 360;
const RINGS: u32 = 400;

/// A side of a sheet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SheetSide {
    /// The front.
    Front,
    /// The back.
    Back,
}

impl SheetSide {
    /// The other side.
    pub(crate) fn opposite(self) -> Self {
        match self {
            Self::Front => Self::Back,
            Self::Back => Self::Front,
        }
    }
}

/// What a sheet does to light that meets one of its sides.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SheetTables {
    /// Reflected light; `None` for none.
    pub reflection: Option<DirectedTable>,
    /// Transmitted light; `None` for none.
    pub transmission: Option<DirectedTable>,
}

/// A table, or the one for all paths of light backwards.
#[derive(Debug, Clone, PartialEq)]
pub struct DirectedTable {
    table: Arc<BsdfTable>,
    /// Whether light takes the paths of the table backwards.
    is_reversed: bool,
}

impl DirectedTable {
    /// A table as it is.
    pub fn new(table: BsdfTable) -> Self {
        Self { table: Arc::new(table), is_reversed: false }
    }

    /// The table for all paths of light backwards, in the same axes of the face.
    pub fn reversed(&self) -> Self {
        Self { table: self.table.clone(), is_reversed: !self.is_reversed }
    }

    /// Whether it has axes of its own on the face.
    pub fn has_grain(&self) -> bool {
        self.table.has_grain()
    }

    /// All values times a factor.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self { table: Arc::new(self.table.scaled(factor)), is_reversed: self.is_reversed }
    }

    /// The patches of arriving light, turned by half a turn if all paths are backwards.
    pub fn incident_patches(&self) -> DirectionPatches {
        let [incident, leaving] = self.table.divisions();
        if self.is_reversed { leaving } else { incident }
    }

    /// Whether it is another table backwards.
    pub fn is_reverse_of(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.table, &other.table) && self.is_reversed != other.is_reversed
    }

    /// A direction within each patch of arriving light, and within each of leaving light.
    pub fn directions(&self) -> [Vec<DVec2>; 2] {
        let [incident, leaving] = self.table.directions();
        let turned = |all: Vec<DVec2>| all.into_iter().map(|at| -at).collect();
        if self.is_reversed { [turned(leaving), turned(incident)] } else { [incident, leaving] }
    }

    /// Root mean square of the difference from another table with all paths reversed, over that of the values, 1: 0 where
    /// light is reciprocal, if the other one is that of the side where light of this one arrives. 0 without light.
    pub fn reciprocity_error(&self, other: &Self) -> f64 {
        let [incident, leaving] = self.directions();
        let turned = [&leaving, &incident].map(|all| all.iter().map(|at| -*at).collect::<Vec<_>>());
        let own = PairValues::new(self, [&incident, &leaving]);
        let backwards = PairValues::new(other, [&turned[0], &turned[1]]);
        let (mut squares, mut differences) = (0.0, 0.0);
        for from in 0..incident.len() {
            for to in 0..leaving.len() {
                let value = own.value(from, to);
                squares += value * value;
                differences += (value - backwards.value(to, from)).powi(2);
            }
        }
        if squares > 0.0 { f64::sqrt(differences / squares) } else { 0.0 }
    }

    /// Share of light from a direction that leaves in any direction, 1.
    pub fn share(&self, from: DVec2) -> f64 {
        if self.is_reversed { self.table.collected_share(-from) } else { self.table.share(from) }
    }

    /// Mean share of light at an angle of incidence, rad, over all azimuths, 1.
    pub fn share_at(&self, angle: f64) -> f64 {
        let around = (0..AZIMUTHS)
            .map(|n| self.share(angle.sin() * circle((f64::from(n) + 0.5) / f64::from(AZIMUTHS))));
        around.sum::<f64>() / f64::from(AZIMUTHS)
    }

    /// Share of diffuse light, by Lambert's law, 1.
    pub fn share_of_diffuse(&self) -> f64 {
        // Rings of one projected solid angle.
        let sine = |n: u32| ((f64::from(n) + 0.5) / f64::from(RINGS)).sqrt();
        (0..RINGS).map(|n| self.share_at(sine(n).asin())).sum::<f64>() / f64::from(RINGS)
    }

    /// The distribution function, 1/sr.
    pub fn value(&self, from: DVec2, to: DVec2) -> f64 {
        if self.is_reversed { self.table.value(-to, -from) } else { self.table.value(from, to) }
    }

    /// A direction in which light leaves; its density is `f cos θ_o` over the share, which is above 0.
    pub(crate) fn leave(&self, from: DVec2, u: [f64; 2]) -> DVec2 {
        if self.is_reversed { -self.table.arrive(-from, u) } else { self.table.leave(from, u) }
    }

    /// `∫ f cos θ_i dω_i` over all light that leaves in a direction, 1.
    pub(crate) fn collected_share(&self, to: DVec2) -> f64 {
        if self.is_reversed { self.table.share(-to) } else { self.table.collected_share(to) }
    }

    /// A direction from which light comes that leaves in a direction; its density is `f cos θ_i` over
    /// [`DirectedTable::collected_share`], which is above 0.
    pub(crate) fn arrive(&self, to: DVec2, u: [f64; 2]) -> DVec2 {
        if self.is_reversed { -self.table.leave(-to, u) } else { self.table.arrive(to, u) }
    }
}

/// Values of a table for all pairs of given directions; each direction is looked up once.
struct PairValues<'a> {
    table: &'a DirectedTable,
    /// Of arriving and of leaving light.
    places: [Vec<PatchPlace>; 2],
}

impl<'a> PairValues<'a> {
    fn new(table: &'a DirectedTable, [from, to]: [&[DVec2]; 2]) -> Self {
        let DirectedTable { table: own, is_reversed } = table;
        let places = if *is_reversed {
            [
                from.iter().map(|at| own.leaving_place(-*at)).collect(),
                to.iter().map(|at| own.incident_place(-*at)).collect(),
            ]
        } else {
            [
                from.iter().map(|at| own.incident_place(*at)).collect(),
                to.iter().map(|at| own.leaving_place(*at)).collect(),
            ]
        };
        Self { table, places }
    }

    /// The distribution function, 1/sr.
    fn value(&self, from: usize, to: usize) -> f64 {
        let DirectedTable { table, is_reversed } = self.table;
        let [from, to] = [&self.places[0][from], &self.places[1][to]];
        if *is_reversed { table.value_at(to, from) } else { table.value_at(from, to) }
    }
}

/// A sheet with measured scatter. Its tables have the direction cosines of travel along x and y of the sheet: y is the grain,
/// turned about the normal of the front, and x points to the right as seen by an observer who faces the back with y upward.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredSheet {
    /// For light that meets the front.
    pub front: SheetTables,
    /// For light that meets the back.
    pub back: SheetTables,
    /// Angle from the grain to y about the normal of the front, rad.
    pub turn: f64,
    /// What was found when its tables were made.
    pub checks: SheetChecks,
}

/// What paths through a sheet may do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SheetPart {
    /// Reflection by the front.
    FrontReflection,
    /// Reflection by the back.
    BackReflection,
    /// Transmission, both ways.
    Transmission,
}

impl SheetPart {
    fn name(self) -> &'static str {
        match self {
            Self::FrontReflection => "reflection by the front",
            Self::BackReflection => "reflection by the back",
            Self::Transmission => "transmission",
        }
    }
}

/// What checks of energy and reciprocity find of the tables of a sheet.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SheetChecks {
    /// The largest share of light from a direction that leaves, 1.
    pub largest_share: f64,
    /// What differs most from the reversed paths, and the root mean square of the difference relative to that of the
    /// values, 1; `None` where paths are exactly reversible.
    pub irreversible: Option<(SheetPart, f64)>,
}

impl fmt::Display for SheetChecks {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let largest = format_percent(self.largest_share);
        write!(f, "at most {largest} of the light from a direction leaves; ")?;
        match self.irreversible.filter(|(_, error)| *error > ROUNDING) {
            Some((part, error)) => {
                let (part, error) = (part.name(), format_percent(error));
                write!(
                    f,
                    "averaged over its patches, its {part} differs from that of the reversed paths by {error} (rms)"
                )
            }
            None => f.write_str("its values are reciprocal"),
        }
    }
}

impl MeasuredSheet {
    /// The tables for light that meets a side.
    pub(crate) fn met(&self, side: SheetSide) -> &SheetTables {
        match side {
            SheetSide::Front => &self.front,
            SheetSide::Back => &self.back,
        }
    }

    /// Whether it has axes of its own on the face.
    pub(crate) fn has_grain(&self) -> bool {
        let sides = [&self.front, &self.back];
        let mut tables = sides.into_iter().flat_map(|side| [&side.reflection, &side.transmission]);
        tables.any(|table| table.as_ref().is_some_and(DirectedTable::has_grain))
    }
}
