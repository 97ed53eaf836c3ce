//! Orders that are obeyed, left or withdrawn, and ends of flights: what an operator reads of them is true.
#![allow(clippy::cast_precision_loss, clippy::cast_possible_truncation)]

use std::cell::Cell;
use std::rc::Rc;

use super::flight_truth::{ARMED, change, count, sky, two};
use crate::support::sky::{Planned, US, lane, plan, plan_spec};
use crate::support::{place, plane, threat};
use sortie::flight::*;
use sortie::geodesy::Amsl;
use sortie::link::*;
use sortie::simulator::Fault;
use sortie::spec::{Action, AlarmKind, Answer, Autopilot, Finish, OnLinkLoss, Who};
use sortie::verify::Limit;

/// Modes of `ArduCopter`.
const GUIDED: u32 = 4;
const LOITER: u32 = 5;
const LAND: u32 = 9;

fn returns(plan: &mut Planned) {
    let (who, action) = (Who::Vehicle, Action::Return);
    plan.spec.on_alarm.battery = Some(Answer { who, action });
    plan.spec.vehicles[0].return_amsl = Some(Amsl(520.0));
}

fn beat(message: &mut Message, change: impl Fn(&mut Heartbeat)) {
    if let Message::Heartbeat(beat) = message {
        change(beat);
    }
}

pub(super) fn position(message: &mut Message, change: impl Fn(&mut Position)) {
    if let Message::Flight(FlightMessage::Position(position)) = message {
        change(position);
    }
}

#[test]
fn motors_that_stop_high_over_the_ground_did_not_land() {
    for order in [None, Some(Intervention::Land)] {
        let plan = two();
        let mut sky = sky(&plan);
        let switch = change(&mut sky, |_, message| {
            beat(message, |beat| beat.base_mode &= !ARMED);
        });
        sky.fly_to(50.0);
        if let Some(order) = order {
            sky.fleet.intervene(sky.now, order);
            sky.fly_to(55.0);
        }
        switch.set(true);
        sky.fly_to(60.0);
        let text = "m over the ground";
        assert_eq!(count(&sky, "alpha", text), 1, "{:?}", sky.events);
        assert_eq!(count(&sky, "alpha", "landed"), 0, "{:?}", sky.events);
    }
}

#[test]
fn a_vehicle_that_loiters_at_its_end_is_watched_as_long_as_another_flies() {
    let mut fleet = vec![lane("alpha", 1, 36.300), lane("bravo", 2, 36.308)];
    fleet[0].finish = Finish::Loiter;
    fleet[1].goal.place = place(36.310, -84.236);
    let plan = plan(fleet, OnLinkLoss::Continue);
    let mut sky = sky(&plan);
    while !sky.says("alpha", "loiters at the end of its mission") {
        sky.step();
        assert!(sky.now.0 < 600_000, "{:?}", sky.events);
    }
    sky.vehicles[0].fail(Fault::BatteryDrain { percent_s: 80.0 });
    assert_eq!(sky.fly_out(), Outcome::Flown);
    assert_eq!(count(&sky, "alpha", "ALARM battery"), 1, "{:?}", sky.events);
    assert_eq!(count(&sky, "alpha", "loiters"), 1, "{:?}", sky.events);
    assert_eq!(sky.end(0), End::Loitering);
    let report = plan.judge(&sky);
    let broken: Vec<_> = report.margins.iter().filter(|m| !m.ok).collect();
    assert!(broken.is_empty(), "{broken:?}");
}

#[test]
fn a_vehicle_that_is_ordered_away_from_its_end_does_not_loiter_there() {
    let mut fleet = vec![lane("alpha", 1, 36.300), lane("bravo", 2, 36.308)];
    fleet[0].finish = Finish::Loiter;
    fleet[1].goal.place = place(36.310, -84.236);
    let mut plan = plan(fleet, OnLinkLoss::Continue);
    returns(&mut plan);
    let mut sky = sky(&plan);
    while !sky.says("alpha", "loiters at the end of its mission") {
        sky.step();
        assert!(sky.now.0 < 600_000, "{:?}", sky.events);
    }
    // It does not hear the order, and stays in the air.
    sky.up = Some(Box::new(|_, system, message| {
        let is_order = matches!(message, Message::Flight(FlightMessage::Command { .. }));
        (system == 1 && is_order).then(Vec::new)
    }));
    sky.vehicles[0].fail(Fault::BatteryDrain { percent_s: 80.0 });
    assert_eq!(sky.fly_out(), Outcome::Flown);
    assert!(
        sky.says("alpha", "is ordered to return"),
        "{:?}",
        sky.events
    );
    assert!(matches!(sky.end(0), End::Failed(_)), "{:?}", sky.events);
}

