//! Mission files of any format, detected from their content.

use super::{Document, FormatError, lists, plan, text, waypoints};

/// Format of a mission file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// `QGC WPL`: a mission, or a fence or rally points in the same layout.
    Waypoints,
    /// A `.plan` of QGroundControl.
    Plan,
    /// A `fence.txt`.
    FenceList,
    /// A `rally.txt`.
    RallyList,
}

/// Reads a mission file of any kind from its bytes.
///
/// # Errors
/// [`FormatError::Text`] when it is not text or of no known format, and the errors of
/// the reader of its format.
pub fn read(bytes: &[u8]) -> Result<(Kind, Document), FormatError> {
    let text = text::decoded(bytes)?;
    let kind = kind(text)?;
    let document = match kind {
        Kind::Waypoints => waypoints::read(text),
        Kind::Plan => plan::read(text),
        Kind::FenceList => lists::read_fence(text),
        Kind::RallyList => lists::read_rally(text),
    }?;
    Ok((kind, document))
}

/// Characters of an unknown first line that a message shows.
const MAX_SHOWN: usize = 40;
/// The formats that are read, in messages.
const ALLOWED: &str = "QGC WPL 110 or 120, a .plan (JSON), a fence or a rally list";

/// The format, by the first line that is neither empty nor a comment.
fn kind(text: &str) -> Result<Kind, FormatError> {
    let lines = text.trim_start_matches('\u{feff}').lines().enumerate();
    let mut lines = lines.map(|(index, line)| (index + 1, line.trim()));
    let Some((number, first)) = lines.find(|(_, line)| !line.is_empty() && !line.starts_with('#'))
    else {
        return Err(FormatError::Text {
            line: 1,
            column: 1,
            found: "an empty file".to_owned(),
            allowed: ALLOWED.to_owned(),
        });
    };
    let mut words = first.split_whitespace();
    Ok(match first.chars().next() {
        Some('{' | '[') => Kind::Plan,
        Some('<') => {
            return Err(FormatError::Text {
                line: number,
                column: 1,
                found: "XML, such as KML or GPX".to_owned(),
                allowed: ALLOWED.to_owned(),
            });
        }
        _ if words.clone().next() == Some("RALLY") => Kind::RallyList,
        _ if words.clone().count() == 2 && words.all(|word| word.parse::<f64>().is_ok()) => {
            Kind::FenceList
        }
        _ if first
            .get(..3)
            .is_some_and(|start| start.eq_ignore_ascii_case("QGC")) =>
        {
            Kind::Waypoints
        }
        _ => {
            let found: String = first.chars().take(MAX_SHOWN).collect();
            return Err(FormatError::Text {
                line: number,
                column: 1,
                found: format!("{found:?}"),
                allowed: ALLOWED.to_owned(),
            });
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_are_detected_from_the_content() {
        let row = "0\t1\t0\t16\t0\t0\t0\t0\t36.1\t-84.2\t400\t1\n";
        let wpl = format!("# by hand\nQGC WPL 110\n{row}");
        assert_eq!(
            read(wpl.as_bytes()).map(|(kind, _)| kind),
            Ok(Kind::Waypoints)
        );
        assert_eq!(kind("\u{feff} {}"), Ok(Kind::Plan));
        assert_eq!(kind("RALLY 1 2 3 0 0 0"), Ok(Kind::RallyList));
        assert_eq!(kind("\n36.1 -84.2\n"), Ok(Kind::FenceList));
        assert!(kind("<kml>").is_err());
    }

    #[test]
    fn a_file_that_is_empty_or_of_no_format_is_answered_with_all_of_them() {
        for (text, found) in [
            ("", "an empty file"),
            ("\n # none\n", "an empty file"),
            ("items: []", "\"items: []\""),
        ] {
            let error = kind(text).expect_err("no format").to_string();
            assert!(
                error.contains(found) && error.contains(".plan (JSON)"),
                "{error}"
            );
        }
    }

    #[test]
    fn bytes_that_are_not_text_are_reported_with_their_location() {
        let error = |bytes: &[u8]| read(bytes).expect_err("no text").to_string();
        assert!(error(b"\xff\xfeQ\0").starts_with("line 1, column 1: UTF-16"));
        assert!(error(b"QGC\nWP\0").starts_with("line 2, column 3: a NUL byte"));
        assert!(error(b"QGC \xe9").starts_with("line 1, column 5: a byte that is not UTF-8"));
    }
}
