//! Mission files without a spec: one is made in memory from the items and the flags,
//! so that the same verdict judges them.

mod airframe;
mod airspeeds;
mod area;
mod assumed;
mod flags;
mod given;
mod rates;
mod versions;
mod wings;

use std::path::{Path, PathBuf};

use crate::cli::args::{AutopilotName, Limits};
use crate::cli::folder;
use crate::cli::print::failure::Failure;
use crate::formats::Document;
use crate::geodesy::{Amsl, LatLon};
use crate::mission::{self, Home, Item, Parameter, VehicleMission, command, frame};
use crate::spec::{
    Airframe, Autopilot, Builder, EndPoint, Finish, MissionSpec, Placement, Separation, Vehicle,
    keys,
};
use crate::verify::{Limit, Margin};
use crate::world::{Bounds, Terrain, World, read_terrain};

use airframe::airframe;
use area::around_positions;
pub(crate) use given::keep_given;
pub(crate) use rates::judge_rates;
pub(crate) use versions::judge_later;

/// Vehicles without a spec are numbered as systems from 1.
const MAX_VEHICLES: usize = 250;

/// Everything that a verdict needs, from files and flags.
pub(crate) struct WithoutSpec {
    pub(crate) spec: MissionSpec,
    /// The prototype as YAML, with every key but those of the vehicles.
    pub(crate) text: String,
    pub(crate) world: World,
    pub(crate) missions: Vec<(usize, VehicleMission)>,
    /// Assumptions, in sentences.
    pub(crate) assumed: Vec<String>,
    /// What fails besides the verdict.
    pub(crate) failed: Vec<Margin>,
}

/// One mission file.
pub(crate) struct Subject {
    pub(crate) id: String,
    pub(crate) path: PathBuf,
    pub(crate) document: Document,
}

/// Makes a spec and a world around the missions.
pub(crate) fn around(subjects: Vec<Subject>, limits: &Limits) -> Result<WithoutSpec, Failure> {
    if subjects.len() > MAX_VEHICLES {
        let message = format!("{} missions (allowed: {MAX_VEHICLES})", subjects.len());
        return Err(Failure::new(Failure::USAGE, message));
    }
    let mut assumed = Vec::new();
    let corners = around_positions(&subjects)?;
    let mut whole: Option<(MissionSpec, String)> = None;
    let (mut vehicles, mut missions, mut failed) = (Vec::new(), Vec::new(), Vec::new());
    for (index, subject) in subjects.into_iter().enumerate() {
        let autopilot = autopilot(&subject, limits, &mut assumed);
        let airframe = airframe(&subject, limits, &mut assumed)?;
        let who = (autopilot, airframe);
        failed.extend(in_home_row(&subject, autopilot));
        let params = params(&subject)?;
        let speed_mps = speed_mps(&subject.document, &params, who, limits);
        let prototype = prototype(corners, who, speed_mps, limits);
        let file = prototype.file(Path::new("flags"));
        let file = file.map_err(|error| flags::refused(&error))?;
        let (mut spec, text) = (file.spec, file.text);
        if let Some(prototype) = spec.vehicles.pop() {
            let home = home(&subject, limits, &spec, &mut assumed)?;
            let is_heading_known = autopilot == Autopilot::Px4 || limits.takeoff_heading.is_some();
            let mut vehicle = fit(prototype, &subject, &home, (index, is_heading_known));
            let mut mission = VehicleMission {
                params,
                ..mission(subject, home, who)?
            };
            if !is_heading_known {
                assumed::takeoff_heading(&mut vehicle, &mission, &mut assumed);
            }
            assumed::returns(&vehicle, &mut mission, limits, &mut assumed);
            airspeeds::limit(&mut mission, &vehicle.id, &mut assumed);
            failed.extend(airspeeds::beyond_limits(&mission, &vehicle.id));
            vehicles.push(vehicle);
            missions.push((index, mission));
        }
        whole.get_or_insert((spec, text));
    }
    let Some((mut spec, text)) = whole else {
        return Err(Failure::new(Failure::USAGE, "no mission files given"));
    };
    spec.vehicles = vehicles;
    spec.version = assumed::version(&missions, limits);
    let mut world = world(&spec, &missions, limits)?;
    wings::describe(&mut spec.vehicles, &missions, &world.terrain, limits);
    let mut begin = |(index, mission): &(usize, VehicleMission)| {
        let vehicle = (*index, &spec.vehicles[*index]);
        assumed::begin_in_air(vehicle, mission, &mut world, limits, &mut assumed)
    };
    failed.extend(missions.iter().filter_map(&mut begin));
    Ok(WithoutSpec {
        failed,
        spec,
        text,
        world,
        missions,
        assumed,
    })
}

