//! Threats that not everybody can be led around.
#![allow(clippy::cast_possible_truncation)]

use crate::support::{command, in_flight};
use std::path::{Path, PathBuf};
use std::process::Output;
use std::time::Duration;

use command::{sortie, text};
use in_flight::{Flight, begin, json, lanes, lines, planned, take_off, wait_for};
use serde_json::Value;
use sortie::link::{Address, Command, Decoder, Encoder, FlightMessage, Links, Message};
use sortie::spec::Link;

pub(super) fn replan(folder: &Path, threat: &str) -> (Output, String, String) {
    let threat = format!("--threat={threat}");
    let output = sortie(folder, &["replan", "lanes.yaml", &threat]);
    let (told, errors) = (text(&output.stdout), text(&output.stderr));
    (output, told, errors)
}

/// A fleet in flight at a speedup, where a vehicle is that late; and where its records go.
fn aloft(
    spec: &str,
    speedup: &str,
    (vehicle, t_s): (&str, f64),
) -> (tempfile::TempDir, PathBuf, Flight) {
    let (folder, runs) = planned("lanes", spec);
    let flight = take_off(folder.path(), "lanes.yaml", speedup);
    wait_for(&runs, vehicle, t_s);
    (folder, runs, flight)
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
    let (folder, runs, mut flight) = aloft(&lanes("-84.238"), "3", ("alpha", 35.0));
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
    let record = lines(&runs);
    // When alpha is in the middle of it was told by the clock of the flight.
    let of = |line: &&Value| line["vehicle"] == "alpha" && line["lat_deg"].is_f64();
    let away = |line: &Value| (line["lon_deg"].as_f64().expect("degrees") + 84.25).abs();
    let positions = record.iter().filter(of);
    let nearest = positions.min_by(|a, b| away(a).total_cmp(&away(b)));
    let passed_s = nearest.expect("positions")["t_s"].as_f64().expect("s");
    assert!((passed_s - middle_s).abs() < 8.0, "{passed_s} {middle_s}");
}

#[test]
fn what_is_broken_from_now_on_is_told_with_the_time_height_and_item_of_now() {
    let (folder, runs, _flight) = aloft(&lanes("-84.238"), "4", ("alpha", 40.0));
    // Its middle is behind alpha: nowhere ahead is nearer to it than here.
    let (output, told, errors) = replan(folder.path(), "36.300,-84.2645,900");
    assert_eq!(output.status.code(), Some(4), "{told}{errors}");
    let what = "FAIL alpha: threat popup-1";
    assert!(worst_s(&told, what) >= 40.0, "{told}");
    let mut lines_told = told.lines();
    let line = lines_told.find(|line| line.contains(what)).expect("a line");
    let height_m = |m: u16| line.contains(&format!(", {m} m AMSL,"));
    assert!((429..=433).any(height_m), "{line}");
    let record = lines(&runs);
    let is_told = |item: u64| line.contains(&format!("at item {item},"));
    let of = |line: &&Value| line["vehicle"] == "alpha" && line["lat_deg"].is_f64();
    let items = record.iter().filter(of).map(|line| &line["item"]);
    let mut items = items.filter_map(Value::as_u64).filter(|item| *item > 1);
    assert!(items.any(is_told), "{line}");
}

#[test]
fn what_cannot_be_meant_is_refused_before_anything_is_recorded_or_sent() {
    let (folder, runs) = planned("lanes", &lanes("-84.238"));
    std::fs::create_dir_all(&runs).expect("a folder");
    let refused = |threat: &str, code: i32, words: &str| {
        let (output, told, errors) = replan(folder.path(), threat);
        assert_eq!(output.status.code(), Some(code), "{told}{errors}");
        assert!(errors.contains(words), "{words} in {errors}");
        assert!(!runs.join("underway.jsonl").exists(), "{threat}");
    };
    // Latitude and longitude of a place to the east, the other way round.
    refused("84.25,36.3,100", 2, "lies outside of the area");
    refused("36.3,-84.25", 2, "not of the form");
    let links = runs.join("links.json");
    for (said, words) in [
        ("garbage", "links.json: expected value at line 1"),
        ("{\"links\": {}, \"speedup\": 1e300}", "allowed: 0.1 to 100"),
        ("{\"links\": {}, \"speedup\": -1}", "allowed: 0.1 to 100"),
    ] {
        std::fs::write(&links, said).expect("written");
        refused("36.3,-84.25,100", 3, words);
    }
    std::fs::remove_file(folder.path().join("out/lanes/plan.json")).expect("it is there");
    refused(
        "36.3,-84.25,100",
        4,
        "plan.json is not there, or not a plan",
    );
}

