//! A whole transfer to a simulated vehicle over a link that the input controls: what is
//! lost, doubled, overtaken or held up, when the vehicle starts again or is armed, what
//! strangers say. It ends, and success is reported only if the vehicle holds our items.
#![no_main]

use std::collections::BTreeMap;

use libfuzzer_sys::fuzz_target;
use sortie::link::{
    Address, Body, MissionType, Message, MissionMessage, MissionResult, Order, Session, Time, stored_form,
};
use sortie::mission::{Home, Item, VehicleMission, command, frame};
use sortie::spec::{Airframe, Autopilot};
use sortie::simulator::{Profile, Vehicle};

const US: Address = Address {
    system: 245,
    component: 190,
};
const STRANGER: Address = Address {
    system: 9,
    component: 1,
};
const HOME: Home = Home {
    x: 363_000_000,
    y: -842_500_000,
    amsl_m: 400.5,
};

struct Script<'a>(std::slice::Iter<'a, u8>);

impl Script<'_> {
    fn byte(&mut self) -> u8 {
        self.0.next().copied().unwrap_or(0)
    }
}

fn waypoint(n: u8) -> Item {
    Item {
        command: command::NAV_WAYPOINT,
        frame: frame::GLOBAL,
        autocontinue: true,
        params: [0.0; 4],
        x: HOME.x + 1000 * i32::from(n),
        y: HOME.y - 777 * i32::from(n),
        z: 480.25,
    }
}

fn mission(autopilot: Autopilot, items: u8, lists: u8, from: u8) -> VehicleMission {
    let list = |command, z, n: u8| -> Vec<Item> {
        let item = |k| Item {
            command,
            z,
            params: [f32::from(n), 0.0, 0.0, 0.0],
            ..waypoint(from.wrapping_add(k))
        };
        (0..n).map(item).collect()
    };
    VehicleMission {
        autopilot_version: None,
        autopilot,
        airframe: Airframe::Copter,
        home: HOME,
        items: (0..items).map(|n| waypoint(from.wrapping_add(n))).collect(),
        fence: list(command::NAV_FENCE_POLYGON_VERTEX_INCLUSION, 0.0, 3 * (lists & 1)),
        is_fence_known: true,
        rally: list(command::NAV_RALLY_POINT, 80.0, lists >> 1 & 1),
        params: Vec::new(),
        notes: Vec::new(),
    }
}

fn holds(vehicle: &Vehicle, profile: Profile, mission: &VehicleMission) -> bool {
    let lists = [
        (MissionType::Mission, &mission.items),
        (MissionType::Fence, &mission.fence),
        (MissionType::Rally, &mission.rally),
    ];
    lists.into_iter().all(|(list, items)| {
        let expected = items.iter().map(|item| match profile {
            Profile::ArduPilot => stored_form(Autopilot::ArduPilot, Airframe::Copter, list, item),
            Profile::Px4 => stored_form(Autopilot::Px4, Airframe::Copter, list, item),
            _ => *item,
        });
        vehicle.items(list).iter().copied().eq(expected)
    })
}

#[derive(Clone, Copy, PartialEq)]
enum To {
    Us,
    Vehicle,
}

/// Messages on their way.
#[derive(Default)]
struct Air {
    flying: BTreeMap<(Time, u64), (To, Address, Message)>,
    serial: u64,
}

impl Air {
    fn fly(&mut self, arrival: Time, to: To, from: Address, message: Message) {
        self.serial += 1;
        self.flying
            .insert((arrival, self.serial), (to, from, message));
    }

    /// The next byte decides what becomes of a message.
    fn send(
        &mut self,
        script: &mut Script<'_>,
        now: Time,
        to: To,
        from: Address,
        message: Message,
    ) {
        let fate = script.byte();
        let soon = now + 2 + u64::from(fate % 32);
        match fate {
            0..=159 => self.fly(soon, to, from, message),
            160..=207 => {}
            208..=231 => {
                self.fly(soon, to, from, message.clone());
                let later = soon + u64::from(script.byte()) * 8;
                self.fly(later, to, from, message);
            }
            _ => {
                let later = now + u64::from(script.byte()) * 40;
                self.fly(later, to, from, message);
            }
        }
    }
}

