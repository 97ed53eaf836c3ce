//! A record of a flight that nobody can have flown does not pass, however well it fits its plan.

use std::collections::VecDeque;

use super::flight_truth::{sky as sky_of, two};
use crate::support::{doctored, sky};
use doctored::{failed, moved, says};
use sky::{Planned, Sky, plan_shipped};
use sortie::flight::*;
use sortie::verify::{Flown, Limit};

/// The times of a flight, so many times as fast.
fn hasten(record: &mut Record, share: f64) {
    for flight in &mut record.flights {
        for plan in &mut flight.plans {
            plan.reference.end_s *= share;
            let ways = plan.reference.waypoints.iter_mut();
            ways.for_each(|waypoint| waypoint.t_s *= share);
        }
        let flown = &mut flight.flown;
        flown.until_s = flown.until_s.map(|t_s| t_s * share);
        flown.fixes.iter_mut().for_each(|fix| fix.t_s *= share);
        flown.reached.iter_mut().for_each(|(_, t_s)| *t_s *= share);
    }
}

#[test]
fn a_flight_in_half_the_time_cannot_have_been_flown_whatever_speeds_and_speedup_it_tells() {
    for speedup in [1.0, 20.0, 100.0] {
        for told in [1.0, 2.0] {
            let bad = failed(|record| {
                record.speedup = speedup;
                hasten(record, 0.5);
                let fixes = record.flights.iter_mut().map(|of| &mut of.flown.fixes);
                fixes.flatten().for_each(|fix| fix.speed_mps *= told);
            });
            for vehicle in ["alpha", "bravo", "charlie"] {
                let held = says(&bad, vehicle, "ground speed held");
                assert!(held, "{vehicle} {speedup} {told}: {bad:?}");
                let covered = says(&bad, vehicle, "ground covered by its own speed");
                assert_eq!(covered, told < 1.5, "{vehicle} {speedup}: {bad:?}");
            }
        }
    }
    // Somewhat faster than planned is what vehicles are.
    assert_eq!(failed(|record| hasten(record, 0.95)), Vec::new());
}

#[test]
fn nobody_climbs_or_descends_much_faster_than_it_may() {
    // A ramp of 200 m within 20 s, up and down again, over a flight that is level.
    let what = ["climb rate held", "descent rate held"];
    for (sign, what) in [1.0, -1.0].into_iter().zip(what) {
        let bad = failed(|record| {
            for fix in &mut record.flights[0].flown.fixes {
                let since_s = (fix.t_s - 45.0).clamp(0.0, 20.0);
                *fix = moved(fix, 0.0, sign * 10.0 * since_s);
            }
        });
        assert!(says(&bad, "alpha", what), "{bad:?}");
    }
}

#[test]
fn a_wing_flies_no_mission_in_half_the_time() {
    for name in ["plane-ardupilot", "vtol-px4"] {
        let plan = plan_shipped(name, |spec| spec.planner.evaluations = 6000);
        let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
        assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
        let record = plan.record(&sky);
        let report = judge(&plan.spec, &plan.world, &record);
        assert!(report.passes(), "{name}: {report:#?}");
        for told in [1.0, 2.0] {
            let mut record = record.clone();
            hasten(&mut record, 0.5);
            let fixes = record.flights[0].flown.fixes.iter_mut();
            fixes.for_each(|fix| fix.speed_mps *= told);
            let report = judge(&plan.spec, &plan.world, &record);
            let bad = report.margins.iter().filter(|margin| !margin.ok);
            let bad: Vec<&Limit> = bad.map(|margin| &margin.limit).collect();
            assert!(
                bad.contains(&&Limit::Flown(Flown::GroundSpeed)),
                "{name}: {bad:?}"
            );
        }
    }
}

#[test]
fn a_vehicle_whose_clock_slips_behind_that_of_the_fleet_was_not_silent() {
    // As where the machine stalled for 0.6 s at ten times speed: the vehicle lived on later.
    let slipped = |has_own_clock: bool| {
        failed(|record| {
            let flown = &mut record.flights[0].flown;
            let half = flown.fixes.len() / 2;
            for fix in &mut flown.fixes[half..] {
                fix.t_s += 6.0;
            }
            flown.until_s = flown.until_s.map(|t_s| t_s + 6.0);
            if !has_own_clock {
                flown.fixes.iter_mut().for_each(|fix| fix.boot_ms = None);
            }
        })
    };
    let gap = "longest time without a position";
    assert!(!says(&slipped(true), "alpha", gap));
    assert!(says(&slipped(false), "alpha", gap));
    // A hole in the record is one by either clock.
    let holed = failed(|record| {
        let flown = &mut record.flights[0].flown;
        let half = flown.fixes.len() / 2;
        flown.fixes.drain(half..half + 40);
    });
    assert!(says(&holed, "alpha", gap), "{holed:?}");
}

/// The flight of two whose simulators live so much of each 20 ms from T0 + 5 s on.
fn slowed(plan: &Planned, lives_ms: u64) -> Sky<'_> {
    let mut sky = sky_of(plan);
    sky.fly_to(5.0);
    sky.lives_ms = lives_ms;
    assert_eq!(sky.fly_out(), Outcome::Flown);
    sky
}

#[test]
fn who_is_late_because_its_simulator_falls_behind_the_clock_ends_its_flight() {
    let plan = two();
    let sky = slowed(&plan, 9);
    // Later than any vehicle may be in its own time.
    let ends_s = plan.references()[0].end_s;
    let t_s = sky
        .events
        .last()
        .and_then(|event| event.t_s)
        .expect("a flight");
    assert!(t_s > 1.25 * ends_s + 90.0, "{t_s} s");
    for index in [0, 1] {
        assert_eq!(sky.end(index), End::Landed, "{:?}", sky.events);
    }
    let report = plan.judge(&sky);
    assert!(report.passes(), "{report:#?}");
    // One that hardly lives is given up all the same.
    let sky = slowed(&plan, 1);
    for (index, id) in ["alpha", "bravo"].into_iter().enumerate() {
        assert!(matches!(sky.end(index), End::Failed(_)), "{:?}", sky.events);
        assert!(sky.says(id, "has not ended its flight"), "{:?}", sky.events);
    }
}

#[test]
fn positions_over_a_link_that_gets_slower_are_of_the_time_at_which_they_were_measured() {
    let plan = two();
    let mut sky = sky_of(&plan);
    let mut waiting = VecDeque::new();
    sky.down = Some(Box::new(move |now, from, message| {
        // Vehicle 1 is heard later and later, up to 4 s, and on.
        let late_ms = 4000.min(now.0.saturating_sub(20_000) / 5);
        if from.system != 1 {
            return vec![(from, message)];
        }
        waiting.push_back((now + late_ms, from, message));
        let due = waiting.partition_point(|(at, ..)| *at <= now);
        waiting
            .drain(..due)
            .map(|(_, from, message)| (from, message))
            .collect()
    }));
    sky.fly_to(90.0);
    for (vehicle, flown) in sky.fleet.flown() {
        let since_boot_s = |fix: &Fix| f64::from(fix.boot_ms.unwrap_or(0)) / 1000.0 - fix.t_s;
        let first_s = since_boot_s(&flown.fixes[0]);
        let off_s = flown.fixes.iter().map(|fix| since_boot_s(fix) - first_s);
        let max_s = off_s.fold(0.0, |most: f64, off_s| most.max(off_s.abs()));
        assert!(max_s < 0.1, "{vehicle}: {max_s} s");
        assert!(flown.fixes.len() > 300, "{vehicle}: {}", flown.fixes.len());
    }
}
