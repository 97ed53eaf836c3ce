//! Arguments of the commands.

mod costs;
mod flight;
mod study;
mod terrain;
mod transfer;

use std::path::PathBuf;

use clap::error::ErrorKind;
use clap::{Parser, Subcommand};

use costs::{CERTIFY, EVALUATE};
pub(super) use costs::{Certify, Evaluate};
pub(super) use flight::{Fly, Replan, Watch};
pub(super) use study::{FleetStudy, Merge, Paper, Planner, Scenario, Speed, Study, StudyFolder};
pub(super) use terrain::{Terrain, TerrainExport, TerrainFetch, TerrainInfo};
pub(super) use transfer::{Download, Upload};

use crate::spec::Airframe;

/// One mission spec in, verified collision-free MAVLink missions for a whole fleet out.
#[derive(Debug, Parser)]
#[command(name = "sortie", version, max_term_width = 100, after_help = EXIT_CODES)]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub(super) command: Command,
}

/// The command to type next, for a command line without a command or a spec.
pub(super) fn next_step(error: ErrorKind, text: &str) -> Option<&'static str> {
    match error {
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => Some(
            "To begin: `sortie new mission --at LAT,LON` writes a spec, `sortie check mission.yaml` checks it, \
             `sortie plan mission.yaml` plans it.",
        ),
        ErrorKind::MissingRequiredArgument if text.contains("<SPEC>") => Some(
            "A spec is a YAML file such as missions/first.yaml; \
             `sortie new mission --at LAT,LON` writes one, `sortie schema` describes its keys.",
        ),
        _ => None,
    }
}

const EXIT_CODES: &str = "Exit codes: 0 done and verified; 1 internal, or output not writable; 2 usage; \
                          3 bad spec or input file; 4 nothing that passes verification; 5 transfer or flight failed.";

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Plan, verify and write everything; with --upload also transfer it
    #[command(after_help = PLAN)]
    Plan(Plan),
    /// Write a commented spec for a place, to begin with
    New(New),
    /// Check a spec without planning
    Check(Check),
    /// Judge mission files, against a spec or against limits given as flags
    Review(Box<Review>),
    /// Verify again, transfer to the vehicles, read back and compare
    Upload(Upload),
    /// Launch the fleet, monitor and record the flight, and judge it
    Fly(Fly),
    /// Attach to a flight in progress, or take it over in the air after a crash
    Watch(Watch),
    /// Plan new paths around a threat for vehicles in flight, and upload them
    Replan(Replan),
    /// Read mission, fence and rally points from a vehicle into a file
    Download(Download),
    /// Convert a mission file to another format, and report what the new format cannot hold
    #[command(after_help = CONVERT)]
    Convert(Convert),
    /// Run the simulated vehicles of a spec, for any ground station, until Ctrl-C
    Vehicles(Vehicles),
    /// Inspect elevation files, fetch them from a server, or export them for a vehicle
    #[command(subcommand)]
    Terrain(Terrain),
    /// Evaluate candidate paths from stdin for an external optimiser, costs to stdout
    #[command(after_help = EVALUATE)]
    Evaluate(Evaluate),
    /// Prove a lower bound of the costs that includes altitude, with a certificate that others can check
    #[command(after_help = CERTIFY)]
    Certify(Certify),
    /// Run the paper's experiment and other studies
    #[command(subcommand)]
    Study(Study),
    /// Rewrite a spec of version 1 as version 2, which has buffers; comments stay
    Migrate(Migrate),
    /// Print the JSON Schema of the spec, or of a document
    Schema {
        /// What the schema is of
        #[arg(default_value = "spec")]
        name: SchemaName,
    },
    /// Write the manual pages of all commands
    Man {
        /// Folder to write to, created where it is missing
        #[arg(value_name = "DIR")]
        folder: PathBuf,
    },
    /// Print a completion script
    Completions {
        /// Which shell
        shell: clap_complete::Shell,
    },
}

impl Command {
    /// Whether `--json` was given.
    pub(super) fn prints_json(&self) -> bool {
        match self {
            Self::Plan(of) => of.json,
            Self::Check(of) => of.json,
            Self::Review(of) => of.json,
            Self::Upload(of) => of.json,
            Self::Certify(of) => of.json,
            Self::Convert(of) => of.json,
            Self::Fly(of) => of.json,
            Self::Watch(of) => of.json,
            Self::Terrain(Terrain::Info(of)) => of.json,
            Self::Study(Study::Planner(of)) => of.json,
            Self::Study(Study::Fleet(of)) => of.json,
            Self::Study(Study::Speed(of)) => of.json,
            _ => false,
        }
    }
}

