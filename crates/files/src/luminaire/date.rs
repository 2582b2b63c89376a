//! Dates in the texts of luminaire files.

/// English names of the months.
const MONTHS: [&str; 12] = [
    "january",
    "february",
    "march",
    "april",
    "may",
    "june",
    "july",
    "august",
    "september",
    "october",
    "november",
    "december",
];
/// Least letters of the name of a month.
const MONTH_LETTERS: usize = 3;

/// The date at the start of a text, as year-month-day (ISO 8601). `None` if there is none, or if day and month cannot be told apart: of
/// dates in numbers only those that begin with the year, or have points as in `25.11.2024`, are known.
pub(crate) fn iso_date(text: &str) -> Option<String> {
    let text = text.trim();
    let is_separator = |letter: char| !letter.is_alphanumeric();
    let mut words = text.split(is_separator).filter(|word| !word.is_empty());
    let [first, second, third] = [words.next()?, words.next()?, words.next()?];
    let (year, month, day) = if let Some(year) = year(first) {
        // A time may follow the day.
        let day = third.split(['T', 't']).next().unwrap_or(third);
        (year, number(second)?, number(day)?)
    } else if let Some(month) = month(second) {
        (year(third)?, month, number(first)?)
    } else if let Some(month) = month(first) {
        (year(third)?, month, number(second)?)
    } else if text.starts_with(&format!("{first}.{second}.{third}")) {
        (year(third)?, number(second)?, number(first)?)
    } else {
        return None;
    };
    let is_leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    let days = match month {
        2 if is_leap => 29,
        2 => 28,
        4 | 6 | 9 | 11 => 30,
        _ => 31,
    };
    let is_date = year > 0 && (1..=12).contains(&month) && (1..=days).contains(&day);
    is_date.then(|| format!("{year:04}-{month:02}-{day:02}"))
}

/// A number of up to four digits.
fn number(word: &str) -> Option<u32> {
    let is_number = word.len() <= 4 && word.bytes().all(|byte| byte.is_ascii_digit());
    if is_number { word.parse().ok() } else { None }
}

fn year(word: &str) -> Option<u32> {
    number(word).filter(|_| word.len() == 4)
}

/// The month of a name or its first letters, from 1.
fn month(word: &str) -> Option<u32> {
    let word = word.to_ascii_lowercase();
    let place = MONTHS.iter().position(|name| name.starts_with(&word))?;
    (word.len() >= MONTH_LETTERS).then_some(place as u32 + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_found_and_ambiguous_ones_are_not() {
        for (text, expected) in [
            ("2024-11-25", Some("2024-11-25")),
            (" 2024/2/29 by hand", Some("2024-02-29")),
            ("25.11.2024/Meier", Some("2024-11-25")),
            ("25-NOV-2024", Some("2024-11-25")),
            ("5 September 2019", Some("2019-09-05")),
            ("May 5, 2019", Some("2019-05-05")),
            ("June 5, 2019", Some("2019-06-05")),
            ("2024-11-25T10:00:00", Some("2024-11-25")),
            ("11/25/2024", None),
            ("11-05-2024", None),
            ("2023-02-29", None),
            ("2024-13-01", None),
            ("2024-00-10", None),
            ("0000-01-01", None),
            ("31.4.2024", None),
            ("25.11.24", None),
            ("25 Novembre 2024", None),
            ("2025", None),
            ("", None),
            ("Übung", None),
        ] {
            assert_eq!(iso_date(text).as_deref(), expected, "{text}");
        }
    }
}
