//! The JSON Schema against the check.

use std::collections::BTreeMap;

use super::*;

/// Every number with a range in the JSON Schema is refused just outside of that range, and only there.
#[test]
fn the_ranges_of_the_schema_are_those_of_the_check() {
    let mut seen = 0;
    for (key, bounds) in bounds() {
        // A key of two structs may have two ranges: refused outside both, taken inside both.
        let least = bounds.iter().map(|(min, _)| *min);
        let most = bounds.iter().map(|(_, max)| *max);
        let outer = (
            least.clone().fold(f64::INFINITY, f64::min),
            most.clone().fold(f64::NEG_INFINITY, f64::max),
        );
        let inner = (
            least.fold(f64::NEG_INFINITY, f64::max),
            most.fold(f64::INFINITY, f64::min),
        );
        let beyond = |limit: f64| (limit.abs() * 0.01).max(1.0);
        for value in [outer.0 - beyond(outer.0), outer.1 + beyond(outer.1)] {
            for text in with_value(&key, value) {
                let found = parse(&text)
                    .err()
                    .map(|error| error.issues)
                    .unwrap_or_default();
                assert!(
                    found.iter().any(|issue| names(issue, &key)),
                    "{key} of {value}: {found:?}"
                );
                seen += 1;
            }
        }
        for value in [inner.0, inner.1] {
            for text in with_value(&key, value) {
                let found = parse(&text)
                    .err()
                    .map(|error| error.issues)
                    .unwrap_or_default();
                let range = |issue: &&Issue| names(issue, &key) && issue.allowed.contains(" to ");
                assert_eq!(found.iter().find(range), None, "{key} of {value}");
            }
        }
    }
    assert!(seen > 60, "{seen}");
}

fn names(issue: &Issue, key: &str) -> bool {
    issue.path.ends_with(&format!(".{key}")) || issue.path == key
}

/// Least and greatest of every numeric key, once for each struct that has it.
fn bounds() -> BTreeMap<String, Vec<(f64, f64)>> {
    let schema: serde_json::Value =
        serde_json::from_str(&sortie::spec::json_schema()).expect("JSON");
    let defs = schema["$defs"].as_object().expect("definitions");
    let mut bounds: BTreeMap<String, Vec<(f64, f64)>> = BTreeMap::new();
    for definition in defs.values().chain([&schema]) {
        for (key, property) in definition["properties"].as_object().into_iter().flatten() {
            let limits = (property["minimum"].as_f64(), property["maximum"].as_f64());
            if let (Some(min), Some(max)) = limits {
                bounds.entry(key.clone()).or_default().push((min, max));
            }
        }
    }
    assert!(bounds.len() > 25, "{bounds:?}");
    bounds
}

/// The full spec with each occurrence of `key: number` in turn set to a value.
fn with_value(key: &str, value: f64) -> Vec<String> {
    let integer = [
        "evaluations",
        "control_points",
        "samples",
        "swarms",
        "population",
        "max_items",
        "sysid",
        "sortie",
    ];
    let value = if integer.contains(&key) {
        if value < 0.0 {
            return Vec::new();
        }
        format!("{value:.0}")
    } else {
        value.to_string()
    };
    let pattern = format!("{key}: ");
    FULL.match_indices(&pattern)
        .filter(|(at, _)| !FULL[..*at].ends_with(|c: char| c.is_alphanumeric() || c == '_'))
        .filter_map(|(at, _)| {
            let from = at + pattern.len();
            let digits = FULL[from..].find(|c: char| !(c.is_ascii_digit() || "-.".contains(c)))?;
            (digits > 0).then(|| format!("{}{value}{}", &FULL[..from], &FULL[from + digits..]))
        })
        .collect()
}
