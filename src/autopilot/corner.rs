//! How a copter flies around a waypoint: it slows down, cuts the corner, and speeds up again.
//!
//! **`ArduCopter`** (4.6, `AC_WPNav` and `SCurve`) gives every leg a profile from rest to rest with
//! limited acceleration and jerk. It begins the next leg while it still brakes on the one before, so
//! late that half of this overlap passes within `WPNAV_RADIUS` of the waypoint. The speeds that follow
//! from this are those flown on 4.6.3 within 0.2 m/s (2026-11-23, simulator, still air, 31 corners
//! of 10 to 150 degrees at 5 and 10 m/s with radius 2 and 5 m); the cut is the flown one or
//! up to twice as much. It begins the next leg no earlier than it may accelerate: in the middle of the
//! corner by `WPNAV_ACCEL_C` at most. With less than twice `WPNAV_ACCEL`, the default, it nearly stops at
//! sharp corners (flown on 4.7.0-dev, 2026-11-24, simulator: 1.6 m/s at 63 degrees, 0.4 m/s at 107).
//! [`measured`] has what the flown seconds of a leg differ by.
//!
//! **PX4** (1.16 to 1.18, `PositionSmoothing` and `computeMaxSpeedInWaypoint`) limits the speed at a
//! waypoint to that of a circle that touches both legs at the acceptance radius, with a share of
//! the acceleration. That is the least it takes: 1.17 keeps the speed with which a turn begins until it heads for the
//! next waypoint, and is slower than the circle then. [`measured`] has what it lost.

mod measured;

use super::command;

/// How the copters of an autopilot fly around a waypoint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CornerLaw {
    /// The profiles of two legs overlap: `ArduCopter`.
    Overlap,
    /// A circle that touches both legs at the acceptance radius: PX4.
    Circle,
}

/// Where a vehicle stops although its items do not say so, besides holds, delays, returns and
/// vertical legs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stops {
    /// At the waypoint before `NAV_LAND` at another place.
    pub before_landing: bool,
    /// At a waypoint whose altitude is above the terrain where that of the next one is not, or
    /// the other way round.
    pub between_altitude_kinds: bool,
    /// At `NAV_LOITER_TIME` of 0 s.
    pub at_timed_loiter: bool,
    /// At the waypoint before these commands.
    pub before: &'static [u16],
}

impl Stops {
    /// Nowhere.
    pub(super) const NONE: Self = Self {
        before_landing: false,
        between_altitude_kinds: false,
        at_timed_loiter: false,
        before: &[],
    };
    /// Wherever the next waypoint is not given to the navigation (`ModeAuto::set_next_wp`,
    /// `AC_WPNav::set_wp_destination_next`). Before a landing 0.03 m/s were flown on 4.6.3.
    pub(super) const ARDUCOPTER: Self = Self {
        before_landing: true,
        between_altitude_kinds: true,
        at_timed_loiter: true,
        before: &[command::NAV_LOITER_TURNS, command::NAV_LOITER_TO_ALT],
    };
}

/// `WPNAV_JERK`, m/s^3: the default.
const JERK_MPS3: f64 = 1.0;
/// Share of the acceleration that turns a PX4 copter: default of `MPC_XY_TRAJ_P`.
const PX4_TURNING_SHARE: f64 = 0.5;
/// Smaller half changes of course are none, radians.
const MIN_RAD: f64 = 1e-6;

/// What a copter's autopilot does at its corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cornering {
    law: CornerLaw,
    accel_mps2: f64,
    jerk_mps3: f64,
    /// The greatest acceleration in the middle of a corner, m/s^2.
    corner_mps2: f64,
}

/// A corner: change of course, the speed of its slower leg, and the radius within which the
/// waypoint is accepted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// Change of course, radians, never negative.
    pub angle_rad: f64,
    /// Cruise speed of the slower leg, m/s.
    pub speed_mps: f64,
    /// Acceptance radius, metres.
    pub radius_m: f64,
}

impl Turn {
    /// Half of the change of course; the tangent of a full reversal has no end.
    fn half_rad(&self) -> f64 {
        (0.5 * self.angle_rad).min(89.9_f64.to_radians())
    }
}

