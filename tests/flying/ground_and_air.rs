//! Whether a vehicle is on the ground or in the air is known by more than its height.
#![allow(clippy::cast_possible_truncation, clippy::cast_precision_loss)]

use std::cell::Cell;
use std::rc::Rc;

use super::flight_truth::{ARMED, change, count, sky, two};
use super::orders_and_ends::position;
use crate::support::sky::{Planned, lane, plan};
use sortie::flight::*;
use sortie::link::*;
use sortie::simulator::Fault;
use sortie::spec::{Action, AlarmKind, Answer, OnLinkLoss, Who};

fn answering(kind: AlarmKind, action: Action) -> Planned {
    let mut plan = two();
    let who = Who::Vehicle;
    let answer = Some(Answer { who, action });
    match kind {
        AlarmKind::Battery => plan.spec.on_alarm.battery = answer,
        _ => plan.spec.on_alarm.position = answer,
    }
    plan
}

#[test]
fn a_copter_that_flies_low_by_its_altitude_is_not_on_the_ground_and_gets_its_order() {
    let plan = answering(AlarmKind::Battery, Action::Land);
    let mut sky = sky(&plan);
    // The ground is at 400 m.
    let switch = change(&mut sky, |_, message| {
        position(message, |position| {
            (position.amsl_mm, position.above_home_mm) = (401_500, 1500);
        });
    });
    sky.fly_to(30.0);
    switch.set(true);
    sky.fly_to(66.0);
    let runs_on = count(&sky, "alpha", "its motors run on");
    assert_eq!(runs_on, 0, "{:?}", sky.events);
    sky.vehicles[0].fail(Fault::BatteryDrain { percent_s: 80.0 });
    sky.fly_to(70.0);
    assert_eq!(
        count(&sky, "alpha", "is ordered to land"),
        1,
        "{:?}",
        sky.events
    );
}

#[test]
fn a_height_that_drifts_while_a_vehicle_waits_on_the_ground_is_no_takeoff() {
    let plan = two();
    let mut sky = sky(&plan);
    let drift = change(&mut sky, |_, message| {
        position(message, |position| {
            position.amsl_mm += 1800;
            position.above_home_mm += 1800;
        });
        if let Message::Heartbeat(beat) = message {
            beat.base_mode |= ARMED;
        }
    });
    // It takes the order to start, and stays where it is.
    sky.up = Some(Box::new(|_, system, message| {
        let Message::Flight(FlightMessage::Command { target, order }) = message else {
            return None;
        };
        let is_start = system == 1 && order.command == Command::MISSION_START;
        let ack = FlightMessage::CommandAck {
            target: crate::support::sky::US,
            command: order.command,
            result: CommandResult::ACCEPTED,
        };
        is_start.then(|| vec![(*target, Message::Flight(ack))])
    }));
    sky.fly_to(2.0);
    drift.set(true);
    sky.fly_to(60.0);
    assert_eq!(count(&sky, "alpha", "took off"), 0, "{:?}", sky.events);
    let late = "ALARM late: has not taken off";
    assert_eq!(count(&sky, "alpha", late), 1, "{:?}", sky.events);
}

#[test]
fn a_vehicle_that_is_armed_again_where_it_has_landed_is_not_in_the_air() {
    let plan = two();
    let mut sky = sky(&plan);
    let arms = Rc::new(Cell::new(false));
    let is_armed = Rc::clone(&arms);
    let drift = change(&mut sky, move |_, message| {
        position(message, |position| {
            position.amsl_mm += 2000;
            position.above_home_mm += 2000;
        });
        if let Message::Heartbeat(beat) = message
            && is_armed.get()
        {
            beat.base_mode |= ARMED;
        }
    });
    // Bravo is heard no more, and the flight goes on.
    sky.fly_to(60.0);
    sky.cut.push(2);
    while count(&sky, "alpha", "landed, motors stopped") == 0 {
        sky.step();
    }
    let landed_s = sky.fleet.t_s(sky.now).expect("T0");
    drift.set(true);
    sky.fly_to(landed_s + 4.0);
    arms.set(true);
    sky.fly_to(landed_s + 12.0);
    let again = count(&sky, "alpha", "it is watched again");
    assert_eq!(again, 0, "{:?}", sky.events);
    assert_eq!(count(&sky, "alpha", "ALARM"), 0, "{:?}", sky.events);
}

