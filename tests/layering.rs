//! The architecture is the folder list: each folder imports only from lower layers, files of
//! one folder import each other in no circle, and neither folders nor functions grow large.

#[path = "support/source.rs"]
#[allow(dead_code, unreachable_pub)]
mod source;

use std::collections::{BTreeMap, BTreeSet};

use source::{SourceFile, source_files};

/// Folder, layer, and what it may not import although it lies lower.
const LAYERS: &[(&str, u32, &[&str])] = &[
    ("guide", 0, &[]),
    ("numeric", 0, &[]),
    ("geodesy", 1, &[]),
    ("optimize", 1, &[]),
    ("autopilot", 1, &[]),
    ("shapes", 1, &[]),
    ("spec", 2, &["optimize"]),
    ("world", 3, &["optimize"]),
    ("path", 4, &["optimize"]),
    ("cost", 5, &["optimize"]),
    ("plan", 6, &[]),
    ("tasks", 7, &[]),
    ("mission", 7, &["optimize", "cost", "plan"]),
    ("formats", 8, &["optimize", "cost", "plan"]),
    ("verify", 8, &["optimize", "cost", "plan"]),
    ("dispatch", 9, &["optimize"]),
    ("link", 9, &["optimize", "path", "cost", "plan", "world"]),
    ("simulator", 10, &["optimize", "path", "cost", "plan"]),
    ("report", 10, &["optimize", "link"]),
    ("flight", 11, &[]),
    ("study", 11, &["link"]),
    // Not a folder: the functions that lib.rs shows first.
    ("library", 12, &[]),
    ("cli", 13, &[]),
];
/// Folders of one layer of which the first stands on the second.
const WITHIN_LAYER: &[(&str, &str)] = &[("shapes", "geodesy")];
/// Most files flat in a folder beside its `mod.rs`.
const MAX_FILES: usize = 12;
/// Most lines of a function, signature and braces included.
const MAX_LINES: usize = 60;
/// Most arguments of a function; members of a tuple count each.
const MAX_ARGUMENTS: usize = 6;

/// Functions that are still too large. The list only shrinks: an entry that is no longer
/// needed fails the test, as a new large function does.
const STILL_LARGE: &[&str] = &["cost/model.rs: new", "verify/limits/separation.rs: judge"];

/// Every path in the code, with its line: those of `use` trees as their leaves, and others
/// that begin with `crate`, `self` or `super`.
fn paths(code: &str) -> Vec<(usize, Vec<String>)> {
    let mut found = Vec::new();
    let line_of = |at: usize| code[..at].matches('\n').count() + 1;
    let mut rest = String::from(code);
    for (at, _) in code.match_indices("use ") {
        let before = code[..at].chars().next_back();
        if before.is_some_and(|c| c.is_alphanumeric() || c == '_') {
            continue;
        }
        let Some(length) = code[at..].find(';') else {
            continue;
        };
        let tree: String = code[at + 4..at + length]
            .split_whitespace()
            .collect::<Vec<_>>()
            .join(" ");
        leaves(&tree, &[], &mut |leaf| found.push((line_of(at), leaf)));
        rest.replace_range(at..at + length, &" ".repeat(length));
    }
    for root in ["crate::", "super::", "self::"] {
        for (at, _) in rest.match_indices(root) {
            let before = rest[..at].chars().next_back();
            if before.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == ':') {
                continue;
            }
            let path: String = rest[at..]
                .chars()
                .take_while(|c| c.is_alphanumeric() || *c == '_' || *c == ':')
                .collect();
            let segments = path.split("::").filter(|s| !s.is_empty());
            found.push((line_of(at), segments.map(str::to_owned).collect()));
        }
    }
    found
}

/// Calls back with each leaf of a `use` tree, `a::{b, c::d as e}` as `a::b` and `a::c::d`.
fn leaves(tree: &str, prefix: &[String], found: &mut impl FnMut(Vec<String>)) {
    let tree = tree.trim();
    let (head, group) = match tree.find('{') {
        Some(at) => (
            &tree[..at],
            tree[at + 1..].rsplit_once('}').map(|(inside, _)| inside),
        ),
        None => (tree.split(" as ").next().unwrap_or(tree), None),
    };
    let mut path = prefix.to_vec();
    path.extend(
        head.split("::")
            .map(str::trim)
            .filter(|s| !s.is_empty())
            .map(str::to_owned),
    );
    let Some(group) = group else {
        return found(path);
    };
    let (mut depth, mut from) = (0, 0);
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                leaves(&group[from..at], &path, found);
                from = at + 1;
            }
            _ => {}
        }
    }
    if !group[from..].trim().is_empty() {
        leaves(&group[from..], &path, found);
    }
}

