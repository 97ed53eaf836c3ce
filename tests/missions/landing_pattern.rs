//! Landing patterns of QGroundControl's plans, which hold no items of their own.

use std::fs;

use crate::support::command::{sortie, text};

/// A plan of a plane or vtol that takes off, flies to a place and has a landing pattern.
fn plan(pattern: &str, (vehicle, takeoff): (u8, u16)) -> String {
    let simple = |command: u16, lat: f64, alt: u8| {
        format!(
            r#"{{"type":"SimpleItem","autoContinue":true,"command":{command},"doJumpId":1,"frame":3,"params":[0,0,0,null,{lat},8.55,{alt}]}}"#
        )
    };
    format!(
        r#"{{"fileType":"Plan","version":1,"groundStation":"QGroundControl","mission":{{"version":2,"firmwareType":12,"vehicleType":{vehicle},"plannedHomePosition":[47.40,8.55,400],"items":[{},{},{pattern}]}},"geoFence":{{"version":2,"circles":[],"polygons":[]}},"rallyPoints":{{"version":2,"points":[]}}}}"#,
        simple(takeoff, 47.401, 50),
        simple(16, 47.41, 60),
    )
}

/// The pattern with its kind and version, and more keys.
fn pattern(kind: &str, version: u8, more: &str) -> String {
    format!(
        r#"{{"type":"ComplexItem","complexItemType":"{kind}","version":{version},"altitudesAreRelative":true,"landCoordinate":[47.42,8.56,0],"landingApproachCoordinate":[47.42,8.55,40],"loiterRadius":75,"valueSetIsDistance":false{more}}}"#
    )
}

/// Command, frame, parameters and place of each row after home.
fn rows(plan: &str) -> Vec<String> {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("m.plan"), plan).expect("written");
    let output = sortie(folder.path(), &["convert", "m.plan", "m.waypoints"]);
    let said = text(&output.stdout) + &text(&output.stderr);
    assert!(output.status.success(), "{said}");
    assert!(said.contains("landing pattern"), "{said}");
    let written = fs::read_to_string(folder.path().join("m.waypoints")).expect("written");
    let row = |line: &str| {
        let fields: Vec<&str> = line.split('\t').collect();
        fields[2..11].join(" ")
    };
    written.lines().skip(2).map(row).collect()
}

#[test]
fn a_landing_pattern_is_read_as_the_items_that_the_ground_station_sends() {
    let circle = r#","useLoiterToAlt":true,"loiterClockwise":false,"stopTakingPhotos":true,"stopVideoPhotos":true"#;
    let found = rows(&plan(&pattern("fwLandingPattern", 2, circle), (1, 22)));
    let expected = [
        "2 189 0 0 0 0 0 0 0",
        "2 206 0 0 0 0 0 0 0",
        "2 2001 0 0 0 0 0 0 0",
        "2 2501 0 0 0 0 0 0 0",
        "3 31 1 -75 0 1 47.4200000 8.5500000 40",
        "3 21 0 0 0 0 47.4200000 8.5600000 0",
    ];
    assert_eq!(found[2..], expected);
    let straight = r#","useLoiterToAlt":false,"loiterClockwise":true"#;
    let found = rows(&plan(&pattern("vtolLandingPattern", 1, straight), (20, 84)));
    let expected = [
        "2 189 0 0 0 0 0 0 0",
        "3 16 0 0 0 0 47.4200000 8.5500000 40",
        "3 85 0 0 0 0 47.4200000 8.5600000 0",
    ];
    assert_eq!(found[2..], expected);
}

#[test]
fn a_landing_pattern_that_the_ground_station_would_not_read_is_refused() {
    for (wrong, at) in [
        (pattern("fwLandingPattern", 9, ""), "version: 9"),
        (pattern("fwLandingPattern", 2, ""), "useLoiterToAlt: null"),
        (
            pattern("fwLandingPattern", 2, r#","useLoiterToAlt":false"#)
                .replace("[47.42,8.56,0]", "[47.42,8.56]"),
            "landCoordinate: [47.42,8.56]",
        ),
        (
            pattern(
                "fwLandingPattern",
                2,
                r#","useLoiterToAlt":false,"useDoChangeSpeed":true"#,
            ),
            "finalApproachSpeed: null",
        ),
    ] {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("m.plan"), plan(&wrong, (1, 22))).expect("written");
        let output = sortie(folder.path(), &["convert", "m.plan", "m.waypoints"]);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(3), "{said}");
        let place = format!("mission.items[2].{at}");
        assert!(said.contains(&place), "{place}: {said}");
    }
}

/// `LandingComplexItem::appendMissionItems` of `QGroundControl` 5 hands the speed over as a whole number.
#[test]
fn the_approach_speed_of_a_landing_pattern_is_commanded_before_its_approach() {
    let speed = r#","useLoiterToAlt":false,"loiterClockwise":true,"stopVideoPhotos":true,"useDoChangeSpeed":true,"finalApproachSpeed":14.7"#;
    for (kind, version, vehicle, landing) in [
        ("fwLandingPattern", 2, (1, 22), 21),
        ("vtolLandingPattern", 1, (20, 84), 85),
    ] {
        let found = rows(&plan(&pattern(kind, version, speed), vehicle));
        let expected = [
            "2 189 0 0 0 0 0 0 0".to_owned(),
            "2 178 0 14 -1 0 0 0 0".to_owned(),
            "2 2501 0 0 0 0 0 0 0".to_owned(),
            "3 16 0 0 0 0 47.4200000 8.5500000 40".to_owned(),
            format!("3 {landing} 0 0 0 0 47.4200000 8.5600000 0"),
        ];
        assert_eq!(found[2..], expected);
        let not = speed.replace("Speed\":true", "Speed\":false");
        assert_eq!(rows(&plan(&pattern(kind, version, &not), vehicle)).len(), 6);
    }
}

#[test]
fn a_complex_item_that_holds_no_flown_items_is_refused() {
    for (items, found) in [("null", "\"survey\""), ("[]", "[]")] {
        let survey = format!(
            r#"{{"type":"ComplexItem","complexItemType":"survey","version":5,"TransectStyleComplexItem":{{"version":2,"Items":{items}}}}}"#
        );
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("m.plan"), plan(&survey, (1, 22))).expect("written");
        let output = sortie(folder.path(), &["convert", "m.plan", "m.waypoints"]);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(3), "{items}: {said}");
        assert!(
            said.contains("mission.items[2].") && said.contains(found),
            "{items}: {said}"
        );
    }
}
