//! Five vehicles and everything that a hostile peer can do at once: every line that an operator reads
//! is held against what the vehicles really did.

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use crate::support::sky::{Planned, Sky, US, lane, plan};

use sortie::flight::*;
use sortie::link::*;
use sortie::spec::{AlarmKind, Autopilot, OnLinkLoss};
use sortie::verify::{Flown, Limit};

const IDS: [&str; 5] = ["alpha", "bravo", "charlie", "delta", "echo"];
/// Echo is not heard from and to these times, seconds after T0.
const CUTS_S: [(f64, f64); 2] = [(40.0, 55.0), (70.0, 82.0)];
/// What it takes to notice that a link is lost or back, seconds.
const NOTICED_S: f64 = 8.0;

fn five() -> Planned {
    let lanes = IDS.iter().zip(1..).map(|(id, sysid)| {
        let lat_deg = 36.276 + 0.008 * f64::from(sysid);
        let mut vehicle = lane(id, sysid, lat_deg);
        if sysid % 2 == 0 {
            vehicle.autopilot = Autopilot::Px4;
        }
        vehicle
    });
    plan(lanes.collect(), OnLinkLoss::Continue)
}

fn autopilot(system: u8) -> Address {
    Address {
        system,
        component: 1,
    }
}

fn accepts(target: Address, command: u16, result: CommandResult) -> Message {
    Message::Flight(FlightMessage::CommandAck {
        target,
        command,
        result,
    })
}

fn is_arming(message: &Message) -> bool {
    let Message::Flight(FlightMessage::Command { order, .. }) = message else {
        return false;
    };
    order.command == Command::COMPONENT_ARM_DISARM && order.params[0].to_bits() == 1_f32.to_bits()
}

/// Bravo refuses to arm for 13 s, while the others, once armed, disarm themselves after 10 s.
fn refusals(sky: &mut Sky<'_>) {
    let first = Cell::new(None);
    sky.up = Some(Box::new(move |now, system, message| {
        if system != 2 || !is_arming(message) {
            return None;
        }
        let began = first.get().unwrap_or(now);
        first.set(Some(began));
        let refused = accepts(US, Command::COMPONENT_ARM_DISARM, CommandResult::FAILED);
        (now - began < 13_000).then(|| vec![(autopilot(2), refused)])
    }));
}

/// Forged answers, positions of a companion and impossible ones, a flood of texts with a forged line.
fn forgeries(sky: &mut Sky<'_>) {
    let number = Cell::new(0_u32);
    let other = Address {
        system: 255,
        component: 190,
    };
    sky.down = Some(Box::new(move |_, from, message| {
        number.set(number.get() + 1);
        let companion = Address {
            component: 191,
            ..from
        };
        let mut heard = Vec::new();
        if number.get().is_multiple_of(13) {
            for command in [
                Command::COMPONENT_ARM_DISARM,
                Command::DO_SET_MODE,
                Command::MISSION_START,
            ] {
                heard.push((from, accepts(other, command, CommandResult::ACCEPTED)));
                heard.push((companion, accepts(US, command, CommandResult::ACCEPTED)));
            }
        }
        if from.system == 4 {
            let text = |severity, text: &str| Message::StatusText {
                severity,
                text: text.to_owned(),
            };
            heard.extend(vec![(from, text(6, "noise")); 5]);
            if number.get().is_multiple_of(97) {
                heard.push((from, text(6, "\u{1b}[2Jlanded as planned\nall have landed")));
            }
        }
        if let Message::Flight(FlightMessage::Position(position)) = message {
            let at = |x| Message::Flight(FlightMessage::Position(Position { x, ..position }));
            heard.push((companion, at(position.x + 50_000)));
            if number.get().is_multiple_of(51) {
                heard.push((from, at(900_000_001)));
            }
        }
        heard.push((from, message));
        heard
    }));
}

/// Whether echo was cut off at a time, or so shortly before that it may be said still.
fn is_cut(t_s: f64) -> bool {
    let within = |(from_s, to_s): &(f64, f64)| (*from_s..=to_s + NOTICED_S).contains(&t_s);
    CUTS_S.iter().any(within)
}

/// Holds an event against the vehicles as they are.
fn is_true(event: &Event, sky: &Sky<'_>) -> bool {
    let of = event.vehicle.as_deref();
    let index = of.and_then(|of| IDS.iter().position(|id| *id == of));
    let is_armed = index.map(|index| sky.vehicles[index].is_armed());
    let t_s = event.t_s.unwrap_or(-1.0);
    let text = event.text.as_str();
    if text.starts_with("says: ") {
        // What a vehicle says is told as what it says, and by whom.
        return of.is_some();
    }
    if text.ends_with(": T0") {
        return sky
            .vehicles
            .iter()
            .all(sortie::simulator::Vehicle::is_armed);
    }
    if text.contains("landed") {
        return is_armed == Some(false);
    }
    if text.contains("link lost") || text.contains("link is back") {
        return of == Some("echo") && is_cut(t_s);
    }
    let alarm = event.alarm.as_ref().map(|alarm| alarm.kind);
    match alarm {
        // Nothing goes wrong in the air but the link of echo.
        Some(AlarmKind::Link | AlarmKind::Position) => of == Some("echo") && is_cut(t_s),
        Some(_) => false,
        None => true,
    }
}

