//! Source files of OpticStudio as text: the number of rays and the code of the unit of length, then a ray a line.

use crate::rays::source::{Opened, RaySource};
use crate::rays::zemax::unit_mm;
use crate::rays::{FileRay, RayFileError, RayFormat, RaySetInfo};
use lumiduct_base::units::FluxUnit;
use std::io::{BufRead, BufReader, Read};

const FORMAT: RayFormat = RayFormat::Zemax;
/// Longest line, bytes.
const LONGEST: u64 = 1 << 16;

/// The lines of a file.
#[derive(Debug)]
pub(crate) struct ZemaxLines {
    source: BufReader<Box<dyn RaySource>>,
    to_mm: f32,
    /// Rays that the first line promises.
    count: u64,
    read: u64,
    line: u64,
}

impl ZemaxLines {
    pub(crate) fn open(source: Box<dyn RaySource>) -> Result<Opened<Self>, RayFileError> {
        let mut lines =
            Self { source: BufReader::new(source), to_mm: 1.0, count: 0, read: 0, line: 0 };
        let head = lines.line()?.unwrap_or_default();
        // Editors may write a byte-order mark.
        let words: Vec<&str> = head.trim_start_matches('\u{feff}').split_whitespace().collect();
        let read = match words[..] {
            [count, code, ..] => count.parse().ok().zip(code.parse().ok().and_then(unit_mm)),
            _ => None,
        };
        let Some((count, to_mm)) = read else {
            let problem = "neither a binary file, which begins with 1010, nor text with the number of rays and a unit (0 to 4: m, in, cm, ft, mm) in its first line";
            return Err(RayFileError::in_line(FORMAT, lines.line, problem));
        };
        if count == 0 {
            return Err(RayFileError::in_line(FORMAT, lines.line, "it has no rays"));
        }
        (lines.count, lines.to_mm) = (count, to_mm);
        let info = RaySetInfo {
            count,
            unit: FluxUnit::Watt,
            flux: 0.0,
            luminous_flux_lm: None,
            texts: Vec::new(),
        };
        let remarks =
            vec!["it is text, which does not state the unit of its flux; W is assumed".to_owned()];
        Ok(Opened { info, remarks, rays: lines })
    }

    pub(crate) fn next(&mut self) -> Option<Result<FileRay, RayFileError>> {
        match self.line() {
            Err(error) => Some(Err(error)),
            Ok(Some(line)) if self.read < self.count => {
                self.read += 1;
                Some(self.ray(&line))
            }
            Ok(None) if self.read == self.count => None,
            Ok(found) => {
                let what = if found.is_some() { "more" } else { "fewer" };
                let problem =
                    format!("there are {what} rays than the {} of the first line", self.count);
                Some(Err(RayFileError::in_line(FORMAT, self.line, problem)))
            }
        }
    }

    fn ray(&self, line: &str) -> Result<FileRay, RayFileError> {
        let wrong = |problem: String| RayFileError::in_line(FORMAT, self.line, problem);
        let mut words = line.split_whitespace();
        let mut numbers = [0.0f32; 7];
        for number in &mut numbers {
            let word = words
                .next()
                .ok_or_else(|| wrong("a ray has seven numbers: x y z l m n flux".to_owned()))?;
            *number = word.parse().map_err(|_| wrong(format!("`{word}` is not a number")))?;
        }
        numbers[..3].iter_mut().for_each(|own| *own *= self.to_mm);
        FileRay::checked(numbers).map_err(wrong)
    }

    /// The next line that is not blank.
    fn line(&mut self) -> Result<Option<String>, RayFileError> {
        loop {
            let mut bytes = Vec::new();
            self.line += 1;
            (&mut self.source).take(LONGEST).read_until(b'\n', &mut bytes)?;
            if bytes.is_empty() {
                return Ok(None);
            }
            if bytes.len() as u64 == LONGEST {
                let problem = format!("a line has more than {LONGEST} bytes");
                return Err(RayFileError::in_line(FORMAT, self.line, problem));
            }
            let text = String::from_utf8_lossy(&bytes);
            if !text.trim().is_empty() {
                return Ok(Some(text.trim().to_owned()));
            }
        }
    }
}
