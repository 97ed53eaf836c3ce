//! Mission files without a spec: one is made in memory of the items and of the flags,
//! so that the same verdict judges them.

mod given;

use std::path::{Path, PathBuf};

use crate::cli::args::{AirframeName, AutopilotName, Limits};
use crate::cli::print::failure::Failure;
use crate::formats::Document;
use crate::geodesy::{Amsl, LatLon};
use crate::mission::{Home, Item, VehicleMission, command, frame};
use crate::spec::{
    Airframe, Autopilot, EndPoint, Finish, MissionSpec, Placement, SpecFile, Vehicle,
};
use crate::world::{Bounds, Terrain, World, read_terrain};

pub(crate) use given::keep_given;

/// Places further than this from the first one are not part of the area, degrees.
const NEAR_DEG: f64 = 2.0;
/// The area reaches this far beyond the items, degrees of latitude.
const AROUND_DEG: f64 = 0.006;
/// Vehicles without a spec are numbered as systems from 1.
const MOST_VEHICLES: usize = 250;

/// Everything a verdict needs, made of files and flags.
pub(crate) struct WithoutSpec {
    pub(crate) spec: MissionSpec,
    /// The prototype as YAML: what the rest of the spec came from.
    pub(crate) text: String,
    pub(crate) world: World,
    pub(crate) missions: Vec<(usize, VehicleMission)>,
    /// What was taken for granted, in sentences.
    pub(crate) assumed: Vec<String>,
}

/// One mission file.
pub(crate) struct Subject {
    pub(crate) id: String,
    pub(crate) path: PathBuf,
    pub(crate) document: Document,
}

/// Makes a spec and a world around the missions.
pub(crate) fn around(subjects: Vec<Subject>, limits: &Limits) -> Result<WithoutSpec, Failure> {
    if subjects.len() > MOST_VEHICLES {
        let message = format!("{} missions (allowed: {MOST_VEHICLES})", subjects.len());
        return Err(Failure::new(Failure::USAGE, message));
    }
    let mut assumed = Vec::new();
    let places: Vec<LatLon> = subjects.iter().flat_map(|s| places(&s.document)).collect();
    // Without any place there is nothing to fly, which the verdict says wherever that is.
    let middle = places.first().copied().unwrap_or(LatLon {
        lat_deg: 0.0,
        lon_deg: 0.0,
    });
    let corners = corners(middle, &places);
    let mut whole: Option<(MissionSpec, String)> = None;
    let mut vehicles = Vec::new();
    let mut missions = Vec::new();
    for (index, subject) in subjects.into_iter().enumerate() {
        let autopilot = autopilot(&subject, limits, &mut assumed);
        let asked = limits.airframe.map(AirframeName::airframe);
        let airframe = asked
            .or(subject.document.airframe)
            .unwrap_or(Airframe::Copter);
        let who = (autopilot, airframe);
        let speed_mps = speed_mps(&subject.document, who, limits);
        let text = prototype(corners, who, speed_mps, limits);
        let parsed = SpecFile::parse(Path::new("flags"), text)
            .map_err(|error| Failure::new(Failure::USAGE, error.to_string()))?;
        let mut spec = parsed.spec;
        if spec.vehicles.len() == 1 {
            let mut vehicle = spec.vehicles.remove(0);
            let home = home(&subject, limits, &spec, &mut assumed)?;
            fit(&mut vehicle, &subject, &home, index);
            if autopilot == Autopilot::ArduPilot && limits.takeoff_heading.is_none() {
                // Which way it stands is in no file: where that matters, nothing is judged.
                if let Some(wing) = &mut vehicle.wing {
                    wing.takeoff_heading_rad = None;
                }
            }
            vehicles.push(vehicle);
            let path = subject.path;
            let document = Document {
                home: Some(home),
                ..subject.document
            };
            let mission = document
                .into_mission(autopilot, airframe)
                .map_err(|e| Failure::new(Failure::INPUT, format!("{}: {e}", path.display())))?;
            missions.push((index, mission));
        }
        whole.get_or_insert((spec, parsed.text));
    }
    let Some((mut spec, text)) = whole else {
        return Err(Failure::new(Failure::USAGE, "no mission files given"));
    };
    spec.vehicles = vehicles;
    "review".clone_into(&mut spec.name);
    let world = world(&spec, &missions, limits)?;
    Ok(WithoutSpec {
        spec,
        text,
        world,
        missions,
        assumed,
    })
}

