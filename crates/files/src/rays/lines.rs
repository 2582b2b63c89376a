//! Lines of text files, of limited length.

use crate::rays::source::RaySource;
use crate::rays::{RayFileError, RayFormat};
use std::io::{self, BufRead, BufReader, Read, Seek};

/// Longest line, bytes.
const LONGEST: usize = 1 << 16;

/// The lines of a file.
#[derive(Debug)]
pub(crate) struct RayLines {
    source: BufReader<Box<dyn RaySource>>,
    format: RayFormat,
    /// The line read last, from 1.
    number: u64,
}

impl RayLines {
    pub(crate) fn new(source: Box<dyn RaySource>, format: RayFormat) -> Self {
        Self { source: BufReader::new(source), format, number: 0 }
    }

    /// The next line that is not blank, without blanks around it; `None` at the end. What is not UTF-8 is replaced.
    pub(crate) fn next(&mut self) -> Result<Option<String>, RayFileError> {
        loop {
            let mut bytes = Vec::new();
            self.number += 1;
            (&mut self.source).take(LONGEST as u64 + 1).read_until(b'\n', &mut bytes)?;
            if bytes.is_empty() {
                return Ok(None);
            }
            if bytes.len() > LONGEST {
                let cause = if bytes.contains(&b'\r') {
                    "; lines must end in LF or CRLF, and these end in CR alone"
                } else {
                    ""
                };
                return Err(self.wrong(format!("it has more than {LONGEST} bytes{cause}")));
            }
            let text = String::from_utf8_lossy(&bytes);
            let text = text.strip_prefix('\u{feff}').unwrap_or(&text).trim();
            if !text.is_empty() {
                return Ok(Some(text.to_owned()));
            }
        }
    }

    /// A violation in the line read last.
    pub(crate) fn wrong(&self, problem: impl Into<String>) -> RayFileError {
        let place = format!("line {}", self.number);
        RayFileError::Violated { format: self.format, place, problem: problem.into() }
    }

    /// Goes back to the first line.
    pub(crate) fn rewind(&mut self) -> io::Result<()> {
        self.number = 0;
        self.source.rewind()
    }
}
