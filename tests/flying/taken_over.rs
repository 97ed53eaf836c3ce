//! A flight that is taken over from its record: nothing that was sent or ordered is lost.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss
)]

use std::collections::BTreeMap;

use super::flight_truth::{count, sky, two};
use crate::support::place;
use crate::support::sky::{Planned, Sky, US, lane, plan};
use sortie::flight::*;
use sortie::link::*;
use sortie::spec::{Action, OnLinkLoss};

/// Milliseconds since 1970 at T0.
const T0_MS: u64 = 1_700_000_000_000;

/// The ground station is killed, and another one takes over by the record and these lines.
fn take_over<'a>(plan: &'a Planned, sky: &mut Sky<'a>, more: &[Line]) {
    take_over_of(plan, sky, more, BTreeMap::new());
}

/// The same of vehicles some of which had `ended`.
fn take_over_of<'a>(
    plan: &'a Planned,
    sky: &mut Sky<'a>,
    more: &[Line],
    ended: BTreeMap<String, Ended>,
) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let record = plan.record(sky);
    let t_s = sky.fleet.t_s(sky.now).expect("T0");
    let ids = record.flights.iter().map(|of| of.vehicle.clone());
    let head = Line::Head {
        sortie: "0".to_owned(),
        spec_sha256: String::new(),
        speedup: 1.0,
        vehicles: ids.collect(),
    };
    let t0_unix_s = T0_MS / 1000;
    let mut lines = vec![head.text(), Line::Start { t0_unix_s }.text()];
    for flight in &record.flights {
        let vehicle = &flight.vehicle;
        lines.push(Line::of_plan(vehicle, 0.0, &flight.plans[0]).text());
        let fixes = flight.flown.fixes.iter();
        lines.extend(fixes.map(|fix| Line::of_fix(vehicle, fix).text()));
    }
    lines.extend(more.iter().map(Line::text));
    let name = "flight-1.jsonl";
    std::fs::write(folder.path().join(name), lines.join("\n") + "\n").expect("written");
    let mut handoff = FlightHandoff::new(folder.path().to_owned(), BTreeMap::new(), 1.0);
    handoff.notice.record = name.to_owned();
    handoff.notice.t0_unix_ms = Some(T0_MS);
    handoff.notice.ended = ended;
    let frame = plan.world.frame;
    let flight = Interrupted::find(folder.path(), &handoff, frame).expect("a record");
    let itineraries = plan.itineraries();
    let missions = plan.dispatched.missions.iter().zip(plan.references());
    let assignments = missions
        .enumerate()
        .map(|(link, ((index, mission), reference))| Assignment {
            vehicle: &plan.spec.vehicles[*index].id,
            sysid: plan.spec.vehicles[*index].sysid,
            link,
            mission,
            reference,
            start_s: 0.0,
            upload: false,
            itinerary: itineraries[*index].clone(),
        });
    let at = (sky.now, T0_MS + (1000.0 * t_s) as u64);
    let options = plan.options(false);
    let fleet = Fleet::take_over(assignments.collect(), options, US, at, &flight);
    sky.fleet = fleet.watched(&plan.spec, &plan.world);
    sky.events.clear();
}

#[test]
fn a_vehicle_that_sends_heartbeats_and_no_position_is_watched_and_takes_orders() {
    let plan = two();
    let mut sky = sky(&plan);
    sky.fly_to(40.0);
    take_over(&plan, &mut sky, &[]);
    sky.down = Some(Box::new(|_, from, message| {
        let is_position = matches!(message, Message::Flight(FlightMessage::Position(_)));
        match from.system == 1 && is_position {
            true => Vec::new(),
            false => vec![(from, message)],
        }
    }));
    sky.fly_to(48.0);
    let stale = count(&sky, "alpha", "ALARM position: no position for");
    assert_eq!(stale, 1, "{:?}", sky.events);
    sky.fleet.intervene(sky.now, Intervention::Hold);
    sky.fly_to(52.0);
    let status = sky.fleet.status(sky.now);
    assert_eq!(status[0].mode.as_deref(), Some("BRAKE"), "{status:?}");
}

#[test]
fn an_order_of_the_record_that_the_mode_does_not_show_is_given_again() {
    let plan = two();
    let mut sky = sky(&plan);
    sky.fly_to(40.0);
    let order = Line::Order {
        t_s: 39.0,
        vehicle: "alpha".to_owned(),
        order: Action::Hold,
    };
    take_over(&plan, &mut sky, &[order]);
    sky.fly_to(60.0);
    let text = "although it was ordered to hold, which is ordered again";
    assert_eq!(count(&sky, "alpha", text), 1, "{:?}", sky.events);
    assert_eq!(count(&sky, "alpha", "holds"), 1, "{:?}", sky.events);
    assert_eq!(count(&sky, "bravo", "hold"), 0, "{:?}", sky.events);
}

