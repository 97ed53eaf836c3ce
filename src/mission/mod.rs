//! Mission items as an autopilot reads them, and the encoding of paths as items.
//!
//! The rules by which an autopilot accepts items are data in [`crate::autopilot`]; the checks
//! that apply them to a mission are in `accept`.

mod accept;
mod build;
mod descent;
mod held_params;
mod item;
mod parameter_overrides;
mod params;

pub use crate::autopilot::{command, command_name, command_named, frame};
pub use accept::differences::read_differently;
pub(crate) use accept::param_fence::{Fence as ParamFence, above_home_m};
pub use accept::stored::{stored_hold_s, stored_otherwise, stored_radius_m, stored_turns};
pub use accept::{AcceptanceProblem, MissionType, problems, problems_in_flight};
pub use build::encode::home_at;
pub use build::fence::{FENCE_REACH_S, fence_needs, fence_pieces};
pub use build::wing::landing_course_note;
pub use build::{MissionError, build, build_course};
pub use descent::Descent;
pub use held_params::{
    acceptance_m, corner_accel_mps2, cruise_speed_mps, first_speed_mps, is_lean_limit, jerk_mps3,
    lean_limit_deg, placing_mps, within_speeds_mps,
};
pub(crate) use item::value_si_of;
pub use item::{Home, Item, Parameter, VehicleMission};
pub use parameter_overrides::{as_set, as_set_on_rotors, rate_parameters};
pub use params::{corner_cut_m, parameters, turn_radius_m};
