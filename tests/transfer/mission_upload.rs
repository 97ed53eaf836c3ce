//! Transfers in virtual time: every rule a scenario, then a sweep over seeds.

use crate::support::{lossy_link, transfers};
use lossy_link::{CLEAR, Ether, Weather};
use rand::RngExt;
use sortie::link::*;
use sortie::mission::{Item, VehicleMission, command, frame};
use sortie::numeric::Seed;
use sortie::simulator::{Profile, Vehicle};
use sortie::spec::Autopilot;
use transfers::{HOME, STRANGER, US, corner, rally};

pub(crate) const VEHICLE: Address = Address {
    system: 1,
    component: 1,
};
pub(crate) const PROFILES: [Profile; 3] = [Profile::ArduPilot, Profile::Px4, Profile::Generic];
/// Each has an altitude of its own.
fn waypoint(n: u16) -> Item {
    Item {
        z: 480.0 + 0.37 * f32::from(n),
        ..transfers::waypoint(10 * i32::from(n))
    }
}

/// A mission with takeoff, speed and landing, a fence of four corners, two rally points.
pub(crate) fn mission(profile: Profile, waypoints: u16) -> VehicleMission {
    let autopilot = match profile {
        Profile::ArduPilot => Autopilot::ArduPilot,
        Profile::Px4 | Profile::Generic => Autopilot::Px4,
    };
    let mut items = vec![
        Item {
            command: command::NAV_TAKEOFF,
            ..waypoint(0)
        },
        Item::without_place(command::DO_CHANGE_SPEED, [1.0, 12.5, -1.0, 0.0]),
    ];
    items.extend((1..=waypoints).map(waypoint));
    items.push(Item {
        command: command::NAV_LAND,
        ..waypoint(waypoints)
    });
    VehicleMission {
        fence: [1, 300, 600, 900].map(|n| corner(10 * n, 4)).to_vec(),
        rally: [5, 6].map(rally).to_vec(),
        ..transfers::mission(autopilot, items)
    }
}

fn wanted(mission: &VehicleMission, list: MissionType) -> &[Item] {
    match list {
        MissionType::Mission => &mission.items,
        MissionType::Fence => &mission.fence,
        MissionType::Rally => &mission.rally,
    }
}

/// Whether a vehicle holds exactly these lists, as its autopilot keeps them.
pub(crate) fn holds(vehicle: &Vehicle, profile: Profile, mission: &VehicleMission) -> bool {
    MissionType::ALL.into_iter().all(|list| {
        let expected: Vec<Item> = wanted(mission, list)
            .iter()
            .map(|item| match profile {
                Profile::ArduPilot => {
                    stored_form(Autopilot::ArduPilot, mission.airframe, list, item)
                }
                Profile::Px4 => stored_form(Autopilot::Px4, mission.airframe, list, item),
                Profile::Generic => *item,
            })
            .collect();
        vehicle.items(list) == expected
    })
}

fn order(mission: &VehicleMission) -> Order<'_> {
    Order {
        vehicle: "alpha",
        sysid: 1,
        mission,
        force: false,
        others: Vec::new(),
    }
}

/// What else happens while the transfer runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Event {
    Nothing,
    /// The vehicle starts again.
    Reboot(Time),
    /// The vehicle starts again, has lost all lists and says so at once that it is ready.
    StartEmpty(Time, Profile),
    /// The motors are started.
    Arm(Time),
    /// The link is dead for a while.
    Silence(Time, Time),
}

/// One ground station, one vehicle and one other ground station, all on the same air.
pub(crate) struct Scene<'a> {
    pub(crate) ether: Ether,
    pub(crate) vehicle: Vehicle,
    session: Session<'a>,
    pub(crate) event: Event,
    /// What the stranger says, and when.
    pub(crate) stranger: Vec<(Time, Address, Message)>,
    /// What the stranger and the vehicle say to each other is not overheard.
    pub(crate) deaf: bool,
    /// Answers to missions are never given.
    mute: bool,
    /// Uploads are never acknowledged.
    pub(crate) unacknowledged: bool,
    /// The vehicle gives this row of its mission back one metre higher, after it gave it so often.
    pub(crate) lifted: Option<u16>,
    pub(crate) lifted_after: u32,
    given: u32,
}

const GROUND: usize = 0;
const DRONE: usize = 1;
const OTHER: usize = 2;

impl<'a> Scene<'a> {
    pub(crate) fn new(
        seed: u64,
        weather: Weather,
        vehicle: Vehicle,
        mission: &'a VehicleMission,
    ) -> Self {
        Self {
            ether: Ether::new(seed, weather),
            vehicle,
            session: Session::new(order(mission), US, Time(0)),
            event: Event::Nothing,
            stranger: Vec::new(),
            mute: false,
            unacknowledged: false,
            lifted: None,
            lifted_after: 0,
            given: 0,
            deaf: false,
        }
    }

    /// To the end; the clock jumps from one thing to do to the next.
    pub(crate) fn run(&mut self) -> TransferReport {
        loop {
            let now = self.ether.now;
            self.happen(now);
            for (receiver, from, message) in self.ether.deliver() {
                match receiver {
                    GROUND => self.session.handle(now, from, &message),
                    DRONE => self.vehicle.handle(now, from, &message),
                    _ => {}
                }
            }
            self.session.handle_timeout(now);
            self.vehicle.handle_timeout(now);
            while let Some(message) = self.session.poll_transmit() {
                self.ether.send(GROUND, US, &[DRONE, OTHER], &message);
            }
            while let Some(mut message) = self.vehicle.poll_transmit() {
                self.tamper(&mut message);
                if !(self.mute && matches!(message, Message::Mission(_))
                    || self.unacknowledged && is_ack(&message))
                {
                    let to: &[usize] = if self.deaf && is_for_stranger(&message) {
                        &[OTHER]
                    } else {
                        &[GROUND, OTHER]
                    };
                    self.ether.send(DRONE, self.vehicle.address(), to, &message);
                }
            }
            let Progress { done, total, .. } = self.session.progress();
            assert!(done <= total, "{done} of {total} items");
            if let Some(report) = self.session.report() {
                return report.clone();
            }
            let due = [
                self.session.poll_timeout(),
                Some(self.vehicle.poll_timeout()),
            ];
            let next = due
                .into_iter()
                .flatten()
                .chain(self.ether.next_arrival())
                .chain(self.stranger.first().map(|(at, ..)| *at))
                .min();
            let next = next.expect("a vehicle always has its next heartbeat");
            self.ether.now = next.max(now + 1);
            assert!(self.ether.now < Time(3_600_000), "the session never ends");
        }
    }

