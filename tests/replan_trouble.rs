//! Threats that not everybody can be led around.

#[path = "support/command.rs"]
#[allow(unreachable_pub)]
mod command;
#[path = "support/in_flight.rs"]
#[allow(unreachable_pub, dead_code)]
mod in_flight;

use std::path::Path;
use std::process::Output;

use command::{sortie, text};
use in_flight::{json, lanes, lines, planned, take_off, wait_for};
use serde_json::Value;

fn replan(folder: &Path, threat: &str) -> (Output, String, String) {
    let threat = format!("--threat={threat}");
    let output = sortie(folder, &["replan", "lanes.yaml", &threat]);
    let (told, errors) = (text(&output.stdout), text(&output.stderr));
    (output, told, errors)
}

/// Seconds after T0 in the line that says what fails.
fn worst_s(told: &str, what: &str) -> f64 {
    let mut lines = told.lines().filter(|line| line.contains(what));
    let line = lines.next().unwrap_or_else(|| panic!("{what} in {told}"));
    let (_, after) = line.split_once("T0+").expect("a time after T0");
    let seconds = after.split(' ').next().expect("a number");
    seconds.parse().expect("seconds")
}

#[test]
fn who_is_inside_of_a_threat_is_named_each_time_and_the_others_are_led_around_theirs() {
    let (folder, runs) = planned("lanes", &lanes("-84.238"));
    let mut flight = take_off(folder.path(), "lanes.yaml", "6");
    wait_for(&runs, "alpha", 35.0);
    // All around alpha.
    let (output, told, errors) = replan(folder.path(), "36.300,-84.250,1050");
    assert_eq!(output.status.code(), Some(4), "{told}{errors}");
    for line in [
        "alpha cannot avoid popup-1 (it is inside",
        "nothing was sent",
    ] {
        assert!(errors.contains(line), "{line} in {errors}");
    }
    assert!(told.contains("KEEPS ITS COURSE"), "{told}");
    let middle_s = worst_s(&told, "FAIL alpha: threat popup-1");
    // And one that bravo alone meets.
    let (output, told, errors) = replan(folder.path(), "36.3103,-84.2425,120");
    assert_eq!(output.status.code(), Some(4), "{told}{errors}");
    assert!(errors.contains("alpha cannot avoid popup-1"), "{errors}");
    assert!(!errors.contains("nothing was sent"), "{errors}");
    assert_eq!(told.matches("on its new path").count(), 1, "{told}");
    let done = json(&runs.join("replan.json"));
    assert_eq!(done["verdict"], "fail");
    assert_eq!(done["cannot_avoid"][0]["id"], "alpha");
    assert_eq!(done["cannot_avoid"][0]["threats"][0], "popup-1");
    assert_eq!(done["vehicles"][0]["id"], "bravo");
    let status = flight.0.wait().expect("it ends");
    assert_eq!(status.code(), Some(5));
    let flown = json(&runs.join("flight.json"));
    assert_eq!(flown["verdict"], "fail");
    let broken = flown["margins"].as_array().expect("margins").iter();
    let broken: Vec<(&str, &str)> = broken
        .filter(|margin| margin["ok"] == false)
        .map(|m| (m["vehicle"].as_str(), m["what"].as_str()))
        .map(|(vehicle, what)| (vehicle.expect("an id"), what.expect("a limit")))
        .collect();
    assert_eq!(broken, [("alpha", "threat popup-1")]);
    // When alpha is in the middle of it was told by the clock of the flight.
    let record = lines(&runs);
    let of = |line: &&Value| line["vehicle"] == "alpha" && line["lat_deg"].is_f64();
    let away = |line: &Value| (line["lon_deg"].as_f64().expect("degrees") + 84.25).abs();
    let positions = record.iter().filter(of);
    let nearest = positions.min_by(|a, b| away(a).total_cmp(&away(b)));
    let passed_s = nearest.expect("positions")["t_s"].as_f64().expect("s");
    assert!((passed_s - middle_s).abs() < 8.0, "{passed_s} {middle_s}");
}

#[test]
fn who_stands_on_the_ground_is_named_and_who_flies_is_led_around_the_same_threat() {
    let later = lanes("-84.238").replace("id: bravo, ", "id: bravo, depart_s: 150, ");
    let (folder, runs) = planned("lanes", &later);
    let _flight = take_off(folder.path(), "lanes.yaml", "4");
    wait_for(&runs, "alpha", 25.0);
    let (output, told, errors) = replan(folder.path(), "36.305,-84.246,570");
    assert_eq!(output.status.code(), Some(4), "{told}{errors}");
    let who = "bravo cannot avoid popup-1 (it stands on the ground)";
    assert!(errors.contains(who), "{errors}");
    assert_eq!(told.matches("on its new path").count(), 1, "{told}");
    assert_eq!(
        json(&runs.join("replan.json"))["vehicles"][0]["id"],
        "alpha"
    );
}

#[test]
fn who_stands_on_the_ground_and_meets_no_threat_keeps_nobody_from_a_new_path() {
    let later = lanes("-84.238").replace("id: bravo, ", "id: bravo, depart_s: 150, ");
    let (folder, runs) = planned("lanes", &later);
    let _flight = take_off(folder.path(), "lanes.yaml", "4");
    wait_for(&runs, "alpha", 25.0);
    let (output, told, errors) = replan(folder.path(), "36.3003,-84.246,120");
    assert_eq!(output.status.code(), Some(0), "{told}{errors}");
    assert_eq!(told.matches("on its new path").count(), 1, "{told}");
    assert_eq!(told.matches("not touched").count(), 1, "{told}");
    assert_eq!(json(&runs.join("replan.json"))["verdict"], "pass");
}

#[test]
fn who_has_no_way_around_a_threat_keeps_its_course_and_nobody_else_from_a_new_one() {
    // Alpha is fenced in to the south of a wall.
    let wall = "no_fly: [{id: wall, polygon: [[36.3045, -84.299], [36.3055, -84.299], [36.3055, -84.201], [36.3045, -84.201]]}]";
    let far = lanes("-84.215");
    let far = far.replace("vehicles:", &format!("{wall}\nvehicles:"));
    let (folder, runs) = planned("lanes", &far);
    let _flight = take_off(folder.path(), "lanes.yaml", "4");
    wait_for(&runs, "alpha", 25.0);
    let (output, told, errors) = replan(folder.path(), "36.2925,-84.235,1450");
    assert_eq!(output.status.code(), Some(4), "{told}{errors}");
    let who = "alpha cannot avoid popup-1 (no new path for it passes verification";
    assert!(errors.contains(who), "{errors}");
    assert!(errors.contains("nothing was sent"), "{errors}");
    let (output, told, errors) = replan(folder.path(), "36.3103,-84.235,120");
    assert_eq!(output.status.code(), Some(4), "{told}{errors}");
    assert!(errors.contains("alpha cannot avoid popup-1"), "{errors}");
    assert_eq!(told.matches("on its new path").count(), 1, "{told}");
}
