//! Scatter by tables of a sheet, as measured or computed elsewhere.
//!
//! Tables mix radiance, as a diffuser does, so the factor `n_i²/n_o²` of a gather path remains. Their directions are those
//! in the media beside the face.

use crate::optics::bsdf::sheet::{DirectedTable, MeasuredSheet, SheetSide};
use crate::optics::finish::model::{FinishModel, Spread};
use crate::optics::{Incidence, Scattered, Shares, Side};
use crate::rng::{Dimension, Numbers, Sampler};
use glam::{DVec2, DVec3};
use lumiduct_base::math::Frame;

/// A sheet as light meets it.
pub(crate) struct MetSheet<'a> {
    pub(crate) sheet: &'a MeasuredSheet,
    /// The side that the light meets on which this acts.
    pub(crate) side: SheetSide,
}

/// Axes of the sheet in the scene.
struct SheetAxes {
    x: DVec3,
    y: DVec3,
}

impl SheetAxes {
    fn cosines(&self, dir: DVec3) -> DVec2 {
        DVec2::new(dir.dot(self.x), dir.dot(self.y))
    }

    /// The unit vector with these cosines, on the side of a normal.
    fn direction(&self, cosines: DVec2, normal: DVec3) -> DVec3 {
        let height = (1.0 - cosines.length_squared()).max(0.0).sqrt();
        cosines.x * self.x + cosines.y * self.y + height * normal
    }
}

impl MetSheet<'_> {
    /// The axes, from the normal on the side that is met.
    fn axes(&self, met: DVec3, grain: DVec3) -> SheetAxes {
        if !self.sheet.has_grain() {
            let frame = Frame::from_axis(DVec3::ZERO, met);
            return SheetAxes { x: frame.x, y: frame.y };
        }
        let front = match self.side {
            SheetSide::Front => met,
            SheetSide::Back => -met,
        };
        let (sin, cos) = self.sheet.turn.sin_cos();
        let y = cos * grain + sin * front.cross(grain);
        SheetAxes { x: front.cross(y), y }
    }

    fn table(&self, side: Side) -> Option<&DirectedTable> {
        let tables = self.sheet.met(self.side);
        match side {
            Side::Reflected => tables.reflection.as_ref(),
            Side::Transmitted => tables.transmission.as_ref(),
        }
    }

    /// Both shares of light of these cosines.
    fn both(&self, of: impl Fn(&DirectedTable) -> f64) -> Shares {
        let share = |side| self.table(side).map_or(0.0, &of);
        Shares { reflected: share(Side::Reflected), transmitted: share(Side::Transmitted) }
    }

    /// The axes for light that leaves along a gather path, with this side relative to the path. The light comes from the side
    /// that it meets.
    fn axes_behind(&self, side: Side, incidence: &Incidence) -> SheetAxes {
        self.axes(incidence.leaving_normal(side), incidence.grain)
    }
}

