//! `sortie study fleet`: fleets of growing size, each planned by the whole command `plan`
//! in a process of its own.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::cli::args;
use crate::cli::print::console::{out_json_text, out_text};
use crate::cli::print::failure::Failure;
use crate::cli::print::progress::Progress;
use crate::report::json_text;
use crate::spec::SpecFile;
use crate::study::{
    DELIVERY_TERRAIN, FleetGrowth, FleetRun, deliveries, delivery_ground, write_whole,
};
use crate::world::{self, World};

/// Evaluations that the cost is compared with.
const REFERENCE: usize = 40_000;

/// What the study reads of `plan.json`, of which a large fleet has a hundred megabytes.
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

pub(crate) fn run(arguments: &args::FleetStudy) -> Result<(), Failure> {
    let home = Home::new(arguments.out.as_deref())?;
    let world = home.ground()?;
    let mut sizes = arguments.sizes.clone();
    sizes.sort_unstable();
    sizes.dedup();
    let progress = Progress::start();
    let mut runs = Vec::new();
    for vehicles in sizes {
        progress.say(&format!("{vehicles} vehicles"));
        let mut run = home.plan(&world, vehicles, arguments.evaluations, "")?;
        if vehicles <= arguments.compare_to {
            progress.say(&format!(
                "{vehicles} vehicles, {REFERENCE} evaluations each"
            ));
            let reference = home.plan(&world, vehicles, REFERENCE, "-reference")?;
            run.reference_cost = Some(reference.cost);
        }
        runs.push(run);
    }
    drop(progress);
    let threads = rayon::current_num_threads();
    let growth = FleetGrowth::of(arguments.evaluations, REFERENCE, threads, runs);
    let document = json_text(&growth);
    if home.is_kept {
        for (name, text) in [("fleet.json", &document), ("fleet.md", &growth.table())] {
            let path = home.path.join(name);
            write_whole(&path, text)?;
        }
    }
    if arguments.json {
        out_json_text(&document)
    } else {
        out_text(&format!(
            "deliveries over the Cumberland Mountains, {} evaluations a plan, {threads} threads\n\n{}",
            growth.evaluations_a_plan,
            growth.table().trim_end()
        ))
    }
}

/// The folder of the study; removed with all that is in it unless it is to be kept.
struct Home {
    path: PathBuf,
    is_kept: bool,
}

impl Home {
    fn new(kept: Option<&Path>) -> Result<Self, Failure> {
        let path = kept.map_or_else(
            || std::env::temp_dir().join(format!("sortie-fleet-{}", std::process::id())),
            Path::to_owned,
        );
        let home = Self {
            path,
            is_kept: kept.is_some(),
        };
        home.write(DELIVERY_TERRAIN.0, DELIVERY_TERRAIN.1)?;
        Ok(home)
    }

    fn write(&self, name: &str, bytes: &[u8]) -> Result<PathBuf, Failure> {
        let path = self.path.join(name);
        let written = path
            .parent()
            .map_or(Ok(()), fs::create_dir_all)
            .and_then(|()| fs::write(&path, bytes));
        written.map_err(|error| unusable(&path, &error))?;
        Ok(path)
    }

    /// The ground that all fleets fly over.
    fn ground(&self) -> Result<World, Failure> {
        let file = SpecFile::parse(&self.path.join("fleet.yaml"), delivery_ground())?;
        Ok(world::load(&file)?)
    }

    /// Plans a fleet as an operator would, and reads what came of it.
    fn plan(
        &self,
        world: &World,
        vehicles: usize,
        evaluations: usize,
        tag: &str,
    ) -> Result<FleetRun, Failure> {
        let made = deliveries(world, vehicles, evaluations);
        let name = format!("fleet-{vehicles}");
        self.write(&format!("{name}.csv"), made.table.as_bytes())?;
        let spec = self.write(&format!("{name}{tag}.yaml"), made.spec.as_bytes())?;
        let planned = self.path.join(format!("{name}{tag}"));
        let wall_s = plan(&spec, &planned)?;
        let timing: Timing = read(&planned.join("timing.json"))?;
        let plan: Plan = read(&planned.join("plan.json"))?;
        let review: Review = read(&planned.join("review.json"))?;
        let broken = || review.margins.iter().filter(|margin| !margin.ok);
        let all = &plan.vehicles;
        Ok(FleetRun {
            vehicles,
            wall_s,
            cpu_s: timing.cpu_s,
            memory_mib: timing.memory_mib,
            evaluations: all.iter().map(|one| one.evaluations).sum(),
            made_again: all.iter().map(|one| one.plans.saturating_sub(1)).sum(),
            violations: broken().count(),
            separations: broken()
                .filter(|margin| margin.what == "separation")
                .count(),
            cost: all
                .iter()
                .map(|one| one.cost.total.unwrap_or(f64::INFINITY))
                .sum(),
            reference_cost: None,
        })
    }
}

impl Drop for Home {
    fn drop(&mut self) {
        if !self.is_kept {
            let _ = fs::remove_dir_all(&self.path);
        }
    }
}

/// Runs `sortie plan` and says how long it took, seconds. A fleet that does not pass is a
/// result like any other.
fn plan(spec: &Path, to: &Path) -> Result<f64, Failure> {
    let program = std::env::current_exe().map_err(|error| unusable(Path::new("sortie"), &error))?;
    #[expect(
        clippy::disallowed_methods,
        reason = "wall times are what is asked for"
    )]
    let started = Instant::now();
    let ended = Command::new(&program)
        .arg("plan")
        .arg(spec)
        .arg("--out")
        .arg(to)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .output()
        .map_err(|error| unusable(&program, &error))?;
    let wall_s = started.elapsed().as_secs_f64();
    let code = ended.status.code();
    if ended.status.success() || code == Some(Failure::VERDICT.number()) {
        return Ok(wall_s);
    }
    let said = String::from_utf8_lossy(&ended.stderr);
    let message = format!("sortie plan {}: {}", spec.display(), said.trim());
    Err(Failure::new(Failure::OUTPUT, message))
}

/// One file that `plan` wrote.
fn read<T: DeserializeOwned>(path: &Path) -> Result<T, Failure> {
    let file = fs::File::open(path).map_err(|error| unusable(path, &error))?;
    serde_json::from_reader(io::BufReader::new(file)).map_err(|error| unusable(path, &error.into()))
}

fn unusable(path: &Path, error: &io::Error) -> Failure {
    Failure::new(Failure::OUTPUT, format!("{}: {error}", path.display()))
}
