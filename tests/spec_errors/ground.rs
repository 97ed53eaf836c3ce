//! What shows only over the ground.

use super::*;

#[test]
fn a_start_under_ground_says_how_deep() {
    let text = with(
        "start: {lat: 36.39, lon: -84.39, agl_m: 80}",
        "start: {lat: 36.39, lon: -84.39, amsl_m: 280}",
    );
    let found = over_ground(&text);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(
        (found[0].path.as_str(), found[0].position),
        (
            "vehicles[1].start",
            Some(place_of(&text, "{lat: 36.39, lon: -84.39"))
        )
    );
    assert!(found[0].found.contains("20.0 m under ground"), "{found:?}");
}

#[test]
fn ends_keep_the_minimum_altitude_and_the_ceiling() {
    let text = with("lon: -84.39, agl_m: 80}", "lon: -84.39, agl_m: 59}")
        .replace("amsl_m: 700", "amsl_m: 1501");
    let found = over_ground(&text);
    let paths: Vec<&str> = found.iter().map(|issue| issue.path.as_str()).collect();
    assert_eq!(
        paths,
        ["vehicles[0].goal", "vehicles[1].start"],
        "{found:?}"
    );
    assert!(found[0].allowed.contains("max_amsl_m") && found[1].allowed.contains("min_agl_m"));
}

#[test]
fn a_zone_with_a_height_counts_below_it() {
    let above = with(
        "goal: {lat: 36.21, lon: -84.12, agl_m: 80}",
        "goal: {lat: 36.3595, lon: -84.19, amsl_m: 950}",
    );
    let file = parse(&above).expect("good so far");
    world::load(&file).expect("it returns above the zone");
    let found = over_ground(&above.replace("amsl_m: 950", "amsl_m: 850"));
    assert_eq!(found[0].path, "vehicles[1].goal");
    assert!(found[0].found.contains("`town`"));
    let found = over_ground(&above.replace("finish: return", "finish: land"));
    assert!(found[0].found.starts_with("landing"), "{found:?}");
}

#[test]
fn two_vehicles_do_not_loiter_at_one_place() {
    let text = FULL
        .replace("finish: land", "finish: loiter")
        .replace("finish: return", "finish: loiter")
        .replace(
            "goal: {lat: 36.21, lon: -84.12, agl_m: 80}",
            "goal: {lat: 36.39, lon: -84.121, amsl_m: 730}",
        );
    let found = over_ground(&text);
    assert_eq!(found[0].path, "vehicles[1].goal");
    assert!(found[0].found.contains("`alpha`"), "{found:?}");
    let apart = text.replace("amsl_m: 730", "amsl_m: 741");
    world::load(&parse(&apart).expect("good")).expect("41 m apart in height is enough");
}

#[test]
fn a_missing_terrain_file_is_named_at_its_key() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("mission.yaml");
    let text = with(
        "terrain:\n  analytic:\n    base_amsl_m: 300\n    hills:\n      - {lat: 36.30, lon: -84.25, height_m: 200, radius_m: 2000}\n",
        "terrain: {file: terrain/none.tif}\n",
    );
    fs::write(&path, &text).expect("written");
    let file = SpecFile::read(&path).expect("a good spec");
    let error = world::load(&file).expect_err("no terrain");
    assert_eq!(error.issues[0].path, "terrain.file");
    assert_eq!(
        error.issues[0].position,
        Some(place_of(&text, "terrain/none.tif"))
    );
    assert!(error.to_string().contains("cannot be read"), "{error}");
}

#[test]
fn a_tolerance_wider_than_the_layer_to_fly_in_says_how_wide_that_is() {
    // 300 m of base under a start, 60 m above it, and a ceiling 80 m higher.
    let low = with("max_amsl_m: 1500", "max_amsl_m: 440")
        .replace("height_m: 200", "height_m: 1")
        .replace("amsl_m: 700", "amsl_m: 380")
        .replace("return_amsl_m: 900", "return_amsl_m: 400");
    let file = parse(&low.replace("tolerance_m: 3", "tolerance_m: 79")).expect("good so far");
    world::load(&file).expect("a tolerance that fits");
    let found = over_ground(&low.replace("tolerance_m: 3", "tolerance_m: 100"));
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].path, "mission.tolerance_m");
    assert!(found[0].found.starts_with("100 m, and from"), "{found:?}");
    assert!(found[0].allowed.starts_with("at most 80"), "{found:?}");
}

#[test]
fn a_value_a_hair_beside_its_limit_does_not_read_like_it() {
    let text = with("lon: -84.39, agl_m: 80}", "lon: -84.39, agl_m: 59.99}");
    let found = over_ground(&text);
    assert!(found[0].found.contains("is 59.99 m above"), "{found:?}");
}

