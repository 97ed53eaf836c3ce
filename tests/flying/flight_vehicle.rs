//! The simulated vehicles fly the mission they hold, in virtual time.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss
)]

use sortie::geodesy::{LatLon, LocalFrame};
use sortie::link::*;
use sortie::mission::{Home, Item, command, frame};
use sortie::simulator::{Profile, Surroundings, Vehicle};
use sortie::spec::Wind;

const US: Address = Address {
    system: 245,
    component: 190,
};
const HOME: Home = Home {
    x: 363_000_000,
    y: -842_500_000,
    amsl_m: 400.0,
};
const ACCEPTED: CommandResult = CommandResult::ACCEPTED;

/// One position: seconds, metres east and north of home, metres above the sea, speed.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Fix {
    t_s: f64,
    at_m: [f64; 3],
    speed_mps: f64,
}

struct Bench {
    vehicle: Vehicle,
    profile: Profile,
    now: Time,
    fixes: Vec<Fix>,
    reached: Vec<u16>,
    current: u16,
    landed: LandedState,
    texts: Vec<String>,
    acks: Vec<CommandResult>,
}

fn origin() -> LocalFrame {
    LocalFrame::new(LatLon {
        lat_deg: 36.3,
        lon_deg: -84.25,
    })
}

impl Bench {
    fn new(profile: Profile, surroundings: Surroundings) -> Self {
        let mut bench = Self {
            vehicle: Vehicle::within(profile, 1, Some(HOME), surroundings, Time(0)),
            profile,
            now: Time(0),
            fixes: Vec::new(),
            reached: Vec::new(),
            current: 0,
            landed: LandedState::ON_GROUND,
            texts: Vec::new(),
            acks: Vec::new(),
        };
        bench.fly(1.0);
        bench
    }

    fn listen(&mut self) {
        while let Some(message) = self.vehicle.poll_transmit() {
            match message {
                Message::Flight(FlightMessage::Position(position)) => {
                    let place = LatLon {
                        lat_deg: f64::from(position.x) / 1e7,
                        lon_deg: f64::from(position.y) / 1e7,
                    };
                    let at = origin().to_plan(place);
                    let [north, east, _] = position.velocity_cmps.map(f64::from);
                    self.fixes.push(Fix {
                        t_s: f64::from(position.boot_ms) / 1000.0,
                        at_m: [at.east_m, at.north_m, f64::from(position.amsl_mm) / 1000.0],
                        speed_mps: north.hypot(east) / 100.0,
                    });
                }
                Message::Flight(FlightMessage::ItemReached { seq }) => self.reached.push(seq),
                Message::Flight(FlightMessage::Landed(state)) => self.landed = state,
                Message::Flight(FlightMessage::CommandAck { result, .. }) => self.acks.push(result),
                Message::MissionCurrent { seq, .. } => self.current = seq,
                Message::StatusText { text, .. } => self.texts.push(text),
                _ => {}
            }
        }
    }

    /// Flies for so many seconds of the vehicle's own time.
    fn fly(&mut self, seconds: f64) {
        let until = self.now + (seconds * 1000.0) as u64;
        while self.vehicle.poll_timeout() <= until {
            self.now = self.vehicle.poll_timeout().max(self.now);
            self.vehicle.handle_timeout(self.now);
            self.listen();
        }
        self.now = until;
    }

    /// Until the motors stop; how long that took.
    fn fly_until_disarmed(&mut self, max_s: f64) -> f64 {
        let began = self.now;
        while self.vehicle.is_armed() {
            self.fly(1.0);
            let since_s = (self.now - began) as f64 / 1000.0;
            assert!(since_s < max_s, "still armed after {since_s} s");
        }
        (self.now - began) as f64 / 1000.0
    }

