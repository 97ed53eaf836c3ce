//! The plan that a fleet flies: read back from its folder and verified again.

use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::flight::conformance::reference::ReferenceTrajectory;
use crate::flight::error::FlightError;
use crate::flight::itinerary::plan_file::itineraries;
use crate::flight::itinerary::stops::Itinerary;
use crate::flight::session::vehicle::Assignment;
use crate::formats;
use crate::link::Links;
use crate::mission::{self, Parameter, VehicleMission, command, cruise_speed_mps};
use crate::numeric::text::read_regular;
use crate::simulator::{self, Running, Simulated, Surroundings};
use crate::spec::{Link, MissionSpec, Retiming, SpecFile, Vehicle};
use crate::verify::{self, Review};
use crate::world::World;

/// Why a plan without this file is not flown.
const MISSING: &str = "is missing: `plan` writes one for each vehicle, with the parameters that the verdict assumes \
     of it; plan again; nothing was started";
/// Share of a speed or an altitude of home that its encoding in a mission may lose.
const ENCODING_SHARE: f32 = 1e-4;

/// A plan that was read back from its folder and verified again.
#[derive(Debug)]
pub struct FlightPlan {
    /// The spec; departures and speeds that it leaves open are those of the missions.
    pub file: SpecFile,
    /// The folder that `plan` wrote.
    pub folder: PathBuf,
    /// The world of the spec.
    pub world: World,
    /// The missions, each with the index of its vehicle in the spec.
    pub missions: Vec<(usize, VehicleMission)>,
    /// What each vehicle of the spec does on its way.
    pub(crate) itineraries: Vec<Itinerary>,
    pub(crate) review: Review,
}

impl FlightPlan {
    /// Verifies missions again, with the parameters of their `.params` files in `folder`.
    ///
    /// # Errors
    /// [`FlightError::Input`] for a parameter file that cannot be read, [`FlightError::Rejected`]
    /// for missions that do not pass, [`FlightError::Verdict`] for two vehicles of one system id
    /// and for parameters that are not those of the plan.
    pub fn verify(
        mut file: SpecFile,
        folder: PathBuf,
        world: World,
        mut missions: Vec<(usize, VehicleMission)>,
    ) -> Result<Self, FlightError> {
        for (index, mission) in &mut missions {
            mission.params = read_params(&params_path(&folder, &file.spec.vehicles[*index]))?;
        }
        let judged: Vec<(usize, &VehicleMission)> = missions.iter().map(|(v, m)| (*v, m)).collect();
        let review = verify::review(&file.spec, &world, &judged);
        if !review.passes() {
            return Err(FlightError::Rejected(Box::new(review)));
        }
        adopt_timing(&mut file.spec, &missions, &review);
        refuse_edited_params(&file.spec, &folder, &missions)?;
        let itineraries = read_itineraries(&file.spec, &folder)?;
        Ok(Self {
            itineraries,
            file,
            folder,
            world,
            missions,
            review,
        })
    }

    /// The spec.
    #[must_use]
    pub fn spec(&self) -> &MissionSpec {
        &self.file.spec
    }

    /// The vehicle of a mission, by its index in the spec.
    #[must_use]
    pub fn vehicle(&self, index: usize) -> &Vehicle {
        &self.file.spec.vehicles[index]
    }

    /// The planned flights, in the order of the missions.
    #[must_use]
    pub fn references(&self) -> Vec<ReferenceTrajectory> {
        let missions = self.missions.iter().zip(&self.review.tracks);
        missions
            .map(|((_, mission), track)| ReferenceTrajectory::new(mission, track, &self.world))
            .collect()
    }

