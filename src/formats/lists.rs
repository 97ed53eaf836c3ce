//! The plain lists of older ground stations: `fence.txt` and `rally.txt`.
//!
//! A fence has a latitude and a longitude on each line: the return point, then the
//! corners of the inclusion polygon, the first corner again at the end. A rally list has
//! lines `RALLY lat lon alt break_alt land_dir flags`, metres above home (MAVProxy,
//! ArduPilot's autotest).

use super::document::{point_item, raised_item};
use super::text::TextReader;
use super::text::field::{float, scaled};
use super::{Document, FormatError};
use crate::mission::{command, frame};

/// Return point, three corners, and the first of them again.
const MIN_FENCE_LINES: usize = 5;

/// Reads a `fence.txt`.
///
/// # Errors
/// [`FormatError::Text`] for a line without two coordinates, and for too few lines.
pub fn read_fence(text: &str) -> Result<Document, FormatError> {
    let mut reader = TextReader::default();
    let text = reader.plain(text);
    let mut points = Vec::new();
    let mut last = 1;
    for (number, line) in (1..).zip(text.lines()) {
        if reader.is_blank(number, line) {
            continue;
        }
        let fields = reader.words(number, line);
        let [lat, lon] = fields[..] else {
            return Err(wrong_count(number, fields.len(), "latitude and longitude"));
        };
        points.push((scaled(lat, frame::GLOBAL)?, scaled(lon, frame::GLOBAL)?));
        last = number;
    }
    let count = points.len();
    if points.len() > 2 && points.last() != points.get(1) {
        reader.repair(last, 1, "the outline is not closed and was closed");
        points.extend(points.get(1).copied());
    }
    let [back, outline @ .., _] = points.as_slice() else {
        return Err(wrong_fence(last, count));
    };
    if points.len() < MIN_FENCE_LINES {
        return Err(wrong_fence(last, count));
    }
    let corners = u16::try_from(outline.len()).map_err(|_| wrong_fence(last, count))?;
    let mut fence = vec![point_item(command::NAV_FENCE_RETURN_POINT, 0.0, *back)];
    fence.extend(outline.iter().map(|corner| {
        let command = command::NAV_FENCE_POLYGON_VERTEX_INCLUSION;
        point_item(command, f32::from(corners), *corner)
    }));
    Ok(Document {
        fence,
        is_fence_known: true,
        repairs: reader.repairs,
        ..Document::default()
    })
}

/// Reads a `rally.txt`.
///
/// # Errors
/// [`FormatError::Text`] for a line that is no rally point.
pub fn read_rally(text: &str) -> Result<Document, FormatError> {
    let mut reader = TextReader::default();
    let text = reader.plain(text);
    let mut rally = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        if reader.is_blank(number, line) {
            continue;
        }
        let fields = reader.words(number, line);
        let [word, lat, lon, alt, rest @ ..] = fields.as_slice() else {
            return Err(wrong_count(number, fields.len(), RALLY_LINE));
        };
        if word.text != "RALLY" || rest.len() > 3 {
            return Err(wrong_count(number, fields.len(), RALLY_LINE));
        }
        for (name, field) in ["break altitude", "landing direction", "flags"]
            .iter()
            .zip(rest)
        {
            if float(*field)?.abs() > 0.0 {
                let what = format!("the {name} {} of a rally point was left out", field.text);
                reader.repair(number, field.column, what);
            }
        }
        let at = (scaled(*lat, frame::GLOBAL)?, scaled(*lon, frame::GLOBAL)?);
        rally.push(raised_item(command::NAV_RALLY_POINT, at, float(*alt)?));
    }
    Ok(Document {
        rally,
        repairs: reader.repairs,
        ..Document::default()
    })
}

const RALLY_LINE: &str = "RALLY lat lon alt break_alt land_dir flags";

fn wrong_count(line: usize, count: usize, allowed: &str) -> FormatError {
    FormatError::Text {
        line,
        column: 1,
        found: format!("{count} fields"),
        allowed: allowed.to_owned(),
    }
}

fn wrong_fence(line: usize, count: usize) -> FormatError {
    FormatError::Text {
        line,
        column: 1,
        found: format!("a fence of {count} points"),
        allowed: "a return point, then three corners or more, then the first corner again"
            .to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_fence_list_is_a_return_point_and_an_outline() {
        let text = "36.26 -84.26\n36.2 -84.3\n36.2 -84.2\n36.3 -84.2\n36.2 -84.3\n";
        let document = read_fence(text).expect("a fence");
        let commands: Vec<u16> = document.fence.iter().map(|item| item.command).collect();
        assert_eq!(commands, [5000, 5001, 5001, 5001]);
        assert_eq!(document.fence[1].params[0].to_bits(), 3.0_f32.to_bits());
        assert!(document.repairs.is_empty(), "{:?}", document.repairs);
    }

    #[test]
    fn an_open_outline_is_closed_with_a_repair() {
        let text = "36.26 -84.26\n36.2 -84.3\n36.2 -84.2\n36.3 -84.2\n";
        let document = read_fence(text).expect("a fence");
        assert_eq!(document.fence.len(), 4);
        assert_eq!(
            document.repairs[0].to_string(),
            "line 4, column 1: the outline is not closed and was closed"
        );
    }

    #[test]
    fn fields_that_no_rally_item_holds_are_repairs() {
        let document = read_rally("RALLY 36.26 -84.26 80.5 40 0 0\n").expect("a point");
        assert_eq!(document.rally[0].z.to_bits(), 80.5_f32.to_bits());
        assert_eq!(
            document.repairs[0].to_string(),
            "line 1, column 25: the break altitude 40 of a rally point was left out"
        );
    }

    proptest! {
        #[test]
        fn random_lists_never_panic(text in "(RALLY |[0-9#. \t\r\n\u{e9}-]|nan|1e9){0,80}") {
            let _ = read_fence(&text);
            let _ = read_rally(&text);
        }
    }
}
