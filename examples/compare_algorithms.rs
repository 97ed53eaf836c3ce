//! Plans one mission with each variant of MSFOA and compares what they find.
//!
//! ```sh
//! cargo run --release --example compare_algorithms missions/jacksboro.yaml
//! ```
#![expect(clippy::print_stdout, reason = "an example talks to its reader")]

use std::error::Error;
use std::path::Path;

use sortie::plan::{Request, plan_fleet};
use sortie::spec::{Algorithm, SpecFile};
use sortie::world;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args()
        .nth(1)
        .unwrap_or_else(|| "missions/jacksboro.yaml".to_owned());
    let file = SpecFile::read(Path::new(&path))?;
    let world = world::load(&file)?;
    println!(
        "{:14} {:>10} {:>10}  limits kept by",
        "algorithm", "cost", "length"
    );
    for (name, algorithm) in [
        ("msfoa", Algorithm::Msfoa),
        ("msfoa-dwindle", Algorithm::MsfoaDwindle),
        ("msfoa-literal", Algorithm::MsfoaLiteral),
    ] {
        let mut spec = file.spec.clone();
        spec.planner.algorithm = algorithm;
        let request = Request::new(spec.planner.seed);
        let fleet = plan_fleet(&spec, &world, &request);
        let cost: f64 = fleet.vehicles.iter().map(|plan| plan.terms.total()).sum();
        let length_km: f64 = fleet
            .vehicles
            .iter()
            .map(|plan| plan.length_m() / 1000.0)
            .sum();
        let clean = fleet
            .vehicles
            .iter()
            .filter(|plan| plan.terms.is_clean())
            .count();
        println!(
            "{name:14} {cost:10.3} {length_km:7.1} km  {clean} of {}",
            fleet.vehicles.len()
        );
    }
    Ok(())
}
