//! `sortie convert`: a mission file in another format, and a report of the losses.

pub(super) mod changes;
mod zones;

use std::path::Path;

use schemars::JsonSchema;
use serde::Serialize;

use super::args::{self, AirframeName, AutopilotName, ListName};
use super::folder;
use super::folder::replace;
use super::print::console::{note, out, out_json};
use super::print::failure::Failure;
use super::print::table;
use crate::formats::{self, Document, Drawing, Format};
use crate::geodesy::{Amsl, LatLon};
use crate::mission::{self, Home, Item, VehicleMission};
use crate::numeric::digits::count;
use crate::spec::{Airframe, Autopilot};
use changes::{changes, ranges};

/// Sentences of one kind that a terminal shows; `--json` has them all.
const MAX_LISTED: usize = 20;

/// A blank home row.
const NO_HOME: Home = Home {
    x: 0,
    y: 0,
    amsl_m: 0.0,
};

/// The format of the output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Target {
    Plan,
    Rows(ListName),
    Kml,
    GeoJson,
}

impl Target {
    fn text(self, mission: &VehicleMission, name: &str) -> Result<String, String> {
        Ok(match self {
            Self::Plan => formats::plan::write(mission),
            Self::Rows(list) => rows(mission, list)?,
            Self::Kml => formats::kml::write_mission(name, &Drawing::of(mission)),
            Self::GeoJson => formats::geojson::write_mission(name, &Drawing::of(mission)),
        })
    }
}

/// The report of a conversion.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Report {
    /// The file read.
    input: String,
    /// The file written.
    output: String,
    /// The autopilot that the output is for.
    autopilot: &'static str,
    /// Mission items, without home.
    mission_items: usize,
    /// Fence items.
    fence_items: usize,
    /// Rally points.
    rally_points: usize,
    /// Deviations from the format that the reader repaired.
    repairs: Vec<String>,
    /// Assumptions where the file says nothing.
    assumed: Vec<String>,
    /// Content of the input that the output lacks or changes.
    #[serde(rename = "not_kept")]
    lost: Vec<String>,
    /// Items that ArduPilot and PX4 read differently, where the file was not made for `autopilot`.
    read_differently: Vec<String>,
    /// Items that `autopilot` stores with other values.
    stored_otherwise: Vec<String>,
    /// Items that `autopilot` would refuse or misread.
    refused: Vec<String>,
}

pub(super) fn run(arguments: &args::Convert) -> Result<(), Failure> {
    if zones::is_shapes(&arguments.input) {
        return zones::run(arguments);
    }
    let ending = ending(arguments)?;
    if same_file(&arguments.input, &arguments.output) {
        let message = "the output is the input: give another name";
        return Err(Failure::new(Failure::USAGE, message));
    }
    let document = folder::read_document(&arguments.input)?;
    let target = target(&document, ending, arguments.list)?;
    let (text, report) = converted(document, target, arguments)?;
    replace::write_file(&arguments.output, text.as_bytes())?;
    if arguments.json {
        return out_json(&report);
    }
    print(&report)
}

/// The target by the name of the output; which rows is open yet.
fn ending(arguments: &args::Convert) -> Result<Target, Failure> {
    let path = &arguments.output;
    let target = match path.extension().and_then(|ending| ending.to_str()) {
        Some("plan") => Target::Plan,
        Some("waypoints" | "txt") => {
            return Ok(Target::Rows(arguments.list.unwrap_or(ListName::Mission)));
        }
        Some("kml") => Target::Kml,
        Some("geojson") => Target::GeoJson,
        _ => {
            let message = format!(
                "{}: no format of that name (allowed: .waypoints, .txt, .plan, .kml, .geojson)",
                path.display()
            );
            return Err(Failure::new(Failure::USAGE, message));
        }
    };
    if arguments.list.is_some() {
        let message = "--list: only a .waypoints or a .txt holds one list, the others hold all";
        return Err(Failure::new(Failure::USAGE, message));
    }
    Ok(target)
}

fn same_file(a: &Path, b: &Path) -> bool {
    match (a.canonicalize(), b.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => false,
    }
}

/// The rows to write: as given, else the mission, else the only list.
fn target(document: &Document, ending: Target, asked: Option<ListName>) -> Result<Target, Failure> {
    if ending != Target::Rows(ListName::Mission) || asked.is_some() || !document.is_list() {
        return Ok(ending);
    }
    match (document.fence.is_empty(), document.rally.is_empty()) {
        (false, true) => Ok(Target::Rows(ListName::Fence)),
        (true, _) => Ok(Target::Rows(ListName::Rally)),
        (false, false) => Err(Failure::new(
            Failure::USAGE,
            "a fence and rally points and no mission: say which (--list fence, --list rally)",
        )),
    }
}

