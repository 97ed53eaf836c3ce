//! Parameters as vehicles answer.

use super::*;
use crate::autopilot::Judged;
use crate::mission::Parameter;

fn planned_as(planned: &[Parameter]) -> Vec<Assumed<'_>> {
    planned.iter().map(Assumed::Planned).collect()
}

/// Whether a value of the vehicle is as good as the planned one.
fn suffices(name: &str, held: f32, value: f32) -> bool {
    let planned = Parameter {
        name: name.to_owned(),
        value,
        why: String::new(),
    };
    Assumed::Planned(&planned).suffices(name, held)
}

/// Checks a vehicle that answers by name, and by the value that is set if one is; none where it does
/// not know the name. The differences, and when all were read.
fn checked(
    planned: &[(&str, f32)],
    set: bool,
    answer: impl FnMut(&str, Option<f32>) -> Option<f32>,
) -> (Vec<String>, Time) {
    let (differences, _, until) = checked_and_set(planned, set, answer);
    (differences, until)
}

/// The same, and between both what is said to be set.
fn checked_and_set(
    planned: &[(&str, f32)],
    set: bool,
    mut answer: impl FnMut(&str, Option<f32>) -> Option<f32>,
) -> (Vec<String>, Option<String>, Time) {
    let planned: Vec<Parameter> = (planned.iter())
        .map(|(name, value)| Parameter {
            name: (*name).to_owned(),
            value: *value,
            why: String::new(),
        })
        .collect();
    let mut now = Time(0);
    let mut check = SettingsCheck::of(planned_as(&planned), set, false, now);
    let target = Address {
        system: 1,
        component: 1,
    };
    while check.outcome().is_none() {
        let asked = match check.poll(now, target) {
            Some(Message::Flight(FlightMessage::ParamRead { name, .. })) => Some((name, None)),
            Some(Message::Flight(FlightMessage::ParamSet { name, value, .. })) => {
                Some((name, Some(value.value(false))))
            }
            _ => None,
        };
        let answered = asked.and_then(|(name, value)| Some((answer(&name, value)?, name)));
        if let Some((held, name)) = answered {
            check.heard(now, &name, ParamValue::float(held));
        }
        now = now + REPEAT_MS;
    }
    let differences = check.outcome().unwrap_or_default().to_vec();
    (differences, check.was_set(), now)
}

/// The differences that a vehicle is found to have which knows these names alone.
fn differences(known: &[&str]) -> Vec<String> {
    let planned = ["ALT_SLOPE_MIN", "GLIDE_SLOPE_MIN", "WP_RADIUS"].map(|name| (name, 1.0));
    checked(&planned, false, |name, _| {
        known.contains(&name).then_some(1.0)
    })
    .0
}

#[test]
fn a_parameter_that_goes_back_after_it_was_set_is_a_difference() {
    let planned = [("MPC_Z_V_AUTO_UP", 4.0), ("MPC_Z_VEL_MAX_UP", 4.0)];
    let outcome = |planned: &[(&str, f32)]| {
        // As PX4 does it: a speed that was set is limited when the next message comes.
        let (mut speed, mut greatest) = (3.0, 3.0);
        let answer = |name: &str, set: Option<f32>| {
            speed = f32::min(speed, greatest);
            let held = match name {
                "MPC_Z_V_AUTO_UP" => &mut speed,
                _ => &mut greatest,
            };
            *held = set.unwrap_or(*held);
            Some(*held)
        };
        checked(planned, true, answer).0
    };
    let found = outcome(&planned);
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].contains("MPC_Z_V_AUTO_UP is 3"), "{found:?}");
    let in_order = [planned[1], planned[0]];
    assert!(outcome(&in_order).is_empty());
}

#[test]
fn a_parameter_that_is_not_taken_is_not_said_to_be_set() {
    let planned = [("WPNAV_RADIUS", 500.0)];
    let (found, set, _) = checked_and_set(&planned, true, |_, _| Some(1000.0));
    assert_eq!(found, ["parameter WPNAV_RADIUS does not take 500"]);
    assert_eq!(set, None);
    let mut held = 1000.0;
    let (found, set, _) = checked_and_set(&planned, true, |_, set| {
        held = set.unwrap_or(held);
        Some(held)
    });
    assert!(found.is_empty() && set.is_some_and(|set| set.ends_with("from 1000 to 500")));
}

