//! The library: a [`Mission`] is read or built, planned, verified, written and uploaded. The
//! [guide](crate::guide::library) has an example of each step.

use std::io;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use crate::dispatch::{Dispatched, Improving, Stage, dispatch};
use crate::formats;
use crate::link::{Job, Progress, TransferReport, upload_fleet};
use crate::mission::VehicleMission;
use crate::simulator::{self, Running, Simulated};
use crate::spec::{Builder, Incomplete, Link, MissionSpec, SpecError, SpecFile, keys};
use crate::verify::{self, Review};
use crate::world::{self, World};

/// Mark in the name of a mission that failed verification.
pub(crate) const REJECTED: &str = ".REJECTED";

/// A checked spec with its terrain, threats and zones.
#[derive(Clone, Debug)]
pub struct Mission {
    file: SpecFile,
    world: World,
}

impl Mission {
    /// Reads a spec and the terrain that it names.
    ///
    /// # Errors
    /// Every problem of the spec with its line and column, or terrain that cannot be read.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, SpecError> {
        Self::load(SpecFile::read_known(path.as_ref()))
    }

    /// A mission from the text of a spec; files that it names are relative to a folder.
    ///
    /// # Errors
    /// As for [`Self::read`].
    pub fn parse(folder: impl AsRef<Path>, yaml: impl Into<String>) -> Result<Self, SpecError> {
        let path = folder.as_ref().join("spec.yaml");
        Self::load(SpecFile::parse_known(&path, yaml.into()))
    }

    /// Begins a mission in code: version 2 of the spec, with its default buffers and without
    /// vehicles. [`Self::build`] completes it.
    #[must_use]
    pub fn builder(name: &str, area: keys::Area, terrain: keys::Terrain) -> Builder {
        MissionSpec::builder(name, area, terrain).with(|keys| keys.sortie = 2)
    }

    /// A mission made in code; files that it names are relative to a folder.
    ///
    /// # Errors
    /// As for [`Self::read`], by path alone: there are no lines.
    pub fn build(folder: impl AsRef<Path>, builder: &Builder) -> Result<Self, SpecError> {
        let path = folder.as_ref().join(builder.name());
        Self::load(builder.clone().file_known(&path))
    }

    /// The keys of the mission, to change some of them and build it again.
    ///
    /// # Errors
    /// None: the keys are those that were read or built.
    pub fn to_builder(&self) -> Result<Builder, SpecError> {
        self.file.to_builder()
    }

    fn load(file: Result<SpecFile, Box<Incomplete>>) -> Result<Self, SpecError> {
        let file = file.map_err(world::with_ground)?;
        let world = world::load(&file)?;
        Ok(Self { file, world })
    }

    /// The checked spec.
    #[must_use]
    pub fn spec(&self) -> &MissionSpec {
        &self.file.spec
    }

    /// Terrain, threats, zones and area in planning coordinates.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.world
    }
}

/// Plans the fleet with the seed of the spec, encodes and verifies it. Infeasibility is not an
/// error: check [`Review::passes`], whose failed margins name the limits. Uses all threads of
/// rayon's global pool; the result does not depend on their number.
#[must_use]
pub fn plan(mission: &Mission) -> Dispatched {
    plan_with(mission, mission.spec().planner.seed, &|_| {})
}

/// [`plan`] with another seed; `progress` is called from several threads at every change.
#[must_use]
pub fn plan_with(mission: &Mission, seed: u64, progress: &(dyn Fn(Stage) + Sync)) -> Dispatched {
    dispatch(mission.spec(), &mission.world, seed, progress)
}

/// Plans of rising quality with the seed of the spec, each encoded and judged ([`Review::passes`]): the
/// first soon, the last with the evaluations of the spec, each with fewer violated limits or less cost. Warm with an `earlier` plan, of this mission or of one that
/// differs a little. Ends early once `cancel` is set.
pub fn improve<'a>(
    mission: &'a Mission,
    earlier: Option<&'a Dispatched>,
    cancel: &'a AtomicBool,
) -> impl Iterator<Item = Dispatched> + 'a {
    let spec = mission.spec();
    let plans = Improving::new(spec, &mission.world, spec.planner.seed, cancel);
    let plans = match earlier {
        Some(earlier) => plans.from_earlier(&earlier.plan),
        None => plans,
    };
    plans.map(|improved| improved.dispatched)
}

