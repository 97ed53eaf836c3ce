//! Endurance: flight time, range or energy.

use super::{Airframe, Span, Vehicle};
use crate::geodesy::Amsl;
use crate::numeric::digits::plain;

/// What a vehicle may use from takeoff to touchdown.
#[derive(Clone, Debug, PartialEq)]
pub struct Endurance {
    /// Total capacity.
    pub capacity: Capacity,
    /// Share of it that must be left at touchdown.
    pub reserve: f64,
}

/// What a vehicle has on board.
#[derive(Clone, Debug, PartialEq)]
pub enum Capacity {
    /// Seconds of flight.
    Time(f64),
    /// Metres through the air.
    Range(f64),
    /// Energy.
    Energy(Energy),
}

/// Energy on board, and the power that flying draws.
#[derive(Clone, Debug, PartialEq)]
pub struct Energy {
    /// On board, watt hours.
    pub wh: f64,
    /// Additional power while climbing at `climb_mps`, watts; proportional to the climb rate.
    pub climbing_w: f64,
    /// The vertical speed that `climbing_w` belongs to, m/s.
    pub climb_mps: f64,
    /// Speed through the air, m/s, and power, W, by ascending speed; not empty. A hover has speed
    /// 0.
    pub level: Vec<(f64, f64)>,
}

impl Endurance {
    /// What may be used, in [`Capacity::unit`].
    #[must_use]
    pub fn usable(&self) -> f64 {
        (1.0 - self.reserve) * self.capacity.total()
    }
}

impl Capacity {
    /// Total capacity, in [`Self::unit`].
    #[must_use]
    pub fn total(&self) -> f64 {
        match self {
            Self::Time(total) | Self::Range(total) => *total,
            Self::Energy(energy) => energy.wh,
        }
    }

    /// The unit of [`Self::total`].
    #[must_use]
    pub fn unit(&self) -> &'static str {
        match self {
            Self::Time(_) => "s",
            Self::Range(_) => "m",
            Self::Energy(_) => "Wh",
        }
    }

    /// What straight flight at constant velocity consumes: duration in seconds, airspeed and
    /// vertical speed (positive up) in m/s.
    #[must_use]
    pub fn used(&self, duration_s: f64, air_mps: f64, up_mps: f64) -> f64 {
        match self {
            Self::Time(_) => duration_s,
            Self::Range(_) => duration_s * air_mps.hypot(up_mps),
            Self::Energy(energy) => duration_s * energy.power_w(air_mps, up_mps) / 3600.0,
        }
    }
}

impl Energy {
    /// Power at an airspeed and vertical speed, watts: linear between table entries, cubic above
    /// the last. A descent draws as much as level flight.
    #[must_use]
    pub fn power_w(&self, air_mps: f64, up_mps: f64) -> f64 {
        let level = &self.level;
        let after = level.partition_point(|(speed_mps, _)| *speed_mps <= air_mps);
        let level_w = match (after.checked_sub(1).map(|at| level[at]), level.get(after)) {
            (Some(low), Some(&high)) => {
                low.1 + (high.1 - low.1) * (air_mps - low.0) / (high.0 - low.0)
            }
            (Some((speed_mps, power_w)), None) if speed_mps > 0.0 => {
                power_w * (air_mps / speed_mps).powi(3)
            }
            (Some(only), None) => only.1,
            (None, first) => first.map_or(0.0, |first| first.1),
        };
        level_w + self.climbing_w * (up_mps / self.climb_mps).max(0.0)
    }
}

