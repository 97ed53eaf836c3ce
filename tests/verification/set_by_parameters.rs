//! Vehicles as the parameters of their missions set them: judged so, whatever the spec says.
#![allow(clippy::cast_possible_truncation)]

use crate::support;
use crate::support::missions;
use missions::{GROUND_M, at, land, level, mission, speed, takeoff, waypoint};
use sortie::geodesy::{Amsl, EastNorth, LatLon, true_airspeed_ratio};
use sortie::mission::{Item, Parameter, VehicleMission, command, frame};
use sortie::spec::*;
use sortie::verify::{Limit, Margin, review, verified_trajectories};
use support::{copter, empty_spec, place, plane, threat, vtol, world};

const UP_M: f64 = GROUND_M + 80.0;
const SPEED_MPS: f64 = 18.0;

fn spot(east_m: f64, north_m: f64) -> LatLon {
    empty_spec(vec![])
        .frame
        .from_plan(EastNorth { east_m, north_m })
}

fn margin(spec: &MissionSpec, mission: &VehicleMission, limit: &Limit) -> Margin {
    let review = review(spec, &world(spec), &[(0, mission)]);
    let mut margins = review.margins.into_iter();
    let found = margins.find(|margin| margin.limit == *limit);
    found.unwrap_or_else(|| panic!("{limit} is judged"))
}

fn with(mission: &VehicleMission, name: &str, value: f32) -> VehicleMission {
    let mut mission = mission.clone();
    mission.params.push(Parameter {
        name: name.to_owned(),
        value,
        why: String::new(),
    });
    mission
}

/// A wing from the origin eastward by a place that is 40 m higher to a circle of 100 m for ever.
fn wing(mut vehicle: Vehicle, takeoff: Item) -> (MissionSpec, VehicleMission) {
    (vehicle.finish, vehicle.speed_mps) = (Finish::Loiter, SPEED_MPS);
    vehicle.climb_mps = 3.0;
    let speed = Item::without_place(command::DO_CHANGE_SPEED, [0.0, SPEED_MPS as f32, -1.0, 0.0]);
    let top_m = UP_M + 40.0;
    let circle = Item {
        params: [0.0, 0.0, 100.0, 0.0],
        ..at(
            command::NAV_LOITER_UNLIM,
            frame::GLOBAL,
            spot(3000.0, 0.0),
            top_m,
            0.0,
        )
    };
    let items = vec![takeoff, speed, waypoint(spot(1500.0, 0.0), top_m), circle];
    let mission = mission(&vehicle, GROUND_M, items);
    (
        empty_spec(vec![vehicle]),
        with(&mission, "WP_LOITER_RAD", 100.0),
    )
}

fn heron() -> (MissionSpec, VehicleMission) {
    let mut vehicle = plane("heron", 1, spot(0.0, 0.0), spot(3000.0, 0.0));
    vehicle.home = spot(-600.0, 0.0);
    let takeoff = at(
        command::NAV_TAKEOFF,
        frame::GLOBAL,
        spot(0.0, 0.0),
        UP_M,
        8.0,
    );
    wing(vehicle, takeoff)
}

#[test]
fn a_wing_climbs_no_faster_than_its_parameters_let_it() {
    let (spec, mut mission) = heron();
    mission.items[2] = waypoint(spot(1500.0, 0.0), UP_M + 80.0);
    let climb = |mission: &VehicleMission| margin(&spec, mission, &Limit::ClimbSpeed);
    let planned = climb(&mission);
    assert!(
        planned.ok && (planned.bound - 3.0).abs() < 1e-9,
        "{planned:?}"
    );
    // It then has its first height at 880 m, and 80 m more at 1500 m.
    let slow = climb(&with(&mission, "TECS_CLMB_MAX", 1.0));
    assert!(!slow.ok && (slow.bound - 1.0).abs() < 1e-6, "{slow:?}");
    assert!(slow.value > 2.0, "{slow:?}");
    let quick = climb(&with(&mission, "TECS_CLMB_MAX", 9.0));
    assert!((quick.bound - 3.0).abs() < 1e-9, "{quick:?}");
}

