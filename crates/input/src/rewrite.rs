//! A scene file with some of its values replaced, as text for another folder: comments and order stay.

use crate::keys::KeySegment;
use crate::overrides::parse_key;
use lumiduct_base::error::{Error, Result};
use std::path::{Component, Path, PathBuf};
use toml_edit::{DocumentMut, Item, TableLike, Value};

/// Keys that name files, relative to the file that contains them.
const PATHS: [&str; 3] = ["csv", "file", "logo"];
/// The key of a scene that names a folder; elsewhere it names an entry of a library.
const LIBRARY: &str = "library";

/// Two folders: of the scene, and of its copy.
#[derive(Debug, Clone, Copy)]
pub struct Move<'a> {
    /// The folder that paths in the scene start from.
    pub from: &'a Path,
    /// The folder that they start from in the copy.
    pub to: &'a Path,
}

/// The text of a scene with overrides, each `key=value`, as its values, under some lines of comment.
///
/// # Errors
///
/// [`Error::Output`] if the text is not TOML, or a key has no place in it.
pub fn rewritten_scene(
    text: &str,
    overrides: &[String],
    way: Move<'_>,
    comment: &[String],
) -> Result<String> {
    let failed = |reason: String| Error::Output { what: "the optimised scene".into(), reason };
    let mut document: DocumentMut =
        text.parse().map_err(|error: toml_edit::TomlError| failed(error.to_string()))?;
    for line in overrides {
        let (key, value) = line.split_once('=').unwrap_or((line, ""));
        let key = parse_key(key.trim()).ok_or_else(|| failed(format!("`{key}` is no key")))?;
        // As for an override, anything that is no value of TOML is text.
        let value = value.trim();
        let value = value.parse().unwrap_or_else(|_| Value::from(value));
        put(document.as_item_mut(), key.segments(), value)
            .ok_or_else(|| failed(format!("`{key}` has no place in the file of the scene")))?;
    }
    let change = |path: &str| moved(path, way);
    move_paths(document.as_table_mut(), &change);
    if let Some(library) = document.get_mut(LIBRARY) {
        change_path(library, &change);
    }
    let comment: String = comment.iter().map(|line| format!("# {line}\n")).collect();
    Ok(format!("{comment}{document}"))
}

/// Sets a value below an item; `None` where there is no table or array around it.
fn put(item: &mut Item, way: &[KeySegment], new: Value) -> Option<()> {
    let Some((first, rest)) = way.split_first() else {
        let decor = item.as_value().map(|old| old.decor().clone());
        *item = Item::Value(new);
        if let (Some(own), Some(decor)) = (item.as_value_mut(), decor) {
            *own.decor_mut() = decor;
        }
        return Some(());
    };
    match (first, &mut *item) {
        (KeySegment::Index(index), Item::ArrayOfTables(tables)) => {
            put_into(tables.get_mut(*index)?, rest, new)
        }
        (KeySegment::Index(index), Item::Value(Value::Array(items))) => {
            put_value(items.get_mut(*index)?, rest, new)
        }
        (_, other) => {
            let way: Vec<KeySegment> = way.to_vec();
            put_into(other.as_table_like_mut()?, &way, new)
        }
    }
}

fn put_into(table: &mut dyn TableLike, way: &[KeySegment], new: Value) -> Option<()> {
    let (first, rest) = way.split_first()?;
    let name = match first {
        KeySegment::Field(name) => name.clone(),
        KeySegment::Index(index) => index.to_string(),
    };
    if table.get(&name).is_none() {
        table.insert(&name, Item::Table(toml_edit::Table::new()));
    }
    put(table.get_mut(&name)?, rest, new)
}

fn put_value(value: &mut Value, way: &[KeySegment], new: Value) -> Option<()> {
    let Some((first, rest)) = way.split_first() else {
        let decor = value.decor().clone();
        *value = new;
        *value.decor_mut() = decor;
        return Some(());
    };
    match (first, value) {
        (KeySegment::Index(index), Value::Array(items)) => {
            put_value(items.get_mut(*index)?, rest, new)
        }
        (KeySegment::Field(name), Value::InlineTable(table)) => {
            if rest.is_empty() && table.get(name).is_none() {
                table.insert(name, new);
                return Some(());
            }
            put_value(table.get_mut(name)?, rest, new)
        }
        (KeySegment::Index(_) | KeySegment::Field(_), _) => None,
    }
}

