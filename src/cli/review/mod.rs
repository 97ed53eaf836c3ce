//! `sortie review`: the verdict on any mission files.

pub(super) mod flight;
mod folders;
mod warnings;
pub(super) mod without_spec;

use std::path::{Path, PathBuf};

use super::args;
use super::check;
use super::folder::missions::{Files, assign};
use super::folder::{self, replace};
use super::print::console::{Paint, note, out, out_json, out_lines, warn_of_parked};
use super::print::failure::Failure;
use super::print::table;
use super::print::table::Rows;
use crate::formats::{self, Document, Format};
use crate::mission::{Home, VehicleMission};
use crate::numeric::digits::count;
use crate::report::{self, ReviewInput};
use crate::spec::SpecFile;
use crate::verify;
use crate::world;
use warnings::{stored_otherwise, warn, warn_of_items, warn_of_vehicles};
use without_spec::Subject;

/// Most repairs of one file that are printed one by one.
const MAX_REPAIRS: usize = 20;

pub(super) fn run(arguments: &args::Review) -> Result<(), Failure> {
    for (flag, path, endings) in [
        ("--html", &arguments.html, ["html", "htm"]),
        ("--svg", &arguments.svg, ["svg", "svg"]),
        ("--trajectories", &arguments.trajectories, ["json", "json"]),
    ] {
        check_name(flag, path.as_deref(), &endings)?;
    }
    let is_spec = |path: &&PathBuf| path.extension().is_some_and(|e| e == "yaml" || e == "yml");
    let paths = folders::opened(&arguments.files)?;
    let (specs, files): (Vec<&PathBuf>, Vec<&PathBuf>) = paths.iter().partition(is_spec);
    let named = named(&arguments.vehicle)?;
    if files.iter().any(|path| flight::is_flight(path)) && specs.len() < 2 {
        let spec = specs.first().map(|path| path.as_path());
        return flight::run(spec, &files, arguments);
    }
    match specs[..] {
        [] => without_spec(&files, &named, arguments),
        [spec] => with_spec(spec, &files, &named, arguments),
        _ => Err(Failure::new(
            Failure::USAGE,
            format!("review judges by one spec (*.yaml), got {}", specs.len()),
        )),
    }
}

/// A wrong ending is rejected, so that a page or picture never overwrites a mission.
fn check_name(flag: &str, path: Option<&Path>, endings: &[&str]) -> Result<(), Failure> {
    let Some(path) = path else { return Ok(()) };
    if path
        .extension()
        .is_some_and(|ending| endings.iter().any(|allowed| ending == *allowed))
    {
        return Ok(());
    }
    let what = match flag {
        "--svg" => "picture",
        "--html" => "page",
        _ => "document",
    };
    let message = format!(
        "{flag} {}: the name of a {what} ends in .{}",
        path.display(),
        endings[0]
    );
    Err(Failure::new(Failure::USAGE, message))
}

fn with_spec(
    spec: &Path,
    files: &[&PathBuf],
    named: &[(&str, PathBuf)],
    arguments: &args::Review,
) -> Result<(), Failure> {
    if arguments.limits != args::Limits::default() {
        let message = "limits come from the spec: leave the flags or the spec out";
        return Err(Failure::new(Failure::USAGE, message));
    }
    let file = SpecFile::read_known(spec).map_err(world::with_ground)?;
    let world = world::load(&file)?;
    check::warn_of_imports(&file);
    let (missions, paths) = missions(&file, &world, files, named)?;
    let own = missions.iter().map(|(_, mission)| mission);
    folders::refuse_disagreeing(&arguments.files, paths.values().zip(own))?;
    let judged: Vec<(usize, &VehicleMission)> = missions.iter().map(|(v, m)| (*v, m)).collect();
    let mut review = verify::review(&file.spec, &world, &judged);
    warn_of_vehicles(&file.spec, &review);
    warn(&mut review, verify::distant_from_area(&file.spec, &judged));
    warn(&mut review, stored_otherwise(&file.spec, &judged));
    write_result(
        &ReviewInput {
            spec: &file.spec,
            world: &world,
            plan: None,
            missions: &judged,
            review: &review,
            seed: None,
            spec_sha256: &folder::sha256(&file.text),
            version: env!("CARGO_PKG_VERSION"),
        },
        &[],
        arguments,
        true,
    )
}

/// Sentences of several vehicles (`ID: TEXT`) in one, for those that have the same text.
fn grouped(sentences: &[String]) -> Vec<String> {
    let mut groups: Vec<(Vec<&str>, &str)> = Vec::new();
    for sentence in sentences {
        let (id, text) = sentence.split_once(": ").unwrap_or(("", sentence));
        match groups.iter_mut().find(|(_, known)| *known == text) {
            Some((ids, _)) => ids.push(id),
            None => groups.push((vec![id], text)),
        }
    }
    let sentence = |(ids, text): (Vec<&str>, &str)| match ids[..] {
        [""] => text.to_owned(),
        [first, second, third, _, ..] => {
            let more = ids.len() - 3;
            format!("{first}, {second}, {third} and {more} more: {text}")
        }
        _ => format!("{}: {text}", ids.join(", ")),
    };
    groups.into_iter().map(sentence).collect()
}

