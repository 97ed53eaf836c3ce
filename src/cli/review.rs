//! `sortie review`: the verdict on any mission files.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::args;
use super::console::{Paint, note, out};
use super::failure::Failure;
use super::folder;
use super::output;
use super::table::{self, Rows};
use crate::formats::{self, Format};
use crate::mission::VehicleMission;
use crate::report;
use crate::spec::SpecFile;
use crate::verify;
use crate::world;

/// Which file holds the mission of which vehicle (by its index in the spec).
pub(super) type Files = BTreeMap<usize, PathBuf>;

pub(super) fn run(arguments: &args::Review) -> Result<(), Failure> {
    let is_spec = |path: &&PathBuf| path.extension().is_some_and(|e| e == "yaml" || e == "yml");
    let specs: Vec<&PathBuf> = arguments.files.iter().filter(is_spec).collect();
    let [spec] = specs[..] else {
        let message = format!(
            "review needs one spec (*.yaml) to judge by, got {}",
            specs.len()
        );
        return Err(Failure::new(Failure::USAGE, message));
    };
    let named = named(&arguments.vehicle)?;
    if let Some(page) = &arguments.html
        && !page.extension().is_some_and(|e| e == "html" || e == "htm")
    {
        let message = format!(
            "--html {}: the name of a page ends in .html",
            page.display()
        );
        return Err(Failure::new(Failure::USAGE, message));
    }
    let file = SpecFile::read(spec)?;
    let world = world::load(&file)?;
    let files = assign(
        &file,
        arguments.files.iter().filter(|path| !is_spec(path)),
        &named,
    )?;
    let missions = read(&file, &files)?;
    let review = verify::review(
        &file.spec,
        &world,
        &missions.iter().map(|(v, m)| (*v, m)).collect::<Vec<_>>(),
    );
    for (vehicle, path) in &files {
        tell_losses(&file.spec.vehicles[*vehicle].id, path);
    }
    for (vehicle, mission) in &missions {
        for repair in &mission.notes {
            note(&format!("{}: {repair}", files[vehicle].display()));
        }
    }
    if let Some(target) = &arguments.html {
        let missions: Vec<(usize, &VehicleMission)> =
            missions.iter().map(|(v, m)| (*v, m)).collect();
        output::write_file(
            target,
            folder::page(&file, &world, None, &missions, &review).as_bytes(),
        )?;
    }
    if arguments.json {
        out(report::json_text(&report::review_json(&review)).trim_end())?;
    } else {
        tell(&file, &review)?;
    }
    if review.passes() {
        Ok(())
    } else {
        Err(Failure::new(
            Failure::VERDICT,
            "the missions do not pass verification",
        ))
    }
}

/// Splits `ID=FILE` arguments.
fn named(arguments: &[String]) -> Result<Vec<(&str, PathBuf)>, Failure> {
    arguments
        .iter()
        .map(|argument| match argument.split_once('=') {
            Some((id, file)) if !id.is_empty() && !file.is_empty() => Ok((id, PathBuf::from(file))),
            _ => Err(Failure::new(
                Failure::USAGE,
                format!("--vehicle {argument}: not of the form ID=FILE"),
            )),
        })
        .collect()
}

/// Gives each file to its vehicle: `<id>.*` by name, the named ones as told.
pub(super) fn assign<'a>(
    file: &SpecFile,
    paths: impl Iterator<Item = &'a PathBuf>,
    named: &[(&str, PathBuf)],
) -> Result<Files, Failure> {
    let ids = || {
        file.spec
            .vehicles
            .iter()
            .map(|v| v.id.as_str())
            .collect::<Vec<_>>()
            .join(", ")
    };
    let mut files = Files::new();
    let mut add = |vehicle: usize, path: PathBuf| match files.insert(vehicle, path.clone()) {
        None => Ok(()),
        Some(other) => Err(Failure::new(
            Failure::USAGE,
            format!(
                "{} and {} are both for {}: name one",
                other.display(),
                path.display(),
                file.spec.vehicles[vehicle].id
            ),
        )),
    };
    for (id, path) in named {
        let vehicle = file
            .spec
            .vehicles
            .iter()
            .position(|vehicle| vehicle.id == *id);
        let unknown = || {
            Failure::new(
                Failure::USAGE,
                format!("no vehicle {id} in the spec (there are: {})", ids()),
            )
        };
        add(vehicle.ok_or_else(unknown)?, path.clone())?;
    }
    for path in paths {
        let vehicle = folder::vehicle_of(path, file).ok_or_else(|| {
            let message = format!(
                "{}: for which vehicle? Use --vehicle ID=FILE (there are: {})",
                path.display(),
                ids()
            );
            Failure::new(Failure::USAGE, message)
        })?;
        add(vehicle, path.clone())?;
    }
    if files.is_empty() {
        return Err(Failure::new(Failure::USAGE, "no mission files given"));
    }
    Ok(files)
}

/// Reads the mission of each vehicle, in the order of the spec.
pub(super) fn read(
    file: &SpecFile,
    files: &Files,
) -> Result<Vec<(usize, VehicleMission)>, Failure> {
    files
        .iter()
        .map(|(vehicle, path)| Ok((*vehicle, folder::read_mission(path, file, *vehicle)?)))
        .collect()
}

/// Says what the format of a file cannot have kept.
fn tell_losses(id: &str, path: &Path) {
    if path
        .extension()
        .is_some_and(|extension| extension == "waypoints")
    {
        note(&format!(
            "note: {id}: {}",
            formats::known_losses(Format::Waypoints)
        ));
    }
}

fn tell(file: &SpecFile, review: &verify::Review) -> Result<(), Failure> {
    let paint = Paint::for_stdout();
    let kept = review.margins.iter().filter(|margin| margin.ok).count();
    let verdict = if review.passes() {
        paint.good("pass")
    } else {
        paint.bad("FAIL")
    };
    let all = review.margins.len();
    out(&format!(
        "{}: {verdict}, {kept} of {all} limits kept",
        file.spec.name
    ))?;
    if !review.passes() {
        out(&table::failures(review, paint))?;
    }
    let mut rows = Rows::new(&["vehicle", "limit", "worst", "allowed", "where and when", ""]);
    for margin in &review.margins {
        let who = margin.other.as_ref().map_or_else(
            || margin.vehicle.clone(),
            |other| format!("{}, {other}", margin.vehicle),
        );
        let place = margin.at.map_or_else(String::new, |at| {
            format!(
                "item {}, {:.5} {:.5}, T0+{}",
                at.item,
                at.place.lat_deg,
                at.place.lon_deg,
                table::clock(at.t_s)
            )
        });
        let value = |value: f64| {
            if value.is_finite() {
                format!("{} {}", table::number(value, 1), margin.unit)
            } else {
                "-".to_owned()
            }
        };
        let verdict = if margin.ok {
            paint.good("ok")
        } else {
            paint.bad("FAIL")
        };
        rows.add([
            who,
            margin.what.clone(),
            value(margin.value),
            if margin.limit.is_finite() {
                format!("{} {}", table::sense(margin), value(margin.limit))
            } else {
                "-".to_owned()
            },
            place,
            verdict,
        ]);
    }
    out(&rows.to_string())
}
