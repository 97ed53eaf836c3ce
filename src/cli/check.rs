//! `sortie check`: the spec alone.

use std::collections::BTreeMap;
use std::path::Path;

use super::args;
use super::print::console::{note, out_json, out_lines};
use super::print::failure::Failure;
use crate::mission;
use crate::numeric::digits::count;
use crate::path::lean_note;
use crate::report::{CheckDocument, CheckedVehicle, ImportEntry};
use crate::spec::{AirspaceImport, Document, MissionSpec, SpecError, SpecFile, Vehicle};
use crate::verify;
use crate::world::{self, World};

/// Zones of one file that are listed.
const MAX_LISTED: usize = 20;

pub(super) fn run(arguments: &args::Check) -> Result<(), Failure> {
    let (document, lines) = checked(&arguments.spec)?;
    if arguments.json {
        return out_json(&document);
    }
    note_warnings(&document.warnings);
    out_lines(&lines)
}

/// What is found in a spec, and the lines of it for people.
fn checked(path: &Path) -> Result<(CheckDocument, Vec<String>), SpecError> {
    let file = match Document::read_known(path).map_err(world::with_ground)? {
        Document::Mission(file) => file,
        Document::Scenario(scenario) => {
            let document = CheckDocument {
                threats: scenario.threats.len(),
                ..CheckDocument::new("scenario")
            };
            let line = summary(
                path,
                " scenario of the study",
                scenario.vehicles.len(),
                &document,
            );
            return Ok((document, vec![line]));
        }
    };
    let (spec, world) = (&file.spec, world::load(&file)?);
    let fleet = spec.vehicles.iter().zip(&world.sites);
    let landings = fleet.map(|(vehicle, of)| mission::landing_course_note(vehicle, of));
    let landings: Vec<Option<String>> = landings.collect();
    let fleet = spec.vehicles.iter().zip(&landings);
    let mut document = CheckDocument {
        warnings: warnings(&file, &world),
        vehicles: fleet
            .map(|(vehicle, landing)| CheckedVehicle::new(vehicle, landing.clone()))
            .collect(),
        airspace: file.imports.iter().map(ImportEntry::from).collect(),
        ..CheckDocument::new("mission")
    };
    document.count(spec);
    let mut lines = vec![summary(path, "", spec.vehicles.len(), &document)];
    lines.extend(
        (spec.vehicles.iter().zip(landings))
            .filter_map(|(vehicle, landing)| Some(format!("  {}: {}", vehicle.id, landing?))),
    );
    lines.extend(fences(spec));
    lines.extend(file.imports.iter().flat_map(import_lines));
    Ok((document, lines))
}

/// The line that says how much there is of what.
fn summary(path: &Path, kind: &str, vehicles: usize, document: &CheckDocument) -> String {
    format!(
        "{}: good{kind}: {}, {}, {}",
        path.display(),
        count(vehicles, "vehicle"),
        count(document.threats, "threat"),
        count(document.zones, "no-fly zone"),
    )
}

/// Prints what may not be meant.
pub(super) fn warn(file: &SpecFile, world: &World) {
    note_warnings(&warnings(file, world));
}

/// Prints what files of airspace and obstacles may not say as it was meant.
pub(super) fn warn_of_imports(file: &SpecFile) {
    note_warnings(&import_warnings(file));
}

fn note_warnings(texts: &[String]) {
    for text in texts {
        note(&format!("warning: {text}"));
    }
}

/// What may not be meant: speeds that need more lean than a stock vehicle has or that its autopilot does not keep,
/// landings with the wind, places far outside of the area, files that forbid nothing or would
/// with their axes swapped, and values that look like another unit.
fn warnings(file: &SpecFile, world: &World) -> Vec<String> {
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
    texts.extend(import_warnings(file));
    texts.extend(verify::distant_from_area(spec, &[]));
    texts.extend(world::unit_warnings(spec, world));
    texts
}

/// Of all files of airspace and obstacles.
fn import_warnings(file: &SpecFile) -> Vec<String> {
    let of_files = file.imports.iter().filter_map(import_warning);
    of_files
        .chain(file.imports.iter().flat_map(unmatched_warnings))
        .collect()
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
