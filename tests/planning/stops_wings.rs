//! Planes and VTOL that fly past places between start and goal: planned, encoded and judged.

use crate::support;

use sortie::dispatch::{Dispatched, dispatch};
use sortie::geodesy::Agl;
use sortie::mission::{Item, command};
use sortie::spec::{Finish, MissionSpec, OnWay, Placement, StopAction};
use sortie::verify::{Limit, Review, review};
use sortie::world::World;
use support::wings::{KINDS, wing_with_stops as spec};
use support::{world, world as world_of};

fn dispatched(spec: &MissionSpec) -> (World, Dispatched) {
    let world = world(spec);
    let done = dispatch(spec, &world, 1, &|_| ());
    assert!(done.review.passes(), "{:?}", failed(&done.review));
    (world, done)
}

fn failed(review: &Review) -> Vec<String> {
    let failed = review.margins.iter().filter(|margin| !margin.ok);
    failed
        .map(|margin| {
            let (limit, note, value) = (&margin.limit, &margin.note, margin.value);
            format!("{limit}: {note} {value:.1}")
        })
        .collect()
}

/// The items that stand exactly at a stop.
fn at_stop(spec: &MissionSpec, items: &[Item], number: usize) -> Vec<usize> {
    let place = spec.vehicles[0].stops[number].end.place;
    let is_there = |item: &Item| {
        item.command == command::NAV_WAYPOINT
            && item.place().is_some_and(|at| at.chord_m(place) < 0.1)
    };
    (0..items.len())
        .filter(|&index| is_there(&items[index]))
        .collect()
}

/// Moves a waypoint to the side of the leg that leads to it.
#[allow(clippy::cast_possible_truncation)]
fn move_aside(items: &mut [Item], at: usize, by_m: f64) {
    let (from, to) = (items[at - 1], items[at]);
    let (north, east) = (f64::from(to.x - from.x), 0.677 * f64::from(to.y - from.y));
    let scale = by_m / 0.011_113 / north.hypot(east);
    items[at].x += (-east * scale) as i32;
    items[at].y += (north * scale / 0.677) as i32;
}

#[test]
fn a_wing_flies_past_each_stop_and_the_verdict_finds_it() {
    for (autopilot, airframe) in KINDS {
        let spec = spec(autopilot, airframe);
        let (_, done) = dispatched(&spec);
        let items = &done.missions[0].1.items;
        for (number, stop) in spec.vehicles[0].stops.iter().enumerate() {
            assert_eq!(at_stop(&spec, items, number).len(), 1, "{airframe}");
            let limit = Limit::Stop(stop.id.clone());
            let margin = done
                .review
                .margins
                .iter()
                .find(|margin| margin.limit == limit);
            let margin = margin.expect("judged");
            println!("{autopilot} {airframe} {}: {:.2} m", stop.id, margin.value);
            assert!((margin.bound - 20.0).abs() < 1e-9);
        }
        let first = at_stop(&spec, items, 0)[0];
        let after: Vec<u16> = items[first + 1..first + 3]
            .iter()
            .map(|item| item.command)
            .collect();
        assert_eq!(
            after,
            [command::IMAGE_START_CAPTURE, command::DO_SET_ROI_NONE]
        );
        println!("{autopilot} {airframe}: {} items", items.len());
    }
}

