use super::*;
use crate::autopilot::{Airframe, Autopilot};
use crate::flight::conformance::reference::Waypoint;
use crate::flight::record::Plan;
use crate::geodesy::{Amsl, LatLon};
use crate::mission::Home;
use crate::spec::SpecFile;

/// A copter at home in the west, which flies to the east; `more` is added to its spec.
fn spec(more: &str) -> MissionSpec {
    let text = format!(
        "
sortie: 2
name: return
area: {{south_west: {{lat: 36.28, lon: -84.30}}, north_east: {{lat: 36.32, lon: -84.22}}, min_agl_m: 30, max_amsl_m: 900}}
terrain: {{flat: {{amsl_m: 400}}}}
vehicles:
  - {{id: alpha, sysid: 1, autopilot: ardupilot, link: sim, speed_mps: 10, finish: land, return_amsl_m: 520,
     start: {{lat: 36.30, lon: -84.28, agl_m: 80}}, goal: {{lat: 36.30, lon: -84.23, agl_m: 80}}}}
{more}"
    );
    let path = std::path::Path::new("return.yaml");
    SpecFile::parse(path, text).expect("a spec").spec
}

fn mission(items: usize) -> VehicleMission {
    let item = crate::mission::Item {
        command: crate::mission::command::NAV_WAYPOINT,
        frame: 0,
        autocontinue: true,
        params: [0.0; 4],
        x: 363_000_000,
        y: -842_300_000,
        z: 480.0,
    };
    VehicleMission {
        autopilot: Autopilot::ArduPilot,
        autopilot_version: None,
        airframe: Airframe::Copter,
        home: Home {
            x: 363_000_000,
            y: -842_800_000,
            amsl_m: 400.0,
        },
        items: vec![item; items],
        fence: Vec::new(),
        is_fence_known: true,
        rally: Vec::new(),
        params: Vec::new(),
        notes: Vec::new(),
    }
}

/// A plan that begins at a longitude, 80 m above the ground.
fn plan(world: &World, from_lon_deg: f64, items: usize) -> Plan {
    let at = |item: usize, lon_deg: f64| {
        let place = LatLon {
            lat_deg: 36.30,
            lon_deg,
        };
        Waypoint {
            item,
            point: PlanPoint {
                at: world.frame.to_plan(place),
                amsl: Amsl(480.0),
            },
            t_s: 0.0,
            radius_m: 0.0,
            late_s: 0.0,
        }
    };
    let waypoints = vec![at(0, from_lon_deg), at(items, -84.23)];
    Plan {
        items,
        reference: ReferenceTrajectory::of_waypoints(waypoints, (1000.0, true), world.frame),
        from_s: 0.0,
    }
}

/// Why it does not return from a longitude, after it took a plan that begins at another.
fn problem(spec: &MissionSpec, here_lon_deg: f64, replanned_from: Option<f64>) -> Option<String> {
    let world =
        crate::world::World::new(spec, crate::world::Terrain::Flat(Amsl(400.0))).expect("ground");
    let (before, us) = (
        mission(3),
        Address {
            system: 245,
            component: 190,
        },
    );
    let watch = Watch {
        vehicle: &spec.vehicles[0],
        mission: &before,
        reference: plan(&world, -84.28, 3).reference,
    };
    let mut alarms = Alarms::new(spec, &world, vec![watch], us, 1.0);
    if let Some(lon_deg) = replanned_from {
        alarms.replan(10.0, 0, plan(&world, lon_deg, 5));
        let current = Message::MissionCurrent {
            seq: 2,
            total: 5,
            opaque_ids: [0; 3],
        };
        alarms.handle(10.0, 0, &current);
    }
    let place = LatLon {
        lat_deg: 36.30,
        lon_deg: here_lon_deg,
    };
    let fix = Fix {
        t_s: 10.0,
        place,
        amsl: Amsl(480.0),
        speed_mps: 10.0,
        item: 2,
        items: 5,
        boot_ms: None,
    };
    let position = Position {
        boot_ms: 10_000,
        x: 363_000_000,
        y: -842_500_000,
        amsl_mm: 480_000,
        above_home_mm: 80_000,
        velocity_cmps: [0, 1000, 0],
    };
    alarms.position(10.0, 0, fix, &position);
    alarms.return_problem(10.0, 0)
}

#[test]
fn a_return_leads_to_its_home_although_its_plan_began_in_the_air() {
    let clear = spec("");
    assert_eq!(problem(&clear, -84.24, None), None);
    assert_eq!(problem(&clear, -84.24, Some(-84.25)), None);
    let wall =
        spec("threats:\n  - {id: wall, kind: radar, lat: 36.30, lon: -84.265, radius_m: 200}\n");
    for replanned_from in [None, Some(-84.25)] {
        let why = problem(&wall, -84.24, replanned_from).expect("a wall on its way");
        assert_eq!(why, "its way home leads into wall");
    }
}

