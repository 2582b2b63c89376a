//! Reads LM-63 files: ANSI/IES LM-63-1986, -1991, -1995, -2002 and -2019.
//!
//! Keywords and their texts come first, then `TILT=`, then numbers in a fixed order, separated by blanks, commas and line
//! ends. The photometric horizontal, C0, lies along the length of the opening.

use crate::luminaire::data::{
    LampFlux, Luminaire, LuminaireColour, Opening, ReadLuminaire, known_power, pole_remarks,
};
use crate::luminaire::error::{
    LuminaireError, MAX_ANGLES, MOST_FACTOR, MOST_LAMPS, MOST_LUMENS, MOST_NODES, MOST_SIZE,
};
use crate::luminaire::fields::NumberReader;
use crate::luminaire::format::LuminaireFormat;
use crate::luminaire::front_table::{FrontTable, problem_of_angles};
use crate::luminaire::generation::FileGeneration;
use crate::luminaire::ies_edition::{Edition, SecondNumber, WithoutLength};
use crate::luminaire::ies_words::{WordReader, violated};
use crate::luminaire::intensities::{Intensities, PlaneSymmetry};
use crate::luminaire::photometric_type::PhotometricType;
use crate::luminaire::{type_a, type_b};

/// Millimetres in a foot.
const FOOT: f64 = 304.8;
/// Relative difference of the planes 0 and 360 that is no more than rounding, 1.
const SAME_PLANE: f64 = 1e-3;

/// Reads the text of a file.
pub(crate) fn read(text: &str) -> Result<ReadLuminaire, LuminaireError> {
    let mut remarks = Vec::new();
    let lines: Vec<&str> = text.lines().collect();
    let is_tilt = |line: &str| {
        let line = line.trim_start().to_ascii_uppercase();
        line.strip_prefix("TILT").is_some_and(|rest| rest.trim_start().starts_with('='))
    };
    let Some(tilt) = lines.iter().position(|line| is_tilt(line)) else {
        let problem = match text {
            _ if text.trim().is_empty() => "the file is empty",
            _ if text.contains('\0') => "the file is no text",
            _ => "there is no line that begins with `TILT=`",
        };
        return Err(violated(lines.len().max(1), problem.to_owned()));
    };
    let labels = &lines[..tilt];
    let head = labels.iter().position(|line| !line.trim().is_empty());
    let edition = head.map_or(Edition::First, |head| Edition::of(labels[head]));
    remarks.extend(edition.remark(head.map(|head| labels[head])));
    let first = head.filter(|_| edition != Edition::First).map_or(0, |head| head + 1);
    let texts = texts(&labels[first..]);
    let mut numbers = WordReader::new(&lines, tilt + 1);
    let way = lines[tilt].split('=').nth(1).unwrap_or_default().trim().to_owned();
    match way.to_ascii_uppercase().as_str() {
        "NONE" => {}
        "INCLUDE" => {
            skip_tilt(&mut numbers)?;
            remarks.push("the effect of tilt on the lamp is left out".to_owned());
        }
        _ => remarks.push(format!("the file of the effect of tilt, `{way}`, is not read")),
    }

    let head = read_head(&mut numbers, edition, &mut remarks)?;
    let Head { lamps, power_w, .. } = head;
    let LocatedTable { line: table_line, of: intensities } =
        read_intensities(&mut numbers, &head, &mut remarks)?;
    let lamps = lamp_flux(lamps, head.lumens_per_lamp, &mut remarks);
    let power_w = known_power(power_w, &mut remarks);
    let opening = opening(head.size_mm, edition.without_length(), &mut remarks);
    let generation = match head.photometric_type {
        PhotometricType::A | PhotometricType::C => head.generation,
        PhotometricType::B => head.generation.interpolated(),
    };
    let luminaire = Luminaire {
        texts,
        generation,
        lamps,
        power_w,
        opening,
        // No keyword is for it.
        colour: LuminaireColour::default(),
        intensities,
    };
    ReadLuminaire::new(luminaire, LuminaireFormat::Ies, table_line, remarks)
}

/// What a table of intensities says, and the line of its first one.
struct LocatedTable<T> {
    line: usize,
    of: T,
}

impl<T> LocatedTable<T> {
    fn map<U>(
        self,
        meaning: impl FnOnce(T) -> Result<U, LuminaireError>,
    ) -> Result<LocatedTable<U>, LuminaireError> {
        let Self { line, of } = self;
        let of = meaning(of).map_err(|error| error.at_table(LuminaireFormat::Ies, line))?;
        Ok(LocatedTable { line, of })
    }
}

