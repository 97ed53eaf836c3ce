//! Areas, corridors and search patterns: laid out, shared, encoded, and counted from the items.

#![allow(clippy::float_cmp)]

use crate::support;

use std::path::Path;

use sortie::dispatch::{Dispatched, dispatch};
use sortie::geodesy::{Agl, LatLon};
use sortie::mission::{Item, VehicleMission, command};
use sortie::spec::*;
use sortie::verify::{Limit, Review, review};
use sortie::world::World;
use support::{copter, empty_spec, peers, place, world};

/// 359 m from west to east and 277 m from south to north.
const FIELD: [(f64, f64); 4] = [
    (36.3000, -84.2530),
    (36.3000, -84.2490),
    (36.3025, -84.2490),
    (36.3025, -84.2530),
];
/// Half of the swath of the camera at 80 m, in 1e-7 degrees of latitude.
const HALF_SWATH: i32 = 4150;

pub(crate) fn corners(of: &[(f64, f64)]) -> Vec<LatLon> {
    of.iter().map(|&(lat, lon)| place(lat, lon)).collect()
}

fn camera() -> Sensor {
    Sensor {
        across: 30_f64.to_radians().tan(),
        along: Some((22.5_f64.to_radians().tan(), 0.7)),
        side_overlap: 0.6,
    }
}

pub(crate) fn sweep(shape: SweepShape, sensor: Option<Sensor>) -> Sweep {
    Sweep {
        shape,
        sensor,
        agl: Agl(80.0),
        speed_mps: None,
    }
}

pub(crate) fn field(holes: Vec<Vec<LatLon>>, heading_rad: Option<f64>) -> Sweep {
    let polygon = corners(&FIELD);
    let shape = SweepShape::Survey {
        polygon,
        holes,
        heading_rad,
    };
    sweep(shape, Some(camera()))
}

/// Copters beside the field, and one task.
pub(crate) fn spec(autopilot: Autopilot, vehicles: u8, sweep: Sweep) -> MissionSpec {
    let vehicles = (1..=vehicles).map(|sysid| {
        let at = |lat_deg| place(lat_deg, -84.2545 - 0.0016 * f64::from(sysid));
        let mut vehicle = copter(&format!("copter{sysid}"), sysid, at(36.301), at(36.3015));
        (vehicle.autopilot, vehicle.speed_mps) = (autopilot, 10.0);
        vehicle
    });
    let mut spec = empty_spec(vehicles.collect());
    spec.planner.evaluations = 1500;
    spec.separation.distance_m = 20.0;
    spec.tasks = vec![Task {
        id: "field".to_owned(),
        stops: Vec::new(),
        sweep: Some(sweep),
    }];
    spec
}

pub(crate) fn dispatched(spec: &MissionSpec) -> (World, Dispatched) {
    let world = world(spec);
    let done = dispatch(spec, &world, 1, &|_| ());
    (world, done)
}

pub(crate) fn failed(review: &Review) -> Vec<String> {
    let failed = review.margins.iter().filter(|margin| !margin.ok);
    failed
        .map(|margin| {
            format!(
                "{}: {}: {} ({})",
                margin.vehicle, margin.limit, margin.note, margin.value
            )
        })
        .collect()
}

/// The verdict on the missions of a plan with the first of them changed.
pub(crate) fn judged(
    spec: &MissionSpec,
    (world, done): &(World, Dispatched),
    change: &dyn Fn(&mut Vec<Item>),
) -> Vec<String> {
    let mut changed: Vec<(usize, VehicleMission)> = done.missions.clone();
    change(&mut changed[0].1.items);
    let missions: Vec<_> = changed.iter().map(|(index, one)| (*index, one)).collect();
    failed(&review(spec, world, &missions))
}

/// From the waypoint where a line begins to the item that ends its pictures.
pub(crate) fn line(items: &[Item], number: usize) -> std::ops::RangeInclusive<usize> {
    let is_switch = |item: &Item, on: bool| {
        item.command == command::DO_SET_CAM_TRIGG_DIST && (item.params[0] > 0.0) == on
    };
    let on = (0..items.len()).filter(|&index| is_switch(&items[index], true));
    let begin = on.clone().nth(number).expect("a line");
    let end = (begin..items.len()).find(|&index| is_switch(&items[index], false));
    begin - 1..=end.expect("its end")
}

