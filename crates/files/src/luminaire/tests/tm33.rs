//! Files in TM-33, read with an XML reader and compared with the schema of ATLA S001.

use crate::luminaire::tests::tm33_schema::checked;
use crate::luminaire::tests::{LAMBERT, all_symmetries, ies};
use crate::luminaire::{
    FileGeneration, LampFlux, Luminaire, LuminaireFormat, Opening, read, written,
};
use roxmltree::{Document, Node};

/// The text of the only element of a name below an element.
fn text_of(document: &Document<'_>, parent: &str, name: &str) -> Option<String> {
    let parent = document.descendants().find(|node| node.has_tag_name(parent))?;
    let found: Vec<_> = parent.descendants().filter(|node| node.has_tag_name(name)).collect();
    assert!(found.len() <= 1, "{} elements {name}", found.len());
    found.first().map(|node| node.text().unwrap_or_default().to_owned())
}

/// With a date, which the schema requires.
fn dated(mut luminaire: Luminaire) -> Luminaire {
    luminaire.texts.push(("ISSUEDATE".to_owned(), "25-NOV-2024".to_owned()));
    luminaire
}

fn tm33(luminaire: &Luminaire) -> String {
    written(luminaire, LuminaireFormat::Tm33).text
}

#[test]
fn every_kind_of_luminaire_follows_the_schema() {
    let [round, flat, boxed, ..] = all_symmetries().map(dated);
    let of = |own: &Luminaire, is_round: bool, sizes: [f64; 3]| {
        let [along_c0_mm, along_c90_mm, height_mm] = sizes;
        Luminaire {
            opening: Opening { is_round, along_c0_mm, along_c90_mm, height_mm },
            ..own.clone()
        }
    };
    let of_2019 = |number: &str| Luminaire {
        generation: FileGeneration::of_number(number.parse().unwrap()).unwrap(),
        lamps: LampFlux::Absolute,
        ..flat.clone()
    };
    let mut all = all_symmetries().map(dated).to_vec();
    all.extend([
        of(&round, true, [80.0, 80.0, 0.0]),
        of(&round, true, [80.0, 40.0, 30.0]),
        of(&flat, false, [600.0, 0.0, 0.0]),
        of(&boxed, false, [0.0; 3]),
        of_2019("1.0001"),
        of_2019("1.111"),
        Luminaire { texts: vec![], ..dated(ies(LAMBERT).unwrap().luminaire) },
    ]);
    let undated = all.pop().unwrap();
    for luminaire in &all {
        checked(&tm33(luminaire)).unwrap_or_else(|why| panic!("{why} in {}", tm33(luminaire)));
    }
    // The comparison finds what is wrong.
    let text = tm33(&all[1]);
    for (old, new, words) in [
        ("IESTM33", "IESTM33-18", "IESTM33-18 is unknown"),
        ("1.0</", "1.1</", "Version contains `1.1`"),
        ("<Laboratory></Laboratory>", "", "Header has 0 elements Laboratory"),
        ("CIE_C", "C", "Type contains `C`"),
        ("2024-11-25", "25.11.2024", "ReportDate contains"),
        ("<IntData h=\"0\"", "<IntData c=\"0\"", "attributes [\"c\", \"v\"]"),
        (">100</IntData>", ">1e2</IntData>", "IntData contains `1e2`"),
        ("<NumberHorz>", "<Symm>Symm_Quad</Symm><NumberHorz>", "NumberHorz in their place"),
        ("<TopFace>", "<C0Face></C0Face><TopFace>", "EmissionAreas has TopFace"),
    ] {
        let wrong = text.replace(old, new);
        assert_ne!(wrong, text, "{old}");
        let error = checked(&wrong).unwrap_err();
        assert!(error.contains(words), "{new}: {error}");
    }
    // Without a date the file lacks that element alone, and says so.
    let file = written(&undated, LuminaireFormat::Tm33);
    assert!(file.remarks[0].contains("give the text ISSUEDATE"), "{:?}", file.remarks);
    let error = checked(&file.text).unwrap_err();
    assert!(error.contains("Header has 0 elements ReportDate"), "{error}");
    let number = "<ReportNumber></ReportNumber>";
    let with_date = format!("{number}<ReportDate>2024-11-25</ReportDate>");
    assert_eq!(checked(&file.text.replace(number, &with_date)), Ok(()));
}

