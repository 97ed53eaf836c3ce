//! Whether a vehicle holds or lands as ordered: by its mode and by its positions. A copter must be
//! in the mode with its mean position at rest (`arrival.rs`), a wing must fly one full circle in
//! the mode (`orbit.rs`). Whether an alarm may order one is judged before (`alarms/order_safety.rs`), and from the
//! record after the flight (`conformance/`).

use super::obeying::Headway;
use super::{FlightVehicle, Instruction, Stay};
use crate::flight::record::Fix;
use crate::flight::session::arrival::{self, Mean, REST_S};
use crate::flight::session::modes;
use crate::flight::session::orbit::Orbit;
use crate::geodesy::LatLon;
use crate::link::{Command, Time};

/// A hold or a landing is ordered again after this time, until the mode shows it, milliseconds.
const AGAIN_MS: u64 = 2000;
/// A mode that was accepted is shown within this time, milliseconds: heartbeats come each second.
const ACCEPTED_MS: u64 = 3000;
/// A position that is older says nothing about where it is now, milliseconds.
const PLACED_MS: u64 = 3000;
/// One that is not seen for this long is reported, seconds; a hold of a wing that circles already,
/// later, because a large circle takes time.
const CONFIRM_S: f64 = 20.0;
/// And again after this time, seconds.
const REPORTED_AGAIN_S: f64 = 30.0;
const CIRCLE_S: f64 = 120.0;
/// A copter that is farther than this from where it held has left it, metres.
const LEFT_M: f64 = 10.0;
/// Farther than this from where it may return to, a vehicle that lands does not return, metres.
const RETURNED_M: f64 = 150.0;

/// A wing is at most so much wider than its circle in wind; the radius where it is not known, metres.
const WIDE_CIRCLE: f64 = 1.5;
const CIRCLE_M: f64 = 150.0;
/// A copter that has left its hold holds again when it has moved less than this for [`CONFIRM_S`], metres.
const DRIFTED_M: f64 = 4.0;

/// What is known of an ordered hold, or of a landing: then the mode alone counts.
#[derive(Clone, Debug, Default)]
pub(super) struct HoldWatch {
    /// When it was first looked for, seconds after T0, and where the vehicle was then.
    ordered_s: Option<f64>,
    ordered_at: Option<LatLon>,
    again: Option<Time>,
    /// Time of the first position in the mode of the hold, seconds after T0.
    in_mode_s: Option<f64>,
    was_in_mode: bool,
    is_reported: bool,
    /// When a hold was last reported missing, seconds after T0.
    reported_s: Option<f64>,
    /// Whether it has left what it was ordered to do for another mode, and what is to say of that.
    has_left: bool,
    left_order: Option<String>,
    /// Where it held first.
    anchor: Option<Mean>,
    /// Since when it has been near the anchor again, after it had left it, seconds after T0.
    left_s: Option<f64>,
    /// Whether it was ordered to land, and does so at the end of its mission.
    pub(super) lands_as_planned: bool,
    /// Whether it did so when its flight was taken over: who ordered it is not known.
    pub(super) is_of_others: bool,
    /// How far a landing or a return has got.
    pub(super) headway: Option<Headway>,
    /// Until when its mode may not show a return yet that it has accepted.
    accepted_until: Option<Time>,
    /// The last answer that was reported.
    answer: Option<String>,
}

impl HoldWatch {
    /// Whether its heartbeat has shown the mode that was ordered.
    pub(super) fn was_in_mode(&self) -> bool {
        self.was_in_mode
    }

    /// Whether an answer is news.
    pub(super) fn is_news(&mut self, answer: &str) -> bool {
        let is_news = self.answer.as_deref() != Some(answer);
        self.answer = Some(answer.to_owned());
        is_news
    }
}

