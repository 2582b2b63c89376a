//! Names: their characters, and that they are unique.

use crate::keys::{Key, Places, is_bare};
use crate::problems::{Problem, Problems};
use crate::tree::{Entry, Node};

/// Tables whose names share the names of faces and measures.
const SHARED: [&str; 4] = ["solids", "sheets", "sources", "sensors"];

/// Names that measures of the whole scene have.
const RESERVED: [&str; 1] = ["balance"];

/// Most letters of a name: file names contain up to three of them, and file systems take 255 bytes
/// (POSIX `NAME_MAX`).
const MOST_LETTERS: usize = 64;

pub(crate) fn check(places: &Places, problems: &mut Problems) {
    for family in
        ["media", "finishes", "emissions", "patterns", "reliefs"].into_iter().chain(SHARED)
    {
        for (name, entry) in named(places.root(), family) {
            if let Some(problem) = check_name(name, &Key::of(&[family, name]), problems) {
                problem.at(&entry.key);
            }
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
            let problem = problems.certain_error(
                &key,
                format!("the name `{name}` is taken by measures of the whole scene"),
            );
            problem.at(&entry.key);
        }
        if let Some(other) = first_by_name.get(name) {
            let line =
                places.line(other).map(|line| format!(" in line {line}")).unwrap_or_default();
            let problem = problems.certain_error(
                &key,
                format!("the name `{name}` is used twice, first by `{other}`{line}"),
            );
            problem.hint("solids, sheets, sources and sensors share their names").at(&entry.key);
        } else {
            first_by_name.insert(name.clone(), key);
        }
    }
}

/// Notes a title that would break the heading of a report.
pub(crate) fn check_title(title: &str, problems: &mut Problems) {
    if title.contains(char::is_control) {
        problems
            .certain_error(&Key::of(&["title"]), "a title must be one line")
            .hint("put longer text into `description`");
    }
}

/// Notes a name that is invalid for files and columns.
pub(crate) fn check_name<'p>(
    name: &str,
    key: &Key,
    problems: &'p mut Problems,
) -> Option<&'p mut Problem> {
    if !is_bare(name) {
        return Some(
            problems.certain_error(key, "a name consists of letters, digits, `_` and `-`"),
        );
    }
    check_length("name", name, key, problems)
}

/// Notes a text that is too long for the name of a file or a column. `what` says what it is.
pub(crate) fn check_length<'p>(
    what: &str,
    text: &str,
    key: &Key,
    problems: &'p mut Problems,
) -> Option<&'p mut Problem> {
    let letters = text.chars().count();
    (letters > MOST_LETTERS).then(|| {
        let message = format!("a {what} of {letters} letters is too long, at most {MOST_LETTERS}");
        problems.certain_error(key, message).hint("files and columns of reports are named after it")
    })
}

fn named<'a>(
    root: &'a Node,
    family: &str,
) -> impl Iterator<Item = (&'a String, &'a Entry)> + use<'a> {
    root.get(family).and_then(Node::table).into_iter().flatten()
}