    fn tamper(&mut self, message: &mut Message) {
        if let Message::Mission(MissionMessage {
            mission_type: 0,
            body: Body::ItemInt { seq, item, .. },
            ..
        }) = message
            && self.lifted == Some(*seq)
        {
            self.given += 1;
            if self.given > self.lifted_after {
                item.z += 1.0;
            }
        }
    }

    fn happen(&mut self, now: Time) {
        match self.event {
            Event::Reboot(at) if now >= at => {
                self.vehicle.reboot(now);
                self.event = Event::Nothing;
            }
            Event::StartEmpty(at, profile) if now >= at => {
                self.vehicle = Vehicle::new(profile, 1, Some(HOME), now);
                self.event = Event::Nothing;
            }
            Event::Arm(at) if now >= at => {
                self.vehicle.set_armed(true);
                self.event = Event::Nothing;
            }
            Event::Silence(from, _) if now >= from => {
                let Event::Silence(_, until) = self.event else {
                    return;
                };
                self.ether.weather.loss = if now < until { 1.0 } else { 0.0 };
            }
            _ => {}
        }
        while self.stranger.first().is_some_and(|(at, ..)| now >= *at) {
            let (_, name, message) = self.stranger.remove(0);
            let to: &[usize] = if self.deaf {
                &[DRONE]
            } else {
                &[GROUND, DRONE]
            };
            self.ether.send(OTHER, name, to, &message);
        }
    }
}

fn is_ack(message: &Message) -> bool {
    let Message::Mission(MissionMessage { body, .. }) = message else {
        return false;
    };
    matches!(body, Body::Ack { .. })
}

fn is_for_stranger(message: &Message) -> bool {
    matches!(message, Message::Mission(MissionMessage { target, .. }) if *target == STRANGER)
}

pub(crate) fn vehicle(profile: Profile) -> Vehicle {
    Vehicle::new(profile, 1, Some(HOME), Time(0))
}

pub(crate) fn say(target: Address, list: MissionType, body: Body) -> Message {
    Message::Mission(MissionMessage {
        target,
        mission_type: list.mission_type(),
        body,
    })
}

pub(crate) fn ack(result: MissionResult) -> Body {
    Body::Ack {
        result,
        opaque_id: 0,
    }
}

// ---------------------------------------------------------------- the upload machine alone

const ROUTE: Route = Route {
    us: US,
    vehicle: VEHICLE,
    list: MissionType::Mission,
};

fn upload(items: u16) -> Upload {
    let rows = (0..items)
        .map(|n| (waypoint(n), u8::from(n == 0)))
        .collect();
    Upload::new(ROUTE, rows, 5000, Time(600_000), Time(0))
}

fn hear(upload: &mut Upload, now: u64, body: Body) {
    upload.handle(Time(now), VEHICLE, &say(US, MissionType::Mission, body));
}

/// What it sends now, in short.
fn sent(upload: &mut Upload) -> Vec<String> {
    std::iter::from_fn(|| upload.poll_transmit())
        .map(|message| match message {
            Message::Mission(MissionMessage { body, target, .. }) => {
                assert_eq!(target, VEHICLE);
                match body {
                    Body::Count { count, .. } => format!("count {count}"),
                    Body::ItemInt { seq, .. } => format!("item {seq}"),
                    Body::Ack { result, .. } => format!("ack {result}"),
                    other => format!("{other:?}"),
                }
            }
            other => format!("{other:?}"),
        })
        .collect()
}

fn wait(upload: &mut Upload) -> u64 {
    let due = upload.poll_timeout().expect("not over");
    upload.handle_timeout(due);
    due.0
}

#[test]
fn both_kinds_of_request_are_answered_with_item_int() {
    let mut machine = upload(2);
    assert_eq!(sent(&mut machine), ["count 2"]);
    hear(&mut machine, 10, Body::Request { seq: 0 });
    assert_eq!(sent(&mut machine), ["item 0"]);
    hear(&mut machine, 20, Body::RequestInt { seq: 1 });
    assert_eq!(sent(&mut machine), ["item 1"]);
    hear(&mut machine, 30, ack(MissionResult::ACCEPTED));
    let outcome = machine.outcome().expect("over").expect("accepted");
    assert!(outcome.acknowledged);
    assert_eq!(machine.poll_timeout(), None);
}

#[test]
fn only_the_vehicle_speaking_to_us_about_this_list_counts() {
    let mut machine = upload(2);
    sent(&mut machine);
    let request = |target, list| say(target, list, Body::RequestInt { seq: 0 });
    for (from, message) in [
        (STRANGER, request(US, MissionType::Mission)),
        (VEHICLE, request(STRANGER, MissionType::Mission)),
        (VEHICLE, request(US, MissionType::Fence)),
        (
            Address {
                component: 100,
                ..VEHICLE
            },
            request(US, MissionType::Mission),
        ),
    ] {
        machine.handle(Time(5), from, &message);
        assert_eq!(sent(&mut machine), [""; 0], "{from:?} {message:?}");
    }
    machine.handle(
        Time(5),
        VEHICLE,
        &request(
            Address {
                system: 0,
                component: 0,
            },
            MissionType::Mission,
        ),
    );
    assert_eq!(sent(&mut machine), ["item 0"]);
}

