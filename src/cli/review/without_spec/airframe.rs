//! The airframe of a mission file that may not say it.

use super::Subject;
use crate::autopilot::command_name;
use crate::cli::args::{AirframeName, Limits};
use crate::cli::print::failure::Failure;
use crate::mission::{Item, command};
use crate::spec::Airframe;

/// The flag, or the airframe of the file, or a copter where nothing speaks against it.
///
/// # Errors
/// A file with items that only a wing flies as it says, and without a word on the airframe.
pub(super) fn airframe(
    subject: &Subject,
    limits: &Limits,
    assumed: &mut Vec<String>,
) -> Result<Airframe, Failure> {
    let flag = limits.airframe.map(AirframeName::airframe);
    if let Some(known) = flag.or(subject.document.airframe) {
        return Ok(known);
    }
    if let Some((row, what)) = of_wing(&subject.document.items) {
        let message = format!(
            "{}: cannot be judged: item {row} ({what}) is one of planes and vtol, and the file does not say which airframe flies it: say --airframe",
            subject.id
        );
        return Err(Failure::new(Failure::VERDICT, message));
    }
    assumed.push(format!(
        "{}: the file does not say for which airframe it is: judged as a copter (--airframe)",
        subject.id
    ));
    Ok(Airframe::Copter)
}

/// The first item that is of a wing, by its row, and what it is.
fn of_wing(items: &[Item]) -> Option<(usize, String)> {
    let row = items.iter().position(|item| {
        matches!(
            item.command,
            command::NAV_VTOL_TAKEOFF
                | command::NAV_VTOL_LAND
                | command::DO_LAND_START
                | command::DO_VTOL_TRANSITION
        )
    });
    let name = |index: usize| {
        let number = items[index].command;
        command_name(number).map_or_else(|| format!("command {number}"), str::to_owned)
    };
    let approach = || {
        let pair = |pair: &[Item]| {
            pair[0].command == command::NAV_LOITER_TO_ALT && pair[1].command == command::NAV_LAND
        };
        let index = items.windows(2).position(pair)?;
        Some((index + 1, "the approach to a landing".to_owned()))
    };
    row.map(|index| (index + 1, name(index))).or_else(approach)
}
