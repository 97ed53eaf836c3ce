//! A vehicle in flight takes a new mission while it comes to a waypoint of the one before.

use super::flight_truth::{sky, two};
use sortie::flight::{Diversion, Onward};
use sortie::geodesy::LatLon;
use sortie::link::{
    Address, Body, Command, FlightMessage, Heartbeat, Message, MissionMessage, MissionResult,
    Position, Time,
};
use sortie::mission::{Home, Item, VehicleMission, command, frame};
use sortie::spec::{Airframe, Autopilot};

const US: Address = Address {
    system: 255,
    component: 190,
};
const VEHICLE: Address = Address {
    system: 1,
    component: 1,
};

/// Armed, in AUTO.
const BEAT: Heartbeat = Heartbeat {
    kind: 2,
    autopilot: 3,
    base_mode: 0b1000_1001,
    custom_mode: 3,
    system_status: 4,
};

fn item(command: u16, lat: i32, lon: i32) -> Item {
    Item {
        command,
        frame: frame::GLOBAL,
        autocontinue: true,
        params: [0.0; 4],
        x: lat,
        y: lon,
        z: 460.0,
    }
}

/// A takeoff, a waypoint that the mission before had too, two new ones, and the landing.
fn mission() -> VehicleMission {
    let lat = 363_160_000;
    VehicleMission {
        autopilot: Autopilot::ArduPilot,
        autopilot_version: None,
        airframe: Airframe::Copter,
        home: Home {
            x: lat,
            y: -842_700_000,
            amsl_m: 400.0,
        },
        items: vec![
            item(command::NAV_TAKEOFF, lat, -842_700_000),
            item(command::NAV_WAYPOINT, lat, -842_650_000),
            item(command::NAV_WAYPOINT, lat + 20_000, -842_600_000),
            item(command::NAV_WAYPOINT, lat, -842_520_000),
            item(command::NAV_LAND, lat, -842_520_000),
        ],
        fence: Vec::new(),
        is_fence_known: true,
        rally: Vec::new(),
        params: Vec::new(),
        notes: Vec::new(),
    }
}

/// What it is ordered to fly to, once it has taken the mission ten metres before its waypoint and
/// says `current` of it.
fn ordered(current: &[(u16, u16)]) -> Option<f32> {
    let mission = mission();
    let onward = Onward {
        vehicle: "alpha",
        mission: &mission,
        origin: LatLon::new(36.316, -84.27).expect("a place"),
        ahead: 1,
        new: 2,
        held: (4, 0),
    };
    let mut now = Time(0);
    let mut diversion = Diversion::new(onward, (VEHICLE, BEAT), Vec::new(), US, now);
    let position = Position {
        boot_ms: 30_000,
        x: 363_160_000,
        y: -842_651_100,
        amsl_mm: 460_000,
        above_home_mm: 60_000,
        velocity_cmps: [0, 1500, 0],
    };
    let accepted = MissionMessage {
        target: US,
        mission_type: 0,
        body: Body::Ack {
            result: MissionResult::ACCEPTED,
            opaque_id: 0,
        },
    };
    let position = Message::Flight(FlightMessage::Position(position));
    diversion.handle(now, VEHICLE, &position);
    diversion.handle(now, VEHICLE, &Message::Mission(accepted));
    for (seq, total) in current.iter().copied() {
        let current = Message::MissionCurrent {
            seq,
            total,
            opaque_ids: [0; 3],
        };
        diversion.handle(now, VEHICLE, &current);
    }
    let mut ordered = None;
    for _ in 0..200 {
        now = now + 50;
        diversion.handle_timeout(now);
        while let Some(message) = diversion.poll_transmit(now) {
            if let Message::Flight(FlightMessage::Command { order, .. }) = message
                && order.command == Command::DO_SET_MISSION_CURRENT
            {
                ordered = ordered.or(Some(order.params[0]));
            }
        }
    }
    ordered
}

#[test]
fn who_flies_to_a_waypoint_of_both_missions_is_left_to_it() {
    assert_eq!(ordered(&[(2, 5)]), None);
    // What it said of the mission before came late.
    assert_eq!(ordered(&[(3, 4), (2, 5)]), None);
    assert_eq!(ordered(&[(2, 65535)]), None);
}

#[test]
fn who_has_left_the_last_common_waypoint_by_its_own_word_is_ordered_to_the_first_new_one() {
    assert_eq!(ordered(&[(3, 5)]), Some(3.0));
    assert_eq!(ordered(&[(2, 4), (3, 5)]), Some(3.0));
}

#[test]
fn who_does_not_say_where_it_flies_to_is_ordered_to_the_first_new_waypoint() {
    assert_eq!(ordered(&[]), Some(3.0));
    assert_eq!(ordered(&[(2, 4)]), Some(3.0));
}

#[test]
fn who_was_taken_over_while_its_new_mission_was_sent_is_not_on_it() {
    for is_taken in [false, true] {
        let plan = two();
        let mut sky = sky(&plan);
        sky.fly_to(20.0);
        let (mission, mut now) = (&plan.dispatched.missions[0].1, sky.now);
        let vehicle = &mut sky.vehicles[0];
        let onward = Onward {
            vehicle: "alpha",
            mission,
            origin: LatLon::of_e7(mission.home.x, mission.home.y),
            ahead: 1,
            new: mission.items.len(),
            held: (mission.items.len(), 0),
        };
        let mut diversion = Diversion::new(onward, (VEHICLE, BEAT), Vec::new(), US, now);
        let until = now + 60_000;
        while diversion.outcome().is_none() && now < until {
            now = now + 20;
            if is_taken && until - now == 59_900 {
                let order = Command::new(Command::NAV_LOITER_UNLIM, []);
                let target = VEHICLE;
                let order = Message::Flight(FlightMessage::Command { target, order });
                vehicle.handle(now, US, &order);
            }
            vehicle.handle_timeout(now);
            while let Some(message) = vehicle.poll_transmit() {
                diversion.handle(now, VEHICLE, &message);
            }
            diversion.handle_timeout(now);
            while let Some(message) = diversion.poll_transmit(now) {
                vehicle.handle(now, US, &message);
            }
        }
        let said = diversion.outcome().cloned().expect("an outcome");
        let why = said.err().unwrap_or_default();
        assert_eq!(why.contains("does not fly it: it is in"), is_taken, "{why}");
        assert_eq!(why.is_empty(), !is_taken, "{why}");
    }
}
