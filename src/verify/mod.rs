//! The verdict on encoded missions, in continuous time.
//!
//! ```text
//! items -> decode (what the autopilot reads) -> flight (legs, fillets, ramps, holds: chords of constant velocity)
//!       -> space (ground, ceiling, threats, zones, area, fence), contract (the rest of the spec), separation (pairs)
//! ```
//!
//! It judges missions from anywhere, knows nothing of the search that may have
//! made them, and reads the ground from its source. What it cannot judge fails.

mod chord;
mod contract;
mod decode;
mod fence;
mod flight;
mod legs;
mod outline;
mod pilot;
mod review;
mod ribbon;
mod separation;
mod space;
mod surface;
mod worst;

pub use review::review;

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
    /// The worst value; NaN where it cannot be known, and then `ok` is false and `note` says why.
    pub value: f64,
    /// What it is held against; NaN where there is nothing to hold it against.
    pub limit: f64,
    /// Which side of the limit is good.
    pub sense: Sense,
    /// Unit of both, such as `m`, `deg`, `items`.
    pub unit: &'static str,
    /// Where and when it is worst, if that is anywhere.
    pub at: Option<Moment>,
    /// Whether the limit is kept.
    pub ok: bool,
    /// What a reader needs to know besides; empty as a rule.
    pub note: String,
}

/// Which side of a limit is good.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sense {
    /// The value must be at least the limit.
    AtLeast,
    /// The value must be at most the limit.
    AtMost,
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

impl Margin {
    /// A limit that fails because it cannot be judged.
    #[must_use]
    pub fn unjudged(vehicle: &str, what: impl Into<String>, note: impl Into<String>) -> Self {
        Self {
            vehicle: vehicle.to_owned(),
            other: None,
            what: what.into(),
            value: f64::NAN,
            limit: f64::NAN,
            sense: Sense::AtLeast,
            unit: "",
            at: None,
            ok: false,
            note: note.into(),
        }
    }
}

impl Margin {
    /// Whether the limit is one of this vehicle, alone or with another.
    #[must_use]
    pub fn concerns(&self, vehicle: &str) -> bool {
        self.vehicle == vehicle || self.other.as_deref() == Some(vehicle)
    }

    /// How far the value is on the good side of its limit; negative on the other;
    /// NaN where it cannot be judged.
    #[must_use]
    pub fn slack(&self) -> f64 {
        match self.sense {
            Sense::AtLeast => self.value - self.limit,
            Sense::AtMost => self.limit - self.value,
        }
    }
}

impl Review {
    /// Whether every limit that concerns this vehicle is kept.
    #[must_use]
    pub fn accepts(&self, vehicle: &str) -> bool {
        let mut concerned = self
            .margins
            .iter()
            .filter(|margin| margin.concerns(vehicle))
            .peekable();
        concerned.peek().is_some() && concerned.all(|margin| margin.ok)
    }

    /// Whether every limit is kept. A review without any margin has judged nothing and fails.
    #[must_use]
    pub fn passes(&self) -> bool {
        !self.margins.is_empty() && self.margins.iter().all(|margin| margin.ok)
    }
}
