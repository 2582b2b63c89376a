//! The JSON Schemas that editors use to check files during editing.
//!
//! A scene is validated after its sensor files have been merged into it. An editor sees one file at
//! a time: a sensor with a `file` has some of its keys there, so no key is required here, nor in a
//! sensor file.

use serde_json::{Map, Value, json};

use crate::schema::{is_required_only, json_schema, resolve};

/// The name of the definition of a sensor in [`json_schema`], and of one with some keys in another
/// file.
const SENSOR: &str = "Sensor";
const PARTIAL_SENSOR: &str = "PartialSensor";

/// The JSON Schema (draft 2020-12) of a scene file as it is on disk.
pub fn scene_file_schema() -> Value {
    let mut schema = json_schema();
    let partial = without_required_keys(&schema, &schema["$defs"][SENSOR]);
    schema["properties"]["sensors"]["additionalProperties"] = json!({
        "if": { "required": ["file"] },
        "then": { "$ref": format!("#/$defs/{PARTIAL_SENSOR}") },
        "else": { "$ref": format!("#/$defs/{SENSOR}") },
    });
    schema["$defs"][PARTIAL_SENSOR] = partial;
    schema
}

/// The JSON Schema (draft 2020-12) of a sensor file: the keys of a sensor except `file`, none
/// required.
pub fn sensor_file_schema() -> Value {
    let schema = json_schema();
    let mut sensor = without_required_keys(&schema, &schema["$defs"][SENSOR]);
    if let Some(Value::Object(keys)) = sensor.get_mut("properties") {
        keys.shift_remove("file");
    }
    let mut file = Map::new();
    file.insert("$schema".into(), schema["$schema"].clone());
    file.insert("title".into(), "Lumiduct sensor".into());
    if let Value::Object(words) = sensor {
        file.extend(words);
    }
    let description = "The keys of a sensor for scenes to include with `file`; keys in the scene take precedence.";
    file.insert("description".into(), description.into());
    Value::Object(file)
}

/// A schema with its definitions inlined and without its rules about required keys. The sensor
/// types are not recursive.
fn without_required_keys(root: &Value, schema: &Value) -> Value {
    let is_rule = |word: &str, rule: &Value| {
        word == "required"
            || matches!(word, "oneOf" | "anyOf")
                && rule.as_array().is_some_and(|options| options.iter().all(is_required_only))
    };
    match resolve(root, schema) {
        Value::Object(words) => {
            // A reference may have its own description.
            let own = schema.as_object().into_iter().flatten().filter(|(word, _)| *word != "$ref");
            let all = words.iter().chain(own).filter(|(word, rule)| !is_rule(word, rule));
            Value::Object(
                all.map(|(word, inner)| (word.clone(), without_required_keys(root, inner)))
                    .collect(),
            )
        }
        Value::Array(items) => items.iter().map(|item| without_required_keys(root, item)).collect(),
        plain => plain.clone(),
    }
}