#[test]
fn a_mission_that_px4_holds_and_says_it_will_not_fly_is_not_verified() {
    let mission = mission(Profile::Px4, 5);
    let run = |stranger: Vec<(Time, Address, Message)>| {
        let mut scene = Scene::new(1, CLEAR, vehicle(Profile::Px4), &mission);
        scene.stranger = stranger;
        scene.run()
    };
    let fine = run(Vec::new());
    assert_eq!(fine.verdict, Verdict::Verified);
    let address = vehicle(Profile::Px4).address();
    let text = "Mission rejected: starts with landing\t".to_owned();
    let says = Message::StatusText { severity: 2, text };
    // At once: of the mission before; a second before the end: of ours.
    let before = run(vec![(Time(1), address, says.clone())]);
    assert_eq!(before.verdict, Verdict::Verified);
    let lasted = std::time::Duration::from_secs_f64(fine.seconds).as_millis();
    let listened = Time(u64::try_from(lasted).expect("not long") - 1000);
    let report = run(vec![(listened, address, says)]);
    let Verdict::Failed(failure) = report.verdict else {
        panic!("{:?}", report.verdict)
    };
    assert_eq!(
        failure.to_string(),
        "the vehicle holds the mission, and will not fly it: Mission rejected: starts with landing"
    );
}

#[test]
fn the_count_is_sent_again_until_the_vehicle_counts_as_silent() {
    let mut machine = upload(2);
    assert_eq!(sent(&mut machine), ["count 2"]);
    for n in 1..20 {
        assert_eq!(wait(&mut machine), 1500 * n);
        assert_eq!(sent(&mut machine), ["count 2"]);
    }
    wait(&mut machine);
    assert_eq!(
        machine.outcome(),
        Some(Err(UploadError::Silent { counts: 20 }))
    );
}

#[test]
fn an_echo_of_a_request_is_answered_once() {
    let mut machine = upload(3);
    sent(&mut machine);
    hear(&mut machine, 10, Body::RequestInt { seq: 0 });
    hear(&mut machine, 60, Body::RequestInt { seq: 0 });
    assert_eq!(sent(&mut machine), ["item 0"]);
    hear(&mut machine, 200, Body::RequestInt { seq: 0 });
    assert_eq!(sent(&mut machine), ["item 0"]);
}

#[test]
fn the_last_requested_item_is_sent_again_after_250_ms_but_never_the_final_one() {
    let mut machine = upload(2);
    sent(&mut machine);
    hear(&mut machine, 10, Body::Request { seq: 0 });
    assert_eq!(sent(&mut machine), ["item 0"]);
    assert_eq!(wait(&mut machine), 260);
    assert_eq!(sent(&mut machine), ["item 0"]);
    hear(&mut machine, 300, Body::Request { seq: 1 });
    assert_eq!(sent(&mut machine), ["item 1"]);
    assert!(wait(&mut machine) >= 4000);
    assert_eq!(sent(&mut machine), [""; 0]);
}

#[test]
fn a_vehicle_whose_own_request_each_item_puts_off_is_left_room_for_it() {
    let mut upload = upload(3).with_min_gap(800);
    hear(&mut upload, 0, Body::RequestInt { seq: 0 });
    sent(&mut upload);
    assert_eq!(wait(&mut upload), 250);
    assert_eq!(sent(&mut upload), ["item 0"]);
    assert_eq!(wait(&mut upload), 1050);
    assert_eq!(sent(&mut upload), ["item 0"]);
}

#[test]
fn any_item_is_given_again_also_after_the_final_one() {
    let mut machine = upload(3);
    sent(&mut machine);
    for (at, seq) in [(10, 0), (20, 1), (30, 2), (1000, 1), (1200, 2)] {
        hear(&mut machine, at, Body::Request { seq });
        assert_eq!(sent(&mut machine), [format!("item {seq}")]);
    }
    hear(&mut machine, 1300, Body::Request { seq: 3 });
    assert_eq!(sent(&mut machine), [""; 0], "there is no item 3");
}

#[test]
fn accepted_counts_only_after_every_item_of_this_run_went_out() {
    let mut machine = upload(2);
    hear(&mut machine, 1, ack(MissionResult::ACCEPTED));
    hear(&mut machine, 10, Body::Request { seq: 0 });
    hear(&mut machine, 11, ack(MissionResult::ACCEPTED));
    assert_eq!(machine.outcome(), None);
    // Everything went out, then the vehicle gave up: what it accepted before is void.
    hear(&mut machine, 20, Body::Request { seq: 1 });
    hear(&mut machine, 30, ack(MissionResult::OPERATION_CANCELLED));
    hear(&mut machine, 31, ack(MissionResult::ACCEPTED));
    assert_eq!(machine.outcome(), None);
}

#[test]
fn invalid_sequence_is_not_fatal() {
    let mut machine = upload(2);
    hear(&mut machine, 10, Body::Request { seq: 0 });
    hear(&mut machine, 12, ack(MissionResult::INVALID_SEQUENCE));
    hear(&mut machine, 20, Body::Request { seq: 1 });
    hear(&mut machine, 22, ack(MissionResult::INVALID_SEQUENCE));
    hear(&mut machine, 30, ack(MissionResult::ACCEPTED));
    assert!(machine.outcome().expect("over").is_ok());
}

