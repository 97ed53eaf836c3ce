//! A record of a flight that was not flown as planned does not pass: one honest flight, doctored.
#![allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss
)]

use crate::support;
use crate::support::doctored;
use doctored::{failed, flown, moved, says, told};
use sortie::flight::*;
use sortie::geodesy::{Amsl, LatLon};
use sortie::verify::{Flown, Limit};
use support::place;

/// The record as `fly` writes it.
fn lines() -> Vec<String> {
    let (_, record, events) = told();
    let mut lines = vec![Line::Head {
        sortie: "0".to_owned(),
        spec_sha256: "0".to_owned(),
        speedup: 1.0,
        vehicles: record.flights.iter().map(|f| f.vehicle.clone()).collect(),
    }];
    for flight in &record.flights {
        lines.push(Line::of_plan(&flight.vehicle, 0.0, &flight.plans[0]));
    }
    lines.push(Line::Start { t0_unix_s: 1 });
    for flight in &record.flights {
        let fixes = flight.flown.fixes.iter();
        lines.extend(fixes.map(|fix| Line::of_fix(&flight.vehicle, fix)));
    }
    lines.extend(events.iter().map(Line::of_event));
    for flight in &record.flights {
        lines.push(Line::of_end(&flight.vehicle, &flight.flown));
    }
    let text = lines.iter().map(serde_json::to_string);
    text.map(|line| line.expect("JSON")).collect()
}

fn read(lines: &[String]) -> Result<Record, Broken> {
    read_record(&lines.join("\n"), flown().0.world.frame)
}

/// Why a record is none.
fn refusal(lines: &[String]) -> String {
    read(lines).expect_err("a broken record").to_string()
}

#[test]
fn an_honest_record_passes_and_every_proof_is_among_its_margins() {
    let (plan, record) = flown();
    assert_eq!(failed(|_| {}), Vec::new());
    let report = judge(&plan.spec, &plan.world, record);
    let again = read(&lines()).expect("a record");
    let again = judge(&plan.spec, &plan.world, &again);
    assert!(report.passes() && again.passes(), "{again:#?}");
    let ends: Vec<&str> = report.vehicles.iter().map(|v| v.end.as_str()).collect();
    assert_eq!(ends, ["landed", "landed", "loiters"]);
    let of = |what: &str| {
        report
            .margins
            .iter()
            .filter(|m| m.limit.to_string() == what)
            .count()
    };
    for what in [
        "first position from home",
        "speed between two positions",
        "cross-track error",
        "altitude error",
        "waypoints missed",
        "nearest to its goal",
        "last position from the planned end",
        "ground speed held",
        "ground covered by its own speed",
        "climb rate held",
        "descent rate held",
    ] {
        assert_eq!(of(what), 3, "{what}");
    }
}

#[test]
fn who_never_left_home_has_not_landed_at_the_end_of_its_plan() {
    // Alpha's landing is elsewhere; bravo's is where it stands all the time.
    for index in [0, 1] {
        let bad = failed(|record| {
            let fixes = &mut record.flights[index].flown.fixes;
            let home = fixes[0];
            for fix in fixes {
                (fix.place, fix.amsl) = (home.place, home.amsl);
            }
        });
        let vehicle = ["alpha", "bravo"][index];
        assert!(says(&bad, vehicle, "nearest to its goal"), "{bad:?}");
        assert!(says(&bad, vehicle, "waypoints missed"), "{bad:?}");
        let away = says(&bad, vehicle, "last position from the planned end");
        assert_eq!(away, index == 0, "{bad:?}");
    }
}

#[test]
fn who_landed_short_of_the_planned_end_has_not_landed_there_whatever_the_record_says() {
    let bad = failed(|record| {
        let fixes = &mut record.flights[0].flown.fixes;
        fixes.truncate(fixes.len() / 2);
        // It comes down with 2 m/s where it is.
        let mut last = *fixes.last().expect("positions");
        while last.amsl.0 > 400.0 {
            last.t_s += 1.0;
            last.amsl = Amsl((last.amsl.0 - 2.0).max(400.0));
            fixes.push(last);
        }
    });
    assert!(says(&bad, "alpha", "last position from the planned end"));
    assert!(says(&bad, "alpha", "waypoints missed"), "{bad:?}");
}

#[test]
fn who_is_still_in_the_air_over_its_landing_has_not_landed() {
    let bad = failed(|record| {
        let fixes = &mut record.flights[0].flown.fixes;
        fixes.retain(|fix| fix.t_s < 30.0 || fix.amsl.0 > 415.0);
    });
    let what = "last position from the ground";
    assert!(says(&bad, "alpha", what), "{bad:?}");
}

