//! The simulated vehicle: it holds missions as real autopilots did, and flies what it holds.

mod air;
mod body;
mod guide;
mod height;
mod mode;
mod pilot;
mod profile;
mod rules;
mod serve;
mod server;
mod settings;
mod steer;
mod surroundings;
mod wing;

pub use air::Weather;
pub use profile::Profile;
pub use serve::{Running, Simulated, spawn, spawn_in};
pub use server::Vehicle;
pub use surroundings::Surroundings;
