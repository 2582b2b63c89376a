//! The text of a measured table: comments of the form `# key = value`, and rows of cells with their lines.

use lumiduct_base::error::{Error, Result};
use std::path::Path;

/// Longest file that is read, bytes.
const MAX_BYTES: u64 = 256 << 20;

/// A table as text.
#[derive(Debug)]
pub(crate) struct TextTable {
    /// Keys and values of comments, with their line, from 1.
    pub(crate) comments: Vec<(String, String, usize)>,
    /// Cells with their line, from 1; lines without any are left out.
    pub(crate) rows: Vec<(usize, Vec<String>)>,
    /// The file, for messages.
    file: String,
}

impl TextTable {
    /// Reads a file.
    ///
    /// # Errors
    ///
    /// [`Error::Usage`] if it cannot be read, is too long or not UTF-8, or holds no row.
    pub(crate) fn read(path: &Path) -> Result<Self> {
        let file = path.display().to_string();
        let failed = |source| {
            let why = "check the name and the permissions";
            Error::Usage(format!("{file}: the file cannot be read: {source}; {why}"))
        };
        if std::fs::metadata(path).map_err(failed)?.len() > MAX_BYTES {
            let most = MAX_BYTES >> 20;
            return Err(Error::Usage(format!(
                "{file}: more than {most} MiB; average neighbouring values before"
            )));
        }
        let bytes = std::fs::read(path).map_err(failed)?;
        let text = String::from_utf8(bytes).map_err(|error| {
            let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
            let end = line_end(error.as_bytes());
            let line = 1 + good.iter().filter(|byte| **byte == end).count();
            Error::Usage(format!("{file}:{line}: not UTF-8 text; save the file as CSV UTF-8"))
        })?;
        Self::parse(file, &text)
    }

    /// Splits a text. Cells are separated by semicolons, tabs, commas or blanks, whichever of these, in this order, the first
    /// row has. Only commas that separate nothing may be decimal commas.
    pub(crate) fn parse(file: String, text: &str) -> Result<Self> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let (mut comments, mut rows) = (Vec::new(), Vec::new());
        let mut separator = None;
        for (place, line) in text.split(char::from(line_end(text.as_bytes()))).enumerate() {
            if let Some(comment) = line.trim_start().strip_prefix('#') {
                if let Some((key, value)) = comment.split_once('=') {
                    let [key, value] = [key, value].map(|part| part.trim().to_lowercase());
                    comments.push((key, value, place + 1));
                }
                continue;
            }
            if line.trim().is_empty() {
                continue;
            }
            let has = |letter: &char| line.contains(*letter);
            let separator =
                *separator.get_or_insert_with(|| [';', '\t', ','].into_iter().find(has));
            let plain = |cell: &str| {
                let cell = cell.trim().trim_matches('"');
                if separator == Some(',') { cell.to_owned() } else { cell.replace(',', ".") }
            };
            let cells: Vec<String> = match separator {
                Some(letter) => line.split(letter).map(plain).collect(),
                None => line.split_whitespace().map(plain).collect(),
            };
            rows.push((place + 1, cells));
        }
        if rows.is_empty() {
            return Err(Error::Usage(format!("{file}: no values; expected a table")));
        }
        Ok(Self { comments, rows, file })
    }

    /// The value and line of a comment.
    pub(crate) fn comment(&self, key: &str) -> Option<(&str, usize)> {
        let found = self.comments.iter().find(|(own, ..)| own == key);
        found.map(|(_, value, line)| (value.as_str(), *line))
    }

    /// A refusal of the file as a whole.
    pub(crate) fn refuse(&self, why: impl AsRef<str>) -> Error {
        Error::Usage(format!("{}: {}", self.file, why.as_ref()))
    }

    /// A refusal of a line.
    pub(crate) fn refuse_line(&self, line: usize, why: impl AsRef<str>) -> Error {
        Error::Usage(format!("{}:{line}: {}", self.file, why.as_ref()))
    }

    /// A finite number in a line.
    pub(crate) fn number(&self, line: usize, cell: &str) -> Result<f64> {
        let number: Option<f64> = cell.parse().ok().filter(|value: &f64| value.is_finite());
        number.ok_or_else(|| self.refuse_line(line, format!("`{cell}` is not a finite number")))
    }

    /// A value of light in a line, not below 0; NaN for an empty cell or `nan`, where nothing was measured.
    pub(crate) fn value(&self, line: usize, cell: &str) -> Result<f64> {
        if cell.is_empty() || cell.eq_ignore_ascii_case("nan") {
            return Ok(f64::NAN);
        }
        let value = self.number(line, cell)?;
        if value < 0.0 {
            return Err(self.refuse_line(
                line,
                format!(
                    "the value `{cell}` is below 0; set readings below the dark level to 0, or leave the cell empty where \
                     nothing was measured"
                ),
            ));
        }
        Ok(value)
    }
}

/// The end of lines: LF, also after CR, or CR alone.
fn line_end(bytes: &[u8]) -> u8 {
    if bytes.contains(&b'\n') { b'\n' } else { b'\r' }
}
