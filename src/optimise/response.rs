//! How the light of zones answers to openings at the points of a law: a matrix that is fitted to the measured designs.
//!
//! Light leaves a hole aslant and meets a sensor beside it, and what one hole takes the others lack. So the light of a zone follows
//! openings elsewhere too (docs/optimise.md, equations 1 and 2). The first guess is the share of each point in the lengths at the zone, and
//! the flux of a guide that light passes once; each pair of measured designs corrects it by linear regression with a Gaussian prior
//! (Bishop, "Pattern Recognition and Machine Learning", 2006, section 3.3), one measurement at a time.

use crate::optimise::feedback::ZoneLight;
use crate::optimise::law::SizeLaw;

/// Standard deviation, before any measurement, of the share of a point in the light of a zone at its place, 1.
const SHARE_DEVIATION: f64 = 0.5;
/// Deviation of the linear model, as a share of the change of the openings, 1.
const NONLINEARITY: f64 = 0.02;
/// Least change of the openings, as a logarithm, from which the fit takes something.
const LEAST_CHANGE: f64 = 1e-6;

/// A measured design: openings at the points of the law, as logarithms, and the light of the zones.
#[derive(Debug, Clone)]
pub(crate) struct MeasuredOpenings<'a> {
    pub(crate) openings: Vec<f64>,
    pub(crate) light: ZoneLight<'a>,
}

