//! Writes ANSI/IES TM-33-18, the XML of ATLA S001.
//!
//! Elements, their order and the types of their texts are those of version 1.0 of the schema in ATLA S001 (I. Ashdown, All Things Lighting Association, 2018),
//! and lengths are in m as in its example. The schema has no symmetry: `Symm` came with IES TM-33-23. Planes therefore
//! make the whole circle, and only rotationally symmetric luminaires have one plane, as in the example. Values are in cd with the
//! lamps of the luminaire and marked as absolute, so that no reader scales them.

use crate::luminaire::data::{LampFlux, Luminaire, Opening, WrittenLuminaire};
use crate::luminaire::date::iso_date;
use crate::luminaire::generation::FileGeneration;
use crate::luminaire::intensities::{Intensities, PlaneSymmetry};
use crate::luminaire::text::{one_line, seven_digits};
use crate::luminaire::xml_text::XmlText;

/// Keywords of LM-63 whose first text has an element of its own; other texts are comments.
const OWN_ELEMENT: [&str; 7] =
    ["MANUFAC", "LUMCAT", "LUMINAIRE", "TESTLAB", "TEST", "LAMP", "LAMPCAT"];
/// Share of the flux that a face has to send, 1; less is noise.
const LEAST_SHARE: f64 = 1e-3;

/// The file.
pub(crate) fn write(luminaire: &Luminaire) -> WrittenLuminaire {
    let mut remarks = Vec::new();
    let opening = &luminaire.opening;
    let [length, width] = horizontal_sizes(opening);
    let mut out = XmlText::new();
    out.parent("IESTM33", |out| {
        out.leaf("Version", "1.0");
        out.parent("Header", |out| header(out, luminaire, &mut remarks));
        out.parent("Luminaire", |out| {
            // The housing is not known, but its sizes are required.
            out.parent("Dimensions", |out| {
                sizes(out, &[("Length", length), ("Width", width), ("Height", opening.height_mm)]);
            });
            if opening.is_round {
                out.leaf("Shape", "Align_Z");
            }
            out.leaf("NumEmitter", "1");
        });
        out.parent("Equipment", |out| {
            out.parent("Gonioradiometer", |out| out.leaf("Type", "CIE_C"));
        });
        out.parent("Emitter", |out| emitter(out, luminaire, &mut remarks));
    });
    WrittenLuminaire { text: out.finish(), remarks }
}

/// Who made the luminaire and its data.
fn header(out: &mut XmlText, luminaire: &Luminaire, remarks: &mut Vec<String>) {
    let text = |keyword: &str| one_line(luminaire.text(keyword).unwrap_or_default(), usize::MAX);
    for (name, keyword) in [("Manufacturer", "MANUFAC"), ("CatalogNumber", "LUMCAT")] {
        if luminaire.text(keyword).is_some() {
            out.leaf(name, &text(keyword));
        }
    }
    // Required, and empty where the text is not known.
    out.leaf("Description", &text("LUMINAIRE"));
    out.leaf("Laboratory", &text("TESTLAB"));
    out.leaf("ReportNumber", &text("TEST"));
    let date = iso_date(&text("ISSUEDATE"));
    match &date {
        Some(date) => out.leaf("ReportDate", date),
        None => remarks.push(
            match text("ISSUEDATE") {
                none if none.is_empty() => {
                    "TM-33 requires the date of the report, which is missing: give the text ISSUEDATE, such as 2024-11-25"
                        .to_owned()
                }
                other => format!(
                    "TM-33 requires the date of the report, and `{other}` is not understood: write ISSUEDATE as 2024-11-25"
                ),
            },
        ),
    }
    for (place, (keyword, text)) in luminaire.texts.iter().enumerate() {
        let is_first = luminaire.texts[..place].iter().all(|(before, _)| before != keyword);
        let is_date = keyword == "ISSUEDATE" && date.is_some();
        let is_written = is_first && (is_date || OWN_ELEMENT.contains(&&keyword[..]));
        let text = one_line(text, usize::MAX);
        if !text.is_empty() && !is_written {
            out.leaf("Comment", &format!("{keyword}: {text}"));
        }
    }
}

/// All lamps as one emitter.
fn emitter(out: &mut XmlText, luminaire: &Luminaire, remarks: &mut Vec<String>) {
    let Luminaire { lamps, power_w, opening, colour, intensities, .. } = luminaire;
    let text = |keyword: &str| one_line(luminaire.text(keyword).unwrap_or_default(), usize::MAX);
    out.leaf("Quantity", "1");
    out.leaf("Description", &text("LAMP"));
    if luminaire.text("LAMPCAT").is_some() {
        out.leaf("CatalogNumber", &text("LAMPCAT"));
    }
    if let LampFlux::Relative { count, flux_lm } = *lamps {
        let flux = seven_digits(flux_lm);
        out.leaf("RatedLumens", &flux);
        let lamps = if count > 1 { format!("its {count} lamps") } else { "its lamp".to_owned() };
        remarks.push(format!(
            "relative photometry is written as absolute, with {lamps} as one emitter of {flux} lm"
        ));
    }
    out.leaf("InputWattage", &seven_digits(*power_w));
    if let Some(kelvin) = colour.temperature_k() {
        out.parent("ColorTemperature", |out| out.leaf("FixedCCT", &format!("{kelvin:.0}")));
    }
    if let Some(index) = colour.rendering_ra() {
        out.parent("ColorRendering", |out| {
            out.parent("CIE_CRI", |out| out.leaf("Ra", &format!("{index:.0}")));
        });
    }
    data_generation(out, luminaire.generation);
    out.parent("LuminousData", |out| {
        out.parent("LuminousIntensity", |out| luminous_intensity(out, intensities));
        out.leaf("LuminousFlux", &seven_digits(intensities.flux()));
    });
    if opening.is_round && opening.along_c0_mm != opening.along_c90_mm {
        remarks.push("the opening is an ellipse; it is written as a circle of its area".to_owned());
    }
    emission_areas(out, opening, intensities);
}

