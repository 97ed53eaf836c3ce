//! A flight whose limits hold at certain times begins then, or not at all.

use crate::support::sky::{Sky, lane, plan};

use sortie::flight::{Launch, Outcome};
use sortie::link::Time;
use sortie::spec::OnLinkLoss;

#[test]
fn vehicles_that_are_ready_are_armed_when_the_flight_may_begin() {
    let planned = plan(vec![lane("alpha", 1, 36.30)], OnLinkLoss::Continue);
    let launch = Launch {
        from: Time(60_000),
        until: Time(65_000),
    };
    let fleet = planned.fleet_launched(true, true, Some(launch));
    let mut sky = Sky::new(fleet, planned.vehicles());
    while sky.now < Time(59_900) {
        sky.step();
        let is_armed = sky.events.iter().any(|event| event.text.contains("T0"));
        assert!(
            !is_armed && sky.fleet.t_s(sky.now).is_none(),
            "{:?}",
            sky.events
        );
    }
    let waits = sky
        .events
        .iter()
        .filter(|event| event.text.contains("t0 is in"));
    assert_eq!(waits.count(), 1, "{:?}", sky.events);
    sky.fly_to(1.0);
    assert!(sky.now <= Time(66_000), "{:?}", sky.now);
}

#[test]
fn a_clock_of_the_wall_that_is_set_back_while_a_flight_waits_puts_its_launch_off() {
    let planned = plan(vec![lane("alpha", 1, 36.30)], OnLinkLoss::Continue);
    // It is 1 000 000 ms since 1970, and the flight may begin a minute later.
    let window_ms = (1_060_000, 1_065_000);
    let launch = Launch::between(window_ms, 1_000_000, Time(0));
    assert_eq!((launch.from, launch.until), (Time(60_000), Time(65_000)));
    let fleet = planned.fleet_launched(true, true, Some(launch));
    let mut sky = Sky::new(fleet, planned.vehicles());
    while sky.now < Time(149_000) {
        // The clock is set back by 90 s after half a minute.
        let set_ms = if sky.now > Time(30_000) { 90_000 } else { 0 };
        let unix_ms = 1_000_000 + sky.now.0 - set_ms;
        let launch = Launch::between(window_ms, unix_ms, sky.now);
        sky.fleet.retime_launch(launch);
        sky.step();
        assert!(sky.fleet.t_s(sky.now).is_none(), "{:?}", sky.events);
        assert!(sky.fleet.outcome().is_none(), "{:?}", sky.events);
    }
    sky.fly_to(1.0);
    let past = Launch::between(window_ms, 1_070_000, Time(20_000));
    assert_eq!((past.from, past.until), (Time(10_000), Time(15_000)));
}

#[test]
fn a_fleet_that_is_ready_after_its_time_is_not_launched() {
    let planned = plan(vec![lane("alpha", 1, 36.30)], OnLinkLoss::Continue);
    let launch = Launch {
        from: Time(0),
        until: Time(100),
    };
    let fleet = planned.fleet_launched(true, true, Some(launch));
    let mut sky = Sky::new(fleet, planned.vehicles());
    let Outcome::NotStarted(why) = sky.fly_out() else {
        panic!("{:?}", sky.events);
    };
    assert!(
        why.iter()
            .any(|(_, why)| why.contains("too late for the times")),
        "{why:?}"
    );
    assert!(sky.fleet.t_s(sky.now).is_none());
}
