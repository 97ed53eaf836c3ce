//! Names: of files, of vehicles, of threats and zones.

use std::collections::BTreeMap;

use super::Checker;

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
            self.report(path, format!("name `{}`", name.escape_debug()), allowed);
        } else if is_device(name) {
            let found = format!("name `{name}`, which is a device to Windows");
            self.report(path, found, "another name");
        }
    }

    /// A name that is only shown.
    pub(super) fn label(&mut self, path: &str, name: &str) {
        if name.trim().is_empty() || name.len() > MAX_BYTES || name.chars().any(char::is_control) {
            let allowed = format!("1 to {MAX_BYTES} printable bytes");
            self.report(path, format!("name `{}`", name.escape_debug()), allowed);
        }
    }

    /// Names of one list, `path[i].id`, differ in more than case: some file systems ignore case.
    pub(super) fn unique<'n>(&mut self, path: &str, names: impl Iterator<Item = Option<&'n str>>) {
        let mut seen: BTreeMap<String, usize> = BTreeMap::new();
        for (index, name) in names.enumerate() {
            let Some(name) = name else { continue };
            if let Some(first) = seen.get(&name.to_lowercase()) {
                let found = format!(
                    "`{}`, already the id of {}",
                    name.escape_debug(),
                    self.sources.name(&format!("{path}[{first}]"))
                );
                self.report(&format!("{path}[{index}].id"), found, "unique ids");
            } else {
                seen.insert(name.to_lowercase(), index);
            }
        }
    }
}
