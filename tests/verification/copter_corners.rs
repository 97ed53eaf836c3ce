//! Corners and stops of copters, against what real autopilots flew.
//!
//! The numbers of [`FLOWN`] and the zigzag were flown on ArduCopter 4.6.3 (simulator, still air,
//! 2026-11-23): 10 m/s, 2.5 m/s2, default jerk, legs of 200 m and of 100 m.

#![expect(
    clippy::cast_possible_truncation,
    reason = "missions hold 1e-7 degrees and float32"
)]

use crate::support;
use crate::support::missions;
use missions::{GROUND_M, at, delay, land, mission, speed, takeoff, waypoint};
use sortie::geodesy::{LatLon, LocalFrame, PlanPoint};
use sortie::mission::{Item, Parameter, VehicleMission, command, frame};
use sortie::spec::{Autopilot, Finish, MissionSpec, Vehicle};
use sortie::verify::{Limit, Margin, Review, review, verified_trajectories};
use support::{copter, empty_spec, place, world};

const UP_M: f64 = GROUND_M + 80.0;
/// Change of course in degrees; seconds for a leg of 200 m with `WPNAV_RADIUS` 2 m and 5 m.
const FLOWN: [(f64, f64, f64); 10] = [
    (20.0, 20.0, 20.1),
    (30.0, 20.4, 20.0),
    (45.0, 21.1, 20.0),
    (60.0, 21.8, 20.2),
    (75.0, 22.3, 20.5),
    (90.0, 22.5, 21.0),
    (105.0, 22.8, 21.3),
    (120.0, 23.0, 21.6),
    (135.0, 23.2, 21.8),
    (150.0, 23.4, 22.0),
];

fn judge(spec: &MissionSpec, missions: &[&VehicleMission]) -> Review {
    let pairs: Vec<(usize, &VehicleMission)> = missions.iter().copied().enumerate().collect();
    review(spec, &world(spec), &pairs)
}

fn find(review: &Review, limit: Limit) -> &Margin {
    let mut margins = review.margins.iter();
    margins
        .find(|margin| margin.limit == limit)
        .unwrap_or_else(|| panic!("no margin {limit} among {:#?}", review.margins))
}

/// A place so many metres east and north of the first waypoint.
fn off(east_m: f64, north_m: f64) -> LatLon {
    let frame = LocalFrame::new(place(36.30, -84.25));
    let point = PlanPoint::new(east_m, north_m, sortie::geodesy::Amsl(0.0));
    frame.from_plan(point.at)
}

/// Places of a zigzag: legs of one length whose course changes by `turn_deg`, left and right.
fn zigzag(legs: u32, length_m: f64, turn_deg: f64) -> Vec<LatLon> {
    let (mut east_m, mut north_m) = (0.0, 0.0);
    let mut places = vec![off(0.0, 0.0)];
    for leg in 0..legs {
        let side = if leg % 2 == 0 { 0.5 } else { -0.5 };
        let course = (90.0 + side * turn_deg).to_radians();
        east_m += length_m * course.sin();
        north_m += length_m * course.cos();
        places.push(off(east_m, north_m));
    }
    places
}

fn slow(id: &str, sysid: u8, from: LatLon, to: LatLon) -> Vehicle {
    Vehicle {
        speed_mps: 10.0,
        ..copter(id, sysid, from, to)
    }
}

/// Up, along the places at 10 m/s, down at the last.
fn along(vehicle: &Vehicle, places: &[LatLon], radius_m: f64) -> VehicleMission {
    let mut items = vec![takeoff(places[0], UP_M), speed(10.0)];
    items.extend(places[1..].iter().map(|&place| waypoint(place, UP_M)));
    items.push(land(places[places.len() - 1]));
    let mut mission = mission(vehicle, GROUND_M, items);
    mission.params.push(Parameter {
        name: "WPNAV_RADIUS".to_owned(),
        value: (radius_m * 100.0) as f32,
        why: String::new(),
    });
    mission
}

