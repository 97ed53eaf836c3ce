//! A vehicle that was told to hold is watched on: whoever takes it over, what is seen is told.
#![allow(clippy::cast_possible_truncation)]

use crate::support::sky;
use sky::{Planned, Sky, lane, plan};
use sortie::flight::*;
use sortie::link::*;
use sortie::spec::{Autopilot, OnLinkLoss};

/// Two side by side, a kilometre each.
fn two() -> Planned {
    let mut fleet = vec![lane("alpha", 1, 36.300), lane("bravo", 2, 36.308)];
    fleet[1].autopilot = Autopilot::Px4;
    plan(fleet, OnLinkLoss::Continue)
}

fn stage(sky: &Sky<'_>, index: usize) -> &'static str {
    sky.fleet.status(sky.now)[index].stage
}

/// A flight in which both were told to hold and do.
fn held(plan: &Planned) -> Sky<'_> {
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    sky.fly_to(45.0);
    sky.fleet.intervene(sky.now, Intervention::Hold);
    sky.fly_to(46.0);
    assert_eq!(stage(&sky, 0), "stops");
    sky.fly_to(60.0);
    assert_eq!((stage(&sky, 0), stage(&sky, 1)), ("holds", "holds"));
    sky
}

#[test]
fn who_was_held_and_is_brought_down_by_somebody_else_is_seen_to_stop_its_motors() {
    let plan = two();
    let mut sky = held(&plan);
    sky.order(0, Command::NAV_LAND);
    assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
    assert_eq!((sky.end(0), sky.end(1)), (End::StoppedAfterHold, End::Held));
    let told = "stopped its motors after it was ordered to hold";
    assert!(sky.says("alpha", told), "{:?}", sky.events);
    assert!(sky.says("bravo", "is not watched any more"));
    assert_eq!(stage(&sky, 0), "stopped");
    // Its way down is in the record, and so is its end.
    let record = plan.record(&sky);
    let last = record.flights[0].flown.fixes.last().expect("positions");
    assert!((last.amsl.0 - 400.0).abs() < 1.0, "{last:?}");
    let report = judge(&plan.spec, &plan.world, &record);
    let ends: Vec<&str> = report.vehicles.iter().map(|v| v.end.as_str()).collect();
    assert_eq!(ends, ["ordered to hold, then stopped its motors", "held"]);
    assert!(!report.passes());
    assert_eq!(End::of_words(ends[0]), End::StoppedAfterHold);
}

#[test]
fn who_was_held_and_is_sent_on_its_mission_again_ends_it_as_planned() {
    let plan = two();
    let mut sky = held(&plan);
    for index in [0, 1] {
        sky.order(index, Command::MISSION_START);
    }
    assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
    assert!(sky.says("alpha", "is on its mission again"));
    assert_eq!((sky.end(0), sky.end(1)), (End::Landed, End::Landed));
    let report = plan.judge(&sky);
    assert!(report.passes(), "{report:#?}");
}

#[test]
fn who_was_held_and_falls_silent_is_not_said_to_be_held() {
    let plan = two();
    let mut sky = held(&plan);
    sky.cut.push(1);
    assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
    let why = End::Failed("held, and was not heard of since".to_owned());
    assert_eq!((sky.end(0), sky.end(1)), (why, End::Held));
}

#[test]
fn who_is_held_can_be_told_to_land_and_whoever_leaves_leaves_it_held() {
    let plan = two();
    let mut sky = held(&plan);
    sky.fleet.intervene(sky.now, Intervention::Land);
    assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
    assert_eq!(
        (sky.end(0), sky.end(1)),
        (End::LandedEarly, End::LandedEarly)
    );
    let mut sky = held(&plan);
    sky.fleet.intervene(sky.now, Intervention::Leave);
    assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
    assert_eq!((sky.end(0), sky.end(1)), (End::Held, End::Held));
}

#[test]
fn a_landing_that_is_acknowledged_and_not_flown_is_ordered_again_until_the_mode_shows_it() {
    let plan = two();
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    sky.fly_to(25.0);
    // The first orders are answered for it, and never reach it; then it refuses some.
    let mut orders = 0;
    sky.up = Some(Box::new(move |_, system, message| {
        let Message::Flight(FlightMessage::Command { target, order }) = message else {
            return None;
        };
        if system != 1 || order.command != Command::DO_SET_MODE {
            return None;
        }
        orders += 1;
        let result = match orders {
            0..=9 => CommandResult::ACCEPTED,
            10..=12 => CommandResult::FAILED,
            _ => return None,
        };
        let command = order.command;
        let answer = FlightMessage::CommandAck {
            target: sky::US,
            command,
            result,
        };
        Some(vec![(*target, Message::Flight(answer))])
    }));
    sky.fleet.intervene(sky.now, Intervention::Land);
    sky.fly_to(46.5);
    assert!(
        sky.says("alpha", "landing not confirmed"),
        "{:?}",
        sky.events
    );
    assert_eq!((stage(&sky, 0), stage(&sky, 1)), ("not landing", "lands"));
    assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
    let landed = (End::LandedEarly, End::LandedEarly);
    assert_eq!((sky.end(0), sky.end(1)), landed, "{:?}", sky.events);
    let refused = |event: &&Event| event.text.contains("refused command 176");
    assert_eq!(sky.events.iter().filter(refused).count(), 1);
}
