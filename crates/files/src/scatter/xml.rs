//! XML of Radiance genBSDF and LBNL WINDOW.
//!
//! Front is the side that WINDOW calls front, the outside of a glazing; Radiance calls it the back. Incident directions are given toward
//! the origin of the light, and the azimuths of both systems are such that light that goes straight on, or is mirrored, stays in the
//! patch of the same number. The layout is that of the readers of Radiance (`bsdf_m.c`, `bsdf_t.c`; Lawrence Berkeley National Laboratory).

use crate::scatter::basis::{basis, line_of, text};
use crate::scatter::data::{BsdfMatrix, ScatterFile};
use crate::scatter::error::{Violation, value};
use crate::scatter::tree::tensor_tree;
use crate::scatter::xml_shape;
use lumiduct_base::math::{DirectionPatches, PatchPairs};
use roxmltree::{Document, Error as XmlError, Node, ParsingOptions};

/// How a file lays its values out.
#[derive(Clone, Copy, PartialEq)]
enum IncidentData {
    /// A column for each incident patch.
    Columns,
    /// A row for each incident patch.
    Rows,
    /// A tree over this number of dimensions.
    Tree(usize),
}

pub(super) fn read(text: &str) -> Result<ScatterFile, Violation> {
    xml_shape::check(text)?;
    // Without DTDs no entity can grow.
    let options = ParsingOptions { allow_dtd: false, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|error| match error {
        XmlError::UnclosedRootNode => {
            let problem = "it ends within an element; the file may be cut short";
            Violation::new(text.lines().count().max(1), problem)
        }
        error => Violation::new(error.pos().row as usize, error.to_string()),
    })?;
    let element = |name: &str| document.descendants().find(|node| node.has_tag_name(name));
    let definition = element("DataDefinition").ok_or_else(|| {
        let root = document.root_element();
        // The other XML of lighting, of any edition.
        if root.tag_name().name().starts_with("IESTM33") {
            let problem = "it is a luminaire in TM-33, not a BSDF; TM-33 files are only written";
            return Violation::new(line_of(root), problem);
        }
        Violation::new(1, "it has no element `DataDefinition`: it is not a file of a BSDF")
    })?;
    let layout = layout(definition)?;
    let bases: Vec<_> =
        definition.children().filter(|child| child.has_tag_name("AngleBasis")).collect();
    let mut file = ScatterFile::default();
    let mut left_out = Vec::new();
    for data in document.descendants().filter(|node| node.has_tag_name("WavelengthData")) {
        let wavelength = self::text(data, "Wavelength").unwrap_or("Visible").trim();
        if !wavelength.eq_ignore_ascii_case("Visible") {
            left_out.push(wavelength.to_owned());
            continue;
        }
        for block in data.children().filter(|child| child.has_tag_name("WavelengthDataBlock")) {
            add_block(&mut file, block, layout, &bases)?;
        }
    }
    let sides = [&file.front, &file.back];
    if sides.iter().all(|side| side.reflection.is_none() && side.transmission.is_none()) {
        return Err(Violation::new(line_of(definition), "it has no data for visible light"));
    }
    left_out.sort();
    left_out.dedup();
    if !left_out.is_empty() {
        let remark = format!("only its visible data are used, not {}", left_out.join(", "));
        file.remarks.push(remark);
    }
    let mut remarks: Vec<String> = Vec::new();
    for remark in file.remarks {
        if !remarks.contains(&remark) {
            remarks.push(remark);
        }
    }
    Ok(ScatterFile { remarks, ..file })
}

fn layout(definition: Node<'_, '_>) -> Result<IncidentData, Violation> {
    let word = text(definition, "IncidentDataStructure").unwrap_or_default().trim();
    match word {
        "Columns" => Ok(IncidentData::Columns),
        "Rows" => Ok(IncidentData::Rows),
        "TensorTree3" => Ok(IncidentData::Tree(3)),
        "TensorTree4" => Ok(IncidentData::Tree(4)),
        _ => Err(Violation::new(
            line_of(definition),
            format!(
                "IncidentDataStructure is `{word}`, expected Columns, Rows, TensorTree3 or TensorTree4"
            ),
        )),
    }
}

