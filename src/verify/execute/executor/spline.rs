//! Splines of ArduCopter: the Hermite curves of its `SplineCurve`, by its sources.
//!
//! The curve of a `NAV_SPLINE_WAYPOINT` leads from the place before with the direction of the leg
//! before (at rest: with none) to its place. There its direction is that from the place before to the
//! place after if a spline follows, else that to the place after, and none where the vehicle stops
//! (`AC_WPNav::set_spline_destination`).

use nalgebra::Vector3;

use super::Pilot;
use crate::geodesy::{Amsl, EastNorth, LatLon, PlanPoint};
use crate::mission::{VehicleMission, command};
use crate::path::stop_late_s;
use crate::verify::execute::decode::{After, Step, Unknown};
use crate::verify::execute::flight::{Cruise, Slope};
use crate::verify::execute::item::{self, Height, Order};
use crate::verify::execute::legs::Knot;
use crate::verify::execute::trajectory::AltitudeLine;
use crate::verify::measure::segment::Segment;

/// Tangents that together are longer than this multiple of the distance are shortened (`SPLINE_FACTOR`).
const TANGENTS: f64 = 4.0;
/// Share of the acceleration along and across the curve (`TANGENTIAL_ACCEL_SCALER`).
const SHARE: f64 = 0.5;
/// Segments are never further from the curve, metres.
const CHORD_ERROR_M: f64 = 0.02;
/// A shorter curve is none, metres: ArduPilot stores 1e-7 degrees and centimetres.
const MIN_M: f64 = 0.005;

/// A cubic curve, for 0 to 1: its coefficients, metres.
struct Curve([Vector3<f64>; 4]);

impl Curve {
    fn new(ends: [Vector3<f64>; 2], mut tangents: [Vector3<f64>; 2]) -> Self {
        let [from, to] = ends;
        let (long_m, max_m) = (
            tangents[0].norm() + tangents[1].norm(),
            TANGENTS * (to - from).norm(),
        );
        if long_m > max_m {
            tangents = tangents.map(|tangent| tangent * (max_m / long_m));
        }
        let [leave, arrive] = tangents;
        Self([
            from,
            leave,
            (to - from) * 3.0 - leave * 2.0 - arrive,
            (from - to) * 2.0 + leave + arrive,
        ])
    }

    fn at(&self, t: f64) -> Vector3<f64> {
        let [a, b, c, d] = self.0;
        a + (b + (c + d * t) * t) * t
    }

    fn velocity(&self, t: f64) -> Vector3<f64> {
        let [_, b, c, d] = self.0;
        b + (c * 2.0 + d * (3.0 * t)) * t
    }

    fn acceleration(&self, t: f64) -> Vector3<f64> {
        let [_, _, c, d] = self.0;
        c * 2.0 + d * (6.0 * t)
    }

    /// Radius of the curve, metres; infinite where it is straight or has no direction.
    fn radius_m(&self, t: f64) -> f64 {
        let (velocity, acceleration) = (self.velocity(t), self.acceleration(t));
        let speed = velocity.norm();
        let across = velocity.cross(&acceleration).norm();
        if across > 0.0 && speed > 0.0 {
            speed.powi(3) / across
        } else {
            f64::INFINITY
        }
    }

    /// Into how many segments of equal time it is cut.
    fn count(&self) -> u32 {
        let bend = self
            .acceleration(0.0)
            .norm()
            .max(self.acceleration(1.0).norm());
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to a small positive count"
        )]
        let count = (bend / (8.0 * CHORD_ERROR_M))
            .sqrt()
            .ceil()
            .clamp(16.0, 1e4) as u32;
        count
    }
}

/// The ends of a spline and its directions there.
struct Ends {
    to: Knot,
    /// Whether its altitudes are heights above the ground.
    follows: bool,
    curve: Curve,
    /// Its direction at the end, not shortened; zero where the vehicle stops.
    arrive: Vector3<f64>,
}

fn vector(at: EastNorth, up_m: f64) -> Vector3<f64> {
    Vector3::new(at.east_m, at.north_m, up_m)
}

/// Place and height in the reference of the item.
fn of_knot(knot: &Knot) -> Vector3<f64> {
    vector(knot.at, knot.agl_m.unwrap_or(knot.amsl_m))
}

