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
    /// Since the vehicle was started, milliseconds by its own clock; none where that was not
    /// recorded.
    pub boot_ms: Option<u32>,
}

impl Fix {
    /// Time until a later position, seconds: by the vehicle's own clock, if that is less. Where a
    /// machine stalls, a simulated vehicle slips behind the clock of the fleet, and is not silent.
    #[must_use]
    pub fn until_s(&self, later: &Self) -> f64 {
        (later.t_s - self.t_s).min(self.passed_s(later))
    }

    /// Time that has passed for the vehicle until a later position, seconds: by its own clock, or
    /// that of the fleet where its own is not known. The one may step against the other.
    #[must_use]
    pub fn passed_s(&self, later: &Self) -> f64 {
        let own_ms = self.boot_ms.zip(later.boot_ms);
        // A vehicle that was started again begins at 0.
        let own_ms = own_ms.and_then(|(from, to)| to.checked_sub(from));
        own_ms.map_or(later.t_s - self.t_s, |ms| f64::from(ms) / 1000.0)
    }
}
