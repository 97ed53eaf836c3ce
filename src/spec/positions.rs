//! Line and column of every key and value in the YAML text.
//!
//! A walk over the parser's events: no tree is built and nothing recurses, so
//! that deep nesting and aliases of aliases end in an error, not in a hang.
//!
//! serde-saphyr 1 has positions too, as `Spanned<T>` around a field. It does not replace this
//! walk: a position is needed for every value by its path, also for keys that are absent, so each
//! field of `keys` would be a `Spanned<Option<T>>`, in the schema and the builder as well. It has
//! no `Value`, which rows over defaults are merged in, so `serde_yaml` would stay as well.

use std::collections::{BTreeMap, BTreeSet};

use saphyr_parser::{Event, Parser, Span};

use super::Issue;

/// Deepest nesting; a mission needs six.
const MAX_DEPTH: usize = 32;
/// Most values, each alias counted as often as it is used.
const MAX_NODES: usize = 1_000_000;

/// Line and column, both from 1.
pub(super) type Position = (usize, usize);

/// Line and column of every key and value, by its path (`vehicles[2].start.lat`).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Positions {
    of: BTreeMap<String, Position>,
    keys: BTreeMap<String, Position>,
}

impl Positions {
    /// Walks the whole text.
    ///
    /// # Errors
    /// Broken YAML, a key given twice, more than one document, and documents too
    /// deep or too large when their aliases are written out.
    pub(super) fn read(text: &str) -> Result<Self, Issue> {
        let mut walk = Walk::default();
        for event in Parser::new_from_str(text) {
            let (event, span) = event.map_err(|error| {
                let marker = error.marker();
                let found = format!("broken YAML: {}", error.info());
                let place = (marker.line(), marker.col() + 1);
                problem("", place, &found, "`key: value` lines, indented by spaces, brackets and quotes closed, here and above")
            })?;
            walk.take(event, span)?;
        }
        Ok(Self {
            of: walk.positions,
            keys: walk.keys,
        })
    }

    /// Whether there is a value of exactly this path.
    pub(super) fn has(&self, path: &str) -> bool {
        self.of.contains_key(path)
    }

    /// The position of the key that ends a path; that of its value where there is no such key.
    pub(super) fn find_key(&self, path: &str) -> Option<Position> {
        (self.keys.get(path).copied()).or_else(|| self.find(path))
    }

    /// The position of a path; of the nearest value around it where the path itself
    /// is absent (a missing key, the inside of an alias).
    pub(super) fn find(&self, path: &str) -> Option<Position> {
        let mut path = path;
        loop {
            if let Some(position) = self.of.get(path) {
                return Some(*position);
            }
            if path.is_empty() {
                return None;
            }
            path = &path[..path.rfind(['.', '[']).unwrap_or(0)];
        }
    }
}

/// An open mapping or sequence.
#[derive(Debug)]
struct Open {
    path: String,
    /// Anchor id, 0 for none.
    anchor: usize,
    /// Values within, itself not counted, aliases written out.
    nodes: usize,
    inside: Inside,
}

#[derive(Debug)]
enum Inside {
    Mapping {
        keys: BTreeSet<String>,
        /// The key whose value comes next.
        key: Option<String>,
    },
    Sequence {
        next: usize,
    },
}

#[derive(Debug, Default)]
struct Walk {
    positions: BTreeMap<String, Position>,
    keys: BTreeMap<String, Position>,
    open: Vec<Open>,
    documents: usize,
    /// Size of each anchored value, by anchor id.
    anchored: BTreeMap<usize, usize>,
    nodes: usize,
}

impl Walk {
    fn take(&mut self, event: Event<'_>, span: Span) -> Result<(), Issue> {
        let at = (span.start.line(), span.start.col() + 1);
        match event {
            Event::DocumentStart(_) => {
                self.documents += 1;
                if self.documents > 1 {
                    return Err(problem(
                        "",
                        at,
                        "a second document",
                        "one mission in one file",
                    ));
                }
            }
            Event::Scalar(text, _, anchor, _) => {
                self.anchored.insert(anchor, 1);
                if !self.key(at, &text)? {
                    self.value(at, 1)?;
                }
            }
            Event::Alias(anchor) => {
                self.refuse_as_key(at)?;
                // An alias within its own anchor finds no size: it would never end.
                let Some(&nodes) = self.anchored.get(&anchor) else {
                    return Err(problem(
                        &self.path(),
                        at,
                        "an alias of itself",
                        "finite values",
                    ));
                };
                self.value(at, nodes)?;
            }
            Event::SequenceStart(anchor, _) => {
                self.start(at, anchor, Inside::Sequence { next: 0 })?
            }
            Event::MappingStart(anchor, _) => {
                let inside = Inside::Mapping {
                    keys: BTreeSet::new(),
                    key: None,
                };
                self.start(at, anchor, inside)?;
            }
            Event::SequenceEnd | Event::MappingEnd => {
                if let Some(done) = self.open.pop() {
                    self.anchored
                        .insert(done.anchor, done.nodes.saturating_add(1));
                    if let Some(around) = self.open.last_mut() {
                        around.nodes = around.nodes.saturating_add(done.nodes);
                    }
                }
            }
            Event::Nothing | Event::StreamStart | Event::StreamEnd | Event::DocumentEnd => {}
        }
        Ok(())
    }

