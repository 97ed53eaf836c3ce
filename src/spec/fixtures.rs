//! Vehicles for the tests of other folders.

use super::{
    Airframe, AltitudeLimits, Autopilot, EndPoint, Finish, Link, OnWay, Order, Placement, Retiming,
    Vehicle,
};
use crate::geodesy::{Agl, LatLon};

/// A copter at 10 m/s with 2 m/s^2 that lands at its goal. Home, start and goal are one position.
pub(crate) fn copter() -> Vehicle {
    let place = LatLon {
        lat_deg: 36.0,
        lon_deg: -84.0,
    };
    let end = EndPoint {
        place,
        altitude: Placement::Agl(Agl(80.0)),
    };
    Vehicle {
        id: "alpha".to_owned(),
        sysid: 1,
        autopilot: Autopilot::ArduPilot,
        autopilot_version: None,
        airframe: Airframe::Copter,
        link: Link::Sim,
        home: place,
        start: end,
        goal: end,
        stops: Vec::new(),
        order: Order::Fixed,
        on_way: OnWay::default(),
        finish: Finish::Land,
        speed_mps: 10.0,
        max_load_factor: 1.2,
        max_climb_rad: None,
        max_descent_rad: None,
        climb_mps: 4.0,
        descent_mps: 2.0,
        accel_mps2: 2.0,
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
