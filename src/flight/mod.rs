//! Launch, monitor, record, and compare what was flown with what was planned.
//!
//! [`Fleet`] knows neither sockets nor clocks, as the machines of [`crate::link`]: its
//! driver hands in messages and the time, sends what `poll_transmit` gives, and comes
//! back at `poll_timeout`.

mod arrival;
mod asking;
mod clock;
mod craft;
mod diversion;
mod document;
mod end;
mod fleet;
mod judge;
mod lap;
mod leg;
mod limits;
mod lines;
mod misread;
mod modes;
mod pace;
mod page;
mod proof;
mod readiness;
mod reading;
mod record;
mod reference;
mod report;
mod setting;
mod settings;
mod status;
mod tlog;

pub use craft::Assignment;
pub use diversion::{Diversion, Onward};
pub use document::{FlightDocument, flight_json};
pub use end::End;
pub use fleet::{Event, Fleet, Intervention, Options, Outcome};
pub use judge::judge;
pub use lines::Line;
pub(crate) use modes::is_mission;
pub use page::flight_page;
pub use reading::{Broken, SPEEDUP, read_record};
pub use record::{Fix, Flight, Flown, Plan, PopUp, Record};
pub use reference::{Deviation, Reference, Waypoint};
pub use report::{FlightReport, Passage, Spread, VehicleReport};
pub use status::Status;
pub use tlog::{Capture, read_tlog};