#[test]
fn a_stop_of_a_wing_left_out_moved_or_out_of_order_fails_and_so_do_its_actions() {
    for (autopilot, airframe) in KINDS {
        let spec = spec(autopilot, airframe);
        let (world, done) = dispatched(&spec);
        let mission = &done.missions[0].1;
        let judged = |change: &dyn Fn(&mut Vec<Item>)| {
            let mut changed = mission.clone();
            change(&mut changed.items);
            failed(&review(&spec, &world, &[(0, &changed)]))
        };
        let names =
            |failed: &[String], what: &str| failed.iter().any(|line| line.starts_with(what));
        let [first, second] = [0, 1].map(|number| at_stop(&spec, &mission.items, number)[0]);
        let out = judged(&|items| {
            // The stop and the turns around it.
            items.drain(second - 3..second + 3);
        });
        assert!(names(&out, "stop t2"), "{out:?}");
        let moved = judged(&|items| move_aside(items, second, 30.0));
        assert!(names(&moved, "stop t2"), "{moved:?}");
        let mut swapped = spec.clone();
        // The way from the second stop to the third leads over the first.
        swapped.vehicles[0].stops.swap(1, 2);
        let mut other = world.clone();
        other.sites[0].stops.swap(1, 2);
        let order = failed(&review(&swapped, &other, &[(0, mission)]));
        assert!(names(&order, "stop t2"), "{order:?}");
        for (number, action) in spec.vehicles[0].stops[0].actions.iter().enumerate() {
            let at = first + 1 + number;
            let name = format!(
                "actions at stop t1: action {} ({}): no item does it",
                number + 1,
                action.key()
            );
            let dropped = judged(&|items| {
                items.remove(at);
            });
            assert!(names(&dropped, &name), "{dropped:?}");
            let late = judged(&|items| {
                let item = items.remove(at);
                items.insert(first + 3, item);
            });
            let name = format!(
                "actions at stop t1: action {} ({}): item {} does it, and the vehicle is nearest",
                number + 1,
                action.key(),
                first + 4
            );
            assert!(names(&late, &name), "{late:?}");
        }
        let reordered = judged(&|items| items.swap(first + 1, first + 2));
        assert!(
            names(&reordered, "actions at stop t1: action 2"),
            "{reordered:?}"
        );
    }
}

#[test]
fn actions_that_arduplane_would_drop_at_the_next_waypoint_fail() {
    let mut spec = spec("ardupilot", "plane");
    let (world, done) = dispatched(&spec);
    let mut mission = done.missions[0].1.clone();
    let first = at_stop(&spec, &mission.items, 0)[0];
    let photo = mission.items[first + 1];
    let many = vec![photo; 40];
    mission.items.splice(first + 1..first + 2, many);
    let roi_none = spec.vehicles[0].stops[0].actions[1].clone();
    spec.vehicles[0].stops[0].actions = vec![StopAction::Photo; 40];
    spec.vehicles[0].stops[0].actions.push(roi_none);
    let found = failed(&review(&spec, &world, &[(0, &mission)]));
    assert!(
        found
            .iter()
            .any(|line| line.contains("the next waypoint is reached before it")),
        "{found:?}"
    );
}

#[test]
fn a_hold_of_a_wing_is_a_circle_for_its_time_and_the_verdict_judges_it() {
    for (autopilot, airframe) in KINDS {
        let mut spec = spec(autopilot, airframe);
        spec.vehicles[0].stops[1].hold_s = 30.0;
        spec.vehicles[0].stops[1].actions = vec![StopAction::Photo];
        let (world, done) = dispatched(&spec);
        let mission = &done.missions[0].1;
        let is_circle = |item: &&Item| item.command == command::NAV_LOITER_TIME;
        let holds: Vec<f32> = mission
            .items
            .iter()
            .filter(is_circle)
            .map(|item| item.params[0])
            .collect();
        assert!(holds == [1.0, 29.0], "{holds:?}");
        let limit = Limit::StopHold("t2".to_owned());
        let margins = &done.review.margins;
        let margin = margins.iter().find(|margin| margin.limit == limit);
        assert!(margin.expect("judged").value >= 30.0);
        let flight = &done.plan.flights(&spec, &world)[0];
        let track = done.review.tracks[0].moments.last().expect("flown");
        let planned_s = flight.points.last().expect("planned").t_s;
        assert!(
            (track.t_s - planned_s).abs() < 60.0,
            "{} {planned_s}",
            track.t_s
        );
        let judged = |change: &dyn Fn(&mut Vec<Item>)| {
            let mut changed = mission.clone();
            change(&mut changed.items);
            failed(&review(&spec, &world, &[(0, &changed)]))
        };
        let named =
            |failed: &[String], what: &str| failed.iter().any(|line| line.starts_with(what));
        let at: Vec<usize> = (0..mission.items.len())
            .filter(|&index| is_circle(&&mission.items[index]))
            .collect();
        let halved = judged(&|items| items[at[1]].params[0] = 14.0);
        assert!(named(&halved, "hold at stop t2"), "{halved:?}");
        let none = judged(&|items| {
            items.drain(at[0]..=at[1]);
        });
        assert!(named(&none, "stop t2"), "{none:?}");
        let moved = judged(&|items| {
            for &index in &at {
                items[index].x += 2700;
            }
        });
        assert!(named(&moved, "stop t2"), "{moved:?}");
        let dropped = judged(&|items| {
            items.remove(at[0] + 1);
        });
        assert!(
            named(&dropped, "actions at stop t2: action 1 (photo)"),
            "{dropped:?}"
        );
        // Its circle is judged against all that is closed.
        let mut near = spec.clone();
        near.threats[0].place.lat_deg = 47.3855;
        near.threats[0].radius_m = 20.0;
        let closed = world_of(&near);
        let found = failed(&review(&near, &closed, &[(0, mission)]));
        assert!(named(&found, "threat mast"), "{found:?}");
    }
}

