//! Lines and figures of a flight that were not true.
#![allow(clippy::cast_possible_truncation, clippy::cast_precision_loss)]

use std::cell::Cell;
use std::rc::Rc;

use super::flight_truth::{ARMED, change, count, sky, two};
use super::orders_and_ends::position;
use crate::support::place;
use crate::support::sky::{US, lane, plan};
use sortie::flight::*;
use sortie::geodesy::Agl;
use sortie::link::*;
use sortie::simulator::Fault;
use sortie::spec::{AlarmKind, EndPoint, OnLinkLoss, Placement, Stop, Wind};

/// Nobody knows whether the positions before a jump or those after it are right.
#[test]
fn a_jump_of_the_position_that_is_not_undone_is_an_alarm_until_the_flight_is_over() {
    for is_undone in [false, true] {
        let plan = two();
        let mut sky = sky(&plan);
        sky.fly_to(40.0);
        let jump = |north_m: f64| Fault::Jump {
            east_m: 0.0,
            north_m,
        };
        sky.vehicles[0].fail(jump(67.0));
        sky.fly_to(50.0);
        if is_undone {
            sky.vehicles[0].fail(jump(0.0));
        }
        sky.fly_to(60.0);
        let over = count(&sky, "alpha", "position alarm: over");
        assert_eq!(over, usize::from(is_undone), "{:?}", sky.events);
        let stands = sky.fleet.status(sky.now)[0]
            .alarms
            .contains(&AlarmKind::Position);
        assert_eq!(stands, !is_undone);
        assert_eq!(
            count(&sky, "alpha", "ALARM position"),
            1,
            "{:?}",
            sky.events
        );
    }
}

#[test]
fn a_variance_of_the_estimate_that_swings_about_its_limit_is_one_alarm() {
    let plan = two();
    let mut sky = sky(&plan);
    let switch = change(&mut sky, |now, message| {
        if let Message::Flight(FlightMessage::Health(Health::Ekf { variances, .. })) = message {
            let swing = (now.0 as f32 / 2500.0).sin();
            variances[1] = 0.7 + 0.2 * swing;
        }
    });
    sky.fly_to(25.0);
    switch.set(true);
    sky.fly_to(90.0);
    assert_eq!(count(&sky, "alpha", "ALARM ekf"), 1, "{:?}", sky.events);
    assert_eq!(
        count(&sky, "alpha", "ekf alarm: over"),
        0,
        "{:?}",
        sky.events
    );
    switch.set(false);
    sky.fly_to(103.0);
    assert_eq!(
        count(&sky, "alpha", "ekf alarm: over"),
        1,
        "{:?}",
        sky.events
    );
}

#[test]
fn a_tab_at_the_end_of_a_text_is_no_part_of_it() {
    let plan = two();
    let mut sky = sky(&plan);
    sky.fly_to(30.0);
    let from = sky.vehicles[0].address();
    for text in ["Failsafe activated\t", "a\tb \t", "\t"] {
        let text = Message::StatusText {
            severity: 5,
            text: text.to_owned(),
        };
        sky.fleet.handle(sky.now, (0, from), &text);
    }
    sky.fly_to(31.0);
    let of = sky.events.iter().map(|event| event.text.as_str());
    let said: Vec<&str> = of.filter(|text| text.starts_with("says: ")).collect();
    assert_eq!(
        said,
        [
            "says: Failsafe activated",
            "says: a b",
            "says: (an empty text)"
        ]
    );
}
