//! What positions and heights show counts, whatever a vehicle says.
#![allow(clippy::cast_possible_truncation)]

use std::cell::Cell;
use std::rc::Rc;

use super::flight_truth::{ARMED, change, count, sky, two};
use super::orders_and_ends::position;
use crate::support::place;
use crate::support::sky::{Sky, lane, plan};
use sortie::flight::*;
use sortie::geodesy::Agl;
use sortie::link::*;
use sortie::spec::{EndPoint, OnLinkLoss, Placement, Stop};

/// A vehicle with a stop of 30 s, which another station sends on as it comes there, and which says that it reached it.
#[test]
fn a_stop_that_it_flies_past_is_missed_although_it_says_that_it_reached_it() {
    let mast = place(36.302, -84.254);
    let end = EndPoint {
        place: mast,
        altitude: Placement::Agl(Agl(80.0)),
    };
    let mut alpha = lane("alpha", 1, 36.30);
    alpha.stops = vec![Stop {
        hold_s: 30.0,
        ..Stop::passing("mast", end)
    }];
    for skips in [false, true] {
        let plan = plan(vec![alpha.clone()], OnLinkLoss::Continue);
        let mut sky = sky(&plan);
        let at = |sky: &Sky<'_>| {
            let (_, flown) = sky.fleet.flown().next().expect("alpha");
            flown
                .fixes
                .last()
                .map(|fix| (fix.place.chord_m(mast), fix.item))
        };
        while at(&sky).is_none_or(|(away_m, _)| away_m > 12.0) {
            sky.step();
            assert!(sky.now.0 < 300_000, "{:?}", sky.events);
        }
        let (_, item) = at(&sky).expect("a position");
        if skips {
            // ArduPilot counts home.
            let [seq, next] = [item, item + 1].map(|seq| u16::try_from(seq).expect("few"));
            let address = sky.vehicles[0].address();
            let (target, order) = (
                address,
                FlightMessage::SetCurrent {
                    target: address,
                    seq: next,
                },
            );
            let other = Address {
                system: 255,
                component: 190,
            };
            sky.vehicles[0].handle(sky.now, other, &Message::Flight(order));
            let reached = Message::Flight(FlightMessage::ItemReached { seq });
            sky.fleet.handle(sky.now, (0, target), &reached);
        }
        assert_eq!(sky.fly_out(), Outcome::Flown);
        assert_eq!(
            sky.says("alpha", "stop mast done"),
            !skips,
            "{:?}",
            sky.events
        );
        assert_eq!(
            sky.says("alpha", "stop mast missed"),
            skips,
            "{:?}",
            sky.events
        );
    }
}

/// It lies on the ground, twitching; it says that it flies its mission.
#[test]
fn a_copter_that_crashed_and_runs_its_motors_is_on_the_ground() {
    let plan = two();
    let mut sky = sky(&plan);
    let twitches = Rc::new(Cell::new(0_i32));
    let switch = change(&mut sky, move |_, message| {
        position(message, |position| {
            twitches.set(twitches.get() + 1);
            position.x = 363_010_000 + 20 * (twitches.get() % 5);
            position.y = -842_540_000;
            (position.amsl_mm, position.above_home_mm) = (400_300, 300);
            position.velocity_cmps = [90, 0, 0];
        });
    });
    sky.fly_to(50.0);
    switch.set(true);
    sky.fly_to(85.0);
    let text = "is on the ground, and its motors run on: keep away from it";
    assert_eq!(count(&sky, "alpha", text), 1, "{:?}", sky.events);
    assert_eq!(count(&sky, "bravo", text), 0, "{:?}", sky.events);
}

/// Without a place it still says how high it is.
#[test]
fn a_copter_that_landed_without_a_place_did_not_stop_its_motors_in_the_air() {
    for lands in [true, false] {
        let plan = two();
        let mut sky = sky(&plan);
        let above_mm = if lands { 100 } else { 60_000 };
        let switch = change(&mut sky, move |_, message| {
            position(message, |position| {
                (position.x, position.y) = (0, 0);
                position.above_home_mm = above_mm;
            });
            if let Message::Heartbeat(beat) = message {
                beat.base_mode &= !ARMED;
            }
        });
        sky.fly_to(50.0);
        switch.set(true);
        sky.fly_to(60.0);
        let high = count(&sky, "alpha", "m over the ground");
        assert_eq!(high, usize::from(!lands), "{:?}", sky.events);
        let elsewhere = count(&sky, "alpha", "m from the end of its mission");
        assert_eq!(elsewhere, usize::from(lands), "{:?}", sky.events);
    }
}

