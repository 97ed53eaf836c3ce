//! Before T0: what is set of a vehicle, and what changes of it after it was checked.

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use super::flight_truth::{ARMED, sky, two};
use super::orders_and_ends::position;
use super::ready_and_t0::refusals;
use crate::support::sky::{Planned, Sky};
use sortie::flight::*;
use sortie::link::*;

/// `WPNAV_SPEED` of alpha is 500 cm/s.
fn slow(sky: &mut Sky<'_>) {
    let set = Message::Flight(FlightMessage::ParamSet {
        target: sky.vehicles[0].address(),
        name: "WPNAV_SPEED".to_owned(),
        value: ParamValue::float(500.0),
    });
    let (system, component) = (255, 190);
    sky.vehicles[0].handle(sky.now, Address { system, component }, &set);
}

/// The parameters that are set from now on.
fn watch_sets(sky: &mut Sky<'_>) -> Rc<RefCell<Vec<String>>> {
    let sets = Rc::new(RefCell::new(Vec::new()));
    let seen = Rc::clone(&sets);
    sky.up = Some(Box::new(move |_, _, message| {
        if let Message::Flight(FlightMessage::ParamSet { name, .. }) = message {
            seen.borrow_mut().push(name.clone());
        }
        None
    }));
    sets
}

fn not_started(sky: &mut Sky<'_>) -> Vec<(String, String)> {
    let Outcome::NotStarted(why) = sky.fly_out() else {
        panic!("{:?}", sky.events);
    };
    why
}

fn is_named(why: &[(String, String)], vehicle: &str, text: &str) -> bool {
    why.iter()
        .any(|(id, of)| id == vehicle && of.contains(text))
}

fn setting(plan: &Planned) -> Sky<'_> {
    Sky::new(plan.fleet(true, true), plan.vehicles())
}

#[test]
fn no_parameter_of_a_vehicle_in_the_air_is_set() {
    let plan = two();
    let mut sky = sky(&plan);
    sky.fly_to(40.0);
    slow(&mut sky);
    let sets = watch_sets(&mut sky);
    sky.fleet = plan.fleet_from(sky.now, plan.options(true), false, &[]);
    let why = not_started(&mut sky);
    assert!(is_named(&why, "alpha", "it is armed"), "{why:?}");
    assert!(sets.borrow().is_empty(), "{sets:?}");
}

/// Whether a fleet flies of which one says other positions in its first seconds.
fn is_waited_for(other: fn(&mut Position)) {
    let plan = two();
    let mut sky = setting(&plan);
    sky.down = Some(Box::new(move |now, from, mut message| {
        if from.system == 1 && now < Time(20_000) {
            position(&mut message, other);
        }
        vec![(from, message)]
    }));
    let outcome = sky.fly_out();
    assert!(matches!(outcome, Outcome::Flown), "{outcome:?}");
}

/// As ArduPlane 4.7.0-beta1 said: near 0, 0 in 4 m/s of wind, and at its home already with an altitude of 0.
#[test]
fn a_vehicle_without_a_fix_or_an_altitude_yet_is_waited_for() {
    is_waited_for(|position| {
        (position.x, position.y, position.amsl_mm) = (-2664, -1548, -150);
    });
    is_waited_for(|position| position.amsl_mm = 0);
}

#[test]
fn no_parameter_of_a_vehicle_that_stands_elsewhere_is_set() {
    let plan = two();
    let mut sky = setting(&plan);
    slow(&mut sky);
    let sets = watch_sets(&mut sky);
    sky.down = Some(Box::new(|_, from, mut message| {
        if from.system == 1 {
            position(&mut message, |position| position.x += 6300);
        }
        vec![(from, message)]
    }));
    let why = not_started(&mut sky);
    assert!(is_named(&why, "alpha", "it stands 70 m"), "{why:?}");
    assert!(sets.borrow().is_empty(), "{sets:?}");
}

#[test]
fn a_vehicle_that_arms_while_its_parameters_are_set_gets_no_more_of_them() {
    let plan = two();
    let mut sky = setting(&plan);
    slow(&mut sky);
    let sets = Rc::new(Cell::new(0));
    let is_armed = Rc::new(Cell::new(false));
    let (counted, armed) = (Rc::clone(&sets), Rc::clone(&is_armed));
    sky.up = Some(Box::new(move |_, system, message| {
        let is_set = matches!(message, Message::Flight(FlightMessage::ParamSet { .. }));
        let is_its = system == 1 && is_set;
        let after = u32::from(is_its && armed.get());
        counted.set(counted.get() + after);
        // None of them arrives.
        is_its.then(Vec::new)
    }));
    let armed = Rc::clone(&is_armed);
    sky.down = Some(Box::new(move |now, from, mut message| {
        if let Message::Heartbeat(beat) = &mut message
            && from.system == 1
            && now > Time(3000)
        {
            beat.base_mode |= ARMED;
            armed.set(true);
        }
        vec![(from, message)]
    }));
    let why = not_started(&mut sky);
    assert!(is_named(&why, "alpha", "it is armed"), "{why:?}");
    assert_eq!(sets.get(), 0, "{why:?}");
}