/// The margin that fails where the first item stands in the row of home (`AP_Mission`: the first
/// command is home, whatever is sent).
fn in_home_row(subject: &Subject, autopilot: Autopilot) -> Option<Margin> {
    let command = subject.document.in_home_row?;
    let why = format!(
        "mission item 1: home row: command {command} stands in row 0, which ArduPilot takes for home: \
         never flown (allowed: a home row before it); judged as flown"
    );
    let is_lost = autopilot == Autopilot::ArduPilot;
    is_lost.then(|| Margin::unjudged(&subject.id, Limit::Acceptance, why))
}

/// A spec with one vehicle somewhere in the area: the flags are checked as its keys.
fn prototype(
    (south_west, north_east): (LatLon, LatLon),
    (autopilot, airframe): (Autopilot, Airframe),
    speed_mps: f64,
    limits: &Limits,
) -> Builder {
    let between = |share: f64| {
        let mix = |a: f64, b: f64| a + (b - a) * share;
        keys::Place {
            lat: Some(mix(south_west.lat_deg, north_east.lat_deg)),
            lon: Some(mix(south_west.lon_deg, north_east.lon_deg)),
        }
    };
    let end = |share: f64| {
        let keys::Place { lat, lon } = between(share);
        keys::Station {
            lat,
            lon,
            amsl_m: Some(100.0),
            ..keys::Station::default()
        }
    };
    let takeoff_heading_deg = match airframe {
        Airframe::Copter => None,
        Airframe::Plane => Some(limits.takeoff_heading.unwrap_or(0.0)),
        Airframe::Vtol => limits.takeoff_heading,
    };
    let vehicle = keys::Vehicle {
        id: Some("vehicle".to_owned()),
        sysid: Some(1),
        link: Some("sim".to_owned()),
        finish: Some(Finish::Loiter),
        autopilot: Some(autopilot),
        airframe: Some(airframe),
        home: Some(between(0.2)),
        start: Some(end(0.3)),
        goal: Some(end(0.7)),
        speed_mps: Some(speed_mps),
        takeoff_heading_deg,
        max_load_factor: limits.load_factor,
        max_climb_deg: limits.max_climb,
        max_descent_deg: limits.max_descent,
        climb_mps: limits.climb,
        descent_mps: limits.descent,
        accel_mps2: limits.accel,
        return_amsl_m: limits.return_amsl,
        ..keys::Vehicle::default()
    };
    builder((south_west, north_east), limits).vehicle(vehicle)
}

/// A spec without vehicles.
fn builder((south_west, north_east): (LatLon, LatLon), limits: &Limits) -> Builder {
    let area = keys::Area {
        south_west: south_west.into(),
        north_east: north_east.into(),
        min_agl_m: limits.min_agl.unwrap_or(0.0),
        max_amsl_m: limits.max_amsl.unwrap_or(20_000.0),
        max_agl_m: None,
        min_amsl_m: None,
    };
    let separation = Separation {
        distance_m: limits.separation.unwrap_or(1.0),
        time_slack_s: limits.time_slack.unwrap_or(0.0),
        vertical_m: limits.vertical_separation,
    };
    MissionSpec::builder("review", area, keys::Terrain::flat(0.0))
        .with(|keys| keys.separation = separation)
}

