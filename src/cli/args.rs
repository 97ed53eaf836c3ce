//! What was typed.

use std::path::PathBuf;

use clap::{Parser, Subcommand};

/// One mission spec in, verified collision-free MAVLink missions for a whole fleet out.
#[derive(Debug, Parser)]
#[command(name = "sortie", version, max_term_width = 100, after_help = EXIT_CODES)]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub(super) command: Command,
}

const EXIT_CODES: &str = "Exit codes: 0 done and verified; 1 internal, or output not writable; 2 usage; \
                          3 bad spec or input file; 4 nothing that passes verification; 5 transfer failed.";

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Plan, verify and write everything; with --upload also transfer it
    Plan(Plan),
    /// Check a spec without planning
    Check(Check),
    /// Judge mission files against a spec
    Review(Review),
    /// Verify again, transfer to the vehicles, read back and compare
    Upload(Upload),
    /// Read mission, fence and rally points from a vehicle into a file
    Download(Download),
    /// Run the simulated vehicles of a spec, for any ground station, until Ctrl-C
    Vehicles(Vehicles),
    /// Run the paper's experiment
    #[command(subcommand)]
    Study(Study),
    /// Print the JSON Schema of the spec
    Schema,
    /// Print a completion script
    Completions {
        /// Which shell
        shell: clap_complete::Shell,
    },
}

#[derive(Debug, clap::Args)]
pub(super) struct Plan {
    /// The mission spec (YAML)
    pub(super) spec: PathBuf,
    /// Output folder, replaced as a whole [default: out/<name>]
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Seed instead of the spec's
    #[arg(long, value_name = "N")]
    pub(super) seed: Option<u64>,
    /// Transfer to every vehicle's link; nothing is sent unless the whole fleet passes
    #[arg(long)]
    pub(super) upload: bool,
    /// Print one JSON document instead of the table
    #[arg(long)]
    pub(super) json: bool,
}

#[derive(Debug, clap::Args)]
pub(super) struct Check {
    /// The mission spec (YAML)
    pub(super) spec: PathBuf,
}

#[derive(Debug, clap::Args)]
pub(super) struct Review {
    /// The spec (*.yaml) and mission files (.waypoints, .plan); <id>.* belongs to vehicle <id>
    #[arg(required = true, value_name = "SPEC and FILES")]
    pub(super) files: Vec<PathBuf>,
    /// The mission file of one vehicle, whatever its name
    #[arg(long, value_name = "ID=FILE")]
    pub(super) vehicle: Vec<String>,
    /// Print review.json instead of the table
    #[arg(long)]
    pub(super) json: bool,
    /// Write the review page to this file
    #[arg(long, value_name = "FILE")]
    pub(super) html: Option<PathBuf>,
}

#[derive(Debug, clap::Args)]
pub(super) struct Upload {
    /// A folder written by `plan`; with --spec, mission files instead
    #[arg(required = true, value_name = "DIR or FILES")]
    pub(super) paths: Vec<PathBuf>,
    /// Judge and transfer the given files against this spec
    #[arg(long, value_name = "SPEC")]
    pub(super) spec: Option<PathBuf>,
    /// Reach a vehicle elsewhere: sim, udpout:HOST:PORT, udpin:HOST:PORT, tcp:HOST:PORT
    #[arg(long, value_name = "ID=ADDR")]
    pub(super) link: Vec<String>,
    /// Say what would be sent, and send nothing
    #[arg(long)]
    pub(super) dry_run: bool,
    /// Capture every frame sent and received: a file, or a folder for one named after the time
    #[arg(long, value_name = "FILE or DIR")]
    pub(super) tlog: Option<PathBuf>,
    /// Send although verification fails, or the vehicle is armed or not the one in the spec
    #[arg(long)]
    pub(super) force: bool,
    /// Print one JSON document instead of the table
    #[arg(long)]
    pub(super) json: bool,
}

