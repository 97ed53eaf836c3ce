//! `sortie check`: the spec alone.

use super::args;
use super::print::console::{note, out};
use super::print::failure::Failure;
use crate::path::lean_problem;
use crate::spec::Document;
use crate::verify;
use crate::world;

pub(super) fn run(arguments: &args::Check) -> Result<(), Failure> {
    let (kind, vehicles, threats, zones) = match Document::read(&arguments.spec)? {
        Document::Mission(file) => {
            world::load(&file)?;
            let spec = &file.spec;
            for vehicle in &spec.vehicles {
                let problem = lean_problem(vehicle, vehicle.speeds().most, spec.wind);
                problem
                    .iter()
                    .for_each(|text| note(&format!("warning: {text}")));
            }
            for text in verify::distant_from_area(spec, &[]) {
                note(&format!("warning: {text}"));
            }
            let (vehicles, threats) = (spec.vehicles.len(), spec.threats.len());
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
    Ok(())
}
