//! `sortie check`: the spec alone.

use super::args;
use super::console::out;
use super::failure::Failure;
use crate::spec::SpecFile;
use crate::world;

pub(super) fn run(arguments: &args::Check) -> Result<(), Failure> {
    let file = SpecFile::read(&arguments.spec)?;
    world::load(&file)?;
    let spec = &file.spec;
    let count = |number: usize, one: &str, many: &str| {
        if number == 1 {
            format!("1 {one}")
        } else {
            format!("{number} {many}")
        }
    };
    out(&format!(
        "{}: good: {}, {}, {}",
        arguments.spec.display(),
        count(spec.vehicles.len(), "vehicle", "vehicles"),
        count(spec.threats.len(), "threat", "threats"),
        count(spec.no_fly.len(), "no-fly zone", "no-fly zones"),
    ))?;
    Ok(())
}