#[test]
fn invalid_sequence_to_a_repetition_brings_the_next_item_once() {
    let mut machine = upload(5);
    hear(&mut machine, 0, Body::Request { seq: 0 });
    // Not repeated yet: a double on the way, nothing more.
    hear(&mut machine, 5, ack(MissionResult::INVALID_SEQUENCE));
    assert_eq!(sent(&mut machine), ["count 5", "item 0"]);
    wait(&mut machine);
    assert_eq!(sent(&mut machine), ["item 0"]);
    hear(&mut machine, 260, ack(MissionResult::INVALID_SEQUENCE));
    assert_eq!(sent(&mut machine), ["item 1"]);
    // The request for it was only late.
    hear(&mut machine, 270, Body::Request { seq: 1 });
    assert_eq!(sent(&mut machine), [""; 0]);
    // A guess that was wrong: no second one, the vehicle has the word.
    wait(&mut machine);
    assert_eq!(sent(&mut machine), ["item 1"]);
    hear(&mut machine, 700, ack(MissionResult::INVALID_SEQUENCE));
    assert_eq!(sent(&mut machine), [""; 0]);
    hear(&mut machine, 800, Body::Request { seq: 0 });
    assert_eq!(sent(&mut machine), ["item 0"]);
    hear(&mut machine, 810, Body::Request { seq: 1 });
    assert_eq!(sent(&mut machine), ["item 1"]);
}

#[test]
fn after_the_silence_of_the_vehicle_the_transfer_is_cancelled_and_started_over() {
    let mut machine = upload(3);
    hear(&mut machine, 10, Body::Request { seq: 0 });
    hear(&mut machine, 20, Body::Request { seq: 1 });
    sent(&mut machine);
    let mut last = Vec::new();
    while wait(&mut machine) < 5020 {
        last = sent(&mut machine);
        assert_eq!(last, ["item 1"]);
    }
    assert_eq!(last, ["item 1"]);
    assert_eq!(sent(&mut machine), ["ack OPERATION_CANCELLED", "count 3"]);
}

#[test]
fn a_vehicle_that_gave_up_gets_the_count_again() {
    let mut machine = upload(3);
    hear(&mut machine, 10, Body::Request { seq: 0 });
    sent(&mut machine);
    hear(&mut machine, 8010, ack(MissionResult::OPERATION_CANCELLED));
    assert_eq!(sent(&mut machine), ["count 3"]);
    // Its echo does not start yet another one.
    hear(&mut machine, 8050, ack(MissionResult::OPERATION_CANCELLED));
    assert_eq!(sent(&mut machine), [""; 0]);
}

#[test]
fn a_storm_of_cancellations_is_answered_four_times_a_second() {
    let mut machine = upload(3);
    let mut answers = 0;
    for ms in 0..2000 {
        hear(&mut machine, ms, Body::Request { seq: 0 });
        hear(&mut machine, ms, ack(MissionResult::OPERATION_CANCELLED));
        machine.handle_timeout(Time(ms));
        answers += sent(&mut machine).len();
    }
    // The first restarts come at once; each start is a count and an item.
    assert!((16..=2 * (8 + 4)).contains(&answers), "{answers}");
}

#[test]
fn denied_backs_off_longer_and_longer_and_says_so_in_the_end() {
    let rows = vec![(waypoint(0), 1)];
    let mut machine = Upload::new(ROUTE, rows, 5000, Time(30_000), Time(0));
    let mut pauses = Vec::new();
    let mut now = 5;
    loop {
        sent(&mut machine);
        hear(&mut machine, now, ack(MissionResult::DENIED));
        let due = wait(&mut machine);
        pauses.push(due - now);
        if machine.outcome().is_some() {
            break;
        }
        assert_eq!(sent(&mut machine), ["count 1"]);
        now = due + 5;
    }
    assert_eq!(pauses[..4], [2000, 4000, 8000, 8000]);
    let error = machine
        .outcome()
        .expect("over")
        .expect_err("denied")
        .to_string();
    assert!(error.contains("another ground station"), "{error}");
}

#[test]
fn a_refusal_names_item_command_and_parameter() {
    let mut rows: Vec<(Item, u8)> = (0..3).map(|n| (waypoint(n), 0)).collect();
    rows[1].0.params[0] = f32::NAN;
    let mut machine = Upload::new(ROUTE, rows, 5000, Time(600_000), Time(0));
    hear(&mut machine, 10, Body::Request { seq: 0 });
    hear(&mut machine, 20, Body::Request { seq: 1 });
    hear(&mut machine, 30, ack(MissionResult(6)));
    let error = machine
        .outcome()
        .expect("over")
        .expect_err("refused")
        .to_string();
    assert_eq!(
        error,
        "refused with INVALID_PARAM1 at sequence number 1 (command 16, param1 = NaN)"
    );
}

#[test]
fn an_unknown_result_code_is_a_refusal_with_its_number() {
    let mut machine = upload(2);
    hear(&mut machine, 10, Body::Request { seq: 0 });
    hear(&mut machine, 20, ack(MissionResult(77)));
    let error = machine
        .outcome()
        .expect("over")
        .expect_err("refused")
        .to_string();
    assert!(error.contains("result 77"), "{error}");
}

#[test]
fn error_starts_over_twice_and_is_a_refusal_the_third_time() {
    let mut machine = upload(3);
    for (n, at) in [0_u64, 100, 200].into_iter().enumerate() {
        hear(&mut machine, at + 10, Body::Request { seq: 0 });
        hear(&mut machine, at + 20, Body::Request { seq: 1 });
        sent(&mut machine);
        hear(&mut machine, at + 30, ack(MissionResult::ERROR));
        assert_eq!(machine.outcome().is_some(), n == 2);
    }
    let error = machine
        .outcome()
        .expect("over")
        .expect_err("refused")
        .to_string();
    assert!(
        error.starts_with("refused with ERROR at sequence number 1"),
        "{error}"
    );
}

#[test]
fn a_busy_px4_is_cancelled_before_the_next_count() {
    let mut machine = upload(2);
    sent(&mut machine);
    hear(&mut machine, 10, ack(MissionResult::ERROR));
    assert_eq!(sent(&mut machine), [""; 0]);
    assert_eq!(wait(&mut machine), 1500);
    assert_eq!(sent(&mut machine), ["ack OPERATION_CANCELLED", "count 2"]);
}

