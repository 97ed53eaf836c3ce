//! `sortie fly` and `sortie replan` as an operator types them, in a hurry.

use crate::support::{command, in_flight};
use std::net::{SocketAddr, UdpSocket};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use command::{sortie, text};
use in_flight::{json, lanes, planned, take_off, wait_for};
use serde_json::Value;

#[test]
fn a_fleet_flies_in_a_hurry_and_its_record_says_that_the_limits_held() {
    let (folder, _) = planned("lanes", &lanes("-84.238"));
    let output = sortie(folder.path(), &["fly", "lanes.yaml", "--speedup", "20"]);
    let told = text(&output.stdout);
    assert!(output.status.success(), "{told}{}", text(&output.stderr));
    for line in [
        "all are armed: T0",
        "alpha: took off",
        "alpha: landed",
        "bravo: loiters",
    ] {
        assert!(told.contains(line), "{line} in {told}");
    }
    let runs = folder.path().join("out/lanes.runs");
    let flight = json(&runs.join("flight.json"));
    assert_eq!(flight["verdict"], "pass");
    assert_eq!(flight["vehicles"][0]["end"], "landed");
    let separation = flight["margins"].as_array().expect("margins").iter();
    let mut separation = separation.filter(|margin| margin["what"] == "separation");
    let flown = separation.next().expect("one pair")["value"]
        .as_f64()
        .expect("metres");
    assert!((900.0..1200.0).contains(&flown), "{flown}");
    let lines = std::fs::read_to_string(runs.join("flight.jsonl")).expect("the record");
    let fixes = lines
        .lines()
        .filter(|line| line.contains("lat_deg"))
        .count();
    assert!(fixes > 800, "{fixes} positions");
    // The record alone gives the same verdict again, to the byte.
    let review = |arguments: &[&str]| {
        let arguments = [&["review"], arguments].concat();
        let output = sortie(folder.path(), &arguments);
        (
            output.status.code(),
            text(&output.stdout),
            text(&output.stderr),
        )
    };
    let record = "out/lanes.runs/flight.jsonl";
    let (code, again, errors) = review(&[record, "--json", "--html", "flown.html"]);
    assert_eq!(code, Some(0), "{errors}");
    let document = std::fs::read_to_string(runs.join("flight.json")).expect("it is there");
    assert_eq!(again.trim_end(), document.trim_end());
    let page = std::fs::read(folder.path().join("flown.html")).expect("the page");
    assert_eq!(
        page,
        std::fs::read(runs.join("flight.html")).expect("that of the flight")
    );
    let page = text(&page);
    assert!(page.contains("Flown against planned") && page.contains("class=\"planned v0\""));
    // Held against tighter limits it fails; cut short it fails; spoilt it is none.
    let post = "threats: [{id: post, kind: lookout, lat: 36.301, lon: -84.25, radius_m: 150}]";
    let tight = lanes("-84.238").replace(
        "vehicles:",
        &format!(
            "{post}
vehicles:"
        ),
    );
    std::fs::write(folder.path().join("tight.yaml"), tight).expect("written");
    let (code, told, errors) = review(&["tight.yaml", record]);
    assert_eq!(code, Some(4), "{told}{errors}");
    assert!(told.contains("FAIL alpha: threat post"), "{told}");
    assert!(errors.contains("was flown by another spec"), "{errors}");
    let half: Vec<&str> = lines.lines().take(lines.lines().count() / 2).collect();
    std::fs::write(folder.path().join("half.jsonl"), half.join("\n")).expect("written");
    let (code, told, errors) = review(&["lanes.yaml", "half.jsonl"]);
    assert_eq!(code, Some(4), "{told}{errors}");
    // In half the time nobody can have flown it.
    let hasten = |line: &str| {
        let mut line: Value = serde_json::from_str(line).expect("JSON");
        if let Some(t_s) = line["t_s"].as_f64() {
            line["t_s"] = (0.5 * t_s).into();
        }
        line.to_string()
    };
    let fast: Vec<String> = lines.lines().map(hasten).collect();
    std::fs::write(folder.path().join("fast.jsonl"), fast.join("\n")).expect("written");
    let (code, told, errors) = review(&["lanes.yaml", "fast.jsonl"]);
    assert_eq!(code, Some(4), "{told}{errors}");
    assert!(told.contains("FAIL alpha: ground speed held"), "{told}");
    std::fs::write(folder.path().join("none.jsonl"), "{}\n{}\n").expect("written");
    let (code, _, errors) = review(&["lanes.yaml", "none.jsonl"]);
    assert_eq!(code, Some(3), "{errors}");
    // Another plan in the record is told of; a spec of another place is none for it.
    let edited = lines.replacen("\"items\":", "\"items\":1", 1);
    std::fs::write(runs.join("edited.jsonl"), edited).expect("written");
    let (_, _, told) = review(&["out/lanes.runs/edited.jsonl"]);
    assert!(told.contains("is not its mission"), "{told}");
    assert!(!review(&[record]).2.contains("is not its mission"));
    let headless: Vec<&str> = lines.lines().skip(1).collect();
    std::fs::write(runs.join("headless.jsonl"), headless.join("\n")).expect("written");
    let (code, _, told) = review(&["out/lanes.runs/headless.jsonl"]);
    assert_eq!(code, Some(3), "{told}");
    assert!(told.contains("has no header"), "{told}");
    let elsewhere = lanes("-84.238").replace("lat: 36.", "lat: 37.");
    std::fs::write(folder.path().join("elsewhere.yaml"), elsewhere).expect("written");
    let (code, _, told) = review(&["elsewhere.yaml", record]);
    assert_eq!(code, Some(3), "{told}");
    assert!(told.contains("was never in the area"), "{told}");
    assert!(
        errors.contains("line 1: is no line of a flight record"),
        "{errors}"
    );
    assert!(!runs.join("links.json").exists());
}

