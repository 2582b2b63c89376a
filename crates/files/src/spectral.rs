//! Properties by wavelength from CSV: spectra, refractive indices, absorption.
//!
//! The first line names the columns, separated by commas. The first column is the wavelength: `nm`, `wavelength_nm` or
//! `lambda_nm` in nm, or `um` or `wavelength_um` in µm. Empty lines and lines that start with # are left out. A reader never
//! trusts a file: whatever it contains, the result is rows or a [`SpectralError`].
//!
//! ```
//! use lumiduct_files::spectral::{SpectralColumn, parse};
//!
//! let csv = "# PMMA\num,n,k\n0.4,1.508,2.3e-7\n0.5,1.497,2.1e-7\n";
//! let index = parse(csv.as_bytes(), SpectralColumn::Named(&["n"]))?;
//! assert_eq!(index.rows, [[400.0, 1.508], [500.0, 1.497]]); // nm, 1
//! # Ok::<(), lumiduct_files::spectral::SpectralError>(())
//! ```

use crate::bytes::{NOT_UTF8, read_file, utf8};
use std::path::Path;

/// Longest file that is read, bytes.
pub const MAX_SPECTRAL_BYTES: u64 = 16 << 20;
/// Most rows of a file.
const MOST_ROWS: usize = 100_000;
/// Names of the first column, and its unit, nm.
const WAVELENGTHS: [(&str, f64); 5] = [
    ("nm", 1.0),
    ("wavelength_nm", 1.0),
    ("lambda_nm", 1.0),
    ("um", 1000.0),
    ("wavelength_um", 1000.0),
];

/// Why a file of properties by wavelength could not be read.
#[derive(Debug, thiserror::Error)]
pub enum SpectralError {
    /// The operating system refuses the file.
    #[error("the file cannot be read: {0}; check the name and the permissions")]
    Unreadable(#[from] std::io::Error),
    /// The file is longer than [`MAX_SPECTRAL_BYTES`].
    #[error("the file has more than {} MiB", MAX_SPECTRAL_BYTES >> 20)]
    TooLong,
    /// The file violates its format.
    #[error("not a usable table by wavelength: line {line}: {problem}")]
    Violated {
        /// The line, from 1.
        line: usize,
        /// What is wrong.
        problem: String,
    },
}

/// Which column of a file is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpectralColumn<'a> {
    /// The one of the first of these names that there is.
    Named(&'a [&'a str]),
    /// The second one, whatever its name.
    Second,
}

/// A column by wavelength.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectralValues {
    /// Name of the column.
    pub name: String,
    /// Wavelength, nm, strictly ascending, and value; at least two rows.
    pub rows: Vec<[f64; 2]>,
}

/// Reads a column of a file.
///
/// # Errors
///
/// [`SpectralError`] if the file cannot be read, has no such column, or is no table of numbers by ascending wavelength.
pub fn read(path: &Path, column: SpectralColumn<'_>) -> Result<SpectralValues, SpectralError> {
    let bytes = read_file(path, MAX_SPECTRAL_BYTES)?.ok_or(SpectralError::TooLong)?;
    parse(&bytes, column)
}

