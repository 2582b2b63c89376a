//! The schema of ATLA S001, version 1.0, of the parts that are written.

use crate::luminaire::date::iso_date;
use roxmltree::{Document, Node};

/// What an element contains.
enum SchemaContent {
    /// These elements in this order, each with how often it may occur.
    Elements(&'static [(&'static str, SchemaOccurs)]),
    Text,
    Decimal,
    Int,
    Boolean,
    Date,
    OneOf(&'static [&'static str]),
}

#[derive(Clone, Copy)]
enum SchemaOccurs {
    Once,
    AtMostOnce,
    AnyNumber,
    AtLeastOnce,
}

use SchemaContent::{Boolean, Date, Decimal, Elements, Int, OneOf, Text};
use SchemaOccurs::{AnyNumber, AtLeastOnce, AtMostOnce, Once};

/// The content of an element of a name.
fn content(name: &str) -> Option<SchemaContent> {
    const LENGTH_AND_WIDTH: &[(&str, SchemaOccurs)] = &[
        ("Length", Once),
        ("Width", Once),
        ("LengthOffset", Once),
        ("WidthOffset", Once),
        ("Circular", AtMostOnce),
    ];
    const LENGTH_AND_HEIGHT: &[(&str, SchemaOccurs)] = &[
        ("Length", Once),
        ("Height", Once),
        ("LengthOffset", Once),
        ("HeightOffset", Once),
        ("Circular", AtMostOnce),
    ];
    const WIDTH_AND_HEIGHT: &[(&str, SchemaOccurs)] = &[
        ("Width", Once),
        ("Height", Once),
        ("WidthOffset", Once),
        ("HeightOffset", Once),
        ("Circular", AtMostOnce),
    ];
    Some(match name {
        "IESTM33" => Elements(&[
            ("Version", Once),
            ("Header", Once),
            ("Luminaire", Once),
            ("Equipment", Once),
            ("Emitter", AtLeastOnce),
            ("CustomData", AnyNumber),
        ]),
        "Version" => OneOf(&["1.0"]),
        "Header" => Elements(&[
            ("Manufacturer", AtMostOnce),
            ("CatalogNumber", AtMostOnce),
            ("GTIN", AtMostOnce),
            ("Description", Once),
            ("Laboratory", Once),
            ("ReportNumber", Once),
            ("ReportDate", Once),
            ("DocumentCreator", AtMostOnce),
            ("DocumentCreationDate", AtMostOnce),
            ("UniqueIdentifier", AtMostOnce),
            ("Comment", AnyNumber),
            ("Reference", AnyNumber),
            ("MoreInfoURI", AtMostOnce),
        ]),
        "Luminaire" => {
            Elements(&[("Dimensions", Once), ("Shape", AtMostOnce), ("NumEmitter", Once)])
        }
        "Dimensions" => Elements(&[("Length", Once), ("Width", Once), ("Height", Once)]),
        "Shape" => OneOf(&["Align_X", "Align_Y", "Align_Z"]),
        "Equipment" => Elements(&[
            ("Gonioradiometer", AtMostOnce),
            ("IntegratingSphere", AtMostOnce),
            ("Spectroradiometer", AtMostOnce),
        ]),
        "Gonioradiometer" => Elements(&[("Type", Once), ("MeasurementEquipment", AtMostOnce)]),
        "Type" => OneOf(&["CIE_A", "CIE_B", "CIE_C", "IES_A", "IES_B", "IES_C", "CUSTOM"]),
        "Emitter" => Elements(&[
            ("Quantity", Once),
            ("Description", Once),
            ("CatalogNumber", AtMostOnce),
            ("RatedLumens", AtMostOnce),
            ("InputWattage", Once),
            ("PowerFactor", AtMostOnce),
            ("BallastFactor", AtMostOnce),
            ("TiltAngles", AtMostOnce),
            ("ColorTemperature", AtMostOnce),
            ("ColorRendering", AtMostOnce),
            ("Duv", AtMostOnce),
            ("SPRatio", AtMostOnce),
            ("DataGeneration", AtMostOnce),
            ("LuminousData", AtMostOnce),
            ("RadiantData", AtMostOnce),
            ("PhotonData", AtMostOnce),
            ("SpectralData", AtMostOnce),
            ("EmissionAreas", AtMostOnce),
            ("EmitterCenter", AtMostOnce),
            ("Regulatory", AtMostOnce),
        ]),
        "ColorTemperature" => {
            Elements(&[("FixedCCT", AtMostOnce), ("MinCCT", AtMostOnce), ("MaxCCT", AtMostOnce)])
        }
        "ColorRendering" => Elements(&[("CIE_CRI", AtMostOnce), ("IES_TM30", AtMostOnce)]),
        "CIE_CRI" => Elements(&[("Ra", Once), ("R9", AtMostOnce)]),
        "DataGeneration" => Elements(&[
            ("Simulation", AtMostOnce),
            ("Laboratory", AtMostOnce),
            ("IntensityScaling", AtMostOnce),
            ("AngleInterpolation", AtMostOnce),
        ]),
        "LuminousData" => Elements(&[
            ("LuminousIntensity", Once),
            ("LuminousFlux", AtMostOnce),
            ("MeasuredCCT", AtMostOnce),
        ]),
        "LuminousIntensity" => Elements(&[
            ("AbsolutePhotometry", Once),
            ("NumberMeasured", Once),
            ("NumberHorz", Once),
            ("NumberVert", Once),
            ("IntData", AtLeastOnce),
        ]),
        "EmissionAreas" => Elements(&[
            ("TopFace", AtMostOnce),
            ("BottomFace", AtMostOnce),
            ("C0Face", AtMostOnce),
            ("C90Face", AtMostOnce),
            ("C180Face", AtMostOnce),
            ("C270Face", AtMostOnce),
        ]),
        "TopFace" => Elements(&[("NumberTop", Once), ("TopArea", AtLeastOnce)]),
        "BottomFace" => Elements(&[("NumberBottom", Once), ("BottomArea", AtLeastOnce)]),
        "C0Face" => Elements(&[("NumberC0", Once), ("C0Area", AtLeastOnce)]),
        "C90Face" => Elements(&[("NumberC90", Once), ("C90Area", AtLeastOnce)]),
        "C180Face" => Elements(&[("NumberC180", Once), ("C180Area", AtLeastOnce)]),
        "C270Face" => Elements(&[("NumberC270", Once), ("C270Area", AtLeastOnce)]),
        "TopArea" | "BottomArea" => Elements(LENGTH_AND_WIDTH),
        "C0Area" | "C180Area" => Elements(LENGTH_AND_HEIGHT),
        "C90Area" | "C270Area" => Elements(WIDTH_AND_HEIGHT),
        "Manufacturer" | "CatalogNumber" | "Description" | "Laboratory" | "ReportNumber"
        | "Comment" => Text,
        "ReportDate" => Date,
        "Quantity" | "FixedCCT" | "Ra" | "NumEmitter" | "NumberMeasured" | "NumberHorz"
        | "NumberVert" | "NumberTop" | "NumberBottom" | "NumberC0" | "NumberC90" | "NumberC180"
        | "NumberC270" => Int,
        "AbsolutePhotometry" | "Circular" | "Simulation" | "IntensityScaling"
        | "AngleInterpolation" => Boolean,
        "Length" | "Width" | "Height" | "LengthOffset" | "WidthOffset" | "HeightOffset"
        | "RatedLumens" | "InputWattage" | "LuminousFlux" | "IntData" => Decimal,
        _ => return None,
    })
}