#[test]
fn without_a_plan_or_with_another_spec_nothing_is_started() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("lanes.yaml"), lanes("-84.238")).expect("written");
    let output = sortie(folder.path(), &["fly", "lanes.yaml"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(text(&output.stderr).contains("sortie plan lanes.yaml"));
    let (folder, _) = planned("lanes", &lanes("-84.238"));
    let other = lanes("-84.238").replace("min_agl_m: 30", "min_agl_m: 31");
    std::fs::write(folder.path().join("lanes.yaml"), other).expect("written");
    let output = sortie(folder.path(), &["fly", "lanes.yaml"]);
    assert_eq!(output.status.code(), Some(4));
    assert!(text(&output.stderr).contains("another spec"));
}

/// One position of a vehicle: metres east and north of 36.3 N 84.25 W, and what it said.
#[derive(Clone, Copy, Debug)]
struct At {
    t_s: f64,
    place: [f64; 2],
    speed_mps: f64,
    items: u64,
}

fn place(line: &Value) -> [f64; 2] {
    let degrees = |key: &str| line[key].as_f64().expect("degrees");
    let (lat, lon) = (degrees("lat_deg"), degrees("lon_deg"));
    [
        (lon + 84.25) * 111_320.0 * 36.3_f64.to_radians().cos(),
        (lat - 36.3) * 110_960.0,
    ]
}

fn track(lines: &[Value], vehicle: &str) -> Vec<At> {
    let of = |line: &&Value| line["vehicle"] == vehicle && line["lat_deg"].is_f64();
    let at = |line: &Value| At {
        t_s: line["t_s"].as_f64().expect("seconds"),
        place: place(line),
        speed_mps: line["speed_mps"].as_f64().expect("m/s"),
        items: line["items"].as_u64().expect("a count"),
    };
    lines.iter().filter(of).map(at).collect()
}

/// The plans that a vehicle was given: number of items, legs.
fn plans(lines: &[Value], vehicle: &str) -> Vec<(u64, Vec<[f64; 2]>)> {
    let of = |line: &&Value| line["vehicle"] == vehicle && line["plan"].is_object();
    let plan = |line: &Value| {
        let waypoints = line["plan"]["waypoints"].as_array().expect("waypoints");
        let items = line["plan"]["items"].as_u64().expect("a count");
        (items, waypoints.iter().map(place).collect())
    };
    lines.iter().filter(of).map(plan).collect()
}

fn beside_m(legs: &[[f64; 2]], at: [f64; 2]) -> f64 {
    let of = |a: [f64; 2], b: [f64; 2]| {
        let (along, gone) = ([b[0] - a[0], b[1] - a[1]], [at[0] - a[0], at[1] - a[1]]);
        let length_sq = (along[0] * along[0] + along[1] * along[1]).max(1e-9);
        let share = ((along[0] * gone[0] + along[1] * gone[1]) / length_sq).clamp(0.0, 1.0);
        (gone[0] - share * along[0]).hypot(gone[1] - share * along[1])
    };
    let legs = legs.windows(2).map(|pair| of(pair[0], pair[1]));
    legs.fold(f64::INFINITY, f64::min)
}

/// That a vehicle went from its plan to another one on its way: never slow, never beside
/// the plan that it had at the time, the change of plans included.
fn went_on(lines: &[Value], vehicle: &str, until_s: f64) {
    let (track, plans) = (track(lines, vehicle), plans(lines, vehicle));
    assert_eq!(plans.len(), 2, "{vehicle}");
    let ((old, before), (new, after)) = (&plans[0], &plans[1]);
    assert_ne!(
        old, new,
        "{vehicle}: its number of items tells its plans apart"
    );
    let threat = lines.iter().find(|line| line["threat"].is_object());
    let known_s = threat.expect("the threat")["t_s"]
        .as_f64()
        .expect("seconds");
    let switch = track.iter().position(|at| at.items == *new);
    let switch = switch.unwrap_or_else(|| panic!("{vehicle} never had {new} items"));
    assert!(
        track[switch].t_s > known_s,
        "{vehicle}: {:?}",
        track[switch]
    );
    let watched = |at: &&At| (known_s..until_s).contains(&at.t_s);
    for at in track.iter().filter(watched) {
        assert!(at.speed_mps > 5.0, "{vehicle} nearly stopped: {at:?}");
    }
    let near_s = 12.0;
    let changed_s = track[switch].t_s;
    for at in &track[..switch] {
        if at.t_s > changed_s - near_s {
            let beside = beside_m(before, at.place);
            assert!(
                beside < 3.0,
                "{vehicle} is {beside} m beside its old plan: {at:?}"
            );
        }
    }
    for at in &track[switch..] {
        if at.t_s < changed_s + near_s {
            let beside = beside_m(after, at.place);
            assert!(
                beside < 6.0,
                "{vehicle} is {beside} m beside its new plan: {at:?}"
            );
        }
    }
}

/// Between `replan` and one vehicle; keeps what was sent to it.
struct Tap {
    near: SocketAddr,
    heard: Arc<Mutex<Vec<Vec<u8>>>>,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Tap {
    fn to(far: SocketAddr) -> Self {
        let near = UdpSocket::bind("127.0.0.1:0").expect("a free port");
        let there = UdpSocket::bind("127.0.0.1:0").expect("a free port");
        let wait = Some(Duration::from_millis(2));
        near.set_read_timeout(wait).expect("a socket");
        there.set_nonblocking(true).expect("a socket");
        let address = near.local_addr().expect("bound");
        let heard = Arc::new(Mutex::new(Vec::new()));
        let stop = Arc::new(AtomicBool::new(false));
        let (kept, stopped) = (Arc::clone(&heard), Arc::clone(&stop));
        let thread = std::thread::spawn(move || {
            let mut peer = None;
            let mut frame = [0; 2048];
            while !stopped.load(Ordering::Relaxed) {
                if let Ok((length, from)) = near.recv_from(&mut frame) {
                    peer = Some(from);
                    kept.lock()
                        .expect("no panic")
                        .push(frame[..length].to_vec());
                    there.send_to(&frame[..length], far).expect("sent");
                }
                // All that the vehicle said: it says more in a second than there are waits.
                while let (Ok((length, _)), Some(peer)) = (there.recv_from(&mut frame), peer) {
                    near.send_to(&frame[..length], peer).expect("sent");
                }
            }
        });
        Self {
            near: address,
            heard,
            stop,
            thread: Some(thread),
        }
    }

    /// Message ids of all frames, and the commands of `COMMAND_LONG`s.
    fn sent(self) -> (Vec<u32>, Vec<u16>) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread {
            thread.join().expect("no panic");
        }
        let heard = self.heard.lock().expect("no panic");
        let id = |frame: &[u8]| u32::from_le_bytes([frame[7], frame[8], frame[9], 0]);
        let mut ids = Vec::new();
        let mut commands = Vec::new();
        for frame in heard.iter() {
            assert_eq!(frame[0], 0xFD, "MAVLink 2");
            ids.push(id(frame));
            if id(frame) == 76 {
                commands.push(u16::from_le_bytes([frame[10 + 28], frame[10 + 29]]));
            }
        }
        (ids, commands)
    }
}

/// Three copters on parallel lanes 600 m apart; the last one comes back.
const THREE: &str = "
sortie: 1
name: three
area: {south_west: {lat: 36.28, lon: -84.30}, north_east: {lat: 36.33, lon: -84.20}, min_agl_m: 30, max_amsl_m: 900}
terrain: {flat: {amsl_m: 400}}
vehicles:
  - {id: alpha, sysid: 1, autopilot: ardupilot, link: sim, speed_mps: 15, climb_mps: 5, descent_mps: 4,
     start: {lat: 36.3000, lon: -84.270, agl_m: 60}, goal: {lat: 36.3000, lon: -84.235, agl_m: 60}, finish: land}
  - {id: bravo, sysid: 2, autopilot: px4, link: sim, speed_mps: 15, climb_mps: 5, descent_mps: 4,
     start: {lat: 36.3054, lon: -84.270, agl_m: 60}, goal: {lat: 36.3054, lon: -84.235, agl_m: 60}, finish: loiter}
  - {id: charlie, sysid: 3, autopilot: ardupilot, link: sim, speed_mps: 15, climb_mps: 5, descent_mps: 4,
     start: {lat: 36.3160, lon: -84.270, agl_m: 60}, goal: {lat: 36.3160, lon: -84.252, agl_m: 60}, finish: return}
separation: {distance_m: 100, time_slack_s: 5}
planner: {algorithm: msfoa, seed: 1, evaluations: 2000}
";

fn popup<'a>(flown: &'a Value, vehicle: &str) -> &'a Value {
    let margins = flown["margins"].as_array().expect("margins");
    let of = |margin: &&Value| margin["vehicle"] == vehicle && margin["what"] == "threat popup-1";
    margins
        .iter()
        .find(of)
        .expect("the threat that came up is among the limits")
}