#[test]
fn the_wind_drives_a_quadplane_off_for_as_long_as_the_parameters_of_its_rotors_have_it_rise() {
    let vehicle = vtol(plane("osprey", 1, spot(0.0, 0.0), spot(3000.0, 0.0)));
    let relative = frame::GLOBAL_RELATIVE_ALT;
    let takeoff = at(
        command::NAV_VTOL_TAKEOFF,
        relative,
        spot(0.0, 0.0),
        80.0,
        0.0,
    );
    let (mut spec, mission) = wing(vehicle, takeoff);
    let wind = Wind {
        from_rad: 0.0,
        speed_mps: 4.0,
    };
    spec.wind = Some(wind);
    for vehicle in &mut spec.vehicles {
        vehicle.wind = Some(wind);
    }
    // 80 m at 0.5 m/s are 160 s, in which 0.8 of the wind goes 512 m.
    let slow = with(&mission, "Q_WP_SPEED_UP", 50.0);
    spec.threats = vec![threat("mast", spot(-300.0, -600.0), 1.0)];
    let mast = Limit::Threat("mast".to_owned());
    let away_m = [&mission, &slow].map(|mission| margin(&spec, mission, &mast).value);
    assert!(away_m[0] > 100.0 && away_m[1] < 10.0, "{away_m:?}");
    let flown = verified_trajectories(&spec, &world(&spec), &[(0, &slow)]);
    let up = &flown[0].segments[0];
    assert!((up.to.t_s - up.from.t_s - 160.0).abs() < 0.1, "{up:?}");
}

#[test]
fn a_copter_flies_a_steep_leg_as_slowly_as_its_parameters_have_it_climb() {
    let (from, to) = (place(36.30, -84.30), place(36.30, -84.25));
    let vehicle = copter("alpha", 1, from, to);
    let items = vec![
        takeoff(from, UP_M),
        speed(15.0),
        waypoint(to, UP_M + 200.0),
        land(to),
    ];
    let mission = mission(&vehicle, GROUND_M, items);
    let spec = empty_spec(vec![vehicle]);
    // 4493 m at 15 m/s; 200 m at 0.2 m/s. At both ends it takes some seconds more.
    let slow = with(&mission, "WPNAV_SPEED_UP", 20.0);
    for (mission, lasts_s, is_good) in [(&mission, 299.5, true), (&slow, 999.9, false)] {
        let flown = verified_trajectories(&spec, &world(&spec), &[(0, mission)]);
        let leg = flown[0].segments.iter().filter(|part| part.from.item == 3);
        let flown_s: f64 = leg.map(|part| part.to.t_s - part.from.t_s).sum();
        assert!((lasts_s..lasts_s + 8.0).contains(&flown_s), "{flown_s}");
        let climb = margin(&spec, mission, &Limit::ClimbSpeed);
        assert_eq!(climb.ok, is_good, "{climb:?}");
        assert!((climb.value - 0.668).abs() < 0.01, "{climb:?}");
    }
}

#[test]
fn a_wing_that_is_to_circle_tighter_than_it_turns_fails() {
    let (spec, mission) = heron();
    for (radius_m, is_good) in [(5.0, false), (45.0, false), (60.0, true)] {
        let mut mission = mission.clone();
        let circle = Item {
            params: [5.0, 0.0, radius_m, 0.0],
            ..at(
                command::NAV_LOITER_TURNS,
                frame::GLOBAL,
                spot(1500.0, 0.0),
                UP_M + 40.0,
                5.0,
            )
        };
        mission.items[2] = circle;
        let found = margin(&spec, &mission, &Limit::LoiterRadius);
        assert_eq!(found.ok, is_good, "{radius_m}: {found:?}");
        if !is_good {
            // 18 m/s indicated are 18.5 m/s at 520 m: 52.6 m with a load factor of 1.2.
            assert!((found.bound - 52.6).abs() < 0.5, "{found:?}");
            assert!(found.note.contains("cannot turn so tightly"), "{found:?}");
        }
    }
}

