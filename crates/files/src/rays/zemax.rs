//! Source files of OpticStudio: a header of 208 bytes and records of numbers (Ansys Zemax OpticStudio help, "Source File", Binary
//! Source File Format), or text.

use crate::rays::records::{RayHeader, RayRecords, RecordLayout};
use crate::rays::source::{Opened, RaySource};
use crate::rays::{RayFileError, RayFormat, RaySetInfo, RayText};
use lumiduct_base::units::FluxUnit;
use std::io::{self, Write};

const FORMAT: RayFormat = RayFormat::Zemax;
/// Bytes of the header.
const HEADER: usize = 208;
/// Bytes of the description.
const DESCRIPTION: usize = 100;
/// What files begin with; the second is that of older ones.
const IDENTIFIERS: [i32; 2] = [1010, 8_675_309];
/// Code of millimetres.
const MILLIMETRES: i32 = 4;
/// Most rays of a file (help of OpticStudio).
pub(crate) const MOST_RAYS: u64 = 4_000_000_000;

/// Millimetres per unit of length of a code.
pub(crate) fn unit_mm(code: i32) -> Option<f32> {
    match code {
        0 => Some(1000.0),
        1 => Some(25.4),
        2 => Some(10.0),
        3 => Some(304.8),
        MILLIMETRES => Some(1.0),
        _ => None,
    }
}

/// Whether it begins as a binary file does.
pub(crate) fn is_binary(source: &mut dyn RaySource) -> Result<bool, RayFileError> {
    let Ok(head) = RayHeader::read(source, FORMAT, 4) else {
        return Err(RayFileError::at_byte(
            FORMAT,
            0,
            "the file is empty or has fewer than 4 bytes",
        ));
    };
    let identifier = head.i32(0)?;
    source.rewind()?;
    Ok(IDENTIFIERS.contains(&identifier))
}

/// Reads the header of a binary file.
pub(crate) fn open(
    mut source: Box<dyn RaySource>,
    length: u64,
) -> Result<Opened<RayRecords>, RayFileError> {
    let header = RayHeader::read(&mut source, FORMAT, HEADER)?;
    let count = header.rays(4, u64::from(header.u32(4)?))?;
    let code = header.i32(136)?;
    let to_mm = unit_mm(code).ok_or_else(|| {
        header
            .wrong(136, format!("{code} is no unit of length; 0 to 4 stand for m, in, cm, ft, mm"))
    })?;
    let (numbers, unit) = match [header.i32(192)?, header.i32(196)?] {
        [0, 0] => (7, FluxUnit::Watt),
        [0, 1] => (7, FluxUnit::Lumen),
        // With wavelengths, fluxes are radiant.
        [2, _] => (8, FluxUnit::Watt),
        [kind, unit] => {
            let problem = format!(
                "its rays are of type {kind} and its flux of type {unit}; 0 with 0 or 1, and 2, can be read"
            );
            return Err(header.wrong(192, problem));
        }
    };
    let mut remarks = Vec::new();
    let moved = (140..164).step_by(4).map(|at| header.f32(at)).collect::<Result<Vec<_>, _>>()?;
    if moved.iter().any(|own| *own != 0.0) {
        remarks.push("the place and rotation in its header are not applied; give them to the source with `at`".to_owned());
    }
    let scales = [164, 168, 172].map(|at| header.f32(at).unwrap_or(1.0));
    // Older files leave them empty.
    if scales.iter().any(|own| ![0.0, 1.0].contains(own)) {
        remarks.push(format!("the scales in its header, {scales:?}, are not applied"));
    }
    if numbers == 8 {
        remarks.push("its wavelengths are not used".to_owned());
    }
    let description: String = header
        .bytes(8, DESCRIPTION)?
        .iter()
        .take_while(|byte| **byte != 0)
        .map(|byte| char::from(*byte))
        .collect();
    let name = description.trim().to_owned();
    let texts = if name.is_empty() { Vec::new() } else { vec![(RayText::Name, name)] };
    let flux = header.flux(112)?.unwrap_or(0.0);
    let info = RaySetInfo { count, unit, flux, luminous_flux_lm: None, is_measured: false, texts };
    let layout =
        RecordLayout { format: FORMAT, start: HEADER as u64, numbers, flux_at: 6, to_mm, count };
    let rays = RayRecords::begin(source, layout, length)?;
    Ok(Opened { info, remarks, rays })
}

/// Writes a binary header; what is lost is a remark.
pub(crate) fn write_header(out: &mut dyn Write, info: &RaySetInfo) -> io::Result<Vec<String>> {
    let mut remarks = Vec::new();
    let known = RayText::ALL.into_iter().filter_map(|kind| info.text(kind));
    let text = known.collect::<Vec<_>>().join("; ");
    if text.len() > DESCRIPTION || !text.is_ascii() {
        remarks.push(format!("the texts are cut to {DESCRIPTION} letters of ASCII"));
    }
    let ascii = text.chars().map(|letter| if letter.is_ascii() { letter as u8 } else { b'?' });
    let mut bytes = [0; HEADER];
    let mut put = |at: usize, value: [u8; 4]| bytes[at..at + 4].copy_from_slice(&value);
    put(0, IDENTIFIERS[0].to_le_bytes());
    // The count was checked.
    put(4, (info.count as u32).to_le_bytes());
    // Flux of the source, and of these rays.
    [108, 112].into_iter().for_each(|at| put(at, (info.flux as f32).to_le_bytes()));
    put(136, MILLIMETRES.to_le_bytes());
    [164, 168, 172].into_iter().for_each(|at| put(at, 1f32.to_le_bytes()));
    let flux_type = match info.unit {
        FluxUnit::Watt => 0i32,
        FluxUnit::Lumen => 1,
    };
    put(196, flux_type.to_le_bytes());
    for (place, letter) in bytes[8..8 + DESCRIPTION].iter_mut().zip(ascii) {
        *place = letter;
    }
    out.write_all(&bytes)?;
    Ok(remarks)
}
