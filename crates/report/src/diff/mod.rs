//! Compares the measures of two reports: whether they differ by more than their errors.
//!
//! Reading is one function, [`read()`]; the rest is pure. Only the files of reports are used: no
//! scene is loaded, nothing is traced. The errors of both sides are taken as independent. Runs with
//! the same seed are not: their noise is correlated, so their differences are smaller than the
//! reported errors.

mod html;
mod maps;
mod measures;
mod page;
mod read;
mod record;

pub use maps::{MapDiff, MapOutcome};
pub(crate) use maps::{MapTable, limit};
pub use measures::{DiffRow, Judgement};
pub use measures::{Limits, MapLimit};
pub(crate) use page::sentence;
pub use page::{ShownRows, diff_table};
pub use read::read;
pub use read::{ComparedReport, Content, DesignRow};
pub use record::Diff;

use crate::OutputFile;
use crate::diff::measures::Pair;
use indexmap::IndexMap;
use lumiduct_base::error::{Error, Result};
use lumiduct_core::measure::{Measure, nearest};

/// What is compared, and how.
#[derive(Debug, Clone)]
pub struct DiffOptions {
    /// Limits beyond which two values differ.
    pub limits: Limits,
    /// Prefixes of the names of the measures to compare; empty for all.
    pub only: Vec<String>,
}

/// Compares two reports of the same kind.
///
/// # Errors
///
/// [`Error::Usage`] if one is of a run and the other of a study, they have nothing in common, no common measure
/// begins like an entry of `only`, or no measure can be judged.
pub fn diff(sides: &[ComparedReport; 2], options: &DiffOptions) -> Result<Diff> {
    let [a, b] = sides;
    let mut pairs = Pairs::default();
    let mut maps = Vec::new();
    match (&a.content, &b.content) {
        (Content::Run(a), Content::Run(b)) => {
            pairs.add("", [&a.measures, &b.measures]);
            maps = maps::compare(&a.maps, &b.maps);
        }
        (Content::Study(a), Content::Study(b)) => pairs.add_designs(a, b),
        (Content::Run(_), Content::Study(_)) | (Content::Study(_), Content::Run(_)) => {
            let kind = |side: &ComparedReport| match side.content {
                Content::Run(_) => "the report of a run",
                Content::Study(_) => "the results of a study",
            };
            return Err(Error::Usage(format!(
                "{} is {}, {} {}; name two reports of runs, or two folders of studies",
                a.name,
                kind(a),
                b.name,
                kind(b)
            )));
        }
    }
    pairs.keep_only(&options.only)?;
    let is_wanted = |name: &str| is_named(&options.only, name);
    maps.retain(|map| is_wanted(&map.name));
    let mut rows: Vec<DiffRow> =
        pairs.both.into_iter().map(|pair| measures::judge(pair, options.limits)).collect();
    measures::sort(&mut rows);
    if !rows.iter().any(|row| row.judgement != Judgement::Unknown) {
        return Err(Error::Usage(match rows.first() {
            None => nothing_in_common(a, b),
            Some(row) => format!(
                "none of the {} measures can be judged: for example, {} {}; trace more paths",
                rows.len(),
                row.name,
                row.doubt.as_deref().unwrap_or_default()
            ),
        }));
    }
    Ok(Diff {
        names: [a.name.clone(), b.name.clone()],
        facts: [a.facts.clone(), b.facts.clone()],
        limits: options.limits,
        rows,
        only_in: pairs.only_in,
        maps,
        checks: a.checks.iter().chain(&b.checks).cloned().collect(),
    })
}

fn nothing_in_common(a: &ComparedReport, b: &ComparedReport) -> String {
    let what = match a.content {
        Content::Run(_) => "no measure in common",
        Content::Study(_) => "no design in common (same settings, and a measure in both)",
    };
    format!("{} and {} have {what}", a.name, b.name)
}

/// All files of a comparison: pictures of maps first, so that the page can name them.
///
/// # Errors
///
/// [`Error::Output`] if a picture cannot be drawn, or the table or the page cannot be composed.
pub fn diff_files(diff: &Diff) -> Result<Vec<OutputFile>> {
    let mut files = maps::pictures(&diff.maps)?;
    let page = page::markdown(diff);
    files.push(page::table_file(diff)?);
    files.push(OutputFile::text("diff.md", page));
    files.push(OutputFile::text("diff.html", html::html(diff)?));
    Ok(files)
}

/// What both sides have, and what only one has.
#[derive(Debug, Default)]
struct Pairs {
    both: Vec<Pair>,
    only_in: [Vec<String>; 2],
}

impl Pairs {
    fn add(&mut self, prefix: &str, [a, b]: [&IndexMap<String, Measure>; 2]) {
        for (name, own) in a {
            match b.get(name) {
                Some(other) => self.both.push(Pair {
                    name: format!("{prefix}{name}"),
                    measure: name.clone(),
                    values: [own.clone(), other.clone()],
                    scale: measures::scale(name, [a, b]),
                }),
                None => self.only_in[0].push(format!("{prefix}{name}")),
            }
        }
        let strange = b.keys().filter(|name| !a.contains_key(*name));
        self.only_in[1].extend(strange.map(|name| format!("{prefix}{name}")));
    }

    /// Pairs designs by their settings, regardless of their numbers.
    fn add_designs(&mut self, a: &[DesignRow], b: &[DesignRow]) {
        let mut left: Vec<&DesignRow> = b.iter().collect();
        let nothing = IndexMap::new();
        for own in a {
            // A list may contain a design twice; each gets its own partner.
            match left.iter().position(|other| other.settings == own.settings) {
                Some(place) => {
                    let other = left.remove(place);
                    self.add(&own.prefix(), [&own.measures, &other.measures]);
                }
                None => self.add(&own.prefix(), [&own.measures, &nothing]),
            }
        }
        for other in left {
            self.add(&other.prefix(), [&nothing, &other.measures]);
        }
    }

    /// Keeps measures whose name has one of these prefixes; each prefix must match at least one.
    fn keep_only(&mut self, only: &[String]) -> Result<()> {
        for pattern in only {
            if !self.both.iter().any(|pair| pair.measure.starts_with(pattern)) {
                let known =
                    nearest(pattern, self.both.iter().map(|pair| pair.measure.as_str())).join(", ");
                let known = if known.is_empty() { "none".to_owned() } else { known };
                return Err(Error::Usage(format!(
                    "--only {pattern}: no measure of both reports begins like this; nearest: {known}"
                )));
            }
        }
        self.both.retain(|pair| is_named(only, &pair.measure));
        for names in &mut self.only_in {
            names.retain(|name| is_named(only, name.rsplit(": ").next().unwrap_or(name)));
        }
        Ok(())
    }
}

/// Whether a name has one of these prefixes, or there are none.
fn is_named(only: &[String], name: &str) -> bool {
    only.is_empty() || only.iter().any(|pattern| name.starts_with(pattern))
}

#[cfg(test)]
mod tests;
