//! Flights against peers that answer for others, refuse, flood, and vehicles that do what they
//! were not ordered to: every line that an operator reads must be true.

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use crate::support::{command, in_flight, sky};
use command::{sortie, text};
use in_flight::{json, lanes, planned, take_off, wait_for};
use sky::{Planned, Sky, US, lane, plan};
use sortie::flight::*;
use sortie::link::*;
use sortie::spec::{Autopilot, OnLinkLoss};
use sortie::verify::{Flown, Limit};

/// Two ArduCopters side by side, a kilometre each.
fn two(on_link_loss: OnLinkLoss) -> Planned {
    plan(
        vec![lane("alpha", 1, 36.300), lane("bravo", 2, 36.308)],
        on_link_loss,
    )
}

fn autopilot(system: u8) -> Address {
    Address {
        system,
        component: 1,
    }
}

fn order(message: &Message) -> Option<Command> {
    match message {
        Message::Flight(FlightMessage::Command { order, .. }) => Some(*order),
        _ => None,
    }
}

/// Whether it is the command to arm (1) or to disarm (0).
fn is_arming(message: &Message, arms: f32) -> bool {
    order(message).is_some_and(|order| {
        order.command == Command::COMPONENT_ARM_DISARM
            && order.params[0].to_bits() == arms.to_bits()
    })
}

fn ack(target: Address, command: u16, result: CommandResult) -> Message {
    Message::Flight(FlightMessage::CommandAck {
        target,
        command,
        result,
    })
}

fn all_text(sky: &Sky<'_>) -> Vec<String> {
    sky.events.iter().map(|event| event.text.clone()).collect()
}

fn count(sky: &Sky<'_>, text: &str) -> usize {
    let texts = all_text(sky);
    texts.iter().filter(|of| of.contains(text)).count()
}

#[test]
fn a_vehicle_that_disarms_itself_while_another_refuses_is_armed_again_before_t0() {
    let plan = two(OnLinkLoss::Continue);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    // Bravo refuses for 13 s; alpha disarms itself after 10 s.
    let first = Cell::new(None);
    sky.up = Some(Box::new(move |now, system, message| {
        if system != 2 || !is_arming(message, 1.0) {
            return None;
        }
        let began = first.get().unwrap_or(now);
        first.set(Some(began));
        let refused = ack(US, Command::COMPONENT_ARM_DISARM, CommandResult::FAILED);
        (now - began < 13_000).then(|| vec![(autopilot(2), refused)])
    }));
    sky.fly_to(0.1);
    assert!(sky.says("alpha", "disarmed itself"), "{:?}", sky.events);
    assert!(sky.vehicles.iter().all(|vehicle| vehicle.is_armed()));
    sky.fly_out();
    assert_eq!((sky.end(0), sky.end(1)), (End::Landed, End::Landed));
}

#[test]
fn an_answer_to_another_ground_station_or_from_another_component_arms_nobody() {
    let other = Address {
        system: 255,
        component: 190,
    };
    let camera = Address {
        system: 2,
        component: 100,
    };
    for (from, target) in [(autopilot(2), other), (camera, US)] {
        let plan = two(OnLinkLoss::Continue);
        let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
        sky.up = Some(Box::new(move |_, system, message| {
            let accepted = ack(
                target,
                Command::COMPONENT_ARM_DISARM,
                CommandResult::ACCEPTED,
            );
            (system == 2 && is_arming(message, 1.0)).then(|| vec![(from, accepted)])
        }));
        let Outcome::NotStarted(why) = sky.fly_out() else {
            panic!("bravo was never armed");
        };
        assert!(why[0].1.contains("did not answer command 400"), "{why:?}");
        assert!(sky.vehicles.iter().all(|vehicle| !vehicle.is_armed()));
    }
}

