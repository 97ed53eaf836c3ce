//! Vehicles that visit places between start and goal: planned, encoded and judged.

#![allow(clippy::float_cmp)]

use crate::support;

use sortie::cost::EarlierFlights;
use sortie::dispatch::{Dispatched, dispatch};
use sortie::geodesy::{Agl, LatLon};
use sortie::mission::{Item, VehicleMission, command};
use sortie::plan::VehiclePlan;
use sortie::spec::*;
use sortie::verify::{Limit, Review, review};
use sortie::world::World;
use support::plans::{EAST, NORTH, SOUTH, WEST};
use support::{copter, empty_spec, world};

pub(crate) fn stop(id: &str, place: LatLon, hold_s: f64) -> Stop {
    let end = EndPoint {
        place,
        altitude: Placement::Agl(Agl(80.0)),
    };
    Stop {
        hold_s,
        ..Stop::passing(id, end)
    }
}

/// A copter that flies from the west over the north and the south to the east.
fn round(autopilot: Autopilot) -> MissionSpec {
    let mut vehicle = copter("alpha", 1, WEST, EAST);
    vehicle.autopilot = autopilot;
    vehicle.speed_mps = 10.0;
    vehicle.stops = vec![stop("north", NORTH, 9.5), stop("south", SOUTH, 0.0)];
    let mut spec = empty_spec(vec![vehicle]);
    spec.planner.evaluations = 4000;
    spec
}

fn dispatched(spec: &MissionSpec) -> (World, Dispatched) {
    let world = world(spec);
    let done = dispatch(spec, &world, 1, &|_| ());
    assert!(done.review.passes(), "{:?}", failed(&done.review));
    (world, done)
}

fn failed(review: &Review) -> Vec<String> {
    let failed = review.margins.iter().filter(|margin| !margin.ok);
    failed
        .map(|margin| format!("{}: {}", margin.limit, margin.note))
        .collect()
}

fn holds(mission: &VehicleMission) -> Vec<f32> {
    let items = mission.items.iter();
    let waypoints = items.filter(|item| item.command == command::NAV_WAYPOINT);
    waypoints
        .map(|item| item.params[0])
        .filter(|hold_s| *hold_s > 0.0)
        .collect()
}

#[test]
fn each_stop_is_a_waypoint_with_its_hold_and_the_verdict_finds_it() {
    for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
        let (_, done) = dispatched(&round(autopilot));
        assert_eq!(holds(&done.missions[0].1), [10.0, 1.0]);
        for (limit, bound) in [
            (Limit::Stop("north".to_owned()), 5.0),
            (Limit::StopHold("north".to_owned()), 9.5),
            (Limit::StopHold("south".to_owned()), 0.0),
        ] {
            let margins = &done.review.margins;
            let margin = margins.iter().find(|margin| margin.limit == limit);
            assert!((margin.expect("judged").bound - bound).abs() < 1e-9);
        }
    }
}

#[test]
fn routes_are_summed_and_begin_after_the_rest_at_the_stop_before() {
    let spec = round(Autopilot::ArduPilot);
    let (world, done) = dispatched(&spec);
    let plan: &VehiclePlan = &done.plan.vehicles[0];
    assert_eq!(plan.routes.len(), 3);
    let ends = |index: usize| {
        let path = &plan.routes[index].path;
        (path[0], path[path.len() - 1])
    };
    for (index, rest_s) in [(0, 10.0), (1, 1.0)] {
        let (arrival, departure) = (ends(index).1, ends(index + 1).0);
        assert_eq!(arrival.point, world.sites[0].stops[index]);
        assert!((departure.t_s - arrival.t_s - rest_s).abs() < 1e-9);
    }
    let straight_m: f64 = (0..3)
        .map(|index| ends(index).0.point.distance_m(ends(index).1.point))
        .sum();
    assert!(
        plan.terms.length * 1000.0 >= straight_m - 0.5 && plan.bound * 1000.0 > 0.99 * straight_m
    );
    assert!(plan.bound <= plan.terms.total());
    // The verdict flies it at the same times.
    let flight = &done.plan.flights(&spec, &world)[0];
    let track = done.review.tracks[0].moments.last().expect("flown");
    assert!((track.t_s - flight.points.last().expect("planned").t_s).abs() < 10.0);
}

