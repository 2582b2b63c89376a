//! The manual pages of the formats of scenes and studies, made from their schemas.
//!
//! Conventions and examples, which a schema cannot express, are in `xtask/templates`.

mod parts;
#[cfg(test)]
mod tests;

use std::collections::BTreeSet;
use std::fmt::Write;

use serde_json::Value as Json;

use crate::manual::parts::{
    Shared, anchor, default_of, description, kind_of, options, range_of, shared_keys, title,
};
use lumiduct_input::schema::{self, RequiredSet};
use lumiduct_input::validate::wording;

const TEMPLATE: &str = include_str!("../templates/scene_format.md");
const STUDY_TEMPLATE: &str = include_str!("../templates/study_format.md");
const OPTIMISE_TEMPLATE: &str = include_str!("../templates/optimise.md");

/// The pages of the manual by their files, from the root of the repository.
pub(crate) fn pages() -> [(&'static str, String); 3] {
    [
        ("docs/scene_format.md", markdown()),
        ("docs/study_format.md", study_markdown()),
        ("docs/optimise.md", optimise_markdown()),
    ]
}

/// The manual page of scenes as Markdown.
fn markdown() -> String {
    TEMPLATE.replace("{{reference}}", reference(&schema::json_schema()).trim_end())
}

/// The manual page of studies as Markdown.
fn study_markdown() -> String {
    STUDY_TEMPLATE.replace("{{reference}}", reference(&schema::study_schema()).trim_end())
}

/// The manual page of optimisations as Markdown.
fn optimise_markdown() -> String {
    OPTIMISE_TEMPLATE.replace("{{reference}}", reference(&schema::optimisation_schema()).trim_end())
}

/// All tables with their keys: first those at the top level of a file, then those that several
/// share.
fn reference(schema: &Json) -> String {
    let mut manual =
        Manual { schema, text: String::new(), wanted: Vec::new(), written: BTreeSet::new() };
    manual.text += "## Top of the file\n\n";
    manual.keys(schema, &[]);
    let is_there = |name: &&str| schema["$defs"].get(*name).is_some();
    for name in FAMILIES.iter().map(|(name, _)| *name).filter(is_there) {
        manual.section(name);
    }
    manual.text += "## Shared tables\n\n";
    // Writing a section may request further ones.
    let mut next = 0;
    while let Some(name) = manual.wanted.get(next).cloned() {
        manual.section(&name);
        next += 1;
    }
    manual.text
}

/// Tables at the top of a file, and their headings.
const FAMILIES: [(&str, &str); 18] = [
    ("Optimise", "optimise"),
    ("OptimisationRun", "run of an optimisation"),
    ("Parameter", "parameters.NAME"),
    ("Plan", "plan"),
    ("StudyRun", "run of a study"),
    ("Ranking", "ranking"),
    ("Project", "project"),
    ("Medium", "media.NAME"),
    ("Finish", "finishes.NAME"),
    ("Solid", "solids.NAME"),
    ("Sheet", "sheets.NAME"),
    ("Pattern", "patterns.NAME"),
    ("Relief", "reliefs.NAME"),
    ("Emission", "emissions.NAME"),
    ("Source", "sources.NAME"),
    ("Sensor", "sensors.NAME"),
    ("Run", "run"),
    ("Check", "check"),
];

struct Manual<'a> {
    schema: &'a Json,
    text: String,
    /// Definitions referred to, in this order.
    wanted: Vec<String>,
    written: BTreeSet<String>,
}

