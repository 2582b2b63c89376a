//! Wording of the schema and the values of a file.

use serde_json::Value as Json;

use crate::schema::{self, Choice};
use crate::texts::Texts;
use crate::tree::{Node, Value};

/// What a schema expects, with the unit of its numbers: "a number in mm, above 0".
pub(crate) fn expected(root: &Json, schema: &Json, unit: Option<&str>) -> String {
    let choices = schema::choices(root, schema);
    if !choices.is_empty() {
        return one_of(root, &choices, unit);
    }
    let number = |noun: &str| {
        let unit = unit.map(|unit| format!(" in {unit}")).unwrap_or_default();
        let range = range(schema).map(|range| format!(", {range}")).unwrap_or_default();
        format!("{noun}{unit}{range}")
    };
    match schema["type"].as_str() {
        Some("number") => number("a number"),
        Some("integer") => number("an integer"),
        Some("string") => "text in quotes".into(),
        Some("boolean") => "true or false".into(),
        Some("array") => format!("an array of {}", length(schema, unit)),
        Some(_) | None => "a table".into(),
    }
}

/// The alternatives of a choice.
fn one_of(root: &Json, choices: &[Choice<'_>], unit: Option<&str>) -> String {
    let mut parts = Vec::new();
    for choice in choices {
        match choice {
            Choice::Word(word, _) => parts.push(format!("\"{word}\"")),
            Choice::Text => parts.push("a name in quotes".into()),
            Choice::Plain(schema) => parts.push(expected(root, schema, unit)),
            Choice::Kind(..) | Choice::Form(_) => {}
        }
    }
    let kinds = list(choices.iter().filter_map(|choice| match choice {
        Choice::Kind(kind, _) => Some(*kind),
        Choice::Word(..) | Choice::Text | Choice::Plain(_) | Choice::Form(_) => None,
    }));
    if !kinds.is_empty() {
        parts.push(format!("a table with one of {kinds}"));
    } else if choices.iter().any(|choice| matches!(choice, Choice::Form(_))) {
        parts.push("a table".into());
    }
    match parts.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, rest)) => format!("{} or {last}", rest.join(", ")),
        None => "nothing".into(),
    }
}

/// The range of a number: "1 to 4", "above 0", "above 0, at most 90"; `None` without limits.
pub fn range(schema: &Json) -> Option<String> {
    let limit = |word: &str| schema.get(word).filter(|limit| limit.is_number()).map(short);
    let low = limit("minimum").map(|min| (format!("at least {min}"), min));
    let high = limit("maximum").map(|max| (format!("at most {max}"), max));
    let above = limit("exclusiveMinimum").map(|min| format!("above {min}"));
    let below = limit("exclusiveMaximum").map(|max| format!("below {max}"));
    if let (Some((_, min)), Some((_, max))) = (&low, &high) {
        return Some(format!("{min} to {max}"));
    }
    let parts: Vec<_> = above
        .or(low.map(|(words, _)| words))
        .into_iter()
        .chain(below.or(high.map(|(words, _)| words)))
        .collect();
    (!parts.is_empty()).then(|| parts.join(", "))
}

/// A number without a redundant ".0".
pub fn short(limit: &Json) -> String {
    limit
        .as_i64()
        .map(|limit| limit.to_string())
        .or_else(|| Some(limit.as_f64()?.to_string()))
        .unwrap_or_default()
}

/// How many entries an array has and what they are: "3 numbers in mm", "at least 1 table".
pub fn length(schema: &Json, unit: Option<&str>) -> String {
    let noun = match schema["items"]["type"].as_str() {
        Some("number") => "number",
        Some("integer") => "integer",
        Some("string") => "text",
        Some("array") if schema["items"]["maxItems"] == 2 => "pair",
        Some("array") => "array",
        Some(_) | None => "table",
    };
    let unit = unit.map(|unit| format!(" in {unit}")).unwrap_or_default();
    let limits = limits_of_length(schema, noun).unwrap_or_else(|| format!("{noun}s"));
    limits + &unit
}

/// How many entries an array may have, if that is limited: "1 to 200 tables".
pub fn limits_of_length(schema: &Json, noun: &str) -> Option<String> {
    let plural = |count: u64| if count == 1 { "" } else { "s" };
    match (schema["minItems"].as_u64(), schema["maxItems"].as_u64()) {
        (Some(min), Some(max)) if min == max => Some(format!("{min} {noun}{}", plural(max))),
        (Some(min), Some(max)) => Some(format!("{min} to {max} {noun}s")),
        (Some(min), None) => Some(format!("at least {min} {noun}{}", plural(min))),
        (None, Some(max)) => Some(format!("at most {max} {noun}s")),
        (None, None) => None,
    }
}

/// The number of entries found.
pub(crate) fn count(count: usize) -> String {
    if count == 0 { "none".into() } else { count.to_string() }
}

/// The value found in a file, with its text where that is short.
pub(crate) fn found(node: &Node, sources: &Texts) -> String {
    let text = || sources.excerpt(&node.origin);
    match &node.value {
        Value::Table(_) => "a table".into(),
        Value::Array(_) => "an array".into(),
        Value::String(_) => format!("the text {}", text()),
        Value::Integer(_) => format!("the integer {}", text()),
        Value::Float(_) => format!("the number {}", text()),
        Value::Boolean(_) => text(),
        Value::Datetime => format!("the date or time {}", text()),
        Value::Unreadable => "nothing readable".into(),
    }
}

/// A list of names, each in the quotes of a key.
pub fn list<'a>(names: impl Iterator<Item = &'a str>) -> String {
    names.map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn ranges_read_as_one_would_say_them() {
        let cases = [
            (json!({ "minimum": 1.0, "maximum": 4.0 }), Some("1 to 4")),
            (json!({ "exclusiveMinimum": 0.0 }), Some("above 0")),
            (json!({ "exclusiveMinimum": 0.0, "maximum": 22.5 }), Some("above 0, at most 22.5")),
            (json!({ "minimum": 0.0, "exclusiveMaximum": 90.0 }), Some("at least 0, below 90")),
            (json!({}), None),
        ];
        for (schema, words) in cases {
            assert_eq!(range(&schema).as_deref(), words);
        }
    }

    #[test]
    fn expectations_name_the_unit_and_the_range() {
        let number = json!({ "type": "number", "exclusiveMinimum": 0.0 });
        assert_eq!(expected(&json!({}), &number, Some("mm")), "a number in mm, above 0");
        let triple =
            json!({ "type": "array", "items": { "type": "number" }, "minItems": 3, "maxItems": 3 });
        assert_eq!(expected(&json!({}), &triple, None), "an array of 3 numbers");
    }
}
