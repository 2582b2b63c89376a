//! Files that are read and written, and files that are not.

mod goniometer_types;
mod ldt;
mod tm33;
mod tm33_schema;

use super::*;
use crate::bytes::tests::mutants;

/// A Lambertian emitter of 1000 cd, every 10°.
const LAMBERT: &str = "IESNA:LM-63-2002\r\n[TEST] 7\r\n[TESTLAB] none\r\n[ISSUEDATE] 2025\r\n[MANUFAC] Blöd & Söhne\r\n\
    [LUMCAT] L-10\r\n[OTHER] first\r\n[MORE] second\r\nTILT=NONE\r\n1 -1 1 10 1 1 2 0.05 0.08 0\r\n1 1 12.5\r\n\
    0 10 20 30 40 50 60 70 80 90\r\n0\r\n1000 984.807753 939.692621 866.025404 766.044443\r\n\
    642.787610 500 342.020143 173.648178 0\r\n";

fn ies(text: &str) -> Result<ReadLuminaire, LuminaireError> {
    parse(text.as_bytes(), LuminaireFormat::Ies)
}

fn luminaire(symmetry: PlaneSymmetry, planes: &[f64]) -> Luminaire {
    let angles = vec![0.0, 30.0, 60.0, 90.0, 180.0];
    let is_pole = |angle: f64| angle == 0.0 || angle == 180.0;
    let of =
        |plane: f64, angle: f64| 100.0 + 0.3 * angle + if is_pole(angle) { 0.0 } else { plane };
    let candela =
        planes.iter().flat_map(|plane| angles.iter().map(|angle| of(*plane, *angle))).collect();
    Luminaire {
        texts: [("TEST", "12"), ("MANUFAC", "A°"), ("LUMINAIRE", "lamp"), ("LAMP", "LED")]
            .map(|(keyword, text)| (keyword.to_owned(), text.to_owned()))
            .to_vec(),
        generation: FileGeneration::Undefined,
        lamps: LampFlux::Relative { count: 2, flux_lm: 6000.0 },
        power_w: 25.0,
        opening: Opening {
            is_round: false,
            along_c0_mm: 600.0,
            along_c90_mm: 50.0,
            height_mm: 10.0,
        },
        colour: LuminaireColour { temperature: "3000".to_owned(), rendering: "82".to_owned() },
        intensities: Intensities::new(symmetry, planes.to_vec(), angles, candela).unwrap(),
    }
}

fn all_symmetries() -> [Luminaire; 5] {
    [
        luminaire(PlaneSymmetry::Rotational, &[0.0]),
        luminaire(PlaneSymmetry::Quadrants, &[0.0, 30.0, 90.0]),
        luminaire(PlaneSymmetry::AboutC0, &[0.0, 45.0, 90.0, 135.0, 180.0]),
        luminaire(PlaneSymmetry::AboutC90, &[90.0, 135.0, 180.0, 225.0, 270.0]),
        luminaire(PlaneSymmetry::None, &[0.0, 50.0, 90.0, 180.0, 270.0]),
    ]
}

#[test]
fn a_lambertian_file_is_read_to_the_last_digit() {
    let ReadLuminaire { luminaire, table_line, remarks } = ies(LAMBERT).unwrap();
    assert_eq!(table_line, 14);
    assert!((luminaire.intensities.flux() - 3133.59342).abs() < 3e-4);
    assert!((luminaire.intensities.at(200.0, 15.0) - 962.250_186_9).abs() < 1e-5);
    assert_eq!(luminaire.lamps, LampFlux::Absolute);
    let Opening { is_round, along_c0_mm, along_c90_mm, .. } = luminaire.opening;
    assert_eq!(
        (is_round, along_c0_mm, along_c90_mm),
        (false, 80.0, 50.0),
        "the length lies along C0"
    );
    assert_eq!(luminaire.text("OTHER"), Some("first\nsecond"));
    assert_eq!((luminaire.power_w, remarks.len()), (12.5, 0));
}

