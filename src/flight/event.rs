//! What an operator reads of a flight: printed, recorded, and sent to other terminals.

use crate::link::as_line;
use crate::spec::AlarmKind;

/// Something that an operator wants to read.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// Seconds after T0; none before it.
    pub t_s: Option<f64>,
    /// The vehicle that it is about; none for all.
    pub vehicle: Option<String>,
    /// The text.
    pub text: String,
    /// The alarm that it raises or ends, if any.
    pub alarm: Option<AlarmMark>,
}

/// What an operator reads of a text of a vehicle.
pub(super) fn says(text: &str) -> String {
    match text.trim().is_empty() {
        true => "says: (an empty text)".to_owned(),
        false => format!("says: {}", as_line(text)),
    }
}

/// The alarm that an event is about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AlarmMark {
    /// Its kind.
    pub kind: AlarmKind,
    /// The other vehicle of a separation.
    pub other: Option<String>,
    /// Whether it begins; else it is over.
    pub is_raised: bool,
}

impl Event {
    /// An event without an alarm.
    pub(super) fn new(t_s: Option<f64>, vehicle: Option<String>, text: String) -> Self {
        Self {
            t_s,
            vehicle,
            text,
            alarm: None,
        }
    }
}