#[test]
fn a_vehicle_that_accepts_to_arm_and_is_not_armed_starts_nobody() {
    let plan = two(OnLinkLoss::Continue);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    sky.up = Some(Box::new(|_, system, message| {
        let accepted = ack(US, Command::COMPONENT_ARM_DISARM, CommandResult::ACCEPTED);
        (system == 2 && is_arming(message, 1.0)).then(|| vec![(autopilot(2), accepted)])
    }));
    let Outcome::NotStarted(why) = sky.fly_out() else {
        panic!("bravo was never armed");
    };
    let text = "accepted the command to arm, and is not armed";
    assert!(
        why.contains(&("bravo".to_owned(), text.to_owned())),
        "{why:?}"
    );
    assert!(sky.vehicles.iter().all(|vehicle| !vehicle.is_armed()));
    assert_eq!(count(&sky, "T0"), 0);
}

#[test]
fn a_vehicle_that_does_not_disarm_is_ordered_to_until_it_does() {
    let plan = two(OnLinkLoss::Continue);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    // Bravo never arms; alpha's order to disarm is lost for 8 s.
    let first = Cell::new(None);
    sky.up = Some(Box::new(move |now, system, message| {
        let refused = ack(US, Command::COMPONENT_ARM_DISARM, CommandResult::FAILED);
        if system == 2 && is_arming(message, 1.0) {
            return Some(vec![(autopilot(2), refused)]);
        }
        if system == 1 && is_arming(message, 0.0) {
            let began = first.get().unwrap_or(now);
            first.set(Some(began));
            return (now - began < 8000).then(Vec::new);
        }
        None
    }));
    let Outcome::NotStarted(why) = sky.fly_out() else {
        panic!("bravo never armed");
    };
    assert!(sky.vehicles.iter().all(|vehicle| !vehicle.is_armed()));
    assert!(why.iter().all(|(_, why)| !why.contains("ARMED")), "{why:?}");
}

#[test]
fn a_vehicle_that_cannot_be_disarmed_is_named_as_still_armed() {
    let plan = two(OnLinkLoss::Continue);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    let orders = Rc::new(Cell::new(0));
    let counted = Rc::clone(&orders);
    // It stays armed: autopilots can be set not to disarm themselves.
    let was_armed = Cell::new(false);
    sky.down = Some(Box::new(move |_, from, message| match message {
        Message::Heartbeat(beat) if from.system == 1 => {
            was_armed.set(was_armed.get() || beat.is_armed());
            let armed = if was_armed.get() { MODE_ARMED } else { 0 };
            let base_mode = beat.base_mode | armed;
            vec![(from, Message::Heartbeat(Heartbeat { base_mode, ..beat }))]
        }
        message => vec![(from, message)],
    }));
    sky.up = Some(Box::new(move |_, system, message| {
        let refused = |from| {
            vec![(
                from,
                ack(US, Command::COMPONENT_ARM_DISARM, CommandResult::FAILED),
            )]
        };
        if system == 1 && is_arming(message, 0.0) {
            counted.set(counted.get() + 1);
            return Some(refused(autopilot(1)));
        }
        (system == 2 && is_arming(message, 1.0)).then(|| refused(autopilot(2)))
    }));
    let Outcome::NotStarted(why) = sky.fly_out() else {
        panic!("bravo never armed");
    };
    assert!(orders.get() > 15, "for 20 s: {}", orders.get());
    let line = "alpha IS STILL ARMED: refused command 400 with FAILED";
    assert!(why.contains(&(String::new(), line.to_owned())), "{why:?}");
    assert_eq!(count(&sky, line), 1);
}

