//! Checks numbers against the ranges in the schema; a range needs both a minimum and a maximum.

use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value as Schema;
use serde_yaml::Value;

use super::Checker;
use crate::numeric::digits;
use crate::spec::keys::schema::resolved;

impl Checker {
    /// Reports each number outside its range, below each of these paths.
    pub(super) fn ranges<'k, T: Serialize + JsonSchema + 'k>(
        &mut self,
        parts: impl IntoIterator<Item = (String, &'k T)>,
    ) {
        let schema = schemars::schema_for!(T).to_value();
        for (path, keys) in parts {
            match serde_yaml::to_value(keys) {
                Ok(value) => self.range(&path, &value, &schema, &schema),
                Err(error) => self.report(&path, error, ""),
            }
        }
    }

    fn range(&mut self, path: &str, value: &Value, schema: &Schema, root: &Schema) {
        let schema = resolved(schema, root);
        match value {
            Value::Mapping(keys) => {
                for (key, value) in keys {
                    let Some(key) = key.as_str() else { continue };
                    let path = match path {
                        "" => key.to_owned(),
                        _ => format!("{path}.{key}"),
                    };
                    self.range(&path, value, &schema["properties"][key], root);
                }
            }
            Value::Sequence(values) => {
                for (index, value) in values.iter().enumerate() {
                    self.range(&format!("{path}[{index}]"), value, &schema["items"], root);
                }
            }
            Value::Number(number) => {
                let (least, most) = (schema["minimum"].as_f64(), schema["maximum"].as_f64());
                if let (Some(least), Some(most), Some(value)) = (least, most, number.as_f64())
                    && !(least..=most).contains(&value)
                {
                    let allowed = match least < most {
                        true => format!("{least} to {most}"),
                        false => least.to_string(),
                    };
                    let share = value / 100.0;
                    let is_percent = most <= 1.0 && value > 1.0 && (least..=most).contains(&share);
                    let hint = match is_percent {
                        true => format!(", a share: did you mean {}?", digits::plain(share)),
                        false => String::new(),
                    };
                    self.report(path, digits::plain(value), format!("{allowed}{hint}"));
                }
            }
            _ => {}
        }
    }
}