/// Home first, then every item with a place.
fn places(document: &Document) -> Vec<LatLon> {
    let home = document.home.map(|home| (home.x, home.y));
    let lists = [&document.items, &document.fence, &document.rally];
    let of_items = lists
        .into_iter()
        .flatten()
        .filter(|item| item.place().is_some())
        .map(|item| (item.x, item.y));
    let places = home
        .into_iter()
        .chain(of_items)
        .filter(|&place| place != (0, 0))
        .filter_map(|(x, y)| LatLon::new(f64::from(x) / 1e7, f64::from(y) / 1e7).ok());
    document.home_place.into_iter().chain(places).collect()
}

/// The corners of a box around the places that are near the first.
fn corners(middle: LatLon, places: &[LatLon]) -> (LatLon, LatLon) {
    let (mut low, mut high) = (middle, middle);
    let near = places.iter().filter(|place| {
        (place.lat_deg - middle.lat_deg).abs() < NEAR_DEG
            && (place.lon_deg - middle.lon_deg).abs() < NEAR_DEG
    });
    for place in near {
        low.lat_deg = low.lat_deg.min(place.lat_deg);
        low.lon_deg = low.lon_deg.min(place.lon_deg);
        high.lat_deg = high.lat_deg.max(place.lat_deg);
        high.lon_deg = high.lon_deg.max(place.lon_deg);
    }
    let wide_deg = AROUND_DEG / middle.lat_deg.to_radians().cos().max(0.1);
    let south_west = LatLon {
        lat_deg: (low.lat_deg - AROUND_DEG).max(-89.9),
        lon_deg: (low.lon_deg - wide_deg).max(-180.0),
    };
    let north_east = LatLon {
        lat_deg: (high.lat_deg + AROUND_DEG).min(89.9),
        lon_deg: (high.lon_deg + wide_deg).min(180.0),
    };
    (south_west, north_east)
}

/// A spec with one vehicle somewhere in the area: the flags are checked as its keys.
fn prototype(
    (south_west, north_east): (LatLon, LatLon),
    (autopilot, airframe): (Autopilot, Airframe),
    speed_mps: f64,
    limits: &Limits,
) -> String {
    let between = |share: f64| {
        let mix = |a: f64, b: f64| a + (b - a) * share;
        format!(
            "lat: {}, lon: {}",
            mix(south_west.lat_deg, north_east.lat_deg),
            mix(south_west.lon_deg, north_east.lon_deg)
        )
    };
    let mut yaml = format!(
        "sortie: 1\nname: review\narea:\n  south_west: {{{}}}\n  north_east: {{{}}}\n  min_agl_m: {}\n  max_amsl_m: {}\n",
        between(0.0),
        between(1.0),
        limits.min_agl.unwrap_or(0.0),
        limits.max_amsl.unwrap_or(20_000.0),
    );
    yaml += &format!(
        "terrain: {{flat: {{amsl_m: 0}}}}\nseparation:\n  distance_m: {}\n  time_slack_s: {}\n",
        limits.separation.unwrap_or(1.0),
        limits.time_slack.unwrap_or(0.0),
    );
    if let Some(vertical_m) = limits.vertical_separation {
        yaml += &format!("  vertical_m: {vertical_m}\n");
    }
    yaml += &format!(
        "vehicles:\n- id: vehicle\n  sysid: 1\n  link: sim\n  finish: loiter\n  autopilot: {}\n  airframe: {}\n  \
         home: {{{}}}\n  start: {{{}, amsl_m: 100}}\n  goal: {{{}, amsl_m: 100}}\n  speed_mps: {speed_mps}\n",
        match autopilot {
            Autopilot::ArduPilot => "ardupilot",
            Autopilot::Px4 => "px4",
        },
        match airframe {
            Airframe::Copter => "copter",
            Airframe::Plane => "plane",
            Airframe::Vtol => "vtol",
        },
        between(0.2),
        between(0.3),
        between(0.7),
    );
    let heading_deg = match airframe {
        Airframe::Copter => None,
        Airframe::Plane => Some(limits.takeoff_heading.unwrap_or(0.0)),
        Airframe::Vtol => limits.takeoff_heading,
    };
    for (key, value) in [
        ("takeoff_heading_deg", heading_deg),
        ("max_load_factor", limits.load_factor),
        ("max_climb_deg", limits.max_climb),
        ("max_descent_deg", limits.max_descent),
        ("climb_mps", limits.climb),
        ("descent_mps", limits.descent),
        ("accel_mps2", limits.accel),
        ("return_amsl_m", limits.return_amsl),
    ] {
        if let Some(value) = value {
            yaml += &format!("  {key}: {value}\n");
        }
    }
    yaml
}

