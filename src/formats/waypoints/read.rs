//! Reads `.waypoints` files of any origin and reports every repair.

use crate::formats::text::TextReader;
use crate::formats::text::field::{Field, byte, command_number, float, scaled, whole};
use crate::formats::text::number;
use crate::formats::{Document, FormatError};
use crate::mission::{Home, Item, command, frame};

/// Reads a mission, or a fence or rally list in the same layout.
///
/// # Errors
/// [`FormatError::Text`] for a header other than 110 or 120, a row of fewer than
/// eleven fields, a field that is no number, a coordinate out of range, a home row in
/// a frame without a place, and a jump among misnumbered rows.
pub fn read(text: &str) -> Result<Document, FormatError> {
    let mut reader = Reader::default();
    let text = reader.text.plain(text);
    let mut lines = text
        .lines()
        .enumerate()
        .map(|(index, line)| (index + 1, line));
    let has_home = loop {
        let Some((number, line)) = lines.next() else {
            return Err(no_header(1, "an empty file"));
        };
        if !reader.text.is_blank(number, line) {
            break reader.header(number, line)?;
        }
    };
    for (number, line) in lines {
        if !reader.text.is_blank(number, line) {
            reader.row(number, line, has_home)?;
        }
    }
    reader.finish()
}

fn no_header(line: usize, found: &str) -> FormatError {
    FormatError::Text {
        line,
        column: 1,
        found: found.to_owned(),
        allowed: "QGC WPL 110 or QGC WPL 120".to_owned(),
    }
}

#[derive(Default)]
struct Reader {
    document: Document,
    rows: usize,
    /// Row of the first item: 1 after a home row.
    first_item: Option<usize>,
    /// The first row whose number is not its place.
    misnumbered: Option<usize>,
    /// Line and column of the first jump.
    jump: Option<(usize, usize)>,
    text: TextReader,
}

impl Reader {
    /// Without a home row the file counts its items from 0: one less than a row.
    fn finish(mut self) -> Result<Document, FormatError> {
        if let (Some(row), Some((line, column))) = (self.misnumbered, self.jump) {
            return Err(FormatError::Text {
                line,
                column,
                found: format!("a jump, and line {row} is misnumbered"),
                allowed: "rows numbered one after the other, so that a jump has one target"
                    .to_owned(),
            });
        }
        if self.first_item == Some(0) {
            for item in &mut self.document.items {
                if item.command == command::DO_JUMP {
                    item.params[0] += 1.0;
                }
            }
        }
        self.document.repairs = self.text.repairs;
        Ok(self.document)
    }

    fn repair(&mut self, line: usize, column: usize, what: impl Into<String>) {
        self.text.repair(line, column, what);
    }

    /// Whether the file has a home row.
    fn header(&mut self, number: usize, line: &str) -> Result<bool, FormatError> {
        let words: Vec<&str> = line.split_whitespace().collect();
        let has_home = match words.as_slice() {
            ["QGC", "WPL", "110"] => true,
            ["QGC", "WPL", "120"] => {
                self.repair(number, 1, "version 120 has no home row");
                false
            }
            _ => {
                let found: String = line.chars().take(40).collect();
                return Err(no_header(number, &format!("{found:?}")));
            }
        };
        if line.len() != "QGC WPL 110".len() {
            self.repair(number, 1, "spaces in the header were left out");
        }
        Ok(has_home)
    }

    fn row(&mut self, number: usize, line: &str, has_home: bool) -> Result<(), FormatError> {
        let fields = self.text.fields(number, line)?;
        let field = |index: usize| {
            fields.get(index).copied().ok_or_else(|| FormatError::Text {
                line: number,
                column: 1,
                found: format!("{} fields", fields.len()),
                allowed: "12 fields".to_owned(),
            })
        };
        // Counted before any of them is read: a row that lost a field in the middle
        // has its altitude where its longitude belongs.
        field(10)?;
        let row = field(0)?;
        let sequence = whole(row, u32::from(u16::MAX))?;
        let current = field(1)?;
        if whole(current, 255)? > 0 && self.rows > 0 {
            let what = format!(
                "row {sequence} is marked as current: the mission is read from its first item"
            );
            self.repair(number, current.column, what);
        }
        let frame = byte(field(2)?)?;
        let item = Item {
            command: command_number(field(3)?)?,
            frame,
            autocontinue: match fields.get(11) {
                Some(&field) => whole(field, 1)? == 1,
                None => {
                    self.repair(number, 1, "autocontinue is missing and was taken as 1");
                    true
                }
            },
            params: [
                float(field(4)?)?,
                float(field(5)?)?,
                float(field(6)?)?,
                float(field(7)?)?,
            ],
            x: scaled(field(8)?, frame)?,
            y: scaled(field(9)?, frame)?,
            z: float(field(10)?)?,
        };
        if let Some(extra) = fields.get(12) {
            self.repair(
                number,
                extra.column,
                "fields after the twelfth were left out",
            );
        }
        for at in [8, 9] {
            let value = fields.get(at).and_then(|field| field.text.parse().ok());
            if let Some(text) = value.and_then(|value| number::rounded(frame, value)) {
                let text = format!("line {}: {text}", row.line);
                self.document.dropped.push(text);
            }
        }
        self.place(row, sequence, item, has_home)
    }