/// Seconds for each leg between corners on both sides.
fn leg_s(length_m: f64, turn_deg: f64, radius_m: f64) -> f64 {
    let places = zigzag(12, length_m, turn_deg);
    let vehicle = slow("alpha", 1, places[0], places[12]);
    mean_leg_s(&vehicle, &along(&vehicle, &places, radius_m))
}

/// The same of the ten legs in the middle of a zigzag of twelve.
fn mean_leg_s(vehicle: &Vehicle, mission: &VehicleMission) -> f64 {
    let review = judge(&empty_spec(vec![vehicle.clone()]), &[mission]);
    let moments = &review.tracks[0].moments;
    // Takeoff 1, speed 2, the end of the first leg 3.
    let reached = |item| {
        let after = moments.iter().position(|moment| moment.item > item);
        moments[after.expect("goes on")].t_s
    };
    (reached(13) - reached(3)) / 10.0
}

#[test]
fn legs_between_corners_last_as_long_as_they_were_flown() {
    for (turn_deg, close_s, wide_s) in FLOWN {
        for (radius_m, flown_s) in [(2.0, close_s), (5.0, wide_s)] {
            let judged_s = leg_s(200.0, turn_deg, radius_m);
            assert!(
                (judged_s - flown_s).abs() < 0.3,
                "{turn_deg} degrees, radius {radius_m} m: {judged_s:.2} s, flown {flown_s} s"
            );
        }
    }
}

/// From rest to 10 m/s with 2.5 m/s^2 and a jerk `j` lasts `p = 4 + 2.5 / j`, or `2 sqrt(10 / j)` where the
/// acceleration is never reached; at right angles the legs overlap for `2 t`, `t` the time to
/// `2 m / (2 sin 45)`, and a corner costs `p - 2 t` and the 0.1 s of the table.
#[test]
fn a_corner_costs_what_the_jerk_of_the_parameters_asks_for() {
    for (name, jerk, lost_s) in [
        ("WPNAV_JERK", 1.0, 2.52),
        ("WPNAV_JERK", 0.2, 7.26),
        ("WPNAV_JERK", 5.0, 1.99),
        ("WPNAV_JERK", 20.0, 1.97),
        ("WP_JERK", 5.0, 1.99),
    ] {
        let places = zigzag(12, 200.0, 90.0);
        let vehicle = slow("alpha", 1, places[0], places[12]);
        let mut mission = along(&vehicle, &places, 2.0);
        mission.params.push(Parameter {
            name: name.to_owned(),
            value: jerk,
            why: String::new(),
        });
        let found_s = mean_leg_s(&vehicle, &mission);
        assert!(
            (found_s - 20.0 - lost_s).abs() < 0.03,
            "{name} {jerk}: {found_s}"
        );
    }
}

#[test]
fn a_zigzag_of_right_angles_takes_12_6_s_a_leg_of_100_m() {
    let judged_s = leg_s(100.0, 90.0, 2.0);
    assert!((judged_s - 12.6).abs() < 0.2, "{judged_s:.2} s");
}

#[test]
fn a_vehicle_that_crosses_the_end_of_a_zigzag_when_it_is_really_there_fails() {
    let places = zigzag(12, 100.0, 90.0);
    let alpha = slow("alpha", 1, places[0], places[12]);
    let first = along(&alpha, &places, 2.0);
    // 80 m up at 5 m/s, eleven legs and a half of 12.6 s, the first of them from rest.
    let there_s = 16.0 + 0.7 + 11.5 * 12.6;
    // Halfway along the last leg, which goes north-east; the other comes from the north-west.
    let (east_m, north_m) = (11.5 * 50.0 * 2.0_f64.sqrt(), -25.0 * 2.0_f64.sqrt());
    let far_m = 400.0 / 2.0_f64.sqrt();
    let (from, to) = (
        off(east_m - far_m, north_m + far_m),
        off(east_m + far_m, north_m - far_m),
    );
    let mut beta = slow("beta", 2, from, to);
    beta.depart_s = (there_s - 16.0_f64 - 2.0 - 40.0).round();
    let mut second = along(&beta, &[from, to], 2.0);
    second.items.insert(0, delay(beta.depart_s as f32));
    let mut spec = empty_spec(vec![alpha, beta]);
    spec.separation.distance_m = 30.0;
    spec.separation.time_slack_s = 0.0;
    let review = judge(&spec, &[&first, &second]);
    let margin = find(&review, Limit::Separation);
    assert!(!margin.ok && margin.value < 20.0, "{margin:?}");
}