#[test]
fn an_ordered_landing_breaks_no_clearance() {
    let plan = two();
    let mut sky = sky(&plan);
    sky.fly_to(60.0);
    sky.fleet.intervene(sky.now, Intervention::Land);
    assert_eq!(sky.fly_out(), Outcome::Flown);
    for (index, id) in ["alpha", "bravo"].into_iter().enumerate() {
        assert_eq!(sky.end(index), End::LandedEarly, "{:?}", sky.events);
        assert_eq!(count(&sky, id, "ALARM clearance"), 0, "{:?}", sky.events);
    }
    let report = plan.judge(&sky);
    let clearance = |of: &&sortie::verify::Margin| of.limit == Limit::TerrainClearance;
    let clearances: Vec<_> = report.margins.iter().filter(clearance).collect();
    assert!(
        clearances.len() == 2 && clearances.iter().all(|of| of.ok),
        "{clearances:?}"
    );
}

#[test]
fn motors_that_run_on_after_a_landing_are_named_and_stopped_at_the_end() {
    let plan = two();
    let mut sky = sky(&plan);
    let switch = change(&mut sky, |_, message| {
        beat(message, |beat| beat.base_mode |= ARMED);
    });
    sky.fly_to(60.0);
    switch.set(true);
    assert_eq!(sky.fly_out(), Outcome::Flown);
    let text = "is on the ground, and its motors run on";
    assert_eq!(count(&sky, "alpha", text), 1, "{:?}", sky.events);
    assert_eq!(count(&sky, "bravo", text), 0, "{:?}", sky.events);
    let armed = |event: &Event| event.text.contains("alpha IS STILL ARMED");
    assert!(sky.events.iter().any(armed), "{:?}", sky.events);
}

#[test]
fn each_change_of_the_mode_is_an_alarm_of_its_own() {
    let plan = two();
    let mut sky = sky(&plan);
    let mode = Rc::new(Cell::new(LOITER));
    let is = Rc::clone(&mode);
    let switch = change(&mut sky, move |_, message| {
        beat(message, |beat| beat.custom_mode = is.get());
    });
    sky.fly_to(40.0);
    switch.set(true);
    sky.fly_to(50.0);
    mode.set(LAND);
    sky.fly_to(60.0);
    for name in ["LOITER", "LAND"] {
        let text = format!("ALARM mode: left its mission for {name}");
        assert_eq!(count(&sky, "alpha", &text), 1, "{:?}", sky.events);
    }
}

#[test]
fn a_clock_that_goes_back_by_seconds_hides_no_position() {
    let plan = two();
    let mut sky = sky(&plan);
    let switch = change(&mut sky, |_, message| {
        position(message, |of| of.boot_ms -= 6000);
    });
    sky.fly_to(50.0);
    switch.set(true);
    assert_eq!(sky.fly_out(), Outcome::Flown);
    let text = "its clock went back by 6 s";
    assert_eq!(count(&sky, "alpha", text), 1, "{:?}", sky.events);
    assert_eq!(count(&sky, "alpha", "ALARM"), 0, "{:?}", sky.events);
    let report = plan.judge(&sky);
    let broken: Vec<_> = report.margins.iter().filter(|m| !m.ok).collect();
    assert!(broken.is_empty(), "{broken:?}");
}

