//! The tasks of the fleet: each alone, and whether any vehicle may do it.

mod areas;

use super::Checker;
use crate::numeric::digits;
use crate::spec::check::map::Map;
use crate::spec::keys;
use crate::spec::{AltitudeLimits, Arrival, MAX_TASKS, Span, Stop, Task, Vehicle};

const KINDS: &str = "exactly one of visit, deliver, survey, corridor, search";

impl Checker {
    /// The tasks, as far as each is whole.
    pub(in crate::spec::check) fn tasks(
        &mut self,
        keys: &keys::Spec,
        map: Option<&Map>,
        fleet: &[Vehicle],
    ) -> Vec<Task> {
        if keys.tasks.is_empty() {
            return Vec::new();
        }
        if keys.sortie < 2 {
            self.report("tasks", "tasks, in version 1", "sortie: 2");
        }
        if keys.tasks.len() > MAX_TASKS {
            let found = format!("{} tasks", keys.tasks.len());
            self.report("tasks", found, format!("at most {MAX_TASKS}"));
        }
        let is_copter = |one: &keys::Vehicle| !one.airframe.unwrap_or_default().has_wing();
        if !keys.vehicles.is_empty() && !keys.vehicles.iter().any(is_copter) {
            let found = "tasks, on wings: planes and VTOL fly from start to goal";
            self.report("tasks", found, "at least one copter, or no tasks");
        }
        self.unique("tasks", keys.tasks.iter().map(|task| task.id.as_deref()));
        let mut tasks = Vec::new();
        for (index, task) in keys.tasks.iter().enumerate() {
            let path = format!("tasks[{index}]");
            if let Some(task) = self.task(&path, task, map) {
                self.has_vehicle(&path, &task, fleet);
                self.holds_together(&path, &task, (&tasks, fleet));
                tasks.push(task);
            }
        }
        tasks
    }

    fn task(&mut self, path: &str, keys: &keys::Task, map: Option<&Map>) -> Option<Task> {
        let id = self.required(path, "id", keys.id.clone());
        if let Some(id) = &id {
            self.label(&format!("{path}.id"), id);
        }
        let name = id.clone().unwrap_or_default();
        let kinds = [
            keys.visit.is_some(),
            keys.deliver.is_some(),
            keys.survey.is_some(),
            keys.corridor.is_some(),
            keys.search.is_some(),
        ];
        if kinds.into_iter().filter(|is_given| *is_given).count() != 1 {
            let found = match kinds.contains(&true) {
                true => "two kinds of task",
                false => "no kind of task",
            };
            self.report(path, found, KINDS);
            return None;
        }
        let at = |key: &str| format!("{path}.{key}");
        let mut sweep = None;
        let mut stops = Vec::new();
        if let Some(visit) = &keys.visit {
            stops.push(self.task_stop(&at("visit"), (name, visit), map));
        } else if let Some(deliver) = &keys.deliver {
            stops.extend(self.delivery(&at("deliver"), (&name, deliver), map));
        } else if let Some(survey) = &keys.survey {
            sweep = Some(self.survey(&at("survey"), survey, map)?);
        } else if let Some(corridor) = &keys.corridor {
            sweep = Some(self.corridor(&at("corridor"), corridor, map)?);
        } else if let Some(search) = &keys.search {
            sweep = Some(self.search(&at("search"), search, map)?);
        }
        let stops = stops.into_iter().collect::<Option<Vec<Stop>>>()?;
        Some(Task {
            id: id?,
            stops,
            sweep,
        })
    }

    /// Where a load is picked up and where it is dropped.
    fn delivery(
        &mut self,
        path: &str,
        (name, deliver): (&str, &keys::Deliver),
        map: Option<&Map>,
    ) -> [Option<Stop>; 2] {
        let ends = [("from", &deliver.from), ("to", &deliver.to)];
        let stops = ends.map(|(key, place)| {
            let place = self.required(path, key, place.as_ref())?;
            let named = (format!("{name}.{key}"), place);
            self.task_stop(&format!("{path}.{key}"), named, map)
        });
        self.carried(path, &stops);
        let window = self.task_window(&format!("{path}.window_s"), deliver.window_s);
        self.one_window(path, deliver);
        let [from, to] = stops;
        let to = to.map(|to| Stop {
            window_s: window.or(to.window_s),
            ..to
        });
        [from, to]
    }

    /// A window of the right way round.
    fn task_window(&mut self, path: &str, keys: Option<keys::TaskWindow>) -> Option<Span> {
        let keys::TaskWindow { from, to } = keys?;
        if to < from {
            let found = format!("from {from} to {to}");
            self.report(path, found, "to not before from");
        }
        Some(Span {
            least: from,
            most: to,
        })
    }