#[test]
fn luminaires_come_back_from_both_formats() {
    for luminaire in all_symmetries() {
        let no_colour = LuminaireColour::default();
        for (format, kept) in
            [(LuminaireFormat::Ies, no_colour), (LuminaireFormat::Ldt, luminaire.colour.clone())]
        {
            let text = written(&luminaire, format).text;
            assert!(text.lines().all(|line| line.len() < 256), "{format}");
            let back =
                parse(text.as_bytes(), format).unwrap_or_else(|error| panic!("{error}\n{text}"));
            assert_eq!(back.remarks, Vec::<String>::new(), "{format}");
            let Luminaire { intensities, lamps, opening, power_w, colour, .. } = &back.luminaire;
            assert_eq!(colour, &kept, "{format}");
            assert_eq!(intensities.symmetry(), luminaire.intensities.symmetry(), "{format}");
            assert_eq!(intensities.angles_deg(), luminaire.intensities.angles_deg());
            for (place, plane) in luminaire.intensities.planes_deg().iter().enumerate() {
                assert_eq!(intensities.planes_deg()[place], *plane, "{format}");
                let both = intensities.plane(place).iter().zip(luminaire.intensities.plane(place));
                // Half a unit of the seventh digit.
                both.for_each(|(own, other)| {
                    assert!((own / other - 1.0).abs() < 5e-7, "{own}, {other}");
                });
            }
            assert_eq!(
                (lamps, opening, power_w),
                (&luminaire.lamps, &luminaire.opening, &25.0),
                "{format}"
            );
            for keyword in ["TEST", "MANUFAC", "LUMINAIRE", "LAMP"] {
                assert_eq!(back.luminaire.text(keyword), luminaire.text(keyword), "{format}");
            }
            assert_eq!(written(&back.luminaire, format).text, text, "{format}, written again");
        }
    }
}

#[test]
fn the_edition_of_2019_keeps_how_a_file_was_made() {
    let measured =
        FileGeneration::Measured { is_accredited: true, is_interpolated: false, is_scaled: true };
    for (generation, line) in [
        (measured, "1 1.10100 25"),
        (FileGeneration::Simulated, "1 1.00010 25"),
        (FileGeneration::Undefined, "1 1.00001 25"),
    ] {
        let own = Luminaire { generation, ..all_symmetries()[1].clone() };
        let text = written(&own, LuminaireFormat::Ies2019).text;
        assert!(text.starts_with("IES:LM-63-2019\r\n"), "{text}");
        assert!(text.lines().any(|own| own == line), "{text}");
        let back = ies(&text).unwrap();
        assert_eq!((back.luminaire.generation, back.remarks.len()), (generation, 0));
        assert_eq!(written(&back.luminaire, LuminaireFormat::Ies2019).text, text);
        // All else is as in the edition of 2002.
        let other = written(&own, LuminaireFormat::Ies).text;
        let back = other.replace("IESNA:LM-63-2002", "IES:LM-63-2019").replace("1 1 25", line);
        assert_eq!(back, text);
        assert_eq!(ies(&other).unwrap().luminaire.generation, FileGeneration::Undefined);
    }
    let text = written(&all_symmetries()[1], LuminaireFormat::Ies2019).text;
    let read = ies(&text.replace("1.00001", "1.25")).unwrap();
    assert!(read.remarks[0].contains("file generation type 1.25"), "{:?}", read.remarks);
    let wrong = ies(&text.replace("1.00001", "x")).unwrap_err().to_string();
    assert!(wrong.contains("line 12: expected the file generation type, found `x`"), "{wrong}");
    // Type B has other angles than were measured.
    let of_b =
        of_type(2).replace("IESNA:LM-63-2002", "IES:LM-63-2019").replace("\n1 1 0", "\n1 1.1 0");
    let name = ies(&of_b).unwrap().luminaire.generation.name().unwrap();
    assert!(name.contains("interpolated"), "{name}");
}

