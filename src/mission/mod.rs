//! Mission items as an autopilot reads them, and how a path becomes items.

mod accept;
mod build;
mod commands;
mod item;
mod params;

pub use accept::differences::read_differently;
pub use accept::{AcceptanceProblem, Limits, List, limits, problems, problems_in_flight};
pub use build::encode::home_at;
pub use build::fence::missing_from_fence;
pub use build::{MissionError, build, build_course};
pub use commands::{command_name, command_named};
pub use item::{Home, Item, Parameter, VehicleMission, command, frame};
pub use params::{
    ALTITUDE_SLOPE_MIN, acceptance_m, corner_cut_m, cruise_speed_mps, other_name, parameters, turn_radius_m,
};
