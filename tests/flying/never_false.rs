//! Lines, alarms and verdicts that were false, or did not come.
#![allow(clippy::cast_possible_truncation)]

use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::rc::Rc;

use super::flight_truth::{ARMED, change, count, sky, two};
use crate::support::sky::{Planned, Sky, parameters, plan_shipped};
use sortie::flight::*;
use sortie::link::*;
use sortie::verify::{Flown, Limit};

/// Another ground station.
const OTHER: Address = Address {
    system: 255,
    component: 190,
};

/// The messages of alpha come later by what this says of the time at which they are sent, in their order.
fn late(sky: &mut Sky<'_>, late_ms: impl Fn(Time) -> u64 + 'static) {
    let waiting = RefCell::new(VecDeque::new());
    sky.down = Some(Box::new(move |now, from, message| {
        if from.system != 1 {
            return vec![(from, message)];
        }
        let mut waiting = waiting.borrow_mut();
        waiting.push_back((now + late_ms(now), from, message));
        let due = waiting.iter().take_while(|(at, ..)| *at <= now).count();
        let due = waiting.drain(..due);
        due.map(|(_, from, message)| (from, message)).collect()
    }));
}

#[test]
fn a_link_that_gets_slower_makes_no_time_without_a_position() {
    let plan = two();
    let mut sky = sky(&plan);
    sky.fly_to(20.0);
    let began = sky.now;
    late(&mut sky, move |now| ((now - began) / 10).min(9000));
    assert_eq!(sky.fly_out(), Outcome::Flown);
    let report = plan.judge(&sky);
    let gap = Limit::Flown(Flown::Gap);
    let gaps = report.margins.iter().filter(|m| m.limit == gap && !m.ok);
    assert_eq!(
        gaps.collect::<Vec<_>>(),
        Vec::<&sortie::verify::Margin>::new()
    );
    let stale = count(&sky, "alpha", "no position for");
    assert_eq!(stale, 0, "{:?}", sky.events);
}

/// Found in noisy flights: a plane was said to skip a waypoint when the message with its row came after it had passed it.
#[test]
fn a_row_that_is_said_after_its_waypoint_was_passed_is_no_skip() {
    let plan = plan_shipped("plane-px4", |spec| spec.planner.evaluations = 6000);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    let sent = RefCell::new(VecDeque::new());
    sky.down = Some(Box::new(move |now, from, message| {
        let mut heard = vec![(from, message.clone())];
        if let Message::MissionCurrent { .. } = &message {
            heard.clear();
            sent.borrow_mut().push_back((now + 2500, message));
        }
        let mut sent = sent.borrow_mut();
        while sent.front().is_some_and(|(due, _)| *due <= now) {
            heard.extend(sent.pop_front().map(|(_, message)| (from, message)));
        }
        heard
    }));
    assert_eq!(sky.fly_out(), Outcome::Flown);
    assert_eq!(count(&sky, "gannet", "skips"), 0, "{:?}", sky.events);
}

/// Found over hostile sockets: each acknowledgement put the alarm off by another second and a half, until the landing.
#[test]
fn a_station_that_writes_again_and_again_is_an_alarm_as_if_it_wrote_once() {
    let plan = two();
    let mut sky = sky(&plan);
    sky.fly_to(45.0);
    sky.down = Some(Box::new(|_, from, message| {
        let written = Message::Mission(MissionMessage {
            target: OTHER,
            mission_type: 0,
            body: Body::Ack {
                result: MissionResult::ACCEPTED,
                opaque_id: 0,
            },
        });
        let is_beat = from.system == 1 && matches!(message, Message::Heartbeat(_));
        let mut heard = vec![(from, message)];
        heard.extend(is_beat.then_some((from, written)));
        heard
    }));
    sky.fly_to(49.0);
    let text = "ALARM mission: acknowledged a mission, or that it was cleared, to system 255";
    assert_eq!(count(&sky, "alpha", text), 1, "{:?}", sky.events);
}

#[test]
fn an_emergency_that_the_heartbeat_shows_is_an_alarm_in_the_words_of_mavlink() {
    let plan = two();
    for (state, word) in [
        (5, "MAV_STATE_CRITICAL"),
        (6, "MAV_STATE_EMERGENCY"),
        (7, "MAV_STATE_POWEROFF"),
        (8, "MAV_STATE_FLIGHT_TERMINATION"),
    ] {
        let mut sky = sky(&plan);
        let switch = change(&mut sky, move |_, message| {
            if let Message::Heartbeat(beat) = message {
                beat.system_status = state;
            }
        });
        sky.fly_to(40.0);
        switch.set(true);
        sky.fly_to(43.0);
        let text = format!("ALARM text: its heartbeat says {word}: ");
        assert_eq!(count(&sky, "alpha", &text), 1, "{word}: {:?}", sky.events);
        switch.set(false);
        sky.fly_to(50.0);
        let over = count(&sky, "alpha", "text alarm: over after");
        assert_eq!(over, 1, "{word}: {:?}", sky.events);
    }
}

