//! What was verified and changes before the end is not called verified: other ground stations,
//! restarts, and items that change after they were read.

use crate::mission_upload::{Event, PROFILES, Scene, VEHICLE, ack, holds, mission, say, vehicle};
use crate::support::{lossy_link, transfers};
use lossy_link::CLEAR;
use sortie::link::*;
use sortie::simulator::Profile;
use transfers::{STRANGER, US};

#[test]
fn a_fence_that_another_station_clears_unheard_is_found_at_the_end_and_put_back() {
    for profile in PROFILES {
        let mission = mission(profile, 20);
        let mut put_back = 0;
        for at in (40..2400).step_by(40) {
            let mut scene = Scene::new(11, CLEAR, vehicle(profile), &mission);
            scene.deaf = true;
            let clear = say(VEHICLE, MissionType::Fence, Body::ClearAll);
            scene.stranger.push((Time(at), STRANGER, clear));
            let report = scene.run();
            let ended = scene.ether.now;
            assert_eq!(
                report.verdict,
                Verdict::Verified,
                "{profile:?} {at} {report:?}"
            );
            // Nobody can know of what comes after the last look at the fence.
            let is_later = at + 400 > ended.0;
            let is_held = holds(&scene.vehicle, profile, &mission);
            assert!(is_held || is_later, "{profile:?} {at} {ended:?} {report:?}");
            put_back += u32::from(is_held && report.attempts > 3);
        }
        assert!(put_back > 0, "{profile:?}");
    }
}

#[test]
fn a_list_that_another_station_is_heard_to_change_is_changed_by_it_and_not_verified() {
    for profile in PROFILES {
        let mission = mission(profile, 20);
        let item = mission.items[1];
        let to_it = |body| (STRANGER, say(VEHICLE, MissionType::Fence, body));
        // One with our system id is another Sortie.
        let twin = Address {
            component: US.component - 1,
            ..US
        };
        let count = Body::Count {
            count: 4,
            opaque_id: 0,
        };
        let row = Body::ItemInt {
            seq: 1,
            current: 0,
            item,
        };
        let accepted = say(STRANGER, MissionType::Fence, ack(MissionResult::ACCEPTED));
        let heard = [
            to_it(Body::ClearAll),
            to_it(count),
            to_it(row),
            (VEHICLE, accepted),
            (twin, say(VEHICLE, MissionType::Fence, Body::ClearAll)),
            (
                VEHICLE,
                say(twin, MissionType::Fence, ack(MissionResult::ACCEPTED)),
            ),
        ];
        for (name, message) in heard {
            let mut scene = Scene::new(11, CLEAR, vehicle(profile), &mission);
            scene.stranger.push((Time(150), name, message.clone()));
            let report = scene.run();
            let Verdict::Failed(failure) = &report.verdict else {
                panic!("{profile:?} {message:?} {report:?}")
            };
            let system = match &message {
                Message::Mission(sent) if name == VEHICLE => sent.target.system,
                _ => name.system,
            };
            let text = format!(
                "fence: changed by system {system} during the transfer; upload again while no \
                 other station writes to the vehicle"
            );
            assert_eq!(failure.to_string(), text, "{profile:?} {message:?}");
            assert_eq!(report.hash, "");
        }
    }
}

#[test]
fn another_station_that_clears_everything_is_named_with_all_lists() {
    let mission = mission(Profile::Px4, 5);
    let mut scene = Scene::new(11, CLEAR, vehicle(Profile::Px4), &mission);
    let Message::Mission(clear) = say(VEHICLE, MissionType::Mission, Body::ClearAll) else {
        panic!("a message of the mission protocol")
    };
    let clear = MissionMessage {
        mission_type: MISSION_TYPE_ALL,
        ..clear
    };
    let clear = Message::Mission(clear);
    scene.stranger.push((Time(150), STRANGER, clear));
    let report = scene.run();
    let changed = Failure::ChangedBy {
        list: None,
        system: 255,
    };
    assert_eq!(report.verdict, Verdict::Failed(changed));
}

#[test]
fn a_list_that_another_station_reads_is_verified_all_the_same() {
    for profile in PROFILES {
        let mission = mission(profile, 20);
        let mut scene = Scene::new(11, CLEAR, vehicle(profile), &mission);
        let read = say(VEHICLE, MissionType::Rally, Body::RequestList);
        scene.stranger.push((Time(5), STRANGER, read));
        let report = scene.run();
        assert_eq!(report.verdict, Verdict::Verified, "{profile:?} {report:?}");
    }
}