impl Cornering {
    /// A law, with the acceleration of a vehicle.
    #[must_use]
    pub fn new(law: CornerLaw, accel_mps2: f64) -> Self {
        Self {
            law,
            accel_mps2,
            jerk_mps3: JERK_MPS3,
            corner_mps2: f64::INFINITY,
        }
    }

    /// The same with a limit on the acceleration in the middle of a corner (`WPNAV_ACCEL_C`), m/s^2.
    #[must_use]
    pub fn within(self, corner_mps2: f64) -> Self {
        Self {
            corner_mps2,
            ..self
        }
    }

    /// The same with another jerk (`WPNAV_JERK`), m/s^3.
    #[must_use]
    pub fn with_jerk(self, jerk_mps3: f64) -> Self {
        Self { jerk_mps3, ..self }
    }

    /// The highest speed on a leg of a length, m/s: the profile of `ArduCopter` must find place on it
    /// from rest to rest.
    #[must_use]
    pub fn cruise_mps(&self, length_m: f64, speed_mps: f64) -> f64 {
        if self.law == CornerLaw::Circle {
            return speed_mps;
        }
        let min_m = self.bend_mps() * self.ramp_s(self.bend_mps());
        let max_mps = if length_m < min_m {
            (0.25 * self.jerk_mps3 * length_m * length_m).cbrt()
        } else {
            // v (v / a + a / j) = length
            let half = 0.5 * self.accel_mps2 * self.accel_mps2 / self.jerk_mps3;
            (half * half + self.accel_mps2 * length_m).sqrt() - half
        };
        speed_mps.min(max_mps)
    }

    /// How much of both legs an arc takes that cuts the corner as far as the vehicle does, metres.
    #[must_use]
    pub fn taken_m(&self, turn: &Turn) -> f64 {
        let half_rad = turn.half_rad();
        if half_rad < MIN_RAD {
            return 0.0;
        }
        match self.law {
            CornerLaw::Overlap => {
                let before_m = self.distance_m(self.overlap_s(turn));
                2.0 * before_m * half_rad.sin() / (0.5 * half_rad).tan()
            }
            CornerLaw::Circle => turn.radius_m,
        }
    }

    /// The constant speed of an arc that takes so much of both legs, m/s: on `ArduCopter` the one with
    /// which the leg lasts as long as flown, where the speed changes with the vehicle's acceleration.
    #[must_use]
    pub fn arc_mps(&self, turn: &Turn, taken_m: f64) -> f64 {
        let (v_mps, half_rad) = (turn.speed_mps, turn.half_rad());
        if self.law == CornerLaw::Circle {
            let turning_mps2 = PX4_TURNING_SHARE * self.accel_mps2;
            return v_mps.min((turning_mps2 * taken_m / half_rad.tan()).sqrt());
        }
        if half_rad < MIN_RAD {
            return v_mps;
        }
        if self.is_full(turn) {
            // As long as the way over the waypoint.
            return v_mps * half_rad / half_rad.tan();
        }
        let overlap_s = 2.0 * self.overlap_s(turn);
        let more_s = measured::more_s(turn.angle_rad.to_degrees());
        let lost_s = (self.ramp_s(v_mps) - overlap_s + more_s).max(0.0);
        // The loss falls with the speed.
        let (mut low_mps, mut high_mps) = (0.0, v_mps);
        for _ in 0..60 {
            let middle_mps = 0.5 * (low_mps + high_mps);
            if self.arc_loses_s(turn, taken_m, middle_mps) > lost_s {
                low_mps = middle_mps;
            } else {
                high_mps = middle_mps;
            }
        }
        high_mps
    }

    /// By how much longer a corner may take than its arc, seconds: what it may lose against the legs
    /// through its waypoint, without what the arc loses, and slowing down for it.
    #[must_use]
    pub fn late_s(&self, turn: &Turn, taken_m: f64) -> f64 {
        if self.law != CornerLaw::Circle || turn.half_rad() < MIN_RAD || taken_m <= 0.0 {
            return 0.0;
        }
        let slower = (measured::MEASURED_AT_MPS2 / self.accel_mps2).max(1.0);
        let lost_s = slower * measured::lost_s(turn.angle_rad.to_degrees(), turn.speed_mps);
        let arc_s = self.arc_loses_s(turn, taken_m, self.arc_mps(turn, taken_m));
        (lost_s - arc_s).max(0.0)
    }

