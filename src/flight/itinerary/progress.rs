//! What a vehicle was seen to do of its itinerary: live, and again from the record, by the same rule.
//!
//! A stop is done when the vehicle was seen at it while it flew to each of its rows, stayed there about as
//! long as planned, and then said that it reached the last of them, or was seen to stay as long before it went on. Where it has to come
//! down it was seen to, and with a load to stay on the ground. What it goes on from
//! without that is missed.

use std::collections::VecDeque;
use std::sync::Arc;

use super::rows::{StopRows, rows_of};
use super::state::{Seen, Served, ServiceState};
use super::stops::{Itinerary, Service, ServiceKind};
use crate::flight::record::fix::Fix;
use crate::flight::record::{Flight, Plan};
use crate::geodesy::LatLon;
use crate::spec::Airframe;

/// So near to a stop a copter is at it, metres; a wing takes its waypoints earlier.
pub(crate) const STOP_M: f64 = 25.0;
pub(crate) const WING_STOP_M: f64 = 150.0;
/// Positions are off by so much, metres.
const ERROR_M: f64 = 3.0;
/// A copter that rests is slower than this, m/s.
const RESTS_MPS: f64 = 1.0;
/// What is missing of a stay may not have been seen, seconds.
const UNSEEN_S: f64 = 1.0;
/// A vehicle that says that it reached a stop begins its stay before it rests: it was seen there for less than planned by
/// this, seconds, and this share.
const BRAKES_S: f64 = 2.0;
const BRAKES_SHARE: f64 = 0.2;
/// The message that an item was reached may come after the next item is current, seconds.
const LATE_S: f64 = 3.0;
/// Share of a descent at a stop on which a vehicle must be seen: the ground is not known to the metre.
const LOWERED: f64 = 0.8;
/// A lesser descent is none, metres.
const DESCENT_M: f64 = 1.0;
/// It stays on the ground to release: this long, seconds, within this height, metres.
const RELEASES_S: f64 = 2.5;
const LOW_M: f64 = 0.5;

/// A mission, by its number of items, and the rows of each stop in it.
#[derive(Clone, Debug)]
struct Mission {
    plan: Plan,
    rows: Vec<Option<Arc<StopRows>>>,
}

/// What is known of one stop.
#[derive(Clone, Debug, Default)]
struct AtStop {
    seen: Seen,
    /// Rows that it was at the stop for.
    rows: Vec<usize>,
    /// When it was last seen at the stop.
    until_s: f64,
    /// How near it came to the stop on its way to a row of it, metres.
    nearest_m: Option<f64>,
    /// Since when it flies to a row behind the stop.
    passed_s: Option<f64>,
    /// The highest and the lowest altitude there, metres AMSL.
    top_m: Option<f64>,
    low_m: Option<f64>,
    /// From when until when it was low.
    low_s: (f64, f64),
}

/// The progress of one vehicle.
#[derive(Clone, Debug)]
pub(crate) struct Progress {
    itinerary: Itinerary,
    sites: Vec<LatLon>,
    has_wing: bool,
    missions: Vec<Mission>,
    /// Index of the mission that it flies.
    mission: usize,
    stops: Vec<AtStop>,
    here: Option<LatLon>,
    news: VecDeque<String>,
}

impl Progress {
    pub(crate) fn new(itinerary: Itinerary, airframe: Airframe) -> Self {
        Self {
            sites: itinerary.sites(),
            stops: vec![AtStop::default(); itinerary.stops.len()],
            itinerary,
            has_wing: airframe.has_wing(),
            missions: Vec::new(),
            mission: 0,
            here: None,
            news: VecDeque::new(),
        }
    }

    /// What a record shows of a vehicle.
    pub(crate) fn recorded(flight: &Flight, airframe: Airframe) -> Self {
        let mut progress = Self::new(flight.itinerary.clone(), airframe);
        for plan in &flight.plans {
            progress.add_mission(plan);
        }
        let mut reached = flight.flown.reached.iter().peekable();
        for fix in &flight.flown.fixes {
            while let Some((row, t_s)) = reached.next_if(|(_, t_s)| *t_s < fix.t_s) {
                progress.take_reached(*row, *t_s);
            }
            progress.take(fix);
        }
        reached.for_each(|(row, t_s)| progress.take_reached(*row, *t_s));
        progress
    }