#[test]
fn a_stop_left_out_cut_short_or_out_of_order_fails() {
    let spec = round(Autopilot::ArduPilot);
    let (world, done) = dispatched(&spec);
    let mission = &done.missions[0].1;
    let judged = |change: &dyn Fn(&mut Vec<Item>), spec: &MissionSpec| {
        let mut changed = mission.clone();
        change(&mut changed.items);
        failed(&review(spec, &world, &[(0, &changed)]))
    };
    let hold_at = |items: &mut [Item], hold_s: f32| {
        let mut items = items.iter_mut();
        let stop = items.find(|item| item.command == command::NAV_WAYPOINT && item.params[0] > 9.0);
        stop.expect("a stop").params[0] = hold_s;
    };
    let none = judged(&|items| hold_at(items, 0.0), &spec);
    assert!(
        none.iter().any(|what| what.starts_with("stop north")),
        "{none:?}"
    );
    let short = judged(&|items| hold_at(items, 9.0), &spec);
    assert_eq!(short, ["hold at stop north: "]);
    let mut other_way = spec.clone();
    other_way.vehicles[0].stops.reverse();
    let world = World {
        sites: world
            .sites
            .iter()
            .map(|own| {
                let mut own = own.clone();
                own.stops.reverse();
                own
            })
            .collect(),
        ..world.clone()
    };
    let swapped = failed(&review(&other_way, &world, &[(0, mission)]));
    assert!(
        swapped.iter().any(|what| what.starts_with("stop north")),
        "{swapped:?}"
    );
    other_way.vehicles[0].order = Order::Free;
    assert!(review(&other_way, &world, &[(0, mission)]).passes());
}

/// A yard 6 m above the ground, where 60 m are asked for.
fn low(autopilot: Autopilot) -> MissionSpec {
    let mut spec = round(autopilot);
    let north = &mut spec.vehicles[0].stops[0];
    (north.drop_m, north.hold_s) = (74.0, 4.0);
    north.actions = vec![StopAction::Gripper { grabs: false }];
    spec
}

#[test]
fn a_place_below_the_least_height_is_reached_straight_down_from_a_rest_above_it() {
    for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
        let (_, done) = dispatched(&low(autopilot));
        let mission = &done.missions[0].1;
        let items = mission.items.iter();
        let rests = items.filter(|item| item.command == command::NAV_WAYPOINT);
        let home_m = f64::from(mission.home.amsl_m);
        let rests: Vec<(f32, f64, [i32; 2])> = rests
            .filter(|item| item.params[0] > 0.0)
            .map(|item| {
                let above_m = match sortie::mission::frame::canonical(item.frame) {
                    sortie::mission::frame::GLOBAL => f64::from(item.z) - home_m,
                    _ => f64::from(item.z),
                };
                (item.params[0], above_m, [item.x, item.y])
            })
            .collect();
        let holds: Vec<f32> = rests.iter().map(|rest| rest.0).collect();
        assert_eq!(holds, [1.0, 1.0, 3.0, 1.0, 1.0]);
        let heights: Vec<f64> = rests.iter().map(|rest| rest.1).collect();
        assert_eq!(heights, [80.0, 6.0, 6.0, 80.0, 80.0]);
        assert!(rests[..4].iter().all(|rest| rest.2 == rests[0].2));
        let margins = &done.review.margins;
        let contact = margins.iter().find(|of| of.limit == Limit::GroundContact);
        assert!((contact.expect("judged").value - 6.0).abs() < 0.01);
        let clearance = margins
            .iter()
            .find(|of| of.limit == Limit::TerrainClearance);
        assert!(clearance.expect("judged").value >= 60.0);
        // The ends of both motions count as stops for what it may be late.
        let late_s = |done: &Dispatched| done.review.tracks[0].late_s.last().copied();
        let (_, high) = dispatched(&round(autopilot));
        let later_s = late_s(&done).expect("flown") - late_s(&high).expect("flown");
        assert!(later_s > 8.5, "{later_s} s");
    }
}