#[test]
fn a_vehicle_that_refuses_its_start_is_disarmed_and_the_line_says_so() {
    let plan = two(OnLinkLoss::Continue);
    for obeys in [true, false] {
        let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
        let armed = Rc::new(Cell::new(true));
        let motors = Rc::clone(&armed);
        sky.up = Some(Box::new(move |_, system, message| {
            let command = order(message)?.command;
            let refused = ack(US, command, CommandResult::FAILED);
            let is_start = command == Command::MISSION_START;
            if system == 1 && is_arming(message, 0.0) {
                motors.set(!obeys);
                return (!obeys).then(|| vec![(autopilot(1), refused)]);
            }
            (system == 1 && is_start).then(|| vec![(autopilot(1), refused)])
        }));
        let shown = Rc::clone(&armed);
        let has_begun = Cell::new(false);
        sky.down = Some(Box::new(move |_, from, message| match message {
            // Whatever DISARM_DELAY is.
            Message::Heartbeat(beat) if from.system == 1 => {
                has_begun.set(has_begun.get() || beat.is_armed());
                let armed = if has_begun.get() && shown.get() {
                    MODE_ARMED
                } else {
                    0
                };
                let base_mode = beat.base_mode & !MODE_ARMED | armed;
                vec![(from, Message::Heartbeat(Heartbeat { base_mode, ..beat }))]
            }
            message => vec![(from, message)],
        }));
        assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
        let End::Failed(why) = sky.end(0) else {
            panic!("{:?}", sky.end(0));
        };
        assert!(why.starts_with("refused command 300"), "{why}");
        assert_eq!(why.contains("alpha IS STILL ARMED"), !obeys, "{why}");
        assert_eq!(sky.says("alpha", "is disarmed"), obeys, "{:?}", sky.events);
        assert_eq!(sky.end(1), End::Landed);
    }
}

#[test]
fn a_vehicle_that_never_gets_the_order_to_hold_is_not_said_to_hold() {
    let plan = two(OnLinkLoss::Continue);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    sky.fly_to(45.0);
    let orders = Rc::new(Cell::new(0));
    let counted = Rc::clone(&orders);
    // The first orders are answered for it, and never reach it.
    sky.up = Some(Box::new(move |_, system, message| {
        let is_hold = order(message).is_some_and(|order| order.command == Command::DO_SET_MODE);
        if system != 1 || !is_hold {
            return None;
        }
        counted.set(counted.get() + 1);
        let accepted = ack(US, Command::DO_SET_MODE, CommandResult::ACCEPTED);
        (counted.get() <= 12).then(|| vec![(autopilot(1), accepted)])
    }));
    // Bravo stands still in the air in its mission, as at a waypoint with a hold.
    sky.fleet.intervene(sky.now, Intervention::Hold);
    sky.fly_to(68.0);
    assert!(sky.says("bravo", "holds"), "{:?}", sky.events);
    assert!(sky.says("alpha", "hold not confirmed"), "{:?}", sky.events);
    let is_line =
        |event: &Event| event.vehicle.as_deref() == Some("alpha") && event.text == "holds";
    assert!(!sky.events.iter().any(is_line), "{:?}", sky.events);
    assert_eq!(sky.fleet.status(sky.now)[0].stage, "no hold yet");
    sky.fly_to(90.0);
    assert!(orders.get() > 12, "it is ordered again: {}", orders.get());
    assert!(sky.events.iter().any(is_line), "{:?}", sky.events);
}

#[test]
fn each_loss_of_a_link_is_acted_upon() {
    let plan = two(OnLinkLoss::HoldAll);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    sky.fly_to(40.0);
    sky.cut.push(2);
    sky.fly_to(60.0);
    sky.cut.clear();
    sky.fly_to(65.0);
    assert_eq!(count(&sky, "all hold"), 1);
    for index in [0, 1] {
        sky.order(index, Command::MISSION_START);
    }
    sky.fly_to(70.0);
    assert!(
        sky.says("alpha", "is on its mission again"),
        "{:?}",
        sky.events
    );
    sky.cut.push(2);
    sky.fly_to(90.0);
    assert_eq!(count(&sky, "all hold"), 2, "{:?}", sky.events);
    assert_eq!(sky.fleet.status(sky.now)[0].stage, "holds");
}

