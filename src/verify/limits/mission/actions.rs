//! What is done at a stop: the heading and the actions, in their order, where they are run.

use std::collections::BTreeSet;

use super::MissionCheck;
use crate::autopilot::{Autopilot, command_name};
use crate::geodesy::{Amsl, PlanPoint};
use crate::mission::{self, Item, command};
use crate::spec::{ACTION_S, EndPoint, MissionSpec, Placement, Stop, StopAction};
use crate::verify::execute::flight::Rest;
use crate::verify::execute::item::{self, Height};
use crate::verify::{Limit, Margin, Requirement};

/// A heading may differ from the planned one by this, degrees.
const HEADING_DEG: f64 = 1.0;
/// A region of interest may be this far from the planned one, metres: encoding moves it less.
const ROI_M: f64 = 1.0;
/// Places nearer than this are one, metres.
const SAME_M: f64 = 0.5;
/// A turn of the nose by 180 degrees, seconds.
const TURN_S: f64 = 4.0;

/// Items that hold a vehicle where it is, and drop what has not run when they end.
const HOLDS: [u16; 3] = [
    command::NAV_WAYPOINT,
    command::NAV_LOITER_TIME,
    command::NAV_PAYLOAD_PLACE,
];
/// Functions of `DO_AUX_FUNCTION` that move what a load may hang on: gripper, winch, relays.
const LOAD_FUNCTIONS: [f32; 7] = [19.0, 28.0, 34.0, 35.0, 36.0, 66.0, 67.0];

/// How long an item may turn the nose, seconds: half around, with its own rate in degrees a second.
fn turn_s(item: &Item) -> Option<f64> {
    let rate = f64::from(item.params[1]);
    let own_s = if rate > 0.0 { 180.0 / rate } else { 0.0 };
    (item.command == command::CONDITION_YAW).then_some(TURN_S.max(own_s))
}

/// The hold of the first item from an index on that has one, seconds. A load is placed for longer than actions take.
fn hold_after_s(items: &[Item], index: usize) -> Option<f64> {
    let after = items[index..]
        .iter()
        .find(|item| HOLDS.contains(&item.command))?;
    Some(match after.command {
        command::NAV_PAYLOAD_PLACE => f64::INFINITY,
        _ => f64::from(after.params[0]),
    })
}

/// Whether an item moves a load by a function of a switch.
fn switches_load(item: &Item) -> bool {
    item.command == command::DO_AUX_FUNCTION
        && LOAD_FUNCTIONS
            .iter()
            .any(|function| function.to_bits() == item.params[0].to_bits())
}

/// The commands of a spec that move loads, by whichever vehicle.
pub(super) fn load_commands(spec: &MissionSpec) -> BTreeSet<u16> {
    let own = spec.vehicles.iter().flat_map(|vehicle| {
        let ends = vehicle.on_way.start.iter().chain(&vehicle.on_way.goal);
        ends.chain(vehicle.stops.iter().flat_map(|stop| &stop.actions))
    });
    let of_tasks = spec.tasks.iter().flat_map(|task| &task.stops);
    own.chain(of_tasks.flat_map(|stop| &stop.actions))
        .filter(|action| action.moves_load())
        .map(StopAction::command)
        .collect()
}

