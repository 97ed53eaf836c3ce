//! A fleet launched, watched and judged, in virtual time against simulated vehicles.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss
)]

use crate::support::{self, sky};
use sky::{Sky, US, lane, parameters, plan, plan_shipped};
use sortie::flight::*;
use sortie::geodesy::Agl;
use sortie::link::*;
use sortie::mission::{Item, command};
use sortie::simulator::{Surroundings, Vehicle};
use sortie::spec::{
    Autopilot, EndPoint, OnLinkLoss, Order, Placement, Stop, StopAction, Vehicle as Spec,
};
use sortie::verify::{Flown, Limit};
use support::place;

/// Three side by side, a kilometre each; the second is a PX4, the third starts later.
fn three() -> Vec<Spec> {
    let mut fleet = vec![
        lane("alpha", 1, 36.300),
        lane("bravo", 2, 36.304),
        lane("charlie", 3, 36.308),
    ];
    fleet[1].autopilot = Autopilot::Px4;
    fleet[2].depart_s = 30.0;
    fleet
}

#[test]
fn three_fly_their_plan_and_the_limits_hold() {
    let plan = plan(three(), OnLinkLoss::Continue);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
    let report = plan.judge(&sky);
    assert!(report.passes(), "{report:#?}");
    assert_eq!(report.vehicles.len(), 3);
    for vehicle in &report.vehicles {
        assert_eq!(vehicle.end, "landed");
        let cross = vehicle.cross_track_m.expect("positions");
        let high = vehicle.altitude_error_m.expect("positions");
        assert!(cross.worst < 6.0 && cross.median < 1.5, "{cross:?}");
        assert!(high.worst < 3.0 && high.median < 1.0, "{high:?}");
        assert!(vehicle.passages.len() >= 2, "{vehicle:?}");
        for passage in &vehicle.passages {
            assert!(passage.late_s().abs() < 15.0, "{passage:?}");
        }
    }
    let separations = report
        .margins
        .iter()
        .filter(|m| m.limit == Limit::Separation);
    assert_eq!(separations.count(), 3, "each pair");
    // The delay is in the mission, and waited for once.
    let charlie = sky.fleet.flown().nth(2).expect("charlie").1;
    let up = charlie
        .fixes
        .iter()
        .find(|fix| fix.amsl.0 > 402.0)
        .expect("it flew");
    assert!((30.0..36.0).contains(&up.t_s), "{up:?}");
}

#[test]
fn the_shipped_fleet_flies_over_the_mountains_and_its_limits_hold() {
    let plan = plan_shipped("jacksboro", |spec| spec.planner.evaluations = 6000);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
    let report = plan.judge(&sky);
    assert!(report.passes(), "{report:#?}");
    let ends: Vec<&str> = report.vehicles.iter().map(|v| v.end.as_str()).collect();
    assert_eq!(ends, ["landed", "loiters", "landed"]);
    for vehicle in &report.vehicles {
        let cross = vehicle.cross_track_m.expect("positions");
        let high = vehicle.altitude_error_m.expect("positions");
        assert!(cross.worst < 6.0 && high.worst < 3.0, "{vehicle:?}");
        for passage in &vehicle.passages {
            assert!(passage.late_s().abs() < 25.0, "{passage:?}");
        }
    }
    let of = |what: &str| {
        report
            .margins
            .iter()
            .filter(|m| m.limit.to_string() == what)
            .count()
    };
    assert_eq!((of("separation"), of("terrain clearance")), (3, 3));
    assert_eq!(of("threat radar-cross"), 3);
}