#[test]
fn absolute_and_round_luminaires_come_back() {
    let opening = Opening { is_round: true, along_c0_mm: 80.0, along_c90_mm: 80.0, height_mm: 0.0 };
    let own = Luminaire { lamps: LampFlux::Absolute, opening, ..all_symmetries()[0].clone() };
    assert_eq!(
        (own.light_output_ratio(), all_symmetries()[0].light_output_ratio().is_some()),
        (None, true)
    );
    for format in [LuminaireFormat::Ies, LuminaireFormat::Ldt] {
        let back = parse(written(&own, format).text.as_bytes(), format).unwrap().luminaire;
        assert_eq!((back.lamps, back.opening), (own.lamps, own.opening), "{format}");
        assert!((back.intensities.flux() / own.intensities.flux() - 1.0).abs() < 1e-6, "{format}");
    }
}

#[test]
fn planes_that_a_format_cannot_name_are_written_without_symmetry() {
    let planes = [90.0, 150.0, 210.0, 270.0];
    let own = luminaire(PlaneSymmetry::AboutC90, &planes);
    let text = written(&own, LuminaireFormat::Ldt).text;
    let back = parse(text.as_bytes(), LuminaireFormat::Ldt).unwrap().luminaire.intensities;
    assert_eq!(back.symmetry(), PlaneSymmetry::None);
    for plane in (0..36).map(|n| 10.0 * f64::from(n)) {
        let both = [back.at(plane, 45.0), own.intensities.at(plane, 45.0)];
        assert!((both[0] / both[1] - 1.0).abs() < 1e-6, "{plane}: {both:?}");
    }
}

#[test]
fn an_opening_without_length_is_a_sphere_in_1995_and_a_standing_disk_later() {
    let text = LAMBERT.replace("0.05 0.08 0", "-0.05 0 -0.05");
    for (edition, is_round, along_c0_mm) in
        [("IESNA:LM-63-1995", true, 50.0), ("IESNA:LM-63-2002", false, 0.0)]
    {
        let rest = text.split_once('\n').unwrap().1;
        let opening = ies(&format!("{edition}\n{rest}")).unwrap().luminaire.opening;
        let expected = Opening { is_round, along_c0_mm, along_c90_mm: 50.0, height_mm: 50.0 };
        assert_eq!(opening, expected, "{edition}");
    }
}

#[test]
fn what_contradicts_itself_or_is_lost_is_remarked_on() {
    let remarks = |old: &str, new: &str| {
        let text = LAMBERT.replace(old, new);
        assert_ne!(text, LAMBERT, "{old}");
        ies(&text).unwrap().remarks.join("; ")
    };
    for (old, new, words) in [
        ("1 -1 1", "1 1000 1", "313 % of the light of its lamps"),
        ("1 -1 1", "1 -500 1", "-500 lm"),
        ("0.05 0.08 0", "50 80 0", "the luminous opening is 80 m long"),
        ("1 1 12.5", "1 1 -5", "power of -5 W"),
        ("1 1 12.5", "1 0.9 12.5", "after the ballast factor is 0.9"),
        ("0.05 0.08 0", "-0.05 0.08 -0.05", "a cylinder that lies"),
        ("80 90\r\n", "80 85\r\n", "beyond them the light is taken as 0"),
    ] {
        assert!(remarks(old, new).contains(words), "{new}: {}", remarks(old, new));
    }
    let hot = ies(&LAMBERT.replace("1 -1 1", "1 10 1")).unwrap_err().to_string();
    assert!(
        hot.contains("line 14") && hot.contains("% of the light of its lamps; correct"),
        "{hot}"
    );
    // All planes meet at the nadir.
    let crossing = "IESNA:LM-63-2002\r\nTILT=NONE\r\n1 -1 1 3 2 1 2 0.05 0.08 0\r\n1 1 12.5\r\n0 45 90\r\n0 90\r\n\
        100 200 0\r\n130 200 0\r\n";
    let remarks = ies(crossing).unwrap().remarks.join("; ");
    assert!(
        remarks.contains("disagree at 0° (nadir), which is a single direction: 100 to 130 cd"),
        "{remarks}"
    );
    let ellipse = ies(&LAMBERT.replace("0.05 0.08 0", "-0.05 -0.08 0")).unwrap().luminaire;
    let remarks = written(&ellipse, LuminaireFormat::Ies).remarks;
    assert!(remarks.len() == 1 && remarks[0].contains("beyond ASCII"), "{remarks:?}");
    // Long texts go on in further lines.
    let mut wordy = ellipse.clone();
    wordy.texts = vec![("OTHER".to_owned(), "0123456789".repeat(50))];
    let written_again = written(&wordy, LuminaireFormat::Ies);
    assert_eq!(written_again.remarks, [""; 0]);
    let back = ies(&written_again.text).unwrap().luminaire;
    assert_eq!(back.text("OTHER").unwrap().replace('\n', ""), "0123456789".repeat(50));
}

