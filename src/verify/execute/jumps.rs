//! Jumps in a mission (`DO_JUMP`), as autopilots make them.

use crate::autopilot::Autopilot;
use crate::mission::{Item, VehicleMission};

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
    /// As in the lap before.
    Repeats,
}

/// The index of the item after a DO_JUMP.
///
/// `param1` is a number as the autopilot counts, `param2` how often. Neither autopilot counts a
/// completed jump anew within a mission, which a loop within a loop needs: such a jump is rejected.
pub(crate) fn jump(
    item: &Item,
    index: usize,
    mission: &VehicleMission,
    jumps: &mut Jumps,
) -> Result<Next, String> {
    let [target, times, ..] = item.params.map(f64::from);
    let is_endless = times.to_bits() == (-1.0_f64).to_bits();
    if is_endless && mission.autopilot == Autopilot::Px4 {
        return Err("a jump (DO_JUMP) made -1 times: PX4 counts from 0".to_owned());
    }
    let first = f64::from(1 - mission.autopilot.first_row());
    let to = whole(target - first)
        .filter(|&to| to < mission.items.len())
        .ok_or_else(|| format!("a jump (DO_JUMP) to item {target}, which there is not"))?;
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
        Jumps::NotMet => whole(times)
            .filter(|&times| times <= MOST_JUMPS)
            .ok_or_else(|| format!("a jump (DO_JUMP) made {times} times"))?,
    };
    if left == 0 {
        *jumps = Jumps::Spent;
        return Ok(Next::Item(index + 1));
    }
    *jumps = Jumps::Left(left - 1);
    Ok(Next::Item(to))
}

/// Most repetitions that both autopilots keep as such (`int16`).
const MOST_JUMPS: usize = 32_767;

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
