//! `sortie fly`: launch the fleet, watch it, judge what it flew.

mod call;
mod flying;
mod journal;
mod settings;
mod show;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::args;
use super::folder::runs;
use super::print::console::{Paint, note_lines};
use super::print::failure::Failure;
use super::print::table;
use super::review;
use super::transfer::upload;
use crate::flight::{Assignment, Event, Fleet, Options, Outcome, Reference};
use crate::link::Links;
use crate::mission::{VehicleMission, command, cruise_speed_mps};
use crate::simulator;
use crate::simulator::{Running, Simulated, Surroundings};
use crate::spec::{Link, MissionSpec, Retiming, SpecFile};
use crate::verify::{self, Review};
use crate::world::{self, World};

pub(super) use call::{Call, Said};
use flying::Flying;
pub(super) use show::report;

/// Between two positions of a vehicle, seconds of its own time.
const POSITION_S: f64 = 0.2;

/// A plan that was read back from its folder and verified again.
pub(super) struct Sorties {
    pub(super) file: SpecFile,
    pub(super) folder: PathBuf,
    pub(super) world: World,
    pub(super) missions: Vec<(usize, VehicleMission)>,
    review: Review,
}

pub(super) fn run(arguments: &args::Fly) -> Result<(), Failure> {
    let sorties = read(&arguments.spec, arguments.dir.as_deref())?;
    let _held = runs::hold(&runs::folder(&sorties.folder), "fly")?;
    let told = upload::links(&sorties.file, &arguments.link)?;
    let (simulated, links) = reach(arguments, &sorties, &told)?;
    let references = references(&sorties);
    let fleet = |open: &Links, now| {
        let assignments = assignments(arguments, &sorties, &references, &simulated, open);
        let options = Options {
            speedup: arguments.speedup,
            set_params: arguments.set_params,
            force: arguments.force,
            on_link_loss: sorties.file.spec.on_link_loss,
            position_s: POSITION_S,
        };
        Fleet::new(assignments, options, open.us(), now)
    };
    let systems: Vec<(u8, &Link)> = sorties
        .missions
        .iter()
        .zip(&links)
        .map(|((vehicle, _), link)| (sorties.file.spec.vehicles[*vehicle].sysid, link))
        .collect();
    let open = Links::open(&systems)
        .map_err(|(link, error)| Failure::new(Failure::TRANSFER, format!("{link}: {error}")))?;
    let call = Call::new(&sorties, &links, arguments.speedup);
    let mut flying = Flying::begin(&sorties, &open, &call, arguments, !simulated.is_empty())?;
    let mut fleet = fleet(&open, flying.now());
    flying.note_plans(&sorties, &references)?;
    call.announce(None)?;
    flying.fly(&mut fleet);
    // Nobody can be reached there any more.
    call.withdraw(fleet.outcome() == Some(&Outcome::Flown));
    flying.end(&fleet, &sorties, arguments)
}

/// The plan in its folder, of the spec that was named, verified again.
pub(super) fn read(spec: &Path, dir: Option<&Path>) -> Result<Sorties, Failure> {
    let asked = SpecFile::read(spec)?;
    let folder = match dir {
        Some(dir) => dir.to_owned(),
        None => Path::new("out").join(&asked.spec.name),
    };
    if !folder.is_dir() {
        let message = format!(
            "{}: no plan there; make it first: sortie plan {}",
            folder.display(),
            spec.display()
        );
        return Err(Failure::new(Failure::INPUT, message));
    }
    let (mut file, files, folder) = upload::from_folder(&[folder], false)?;
    told_apart(&file.spec)?;
    if file.text != asked.text || file.table != asked.table {
        let message = format!(
            "{} was planned from another spec than {}; nothing was started",
            folder.display(),
            spec.display()
        );
        return Err(Failure::new(Failure::VERDICT, message));
    }
    let world = world::load(&file)?;
    let mut missions = review::read(&file, &files)?;
    settings::read(&file.spec, &folder, &mut missions)?;
    let judged: Vec<(usize, &VehicleMission)> = missions.iter().map(|(v, m)| (*v, m)).collect();
    let review = verify::review(&file.spec, &world, &judged);
    if !review.passes() {
        note_lines(&table::failures(&review, Paint::for_stdout()));
        let message = "the missions do not pass verification; nothing was started";
        return Err(Failure::new(Failure::VERDICT, message));
    }
    settle(&mut file.spec, &missions, &review);
    settings::refuse_edited(&file.spec, &folder, &missions)?;
    Ok(Sorties {
        file,
        folder,
        world,
        missions,
        review,
    })
}