#[test]
fn a_wing_acts_at_its_start_and_at_its_goal_before_it_lands_or_circles() {
    for (autopilot, airframe) in KINDS {
        for finish in [Finish::Land, Finish::Loiter] {
            let mut spec = spec(autopilot, airframe);
            let vehicle = &mut spec.vehicles[0];
            vehicle.finish = finish;
            vehicle.stops.truncate(1);
            // A circle is flown up to 6 m off its height.
            vehicle.goal.altitude = Placement::Agl(Agl(100.0));
            let released = StopAction::Gripper { grabs: false };
            vehicle.on_way = OnWay {
                start: vec![StopAction::Video { starts: true }],
                goal: vec![StopAction::Photo, released],
                trigger_m: Some(60.0),
            };
            let (world, done) = dispatched(&spec);
            let mission = &done.missions[0].1;
            let items = &mission.items;
            let at = |command: u16| items.iter().rposition(|item| item.command == command);
            let (photo, release) = (
                at(command::IMAGE_START_CAPTURE).expect("a picture"),
                at(command::DO_GRIPPER).expect("a release"),
            );
            assert_eq!(release, photo + 1, "{autopilot} {airframe} {finish:?}");
            let is_place = |item: &&Item| item.command <= command::NAV_LAST;
            let before = items[..photo]
                .iter()
                .rfind(is_place)
                .expect("a place before");
            let after = items[release..]
                .iter()
                .find(is_place)
                .expect("a place after");
            assert_eq!(before.command, command::NAV_WAYPOINT);
            let circles = after.command == command::NAV_LOITER_UNLIM;
            assert_eq!(circles, finish == Finish::Loiter, "{}", after.command);
            let judged = |change: &dyn Fn(&mut Vec<Item>)| {
                let mut changed = mission.clone();
                change(&mut changed.items);
                failed(&review(&spec, &world, &[(0, &changed)]))
            };
            let dropped = judged(&|items| {
                items.remove(photo);
            });
            assert!(
                dropped.iter().any(|line| line
                    .starts_with("actions at stop goal: action 1 (photo): no item does it")),
                "{autopilot} {airframe} {finish:?}: {dropped:?}"
            );
            // Not where the mission is over: nothing after an endless circle or a landing is run.
            let late = judged(&|items| {
                let item = items.remove(photo);
                items.push(item);
            });
            assert!(
                late.iter()
                    .any(|line| line.contains("actions at stop goal: action 1 (photo)")),
                "{autopilot} {airframe} {finish:?}: {late:?}"
            );
            // Nor on the way to the goal.
            let early = judged(&|items| {
                let item = items.remove(photo);
                let stop = items
                    .iter()
                    .position(|item| item.command == command::NAV_WAYPOINT);
                items.insert(stop.expect("a waypoint"), item);
            });
            assert!(
                early
                    .iter()
                    .any(|line| line.contains("actions at stop goal: action 1 (photo)")),
                "{autopilot} {airframe} {finish:?}: {early:?}"
            );
        }
    }
}