#[test]
fn editions_differ_in_their_factors_and_tilt_is_remarked_on() {
    let flux = |head: &str, tilt: &str| {
        let text = format!("{head}{tilt}\n1 -1 2 2 1 1 1 -1 0 0\n0.9 0.5 0\n0 90\n0\n10 10\n");
        let read = ies(&text).unwrap_or_else(|error| panic!("{error}"));
        (read.luminaire.intensities.peak(), read.remarks.len(), read.luminaire.opening)
    };
    // The second number, 0.5, is a factor until 1991.
    let (peak, remarks, opening) = flux("IESNA:LM-63-2002\n", "TILT=NONE");
    assert_eq!((peak, remarks), (18.0, 1));
    assert_eq!(
        [opening.along_c0_mm, opening.along_c90_mm],
        [304.8; 2],
        "a circle of a foot, as in 1995"
    );
    assert!(opening.is_round);
    for (head, remarks) in [("", 1), ("A label\n", 1), ("IESNA91\n", 0), ("\nIESNA91\n", 0)] {
        let found = flux(head, "TILT=NONE");
        assert_eq!((found.0, found.1), (9.0, remarks), "{head}");
    }
    let (peak, remarks, _) = flux("IES:LM-63-2099\n", "TILT=NONE");
    assert_eq!((peak, remarks), (18.0, 2));
    let aside = "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 2 1 1 2 0 0 0\n1 1 0\n0 90\n45\n10 10\n";
    assert!(ies(aside).unwrap().remarks[0].contains("only plane is at 45"));
    // Since 2019 the second number is no factor, and 0.5 is none of its values.
    let (peak, remarks, _) = flux("IES:LM-63-2019\n", "TILT = INCLUDE\n1\n2\n0 90\n1 0.8");
    assert_eq!((peak, remarks), (18.0, 2));
    assert_eq!(flux("IESNA:LM-63-2002\n", "TILT=lamp.tlt").1, 2);
}

/// A file with a photometric type: of three horizontal by three vertical angles.
fn of_type(number: u32) -> String {
    let head = "IESNA:LM-63-2002\nTILT=NONE\n1 -1 2 3 3";
    format!("{head} {number} 2 0.2 0.4 0\n1 1 0\n-90 0 90\n-90 0 90\n0 1 2\n0 9 4\n0 6 3\n")
}

#[test]
fn types_a_and_b_turn_their_axes_to_those_of_type_c() {
    let [a, b] = [3, 2].map(|number| ies(&of_type(number)).unwrap());
    // Values at (horizontal, vertical) = (0, 0), (0, 90), (-90, 0) and (90, 0), and the multiplier 2.
    let at = |read: &ReadLuminaire, points: [[f64; 2]; 4]| {
        points.map(|[plane, angle]| read.luminaire.intensities.at(plane, angle).round())
    };
    assert_eq!(
        at(&a, [[0.0, 90.0], [0.0, 180.0], [90.0, 90.0], [270.0, 90.0]]),
        [18.0, 8.0, 2.0, 12.0]
    );
    assert_eq!(
        at(&b, [[0.0, 0.0], [0.0, 90.0], [90.0, 90.0], [270.0, 90.0]]),
        [18.0, 8.0, 2.0, 12.0]
    );
    for (read, words) in [(&a, "type A"), (&b, "type B")] {
        assert!(read.remarks.len() == 1 && read.remarks[0].contains(words), "{:?}", read.remarks);
        assert_eq!(read.luminaire.opening.along_c0_mm, 400.0);
    }
    let error = ies(&of_type(1)).unwrap_err().to_string();
    assert!(error.contains("line 6: horizontal angles from -90 to 90"), "{error}");
    let wide = of_type(2).replace("-90 0 90\n-90 0 90", "-90 0 90\n-180 0 180");
    let error = ies(&wide).unwrap_err().to_string();
    assert!(error.contains("line 6") && error.contains("from -180 to 180"), "{error}");
}

