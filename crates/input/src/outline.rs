//! The entries of a scene file in words: `cylinder, radius 1.5 mm, length 25.4 mm`.
//!
//! The words come from the keys, whose suffixes are units, so no list of all keys is needed.
//! Overrides and sensor files are in the tree already.

use crate::tree::Node;
use lumiduct_base::number::format_exact;
use serde_json::Value;

/// Suffixes of keys and their units, the longer ones first.
const UNITS: [(&str, &str); 14] = [
    ("_cd_m2", "cd/m²"),
    ("_per_mm", "/mm"),
    ("_mm2", "mm²"),
    ("_deg", "deg"),
    ("_mm", "mm"),
    ("_lm", "lm"),
    ("_lx", "lx"),
    ("_cd", "cd"),
    ("_mcd", "mcd"),
    ("_nm", "nm"),
    ("_k", "K"),
    ("_w", "W"),
    ("_h", "h"),
    ("_s", "s"),
];

/// Keys whose numbers are the sides of something.
const SIDES: [&str; 3] = ["size_mm", "cells", "pixels"];

/// Items of an array that are written one by one.
const ITEMS: usize = 8;

/// A scene file, section by section.
#[derive(Debug, Clone, Default)]
pub struct Outline {
    root: Value,
}

impl Outline {
    /// The outline of a whole scene file.
    pub fn of(root: &Node) -> Self {
        Self { root: root.to_json() }
    }

    /// The kind and size of an entry: its kind and its keys, except those in `without`. Empty where
    /// the file has no such entry.
    pub fn entry(&self, section: &str, name: &str, without: &[&str]) -> String {
        let fields = self.fields(section, name).into_iter();
        let shown = fields.filter(|(key, _)| !without.contains(key));
        shown.map(|(key, value)| words(key, value)).collect::<Vec<_>>().join(", ")
    }

    /// The value of a key of an entry, in words. Empty where the file has no such key.
    pub fn field(&self, section: &str, name: &str, key: &str) -> String {
        let mut fields = self.fields(section, name).into_iter();
        let found = fields.find(|(own, _)| *own == key).and_then(|(_, value)| value);
        found.map_or(String::new(), |value| value_words(key, value))
    }

    /// The keys of an entry. An entry that is a single table, as in `solids.NAME.KIND`, has its kind first, without a value.
    fn fields(&self, section: &str, name: &str) -> Vec<(&str, Option<&Value>)> {
        let entry = self.root.get(section).and_then(|entries| entries.get(name)?.as_object());
        let Some(entry) = entry else { return Vec::new() };
        let kind = entry.iter().next().filter(|_| entry.len() == 1);
        match kind.and_then(|(kind, inner)| Some((kind, inner.as_object()?))) {
            Some((kind, inner)) => {
                let keys = inner.iter().map(|(key, value)| (key.as_str(), Some(value)));
                std::iter::once((kind.as_str(), None)).chain(keys).collect()
            }
            None => entry.iter().map(|(key, value)| (key.as_str(), Some(value))).collect(),
        }
    }
}

/// The key of tables by wavelength.
const BY_WAVELENGTH: &str = "by_nm";

/// A key without its unit, in words, and the unit.
fn label(key: &str) -> (String, &'static str) {
    let ending = UNITS.iter().find(|(ending, _)| key.ends_with(ending) && key.len() > ending.len());
    let (ending, unit) = ending.copied().unwrap_or_default();
    (key[..key.len() - ending.len()].replace('_', " "), unit)
}

/// A key with its value.
fn words(key: &str, value: Option<&Value>) -> String {
    let (label, _) = label(key);
    let Some(value) = value else { return label };
    if let (BY_WAVELENGTH, Some(rows)) = (key, value.as_array()) {
        return format!("by wavelength in {} rows", rows.len());
    }
    match value {
        Value::Bool(true) => label,
        Value::Bool(false) => format!("no {label}"),
        // All as by default.
        Value::Object(fields) if fields.is_empty() => label,
        Value::Object(fields) if fields.len() > 1 => {
            format!("{label} ({})", value_words(key, value))
        }
        Value::Array(items) if items.iter().any(Value::is_object) => {
            format!("{label} ({})", value_words(key, value))
        }
        Value::Null | Value::Number(_) | Value::String(_) | Value::Array(_) | Value::Object(_) => {
            format!("{label} {}", value_words(key, value))
        }
    }
}

