//! Limits of altitude and endurance: what is wrong with them is said with its place.

use super::*;

/// The full spec with keys below the ceiling of the area and below the first vehicle.
fn limited(area: &str, vehicle: &str) -> String {
    let text = with("max_amsl_m: 1500\n", &format!("max_amsl_m: 1500\n{area}"));
    text.replacen(
        "    max_climb_deg: 15\n",
        &format!("    max_climb_deg: 15\n{vehicle}"),
        1,
    )
}

#[test]
fn the_tighter_of_two_limits_counts() {
    let area = "  max_agl_m: 150\n  min_amsl_m: 320\n";
    let spec = good(&limited(area, "    max_agl_m: 120\n    min_amsl_m: 310\n"));
    let limits = spec.vehicles[0].altitudes;
    assert_eq!(limits.max_agl, Some(Agl(120.0)));
    assert_eq!(limits.min_amsl, Some(Amsl(320.0)));
    assert_eq!(spec.vehicles[1].altitudes, spec.area.altitudes);
    assert_eq!(good(FULL).vehicles[0].altitudes, Default::default());
}

#[test]
fn limits_that_leave_no_layer_are_an_error() {
    let text = limited(
        "  max_agl_m: 60\n",
        "    max_agl_m: 40\n    min_amsl_m: 1500\n",
    );
    let found = issues(&text);
    let paths: Vec<&str> = found.iter().map(|issue| issue.path.as_str()).collect();
    let vehicle = ["vehicles[0].max_agl_m", "vehicles[0].min_amsl_m"];
    assert!(paths.contains(&"area.max_agl_m"), "{found:?}");
    assert!(vehicle.iter().all(|path| paths.contains(path)), "{found:?}");
    assert!(
        found[0].allowed.contains("area.min_agl_m 60 m"),
        "{found:?}"
    );
}

#[test]
fn a_start_above_and_a_goal_below_their_limits_are_named() {
    let found = over_ground(&limited("", "    max_agl_m: 75\n    min_amsl_m: 750\n"));
    let named = |path: &str, key: &str| {
        let mut issues = found.iter().filter(|issue| issue.path == path);
        assert!(issues.any(|issue| issue.allowed.contains(key)), "{found:?}");
    };
    named("vehicles[0].start", "at most 75 m (max_agl_m)");
    named("vehicles[0].start", "at least 750 m (min_amsl_m)");
    named("vehicles[0].goal", "at least 750 m (min_amsl_m)");
}

#[test]
fn a_goal_below_the_least_height_is_a_drop_for_rotors_that_land() {
    let low = with(
        "goal: {lat: 36.39, lon: -84.12, amsl_m: 700}",
        "goal: {lat: 36.39, lon: -84.12, agl_m: 2}",
    );
    world::load(&parse(&low).expect("good")).expect("a drop");
    let found = over_ground(&low.replacen("finish: land", "finish: loiter", 1));
    assert_eq!(found[0].path, "vehicles[0].goal", "{found:?}");
}

#[test]
fn an_endurance_has_one_capacity_and_ascending_speeds() {
    let spec = good(&limited("", "    endurance: {time_s: 1500}\n"));
    let endurance = spec.vehicles[0].endurance.clone().expect("given");
    assert!((endurance.usable() - 1200.0).abs() < 1e-9);
    let power = "{wh: 200, hover_w: 400, climb_w: 600, cruise: [[5, 380], [15, 420]]}";
    let spec = good(&limited(
        "",
        &format!("    endurance: {{energy: {power}, reserve: 0.1}}\n"),
    ));
    let endurance = spec.vehicles[0].endurance.clone().expect("given");
    assert!((endurance.usable() - 180.0).abs() < 1e-9);
    for (keys, path) in [
        ("{}", "endurance"),
        ("{time_s: 100, range_m: 1000}", "endurance"),
        ("{time_s: 100, reserve: 1.5}", "endurance.reserve"),
        ("{energy: {hover_w: 400}}", "endurance.energy.wh"),
        ("{energy: {wh: 10}}", "endurance.energy.hover_w"),
        (
            "{energy: {wh: 10, hover_w: 9, cruise: [[9, 1], [8, 1]]}}",
            "endurance.energy.cruise[1]",
        ),
        (
            "{energy: {wh: 10, hover_w: 9, cruise: [[9, -1]]}}",
            "endurance.energy.cruise[0]",
        ),
    ] {
        let found = issues(&limited("", &format!("    endurance: {keys}\n")));
        assert_eq!(
            found[0].path,
            format!("vehicles[0].{path}"),
            "{keys}: {found:?}"
        );
    }
}

#[test]
fn fence_points_hold_at_least_the_area() {
    let spec = good(&limited("", "    fence_points: 200\n"));
    assert_eq!(spec.vehicles[0].fence_capacity(), 200);
    let found = issues(&limited("", "    fence_points: 3\n"));
    let points = found
        .iter()
        .find(|issue| issue.path == "vehicles[0].fence_points");
    let points = points.expect("an issue");
    assert_eq!(
        (points.found.as_str(), points.allowed.as_str()),
        ("3", "4 to 5000")
    );
}

#[test]
fn a_battery_that_never_runs_down_and_a_speed_that_no_copter_flies_are_errors() {
    let spec = FULL.replace("sortie: 1", "sortie: 2");
    let with = |key: &str| {
        let at = "    max_airspeed_mps: 20\n";
        spec.replace(at, &format!("    {key}\n"))
    };
    for (key, path) in [
        (
            "endurance: {energy: {wh: 100, hover_w: 0}}",
            "vehicles[1].endurance.energy",
        ),
        (
            "endurance: {energy: {wh: 100, hover_w: 200, cruise: [[15, 0]]}}",
            "vehicles[1].endurance.energy",
        ),
        (
            "stops: [{id: a, lat: 36.3, lon: -84.15, agl_m: 80, speed_mps: 80}]",
            "vehicles[1].stops[0].speed_mps",
        ),
    ] {
        let found = issues(&with(key));
        assert!(
            found.iter().any(|issue| issue.path == path),
            "{key}: {found:#?}"
        );
    }
}
