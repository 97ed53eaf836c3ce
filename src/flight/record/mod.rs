//! What was flown.

pub(super) mod fix;
pub(super) mod handoff;
pub(super) mod interrupted;
pub(super) mod invalid_line;
pub(super) mod journal;
pub(super) mod lines;
pub(super) mod read;
pub(super) mod tlog;

pub use fix::Fix;

use super::conformance::reference::ReferenceTrajectory;
use super::itinerary::stops::Itinerary;
use crate::spec::{Action, AlarmKind, Threat};

/// Items reached that are taken down of one vehicle within [`PERIOD_S`].
const MAX_REACHED: usize = 100;
/// Times of vehicles and of `replan` may be apart by this, seconds.
const CLOCKS_S: f64 = 1.0;
/// Seconds of flight.
const PERIOD_S: f64 = 10.0;

/// The flight of one vehicle.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Flown {
    /// Since when its positions are looked for, seconds after T0; none: since its planned departure.
    pub since_s: Option<f64>,
    /// When it ended, seconds after T0; none for a flight that nobody saw the end of.
    pub until_s: Option<f64>,
    /// In order of time, from T0 to the end.
    pub fixes: Vec<Fix>,
    /// When each item was said to be reached, seconds after T0.
    pub reached: Vec<(usize, f64)>,
    /// How it ended.
    pub end: super::End,
    /// What it was ordered to do instead of its mission, last.
    pub ordered: Action,
    /// When, seconds after T0; none of a flight that was ordered nothing.
    pub ordered_s: Option<f64>,
    /// Since when it has been off its mission as ordered, whatever it was ordered after that.
    pub left_s: Option<f64>,
}

/// A plan, and its mark in what a vehicle reports.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Items of its mission without home. A new plan has another number than the one
    /// before it, which identifies it in what the vehicle reports.
    pub items: usize,
    /// What is flown is held against this.
    pub reference: ReferenceTrajectory,
    /// When it was recorded, seconds after T0: before it is sent.
    pub from_s: f64,
}

impl Plan {
    /// Whether a vehicle that holds another number of items from a time in seconds after T0 on may fly it then.
    pub(super) fn may_begin(&self, items: usize, t_s: f64) -> bool {
        self.items == items && self.from_s <= t_s + CLOCKS_S
    }
}

/// A threat that was not there when the fleet took off.
#[derive(Clone, Debug, PartialEq)]
pub struct PopUp {
    /// From when on it was known, seconds after T0.
    pub from_s: f64,
    /// Where.
    pub threat: Threat,
}

/// One vehicle's part of a record.
#[derive(Clone, Debug, PartialEq)]
pub struct Flight {
    /// Id in the spec.
    pub vehicle: String,
    /// The plans that it was given, one after the other; the first before it took off.
    pub plans: Vec<Plan>,
    /// What it flew.
    pub flown: Flown,
    /// Its stops and what they are for; empty where that was not recorded.
    pub itinerary: Itinerary,
}

/// A flight as it was recorded: all that its verdict needs besides the spec.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// SHA-256 of the spec file, hexadecimal.
    pub spec_sha256: String,
    /// Seconds since 1970 at T0.
    pub t0_unix_s: u64,
    /// How much faster than the wall's clock the vehicles' time went.
    pub speedup: f64,
    /// In the order of the spec.
    pub flights: Vec<Flight>,
    /// Threats that came up on the way.
    pub popups: Vec<PopUp>,
    /// Times that the recording program was stopped for: from, until, seconds after T0.
    pub stops: Vec<(f64, f64)>,
    /// Alarms, in order of time.
    pub alarms: Vec<RaisedAlarm>,
}

/// An alarm as it was recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct RaisedAlarm {
    /// When it was raised, seconds after T0.
    pub t_s: f64,
    /// When it was over, seconds after T0; none for one that was not.
    pub until_s: Option<f64>,
    /// Id in the spec.
    pub vehicle: String,
    /// The other vehicle of a separation.
    pub other: Option<String>,
    /// What it is about.
    pub kind: AlarmKind,
    /// In words.
    pub text: String,
}

impl Record {
    /// Takes down an alarm that was raised or is over; the latter ends the first that stands.
    pub(super) fn take_alarm(&mut self, alarm: RaisedAlarm, is_raised: bool) {
        if is_raised {
            return self.alarms.push(alarm);
        }
        let is_it = |of: &&mut RaisedAlarm| {
            of.until_s.is_none()
                && of.kind == alarm.kind
                && of.vehicle == alarm.vehicle
                && of.other == alarm.other
        };
        if let Some(standing) = self.alarms.iter_mut().find(is_it) {
            standing.until_s = Some(alarm.t_s);
        }
    }
}

impl Flown {
    /// By how much its own clock has slipped behind that of the fleet from its first position to its last, seconds.
    pub(super) fn slipped_s(&self) -> f64 {
        let ends = self.fixes.first().zip(self.fixes.last());
        ends.map_or(0.0, |(first, last)| first.slip_s(last))
    }

    /// Takes down what it is ordered to do, from a time in seconds after T0 on.
    pub(super) fn take_order(&mut self, order: Action, t_s: f64) {
        (self.ordered, self.ordered_s) = (order, Some(t_s));
        let is_off = order != Action::Continue;
        self.left_s = is_off.then(|| self.left_s.unwrap_or(t_s));
    }

