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
use sortie::spec::{AlarmKind, EndPoint, OnLinkLoss, Placement, Stop, Wind, Zone};
use sortie::verify::{Limit, Margin};

/// From some time on the place and altitude of alpha stand still; its height above home sinks by so many mm a second,
/// and its motors stand 20 s later, when it says that it is on the ground or does not.
fn without_a_place(sinks_mm_s: i32, says_grounded: bool) -> (FlightReport, Vec<Event>) {
    let plan = two();
    let mut sky = sky(&plan);
    let (began, last) = (Rc::new(Cell::new(None)), Rc::new(Cell::new(None)));
    let stands = Rc::new(Cell::new(false));
    let stop = Rc::clone(&stands);
    let switch = change(&mut sky, move |now, message| {
        position(message, |position| {
            let since = began.get().unwrap_or(now);
            began.set(Some(since));
            let known = last.get().unwrap_or(*position);
            last.set(Some(known));
            let sunk_mm = i32::try_from(now - since).expect("minutes") / 1000 * sinks_mm_s;
            *position = Position {
                above_home_mm: (known.above_home_mm - sunk_mm).max(0),
                boot_ms: position.boot_ms,
                velocity_cmps: [0, 150, 0],
                ..known
            };
        });
        match message {
            Message::Heartbeat(beat) if stop.get() => beat.base_mode &= !ARMED,
            Message::Flight(FlightMessage::Landed(state)) if says_grounded => {
                *state = LandedState::ON_GROUND
            }
            _ => {}
        }
    });
    sky.fly_to(50.0);
    switch.set(true);
    sky.fly_to(70.0);
    stands.set(true);
    sky.fly_to(76.0);
    (plan.judge(&sky), sky.events)
}

fn says(events: &[Event], text: &str) -> bool {
    let of_alpha = |event: &&Event| event.vehicle.as_deref() == Some("alpha");
    events
        .iter()
        .filter(of_alpha)
        .any(|event| event.text.contains(text))
}

#[test]
fn a_copter_whose_place_stands_still_is_as_high_as_its_height_above_home_says() {
    let (report, landed) = without_a_place(10_000, false);
    let in_air = |event: &&Event| {
        event.text.contains("stopped its motors") && event.text.contains("over the ground")
    };
    assert_eq!(landed.iter().find(in_air), None, "{landed:?}");
    let text = "m from the end of its mission by its last place, of T0+5";
    assert!(says(&landed, text), "{landed:?}");
    let height = report.vehicles[0].altitude_error_m.expect("positions");
    assert!(height.worst > 30.0, "{height:?}");
    let (_, fell) = without_a_place(500, false);
    assert!(fell.iter().any(|event| in_air(&event)), "{fell:?}");
}

#[test]
fn a_height_that_stands_still_as_well_is_not_known_where_it_stops_its_motors() {
    let (_, unknown) = without_a_place(0, false);
    let text = "stopped its motors; its height is not known since T0+5";
    assert!(says(&unknown, text), "{unknown:?}");
    let (_, landed) = without_a_place(0, true);
    assert!(!says(&landed, "its height is not known"), "{landed:?}");
    assert!(says(&landed, "m from the end of its mission"), "{landed:?}");
}

/// The first vehicle flies against a gale from a time on, and is ordered to hold later.
#[test]
fn lateness_of_one_that_never_comes_to_its_next_waypoint_is_that_of_its_alarm() {
    let plan = two();
    let mut sky = sky(&plan);
    sky.fly_to(24.0);
    sky.vehicles[0].fail(Fault::Wind {
        wind: Wind {
            from_rad: 90_f64.to_radians(),
            speed_mps: 14.0,
        },
        airspeed_mps: 17.4,
    });
    sky.fly_to(110.0);
    sky.fleet.intervene(sky.now, Intervention::Hold);
    let status_s = sky.fleet.t_s(sky.now).expect("T0");
    sky.fly_out();
    let report = plan.judge(&sky);
    let latest_s = report.vehicles[0]
        .late_s()
        .fold(f64::NEG_INFINITY, f64::max);
    assert!(
        (35.0..status_s).contains(&latest_s),
        "{latest_s}: {:?}",
        report.vehicles[0]
    );
    let late = sky
        .events
        .iter()
        .find(|event| event.text.contains("ALARM late"));
    assert!(late.is_some(), "{:?}", sky.events);
    // The other one holds at once, and is not late.
    let other_s = report.vehicles[1]
        .late_s()
        .fold(f64::NEG_INFINITY, f64::max);
    assert!(other_s < 15.0, "{other_s}");
}

/// It is set on to a later item, and flies along its path all the same.
#[test]
fn a_waypoint_that_was_flown_over_later_is_not_said_to_be_passed_far_away() {
    let plan = two();
    let mut sky = sky(&plan);
    sky.fly_to(60.0);
    sky.fly_out();
    let mut record = plan.record(&sky);
    let items = plan.dispatched.missions[0].1.items.len();
    for fix in &mut record.flights[0].flown.fixes {
        if fix.t_s > 20.0 {
            fix.item = fix.item.max(items - 1);
        }
    }
    let report = judge(&plan.spec, &plan.world, &record);
    let missed: Vec<_> = report
        .margins
        .iter()
        .filter(|of| !of.ok && of.note.contains("passed"))
        .collect();
    assert!(!missed.is_empty(), "{:?}", report.margins);
    for of in missed {
        assert!(
            of.note
                .contains("m away in its turn, and 0 m away on the way to item"),
            "{of:?}"
        );
    }
}

