//! IES TM-25: a header of fixed and variable blocks, and records of numbers. Section numbers are those of IES TM-25-13; sizes and order of
//! the blocks are those of the public reader `TM25RaySetTools` (J. Muschaweck, 2019).

use crate::rays::records::{NUMBER, RayHeader, RayRecords, RecordLayout};
use crate::rays::source::{Opened, RaySource};
use crate::rays::{RayFileError, RayFormat, RaySetInfo, RayText};
use lumiduct_base::units::FluxUnit;
use std::io::{self, SeekFrom, Write};

const FORMAT: RayFormat = RayFormat::Tm25;
/// Bytes of the header up to the spectral tables (sections 4.7.1 to 4.7.3).
const FIXED: usize = 36_288;
/// Byte of the flags (section 4.7.2).
const FLAGS: usize = 256;
/// Byte of the texts (section 4.7.3).
const TEXTS: usize = 288;
/// Letters of a text, in UTF-32.
const LETTERS: usize = 1000;
/// Blocks of variable size are filled up to a multiple of this, bytes.
const ALIGNED: u64 = 32;
/// Bytes of the name of an additional column (section 4.7.5).
const COLUMN_NAME: u64 = 512;
/// Version that is written.
const VERSION: i32 = 2013;
/// Version whose layout is taken to be the same.
const LATER_VERSION: i32 = 2020;
/// How the rays were made (section 4.7.1.3).
const SIMULATED: i32 = 0;
const MEASURED: i32 = 1;

/// Reads the header.
pub(crate) fn open(
    mut source: Box<dyn RaySource>,
    length: u64,
) -> Result<Opened<RayRecords>, RayFileError> {
    let header = RayHeader::read(&mut source, FORMAT, FIXED)?;
    if header.bytes(0, 4)? != b"TM25" {
        return Err(header.wrong(0, "it does not begin with TM25"));
    }
    let version = header.i32(4)?;
    if version != VERSION && version != LATER_VERSION {
        let problem =
            format!("its version is {version}; {VERSION} and {LATER_VERSION} can be read");
        return Err(header.wrong(4, problem));
    }
    let (luminous, radiant) = (header.flux(12)?, header.flux(16)?);
    let count = header.rays(20, header.u64(20)?)?;
    let (tables, columns, text) = (header.i32(76)?, header.i32(80)?, header.i32(84)?);
    let sizes = [(76, tables), (80, columns), (84, text)];
    if let Some((at, size)) = sizes.into_iter().find(|(_, size)| *size < 0) {
        return Err(header.wrong(at, format!("{size} is not a number of tables, columns or bytes")));
    }
    let columns_of_rays = RayColumns::read(&header, columns as u64)?;
    let (start, mut remarks) = (after_tables(&mut source, tables, length)?, Vec::new());
    // Sizes were checked not to be negative.
    let start_of_text = start + columns as u64 * COLUMN_NAME;
    let start = start_of_text + text as u64;
    let too_long = [(80, start_of_text, "additional columns"), (84, start, "bytes of text")];
    if let Some((at, _, what)) = too_long.into_iter().find(|(_, end, _)| *end > length) {
        let problem = format!("its {what} do not fit into the file of {length} bytes");
        return Err(header.wrong(at, problem));
    }
    if version == LATER_VERSION {
        remarks.push(format!("its version is {LATER_VERSION}, which is read as {VERSION}"));
    }
    if tables > 0 || columns_of_rays.has_color {
        remarks.push("its spectra, wavelengths and colours are not used".to_owned());
    }
    if columns_of_rays.has_both_fluxes {
        remarks
            .push("it has luminous and radiant fluxes; the radiant ones are not used".to_owned());
    }
    if columns_of_rays.has_stokes {
        remarks.push("its polarisation is not used".to_owned());
    }
    if columns > 0 || text > 0 {
        remarks.push("its additional columns and text are not used".to_owned());
    }
    let (unit, flux) = match columns_of_rays.unit {
        FluxUnit::Lumen => (FluxUnit::Lumen, luminous),
        FluxUnit::Watt => (FluxUnit::Watt, radiant),
    };
    let info = RaySetInfo {
        count,
        unit,
        flux: flux.unwrap_or(0.0),
        luminous_flux_lm: luminous.filter(|_| unit == FluxUnit::Watt),
        is_measured: header.i32(8)? == MEASURED,
        texts: texts(&header)?,
    };
    let layout = RecordLayout {
        format: FORMAT,
        start,
        numbers: columns_of_rays.numbers,
        flux_at: columns_of_rays.flux_at,
        to_mm: 1.0,
        count,
    };
    let rays = RayRecords::begin(source, layout, length)?;
    Ok(Opened { info, remarks, rays })
}

/// The numbers of a record (section 4.7.2).
struct RayColumns {
    numbers: u64,
    flux_at: usize,
    unit: FluxUnit,
    has_color: bool,
    has_stokes: bool,
    has_both_fluxes: bool,
}

