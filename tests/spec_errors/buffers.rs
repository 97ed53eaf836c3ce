//! Buffers: which a spec has, and points that satisfy a limit and not its buffer.

use sortie::spec::Buffers;

use super::*;

/// The full spec in version 2, under the operational objective.
fn second() -> String {
    with("sortie: 1", "sortie: 2")
        .replace("speed_mps: 15", "speed_mps: 13")
        .replace("  objective: paper\n", "")
}

#[test]
fn version_1_has_no_buffers_and_version_2_has_those_of_its_vehicles() {
    let first = good(FULL);
    assert_eq!(first.buffers, Buffers::NONE);
    assert_eq!(first.why_no_buffers(), Some("no buffers: sortie: 1"));
    let spec = good(&second());
    assert_eq!(
        (spec.buffers, spec.why_no_buffers()),
        (Buffers::even(10.0), None)
    );
    let paper = good(&with("sortie: 1", "sortie: 2").replace("speed_mps: 15", "speed_mps: 13"));
    assert_eq!(paper.buffers, Buffers::NONE);
    let given = second() + "buffer_m: {all: 12, zones: 30, separation: 0}\n";
    let expected = Buffers {
        zones_m: 30.0,
        separation_m: 0.0,
        ..Buffers::even(12.0)
    };
    assert_eq!(good(&given).buffers, expected);
}

#[test]
fn every_kind_of_vehicle_has_a_buffer_of_at_least_10_m() {
    for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
        for airframe in [Airframe::Copter, Airframe::Plane, Airframe::Vtol] {
            assert!(sortie::autopilot::facts(autopilot, airframe).buffer_m >= 10.0);
        }
    }
}

#[test]
fn buffers_where_there_are_none_are_an_error() {
    for (text, allowed) in [
        (FULL.to_owned(), "sortie migrate"),
        (
            with("sortie: 1", "sortie: 2").replace("speed_mps: 15", "speed_mps: 13"),
            "operational",
        ),
    ] {
        let text = text + "buffer_m: {all: 12}\n";
        let found = issues(&text);
        assert_eq!(
            (found.len(), found[0].path.as_str()),
            (1, "buffer_m"),
            "{found:?}"
        );
        assert_eq!(found[0].position, Some(place_of(&text, "{all: 12}")));
        if !text.contains("objective: paper") {
            assert!(found[0].allowed.contains(allowed), "{found:?}");
        }
    }
}

#[test]
fn a_place_inside_a_buffer_names_limit_buffer_and_the_largest_that_works() {
    // 7.1 m inside of the south edge of the area, and a goal 4 m outside of the rim of the radar.
    let text = second()
        .replace(
            "home: {lat: 36.21, lon: -84.39}",
            "home: {lat: 36.200066, lon: -84.39}",
        )
        .replace(
            "goal: {lat: 36.21, lon: -84.12, agl_m: 80}",
            "goal: {lat: 36.31, lon: -84.22655, agl_m: 80}",
        );
    let found = issues(&text);
    let paths: Vec<&str> = found.iter().map(|issue| issue.path.as_str()).collect();
    assert_eq!(
        paths,
        ["vehicles[0].home", "vehicles[1].goal"],
        "{found:#?}"
    );
    assert!(
        found[0]
            .found
            .contains("7.1 m inside of the edge of the area"),
        "{found:?}"
    );
    for part in ["at least 10 m", "buffer_m.area 10 m", "works here is 7.1 m"] {
        assert!(found[0].allowed.contains(part), "{found:?}");
    }
    for part in [
        "at least 3010 m",
        "its radius 3000 m",
        "buffer_m.threats 10 m",
        "works here is",
    ] {
        assert!(found[1].allowed.contains(part), "{found:?}");
    }
    // What is named works.
    good(&(text.replace("-84.22655", "-84.20") + "buffer_m: {area: 7.1}\n"));
}

#[test]
fn heights_inside_a_buffer_name_both_figures() {
    let text = second()
        .replace("lon: -84.39, agl_m: 80}", "lon: -84.39, agl_m: 65}")
        .replace("amsl_m: 700", "amsl_m: 1495")
        .replace("return_amsl_m: 900", "return_amsl_m: 1492");
    let found = over_ground(&text);
    let paths: Vec<&str> = found.iter().map(|issue| issue.path.as_str()).collect();
    let expected = [
        "vehicles[0].goal",
        "vehicles[0].return_amsl_m",
        "vehicles[1].start",
    ];
    assert_eq!(paths, expected, "{found:#?}");
    for (issue, parts) in found.iter().zip([
        ["at most 1490 m", "works here is 5 m"],
        ["at most 1490 m", "works here is 8 m"],
        ["at least 70 m", "works here is 5 m"],
    ]) {
        for part in parts {
            assert!(issue.allowed.contains(part), "{issue:?}");
        }
    }
    let rally = second().replace(
        "lon: -84.38, agl_m: 80}\nvehicles",
        "lon: -84.38, agl_m: 61}\nvehicles",
    );
    let found = issues(&rally);
    assert_eq!(found[0].path, "rally[0].agl_m");
    assert!(found[0].allowed.contains("works here is 1 m"), "{found:?}");
}

#[test]
fn a_place_near_a_zone_with_a_height_is_an_error_below_it_alone() {
    // 5 m south of the town, which is closed below 900 m.
    let at = |amsl_m: &str| {
        second().replace(
            "goal: {lat: 36.21, lon: -84.12, agl_m: 80}",
            &format!("goal: {{lat: 36.349955, lon: -84.20, amsl_m: {amsl_m}}}"),
        )
    };
    let found = over_ground(&at("905"));
    assert_eq!(found[0].path, "vehicles[1].goal");
    assert!(
        found[0].allowed.contains("buffer_m.zones 10 m"),
        "{found:?}"
    );
    world::load(&parse(&at("911")).expect("good so far")).expect("above the zone and its buffer");
}