/// The verdict on encoded missions, with the index of the vehicle in the spec.
#[must_use]
pub fn verify(mission: &Mission, missions: &[(usize, VehicleMission)]) -> Review {
    let missions: Vec<_> = missions
        .iter()
        .map(|(vehicle, items)| (*vehicle, items))
        .collect();
    verify::review(mission.spec(), &mission.world, &missions)
}

/// Names and texts of all mission files of a fleet. Those of a vehicle that failed verification
/// have `.REJECTED` in their names.
#[must_use]
pub fn files(mission: &Mission, planned: &Dispatched) -> Vec<(String, String)> {
    let vehicles = &mission.spec().vehicles;
    let (missions, seed) = (planned.missions.iter(), planned.plan.seed);
    missions
        .filter_map(|(vehicle, items)| Some((&vehicles.get(*vehicle)?.id, items)))
        .flat_map(|(id, items)| mission_files(id, (items, seed), planned.review.accepts(id)))
        .collect()
}

/// Names and texts of the files of one vehicle.
pub(crate) fn mission_files(
    id: &str,
    (mission, seed): (&VehicleMission, u64),
    is_accepted: bool,
) -> [(String, String); 3] {
    let tag = if is_accepted { "" } else { REJECTED };
    [
        (
            format!("{id}{tag}.waypoints"),
            formats::waypoints::write(mission),
        ),
        (format!("{id}{tag}.plan"), formats::plan::write(mission)),
        (
            format!("{id}.params"),
            formats::params::write(mission, seed),
        ),
    ]
}

/// Why nothing was sent.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum UploadError {
    /// The fleet does not pass verification.
    #[error("the fleet does not pass verification: {} limits are violated", .0.margins.iter().filter(|margin| !margin.ok).count())]
    Rejected(Box<Review>),
    /// A simulated vehicle, for `link: sim`, could not be started.
    #[error("a simulated vehicle cannot be started: {0}")]
    Simulator(#[from] io::Error),
}

/// Verifies the missions of the whole fleet again, transfers them to the vehicles' links at once,
/// reads them back and compares. `link: sim` starts a simulated vehicle that lives until all
/// transfers are done. Blocks until the last transfer has ended, each within two minutes and 5 s
/// an item. Parameters are not sent.
///
/// # Errors
/// Missions that do not pass, or a simulated vehicle that cannot be started: nothing is sent. A
/// transfer that fails is a report, in the order of the missions.
pub fn upload(
    mission: &Mission,
    missions: &[(usize, VehicleMission)],
) -> Result<Vec<TransferReport>, UploadError> {
    upload_with(mission, missions, &|_, _| {})
}

/// [`upload`]; `progress` gets the id of a vehicle and its progress, from several threads.
///
/// # Errors
/// As for [`upload`].
pub fn upload_with(
    mission: &Mission,
    missions: &[(usize, VehicleMission)],
    progress: &(dyn Fn(&str, Progress) + Sync),
) -> Result<Vec<TransferReport>, UploadError> {
    let review = verify(mission, missions);
    if !review.passes() {
        return Err(UploadError::Rejected(Box::new(review)));
    }
    // What passes has one mission for each vehicle of the spec.
    let vehicles = &mission.spec().vehicles;
    let mut running: Vec<Running> = Vec::new();
    let mut links = Vec::new();
    for (vehicle, items) in missions {
        let this = &vehicles[*vehicle];
        links.push(match &this.link {
            Link::Sim => {
                let simulated = simulator::spawn(&Simulated {
                    airframe: this.airframe,
                    fence_points: this.fence_points,
                    ..Simulated::on_loopback(this.autopilot.into(), this.sysid, Some(items.home))
                })?;
                let address = simulated.address().to_string();
                running.push(simulated);
                Link::UdpOut(address)
            }
            link => link.clone(),
        });
    }
    let jobs: Vec<Job<'_>> = missions
        .iter()
        .zip(&links)
        .map(|((vehicle, mission), link)| Job {
            vehicle: &vehicles[*vehicle].id,
            sysid: vehicles[*vehicle].sysid,
            link,
            mission,
            force: false,
        })
        .collect();
    Ok(upload_fleet(&jobs, progress))
}
