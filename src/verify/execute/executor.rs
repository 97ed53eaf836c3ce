//! The vehicle as its orders are obeyed, one after the other.

mod circle;
mod ends;
mod motions;
mod payload;
mod spline;
mod takeoff;

use nalgebra::Vector3;

use crate::autopilot::Cornering;
use crate::geodesy::{Agl, Amsl, EastNorth, LatLon, PlanPoint};
use crate::mission::{
    Descent, Item, VehicleMission, acceptance_m, as_set, as_set_on_rotors, corner_accel_mps2,
    first_speed_mps, frame, jerk_mps3, within_speeds_mps,
};
use crate::spec::{Airframe, Autopilot, MissionSpec, Vehicle};
use crate::world::{Departure, LowPlace, VehicleSites, World};

use super::bent_map;
use super::decode::{self, After, Orders, Step, Unknown};
use super::flight::{EarlyTop, End, Flight, Hull, Last, Mark};
use super::item::{self, Height, Order};
use super::legs::Knot;
use super::trajectory::TrajectoryBuilder;
use super::wing::altitude_lag::{self, Arrival};
use super::wing::circle_radius::Widening;
use super::wing::guidance::Guidance;
use crate::verify::measure::segment::Phase;

/// Knots nearer than this are one place: two units of 1e-7 degrees.
pub(crate) const SAME_PLACE_M: f64 = 0.025;
/// Places further from the origin than this are beyond the local frame.
const REACH_M: f64 = 500_000.0;

/// Why its parameters make the vehicle fly all of its mission otherwise than this verdict does, if they do.
fn other_flight(mission: &VehicleMission) -> Option<String> {
    let mut known = mission.facts().judged_with.iter().copied().flatten();
    known.find_map(|(name, judged)| {
        let held = mission
            .params
            .iter()
            .find(|param| param.name == *name)?
            .value;
        let is_other = !judged.knows(f64::from(held));
        is_other.then(|| format!("a flight with {name} {held} (judged: {judged})"))
    })
}

/// Flies a mission from a home (its place, and the altitude the autopilot measures from).
pub(crate) fn fly(
    vehicle: &Vehicle,
    mission: &VehicleMission,
    spec: &MissionSpec,
    world: &World,
    sites: &VehicleSites,
    home: PlanPoint,
) -> Flight {
    let orders = decode::decode(mission, home.amsl);
    let rotors = &*as_set_on_rotors(vehicle, mission);
    let vehicle = &*as_set(vehicle, mission);
    let mut pilot = Pilot {
        vehicle,
        rotors,
        world,
        trajectory: TrajectoryBuilder::new(world, home.at, posts_m(mission)),
        sites,
        tolerance_m: spec.mission.tolerance_m,
        drops: world.drops(spec, vehicle, sites),
        flight: Flight::default(),
        home,
        airborne: false,
        ended: false,
        phase: Phase::Join,
        speed_mps: first_speed_mps(mission, vehicle.speed_mps),
        descent: Descent::of(rotors, mission),
        knots: Vec::new(),
        moving_mps: 0.0,
        at_once_m: altitude_lag::threshold_m(mission),
        guidance: Guidance::of(vehicle, mission),
        widening: Widening::of(vehicle, mission),
        early_top: None,
        accept_m: acceptance_m(mission, 0),
        law: vehicle.facts().corners.map(|law| {
            let corner_mps2 = corner_accel_mps2(vehicle.accel_mps2, Some(mission));
            Cornering::new(law, vehicle.accel_mps2)
                .within(corner_mps2)
                .with_jerk(jerk_mps3(mission))
        }),
        lag_s: altitude_lag::lag_s(mission),
        transition_lag_s: 0.0,
        arrival: Arrival::default(),
        early_m: altitude_lag::early_m(vehicle, mission),
        is_onto_circle: false,
        circle_m: None,
        tangent: None,
        is_doubled: false,
        hull: None,
    };
    pilot.depart(mission);
    pilot.flight.unknown = pilot.fly(&orders, mission);
    pilot.gain();
    pilot.flight.segments = pilot.trajectory.segments;
    let mut flight = pilot.flight.cut_at_nan();
    bent_map::widen(vehicle, &mut flight, world);
    flight
}