#[test]
fn parameters_that_were_set_are_named_where_nobody_starts() {
    let plan = two();
    let mut sky = setting(&plan);
    slow(&mut sky);
    sky.down = Some(Box::new(|_, from, mut message| {
        if from.system == 2 {
            position(&mut message, |position| position.x += 6300);
        }
        vec![(from, message)]
    }));
    let why = not_started(&mut sky);
    let text = "was set, and stays so: WPNAV_SPEED from 500 to 1500";
    assert!(is_named(&why, "alpha", text), "{why:?}");
}

#[test]
fn a_home_that_was_moved_after_it_was_checked_starts_nobody() {
    let why = refusals(|message| {
        if let Message::HomePosition { x, .. } = message {
            *x += 36_000;
        }
    });
    assert!(
        is_named(
            &why,
            "alpha",
            "its home is 399 m from where the plan has it"
        ),
        "{why:?}"
    );
}

#[test]
fn a_list_that_was_replaced_after_it_was_read_starts_nobody() {
    for (at, text) in [
        (0, "the mission on board is another one"),
        (1, "the fence on board is another one"),
        (2, "the rally points on board are others"),
    ] {
        let plan = two();
        let (from, until) = (Time(60_000), Time(120_000));
        let fleet = plan.fleet_launched(false, true, Some(Launch { from, until }));
        let mut sky = Sky::new(fleet, plan.vehicles());
        sky.down = Some(Box::new(move |now, from, mut message| {
            if let Message::MissionCurrent { opaque_ids, .. } = &mut message {
                // First there are no rally points.
                *opaque_ids = [5, 6, 0];
                opaque_ids[at] += u32::from(now > Time(50_000) && from.system == 1);
            }
            vec![(from, message)]
        }));
        let why = not_started(&mut sky);
        assert!(is_named(&why, "alpha", text), "{why:?}");
    }
}

#[test]
fn who_never_says_which_item_it_flies_to_starts_nobody() {
    let plan = two();
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    sky.down = Some(Box::new(|_, from, message| {
        let is_current = matches!(message, Message::MissionCurrent { .. });
        match from.system == 1 && is_current {
            true => Vec::new(),
            false => vec![(from, message)],
        }
    }));
    let why = not_started(&mut sky);
    let text = "does not say which item it flies to";
    assert!(is_named(&why, "alpha", text), "{why:?}");
}

#[test]
fn who_hovers_when_the_monitoring_ends_is_named_as_in_the_air() {
    let plan = two();
    let mut sky = sky(&plan);
    sky.fly_to(30.0);
    sky.order(0, Command::NAV_LOITER_UNLIM);
    assert_eq!(sky.fly_out(), Outcome::Flown);
    assert!(matches!(sky.end(0), End::Failed(_)), "{:?}", sky.events);
    assert_eq!(sky.fleet.in_the_air(), ["alpha"], "{:?}", sky.events);
}

#[test]
fn parameters_are_read_over_a_link_of_three_seconds_and_the_wait_is_said() {
    let plan = two();
    let mut sky = setting(&plan);
    slow(&mut sky);
    let late = RefCell::new(Vec::new());
    sky.down = Some(Box::new(move |now, from, message| {
        let mut late = late.borrow_mut();
        late.push((now + 3000, from, message));
        let due = late.iter().take_while(|(at, ..)| *at <= now).count();
        late.drain(..due)
            .map(|(_, from, message)| (from, message))
            .collect()
    }));
    while sky.fleet.outcome().is_none() && sky.fleet.t_s(sky.now).is_none() {
        sky.step();
        assert!(sky.now < Time(1_800_000), "{:?}", sky.events);
    }
    let why = format!("{:?}", sky.fleet.outcome());
    assert!(!why.contains("is not known to the vehicle"), "{why}");
    assert!(!why.contains("does not take"), "{why}");
    assert!(
        sky.says("alpha", "is waited for: parameter"),
        "{:?}",
        sky.events
    );
}
