//! Scatter by angles in CSV, and over Klems patches in XML.

use crate::{Verdict, config};
use glam::DVec2;
use lumiduct_base::math::{DirectionPatches, PatchPairs};
use lumiduct_files::scatter::{BsdfMatrix, ScatterFormat, parse};
use proptest::array::uniform2;
use proptest::collection::{btree_set, vec};
use proptest::prelude::*;
use proptest::sample::select;
use std::collections::BTreeSet;
use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt::Write as _;

/// Values over angles, deg: of reflection and of transmission, 1/sr, the azimuth fastest.
#[derive(Debug)]
struct ScatterTable {
    incident: Vec<f64>,
    polar: Vec<f64>,
    azimuth: Vec<f64>,
    values: [Vec<f64>; 2],
}

/// Angles are so far apart that no patch at a polar angle of 30 deg or more reaches past the next angle, and near enough to be a table.
fn scatter_table() -> impl Strategy<Value = ScatterTable> {
    let angles = |all: BTreeSet<u32>| all.into_iter().map(f64::from).collect::<Vec<f64>>();
    let polar = || {
        let parts = (btree_set(0..=18u32, 0..4), 0..=4u32, 14..=18u32);
        parts.prop_map(move |(mut steps, first, last)| {
            steps.extend([first, 9, last]);
            angles(steps.into_iter().map(|step| 5 * step).collect())
        })
    };
    let azimuth = (btree_set(0..12u32, 0..4), select(vec![180u32, 330]));
    let azimuth = azimuth.prop_map(move |(steps, last)| {
        let all = steps.into_iter().map(|step| 30 * step).chain((0..=last).step_by(90));
        angles(all.filter(|angle| *angle <= last).collect())
    });
    let values = uniform2(vec(0.01..2.0f64, 6 * 6 * 7));
    let parts = (polar(), polar(), azimuth, values);
    parts.prop_map(|(incident, polar, azimuth, values)| ScatterTable {
        incident,
        polar,
        azimuth,
        values,
    })
}

impl ScatterTable {
    fn csv(&self) -> String {
        let mut text =
            "# random\nphi_s_deg, btdf_per_sr, theta_i_deg,theta_s_deg,brdf_per_sr\n".to_owned();
        let mut values = self.values[0].iter().zip(&self.values[1]);
        for from in &self.incident {
            for to in &self.polar {
                for turn in &self.azimuth {
                    let (brdf, btdf) = values.next().unwrap();
                    _ = writeln!(text, "{turn}, {btdf},{from},{to},{brdf}");
                }
            }
        }
        text
    }

    /// Azimuths once around, deg, with the places of their values: those up to 180 deg alone stand for both sides.
    fn around(&self) -> Vec<(f64, usize)> {
        let mut all: Vec<(f64, usize)> = self.azimuth.iter().copied().zip(0..).collect();
        if all.iter().all(|(at, _)| *at <= 180.0) {
            let images = all.clone().into_iter().filter(|(at, _)| *at > 0.0 && *at < 180.0);
            all.extend(images.map(|(at, place)| (360.0 - at, place)));
        }
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all
    }

    /// ∫∫ f cos θ dω cos θ dω over arriving and leaving light, of the function that is linear between the angles, sr.
    fn energy(&self, values: &[f64]) -> f64 {
        let knots = self.around();
        let turn =
            |place: usize| knots[place % knots.len()].0 + 360.0 * (place / knots.len()) as f64;
        let mean = |row: &[f64]| -> f64 {
            // From the middle before an azimuth to that after it.
            let width = |k: usize| 0.5 * (turn(k + knots.len() + 1) - turn(k + knots.len() - 1));
            let parts =
                knots.iter().enumerate().map(|(k, (_, place))| width(k) / 360.0 * row[*place]);
            parts.sum()
        };
        let means: Vec<f64> = values.chunks(self.azimuth.len()).map(mean).collect();
        let leaving = means.chunks(self.polar.len()).take(self.incident.len());
        let leaving: Vec<f64> = leaving.map(|means| over_hemisphere(&self.polar, means)).collect();
        over_hemisphere(&self.incident, &leaving)
    }

