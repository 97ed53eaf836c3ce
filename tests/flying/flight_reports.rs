//! Reports and texts of vehicles that stop, come in pieces, or say that a mission goes on elsewhere.

use std::cell::Cell;
use std::rc::Rc;

use super::flight_truth::{count, sky, two};
use crate::support::sky::{Sky, US, lane, plan};
use sortie::flight::*;
use sortie::link::*;
use sortie::spec::{Action, Answer, OnLinkLoss, Who};

/// Reports of its health by vehicle 1 are lost while a switch is on.
fn lose_health(sky: &mut Sky<'_>) -> Rc<Cell<bool>> {
    let is_on = Rc::new(Cell::new(false));
    let switch = Rc::clone(&is_on);
    sky.down = Some(Box::new(move |_, from, message| {
        let is_health = matches!(message, Message::Flight(FlightMessage::Health(_)));
        match from.system == 1 && is_on.get() && is_health {
            true => Vec::new(),
            false => vec![(from, message)],
        }
    }));
    switch
}

#[test]
fn reports_that_stop_are_alarms_and_what_they_said_is_not_shown_any_more() {
    let plan = two();
    let mut sky = sky(&plan);
    let switch = lose_health(&mut sky);
    sky.fly_to(30.0);
    let shown = |sky: &Sky<'_>| {
        let alpha = &sky.fleet.status(sky.now)[0];
        (alpha.battery_percent.is_some(), alpha.gps_fix.is_some())
    };
    assert_eq!(shown(&sky), (true, true));
    switch.set(true);
    sky.fly_to(39.0);
    assert_eq!(count(&sky, "alpha", "ALARM"), 0, "{:?}", sky.events);
    sky.fly_to(43.0);
    for text in [
        "ALARM battery: no battery report for 10 s (100 % left then)",
        "ALARM ekf: no report of its position estimate for 10 s",
        "ALARM position: no GPS report for 10 s",
    ] {
        assert_eq!(count(&sky, "alpha", text), 1, "{text}: {:?}", sky.events);
    }
    assert_eq!(shown(&sky), (false, false));
    switch.set(false);
    sky.fly_to(50.0);
    let over = "battery alarm: over";
    assert_eq!(count(&sky, "alpha", over), 1, "{:?}", sky.events);
    assert_eq!(shown(&sky), (true, true));
    assert_eq!(count(&sky, "bravo", "ALARM"), 0, "{:?}", sky.events);
}

#[test]
fn a_vehicle_whose_battery_is_not_known_any_more_does_what_the_spec_says_of_its_battery() {
    let mut plan = two();
    let (who, action) = (Who::Vehicle, Action::Hold);
    plan.spec.on_alarm.battery = Some(Answer { who, action });
    let mut sky = sky(&plan);
    let switch = lose_health(&mut sky);
    sky.fly_to(30.0);
    switch.set(true);
    sky.fly_to(43.0);
    let text = "on_alarm battery: is ordered to hold";
    assert_eq!(count(&sky, "alpha", text), 1, "{:?}", sky.events);
    assert_eq!(count(&sky, "bravo", "on_alarm"), 0, "{:?}", sky.events);
}

#[test]
fn the_silence_of_a_link_is_no_silence_of_a_battery() {
    let plan = two();
    let mut sky = sky(&plan);
    sky.fly_to(30.0);
    sky.cut.push(1);
    sky.fly_to(60.0);
    sky.cut.clear();
    sky.fly_to(70.0);
    assert_eq!(count(&sky, "alpha", "ALARM link"), 1, "{:?}", sky.events);
    assert_eq!(count(&sky, "alpha", "report"), 0, "{:?}", sky.events);
}

/// Another ground station.
const OTHER: Address = Address {
    system: 255,
    component: 190,
};