#[derive(Debug, clap::Args)]
pub(super) struct New {
    /// Name of the mission; the file is NAME.yaml
    pub(super) name: String,
    /// Middle of the area, degrees
    #[arg(long, value_name = "LAT,LON", value_parser = latitude_longitude, allow_hyphen_values = true)]
    pub(super) at: (f64, f64),
    /// Elevation file, relative to the spec: .tif, .hgt [default: flat ground, altitudes above home]
    #[arg(long, value_name = "FILE")]
    pub(super) terrain: Option<PathBuf>,
    /// Write to this file instead; existing files are not replaced
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
}

fn latitude_longitude(text: &str) -> Result<(f64, f64), String> {
    let numbers: Result<Vec<f64>, String> =
        text.split(',').map(|part| finite(part.trim())).collect();
    match numbers?[..] {
        [lat_deg, lon_deg] if lat_deg.abs() < 85.0 && lon_deg.abs() <= 180.0 => {
            Ok((lat_deg, lon_deg))
        }
        _ => Err(
            "not LAT,LON in degrees such as 47.39,8.54 (allowed: latitudes between -85 and 85, longitudes from -180 to 180)".to_owned(),
        ),
    }
}

const PLAN: &str = "The table: cost is the length in km and what height adds; time is from the start to the goal at the \
                    planned speed, or to the end of the route home with `finish: return`, without takeoff, climb to \
                    the start and landing; each margin has its limit, buffer included, in brackets.";

#[derive(Debug, clap::Args)]
pub(super) struct Plan {
    /// The mission spec (YAML)
    pub(super) spec: PathBuf,
    /// Output folder; an existing one is replaced as a whole [default: out/<name>]
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Seed instead of the spec's
    #[arg(long, value_name = "N")]
    pub(super) seed: Option<u64>,
    /// Objective evaluations of each vehicle instead of the spec's
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(super) evaluations: Option<u32>,
    /// Plan with more and more evaluations for this time, or until Ctrl-C, and take the best plan
    #[arg(long, value_name = "SECONDS", conflicts_with = "evaluations", value_parser = seconds)]
    pub(super) within: Option<f64>,
    /// Transfer to every vehicle's link; nothing is sent unless the whole fleet passes
    #[arg(long)]
    pub(super) upload: bool,
    /// Print one JSON document instead of the table
    #[arg(long)]
    pub(super) json: bool,
}

#[derive(Debug, clap::Args)]
pub(super) struct Migrate {
    /// The mission spec (YAML)
    pub(super) spec: PathBuf,
    /// Write to this file instead of printing
    #[arg(short, long, value_name = "FILE", conflicts_with = "in_place")]
    pub(super) output: Option<PathBuf>,
    /// Replace the spec itself
    #[arg(long)]
    pub(super) in_place: bool,
}

#[derive(Debug, clap::Args)]
pub(super) struct Check {
    /// The mission spec (YAML)
    pub(super) spec: PathBuf,
    /// Print one JSON document, with every problem and its line and column
    #[arg(long)]
    pub(super) json: bool,
}

/// What a JSON Schema is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum SchemaName {
    /// The mission spec
    Spec,
    /// plan.json, and `plan --json`
    Plan,
    /// review.json, and `review --json`
    Review,
    /// What `review --trajectories` writes
    Trajectories,
    /// timing.json
    Timing,
    /// upload.json, and `upload --json`
    Upload,
    /// flight.json, and `fly --json`
    Flight,
    /// certificate.json
    Certificate,
    /// What `check --json` prints, and other commands of a bad spec or file
    Check,
    /// What `convert --json` prints of a mission file
    Convert,
    /// What `terrain info --json` prints
    Terrain,
    /// What `study speed --json` prints
    Speed,
}

#[derive(Debug, clap::Args)]
pub(super) struct Review {
    /// Mission files (QGC WPL, .plan, fence and rally lists), and the spec (*.yaml) if there is
    /// one; <id>.* belongs to vehicle <id>, a file with a fence or rally points only to all.
    /// Or one flight: the record that `fly` wrote (.jsonl), or a .tlog with the missions flown
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
    /// Write a picture of the review to this file
    #[arg(long, value_name = "FILE")]
    pub(super) svg: Option<PathBuf>,
    /// Write the verified trajectories to this file (JSON): places, times, what is allowed around them
    #[arg(long, value_name = "FILE")]
    pub(super) trajectories: Option<PathBuf>,
    #[command(flatten)]
    pub(super) limits: Limits,
}