/// Everything that is wrong with a spec, over the ground as well.
pub(super) fn everything(text: &str) -> Vec<Issue> {
    let mission = sortie::Mission::parse("", text);
    mission.expect_err("something is wrong").issues
}

pub(super) fn has(issues: &[Issue], path: &str, part: &str) {
    let is_it = |issue: &&Issue| issue.path == path && issue.found.contains(part);
    assert!(
        issues.iter().any(|issue| is_it(&issue)),
        "{path} {part}: {issues:#?}"
    );
}

#[test]
fn a_wrong_key_and_a_wrong_value_hide_nothing_that_the_ground_shows() {
    // In the same vehicle: a start inside a threat, a value out of range, and a goal above the ceiling.
    let text = FULL
        .replace("kind: radar,", "colour: red,")
        .replace("    speed_mps: 15\n", "    speed_mps: 1500\n")
        .replace(
            "start: {lat: 36.21, lon: -84.38",
            "start: {lat: 36.31, lon: -84.26",
        )
        .replace("amsl_m: 700", "amsl_m: 1501")
        .replace("lon: -84.39, agl_m: 80}", "lon: -84.39, agl_m: 59}");
    let found = everything(&text);
    has(&found, "threats[0].colour", "unknown field");
    has(&found, "vehicles[0].speed_mps", "1500");
    has(&found, "vehicles[0].start", "inside threat `radar-1`");
    has(&found, "vehicles[0].goal", "1501.0 m");
    has(&found, "vehicles[1].start", "59.0 m above ground");
    assert_eq!(found.len(), 5, "{found:#?}");
    assert!(found.is_sorted_by_key(|issue| issue.position), "{found:#?}");
}

#[test]
fn sites_of_a_vehicle_are_judged_whatever_its_other_keys_are() {
    for (old, new, path) in [
        (
            "    speed_mps: 12\n",
            "    speed_mps: fast\n",
            "vehicles[1].speed_mps",
        ),
        (
            "    finish: return\n",
            "    finish: crash\n",
            "vehicles[1].finish",
        ),
        ("    autopilot: px4\n", "", "vehicles[1].autopilot"),
        ("  max_amsl_m: 1500\n", "", "area.max_amsl_m"),
        ("sysid: 2\n", "sysid: two\n", "vehicles[1].sysid"),
        (
            "    link: tcp:127.0.0.1:5760\n",
            "    link: wire\n",
            "vehicles[1].link",
        ),
    ] {
        let text = with(old, new).replace("lon: -84.39, agl_m: 80}", "lon: -84.39, agl_m: 59}");
        let found = everything(&text);
        has(&found, path, "");
        has(&found, "vehicles[1].start", "59.0 m above ground");
        assert_eq!(found.len(), 2, "{found:#?}");
    }
}

#[test]
fn what_the_ground_would_show_of_a_broken_value_is_not_reported() {
    let low = FULL.replace("lon: -84.39, agl_m: 80}", "lon: -84.39, agl_m: 59}");
    for (old, new) in [
        ("min_agl_m: 60", "min_agl_m: sixty"),
        ("min_agl_m: 60", "min_agl_m: -60"),
        ("base_amsl_m: 300", "base_amsl_m: low"),
        ("lon: -84.39, agl_m: 59}", "lon: -84.39, agl_m: low}"),
        ("lon: -84.39, agl_m: 59}", "lon: -84.39}"),
    ] {
        let found = everything(&low.replace(old, new));
        assert_eq!(found.len(), 1, "{new}: {found:#?}");
    }
    // A list that is broken moves no path: the second stop is the second.
    let stops = "stops: [{id: a, lat: 36.2, lon: x, agl_m: 80}, {id: b, lat: 36.3, lon: -84.15, amsl_m: 330}]";
    let text = FULL.replace("sortie: 1", "sortie: 2").replace(
        "    max_airspeed_mps: 20\n",
        &format!("    max_airspeed_mps: 20\n    {stops}\n"),
    );
    let found = everything(&text);
    has(&found, "vehicles[1].stops[1]", "m above ground");
}

#[test]
fn a_terrain_that_is_missing_is_reported_beside_a_wrong_value() {
    let text = with("from_deg: 270", "from_deg: 400").replace(
        "  analytic:\n    base_amsl_m: 300\n    hills:\n      - {lat: 36.30, lon: -84.25, height_m: 200, radius_m: 2000}\n",
        "  file: none.tif\n",
    );
    let found = everything(&text);
    has(&found, "terrain.file", "");
    has(&found, "wind.from_deg", "400");
    assert_eq!(found.len(), 2, "{found:#?}");
}
