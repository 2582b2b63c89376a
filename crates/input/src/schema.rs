//! The JSON Schemas of scene files and study files, made from the spec types.
//!
//! The same schema validates files (`validate` of this crate) and makes the manual pages (`manual` of `xtask`), so that
//! types, validation and manual cannot disagree.

use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde_json::{Map, Value, json};

use crate::spec::SceneSpec;
use crate::spec::optimise::OptimisationSpec;
use crate::spec::study::StudySpec;

/// The JSON Schema (draft 2020-12) of a scene merged with its sensor files. Every table is closed:
/// a key that is not listed is an error.
pub fn json_schema() -> Value {
    schema_of::<SceneSpec>()
}

/// The JSON Schema (draft 2020-12) of a study file, closed likewise.
pub fn study_schema() -> Value {
    schema_of::<StudySpec>()
}

/// The JSON Schema (draft 2020-12) of a study file with a table `optimise`, closed likewise.
pub fn optimisation_schema() -> Value {
    schema_of::<OptimisationSpec>()
}

fn schema_of<T: JsonSchema>() -> Value {
    let settings = SchemaSettings::draft2020_12();
    let mut schema = settings.into_generator().into_root_schema_for::<T>().to_value();
    let names = short_names(&schema);
    if let Some(Value::Object(definitions)) = schema.get_mut("$defs") {
        *definitions = std::mem::take(definitions)
            .into_iter()
            .map(|(name, definition)| {
                (names.get(&name).and_then(Value::as_str).unwrap_or(&name).to_owned(), definition)
            })
            .collect();
    }
    tidy(&mut schema, &names);
    schema
}

/// Names of the definitions without the suffix that they have as types.
fn short_names(schema: &Value) -> Map<String, Value> {
    let definitions = schema["$defs"].as_object();
    definitions
        .into_iter()
        .flatten()
        .map(|(name, _)| (name.clone(), short_name(name).into()))
        .collect()
}

/// `SweepSpecSolid` is `SweepSolid`, but `SpecularSpec` is `Specular`.
fn short_name(name: &str) -> String {
    let mut parts = name.split("Spec");
    let mut short = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        if part.starts_with(char::is_lowercase) {
            short.push_str("Spec");
        }
        short.push_str(part);
    }
    short
}

/// Closes tables, removes null (which TOML does not have), gives integers their range, and unwraps
/// text.
fn tidy(schema: &mut Value, names: &Map<String, Value>) {
    match schema {
        Value::Object(object) => {
            unwrap_option(object);
            if let Some(Value::Array(types)) = object.get_mut("type") {
                types.retain(|name| name != "null");
                if let [only] = types.as_slice() {
                    object["type"] = only.clone();
                }
            }
            tidy_keywords(object, names);
            for (_, inner) in object.iter_mut() {
                tidy(inner, names);
            }
        }
        Value::Array(items) => items.iter_mut().for_each(|item| tidy(item, names)),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
    }
}

/// `anyOf: [X, null]` becomes X.
fn unwrap_option(object: &mut Map<String, Value>) {
    let Some(Value::Array(choices)) = object.get("anyOf") else { return };
    if let [Value::Object(some), none] = choices.as_slice()
        && *none == json!({ "type": "null" })
    {
        let some = some.clone();
        object.remove("anyOf");
        for (key, value) in some {
            object.entry(key).or_insert(value);
        }
    }
}

fn tidy_keywords(object: &mut Map<String, Value>, names: &Map<String, Value>) {
    if object.contains_key("properties") && object.get("type") == Some(&json!("object"))
        || is_empty_table(object)
    {
        object.insert("additionalProperties".into(), false.into());
    }
    if let Some(Value::String(text)) = object.get_mut("description") {
        *text = text.replace('\n', " ");
    }
    if let Some(Value::String(reference)) = object.get_mut("$ref")
        && let Some(short) =
            reference.strip_prefix(DEFINITIONS).and_then(|name| names.get(name)?.as_str())
    {
        *reference = format!("{DEFINITIONS}{short}");
    }
    let is_empty =
        |value: &Value| value.as_object().is_some() || value.as_array().is_some_and(Vec::is_empty);
    if object.get("default").is_some_and(is_empty) {
        object.remove("default");
    }
    match object.get("format").and_then(Value::as_str) {
        Some("uint32") => {
            object.entry("maximum").or_insert(u32::MAX.into());
        }
        Some("int32") => {
            object.entry("minimum").or_insert(i32::MIN.into());
            object.entry("maximum").or_insert(i32::MAX.into());
        }
        Some(_) | None => {}
    }
    if object.get("format").is_some_and(Value::is_string) {
        object.remove("format");
    }
}