#[test]
fn positions_that_come_late_are_an_alarm_as_long_as_they_do() {
    let plan = two();
    let mut sky = sky(&plan);
    let mut late: Vec<(Time, Address, Message)> = Vec::new();
    sky.down = Some(Box::new(move |now, from, message| {
        if from.system != 1 || now < Time(60_000) || now > Time(72_000) {
            return vec![(from, message)];
        }
        late.push((now + 4000, from, message));
        let due = late.iter().take_while(|(at, ..)| *at <= now).count();
        late.drain(..due)
            .map(|(_, from, message)| (from, message))
            .collect()
    }));
    sky.fly_to(68.0);
    let text = "ALARM position: positions come 4.";
    assert_eq!(count(&sky, "alpha", text), 1, "{:?}", sky.events);
    assert_eq!(count(&sky, "bravo", "ALARM"), 0, "{:?}", sky.events);
}

#[test]
fn nobody_is_started_when_a_mission_on_board_has_changed_after_it_was_read() {
    let plan = two();
    let mut sky = sky(&plan);
    let is_ready = Rc::new(Cell::new(false));
    let ready = Rc::clone(&is_ready);
    sky.down = Some(Box::new(move |_, from, mut message| {
        match &mut message {
            Message::MissionCurrent { total, .. } if from.system == 1 && ready.get() => {
                *total += 2;
            }
            // It does not arm for a while.
            Message::Heartbeat(beat) if from.system == 2 => beat.base_mode &= !ARMED,
            _ => {}
        }
        vec![(from, message)]
    }));
    while sky.fleet.outcome().is_none() {
        assert!(sky.now.0 < 600_000, "{:?}", sky.events);
        sky.step();
        is_ready.set(sky.events.iter().any(|event| event.text == "all are ready"));
    }
    let outcome = sky.fly_out();
    let Outcome::NotStarted(why) = &outcome else {
        panic!("{outcome:?}")
    };
    let changed = |(id, why): &(String, String)| {
        id == "alpha" && why.contains("was changed on board after it was read")
    };
    assert!(why.iter().any(changed), "{why:?}");
}

#[test]
fn a_vehicle_with_a_wrong_height_above_home_is_in_the_air_and_not_disarmed() {
    let mut plan = two();
    let (who, action) = (Who::All, Action::Hold);
    plan.spec.on_alarm.battery = Some(Answer { who, action });
    let mut sky = sky(&plan);
    let switch = change(&mut sky, |_, message| {
        position(message, |of| of.above_home_mm = 0);
    });
    switch.set(true);
    sky.fly_to(60.0);
    sky.vehicles[0].fail(Fault::BatteryDrain { percent_s: 80.0 });
    sky.fly_to(80.0);
    assert!(sky.says("alpha", "is ordered to hold"), "{:?}", sky.events);
    assert_eq!(count(&sky, "alpha", "stays on the ground"), 0);
    assert_eq!(count(&sky, "alpha", "has not taken off"), 0);
    assert!(sky.says("alpha", "holds"), "{:?}", sky.events);
}

#[test]
fn a_return_that_was_not_heard_is_judged_again_where_the_vehicle_is_by_then() {
    let mut plan = two();
    returns(&mut plan);
    // It flies around it; its way home leads through it afterwards.
    plan.spec.threats = vec![threat("mast", place(36.3010, -84.2545), 60.0)];
    let plan = plan_spec(plan.spec);
    let mut sky = sky(&plan);
    let is_deaf = Rc::new(Cell::new(false));
    let deaf = Rc::clone(&is_deaf);
    sky.up = Some(Box::new(move |_, system, message| {
        let is_order = matches!(message, Message::Flight(FlightMessage::Command { .. }));
        (system == 1 && deaf.get() && is_order).then(Vec::new)
    }));
    sky.fly_to(30.0);
    is_deaf.set(true);
    sky.vehicles[0].fail(Fault::BatteryDrain { percent_s: 80.0 });
    sky.fly_to(35.0);
    assert!(
        sky.says("alpha", "is ordered to return"),
        "{:?}",
        sky.events
    );
    sky.fly_to(70.0);
    is_deaf.set(false);
    sky.fly_to(78.0);
    let text = "is not ordered to return any more, it continues: its way home leads into mast";
    assert_eq!(count(&sky, "alpha", text), 1, "{:?}", sky.events);
    assert_eq!(count(&sky, "alpha", "ALARM threat"), 0, "{:?}", sky.events);
    let alpha = sky.fleet.status(sky.now);
    assert_eq!(alpha[0].mode.as_deref(), Some("AUTO"), "{:?}", sky.events);
}

