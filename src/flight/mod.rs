//! Launch, monitor, record, and compare what was flown with what was planned.
//!
//! [`Fleet`] knows neither sockets nor clocks, as the machines of [`crate::link`]: its
//! driver hands in messages and the time, sends what `poll_transmit` gives, and comes
//! back at `poll_timeout`. [`Driver`] is that driver for real links.

pub mod alarms;
mod clock;
mod conformance;
mod document;
mod error;
mod event;
mod itinerary;
mod launch;
mod page;
mod record;
pub mod replan;
mod session;

pub use clock::{BootTime, steady_ms, unix_ms};
pub use conformance::judge;
pub use conformance::reference::{Deviation, ReferenceTrajectory, Waypoint};
pub use conformance::report::{ErrorPercentiles, FlightReport, MadeStop, Passage, VehicleReport};
pub use document::{FlightDocument, flight_json};
pub use error::FlightError;
pub use event::{AlarmMark, Event};
pub use itinerary::plan_file::itineraries;
pub use itinerary::state::{Served, ServiceState, done_words};
pub use itinerary::stops::{Itinerary, ItineraryStop, Service, ServiceKind, count_words};
pub use launch::plan::{FlightPlan, refuse_shared_sysids};
pub(crate) use launch::readiness::STANDS_M;
pub use page::flight_page;
pub use record::handoff::{Ended, FlightHandoff, Notice, T0};
pub use record::interrupted::Interrupted;
pub use record::journal::Journal;
pub use record::lines::Line;
pub use record::read::{Broken, SPEEDUP, read_record};
pub use record::tlog::{Capture, read_tlog};
pub use record::{Fix, Flight, Flown, Plan, PopUp, RaisedAlarm, Record};
pub use session::diversion::{Diversion, Onward};
pub use session::driver::{Driver, Judged, Operator};
pub use session::end::End;
pub use session::start::Launch;
pub use session::status::Status;
pub use session::vehicle::Assignment;
pub use session::{Fleet, Intervention, Options, Outcome};
