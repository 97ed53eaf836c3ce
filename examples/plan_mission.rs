//! Plans a mission from code: a spec in, judged mission files out.
//!
//! ```sh
//! cargo run --release --example plan_mission missions/first.yaml
//! ```
#![expect(clippy::print_stdout, reason = "an example talks to its reader")]

use std::error::Error;

use sortie::{Mission, files, plan};

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args()
        .nth(1)
        .unwrap_or_else(|| "missions/first.yaml".to_owned());
    let mission = Mission::read(path)?;

    // Search, encode and verify; an infeasible mission is a verdict, not an error.
    let found = plan(&mission);

    for (vehicle, plan) in mission.spec().vehicles.iter().zip(&found.plan.vehicles) {
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
    for (name, text) in files(&mission, &found) {
        println!("{name}: {} bytes", text.len());
    }
    Ok(())
}