    fn order<const N: usize>(&mut self, command: u16, params: [f32; N]) -> CommandResult {
        let message = FlightMessage::Command {
            target: self.vehicle.address(),
            order: Command::new(command, params),
        };
        self.vehicle.handle(self.now, US, &Message::Flight(message));
        self.listen();
        self.acks.pop().expect("an answer")
    }

    fn hear_body(&mut self, body: Body) {
        let message = Message::Mission(MissionMessage {
            target: self.vehicle.address(),
            mission_type: 0,
            body,
        });
        self.vehicle.handle(self.now, US, &message);
        self.listen();
    }

    /// Uploads items; ArduPilot's first row is for its home.
    fn load(&mut self, items: &[Item]) {
        let mut rows = items.to_vec();
        if self.profile == Profile::ArduPilot {
            rows.insert(0, items[0]);
        }
        let count = u16::try_from(rows.len()).expect("few items");
        let opaque_id = 0;
        self.hear_body(Body::Count { count, opaque_id });
        for (seq, item) in (0..count).zip(rows) {
            let current = 0;
            self.hear_body(Body::ItemInt { seq, current, item });
        }
    }

    /// Arms and starts, as each autopilot wants it.
    fn start(&mut self) {
        match self.profile {
            Profile::ArduPilot => {
                assert_eq!(self.order(Command::DO_SET_MODE, [1.0, 4.0]), ACCEPTED);
                assert_eq!(self.order(Command::COMPONENT_ARM_DISARM, [1.0]), ACCEPTED);
                assert_eq!(self.order(Command::MISSION_START, [0.0, 0.0]), ACCEPTED);
            }
            _ => {
                assert_eq!(self.order(Command::COMPONENT_ARM_DISARM, [1.0]), ACCEPTED);
                assert_eq!(self.order(Command::DO_SET_MODE, [1.0, 4.0, 4.0]), ACCEPTED);
            }
        }
    }

    fn last(&self) -> Fix {
        *self.fixes.last().expect("a position")
    }
}

fn item(command: u16, east_m: f64, north_m: f64, amsl_m: f64, param1: f32) -> Item {
    let place = origin().from_plan(sortie::geodesy::EastNorth { east_m, north_m });
    Item {
        command,
        frame: frame::GLOBAL,
        autocontinue: true,
        params: [param1, 0.0, 0.0, 0.0],
        x: (place.lat_deg * 1e7).round() as i32,
        y: (place.lon_deg * 1e7).round() as i32,
        z: amsl_m as f32,
    }
}

fn waypoint(east_m: f64, north_m: f64, amsl_m: f64) -> Item {
    item(command::NAV_WAYPOINT, east_m, north_m, amsl_m, 0.0)
}

/// Up, a dog-leg of 40 degrees with a climb, down at its end.
fn dog_leg() -> Vec<Item> {
    vec![
        item(command::NAV_TAKEOFF, 0.0, 0.0, 480.0, 0.0),
        waypoint(1000.0, 0.0, 480.0),
        waypoint(1766.0, 642.8, 560.0),
        item(command::NAV_LAND, 1766.0, 642.8, 400.0, 0.0),
    ]
}

fn set_up(profile: Profile) -> Surroundings {
    let params: &[(&str, f32)] = match profile {
        Profile::ArduPilot => &[
            ("WPNAV_SPEED", 1500.0),
            ("WPNAV_RADIUS", 500.0),
            ("WPNAV_ACCEL_C", 250.0),
            ("WPNAV_SPEED_UP", 300.0),
            ("WPNAV_SPEED_DN", 200.0),
        ],
        _ => &[
            ("MPC_XY_CRUISE", 15.0),
            ("MPC_XY_VEL_MAX", 15.0),
            ("NAV_ACC_RAD", 5.0),
            ("MPC_TKO_SPEED", 3.0),
        ],
    };
    Surroundings {
        params: params.iter().map(|(n, v)| ((*n).to_owned(), *v)).collect(),
        ..Surroundings::default()
    }
}

