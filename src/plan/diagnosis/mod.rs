//! Infeasibility: why no path was found, and what would help.

pub(super) mod blockers;
pub(super) mod blocking_set;
pub(super) mod relaxations;
pub(super) mod violations;