/// Changes all paths of files in a table.
fn move_paths(table: &mut dyn TableLike, change: &dyn Fn(&str) -> String) {
    for (key, item) in table.iter_mut() {
        if PATHS.contains(&key.get()) && item.is_str() {
            change_path(item, change);
        } else if let Some(tables) = item.as_array_of_tables_mut() {
            tables.iter_mut().for_each(|own| move_paths(own, change));
        } else if let Some(items) = item.as_array_mut() {
            move_in_array(items, change);
        } else if let Some(own) = item.as_table_like_mut() {
            move_paths(own, change);
        }
    }
}

/// Changes the path of a file, if it is one.
fn change_path(item: &mut Item, change: &dyn Fn(&str) -> String) {
    if let Some(path) = item.as_str().map(change)
        && let Some(value) = item.as_value_mut()
    {
        let decor = value.decor().clone();
        *value = Value::from(path);
        *value.decor_mut() = decor;
    }
}

fn move_in_array(items: &mut toml_edit::Array, change: &dyn Fn(&str) -> String) {
    for value in items.iter_mut() {
        if let Some(own) = value.as_array_mut() {
            move_in_array(own, change);
        } else if let Some(own) = value.as_inline_table_mut() {
            move_paths(own, change);
        }
    }
}

/// A path as it is seen from the other folder; absolute ones stay.
fn moved(path: &str, way: Move<'_>) -> String {
    if Path::new(path).is_absolute() {
        return path.to_owned();
    }
    let whole = |folder: &Path| {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        folder.canonicalize().unwrap_or_else(|_| folder.to_path_buf())
    };
    let (target, base) = (flat(&whole(way.from).join(path)), flat(&whole(way.to)));
    let (target, base): (Vec<_>, Vec<_>) =
        (target.components().collect(), base.components().collect());
    let common = target.iter().zip(&base).take_while(|(one, other)| one == other).count();
    let up = base[common..].iter().map(|_| "..".to_owned());
    let down = target[common..].iter().map(|own| own.as_os_str().to_string_lossy().into_owned());
    up.chain(down).collect::<Vec<String>>().join("/")
}

/// A path without `.` and `..`.
fn flat(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => _ = out.pop(),
            Component::Prefix(_) | Component::RootDir | Component::Normal(_) => out.push(part),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_replaced_where_they_are_and_everything_else_stays() {
        let text = "# A light.\ntitle = 'a'\nlibrary = '../mine'\n[media]\nwater = { library = \"water\" }\n[patterns.holes]\nelement = { circle = { diameter_mm = 3 } } # drilled\n\
                    [[check]]\nmin = 1\n[sources.led]\nspectrum = { csv = 'led.csv' }\n[sensors]\nfar = { file = \"../sensors/far.toml\" }\n";
        let overrides = [
            "patterns.holes.element.circle.diameter_mm=[[1, 2.5], [3, 4]]",
            "check.0.min=0.5",
            "sources.led.flux_lm=7",
            "title=new",
        ];
        let way = Move { from: Path::new("/lab/scenes"), to: Path::new("/lab/reports/x/y") };
        let comment = ["Found.".to_owned()];
        let made = rewritten_scene(text, &overrides.map(str::to_owned), way, &comment).unwrap();
        for line in [
            "# Found.\n# A light.\ntitle = \"new\"\n",
            "element = { circle = { diameter_mm = [[1, 2.5], [3, 4]] } } # drilled\n",
            "[[check]]\nmin = 0.5\n",
            "far = { file = \"../../../sensors/far.toml\" }\n",
            "flux_lm = 7",
            "library = \"../../../mine\"",
            "spectrum = { csv = \"../../../scenes/led.csv\" }",
            "water = { library = \"water\" }",
        ] {
            assert!(made.contains(line), "{line}\n{made}");
        }
        let nowhere = ["title.a.b=1".to_owned()];
        assert!(rewritten_scene(text, &nowhere, way, &[]).is_err());
    }
}
