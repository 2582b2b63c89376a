//! Names: their letters, and that none is used twice.

use crate::input::keys::{Key, Places, is_bare};
use crate::input::problems::Problems;
use crate::input::tree::{Entry, Node};

/// Tables whose names share the names of faces and measures.
const SHARED: [&str; 4] = ["solids", "sheets", "sources", "sensors"];

/// Names that measures of the whole scene have.
const RESERVED: [&str; 1] = ["balance"];

pub(crate) fn check(places: &Places, problems: &mut Problems) {
    for family in ["media", "finishes", "patterns", "reliefs"].into_iter().chain(SHARED) {
        for (name, entry) in named(places.root(), family) {
            check_letters(&Key::of(&[family, name]), name, entry, problems);
        }
    }
    let all: Vec<_> = SHARED
        .iter()
        .flat_map(|family| named(places.root(), family).map(move |(n, e)| (*family, n, e)))
        .collect();
    let mut first_by_name = indexmap::IndexMap::new();
    for (family, name, entry) in all {
        let key = Key::of(&[family, name]);
        if RESERVED.contains(&name.as_str()) {
            let problem = problems
                .error(&key, format!("the name `{name}` is taken by measures of the whole scene"));
            problem.at(&entry.key);
        }
        if let Some(other) = first_by_name.get(name) {
            let line =
                places.line(other).map(|line| format!(" in line {line}")).unwrap_or_default();
            let problem = problems
                .error(&key, format!("the name `{name}` is used twice, first by `{other}`{line}"));
            problem.hint("solids, sheets, sources and sensors share their names").at(&entry.key);
        } else {
            first_by_name.insert(name.clone(), key);
        }
    }
}

/// Notes a title that would break the head of a report.
pub(crate) fn check_title(title: &str, problems: &mut Problems) {
    if title.contains(char::is_control) {
        problems
            .error(&Key::of(&["title"]), "a title is one line")
            .hint("what needs more is for `description`");
    }
}

fn check_letters(key: &Key, name: &str, entry: &Entry, problems: &mut Problems) {
    if !is_bare(name) {
        let message = "a name is made of letters, digits, `_` and `-`";
        problems.error(key, message).at(&entry.key);
    }
}

fn named<'a>(
    root: &'a Node,
    family: &str,
) -> impl Iterator<Item = (&'a String, &'a Entry)> + use<'a> {
    root.get(family).and_then(Node::table).into_iter().flatten()
}