impl RayColumns {
    fn read(header: &RayHeader, additional: u64) -> Result<Self, RayFileError> {
        let flag = |place: usize, what: &str| header.flag(FLAGS + 4 * place, what);
        for (place, what) in [(0, "positions"), (1, "directions")] {
            if !flag(place, &format!("flag of {what}"))? {
                return Err(header.wrong(FLAGS + 4 * place, format!("its rays have no {what}")));
            }
        }
        let (radiant, wavelength) =
            (flag(2, "flag of radiant flux")?, flag(3, "flag of wavelengths")?);
        let luminous = flag(4, "flag of luminous flux")?;
        let (stokes, tristimulus) =
            (flag(5, "flag of Stokes vectors")?, flag(6, "flag of tristimulus values")?);
        let index = flag(7, "flag of spectrum numbers")?;
        let before = 6 + usize::from(radiant) + usize::from(wavelength);
        let (flux_at, unit) = match (luminous, radiant) {
            (true, _) => (before, FluxUnit::Lumen),
            (false, true) => (6, FluxUnit::Watt),
            (false, false) => return Err(header.wrong(FLAGS + 8, "its rays have no flux")),
        };
        let numbers = before as u64
            + u64::from(luminous)
            + 6 * u64::from(stokes)
            + 2 * u64::from(tristimulus)
            + u64::from(index)
            + additional;
        let has_color = wavelength || tristimulus || index;
        let has_both_fluxes = luminous && radiant;
        Ok(Self { numbers, flux_at, unit, has_color, has_stokes: stokes, has_both_fluxes })
    }
}

/// Byte after the spectral tables (section 4.7.4).
fn after_tables(source: &mut dyn RaySource, tables: i32, length: u64) -> Result<u64, RayFileError> {
    let begin = FIXED as u64;
    let mut at = begin;
    for table in 1..=tables {
        source.seek(SeekFrom::Start(at))?;
        let pairs = RayHeader::read(source, FORMAT, NUMBER as usize);
        let pairs = match pairs.and_then(|head| head.i32(0)) {
            Ok(pairs) if pairs > 0 => pairs as u64,
            Ok(pairs) => {
                let problem = format!("spectral table {table} has {pairs} pairs of numbers");
                return Err(RayFileError::at_byte(FORMAT, at, problem));
            }
            Err(_) => {
                let problem = format!("the file ends before spectral table {table} of {tables}");
                return Err(RayFileError::at_byte(FORMAT, length, problem));
            }
        };
        // No overflow: both are below 2³⁵.
        at += NUMBER + 2 * NUMBER * pairs;
        if at > length {
            let problem =
                format!("spectral table {table} of {pairs} pairs is longer than the file");
            return Err(RayFileError::at_byte(FORMAT, at - 2 * NUMBER * pairs, problem));
        }
    }
    Ok(begin + (at - begin).next_multiple_of(ALIGNED))
}

fn texts(header: &RayHeader) -> Result<Vec<(RayText, String)>, RayFileError> {
    let mut texts = Vec::new();
    for (place, kind) in RayText::ALL.into_iter().enumerate() {
        let at = TEXTS + place * 4 * LETTERS;
        let bytes = header.bytes(at, 4 * LETTERS)?;
        let codes = bytes.as_chunks::<4>().0.iter().map(|code| u32::from_le_bytes(*code));
        let letters: Option<String> =
            codes.take_while(|code| *code != 0).map(char::from_u32).collect();
        let text = letters.ok_or_else(|| header.wrong(at, "a text is not in UTF-32"))?;
        if !text.trim().is_empty() {
            texts.push((kind, text.trim().to_owned()));
        }
    }
    Ok(texts)
}

/// Writes a header for records of seven numbers; what is lost is a remark.
pub(crate) fn write_header(out: &mut dyn Write, info: &RaySetInfo) -> io::Result<Vec<String>> {
    let mut remarks = Vec::new();
    let (mut luminous, mut radiant) = (info.luminous_flux_lm.unwrap_or(0.0), 0.0);
    match info.unit {
        FluxUnit::Lumen => luminous = info.flux,
        FluxUnit::Watt => radiant = info.flux,
    }
    let mut bytes = vec![0; FIXED];
    let mut put = |at: usize, value: &[u8]| bytes[at..at + value.len()].copy_from_slice(value);
    put(0, b"TM25");
    put(4, &VERSION.to_le_bytes());
    put(8, &if info.is_measured { MEASURED } else { SIMULATED }.to_le_bytes());
    put(12, &(luminous as f32).to_le_bytes());
    put(16, &(radiant as f32).to_le_bytes());
    put(20, &info.count.to_le_bytes());
    // No wavelengths (sections 4.7.1.10 to 4.7.1.12).
    [64, 68, 72].into_iter().for_each(|at| put(at, &f32::NAN.to_le_bytes()));
    let flux_flag = match info.unit {
        FluxUnit::Lumen => 4,
        FluxUnit::Watt => 2,
    };
    [0, 1, flux_flag].into_iter().for_each(|flag| put(FLAGS + 4 * flag, &1i32.to_le_bytes()));
    for (place, kind) in RayText::ALL.into_iter().enumerate() {
        let text = info.text(kind).unwrap_or_default();
        if text.chars().count() > LETTERS {
            remarks.push(format!("the {} is cut after {LETTERS} letters", kind.name()));
        }
        for (letter, code) in text.chars().take(LETTERS).enumerate() {
            put(TEXTS + 4 * (place * LETTERS + letter), &u32::from(code).to_le_bytes());
        }
    }
    out.write_all(&bytes)?;
    Ok(remarks)
}
