//! The vehicle as its orders are obeyed, one after the other.

mod ends;

use crate::autopilot::Cornering;
use crate::geodesy::{Agl, Amsl, EastNorth, LatLon, PlanPoint};
use crate::mission::{VehicleMission, acceptance_m, corner_accel_mps2, cruise_speed_mps};
use crate::path::{heading_rad, leg_late_s, stop_late_s};
use crate::spec::{Airframe, Autopilot, Vehicle};
use crate::world::{Departure, Stations, World};

use super::decode::{self, Orders, Step, Unknown};
use super::flight::{End, Flight, Last, Legs, Mark, Rest, Slope};
use super::item::{Height, Order};
use super::legs::{self, Knot};
use super::trajectory::TrajectoryBuilder;
use super::wing::altitude_lag;
use super::wing::l1::Guidance;
use crate::verify::measure::segment::Phase;

/// Knots nearer than this are one place: two units of 1e-7 degrees.
const SAME_PLACE_M: f64 = 0.025;
/// Default of PX4's `MIS_TAKEOFF_ALT`, metres.
const LEAST_TAKEOFF_M: f64 = 2.5;
/// Places further from the origin than this are beyond the local frame.
const REACH_M: f64 = 500_000.0;

/// Flies a mission from a home (its place, and the altitude the autopilot measures from).
pub(crate) fn fly(
    vehicle: &Vehicle,
    mission: &VehicleMission,
    world: &World,
    stations: &Stations,
    home: PlanPoint,
    tolerance_m: f64,
) -> Flight {
    let orders = decode::decode(mission, home.amsl);
    let mut pilot = Pilot {
        vehicle,
        world,
        trajectory: TrajectoryBuilder::new(world),
        stations,
        tolerance_m,
        flight: Flight::default(),
        home,
        airborne: false,
        ended: false,
        phase: Phase::Join,
        speed_mps: cruise_speed_mps(mission),
        knots: Vec::new(),
        moving_mps: 0.0,
        at_once_m: altitude_lag::threshold_m(mission),
        guidance: Guidance::of(vehicle, mission),
        early_top: None,
        drift: None,
        accept_m: acceptance_m(mission, 0),
        law: vehicle.facts().corners.map(|law| {
            let corner_mps2 = corner_accel_mps2(vehicle.accel_mps2, Some(mission));
            Cornering::new(law, vehicle.accel_mps2).within(corner_mps2)
        }),
        lag_s: altitude_lag::lag_s(mission),
        early_m: altitude_lag::early_m(vehicle, mission),
    };
    pilot.depart();
    pilot.flight.unknown = pilot.fly(&orders, mission);
    pilot.flight.chords = pilot.trajectory.chords;
    pilot.flight.cut_at_nan()
}

/// Whether a mission without a delay starts at `depart_s`, launched by an operator, and not at T0.
/// A departure chosen from a window is in the mission only.
pub(crate) fn is_launched(vehicle: &Vehicle, autopilot: Autopilot) -> bool {
    let waits_elsewhere = autopilot == Autopilot::Px4 || vehicle.airframe.has_wing();
    waits_elsewhere && vehicle.retiming.depart_s.is_none()
}

pub(crate) struct Pilot<'a> {
    pub(crate) vehicle: &'a Vehicle,
    pub(crate) world: &'a World,
    pub(crate) trajectory: TrajectoryBuilder<'a>,
    pub(crate) stations: &'a Stations,
    tolerance_m: f64,
    pub(crate) flight: Flight,
    pub(crate) home: PlanPoint,
    pub(crate) airborne: bool,
    /// Landed or staying: nothing follows.
    pub(crate) ended: bool,
    pub(crate) phase: Phase,
    /// Commanded speed, if known.
    speed_mps: Option<f64>,
    /// Where the vehicle last stopped, or left the ground, and where it goes from there.
    pub(crate) knots: Vec<Knot>,
    /// Commanded speed at the first knot, m/s; 0 at rest.
    pub(crate) moving_mps: f64,
    /// Smaller changes of altitude are not spread along the leg, metres.
    pub(crate) at_once_m: f64,
    /// What steers it, if that is known to leave its legs.
    pub(crate) guidance: Option<Guidance>,
    /// Where a plane may have the height of its takeoff, until it goes on from there.
    pub(crate) early_top: Option<PlanPoint>,
    /// Where the wind has driven it as it rose, until it goes on from there: metres.
    pub(crate) drift: Option<EastNorth>,
    /// A copter accepts the place of the item at work within this radius, metres.
    accept_m: f64,
    /// How a copter flies around corners.
    law: Option<Cornering>,
    /// Lag behind a slope, seconds of the climb rate; 0 for none.
    pub(crate) lag_s: f64,
    /// So far before a waypoint it has its altitude, metres.
    pub(crate) early_m: f64,
}

