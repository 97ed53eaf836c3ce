//! Growth of planning with the size of a fleet: each fleet is planned by `sortie plan` in a
//! process of its own.

mod deliveries;
mod growth;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::store::{StoreError, io_at};
use crate::spec::{SpecError, SpecFile};
use crate::verify::Limit;
use crate::world::{self, World};

pub use deliveries::{DELIVERY_TERRAIN, Deliveries, MAX_DELIVERIES, deliveries, delivery_ground};
pub use growth::{FleetGrowth, FleetRun};

/// An error of a fleet study.
#[derive(Debug, thiserror::Error)]
pub enum FleetError {
    /// A file, folder or program cannot be used.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// `sortie plan` failed.
    #[error("sortie plan {}: {message}", spec.display())]
    Plan {
        /// The mission.
        spec: PathBuf,
        /// Its message.
        message: String,
    },
    /// The ground cannot be loaded.
    #[error(transparent)]
    Ground(#[from] SpecError),
}

/// The read part of `plan.json`, which has a hundred megabytes for a large fleet.
#[derive(Deserialize)]
struct Plan {
    vehicles: Vec<Planned>,
}

#[derive(Deserialize)]
struct Planned {
    cost: Cost,
    evaluations: usize,
    plans: usize,
}

#[derive(Deserialize)]
struct Cost {
    total: Option<f64>,
}

#[derive(Deserialize)]
struct Review {
    margins: Vec<Margin>,
}

#[derive(Deserialize)]
struct Margin {
    what: String,
    ok: bool,
}

#[derive(Deserialize)]
struct Timing {
    cpu_s: Option<f64>,
    memory_mib: Option<f64>,
}

/// The folder of a fleet study; a temporary one is removed at the end.
#[derive(Debug)]
pub struct FleetFolder {
    path: PathBuf,
    is_temporary: bool,
    verdict: i32,
}

impl FleetFolder {
    /// A folder with the terrain; a temporary one without `out`. `verdict` is the exit code of
    /// `sortie plan` for a plan that breaks a limit.
    ///
    /// # Errors
    /// A folder that cannot be written.
    pub fn new(out: Option<&Path>, verdict: i32) -> Result<Self, FleetError> {
        let temporary =
            || std::env::temp_dir().join(format!("sortie-fleet-{}", std::process::id()));
        let folder = Self {
            path: out.map_or_else(temporary, Path::to_owned),
            is_temporary: out.is_none(),
            verdict,
        };
        folder.write(DELIVERY_TERRAIN.0, DELIVERY_TERRAIN.1)?;
        Ok(folder)
    }

    /// Plans fleets of growing size, those up to `compare_to` vehicles also with the
    /// evaluations of the reference. `progress` takes the number of vehicles and evaluations of
    /// each plan before it starts.
    ///
    /// # Errors
    /// Unusable files, and a `sortie plan` that ends without a plan.
    pub fn grow(
        &self,
        sizes: &[usize],
        evaluations: usize,
        compare_to: usize,
        progress: &dyn Fn(usize, usize),
    ) -> Result<FleetGrowth, FleetError> {
        let ground = SpecFile::parse(&self.path.join("fleet.yaml"), delivery_ground())?;
        let world = world::load(&ground)?;
        let mut sizes = sizes.to_vec();
        sizes.sort_unstable();
        sizes.dedup();
        let mut runs = Vec::new();
        for vehicles in sizes {
            progress(vehicles, evaluations);
            let mut run = self.plan(&world, vehicles, evaluations, "")?;
            if vehicles <= compare_to {
                let reference = FleetGrowth::REFERENCE;
                progress(vehicles, reference);
                let reference = self.plan(&world, vehicles, reference, "-reference")?;
                run.reference_cost = Some(reference.cost);
            }
            runs.push(run);
        }
        Ok(FleetGrowth::of(
            evaluations,
            rayon::current_num_threads(),
            runs,
        ))
    }