#[test]
fn a_place_below_the_least_height_excuses_nothing_but_its_own_column() {
    for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
        let spec = low(autopilot);
        let (world, done) = dispatched(&spec);
        let mission = &done.missions[0].1;
        let is_rest =
            |item: &&mut Item| item.command == command::NAV_WAYPOINT && item.params[0] > 0.0;
        let judged = |spec: &MissionSpec, change: &dyn Fn(usize, &mut Item)| {
            let mut changed = mission.clone();
            let rests = changed.items.iter_mut().filter(is_rest);
            rests
                .enumerate()
                .for_each(|(index, item)| change(index, item));
            failed(&review(spec, &world, &[(0, &changed)]))
        };
        let is_low =
            |failed: &[String]| failed.iter().any(|of| of.starts_with("terrain clearance"));
        assert!(judged(&spec, &|_, _| ()).is_empty());
        let lower = judged(&spec, &|index, item| {
            if [1, 2].contains(&index) {
                item.z -= 4.0;
            }
        });
        assert!(is_low(&lower), "{lower:?}");
        let aside = judged(&spec, &|index, item| {
            if index < 4 {
                item.x += 2000;
            }
        });
        assert!(is_low(&aside), "{aside:?}");
        let slanting = judged(&spec, &|index, item| {
            if index == 0 {
                item.x += 2000;
            }
        });
        assert!(is_low(&slanting), "{slanting:?}");
        let in_passing = judged(&spec, &|index, item| {
            if index == 0 {
                item.params[0] = 0.0;
            }
        });
        assert!(is_low(&in_passing), "{in_passing:?}");
        let mut high = spec.clone();
        high.vehicles[0].stops[0].drop_m = 0.0;
        assert!(is_low(&judged(&high, &|_, _| ())));
    }
}

#[test]
fn a_stop_has_its_radius_its_heading_and_a_speed_from_there_on() {
    for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
        let mut spec = round(autopilot);
        let stop = &mut spec.vehicles[0].stops[0];
        stop.acceptance_radius_m = Some(2.0);
        stop.heading_rad = Some(90_f64.to_radians());
        stop.speed_mps = Some(7.0);
        let (world, done) = dispatched(&spec);
        let mission = &done.missions[0].1;
        let is_ardupilot = autopilot == Autopilot::ArduPilot;
        let expected: &[f32] = if is_ardupilot {
            &[1.0, 9.0, 1.0]
        } else {
            &[10.0, 1.0]
        };
        assert_eq!(holds(mission), expected);
        for drop in [command::CONDITION_YAW, command::DO_CHANGE_SPEED] {
            let mut changed = mission.clone();
            let is_dropped = |item: &Item| item.command == drop && item.params[1] != 10.0;
            changed.items.retain(|item| !is_dropped(item));
            let failed = failed(&review(&spec, &world, &[(0, &changed)]));
            match (drop, is_ardupilot) {
                (command::CONDITION_YAW, true) => {
                    assert_eq!(
                        failed,
                        ["actions at stop north: no item turns it to 90 degrees"]
                    );
                }
                (command::CONDITION_YAW, false) => assert!(failed.is_empty()),
                _ => assert_eq!(failed, ["speed: "]),
            }
        }
        let mut wide = mission.clone();
        for param in &mut wide.params {
            if ["WPNAV_RADIUS"].contains(&param.name.as_str()) {
                param.value *= 2.0;
            }
        }
        wide.items
            .iter_mut()
            .filter(|item| item.params[1] == 2.0)
            .for_each(|item| item.params[1] = 4.0);
        let failed = failed(&review(&spec, &world, &[(0, &wide)]));
        assert_eq!(failed, ["stop north: "]);
        let path = &done.plan.vehicles[0].routes[1].path;
        let fastest = path.windows(2).map(|pair| {
            pair[0].point.at.distance_m(pair[1].point.at) / (pair[1].t_s - pair[0].t_s)
        });
        assert!((fastest.fold(0.0, f64::max) - 7.0).abs() < 0.01);
    }
}

#[test]
fn a_vehicle_without_a_goal_comes_back_to_its_start() {
    let text = "
sortie: 2
name: round
area: {south_west: {lat: 47.35, lon: 8.45}, north_east: {lat: 47.45, lon: 8.60}, min_agl_m: 60, max_amsl_m: 900}
terrain: {flat: {amsl_m: 430}}
vehicles:
  - {id: alpha, sysid: 1, autopilot: ardupilot, link: sim, speed_mps: 10, finish: FINISH,
     start: {lat: 47.400, lon: 8.48, agl_m: 80}, stops: [{id: t1, lat: 47.405, lon: 8.49, agl_m: 80}]}
planner: {evaluations: 2000}
";
    for finish in ["land", "return"] {
        let text = text.replace("FINISH", finish);
        let file = SpecFile::parse(std::path::Path::new("a.yaml"), text).expect("good");
        let (_, done) = dispatched(&file.spec);
        assert_eq!(done.plan.vehicles[0].routes.len(), 2);
        let items = &done.missions[0].1.items;
        assert_eq!(items[items.len() - 1].x, items[0].x);
    }
}

