//! The simulated vehicle: it holds missions as real autopilots did, and flies what it holds.

mod air;
mod dynamics;
mod environment;
mod faults;
mod mode;
mod parameters;
mod pilot;
mod profile;
mod rules;
mod serve;
mod server;

pub use air::Weather;
pub use environment::Surroundings;
pub use faults::Fault;
pub use profile::Profile;
pub use serve::{Running, Simulated, spawn, spawn_in};
pub use server::Vehicle;
