//! Fixtures shared by the tests.
#![allow(dead_code, unreachable_pub, missing_docs)]

pub mod command;
pub mod doctored;
pub mod in_flight;
pub mod lossy_link;
pub mod lossy_proxy;
pub mod mavsdk;
pub mod missions;
pub mod peers;
pub mod plans;
pub mod ports;
pub mod sky;
pub mod tile_server;
pub mod transfers;
pub mod wings;

use std::f64::consts::FRAC_PI_2;
use std::path::Path;

use sortie::geodesy::{Agl, Amsl, LatLon, LocalFrame};
use sortie::spec::*;
use sortie::study::scenario;
use sortie::world::{Terrain, World};

pub fn place(lat_deg: f64, lon_deg: f64) -> LatLon {
    LatLon { lat_deg, lon_deg }
}

/// A radar.
pub fn threat(id: &str, at: LatLon, radius_m: f64) -> Threat {
    Threat {
        id: id.to_owned(),
        kind: "radar".to_owned(),
        place: at,
        radius_m,
    }
}

/// What `sortie study scenario` writes.
pub fn generated(seed: u64, difficulty: u8) -> SpecFile {
    match Document::parse(Path::new("scenario.yaml"), scenario(seed, difficulty)) {
        Ok(Document::Mission(file)) => *file,
        other => panic!("{other:?}"),
    }
}

/// 16 km from `EAST`, over the made ground of the tests.
pub const WEST: LatLon = LatLon {
    lat_deg: 36.30,
    lon_deg: -84.34,
};
pub const EAST: LatLon = LatLon {
    lat_deg: 36.30,
    lon_deg: -84.16,
};

/// An ArduPilot copter that flies from one place to another at 80 m above ground.
pub fn copter(id: &str, sysid: u8, start: LatLon, goal: LatLon) -> Vehicle {
    let airborne = |place| EndPoint {
        place,
        altitude: Placement::Agl(Agl(80.0)),
    };
    Vehicle {
        id: id.to_owned(),
        sysid,
        autopilot: Autopilot::ArduPilot,
        airframe: Airframe::Copter,
        link: Link::Sim,
        home: start,
        start: airborne(start),
        goal: airborne(goal),
        stops: Vec::new(),
        order: Order::Fixed,
        on_way: OnWay::default(),
        finish: Finish::Land,
        autopilot_version: None,
        speed_mps: 15.0,
        max_load_factor: 1.2,
        max_climb_rad: Some(15_f64.to_radians()),
        max_descent_rad: Some(10_f64.to_radians()),
        climb_mps: 5.0,
        descent_mps: 3.0,
        accel_mps2: 2.5,
        max_airspeed_mps: None,
        depart_s: 0.0,
        retiming: Retiming::default(),
        altitudes: AltitudeLimits::default(),
        endurance: None,
        fence_points: None,
        return_amsl: None,
        wind: None,
        wing: None,
    }
}

/// A plane that takes off and lands eastward.
pub fn plane(id: &str, sysid: u8, start: LatLon, goal: LatLon) -> Vehicle {
    Vehicle {
        airframe: Airframe::Plane,
        wing: Some(Wing {
            takeoff_heading_rad: Some(FRAC_PI_2),
            landing: Some(Landing {
                heading_rad: Some(FRAC_PI_2),
                glide_rad: 6_f64.to_radians(),
            }),
            loiter_radius_m: 100.0,
            ceiling: Amsl(1500.0),
        }),
        ..copter(id, sysid, start, goal)
    }
}

/// The same on rotors at its two ends: it rises at its start.
pub fn vtol(plane: Vehicle) -> Vehicle {
    Vehicle {
        airframe: Airframe::Vtol,
        home: plane.start.place,
        wing: plane.wing.map(|wing| Wing {
            takeoff_heading_rad: None,
            landing: None,
            ..wing
        }),
        ..plane
    }
}

/// A 20 km square around 36.30 N 84.25 W over flat ground at 400 m, nothing in it.
pub fn empty_spec(vehicles: Vec<Vehicle>) -> MissionSpec {
    MissionSpec {
        version: 1,
        name: "test".to_owned(),
        frame: LocalFrame::new(place(36.30, -84.25)),
        area: Area {
            south_west: place(36.21, -84.36),
            north_east: place(36.39, -84.14),
            min_agl: Agl(60.0),
            max_amsl: Amsl(1500.0),
            altitudes: AltitudeLimits::default(),
        },
        terrain: TerrainSource::Flat(Amsl(400.0)),
        tasks: Vec::new(),
        threats: Vec::new(),
        no_fly: Vec::new(),
        rally: Vec::new(),
        vehicles,
        separation: Separation {
            distance_m: 100.0,
            time_slack_s: 5.0,
            vertical_m: None,
        },
        buffers: Buffers::NONE,
        planner: Planner {
            algorithm: Algorithm::Msfoa,
            objective: Objective::Operational,
            seed: 1,
            evaluations: 5000,
            control_points: 8,
            samples: 101,
            weights: Weights::default(),
            swarms: None,
            population: None,
            threshold: None,
            step: None,
        },
        mission: MissionOptions {
            altitude: AltitudeReference::Amsl,
            tolerance_m: 5.0,
            max_items: 200,
            fence: true,
        },
        wind: None,
        on_link_loss: OnLinkLoss::Continue,
        on_alarm: sortie::spec::OnAlarm::default(),
    }
}

/// The world of a spec whose terrain is flat or analytic.
pub fn world(spec: &MissionSpec) -> World {
    let terrain = match &spec.terrain {
        TerrainSource::Flat(amsl) => Terrain::Flat(*amsl),
        TerrainSource::Analytic { base, hills } => Terrain::Analytic {
            base: *base,
            hills: hills.clone(),
        },
        TerrainSource::File(file) | TerrainSource::Folder(file) => {
            panic!("{} is not for this fixture", file.display())
        }
    };
    World::new(spec, terrain).expect("ground everywhere")
}
