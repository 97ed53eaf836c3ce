//! Keys and types of a spec: what is wrong with them, all of it, and what can be known in spite of it.
//!
//! The parser stops at the first problem. It is mended in a copy of the values (an unknown key is
//! removed or renamed, a value of a wrong type removed, a missing one filled in), and the copy is parsed
//! again. What is checked of the result is true but for what depends on the mended values.

use serde_json::Value as Schema;
use serde_yaml::{Mapping, Number, Value};

use crate::numeric::digits;
use crate::numeric::text::{meant, other_unit};
use crate::spec::issue::{Issue, MISSING};
use crate::spec::keys;
use crate::spec::keys::schema::{self, index_of, resolved, steps};
use crate::spec::positions::Positions;

/// What a vehicle has places at: these do not depend on its other keys.
const SITES: [&str; 4] = ["home", "start", "goal", "stops"];
/// Most problems of keys and types that are reported.
const MAX_PROBLEMS: usize = 50;
/// Most text that is parsed again, bytes.
const MAX_TEXT: usize = 16 << 20;

/// Keys of a spec, as far as they are known.
pub(in crate::spec) struct KeysRead {
    pub(in crate::spec) keys: keys::Spec,
    /// What is wrong with keys and types.
    pub(in crate::spec) issues: Vec<Issue>,
    /// Where nothing more can be known.
    pub(in crate::spec) unknown: Vec<Unknown>,
}

/// What is not known for a problem that is reported already.
#[derive(Debug)]
pub(in crate::spec) enum Unknown {
    /// What is at a path, but not what is at its keys.
    At(String),
    /// What is at a path and below it.
    Within(String),
    /// What is at a vehicle and below it, but for its places.
    ButSites(String),
}

impl From<keys::Spec> for KeysRead {
    fn from(keys: keys::Spec) -> Self {
        Self {
            keys,
            issues: Vec::new(),
            unknown: Vec::new(),
        }
    }
}

/// Parses a spec, beyond all problems of keys and types.
///
/// # Errors
/// Those problems, where nothing can be known beside them.
pub(in crate::spec) fn read(yaml: &str, positions: &Positions) -> Result<KeysRead, Vec<Issue>> {
    let mut error = match serde_yaml::from_str::<keys::Spec>(yaml) {
        Ok(keys) => return Ok(keys.into()),
        Err(error) => error,
    };
    if let Some(found) = other_kind(yaml) {
        return Err(vec![Issue {
            path: String::new(),
            table: None,
            position: Some((1, 1)),
            found,
            allowed: "a mission spec: YAML that begins with `sortie: 2`".to_owned(),
        }]);
    }
    let schema = schema::of_spec();
    let mut first = Some(problem(&error, schema));
    let Ok(value) = serde_yaml::from_str::<Value>(yaml) else {
        return Err(first.into_iter().collect());
    };
    let mut mended = Mended {
        value,
        schema,
        removed: Vec::new(),
        unknown: Vec::new(),
    };
    let (mut issues, mut parsed) = (Vec::new(), 0);
    loop {
        // The position is known of the first one alone: others are of the copy.
        let found = Found::of(&error, schema);
        let issue = first.take().unwrap_or_else(|| found.issue_in(positions));
        if !mended.is_removed(&found) {
            issues.push(issue);
        }
        let is_mended = issues.len() <= MAX_PROBLEMS && mended.mend(&found).is_some();
        let text = serde_yaml::to_string(&mended.value)
            .ok()
            .filter(|_| is_mended);
        let Some(text) = text.filter(|text| parsed + text.len() <= MAX_TEXT) else {
            return Err(issues);
        };
        parsed += text.len();
        match serde_yaml::from_str::<keys::Spec>(&text) {
            // What all other keys mean depends on the version.
            Ok(_) if mended.has_no_version() => return Err(issues),
            Ok(keys) => {
                return Ok(KeysRead {
                    keys,
                    issues,
                    unknown: mended.unknown,
                });
            }
            Err(next) => error = next,
        }
    }
}

