//! The plan to fly, and the checks before takeoff: is each vehicle what, where and set as the
//! plan assumes?

pub(super) mod parameters;
pub(super) mod plan;
pub(super) mod readiness;