/// Between the posts of the terrain that `ArduPilot` follows, metres.
fn posts_m(mission: &VehicleMission) -> f64 {
    mission
        .param_or_default_si("TERRAIN_SPACING")
        .unwrap_or(0.0)
}

/// Whether a mission without a delay starts at `depart_s`, launched by an operator, and not at T0.
/// A departure chosen from a window is in the mission only.
pub(crate) fn is_launched(vehicle: &Vehicle, autopilot: Autopilot) -> bool {
    let waits_elsewhere = autopilot == Autopilot::Px4 || vehicle.airframe.has_wing();
    waits_elsewhere && vehicle.retiming.depart_s.is_none()
}

pub(crate) struct Pilot<'a> {
    pub(crate) vehicle: &'a Vehicle,
    /// The vehicle on its rotors.
    pub(crate) rotors: &'a Vehicle,
    pub(crate) world: &'a World,
    pub(crate) trajectory: TrajectoryBuilder<'a>,
    pub(crate) sites: &'a VehicleSites,
    tolerance_m: f64,
    /// Where it may come below the least height above ground.
    drops: Vec<LowPlace>,
    pub(crate) flight: Flight,
    pub(crate) home: PlanPoint,
    pub(crate) airborne: bool,
    /// Landed or staying: nothing follows.
    pub(crate) ended: bool,
    pub(crate) phase: Phase,
    /// Commanded speed, if known.
    pub(crate) speed_mps: Option<f64>,
    /// How it descends to land.
    descent: Descent,
    /// Where the vehicle last stopped, or left the ground, and where it goes from there.
    pub(crate) knots: Vec<Knot>,
    /// Commanded speed at the first knot, m/s; 0 at rest.
    pub(crate) moving_mps: f64,
    /// Smaller changes of altitude are not spread along the leg, metres.
    pub(crate) at_once_m: f64,
    /// What steers it, if that is known to leave its legs.
    pub(crate) guidance: Option<Guidance>,
    /// How its circles widen with altitude, if they do.
    pub(crate) widening: Option<Widening>,
    /// Where a plane may have the height of its takeoff, until it goes on from there.
    pub(crate) early_top: Option<EarlyTop>,
    /// A copter accepts the place of the item at work within this radius, metres.
    accept_m: f64,
    /// How a copter flies around corners.
    law: Option<Cornering>,
    /// Lag behind a slope, seconds of the climb rate; 0 for none.
    pub(crate) lag_s: f64,
    /// The same above legs that descend from a climb on rotors, until it flies these.
    pub(crate) transition_lag_s: f64,
    /// What the last legs left.
    pub(crate) arrival: Arrival,
    /// So far before a waypoint it has its altitude, metres.
    pub(crate) early_m: f64,
    /// The last of the legs that are flown leads to a circle.
    pub(crate) is_onto_circle: bool,
    /// The radius of the circle before on rotors, metres.
    circle_m: Option<f64>,
    /// The tangent at the end of the spline that it comes from, if it does not stop there.
    tangent: Option<Vector3<f64>>,
    /// Whether the last place that it was ordered to is the one before that: the leg there has no direction, or
    /// one up or down.
    is_doubled: bool,
    /// The circle that it leaves, until it goes on from there.
    pub(crate) hull: Option<Hull>,
}

/// Why a vehicle does not take off that waits so long on the ground, seconds: it disarms itself before.
fn disarms_after(mission: &VehicleMission, waits_s: f64) -> Option<String> {
    let row = mission.facts().disarms_after()?;
    let after_s = mission.param_or_default_si(row.name)?;
    (after_s > 0.0 && waits_s > after_s).then(|| {
        format!(
            "it waits for {waits_s} s on the ground, and disarms itself after {after_s} s there ({}; 0 or below: never)",
            row.name
        )
    })
}

