//! A vehicle that disarms itself on the ground is never near that when the fleet begins.

use crate::support::sky::{Planned, Sky, lane, plan};

use sortie::flight::Outcome;
use sortie::link::{Command, FlightMessage, Message, Time};
use sortie::spec::{Autopilot, OnLinkLoss};

/// How much faster than the clock the vehicles' time goes.
const SPEEDUP: u32 = 5;

/// A PX4, which disarms itself 10 s after it was armed, and an ArduPilot.
fn pair() -> Planned {
    let mut fleet = vec![lane("alpha", 1, 36.300), lane("bravo", 2, 36.304)];
    fleet[0].autopilot = Autopilot::Px4;
    plan(fleet, OnLinkLoss::Continue)
}

/// The flight of the pair, of which the second hears no order to arm before a time after the first
/// that is sent to it, milliseconds of the clock.
fn flown(plan: &Planned, deaf_ms: u64) -> Sky<'_> {
    let mut options = plan.options(false);
    options.speedup = f64::from(SPEEDUP);
    let mut sky = Sky::new(plan.fleet_with(options, true), plan.vehicles());
    sky.speedup = u64::from(SPEEDUP);
    let mut first: Option<Time> = None;
    sky.up = Some(Box::new(move |now, system, message| {
        let Message::Flight(FlightMessage::Command { order, .. }) = message else {
            return None;
        };
        let arms = order.command == Command::COMPONENT_ARM_DISARM && order.params[0] > 0.5;
        if system != 2 || !arms {
            return None;
        }
        let since_ms = now - *first.get_or_insert(now);
        (since_ms < deaf_ms).then(Vec::new)
    }));
    sky
}

#[test]
fn a_vehicle_that_was_armed_first_is_armed_again_when_others_took_long() {
    let plan = pair();
    let mut armed_again = 0;
    for deaf_ms in (0..4000).step_by(100) {
        let mut sky = flown(&plan, deaf_ms);
        let mut armed: Option<Time> = None;
        while sky.fleet.t_s(sky.now).is_none() {
            assert!(sky.fleet.outcome().is_none(), "{deaf_ms}: {:?}", sky.events);
            let was = sky.vehicles[0].is_armed();
            sky.step();
            let is = sky.vehicles[0].is_armed();
            armed = match (was, is) {
                (false, true) => Some(sky.now),
                (true, true) => armed,
                (_, false) => None,
            };
        }
        let since = armed.unwrap_or_else(|| panic!("{deaf_ms}: disarmed at T0"));
        let own_ms = (sky.now - since) * u64::from(SPEEDUP);
        assert!(own_ms <= 5000, "{deaf_ms}: armed for {own_ms} ms at T0");
        armed_again += usize::from(sky.says("alpha", "it is armed again"));
        assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
        let ends: Vec<_> = sky.fleet.flown().map(|of| of.1.end.words()).collect();
        assert_eq!(ends, ["landed", "landed"], "{deaf_ms}: {:?}", sky.events);
    }
    assert!(armed_again > 5, "{armed_again}");
}
