//! The limits that a trajectory is judged against, one file for each kind.

pub(super) mod assumptions;
mod closed;
pub(super) mod distant;
mod endurance;
pub(super) mod fence;
mod lean;
pub(super) mod mission;
pub(super) mod parked;
pub(super) mod rally;
pub(super) mod separation;
pub(super) mod space;
pub(super) mod wing;