#[test]
fn errors_name_the_line_and_what_is_wrong() {
    for (old, new, line, words) in [
        ("TILT=NONE", "", 15, "TILT"),
        ("1 -1 1 10 1 1", "1 -1 1 10 1 4", 10, "type 4, expected 1 (C), 2 (B) or 3 (A)"),
        ("1 -1 1 10 1 1", "1 -1 1 10 1 2", 13, "two or more for type A or B"),
        ("1 -1 1 10", "1 -1 1 11", 13, "0 follows 90"),
        ("\r\n642.787610", "", 14, "ends before"),
        ("500 342", "-500 342", 15, "-500"),
        ("70 80 90", "80 70 90", 12, "must increase"),
        ("1 -1 1 10", "1 -1 0 10", 10, "above 0"),
        ("1 -1 1 10", "1 -1 1 1e7", 10, "expected 1 to 4096"),
        ("342.020143", "x342", 15, "found `x342`"),
        ("173.648178 0", "173.648178 0 1", 15, "follows"),
        ("2 0.05", "3 0.05", 10, "expected 1 (feet)"),
        ("1 1 12.5", "1 nan 12.5", 11, "found `nan`"),
    ] {
        let text = LAMBERT.replace(old, new);
        assert_ne!(text, LAMBERT, "{old}");
        let error = ies(&text).unwrap_err().to_string();
        assert!(
            error.contains(&format!("line {line}: ")) && error.contains(words),
            "{old}: {error}"
        );
    }
    let high = ies(&LAMBERT.replace("80 90", "80 200"));
    let high = high.unwrap_err().to_string();
    assert!(high.contains("line 14: no usable distribution: an angle lies outside"), "{high}");
    for (text, words) in [("", "empty"), ("a\0b", "no text"), ("TILTED lamp\n1 2", "TILT=")] {
        assert!(ies(text).unwrap_err().to_string().contains(words), "{text}");
    }
    assert!(matches!(read(Path::new("a.txt")), Err(LuminaireError::UnknownLuminaire { .. })));
    assert!(matches!(read(Path::new("missing.ies")), Err(LuminaireError::Unreadable(_))));
}

#[test]
fn damaged_files_are_luminaires_or_errors() {
    let ldt = written(&all_symmetries()[2], LuminaireFormat::Ldt).text;
    let [type_a, type_b] = [3, 2].map(of_type);
    let files = [(LAMBERT, LuminaireFormat::Ies), (&ldt, LuminaireFormat::Ldt)];
    let files = files
        .into_iter()
        .chain([&type_a, &type_b].map(|text| (text.as_str(), LuminaireFormat::Ies)));
    let mut usable = [0; 4];
    for (kind, (original, format)) in files.enumerate() {
        // Those of type B are interpolated, which takes longer.
        let count = if kind == 3 { 8_000 } else { 100_000 };
        for bytes in mutants(original.as_bytes(), count, kind as u64) {
            let Ok(read) = parse(&bytes, format) else { continue };
            usable[kind] += 1;
            let intensities = &read.luminaire.intensities;
            assert!(intensities.flux().is_finite() && intensities.flux() >= 0.0);
            assert!(intensities.at(33.0, 45.0) <= intensities.peak() * (1.0 + 1e-12));
            // What was read can be written, and read again.
            let again = parse(written(&read.luminaire, format).text.as_bytes(), format);
            assert!(again.is_ok(), "{again:?}");
        }
    }
    assert!(usable.iter().all(|count| *count > 100), "{usable:?}");
}