impl Manual<'_> {
    fn section(&mut self, name: &str) {
        if !self.written.insert(name.to_owned()) {
            return;
        }
        let definition = &self.schema["$defs"][name];
        let (level, title) = match (is_family(name), title(name)) {
            (true, title) => ("##", format!("`{title}`")),
            (false, title) => ("###", title),
        };
        _ = write!(self.text, "{level} {title}\n\n{}\n\n", description(definition));
        if schema::choices(self.schema, definition).is_empty() {
            self.keys(definition, &[]);
        } else {
            let kinds = match title.strip_suffix('`') {
                Some(table) => format!("{level}# {table}."),
                None => format!("{level}# {title} `"),
            };
            self.choices(definition, &kinds);
        }
    }

    /// The alternatives of a choice: words as a list, tables with their keys.
    fn choices(&mut self, definition: &Json, heading: &str) {
        let options = options(definition);
        let shared = shared_keys(self.schema, &options);
        if let Some(Shared { names, table, apart }) = &shared {
            let apart = apart.iter().map(|kind| format!("`{kind}`")).collect::<Vec<_>>();
            let but =
                if apart.is_empty() { String::new() } else { format!(" but {}", apart.join(", ")) };
            _ = write!(self.text, "Keys of every kind{but}:\n\n");
            self.rows(table, |name| names.contains(&name));
            self.rule(table);
        }
        for option in options {
            match kind_of(option) {
                Some((kind, value)) => {
                    let shared = shared.as_ref().filter(|shared| !shared.apart.contains(&kind));
                    let names = shared.map_or(&[][..], |shared| &shared.names);
                    self.kind(kind, value, description(option), names, heading);
                }
                None => self.option(option, schema::resolve(self.schema, option)),
            }
        }
        self.end_list();
    }

    fn kind(&mut self, kind: &str, value: &Json, words: &str, shared: &[&str], heading: &str) {
        let table = schema::resolve(self.schema, value);
        if table["type"] != "object" {
            let value = self.type_of(kind, value);
            let range = range_of(table);
            let range = if range.is_empty() { range } else { format!(", {range}") };
            _ = writeln!(self.text, "- `{kind}`: {value}{range}. {words}");
            return;
        }
        self.end_list();
        _ = write!(self.text, "{heading}{kind}`\n\n{words}\n\n");
        let mut own = table["properties"].as_object().into_iter().flat_map(|keys| keys.keys());
        match table["properties"].is_object() {
            true if own.all(|key| shared.contains(&key.as_str())) => {
                self.text += "No keys of its own.\n\n";
            }
            true => self.keys(table, shared),
            false => _ = write!(self.text, "No keys: `{kind} = {{}}`.\n\n"),
        }
    }

    /// Ends a list, if the text ends in one.
    fn end_list(&mut self) {
        if !self.text.ends_with("\n\n") {
            self.text.push('\n');
        }
    }

    /// A word, any text, or a form of a table.
    fn option(&mut self, option: &Json, resolved: &Json) {
        let words = description(option);
        if let Some(word) = resolved["const"].as_str() {
            _ = writeln!(self.text, "- `\"{word}\"`: {words}");
        } else if resolved["type"] == "string" {
            _ = writeln!(self.text, "- text: {words}");
        } else if resolved["properties"].is_object() {
            self.end_list();
            _ = write!(self.text, "**{words}** {}\n\n", description(resolved));
            self.keys(resolved, &[]);
        } else {
            let plain = match resolved["type"].as_str() {
                Some("number") => "number",
                Some("array") => "list",
                Some(_) | None => "",
            };
            let link = self.link(option).unwrap_or_else(|| plain.into());
            _ = writeln!(self.text, "- {link}: {words}");
        }
    }

    /// A table of all keys except `left_out`, and the rule about them.
    fn keys(&mut self, table: &Json, left_out: &[&str]) {
        self.rows(table, |name| !left_out.contains(&name));
        if left_out.is_empty() {
            self.rule(table);
        }
    }

    fn rows(&mut self, table: &Json, is_wanted: impl Fn(&str) -> bool) {
        let properties: Vec<_> = table["properties"]
            .as_object()
            .into_iter()
            .flatten()
            .filter(|(name, _)| is_wanted(name))
            .collect();
        if properties.is_empty() {
            return;
        }
        self.text += "| key | type, unit | default | range | meaning |\n|---|---|---|---|---|\n";
        for (name, schema) in properties {
            let kind = self.type_of(name, schema);
            let is_required = table["required"]
                .as_array()
                .is_some_and(|keys| keys.iter().any(|key| key == name.as_str()));
            let default = match schema.get("default") {
                Some(default) => format!("`{}`", default_of(default)),
                None if is_required => "required".into(),
                None => "".into(),
            };
            let range = range_of(schema);
            _ = writeln!(
                self.text,
                "| `{name}` | {kind} | {default} | {range} | {} |",
                description(schema)
            );
        }
        self.text.push('\n');
    }

    fn rule(&mut self, table: &Json) {
        let (words, keys) = match schema::required_set(table) {
            Some(RequiredSet::ExactlyOne(keys)) => ("Exactly", keys),
            Some(RequiredSet::AtLeastOne(keys)) => ("At least", keys),
            None => return,
        };
        _ = write!(
            self.text,
            "{words} one of {} is required.\n\n",
            wording::list(keys.into_iter())
        );
    }

    /// Type and unit of a key.
    fn type_of(&mut self, key: &str, schema: &Json) -> String {
        if let Some(link) = self.link(schema) {
            return link;
        }
        let unit = schema::unit(key).map(|unit| format!(", {unit}")).unwrap_or_default();
        match schema["type"].as_str() {
            Some("number") => format!("number{unit}"),
            Some("integer") => format!("integer{unit}"),
            Some("string") => "text".into(),
            Some("boolean") => "true or false".into(),
            Some("array") => match self.link(&schema["items"]) {
                Some(link) => {
                    let limits = wording::limits_of_length(schema, "item");
                    let limits = limits.map(|limits| format!(", {limits}")).unwrap_or_default();
                    format!("array of {link}{limits}")
                }
                None => format!("array of {}{unit}", wording::length(schema, None)),
            },
            Some(_) | None => match self.link(&schema["additionalProperties"]) {
                Some(link) => format!("tables by name, each {link}"),
                None => "table".into(),
            },
        }
    }

    fn link(&mut self, schema: &Json) -> Option<String> {
        let name = schema["$ref"].as_str()?.rsplit('/').next()?;
        if !is_family(name) {
            self.wanted.push(name.to_owned());
        }
        let title = title(name);
        let words = if is_family(name) { format!("`{title}`") } else { title.to_lowercase() };
        Some(format!("[{words}](#{})", anchor(&title)))
    }
}

fn is_family(name: &str) -> bool {
    FAMILIES.iter().any(|(family, _)| *family == name)
}
