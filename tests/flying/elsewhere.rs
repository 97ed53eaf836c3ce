//! A return is ordered only to where it was judged to lead.

use std::cell::Cell;
use std::rc::Rc;

use super::flight_truth::{count, sky};
use crate::support::sky::{Planned, Sky, US, lane, parameters, plan};
use sortie::flight::Outcome;
use sortie::geodesy::Amsl;
use sortie::link::*;
use sortie::simulator::Fault;
use sortie::spec::{Action, Answer, OnLinkLoss, Who};

fn returning() -> Planned {
    let mut fleet = vec![lane("alpha", 1, 36.300), lane("bravo", 2, 36.308)];
    fleet[0].return_amsl = Some(Amsl(520.0));
    let mut plan = plan(fleet, OnLinkLoss::Continue);
    let (who, action) = (Who::Vehicle, Action::Return);
    plan.spec.on_alarm.battery = Some(Answer { who, action });
    plan
}

/// From 40 s on this happens to the messages of alpha; its battery is empty at 60 s.
fn ordered(plan: &Planned, change: impl Fn(&mut Message) -> Option<Message> + 'static) -> Sky<'_> {
    let mut sky = sky(plan);
    sky.fly_to(40.0);
    sky.down = Some(Box::new(move |_, from, mut message| {
        let more = match from.system {
            1 => change(&mut message),
            _ => None,
        };
        let all = more.into_iter().chain([message]);
        all.map(|message| (from, message)).collect()
    }));
    sky.fly_to(60.0);
    sky.vehicles[0].fail(Fault::BatteryDrain { percent_s: 80.0 });
    sky.fly_to(66.0);
    sky
}

/// The acknowledgement of a list that system 254 has written.
pub(super) fn acknowledged_to_another(mission_type: u8) -> Message {
    let (system, component) = (254, 190);
    acknowledged_to(Address { system, component }, mission_type)
}

fn acknowledged_to(target: Address, mission_type: u8) -> Message {
    let body = Body::Ack {
        result: MissionResult::ACCEPTED,
        opaque_id: 0,
    };
    Message::Mission(MissionMessage {
        target,
        mission_type,
        body,
    })
}

#[test]
fn a_return_is_not_ordered_where_home_was_moved_in_flight() {
    let plan = returning();
    // By 5 m, and by 110 m.
    for (by, alarms) in [(450, 0), (10_000, 1)] {
        let sky = ordered(&plan, move |message| {
            if let Message::HomePosition { x, .. } = message {
                *x += by;
            }
            None
        });
        let moved = count(&sky, "alpha", "ALARM mission: its home was moved by");
        assert_eq!(moved, alarms, "{:?}", sky.events);
        let returns = count(&sky, "alpha", "is ordered to return");
        assert_eq!(returns, 1 - alarms, "{:?}", sky.events);
        let why = "does not return, it continues: its home was moved by";
        assert_eq!(count(&sky, "alpha", why), alarms, "{:?}", sky.events);
    }
}

/// ArduPlane has its home where it stands without its motors: it says so before the heartbeat that shows them to stand.
#[test]
fn a_home_that_comes_with_a_vehicle_to_its_landing_is_no_alarm() {
    let plan = returning();
    let mut sky = sky(&plan);
    sky.fly_to(40.0);
    let (at, is_said) = (Cell::new((0, 0, 0)), Cell::new(false));
    sky.down = Some(Box::new(move |_, from, message| {
        let (x, y, amsl_mm) = at.get();
        let here = Message::HomePosition { x, y, amsl_mm };
        let message = match message {
            _ if from.system != 1 => message,
            Message::Flight(FlightMessage::Position(position)) => {
                at.set((position.x, position.y, position.amsl_mm));
                message
            }
            // The heartbeat that shows it comes a second later.
            Message::Heartbeat(beat) if !beat.is_armed() && !is_said.replace(true) => here,
            Message::HomePosition { .. } if is_said.get() => here,
            _ => message,
        };
        vec![(from, message)]
    }));
    assert_eq!(sky.fly_out(), Outcome::Flown);
    assert_eq!(count(&sky, "alpha", "ALARM"), 0, "{:?}", sky.events);
    let landed = count(&sky, "alpha", "landed, motors stopped");
    assert_eq!(landed, 1, "{:?}", sky.events);
}

#[test]
fn rally_points_or_a_fence_that_another_station_is_heard_to_write_are_an_alarm() {
    let plan = returning();
    // One is another Sortie, which has our system id and another component id.
    let station = |system, component| Address { system, component };
    let cases = [
        (station(254, 190), 2, "rally points", 0),
        (station(254, 190), 1, "fence", 1),
        (station(US.system, US.component - 1), 2, "rally points", 0),
    ];
    for (station, mission_type, what, returns) in cases {
        let sky = ordered(&plan, move |message| {
            let is_beat = matches!(message, Message::Heartbeat(_));
            is_beat.then(|| acknowledged_to(station, mission_type))
        });
        let system = station.system;
        let text = format!(
            "ALARM mission: acknowledged {what}, or that they were cleared, to system {system}"
        );
        assert_eq!(count(&sky, "alpha", &text), 1, "{:?}", sky.events);
        let ordered = count(&sky, "alpha", "is ordered to return");
        assert_eq!(ordered, returns, "{:?}", sky.events);
    }
}

#[test]
fn another_id_of_the_rally_points_on_board_is_an_alarm_and_no_return_is_ordered() {
    let plan = returning();
    let mut sky = sky(&plan);
    let is_changed = Rc::new(Cell::new(false));
    let changed = Rc::clone(&is_changed);
    sky.down = Some(Box::new(move |_, from, mut message| {
        if let Message::MissionCurrent { opaque_ids, .. } = &mut message {
            // First there are none.
            *opaque_ids = [5, 6, if changed.get() { 77 } else { 0 }];
        }
        vec![(from, message)]
    }));
    sky.fly_to(40.0);
    assert_eq!(count(&sky, "alpha", "ALARM"), 0, "{:?}", sky.events);
    is_changed.set(true);
    sky.fly_to(60.0);
    sky.vehicles[0].fail(Fault::BatteryDrain { percent_s: 80.0 });
    sky.fly_to(66.0);
    let text = "ALARM mission: the rally points on board are others (their id changed)";
    assert_eq!(count(&sky, "alpha", text), 1, "{:?}", sky.events);
    let ordered = count(&sky, "alpha", "is ordered to return");
    assert_eq!(ordered, 0, "{:?}", sky.events);
}

/// A ground station sets a parameter of alpha 40 s after T0, and sets it back after 30 s if it `mends` it. Then its
/// battery is empty.
fn set_in_flight<'a>(plan: &'a Planned, name: &str, value: f32, mends: bool) -> Sky<'a> {
    let planned = parameters(&plan.dispatched.missions[0].1);
    let planned = planned.iter().find(|of| of.0 == name).expect("a parameter");
    let mut sky = sky(plan);
    sky.fly_to(40.0);
    let set = |sky: &mut Sky<'_>, value: f32| {
        let set = Message::Flight(FlightMessage::ParamSet {
            target: sky.vehicles[0].address(),
            name: name.to_owned(),
            value: ParamValue::float(value),
        });
        let (system, component) = (255, 190);
        let now = sky.now;
        sky.vehicles[0].handle(now, Address { system, component }, &set);
    };
    set(&mut sky, value);
    sky.fly_to(50.0);
    if mends {
        set(&mut sky, planned.1);
    }
    sky.fly_to(60.0);
    sky.vehicles[0].fail(Fault::BatteryDrain { percent_s: 80.0 });
    sky.fly_to(66.0);
    let text = format!(
        "ALARM mission: says that {name} is {value}, planned {}",
        planned.1
    );
    assert_eq!(count(&sky, "alpha", &text), 1, "{:?}", sky.events);
    sky
}

