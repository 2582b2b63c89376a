mod csv;
mod tables;

use super::*;
use crate::bytes::tests::mutants;
use glam::DVec2;
use lumiduct_base::math::PatchPairs;
use std::f64::consts::PI;
use std::fmt::Write;

const KLEMS_QUARTER: usize = 41;

/// A file with a block for each direction.
fn xml(layout: &str, definition: &str, blocks: &[(&str, &str, String)]) -> String {
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<WindowElement><Optical><Layer>\n<DataDefinition>\
         <IncidentDataStructure>{layout}</IncidentDataStructure>{definition}</DataDefinition>\n"
    );
    for (direction, basis, data) in blocks {
        let bases = if layout.starts_with("Tensor") {
            "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>".to_owned()
        } else {
            format!(
                "<ColumnAngleBasis>{basis}</ColumnAngleBasis><RowAngleBasis>{basis}</RowAngleBasis>"
            )
        };
        _ = write!(
            text,
            "<WavelengthData><Wavelength unit=\"Integral\">Visible</Wavelength>\n<WavelengthDataBlock>\
             <WavelengthDataDirection>{direction}</WavelengthDataDirection>\n{bases}\
             <ScatteringData>\n{data}\n</ScatteringData></WavelengthDataBlock></WavelengthData>\n"
        );
    }
    text + "</Layer></Optical></WindowElement>\n"
}

/// Values by row and column, a row a line.
fn matrix(size: usize, value: impl Fn(usize, usize) -> f64) -> String {
    let row = |row| (0..size).map(|column| value(row, column).to_string()).collect::<Vec<_>>();
    (0..size).map(|number| row(number).join(",\t") + ",\n").collect()
}

fn quarter(layout: &str) -> String {
    let data = matrix(KLEMS_QUARTER, |row, column| (row + 100 * column) as f64 / 1e6);
    xml(layout, "", &[("Transmission Front", "LBNL/Klems Quarter", data)])
}

pub(crate) fn good(text: &str, format: ScatterFormat) -> ScatterFile {
    parse(text.as_bytes(), format).unwrap()
}

pub(crate) fn refused(text: &str, format: ScatterFormat, parts: &[&str]) {
    let error = parse(text.as_bytes(), format).unwrap_err().to_string();
    assert!(parts.iter().all(|part| error.contains(part)), "{error}: {parts:?}");
}

pub(crate) fn csv_of(value: impl Fn(f64, f64, f64) -> f64) -> String {
    let mut text = "# a sample\ntheta_i_deg, theta_s_deg, phi_s_deg, brdf_per_sr\n".to_owned();
    for i in [0.0, 30.0, 60.0, 80.0] {
        for s in [0.0, 15.0, 45.0, 90.0] {
            for phi in [0.0, 90.0, 180.0] {
                _ = writeln!(text, "{i},{s},{phi},{}", value(i, s, phi));
            }
        }
    }
    text
}

/// Light that leaves from each ring of arriving light, 1.
pub(crate) fn shares(matrix: &BsdfMatrix) -> Vec<f64> {
    let [_, count] = matrix.pairs.counts();
    let share = |values: &[f64]| -> f64 {
        values.iter().zip(0..).map(|(f, at)| f * matrix.pairs.leaving_projected(at)).sum()
    };
    matrix.values.chunks(count).map(share).collect()
}

#[test]
fn columns_are_incident_and_rows_leaving_directions() {
    let columns = good(&quarter("Columns"), ScatterFormat::Xml);
    let matrix = columns.front.transmission.unwrap();
    assert_eq!(matrix.pairs.counts(), [KLEMS_QUARTER; 2]);
    // Incident patch 3, leaving patch 7.
    assert!((matrix.values[3 * KLEMS_QUARTER + 7] - 307e-6).abs() < 1e-12);
    let rows = good(&quarter("Rows"), ScatterFormat::Xml).front.transmission.unwrap();
    assert!((rows.values[7 * KLEMS_QUARTER + 3] - 307e-6).abs() < 1e-12);
    assert_eq!(columns.back, ScatterSide::default());
}

#[test]
fn letters_of_directions_and_comments_do_not_matter() {
    let file = quarter("Columns");
    let other = file.replace("Transmission Front", "transmission front");
    let other = other.replace("<ScatteringData>", "<ScatteringData><!-- W/W sr -->");
    assert_eq!(good(&file, ScatterFormat::Xml), good(&other, ScatterFormat::Xml));
}