#[test]
fn a_lost_final_ack_is_left_to_the_read_back() {
    for end in ["silence", "error"] {
        let mut machine = upload(2);
        hear(&mut machine, 10, Body::Request { seq: 0 });
        hear(&mut machine, 20, Body::Request { seq: 1 });
        sent(&mut machine);
        if end == "error" {
            hear(&mut machine, 30, ack(MissionResult::ERROR));
        } else {
            assert_eq!(wait(&mut machine), 4020);
        }
        assert_eq!(sent(&mut machine), [""; 0]);
        let outcome = machine.outcome().expect("over").expect("sent");
        assert!(!outcome.acknowledged);
    }
}

#[test]
fn the_deadline_holds_whatever_else_arrives() {
    let rows = vec![(waypoint(0), 1), (waypoint(1), 0)];
    let mut machine = Upload::new(ROUTE, rows, 5000, Time(20_000), Time(0));
    let mut now = 0;
    while machine.outcome().is_none() {
        now += 50;
        assert!(now <= 20_050);
        hear(&mut machine, now, Body::Request { seq: 0 });
        hear(&mut machine, now, ack(MissionResult::INVALID_SEQUENCE));
        machine.handle(
            Time(now),
            STRANGER,
            &say(US, MissionType::Mission, Body::Request { seq: 1 }),
        );
        machine.handle_timeout(Time(now));
        sent(&mut machine);
    }
    assert!(matches!(
        machine.outcome(),
        Some(Err(UploadError::OutOfTime { seq: 0, .. }))
    ));
}

#[test]
fn more_items_than_a_count_can_say_are_refused_before_anything_is_sent() {
    let mut machine = Upload::new(ROUTE, vec![(waypoint(0), 0); 65536], 5000, Time(9), Time(0));
    assert_eq!(sent(&mut machine), [""; 0]);
    assert_eq!(
        machine.outcome(),
        Some(Err(UploadError::TooMany { items: 65536 }))
    );
}

// ---------------------------------------------------------------- the download machine alone

#[test]
fn a_download_asks_one_by_one_ignores_duplicates_and_ends_with_an_ack() {
    let mut machine = Download::new(ROUTE, Time(60_000), Time(0));
    let mut hear = |now, body| {
        machine.handle(Time(now), VEHICLE, &say(US, MissionType::Mission, body));
        std::iter::from_fn(|| machine.poll_transmit()).collect::<Vec<_>>()
    };
    let item = |seq| Body::ItemInt {
        seq,
        current: 0,
        item: waypoint(seq),
    };
    assert_eq!(
        hear(1, item(0)),
        [say(VEHICLE, MissionType::Mission, Body::RequestList)]
    );
    let request = |seq| [say(VEHICLE, MissionType::Mission, Body::RequestInt { seq })];
    assert_eq!(
        hear(
            10,
            Body::Count {
                count: 2,
                opaque_id: 0
            }
        ),
        request(0)
    );
    assert_eq!(hear(20, item(1)), []);
    assert_eq!(hear(30, item(0)), request(1));
    assert_eq!(hear(40, item(0)), []);
    assert_eq!(
        hear(
            40,
            Body::Count {
                count: 2,
                opaque_id: 0
            }
        ),
        []
    );
    assert_eq!(
        hear(50, item(1)),
        [say(
            VEHICLE,
            MissionType::Mission,
            ack(MissionResult::ACCEPTED)
        )]
    );
    assert_eq!(machine.outcome(), Some(&Ok(vec![waypoint(0), waypoint(1)])));
}

#[test]
fn a_download_of_nothing_is_complete_and_acknowledged_at_once() {
    let mut machine = Download::new(ROUTE, Time(60_000), Time(0));
    machine.poll_transmit();
    let none = Body::Count {
        count: 0,
        opaque_id: 0,
    };
    machine.handle(Time(5), VEHICLE, &say(US, MissionType::Mission, none));
    let closing = say(VEHICLE, MissionType::Mission, ack(MissionResult::ACCEPTED));
    assert_eq!(machine.poll_transmit(), Some(closing));
    assert_eq!(machine.outcome(), Some(&Ok(Vec::new())));
}

/// What becomes of a download from a vehicle that counts three items and answers requests like this, and when.
fn read_from(answer: impl Fn(u16) -> Option<Body>) -> (Option<DownloadError>, Time) {
    let mut machine = Download::new(ROUTE, Time(600_000), Time(0));
    let mut now = Time(0);
    while machine.outcome().is_none() {
        while let Some(message) = machine.poll_transmit() {
            let Message::Mission(MissionMessage { body, .. }) = message else {
                continue;
            };
            let answered = match body {
                Body::RequestList => Some(Body::Count {
                    count: 3,
                    opaque_id: 0,
                }),
                Body::RequestInt { seq } => answer(seq),
                _ => None,
            };
            if let Some(body) = answered {
                machine.handle(now, VEHICLE, &say(US, MissionType::Mission, body));
            }
        }
        now = now + 20;
        machine.handle_timeout(now);
    }
    (machine.outcome().and_then(|of| of.clone().err()), now)
}

#[test]
fn a_vehicle_that_answers_in_float_degrees_alone_is_named_at_once_as_not_supported() {
    let (error, at) = read_from(|seq| {
        Some(Body::Item {
            seq,
            current: 0,
            item: waypoint(seq),
        })
    });
    let error = error.expect("no list");
    assert!(
        error
            .to_string()
            .contains("MISSION_ITEM_INT is not supported"),
        "{error}"
    );
    assert!(at < Time(20_000), "{at:?}");
}

#[test]
fn a_vehicle_that_answers_no_request_for_an_item_is_named_within_two_minutes() {
    let (error, at) = read_from(|_| None);
    let error = error.expect("no list");
    assert!(
        error
            .to_string()
            .contains("answered no MISSION_REQUEST_INT"),
        "{error}"
    );
    assert!(at < Time(120_000), "{at:?}");
}

// ---------------------------------------------------------------- whole sessions