/// The missions of the vehicles of a spec, and the files that hold them.
fn missions(
    file: &SpecFile,
    world: &world::World,
    files: &[&PathBuf],
    named: &[(&str, PathBuf)],
) -> Result<(Vec<(usize, VehicleMission)>, Files), Failure> {
    let mut lists = Vec::new();
    let mut own = Vec::new();
    for &path in files {
        let list = match folder::vehicle_of(path, file) {
            Some(_) => None,
            None => Some(folder::read_document(path)?).filter(Document::is_list),
        };
        match list {
            Some(document) => {
                report_list(path, &document);
                lists.push((path.clone(), document));
            }
            None => own.push(path),
        }
    }
    let files = assign(file, own.into_iter(), named)?;
    let mut missions = Vec::new();
    for (vehicle, path) in &files {
        let mut document = folder::read_document(path)?;
        hand_out(&lists, &mut document);
        report_losses(&file.spec.vehicles[*vehicle].id, path, &document);
        // A missing home is judged against the home of the spec, and fails.
        let home = document.home.or_else(|| document.home_on(&world.terrain));
        document.home = Some(home.unwrap_or(NO_HOME));
        let vehicle_of = &file.spec.vehicles[*vehicle];
        let mut mission = document
            .into_mission(vehicle_of.autopilot, vehicle_of.airframe)
            .map(|mission| mission.for_version(vehicle_of.autopilot_version))
            .map_err(|error| {
                Failure::new(Failure::INPUT, format!("{}: {error}", path.display()))
            })?;
        mission.params = folder::params::read_params(path, &vehicle_of.id)?;
        report_repairs(path, &mission.notes);
        missions.push((*vehicle, mission));
    }
    Ok((missions, files))
}

/// A blank home row.
const NO_HOME: Home = Home {
    x: 0,
    y: 0,
    amsl_m: 0.0,
};

fn without_spec(
    files: &[&PathBuf],
    named: &[(&str, PathBuf)],
    arguments: &args::Review,
) -> Result<(), Failure> {
    let subjects = subjects(files, named)?;
    let mut paths = Vec::new();
    for subject in &subjects {
        report_losses(&subject.id, &subject.path, &subject.document);
        paths.push(subject.path.clone());
    }
    let mut made = without_spec::around(subjects, &arguments.limits)?;
    for ((_, mission), path) in made.missions.iter().zip(&paths) {
        report_repairs(path, &mission.notes);
    }
    let own = made.missions.iter().map(|(_, mission)| mission);
    folders::refuse_disagreeing(&arguments.files, paths.iter().zip(own))?;
    let judged: Vec<(usize, &VehicleMission)> =
        made.missions.iter().map(|(v, m)| (*v, m)).collect();
    let mut review = verify::review(&made.spec, &made.world, &judged);
    without_spec::judge_later(&mut review, (&made.spec, &made.world), &judged);
    let rates = without_spec::judge_rates(
        &mut review,
        (&made.spec, &made.world),
        &judged,
        &arguments.limits,
    );
    made.assumed.extend(rates);
    let not_judged =
        without_spec::keep_given(&mut review, (&made.spec, &judged), &arguments.limits);
    review.assumptions.extend(made.assumed.iter().cloned());
    for left_out in &not_judged {
        let text = format!("not judged, because it was not given: {left_out}");
        review.assumptions.push(text);
    }
    review.margins.extend(made.failed.iter().cloned());
    for text in grouped(&made.assumed) {
        note(&format!("note: {text}"));
    }
    warn(&mut review, verify::distant_from_home(&made.spec, &judged));
    warn(&mut review, stored_otherwise(&made.spec, &judged));
    write_result(
        &ReviewInput {
            spec: &made.spec,
            world: &made.world,
            plan: None,
            missions: &judged,
            review: &review,
            seed: None,
            spec_sha256: &folder::sha256(&made.text),
            version: env!("CARGO_PKG_VERSION"),
        },
        &not_judged,
        arguments,
        false,
    )
}

/// The missions among the files; the lists among them go to each mission that has none.
fn subjects(files: &[&PathBuf], named: &[(&str, PathBuf)]) -> Result<Vec<Subject>, Failure> {
    let mut lists = Vec::new();
    let mut subjects: Vec<Subject> = Vec::new();
    let own = named.iter().map(|(id, path)| ((*id).to_owned(), path));
    let others = files.iter().map(|path| (folder::stem(path), *path));
    for (id, path) in own.chain(others) {
        let document = folder::read_document(path)?;
        if document.is_list() {
            report_list(path, &document);
            lists.push((path.clone(), document));
            continue;
        }
        if let Some(other) = subjects.iter().find(|other| other.id == id) {
            let (path, other) = (path.display(), other.path.display());
            let message =
                format!("{other} and {path} are both for {id}: name one (--vehicle ID=FILE)");
            return Err(Failure::new(Failure::USAGE, message));
        }
        subjects.push(Subject {
            id,
            path: path.clone(),
            document,
        });
    }
    if subjects.is_empty() {
        // A fence alone holds nothing to fly; the verdict fails for that.
        subjects.extend(lists.drain(..).map(|(path, document)| Subject {
            id: folder::stem(&path),
            path,
            document: Document {
                repairs: Vec::new(),
                ..document
            },
        }));
    }
    for subject in &mut subjects {
        hand_out(&lists, &mut subject.document);
    }
    Ok(subjects)
}

