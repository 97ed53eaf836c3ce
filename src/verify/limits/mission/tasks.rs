//! Tasks: one vehicle visits the places of each in order, for its time, and does there what the
//! spec wants. Any vehicle may do a task; several may be done in one rest.

use std::collections::BTreeMap;

use super::MissionCheck;
use super::actions::load_commands;
use super::stops::REST_S;
use crate::mission::{self, Item, command};
use crate::path::takeoff_lateness_s;
use crate::spec::{MissionSpec, Span, Stop, Task};
use crate::verify::execute::flight::Rest;
use crate::verify::execute::item;
use crate::verify::{Limit, Margin, Requirement};
use crate::world::World;

/// Most steps of the search for the rests of all tasks.
const MAX_STEPS: usize = 20_000;

/// Where a task may be done: the vehicle, and for each of its places one of the rests.
#[derive(Clone)]
struct Claim {
    contract: usize,
    rests: Vec<usize>,
}

/// The margins of all tasks, and of what moves loads but for none of them.
pub(crate) fn margins(
    spec: &MissionSpec,
    world: &World,
    contracts: &[MissionCheck<'_>],
) -> Vec<Margin> {
    let near_m = mission::corner_cut_m(&spec.mission).max(spec.mission.tolerance_m);
    let search = Search::new(spec, world, contracts, near_m);
    let claims = search.claims();
    let visited = spec.tasks.iter().zip(&claims);
    let visited = visited.filter(|(task, _)| task.sweep.is_none());
    let mut margins: Vec<Margin> = visited
        .map(|(task, claim)| {
            let sites = count(task.stops.len());
            let required = Requirement::at_least(Limit::Task(task.id.clone()), sites, "places");
            match claim {
                Some(claim) => {
                    let contract = &contracts[claim.contract];
                    let rest = &contract.flight.rests[claim.rests[0]];
                    let at = contract.moment(rest.point, rest.from_s, rest.rows.0);
                    required.margin(contract.id(), sites, Some(at))
                }
                None => Margin {
                    note: "no vehicle does it".to_owned(),
                    ..required.margin("", 0.0, None)
                },
            }
        })
        .collect();
    let mut taken: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (task, claim) in spec.tasks.iter().zip(&claims) {
        let Some(claim) = claim else { continue };
        let contract = &contracts[claim.contract];
        let taken = taken.entry(claim.contract).or_default();
        for (stop, &rest) in task.stops.iter().zip(&claim.rests) {
            let rest = &contract.flight.rests[rest];
            let acts = contract.acts(stop, rest, taken);
            margins.extend(contract.window(&task.id, stop, (rest, acts.first().copied())));
            // Those of one place are in one order for all of its tasks.
            taken.extend(acts);
        }
    }
    for (index, contract) in contracts.iter().enumerate() {
        for rest in 0..contract.flight.rests.len() {
            let done = search.merged(&claims, index, rest);
            if let Some((stop, away_m)) = done {
                margins.extend(contract.visited(&stop, &contract.flight.rests[rest], away_m));
            }
        }
    }
    let commands = load_commands(spec);
    for (index, contract) in contracts.iter().enumerate() {
        let done = spec.tasks.iter().zip(&claims);
        let is_own = |claim: &Claim| claim.contract == index;
        let done = done.filter(|(_, claim)| claim.as_ref().is_some_and(is_own));
        let stops: Vec<&Stop> = done.flat_map(|(task, _)| &task.stops).collect();
        margins.extend(contract.stray(&commands, &stops));
    }
    margins
}

struct Search<'a> {
    spec: &'a MissionSpec,
    world: &'a World,
    contracts: &'a [MissionCheck<'a>],
    /// Of each task.
    possible: Vec<Vec<Claim>>,
}