impl Pilot<'_> {
    /// Begins in the air, if it is there.
    fn depart(&mut self) {
        if let Departure::Airborne { point, at_s, .. } = self.stations.departure {
            self.airborne = true;
            self.phase = Phase::Route;
            self.trajectory.t_s = at_s;
            self.knots = vec![self.knot(0, point.at, point.amsl.0, None)];
            self.mark();
        }
    }

    /// Obeys every order; says from where on the flight is not known, if so.
    fn fly(&mut self, orders: &Orders, mission: &VehicleMission) -> Option<Unknown> {
        let items = mission.items.len();
        let mut first = 0;
        for (index, step) in orders.steps.iter().enumerate() {
            if orders.repeats.is_some_and(|(_, again)| again == index) {
                first = self.trajectory.chords.len();
            }
            if let Err(unknown) = self.obey(step, mission) {
                // What is flown before it is still judged; troubles on the way there come first.
                return self.stop().err().or(Some(unknown));
            }
            let why = match self.flight.end {
                Some(End::Stays(_)) => "stays at",
                Some(End::Landed(_)) => "lands at",
                _ => continue,
            };
            let is_harmless = why == "lands at" && ends::goes_nowhere(&mission.items[step.row..]);
            self.flight.last = (step.row < items).then_some(Last {
                row: step.row,
                why,
                is_harmless,
            });
            return None;
        }
        if let (Some((row, _)), None) = (orders.repeats, &orders.unread) {
            self.flight.last = (row < items).then_some(Last {
                row,
                why: "repeats the mission at",
                is_harmless: false,
            });
            return self.repeat(row, first).err();
        }
        let last = orders.steps.last().map_or(1, |step| step.row);
        let result = match &orders.unread {
            Some(_) => self.stop(),
            None => self.finish(last, mission),
        };
        result.err().or_else(|| orders.unread.clone())
    }

    fn obey(&mut self, step: &Step, mission: &VehicleMission) -> Result<(), Unknown> {
        let row = step.row;
        let unknown = |why: &str| Unknown::err(row, why);
        self.accept_m = acceptance_m(mission, row);
        if let (false, Order::Fly { height, .. } | Order::Stay { height, .. }) =
            (self.airborne, step.order)
            && !mission.facts().acceptance.needs_takeoff
        {
            self.lift_itself(row, height, mission.autopilot)?;
        }
        match step.order {
            Order::Nothing => {}
            Order::Speed { speed_mps } => self.speed_mps = Some(speed_mps),
            Order::Wait { hold_s } if !self.airborne => {
                *self.flight.delay_s.get_or_insert(0.0) += hold_s;
            }
            Order::Wait { .. } if self.vehicle.airframe.has_wing() => {
                return unknown("a wait in the air, on a wing");
            }
            Order::Wait { hold_s } => {
                self.stop()?;
                self.hold(row, hold_s);
            }
            Order::Takeoff { .. } if self.airborne => return unknown("a second takeoff"),
            Order::Takeoff { at, height } if self.vehicle.airframe == Airframe::Plane => {
                self.climb_out(row, at, height)?;
            }
            Order::Takeoff { at, height } => self.take_off(row, at, height, mission.autopilot)?,
            _ if !self.airborne => return unknown("no takeoff before it"),
            Order::Fly { at, height, hold_s } => {
                self.head_for(row, self.or_here(at), height)?;
                if let Some(hold_s) = hold_s {
                    self.stop()?;
                    self.hold(row, hold_s);
                }
            }
            Order::Stay {
                at,
                height,
                radius_m: Some(radius_m),
            } => {
                let at = self.or_here(at);
                self.circle(row, at, height, radius_m)?;
            }
            Order::Stay { at, height, .. } => {
                self.head_for(row, self.or_here(at), height)?;
                self.finish(row, mission)?;
            }
            Order::Land { at: Some(at) } if self.vehicle.airframe == Airframe::Plane => {
                self.glide(row, at)?;
            }
            Order::Land { at } => self.land(row, at)?,
            Order::Return => self.return_home(row, mission)?,
        }
        Ok(())
    }

    /// The place, or the present one.
    fn or_here(&self, at: Option<LatLon>) -> LatLon {
        at.unwrap_or_else(|| self.world.frame.from_plan(self.last().at))
    }

    /// PX4 climbs over its home, to the altitude of the first item and `MIS_TAKEOFF_ALT` at least,
    /// before it flies there (`Mission::do_need_vertical_takeoff`).
    fn lift_itself(
        &mut self,
        row: usize,
        height: Height,
        autopilot: Autopilot,
    ) -> Result<(), Unknown> {
        let place = self.world.frame.from_plan(self.home.at);
        let (amsl_m, _) = self.resolve(row, place, height)?;
        let least_m = self.home.amsl.0 + LEAST_TAKEOFF_M;
        self.take_off(row, None, Height::Sea(Amsl(amsl_m.max(least_m))), autopilot)
    }

    fn take_off(
        &mut self,
        row: usize,
        at: Option<LatLon>,
        height: Height,
        autopilot: Autopilot,
    ) -> Result<(), Unknown> {
        // The encoded delay is the departure.
        self.trajectory.t_s = match (self.flight.delay_s, autopilot) {
            (Some(delay_s), _) => delay_s,
            (None, autopilot) if is_launched(self.vehicle, autopilot) => self.vehicle.depart_s,
            (None, _) => 0.0,
        };
        let home = self.home;
        let place = self.world.frame.from_plan(home.at);
        let (amsl_m, _) = self.resolve(row, place, height)?;
        if amsl_m <= home.amsl.0 || home.amsl.0.is_nan() {
            let home_m = home.amsl.0;
            let why = format!("takeoff to {amsl_m:.2} m AMSL, not above home at {home_m:.2} m");
            return Unknown::err(row, why);
        }
        self.airborne = true;
        self.knots = vec![self.knot(row, home.at, home.amsl.0, None)];
        self.lift(row, amsl_m, self.vehicle.climb_mps, true);
        self.drift_up(row, self.here());
        if let Some(at) = at {
            let at = self.reach(row, at)?;
            if at.distance_m(home.at) > self.tolerance_m {
                let knot = self.knot(row, at, amsl_m, None);
                self.append(knot)?;
                self.stop()?;
                // That was still the takeoff, not the route.
                self.flight.route.clear();
            }
        }
        let start = self.stations.start;
        if self.here().distance_m(start) <= self.tolerance_m {
            self.phase = Phase::Route;
            self.mark();
        }
        Ok(())
    }

    /// Adds a leg to a place at a height.
    fn head_for(&mut self, row: usize, place: LatLon, height: Height) -> Result<(), Unknown> {
        let at = self.reach(row, place)?;
        let (amsl_m, agl_m) = self.resolve(row, place, height)?;
        let knot = self.knot(row, at, amsl_m, agl_m);
        let changes_kind = self.last().agl_m.is_some() != agl_m.is_some();
        if changes_kind && self.vehicle.facts().stops.between_altitude_kinds {
            self.stop()?;
        }
        self.append(knot)?;
        if self.phase == Phase::Join {
            // The first place after the takeoff is the start of the route.
            self.phase = Phase::Route;
        }
        Ok(())
    }

    pub(crate) fn append(&mut self, knot: Knot) -> Result<(), Unknown> {
        let last = self.last();
        if knot.at.distance_m(last.at) > SAME_PLACE_M {
            self.knots.push(knot);
        } else if (knot.amsl_m - last.amsl_m).abs() > SAME_PLACE_M {
            self.stop()?;
            self.climb(knot.row, knot.amsl_m);
            self.mark();
        } else if knot.phase == Phase::Join {
            // A waypoint at the place of the takeoff: the route begins here.
            self.stop()?;
            self.mark();
        }
        Ok(())
    }

    /// Climbs or descends to an altitude.
    pub(crate) fn climb(&mut self, row: usize, to_m: f64) {
        let rise_m = to_m - self.last().amsl_m;
        self.flight.slopes.push(Slope {
            chord: self.trajectory.chords.len(),
            phase: self.phase,
            run_m: 0.0,
            rise_m,
            speed_mps: 0.0,
            top_m: to_m.max(to_m - rise_m),
        });
        let rate_mps = if rise_m > 0.0 {
            self.vehicle.climb_mps
        } else {
            self.vehicle.descent_mps
        };
        self.lift(row, to_m, rate_mps, false);
    }

    /// A vertical motion at a given rate.
    fn lift(&mut self, row: usize, to_m: f64, rate_mps: f64, grounded: bool) {
        let from = self.here();
        let to = PlanPoint {
            at: from.at,
            amsl: Amsl(to_m),
        };
        let duration_s = (to_m - from.amsl.0).abs() / rate_mps;
        self.trajectory
            .straight((row, self.phase), (from, to), duration_s, grounded);
        self.knots = vec![self.knot(row, to.at, to_m, None)];
    }

    fn hold(&mut self, row: usize, hold_s: f64) {
        let (here, from_s) = (self.here(), self.trajectory.t_s);
        self.trajectory
            .straight((row, self.phase), (here, here), hold_s, false);
        let until_s = self.trajectory.t_s;
        match self.flight.rests.last_mut() {
            Some(last) if last.until_s >= from_s && last.point == here => {
                (last.until_s, last.rows.1) = (until_s, row);
            }
            _ => self.flight.rests.push(Rest {
                point: here,
                from_s,
                until_s,
                rows: (row, row),
            }),
        }
    }

    /// Flies the legs that were gathered, to a stop at the last knot.
    pub(crate) fn stop(&mut self) -> Result<(), Unknown> {
        self.fly_to_last(0.0)
    }

    /// Flies the legs that were gathered, and has a speed at the last knot.
    pub(crate) fn fly_to_last(&mut self, last_mps: f64) -> Result<(), Unknown> {
        let first_mps = self.moving_mps;
        let knots = std::mem::take(&mut self.knots);
        if let Some(&last) = knots.last() {
            self.knots = vec![last];
        }
        if knots.len() < 2 {
            return Ok(());
        }
        self.moving_mps = last_mps;
        let grounds_mps = legs::ground_speeds(&knots, self.vehicle)?;
        // At its ends the wind carries it as on the leg there.
        let carried = |speed_mps: f64, leg: usize| {
            if speed_mps > 0.0 {
                speed_mps * (grounds_mps[leg] / knots[leg + 1].speed_mps)
            } else {
                speed_mps
            }
        };
        let first_mps = match self.initial_mps(&knots) {
            Some(initial_mps) => initial_mps.min(grounds_mps[0]),
            None => carried(first_mps, 0),
        };
        let ends_mps = (first_mps, carried(last_mps, knots.len() - 2));
        let run = legs::run(&knots, (self.vehicle, self.law), &grounds_mps, ends_mps);
        let lines = knots
            .windows(2)
            .map(|pair| self.trajectory.altitude_line(&pair[0], &pair[1]))
            .collect::<Result<Vec<_>, _>>()?;
        let mut firsts = vec![self.trajectory.chords.len(); lines.len()];
        let mut leg = usize::MAX;
        for piece in &run.pieces {
            if piece.leg != leg {
                leg = piece.leg;
                self.trajectory.late_s += leg_late_s(self.vehicle);
                firsts[leg] = self.trajectory.chords.len();
            }
            self.trajectory.lay_piece(piece, &knots, &lines)?;
        }
        let legs = Legs {
            knots: &knots,
            lines: &lines,
            run: &run,
            firsts: &firsts,
        };
        self.flight
            .take_stock(&legs, &self.trajectory.chords, self.trajectory.t_s);
        self.lay_altitude_offsets(&knots, &firsts)?;
        self.lay_overshoot(&knots, &grounds_mps, &firsts)?;
        self.drift_onto(&knots, &firsts);
        if last_mps <= 0.0 {
            self.trajectory.late_s += stop_late_s(self.vehicle);
        }
        Ok(())
    }

    /// The ground speed of an airborne departure along the first leg, m/s; none on later legs.
    fn initial_mps(&self, knots: &[Knot]) -> Option<f64> {
        let Departure::Airborne {
            course_rad,
            speed_mps,
            ..
        } = self.stations.departure
        else {
            return None;
        };
        let turn_rad = heading_rad(knots[0].at, knots[1].at) - course_rad;
        let is_first = self.trajectory.chords.is_empty();
        is_first.then(|| speed_mps * turn_rad.cos().max(0.0))
    }

    /// Altitude above the sea, and above the ground if the item says so.
    pub(crate) fn resolve(
        &self,
        row: usize,
        place: LatLon,
        height: Height,
    ) -> Result<(f64, Option<f64>), Unknown> {
        match height {
            Height::Sea(Amsl(amsl_m)) => Ok((amsl_m, None)),
            Height::Ground(Agl(agl_m)) => {
                Ok((self.trajectory.ground_m(row, place)? + agl_m, Some(agl_m)))
            }
            Height::Keep { follows: false } => Ok((self.last().amsl_m, None)),
            Height::Keep { follows: true } => {
                let last = self.last();
                let agl_m = match last.agl_m {
                    Some(agl_m) => agl_m,
                    None => {
                        let below = self.world.frame.from_plan(last.at);
                        last.amsl_m - self.trajectory.ground_m(row, below)?
                    }
                };
                Ok((self.trajectory.ground_m(row, place)? + agl_m, Some(agl_m)))
            }
        }
    }

    /// Planning coordinates of a place that is near enough to have any.
    pub(crate) fn reach(&self, row: usize, place: LatLon) -> Result<EastNorth, Unknown> {
        let origin = self.world.frame.origin();
        let away_m = (place.to_ecef(0.0) - origin.to_ecef(0.0)).norm();
        if away_m <= REACH_M {
            Ok(self.world.frame.to_plan(place))
        } else {
            let why = format!("a place {:.0} km from the origin", away_m / 1000.0);
            Unknown::err(row, why)
        }
    }

    pub(crate) fn knot(&self, row: usize, at: EastNorth, amsl_m: f64, agl_m: Option<f64>) -> Knot {
        Knot {
            row,
            at,
            amsl_m,
            agl_m,
            speed_mps: self.speed_mps.unwrap_or(self.vehicle.speed_mps),
            speed_is_known: self.speed_mps.is_some(),
            phase: self.phase,
            slope_from_m: None,
            accept_m: self.accept_m,
        }
    }

    pub(crate) fn last(&self) -> Knot {
        self.knots
            .last()
            .copied()
            .unwrap_or_else(|| self.knot(0, self.home.at, self.home.amsl.0, None))
    }

    fn here(&self) -> PlanPoint {
        self.last().point()
    }

    /// Notes where the vehicle is as a point of the route.
    pub(crate) fn mark(&mut self) {
        let last = self.last();
        self.flight.route.push(Mark {
            point: last.point(),
            row: last.row,
            t_s: self.trajectory.t_s,
        });
    }
}