#[test]
fn every_profile_is_loaded_over_a_clear_link() {
    for profile in PROFILES {
        let mission = mission(profile, 20);
        let mut scene = Scene::new(1, CLEAR, vehicle(profile), &mission);
        let report = scene.run();
        assert_eq!(report.verdict, Verdict::Verified, "{profile:?} {report:?}");
        assert!(holds(&scene.vehicle, profile, &mission), "{profile:?}");
        assert_eq!((report.attempts, report.retries), (3, 0), "{profile:?}");
    }
}

#[test]
fn a_reboot_in_mid_transfer_is_survived() {
    for profile in PROFILES {
        for at in [20, 60, 100, 140, 200, 260] {
            let mission = mission(profile, 20);
            let mut scene = Scene::new(at, CLEAR, vehicle(profile), &mission);
            scene.event = Event::Reboot(Time(at));
            let report = scene.run();
            assert_eq!(
                report.verdict,
                Verdict::Verified,
                "{profile:?} {at} {report:?}"
            );
            assert!(holds(&scene.vehicle, profile, &mission), "{profile:?} {at}");
        }
    }
}

#[test]
fn a_link_that_dies_for_a_while_is_survived_and_one_that_stays_dead_is_not() {
    for profile in PROFILES {
        let mission = mission(profile, 20);
        let mut scene = Scene::new(3, CLEAR, vehicle(profile), &mission);
        scene.event = Event::Silence(Time(100), Time(14_000));
        let report = scene.run();
        assert_eq!(report.verdict, Verdict::Verified, "{profile:?} {report:?}");
        assert!(holds(&scene.vehicle, profile, &mission));
        let mut scene = Scene::new(3, CLEAR, vehicle(profile), &mission);
        scene.event = Event::Silence(Time(100), Time(3_000_000));
        let report = scene.run();
        assert!(
            matches!(report.verdict, Verdict::Failed(_)),
            "{profile:?} {report:?}"
        );
        assert!(!holds(&scene.vehicle, profile, &mission));
    }
}

#[test]
fn a_vehicle_that_is_starting_is_waited_for() {
    for profile in [Profile::ArduPilot, Profile::Px4] {
        let mission = mission(profile, 5);
        let mut starting = vehicle(profile);
        starting.reboot(Time(0));
        let mut scene = Scene::new(4, CLEAR, starting, &mission);
        let report = scene.run();
        assert_eq!(report.verdict, Verdict::Verified, "{profile:?} {report:?}");
        assert_eq!(report.attempts, 3, "nothing was sent before it was ready");
        assert!(report.seconds > 3.0);
    }
}

#[test]
fn a_vehicle_that_is_armed_in_mid_transfer_is_left_alone() {
    let mission = mission(Profile::ArduPilot, 400);
    let mut scene = Scene::new(5, CLEAR, vehicle(Profile::ArduPilot), &mission);
    scene.event = Event::Arm(Time(500));
    let report = scene.run();
    assert_eq!(report.verdict, Verdict::Failed(Failure::ArmedMeanwhile));
    assert!(report.seconds < 3.0);
}

#[test]
fn a_vehicle_that_never_answers_fails_in_time_and_says_so() {
    for profile in PROFILES {
        let mission = mission(profile, 5);
        let mut scene = Scene::new(6, CLEAR, vehicle(profile), &mission);
        scene.mute = true;
        let report = scene.run();
        let Verdict::Failed(failure) = report.verdict else {
            panic!("{report:?}")
        };
        assert_eq!(
            failure.to_string(),
            "fence: no answer to 20 MISSION_COUNT messages"
        );
        assert!(report.seconds < 40.0);
    }
}

#[test]
fn a_full_vehicle_fails_and_says_so() {
    let mission = mission(Profile::ArduPilot, 700);
    let mut scene = Scene::new(7, CLEAR, vehicle(Profile::ArduPilot), &mission);
    let report = scene.run();
    let Verdict::Failed(failure) = report.verdict else {
        panic!("{report:?}")
    };
    assert_eq!(failure.to_string(), "mission: refused with NO_SPACE");
    assert_eq!(scene.vehicle.items(MissionType::Mission), []);
}

#[test]
fn a_refused_item_is_named_and_a_mix_of_old_and_new_is_never_called_a_success() {
    let before = mission(Profile::ArduPilot, 30);
    let mut scene = Scene::new(8, CLEAR, vehicle(Profile::ArduPilot), &before);
    assert!(scene.run().is_verified());
    let mut bad = mission(Profile::ArduPilot, 30);
    bad.items[9].z = f32::NAN;
    let mut scene = Scene::new(8, CLEAR, scene.vehicle, &bad);
    let report = scene.run();
    let Verdict::Failed(failure) = report.verdict else {
        panic!("{report:?}")
    };
    assert_eq!(
        failure.to_string(),
        "mission: refused with INVALID_PARAM7 at sequence number 10 (command 16, z = NaN)"
    );
    assert!(!holds(&scene.vehicle, Profile::ArduPilot, &bad));
}

#[test]
fn px4_keeps_its_old_mission_when_it_refuses_a_new_one() {
    let before = mission(Profile::Px4, 10);
    let mut scene = Scene::new(9, CLEAR, vehicle(Profile::Px4), &before);
    assert!(scene.run().is_verified());
    let mut bad = mission(Profile::Px4, 12);
    bad.items[9].frame = frame::GLOBAL_TERRAIN_ALT;
    let mut scene = Scene::new(9, CLEAR, scene.vehicle, &bad);
    let report = scene.run();
    let Verdict::Failed(failure) = report.verdict else {
        panic!("{report:?}")
    };
    assert_eq!(
        failure.to_string(),
        "mission: refused with UNSUPPORTED_FRAME at sequence number 9 (command 16, frame 10)"
    );
    assert!(holds(&scene.vehicle, Profile::Px4, &before));
}