    /// It may fly another mission from now on: once it says that it holds as many items.
    pub(crate) fn add_mission(&mut self, plan: &Plan) {
        let rows = rows_of(&self.itinerary, &plan.reference).into_iter();
        let rows = rows.map(|rows| rows.map(Arc::new)).collect();
        let plan = plan.clone();
        self.missions.push(Mission { plan, rows });
    }

    /// Index of the mission that it flies.
    #[cfg(test)]
    pub(crate) fn mission(&self) -> usize {
        self.mission
    }

    /// Nothing of what was seen so far is news.
    pub(crate) fn forget_news(&mut self) {
        self.news.clear();
    }

    pub(crate) fn poll_news(&mut self) -> Option<String> {
        self.news.pop_front()
    }

    /// The services and what was seen of each.
    pub(crate) fn served(&self) -> Vec<Served> {
        let seen: Vec<Seen> = self.stops.iter().map(|stop| stop.seen).collect();
        self.itinerary.served(&seen)
    }

    /// How many services are done, and of how many.
    pub(crate) fn done_of(&self) -> (usize, usize) {
        let served = self.served();
        let done = served.iter().filter(|of| of.state == ServiceState::Done);
        (done.count(), served.len())
    }

    /// The nearest stop to a place that a vehicle there is at.
    pub(crate) fn stop_at(&self, place: LatLon) -> Option<&str> {
        let away_m = |at: usize| self.sites[at].chord_m(place);
        let stops = 0..self.sites.len();
        let nearest = stops.min_by(|a, b| away_m(*a).total_cmp(&away_m(*b)))?;
        let is_near = away_m(nearest) < self.near_m();
        is_near.then(|| self.itinerary.stops[nearest].id.as_str())
    }

    /// The stop that a row is of.
    pub(crate) fn stop_of(&self, row: usize) -> Option<&str> {
        let is_of = |rows: &StopRows| (rows.first()..=rows.last()).contains(&row);
        let mut stops = 0..self.sites.len();
        let at = stops.find(|at| self.rows(*at).is_some_and(|rows| is_of(&rows)))?;
        Some(self.itinerary.stops[at].id.as_str())
    }

    fn near_m(&self) -> f64 {
        if self.has_wing { WING_STOP_M } else { STOP_M }
    }

    /// Takes in a position.
    pub(crate) fn take(&mut self, fix: &Fix) {
        let before = self.here.replace(fix.place).unwrap_or(fix.place);
        self.change_mission(fix);
        for at in 0..self.stops.len() {
            let Some(rows) = self.rows(at) else { continue };
            if self.stops[at].seen.done_s.is_some() {
                continue;
            }
            let is_near = self.sites[at].chord_m(fix.place) < self.near_m();
            let passed_s = self.stops[at].passed_s;
            let has_passed = passed_s.is_some_and(|passed_s| fix.t_s - passed_s >= LATE_S);
            if is_near && fix.item >= rows.first() && !has_passed {
                let away_m = from_leg_m(self.sites[at], before, fix.place);
                self.stops[at].come_near(away_m);
            }
            if rows.waypoints.contains(&fix.item) && is_near {
                self.take_at_stop(at, fix);
            } else if fix.item > rows.last() {
                self.take_behind(at, &rows, fix.t_s);
            }
        }
    }

    /// Takes in that an item was said to be reached.
    pub(crate) fn take_reached(&mut self, row: usize, t_s: f64) {
        for at in 0..self.stops.len() {
            let Some(rows) = self.rows(at) else { continue };
            let here = self.here.map(|here| self.sites[at].chord_m(here));
            let is_near = here.is_some_and(|away_m| away_m < self.near_m());
            if !is_near || !rows.waypoints.contains(&row) {
                continue;
            }
            let stop = &mut self.stops[at];
            if stop.seen.done_s.is_some() {
                continue;
            }
            stop.see(row);
            let stayed_s = stop.seen.begun_s.map_or(0.0, |begun_s| t_s - begun_s);
            let stayed = stayed_s >= (1.0 - BRAKES_SHARE) * rows.rest_s - BRAKES_S;
            let is_last = row == rows.last();
            if is_last && stayed && self.is_made(at, &rows) {
                self.finish(at, t_s);
            }
        }
    }