#[test]
fn who_leaves_waypoints_out_has_not_flown_its_plan() {
    let bad = failed(|record| {
        // Bravo turns back half way to its goal.
        let fixes = &mut record.flights[1].flown.fixes;
        let goal = place(36.310, -84.248);
        fixes.retain(|fix| fix.place.chord_m(goal) > 600.0);
        for (n, fix) in fixes.iter_mut().enumerate() {
            fix.t_s = 0.2 * n as f64;
        }
    });
    assert!(says(&bad, "bravo", "waypoints missed"), "{bad:?}");
    assert!(says(&bad, "bravo", "nearest to its goal"), "{bad:?}");
    assert!(bad.iter().all(|(vehicle, _)| vehicle == "bravo"), "{bad:?}");
}

#[test]
fn who_goes_on_from_its_place_in_the_air_does_not_stay_there() {
    let bad = failed(|record| {
        let fixes = &mut record.flights[2].flown.fixes;
        fixes.last_mut().expect("positions").speed_mps = 12.0;
    });
    assert!(says(&bad, "charlie", "last speed"), "{bad:?}");
    let bad = failed(|record| {
        // It has come there, and stays while others fly.
        let fixes = &mut record.flights[2].flown.fixes;
        let end = fixes.last().expect("positions").place;
        let there = fixes.iter().position(|fix| fix.place.chord_m(end) < 20.0);
        fixes.truncate(there.expect("it comes there"));
    });
    assert!(says(&bad, "charlie", "last position from the planned end"));
}

#[test]
fn time_without_a_position_counts_from_the_departure_on() {
    let bad = failed(|record| {
        record.flights[0].flown.fixes.retain(|fix| fix.t_s > 40.0);
    });
    assert!(says(&bad, "alpha", "longest time without a position"));
    assert!(says(&bad, "alpha", "first position from home"), "{bad:?}");
    // With the times of all others it began in the air.
    let bad = failed(|record| {
        let fixes = &mut record.flights[0].flown.fixes;
        fixes.retain(|fix| fix.t_s > 40.0);
        fixes.iter_mut().for_each(|fix| fix.t_s -= 40.0);
    });
    assert!(says(&bad, "alpha", "first position from home"), "{bad:?}");
}

#[test]
fn time_without_a_position_counts_to_the_end_that_was_told() {
    let bad = failed(|record| {
        let fixes = &mut record.flights[0].flown.fixes;
        // On the ground by then, or nearly.
        let seen = fixes.len() - 40;
        fixes.truncate(seen);
    });
    let what = "longest time without a position".to_owned();
    assert_eq!(bad, [("alpha".to_owned(), what)]);
    let untold = |line: String| match line.split_once(",\"t_s\":") {
        Some((begin, _)) if line.contains("\"end\":\"landed\"") => format!("{begin}}}"),
        _ => line,
    };
    let silent: Vec<String> = lines().into_iter().map(untold).collect();
    let (plan, _) = flown();
    let report = judge(&plan.spec, &plan.world, &read(&silent).expect("a record"));
    let bad = report.margins.iter().filter(|margin| !margin.ok);
    let bad: Vec<(&str, &Limit)> = bad.map(|m| (m.vehicle.as_str(), &m.limit)).collect();
    let what = &Limit::Flown(Flown::End);
    assert_eq!(bad, [("alpha", what), ("bravo", what)]);
}

#[test]
fn a_flight_without_any_position_or_any_plan_fails() {
    let bad = failed(|record| record.flights[0].flown.fixes.clear());
    assert!(says(&bad, "alpha", "flight"), "{bad:?}");
    let (plan, record) = flown();
    let mut record = record.clone();
    record.flights[0].plans.clear();
    let report = judge(&plan.spec, &plan.world, &record);
    assert!(!report.passes() && !report.vehicles[0].ended_as_planned);
}

