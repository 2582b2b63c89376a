//! A TOML text as a tree that knows the place of each of its values.
//!
//! Knows nothing of scenes. Unlike the parser's own tree it owns its text, and parts of several
//! files may be merged.

use indexmap::IndexMap;
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use crate::texts::{Origin, TextId, Texts};
use lumiduct_base::text::is_control;

/// Deepest nesting of tables and arrays.
pub(crate) const MAX_DEPTH: usize = 64;

/// A value and its place.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// The value, or the header or key of a table.
    pub origin: Origin,
    /// The value itself.
    pub value: Value,
}

/// A value of TOML.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A table, in the order of the file.
    Table(IndexMap<String, Entry>),
    /// An array.
    Array(Vec<Node>),
    /// Text.
    String(String),
    /// An integer.
    Integer(i64),
    /// A number with a point or an exponent; may be infinite or NaN.
    Float(f64),
    /// True or false.
    Boolean(bool),
    /// A date or a time, which no key of a scene takes.
    Datetime,
    /// A value with a syntax error, which has been reported and is skipped.
    Unreadable,
}

/// A key of a table with its value.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// The place of the key.
    pub key: Origin,
    /// Its value.
    pub node: Node,
}

impl Node {
    /// The entries, if this is a table.
    pub(crate) fn table(&self) -> Option<&IndexMap<String, Entry>> {
        match &self.value {
            Value::Table(entries) => Some(entries),
            Value::Array(_)
            | Value::String(_)
            | Value::Integer(_)
            | Value::Float(_)
            | Value::Boolean(_)
            | Value::Datetime
            | Value::Unreadable => None,
        }
    }

    /// The value of a key, if this is a table that has it.
    pub(crate) fn get(&self, key: &str) -> Option<&Self> {
        Some(&self.table()?.get(key)?.node)
    }

    /// The text, if this is text.
    pub(crate) fn text(&self) -> Option<&str> {
        match &self.value {
            Value::String(text) => Some(text),
            Value::Table(_)
            | Value::Array(_)
            | Value::Integer(_)
            | Value::Float(_)
            | Value::Boolean(_)
            | Value::Datetime
            | Value::Unreadable => None,
        }
    }

    /// The same tree without places. Dates, non-finite numbers and unreadable values become null.
    pub(crate) fn to_json(&self) -> serde_json::Value {
        match &self.value {
            Value::Table(entries) => {
                entries.iter().map(|(key, entry)| (key.clone(), entry.node.to_json())).collect()
            }
            Value::Array(items) => items.iter().map(Self::to_json).collect(),
            Value::String(text) => text.as_str().into(),
            Value::Integer(number) => (*number).into(),
            Value::Float(number) => (*number).into(),
            Value::Boolean(truth) => (*truth).into(),
            Value::Datetime | Value::Unreadable => serde_json::Value::Null,
        }
    }
}

/// A syntax error.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct SyntaxError {
    /// Where.
    pub origin: Origin,
    /// The key it refers to, if any.
    pub key: String,
    /// What is wrong.
    pub message: String,
}

/// The tree of a whole text, and all its syntax errors. The tree has everything readable despite
/// them.
pub(crate) fn parse(sources: &Texts, source: TextId) -> (Node, Vec<SyntaxError>) {
    let text = sources.get(source).text();
    let (table, failures) = DeTable::parse_recoverable(text);
    let mut reader = Reader { source, offset: 0, errors: Vec::new() };
    let root = reader.table(table.into_inner(), 0..0, 0);
    reader.note_failures(text, failures);
    (root, one_per_line(sources, reader.errors))
}

/// The value in a part of a text, from `offset` to the end; or its syntax errors.
pub(crate) fn parse_value(
    sources: &Texts,
    source: TextId,
    offset: usize,
) -> Result<Node, Vec<SyntaxError>> {
    let text = &sources.get(source).text()[offset..];
    let (value, failures) = DeValue::parse_recoverable(text);
    let mut reader = Reader { source, offset, errors: Vec::new() };
    let node = reader.node(value, 0);
    reader.note_failures(text, failures);
    if reader.errors.is_empty() { Ok(node) } else { Err(reader.errors) }
}

