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
/// A file with items that wings are flown with, and without a word on the airframe: which one flies it is not guessed.
pub(super) fn airframe(
    subject: &Subject,
    limits: &Limits,
    assumed: &mut Vec<String>,
) -> Result<Airframe, Failure> {
    let flag = limits.airframe.map(AirframeName::airframe);
    if let Some(known) = flag.or(subject.document.airframe) {
        return Ok(known);
    }
    if let Some((row, what, whose)) = no_evidence(&subject.document.items) {
        let message = format!(
            "{}: cannot be judged: item {row} ({what}) is one of {whose}, and the file does not say which airframe flies it: say --airframe",
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

/// Items that only a wing flies as they say.
const OF_WINGS: [u16; 3] = [
    command::NAV_VTOL_TAKEOFF,
    command::NAV_VTOL_LAND,
    command::DO_VTOL_TRANSITION,
];

/// The first item with which a mission is hardly one of a copter, its row, what it is, and which airframes fly it.
fn no_evidence(items: &[Item]) -> Option<(usize, String, &'static str)> {
    const WINGS: &str = "planes and vtol";
    // ArduCopter returns along the items behind a DO_LAND_START, and changes its altitude with NAV_LOITER_TO_ALT.
    const ANY: &str = "planes and vtol, and of copters as well";
    let name = |index: usize| {
        let number = items[index].command;
        command_name(number).map_or_else(|| format!("command {number}"), str::to_owned)
    };
    let first = |is: &dyn Fn(u16) -> bool| items.iter().position(|item| is(item.command));
    let of_wings = first(&|command| OF_WINGS.contains(&command));
    let of_wings = of_wings.map(|index| (index + 1, name(index), WINGS));
    let land_start = || {
        let index = first(&|command| command == command::DO_LAND_START)?;
        Some((index + 1, name(index), ANY))
    };
    let approach = || {
        let pair = |pair: &[Item]| {
            pair[0].command == command::NAV_LOITER_TO_ALT && pair[1].command == command::NAV_LAND
        };
        let index = items.windows(2).position(pair)?;
        Some((
            index + 1,
            "NAV_LOITER_TO_ALT before a landing".to_owned(),
            ANY,
        ))
    };
    of_wings.or_else(land_start).or_else(approach)
}
