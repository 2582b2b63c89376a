//! Rays as records of single-precision numbers, least significant byte first, as binary formats have them.

use crate::rays::source::RaySource;
use crate::rays::{FileRay, RayFileError, RayFormat};
use std::io::{self, BufReader, Read, Seek, SeekFrom};

/// Bytes of a number.
pub(crate) const NUMBER: u64 = 4;

/// How records are laid out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RecordLayout {
    pub(crate) format: RayFormat,
    /// Byte of the first record.
    pub(crate) start: u64,
    /// Numbers of a record: position and direction, then others.
    pub(crate) numbers: u64,
    /// The place of the flux among them.
    pub(crate) flux_at: usize,
    /// Millimetres per unit of length.
    pub(crate) to_mm: f32,
    pub(crate) count: u64,
}

/// The rest of a file.
#[derive(Debug)]
pub(crate) struct RayRecords {
    source: BufReader<Box<dyn RaySource>>,
    layout: RecordLayout,
    bytes: Vec<u8>,
    read: u64,
}

impl RayRecords {
    /// Goes to the first record, if the file has as many as it says.
    pub(crate) fn begin(
        mut source: Box<dyn RaySource>,
        layout: RecordLayout,
        length: u64,
    ) -> Result<Self, RayFileError> {
        let RecordLayout { format, start, numbers, count, .. } = layout;
        let record = numbers.saturating_mul(NUMBER);
        let expected = count.checked_mul(record).and_then(|rays| rays.checked_add(start));
        if expected != Some(length) {
            let there = length.saturating_sub(start);
            // A record has a position and a direction: it is never empty.
            let (whole, rest) = (there / record, there % record);
            let problem = format!(
                "its header promises {count} rays of {record} bytes each, and the file has {whole} and {rest} further bytes; get a whole copy of it"
            );
            return Err(RayFileError::at_byte(format, start, problem));
        }
        source.seek(SeekFrom::Start(start))?;
        // The length of the file bounds the record.
        Ok(Self {
            source: BufReader::new(source),
            layout,
            bytes: vec![0; record as usize],
            read: 0,
        })
    }

    pub(crate) fn next(&mut self) -> Option<Result<FileRay, RayFileError>> {
        if self.read == self.layout.count {
            return None;
        }
        self.read += 1;
        Some(self.ray())
    }

    fn ray(&mut self) -> Result<FileRay, RayFileError> {
        let RecordLayout { format, start, numbers, flux_at, to_mm, .. } = self.layout;
        self.source.read_exact(&mut self.bytes)?;
        let number = |place: usize| {
            let bytes = self.bytes.get(place * 4..place * 4 + 4)?;
            Some(f32::from_le_bytes(bytes.try_into().ok()?))
        };
        let places = [0, 1, 2, 3, 4, 5, flux_at];
        let [x, y, z, dx, dy, dz, flux] = places.map(|place| number(place).unwrap_or(f32::NAN));
        let numbers_of_ray = [x * to_mm, y * to_mm, z * to_mm, dx, dy, dz, flux];
        FileRay::checked(numbers_of_ray).map_err(|problem| {
            let byte = start + (self.read - 1) * numbers * NUMBER;
            let place = format!("ray {} at byte {byte}", self.read);
            RayFileError::Violated { format, place, problem }
        })
    }
}

/// The first bytes of a file, as the numbers of a header.
#[derive(Debug)]
pub(crate) struct RayHeader {
    format: RayFormat,
    bytes: Vec<u8>,
}

impl RayHeader {
    /// Reads as many bytes.
    pub(crate) fn read(
        source: &mut dyn RaySource,
        format: RayFormat,
        length: usize,
    ) -> Result<Self, RayFileError> {
        let mut bytes = Vec::new();
        source.take(length as u64).read_to_end(&mut bytes)?;
        if bytes.len() < length {
            let problem = format!("the file ends within its header of {length} bytes");
            return Err(RayFileError::at_byte(format, bytes.len() as u64, problem));
        }
        Ok(Self { format, bytes })
    }

    /// Bytes from a place.
    pub(crate) fn bytes(&self, at: usize, length: usize) -> Result<&[u8], RayFileError> {
        self.bytes.get(at..at + length).ok_or_else(|| self.wrong(at, "the header is too short"))
    }

    pub(crate) fn i32(&self, at: usize) -> Result<i32, RayFileError> {
        self.array(at).map(i32::from_le_bytes)
    }

    pub(crate) fn u32(&self, at: usize) -> Result<u32, RayFileError> {
        self.array(at).map(u32::from_le_bytes)
    }

    pub(crate) fn u64(&self, at: usize) -> Result<u64, RayFileError> {
        self.array(at).map(u64::from_le_bytes)
    }

    pub(crate) fn f32(&self, at: usize) -> Result<f32, RayFileError> {
        self.array(at).map(f32::from_le_bytes)
    }

    /// A number that must be 0 or 1.
    pub(crate) fn flag(&self, at: usize, what: &str) -> Result<bool, RayFileError> {
        match self.i32(at)? {
            0 => Ok(false),
            1 => Ok(true),
            other => Err(self.wrong(at, format!("the {what} is {other}, not 0 or 1"))),
        }
    }

    /// A flux; `None` for 0 and NaN, with which files say that they do not know it.
    pub(crate) fn flux(&self, at: usize) -> Result<Option<f64>, RayFileError> {
        let flux = f64::from(self.f32(at)?);
        if flux < 0.0 || flux.is_infinite() {
            return Err(self.wrong(at, format!("the flux is {flux}")));
        }
        Ok((flux > 0.0).then_some(flux))
    }

    /// A number of rays, which must not be zero.
    pub(crate) fn rays(&self, at: usize, count: u64) -> Result<u64, RayFileError> {
        if count == 0 { Err(self.wrong(at, "it has no rays")) } else { Ok(count) }
    }

    /// A violation at a byte.
    pub(crate) fn wrong(&self, at: usize, problem: impl Into<String>) -> RayFileError {
        RayFileError::at_byte(self.format, at as u64, problem)
    }

    fn array<const N: usize>(&self, at: usize) -> Result<[u8; N], RayFileError> {
        let bytes = self.bytes(at, N)?;
        bytes.try_into().map_err(|_| io::Error::from(io::ErrorKind::UnexpectedEof).into())
    }
}
