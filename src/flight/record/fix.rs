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

    /// By how much the vehicle's own clock has fallen behind that of the fleet until a later
    /// position, seconds.
    #[must_use]
    pub fn slip_s(&self, later: &Self) -> f64 {
        later.t_s - self.t_s - self.until_s(later)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vehicle_on_a_machine_that_stalls_slips_and_one_that_was_started_again_does_not() {
        let fix = |t_s, boot_ms| Fix {
            t_s,
            place: LatLon {
                lat_deg: 47.0,
                lon_deg: 8.0,
            },
            amsl: Amsl(500.0),
            speed_mps: 10.0,
            item: 3,
            items: 9,
            boot_ms,
        };
        let first = fix(10.0, Some(40_000));
        for (later, slip_s) in [
            (fix(60.0, Some(90_000)), 0.0),
            (fix(60.0, Some(78_000)), 12.0),
            // Its clock is fast, was started again, or is not known.
            (fix(60.0, Some(90_500)), 0.0),
            (fix(60.0, Some(2_000)), 0.0),
            (fix(60.0, None), 0.0),
        ] {
            assert!((first.slip_s(&later) - slip_s).abs() < 1e-9, "{later:?}");
        }
    }
}
