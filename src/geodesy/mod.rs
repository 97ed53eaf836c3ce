//! The earth: WGS84, ECEF, the local frame, the geoid, and what an altitude refers to.

mod altitude;
mod atmosphere;
mod frame;
mod geoid;
mod projection;

pub use altitude::{AboveHome, Agl, Amsl, Ellipsoid};
pub use atmosphere::{flight_level, true_airspeed_ratio};
pub(crate) use frame::{
    EARTH_RADIUS_M, METRES_PER_DEG, SMALL_BEND_M, in_plane_m, on_earth_m, straight_m,
};
pub use frame::{EastNorth, GeodesyError, LatLon, LocalFrame, PlanPoint, bend_m, frame_bend_m};
pub use geoid::Geoid;
pub use projection::Projection;
