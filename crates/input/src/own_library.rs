//! The user's own library: a folder whose media, finishes and emissions join the tables of a scene.
//!
//! They become entries of the tree, so that they are checked like those of the scene, at their places. Entries that
//! the scene does not name are left out of its spec.

use std::collections::BTreeSet;
use std::path::Path;

use indexmap::IndexMap;

use crate::keys::Key;
use crate::problems::Problems;
use crate::spec::SceneSpec;
use crate::texts::{Texts, Unreadable};
use crate::tree::{self, Entry, Node, SyntaxError, Value};

/// The key with the folder.
pub(crate) const LIBRARY: &str = "library";

/// The tables for which a library may have a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Family {
    Media,
    Finishes,
    Emissions,
}

impl Family {
    const ALL: [Self; 3] = [Self::Media, Self::Finishes, Self::Emissions];

    /// The name of the table and of its file.
    fn name(self) -> &'static str {
        match self {
            Self::Media => "media",
            Self::Finishes => "finishes",
            Self::Emissions => "emissions",
        }
    }
}

/// Texts of an entry for its readers, which scenes do not have.
const TEXTS: [&str; 3] = ["description", "source", "licence"];

/// The wavelengths of the measurements of a medium, also for readers.
const RANGE: &str = "range_nm";

/// The entries of a library that joined a scene: their tables and names.
#[derive(Debug, Default)]
pub(crate) struct Joined {
    entries: Vec<(Family, String)>,
}

impl Joined {
    /// Removes the entries that no text of the tree names.
    pub(crate) fn leave_out_unnamed(&self, root: &Node, spec: &mut SceneSpec) {
        let mut texts = BTreeSet::new();
        collect_texts(root, &mut texts);
        for (family, name) in self.entries.iter().filter(|(_, name)| !texts.contains(name.as_str()))
        {
            match family {
                Family::Media => drop(spec.media.shift_remove(name)),
                Family::Finishes => drop(spec.finishes.shift_remove(name)),
                Family::Emissions => drop(spec.emissions.shift_remove(name)),
            }
        }
    }
}

/// Adds the entries of the library of a scene to its tables; entries of the scene win. Returns the
/// syntax errors of its files.
pub(crate) fn join(
    root: &mut Node,
    sources: &mut Texts,
    problems: &mut Problems,
) -> (Joined, Vec<SyntaxError>) {
    let (mut joined, mut breaks) = (Joined::default(), Vec::new());
    let named = root.get(LIBRARY).and_then(|node| Some((node.text()?, node.origin.clone())));
    let Some((folder, origin)) = named else { return (joined, breaks) };
    let base = sources.folder(&origin).or_else(|| sources.folder(&root.origin));
    let folder = base.unwrap_or(Path::new("")).join(folder);
    let key = Key::of(&[LIBRARY]);
    if !folder.is_dir() {
        problems
            .error(&key, format!("{}: no such folder", folder.display()))
            .at(&origin)
            .hint("a path is relative to the folder of this file");
        return (joined, breaks);
    }
    let mut missing = 0;
    for family in Family::ALL {
        let path = folder.join(format!("{}.toml", family.name()));
        match sources.add_file(&path) {
            Ok(source) => {
                let (file, errors) = tree::parse(sources, source);
                breaks.extend(errors);
                join_file(root, family, file, &mut joined, problems);
            }
            Err(Unreadable::Missing) => missing += 1,
            Err(reason) => {
                problems.error(&key, format!("{}: {reason}", path.display())).at(&origin);
            }
        }
    }
    if missing == Family::ALL.len() {
        let files = Family::ALL.map(|family| format!("{}.toml", family.name())).join(", ");
        problems.error(&key, format!("{} has none of {files}", folder.display())).at(&origin);
    }
    (joined, breaks)
}

fn join_file(
    root: &mut Node,
    family: Family,
    file: Node,
    joined: &mut Joined,
    problems: &mut Problems,
) {
    let origin = file.origin.clone();
    let (Value::Table(tables), Value::Table(listed)) = (&mut root.value, file.value) else {
        return;
    };
    let empty = || Node { origin: origin.clone(), value: Value::Table(IndexMap::new()) };
    let table = tables
        .entry(family.name().to_owned())
        .or_insert_with(|| Entry { key: origin.clone(), node: empty() });
    // What is no table is reported when the tree is validated.
    let Value::Table(own) = &mut table.node.value else { return };
    for (name, mut entry) in listed {
        take_texts(&mut entry.node, family, &name, problems);
        if !own.contains_key(&name) {
            own.insert(name.clone(), entry);
            joined.entries.push((family, name));
        }
    }
}