/// It is in the mode of the hold, and the wind takes it.
#[test]
fn a_copter_that_is_blown_away_as_it_holds_is_named_again_and_again() {
    let plan = two();
    let mut sky = sky(&plan);
    let (from, drift_e7) = (Rc::new(Cell::new(None)), 20);
    let switch = change(&mut sky, move |now, message| {
        position(message, |position| {
            let began = from.get().unwrap_or(now);
            from.set(Some(began));
            let ms = i32::try_from(now - began).expect("minutes");
            position.x -= drift_e7 * ms / 100;
        });
    });
    sky.fly_to(50.0);
    sky.fleet.intervene(sky.now, Intervention::Hold);
    switch.set(true);
    sky.fly_to(170.0);
    let said = count(&sky, "alpha", "hold not confirmed");
    assert!((3..=5).contains(&said), "{said}: {:?}", sky.events);
    let far = |event: &&Event| event.text.contains("m from where it was ordered to)");
    assert_eq!(sky.events.iter().filter(far).count(), said);
    assert_eq!(
        count(&sky, "alpha", "corridor alarm: over"),
        0,
        "{:?}",
        sky.events
    );
}

/// A gimbal that uses the component id of the autopilot.
#[test]
fn heartbeats_of_another_device_with_the_id_of_the_autopilot_say_nothing_of_it() {
    let plan = two();
    let mut sky = sky(&plan);
    sky.down = Some(Box::new(|_, from, message| {
        let gimbal = Heartbeat {
            kind: 26,
            autopilot: 8,
            base_mode: 0,
            custom_mode: 0,
            system_status: 4,
        };
        let mut heard = vec![(from, message)];
        if from.system == 1 && matches!(heard[0].1, Message::Heartbeat(_)) {
            heard.extend([0, 1].map(|_| (from, Message::Heartbeat(gimbal))));
        }
        heard
    }));
    assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
    assert_eq!(sky.end(0), End::Landed, "{:?}", sky.events);
    assert!(plan.judge(&sky).passes());
    let alarms = sky.events.iter().filter(|event| event.alarm.is_some());
    assert_eq!(alarms.count(), 0, "{:?}", sky.events);
}

#[test]
fn who_is_not_at_the_height_of_its_home_by_its_position_is_not_started() {
    for (off_mm, what) in [(-24_000, "24 m below"), (36_000, "36 m above")] {
        let plan = two();
        let mut sky = sky(&plan);
        let switch = change(&mut sky, move |_, message| {
            position(message, |position| {
                position.amsl_mm += off_mm;
                position.above_home_mm += off_mm;
            });
        });
        switch.set(true);
        let Outcome::NotStarted(why) = sky.fly_out() else {
            panic!("{:?}", sky.events);
        };
        let text = format!("it is {what} its home by its position");
        assert!(why.iter().any(|(_, of)| of.contains(&text)), "{why:?}");
    }
}

#[test]
fn a_vehicle_that_leaves_its_hold_to_land_by_itself_is_an_alarm_that_names_the_mode() {
    let plan = two();
    let mut sky = sky(&plan);
    sky.fly_to(50.0);
    sky.fleet.intervene(sky.now, Intervention::Hold);
    sky.fly_to(70.0);
    assert!(sky.says("alpha", "holds"), "{:?}", sky.events);
    sky.order(0, Command::NAV_LAND);
    sky.fly_to(74.0);
    let text = "ALARM mode: left its hold for LAND, and is not ordered again";
    assert_eq!(count(&sky, "alpha", text), 1, "{:?}", sky.events);
    assert_eq!(count(&sky, "bravo", "ALARM"), 0, "{:?}", sky.events);
}
