//! Mission items as an autopilot reads them, and how a path becomes items.

mod item;

pub use item::{Home, Item, Parameter, VehicleMission, command, frame};
