//! The simulated vehicle as a body: position, velocity, steering, wings, and what the air does to it.

pub(super) mod altitude;
pub(super) mod body;
pub(super) mod guidance;
pub(super) mod steering;
pub(super) mod wing;
