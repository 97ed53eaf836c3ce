//! `sortie migrate`: a spec of version 1 as one of version 2.

use std::fs;

use super::args;
use super::folder::replace;
use super::print::console::{note, out_bytes};
use super::print::failure::Failure;
use crate::numeric::digits;
use crate::spec::{Buffers, SpecFile};
use crate::world;

pub(super) fn run(arguments: &args::Migrate) -> Result<(), Failure> {
    let file = SpecFile::read_known(&arguments.spec).map_err(world::with_ground)?;
    let name = arguments.spec.display();
    let text = if file.spec.version == 1 {
        let text = file.in_version_2()?;
        let migrated = SpecFile::parse_known(&arguments.spec, text).map_err(world::with_ground)?;
        // What the buffers forbid shows over the ground as well.
        world::load(&migrated)?;
        note(&format!(
            "{name}: version 1 becomes 2: {}",
            changes(&migrated)
        ));
        migrated.text
    } else {
        note(&format!(
            "{name}: is of version {} already",
            file.spec.version
        ));
        file.text
    };
    let target = match arguments.in_place {
        // A symbolic link stays: the file that it points to is replaced.
        true => Some(fs::canonicalize(&arguments.spec).unwrap_or_else(|_| arguments.spec.clone())),
        false => arguments.output.clone(),
    };
    match target {
        Some(path) => Ok(replace::write_file(&path, text.as_bytes())?),
        None => out_bytes(text.as_bytes()),
    }
}

/// What the new version means, in words.
fn changes(file: &SpecFile) -> String {
    if let Some(none) = file.spec.why_no_buffers() {
        return format!("as before, {none}");
    }
    let Buffers {
        threats_m,
        zones_m,
        area_m,
        terrain_m,
        ceiling_m,
        separation_m,
    } = file.spec.buffers;
    let named = [
        ("threats", threats_m),
        ("zones", zones_m),
        ("area", area_m),
        ("terrain", terrain_m),
        ("ceiling", ceiling_m),
        ("separation", separation_m),
    ];
    let all: Vec<String> = named
        .iter()
        .map(|(of, buffer_m)| format!("{of} {} m", digits::plain(*buffer_m)))
        .collect();
    format!(
        "plan, review and upload keep the default buffers beyond every limit ({}); buffer_m: changes them",
        all.join(", ")
    )
}