struct Reader {
    source: TextId,
    /// Where the parsed part begins in the text.
    offset: usize,
    errors: Vec<SyntaxError>,
}

impl Reader {
    fn origin(&self, span: std::ops::Range<usize>) -> Origin {
        Origin { source: self.source, span: span.start + self.offset..span.end + self.offset }
    }

    fn error(&mut self, span: std::ops::Range<usize>, message: &str) -> Value {
        let origin = self.origin(span);
        self.errors.push(SyntaxError { origin, key: String::new(), message: message.into() });
        Value::Unreadable
    }

    fn note_failures(&mut self, text: &str, failures: Vec<toml::de::Error>) {
        for failure in failures {
            let span = failure.span().unwrap_or(0..0);
            let key =
                if failure.message() == "duplicate key" { text.get(span.clone()) } else { None };
            let origin = self.origin(span);
            let message = decimal_comma(text, origin.span.start - self.offset)
                .unwrap_or_else(|| failure.message().to_owned());
            self.errors.push(SyntaxError { origin, key: key.unwrap_or_default().into(), message });
        }
    }

    fn table(&mut self, table: DeTable<'_>, span: std::ops::Range<usize>, depth: usize) -> Node {
        let mut entries = IndexMap::new();
        for (key, value) in table {
            let origin = self.origin(key.span());
            if let Some(letter) = key.get_ref().chars().find(|letter| is_control(*letter)) {
                self.error(key.span(), &control_message("name", letter));
            }
            let node = self.node(value, depth + 1);
            entries.insert(DeString::into_owned(key.into_inner()), Entry { key: origin, node });
        }
        Node { origin: self.origin(span), value: Value::Table(entries) }
    }

    fn node(&mut self, value: Spanned<DeValue<'_>>, depth: usize) -> Node {
        let span = value.span();
        // Where the parser finds no value it puts a zero with the span of the file start.
        let missing = span == (0..0);
        if depth > MAX_DEPTH {
            let value = self.error(span.clone(), &format!("nested deeper than {MAX_DEPTH} levels"));
            return Node { origin: self.origin(span), value };
        }
        let value = match value.into_inner() {
            DeValue::Table(table) => return self.table(table, span, depth),
            DeValue::Integer(_) if missing => Value::Unreadable,
            DeValue::Array(items) => {
                Value::Array(items.into_iter().map(|item| self.node(item, depth + 1)).collect())
            }
            DeValue::String(text) => {
                let is_wrong = |letter: &char| is_control(*letter) && !"\n\r\t".contains(*letter);
                match text.chars().find(is_wrong) {
                    Some(letter) => self.error(span.clone(), &control_message("text", letter)),
                    None => Value::String(text.into_owned()),
                }
            }
            DeValue::Integer(number) => {
                match i64::from_str_radix(number.as_str(), number.radix()) {
                    Ok(number) => Value::Integer(number),
                    Err(_) => self.error(span.clone(), "the integer needs more than 64 bits"),
                }
            }
            DeValue::Float(number) => match number.as_str().parse() {
                Ok(number) => Value::Float(number),
                Err(_) => self.error(span.clone(), "not a number"),
            },
            DeValue::Boolean(truth) => Value::Boolean(truth),
            DeValue::Datetime(_) => Value::Datetime,
        };
        Node { origin: self.origin(span), value }
    }
}

fn control_message(what: &str, letter: char) -> String {
    let code = u32::from(letter);
    format!(
        "this {what} contains the control character U+{code:04X}, which terminals and pages interpret; remove it"
    )
}

/// The message for a number with a decimal comma, such as `1,49`, if there is one in the line of a byte.
fn decimal_comma(text: &str, at: usize) -> Option<String> {
    let start = text.get(..at)?.rfind('\n').map_or(0, |end| end + 1);
    let line = text[start..].lines().next()?;
    let value_starts = line.match_indices('=').map(|(equals, _)| line[equals + 1..].trim_start());
    value_starts.filter_map(with_decimal_comma).next()
}

