//! What an operator reads is true, whatever a vehicle says of itself.
#![allow(clippy::cast_precision_loss, clippy::cast_possible_truncation)]

use std::cell::Cell;
use std::rc::Rc;

use crate::support::sky::{Planned, Sky, US, lane, plan, plan_spec};
use crate::support::{copter, place, plane, threat};
use sortie::flight::*;
use sortie::geodesy::{Agl, Amsl};
use sortie::link::*;
use sortie::simulator::Fault;
use sortie::spec::{Action, AlarmKind, Answer, OnLinkLoss, Rally, Who};

/// `MAV_MODE_FLAG_SAFETY_ARMED`.
pub(super) const ARMED: u8 = 128;
/// `AUTO` of `ArduCopter`.
const AUTO: u32 = 3;

pub(super) fn two() -> Planned {
    let fleet = vec![lane("alpha", 1, 36.300), lane("bravo", 2, 36.308)];
    plan(fleet, OnLinkLoss::Continue)
}

pub(super) fn sky(plan: &Planned) -> Sky<'_> {
    Sky::new(plan.fleet(false, true), plan.vehicles())
}

fn answer(who: Who, action: Action) -> Option<Answer> {
    Some(Answer { who, action })
}

/// How many lines of a vehicle have a text.
pub(super) fn count(sky: &Sky<'_>, vehicle: &str, text: &str) -> usize {
    let of = sky.events.iter();
    let of = of.filter(|event| event.vehicle.as_deref() == Some(vehicle));
    of.filter(|event| event.text.contains(text)).count()
}

/// The messages of vehicle 1 are changed while a switch is on.
pub(super) fn change(
    sky: &mut Sky<'_>,
    change: impl Fn(Time, &mut Message) + 'static,
) -> Rc<Cell<bool>> {
    let is_on = Rc::new(Cell::new(false));
    let switch = Rc::clone(&is_on);
    sky.down = Some(Box::new(move |now, from, mut message| {
        if from.system == 1 && is_on.get() {
            change(now, &mut message);
        }
        vec![(from, message)]
    }));
    switch
}

fn disarmed(_: Time, message: &mut Message) {
    if let Message::Heartbeat(beat) = message {
        beat.base_mode &= !ARMED;
    }
}

#[test]
fn one_heartbeat_that_shows_it_disarmed_ends_no_flight_and_one_that_flies_on_is_watched_again() {
    let plan = two();
    let mut sky = sky(&plan);
    let switch = change(&mut sky, disarmed);
    sky.fly_to(30.0);
    switch.set(true);
    sky.fly_to(31.0);
    switch.set(false);
    sky.fly_to(35.0);
    assert_eq!(
        count(&sky, "alpha", "stopped its motors"),
        0,
        "{:?}",
        sky.events
    );
    switch.set(true);
    sky.fly_to(39.0);
    switch.set(false);
    sky.fly_to(43.0);
    assert_eq!(
        count(&sky, "alpha", "stopped its motors"),
        1,
        "{:?}",
        sky.events
    );
    assert!(sky.says("alpha", "it is watched again"), "{:?}", sky.events);
    sky.fly_out();
    assert_eq!(sky.end(0), End::Landed, "{:?}", sky.events);
}

#[test]
fn a_vehicle_that_says_that_it_flies_and_stays_on_the_ground_is_late_and_never_left_armed_in_silence()
 {
    let plan = two();
    let mut sky = sky(&plan);
    let switch = change(&mut sky, |_, message| {
        if let Message::Heartbeat(beat) = message {
            (beat.base_mode, beat.custom_mode) = (beat.base_mode | ARMED, AUTO);
        }
    });
    sky.up = Some(Box::new(|_, system, message| {
        let Message::Flight(FlightMessage::Command { target, order }) = message else {
            return None;
        };
        let is_start = system == 1 && order.command == Command::MISSION_START;
        let ack = FlightMessage::CommandAck {
            target: US,
            command: order.command,
            result: CommandResult::ACCEPTED,
        };
        is_start.then(|| vec![(*target, Message::Flight(ack))])
    }));
    sky.fly_to(0.0);
    switch.set(true);
    sky.fly_to(60.0);
    let late = sky.events.iter().find(|event| {
        let is_late = |alarm: &AlarmMark| alarm.kind == AlarmKind::Late && alarm.is_raised;
        event.alarm.as_ref().is_some_and(is_late)
    });
    let late = late.unwrap_or_else(|| panic!("{:?}", sky.events));
    assert!(late.text.contains("has not taken off"), "{late:?}");
    sky.fly_out();
    let said = sky
        .events
        .iter()
        .any(|event| event.text.contains("alpha IS STILL ARMED"));
    assert!(said, "{:?}", sky.events);
    assert_eq!(sky.end(1), End::Landed);
}

