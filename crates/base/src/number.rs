//! Number formatting for people: in pictures, in text reports and in verdicts, never in data files.
//!
//! Knows no units. Negative numbers have a true minus sign, powers of ten are written ×10ⁿ.

/// Exponents of ten from here on are written out: 10⁻⁴.
const FIRST_SMALL_EXPONENT: i32 = -4;
/// Exponents of ten from here on are written out: 10⁵.
const FIRST_LARGE_EXPONENT: i32 = 5;
/// Percentages below this would be zero at two decimals.
const LEAST_PERCENT: f64 = 0.01;
/// Percentages below this are rounding.
const FAINT_PERCENT: f64 = 1e-9;
/// Errors below this share of their value are rounding.
const FAINT_ERROR: f64 = 1e-9;
/// Most digits written with an error bar.
const MOST_DIGITS: i32 = 9;

/// A value with four significant digits, without trailing zeros: "0.8419", "12.5", "12346", "1.235×10⁻⁷".
pub fn format_value(value: f64) -> String {
    format_significant(value, 4)
}

/// A length in a message, with three significant digits, without trailing zeros: "2.41", "12.5", "1235".
pub fn format_length(value: f64) -> String {
    format_significant(value, 3)
}

/// The least sufficient length: three significant digits, rounded up, so that the number as written
/// suffices.
pub fn format_least_length(value: f64) -> String {
    if !(value.is_finite() && value > 0.0) {
        return format_length(value);
    }
    let scale = 10_f64.powi(2 - value.log10().floor() as i32);
    // Rounding in the last bits must not raise the third digit.
    format_length((value * scale * (1.0 - 1e-12)).ceil() / scale)
}

fn format_significant(value: f64, digits: i32) -> String {
    if !value.is_finite() {
        return not_finite(value).to_string();
    }
    let exponent = rounded_exponent(value, digits);
    if is_plain(exponent) {
        trimmed(format_fixed(value, (digits - 1 - exponent).max(0)))
    } else {
        let mantissa = trimmed(format_scaled(value, exponent, digits - 1));
        format!("{mantissa}×10{}", superscript(exponent))
    }
}

/// A value and its standard error, both with the digits that the error justifies: "0.8419 ±
/// 0.0006", "(1.234 ± 0.020)×10⁻⁷". An error at rounding level becomes 0: "100 ± 0".
///
/// The error has two digits up to 0.354 of its power of ten and one digit beyond (Particle Data
/// Group, Review of Particle Physics, introduction, section 5.3). An infinite value is written
/// alone.
pub fn format_with_error(value: f64, std_error: f64) -> String {
    if !value.is_finite() {
        return not_finite(value).to_string();
    }
    if !std_error.is_finite() {
        return format!("{} with unknown error", format_value(value));
    }
    let std_error = std_error.abs();
    if std_error == 0.0 {
        return format!("{} ± 0", format_value(value));
    }
    if std_error < FAINT_ERROR * value.abs() {
        return format!("{} ± 0", format_exact(value));
    }
    let (std_error, place) = round_error(std_error);
    let exponent = rounded_exponent(value.abs().max(std_error), MOST_DIGITS);
    if exponent - place >= MOST_DIGITS {
        return format!("{} ± {}", format_long(value, exponent), format_value(std_error));
    }
    if is_plain(exponent) {
        format!("{} ± {}", format_fixed(value, -place), format_fixed(std_error, -place))
    } else {
        let digits = exponent - place;
        let value = format_scaled(value, exponent, digits);
        format!(
            "({value} ± {})×10{}",
            format_scaled(std_error, exponent, digits),
            superscript(exponent)
        )
    }
}

/// A value that has no error bar, with at most nine digits: "0.75", "1200".
pub fn format_exact(value: f64) -> String {
    if value.is_finite() {
        format_long(value, rounded_exponent(value, MOST_DIGITS))
    } else {
        not_finite(value).to_string()
    }
}

