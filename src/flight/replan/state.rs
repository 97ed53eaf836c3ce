//! The state of a vehicle in flight: what it holds, where it is, what it has ahead.

use super::activity::Doing;
use super::in_column::{InColumn, puts_down};
use super::observation::ObservedVehicle;
use super::path_distance::comes_near;
use crate::flight::conformance::reference::{ReferenceTrajectory, Waypoint};
use crate::flight::itinerary::rows::left_of;
use crate::flight::itinerary::stops::Service;
use crate::flight::launch::plan::FlightPlan;
use crate::geodesy::{Amsl, EastNorth, LocalFrame, PlanPoint};
use crate::link::Position;
use crate::mission::{Home, Item, VehicleMission, command, frame};
use crate::spec::{Finish, Stop, Vehicle, Wing};
use crate::verify::Track;
use crate::world::{Departure, VehicleSites};

/// Lower above its home than this a vehicle stands on the ground, metres.
const AIRBORNE_M: f64 = 1.5;
/// A waypoint this near a goal is the goal, metres.
const GOAL_M: f64 = 2.0;
/// Waypoints nearer than this are at one place, metres.
const SAME_M: f64 = 0.5;

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

/// A place that a new path leads over.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Via {
    /// Index into `ahead` of its first waypoint.
    first: usize,
    /// What is done there, as it is on board with altitudes AMSL: holds and actions.
    pub(super) items: Vec<Item>,
    /// Where.
    pub(super) point: PlanPoint,
}