impl Vehicle {
    /// The most that it uses in a time at an altitude in which it waits or is slower than planned, in
    /// [`Capacity::unit`]; 0 without an endurance. A copter hovers, in still air or against the wind, a wing circles, and
    /// a VTOL may do either. Slow flight of a copter uses no more than a hover in place of the time that it takes longer:
    /// power over speed is convex.
    #[must_use]
    pub fn used_waiting(&self, duration_s: f64, wind_mps: f64, at: Amsl) -> f64 {
        let Some(endurance) = &self.endurance else {
            return 0.0;
        };
        let hovers = (self.airframe != Airframe::Plane).then_some([0.0, wind_mps]);
        let circles = self.wing.map(|_| self.through_air_mps(self.speed_mps, at));
        let used = |air_mps: f64| endurance.capacity.used(duration_s, air_mps, 0.0);
        let airspeeds_mps = hovers.into_iter().flatten().chain(circles);
        airspeeds_mps.map(used).fold(0.0, f64::max)
    }

    /// A warning where it is planned slower or faster than the powers of its table were measured at.
    #[must_use]
    pub fn energy_note(&self) -> Option<String> {
        let Capacity::Energy(energy) = &self.endurance.as_ref()?.capacity else {
            return None;
        };
        let (first, last) = (energy.level.first()?.0, energy.level.last()?.0);
        // A copter that has its hover alone has no table.
        if last <= 0.0 {
            return None;
        }
        let Span { least, most } = self.speeds();
        let (planned_mps, how) = match (least < first, most > last) {
            (_, true) => (most, "power grows there with the cube of speed"),
            (true, false) => (least, "the power of the slowest is taken there"),
            (false, false) => return None,
        };
        Some(format!(
            "{}: {} m/s is planned, and endurance.energy.cruise covers {} to {} m/s; {how}: state a power for it",
            self.id,
            plain(planned_mps),
            plain(first),
            plain(last)
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }

    #[test]
    fn power_is_linear_between_speeds_and_cubic_beyond_the_last() {
        let energy = Energy {
            wh: 100.0,
            climbing_w: 60.0,
            climb_mps: 3.0,
            level: vec![(0.0, 300.0), (10.0, 200.0), (20.0, 400.0)],
        };
        near(energy.power_w(0.0, 0.0), 300.0);
        near(energy.power_w(15.0, 0.0), 300.0);
        near(energy.power_w(40.0, 0.0), 3200.0);
        near(energy.power_w(10.0, 1.5), 230.0);
        near(energy.power_w(10.0, -2.0), 200.0);
        near(Capacity::Energy(energy).used(1800.0, 10.0, 0.0), 100.0);
    }

    #[test]
    fn a_vtol_that_waits_uses_what_the_dearer_of_a_hover_and_a_circle_does() {
        use crate::spec::{Airframe, Wing, fixtures};
        let energy = |hover_w, cruise_w| Energy {
            wh: 100.0,
            climbing_w: 0.0,
            climb_mps: 3.0,
            level: vec![(0.0, hover_w), (10.0, cruise_w), (20.0, cruise_w)],
        };
        let used_w = |airframe, energy: Energy| {
            let wing = Wing {
                takeoff_heading_rad: None,
                landing: None,
                loiter_radius_m: 100.0,
                ceiling: Amsl(500.0),
            };
            let vehicle = Vehicle {
                airframe,
                wing: (airframe != Airframe::Copter).then_some(wing),
                endurance: Some(Endurance {
                    capacity: Capacity::Energy(energy),
                    reserve: 0.0,
                }),
                ..fixtures::copter()
            };
            vehicle.used_waiting(3600.0, 0.0, Amsl(100.0))
        };
        near(used_w(Airframe::Vtol, energy(900.0, 200.0)), 900.0);
        near(used_w(Airframe::Vtol, energy(100.0, 200.0)), 200.0);
        near(used_w(Airframe::Plane, energy(900.0, 200.0)), 200.0);
        near(used_w(Airframe::Copter, energy(300.0, 900.0)), 300.0);
    }

    #[test]
    fn a_reserve_is_not_usable() {
        let endurance = Endurance {
            capacity: Capacity::Range(20_000.0),
            reserve: 0.2,
        };
        near(endurance.usable(), 16_000.0);
        near(endurance.capacity.used(100.0, 3.0, 4.0), 500.0);
    }
}
