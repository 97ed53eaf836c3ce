//! The verdict on encoded missions: laws, sampled flights, a second implementation.

#[path = "../support/mod.rs"]
mod support;

mod airspeed;
mod altitudes_and_endurance;
mod bends;
mod buffers;
mod campaign;
mod copter_corners;
mod curves;
mod domes;
mod down_from_climb;
mod early_climb;
mod fences;
mod lateness;
mod obstacles;
mod other_world;
mod px4_heights;
mod set_by_parameters;
mod verify;
mod verify_independent;
mod verify_sampled;
mod wings;
mod zone_times;
