//! What the verdict counts where a vehicle is later than the flight model has it.

use crate::support;
use crate::support::missions;
use missions::{GROUND_M, at, land, mission, speed, takeoff, waypoint};
use sortie::geodesy::{Agl, Amsl, EastNorth, LatLon, PlanPoint};
use sortie::mission::{Item, Parameter, VehicleMission, command, frame};
use sortie::spec::*;
use sortie::verify::{
    Limit, Margin, Review, VerifiedSegment, VerifiedTrajectory, review, verified_trajectories,
};
use sortie::world::{Departure, World};
use support::{copter, empty_spec, world};

const UP_M: f64 = GROUND_M + 80.0;

/// A place by metres east and north of the origin.
fn spot(east_m: f64, north_m: f64) -> LatLon {
    let spec = empty_spec(vec![]);
    spec.frame.from_plan(EastNorth { east_m, north_m })
}

/// A copter between two places, at 10 m/s.
fn slow(id: &str, sysid: u8, from: LatLon, to: LatLon) -> Vehicle {
    let mut vehicle = copter(id, sysid, from, to);
    vehicle.speed_mps = 10.0;
    vehicle
}

/// Its mission over some items.
fn over(vehicle: &Vehicle, items: &[Item]) -> VehicleMission {
    let last = items.last().and_then(Item::place).expect("a place");
    let mut all = vec![takeoff(vehicle.home, UP_M), speed(10.0)];
    all.extend_from_slice(items);
    all.push(land(last));
    mission(vehicle, GROUND_M, all)
}

/// The world of a spec whose first vehicle is in the air at a time, on its way to the east.
fn with_first_in_the_air(spec: &MissionSpec, from: EastNorth, at_s: f64) -> World {
    let mut world = world(spec);
    world.sites[0].departure = Departure::Airborne {
        point: PlanPoint::new(from.east_m, from.north_m, Amsl(UP_M)),
        course_rad: std::f64::consts::FRAC_PI_2,
        speed_mps: 10.0,
        at_s,
    };
    world
}

fn find(review: &Review, limit: &Limit) -> Margin {
    let mut margins = review.margins.iter();
    let found = margins.find(|margin| margin.limit == *limit);
    found.unwrap_or_else(|| panic!("no {limit}")).clone()
}

fn verified(spec: &MissionSpec, world: &World, mission: &VehicleMission) -> VerifiedTrajectory {
    verified_trajectories(spec, world, &[(0, mission)]).remove(0)
}

fn flown(verified: &VerifiedTrajectory) -> Vec<&VerifiedSegment> {
    let segments = verified.segments.iter();
    segments.filter(|segment| segment.is_flown).collect()
}

/// The margin of the endurance, where the vehicle has so many seconds.
fn endurance(
    (spec, world): (&MissionSpec, &World),
    mission: &VehicleMission,
    time_s: f64,
) -> Margin {
    let mut spec = spec.clone();
    spec.vehicles[0].endurance = Some(Endurance {
        capacity: Capacity::Time(time_s),
        reserve: 0.0,
    });
    find(&review(&spec, world, &[(0, mission)]), &Limit::Endurance)
}

#[test]
fn endurance_includes_what_a_vehicle_is_late_by_from_its_takeoff_on() {
    let vehicle = slow("alpha", 1, spot(0.0, 0.0), spot(900.0, 0.0));
    let mission = over(&vehicle, &[waypoint(spot(900.0, 0.0), UP_M)]);
    let spec = empty_spec(vec![vehicle]);
    let world = world(&spec);
    let verified = verified(&spec, &world, &mission);
    let segments = flown(&verified);
    let (first, last) = (segments[0], segments[segments.len() - 1]);
    let in_air_s = last.to.t_s - first.from.t_s + last.late_s;
    assert!(verified.takeoff_late_s.most > 10.0);
    let needs_s = in_air_s + verified.takeoff_late_s.most;
    let short = endurance((&spec, &world), &mission, needs_s - 1.0);
    assert!(
        !short.ok && (short.value - needs_s).abs() < 1e-6,
        "{short:?}"
    );
    assert!(endurance((&spec, &world), &mission, needs_s + 1.0).ok);
}