#[test]
fn what_a_foreign_ground_station_says_and_hears_is_not_ours() {
    for profile in PROFILES {
        let mission = mission(profile, 20);
        let mut scene = Scene::new(10, CLEAR, vehicle(profile), &mission);
        for at in (0..600).step_by(7) {
            let at = Time(at);
            // Another vehicle talks to us and to the stranger; the stranger talks to everybody.
            let other = Address {
                system: 9,
                component: 1,
            };
            let list = MissionType::ALL[usize::try_from(at.0 % 3).expect("small")];
            for (name, target, body) in [
                (other, STRANGER, ack(MissionResult::ACCEPTED)),
                (other, US, ack(MissionResult::ACCEPTED)),
                (other, US, Body::RequestInt { seq: 2 }),
                (VEHICLE, STRANGER, ack(MissionResult::UNSUPPORTED)),
                (
                    VEHICLE,
                    STRANGER,
                    Body::Count {
                        count: 0,
                        opaque_id: 0,
                    },
                ),
                (STRANGER, US, ack(MissionResult::NO_SPACE)),
                (STRANGER, VEHICLE, ack(MissionResult::ACCEPTED)),
            ] {
                scene.stranger.push((at, name, say(target, list, body)));
            }
        }
        let report = scene.run();
        assert_eq!(report.verdict, Verdict::Verified, "{profile:?} {report:?}");
        assert!(holds(&scene.vehicle, profile, &mission), "{profile:?}");
        assert_eq!(report.attempts, 3, "{profile:?}");
    }
}

#[test]
fn a_foreign_upload_in_progress_is_waited_for() {
    for profile in [Profile::ArduPilot, Profile::Px4] {
        let mission = mission(profile, 10);
        let mut busy = vehicle(profile);
        let count = Body::Count {
            count: 9,
            opaque_id: 0,
        };
        busy.handle(
            Time(0),
            STRANGER,
            &say(VEHICLE, MissionType::Mission, count),
        );
        let mut scene = Scene::new(11, CLEAR, busy, &mission);
        let report = scene.run();
        assert_eq!(report.verdict, Verdict::Verified, "{profile:?} {report:?}");
        assert!(holds(&scene.vehicle, profile, &mission), "{profile:?}");
        assert!(report.seconds > 4.0, "{profile:?} {report:?}");
    }
}

#[test]
fn a_vehicle_says_which_software_it_runs_and_px4_what_it_calls_its_lists() {
    for (profile, version, has_ids) in [
        (Profile::ArduPilot, "4.6.3", false),
        (Profile::Px4, "1.17.0", true),
        (Profile::Generic, "", false),
    ] {
        let mission = mission(profile, 5);
        let report = Scene::new(1, CLEAR, vehicle(profile), &mission).run();
        assert_eq!(report.version, version);
        assert_eq!(report.plan_ids.map(|id| id != 0), [has_ids; 3]);
    }
}

#[test]
fn a_stale_acceptance_at_the_start_is_no_success() {
    for profile in PROFILES {
        let mission = mission(profile, 10);
        let mut scene = Scene::new(12, CLEAR, vehicle(profile), &mission);
        scene.mute = true;
        for list in MissionType::ALL {
            for at in (0..40_000).step_by(100) {
                let stale = say(US, list, ack(MissionResult::ACCEPTED));
                scene.stranger.push((Time(at), VEHICLE, stale));
            }
        }
        scene.stranger.sort_by_key(|(at, ..)| *at);
        let report = scene.run();
        assert!(
            matches!(report.verdict, Verdict::Failed(_)),
            "{profile:?} {report:?}"
        );
    }
}

#[test]
fn what_was_on_board_before_is_replaced_and_empty_lists_are_emptied() {
    for profile in PROFILES {
        let before = mission(profile, 60);
        let mut scene = Scene::new(13, CLEAR, vehicle(profile), &before);
        assert!(scene.run().is_verified());
        let mut after = mission(profile, 3);
        (after.fence, after.rally) = (Vec::new(), Vec::new());
        let mut scene = Scene::new(13, CLEAR, scene.vehicle, &after);
        let report = scene.run();
        assert_eq!(report.verdict, Verdict::Verified, "{profile:?} {report:?}");
        assert!(holds(&scene.vehicle, profile, &after), "{profile:?}");
        assert_eq!((report.items, report.fence, report.rally), (6, 0, 0));
    }
}

#[test]
fn a_vehicle_that_keeps_something_else_fails_and_item_and_field_are_named() {
    for (profile, seq) in [(Profile::ArduPilot, 3), (Profile::Px4, 2)] {
        let mission = mission(profile, 10);
        let mut scene = Scene::new(14, CLEAR, vehicle(profile), &mission);
        scene.lifted = Some(seq);
        let report = scene.run();
        let Verdict::Failed(failure) = &report.verdict else {
            panic!("{report:?}")
        };
        assert_eq!(
            failure.to_string(),
            "mission: the vehicle holds something else than was sent (differences: 1)"
        );
        let [difference] = &report.differences[..] else {
            panic!("{report:?}")
        };
        let text = difference.to_string();
        assert!(
            text.starts_with("mission item 3: z sent 480.37, read back 481.3"),
            "{text}"
        );
        assert_eq!(report.hash, "");
    }
}

#[test]
fn the_hash_tells_missions_apart_and_is_the_same_for_the_same() {
    let hash_of = |waypoints, seed| {
        let mission = mission(Profile::Px4, waypoints);
        Scene::new(seed, CLEAR, vehicle(Profile::Px4), &mission)
            .run()
            .hash
    };
    assert_eq!(hash_of(4, 1), hash_of(4, 2));
    assert_ne!(hash_of(4, 1), hash_of(5, 1));
}

// ---------------------------------------------------------------- sweeps

/// How many seeds for each profile; `SORTIE_SEEDS` asks for more.
fn seeds() -> u64 {
    std::env::var("SORTIE_SEEDS")
        .ok()
        .and_then(|n| n.parse().ok())
        .unwrap_or(200)
}