#[test]
fn positions_of_other_components_and_impossible_ones_are_not_recorded() {
    let plan = two(OnLinkLoss::Continue);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    let number = Cell::new(0_u32);
    sky.down = Some(Box::new(move |_, from, message| {
        let Message::Flight(FlightMessage::Position(position)) = message else {
            return vec![(from, message)];
        };
        number.set(number.get() + 1);
        let at = |x| Message::Flight(FlightMessage::Position(Position { x, ..position }));
        let companion = Address {
            component: 191,
            ..from
        };
        let mut heard = vec![(companion, at(position.x + 50_000))];
        if number.get().is_multiple_of(51) {
            heard.push((from, at(900_000_001)));
        }
        heard.push((from, message));
        heard
    }));
    assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
    let report = plan.judge(&sky);
    assert!(report.passes(), "{report:#?}");
    let text = "sent a position that cannot be: latitude 90.0000001";
    assert!(sky.says("alpha", text), "{:?}", sky.events);
    assert_eq!(count(&sky, text), 2, "once for each");
    assert!(sky.says("alpha", "positions that cannot be; none was used"));
}

#[test]
fn a_companion_that_speaks_first_is_not_taken_for_the_autopilot() {
    let plan = two(OnLinkLoss::Continue);
    let mut sky = Sky::new(plan.fleet(false, false), plan.vehicles());
    let companion = Address {
        system: 1,
        component: 191,
    };
    let beat = Message::Heartbeat(Heartbeat {
        kind: 18,
        autopilot: 8,
        base_mode: 128,
        custom_mode: 0,
        system_status: 4,
    });
    sky.fleet.handle(Time(0), (0, companion), &beat);
    let targets = Rc::new(RefCell::new(Vec::new()));
    let seen = Rc::clone(&targets);
    sky.up = Some(Box::new(move |_, system, message| {
        if let Message::Flight(FlightMessage::Command { target, .. }) = message
            && system == 1
        {
            seen.borrow_mut().push(target.component);
        }
        None
    }));
    // What it does not say by itself is requested.
    sky.down = Some(Box::new(|_, from, message| match message {
        Message::MissionCurrent { .. } => Vec::new(),
        message => vec![(from, message)],
    }));
    (0..200).for_each(|_| sky.step());
    let targets = targets.borrow();
    assert!(
        !targets.is_empty() && targets.iter().all(|of| *of == 1),
        "{targets:?}"
    );
}

#[test]
fn a_stop_of_this_program_right_after_t0_is_its_own_as_well() {
    let plan = two(OnLinkLoss::HoldAll);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
    let mut record = plan.record(&sky);
    record.stops = vec![(1.0, 22.0)];
    for flight in &mut record.flights {
        flight.flown.fixes.retain(|fix| fix.t_s > 22.0);
    }
    let report = judge(&plan.spec, &plan.world, &record);
    let gap = |m: &&sortie::verify::Margin| m.limit == Limit::Flown(Flown::Gap);
    let gaps: Vec<_> = report.margins.iter().filter(gap).collect();
    assert_eq!(gaps.len(), 2);
    for gap in gaps {
        let note = "the recording program was stopped for 21 s";
        assert!(gap.value > 20.0 && gap.note.contains(note), "{gap:?}");
    }
}