#[test]
fn intensities_of_every_symmetry_come_back_at_seven_digits() {
    for (luminaire, planes) in all_symmetries().iter().zip([1, 9, 9, 9, 6]) {
        let text = tm33(luminaire);
        let document = Document::parse(&text).unwrap();
        let int_data: Vec<_> =
            document.descendants().filter(|node| node.has_tag_name("IntData")).collect();
        let own = &luminaire.intensities;
        let name = own.symmetry().name();
        let count = |of: &str| text_of(&document, "LuminousIntensity", of).unwrap();
        let angles = own.angles_deg().len();
        assert_eq!(
            [count("NumberHorz"), count("NumberVert"), count("NumberMeasured")],
            [planes, angles, planes * angles].map(|count| count.to_string()),
            "{name}"
        );
        assert_eq!(int_data.len(), planes * angles, "{name}");
        let mut directions = Vec::new();
        for node in &int_data {
            let [h, v] = ["h", "v"].map(|of| node.attribute(of).unwrap().parse::<f64>().unwrap());
            let value: f64 = node.text().unwrap().parse().unwrap();
            // By the formula behind the table, where it is linear between planes.
            let is_pole = v == 0.0 || v == 180.0;
            let plane = if is_pole { 0.0 } else { own.symmetry().folded(h % 360.0) };
            let given = 100.0 + plane + 0.3 * v;
            assert!((value / given - 1.0).abs() < 5e-7, "{name}, C {h}, γ {v}: {value} {given}");
            directions.push([h, v]);
        }
        // Plane by plane, each from the nadir up; the circle is closed.
        assert!(directions.is_sorted() && directions[0] == [0.0, 0.0], "{name}: {directions:?}");
        let last = if planes == 1 { 0.0 } else { 360.0 };
        assert_eq!(directions.last(), Some(&[last, 180.0]), "{name}");
        assert_eq!(count("AbsolutePhotometry"), "true");
        let flux: f64 =
            text_of(&document, "LuminousData", "LuminousFlux").unwrap().parse().unwrap();
        assert!((flux / own.flux() - 1.0).abs() < 5e-7, "{name}");
    }
}

#[test]
fn texts_are_escaped_and_none_is_lost() {
    let odd = "\"A\" & <B> 'C' Söhne ]]>";
    let texts = [
        ("MANUFAC", odd),
        ("LUMINAIRE", "Leuchte\n10°"),
        ("OTHER", odd),
        ("OTHER", "second"),
        ("MANUFAC", "also"),
        ("ISSUEDATE", "11/25/2024"),
        ("LAMP", "LED & driver"),
        ("SEARCH", ""),
    ];
    let texts = texts.map(|(word, text)| (word.to_owned(), text.to_owned())).to_vec();
    let text = tm33(&Luminaire { texts, ..all_symmetries()[0].clone() });
    assert!(text.contains("&quot;A&quot; &amp; &lt;B&gt; 'C' Söhne"), "{text}");
    let document = Document::parse(&text).unwrap();
    let header = |name: &str| text_of(&document, "Header", name);
    assert_eq!(header("Manufacturer").as_deref(), Some(odd));
    assert_eq!(header("Description").as_deref(), Some("Leuchte 10°"));
    assert_eq!(
        [header("Laboratory").as_deref(), header("ReportDate").as_deref()],
        [Some(""), None]
    );
    assert_eq!(text_of(&document, "Emitter", "Description").as_deref(), Some("LED & driver"));
    let comments: Vec<_> =
        document.descendants().filter(|node| node.has_tag_name("Comment")).collect();
    let comments: Vec<&str> = comments.iter().filter_map(Node::text).collect();
    let first = format!("OTHER: {odd}");
    assert_eq!(comments, [&first, "OTHER: second", "MANUFAC: also", "ISSUEDATE: 11/25/2024"]);
}