/// Where a new path branches off the present one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Branch {
    /// The point.
    pub(super) point: PlanPoint,
    /// Waypoints of `ahead` that lie before it: the vehicle retains them.
    pub(super) retained: usize,
    /// Distance along the path to it, metres.
    pub(super) distance_m: f64,
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
        let held = VehicleMission {
            items: observed.onboard.mission.clone(),
            ..planned.clone()
        };
        let returns = |item: &Item| item.command == command::NAV_RETURN_TO_LAUNCH;
        if held.items.iter().any(returns) {
            return Err("flies a NAV_RETURN_TO_LAUNCH, on a path of its own".to_owned());
        }
        let first = usize::from(planned.autopilot.first_row());
        let row = (usize::from(observed.seq) + first).max(1);
        let here = point(plan, &observed.position);
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
            doing: Doing::of((plan, vehicle), planned, observed.beat.custom_mode, here),
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

    /// Whether its path comes nearer than a distance to a place before a branch.
    pub(super) fn meets_before(&self, branch: &Branch, center: EastNorth, distance_m: f64) -> bool {
        let mut points = self.points();
        points.truncate(branch.retained + 1);
        points.push(branch.point);
        comes_near(&points, center, distance_m)
    }

    /// The branch after a distance along its path; none beyond the end.
    pub(super) fn branch_after(&self, distance_m: f64) -> Option<Branch> {
        let mut left_m = distance_m;
        let points = self.points();
        for (retained, pair) in points.windows(2).enumerate() {
            let length_m = pair[0].distance_m(pair[1]);
            if left_m < length_m {
                let share = left_m / length_m;
                let mix = |a: f64, b: f64| a + (b - a) * share;
                let point = PlanPoint::new(
                    mix(pair[0].at.east_m, pair[1].at.east_m),
                    mix(pair[0].at.north_m, pair[1].at.north_m),
                    Amsl(mix(pair[0].amsl.0, pair[1].amsl.0)),
                );
                return Some(Branch {
                    point,
                    retained,
                    distance_m,
                });
            }
            left_m -= length_m;
        }
        None
    }

    /// Whether a branch lies in the column of a drop.
    pub(super) fn drops_at(&self, branch: &Branch) -> bool {
        self.drops.get(branch.retained).is_some_and(|drops| *drops)
    }

    /// The routes to plan from a branch, end to end.
    pub(super) fn routes(&self, branch: &Branch) -> Vec<(PlanPoint, PlanPoint)> {
        let Some(&(_, last)) = self.ahead.last() else {
            return Vec::new();
        };
        let mut points = vec![branch.point];
        points.extend(self.vias_after(branch).map(|via| via.point));
        points.push(last);
        points.windows(2).map(|pair| (pair[0], pair[1])).collect()
    }

    /// The places behind a branch that a new path leads over.
    pub(super) fn vias_after(&self, branch: &Branch) -> impl Iterator<Item = &Via> {
        let retained = branch.retained;
        self.vias.iter().filter(move |via| via.first >= retained)
    }

    /// Whether it comes to its goal and returns from there.
    pub(super) fn returns_from(&self, vehicle: &Vehicle, goal: PlanPoint) -> bool {
        let is_goal = |via: &Via| via.point.distance_m(goal) < GOAL_M;
        vehicle.finish == Finish::Return && self.vias.iter().any(is_goal)
    }

    /// The stops of its own that are ahead, in the order in which it visits them, by their indices in
    /// the spec. One at which it rests already is none: it is not done twice.
    pub(super) fn stops_ahead(&self, vehicle: &Vehicle, sites: &VehicleSites) -> Vec<usize> {
        let at = |via: &Via| {
            let is_whole = |stop: &Stop| {
                let is_one_item = stop.actions.is_empty() && stop.drop_m <= 0.0;
                is_one_item || via.items.len() > 1
            };
            let mut stops = vehicle.stops.iter().zip(&sites.stops);
            stops.position(|(stop, point)| via.point.distance_m(*point) < GOAL_M && is_whole(stop))
        };
        self.vias.iter().filter_map(at).collect()
    }

    /// Items that it flies from where it is, with altitudes AMSL instead of above home, each with its
    /// row: the speed that it was commanded, the rest of a takeoff under way, the items ahead. One
    /// that does not fly its mission stays where it is, or where it returns to.
    pub(super) fn items_ahead(&self, frame: &LocalFrame) -> Vec<(usize, Item)> {
        if !self.in_mission() {
            let params = [0.0, 0.0, self.stay_radius_m, 0.0];
            let at = self.doing.stays_at(self.here);
            let stay = item_at(frame, command::NAV_LOITER_UNLIM, params, at);
            return vec![(self.at + 1, stay)];
        }
        let is_speed = |item: &&Item| item.command == command::DO_CHANGE_SPEED;
        let flown = self.held.items.iter().take(self.at);
        let speed = flown.rev().find(is_speed);
        let speed = speed.map(|item| (self.at + 1, *item));
        let ahead = self.held.items.iter().enumerate().skip(self.at);
        let ahead = ahead.filter(|(_, item)| item.command != command::NAV_DELAY);
        let ahead = ahead.map(|(index, item)| {
            let item = match self.ahead.first() {
                Some((_, top)) if is_takeoff(item) => {
                    item_at(frame, command::NAV_WAYPOINT, [0.0; 4], *top)
                }
                _ => with_amsl(item, &self.held.home),
            };
            (index + 1, item)
        });
        speed.into_iter().chain(ahead).collect()
    }

    /// Items ahead before a branch, with altitudes AMSL: waypoints, and what is done on the way.
    pub(super) fn retained_items(&self, branch: &Branch) -> Vec<Item> {
        let end = self.retained_end(branch);
        let items = self.held.items.get(self.first_ahead(branch)..end);
        let items = items.unwrap_or_default().iter();
        items.map(|item| with_amsl(item, &self.held.home)).collect()
    }

    /// The speed that it flies with now: that of the last stop behind it that has one, m/s.
    pub(super) fn speed_now_mps(&self, vehicle: &Vehicle, sites: &VehicleSites) -> f64 {
        let ahead = self.stops_ahead(vehicle, sites);
        let behind = vehicle.stops.iter().enumerate().rev();
        let mut behind = behind.filter(|(index, _)| !ahead.contains(index));
        let own_mps = behind.find_map(|(_, stop)| stop.speed_mps);
        own_mps.unwrap_or(vehicle.speed_mps)
    }

    /// Whether the items that are retained are waypoints one after the other, and what is done there.
    pub(super) fn is_contiguous(&self, branch: &Branch) -> bool {
        let retained = self.ahead.iter().take(branch.retained);
        let indices: Vec<usize> = retained.map(|(index, _)| *index).collect();
        let mut pairs = indices.windows(2);
        pairs.all(|pair| after_actions(&self.held.items, pair[0]) == pair[1])
    }

    /// Index of the first item ahead that is retained, or of the first that is not.
    pub(super) fn first_ahead(&self, branch: &Branch) -> usize {
        let first = self.ahead.first().filter(|_| branch.retained > 0);
        first.map_or_else(|| self.retained_end(branch), |(index, _)| *index)
    }

    /// Index of the first item that is not retained.
    pub(super) fn retained_end(&self, branch: &Branch) -> usize {
        let last = branch.retained.checked_sub(1);
        let last = last.and_then(|last| self.ahead.get(last));
        let none = || {
            // A takeoff that is under way is not begun again.
            let items = self.held.items.iter().skip(self.at);
            let stays = |item: &&Item| is_takeoff(item) || item.place().is_none();
            self.at + items.take_while(stays).count()
        };
        last.map_or_else(none, |(index, _)| after_actions(&self.held.items, *index))
    }
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