/// A share of a whole, as percent with two decimals: "84.19 %"; more digits where that would give
/// zero: "1.25×10⁻⁴ %".
pub fn format_percent(share: f64) -> String {
    let percent = 100.0 * share;
    if share.is_finite() && (FAINT_PERCENT..LEAST_PERCENT).contains(&percent.abs()) {
        format!("{} %", format_value(percent))
    } else if share.is_finite() {
        format!("{} %", format_fixed(percent, 2))
    } else {
        not_finite(share).to_string()
    }
}

/// A value with a given number of decimals; a negative number rounds to tens, hundreds and so on.
pub fn format_fixed(value: f64, decimals: i32) -> String {
    let text = if decimals >= 0 {
        format!("{value:.*}", decimals as usize)
    } else {
        let unit = 10f64.powi(-decimals);
        format!("{:.0}", (value / unit).round() * unit)
    };
    match text.strip_prefix('-') {
        // A negative number that rounds to zero has no sign.
        Some(digits) if digits.chars().all(|c| c == '0' || c == '.') => digits.to_string(),
        Some(digits) => format!("−{digits}"),
        None => text,
    }
}

/// An integer in superscripts: "⁻⁷".
pub fn superscript(exponent: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    exponent
        .to_string()
        .chars()
        .map(|c| c.to_digit(10).map_or('⁻', |digit| DIGITS[digit as usize]))
        .collect()
}

/// A text cut to at most `longest` characters by removing the middle: `housin…et_12`.
pub fn shorten(text: &str, longest: usize) -> String {
    let letters: Vec<char> = text.chars().collect();
    if letters.len() <= longest {
        return text.to_string();
    }
    let kept = longest.saturating_sub(1);
    let head: String = letters[..kept.div_ceil(2)].iter().collect();
    let tail: String = letters[letters.len() - kept / 2..].iter().collect();
    format!("{head}…{tail}")
}

fn is_plain(exponent: i32) -> bool {
    FIRST_SMALL_EXPONENT < exponent && exponent < FIRST_LARGE_EXPONENT
}

fn not_finite(value: f64) -> &'static str {
    if value.is_nan() {
        "n/a"
    } else if value > 0.0 {
        "∞"
    } else {
        "−∞"
    }
}

/// The power of ten of a value after rounding to `digits` significant digits; 0 for zero.
fn rounded_exponent(value: f64, digits: i32) -> i32 {
    if value == 0.0 {
        return 0;
    }
    let text = format!("{value:.*e}", (digits - 1) as usize);
    let exponent = text.rsplit('e').next().and_then(|exponent| exponent.parse().ok());
    exponent.expect("Rust writes finite numbers with an exponent after the letter e")
}

/// The error rounded to one or two digits, and the power of ten of its last digit.
fn round_error(std_error: f64) -> (f64, i32) {
    let exponent = rounded_exponent(std_error, 3);
    let leading = std_error / 10f64.powi(exponent);
    let place = if leading < 3.55 { exponent - 1 } else { exponent };
    let unit = 10f64.powi(place);
    let rounded = (std_error / unit).round() * unit;
    // The very largest number cannot be rounded up.
    (if rounded.is_finite() { rounded } else { std_error }, place)
}

/// A value with the most digits ever written.
fn format_long(value: f64, exponent: i32) -> String {
    if is_plain(exponent) {
        trimmed(format_fixed(value, MOST_DIGITS - 1 - exponent))
    } else {
        let mantissa = trimmed(format_scaled(value, exponent, MOST_DIGITS - 1));
        format!("{mantissa}×10{}", superscript(exponent))
    }
}

fn format_scaled(value: f64, exponent: i32, decimals: i32) -> String {
    // In two steps: 10^-exponent alone overflows for the smallest numbers.
    let half = exponent / 2;
    format_fixed(value / 10f64.powi(half) / 10f64.powi(exponent - half), decimals)
}