/// Removes the keys of an entry that scenes do not have.
fn take_texts(node: &mut Node, family: Family, name: &str, problems: &mut Problems) {
    let key = Key::of(&[family.name(), name]);
    let Value::Table(entries) = &mut node.value else { return };
    for name in TEXTS {
        let Some(Entry { node, .. }) = entries.shift_remove(name) else { continue };
        if node.text().is_none() && node.value != Value::Unreadable {
            problems.error(&key.field(name), "expected text in quotes").at(&node.origin);
        }
    }
    if family != Family::Media {
        return;
    }
    let Some(Entry { node, .. }) = entries.shift_remove(RANGE) else { return };
    let is_number = |item: &Node| matches!(item.value, Value::Integer(_) | Value::Float(_));
    let is_range = match &node.value {
        Value::Array(items) => items.len() == 2 && items.iter().all(is_number),
        Value::Unreadable => true,
        Value::Table(_)
        | Value::String(_)
        | Value::Integer(_)
        | Value::Float(_)
        | Value::Boolean(_)
        | Value::Datetime => false,
    };
    if !is_range {
        problems.error(&key.field(RANGE), "expected an array of 2 numbers in nm").at(&node.origin);
    }
}

fn collect_texts<'a>(node: &'a Node, texts: &mut BTreeSet<&'a str>) {
    match &node.value {
        Value::Table(entries) => {
            entries.values().for_each(|entry| collect_texts(&entry.node, texts));
        }
        Value::Array(items) => items.iter().for_each(|item| collect_texts(item, texts)),
        Value::String(text) => drop(texts.insert(text)),
        Value::Integer(_)
        | Value::Float(_)
        | Value::Boolean(_)
        | Value::Datetime
        | Value::Unreadable => {}
    }
}

#[cfg(test)]
mod tests {
    use crate::read;
    use std::path::Path;

    const SCENE: &str = r#"
lumiduct = 1
title = "Rod"
library = "own"
finishes.wall = { specular = { reflectance = 0.5 } }
[solids.rod.cylinder]
radius_mm = 1
length_mm = 10
medium = "gel"
faces = { wall = "wall", exit = "esr", entry = "half" }
[sources.led.disk]
radius_mm = 0.5
flux_lm = 1
emission = "round_5mm_15deg"
at = { face = "rod.entry", gap_mm = 0.1 }
[run]
paths = 1000
"#;

    fn scene(folder: &Path, files: &[(&str, &str)]) -> std::path::PathBuf {
        std::fs::create_dir(folder.join("own")).unwrap();
        for (name, text) in files {
            std::fs::write(folder.join("own").join(name), text).unwrap();
        }
        let path = folder.join("rod.toml");
        std::fs::write(&path, SCENE).unwrap();
        path
    }

    #[test]
    fn entries_of_the_scene_win_over_the_folder_and_those_of_the_folder_over_the_library() {
        let folder = tempfile::tempdir().unwrap();
        let media = "[gel]\nindex = 1.41\nsource = \"our lab\"\n[unused]\nindex = 1.6\n";
        let finishes = "wall.absorber = {}\nesr = { specular.reflectance = 0.97, licence = \"ours\" }\n\
            half.mixture = [{ weight = 1, finish = \"part\" }]\npart.absorber = {}\nother.open = {}\n";
        let emissions = "round_5mm_15deg.viewing_angle_deg = 17\n";
        let files =
            [("media.toml", media), ("finishes.toml", finishes), ("emissions.toml", emissions)];
        let spec = read(&scene(folder.path(), &files), &[]).unwrap().spec;
        assert_eq!(spec.media.keys().collect::<Vec<_>>(), ["gel"]);
        assert_eq!(spec.finishes.keys().collect::<Vec<_>>(), ["wall", "esr", "half", "part"]);
        let json = serde_json::to_value(&spec).unwrap();
        assert_eq!(json["finishes"]["wall"]["specular"]["reflectance"], 0.5);
        assert_eq!(json["finishes"]["esr"]["specular"]["reflectance"], 0.97);
        assert_eq!(json["emissions"]["round_5mm_15deg"]["viewing_angle_deg"], 17.0);
    }

    #[test]
    fn the_library_of_the_program_is_valid_as_a_folder_of_a_user() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rod.toml");
        let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("library");
        let text = SCENE.replace("gel", "pmma").replace("\"half\"", "\"silver\"");
        std::fs::write(&path, text).unwrap();
        let overrides = [format!("library={}", own.display())];
        let spec = read(&path, &overrides).unwrap_or_else(|error| panic!("{error}")).spec;
        assert_eq!(spec.finishes.keys().collect::<Vec<_>>(), ["wall", "silver", "esr"]);
        assert_eq!(spec.media.keys().collect::<Vec<_>>(), ["pmma"]);
    }

    #[test]
    fn folders_without_a_library_are_refused() {
        for (library, words) in [("gone", "gone: no such folder"), (".", "has none of media.toml")]
        {
            let folder = tempfile::tempdir().unwrap();
            let path = scene(folder.path(), &[]);
            let error = read(&path, &[format!("library={library}")]).unwrap_err().to_string();
            assert!(error.contains("library") && error.contains(words), "{error}");
        }
    }
}
