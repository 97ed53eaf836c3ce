//! Speeds that no copter of an autopilot is known to fly.

use super::*;

/// The full spec in version 2, under the operational objective.
fn second() -> String {
    with("sortie: 1", "sortie: 2")
        .replace("  objective: paper\n", "")
        .replace("    max_airspeed_mps: 20\n", "")
}

#[test]
fn a_copter_faster_than_its_autopilot_is_known_to_fly_is_an_error_that_names_the_most() {
    let text = second();
    let found = issues(&text);
    let paths: Vec<&str> = found.iter().map(|issue| issue.path.as_str()).collect();
    assert_eq!(paths, ["vehicles[0].speed_mps", "vehicles[1].speed_mps"]);
    assert_eq!(found[0].position, Some(place_of(&text, "15\n")));
    for (issue, most, reached) in [
        (&found[0], "at most 13.6 m/s", "9.5 m/s at 30 degrees"),
        (&found[1], "at most 10.7 m/s", "9.8 m/s at 45 degrees"),
    ] {
        for part in [most, reached, "max_airspeed_mps"] {
            assert!(issue.allowed.contains(part), "{part}: {issue:?}");
        }
    }
}

#[test]
fn what_a_copter_was_flown_at_is_its_own_limit() {
    let stated = |alpha: &str| {
        second()
            .replace(
                "speed_mps: 15",
                &format!("speed_mps: 15\n    max_airspeed_mps: {alpha}"),
            )
            .replace("speed_mps: 12", "speed_mps: 10")
    };
    assert_eq!(good(&stated("16")).vehicles[0].max_airspeed_mps, Some(16.0));
    let found = issues(&stated("14.5"));
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].path, "vehicles[0].speed_mps");
    assert!(
        found[0].allowed.contains("14.5 m/s: max_airspeed_mps"),
        "{found:?}"
    );
    // Specs of version 1 keep their meaning.
    assert_eq!(
        good(FULL).vehicles[0].speed_mps.to_bits(),
        15.0_f64.to_bits()
    );
}