#[test]
fn an_area_is_seen_at_its_overlap_and_gaps_are_named_with_place_and_size() {
    for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
        let spec = spec(
            autopilot,
            1,
            field(Vec::new(), Some(std::f64::consts::FRAC_PI_2)),
        );
        let planned = dispatched(&spec);
        assert_eq!(judged(&spec, &planned, &|_| ()), Vec::<String>::new());
        let seen = Limit::AreaCovered("field".to_owned());
        let margins = &planned.1.review.margins;
        let seen = margins.iter().find(|margin| margin.limit == seen);
        assert!(seen.expect("judged").value > 99.9);
        // Distance and a picture at once, then a last one.
        let items = &planned.1.missions[0].1.items;
        let third = line(items, 3);
        let (on, off) = (items[third.start() + 1].params, items[*third.end()].params);
        assert!(
            (on[0] - 18.2).abs() < 0.11 && (on[2] - 1.0).abs() < 1e-6,
            "{on:?}"
        );
        assert_eq!(off, [0.0, 0.0, 1.0, 0.0]);
        // 359 m by 277 m with lines 37 m apart.
        let lines = items
            .iter()
            .filter(|item| item.command == command::DO_SET_CAM_TRIGG_DIST);
        assert!((14..=18).contains(&lines.count()));
        type Change<'a> = (&'a str, &'a dyn Fn(&mut Vec<Item>));
        let changes: [Change<'_>; 4] = [
            ("a line removed", &|items| {
                items.drain(line(items, 3));
            }),
            ("pictures off", &|items| {
                let on = line(items, 3).start() + 1;
                items[on].params[0] = 0.0;
            }),
            ("altitude doubled", &|items| {
                for index in line(items, 3) {
                    if items[index].command == command::NAV_WAYPOINT {
                        items[index].z += 80.0;
                    }
                }
            }),
            ("shifted by half a swath", &|items| {
                for index in line(items, 3) {
                    if items[index].command == command::NAV_WAYPOINT {
                        items[index].x += HALF_SWATH;
                    }
                }
            }),
        ];
        for (what, change) in changes {
            let failed = judged(&spec, &planned, change);
            let named = failed
                .iter()
                .find(|text| text.contains("area covered of task field"));
            let named = named.unwrap_or_else(|| panic!("{what}: {failed:?}"));
            assert!(
                named.contains("m2 (") && named.contains("at 36.30"),
                "{what}: {named}"
            );
        }
    }
}

#[test]
fn copters_share_an_area_that_one_battery_does_not_suffice_for() {
    let mut spec = spec(Autopilot::ArduPilot, 2, field(Vec::new(), None));
    let endurance = |time_s| {
        Some(Endurance {
            capacity: Capacity::Time(time_s),
            reserve: 0.2,
        })
    };
    for vehicle in &mut spec.vehicles {
        // 12 s of what may be used are for a late takeoff.
        vehicle.endurance = endurance(635.0);
    }
    let (_, done) = dispatched(&spec);
    assert!(done.review.passes(), "{:?}", failed(&done.review));
    let tasks = done.tasks.as_ref().expect("tasks");
    let mut lines: Vec<i32> = tasks
        .done
        .iter()
        .flatten()
        .flat_map(|task| &task.lines)
        .map(|line| line.abs())
        .collect();
    lines.sort_unstable();
    assert!(
        tasks.done.iter().all(|done| done.len() == 1),
        "{:?}",
        tasks.done
    );
    let all = i32::try_from(lines.len()).expect("few");
    assert_eq!(lines, (1..=all).collect::<Vec<_>>(), "each line once");
    // What is left is named, and the plan fails with the gap.
    for vehicle in &mut spec.vehicles {
        vehicle.endurance = endurance(350.0);
    }
    let (_, done) = dispatched(&spec);
    let left = &done.tasks.as_ref().expect("tasks").left;
    assert_eq!(left.len(), 1);
    assert!(left[0].why.contains("lines ("), "{left:?}");
    assert!(
        left[0].why.contains("endurance") || left[0].why.contains("out of reach"),
        "{left:?}"
    );
    let failed = failed(&done.review);
    assert!(failed.iter().any(|text| text.contains("gap")), "{failed:?}");
}

#[test]
fn a_hole_is_not_flown_over_and_the_free_heading_is_the_cheapest() {
    let hole = corners(&[
        (36.3003, -84.2522),
        (36.3003, -84.2498),
        (36.3022, -84.2498),
        (36.3022, -84.2522),
    ]);
    let with_hole = spec(Autopilot::Px4, 1, field(vec![hole], None));
    let layout = |spec: &MissionSpec| {
        let sweep = spec.tasks[0].sweep.as_ref().expect("an area");
        sortie::tasks::lay_out(sweep, &world(spec)).lines
    };
    let whole = spec(Autopilot::Px4, 1, field(Vec::new(), None));
    let length = |spec: &MissionSpec| {
        layout(spec)
            .iter()
            .map(sortie::tasks::SweepLine::length_m)
            .sum::<f64>()
    };
    assert!(length(&with_hole) < 0.95 * length(&whole));
    // No direction costs less than the free one: length, and 77 m for the turn and the stop of each.
    let cost = |spec: &MissionSpec| {
        let each = layout(spec).into_iter().map(|line| line.length_m() + 77.0);
        each.sum::<f64>()
    };
    for heading_deg in [0_f64, 45.0, 90.0] {
        let heading_rad = Some(heading_deg.to_radians());
        let given = spec(Autopilot::Px4, 1, field(Vec::new(), heading_rad));
        assert!(cost(&whole) <= cost(&given) + 1.0, "{heading_deg} degrees");
    }
    let (_, done) = dispatched(&with_hole);
    assert!(done.review.passes(), "{:?}", failed(&done.review));
}

