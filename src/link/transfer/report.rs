//! The report of a transfer.

use std::net::SocketAddr;

use sha2::{Digest, Sha256};

use super::compare::Difference;
use super::download::DownloadError;
use super::upload::UploadError;
use crate::link::message::{MissionResult, MissionType};
use crate::mission::Item;

/// The report of one vehicle's transfer.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct TransferReport {
    /// Id of the vehicle in the spec.
    pub vehicle: String,
    /// System id of the vehicle.
    pub sysid: u8,
    /// Autopilot and type from its heartbeat; empty if it never spoke.
    pub autopilot: String,
    /// Version of its software as it says, such as `4.6.3`; empty if unknown.
    pub version: String,
    /// The vehicle's own ids of mission, fence and rally as they were read back; 0 where it has none.
    pub plan_ids: [u32; 3],
    /// Mission items read back, without home.
    pub items: usize,
    /// Fence items read back.
    pub fence: usize,
    /// Rally points read back.
    pub rally: usize,
    /// How often a list was sent from its beginning.
    pub attempts: u32,
    /// Messages that had to be repeated.
    pub retries: u32,
    /// From the first heartbeat we sent to the verdict.
    pub seconds: f64,
    /// SHA-256 over the items held (see [`hash`]); empty unless verified.
    pub hash: String,
    /// How far the vehicle stands from the home of its mission, metres; none if it did not say.
    pub from_home_m: Option<f64>,
    /// Whether the vehicle holds exactly the items sent.
    pub verdict: Verdict,
    /// Every difference between the items sent and read back.
    pub differences: Vec<Difference>,
    /// Texts of the vehicle during the transfer (`STATUSTEXT`).
    pub statustexts: Vec<String>,
}

/// How a transfer ended.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Verdict {
    /// The vehicle holds exactly our items: read back and compared.
    Verified,
    /// It does not, or that is unknown.
    Failed(Failure),
    /// Nothing was sent.
    Refused(Refusal),
}

impl Verdict {
    /// Why it is not verified, in words; nothing if it is.
    #[must_use]
    pub fn why(&self) -> String {
        match self {
            Self::Verified => String::new(),
            Self::Failed(failure) => failure.to_string(),
            Self::Refused(refusal) => refusal.to_string(),
        }
    }
}

/// Why a transfer failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Failure {
    /// No heartbeat.
    #[error("no heartbeat from system {sysid} within {after_s} s{}", heard_text(.heard))]
    Nobody {
        /// Whose.
        sysid: u8,
        /// How long was waited, seconds.
        after_s: u64,
        /// Other systems heard on the link.
        heard: Vec<u8>,
    },
    /// No heartbeat of any vehicle.
    #[error("no heartbeat of any vehicle within {after_s} s")]
    Nothing {
        /// How long was waited, seconds.
        after_s: u64,
    },
    /// Several vehicles, and none was named.
    #[error("several vehicles are on the link: name one by its system id{}", heard_text(.heard))]
    Several {
        /// Their system ids.
        heard: Vec<u8>,
    },
    /// One system id at two addresses at the same time, or of two vehicles at one.
    #[error("system {sysid} speaks {} at once: two vehicles with one system id{}", addresses(*at), if at[0] == at[1] { "" } else { ", or one over two links" })]
    DuplicateSystem {
        /// Their system id.
        sysid: u8,
        /// Where they are.
        at: [SocketAddr; 2],
    },
    /// Fence and rally points have no messages in MAVLink 1.
    #[error(
        "the vehicle speaks only MAVLink 1, which has no messages for fence items ({fence}) and rally points ({rally})"
    )]
    OnlyMavlink1 {
        /// Fence items of the mission.
        fence: usize,
        /// Rally points of the mission.
        rally: usize,
    },
    /// The vehicle did not finish starting.
    #[error("still starting (system_status {status}) after {after_s} s")]
    NotReady {
        /// `MAV_STATE`.
        status: u8,
        /// How long was waited, seconds.
        after_s: u64,
    },
    /// Sending a list failed.
    #[error("{list}: {error}{}", way_out(*.list, error))]
    Upload {
        /// Which.
        list: MissionType,
        /// Why.
        #[source]
        error: UploadError,
    },
    /// An old list could not be cleared.
    #[error("{list}: what is on board could not be cleared: {result}")]
    Clear {
        /// Which.
        list: MissionType,
        /// Its answer.
        result: MissionResult,
    },
    /// Reading a list failed, so its content on board is unknown.
    #[error("{list}: could not be read back: {error}")]
    ReadBack {
        /// Which.
        list: MissionType,
        /// Why.
        #[source]
        error: DownloadError,
    },
    /// The vehicle holds the mission and will not fly it.
    #[error("the vehicle holds the mission, and will not fly it: {text}")]
    WillNotFly {
        /// Its text.
        text: String,
    },
    /// The vehicle holds something else.
    #[error("{list}: the vehicle holds something else than was sent (differences: {count}){}", complaint_text(*.complaint))]
    Different {
        /// Which.
        list: MissionType,
        /// How many differences.
        count: usize,
        /// Its last answer while it took the items.
        complaint: Option<MissionResult>,
    },
    /// Every item was sent again and again, and the vehicle holds something else.
    #[error(
        "{list}: all items were sent {times} times and never acknowledged, and the vehicle holds something else (differences: {count})"
    )]
    NeverConfirmed {
        /// Which.
        list: MissionType,
        /// How many differences.
        count: usize,
        /// How often.
        times: u32,
    },
    /// The list changed again and again after it had been read back.
    #[error(
        "{list}: changed on board {times} times after it was read back: another station writes to the vehicle; upload again while none does"
    )]
    ChangedMeanwhile {
        /// Which.
        list: MissionType,
        /// How often.
        times: u32,
    },
    /// Another station wrote to the vehicle, so its content on board is not certain.
    #[error(
        "{}: changed by system {system} during the transfer; upload again while no other station writes to the vehicle",
        list_text(*.list)
    )]
    ChangedBy {
        /// Which list; none for all of them.
        list: Option<MissionType>,
        /// The system id of the other station.
        system: u8,
    },
    /// What a vehicle holds changed again and again while it was read.
    #[error(
        "{}: changed {}while it was read, again and again; read it again while no other station writes to the vehicle",
        list_text(*.list), system.map_or_else(String::new, |system| format!("by system {system} "))
    )]
    ChangedWhileRead {
        /// Which list; none for all of them.
        list: Option<MissionType>,
        /// The system id of the other station, if it was heard.
        system: Option<u8>,
    },
    /// The whole transfer took too long.
    #[error("not finished within {after_s} s")]
    OutOfTime {
        /// How long was waited, seconds.
        after_s: u64,
    },
    /// The vehicle was armed during the transfer.
    #[error("the vehicle was armed during the transfer")]
    ArmedMeanwhile,
    /// The link could not be opened or broke.
    #[error("{link}: {error}")]
    Link {
        /// Which.
        link: String,
        /// Why.
        error: String,
    },
}