#[test]
fn a_flight_is_judged_alike_from_its_record_and_from_a_capture_of_its_links() {
    let plan = plan(three(), OnLinkLoss::Continue);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
    let record = plan.record(&sky);
    let mut lines: Vec<Line> = sky.events.iter().map(Line::of_event).collect();
    for flight in &record.flights {
        lines.push(Line::of_plan(&flight.vehicle, 0.0, &flight.plans[0]));
        let fixes = flight.flown.fixes.iter();
        lines.extend(fixes.map(|fix| Line::of_fix(&flight.vehicle, fix)));
        lines.push(Line::of_end(&flight.vehicle, &flight.flown));
    }
    let lines = lines
        .iter()
        .map(|line| serde_json::to_string(line).expect("JSON"));
    let text = lines.collect::<Vec<_>>().join("\n");
    let read = read_record(&text, plan.world.frame).expect("a record");
    let captures: Vec<Capture> = record
        .flights
        .iter()
        .zip(&plan.dispatched.missions)
        .map(|(flight, (index, mission))| Capture {
            vehicle: flight.vehicle.clone(),
            sysid: plan.spec.vehicles[*index].sysid,
            autopilot: mission.autopilot,
            airframe: mission.airframe,
            plan: flight.plans[0].clone(),
        })
        .collect();
    // What is no frame is passed over.
    let spoilt = [&[1, 2, 3], sky.capture.as_slice()].concat();
    let captured = read_tlog(&spoilt, &captures).expect("a capture");
    let first = judge(&plan.spec, &plan.world, &record);
    for other in [&read, &captured] {
        let again = judge(&plan.spec, &plan.world, other);
        assert!(again.passes(), "{again:#?}");
        for (one, two) in first.vehicles.iter().zip(&again.vehicles) {
            assert_eq!(one.end, two.end);
            let (one, two) = (
                one.cross_track_m.expect("some"),
                two.cross_track_m.expect("some"),
            );
            assert!((one.worst - two.worst).abs() < 0.05, "{one:?} {two:?}");
        }
        // T0 of a capture is the first heartbeat that shows a vehicle armed; that of a flight, the
        // last: a second at most.
        let last = |record: &Record| record.flights[0].flown.fixes.last().expect("positions").t_s;
        let later_s = last(other) - last(&record);
        assert!((-0.01..1.1).contains(&later_s), "{later_s}");
        for (one, two) in first.margins.iter().zip(&again.margins) {
            assert_eq!((&one.vehicle, &one.limit), (&two.vehicle, &two.limit));
            let is_end = one.limit == Limit::Flown(sortie::verify::Flown::End);
            let since_t0_s = if is_end { later_s } else { 0.0 };
            let near = (one.value + since_t0_s - two.value).abs() < 0.3;
            assert!(near, "{one:?} {two:?}");
        }
    }
    assert!(read_tlog(b"nothing of the kind", &captures).is_err());
}

#[test]
fn a_new_plan_counts_from_where_the_vehicle_says_that_it_holds_it() {
    let plan = plan(three(), OnLinkLoss::Continue);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    sky.fly_out();
    let mut record = plan.record(&sky);
    let flight = &mut record.flights[0];
    // As if its second half had been flown by a plan 50 m beside the first.
    let items = flight.plans[0].items + 1;
    let half = flight.flown.fixes.len() / 2;
    let mut beside = flight.plans[0].clone();
    beside.items = items;
    for waypoint in &mut beside.reference.waypoints {
        waypoint.point.at.north_m += 50.0;
    }
    flight.plans.push(beside);
    let before = judge(&plan.spec, &plan.world, &record);
    assert!(before.vehicles[0].cross_track_m.expect("some").worst < 6.0);
    for fix in &mut record.flights[0].flown.fixes[half..] {
        fix.items = items;
    }
    let after = judge(&plan.spec, &plan.world, &record);
    let cross = after.vehicles[0].cross_track_m.expect("some");
    assert!((40.0..56.0).contains(&cross.worst), "{cross:?}");
    // A threat that came up counts from then on.
    let there = record.flights[0].flown.fixes[half];
    let popup = |from_s: f64| PopUp {
        from_s,
        threat: sortie::spec::Threat {
            id: "popup-1".to_owned(),
            kind: "popup".to_owned(),
            place: there.place,
            radius_m: 40.0,
        },
    };
    let worst = |record: &Record| {
        let report = judge(&plan.spec, &plan.world, record);
        let of = |m: &&sortie::verify::Margin| {
            m.vehicle == "alpha" && m.limit == Limit::Threat("popup-1".to_owned())
        };
        let found = report
            .margins
            .iter()
            .find(of)
            .map(|margin| (margin.value, margin.ok));
        found.expect("judged")
    };
    record.popups = vec![popup(there.t_s - 1.0)];
    let (value, ok) = worst(&record);
    assert!((-40.0..-39.0).contains(&value) && !ok, "{value}");
    record.popups = vec![popup(there.t_s + 10.0)];
    assert!(worst(&record).1, "it came up behind the vehicle");
}