#[test]
fn a_line_goes_on_over_a_small_hole_but_not_through_the_mast_in_it() {
    let hole = corners(&[
        (36.3008, -84.2516),
        (36.3008, -84.2504),
        (36.3017, -84.2504),
        (36.3017, -84.2516),
    ]);
    let open = spec(Autopilot::ArduPilot, 1, field(vec![hole], Some(0.0)));
    let mut closed = open.clone();
    closed.threats.push(Threat {
        id: "mast".to_owned(),
        kind: String::new(),
        place: place(36.30125, -84.251),
        radius_m: 30.0,
    });
    let lines = |spec: &MissionSpec| {
        let sweep = spec.tasks[0].sweep.as_ref().expect("an area");
        sortie::tasks::lay_out(sweep, &world(spec)).lines.len()
    };
    assert!(lines(&closed) > lines(&open));
    let (_, done) = dispatched(&closed);
    assert!(done.review.passes(), "{:?}", failed(&done.review));
}

#[test]
fn the_legs_of_a_pattern_are_flown_in_order_and_a_missing_one_is_named() {
    for pattern in [
        Pattern::ExpandingSquare,
        Pattern::Sector,
        Pattern::ParallelTrack,
    ] {
        let search = SearchPattern {
            pattern,
            at: place(36.301, -84.250),
            heading_rad: 0.3,
            leg_m: 120.0,
            legs: 9,
            spacing_m: 60.0,
        };
        let spec = spec(
            Autopilot::ArduPilot,
            1,
            sweep(SweepShape::Search(search), None),
        );
        let planned = dispatched(&spec);
        assert_eq!(judged(&spec, &planned, &|_| ()), Vec::<String>::new());
        // Without its fifth corner the vehicle cuts from the fourth to the sixth.
        let failed = judged(&spec, &planned, &|items| {
            let rests = (0..items.len()).filter(|&index| {
                items[index].command == command::NAV_WAYPOINT && items[index].params[0] > 0.5
            });
            let corner = rests.clone().nth(5).expect("corners");
            let before = rests.clone().nth(4).expect("corners");
            items.drain(before + 1..=corner);
        });
        let named = failed
            .iter()
            .any(|text| text.contains("task field") && text.contains("is not flown in order"));
        assert!(named, "{pattern:?}: {failed:?}");
    }
}

#[test]
fn a_corridor_with_a_bend_is_seen_and_one_without_a_camera_is_flown_along() {
    let line = corners(&[(36.300, -84.256), (36.303, -84.252), (36.303, -84.248)]);
    let strip = |width_m| SweepShape::Corridor {
        line: line.clone(),
        width_m,
    };
    let spec_of = |sweep| spec(Autopilot::Px4, 1, sweep);
    let seen = spec_of(sweep(strip(120.0), Some(camera())));
    let (_, done) = dispatched(&seen);
    assert!(done.review.passes(), "{:?}", failed(&done.review));
    let swath = Sensor {
        across: 0.5,
        along: None,
        side_overlap: 0.2,
    };
    let (_, done) = dispatched(&spec_of(sweep(strip(120.0), Some(swath))));
    assert!(done.review.passes(), "{:?}", failed(&done.review));
    let switches = |item: &&Item| item.command == command::DO_SET_CAM_TRIGG_DIST;
    assert_eq!(done.missions[0].1.items.iter().filter(switches).count(), 0);
    let along = spec_of(sweep(strip(40.0), None));
    let (_, done) = dispatched(&along);
    assert!(done.review.passes(), "{:?}", failed(&done.review));
}

#[test]
fn the_survey_mission_passes_over_the_ridge() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("missions/survey.yaml");
    let file = SpecFile::read(&path).expect("a good spec");
    let world = sortie::world::load(&file).expect("good over the ground");
    let done = dispatch(&file.spec, &world, 1, &|_| ());
    assert!(done.review.passes(), "{:?}", failed(&done.review));
    let tasks = done.tasks.as_ref().expect("tasks");
    assert!(
        tasks.done.iter().all(|done| !done.is_empty()),
        "{:?}",
        tasks.done
    );
}

