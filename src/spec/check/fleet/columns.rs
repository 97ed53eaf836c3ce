//! Columns of a table of vehicles, from the schema of a vehicle.

use serde_json::Value as Schema;
use serde_yaml::{Mapping, Value};

use crate::spec::keys;
use crate::spec::keys::schema::resolved;

/// A column that a table may have.
pub(super) struct Column {
    /// The keys from the vehicle down to the value, joined by _.
    pub(super) name: String,
    keys: Vec<String>,
    kind: Kind,
}

enum Kind {
    Number,
    Whole,
    Text,
    Words(Vec<String>),
}

/// Every column that a table may have: each key of a vehicle that holds one value.
pub(super) fn columns() -> Vec<Column> {
    let schema = schemars::schema_for!(keys::Vehicle).to_value();
    let mut columns = Vec::new();
    collect(&schema, &schema, &[], &mut columns);
    columns
}

fn collect(object: &Schema, root: &Schema, above: &[String], columns: &mut Vec<Column>) {
    for (key, property) in object["properties"].as_object().into_iter().flatten() {
        let schema = resolved(property, root);
        let keys = [above, std::slice::from_ref(key)].concat();
        let types = &schema["type"];
        let kind = match types.as_str().or(types[0].as_str()) {
            Some("number") => Kind::Number,
            Some("integer") => Kind::Whole,
            Some("string") => match schema["enum"].as_array() {
                Some(words) => {
                    let words = words.iter().filter_map(Schema::as_str);
                    Kind::Words(words.map(str::to_owned).collect())
                }
                None => Kind::Text,
            },
            Some("object") => {
                collect(schema, root, &keys, columns);
                continue;
            }
            _ => continue,
        };
        let name = keys.join("_");
        columns.push(Column { name, keys, kind });
    }
}

impl Column {
    /// Puts a cell that is not empty into the keys of a vehicle.
    ///
    /// # Errors
    /// What such a cell may be.
    pub(super) fn put(&self, cell: &str, vehicle: &mut Mapping) -> Result<(), String> {
        let value = self.value(cell)?;
        let Some((last, above)) = self.keys.split_last() else {
            return Ok(());
        };
        let mut within = vehicle;
        for key in above {
            let inner = within.entry(Value::from(key.as_str()));
            let inner = inner.or_insert_with(|| Mapping::new().into());
            let Value::Mapping(inner) = inner else {
                return Ok(());
            };
            within = inner;
        }
        within.insert(Value::from(last.as_str()), value);
        Ok(())
    }

    fn value(&self, cell: &str) -> Result<Value, String> {
        match &self.kind {
            Kind::Text => Ok(cell.into()),
            Kind::Number => {
                let number = cell.parse::<f64>();
                number
                    .map(Value::from)
                    .map_err(|_| number_like(cell).to_owned())
            }
            Kind::Whole => {
                let number = cell.parse::<i64>();
                number
                    .map(Value::from)
                    .map_err(|_| "a whole number".to_owned())
            }
            Kind::Words(words) if words.iter().any(|word| word == cell) => Ok(cell.into()),
            Kind::Words(words) => Err(format!("`{}`", words.join("` or `"))),
        }
    }
}

/// What a cell that should be a number may be.
fn number_like(cell: &str) -> &'static str {
    let digits = cell.trim_start_matches(['-', '+']).to_ascii_lowercase();
    match ["0x", "0o", "0b"]
        .iter()
        .any(|base| digits.starts_with(base))
    {
        true => "a number in decimal digits, such as 16",
        false => "a number",
    }
}

/// Alternative keys: one in a row replaces any in the defaults, as an altitude has one reference.
const ALTITUDES: [&str; 2] = ["agl_m", "amsl_m"];

/// Puts the keys of a row over those of the defaults. Null and absent keys change nothing.
pub(super) fn merge(row: Mapping, defaults: &mut Mapping) {
    if ALTITUDES.iter().any(|key| row.contains_key(key)) {
        defaults.retain(|key, _| !ALTITUDES.iter().any(|altitude| key == altitude));
    }
    for (key, value) in row {
        match (value, defaults.get_mut(&key)) {
            (Value::Mapping(row), Some(Value::Mapping(defaults))) => merge(row, defaults),
            (value, _) => {
                defaults.insert(key, value);
            }
        }
    }
}