fn trimmed(text: String) -> String {
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_string()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_have_four_digits_and_no_needless_zeros() {
        let cases = [
            (0.841_905_38, "0.8419"),
            (12.5, "12.5"),
            (-3.0, "−3"),
            (0.0, "0"),
            (-0.0, "0"),
            (9.99996, "10"),
            (12_345.6, "12346"),
            (99_999.6, "1×10⁵"),
            (123_456.0, "1.235×10⁵"),
            (0.001_234_5, "0.001234"),
            (1.234_56e-7, "1.235×10⁻⁷"),
            (-1e9, "−1×10⁹"),
            (5e-324, "4.941×10⁻³²⁴"),
            (f64::MAX, "1.798×10³⁰⁸"),
            (f64::NAN, "n/a"),
            (f64::NEG_INFINITY, "−∞"),
        ];
        for (value, text) in cases {
            assert_eq!(format_value(value), text);
        }
    }

    #[test]
    fn the_error_decides_the_digits_of_both() {
        let cases = [
            (0.841_905, 0.000_63, "0.8419 ± 0.0006"),
            (0.841_905, 0.000_12, "0.84191 ± 0.00012"),
            (0.841_905, 0.000_97, "0.8419 ± 0.0010"),
            (12_345.6, 123.0, "12350 ± 120"),
            (12.0, 3.0, "12.0 ± 3.0"),
            (12.0, 4.0, "12 ± 4"),
            (-0.2, 0.5, "−0.2 ± 0.5"),
            (1.234e-7, 2e-9, "(1.234 ± 0.020)×10⁻⁷"),
            (6.5e6, 4e4, "(6.50 ± 0.04)×10⁶"),
            (0.0, 0.004, "0.000 ± 0.004"),
            (0.5, 0.0, "0.5 ± 0"),
            (0.5, f64::NAN, "0.5 with unknown error"),
            (0.5, f64::INFINITY, "0.5 with unknown error"),
            (f64::INFINITY, f64::INFINITY, "∞"),
            (f64::NAN, 1.0, "n/a"),
            (1.0, f64::MAX, "(0.0 ± 1.8)×10³⁰⁸"),
            (0.841_905_381_23, 1e-13, "0.841905381 ± 0"),
        ];
        for (value, std_error, text) in cases {
            assert_eq!(format_with_error(value, std_error), text);
        }
    }

    #[test]
    fn exact_values_have_nine_digits_at_most() {
        let cases = [
            (0.75, "0.75"),
            (1200.0, "1200"),
            (1.0 / 3.0, "0.333333333"),
            (-2e6, "−2×10⁶"),
            (0.0, "0"),
            (f64::NAN, "n/a"),
        ];
        for (value, text) in cases {
            assert_eq!(format_exact(value), text);
        }
    }

    #[test]
    fn no_number_is_too_small_or_too_large() {
        for exponent in -320..=308 {
            let value: f64 = format!("3.3e{exponent}").parse().unwrap();
            for ratio in [1e-16, 1e-3, 1.0, 1e3] {
                let text = format_with_error(value, value * ratio);
                assert!(text.chars().count() < 40, "{value:e}: {text}");
            }
            assert!(format_value(value).chars().count() <= 12);
        }
    }

    #[test]
    fn shares_are_percent() {
        assert_eq!(format_percent(0.841_905), "84.19 %");
        assert_eq!(format_percent(-1e-13), "0.00 %");
        assert_eq!(format_percent(1.25e-6), "1.25×10⁻⁴ %");
        assert_eq!(format_percent(f64::NAN), "n/a");
    }

    #[test]
    fn long_names_lose_their_middle() {
        assert_eq!(shorten("pipe.wall", 12), "pipe.wall");
        assert_eq!(shorten("housing.inner_wall.facet_12", 12), "housin…et_12");
        assert_eq!(shorten("abc", 0), "…");
    }
}