#[test]
fn a_vehicle_that_may_lean_further_than_the_plan_needs_is_as_good() {
    assert!(suffices("ANGLE_MAX", 4500.0, 3000.0) && suffices("MPC_TILTMAX_AIR", 50.0, 45.0));
    assert!(!suffices("ANGLE_MAX", 2000.0, 3000.0));
    assert!(!suffices("WPNAV_SPEED", 1100.0, 1000.0));
}

#[test]
fn a_value_that_is_no_number_is_as_planned_of_nothing() {
    for held in [f32::INFINITY, f32::NEG_INFINITY, f32::NAN] {
        for name in ["WPNAV_SPEED", "ANGLE_MAX", "FENCE_ENABLE"] {
            assert!(!suffices(name, held, 1000.0), "{name} {held}");
        }
        let found = checked(&[("RTL_ALT", 4000.0)], false, |_, _| Some(held)).0;
        assert_eq!(found.len(), 1, "{found:?}");
    }
}

#[test]
fn a_parameter_that_is_said_to_be_another_one_after_it_was_read_is_named_until_it_is_as_planned() {
    let planned = [("WPNAV_SPEED", 1000.0), ("RTL_ALT", 10_600.0)];
    let planned: Vec<Parameter> = (planned.iter())
        .map(|(name, value)| Parameter {
            name: (*name).to_owned(),
            value: *value,
            why: String::new(),
        })
        .collect();
    let mut check = SettingsCheck::of(planned_as(&planned), false, false, Time(0));
    let says = |check: &mut SettingsCheck<'_>, ms, name: &str, value: f32| {
        check.heard(Time(ms), name, ParamValue::float(value));
        let others = check.others(Time(ms), 0);
        others
            .iter()
            .map(ParameterMismatch::words)
            .collect::<Vec<_>>()
    };
    // Not read yet, and of no concern.
    assert!(says(&mut check, 0, "RTL_ALT", 1500.0).is_empty());
    assert!(says(&mut check, 0, "WPNAV_SPEED", 1000.0).is_empty());
    // Read, while another one is at work.
    let speed = says(&mut check, 10, "WPNAV_SPEED", 500.0);
    assert_eq!(speed, ["WPNAV_SPEED is 500, planned 1000"]);
    assert!(says(&mut check, 20, "WPNAV_SPEED", 1000.0).is_empty());
    assert!(says(&mut check, 30, "RTL_ALT", 10_600.0).is_empty());
    assert!(check.outcome().is_some_and(<[String]>::is_empty));
    assert_eq!(check.other_of_return(), None);
    let height = says(&mut check, 100, "RTL_ALT_M", 15.0);
    assert_eq!(height, ["RTL_ALT_M is 15, planned 106"]);
    assert!(check.other_of_return().is_some());
    assert!(check.others(Time(1000), 1000).is_empty());
    assert_eq!(check.others(Time(1100), 1000).len(), 1);
    let target = Address {
        system: 1,
        component: 1,
    };
    let asked = (0..100).filter_map(|n| check.poll(Time(100 + 100 * n), target));
    assert_eq!(asked.count(), usize::from(READ_AGAIN));
    assert!(says(&mut check, 9000, "RTL_ALT_M", 106.0).is_empty());
    assert_eq!(check.other_of_return(), None);
}