/// The path from the root of the crate; none for what is outside of it.
fn absolute(
    path: &[String],
    module: &[String],
    modules: &BTreeSet<Vec<String>>,
) -> Option<Vec<String>> {
    let mut base = module.to_vec();
    match path.first()?.as_str() {
        "crate" => Some(path[1..].to_vec()),
        "self" => Some([&base[..], &path[1..]].concat()),
        "super" => {
            let ups = path.iter().take_while(|s| *s == "super").count();
            base.truncate(base.len().saturating_sub(ups));
            Some([&base[..], &path[ups..]].concat())
        }
        first => {
            base.push(first.to_owned());
            modules.contains(&base).then(|| [module, path].concat())
        }
    }
}

/// The imports of each module by the modules that they name: module -> (line, module).
fn imports(files: &[SourceFile]) -> BTreeMap<Vec<String>, Vec<(usize, Vec<String>)>> {
    let modules: BTreeSet<Vec<String>> = files.iter().map(|file| file.module.clone()).collect();
    let of = |file: &SourceFile| {
        let named = paths(&file.product_code())
            .into_iter()
            .filter_map(|(line, path)| {
                let mut path = absolute(&path, &file.module, &modules)?;
                while !modules.contains(&path) {
                    path.pop()?;
                }
                Some((line, path))
            });
        (file.module.clone(), named.collect())
    };
    files
        .iter()
        .filter(|file| file.name != "main.rs")
        .map(of)
        .collect()
}

#[test]
fn each_folder_imports_only_what_lies_below_it() {
    let files = source_files();
    let row = |folder: &str| LAYERS.iter().find(|(name, ..)| *name == folder);
    let mut broken = Vec::new();
    let mut seen = BTreeSet::new();
    for (module, imported) in imports(&files) {
        let Some(folder) = module.first() else {
            continue;
        };
        let (_, layer, forbidden) =
            row(folder).unwrap_or_else(|| panic!("src/{folder} has no layer"));
        seen.insert(folder.clone());
        for (line, target) in imported {
            let Some((name, below, _)) = target.first().and_then(|name| row(name)) else {
                continue;
            };
            let is_above = below >= layer && !WITHIN_LAYER.contains(&(folder, name));
            if name != folder && (is_above || forbidden.contains(name)) {
                broken.push(format!(
                    "{}:{line}: {folder} (layer {layer}) must not import {name} (layer {below})",
                    module.join("/")
                ));
            }
        }
    }
    assert!(seen.len() > 15, "only {seen:?} were looked at");
    assert!(broken.is_empty(), "\n{}", broken.join("\n"));
}

#[test]
fn files_of_one_folder_import_each_other_in_no_circle() {
    let graph = imports(&source_files());
    let is_kin = |a: &[String], b: &[String]| a.starts_with(b) || b.starts_with(a);
    let edges: BTreeMap<&Vec<String>, BTreeSet<&Vec<String>>> = graph
        .iter()
        .map(|(from, targets)| {
            let others = targets
                .iter()
                .map(|(_, to)| to)
                .filter(|to| !is_kin(from, to));
            (from, others.collect())
        })
        .collect();
    let mut circles = BTreeSet::new();
    for start in edges.keys() {
        // Breadth first, so that the circle found is a shortest one.
        let mut before: BTreeMap<&Vec<String>, &Vec<String>> = BTreeMap::new();
        let mut queue = std::collections::VecDeque::from([*start]);
        while let Some(at) = queue.pop_front() {
            for &to in edges.get(at).into_iter().flatten() {
                if to == *start {
                    let mut circle = vec![at.join("/")];
                    let mut step = at;
                    while let Some(previous) = before.get(step) {
                        circle.push(previous.join("/"));
                        step = previous;
                    }
                    circle.sort();
                    circles.insert(circle.join(" <-> "));
                    queue.clear();
                    break;
                }
                if to != *start && !before.contains_key(to) {
                    before.insert(to, at);
                    queue.push_back(to);
                }
            }
        }
    }
    let list: Vec<String> = circles.into_iter().collect();
    assert!(list.is_empty(), "\n{}", list.join("\n"));
}

#[test]
fn no_folder_has_many_files_flat() {
    let mut flat: BTreeMap<String, usize> = BTreeMap::new();
    for file in source_files() {
        let (folder, name) = file.name.rsplit_once('/').unwrap_or(("", &file.name));
        if !["mod.rs", "lib.rs", "main.rs"].contains(&name) {
            *flat.entry(folder.to_owned()).or_default() += 1;
        }
    }
    flat.retain(|_, count| *count > MAX_FILES);
    assert!(flat.is_empty(), "more than {MAX_FILES} files: {flat:?}");
}