#[test]
fn the_type_of_scattering_data_fits_their_direction() {
    let file = |direction: &str, kind: &str| {
        let data = matrix(KLEMS_QUARTER, |_, _| 0.1);
        let all = xml("Columns", "", &[(direction, "LBNL/Klems Quarter", data)]);
        all.replacen(
            "<ScatteringData>",
            &format!("\n<ScatteringDataType>{kind}</ScatteringDataType><ScatteringData>"),
            1,
        )
    };
    for (direction, kind) in
        [("Transmission Back", " btdf "), ("Reflection Back", "BRDF"), ("Reflection Front", "BSDF")]
    {
        assert_eq!(good(&file(direction, kind), ScatterFormat::Xml).remarks, [""; 0]);
    }
    // Programs of Radiance write this.
    let other = good(&file("Reflection Back", "BTDF"), ScatterFormat::Xml);
    assert!(other.remarks[0].contains("of reflection is BTDF"), "{:?}", other.remarks);
    assert!(other.back.reflection.is_some());
    for (direction, kind, part) in [
        (
            "Transmission Front",
            "BRDF",
            "`BRDF`, a reflection, but WavelengthDataDirection is `Transmission Front`",
        ),
        ("Transmission Front", "", "ScatteringDataType is ``, expected BTDF or BRDF"),
        ("Reflection Front", "Reflectance", "`Reflectance`, expected BTDF or BRDF: values in 1/sr"),
    ] {
        refused(&file(direction, kind), ScatterFormat::Xml, &["line 7", part]);
    }
}

#[test]
fn klems_bases_have_their_patches() {
    for (name, count) in [("Full", 145), ("Half", 77), ("Quarter", 41)] {
        let basis = format!("LBNL/Klems {name}");
        let file = xml("Columns", "", &[("Reflection Back", &basis, matrix(count, |_, _| 0.1))]);
        let matrix = good(&file, ScatterFormat::Xml).back.reflection.unwrap();
        assert_eq!(matrix.pairs.counts(), [count; 2]);
        let sum: f64 = (0..count).map(|patch| matrix.pairs.leaving_projected(patch)).sum();
        assert!((sum - PI).abs() < 1e-12);
    }
    // The second patch of Klems Full lies about the azimuth 0, between 5 and 15 deg: W6 manual, table of the basis.
    let file =
        xml("Columns", "", &[("Reflection Back", "LBNL/Klems Full", matrix(145, |_, _| 0.1))]);
    let PatchPairs::Fixed { incident, .. } =
        good(&file, ScatterFormat::Xml).back.reflection.unwrap().pairs
    else {
        panic!("a matrix has axes")
    };
    let polar = |deg: f64| DVec2::new(deg.to_radians().sin(), 0.0);
    assert_eq!([4.9, 5.1, 14.9, 15.1].map(|deg| incident.patch(polar(deg))), [0, 1, 1, 9]);
}

#[test]
fn a_file_may_define_its_basis() {
    let block = |from: f64, to: f64, phis: usize| {
        format!(
            "<AngleBasisBlock><Theta>0</Theta><nPhis>{phis}</nPhis><ThetaBounds><LowerTheta>{from}</LowerTheta>\
             <UpperTheta>{to}</UpperTheta></ThetaBounds></AngleBasisBlock>"
        )
    };
    let definition = |blocks: &[String]| {
        let blocks = blocks.concat();
        format!("<AngleBasis><AngleBasisName>own</AngleBasisName>{blocks}</AngleBasis>")
    };
    let file = |blocks: &[String]| {
        xml("Columns", &definition(blocks), &[("Reflection Front", "own", matrix(5, |_, _| 0.1))])
    };
    let right = [block(0.0, 30.0, 1), block(30.0, 90.0, 4)];
    let pairs = good(&file(&right), ScatterFormat::Xml).front.reflection.unwrap().pairs;
    assert!((pairs.leaving_projected(0) - PI * 0.25).abs() < 1e-12);
    for (wrong, part) in [
        ([block(0.0, 30.0, 1), block(31.0, 90.0, 4)], "the ring before ends at 30"),
        ([block(0.0, 30.0, 1), block(30.0, 80.0, 4)], "from 0 to 90 deg"),
        ([block(0.0, 30.0, 0), block(30.0, 90.0, 4)], "nPhis is `0`"),
        ([block(0.0, 30.0, 4), block(30.0, 90.0, 4000)], "nPhis is `4000`, expected 1 to 1024"),
        ([block(0.0, f64::NAN, 1), block(30.0, 90.0, 4)], "from 0 to 90 deg"),
    ] {
        refused(&file(&wrong), ScatterFormat::Xml, &["line 3", part]);
    }
}

