//! What only a wing does: climb out along a course, circle, glide to the ground.

use std::f64::consts::{FRAC_PI_2, TAU};

use crate::geodesy::{Amsl, EastNorth, LatLon, PlanPoint};
use crate::mission::{Item, command, turn_radius_m};
use crate::numeric::geometry;
use crate::path::{along, climb_out, heading_rad};
use crate::spec::Autopilot;

use super::drift::carried_points;
use super::overshoot::share;
use crate::verify::execute::decode::Unknown;
use crate::verify::execute::executor::{Pilot, SAME_PLACE_M};
use crate::verify::execute::flight::{Circle, EarlyTop, End, Mark, Round};
use crate::verify::execute::item::Height;
use crate::verify::execute::legs::{Knot, ground_speed, turn_radius_at_m};
use crate::verify::execute::trajectory::AltitudeLine;
use crate::verify::limits::space::SLOPE_SHARE;
use crate::verify::measure::segment::{Column, Phase, Segment};
use crate::world::Terrain;

/// A plane finds the ground within this of the altitude that it lands at: it flares by its own
/// measurements of height.
const LANDING_M: f64 = 10.0;
/// A climb-out and a glide are slopes so far above `min_agl` at least, metres: with the lag of their climb under
/// them what follows would begin below that, over flat ground.
const MIN_SLOPE_M: f64 = 20.0;
/// Segments of a circle are never further off than this, metres.
const CHORD_ERROR_M: f64 = 0.02;
/// Ways onto a circle that are judged in space end no further apart than this, metres.
const BETWEEN_M: f64 = 30.0;

