//! Uploads a mission to a simulated vehicle over UDP and reads it back.
//!
//! ```sh
//! cargo run --release --example upload_simulated
//! ```
#![expect(clippy::print_stdout, reason = "an example talks to its reader")]

use std::error::Error;

use sortie::{Mission, plan, upload_with};

fn main() -> Result<(), Box<dyn Error>> {
    // `link: sim` starts a vehicle that behaves like the autopilot of the spec, on this machine.
    let mission = Mission::read("missions/first.yaml")?;
    let planned = plan(&mission);
    let progress = |id: &str, progress| println!("{id}: {progress:?}");
    for report in upload_with(&mission, &planned.missions, &progress)? {
        let verdict = if report.is_verified() {
            "verified"
        } else {
            "NOT verified"
        };
        println!(
            "{}: {verdict}; {} items, {} retries, {:.2} s, hash {}",
            report.vehicle, report.items, report.retries, report.seconds, report.hash
        );
    }
    Ok(())
}
