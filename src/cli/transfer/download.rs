//! `sortie download`: the lists on board a vehicle, into a file.

use std::path::Path;

use crate::cli::args;
use crate::cli::folder::replace;
use crate::cli::print::console::{note, out};
use crate::cli::print::failure::Failure;
use crate::cli::print::progress::Progress;
use crate::formats::{self, Document, Format, FormatError};
use crate::link::{self, MissionType, Onboard};
use crate::mission::{Home, VehicleMission};
use crate::numeric::digits::count;
use crate::spec::{Airframe, Autopilot, Link};

pub(crate) fn run(arguments: &args::Download) -> Result<(), Failure> {
    let format = format(&arguments.output)?;
    let link = match Link::parse(&arguments.link) {
        None | Some(Link::Sim) => {
            let message = format!(
                "--link {}: no such link (allowed: udpout:HOST:PORT, udpin:HOST:PORT, tcp:HOST:PORT, tcpin:HOST:PORT, serial:DEVICE:BAUD)",
                arguments.link
            );
            return Err(Failure::new(Failure::USAGE, message));
        }
        Some(link) => link,
    };
    let progress = Progress::start();
    let onboard = link::download(&link, arguments.sysid, &|list, items| {
        progress.say(&format!("{list}: {items} items"));
    });
    drop(progress);
    let onboard = onboard.map_err(|failure| {
        Failure::new(Failure::TRANSFER, format!("{failure}; no file was written"))
    })?;
    let mission = mission_of(&onboard);
    let text = match format {
        Format::Waypoints => formats::waypoints::write(&mission),
        Format::Plan => formats::plan::write(&mission),
    };
    let mut losses = assumptions(&onboard);
    losses.extend(formats::losses(&mission, format));
    losses.extend(reread_differences(&mission, format, &text)?);
    replace::write_file(&arguments.output, text.as_bytes())?;
    for loss in losses {
        note(&format!("note: {loss}"));
    }
    out(&format!(
        "system {} ({}): {}, {}, {} in {}",
        onboard.sysid,
        onboard.description,
        count(mission.items.len(), "mission item"),
        count(mission.fence.len(), "fence item"),
        count(mission.rally.len(), "rally point"),
        arguments.output.display()
    ))?;
    Ok(())
}

fn format(path: &Path) -> Result<Format, Failure> {
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("plan") => Ok(Format::Plan),
        Some("waypoints") => Ok(Format::Waypoints),
        _ => {
            let message = format!("{}: not .plan or .waypoints", path.display());
            Err(Failure::new(Failure::USAGE, message))
        }
    }
}

fn mission_of(onboard: &Onboard) -> VehicleMission {
    VehicleMission {
        // Without ArduPilot's home row: as PX4 counts.
        autopilot: onboard.autopilot.unwrap_or(Autopilot::Px4),
        autopilot_version: None,
        airframe: Airframe::Copter,
        home: onboard.home.unwrap_or(Home {
            x: 0,
            y: 0,
            amsl_m: 0.0,
        }),
        items: onboard.mission.clone(),
        fence: onboard.fence.clone(),
        is_fence_known: !onboard.unknown.contains(&MissionType::Fence),
        rally: onboard.rally.clone(),
        params: Vec::new(),
        notes: Vec::new(),
    }
}

/// What the file says although the vehicle did not.
fn assumptions(onboard: &Onboard) -> Vec<String> {
    let mut losses = Vec::new();
    if onboard.autopilot.is_none() {
        losses.push(format!(
            "the vehicle is a {}: items are counted as PX4 does, without a home row",
            onboard.description
        ));
    }
    if onboard.home.is_none() {
        losses
            .push("the vehicle does not say where its home is: it is 0, 0 in the file".to_owned());
    }
    for list in &onboard.unknown {
        losses.push(format!("the vehicle keeps no {list} items"));
    }
    losses
}

/// Whether the file says what the vehicle holds.
fn reread_differences(
    mission: &VehicleMission,
    format: Format,
    text: &str,
) -> Result<Option<String>, Failure> {
    let read: Result<Document, FormatError> = match format {
        Format::Waypoints => formats::waypoints::read(text),
        Format::Plan => formats::plan::read(text),
    };
    let read = read.and_then(|document| {
        Document {
            autopilot: None,
            ..document
        }
        .into_mission(mission.autopilot, mission.airframe)
    });
    match read {
        Ok(read) if read.items == mission.items => Ok(None),
        Ok(read) => {
            let pairs = read.items.iter().zip(&mission.items);
            let same = pairs.filter(|(read, held)| read == held).count();
            Ok(Some(format!(
                "of {} mission items {same} come back from the file exactly as they are on board",
                mission.items.len()
            )))
        }
        Err(error) => Err(Failure::new(
            Failure::TRANSFER,
            format!("the vehicle holds what the file cannot say; no file was written: {error}"),
        )),
    }
}