#[test]
fn a_flight_beside_or_over_its_way_is_not_the_one_that_was_verified() {
    let (_, record) = flown();
    let times = record.flights[0].flown.fixes.iter().map(|fix| fix.t_s);
    let (begin_s, end_s) = times.fold((f64::MAX, 0.0), |(a, b): (f64, f64), t| {
        (a.min(t), b.max(t))
    });
    // Away from the others, out and back slowly enough; nothing of the spec forbids it.
    let bulge = |t_s: f64, max_m: f64| {
        let share = (t_s - begin_s) / (end_s - begin_s);
        max_m * (std::f64::consts::PI * share).sin()
    };
    let aside = |north_m: f64, up_m: f64| {
        failed(|record| {
            for fix in &mut record.flights[0].flown.fixes {
                *fix = moved(fix, bulge(fix.t_s, north_m), bulge(fix.t_s, up_m));
            }
        })
    };
    let bad = aside(-200.0, 0.0);
    assert!(says(&bad, "alpha", "cross-track error"), "{bad:?}");
    let bad = aside(0.0, 60.0);
    let what = "altitude error";
    assert!(says(&bad, "alpha", what), "{bad:?}");
    // A few metres are what positions are off, and corners cut.
    assert_eq!(aside(-8.0, 5.0), Vec::new());
}

#[test]
fn who_is_told_to_hold_is_not_off_its_way_and_fails_by_its_end() {
    let bad = failed(|record| {
        let flown = &mut record.flights[0].flown;
        flown.end = End::Held;
        for fix in &mut flown.fixes[300..] {
            *fix = moved(fix, -200.0, 0.0);
        }
    });
    assert!(!says(&bad, "alpha", "cross-track error"), "{bad:?}");
}

#[test]
fn altitudes_of_another_reference_do_not_pass() {
    let bad = failed(|record| {
        for fix in &mut record.flights[0].flown.fixes {
            *fix = moved(fix, 0.0, 40.0);
        }
    });
    for what in [
        "first position from home",
        "altitude error",
        "last position from the ground",
    ] {
        assert!(says(&bad, "alpha", what), "{what}: {bad:?}");
    }
}

#[test]
fn nobody_is_somewhere_else_at_once() {
    let bad = failed(|record| {
        let fixes = &mut record.flights[0].flown.fixes;
        // A part of its way is left out, and the time for it.
        let (from, to) = (fixes.len() / 3, fixes.len() / 2);
        let gone_s = fixes[to].t_s - fixes[from].t_s;
        fixes.drain(from + 1..=to);
        for fix in &mut fixes[from + 1..] {
            fix.t_s -= gone_s - 0.2;
        }
    });
    let what = "speed between two positions";
    assert!(says(&bad, "alpha", what), "{bad:?}");
}

#[test]
fn a_step_between_the_clocks_of_fleet_and_vehicle_is_no_speed() {
    let step = |speedup: f64, own_s: f64| {
        failed(|record| {
            record.speedup = speedup;
            let fixes = &mut record.flights[0].flown.fixes;
            for fix in fixes.iter_mut() {
                fix.boot_ms = Some(1000 + (fix.t_s * 1000.0) as u32);
            }
            let from = fixes.len() / 3;
            let gone_s = |fixes: &[Fix], to: usize| fixes[to].t_s - fixes[from].t_s;
            let to = (from..fixes.len()).find(|&to| gone_s(fixes, to) >= own_s);
            let to = to.expect("a later position");
            let stepped_s = gone_s(fixes, to) - 0.1;
            fixes.drain(from + 1..to);
            for fix in &mut fixes[from + 1..] {
                fix.t_s -= stepped_s;
            }
        })
    };
    let what = "speed between two positions";
    let bad = step(20.0, 3.0);
    assert!(!says(&bad, "alpha", what), "{bad:?}");
    // A clock that is off by more than machines stall is no excuse.
    assert!(says(&step(20.0, 60.0), "alpha", what));
    assert!(says(&step(1.0, 3.0), "alpha", what));
}

#[test]
fn a_vehicle_that_flew_in_the_place_of_another_has_not_flown_its_own_mission() {
    let bad = failed(|record| {
        let [first, second, _] = &mut record.flights[..] else {
            panic!("three");
        };
        std::mem::swap(&mut first.vehicle, &mut second.vehicle);
    });
    for vehicle in ["alpha", "bravo"] {
        assert!(says(&bad, vehicle, "nearest to its goal"), "{bad:?}");
        assert!(says(&bad, vehicle, "first position from home"), "{bad:?}");
    }
}

#[test]
fn what_can_be_told_once_and_is_told_again_is_no_record() {
    let lines = lines();
    let with = |index: usize, line: &str| {
        let mut all = lines.clone();
        all.insert(index, line.to_owned());
        refusal(&all)
    };
    let count = lines.len();
    let left = "{\"vehicle\": \"alpha\", \"end\": \"left flying\"}";
    // Whichever of the two ends comes first.
    assert!(with(count, left).ends_with("comes after the end of alpha"));
    let both = with(count - 3, left);
    let at = format!("line {}: comes after the end of alpha", count - 1);
    assert_eq!(both, at);
    assert!(with(count, &lines[0]).ends_with("the header was recorded before"));
    assert!(with(count - 3, "{\"t0_unix_s\": 5}").ends_with("T0 was recorded before"));
}

