//! Values set on the command line: `-D solids.pipe.sweep.path.0.straight_mm=20`.
//!
//! They are inserted into the tree before it is validated, and validated like any other value.

use crate::keys::{Key, KeySegment};
use crate::own_library::LIBRARY;
use crate::problems::{Problems, name_hint};
use crate::texts::{Origin, TextId, Texts};
use crate::tree::{self, Entry, Node, Value};

/// A value for a key, from the command line.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Override {
    key: Key,
    /// The place of the key in the argument.
    key_origin: Origin,
    node: Node,
}

impl Override {
    /// Whether it sets the file of a sensor or the folder of the library, which must be known before they are read.
    pub(crate) fn names_a_file(&self) -> bool {
        match self.key.segments() {
            [KeySegment::Field(key)] => key == LIBRARY,
            [KeySegment::Field(family), _, KeySegment::Field(key)] => {
                family == "sensors" && key == "file"
            }
            [KeySegment::Field(family), _] => {
                family == "sensors" && self.node.get("file").is_some()
            }
            _ => false,
        }
    }
}

/// Reads arguments, each `key=value` without the `-D`. The value is TOML; anything else is taken as
/// text.
pub(crate) fn read(
    arguments: &[String],
    sources: &mut Texts,
    problems: &mut Problems,
) -> Vec<Override> {
    let mut overrides = Vec::new();
    for argument in arguments {
        let source = sources.add_argument(argument);
        match read_one(sources, source) {
            Ok(one) => overrides.push(one),
            Err((message, span)) => {
                problems.error(&Key::root(), message).at(&Origin { source, span });
            }
        }
    }
    overrides
}

fn read_one(sources: &Texts, source: TextId) -> Result<Override, (String, std::ops::Range<usize>)> {
    let text = sources.get(source).text();
    let usage =
        || ("expected KEY=VALUE, such as sources.led.disk.flux_lm=3".to_owned(), 0..text.len());
    let (segments, equals) = read_key(text).ok_or_else(usage)?;
    let rest = &text[equals + 1..];
    let start = equals + 1 + (rest.len() - rest.trim_start().len());
    let node = match tree::parse_value(sources, source, start) {
        Ok(node) => node,
        Err(errors) if rest.trim_start().starts_with(['[', '{', '"', '\'']) => {
            let error = errors.into_iter().next();
            return Err(error.map_or_else(usage, |error| (error.message, error.origin.span)));
        }
        Err(_) => {
            let end = start + rest.trim().len();
            Node {
                origin: Origin { source, span: start..end },
                value: Value::String(rest.trim().into()),
            }
        }
    };
    let key = segments.into_iter().fold(Key::root(), |key, segment| key.step(segment));
    Ok(Override {
        key,
        key_origin: Origin { source, span: 0..text[..equals].trim_end().len() },
        node,
    })
}

/// A dotted key, as before the `=` of an argument; `None` if it is not a key.
pub(crate) fn parse_key(text: &str) -> Option<Key> {
    let (segments, equals) = read_key(&format!("{text}="))?;
    (equals == text.len())
        .then(|| segments.into_iter().fold(Key::root(), |key, segment| key.step(segment)))
}

/// The steps before the first `=` outside quotes, and where that is. A step of digits only is an index.
fn read_key(text: &str) -> Option<(Vec<KeySegment>, usize)> {
    let mut segments = Vec::new();
    let mut word = String::new();
    let mut quote = None;
    let mut was_quoted = false;
    for (i, c) in text.char_indices() {
        match (quote, c) {
            (Some(open), _) if c == open => quote = None,
            (Some(_), _) => word.push(c),
            (None, '"' | '\'') => (quote, was_quoted) = (Some(c), true),
            (None, '.' | '=') => {
                let name = if was_quoted { word.as_str() } else { word.trim() };
                if name.is_empty() {
                    return None;
                }
                segments.push(match name.parse() {
                    Ok(index) if !was_quoted => KeySegment::Index(index),
                    _ => KeySegment::Field(name.into()),
                });
                if c == '=' {
                    return Some((segments, i));
                }
                word.clear();
                was_quoted = false;
            }
            (None, _) => word.push(c),
        }
    }
    None
}

/// Inserts a value into the tree. The table or array around it must exist, except a table at the
/// top of the file.
pub(crate) fn apply(one: &Override, root: &mut Node, problems: &mut Problems) {
    let Some((last, way)) = one.key.segments().split_last() else { return };
    let mut node = root;
    let mut key = Key::root();
    for segment in way {
        if let ([KeySegment::Field(name)], Value::Table(entries)) = (way, &mut node.value) {
            entries.entry(name.clone()).or_insert_with(|| empty_table(&one.key_origin));
        }
        node = match step(node, segment) {
            Ok(next) => next,
            Err((message, hint)) => {
                problems.error(&key.step(segment.clone()), message).hint(hint).at(&one.key_origin);
                return;
            }
        };
        key = key.step(segment.clone());
    }
    if let (Value::Table(entries), KeySegment::Field(_) | KeySegment::Index(_)) =
        (&mut node.value, last)
    {
        let name = name_of(last);
        let key =
            entries.get(&name).map_or_else(|| one.key_origin.clone(), |entry| entry.key.clone());
        let key = if one.node.table().is_some() { one.key_origin.clone() } else { key };
        entries.insert(name, Entry { key, node: one.node.clone() });
        return;
    }
    match step(node, last) {
        Ok(place) => *place = one.node.clone(),
        Err((message, hint)) => {
            problems.error(&one.key, message).hint(hint).at(&one.key_origin);
        }
    }
}