    /// Writes documents unless the folder is temporary.
    ///
    /// # Errors
    /// Files that cannot be written.
    pub fn keep(&self, documents: [(&str, &str); 2]) -> Result<(), FleetError> {
        for (name, text) in documents.iter().filter(|_| !self.is_temporary) {
            self.write(name, text.as_bytes())?;
        }
        Ok(())
    }

    fn write(&self, name: &str, bytes: &[u8]) -> Result<PathBuf, FleetError> {
        let path = self.path.join(name);
        let folder = path.parent().unwrap_or(&path);
        fs::create_dir_all(folder)
            .and_then(|()| fs::write(&path, bytes))
            .map_err(io_at(&path))?;
        Ok(path)
    }

    /// Plans a fleet as an operator would, and reads the results.
    fn plan(
        &self,
        world: &World,
        vehicles: usize,
        evaluations: usize,
        tag: &str,
    ) -> Result<FleetRun, FleetError> {
        let Deliveries { spec, table } = deliveries(world, vehicles, evaluations);
        // Without buffers, as the best known totals.
        let spec = spec.replacen("sortie: 2", "sortie: 1", 1);
        let name = format!("fleet-{vehicles}");
        self.write(&format!("{name}.csv"), table.as_bytes())?;
        let spec = self.write(&format!("{name}{tag}.yaml"), spec.as_bytes())?;
        let planned = self.path.join(format!("{name}{tag}"));
        let wall_s = run_plan(&spec, &planned, self.verdict)?;
        let timing: Timing = read(&planned.join("timing.json"))?;
        let plan: Plan = read(&planned.join("plan.json"))?;
        let review: Review = read(&planned.join("review.json"))?;
        let broken = || review.margins.iter().filter(|margin| !margin.ok);
        let separation = Limit::Separation.to_string();
        let all = &plan.vehicles;
        Ok(FleetRun {
            vehicles,
            wall_s,
            cpu_s: timing.cpu_s,
            memory_mib: timing.memory_mib,
            evaluations: all.iter().map(|one| one.evaluations).sum(),
            made_again: all.iter().map(|one| one.plans.saturating_sub(1)).sum(),
            violations: broken().count(),
            separations: broken().filter(|margin| margin.what == separation).count(),
            cost: all
                .iter()
                .map(|one| one.cost.total.unwrap_or(f64::INFINITY))
                .sum(),
            reference_cost: None,
        })
    }
}

impl Drop for FleetFolder {
    fn drop(&mut self) {
        if self.is_temporary {
            let _ = fs::remove_dir_all(&self.path);
        }
    }
}

/// Runs `sortie plan` and returns its wall time in seconds. A plan that breaks a limit is a
/// result like any other.
fn run_plan(spec: &Path, out: &Path, verdict: i32) -> Result<f64, FleetError> {
    let program = std::env::current_exe().map_err(io_at(Path::new("sortie")))?;
    #[expect(clippy::disallowed_methods, reason = "wall time is the result")]
    let started = Instant::now();
    let ended = Command::new(&program)
        .arg("plan")
        .arg(spec)
        .arg("--out")
        .arg(out)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .output()
        .map_err(io_at(&program))?;
    let wall_s = started.elapsed().as_secs_f64();
    if ended.status.success() || ended.status.code() == Some(verdict) {
        return Ok(wall_s);
    }
    Err(FleetError::Plan {
        spec: spec.to_owned(),
        message: String::from_utf8_lossy(&ended.stderr).trim().to_owned(),
    })
}

/// One file that `plan` wrote.
fn read<T: DeserializeOwned>(path: &Path) -> Result<T, FleetError> {
    let file = fs::File::open(path).map_err(io_at(path))?;
    let read = serde_json::from_reader(io::BufReader::new(file));
    Ok(read.map_err(|error| io_at(path)(error.into()))?)
}