fn add_block(
    file: &mut ScatterFile,
    block: Node<'_, '_>,
    layout: IncidentData,
    bases: &[Node<'_, '_>],
) -> Result<(), Violation> {
    let line = line_of(block);
    let direction = text(block, "WavelengthDataDirection").unwrap_or_default().trim();
    let place = match direction.to_ascii_lowercase().as_str() {
        "transmission front" | "transmission" => &mut file.front.transmission,
        "transmission back" => &mut file.back.transmission,
        "reflection front" => &mut file.front.reflection,
        "reflection back" => &mut file.back.reflection,
        _ => {
            let problem = format!(
                "WavelengthDataDirection is `{direction}`, expected Transmission or Reflection with Front or Back"
            );
            return Err(Violation::new(line, problem));
        }
    };
    if place.is_some() {
        return Err(Violation::new(line, format!("there are two visible blocks of `{direction}`")));
    }
    file.remarks.extend(data_type_remark(block, direction)?);
    let data = block.children().find(|child| child.has_tag_name("ScatteringData"));
    let data = data.ok_or_else(|| Violation::new(line, "it has no element `ScatteringData`"))?;
    let words = &text_with_lines(data);
    let first_line = data
        .first_child()
        .map_or(line, |child| child.document().text_pos_at(child.range().start).row as usize);
    let matrix = match layout {
        IncidentData::Tree(dimensions) => {
            let name = text(block, "AngleBasis").unwrap_or_default().trim();
            if name != "LBNL/Shirley-Chiu" {
                let problem =
                    format!("the angle basis of a tree is `{name}`, not LBNL/Shirley-Chiu");
                return Err(Violation::new(line, problem));
            }
            tensor_tree(words, first_line, dimensions, &mut file.remarks)?
        }
        IncidentData::Columns | IncidentData::Rows => {
            let pairs = pairs(block, bases, line)?;
            let values = matrix_values(words, first_line, &pairs, layout)?;
            let before = words.len() - words.trim_start().len();
            let line = first_line + words[..before].matches('\n').count();
            BsdfMatrix { pairs, values, line }
        }
    };
    *place = Some(matrix);
    Ok(())
}

/// Refuses values that are no BTDF of transmission and no BRDF of reflection. Programs of Radiance call both BTDF, which is remarked.
fn data_type_remark(block: Node<'_, '_>, direction: &str) -> Result<Option<String>, Violation> {
    let Some(node) = block.children().find(|child| child.has_tag_name("ScatteringDataType")) else {
        return Ok(None);
    };
    let word = node.text().unwrap_or_default().trim();
    let refuse = |problem: String| Err(Violation::new(line_of(node), problem));
    let is_transmission = direction.to_ascii_lowercase().starts_with("transmission");
    match (word.to_ascii_uppercase().as_str(), is_transmission) {
        ("BTDF", true) | ("BRDF", false) | ("BSDF", _) => Ok(None),
        ("BTDF", false) => Ok(Some(
            "ScatteringDataType of reflection is BTDF; its values are used as those of a BRDF"
                .to_owned(),
        )),
        ("BRDF", true) => refuse(format!(
            "ScatteringDataType is `{word}`, a reflection, but WavelengthDataDirection is `{direction}`; correct one of them"
        )),
        _ => {
            refuse(format!("ScatteringDataType is `{word}`, expected BTDF or BRDF: values in 1/sr"))
        }
    }
}

/// The text of an element without its comments, but with their ends of lines.
fn text_with_lines(node: Node<'_, '_>) -> String {
    let mut all = String::new();
    for child in node.children() {
        match child.text() {
            Some(text) if child.is_text() => all.push_str(text),
            other => all.extend(other.unwrap_or_default().chars().filter(|letter| *letter == '\n')),
        }
    }
    all
}

/// The patches of a matrix: its columns are incident directions.
fn pairs(
    block: Node<'_, '_>,
    bases: &[Node<'_, '_>],
    line: usize,
) -> Result<PatchPairs, Violation> {
    let of = |element: &str| {
        let name = text(block, element).unwrap_or_default().trim();
        basis(name, bases, line).map(DirectionPatches::Rings)
    };
    Ok(PatchPairs::Fixed { incident: of("ColumnAngleBasis")?, leaving: of("RowAngleBasis")? })
}

/// Values by incident patch, separated by commas or blanks.
fn matrix_values(
    text: &str,
    first_line: usize,
    pairs: &PatchPairs,
    layout: IncidentData,
) -> Result<Vec<f64>, Violation> {
    let [incident, leaving] = pairs.counts();
    let wanted = incident * leaving;
    // A value takes two letters at least.
    let mut values = vec![0.0; if wanted <= text.len() { wanted } else { 0 }];
    let mut found = 0;
    for (index, line) in text.split('\n').enumerate() {
        let number = first_line + index;
        let words = line.split(|letter: char| letter == ',' || letter.is_whitespace());
        for word in words.filter(|word| !word.is_empty()) {
            let value = value(word, number)?;
            if found < values.len() {
                let place = match layout {
                    IncidentData::Rows => found,
                    IncidentData::Columns | IncidentData::Tree(_) => {
                        found % incident * leaving + found / incident
                    }
                };
                values[place] = value;
            }
            found += 1;
        }
    }
    if found != wanted {
        return Err(Violation::new(
            first_line,
            format!(
                "there are {found} values, but {incident} incident and {leaving} leaving directions need {wanted}"
            ),
        ));
    }
    Ok(values)
}