/// Reads the angles and the intensities, and gives them over C planes; notes remarks.
fn read_intensities(
    numbers: &mut WordReader<'_>,
    head: &Head,
    remarks: &mut Vec<String>,
) -> Result<LocatedTable<Intensities>, LuminaireError> {
    match head.photometric_type {
        PhotometricType::A => {
            read_front(numbers, head)?.map(|table| type_a::over_c_planes(&table, remarks))
        }
        PhotometricType::B => {
            read_front(numbers, head)?.map(|table| type_b::over_c_planes(&table, remarks))
        }
        PhotometricType::C => {
            let angles_deg = numbers.angles(head.angles, "a vertical angle")?;
            let planes_deg = numbers.angles(head.planes, "a horizontal angle")?;
            if let [only] = planes_deg[..]
                && only != 0.0
            {
                let taken = "the light is taken as the same at all horizontal angles";
                remarks.push(format!("its only plane is at {only} and not at 0; {taken}"));
            }
            let (symmetry, planes_deg) =
                symmetry_of(planes_deg).map_err(|problem| numbers.wrong(problem))?;
            read_values(numbers, head)?.map(|mut candela| {
                remark_on_repeated_plane((&planes_deg, &angles_deg), &candela, remarks);
                candela.truncate(planes_deg.len() * angles_deg.len());
                let intensities = Intensities::new(symmetry, planes_deg, angles_deg, candela)?;
                remarks.extend(pole_remarks(&intensities));
                Ok(intensities)
            })
        }
    }
}

/// Reads the angles and the intensities of type A or B.
fn read_front(
    numbers: &mut WordReader<'_>,
    head: &Head,
) -> Result<LocatedTable<FrontTable>, LuminaireError> {
    let vertical_deg = numbers.angles(head.angles, "a vertical angle")?;
    let horizontal_deg = numbers.angles(head.planes, "a horizontal angle")?;
    if let Some(problem) = problem_of_angles(&horizontal_deg, &vertical_deg) {
        return Err(numbers.wrong(problem));
    }
    read_values(numbers, head)?
        .map(|candela| Ok(FrontTable::new(horizontal_deg, vertical_deg, candela)))
}

/// Reads the intensities, which end the file, cd.
fn read_values(
    numbers: &mut WordReader<'_>,
    head: &Head,
) -> Result<LocatedTable<Vec<f64>>, LuminaireError> {
    let &Head { angles, planes, factor, .. } = head;
    let line = numbers.next_line();
    let mut candela = numbers.intensities(planes * angles)?;
    numbers.end([planes, angles])?;
    candela.iter_mut().for_each(|value| *value *= factor);
    Ok(LocatedTable { line, of: candela })
}

/// The numbers before the angles.
struct Head {
    lamps: usize,
    lumens_per_lamp: f64,
    /// Of the intensities, 1.
    factor: f64,
    angles: usize,
    planes: usize,
    photometric_type: PhotometricType,
    /// Width, length and height; negative ones are diameters.
    size_mm: [f64; 3],
    generation: FileGeneration,
    power_w: f64,
}

fn read_head(
    numbers: &mut WordReader<'_>,
    edition: Edition,
    remarks: &mut Vec<String>,
) -> Result<Head, LuminaireError> {
    let lamps = numbers.count("the number of lamps", 1..=MOST_LAMPS)?;
    let lumens_per_lamp = numbers.within("the lumens per lamp", -MOST_LUMENS..=MOST_LUMENS)?;
    let multiplier = numbers.positive("the multiplier of the intensities", MOST_FACTOR)?;
    let angles = numbers.count("the number of vertical angles", 1..=MAX_ANGLES)?;
    let planes = numbers.count("the number of horizontal angles", 1..=MAX_ANGLES)?;
    if planes * angles > MOST_NODES {
        return Err(numbers.wrong(format!("{planes} times {angles} angles are too many")));
    }
    let number = numbers.next("the photometric type")?;
    let photometric_type = PhotometricType::of_number(number).ok_or_else(|| {
        numbers.wrong(format!("photometric type {number}, expected 1 (C), 2 (B) or 3 (A)"))
    })?;
    let unit = match numbers.next("the unit of lengths")? {
        1.0 => FOOT,
        2.0 => 1000.0,
        other => {
            return Err(numbers.wrong(format!("unit {other}, expected 1 (feet) or 2 (metres)")));
        }
    };
    let most = MOST_SIZE / unit;
    let mut size = || numbers.within("the size of the opening", -most..=most);
    let size_mm = [size()? * unit, size()? * unit, size()? * unit];
    let ballast = numbers.positive("the ballast factor", MOST_FACTOR)?;
    let (second, generation) = match edition.second_number() {
        SecondNumber::Factor => {
            let factor = numbers.positive("the ballast-lamp factor", MOST_FACTOR)?;
            (factor, FileGeneration::Undefined)
        }
        SecondNumber::Unused => {
            let unused = numbers.next("the number after the ballast factor")?;
            if unused != 1.0 {
                remarks.push(format!(
                    "the number after the ballast factor is {unused}; LM-63 has reserved it since 1995, so it is not applied"
                ));
            }
            (1.0, FileGeneration::Undefined)
        }
        SecondNumber::Generation => {
            let number = numbers.next("the file generation type")?;
            (1.0, known_generation(number, remarks))
        }
    };
    let power_w = numbers.next("the input power")?;
    let factor = multiplier * ballast * second;
    Ok(Head {
        lamps,
        lumens_per_lamp,
        factor,
        angles,
        planes,
        photometric_type,
        size_mm,
        generation,
        power_w,
    })
}