/// Reads a column from the bytes of a file.
///
/// # Errors
///
/// [`SpectralError::Violated`] with the line.
pub fn parse(bytes: &[u8], column: SpectralColumn<'_>) -> Result<SpectralValues, SpectralError> {
    let wrong = |line, problem: String| SpectralError::Violated { line, problem };
    let text = utf8(bytes).map_err(|line| wrong(line, NOT_UTF8.to_owned()))?;
    let lines = text.lines().enumerate().map(|(index, line)| (index + 1, line.trim()));
    let mut lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let Some((head_line, head)) = lines.next() else {
        return Err(wrong(1, "the file is empty".to_owned()));
    };
    let names: Vec<&str> = head.split(',').map(str::trim).collect();
    let unit = WAVELENGTHS.iter().find(|(name, _)| names[0].eq_ignore_ascii_case(name));
    let Some((_, unit)) = unit else {
        let problem = format!(
            "the first column is `{}`; it must be the wavelength, named nm, wavelength_nm, lambda_nm, um or wavelength_um",
            names[0].escape_debug()
        );
        return Err(wrong(head_line, problem));
    };
    let place = match column {
        SpectralColumn::Named(wanted) => {
            let place = |name: &str| names.iter().position(|own| own.eq_ignore_ascii_case(name));
            let missing = || {
                let (wanted, found) =
                    (wanted.join("` or `"), names.join("`, `").escape_debug().to_string());
                wrong(head_line, format!("there is no column `{wanted}`; found: `{found}`"))
            };
            wanted.iter().find_map(|name| place(name)).ok_or_else(missing)?
        }
        SpectralColumn::Second => 1,
    };
    let Some(name) = names.get(place) else {
        return Err(wrong(head_line, "there is no second column".to_owned()));
    };
    let mut rows: Vec<[f64; 2]> = Vec::new();
    for (line, text) in lines {
        let words: Vec<&str> = text.split(',').map(str::trim).collect();
        if words.len() != names.len() {
            let problem = format!("it has {} columns instead of {}", words.len(), names.len());
            return Err(wrong(line, problem));
        }
        let number = |word: &str| match word.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            Ok(_) => Err(wrong(line, format!("{word} is not a finite number"))),
            Err(_) => Err(wrong(line, format!("`{}` is not a number", word.escape_debug()))),
        };
        let row = [unit * number(words[0])?, number(words[place])?];
        if row[0] <= 0.0 {
            return Err(wrong(line, format!("{} is not a wavelength", words[0])));
        }
        if rows.last().is_some_and(|before| before[0] >= row[0]) {
            return Err(wrong(line, "wavelengths must ascend".to_owned()));
        }
        if rows.len() == MOST_ROWS {
            return Err(wrong(line, format!("more than {MOST_ROWS} rows")));
        }
        rows.push(row);
    }
    if rows.len() < 2 {
        return Err(wrong(head_line, "fewer than two wavelengths follow".to_owned()));
    }
    Ok(SpectralValues { name: (*name).to_owned(), rows })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bytes::tests::mutants;

    const INDEX: SpectralColumn<'_> = SpectralColumn::Named(&["n"]);

    fn problem(text: &str, column: SpectralColumn<'_>) -> String {
        parse(text.as_bytes(), column)
            .map_or_else(|error| error.to_string(), |found| format!("{found:?}"))
    }

    #[test]
    fn columns_are_found_by_name_and_wavelengths_by_unit() {
        let text = "\u{feff}# a comment\n\nUm, k, N\n0.4, 1e-7, 1.51\n0.7, 2e-7, 1.49\n";
        let found = parse(text.as_bytes(), INDEX).unwrap();
        assert_eq!(
            found,
            SpectralValues { name: "N".into(), rows: vec![[400.0, 1.51], [700.0, 1.49]] }
        );
        let found =
            parse(text.as_bytes(), SpectralColumn::Named(&["absorption_per_mm", "k"])).unwrap();
        assert_eq!(found.name, "k");
        assert_eq!(parse(text.as_bytes(), SpectralColumn::Second).unwrap().name, "k");
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        for (text, part) in [
            ("", "line 1: the file is empty"),
            ("wavelength,n\n", "line 1: the first column is `wavelength`"),
            ("nm,mu\n400,1\n", "line 1: there is no column `n`; found: `nm`, `mu`"),
            ("nm,n\n400,1.5\n", "line 1: fewer than two"),
            ("nm,n\n400,1.5\n500\n", "line 3: it has 1 columns instead of 2"),
            ("nm,n\n400,1.5\n500,x\n", "line 3: `x` is not a number"),
            ("nm,n\n400,1.5\n500,inf\n", "line 3: inf is not a finite number"),
            ("nm,n\n500,1.5\n400,1.5\n", "line 3: wavelengths must ascend"),
            ("nm,n\n0,1.5\n400,1.5\n", "line 2: 0 is not a wavelength"),
        ] {
            let found = problem(text, INDEX);
            assert!(found.contains(part), "{text:?}: {found}");
        }
        assert!(problem("nm\n400\n500\n", SpectralColumn::Second).contains("no second column"));
        let latin = parse(b"nm,n\n400,1.5\n500,\xe4\n", INDEX).unwrap_err().to_string();
        assert!(latin.contains("line 3: it is not UTF-8"), "{latin}");
    }

    #[test]
    fn damaged_files_are_read_or_refused() {
        let original = "nm,n,k\n400,1.508,2.3e-7\n500,1.497,2.1e-7\n600,1.491,2.2e-7\n";
        let (mut read, mut refused) = (0, 0);
        for bytes in mutants(original.as_bytes(), 100_000, 1) {
            match parse(&bytes, INDEX) {
                Ok(found) => {
                    assert!(found.rows.windows(2).all(|pair| pair[0][0] < pair[1][0]));
                    assert!(found.rows.iter().flatten().all(|number| number.is_finite()));
                    read += 1;
                }
                Err(_) => refused += 1,
            }
        }
        assert!(read > 1000 && refused > 1000, "{read} {refused}");
    }
}