fn step<'a>(node: &'a mut Node, segment: &KeySegment) -> Result<&'a mut Node, (String, String)> {
    match (&mut node.value, segment) {
        (Value::Table(entries), _) => {
            let name = name_of(segment);
            match entries.get_index_of(&name) {
                Some(index) => Ok(&mut entries[index].node),
                None => {
                    let hint = name_hint(&name, entries.keys().map(String::as_str));
                    Err(("there is no such key in the scene".into(), hint))
                }
            }
        }
        (Value::Array(items), KeySegment::Index(index)) => {
            let count = items.len();
            let hint = match count {
                0 => "the array is empty".into(),
                1 => "the array has one entry, 0".into(),
                _ => format!("the array has {count} entries, 0 to {}", count - 1),
            };
            items.get_mut(*index).ok_or_else(|| (format!("index {index} is out of range"), hint))
        }
        (Value::Array(items), KeySegment::Field(_)) => {
            let hint = format!(
                "write the number of an entry, from 0 to {}",
                items.len().saturating_sub(1)
            );
            Err(("expected an index into an array".into(), hint))
        }
        (
            Value::String(_)
            | Value::Integer(_)
            | Value::Float(_)
            | Value::Boolean(_)
            | Value::Datetime
            | Value::Unreadable,
            _,
        ) => Err((
            "there is no such key in the scene".into(),
            "what is there is a single value, not a table".into(),
        )),
    }
}

/// The name of a step in a table, which may consist of digits.
fn name_of(segment: &KeySegment) -> String {
    match segment {
        KeySegment::Field(name) => name.clone(),
        KeySegment::Index(index) => index.to_string(),
    }
}

fn empty_table(origin: &Origin) -> Entry {
    Entry {
        key: origin.clone(),
        node: Node { origin: origin.clone(), value: Value::Table(Default::default()) },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::keys::Places;

    const SCENE: &str = "title = 'a'\n[solids.pipe.sweep]\npath = [{ straight_mm = 1 }]\n";

    fn overridden(arguments: &[&str]) -> (serde_json::Value, Vec<String>) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.toml");
        std::fs::write(&path, SCENE).unwrap();
        let (mut sources, mut problems) = (Texts::default(), Problems::default());
        let source = sources.add_file(&path).unwrap();
        let mut root = tree::parse(&sources, source).0;
        let arguments: Vec<_> = arguments.iter().map(|text| (*text).to_owned()).collect();
        for one in read(&arguments, &mut sources, &mut problems) {
            apply(&one, &mut root, &mut problems);
        }
        let json = root.to_json();
        let diagnostics = problems.into_diagnostics(&Places::new(root, sources));
        (json, diagnostics.iter().map(|diagnostic| diagnostic.to_string()).collect())
    }

    #[test]
    fn values_are_toml_or_else_text() {
        let (json, problems) = overridden(&[
            "solids.pipe.sweep.path.0.straight_mm=20",
            "solids.pipe.sweep.path.0.end_scale = 0.5",
            "title=two words",
            "run.seed=7",
            "solids.pipe.sweep.faces={ wall = \"black\" }",
            "solids.\"pipe\".sweep.medium='pmma'",
        ]);
        assert_eq!(problems, [""; 0]);
        assert_eq!(
            json["solids"]["pipe"]["sweep"]["path"][0],
            serde_json::json!({ "straight_mm": 20, "end_scale": 0.5 })
        );
        assert_eq!(json["title"], "two words");
        assert_eq!(json["run"]["seed"], 7);
        assert_eq!(json["solids"]["pipe"]["sweep"]["medium"], "pmma");
    }

    #[test]
    fn paths_that_lead_nowhere_are_named_with_what_is_there() {
        let (_, problems) = overridden(&[
            "solids.pip.sweep.path.0.straight_mm=20",
            "solids.pipe.sweep.path.1.straight_mm=20",
            "solids.pipe.sweep.path.first.straight_mm=20",
            "title.a=1",
            "title",
            "title=[1,",
            ".a=1",
        ]);
        let expected = [
            "-D solids.pip.sweep.path.0.straight_mm=20: `solids.pip`: there is no such key in the scene; did you mean `pipe`?",
            "-D solids.pipe.sweep.path.1.straight_mm=20: `solids.pipe.sweep.path.1`: index 1 is out of range; the array has one entry, 0",
            "-D solids.pipe.sweep.path.first.straight_mm=20: `solids.pipe.sweep.path.first`: expected an index into an array; write the number of an entry, from 0 to 0",
            "-D title.a=1: `title.a`: there is no such key in the scene; what is there is a single value, not a table",
            "-D title: expected KEY=VALUE, such as sources.led.disk.flux_lm=3",
        ];
        assert_eq!(problems[..5], expected);
        assert_eq!(problems.len(), 7, "{problems:?}");
    }
}
