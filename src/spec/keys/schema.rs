//! What is at a path of a JSON Schema, and what it allows there.

use std::sync::OnceLock;

use serde_json::Value as Schema;

/// The JSON Schema of a mission spec.
pub(in crate::spec) fn of_spec() -> &'static Schema {
    static SCHEMA: OnceLock<Schema> = OnceLock::new();
    SCHEMA.get_or_init(|| schemars::schema_for!(super::Spec).to_value())
}

/// Follows the `$ref` of a schema, also inside `anyOf` with `null`; otherwise the schema itself.
pub(in crate::spec) fn resolved<'s>(schema: &'s Schema, root: &'s Schema) -> &'s Schema {
    let target = schema.pointer("/anyOf/0/$ref").or(schema.get("$ref"));
    let path = target.and_then(|target| target.as_str()?.strip_prefix('#'));
    path.and_then(|path| root.pointer(path)).unwrap_or(schema)
}

/// The keys and indices, with their `[`, of a path.
pub(in crate::spec) fn steps(path: &str) -> impl Iterator<Item = &str> {
    let keys = path.split('.').filter(|key| !key.is_empty());
    keys.flat_map(|key| {
        let (key, indices) = key.split_at(key.find('[').unwrap_or(key.len()));
        let indices = indices.split_inclusive(']');
        std::iter::once(key)
            .filter(|key| !key.is_empty())
            .chain(indices)
    })
}

/// The index of a step such as `[3]`.
pub(in crate::spec) fn index_of(step: &str) -> Option<usize> {
    step.strip_prefix('[')?.strip_suffix(']')?.parse().ok()
}

/// The schema of the value at a path; null where the schema has no such path.
pub(in crate::spec) fn at<'s>(root: &'s Schema, path: &str) -> &'s Schema {
    steps(path).fold(root, |schema, step| {
        let next = match index_of(step) {
            Some(_) => &schema["items"],
            None => &schema["properties"][step],
        };
        resolved(next, root)
    })
}

/// What a schema allows at a path, in the words of a message; empty where it does not say it.
pub(in crate::spec) fn allowed_at(root: &Schema, path: &str) -> String {
    allowed(at(root, path))
}

/// What a schema allows.
fn allowed(schema: &Schema) -> String {
    let words = |list: &Schema| -> Vec<String> {
        let words = list.as_array().into_iter().flatten();
        let words = words.filter_map(Schema::as_str);
        words.map(|word| format!("`{word}`")).collect()
    };
    let choice = words(&schema["enum"]);
    let range = (schema["minimum"].as_f64()).zip(schema["maximum"].as_f64());
    // Of a key that may be absent it is a list: a type, or null.
    let kind = &schema["type"];
    match (kind.as_str().or_else(|| kind[0].as_str()), range) {
        _ if !choice.is_empty() => one_of(&choice),
        (Some("integer"), Some((least, most))) if (most - least - 1.0).abs() < 0.5 => {
            format!("{least} or {most}")
        }
        (Some("integer" | "number"), Some((least, most))) if least < most => {
            format!("{least} to {most}")
        }
        (Some("integer" | "number"), Some((least, _))) => least.to_string(),
        (Some("integer"), None) => "a whole number".to_owned(),
        (Some("number"), None) => "a number".to_owned(),
        (Some("boolean"), _) => "true or false".to_owned(),
        (Some("string"), _) => match (&schema["minLength"], &schema["maxLength"]) {
            (Schema::Number(least), Schema::Number(most)) => {
                format!("text of {least} to {most} characters")
            }
            _ => "text".to_owned(),
        },
        (Some("array"), _) => match schema["minItems"].as_u64() {
            Some(least) if least > 1 => format!("a list of at least {least} entries"),
            _ => "a list".to_owned(),
        },
        (Some("object"), _) => {
            let keys = schema["properties"].as_object().into_iter().flatten();
            let keys: Vec<String> = keys.map(|(key, _)| format!("`{key}`")).collect();
            let required = words(&schema["required"]);
            match schema["maxProperties"].as_u64() {
                Some(1) => format!("{}, with its values", one_of(&keys)),
                _ if required.is_empty() => "keys with values".to_owned(),
                _ => format!("keys with values: {}", required.join(", ")),
            }
        }
        _ => String::new(),
    }
}

/// Words as the parser lists them.
fn one_of(words: &[String]) -> String {
    match words {
        [one] => one.clone(),
        [one, two] => format!("{one} or {two}"),
        _ => format!("one of {}", words.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_needed_key_says_what_is_allowed() {
        let root = of_spec();
        let definitions = root["$defs"].as_object().expect("definitions");
        let mut found = 0;
        for (name, of) in definitions.iter().chain([(&String::new(), root)]) {
            for key in of["required"].as_array().into_iter().flatten() {
                let key = key.as_str().expect("a word");
                let schema = resolved(&of["properties"][key], root);
                assert!(!allowed(schema).is_empty(), "{name}.{key}: {schema}");
                found += 1;
            }
        }
        assert!(found > 70, "{found}");
        assert_eq!(allowed(at(root, "sortie")), "1 or 2");
        assert_eq!(allowed(at(root, "vehicles[3].start.lat")), "-90 to 90");
        assert_eq!(
            allowed(at(root, "terrain")),
            "one of `analytic`, `file`, `flat`, `folder`, with its values"
        );
        assert_eq!(
            allowed(at(root, "tasks[0].survey.polygon")),
            "a list of at least 3 entries"
        );
        assert_eq!(allowed(at(root, "no.such[0].path")), "");
    }
}
