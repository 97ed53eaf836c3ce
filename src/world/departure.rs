//! How a vehicle begins its path.

use crate::geodesy::PlanPoint;

/// How a vehicle begins its path: on the ground, or in flight.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Departure {
    /// It stands at home, takes off after its departure delay, and flies to the start.
    #[default]
    Ground,
    /// It is in the air, and its path begins there.
    Airborne {
        /// Its position.
        point: PlanPoint,
        /// Its course, radians clockwise from north.
        course_rad: f64,
        /// Its ground speed, m/s.
        speed_mps: f64,
        /// The time of all this, seconds after T0.
        at_s: f64,
    },
}

impl Departure {
    /// Whether the vehicle is in the air.
    #[must_use]
    pub fn is_airborne(&self) -> bool {
        matches!(self, Self::Airborne { .. })
    }

    /// The ground speed at which a route begins, m/s: at the point of an airborne departure that of
    /// the vehicle, else 0.
    #[must_use]
    pub fn speed_at_mps(&self, from: PlanPoint) -> f64 {
        match *self {
            Self::Airborne {
                point, speed_mps, ..
            } if point == from => speed_mps,
            _ => 0.0,
        }
    }
}