/// When a vehicle that does not return is ordered to, and when it is not any more, seconds after T0; its battery is
/// empty from some time on, and it may accept the order all the same.
fn ordered_and_withdrawn_s(drains_s: f64, accepts: bool) -> [f64; 2] {
    let mut plan = two();
    returns(&mut plan);
    plan.spec.threats = vec![threat("mast", place(36.3010, -84.2545), 60.0)];
    let plan = plan_spec(plan.spec);
    let mut sky = sky(&plan);
    sky.up = Some(Box::new(move |_, system, message| {
        let Message::Flight(FlightMessage::Command { target, order }) = message else {
            return None;
        };
        let is_mode =
            system == 1 && order.command == 176 && order.params[1].to_bits() == 6.0_f32.to_bits();
        let ack = FlightMessage::CommandAck {
            target: US,
            command: order.command,
            result: CommandResult::ACCEPTED,
        };
        let answers = accepts.then_some((*target, Message::Flight(ack)));
        is_mode.then(|| answers.into_iter().collect())
    }));
    sky.fly_to(drains_s);
    sky.vehicles[0].fail(Fault::BatteryDrain { percent_s: 80.0 });
    let texts = ["is ordered to return", "is not ordered to return any more"];
    texts.map(|text| {
        while !sky.says("alpha", text) {
            assert!(sky.fleet.outcome().is_none(), "{:?}", sky.events);
            sky.step();
        }
        sky.fleet.t_s(sky.now).expect("it flies")
    })
}

#[test]
fn a_return_that_was_accepted_a_moment_ago_is_not_withdrawn() {
    let [ordered_s, withdrawn_s] = ordered_and_withdrawn_s(30.0, false);
    // One second before its way home leads through a threat.
    let drains_s = withdrawn_s - (ordered_s - 30.0) - 1.0;
    let [ordered_s, withdrawn_s] = ordered_and_withdrawn_s(drains_s, false);
    assert!(withdrawn_s - ordered_s < 2.0, "{ordered_s} {withdrawn_s}");
    let [ordered_s, withdrawn_s] = ordered_and_withdrawn_s(drains_s, true);
    let after_s = withdrawn_s - ordered_s;
    // It does not obey, and is judged again then.
    assert!((2.9..5.0).contains(&after_s), "{after_s}");
}

#[test]
fn a_vehicle_that_leaves_its_return_for_another_mode_is_an_alarm() {
    let mut plan = two();
    returns(&mut plan);
    let mut sky = sky(&plan);
    let switch = change(&mut sky, |_, message| {
        beat(message, |beat| beat.custom_mode = GUIDED);
    });
    sky.fly_to(40.0);
    sky.vehicles[0].fail(Fault::BatteryDrain { percent_s: 80.0 });
    sky.fly_to(50.0);
    assert!(
        sky.says("alpha", "is ordered to return"),
        "{:?}",
        sky.events
    );
    switch.set(true);
    sky.fly_to(60.0);
    let text = "ALARM mode: left its return for GUIDED";
    assert_eq!(count(&sky, "alpha", text), 1, "{:?}", sky.events);
    let kinds = sky.fleet.status(sky.now)[0].alarms.clone();
    assert!(kinds.contains(&AlarmKind::Battery), "{kinds:?}");
}

#[test]
fn a_plane_of_px4_that_was_started_a_moment_ago_is_waited_for() {
    let mut spec = plane("alpha", 1, place(36.30, -84.27), place(36.30, -84.23));
    spec.autopilot = Autopilot::Px4;
    spec.finish = Finish::Loiter;
    if let Some(wing) = &mut spec.wing {
        wing.landing = None;
    }
    spec.speed_mps = 18.0;
    let plan = plan(vec![spec], OnLinkLoss::Continue);
    let mut sky = sky(&plan);
    // It has been running for an hour.
    let switch = change(&mut sky, |_, message| {
        position(message, |of| of.boot_ms -= 3_600_000);
    });
    switch.set(true);
    sky.fly_to(0.5);
    let text = "was started too short a time ago, and would sink after its takeoff";
    assert_eq!(count(&sky, "alpha", text), 1, "{:?}", sky.events);
    // Its home is at 400 m, and it climbs at 5 m/s at most.
    assert!(sky.now > Time(90_000), "{:?}", sky.now);
}