    /// Decides whether a row is home or an item.
    fn place(
        &mut self,
        row: Field<'_>,
        sequence: u32,
        item: Item,
        has_home: bool,
    ) -> Result<(), FormatError> {
        let Field { line, column, .. } = row;
        if self.rows == 0
            && has_home
            && sequence == 0
            && [0, command::NAV_WAYPOINT].contains(&item.command)
        {
            self.rows = 1;
            return self.home(row, &item);
        }
        let is_mission =
            !(command::NAV_FENCE_RETURN_POINT..=command::NAV_RALLY_POINT).contains(&item.command);
        if self.rows == 0 && has_home {
            if is_mission {
                let what = format!(
                    "row {sequence} (command {}) is no home row and was taken as the first item",
                    item.command
                );
                self.repair(line, column, what);
                self.document.in_home_row = (sequence == 0).then_some(item.command);
            }
            // Its own number shows whether a home row was counted.
            self.rows = usize::from(sequence == 1);
        }
        self.first_item.get_or_insert(self.rows);
        if usize::try_from(sequence) != Ok(self.rows) {
            let what = format!("row {sequence} was taken as row {}", self.rows);
            self.repair(line, column, what);
            self.misnumbered.get_or_insert(line);
        }
        if item.command == command::DO_JUMP {
            self.jump.get_or_insert((line, column));
        }
        self.rows += 1;
        self.document.add(item);
        Ok(())
    }