/// Limits in place of a spec. A limit that is not given is not judged.
#[derive(Debug, Default, PartialEq, clap::Args)]
#[command(next_help_heading = "Without a spec (a limit that is not given is not judged)")]
pub(super) struct Limits {
    /// Elevation file; without it nothing passes unless --no-terrain is given
    #[arg(long, value_name = "FILE", conflicts_with = "no_terrain")]
    pub(super) terrain: Option<PathBuf>,
    /// Judge without terrain
    #[arg(long)]
    pub(super) no_terrain: bool,
    /// Minimum height above ground, metres [default: 0]
    #[arg(long, value_name = "M", value_parser = finite, requires = "terrain", conflicts_with = "no_terrain")]
    pub(super) min_agl: Option<f64>,
    /// Ceiling, metres above mean sea level
    #[arg(long, value_name = "M", value_parser = finite)]
    pub(super) max_amsl: Option<f64>,
    /// Minimum distance between vehicles, metres
    #[arg(long, value_name = "M", value_parser = finite)]
    pub(super) separation: Option<f64>,
    /// Vertical distance at which vehicles may be nearer than --separation, metres
    #[arg(long, value_name = "M", value_parser = finite, requires = "separation")]
    pub(super) vertical_separation: Option<f64>,
    /// The separation holds for every shift of departure up to this, seconds [default: 0]
    #[arg(long, value_name = "S", value_parser = finite, requires = "separation")]
    pub(super) time_slack: Option<f64>,
    /// Autopilot of the missions [default: as the file says, else ardupilot]
    #[arg(long, value_enum, value_name = "AUTOPILOT")]
    pub(super) autopilot: Option<AutopilotName>,
    /// Airframe of the vehicles [default: as the file says, else copter]
    #[arg(long, value_enum, value_name = "AIRFRAME")]
    pub(super) airframe: Option<AirframeName>,
    /// Missions without a takeoff begin in the air, at their first place
    #[arg(long)]
    pub(super) airborne: bool,
    /// Takeoff course of a plane, degrees from north; missions of ArduPilot do not hold it
    /// [default: towards the first waypoint]
    #[arg(long, value_name = "DEG", value_parser = finite)]
    pub(super) takeoff_heading: Option<f64>,
    /// Ground speed where the mission says none, m/s [default: the autopilot's]
    #[arg(long, value_name = "MPS", value_parser = finite)]
    pub(super) speed: Option<f64>,
    /// Horizontal acceleration, m/s^2 [default: the autopilot's]
    #[arg(long, value_name = "MPS2", value_parser = finite)]
    pub(super) accel: Option<f64>,
    /// Climb rate and its limit, m/s
    #[arg(long, value_name = "MPS", value_parser = finite)]
    pub(super) climb: Option<f64>,
    /// Descent rate and its limit, m/s
    #[arg(long, value_name = "MPS", value_parser = finite)]
    pub(super) descent: Option<f64>,
    /// Steepest climb, degrees
    #[arg(long, value_name = "DEG", value_parser = finite)]
    pub(super) max_climb: Option<f64>,
    /// Steepest descent, degrees
    #[arg(long, value_name = "DEG", value_parser = finite)]
    pub(super) max_descent: Option<f64>,
    /// Maximum load factor, which sets the turn radius
    #[arg(long, value_name = "N", value_parser = finite)]
    pub(super) load_factor: Option<f64>,
    /// Altitude at which a vehicle returns to launch, metres above mean sea level
    #[arg(long, value_name = "M", value_parser = finite)]
    pub(super) return_amsl: Option<f64>,
    /// Home of missions that have none: latitude, longitude, metres above mean sea level
    #[arg(long, value_name = "LAT,LON,AMSL", value_parser = place, allow_hyphen_values = true)]
    pub(super) home: Option<Place>,
}

/// An autopilot by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum AutopilotName {
    /// ArduPilot
    Ardupilot,
    /// PX4
    Px4,
}

/// An airframe by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum AirframeName {
    /// Multicopter
    Copter,
    /// Fixed wing
    Plane,
    /// Takes off and lands vertically, flies on its wing in between
    Vtol,
}

impl AirframeName {
    pub(super) fn airframe(self) -> Airframe {
        match self {
            Self::Copter => Airframe::Copter,
            Self::Plane => Airframe::Plane,
            Self::Vtol => Airframe::Vtol,
        }
    }
}

/// Latitude and longitude in degrees, metres above mean sea level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    pub(super) lat_deg: f64,
    pub(super) lon_deg: f64,
    pub(super) amsl_m: f64,
}

