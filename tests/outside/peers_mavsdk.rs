//! Both sides of a transfer against implementations that are not ours: MAVSDK as vehicle,
//! MAVSDK and pymavlink as ground stations.

use crate::support::{mavsdk, peers, ports, transfers};
use mavsdk::Peer;
use serde_json::Value;
use sortie::link::{MissionType, TransferReport, Verdict};
use sortie::mission::{Item, VehicleMission, command, frame};
use sortie::simulator::{Profile, Simulated, spawn};
use sortie::spec::{Autopilot, Link};
use transfers::{HOME, corner};

fn waypoint(n: i32) -> Item {
    Item {
        params: [0.0, 2.5, 0.0, f32::NAN],
        x: HOME.x + 1003 * n,
        y: HOME.y - 771 * n,
        z: 480.37,
        ..transfers::waypoint(n)
    }
}

fn mission(autopilot: Autopilot) -> VehicleMission {
    let mut items: Vec<Item> = (0..40).map(waypoint).collect();
    items[0].command = command::NAV_TAKEOFF;
    items[1] = Item::without_place(command::DO_CHANGE_SPEED, [1.0, 12.5, -1.0, 0.0]);
    items.push(Item {
        command: command::NAV_LAND,
        ..waypoint(39)
    });
    VehicleMission {
        fence: [-200, 300, 800].map(|n| corner(n, 3)).to_vec(),
        ..transfers::mission(autopilot, items)
    }
}

fn upload(port: u16, sysid: u8, mission: &VehicleMission) -> TransferReport {
    let link = Link::UdpIn(format!("127.0.0.1:{port}"));
    transfers::upload(sysid, &link, mission, false)
}

/// What the peer says it got, against what was sent.
fn assert_same(list: &Value, mission_type: u8, sent: &[Item]) {
    let got = list.as_array().expect("a list");
    assert_eq!(got.len(), sent.len());
    for (seq, (got, sent)) in got.iter().zip(sent).enumerate() {
        let float = |value: f32| serde_json::to_value(f64::from(value)).expect("a number or null");
        assert_eq!(got["mission_type"], mission_type);
        assert_eq!(got["seq"], seq);
        assert_eq!(got["command"], sent.command);
        assert_eq!(got["frame"], sent.frame);
        assert_eq!(got["x"], sent.x);
        assert_eq!(got["y"], sent.y);
        assert_eq!(got["z"], float(sent.z), "item {seq}");
        assert_eq!(
            got["params"],
            Value::from(sent.params.map(float).to_vec()),
            "item {seq}"
        );
        assert_eq!(got["current"], u8::from(mission_type == 0 && seq == 0));
    }
}

#[test]
fn mavsdk_takes_mission_and_fence_and_they_read_back_equal() {
    let Some(python) = peers::python() else {
        return;
    };
    let port = ports::unshared().port();
    let peer = Peer::start(&python, port, 1);
    let mission = mission(Autopilot::Px4);
    let report = upload(port, 1, &mission);
    assert_eq!(report.verdict, Verdict::Verified, "{report:?}");
    assert_eq!((report.items, report.fence, report.rally), (41, 3, 0));
    assert_eq!(report.autopilot, "generic autopilot vehicle");
    assert_same(&peer.list(), 1, &mission.fence);
    assert_same(&peer.list(), 0, &mission.items);
}

#[test]
fn mavsdk_takes_an_ardupilot_mission_with_home_in_front() {
    let Some(python) = peers::python() else {
        return;
    };
    let port = ports::unshared().port();
    let peer = Peer::start(&python, port, 7);
    let mission = mission(Autopilot::ArduPilot);
    let report = upload(port, 7, &mission);
    assert_eq!(report.verdict, Verdict::Verified, "{report:?}");
    assert_eq!(report.items, 41);
    peer.list();
    let home = Item {
        command: command::NAV_WAYPOINT,
        frame: frame::GLOBAL,
        autocontinue: true,
        params: [0.0; 4],
        x: HOME.x,
        y: HOME.y,
        z: HOME.amsl_m,
    };
    let rows: Vec<Item> = std::iter::once(home)
        .chain(mission.items.iter().copied())
        .collect();
    assert_same(&peer.list(), 0, &rows);
}

/// Ground stations that are not ours load the simulated vehicles and read them back.
#[test]
fn mavsdk_and_pymavlink_load_the_simulated_vehicles() {
    let Some(python) = peers::python() else {
        return;
    };
    for profile in [Profile::ArduPilot, Profile::Px4] {
        for tool in ["mavsdk", "pymavlink"] {
            let vehicle = spawn(&Simulated::on_loopback(profile, 3, Some(HOME))).expect("a port");
            let port = vehicle.address().port().to_string();
            let script = "vehicle_ground_station.py";
            let result = peers::run(&python, script, &[tool, &port, "60"]);
            let read = result["items"].as_array().expect("a list");
            assert_eq!(read.len(), 60, "{profile:?} {tool}");
            for (seq, item) in (0..60).zip(read) {
                let place = [&item[1], &item[2], &item[3]].map(|n| n.as_f64().expect("a number"));
                let sent = match (profile, seq) {
                    (Profile::ArduPilot, 0) => [363e6, -842.5e6, 400.5],
                    _ => [
                        363e6 + 100.0 * f64::from(seq),
                        -842.5e6 - 70.0 * f64::from(seq),
                        480.25,
                    ],
                };
                assert!(
                    place.iter().zip(sent).all(|(a, b)| (a - b).abs() < 1e-6),
                    "{profile:?} {tool}: {item}"
                );
            }
            let items = vehicle.items(MissionType::Mission);
            assert_eq!(
                items.len(),
                if profile == Profile::ArduPilot {
                    59
                } else {
                    60
                }
            );
            let result = peers::run(&python, script, &[tool, &port, "3", "clear"]);
            assert!(result["error"].is_null(), "{profile:?} {tool}: {result}");
            assert_eq!(
                vehicle.items(MissionType::Mission),
                [],
                "{profile:?} {tool}"
            );
        }
    }
}
