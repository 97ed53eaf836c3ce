//! The vehicle as its orders are obeyed, one after the other.

mod circle;
mod ends;
mod knots;
mod motions;
mod orders;
mod payload;
mod spline;
mod takeoff;

use nalgebra::Vector3;

use crate::autopilot::Cornering;
use crate::geodesy::PlanPoint;
use crate::mission::{
    Descent, VehicleMission, acceptance_m, as_set, as_set_on_rotors, corner_accel_mps2,
    first_speed_mps, jerk_mps3,
};
use crate::spec::{Autopilot, MissionSpec, Vehicle};
use crate::world::{Departure, LowPlace, VehicleSites, World};

use super::bent_map;
use super::decode::{self, Orders, Unknown};
use super::flight::{EarlyTop, End, Flight, Hull, Last};
use super::legs::Knot;
use super::trajectory::TrajectoryBuilder;
use super::wing::altitude_lag::{self, Arrival};
use super::wing::circle_radius::Widening;
use super::wing::guidance::Guidance;
use crate::verify::measure::segment::Phase;

/// Knots nearer than this are one place: two units of 1e-7 degrees.
pub(crate) const SAME_PLACE_M: f64 = 0.025;

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
}

/// Whether a mission without a delay starts at `depart_s`, launched by an operator, and not at T0.
/// A departure chosen from a window is in the mission only.
pub(crate) fn is_launched(vehicle: &Vehicle, autopilot: Autopilot) -> bool {
    let waits_elsewhere = autopilot == Autopilot::Px4 || vehicle.airframe.has_wing();
    waits_elsewhere && vehicle.retiming.depart_s.is_none()
}

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

/// Between the posts of the terrain that `ArduPilot` follows, metres.
fn posts_m(mission: &VehicleMission) -> f64 {
    mission
        .param_or_default_si("TERRAIN_SPACING")
        .unwrap_or(0.0)
}