    /// By how much longer than the legs through the waypoint an arc takes at a constant speed, with slowing down for it and
    /// speeding up again, seconds.
    fn arc_loses_s(&self, turn: &Turn, taken_m: f64, arc_mps: f64) -> f64 {
        let slower_mps = turn.speed_mps - arc_mps;
        let braking_s = slower_mps * slower_mps / (self.accel_mps2 * turn.speed_mps);
        let arc_m = taken_m / turn.half_rad().tan() * turn.angle_rad;
        braking_s + arc_m / arc_mps - 2.0 * taken_m / turn.speed_mps
    }

    /// The speed nearest to the waypoint, m/s.
    #[must_use]
    pub fn min_mps(&self, turn: &Turn) -> f64 {
        match self.law {
            CornerLaw::Overlap => {
                2.0 * self.speed_mps(self.overlap_s(turn)) * turn.half_rad().cos()
            }
            CornerLaw::Circle => self.arc_mps(turn, turn.radius_m),
        }
    }

    /// Speed at which the acceleration just reaches its limit, m/s.
    fn bend_mps(&self) -> f64 {
        self.accel_mps2 * self.accel_mps2 / self.jerk_mps3
    }

    /// From rest to a speed, seconds.
    fn ramp_s(&self, speed_mps: f64) -> f64 {
        if speed_mps >= self.bend_mps() {
            speed_mps / self.accel_mps2 + self.accel_mps2 / self.jerk_mps3
        } else {
            2.0 * (speed_mps / self.jerk_mps3).sqrt()
        }
    }

    /// How far a leg has come after a time, up to half of its ramp, metres.
    fn distance_m(&self, time_s: f64) -> f64 {
        let bend_s = self.accel_mps2 / self.jerk_mps3;
        let jerked_s = time_s.min(bend_s);
        let more_s = time_s - jerked_s;
        self.jerk_mps3 * jerked_s.powi(3) / 6.0
            + more_s * (0.5 * self.jerk_mps3 * jerked_s * jerked_s + 0.5 * self.accel_mps2 * more_s)
    }

    /// Its speed then, m/s.
    fn speed_mps(&self, time_s: f64) -> f64 {
        let jerked_s = time_s.min(self.accel_mps2 / self.jerk_mps3);
        0.5 * self.jerk_mps3 * jerked_s * jerked_s + self.accel_mps2 * (time_s - jerked_s)
    }

    /// Half of the time for which two legs overlap, seconds.
    fn overlap_s(&self, turn: &Turn) -> f64 {
        let full_s = 0.5 * self.ramp_s(turn.speed_mps);
        if self.is_full(turn) {
            return full_s;
        }
        let by_radius_s = self.overlap_by_radius_s(turn);
        // The two legs accelerate across each other: `2 j t sin h` in the middle.
        let by_accel_s = self.corner_mps2 / (2.0 * self.jerk_mps3 * turn.half_rad().sin());
        if self.is_limited(turn) {
            by_radius_s.min(by_accel_s)
        } else {
            by_radius_s
        }
    }

    /// Whether the two ramps together accelerate more in a corner than it may.
    fn is_limited(&self, turn: &Turn) -> bool {
        let ramp_mps2 = self
            .accel_mps2
            .min((self.jerk_mps3 * turn.speed_mps).sqrt());
        2.0 * ramp_mps2 * turn.half_rad().sin() >= self.corner_mps2
    }

    /// The same as far as the acceptance radius limits it, seconds.
    fn overlap_by_radius_s(&self, turn: &Turn) -> f64 {
        let full_s = 0.5 * self.ramp_s(turn.speed_mps);
        if self.is_within_radius(turn) {
            return full_s;
        }
        let before_m = turn.radius_m / (2.0 * turn.half_rad().sin());
        let bend_s = self.accel_mps2 / self.jerk_mps3;
        let bend_m = self.jerk_mps3 * bend_s.powi(3) / 6.0;
        if before_m <= bend_m {
            (6.0 * before_m / self.jerk_mps3).cbrt()
        } else {
            let bend_mps = 0.5 * self.bend_mps();
            let root = (bend_mps * bend_mps + 2.0 * self.accel_mps2 * (before_m - bend_m)).sqrt();
            bend_s + (root - bend_mps) / self.accel_mps2
        }
    }

