//! Missions to and from vehicles: sans-IO machines, codec, sockets.
//!
//! # Driver contract
//!
//! [`Upload`], [`Download`], [`Clear`], [`Session`] and [`Reading`] know neither sockets
//! nor clocks. A driver passes each message to `handle` of any sender, and calls
//! `handle_timeout` when `poll_timeout` is due (`None` at the end). After each of these
//! calls it sends every message that `poll_transmit` returns. [`upload_fleet`] is such a
//! driver.

mod codec;
mod fleet;
mod ground_station;
mod io;
mod message;
mod rtt;
mod stored_form;
mod texts;
mod time;
mod transfer;

pub use crate::link::io::links::{Arrival, Links};
pub use crate::link::io::tlog::Tlog;
pub use crate::link::transfer::clear::{Clear, Cleared};
pub use crate::link::transfer::compare::{Difference, differences};
pub use crate::link::transfer::download::{Download, DownloadError};
pub(crate) use crate::link::transfer::identity::check_kind;
pub use crate::link::transfer::onboard::{Onboard, Reading};
pub use crate::link::transfer::order::Order;
pub use crate::link::transfer::report::{Failure, Refusal, TransferReport, Verdict, hash};
pub use crate::link::transfer::session::{Progress, Session};
pub use crate::link::transfer::upload::{Sent, Upload, UploadError};
pub use codec::{Decoder, Encoder, Version};
pub use fleet::{Job, download, upload_fleet, upload_fleet_captured};
pub use message::flight::{
    Command, CommandResult, FlightMessage, LandedState, ParamValue, Position,
};
pub use message::health::{Health, SystemStatus};
pub use message::{
    AUTOPILOT_GENERIC, AUTOPILOT_INVALID, Address, Body, Heartbeat, MISSION_TYPE_ALL, MODE_ARMED,
    Message, MissionMessage, MissionResult, MissionType, Route, STATE_ACTIVE, STATE_STANDBY,
    TEXT_BYTES, TYPE_GCS, TextChunk,
};
pub use stored_form::stored_form;
pub use texts::TextChunks;
pub(crate) use texts::as_line;
pub use time::Time;