/// Index of the first item after a waypoint that is more than something done there.
fn after_actions(items: &[Item], waypoint: usize) -> usize {
    let rest = items.iter().skip(waypoint + 1);
    let is_action = |item: &&Item| {
        item.command > command::NAV_LAST || item.command == command::NAV_PAYLOAD_PLACE
    };
    waypoint + 1 + rest.take_while(is_action).count()
}

/// Where a mission stays or turns back ahead, but for its start. A drop is one of them, at its upper end:
/// what it does down there, and the ways there and back, remain as they are on board.
fn vias(
    held: &VehicleMission,
    (ahead, drops): (&[(usize, PlanPoint)], &[bool]),
    (start, goal): (PlanPoint, PlanPoint),
) -> Vec<Via> {
    let item = |at: usize| ahead.get(at).and_then(|(index, _)| held.items.get(*index));
    let holds = |at: usize| {
        let is_hold = |item: &Item| item.command == command::NAV_WAYPOINT && item.params[0] > 0.0;
        item(at).is_some_and(is_hold)
    };
    let is_waypoint = |item: &Item| item.command == command::NAV_WAYPOINT;
    let begin = held.items.iter().position(is_waypoint);
    let mut vias: Vec<Via> = Vec::new();
    let mut at = 0;
    while let Some(&(index, point)) = ahead.get(at) {
        let is_start = begin == Some(index) && point.distance_m(start) < GOAL_M;
        let is_turn = point.distance_m(goal) < GOAL_M && at + 1 < ahead.len();
        let mut last = at;
        while holds(at)
            && holds(last + 1)
            && (drops.get(last + 1).is_some_and(|drops| *drops)
                || ahead
                    .get(last + 1)
                    .is_some_and(|(_, next)| next.distance_m(point) < SAME_M))
        {
            last += 1;
        }
        if !is_start && (holds(at) || is_turn) && last + 1 < ahead.len() {
            let end = after_actions(&held.items, ahead[last].0);
            let done = held.items.get(index..end).filter(|_| holds(at));
            let done = done.unwrap_or_default().iter();
            vias.push(Via {
                first: at,
                items: done.map(|item| with_amsl(item, &held.home)).collect(),
                point,
            });
        }
        at = last + 1;
    }
    vias
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

/// Whether an item is a takeoff.
pub(super) fn is_takeoff(item: &Item) -> bool {
    [command::NAV_TAKEOFF, command::NAV_VTOL_TAKEOFF].contains(&item.command)
}

/// An item at a point, with an altitude AMSL.
pub(super) fn item_at(
    frame: &LocalFrame,
    command: u16,
    params: [f32; 4],
    point: PlanPoint,
) -> Item {
    let place = frame.from_plan(point.at);
    #[expect(
        clippy::cast_possible_truncation,
        reason = "degrees in 1e-7 and metres as missions have them"
    )]
    Item {
        command,
        frame: crate::mission::frame::GLOBAL,
        params,
        x: (place.lat_deg * 1e7).round() as i32,
        y: (place.lon_deg * 1e7).round() as i32,
        z: point.amsl.0 as f32,
        autocontinue: true,
    }
}

/// An item with its altitude AMSL, if it has one above home.
fn with_amsl(item: &Item, home: &Home) -> Item {
    let mut item = *item;
    if item.place().is_some() && frame::canonical(item.frame) == frame::GLOBAL_RELATIVE_ALT {
        item.frame = frame::GLOBAL;
        item.z += home.amsl_m;
    }
    item
}
