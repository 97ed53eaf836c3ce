//! Checks before takeoff: is each vehicle what, where and set as the plan assumes?

pub(super) mod parameters;
pub(super) mod readiness;
