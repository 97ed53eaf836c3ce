//! The state of a vehicle in flight: what it holds, where it is, what it has ahead.

mod branch;
mod items;
mod vias;

pub(super) use self::branch::Branch;
pub(super) use self::items::{is_takeoff, item_at};
pub(super) use self::vias::Via;
use self::vias::vias;
use super::activity::Doing;
use super::in_column::{InColumn, puts_down};
use super::observation::ObservedVehicle;
use super::path_distance::comes_near;
use crate::flight::conformance::reference::{ReferenceTrajectory, Waypoint};
use crate::flight::itinerary::rows::left_of;
use crate::flight::itinerary::stops::Service;
use crate::flight::launch::plan::FlightPlan;
use crate::geodesy::{EastNorth, PlanPoint};
use crate::link::Position;
use crate::mission::{Item, VehicleMission, command};
use crate::spec::{Vehicle, Wing};
use crate::verify::Track;
use crate::world::{Departure, VehicleSites};

/// Lower above its home than this a vehicle stands on the ground, metres.
const AIRBORNE_M: f64 = 1.5;

/// One vehicle in flight.
#[derive(Clone, Debug)]
pub struct VehicleState {
    /// Its index in the spec.
    pub vehicle: usize,
    /// What it holds; its home is that of the plan.
    pub(super) held: VehicleMission,
    /// Index of its current item.
    pub(super) at: usize,
    /// Where it is.
    pub(super) here: PlanPoint,
    /// Its course, radians clockwise from north, and its ground speed, m/s.
    course_rad: f64,
    speed_mps: f64,
    /// Whether its takeoff is not over: it must not be diverted low over the ground.
    pub(super) takes_off: bool,
    /// The column that it is in: whatever its mission is by then, it leaves that first.
    pub(super) column: Option<InColumn>,
    /// For each waypoint ahead whether the way to it is in the column of a drop.
    drops: Vec<bool>,
    /// Its flown track since the threat came up.
    pub(super) flown: Vec<PlanPoint>,
    /// What it does: it flies its mission, or something else.
    pub doing: Doing,
    /// Whether it says how many items it holds.
    pub(super) counts_items: bool,
    /// Where the leg to the item that it flies to begins.
    pub(super) origin: PlanPoint,
    /// The waypoints ahead in the air, each with the index of its item.
    pub(super) ahead: Vec<(usize, PlanPoint)>,
    /// Whether it lands after the last of them.
    pub(super) lands: bool,
    /// Whether it still stands on the ground.
    pub stands: bool,
    /// Where it stays on its way or turns back, in order.
    pub(super) vias: Vec<Via>,
    /// Its stops and tasks that are ahead or under way.
    pub left: Vec<Service>,
    /// Radius of the circle on which a wing stays where it is, metres; 0 without a wing.
    stay_radius_m: f32,
}

