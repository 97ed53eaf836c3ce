//! Executes decoded mission items as the autopilot does, and gives the trajectory that results.

pub(super) mod bent_map;
pub(super) mod copter;
pub(super) mod decode;
pub(super) mod executor;
pub(super) mod flight;
pub(super) mod home;
pub(super) mod item;
pub(super) mod jumps;
pub(super) mod legs;
pub(super) mod trajectory;
pub(super) mod wing;
