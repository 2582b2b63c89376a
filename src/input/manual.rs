//! The manual pages of the formats of scenes and studies, made from their schemas.
//!
//! What a schema cannot say, conventions and examples, is in `docs/templates`.

use std::collections::BTreeSet;
use std::fmt::Write;

use serde_json::{Map, Value as Json};

use crate::input::schema::{self, RequiredSet};
use crate::input::validate::wording;

const TEMPLATE: &str = include_str!("../../docs/templates/scene_format.md");
const STUDY_TEMPLATE: &str = include_str!("../../docs/templates/study_format.md");

/// The manual page of scenes as Markdown.
pub fn markdown() -> String {
    TEMPLATE.replace("{{reference}}", reference(&schema::json_schema()).trim_end())
}

/// The manual page of studies as Markdown.
pub fn study_markdown() -> String {
    STUDY_TEMPLATE.replace("{{reference}}", reference(&schema::study_schema()).trim_end())
}

/// All tables with their keys: first those at the top of a file, then those that several of them share.
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
    // Sections ask for further ones while they are written.
    let mut next = 0;
    while let Some(name) = manual.wanted.get(next).cloned() {
        manual.section(&name);
        next += 1;
    }
    manual.text
}

/// Tables at the top of a file, and their headings.
const FAMILIES: [(&str, &str); 14] = [
    ("Parameter", "parameters.NAME"),
    ("Plan", "plan"),
    ("StudyRun", "run of a study"),
    ("Ranking", "ranking"),
    ("Medium", "media.NAME"),
    ("Finish", "finishes.NAME"),
    ("Solid", "solids.NAME"),
    ("Sheet", "sheets.NAME"),
    ("Pattern", "patterns.NAME"),
    ("Relief", "reliefs.NAME"),
    ("Source", "sources.NAME"),
    ("Sensor", "sensors.NAME"),
    ("Run", "run"),
    ("Check", "check"),
];

struct Manual<'a> {
    schema: &'a Json,
    text: String,
    /// Definitions that were named, in this order.
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

    /// What may stand where there is a choice: words as a list, tables with their keys.
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

    /// A table of all keys but some, and the rule about them.
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
                Some(link) => format!("array of {link}"),
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

/// Alternatives of a choice, as written.
fn options(definition: &Json) -> Vec<&Json> {
    ["oneOf", "anyOf"]
        .iter()
        .find_map(|word| definition[word].as_array())
        .into_iter()
        .flatten()
        .collect()
}

/// The kind that an alternative is, and what it takes.
fn kind_of(option: &Json) -> Option<(&str, &Json)> {
    let (kind, value) = option["properties"].as_object()?.iter().next()?;
    Some((kind, value))
}

/// Keys that kinds have in the same way.
struct Shared<'a> {
    names: Vec<&'a str>,
    /// The table of a kind that has them.
    table: &'a Json,
    /// Kinds that have none of them.
    apart: Vec<&'a str>,
}

