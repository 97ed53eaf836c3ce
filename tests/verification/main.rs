//! The verdict on encoded missions: laws, sampled flights, a second implementation.

#[path = "../support/mod.rs"]
mod support;

mod airspeed;
mod buffers;
mod copter_corners;
mod verify;
mod verify_independent;
mod verify_sampled;
