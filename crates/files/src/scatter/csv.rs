//! CSV of an isotropic sample, a row for each pair of directions.

use crate::bytes::repeated;
use crate::scatter::angles::SampledScatter;
use crate::scatter::coverage::expect_covered;
use crate::scatter::data::{BsdfMatrix, ScatterFile, ScatterSide};
use crate::scatter::error::{Violation, value};
use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, TAU};

const ANGLES: [&str; 3] = ["theta_i_deg", "theta_s_deg", "phi_s_deg"];
const BRDF: &str = "brdf_per_sr";
const BTDF: &str = "btdf_per_sr";
/// Most pairs of directions of a file.
const MOST_PAIRS: usize = 1 << 22;

/// Combinations of angles that may be missing in any file, for an error that names one.
const FEW_PAIRS: usize = 4096;

/// Values of one kind by incident polar angle, leaving polar angle and azimuth.
type Samples = BTreeMap<[AngleKey; 3], f64>;

/// An angle in units of 1e-6 deg: what a file means by the same angle.
type AngleKey = u32;

const UNITS_PER_DEG: f64 = 1e6;

/// Whether the first line of the table names an angle of incidence.
pub(super) fn has_angles(text: &str) -> bool {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    rows(text).next().is_some_and(|(_, head)| head.to_ascii_lowercase().contains("theta_i"))
}

/// Lines with their numbers, without comments and empty ones.
fn rows(text: &str) -> impl Iterator<Item = (usize, &str)> {
    // With LF, CRLF or CR at their ends.
    let lines = if text.contains('\n') { text.split('\n') } else { text.split('\r') };
    let lines = lines.enumerate().map(|(index, line)| (index + 1, line.trim()));
    lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
}

pub(super) fn read(text: &str) -> Result<ScatterFile, Violation> {
    let mut lines = rows(text);
    let (head_line, head) = lines.next().unwrap_or((1, ""));
    let names: Vec<&str> = head.split(',').map(str::trim).collect();
    if let Some(name) = repeated(&names, &[ANGLES[0], ANGLES[1], ANGLES[2], BRDF, BTDF]) {
        let problem = format!("the column `{name}` is there twice; remove one of them");
        return Err(Violation::new(head_line, problem));
    }
    let place = |name: &str| names.iter().position(|own| own.eq_ignore_ascii_case(name));
    let missing = |name: &str| {
        let problem = format!(
            "there is no column `{name}`; needed are {}, and {BRDF}, {BTDF} or both, separated by commas",
            ANGLES.join(", ")
        );
        Violation::new(head_line, problem)
    };
    let mut places = [0; 3];
    for (at, name) in places.iter_mut().zip(ANGLES) {
        *at = place(name).ok_or_else(|| missing(name))?;
    }
    let kinds = [place(BRDF), place(BTDF)];
    if kinds == [None, None] {
        return Err(missing(BRDF));
    }
    let mut samples = [Samples::new(), Samples::new()];
    let mut lines = lines.peekable();
    let first_line = lines.peek().map_or(head_line, |(number, _)| *number);
    for (number, line) in lines {
        let words: Vec<&str> = line.split(',').map(str::trim).collect();
        if words.len() != names.len() {
            let problem = format!(
                "it has {} columns instead of {}; commas separate them, and numbers have a decimal point",
                words.len(),
                names.len()
            );
            return Err(Violation::new(number, problem));
        }
        let mut angles = [0; 3];
        for (axis, at) in places.iter().enumerate() {
            angles[axis] = angle(words[*at], ANGLES[axis], [90.0, 90.0, 360.0][axis], number)?;
        }
        for (own, at) in samples.iter_mut().zip(kinds) {
            let Some(at) = at else { continue };
            if own.insert(angles, value(words[at], number)?).is_some() {
                return Err(Violation::new(number, "the same directions are in a line before"));
            }
        }
        if samples[0].len().max(samples[1].len()) > MOST_PAIRS {
            return Err(Violation::new(number, format!("more than {MOST_PAIRS} rows")));
        }
    }
    let mut remarks: Vec<String> = Vec::new();
    let mut matrix = |own: &Samples, at: Option<usize>| {
        at.map(|_| {
            let (matrix, assumed) = averaged(own, [head_line, first_line])?;
            for remark in assumed {
                if !remarks.contains(&remark) {
                    remarks.push(remark);
                }
            }
            Ok(matrix)
        })
        .transpose()
    };
    let [brdf, btdf] = samples;
    let [reflection, transmission] = [matrix(&brdf, kinds[0])?, matrix(&btdf, kinds[1])?];
    if reflection.is_some() {
        remarks.push("both sides reflect as measured on one".to_owned());
    }
    let back = ScatterSide { reflection: reflection.clone(), transmission: None };
    Ok(ScatterFile { front: ScatterSide { reflection, transmission }, back, remarks })
}

