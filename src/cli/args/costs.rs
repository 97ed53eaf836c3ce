//! Arguments of `certify` and `evaluate`.

use std::path::PathBuf;

pub(super) const EVALUATE: &str = "A candidate is 3 x control_points numbers, in the unit cube for a path within the area: first \
                        the east of every free control point in parts of the area's box, then the north, then the \
                        altitude in parts of the range from the lowest ground to the ceiling. One line in, one line \
                        with its cost out; with --binary 8 bytes little-endian for each number and each cost. \
                        Complete candidates are answered at once: write a batch, read as many costs. \
                        A path too far out to be measured costs inf. An invalid candidate (a blank line, too) \
                        ends the program with code 3 and its row, after the rows before it are answered. \
                        Earlier vehicles of the spec are planned first, and the candidate is judged against them.";

pub(super) const CERTIFY: &str = "\
The folder gets certificate.json; one that `plan` has written keeps its files. \
`tools/check_certificate.py SPEC DIR` (Python with numpy, shapely, PyYAML) reads spec, terrain and certificate by itself and accepts \
or rejects it. A bound takes minutes for each vehicle; with --within it is the best by then, and another time may give another.";

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Certify {
    /// The mission spec (YAML)
    pub(in crate::cli) spec: PathBuf,
    /// Folder for certificate.json: of a plan of this spec, or a new one
    #[arg(value_name = "DIR")]
    pub(in crate::cli) folder: PathBuf,
    /// Only this vehicle
    #[arg(long, value_name = "ID")]
    pub(in crate::cli) vehicle: Option<String>,
    /// Most cells of the mesh from start to goal: half as many take about an eighth of the time
    #[arg(long, value_name = "N", default_value_t = 320, value_parser = cells)]
    pub(in crate::cli) cells: usize,
    /// Stop after about this time, all vehicles together, with the best bound by then
    #[arg(long, value_name = "S", value_parser = super::seconds)]
    pub(in crate::cli) within: Option<f64>,
    /// Print the bounds as JSON
    #[arg(long)]
    pub(in crate::cli) json: bool,
}

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Evaluate {
    /// The mission spec (YAML), or a map with `frame: local`, under the operational objective
    pub(in crate::cli) spec: PathBuf,
    /// The vehicle to evaluate
    #[arg(long, value_name = "ID")]
    pub(in crate::cli) vehicle: String,
    /// Little-endian f64 instead of lines
    #[arg(long)]
    pub(in crate::cli) binary: bool,
    /// Samples of the path instead of the spec's; results are judged at 2001
    #[arg(long, value_name = "K", value_parser = samples)]
    pub(in crate::cli) samples: Option<usize>,
    /// Print the number of dimensions of a candidate, and exit
    #[arg(long)]
    pub(in crate::cli) dimension: bool,
}

fn cells(text: &str) -> Result<usize, String> {
    text.parse()
        .ok()
        .filter(|cells| (20..=320).contains(cells))
        .ok_or_else(|| "not a whole number from 20 to 320".to_owned())
}

fn samples(text: &str) -> Result<usize, String> {
    text.parse()
        .ok()
        .filter(|samples| (2..=100_000).contains(samples))
        .ok_or_else(|| "not a whole number from 2 to 100000".to_owned())
}