#[test]
fn a_vehicle_that_is_started_again_before_t0_starts_nobody() {
    let plan = two();
    let mut sky = sky(&plan);
    let switch = change(&mut sky, |_, message| {
        if let Message::Flight(FlightMessage::Position(position)) = message {
            position.boot_ms = 5;
        }
    });
    // Alpha is ready, and bravo is not heard yet.
    sky.cut.push(2);
    for step in 0..350 {
        switch.set(step > 250);
        sky.step();
    }
    sky.cut.clear();
    let Outcome::NotStarted(why) = sky.fly_out() else {
        panic!("{:?}", sky.events);
    };
    let why = format!("{why:?}");
    assert!(why.contains("was started again"), "{why}");
}

#[test]
fn a_copter_that_sinks_in_the_mode_of_a_hold_is_not_said_to_hold_again_and_again() {
    let plan = two();
    let mut sky = sky(&plan);
    let began = Rc::new(Cell::new(None));
    let switch = change(&mut sky, move |now, message| {
        if let Message::Flight(FlightMessage::Position(position)) = message {
            let since = began.get().unwrap_or(now);
            began.set(Some(since));
            let sunk_mm = (now - since) as i32 / 2;
            position.amsl_mm -= sunk_mm;
            position.above_home_mm -= sunk_mm;
        }
    });
    sky.fly_to(30.0);
    sky.fleet.intervene(sky.now, Intervention::Hold);
    switch.set(true);
    sky.fly_to(130.0);
    assert!(
        sky.says("alpha", "does not hold any more"),
        "{:?}",
        sky.events
    );
    let holds = sky.events.iter().filter(|event| event.text == "holds");
    let of_alpha = holds.filter(|event| event.vehicle.as_deref() == Some("alpha"));
    assert!(of_alpha.count() <= 1, "{:?}", sky.events);
}

#[test]
fn a_position_that_is_frozen_or_does_not_come_is_not_over_before_it_changes() {
    let plan = two();
    let mut frozen = sky(&plan);
    frozen.fly_to(30.0);
    frozen.vehicles[0].fail(Fault::FrozenPosition);
    frozen.fly_out();
    assert_eq!(
        count(&frozen, "alpha", "ALARM position"),
        1,
        "{:?}",
        frozen.events
    );
    assert_eq!(
        count(&frozen, "alpha", "position alarm: over"),
        0,
        "{:?}",
        frozen.events
    );
    let mut silent = sky(&plan);
    silent.fly_to(0.5);
    silent.cut.push(1);
    silent.fly_out();
    assert_eq!(
        count(&silent, "alpha", "position alarm: over"),
        0,
        "{:?}",
        silent.events
    );
}

/// Two whose ways out have crossed, and so their ways home.
fn crossed() -> Planned {
    let mut fleet = vec![
        copter("alpha", 1, place(36.300, -84.262), place(36.300, -84.238)),
        copter("bravo", 2, place(36.2955, -84.255), place(36.3125, -84.255)),
    ];
    fleet[1].depart_s = 40.0;
    for vehicle in &mut fleet {
        vehicle.return_amsl = Some(Amsl(520.0));
    }
    let mut plan = plan(fleet, OnLinkLoss::Continue);
    plan.spec.on_alarm.battery = answer(Who::All, Action::Return);
    plan
}

#[test]
fn of_two_returns_that_would_cross_one_is_ordered_and_the_other_named() {
    let plan = crossed();
    let mut sky = sky(&plan);
    sky.fly_to(101.0);
    sky.vehicles[0].fail(Fault::BatteryDrain { percent_s: 80.0 });
    sky.fly_to(106.0);
    let ordered =
        ["alpha", "bravo"].map(|id| count(&sky, id, "on_alarm battery: is ordered to return"));
    assert_eq!(ordered, [1, 0], "{:?}", sky.events);
    let why = "m of the way on which alpha returns";
    assert!(sky.says("bravo", why), "{:?}", sky.events);
}