/// Gives the fence and the rally points of files that hold nothing else to a mission
/// that has none.
fn hand_out(lists: &[(PathBuf, Document)], document: &mut Document) {
    for (_, list) in lists {
        if document.fence.is_empty() && !list.fence.is_empty() {
            document.fence.clone_from(&list.fence);
            document.is_fence_known = true;
        }
        if document.rally.is_empty() {
            document.rally.clone_from(&list.rally);
        }
    }
}

/// Writes and prints the review; an error if the missions fail.
fn write_result(
    input: &ReviewInput<'_>,
    not_judged: &[String],
    arguments: &args::Review,
    has_spec: bool,
) -> Result<(), Failure> {
    let review = input.review;
    warn_of_parked(review);
    warn_of_items(review);
    if let Some(target) = &arguments.html {
        replace::write_file(target, report::review_html(input).as_bytes())?;
    }
    if let Some(target) = &arguments.svg {
        replace::write_file(target, report::review_svg(input).as_bytes())?;
    }
    if let Some(target) = &arguments.trajectories {
        let found = verify::verified_trajectories(input.spec, input.world, input.missions);
        let document = report::trajectories_json(&found);
        replace::write_file(target, report::json_text(&document).as_bytes())?;
    }
    if arguments.json {
        out_json(&report::review_json(review, None))?;
    } else {
        print(&input.spec.name, review, not_judged)?;
        if has_spec {
            table::print_no_buffers(input.spec)?;
        }
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

/// Prints the use of a file without a mission.
fn report_list(path: &Path, document: &Document) {
    note(&format!(
        "{}: {} and {}, for every mission that has none",
        path.display(),
        count(document.fence.len(), "fence item"),
        count(document.rally.len(), "rally point")
    ));
    let repairs: Vec<String> = document.repairs.iter().map(ToString::to_string).collect();
    report_repairs(path, &repairs);
}

fn report_repairs(path: &Path, repairs: &[String]) {
    for repair in repairs.iter().take(MAX_REPAIRS) {
        note(&format!("{}: {repair}", path.display()));
    }
    if let Some(more) = repairs.len().checked_sub(MAX_REPAIRS).filter(|&n| n > 0) {
        note(&format!("{}: and {more} more repairs", path.display()));
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

/// Prints what the format of a file cannot hold.
fn report_losses(id: &str, path: &Path, document: &Document) {
    if folder::is_waypoints(path) && !document.is_fence_known && document.rally.is_empty() {
        let lost = match folder::params::params_path(path, id) {
            None => formats::known_losses(Format::Waypoints),
            Some(_) => "a .waypoints file holds no fence and no rally points: they are not judged",
        };
        note(&format!("note: {id}: {lost}"));
    }
}

fn print(name: &str, review: &verify::Review, not_judged: &[String]) -> Result<(), Failure> {
    let paint = Paint::for_stdout();
    let passed = review.margins.iter().filter(|margin| margin.ok).count();
    let verdict = if review.passes() {
        paint.good("pass")
    } else {
        paint.bad("FAIL")
    };
    let all = review.margins.len();
    out(&format!("{name}: {verdict}, {passed} of {all} limits kept"))?;
    if !review.passes() {
        out_lines(&table::failures(review, paint))?;
    }
    let mut rows = Rows::new(&["vehicle", "limit", "worst", "allowed", "where and when", ""]);
    for margin in &review.margins {
        rows.add(row(margin, paint));
    }
    for left_out in not_judged {
        rows.add([
            String::new(),
            left_out.clone(),
            "-".to_owned(),
            "-".to_owned(),
            String::new(),
            paint.dim("not judged"),
        ]);
    }
    rows.print()
}

/// One margin: vehicle, limit, worst value, allowed value, where and when, verdict.
fn row(margin: &verify::Margin, paint: Paint) -> [String; 6] {
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
            format!(
                "{} {}",
                table::number(value, table::decimals(margin.unit)),
                table::unit(value, margin.unit)
            )
        } else {
            "-".to_owned()
        }
    };
    let verdict = if margin.ok {
        paint.good("ok")
    } else {
        paint.bad("FAIL")
    };
    [
        who,
        margin.limit.to_string(),
        value(margin.value),
        if margin.bound.is_finite() {
            format!("{} {}", table::sense(margin), value(margin.bound))
        } else {
            "-".to_owned()
        },
        place,
        verdict,
    ]
}
