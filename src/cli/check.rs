//! `sortie check`: the spec alone.

use std::collections::{BTreeMap, BTreeSet};

use super::args;
use super::print::console::{note, out};
use super::print::failure::Failure;
use crate::mission;
use crate::path::lean_note;
use crate::spec::{AirspaceImport, Document, MissionSpec, SpecFile, Vehicle, dome_of};
use crate::verify;
use crate::world::{self, VehicleSites, World};

/// Zones of one file that are listed.
const MAX_LISTED: usize = 20;

pub(super) fn run(arguments: &args::Check) -> Result<(), Failure> {
    let mut imports = Vec::new();
    let mut needs = Vec::new();
    let (kind, vehicles, threats, zones) =
        match Document::read_known(&arguments.spec).map_err(world::with_ground)? {
            Document::Mission(file) => {
                let world = world::load(&file)?;
                let spec = &file.spec;
                warn(&file, &world);
                let fleet = spec.vehicles.iter().zip(&world.sites);
                needs.extend(fleet.filter_map(|(vehicle, of)| landing_course(vehicle, of)));
                needs.extend(fences(spec));
                imports.clone_from(&file.imports);
                let (threats, zones) = threats_and_zones(spec);
                ("", spec.vehicles.len(), threats, zones)
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
    for line in needs {
        out(&line)?;
    }
    for import in &imports {
        for line in import_lines(import) {
            out(&line)?;
        }
    }
    Ok(())
}

/// How many there are: a dome is one threat, and its layers are no zones.
fn threats_and_zones(spec: &MissionSpec) -> (usize, usize) {
    let domes: BTreeSet<&str> = spec.no_fly.iter().filter_map(dome_of).collect();
    let zones = spec.no_fly.iter().filter(|zone| dome_of(zone).is_none());
    (spec.threats.len() + domes.len(), zones.count())
}

/// Warns of speeds that need more lean than a stock vehicle has or that its autopilot does not keep, of
/// landings with the wind, of places far outside of the area, of files that forbid nothing or would
/// with their coordinates exchanged, and of values that look like another unit.
pub(super) fn warn(file: &SpecFile, world: &World) {
    let spec = &file.spec;
    let fleet = spec.vehicles.iter().zip(&world.sites);
    let mut texts: Vec<String> = fleet
        .flat_map(|(vehicle, of)| {
            let lean = lean_note(spec, vehicle, vehicle.speeds().most);
            let airspeed = vehicle.airspeed_note();
            let energy = vehicle.energy_note();
            let speeds = lean.into_iter().chain(airspeed).chain(energy);
            speeds.chain(vehicle.landing_note(of.landing_rad))
        })
        .collect();
    texts.extend(file.imports.iter().filter_map(import_warning));
    texts.extend(file.imports.iter().flat_map(unmatched_warnings));
    texts.extend(verify::distant_from_area(spec, &[]));
    texts.extend(world::unit_warnings(spec, world));
    for text in texts {
        note(&format!("warning: {text}"));
    }
}

/// That a file of airspace or obstacles may not say what was meant.
fn import_warning(import: &AirspaceImport) -> Option<String> {
    let is_empty = [import.out_of_reach, import.left_out, import.unrestricted]
        .iter()
        .sum::<usize>()
        + import.zones.len()
        + import.without_area
        == 0;
    if import.axes_swapped > 0 {
        let (file, swapped) = (&import.file, import.axes_swapped);
        return Some(format!(
            "{file}: {swapped} out of reach would be in the area with latitude and longitude exchanged"
        ));
    }
    is_empty.then(|| format!("{}: no zone or obstacle is in it", import.file))
}

/// That `skip` or `only` asks for what a file does not have.
fn unmatched_warnings(import: &AirspaceImport) -> Vec<String> {
    let unmatched = import.unmatched.iter().map(|(word, meant)| {
        let like = meant
            .as_ref()
            .map(|meant| format!(": did you mean `{meant}`?"));
        let file = &import.file;
        format!(
            "{file}: nothing in it is `{word}`{}",
            like.unwrap_or_default()
        )
    });
    unmatched.collect()
}

/// The course of a landing that was found.
fn landing_course(vehicle: &Vehicle, sites: &VehicleSites) -> Option<String> {
    let note = mission::landing_course_note(vehicle, sites)?;
    Some(format!("  {}: {note}", vehicle.id))
}

/// What the fence of a spec needs, and what each kind of vehicle keeps.
fn fences(spec: &MissionSpec) -> Vec<String> {
    let needs = mission::fence_needs(spec);
    if needs == 0 {
        return vec!["  fence: none (mission.fence: false)".to_owned()];
    }
    let mut kinds: BTreeMap<(usize, u64), Vec<&Vehicle>> = BTreeMap::new();
    for vehicle in &spec.vehicles {
        let reach_m = mission::FENCE_REACH_S * vehicle.top_speed_mps();
        let key = (vehicle.fence_capacity(), reach_m.to_bits());
        kinds.entry(key).or_default().push(vehicle);
    }
    let lines = kinds.into_iter().filter_map(|((keeps, reach_bits), vehicles)| {
        let first = vehicles.first()?;
        let (others, verb) = match vehicles.len() - 1 {
            0 => (String::new(), "keeps"),
            more => (format!(" and {more} more"), "keep"),
        };
        let how = match first.fence_points {
            Some(_) => "fence_points",
            None => first.facts().firmware,
        };
        let mut line = format!(
            "  fence: needs {needs} items, {}{others} {verb} {keeps} ({how})",
            first.id
        );
        if needs > keeps {
            line += &format!(
                ": zones and threats more than {} s at top speed ({:.0} m) from the path and every way back may be left out, \
                 others have wider boundaries",
                mission::FENCE_REACH_S,
                f64::from_bits(reach_bits)
            );
        }
        Some(line)
    });
    lines.collect()
}

/// What became of the shapes of a file.
fn import_lines(import: &AirspaceImport) -> Vec<String> {
    let parts = [
        (import.zones.len(), "zones"),
        (import.out_of_reach, "out of reach"),
        (import.left_out, "left out by only or skip"),
        (import.unrestricted, "that forbid nothing"),
        (import.without_area, "lines and points"),
    ];
    let parts = parts.iter().filter(|(number, _)| *number > 0);
    let parts: Vec<String> = parts
        .map(|(number, what)| format!("{number} {what}"))
        .collect();
    let found = match parts.is_empty() {
        true => "nothing".to_owned(),
        false => parts.join(", "),
    };
    let mut lines = vec![format!("  {}: {found}", import.file)];
    let shown = import.zones.iter().take(MAX_LISTED);
    lines.extend(shown.map(|id| format!("    {id}")));
    if let Some(more @ 1..) = import.zones.len().checked_sub(MAX_LISTED) {
        lines.push(format!("    and {more} more"));
    }
    lines
}
