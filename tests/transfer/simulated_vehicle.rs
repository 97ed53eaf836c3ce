//! The simulated vehicles do what real autopilots were measured to do: ArduCopter 4.6.3
//! and PX4 1.18 in software-in-the-loop simulation, November 2026.

use crate::support::transfers;
use sortie::link::*;
use sortie::mission::{Item, command, frame};
use sortie::simulator::{Profile, Vehicle};
use transfers::{HOME, STRANGER as OTHER, US};

fn waypoint(n: u16) -> Item {
    Item {
        frame: frame::GLOBAL_RELATIVE_ALT,
        x: HOME.x + i32::from(n),
        y: HOME.y - i32::from(n),
        z: 80.0,
        ..transfers::waypoint(0)
    }
}

/// A vehicle and what it answers, in short.
struct Bench {
    vehicle: Vehicle,
    now: Time,
}

impl Bench {
    fn new(profile: Profile) -> Self {
        let mut bench = Self {
            vehicle: Vehicle::new(profile, 1, Some(HOME), Time(0)),
            now: Time(0),
        };
        bench.wait(0);
        bench
    }

    fn said(&mut self) -> Vec<String> {
        std::iter::from_fn(|| self.vehicle.poll_transmit())
            .filter_map(|message| match message {
                Message::Mission(mission) => Some(match mission.body {
                    Body::Request { seq } => format!("request {seq}"),
                    Body::RequestInt { seq } => format!("request_int {seq}"),
                    Body::Ack { result, .. } => format!("{result}"),
                    Body::Count { count, .. } => format!("count {count}"),
                    Body::ItemInt { seq, .. } => format!("item_int {seq}"),
                    Body::Item { seq, .. } => format!("item {seq}"),
                    other => format!("{other:?}"),
                }),
                Message::StatusText { text, .. } => Some(text),
                Message::Heartbeat(_)
                | Message::MissionCurrent { .. }
                | Message::HomePosition { .. }
                | Message::AutopilotVersion { .. }
                | Message::TextChunk(_)
                | Message::Flight(_) => None,
            })
            .collect()
    }

    fn hear_from(&mut self, from: Address, list: MissionType, body: Body) -> Vec<String> {
        let message = Message::Mission(MissionMessage {
            target: self.vehicle.address(),
            mission_type: list.mission_type(),
            body,
        });
        self.vehicle.handle(self.now, from, &message);
        self.said()
    }

    fn hear(&mut self, body: Body) -> Vec<String> {
        self.hear_from(US, MissionType::Mission, body)
    }

    fn count(&mut self, count: u16) -> Vec<String> {
        let opaque_id = 0;
        self.hear(Body::Count { count, opaque_id })
    }

    fn item(&mut self, seq: u16, item: Item) -> Vec<String> {
        let current = 0;
        self.hear(Body::ItemInt { seq, current, item })
    }

    fn wait(&mut self, ms: u64) -> Vec<String> {
        let until = self.now + ms;
        let mut said = Vec::new();
        while self.vehicle.poll_timeout() <= until {
            self.now = self.vehicle.poll_timeout().max(self.now);
            self.vehicle.handle_timeout(self.now);
            said.extend(self.said());
        }
        self.now = until;
        said
    }

    /// Uploads waypoints; ArduPilot's first row is for its home.
    fn load(&mut self, rows: u16) -> Vec<String> {
        let mut said = self.count(rows);
        for seq in 0..rows {
            said = self.item(seq, waypoint(seq));
        }
        said
    }
}

#[test]
fn ardupilot_asks_with_the_old_request_and_px4_with_the_new_one() {
    assert_eq!(Bench::new(Profile::ArduPilot).count(3), ["request 0"]);
    assert_eq!(Bench::new(Profile::Px4).count(3), ["request_int 0"]);
}

#[test]
fn ardupilot_asks_every_second_and_cancels_after_eight() {
    let mut bench = Bench::new(Profile::ArduPilot);
    bench.count(3);
    assert_eq!(bench.wait(7500), ["request 0"; 7]);
    assert_eq!(
        bench.wait(1000),
        ["Mission upload timeout", "OPERATION_CANCELLED"]
    );
    assert_eq!(bench.wait(9000), [""; 0]);
}

#[test]
fn px4_asks_every_270_ms_and_gives_up_after_five_seconds_without_an_ack() {
    let mut bench = Bench::new(Profile::Px4);
    assert_eq!(bench.load(4), ["ACCEPTED"]);
    bench.count(9);
    assert_eq!(bench.wait(1000), ["request_int 0"; 3]);
    assert_eq!(
        bench.wait(4500).last().map(String::as_str),
        Some("Operation timeout")
    );
    assert_eq!(
        bench.vehicle.items(MissionType::Mission).len(),
        4,
        "the old mission stays"
    );
}

