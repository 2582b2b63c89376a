//! Streaming reading of ray files of any format.

use crate::rays::records::RayRecords;
use crate::rays::source::{Opened, RaySource};
use crate::rays::table::RayTable;
use crate::rays::zemax_text::ZemaxLines;
use crate::rays::{FileRay, RayFileError, RayFormat, RaySetInfo, tm25, zemax};
use std::fs::{self, File};
use std::io::{self, Cursor, SeekFrom};
use std::path::Path;

/// The rays of a file, one after the other. After an error there are no more.
#[derive(Debug)]
pub struct RayReader {
    info: RaySetInfo,
    remarks: Vec<String>,
    body: Option<RayBody>,
}

/// Where rays come from.
#[derive(Debug)]
enum RayBody {
    RayRecords(RayRecords),
    Lines(ZemaxLines),
    RayTable(RayTable),
}

impl RayReader {
    /// Opens a file; its extension gives the format. A CSV is read once to count and to sum its rays.
    ///
    /// # Errors
    ///
    /// As [`RayFormat::of`]; [`RayFileError::Unreadable`] if the file cannot be read; [`RayFileError::Violated`] if what is before its
    /// rays violates the format, or its length is not that of its rays.
    pub fn open(path: &Path) -> Result<Self, RayFileError> {
        let format = RayFormat::of(path)?;
        // A pipe or a device may never end.
        if !fs::metadata(path)?.is_file() {
            return Err(io::Error::other("it is not a regular file").into());
        }
        Self::from_source(Box::new(File::open(path)?), format)
    }

    /// Reads the bytes of a file.
    ///
    /// # Errors
    ///
    /// As [`Self::open`].
    pub fn of_bytes(bytes: Vec<u8>, format: RayFormat) -> Result<Self, RayFileError> {
        Self::from_source(Box::new(Cursor::new(bytes)), format)
    }

    fn from_source(
        mut source: Box<dyn RaySource>,
        format: RayFormat,
    ) -> Result<Self, RayFileError> {
        let length = source.seek(SeekFrom::End(0))?;
        source.rewind()?;
        Ok(match format {
            RayFormat::Tm25 => Self::of(tm25::open(source, length)?, RayBody::RayRecords),
            RayFormat::Zemax if zemax::is_binary(&mut source)? => {
                Self::of(zemax::open(source, length)?, RayBody::RayRecords)
            }
            RayFormat::Zemax => Self::of(ZemaxLines::open(source)?, RayBody::Lines),
            RayFormat::Csv => Self::of(RayTable::open(source)?, RayBody::RayTable),
        })
    }

    fn of<Rays>(opened: Opened<Rays>, body: impl FnOnce(Rays) -> RayBody) -> Self {
        let Opened { info, remarks, rays } = opened;
        Self { info, remarks, body: Some(body(rays)) }
    }

    /// What the file says of its rays.
    pub fn info(&self) -> &RaySetInfo {
        &self.info
    }

    /// What was assumed and what is not used: sentences without a full stop.
    pub fn remarks(&self) -> &[String] {
        &self.remarks
    }
}

impl Iterator for RayReader {
    type Item = Result<FileRay, RayFileError>;

    fn next(&mut self) -> Option<Self::Item> {
        let next = match self.body.as_mut()? {
            RayBody::RayRecords(records) => records.next(),
            RayBody::Lines(lines) => lines.next(),
            RayBody::RayTable(table) => table.next(),
        };
        if !matches!(next, Some(Ok(_))) {
            self.body = None;
        }
        next
    }
}