#[test]
fn a_plan_that_was_sent_before_the_end_of_the_record_is_known() {
    let plan = two();
    let mut sky = sky(&plan);
    sky.fly_to(40.0);
    let mut next = plan.record(&sky).flights[0].plans[0].clone();
    let held = next.items;
    next.items += 2;
    let line = Line::of_plan("alpha", 39.0, &next);
    take_over(&plan, &mut sky, &[line]);
    // It takes the new one up later.
    let until = sky.now + 5000;
    sky.down = Some(Box::new(move |now, from, mut message| {
        if let Message::MissionCurrent { total, .. } = &mut message
            && from.system == 1
            && now > until
        {
            *total += 2;
        }
        vec![(from, message)]
    }));
    sky.fly_to(60.0);
    let status = sky.fleet.status(sky.now);
    assert_eq!(count(&sky, "alpha", "ALARM mission"), 0, "{:?}", sky.events);
    assert!(held > 0 && !status.is_empty(), "{status:?}");
}

#[test]
fn a_plan_that_was_sent_before_the_end_of_the_record_and_never_comes_is_named() {
    let plan = two();
    let mut sky = sky(&plan);
    sky.fly_to(40.0);
    let mut next = plan.record(&sky).flights[0].plans[0].clone();
    next.items += 2;
    let line = Line::of_plan("alpha", 39.0, &next);
    take_over(&plan, &mut sky, &[line]);
    assert_eq!(sky.fly_out(), Outcome::Flown);
    let text = "does not hold the plan that replan sent at T0+39 s: it flies the one before";
    assert_eq!(count(&sky, "alpha", text), 1, "{:?}", sky.events);
    assert_eq!(count(&sky, "bravo", "does not hold"), 0, "{:?}", sky.events);
    assert_eq!(sky.end(0), End::Landed, "{:?}", sky.events);
}

/// Nobody watches for this number of seconds.
fn pass(sky: &mut Sky<'_>, seconds: u64) {
    for _ in 0..50 * seconds {
        sky.now = sky.now + 20;
        for vehicle in &mut sky.vehicles {
            vehicle.handle_timeout(sky.now);
            while vehicle.poll_transmit().is_some() {}
        }
    }
}

#[test]
fn a_flight_that_is_taken_over_after_its_time_is_given_up_by_nobody_before_it_was_heard() {
    for holds in [true, false] {
        let plan = two();
        let mut sky = sky(&plan);
        sky.fly_to(40.0);
        if holds {
            sky.fleet.intervene(sky.now, Intervention::Hold);
            sky.fly_to(60.0);
        }
        let ends_s = plan.references()[0].end_s;
        let limit_s = 1.25 * ends_s + 90.0;
        pass(&mut sky, limit_s as u64);
        take_over(&plan, &mut sky, &[]);
        let begin = sky.now;
        while sky.now < begin + 8000 && sky.fleet.outcome().is_none() {
            sky.step();
        }
        for id in ["alpha", "bravo"] {
            let given_up = count(&sky, id, "has not ended its flight");
            assert_eq!(given_up, 0, "{:?}", sky.events);
            let text = if holds {
                "is watched again"
            } else {
                "came down while nobody watched"
            };
            assert_eq!(count(&sky, id, text), 1, "{:?}", sky.events);
        }
        assert_eq!(sky.fleet.outcome().is_none(), holds, "{:?}", sky.events);
    }
}

#[test]
fn who_is_not_heard_after_a_takeover_is_said_to_be_unknown_and_can_be_taken_over_again() {
    let plan = two();
    let mut sky = sky(&plan);
    sky.fly_to(40.0);
    take_over(&plan, &mut sky, &[]);
    sky.cut = vec![1, 2];
    assert_eq!(sky.fly_out(), Outcome::Flown);
    for id in ["alpha", "bravo"] {
        let text = "was not heard since the flight was taken over";
        assert_eq!(count(&sky, id, text), 1, "{:?}", sky.events);
    }
    assert_eq!(sky.fleet.unheard(), ["alpha", "bravo"]);
    assert!(sky.fleet.ended().is_empty());
}

#[test]
fn who_had_landed_before_a_takeover_and_is_switched_off_is_not_waited_for() {
    let mut fleet = vec![lane("alpha", 1, 36.300), lane("bravo", 2, 36.308)];
    fleet[1].goal.place = place(36.310, -84.236);
    let plan = plan(fleet, OnLinkLoss::Continue);
    let mut sky = sky(&plan);
    while !sky.says("alpha", "landed, motors stopped") {
        sky.step();
        assert!(sky.now.0 < 600_000, "{:?}", sky.events);
    }
    let ended = sky.fleet.ended();
    assert_eq!(ended.len(), 1, "{ended:?}");
    assert_eq!(ended["alpha"].end, "landed", "{ended:?}");
    take_over_of(&plan, &mut sky, &[], ended);
    sky.cut = vec![1];
    assert_eq!(sky.fly_out(), Outcome::Flown);
    assert_eq!(sky.end(0), End::Landed, "{:?}", sky.events);
    assert_eq!(sky.end(1), End::Landed, "{:?}", sky.events);
    assert!(
        sky.says("alpha", "its flight is over: landed"),
        "{:?}",
        sky.events
    );
    assert_eq!(count(&sky, "alpha", "ALARM"), 0, "{:?}", sky.events);
}