#[test]
fn a_bank_that_the_parameters_do_not_allow_makes_no_circle() {
    let (spec, mission) = heron();
    let radius = |mission: &VehicleMission| margin(&spec, mission, &Limit::LoiterRadius);
    assert!(radius(&mission).ok);
    assert!(radius(&with(&mission, "ROLL_LIMIT_DEG", 45.0)).ok);
    for (name, value) in [("ROLL_LIMIT_DEG", 10.0), ("LIM_ROLL_CD", 1000.0)] {
        // 18.5^2 / (g tan 10 degrees).
        let found = radius(&with(&mission, name, value));
        assert!(!found.ok && (found.bound - 198.0).abs() < 2.0, "{found:?}");
    }
}

#[test]
fn a_plane_circles_wider_with_altitude_unless_its_bank_has_a_limit() {
    let (spec, mission) = heron();
    let radius_m = |mission: &VehicleMission| margin(&spec, mission, &Limit::LoiterRadius).value;
    let dense = true_airspeed_ratio(Amsl(UP_M + 40.0)).powi(2);
    assert!(dense > 1.02, "{dense}");
    // Altitudes of items are float32.
    assert!((radius_m(&mission) - 100.0 * dense).abs() < 0.01);
    let limited = with(&mission, "NAVL1_LIM_BANK", 40.0);
    assert!((radius_m(&limited) - 100.0).abs() < 1e-9);
    // 18 m/s with 20 degrees need 91 m at the sea, with 15 degrees 123 m: that is too wide, and the limit no longer counts.
    let flat = 18.0 * 18.0 / (GRAVITY_MPS2 * 20.0_f64.to_radians().tan()) * dense;
    let steeper = with(&mission, "NAVL1_LIM_BANK", 20.0);
    assert!((radius_m(&steeper) - flat.max(100.0)).abs() < 0.01);
    let flatter = with(&mission, "NAVL1_LIM_BANK", 15.0);
    assert!((radius_m(&flatter) - 100.0 * dense).abs() < 0.01);
}

#[test]
fn parameters_that_change_the_flight_unknown_to_the_verdict_fail() {
    let (spec, plane) = heron();
    let judged = |name: &str, value: f32| {
        let mission = with(&plane, name, value);
        let review = review(&spec, &world(&spec), &[(0, &mission)]);
        let mut margins = review.margins.into_iter();
        let failed = margins.find(|margin| !margin.ok && margin.note.contains(name));
        failed.map(|margin| margin.note)
    };
    for (name, known, unknown) in [
        ("MIN_GROUNDSPEED", 0.0, 6.1),
        ("MIN_GNDSPD_CM", 0.0, 610.0),
        ("FLIGHT_OPTIONS", 2.0, 16_384.0),
        ("SOAR_ENABLE", 0.0, 1.0),
        ("ARSPD_USE", 1.0, 0.0),
        ("ARSPD_USE", 1.0, 2.0),
        ("ARSPD_TYPE", 2.0, 0.0),
        ("ARSPD_ENABLE", 1.0, 0.0),
    ] {
        assert_eq!(judged(name, known), None);
        let note = judged(name, unknown).unwrap_or_default();
        let words = format!("a flight with {name} {unknown} (");
        assert!(note.contains(&words), "{name}: {note}");
    }
}

#[test]
fn a_px4_copter_flies_to_the_place_of_its_takeoff_however_near_that_is() {
    let (from, to) = (place(36.30, -84.30), place(36.30, -84.25));
    let mut vehicle = copter("alpha", 1, from, to);
    vehicle.autopilot = Autopilot::Px4;
    let mut mission = level(&vehicle, UP_M, &[from, to]);
    let mut spec = empty_spec(vec![vehicle]);
    spec.mission.tolerance_m = 100.0;
    // 89 m north of home, and a mast between.
    let aside = place(36.3008, -84.30);
    mission.items[0] = takeoff(aside, UP_M);
    spec.threats = vec![threat("mast", place(36.3006, -84.30), 10.0)];
    let found = margin(&spec, &mission, &Limit::Threat("mast".to_owned()));
    assert!(!found.ok && found.value < 0.0, "{found:?}");
}