#[test]
fn a_stop_of_this_program_is_its_own_and_no_lost_link() {
    let plan = two(OnLinkLoss::HoldAll);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    sky.fly_to(40.0);
    // As after SIGSTOP: the vehicles fly on, and what they said meanwhile is lost.
    for _ in 0..1500 {
        sky.now = sky.now + 20;
        for vehicle in &mut sky.vehicles {
            vehicle.handle_timeout(sky.now);
            while vehicle.poll_transmit().is_some() {}
        }
    }
    assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
    assert_eq!(count(&sky, "this program was stopped for 30 s"), 1);
    assert_eq!(count(&sky, "link lost"), 0, "{:?}", sky.events);
    assert_eq!(count(&sky, "all hold"), 0);
    assert_eq!((sky.end(0), sky.end(1)), (End::Landed, End::Landed));
    // Nobody knows what was flown meanwhile; the note says whose fault that is.
    let mut record = plan.record(&sky);
    record.stops = vec![(40.0, 70.0)];
    let report = judge(&plan.spec, &plan.world, &record);
    let gap = |m: &&sortie::verify::Margin| m.limit == Limit::Flown(Flown::Gap);
    let gaps: Vec<_> = report.margins.iter().filter(gap).collect();
    assert_eq!(gaps.len(), 2);
    for gap in gaps {
        assert!(!gap.ok && gap.value > 29.0, "{gap:?}");
        assert!(
            gap.note
                .contains("the recording program was stopped for 30 s"),
            "{gap:?}"
        );
    }
    let line = Line::Stop {
        t_s: 70.0,
        stopped_s: 30.0,
    };
    let read = read_record(
        &[
            line.text(),
            Line::of_end("alpha", &record.flights[0].flown).text(),
        ]
        .join("\n"),
        plan.world.frame,
    );
    assert_eq!(read.expect("a record").stops, [(40.0, 70.0)]);
}

#[test]
fn a_flood_of_texts_is_bounded_and_counted_and_errors_come_through() {
    let plan = two(OnLinkLoss::Continue);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    sky.fly_to(20.0);
    let errors = Cell::new(0);
    sky.down = Some(Box::new(move |_, from, message| {
        let text = |severity, text: &str| Message::StatusText {
            severity,
            text: text.to_owned(),
        };
        let mut heard = vec![(from, text(6, "noise")); 100];
        // Two cameras that each count their own.
        for number in [1, 2] {
            let seen = FlightMessage::CameraTrigger { seq: number };
            heard.push((from, Message::Flight(seen)));
        }
        if errors.get() == 3 {
            heard.push((from, text(2, "EKF variance")));
        }
        errors.set(errors.get() + 1);
        heard.push((from, message));
        heard
    }));
    sky.fly_to(60.0);
    let noise = count(&sky, "says: noise");
    assert!((40..=240).contains(&noise), "{noise}");
    let pictures = count(&sky, "picture ");
    assert!((40..=240).contains(&pictures), "{pictures}");
    assert_eq!(count(&sky, "EKF variance"), 1);
    assert!(count(&sky, "more texts are not recorded (at most 20 in 10 s)") >= 2);
}

#[test]
fn a_vehicle_that_streams_positions_already_is_asked_for_its_current_item() {
    let mut fleet = vec![lane("alpha", 1, 36.300), lane("bravo", 2, 36.308)];
    fleet[1].autopilot = Autopilot::Px4;
    let plan = plan(fleet, OnLinkLoss::Continue);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    // As with SR0_POSITION: positions by themselves, the current item only after a request.
    let requested = Rc::new(Cell::new(false));
    let is_requested = Rc::clone(&requested);
    sky.up = Some(Box::new(move |_, _, message| {
        let asks = order(message).is_some_and(|order| {
            let commands = [Command::SET_MESSAGE_INTERVAL, Command::REQUEST_MESSAGE];
            commands.contains(&order.command) && order.params[0].to_bits() == 42_f32.to_bits()
        });
        requested.set(requested.get() || asks);
        None
    }));
    sky.down = Some(Box::new(move |_, from, message| match message {
        Message::MissionCurrent { .. } if !is_requested.get() => Vec::new(),
        // Ready at the first look: nothing to wait for.
        message => vec![(from, message)],
    }));
    assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
    for (_, flown) in sky.fleet.flown() {
        assert!(flown.fixes.iter().any(|fix| fix.item > 1));
        assert!(flown.fixes.iter().all(|fix| fix.items > 0));
    }
    assert!(plan.judge(&sky).passes());
}