/// How the file was made, with a remark if its number is not one of the standard.
fn known_generation(number: f64, remarks: &mut Vec<String>) -> FileGeneration {
    FileGeneration::of_number(number).unwrap_or_else(|| {
        let taken = "is not one of LM-63-2019; how the file was made is taken as not known";
        remarks.push(format!("the file generation type {number} {taken}"));
        FileGeneration::Undefined
    })
}

/// The flux of the lamps; -1 lm of each says that the photometry is absolute.
fn lamp_flux(count: usize, lumens_per_lamp: f64, remarks: &mut Vec<String>) -> LampFlux {
    if lumens_per_lamp > 0.0 {
        return LampFlux::Relative { count: count as u32, flux_lm: count as f64 * lumens_per_lamp };
    }
    if lumens_per_lamp != -1.0 {
        let taken = "the photometry is taken as absolute";
        remarks.push(format!("the lamps have {lumens_per_lamp} lm each; {taken}"));
    }
    LampFlux::Absolute
}

/// The symmetry that horizontal angles mean, and the planes without a repeated one at 360.
fn symmetry_of(mut planes: Vec<f64>) -> Result<(PlaneSymmetry, Vec<f64>), String> {
    let symmetry = match [planes[0], planes[planes.len() - 1]] {
        _ if planes.len() == 1 => return Ok((PlaneSymmetry::Rotational, vec![0.0])),
        [0.0, 90.0] => PlaneSymmetry::Quadrants,
        [0.0, 180.0] => PlaneSymmetry::AboutC0,
        [90.0, 270.0] => PlaneSymmetry::AboutC90,
        [0.0, last] if last > 180.0 && last <= 360.0 => PlaneSymmetry::None,
        [first, last] => {
            let expected = "0 to 0, 90, 180 or 360, or 90 to 270";
            return Err(format!("horizontal angles from {first} to {last}, expected {expected}"));
        }
    };
    planes.pop_if(|last| *last == 360.0);
    Ok((symmetry, planes))
}

/// Remarks where planes 0 and 360 differ.
fn remark_on_repeated_plane(
    (planes, angles): (&[f64], &[f64]),
    candela: &[f64],
    remarks: &mut Vec<String>,
) {
    let (first, repeated) = (&candela[..angles.len()], &candela[planes.len() * angles.len()..]);
    let peak = first.iter().copied().fold(0.0, f64::max);
    if first.iter().zip(repeated).any(|(a, b)| (a - b).abs() > SAME_PLANE * peak) {
        remarks.push("the planes 0 and 360 differ; that of 0 is used".to_owned());
    }
}

/// Keywords in brackets with their texts, unless empty; `[MORE]` goes on with the text before. Lines without a keyword are of the
/// first edition.
fn texts(lines: &[&str]) -> Vec<(String, String)> {
    let mut texts: Vec<(String, String)> = Vec::new();
    for line in lines.iter().map(|line| line.trim()).filter(|line| !line.is_empty()) {
        let bracketed = line.strip_prefix('[').and_then(|rest| rest.split_once(']'));
        match (bracketed, texts.last_mut()) {
            (Some((keyword, text)), Some((_, before))) if keyword.eq_ignore_ascii_case("MORE") => {
                before.push('\n');
                before.push_str(text.trim());
            }
            (Some((keyword, text)), _) => {
                texts.push((keyword.trim().to_ascii_uppercase(), text.trim().to_owned()));
            }
            (None, _) => texts.push(("OTHER".to_owned(), line.to_owned())),
        }
    }
    texts.retain(|(_, text)| !text.is_empty());
    texts
}

/// Passes over the orientation of the lamp, and pairs of angles and factors.
fn skip_tilt(numbers: &mut WordReader<'_>) -> Result<(), LuminaireError> {
    numbers.next("the geometry of the lamp")?;
    let pairs = numbers.count("the number of tilts", 1..=MAX_ANGLES)?;
    (0..2 * pairs).try_for_each(|_| numbers.next("a tilt or its factor").map(drop))
}

/// The opening: negative sizes are diameters (LM-63-2002, table 1). A circle has a length of 0 in LM-63-1995, and an ellipse a
/// positive one.
fn opening(
    [width, length, height]: [f64; 3],
    without_length: WithoutLength,
    remarks: &mut Vec<String>,
) -> Opening {
    let is_flat = height >= 0.0;
    let is_disk_or_ball = is_flat || without_length == WithoutLength::Sphere && length == 0.0;
    let is_round = width < 0.0 && (length < 0.0 || is_disk_or_ball);
    if !is_flat || (length < 0.0 && width >= 0.0) {
        let shape = "is a sphere, a cylinder that lies or a disk that stands";
        let taken = "it is read as an upright cylinder or box of its sizes";
        remarks.push(format!("the opening {shape}; {taken}"));
    }
    let [width, length] = [width.abs(), length.abs()];
    let length = if is_round && length == 0.0 { width } else { length };
    Opening { is_round, along_c0_mm: length, along_c90_mm: width, height_mm: height.abs() }
}
