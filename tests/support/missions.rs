//! Missions item by item, for tests of what is made of them.
#![allow(dead_code, unreachable_pub, missing_docs)]
#![allow(clippy::cast_possible_truncation)]

use sortie::geodesy::LatLon;
use sortie::mission::{Home, Item, Parameter, VehicleMission, command, frame};
use sortie::spec::{Autopilot, Vehicle};

pub const GROUND_M: f64 = 400.0;

pub fn degrees(value: f64) -> i32 {
    (value * 1e7).round() as i32
}

pub fn at(command: u16, frame: u8, place: LatLon, z: f64, param1: f32) -> Item {
    Item {
        command,
        frame,
        autocontinue: true,
        params: [param1, 0.0, 0.0, 0.0],
        x: degrees(place.lat_deg),
        y: degrees(place.lon_deg),
        z: z as f32,
    }
}

pub fn waypoint(place: LatLon, amsl_m: f64) -> Item {
    at(command::NAV_WAYPOINT, frame::GLOBAL, place, amsl_m, 0.0)
}

pub fn takeoff(place: LatLon, amsl_m: f64) -> Item {
    at(command::NAV_TAKEOFF, frame::GLOBAL, place, amsl_m, 0.0)
}

pub fn land(place: LatLon) -> Item {
    at(command::NAV_LAND, frame::GLOBAL, place, 0.0, 0.0)
}

pub fn speed(speed_mps: f32) -> Item {
    Item::without_place(command::DO_CHANGE_SPEED, [1.0, speed_mps, -1.0, 0.0])
}

pub fn delay(delay_s: f32) -> Item {
    Item::without_place(command::NAV_DELAY, [delay_s, 0.0, 0.0, 0.0])
}

/// PX4 takes off as fast as it climbs, as plans set it.
pub fn quick_takeoff() -> Parameter {
    Parameter {
        name: "MPC_TKO_SPEED".to_owned(),
        value: 10.0,
        why: String::new(),
    }
}

/// It stays armed on the ground until its departure, as plans set it.
fn stays_armed(autopilot: Autopilot) -> Parameter {
    let (name, value) = match autopilot {
        Autopilot::ArduPilot => ("DISARM_DELAY", 0.0),
        Autopilot::Px4 => ("COM_DISARM_PRFLT", -1.0),
    };
    Parameter {
        name: name.to_owned(),
        value,
        why: String::new(),
    }
}

/// With posts so close that an autopilot follows the ground itself.
pub fn with_close_posts(mut mission: VehicleMission) -> VehicleMission {
    mission.params.push(Parameter {
        name: "TERRAIN_SPACING".to_owned(),
        value: 0.5,
        why: String::new(),
    });
    mission
}

pub fn mission(vehicle: &Vehicle, home_m: f64, items: Vec<Item>) -> VehicleMission {
    VehicleMission {
        autopilot_version: None,
        autopilot: vehicle.autopilot,
        airframe: vehicle.airframe,
        home: Home {
            x: degrees(vehicle.home.lat_deg),
            y: degrees(vehicle.home.lon_deg),
            amsl_m: home_m as f32,
        },
        items,
        fence: Vec::new(),
        rally: Vec::new(),
        params: vec![stays_armed(vehicle.autopilot)],
        is_fence_known: false,
        notes: Vec::new(),
    }
}

/// Up, along the places at one altitude, down at the last.
pub fn level(vehicle: &Vehicle, amsl_m: f64, places: &[LatLon]) -> VehicleMission {
    let mut items = vec![takeoff(places[0], amsl_m), speed(15.0)];
    items.extend(places[1..].iter().map(|&place| waypoint(place, amsl_m)));
    items.push(land(places[places.len() - 1]));
    mission(vehicle, GROUND_M, items)
}
