//! Arguments of `sortie study`.

use std::ops::RangeInclusive;
use std::path::PathBuf;

use clap::Subcommand;
use clap::builder::RangedU64ValueParser;

use crate::study::{Family, MAX_DELIVERIES};

#[derive(Debug, Subcommand)]
pub(in crate::cli) enum Study {
    /// Run the paper's experiment: seven algorithms on three maps, many times
    Paper(Paper),
    /// Compare the default planner with the best known plans: many seeds, many missions
    Planner(Planner),
    /// Merge the shards of a study
    Merge(Merge),
    /// Measure costs per second of the objective on this machine
    Speed(Speed),
    /// Plan fleets of growing size: time, memory, evaluations, violations, cost
    Fleet(FleetStudy),
    /// Generate a mission spec from a seed: ridges, belts of threats, dead ends, narrow passes, or
    /// a problem of a family
    Scenario(Scenario),
}

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct FleetStudy {
    /// Save missions and plans in this folder
    #[arg(long, value_name = "DIR")]
    pub(in crate::cli) out: Option<PathBuf>,
    /// Numbers of vehicles
    #[arg(long, value_name = "N,...", value_delimiter = ',', default_value = "1,3,10,30,100,300,1000", value_parser = number(1, MAX_DELIVERIES as u64))]
    pub(in crate::cli) sizes: Vec<usize>,
    /// Objective evaluations of each plan
    #[arg(long, value_name = "N", default_value_t = 1000)]
    pub(in crate::cli) evaluations: usize,
    /// Compare fleets of up to N vehicles with plans of 40 000 evaluations
    #[arg(long, value_name = "N", default_value_t = 100)]
    pub(in crate::cli) compare_to: usize,
    /// Print one JSON document instead of the table
    #[arg(long)]
    pub(in crate::cli) json: bool,
}

fn number(min: u64, max: u64) -> RangedU64ValueParser<usize> {
    RangedU64ValueParser::new().range(min..=max)
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
    /// Seed; each seed gives a different mission of the same difficulty
    #[arg(long, value_name = "N")]
    pub(in crate::cli) seed: u64,
    /// From 1 (5 threats, some kilometres) to 10 (40 threats, up to 200 km)
    #[arg(long, value_name = "D", value_parser = clap::value_parser!(u8).range(1..=10), required_unless_present = "family")]
    pub(in crate::cli) difficulty: Option<u8>,
    /// A problem of a family instead: walls, maze, city, gaps, far, canyon, plateau, rough, overflight
    #[arg(long, value_name = "NAME", value_parser = parse_family, conflicts_with = "difficulty")]
    pub(in crate::cli) family: Option<Family>,
    /// Write to a file instead of stdout
    #[arg(short, long, value_name = "FILE")]
    pub(in crate::cli) output: Option<PathBuf>,
}