    /// Whether a matrix has the light of the values, and near each angle a value between those of the angles beside it.
    fn is_in(&self, matrix: &BsdfMatrix, values: &[f64]) -> Verdict {
        let PatchPairs::Isotropic { incident, leaving } = &matrix.pairs else {
            return Err(TestCaseError::fail("the sample has a grain"));
        };
        let [_, count] = matrix.pairs.counts();
        let weighted = |(at, value): (usize, &f64)| {
            value
                * matrix.pairs.incident_projected(at / count)
                * matrix.pairs.leaving_projected(at % count)
        };
        let found: f64 = matrix.values.iter().enumerate().map(weighted).sum();
        let expected = self.energy(values);
        prop_assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
        let (patches, knots) = (DirectionPatches::Rings(leaving.clone()), self.around());
        let beside =
            |place: usize, all: &[f64]| place.saturating_sub(1)..=(place + 1).min(all.len() - 1);
        for (i, from) in self.incident.iter().enumerate() {
            let row = incident.ring(from.to_radians().sin().powi(2));
            for (s, to) in self.polar.iter().enumerate().filter(|(_, to)| **to >= 30.0) {
                for (k, (turn, _)) in knots.iter().enumerate() {
                    let cosines = to.to_radians().sin() * DVec2::from_angle(turn.to_radians());
                    let found = matrix.values[row * count + patches.patch(cosines)];
                    let mut range = [f64::INFINITY, 0.0f64];
                    for i in beside(i, &self.incident) {
                        for s in beside(s, &self.polar) {
                            for k in [k + knots.len() - 1, k, k + 1] {
                                let place = (i * self.polar.len() + s) * self.azimuth.len()
                                    + knots[k % knots.len()].1;
                                range = [range[0].min(values[place]), range[1].max(values[place])];
                            }
                        }
                    }
                    let is_between = found >= range[0] - 1e-9 && found <= range[1] + 1e-9;
                    prop_assert!(is_between, "{from} {to} {turn}: {found}, {range:?}");
                }
            }
        }
        Ok(())
    }
}

/// 2π ∫ f sin θ cos θ dθ from 0 to 90 deg by Simpson's rule, where f is linear between angles and constant beyond them.
fn over_hemisphere(angles_deg: &[f64], values: &[f64]) -> f64 {
    const STEPS: u32 = 512;
    let mut knots = vec![(0.0, values[0])];
    knots.extend(angles_deg.iter().map(|angle| angle.to_radians()).zip(values.iter().copied()));
    knots.push((FRAC_PI_2, values[values.len() - 1]));
    let segment = |pair: &[(f64, f64)]| {
        let [(from, low), (to, high)] = [pair[0], pair[1]];
        let at = |step: u32| {
            let share = f64::from(step) / f64::from(STEPS);
            (low + share * (high - low)) * (2.0 * (from + share * (to - from))).sin()
        };
        let sum: f64 = (0..STEPS).step_by(2).map(|n| at(n) + 4.0 * at(n + 1) + at(n + 2)).sum();
        PI * sum * (to - from) / f64::from(3 * STEPS)
    };
    knots.windows(2).map(segment).sum()
}

/// Patches of the Klems quarter basis.
const KLEMS: usize = 41;
const DIRECTIONS: [&str; 4] =
    ["Reflection Front", "Transmission Front", "Reflection Back", "Transmission Back"];

/// A BSDF file of values by arriving and leaving patch.
fn xml(layout: &str, direction: &str, values: &[f64]) -> String {
    let value = |row: usize, column: usize| match layout {
        "Rows" => values[row * KLEMS + column],
        _ => values[column * KLEMS + row],
    };
    let line = |row| (0..KLEMS).map(|column| value(row, column).to_string()).collect::<Vec<_>>();
    let data: String = (0..KLEMS).map(|row| line(row).join(",\t") + ",\n").collect();
    let basis = "LBNL/Klems Quarter";
    format!(
        "<WindowElement><Optical><Layer><DataDefinition><IncidentDataStructure>{layout}</IncidentDataStructure></DataDefinition>\n\
         <WavelengthData><Wavelength>Visible</Wavelength><WavelengthDataBlock>\n\
         <WavelengthDataDirection>{direction}</WavelengthDataDirection>\n\
         <ColumnAngleBasis>{basis}</ColumnAngleBasis><RowAngleBasis>{basis}</RowAngleBasis>\n\
         <ScatteringData>\n{data}</ScatteringData></WavelengthDataBlock></WavelengthData></Layer></Optical></WindowElement>\n"
    )
}

proptest! {
    #![proptest_config(config(24))]

    #[test]
    fn tables_of_scatter_keep_their_light_and_values(table in scatter_table()) {
        let file = parse(table.csv().as_bytes(), ScatterFormat::Csv)?;
        prop_assert_eq!(&file.back.reflection, &file.front.reflection);
        prop_assert!(file.back.transmission.is_none());
        let size = table.incident.len() * table.polar.len() * table.azimuth.len();
        table.is_in(&file.front.reflection.unwrap(), &table.values[0][..size])?;
        table.is_in(&file.front.transmission.unwrap(), &table.values[1][..size])?;
    }

    #[test]
    fn matrices_over_klems_patches_come_back(
        layout in select(vec!["Columns", "Rows"]),
        chosen in 0..DIRECTIONS.len(),
        powers in vec(-12.0..3.0f64, KLEMS * KLEMS),
    ) {
        let values: Vec<f64> = powers.into_iter().map(|power| 10f64.powf(power)).collect();
        let file = parse(xml(layout, DIRECTIONS[chosen], &values).as_bytes(), ScatterFormat::Xml)?;
        let (front, back) = (file.front, file.back);
        let sides = [front.reflection, front.transmission, back.reflection, back.transmission];
        for (place, side) in sides.into_iter().enumerate() {
            let found = side.map(|matrix| (matrix.pairs.counts(), matrix.values));
            let expected = (place == chosen).then(|| ([KLEMS; 2], values.clone()));
            prop_assert!(found == expected, "{} in {layout}", DIRECTIONS[place]);
        }
    }
}
