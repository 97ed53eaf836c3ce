//! One concept has one name: words that were given up for the field's do not come back.

#[path = "support/source.rs"]
#[allow(dead_code, unreachable_pub)]
mod source;

use std::collections::BTreeMap;

use source::source_files;

/// Words of identifiers.
const GIVEN_UP: &[&str] = &[
    "kept",
    "told",
    "asking",
    "lap",
    "misread",
    "meeting",
    "encounter",
    "wanted",
    "settle",
    "leeway",
    "lowest",
    "pivot",
    "swerve",
    "ribbon",
    "swing",
    "tecs",
    "doubt",
    "thin",
    "printed",
    "craft",
    "trail",
    "hair",
    "whereabouts",
    "places",
    "bare",
    "cutoff",
    "beside",
    "spot",
    "author",
    "script",
];
/// Words that no identifier of several begins with: a bound is `min` or `max`.
const NO_PREFIX: &[&str] = &["most", "least"];
/// Phrases of comments, messages and documentation.
const PHRASES: &[&str] = &[
    "told",
    "tells",
    "whoever",
    "so many",
    "none but",
    "of which",
    "left away",
    "is to be",
    "the house",
    "room of the house",
];
/// Identifiers in which such a word is the field's own: ArduPlane's TECS and its parameters,
/// scripts of Unicode, what is least or most of its kind.
const REAL: &[&str] = &[
    "tecs",
    "TECS",
    "MixedScript",
    "is_single_script",
    "one_script",
    "least_cost",
    "LeastCost",
    "most_promising",
    "most_violated",
    "most_regretted",
    "most_important",
];

/// The words of an identifier in snake or camel case, lower case.
fn words(identifier: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut previous = '_';
    for c in identifier.chars() {
        let begins = previous == '_' || (c.is_uppercase() && !previous.is_uppercase());
        if c != '_' {
            if begins || words.is_empty() {
                words.push(String::new());
            }
            if let Some(word) = words.last_mut() {
                word.extend(c.to_lowercase());
            }
        }
        previous = c;
    }
    words
}

fn identifiers(code: &str) -> impl Iterator<Item = &str> {
    code.split(|c: char| !c.is_alphanumeric() && c != '_')
        .filter(|word| word.starts_with(|c: char| c.is_alphabetic() || c == '_'))
}

#[test]
fn identifiers_use_the_words_of_the_field() {
    let mut found: BTreeMap<(String, String), usize> = BTreeMap::new();
    for file in source_files() {
        for identifier in identifiers(&file.code()) {
            let is_given_up = |word: &String| {
                let singular = word.strip_suffix('s').unwrap_or(word);
                GIVEN_UP.contains(&word.as_str()) || GIVEN_UP.contains(&singular)
            };
            let is_real = REAL.iter().any(|real| identifier.starts_with(real));
            let words = words(identifier);
            let is_prefixed = words.len() > 1 && NO_PREFIX.contains(&words[0].as_str());
            if !is_real && (is_prefixed || words.iter().any(is_given_up)) {
                *found
                    .entry((file.name.clone(), identifier.to_owned()))
                    .or_default() += 1;
            }
        }
    }
    let list: Vec<String> = found
        .iter()
        .map(|((file, identifier), count)| format!("{file}: {identifier} ({count})"))
        .collect();
    assert!(list.is_empty(), "{}:\n{}", list.len(), list.join("\n"));
}

#[test]
fn comments_and_messages_avoid_the_phrases_given_up() {
    let mut found = Vec::new();
    for file in source_files() {
        for (number, line) in file.prose().lines().enumerate() {
            let line = line.to_lowercase();
            let stands = |phrase: &&&str| {
                line.match_indices(**phrase).any(|(at, _)| {
                    let is_word = |c: Option<char>| c.is_some_and(char::is_alphanumeric);
                    !is_word(line[..at].chars().next_back())
                        && !is_word(line[at + phrase.len()..].chars().next())
                })
            };
            if let Some(phrase) = PHRASES.iter().find(stands) {
                found.push(format!("{}:{}: {phrase}", file.name, number + 1));
            }
        }
    }
    assert!(found.is_empty(), "{}:\n{}", found.len(), found.join("\n"));
}

#[test]
fn identifiers_are_split_into_their_words() {
    assert_eq!(words("has_leeway"), ["has", "leeway"]);
    assert_eq!(words("LowestSpline"), ["lowest", "spline"]);
    assert_eq!(words("MOST_PLACES"), ["most", "places"]);
    assert_eq!(words("thinnest_m"), ["thinnest", "m"]);
}
