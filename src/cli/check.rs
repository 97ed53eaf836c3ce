//! `sortie check`: the spec alone.

use super::args;
use super::print::console::{note, out};
use super::print::failure::Failure;
use crate::autopilot::facts;
use crate::mission;
use crate::path::lean_note;
use crate::spec::{Document, MissionSpec, Survey};
use crate::verify;
use crate::world;

/// Zones of one file that are listed.
const MAX_LISTED: usize = 20;

pub(super) fn run(arguments: &args::Check) -> Result<(), Failure> {
    let mut surveys = Vec::new();
    let (kind, vehicles, threats, zones) = match Document::read(&arguments.spec)? {
        Document::Mission(file) => {
            world::load(&file)?;
            let spec = &file.spec;
            for vehicle in &spec.vehicles {
                let leans = lean_note(spec, vehicle, vehicle.speeds().most);
                leans
                    .iter()
                    .for_each(|text| note(&format!("warning: {text}")));
            }
            for text in verify::distant_from_area(spec, &[]) {
                note(&format!("warning: {text}"));
            }
            for text in full_fences(spec) {
                note(&format!("warning: {text}"));
            }
            let (vehicles, threats) = (spec.vehicles.len(), spec.threats.len());
            surveys.clone_from(&file.surveys);
            ("", vehicles, threats, spec.no_fly.len())
        }
        Document::Scenario(scenario) => {
            let (vehicles, threats) = (scenario.vehicles.len(), scenario.threats.len());
            (" scenario of the study", vehicles, threats, 0)
        }
    };
    let count = |number: usize, one: &str, many: &str| {
        if number == 1 {
            format!("1 {one}")
        } else {
            format!("{number} {many}")
        }
    };
    out(&format!(
        "{}: good{kind}: {}, {}, {}",
        arguments.spec.display(),
        count(vehicles, "vehicle", "vehicles"),
        count(threats, "threat", "threats"),
        count(zones, "no-fly zone", "no-fly zones"),
    ))?;
    for survey in &surveys {
        for line in described(survey) {
            out(&line)?;
        }
    }
    Ok(())
}

/// The vehicles whose autopilot does not keep the fence of a spec: their missions would be
/// rejected after planning.
fn full_fences(spec: &MissionSpec) -> Vec<String> {
    let needs = mission::fence_needs(spec);
    let vehicles = spec.vehicles.iter().filter_map(|vehicle| {
        let keeps = facts(vehicle.autopilot, vehicle.airframe).capacity.fence;
        (needs > keeps).then(|| {
            format!(
                "the fence needs {needs} items and {} keeps {keeps}: leave zones out (only, skip), or set mission.fence: false",
                vehicle.id
            )
        })
    });
    vehicles.collect()
}

/// What became of the shapes of a file.
fn described(survey: &Survey) -> Vec<String> {
    let parts = [
        (survey.zones.len(), "zones"),
        (survey.out_of_reach, "out of reach"),
        (survey.left_out, "left out by only or skip"),
        (survey.open, "that forbid nothing"),
        (survey.without_area, "lines and points"),
    ];
    let parts = parts.iter().filter(|(number, _)| *number > 0);
    let parts: Vec<String> = parts
        .map(|(number, what)| format!("{number} {what}"))
        .collect();
    let mut lines = vec![format!("  {}: {}", survey.file, parts.join(", "))];
    let shown = survey.zones.iter().take(MAX_LISTED);
    lines.extend(shown.map(|id| format!("    {id}")));
    if let Some(more @ 1..) = survey.zones.len().checked_sub(MAX_LISTED) {
        lines.push(format!("    and {more} more"));
    }
    lines
}
