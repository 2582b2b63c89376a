//! Streaming writing of ray files of any format.

use crate::rays::data::MOST_FLUX;
use crate::rays::{FileRay, RayFileError, RayFormat, RaySetInfo, table, tm25, zemax};
use std::io::{BufWriter, Write};

/// Writes rays with what `info` says of them; returns remarks on what the format cannot hold.
///
/// # Errors
///
/// Errors of the rays; [`RayFileError::Unreadable`] if the file cannot be written; [`RayFileError::NotWritten`] if there are not
/// `info.count` rays, or too many for the format, or if a ray or all of them have too much flux for its readers.
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
    if info.flux > f64::from(f32::MAX) {
        return Err(refused(format!("a flux of {:e} {}", info.flux, info.unit.flux())));
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
        let ray = ray?;
        if ray.flux > MOST_FLUX {
            let (flux, unit) = (ray.flux, info.unit.flux());
            return Err(refused(format!("a ray of {flux:e} {unit}; at most {MOST_FLUX:e} {unit}")));
        }
        let numbers = ray.numbers();
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