    /// The task of each vehicle; `is_uploaded` says which missions are transferred before the
    /// flight, by index in the spec.
    pub fn assignments(
        &self,
        references: &[ReferenceTrajectory],
        links: &Links,
        is_uploaded: impl Fn(usize) -> bool,
    ) -> Vec<Assignment<'_>> {
        let missions = self.missions.iter().zip(references);
        missions
            .map(|((index, mission), reference)| {
                let vehicle = self.vehicle(*index);
                Assignment {
                    vehicle: &vehicle.id,
                    sysid: vehicle.sysid,
                    link: links.number(vehicle.sysid).unwrap_or_default(),
                    mission,
                    reference: reference.clone(),
                    start_s: if has_departure_delay(mission) {
                        0.0
                    } else {
                        vehicle.depart_s
                    },
                    upload: is_uploaded(*index),
                    itinerary: self.itineraries[*index].clone(),
                }
            })
            .collect()
    }

    /// Starts the simulated vehicles, by index in the spec, and puts their addresses in the place
    /// of [`Link::Sim`]. `links` are in the order of the missions; `noise_m` is the standard
    /// deviation of simulated positions, `seed` that of noise and gusts.
    ///
    /// # Errors
    /// [`FlightError::Transfer`]
    pub fn simulate(
        &self,
        links: &mut [Link],
        (noise_m, seed): (f64, u64),
        speedup: f64,
    ) -> Result<BTreeMap<usize, Running>, FlightError> {
        let mut running = BTreeMap::new();
        let terrain = Arc::new(self.world.terrain.clone());
        let missions = self.missions.iter().zip(links);
        for ((index, mission), link) in missions.filter(|(_, link)| **link == Link::Sim) {
            let this = self.vehicle(*index);
            let params = mission.params.iter();
            let surroundings = Surroundings {
                terrain: Some(Arc::clone(&terrain)),
                wind: self.spec().wind,
                heading_rad: this
                    .wing
                    .and_then(|wing| wing.takeoff_heading_rad)
                    .unwrap_or(0.0),
                noise_m,
                seed,
                params: params.map(|p| (p.name.clone(), p.value)).collect(),
            };
            let vehicle = Simulated {
                airframe: this.airframe,
                fence_points: this.fence_points,
                ..Simulated::on_loopback(this.autopilot.into(), this.sysid, Some(mission.home))
            };
            let started = simulator::spawn_in(&vehicle, surroundings, speedup);
            let started = started.map_err(|error| {
                let id = &this.id;
                let message = format!("{id}: the simulated vehicle does not start: {error}");
                FlightError::Transfer(message)
            })?;
            *link = Link::UdpOut(started.address().to_string());
            running.insert(*index, started);
        }
        Ok(running)
    }
}

/// Refuses two vehicles of one system id: in the air it alone identifies them, whatever their link.
///
/// # Errors
/// [`FlightError::Verdict`]
pub fn refuse_shared_sysids(spec: &MissionSpec) -> Result<(), FlightError> {
    for (index, vehicle) in spec.vehicles.iter().enumerate() {
        let mut earlier = spec.vehicles[..index].iter();
        if let Some(other) = earlier.find(|other| other.sysid == vehicle.sysid) {
            return Err(FlightError::Verdict(format!(
                "{} and {} have one system id, {}: such a fleet is uploaded, and started from ground stations",
                other.id, vehicle.id, vehicle.sysid
            )));
        }
    }
    Ok(())
}

/// Departures and speeds that the spec leaves open become those of the missions.
fn adopt_timing(spec: &mut MissionSpec, missions: &[(usize, VehicleMission)], review: &Review) {
    for ((index, mission), track) in missions.iter().zip(&review.tracks) {
        let vehicle = &mut spec.vehicles[*index];
        if let (Some(_), Some(first)) = (vehicle.retiming.depart_s, track.moments.first()) {
            vehicle.depart_s = first.t_s;
        }
        if let (Some(span), Some(speed_mps)) =
            (vehicle.retiming.speed_mps, cruise_speed_mps(mission))
        {
            // The comparison of the parameters finds a speed outside of the span.
            vehicle.speed_mps = speed_mps.clamp(span.least, span.most);
        }
        vehicle.retiming = Retiming::default();
    }
}