/// Distance of a point from the way between two others, and its height over it.
fn beside(at: [f64; 3], from: [f64; 3], to: [f64; 3]) -> (f64, f64) {
    let along = [to[0] - from[0], to[1] - from[1]];
    let gone = [at[0] - from[0], at[1] - from[1]];
    let length_sq = along[0] * along[0] + along[1] * along[1];
    let share = ((gone[0] * along[0] + gone[1] * along[1]) / length_sq).clamp(0.0, 1.0);
    let foot = [0, 1].map(|axis| from[axis] + share * along[axis]);
    let high = from[2] + share * (to[2] - from[2]);
    ((at[0] - foot[0]).hypot(at[1] - foot[1]), at[2] - high)
}

#[test]
fn both_autopilots_fly_what_they_hold_and_stop_their_motors_after_landing() {
    for profile in [Profile::ArduPilot, Profile::Px4] {
        let mut bench = Bench::new(profile, set_up(profile));
        bench.load(&dog_leg());
        bench.start();
        let took_s = bench.fly_until_disarmed(400.0);
        let points = [
            [0.0, 0.0, 480.0],
            [1000.0, 0.0, 480.0],
            [1766.0, 642.8, 560.0],
        ];
        let cruising = |fix: &&Fix| fix.at_m[2] > 479.0 && fix.at_m[0] > 5.0;
        let errors: Vec<(f64, f64)> = bench
            .fixes
            .iter()
            .filter(cruising)
            .filter(|fix| fix.at_m[0] < 1760.0)
            .map(|fix| {
                let legs = points.windows(2).map(|p| beside(fix.at_m, p[0], p[1]));
                legs.min_by(|a, b| a.0.total_cmp(&b.0)).expect("two legs")
            })
            .collect();
        assert!(errors.len() > 300, "{}", errors.len());
        let widest = errors.iter().map(|e| e.0).fold(0.0, f64::max);
        let highest = errors.iter().map(|e| e.1.abs()).fold(0.0, f64::max);
        assert!(widest < 5.5, "{profile:?}: {widest} m beside the way");
        assert!(highest < 1.5, "{profile:?}: {highest} m over or under it");
        let fastest = bench
            .fixes
            .iter()
            .map(|fix| fix.speed_mps)
            .fold(0.0, f64::max);
        assert!(
            (14.5..15.2).contains(&fastest),
            "{profile:?}: {fastest} m/s"
        );
        let end = bench.last().at_m;
        assert!((end[0] - 1766.0).hypot(end[1] - 642.8) < 1.5, "{end:?}");
        assert!((end[2] - 400.0).abs() < 0.2, "{end:?}");
        assert!((170.0..300.0).contains(&took_s), "{profile:?}: {took_s} s");
        let first = u16::from(profile == Profile::ArduPilot);
        let mut reached = bench.reached.clone();
        reached.dedup();
        assert_eq!(
            reached,
            (first..first + 4).collect::<Vec<u16>>(),
            "{profile:?}"
        );
        if profile == Profile::Px4 {
            assert!(bench.reached.len() >= 30, "each is said about ten times");
        }
        assert_eq!(bench.landed, LandedState::ON_GROUND);
    }
}

#[test]
fn the_same_seed_flies_the_same_way_and_gusts_and_noise_show() {
    let flown = |seed: u64, noise_m: f64| {
        let surroundings = Surroundings {
            wind: Some(Wind {
                from_rad: 1.0,
                speed_mps: 8.0,
            }),
            noise_m,
            seed,
            ..set_up(Profile::ArduPilot)
        };
        let mut bench = Bench::new(Profile::ArduPilot, surroundings);
        bench.load(&dog_leg());
        bench.start();
        bench.fly(60.0);
        bench.fixes
    };
    assert_eq!(flown(7, 1.0), flown(7, 1.0));
    assert_ne!(flown(7, 1.0), flown(8, 1.0));
    let first_leg = |fixes: &[Fix]| {
        let on_it = fixes
            .iter()
            .filter(|fix| (50.0..400.0).contains(&fix.at_m[0]));
        on_it.map(|fix| fix.at_m[1].abs()).fold(0.0, f64::max)
    };
    let gusts = first_leg(&flown(7, 0.0));
    assert!((0.01..3.0).contains(&gusts), "{gusts}");
    assert!(first_leg(&flown(7, 1.0)) > gusts);
}