impl FlightVehicle<'_> {
    /// Whether it holds as ordered, and still does: somebody else may take it over.
    pub(super) fn check_hold(&mut self, t_s: f64, fix: Fix) {
        let mode = self.vehicle.map(|(_, heartbeat)| heartbeat.custom_mode);
        let in_mode = mode.is_some_and(|mode| modes::is_hold(self.of.mission, mode));
        let since_s = self.hold.in_mode_s.unwrap_or(fix.t_s);
        self.hold.in_mode_s = in_mode.then_some(since_s);
        self.hold.was_in_mode |= in_mode;
        let rest = self.rest(since_s);
        if self.holds {
            let moved_m = rest
                .zip(self.hold.anchor)
                .map(|(at, anchor)| at.distance_m(anchor));
            let why = match moved_m {
                _ if !in_mode => "its mode is another one".to_owned(),
                Some(moved_m) if moved_m > self.left_m() => format!("it has moved {moved_m:.0} m"),
                _ => return,
            };
            self.holds = false;
            self.hold.left_s = Some(fix.t_s);
            self.hold.anchor = rest.or(self.hold.anchor);
            self.orbit = Orbit::default();
            let text = format!("does not hold any more: {why}");
            return self.news.push_back(text);
        }
        self.heed_left("hold", in_mode);
        self.holds = if self.of.mission.airframe.has_wing() {
            self.has_circled(fix, in_mode)
        } else {
            in_mode && rest.is_some_and(|rest| rest.is_still && self.stays_again(rest, fix.t_s))
        };
        if self.holds {
            self.hold.anchor = rest;
            return self.news.push_back("holds".to_owned());
        }
        self.order_again(in_mode, modes::hold(self.of.mission));
        self.report_missing_hold(t_s, fix, in_mode);
    }

    /// An order that it was seen to obey, and left for another mode than its mission: somebody ended it, or the
    /// vehicle itself.
    fn heed_left(&mut self, what: &str, in_mode: bool) {
        let has_left = self.hold.was_in_mode && !in_mode && !self.in_mission;
        let mode = self.vehicle.map(|(_, heartbeat)| heartbeat.custom_mode);
        if has_left && !self.hold.has_left {
            self.hold.left_order = mode.map(|mode| {
                let name = modes::name(self.of.mission, mode);
                format!("left its {what} for {name}, and is not ordered again")
            });
        }
        self.hold.has_left = has_left;
    }

    /// How far from where it held first it has left it, metres: a wing is on its circle anywhere.
    fn left_m(&self) -> f64 {
        match self.of.mission.airframe.has_wing() {
            true => WIDE_CIRCLE * 2.0 * self.circle_m().unwrap_or(CIRCLE_M).max(LEFT_M),
            false => LEFT_M,
        }
    }

    /// The radius of the circles of a wing by its parameters, metres.
    pub(super) fn circle_m(&self) -> Option<f64> {
        let mut names = ["WP_LOITER_RAD", "NAV_LOITER_RAD"].into_iter();
        let radius_m = names.find_map(|name| self.of.mission.param_si(name));
        radius_m.map(f64::abs)
    }

    /// Whether one that has moved out of its hold has been at one place for long: a slow drift is none.
    fn stays_again(&mut self, rest: Mean, t_s: f64) -> bool {
        let Some(left_s) = self.hold.left_s else {
            return true;
        };
        let moved_m = (self.hold.anchor).map_or(f64::INFINITY, |anchor| rest.distance_m(anchor));
        if moved_m > DRIFTED_M {
            (self.hold.left_s, self.hold.anchor) = (Some(t_s), Some(rest));
            return false;
        }
        t_s - left_s >= CONFIRM_S
    }

    /// The mean of its last positions, once it is in the mode of the hold for long enough.
    fn rest(&self, since_s: f64) -> Option<Mean> {
        let last = self.flown.fixes.last()?;
        let is_long = last.t_s - since_s >= 2.0 * REST_S;
        let frame = self.of.reference.frame();
        is_long.then(|| arrival::mean(frame, &self.flown.fixes))
    }

    /// An order that somebody else ended is not ordered again.
    fn order_again(&mut self, in_mode: bool, order: Command) {
        let is_idle = self.pending.is_none() && self.orders.is_empty();
        if in_mode || self.hold.was_in_mode || !is_idle {
            return;
        }
        let again = *self.hold.again.get_or_insert(self.now + AGAIN_MS);
        if self.now >= again {
            self.hold.again = None;
            self.command([order]);
        }
    }

    /// Again and again, and not of a vehicle that may still do it.
    fn report_missing_hold(&mut self, t_s: f64, fix: Fix, in_mode: bool) {
        let from = *self.hold.ordered_at.get_or_insert(fix.place);
        let since_s = t_s - *self.hold.ordered_s.get_or_insert(t_s);
        let circles = in_mode && self.of.mission.airframe.has_wing();
        let limit_s = if circles { CIRCLE_S } else { CONFIRM_S };
        let is_due = self
            .hold
            .reported_s
            .is_none_or(|at_s| t_s - at_s >= REPORTED_AGAIN_S);
        if since_s < limit_s || !is_due {
            return;
        }
        (self.hold.is_reported, self.hold.reported_s) = (true, Some(t_s));
        let why = if in_mode {
            "it is in the mode, and does not stay where it is"
        } else if self.hold.was_in_mode {
            "it was in the mode, and left it"
        } else {
            "its mode is another one; it is ordered again"
        };
        let (away_m, of_place) = (from.chord_m(fix.place), self.motors.height.of_place());
        self.news.push_back(format!(
            "hold not confirmed: {why} ({away_m:.0} m from where it was ordered to{of_place})"
        ));
    }

    /// Whether its mode shows that it lands, or returns, as ordered: until then the order is repeated.
    pub(super) fn check_landing_or_return(&mut self, t_s: f64, fix: Fix) {
        let mode = self.vehicle.map(|(_, heartbeat)| heartbeat.custom_mode);
        let mission = self.of.mission;
        let lands = mode.is_some_and(|mode| modes::is_land(mission, mode));
        let returns = mode.is_some_and(|mode| modes::is_return(mission, mode));
        let (order, in_mode, what) = match self.instruction {
            Some(Instruction::Land) => (modes::land(mission), lands, "landing"),
            // At the end of a return an autopilot may change to its landing.
            Some(Instruction::Return) => {
                let (home_m, rally_m) = self.away_from_returns_m(fix);
                let is_there = home_m.min(rally_m) <= RETURNED_M;
                let order = modes::return_to_launch(mission);
                (Some(order), returns || lands && is_there, "return")
            }
            Some(Instruction::Hold) | None => return,
        };
        self.hold.was_in_mode |= in_mode;
        if let Some(order) = order.filter(|_| self.is_placed()) {
            self.order_again(in_mode, order);
        }
        self.heed_left(what, in_mode);
        self.check_headway(fix, in_mode);
        let since_s = t_s - *self.hold.ordered_s.get_or_insert(t_s);
        if self.hold.was_in_mode || self.hold.is_reported || since_s < CONFIRM_S {
            return;
        }
        self.hold.is_reported = true;
        self.news.push_back(format!(
            "{what} not confirmed: its mode is another one; it is ordered again"
        ));
    }

    /// That it has left what it was ordered to do, in words, once.
    pub(crate) fn take_left_order(&mut self) -> Option<String> {
        self.hold.left_order.take()
    }

    /// Whether it is known where it is now: a way that was judged from elsewhere is not ordered.
    pub(crate) fn is_placed(&self) -> bool {
        self.is_positioned() && self.motors.height.is_placed()
    }

    /// Whether a position came a short time ago.
    pub(super) fn is_positioned(&self) -> bool {
        self.position_at
            .is_some_and(|at| self.now - at <= PLACED_MS)
    }

    /// Whether it was ordered to return, and neither its mode nor its answer has shown that yet.
    pub(crate) fn is_to_return(&self) -> bool {
        let may_return = (self.hold.accepted_until).is_some_and(|until| self.now < until);
        self.instruction == Some(Instruction::Return) && !self.hold.was_in_mode && !may_return
    }

    /// It accepts a return: it may be on its way before its next heartbeat.
    pub(super) fn heed_accepted(&mut self, command: u16) {
        let order = modes::return_to_launch(self.of.mission).command;
        if self.instruction == Some(Instruction::Return) && command == order {
            // One that accepts again and again and does not obey is judged again.
            self.hold
                .accepted_until
                .get_or_insert(self.now + ACCEPTED_MS);
        }
    }

    /// Takes an order back that it has not obeyed.
    pub(crate) fn withdraw(&mut self) {
        (self.instruction, self.pending) = (None, None);
        self.orders.clear();
    }

    /// Whether it was ordered to land or to return and is not seen to.
    pub(crate) fn misses_its_order(&self) -> bool {
        self.hold.is_reported && !self.hold.was_in_mode
    }

    /// Whether somebody has sent it on its mission again, after it obeyed an order to leave it.
    pub(super) fn is_taken_back(&self) -> bool {
        match self.instruction {
            Some(Instruction::Hold) => true,
            Some(Instruction::Land | Instruction::Return) => self.hold.was_in_mode,
            None => false,
        }
    }

    /// Whether it was ordered to hold and is not seen to.
    pub(crate) fn misses_its_hold(&self) -> bool {
        self.instruction == Some(Instruction::Hold) && !self.holds && self.hold.is_reported
    }

    /// Whether it was ordered to land and its mode does not show it.
    pub(crate) fn misses_its_landing(&self) -> bool {
        let is_missed = self.hold.is_reported && !self.hold.was_in_mode;
        self.instruction == Some(Instruction::Land) && is_missed
    }

    /// An order to hold, or to land, begins.
    pub(super) fn begin_instruction(&mut self, instruction: Instruction) {
        (self.instruction, self.holds) = (Some(instruction), false);
        self.hold = HoldWatch::default();
        self.stay = Stay::default();
    }
}
