//! Commands that are repeated until the vehicle answers.

pub(super) mod pending;
pub(super) mod set_current;
