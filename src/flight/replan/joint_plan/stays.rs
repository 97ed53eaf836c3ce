//! What a vehicle has still to do at the places that its new path leads over, and on the way.

use crate::flight::replan::new_mission::head_len;
use crate::flight::replan::state::{VehicleState, Via};
use crate::mission::{Item, command};
use crate::spec::{Finish, OnWay, Vehicle};
use crate::world::VehicleSites;

/// Puts what is done at the places that a new path leads over instead of the turns there.
pub(super) fn keep_stays<'a>(items: &mut Vec<Item>, vias: impl Iterator<Item = &'a Via>) {
    let is_turn = |item: &Item| item.command == command::NAV_WAYPOINT && item.params[0] > 0.0;
    let mut from = 0;
    for via in vias.filter(|via| !via.items.is_empty()) {
        let Some(turn) = items.iter().skip(from).position(is_turn) else {
            return;
        };
        let at = from + turn;
        items.splice(at..=at, via.items.iter().copied());
        from = at + via.items.len();
    }
}

/// What it has still to do at its goal and on the way there: nothing on its way back.
pub(super) fn on_way_ahead(state: &VehicleState, vehicle: &Vehicle, sites: &VehicleSites) -> OnWay {
    let is_over = vehicle.finish == Finish::Return && !state.returns_from(vehicle, sites.goal);
    match is_over {
        true => OnWay::default(),
        false => vehicle.on_way.clone(),
    }
}

/// Removes the last picture at the end of new routes: one that returns takes it at its goal.
pub(super) fn drop_last_trigger(items: &mut Vec<Item>) {
    let is_trigger = |item: &Item| item.command == command::DO_SET_CAM_TRIGG_DIST;
    let last = items.iter().rposition(is_trigger);
    if let Some(last) = last.filter(|last| *last >= head_len(items)) {
        items.remove(last);
    }
}

/// The speed that the items of a place set for the way from there, m/s, if they do.
pub(super) fn speed_after_mps(items: &[Item]) -> Option<f64> {
    let changes = items.iter().rev();
    let mut changes = changes.filter(|item| item.command == command::DO_CHANGE_SPEED);
    let speed_mps = changes.next().map(|item| f64::from(item.params[1]));
    speed_mps.filter(|speed_mps| *speed_mps > 0.0)
}

/// How long a vehicle is at the items of a place, seconds: its holds, and its ways down and up.
pub(super) fn rest_s(items: &[Item], vehicle: &Vehicle) -> f64 {
    let waypoints = items
        .iter()
        .filter(|item| item.command == command::NAV_WAYPOINT);
    let waypoints: Vec<&Item> = waypoints.collect();
    let holds = waypoints.iter().map(|item| f64::from(item.params[0]));
    let ways = waypoints.windows(2).map(|pair| {
        let rise_m = f64::from(pair[1].z - pair[0].z);
        (rise_m / vehicle.climb_mps).max(-rise_m / vehicle.descent_mps)
    });
    holds.sum::<f64>() + ways.sum::<f64>()
}