#[test]
fn endurance_from_a_place_in_the_air_has_what_was_flown_before_and_no_late_takeoff() {
    let vehicle = slow("alpha", 1, spot(0.0, 0.0), spot(900.0, 0.0));
    let items = vec![
        speed(10.0),
        waypoint(spot(900.0, 0.0), UP_M),
        land(spot(900.0, 0.0)),
    ];
    let mission = mission(&vehicle, GROUND_M, items);
    let mut spec = empty_spec(vec![vehicle]);
    spec.vehicles[0].depart_s = 30.0;
    let from = EastNorth {
        east_m: 100.0,
        north_m: 0.0,
    };
    for (at_s, before_s) in [(0.0, 0.0), (530.0, 500.0)] {
        let world = with_first_in_the_air(&spec, from, at_s);
        let verified = verified(&spec, &world, &mission);
        let segments = flown(&verified);
        let last = segments[segments.len() - 1];
        let used_s = endurance((&spec, &world), &mission, 1000.0).value;
        let in_air_s = before_s + last.to.t_s - at_s + last.late_s;
        assert!((used_s - in_air_s).abs() < 1e-6, "{used_s} {in_air_s}");
        let short = endurance((&spec, &world), &mission, in_air_s - 1.0);
        assert!(!short.ok, "{short:?}");
    }
}

/// The separation of one that crosses the way of another of its kind, which is in the air at T0 and at the
/// crossing after 100 s, from a start so far before the crossing.
fn crossed_from(south_m: f64) -> Margin {
    let alpha = slow("alpha", 1, spot(-1000.0, 0.0), spot(1000.0, 0.0));
    let bravo = slow("bravo", 2, spot(0.0, -south_m), spot(0.0, 900.0));
    let end = spot(1000.0, 0.0);
    let items = vec![speed(10.0), waypoint(end, UP_M), land(end)];
    let in_the_air = mission(&alpha, GROUND_M, items);
    let from_ground = over(&bravo, &[waypoint(spot(0.0, 900.0), UP_M)]);
    let mut spec = empty_spec(vec![alpha, bravo]);
    spec.separation.distance_m = 50.0;
    spec.separation.vertical_m = None;
    spec.separation.time_slack_s = 5.0;
    let from = EastNorth {
        east_m: -1000.0,
        north_m: 0.0,
    };
    let world = with_first_in_the_air(&spec, from, 0.0);
    let judged = review(&spec, &world, &[(0, &in_the_air), (1, &from_ground)]);
    find(&judged, &Limit::Separation)
}

#[test]
fn a_vehicle_on_the_ground_is_not_late_alike_with_one_of_its_kind_in_the_air() {
    // Some 20 s before the other; late from its takeoff on by up to 12 s, and by a stop.
    let before = crossed_from(620.0);
    assert!(!before.ok, "{before:?}");
    // Some 14 s behind it, and the other has no takeoff to be late from.
    let behind = crossed_from(960.0);
    assert!(behind.ok, "{behind:?}");
    assert!(behind.value < 100.0, "{behind:?}");
}

/// A copter that flies a full circle of 100 m around a place, and its mission.
fn around(middle: LatLon) -> (MissionSpec, VehicleMission) {
    let end = spot(900.0, 0.0);
    let vehicle = slow("alpha", 1, spot(0.0, 0.0), end);
    let circle = Item {
        params: [1.0, 0.0, 100.0, 0.0],
        ..at(command::NAV_LOITER_TURNS, frame::GLOBAL, middle, UP_M, 0.0)
    };
    let mission = over(&vehicle, &[circle, waypoint(end, UP_M)]);
    (empty_spec(vec![vehicle]), mission)
}

