//! The verdict on encoded missions, in continuous time.

use crate::geodesy::{Amsl, LatLon};

/// What `verify` found.
#[derive(Clone, Debug, PartialEq)]
pub struct Review {
    /// Every limit with its worst value, whether kept or not.
    pub margins: Vec<Margin>,
    /// Where each vehicle is over time, in the order of the missions given.
    pub tracks: Vec<Track>,
    /// What the flight model assumes and was not measured on an autopilot.
    pub assumptions: Vec<String>,
}

/// The worst value of one limit.
#[derive(Clone, Debug, PartialEq)]
pub struct Margin {
    /// Id of the vehicle.
    pub vehicle: String,
    /// Id of the other vehicle, for separation.
    pub other: Option<String>,
    /// Which limit, in words: `terrain clearance`, `threat radar-1`, `separation`, ...
    pub what: String,
    /// The worst value.
    pub value: f64,
    /// What it is held against.
    pub limit: f64,
    /// Unit of both, such as `m`, `deg`, `items`.
    pub unit: &'static str,
    /// Where and when it is worst, if that is anywhere.
    pub at: Option<Moment>,
    /// Whether the limit is kept.
    pub ok: bool,
    /// What a reader needs to know besides; empty as a rule.
    pub note: String,
}

/// A place and time of a flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Where.
    pub place: LatLon,
    /// How high.
    pub amsl: Amsl,
    /// Seconds after T0.
    pub t_s: f64,
    /// Row of the `.waypoints` file: home is 0, the first item 1.
    pub item: usize,
}

/// Where one vehicle is over time, from takeoff to touchdown, dense enough to draw.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Id of the vehicle.
    pub vehicle: String,
    /// In order of time.
    pub moments: Vec<Moment>,
}

impl Review {
    /// Whether every limit is kept. A review without any margin has judged nothing and fails.
    #[must_use]
    pub fn passes(&self) -> bool {
        !self.margins.is_empty() && self.margins.iter().all(|margin| margin.ok)
    }
}
