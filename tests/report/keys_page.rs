//! The guide's page of keys is that of the JSON Schema.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::{env, fs, path::Path};

use serde_json::Value;
use sortie::spec::json_schema;

const TOP: &str = "Every key of a [mission spec](crate::guide::spec), as `sortie schema` describes it to editors. \
A key with a dot is needed.\n";

/// On failure the page as it should be is in `target/keys.md`.
#[test]
fn the_page_of_keys_has_every_key_of_the_schema() {
    let schema: Value = serde_json::from_str(&json_schema()).expect("a schema");
    let page = Page::of(&schema).text();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let shipped = fs::read_to_string(root.join("src/guide/keys.md")).expect("the page of keys");
    if shipped != page {
        let made = root.join("target/keys.md");
        fs::write(&made, &page).expect("target can be written");
        panic!("src/guide/keys.md is not the page of the schema: target/keys.md is");
    }
}

#[test]
fn the_page_of_keys_says_range_default_and_need() {
    let schema = serde_json::json!({
        "description": "A spec.",
        "properties": {"vehicles": {"type": "array", "items": {"$ref": "#/$defs/Vehicle"}, "description": "In order."}},
        "required": ["vehicles"],
        "$defs": {"Vehicle": {"description": "One.", "properties": {
            "sysid": {"type": "integer", "minimum": 1, "maximum": 250, "description": "MAVLink's.", "default": 1},
            "finish": {"anyOf": [{"$ref": "#/$defs/Finish"}, {"type": "null"}], "description": "At\nthe goal."}}},
            "Finish": {"enum": ["land", "loiter"], "type": "string"}}
    });
    let text = Page::of(&schema).text();
    assert!(
        text.contains("| • `vehicles` | list of [vehicle](#vehicle) | In order. |"),
        "{text}"
    );
    assert!(
        text.contains("| `sysid` | integer, 1 to 250; default 1 | MAVLink's. |"),
        "{text}"
    );
    assert!(
        text.contains("| `finish` | `land`, `loiter` | At the goal. |"),
        "{text}"
    );
    assert!(
        text.contains("# Vehicle\n\nOne. In `vehicles`.\n"),
        "{text}"
    );
}

struct Page<'a> {
    definitions: &'a Value,
    /// Names of definitions in the order in which they are met, and the keys that lead there.
    order: Vec<&'a str>,
    used_in: BTreeMap<&'a str, Vec<String>>,
    root: &'a Value,
}

impl<'a> Page<'a> {
    fn of(schema: &'a Value) -> Self {
        let mut page = Self {
            definitions: &schema["$defs"],
            order: Vec::new(),
            used_in: BTreeMap::new(),
            root: schema,
        };
        page.meet(schema);
        page
    }

    fn meet(&mut self, object: &'a Value) {
        let mut new = Vec::new();
        for (key, value) in properties(object) {
            let Some(name) = referred(value) else {
                continue;
            };
            if self.words(name).is_some() {
                continue;
            }
            let used_in = self.used_in.entry(name).or_default();
            if !used_in.contains(key) {
                used_in.push(key.clone());
            }
            if !self.order.contains(&name) {
                self.order.push(name);
                new.push(name);
            }
        }
        for name in new {
            self.meet(&self.definitions[name]);
        }
    }

    fn words(&self, name: &str) -> Option<String> {
        let words = self.definitions[name]["enum"].as_array()?;
        let words = words.iter().filter_map(Value::as_str);
        Some(
            words
                .map(|word| format!("`{word}`"))
                .collect::<Vec<_>>()
                .join(", "),
        )
    }

    fn text(&self) -> String {
        let mut text = TOP.to_owned();
        self.table(&mut text, self.root);
        for name in &self.order {
            let definition = &self.definitions[*name];
            let keys = &self.used_in[name];
            let keys: Vec<String> = keys.iter().map(|key| format!("`{key}`")).collect();
            let about = sentence(&definition["description"]);
            let about = if about.is_empty() { about } else { about + " " };
            let keys = keys.join(", ");
            write!(text, "\n# {}\n\n{about}In {keys}.\n", title(name)).expect("memory");
            self.table(&mut text, definition);
        }
        text
    }

    fn table(&self, text: &mut String, object: &Value) {
        text.push_str("\n| key | value | meaning |\n|---|---|---|\n");
        let needed: Vec<&str> = match object["required"].as_array() {
            Some(needed) => needed.iter().filter_map(Value::as_str).collect(),
            None => Vec::new(),
        };
        for (key, value) in properties(object) {
            let dot = if needed.contains(&key.as_str()) {
                "• "
            } else {
                ""
            };
            let default = match &value["default"] {
                Value::Number(number) => format!("; default {number}"),
                Value::Bool(yes) => format!("; default {yes}"),
                Value::String(word) => format!("; default `{word}`"),
                _ => String::new(),
            };
            let kind = self.kind(value);
            let meaning = sentence(&value["description"]);
            writeln!(text, "| {dot}`{key}` | {kind}{default} | {meaning} |").expect("memory");
        }
    }

    /// What a value may be.
    fn kind(&self, value: &Value) -> String {
        if value["items"].is_object() {
            return format!("list of {}", self.kind(&value["items"]));
        }
        if let Some(name) = referred(value) {
            return self.words(name).unwrap_or_else(|| {
                let title = title(name);
                let anchor = title.to_lowercase().replace(' ', "-");
                format!("[{}](#{anchor})", title.to_lowercase())
            });
        }
        if value["properties"].is_object() {
            return "keys of a [vehicle](#vehicle)".to_owned();
        }
        let name = match &value["type"] {
            Value::Array(types) => types[0].as_str(),
            name => name.as_str(),
        };
        let name = match name {
            Some("string") => "text",
            Some("boolean") => "`true`, `false`",
            Some(other) => other,
            None => "value",
        };
        match (value["minimum"].as_f64(), value["maximum"].as_f64()) {
            (Some(least), Some(most)) => format!("{name}, {least} to {most}"),
            (Some(least), None) => format!("{name}, at least {least}"),
            _ => name.to_owned(),
        }
    }
}

fn properties(object: &Value) -> impl Iterator<Item = (&String, &Value)> {
    object["properties"].as_object().into_iter().flatten()
}

/// The definition that a value, an optional value or the items of a list are of. A part of a
/// definition, for defaults, has its keys.
fn referred(value: &Value) -> Option<&str> {
    let value = if value["items"].is_object() {
        &value["items"]
    } else {
        value
    };
    let first = value["anyOf"]
        .as_array()
        .and_then(|all| all.first())
        .unwrap_or(value);
    let name = first["$ref"].as_str()?.rsplit('/').next()?;
    Some(name.strip_prefix("PartOf").unwrap_or(name))
}

/// A description on one line of a table.
fn sentence(description: &Value) -> String {
    let text = description.as_str().unwrap_or("");
    text.replace('\n', " ").replace('|', "\\|")
}

/// `SurveyArea` as "Survey area".
fn title(name: &str) -> String {
    let mut title = String::new();
    for (at, letter) in name.char_indices() {
        if at > 0 && letter.is_uppercase() {
            title.push(' ');
            title.extend(letter.to_lowercase());
        } else {
            title.push(letter);
        }
    }
    title
}