#[test]
fn a_hold_stops_it_and_the_mission_goes_on_from_there() {
    for profile in [Profile::ArduPilot, Profile::Px4] {
        let mut bench = Bench::new(profile, set_up(profile));
        bench.load(&dog_leg());
        bench.start();
        bench.fly(70.0);
        let hold = bench.last();
        assert!(hold.speed_mps > 14.0, "{hold:?}");
        let current = bench.current;
        assert_eq!(bench.order(Command::NAV_LOITER_UNLIM, []), ACCEPTED);
        bench.fly(30.0);
        let held = bench.last();
        assert!(held.speed_mps < 0.1, "{held:?}");
        bench.fly(10.0);
        let still = bench.last();
        let drift = (still.at_m[0] - held.at_m[0]).hypot(still.at_m[1] - held.at_m[1]);
        assert!(drift < 0.2, "{drift} m");
        let back = match profile {
            Profile::ArduPilot => bench.order(Command::DO_SET_MODE, [1.0, 3.0]),
            _ => bench.order(Command::DO_SET_MODE, [29.0, 4.0, 4.0]),
        };
        assert_eq!(back, ACCEPTED);
        bench.fly(5.0);
        assert_eq!(bench.current, current);
        bench.fly_until_disarmed(400.0);
        let end = bench.last().at_m;
        assert!((end[0] - 1766.0).hypot(end[1] - 642.8) < 1.5, "{end:?}");
    }
}

#[test]
fn a_landing_that_was_ordered_comes_down_where_it_is() {
    for profile in [Profile::ArduPilot, Profile::Px4] {
        let mut bench = Bench::new(profile, set_up(profile));
        bench.load(&dog_leg());
        bench.start();
        bench.fly(60.0);
        let at = bench.last().at_m;
        assert_eq!(bench.order(Command::NAV_LAND, []), ACCEPTED);
        bench.fly_until_disarmed(200.0);
        let end = bench.last().at_m;
        let moved = (end[0] - at[0]).hypot(end[1] - at[1]);
        assert!((1.0..80.0).contains(&moved), "{moved} m");
        assert!((end[2] - 400.0).abs() < 0.2);
    }
}

#[test]
fn new_items_and_a_new_current_one_are_taken_up_without_a_stop() {
    for profile in [Profile::ArduPilot, Profile::Px4] {
        let mut bench = Bench::new(profile, set_up(profile));
        bench.load(&dog_leg());
        bench.start();
        bench.fly(60.0);
        let before = bench.fixes.len();
        bench.load(&[
            waypoint(700.0, 300.0, 500.0),
            waypoint(900.0, 900.0, 500.0),
            item(command::NAV_LOITER_UNLIM, 900.0, 1500.0, 500.0, 0.0),
        ]);
        let seq = u16::from(profile == Profile::ArduPilot);
        let target = bench.vehicle.address();
        let message = Message::Flight(FlightMessage::SetCurrent { target, seq });
        bench.vehicle.handle(bench.now, US, &message);
        bench.fly(40.0);
        let slowest = bench.fixes[before..]
            .iter()
            .map(|fix| fix.speed_mps)
            .fold(f64::INFINITY, f64::min);
        assert!(slowest > 3.0, "{profile:?}: {slowest} m/s");
        bench.fly(200.0);
        assert!(bench.vehicle.is_armed(), "it loiters");
        let end = bench.last();
        assert!(end.speed_mps < 0.1);
        assert!(
            (end.at_m[0] - 900.0).hypot(end.at_m[1] - 1500.0) < 1.0,
            "{end:?}"
        );
        assert_eq!(bench.reached.last(), Some(&(seq + 2)));
    }
}