    fn rows(&self, at: usize) -> Option<Arc<StopRows>> {
        let mission = self.missions.get(self.mission)?;
        mission.rows.get(at)?.clone()
    }

    /// As [`Flight::plan_of_each`] has it.
    fn change_mission(&mut self, fix: &Fix) {
        let is = |of: &Mission| of.plan.items == fix.items;
        if fix.items == 0 || self.missions.get(self.mission).is_some_and(is) {
            return;
        }
        let mut later = self.missions.iter().enumerate().skip(self.mission + 1);
        if let Some((number, _)) = later.rfind(|(_, of)| of.plan.may_begin(fix.items, fix.t_s)) {
            let before = std::mem::replace(&mut self.mission, number);
            for (at, stop) in self.stops.iter_mut().enumerate() {
                let [old, new] = [before, number].map(|of| self.missions[of].rows[at].as_ref());
                stop.renumber(old.map(Arc::as_ref), new.map(Arc::as_ref));
            }
        }
    }

    /// It is at a stop and flies to a row of it.
    fn take_at_stop(&mut self, at: usize, fix: &Fix) {
        let rests = self.has_wing || fix.speed_mps < RESTS_MPS;
        let stop = &mut self.stops[at];
        stop.see(fix.item);
        (stop.until_s, stop.passed_s) = (fix.t_s, None);
        stop.see_height(fix);
        stop.seen.is_missed = false;
        if rests && stop.seen.begun_s.is_none() {
            let before = self.served();
            self.stops[at].seen.begun_s = Some(fix.t_s);
            self.report(&before);
        }
    }

    /// It flies to a row behind a stop that it was not seen to do.
    fn take_behind(&mut self, at: usize, rows: &StopRows, t_s: f64) {
        let stop = &mut self.stops[at];
        let passed_s = *stop.passed_s.get_or_insert(t_s);
        let stayed_s = stop.seen.begun_s.map(|begun_s| stop.until_s - begun_s);
        let stayed = stayed_s.is_some_and(|stayed_s| stayed_s >= rows.rest_s - UNSEEN_S);
        let is_missed = stop.seen.is_missed;
        if stayed && self.is_made(at, rows) {
            self.finish(at, passed_s);
        } else if t_s - passed_s >= LATE_S && !is_missed {
            let before = self.served();
            self.stops[at].seen.is_missed = true;
            self.report(&before);
        }
    }

    /// Whether it was at a stop for each of its rows, near enough, and came down where it has to.
    fn is_made(&self, at: usize, rows: &StopRows) -> bool {
        let stop = &self.stops[at];
        self.too_far(at).is_none() && stop.has_been_at(rows) && stop.has_come_down(rows)
    }

    /// How near it came to a stop, and how near it had to, metres, if that was not near enough.
    fn too_far(&self, at: usize) -> Option<(f64, f64)> {
        let far = self.stops[at]
            .nearest_m
            .zip(self.itinerary.stops[at].near_m);
        far.filter(|(nearest_m, near_m)| *nearest_m > near_m + ERROR_M)
    }

    /// Why a service is missed, in words.
    fn why_missed(&self, service: &Service) -> String {
        let own = service.stops.iter();
        let mut missed = own.filter(|at| self.stops[**at].seen.is_missed);
        match missed.find_map(|at| self.too_far(*at)) {
            Some((nearest_m, near_m)) => {
                format!("it came no nearer than {nearest_m:.0} m (at most {near_m:.0} m)")
            }
            None => "it went on without being seen to do it".to_owned(),
        }
    }

