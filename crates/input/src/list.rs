//! Lists the scenes, studies and sensor files below a folder.

use crate::texts::{Texts, Unreadable};
use lumiduct_base::error::{Error, Result};
use lumiduct_base::text::visible;
use std::fs;
use std::path::Path;

/// Depth to which subfolders are searched.
const DEPTH: usize = 4;

/// A line for each scene and study, with its title, and for each sensor file, in the order of their paths.
///
/// # Errors
///
/// [`Error::Usage`] if it is not a folder, [`Error::Io`] if it or a folder in it cannot be read.
pub fn list(folder: &Path) -> Result<String> {
    if !folder.is_dir() {
        return Err(Error::Usage(format!("{} is not a folder", folder.display())));
    }
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
            // Reports contain copies of scenes, wherever they are; build output and tests contain
            // none to run.
            let is_report = ["summary.json", "batch.json", "optimisation.json"]
                .iter()
                .any(|name| path.join(name).is_file());
            let is_passed_by =
                name.starts_with('.') || ["target", "tests"].contains(&name.as_str());
            if depth > 0 && !is_report && !is_passed_by {
                collect(&path, depth - 1, lines)?;
            }
        } else if path.extension().is_some_and(|extension| extension == "toml")
            && let Some(what) = describe(&path)
        {
            lines.push((one_line(&path.display().to_string()), one_line(&what)));
        }
    }
    Ok(())
}

/// A text as one line of a list.
fn one_line(text: &str) -> String {
    visible(text).replace(['\n', '\t'], " ")
}

/// The title of a scene or a study, or the kind of a sensor file, or a note that it cannot be read;
/// `None` for anything else.
fn describe(path: &Path) -> Option<String> {
    let mut sources = Texts::default();
    let table = match sources.add_file(path) {
        Ok(source) => sources.get(source).text().parse::<toml::Table>(),
        // A pipe or a device may never end.
        Err(Unreadable::NotAFile) => return None,
        Err(reason) => return Some(format!("({reason})")),
    };
    let Ok(table) = table else {
        return Some("(not valid TOML: run `lumiduct check` to see where)".to_owned());
    };
    if table.contains_key("lumiduct") {
        return Some(
            table.get("title").and_then(toml::Value::as_str).unwrap_or("(no title)").to_owned(),
        );
    }
    if table.contains_key("lumiduct_study") {
        let title = table.get("title").and_then(toml::Value::as_str).unwrap_or("(no title)");
        return Some(format!("study: {title}"));
    }
    let kind = ["plane", "goniometer", "luminance", "image"]
        .into_iter()
        .find(|kind| table.contains_key(*kind))?;
    Some(format!("sensor file: {kind}"))
}
