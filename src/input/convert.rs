//! From a validated tree to the spec types, entry by entry, so that a bad entry does not hide the others.

use indexmap::IndexMap;
use serde::de::DeserializeOwned;

use crate::input::keys::Key;
use crate::input::problems::Problems;
use crate::input::spec::{AIR, FORMAT_VERSION, SceneSpec};
use crate::input::tree::{Node, Value};

/// The spec that a tree says. What has an error is left out, or has its default.
pub fn scene(root: &Node, problems: &mut Problems) -> SceneSpec {
    SceneSpec {
        lumiduct: FORMAT_VERSION,
        title: value(root, "title", problems).unwrap_or_default(),
        description: value(root, "description", problems),
        surroundings: value(root, "surroundings", problems).unwrap_or_else(|| AIR.into()),
        media: entries(root, "media", problems),
        finishes: entries(root, "finishes", problems),
        solids: entries(root, "solids", problems),
        sheets: entries(root, "sheets", problems),
        sources: entries(root, "sources", problems),
        sensors: entries(root, "sensors", problems),
        run: value(root, "run", problems).unwrap_or_default(),
        // One bad check takes the others with it: their places in the list would no longer fit their keys.
        check: value(root, "check", problems).unwrap_or_default(),
    }
}

fn value<T: DeserializeOwned>(root: &Node, name: &str, problems: &mut Problems) -> Option<T> {
    one(root.get(name)?, &Key::of(&[name]), problems)
}

fn entries<T: DeserializeOwned>(
    root: &Node,
    family: &str,
    problems: &mut Problems,
) -> IndexMap<String, T> {
    let table = root.get(family).and_then(Node::table);
    let key = Key::of(&[family]);
    let named = table.into_iter().flatten();
    named
        .filter_map(|(name, entry)| {
            Some((name.clone(), one(&entry.node, &key.field(name), problems)?))
        })
        .collect()
}

fn one<T: DeserializeOwned>(node: &Node, key: &Key, problems: &mut Problems) -> Option<T> {
    if problems.has_error_within(key) || has_unreadable(node) {
        return None;
    }
    match serde_json::from_value(node.to_json()) {
        Ok(spec) => Some(spec),
        Err(reason) => {
            problems.error(key, reason.to_string()).at(&node.origin);
            None
        }
    }
}

fn has_unreadable(node: &Node) -> bool {
    match &node.value {
        Value::Table(entries) => entries.values().any(|entry| has_unreadable(&entry.node)),
        Value::Array(items) => items.iter().any(has_unreadable),
        Value::Unreadable => true,
        Value::String(_)
        | Value::Integer(_)
        | Value::Float(_)
        | Value::Boolean(_)
        | Value::Datetime => false,
    }
}