/// What a text is instead of a spec, if it is of another kind, and which command reads that.
fn other_kind(text: &str) -> Option<String> {
    let reviewed = |kind: &str| Some(format!("{kind}, no spec: `sortie review` judges it"));
    if text.starts_with("QGC WPL") {
        return reviewed("a mission file (QGC WPL)");
    }
    if text.trim_start().starts_with('{') && text.contains("\"fileType\"") {
        return reviewed("a plan of QGroundControl");
    }
    match serde_yaml::from_str::<Value>(text) {
        Ok(Value::Mapping(_)) | Err(_) => None,
        Ok(Value::Null) => Some("nothing".to_owned()),
        Ok(Value::Sequence(_)) => Some("a list".to_owned()),
        Ok(_) => {
            const SHOWN: usize = 40;
            let line = text.lines().find(|line| !line.trim().is_empty());
            let start: String = line.unwrap_or_default().chars().take(SHOWN).collect();
            Some(format!("text without keys that begins with {start:?}"))
        }
    }
}

/// Whether an issue may come of a problem that is reported already.
pub(in crate::spec) fn is_unknown(issue: &Issue, unknown: &[Unknown]) -> bool {
    let is_of = |unknown: &Unknown| match unknown {
        Unknown::At(path) => issue.path == *path,
        Unknown::Within(path) => is_of(&issue.path, path),
        Unknown::ButSites(path) => {
            let mut sites = SITES.iter();
            is_of(&issue.path, path)
                && !sites.any(|site| is_of(&issue.path, &format!("{path}.{site}")))
        }
    };
    issue.table.is_none() && unknown.iter().any(is_of)
}

/// Whether a path is that of a key, or below it.
pub(super) fn is_of(path: &str, key: &str) -> bool {
    let rest = path.strip_prefix(key);
    rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
}

/// The problem that ended a parse of what has this schema.
pub(in crate::spec) fn problem(error: &serde_yaml::Error, schema: &Schema) -> Issue {
    Found::of(error, schema).issue
}

/// What is wrong at a place.
enum Kind {
    /// A key that is not known, and the known one that was probably meant.
    UnknownKey(Option<String>),
    /// A key that differs from this known one in its unit: its value says nothing.
    OtherUnit(String),
    /// The key is missing.
    Missing,
    /// The value.
    Value,
}

struct Found {
    issue: Issue,
    kind: Kind,
}

impl Found {
    /// Takes apart a message such as
    /// `vehicles[0]: invalid type: string "fast", expected f64 at line 3 column 5`.
    fn of(error: &serde_yaml::Error, schema: &Schema) -> Self {
        let position = error.location().map(|at| (at.line(), at.column()));
        let mut message = error.to_string();
        if let Some((line, column)) = position {
            let suffix = format!(" at line {line} column {column}");
            message = message.replacen(&suffix, "", 1);
        }
        let is_path = |text: &str| {
            text.chars()
                .all(|c| c.is_ascii_alphanumeric() || "_.[]?".contains(c))
        };
        let (path, message) = match message.split_once(": ") {
            Some((path, rest)) if is_path(path) => (path.to_owned(), rest.to_owned()),
            _ => (String::new(), message),
        };
        let quoted = |before: &str| message.strip_prefix(before)?.split_once('`');
        let (key, missing) = (quoted("unknown field `"), quoted(MISSING));
        // The key itself belongs to the path.
        let path = match key.or(missing) {
            Some((key, _)) => below(&path, key),
            None => path,
        };
        let (mut found, allowed) = match message.split_once(", expected ") {
            Some((found, allowed)) => explained(found, plain(allowed)),
            None if missing.is_some() => (message.clone(), schema::allowed_at(schema, &path)),
            None => (message.clone(), String::new()),
        };
        let word = key.or_else(|| quoted("unknown variant `"));
        // What is known is listed in backticks.
        let meant = word.and_then(|(word, rest)| meant(word, rest.split('`').skip(1).step_by(2)));
        if let Some(((word, _), meant)) = word.zip(meant) {
            let unit = other_unit(word, meant).map_or_else(String::new, |of| format!(", in {of}"));
            found = format!("{found}: did you mean `{meant}`{unit}?");
        }
        let kind = match (key, missing) {
            (Some((key, _)), _) => match meant {
                Some(meant) if other_unit(key, meant).is_some() => {
                    Kind::OtherUnit(meant.to_owned())
                }
                _ => Kind::UnknownKey(meant.map(str::to_owned)),
            },
            (_, Some(_)) => Kind::Missing,
            _ => Kind::Value,
        };
        let issue = Issue {
            path,
            table: None,
            position,
            found,
            allowed,
        };
        Self { issue, kind }
    }

