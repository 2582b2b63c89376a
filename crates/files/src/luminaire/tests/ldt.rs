//! Fields of EULUMDAT files.

use crate::luminaire::tests::all_symmetries;
use crate::luminaire::{LuminaireFormat, parse, written};

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
