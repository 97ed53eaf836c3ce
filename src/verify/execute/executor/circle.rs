//! Circles of ArduCopter (`NAV_LOITER_TURNS`), by its sources (`ModeAuto::circle_movetoedge_start`,
//! `AC_Circle`).
//!
//! It flies straight to the nearest place of the circle, stops there, flies the turns as fast as half
//! of its acceleration and `CIRCLE_RATE` allow, and comes to rest along the tangent.

use std::f64::consts::TAU;

use super::Pilot;
use crate::autopilot::{Version, parameter};
use crate::geodesy::{EastNorth, LatLon};
use crate::mission::VehicleMission;
use crate::path::stop_late_s;
use crate::verify::execute::decode::Unknown;
use crate::verify::execute::flight::OnRotors;
use crate::verify::execute::item::{Circling, Height, Until};
use crate::verify::execute::legs::Knot;
use crate::verify::execute::trajectory::AltitudeLine;
use crate::verify::measure::segment::Segment;

/// Nearer to the middle or the rim than this it begins its circle where it is, metres.
const NEAR_M: f64 = 3.0;
/// Altitudes that differ by no more are the same, metres.
const LEVEL_M: f64 = 0.5;
/// Share of the acceleration that turns it.
const SHARE: f64 = 0.5;
/// `AC_CIRCLE_RADIUS_MAX`, metres.
const MAX_RADIUS_M: f64 = 2000.0;
/// Segments of a circle are never further off than this, metres.
const CHORD_ERROR_M: f64 = 0.02;

/// Whether a circle is flown at the altitude before it and not at its own, by the way to its rim in the plane and up: so near
/// to it 4.7 circles at once (`ModeAuto::circle_movetoedge_start`).
fn keeps_altitude((level_m, climb_m): (f64, f64), version: Option<Version>) -> bool {
    version.is_none_or(|version| version >= LEVEL_SINCE)
        && climb_m.abs() > LEVEL_M
        && level_m.hypot(climb_m) <= NEAR_M
}

/// A circle on rotors.
struct Orbit {
    middle: EastNorth,
    /// Metres, clockwise where positive.
    radius_m: f64,
    speed_mps: f64,
    /// Where it begins, radians counter-clockwise from east.
    begin_rad: f64,
}

/// Since 4.7 the nearest place of a circle is taken from the distance seen from above
/// (`AC_Circle::get_closest_point_on_circle_NED_m`).
const LEVEL_SINCE: Version = Version { major: 4, minor: 7 };

impl Orbit {
    /// The place after a turn by an angle.
    fn at(&self, turned_rad: f64) -> EastNorth {
        let (sin, cos) = (self.begin_rad - turned_rad * self.radius_m.signum()).sin_cos();
        EastNorth {
            east_m: self.middle.east_m + self.radius_m.abs() * cos,
            north_m: self.middle.north_m + self.radius_m.abs() * sin,
        }
    }
}

