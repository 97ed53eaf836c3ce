//! Jumps in a mission (`DO_JUMP`), as autopilots make them.

use crate::autopilot::Autopilot;
use crate::mission::{Item, VehicleMission, command};

/// How often a jump is still made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Jumps {
    /// The vehicle has not come to it yet.
    NotMet,
    /// So often.
    Left(usize),
    /// It was passed without a jump.
    Spent,
    /// It is made for ever, and was made once.
    ForEver,
}

/// Where the mission goes on after a DO_JUMP.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Next {
    /// At the item with this index.
    Item(usize),
    /// At this one, for ever again.
    Again(usize),
    /// As in the repetition before.
    Repeats,
}

/// Whether an item jumps: to a number, or, for ArduPilot, to the first `JUMP_TAG` with a number
/// (`AP_Mission::get_index_of_jump_tag`).
pub(crate) fn is_jump(item: &Item, autopilot: Autopilot) -> bool {
    item.command == command::DO_JUMP
        || item.command == command::DO_JUMP_TAG && autopilot == Autopilot::ArduPilot
}

/// The index of the item that a jump goes to, if there is one.
fn target(item: &Item, mission: &VehicleMission) -> Result<usize, String> {
    let target = f64::from(item.params[0]);
    if item.command == command::DO_JUMP {
        let first = f64::from(1 - mission.autopilot.first_row());
        let to = whole(target - first).filter(|&to| to < mission.items.len());
        return to.ok_or_else(|| format!("a jump (DO_JUMP) to item {target}, which there is not"));
    }
    let is_tag = |other: &Item| {
        let tag = f64::from(other.params[0]);
        other.command == command::JUMP_TAG && whole(tag).is_some() && whole(tag) == whole(target)
    };
    let to = mission.items.iter().position(is_tag);
    to.ok_or_else(|| format!("a jump to the JUMP_TAG {target}, which there is not"))
}

/// The row of the command behind a counted jump that ArduPilot obeys as its last repetition begins, if there is one: with the
/// command before the jump done, it looks for the next one, finds the jump made, and goes on behind it
/// (`AP_Mission::advance_current_do_cmd`).
fn obeyed_early(mission: &VehicleMission, jump: usize) -> Option<usize> {
    let is_done_at_once = |index: usize| {
        let item = mission.items.get(index)?;
        let is_order = item.command > command::NAV_LAST && !is_jump(item, mission.autopilot);
        (is_order && item.command != command::JUMP_TAG).then_some(index + 1)
    };
    if mission.autopilot != Autopilot::ArduPilot {
        return None;
    }
    is_done_at_once(jump.checked_sub(1)?)?;
    is_done_at_once(jump + 1)
}

/// The index of the item after a jump.
///
/// `param1` is a number as the autopilot counts, or of a tag, `param2` how often. Neither autopilot counts a
/// completed jump anew within a mission, which a loop within a loop needs: such a jump is rejected.
pub(crate) fn jump(
    item: &Item,
    index: usize,
    mission: &VehicleMission,
    jumps: &mut Jumps,
) -> Result<Next, String> {
    let times = f64::from(item.params[1]);
    let is_endless = times.to_bits() == (-1.0_f64).to_bits();
    if is_endless && mission.autopilot == Autopilot::Px4 {
        return Err("a jump (DO_JUMP) made -1 times: PX4 counts from 0".to_owned());
    }
    let to = target(item, mission)?;
    if to == index {
        return Err("a jump (DO_JUMP) to itself".to_owned());
    }
    if is_endless {
        let again = *jumps == Jumps::ForEver;
        *jumps = Jumps::ForEver;
        return Ok(if again {
            Next::Repeats
        } else {
            Next::Again(to)
        });
    }
    let left = match *jumps {
        Jumps::Left(left) => left,
        Jumps::Spent | Jumps::ForEver => {
            return Err("a jump (DO_JUMP) within the loop of another".to_owned());
        }
        Jumps::NotMet => {
            let left = whole(times).filter(|&times| times <= MAX_JUMPS);
            let left = left.ok_or_else(|| format!("a jump (DO_JUMP) made {times} times"))?;
            if let Some(row) = obeyed_early(mission, index).filter(|_| left > 0) {
                return Err(format!(
                    "ArduPilot obeys item {row} one repetition early, as a command without a place stands before this jump, too: put a waypoint between"
                ));
            }
            left
        }
    };
    if left == 0 {
        *jumps = Jumps::Spent;
        return Ok(Next::Item(index + 1));
    }
    *jumps = Jumps::Left(left - 1);
    Ok(Next::Item(to))
}

/// Most repetitions that both autopilots keep as such (`int16`).
const MAX_JUMPS: usize = 32_767;

/// A whole number that fits the parameter of a jump.
fn whole(value: f64) -> Option<usize> {
    if !(0.0..=65_535.0).contains(&value) || value.fract().abs() > 0.0 {
        return None;
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "whole and in range"
    )]
    let whole = value as usize;
    Some(whole)
}