    /// Takes a word as a key if one is due; returns whether it did.
    fn key(&mut self, at: Position, word: &str) -> Result<bool, Issue> {
        let inside = self.open.last_mut().map(|open| &mut open.inside);
        let Some(Inside::Mapping {
            keys,
            key: key @ None,
        }) = inside
        else {
            return Ok(false);
        };
        *key = Some(word.to_owned());
        if keys.insert(word.to_owned()) {
            self.keys.insert(self.path(), at);
            return Ok(true);
        }
        let found = "this key a second time";
        Err(problem(&self.path(), at, found, "each key once"))
    }

    /// Path of the value that comes next.
    fn path(&self) -> String {
        match self.open.last() {
            None => String::new(),
            Some(Open {
                path,
                inside: Inside::Sequence { next },
                ..
            }) => format!("{path}[{next}]"),
            Some(Open {
                path,
                inside: Inside::Mapping { key, .. },
                ..
            }) => {
                let key = key.as_deref().unwrap_or("");
                if path.is_empty() {
                    key.to_owned()
                } else {
                    format!("{path}.{key}")
                }
            }
        }
    }

    /// Notes one value, with its number of nodes.
    fn value(&mut self, at: Position, nodes: usize) -> Result<(), Issue> {
        let path = self.path();
        self.nodes = self.nodes.saturating_add(nodes);
        if self.nodes > MAX_NODES {
            let allowed = format!("at most {MAX_NODES} values, aliases written out");
            return Err(problem(&path, at, "too large a file", &allowed));
        }
        if let Some(open) = self.open.last_mut() {
            open.nodes = open.nodes.saturating_add(nodes);
            match &mut open.inside {
                Inside::Mapping { key, .. } => *key = None,
                Inside::Sequence { next } => *next += 1,
            }
        }
        self.positions.insert(path, at);
        Ok(())
    }

    fn start(&mut self, at: Position, anchor: usize, inside: Inside) -> Result<(), Issue> {
        self.refuse_as_key(at)?;
        let path = self.path();
        if self.open.len() >= MAX_DEPTH {
            let allowed = format!("at most {MAX_DEPTH} levels");
            return Err(problem("", at, "nested too deeply", &allowed));
        }
        self.value(at, 1)?;
        self.open.push(Open {
            path,
            anchor,
            nodes: 0,
            inside,
        });
        Ok(())
    }

    fn refuse_as_key(&self, at: Position) -> Result<(), Issue> {
        match self.open.last() {
            Some(Open {
                path,
                inside: Inside::Mapping { key: None, .. },
                ..
            }) => Err(problem(
                path,
                at,
                "a key that is not a word",
                "words as keys",
            )),
            _ => Ok(()),
        }
    }
}

fn problem(path: &str, at: Position, found: &str, allowed: &str) -> Issue {
    Issue {
        path: path.to_owned(),
        table: None,
        position: Some(at),
        found: found.to_owned(),
        allowed: allowed.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str =
        "name: x\nvehicles:\n  - id: a\n    start: {lat: 1, lon: 2}\n  - &b\n    id: b\n  - *b\n";

    #[test]
    fn every_value_has_its_line_and_column() {
        let positions = Positions::read(TEXT).expect("good YAML");
        assert_eq!(positions.find("name"), Some((1, 7)));
        assert_eq!(positions.find("vehicles[0].start.lon"), Some((4, 26)));
        assert_eq!(positions.find("vehicles[1].id"), Some((6, 9)));
    }

    #[test]
    fn an_absent_value_has_the_position_of_its_surroundings() {
        let positions = Positions::read(TEXT).expect("good YAML");
        assert_eq!(
            positions.find("vehicles[0].start.agl_m"),
            positions.find("vehicles[0].start")
        );
        assert_eq!(
            positions.find("vehicles[2].id"),
            Some((7, 5)),
            "the alias, not its anchor"
        );
        assert_eq!(positions.find("nothing.at[3].all"), Some((1, 1)));
    }

    #[test]
    fn a_key_given_twice_is_reported_where_it_stands_again() {
        let issue = Positions::read("a: 1\nb: {c: 1,\n    c: 2}\n").expect_err("c twice");
        assert_eq!((issue.path.as_str(), issue.position), ("b.c", Some((3, 5))));
    }

    #[test]
    fn aliases_of_aliases_are_counted_written_out() {
        let mut text = String::from("a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n");
        for level in 1..30 {
            let list = vec![format!("*a{}", level - 1); 10].join(", ");
            text += &format!("a{level}: &a{level} [{list}]\n");
        }
        let issue = Positions::read(&text).expect_err("ten to the thirty values");
        assert_eq!(issue.found, "too large a file");
    }

    #[test]
    fn an_alias_of_itself_is_an_error() {
        let issue = Positions::read("a: &a [1, *a]\n").expect_err("endless");
        assert_eq!(
            (issue.path.as_str(), issue.position),
            ("a[1]", Some((1, 11)))
        );
    }

    #[test]
    fn deep_nesting_is_an_error() {
        for text in [
            "[".repeat(200_000),
            "{a: ".repeat(200_000),
            "- ".repeat(200_000),
        ] {
            let issue = Positions::read(&text).expect_err("too deep");
            // The scanner itself stops at deep brackets, the walk at deep blocks.
            let known = ["nested too deeply", "recursion limit exceeded"];
            let found = issue.found.trim_start_matches("broken YAML: ");
            assert!(known.contains(&found), "{issue:?}");
        }
    }
}
