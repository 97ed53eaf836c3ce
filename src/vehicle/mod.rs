//! The simulated vehicle: a mission server that behaves as real autopilots did.

mod profile;
mod rules;
mod serve;
mod server;

pub use profile::Profile;
pub use serve::{Running, Simulated, spawn};
pub use server::Vehicle;
