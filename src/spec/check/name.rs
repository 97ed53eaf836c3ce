//! Names: of files, of vehicles, of threats and zones.

use std::collections::BTreeMap;

use unicode_security::{MixedScript, skeleton};

use super::Checker;
use crate::numeric::text::is_hidden;

/// Longest name, bytes: with its ending it still is a file name everywhere.
const MAX_BYTES: usize = 64;

/// Whether Windows takes a file of this name, with any ending, for a device.
fn is_device(name: &str) -> bool {
    let name = name.to_lowercase();
    let port = |kind| {
        let number = name.strip_prefix(kind).unwrap_or_default();
        number.chars().count() == 1 && number.contains(|c| "123456789¹²³".contains(c))
    };
    ["con", "nul", "prn", "aux"].contains(&name.as_str()) || port("com") || port("lpt")
}

/// A character by its code point, such as `U+202E`.
fn code(sign: char) -> String {
    format!("U+{:04X}", u32::from(sign))
}

impl Checker {
    /// A name that becomes part of a file name. Without dots, so that the files
    /// of `a` (`a.*`) are never those of another vehicle `a.b`.
    pub(super) fn file_name(&mut self, path: &str, name: &str) {
        let good = name.len() <= MAX_BYTES
            && name.starts_with(char::is_alphanumeric)
            && name
                .chars()
                .all(|c| c.is_alphanumeric() || c == '-' || c == '_');
        if !good {
            let allowed = format!(
                "letters, digits, - and _, first a letter or digit, at most {MAX_BYTES} bytes"
            );
            let hidden = name.chars().find(|sign| is_hidden(*sign));
            let with = hidden.map_or_else(String::new, |sign| {
                format!(" with the invisible character {}", code(sign))
            });
            self.report(
                path,
                format!("name `{}`{with}", name.escape_debug()),
                allowed,
            );
        } else if is_device(name) {
            let found = format!("name `{name}`, which is a device to Windows");
            self.report(path, found, "another name");
        } else {
            self.one_script(path, name, name);
        }
    }

    /// A name that is only shown.
    pub(super) fn label(&mut self, path: &str, name: &str) {
        let shown = name.escape_debug();
        if let Some(hidden) = name.chars().find(|sign| is_hidden(*sign)) {
            let found = format!(
                "name `{shown}` with the invisible character {}",
                code(hidden)
            );
            self.report(path, found, "visible characters");
        } else if name.trim().is_empty() || name.len() > MAX_BYTES {
            let allowed = format!("1 to {MAX_BYTES} printable bytes");
            self.report(path, format!("name `{shown}`"), allowed);
        } else {
            let mut words = name.split(|sign: char| !sign.is_alphanumeric());
            let _ = words.all(|word| self.one_script(path, name, word));
        }
    }

    /// The letters of a word belong to one script, or to several that are written together
    /// (UTS #39, section 5.1): a Cyrillic letter among Latin ones looks like another name.
    fn one_script(&mut self, path: &str, name: &str, word: &str) -> bool {
        let ends = word
            .char_indices()
            .map(|(at, sign)| (at + sign.len_utf8(), sign));
        let mut mixed = ends.filter(|(end, _)| !word[..*end].is_single_script());
        let Some((_, sign)) = mixed.next() else {
            return true;
        };
        let found = format!(
            "name `{name}` with the character `{sign}` ({}) among letters of another script",
            code(sign)
        );
        self.report(path, found, "letters of one script");
        false
    }

    /// Names of one list, `path[i].id`, differ in more than case, which file systems may not
    /// see, and do not look alike (UTS #39, section 4) unless all are ASCII.
    pub(super) fn unique<'n>(&mut self, path: &str, names: impl Iterator<Item = Option<&'n str>>) {
        let mut seen: BTreeMap<String, usize> = BTreeMap::new();
        let mut alike: BTreeMap<String, (usize, bool)> = BTreeMap::new();
        for (index, name) in names.enumerate() {
            let Some(name) = name else { continue };
            let (lowercase, is_ascii) = (name.to_lowercase(), name.is_ascii());
            let look: String = skeleton(&lowercase).collect();
            let first = seen
                .get(&lowercase)
                .copied()
                .map(|first| (first, "already"));
            let first = first.or_else(|| {
                let (first, other_is_ascii) = *alike.get(&look)?;
                (!is_ascii || !other_is_ascii).then_some((first, "which looks like"))
            });
            if let Some((first, is)) = first {
                let found = format!(
                    "`{}`, {is} the id of {}",
                    name.escape_debug(),
                    self.sources.name(&format!("{path}[{first}]"))
                );
                self.report(&format!("{path}[{index}].id"), found, "unique ids");
            } else {
                seen.insert(lowercase, index);
                alike.entry(look).or_insert((index, is_ascii));
            }
        }
    }
}