/// Something that somebody else says, to us or to others.
fn gossip(script: &mut Script<'_>, vehicle: Address) -> (Address, Message) {
    let list = MissionType::ALL[usize::from(script.byte() % 3)];
    let seq = u16::from(script.byte() % 16);
    let body = match script.byte() % 5 {
        0 => Body::Request { seq },
        1 => Body::Ack {
            result: MissionResult(script.byte() % 18),
            opaque_id: 0,
        },
        2 => Body::Count {
            count: seq,
            opaque_id: 7,
        },
        3 => Body::ItemInt {
            seq,
            current: 0,
            item: waypoint(200),
        },
        _ => Body::RequestInt { seq },
    };
    // The vehicle speaks to a stranger, or a stranger to us.
    let (from, target) = if script.byte() & 1 == 0 {
        (vehicle, STRANGER)
    } else {
        (STRANGER, US)
    };
    let mission = MissionMessage {
        target,
        mission_type: list.mission_type(),
        body,
    };
    (from, Message::Mission(mission))
}

fuzz_target!(|data: &[u8]| {
    let mut script = Script(data.iter());
    let (profile, autopilot) = match script.byte() % 3 {
        0 => (Profile::ArduPilot, Autopilot::ArduPilot),
        1 => (Profile::Px4, Autopilot::Px4),
        _ => (Profile::Generic, Autopilot::Px4),
    };
    let mut vehicle = Vehicle::new(profile, 1, Some(HOME), Time(0));
    // What was on board before goes over a perfect link.
    let before = mission(autopilot, script.byte() % 12, script.byte(), 100);
    let mut ours = mission(autopilot, script.byte() % 12, script.byte(), 0);
    if let (0, Some(item)) = (script.byte() % 16, ours.items.last_mut()) {
        item.command = 60_000;
    }
    let mut now = Time(0);
    for (mission, perfect) in [(&before, true), (&ours, false)] {
        let order = Order {
            vehicle: "alpha",
            sysid: 1,
            mission,
            force: false,
            others: Vec::new(),
        };
        let mut session = Session::new(order, US, now);
        let mut air = Air::default();
        let began = now;
        let mut nothing = Script([].iter());
        let script = if perfect { &mut nothing } else { &mut script };
        let report = loop {
            while let Some(first) = air
                .flying
                .first_entry()
                .filter(|first| first.key().0 <= now)
            {
                match first.remove() {
                    (To::Us, from, message) => session.handle(now, from, &message),
                    (To::Vehicle, from, message) => vehicle.handle(now, from, &message),
                }
            }
            session.handle_timeout(now);
            vehicle.handle_timeout(now);
            while let Some(message) = session.poll_transmit() {
                air.send(script, now, To::Vehicle, US, message);
            }
            while let Some(message) = vehicle.poll_transmit() {
                air.send(script, now, To::Us, vehicle.address(), message);
            }
            if let Some(report) = session.report() {
                break report.clone();
            }
            if script.0.len() > 0 {
                match script.byte() {
                    250 => vehicle.reboot(now),
                    251 => vehicle.set_armed(true),
                    252..=255 => {
                        let (from, message) = gossip(script, vehicle.address());
                        air.fly(now + 1, To::Us, from, message);
                    }
                    _ => {}
                }
            }
            let next = air.flying.keys().next().map(|(arrival, _)| *arrival);
            let due = [session.poll_timeout(), next].into_iter().flatten();
            let due = due.fold(vehicle.poll_timeout(), Time::min);
            now = due.max(now + 1);
            assert!(now - began < 1_000_000, "the session never ends");
        };
        assert!(
            !report.is_verified() || holds(&vehicle, profile, mission),
            "{profile:?} {report:?}"
        );
    }
});