#[test]
fn a_reading_suffices_when_the_missions_are_on_board_and_none_starts_otherwise() {
    let plan = plan(three(), OnLinkLoss::Continue);
    let mut sky = Sky::new(plan.fleet(false, false), plan.vehicles());
    let Outcome::NotStarted(why) = sky.fly_out() else {
        panic!("nothing was on board");
    };
    assert_eq!(why.len(), 6, "mission and fence of three: {why:?}");
    assert!(
        why[0].1.contains("what is on board is not the plan"),
        "{why:?}"
    );
    // Loaded by one fleet, flown by the next.
    let mut loading = Sky::new(plan.fleet(false, true), plan.vehicles());
    while loading
        .events
        .iter()
        .all(|event| event.text != "all are ready")
    {
        loading.step();
    }
    loading.fleet.intervene(loading.now, Intervention::Leave);
    for _ in 0..200 {
        loading.step();
    }
    assert!(loading.vehicles.iter().all(|vehicle| !vehicle.is_armed()));
    let mut sky = Sky::new(plan.fleet(false, false), loading.vehicles);
    sky.now = loading.now;
    sky.fly_to(5.0);
    assert!(sky.vehicles.iter().all(Vehicle::is_armed));
}

#[test]
fn none_is_started_when_one_is_not_as_assumed_and_what_differs_is_named() {
    let plan = plan(three(), OnLinkLoss::Continue);
    let mut vehicles = plan.vehicles();
    let (index, mission) = &plan.dispatched.missions[2];
    let this = &plan.spec.vehicles[*index];
    let mut params = parameters(mission);
    params
        .iter_mut()
        .filter(|p| p.0 == "WPNAV_SPEED")
        .for_each(|p| p.1 = 500.0);
    let home = sortie::mission::Home {
        amsl_m: mission.home.amsl_m + 30.0,
        ..mission.home
    };
    let profile = this.autopilot.into();
    let surroundings = |params| Surroundings {
        params,
        ..Surroundings::default()
    };
    let at = |home, params| Vehicle::within(profile, 3, Some(home), surroundings(params), Time(0));
    vehicles[2] = at(home, params.clone());
    let mut sky = Sky::new(plan.fleet(false, true), vehicles);
    let Outcome::NotStarted(why) = sky.fly_out() else {
        panic!("it was started");
    };
    let text = format!("{why:?}");
    assert!(
        text.contains("parameter WPNAV_SPEED is 500, the verdict assumes 1500"),
        "{text}"
    );
    assert!(text.contains("home is at 430.0 m above the sea"), "{text}");
    assert!(
        why.iter().all(|(vehicle, _)| vehicle == "charlie"),
        "{text}"
    );
    for _ in 0..100 {
        sky.step();
    }
    assert!(sky.vehicles.iter().all(|vehicle| !vehicle.is_armed()));
    // The parameter can be set.
    let mut vehicles = plan.vehicles();
    vehicles[2] = at(mission.home, params);
    let mut sky = Sky::new(plan.fleet(true, true), vehicles);
    sky.fly_to(1.0);
}