#[test]
fn a_position_that_is_none_on_earth_does_not_spoil_its_record() {
    let mut lines = lines();
    let first = lines.iter().position(|line| line.contains("lat_deg"));
    let at = 20 + first.expect("positions");
    let latitude = |line: &str| line.split_once("\"lat_deg\":").map(|of| of.1.to_owned());
    let tail = latitude(&lines[at]).expect("a position");
    let number = tail.split(',').next().expect("a number");
    let honest = read(&lines).expect("a record");
    lines[at] = lines[at].replace(number, "90.0000001");
    let spoilt = read(&lines).expect("still a record");
    let fixes = |record: &Record| record.flights[0].flown.fixes.len();
    assert_eq!(fixes(&spoilt) + 1, fixes(&honest));
    let plan = &flown().0;
    assert!(judge(&plan.spec, &plan.world, &spoilt).passes());
}

#[test]
fn what_cannot_be_in_a_record_is_refused_with_its_line() {
    let lines = lines();
    let position = |vehicle: &str, t_s: f64| {
        format!(
            "{{\"t_s\": {t_s}, \"vehicle\": \"{vehicle}\", \"lat_deg\": 36.3, \"lon_deg\": -84.26, \
             \"amsl_m\": 400, \"speed_mps\": 0, \"item\": 1}}"
        )
    };
    let with = |index: usize, line: String| {
        let mut all = lines.clone();
        all.insert(index, line);
        refusal(&all)
    };
    let count = lines.len();
    assert!(with(count, position("alpha", 1e4)).ends_with("comes after the end of alpha"));
    assert!(with(5, position("alpha", -1.0)).ends_with("line 6: -1 s is before T0"));
    assert!(with(9, position("alpha", 0.0)).contains("not later than the line before"));
    let stranger = with(5, position("delta", 1.0));
    assert!(stranger.contains("delta is none of the vehicles of the first line"));
    let plan = "{\"t_s\": 0, \"vehicle\": \"alpha\", \"plan\": {\"items\": 3, \"end_s\": 9, \
                \"lands\": true, \"waypoints\": []}}";
    assert!(with(5, plan.to_owned()).contains("from one place to another"));
    let why = with(5, "{\"vehicle\": \"alpha\", \"lat_deg\": 36.3}".to_owned());
    let wanted = "line 6: is no line of a flight record: a position, but missing field";
    assert!(why.starts_with(wanted), "{why}");
    // Only a last line may be cut off, and then it says nothing.
    let mut cut = lines.clone();
    let end = cut.pop().expect("an end");
    cut.push(end[..end.len() / 2].to_owned());
    assert_eq!(
        read(&cut).expect("a record").flights[2].flown.end,
        End::NotFlown
    );
    cut.push(String::from("{}"));
    assert!(refusal(&cut).contains("it is not JSON"));
}

#[test]
fn who_says_all_the_time_that_it_takes_off_is_held_to_its_minimum_height_all_the_same() {
    let bad = failed(|record| {
        let fixes = &mut record.flights[0].flown.fixes;
        let home = fixes[0].place;
        let ends = fixes.last().expect("positions").place;
        for fix in fixes {
            fix.item = 1;
            let columns = fix.place.chord_m(home).min(fix.place.chord_m(ends));
            if columns > 60.0 {
                fix.amsl = Amsl(fix.amsl.0.min(420.0));
            }
        }
    });
    assert!(says(&bad, "alpha", "terrain clearance"), "{bad:?}");
}

