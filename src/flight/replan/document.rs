//! `replan.json`.

use serde_json::{Value, json};

use super::{Decision, Outcomes};
use crate::mission::Item;
use crate::report;
use crate::spec::{MissionSpec, Threat};

/// The document of a decision and of how the vehicles took their new missions.
#[must_use]
pub fn document(
    spec: &MissionSpec,
    threat: &Threat,
    decision: &Decision,
    outcomes: &Outcomes,
) -> String {
    let id = |vehicle: usize| &spec.vehicles[vehicle].id;
    let place = |item: &Item| {
        let place = item.place()?;
        Some(
            json!({"lat_deg": place.lat_deg, "lon_deg": place.lon_deg, "frame": item.frame, "z_m": item.z}),
        )
    };
    let missions = decision.missions.iter();
    let vehicles: Vec<Value> = missions
        .map(|new| {
            let outcome = outcomes.get(&new.vehicle);
            let items: Vec<Value> = new.mission.items.iter().filter_map(place).collect();
            json!({
                "id": id(new.vehicle),
                "on_new_path": outcome.is_some_and(Result::is_ok),
                "reason": outcome.and_then(|outcome| outcome.as_ref().err()),
                "items": items,
                "left": left(decision, new.vehicle),
            })
        })
        .collect();
    let unavoidable = decision.unavoidable.iter();
    let cannot_avoid: Vec<Value> = unavoidable
        .map(|of| json!({"id": id(of.vehicle), "threats": of.threats, "why": of.why}))
        .collect();
    let passes = decision.review.passes() && decision.unavoidable.is_empty();
    report::json_text(&json!({
        "sortie": env!("CARGO_PKG_VERSION"),
        "threat": threat_json(threat),
        "verdict": if passes { "pass" } else { "fail" },
        "planning_s": decision.planned_s,
        "buffers": decision.has_buffers,
        "vehicles": vehicles,
        "cannot_avoid": cannot_avoid,
    }))
}

/// The stops and tasks of a vehicle that are left.
fn left(decision: &Decision, vehicle: usize) -> Vec<Value> {
    let state = decision
        .states
        .iter()
        .find(|state| state.vehicle == vehicle);
    let left = state.map_or(&[][..], |state| state.left.as_slice()).iter();
    left.map(|of| json!({"id": of.id, "kind": of.kind.word()}))
        .collect()
}

/// The document of a threat for which nothing was decided, or nothing sent.
#[must_use]
pub fn failure_document(threat: &Threat, why: &str) -> String {
    report::json_text(&json!({
        "sortie": env!("CARGO_PKG_VERSION"),
        "threat": threat_json(threat),
        "verdict": "fail",
        "reason": why,
        "vehicles": [],
        "cannot_avoid": [],
    }))
}

fn threat_json(threat: &Threat) -> Value {
    json!({
        "id": threat.id,
        "lat_deg": threat.place.lat_deg,
        "lon_deg": threat.place.lon_deg,
        "radius_m": threat.radius_m,
    })
}
