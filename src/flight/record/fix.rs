//! A position of a vehicle.

use crate::geodesy::{Amsl, LatLon};

/// Where a vehicle was at one time, by its own word.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fix {
    /// Seconds after T0.
    pub t_s: f64,
    /// Where.
    pub place: LatLon,
    /// How high.
    pub amsl: Amsl,
    /// Ground speed, m/s.
    pub speed_mps: f64,
    /// Row of the `.waypoints` file that it was flying to; home is 0.
    pub item: usize,
    /// Items on board without home, by its own word; 0 where it does not say.
    pub items: usize,
}