    /// Whether a leg takes longer for the corner.
    #[must_use]
    pub fn takes_time(&self, turn: &Turn) -> bool {
        match self.law {
            CornerLaw::Overlap => !self.is_full(turn),
            CornerLaw::Circle => self.arc_mps(turn, turn.radius_m) < turn.speed_mps,
        }
    }

    /// Whether the whole of both ramps overlaps within the acceptance radius: nothing is lost.
    fn is_full(&self, turn: &Turn) -> bool {
        self.is_within_radius(turn) && !self.is_limited(turn)
    }

    fn is_within_radius(&self, turn: &Turn) -> bool {
        let full_m = self.distance_m(0.5 * self.ramp_s(turn.speed_mps));
        2.0 * full_m * turn.half_rad().sin() <= turn.radius_m
    }
}

#[cfg(test)]
mod tests {
    use super::{CornerLaw, Cornering, Turn};

    /// Flown on `ArduCopter` 4.6.3 with 2.5 m/s^2 and default jerk: change of course, degrees; least speed, m/s,
    /// and closest to the waypoint, metres, at 10 m/s with radius 2 and 5 m; least speed at 5 m/s with 2 m.
    type Row = (f64, [(f64, f64); 2], f64);
    const FLOWN: [Row; 11] = [
        (10.0, [(9.9, 0.9), (9.9, 0.9)], 5.0),
        (20.0, [(9.8, 1.8), (9.9, 1.8)], 4.9),
        (30.0, [(7.7, 1.7), (9.7, 2.6)], 4.8),
        (45.0, [(5.8, 1.6), (9.3, 3.9)], 4.6),
        (60.0, [(4.5, 1.5), (8.1, 4.4)], 4.3),
        (75.0, [(3.6, 1.3), (6.6, 4.3)], 3.7),
        (90.0, [(2.9, 1.2), (5.4, 4.2)], 3.0),
        (105.0, [(2.3, 1.1), (4.4, 4.1)], 2.4),
        (120.0, [(1.8, 1.0), (3.4, 4.0)], 1.8),
        (135.0, [(1.3, 0.9), (2.5, 3.9)], 1.4),
        (150.0, [(0.9, 0.9), (1.6, 3.8)], 0.9),
    ];

    fn turn(turn_deg: f64, speed_mps: f64, radius_m: f64) -> Turn {
        Turn {
            angle_rad: turn_deg.to_radians(),
            speed_mps,
            radius_m,
        }
    }

    #[test]
    fn arducopter_has_the_speeds_and_cuts_that_were_flown() {
        let law = Cornering::new(CornerLaw::Overlap, 2.5);
        for (turn_deg, at_10_mps, slow_mps) in FLOWN {
            for ((flown_mps, closest_m), radius_m) in at_10_mps.into_iter().zip([2.0, 5.0]) {
                let corner = turn(turn_deg, 10.0, radius_m);
                let min_mps = law.min_mps(&corner);
                assert!(
                    (min_mps - flown_mps).abs() < 0.2,
                    "{turn_deg} {radius_m}: {min_mps}"
                );
                let cut_m = law.taken_m(&corner) * (0.25 * corner.angle_rad).tan();
                assert!(cut_m > closest_m - 0.05, "{turn_deg} {radius_m}: {cut_m}");
                assert!(cut_m <= radius_m + 1e-9, "{turn_deg} {radius_m}: {cut_m}");
            }
            let min_mps = law.min_mps(&turn(turn_deg, 5.0, 2.0));
            assert!((min_mps - slow_mps).abs() < 0.2, "{turn_deg}: {min_mps}");
        }
    }