/// A value with the unit of its key.
fn value_words(key: &str, value: &Value) -> String {
    let (_, unit) = label(key);
    let with_unit = |text: String| format!("{text} {unit}").trim_end().to_owned();
    match value {
        Value::Null => "not told".to_owned(),
        Value::Bool(truth) => if *truth { "yes" } else { "no" }.to_owned(),
        Value::Number(number) => with_unit(number.as_f64().map_or(String::new(), format_exact)),
        Value::String(text) => text.clone(),
        Value::Array(items) if items.iter().all(|item| !item.is_object()) => list(key, items, unit),
        Value::Array(items) => {
            let shown = items.iter().take(ITEMS).map(|item| value_words(key, item));
            let mut text = shown.collect::<Vec<_>>().join("; ");
            if items.len() > ITEMS {
                text += &format!("; and {} more", items.len() - ITEMS);
            }
            text
        }
        Value::Object(fields) => {
            let told = fields.iter().map(|(key, value)| words(key, Some(value)));
            told.collect::<Vec<_>>().join(", ")
        }
    }
}

/// Numbers, texts or points with their unit.
fn list(key: &str, items: &[Value], unit: &str) -> String {
    if items.len() > ITEMS || items.iter().any(Value::is_array) {
        let unit = if unit.is_empty() { String::new() } else { format!(" in {unit}") };
        return format!("of {} values{unit}", items.len());
    }
    let shown: Vec<String> = items.iter().map(|item| value_words("", item)).collect();
    let text = if SIDES.contains(&key) {
        shown.join(" x ")
    } else if items.iter().all(Value::is_number) {
        format!("[{}]", shown.join(", "))
    } else {
        shown.join(", ")
    };
    format!("{text} {unit}").trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_become_words_with_units() {
        let outline = Outline {
            root: serde_json::json!({
                "solids": {"pipe": {"sweep": {
                    "profile": {"circle": {"radius_mm": 1.5}},
                    "path": [{"straight_mm": 10}, {"bend_deg": 90, "radius_mm": 8.25}],
                    "medium": "pmma",
                }}},
                "sources": {"led": {"rectangle": {
                    "width_mm": 0.3, "at": {"face": "pipe.entry", "gap_mm": 0.2}, "flux_lm": 3.0,
                }}},
                "finishes": {"chrome": {"specular": {"reflectance": 0.95}}},
                "sensors": {"exit": {"plane": {"cells": [24, 24]}, "on": "pipe.exit"}},
            }),
        };
        let pipe = "sweep, profile circle radius 1.5 mm, path (straight 10 mm; bend 90 deg, radius 8.25 mm)";
        assert_eq!(outline.entry("solids", "pipe", &["medium"]), pipe);
        assert_eq!(outline.field("solids", "pipe", "medium"), "pmma");
        assert_eq!(outline.field("sources", "led", "at"), "face pipe.entry, gap 0.2 mm");
        assert_eq!(outline.entry("sources", "led", &["at", "flux_lm"]), "rectangle, width 0.3 mm");
        assert_eq!(outline.entry("finishes", "chrome", &[]), "specular, reflectance 0.95");
        assert_eq!(outline.entry("sensors", "exit", &["on"]), "plane cells 24 x 24");
        assert_eq!(outline.entry("sensors", "far", &[]), "");
    }

    #[test]
    fn long_arrays_are_counted() {
        let many: Vec<f64> = (0..50).map(f64::from).collect();
        let steps: Vec<Value> = many.iter().map(|x| serde_json::json!({"bend_deg": x})).collect();
        assert_eq!(value_words("positions_mm", &many.into()), "of 50 values in mm");
        let table = serde_json::json!({"by_nm": [[400, 0.1], [700, 0.8]]});
        assert_eq!(words("reflectance", Some(&table)), "reflectance by wavelength in 2 rows");
        assert!(value_words("path", &steps.into()).ends_with("bend 7 deg; and 42 more"));
    }
}
