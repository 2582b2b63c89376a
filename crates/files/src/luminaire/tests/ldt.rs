//! Fields of EULUMDAT files.

use crate::luminaire::tests::{LAMBERT, all_symmetries, ies};
use crate::luminaire::{LuminaireFormat, PlaneSymmetry, parse, written};

#[test]
fn a_downward_flux_fraction_is_a_share_of_the_light() {
    const LINE: usize = 22;
    let own = written(&all_symmetries()[3], LuminaireFormat::Ldt).text;
    let with = |fraction: &str| {
        let mut lines: Vec<&str> = own.lines().collect();
        lines[LINE - 1] = fraction;
        parse(lines.join("\n").as_bytes(), LuminaireFormat::Ldt)
    };
    for good in ["0", "", "99,9", "100.0", "100.4"] {
        assert!(with(good).is_ok(), "{good}");
    }
    for bad in ["150", "-1", "100.6"] {
        let said = with(bad).unwrap_err().to_string();
        let words =
            format!("line {LINE}: the downward flux fraction is {bad} %, expected 0 to 100");
        assert!(said.contains(&words), "{said}");
    }
}

#[test]
fn what_eulumdat_loses_or_contradicts_is_remarked_on() {
    let ellipse = ies(&LAMBERT.replace("0.05 0.08 0", "-0.05 -0.08 0")).unwrap().luminaire;
    let mut wordy = ellipse.clone();
    wordy.texts = vec![("LAMP".to_owned(), "COB LED module of 3000 K".to_owned())];
    assert_eq!(written(&wordy, LuminaireFormat::Ldt).remarks.len(), 1);
    wordy.texts[0].1 += ", CRI 90";
    let remarks = written(&wordy, LuminaireFormat::Ldt).remarks;
    assert!(remarks[0].contains("of the 32 letters of LAMP"), "{remarks:?}");
    let written = written(&ellipse, LuminaireFormat::Ldt);
    assert!(written.remarks[0].contains("an ellipse"), "{:?}", written.remarks);
    assert!(written.remarks[1].contains("beyond ASCII"), "{:?}", written.remarks);
    let back = parse(written.text.as_bytes(), LuminaireFormat::Ldt).unwrap().luminaire.opening;
    assert!((back.along_c0_mm - 4000f64.sqrt()).abs() < 1e-4, "{back:?}");
    let types = written.text.replacen("\r\n1\r\n", "\r\n7\r\n", 1);
    let read = parse(types.as_bytes(), LuminaireFormat::Ldt).unwrap();
    assert!(read.remarks[0].contains("type of luminaire is 7"), "{:?}", read.remarks);
    let steps = written.text.replacen("\r\n10\r\n10\r\n", "\r\n10\r\n5\r\n", 1);
    let read = parse(steps.as_bytes(), LuminaireFormat::Ldt).unwrap();
    assert!(
        read.remarks.iter().any(|remark| remark.contains("not 5° apart")),
        "{:?}",
        read.remarks
    );
}

#[test]
fn eulumdat_with_commas_and_several_sets_is_read() {
    let own = written(&all_symmetries()[3], LuminaireFormat::Ldt).text;
    let mut lines: Vec<String> = own.lines().map(str::to_owned).collect();
    assert_eq!(lines[25], "1", "sets of lamps");
    lines[25] = "2".to_owned();
    let second = ["3", "old", "9000,5", "3000", "80", "70"].map(str::to_owned);
    lines.splice(32..32, second);
    let text = lines.join("\n").replace("166.6667", "166,6667");
    let read = parse(text.as_bytes(), LuminaireFormat::Ldt).unwrap();
    assert_eq!(read.luminaire.intensities.symmetry(), PlaneSymmetry::AboutC90);
    assert_eq!(read.luminaire.lamps, all_symmetries()[3].lamps);
    assert_eq!(read.remarks, ["of 2 sets of lamps the first is used"]);
    for (temperature, rendering, expected) in [
        ("3500 K", "80", [Some(3500.0), Some(80.0)]),
        ("warm white", "1B", [None, None]),
        ("840", ">80", [None, None]),
    ] {
        lines[29] = temperature.to_owned();
        lines[30] = rendering.to_owned();
        let read = parse(lines.join("\n").as_bytes(), LuminaireFormat::Ldt).unwrap().luminaire;
        let stated = [read.colour.temperature_k(), read.colour.rendering_ra()];
        assert_eq!(stated, expected, "{temperature}");
        // The words are kept.
        let again: Vec<String> =
            written(&read, LuminaireFormat::Ldt).text.lines().map(str::to_owned).collect();
        assert_eq!(again[29..31], [temperature, rendering]);
        let ies = written(&read, LuminaireFormat::Ies).text;
        assert!(ies.contains(&format!("[OTHER] colour rendering: {rendering}")), "{ies}");
    }
}