#[test]
fn none_is_started_with_a_parameter_on_board_that_the_verdict_does_not_judge() {
    let plan = plan(three(), OnLinkLoss::Continue);
    let with = |value: f32| {
        let (index, mission) = &plan.dispatched.missions[2];
        let mut params = parameters(mission);
        params.push(("OA_TYPE".to_owned(), value));
        let surroundings = Surroundings {
            params,
            ..Surroundings::default()
        };
        let profile = plan.spec.vehicles[*index].autopilot.into();
        let mut vehicles = plan.vehicles();
        vehicles[2] = Vehicle::within(profile, 3, Some(mission.home), surroundings, Time(0));
        vehicles
    };
    // Nor is it set.
    for sets in [false, true] {
        let mut sky = Sky::new(plan.fleet(sets, true), with(1.0));
        let Outcome::NotStarted(why) = sky.fly_out() else {
            panic!("it was started");
        };
        assert_eq!(why.len(), 1, "{why:?}");
        let text =
            "parameter OA_TYPE is 1 (judged: 0): the verdict does not know how it flies with that";
        let is_named = why[0].0 == "charlie" && why[0].1.contains(text);
        assert!(is_named, "{why:?}");
    }
    let mut sky = Sky::new(plan.fleet(false, true), with(0.0));
    sky.fly_to(1.0);
}

#[test]
fn who_is_silent_is_told_with_those_alone_that_are_heard_on_its_link() {
    let plan = plan(three(), OnLinkLoss::Continue);
    let why = |vehicles: Vec<Vehicle>| {
        let mut sky = Sky::new(plan.fleet(false, false), vehicles);
        sky.cut.push(2);
        let Outcome::NotStarted(why) = sky.fly_out() else {
            panic!("bravo is silent");
        };
        let mut of = why.into_iter().filter(|(vehicle, _)| vehicle == "bravo");
        of.next().expect("bravo").1
    };
    let silence = "no heartbeat from system 2 within 10 s";
    assert_eq!(why(plan.vehicles()), silence);
    // Charlie speaks where bravo should.
    let mut vehicles = plan.vehicles();
    vehicles.remove(1);
    let heard = format!("{silence} (heard on the link: system 3)");
    assert_eq!(why(vehicles), heard);
}

#[test]
fn a_lost_link_is_shown_and_all_hold_if_the_spec_says_so() {
    let plan = plan(three(), OnLinkLoss::HoldAll);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    sky.fly_to(60.0);
    sky.cut.push(2);
    sky.fly_to(70.0);
    assert!(sky.says("bravo", "link lost"), "{:?}", sky.events);
    let status = sky.fleet.status(sky.now);
    assert!(status[1].lost_s.is_some_and(|s| s > 5.0), "{status:?}");
    sky.fly_out();
    assert!(!sky.says("bravo", "link is back"), "{:?}", sky.events);
    assert_eq!((sky.end(0), sky.end(2)), (End::Held, End::Held));
    assert!(matches!(sky.end(1), End::Failed(_)));
    let report = plan.judge(&sky);
    assert!(!report.passes());
}

#[test]
fn whoever_leaves_before_the_start_leaves_nobody_flying() {
    let plan = plan(three(), OnLinkLoss::Continue);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    (0..20).for_each(|_| sky.step());
    sky.fleet.intervene(sky.now, Intervention::Leave);
    assert!(matches!(sky.fly_out(), Outcome::NotStarted(_)));
    assert!(!sky.says("alpha", "left flying"), "{:?}", sky.events);
    assert_eq!(sky.end(0), End::NotFlown);
}

#[test]
fn whoever_is_left_flying_with_a_dead_link_is_not_said_to_be_back() {
    let plan = plan(three(), OnLinkLoss::Continue);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    sky.fly_to(60.0);
    sky.cut.push(2);
    sky.fly_to(70.0);
    sky.fleet.intervene(sky.now, Intervention::Leave);
    sky.fly_out();
    assert!(sky.says("bravo", "link lost"), "{:?}", sky.events);
    assert!(!sky.says("bravo", "link is back"), "{:?}", sky.events);
    assert_eq!(sky.end(1), End::LeftFlying);
}

