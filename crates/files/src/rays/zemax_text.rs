//! Source files of OpticStudio as text: the number of rays and the code of the unit of length, then a ray a line.

use crate::rays::lines::RayLines;
use crate::rays::source::{Opened, RaySource};
use crate::rays::zemax::unit_mm;
use crate::rays::{FileRay, RayFileError, RayFormat, RaySetInfo};
use lumiduct_base::units::FluxUnit;

/// The lines of a file.
#[derive(Debug)]
pub(crate) struct ZemaxLines {
    lines: RayLines,
    to_mm: f32,
    /// Rays that the first line promises.
    count: u64,
    read: u64,
}

impl ZemaxLines {
    pub(crate) fn open(source: Box<dyn RaySource>) -> Result<Opened<Self>, RayFileError> {
        let mut lines = RayLines::new(source, RayFormat::Zemax);
        let head = lines.next()?.unwrap_or_default();
        let words: Vec<&str> = head.split_whitespace().collect();
        let read = match words[..] {
            [count, code, ..] => count.parse().ok().zip(code.parse().ok().and_then(unit_mm)),
            _ => None,
        };
        let Some((count, to_mm)) = read else {
            return Err(lines.wrong(
                "neither a binary file, which begins with 1010, nor text with the number of rays and a unit (0 to 4: m, in, cm, ft, mm) in its first line",
            ));
        };
        if count == 0 {
            return Err(lines.wrong("it has no rays"));
        }
        let info = RaySetInfo {
            count,
            unit: FluxUnit::Watt,
            flux: 0.0,
            luminous_flux_lm: None,
            is_measured: false,
            texts: Vec::new(),
        };
        let remarks = vec![
            "it is text, which does not state the unit of its flux; W is assumed, and wavelengths after the flux are not used"
                .to_owned(),
        ];
        Ok(Opened { info, remarks, rays: Self { lines, to_mm, count, read: 0 } })
    }

    pub(crate) fn next(&mut self) -> Option<Result<FileRay, RayFileError>> {
        match self.lines.next() {
            Err(error) => Some(Err(error)),
            Ok(Some(line)) if self.read < self.count => {
                self.read += 1;
                Some(self.ray(&line).map_err(|problem| self.lines.wrong(problem)))
            }
            Ok(None) if self.read == self.count => None,
            Ok(found) => {
                let what = if found.is_some() { "more" } else { "fewer" };
                let promised = self.count;
                let problem =
                    format!("there are {what} rays than the {promised} of the first line");
                Some(Err(self.lines.wrong(problem)))
            }
        }
    }

    fn ray(&self, line: &str) -> Result<FileRay, String> {
        let mut words = line.split_whitespace();
        let mut numbers = [0.0f32; 7];
        for number in &mut numbers {
            let word = words.next().ok_or("a ray has seven numbers: x y z l m n flux")?;
            *number = word.parse().map_err(|_| format!("`{word}` is not a number"))?;
        }
        numbers[..3].iter_mut().for_each(|own| *own *= self.to_mm);
        FileRay::checked(numbers)
    }
}