#[test]
fn a_vehicle_that_crosses_the_way_to_a_landing_beside_the_last_waypoint_fails() {
    let (start, last, pad) = (off(0.0, 0.0), off(1000.0, 0.0), off(1300.0, 0.0));
    let alpha = copter("alpha", 1, start, pad);
    let items = vec![
        takeoff(start, UP_M),
        speed(15.0),
        waypoint(last, UP_M),
        land(pad),
    ];
    let first = mission(&alpha, GROUND_M, items);
    // 16 s up, 72.7 s with two ramps of 3 s, 150 m from rest: 3 s more than at full speed.
    let there_s = 16.0 + 1000.0 / 15.0 + 6.0 + 10.0 + 3.0;
    let (from, to) = (off(1150.0, 600.0), off(1150.0, -600.0));
    let mut beta = copter("beta", 2, from, to);
    beta.depart_s = (there_s - 16.0_f64 - 40.0 - 3.0).round();
    let items = vec![
        delay(beta.depart_s as f32),
        takeoff(from, UP_M),
        speed(15.0),
        waypoint(to, UP_M),
        land(to),
    ];
    let second = mission(&beta, GROUND_M, items);
    let mut spec = empty_spec(vec![alpha, beta]);
    spec.separation.distance_m = 20.0;
    spec.separation.time_slack_s = 0.0;
    let review = judge(&spec, &[&first, &second]);
    let margin = find(&review, Limit::Separation);
    assert!(!margin.ok && margin.value < 10.0, "{margin:?}");
}

#[test]
fn a_landing_some_metres_beside_the_last_waypoint_is_no_corner() {
    let (start, last) = (off(0.0, 0.0), off(1000.0, 0.0));
    for beside_m in [1.0, 3.0, 4.9] {
        let pad = off(1000.0, beside_m);
        let vehicle = copter("alpha", 1, start, last);
        let items = vec![
            takeoff(start, UP_M),
            speed(15.0),
            waypoint(last, UP_M),
            land(pad),
        ];
        let mission = mission(&vehicle, GROUND_M, items);
        let review = judge(&empty_spec(vec![vehicle]), &[&mission]);
        assert!(review.passes(), "{:#?}", review.margins);
    }
}

/// Seconds until the landing of a flight straight on over a waypoint in the middle.
fn straight_s(autopilot: Autopilot, middle: Item, end: Item) -> f64 {
    let (start, goal) = (off(0.0, 0.0), off(2000.0, 0.0));
    let mut vehicle = copter("alpha", 1, start, goal);
    vehicle.autopilot = autopilot;
    let items = vec![takeoff(start, UP_M), speed(15.0), middle, end, land(goal)];
    let mission = mission(&vehicle, GROUND_M, items);
    let review = judge(&empty_spec(vec![vehicle]), &[&mission]);
    let moments = &review.tracks[0].moments;
    moments[moments.len() - 1].t_s
}