#[test]
fn with_continue_the_others_fly_on_and_the_time_in_the_dark_is_in_the_report() {
    let plan = plan(three(), OnLinkLoss::Continue);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    sky.fly_to(60.0);
    sky.cut.push(1);
    sky.fly_to(72.0);
    sky.cut.clear();
    sky.fly_to(74.0);
    assert!(sky.says("alpha", "link lost") && sky.says("alpha", "link is back"));
    sky.fly_out();
    for index in 0..3 {
        assert_eq!(sky.end(index), End::Landed);
    }
    let report = plan.judge(&sky);
    let failed: Vec<_> = report.margins.iter().filter(|margin| !margin.ok).collect();
    assert_eq!(failed.len(), 1, "{failed:?}");
    assert_eq!(failed[0].limit, Limit::Flown(Flown::Gap));
    assert!((11.0..14.0).contains(&failed[0].value), "{failed:?}");
}

#[test]
fn a_vehicle_that_somebody_else_holds_is_told_of_and_the_flight_fails() {
    let plan = plan(three(), OnLinkLoss::Continue);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    sky.fly_to(50.0);
    sky.order(0, Command::NAV_LOITER_UNLIM);
    sky.fly_out();
    assert!(
        sky.says(
            "alpha",
            "left its mission for LOITER: commanded by system 255"
        ),
        "{:?}",
        sky.events
    );
    assert!(matches!(sky.end(0), End::Failed(_)), "{:?}", sky.end(0));
    assert_eq!(sky.end(1), End::Landed);
    let report = plan.judge(&sky);
    assert!(!report.passes());
    assert!(
        report.vehicles[0].end.contains("has not ended"),
        "{report:?}"
    );
}

#[test]
fn an_operator_who_wants_all_to_land_has_them_land() {
    let plan = plan(three(), OnLinkLoss::Continue);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    sky.fly_to(45.0);
    sky.fleet.intervene(sky.now, Intervention::Land);
    sky.fly_out();
    for index in 0..3 {
        assert_eq!(sky.end(index), End::LandedEarly);
        assert!(!sky.vehicles[index].is_armed());
    }
}

#[test]
fn a_vehicle_that_flies_another_way_breaks_limits_and_the_verdict_says_where() {
    let plan = plan(three(), OnLinkLoss::Continue);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    sky.fly_to(50.0);
    // Somebody uploads another mission to alpha: low, and over to where bravo flies.
    let low = |lat: f64, lon: f64, amsl_m: f32, command| Item {
        command,
        frame: 0,
        autocontinue: true,
        params: [0.0; 4],
        x: (lat * 1e7) as i32,
        y: (lon * 1e7) as i32,
        z: amsl_m,
    };
    let rows = [
        low(36.3, -84.26, 400.0, command::NAV_WAYPOINT),
        low(36.305, -84.252, 430.0, command::NAV_WAYPOINT),
        low(36.302, -84.248, 430.0, command::NAV_WAYPOINT),
        low(36.302, -84.248, 0.0, command::NAV_LAND),
    ];
    let target = sky.vehicles[0].address();
    let mut say = |body| {
        let mission_type = 0;
        let message = Message::Mission(MissionMessage {
            target,
            mission_type,
            body,
        });
        sky.vehicles[0].handle(sky.now, US, &message);
    };
    let (count, opaque_id) = (4, 0);
    say(Body::Count { count, opaque_id });
    for (seq, item) in (0..).zip(rows) {
        let current = 0;
        say(Body::ItemInt { seq, current, item });
    }
    let set = Message::Flight(FlightMessage::SetCurrent { target, seq: 1 });
    sky.vehicles[0].handle(sky.now, US, &set);
    sky.fly_out();
    let report = plan.judge(&sky);
    let failed: Vec<&Limit> = report
        .margins
        .iter()
        .filter(|margin| !margin.ok)
        .map(|margin| &margin.limit)
        .collect();
    assert!(failed.contains(&&Limit::TerrainClearance), "{failed:?}");
    let worst = report.vehicles[0].cross_track_m.expect("positions").worst;
    assert!(worst > 100.0, "{worst}");
    let low = report
        .margins
        .iter()
        .find(|m| m.limit == Limit::TerrainClearance)
        .expect("judged");
    assert!(
        (28.0..32.0).contains(&low.value) && low.at.is_some(),
        "{low:?}"
    );
}