#[test]
fn a_mode_that_flaps_is_named_with_a_count_and_not_in_each_line() {
    let plan = two();
    let mut sky = sky(&plan);
    sky.fly_to(40.0);
    let (beat, number) = (Cell::new(None), Cell::new(0_u32));
    sky.down = Some(Box::new(move |_, from, message| {
        let mut heard = vec![(from, message.clone())];
        match message {
            Message::Heartbeat(of) if from.system == 1 => beat.set(Some(of)),
            Message::Flight(FlightMessage::Position(_)) if from.system == 1 => {
                for _ in 0..2 {
                    number.set(number.get() + 1);
                    // AUTO, GUIDED, LOITER, CIRCLE.
                    let custom_mode = [3, 4, 5, 7][number.get() as usize % 4];
                    let flaps = beat.get().map(|of| Heartbeat { custom_mode, ..of });
                    heard.extend(flaps.map(|of| (from, Message::Heartbeat(of))));
                }
            }
            _ => {}
        }
        heard
    }));
    sky.fly_to(80.0);
    let lines = count(&sky, "alpha", "");
    assert!(lines <= 80, "{lines} lines in 40 s: {:?}", sky.events);
    let counted = count(&sky, "alpha", "more changes of its mode");
    assert!((2..=5).contains(&counted), "{counted}: {:?}", sky.events);
}

#[test]
fn a_pre_arm_text_after_the_landing_is_no_alarm() {
    let plan = two();
    let mut sky = sky(&plan);
    sky.fly_to(20.0);
    let was_armed = Cell::new(true);
    sky.down = Some(Box::new(move |_, from, message| {
        let mut heard = Vec::new();
        if let Message::Heartbeat(beat) = message
            && from.system == 1
        {
            if was_armed.get() && beat.base_mode & ARMED == 0 {
                let text = "PreArm: Battery 1 below minimum arming voltage".to_owned();
                heard.push((from, Message::StatusText { severity: 2, text }));
            }
            was_armed.set(beat.base_mode & ARMED != 0);
        }
        heard.push((from, message));
        heard
    }));
    assert_eq!(sky.fly_out(), Outcome::Flown);
    assert_eq!(count(&sky, "alpha", "ALARM"), 0, "{:?}", sky.events);
    assert_eq!(
        count(&sky, "alpha", "says: PreArm: Battery"),
        1,
        "{:?}",
        sky.events
    );
}

fn not_started(sky: &mut Sky<'_>) -> Vec<(String, String)> {
    while sky.fleet.outcome().is_none() {
        sky.step();
        assert!(sky.fleet.t_s(sky.now).is_none(), "{:?}", sky.events);
    }
    match sky.fleet.outcome() {
        Some(Outcome::NotStarted(why)) => why.clone(),
        other => panic!("{other:?} {:?}", sky.events),
    }
}

/// Alpha does not say where it is before this time.
const PLACED: Time = Time(25_000);

#[test]
fn what_is_on_board_is_read_again_where_an_id_changes_while_a_vehicle_is_still_checked() {
    for (at, changes) in [(0, 1), (1, 1), (2, 1), (0, 0)] {
        let plan = two();
        let mut sky = sky(&plan);
        sky.down = Some(Box::new(move |now, from, mut message| {
            if let Message::MissionCurrent { opaque_ids, .. } = &mut message {
                *opaque_ids = [5, 6, 0];
                let is_changed = now > Time(15_000) && from.system == 1;
                opaque_ids[at] += if is_changed { changes } else { 0 };
            }
            let is_position = matches!(message, Message::Flight(FlightMessage::Position(_)));
            match from.system == 1 && is_position && now < PLACED {
                true => Vec::new(),
                false => vec![(from, message)],
            }
        }));
        let lists = Rc::new(Cell::new(0));
        let counted = Rc::clone(&lists);
        sky.up = Some(Box::new(move |now, system, message| {
            if let Message::Mission(of) = message
                && (system, of.body) == (1, Body::RequestList)
                && now > Time(15_000)
            {
                counted.set(counted.get() + 1);
            }
            None
        }));
        sky.fly_to(1.0);
        assert_eq!(lists.get(), 3 * changes, "{:?}", sky.events);
    }
}

/// Another station gives alpha a mission of as many items, one of them elsewhere; nobody hears what they say.
fn exchange(sky: &mut Sky<'_>) {
    let requests = Rc::new(RefCell::new(Vec::new()));
    let seen = Rc::clone(&requests);
    let hidden = move |message: &Message| match message {
        Message::Mission(of) if of.target == OTHER => {
            if let Body::Request { seq } | Body::RequestInt { seq } = of.body {
                seen.borrow_mut().push(seq);
            }
            true
        }
        _ => false,
    };
    let before = sky.down.take();
    let before = RefCell::new(before);
    sky.down = Some(Box::new(move |now, from, message| {
        if hidden(&message) {
            return Vec::new();
        }
        match &mut *before.borrow_mut() {
            Some(down) => down(now, from, message),
            None => vec![(from, message)],
        }
    }));
    let items = sky.vehicles[0].items(MissionType::Mission).to_vec();
    let target = sky.vehicles[0].address();
    let say = |body| {
        Message::Mission(MissionMessage {
            target,
            mission_type: 0,
            body,
        })
    };
    let count = items.len() as u16 + 1;
    let opaque_id = 0;
    let now = sky.now;
    sky.vehicles[0].handle(now, OTHER, &say(Body::Count { count, opaque_id }));
    for _ in 0..300 {
        sky.step();
        for seq in requests.take() {
            // ArduPilot has its home first.
            let mut item = items[usize::from(seq).saturating_sub(1)];
            if usize::from(seq) == items.len() - 1 {
                item.x += 5000;
            }
            let current = u8::from(seq == 0);
            let now = sky.now;
            sky.vehicles[0].handle(now, OTHER, &say(Body::ItemInt { seq, current, item }));
        }
    }
    assert_eq!(
        sky.vehicles[0].items(MissionType::Mission).len(),
        items.len()
    );
    assert_ne!(sky.vehicles[0].items(MissionType::Mission), &items[..]);
}