#[test]
fn an_item_that_changes_after_it_was_read_is_found() {
    // PX4 gives its lists ids; the others are read again.
    for (profile, row) in [(Profile::ArduPilot, 3), (Profile::Generic, 2)] {
        let mission = mission(profile, 20);
        let mut scene = Scene::new(12, CLEAR, vehicle(profile), &mission);
        (scene.lifted, scene.lifted_after) = (Some(row), 1);
        let report = scene.run();
        let Verdict::Failed(Failure::Different { list, count, .. }) = report.verdict else {
            panic!("{profile:?} {report:?}")
        };
        assert_eq!((list, count), (MissionType::Mission, 1));
    }
}

#[test]
fn a_list_that_is_never_acknowledged_and_held_otherwise_is_given_up_before_its_deadline() {
    for profile in PROFILES {
        let mission = mission(profile, 20);
        let mut scene = Scene::new(12, CLEAR, vehicle(profile), &mission);
        scene.unacknowledged = true;
        scene.lifted = Some(3);
        let report = scene.run();
        let Verdict::Failed(failure) = &report.verdict else {
            panic!("{profile:?} {report:?}")
        };
        let text = "mission: all items were sent 6 times and never acknowledged, and the vehicle holds \
                    something else (differences: 1)";
        assert_eq!(failure.to_string(), text, "{profile:?}");
        assert!(report.seconds < 60.0, "{profile:?} {report:?}");
    }
}

#[test]
fn a_list_that_is_held_as_it_was_sent_needs_no_acknowledgement() {
    for profile in PROFILES {
        let mission = mission(profile, 20);
        let mut scene = Scene::new(12, CLEAR, vehicle(profile), &mission);
        scene.unacknowledged = true;
        let report = scene.run();
        assert_eq!(report.verdict, Verdict::Verified, "{profile:?} {report:?}");
    }
}

#[test]
fn a_list_that_changes_again_and_again_is_given_up() {
    let mission = mission(Profile::Px4, 20);
    let mut scene = Scene::new(11, CLEAR, vehicle(Profile::Px4), &mission);
    scene.deaf = true;
    for at in (50..60_000).step_by(50) {
        let clear = say(VEHICLE, MissionType::Rally, Body::ClearAll);
        scene.stranger.push((Time(at), STRANGER, clear));
    }
    let report = scene.run();
    let Verdict::Failed(failure) = &report.verdict else {
        panic!("{report:?}")
    };
    let text = failure.to_string();
    assert!(text.starts_with("rally: "), "{text}");
    assert!(report.seconds < 60.0, "{report:?}");
}

#[test]
fn a_vehicle_that_starts_again_without_its_lists_is_loaded_again() {
    for profile in PROFILES {
        let mission = mission(profile, 20);
        for at in (20..1400).step_by(60) {
            let mut scene = Scene::new(at, CLEAR, vehicle(profile), &mission);
            scene.event = Event::StartEmpty(Time(at), profile);
            let report = scene.run();
            let is_later = at + 300 > scene.ether.now.0 || scene.event != Event::Nothing;
            let is_held = holds(&scene.vehicle, profile, &mission);
            assert_eq!(
                report.verdict,
                Verdict::Verified,
                "{profile:?} {at} {report:?}"
            );
            assert!(is_held || is_later, "{profile:?} {at} {report:?}");
        }
    }
}

#[test]
fn a_companion_that_claims_to_be_the_autopilot_and_speaks_first_blocks_no_upload() {
    for profile in [Profile::ArduPilot, Profile::Px4] {
        let mission = mission(profile, 10);
        let mut scene = Scene::new(13, CLEAR, vehicle(profile), &mission);
        let companion = Address {
            component: 191,
            ..VEHICLE
        };
        let beat = Message::Heartbeat(Heartbeat {
            kind: 2,
            autopilot: mission.autopilot.conventions().mav_autopilot,
            base_mode: 0,
            custom_mode: 0,
            system_status: 4,
        });
        for at in (0..20).map(|n| 1000 * n) {
            scene.stranger.push((Time(at), companion, beat.clone()));
        }
        let report = scene.run();
        assert_eq!(report.verdict, Verdict::Verified, "{profile:?} {report:?}");
        assert!(holds(&scene.vehicle, profile, &mission), "{profile:?}");
        assert!(report.seconds < 5.0, "{profile:?} {report:?}");
    }
}