    /// The problem with its position in the file.
    fn issue_in(&self, positions: &Positions) -> Issue {
        let path = &self.issue.path;
        Issue {
            position: match self.kind {
                Kind::UnknownKey(_) | Kind::OtherUnit(_) => positions.find_key(path),
                Kind::Missing | Kind::Value => positions.find(path),
            },
            ..self.issue.clone()
        }
    }
}

/// A copy of the values of a spec in which problems are mended.
struct Mended {
    value: Value,
    schema: &'static Schema,
    /// Paths whose values were removed: that they are missing is no other problem.
    removed: Vec<String>,
    unknown: Vec<Unknown>,
}

impl Mended {
    /// Whether a key is missing because its value was removed.
    fn is_removed(&self, found: &Found) -> bool {
        matches!(found.kind, Kind::Missing) && self.removed.contains(&found.issue.path)
    }

    /// Whether the version of the format is a filling.
    fn has_no_version(&self) -> bool {
        let is_version =
            |unknown: &Unknown| matches!(unknown, Unknown::Within(path) if path == "sortie");
        self.unknown.iter().any(is_version)
    }

    /// Mends a problem; `None` where that is not possible.
    fn mend(&mut self, found: &Found) -> Option<()> {
        let path = found.issue.path.as_str();
        let (parent, last) = split(path)?;
        if matches!(found.kind, Kind::Missing) {
            let filling = filling(last, schema::at(self.schema, path), self.schema, 0);
            let keys = value_at(&mut self.value, parent)?.as_mapping_mut()?;
            let before = keys.insert(last.into(), filling);
            let around = if parent.is_empty() { path } else { parent };
            self.unknown.push(Unknown::Within(around.to_owned()));
            return before.is_none().then_some(());
        }
        let value = value_at(&mut self.value, parent)?;
        if let Some(index) = index_of(last) {
            let filling = filling("", schema::at(self.schema, path), self.schema, 0);
            let item = value.as_sequence_mut()?.get_mut(index)?;
            if *item == filling {
                return None;
            }
            *item = filling;
            self.unknown.push(Unknown::Within(mapping_around(path)));
            return Some(());
        }
        let keys = value.as_mapping_mut()?;
        let was = keys.remove(last)?;
        match &found.kind {
            Kind::UnknownKey(Some(meant)) if !keys.contains_key(meant.as_str()) => {
                keys.insert(meant.as_str().into(), was);
            }
            Kind::UnknownKey(_) => self.unknown.push(Unknown::At(parent.to_owned())),
            kind => {
                let missing = match kind {
                    Kind::OtherUnit(meant) => meant,
                    _ => last,
                };
                let missing = below(parent, missing);
                self.removed.push(missing.clone());
                // A site that is removed is not missing, though the sites of a vehicle are known.
                self.unknown.push(Unknown::Within(missing));
                self.unknown
                    .push(match is_vehicle(parent) && last != "stops" {
                        true => Unknown::ButSites(parent.to_owned()),
                        false => Unknown::Within(mapping_around(path)),
                    });
            }
        }
        Some(())
    }
}

/// Whether a path is that of a vehicle.
fn is_vehicle(path: &str) -> bool {
    let index = path.strip_prefix("vehicles");
    index.and_then(index_of).is_some()
}