/// The flag, or the autopilot of the file, or ArduPilot.
fn autopilot(subject: &Subject, limits: &Limits, assumed: &mut Vec<String>) -> Autopilot {
    let flag = limits.autopilot.map(|name| match name {
        AutopilotName::Ardupilot => Autopilot::ArduPilot,
        AutopilotName::Px4 => Autopilot::Px4,
    });
    flag.or(subject.document.autopilot).unwrap_or_else(|| {
        assumed.push(format!(
            "{}: the file does not say for which autopilot it is: read as for ArduPilot (--autopilot)",
            subject.id
        ));
        Autopilot::ArduPilot
    })
}

/// The flag, or a change of speed before the first leg, or the parameter next to the mission, or
/// the default of the autopilot (`WPNAV_SPEED`, `MPC_XY_CRUISE`, `AIRSPEED_CRUISE`,
/// `FW_AIRSPD_TRIM`).
fn speed_mps(
    document: &Document,
    params: &[Parameter],
    who: (Autopilot, Airframe),
    limits: &Limits,
) -> f64 {
    let defaults = crate::autopilot::facts(who.0, who.1).defaults;
    let takeoffs = [command::NAV_TAKEOFF, command::NAV_VTOL_TAKEOFF];
    let flies = |item: &&Item| {
        item.command <= command::NAV_LAST
            && item.place().is_some()
            && !takeoffs.contains(&item.command)
    };
    let before = document
        .items
        .iter()
        .take_while(|item| !flies(item))
        .count();
    let changes = airspeeds::changes(&document.items, who)
        .take_while(|(index, _)| *index < before)
        .map(|(_, item)| item);
    let held = |name: &str| mission::value_si_of(params, name);
    let [least, most] = defaults.speed_parameters;
    let min_mps = least.and_then(held).unwrap_or(0.0);
    let max_mps = most.and_then(held).unwrap_or(100.0);
    let in_mission = changes
        .map(|item| f64::from(item.params[1]))
        .find(|mps| (0.5..=100.0).contains(mps) && (min_mps..=max_mps.min(100.0)).contains(mps));
    let cruise = held(defaults.cruise_parameter).filter(|mps| (0.5..=100.0).contains(mps));
    let first = limits.speed.or(in_mission).or(cruise);
    let first = first.unwrap_or_else(|| defaults.cruise_mps());
    match who.0 {
        Autopilot::Px4 => first.min(max_mps).max(0.5),
        Autopilot::ArduPilot => first,
    }
}

/// The parameters next to a mission.
fn params(subject: &Subject) -> Result<Vec<Parameter>, Failure> {
    let stem = subject.path.file_stem().unwrap_or_default();
    folder::params::read_params(&subject.path, &stem.to_string_lossy())
}

/// The home row of a file without a home.
const NO_HOME: Home = Home {
    x: 0,
    y: 0,
    amsl_m: 0.0,
};

/// Home of the file, or of the flag, or on the terrain; else 0, 0, for which the verdict fails.
fn home(
    subject: &Subject,
    limits: &Limits,
    spec: &MissionSpec,
    assumed: &mut Vec<String>,
) -> Result<Home, Failure> {
    let home = known_home(subject, limits, spec, assumed)?;
    if (home.x, home.y) == (NO_HOME.x, NO_HOME.y) {
        let judged = "the file has no home: judged from the ground under its first waypoint (--home LAT,LON,AMSL)";
        assumed.push(format!("{}: {judged}", subject.id));
    }
    Ok(home)
}

fn known_home(
    subject: &Subject,
    limits: &Limits,
    spec: &MissionSpec,
    assumed: &mut Vec<String>,
) -> Result<Home, Failure> {
    if let Some(home) = subject.document.home {
        return Ok(home);
    }
    let Some(place) = limits.home else {
        let on_terrain = match subject.document.home_place {
            Some(_) => subject.document.home_on(&terrain(spec, limits)?),
            None => None,
        };
        if on_terrain.is_some() {
            let text = format!("{}: home stands on the terrain of --terrain", subject.id);
            assumed.push(text);
        }
        return Ok(on_terrain.unwrap_or(NO_HOME));
    };
    assumed.push(format!("{}: home is where --home says", subject.id));
    #[expect(clippy::cast_possible_truncation, reason = "checked with the flag")]
    let home = Home {
        x: (place.lat_deg * 1e7).round() as i32,
        y: (place.lon_deg * 1e7).round() as i32,
        amsl_m: place.amsl_m as f32,
    };
    Ok(home)
}

