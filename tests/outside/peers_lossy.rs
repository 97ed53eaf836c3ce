//! Transfers through a bad radio, over real sockets, with implementations that are
//! not ours at the other end: whoever fails, nobody says "uploaded" wrongly.

use crate::support::{lossy_proxy, mavsdk, peers, ports, transfers};
use std::path::Path;

use lossy_proxy::{LossyProxy, Radio};
use mavsdk::Peer;
use sortie::link::{MissionType, TransferReport, Verdict};
use sortie::mission::Item;
use sortie::simulator::{Profile, Simulated, spawn};
use sortie::spec::{Autopilot, Link};
use transfers::{HOME, mission, upload, waypoint};

/// Uploads to MAVSDK at that loss, and holds the verdict against what MAVSDK got.
fn upload_to_mavsdk(python: &Path, items: i32, percent: u32, seed: u64) -> TransferReport {
    let ground = ports::unshared();
    let proxy = LossyProxy::to(ground, Radio::losing(percent, seed));
    let peer = Peer::start(python, proxy.near.port(), 1);
    let mission = mission(Autopilot::Px4, (0..items).map(waypoint).collect());
    let link = Link::UdpIn(ground.to_string());
    let report = upload(1, &link, &mission, false);
    if report.is_verified() {
        let got = peer.whole_list();
        let got: Vec<(i64, i64)> = got
            .as_array()
            .expect("a list")
            .iter()
            .map(|item| {
                (
                    item["x"].as_i64().expect("x"),
                    item["y"].as_i64().expect("y"),
                )
            })
            .collect();
        let sent = mission.items.iter();
        let sent: Vec<(i64, i64)> = sent.map(|i| (i.x.into(), i.y.into())).collect();
        assert_eq!(got, sent, "{percent} % loss, seed {seed}");
    }
    report
}

/// `SORTIE_UPLOADS=20` for the whole measurement: so many uploads of 60 items at 25 % loss.
#[test]
fn mavsdk_is_loaded_at_every_loss_up_to_25_percent_each_way() {
    let Some(python) = peers::python() else {
        return;
    };
    let uploads = std::env::var("SORTIE_UPLOADS").ok();
    let uploads: Option<u64> = uploads.and_then(|n| n.parse().ok());
    let items = if uploads.is_some() { 60 } else { 12 };
    let uploads = uploads.unwrap_or(3);
    let mut runs = vec![(0, 1), (5, 1), (15, 1)];
    runs.extend((1..=uploads).map(|seed| (25, seed)));
    // A few at a time: each waits for the radio, not for the processor.
    for some in runs.chunks(6) {
        std::thread::scope(|scope| {
            for &(percent, seed) in some {
                let python = &python;
                scope.spawn(move || {
                    let report = upload_to_mavsdk(python, items, percent, seed);
                    println!(
                        "{percent} % seed {seed}: {:?}, {:.1} s, {} starts, {} repeats",
                        report.verdict, report.seconds, report.attempts, report.retries
                    );
                    assert_eq!(report.verdict, Verdict::Verified, "{percent} %: {report:?}");
                });
            }
        });
    }
}

/// Both tools at one loss against one profile: what they believe is what is on board.
fn loaded_by_others(python: &Path, profile: Profile, tool: &str, percent: u32) {
    let vehicle = spawn(&Simulated::on_loopback(profile, 3, Some(HOME))).expect("a free port");
    let proxy = LossyProxy::to(vehicle.address(), Radio::losing(percent, 1));
    let port = proxy.near.port().to_string();
    let result = peers::run(python, "vehicle_ground_station.py", &[tool, &port, "12"]);
    let held = vehicle.items(MissionType::Mission);
    // ArduPilot has the first one, home, to itself.
    let first = i32::from(profile == Profile::ArduPilot);
    let whole: Vec<Item> = (first..12).map(waypoint).collect();
    let what = format!("{profile:?}, {tool}, {percent} %: {result}");
    if percent == 0 {
        assert!(result["error"].is_null(), "{what}");
    }
    if result["seconds"].is_number() {
        assert_eq!(held, whole, "told to be uploaded: {what}");
    } else if profile == Profile::Px4 {
        assert!(held.is_empty() || held == whole, "all or nothing: {what}");
    } else {
        assert!(whole.starts_with(&held), "a beginning of it: {what}");
    }
    if let Some(read) = result["items"].as_array() {
        assert_eq!(read.len(), 12, "{what}");
        for (n, item) in (0..).zip(read).skip(1) {
            let sent = waypoint(n);
            assert_eq!(
                (&item[1], &item[2]),
                (&sent.x.into(), &sent.y.into()),
                "{what}"
            );
        }
    }
}

#[test]
fn what_other_ground_stations_believe_to_be_on_board_is_on_board_at_any_loss() {
    let Some(python) = peers::python() else {
        return;
    };
    std::thread::scope(|scope| {
        for tool in ["mavsdk", "pymavlink"] {
            for percent in [0, 5, 15, 25] {
                for profile in [Profile::ArduPilot, Profile::Px4] {
                    let python = &python;
                    scope.spawn(move || loaded_by_others(python, profile, tool, percent));
                }
            }
        }
    });
}
