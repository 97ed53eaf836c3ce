//! What `replan` did, on paper and on screen.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::Decision;
use crate::cli::fly::Sorties;
use crate::cli::folder::{replace, runs};
use crate::cli::print::console::out;
use crate::cli::print::failure::Failure;
use crate::cli::print::table::Rows;
use crate::report;
use crate::spec::Threat;

/// How each vehicle that was sent a new mission took it.
pub(super) type Told = BTreeMap<usize, Result<(), String>>;

/// Writes what was done beside the record of the flight.
pub(super) fn record(
    sorties: &Sorties,
    threat: &Threat,
    decision: &Decision,
    told: &Told,
) -> Result<(), Failure> {
    let fleet = &sorties.file.spec.vehicles;
    let renewed = &decision.replanned.renewed;
    let vehicles: Vec<Value> = renewed
        .iter()
        .map(|renewed| {
            let index = renewed.vehicle;
            let outcome = told.get(&index);
            let items: Vec<Value> = renewed
                .mission
                .items
                .iter()
                .filter_map(|item| {
                    let place = item.place()?;
                    Some(json!({"lat_deg": place.lat_deg, "lon_deg": place.lon_deg, "frame": item.frame, "z_m": item.z}))
                })
                .collect();
            json!({
                "id": fleet[index].id,
                "on_new_path": outcome.is_some_and(Result::is_ok),
                "reason": outcome.and_then(|outcome| outcome.as_ref().err()),
                "items": items,
            })
        })
        .collect();
    let cannot_avoid: Vec<Value> = decision
        .bound
        .iter()
        .map(|of| json!({"id": fleet[of.vehicle].id, "threats": of.threats, "why": of.why}))
        .collect();
    let passes = decision.replanned.review.passes() && decision.bound.is_empty();
    let document = json!({
        "sortie": env!("CARGO_PKG_VERSION"),
        "threat": threat_json(threat),
        "verdict": if passes { "pass" } else { "fail" },
        "planning_s": decision.planned_s,
        "vehicles": vehicles,
        "cannot_avoid": cannot_avoid,
    });
    write(sorties, &document)
}

/// The same where nothing was decided, or nothing sent.
pub(super) fn record_failure(sorties: &Sorties, threat: &Threat, why: &str) -> Result<(), Failure> {
    let document = json!({
        "sortie": env!("CARGO_PKG_VERSION"),
        "threat": threat_json(threat),
        "verdict": "fail",
        "reason": why,
        "vehicles": [],
        "cannot_avoid": [],
    });
    write(sorties, &document)
}

fn threat_json(threat: &Threat) -> Value {
    json!({
        "id": threat.id,
        "lat_deg": threat.place.lat_deg,
        "lon_deg": threat.place.lon_deg,
        "radius_m": threat.radius_m,
    })
}

fn write(sorties: &Sorties, document: &Value) -> Result<(), Failure> {
    let folder = runs::folder(&sorties.folder);
    let text = report::json_text(document);
    replace::write_file(&runs::named(&folder, "replan", "json"), text.as_bytes())?;
    replace::write_file(&folder.join("replan.json"), text.as_bytes())?;
    Ok(())
}

pub(super) fn tell(sorties: &Sorties, decision: &Decision, told: &Told) -> Result<(), Failure> {
    let mut rows = Rows::new(&["vehicle", "on its way", "items", ""]);
    for course in &decision.courses {
        let index = course.vehicle;
        let renewed = &decision.replanned.renewed;
        let mission = renewed.iter().find(|of| of.vehicle == index);
        let bound = decision.bound.iter().find(|of| of.vehicle == index);
        let (what, result) = match (told.get(&index), bound) {
            (_, Some(bound)) => (bound.cannot(), "KEEPS ITS COURSE".to_owned()),
            (None, None) if !course.in_mission && !course.stands => (
                "holds, or somebody flies it".to_owned(),
                "not touched".to_owned(),
            ),
            (None, None) => ("is not concerned".to_owned(), "not touched".to_owned()),
            (Some(Ok(())), None) => ("meets a threat".to_owned(), "on its new path".to_owned()),
            (Some(Err(why)), None) => ("meets a threat".to_owned(), why.clone()),
        };
        rows.add([
            sorties.file.spec.vehicles[index].id.clone(),
            what,
            mission.map_or_else(|| "-".to_owned(), |of| of.mission.items.len().to_string()),
            result,
        ]);
    }
    rows.print()?;
    out(&format!(
        "planned and verified in {:.2} s",
        decision.planned_s
    ))
}