impl VehicleState {
    /// From what a vehicle holds, its current item, and where it is.
    ///
    /// # Errors
    /// Why its path is not known, in words.
    pub(super) fn new(
        plan: &FlightPlan,
        vehicle: usize,
        planned: &VehicleMission,
        observed: &ObservedVehicle,
        threat_time: &ThreatTime,
    ) -> Result<Self, String> {
        let held = held(planned, observed)?;
        let first = usize::from(planned.autopilot.first_row());
        let row = (usize::from(observed.seq) + first).max(1);
        let here = point(plan, &observed.position);
        let mode = observed.heartbeat.custom_mode;
        let reference = untimed(&held, plan);
        let itinerary = plan.itineraries.get(vehicle);
        let left = itinerary.map(|itinerary| left_of(itinerary, &reference, row));
        let (origin, mut ahead) = split_path(&reference, row);
        let column = InColumn::of(&held, &reference, row, here);
        // A load is put down at a stop: no waypoint of its own. One that comes down to land does not rise
        // again to where its descent began.
        let is_landing = column == Some(InColumn::Landing);
        let is_load = |index: &usize| held.items.get(*index).is_some_and(puts_down);
        ahead.retain(|(index, _)| !is_landing && !is_load(index));
        let in_drop = |(index, point): &(usize, PlanPoint)| reference.dips_at(index + 1, point.at);
        let drops: Vec<bool> = ahead.iter().map(in_drop).collect();
        let stands = stands(observed, &held.items, row);
        let rising = held.items.get(row - 1).is_some_and(is_takeoff);
        if let (true, Some((_, top))) = (rising, ahead.first_mut()) {
            top.at = here.at;
        }
        let [north_cmps, east_cmps, _] = observed.position.velocity_cmps.map(f64::from);
        let ends = start_and_goal(plan, vehicle);
        let vias = ends.map_or_else(Vec::new, |ends| vias(&held, (&ahead, &drops), ends));
        Ok(Self {
            vehicle,
            held,
            at: row - 1,
            here,
            course_rad: east_cmps.atan2(north_cmps),
            speed_mps: observed.position.ground_speed_mps(),
            takes_off: rising,
            column,
            drops,
            flown: threat_time.flown_track(plan, observed),
            doing: Doing::of((plan, vehicle), planned, mode, here),
            counts_items: (1..u16::MAX).contains(&observed.total),
            origin: origin.filter(|_| !rising).unwrap_or(here),
            ahead,
            lands: reference.lands,
            stands,
            vias,
            left: left.unwrap_or_default(),
            stay_radius_m: stay_radius_m(plan.vehicle(vehicle)),
        })
    }

    /// Where it is and every waypoint ahead.
    pub(super) fn points(&self) -> Vec<PlanPoint> {
        let ahead = self.ahead.iter().map(|(_, point)| *point);
        std::iter::once(self.here).chain(ahead).collect()
    }

    /// Its departure from where it is, at a time in seconds after T0.
    pub(super) fn departure(&self, at_s: f64) -> Departure {
        Departure::Airborne {
            point: self.here,
            course_rad: self.course_rad,
            speed_mps: self.speed_mps,
            at_s,
        }
    }

    /// Whether it flies its mission.
    #[must_use]
    pub fn in_mission(&self) -> bool {
        self.doing == Doing::Mission
    }

    /// Whether its path comes nearer than a distance to a place: that of its mission, or what it flies instead.
    pub(super) fn meets(&self, center: EastNorth, distance_m: f64) -> bool {
        let Some(ways) = self.doing.ways(self.here) else {
            return self.mission_meets(center, distance_m);
        };
        let circle_m = match self.doing {
            Doing::Holds => f64::from(self.stay_radius_m),
            _ => 0.0,
        };
        let mut ways = ways.iter();
        ways.any(|way| comes_near(way, center, distance_m + circle_m))
    }

    /// The same of its mission, whether it flies it or not.
    pub(super) fn mission_meets(&self, center: EastNorth, distance_m: f64) -> bool {
        comes_near(&self.points(), center, distance_m)
    }

    /// Whether it was nearer than a distance to a place since the threat came up.
    pub(super) fn was_near(&self, center: EastNorth, distance_m: f64) -> bool {
        comes_near(&self.flown, center, distance_m)
    }

    /// The speed that it flies with now: that of the last stop behind it that has one, m/s.
    pub(super) fn speed_now_mps(&self, vehicle: &Vehicle, sites: &VehicleSites) -> f64 {
        let ahead = self.stops_ahead(vehicle, sites);
        let behind = vehicle.stops.iter().enumerate().rev();
        let mut behind = behind.filter(|(index, _)| !ahead.contains(index));
        let own_mps = behind.find_map(|(_, stop)| stop.speed_mps);
        own_mps.unwrap_or(vehicle.speed_mps)
    }
}

/// Since when the last threat counts.
#[derive(Clone, Copy, Debug)]
pub(super) struct ThreatTime {
    /// Milliseconds on the steady clock.
    pub(super) steady_ms: u64,
    /// How much faster than the clock the time of the vehicles goes.
    pub(super) speedup: f64,
}

