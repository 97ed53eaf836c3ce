//! Text files of any origin: bytes to lines, lines to fields.

pub(super) mod field;
pub(super) mod number;

use super::{FormatError, Repair, Spot};
use field::Field;

/// The text in the bytes of a file.
///
/// # Errors
/// [`FormatError::Text`] with the place of the first byte that is no text: UTF-16,
/// other encodings, NUL.
pub(super) fn decoded(bytes: &[u8]) -> Result<&str, FormatError> {
    let bad = |at: usize, found: &str, allowed: &str| {
        let before = String::from_utf8_lossy(&bytes[..at]);
        let line = before.matches('\n').count() + 1;
        let column = before.chars().rev().take_while(|&c| c != '\n').count() + 1;
        Err(FormatError::Text {
            line,
            column,
            found: found.to_owned(),
            allowed: allowed.to_owned(),
        })
    };
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return bad(0, "UTF-16", "text saved as UTF-8");
    }
    if let Some(at) = bytes.iter().position(|&byte| byte == 0) {
        return bad(at, "a NUL byte", "text in UTF-8");
    }
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(text),
        Err(error) => bad(
            error.valid_up_to(),
            "a byte that is not UTF-8",
            "text in UTF-8",
        ),
    }
}

/// What had to be overlooked in a text.
#[derive(Default)]
pub(super) struct Overlooked {
    pub(super) repairs: Vec<Repair>,
    told_separator: bool,
}

impl Overlooked {
    pub(super) fn repair(&mut self, line: usize, column: usize, what: impl Into<String>) {
        self.repairs.push(Repair {
            at: Spot::Text { line, column },
            what: what.into(),
        });
    }

    /// The text without byte order mark and carriage returns.
    pub(super) fn plain(&mut self, text: &str) -> String {
        let plain = text.strip_prefix('\u{feff}').unwrap_or(text);
        if plain.len() != text.len() {
            self.repair(1, 1, "a byte order mark was left out");
        }
        let unix = plain.replace("\r\n", "\n").replace('\r', "\n");
        if let Some(at) = plain.find('\r') {
            let line = plain[..at].matches('\n').count() + 1;
            self.repair(line, 1, "carriage returns were taken as line ends");
        }
        if !unix.ends_with('\n') {
            let line = unix.lines().count().max(1);
            self.repair(line, 1, "the last line has no line end");
        }
        unix
    }

    /// Whether a line has nothing to read.
    pub(super) fn is_blank(&mut self, number: usize, line: &str) -> bool {
        let text = line.trim();
        if text.starts_with('#') {
            self.repair(number, 1, "a comment was left out");
        } else if text.is_empty() {
            self.repair(number, 1, "an empty line was left out");
        }
        text.is_empty() || text.starts_with('#')
    }

    /// Splits at tabs, or at commas if there is no tab, or at spaces if neither.
    pub(super) fn fields<'a>(
        &mut self,
        number: usize,
        line: &'a str,
    ) -> Result<Vec<Field<'a>>, FormatError> {
        let (data, comment) = match line.split_once('#') {
            Some((data, _)) => (data, true),
            None => (line, false),
        };
        if comment {
            let column = data.chars().count() + 1;
            self.repair(number, column, "a comment was left out");
        }
        let data = data.trim_end();
        let separator = if data.contains('\t') {
            '\t'
        } else if data.contains(',') {
            ','
        } else {
            ' '
        };
        let mut fields = Vec::new();
        let mut column = 1;
        let mut untidy = separator != '\t';
        for part in data.split(separator) {
            let text = part.trim();
            let lead = part.chars().take_while(|c| c.is_whitespace()).count();
            untidy |= text.len() != part.len();
            if !text.is_empty() {
                fields.push(Field {
                    text,
                    line: number,
                    column: column + lead,
                });
            } else if separator != ' ' {
                return Err(FormatError::Text {
                    line: number,
                    column,
                    found: "an empty field".to_owned(),
                    allowed: "a number".to_owned(),
                });
            }
            column += part.chars().count() + 1;
        }
        // A comma between decimals would make two fields of one number.
        if let Some(extra) = fields.get(12).filter(|_| separator == ',') {
            return Err(FormatError::Text {
                line: number,
                column: extra.column,
                found: format!("{} fields separated by commas", fields.len()),
                allowed: "12 fields, with a point before decimals".to_owned(),
            });
        }
        if untidy && !self.told_separator {
            self.told_separator = true;
            self.repair(number, 1, "fields are not separated by single tabs");
        }
        Ok(fields)
    }
}
