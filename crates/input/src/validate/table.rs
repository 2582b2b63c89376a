//! The keys of one table: known, missing, and the required number.

use serde_json::{Map, Value as Json};

use crate::schema::{self, RequiredSet};
use crate::tree::{Entry, Node, Value};
use crate::validate::{At, Completeness, Entries, Walk, unknown, wording};

impl Walk<'_> {
    pub(crate) fn table(&mut self, node: &Node, entries: &Entries, schema: &Json, at: &At<'_>) {
        let empty = Map::new();
        let properties = schema["properties"].as_object().unwrap_or(&empty);
        let any = schema.get("additionalProperties").filter(|any| **any != false);
        for (name, entry) in entries {
            let inner = At { outer: Some(properties), ..at.field(name, Some(entry)) };
            match properties.get(name).or(any) {
                Some(schema) => self.value(&entry.node, schema, &inner),
                None => self.unknown_key(
                    properties.keys().map(String::as_str).collect(),
                    at,
                    &inner,
                    name,
                ),
            }
        }
        if self.is_whole(entries) {
            self.missing_keys(node, entries, schema, at);
        }
        self.required_set(node, entries, schema, at);
    }

    /// Whether a table contains all its keys in the files.
    fn is_whole(&self, entries: &Entries) -> bool {
        let is_readable = |entry: &Entry| entry.node.value != Value::Unreadable;
        self.completeness == Completeness::Whole && entries.values().all(is_readable)
    }

    fn missing_keys(&mut self, node: &Node, entries: &Entries, schema: &Json, at: &At<'_>) {
        let required = schema["required"].as_array().into_iter().flatten().filter_map(Json::as_str);
        let known = known_keys(schema);
        for name in required.filter(|name| !entries.contains_key(*name)) {
            if unknown::is_misspelt(name, entries, known.iter().copied()) {
                continue;
            }
            let field = at.field(name, None);
            let wanted = schema::resolve(self.schema, &schema["properties"][name]);
            let expected = wording::expected(self.schema, wanted, field.unit);
            let origin = at.key.unwrap_or(&node.origin);
            self.problems
                .error(&field.to_key(), format!("missing, expected {expected}"))
                .at(origin);
        }
    }

    fn required_set(&mut self, node: &Node, entries: &Entries, schema: &Json, at: &At<'_>) {
        let Some(set) = schema::required_set(schema) else { return };
        let (keys, words, is_single) = match &set {
            RequiredSet::ExactlyOne(keys) => (keys, "exactly one", true),
            RequiredSet::AtLeastOne(keys) => (keys, "at least one", false),
        };
        let given: Vec<_> = keys.iter().filter_map(|key| entries.get_key_value(*key)).collect();
        let list = wording::list(keys.iter().copied());
        let known = known_keys(schema);
        let is_misspelt = |key: &&str| unknown::is_misspelt(key, entries, known.iter().copied());
        if given.is_empty() && self.is_whole(entries) && !keys.iter().any(is_misspelt) {
            let origin = at.key.unwrap_or(&node.origin);
            self.problems.error(&at.to_key(), format!("needs {words} of {list}")).at(origin);
        }
        if is_single && given.len() > 1 {
            let names = wording::list(given.iter().map(|(name, _)| name.as_str()));
            for (name, entry) in &given[1..] {
                let key = at.field(name, None).to_key();
                self.problems
                    .error(&key, format!("takes {words} of {list}, found {names}"))
                    .at(&entry.key);
            }
        }
    }
}

fn known_keys(schema: &Json) -> Vec<&str> {
    schema["properties"].as_object().into_iter().flatten().map(|(name, _)| name.as_str()).collect()
}