#[test]
fn ardupilot_is_not_atomic_a_count_alone_cuts_the_mission() {
    let mut bench = Bench::new(Profile::ArduPilot);
    assert_eq!(bench.load(10), ["ACCEPTED"]);
    bench.count(5);
    bench.wait(20_000);
    assert_eq!(
        bench.vehicle.items(MissionType::Mission).len(),
        4,
        "five rows with home"
    );
    // A refused item leaves a mix.
    bench.count(5);
    bench.item(0, waypoint(0));
    bench.item(1, waypoint(101));
    let strange = Item {
        command: 60_000,
        ..waypoint(2)
    };
    assert_eq!(bench.item(2, strange), ["UNSUPPORTED"]);
    let places: Vec<i32> = bench
        .vehicle
        .items(MissionType::Mission)
        .iter()
        .map(|i| i.x - HOME.x)
        .collect();
    assert_eq!(places, [101, 2, 3, 4]);
}

#[test]
fn ardupilot_answers_duplicates_late_items_and_other_ground_stations_as_measured() {
    let mut bench = Bench::new(Profile::ArduPilot);
    bench.count(2);
    assert_eq!(bench.item(0, waypoint(0)), ["request 1"]);
    assert_eq!(bench.item(0, waypoint(0)), ["INVALID_SEQUENCE"]);
    let count = Body::Count {
        count: 7,
        opaque_id: 0,
    };
    assert_eq!(
        bench.hear_from(OTHER, MissionType::Mission, count),
        ["DENIED"]
    );
    assert_eq!(bench.hear(Body::RequestList), ["DENIED"]);
    let cancel = Body::Ack {
        result: MissionResult::OPERATION_CANCELLED,
        opaque_id: 0,
    };
    assert_eq!(bench.hear(cancel), [""; 0], "ignored");
    assert_eq!(bench.item(1, waypoint(1)), ["ACCEPTED"]);
    assert_eq!(
        bench.item(1, waypoint(1)),
        ["ERROR"],
        "although all is on board"
    );
    assert_eq!(bench.count(2), ["request 0"]);
    bench.item(0, waypoint(0));
    assert_eq!(
        bench.count(2),
        ["request 0"],
        "the same ground station starts over"
    );
}

#[test]
fn px4_answers_duplicates_late_items_and_a_second_count_as_measured() {
    let mut bench = Bench::new(Profile::Px4);
    bench.count(3);
    assert_eq!(bench.count(3), ["request_int 0"]);
    assert_eq!(bench.item(0, waypoint(0)), ["request_int 1"]);
    assert_eq!(bench.item(0, waypoint(0)), ["request_int 1"]);
    assert_eq!(bench.item(2, waypoint(2)), [""; 0]);
    assert_eq!(bench.count(3), ["ERROR"]);
    bench.item(1, waypoint(1));
    assert_eq!(bench.item(2, waypoint(2)), ["ACCEPTED"]);
    assert_eq!(bench.item(2, waypoint(2)), ["ACCEPTED"], "confirmed again");
    let terrain = Item {
        frame: 11,
        ..waypoint(0)
    };
    bench.count(1);
    assert_eq!(bench.item(0, terrain), ["UNSUPPORTED_FRAME"]);
}

#[test]
fn a_generic_one_waits_anew_after_any_item() {
    let mut bench = Bench::new(Profile::Generic);
    bench.count(3);
    assert_eq!(bench.item(0, waypoint(0)), ["request_int 1"]);
    for _ in 0..10 {
        assert_eq!(bench.wait(400), [""; 0]);
        assert_eq!(bench.item(0, waypoint(0)), [""; 0]);
    }
    assert_eq!(bench.wait(500), ["request_int 1"]);
}