/// It has vehicle 1 or 2 go on to an item.
fn set_item(sky: &mut Sky<'_>, index: usize, seq: u16) {
    let target = sky.vehicles[index].address();
    let message = Message::Flight(FlightMessage::SetCurrent { target, seq });
    sky.vehicles[index].handle(sky.now, OTHER, &message);
}

#[test]
fn a_vehicle_that_takes_off_before_its_departure_is_an_alarm_that_says_by_how_much() {
    let mut fleet = vec![lane("alpha", 1, 36.300), lane("bravo", 2, 36.308)];
    fleet[0].depart_s = 60.0;
    let plan = plan(fleet, OnLinkLoss::Continue);
    let mut sky = sky(&plan);
    sky.fly_to(4.0);
    set_item(&mut sky, 0, 2);
    sky.fly_to(10.0);
    let early = sky.events.iter().find(|event| event.text.contains("ALARM"));
    let early = early.unwrap_or_else(|| panic!("{:?}", sky.events));
    let text = "ALARM late: took off 54 s before its departure (the verdict assumed at most";
    assert!(early.text.contains(text), "{early:?}");
    assert_eq!(early.vehicle.as_deref(), Some("alpha"));
    sky.fly_out();
    let text = "before its departure";
    assert_eq!(count(&sky, "alpha", text), 1, "{:?}", sky.events);
    assert_eq!(count(&sky, "bravo", text), 0, "{:?}", sky.events);
}

#[test]
fn a_vehicle_that_waits_for_its_start_and_is_started_by_somebody_else_is_watched_and_early() {
    let plan = two();
    let missions = plan.dispatched.missions.iter().zip(plan.references());
    let assignments = missions
        .enumerate()
        .map(|(link, ((index, mission), mut reference))| {
            // Alpha is started a minute later than its plan has it.
            let start_s = if link == 0 { 60.0 } else { 0.0 };
            for waypoint in &mut reference.waypoints {
                waypoint.t_s += start_s;
            }
            Assignment {
                vehicle: &plan.spec.vehicles[*index].id,
                sysid: plan.spec.vehicles[*index].sysid,
                link,
                mission,
                reference,
                start_s,
                upload: true,
                itinerary: Itinerary::default(),
            }
        });
    let fleet = Fleet::new(assignments.collect(), plan.options(false), US, Time(0));
    let fleet = fleet.watched(&plan.spec, &plan.world);
    let mut sky = Sky::new(fleet, plan.vehicles());
    sky.fly_to(2.0);
    let target = sky.vehicles[0].address();
    let order = Command::new(Command::MISSION_START, [0.0, 0.0]);
    let start = Message::Flight(FlightMessage::Command { target, order });
    sky.vehicles[0].handle(sky.now, OTHER, &start);
    sky.fly_to(10.0);
    let text = "before its departure";
    assert_eq!(count(&sky, "alpha", text), 1, "{:?}", sky.events);
    sky.fly_out();
    assert_eq!(sky.end(0), End::Landed, "{:?}", sky.events);
    assert_eq!(count(&sky, "alpha", text), 1, "{:?}", sky.events);
}

#[test]
fn a_vehicle_that_goes_on_to_a_later_item_is_an_alarm_that_names_those_that_it_skips() {
    let plan = two();
    let items = plan.dispatched.missions[0].1.items.len();
    let mut sky = sky(&plan);
    sky.fly_to(30.0);
    let row = sky.fleet.status(sky.now)[0].item.0;
    assert!(row + 1 < items, "it flies to item {row} of {items}");
    set_item(&mut sky, 0, u16::try_from(items).expect("a short mission"));
    sky.fly_to(32.0);
    let last = items - 1;
    let text =
        format!("ALARM mission: skips items {row} to {last}: it flies to item {items} of {items}");
    assert_eq!(count(&sky, "alpha", &text), 1, "{text}: {:?}", sky.events);
    assert_eq!(count(&sky, "bravo", "skips"), 0, "{:?}", sky.events);
}

