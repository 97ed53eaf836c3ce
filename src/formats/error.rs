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
    #[error("the file is for {file:?}, the vehicle is {vehicle:?}")]
    OtherAutopilot {
        /// What the file says.
        file: Autopilot,
        /// What was asked for.
        vehicle: Autopilot,
    },
}