    fn home(&mut self, row: Field<'_>, item: &Item) -> Result<(), FormatError> {
        let Field { line, column, .. } = row;
        if (item.x, item.y) == (0, 0) {
            self.repair(line, column, "the home row is empty: no home position");
            return Ok(());
        }
        match frame::canonical(item.frame) {
            frame::GLOBAL => {}
            // Ground stations write this, and ArduPilot puts its own home there.
            frame::GLOBAL_RELATIVE_ALT | frame::GLOBAL_TERRAIN_ALT => {
                let what = format!(
                    "home in frame {} has no altitude above mean sea level: its altitude {} was \
                     ignored and must come from --home or the terrain",
                    item.frame, item.z
                );
                self.repair(line, column, what);
                self.document.home_place = item.place();
                return Ok(());
            }
            _ => {
                return Err(FormatError::Text {
                    line,
                    column,
                    found: format!("home in frame {}", item.frame),
                    allowed: "frame 0: the altitude of home is above mean sea level".to_owned(),
                });
            }
        }
        if !item.z.is_finite() {
            return Err(FormatError::Text {
                line,
                column,
                found: format!("home at {} m", item.z),
                allowed: "an altitude above mean sea level".to_owned(),
            });
        }
        if item
            .params
            .iter()
            .any(|value| !value.is_finite() || value.abs() > 0.0)
        {
            self.document
                .dropped
                .push(format!("line {line}: the parameters of the home row"));
        }
        self.document.home = Some(Home {
            x: item.x,
            y: item.y,
            amsl_m: item.z,
        });
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::read;
    use crate::formats::SourceLocation;
    use crate::geodesy::LatLon;
    use proptest::prelude::*;

    #[test]
    fn a_missing_field_is_reported_with_its_line() {
        let error =
            read("QGC WPL 110\n0\t1\t0\t16\t0\t0\t0\t0\t36.1\t-84.2\n").expect_err("ten fields");
        assert_eq!(
            error.to_string(),
            "line 2, column 1: 10 fields (allowed: 12 fields)"
        );
    }

    #[test]
    fn a_word_among_the_numbers_is_reported_with_line_and_column() {
        let error = read("QGC WPL 110\n0\t1\t0\t16\t0\t0\tabc\t0\t36.1\t-84.2\t400\t1\n")
            .expect_err("a word");
        assert_eq!(
            error.to_string(),
            "line 2, column 14: \"abc\" (allowed: a number)"
        );
    }

    #[test]
    fn home_in_frame_3_has_a_place_without_an_altitude() {
        let document =
            read("QGC WPL 110\n0\t1\t3\t16\t0\t0\t0\t0\t36.1\t-84.2\t0\t1\n").expect("readable");
        assert_eq!(document.home, None);
        assert_eq!(document.home_place, LatLon::new(36.1, -84.2).ok());
        assert!(document.repairs[0].what.contains("--home or the terrain"));
    }

    #[test]
    fn home_in_a_frame_without_a_place_is_refused() {
        let error =
            read("QGC WPL 110\n0\t1\t2\t16\t0\t0\t0\t0\t36\t-84\t0\t1\n").expect_err("frame 2");
        assert!(
            error.to_string().contains("above mean sea level"),
            "{error}"
        );
    }

    #[test]
    fn other_headers_are_refused() {
        for text in ["", "\n", "QGC WPL 100\n", "QGC WPL\n", "{}"] {
            let error = read(text).expect_err("no header");
            assert!(error.to_string().contains("QGC WPL 110"), "{error}");
        }
    }

    #[test]
    fn spaces_commas_crlf_comments_names_and_a_missing_last_newline_are_repaired() {
        let text = "\u{feff}QGC WPL 110\r\n# made by hand\r\n\
            0,1,0,16,0,0,0,0,36.1,-84.2,400,1\r\n\r\n\
            1 0 3 NAV_TAKEOFF 0 0 0 0 36.1 -84.2 30\r\n\
            5\t0\t3\t16.0\t0\t0\t0\t0\t36.2\t-84.2\t30\t1\t9 # last";
        let document = read(text).expect("readable");
        assert_eq!(document.home.map(|home| home.x), Some(361_000_000));
        let commands: Vec<u16> = document.items.iter().map(|item| item.command).collect();
        assert_eq!(commands, [22, 16]);
        let repairs: Vec<(usize, &str)> = document
            .repairs
            .iter()
            .map(|r| match r.at {
                SourceLocation::Text { line, .. } => (line, r.what.as_str()),
                SourceLocation::Json(_) => (0, r.what.as_str()),
            })
            .collect();
        assert_eq!(
            repairs,
            [
                (1, "a byte order mark was left out"),
                (1, "carriage returns were taken as line ends"),
                (6, "the last line has no line end"),
                (2, "a comment was left out"),
                (3, "fields are not separated by single tabs"),
                (4, "an empty line was left out"),
                (5, "autocontinue is missing and was taken as 1"),
                (6, "a comment was left out"),
                (6, "fields after the twelfth were left out"),
                (6, "row 5 was taken as row 2"),
            ]
        );
    }

    #[test]
    fn version_120_and_an_empty_home_row_have_no_home() {
        let row = "\t0\t0\t0\t0\t36.1\t-84.2\t30\t1\n";
        let without = read(&format!("QGC WPL 120\n0\t1\t3\t22{row}")).expect("readable");
        assert_eq!((without.home, without.items.len()), (None, 1));
        let empty = format!("QGC WPL 110\n0\t1\t0\t0\t0\t0\t0\t0\t0\t0\t0\t1\n1\t0\t3\t22{row}");
        let empty = read(&empty).expect("readable");
        assert_eq!((empty.home, empty.items.len()), (None, 1));
        let first = read(&format!("QGC WPL 110\n0\t1\t3\t22{row}")).expect("readable");
        assert_eq!((first.home, first.items.len()), (None, 1));
        assert!(first.repairs[0].what.contains("no home row"));
    }

    #[test]
    fn fence_and_rally_rows_go_to_their_lists() {
        let text = "QGC WPL 110\n\
            0\t0\t0\t5004\t300\t0\t0\t0\t36.1\t-84.2\t0\t1\n\
            1\t0\t3\t5100\t0\t0\t0\t0\t36.1\t-84.2\t30\t1\n";
        let document = read(text).expect("readable");
        assert_eq!(
            (
                document.items.len(),
                document.fence.len(),
                document.rally.len()
            ),
            (0, 1, 1)
        );
        assert!(document.repairs.is_empty(), "{:?}", document.repairs);
    }

    proptest! {
        #[test]
        fn random_text_never_panics(text in any::<String>()) {
            let _ = read(&text);
        }

        #[test]
        fn random_rows_never_panic(rows in "([0-9#,. \t\r\n\u{e9}-]|nan|inf|1e9|16){0,200}") {
            let _ = read(&format!("QGC WPL 110\n{rows}"));
        }

        #[test]
        fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
            let _ = read(&String::from_utf8_lossy(&bytes));
        }
    }
}