#[test]
fn items_that_are_flown_unheard_or_after_others_are_not_said_to_be_skipped() {
    let plan = two();
    let mut sky = sky(&plan);
    sky.fly_to(15.0);
    // It flies on unheard, is heard again, and is sent back by somebody.
    sky.cut.push(1);
    sky.fly_to(60.0);
    sky.cut.clear();
    sky.fly_to(62.0);
    set_item(&mut sky, 0, 2);
    sky.fly_out();
    for id in ["alpha", "bravo"] {
        assert_eq!(count(&sky, id, "skips"), 0, "{:?}", sky.events);
    }
    let text = "ALARM mission: goes back: it flies to item 3 of 6 again, after item 4";
    assert_eq!(count(&sky, "alpha", text), 1, "{:?}", sky.events);
    assert_eq!(count(&sky, "bravo", "goes back"), 0, "{:?}", sky.events);
}

/// Vehicle 1 says a text in pieces, in an order; some may be missing. One that is no piece has no id.
fn say(sky: &mut Sky<'_>, (severity, id): (u8, u16), pieces: &[(u8, &str)]) {
    let from = sky.vehicles[0].address();
    for (seq, text) in pieces {
        let mut bytes = [0; TEXT_BYTES];
        bytes[..text.len()].copy_from_slice(text.as_bytes());
        let (seq, id) = (*seq, id);
        let chunk = TextChunk {
            severity,
            bytes,
            id,
            seq,
        };
        sky.fleet
            .handle(sky.now, (0, from), &Message::TextChunk(chunk));
    }
}

#[test]
fn a_text_in_pieces_is_one_line_and_what_was_lost_of_it_is_marked() {
    let plan = two();
    let mut sky = sky(&plan);
    sky.fly_to(30.0);
    let (a, b) = ("a".repeat(TEXT_BYTES), "b".repeat(TEXT_BYTES));
    say(&mut sky, (2, 1), &[(1, &b), (0, &a), (2, "end")]);
    sky.step();
    let whole = format!("ALARM text: says: {a}{b}end");
    assert_eq!(count(&sky, "alpha", &whole), 1, "{:?}", sky.events);
    // Five critical texts in 10 s are alarms, however many pieces one has.
    say(&mut sky, (2, 2), &[(0, &a), (2, "landed, motors stopped")]);
    sky.fly_to(30.5);
    assert_eq!(count(&sky, "alpha", "landed"), 0, "{:?}", sky.events);
    sky.fly_to(32.0);
    let marked = format!("ALARM text: says: {a}[...]landed, motors stopped");
    assert_eq!(count(&sky, "alpha", &marked), 1, "{:?}", sky.events);
    say(&mut sky, (2, 2), &[(1, &b)]);
    say(&mut sky, (2, 3), &[(0, "  ")]);
    sky.fly_to(36.0);
    let empty = "ALARM text: says: (an empty text)";
    assert_eq!(count(&sky, "alpha", empty), 1, "{:?}", sky.events);
    assert_eq!(count(&sky, "alpha", "says"), 3, "{:?}", sky.events);
}

#[test]
fn a_record_and_its_documents_have_no_raw_marks_that_reorder_a_terminal() {
    let text = "says: \u{202e}landed\u{2066}\u{9b}2J";
    let event = Event {
        t_s: Some(9.0),
        vehicle: Some("alpha".to_owned()),
        text: text.to_owned(),
        alarm: None,
    };
    let line = Line::of_event(&event).text();
    assert!(
        line.is_ascii() && line.contains("\\u202elanded\\u2066\\u009b2J"),
        "{line}"
    );
    let read: Line = serde_json::from_str(&line).expect("a line");
    assert_eq!(read, Line::of_event(&event));
    let document = sortie::report::json_text(&[text]);
    assert!(
        document.is_ascii() && document.ends_with("\n]\n"),
        "{document}"
    );
    let read: [String; 1] = serde_json::from_str(&document).expect("JSON");
    assert_eq!(read, [text]);
}
