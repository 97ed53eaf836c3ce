//! `sortie review` of missions without a spec: what is assumed, and what cannot be guessed.

use std::fs;

use crate::support::command::{sortie, text};

/// A row of a `.waypoints` file: command, frame, the four parameters, place and altitude.
struct Row(u16, u8, [f32; 4], f64, f64, f64);

/// A takeoff, or a waypoint, above home.
fn waypoint(lat: f64, lon: f64, above_home_m: f64) -> Row {
    Row(16, 3, [0.0; 4], lat, lon, above_home_m)
}
fn takeoff() -> Row {
    Row(22, 3, [0.0; 4], 0.0, 0.0, 50.0)
}
fn land(lat: f64, lon: f64) -> Row {
    Row(21, 3, [0.0; 4], lat, lon, 0.0)
}
fn command(number: u16, params: [f32; 4]) -> Row {
    Row(number, 3, params, 0.0, 0.0, 0.0)
}

const HOME: (f64, f64) = (46.0, 8.0);

/// Exit code, standard output and standard error of a review of these rows.
fn review(home: (f64, f64), rows: &[Row], flags: &[&str]) -> (Option<i32>, String, String) {
    let mut file = format!(
        "QGC WPL 110\n0\t1\t0\t16\t0\t0\t0\t0\t{}\t{}\t500\t1\n",
        home.0, home.1
    );
    for (index, Row(command, frame, [a, b, c, d], lat, lon, alt)) in rows.iter().enumerate() {
        let seq = index + 1;
        file +=
            &format!("{seq}\t0\t{frame}\t{command}\t{a}\t{b}\t{c}\t{d}\t{lat}\t{lon}\t{alt}\t1\n");
    }
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("m.waypoints"), file).expect("written");
    let mut arguments = vec!["review", "m.waypoints"];
    arguments.extend(flags);
    let output = sortie(folder.path(), &arguments);
    (
        output.status.code(),
        text(&output.stdout),
        text(&output.stderr),
    )
}

const COPTER: [&str; 3] = ["--no-terrain", "--airframe", "copter"];

#[test]
fn the_airframe_that_no_file_states_is_said() {
    let rows = [takeoff(), waypoint(46.001, 8.0, 50.0), land(46.001, 8.0)];
    let (code, out, errors) = review(HOME, &rows, &["--no-terrain"]);
    assert_eq!(code, Some(0), "{out}{errors}");
    assert!(
        errors.contains("judged as a copter (--airframe)"),
        "{errors}"
    );
    let (code, _, errors) = review(HOME, &rows, &COPTER);
    assert_eq!(code, Some(0), "{errors}");
    assert!(!errors.contains("--airframe"), "{errors}");
}

#[test]
fn items_of_wings_are_never_guessed_to_be_for_a_copter() {
    let to_alt = Row(31, 3, [0.0; 4], 46.002, 8.0, 60.0);
    let takeoff_vtol = Row(84, 3, [0.0; 4], 46.0, 8.0, 50.0);
    let land_vtol = Row(85, 3, [0.0; 4], 46.001, 8.0, 0.0);
    let way = || waypoint(46.001, 8.0, 50.0);
    let cases = [
        (
            vec![takeoff_vtol, way(), land(46.0, 8.0)],
            "item 1 (NAV_VTOL_TAKEOFF)",
        ),
        (vec![takeoff(), way(), land_vtol], "item 3 (NAV_VTOL_LAND)"),
        (
            vec![takeoff(), way(), command(189, [0.0; 4]), land(46.001, 8.0)],
            "item 3 (DO_LAND_START)",
        ),
        (
            vec![
                takeoff(),
                command(3000, [4.0, 0.0, 0.0, 0.0]),
                way(),
                land(46.001, 8.0),
            ],
            "item 2 (DO_VTOL_TRANSITION)",
        ),
        (
            vec![takeoff(), way(), to_alt, land(46.001, 8.0)],
            "item 3 (the approach to a landing)",
        ),
    ];
    for (rows, item) in cases {
        let (code, out, errors) = review(HOME, &rows, &["--no-terrain"]);
        assert_eq!(code, Some(4), "{item}: {out}{errors}");
        assert!(errors.contains(item), "{item}: {errors}");
        assert!(
            errors.contains("cannot be judged") && errors.contains("say --airframe"),
            "{errors}"
        );
    }
}

#[test]
fn a_waypoint_that_is_not_above_home_fails_without_terrain() {
    for (above_home_m, passes) in [(-458.0, false), (-20.0, false), (-0.5, false), (1.0, true)] {
        let rows = [
            takeoff(),
            waypoint(46.001, 8.0, above_home_m),
            land(46.001, 8.0),
        ];
        let (code, out, errors) = review(HOME, &rows, &COPTER);
        assert_eq!(code == Some(0), passes, "{above_home_m}: {out}{errors}");
        let line = out
            .lines()
            .find(|line| line.contains("altitude above home"));
        let line = line.unwrap_or_else(|| panic!("{above_home_m}: {out}"));
        assert!(line.contains("FAIL") != passes, "{line}");
        assert!(passes || out.contains("--terrain"), "{out}");
    }
    // The same place above the sea.
    let low = Row(16, 0, [0.0; 4], 46.001, 8.0, 42.0);
    let (code, out, _) = review(HOME, &[takeoff(), low, land(46.001, 8.0)], &COPTER);
    assert_eq!(code, Some(4), "{out}");
    assert!(out.contains("-458.0 m"), "{out}");
}

#[test]
fn latitude_and_longitude_swapped_are_named_with_the_distance() {
    let home = (45.05, 43.30);
    let rows = [
        takeoff(),
        waypoint(43.301, 45.05, 50.0),
        land(43.301, 45.05),
    ];
    let (_, _, errors) = review(home, &rows, &COPTER);
    assert!(
        errors.contains("warning: m: items: 239 km from home"),
        "{errors}"
    );
    assert!(errors.contains("swapped it would be 0.1 km"), "{errors}");
    let rows = [
        takeoff(),
        waypoint(45.051, 43.30, 50.0),
        land(45.051, 43.30),
    ];
    let (_, _, errors) = review(home, &rows, &COPTER);
    assert!(!errors.contains("warning"), "{errors}");
}

/// `missions/first.yaml` lies elsewhere; a zone with swapped corners is no error, and is named.
#[test]
fn a_zone_of_a_spec_with_swapped_corners_is_named_by_check() {
    let folder = tempfile::tempdir().expect("a folder");
    let spec = "sortie: 1\nname: near-45\narea:\n  south_west: {lat: 45.00, lon: 43.20}\n  north_east: {lat: 45.10, lon: 43.40}\n  min_agl_m: 50\n  max_amsl_m: 2000\nterrain: {flat: {amsl_m: 300}}\nno_fly:\n  - {id: town, polygon: [[43.29, 45.04], [43.29, 45.05], [43.30, 45.05]]}\nvehicles:\n  - id: alpha\n    sysid: 1\n    autopilot: ardupilot\n    link: sim\n    start: {lat: 45.02, lon: 43.25, agl_m: 80}\n    goal: {lat: 45.08, lon: 43.35, agl_m: 80}\n    finish: land\n    speed_mps: 10\n";
    fs::write(folder.path().join("m.yaml"), spec).expect("written");
    let output = sortie(folder.path(), &["check", "m.yaml"]);
    let errors = text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{errors}");
    assert!(
        errors.contains("warning: zone town:") && errors.contains("swapped"),
        "{errors}"
    );
}
