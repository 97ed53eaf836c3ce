//! The parameters of items that an autopilot reads: PX4 refuses an item with a number in another.
//!
//! Flown: every command of [`super::COMMANDS`] in frames 0, 2 and 3, one parameter at a time, was uploaded to a
//! copter, a plane and a VTOL of PX4 1.18 beta (July 2026) in its own simulator.

use crate::autopilot::version::{VersionRange, version};

/// What one autopilot reads of each command on one airframe.
#[derive(Clone, Copy, Debug)]
pub struct ReadParameters {
    /// The versions that refuse what they do not read.
    pub versions: VersionRange,
    /// `MAV_CMD`, ascending, and the parameters from 1; 5 and 6 are latitude and longitude, 7 is the altitude. Of a
    /// command that is not in the list nothing is refused.
    pub commands: &'static [(u16, &'static [u8])],
    /// Pairs of a command and a parameter besides.
    pub more: &'static [(u16, u8)],
    /// Where the list is from.
    pub source: &'static str,
}

impl ReadParameters {
    /// Whether an item with a number in this parameter is refused for it.
    #[must_use]
    pub fn refuses(&self, command: u16, param: u8) -> bool {
        let row = self
            .commands
            .binary_search_by_key(&command, |(command, _)| *command);
        row.is_ok_and(|row| !self.commands[row].1.contains(&param))
            && !self.more.contains(&(command, param))
    }
}

/// PX4 on rotors alone.
pub(in crate::autopilot) static PX4: ReadParameters = ReadParameters {
    versions: VersionRange::since(version(1, 18)),
    commands: PX4_COMMANDS,
    more: &[],
    source: "PX4 1.18 and later (#27541, mavlink_command_params.hpp)",
};

/// On a wing the first parameter of a takeoff is the pitch.
pub(in crate::autopilot) static PX4_WING: ReadParameters = ReadParameters {
    more: &[(22, 1)],
    ..PX4
};

const PX4_COMMANDS: &[(u16, &[u8])] = &[
    (16, &[1, 2, 4, 5, 6, 7]),
    (17, &[3, 4, 5, 6, 7]),
    (19, &[1, 2, 3, 4, 5, 6, 7]),
    (20, &[]),
    (21, &[1, 2, 4, 5, 6, 7]),
    (22, &[4, 5, 6, 7]),
    (31, &[1, 2, 4, 5, 6, 7]),
    (84, &[4, 5, 6, 7]),
    (85, &[4, 5, 6, 7]),
    (93, &[1, 2, 3, 4]),
    (177, &[1, 2]),
    (178, &[1, 2, 3]),
    (179, &[1, 2, 3, 4, 5, 6, 7]),
    (189, &[]),
    (195, &[5, 6, 7]),
    (196, &[1]),
    (197, &[1]),
    // Not the place: in frames with one it is refused whatever it is.
    (201, &[1, 2, 3]),
    (206, &[1, 2, 3, 4]),
    (211, &[1, 2]),
    (212, &[1, 2]),
    (214, &[1, 2, 3]),
    (400, &[1, 2]),
    (530, &[1, 2]),
    (532, &[1, 2, 3]),
    (534, &[1, 2, 3]),
    (2000, &[1, 2, 3, 4]),
    (2001, &[1]),
    (2003, &[1, 2, 3, 4]),
    (2500, &[1, 2, 3]),
    (2501, &[1, 2]),
    (3000, &[1, 2]),
    // Its place is refused: it cannot be uploaded.
    (4501, &[]),
    (42_600, &[1, 2, 3, 4]),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_and_their_parameters_are_in_ascending_order() {
        assert!(PX4.commands.is_sorted_by(|a, b| a.0 < b.0));
        for (command, read) in PX4.commands {
            assert!(read.is_sorted_by(|a, b| a < b), "{command}");
        }
    }
}