#[test]
fn evaluate_takes_the_routes_one_after_the_other_and_sums_their_costs() {
    use sortie::optimize::Problem;
    use sortie::plan::{objective, objective_specs};
    let mut spec = round(Autopilot::ArduPilot);
    spec.vehicles[0].stops[0].speed_mps = Some(7.0);
    let world = world(&spec);
    let specs = objective_specs(&spec, &world, 0);
    let whole = objective(&specs, &world, 0, EarlierFlights::none(), 101);
    let each = 3 * spec.planner.control_points;
    assert_eq!(whole.dimension(), 3 * each);
    let row: Vec<f64> = (0..3 * each)
        .map(|index| (0.618 * f64::from(u32::try_from(index).expect("few"))).fract())
        .collect();
    let mut cost = [0.0];
    whole.evaluate(&row, &mut cost);
    // Each route as the only one of a vehicle of its own.
    let sites = &world.sites[0];
    let places = [sites.start, sites.stops[0], sites.stops[1], sites.goal];
    let mut sum = 0.0;
    for (index, pair) in places.windows(2).enumerate() {
        let mut alone = spec.clone();
        alone.vehicles[0].stops.clear();
        alone.vehicles[0].speed_mps = if index == 0 { 10.0 } else { 7.0 };
        let mut world = world.clone();
        world.sites[0].stops.clear();
        (world.sites[0].start, world.sites[0].goal) = (pair[0], pair[1]);
        let specs = objective_specs(&alone, &world, 0);
        let part = objective(&specs, &world, 0, EarlierFlights::none(), 101);
        let mut own = [0.0];
        part.evaluate(&row[index * each..(index + 1) * each], &mut own);
        sum += own[0];
    }
    assert!((cost[0] - sum).abs() < 1e-9 * sum, "{} {sum}", cost[0]);
}

#[test]
fn a_free_order_costs_less_than_the_listed_one_and_its_bound_holds_for_all_orders() {
    let mut spec = round(Autopilot::ArduPilot);
    let at = |share: f64| LatLon {
        lat_deg: 36.30 + 0.02 * (share * 9.0).sin(),
        lon_deg: WEST.lon_deg + share * (EAST.lon_deg - WEST.lon_deg),
    };
    let shares = [0.8, 0.2, 0.6, 0.4];
    spec.vehicles[0].stops = shares
        .iter()
        .map(|share| stop(&format!("s{share}"), at(*share), 2.0))
        .collect();
    let (_, listed) = dispatched(&spec);
    spec.vehicles[0].order = Order::Free;
    let (world, free) = dispatched(&spec);
    let (plan, fixed) = (&free.plan.vehicles[0], &listed.plan.vehicles[0]);
    assert_eq!(plan.order, [1, 3, 2, 0]);
    assert!(plan.terms.total() < 0.7 * fixed.terms.total());
    assert!(plan.bound <= plan.terms.total() && plan.bound > 0.95 * plan.terms.total());
    // The spec that missions are made from has that order, and flights rest at those stops.
    let ids: Vec<String> = free.plan.retimed(&spec).vehicles[0]
        .stops
        .iter()
        .map(|stop| stop.id.clone())
        .collect();
    assert_eq!(ids, ["s0.2", "s0.4", "s0.6", "s0.8"]);
    // An upload judges against the spec as it is listed.
    assert!(review(&spec, &world, &[(0, &free.missions[0].1)]).passes());
}

/// One of each action that an autopilot runs.
fn actions(autopilot: Autopilot) -> Vec<StopAction> {
    let mut actions = vec![
        StopAction::Gimbal {
            pitch_deg: -45,
            yaw_deg: 30,
        },
        StopAction::Roi(EndPoint {
            place: WEST,
            altitude: Placement::Agl(Agl(0.0)),
        }),
        StopAction::Photo,
        StopAction::Video { starts: true },
        StopAction::Video { starts: false },
        StopAction::RoiNone,
        StopAction::Gripper { grabs: false },
        StopAction::Winch {
            length_m: 5.0,
            rate_mps: 0.5,
        },
    ];
    if autopilot == Autopilot::ArduPilot {
        actions.push(StopAction::Servo {
            channel: 9,
            pwm_us: 1900,
        });
        actions.push(StopAction::Relay {
            number: 1,
            closed: true,
        });
    }
    actions
}