impl ThreatTime {
    /// The flown track since then: until the first position the vehicle flew straight on as it
    /// did there.
    fn flown_track(&self, plan: &FlightPlan, observed: &ObservedVehicle) -> Vec<PlanPoint> {
        let positions = observed.flown.iter().map(|(_, position)| position);
        let mut flown: Vec<PlanPoint> = positions.map(|at| point(plan, at)).collect();
        if let (Some((heard_ms, first)), Some(from)) = (observed.flown.first(), flown.first()) {
            #[expect(clippy::cast_precision_loss, reason = "milliseconds of one command")]
            let before_s = heard_ms.saturating_sub(self.steady_ms) as f64 / 1000.0 * self.speedup;
            let [north_m, east_m, _] = first
                .velocity_cmps
                .map(|cmps| f64::from(cmps) / 100.0 * before_s);
            let then = PlanPoint::new(
                from.at.east_m - east_m,
                from.at.north_m - north_m,
                from.amsl,
            );
            flown.insert(0, then);
        }
        flown
    }
}

/// The planned mission with the items on board.
fn held(planned: &VehicleMission, observed: &ObservedVehicle) -> Result<VehicleMission, String> {
    let held = VehicleMission {
        items: observed.onboard.mission.clone(),
        ..planned.clone()
    };
    let returns = |item: &Item| item.command == command::NAV_RETURN_TO_LAUNCH;
    if held.items.iter().any(returns) {
        return Err("flies a NAV_RETURN_TO_LAUNCH, on a path of its own".to_owned());
    }
    Ok(held)
}

/// Where its planned path begins, and where it ends.
fn start_and_goal(plan: &FlightPlan, vehicle: usize) -> Option<(PlanPoint, PlanPoint)> {
    let sites = plan.world.sites.get(vehicle)?;
    Some((sites.start, sites.goal))
}

/// Radius of the circle on which a wing stays where it is, metres; 0 without a wing.
fn stay_radius_m(vehicle: &Vehicle) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "parameters are float32")]
    let radius_m = |wing: &Wing| wing.loiter_radius_m as f32;
    vehicle.wing.as_ref().map_or(0.0, radius_m)
}

/// Whether a vehicle stands on the ground and has its takeoff ahead: one that has taken off may land below
/// its home.
fn stands(observed: &ObservedVehicle, items: &[Item], row: usize) -> bool {
    let is_low = observed.position.above_home_m() < AIRBORNE_M;
    is_low && items.iter().skip(row - 1).any(is_takeoff)
}

/// Where the leg to the item of a row begins, unless at home; and the waypoints ahead in the air,
/// each with the index of its item.
fn split_path(
    reference: &ReferenceTrajectory,
    row: usize,
) -> (Option<PlanPoint>, Vec<(usize, PlanPoint)>) {
    let waypoints = &reference.waypoints;
    let first = waypoints.iter().position(|w| w.item >= row);
    let first = first.unwrap_or(waypoints.len());
    let in_air = waypoints.len() - usize::from(reference.lands).min(waypoints.len());
    let ahead = waypoints.get(first.max(1)..in_air).unwrap_or_default();
    let ahead = ahead.iter().map(|w: &Waypoint| (w.item - 1, w.point));
    let before = first.saturating_sub(1);
    // A mission that was given in the air does not begin at home.
    let origin = waypoints.get(before.max(1)).filter(|_| before > 0);
    (origin.map(|w| w.point), ahead.collect())
}

/// The waypoints of a mission without their times.
fn untimed(held: &VehicleMission, plan: &FlightPlan) -> ReferenceTrajectory {
    let no_times = Track {
        vehicle: String::new(),
        moments: Vec::new(),
        late_s: Vec::new(),
    };
    ReferenceTrajectory::new(held, &no_times, &plan.world)
}

/// A position in planning coordinates.
fn point(plan: &FlightPlan, position: &Position) -> PlanPoint {
    PlanPoint {
        at: plan.world.frame.to_plan(position.place()),
        amsl: position.amsl(),
    }
}