/// The mission with its home.
fn mission(
    subject: Subject,
    home: Home,
    (autopilot, airframe): (Autopilot, Airframe),
) -> Result<VehicleMission, Failure> {
    let document = Document {
        home: Some(home),
        ..subject.document
    };
    let mission = document.into_mission(autopilot, airframe);
    mission.map_err(|error| {
        let message = format!("{}: {error}", subject.path.display());
        Failure::new(Failure::INPUT, message)
    })
}

/// The prototype at the mission: its home, its first position, its last.
fn fit(
    mut vehicle: Vehicle,
    subject: &Subject,
    home: &Home,
    (index, is_heading_known): (usize, bool),
) -> Vehicle {
    if let Some(wing) = vehicle.wing.as_mut().filter(|_| !is_heading_known) {
        // No file holds the heading before takeoff: what depends on it is not judged.
        wing.takeoff_heading_rad = None;
    }
    vehicle.id.clone_from(&subject.id);
    vehicle.sysid = u8::try_from(index + 1).unwrap_or(u8::MAX);
    let flown: Vec<&Item> = subject
        .document
        .items
        .iter()
        .filter(|item| item.place().is_some() && (item.x, item.y) != (0, 0))
        .collect();
    let place = |x: i32, y: i32| LatLon::new(f64::from(x) / 1e7, f64::from(y) / 1e7).ok();
    let end = |item: &&Item| {
        let base_m = match frame::canonical(item.frame) {
            frame::GLOBAL => 0.0,
            _ => f64::from(home.amsl_m),
        };
        Some(EndPoint {
            place: item.place()?,
            altitude: Placement::Amsl(Amsl(f64::from(item.z) + base_m)),
        })
    };
    let waypoints = || {
        flown
            .iter()
            .filter(|item| item.command == command::NAV_WAYPOINT)
    };
    let first = waypoints().next().or(flown.first()).and_then(end);
    let last = waypoints().next_back().or(flown.last()).and_then(end);
    if let (Some(first), Some(last)) = (first, last) {
        (vehicle.start, vehicle.goal) = (first, last);
        vehicle.home = first.place;
    }
    if let Some(place) = place(home.x, home.y).filter(|_| (home.x, home.y) != (0, 0)) {
        vehicle.home = place;
    }
    let holds = |command: u16| {
        let mut items = subject.document.items.iter();
        items.any(|item| item.command == command)
    };
    if holds(command::NAV_LAND) || holds(command::NAV_VTOL_LAND) {
        vehicle.finish = Finish::Land;
    } else if holds(command::NAV_RETURN_TO_LAUNCH) {
        vehicle.finish = Finish::Return;
    }
    vehicle
}

/// The elevation of `--terrain` around the area.
fn terrain(spec: &MissionSpec, limits: &Limits) -> Result<Terrain, Failure> {
    let Some(path) = &limits.terrain else {
        return Ok(Terrain::Unknown);
    };
    let bounds = Some(Bounds::around(&spec.area));
    let grid = read_terrain(path, bounds).map_err(|error| {
        let message = format!("--terrain {}: {error}", path.display());
        Failure::new(Failure::INPUT, message)
    })?;
    Ok(Terrain::Grid(grid))
}

fn world(
    spec: &MissionSpec,
    missions: &[(usize, VehicleMission)],
    limits: &Limits,
) -> Result<World, Failure> {
    let terrain = terrain(spec, limits)?;
    // Sites need ground, and there may be none; only their homes are used.
    let mut world = World::new(spec, Terrain::Flat(Amsl(0.0)))
        .map_err(|error| Failure::new(Failure::INPUT, error.to_string()))?;
    for (index, mission) in missions {
        let home = spec.vehicles[*index].home;
        let row = Amsl(f64::from(mission.home.amsl_m));
        world.sites[*index].home.amsl = terrain.height(home).unwrap_or(row);
    }
    world.terrain = terrain;
    Ok(world)
}
