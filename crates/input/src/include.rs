//! Sensor files: tables of a scene that include keys from another file.

use std::path::Path;

use crate::keys::Key;
use crate::problems::{Problems, nearest};
use crate::texts::{Origin, Texts, Unreadable};
use crate::tree::{self, Entry, Node, SyntaxError, Value};

/// The key with the name of another file.
const FILE: &str = "file";

/// Merges the keys of its file into each sensor that refers to one; keys of the scene win. Returns
/// the syntax errors of those files.
pub(crate) fn join_sensor_files(
    root: &mut Node,
    sources: &mut Texts,
    problems: &mut Problems,
) -> Vec<SyntaxError> {
    let mut breaks: Vec<SyntaxError> = Vec::new();
    let scene = root.origin.clone();
    let Value::Table(entries) = &mut root.value else { return breaks };
    let Some(Entry { node: Node { value: Value::Table(sensors), .. }, .. }) =
        entries.get_mut("sensors")
    else {
        return breaks;
    };
    for (name, sensor) in sensors {
        let Some((path, origin)) =
            sensor.node.get(FILE).and_then(|file| Some((file.text()?, file.origin.clone())))
        else {
            continue;
        };
        let folder = sources.folder(&origin).or_else(|| sources.folder(&scene));
        let path = folder.unwrap_or(Path::new("")).join(path);
        let key = Key::of(&["sensors", name]);
        match read(&path, &key, sources, problems) {
            Ok((base, errors)) => {
                sensor.node =
                    joined(base, std::mem::replace(&mut sensor.node, placeholder(&origin)));
                breaks.extend(
                    errors.into_iter().filter(|error| !breaks.contains(error)).collect::<Vec<_>>(),
                );
            }
            Err(reason) => {
                // Keys that only this file gives must not be reported as missing now.
                if let Value::Table(entries) = &mut sensor.node.value
                    && let Some(file) = entries.get_mut(FILE)
                {
                    file.node = placeholder(&origin);
                }
                note_refusal(&reason, &path, &key.field(FILE), &origin, problems);
            }
        }
    }
    breaks
}

fn note_refusal(
    reason: &Refused,
    path: &Path,
    key: &Key,
    origin: &Origin,
    problems: &mut Problems,
) {
    let message = match reason {
        Refused::Unreadable(reason) => format!("{}: {reason}", path.display()),
        Refused::Scene => format!("{} is a scene, not a sensor file", path.display()),
    };
    let problem = problems.error(key, message).at(origin);
    if let (Refused::Unreadable(Unreadable::Missing), Some(near)) = (reason, similar_file(path)) {
        problem.hint(format!("did you mean `{near}`?"));
    }
}

fn read(
    path: &Path,
    key: &Key,
    sources: &mut Texts,
    problems: &mut Problems,
) -> Result<(Node, Vec<SyntaxError>), Refused> {
    let source = sources.add_file(path).map_err(Refused::Unreadable)?;
    let (mut root, errors) = tree::parse(sources, source);
    let Value::Table(entries) = &mut root.value else { return Ok((root, errors)) };
    if entries.contains_key("lumiduct") {
        return Err(Refused::Scene);
    }
    if let Some(nested) = entries.shift_remove(FILE) {
        let message = "a sensor file cannot take keys from another file";
        problems.error(&key.field(FILE), message).at(&nested.key);
    }
    Ok((root, errors))
}

/// Why a file is not a sensor file.
enum Refused {
    Unreadable(Unreadable),
    Scene,
}

/// `base` with the keys of `over`, which win; tables are merged key by key.
fn joined(base: Node, over: Node) -> Node {
    match (base.value, over.value) {
        (Value::Table(mut entries), Value::Table(own)) => {
            for (name, entry) in own {
                let node = match entries.get_mut(&name) {
                    Some(below) => joined(
                        std::mem::replace(&mut below.node, placeholder(&entry.key)),
                        entry.node,
                    ),
                    None => entry.node,
                };
                entries.insert(name, Entry { key: entry.key, node });
            }
            Node { origin: over.origin, value: Value::Table(entries) }
        }
        (_, value) => Node { origin: over.origin, value },
    }
}

fn placeholder(origin: &Origin) -> Node {
    Node { origin: origin.clone(), value: Value::Unreadable }
}

/// A file of the same folder with a similar name.
fn similar_file(path: &Path) -> Option<String> {
    let names = std::fs::read_dir(path.parent()?).ok()?.take(1000).flatten();
    let mut names: Vec<_> =
        names.filter_map(|entry| entry.file_name().into_string().ok()).collect();
    names.sort();
    nearest(path.file_name()?.to_str()?, names.iter().map(String::as_str)).map(str::to_owned)
}
