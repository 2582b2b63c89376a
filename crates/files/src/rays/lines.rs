//! Lines of text files, of limited length.

use crate::rays::source::RaySource;
use crate::rays::{RayFileError, RayFormat};
use std::io::{self, BufRead, BufReader, Seek};

/// Longest line, bytes.
const LONGEST: usize = 1 << 16;

/// The lines of a file.
#[derive(Debug)]
pub(crate) struct RayLines {
    source: BufReader<Box<dyn RaySource>>,
    format: RayFormat,
    /// The line read last, from 1.
    number: u64,
    /// Whether it ended in CR: an LF that follows is part of the same end.
    is_after_cr: bool,
}

impl RayLines {
    pub(crate) fn new(source: Box<dyn RaySource>, format: RayFormat) -> Self {
        Self { source: BufReader::new(source), format, number: 0, is_after_cr: false }
    }

    /// The next line that is not blank, without blanks around it; `None` at the end. What is not UTF-8 is replaced.
    pub(crate) fn next(&mut self) -> Result<Option<String>, RayFileError> {
        loop {
            self.number += 1;
            let Some(bytes) = self.bytes()? else { return Ok(None) };
            if bytes.len() > LONGEST {
                return Err(self.wrong(format!("it has more than {LONGEST} bytes")));
            }
            let text = String::from_utf8_lossy(&bytes);
            let text = text.strip_prefix('\u{feff}').unwrap_or(&text).trim();
            if !text.is_empty() {
                return Ok(Some(text.to_owned()));
            }
        }
    }

    /// The bytes up to the next end of a line: LF, CRLF or CR. Of a line that is too long only the beginning; `None` at the end.
    fn bytes(&mut self) -> io::Result<Option<Vec<u8>>> {
        let mut bytes = Vec::new();
        if std::mem::take(&mut self.is_after_cr) && self.source.fill_buf()?.starts_with(b"\n") {
            self.source.consume(1);
        }
        loop {
            let read = self.source.fill_buf()?;
            let end = read.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
            let length = end.unwrap_or(read.len());
            bytes.extend_from_slice(&read[..length]);
            self.is_after_cr = read.get(length) == Some(&b'\r');
            self.source.consume(length + usize::from(end.is_some()));
            match end {
                Some(_) => return Ok(Some(bytes)),
                None if length == 0 => return Ok((!bytes.is_empty()).then_some(bytes)),
                None if bytes.len() > LONGEST => return Ok(Some(bytes)),
                None => {}
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
        self.is_after_cr = false;
        self.source.rewind()
    }
}