fn finite(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|value: &f64| value.is_finite())
        .ok_or_else(|| "not a number".to_owned())
}

/// A time to plan for, seconds: to a year.
fn seconds(text: &str) -> Result<f64, String> {
    let found = text.parse().ok().filter(|s| (0.0..=3e7).contains(s));
    found.ok_or_else(|| "not a number from 0 to 3e7".to_owned())
}

fn place(text: &str) -> Result<Place, String> {
    let numbers: Result<Vec<f64>, String> = text.split(',').map(finite).collect();
    match numbers?[..] {
        [lat_deg, lon_deg, amsl_m]
            if lat_deg.abs() <= 90.0 && lon_deg.abs() <= 180.0 && amsl_m.abs() <= 20_000.0 =>
        {
            Ok(Place {
                lat_deg,
                lon_deg,
                amsl_m,
            })
        }
        _ => Err("not LAT,LON,AMSL".to_owned()),
    }
}

const CONVERT: &str = "Numbers are kept as they go over the wire: 1e-7 degrees, 32-bit floats. Altitudes keep their \
                       reference. The report lists, item by item, what is lost, what ArduPilot and PX4 read \
                       differently, and what the autopilot would refuse; items count from 1, home is row 0 of a .waypoints file. \
                       A fence or rally points in a .waypoints or .txt file are rows from 0 without home, as \
                       MAVProxy keeps them. .kml and .geojson are maps, not missions.";

#[derive(Debug, clap::Args)]
pub(super) struct Convert {
    /// The file to read: QGC WPL, .plan, a fence or a rally list, recognised by its content, or zones: .geojson, .json, .kml, .kmz, OpenAir
    #[arg(value_name = "IN")]
    pub(super) input: PathBuf,
    /// The file to write: .waypoints, .txt, .plan, .kml or .geojson
    #[arg(value_name = "OUT")]
    pub(super) output: PathBuf,
    /// Autopilot of the mission [default: as the file says, else ardupilot]
    #[arg(long, value_enum, value_name = "AUTOPILOT")]
    pub(super) autopilot: Option<AutopilotName>,
    /// Airframe of the vehicle [default: as the file says, else copter]
    #[arg(long, value_enum, value_name = "AIRFRAME")]
    pub(super) airframe: Option<AirframeName>,
    /// The list that a .waypoints or .txt holds [default: the mission, or the only list]
    #[arg(long, value_enum, value_name = "LIST")]
    pub(super) list: Option<ListName>,
    /// Home of a file that has none: latitude, longitude, metres above mean sea level
    #[arg(long, value_name = "LAT,LON,AMSL", value_parser = place, allow_hyphen_values = true)]
    pub(super) home: Option<Place>,
    /// Print the report as one JSON document
    #[arg(long)]
    pub(super) json: bool,
}

/// A list of items by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum ListName {
    /// The mission proper
    Mission,
    /// The fence
    Fence,
    /// The rally points
    Rally,
}

#[derive(Debug, clap::Args)]
pub(super) struct Vehicles {
    /// The mission spec (YAML)
    pub(super) spec: PathBuf,
    /// UDP port of the first vehicle, one more for each further one; 0 for any free ones
    #[arg(long, value_name = "PORT", default_value_t = 14550)]
    pub(super) port: u16,
    /// Send to this ground station at once, instead of waiting for its first frame
    #[arg(long, value_name = "HOST:PORT")]
    pub(super) speak_to: Option<String>,
    /// Autopilot that all of them simulate [default: the autopilots in the spec]
    #[arg(long, value_enum, value_name = "AUTOPILOT")]
    pub(super) profile: Option<ProfileName>,
    /// Frames lost in each direction, percent
    #[arg(long, value_name = "PERCENT", default_value_t = 0.0, value_parser = percent)]
    pub(super) loss: f64,
    /// Delay of frames in each direction, milliseconds
    #[arg(long, value_name = "MS", default_value_t = 0)]
    pub(super) delay: u64,
    /// Seed of the losses
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(super) seed: u64,
    /// Stop after this time instead of at Ctrl-C
    #[arg(long = "for", value_name = "SECONDS")]
    pub(super) for_s: Option<u64>,
}

/// The autopilot that a vehicle simulates.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(super) enum ProfileName {
    /// ArduCopter
    Ardupilot,
    /// PX4
    Px4,
    /// Reports MAV_AUTOPILOT_GENERIC
    Generic,
}

fn percent(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|percent| (0.0..=100.0).contains(percent))
        .ok_or_else(|| "not a number from 0 to 100".to_owned())
}
