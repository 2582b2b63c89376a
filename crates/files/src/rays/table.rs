//! CSV with a ray a line, its columns named in the first line that is not a comment.

use crate::bytes::repeated;
use crate::rays::lines::RayLines;
use crate::rays::source::{Opened, RaySource};
use crate::rays::{FileRay, RayFileError, RayFormat, RaySetInfo, RayText};
use lumiduct_base::units::FluxUnit;
use std::io::{self, Write};

/// Columns of position and direction.
const COLUMNS: [&str; 6] = ["x_mm", "y_mm", "z_mm", "dx", "dy", "dz"];
const LUMENS: &str = "flux_lm";
const WATTS: &str = "flux_w";

/// The lines of a file.
#[derive(Debug)]
pub(crate) struct RayTable {
    lines: RayLines,
    /// Number of columns.
    columns: usize,
    /// Places of position, direction and flux.
    places: [usize; 7],
}

impl RayTable {
    /// Reads the names of the columns, and all rays once to count them.
    pub(crate) fn open(source: Box<dyn RaySource>) -> Result<Opened<Self>, RayFileError> {
        let mut lines = RayLines::new(source, RayFormat::Csv);
        let head = line(&mut lines)?.unwrap_or_default();
        let names: Vec<&str> = head.split(',').map(word).collect();
        let known = [&COLUMNS[..], &[LUMENS, WATTS]].concat();
        if let Some(name) = repeated(&names, &known) {
            return Err(
                lines.wrong(format!("the column `{name}` is there twice; remove one of them"))
            );
        }
        let place = |name: &str| names.iter().position(|own| own.eq_ignore_ascii_case(name));
        let missing = |what: String| {
            let commas = if names.len() < 7 { "; commas separate columns" } else { "" };
            let columns = COLUMNS.join(", ");
            lines.wrong(format!(
                "there is no column {what}; needed are {columns}, and {LUMENS} or {WATTS}{commas}"
            ))
        };
        let (unit, flux_at) = match (place(LUMENS), place(WATTS)) {
            (Some(_), Some(_)) => {
                let problem =
                    format!("it has both columns `{LUMENS}` and `{WATTS}`; remove one of them");
                return Err(lines.wrong(problem));
            }
            (Some(at), None) => (FluxUnit::Lumen, at),
            (None, Some(at)) => (FluxUnit::Watt, at),
            (None, None) => return Err(missing(format!("`{LUMENS}` or `{WATTS}`"))),
        };
        let mut places = [flux_at; 7];
        for (at, name) in places.iter_mut().zip(COLUMNS) {
            *at = place(name).ok_or_else(|| missing(format!("`{name}`")))?;
        }
        let columns = names.len();
        let no_rays = lines.wrong("no rays follow the names of the columns");
        let mut table = Self { lines, columns, places };
        let (mut count, mut flux) = (0, 0.0);
        while let Some(ray) = table.next() {
            count += 1;
            flux += f64::from(ray?.flux);
        }
        if count == 0 {
            return Err(no_rays);
        }
        table.lines.rewind()?;
        _ = line(&mut table.lines)?;
        let mut remarks = Vec::new();
        if columns > places.len() {
            remarks.push("its further columns are not used".to_owned());
        }
        let info = RaySetInfo {
            count,
            unit,
            flux,
            luminous_flux_lm: None,
            is_measured: false,
            texts: Vec::new(),
        };
        Ok(Opened { info, remarks, rays: table })
    }

    pub(crate) fn next(&mut self) -> Option<Result<FileRay, RayFileError>> {
        let line = line(&mut self.lines).transpose()?;
        Some(line.and_then(|line| self.ray(&line).map_err(|problem| self.lines.wrong(problem))))
    }

    fn ray(&self, line: &str) -> Result<FileRay, String> {
        let words: Vec<&str> = line.split(',').map(word).collect();
        if words.len() != self.columns {
            return Err(format!("it has {} columns instead of {}", words.len(), self.columns));
        }
        let mut numbers = [0.0f32; 7];
        for (number, place) in numbers.iter_mut().zip(self.places) {
            let word = words[place];
            *number = word.parse().map_err(|_| format!("`{word}` is not a number"))?;
        }
        FileRay::checked(numbers)
    }
}

/// The next line that is not a comment.
fn line(lines: &mut RayLines) -> Result<Option<String>, RayFileError> {
    loop {
        match lines.next()? {
            Some(line) if line.starts_with('#') => {}
            found => return Ok(found),
        }
    }
}

/// A word of a line without the quotes that some programs write around every one.
fn word(text: &str) -> &str {
    text.trim().trim_matches('"')
}

/// Writes the texts as comments, and the names of the columns.
pub(crate) fn write_header(out: &mut dyn Write, info: &RaySetInfo) -> io::Result<()> {
    for kind in RayText::ALL {
        if let Some(text) = info.text(kind) {
            let line = text.split(char::is_control).collect::<Vec<_>>().join(" ");
            writeln!(out, "# {}: {line}", kind.name())?;
        }
    }
    let flux = match info.unit {
        FluxUnit::Lumen => LUMENS,
        FluxUnit::Watt => WATTS,
    };
    writeln!(out, "{},{flux}", COLUMNS.join(","))
}