fn angle(word: &str, name: &str, most: f64, line: usize) -> Result<AngleKey, Violation> {
    let angle = word.parse::<f64>().ok().filter(|angle| (0.0..=most).contains(angle));
    let angle = angle.ok_or_else(|| {
        Violation::new(line, format!("{name} is `{word}`, expected a number from 0 to {most}"))
    })?;
    Ok((angle * UNITS_PER_DEG).round() as AngleKey)
}

/// The values over patches, and what was assumed.
fn averaged(
    samples: &Samples,
    [head_line, first_line]: [usize; 2],
) -> Result<(BsdfMatrix, Vec<String>), Violation> {
    if samples.is_empty() {
        return Err(Violation::new(head_line, "no rows follow the names of the columns"));
    }
    let axis = |axis: usize| {
        let mut all: Vec<AngleKey> = samples.keys().map(|angles| angles[axis]).collect();
        all.sort_unstable();
        all.dedup();
        all
    };
    let keys = [axis(0), axis(1), axis(2)];
    let count: usize = keys.iter().map(Vec::len).product();
    // Only azimuths of the zenith may be missing, which at most doubles the number.
    if count > 2 * samples.len() + FEW_PAIRS {
        let [i, s, phi] = keys.map(|own| own.len());
        let problem = format!(
            "{} rows for {i} theta_i, {s} theta_s and {phi} phi_s; each combination of the angles needs one",
            samples.len()
        );
        return Err(Violation::new(head_line, problem));
    }
    let mut values = Vec::with_capacity(count);
    for from in &keys[0] {
        for to in &keys[1] {
            for turn in &keys[2] {
                let found = value_at(samples, [*from, *to, *turn]);
                values.push(found.ok_or_else(|| missing([*from, *to, *turn], head_line))?);
            }
        }
    }
    if may_be_radians(&keys) {
        let problem = "all its angles could be in radians, and they are in degrees: multiply them by 180/π, or, if they are in \
            degrees, add rows at a larger angle";
        return Err(Violation::new(head_line, problem.to_owned()));
    }
    let [incident, polar, azimuth] =
        keys.map(|keys| keys.into_iter().map(|key| f64::from(key) / UNITS_PER_DEG).collect());
    let sampled = SampledScatter { incident, polar, azimuth, values, line: first_line };
    expect_covered(&sampled).map_err(|problem| Violation::new(head_line, problem))?;
    sampled.matrix().ok_or_else(|| Violation::new(head_line, "its angles make no patches"))
}

/// Whether all angles are within the range of radians, and some are above 0.
fn may_be_radians(keys: &[Vec<AngleKey>; 3]) -> bool {
    const ROUNDING: f64 = 0.01;
    let lasts = keys.each_ref().map(|keys| f64::from(keys[keys.len() - 1]) / UNITS_PER_DEG);
    let most = [FRAC_PI_2, FRAC_PI_2, TAU].map(|most| most + ROUNDING);
    lasts.iter().any(|last| *last > 0.0) && lasts.iter().zip(most).all(|(last, most)| *last <= most)
}

/// The value of a combination of angles. At the zenith all azimuths are one direction.
fn value_at(samples: &Samples, [from, to, turn]: [AngleKey; 3]) -> Option<f64> {
    let own = samples.get(&[from, to, turn]);
    let any = || samples.range([from, 0, 0]..=[from, 0, AngleKey::MAX]).next();
    let found = own.or_else(|| if to == 0 { any().map(|(_, value)| value) } else { None });
    found.copied()
}

fn missing(keys: [AngleKey; 3], head_line: usize) -> Violation {
    let [i, s, phi] = keys.map(|key| f64::from(key) / UNITS_PER_DEG);
    let problem = format!(
        "there is no row for theta_i {i}, theta_s {s} and phi_s {phi} deg; each combination of the angles needs one"
    );
    Violation::new(head_line, problem)
}
