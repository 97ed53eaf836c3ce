//! Arguments of `upload` and `download`.

use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Upload {
    /// A folder written by `plan`; with --spec, mission files instead
    #[arg(required = true, value_name = "DIR or FILES")]
    pub(in crate::cli) paths: Vec<PathBuf>,
    /// Judge and transfer the given files against this spec
    #[arg(long, value_name = "SPEC")]
    pub(in crate::cli) spec: Option<PathBuf>,
    /// Link of a vehicle instead of the spec's: sim, udpout:HOST:PORT, udpin:HOST:PORT, tcp:HOST:PORT,
    /// tcpin:HOST:PORT, serial:DEVICE:BAUD
    #[arg(long, value_name = "ID=ADDR")]
    pub(in crate::cli) link: Vec<String>,
    /// Print what would be sent, and send nothing
    #[arg(long)]
    pub(in crate::cli) dry_run: bool,
    /// Capture every frame sent and received: a file, or a folder for one named after the time
    #[arg(long, value_name = "FILE or DIR")]
    pub(in crate::cli) tlog: Option<PathBuf>,
    /// Send even if verification fails, or the vehicle is armed or is not that of the spec
    #[arg(long)]
    pub(in crate::cli) force: bool,
    /// Print one JSON document instead of the table
    #[arg(long)]
    pub(in crate::cli) json: bool,
}

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Download {
    /// Link to the vehicle: udpout:HOST:PORT, udpin:HOST:PORT, tcp:HOST:PORT,
    /// tcpin:HOST:PORT, serial:DEVICE:BAUD
    #[arg(long, value_name = "ADDR")]
    pub(in crate::cli) link: String,
    /// Its system id [default: the only one on the link]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..))]
    pub(in crate::cli) sysid: Option<u8>,
    /// The file to write, .plan or .waypoints
    #[arg(short, long, value_name = "FILE")]
    pub(in crate::cli) output: PathBuf,
}
