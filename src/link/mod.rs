//! Missions to and from vehicles: sans-IO machines, codec, sockets.
//!
//! [`Upload`], [`Download`], [`Clear`] and [`Session`] know neither sockets nor
//! clocks: a driver hands in messages and the time, sends what `poll_transmit`
//! gives, and comes back at `poll_timeout`. [`upload_fleet`] is that driver.

mod clear;
mod codec;
mod compare;
mod download;
mod fleet;
mod flight_message;
mod flight_payload;
mod identity;
mod kept;
mod links;
mod meeting;
mod message;
mod pace;
mod payload;
mod radio;
mod reading;
mod report;
mod session;
mod socket;
mod task;
mod time;
mod tlog;
mod upload;
mod wanted;

pub use clear::{Clear, Cleared};
pub use codec::{Decoder, Encoder, Version};
pub use compare::{Difference, differences};
pub use download::{Download, DownloadError};
pub use fleet::{Job, download, upload_fleet, upload_fleet_captured};
pub use flight_message::{
    Command, CommandResult, FlightMessage, LandedState, ParamValue, Position,
};
pub use kept::kept;
pub use links::{Arrival, Links};
pub use message::{
    AUTOPILOT_ARDUPILOT, AUTOPILOT_GENERIC, AUTOPILOT_INVALID, AUTOPILOT_PX4, Address, Body,
    Heartbeat, List, MISSION_TYPE_ALL, MODE_ARMED, Message, MissionMessage, MissionResult, Route,
    STATE_ACTIVE, STATE_STANDBY, TYPE_GCS,
};
pub use reading::{Onboard, Reading};
pub use report::{Failure, Refusal, TransferReport, Verdict, hash};
pub use session::{Order, Progress, Session};
pub use time::Time;
pub use tlog::Tlog;
pub use upload::{Sent, Upload, UploadError};
