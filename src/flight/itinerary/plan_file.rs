//! The itineraries of a fleet from its `plan.json`: the spec alone does not say who does which task.

use serde::Deserialize;

use super::stops::{Itinerary, ItineraryStop, Service, ServiceKind};
use crate::mission::corner_cut_m;
use crate::spec::{MissionSpec, SweepShape, Task, Vehicle};

/// A stop of the spec this near one of the plan is that one, metres.
const SAME_M: f64 = 2.0;

/// Other keys are skipped: for a large fleet they hold a hundred megabytes.
#[derive(Deserialize)]
struct Document {
    vehicles: Vec<Planned>,
}

#[derive(Deserialize)]
struct Planned {
    id: String,
    #[serde(default)]
    stops: Vec<ItineraryStop>,
    #[serde(default)]
    tasks: Vec<PlannedTask>,
}

#[derive(Deserialize)]
struct PlannedTask {
    id: String,
}

/// The itinerary of each vehicle, in the order of the spec, from the text of `plan.json`.
///
/// # Errors
/// Why the text is no plan of the spec, in words.
pub fn itineraries(plan: &[u8], spec: &MissionSpec) -> Result<Vec<Itinerary>, String> {
    let document: Document = serde_json::from_slice(plan).map_err(|error| error.to_string())?;
    let of = |vehicle: &Vehicle| {
        let mut planned = document.vehicles.iter();
        let found = planned.find(|planned| planned.id == vehicle.id);
        found.map_or_else(Itinerary::default, |planned| {
            itinerary(planned, vehicle, spec)
        })
    };
    let all: Vec<Itinerary> = spec.vehicles.iter().map(of).collect();
    match all.iter().find_map(Itinerary::problem) {
        Some(problem) => Err(problem),
        None => Ok(all),
    }
}

fn itinerary(planned: &Planned, vehicle: &Vehicle, spec: &MissionSpec) -> Itinerary {
    let mut itinerary = Itinerary {
        stops: planned.stops.clone(),
        services: Vec::new(),
    };
    for stop in &mut itinerary.stops {
        stop.near_m = near_m(&stop.id, vehicle, spec);
    }
    let sites = itinerary.sites();
    let own = vehicle.stops.iter().filter_map(|stop| {
        let is_it = |&at: &usize| {
            planned.stops[at].id == stop.id && sites[at].chord_m(stop.end.place) < SAME_M
        };
        let at = (0..sites.len()).find(is_it)?;
        Some(Service {
            id: stop.id.clone(),
            kind: ServiceKind::Stop,
            stops: vec![at],
        })
    });
    let own: Vec<Service> = own.collect();
    let is_own = |at: usize| own.iter().any(|service| service.stops == [at]);
    let tasks = planned.tasks.iter().filter_map(|of| {
        let task = spec.tasks.iter().find(|task| task.id == of.id)?;
        let is_for = |&at: &usize| !is_own(at) && is_of(&planned.stops[at].id, task);
        let stops: Vec<usize> = (0..sites.len()).filter(is_for).collect();
        (!stops.is_empty()).then(|| Service {
            id: task.id.clone(),
            kind: kind(task),
            stops,
        })
    });
    let mut services: Vec<Service> = tasks.collect();
    services.extend(own);
    services.sort_by_key(|service| service.stops.first().copied());
    itinerary.services = services;
    itinerary
}

/// How near a copter must come to a stop of the plan, metres: as the verdict has it.
fn near_m(id: &str, vehicle: &Vehicle, spec: &MissionSpec) -> Option<f64> {
    if vehicle.airframe.has_wing() {
        return None;
    }
    let options = &spec.mission;
    let usual_m = corner_cut_m(options).max(options.tolerance_m);
    let of_tasks = spec.tasks.iter().flat_map(|task| &task.stops);
    let named = vehicle.stops.iter().chain(of_tasks).filter(|stop| {
        let mut parts = id.split(" + ");
        stop.id == id || parts.any(|part| part == stop.id)
    });
    let radii = named.map(|stop| vehicle.radius_at_m(stop, usual_m));
    Some(radii.reduce(f64::max).unwrap_or(usual_m))
}

fn kind(task: &Task) -> ServiceKind {
    match task.sweep.as_ref().map(|sweep| &sweep.shape) {
        None if task.stops.len() > 1 => ServiceKind::Delivery,
        None => ServiceKind::Visit,
        Some(SweepShape::Survey { .. }) => ServiceKind::Area,
        Some(SweepShape::Corridor { .. }) => ServiceKind::Corridor,
        Some(SweepShape::Search(_)) => ServiceKind::Search,
    }
}

/// Whether a stop of the plan is made for a task: `ID`, `ID.from`, `ID.to`, several of these joined
/// by ` + `, or `ID.LINE.PLACE`.
fn is_of(stop: &str, task: &Task) -> bool {
    if task.sweep.is_some() {
        let rest = stop.strip_prefix(&task.id);
        let numbers = rest.and_then(|rest| rest.strip_prefix('.'));
        return numbers.is_some_and(|numbers| {
            let mut parts = numbers.split('.');
            numbers.split('.').count() == 2 && parts.all(|part| part.parse::<usize>().is_ok())
        });
    }
    let mut parts = stop.split(" + ");
    parts.any(|part| task.stops.iter().any(|stop| stop.id == part))
}
