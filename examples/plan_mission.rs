//! Plans a mission from code: a spec in, judged mission items out.
//!
//! ```sh
//! cargo run --release --example plan_mission missions/first.yaml
//! ```
#![expect(clippy::print_stdout, reason = "an example talks to its reader")]

use std::error::Error;
use std::path::Path;

use sortie::dispatch::dispatch;
use sortie::formats::waypoints;
use sortie::spec::SpecFile;
use sortie::world;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args()
        .nth(1)
        .unwrap_or_else(|| "missions/first.yaml".to_owned());
    let file = SpecFile::read(Path::new(&path))?;
    let world = world::load(&file)?;

    // Search, encode and verify; an infeasible mission is a verdict, not an error.
    let found = dispatch(&file.spec, &world, file.spec.planner.seed, &|_| {});

    for (vehicle, plan) in file.spec.vehicles.iter().zip(&found.plan.vehicles) {
        let (cost, length_km) = (plan.terms.total(), plan.length_m() / 1000.0);
        println!(
            "{}: cost {cost:.3}, {length_km:.1} km, bound {:.3}",
            vehicle.id, plan.bound
        );
    }
    for margin in &found.review.margins {
        let verdict = if margin.ok { "ok" } else { "FAIL" };
        println!(
            "  {verdict:4} {} {}: {:.1} {} (limit {:.1})",
            margin.vehicle, margin.limit, margin.value, margin.unit, margin.bound
        );
    }
    if let Some((_, mission)) = found.missions.first() {
        print!("{}", waypoints::write(mission));
    }
    Ok(())
}