#[test]
fn actions_stand_between_two_waypoints_of_their_stop_and_each_is_judged() {
    for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
        let mut spec = round(autopilot);
        let listed = actions(autopilot);
        let south = &mut spec.vehicles[0].stops[1];
        south.actions.clone_from(&listed);
        let rest_s = south.rest_s();
        // 1 s to come to rest, 1 s more, and half a second for each of them.
        let expected_s = if autopilot == Autopilot::ArduPilot {
            7.0
        } else {
            6.0
        };
        assert_eq!(f64::from(expected_s), rest_s);
        let (world, done) = dispatched(&spec);
        let mission = &done.missions[0].1;
        let first = listed[0].command();
        let items = &mission.items;
        let found = items.iter().position(|item| item.command == first);
        let begin = found.expect("encoded");
        let commands: Vec<u16> = items[begin..].iter().map(|item| item.command).collect();
        let expected: Vec<u16> = listed.iter().map(StopAction::command).collect();
        assert_eq!(commands[..listed.len()], expected);
        let after = &items[begin + listed.len()];
        assert_eq!(
            (after.command, after.params[0]),
            (command::NAV_WAYPOINT, expected_s - 1.0)
        );
        assert_eq!(holds(mission)[1..], [1.0, expected_s - 1.0]);
        let judged = |change: &dyn Fn(&mut Vec<Item>)| {
            let mut changed = mission.clone();
            change(&mut changed.items);
            failed(&review(&spec, &world, &[(0, &changed)]))
        };
        for (index, action) in listed.iter().enumerate() {
            let at_stop = format!(
                "actions at stop south: action {} ({}): ",
                index + 1,
                action.key()
            );
            let name = format!("{at_stop}no item does it");
            let at = begin + index;
            let none = judged(&|items| {
                items.remove(at);
            });
            assert_eq!(none, [name.as_str()]);
            // On the way to the next stop it would be done elsewhere.
            let late = judged(&|items| {
                let item = items.remove(at);
                items.insert(begin + listed.len(), item);
            });
            let elsewhere = [
                "no item does it",
                "does it, and the vehicle is nearest to the stop",
            ];
            assert_eq!(late.len(), 1, "{late:?}");
            assert!(late[0].starts_with(&at_stop), "{late:?}");
            assert!(
                elsewhere.iter().any(|why| late[0].contains(why)),
                "{late:?}"
            );
            // Another value is another action.
            let other = judged(&|items| match action {
                StopAction::Roi(_) => items[at].x += 1000,
                StopAction::Video { .. } | StopAction::RoiNone => {
                    items[at].command = command::DO_SET_SERVO;
                }
                StopAction::Photo => items[at].params[2] = 0.0,
                _ => items[at].params[1] += 2.0,
            });
            assert!(other.contains(&name), "{other:?}");
        }
        // A load that is let go once more is lost, wherever that is.
        let load = items
            .iter()
            .position(|item| item.command == command::DO_GRIPPER);
        let load = load.expect("encoded");
        let late = begin + listed.len() + 1;
        for (row, rows) in [
            (begin - 3, [begin - 2, load + 2]),
            (late, [load + 1, late + 1]),
        ] {
            let again = judged(&|items| items.insert(row, items[load]));
            let [first, second] = rows;
            let stray = format!(
                "load moved elsewhere: DO_GRIPPER at item {first}, {second}, its stops ask for 1"
            );
            assert!(again.contains(&stray), "{again:?}");
        }
        if autopilot == Autopilot::Px4 {
            let free = judged(&|items| {
                items.remove(begin - 1);
            });
            let name = "actions at stop south: action 1 (gimbal): no item takes control of it";
            assert_eq!(free, [name]);
        }
    }
}