#[test]
fn trees_are_nodes_or_grids() {
    let tree = |text: &str| {
        good(&xml("TensorTree4", "", &[("Transmission", "", text.to_owned())]), ScatterFormat::Xml)
            .front
            .transmission
            .unwrap()
    };
    let one = tree("{ 0.25 }");
    assert_eq!((one.pairs.counts(), &one.values[..]), ([1, 1], &[0.25][..]));
    // Nodes count the first dimension fastest, grids the last one: node 1 is value 8.
    let nodes: String = (0..16).map(|node| format!("{{ {node} }}\n")).collect();
    let by_nodes = tree(&format!("{{{nodes}}}"));
    let number =
        |value: usize| [0, 1, 2, 3].map(|bit| (value >> bit & 1) << (3 - bit)).iter().sum();
    let grid: Vec<String> = (0..16)
        .map(|value| {
            let node: usize = number(value);
            node.to_string()
        })
        .collect();
    assert_eq!(by_nodes, tree(&format!("{{ {} }}", grid.join(", "))));
    assert_eq!(by_nodes.values[8], 1.0);
    // A divided node is refined, others keep their value.
    let deeper = nodes.replacen("{ 5 }", &format!("{{{nodes}}}"), 1);
    let fine = tree(&format!("{{{deeper}}}"));
    assert_eq!(fine.pairs.counts(), [16, 16]);
    let mean = |matrix: &BsdfMatrix| matrix.values.iter().sum::<f64>() / matrix.values.len() as f64;
    assert!((mean(&fine) - (120.0 - 5.0 + 7.5) / 16.0).abs() < 1e-12);
    // Deeper than what is kept: the mean, and a remark.
    let mut deep = "{ 3 }".to_owned();
    for _ in 0..7 {
        deep = format!("{{ {} }}", deep.clone() + &"{ 0 }".repeat(15));
    }
    let file = xml("TensorTree4", "", &[("Transmission", "", deep)]);
    let file = good(&file, ScatterFormat::Xml);
    assert!(file.remarks[0].contains("divided 7 times"), "{:?}", file.remarks);
    let kept = file.front.transmission.unwrap();
    assert_eq!(kept.pairs.counts(), [1024, 1024]);
    assert!((kept.values[0] - 3.0 / 256.0).abs() < 1e-15);
}

#[test]
fn trees_without_grain_keep_the_light_of_every_square() {
    // One of 8 x 8 squares has light, for the incident angles of the first half.
    let value = |from: usize, square: usize, lit: usize| {
        if from < 4 && square == lit { "9" } else { "0" }
    };
    for lit in [0, 9, 27, 30, 35, 63] {
        let all = (0..512).map(|at| value(at / 64, at % 64, lit)).collect::<Vec<_>>().join(" ");
        let file = xml("TensorTree3", "", &[("Reflection Front", "", format!("{{ {all} }}"))]);
        let matrix = good(&file, ScatterFormat::Xml).front.reflection.unwrap();
        for share in shares(&matrix) {
            assert!((share - 9.0 * PI / 64.0).abs() < 1e-12, "square {lit}: {share}");
        }
    }
}

#[test]
fn trees_without_grain_turn_with_the_light() {
    // Light leaves evenly into half of the directions, those ahead: x > 0 is the half of larger first coordinates.
    let nodes: String =
        (0..8).map(|node| if node & 2 == 0 { "{ 0 }" } else { "{ 0.2 }" }).collect();
    let deeper: String = (0..8)
        .map(|node| {
            if node & 2 == 0 { "{ 0 }".to_owned() } else { format!("{{{}}}", "{ 0.2 }".repeat(8)) }
        })
        .collect();
    for text in [nodes, deeper] {
        let file = xml("TensorTree3", "", &[("Reflection Front", "", format!("{{{text}}}"))]);
        let matrix = good(&file, ScatterFormat::Xml).front.reflection.unwrap();
        let PatchPairs::Isotropic { leaving, .. } = &matrix.pairs else { panic!("no grain") };
        let sectors = leaving.sectors(0);
        // The square's right half is not the disk's, but its middle sectors are.
        assert!((matrix.values[0] - 0.2).abs() < 1e-12);
        assert!(matrix.values[sectors / 2].abs() < 1e-12);
        let [_, count] = matrix.pairs.counts();
        let share: f64 =
            (0..count).map(|at| matrix.values[at] * matrix.pairs.leaving_projected(at)).sum();
        assert!((share - 0.1 * PI).abs() < 0.01, "{share}");
    }
}

