//! Why an upload ended, in words.

use crate::link::message::MissionResult;
use crate::mission::Item;

/// Why an upload ended without every item sent.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum UploadError {
    /// Nothing came back.
    #[error("no answer to {counts} MISSION_COUNT messages")]
    Silent {
        /// How many were sent.
        counts: u32,
    },
    /// The vehicle refused.
    #[error("{}", refusal(*.result, *.seq, .item.as_ref()))]
    Rejected {
        /// Its code.
        result: MissionResult,
        /// The item last requested, if items were moving.
        seq: Option<u16>,
        /// That item.
        item: Option<Item>,
    },
    /// Another ground station is transferring.
    #[error("the vehicle said DENIED {denials} times: another ground station is using it")]
    Denied {
        /// How often.
        denials: u32,
    },
    /// Time ran out.
    #[error("not finished in time, item {seq} was the last requested, after {runs} starts{}", last_word(*.complaint))]
    OutOfTime {
        /// The item last requested.
        seq: u16,
        /// How often the transfer was started.
        runs: u32,
        /// The last code from the vehicle.
        complaint: Option<MissionResult>,
    },
    /// More items than `MISSION_COUNT` can say.
    #[error("{items} items are more than a transfer can count (65535)")]
    TooMany {
        /// How many.
        items: usize,
    },
}

fn refusal(result: MissionResult, seq: Option<u16>, item: Option<&Item>) -> String {
    let (Some(seq), Some(item)) = (seq, item) else {
        return format!("refused with {result}");
    };
    let [p1, p2, p3, p4] = item.params;
    let parameter = match result.parameter() {
        Some(n @ 1..=4) => format!(", param{n} = {}", [p1, p2, p3, p4][usize::from(n) - 1]),
        Some(5) => format!(", x = {}", item.x),
        Some(6) => format!(", y = {}", item.y),
        Some(_) => format!(", z = {}", item.z),
        None => format!(", frame {}", item.frame),
    };
    let command = item.command;
    format!("refused with {result} at sequence number {seq} (command {command}{parameter})")
}

fn last_word(complaint: Option<MissionResult>) -> String {
    complaint.map_or(String::new(), |result| {
        format!(", last code from the vehicle {result}")
    })
}