#[test]
fn sixty_items_at_25_percent_loss_each_way_always_arrive_within_300_s() {
    let weather = Weather {
        loss: 0.25,
        duplication: 0.0,
        corruption: 0.0,
        delay_ms: (10, 40),
    };
    for profile in PROFILES {
        let mission = mission(profile, 57);
        let mut seconds: Vec<f64> = Vec::new();
        for seed in 0..seeds() {
            let mut scene = Scene::new(seed, weather, vehicle(profile), &mission);
            let report = scene.run();
            assert!(report.is_verified(), "{profile:?} seed {seed}: {report:?}");
            assert!(
                holds(&scene.vehicle, profile, &mission),
                "{profile:?} seed {seed}"
            );
            seconds.push(report.seconds);
        }
        seconds.sort_by(f64::total_cmp);
        let (median, worst) = (seconds[seconds.len() / 2], seconds[seconds.len() - 1]);
        println!("{profile:?}: median {median} s, worst {worst} s");
        assert!(worst < 300.0, "{profile:?}");
    }
}

/// One list of 200 items, as one of a hundred vehicles has it: the slowest of them counts.
#[test]
fn two_hundred_items_at_5_percent_loss_each_way_take_seconds_also_for_the_unlucky() {
    let weather = Weather {
        loss: 0.05,
        delay_ms: (1, 3),
        ..CLEAR
    };
    for profile in PROFILES {
        let mut mission = mission(profile, 197);
        (mission.fence, mission.rally) = (Vec::new(), Vec::new());
        let mut worst = 0.0_f64;
        let mut sum = 0.0;
        for seed in 0..100 {
            let mut scene = Scene::new(seed, weather, vehicle(profile), &mission);
            let report = scene.run();
            assert!(report.is_verified(), "{profile:?} seed {seed}: {report:?}");
            assert!(holds(&scene.vehicle, profile, &mission), "{profile:?}");
            worst = worst.max(report.seconds);
            sum += report.seconds;
        }
        println!("{profile:?}: mean {} s, worst {worst} s", sum / 100.0);
        let max_s = if profile == Profile::Generic {
            30.0
        } else {
            15.0
        };
        assert!(worst < max_s, "{profile:?}: {worst} s");
    }
}

/// One random transfer over random weather: whether the vehicle then holds exactly
/// our items, and what was reported.
fn random_transfer(profile: Profile, seed: u64, storm: bool) -> (bool, TransferReport) {
    let mut rng = Seed(seed).stream("scenario", u64::from(storm));
    let (max_loss, max_delay_ms) = if storm { (0.6, 1500) } else { (0.25, 400) };
    let weather = Weather {
        loss: rng.random_range(0.0..max_loss),
        duplication: rng.random_range(0.0..0.2),
        corruption: rng.random_range(0.0..0.05),
        delay_ms: (5, rng.random_range(5..max_delay_ms)),
    };
    let mut before = mission(profile, rng.random_range(0..40));
    before.items[0].y += 5;
    let mut ours = mission(profile, rng.random_range(0..40));
    if rng.random_bool(0.2) {
        ours.fence.clear();
    }
    if rng.random_bool(0.2) {
        ours.rally.clear();
    }
    if rng.random_bool(0.1) {
        let at = rng.random_range(0..ours.items.len());
        ours.items[at].command = 60_000;
    }
    let mut old = Scene::new(seed, CLEAR, vehicle(profile), &before);
    assert!(old.run().is_verified());
    let mut scene = Scene::new(seed, weather, old.vehicle, &ours);
    let at = Time(rng.random_range(0..20_000));
    scene.event = match rng.random_range(0..4) {
        0 => Event::Reboot(at),
        1 if storm => Event::Arm(at),
        2 if storm => Event::Silence(at, at + rng.random_range(100..60_000_u64)),
        _ => Event::Nothing,
    };
    let report = scene.run();
    (holds(&scene.vehicle, profile, &ours), report)
}

#[test]
fn success_is_reported_if_and_only_if_the_vehicle_holds_exactly_our_items() {
    for profile in PROFILES {
        let (mut verified, mut failed) = (0, 0);
        for seed in 0..seeds() {
            let (is_held, report) = random_transfer(profile, seed, false);
            assert_eq!(
                report.is_verified(),
                is_held,
                "{profile:?} seed {seed}: {report:?}"
            );
            if is_held { verified += 1 } else { failed += 1 }
        }
        println!("{profile:?}: {verified} verified, {failed} failed");
        assert!(
            verified > failed,
            "{profile:?}: {verified} verified, {failed} failed"
        );
    }
}

/// Where a link or a transfer breaks off, nobody can know what the vehicle holds:
/// then a failure may be reported although everything is on board, never the reverse.
#[test]
fn in_a_storm_success_is_never_false_and_doubt_is_called_a_failure() {
    for profile in PROFILES {
        let (mut verified, mut doubtful, mut failed) = (0, 0, 0);
        for seed in 0..seeds() {
            let (is_held, report) = random_transfer(profile, seed, true);
            match (&report.verdict, is_held) {
                (Verdict::Verified, true) => verified += 1,
                (Verdict::Failed(_), false) | (Verdict::Refused(Refusal::Armed), false) => {
                    failed += 1
                }
                (
                    Verdict::Failed(
                        Failure::ReadBack { .. }
                        | Failure::Upload {
                            error: UploadError::OutOfTime { .. },
                            ..
                        }
                        | Failure::OutOfTime { .. }
                        | Failure::ArmedMeanwhile,
                    ),
                    true,
                ) => doubtful += 1,
                _ => panic!("{profile:?} seed {seed}: held {is_held}, {report:?}"),
            }
        }
        println!("{profile:?}: {verified} verified, {doubtful} in doubt, {failed} failed");
        assert!(verified > 0 && failed > 0, "{profile:?}");
    }
}
