//! What can be run: the scenes and sensor files below a folder.

use crate::error::{Error, Result};
use std::fs;
use std::path::Path;

/// Folders below the start that are still looked into.
const DEPTH: usize = 4;

/// A line for each scene, with its title, and for each sensor file, in the order of their paths.
pub fn list(folder: &Path) -> Result<String> {
    let mut lines = Vec::new();
    collect(folder, DEPTH, &mut lines)?;
    if lines.is_empty() {
        return Ok(format!("no scenes below {}\n", folder.display()));
    }
    let width = lines.iter().map(|(path, _)| path.chars().count()).max().unwrap_or(0);
    Ok(lines.iter().map(|(path, what)| format!("{path:width$}  {what}\n")).collect())
}

fn collect(folder: &Path, depth: usize, lines: &mut Vec<(String, String)>) -> Result<()> {
    let entries = fs::read_dir(folder).map_err(|source| Error::io(folder, source))?;
    let mut paths: Vec<_> =
        entries.filter_map(|entry| entry.ok().map(|entry| entry.path())).collect();
    paths.sort();
    for path in paths {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_dir() {
            // Build products and reports hold copies of scenes.
            if depth > 0
                && !name.starts_with('.')
                && !["target", "reports"].contains(&name.as_str())
            {
                collect(&path, depth - 1, lines)?;
            }
        } else if path.extension().is_some_and(|extension| extension == "toml")
            && let Some(what) = describe(&path)
        {
            lines.push((path.display().to_string(), what));
        }
    }
    Ok(())
}

/// The title of a scene, or the kind of a sensor file; `None` for anything else.
fn describe(path: &Path) -> Option<String> {
    let table: toml::Table = fs::read_to_string(path).ok()?.parse().ok()?;
    if table.contains_key("lumiduct") {
        return Some(
            table.get("title").and_then(toml::Value::as_str).unwrap_or("(no title)").to_owned(),
        );
    }
    let kind =
        ["plane", "goniometer", "luminance"].into_iter().find(|kind| table.contains_key(*kind))?;
    Some(format!("sensor file: {kind}"))
}
