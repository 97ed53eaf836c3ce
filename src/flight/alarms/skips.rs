//! A vehicle that goes on to a later item of its mission without having flown those before it, or back to an earlier one:
//! another station, a pilot or the vehicle itself set it. The way from where it is to that item is not verified.

use super::{Alarms, Here, Watched};
use crate::flight::conformance::reference::Waypoint;
use crate::flight::conformance::takeoff::at_its_fastest;
use crate::geodesy::PlanPoint;
use crate::link::Message;
use crate::mission::{Item, command};
use crate::spec::AlarmKind;

/// A waypoint may be passed this long before the vehicle was last said to fly to it, seconds.
const BEFORE_S: f64 = 3.0;
/// An earlier row that it flies to for this long is no message that came late, seconds.
const BACK_S: f64 = 2.0;
/// Unheard, a vehicle may be faster than planned by this share.
const FASTER: f64 = 1.5;

/// Where a vehicle is in its mission by its own word, and what it was seen to pass.
#[derive(Debug, Default)]
pub(super) struct Skips {
    /// The row that it flew to last, when it said so, seconds after T0, and where it was then.
    row: Option<(usize, f64, PlanPoint)>,
    /// Waypoints ahead that it was near, by their index, and when.
    near: Vec<(usize, f64)>,
    /// When its last position came, and whether positions were missing since it last said its row.
    position_s: f64,
    has_gap: bool,
    /// Since when it has said that it flies to an earlier row, seconds after T0.
    back_s: Option<f64>,
}

impl Skips {
    /// The mission of a vehicle on the ground begins: with its first item.
    pub(super) fn begin(&mut self, t_s: f64, here: Option<&Here>) {
        self.row = here.map(|here| (1, t_s, here.point));
    }

    fn take_position(&mut self, t_s: f64, stale_s: f64) {
        self.has_gap |= t_s - self.position_s > stale_s;
        self.position_s = t_s;
    }

    fn take_near(&mut self, waypoint: usize, t_s: f64) {
        match self.near.iter_mut().find(|of| of.0 == waypoint) {
            Some(known) => known.1 = t_s,
            None => self.near.push((waypoint, t_s)),
        }
    }
}

impl Watched<'_> {
    /// The waypoints that it must come to, by their index: neither home nor the top of its takeoff, nor where a
    /// mission that was given in flight branches off.
    fn ahead(&self) -> impl Iterator<Item = (usize, &Waypoint)> {
        let first = self.plan.waypoints.first();
        let before = match first.is_some_and(|first| first.item == 0) {
            true => 2,
            false => 1,
        };
        self.plan.waypoints.iter().enumerate().skip(before)
    }

    fn take_near(&mut self, t_s: f64, here: &Here) {
        let Some((row, ..)) = self.skips.row else {
            return;
        };
        let near_m = self.tube.tube.across_m;
        let takeoff = self.tube.takeoff.as_ref();
        let is_near = |(_, of): &(usize, &Waypoint)| {
            let (place, at) = (of.point.at, here.point.at);
            let is_abeam = takeoff.is_some_and(|takeoff| takeoff.passes((of.item, place), at));
            of.item >= row && (is_abeam || place.distance_m(at) - of.radius_m <= near_m)
        };
        let near: Vec<usize> = self.ahead().filter(is_near).map(|of| of.0).collect();
        for waypoint in near {
            self.skips.take_near(waypoint, t_s);
        }
    }

    /// Whether it may have flown a waypoint since it said that it flew to `row`.
    fn may_have_passed(&self, (index, waypoint): (usize, &Waypoint), t_s: f64) -> bool {
        let Some((_, since_s, from)) = self.skips.row else {
            return true;
        };
        let mut near = self.skips.near.iter();
        if near.any(|of| of.0 == index && of.1 >= since_s - BEFORE_S) {
            return true;
        }
        let reach_m = FASTER * at_its_fastest(self.vehicle).fastest_mps() * (t_s - since_s);
        let away_m = from.at.distance_m(waypoint.point.at) - waypoint.radius_m;
        self.skips.has_gap && away_m <= reach_m + self.tube.tube.across_m
    }

    /// Takes in which row it flies to, at a time in seconds after T0; in words, what it has skipped.
    fn take_row(&mut self, t_s: f64, row: usize, stale_s: f64) -> Option<String> {
        let here = self.here?;
        let is_flown = self.is_on_plan() && self.duty.is_up && self.onboard.holds_its_plan(t_s);
        if !is_flown || row > self.onboard.items() {
            return None;
        }
        self.skips.has_gap |= t_s - self.skips.position_s > stale_s;
        let before = self.skips.row.map_or(row, |(before, ..)| before);
        let since_s = (row < before).then(|| self.skips.back_s.unwrap_or(t_s));
        self.skips.back_s = since_s;
        let is_sure = |since_s| t_s - since_s >= BACK_S && self.onboard.armed_since(since_s);
        if since_s.is_some_and(|since_s| !is_sure(since_s)) {
            return None;
        }
        let skipped = self.ahead().filter(|(_, of)| {
            let is_between = (before..row).contains(&of.item);
            // Of an item with several places, such as a landing, one is enough.
            let mut own = self.ahead().filter(|(_, other)| other.item == of.item);
            is_between && !own.any(|of| self.may_have_passed(of, t_s))
        });
        let mut items: Vec<usize> = skipped.map(|(_, of)| of.item).collect();
        items.dedup();
        if before != row {
            // The message may come after what it says: what was passed shortly before it counts.
            self.skips.near.retain(|(_, at_s)| *at_s >= t_s - BEFORE_S);
        }
        self.skips.row = Some((row, t_s, here.point));
        self.skips.has_gap = false;
        let all = self.onboard.items();
        if row < before {
            self.skips.back_s = None;
            let text =
                format!("goes back: it flies to item {row} of {all} again, after item {before}");
            let jumps = |of: &Item| [command::DO_JUMP, command::DO_JUMP_TAG].contains(&of.command);
            return (!self.mission.items.iter().any(jumps)).then_some(text);
        }
        let what = match items.as_slice() {
            [] => return None,
            [one] => format!("item {one}"),
            [first, .., last] => format!("items {first} to {last}"),
        };
        Some(format!("skips {what}: it flies to item {row} of {all}"))
    }
}

impl Alarms<'_> {
    /// Takes in a position that came at a time in seconds after T0.
    pub(super) fn look_at_waypoints(&mut self, t_s: f64, vehicle: usize, here: &Here) {
        let stale_s = self.stale_s();
        let of = &mut self.vehicles[vehicle];
        of.skips.take_position(t_s, stale_s);
        of.take_near(t_s, here);
    }

    /// Whether a vehicle goes on to another item, and has skipped some.
    pub(super) fn look_at_items(&mut self, t_s: f64, vehicle: usize, message: &Message) {
        let Message::MissionCurrent { seq, .. } = message else {
            return;
        };
        let stale_s = self.stale_s();
        let of = &mut self.vehicles[vehicle];
        let row = usize::from(*seq) + usize::from(of.mission.autopilot.first_row());
        if let Some(text) = of.take_row(t_s, row, stale_s) {
            self.push(t_s, (AlarmKind::Mission, vehicle, None, ""), true, text);
        }
    }
}
