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
    /// Send although verification fails, or the vehicle is armed or not the one in the spec
    #[arg(long)]
    pub(super) force: bool,
    /// Print one JSON document instead of the table
    #[arg(long)]
    pub(super) json: bool,
}