impl Pilot<'_> {
    /// Whether a wing turns at a waypoint by its own rule: ArduPlane within the `param2` of the item
    /// if there is one, in whole metres up to 255 (`Plane::verify_nav_wp`), PX4 too, and then earlier
    /// than judged where that is more than the radius of its turns.
    pub(crate) fn turns_by_itself(&self, row: usize, item: &Item) -> Result<(), Unknown> {
        let radius_m = f64::from(item.params[1]);
        let is_early = match self.vehicle.autopilot {
            Autopilot::ArduPilot => radius_m >= 1.0,
            Autopilot::Px4 => radius_m > turn_radius_m(self.vehicle),
        };
        if self.vehicle.airframe.has_wing() && item.command == command::NAV_WAYPOINT && is_early {
            let why = format!("param2 accepts the waypoint {radius_m} m before it");
            return Unknown::err(row, why);
        }
        Ok(())
    }

    /// Runs and climbs along the course of the spec, or towards the place of the item.
    pub(crate) fn climb_out(
        &mut self,
        row: usize,
        at: Option<LatLon>,
        height: Height,
    ) -> Result<(), Unknown> {
        let Some(planned_rad) = self.vehicle.wing.and_then(|wing| wing.takeoff_heading_rad) else {
            return Unknown::err(row, "a takeoff along a course, and the spec has none");
        };
        let home = self.home;
        let (top_m, _) = self.resolve(row, self.world.frame.from_plan(home.at), height)?;
        let course_rad = match at {
            Some(place) => heading_rad(home.at, self.reach(row, place)?),
            None => planned_rad,
        };
        self.trajectory.t_s = self.flight.delay_s.unwrap_or(self.vehicle.depart_s);
        let ground = |at: EastNorth| {
            let place = self.world.frame.from_plan(at);
            self.trajectory.ground_m(row, place).map_or(home.amsl, Amsl)
        };
        let climb = climb_out(self.vehicle, home.at, course_rad, ground, Amsl(top_m));
        let ground_m = ground(climb.lift_off).0;
        if top_m <= ground_m || top_m.is_nan() {
            let why = format!("takeoff to {top_m:.2} m AMSL, from {ground_m:.2} m");
            return Unknown::err(row, why);
        }
        self.flight.takeoff_rad = Some(course_rad);
        let lift_off = PlanPoint {
            at: climb.lift_off,
            amsl: Amsl(ground_m),
        };
        self.trajectory.straight(
            (row, self.phase),
            (home, lift_off),
            climb.run_s,
            Some(Column::Ground),
        );
        self.airborne = true;
        self.moving_mps = self.vehicle.speed_mps;
        let first = self.knot(row, lift_off.at, ground_m, None);
        self.knots = vec![first];
        let top = self.own_speed(self.knot(row, climb.top.at, top_m, None));
        self.knots.extend(self.in_two(&first, top, ground_m));
        self.steep_climb(&first, &top);
        let behaviour = &self.vehicle.facts().behaviour;
        self.trajectory.late_s += (behaviour.climb_late_s).value(self.vehicle.autopilot_version);
        self.phase = Phase::Route;
        Ok(())
    }

    /// A plane climbs out more steeply, goes over the height that it climbs to, and on to the
    /// next place from where it first has it.
    fn steep_climb(&mut self, lift_off: &Knot, top: &Knot) {
        if self.guidance.is_none() {
            return;
        }
        let (early_share, overshoot_m) = self.climb_out_figures();
        let mix = |a: f64, b: f64| a + (b - a) * early_share;
        let over = |at: EastNorth| PlanPoint {
            at,
            amsl: Amsl(top.amsl_m + overshoot_m),
        };
        let early = EastNorth {
            east_m: mix(lift_off.at.east_m, top.at.east_m),
            north_m: mix(lift_off.at.north_m, top.at.north_m),
        };
        let t_s = self.trajectory.t_s;
        let ends = (over(early), over(top.at));
        let segment = Segment::unflown((top.row, self.phase), (t_s, t_s), ends);
        self.trajectory.segments.push(segment);
        let climb_s = (top.amsl_m - lift_off.amsl_m) / self.vehicle.climb_mps;
        let early_top = EarlyTop {
            point: PlanPoint {
                at: early,
                amsl: Amsl(top.amsl_m),
            },
            off: self.carried_off(climb_s),
        };
        for point in carried_points(early_top).skip(1) {
            let carried = Knot {
                at: point.at,
                ..*top
            };
            self.lay_climb(lift_off, carried);
        }
        self.early_top = Some(early_top);
    }

    /// Lays a climb from the ground, to be judged in space.
    fn lay_climb(&mut self, lift_off: &Knot, top: Knot) {
        let t_s = self.trajectory.t_s;
        let mut from = *lift_off;
        for to in self.in_two(lift_off, top, lift_off.amsl_m) {
            // Where no height above ground is asked for, the first part has no length.
            if from.point() != to.point() {
                let ends = (from.point(), to.point());
                self.trajectory.segments.push(Segment {
                    slope_from_m: to.slope_from_m,
                    ..Segment::unflown((to.row, self.phase), (t_s, t_s), ends)
                });
            }
            from = to;
        }
    }

    /// Glides from where it is to a place, at the altitude of the item: that of the ground there.
    pub(crate) fn glide(
        &mut self,
        row: usize,
        place: LatLon,
        height: Height,
    ) -> Result<(), Unknown> {
        let at = self.reach(row, place)?;
        let ground_m = match (&self.world.terrain, height) {
            // It flares at the altitude of the item. Whether the ground is there, nobody knows.
            (Terrain::Unknown, Height::Sea(Amsl(amsl_m)))
                if (amsl_m - self.home.amsl.0).abs() > LANDING_M =>
            {
                self.flight.blind_landing_m = Some(amsl_m - self.home.amsl.0);
                amsl_m
            }
            (Terrain::Unknown, _) => self.home.amsl.0,
            _ => self.trajectory.ground_m(row, place)?,
        };
        if let Height::Sea(Amsl(amsl_m)) = height
            && (amsl_m - ground_m).abs() > LANDING_M
        {
            let why =
                format!("a landing at {amsl_m:.1} m AMSL, where the ground is at {ground_m:.1} m");
            return Unknown::err(row, why);
        }
        let from = self.last();
        self.phase = Phase::Finish;
        let down = self.knot(row, at, ground_m, None);
        let run_m = from.at.distance_m(at);
        if run_m <= 0.0 || from.amsl_m <= ground_m {
            let from_m = from.amsl_m;
            let why = format!("a landing at {ground_m:.2} m from {from_m:.2} m, {run_m:.0} m away");
            return Unknown::err(row, why);
        }
        self.flight.landing = Some((
            heading_rad(from.at, at),
            ((from.amsl_m - ground_m) / run_m).atan(),
        ));
        // High above the ground the way down is flown like any other.
        let upper = self.in_two(&down, from, ground_m);
        let mut middle = down;
        if let [split, _] = upper.as_slice() {
            middle = Knot {
                at: split.at,
                amsl_m: split.amsl_m,
                slope_from_m: None,
                ..down
            };
            self.append(middle)?;
        }
        self.append(Knot {
            slope_from_m: Some(ground_m),
            ..down
        })?;
        let speed_mps = middle.speed_mps;
        self.fly_to_last(speed_mps)?;
        self.ended = true;
        self.flight.end = Some(End::Landed(at));
        Ok(())
    }

    /// A leg that climbs from the ground, split into the part where its height decides the
    /// required clearance and the part where the minimum height does. That begins above its lag: where the slope
    /// begins it is on the ground.
    fn in_two(&self, ground: &Knot, top: Knot, ground_m: f64) -> Vec<Knot> {
        let min_agl_m = self.world.min_agl.0;
        let min_m = match self.world.terrain {
            Terrain::Unknown => 0.0,
            _ => min_agl_m + MIN_SLOPE_M,
        };
        let split_m = ground_m + (min_agl_m / SLOPE_SHARE).max(min_m);
        let sloping = |knot: Knot| Knot {
            slope_from_m: Some(ground_m),
            ..knot
        };
        if split_m >= top.amsl_m {
            return vec![sloping(top)];
        }
        let share = (split_m - ground_m) / (top.amsl_m - ground_m);
        let mix = |a: f64, b: f64| a + (b - a) * share;
        let split = Knot {
            at: EastNorth {
                east_m: mix(ground.at.east_m, top.at.east_m),
                north_m: mix(ground.at.north_m, top.at.north_m),
            },
            amsl_m: split_m,
            ..top
        };
        vec![sloping(split), top]
    }

    /// A takeoff is flown at the vehicle's own speed, taken to be the planned one.
    fn own_speed(&self, knot: Knot) -> Knot {
        Knot {
            speed_mps: self.vehicle.speed_mps,
            speed_is_known: true,
            ..knot
        }
    }

    /// Flies to the rim of a circle, and around its middle for ever.
    pub(crate) fn circle(
        &mut self,
        row: usize,
        place: LatLon,
        height: Height,
        radius_m: f64,
    ) -> Result<(), Unknown> {
        let from = self.last();
        let radius_m = self.flown_radius_m((row, place, height), radius_m)?;
        let (middle, rim) = self.enter_circle((row, place, height), radius_m)?;
        let rim_m = radius_m.abs();
        let off_m = self.off_at_rim_m(&from, middle, (rim.amsl_m, rim_m));
        let (first, wide_m) = (self.trajectory.segments.len(), self.circle_wide_m());
        self.orbit(row, middle, rim, radius_m)?;
        let over = PlanPoint {
            at: middle,
            amsl: Amsl(rim.amsl_m),
        };
        if wide_m > 0.0 {
            self.widen_from(first, wide_m);
            let times_s = (self.trajectory.t_s, self.trajectory.t_s);
            self.lay_rings((row, over), [rim_m, wide_m], off_m, times_s);
        }
        self.flight.route.push(Mark {
            point: over,
            row,
            t_s: self.trajectory.t_s,
        });
        self.flight.circle = Some(Circle {
            radius_m: rim_m,
            segment: self.trajectory.segments.len(),
        });
        // From now on it is somewhere on the circle.
        self.trajectory
            .straight((row, self.phase), (over, over), f64::INFINITY, None);
        if let Some(stay) = self.trajectory.segments.last_mut() {
            stay.error_m = rim_m + wide_m;
        }
        self.ended = true;
        self.flight.end = Some(End::Stays(middle));
        Ok(())
    }

    /// Flies to the rim of a circle: its middle, and the place on the rim.
    pub(crate) fn enter_circle(
        &mut self,
        (row, place, height): (usize, LatLon, Height),
        radius_m: f64,
    ) -> Result<(EastNorth, Knot), Unknown> {
        let middle = self.reach(row, place)?;
        let (amsl_m, agl_m) = self.resolve(row, place, height)?;
        if agl_m.is_some() {
            return Unknown::err(row, "a circle at a height above terrain");
        }
        let from = self.last();
        let away_m = from.at.distance_m(middle);
        let rim_m = radius_m.abs();
        let mut within = None;
        // From the middle itself, where only rounding has a direction, north.
        let outward_rad = match away_m > SAME_PLACE_M {
            true => heading_rad(middle, from.at),
            false => 0.0,
        };
        let rim_at = if away_m > rim_m {
            // Clockwise the middle is to the right of the tangent.
            let aside_rad = (rim_m / away_m).asin() * radius_m.signum();
            let course_rad = heading_rad(from.at, middle) - aside_rad;
            let tangent_m = (away_m * away_m - rim_m * rim_m).sqrt();
            along(from.at, course_rad, tangent_m)
        } else if self.sites.departure.is_airborne() {
            // It is on its circle already.
            along(middle, outward_rad, rim_m)
        } else {
            // It comes to its rim somewhere, and turns on to it beyond at worst.
            within = Some(self.wide_reach_m(rim_m));
            along(middle, outward_rad, rim_m)
        };
        let first = self.trajectory.segments.len();
        let turned = self.turned_towards(middle)?;
        let rim = self.knot(row, rim_at, amsl_m, None);
        self.append(rim)?;
        let speed_mps = rim.speed_mps;
        self.is_onto_circle = true;
        self.fly_to_last(speed_mps)?;
        self.is_onto_circle = false;
        self.straight_in(row, (from, 0.0), middle, amsl_m)?;
        self.lay_between(from, &rim, (middle, rim_m))?;
        for at in turned {
            let share = share(from.at, middle, at);
            let out = Knot {
                at,
                amsl_m: from.amsl_m + (amsl_m - from.amsl_m) * share,
                ..from
            };
            self.straight_in(row, (out, share), middle, amsl_m)?;
        }
        if let Some(reach_m) = within {
            self.widen_from(first, reach_m);
            self.lay_discs((row, middle), (from.amsl_m, amsl_m), reach_m);
        }
        Ok((middle, rim))
    }

    /// Lays discs around the middle of a circle, at the altitudes at both ends of the way there.
    fn lay_discs(&mut self, at: (usize, EastNorth), ends_m: (f64, f64), reach_m: f64) {
        let ((row, middle), t_s) = (at, self.trajectory.t_s);
        let lines = self.arrival.lines.iter().map(AltitudeLine::ends_m);
        let altitudes_m: Vec<_> = std::iter::once(ends_m).chain(lines).collect();
        for altitude_m in altitudes_m.into_iter().flat_map(<[f64; 2]>::from) {
            let amsl = Amsl(altitude_m);
            self.lay_disc(row, PlanPoint { at: middle, amsl }, reach_m, (t_s, t_s));
        }
    }

    /// How an autopilot comes to the rim is its own affair: somewhere between the tangent and
    /// the straight way to the middle, which is judged in space alone. `share`: of the way that is behind it.
    fn straight_in(
        &mut self,
        row: usize,
        (from, share): (Knot, f64),
        middle: EastNorth,
        amsl_m: f64,
    ) -> Result<(), Unknown> {
        let t_s = self.trajectory.t_s;
        let to = PlanPoint {
            at: middle,
            amsl: Amsl(amsl_m),
        };
        let segment = Segment::unflown((row, self.phase), (t_s, t_s), (from.point(), to));
        self.trajectory.segments.push(segment);
        self.lay_arrival(segment, share)?;
        let level_m = self.circle_level_m();
        if level_m <= 0.0 {
            return Ok(());
        }
        let off_m = level_m + self.climbs_late_m(&from, middle, (amsl_m, 0.0)).abs();
        for up_m in [-off_m, off_m] {
            let ends = (from.point().raised(up_m), to.raised(up_m));
            let segment = Segment::unflown((row, self.phase), (t_s, t_s), ends);
            self.trajectory.segments.push(segment);
        }
        Ok(())
    }

    /// The ways between the tangent and the straight way to the middle, to be judged in space: PX4 1.17 flew up
    /// to 17 m from both.
    fn lay_between(
        &mut self,
        from: Knot,
        rim: &Knot,
        (middle, rim_m): (EastNorth, f64),
    ) -> Result<(), Unknown> {
        let t_s = self.trajectory.t_s;
        let inside = Knot { at: middle, ..*rim };
        if from.at.distance_m(middle) <= rim_m {
            return Ok(());
        }
        let steps = geometry::steps(rim_m, BETWEEN_M, (1, 20));
        for step in 1..steps {
            let to = (rim.point()).toward(inside.point(), f64::from(step) / f64::from(steps));
            let ends = (from.point(), to);
            let segment = Segment::unflown((rim.row, self.phase), (t_s, t_s), ends);
            self.trajectory.segments.push(segment);
            self.lay_arrival(segment, 0.0)?;
        }
        Ok(())
    }

    /// How far below and above its altitude a wing is at the rim of a circle, metres.
    pub(super) fn off_at_rim_m(&self, from: &Knot, middle: EastNorth, rim: (f64, f64)) -> [f64; 2] {
        let late_m = self.climbs_late_m(from, middle, rim);
        let [below_m, above_m] = self.arrival.left_m;
        [late_m.max(below_m), (-late_m).max(above_m)]
            .map(|off_m| self.circle_level_m() + off_m.max(0.0))
    }

    /// How much of a climb to a circle is left at its rim, negative of a descent, metres: it leads to the
    /// middle, and the wing lags it.
    pub(super) fn climbs_late_m(
        &self,
        from: &Knot,
        middle: EastNorth,
        (amsl_m, rim_m): (f64, f64),
    ) -> f64 {
        let rise_m = amsl_m - from.amsl_m;
        let away_m = from.at.distance_m(middle).max(1.0);
        let flown_s = (away_m / self.vehicle.speed_mps).max(1.0);
        let lag_m = self.lag_s * (rise_m.abs() / flown_s).min(self.vehicle.climb_mps);
        lag_m.copysign(rise_m) + rise_m * (rim_m / away_m).min(1.0)
    }

    /// Once around.
    pub(crate) fn orbit(
        &mut self,
        row: usize,
        middle: EastNorth,
        rim: Knot,
        radius_m: f64,
    ) -> Result<(), Unknown> {
        let rim_m = radius_m.abs();
        self.flight.rounds.push(Round {
            segment: self.trajectory.segments.len(),
            radius_m: rim_m,
            min_m: turn_radius_at_m(self.vehicle, rim.speed_mps, Amsl(rim.amsl_m)),
        });
        let step_rad = (8.0 * CHORD_ERROR_M / rim_m).sqrt();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to a small positive count"
        )]
        let count = (TAU / step_rad).ceil().clamp(8.0, 1e4) as u32;
        let begin_rad = FRAC_PI_2 - heading_rad(middle, rim.at);
        let at = |index: u32| {
            let turned_rad = TAU * f64::from(index) / f64::from(count);
            let (sin, cos) = (begin_rad - turned_rad * radius_m.signum()).sin_cos();
            PlanPoint {
                at: EastNorth {
                    east_m: middle.east_m + rim_m * cos,
                    north_m: middle.north_m + rim_m * sin,
                },
                amsl: Amsl(rim.amsl_m),
            }
        };
        let step_m = TAU * rim_m / f64::from(count);
        for index in 0..count {
            let ends = (at(index), at(index + 1));
            let course_rad = heading_rad(ends.0.at, ends.1.at);
            let step_s = step_m / ground_speed(self.vehicle, &rim, Amsl(rim.amsl_m), course_rad)?;
            self.trajectory
                .straight((row, self.phase), ends, step_s, None);
            if let Some(segment) = self.trajectory.segments.last_mut() {
                segment.error_m = CHORD_ERROR_M;
                segment.bow_m = CHORD_ERROR_M;
            }
        }
        Ok(())
    }
}