    fn finish(&mut self, at: usize, t_s: f64) {
        let before = self.served();
        let seen = &mut self.stops[at].seen;
        seen.begun_s = seen.begun_s.or(Some(t_s));
        (seen.done_s, seen.is_missed) = (Some(t_s), false);
        let services = self.itinerary.services.iter();
        let is_pick_up = |of: &&Service| {
            of.kind == ServiceKind::Delivery && of.stops.len() > 1 && of.stops.first() == Some(&at)
        };
        let picked_up = services.filter(is_pick_up);
        let picked_up = picked_up.map(|of| format!("{} picked up", of.label()));
        self.news.extend(picked_up);
        self.report(&before);
    }

    /// What changed becomes news.
    fn report(&mut self, before: &[Served]) {
        let after = self.served();
        let (done, all) = self.done_of();
        for (index, (old, new)) in before.iter().zip(&after).enumerate() {
            let service = &self.itinerary.services[index];
            let label = service.label();
            let begins = old.from_s.is_none() && new.from_s.is_some();
            if begins && new.kind != ServiceKind::Stop {
                self.news.push_back(format!("{label} begins"));
            }
            match new.state {
                state if state == old.state => {}
                ServiceState::Done => {
                    self.news
                        .push_back(format!("{label} done ({done} of {all})"));
                }
                ServiceState::Missed => {
                    let why = self.why_missed(service);
                    self.news.push_back(format!("{label} missed: {why}"));
                }
                ServiceState::Left => {}
            }
        }
    }
}

/// How far a place is from the straight way between two others, metres.
fn from_leg_m(place: LatLon, from: LatLon, to: LatLon) -> f64 {
    let [a_m, b_m, leg_m] = [place.chord_m(from), place.chord_m(to), from.chord_m(to)];
    let along_m = (a_m * a_m - b_m * b_m + leg_m * leg_m) / (2.0 * leg_m);
    // Of two at one place that is no number.
    match (0.0..=leg_m).contains(&along_m) {
        true => (a_m * a_m - along_m * along_m).max(0.0).sqrt(),
        false => a_m.min(b_m),
    }
}

impl AtStop {
    fn come_near(&mut self, away_m: f64) {
        let nearest_m = self
            .nearest_m
            .map_or(away_m, |nearest_m| nearest_m.min(away_m));
        self.nearest_m = Some(nearest_m);
    }

    fn see(&mut self, row: usize) {
        if !self.rows.contains(&row) {
            self.rows.push(row);
        }
    }

    /// The rows of the stop in another mission, which may begin in its midst, take the place of those in
    /// the one before.
    fn renumber(&mut self, old: Option<&StopRows>, new: Option<&StopRows>) {
        let (old, new) = (old.into_iter(), new.into_iter());
        let old = old.flat_map(|rows| rows.waypoints.iter().rev());
        let new = new.flat_map(|rows| rows.waypoints.iter().rev());
        let seen = old.zip(new).filter(|(old, _)| self.rows.contains(old));
        self.rows = seen.map(|(_, new)| *new).collect();
        self.passed_s = None;
    }

    fn see_height(&mut self, fix: &Fix) {
        let amsl_m = fix.amsl.0;
        self.top_m = Some(self.top_m.map_or(amsl_m, |top_m| top_m.max(amsl_m)));
        match self.low_m {
            Some(low_m) if amsl_m > low_m + LOW_M => {}
            Some(low_m) if amsl_m > low_m - LOW_M => self.low_s.1 = fix.t_s,
            _ => (self.low_m, self.low_s) = (Some(amsl_m), (fix.t_s, fix.t_s)),
        }
    }

    fn has_been_at(&self, rows: &StopRows) -> bool {
        rows.waypoints.iter().all(|row| self.rows.contains(row))
    }

    /// Whether it came down where it has to, and stayed on the ground to release a load, if there is one.
    fn has_come_down(&self, rows: &StopRows) -> bool {
        if rows.descent_m < DESCENT_M {
            return true;
        }
        let (Some(top_m), Some(low_m)) = (self.top_m, self.low_m) else {
            return false;
        };
        let released = self.low_s.1 - self.low_s.0 >= RELEASES_S;
        top_m - low_m >= LOWERED * rows.descent_m && (released || !rows.puts_down)
    }
}
