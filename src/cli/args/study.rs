//! Arguments of `sortie study`.

use std::path::PathBuf;

use clap::Subcommand;

#[derive(Debug, Subcommand)]
pub(in crate::cli) enum Study {
    /// Seven algorithms on three maps, many times
    Paper(Paper),
    /// The default planner against the best paths known: many seeds, many missions
    Planner(Planner),
    /// Make one study of its shards
    Merge(Merge),
    /// How many costs a second the objective gives on this machine
    Speed(Speed),
    /// How planning grows with the fleet: time, memory, evaluations, violations, cost
    Fleet(FleetStudy),
    /// Write a mission spec made of a seed: ridges, belts of threats, dead ends, narrow passes
    Scenario(Scenario),
}

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct FleetStudy {
    /// Keep the missions and what was planned in this folder
    #[arg(long, value_name = "DIR")]
    pub(in crate::cli) out: Option<PathBuf>,
    /// Numbers of vehicles
    #[arg(long, value_name = "N,...", value_delimiter = ',', default_value = "1,3,10,30,100,300,1000", value_parser = fleet_size)]
    pub(in crate::cli) sizes: Vec<usize>,
    /// Objective evaluations for each plan
    #[arg(long, value_name = "N", default_value_t = 1000)]
    pub(in crate::cli) evaluations: usize,
    /// Compare the cost of fleets of up to this many vehicles with that at 40 000 evaluations
    #[arg(long, value_name = "N", default_value_t = 100)]
    pub(in crate::cli) compare_to: usize,
    /// Print one JSON document instead of the table
    #[arg(long)]
    pub(in crate::cli) json: bool,
}

fn fleet_size(text: &str) -> Result<usize, String> {
    let most = crate::study::MOST_DELIVERIES;
    text.parse()
        .ok()
        .filter(|size| (1..=most).contains(size))
        .ok_or_else(|| format!("not a number of vehicles from 1 to {most}"))
}

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Speed {
    /// Time for each number
    #[arg(long, value_name = "SECONDS", default_value_t = 0.3, value_parser = seconds)]
    pub(in crate::cli) seconds: f64,
    /// Print one JSON document instead of the table
    #[arg(long)]
    pub(in crate::cli) json: bool,
}

fn seconds(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|seconds| (0.001..=60.0).contains(seconds))
        .ok_or_else(|| "not a number from 0.001 to 60".to_owned())
}

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Scenario {
    /// Which one of this difficulty
    #[arg(long, value_name = "N")]
    pub(in crate::cli) seed: u64,
    /// From 1 (5 threats, some kilometres) to 10 (40 threats, up to 200 km)
    #[arg(long, value_name = "D", value_parser = clap::value_parser!(u8).range(1..=10))]
    pub(in crate::cli) difficulty: u8,
    /// The file to write instead of stdout
    #[arg(short, long, value_name = "FILE")]
    pub(in crate::cli) output: Option<PathBuf>,
}

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Paper {
    /// Maps (YAML with `frame: local`) instead of the three that come with the program
    #[arg(value_name = "MAPS")]
    pub(in crate::cli) maps: Vec<PathBuf>,
    /// Output folder
    #[arg(long, value_name = "DIR")]
    pub(in crate::cli) out: PathBuf,
    /// Runs of each algorithm on each map; a quarter of them of the planner and of variations
    #[arg(long, value_name = "N", default_value_t = 40)]
    pub(in crate::cli) runs: usize,
    /// Iterations
    #[arg(long, value_name = "N", default_value_t = 200)]
    pub(in crate::cli) iterations: usize,
    /// Population size
    #[arg(long, value_name = "M", default_value_t = 100)]
    pub(in crate::cli) population: usize,
    /// Free control points instead of the maps' own
    #[arg(long, value_name = "D")]
    pub(in crate::cli) control_points: Option<usize>,
    /// Seed of the first run; each later run has the next
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(in crate::cli) seed: u64,
    /// Also run MSFOA without its parts
    #[arg(long)]
    pub(in crate::cli) ablations: bool,
    /// Also read what the paper leaves open in other ways
    #[arg(long)]
    pub(in crate::cli) readings: bool,
    /// Search the objective as published, gaps and all; the default planner then stays away
    #[arg(long, alias = "printed-objective")]
    pub(in crate::cli) published_objective: bool,
    /// Make only part I of N, for `study merge`
    #[arg(long, value_name = "I/N", value_parser = crate::cli::study::parse_shard)]
    pub(in crate::cli) shard: Option<(usize, usize)>,
    /// Go on with what is in the folder
    #[arg(long)]
    pub(in crate::cli) resume: bool,
}

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Planner {
    /// Missions, or maps with `frame: local`, instead of the paper's three, the shipped ones
    /// and the generated ones with the seeds 101 to 120
    #[arg(value_name = "SPECS")]
    pub(in crate::cli) specs: Vec<PathBuf>,
    /// Generated missions of these seeds, beside SPECS
    #[arg(long, value_name = "FIRST-LAST", value_parser = crate::cli::study::parse_range)]
    pub(in crate::cli) generated: Option<std::ops::RangeInclusive<u64>>,
    /// Folder of the shipped missions
    #[arg(long, value_name = "DIR", default_value = "missions")]
    pub(in crate::cli) missions: PathBuf,
    /// Output folder
    #[arg(long, value_name = "DIR")]
    pub(in crate::cli) out: PathBuf,
    /// Runs on each mission with each budget
    #[arg(long, value_name = "N", default_value_t = 40, value_parser = crate::cli::study::parse_count)]
    pub(in crate::cli) seeds: usize,
    /// Seed of the first run; each later run has the next
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(in crate::cli) seed: u64,
    /// Evaluations for each vehicle
    #[arg(long, value_name = "N,N", value_delimiter = ',', default_values_t = [40_000, 10_000], value_parser = crate::cli::study::parse_budget)]
    pub(in crate::cli) evaluations: Vec<usize>,
    /// Also run the planner without its parts, one at a time
    #[arg(long)]
    pub(in crate::cli) ablations: bool,
    /// The best costs known
    #[arg(long, value_name = "FILE", default_value = "missions/best-known.json")]
    pub(in crate::cli) best_known: PathBuf,
    /// Lower the best costs known where a run is below them
    #[arg(long)]
    pub(in crate::cli) update: bool,
    /// Make only part I of N, for `study merge`
    #[arg(long, value_name = "I/N", value_parser = crate::cli::study::parse_shard)]
    pub(in crate::cli) shard: Option<(usize, usize)>,
    /// Go on with what is in the folder
    #[arg(long)]
    pub(in crate::cli) resume: bool,
    /// Print one JSON document instead of the table
    #[arg(long)]
    pub(in crate::cli) json: bool,
}

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Merge {
    /// Folders of all shards
    #[arg(required = true, value_name = "DIRS")]
    pub(in crate::cli) shards: Vec<PathBuf>,
    /// Output folder
    #[arg(long, value_name = "DIR")]
    pub(in crate::cli) out: PathBuf,
    /// The best costs known, for a study of the planner
    #[arg(long, value_name = "FILE", default_value = "missions/best-known.json")]
    pub(in crate::cli) best_known: PathBuf,
}
