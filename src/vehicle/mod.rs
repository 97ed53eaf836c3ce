//! The simulated vehicle: a mission server that behaves as real autopilots did.

mod air;
mod profile;
mod rules;
mod serve;
mod server;

pub use air::Weather;
pub use profile::Profile;
pub use serve::{Running, Simulated, spawn};
pub use server::Vehicle;
