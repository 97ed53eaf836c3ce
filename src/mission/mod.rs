//! Mission items as an autopilot reads them, and how a path becomes items.

mod accept;
mod accept_fence;
mod accept_item;
mod accept_wing;
mod build;
mod commands;
mod differ;
mod encode;
mod fence;
mod item;
mod legs;
mod params;
mod simplify;
mod wing;

pub use accept::{AcceptanceProblem, Limits, List, limits, problems};
pub use build::{MissionError, build, build_course};
pub use commands::{command_name, command_named};
pub use differ::read_differently;
pub use encode::home_at;
pub use fence::missing_from_fence;
pub use item::{Home, Item, Parameter, VehicleMission, command, frame};
pub use params::{
    ALTITUDE_SLOPE_MIN, corner_cut_m, cruise_speed_mps, other_name, parameters, turn_radius_m,
};