fn value_at<'v>(root: &'v mut Value, path: &str) -> Option<&'v mut Value> {
    steps(path).try_fold(root, |value, step| match index_of(step) {
        Some(index) => value.as_sequence_mut()?.get_mut(index),
        None => value.as_mapping_mut()?.get_mut(step),
    })
}

/// The path of a key below another one.
fn below(path: &str, key: &str) -> String {
    match path {
        "" => key.to_owned(),
        _ => format!("{path}.{key}"),
    }
}

/// A path without its last key or index, and that; none of the root.
fn split(path: &str) -> Option<(&str, &str)> {
    let at = path.rfind(['.', '[']).unwrap_or(0);
    let (parent, last) = path.split_at(at);
    let last = last.trim_start_matches('.');
    (!last.is_empty()).then_some((parent, last))
}

/// The mapping that has a value, or the key of the spec that has it.
fn mapping_around(path: &str) -> String {
    let key = path.trim_end_matches(|c: char| c == '[' || c == ']' || c.is_ascii_digit());
    let around = split(key).map_or("", |(parent, _)| parent);
    if around.is_empty() {
        key.to_owned()
    } else {
        around.to_owned()
    }
}

/// A value of a type that is needed, and within its range.
fn filling(key: &str, schema: &Schema, root: &Schema, depth: usize) -> Value {
    let kind = schema["type"].as_str().unwrap_or_default();
    if let Some(word) = schema["enum"][0].as_str() {
        return word.into();
    }
    let bound = |name: &str| schema[name].as_f64();
    match kind {
        "string" => "".into(),
        "boolean" => false.into(),
        "array" => {
            let least = schema["minItems"].as_u64().unwrap_or(0).min(8);
            let item = || filling("", resolved(&schema["items"], root), root, depth + 1);
            Value::Sequence((0..least).map(|_| item()).collect())
        }
        "object" if depth < 8 => {
            let required = schema["required"].as_array().into_iter().flatten();
            let keys = required.filter_map(Schema::as_str).map(|key| {
                let of_key = resolved(&schema["properties"][key], root);
                (key.into(), filling(key, of_key, root, depth + 1))
            });
            Value::Mapping(keys.collect::<Mapping>())
        }
        "number" | "integer" => {
            // The widest limit.
            let is_max = key.starts_with("max_");
            let least = bound("minimum").unwrap_or(0.0).max(0.0);
            let value = bound("maximum").filter(|_| is_max).unwrap_or(least);
            #[expect(clippy::cast_possible_truncation, reason = "bounds of a small schema")]
            match kind {
                "integer" => Value::Number((value as i64).into()),
                _ => Value::Number(Number::from(value)),
            }
        }
        _ => Value::Null,
    }
}

/// What the parser found and expected of a number, in the words of the file.
fn explained(found: &str, allowed: String) -> (String, String) {
    let between = |before: &str| found.strip_prefix(before)?.strip_suffix('`');
    // An integer is a number too, unless its digits are not decimal.
    if let Some(value) = between("invalid type: integer `").filter(|_| allowed == "a number") {
        let found = format!("{value} in hexadecimal, octal or binary digits");
        return (
            found,
            format!("a number in decimal digits, such as {value}"),
        );
    }
    let float = between("invalid type: floating point `");
    if let Some(value) = float.and_then(|text| text.parse().ok()) {
        let value = digits::plain(value);
        return (format!("invalid type: floating point `{value}`"), allowed);
    }
    (found.to_owned(), allowed)
}

/// What the parser expected, in the words of the file.
fn plain(expected: &str) -> String {
    match expected {
        "f64" => "a number".to_owned(),
        "u32" | "u64" | "i64" => "a whole number".to_owned(),
        "a sequence" => "a list".to_owned(),
        _ if expected.starts_with("struct ") => "keys with values".to_owned(),
        _ => expected.to_owned(),
    }
}
