//! Why a task is not done.

use super::estimate::MIN_ROUTE_M;
use super::{Assigner, BUDGET, PER_SECOND, TaskLeft, float};
use crate::spec::MAX_STOPS;
use crate::tasks::assignment::{Assignment, Spent};

impl Assigner<'_> {
    /// The tasks that are not done, or not wholly, and why.
    pub(super) fn left(&self, assignment: &Assignment<'_>, units: &[usize]) -> Vec<TaskLeft> {
        let groups = units.chunk_by(|one, other| self.units[*one].task == self.units[*other].task);
        let mut left: Vec<(usize, TaskLeft)> = Vec::new();
        for group in groups {
            let (first, task) = (group[0], self.units[group[0]].task);
            let why = self.why(assignment, first);
            let lines = self.layouts[task].as_ref().map(|layout| layout.lines.len());
            let numbers: Vec<String> = group
                .iter()
                .filter_map(|&unit| Some((self.units[unit].line? + 1).to_string()))
                .collect();
            let why = match lines {
                Some(lines) => format!(
                    "{} of {lines} lines ({}): {why}",
                    numbers.len(),
                    numbers.join(", ")
                ),
                None => why,
            };
            let id = self.spec.tasks[task].id.clone();
            left.push((task, TaskLeft { id, why }));
        }
        left.sort_by_key(|(task, _)| *task);
        left.into_iter().map(|(_, left)| left).collect()
    }

    /// Why a unit found no vehicle.
    fn why(&self, assignment: &Assignment<'_>, unit: usize) -> String {
        let task = self.units[unit].task;
        let fleet = self.spec.vehicles.iter().enumerate();
        let alone = fleet.filter_map(|(vehicle, own)| {
            let spent: Spent = assignment.alone(vehicle, unit)?;
            Some((float(spent.uses) + self.overhead(vehicle), own))
        });
        let Some((uses, vehicle)) = alone.min_by(|a, b| a.0.total_cmp(&b.0)) else {
            return match (self.short_window(assignment, unit), self.has_window(task)) {
                (Some(why), _) => why,
                (None, has_window) => self.why_none(assignment, unit, has_window),
            };
        };
        match &vehicle.endurance {
            Some(endurance) if uses > BUDGET => format!(
                "out of reach: with it alone {} uses about {:.0} of {:.0} {}",
                vehicle.id,
                uses / BUDGET * endurance.usable(),
                endurance.usable(),
                endurance.capacity.unit()
            ),
            _ => {
                let time = match self.has_window(task) {
                    true => "the time in its window, and ",
                    false => "",
                };
                let near = self.near(unit).map_or_else(String::new, |id| {
                    format!(", or it would fly there straight from task {id}, less than {MIN_ROUTE_M} m from it: give one task the `actions` of both")
                });
                format!(
                    "no vehicle has {time}enough endurance and stops (at most {MAX_STOPS}) left for it{near}"
                )
            }
        }
    }

    /// A task with a place that no leg leads to from one of the unit: they are too near each other.
    fn near(&self, unit: usize) -> Option<&str> {
        let own = &self.units[unit];
        let is_near = |site: &usize| {
            let mut sites = own.sites.iter();
            sites.any(|of| self.points[*of].at.distance_m(self.points[*site].at) < MIN_ROUTE_M)
        };
        let mut others = self.units.iter().filter(|other| other.task != own.task);
        let other = others.find(|other| other.sites.iter().any(is_near))?;
        Some(&self.spec.tasks[other.task].id)
    }

    /// Why a unit is for no vehicle even alone: each cause has a sentence of its own.
    fn why_none(&self, assignment: &Assignment<'_>, unit: usize, has_window: bool) -> String {
        let task = self.units[unit].task;
        let fleet = self.spec.vehicles.iter().enumerate();
        let able: Vec<usize> = fleet
            .filter(|(_, own)| self.spec.tasks[task].is_for(own))
            .map(|(vehicle, _)| vehicle)
            .collect();
        if able.is_empty() {
            return "no vehicle is a copter that runs its actions".to_owned();
        }
        let mut in_layer = able
            .into_iter()
            .filter(|&vehicle| self.is_in_layer(vehicle, task))
            .peekable();
        if in_layer.peek().is_none() {
            return "no vehicle that runs its actions may fly at its height".to_owned();
        }
        let reaches = in_layer.any(|vehicle| assignment.has_ways(vehicle, unit));
        let closed = self.closed_zone(unit).filter(|_| reaches);
        match (reaches, has_window) {
            (false, _) => "its place is within 10 m of the start or the goal of each vehicle that may do it: give these `actions` instead".to_owned(),
            _ if closed.is_some() => closed.unwrap_or_default(),
            (true, true) => "no vehicle that may do it is there in its window".to_owned(),
            (true, false) => "its places are within 10 m of each other, or of stops of each vehicle that may do it".to_owned(),
        }
    }

    /// What is said where even the vehicle whose arrival is known best may miss a window for its
    /// length alone.
    fn short_window(&self, assignment: &Assignment<'_>, unit: usize) -> Option<String> {
        let fleet = self.spec.vehicles.iter().enumerate();
        let short = fleet.filter_map(|(vehicle, own)| {
            let (position, spread) = assignment.short_window(vehicle, unit)?;
            Some((spread, position, own))
        });
        let (spread, position, vehicle) = short.min_by_key(|(spread, ..)| *spread)?;
        let stop = &self.spec.tasks[self.units[unit].task].stops[position];
        let window = stop.window_s?;
        let spread_s = float(spread) / PER_SECOND;
        Some(format!(
            "its window of {:.1} s is shorter than the lateness of {spread_s:.1} s that {} may have there",
            window.most - window.least,
            vehicle.id
        ))
    }

    /// What is said of a unit in a zone with times.
    fn closed_zone(&self, unit: usize) -> Option<String> {
        let (id, (from_s, to_s)) = self.timed_zone_at(&self.units[unit].sites)?;
        Some(format!(
            "zone {id} is closed from T0 {from_s:+.0} s to T0 {to_s:+.0} s, and no vehicle is there before or after that; `depart_window_s` lets one wait on the ground"
        ))
    }

    fn has_window(&self, task: usize) -> bool {
        let mut stops = self.spec.tasks[task].stops.iter();
        stops.any(|stop| stop.window_s.is_some())
    }
}