/// How the intensities were obtained. The body that accredits a laboratory is not known, so accreditation has no element.
fn data_generation(out: &mut XmlText, generation: FileGeneration) {
    let mut write = |answers: &[(&str, bool)]| {
        out.parent("DataGeneration", |out| {
            answers.iter().for_each(|(name, is)| out.leaf(name, &is.to_string()));
        });
    };
    match generation {
        FileGeneration::Undefined => {}
        FileGeneration::Simulated => write(&[("Simulation", true)]),
        FileGeneration::Measured { is_interpolated, is_scaled, .. } => write(&[
            ("Simulation", false),
            ("IntensityScaling", is_scaled),
            ("AngleInterpolation", is_interpolated),
        ]),
    }
}

/// Intensities, cd, plane by plane over the whole circle, with the first plane again at 360°.
fn luminous_intensity(out: &mut XmlText, intensities: &Intensities) {
    let mut planes = intensities.circle();
    if intensities.symmetry() != PlaneSymmetry::Rotational {
        planes.push(360.0);
    }
    let angles = intensities.angles_deg();
    out.leaf("AbsolutePhotometry", "true");
    out.leaf("NumberMeasured", &(planes.len() * angles.len()).to_string());
    out.leaf("NumberHorz", &planes.len().to_string());
    out.leaf("NumberVert", &angles.len().to_string());
    let angle_texts: Vec<String> = angles.iter().map(|angle| seven_digits(*angle)).collect();
    for plane in planes {
        let h = seven_digits(plane);
        for (angle, v) in angles.iter().zip(&angle_texts) {
            let value = seven_digits(intensities.at(plane, *angle));
            out.leaf_at("IntData", &[("h", &h), ("v", v)], &value);
        }
    }
}

/// The faces of the opening that send light; none for a point.
fn emission_areas(out: &mut XmlText, opening: &Opening, intensities: &Intensities) {
    let [length, width] = horizontal_sizes(opening);
    let height = opening.height_mm;
    if [length, width, height] == [0.0; 3] {
        return;
    }
    let flux = intensities.flux();
    let is_lit = |from: f64, to: f64| intensities.flux_between(from, to) > LEAST_SHARE * flux;
    let faces = [("Top", is_lit(90.0, 180.0)), ("Bottom", is_lit(0.0, 90.0))];
    let sides = ["C0", "C90", "C180", "C270"];
    let has_sides = height > 0.0;
    if !has_sides && faces.iter().all(|(_, is_lit)| !is_lit) {
        return;
    }
    out.parent("EmissionAreas", |out| {
        for (face, _) in faces.iter().filter(|(_, is_lit)| *is_lit) {
            let sizes = [("Length", length), ("Width", width)];
            let marks: &[&str] = if opening.is_round { &["Circular"] } else { &[] };
            emission_face(out, face, &sizes, marks);
        }
        // A side is as long as the axis across its plane.
        for (place, side) in sides.iter().enumerate().filter(|_| has_sides) {
            let across =
                if place.is_multiple_of(2) { ("Length", length) } else { ("Width", width) };
            emission_face(out, side, &[across, ("Height", height)], &[]);
        }
    });
}

/// A face with one area in its middle, and what is true of the area.
fn emission_face(out: &mut XmlText, face: &str, of: &[(&str, f64); 2], marks: &[&str]) {
    out.parent(&format!("{face}Face"), |out| {
        out.leaf(&format!("Number{face}"), "1");
        out.parent(&format!("{face}Area"), |out| {
            sizes(out, of);
            of.iter().for_each(|(name, _)| out.leaf(&format!("{name}Offset"), "0"));
            marks.iter().for_each(|mark| out.leaf(mark, "true"));
        });
    });
}

/// Length and width of the opening, mm. The faces toward C0 and C180 have a length and those toward C90 and C270 a width, so the length lies
/// along C90, as in EULUMDAT.
fn horizontal_sizes(opening: &Opening) -> [f64; 2] {
    match opening.is_round {
        true => [(opening.along_c90_mm * opening.along_c0_mm).sqrt(); 2],
        false => [opening.along_c90_mm, opening.along_c0_mm],
    }
}

/// Elements with sizes, given in mm, written in m.
fn sizes(out: &mut XmlText, of: &[(&str, f64)]) {
    of.iter().for_each(|(name, size_mm)| out.leaf(name, &seven_digits(size_mm / 1000.0)));
}