#[test]
fn a_parameter_that_is_set_in_flight_is_an_alarm_and_one_of_the_return_prevents_it() {
    let plan = returning();
    for (name, value, mends, returns) in [
        ("RTL_ALT", 1500.0, false, 0),
        ("RTL_ALT", 1500.0, true, 1),
        ("WPNAV_SPEED", 500.0, false, 1),
    ] {
        let sky = set_in_flight(&plan, name, value, mends);
        let ordered = count(&sky, "alpha", "is ordered to return");
        assert_eq!(ordered, returns, "{:?}", sky.events);
        let why = "how it would return is not known";
        assert_eq!(count(&sky, "alpha", why), 1 - returns, "{:?}", sky.events);
        let over = count(&sky, "alpha", "mission alarm: over after");
        assert_eq!(over, usize::from(mends), "{:?}", sky.events);
    }
}

#[test]
fn an_old_value_of_a_parameter_that_comes_late_is_no_alarm() {
    let plan = returning();
    let is_said = Cell::new(false);
    let sky = ordered(&plan, move |message| {
        let is_first = matches!(message, Message::Heartbeat(_)) && !is_said.replace(true);
        is_first.then(|| {
            Message::Flight(FlightMessage::Param {
                name: "RTL_ALT".to_owned(),
                value: ParamValue::float(1500.0),
            })
        })
    });
    assert_eq!(count(&sky, "alpha", "ALARM mission"), 0, "{:?}", sky.events);
    let ordered = count(&sky, "alpha", "is ordered to return");
    assert_eq!(ordered, 1, "{:?}", sky.events);
}