/// The message for a text that begins with a number with a decimal comma, and with no further key
/// after it.
fn with_decimal_comma(text: &str) -> Option<String> {
    let (whole, rest) = text.split_once(',')?;
    let decimals = &rest[..rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len())];
    let digits = whole.strip_prefix(['+', '-']).unwrap_or(whole);
    let is_number = !digits.is_empty()
        && digits.bytes().all(|byte| byte.is_ascii_digit())
        && !decimals.is_empty();
    let ends = rest[decimals.len()..].trim_start();
    let is_whole = ends.is_empty() || ends.starts_with(['#', '}', ']', ',']);
    (is_number && is_whole).then(|| {
        format!("`{whole},{decimals}` has a decimal comma, expected a point: {whole}.{decimals}")
    })
}

/// The first error of each line: the rest are mostly its echoes.
fn one_per_line(sources: &Texts, mut errors: Vec<SyntaxError>) -> Vec<SyntaxError> {
    let line = |error: &SyntaxError| sources.get(error.origin.source).line(error.origin.span.start);
    errors.sort_by_key(|error| error.origin.span.start);
    errors.dedup_by_key(|error| line(error));
    errors
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> (Node, Vec<SyntaxError>) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.toml");
        std::fs::write(&path, text).unwrap();
        let mut sources = Texts::default();
        let source = sources.add_file(&path).unwrap();
        parse(&sources, source)
    }

    #[test]
    fn values_and_keys_know_where_they_stand() {
        let text = "a = 1\n[b.c]\nd = [2.5, \"x\"]\n";
        let (root, errors) = parsed(text);
        assert!(errors.is_empty());
        let array = root.get("b").unwrap().get("c").unwrap().get("d").unwrap();
        assert_eq!(&text[array.origin.span.clone()], "[2.5, \"x\"]");
        assert_eq!(&text[root.get("b").unwrap().get("c").unwrap().origin.span.clone()], "[b.c]");
        assert_eq!(
            root.to_json(),
            serde_json::json!({ "a": 1, "b": { "c": { "d": [2.5, "x"] } } })
        );
    }

    #[test]
    fn every_broken_line_is_reported_and_the_rest_is_read() {
        let (root, errors) = parsed("a = \nb = 2\nb = 3\nc = [1,, 2]\nd = 4\n");
        assert_eq!(errors.len(), 3, "{errors:?}");
        assert_eq!(errors[1].key, "b");
        assert_eq!(root.get("d").unwrap().value, Value::Integer(4));
    }

    #[test]
    fn control_characters_of_names_and_texts_are_errors() {
        for text in [
            "a = \"x\\u001b[31m\"",
            "a = \"x\u{202e}y\"",
            "\"a\\u0007\" = 1",
            "[\"b\\u009b\"]\nc = 1",
        ] {
            let errors = parsed(text).1;
            assert!(errors.len() == 1 && errors[0].message.contains("U+"), "{text:?}: {errors:?}");
        }
        assert!(parsed("a = \"two\\nlines\\tand a tab\"").1.is_empty());
    }

    #[test]
    fn a_decimal_comma_is_named_and_a_list_is_not_taken_for_one() {
        for (text, number) in [
            ("index = 1,49\n", "1.49"),
            ("a = { index = -1,5 }\n", "-1.5"),
            ("a = { index = 1,5, b = 2 } # x\n", "1.5"),
        ] {
            let errors = parsed(text).1;
            let [error] = errors.as_slice() else { panic!("{text}: {errors:?}") };
            assert!(error.message.contains("decimal comma"), "{text}: {error:?}");
            assert!(error.message.ends_with(number), "{text}: {error:?}");
        }
        assert!(parsed("a = [1,49]\n").1.is_empty());
        assert!(parsed("a = { b = 1,c = 2 }\n").1.is_empty());
        assert!(!parsed("a = [1,49\n").1[0].message.contains("comma, expected a point"));
    }

    #[test]
    fn deep_nesting_is_an_error_and_not_a_crash() {
        let deep = ["[".repeat(100_000), "]".repeat(100_000)].concat();
        for text in [
            format!("a = {deep}"),
            "a.".repeat(1_000_000) + "b = 1",
            format!("[{}b]", "a.".repeat(70)),
        ] {
            assert!(!parsed(&text).1.is_empty());
        }
        let wide = (0..79)
            .fold("1".to_owned(), |inner, _| format!("{{ {}b = {inner} }}", "a.".repeat(78)));
        assert!(!parsed(&format!("x = {wide}")).1.is_empty());
    }
}
