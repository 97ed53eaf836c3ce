//! The earth: WGS84, ECEF, the local frame, and what an altitude refers to.

mod altitude;
mod frame;

pub use altitude::{AboveHome, Agl, Amsl};
pub use frame::{EastNorth, GeodesyError, LatLon, LocalFrame, PlanPoint};
