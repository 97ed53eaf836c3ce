//! What was found when a vehicle was checked may have changed before all of them start.

use std::cell::Cell;

use super::elsewhere::acknowledged_to_another;
use super::flight_truth::{ARMED, change, two};
use super::orders_and_ends::position;
use crate::support::sky::Sky;
use sortie::flight::*;
use sortie::link::*;

/// Why nobody starts, where this happens to the messages of alpha from when it is ready until all are.
pub(super) fn refusals(happens: impl Fn(&mut Message) + 'static) -> Vec<(String, String)> {
    let plan = two();
    let launch = Launch {
        from: Time(90_000),
        until: Time(120_000),
    };
    let fleet = plan.fleet_launched(false, true, Some(launch));
    let mut sky = Sky::new(fleet, plan.vehicles());
    let switch = change(&mut sky, move |_, message| happens(message));
    while sky.now < Time(80_000) {
        sky.step();
    }
    assert_eq!(sky.fleet.outcome(), None, "{:?}", sky.events);
    switch.set(true);
    let Outcome::NotStarted(why) = sky.fly_out() else {
        panic!("{:?}", sky.events);
    };
    assert!(!sky.says("bravo", "took off"), "{:?}", sky.events);
    why
}

fn is_named(why: &[(String, String)], text: &str) -> bool {
    let mut why = why.iter();
    why.any(|(vehicle, of)| vehicle == "alpha" && of.contains(text))
}

#[test]
fn who_was_armed_by_its_pilot_meanwhile_starts_nobody() {
    let why = refusals(|message| {
        if let Message::Heartbeat(beat) = message {
            beat.base_mode |= ARMED;
        }
    });
    assert!(is_named(&why, "was armed after it was checked"), "{why:?}");
}

#[test]
fn who_was_carried_away_meanwhile_starts_nobody() {
    let why = refusals(|message| position(message, |position| position.x += 6300));
    assert!(is_named(&why, "it stands 70 m from its home"), "{why:?}");
}

#[test]
fn who_has_no_battery_left_meanwhile_starts_nobody() {
    let why = refusals(|message| {
        if let Message::Flight(FlightMessage::Health(health)) = message {
            match health {
                Health::System(status) => status.remaining = 5,
                Health::Battery { remaining, .. } => *remaining = 5,
                _ => {}
            }
        }
    });
    assert!(is_named(&why, "5 % left, reserve 20 %"), "{why:?}");
}

#[test]
fn who_takes_a_list_from_another_station_meanwhile_starts_nobody() {
    for mission_type in [0, 1, 2] {
        let why = refusals(move |message| {
            if matches!(message, Message::Heartbeat(_)) {
                *message = acknowledged_to_another(mission_type);
            }
        });
        assert!(
            is_named(&why, "to system 254 after they were read"),
            "{why:?}"
        );
    }
}

#[test]
fn who_says_that_a_parameter_is_another_one_meanwhile_starts_nobody() {
    let is_said = Cell::new(false);
    let why = refusals(move |message| {
        let speed = ParamValue::float(500.0);
        if matches!(message, Message::Heartbeat(_)) && !is_said.replace(true) {
            let name = "WPNAV_SPEED".to_owned();
            let value = speed;
            *message = Message::Flight(FlightMessage::Param { name, value });
        }
        if let Message::Flight(FlightMessage::Param { name, value }) = message
            && name == "WPNAV_SPEED"
        {
            // Whenever it is read again.
            *value = speed;
        }
    });
    let text = "it says that WPNAV_SPEED is 500 and not 1500, after it was checked";
    assert!(is_named(&why, text), "{why:?}");
}

#[test]
fn what_a_vehicle_never_reports_is_named_at_t0() {
    let plan = two();
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    let switch = change(&mut sky, |_, message| {
        if let Message::Flight(FlightMessage::Health(health)) = message {
            match health {
                Health::System(status) => status.remaining = -1,
                Health::Battery { remaining, .. } => *remaining = -1,
                _ => {}
            }
        }
    });
    switch.set(true);
    sky.fly_to(1.0);
    const BATTERY: &str =
        "has not reported the charge of its battery: no alarm will come of that unless it does";
    assert!(sky.says("alpha", BATTERY), "{:?}", sky.events);
    assert!(!sky.says("bravo", "has not reported"), "{:?}", sky.events);
}

#[test]
fn who_turns_out_to_be_of_another_kind_starts_nobody() {
    let why = refusals(|message| {
        if let Message::Heartbeat(beat) = message {
            // `MAV_TYPE_FIXED_WING`.
            beat.kind = 1;
        }
    });
    assert!(
        is_named(&why, "the spec says copter, the vehicle says fixed wing"),
        "{why:?}"
    );
}