/// Why nothing was sent. `force` overrides each.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Refusal {
    /// Its motors may run.
    #[error("the vehicle is armed")]
    Armed,
    /// Another autopilot than in the spec.
    #[error("the spec says {expected}, the vehicle says {found}")]
    Autopilot {
        /// In the spec.
        expected: &'static str,
        /// In its heartbeat.
        found: String,
    },
    /// Another type than in the spec.
    #[error("the spec says {expected}, the vehicle says {found}")]
    Type {
        /// In the spec.
        expected: &'static str,
        /// In its heartbeat.
        found: String,
    },
    /// Another system id than in the spec.
    #[error("the spec says system {expected}, on the link is system {found}")]
    System {
        /// In the spec.
        expected: u8,
        /// In its heartbeat.
        found: u8,
    },
}

fn addresses([one, two]: [SocketAddr; 2]) -> String {
    match one == two {
        true => format!("from {one} for two"),
        false => format!("from {one} and from {two}"),
    }
}

fn heard_text(heard: &[u8]) -> String {
    if heard.is_empty() {
        return String::new();
    }
    let names: Vec<String> = heard.iter().map(ToString::to_string).collect();
    format!(" (heard on the link: system {})", names.join(", "))
}

fn list_text(list: Option<MissionType>) -> String {
    list.map_or_else(|| "all lists".to_owned(), |list| list.to_string())
}

/// What helps where a vehicle has less space for a fence than the spec or its autopilot says.
fn way_out(list: MissionType, error: &UploadError) -> &'static str {
    match error {
        UploadError::Rejected {
            result: MissionResult::NO_SPACE,
            ..
        } if list == MissionType::Fence => {
            ": this vehicle keeps fewer; state how many in fence_points of the vehicle, and plan again"
        }
        _ => "",
    }
}

fn complaint_text(complaint: Option<MissionResult>) -> String {
    complaint.map_or(String::new(), |result| {
        format!("; it answered {result} meanwhile")
    })
}

impl TransferReport {
    /// Whether the vehicle holds exactly our items.
    #[must_use]
    pub fn is_verified(&self) -> bool {
        self.verdict == Verdict::Verified
    }

    /// A report without any transfer.
    pub(crate) fn nothing(vehicle: &str, sysid: u8, verdict: Verdict) -> Self {
        Self {
            vehicle: vehicle.to_owned(),
            sysid,
            autopilot: String::new(),
            version: String::new(),
            plan_ids: [0; 3],
            items: 0,
            fence: 0,
            rally: 0,
            attempts: 0,
            retries: 0,
            seconds: 0.0,
            hash: String::new(),
            from_home_m: None,
            verdict,
            differences: Vec::new(),
            statustexts: Vec::new(),
        }
    }
}

/// SHA-256 in hexadecimal over lists of items in the order mission, fence, rally,
/// without home. Each list is its `MAV_MISSION_TYPE` (1 byte) and number of items
/// (`u32`), then every item as command (`u16`), frame, autocontinue, `param1` to
/// `param4`, x, y, z as on the wire; all little endian.
#[must_use]
pub fn hash(mission: &[Item], fence: &[Item], rally: &[Item]) -> String {
    let mut sha = Sha256::new();
    for (list, items) in MissionType::ALL.into_iter().zip([mission, fence, rally]) {
        sha.update([list.mission_type()]);
        let count = u32::try_from(items.len()).expect("a list counts its items in 16 bits");
        sha.update(count.to_le_bytes());
        for item in items {
            sha.update(item.command.to_le_bytes());
            sha.update([item.frame, u8::from(item.autocontinue)]);
            item.params
                .iter()
                .for_each(|param| sha.update(param.to_le_bytes()));
            sha.update(item.x.to_le_bytes());
            sha.update(item.y.to_le_bytes());
            sha.update(item.z.to_le_bytes());
        }
    }
    sha.finalize()
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect()
}