#[test]
fn a_return_is_not_ordered_where_the_way_to_a_rally_point_is_not_clear() {
    let mut fleet = vec![lane("alpha", 1, 36.300), lane("bravo", 2, 36.308)];
    fleet[0].return_amsl = Some(Amsl(520.0));
    let mut plan = plan(fleet, OnLinkLoss::Continue);
    plan.spec.on_alarm.battery = answer(Who::Vehicle, Action::Return);
    // South of alpha's way, nearer than its home, behind a threat.
    plan.spec.rally = vec![Rally {
        place: place(36.297, -84.249),
        agl: Agl(60.0),
    }];
    plan.spec.threats = vec![threat("mast", place(36.2993, -84.2497), 60.0)];
    let plan = plan_spec(plan.spec);
    let mut sky = sky(&plan);
    sky.fly_to(78.0);
    sky.vehicles[0].fail(Fault::BatteryDrain { percent_s: 80.0 });
    sky.fly_to(83.0);
    let why = "its way to rally point 1, which it may return to, leads into mast";
    assert!(sky.says("alpha", why), "{:?}", sky.events);
    assert!(
        !sky.says("alpha", "is ordered to return"),
        "{:?}",
        sky.events
    );
}

#[test]
fn a_return_that_ends_at_a_rally_point_says_so_and_its_descent_there_breaks_no_limit() {
    let mut fleet = vec![lane("alpha", 1, 36.300), lane("bravo", 2, 36.308)];
    fleet[0].return_amsl = Some(Amsl(520.0));
    let mut plan = plan(fleet, OnLinkLoss::Continue);
    plan.spec.on_alarm.battery = answer(Who::Vehicle, Action::Return);
    // South of alpha's way, nearer than its home.
    plan.spec.rally = vec![Rally {
        place: place(36.297, -84.249),
        agl: Agl(60.0),
    }];
    let plan = plan_spec(plan.spec);
    let mut sky = sky(&plan);
    sky.fly_to(78.0);
    sky.vehicles[0].fail(Fault::BatteryDrain { percent_s: 80.0 });
    sky.fly_out();
    let report = plan.judge(&sky);
    let ended = "landed at a rally point: it was ordered to return";
    assert!(sky.says("alpha", ended), "{:?}", sky.events);
    assert!(!sky.says("alpha", "clearance alarm"), "{:?}", sky.events);
    let broken: Vec<_> = report.margins.iter().filter(|m| !m.ok).collect();
    assert!(broken.is_empty(), "{broken:?}");
}

#[test]
fn a_vehicle_that_waits_on_the_ground_is_disarmed_where_others_are_held() {
    for action in [Action::Hold, Action::Return, Action::Land] {
        let mut plan = crossed();
        plan.spec.on_alarm.battery = answer(Who::All, action);
        let mut sky = sky(&plan);
        sky.fly_to(25.0);
        sky.vehicles[0].fail(Fault::BatteryDrain { percent_s: 80.0 });
        sky.fly_to(35.0);
        assert!(sky.says("bravo", "stays on the ground"), "{:?}", sky.events);
        assert!(sky.says("bravo", "is disarmed"), "{:?}", sky.events);
    }
}

#[test]
fn a_plane_that_circles_as_ordered_is_said_to_hold_once() {
    let heron = sortie::spec::Vehicle {
        home: place(36.29, -84.30),
        ..plane("heron", 1, place(36.29, -84.28), place(36.29, -84.245))
    };
    let plan = plan(vec![heron], OnLinkLoss::Continue);
    let mut sky = sky(&plan);
    sky.fly_to(90.0);
    sky.fleet.intervene(sky.now, Intervention::Hold);
    sky.fly_to(300.0);
    let holds = sky.events.iter().filter(|event| event.text == "holds");
    assert_eq!(holds.count(), 1, "{:?}", sky.events);
    assert_eq!(count(&sky, "heron", "does not hold"), 0, "{:?}", sky.events);
}

