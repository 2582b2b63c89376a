//! Validates a tree against the JSON Schema: every problem, each at its place.
//!
//! Knows the keywords of JSON Schema that the spec types produce, but not the meaning of keys.
//! Rules that the schema cannot state are in `input::lower`.

use serde_json::{Map, Value as Json};

use crate::keys::{Key, KeySegment};
use crate::problems::{Problem, Problems};
use crate::schema;
use crate::texts::{Origin, Texts};
use crate::tree::{Entry, Node, Value};

mod choice;
mod table;
mod unknown;
pub mod wording;

type Entries = indexmap::IndexMap<String, Entry>;

/// Whether a tree contains everything in its files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Completeness {
    /// It does: an absent key is missing.
    Whole,
    /// A syntax error may have hidden some keys.
    Broken,
}

/// Notes every difference of a tree from a schema.
pub(crate) fn validate(
    root: &Node,
    schema: &Json,
    sources: &Texts,
    completeness: Completeness,
    problems: &mut Problems,
) {
    let mut walk = Walk { schema, sources, completeness, problems };
    walk.value(root, schema, &At::ROOT);
}

/// The context of the walk through a tree.
struct Walk<'a> {
    /// The whole schema, for its definitions.
    schema: &'a Json,
    sources: &'a Texts,
    completeness: Completeness,
    problems: &'a mut Problems,
}

/// Where in the tree the walk is, as a list from the inside out.
#[derive(Clone, Copy)]
struct At<'a> {
    around: Option<(&'a At<'a>, Step<'a>)>,
    /// The place of the key, if there is one.
    key: Option<&'a Origin>,
    /// Unit of the numbers in it, from its key or that of an array around it.
    unit: Option<&'static str>,
    /// Keys of the table around it, for keys placed one level too deep.
    outer: Option<&'a Map<String, Json>>,
    /// The forms that the table may have, for keys that belong to another one.
    forms: &'a [&'a Json],
}

#[derive(Clone, Copy)]
enum Step<'a> {
    Field(&'a str),
    Index(usize),
}

impl<'a> At<'a> {
    const ROOT: Self = Self { around: None, key: None, unit: None, outer: None, forms: &[] };

    fn field(&'a self, name: &'a str, entry: Option<&'a Entry>) -> Self {
        let key = entry.map(|entry| &entry.key);
        Self {
            around: Some((self, Step::Field(name))),
            key,
            unit: schema::unit(name),
            outer: None,
            forms: &[],
        }
    }

    fn index(&'a self, index: usize) -> Self {
        Self {
            around: Some((self, Step::Index(index))),
            key: None,
            unit: self.unit,
            outer: None,
            forms: &[],
        }
    }

    fn to_key(self) -> Key {
        match self.around {
            None => Key::root(),
            Some((around, Step::Field(name))) => {
                around.to_key().step(KeySegment::Field(name.into()))
            }
            Some((around, Step::Index(index))) => around.to_key().step(KeySegment::Index(index)),
        }
    }
}

impl Walk<'_> {
    fn value(&mut self, node: &Node, schema: &Json, at: &At<'_>) {
        if node.value == Value::Unreadable {
            return;
        }
        let schema = schema::resolve(self.schema, schema);
        if schema::takes_anything(schema) {
            return;
        }
        let choices = schema::choices(self.schema, schema);
        if !choices.is_empty() {
            return self.choice(node, schema, &choices, at);
        }
        match (schema["type"].as_str(), &node.value) {
            (Some("object"), Value::Table(entries)) => self.table(node, entries, schema, at),
            (Some("array"), Value::Array(items)) => self.array(node, items, schema, at),
            (Some("number"), Value::Float(number)) => self.number(node, *number, schema, at),
            (Some("number" | "integer"), Value::Integer(number)) => {
                self.integer(node, *number, schema, at);
            }
            (Some("string"), Value::String(_)) | (Some("boolean"), Value::Boolean(_)) => {}
            _ => self.wrong_type(node, schema, at),
        }
    }

    fn error(&mut self, node: &Node, at: &At<'_>, message: String) -> &mut Problem {
        self.problems.error(&at.to_key(), message).at(&node.origin)
    }

    fn wrong_type(&mut self, node: &Node, schema: &Json, at: &At<'_>) {
        let expected = wording::expected(self.schema, schema, at.unit);
        let found = wording::found(node, self.sources);
        let hint = self.type_hint(node, schema, at);
        let problem = self.error(node, at, format!("expected {expected}, found {found}"));
        if let Some(hint) = hint {
            problem.hint(hint);
        }
    }

    fn type_hint(&self, node: &Node, schema: &Json, at: &At<'_>) -> Option<String> {
        match (schema["type"].as_str(), &node.value) {
            // Larger whole numbers are not exact as f64.
            (Some("integer"), Value::Float(number))
                if number.fract() == 0.0 && number.abs() < 9e15 =>
            {
                Some(format!("write {number:.0}"))
            }
            (Some("array"), Value::Table(_)) => Some(format!("write [[{}]]", at.to_key())),
            (Some("number" | "integer"), Value::String(text))
                if text.trim().parse::<f64>().is_ok() =>
            {
                Some("write it without quotes".into())
            }
            (Some("number"), Value::String(text))
                if text.trim().replacen(',', ".", 1).parse::<f64>().is_ok() =>
            {
                Some(format!(
                    "write the decimals behind a point: {}",
                    text.trim().replacen(',', ".", 1)
                ))
            }
            _ => None,
        }
    }

    fn integer(&mut self, node: &Node, number: i64, schema: &Json, at: &At<'_>) {
        if let Some(only) = schema["const"].as_i64() {
            if number != only {
                self.error(node, at, format!("expected {only}, found {number}"));
            }
            return;
        }
        self.range(node, number as f64, schema, at);
    }

    fn number(&mut self, node: &Node, number: f64, schema: &Json, at: &At<'_>) {
        if number.is_finite() {
            return self.range(node, number, schema, at);
        }
        let text = self.sources.excerpt(&node.origin);
        self.error(node, at, format!("{text} is not a finite number"));
    }

    fn range(&mut self, node: &Node, number: f64, schema: &Json, at: &At<'_>) {
        let limit = |word: &str| schema[word].as_f64();
        let is_inside = limit("minimum").is_none_or(|min| number >= min)
            && limit("maximum").is_none_or(|max| number <= max)
            && limit("exclusiveMinimum").is_none_or(|min| number > min)
            && limit("exclusiveMaximum").is_none_or(|max| number < max);
        if !is_inside {
            let text = self.sources.excerpt(&node.origin);
            let expected = wording::range(schema).unwrap_or_default();
            self.error(node, at, format!("{text} is out of range, expected {expected}"));
        }
    }

    fn array(&mut self, node: &Node, items: &[Node], schema: &Json, at: &At<'_>) {
        let limit = |word: &str| schema[word].as_u64().map(|limit| limit as usize);
        let too_few = limit("minItems").is_some_and(|min| items.len() < min);
        if too_few || limit("maxItems").is_some_and(|max| items.len() > max) {
            let expected = wording::length(schema, at.unit);
            self.error(
                node,
                at,
                format!("expected {expected}, found {}", wording::count(items.len())),
            );
        }
        for (i, item) in items.iter().enumerate() {
            self.value(item, &schema["items"], &at.index(i));
        }
    }
}
