//! CSV with a ray a line, its columns named in the first line that is not a comment.

use crate::rays::source::{Opened, RaySource};
use crate::rays::{FileRay, RayFileError, RayFormat, RaySetInfo, RayText};
use lumiduct_base::units::FluxUnit;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};

const FORMAT: RayFormat = RayFormat::Csv;
/// Columns of position and direction.
const COLUMNS: [&str; 6] = ["x_mm", "y_mm", "z_mm", "dx", "dy", "dz"];
const LUMENS: &str = "flux_lm";
const WATTS: &str = "flux_w";
/// Longest line, bytes.
const LONGEST: usize = 1 << 16;

type CsvReader = csv::Reader<Bounded<BufReader<Box<dyn RaySource>>>>;

/// The lines of a file.
#[derive(Debug)]
pub(crate) struct RayTable {
    reader: CsvReader,
    record: csv::StringRecord,
    /// Places of position, direction and flux.
    places: [usize; 7],
}

impl RayTable {
    /// Reads the names of the columns, and all rays once to count them.
    pub(crate) fn open(source: Box<dyn RaySource>) -> Result<Opened<Self>, RayFileError> {
        let mut reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .trim(csv::Trim::All)
            // A record is a line: an open quote would make the rest of the file one record, of any length.
            .quoting(false)
            .from_reader(Bounded { inner: BufReader::new(source), since_line_end: 0 });
        let begin = reader.position().clone();
        let head = match reader.headers() {
            Ok(head) => head.clone(),
            Err(error) => return Err(failed(&mut reader, &begin, error)),
        };
        let after = reader.position().clone();
        let line = line_of(&mut reader, &begin)?;
        let place = |name: &str| {
            let is_it = |own: &str| unquoted(own).eq_ignore_ascii_case(name);
            head.iter().position(|own| is_it(own.trim_start_matches('\u{feff}')))
        };
        let missing = |name: &str| {
            let commas = if head.len() < 7 { "; commas separate columns" } else { "" };
            let columns = COLUMNS.join(", ");
            let problem = format!(
                "there is no column `{name}`; needed are {columns}, and {LUMENS} or {WATTS}{commas}"
            );
            RayFileError::in_line(FORMAT, line, problem)
        };
        let needed = |name: &str| place(name).ok_or_else(|| missing(name));
        let (unit, flux_at) = match place(LUMENS) {
            Some(at) => (FluxUnit::Lumen, at),
            None => (
                FluxUnit::Watt,
                place(WATTS).ok_or_else(|| missing(&format!("{LUMENS}` or `{WATTS}")))?,
            ),
        };
        let mut places = [flux_at; 7];
        for (place, name) in places.iter_mut().zip(COLUMNS) {
            *place = needed(name)?;
        }
        let mut remarks = Vec::new();
        if head.len() > places.len() {
            remarks.push("its further columns are not used".to_owned());
        }
        reader.seek_raw(SeekFrom::Start(after.byte()), after.clone()).map_err(io::Error::from)?;
        let mut table = Self { reader, record: csv::StringRecord::new(), places };
        let (mut count, mut flux) = (0, 0.0);
        while let Some(ray) = table.next() {
            count += 1;
            flux += f64::from(ray?.flux);
        }
        if count == 0 {
            return Err(RayFileError::in_line(
                FORMAT,
                line,
                "no rays follow the names of the columns",
            ));
        }
        table.reader.seek_raw(SeekFrom::Start(after.byte()), after).map_err(io::Error::from)?;
        let info = RaySetInfo { count, unit, flux, luminous_flux_lm: None, texts: Vec::new() };
        Ok(Opened { info, remarks, rays: table })
    }

    pub(crate) fn next(&mut self) -> Option<Result<FileRay, RayFileError>> {
        let begin = self.reader.position().clone();
        match self.reader.read_record(&mut self.record) {
            Ok(false) => None,
            Ok(true) => Some(match self.ray() {
                Ok(ray) => Ok(ray),
                Err(problem) => Err(in_line(&mut self.reader, &begin, problem)),
            }),
            Err(error) => Some(Err(failed(&mut self.reader, &begin, error))),
        }
    }

    fn ray(&self) -> Result<FileRay, String> {
        let mut numbers = [0.0f32; 7];
        for (number, place) in numbers.iter_mut().zip(self.places) {
            let word = unquoted(self.record.get(place).unwrap_or_default());
            *number = word.parse().map_err(|_| format!("`{word}` is not a number"))?;
        }
        FileRay::checked(numbers)
    }
}

/// A word without the quotes that some programs write around every one.
fn unquoted(word: &str) -> &str {
    word.trim_matches('"')
}

/// The error of a record that was read from `begin` on.
fn failed(reader: &mut CsvReader, begin: &csv::Position, error: csv::Error) -> RayFileError {
    let problem = match error.into_kind() {
        csv::ErrorKind::Io(error) if error.kind() == io::ErrorKind::InvalidData => {
            error.to_string()
        }
        csv::ErrorKind::Io(error) => return RayFileError::Unreadable(error),
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("it has {len} columns instead of {expected_len}")
        }
        csv::ErrorKind::Utf8 { .. } => "it is not in UTF-8".to_owned(),
        _ => "it is not a line of a CSV".to_owned(),
    };
    in_line(reader, begin, problem)
}

fn in_line(reader: &mut CsvReader, begin: &csv::Position, problem: String) -> RayFileError {
    match line_of(reader, begin) {
        Ok(line) => RayFileError::in_line(FORMAT, line, problem),
        Err(error) => error.into(),
    }
}

/// The line of a record. Between `begin`, where the csv reader goes on, and the record may be a line feed of the line before, blank lines
/// and comments. It leaves the reader at another place.
fn line_of(reader: &mut CsvReader, begin: &csv::Position) -> io::Result<u64> {
    let source = &mut reader.get_mut().inner;
    source.seek(SeekFrom::Start(begin.byte()))?;
    let mut line = begin.line();
    loop {
        let mut bytes = Vec::new();
        source.take(LONGEST as u64).read_until(b'\n', &mut bytes)?;
        let text = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(&bytes);
        let is_blank = text.iter().all(|byte| matches!(byte, b'\r' | b'\n'));
        // The end of the file, and a line that is too long, have no line feed.
        if !text.ends_with(b"\n") || !(is_blank || text.starts_with(b"#")) {
            return Ok(line);
        }
        line += 1;
    }
}

/// Fails at a line of more than [`LONGEST`] bytes, which would otherwise be held in memory.
#[derive(Debug)]
struct Bounded<R> {
    inner: R,
    since_line_end: usize,
}

impl<R: Read> Read for Bounded<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let length = self.inner.read(buffer)?;
        let read = buffer.get(..length).unwrap_or_default();
        self.since_line_end = match read.iter().rposition(|byte| matches!(byte, b'\n' | b'\r')) {
            Some(end) => length - end - 1,
            None => self.since_line_end + length,
        };
        if self.since_line_end > LONGEST {
            let problem = format!("a line has more than {LONGEST} bytes; a ray has about 100");
            return Err(io::Error::new(io::ErrorKind::InvalidData, problem));
        }
        Ok(length)
    }
}

impl<R: Seek> Seek for Bounded<R> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.since_line_end = 0;
        self.inner.seek(to)
    }
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