#[test]
fn actions_that_arducopter_would_drop_at_the_end_of_a_hold_fail() {
    let mut spec = round(Autopilot::ArduPilot);
    spec.vehicles[0].stops[1].actions = actions(Autopilot::ArduPilot);
    let (world, done) = dispatched(&spec);
    let mut mission = done.missions[0].1.clone();
    let items = &mut mission.items;
    let photo = items
        .iter()
        .position(|item| item.command == command::IMAGE_START_CAPTURE)
        .expect("encoded");
    let after = items[photo..]
        .iter_mut()
        .find(|item| item.command == command::NAV_WAYPOINT);
    after.expect("a second waypoint").params[0] = 2.0;
    let failed = failed(&review(&spec, &world, &[(0, &mission)]));
    let dropped: Vec<String> = (5..=10)
        .map(|number| {
            let key = spec.vehicles[0].stops[1].actions[number - 1].key();
            format!("action {number} ({key}): the hold after it ends before it")
        })
        .collect();
    assert_eq!(
        failed,
        [format!("actions at stop south: {}", dropped.join("; "))]
    );
}

/// Commands that the verdict took for run where their rows are.
#[test]
fn actions_behind_a_condition_or_a_jump_are_not_done_there() {
    let mut spec = round(Autopilot::ArduPilot);
    spec.vehicles[0].stops[1].heading_rad = Some(1.0);
    spec.vehicles[0].stops[1].actions = vec![StopAction::Gripper { grabs: false }];
    let (world, done) = dispatched(&spec);
    let mission = &done.missions[0].1;
    let row = |number: u16| mission.items.iter().position(|item| item.command == number);
    let (yaw, load) = (row(command::CONDITION_YAW), row(command::DO_GRIPPER));
    let (yaw, load) = (yaw.expect("encoded"), load.expect("encoded"));
    let judged = |change: &dyn Fn(&mut Vec<Item>)| {
        let mut changed = mission.clone();
        change(&mut changed.items);
        failed(&review(&spec, &world, &[(0, &changed)]))
    };
    let delay = |seconds: f32| Item {
        command: command::CONDITION_DELAY,
        params: [seconds, 0.0, 0.0, 0.0],
        ..mission.items[load]
    };
    let late = judged(&|items| items.insert(load, delay(600.0)));
    let action = "action 1 (gripper): CONDITION_DELAY at item";
    assert_eq!(late.len(), 1, "{late:?}");
    assert!(late[0].contains(action), "{late:?}");
    let late = judged(&|items| items.insert(yaw, delay(600.0)));
    assert!(
        late[0].contains("the turn to 57 degrees: CONDITION_DELAY"),
        "{late:?}"
    );
    // Past it to what is after it: ArduPilot counts home.
    let past = judged(&|items| {
        let to = f32::from(u16::try_from(load + 3).expect("few items"));
        let jump = Item {
            command: command::DO_JUMP,
            params: [to, 1.0, 0.0, 0.0],
            ..mission.items[load]
        };
        items.insert(yaw, jump);
    });
    assert!(
        past[0].contains("action 1 (gripper): DO_JUMP at item"),
        "{past:?}"
    );
    let slow = judged(&|items| items[yaw].params[1] = 1.0);
    let takes = "the turn to 57 degrees takes up to 180 s, and the hold after it ends before";
    assert!(slow[0].contains(takes), "{slow:?}");
    // The same load, let go on the way by the function of a switch.
    let stray = judged(&|items| {
        let switch = Item {
            command: command::DO_AUX_FUNCTION,
            params: [19.0, 0.0, 0.0, 0.0],
            ..mission.items[load]
        };
        items.insert(yaw - 2, switch);
    });
    let moved = stray
        .iter()
        .any(|note| note.contains("load moved elsewhere: DO_AUX_FUNCTION"));
    assert!(moved, "{stray:?}");
}