#[test]
fn wrong_files_are_refused_with_their_line() {
    let all = quarter("Columns");
    for (old, new, parts) in [
        ("Columns<", "Lines<", &["line 3", "`Lines`", "Columns, Rows"][..]),
        ("Transmission Front", "Through", &["line 5", "`Through`"]),
        ("Klems Quarter", "Klems Third", &["Klems Third", "LBNL/Klems Full"]),
        ("\t0.0001,", "\t-0.0001,", &["line 7", "-0.0001 is negative"]),
        ("\t0.0001,", "\tnan,", &["line 7", "nan is not a usable value"]),
        ("\t0.0001,", "\tx,", &["line 7", "`x` is not a number"]),
        ("\t0.0001,", "", &["line 6", "1680 values", "need 1681"]),
        ("\t0.0001,", "0.1,\t0.0001,", &["1682 values", "need 1681"]),
        ("0.000003,", "<!-- 3\n4 --> 0.000003x,", &["line 11", "`0.000003x`"]),
        ("Visible", "Solar", &["no data for visible light"]),
        ("</ScatteringData>", "", &["line"]),
        ("DataDefinition", "Data", &["DataDefinition"]),
        ("<WindowElement>", "<!DOCTYPE x [<!ENTITY a \"b\">]><WindowElement>", &["DTD"]),
    ] {
        assert!(all.contains(old), "{old}");
        let count = if old == "DataDefinition" { 2 } else { 1 };
        refused(&all.replacen(old, new, count), ScatterFormat::Xml, parts);
    }
    let cut = &all[..all.find("</ScatteringData>").unwrap()];
    let last = format!("line {}", cut.lines().count());
    refused(cut, ScatterFormat::Xml, &[&last, "cut short"]);
    let twice = ("Reflection Front", "LBNL/Klems Quarter", matrix(KLEMS_QUARTER, |_, _| 0.1));
    let twice = xml("Columns", "", &[twice.clone(), twice]);
    refused(&twice, ScatterFormat::Xml, &["two visible blocks"]);
    for (text, part) in [
        ("", "ends before `{`"),
        ("{ 1 2 }", "a grid of 2 values"),
        ("{ {1} {2} }", "`}` instead of `{`"),
        ("{ 1 } 2", "follows"),
        ("{ -1 }", "-1 is negative"),
        (&"{".repeat(100_000), "more than 12 times"),
    ] {
        let file = xml("TensorTree4", "", &[("Transmission", "", text.to_owned())]);
        refused(&file, ScatterFormat::Xml, &["line", part]);
    }
    assert!(parse(b"\xff<a/>", ScatterFormat::Xml).unwrap_err().to_string().contains("UTF-8"));
    let unknown = ScatterFormat::of(Path::new("a.bsdf")).unwrap_err().to_string();
    assert!(unknown.contains(".xml or .csv"), "{unknown}");
}

#[test]
fn damaged_files_are_read_or_refused() {
    let block = |from: u32, to: u32, phis: u32| {
        format!(
            "<AngleBasisBlock><nPhis>{phis}</nPhis><ThetaBounds><LowerTheta>{from}</LowerTheta>\
             <UpperTheta>{to}</UpperTheta></ThetaBounds></AngleBasisBlock>\n"
        )
    };
    let basis = block(0, 40, 1) + &block(40, 90, 2);
    let basis = format!("<AngleBasis><AngleBasisName>own</AngleBasisName>{basis}</AngleBasis>\n");
    let small = xml("Columns", &basis, &[("Reflection Front", "own", matrix(3, |_, _| 0.1))]);
    let tree = format!("{{ {} }}", "{ 0.1 }\n".repeat(8));
    let tree = xml("TensorTree3", "", &[("Transmission", "", tree)]);
    const MUTANTS: u64 = 100_000;
    for (text, format) in [
        (small, ScatterFormat::Xml),
        (tree, ScatterFormat::Xml),
        (csv_of(|_, s, _| s * 1e-3), ScatterFormat::Csv),
    ] {
        let mut usable = 0;
        for bytes in mutants(text.as_bytes(), MUTANTS, 18) {
            let Ok(file) = parse(&bytes, format) else { continue };
            usable += 1;
            let sides = [file.front, file.back];
            for matrix in sides.into_iter().flat_map(|own| [own.reflection, own.transmission]) {
                let Some(matrix) = matrix else { continue };
                let [from, to] = matrix.pairs.counts();
                assert_eq!(matrix.values.len(), from * to);
                assert!(matrix.values.iter().all(|value| value.is_finite() && *value >= 0.0));
            }
        }
        assert!(0 < usable && usable < MUTANTS, "{format}: {usable} are usable");
    }
}