    /// Flown on `ArduCopter` 4.7.0-dev with 1.5 m/s^2, `WPNAV_ACCEL_C` 150 and radius 5 m: speed, m/s, change of
    /// course, degrees, and least speed, m/s.
    const FLOWN_WITHIN_1500_MMPS2: [(f64, f64, f64); 14] = [
        (7.1, 18.0, 6.9),
        (7.1, 26.0, 6.9),
        (7.1, 63.0, 1.6),
        (7.1, 64.0, 1.6),
        (7.1, 89.0, 0.6),
        (7.1, 107.0, 0.4),
        (5.6, 34.0, 5.3),
        (5.6, 37.0, 5.3),
        (5.6, 66.0, 1.5),
        (5.6, 73.0, 1.3),
        (5.6, 81.0, 1.0),
        (5.6, 86.0, 0.8),
        (5.6, 121.0, 0.3),
        (5.6, 129.0, 0.2),
    ];

    #[test]
    fn arducopter_nearly_stops_where_it_may_not_accelerate_through_the_corner() {
        let law = Cornering::new(CornerLaw::Overlap, 1.5).within(1.5);
        for (speed_mps, turn_deg, flown_mps) in FLOWN_WITHIN_1500_MMPS2 {
            let min_mps = law.min_mps(&turn(turn_deg, speed_mps, 5.0));
            let more_mps = min_mps - flown_mps;
            assert!(
                (-0.1..0.25).contains(&more_mps),
                "{turn_deg}: {min_mps}, flown {flown_mps}"
            );
        }
        // A leg of 89 m between corners of 64 and 89 degrees took 16.3 s, without the limit 12.9 s.
        let lost_s = |turn_deg: f64| {
            let corner = turn(turn_deg, 7.1, 5.0);
            let overlap_s = 2.0 * law.overlap_s(&corner);
            law.ramp_s(7.1) - overlap_s + super::measured::more_s(turn_deg)
        };
        let leg_s = 89.0 / 7.1 + 0.5 * (lost_s(64.0) + lost_s(89.0));
        assert!((leg_s - 16.3).abs() < 0.2, "{leg_s}");
        // Twice the acceleration limits nothing: what the law was measured with, and what plans set.
        let corner = turn(150.0, 7.1, 5.0);
        let free = Cornering::new(CornerLaw::Overlap, 1.5);
        assert!((free.within(3.0).min_mps(&corner) - free.min_mps(&corner)).abs() < 1e-12);
    }

    #[test]
    fn an_arc_is_never_faster_than_its_legs_and_never_stands() {
        for law in [CornerLaw::Overlap, CornerLaw::Circle] {
            for accel_mps2 in [1.0, 2.5, 5.0] {
                let law = Cornering::new(law, accel_mps2);
                for turn_deg in [0.0, 1.0, 45.0, 90.0, 179.9, 180.0] {
                    for speed_mps in [0.5, 8.0, 22.0] {
                        let corner = turn(turn_deg, speed_mps, 2.0);
                        let taken_m = law.taken_m(&corner).min(30.0);
                        let arc_mps = law.arc_mps(&corner, taken_m);
                        assert!(
                            arc_mps > 0.0 && arc_mps <= speed_mps,
                            "{corner:?} {arc_mps}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn straight_on_takes_nothing_of_the_legs() {
        for law in [CornerLaw::Overlap, CornerLaw::Circle] {
            let law = Cornering::new(law, 2.5);
            assert!(law.taken_m(&turn(0.0, 10.0, 5.0)) <= 0.0);
        }
    }

    #[test]
    fn a_short_leg_holds_the_whole_profile_of_arducopter() {
        let law = Cornering::new(CornerLaw::Overlap, 2.5);
        for length_m in [1.0, 20.0, 39.0, 40.0, 60.0] {
            let peak_mps = law.cruise_mps(length_m, 10.0);
            let needed_m = peak_mps * law.ramp_s(peak_mps);
            assert!((needed_m - length_m).abs() < 1e-9, "{length_m}: {needed_m}");
        }
        assert!((law.cruise_mps(70.0, 10.0) - 10.0).abs() < 1e-12);
    }
}

/// Commands that a vehicle stores and does not start, or that set limits of another mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Skips {
    /// Those that it passes in flight.
    pub passing: &'static [u16],
    /// Those before which it stops at the waypoint.
    pub at_rest: &'static [u16],
}

impl Skips {
    /// None.
    pub(super) const NONE: Self = Self {
        passing: &[],
        at_rest: &[],
    };
}