#[test]
fn the_page_says_how_a_flight_ended_in_the_words_of_the_table() {
    for (order, words) in [
        (Intervention::Land, "landed early"),
        (Intervention::Leave, "left flying"),
    ] {
        let plan = two();
        let mut sky = sky(&plan);
        sky.fly_to(60.0);
        sky.fleet.intervene(sky.now, order);
        assert_eq!(sky.fly_out(), Outcome::Flown);
        let (record, judged) = (plan.record(&sky), plan.judge(&sky));
        assert_eq!(judged.vehicles[0].end, words);
        let missions = plan.dispatched.missions.iter();
        let missions: Vec<_> = missions.map(|(index, of)| (*index, of)).collect();
        let page = flight_page(&plan.spec, &plan.world, &record, &judged, &missions);
        let cards = page.split("class=\"card bad\"").skip(1);
        let end = cards.filter(|card| card.contains("end of the flight"));
        let end: Vec<&str> = end
            .filter_map(|card| card.split("</button>").next())
            .collect();
        assert!(!end.is_empty(), "{words}");
        for card in end {
            let value = format!("<span class=\"value words\">{words}</span>");
            assert!(
                card.contains(&value) && !card.contains("not known"),
                "{card}"
            );
        }
    }
}

#[test]
fn nothing_is_assumed_of_a_time_without_positions_and_that_time_fails() {
    let mut plan = two();
    let mast = place(36.3010, -84.2545);
    plan.spec.threats = vec![threat("mast", mast, 60.0)];
    let plan = plan_spec(plan.spec);
    let mut sky = sky(&plan);
    assert_eq!(sky.fly_out(), Outcome::Flown);
    let whole = plan.record(&sky);
    let margin = |record: &Record, limit: Limit| {
        let margins = judge(&plan.spec, &plan.world, record).margins;
        let of = |of: &&sortie::verify::Margin| of.vehicle == "alpha" && of.limit == limit;
        margins.iter().find(of).cloned().expect("judged")
    };
    let threat = Limit::Threat("mast".to_owned());
    let gap = Limit::Flown(sortie::verify::Flown::Gap);
    assert!(margin(&whole, threat.clone()).ok && margin(&whole, gap.clone()).ok);
    // The way around it was not recorded.
    let mut record = whole.clone();
    let fixes = &mut record.flights[0].flown.fixes;
    fixes.retain(|fix| fix.place.chord_m(mast) > 250.0);
    let found = margin(&record, threat);
    assert!(found.ok && found.value > 180.0, "{found:?}");
    assert!(!margin(&record, gap.clone()).ok);
    // Bravo, where alpha would be on a straight way between two positions.
    let mut record = whole.clone();
    let fixes = &mut record.flights[0].flown.fixes;
    fixes.retain(|fix| !(40.0..60.0).contains(&fix.t_s));
    let after = fixes
        .iter()
        .position(|fix| fix.t_s >= 60.0)
        .expect("it flies");
    let (from, to) = (fixes[after - 1], fixes[after]);
    let middle_s = 0.5 * (from.t_s + to.t_s);
    for fix in &mut record.flights[1].flown.fixes {
        if (fix.t_s - middle_s).abs() < 2.0 {
            let middle = |a: f64, b: f64| 0.5 * (a + b);
            fix.place.lat_deg = middle(from.place.lat_deg, to.place.lat_deg);
            fix.place.lon_deg = middle(from.place.lon_deg, to.place.lon_deg);
        }
    }
    let found = margin(&record, Limit::Separation);
    assert!(found.ok, "{found:?}");
    assert!(!margin(&record, gap).ok);
}