#[test]
fn a_vehicle_that_was_not_heard_at_its_start_is_watched_again_when_it_is_heard_to_fly() {
    let plan = answering(AlarmKind::Battery, Action::Land);
    let mut sky = sky(&plan);
    // Its downlink is lost; it hears all.
    let is_lost = Rc::new(Cell::new(false));
    let lost = Rc::clone(&is_lost);
    sky.down = Some(Box::new(move |_, from, message| {
        match from.system == 1 && lost.get() {
            true => Vec::new(),
            false => vec![(from, message)],
        }
    }));
    sky.fly_to(0.0);
    is_lost.set(true);
    sky.fly_to(32.0);
    let armed = |event: &Event| event.text.contains("alpha IS STILL ARMED");
    assert!(sky.events.iter().any(armed), "{:?}", sky.events);
    is_lost.set(false);
    sky.fly_to(40.0);
    let again = "in the air: it is watched again";
    assert_eq!(count(&sky, "alpha", again), 1, "{:?}", sky.events);
    sky.vehicles[0].fail(Fault::BatteryDrain { percent_s: 80.0 });
    sky.fly_to(48.0);
    let ordered = count(&sky, "alpha", "is ordered to land");
    assert_eq!(ordered, 1, "{:?}", sky.events);
    assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
    assert_eq!(sky.end(0), End::LandedEarly, "{:?}", sky.events);
}

#[test]
fn what_was_ordered_on_the_ground_is_ordered_again_to_one_that_takes_off_unheard() {
    let mut fleet = vec![lane("alpha", 1, 36.300), lane("bravo", 2, 36.308)];
    // It waits in its mission.
    fleet[0].depart_s = 30.0;
    let plan = plan(fleet, OnLinkLoss::Continue);
    let mut sky = sky(&plan);
    sky.fly_to(1.0);
    let waits = plan.dispatched.missions[0].1.items.iter();
    let waits = waits.clone().any(|item| item.command == 93);
    assert!(waits, "a delay of the mission");
    // It does not hear the hold, and is heard.
    let is_deaf = Rc::new(Cell::new(false));
    let deaf = Rc::clone(&is_deaf);
    sky.up = Some(Box::new(move |_, system, _| {
        (system == 1 && deaf.get()).then(Vec::new)
    }));
    sky.fly_to(5.0);
    is_deaf.set(true);
    sky.fleet.intervene(sky.now, Intervention::Hold);
    sky.fly_to(28.0);
    let armed = |event: &Event| event.text.contains("alpha IS STILL ARMED");
    assert!(sky.events.iter().any(armed), "{:?}", sky.events);
    is_deaf.set(false);
    sky.fly_to(70.0);
    let again = "in the air: it is watched again";
    assert_eq!(count(&sky, "alpha", again), 1, "{:?}", sky.events);
    assert_eq!(count(&sky, "alpha", "holds"), 1, "{:?}", sky.events);
}

#[test]
fn without_a_position_it_is_not_said_to_stay_on_the_ground_and_items_show_its_takeoff() {
    let plan = answering(AlarmKind::Position, Action::Land);
    let mut sky = sky(&plan);
    let is_lost = Rc::new(Cell::new(false));
    let lost = Rc::clone(&is_lost);
    sky.down = Some(Box::new(move |_, from, message| {
        let is_position = matches!(message, Message::Flight(FlightMessage::Position(_)));
        match from.system == 1 && is_position && lost.get() {
            true => Vec::new(),
            false => vec![(from, message)],
        }
    }));
    // It does not hear the order of its alarm either, and flies its mission.
    let is_deaf = Rc::clone(&is_lost);
    sky.up = Some(Box::new(move |_, system, message| {
        let Message::Flight(FlightMessage::Command { order, .. }) = message else {
            return None;
        };
        let is_order = order.command != Command::MISSION_START;
        (system == 1 && is_order && is_deaf.get()).then(Vec::new)
    }));
    sky.fly_to(0.0);
    is_lost.set(true);
    sky.fly_to(60.0);
    let took_off = "took off by its own word: its position is not known";
    assert_eq!(count(&sky, "alpha", took_off), 1, "{:?}", sky.events);
    for text in ["has not taken off", "stays on the ground", "ARMED"] {
        let said = sky.events.iter().any(|event| event.text.contains(text));
        assert!(!said, "{text}: {:?}", sky.events);
    }
    let ordered = count(&sky, "alpha", "is ordered to land");
    assert_eq!(ordered, 1, "{:?}", sky.events);
}