fn is_empty_table(object: &Map<String, Value>) -> bool {
    object.get("type") == Some(&json!("object")) && !object.contains_key("additionalProperties")
}

const DEFINITIONS: &str = "#/$defs/";

/// The schema that a `$ref` names, or the schema itself.
pub fn resolve<'a>(root: &'a Value, schema: &'a Value) -> &'a Value {
    let mut schema = schema;
    // A chain of references is as long as the types nest; references alone form no loop.
    for _ in 0..16 {
        match schema
            .get("$ref")
            .and_then(Value::as_str)
            .and_then(|name| name.strip_prefix(DEFINITIONS))
        {
            Some(name) => schema = &root["$defs"][name],
            None => break,
        }
    }
    schema
}

/// Whether a schema accepts any value.
pub(crate) fn takes_anything(schema: &Value) -> bool {
    match schema {
        Value::Bool(takes) => *takes,
        Value::Object(words) => words.keys().all(|word| word == "description"),
        Value::Null | Value::Number(_) | Value::String(_) | Value::Array(_) => false,
    }
}

/// One alternative for a value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Choice<'a> {
    /// This word.
    Word(&'a str, &'a Value),
    /// Any text.
    Text,
    /// A number or an array, by its schema.
    Plain(&'a Value),
    /// A table whose only key is this, with what the key takes.
    Kind(&'a str, &'a Value),
    /// A table with these properties, identified by a key that only it requires.
    Form(&'a Value),
}

/// The alternatives for a value; empty if there is no choice.
pub fn choices<'a>(root: &'a Value, schema: &'a Value) -> Vec<Choice<'a>> {
    let schema = resolve(root, schema);
    let options = ["oneOf", "anyOf"].iter().find_map(|word| schema.get(word)?.as_array());
    // Alternatives that only say which keys are required are a rule of one table, see `required_sets`.
    let options = options.filter(|options| !options.iter().all(is_required_only));
    let mut found = Vec::new();
    for option in options.into_iter().flatten() {
        let inner = choices(root, option);
        if inner.is_empty() {
            found.push(single_choice(option, resolve(root, option)));
        } else {
            found.extend(inner);
        }
    }
    found
}

fn single_choice<'a>(option: &'a Value, resolved: &'a Value) -> Choice<'a> {
    if let Some(word) = resolved.get("const").and_then(Value::as_str) {
        return Choice::Word(word, option);
    }
    if resolved.get("type").and_then(Value::as_str) == Some("string") {
        return Choice::Text;
    }
    if matches!(resolved.get("type").and_then(Value::as_str), Some("number" | "integer" | "array"))
    {
        return Choice::Plain(resolved);
    }
    let properties = resolved.get("properties").and_then(Value::as_object);
    let only = properties.filter(|keys| keys.len() == 1).and_then(|keys| keys.iter().next());
    // Kinds are inlined, forms are separate types.
    match only.filter(|_| option.get("$ref").is_none()) {
        Some((kind, inner)) => Choice::Kind(kind, inner),
        None => Choice::Form(resolved),
    }
}

/// How many of several keys a table must have.
#[derive(Debug, Clone, PartialEq)]
pub enum RequiredSet<'a> {
    /// Exactly one of these.
    ExactlyOne(Vec<&'a str>),
    /// One or more of these.
    AtLeastOne(Vec<&'a str>),
}

/// The rule of a table about how many of several keys it must have.
pub fn required_set(schema: &Value) -> Option<RequiredSet<'_>> {
    let keys = |word: &str| -> Option<Vec<&str>> {
        let options = schema.get(word)?.as_array()?;
        options
            .iter()
            .map(|option| is_required_only(option).then(|| option["required"][0].as_str())?)
            .collect()
    };
    keys("oneOf")
        .map(RequiredSet::ExactlyOne)
        .or_else(|| keys("anyOf").map(RequiredSet::AtLeastOne))
}

/// The required key that shows which form a table has: no other form requires it.
pub(crate) fn marker<'a>(form: &'a Value, forms: &[&Value]) -> Option<&'a str> {
    let requires = |form: &Value, name: &str| {
        form["required"].as_array().is_some_and(|keys| keys.iter().any(|key| key == name))
    };
    let keys = form["required"].as_array().into_iter().flatten().filter_map(Value::as_str);
    keys.into_iter().find(|name| {
        !forms.iter().any(|other| !std::ptr::eq(*other, form) && requires(other, name))
    })
}

