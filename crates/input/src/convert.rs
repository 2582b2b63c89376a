//! From a validated tree to the spec types, entry by entry, so that a bad entry does not hide the others, and a bad
//! key does not hide the rest of its entry.

use indexmap::IndexMap;
use serde::de::DeserializeOwned;
use serde_json::Value as Json;

use crate::keys::{Key, KeySegment};
use crate::own_library::LIBRARY;
use crate::problems::Problems;
use crate::spec::optimise::OptimisationSpec;
use crate::spec::study::StudySpec;
use crate::spec::{AIR, FORMAT_VERSION, NORTH, SceneSpec, UP};
use crate::tree::{Node, Value};

/// The spec of a tree. A key with an error is left out, and with it an entry that is meaningless
/// without the key.
pub(crate) fn scene(root: &Node, problems: &mut Problems) -> SceneSpec {
    SceneSpec {
        lumiduct: FORMAT_VERSION,
        title: value(root, "title", problems).unwrap_or_default(),
        description: value(root, "description", problems),
        project: value(root, "project", problems),
        library: value(root, LIBRARY, problems),
        surroundings: value(root, "surroundings", problems).unwrap_or_else(|| AIR.into()),
        up: value(root, "up", problems).unwrap_or(UP),
        north: value(root, "north", problems).unwrap_or(NORTH),
        media: entries(root, "media", problems),
        finishes: entries(root, "finishes", problems),
        solids: entries(root, "solids", problems),
        sheets: entries(root, "sheets", problems),
        patterns: entries(root, "patterns", problems),
        reliefs: entries(root, "reliefs", problems),
        emissions: entries(root, "emissions", problems),
        sources: entries(root, "sources", problems),
        sensors: entries(root, "sensors", problems),
        run: value(root, "run", problems).unwrap_or_default(),
        // One bad check drops the others, too: their indices in the list would no longer match
        // their keys.
        check: value(root, "check", problems).unwrap_or_default(),
    }
}

/// The study of a tree; `None` if that fails, which has then been noted.
pub(crate) fn study(root: &Node, problems: &mut Problems) -> Option<StudySpec> {
    one(root, &Key::root(), problems)
}

/// The optimisation of a tree; `None` if that fails, which has then been noted.
pub(crate) fn optimisation(root: &Node, problems: &mut Problems) -> Option<OptimisationSpec> {
    one(root, &Key::root(), problems)
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
    if has_unreadable(node) {
        return None;
    }
    let mut json = node.to_json();
    let mut is_whole = true;
    for wrong in problems.error_keys().filter(|wrong| wrong.is_within(key)) {
        is_whole = false;
        drop_key(&mut json, &wrong.segments()[key.segments().len()..]);
    }
    match serde_json::from_value(json) {
        Ok(spec) => Some(spec),
        Err(reason) => {
            if is_whole {
                problems.error(key, reason.to_string()).at(&node.origin);
            }
            None
        }
    }
}

/// Removes a key from a table. An item of an array stays, as its removal would renumber those after
/// it.
fn drop_key(json: &mut Json, path: &[KeySegment]) {
    let Some((last, around)) = path.split_last() else {
        *json = Json::Null;
        return;
    };
    let table = around.iter().try_fold(json, |json, segment| match segment {
        KeySegment::Field(name) => json.get_mut(name),
        KeySegment::Index(index) => json.get_mut(index),
    });
    if let (Some(Json::Object(entries)), KeySegment::Field(name)) = (table, last) {
        entries.shift_remove(name);
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
