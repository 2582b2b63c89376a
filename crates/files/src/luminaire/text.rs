//! Texts of luminaire files: their encoding and their numbers.

/// The text of a file in UTF-8, in UTF-16 with a byte-order mark or, as many files are, in Windows-1252; with any line ends.
pub(crate) fn decoded(bytes: &[u8]) -> String {
    let units = |of: fn([u8; 2]) -> u16| -> Vec<u16> {
        bytes[2..].as_chunks::<2>().0.iter().map(|unit| of(*unit)).collect()
    };
    let text = if bytes.starts_with(b"\xff\xfe") {
        String::from_utf16_lossy(&units(u16::from_le_bytes))
    } else if bytes.starts_with(b"\xfe\xff") {
        String::from_utf16_lossy(&units(u16::from_be_bytes))
    } else {
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        match std::str::from_utf8(bytes) {
            Ok(text) => text.to_owned(),
            Err(_) => bytes.iter().map(|byte| WINDOWS_1252[usize::from(*byte)]).collect(),
        }
    };
    text.replace("\r\n", "\n").replace('\r', "\n")
}

/// The letters of Windows-1252, which differs from Latin-1 between 0x80 and 0x9f (WHATWG Encoding, index-windows-1252).
static WINDOWS_1252: [char; 256] = {
    let special = [
        '€', '\u{81}', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\u{8d}', 'Ž',
        '\u{8f}', '\u{90}', '‘', '’', '“', '”', '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\u{9d}',
        'ž', 'Ÿ',
    ];
    let mut all = ['\0'; 256];
    let mut place = 0;
    while place < 256 {
        all[place] =
            if place >= 0x80 && place < 0xa0 { special[place - 0x80] } else { place as u8 as char };
        place += 1;
    }
    all
};

/// A number with a decimal point, or a decimal comma as in some EULUMDAT files.
pub(crate) fn number(text: &str) -> Option<f64> {
    let value: f64 = text.trim().replace(',', ".").parse().ok()?;
    value.is_finite().then_some(value)
}

/// A count, which some files write with decimals.
pub(crate) fn whole(value: f64) -> Option<i64> {
    (value.fract() == 0.0 && value.abs() < 1e9).then_some(value as i64)
}

/// A number with seven significant digits, without an exponent: a thousand times finer than any goniometer.
pub(crate) fn seven_digits(value: f64) -> String {
    with_digits(value, 7)
}

/// A number with so many significant digits, without an exponent.
pub(crate) fn with_digits(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return "0".to_owned();
    }
    let decimals = (digits - 1 - value.abs().log10().floor() as i32).clamp(0, 12) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// Most letters of a keyword of LM-63 (LM-63-2002, 5.2).
pub(crate) const KEYWORD: usize = 18;

/// Whether a user may give a text with this keyword of LM-63: capital letters, digits, - and _, and none with a meaning of its own.
pub fn is_keyword(word: &str) -> bool {
    let is_letter = |letter: char| {
        letter.is_ascii_uppercase() || letter.is_ascii_digit() || "-_".contains(letter)
    };
    (1..=KEYWORD).contains(&word.len())
        && word.chars().all(is_letter)
        && !["MORE", "TILT", "BLOCK", "ENDBLOCK"].contains(&word)
}

/// A text on one line of at most this many letters.
pub(crate) fn one_line(text: &str, longest: usize) -> String {
    let flat: String =
        text.chars().map(|letter| if letter.is_control() { ' ' } else { letter }).collect();
    flat.trim().chars().take(longest).collect()
}

/// A remark if a file has letters beyond ASCII, which are written in UTF-8.
pub(crate) fn beyond_ascii(file: &str, what_is_known: &str) -> Option<String> {
    let remark =
        format!("texts have letters beyond ASCII, which are written in UTF-8; {what_is_known}");
    (!file.is_ascii()).then_some(remark)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_may_be_in_either_encoding() {
        assert_eq!(decoded("Leuchte 10° µ".as_bytes()), "Leuchte 10° µ");
        assert_eq!(decoded(b"Leuchte 10\xb0 \x80\x99"), "Leuchte 10° €™");
        assert_eq!(decoded(b"\xef\xbb\xbfIESNA"), "IESNA");
        assert_eq!(decoded(b"\xff\xfeI\0E\0\r\0"), "IE\n");
        assert_eq!(decoded(b"\xfe\xff\0I\0E"), "IE");
        assert_eq!(decoded(b"a\rb\r\nc\n"), "a\nb\nc\n");
    }

    #[test]
    fn numbers_have_a_point_or_a_comma_and_are_finite() {
        assert_eq!(number(" 12,5 "), Some(12.5));
        assert_eq!(number("1e3"), Some(1000.0));
        for wrong in ["", "x", "nan", "inf", "1,2,3"] {
            assert_eq!(number(wrong), None, "{wrong}");
        }
        assert_eq!([whole(3.0), whole(3.5), whole(1e12)], [Some(3), None, None]);
    }

    #[test]
    fn seven_digits_are_written_without_an_exponent() {
        assert_eq!(seven_digits(962.250_186_9), "962.2502");
        assert_eq!(seven_digits(1000.0), "1000");
        assert_eq!(seven_digits(123_456_789.0), "123456789");
        assert_eq!(seven_digits(1.5e-5), "0.000015");
        assert_eq!(seven_digits(0.0), "0");
    }
}