#[test]
fn arducopter_stops_where_the_kind_of_altitude_changes_and_at_a_timed_loiter() {
    let (half, goal) = (off(1000.0, 0.0), off(2000.0, 0.0));
    let over_ground = |place| {
        at(
            command::NAV_WAYPOINT,
            frame::GLOBAL_TERRAIN_ALT,
            place,
            80.0,
            0.0,
        )
    };
    let loiter = at(command::NAV_LOITER_TIME, frame::GLOBAL, half, UP_M, 0.0);
    let passes_s = straight_s(
        Autopilot::ArduPilot,
        waypoint(half, UP_M),
        waypoint(goal, UP_M),
    );
    // A stop from 15 m/s and the start after it, with 2.5 m/s2.
    for (middle, end) in [
        (waypoint(half, UP_M), over_ground(goal)),
        (over_ground(half), waypoint(goal, UP_M)),
        (loiter, waypoint(goal, UP_M)),
    ] {
        let stops_s = straight_s(Autopilot::ArduPilot, middle, end);
        assert!(
            (stops_s - passes_s - 6.0).abs() < 0.1,
            "{stops_s} {passes_s}"
        );
    }
    let px4_s = straight_s(Autopilot::Px4, waypoint(half, UP_M), waypoint(goal, UP_M));
    let timed_s = straight_s(Autopilot::Px4, loiter, waypoint(goal, UP_M));
    assert!((px4_s - timed_s).abs() < 0.1, "{px4_s} {timed_s}");
}

#[test]
fn items_after_an_unlimited_loiter_are_never_flown() {
    let (start, half, goal) = (off(0.0, 0.0), off(1000.0, 0.0), off(2000.0, 0.0));
    let vehicle = copter("alpha", 1, start, goal);
    let items = vec![
        takeoff(start, UP_M),
        speed(15.0),
        at(command::NAV_LOITER_UNLIM, frame::GLOBAL, half, UP_M, 0.0),
        waypoint(goal, UP_M),
        land(goal),
    ];
    let mission = mission(&vehicle, GROUND_M, items);
    let mut spec = empty_spec(vec![vehicle]);
    let hovering = judge(&spec, &[&mission]);
    let judged = find(&hovering, Limit::ItemsJudged);
    assert!(
        !judged.ok && (judged.value - 3.0).abs() < 1e-9,
        "{judged:?}"
    );
    assert!(
        judged.note.contains("item 4") && judged.note.contains("NAV_LOITER_UNLIM"),
        "{judged:?}"
    );
    let finish = find(&hovering, Limit::Finish);
    assert!(!finish.ok, "{finish:?}");
    spec.vehicles[0].finish = Finish::Loiter;
    spec.vehicles[0].goal.place = half;
    let loiters = judge(&spec, &[&mission]);
    assert!(loiters.passes(), "{:#?}", loiters.margins);
    assert!(find(&loiters, Limit::ItemsJudged).note.contains("item 4"));
}

/// What a copter of an autopilot may be late and early by at the end of 12 km on a course, as shares of the time since its
/// tenth minute.
fn late_and_early(autopilot: Autopilot, course_deg: f64) -> (f64, f64) {
    let (sin, cos) = course_deg.to_radians().sin_cos();
    let places = [
        off(-6000.0 * sin, -6000.0 * cos),
        off(6000.0 * sin, 6000.0 * cos),
    ];
    let vehicle = Vehicle {
        autopilot,
        ..slow("alpha", 1, places[0], places[1])
    };
    let mut mission = along(&vehicle, &places, 2.0);
    mission.params.push(missions::quick_takeoff());
    let spec = empty_spec(vec![vehicle]);
    let all = verified_trajectories(&spec, &world(&spec), &[(0, &mission)]);
    let on_its_way = all[0]
        .segments
        .iter()
        .filter(|of| of.is_flown && of.to.item == 3);
    let longest =
        on_its_way.max_by(|a, b| (a.to.t_s - a.from.t_s).total_cmp(&(b.to.t_s - b.from.t_s)));
    let longest = longest.expect("a leg");
    let counted_s = longest.to.t_s - 600.0;
    assert!((600.0..660.0).contains(&counted_s), "{counted_s}");
    // The climb and each leg of PX4 make it late by themselves.
    let own_s = f64::from(u8::from(autopilot == Autopilot::Px4)) * (12.0 + 1.5);
    (
        (longest.late_s - own_s) / counted_s,
        longest.early_s / counted_s,
    )
}

