//! What a plan does that the spec does not say.

use crate::dispatch::Dispatched;
use crate::spec::{Arrival, MissionSpec, SpecFile, Stop, Vehicle};

/// All notes, a line each.
pub(super) fn all(file: &SpecFile, planned: &MissionSpec, dispatched: &Dispatched) -> Vec<String> {
    let missions = of_missions(file, dispatched).into_iter();
    let missions = missions.map(|(note, ids)| format!("{}: {note}", ids.join(", ")));
    let mut all = given_way(file, dispatched);
    all.extend(resting(planned));
    all.extend(holding(&file.spec, planned));
    all.extend(missions);
    all
}

/// The vehicles that hold on their way until others have passed, at stops that are neither theirs nor those of tasks.
fn holding(specified: &MissionSpec, planned: &MissionSpec) -> Vec<String> {
    let fleet = specified.vehicles.iter().zip(&planned.vehicles);
    let is_of_task = |stop: &Stop| specified.tasks.iter().any(|task| task.has_stop(stop));
    let line = |(own, planned): (&Vehicle, &Vehicle)| {
        let is_own = |stop: &Stop| own.stops.iter().any(|known| known.id == stop.id);
        let is_new = |stop: &&Stop| !is_own(stop) && !is_of_task(stop);
        let mut stops = planned.stops.iter().filter(is_new);
        let hold = stops.find(|stop| stop.arrives == Arrival::Planned)?;
        Some(format!(
            "{} holds in the air for {} s until others have passed (`{}` of its stops in plan.json)",
            own.id, hold.hold_s, hold.id
        ))
    };
    fleet.filter_map(line).collect()
}

/// The vehicles that rest on their way where they have no space to turn, and how often.
fn resting(planned: &MissionSpec) -> Vec<String> {
    let vehicles = planned.vehicles.iter();
    vehicles
        .filter_map(|vehicle| {
            let stops = vehicle.stops.iter();
            let rests = stops.filter(|stop| stop.arrives == Arrival::Exact).count();
            let times = if rests == 1 { "time" } else { "times" };
            (rests > 0).then(|| {
                format!(
                    "{} rests for 1 s {rests} {times} on its way, to turn on the spot (`stops` of plan.json)",
                    vehicle.id
                )
            })
        })
        .collect()
}

/// The vehicles with another departure or speed than the spec has, and to which they give way.
fn given_way(file: &SpecFile, dispatched: &Dispatched) -> Vec<String> {
    let vehicles = &file.spec.vehicles;
    let planned = vehicles.iter().zip(&dispatched.plan.vehicles);
    planned
        .filter_map(|(vehicle, plan)| {
            let others = plan.gives_way_to(vehicle);
            let (first, rest) = others.split_first()?;
            let mut past = vehicles.get(*first)?.id.clone();
            if !rest.is_empty() {
                past += &format!(" and {} more", rest.len());
            }
            Some(format!(
                "{}: takes off at {} s and flies {} m/s (spec: {} s, {} m/s), to give way to {past}",
                vehicle.id, plan.depart_s, plan.speed_mps, vehicle.depart_s, vehicle.speed_mps
            ))
        })
        .collect()
}

/// The notes on missions, each once, with its vehicles.
fn of_missions<'a>(file: &'a SpecFile, dispatched: &'a Dispatched) -> Vec<(&'a str, Vec<&'a str>)> {
    let mut notes: Vec<(&str, Vec<&str>)> = Vec::new();
    for (vehicle, mission) in &dispatched.missions {
        let id = file.spec.vehicles[*vehicle].id.as_str();
        for note in &mission.notes {
            match notes.iter_mut().find(|(known, _)| known == note) {
                Some((_, ids)) => ids.push(id),
                None => notes.push((note, vec![id])),
            }
        }
    }
    notes
}
