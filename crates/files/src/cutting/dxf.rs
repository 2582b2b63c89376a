//! DXF of release 12, the form that every machine reads: circles, closed polylines, and two layers.
//!
//! The reference is Autodesk's "DXF Reference" (group codes of CIRCLE, POLYLINE and VERTEX). The text has no date and no
//! random identifier, so the same drawing has the same bytes.

use crate::cutting::{CutDrawing, CutOutline, corners, length};
use std::fmt::Write;

/// The layer of the edge of the sheet.
const SHEET: &str = "SHEET";

/// A drawing as DXF.
pub fn dxf(drawing: &CutDrawing) -> String {
    let mut out = String::new();
    let layer = layer_name(&drawing.layer);
    let [width, height] = drawing.size.map(length);
    for (code, value) in [
        (0, "SECTION"),
        (2, "HEADER"),
        (9, "$ACADVER"),
        (1, "AC1009"),
        (9, "$INSUNITS"),
        (70, "4"),
        (9, "$EXTMIN"),
        (10, "0"),
        (20, "0"),
        (30, "0"),
        (9, "$EXTMAX"),
        (10, &width),
        (20, &height),
        (30, "0"),
        (0, "ENDSEC"),
        (0, "SECTION"),
        (2, "TABLES"),
        (0, "TABLE"),
        (2, "LAYER"),
        (70, "2"),
    ] {
        pair(&mut out, code, value);
    }
    for (name, colour) in [(SHEET, "8"), (&layer, "1")] {
        for (code, value) in [(0, "LAYER"), (2, name), (70, "0"), (62, colour), (6, "CONTINUOUS")] {
            pair(&mut out, code, value);
        }
    }
    for (code, value) in [(0, "ENDTAB"), (0, "ENDSEC"), (0, "SECTION"), (2, "ENTITIES")] {
        pair(&mut out, code, value);
    }
    let [width, height] = drawing.size;
    polyline(&mut out, SHEET, &corners([0.5 * width, 0.5 * height], drawing.size));
    for outline in &drawing.outlines {
        match outline {
            CutOutline::Circle { middle, diameter } => {
                pair(&mut out, 0, "CIRCLE");
                pair(&mut out, 8, &layer);
                point(&mut out, *middle);
                pair(&mut out, 40, &length(0.5 * diameter));
            }
            CutOutline::Rectangle { middle, size } => {
                polyline(&mut out, &layer, &corners(*middle, *size));
            }
        }
    }
    pair(&mut out, 0, "ENDSEC");
    pair(&mut out, 0, "EOF");
    out
}

/// A closed polyline.
fn polyline(out: &mut String, layer: &str, points: &[[f64; 2]]) {
    for (code, value) in [(0, "POLYLINE"), (8, layer), (66, "1"), (70, "1")] {
        pair(out, code, value);
    }
    for at in points {
        pair(out, 0, "VERTEX");
        pair(out, 8, layer);
        point(out, *at);
    }
    pair(out, 0, "SEQEND");
    pair(out, 8, layer);
}

fn point(out: &mut String, at: [f64; 2]) {
    pair(out, 10, &length(at[0]));
    pair(out, 20, &length(at[1]));
    pair(out, 30, "0");
}

fn pair(out: &mut String, code: u8, value: &str) {
    _ = write!(out, "{code}\n{value}\n");
}

/// Release 12 allows capitals, digits and `_` in names of layers, at most 31.
fn layer_name(name: &str) -> String {
    let mut made = String::new();
    for letter in name.chars() {
        if letter.is_ascii_alphanumeric() {
            made.push(letter.to_ascii_uppercase());
        } else if !made.is_empty() && !made.ends_with('_') {
            made.push('_');
        }
    }
    made.truncate(31);
    let made = made.trim_end_matches('_');
    // The edge of the sheet has a layer of its own.
    if made.is_empty() || made == SHEET { "CUT".to_owned() } else { made.to_owned() }
}
