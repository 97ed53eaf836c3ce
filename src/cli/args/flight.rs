//! Arguments of `fly`, `watch` and `replan`.

use std::path::PathBuf;

use crate::flight::SPEEDUP;

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Fly {
    /// The mission spec (YAML) that was planned
    pub(in crate::cli) spec: PathBuf,
    /// The folder that `plan` wrote [default: out/<name>]
    #[arg(long, value_name = "DIR")]
    pub(in crate::cli) dir: Option<PathBuf>,
    /// Link of a vehicle instead of the spec's: sim, udpout:HOST:PORT, udpin:HOST:PORT, tcp:HOST:PORT
    #[arg(long, value_name = "ID=ADDR")]
    pub(in crate::cli) link: Vec<String>,
    /// Transfer the missions first, instead of only comparing those on board
    #[arg(long)]
    pub(in crate::cli) upload: bool,
    /// Set parameters that differ from those that the verdict assumes
    #[arg(long)]
    pub(in crate::cli) set_params: bool,
    /// Speed-up of the vehicles' time over real time: simulators only
    #[arg(long, value_name = "N", default_value_t = 1.0, value_parser = speedup)]
    pub(in crate::cli) speedup: f64,
    /// Standard deviation of the positions of simulated vehicles, metres
    #[arg(long, value_name = "M", default_value_t = 0.0, value_parser = metres)]
    pub(in crate::cli) noise: f64,
    /// Seed of noise and gusts of simulated vehicles [default: that of the spec]
    #[arg(long, value_name = "N")]
    pub(in crate::cli) seed: Option<u64>,
    /// Fly even if parameters, home or position differ from the plan
    #[arg(long)]
    pub(in crate::cli) force: bool,
    /// Take over the flight of this plan in the air after a crash, as `sortie watch` does
    #[arg(long, conflicts_with_all = ["upload", "set_params", "speedup", "noise", "seed", "force"])]
    pub(in crate::cli) resume: bool,
    /// Print flight.json instead of the table
    #[arg(long)]
    pub(in crate::cli) json: bool,
}

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Watch {
    /// The folder that `plan` wrote and that is being flown
    pub(in crate::cli) dir: PathBuf,
    /// Link of a vehicle instead of the one that `fly` used: udpout:HOST:PORT, udpin:HOST:PORT, tcp:HOST:PORT
    #[arg(long, value_name = "ID=ADDR")]
    pub(in crate::cli) link: Vec<String>,
    /// Print flight.json instead of the table
    #[arg(long)]
    pub(in crate::cli) json: bool,
}

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Replan {
    /// The mission spec (YAML) that is being flown
    pub(in crate::cli) spec: PathBuf,
    /// The folder that `plan` wrote [default: out/<name>]
    #[arg(long, value_name = "DIR")]
    pub(in crate::cli) dir: Option<PathBuf>,
    /// New threat to avoid (degrees, metres)
    #[arg(long, value_name = "LAT,LON,RADIUS", allow_hyphen_values = true)]
    pub(in crate::cli) threat: String,
    /// Link of a vehicle instead of the one that `fly` uses: udpout:HOST:PORT, udpin:HOST:PORT, tcp:HOST:PORT
    #[arg(long, value_name = "ID=ADDR")]
    pub(in crate::cli) link: Vec<String>,
    /// Seed instead of the spec's
    #[arg(long, value_name = "N")]
    pub(in crate::cli) seed: Option<u64>,
}

fn speedup(text: &str) -> Result<f64, String> {
    let found = text.parse().ok().filter(|n| SPEEDUP.contains(n));
    let (least, most) = (SPEEDUP.start(), SPEEDUP.end());
    found.ok_or_else(|| format!("not a number from {least} to {most}"))
}

fn metres(text: &str) -> Result<f64, String> {
    let found = text.parse().ok().filter(|n| (0.0..=20.0).contains(n));
    found.ok_or_else(|| "not a number from 0 to 20".to_owned())
}