#[test]
fn a_delay_is_waited_on_the_ground_and_a_slow_start_stops_the_motors() {
    let delayed = |seconds| {
        let mut items = vec![Item::without_place(
            command::NAV_DELAY,
            [seconds, -1.0, -1.0, -1.0],
        )];
        items.extend(dog_leg());
        items
    };
    for profile in [Profile::ArduPilot, Profile::Px4] {
        let mut bench = Bench::new(profile, set_up(profile));
        bench.load(&delayed(40.0));
        bench.start();
        bench.fly(39.0);
        assert!((bench.last().at_m[2] - 400.0).abs() < 0.01);
        bench.fly(5.0);
        assert!(bench.last().at_m[2] > 402.0);
        // Armed, and nothing said for long.
        let mut bench = Bench::new(profile, set_up(profile));
        bench.load(&dog_leg());
        assert_eq!(bench.order(Command::COMPONENT_ARM_DISARM, [1.0]), ACCEPTED);
        bench.fly(12.0);
        assert!(!bench.vehicle.is_armed());
        assert_eq!(bench.texts, ["Disarmed: no takeoff"]);
    }
}

#[test]
fn what_cannot_be_is_refused_and_what_is_not_known_is_said_to_be() {
    let mut copter = Bench::new(Profile::ArduPilot, set_up(Profile::ArduPilot));
    assert_eq!(
        copter.order(Command::DO_SET_MODE, [1.0, 3.0]),
        CommandResult::DENIED,
        "no mission"
    );
    copter.load(&dog_leg());
    assert_eq!(copter.order(Command::DO_SET_MODE, [1.0, 3.0]), ACCEPTED);
    assert_eq!(
        copter.order(Command::COMPONENT_ARM_DISARM, [1.0]),
        CommandResult::FAILED
    );
    assert_eq!(copter.texts, ["Arm: Mode not armable"]);
    assert_eq!(
        copter.order(Command::MISSION_START, []),
        CommandResult::FAILED,
        "not armed"
    );
    assert_eq!(copter.order(31_010, []), CommandResult::UNSUPPORTED);
    copter.start();
    copter.fly(30.0);
    assert_eq!(
        copter.order(Command::COMPONENT_ARM_DISARM, [0.0]),
        CommandResult::FAILED,
        "in the air"
    );
    let mut generic = Bench::new(Profile::Generic, Surroundings::default());
    assert_eq!(
        generic.order(Command::COMPONENT_ARM_DISARM, [1.0]),
        CommandResult::UNSUPPORTED
    );
}

#[test]
fn px4_is_led_to_an_item_by_message_alone_and_not_while_items_are_read() {
    let mut bench = Bench::new(Profile::Px4, set_up(Profile::Px4));
    bench.load(&dog_leg());
    bench.start();
    bench.fly(20.0);
    let refused = bench.order(Command::DO_SET_MISSION_CURRENT, [2.0]);
    assert_eq!(refused, CommandResult::UNSUPPORTED);
    let target = bench.vehicle.address();
    let set = Message::Flight(FlightMessage::SetCurrent { target, seq: 2 });
    bench.hear_body(Body::RequestList);
    bench.vehicle.handle(bench.now, US, &set);
    bench.fly(1.0);
    assert_ne!(bench.current, 2);
    let says = bench.texts.iter().any(|text| text.contains("Busy"));
    assert!(says, "{:?}", bench.texts);
    let result = MissionResult::ACCEPTED;
    let opaque_id = 0;
    bench.hear_body(Body::Ack { result, opaque_id });
    bench.vehicle.handle(bench.now, US, &set);
    bench.fly(1.0);
    assert_eq!(bench.current, 2);
}