/// Change of the logarithm of the light of each zone by the logarithm of the openings at each point: a row for each zone.
pub(crate) fn fit_response(
    law: &SizeLaw,
    zones: &[f64],
    designs: &[MeasuredOpenings<'_>],
) -> Vec<Vec<f64>> {
    let shares: Vec<Vec<f64>> = zones.iter().map(|zone| law.shares(*zone)).collect();
    let Some(last) = designs.last() else { return shares };
    let flux = flux_response(&last.light, &shares);
    let width = zones.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
    let row = |zone: usize| {
        let mut row: Vec<f64> =
            shares[zone].iter().zip(&flux[zone]).map(|(own, flux)| own + flux).collect();
        let near = law
            .points
            .iter()
            .map(|point| (SHARE_DEVIATION * (-(point - zones[zone]).abs() / width).exp()).powi(2));
        let mut covariance = outer(&flux[zone]);
        for (place, variance) in near.enumerate() {
            covariance[place][place] += variance;
        }
        for pair in designs.windows(2) {
            add_pair(&mut row, &mut covariance, [&pair[0], &pair[1]], zone);
        }
        row
    };
    (0..zones.len()).map(row).collect()
}

/// Change of the logarithm of the flux in the guide at each zone: what zones before it take is missing there.
fn flux_response(light: &ZoneLight<'_>, shares: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let (taken, left) = light.shares_taken();
    let count = shares.first().map_or(0, Vec::len);
    let row = |zone: usize| {
        let mut row = vec![0.0; count];
        for before in 0..=zone {
            let part = if before == zone { 0.5 } else { 1.0 };
            let change = -part * taken[before] / left[zone];
            row.iter_mut().zip(&shares[before]).for_each(|(own, share)| *own += change * share);
        }
        row
    };
    (0..shares.len()).map(row).collect()
}

/// Corrects a row and its covariance by the change of the light of a zone between two designs.
fn add_pair(
    row: &mut [f64],
    covariance: &mut [Vec<f64>],
    [old, new]: [&MeasuredOpenings<'_>; 2],
    zone: usize,
) {
    let change: Vec<f64> =
        new.openings.iter().zip(&old.openings).map(|(new, old)| new - old).collect();
    let [before, after] = [old, new].map(|own| own.light.measured[zone]);
    let largest = change.iter().fold(0.0_f64, |most, own| most.max(own.abs()));
    if largest < LEAST_CHANGE || before.value <= 0.0 || after.value <= 0.0 {
        return;
    }
    let along: Vec<f64> = covariance.iter().map(|own| dot(own, &change)).collect();
    let noise = [before, after].map(|own| (own.std_error / own.value).powi(2));
    let variance = dot(&along, &change)
        + noise[0]
        + noise[1]
        + NONLINEARITY * NONLINEARITY * dot(&change, &change);
    let surprise = (after.value / before.value).ln() - dot(row, &change);
    for (place, own) in along.iter().enumerate() {
        row[place] += own * surprise / variance;
        for (other, beside) in covariance[place].iter_mut().zip(&along) {
            *other -= own * beside / variance;
        }
    }
}

fn dot(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).map(|(one, other)| one * other).sum()
}

fn outer(numbers: &[f64]) -> Vec<Vec<f64>> {
    numbers.iter().map(|one| numbers.iter().map(|other| one * other).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumiduct_input::LawKind;
    use lumiduct_report::optimise::Uncertain;

    const ZONES: [f64; 6] = [0.0, 10.0, 20.0, 30.0, 40.0, 50.0];

    /// Light of zones that get a part of the openings before them, without noise to speak of.
    fn light(openings: &[f64], spill: f64) -> Vec<Uncertain> {
        let opened = |zone: usize| openings[zone].exp();
        let value =
            |zone: usize| (1.0 - spill) * opened(zone) + spill * opened(zone.saturating_sub(1));
        (0..6).map(|zone| Uncertain { value: value(zone), std_error: 1e-6 }).collect()
    }

    fn response(spill: f64, designs: &[[f64; 6]]) -> Vec<Vec<f64>> {
        let law = SizeLaw::over(LawKind::Table, &ZONES, [0.0, 50.0]);
        let lights: Vec<Vec<Uncertain>> = designs.iter().map(|own| light(own, spill)).collect();
        let designs: Vec<MeasuredOpenings<'_>> = designs
            .iter()
            .zip(&lights)
            .map(|(openings, measured)| MeasuredOpenings {
                openings: openings.to_vec(),
                light: ZoneLight { measured, wanted: &[1.0; 6], efficiency: 0.0 },
            })
            .collect();
        fit_response(&law, &ZONES, &designs)
    }

    #[test]
    fn without_a_change_the_first_guess_remains() {
        let found = response(0.4, &[[0.1; 6], [0.1; 6]]);
        for (zone, row) in found.iter().enumerate() {
            assert!(
                row.iter().enumerate().all(|(at, own)| *own == f64::from(u8::from(at == zone)))
            );
        }
    }

    #[test]
    fn light_that_falls_beside_its_openings_is_found() {
        let designs = [
            [0.0; 6],
            [0.0, 0.1, 0.0, 0.0, 0.1, 0.0],
            [0.1, 0.1, 0.0, 0.1, 0.1, 0.0],
            [0.1, 0.1, 0.1, 0.1, 0.1, 0.1],
            [0.1, 0.0, 0.1, 0.2, 0.1, 0.0],
        ];
        let found = response(0.4, &designs);
        for zone in 1..6 {
            let [before, own] = [found[zone][zone - 1], found[zone][zone]];
            assert!((before - 0.4).abs() < 0.1 && (own - 0.6).abs() < 0.1, "{zone}: {found:?}");
        }
    }

    #[test]
    fn what_zones_take_is_missing_in_those_behind_them() {
        let (measured, law) =
            (light(&[0.0; 6], 0.0), SizeLaw::over(LawKind::Table, &ZONES, [0.0, 50.0]));
        let light = ZoneLight { measured: &measured, wanted: &[1.0; 6], efficiency: 0.6 };
        let found =
            fit_response(&law, &ZONES, &[MeasuredOpenings { openings: vec![0.0; 6], light }]);
        // A tenth leaves in each zone: 0.45 is left at the middle of the last.
        assert!((found[5][0] + 0.1 / 0.45).abs() < 1e-9 && found[0][5] == 0.0, "{found:?}");
    }
}
