//! Values for which the schema allows several kinds.

use serde_json::{Map, Value as Json};

use crate::problems::name_hint;
use crate::schema::{Choice, marker};
use crate::tree::{Node, Value};
use crate::validate::{At, Completeness, Entries, Walk, unknown, wording};

impl Walk<'_> {
    pub(crate) fn choice(
        &mut self,
        node: &Node,
        schema: &Json,
        choices: &[Choice<'_>],
        at: &At<'_>,
    ) {
        match &node.value {
            Value::String(text) => self.word(node, text, schema, choices, at),
            Value::Table(entries) => {
                let kinds: Vec<_> = choices.iter().filter_map(kind).collect();
                let forms: Vec<_> = choices.iter().filter_map(form).collect();
                if !kinds.is_empty() {
                    self.kinds(node, entries, &kinds, choices, at);
                } else if !forms.is_empty() {
                    self.forms(node, entries, &forms, at);
                } else {
                    self.wrong_type(node, schema, at);
                }
            }
            Value::Array(_) => self.plain_value(node, schema, choices, &["array"], at),
            Value::Integer(_) => {
                self.plain_value(node, schema, choices, &["number", "integer"], at);
            }
            Value::Float(_) => self.plain_value(node, schema, choices, &["number"], at),
            Value::Boolean(_) | Value::Datetime => {
                self.wrong_type(node, schema, at);
            }
            Value::Unreadable => {}
        }
    }

    /// An array or a number, for a choice of one of these types.
    fn plain_value(
        &mut self,
        node: &Node,
        schema: &Json,
        choices: &[Choice<'_>],
        types: &[&str],
        at: &At<'_>,
    ) {
        match choices.iter().find_map(|choice| plain(choice, types)) {
            Some(schema) => self.value(node, schema, at),
            None => self.wrong_type(node, schema, at),
        }
    }

    fn word(
        &mut self,
        node: &Node,
        text: &str,
        schema: &Json,
        choices: &[Choice<'_>],
        at: &At<'_>,
    ) {
        let words: Vec<_> = choices.iter().filter_map(word).collect();
        if choices.contains(&Choice::Text) || words.contains(&text) {
            return;
        }
        if words.is_empty() {
            // A number in quotes is meant as one.
            let number = choices.iter().find_map(|choice| plain(choice, &["number"]));
            let is_number = text.trim().replacen(',', ".", 1).parse::<f64>().is_ok();
            let meant = number.filter(|_| is_number).unwrap_or(schema);
            return self.wrong_type(node, meant, at);
        }
        let kinds: Vec<_> = choices.iter().filter_map(kind).map(|(kind, _)| kind).collect();
        let hint = self.unknown_word(text, &words, &kinds);
        let expected = wording::expected(self.schema, schema, at.unit);
        let found = wording::found(node, self.sources);
        self.error(node, at, format!("expected {expected}, found {found}")).hint(hint);
    }

    /// A table whose only key is its kind.
    fn kinds(
        &mut self,
        node: &Node,
        entries: &Entries,
        kinds: &[(&str, &Json)],
        choices: &[Choice<'_>],
        at: &At<'_>,
    ) {
        let given: Vec<_> = entries
            .iter()
            .filter_map(|(name, entry)| Some((name, entry, find(kinds, name)?)))
            .collect();
        for (name, entry, schema) in &given {
            self.value(&entry.node, schema, &at.field(name, Some(entry)));
        }
        let inner = given.first().map(|(name, _, schema)| (name.as_str(), *schema));
        for (name, entry) in entries.iter().filter(|(name, _)| find(kinds, name).is_none()) {
            let hint = self.kind_hint(name, kinds, inner, choices, at);
            let message = if given.is_empty() { "unknown kind" } else { "unknown key" };
            self.problems.error(&at.field(name, None).to_key(), message).hint(hint).at(&entry.key);
        }
        let list = wording::list(kinds.iter().map(|(kind, _)| *kind));
        if let [(first, ..), others @ ..] = given.as_slice() {
            for (name, entry, _) in others {
                let key = at.field(name, None).to_key();
                let message = format!(
                    "two kinds in one table: `{first}` and `{name}`, expected one of {list}"
                );
                self.problems.error(&key, message).at(&entry.key);
            }
        } else if entries.is_empty() && self.completeness == Completeness::Whole {
            let origin = at.key.unwrap_or(&node.origin);
            self.problems
                .error(&at.to_key(), format!("is empty, expected one of {list}"))
                .at(origin);
        }
    }

    fn kind_hint(
        &self,
        name: &str,
        kinds: &[(&str, &Json)],
        inner: Option<(&str, &Json)>,
        choices: &[Choice<'_>],
        at: &At<'_>,
    ) -> String {
        if choices.iter().filter_map(word).any(|word| word == name) {
            return format!("write \"{name}\" in quotes, without a table");
        }
        let keys_of = |schema: &Json| -> Map<String, Json> {
            let schema = crate::schema::resolve(self.schema, schema);
            schema["properties"].as_object().cloned().unwrap_or_default()
        };
        let table = at.to_key();
        if let Some((kind, _)) = inner.filter(|(_, schema)| keys_of(schema).contains_key(name)) {
            return format!("`{name}` belongs in `{table}.{kind}`");
        }
        if let Some((kind, _)) = kinds.iter().find(|(_, schema)| keys_of(schema).contains_key(name))
        {
            return format!(
                "the kind goes between the name and the keys, such as `{table}.{kind}.{name}`"
            );
        }
        match inner {
            Some((kind, _)) => format!("only `{kind}` is allowed here"),
            None => name_hint(name, kinds.iter().map(|(kind, _)| *kind)),
        }
    }

    /// A table whose form is identified by the keys that only this form requires.
    fn forms(&mut self, node: &Node, entries: &Entries, forms: &[&Json], at: &At<'_>) {
        let marked: Vec<_> =
            forms.iter().filter_map(|form| Some((marker(form, forms)?, *form))).collect();
        let given: Vec<_> =
            marked.iter().filter(|(marker, _)| entries.contains_key(*marker)).collect();
        let plain = forms.iter().find(|form| marker(form, forms).is_none());
        let at = &At { forms, ..*at };
        match (given.as_slice(), plain) {
            ([(_, form)], _) => self.value(node, form, at),
            ([], Some(form)) => self.value(node, form, at),
            ([], None) => {
                let markers: Vec<_> = marked.iter().map(|(marker, _)| *marker).collect();
                for (name, entry) in
                    entries.iter().filter(|(name, _)| forms.iter().all(|form| !has(form, name)))
                {
                    self.unknown_key(markers.clone(), at, &at.field(name, Some(entry)), name);
                }
                let is_misspelt =
                    |key: &&str| unknown::is_misspelt(key, entries, markers.iter().copied());
                if self.completeness == Completeness::Whole && !markers.iter().any(is_misspelt) {
                    let list = wording::list(markers.iter().copied());
                    let origin = at.key.unwrap_or(&node.origin);
                    self.problems.error(&at.to_key(), format!("needs one of {list}")).at(origin);
                }
            }
            ([(first, _), others @ ..], _) => {
                for (name, _) in others {
                    let message = format!(
                        "two kinds in one table: `{first}` and `{name}`, expected one of them"
                    );
                    let origin = entries.get(*name).map_or(&node.origin, |entry| &entry.key);
                    self.problems.error(&at.field(name, None).to_key(), message).at(origin);
                }
            }
        }
    }
}

fn has(form: &Json, name: &str) -> bool {
    form["properties"].get(name).is_some()
}

fn find<'a>(kinds: &[(&str, &'a Json)], name: &str) -> Option<&'a Json> {
    kinds.iter().find(|(kind, _)| *kind == name).map(|(_, schema)| *schema)
}

fn kind<'a>(choice: &Choice<'a>) -> Option<(&'a str, &'a Json)> {
    match choice {
        Choice::Kind(kind, schema) => Some((*kind, *schema)),
        Choice::Word(..) | Choice::Text | Choice::Plain(_) | Choice::Form(_) => None,
    }
}

fn word<'a>(choice: &Choice<'a>) -> Option<&'a str> {
    match choice {
        Choice::Word(word, _) => Some(*word),
        Choice::Kind(..) | Choice::Text | Choice::Plain(_) | Choice::Form(_) => None,
    }
}

fn form<'a>(choice: &Choice<'a>) -> Option<&'a Json> {
    match choice {
        Choice::Form(schema) => Some(*schema),
        Choice::Word(..) | Choice::Text | Choice::Plain(_) | Choice::Kind(..) => None,
    }
}

/// The schema of a number or an array, if it has one of some types.
fn plain<'a>(choice: &Choice<'a>, types: &[&str]) -> Option<&'a Json> {
    match choice {
        Choice::Plain(schema) => {
            schema["type"].as_str().is_some_and(|own| types.contains(&own)).then_some(*schema)
        }
        Choice::Word(..) | Choice::Text | Choice::Kind(..) | Choice::Form(_) => None,
    }
}
