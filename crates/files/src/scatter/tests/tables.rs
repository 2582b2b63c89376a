//! Sizes of tables, and their places in the file.

use crate::scatter::tests::{csv_of, good, refused, xml};
use crate::scatter::{ScatterFormat, ScatterSide};

#[test]
fn tables_have_the_line_of_their_first_value() {
    let tree = |direction| (direction, "", "<!-- two\nlines -->\n\n{ 0.1 }".to_owned());
    let file = xml("TensorTree4", "", &[tree("Transmission"), tree("Reflection Front")]);
    let ScatterSide { reflection, transmission } = good(&file, ScatterFormat::Xml).front;
    let line = |from: usize| {
        let all = file.lines().enumerate().skip(from).find(|(_, line)| line.contains("{ 0.1"));
        all.unwrap().0 + 1
    };
    let first = line(0);
    assert_eq!([transmission, reflection].map(|own| own.unwrap().line), [first, line(first)]);
    let klems = "\n\n0.1 ".to_owned() + &"0.1 ".repeat(41 * 41 - 1);
    let file = xml("Columns", "", &[("Reflection Back", "LBNL/Klems Quarter", klems)]);
    let line = 1 + file.lines().position(|line| line.starts_with("0.1")).unwrap();
    assert_eq!(good(&file, ScatterFormat::Xml).back.reflection.unwrap().line, line);
    // A comment and the names of the columns come first.
    let csv = good(&csv_of(|_, _, _| 0.1), ScatterFormat::Csv);
    assert_eq!([csv.front, csv.back].map(|side| side.reflection.unwrap().line), [3, 3]);
}

#[test]
fn rings_and_sectors_are_limited() {
    let block = |from: f64, to: f64, phis: usize| {
        format!(
            "<AngleBasisBlock><nPhis>{phis}</nPhis><ThetaBounds><LowerTheta>{from}</LowerTheta>\
             <UpperTheta>{to}</UpperTheta></ThetaBounds></AngleBasisBlock>\n"
        )
    };
    let file = |rings: usize, phis: usize| {
        let edge = |ring: usize| 90.0 * ring as f64 / rings as f64;
        let blocks: String = (0..rings).map(|n| block(edge(n), edge(n + 1), phis)).collect();
        let basis =
            format!("<AngleBasis><AngleBasisName>own</AngleBasisName>{blocks}</AngleBasis>");
        xml("Columns", &basis, &[("Reflection Front", "own", "0.1 ".to_owned())])
    };
    for (rings, phis, part) in [
        (257, 1, "more than 256 rings"),
        (1, 1025, "nPhis is `1025`, expected 1 to 1024"),
        (5, 1024, "more than 4096 patches"),
        (256, 1, "need 65536"),
    ] {
        refused(&file(rings, phis), ScatterFormat::Xml, &["line", part]);
    }
}

#[test]
fn remarks_of_several_trees_are_made_once() {
    let tree = |direction| (direction, "", format!("{{ {} }}", "{ 0.1 }".repeat(8)));
    let file = xml("TensorTree3", "", &[tree("Transmission"), tree("Reflection Front")]);
    let remarks = good(&file, ScatterFormat::Xml).remarks;
    assert_eq!(remarks, ["its tree without grain is averaged over rings and sectors"]);
    let mut deep = "{ 3 }".to_owned();
    for _ in 0..7 {
        deep = format!("{{ {} }}", deep.clone() + &"{ 0 }".repeat(7));
    }
    let tree = |direction| (direction, "", deep.clone());
    let file = xml("TensorTree3", "", &[tree("Transmission"), tree("Reflection Front")]);
    assert_eq!(good(&file, ScatterFormat::Xml).remarks.len(), 2);
}
