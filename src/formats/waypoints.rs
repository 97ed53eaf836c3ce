//! `QGC WPL 110`: twelve columns of text, degrees, row 0 is home.
//!
//! The writer uses the form that every reader accepts: LF, TAB, exact 1e-7 degrees, no
//! exponents, no NaN. The reader also accepts other separators, line ends, comments, and
//! the header 120, which has no home row.

mod read;

use super::document::rows;
use super::text::number::coordinate_text;
use crate::mission::{Item, VehicleMission, command, frame};

pub use read::read;

/// The mission as text, without fence, rally points and parameters.
///
/// A NaN is written as 0, because readers differ in whether they take "nan"
/// ([`super::losses`]).
#[must_use]
pub fn write(mission: &VehicleMission) -> String {
    let home = Item {
        command: command::NAV_WAYPOINT,
        frame: frame::GLOBAL,
        autocontinue: true,
        params: [0.0; 4],
        x: mission.home.x,
        y: mission.home.y,
        z: mission.home.amsl_m,
    };
    let mut text = String::from("QGC WPL 110\n");
    for (row, item) in std::iter::once(home).chain(rows(mission)).enumerate() {
        text.push_str(&line(row, row == 0, &item));
    }
    text
}

/// A fence or rally points alone, as MAVProxy stores them: rows from 0, no home row.
#[must_use]
pub fn write_list(items: &[Item]) -> String {
    let mut text = String::from("QGC WPL 110\n");
    for (row, item) in items.iter().enumerate() {
        text.push_str(&line(row, false, item));
    }
    text
}

fn line(row: usize, current: bool, item: &Item) -> String {
    let [a, b, c, d] = item.params.map(number);
    format!(
        "{row}\t{}\t{}\t{}\t{a}\t{b}\t{c}\t{d}\t{}\t{}\t{}\t{}\n",
        u8::from(current),
        item.frame,
        item.command,
        coordinate_text(item.frame, item.x),
        coordinate_text(item.frame, item.y),
        number(item.z),
        u8::from(item.autocontinue),
    )
}

/// Shortest decimals that read back as the same float; never an exponent.
fn number(value: f32) -> String {
    if value.is_finite() {
        value.to_string()
    } else {
        "0".to_owned()
    }
}