impl<'a> Search<'a> {
    fn new(
        spec: &'a MissionSpec,
        world: &'a World,
        contracts: &'a [MissionCheck<'a>],
        near_m: f64,
    ) -> Self {
        let own: Vec<Vec<usize>> = contracts.iter().map(MissionCheck::own_rests).collect();
        let of_task = |(index, task): (usize, &Task)| {
            let mut claims = Vec::new();
            if task.sweep.is_some() {
                return claims;
            }
            for (at, contract) in contracts.iter().enumerate() {
                if !task.is_for(contract.vehicle) {
                    continue;
                }
                let near = |place: usize| -> Vec<usize> {
                    let point = task.stops[place].below(world.tasks[index][place]);
                    let rests = contract.flight.rests.iter().enumerate();
                    let near = rests.filter(|(rest, of)| {
                        !own[at].contains(rest) && of.point.distance_m(point) <= near_m
                    });
                    near.map(|(rest, _)| rest).collect()
                };
                let first: Vec<Vec<usize>> = near(0).into_iter().map(|rest| vec![rest]).collect();
                let later = 1..task.stops.len();
                let rests = later.fold(first, |before, place| extended(&before, &near(place)));
                claims.extend(rests.into_iter().map(|rests| Claim {
                    contract: at,
                    rests,
                }));
            }
            claims
        };
        Self {
            spec,
            world,
            contracts,
            possible: spec.tasks.iter().enumerate().map(of_task).collect(),
        }
    }

    /// A claim for each task, such that no rest has to be longer than it is and all is done there;
    /// where the search finds none, the first possible one.
    fn claims(&self) -> Vec<Option<Claim>> {
        // Those with few choices first, then by the last rest, which is that of a drop.
        let mut order: Vec<usize> = (0..self.possible.len()).collect();
        order.retain(|&task| !self.possible[task].is_empty());
        order.sort_by_key(|&task| {
            let of = &self.possible[task];
            (of[0].contract, of[0].rests.last().copied(), of.len())
        });
        let mut chosen: Vec<Option<Claim>> = vec![None; self.possible.len()];
        let mut steps = MAX_STEPS;
        if !self.choose(&order, &mut chosen, &mut steps) {
            for (chosen, possible) in chosen.iter_mut().zip(&self.possible) {
                *chosen = possible.first().cloned();
            }
        }
        chosen
    }

    fn choose(&self, open: &[usize], chosen: &mut Vec<Option<Claim>>, steps: &mut usize) -> bool {
        let Some((&task, open)) = open.split_first() else {
            return true;
        };
        for claim in &self.possible[task] {
            if *steps == 0 {
                break;
            }
            *steps -= 1;
            chosen[task] = Some(claim.clone());
            let fits = |&rest: &usize| self.fits(chosen, claim.contract, rest);
            if claim.rests.iter().all(fits) && self.choose(open, chosen, steps) {
                return true;
            }
        }
        chosen[task] = None;
        false
    }

    /// Whether a rest is long enough for what is claimed to be done in it, and it is done.
    fn fits(&self, claims: &[Option<Claim>], contract: usize, rest: usize) -> bool {
        let Some((stop, _)) = self.merged(claims, contract, rest) else {
            return true;
        };
        let (contract, rest) = (&self.contracts[contract], rest);
        let rest = &contract.flight.rests[rest];
        rest.until_s - rest.from_s + REST_S >= stop.hold_s
            && contract
                .window(
                    "",
                    &stop,
                    (rest, contract.acts(&stop, rest, &[]).first().copied()),
                )
                .is_none_or(|margin| margin.ok)
            && contract.done(&stop, rest).is_none_or(|margin| margin.ok)
    }

    /// All that is claimed to be done in a rest as one stop, and how far it is from the places.
    fn merged(
        &self,
        claims: &[Option<Claim>],
        contract: usize,
        rest: usize,
    ) -> Option<(Stop, f64)> {
        let at = self.contracts[contract].flight.rests[rest].point;
        let mut merged: Option<(Stop, f64)> = None;
        for (index, (task, claim)) in self.spec.tasks.iter().zip(claims).enumerate() {
            let claim = claim.iter().filter(|claim| claim.contract == contract);
            for place in claim.flat_map(|claim| claim.rests.iter()).enumerate() {
                let (place, _) = match *place.1 == rest {
                    true => place,
                    false => continue,
                };
                let point = task.stops[place].below(self.world.tasks[index][place]);
                let away_m = at.distance_m(point);
                match &mut merged {
                    Some((stop, furthest_m)) => {
                        stop.join(&task.stops[place]);
                        *furthest_m = furthest_m.max(away_m);
                    }
                    None => merged = Some((task.stops[place].clone(), away_m)),
                }
            }
        }
        merged
    }
}

