//! Uploads a mission to a simulated vehicle over UDP and reads it back.
//!
//! ```sh
//! cargo run --release --example upload_simulated
//! ```
#![expect(clippy::print_stdout, reason = "an example talks to its reader")]

use std::error::Error;
use std::path::Path;

use sortie::dispatch::dispatch;
use sortie::link::{Job, List, upload_fleet};
use sortie::simulator::{Profile, Simulated, spawn};
use sortie::spec::{Link, SpecFile};
use sortie::world;

fn main() -> Result<(), Box<dyn Error>> {
    let file = SpecFile::read(Path::new("missions/first.yaml"))?;
    let world = world::load(&file)?;
    let found = dispatch(&file.spec, &world, 1, &|_| {});
    let (index, mission) = found.missions.first().ok_or("nothing could be encoded")?;
    let vehicle = &file.spec.vehicles[*index];

    // A vehicle that behaves like ArduPilot, on a free port of this machine.
    let simulated = Simulated::on_loopback(Profile::ArduPilot, vehicle.sysid, Some(mission.home));
    let running = spawn(&simulated)?;
    let link = Link::UdpOut(running.address().to_string());
    let (id, sysid) = (vehicle.id.as_str(), vehicle.sysid);
    let job = Job {
        vehicle: id,
        sysid,
        link: &link,
        mission,
        force: false,
    };

    for report in upload_fleet(&[job], &|_, _| {}) {
        let verdict = if report.is_verified() {
            "verified"
        } else {
            "NOT verified"
        };
        println!(
            "{id}: {verdict}; {} items, {} retries, {:.2} s, hash {}",
            report.items, report.retries, report.seconds, report.hash
        );
    }
    println!(
        "the vehicle holds {} mission items",
        running.items(List::Mission).len()
    );
    Ok(())
}
