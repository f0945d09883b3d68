//! The part of JSON Schema that `docs/report.schema.json` uses.

use std::sync::LazyLock;

use serde_json::Value;

static REPORT: LazyLock<Value> =
    LazyLock::new(|| serde_json::from_str(include_str!("../../docs/report.schema.json")).expect("the schema is JSON"));

/// What of a report does not follow the schema, with its path; empty if all does.
pub fn violations(report: &Value) -> Vec<String> {
    let mut found = Vec::new();
    check(&REPORT, report, "report", &mut found);
    found
}

fn check(schema: &Value, value: &Value, path: &str, found: &mut Vec<String>) {
    for (keyword, rule) in schema.as_object().expect("a schema is an object") {
        let holds = match keyword.as_str() {
            "$schema" | "$defs" | "title" | "description" | "items" | "required" | "additionalProperties" => true,
            "$ref" => {
                let pointer = rule.as_str().and_then(|name| name.strip_prefix('#')).expect("a local reference");
                check(REPORT.pointer(pointer).expect("a definition"), value, path, found);
                true
            }
            "type" => rule.as_array().map_or_else(|| is_of(rule, value), |any| any.iter().any(|one| is_of(one, value))),
            "minimum" => value.as_f64().is_none_or(|number| number >= rule.as_f64().expect("a number")),
            "const" => rule == value,
            "enum" => rule.as_array().expect("a list").contains(value),
            "anyOf" => rule.as_array().expect("a list").iter().any(|one| {
                let mut own = Vec::new();
                check(one, value, path, &mut own);
                own.is_empty()
            }),
            "properties" => {
                object(schema, value, path, found);
                true
            }
            other => panic!("the keyword {other} is not known here"),
        };
        if !holds {
            found.push(format!("{path}: {value} does not satisfy {keyword} {rule}"));
        }
    }
    for (k, item) in value.as_array().into_iter().flatten().enumerate() {
        schema.get("items").into_iter().for_each(|items| check(items, item, &format!("{path}[{k}]"), found));
    }
}

fn object(schema: &Value, value: &Value, path: &str, found: &mut Vec<String>) {
    let Some(keys) = value.as_object() else { return };
    for required in schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str) {
        if !keys.contains_key(required) {
            found.push(format!("{path}: the key {required} is missing"));
        }
    }
    for (key, value) in keys {
        match schema["properties"].get(key) {
            Some(rule) => check(rule, value, &format!("{path}.{key}"), found),
            None => found.push(format!("{path}: the key {key} is not in the schema")),
        }
    }
}

fn is_of(kind: &Value, value: &Value) -> bool {
    match kind.as_str().expect("a name") {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "integer" => value.is_u64() || value.is_i64(),
        "number" => value.is_number(),
        "null" => value.is_null(),
        other => panic!("the type {other} is not known here"),
    }
}
