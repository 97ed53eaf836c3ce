//! How soon there is a first verified plan: cold, and warm with the plan of a mission that differs
//! a little. Prints processor time of all threads, on Linux, averaged over several runs.
//!
//! ```sh
//! cargo run --release --example improve missions/jacksboro.yaml 20
//! ```
#![expect(clippy::print_stdout, reason = "an example talks to its reader")]

use std::error::Error;
use std::fs;
use std::sync::atomic::AtomicBool;

use sortie::{Mission, dispatch::Dispatched, improve, plan};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next();
    let path = path.unwrap_or_else(|| "missions/jacksboro.yaml".to_owned());
    let runs: u32 = arguments.next().map_or(Ok(20), |text| text.parse())?;

    let mission = Mission::read(&path)?;
    let higher = {
        let keys = mission.to_builder()?;
        let keys = keys.with(|keys| keys.area.min_agl_m += 5.0);
        Mission::build(fs::canonicalize(&path)?.parent().ok_or("no folder")?, &keys)?
    };
    let cold = averaged(runs, || first(&mission, None))?;
    println!("first plan, cold: {cold}");
    let earlier = plan(&mission);
    let warm = averaged(runs, || first(&higher, Some(&earlier)))?;
    println!("first plan of a mission with 5 m more clearance, warm: {warm}");
    Ok(())
}

fn first(mission: &Mission, earlier: Option<&Dispatched>) -> Option<Dispatched> {
    let cancel = AtomicBool::new(false);
    improve(mission, earlier, &cancel).next()
}

fn averaged(
    runs: u32,
    mut plan: impl FnMut() -> Option<Dispatched>,
) -> Result<String, Box<dyn Error>> {
    let before_s = cpu_s()?;
    let mut found = None;
    for _ in 0..runs {
        found = plan();
    }
    let each_ms = 1000.0 * (cpu_s()? - before_s) / f64::from(runs);
    let found = found.ok_or("no plan")?;
    let verdict = if found.review.passes() {
        "pass"
    } else {
        "fail"
    };
    Ok(format!(
        "{each_ms:.0} ms of processor time, {verdict}, cost {:.3}",
        found.plan.cost()
    ))
}

/// Processor time of this process, seconds: fields 14 and 15 after the name of the program.
fn cpu_s() -> Result<f64, Box<dyn Error>> {
    const TICKS: f64 = 100.0;
    let stat = fs::read_to_string("/proc/self/stat")?;
    let (_, rest) = stat.rsplit_once(')').ok_or("no statistics")?;
    let fields: Vec<&str> = rest.split_whitespace().collect();
    let (user, system): (f64, f64) = (fields[11].parse()?, fields[12].parse()?);
    Ok((user + system) / TICKS)
}
