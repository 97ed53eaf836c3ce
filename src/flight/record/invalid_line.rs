//! Why a line is none of a flight record.

use serde::de::DeserializeOwned;
use serde_json::Value;

use super::lines::{FixLine, PlanLine, ThreatLine};
use crate::flight::itinerary::stops::Itinerary;

/// What a value of a key is.
#[derive(Clone, Copy)]
enum Kind {
    Number,
    Count,
    Text,
    Texts,
}

/// A key that only one kind of line has, what that is, and the keys of it.
type Sort = (&'static str, &'static str, &'static [(&'static str, Kind)]);

const LINES: [Sort; 11] = [
    (
        "sortie",
        "a header",
        &[
            ("sortie", Kind::Text),
            ("spec_sha256", Kind::Text),
            ("speedup", Kind::Number),
            ("vehicles", Kind::Texts),
        ],
    ),
    ("t0_unix_s", "T0", &[("t0_unix_s", Kind::Count)]),
    (
        "plan",
        "a plan",
        &[("t_s", Kind::Number), ("vehicle", Kind::Text)],
    ),
    ("itinerary", "an itinerary", &[("vehicle", Kind::Text)]),
    ("threat", "a threat", &[("t_s", Kind::Number)]),
    ("lat_deg", "a position", &[]),
    (
        "reached",
        "an item reached",
        &[
            ("t_s", Kind::Number),
            ("vehicle", Kind::Text),
            ("reached", Kind::Count),
        ],
    ),
    (
        "stopped_s",
        "a stop",
        &[("t_s", Kind::Number), ("stopped_s", Kind::Number)],
    ),
    (
        "order",
        "an order",
        &[
            ("t_s", Kind::Number),
            ("vehicle", Kind::Text),
            ("order", Kind::Text),
        ],
    ),
    (
        "end",
        "an end",
        &[("vehicle", Kind::Text), ("end", Kind::Text)],
    ),
    ("event", "an event", &[("event", Kind::Text)]),
];

/// Whether a line is the beginning of one at most.
pub(crate) fn is_cut_off(text: &str) -> bool {
    let parsed = serde_json::from_str::<Value>(text);
    parsed.is_err_and(|error| error.is_eof())
}

/// Why a line is none of a record, in words.
pub(crate) fn why(text: &str) -> String {
    let why = match serde_json::from_str::<Value>(text) {
        Err(error) => format!("it is not JSON: {error}"),
        Ok(value) => why_not(&value),
    };
    format!("is no line of a flight record: {why}")
}

fn why_not(line: &Value) -> String {
    let Some((mark, what, keys)) = LINES.iter().find(|(mark, ..)| line.get(mark).is_some()) else {
        let marks: Vec<&str> = LINES.iter().map(|(mark, ..)| *mark).collect();
        return format!("it has none of the keys {}", marks.join(", "));
    };
    for (key, kind) in *keys {
        match line.get(key) {
            None => return format!("{what} has `{key}`, which is missing"),
            Some(value) if !kind.is(value) => {
                return format!("`{key}` of {what} is {}, got {value}", kind.words());
            }
            Some(_) => {}
        }
    }
    let inner = line.get(mark).cloned().unwrap_or_default();
    let refused = match *mark {
        "plan" => refusal::<PlanLine>(inner),
        "itinerary" => refusal::<Itinerary>(inner),
        "threat" => refusal::<ThreatLine>(inner),
        "lat_deg" => refusal::<FixLine>(line.clone()),
        _ => None,
    };
    let refused = refused.unwrap_or_else(|| "a key of it is of another type".to_owned());
    format!("{what}, but {refused}")
}

/// In the words of the parser.
fn refusal<T: DeserializeOwned>(value: Value) -> Option<String> {
    let refused = serde_json::from_value::<T>(value).err()?;
    Some(refused.to_string())
}

impl Kind {
    fn is(self, value: &Value) -> bool {
        match self {
            Self::Number => value.is_number(),
            Self::Count => value.is_u64(),
            Self::Text => value.is_string(),
            Self::Texts => value
                .as_array()
                .is_some_and(|all| all.iter().all(Value::is_string)),
        }
    }

    fn words(self) -> &'static str {
        match self {
            Self::Number => "a number",
            Self::Count => "a whole number",
            Self::Text => "a text",
            Self::Texts => "a list of texts",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{is_cut_off, why};

    #[test]
    fn what_is_missing_or_of_another_type_is_named() {
        let cases = [
            ("{}", "it has none of the keys sortie"),
            (
                "{\"end\": \"landed\"}",
                "an end has `vehicle`, which is missing",
            ),
            (
                "{\"t_s\": \"1\", \"vehicle\": \"a\", \"reached\": 2}",
                "`t_s` of an item reached is a number, got \"1\"",
            ),
            (
                "{\"t_s\": 1, \"vehicle\": \"a\", \"lat_deg\": 1, \"lon_deg\": 2}",
                "a position, but missing field `amsl_m`",
            ),
            (
                "{\"t_s\": 1, \"vehicle\": \"a\", \"plan\": {\"items\": -1}}",
                "a plan, but invalid value: integer `-1`",
            ),
            ("{\"t_s\": 1", "it is not JSON: EOF"),
            ("[1, 2]", "it has none of the keys"),
        ];
        for (line, expected) in cases {
            let found = why(line);
            assert!(found.contains(expected), "{line}: {found}");
        }
    }

    #[test]
    fn only_what_ends_too_early_is_cut_off() {
        assert!(is_cut_off("{\"t_s\": 1, \"vehi"));
        assert!(
            !is_cut_off("{\"t_s\": 1}") && !is_cut_off("{\"t_s\": 1}}") && !is_cut_off("nonsense")
        );
    }
}
