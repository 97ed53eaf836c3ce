//! `cargo bench`: costs a second, heights a second, and seconds for one vehicle and for
//! three; the least of several tries, because other programs take their share.

use std::io::{self, Write};
use std::path::Path;
use std::time::Instant;

use sortie::cost::Relief;
use sortie::plan::{Request, plan_fleet};
use sortie::spec::SpecFile;
use sortie::study::speed;
use sortie::world::{self, World};

/// Places of one reading of heights.
const PLACES: u32 = 100_000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut out = io::stdout().lock();
    let of = speed(0.3)?;
    writeln!(out, "{} ({}), a second:", of.cpu, of.dispatch)?;
    for (what, rate) in [
        ("costs, local", of.fast_one_thread),
        ("costs, global", of.fast_global_one_thread),
        ("costs, all threads", of.fast_all_threads),
        ("costs, cutoff", of.fast_cutoff_one_thread),
        ("costs, two earlier vehicles", of.fast_traffic_one_thread),
        ("costs, plain reference", of.reference_one_thread),
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
    let heights = f64::from(PLACES) / least_s(20, || read_heights(&world));
    writeln!(out, "{:32} {heights:12.0}", "heights")?;
    for vehicles in [1, 3] {
        let mut spec = file.spec.clone();
        spec.vehicles.truncate(vehicles);
        let took_s = least_s(3, || {
            let request = Request {
                seed: 1,
                margins: Vec::new(),
                extra_parameters: Vec::new(),
                progress: &|_| (),
            };
            std::hint::black_box(plan_fleet(&spec, &world, &request));
        });
        writeln!(out, "seconds for {vehicles} of jacksboro {took_s:19.3}")?;
    }
    Ok(())
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
    std::hint::black_box(&heights_m);
}

#[expect(
    clippy::disallowed_methods,
    reason = "wall times are what is asked for"
)]
fn least_s(tries: u32, mut act: impl FnMut()) -> f64 {
    (0..tries)
        .map(|_| {
            let started = Instant::now();
            act();
            started.elapsed().as_secs_f64()
        })
        .fold(f64::INFINITY, f64::min)
}