/// The text of the output, and the report.
fn converted(
    document: Document,
    target: Target,
    arguments: &args::Convert,
) -> Result<(String, Report), Failure> {
    let bad = |what: &str| {
        let message = format!("{}: {what}", arguments.input.display());
        Failure::new(Failure::INPUT, message)
    };
    let mut assumed = Vec::new();
    let made_for = document.autopilot;
    let made_by = made_for.map(|autopilot| table::autopilot(autopilot).to_owned());
    let airframe_of = document.airframe.map(|of| format!("a {}", of.name()));
    let made: Vec<String> = made_by.into_iter().chain(airframe_of).collect();
    let autopilot = autopilot(made_for, arguments.autopilot, &mut assumed);
    let airframe = airframe(document.airframe, arguments.airframe, &mut assumed);
    let is_list = document.is_list();
    let repairs = texts(&document.repairs);
    let mut lost = document.dropped.clone();
    let home = home(&document, target, arguments, &mut assumed)?;
    let document = Document {
        home: Some(home),
        autopilot: None,
        ..document
    };
    let mission = document
        .into_mission(autopilot, airframe)
        .map_err(|error| bad(&error.to_string()))?;
    let name = folder::stem(&arguments.input);
    let text = target.text(&mission, &name).map_err(|what| bad(&what))?;
    lost.extend(losses(&mission, target, &made));
    if matches!(target, Target::Plan | Target::Rows(_)) {
        lost.extend(differences(&mission, &text, target).map_err(|what| bad(&what))?);
    }
    let is_foreign = arguments.autopilot.is_some() && made_for != Some(autopilot);
    let count = |of: ListName, items: &[Item]| match target {
        Target::Rows(list) if of != list => 0,
        _ => items.len(),
    };
    let refused = mission::problems(&mission);
    let is_judged = |list| !(is_list && list == mission::MissionType::Mission);
    let report = Report {
        input: arguments.input.display().to_string(),
        output: arguments.output.display().to_string(),
        autopilot: table::autopilot(autopilot),
        mission_items: count(ListName::Mission, &mission.items),
        fence_items: count(ListName::Fence, &mission.fence),
        rally_points: count(ListName::Rally, &mission.rally),
        repairs,
        assumed,
        lost,
        read_differently: match is_foreign {
            true => read_differently(&mission),
            false => Vec::new(),
        },
        stored_otherwise: mission::stored_otherwise(&mission),
        refused: texts(refused.iter().filter(|problem| is_judged(problem.list))),
    };
    Ok((text, report))
}

fn texts<T: ToString>(of: impl IntoIterator<Item = T>) -> Vec<String> {
    of.into_iter().map(|one| one.to_string()).collect()
}

/// What this autopilot reads otherwise than the one for which the file was made.
fn read_differently(mission: &VehicleMission) -> Vec<String> {
    mission::read_differently(mission)
        .into_iter()
        .map(|(what, items)| format!("{}: {what}", ranges("item", &items)))
        .collect()
}

/// Who is to read it: as asked, or as the file says, or ArduPilot.
fn autopilot(
    made_for: Option<Autopilot>,
    asked: Option<AutopilotName>,
    assumed: &mut Vec<String>,
) -> Autopilot {
    let asked = asked.map(|name| match name {
        AutopilotName::Ardupilot => Autopilot::ArduPilot,
        AutopilotName::Px4 => Autopilot::Px4,
    });
    asked.or(made_for).unwrap_or_else(|| {
        assumed.push(
            "the file does not say for which autopilot it is: taken as for ArduPilot (--autopilot)"
                .to_owned(),
        );
        Autopilot::ArduPilot
    })
}

/// What flies it: as asked, or as the file says, or a copter.
fn airframe(
    made_for: Option<Airframe>,
    asked: Option<AirframeName>,
    assumed: &mut Vec<String>,
) -> Airframe {
    let asked = asked.map(AirframeName::airframe);
    if let (Some(file), Some(asked)) = (made_for, asked)
        && file != asked
    {
        assumed.push(format!(
            "the file is for a {}, converted for a {}",
            file.name(),
            asked.name()
        ));
    }
    asked.or(made_for).unwrap_or_else(|| {
        assumed.push(
            "the file does not say what flies it: taken as for a copter (--airframe)".to_owned(),
        );
        Airframe::Copter
    })
}

/// Home as the file has it, or the flag; a `.plan` must have one, a home row may be blank.
fn home(
    document: &Document,
    target: Target,
    arguments: &args::Convert,
    assumed: &mut Vec<String>,
) -> Result<Home, Failure> {
    if let Some(home) = document.home.filter(|home| (home.x, home.y) != (0, 0)) {
        if arguments.home.is_some() {
            assumed.push("home is the file's own: --home is for files without".to_owned());
        }
        return Ok(home);
    }
    if let Some(place) = arguments.home {
        assumed.push("home is where --home says: the file has none".to_owned());
        let at = LatLon {
            lat_deg: place.lat_deg,
            lon_deg: place.lon_deg,
        };
        return Ok(mission::home_at(at, Amsl(place.amsl_m)));
    }
    match target {
        Target::Plan => {
            let message = format!(
                "{}: the file has no home position, and a .plan must have one (--home LAT,LON,AMSL)",
                arguments.input.display()
            );
            return Err(Failure::new(Failure::INPUT, message));
        }
        Target::Rows(ListName::Mission) => {
            assumed.push("the file has no home position: row 0 is blank, which is none".to_owned())
        }
        Target::Rows(_) | Target::Kml | Target::GeoJson => {}
    }
    Ok(NO_HOME)
}