impl Pilot<'_> {
    /// Begins in the air, if it is there.
    fn depart(&mut self, mission: &VehicleMission) {
        if let Departure::Airborne { point, at_s, .. } = self.sites.departure {
            self.airborne = true;
            self.phase = Phase::Route;
            self.trajectory.t_s = at_s;
            self.knots = vec![self.knot(0, point.at, point.amsl.0, None)];
            self.mark();
            self.flight.begins_in_column =
                ends::lands_first(&mission.items) || self.is_at_drop(point.amsl.0);
        }
    }

    /// A wing may have gained time since its takeoff.
    fn gain(&mut self) {
        let behaviour = &self.vehicle.facts().behaviour;
        let share = behaviour.early_share.value(self.vehicle.autopilot_version);
        let Some(first_s) = self
            .trajectory
            .segments
            .first()
            .map(|segment| segment.from_s)
        else {
            return;
        };
        for segment in &mut self.trajectory.segments {
            let until_s = if segment.to_s.is_finite() {
                segment.to_s
            } else {
                segment.from_s
            };
            segment.early_s += share * (until_s - first_s).max(0.0);
        }
        for rest in &mut self.flight.rests {
            rest.early_s += share * (rest.from_s - first_s).max(0.0);
        }
    }

    /// Obeys every order; says from where on the flight is not known, if so.
    fn fly(&mut self, orders: &Orders, mission: &VehicleMission) -> Option<Unknown> {
        if let Some(why) = other_flight(mission) {
            return Some(Unknown { row: 1, why });
        }
        let items = mission.items.len();
        let mut first = 0;
        for (index, step) in orders.steps.iter().enumerate() {
            if orders.repeats.is_some_and(|(_, again)| again == index) {
                first = self.trajectory.segments.len();
            }
            let obeyed = self.trajectory.within_bound(step.row).and_then(|()| {
                let next = orders.after(index, mission);
                self.obey(step, &next, mission)
            });
            if let Err(unknown) = obeyed {
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

    fn obey(
        &mut self,
        step: &Step,
        next: &After<'_>,
        mission: &VehicleMission,
    ) -> Result<(), Unknown> {
        let row = step.row;
        let unknown = |why: &str| Unknown::err(row, why);
        self.accept_m = acceptance_m(mission, row);
        if let (false, Order::Fly { height, .. } | Order::Stay { height, .. }) =
            (self.airborne, step.order)
            && !mission.facts().acceptance.needs_takeoff
        {
            self.lift_itself(row, height, mission)?;
        }
        let stops = self.vehicle.facts().stops;
        if self.airborne && stops.before.contains(&mission.items[row - 1].command) {
            self.stop()?;
        }
        match step.order {
            Order::Nothing => {}
            Order::Speed { .. } | Order::OwnSpeed if self.is_on_rotors(mission) => {}
            Order::Speed { speed_mps } => {
                self.speed_mps = Some(within_speeds_mps(mission, speed_mps));
            }
            Order::OwnSpeed => {
                self.speed_mps = first_speed_mps(mission, self.vehicle.speed_mps);
            }
            Order::Wait { hold_s } if !self.airborne => {
                let all_s = self.flight.delay_s.unwrap_or(0.0) + hold_s;
                self.flight.delay_s = Some(all_s);
                if let Some(after) = disarms_after(mission, all_s) {
                    return unknown(&after);
                }
            }
            Order::Wait { .. } if self.vehicle.airframe.has_wing() => {
                return unknown("a wait in the air, on a wing");
            }
            Order::Wait { hold_s } => {
                self.stop()?;
                self.hold(row, hold_s);
            }
            Order::Takeoff { height, .. } if self.airborne => {
                self.climb_again(row, height, mission.autopilot)?;
            }
            Order::Takeoff { at, height } if self.vehicle.airframe == Airframe::Plane => {
                self.climb_out(row, at, height)?;
            }
            Order::Takeoff { at, height } => self.take_off(row, at, height, mission)?,
            _ if !self.airborne => return unknown("no takeoff before it"),
            _ => self.navigate(step, next, mission)?,
        }
        Ok(())
    }

    /// Whether a change of speed is for the rotors: a VTOL of PX4 is on them until its takeoff is over
    /// (`Navigator::set_cruising_speed`).
    fn is_on_rotors(&self, mission: &VehicleMission) -> bool {
        let is_px4_vtol =
            mission.autopilot == Autopilot::Px4 && self.vehicle.airframe == Airframe::Vtol;
        is_px4_vtol && !self.airborne
    }

    /// Obeys an order that moves a vehicle in the air.
    fn navigate(
        &mut self,
        step: &Step,
        next: &After<'_>,
        mission: &VehicleMission,
    ) -> Result<(), Unknown> {
        let row = step.row;
        match step.order {
            Order::Nothing
            | Order::Speed { .. }
            | Order::OwnSpeed
            | Order::OnWing
            | Order::Wait { .. }
            | Order::Takeoff { .. } => {}
            Order::Stop => self.stop()?,
            Order::Fly { at, height, hold_s } => {
                self.turns_by_itself(row, &mission.items[row - 1])?;
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
            Order::Spline { at, height, hold_s } => {
                self.spline((row, self.or_here(at), height), hold_s, (next, mission))?;
            }
            Order::Circle { at, height, circle } if self.vehicle.airframe.has_wing() => {
                self.circle_a_while((row, self.or_here(at), height), circle, next)?;
            }
            Order::Circle { at, height, circle } => {
                self.circle_on_rotors((row, self.or_here(at), height), circle, mission)?;
            }
            Order::Place { at, max_m } => {
                self.place_payload(row, self.or_here(at), max_m, mission)?
            }
            Order::Land { at: Some(at) } if self.vehicle.airframe == Airframe::Plane => {
                let item = &mission.items[row - 1];
                let height = item::height(item, mission.autopilot, self.home.amsl);
                let height = height.map_err(|why| Unknown { row, why })?;
                self.glide(row, at, height)?;
            }
            Order::Land { at } => {
                self.land(row, at, mission)?;
            }
            Order::Return => self.return_home(row, mission)?,
        }
        Ok(())
    }

    /// The altitude with which a copter flies to a place where it descends: the one that it has, above
    /// the ground where the item has one above terrain (`ModeAuto::shift_alt_to_current_alt`).
    fn present_height(&self, item: &Item) -> Height {
        let follows = frame::canonical(item.frame) == frame::GLOBAL_TERRAIN_ALT;
        Height::Keep {
            follows: follows && !self.vehicle.airframe.has_wing(),
        }
    }

    /// The place, or the present one.
    fn or_here(&self, at: Option<LatLon>) -> LatLon {
        at.unwrap_or_else(|| self.world.frame.from_plan(self.last().at))
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
        self.is_doubled = at.distance_m(self.last().at) <= SAME_PLACE_M;
        if self.is_doubled && self.phase == Phase::Route && self.vehicle.airframe.has_wing() {
            let why = "a second waypoint at the place of the one before: a wing can neither stop nor climb there";
            return Unknown::err(row, why);
        }
        self.append(knot)?;
        self.phase_in();
        Ok(())
    }

    /// The first place after the takeoff is the start of the route.
    pub(crate) fn phase_in(&mut self) {
        if self.phase == Phase::Join {
            self.phase = Phase::Route;
        }
    }

    pub(crate) fn append(&mut self, knot: Knot) -> Result<(), Unknown> {
        let last = self.last();
        if knot.agl_m.is_none() && knot.phase != Phase::Finish {
            self.flight.note_low(Mark {
                point: knot.point(),
                row: knot.row,
                t_s: self.trajectory.t_s,
            });
        }
        if knot.at.distance_m(last.at) > SAME_PLACE_M {
            self.knots.push(knot);
        } else if (knot.amsl_m - last.amsl_m).abs() > SAME_PLACE_M {
            self.stop()?;
            self.climb(knot.row, knot.amsl_m);
            self.mark();
        } else if knot.phase == Phase::Join || !self.vehicle.airframe.has_wing() {
            // At the place of the takeoff the route begins; copters of both autopilots stop at a waypoint that is
            // there twice.
            self.stop()?;
            self.mark();
        }
        Ok(())
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

    pub(crate) fn here(&self) -> PlanPoint {
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