#[test]
fn start_and_goal_have_actions_and_pictures_are_taken_along_the_way() {
    for (autopilot, finish) in [
        (Autopilot::ArduPilot, Finish::Land),
        (Autopilot::Px4, Finish::Land),
        (Autopilot::ArduPilot, Finish::Return),
    ] {
        let mut spec = round(autopilot);
        let vehicle = &mut spec.vehicles[0];
        vehicle.finish = finish;
        vehicle.on_way = OnWay {
            start: vec![StopAction::Video { starts: true }],
            goal: vec![StopAction::Video { starts: false }],
            trigger_m: Some(25.0),
        };
        let (world, done) = dispatched(&spec);
        let mission = &done.missions[0].1;
        let at = |command: u16| -> Vec<usize> {
            let items = mission.items.iter().enumerate();
            let found = items.filter(|(_, item)| item.command == command);
            found.map(|(index, _)| index).collect()
        };
        let triggers = at(command::DO_SET_CAM_TRIGG_DIST);
        let values: Vec<f32> = triggers
            .iter()
            .map(|&index| mission.items[index].params[0])
            .collect();
        assert_eq!(values, [25.0, 0.0]);
        let [start, stop] = [command::VIDEO_START_CAPTURE, command::VIDEO_STOP_CAPTURE].map(at);
        assert!(
            start[0] < triggers[0] && stop[0] < triggers[1],
            "{start:?} {triggers:?} {stop:?}"
        );
        let judged = |change: &dyn Fn(&mut Vec<Item>)| {
            let mut changed = mission.clone();
            change(&mut changed.items);
            failed(&review(&spec, &world, &[(0, &changed)]))
        };
        let named =
            |failed: &[String], what: &str| failed.iter().any(|line| line.starts_with(what));
        for (index, what) in [
            (
                start[0],
                "actions at stop start: action 1 (video): no item does it",
            ),
            (
                stop[0],
                "actions at stop goal: action 1 (video): no item does it",
            ),
            (triggers[0], "pictures along the way: pictures every 0 m"),
            (
                triggers[1],
                "pictures along the way: pictures on the way to item",
            ),
        ] {
            let dropped = judged(&|items| {
                items.remove(index);
            });
            assert!(named(&dropped, what), "{dropped:?}");
        }
        let other = judged(&|items| items[triggers[0]].params[0] = 50.0);
        assert!(
            named(&other, "pictures along the way: pictures every 50 m"),
            "{other:?}"
        );
        let late = judged(&|items| {
            let item = items.remove(triggers[0]);
            items.insert(triggers[0] + 1, item);
        });
        assert!(named(&late, "pictures along the way"), "{late:?}");
        // The rests are in the planned times.
        let track = done.review.tracks[0].moments.last().expect("flown");
        let flight = &done.plan.flights(&spec, &world)[0];
        assert!((track.t_s - flight.points.last().expect("planned").t_s).abs() < 15.0);
    }
}

#[test]
fn a_payload_is_placed_below_a_stop_and_the_verdict_holds_the_item_against_the_spec() {
    let mut spec = round(Autopilot::ArduPilot);
    let place = |max_descent_m| StopAction::PayloadPlace { max_descent_m };
    spec.vehicles[0].stops[0].actions =
        vec![StopAction::Photo, place(Some(100.0)), StopAction::Photo];
    spec.vehicles[0].on_way.goal = vec![place(None)];
    let (world, done) = dispatched(&spec);
    let mission = &done.missions[0].1;
    let items = mission.items.iter().enumerate();
    let placed: Vec<usize> = items
        .filter(|(_, item)| item.command == command::NAV_PAYLOAD_PLACE)
        .map(|(index, _)| index)
        .collect();
    assert_eq!(placed.len(), 2);
    assert_eq!(mission.items[placed[0]].params[0], 100.0);
    assert_eq!(mission.items[placed[1]].params[0], 0.0);
    let speed = mission
        .params
        .iter()
        .find(|param| param.name == "PLDP_SPEED_DN");
    assert_eq!(speed.map(|param| param.value), Some(0.0));
    // It is flown down to the ground and up again, in the planned time.
    let moments = &done.review.tracks[0].moments;
    let lowest = moments.iter().filter(|at| at.item == placed[0] + 1);
    let lowest = lowest.map(|at| at.amsl.0).fold(f64::INFINITY, f64::min);
    assert!((lowest - 400.0).abs() < 0.01, "{lowest}");
    let planned = done.plan.flights(&spec, &world)[0]
        .points
        .last()
        .expect("planned")
        .t_s;
    let flown = moments.last().expect("flown").t_s;
    assert!((planned - flown).abs() < 15.0, "{planned} {flown}");
    let judged = |change: &dyn Fn(&mut Vec<Item>)| {
        let mut changed = mission.clone();
        change(&mut changed.items);
        failed(&review(&spec, &world, &[(0, &changed)]))
    };
    for (change, what) in [
        (
            &(|items: &mut Vec<Item>| {
                items.remove(placed[0]);
            }) as &dyn Fn(&mut Vec<Item>),
            "north",
        ),
        (&|items| items[placed[0]].params[0] = 60.0, "north"),
        (&|items| items[placed[1]].x += 3000, "goal"),
    ] {
        let failed = judged(change);
        let action = format!("actions at stop {what}: action");
        let named = |line: &String| line.starts_with(&action) && line.contains("payload_place");
        assert!(failed.iter().any(named), "{what}: {failed:?}");
    }
}