#[test]
fn a_copter_may_be_late_on_its_circle_when_a_zone_there_becomes_active() {
    let middle = EastNorth {
        east_m: 400.0,
        north_m: 0.0,
    };
    let (mut spec, mission) = around(spot(middle.east_m, middle.north_m));
    let plain = world(&spec);
    let verified = verified(&spec, &plain, &mission);
    let on_circle: Vec<&VerifiedSegment> = flown(&verified)
        .into_iter()
        .filter(|segment| {
            let to_middle = |at: LatLon| plain.frame.to_plan(at).distance_m(middle);
            [segment.from.place, segment.to.place]
                .iter()
                .all(|at| (to_middle(*at) - 100.0).abs() < 0.02)
        })
        .collect();
    assert!(on_circle.len() > 100, "{}", on_circle.len());
    let passed = on_circle[on_circle.len() * 9 / 10].from;
    // It stops where the circle begins.
    let before_s = late_before_s(&verified, on_circle[0].from.t_s) + 4.5;
    let shift_s = verified.takeoff_late_s.most + spec.separation.time_slack_s;
    // One that loses nothing on the circle has left the zone by then.
    let begins_s = passed.t_s + 1.0 + before_s + shift_s;
    spec.no_fly = vec![Zone {
        id: "later".to_owned(),
        circle: Some((passed.place, 5.0)),
        active_s: Some((begins_s, 1000.0)),
        ..Zone::default()
    }];
    let judged = review(&spec, &world(&spec), &[(0, &mission)]);
    let margin = find(&judged, &Limit::Zone("later".to_owned()));
    assert!(!margin.ok, "{margin:?}");
}

/// By how much it may be late on what it has flown by a time, seconds.
fn late_before_s(verified: &VerifiedTrajectory, t_s: f64) -> f64 {
    let earlier = flown(verified).into_iter().filter(|one| one.to.t_s <= t_s);
    earlier.map(|one| one.late_s).fold(0.0, f64::max)
}

#[test]
fn a_copter_becomes_late_along_a_spline_and_not_behind_it() {
    let (middle, end) = (spot(600.0, 300.0), spot(900.0, 0.0));
    let vehicle = slow("alpha", 1, spot(0.0, 0.0), end);
    let spline = at(
        command::NAV_SPLINE_WAYPOINT,
        frame::GLOBAL,
        middle,
        UP_M,
        0.0,
    );
    let mission = over(&vehicle, &[spline, waypoint(end, UP_M)]);
    let spec = empty_spec(vec![vehicle]);
    let verified = verified(&spec, &world(&spec), &mission);
    let segments = flown(&verified);
    let on_spline: Vec<&&VerifiedSegment> = (segments.iter())
        .filter(|segment| segment.to.item == 3)
        .collect();
    let after = segments.iter().find(|segment| segment.to.item == 4);
    let (first, last) = (on_spline[0], on_spline[on_spline.len() - 1]);
    let after_s = after.expect("a leg").late_s;
    assert!((last.late_s - after_s).abs() < 1e-9, "{after_s}");
    assert!(first.late_s < after_s - 4.0, "{after_s}");
    let grows = on_spline
        .windows(2)
        .all(|pair| pair[0].late_s < pair[1].late_s);
    assert!(grows);
}