#[derive(Debug, clap::Args)]
pub(super) struct Download {
    /// How the vehicle is reached: udpout:HOST:PORT, udpin:HOST:PORT, tcp:HOST:PORT
    #[arg(long, value_name = "ADDR")]
    pub(super) link: String,
    /// Its system id [default: the only one on the link]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..))]
    pub(super) sysid: Option<u8>,
    /// The file to write, .plan or .waypoints
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: PathBuf,
}

#[derive(Debug, clap::Args)]
pub(super) struct Vehicles {
    /// The mission spec (YAML)
    pub(super) spec: PathBuf,
    /// UDP port of the first vehicle, one more for each further one; 0 for any free ones
    #[arg(long, value_name = "PORT", default_value_t = 14550)]
    pub(super) port: u16,
    /// Speak to this ground station at once, instead of waiting to be spoken to
    #[arg(long, value_name = "HOST:PORT")]
    pub(super) speak_to: Option<String>,
    /// What all of them play [default: the autopilots in the spec]
    #[arg(long, value_enum, value_name = "AUTOPILOT")]
    pub(super) profile: Option<ProfileName>,
    /// Frames lost in each direction, percent
    #[arg(long, value_name = "PERCENT", default_value_t = 0.0, value_parser = percent)]
    pub(super) loss: f64,
    /// How long a frame takes in each direction, milliseconds
    #[arg(long, value_name = "MS", default_value_t = 0)]
    pub(super) delay: u64,
    /// Seed of the losses
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(super) seed: u64,
    /// End after this time instead of at Ctrl-C
    #[arg(long = "for", value_name = "SECONDS")]
    pub(super) for_s: Option<u64>,
}

/// What a simulated vehicle plays.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(super) enum ProfileName {
    /// ArduCopter
    Ardupilot,
    /// PX4
    Px4,
    /// An autopilot that does not say which
    Generic,
}

fn percent(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|percent| (0.0..=100.0).contains(percent))
        .ok_or_else(|| "not a number from 0 to 100".to_owned())
}

#[derive(Debug, Subcommand)]
pub(super) enum Study {
    /// Seven algorithms on three maps, many times
    Paper(Paper),
    /// Make one study of its shards
    Merge(Merge),
}

#[derive(Debug, clap::Args)]
pub(super) struct Paper {
    /// Maps (YAML with `frame: local`) instead of the three that come with the program
    #[arg(value_name = "MAPS")]
    pub(super) maps: Vec<PathBuf>,
    /// Output folder
    #[arg(long, value_name = "DIR")]
    pub(super) out: PathBuf,
    /// Runs of each algorithm on each map
    #[arg(long, value_name = "N", default_value_t = 40)]
    pub(super) runs: usize,
    /// Iterations
    #[arg(long, value_name = "N", default_value_t = 200)]
    pub(super) iterations: usize,
    /// Population size
    #[arg(long, value_name = "M", default_value_t = 100)]
    pub(super) population: usize,
    /// Free control points instead of the maps' own
    #[arg(long, value_name = "D")]
    pub(super) control_points: Option<usize>,
    /// Seed of the first run; each later run has the next
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(super) seed: u64,
    /// Also run MSFOA without its parts
    #[arg(long)]
    pub(super) ablations: bool,
    /// Also read what the paper leaves open in other ways
    #[arg(long)]
    pub(super) readings: bool,
    /// Search the objective as printed, gaps and all; the default planner then stays away
    #[arg(long)]
    pub(super) printed_objective: bool,
    /// Make only part I of N, for `study merge`
    #[arg(long, value_name = "I/N", value_parser = super::study::parse_shard)]
    pub(super) shard: Option<(usize, usize)>,
    /// Go on with what is in the folder
    #[arg(long)]
    pub(super) resume: bool,
}

#[derive(Debug, clap::Args)]
pub(super) struct Merge {
    /// Folders of all shards
    #[arg(required = true, value_name = "DIRS")]
    pub(super) shards: Vec<PathBuf>,
    /// Output folder
    #[arg(long, value_name = "DIR")]
    pub(super) out: PathBuf,
}