#[test]
fn copters_of_both_autopilots_rest_at_their_stops_and_their_limits_hold() {
    let mut fleet = three();
    fleet.truncate(2);
    for vehicle in &mut fleet {
        let end = |lat_deg: f64, lon_deg: f64| EndPoint {
            place: support::place(vehicle.start.place.lat_deg + lat_deg, lon_deg),
            ..vehicle.start
        };
        let stop = |id: &str, end: EndPoint, hold_s: f64| Stop {
            hold_s,
            acceptance_radius_m: Some(3.0),
            ..Stop::passing(id, end)
        };
        vehicle.speed_mps = 8.0;
        vehicle.stops = vec![
            stop("far", end(0.001, -84.250), 20.0),
            stop("near", end(0.0, -84.256), 5.0),
        ];
        vehicle.stops[0].heading_rad = Some(0.0);
        vehicle.order = Order::Free;
    }
    let plan = plan(fleet, OnLinkLoss::Continue);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
    let report = plan.judge(&sky);
    assert!(report.passes(), "{report:#?}");
    for (index, (_, track)) in sky.fleet.flown().enumerate() {
        for (stop, point) in plan.spec.vehicles[index]
            .stops
            .iter()
            .zip(&plan.world.sites[index].stops)
        {
            let near = track.fixes.iter().filter(|fix| {
                let at = plan.world.frame.to_plan(fix.place);
                at.distance_m(point.at) < 3.0 && (fix.amsl.0 - point.amsl.0).abs() < 3.0
            });
            let times: Vec<f64> = near.map(|fix| fix.t_s).collect();
            let rested_s = times.last().expect("it was there") - times[0];
            assert!(rested_s >= stop.hold_s - 1.0, "{}: {rested_s} s", stop.id);
        }
    }
}

/// A copter with a stop 220 m aside of its lane, 80 m above the ground.
fn aside(autopilot: Autopilot, stop: impl Fn(EndPoint) -> Stop) -> Spec {
    let end = EndPoint {
        place: place(36.302, -84.254),
        altitude: Placement::Agl(Agl(80.0)),
    };
    Spec {
        autopilot,
        speed_mps: 9.0,
        stops: vec![stop(end)],
        ..lane("alpha", 1, 36.30)
    }
}

#[test]
fn a_copter_takes_its_pictures_and_says_so() {
    for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
        let alpha = aside(autopilot, |end| Stop {
            hold_s: 4.0,
            actions: vec![StopAction::Photo],
            ..Stop::passing("mast", end)
        });
        let plan = plan(vec![alpha], OnLinkLoss::Continue);
        let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
        assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
        assert!(
            sky.says("alpha", "picture 1 (stop mast)"),
            "{:?}",
            sky.events
        );
        let report = plan.judge(&sky);
        assert!(report.passes(), "{report:#?}");
        let stop = &report.vehicles[0].stops[0];
        assert!(stop.id == "mast" && stop.distance_m < 2.0, "{stop:?}");
    }
}

#[test]
fn a_copter_places_its_load_on_the_ground_and_flies_on() {
    let max_descent_m = None;
    let alpha = aside(Autopilot::ArduPilot, |end| Stop {
        actions: vec![
            StopAction::PayloadPlace { max_descent_m },
            StopAction::Photo,
        ],
        ..Stop::passing("yard", end)
    });
    let plan = plan(vec![alpha], OnLinkLoss::Continue);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
    assert!(sky.says("alpha", "releasing"), "{:?}", sky.events);
    assert!(
        sky.says("alpha", "picture 1 (stop yard)"),
        "{:?}",
        sky.events
    );
    let report = plan.judge(&sky);
    assert!(report.passes(), "{report:#?}");
    let (_, track) = sky.fleet.flown().next().expect("flown");
    let at = plan.world.sites[0].stops[0].at;
    let below = track
        .fixes
        .iter()
        .filter(|fix| plan.world.frame.to_plan(fix.place).distance_m(at) < 3.0);
    let lowest_m = below.map(|fix| fix.amsl.0).fold(f64::INFINITY, f64::min);
    let ground_m = plan.world.sites[0].stops[0].amsl.0 - 80.0;
    assert!((lowest_m - ground_m).abs() < 1.0, "{lowest_m} {ground_m}");
}