impl FinishModel for MetSheet<'_> {
    fn shares(&self, incidence: &Incidence) -> Shares {
        let from = self.axes(incidence.normal, incidence.grain).cosines(incidence.dir);
        self.both(|table| table.share(from))
    }

    fn scatter(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        let axes = self.axes(incidence.normal, incidence.grain);
        let from = axes.cosines(incidence.dir);
        let shares = self.both(|table| table.share(from));
        let side = shares.choose_side(sampler)?;
        let to = self.table(side)?.leave(from, sampler.pair(Dimension::Scatter));
        let dir = axes.direction(to, incidence.leaving_normal(side));
        Some(Scattered::diffuse(dir, shares.sum(), side).chosen_by(shares))
    }

    fn scatter_radiance(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        let chances = self.radiance_chances(incidence);
        let side = chances.choose_side(sampler)?;
        let out = self.scatter_toward(side, incidence, sampler)?;
        Some(Scattered { factor: out.factor * (chances.sum() / chances.of(side)), ..out })
    }

    fn scatter_toward(
        &self,
        side: Side,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        let table = self.table(side)?;
        let axes = self.axes_behind(side, incidence);
        let to = axes.cosines(-incidence.dir);
        let share = table.collected_share(to);
        if share <= 0.0 {
            return None;
        }
        let from = table.arrive(to, sampler.pair(Dimension::Scatter));
        let dir = axes.direction(-from, incidence.leaving_normal(side));
        Some(Scattered::diffuse(dir, share, side).unrefracted(incidence))
    }

    fn radiance_chances(&self, incidence: &Incidence) -> Shares {
        let share = |side| {
            let to = self.axes_behind(side, incidence).cosines(-incidence.dir);
            self.table(side).map_or(0.0, |table| table.collected_share(to))
        };
        Shares { reflected: share(Side::Reflected), transmitted: share(Side::Transmitted) }
    }

    fn evaluate(&self, incidence: &Incidence, out: DVec3) -> f64 {
        let axes = self.axes(incidence.normal, incidence.grain);
        let [from, to] = [incidence.dir, out].map(|dir| axes.cosines(dir));
        self.table(incidence.side_of(out)).map_or(0.0, |table| table.value(from, to))
    }

    fn spread(&self) -> Spread {
        Spread::Broad
    }

    fn has_grain(&self) -> bool {
        self.sheet.has_grain()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::bsdf::sheet::{SheetChecks, SheetTables};
    use crate::optics::bsdf::table::BsdfTable;
    use crate::optics::finish::testing::{
        assert_adjoint, assert_follows, diffuse, incidence, splitter,
    };
    use crate::optics::{Faces, Finish};
    use lumiduct_base::math::{DirectionPatches, PatchPairs, RingPatches};
    use std::f64::consts::{FRAC_PI_2, PI};
    use std::sync::Arc;

    fn rings(angles: &[f64], sectors: &[usize]) -> RingPatches {
        RingPatches::new(angles, sectors.to_vec()).unwrap()
    }

    /// A table of irregular values with shares below this.
    fn table(patches: PatchPairs, most: f64) -> DirectedTable {
        let [incident, leaving] = patches.counts();
        let uneven = |n: usize| (n as f64 * 0.618_034).fract().powi(4);
        let values: Vec<f64> = (0..incident * leaving).map(uneven).collect();
        let table = BsdfTable::new(patches, &values).unwrap();
        let [directions, _] = table.directions();
        let largest = directions.iter().map(|from| table.share(*from)).fold(0.0, f64::max);
        DirectedTable::new(table.scaled(most / largest))
    }

    fn with_grain() -> PatchPairs {
        let rings = rings(&[0.0, 0.2, 0.9, FRAC_PI_2], &[1, 6, 5]);
        PatchPairs::Fixed {
            incident: DirectionPatches::Rings(rings),
            leaving: DirectionPatches::Squares { side: 4 },
        }
    }

    fn without_grain() -> PatchPairs {
        PatchPairs::Isotropic {
            incident: rings(&[0.0, 0.5, 1.1, FRAC_PI_2], &[1, 1, 1]),
            leaving: rings(&[0.0, 0.3, 0.8, FRAC_PI_2], &[1, 5, 8]),
        }
    }

    /// Sheets with and without grain, some with tables backwards.
    fn sheets() -> Vec<Arc<MeasuredSheet>> {
        let sheet = |patches: fn() -> PatchPairs| {
            let transmission = table(patches(), 0.5);
            MeasuredSheet {
                back: SheetTables {
                    reflection: Some(table(patches(), 0.3)),
                    transmission: Some(transmission.reversed()),
                },
                front: SheetTables {
                    reflection: Some(table(patches(), 0.45)),
                    transmission: Some(transmission),
                },
                turn: 0.4,
                checks: SheetChecks::default(),
            }
        };
        let both = sheet(with_grain);
        let half = SheetTables { reflection: None, ..both.front.clone() };
        let open = MeasuredSheet { front: half, ..both.clone() };
        [both, open, sheet(without_grain)].map(Arc::new).into()
    }

    #[test]
    fn gather_paths_collect_what_photons_bring() {
        for sheet in sheets() {
            let own = Finish::MeasuredSheet { sheet: sheet.clone(), met: SheetSide::Front };
            let behind = own.from_behind().unwrap();
            assert_eq!(behind, Finish::MeasuredSheet { sheet, met: SheetSide::Back });
            assert_adjoint(Faces { own: &own, behind: &behind });
            assert_adjoint(Faces { own: &behind, behind: &own });
            assert_adjoint(Faces { own: &own, behind: &diffuse() });
            let mixed = Finish::Mixture(vec![(2.0, own), (1.0, splitter())]);
            let behind = mixed.from_behind().unwrap();
            assert_adjoint(Faces { own: &mixed, behind: &behind });
        }
    }

    #[test]
    fn photons_follow_the_tables() {
        for sheet in sheets() {
            for met in [SheetSide::Front, SheetSide::Back] {
                let finish = Finish::MeasuredSheet { sheet: sheet.clone(), met };
                for angle in [0.1, 0.7, 1.3] {
                    let light = incidence(angle, [1.0, 1.0]);
                    for side in [Side::Reflected, Side::Transmitted] {
                        let share = assert_follows(&finish, &light, side);
                        assert!((share - finish.shares(&light).of(side)).abs() < 0.01, "{share}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_table_of_one_value_is_a_diffuser() {
        let patches = [with_grain(), without_grain()];
        for patches in patches {
            let [incident, leaving] = patches.counts();
            let table = BsdfTable::new(patches, &vec![0.4 / PI; incident * leaving]).unwrap();
            for from in [DVec2::ZERO, DVec2::new(0.3, -0.6), DVec2::new(-0.99, 0.05)] {
                assert!((table.share(from) - 0.4).abs() < 1e-12);
                assert!((table.collected_share(from) - 0.4).abs() < 1e-12);
                assert!((table.value(from, -from) - 0.4 / PI).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn light_that_goes_straight_on_keeps_its_patch() {
        // Each patch sends all of its light into the patch of the same number.
        let side = 6;
        let squares = DirectionPatches::Squares { side };
        let count = side * side;
        let value = |n: usize| if n.is_multiple_of(count + 1) { count as f64 / PI } else { 0.0 };
        let values: Vec<f64> = (0..count * count).map(value).collect();
        let patches = PatchPairs::Fixed { incident: squares.clone(), leaving: squares.clone() };
        let table = DirectedTable::new(BsdfTable::new(patches, &values).unwrap());
        let tables = SheetTables { reflection: None, transmission: Some(table) };
        let checks = SheetChecks::default();
        let sheet = MeasuredSheet { front: tables.clone(), back: tables, turn: 0.3, checks };
        for (met, normal) in [(SheetSide::Front, DVec3::Z), (SheetSide::Back, DVec3::NEG_Z)] {
            let finish = Finish::MeasuredSheet { sheet: Arc::new(sheet.clone()), met };
            for dir in [DVec3::new(0.3, 0.5, -0.2), DVec3::new(-0.7, 0.1, -0.4)] {
                let dir = (dir * DVec3::new(1.0, 1.0, normal.z)).normalize();
                let light = Incidence { dir, normal, ..incidence(0.0, [1.0, 1.0]) };
                for index in 0..20 {
                    let mut sampler = Sampler::for_path(1, 0, index);
                    let out = finish.scatter(&light, &mut sampler).unwrap();
                    assert_eq!((out.side, out.factor), (Side::Transmitted, 1.0));
                    assert!((out.dir - dir).length() < 0.6, "{dir} {}", out.dir);
                }
            }
        }
    }

    #[test]
    fn axes_are_those_of_an_observer_who_faces_the_back() {
        // All light leaves into the quarter of positive x and y.
        let squares = DirectionPatches::Squares { side: 2 };
        let values = [0.0, 0.0, 0.0, 4.0 / PI].repeat(4);
        let pairs = PatchPairs::Fixed { incident: squares.clone(), leaving: squares };
        let table = DirectedTable::new(BsdfTable::new(pairs, &values).unwrap());
        let tables = SheetTables { reflection: None, transmission: Some(table) };
        let checks = SheetChecks::default();
        let sheet = MeasuredSheet { front: tables.clone(), back: tables, turn: 0.0, checks };
        // The front is above, y is +y of the scene: who looks up from below has -x to the right.
        for (met, normal) in [(SheetSide::Front, DVec3::Z), (SheetSide::Back, DVec3::NEG_Z)] {
            let finish = Finish::MeasuredSheet { sheet: Arc::new(sheet.clone()), met };
            let light = Incidence { dir: -normal, normal, ..incidence(0.0, [1.0, 1.0]) };
            for index in 0..20 {
                let mut sampler = Sampler::for_path(1, 0, index);
                let out = finish.scatter(&light, &mut sampler).unwrap().dir;
                assert!(out.x < 0.0 && out.y > 0.0 && out.dot(normal) < 0.0, "{met:?}: {out}");
            }
        }
    }

    #[test]
    fn wrong_values_make_no_table() {
        let patches = without_grain();
        let [incident, leaving] = patches.counts();
        let good = vec![0.1; incident * leaving];
        assert!(BsdfTable::new(patches.clone(), &good[1..]).is_none());
        for wrong in [-0.1, f64::NAN, f64::INFINITY] {
            let mut values = good.clone();
            values[3] = wrong;
            assert!(BsdfTable::new(patches.clone(), &values).is_none());
        }
    }

    #[test]
    fn reciprocity_is_that_of_all_pairs_of_directions() {
        let sheets = sheets();
        let pairs = sheets.iter().flat_map(|sheet| {
            let MeasuredSheet { front, back, .. } = &**sheet;
            [
                (front.reflection.as_ref(), front.reflection.as_ref()),
                (front.transmission.as_ref(), back.reflection.as_ref()),
                (back.transmission.as_ref(), front.transmission.as_ref()),
                (back.transmission.as_ref(), back.reflection.as_ref()),
            ]
        });
        for (table, other) in pairs.filter_map(|(table, other)| table.zip(other)) {
            let [incident, leaving] = table.directions();
            let (mut squares, mut differences) = (0.0, 0.0);
            for (from, to) in
                incident.iter().flat_map(|from| leaving.iter().map(move |to| (from, to)))
            {
                let value = table.value(*from, *to);
                squares += value * value;
                differences += (value - other.value(-*to, -*from)).powi(2);
            }
            assert_eq!(table.reciprocity_error(other), f64::sqrt(differences / squares));
        }
    }

    #[test]
    fn a_deep_tree_takes_little_space() {
        // Squares of arriving and of leaving light, 32 by 32 each: few of their pairs differ from the others.
        let squares = DirectionPatches::Squares { side: 32 };
        let pairs = PatchPairs::Fixed { incident: squares.clone(), leaving: squares };
        let value = |at: usize| match (at / 1024, at % 1024) {
            (3, 5) => 0.3,
            (700..704, 100..200) => 0.2,
            _ => 0.1,
        };
        let values: Vec<f64> = (0..1024 * 1024).map(value).collect();
        let table = BsdfTable::new(pairs, &values).unwrap();
        assert!(table.stored_weights() < 3000, "{}", table.stored_weights());
        let [from, to] = table.directions();
        for (at, value) in values.iter().enumerate().step_by(1009).chain([(3077, &0.3)]) {
            let found = table.value(from[at / 1024], to[at % 1024]);
            assert!((found - value).abs() < 1e-9, "{at}: {found}");
        }
    }
}