#[test]
fn lamps_openings_and_origins_are_stated() {
    let [rotational, quadrants, ..] = all_symmetries();
    let file = written(&quadrants, LuminaireFormat::Tm33);
    let document = Document::parse(&file.text).unwrap();
    let of = |parent: &str, name: &str| text_of(&document, parent, name).unwrap();
    assert_eq!([of("Emitter", "Quantity"), of("Emitter", "RatedLumens")], ["1", "6000"]);
    assert_eq!(of("Emitter", "InputWattage"), "25");
    assert_eq!([of("ColorTemperature", "FixedCCT"), of("CIE_CRI", "Ra")], ["3000", "82"]);
    assert!(file.remarks.iter().any(|remark| remark.contains("2 lamps as one emitter of 6000 lm")));
    // 600 mm along C0 and 50 mm along C90: the length lies along C90, and the face toward C0 has it.
    assert_eq!([of("Dimensions", "Length"), of("Dimensions", "Width")], ["0.05", "0.6"]);
    assert_eq!([of("C0Area", "Length"), of("C90Area", "Width")], ["0.05", "0.6"]);
    assert_eq!([of("C180Area", "Height"), of("BottomArea", "Width")], ["0.01", "0.6"]);
    assert!(text_of(&document, "Luminaire", "Shape").is_none());
    assert!(text_of(&document, "Emitter", "Simulation").is_none(), "not known");

    // A round lamp that shines down only, computed.
    let down = ies(LAMBERT).unwrap().luminaire;
    let opening = Opening { is_round: true, along_c0_mm: 80.0, along_c90_mm: 20.0, height_mm: 0.0 };
    let down = Luminaire { opening, generation: FileGeneration::Simulated, ..down };
    let file = written(&down, LuminaireFormat::Tm33);
    let document = Document::parse(&file.text).unwrap();
    let of = |parent: &str, name: &str| text_of(&document, parent, name);
    assert_eq!(of("BottomArea", "Length").as_deref(), Some("0.04"));
    assert_eq!(of("BottomArea", "Circular").as_deref(), Some("true"));
    assert_eq!(of("Luminaire", "Shape").as_deref(), Some("Align_Z"));
    assert_eq!([of("Emitter", "TopFace"), of("Emitter", "C0Face")], [None, None]);
    assert_eq!(of("DataGeneration", "Simulation").as_deref(), Some("true"));
    assert_eq!(of("Emitter", "RatedLumens"), None, "absolute photometry");
    assert!(file.remarks.iter().any(|remark| remark.contains("an ellipse")), "{:?}", file.remarks);

    let point = Luminaire { opening: Opening::default(), ..rotational };
    assert!(!tm33(&point).contains("EmissionAreas"));
    let generation = FileGeneration::of_number(1.011).unwrap();
    let text = tm33(&Luminaire { generation, ..point });
    let document = Document::parse(&text).unwrap();
    let answers = ["Simulation", "IntensityScaling", "AngleInterpolation"]
        .map(|name| text_of(&document, "DataGeneration", name).unwrap());
    assert_eq!(answers, ["false", "true", "true"]);
}

#[test]
fn such_files_are_not_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lamp.xml");
    std::fs::write(&path, tm33(&all_symmetries()[0])).unwrap();
    let error = read(&path).unwrap_err().to_string();
    assert!(error.contains("TM-33 files are only written"), "{error}");
    // Nor are they mistaken for scatter, whose files have the same ending.
    let error = crate::scatter::read(&path).unwrap_err().to_string();
    assert!(error.contains("line 2") && error.contains("TM-33"), "{error}");
}
