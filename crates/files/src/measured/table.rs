//! The text of a measured table: comments of the form `# key = value`, and rows of cells with their lines.

use crate::measured::error::MeasuredError;
use std::borrow::Cow;

/// Excess of an angle that is rounding, deg.
const ANGLE_ROUNDING: f64 = 1e-6;

/// A table as text.
#[derive(Debug)]
pub(super) struct TextTable<'a> {
    /// Keys and values of comments, with their line, from 1.
    comments: Vec<(String, String, usize)>,
    /// Rows with at least one cell; the first is the head, where there is one.
    pub(super) rows: Vec<TextRow<'a>>,
}

/// A row of a table.
#[derive(Debug)]
pub(super) struct TextRow<'a> {
    /// The line, from 1.
    pub(super) line: usize,
    /// The cells, with decimal points.
    pub(super) cells: Vec<Cow<'a, str>>,
}

/// The text of a file, without a byte order mark.
pub(super) fn text(bytes: &[u8]) -> Result<&str, MeasuredError> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let end = line_end(bytes);
        let line = 1 + bytes[..error.valid_up_to()].iter().filter(|byte| **byte == end).count();
        MeasuredError::of_line(line, "not UTF-8 text; save the file as CSV UTF-8")
    })?;
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}

impl<'a> TextTable<'a> {
    /// Splits a text. Cells are separated by semicolons, tabs, commas or blanks, whichever of these, in this order, the first
    /// row has. Only commas that separate nothing may be decimal commas.
    pub(super) fn new(text: &'a str) -> Result<Self, MeasuredError> {
        let (mut comments, mut rows, mut tab_lines) = (Vec::new(), Vec::new(), Vec::new());
        let mut separator = None;
        let empty = |_: &'a str| Cow::Borrowed("");
        for (place, line) in text.split(char::from(line_end(text.as_bytes()))).enumerate() {
            if let Some(comment) = line.trim_start().strip_prefix('#') {
                if let Some((key, value)) = comment.split_once('=') {
                    let [key, value] = [key, value].map(|part| part.trim().to_lowercase());
                    comments.push((key, value, place + 1));
                }
                continue;
            }
            if line.trim().is_empty() {
                if line.contains('\t') {
                    tab_lines.push(place + 1);
                    rows.push(TextRow {
                        line: place + 1,
                        cells: line.split('\t').map(empty).collect(),
                    });
                }
                continue;
            }
            let has = |letter: &char| line.contains(*letter);
            let separator =
                *separator.get_or_insert_with(|| [';', '\t', ','].into_iter().find(has));
            let plain = |cell: &'a str| {
                let cell = cell.trim().trim_matches('"');
                if separator != Some(',') && cell.contains(',') {
                    Cow::Owned(cell.replace(',', "."))
                } else {
                    Cow::Borrowed(cell)
                }
            };
            // Without this a row has room for four cells, which is most of the memory of a long file of one column.
            let mut cells = Vec::with_capacity(match separator {
                Some(letter) => line.matches(letter).count() + 1,
                None => line.split_whitespace().count(),
            });
            match separator {
                Some(letter) => cells.extend(line.split(letter).map(plain)),
                None => cells.extend(line.split_whitespace().map(plain)),
            }
            rows.push(TextRow { line: place + 1, cells });
        }
        retain_unmeasured(&mut rows, &tab_lines, separator.flatten());
        if rows.is_empty() {
            let last = text.lines().count().max(1);
            return Err(MeasuredError::of_line(
                last,
                "the file ends without values; expected a table",
            ));
        }
        Ok(Self { comments, rows })
    }

    /// The line of a row, or of the last one, from 1.
    pub(super) fn line(&self, row: usize) -> usize {
        self.rows[row.min(self.rows.len() - 1)].line
    }

    /// The value and line of a comment.
    pub(super) fn comment(&self, key: &str) -> Option<(&str, usize)> {
        let found = self.comments.iter().find(|(own, ..)| own == key);
        found.map(|(_, value, line)| (value.as_str(), *line))
    }
}

/// Leaves out lines of tabs alone, but in a matrix of numbers between tabs, where they are rows without a value.
fn retain_unmeasured(rows: &mut Vec<TextRow<'_>>, tab_lines: &[usize], separator: Option<char>) {
    let is_of_tabs = |row: &TextRow<'_>| tab_lines.binary_search(&row.line).is_ok();
    let first = rows.iter().find(|row| !is_of_tabs(row));
    let is_number = |cell: &Cow<'_, str>| cell.is_empty() || cell.parse::<f64>().is_ok();
    let matrix = first.filter(|row| separator == Some('\t') && row.cells.iter().all(is_number));
    let columns = matrix.map(|row| row.cells.len());
    rows.retain(|row| !is_of_tabs(row) || Some(row.cells.len()) == columns);
}

/// A finite number in a line.
pub(super) fn number(line: usize, cell: &str) -> Result<f64, MeasuredError> {
    let number = cell.parse::<f64>().ok().filter(|value| value.is_finite());
    number.ok_or_else(|| MeasuredError::of_line(line, format!("`{cell}` is not a finite number")))
}

/// A value of light in a line, not below 0; NaN for an empty cell or `nan`, where nothing was measured.
pub(super) fn value(line: usize, cell: &str) -> Result<f64, MeasuredError> {
    if cell.is_empty() || cell.eq_ignore_ascii_case("nan") {
        return Ok(f64::NAN);
    }
    let value = number(line, cell)?;
    if value < 0.0 {
        return Err(MeasuredError::of_line(
            line,
            format!(
                "the value `{cell}` is below 0; set readings below the dark level to 0, or leave the cell empty where \
                 nothing was measured"
            ),
        ));
    }
    Ok(value)
}

/// Refuses angles γ beyond a sphere.
///
/// # Errors
///
/// [`MeasuredError::WrongLine`] with the angle.
pub(super) fn expect_gamma(
    line: usize,
    angles: impl IntoIterator<Item = f64>,
) -> Result<(), MeasuredError> {
    let range = 0.0..=180.0 + ANGLE_ROUNDING;
    match angles.into_iter().find(|gamma| !range.contains(gamma)) {
        Some(gamma) => {
            Err(MeasuredError::of_line(line, format!("γ is {gamma} deg, expected 0 to 180 deg")))
        }
        None => Ok(()),
    }
}

/// The end of lines: LF, also after CR, or CR alone.
fn line_end(bytes: &[u8]) -> u8 {
    if bytes.contains(&b'\n') { b'\n' } else { b'\r' }
}
