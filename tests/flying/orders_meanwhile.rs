//! Orders and starts at moments at which something else is under way.

use super::flight_truth::{count, sky, two};
use super::ready_and_t0::refusals;
use crate::support::sky::{Planned, Sky, lane, plan};
use crate::support::{place, plane, world};
use sortie::flight::*;
use sortie::geodesy::Amsl;
use sortie::link::*;
use sortie::simulator::Fault;
use sortie::spec::{
    Action, Answer, EndPoint, Finish, OnLinkLoss, Placement, Stop, Who, Wind, Zone,
};

/// One that is started so many seconds after T0.
fn started_at(plan: &Planned, starts_s: [f64; 2]) -> Sky<'_> {
    let options = plan.options(false);
    Sky::new(
        plan.fleet_started(options, true, &starts_s),
        plan.vehicles(),
    )
}

/// Two planes of ArduPilot: they stay armed on the ground.
fn planes() -> Planned {
    let at = |id: &str, sysid: u8, lat_deg: f64| sortie::spec::Vehicle {
        home: place(lat_deg, -84.30),
        ..plane(id, sysid, place(lat_deg, -84.28), place(lat_deg, -84.235))
    };
    let fleet = vec![at("alpha", 1, 36.29), at("bravo", 2, 36.31)];
    plan(fleet, OnLinkLoss::Continue)
}

#[test]
fn a_plane_that_is_ordered_to_land_right_after_a_hold_lands() {
    let plan = planes();
    let mut sky = sky(&plan);
    sky.fly_to(100.0);
    sky.fleet.intervene(sky.now, Intervention::Hold);
    sky.fly_to(100.1);
    sky.fleet.intervene(sky.now, Intervention::Land);
    assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
    assert!(sky.says("alpha", "lands as planned"), "{:?}", sky.events);
    assert_eq!(sky.end(0), End::Landed, "{:?}", sky.events);
}

#[test]
fn who_waits_armed_for_its_departure_is_disarmed_when_nobody_watches_any_more() {
    let plan = planes();
    let mut sky = started_at(&plan, [0.0, 60.0]);
    sky.fly_to(20.0);
    sky.fleet.intervene(sky.now, Intervention::Leave);
    assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
    assert_eq!(sky.end(0), End::LeftFlying, "{:?}", sky.events);
    assert_eq!(count(&sky, "bravo", "is disarmed"), 1, "{:?}", sky.events);
    assert_eq!(count(&sky, "bravo", "left flying"), 0, "{:?}", sky.events);
}

#[test]
fn who_could_not_be_started_at_its_departure_stays_on_the_ground() {
    for (stopped_s, stays) in [(3, false), (60, true)] {
        let plan = planes();
        let mut sky = started_at(&plan, [0.0, 20.0]);
        sky.fly_to(18.0);
        // This program is stopped; the vehicles fly on.
        let until = sky.now + 1000 * stopped_s;
        while sky.now < until {
            sky.now = sky.now + 20;
            for vehicle in &mut sky.vehicles {
                vehicle.handle_timeout(sky.now);
                while vehicle.poll_transmit().is_some() {}
            }
        }
        assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
        let text = "and it stays on the ground";
        let said = count(&sky, "bravo", text);
        assert_eq!(said, usize::from(stays), "{:?}", sky.events);
        assert_eq!(sky.says("bravo", "took off"), !stays, "{:?}", sky.events);
    }
}

#[test]
fn a_mission_that_is_cleared_before_the_start_starts_nobody() {
    for none in [0, u16::MAX] {
        let why = refusals(move |message| {
            if let Message::MissionCurrent { total, .. } = message {
                *total = none;
            }
        });
        let text = "its mission was cleared on board after it was read";
        assert!(why.iter().any(|(_, of)| of == text), "{why:?}");
    }
}

#[test]
fn an_order_waits_on_although_another_alarm_of_its_kind_is_over() {
    let mut plan = two();
    plan.spec.vehicles[0].return_amsl = Some(Amsl(520.0));
    plan.spec.vehicles[0].goal.place = place(36.302, -84.238);
    let plan = crate::support::sky::plan(plan.spec.vehicles, OnLinkLoss::Continue);
    let mut plan = plan;
    let (who, action) = (Who::Vehicle, Action::Return);
    plan.spec.on_alarm.position = Some(Answer { who, action });
    // It is closed behind the vehicle for some time.
    let (west, east) = (-84.2575, -84.2565);
    let corners = [
        (36.295, west),
        (36.295, east),
        (36.305, east),
        (36.305, west),
    ];
    let corners = corners.map(|(lat, lon)| place(lat, lon)).to_vec();
    plan.spec.no_fly = vec![Zone {
        active_s: Some((60.0, 110.0)),
        ..Zone::closed("road".to_owned(), corners)
    }];
    plan.world = world(&plan.spec);
    let mut sky = sky(&plan);
    sky.fly_to(62.0);
    sky.vehicles[0].fail(Fault::NoFix);
    sky.fly_to(70.0);
    let waits = "on_alarm position: does not return, it continues: its way home leads into road";
    assert_eq!(count(&sky, "alpha", waits), 1, "{:?}", sky.events);
    for (north_m, until_s) in [(25.0, 70.3), (0.0, 80.0)] {
        let east_m = 0.0;
        sky.vehicles[0].fail(Fault::Jump { east_m, north_m });
        sky.fly_to(until_s);
    }
    assert!(
        sky.says("alpha", "over after 0 s (jump)"),
        "{:?}",
        sky.events
    );
    sky.fly_to(120.0);
    let text = "on_alarm position: is ordered to return";
    assert_eq!(count(&sky, "alpha", text), 1, "{:?}", sky.events);
}

#[test]
fn a_long_hold_does_not_excuse_lateness_on_later_legs() {
    let end = |lon_deg| EndPoint {
        place: place(36.302, lon_deg),
        altitude: Placement::Agl(sortie::geodesy::Agl(80.0)),
    };
    let mut alpha = lane("alpha", 1, 36.30);
    alpha.goal.place = place(36.302, -84.21);
    alpha.finish = Finish::Land;
    let hold = Stop {
        hold_s: 120.0,
        ..Stop::passing("mast", end(-84.254))
    };
    alpha.stops = vec![
        hold,
        Stop::passing("bend", end(-84.248)),
        Stop::passing("pole", end(-84.240)),
    ];
    let plan = plan(vec![alpha], OnLinkLoss::Continue);
    let mut sky = sky(&plan);
    let at = |sky: &Sky<'_>| {
        let flown = sky.fleet.flown().next().expect("alpha").1;
        flown.fixes.last().map_or(-85.0, |fix| fix.place.lon_deg)
    };
    while at(&sky) < -84.246 {
        sky.step();
        assert!(sky.now.0 < 900_000, "{:?}", sky.events);
    }
    assert_eq!(count(&sky, "alpha", "ALARM"), 0, "{:?}", sky.events);
    // It gets no further than at walking pace.
    sky.vehicles[0].fail(Fault::Wind {
        wind: Wind {
            speed_mps: 8.0,
            from_rad: std::f64::consts::FRAC_PI_2,
        },
        airspeed_mps: 9.0,
    });
    let from_s = sky.fleet.t_s(sky.now).expect("T0");
    sky.fly_to(from_s + 60.0);
    assert_eq!(count(&sky, "alpha", "ALARM late"), 1, "{:?}", sky.events);
}