#[test]
fn what_the_survey_mission_shows_and_how_far_it_flies_is_counted_apart() {
    let Some(python) = peers::python() else {
        return;
    };
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = tempfile::tempdir().expect("a folder");
    let spec = root.join("missions/survey.yaml").display().to_string();
    let out = folder.path().join("o").display().to_string();
    let planned = support::command::sortie(root, &["plan", &spec, "--out", &out]);
    assert!(planned.status.success(), "{planned:?}");
    let counted = std::process::Command::new(&python)
        .arg(root.join("tools/check_coverage.py"))
        .args([&spec, &out])
        .output()
        .expect("python starts");
    let counted: serde_json::Value = serde_json::from_slice(&counted.stdout).expect("JSON");
    let number = |key: &str| counted[key].as_f64().expect("a number");
    assert!(number("share") >= 0.995, "{counted}");
    // Lines and turns, without ferries, against the least that parallel tracks can have.
    assert!(number("ratio") <= 1.10, "{counted}");
    assert!((number("area_m2") - 509e3).abs() < 1e3, "{counted}");
}

/// Each assignment for the least cost gave one vehicle more than it can do, or had both in each other's
/// way with 2600 s; with less and with more endurance one passed.
#[test]
fn more_endurance_never_makes_a_plan_with_tasks_fail() {
    for endurance_s in [2500, 2600, 2700] {
        let vehicle = |id: &str, sysid: u8, autopilot: &str, lon: f64| {
            format!(
                "  - {{id: {id}, sysid: {sysid}, autopilot: {autopilot}, link: sim, finish: land, speed_mps: 9,
     endurance: {{time_s: {endurance_s}}}, start: {{lat: 63.4200, lon: {lon}, agl_m: 80}}, goal: {{lat: 63.4203, lon: {lon}, agl_m: 80}}}}
"
            )
        };
        let spec = format!(
            "sortie: 2
name: park
area: {{south_west: {{lat: 63.40, lon: 10.36}}, north_east: {{lat: 63.44, lon: 10.44}}, min_agl_m: 40, max_agl_m: 120, max_amsl_m: 300}}
terrain: {{flat: {{amsl_m: 20}}}}
vehicles:
{}{}separation: {{distance_m: 30, time_slack_s: 5}}
planner: {{evaluations: 4000}}
tasks:
  - id: park
    survey:
      polygon: [[63.422, 10.395], [63.422, 10.405], [63.426, 10.405], [63.426, 10.395]]
      holes: [[[63.4235, 10.398], [63.4235, 10.402], [63.4245, 10.402], [63.4245, 10.398]]]
      camera: {{fov_deg: [60, 45]}}
      agl_m: 80
  - {{id: line, corridor: {{line: [[63.41, 10.38], [63.41, 10.41], [63.415, 10.42]], width_m: 80, camera: {{fov_deg: [60, 45]}}, agl_m: 80}}}}
  - {{id: sar, search: {{pattern: sector, at: {{lat: 63.432, lon: 10.42, agl_m: 80}}, leg_m: 150, legs: 9}}}}
",
            vehicle("a", 1, "ardupilot", 10.39),
            vehicle("b", 2, "px4", 10.415)
        );
        let mission = sortie::Mission::parse(std::path::Path::new("."), spec).expect("a good spec");
        let planned = sortie::plan(&mission);
        let broken = planned.review.margins.iter().filter(|margin| !margin.ok);
        let broken: Vec<String> = broken.map(|margin| margin.limit.to_string()).collect();
        assert_eq!(broken, Vec::<String>::new(), "{endurance_s} s");
    }
}

#[test]
fn pictures_behind_a_condition_do_not_count_and_lines_are_flown_with_their_speed() {
    let mut sweep = field(Vec::new(), None);
    sweep.speed_mps = Some(5.0);
    let spec = spec(Autopilot::ArduPilot, 1, sweep);
    let planned = dispatched(&spec);
    assert!(planned.1.review.passes(), "{:?}", failed(&planned.1.review));
    let late = judged(&spec, &planned, &|items| {
        let is_switch = |item: &Item| item.command == command::DO_SET_CAM_TRIGG_DIST;
        let delayed = items.iter().flat_map(|item| {
            let delay = Item {
                command: command::CONDITION_DELAY,
                params: [600.0, 0.0, 0.0, 0.0],
                ..*item
            };
            [is_switch(item).then_some(delay), Some(*item)]
        });
        *items = delayed.flatten().collect();
    });
    assert!(
        late.iter()
            .any(|note| note.contains("area covered of task field")),
        "{late:?}"
    );
    let fast = judged(&spec, &planned, &|items| {
        for item in items {
            if item.command == command::DO_CHANGE_SPEED && item.params[1] < 9.0 {
                item.params[1] = 10.0;
            }
        }
    });
    assert!(
        fast.iter().any(|note| note.contains("copter1: speed")),
        "{fast:?}"
    );
}