#[test]
fn who_stands_on_the_ground_is_named_and_who_flies_is_led_around_the_same_threat() {
    let later = lanes("-84.238").replace("id: bravo, ", "id: bravo, depart_s: 150, ");
    let (folder, runs, _flight) = aloft(&later, "4", ("alpha", 25.0));
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
fn who_still_climbs_after_its_takeoff_keeps_its_course() {
    let slow = lanes("-84.238").replace("climb_mps: 5", "climb_mps: 1");
    let (folder, runs, _flight) = aloft(&slow, "4", ("bravo", 12.0));
    let (output, told, errors) = replan(folder.path(), "36.305,-84.246,570");
    assert_eq!(output.status.code(), Some(4), "{told}{errors}");
    assert_eq!(told.matches("KEEPS ITS COURSE").count(), 2, "{told}");
    assert!(
        errors.contains("bravo cannot avoid popup-1 (it still climbs"),
        "{errors}"
    );
    assert_eq!(json(&runs.join("replan.json"))["verdict"], "fail");
}

#[test]
fn who_stands_on_the_ground_and_meets_no_threat_keeps_nobody_from_a_new_path() {
    let later = lanes("-84.238").replace("id: bravo, ", "id: bravo, depart_s: 150, ");
    let (folder, runs, _flight) = aloft(&later, "4", ("alpha", 25.0));
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
    let (folder, _, _flight) = aloft(&far, "2", ("alpha", 25.0));
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

/// Has a vehicle that is flown from here leave its mission, as another ground station would.
pub(super) fn order(runs: &Path, vehicle: &str, system: u8, mode: f32) {
    let said = json(&runs.join("links.json"));
    let link = said["links"][vehicle].as_str().expect("a link");
    let link = Link::parse(link).expect("a link");
    let links = Links::open(&[(system, &link)]).expect("a socket");
    let target = Address {
        system,
        component: 1,
    };
    let order = Command::new(Command::DO_SET_MODE, [1.0, mode]);
    links.send(
        system,
        Message::Flight(FlightMessage::Command { target, order }),
    );
    let _heard = links.receive(Duration::from_millis(500));
}

/// A copter, and a QuadPlane whose way begins with a steep descent from the top of its climb.
const WITH_WING: &str = "
sortie: 1
name: lanes
area: {south_west: {lat: -35.390, lon: 149.130}, north_east: {lat: -35.330, lon: 149.200}, min_agl_m: 30, max_amsl_m: 704}
terrain: {flat: {amsl_m: 584}}
vehicles:
  - {id: alpha, sysid: 1, autopilot: px4, link: sim, start: {lat: -35.3533, lon: 149.1600, agl_m: 40},
     goal: {lat: -35.3520, lon: 149.1750, agl_m: 40}, finish: land, speed_mps: 12, max_climb_deg: 10, max_descent_deg: 8}
  - {id: wing, sysid: 2, autopilot: ardupilot, airframe: vtol, link: sim, start: {lat: -35.3733, lon: 149.1500, agl_m: 60},
     goal: {lat: -35.3720, lon: 149.1760, agl_m: 60}, finish: land, loiter_radius_m: 80, speed_mps: 18,
     max_load_factor: 1.2, max_climb_deg: 10, max_descent_deg: 8, climb_mps: 3, descent_mps: 2.5}
separation: {distance_m: 60, vertical_m: 20, time_slack_s: 5}
planner: {algorithm: msfoa, seed: 1, evaluations: 2000}
";

#[test]
fn who_keeps_its_course_or_holds_keeps_nobody_from_a_new_path_wherever_on_its_way_it_is() {
    let (folder, runs) = planned("lanes", WITH_WING);
    let _flight = take_off(folder.path(), "lanes.yaml", "4");
    // The wing has climbed, and goes over into its way.
    wait_for(&runs, "wing", 28.0);
    let (output, told, errors) = replan(folder.path(), "-35.35250,149.1690,40");
    assert_eq!(output.status.code(), Some(0), "{told}{errors}");
    assert_eq!(told.matches("on its new path").count(), 1, "{told}");
    assert_eq!(json(&runs.join("replan.json"))["verdict"], "pass");
    // It circles where it is.
    const LOITER: f32 = 12.0;
    order(&runs, "wing", 2, LOITER);
    wait_for(&runs, "wing", 45.0);
    let (output, told, errors) = replan(folder.path(), "-35.35220,149.1725,40");
    assert_eq!(output.status.code(), Some(0), "{told}{errors}");
    assert_eq!(told.matches("on its new path").count(), 1, "{told}");
    assert!(told.contains("holds: is not concerned"), "{told}");
}

#[test]
fn who_flies_there_and_back_goes_on_there_on_its_new_path() {
    let there_and_back = WITH_WING.replacen("finish: land", "finish: return", 1);
    let there_and_back = there_and_back.replace("autopilot: px4", "autopilot: ardupilot");
    let (folder, runs) = planned("lanes", &there_and_back);
    let fly = ["fly", "lanes.yaml", "--speedup", "5", "--noise", "1"];
    let mut flight = begin(folder.path(), &fly);
    wait_for(&runs, "alpha", 36.0);
    let (output, told, errors) = replan(folder.path(), "-35.35280,149.1655,5");
    assert_eq!(output.status.code(), Some(0), "{told}{errors}");
    assert_eq!(told.matches("on its new path").count(), 1, "{told}");
    flight.0.wait().expect("it ends");
    let flown = json(&runs.join("flight.json"));
    let margins = flown["margins"].as_array().expect("margins").iter();
    let of = |what: &'static str| {
        let mut margins = margins.clone();
        margins.find(|m| m["vehicle"] == "alpha" && m["what"] == what)
    };
    assert_eq!(of("waypoints missed").expect("judged")["ok"], true);
    assert_eq!(of("nearest to its goal").expect("judged")["ok"], true);
}

#[test]
fn who_holds_is_not_said_to_be_on_a_new_path() {
    const BRAKE: f32 = 17.0;
    let (folder, runs, _flight) = aloft(&lanes("-84.238"), "2", ("alpha", 30.0));
    order(&runs, "alpha", 1, BRAKE);
    wait_for(&runs, "alpha", 45.0);
    // Both meet it.
    let (output, told, errors) = replan(folder.path(), "36.305,-84.244,570");
    // Alpha stays clear of it, as long as nobody sends it on.
    assert_eq!(output.status.code(), Some(0), "{told}{errors}");
    for part in [
        "holds: is not concerned",
        "its mission meets a threat, do not resume it",
    ] {
        assert!(told.contains(part), "{part} in {told}");
    }
    assert_eq!(told.matches("on its new path").count(), 1, "{told}");
    let done = json(&runs.join("replan.json"));
    assert_eq!(done["verdict"], "pass");
    assert_eq!(done["vehicles"][0]["id"], "bravo");
}

#[test]
fn who_passes_a_threat_while_the_command_looks_is_named() {
    let (folder, runs) = planned("lanes", &lanes("-84.215"));
    let mut flight = take_off(folder.path(), "lanes.yaml", "10");
    // Discs of 25 m along the way of alpha, told when it is about there.
    let mut told_of = Vec::new();
    for number in 1_u8..=5 {
        wait_for(&runs, "alpha", 20.0 * f64::from(number) + 10.0);
        let record = lines(&runs);
        let of = |line: &&Value| line["vehicle"] == "alpha" && line["lat_deg"].is_f64();
        let latest = record.iter().rfind(of).expect("a position");
        let lon_deg = latest["lon_deg"].as_f64().expect("degrees") + 0.0001 * f64::from(number);
        let (output, told, errors) = replan(folder.path(), &format!("36.300,{lon_deg},25"));
        let verdict = json(&runs.join("replan.json"))["verdict"].clone();
        let names = errors.contains(&format!("popup-{number}"));
        told_of.push((output.status.code(), verdict, names, told + &errors));
    }
    flight.0.wait().expect("it ends");
    let flown = json(&runs.join("flight.json"));
    for margin in flown["margins"].as_array().expect("margins") {
        let threat = margin["what"].as_str().expect("a limit");
        let Some(number) = threat.strip_prefix("threat popup-") else {
            continue;
        };
        let number: usize = number.parse().expect("a number");
        let (code, verdict, names, said) = &told_of[number - 1];
        if margin["vehicle"] == "alpha" && margin["ok"] == false {
            assert_eq!((*code, *names), (Some(4), true), "{threat}: {said}");
            assert_eq!(verdict, "fail", "{threat}: {said}");
        }
    }
    assert!(told_of.iter().any(|of| of.2), "none was met");
}

#[test]
fn a_port_that_fly_listens_at_is_refused_before_the_threat_is_recorded() {
    let (folder, runs) = planned("lanes", &lanes("-84.251"));
    let listening = std::net::UdpSocket::bind("127.0.0.1:0").expect("a port");
    let link = format!("udpin:{}", listening.local_addr().expect("bound"));
    std::fs::create_dir_all(&runs).expect("a folder");
    let notice = serde_json::json!({
        "links": {"alpha": link, "bravo": "udpout:127.0.0.1:9"},
        "speedup": 1.0,
        "t0_unix_ms": null,
    });
    std::fs::write(runs.join("links.json"), notice.to_string()).expect("written");
    let (output, _, errors) = replan(folder.path(), "36.300,-84.258,200");
    assert_eq!(output.status.code(), Some(5), "{errors}");
    for part in [
        "listens there",
        "--link alpha=",
        "the threat was not recorded",
    ] {
        assert!(errors.contains(part), "{part} in {errors}");
    }
    assert!(!runs.join("underway.jsonl").exists());
}

#[test]
fn who_returns_lands_or_holds_is_named_where_its_own_way_meets_a_threat_and_only_there() {
    const LAND: f32 = 9.0;
    const RETURN: f32 = 6.0;
    // A threat on the way home, and one on the mission ahead.
    let (behind, ahead) = ("36.300,-84.2635,30", "36.300,-84.245,60");
    for (mode, word, why) in [
        (RETURN, "returns", "it returns, and its way leads into it"),
        (LAND, "lands", ""),
    ] {
        let (folder, runs, _flight) = aloft(&lanes("-84.238"), "4", ("alpha", 40.0));
        order(&runs, "alpha", 1, mode);
        wait_for(&runs, "alpha", 44.0);
        let (output, told, errors) = replan(folder.path(), ahead);
        assert_eq!(output.status.code(), Some(0), "{word}: {told}{errors}");
        let line = format!("{word}: is not concerned");
        assert!(told.contains(&line), "{line} in {told}");
        let (output, told, errors) = replan(folder.path(), behind);
        let is_named = errors.contains(&format!("alpha cannot avoid popup-2 ({why}"));
        let expected = if why.is_empty() {
            (Some(0), false)
        } else {
            (Some(4), true)
        };
        assert_eq!(
            (output.status.code(), is_named),
            expected,
            "{word}: {told}{errors}"
        );
    }
}

/// Passes messages on between a ground station and a vehicle; `change` says what becomes of each that it sends, and
/// how many milliseconds later it comes.
fn relay(far: &str, change: impl Fn(&mut Message) -> u64 + Send + 'static) -> String {
    let bind = || std::net::UdpSocket::bind("127.0.0.1:0").expect("a free port");
    let (near, there) = (bind(), bind());
    there.connect(far).expect("a vehicle");
    let address = near.local_addr().expect("bound").to_string();
    for socket in [&near, &there] {
        socket.set_nonblocking(true).expect("a socket");
    }
    std::thread::spawn(move || {
        let (mut station, mut buffer) = (None, [0; 2048]);
        let mut decoder = Decoder::default();
        let mut waiting = std::collections::VecDeque::<(u64, Vec<u8>)>::new();
        #[allow(clippy::disallowed_methods)]
        let began = std::time::Instant::now();
        loop {
            let now_ms = began.elapsed().as_millis() as u64;
            while waiting.front().is_some_and(|(due, _)| *due <= now_ms)
                && let (Some((_, bytes)), Some(station)) = (waiting.pop_front(), station)
            {
                let _: std::io::Result<usize> = near.send_to(&bytes, station);
            }
            if let Ok((length, from)) = near.recv_from(&mut buffer) {
                station = Some(from);
                let _ = there.send(&buffer[..length]);
            } else if let Ok(length) = there.recv(&mut buffer) {
                decoder.push(&buffer[..length]);
                while let Some((from, mut message)) = decoder.next_message() {
                    let late_ms = change(&mut message);
                    let bytes: Vec<u8> = Encoder::new(from).encode(&message);
                    waiting.push_back((now_ms + late_ms, bytes));
                }
            } else {
                std::thread::sleep(Duration::from_micros(500));
            }
        }
    });
    address
}

/// A vehicle that does not say how many items it holds.
fn uncounted(far: &str) -> String {
    relay(far, |message| {
        if let Message::MissionCurrent { total, .. } = message {
            *total = 0;
        }
        0
    })
}

/// Replans alpha over a relay; what becomes of the messages of the vehicle is said by `change`.
fn replan_over(
    change: impl Fn(&mut Message) -> u64 + Send + 'static,
    threat: &str,
) -> (Option<i32>, String) {
    let (folder, runs, _flight) = aloft(&lanes("-84.215"), "1", ("alpha", 24.0));
    let links = json(&runs.join("links.json"));
    let far = links["links"]["alpha"].as_str().expect("a link");
    let near = relay(far.strip_prefix("udpout:").expect("UDP"), change);
    let link = format!("--link=alpha=udpout:{near}");
    let threat = format!("--threat={threat}");
    let output = sortie(folder.path(), &["replan", "lanes.yaml", &threat, &link]);
    let said = text(&output.stdout) + &text(&output.stderr);
    (output.status.code(), said)
}

#[test]
fn over_a_link_of_two_seconds_a_vehicle_is_led_onto_its_new_path() {
    let (code, said) = replan_over(|_| 2000, "36.3003,-84.225,120");
    assert_eq!(code, Some(0), "{said}");
    assert_eq!(said.matches("on its new path").count(), 1, "{said}");
}

#[test]
fn positions_at_zero_are_none_and_a_vehicle_that_sends_no_others_is_named() {
    let (code, said) = replan_over(
        |message| {
            if let Message::Flight(FlightMessage::Position(position)) = message {
                (position.x, position.y) = (0, 0);
            }
            0
        },
        "36.3003,-84.225,120",
    );
    assert_eq!(code, Some(5), "{said}");
    assert!(said.contains("alpha: does not say where it is"), "{said}");
    assert!(!said.contains("on its new path"), "{said}");
}

#[test]
fn a_vehicle_that_does_not_say_how_many_items_it_holds_is_sent_nothing_and_named() {
    let (folder, runs, mut flight) = aloft(&lanes("-84.238"), "4", ("alpha", 30.0));
    let links = json(&runs.join("links.json"));
    let far = links["links"]["alpha"].as_str().expect("a link");
    let near = uncounted(far.strip_prefix("udpout:").expect("UDP"));
    let link = format!("--link=alpha=udpout:{near}");
    let threat = "--threat=36.305,-84.244,570";
    let output = sortie(folder.path(), &["replan", "lanes.yaml", threat, &link]);
    let (told, errors) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(4), "{told}{errors}");
    let why = "alpha cannot avoid popup-1 (it does not say how many items it holds";
    assert!(errors.contains(why), "{errors}");
    // Bravo is led around it all the same.
    assert_eq!(told.matches("on its new path").count(), 1, "{told}");
    flight.0.wait().expect("it ends");
    let flown = json(&runs.join("flight.json"));
    let margins = flown["margins"].as_array().expect("margins");
    let beside = |m: &&Value| m["vehicle"] == "alpha" && m["what"] == "cross-track error";
    let beside = margins.iter().find(beside).expect("judged");
    assert_eq!(beside["ok"], true, "{beside}");
}