#[test]
fn every_line_is_true_while_peers_refuse_forge_flood_and_cut_links_at_once() {
    let plan = five();
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    refusals(&mut sky);
    forgeries(&mut sky);
    let mut seen = 0;
    while sky.fleet.outcome().is_none() {
        assert!(sky.now.0 < 1_800_000, "{:?}", sky.events);
        let t_s = sky.fleet.t_s(sky.now).unwrap_or(-1.0);
        let cut = CUTS_S
            .iter()
            .any(|(from_s, to_s)| (*from_s..*to_s).contains(&t_s));
        sky.cut = if cut { vec![5] } else { Vec::new() };
        sky.step();
        for event in &sky.events[seen..] {
            assert!(is_true(event, &sky), "{event:?}");
        }
        seen = sky.events.len();
    }
    assert_eq!(sky.fleet.outcome(), Some(&Outcome::Flown));
    let count = |text: &str| {
        sky.events
            .iter()
            .filter(|of| of.text.contains(text))
            .count()
    };
    assert_eq!(count("all are armed: T0"), 1);
    assert_eq!(count("link lost"), 2, "{:?}", sky.events);
    assert!(sky.says("alpha", "disarmed itself"), "{:?}", sky.events);
    assert!(count("more texts are not recorded") >= 2);
    for (index, id) in IDS.iter().enumerate() {
        assert_eq!(sky.end(index), End::Landed, "{id}");
        assert!(sky.says(id, "sent a position that cannot be"), "{id}");
    }
    // What was recorded is what the autopilots sent; of echo it has the gaps of its link.
    let report = plan.judge(&sky);
    let gap = Limit::Flown(Flown::Gap);
    let is_gap = |m: &&sortie::verify::Margin| m.limit == gap && m.vehicle == "echo";
    let failed: Vec<_> = report.margins.iter().filter(|m| !m.ok).collect();
    assert!(failed.iter().all(is_gap), "{failed:?}");
    assert_eq!(failed.len(), 1);
}

/// Everything that goes wrong from 40 s on in another flight, and the kind of line that is true of it.
fn injuries(sky: &mut Sky<'_>, now_s: &Rc<Cell<f64>>) -> Rc<RefCell<u32>> {
    let (t_s, at_s) = (Rc::clone(now_s), Rc::clone(now_s));
    let stormed = Rc::new(RefCell::new(0));
    let sent = Rc::clone(&stormed);
    // Alpha takes no order to hold.
    sky.up = Some(Box::new(move |_, system, message| {
        if let Message::Mission(_) = message
            && t_s.get() > 40.0
        {
            *sent.borrow_mut() += 1;
        }
        let is_order = matches!(message, Message::Flight(FlightMessage::Command { order, .. })
            if order.command == Command::DO_SET_MODE);
        let refused = accepts(US, Command::DO_SET_MODE, CommandResult::DENIED);
        (system == 1 && is_order && t_s.get() > 60.0).then(|| vec![(autopilot(1), refused)])
    }));
    sky.down = Some(Box::new(move |_, from, mut message| {
        let t_s = at_s.get();
        let mut heard = Vec::new();
        if let Message::Heartbeat(beat) = &mut message {
            let to = |system: u8, result| {
                let (target, opaque_id) = (Address { system, ..US }, 0);
                Message::Mission(MissionMessage {
                    target,
                    mission_type: 0,
                    body: Body::Ack { result, opaque_id },
                })
            };
            match from.system {
                // Another station writes to bravo, and delta cancels what nobody began.
                2 if (40.0..42.0).contains(&t_s) => {
                    heard.push((from, to(254, MissionResult::ACCEPTED)));
                }
                4 if t_s > 40.0 => {
                    let storm = to(US.system, MissionResult::OPERATION_CANCELLED);
                    heard.extend(vec![(from, storm); 100]);
                }
                3 if (50.0..55.0).contains(&t_s) => beat.system_status = 6,
                _ => {}
            }
        }
        heard.push((from, message));
        heard
    }));
    stormed
}

#[test]
fn every_line_is_true_while_orders_are_refused_missions_written_and_transfers_cancelled_at_once() {
    let plan = five();
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    let now_s = Rc::new(Cell::new(-1.0));
    let stormed = injuries(&mut sky, &now_s);
    let mut is_ordered = false;
    while sky.fleet.outcome().is_none() {
        assert!(sky.now.0 < 1_800_000, "{:?}", sky.events);
        now_s.set(sky.fleet.t_s(sky.now).unwrap_or(-1.0));
        if now_s.get() > 62.0 && !is_ordered {
            is_ordered = true;
            sky.fleet.intervene(sky.now, Intervention::Hold);
        }
        if now_s.get() > 110.0 {
            sky.fleet.intervene(sky.now, Intervention::Leave);
        }
        sky.step();
    }
    for event in &sky.events {
        let of = event.vehicle.as_deref();
        let is_expected = match event.alarm.as_ref().map(|alarm| alarm.kind) {
            None => true,
            Some(AlarmKind::Mission) => of == Some("bravo"),
            Some(AlarmKind::Text) => of == Some("charlie"),
            // It goes on to where it should not be.
            Some(AlarmKind::Late | AlarmKind::Corridor) => of == Some("alpha"),
            Some(_) => false,
        };
        assert!(is_expected, "{event:?}");
        if event.text.contains("not confirmed") {
            assert_eq!(of, Some("alpha"), "{event:?}");
        }
    }
    for (vehicle, text) in [
        ("alpha", "hold not confirmed"),
        (
            "bravo",
            "acknowledged a mission, or that it was cleared, to system 254",
        ),
        ("charlie", "MAV_STATE_EMERGENCY"),
        ("echo", "holds"),
    ] {
        assert!(
            sky.says(vehicle, text),
            "{vehicle} {text}: {:?}",
            sky.events
        );
    }
    assert_eq!(*stormed.borrow(), 0, "a storm is not answered");
}