#[test]
fn a_copter_of_px4_with_a_slow_takeoff_is_late_on_its_way_up_already() {
    let mut vehicle = slow("alpha", 1, spot(0.0, 0.0), spot(900.0, 0.0));
    vehicle.autopilot = Autopilot::Px4;
    let mut mission = over(&vehicle, &[waypoint(spot(900.0, 0.0), UP_M)]);
    mission.params = vec![Parameter {
        value: 1.0,
        ..missions::quick_takeoff()
    }];
    let mut spec = empty_spec(vec![vehicle]);
    spec.separation.time_slack_s = 5.0;
    // 10 m at 1 m/s and 30 m at 5 m/s take 16 s, 8 s more than with a quick takeoff: up to 35 s with its lateness.
    spec.no_fly = vec![Zone {
        id: "later".to_owned(),
        circle: Some((spot(0.0, 0.0), 30.0)),
        floor: Some(Placement::Agl(Agl(30.0))),
        ceiling: Some(Placement::Agl(Agl(40.0))),
        active_s: Some((30.0, 1000.0)),
        ..Zone::default()
    }];
    let judged = review(&spec, &world(&spec), &[(0, &mission)]);
    let margin = find(&judged, &Limit::Zone("later".to_owned()));
    assert!(!margin.ok, "{margin:?}");
}

/// Of 1.17 one was 25.5 s late over its home and others 3 s.
#[test]
fn a_copter_of_px4_may_dwell_before_its_first_place() {
    let late_s = |autopilot| {
        let mut vehicle = slow("alpha", 1, spot(0.0, 0.0), spot(900.0, 0.0));
        vehicle.autopilot = autopilot;
        let mission = over(&vehicle, &[waypoint(spot(900.0, 0.0), UP_M)]);
        let spec = empty_spec(vec![vehicle]);
        let verified = verified(&spec, &world(&spec), &mission);
        (verified.takeoff_late_s.most, flown(&verified)[0].late_s)
    };
    let (alike_s, own_s) = late_s(Autopilot::Px4);
    assert!(alike_s + own_s >= 25.5, "{alike_s} {own_s}");
    assert!(own_s >= 12.0, "{own_s}");
    assert!(late_s(Autopilot::ArduPilot).1 < 1.0);
}

#[test]
fn a_copter_of_px4_is_late_in_a_corner_and_not_behind_it_alone() {
    let (corner, end) = (spot(500.0, 0.0), spot(500.0, 500.0));
    let mut vehicle = slow("alpha", 1, spot(0.0, 0.0), end);
    vehicle.autopilot = Autopilot::Px4;
    let mission = over(&vehicle, &[waypoint(corner, UP_M), waypoint(end, UP_M)]);
    let spec = empty_spec(vec![vehicle]);
    let verified = verified(&spec, &world(&spec), &mission);
    let segments = flown(&verified);
    let mut to_corner = segments.iter().filter(|segment| segment.to.item == 3);
    let first = to_corner.next().expect("a leg");
    let last = to_corner.next_back().expect("a corner");
    assert!(last.late_s - first.late_s > 1.0, "{}", last.late_s);
}

#[test]
fn a_copter_is_late_as_it_brakes_for_a_stop_already() {
    let (stop, end) = (spot(500.0, 0.0), spot(900.0, 0.0));
    let hold = at(command::NAV_WAYPOINT, frame::GLOBAL, stop, UP_M, 10.0);
    for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
        let mut vehicle = slow("alpha", 1, spot(0.0, 0.0), end);
        vehicle.autopilot = autopilot;
        let mission = over(&vehicle, &[hold, waypoint(end, UP_M)]);
        let spec = empty_spec(vec![vehicle]);
        let verified = verified(&spec, &world(&spec), &mission);
        let segments = flown(&verified);
        let rests = |of: &VerifiedSegment| of.from.place == of.to.place;
        let to_stop = segments.iter().filter(|of| of.to.item == 3);
        let (resting, moving): (Vec<&VerifiedSegment>, Vec<_>) = to_stop.partition(|of| rests(of));
        let rest_s = resting[0].late_s;
        let (first, last) = (moving[0], moving[moving.len() - 1]);
        assert!(
            (last.late_s - rest_s).abs() < 1e-9,
            "{} {rest_s}",
            last.late_s
        );
        // As long as it cruises it has nothing to be late by.
        assert!(first.late_s < rest_s - 4.0, "{} {rest_s}", first.late_s);
    }
}