#[test]
fn three_in_flight_meet_a_popup_threat_go_around_it_without_a_stop_and_one_is_not_touched() {
    let (folder, runs) = planned("three", THREE);
    let mut flight = take_off(folder.path(), "three.yaml", "4");
    wait_for(&runs, "alpha", 30.0);
    let links = json(&runs.join("links.json"));
    let charlie = links["links"]["charlie"].as_str().expect("its address");
    let download = |name: &str| {
        let output = sortie(folder.path(), &["download", "--link", charlie, "-o", name]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        std::fs::read(folder.path().join(name)).expect("what it holds")
    };
    let before = download("before.waypoints");
    let far = charlie.strip_prefix("udpout:").expect("UDP");
    let tap = Tap::to(far.parse().expect("an address"));
    let link = format!("charlie=udpout:{}", tap.near);
    let threat = "--threat=36.3027,-84.243,330";
    let arguments = ["replan", "three.yaml", threat, "--link", &link];
    let output = sortie(folder.path(), &arguments);
    let told = text(&output.stdout);
    assert!(output.status.success(), "{told}{}", text(&output.stderr));
    let after = download("after.waypoints");
    assert_eq!(before, after, "charlie holds what it held");
    let (ids, commands) = tap.sent();
    // Heartbeats, reading of lists, and requests for single messages.
    let harmless = |id: &u32| [0, 43, 47, 51, 76].contains(id);
    assert!(ids.iter().all(harmless), "{ids:?}");
    assert!(
        !commands.is_empty() && commands.iter().all(|command| *command == 512),
        "{commands:?}"
    );
    assert_eq!(told.matches("on its new path").count(), 2, "{told}");
    assert_eq!(told.matches("not touched").count(), 1, "{told}");
    let done = json(&runs.join("replan.json"));
    let planning_s = done["planning_s"].as_f64().expect("seconds");
    // Under a second in a release build; this one may be slow, on a busy machine.
    assert!(planning_s < 10.0, "{planning_s} s");
    let status = flight.0.wait().expect("it ends");
    let flown = json(&runs.join("flight.json"));
    assert_eq!(flown["verdict"], "pass", "{flown:#}");
    assert!(status.success(), "{status}");
    let alarms = flown["alarms"].as_array().expect("alarms");
    let of_lists = |alarm: &&Value| {
        let text = alarm["text"].as_str();
        text.is_some_and(|text| text.contains("on board"))
    };
    // Its fence is sent again.
    assert_eq!(alarms.iter().find(of_lists), None);
    let text = std::fs::read_to_string(runs.join("flight.jsonl")).expect("the record");
    let lines: Vec<Value> = text
        .lines()
        .map(|line| serde_json::from_str(line).expect("JSON"))
        .collect();
    for (vehicle, goal_lon) in [("alpha", -84.235), ("bravo", -84.235)] {
        let goal_east = place(&serde_json::json!({"lat_deg": 36.3, "lon_deg": goal_lon}))[0];
        let flown_track = track(&lines, vehicle);
        let arrives = flown_track
            .iter()
            .find(|at| at.place[0] > goal_east - 120.0);
        went_on(&lines, vehicle, arrives.expect("it comes to its goal").t_s);
        let margin = popup(&flown, vehicle)["value"].as_f64().expect("metres");
        assert!(
            (0.0..200.0).contains(&margin),
            "{vehicle}: {margin} m from the rim"
        );
    }
    assert!(popup(&flown, "charlie")["value"].as_f64().expect("metres") > 500.0);
    assert_eq!(plans(&lines, "charlie").len(), 1);
    let one = track(&lines, "charlie")[0].items;
    assert!(track(&lines, "charlie").iter().all(|at| at.items == one));
    for vehicle in flown["vehicles"].as_array().expect("vehicles") {
        let beside = vehicle["cross_track_m"]["worst"].as_f64().expect("metres");
        assert!(beside < 15.0, "{vehicle:#}");
    }
}

#[test]
fn a_vehicle_that_returns_is_led_around_a_threat_on_its_way_out_and_home() {
    let (folder, runs) = planned("three", &THREE.replace("lon: -84.235", "lon: -84.262"));
    let mut flight = take_off(folder.path(), "three.yaml", "8");
    wait_for(&runs, "charlie", 22.0);
    let threat = "--threat=36.3161,-84.2575,120";
    let output = sortie(folder.path(), &["replan", "three.yaml", threat]);
    let told = text(&output.stdout);
    assert!(output.status.success(), "{told}{}", text(&output.stderr));
    assert_eq!(told.matches("on its new path").count(), 1, "{told}");
    assert_eq!(told.matches("not touched").count(), 2, "{told}");
    let status = flight.0.wait().expect("it ends");
    let flown = json(&runs.join("flight.json"));
    assert_eq!(flown["verdict"], "pass", "{flown:#}");
    assert!(status.success(), "{status}");
    assert_eq!(flown["vehicles"][2]["end"], "landed");
    let margin = popup(&flown, "charlie")["value"].as_f64().expect("metres");
    assert!((0.0..120.0).contains(&margin), "{margin} m from the rim");
    let text = std::fs::read_to_string(runs.join("flight.jsonl")).expect("the record");
    let lines: Vec<Value> = text
        .lines()
        .map(|line| serde_json::from_str(line).expect("JSON"))
        .collect();
    let goal = place(&serde_json::json!({"lat_deg": 36.316, "lon_deg": -84.252}));
    let away_m = |at: &At| (at.place[0] - goal[0]).hypot(at.place[1] - goal[1]);
    let track = track(&lines, "charlie");
    let nearest = track.iter().map(away_m).fold(f64::INFINITY, f64::min);
    assert!(nearest < 5.0, "{nearest} m from the goal");
    let turns = track.iter().find(|at| away_m(at) < 120.0);
    went_on(&lines, "charlie", turns.expect("it comes to its goal").t_s);
}
