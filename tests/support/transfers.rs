//! Missions by number, and a transfer of one of them.
#![allow(dead_code, unreachable_pub, missing_docs)]

use sortie::link::{Address, Job, TransferReport, upload_fleet};
use sortie::mission::{Home, Item, VehicleMission, command, frame};
use sortie::spec::{Airframe, Autopilot, Link};

/// Our ground station.
pub const US: Address = Address {
    system: 245,
    component: 190,
};
/// Another one.
pub const STRANGER: Address = Address {
    system: 255,
    component: 190,
};
pub const HOME: Home = Home {
    x: 363_000_000,
    y: -842_500_000,
    amsl_m: 400.5,
};

/// As `tests/peers/vehicle_ground_station.py` numbers them.
pub fn waypoint(n: i32) -> Item {
    Item {
        command: command::NAV_WAYPOINT,
        frame: frame::GLOBAL,
        autocontinue: true,
        params: [0.0; 4],
        x: HOME.x + 100 * n,
        y: HOME.y - 70 * n,
        z: 480.25,
    }
}

/// One corner of an inclusion polygon of so many.
pub fn corner(n: i32, corners: u8) -> Item {
    Item {
        command: command::NAV_FENCE_POLYGON_VERTEX_INCLUSION,
        params: [f32::from(corners), 0.0, 0.0, 0.0],
        z: 0.0,
        ..waypoint(n)
    }
}

pub fn rally(n: i32) -> Item {
    Item {
        command: command::NAV_RALLY_POINT,
        frame: frame::GLOBAL_RELATIVE_ALT,
        z: 80.0,
        ..waypoint(n)
    }
}

/// A mission of these items, without fence and rally points.
pub fn mission(autopilot: Autopilot, items: Vec<Item>) -> VehicleMission {
    VehicleMission {
        autopilot_version: None,
        autopilot,
        airframe: Airframe::Copter,
        home: HOME,
        items,
        fence: Vec::new(),
        is_fence_known: true,
        rally: Vec::new(),
        params: Vec::new(),
        notes: Vec::new(),
    }
}

/// Over a real socket.
pub fn upload(sysid: u8, link: &Link, mission: &VehicleMission, force: bool) -> TransferReport {
    let job = Job {
        vehicle: "alpha",
        sysid,
        link,
        mission,
        force,
    };
    upload_fleet(&[job], &|_, _| {}).remove(0)
}
