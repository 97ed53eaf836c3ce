//! Why a flight does not begin or go on.

use crate::formats::OutputError;
use crate::verify::Review;

/// Why a flight, or a new plan in flight, does not go on. The message names what happened and
/// what was not done because of it.
#[derive(Debug, thiserror::Error)]
pub enum FlightError {
    /// A file that cannot be used.
    #[error("{0}")]
    Input(String),
    /// No plan that may be flown.
    #[error("{0}")]
    Verdict(String),
    /// The missions do not pass verification.
    #[error("the missions do not pass verification; nothing was started")]
    Rejected(Box<Review>),
    /// A vehicle that cannot be reached, or does not answer.
    #[error("{0}")]
    Transfer(String),
    /// A record that cannot be read or written.
    #[error("{0}")]
    Record(String),
}

impl From<OutputError> for FlightError {
    fn from(error: OutputError) -> Self {
        Self::Record(error.to_string())
    }
}