/// The rows of one list. An altitude that is no number would become 0, which is an
/// altitude: refused.
fn rows(mission: &VehicleMission, list: ListName) -> Result<String, String> {
    let items = items(mission, list);
    let open = |item: &&Item| item.place().is_some() && !item.z.is_finite();
    if let Some(index) = items.iter().position(|item| open(&item)) {
        return Err(format!(
            "item {}: the altitude is {}, which such a file cannot say",
            index + 1,
            items[index].z
        ));
    }
    Ok(match list {
        ListName::Mission => formats::waypoints::write(mission),
        ListName::Fence | ListName::Rally => formats::waypoints::write_list(items),
    })
}

fn items(mission: &VehicleMission, list: ListName) -> &[Item] {
    match list {
        ListName::Mission => &mission.items,
        ListName::Fence => &mission.fence,
        ListName::Rally => &mission.rally,
    }
}

const LISTS: [(ListName, &str); 3] = [
    (ListName::Mission, "item"),
    (ListName::Fence, "fence item"),
    (ListName::Rally, "rally point"),
];

/// What the format has no place for.
fn losses(mission: &VehicleMission, target: Target, made: &[String]) -> Vec<String> {
    match target {
        Target::Plan => formats::losses(mission, Format::Plan),
        Target::Rows(list) => {
            let others = LISTS.iter().filter(|(other, _)| *other != list);
            let mut found: Vec<String> = others
                .filter(|(other, _)| !items(mission, *other).is_empty())
                .map(|(other, what)| format!("{} {what}s", items(mission, *other).len()))
                .collect();
            if list != ListName::Mission && mission.home != NO_HOME {
                found.push("home".to_owned());
            }
            found.extend(made.iter().map(|who| format!("that it is for {who}")));
            found
        }
        Target::Kml | Target::GeoJson => of_a_map(&Drawing::of(mission)),
    }
}

fn of_a_map(drawing: &Drawing<'_>) -> Vec<String> {
    let mut found = vec![
        "it is a map: no ground station reads a mission from it".to_owned(),
        "the route is straight between its items: turns, splines, circles and jumps are not drawn"
            .to_owned(),
    ];
    let nowhere = drawing.without_place();
    if !nowhere.is_empty() {
        let items = ranges("item", &nowhere);
        found.push(format!("{items}: no place on a map"));
    }
    if !drawing.without_altitude().is_empty() {
        let items = ranges("item", drawing.without_altitude());
        found.push(format!(
            "{items}: the altitude above the sea is not known from the file alone, and so not \
             drawn, nor are those of the route"
        ));
    }
    found.extend(drawing.lost());
    found
}

/// What does not come back from the text as it was, list by list.
fn differences(
    mission: &VehicleMission,
    text: &str,
    target: Target,
) -> Result<Vec<String>, String> {
    let unreadable = |error: formats::FormatError| {
        format!("the format cannot say this mission, nothing was written: {error}")
    };
    let (_, mut document) = formats::read(text.as_bytes()).map_err(unreadable)?;
    document.autopilot = None;
    let written = document.home;
    let home = written.unwrap_or(NO_HOME);
    document.home = Some(home);
    let back = document
        .into_mission(mission.autopilot, mission.airframe)
        .map_err(unreadable)?;
    let mut found = Vec::new();
    if matches!(target, Target::Plan | Target::Rows(ListName::Mission)) && home != mission.home {
        let home = written.map_or("none".to_owned(), |home| home.to_string());
        found.push(format!("home: {} becomes {home}", mission.home));
    }
    for (list, what) in LISTS {
        if target == Target::Plan || target == Target::Rows(list) {
            found.extend(changes(what, items(mission, list), items(&back, list)));
        }
    }
    Ok(found)
}

fn print(report: &Report) -> Result<(), Failure> {
    for (head, all) in [
        ("read: ", &report.repairs),
        ("note: ", &report.assumed),
        ("not kept: ", &report.lost),
        ("read differently: ", &report.read_differently),
        ("stored: ", &report.stored_otherwise),
        ("refused or misread: ", &report.refused),
    ] {
        for one in all.iter().take(MAX_LISTED) {
            note(&format!("{head}{one}"));
        }
        if let Some(more) = all.len().checked_sub(MAX_LISTED).filter(|&more| more > 0) {
            note(&format!("{head}{more} more (--json lists all)"));
        }
    }
    out(&format!(
        "{}: {}, {}, {}, for {}",
        report.output,
        count(report.mission_items, "mission item"),
        count(report.fence_items, "fence item"),
        count(report.rally_points, "rally point"),
        report.autopilot
    ))
}