/// Each function of the code: its line, name, arguments and lines.
fn functions(code: &str) -> Vec<(usize, String, usize, usize)> {
    let mut found = Vec::new();
    for (at, _) in code.match_indices("fn ") {
        if code[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_') {
            continue;
        }
        let rest = &code[at + 3..];
        let name: String = rest
            .chars()
            .take_while(|c| c.is_alphanumeric() || *c == '_')
            .collect();
        if name.is_empty() {
            continue;
        }
        let Some(open) = parenthesis(rest) else {
            continue;
        };
        let close = open + closing(&rest[open..], '(', ')');
        let count = arguments(&rest[open + 1..close]);
        let Some(end) = rest[close..].find([';', '{']).map(|end| close + end) else {
            continue;
        };
        if rest[end..].starts_with(';') {
            continue;
        }
        let length = end + closing(&rest[end..], '{', '}');
        let lines = rest[..length].matches('\n').count() + 1;
        found.push((code[..at].matches('\n').count() + 1, name, count, lines));
    }
    found
}

/// Where the list of arguments opens: the first parenthesis outside of generics.
fn parenthesis(text: &str) -> Option<usize> {
    let mut depth = 0;
    for (at, c) in text.char_indices() {
        match c {
            '<' => depth += 1,
            '>' if !text[..at].ends_with('-') => depth -= 1,
            '(' if depth == 0 => return Some(at),
            '{' | ';' => return None,
            _ => {}
        }
    }
    None
}

/// Where what opens at the first character closes.
fn closing(text: &str, open: char, close: char) -> usize {
    let mut depth = 0;
    for (at, c) in text.char_indices() {
        if c == open {
            depth += 1;
        } else if c == close {
            depth -= 1;
            if depth == 0 {
                return at;
            }
        }
    }
    text.len()
}

/// How many arguments a list has, `self` apart, members of a tuple each.
fn arguments(list: &str) -> usize {
    let of = |argument: &&str| match argument.trim().split_once(':') {
        Some((_, kind)) if kind.trim().starts_with('(') => {
            let inside = kind.trim().trim_start_matches('(').trim_end_matches(')');
            members(inside).len()
        }
        Some(_) => 1,
        None => 0,
    };
    members(list).iter().map(of).sum()
}

/// What stands between the commas of a list, brackets left whole.
fn members(list: &str) -> Vec<&str> {
    let mut all = Vec::new();
    let (mut depth, mut from) = (0, 0);
    for (at, c) in list.char_indices() {
        match c {
            '(' | '[' | '<' | '{' => depth += 1,
            '>' if list[..at].ends_with('-') => {}
            ')' | ']' | '}' | '>' => depth -= 1,
            ',' if depth == 0 => {
                all.push(&list[from..at]);
                from = at + 1;
            }
            _ => {}
        }
    }
    all.push(&list[from..]);
    all.retain(|member| !member.trim().is_empty());
    all
}

#[test]
fn no_function_is_long_or_takes_many_arguments() {
    let mut large = BTreeMap::new();
    let mut seen = 0;
    for file in source_files() {
        if file.name.ends_with("tests.rs") {
            continue;
        }
        for (line, name, arguments, lines) in functions(&file.product_code()) {
            seen += 1;
            if lines > MAX_LINES || arguments > MAX_ARGUMENTS {
                let size = format!("line {line}: {lines} lines, {arguments} arguments");
                large.insert(format!("{}: {name}", file.name), size);
            }
        }
    }
    assert!(seen > 2000, "only {seen} functions were looked at");
    for known in STILL_LARGE {
        let found = large.remove(*known);
        assert!(
            found.is_some(),
            "{known} is no longer large: remove it from the list"
        );
    }
    assert!(large.is_empty(), "{large:#?}");
}

#[test]
fn imports_and_functions_are_found_in_every_spelling() {
    let of = |code: &str| -> Vec<String> {
        paths(code)
            .into_iter()
            .map(|(_, path)| path.join("::"))
            .collect()
    };
    assert_eq!(of("use crate::plan::Route;"), ["crate::plan::Route"]);
    assert_eq!(
        of("pub use crate::{plan, cost::{Terms, self as c}};"),
        ["crate::plan", "crate::cost::Terms", "crate::cost::self"]
    );
    assert_eq!(
        of("let a = crate::link::f(super::spec::g());"),
        ["crate::link::f", "super::spec::g"]
    );
    let code = "fn a<F: Fn(u8) -> u8>(&self, x: (f64, Option<u8>), f: F) -> u8 {\n\n}\nfn b();";
    assert_eq!(functions(code), [(1, "a".to_owned(), 3, 3)]);
}