    /// The window of a delivery is that of its drop.
    fn one_window(&mut self, path: &str, deliver: &keys::Deliver) {
        let to = deliver.to.as_ref().and_then(|place| place.window_s);
        if to.is_some() && deliver.window_s.is_some() {
            let allowed = "one of them: both are that of the drop";
            self.report(&format!("{path}.window_s"), "two windows", allowed);
        }
    }

    /// There must be a path to plan from where a load is picked up to where it is dropped.
    fn carried(&mut self, path: &str, stops: &[Option<Stop>; 2]) {
        let [Some(from), Some(to)] = stops else {
            return;
        };
        let min_m = super::MIN_START_TO_GOAL_M;
        let apart_m = from.end.place.chord_m(to.end.place);
        if apart_m < min_m {
            let apart = crate::numeric::digits::distinct_from(apart_m, min_m, 1);
            let found = format!("{apart} m from `from`");
            let allowed = format!("at least {min_m} m from `from`");
            self.report(&format!("{path}.to"), found, allowed);
        }
    }

    fn task_stop(
        &mut self,
        path: &str,
        (id, keys): (String, &keys::TaskPlace),
        map: Option<&Map>,
    ) -> Option<Stop> {
        let (lat, lon, agl_m, amsl_m) = (keys.lat, keys.lon, keys.agl_m, keys.amsl_m);
        let point = keys::EndPoint {
            lat,
            lon,
            agl_m,
            amsl_m,
        };
        let end = self.end_point(path, point);
        let (end, drop_m) = self.over_drop(path, end, map);
        if let (Some(map), Some(end)) = (map, end) {
            self.clear(path, "task", end.place, map);
            // Some vehicle may have wider limits than the others; the area has them all.
            let altitudes = AltitudeLimits::default();
            self.known_point((path, "task"), Some(end), altitudes, false);
        }
        let actions = self.actions(path, (&keys.actions, point), None);
        Some(Stop {
            id,
            end: end?,
            drop_m,
            hold_s: keys.hold_s.unwrap_or(0.0),
            acceptance_radius_m: None,
            heading_rad: None,
            actions,
            speed_mps: None,
            window_s: self.task_window(&format!("{path}.window_s"), keys.window_s),
            wait_s: 0.0,
            arrives: Arrival::Planned,
            trigger_m: None,
        })
    }

    /// What one vehicle does at one place is one rest, whose hold an item has to store; several
    /// vehicles may share it.
    fn holds_together(&mut self, path: &str, task: &Task, (before, fleet): (&[Task], &[Vehicle])) {
        let able = fleet.iter().filter(|own| task.is_for(own));
        let max_s = able.map(|own| f64::from(own.facts().acceptance.max_hold_s));
        let max_s: f64 = max_s.sum();
        for (index, stop) in task.stops.iter().enumerate() {
            let is_there = |other: &&Stop| (other.end, other.drop_m) == (stop.end, stop.drop_m);
            let others = before.iter().flat_map(|task| &task.stops).filter(is_there);
            let others_s: f64 = others.map(|other| other.hold_s).sum();
            let sum_s = others_s + stop.hold_s;
            // Said once, where the sum becomes too large.
            if others_s <= max_s && sum_s > max_s {
                let key = match (task.stops.len(), index) {
                    (1, _) => "visit",
                    (_, 0) => "deliver.from",
                    _ => "deliver.to",
                };
                let found = format!("{sum_s} s with the tasks before it at this place");
                let allowed = format!("at most {max_s} s at one place");
                self.report(&format!("{path}.{key}.hold_s"), found, allowed);
            }
        }
    }

    /// The autopilot of one copter at least must run the actions of a task.
    fn has_vehicle(&mut self, path: &str, task: &Task, fleet: &[Vehicle]) {
        let copters = fleet.iter().filter(|one| !one.airframe.has_wing());
        let mut autopilots: Vec<&str> = copters.map(|one| one.autopilot.name()).collect();
        autopilots.sort_unstable();
        autopilots.dedup();
        if autopilots.is_empty() || fleet.iter().any(|vehicle| task.is_for(vehicle)) {
            return;
        }
        let with_distance = fleet.iter().find_map(|one| one.on_way.trigger_m);
        if let (Some(trigger_m), true) = (with_distance, task.takes_pictures()) {
            let key = task.sweep.as_ref().map_or("", |sweep| sweep.shape.key());
            let found = format!(
                "pictures of its own, and every copter takes them along its way (camera, {} m)",
                digits::plain(trigger_m)
            );
            let allowed = "one copter at least without camera";
            self.report(&format!("{path}.{key}.camera"), found, allowed);
        } else {
            let found = format!("actions that {} refuses", autopilots.join(" and "));
            self.report(path, found, "actions that one copter runs");
        }
    }
}
