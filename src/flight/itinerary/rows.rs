//! Which rows of a mission make a stop: `fly`, the verdict on a flight and `replan` ask here, so that
//! they agree on what is done and what is left.

use super::stops::{Itinerary, Service};
use crate::flight::conformance::reference::{ReferenceTrajectory, Waypoint};
use crate::geodesy::EastNorth;

/// A waypoint this near a stop is made for it, metres.
const STOP_M: f64 = 2.0;

/// The rows of a mission that make a stop.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct StopRows {
    /// Rows of its waypoints, ascending; at least one.
    pub(crate) waypoints: Vec<usize>,
    /// How long the vehicle stays there, with the stops before and after it at the same place.
    pub(crate) rest_s: f64,
    /// How far it comes down there, metres.
    pub(crate) descent_m: f64,
    /// Whether it puts down a load on the ground.
    pub(crate) puts_down: bool,
}

impl StopRows {
    pub(crate) fn last(&self) -> usize {
        self.waypoints.last().copied().unwrap_or(0)
    }

    pub(crate) fn first(&self) -> usize {
        self.waypoints.first().copied().unwrap_or(0)
    }

    /// Whether the stop is ahead of a vehicle that flies to a row, or is being made.
    pub(crate) fn is_left(&self, row: usize) -> bool {
        self.last() >= row
    }
}

/// The services with a stop that is left for a vehicle that flies to a row of its mission.
pub(crate) fn left_of(
    itinerary: &Itinerary,
    reference: &ReferenceTrajectory,
    row: usize,
) -> Vec<Service> {
    let rows = rows_of(itinerary, reference);
    let is_left = |stop: &usize| rows[*stop].as_ref().is_some_and(|rows| rows.is_left(row));
    let services = itinerary.services.iter();
    let left = services.filter(|service| service.stops.iter().any(is_left));
    left.cloned().collect()
}

/// The rows of each stop; none of a stop that the mission does not make. A mission that was given in
/// flight makes the last stops alone.
pub(crate) fn rows_of(
    itinerary: &Itinerary,
    reference: &ReferenceTrajectory,
) -> Vec<Option<StopRows>> {
    let frame = reference.frame();
    let sites = itinerary.sites().into_iter();
    let sites: Vec<EastNorth> = sites.map(|place| frame.to_plan(place)).collect();
    let numbers: Vec<usize> = (0..sites.len()).collect();
    let is_same = |a: &usize, b: &usize| sites[*a].distance_m(sites[*b]) < STOP_M;
    // Stops at one place that follow each other are not distinguished: each has all rows there.
    let groups: Vec<&[usize]> = numbers.chunk_by(is_same).collect();
    let at: Vec<EastNorth> = groups.iter().map(|group| sites[group[0]]).collect();
    let count = reference.waypoints.len();
    let in_air = count.saturating_sub(usize::from(reference.lands));
    // Neither home and the takeoff, nor where a mission that was given in flight branches off.
    let first = reference.waypoints.first();
    let before = if first.is_some_and(|w| w.item == 0) {
        2
    } else {
        1
    };
    let waypoints = reference.waypoints.get(before..in_air).unwrap_or_default();
    let mut found = forwards(&at, waypoints);
    if found.iter().any(Option::is_none) {
        found = backwards(&at, waypoints);
    }
    let mut rows = vec![None; sites.len()];
    for (group, found) in groups.iter().zip(found) {
        let Some(found) = found else { continue };
        let rest_s = group.iter().map(|stop| itinerary.stops[*stop].rest_s).sum();
        let puts_down = group.iter().any(|stop| itinerary.stops[*stop].puts_down());
        let made = StopRows {
            puts_down,
            ..stop_rows(&waypoints[found], rest_s)
        };
        for stop in *group {
            rows[*stop] = Some(made.clone());
        }
    }
    rows
}

fn stop_rows(waypoints: &[Waypoint], rest_s: f64) -> StopRows {
    let heights = waypoints.iter().map(|waypoint| waypoint.point.amsl.0);
    let top_m = heights.clone().fold(f64::NEG_INFINITY, f64::max);
    let low_m = heights.fold(f64::INFINITY, f64::min);
    let mut rows: Vec<usize> = waypoints.iter().map(|waypoint| waypoint.item).collect();
    rows.dedup();
    StopRows {
        waypoints: rows,
        rest_s,
        descent_m: top_m - low_m,
        puts_down: false,
    }
}

/// Ranges of waypoints, each the first at its place after the one before.
fn forwards(at: &[EastNorth], waypoints: &[Waypoint]) -> Vec<Option<std::ops::Range<usize>>> {
    let mut from = 0;
    let of = |place: &EastNorth| {
        let is_there = |waypoint: &Waypoint| waypoint.point.at.distance_m(*place) < STOP_M;
        let rest = waypoints.get(from..).unwrap_or_default();
        let first = from + rest.iter().position(is_there)?;
        let count = waypoints[first..]
            .iter()
            .take_while(|w| is_there(w))
            .count();
        from = first + count;
        Some(first..from)
    };
    at.iter().map(of).collect()
}

/// The same from the last stop back.
fn backwards(at: &[EastNorth], waypoints: &[Waypoint]) -> Vec<Option<std::ops::Range<usize>>> {
    let mut until = waypoints.len();
    let of = |place: &EastNorth| {
        let is_there = |waypoint: &Waypoint| waypoint.point.at.distance_m(*place) < STOP_M;
        let end = waypoints[..until].iter().rposition(is_there)? + 1;
        let before = waypoints[..end].iter().rev();
        until = end - before.take_while(|w| is_there(w)).count();
        Some(until..end)
    };
    let mut found: Vec<_> = at.iter().rev().map(of).collect();
    found.reverse();
    found
}