/// As a stock ArduPilot does that was asked for one position before, by an upload.
#[test]
fn a_vehicle_that_gives_one_position_and_no_stream_is_asked_for_a_stream() {
    let fleet = vec![lane("alpha", 1, 36.300), lane("bravo", 2, 36.308)];
    let plan = plan(fleet, OnLinkLoss::Continue);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    let streams = Rc::new(RefCell::new([false; 2]));
    let ordered = Rc::clone(&streams);
    sky.up = Some(Box::new(move |_, _, message| {
        if let Message::Flight(FlightMessage::Command { target, order }) = message
            && order.command == Command::SET_MESSAGE_INTERVAL
            && order.params[0].to_bits() == 33_f32.to_bits()
        {
            ordered.borrow_mut()[usize::from(target.system) - 1] = true;
        }
        None
    }));
    let mut given = [false; 2];
    sky.down = Some(Box::new(move |_, from, message| {
        let number = usize::from(from.system) - 1;
        let is_position = matches!(message, Message::Flight(FlightMessage::Position(_)));
        if is_position && given[number] && !streams.borrow()[number] {
            return Vec::new();
        }
        given[number] |= is_position;
        vec![(from, message)]
    }));
    assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
    assert_eq!(count(&sky, "ALARM position"), 0, "{:?}", all_text(&sky));
    assert!(plan.judge(&sky).passes());
}

#[cfg(unix)]
fn signal(flight: &in_flight::Flight, name: &str) {
    let id = flight.0.id().to_string();
    let sent = std::process::Command::new("kill")
        .args([name, &id])
        .status();
    assert!(sent.expect("kill").success());
}

#[cfg(unix)]
#[test]
fn a_terminal_that_hangs_up_ends_no_flight() {
    let (folder, runs) = planned("lanes", &lanes("-84.251"));
    let mut flight = take_off(folder.path(), "lanes.yaml", "8");
    wait_for(&runs, "alpha", 5.0);
    signal(&flight, "-HUP");
    let status = flight.0.wait().expect("it ends");
    assert!(status.success(), "{status}");
    assert_eq!(json(&runs.join("flight.json"))["verdict"], "pass");
}

/// A plane that circles at its goal.
const PLANE: &str = "
sortie: 1
name: lanes
area: {south_west: {lat: 36.27, lon: -84.31}, north_east: {lat: 36.34, lon: -84.19}, min_agl_m: 30, max_amsl_m: 900}
terrain: {flat: {amsl_m: 400}}
vehicles:
  - {id: heron, sysid: 1, autopilot: ardupilot, airframe: plane, link: sim, speed_mps: 18, climb_mps: 4, descent_mps: 3,
     home: {lat: 36.300, lon: -84.290}, takeoff_heading_deg: 90,
     start: {lat: 36.300, lon: -84.275, agl_m: 60}, goal: {lat: 36.300, lon: -84.245, agl_m: 60}, finish: loiter,
     loiter_radius_m: 80}
separation: {distance_m: 100, time_slack_s: 5}
planner: {algorithm: msfoa, seed: 1, evaluations: 1000}
";

#[test]
fn a_plane_that_replan_refuses_is_judged_against_the_threat() {
    let (folder, runs) = planned("lanes", PLANE);
    let mut flight = take_off(folder.path(), "lanes.yaml", "16");
    wait_for(&runs, "heron", 30.0);
    let threat = "--threat=36.300,-84.252,150";
    let output = sortie(folder.path(), &["replan", "lanes.yaml", threat]);
    let errors = text(&output.stderr);
    assert_eq!(output.status.code(), Some(4), "{errors}");
    assert!(errors.contains("heron is a plane"), "{errors}");
    assert!(errors.contains("is judged against the threat"), "{errors}");
    let status = flight.0.wait().expect("it ends");
    assert_eq!(status.code(), Some(5));
    let flown = json(&runs.join("flight.json"));
    assert_eq!(flown["verdict"], "fail", "{flown:#}");
    let margins = flown["margins"].as_array().expect("margins");
    let popup = margins.iter().find(|m| m["what"] == "threat popup-1");
    assert_eq!(popup.expect("judged")["ok"], false, "{margins:#?}");
}