impl Pilot<'_> {
    /// Flies a spline, and holds at its end.
    pub(crate) fn spline(
        &mut self,
        target: (usize, LatLon, Height),
        hold_s: Option<f64>,
        (next, mission): (&After<'_>, &VehicleMission),
    ) -> Result<(), Unknown> {
        let row = target.0;
        if self.is_doubled {
            // It would begin in the direction of the leg between the two (`AC_WPNav::set_spline_destination_NED_m`).
            let why =
                "a spline after two waypoints at one place: its beginning has no known direction";
            return Unknown::err(row, why);
        }
        let Some(ends) = self.spline_ends(target, hold_s.is_some(), (next, mission))? else {
            // A waypoint where the vehicle is already.
            self.stop()?;
            hold_s.into_iter().for_each(|hold_s| self.hold(row, hold_s));
            return Ok(());
        };
        if self.knots.len() > 1 {
            let first_mps = self.speed_limit_mps(&ends, 0.0);
            self.fly_to_last(first_mps)?;
        }
        self.lay_spline(&ends)?;
        self.tangent = (self.moving_mps > 0.0).then_some(ends.arrive);
        self.knots = vec![ends.to];
        self.mark();
        self.phase_in();
        hold_s.into_iter().for_each(|hold_s| self.hold(row, hold_s));
        Ok(())
    }

    /// The curve to a place; none where the vehicle is there already.
    fn spline_ends(
        &mut self,
        (row, place, height): (usize, LatLon, Height),
        stops: bool,
        (next, mission): (&After<'_>, &VehicleMission),
    ) -> Result<Option<Ends>, Unknown> {
        let at = self.reach(row, place)?;
        let (amsl_m, agl_m) = self.resolve(row, place, height)?;
        let to = self.knot(row, at, amsl_m, agl_m);
        let follows = agl_m.is_some();
        if self.last().agl_m.is_some() != follows {
            self.stop()?;
            self.tangent = None;
        }
        let mut leave = self.tangent.unwrap_or_default();
        if let [.., before, last] = self.knots.as_slice() {
            let before_m = match (before.agl_m, last.agl_m) {
                (None, Some(_)) => {
                    let below = self.world.frame.from_plan(before.at);
                    before.amsl_m - self.trajectory.ground_m(row, below)?
                }
                (Some(_), None) => before.amsl_m,
                _ => of_knot(before).z,
            };
            leave = of_knot(last) - vector(before.at, before_m);
        }
        let mut from = self.last();
        if follows && from.agl_m.is_none() {
            let below = self.world.frame.from_plan(from.at);
            from.agl_m = Some(from.amsl_m - self.trajectory.ground_m(row, below)?);
        } else if !follows {
            from.agl_m = None;
        }
        let (begin, end) = (of_knot(&from), of_knot(&to));
        if (end - begin).norm() < MIN_M {
            return Ok(None);
        }
        let arrive = match next {
            _ if stops => Vector3::zeros(),
            After::End => Vector3::zeros(),
            After::Unread => {
                return Unknown::err(row, "a spline, and the item after it is not known");
            }
            After::Step(step) => self.arrival((&from, &to), step, mission)?,
        };
        let curve = Curve::new([begin, end], [leave, arrive]);
        Ok(Some(Ends {
            to,
            follows,
            curve,
            arrive,
        }))
    }

    /// The direction at the end of a spline, by the item that is flown to after it.
    fn arrival(
        &self,
        (from, to): (&Knot, &Knot),
        step: &Step,
        mission: &VehicleMission,
    ) -> Result<Vector3<f64>, Unknown> {
        let item = &mission.items[step.row - 1];
        let known = [
            command::NAV_WAYPOINT,
            command::NAV_SPLINE_WAYPOINT,
            command::NAV_LOITER_UNLIM,
            command::NAV_LOITER_TIME,
            command::NAV_LAND,
        ];
        if step.order == Order::Return {
            // Its place is none: the vehicle stops.
            return Ok(Vector3::zeros());
        }
        if !known.contains(&item.command) {
            let why = "a spline before an item that is neither a waypoint nor a landing";
            return Unknown::err(to.row, why);
        }
        let unread = |why| Unknown { row: step.row, why };
        let height = item::own_height(item, mission.autopilot, self.home.amsl).map_err(unread)?;
        let at = match item.place().filter(|_| (item.x, item.y) != (0, 0)) {
            Some(place) => self.reach(step.row, place)?,
            None => to.at,
        };
        let next_m = match height {
            Height::Keep { .. } => to.agl_m.unwrap_or(to.amsl_m),
            Height::Ground(agl) if to.agl_m.is_some() => agl.0,
            Height::Sea(amsl) if to.agl_m.is_none() => amsl.0,
            // From above the ground to above the sea, or the other way round, it stops.
            _ => return Ok(Vector3::zeros()),
        };
        let begin = match item.command {
            command::NAV_SPLINE_WAYPOINT => of_knot(from),
            _ => of_knot(to),
        };
        let arrive = vector(at, next_m) - begin;
        Ok(match arrive.norm() < MIN_M {
            true => Vector3::zeros(),
            false => arrive,
        })
    }

    /// The speed at which a spline is flown at a time of its own, m/s.
    fn speed_limit_mps(&self, ends: &Ends, t: f64) -> f64 {
        let velocity = ends.curve.velocity(t);
        let sine = velocity.z.abs() / velocity.norm().max(1e-9);
        let cosine = (1.0 - sine * sine).max(0.0).sqrt();
        let vertical_mps = match velocity.z > 0.0 {
            true => self.vehicle.climb_mps,
            false => self.vehicle.descent_mps,
        };
        let across_mps = (SHARE * self.vehicle.accel_mps2 * ends.curve.radius_m(t)).sqrt();
        (ends.to.speed_mps / cosine.max(1e-9))
            .min(vertical_mps / sine.max(1e-9))
            .min(across_mps)
    }

    /// Lays the segments of a spline.
    fn lay_spline(&mut self, ends: &Ends) -> Result<(), Unknown> {
        let accel_mps2 = SHARE * self.vehicle.accel_mps2;
        let count = ends.curve.count();
        let end = ends.curve.at(1.0);
        let last_mps = match ends.arrive.norm() > 0.0 {
            true => self.speed_limit_mps(ends, 1.0),
            false => 0.0,
        };
        let mut speed_mps = self.moving_mps.min(self.speed_limit_mps(ends, 0.0));
        let first = self.trajectory.segments.len();
        let before_s = self.trajectory.late_s;
        for index in 1..=count {
            let time = |index: u32| f64::from(index) / f64::from(count);
            let (from, to) = (ends.curve.at(time(index - 1)), ends.curve.at(time(index)));
            let length_m = (to - from).norm();
            let left_m = (end - to).norm();
            let max_mps = self
                .speed_limit_mps(ends, time(index))
                .min((last_mps * last_mps + 2.0 * accel_mps2 * left_m).sqrt());
            let change = 2.0 * accel_mps2 * length_m;
            let square = speed_mps * speed_mps;
            let next_mps =
                max_mps.clamp((square - change).max(0.0).sqrt(), (square + change).sqrt());
            let duration_s = 2.0 * length_m / (speed_mps + next_mps).max(1e-6);
            let error_m = CHORD_ERROR_M + accel_mps2 * duration_s * duration_s / 8.0;
            // What it takes longer it loses along the way.
            self.trajectory.late_s = before_s + time(index) * stop_late_s(self.vehicle);
            self.lay_spline_segment(ends, (from, to), (duration_s, error_m))?;
            speed_mps = next_mps;
        }
        self.moving_mps = if last_mps > 0.0 { speed_mps } else { 0.0 };
        self.flight.cruises.push(Cruise {
            segment: first,
            speed_mps: ends.to.speed_is_known.then_some(ends.to.speed_mps),
        });
        let segments = self.trajectory.segments[first..].iter().zip(first..);
        for (segment, index) in segments {
            self.flight.slopes.push(Slope {
                segment: index,
                phase: segment.phase,
                run_m: segment.from.at.distance_m(segment.to.at),
                rise_m: segment.to.amsl.0 - segment.from.amsl.0,
                speed_mps: ends.to.speed_mps,
                top_m: segment.to.amsl.0.max(segment.from.amsl.0),
            });
        }
        self.flight.follows_terrain |= ends.follows;
        Ok(())
    }

    fn lay_spline_segment(
        &mut self,
        ends: &Ends,
        (from, to): (Vector3<f64>, Vector3<f64>),
        (duration_s, error_m): (f64, f64),
    ) -> Result<(), Unknown> {
        let here = |point: Vector3<f64>| PlanPoint::new(point.x, point.y, Amsl(f64::NAN));
        let (from_s, knot) = (self.trajectory.t_s, &ends.to);
        let times_s = (from_s, from_s + duration_s);
        let segment = Segment {
            error_m,
            bow_m: CHORD_ERROR_M,
            ..Segment::unflown((knot.row, knot.phase), times_s, (here(from), here(to)))
        };
        self.trajectory.curve(
            segment,
            &AltitudeLine::between(ends.follows, (from.z, to.z)),
        )
    }
}
