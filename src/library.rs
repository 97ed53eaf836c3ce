//! The library in four steps: a [`Mission`] is read or built, planned, verified and uploaded.
//!
//! ```
//! use sortie::{Mission, files, plan, upload, verify};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let mission = Mission::read("missions/first.yaml")?;
//! let planned = plan(&mission);
//! assert!(planned.review.passes());
//! for (name, text) in files(&mission, &planned) {
//!     println!("{name}: {} bytes", text.len());
//! }
//! // The verdict again, as after an edit of the items.
//! assert!(verify(&mission, &planned.missions).passes());
//! // `link: sim` starts a simulated vehicle.
//! for report in upload(&mission, &planned.missions)? {
//!     assert!(report.is_verified());
//! }
//! # Ok(())
//! # }
//! ```
//!
//! The modules below have the parts; they may change between versions, these functions do not.

use std::io;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use crate::dispatch::{Dispatched, Improving, dispatch};
use crate::formats;
use crate::link::{Job, TransferReport, upload_fleet};
use crate::mission::VehicleMission;
use crate::simulator::{self, Running, Simulated};
use crate::spec::{Builder, Link, MissionSpec, SpecError, SpecFile};
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
        Self::load(SpecFile::read(path.as_ref())?)
    }

    /// A mission from the text of a spec; files that it names are relative to a folder.
    ///
    /// # Errors
    /// As for [`Self::read`].
    pub fn parse(folder: impl AsRef<Path>, yaml: impl Into<String>) -> Result<Self, SpecError> {
        let path = folder.as_ref().join("spec.yaml");
        Self::load(SpecFile::parse(&path, yaml.into())?)
    }

    /// A mission made in code; [`MissionSpec::builder`] has an example.
    ///
    /// # Errors
    /// As for [`Self::read`].
    pub fn build(builder: &Builder) -> Result<Self, SpecError> {
        Self::parse(".", builder.yaml())
    }

    fn load(file: SpecFile) -> Result<Self, SpecError> {
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

/// Plans the fleet with the seed of the spec, encodes and verifies it. An infeasible mission is no
/// error: its review fails and names the limits.
#[must_use]
pub fn plan(mission: &Mission) -> Dispatched {
    let spec = mission.spec();
    dispatch(spec, &mission.world, spec.planner.seed, &|_| {})
}

/// Plans of rising quality with the seed of the spec, each encoded and verified: the first soon, the
/// last with the evaluations of the spec. Warm with an `earlier` plan, of this mission or of one that
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
    let mut files = Vec::new();
    let accepted = planned.review.accepted();
    for (vehicle, items) in &planned.missions {
        let id = &mission.spec().vehicles[*vehicle].id;
        files.extend(mission_files(id, items, accepted.contains(id.as_str())));
    }
    files
}

/// Names and texts of the files of one vehicle.
pub(crate) fn mission_files(
    id: &str,
    mission: &VehicleMission,
    is_accepted: bool,
) -> [(String, String); 3] {
    let tag = if is_accepted { "" } else { REJECTED };
    [
        (
            format!("{id}{tag}.waypoints"),
            formats::waypoints::write(mission),
        ),
        (format!("{id}{tag}.plan"), formats::plan::write(mission)),
        (format!("{id}.params"), formats::params::write(mission)),
    ]
}

/// Transfers missions to the vehicles' links at once, reads them back and compares. `link: sim`
/// starts a simulated vehicle that lives until all transfers are done. Whether the missions pass
/// is not asked: see [`verify`].
///
/// # Errors
/// A simulated vehicle that cannot be started. A transfer that fails is a report.
pub fn upload(
    mission: &Mission,
    missions: &[(usize, VehicleMission)],
) -> io::Result<Vec<TransferReport>> {
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
    Ok(upload_fleet(&jobs, &|_, _| {}))
}