/// Three ArduCopters 4.7.0-beta1 flew 22 to 25 km at 36.3 degrees: 0.320 % late to the north, 0.129 % early to the east.
#[test]
fn a_copter_that_counts_metres_on_a_sphere_is_late_to_the_north_and_early_to_the_east() {
    let near = |(late, early): (f64, f64), flown_late: f64, flown_early: f64| {
        let is_near = |judged: f64, flown: f64| (judged - flown).abs() < 2e-4;
        assert!(
            is_near(late, flown_late) && is_near(early, flown_early),
            "{late} {early}"
        );
    };
    near(late_and_early(Autopilot::ArduPilot, 0.0), 0.0032, 0.0);
    near(late_and_early(Autopilot::ArduPilot, 180.0), 0.0032, 0.0);
    near(late_and_early(Autopilot::ArduPilot, 90.0), 0.0, 0.0012);
    // Its sphere is smaller by 0.11 %.
    near(late_and_early(Autopilot::Px4, 0.0), 0.0021, 0.0);
    near(late_and_early(Autopilot::Px4, 90.0), 0.0, 0.0023);
}

/// PX4 1.17.0 (simulator, still air, 2026-11-26): speed, m/s; length of a leg, metres; acceptance radius, metres; change of course,
/// degrees; seconds for a leg of a zigzag.
const FLOWN_BY_PX4: [(f64, f64, f64, f64, f64); 10] = [
    (5.0, 100.0, 10.0, 30.0, 21.5),
    (5.0, 100.0, 10.0, 90.0, 24.8),
    (5.0, 100.0, 10.0, 150.0, 26.5),
    (5.0, 100.0, 3.0, 90.0, 23.9),
    (6.5, 60.0, 10.0, 45.0, 11.9),
    (6.5, 60.0, 10.0, 120.0, 15.5),
    (8.0, 100.0, 10.0, 60.0, 17.1),
    (8.0, 100.0, 10.0, 90.0, 18.2),
    (10.0, 140.0, 10.0, 20.0, 16.8),
    (10.0, 140.0, 4.0, 90.0, 20.0),
];

/// Seconds for each leg of a zigzag of a PX4 copter between corners on both sides, and by how much it may be later.
fn px4_leg_s((speed_mps, length_m, radius_m, turn_deg): (f64, f64, f64, f64)) -> (f64, f64) {
    let places = zigzag(12, length_m, turn_deg);
    let vehicle = Vehicle {
        autopilot: Autopilot::Px4,
        speed_mps,
        accel_mps2: 3.0,
        ..copter("alpha", 1, places[0], places[12])
    };
    let mut items = vec![takeoff(places[0], UP_M), speed(speed_mps as f32)];
    items.extend(places[1..].iter().map(|&place| {
        let mut item = waypoint(place, UP_M);
        item.params[1] = radius_m as f32;
        item
    }));
    items.push(land(places[12]));
    let mission = mission(&vehicle, GROUND_M, items);
    let spec = empty_spec(vec![vehicle]);
    let all = verified_trajectories(&spec, &world(&spec), &[(0, &mission)]);
    let mut flown = all[0].segments.iter().filter(|of| of.is_flown);
    let mut reached = |item| {
        let last = flown.rfind(|of| of.to.item == item).expect("a leg");
        (last.to.t_s, last.late_s)
    };
    let (last, first) = (reached(13), reached(3));
    ((last.0 - first.0) / 10.0, (last.1 - first.1) / 10.0)
}

#[test]
fn px4_copters_are_as_late_after_corners_as_they_were_flown() {
    for (speed_mps, length_m, radius_m, turn_deg, flown_s) in FLOWN_BY_PX4 {
        let (judged_s, late_s) = px4_leg_s((speed_mps, length_m, radius_m, turn_deg));
        assert!(
            judged_s < flown_s && flown_s < judged_s + late_s + 0.1,
            "{turn_deg} degrees at {speed_mps} m/s: {judged_s:.2} s and {late_s:.2} s, flown {flown_s} s"
        );
        assert!(
            judged_s + late_s < flown_s + 2.5,
            "{turn_deg} {speed_mps}: {late_s}"
        );
    }
}
