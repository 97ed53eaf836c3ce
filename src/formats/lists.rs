//! The plain lists of older ground stations: `fence.txt` and `rally.txt`.
//!
//! A fence has a latitude and a longitude on each line: where to return to, then
//! the corners of the outline to stay in, the first of them again at the end. A
//! rally list has lines `RALLY lat lon alt break_alt land_dir flags`, metres above
//! home (MAVProxy, ArduPilot's autotest).

use super::text::Overlooked;
use super::text::field::{Field, float, scaled};
use super::{Document, FormatError};
use crate::mission::{Item, command, frame};

/// Return point, three corners, and the first of them again.
const LEAST_FENCE_LINES: usize = 5;

/// Reads a `fence.txt`.
///
/// # Errors
/// [`FormatError::Text`] for a line that is no place, and for too few of them.
pub fn read_fence(text: &str) -> Result<Document, FormatError> {
    let mut overlooked = Overlooked::default();
    let text = overlooked.plain(text);
    let mut places = Vec::new();
    let mut last = 1;
    for (number, line) in (1..).zip(text.lines()) {
        if overlooked.is_blank(number, line) {
            continue;
        }
        let fields = split(&mut overlooked, number, line);
        let [lat, lon] = fields[..] else {
            return Err(wrong_count(number, fields.len(), "latitude and longitude"));
        };
        places.push((scaled(lat, frame::GLOBAL)?, scaled(lon, frame::GLOBAL)?));
        last = number;
    }
    let count = places.len();
    if places.len() > 2 && places.last() != places.get(1) {
        overlooked.repair(last, 1, "the outline is not closed and was closed");
        places.extend(places.get(1).copied());
    }
    let [back, outline @ .., _] = places.as_slice() else {
        return Err(wrong_places(last, count));
    };
    if places.len() < LEAST_FENCE_LINES {
        return Err(wrong_places(last, count));
    }
    let corners = u16::try_from(outline.len()).map_err(|_| wrong_places(last, count))?;
    let item = |command, param1, &(x, y): &(i32, i32)| Item {
        command,
        frame: frame::GLOBAL,
        autocontinue: false,
        params: [param1, 0.0, 0.0, 0.0],
        x,
        y,
        z: 0.0,
    };
    let mut fence = vec![item(command::FENCE_RETURN_POINT, 0.0, back)];
    fence.extend(
        outline
            .iter()
            .map(|corner| item(command::FENCE_POLYGON_INCLUSION, f32::from(corners), corner)),
    );
    Ok(Document {
        fence,
        is_fence_known: true,
        repairs: overlooked.repairs,
        ..Document::default()
    })
}

/// Reads a `rally.txt`.
///
/// # Errors
/// [`FormatError::Text`] for a line that is no rally point.
pub fn read_rally(text: &str) -> Result<Document, FormatError> {
    let mut overlooked = Overlooked::default();
    let text = overlooked.plain(text);
    let mut rally = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        if overlooked.is_blank(number, line) {
            continue;
        }
        let fields = split(&mut overlooked, number, line);
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
                overlooked.repair(number, field.column, what);
            }
        }
        rally.push(Item {
            command: command::RALLY_POINT,
            frame: frame::GLOBAL_RELATIVE_ALT,
            autocontinue: false,
            params: [0.0; 4],
            x: scaled(*lat, frame::GLOBAL)?,
            y: scaled(*lon, frame::GLOBAL)?,
            z: float(*alt)?,
        });
    }
    Ok(Document {
        rally,
        repairs: overlooked.repairs,
        ..Document::default()
    })
}

const RALLY_LINE: &str = "RALLY lat lon alt break_alt land_dir flags";

/// Fields between spaces or tabs, without what follows a `#`.
fn split<'a>(overlooked: &mut Overlooked, number: usize, line: &'a str) -> Vec<Field<'a>> {
    let data = line.split('#').next().unwrap_or_default();
    if data.len() != line.len() {
        let column = data.chars().count() + 1;
        overlooked.repair(number, column, "a comment was left out");
    }
    let column = |word: &str| {
        let bytes = word.as_ptr().addr() - line.as_ptr().addr();
        line[..bytes].chars().count() + 1
    };
    data.split_whitespace()
        .map(|text| Field {
            text,
            line: number,
            column: column(text),
        })
        .collect()
}

fn wrong_count(line: usize, count: usize, allowed: &str) -> FormatError {
    FormatError::Text {
        line,
        column: 1,
        found: format!("{count} fields"),
        allowed: allowed.to_owned(),
    }
}

fn wrong_places(line: usize, count: usize) -> FormatError {
    FormatError::Text {
        line,
        column: 1,
        found: format!("a fence of {count} places"),
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
    fn an_open_outline_is_closed_and_told() {
        let text = "36.26 -84.26\n36.2 -84.3\n36.2 -84.2\n36.3 -84.2\n";
        let document = read_fence(text).expect("a fence");
        assert_eq!(document.fence.len(), 4);
        assert_eq!(
            document.repairs[0].to_string(),
            "line 4, column 1: the outline is not closed and was closed"
        );
    }

    #[test]
    fn a_rally_list_tells_what_a_rally_item_has_no_place_for() {
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