impl MissionCheck<'_> {
    /// When what is done in a rest begins, early or late, against the window of its stop; `acts` is the index of the
    /// item that begins it.
    fn window(
        &self,
        task: &str,
        stop: &Stop,
        (rest, acts): (&Rest, Option<usize>),
    ) -> Option<Margin> {
        let window = stop.window_s?;
        // Actions begin after the holds before them; a hold alone may begin at any time of the rest.
        let (held_s, waits_until_s) = match stop.actions.is_empty() {
            true => (0.0, window.least),
            false => (self.held_before_s(rest, acts), f64::NEG_INFINITY),
        };
        let shift_s = self.shift_at_s(rest);
        let begins_s = [shift_s.least, shift_s.most]
            .map(|by_s| (rest.from_s + by_s + held_s).max(waits_until_s));
        let missed_s = window.miss(begins_s[0]).max(window.miss(begins_s[1]));
        // Who is early is gone early, too.
        let (from_s, until_s) = (rest.from_s + shift_s.least, rest.until_s + shift_s.least);
        let cut_s = (stop.hold_s - REST_S - (until_s - from_s.max(window.least))).max(0.0);
        let required = Requirement::at_most(Limit::TaskWindow(task.to_owned()), 0.0, "s");
        let planned_s = (rest.from_s + held_s).max(waits_until_s);
        let at = self.moment(rest.point, planned_s, rest.rows.0);
        let note = format!(
            "begins at {:.0} to {:.0} s, {} to {} s in the spec",
            begins_s[0], begins_s[1], window.least, window.most
        );
        Some(Margin {
            note,
            ..required.margin(self.id(), missed_s.max(cut_s), Some(at))
        })
    }

    /// By how much a rest may begin early (negative) or late: its takeoff and what is behind it. Its departure
    /// counts as planned: the slack of the separation is about other vehicles.
    fn shift_at_s(&self, rest: &Rest) -> Span {
        let takeoff_s = takeoff_lateness_s(self.vehicle);
        Span {
            least: takeoff_s.least - rest.early_s,
            most: takeoff_s.most + rest.late_s,
        }
    }

    /// How long a vehicle stays in a rest before an item is run; where the time of an item before that is not known,
    /// all but the holds after it.
    fn held_before_s(&self, rest: &Rest, index: Option<usize>) -> f64 {
        let (first, last) = rest.rows;
        let items = self.mission.items.get(first - 1..last).unwrap_or_default();
        let stays_s = rest.until_s - rest.from_s;
        let (before, after) = items.split_at(index.map_or(0, |index| index + 1 - first));
        let hold_s = |item: &Item| match item.command {
            command::NAV_WAYPOINT | command::NAV_LOITER_TIME => {
                item::hold_s(item.params[0], self.mission.autopilot).ok()
            }
            command::NAV_DELAY => Some(f64::from(item.params[0])).filter(|hold_s| *hold_s >= 0.0),
            command if command > command::NAV_LAST => Some(0.0),
            _ => None,
        };
        let known_s: Option<f64> = before.iter().map(hold_s).sum();
        let after_s = || after.iter().filter_map(hold_s).sum::<f64>();
        known_s
            .unwrap_or_else(|| stays_s - after_s())
            .clamp(0.0, stays_s.max(0.0))
    }
}

/// Each of the sequences with each later rest at its end.
fn extended(before: &[Vec<usize>], after: &[usize]) -> Vec<Vec<usize>> {
    let longer = before.iter().flat_map(|rests| {
        let later = after.iter().filter(|rest| rests.last() < Some(*rest));
        later.map(|rest| [rests.as_slice(), &[*rest]].concat())
    });
    longer.collect()
}

fn count(sites: usize) -> f64 {
    f64::from(u32::try_from(sites).unwrap_or(u32::MAX))
}