#[test]
fn a_return_does_not_climb_or_come_down_through_a_zone() {
    // It flies at 480 m, and returns at 520 m.
    for (west, is_closed) in [(-84.242, true), (-84.282, true), (-84.262, false)] {
        let east = west + 0.004;
        let lid = format!(
            "zones:
  - {{id: lid, floor: {{amsl_m: 495}}, ceiling: {{amsl_m: 505}}, polygon: [[36.298, {west}], [36.298, {east}], [36.302, {east}], [36.302, {west}]]}}
"
        );
        let why = problem(&spec(&lid), -84.24, None);
        let expected = is_closed.then(|| "its way home leads into lid".to_owned());
        assert_eq!(why, expected, "{west}");
    }
}

/// A vehicle that flies its mission of three items, whose reports come each second.
struct Flying<'a> {
    alarms: Alarms<'a>,
}

const US: Address = Address {
    system: 245,
    component: 190,
};
/// `replan` is another process.
const REPLAN: Address = Address {
    system: 245,
    component: 31,
};

impl<'a> Flying<'a> {
    fn new(spec: &'a MissionSpec, world: &World, mission: &'a VehicleMission) -> Self {
        let lons_deg = [-84.28, -84.275, -84.26, -84.23];
        let waypoints = lons_deg.iter().enumerate().map(|(item, lon_deg)| {
            let mut of = plan(world, *lon_deg, 3).reference.waypoints[0];
            of.item = item;
            of
        });
        let reference =
            ReferenceTrajectory::of_waypoints(waypoints.collect(), (1000.0, true), world.frame);
        let vehicle = &spec.vehicles[0];
        let watch = Watch {
            vehicle,
            mission,
            reference,
        };
        let mut alarms = Alarms::new(spec, world, vec![watch], US, 1.0);
        let duty = Duty {
            flies: true,
            is_up: true,
            held: Some(3),
            ..Duty::default()
        };
        alarms.note(0.0, 0, duty);
        let heartbeat = crate::link::Heartbeat {
            kind: 2,
            autopilot: 3,
            base_mode: 0b1000_1001,
            custom_mode: 3,
            system_status: 4,
        };
        alarms.handle(0.0, 0, &Message::Heartbeat(heartbeat));
        Self { alarms }
    }

    /// It says so, at a time; the texts of its alarms of the mission since the last call.
    fn says(&mut self, t_s: f64, message: &Message) -> Vec<String> {
        self.alarms.handle(t_s, 0, message);
        self.alarms.look(t_s);
        let alarms = std::iter::from_fn(|| self.alarms.poll());
        let alarms = alarms.filter(|of| of.is_raised && of.kind == AlarmKind::Mission);
        alarms.map(|of| of.text).collect()
    }

    /// It flies to an item of three and has rally points with this id, for as many seconds.
    fn flies_to(&mut self, seq: u16, rally: u32, seconds: std::ops::Range<u16>) -> Vec<String> {
        let opaque_ids = [5, 6, rally];
        let total = 3;
        let current = Message::MissionCurrent {
            seq,
            total,
            opaque_ids,
        };
        let texts = seconds.flat_map(|s| self.says(f64::from(s), &current));
        texts.collect()
    }

    fn acknowledges(&mut self, t_s: f64, target: Address) -> Vec<String> {
        let body = crate::link::Body::Ack {
            result: crate::link::MissionResult::ACCEPTED,
            opaque_id: 0,
        };
        let rally = Message::Mission(crate::link::MissionMessage {
            target,
            mission_type: 2,
            body,
        });
        self.says(t_s, &rally)
    }
}