#[test]
fn a_difference_that_is_flown_all_the_same_is_no_news_and_may_be_one_of_the_return() {
    let planned = [Parameter {
        name: "RTL_ALT".to_owned(),
        value: 4000.0,
        why: String::new(),
    }];
    let mut check = SettingsCheck::of(planned_as(&planned), false, false, Time(0));
    check.heard(Time(0), "RTL_ALT", ParamValue::float(1500.0));
    assert_eq!(check.outcome().map(<[String]>::len), Some(1));
    check.heard(Time(10), "RTL_ALT", ParamValue::float(1500.0));
    assert!(check.others(Time(10), 0).is_empty());
    let of_return = check.other_of_return().map(ParameterMismatch::words);
    assert_eq!(of_return.as_deref(), Some("RTL_ALT is 1500, planned 4000"));
    check.heard(Time(20), "RTL_ALT", ParamValue::float(2000.0));
    assert_eq!(check.others(Time(20), 0).len(), 1);
}

/// A vehicle of ArduCopter 4.7, with these of its parameters: what differs, and what is set.
fn of_4_7(own: &[(&str, f32)], set: bool) -> (Vec<String>, Vec<(String, f32)>, Time) {
    let planned = [
        ("WPNAV_SPEED", 1200.0),
        ("RTL_ALT", 4000.0),
        ("WPNAV_RADIUS", 500.0),
    ];
    let mut own = own.to_vec();
    let mut sets = Vec::new();
    let (differences, until) = checked(&planned, set, |name, value| {
        let held = own.iter_mut().find(|(known, _)| *known == name);
        if let Some(value) = value {
            sets.push((name.to_owned(), value));
            held?.1 = value;
            return Some(value);
        }
        held.map(|(_, value)| *value)
    });
    (differences, sets, until)
}

#[test]
fn parameters_of_arducopter_4_7_are_compared_and_set_under_its_names_in_metres() {
    let as_planned = [("WP_SPD", 12.0), ("RTL_ALT_M", 40.0), ("WP_RADIUS_M", 5.0)];
    let (differences, _, until) = of_4_7(&as_planned, false);
    assert!(differences.is_empty(), "{differences:?}");
    // The second name is asked for after one turn, not after all.
    assert!(until <= Time(8 * REPEAT_MS), "{until:?}");
    let stock = [("WP_SPD", 10.0), ("RTL_ALT_M", 15.0), ("WP_RADIUS_M", 5.0)];
    let (differences, _, _) = of_4_7(&stock, false);
    assert_eq!(differences.len(), 2, "{differences:?}");
    assert!(differences[0].contains("WP_SPD is 10, the verdict assumes 12"));
    let (differences, sets, _) = of_4_7(&stock, true);
    assert!(differences.is_empty(), "{differences:?}");
    let expected = [("WP_SPD".to_owned(), 12.0), ("RTL_ALT_M".to_owned(), 40.0)];
    assert_eq!(sets, expected);
    let (differences, _, _) = of_4_7(&stock[..1], false);
    assert!(
        differences
            .iter()
            .any(|text| text.contains("RTL_ALT is not known"))
    );
}

#[test]
fn a_parameter_with_two_names_is_found_under_either() {
    assert!(differences(&["ALT_SLOPE_MIN", "WP_RADIUS"]).is_empty());
    assert!(differences(&["GLIDE_SLOPE_MIN", "WP_RADIUS"]).is_empty());
    let neither = differences(&["WP_RADIUS"]);
    assert_eq!(neither.len(), 1, "{neither:?}");
    assert!(neither[0].contains("GLIDE_SLOPE_MIN is not known"));
    assert_eq!(differences(&["ALT_SLOPE_MIN", "GLIDE_SLOPE_MIN"]).len(), 1);
}

#[test]
fn parameters_are_requested_ahead_once_and_come_in_any_order() {
    let planned: Vec<Parameter> = (0_u8..12)
        .map(|number| Parameter {
            name: format!("P{number}"),
            value: f32::from(number),
            why: String::new(),
        })
        .collect();
    let target = Address {
        system: 1,
        component: 1,
    };
    let mut check = SettingsCheck::of(planned_as(&planned), false, false, Time(0));
    assert!(check.poll(Time(0), target).is_some());
    assert_eq!(check.poll_ahead(target).len(), AHEAD - 1);
    assert!(check.poll_ahead(target).is_empty());
    for number in (0..u8::try_from(AHEAD).expect("a few")).rev() {
        // One of them has another value.
        let held = if number == 3 { 7.0 } else { f32::from(number) };
        check.heard(Time(1), &format!("P{number}"), ParamValue::float(held));
    }
    assert_eq!(check.at, AHEAD);
    assert_eq!(check.poll_ahead(target).len(), 12 - AHEAD - 1);
    for number in u8::try_from(AHEAD).expect("a few")..12 {
        let held = f32::from(number);
        check.heard(Time(2), &format!("P{number}"), ParamValue::float(held));
    }
    let differences = check.outcome().expect("all are read");
    assert_eq!(differences.len(), 1, "{differences:?}");
    assert!(differences[0].contains("P3 is 7"), "{differences:?}");
}