impl MissionCheck<'_> {
    /// Whether items move a load where none of the stops that the vehicle makes asks for it: its own,
    /// and those of its tasks. One that begins in the air may have part of a stop behind it.
    pub(super) fn stray(&self, commands: &BTreeSet<u16>, of_tasks: &[&Stop]) -> Option<Margin> {
        if commands.is_empty() || self.sites.departure.is_airborne() {
            return None;
        }
        let own: Vec<Stop> = self.with_ends().into_iter().map(|(stop, _)| stop).collect();
        let stops = own.iter().chain(of_tasks.iter().copied());
        let asked: Vec<(&StopAction, &Stop)> = stops
            .flat_map(|stop| stop.actions.iter().map(move |action| (action, stop)))
            .collect();
        let mut left = asked.clone();
        let mut stray = Vec::new();
        for item in &self.mission.items {
            if !commands.contains(&item.command) && !switches_load(item) {
                continue;
            }
            let does = |of: &(&StopAction, &Stop)| self.does(item, of.0, of.1);
            match left.iter().position(does) {
                Some(index) => drop(left.swap_remove(index)),
                None => stray.push(item.command),
            }
        }
        let required = Requirement::at_most(Limit::StrayActions, 0.0, "items");
        let count = u32::try_from(stray.len()).unwrap_or(u32::MAX);
        let mut margin = required.margin(self.id(), f64::from(count), None);
        if let Some(&first) = stray.first() {
            let items = self.mission.items.iter().zip(1..);
            let rows = items.filter(|(item, _)| item.command == first);
            let rows: Vec<String> = rows.map(|(_, row): (_, usize)| row.to_string()).collect();
            let named = asked.iter().filter(|of| of.0.command() == first).count();
            margin.note = format!(
                "{} at item {}, its stops ask for {named}",
                command_name(first).unwrap_or("a command"),
                rows.join(", ")
            );
        }
        Some(margin)
    }

    /// Whether the items of a stop turn the nose and do what the spec says.
    pub(super) fn done(&self, stop: &Stop, rest: &Rest) -> Option<Margin> {
        if stop.heading_rad.is_none() && stop.actions.is_empty() {
            return None;
        }
        let (first, last) = rest.rows;
        let items = self.mission.items.get(first - 1..last).unwrap_or_default();
        let mut missing: Vec<String> = Vec::new();
        if let Some(heading_rad) = stop.heading_rad {
            let heading_deg = heading_rad.to_degrees();
            missing.extend(self.not_turned(heading_deg, rest, items));
        }
        missing.extend(self.not_done(stop, rest, items));
        let required = Requirement::at_most(Limit::StopActions(stop.id.clone()), 0.0, "missing");
        let count = u32::try_from(missing.len()).unwrap_or(u32::MAX);
        let at = self.moment(rest.point, rest.from_s, first);
        let mut margin = required.margin(self.id(), f64::from(count), Some(at));
        margin.note = missing.join("; ");
        Some(margin)
    }

    /// Whether pictures are taken at their distance on every leg from start to goal, and no longer.
    pub(crate) fn camera(&self) -> Option<Margin> {
        let trigger_m = self.vehicle.on_way.trigger_m?;
        let (from, to) = self.rows_of_way();
        let (mut set_m, mut wrong) = (0.0, Vec::new());
        for (index, item) in self.mission.items.iter().enumerate() {
            let row = index + 1;
            let misses = |expected_m: f64| (set_m - expected_m).abs() > 1e-3;
            match item.command {
                command::DO_SET_CAM_TRIGG_DIST => {
                    set_m = f64::from(item.params[0]);
                    let holds_up = self.held_up_by(index).map(|of| self.holds_up(of));
                    wrong.extend(holds_up.map(|why| format!("item {row}: {why}")));
                }
                command if command > command::NAV_LAST => {}
                _ if row > to && misses(0.0) => {
                    wrong.push(format!("pictures on the way to item {row}"));
                }
                _ if row > from && row <= to && misses(trigger_m) => {
                    wrong.push(format!(
                        "pictures every {} m on the way to item {row}, not every {trigger_m} m",
                        (set_m * 1e3).round() / 1e3
                    ));
                }
                _ => {}
            }
        }
        let required = Requirement::at_most(Limit::CameraTrigger, 0.0, "legs");
        let count = u32::try_from(wrong.len()).unwrap_or(u32::MAX);
        let mut margin = required.margin(self.id(), f64::from(count), None);
        margin.note = wrong.into_iter().next().unwrap_or_default();
        Some(margin)
    }

    /// The row after which the vehicle leaves the start, and that which ends what it does at the goal.
    fn rows_of_way(&self) -> (usize, usize) {
        // The way of a wing ends at the last waypoint before its circle or its landing.
        let ends = [
            command::NAV_LOITER_UNLIM,
            command::NAV_LAND,
            command::NAV_VTOL_LAND,
        ];
        let is_on_way = |row: usize| {
            let item = row
                .checked_sub(1)
                .and_then(|index| self.mission.items.get(index));
            self.vehicle.wing.is_none() || item.is_none_or(|item| !ends.contains(&item.command))
        };
        let marks = self.flight.route.iter().filter(|mark| is_on_way(mark.row));
        let marks = marks.map(|mark| (mark.row, mark.point));
        let rests = self.flight.rests.iter();
        let rests = rests.map(|rest| (rest.rows.1, rest.point));
        let mut passed: Vec<(usize, PlanPoint)> = marks.chain(rests).collect();
        passed.sort_by_key(|(row, _)| *row);
        let near = |site: PlanPoint| -> Vec<bool> {
            let away = |of: &(usize, PlanPoint)| of.1.distance_m(site);
            let within_m = passed.iter().map(away).fold(f64::INFINITY, f64::min) + SAME_M;
            passed.iter().map(|of| away(of) <= within_m).collect()
        };
        let (at_start, at_goal) = (near(self.sites.start), near(self.sites.goal));
        let begin = at_start.iter().position(|is_there| *is_there).unwrap_or(0);
        let stays = at_start[begin.min(at_start.len())..].iter();
        let stays = stays.take_while(|is_there| **is_there).count();
        let row = |index: Option<usize>| index.and_then(|at| passed.get(at)).map_or(0, |of| of.0);
        let left = (begin + stays).checked_sub(1);
        (
            row(left),
            row(at_goal.iter().rposition(|is_there| *is_there)),
        )
    }

    fn turns_nose(&self, item: &Item, heading_deg: f64) -> bool {
        let is_heading = |deg: f32| {
            let off_deg = (f64::from(deg) - heading_deg).rem_euclid(360.0);
            off_deg.min(360.0 - off_deg) <= HEADING_DEG
        };
        match self.mission.autopilot {
            Autopilot::ArduPilot => {
                let [deg, _, _, relative] = item.params;
                item.command == command::CONDITION_YAW && relative == 0.0 && is_heading(deg)
            }
            Autopilot::Px4 => item.command == command::NAV_WAYPOINT && is_heading(item.params[3]),
        }
    }

    /// Why a vehicle does not turn its nose to a heading in a rest.
    fn not_turned(&self, heading_deg: f64, rest: &Rest, items: &[Item]) -> Option<String> {
        let turns = |item: &Item| self.turns_nose(item, heading_deg);
        let Some(offset) = items.iter().position(turns) else {
            return Some(format!("no item turns it to {heading_deg:.0} degrees"));
        };
        let goal = format!("the turn to {heading_deg:.0} degrees");
        if let Some(index) = self.held_up_by(rest.rows.0 - 1 + offset) {
            return Some(format!("{goal}: {}", self.holds_up(index)));
        }
        let turn_s = turn_s(&items[offset]).filter(|_| items[offset].params[1] > 0.0)?;
        let is_short = hold_after_s(items, offset).is_none_or(|hold_s| hold_s < turn_s);
        is_short
            .then(|| format!("{goal} takes up to {turn_s:.0} s, and the hold after it ends before"))
    }

    /// Whether every action of a stop is done in a rest.
    pub(super) fn does_all(&self, stop: &Stop, rest: &Rest) -> bool {
        let (first, last) = rest.rows;
        let items = self.mission.items.get(first - 1..last).unwrap_or_default();
        self.not_done(stop, rest, items).is_empty()
    }

    /// The actions without an item that does them, in their order, and those that would be dropped.
    fn not_done(&self, stop: &Stop, stay: &Rest, items: &[Item]) -> Vec<String> {
        let mut missing = Vec::new();
        let mut next = 0;
        for (index, action) in stop.actions.iter().enumerate() {
            let name = || format!("action {} ({})", index + 1, action.key());
            let rest = items.get(next..).unwrap_or_default();
            match rest.iter().position(|item| self.does(item, action, stop)) {
                Some(offset) => {
                    next += offset + 1;
                    let is_steered = !matches!(action, StopAction::Gimbal { .. })
                        || self.steers_gimbal(&items[..next]);
                    if !is_steered {
                        missing.push(format!("{}: no item takes control of it", name()));
                    } else if let Some(index) = self.held_up_by(stay.rows.0 + next - 2) {
                        missing.push(format!("{}: {}", name(), self.holds_up(index)));
                    } else if !self.is_run(stay, items, next - 1) {
                        let why = match stay.until_s > stay.from_s {
                            true => "the hold after it ends before it",
                            false => "the next waypoint is reached before it",
                        };
                        missing.push(format!("{}: {why}", name()));
                    }
                }
                None => missing.push(format!(
                    "{}: {}",
                    name(),
                    self.done_elsewhere(stop, stay, action)
                )),
            }
        }
        missing
    }

    /// Why none of the items of a rest does an action: an item does it elsewhere, if there is one for each stop that asks
    /// for it.
    fn done_elsewhere(&self, stop: &Stop, stay: &Rest, action: &StopAction) -> String {
        let (first, last) = stay.rows;
        let rows = self.mission.items.iter().zip(1_usize..);
        let does: Vec<usize> = rows
            .filter(|(item, _)| self.does(item, action, stop))
            .map(|(_, row)| row)
            .collect();
        let own = self.with_ends();
        let of_tasks = self.spec.tasks.iter().flat_map(|task| &task.stops);
        let stops = own.iter().map(|(stop, _)| stop).chain(of_tasks);
        let asked = stops.flat_map(|stop| &stop.actions);
        let asked = asked.filter(|other| *other == action).count();
        let off = |row: &usize| row.abs_diff((*row).clamp(first, last));
        match does.iter().min_by_key(|row| off(row)) {
            Some(row) if does.len() >= asked => format!(
                "item {row} does it, and the vehicle is nearest to the stop at items {first} to {last}"
            ),
            _ => "no item does it".to_owned(),
        }
    }

    /// PX4 turns a gimbal only for whom controls it.
    fn steers_gimbal(&self, items: &[Item]) -> bool {
        let configures = |item: &Item| item.command == command::DO_GIMBAL_MANAGER_CONFIGURE;
        self.mission.autopilot != Autopilot::Px4 || items.iter().any(configures)
    }

    /// ArduPilot runs commands while it is on its way to the waypoint after them or holds there, and
    /// drops those that have not run when it goes on from there. At a stop of a copter the hold counts.
    fn is_run(&self, stay: &Rest, items: &[Item], index: usize) -> bool {
        let puts_down = |item: &Item| item.command == command::NAV_PAYLOAD_PLACE;
        if self.mission.autopilot != Autopilot::ArduPilot || puts_down(&items[index]) {
            return true;
        }
        let is_waypoint = |item: &&Item| HOLDS.contains(&item.command);
        let before = items[..index].iter().rev();
        let mut needed_s = ACTION_S;
        for item in before.take_while(|item| !is_waypoint(item)) {
            needed_s += turn_s(item).unwrap_or(ACTION_S);
        }
        if stay.until_s <= stay.from_s {
            return self.until_next_s(stay) >= needed_s;
        }
        hold_after_s(items, index).is_some_and(|hold_s| hold_s >= needed_s)
    }

    /// Where in the mission the actions of a stop are run in a rest, but for items that other stops have: indices, in
    /// their order.
    pub(super) fn acts(&self, stop: &Stop, rest: &Rest, taken: &[usize]) -> Vec<usize> {
        let (first, last) = rest.rows;
        let mut found: Vec<usize> = Vec::new();
        for action in &stop.actions {
            let from = found.last().map_or(first - 1, |index| index + 1);
            let items = self.mission.items.iter().enumerate();
            let items = items.take(last).skip(from);
            let mut free = items.filter(|(index, _)| !taken.contains(index));
            found.extend(
                free.find(|(_, item)| self.does(item, action, stop))
                    .map(|of| of.0),
            );
        }
        found
    }

    /// How long a wing flies past a stop until its autopilot turns to the leg after the next
    /// waypoint: as early as its turn radius before that, seconds.
    fn until_next_s(&self, pass: &Rest) -> f64 {
        let mut segments = self.flight.segments.iter();
        let last = segments.rfind(|segment| segment.flown && segment.row == pass.rows.1);
        let early_s = mission::turn_radius_m(self.vehicle) / self.vehicle.speed_mps;
        last.map_or(0.0, |segment| segment.to_s - pass.from_s - early_s)
    }

    /// Whether an item does an action as the autopilot reads it.
    fn does(&self, item: &Item, action: &StopAction, stop: &Stop) -> bool {
        let has = |expected: &[f64]| {
            let pairs = item.params.iter().zip(expected);
            pairs
                .into_iter()
                .all(|(param, expected)| (f64::from(*param) - expected).abs() < 1e-3)
        };
        let is_done = match *action {
            StopAction::Photo => has(&[0.0, 0.0, 1.0]),
            StopAction::Video { .. } | StopAction::RoiNone => true,
            StopAction::Gimbal { pitch_deg, yaw_deg } => {
                has(&[f64::from(pitch_deg), f64::from(yaw_deg)]) && item.x == 0
            }
            StopAction::Servo { channel, pwm_us } => has(&[f64::from(channel), f64::from(pwm_us)]),
            StopAction::Relay { number, closed } => {
                has(&[f64::from(number), f64::from(u8::from(closed))])
            }
            StopAction::Gripper { grabs } => has(&[1.0, f64::from(u8::from(grabs))]),
            StopAction::Winch { length_m, rate_mps } => has(&[1.0, 1.0, length_m, rate_mps]),
            StopAction::Roi(end) => self.is_at(item, end),
            StopAction::PayloadPlace { max_descent_m } => {
                has(&[max_descent_m.unwrap_or(0.0)]) && self.is_at(item, stop.place())
            }
        };
        item.command == action.command() && is_done
    }

    /// Whether an item has this place and altitude.
    fn is_at(&self, item: &Item, end: EndPoint) -> bool {
        let (Some(place), Ok(ground)) = (item.place(), self.world.terrain.height(end.place)) else {
            return false;
        };
        let home = Amsl(f64::from(self.mission.home.amsl_m));
        let amsl_m = match item::height(item, self.mission.autopilot, home) {
            Ok(Height::Sea(amsl)) => amsl.0,
            Ok(Height::Ground(agl)) => agl.over(ground).0,
            _ => return false,
        };
        let expected_m = match end.altitude {
            Placement::Amsl(amsl) => amsl.0,
            Placement::Agl(agl) => agl.over(ground).0,
        };
        place.chord_m(end.place) <= ROI_M && (amsl_m - expected_m).abs() <= ROI_M
    }
}
