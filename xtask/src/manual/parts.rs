//! What the manual needs to know of a schema: alternatives, keys that kinds share, headings and anchors.

use serde_json::{Map, Value as Json};

use crate::manual::FAMILIES;
use lumiduct_input::schema;
use lumiduct_input::validate::wording;

/// Alternatives of a choice, as in the schema.
pub(super) fn options(definition: &Json) -> Vec<&Json> {
    ["oneOf", "anyOf"]
        .iter()
        .find_map(|word| definition[word].as_array())
        .into_iter()
        .flatten()
        .collect()
}

/// The kind of an alternative, and what it takes.
pub(super) fn kind_of(option: &Json) -> Option<(&str, &Json)> {
    let (kind, value) = option["properties"].as_object()?.iter().next()?;
    Some((kind, value))
}

/// Keys that kinds share unchanged.
pub(super) struct Shared<'a> {
    pub(super) names: Vec<&'a str>,
    /// The table of a kind that has them.
    pub(super) table: &'a Json,
    /// Kinds that have none of them.
    pub(super) apart: Vec<&'a str>,
}

/// Keys that all kinds share unchanged, except kinds that have nothing in common with the first.
pub(super) fn shared_keys<'a>(root: &'a Json, options: &[&'a Json]) -> Option<Shared<'a>> {
    let tables = options.iter().map(|option| {
        let (kind, value) = kind_of(option)?;
        let table = schema::resolve(root, value);
        Some((kind, table["properties"].as_object()?, table))
    });
    let tables: Option<Vec<_>> = tables.collect();
    let tables = tables?;
    let (_, first, table) = *tables.first()?;
    let is_apart =
        |keys: &Map<String, Json>| !first.iter().any(|(name, value)| keys.get(name) == Some(value));
    let (apart, alike): (Vec<_>, Vec<_>) = tables.iter().partition(|(_, keys, _)| is_apart(keys));
    let is_shared = |(name, value): &(&String, &Json)| {
        let is_needed = |table: &Json| {
            table["required"].as_array().is_some_and(|all| all.iter().any(|own| own == *name))
        };
        alike.iter().all(|(_, keys, other)| {
            keys.get(*name) == Some(*value) && is_needed(other) == is_needed(table)
        })
    };
    let names: Vec<_> = first.iter().filter(is_shared).map(|(name, _)| name.as_str()).collect();
    let apart: Vec<_> = apart.iter().map(|(kind, ..)| *kind).collect();
    (alike.len() > 1 && !names.is_empty()).then_some(Shared { names, table, apart })
}

pub(super) fn description(schema: &Json) -> &str {
    schema["description"].as_str().unwrap_or_default()
}

/// A default without a redundant ".0".
pub(super) fn default_of(default: &Json) -> String {
    match default {
        Json::Number(_) => wording::short(default),
        Json::Array(items) => {
            format!("[{}]", items.iter().map(default_of).collect::<Vec<_>>().join(", "))
        }
        Json::Null | Json::Bool(_) | Json::String(_) | Json::Object(_) => default.to_string(),
    }
}

pub(super) fn range_of(schema: &Json) -> String {
    if schema["minimum"] == i32::MIN {
        return String::new();
    }
    let words = wording::range(schema).or_else(|| wording::range(&schema["items"]));
    words.unwrap_or_default()
}

/// The heading of a definition: `SpacePlacement` is "Space placement".
pub(super) fn title(name: &str) -> String {
    if let Some((_, title)) = FAMILIES.iter().find(|(family, _)| *family == name) {
        return (*title).to_owned();
    }
    let mut words = String::new();
    for (i, c) in name.char_indices() {
        if i > 0 && c.is_uppercase() {
            words.push(' ');
            words.extend(c.to_lowercase());
        } else {
            words.push(c);
        }
    }
    words
}

/// The anchor that a heading gets.
pub(super) fn anchor(heading: &str) -> String {
    let kept = heading.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.collect::<String>().to_lowercase().replace(' ', "-")
}
