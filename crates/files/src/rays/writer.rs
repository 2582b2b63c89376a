//! Streaming writing of ray files of any format.

use crate::rays::{FileRay, RayFileError, RayFormat, RaySetInfo, table, tm25, zemax};
use std::io::{BufWriter, Write};

/// Writes rays with what `info` says of them; returns remarks on what the format cannot hold.
///
/// # Errors
///
/// Errors of the rays; [`RayFileError::Unreadable`] if the file cannot be written; [`RayFileError::NotWritten`] if there are not
/// `info.count` rays, or too many for the format.
pub fn write(
    out: &mut dyn Write,
    format: RayFormat,
    info: &RaySetInfo,
    rays: impl IntoIterator<Item = Result<FileRay, RayFileError>>,
) -> Result<Vec<String>, RayFileError> {
    let refused = |problem: String| RayFileError::NotWritten { format, problem };
    if format == RayFormat::Zemax && info.count > zemax::MOST_RAYS {
        return Err(refused(format!("{} rays; at most {}", info.count, zemax::MOST_RAYS)));
    }
    let mut out = BufWriter::new(out);
    let remarks = match format {
        RayFormat::Tm25 => tm25::write_header(&mut out, info)?,
        RayFormat::Zemax => zemax::write_header(&mut out, info)?,
        RayFormat::Csv => {
            table::write_header(&mut out, info)?;
            Vec::new()
        }
    };
    let mut count = 0;
    for ray in rays {
        let numbers = ray?.numbers();
        match format {
            RayFormat::Tm25 | RayFormat::Zemax => {
                for number in numbers {
                    out.write_all(&number.to_le_bytes())?;
                }
            }
            RayFormat::Csv => writeln!(out, "{}", numbers.map(|own| own.to_string()).join(","))?,
        }
        count += 1;
    }
    if count != info.count {
        return Err(refused(format!("{count} rays, where the header has {}", info.count)));
    }
    out.flush()?;
    Ok(remarks)
}
