//! Missions that ArduPilot 4.7.0-beta1 or PX4 1.17 flew otherwise than they had been judged: places that come twice, climbs that
//! parameters limit, circles after a descent.

use std::fs;

use serde_json::Value;

use crate::flown_otherwise::{fails, up};
use crate::support::command::{sortie, text};
use crate::without_spec::{COPTER, HOME, Row, file_of, land, review, waypoint};

fn spline(lat: f64, lon: f64, above_m: f64) -> Row {
    Row(82, 3, [0.0; 4], lat, lon, above_m)
}
/// A plane that takes off eastward, flies over places, and returns.
fn plane(places: &[(f64, f64, f64)]) -> Vec<Row> {
    let mut rows = vec![Row(22, 3, [10.0, 0.0, 0.0, 0.0], 46.0, 8.003, 80.0)];
    rows.push(waypoint(46.0, 8.02, 80.0));
    rows.extend(places.iter().map(|of| waypoint(of.0, of.1, of.2)));
    rows.push(Row(20, 3, [0.0; 4], 0.0, 0.0, 0.0));
    rows
}

/// What a review of a plane prints, with parameters next to its mission.
fn plane_with(params: &str, mission: &str, flags: &[&str]) -> (String, String) {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("m.waypoints"), mission).expect("written");
    fs::write(folder.path().join("m.params"), params).expect("written");
    let of_plane = [
        "review",
        "m.waypoints",
        "--no-terrain",
        "--airframe",
        "plane",
    ];
    let output = sortie(folder.path(), &[&of_plane, flags].concat());
    (text(&output.stdout), text(&output.stderr))
}

/// What a review writes with `--trajectories`, of the only vehicle; next to the mission stand parameters.
fn trajectory(rows: &[Row], params: &str) -> Value {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("m.waypoints"), file_of(HOME, rows)).expect("written");
    fs::write(folder.path().join("m.params"), params).expect("written");
    let flags = ["review", "m.waypoints", "--trajectories", "t.json"];
    let output = sortie(folder.path(), &[&flags[..], &COPTER].concat());
    let written = fs::read(folder.path().join("t.json"));
    let written = written.unwrap_or_else(|_| panic!("{}", text(&output.stderr)));
    let mut document: Value = serde_json::from_slice(&written).expect("JSON");
    document["vehicles"][0].take()
}

/// ArduCopter began its spline in the direction of the leg before, 160 m down, and came to the ground 13 m on; behind
/// a waypoint that came twice it passed 2 m from the middle of a threat of 45 m.
#[test]
fn a_spline_after_two_waypoints_at_one_place_is_not_judged() {
    for first_m in [180.0, 20.0] {
        let place = (46.0, 8.003);
        let rows = [
            up(),
            waypoint(place.0, place.1, first_m),
            waypoint(place.0, place.1, 20.0),
            spline(46.0, 8.006, 20.0),
            land(46.0, 8.006),
        ];
        fails(&rows, &COPTER, "a spline after two waypoints at one place");
    }
}

/// Copters of both autopilots: 17 s for each 100 m where 11 s were judged.
#[test]
fn a_copter_stops_at_a_waypoint_that_is_there_twice() {
    let end_s = |times: usize| {
        let mut rows = vec![up()];
        for leg in 1..=8 {
            let way = || waypoint(46.0 + 0.0009 * f64::from(leg), 8.0, 50.0);
            rows.extend((0..times).map(|_| way()));
        }
        rows.push(land(46.0072, 8.0));
        let flown = trajectory(&rows, "");
        let segments = flown["segments"].as_array().expect("segments").clone();
        let ends = segments.iter().filter_map(|of| of["to"]["t_s"].as_f64());
        ends.fold(0.0, f64::max)
    };
    // Seven stops from 10 m/s at 2.5 m/s^2: 4 s each.
    assert!(end_s(2) > end_s(1) + 7.0 * 3.9);
}

/// ArduPlane was 10 m inside a cliff: it climbs on its way. PX4 circled 79 m beside its leg. Where the place
/// is a corner ArduPlane turned 30 m further out.
#[test]
fn a_wing_with_two_waypoints_at_one_place_is_not_judged() {
    let place = (46.0, 8.04);
    for autopilot in ["ardupilot", "px4"] {
        for second_m in [80.0, 160.0] {
            let rows = plane(&[
                (place.0, place.1, 80.0),
                (place.0, place.1, second_m),
                (46.0, 8.07, second_m),
            ]);
            let flags = [
                "--no-terrain",
                "--airframe",
                "plane",
                "--autopilot",
                autopilot,
            ];
            fails(&rows, &flags, "a wing can neither stop nor climb there");
        }
    }
}

