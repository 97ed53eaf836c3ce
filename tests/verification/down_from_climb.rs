//! Where a simulated QuadPlane was that was sent down at once behind its climb: judged there.
#![allow(clippy::cast_possible_truncation)]

use crate::support;
use crate::support::missions;
use missions::{GROUND_M, at, mission, speed, waypoint};
use sortie::geodesy::{Amsl, EastNorth, LatLon};
use sortie::mission::{VehicleMission, command, frame};
use sortie::spec::*;
use sortie::verify::{Limit, review};
use support::{empty_spec, plane, vtol, world};

/// Metres along its course and above the ground: its waypoints, and where it was 51 to 65 s after T0.
const PLANNED: [(f64, f64); 4] = [(290.0, 88.4), (330.0, 79.9), (423.0, 60.0), (1500.0, 60.0)];
const FLOWN: [(f64, f64); 5] = [
    (327.5, 119.1),
    (406.1, 104.7),
    (430.0, 100.0),
    (518.4, 82.0),
    (603.7, 65.8),
];

fn spot(north_m: f64) -> LatLon {
    let spec = empty_spec(vec![]);
    spec.frame.from_plan(EastNorth {
        east_m: 0.0,
        north_m,
    })
}

/// Another one, and where it was 68 s after T0: not on the tangent to its circle, but straight to the middle.
const SLOWER: [(f64, f64); 4] = [(230.0, 101.1), (270.0, 92.6), (423.4, 60.0), (1500.0, 60.0)];
const STILL_UP: (f64, f64) = (586.6, 85.0);

/// Its mission from a climb to 150 m, down at 12 degrees.
fn planned(speed_mps: f64, places: [(f64, f64); 4]) -> (MissionSpec, VehicleMission) {
    let mut vehicle = vtol(plane("osprey", 1, spot(0.0), spot(1500.0)));
    (vehicle.finish, vehicle.speed_mps) = (Finish::Loiter, speed_mps);
    (vehicle.climb_mps, vehicle.descent_mps) = (4.5, 4.5);
    let relative = frame::GLOBAL_RELATIVE_ALT;
    let takeoff = at(command::NAV_VTOL_TAKEOFF, relative, spot(0.0), 150.0, 0.0);
    let mut items = vec![takeoff, speed(speed_mps as f32)];
    items[1].params[0] = 0.0;
    items.extend(places.map(|(along_m, up_m)| waypoint(spot(along_m), GROUND_M + up_m)));
    if let Some(last) = items.last_mut() {
        last.command = command::NAV_LOITER_UNLIM;
        last.params[2] = 80.0;
    }
    let mission = mission(&vehicle, GROUND_M, items);
    (empty_spec(vec![vehicle]), mission)
}

/// How far inside all that is judged a place is, 10 m up and down, metres.
fn inside_m((spec, mission): &(MissionSpec, VehicleMission), (along_m, up_m): (f64, f64)) -> f64 {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(east_m, north_m)| {
        spec.frame.from_plan(EastNorth {
            east_m,
            north_m: along_m + north_m,
        })
    });
    let amsl = |metres: f64| Some(Placement::Amsl(Amsl(GROUND_M + up_m + metres)));
    let mut spec = spec.clone();
    spec.no_fly = vec![Zone {
        id: "place".to_owned(),
        polygon: corners.to_vec(),
        floor: amsl(-10.0),
        ceiling: amsl(10.0),
        ..Zone::default()
    }];
    let review = review(&spec, &world(&spec), &[(0, mission)]);
    let zone = Limit::Zone("place".to_owned());
    let margin = review.margins.into_iter().find(|of| of.limit == zone);
    -margin.expect("judged").value
}

/// ArduPlane 4.7.0-dev of February 2026, its simulated QuadPlane in still air: it hardly descended while it accelerated,
/// and was 22.8 to 25.8 m above all that was judged, of 15 m that a buffer allows. What is judged now is within 10 m of it.
#[test]
fn a_quadplane_that_stays_up_behind_its_climb_is_judged_where_one_was_flown() {
    let planned = planned(20.0, PLANNED);
    for place in FLOWN {
        let inside_m = inside_m(&planned, place);
        assert!(inside_m > 0.0, "{inside_m} m inside at {place:?}");
    }
}

/// As above: it was 19.9 m above all that was judged on its way to the circle.
#[test]
fn a_wing_that_is_still_above_its_legs_flies_so_straight_to_the_middle_of_its_circle() {
    let inside_m = inside_m(&planned(16.0, SLOWER), STILL_UP);
    assert!(inside_m > 0.0, "{inside_m} m inside");
}

/// It stays up, and does not climb: its highest place is the top of its climb, and 3.3 s of a descent of 4.25 m/s at most.
#[test]
fn a_quadplane_that_stays_up_is_no_higher_than_its_climb() {
    let (spec, mission) = planned(20.0, PLANNED);
    let review = review(&spec, &world(&spec), &[(0, &mission)]);
    let ceiling = (review.margins.iter()).find(|of| of.limit == Limit::Ceiling);
    let above_m = ceiling.expect("judged").value - (GROUND_M + 150.0);
    assert!((1.0..14.1).contains(&above_m), "{above_m} m");
}
