//! Why a file cannot be read.

use crate::spec::Autopilot;

/// Why a file cannot be read, or cannot become a mission.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FormatError {
    /// At a location in a text file.
    #[error("line {line}, column {column}: {found} (allowed: {allowed})")]
    Text {
        /// Line, from 1.
        line: usize,
        /// Column in characters, from 1.
        column: usize,
        /// What was found.
        found: String,
        /// What is allowed.
        allowed: String,
    },
    /// At a path in a JSON document.
    #[error("{at}: {found} (allowed: {allowed})")]
    Json {
        /// Path, such as `mission.items[2].params[4]`; items count from 0 here.
        at: String,
        /// Item as ground stations count it, from 1, if it is one.
        item: Option<usize>,
        /// What was found.
        found: String,
        /// What is allowed.
        allowed: String,
    },
    /// The file has no home position, so altitudes above home mean nothing.
    #[error("the file has no home position")]
    NoHome,
    /// The file was made for another autopilot.
    #[error("the file is for {}, the vehicle is {}", file.name(), vehicle.name())]
    OtherAutopilot {
        /// What the file says.
        file: Autopilot,
        /// What was asked for.
        vehicle: Autopilot,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn autopilots_are_named_as_their_developers_write_them() {
        let error = FormatError::OtherAutopilot {
            file: Autopilot::ArduPilot,
            vehicle: Autopilot::Px4,
        };
        let expected = "the file is for ArduPilot, the vehicle is PX4";
        assert_eq!(error.to_string(), expected);
    }
}