/// With another plan, of five items, announced 10 s after T0.
fn with_another_plan(check: impl FnOnce(&mut Flying<'_>)) {
    let spec = spec("");
    let world =
        crate::world::World::new(&spec, crate::world::Terrain::Flat(Amsl(400.0))).expect("ground");
    let mission = mission(3);
    let mut flying = Flying::new(&spec, &world, &mission);
    assert!(flying.flies_to(1, 7, 1..10).is_empty());
    flying.alarms.replan(10.0, 0, plan(&world, -84.25, 5));
    check(&mut flying);
}

#[test]
fn a_plan_that_never_came_is_no_reason_for_other_rally_points_later() {
    const OTHERS: &str = "the rally points on board are others (their id changed)";
    with_another_plan(|flying| {
        // The transfer may send them again: 30 s, and 2 s for each of five items.
        assert!(flying.flies_to(1, 8, 11..49).is_empty());
        assert_eq!(flying.flies_to(1, 9, 51..60), [OTHERS]);
        let why = flying.alarms.return_problem(60.0, 0).expect("a reason");
        assert_eq!(why, "its place is not known");
    });
}

#[test]
fn a_plan_that_never_came_is_no_reason_for_a_list_of_another_sortie_later() {
    const SYSTEM: &str = "acknowledged rally points, or that they were cleared, to system 245";
    with_another_plan(|flying| {
        assert!(flying.acknowledges(20.0, REPLAN).is_empty());
        assert_eq!(flying.acknowledges(51.0, REPLAN), [SYSTEM]);
    });
    with_another_plan(|flying| {
        let stranger = Address {
            system: 254,
            component: 190,
        };
        let texts = flying.acknowledges(20.0, stranger);
        assert_eq!(texts, [SYSTEM.replace("245", "254")]);
    });
}

#[test]
fn a_plan_that_never_came_hides_no_skipped_items_later() {
    with_another_plan(|flying| {
        let place = LatLon {
            lat_deg: 36.30,
            lon_deg: -84.278,
        };
        for s in [52.0, 53.0] {
            let fix = Fix {
                t_s: s,
                place,
                amsl: Amsl(480.0),
                speed_mps: 10.0,
                item: 1,
                items: 3,
                boot_ms: None,
            };
            let position = Position {
                boot_ms: 10_000,
                x: 363_000_000,
                y: -842_780_000,
                amsl_mm: 480_000,
                above_home_mm: 80_000,
                velocity_cmps: [0, 1000, 0],
            };
            flying.alarms.position(s, 0, fix, &position);
        }
        assert!(flying.flies_to(1, 7, 53..54).is_empty());
        let texts = flying.flies_to(3, 7, 54..56);
        assert_eq!(texts, ["skips item 2: it flies to item 3 of 3"]);
    });
}

#[test]
fn a_plan_that_comes_late_is_known_all_the_same() {
    with_another_plan(|flying| {
        let current = Message::MissionCurrent {
            seq: 1,
            total: 5,
            opaque_ids: [15, 6, 7],
        };
        for s in 80..90 {
            let texts = flying.says(f64::from(s), &current);
            assert!(texts.is_empty(), "{texts:?}");
        }
    });
}

#[test]
fn items_that_come_one_by_one_are_no_other_mission() {
    let hold = |total: u16| Message::MissionCurrent {
        seq: 1,
        total,
        opaque_ids: [0, 6, 7],
    };
    with_another_plan(|flying| {
        for s in 11..16 {
            let texts = flying.says(f64::from(s), &hold(4));
            assert!(texts.is_empty(), "{texts:?}");
        }
        let texts: Vec<String> = (16..20)
            .flat_map(|s| flying.says(f64::from(s), &hold(7)))
            .collect();
        assert_eq!(texts, ["the mission on board has 7 items, the plan 3"]);
    });
    with_another_plan(|flying| {
        let texts: Vec<String> = (11..60)
            .flat_map(|s| flying.says(f64::from(s), &hold(4)))
            .collect();
        assert_eq!(texts, ["the mission on board has 4 items, the plan 3"]);
    });
}

#[test]
fn an_alarm_right_after_a_stall_of_the_ground_station_names_the_stall() {
    let spec = spec("");
    let world = World::new(&spec, crate::world::Terrain::Flat(Amsl(400.0))).expect("ground");
    let mission = mission(3);
    let text = |speedup: f64, looks: &[f64], raised_s: f64| {
        let mut alarms = Flying::new(&spec, &world, &mission).alarms;
        alarms.speedup = speedup;
        looks.iter().for_each(|&t_s| alarms.look(t_s));
        while alarms.poll().is_some() {}
        let key = (AlarmKind::Late, 0, None, "");
        alarms.push(raised_s, key, true, "late".to_owned());
        alarms.poll().expect("an alarm").text
    };
    assert_eq!(
        text(50.0, &[100.0, 140.0], 145.0),
        "late (the ground station had stalled for 0.8 s, 40 s of flight)"
    );
    // One soon after another: what came late did so by both. One that came when the other was caught up with is alone.
    assert_eq!(
        text(50.0, &[100.0, 140.0, 141.0, 165.0], 200.0),
        "late (the ground station had stalled 2 times, for 1.3 s, 64 s of flight)"
    );
    assert_eq!(
        text(50.0, &[100.0, 140.0, 141.0, 165.0, 166.0, 196.0], 197.0),
        "late (the ground station had stalled 3 times, for 1.9 s, 94 s of flight)"
    );
    let looks: Vec<f64> = (0..40).map(|s| 141.0 + 1.5 * f64::from(s)).collect();
    let looks = [&[100.0, 140.0], looks.as_slice(), &[220.0]].concat();
    assert_eq!(
        text(50.0, &looks, 221.0),
        "late (the ground station had stalled for 0.4 s, 20 s of flight)"
    );
    // In real time, long after it, and where the turns of the loop were in time.
    assert_eq!(text(1.0, &[100.0, 106.0], 106.0), "late");
    assert_eq!(text(50.0, &[100.0, 140.0], 190.0), "late");
    assert_eq!(text(50.0, &[100.0, 102.0], 102.0), "late");
}