#[test]
fn a_plan_that_was_given_in_flight_ends_where_the_spec_does() {
    // As if alpha had been led somewhere else from where its plan ends.
    let bad = failed(|record| {
        let flight = &mut record.flights[0];
        let fixes = &mut flight.flown.fixes;
        let lands = flight.plans[0].items;
        let over = fixes.iter().position(|fix| fix.item == lands);
        fixes.truncate(over.expect("it lands"));
        let mut last = *fixes.last().expect("positions");
        let mut second = flight.plans[0].clone();
        second.items += 1;
        let ways = &mut second.reference.waypoints;
        let [over, end] = ways[ways.len() - 2..] else {
            panic!("a way to the landing");
        };
        *ways = vec![over, over, end];
        for (item, way) in (1..).zip(ways.iter_mut()) {
            way.item = item;
            way.point.at.north_m -= if item > 1 { 120.0 } else { 0.0 };
        }
        last.items = second.items;
        for item in [2; 60] {
            last = moved(&last, -2.0, 0.0);
            (last.t_s, last.item, last.speed_mps) = (last.t_s + 0.5, item, 4.0);
            fixes.push(last);
        }
        while last.amsl.0 > 400.0 {
            last = moved(&last, 0.0, -1.0);
            (last.t_s, last.item) = (last.t_s + 1.0, 3);
            fixes.push(last);
        }
        flight.plans.push(second);
    });
    let what = "last position from where the spec ends";
    assert_eq!(bad, [("alpha".to_owned(), what.to_owned())]);
}

/// What a vehicle has before it at a position becomes a plan of its own, which counts its items
/// from 1 again, as that of a PX4 vehicle that is led onto a new path.
fn begin_again(flight: &mut Flight, from: usize) {
    let first = flight.flown.fixes[from];
    let mut plan = flight.plans[flight.plans.len() - 1].clone();
    let left_out = first.item - 1;
    plan.items += 1;
    let ways = &mut plan.reference.waypoints;
    let at = ways.iter().position(|way| way.item >= first.item);
    ways.drain(..at.expect("a way ahead") - 1);
    for (number, way) in ways.iter_mut().enumerate() {
        way.item = way
            .item
            .saturating_sub(left_out)
            .max(usize::from(number > 0));
    }
    for fix in &mut flight.flown.fixes[from..] {
        (fix.item, fix.items) = (fix.item - left_out, plan.items);
    }
    for (item, t_s) in &mut flight.flown.reached {
        if *t_s > first.t_s {
            *item -= left_out;
        }
    }
    flight.plans.push(plan);
}

#[test]
fn items_of_a_plan_given_in_flight_are_not_those_of_the_same_number_before() {
    let (plan, record) = flown();
    let mut record = record.clone();
    let lateness = |record: &Record| -> Vec<f64> {
        let report = judge(&plan.spec, &plan.world, record);
        let late = report.vehicles[0].passages.iter().map(Passage::late_s);
        late.collect()
    };
    let before = lateness(&record);
    let flight = &mut record.flights[0];
    let fixes = flight.flown.fixes.len();
    for from in [fixes / 2, 2 * fixes / 3] {
        begin_again(flight, from);
    }
    let after = lateness(&record);
    assert_eq!(before.len(), after.len(), "{before:?}\n{after:?}");
    for (before, after) in before.iter().zip(&after) {
        assert!((before - after).abs() < 1.0, "{before} {after}");
    }
}

#[test]
fn a_flight_that_fly_would_have_given_up_does_not_pass() {
    let bad = failed(|record| {
        for flight in &mut record.flights {
            let fixes = &mut flight.flown.fixes;
            let mut last = *fixes.last().expect("positions");
            for _ in 0..1000 {
                last.t_s += 0.5;
                fixes.push(last);
            }
            flight.flown.until_s = Some(last.t_s);
        }
    });
    let what = "end of the flight".to_owned();
    let all = ["alpha", "bravo", "charlie"].map(|id| (id.to_owned(), what.clone()));
    assert_eq!(bad, all);
}

#[test]
fn a_threat_between_two_positions_is_met() {
    let (plan, record) = flown();
    let fixes = &record.flights[0].flown.fixes;
    let middle = fixes.len() / 2;
    let (from, to) = (fixes[middle].place, fixes[middle + 1].place);
    let between = LatLon::new(
        0.5 * (from.lat_deg + to.lat_deg),
        0.5 * (from.lon_deg + to.lon_deg),
    );
    let radius_m = 0.25 * from.chord_m(to);
    let mut record = record.clone();
    record.popups = vec![PopUp {
        from_s: fixes[middle].t_s - 10.0,
        threat: sortie::spec::Threat {
            id: "pole".to_owned(),
            kind: "popup".to_owned(),
            place: between.expect("a place"),
            radius_m,
        },
    }];
    let report = judge(&plan.spec, &plan.world, &record);
    let mut bad = report.margins.iter().filter(|margin| !margin.ok);
    let met = bad.next().expect("the pole is met");
    assert_eq!(
        (met.vehicle.as_str(), &met.limit),
        ("alpha", &Limit::Threat("pole".to_owned()))
    );
    assert!(met.value < -0.9 * radius_m, "{met:?}");
}