#[test]
fn one_that_landed_or_is_not_heard_does_not_keep_the_others_from_being_led() {
    let (folder, runs, mut flight) = aloft(&lanes("-84.238"), "4", ("alpha", 20.0));
    let path = runs.join("links.json");
    let mut notice = json(&path);
    // Nobody answers there.
    notice["links"]["alpha"] = "udpout:127.0.0.1:9".into();
    std::fs::write(&path, notice.to_string()).expect("written");
    let (output, told, errors) = replan(folder.path(), "36.3103,-84.2425,120");
    assert_eq!(output.status.code(), Some(0), "{told}{errors}");
    assert!(errors.contains("WARNING: alpha is not heard"), "{errors}");
    assert_eq!(told.matches("on its new path").count(), 1, "{told}");
    let took = "is on the plan of replan";
    let is_its = |line: &Value| line["vehicle"] == "bravo" && line["event"] == took;
    std::thread::sleep(Duration::from_millis(500));
    assert!(lines(&runs).iter().any(is_its), "{took}");
    notice["ended"]["alpha"] = serde_json::json!({"end": "landed", "t_s": 12.5});
    std::fs::write(&path, notice.to_string()).expect("written");
    let (output, told, errors) = replan(folder.path(), "36.3200,-84.2150,60");
    assert_eq!(output.status.code(), Some(0), "{told}{errors}");
    let line = "alpha: its flight is over (landed); it is left out";
    assert!(errors.contains(line), "{errors}");
    assert!(!errors.contains("is not heard"), "{errors}");
    let _ = flight.0.kill();
    let _ = flight.0.wait();
}