/// Parameters with which the verdict knows how a plane is flown, of a vehicle that has these: what differs, and when
/// all were read.
fn judged(own: &[(&str, f32)]) -> (Vec<String>, Time) {
    let assumed = vec![
        Assumed::Judged("FLIGHT_OPTIONS", Judged::Without(1 << 14)),
        Assumed::Judged("MIN_GROUNDSPEED", Judged::Is(0)),
        Assumed::Judged("SOAR_ENABLE", Judged::Is(0)),
        Assumed::Judged("OTHER", Judged::Is(0)),
    ];
    let mut check = SettingsCheck::of(assumed, false, false, Time(0));
    let target = Address {
        system: 1,
        component: 1,
    };
    let mut now = Time(0);
    while check.outcome().is_none() {
        let mut requests: Vec<Message> = check.poll(now, target).into_iter().collect();
        requests.extend(check.poll_ahead(target));
        for request in requests {
            let Message::Flight(FlightMessage::ParamRead { name, .. }) = request else {
                panic!("nothing is set: {request:?}");
            };
            if let Some((_, value)) = own.iter().find(|(known, _)| *known == name) {
                check.heard(now, &name, ParamValue::float(*value));
            }
        }
        now = now + REPEAT_MS;
    }
    (check.outcome().unwrap_or_default().to_vec(), now)
}

#[test]
fn a_vehicle_with_a_parameter_that_the_verdict_does_not_judge_differs_and_one_without_it_does_not()
{
    let stock = [("FLIGHT_OPTIONS", 8.0), ("MIN_GROUNDSPEED", 0.0)];
    assert_eq!(judged(&stock).0, [""; 0]);
    for (name, value, words) in [
        ("MIN_GROUNDSPEED", 22.0, "MIN_GROUNDSPEED is 22 (judged: 0)"),
        ("MIN_GNDSPD_CM", 610.0, "MIN_GNDSPD_CM is 610 (judged: 0)"),
        ("SOAR_ENABLE", 6.1, "SOAR_ENABLE is 6.1 (judged: 0)"),
        (
            "FLIGHT_OPTIONS",
            16384.0,
            "FLIGHT_OPTIONS is 16384 (judged: without the bits of 16384)",
        ),
    ] {
        let found = judged(&[(name, value)]).0;
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].contains(words), "{found:?}");
    }
    // Those that are missing are waited for at once, not one after the other.
    let until = judged(&[]).1;
    assert!(until <= Time((u64::from(MAX) + 1) * REPEAT_MS), "{until:?}");
}

#[test]
fn a_judged_parameter_that_is_set_after_it_was_read_is_named() {
    let assumed = vec![Assumed::Judged("SOAR_ENABLE", Judged::Is(0))];
    let mut check = SettingsCheck::of(assumed, false, false, Time(0));
    check.heard(Time(0), "SOAR_ENABLE", ParamValue::float(0.0));
    assert_eq!(check.outcome().map(<[String]>::len), Some(0));
    check.heard(Time(10), "SOAR_ENABLE", ParamValue::float(1.0));
    let others = check.others(Time(10), 0);
    assert_eq!(others[0].words(), "SOAR_ENABLE is 1, judged: 0");
    let why = "it says that SOAR_ENABLE is 1 (judged: 0), after it was checked";
    assert_eq!(others[0].changed(), why);
}
