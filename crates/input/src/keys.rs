//! Dotted keys and their places in the files.

use std::fmt;
use std::path::PathBuf;

use crate::texts::{Origin, Texts};
use crate::tree::{Node, Value};

/// A path through tables and arrays, such as `solids.pipe.sweep.path.0.straight_mm`.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Key {
    segments: Vec<KeySegment>,
}

/// One step of a key.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum KeySegment {
    /// Into a table.
    Field(String),
    /// Into an array, from 0.
    Index(usize),
}

impl Key {
    /// The whole file.
    pub(crate) fn root() -> Self {
        Self::default()
    }

    /// A path through tables only.
    pub fn of(fields: &[&str]) -> Self {
        Self { segments: fields.iter().map(|field| KeySegment::Field((*field).into())).collect() }
    }

    /// The key of a field of the table at this key.
    pub fn field(&self, name: &str) -> Self {
        self.step(KeySegment::Field(name.into()))
    }

    /// The key of an entry of the array at this key, from 0.
    pub fn index(&self, index: usize) -> Self {
        self.step(KeySegment::Index(index))
    }

    /// The key one step further.
    pub(crate) fn step(&self, segment: KeySegment) -> Self {
        let mut segments = self.segments.clone();
        segments.push(segment);
        Self { segments }
    }

    /// The steps.
    pub(crate) fn segments(&self) -> &[KeySegment] {
        &self.segments
    }

    /// The table or array around it; of the whole file, itself.
    pub(crate) fn parent(&self) -> Self {
        Self { segments: self.segments[..self.segments.len().saturating_sub(1)].to_vec() }
    }

    /// Whether this is `other` or inside it.
    pub(crate) fn is_within(&self, other: &Self) -> bool {
        self.segments.starts_with(&other.segments)
    }
}

impl fmt::Display for Key {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, segment) in self.segments.iter().enumerate() {
            if i > 0 {
                write!(out, ".")?;
            }
            match segment {
                KeySegment::Field(name) if is_bare(name) => write!(out, "{name}")?,
                KeySegment::Field(name) => write!(out, "\"{}\"", name.escape_debug())?,
                KeySegment::Index(index) => write!(out, "{index}")?,
            }
        }
        Ok(())
    }
}

/// Whether a key needs no quotes: letters, digits, `_` and `-`.
pub(crate) fn is_bare(name: &str) -> bool {
    !name.is_empty() && name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_' || b == b'-')
}

/// The places of the keys of a scene in its files.
#[derive(Debug, Clone, PartialEq)]
pub struct Places {
    root: Node,
    sources: Texts,
}

impl Places {
    /// The places of a tree whose texts are `sources`.
    pub(crate) fn new(root: Node, sources: Texts) -> Self {
        Self { root, sources }
    }

    /// The tree.
    pub fn root(&self) -> &Node {
        &self.root
    }

    /// The texts.
    pub(crate) fn sources(&self) -> &Texts {
        &self.sources
    }

    /// The whole text of the file of the tree.
    pub(crate) fn root_text(&self) -> &str {
        self.sources.get(self.root.origin.source).text()
    }

    /// Whether the files contain this key.
    pub fn has(&self, key: &Key) -> bool {
        self.node(key).is_some()
    }

    /// The node at this key; `None` where the files do not contain it.
    pub(crate) fn node(&self, key: &Key) -> Option<&Node> {
        let (node, depth) = self.walk(key);
        (depth == key.segments.len()).then_some(node)
    }

    /// The place of the value of a key, or of the innermost existing table around it. `None` if
    /// there is none.
    pub(crate) fn value(&self, key: &Key) -> Option<&Origin> {
        let (node, depth) = self.walk(key);
        (depth > 0).then_some(&node.origin)
    }

    /// Line of a key in its file, from 1; `None` when it is not in a file.
    pub fn line(&self, key: &Key) -> Option<usize> {
        let origin = self.value(key)?;
        self.sources.get(origin.source).line(origin.span.start)
    }

    /// Whether a key is in another file than that of the tree.
    pub(crate) fn is_in_another_file(&self, key: &Key) -> bool {
        let is_other = |origin: &&Origin| origin.source != self.root.origin.source;
        let other = self.value(key).filter(is_other);
        other.is_some_and(|origin| self.sources.folder(origin).is_some())
    }

    /// The folder that a relative path at this key starts from: that of the file that contains the
    /// key; for the command line that of the scene.
    pub fn folder(&self, key: &Key) -> PathBuf {
        let own = self.sources.folder(&self.walk(key).0.origin);
        own.or_else(|| self.sources.folder(&self.root.origin))
            .map(PathBuf::from)
            .unwrap_or_default()
    }

    /// The innermost value on the way to a key, and how many steps lead to it.
    fn walk(&self, key: &Key) -> (&Node, usize) {
        let mut node = &self.root;
        for (depth, segment) in key.segments.iter().enumerate() {
            let next = match (segment, &node.value) {
                (KeySegment::Field(name), Value::Table(entries)) => {
                    entries.get(name).map(|entry| &entry.node)
                }
                (KeySegment::Index(index), Value::Array(items)) => items.get(*index),
                (KeySegment::Field(_) | KeySegment::Index(_), _) => None,
            };
            match next {
                Some(next) => node = next,
                None => return (node, depth),
            }
        }
        (node, key.segments.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_print_as_they_are_written_in_a_file() {
        let key = Key::of(&["solids", "my rod"]).field("path").index(2).field("bend_deg");
        assert_eq!(key.to_string(), "solids.\"my rod\".path.2.bend_deg");
        assert!(key.is_within(&Key::of(&["solids"])));
        assert!(!Key::of(&["solids"]).is_within(&key));
    }
}
