//! Values of arguments, with their units.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use lumiduct_core::plan::MOST_RECORDS;
use lumiduct_core::transport::Shard;
use std::time::Duration;

/// A count with an optional k, M or G.
pub(super) fn parse_count(text: &str) -> Result<u64, String> {
    let (digits, factor) = match text.char_indices().last() {
        Some((at, 'k' | 'K')) => (&text[..at], 1e3),
        Some((at, 'm' | 'M')) => (&text[..at], 1e6),
        Some((at, 'g' | 'G')) => (&text[..at], 1e9),
        _ => (text, 1.0),
    };
    let value: f64 =
        digits.parse().map_err(|_| format!("`{text}` is not a count; try 500k or 2M"))?;
    let count = value * factor;
    // Beyond 2^53 a count is no longer exact, and no run is that long.
    if !(1.0..=9e15).contains(&count) {
        return Err(format!("`{text}` is out of range, expected 1 to 9e15"));
    }
    // 1.0001k is 1000.1; products of decimal fractions are slightly inexact.
    if (count - count.round()).abs() > 1e-9 * count {
        return Err(format!("`{text}` is not a whole number"));
    }
    Ok(count.round() as u64)
}

/// A count of gather paths that have to fit into memory.
pub(super) fn parse_records(text: &str) -> Result<u64, String> {
    let count = parse_count(text)?;
    if count > MOST_RECORDS {
        return Err(format!(
            "`{text}` is out of range, expected up to {MOST_RECORDS}: each takes about 350 bytes in every thread"
        ));
    }
    Ok(count)
}

/// A relative error with its percent sign: without one, 0.5 might mean half a percent or a half.
pub(super) fn parse_percent(text: &str) -> Result<f64, String> {
    let value = text.strip_suffix('%').and_then(|digits| digits.trim().parse::<f64>().ok());
    let fraction = 0.01 * value.ok_or_else(|| format!("`{text}` is not a percentage; try 0.5%"))?;
    if fraction > 0.0 && fraction < 1.0 {
        Ok(fraction)
    } else {
        Err(format!("`{text}` is out of range, expected above 0 and below 100%"))
    }
}

/// A time: 60s, 5min or 1h; plain numbers are seconds.
pub(super) fn parse_time(text: &str) -> Result<Duration, String> {
    let (digits, factor) = if let Some(digits) = text.strip_suffix("min") {
        (digits, 60.0)
    } else if let Some(digits) = text.strip_suffix('h') {
        (digits, 3600.0)
    } else {
        (text.strip_suffix('s').unwrap_or(text), 1.0)
    };
    let value: f64 =
        digits.trim().parse().map_err(|_| format!("`{text}` is not a time; try 60s or 5min"))?;
    let seconds = value * factor;
    if seconds > 0.0
        && let Ok(time) = Duration::try_from_secs_f64(seconds)
    {
        return Ok(time);
    }
    Err(format!("`{text}` is out of range, expected a time above 0"))
}

/// A radius above 0, mm.
pub(super) fn parse_radius(text: &str) -> Result<f64, String> {
    parse_between(text, "a radius", f64::INFINITY, "a finite number above 0")
}

/// A length above 0, mm.
pub(super) fn parse_length(text: &str) -> Result<f64, String> {
    parse_between(text, "a length", f64::INFINITY, "a finite number above 0")
}

/// An angle above 0 and below 90 degrees.
pub(super) fn parse_angle(text: &str) -> Result<f64, String> {
    parse_between(text, "an angle", 90.0, "above 0 and below 90")
}

fn parse_between(text: &str, what: &str, below: f64, expected: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| format!("`{text}` is not {what}"))?;
    if value > 0.0 && value < below {
        Ok(value)
    } else {
        Err(format!("`{text}` is out of range, expected {expected}"))
    }
}

/// A finite number.
pub(super) fn parse_number(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| format!("`{text}` is not a number"))?;
    if value.is_finite() { Ok(value) } else { Err(format!("`{text}` is not finite")) }
}

/// A number of standard errors above 0.
pub(super) fn parse_sigmas(text: &str) -> Result<f64, String> {
    parse_between(text, "a number of errors", f64::INFINITY, "a finite number above 0")
}

/// One of some words, and its value.
pub(super) fn words<T: Clone + Send + Sync + 'static>(
    names: impl IntoIterator<Item = &'static str>,
    named: fn(&str) -> Option<T>,
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(names.into_iter().map(PossibleValue::new))
        .try_map(move |name| named(&name).ok_or_else(|| format!("`{name}` is not known")))
}

/// A part of a piece of work: 3/16 is the third of sixteen.
pub(super) fn parse_shard(text: &str) -> Result<Shard, String> {
    let wrong = || format!("`{text}` is not a part; try 1/4, 2/4, 3/4 and 4/4 for four parts");
    let (number, count) = text.split_once('/').ok_or_else(wrong)?;
    let parse = |digits: &str| digits.parse::<u64>().map_err(|_| wrong());
    Shard::new(parse(number)?, parse(count)?).ok_or_else(wrong)
}

/// A step of an angle, in degrees.
pub(super) fn parse_step(text: &str) -> Result<f64, String> {
    parse_within(text, [0.1, 45.0])
}

/// A refractive index.
pub(super) fn parse_index(text: &str) -> Result<f64, String> {
    parse_within(text, [1.0, 4.0])
}

fn parse_within(text: &str, [least, most]: [f64; 2]) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| format!("`{text}` is not a number"))?;
    if (least..=most).contains(&value) {
        Ok(value)
    } else {
        Err(format!("`{text}` is out of range, expected {least} to {most}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_percentages_and_times_are_read_with_their_units() {
        assert_eq!(parse_count("2M"), Ok(2_000_000));
        assert_eq!(parse_count("1.5k"), Ok(1500));
        assert!(
            parse_count("0").is_err() && parse_count("nan").is_err() && parse_count("M").is_err()
        );
        assert!(parse_count("2.5").is_err() && parse_count("1.0001k").is_err());
        assert_eq!(parse_count("0.3k"), Ok(300));
        assert_eq!(parse_records("4M"), Ok(4_000_000));
        assert!(parse_records("5M").unwrap_err().contains("4194304"));
        assert_eq!(parse_percent("0.5%"), Ok(0.005));
        for wrong in ["100%", "-1%", "0.5", "%", "nan%"] {
            assert!(parse_percent(wrong).is_err(), "{wrong}");
        }
        assert_eq!(parse_time("5min"), Ok(Duration::from_secs(300)));
        assert!(parse_time("0s").is_err() && parse_time("inf").is_err());
    }

    #[test]
    fn parts_are_counted_from_one() {
        assert_eq!(parse_shard("3/16"), Ok(Shard::new(3, 16).unwrap()));
        for wrong in ["0/4", "5/4", "1/0", "1", "a/b", "-1/4", "1/4/4"] {
            assert!(parse_shard(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn radii_and_angles_have_their_ranges() {
        assert_eq!(parse_radius("0.5"), Ok(0.5));
        assert_eq!(parse_angle("89.9"), Ok(89.9));
        for wrong in ["0", "-1", "nan", "inf", "1mm"] {
            assert!(parse_radius(wrong).is_err() && parse_angle(wrong).is_err(), "{wrong}");
        }
        assert!(parse_angle("90").is_err());
    }
}