fn elements<'a>(node: Node<'a, 'a>) -> Vec<Node<'a, 'a>> {
    node.children().filter(Node::is_element).collect()
}

/// A number without an exponent (XML Schema, part 2, 3.2.3).
fn is_decimal(text: &str) -> bool {
    let digits = text.strip_prefix('-').unwrap_or(text);
    digits.split('.').count() <= 2
        && digits.bytes().any(|byte| byte.is_ascii_digit())
        && digits.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.')
}

/// Compares an element and all within it with the schema.
fn violation(node: Node<'_, '_>) -> Result<(), String> {
    let name = node.tag_name().name();
    let own = content(name).ok_or_else(|| format!("{name} is unknown"))?;
    let text = node.text().unwrap_or_default();
    let expect = |fits: bool| if fits { Ok(()) } else { Err(format!("{name} contains `{text}`")) };
    let attributes: Vec<&str> = node.attributes().map(|attribute| attribute.name()).collect();
    if attributes != if name == "IntData" { vec!["h", "v"] } else { vec![] } {
        return Err(format!("{name} has the attributes {attributes:?}"));
    }
    if !node.attributes().all(|attribute| is_decimal(attribute.value())) {
        return Err(format!("{name} has angles that are no numbers"));
    }
    let Elements(expected) = own else {
        expect(elements(node).is_empty())?;
        return expect(match own {
            Text | Elements(_) => true,
            Decimal => is_decimal(text),
            Int => text.parse::<i32>().is_ok(),
            Boolean => ["true", "false"].contains(&text),
            Date => text.len() == 10 && iso_date(text).as_deref() == Some(text),
            OneOf(words) => words.contains(&text),
        });
    };
    expect(text.trim().is_empty())?;
    let children = elements(node);
    let mut rest = &children[..];
    for (child, occurs) in expected {
        let count = rest.iter().take_while(|own| own.has_tag_name(*child)).count();
        let fits = match occurs {
            Once => count == 1,
            AtMostOnce => count <= 1,
            AnyNumber => true,
            AtLeastOnce => count >= 1,
        };
        if !fits {
            return Err(format!("{name} has {count} elements {child} in their place"));
        }
        rest = &rest[count..];
    }
    if let Some(other) = rest.first() {
        return Err(format!("{name} has {} where the schema has none", other.tag_name().name()));
    }
    children.into_iter().try_for_each(violation)
}

/// Compares a file with the schema.
pub(crate) fn checked(text: &str) -> Result<(), String> {
    let document = Document::parse(text).map_err(|error| error.to_string())?;
    violation(document.root_element())
}