    /// Takes down that an item was said to be reached; whether that is news. PX4 says it ten
    /// times. A plan that it is given on the way begins at the first item again. A vehicle that
    /// says it of many items at once is not believed all of it.
    pub(super) fn reach(&mut self, item: usize, t_s: f64) -> bool {
        let is_new = self.reached.last().is_none_or(|(last, _)| *last != item);
        let oldest = self.reached.len().checked_sub(MAX_REACHED);
        let oldest = oldest.and_then(|index| self.reached.get(index));
        let is_flood = oldest.is_some_and(|(_, before_s)| t_s - before_s < PERIOD_S);
        let takes = is_new && !is_flood;
        if takes {
            self.reached.push((item, t_s));
        }
        takes
    }
}

impl Flight {
    /// Which of the plans each position was flown by: a vehicle flies a later one from
    /// where it first says that it holds as many items, and those before it no longer. Of several it is
    /// the last that was recorded by then: one before that was sent, and did not come.
    #[must_use]
    pub fn plan_of_each(&self) -> Vec<usize> {
        let mut at = 0;
        let of = |fix: &Fix| {
            let items = |plan: usize| self.plans.get(plan).map(|plan| plan.items);
            if fix.items > 0 && items(at) != Some(fix.items) {
                let mut later = self.plans.iter().enumerate().skip(at + 1);
                let next = later.rfind(|(_, plan)| plan.may_begin(fix.items, fix.t_s));
                at = next.map_or(at, |(next, _)| next);
            }
            at
        };
        self.flown.fixes.iter().map(of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flight::itinerary::progress::Progress;
    use crate::geodesy::{Amsl, LatLon, LocalFrame};
    use crate::spec::Airframe;

    #[test]
    fn an_item_is_reached_once_however_often_that_is_said_and_again_in_a_later_plan() {
        let mut flown = Flown::default();
        let said = [1, 2, 2, 2, 3, 3, 1, 2, 2];
        let news = said.map(|item| flown.reach(item, 0.0));
        let items: Vec<usize> = flown.reached.iter().map(|of| of.0).collect();
        assert_eq!(items, [1, 2, 3, 1, 2]);
        assert_eq!(news.iter().filter(|is_new| **is_new).count(), 5);
    }

    #[test]
    fn of_plans_with_one_number_of_items_the_last_that_was_recorded_by_then_is_flown() {
        let frame = LocalFrame::new(LatLon {
            lat_deg: 36.3,
            lon_deg: -84.2,
        });
        let plan = |(items, from_s): (usize, f64)| Plan {
            items,
            reference: ReferenceTrajectory::of_waypoints(Vec::new(), (100.0, true), frame),
            from_s,
        };
        let fix = |(t_s, items): (f64, usize)| Fix {
            t_s,
            place: LatLon {
                lat_deg: 36.3,
                lon_deg: -84.2,
            },
            amsl: Amsl(480.0),
            speed_mps: 10.0,
            item: 1,
            items,
            boot_ms: None,
        };
        let flown_by = |plans: &[(usize, f64)], fixes: &[(f64, usize)]| {
            let plans: Vec<Plan> = plans.iter().copied().map(plan).collect();
            let mut progress = Progress::new(Itinerary::default(), Airframe::Copter);
            for plan in &plans {
                progress.add_mission(plan);
            }
            let mut flight = Flight {
                vehicle: "alpha".to_owned(),
                plans,
                flown: Flown::default(),
                itinerary: Itinerary::default(),
            };
            flight.flown.fixes = fixes.iter().copied().map(fix).collect();
            let plan_of = flight.plan_of_each();
            for (fix, plan) in flight.flown.fixes.iter().zip(&plan_of) {
                progress.take(fix);
                assert_eq!(progress.mission(), *plan);
            }
            plan_of
        };
        // The replan of 40 s died before it was sent; or after that.
        let plans = [(9, 0.0), (11, 40.0), (11, 80.0)];
        assert_eq!(
            flown_by(&plans, &[(30.0, 9), (70.0, 9), (90.0, 11)]),
            [0, 0, 2]
        );
        assert_eq!(
            flown_by(&plans, &[(30.0, 9), (70.0, 11), (90.0, 11)]),
            [0, 1, 1]
        );
        // What was not recorded yet cannot be it.
        assert_eq!(flown_by(&plans, &[(20.0, 11), (30.0, 9)]), [0, 0]);
        let back = [(9, 0.0), (11, 40.0), (9, 80.0)];
        assert_eq!(
            flown_by(&back, &[(50.0, 11), (70.0, 9), (90.0, 9)]),
            [1, 1, 2]
        );
    }

    #[test]
    fn a_flood_of_items_reached_is_bounded() {
        let mut flown = Flown::default();
        // A thousand a second, two in turn, for a minute.
        let said = (0..60_000_u32).map(|n| {
            let item = if n % 2 == 0 { 1 } else { 2 };
            flown.reach(item, 1e-3 * f64::from(n))
        });
        assert_eq!(said.filter(|is_new| *is_new).count(), 600);
        assert!(flown.reach(7, 71.0), "an honest one later");
    }
}