#[test]
fn a_mission_that_is_exchanged_without_an_id_while_a_vehicle_is_still_checked_starts_nobody() {
    let plan = two();
    let mut sky = sky(&plan);
    sky.down = Some(Box::new(move |now, from, message| {
        let is_position = matches!(message, Message::Flight(FlightMessage::Position(_)));
        match from.system == 1 && is_position && now < PLACED {
            true => Vec::new(),
            false => vec![(from, message)],
        }
    }));
    while sky.now < Time(15_000) {
        sky.step();
    }
    exchange(&mut sky);
    let why = not_started(&mut sky);
    assert!(why.iter().any(|(id, _)| id == "alpha"), "{why:?}");
}

/// When all are armed, over links on which each answer takes that long.
fn armed_at(plan: &Planned, late_ms: u64) -> Time {
    let mut sky = sky(plan);
    late(&mut sky, move |_| late_ms);
    while sky.fleet.t_s(sky.now).is_none() {
        sky.step();
        assert!(sky.fleet.outcome().is_none(), "{:?}", sky.fleet.outcome());
        assert!(sky.now < Time(1_800_000), "{:?}", sky.events);
    }
    sky.now
}

#[test]
fn parameters_are_asked_for_together_over_a_link_of_three_seconds() {
    let plan = two();
    let (at_once, late) = (armed_at(&plan, 0), armed_at(&plan, 3000));
    let all = plan.dispatched.missions[0].1.params.len() as u64;
    let longer_ms = late - at_once;
    // The transfer of a mission is one answer after the other, too.
    println!("{all} parameters: T0 at {at_once:?}, and at {late:?} over a link of 3 s");
    assert!(
        longer_ms < 180_000,
        "{all} parameters: {longer_ms} ms longer"
    );
}

#[test]
fn one_that_does_not_say_whether_it_is_on_the_ground_is_asked() {
    let plan = two();
    let mut sky = sky(&plan);
    sky.down = Some(Box::new(|_, from, message| {
        let is_word = matches!(message, Message::Flight(FlightMessage::Landed(_)));
        match is_word {
            true => Vec::new(),
            false => vec![(from, message)],
        }
    }));
    let is_asked = Rc::new(Cell::new(false));
    let asked = Rc::clone(&is_asked);
    sky.up = Some(Box::new(move |_, _, message| {
        if let Message::Flight(FlightMessage::Command { order, .. }) = message {
            let is_it = order.command == Command::SET_MESSAGE_INTERVAL
                && (order.params[0] - 245.0).abs() < 0.5;
            asked.set(asked.get() || is_it);
        }
        None
    }));
    sky.fly_to(5.0);
    assert!(is_asked.get(), "EXTENDED_SYS_STATE");
}

#[test]
fn a_parameter_that_changes_in_flight_without_a_word_is_an_alarm() {
    let plan = two();
    let planned = parameters(&plan.dispatched.missions[0].1);
    let speed = planned.iter().find(|of| of.0 == "WPNAV_SPEED");
    let speed = speed.expect("a parameter").1;
    let mut sky = sky(&plan);
    sky.fly_to(30.0);
    let is_silent = Rc::new(Cell::new(true));
    let silent = Rc::clone(&is_silent);
    sky.down = Some(Box::new(move |_, from, message| {
        let is_parameter = matches!(message, Message::Flight(FlightMessage::Param { .. }));
        match is_parameter && silent.get() {
            true => Vec::new(),
            false => vec![(from, message)],
        }
    }));
    let set = Message::Flight(FlightMessage::ParamSet {
        target: sky.vehicles[0].address(),
        name: "WPNAV_SPEED".to_owned(),
        value: ParamValue::float(500.0),
    });
    let now = sky.now;
    sky.vehicles[0].handle(now, OTHER, &set);
    sky.fly_to(30.2);
    is_silent.set(false);
    sky.fly_to(90.0);
    let text = format!("ALARM mission: says that WPNAV_SPEED is 500, planned {speed}");
    assert_eq!(count(&sky, "alpha", &text), 1, "{:?}", sky.events);
    assert_eq!(count(&sky, "bravo", "ALARM"), 0, "{:?}", sky.events);
}