#[test]
fn each_refuses_what_it_refuses() {
    let refused = |profile, item: Item| {
        let mut bench = Bench::new(profile);
        bench.count(2);
        bench.item(0, waypoint(0));
        bench.item(1, item).concat()
    };
    let param = |n: usize| {
        let mut params = [0.0; 4];
        params[n] = f32::NAN;
        Item {
            params,
            ..waypoint(1)
        }
    };
    let z = |z| Item { z, ..waypoint(1) };
    let x = Item {
        x: 950_000_000,
        ..waypoint(1)
    };
    let speed_in_frame_3 = Item {
        command: command::DO_CHANGE_SPEED,
        ..waypoint(1)
    };
    for (item, ardupilot, px4) in [
        (param(0), "INVALID_PARAM1", "ACCEPTED"),
        (param(3), "ACCEPTED", "ACCEPTED"),
        (z(f32::NAN), "INVALID_PARAM7", "ACCEPTED"),
        (z(83_000.0), "INVALID_PARAM7", "ACCEPTED"),
        (x, "INVALID_PARAM5_X", "ACCEPTED"),
        (
            Item {
                frame: 1,
                ..waypoint(1)
            },
            "UNSUPPORTED_FRAME",
            "UNSUPPORTED_FRAME",
        ),
        (
            Item {
                command: 60_000,
                ..waypoint(1)
            },
            "UNSUPPORTED",
            "UNSUPPORTED",
        ),
        (speed_in_frame_3, "ACCEPTED", "UNSUPPORTED"),
    ] {
        assert_eq!(refused(Profile::ArduPilot, item), ardupilot, "{item:?}");
        assert_eq!(refused(Profile::Px4, item), px4, "{item:?}");
    }
}

#[test]
fn an_inconsistent_fence_leaves_the_old_one_on_ardupilot() {
    let mut bench = Bench::new(Profile::ArduPilot);
    let corner = |n, corners| Item {
        command: command::NAV_FENCE_POLYGON_VERTEX_INCLUSION,
        params: [corners, 0.0, 0.0, 0.0],
        ..waypoint(n)
    };
    let mut load = |corners: f32| {
        let count = Body::Count {
            count: 3,
            opaque_id: 0,
        };
        bench.hear_from(US, MissionType::Fence, count);
        let mut said = Vec::new();
        for seq in 0..3 {
            let (current, item) = (0, corner(seq, corners));
            said = bench.hear_from(US, MissionType::Fence, Body::ItemInt { seq, current, item });
        }
        (said, bench.vehicle.items(MissionType::Fence).len())
    };
    assert_eq!(load(3.0), (vec!["ACCEPTED".to_owned()], 3));
    assert_eq!(load(4.0), (vec!["ERROR".to_owned()], 3));
}

#[test]
fn capacities_and_clearing_are_as_measured() {
    let mut copter = Bench::new(Profile::ArduPilot);
    assert_eq!(copter.load(5), ["ACCEPTED"]);
    assert_eq!(copter.count(651), ["NO_SPACE"]);
    assert_eq!(
        copter.vehicle.items(MissionType::Mission).len(),
        4,
        "the old plan is kept"
    );
    assert_eq!(copter.hear(Body::ClearAll), ["ACCEPTED"]);
    assert_eq!(copter.hear(Body::RequestList), ["count 0"]);
    let everything = |bench: &mut Bench| {
        let message = Message::Mission(MissionMessage {
            target: bench.vehicle.address(),
            mission_type: MISSION_TYPE_ALL,
            body: Body::ClearAll,
        });
        bench.vehicle.handle(bench.now, US, &message);
        bench.said()
    };
    assert_eq!(everything(&mut copter), ["UNSUPPORTED"]);
    assert_eq!(everything(&mut Bench::new(Profile::Px4)), ["ACCEPTED"]);
    assert_eq!(Bench::new(Profile::Px4).count(9999), ["request_int 0"]);
}

#[test]
fn ardupilot_gives_its_own_home_as_item_0_and_both_kinds_of_item() {
    let mut bench = Bench::new(Profile::ArduPilot);
    bench.load(3);
    assert_eq!(bench.hear(Body::RequestList), ["count 3"]);
    assert_eq!(bench.hear(Body::Request { seq: 1 }), ["item 1"]);
    let message = Message::Mission(MissionMessage {
        target: bench.vehicle.address(),
        mission_type: 0,
        body: Body::RequestInt { seq: 0 },
    });
    bench.vehicle.handle(bench.now, US, &message);
    let Some(Message::Mission(MissionMessage {
        body: Body::ItemInt { item, .. },
        ..
    })) = bench.vehicle.poll_transmit()
    else {
        panic!("no item");
    };
    assert_eq!((item.x, item.y), (HOME.x, HOME.y));
    assert_eq!((item.frame, item.z.to_bits()), (0, HOME.amsl_m.to_bits()));
}

#[test]
fn messages_for_another_system_are_not_answered() {
    let mut bench = Bench::new(Profile::ArduPilot);
    for (system, component, answers) in [(1, 0, 1), (1, 1, 1), (1, 190, 1), (2, 1, 0)] {
        let message = Message::Mission(MissionMessage {
            target: Address { system, component },
            mission_type: 0,
            body: Body::RequestList,
        });
        bench.vehicle.handle(bench.now, US, &message);
        assert_eq!(bench.said().len(), answers, "{system}/{component}");
    }
}