/// A stop of 30 s with 5 m, at which the vehicle stays so many metres beside by its positions.
#[test]
fn a_stop_that_it_makes_farther_away_than_planned_is_missed() {
    let end = EndPoint {
        place: place(36.302, -84.254),
        altitude: Placement::Agl(Agl(80.0)),
    };
    let mut alpha = lane("alpha", 1, 36.30);
    alpha.stops = vec![Stop {
        hold_s: 30.0,
        acceptance_radius_m: Some(5.0),
        ..Stop::passing("mast", end)
    }];
    let plan = plan(vec![alpha], OnLinkLoss::Continue);
    for (beside_m, is_done) in [(0, true), (4, true), (20, false)] {
        let mut sky = sky(&plan);
        let switch = change(&mut sky, move |_, message| {
            position(message, |position| position.x += beside_m * 90);
        });
        sky.fly_to(30.0);
        switch.set(true);
        assert_eq!(sky.fly_out(), Outcome::Flown);
        assert_eq!(
            sky.says("alpha", "stop mast done"),
            is_done,
            "{:?}",
            sky.events
        );
        let text = "m (at most 5 m)";
        assert_eq!(sky.says("alpha", text), !is_done, "{:?}", sky.events);
        let report = plan.judge(&sky);
        let state = report.vehicles[0].served[0].state;
        let expected = if is_done {
            ServiceState::Done
        } else {
            ServiceState::Missed
        };
        assert_eq!(state, expected, "{beside_m} m");
    }
}

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

/// It lies on the ground and refuses to stop its motors.
#[test]
fn positions_of_one_that_does_not_stop_its_motors_are_recorded_until_it_is_given_up() {
    let plan = two();
    let mut sky = sky(&plan);
    let switch = change(&mut sky, |now, message| {
        position(message, |position| {
            (position.x, position.y) = (363_010_000 + (now.0 / 100 % 7) as i32, -842_540_000);
            (position.amsl_mm, position.above_home_mm) = (400_300, 300);
            position.velocity_cmps = [0, 0, 0];
        });
        if let Message::Heartbeat(beat) = message {
            beat.base_mode |= ARMED;
        }
    });
    sky.fly_to(50.0);
    switch.set(true);
    sky.up = Some(Box::new(|_, system, message| {
        let Message::Flight(FlightMessage::Command { target, order }) = message else {
            return None;
        };
        let ack = FlightMessage::CommandAck {
            target: US,
            command: order.command,
            result: CommandResult::FAILED,
        };
        let is_disarm = system == 1 && order.command == Command::COMPONENT_ARM_DISARM;
        is_disarm.then(|| vec![(*target, Message::Flight(ack))])
    }));
    sky.fly_out();
    let is_armed = |event: &Event| event.text.contains("alpha IS STILL ARMED");
    assert!(sky.events.iter().any(is_armed), "{:?}", sky.events);
    let report = plan.judge(&sky);
    let gap = report
        .margins
        .iter()
        .find(|of| of.vehicle == "alpha" && of.limit.to_string().contains("without a position"));
    assert!(
        gap.is_some_and(|gap| gap.ok),
        "{gap:?}: {:?}",
        report.margins
    );
}

#[test]
fn a_zone_that_is_crossed_between_two_positions_is_entered() {
    for (east_m, is_crossed) in [(0.0, true), (3000.0, false)] {
        let plan = two();
        let mut sky = sky(&plan);
        let west_deg = -84.2540;
        // Nothing is heard of where it is from before the zone until it is behind it.
        sky.down = Some(Box::new(move |_, from, message| {
            let is_in = match &message {
                Message::Flight(FlightMessage::Position(position)) if from.system == 1 => {
                    let east_m = (f64::from(position.y) / 1e7 - west_deg) * 89_800.0;
                    (-8.0..32.0).contains(&east_m)
                }
                _ => false,
            };
            if is_in {
                Vec::new()
            } else {
                vec![(from, message)]
            }
        }));
        assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
        let shift_deg = east_m / 89_800.0;
        let corner =
            |lat_deg: f64, east_m: f64| place(lat_deg, west_deg + shift_deg + east_m / 89_800.0);
        let corners = vec![
            corner(36.2990, 0.0),
            corner(36.2990, 24.0),
            corner(36.3030, 24.0),
            corner(36.3030, 0.0),
        ];
        let mut spec = plan.spec.clone();
        spec.no_fly = vec![Zone::closed("yard".to_owned(), corners)];
        let report = judge(&spec, &plan.world, &plan.record(&sky));
        let mut margins = report.margins.iter();
        let yard = Limit::Zone("yard".to_owned());
        let of = |margin: &&Margin| margin.vehicle == "alpha" && margin.limit == yard;
        let margin = margins.find(of).expect("judged");
        assert_eq!(margin.ok, !is_crossed, "{margin:?}");
    }
}
