//! The places of its present mission that a new path leads over: where a vehicle stays or turns back.

use super::VehicleState;
use super::items::{after_actions, with_amsl};
use crate::geodesy::PlanPoint;
use crate::mission::{Item, VehicleMission, command};
use crate::spec::{Finish, Stop, Vehicle};
use crate::world::VehicleSites;

/// A waypoint this near a goal is the goal, metres.
const GOAL_M: f64 = 2.0;
/// Waypoints nearer than this are at one place, metres.
const SAME_M: f64 = 0.5;

/// A place that a new path leads over.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Via {
    /// Index into `ahead` of its first waypoint.
    pub(in crate::flight::replan) first: usize,
    /// What is done there, as it is on board with altitudes AMSL: holds and actions.
    pub(in crate::flight::replan) items: Vec<Item>,
    /// Where.
    pub(in crate::flight::replan) point: PlanPoint,
}

impl VehicleState {
    /// Whether it comes to its goal and returns from there.
    pub(in crate::flight::replan) fn returns_from(
        &self,
        vehicle: &Vehicle,
        goal: PlanPoint,
    ) -> bool {
        let is_goal = |via: &Via| via.point.distance_m(goal) < GOAL_M;
        vehicle.finish == Finish::Return && self.vias.iter().any(is_goal)
    }

    /// The stops of its own that are ahead, in the order in which it visits them, by their indices in
    /// the spec. One at which it rests already is none: it is not done twice.
    pub(in crate::flight::replan) fn stops_ahead(
        &self,
        vehicle: &Vehicle,
        sites: &VehicleSites,
    ) -> Vec<usize> {
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
}

/// Where a mission stays or turns back ahead, but for its start. A drop is one of them, at its upper end:
/// what it does down there, and the ways there and back, remain as they are on board.
pub(super) fn vias(
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