/// Copters of both autopilots come straight down to a place below the least height above ground.
#[test]
fn a_copter_comes_down_to_a_low_place_and_its_limits_hold() {
    for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
        let alpha = aside(autopilot, |end| Stop {
            drop_m: 74.0,
            hold_s: 4.0,
            actions: vec![StopAction::Gripper { grabs: false }],
            ..Stop::passing("yard", end)
        });
        let plan = plan(vec![alpha], OnLinkLoss::Continue);
        let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
        assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
        let alarms = sky.events.iter().filter(|event| event.alarm.is_some());
        assert_eq!(alarms.count(), 0, "{:?}", sky.events);
        let report = plan.judge(&sky);
        assert!(report.passes(), "{report:#?}");
        let (_, track) = sky.fleet.flown().next().expect("flown");
        let top = plan.world.sites[0].stops[0];
        let near = track.fixes.iter().filter(|fix| {
            let at = plan.world.frame.to_plan(fix.place);
            at.distance_m(top.at) < 3.0 && (fix.amsl.0 - (top.amsl.0 - 74.0)).abs() < 1.5
        });
        let times: Vec<f64> = near.map(|fix| fix.t_s).collect();
        let rested_s = times.last().expect("it was there") - times[0];
        assert!(rested_s >= 3.0, "{rested_s} s");
    }
}

#[test]
fn a_copter_takes_pictures_along_its_way() {
    let mut alpha = sky::lane("alpha", 1, 36.30);
    alpha.speed_mps = 9.0;
    alpha.on_way.trigger_m = Some(50.0);
    let plan = plan(vec![alpha], OnLinkLoss::Continue);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
    // 1.1 km at 50 m: a first, one every 50 m, and a last.
    assert!(sky.says("alpha", "picture 20"), "{:?}", sky.events);
    assert!(!sky.says("alpha", "picture 30"), "{:?}", sky.events);
}

#[test]
fn the_inspection_mission_makes_its_stops_and_takes_its_pictures() {
    let plan = plan_shipped("inspection", |_| {});
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
    let report = plan.judge(&sky);
    assert!(report.passes(), "{report:#?}");
    for (vehicle, pictures) in [("alpha", 4), ("bravo", 4)] {
        assert!(sky.says(vehicle, "(stop south)"), "{:?}", sky.events);
        let numbers = |number: u32| sky.says(vehicle, &format!("picture {number}"));
        // Of many pictures every tenth is said, of few the first three.
        assert!((1..=3.min(pictures)).all(numbers), "{:?}", sky.events);
    }
    for vehicle in &report.vehicles {
        assert!(vehicle.stops.len() == 4, "{vehicle:?}");
        assert!(
            vehicle.stops.iter().all(|stop| stop.distance_m < 2.0),
            "{vehicle:?}"
        );
    }
}

#[test]
fn an_item_that_is_reached_beside_a_stop_is_not_of_it() {
    let alpha = aside(Autopilot::ArduPilot, |end| Stop::passing("yard", end));
    let plan = plan(vec![alpha], OnLinkLoss::Continue);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    // The next item is a few metres on.
    sky.down = Some(Box::new(|_, from, message| {
        let next = match &message {
            Message::Flight(FlightMessage::ItemReached { seq: 5 }) => {
                Some(Message::Flight(FlightMessage::ItemReached { seq: 6 }))
            }
            _ => None,
        };
        let all = std::iter::once(message).chain(next);
        all.map(|message| (from, message)).collect()
    }));
    assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
    let reached = |item: u32| {
        let of = format!("item {item} reached");
        let said = sky.events.iter().find(|event| event.text.starts_with(&of));
        said.map(|event| event.text.clone()).unwrap_or_default()
    };
    assert_eq!(reached(5), "item 5 reached (stop yard)");
    assert_eq!(reached(6), "item 6 reached");
}
