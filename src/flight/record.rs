//! What was flown.

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
}

/// The flight of one vehicle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Flown {
    /// In order of time, from T0 to the end.
    pub fixes: Vec<Fix>,
    /// When each item was said to be reached, seconds after T0.
    pub reached: Vec<(usize, f64)>,
    /// How it ended.
    pub end: super::End,
}
