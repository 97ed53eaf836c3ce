//! The source of the crate as text: files, modules, code without comments and strings.

use std::fs;
use std::path::{Path, PathBuf};

/// A file of `src`.
pub struct SourceFile {
    /// Path below `src`, with forward slashes.
    pub name: String,
    /// Module path: `plan/fleet/mod.rs` is `["plan", "fleet"]`, `lib.rs` is empty.
    pub module: Vec<String>,
    /// The text as it is.
    pub text: String,
}

impl SourceFile {
    /// The text with comments, strings and characters blanked: same lines, same columns.
    pub fn code(&self) -> String {
        blank(&self.text, false)
    }

    /// The code above the inline tests at the end of the file.
    pub fn product_code(&self) -> String {
        let code = self.code();
        match code.find("#[cfg(test)]\nmod ") {
            Some(at) if code[at..].contains('{') => code[..at].to_owned(),
            _ => code,
        }
    }

    /// Comments and strings only, by line.
    pub fn prose(&self) -> String {
        blank(&self.text, true)
    }
}

/// All files of `src`.
pub fn source_files() -> Vec<SourceFile> {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut paths = Vec::new();
    collect(&src, &mut paths);
    paths.sort();
    assert!(paths.len() > 300, "only {} files in src", paths.len());
    let read = |path: PathBuf| {
        let inside = path.strip_prefix(&src).expect("a file of src");
        let mut module: Vec<String> = inside
            .with_extension("")
            .iter()
            .map(|part| part.to_str().expect("an ASCII name").to_owned())
            .collect();
        if matches!(module.last().map(String::as_str), Some("mod" | "lib")) {
            module.pop();
        }
        SourceFile {
            name: inside.to_str().expect("an ASCII name").replace('\\', "/"),
            module,
            text: fs::read_to_string(&path).expect("a source file"),
        }
    };
    paths.into_iter().map(read).collect()
}

fn collect(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("src can be read") {
        let path = entry.expect("src can be read").path();
        if path.is_dir() {
            collect(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// Blanks comments and literals, or all else.
fn blank(text: &str, keep_prose: bool) -> String {
    let bytes: Vec<char> = text.chars().collect();
    let mut out = String::with_capacity(text.len());
    let mut at = 0;
    let push = |out: &mut String, c: char, is_prose: bool| {
        out.push(if c == '\n' || is_prose == keep_prose {
            c
        } else {
            ' '
        });
    };
    while at < bytes.len() {
        let end = prose_end(&bytes, at);
        if end == at {
            push(&mut out, bytes[at], false);
            at += 1;
        } else {
            bytes[at..end].iter().for_each(|c| push(&mut out, *c, true));
            at = end;
        }
    }
    out
}

/// Where the comment or literal that begins here ends; here, where none begins.
fn prose_end(text: &[char], at: usize) -> usize {
    let find = |from: usize, wanted: &[char]| {
        (from..text.len())
            .find(|i| text[*i..].starts_with(wanted))
            .unwrap_or(text.len())
    };
    let is_word = |i: usize| text[i].is_alphanumeric() || text[i] == '_';
    match text[at] {
        '/' if text.get(at + 1) == Some(&'/') => find(at, &['\n']),
        '/' if text.get(at + 1) == Some(&'*') => find(at, &['*', '/']) + 2,
        'r' if at == 0 || !is_word(at - 1) || text[at - 1] == 'b' => {
            let hashes = text[at + 1..].iter().take_while(|c| **c == '#').count();
            if text.get(at + 1 + hashes) != Some(&'"') {
                return at;
            }
            let close: Vec<char> = std::iter::once('"')
                .chain(std::iter::repeat_n('#', hashes))
                .collect();
            (find(at + 2 + hashes, &close) + 1 + hashes).min(text.len())
        }
        '"' => {
            let mut end = at + 1;
            while end < text.len() && text[end] != '"' {
                end += 1 + usize::from(text[end] == '\\');
            }
            (end + 1).min(text.len())
        }
        '\'' if text.get(at + 1) == Some(&'\\') => find(at + 3, &['\'']) + 1,
        '\'' if text.get(at + 2) == Some(&'\'') => at + 3,
        _ => at,
    }
}
