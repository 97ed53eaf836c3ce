//! Text files of any origin: bytes to lines, lines to fields.

pub(super) mod field;
pub(super) mod number;

use super::{FormatError, Repair, SourceLocation};
use field::Field;

/// The text in the bytes of a file.
///
/// # Errors
/// [`FormatError::Text`] with the location of the first byte that is not UTF-8 text:
/// UTF-16, other encodings, NUL.
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

/// Fields of a row of a mission.
const FIELDS: usize = 12;

/// Splits a text into lines and fields and records every repair.
#[derive(Default)]
pub(super) struct TextReader {
    pub(super) repairs: Vec<Repair>,
    reported_separator: bool,
}

impl TextReader {
    pub(super) fn repair(&mut self, line: usize, column: usize, what: impl Into<String>) {
        self.repairs.push(Repair {
            at: SourceLocation::Text { line, column },
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

    /// Whether a line is empty or a comment.
    pub(super) fn is_blank(&mut self, number: usize, line: &str) -> bool {
        let text = line.trim();
        if text.starts_with('#') {
            self.repair(number, 1, "a comment was left out");
        } else if text.is_empty() {
            self.repair(number, 1, "an empty line was left out");
        }
        text.is_empty() || text.starts_with('#')
    }

    /// The fields between spaces or tabs.
    pub(super) fn words<'a>(&mut self, number: usize, line: &'a str) -> Vec<Field<'a>> {
        let words = self.without_comment(number, line).split_whitespace();
        words.map(|text| field(number, line, text)).collect()
    }

    /// Splits at tabs, else at commas, else at spaces; at tabs and spaces alike if a row
    /// has both between its fields, or is aligned with runs of tabs.
    pub(super) fn fields<'a>(
        &mut self,
        number: usize,
        line: &'a str,
    ) -> Result<Vec<Field<'a>>, FormatError> {
        let data = self.without_comment(number, line).trim_end();
        let separator = ['\t', ','].into_iter().find(|&c| data.contains(c));
        let parts: Vec<&str> = match separator {
            Some(separator) => data.split(separator).collect(),
            None => data.split_whitespace().collect(),
        };
        let has_spaces_too = |part: &&str| part.trim().contains(char::is_whitespace);
        let at_spaces_too = separator == Some('\t') && parts.iter().any(has_spaces_too);
        let is_aligned =
            separator == Some('\t') && is_aligned(data, at_spaces_too || parts.len() > FIELDS);
        let blank = parts.iter().find(|part| part.trim().is_empty());
        if let Some(part) = blank.filter(|_| !is_aligned) {
            let Field { column, .. } = field(number, line, part);
            return Err(FormatError::Text {
                line: number,
                column,
                found: "an empty field".to_owned(),
                allowed: "a number".to_owned(),
            });
        }
        let is_split_anywhere = at_spaces_too || (is_aligned && blank.is_some());
        let fields: Vec<Field<'_>> = if is_split_anywhere {
            self.words(number, data)
        } else {
            let parts = parts.iter().map(|part| field(number, line, part.trim()));
            parts.collect()
        };
        // A comma between decimals would make two fields of one number.
        if let Some(extra) = fields.get(FIELDS).filter(|_| separator == Some(',')) {
            return Err(FormatError::Text {
                line: number,
                column: extra.column,
                found: format!("{} fields separated by commas", fields.len()),
                allowed: "12 fields, with a point before decimals".to_owned(),
            });
        }
        let is_tidy = separator == Some('\t') && !data.contains(' ') && !is_split_anywhere;
        if !is_tidy && !self.reported_separator {
            self.reported_separator = true;
            self.repair(number, 1, "fields are not separated by single tabs");
        }
        Ok(fields)
    }

    fn without_comment<'a>(&mut self, number: usize, line: &'a str) -> &'a str {
        let Some((data, _)) = line.split_once('#') else {
            return line;
        };
        let column = data.chars().count() + 1;
        self.repair(number, column, "a comment was left out");
        data
    }
}

/// Whether the columns of a row are aligned with more than one tab between fields: it has as many
/// words as a mission has fields, and more tabs, or other gaps, than those need. What separates them
/// is one gap to Mission Planner and MAVProxy. With one tab each, a gap is a field that was lost.
fn is_aligned(data: &str, has_more_gaps: bool) -> bool {
    has_more_gaps && data.split_whitespace().count() == FIELDS
}

/// A part of a line with its column.
fn field<'a>(line: usize, whole: &str, text: &'a str) -> Field<'a> {
    let bytes = text.as_ptr().addr() - whole.as_ptr().addr();
    let column = whole[..bytes].chars().count() + 1;
    Field { text, line, column }
}
