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