/// Whether a mission waits for its departure itself, before the takeoff.
fn has_departure_delay(mission: &VehicleMission) -> bool {
    let takeoffs = [command::NAV_TAKEOFF, command::NAV_VTOL_TAKEOFF];
    let items = mission.items.iter().map(|item| item.command);
    let mut before = items.take_while(|command| !takeoffs.contains(command));
    before.any(|command| command == command::NAV_DELAY)
}

fn params_path(folder: &Path, vehicle: &Vehicle) -> PathBuf {
    folder.join(format!("{}.params", vehicle.id))
}

fn read_params(path: &Path) -> Result<Vec<Parameter>, FlightError> {
    let bad = |why: String| FlightError::Input(format!("{}: {why}", path.display()));
    let text = read_regular(path).map_err(|error| match error.kind() {
        ErrorKind::NotFound => bad(MISSING.to_owned()),
        _ => bad(error.to_string()),
    })?;
    formats::params::read(&text).map_err(|error| bad(error.to_string()))
}

/// Reads what each vehicle does on its way; nothing where the folder has no `plan.json`, which others
/// refuse.
fn read_itineraries(spec: &MissionSpec, folder: &Path) -> Result<Vec<Itinerary>, FlightError> {
    let nothing = vec![Itinerary::default(); spec.vehicles.len()];
    let has_stops = spec.vehicles.iter().any(|of| !of.stops.is_empty());
    if !has_stops && spec.tasks.is_empty() {
        return Ok(nothing);
    }
    let path = folder.join("plan.json");
    let bad = |why: String| FlightError::Input(format!("{}: {why}", path.display()));
    match read_regular(&path) {
        Ok(text) => itineraries(text.as_bytes(), spec).map_err(bad),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(nothing),
        Err(error) => Err(bad(error.to_string())),
    }
}

/// Refuses parameters that are not those of the plan: they would be set on the vehicle, and its
/// own compared with them.
fn refuse_edited_params(
    spec: &MissionSpec,
    folder: &Path,
    missions: &[(usize, VehicleMission)],
) -> Result<(), FlightError> {
    for (index, mission) in missions {
        let fence_margin_m = (!mission.fence.is_empty()).then(|| spec.fence_margin_m());
        let vehicle = &spec.vehicles[*index];
        let home_amsl_m = f64::from(mission.home.amsl_m);
        let planned = mission::parameters(
            vehicle,
            &spec.mission,
            &mission.items,
            home_amsl_m,
            fence_margin_m,
            spec.airspeed_mps(vehicle),
        );
        if let Some(problem) = first_difference(&mission.params, &planned) {
            let path = params_path(folder, vehicle);
            let message = format!("{}: {problem}; nothing was started", path.display());
            return Err(FlightError::Verdict(message));
        }
    }
    Ok(())
}

/// The first difference between the parameters of a file and those of the plan, in words.
fn first_difference(found: &[Parameter], planned: &[Parameter]) -> Option<String> {
    let of = |list: &[Parameter], name: &str| -> Option<f32> {
        list.iter().find(|of| of.name == name).map(|of| of.value)
    };
    for parameter in planned {
        let (name, value) = (&parameter.name, parameter.value);
        let Some(held) = of(found, name) else {
            return Some(format!("{name} is missing, the plan assumes {value}"));
        };
        // Not `>`: a value that is not a number differs.
        let is_same = (held - value).abs() <= ENCODING_SHARE * value.abs().max(1.0);
        if !is_same {
            return Some(format!("{name} is {held}, the plan assumes {value}"));
        }
    }
    let mut names = found.iter().enumerate();
    let stranger = names.find(|(index, one)| {
        of(planned, &one.name).is_none() || found[..*index].iter().any(|of| of.name == one.name)
    });
    stranger.map(|(_, one)| format!("{} = {} is none of the plan's", one.name, one.value))
}