/// Whether a schema only says which keys are required.
pub(crate) fn is_required_only(option: &Value) -> bool {
    option.as_object().is_some_and(|option| option.len() == 1 && option.contains_key("required"))
}

/// The unit of a key, by the suffix of its name.
pub fn unit(key: &str) -> Option<&'static str> {
    UNITS.iter().find(|(ending, _)| key.ends_with(ending)).map(|(_, unit)| *unit)
}

/// Suffixes of keys and their meaning; the longer of two that fit comes first.
const UNITS: [(&str, &str); 13] = [
    ("_cd_m2", "cd/m²"),
    ("per_mm", "1/mm"),
    ("_mm", "mm"),
    ("_deg", "degrees"),
    ("_lm", "lm"),
    ("_lx", "lx"),
    ("_h", "hours"),
    ("_w", "W"),
    ("_cd", "cd"),
    ("_mcd", "mcd"),
    ("_nm", "nm"),
    ("_k", "K"),
    ("_s", "s"),
];

#[cfg(test)]
mod tests {
    use super::*;

    fn walk(value: &Value, visit: &mut impl FnMut(&Map<String, Value>)) {
        match value {
            Value::Object(object) => {
                visit(object);
                object.values().for_each(|inner| walk(inner, visit));
            }
            Value::Array(items) => items.iter().for_each(|item| walk(item, visit)),
            Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
        }
    }

    #[test]
    fn every_table_is_closed_and_every_reference_leads_somewhere() {
        let schema = json_schema();
        let mut references = 0;
        walk(&schema, &mut |object| {
            if object.get("type") == Some(&json!("object")) {
                assert!(object.contains_key("additionalProperties"), "{object:?}");
            }
            if let Some(name) = object.get("$ref").and_then(Value::as_str) {
                references += 1;
                assert!(
                    schema["$defs"].get(name.trim_start_matches(DEFINITIONS)).is_some(),
                    "{name}"
                );
            }
            assert_ne!(object.get("type"), Some(&json!("null")));
        });
        assert!(references > 100);
    }

    #[test]
    fn every_key_has_a_description_and_every_number_a_unit_or_a_known_meaning() {
        let pure = "lumiduct index powers cauchy sellmeier share reflectance transmittance n k weight \
            end_scale sides axis x_axis up north cie_type rounded_share roughness anisotropy quantum_yield a b \
            g b0 l s power count priority cells pixels lamps rings sectors cosine_power paths \
            batches planned_paths seed bounce_limit depth records max_rays photons relative_error \
            min max equals within sigmas max_std_error";
        let pure: Vec<&str> = pure.split_whitespace().collect();
        walk(&json_schema(), &mut |object| {
            let Some(Value::Object(properties)) = object.get("properties") else { return };
            for (key, schema) in properties {
                let is_kind = properties.len() == 1 && object.contains_key("description");
                assert!(is_kind || schema.get("description").is_some(), "{key} has no description");
                let kind = schema["type"].as_str().unwrap_or_default();
                let is_number = |kind: &Value| kind == "number" || kind == "integer";
                if is_number(&kind.into()) || is_number(&schema["items"]["type"]) {
                    assert!(
                        unit(key).is_some() || pure.contains(&key.as_str()),
                        "{key} has no unit"
                    );
                }
            }
        });
    }

    #[test]
    fn kinds_words_and_forms_are_told_apart() {
        let schema = json_schema();
        let of = |name: &str| choices(&schema, &schema["$defs"][name]);
        assert!(matches!(of("Solid")[0], Choice::Kind("sweep", _)));
        assert!(matches!(of("Emission")[0], Choice::Word("lambertian", _)));
        assert!(matches!(of("Emission")[3], Choice::Kind("cosine_power", _)));
        assert!(matches!(of("Leg")[..], [Choice::Form(_), Choice::Form(_), Choice::Form(_)]));
        assert_eq!(of("Body")[2], Choice::Text);
        assert!(of("Circle").is_empty() && of("Check").is_empty());
        assert!(
            matches!(required_set(&schema["$defs"]["Check"]), Some(RequiredSet::AtLeastOne(keys)) if keys.len() == 3)
        );
    }
}
