//! Commands that run later than their rows say, or never.

use super::MissionCheck;
use crate::autopilot::Autopilot;
use crate::mission::{command, command_name};

impl MissionCheck<'_> {
    /// Index of the item between the waypoint before a command and the command that lets it run later, or never: a
    /// condition, for which ArduPilot waits until it goes on from there and drops the rest, or a jump.
    pub(super) fn held_up_by(&self, index: usize) -> Option<usize> {
        let before = self.mission.items.get(..index)?.iter().enumerate().rev();
        let mut before = before.take_while(|(_, item)| item.command > command::NAV_LAST);
        let waits = self.mission.autopilot == Autopilot::ArduPilot;
        let found = before.find(|(_, item)| match item.command {
            command::DO_JUMP | command::DO_JUMP_TAG => true,
            command::CONDITION_DELAY | command::CONDITION_DISTANCE => waits,
            _ => false,
        });
        found.map(|(index, _)| index)
    }

    /// That an item holds up what is after it, in words.
    pub(super) fn holds_up(&self, index: usize) -> String {
        let command = self.mission.items[index].command;
        let name = command_name(command).unwrap_or("a command");
        format!("{name} at item {} lets it run later, or never", index + 1)
    }
}
