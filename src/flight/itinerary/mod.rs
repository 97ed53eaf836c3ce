//! What a vehicle does on its way: its stops, the tasks that they are for, and what of that was seen.

pub(super) mod plan_file;
pub(super) mod progress;
pub(super) mod rows;
pub(super) mod state;
pub(super) mod stops;