/// The folder of a study and the part of it to make.
#[derive(Debug, clap::Args)]
pub(in crate::cli) struct StudyFolder {
    /// Output folder
    #[arg(long, value_name = "DIR")]
    pub(in crate::cli) out: PathBuf,
    /// Run only part I of N, for `study merge`
    #[arg(long, value_name = "I/N", value_parser = parse_shard)]
    pub(in crate::cli) shard: Option<(usize, usize)>,
    /// Continue the study in the folder
    #[arg(long)]
    pub(in crate::cli) resume: bool,
}

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Paper {
    /// Maps (YAML with `frame: local`) instead of the three shipped ones
    #[arg(value_name = "MAPS")]
    pub(in crate::cli) maps: Vec<PathBuf>,
    /// Runs of each algorithm on each map; a quarter of that for the planner and for variations
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
    /// Also run MSFOA without its parts, one at a time
    #[arg(long)]
    pub(in crate::cli) ablations: bool,
    /// Also run other interpretations of what the paper leaves open
    #[arg(long)]
    pub(in crate::cli) readings: bool,
    /// Search the objective as published, with its gaps; excludes the default planner
    #[arg(long, alias = "printed-objective")]
    pub(in crate::cli) published_objective: bool,
    #[command(flatten)]
    pub(in crate::cli) folder: StudyFolder,
}

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Planner {
    /// Missions, or maps with `frame: local`, instead of the paper's three, the shipped ones
    /// and the generated ones with the seeds 101 to 120
    #[arg(value_name = "SPECS")]
    pub(in crate::cli) specs: Vec<PathBuf>,
    /// Add generated missions of these seeds to SPECS
    #[arg(long, value_name = "FIRST-LAST", value_parser = parse_range)]
    pub(in crate::cli) generated: Option<RangeInclusive<u64>>,
    /// Add problems of a family, seeds FIRST to LAST; repeatable, see `study scenario --help`
    #[arg(long = "family", value_name = "NAME=FIRST-LAST", value_parser = parse_families)]
    pub(in crate::cli) families: Vec<(Family, RangeInclusive<u64>)>,
    /// Folder of the shipped missions
    #[arg(long, value_name = "DIR", default_value = "missions")]
    pub(in crate::cli) missions: PathBuf,
    /// Runs on each mission with each budget
    #[arg(long, value_name = "N", default_value_t = 40, value_parser = number(1, 10_000))]
    pub(in crate::cli) seeds: usize,
    /// Seed of the first run; each later run has the next
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(in crate::cli) seed: u64,
    /// Evaluations for each vehicle
    #[arg(long, value_name = "N,N", value_delimiter = ',', default_values_t = [40_000, 10_000], value_parser = number(100, 100_000_000))]
    pub(in crate::cli) evaluations: Vec<usize>,
    /// Also run the planner without its parts, one at a time
    #[arg(long)]
    pub(in crate::cli) ablations: bool,
    /// File of the best known costs
    #[arg(long, value_name = "FILE", default_value = "missions/best-known.json")]
    pub(in crate::cli) best_known: PathBuf,
    /// Update the best known costs with lower ones
    #[arg(long)]
    pub(in crate::cli) update: bool,
    #[command(flatten)]
    pub(in crate::cli) folder: StudyFolder,
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
    /// File of the best known costs, for a study of the planner
    #[arg(long, value_name = "FILE", default_value = "missions/best-known.json")]
    pub(in crate::cli) best_known: PathBuf,
}

/// `I/N` with I from 1 to N.
fn parse_shard(text: &str) -> Result<(usize, usize), String> {
    let parts = text
        .split_once('/')
        .and_then(|(part, parts)| Some((part.parse().ok()?, parts.parse().ok()?)));
    parts
        .filter(|&(part, parts)| (1..=parts).contains(&part))
        .ok_or_else(|| "not I/N with I from 1 to N, such as 1/4".to_owned())
}

/// `FIRST-LAST`, or one number.
fn parse_range(text: &str) -> Result<RangeInclusive<u64>, String> {
    let (first, last) = text.split_once('-').unwrap_or((text, text));
    let ends = first.parse().ok().zip(last.parse().ok());
    ends.filter(|(first, last)| first <= last && last - first < 10_000)
        .map(|(first, last)| first..=last)
        .ok_or_else(|| "not FIRST-LAST, such as 101-120".to_owned())
}

/// A family by its name.
fn parse_family(text: &str) -> Result<Family, String> {
    Family::named(text).ok_or_else(|| {
        let names = Family::ALL.map(Family::name);
        format!("not one of {}", names.join(", "))
    })
}

/// A family and seeds, such as `walls=1-5`.
fn parse_families(text: &str) -> Result<(Family, RangeInclusive<u64>), String> {
    let (name, seeds) = text
        .split_once('=')
        .ok_or_else(|| "not NAME=FIRST-LAST, such as walls=1-5".to_owned())?;
    Ok((parse_family(name)?, parse_range(seeds)?))
}