/// PX4 climbs on missions by `FW_T_CLMB_R_SP`, 3 m/s where no parameter says otherwise, not by `FW_T_CLMB_MAX`: 23 m
/// inside a slope that it was to climb at 4 m/s.
#[test]
fn a_plane_of_px4_climbs_no_faster_than_its_target_rate() {
    let rows = plane(&[(46.0, 8.046, 620.0), (46.0, 8.06, 620.0)]);
    let flags = ["--no-terrain", "--airframe", "plane"];
    let (_, out, _) = review(HOME, &rows, &[&flags[..], &["--autopilot", "px4"]].concat());
    assert!(out.contains("FAIL m: climb speed"), "{out}");
    let (_, _, errors) = review(HOME, &rows, &[&flags[..], &["--autopilot", "px4"]].concat());
    assert!(errors.contains("FW_T_CLMB_R_SP 3"), "{errors}");
    let (_, out, _) = review(HOME, &rows, &flags);
    assert!(!out.contains("FAIL m: climb speed"), "{out}");
}

/// The greatest climb holds where it is less than the target rate.
#[test]
fn a_plane_of_px4_climbs_no_faster_than_its_greatest_rate_either() {
    let rows = plane(&[(46.0, 8.046, 620.0), (46.0, 8.06, 620.0)]);
    let held = "1\t1\tFW_T_CLMB_R_SP\t6.0\t9\n1\t1\tFW_T_CLMB_MAX\t2.5\t9\n";
    let (out, errors) = plane_with(held, &file_of(HOME, &rows), &["--autopilot", "px4"]);
    assert!(out.contains("FAIL m: climb speed"), "{out}");
    assert!(errors.contains("FW_T_CLMB_MAX 2.5"), "{errors}");
}

/// Since 4.7 the edge of a circle is found from the distance seen from above: 62 m inside a hill that the way to a place
/// further in passes.
#[test]
fn a_circle_after_a_descent_is_come_to_at_its_rim_as_well() {
    let middle = (46.0, 8.003);
    let rows = [
        up(),
        waypoint(46.0, 8.0013, 220.0),
        Row(18, 3, [1.0, 0.0, 100.0, 0.0], middle.0, middle.1, 20.0),
        land(46.0, 8.006),
    ];
    let flown = trajectory(&rows, "");
    let segments = flown["segments"].as_array().expect("segments");
    let off_m = |end: &Value| {
        let north_m = 111_150.0 * (end["lat_deg"].as_f64().expect("a number") - middle.0);
        let east_m = 77_460.0 * (end["lon_deg"].as_f64().expect("a number") - middle.1);
        (north_m.hypot(east_m) - 100.0).abs()
    };
    let mut straight = segments.iter().filter(|of| {
        let height_m = |end: &str| of[end]["amsl_m"].as_f64().expect("metres");
        height_m("from") > 719.0 && height_m("to") < 521.0
    });
    assert!(straight.any(|of| off_m(&of["to"]) < 1.0), "{segments:?}");
}

/// With `TECS_PITCH_MAX` 8 ArduPlane flew 100 m below its line.
#[test]
fn a_plane_whose_parameters_keep_it_from_its_climb_is_not_judged() {
    let rows = "1\t0\t3\t22\t10\t0\t0\t0\t46.0\t8.003\t80\t1\n2\t0\t3\t16\t0\t0\t0\t0\t46.0\t8.02\t80\t1\n3\t0\t3\t20\t0\t0\t0\t0\t0\t0\t0\t1\n";
    let file = format!("QGC WPL 110\n0\t1\t0\t16\t0\t0\t0\t0\t46.0\t8.0\t500\t1\n{rows}");
    for (held, why) in [
        (
            "TECS_PITCH_MAX,8",
            "TECS_PITCH_MAX 8 (judged: 0, or at least 15)",
        ),
        ("THR_MAX,20", "THR_MAX 20 (judged: at least 50)"),
        (
            "PTCH_LIM_MAX_DEG,1",
            "PTCH_LIM_MAX_DEG 1 (judged: at least 15)",
        ),
        ("Q_ENABLE,1", "Q_ENABLE 1 (judged: 0)"),
        ("TECS_PITCH_MAX,20\nTHR_MAX,75", ""),
    ] {
        let (said, _) = plane_with(&format!("{held}\n"), &file, &[]);
        match why {
            "" => assert!(!said.contains("judged:"), "{said}"),
            why => assert!(said.contains(why), "{why}: {said}"),
        }
    }
}

/// ArduCopter waited 108 s longer with `PLDP_DELAY` 120.
#[test]
fn a_copter_waits_for_its_delay_where_it_places_a_load() {
    let rows = [
        up(),
        waypoint(46.0018, 8.0, 30.0),
        Row(94, 3, [0.0; 4], 46.0018, 8.0, 30.0),
        waypoint(46.005, 8.0, 30.0),
        land(46.005, 8.0),
    ];
    let latest_s = |params: &str| {
        let flown = trajectory(&rows, params);
        let segments = flown["segments"].as_array().expect("segments").clone();
        let ends = segments.iter().map(|of| {
            of["to"]["t_s"].as_f64().unwrap_or(0.0) + of["late_s"].as_f64().unwrap_or(0.0)
        });
        ends.fold(0.0, f64::max)
    };
    assert!((latest_s("PLDP_DELAY,120\n") - latest_s("") - 120.0).abs() < 1e-6);
}
