//! `sortie vehicles`: the simulated vehicles of a spec, in the foreground.

use std::net::{Ipv4Addr, SocketAddr, ToSocketAddrs};
use std::sync::mpsc;
use std::time::Duration;

use super::args::{self, ProfileName};
use super::print::console::out;
use super::print::failure::Failure;
use super::print::table::Rows;
use crate::link::MissionType;
use crate::mission;
use crate::numeric::digits::count;
use crate::simulator;
use crate::simulator::{Profile, Running, Simulated, Surroundings, Weather};
use crate::spec::{SpecFile, Vehicle};
use crate::world;

pub(super) fn run(arguments: &args::Vehicles) -> Result<(), Failure> {
    let file = SpecFile::read_known(&arguments.spec).map_err(world::with_ground)?;
    let world = world::load(&file)?;
    let speak_to = arguments.speak_to.as_deref().map(resolve).transpose()?;
    let mut running: Vec<Running> = Vec::new();
    let mut rows = Rows::new(&["vehicle", "system", "plays", "link"]);
    for (index, (this, sites)) in file.spec.vehicles.iter().zip(&world.sites).enumerate() {
        let profile = arguments
            .profile
            .map_or(this.autopilot.into(), Profile::from);
        let home = Some(mission::home_at(this.home, sites.home.amsl));
        let port = port(arguments.port, index)?;
        let vehicle = start(
            arguments,
            this,
            Simulated {
                listen: (Ipv4Addr::LOCALHOST, port).into(),
                speak_to,
                ..Simulated::on_loopback(profile, this.sysid, home)
            },
        )?;
        let link = match speak_to {
            Some(ground) => format!("udpin:{ground}"),
            None => format!("udpout:{}", vehicle.address()),
        };
        let plays = match profile {
            Profile::ArduPilot => "ArduPilot",
            Profile::Px4 => "PX4",
            Profile::Generic => "generic",
        };
        rows.add([
            this.id.clone(),
            this.sysid.to_string(),
            plays.to_owned(),
            link,
        ]);
        running.push(vehicle);
    }
    let (stop, stopped) = mpsc::channel();
    #[cfg(unix)]
    stop_at_signals(stop.clone())
        .map_err(|error| Failure::new(Failure::OUTPUT, format!("no signals: {error}")))?;
    ctrlc::set_handler(move || {
        // The receiver is gone if the command ends already.
        let _ = stop.send(());
    })
    .map_err(|error| Failure::new(Failure::OUTPUT, format!("no Ctrl-C: {error}")))?;
    rows.print()?;
    match arguments.for_s {
        Some(seconds) => drop(stopped.recv_timeout(Duration::from_secs(seconds))),
        None => drop(stopped.recv()),
    }
    out(&farewell(&running))
}

/// SIGTERM and SIGHUP end the vehicles as Ctrl-C does.
#[cfg(unix)]
fn stop_at_signals(stop: mpsc::Sender<()>) -> std::io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGTERM};
    let mut signals = signal_hook::iterator::Signals::new([SIGHUP, SIGTERM])?;
    std::thread::spawn(move || {
        if signals.forever().next().is_some() {
            // Nobody listens any more when it is ending anyway.
            let _ = stop.send(());
        }
    });
    Ok(())
}

impl From<ProfileName> for Profile {
    fn from(name: ProfileName) -> Self {
        match name {
            ProfileName::Ardupilot => Self::ArduPilot,
            ProfileName::Px4 => Self::Px4,
            ProfileName::Generic => Self::Generic,
        }
    }
}

/// Starts one simulated vehicle in the weather of the command line.
fn start(
    arguments: &args::Vehicles,
    this: &Vehicle,
    simulated: Simulated,
) -> Result<Running, Failure> {
    let heading_rad = this.wing.and_then(|wing| wing.takeoff_heading_rad);
    let surroundings = Surroundings {
        heading_rad: heading_rad.unwrap_or(0.0),
        ..Surroundings::default()
    };
    let simulated = Simulated {
        airframe: this.airframe,
        fence_points: this.fence_points,
        weather: Weather {
            loss: arguments.loss / 100.0,
            delay_ms: arguments.delay,
            seed: arguments.seed,
        },
        ..simulated
    };
    simulator::spawn_in(&simulated, surroundings, 1.0).map_err(|error| {
        let message = format!("{}: the vehicle does not start: {error}", this.id);
        Failure::new(Failure::TRANSFER, message)
    })
}

/// The items that the vehicles hold in the end.
fn farewell(running: &[Running]) -> String {
    let items = |vehicle: &Running, list| vehicle.items(list).len();
    let holds = |vehicle: &&Running| {
        MissionType::ALL
            .iter()
            .any(|list| items(vehicle, *list) > 0)
    };
    let loaded: Vec<&Running> = running.iter().filter(holds).collect();
    let [mission, fence, rally] =
        MissionType::ALL.map(|list| loaded.iter().map(|one| items(one, list)).sum::<usize>());
    format!(
        "ended: {} of {} were loaded, with {}, {}, {}",
        loaded.len(),
        count(running.len(), "vehicle"),
        count(mission, "mission item"),
        count(fence, "fence item"),
        count(rally, "rally point")
    )
}

/// The port of a vehicle, or any if the first is.
fn port(first: u16, index: usize) -> Result<u16, Failure> {
    if first == 0 {
        return Ok(0);
    }
    u16::try_from(index)
        .ok()
        .and_then(|index| first.checked_add(index))
        .ok_or_else(|| {
            let message = format!("--port {first}: not enough ports up to 65535 for the fleet");
            Failure::new(Failure::USAGE, message)
        })
}

fn resolve(address: &str) -> Result<SocketAddr, Failure> {
    address
        .to_socket_addrs()
        .ok()
        .and_then(|mut addresses| addresses.next())
        .ok_or_else(|| {
            let message = format!("--speak-to {address}: not an address of the form HOST:PORT");
            Failure::new(Failure::USAGE, message)
        })
}
