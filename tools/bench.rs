//! `cargo bench`: costs a second, heights a second, and seconds for one vehicle and for
//! three; the least of several tries, because other programs take their share.
//!
//! `cargo bench -- instructions`: instructions of one cost, counted by callgrind (which
//! has to be installed, and knows no AVX-512). A helper of the kernel that is no longer
//! inlined makes it slower several times over and shows here, however busy the machine.

use std::error::Error;
use std::hint::black_box;
use std::io::{self, Write};
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use sortie::cost::{Batch, CostModel, Dispatch, Relief, Scratch};
use sortie::plan::{Request, plan_fleet};
use sortie::spec::{Objective, SpecFile};
use sortie::study::{Population, SpeedCourse, speed};
use sortie::world::{self, World};

/// Places of one reading of heights.
const PLACES: u32 = 100_000;

/// What instructions are counted of.
const COUNTED: [(&str, Objective, Population); 4] = [
    ("local", Objective::Operational, Population::Local),
    ("global", Objective::Operational, Population::Global),
    ("paper-local", Objective::Paper, Population::Local),
    ("paper-global", Objective::Paper, Population::Global),
];

fn main() -> Result<(), Box<dyn Error>> {
    // Cargo adds an argument of its own.
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.first().map(String::as_str) {
        Some("instructions") => instructions(),
        Some("pass") => pass(&arguments[1..]),
        _ => measure(),
    }
}

fn measure() -> Result<(), Box<dyn Error>> {
    let mut out = io::stdout().lock();
    let of = speed(0.3)?;
    writeln!(out, "{} ({}), a second:", of.cpu, of.dispatch)?;
    for (what, rate) in [
        ("costs, local", of.rates.fast_one_thread),
        ("costs, global", of.rates.fast_global_one_thread),
        ("costs, all threads", of.fast_all_threads),
        (
            "costs, two earlier vehicles",
            of.rates.fast_traffic_one_thread,
        ),
        ("costs, plain reference", of.rates.reference_one_thread),
        ("paper's costs, local", of.paper.fast_one_thread),
        (
            "paper's costs, plain reference",
            of.paper.reference_one_thread,
        ),
    ] {
        writeln!(out, "{what:32} {rate:12.0}")?;
    }
    let file = SpecFile::read(Path::new("missions/jacksboro.yaml"))?;
    let world = world::load(&file)?;
    let heights = f64::from(PLACES) / min_s(20, || read_heights(&world));
    writeln!(out, "{:32} {heights:12.0}", "heights")?;
    for vehicles in [1, 3] {
        let mut spec = file.spec.clone();
        spec.vehicles.truncate(vehicles);
        let took_s = min_s(3, || {
            let request = Request::new(1);
            black_box(plan_fleet(&spec, &world, &request));
        });
        writeln!(out, "seconds for {vehicles} of jacksboro {took_s:19.3}")?;
    }
    Ok(())
}

/// Runs this program under callgrind for every level and population.
fn instructions() -> Result<(), Box<dyn Error>> {
    let mut out = io::stdout().lock();
    writeln!(out, "instructions of a cost:")?;
    for level in Dispatch::all()
        .into_iter()
        .filter(|level| level.name() != "avx512")
    {
        for (name, ..) in COUNTED {
            let run = Command::new("valgrind")
                .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
                .arg("--toggle-collect=*evaluate_all*")
                .arg(std::env::current_exe()?)
                .args(["pass", name, level.name()])
                .output()?;
            let told = String::from_utf8_lossy(&run.stderr);
            let collected = told
                .lines()
                .find_map(|line| line.split_once("Collected :"))
                .ok_or("valgrind gives no count")?;
            let count: f64 = collected.1.trim().parse()?;
            let evaluations: f64 = String::from_utf8_lossy(&run.stdout).trim().parse()?;
            let each = count / evaluations;
            writeln!(out, "{:32} {each:12.0}", format!("{} {name}", level.name()))?;
        }
    }
    Ok(())
}

/// Evaluates one population once and prints how many candidates it has.
fn pass(arguments: &[String]) -> Result<(), Box<dyn Error>> {
    let [name, level] = arguments else {
        return Err("which population, by which instructions?".into());
    };
    let counted = COUNTED.iter().find(|counted| counted.0 == name);
    let (_, objective, population) = counted.ok_or("no such population")?;
    let mut levels = Dispatch::all().into_iter();
    let level = levels.find(|dispatch| dispatch.name() == level);
    let course = SpeedCourse::new(*objective)?;
    let model = course
        .model
        .clone()
        .with_dispatch(level.ok_or("no such instructions here")?);
    let batches = course.batches(*population);
    evaluate_all(&model, &batches);
    let count: usize = batches.iter().map(Batch::len).sum();
    writeln!(io::stdout(), "{count}")?;
    Ok(())
}

/// What callgrind looks at.
#[inline(never)]
fn evaluate_all(model: &CostModel, batches: &[Batch]) {
    let mut scratch = Scratch::default();
    for batch in batches {
        let mut costs = vec![0.0; batch.len()];
        model.totals(batch, &mut scratch, &mut costs);
        black_box(&costs);
    }
}

fn read_heights(world: &World) {
    let relief = Relief::new(&world.ground, f64::NAN);
    // A walk over the whole map, row after row.
    let along = |steps: f64, from_m: f64| {
        (0..PLACES)
            .map(|i| from_m + (f64::from(i) * steps).fract() * 25_000.0)
            .collect::<Vec<f64>>()
    };
    let from = world.ground.south_west;
    let (east_m, north_m) = (along(0.01, from.east_m), along(1e-5, from.north_m));
    let mut heights_m = Vec::new();
    relief.read(&east_m, &north_m, &mut heights_m);
    black_box(&heights_m);
}

#[expect(
    clippy::disallowed_methods,
    reason = "wall times are what is asked for"
)]
fn min_s(tries: u32, mut act: impl FnMut()) -> f64 {
    (0..tries)
        .map(|_| {
            let started = Instant::now();
            act();
            started.elapsed().as_secs_f64()
        })
        .fold(f64::INFINITY, f64::min)
}