#[test]
fn a_vehicle_that_lands_by_its_mode_and_not_by_its_height_is_named() {
    let plan = two();
    let mut sky = sky(&plan);
    let still = Rc::new(Cell::new(None));
    let switch = change(&mut sky, move |_, message| {
        if let Message::Flight(FlightMessage::Position(position)) = message {
            let height = still
                .get()
                .unwrap_or((position.amsl_mm, position.above_home_mm));
            still.set(Some(height));
            (position.amsl_mm, position.above_home_mm) = height;
        }
    });
    sky.fly_to(30.0);
    switch.set(true);
    sky.fleet.intervene(sky.now, Intervention::Land);
    sky.fly_to(55.0);
    let why = "landing not confirmed: it is in the mode, and has not come down for";
    assert_eq!(count(&sky, "alpha", why), 1, "{:?}", sky.events);
    assert_eq!(count(&sky, "bravo", why), 0, "{:?}", sky.events);
}

#[test]
fn an_autopilot_that_is_started_again_in_the_air_or_whose_clock_jumps_is_named() {
    let plan = two();
    let jumps: [(u32, &str); 3] = [
        (1_000_000, "its clock went on by 1000 s more than it should"),
        (0_u32.wrapping_sub(20_000), "its clock went back by 20 s"),
        (0, "its clock"),
    ];
    for (by_ms, text) in jumps {
        let mut sky = sky(&plan);
        let switch = change(&mut sky, move |_, message| {
            if let Message::Flight(FlightMessage::Position(position)) = message {
                position.boot_ms = position.boot_ms.wrapping_add(by_ms);
            }
        });
        sky.fly_to(60.0);
        switch.set(true);
        sky.fly_to(90.0);
        let times = usize::from(by_ms != 0);
        assert_eq!(count(&sky, "alpha", text), times, "{:?}", sky.events);
        assert_eq!(count(&sky, "bravo", "its clock"), 0, "{:?}", sky.events);
    }
}

#[test]
fn a_mission_of_as_many_items_that_another_station_is_heard_to_write_is_an_alarm() {
    let plan = two();
    for (system, mission_type, alarms) in [(42, 0, 1), (42, 1, 0), (US.system, 0, 0)] {
        let mut sky = sky(&plan);
        let mut is_due = false;
        sky.down = Some(Box::new(move |now, from, message| {
            let is_beat = matches!(message, Message::Heartbeat(_));
            let ack = MissionMessage {
                target: Address {
                    system,
                    component: 190,
                },
                mission_type,
                body: Body::Ack {
                    result: MissionResult::ACCEPTED,
                    opaque_id: 0,
                },
            };
            let says = is_beat && from.system == 1 && !is_due && now > Time(60_000);
            is_due |= says;
            let ack = says.then_some((from, Message::Mission(ack)));
            ack.into_iter().chain([(from, message)]).collect()
        }));
        sky.fly_to(90.0);
        let text = "acknowledged a mission, or that it was cleared, to system 42";
        assert_eq!(count(&sky, "alpha", text), alarms, "{:?}", sky.events);
    }
}

#[test]
fn what_is_wrong_with_a_link_all_the_time_is_said_once() {
    let plan = two();
    let mut sky = sky(&plan);
    sky.fly_to(10.0);
    for _ in 0..20 {
        let now = sky.now;
        sky.fleet
            .trouble(now, Some(1), "speaks from two addresses at once");
        sky.step();
    }
    assert_eq!(count(&sky, "alpha", "two addresses"), 1, "{:?}", sky.events);
}

#[test]
fn a_return_is_not_ordered_where_another_vehicle_rests_on_the_way() {
    use sortie::spec::{EndPoint, Placement, Stop};
    let mut plan = crossed();
    plan.spec.on_alarm.battery = answer(Who::Vehicle, Action::Return);
    // Bravo rests for two minutes on the way on which alpha came, as high as alpha returns.
    let end = EndPoint {
        place: place(36.300, -84.255),
        altitude: Placement::Amsl(Amsl(520.0)),
    };
    plan.spec.vehicles[1].stops = vec![Stop {
        hold_s: 120.0,
        ..Stop::passing("rest", end)
    }];
    plan.spec.vehicles[1].depart_s = 60.0;
    let plan = plan_spec(plan.spec);
    let mut sky = sky(&plan);
    sky.fly_to(120.0);
    sky.vehicles[0].fail(Fault::BatteryDrain { percent_s: 80.0 });
    sky.fly_to(125.0);
    assert!(
        sky.says(
            "alpha",
            "does not return, it continues: its way home comes within"
        ),
        "{:?}",
        sky.events
    );
    assert!(
        !sky.says("alpha", "is ordered to return"),
        "{:?}",
        sky.events
    );
}