/// What the file says, or the flag, or ArduPilot.
fn autopilot(subject: &Subject, limits: &Limits, assumed: &mut Vec<String>) -> Autopilot {
    let asked = limits.autopilot.map(|name| match name {
        AutopilotName::Ardupilot => Autopilot::ArduPilot,
        AutopilotName::Px4 => Autopilot::Px4,
    });
    asked.or(subject.document.autopilot).unwrap_or_else(|| {
        assumed.push(format!(
            "{}: the file does not say for which autopilot it is: read as for ArduPilot (--autopilot)",
            subject.id
        ));
        Autopilot::ArduPilot
    })
}

/// What the flag says, or the first change of speed, or the default of the autopilot
/// (`WPNAV_SPEED`, `MPC_XY_CRUISE`, `AIRSPEED_CRUISE`, `FW_AIRSPD_TRIM`).
fn speed_mps(document: &Document, who: (Autopilot, Airframe), limits: &Limits) -> f64 {
    let changes = document.items.iter();
    let mut changes = changes.filter(|item| item.command == command::DO_CHANGE_SPEED);
    let in_mission = changes
        .find(|item| (0.5..=100.0).contains(&item.params[1]))
        .map(|item| f64::from(item.params[1]));
    let default = match who {
        (Autopilot::ArduPilot, Airframe::Copter) => 10.0,
        (Autopilot::Px4, Airframe::Copter) => 5.0,
        (Autopilot::ArduPilot, Airframe::Plane | Airframe::Vtol) => 12.0,
        (Autopilot::Px4, Airframe::Plane | Airframe::Vtol) => 15.0,
    };
    limits.speed.or(in_mission).unwrap_or(default)
}

/// Home as the file has it, or the flag, or on the terrain; 0, 0 is none, and the verdict says so.
fn home(
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
        return Ok(on_terrain.unwrap_or(Home {
            x: 0,
            y: 0,
            amsl_m: 0.0,
        }));
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

/// Puts the prototype where the mission is: its home, its first place, its last.
fn fit(vehicle: &mut Vehicle, subject: &Subject, home: &Home, index: usize) {
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
    // Stations need ground, of which there may be none; only homes are used of them.
    let mut world = World::new(spec, Terrain::Flat(Amsl(0.0)))
        .map_err(|error| Failure::new(Failure::INPUT, error.to_string()))?;
    for (index, mission) in missions {
        let home = spec.vehicles[*index].home;
        let row = Amsl(f64::from(mission.home.amsl_m));
        world.stations[*index].home.amsl = terrain.height(home).unwrap_or(row);
    }
    world.terrain = terrain;
    Ok(world)
}