/// What the spec leaves open is as the missions have it: their departures and speeds.
fn settle(spec: &mut MissionSpec, missions: &[(usize, VehicleMission)], review: &Review) {
    for ((index, mission), track) in missions.iter().zip(&review.tracks) {
        let vehicle = &mut spec.vehicles[*index];
        if let (Some(_), Some(first)) = (vehicle.retiming.depart_s, track.moments.first()) {
            vehicle.depart_s = first.t_s;
        }
        if let (Some(span), Some(speed_mps)) =
            (vehicle.retiming.speed_mps, cruise_speed_mps(mission))
        {
            // What lies outside is found when the parameters are compared.
            vehicle.speed_mps = speed_mps.clamp(span.least, span.most);
        }
        vehicle.retiming = Retiming::default();
    }
}

/// In the air vehicles are told apart by system id alone, whatever their link.
pub(super) fn told_apart(spec: &MissionSpec) -> Result<(), Failure> {
    for (index, vehicle) in spec.vehicles.iter().enumerate() {
        let mut earlier = spec.vehicles[..index].iter();
        if let Some(other) = earlier.find(|other| other.sysid == vehicle.sysid) {
            let message = format!(
                "{} and {} have one system id, {}: such a fleet is uploaded, and started from ground stations",
                other.id, vehicle.id, vehicle.sysid
            );
            return Err(Failure::new(Failure::VERDICT, message));
        }
    }
    Ok(())
}

/// Starts the simulated vehicles, and says where each vehicle is reached.
fn reach(
    arguments: &args::Fly,
    sorties: &Sorties,
    told: &[(usize, Link)],
) -> Result<(BTreeMap<usize, Running>, Vec<Link>), Failure> {
    let mut simulated = BTreeMap::new();
    let mut links = Vec::new();
    let spec = &sorties.file.spec;
    let terrain = Arc::new(sorties.world.terrain.clone());
    for (index, mission) in &sorties.missions {
        let link = upload::link_of(&sorties.file, *index, told).clone();
        if link != Link::Sim {
            links.push(link);
            continue;
        }
        let this = &spec.vehicles[*index];
        let params = mission.params.iter();
        let surroundings = Surroundings {
            terrain: Some(Arc::clone(&terrain)),
            wind: spec.wind,
            heading_rad: this
                .wing
                .and_then(|wing| wing.takeoff_heading_rad)
                .unwrap_or(0.0),
            noise_m: arguments.noise,
            seed: spec.planner.seed,
            params: params.map(|p| (p.name.clone(), p.value)).collect(),
        };
        let home = Some(mission.home);
        let vehicle = Simulated {
            airframe: this.airframe,
            ..Simulated::on_loopback(this.autopilot.into(), this.sysid, home)
        };
        let running =
            simulator::spawn_in(&vehicle, surroundings, arguments.speedup).map_err(|error| {
                let message = format!("{}: the simulated vehicle does not start: {error}", this.id);
                Failure::new(Failure::TRANSFER, message)
            })?;
        links.push(Link::UdpOut(running.address().to_string()));
        simulated.insert(*index, running);
    }
    Ok((simulated, links))
}

/// The planned flights, in the order of the missions.
fn references(sorties: &Sorties) -> Vec<Reference> {
    sorties
        .missions
        .iter()
        .zip(&sorties.review.tracks)
        .map(|((_, mission), track)| Reference::new(mission, track, &sorties.world))
        .collect()
}

fn assignments<'a>(
    arguments: &args::Fly,
    sorties: &'a Sorties,
    references: &[Reference],
    simulated: &BTreeMap<usize, Running>,
    open: &Links,
) -> Vec<Assignment<'a>> {
    let fleet = &sorties.file.spec.vehicles;
    sorties
        .missions
        .iter()
        .zip(references)
        .map(|((index, mission), reference)| Assignment {
            vehicle: &fleet[*index].id,
            sysid: fleet[*index].sysid,
            link: open.number(fleet[*index].sysid).unwrap_or_default(),
            mission,
            reference: reference.clone(),
            start_s: if waits_itself(mission) {
                0.0
            } else {
                fleet[*index].depart_s
            },
            upload: arguments.upload || simulated.contains_key(index),
        })
        .collect()
}

/// Whether the delay before the takeoff is in the mission: then it is not waited for here too.
fn waits_itself(mission: &VehicleMission) -> bool {
    let before = mission.items.iter().take_while(|item| {
        ![command::NAV_TAKEOFF, command::NAV_VTOL_TAKEOFF].contains(&item.command)
    });
    before
        .into_iter()
        .any(|item| item.command == command::NAV_DELAY)
}

/// An event as a line.
fn sentence(event: &Event) -> String {
    let at = event
        .t_s
        .map_or_else(String::new, |t_s| format!("T0+{} ", table::clock(t_s)));
    match &event.vehicle {
        Some(vehicle) => format!("{at}{vehicle}: {}", event.text),
        None => format!("{at}{}", event.text),
    }
}