impl Pilot<'_> {
    pub(crate) fn circle_on_rotors(
        &mut self,
        (row, place, height): (usize, LatLon, Height),
        circle: Circling,
        mission: &VehicleMission,
    ) -> Result<(), Unknown> {
        let Until::Turns(turns) = circle.until else {
            return Unknown::err(row, "a circle for a time, on rotors");
        };
        self.stop()?;
        let middle = self.reach(row, place)?;
        let (amsl_m, agl_m) = self.resolve(row, place, height)?;
        let from = self.last();
        let away_m = from.at.distance_m(middle);
        if away_m < NEAR_M {
            return Unknown::err(
                row,
                "a circle around the place where it begins: on no known course",
            );
        }
        let radius_m = self.orbit_radius_m(circle, mission);
        if radius_m.abs() < 1.0 {
            return Unknown::err(row, "a circle without a radius turns on the spot");
        }
        let to_rim_m = (away_m - radius_m.abs(), amsl_m - from.amsl_m);
        if keeps_altitude(to_rim_m, mission.autopilot_version) {
            return Unknown::err(
                row,
                "a circle that begins within 3 m of its rim at another altitude: the copter keeps the one that it has",
            );
        }
        let edge = self.circle_edge((row, middle, radius_m.abs()), (amsl_m, agl_m), mission);
        let knot = self.knot(row, edge, amsl_m, agl_m);
        self.append(knot)?;
        self.stop()?;
        let rate_deg = mission
            .param_si("CIRCLE_RATE")
            .or_else(|| parameter("CIRCLE_RATE").map(|row| row.default_si()))
            .unwrap_or(0.0);
        let orbit = Orbit {
            middle,
            radius_m,
            speed_mps: self
                .last()
                .speed_mps
                .min((SHARE * self.vehicle.accel_mps2 * radius_m.abs()).sqrt())
                .min(rate_deg.abs().to_radians() * radius_m.abs()),
            begin_rad: (from.at.north_m - middle.north_m).atan2(from.at.east_m - middle.east_m),
        };
        if orbit.speed_mps <= 0.0 {
            return Unknown::err(row, "a circle that is not flown (CIRCLE_RATE 0)");
        }
        let aside_m = (radius_m.abs() - edge.distance_m(middle)).abs();
        self.turn_around(knot, &orbit, (turns, aside_m))?;
        self.circle_m = Some(radius_m.abs());
        self.phase_in();
        Ok(())
    }

    /// The place of a circle that the copter flies to. Before 4.7 it is computed from the distance to the middle in space, and
    /// can lie inside the circle. Without a known version the leg to the rim is judged as well, in space alone.
    fn circle_edge(
        &mut self,
        (row, middle, radius_m): (usize, EastNorth, f64),
        (amsl_m, agl_m): (f64, Option<f64>),
        mission: &VehicleMission,
    ) -> EastNorth {
        let from = self.last();
        let level_m = from.at.distance_m(middle);
        let space_m = level_m.hypot(from.amsl_m - amsl_m);
        let within = |far_m: f64| {
            let mix = |a: f64, b: f64| b + (a - b) * (radius_m / far_m);
            EastNorth {
                east_m: mix(from.at.east_m, middle.east_m),
                north_m: mix(from.at.north_m, middle.north_m),
            }
        };
        let rim = within(level_m);
        match mission.autopilot_version {
            Some(version) if version >= LEVEL_SINCE => return rim,
            None if agl_m.is_none() => {
                let t_s = self.trajectory.t_s;
                let ends = (from.point(), self.knot(row, rim, amsl_m, None).point());
                let segment = Segment::unflown((row, self.phase), (t_s, t_s), ends);
                self.trajectory.segments.push(segment);
            }
            _ => {}
        }
        within(space_m)
    }

    /// The radius of a circle, that of the circle before or of the parameters where it has none,
    /// metres.
    fn orbit_radius_m(&self, circle: Circling, mission: &VehicleMission) -> f64 {
        let own = Some(circle.radius_m.abs()).filter(|radius_m| *radius_m > 0.0);
        let radius_m = own
            .or(self.circle_m)
            .or_else(|| mission.param_si("CIRCLE_RADIUS"))
            .or_else(|| parameter("CIRCLE_RADIUS").map(|row| row.default_si()));
        let radius_m = radius_m.unwrap_or(0.0).min(MAX_RADIUS_M);
        radius_m.copysign(circle.radius_m)
    }

    /// Turns so often, and comes to rest.
    fn turn_around(
        &mut self,
        knot: Knot,
        orbit: &Orbit,
        (turns, aside_m): (f64, f64),
    ) -> Result<(), Unknown> {
        let step_rad = (8.0 * CHORD_ERROR_M / orbit.radius_m.abs()).sqrt();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to a small positive count"
        )]
        let count = (TAU * turns / step_rad).ceil().clamp(1.0, 1e5) as u32;
        let angle_rad = |index: u32| TAU * turns * f64::from(index) / f64::from(count);
        let value_m = knot.agl_m.unwrap_or(knot.amsl_m);
        let line = AltitudeLine::between(knot.agl_m.is_some(), (value_m, value_m));
        self.flight.follows_terrain |= knot.agl_m.is_some();
        let step_s = angle_rad(1) * orbit.radius_m.abs() / orbit.speed_mps;
        let first = self.trajectory.segments.len();
        // It speeds up to that, loses the rest along the turns, and stops along the tangent where its position controller
        // can.
        self.trajectory.late_s += orbit.speed_mps / self.vehicle.accel_mps2;
        let before_s = self.trajectory.late_s;
        if turns > 0.0 {
            for index in 0..count {
                let share = f64::from(index + 1) / f64::from(count);
                self.trajectory.late_s = before_s + share * stop_late_s(self.vehicle);
                let ends = (orbit.at(angle_rad(index)), orbit.at(angle_rad(index + 1)));
                self.lay_turn(knot, ends, step_s, &line)?;
            }
        }
        self.trajectory.late_s = before_s + stop_late_s(self.vehicle);
        let stop_m = stopping_m(orbit.speed_mps, self.vehicle.accel_mps2);
        let (end, before) = (orbit.at(TAU * turns), orbit.at(TAU * turns - 0.01));
        let unit_m = before.distance_m(end);
        let on = |a: f64, b: f64| b + (b - a) / unit_m * stop_m;
        let rest = EastNorth {
            east_m: on(before.east_m, end.east_m),
            north_m: on(before.north_m, end.north_m),
        };
        if turns > 0.0 {
            self.lay_turn(knot, (end, rest), 2.0 * stop_m / orbit.speed_mps, &line)?;
        }
        for segment in &mut self.trajectory.segments[first..] {
            segment.wide_m = segment.wide_m.max(aside_m);
        }
        self.flight.on_rotors.push(OnRotors {
            segments: first..self.trajectory.segments.len(),
            speed_mps: orbit.speed_mps,
        });
        let at = if turns > 0.0 { rest } else { knot.at };
        self.knots = vec![self.knot(knot.row, at, self.amsl_at(&knot, at)?, knot.agl_m)];
        self.moving_mps = 0.0;
        self.mark();
        Ok(())
    }

    /// The altitude of a knot moved to a place.
    fn amsl_at(&self, knot: &Knot, at: EastNorth) -> Result<f64, Unknown> {
        let Some(agl_m) = knot.agl_m else {
            return Ok(knot.amsl_m);
        };
        let place = self.world.frame.from_plan(at);
        Ok(self.trajectory.ground_m(knot.row, place)? + agl_m)
    }

    fn lay_turn(
        &mut self,
        knot: Knot,
        (from, to): (EastNorth, EastNorth),
        duration_s: f64,
        line: &AltitudeLine,
    ) -> Result<(), Unknown> {
        let from_s = self.trajectory.t_s;
        let times_s = (from_s, from_s + duration_s);
        let ends = (knot_at(knot, from), knot_at(knot, to));
        let segment = Segment {
            error_m: CHORD_ERROR_M,
            bow_m: CHORD_ERROR_M,
            ..Segment::unflown((knot.row, knot.phase), times_s, ends)
        };
        self.trajectory.curve(segment, line)
    }
}

fn knot_at(knot: Knot, at: EastNorth) -> crate::geodesy::PlanPoint {
    Knot { at, ..knot }.point()
}

/// How far on a copter comes to rest (`AC_PosControl::get_stopping_point_xy`, its gain being 1 /s).
fn stopping_m(speed_mps: f64, accel_mps2: f64) -> f64 {
    if speed_mps < accel_mps2 {
        speed_mps
    } else {
        0.5 * (accel_mps2 + speed_mps * speed_mps / accel_mps2)
    }
}