/// Keys that all kinds have in the same way, but for kinds that have nothing in common with the first.
fn shared_keys<'a>(root: &'a Json, options: &[&'a Json]) -> Option<Shared<'a>> {
    let tables = options.iter().map(|option| {
        let (kind, value) = kind_of(option)?;
        let table = schema::resolve(root, value);
        Some((kind, table["properties"].as_object()?, table))
    });
    let tables: Option<Vec<_>> = tables.collect();
    let tables = tables?;
    let (_, first, table) = *tables.first()?;
    let is_apart =
        |keys: &Map<String, Json>| !first.iter().any(|(name, value)| keys.get(name) == Some(value));
    let (apart, alike): (Vec<_>, Vec<_>) = tables.iter().partition(|(_, keys, _)| is_apart(keys));
    let is_shared = |(name, value): &(&String, &Json)| {
        alike.iter().all(|(_, keys, _)| keys.get(*name) == Some(*value))
    };
    let names: Vec<_> = first.iter().filter(is_shared).map(|(name, _)| name.as_str()).collect();
    let apart: Vec<_> = apart.iter().map(|(kind, ..)| *kind).collect();
    (alike.len() > 1 && !names.is_empty()).then_some(Shared { names, table, apart })
}

fn description(schema: &Json) -> &str {
    schema["description"].as_str().unwrap_or_default()
}

/// A default without needless ".0".
fn default_of(default: &Json) -> String {
    match default {
        Json::Number(_) => wording::short(default),
        Json::Array(items) => {
            format!("[{}]", items.iter().map(default_of).collect::<Vec<_>>().join(", "))
        }
        Json::Null | Json::Bool(_) | Json::String(_) | Json::Object(_) => default.to_string(),
    }
}

fn range_of(schema: &Json) -> String {
    if schema["minimum"] == i32::MIN {
        return String::new();
    }
    let words = wording::range(schema).or_else(|| wording::range(&schema["items"]));
    words.unwrap_or_default()
}

/// The heading of a definition: `SpacePlacement` is "Space placement".
fn title(name: &str) -> String {
    if let Some((_, title)) = FAMILIES.iter().find(|(family, _)| *family == name) {
        return (*title).to_owned();
    }
    let mut words = String::new();
    for (i, c) in name.char_indices() {
        if i > 0 && c.is_uppercase() {
            words.push(' ');
            words.extend(c.to_lowercase());
        } else {
            words.push(c);
        }
    }
    words
}

/// The anchor that a heading gets.
fn anchor(heading: &str) -> String {
    let kept = heading.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.collect::<String>().to_lowercase().replace(' ', "-")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input;

    /// Where a page lies, what is on it, and the schema that it is made from.
    type Page = (&'static str, fn() -> String, fn() -> Json);

    /// The whole pages, from the root of the package.
    const PAGES: [Page; 2] = [
        ("docs/scene_format.md", markdown, schema::json_schema),
        ("docs/study_format.md", study_markdown, schema::study_schema),
    ];

    #[test]
    fn the_pages_in_docs_are_current() {
        for (page, markdown, _) in PAGES {
            let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(page);
            if std::env::var_os("UPDATE_GOLDEN").is_some() {
                std::fs::write(&path, markdown()).unwrap();
            }
            let found = std::fs::read_to_string(&path).unwrap();
            assert!(
                found == markdown(),
                "{page} is not current: run the tests with UPDATE_GOLDEN=1"
            );
        }
    }

    #[test]
    fn every_key_and_kind_of_the_schema_is_on_the_page() {
        for (page, schema) in PAGES.map(|(_, markdown, schema)| (markdown(), schema())) {
            for (name, definition) in schema["$defs"].as_object().unwrap() {
                let tables = options(definition).into_iter().chain([definition]);
                for key in tables
                    .filter_map(|table| table["properties"].as_object())
                    .flat_map(|keys| keys.keys())
                {
                    let is_there =
                        page.contains(&format!("`{key}`")) || page.contains(&format!(".{key}`"));
                    assert!(is_there, "{name}.{key}");
                }
            }
        }
    }

    #[test]
    fn every_link_leads_to_one_heading() {
        for page in PAGES.map(|(_, markdown, _)| markdown()) {
            let headings: Vec<_> = page
                .lines()
                .filter(|line| line.starts_with('#'))
                .map(|line| anchor(line.trim_start_matches(['#', ' '])))
                .collect();
            let links: Vec<_> =
                page.split("](#").skip(1).filter_map(|rest| rest.split(')').next()).collect();
            assert!(links.len() > 10);
            for link in links {
                assert_eq!(headings.iter().filter(|heading| *heading == link).count(), 1, "{link}");
            }
        }
    }

    #[test]
    fn the_worked_example_is_a_good_scene() {
        let example = TEMPLATE.split("```toml\n").nth(1).unwrap().split("```").next().unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("example.toml");
        std::fs::write(&path, example).unwrap();
        let loaded = input::read(&path, &[]).unwrap_or_else(|error| panic!("{error}"));
        assert!(loaded.warnings.is_empty());
    }

    #[test]
    fn the_worked_example_of_a_study_is_a_good_study() {
        let example =
            STUDY_TEMPLATE.split("```toml\n").nth(1).unwrap().split("```").next().unwrap();
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("example.toml");
        let scenes = root.join("scenes").display().to_string();
        std::fs::write(
            &path,
            example
                .replace("\"../led_indicator.toml\"", &format!("\"{scenes}/led_indicator.toml\"")),
        )
        .unwrap();
        let study = input::load_study(&path, &input::StudySettings::default());
        assert!(study.unwrap_or_else(|error| panic!("{error}")).warnings.is_empty());
    }
}
