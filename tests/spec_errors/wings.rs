//! The keys of planes and VTOL.

use super::*;

/// The full spec with a plane instead of its first copter.
fn plane() -> String {
    with(
        "    airframe: copter\n",
        "    airframe: plane\n    takeoff_heading_deg: 90\n    landing: {heading_deg: 45, glide_deg: 5}\n    loiter_radius_m: 80\n",
    )
    .replace("    return_amsl_m: 900\n", "")
    .replace("wind: {from_deg: 270, speed_mps: 5}\n", "")
}

#[test]
fn wind_widens_circles_and_steepens_a_glide_with_it() {
    let windy = |from: &str, old: &str, new: &str| {
        let text = format!("{}\nwind: {{from_deg: {from}, speed_mps: 5}}\n", plane());
        let found = issues(&text.replacen(old, new, 1));
        assert_eq!(found.len(), 1, "{found:#?}");
        format!(
            "{}: {} (allowed: {})",
            found[0].path, found[0].found, found[0].allowed
        )
    };
    // At 1500 m the standard atmosphere has 1.0581 kg/m^3, not 1.225, and 15 m/s are 16.14:
    // 21.14^2 / (9.80665 sqrt(1.2^2 - 1)) = 68.7.
    let circle = windy("0", "loiter_radius_m: 80", "loiter_radius_m: 60");
    assert!(
        circle.contains("loiter_radius_m") && circle.contains("at least 68.8 m at 21.1 m/s"),
        "{circle}"
    );
    // Landing with 5 m/s behind at 21.14 m/s: atan(3 / 21.14).
    let glide = windy("225", "glide_deg: 5", "glide_deg: 10");
    assert!(
        glide.contains("glide_deg") && glide.contains("at most 8.1"),
        "{glide}"
    );
}

/// The only issue of a plane with one piece of text replaced.
fn broken(old: &str, new: &str) -> (String, String) {
    let text = plane();
    assert!(text.contains(old), "{old}");
    let found = issues(&text.replacen(old, new, 1));
    assert_eq!(found.len(), 1, "{found:#?}");
    assert!(found[0].position.is_some());
    let words = format!("{} (allowed: {})", found[0].found, found[0].allowed);
    (found[0].path.clone(), words)
}

#[test]
fn a_plane_is_read_with_its_headings_in_radians() {
    let vehicle = good(&plane()).vehicles.remove(0);
    assert_eq!(vehicle.airframe, Airframe::Plane);
    let wing = vehicle.wing.expect("a wing");
    let landing = wing.landing.expect("a landing");
    assert!((wing.takeoff_heading_rad.expect("a heading") - 90_f64.to_radians()).abs() < 1e-12);
    let heading_rad = landing.heading_rad.expect("given");
    assert!((heading_rad - 45_f64.to_radians()).abs() < 1e-12);
    assert!((landing.glide_rad - 5_f64.to_radians()).abs() < 1e-12);
    assert!((wing.loiter_radius_m - 80.0).abs() < 1e-12);
}

#[test]
fn a_radius_that_is_not_given_has_room_around_the_turn_radius() {
    let text = plane().replace("    loiter_radius_m: 80\n", "");
    let wing = good(&text).vehicles[0].wing.expect("a wing");
    // 40.1 m at 1.2 g and 15 m/s, which are 16.14 m/s at the ceiling of 1500 m, and a quarter more.
    assert!((wing.loiter_radius_m - 51.0).abs() < 1e-9, "{wing:?}");
}

#[test]
fn a_plane_needs_a_takeoff_heading_and_a_landing() {
    let (path, words) = broken("    takeoff_heading_deg: 90\n", "");
    assert_eq!(path, "vehicles[0]");
    assert!(words.contains("takeoff_heading_deg: 0 to 360"), "{words}");
    let landing = "    landing: {heading_deg: 45, glide_deg: 5}\n";
    let (path, words) = broken(landing, "");
    assert_eq!(path, "vehicles[0].landing");
    assert!(
        words.contains("landing: {heading_deg, glide_deg}"),
        "{words}"
    );
    let loiters = plane().replacen("finish: land", "finish: loiter", 1);
    good(&loiters.replace(landing, ""));
}

#[test]
fn a_plane_stands_away_from_its_start() {
    let (path, words) = broken("    home: {lat: 36.21, lon: -84.39}\n", "");
    assert_eq!(path, "vehicles[0]");
    assert!(words.contains("no home"), "{words}");
    let (path, words) = broken("lon: -84.39}", "lon: -84.38}");
    assert_eq!(path, "vehicles[0].home");
    assert!(words.contains("0.0 m from start"), "{words}");
}

#[test]
fn a_circle_is_not_tighter_than_the_vehicle_can_turn() {
    let (path, words) = broken("loiter_radius_m: 80", "loiter_radius_m: 30");
    assert_eq!(path, "vehicles[0].loiter_radius_m");
    assert!(words.contains("at least 40.1 m"), "{words}");
}

#[test]
fn a_glide_sinks_no_faster_than_the_vehicle_may() {
    let (path, words) = broken("glide_deg: 5", "glide_deg: 15");
    assert_eq!(path, "vehicles[0].landing.glide_deg");
    assert!(words.contains("at most 10.5 (descent_mps 3)"), "{words}");
    assert_eq!(
        broken("glide_deg: 5", "glide_deg: 0.5").0,
        "vehicles[0].landing.glide_deg"
    );
    assert_eq!(
        broken("heading_deg: 45", "heading_deg: 361").0,
        "vehicles[0].landing.heading_deg"
    );
}

#[test]
fn a_wing_does_not_return_on_its_own() {
    let text = plane().replace("depart_s: 5\n", "depart_s: 5\n    return_amsl_m: 900\n");
    let found = issues(&text);
    assert_eq!(found.len(), 1, "{found:#?}");
    assert_eq!(found[0].path, "vehicles[0].return_amsl_m");
}

#[test]
fn a_vtol_needs_none_of_the_keys_and_may_have_all() {
    good(&plane().replace("airframe: plane", "airframe: vtol"));
    let bare = with("    airframe: copter\n", "    airframe: vtol\n").replace(
        "wind: {from_deg: 270, speed_mps: 5}",
        "wind: {from_deg: 270, speed_mps: 4}",
    );
    let vehicle = good(&bare.replace("    return_amsl_m: 900\n", ""))
        .vehicles
        .remove(0);
    let wing = vehicle.wing.expect("a wing");
    assert_eq!((wing.takeoff_heading_rad, wing.landing), (None, None));
}

#[test]
fn an_approach_begins_in_the_area_and_high_enough() {
    let text = plane();
    world::load(&parse(&text).expect("good")).expect("4.8 km south-west of the goal is clear");
    let found = over_ground(&text.replace("heading_deg: 45", "heading_deg: 225"));
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].path, "vehicles[0].landing");
    let turned = text.replace("heading_deg: 45", "heading_deg: 225");
    assert_eq!(
        found[0].position,
        Some(place_of(&turned, "{heading_deg: 225"))
    );
    assert!(
        found[0]
            .found
            .contains("m before the touchdown, begins outside the area"),
        "{found:?}"
    );
    // A hill of 380 m over 300 m where the approach begins, at 700 m.
    let hilly = text.replace(
        "lat: 36.30, lon: -84.25, height_m: 200, radius_m: 2000",
        "lat: 36.3594, lon: -84.1580, height_m: 380, radius_m: 1000",
    );
    let found = over_ground(&hilly);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].path, "vehicles[0].landing");
    assert!(found[0].allowed.contains("min_agl_m"), "{found:?}");
    let watched = text.replace(
        "lat: 36.31, lon: -84.26, radius_m: 3000",
        "lat: 36.36, lon: -84.17, radius_m: 2000",
    );
    let found = over_ground(&watched);
    assert!(
        found[0].found.contains("inside threat `radar-1`"),
        "{found:?}"
    );
}

/// The first vehicle in a wind, by its autopilot and airframe.
fn in_wind(autopilot: &str, airframe: &str, wind_mps: f64) -> String {
    let text = plane()
        .replacen(
            "autopilot: ardupilot",
            &format!("autopilot: {autopilot}"),
            1,
        )
        .replace("airframe: plane", &format!("airframe: {airframe}"))
        .replace("return_amsl_m: 900\n", "\n");
    format!("{text}\nwind: {{from_deg: 0, speed_mps: {wind_mps}}}\n")
}

#[test]
fn a_wing_in_more_wind_than_it_was_flown_in_is_an_error_that_says_what_was_measured() {
    for (autopilot, airframe, kind, most) in [
        ("ardupilot", "plane", "ArduPlane", 6.0),
        ("ardupilot", "vtol", "ArduPlane (QuadPlane)", 4.0),
        ("px4", "plane", "PX4 (plane)", 6.0),
        ("px4", "vtol", "PX4 (VTOL)", 4.0),
    ] {
        good(&in_wind(autopilot, airframe, most));
        let found = issues(&in_wind(autopilot, airframe, most + 0.5));
        assert_eq!(found.len(), 1, "{kind}: {found:#?}");
        assert_eq!(found[0].path, "wind.speed_mps");
        assert!(found[0].position.is_some(), "{found:?}");
        let is = format!("{} m/s, and `alpha` is of {kind}", most + 0.5);
        assert_eq!(found[0].found, is);
        for part in [
            &format!("in more than {most} m/s of wind (ArduPlane 4."),
            "plan for less wind",
        ] {
            assert!(found[0].allowed.contains(part), "{part}: {found:?}");
        }
    }
    // A copter is judged by the speed that it needs through the air.
    good(&with("speed_mps: 5}", "speed_mps: 9}"));
}

/// A QuadPlane in the corner of the area: its region has 80 m, and two turn radii of 40.1 m.
fn quadplane() -> String {
    with(
        "    airframe: copter\n",
        "    airframe: vtol\n    loiter_radius_m: 80\n",
    )
    .replace("    return_amsl_m: 900\n", "")
    .replace("wind: {from_deg: 270, speed_mps: 5}\n", "")
}

#[test]
fn what_is_nearer_to_the_takeoff_of_a_quadplane_than_where_it_may_be_is_named() {
    let text = quadplane();
    world::load(&parse(&text).expect("good")).expect("nothing near");
    let one = |text: &str| {
        let found = over_ground(text);
        assert_eq!(found.len(), 1, "{found:#?}");
        assert_eq!(found[0].path, "vehicles[0].home");
        found[0].clone()
    };
    // 0.0022 degrees of latitude are 244 m.
    let mast = "  - {id: mast, kind: mast, lat: 36.2122, lon: -84.39, radius_m: 100}\nno_fly:";
    let found = one(&text.replace("no_fly:", mast));
    assert!(
        found
            .found
            .contains("home is 244 m from the axis of threat `mast`"),
        "{found:?}"
    );
    for part in [
        "at least 261 m: its radius of 100 m, and 161 m in which ArduPlane (QuadPlane) may be",
        "80 m to forward flight, 80 m for two turn radii)",
    ] {
        assert!(found.allowed.contains(part), "{part}: {found:?}");
    }
    // The same mast 40 m further away, and then in a wind.
    let away = text.replace("no_fly:", &mast.replace("36.2122", "36.2126"));
    world::load(&parse(&away).expect("good")).expect("far enough");
    let windy = format!("{away}wind: {{from_deg: 90, speed_mps: 2}}\n");
    let found = one(&windy);
    assert!(found.allowed.contains("m in this wind"), "{found:?}");
    // PX4 turns its nose to its first leg before it flies on; a copter keeps its column.
    let px4 = text.replacen("autopilot: ardupilot", "autopilot: px4", 1);
    world::load(&parse(&px4.replace("no_fly:", mast)).expect("good")).expect("no region");
    let zone = "no_fly:\n  - {id: yard, polygon: [[36.2112, -84.391], [36.2112, -84.389], [36.213, -84.39]]}";
    let found = one(&text.replace("no_fly:", zone));
    assert!(
        found.found.contains("m from no-fly zone `yard`") && found.allowed.contains("its outline"),
        "{found:?}"
    );
    // Lower than the region.
    let low = zone.replace("-84.39]]}", "-84.39]], below_amsl_m: 320}");
    world::load(&parse(&text.replace("no_fly:", &low)).expect("good")).expect("above the yard");
    let edge = text.replace("south_west: {lat: 36.20,", "south_west: {lat: 36.209,");
    let found = one(&edge);
    assert!(
        found.found.contains("home is 111 m from the edge"),
        "{found:?}"
    );
    let hill = "    hills:\n      - {lat: 36.2095, lon: -84.3905, height_m: 75, radius_m: 200}\n";
    let found = over_ground(&text.replace("    hills:\n", hill));
    let of_region = found
        .iter()
        .find(|issue| issue.allowed.contains("a higher start"));
    assert!(of_region.is_some(), "{found:#?}");
}

#[test]
fn a_quadplane_that_may_land_with_the_wind_from_behind_is_warned() {
    let text = quadplane() + "wind: {from_deg: 300, speed_mps: 3}\n";
    let note = |text: &str| {
        let vehicle = good(text).vehicles.remove(0);
        let landing = vehicle.wing.and_then(|wing| wing.landing);
        vehicle.landing_note(landing.and_then(|landing| landing.heading_rad))
    };
    let told = note(&text).expect("a warning");
    assert!(
        told.contains("60 m from its place; landing.heading_deg 300"),
        "{told}"
    );
    let heading = |deg: u32| {
        let own = format!("    landing: {{heading_deg: {deg}, glide_deg: 5}}\n    loiter_radius_m");
        text.replacen("    loiter_radius_m", &own, 1)
    };
    assert!(note(&heading(120)).is_some());
    assert_eq!(note(&heading(300)), None);
    assert_eq!(note(&heading(29)), None);
    assert_eq!(note(&quadplane()), None);
}

#[test]
fn where_there_is_wind_the_course_of_a_landing_may_be_left_open() {
    let open = |text: &str| {
        let wing = good(text).vehicles[0].wing.expect("a wing");
        wing.landing.map(|landing| landing.heading_rad)
    };
    let windy = plane() + "wind: {from_deg: 45, speed_mps: 3}\n";
    let left_open = windy.replace("heading_deg: 45, ", "");
    assert_eq!(open(&left_open), Some(None));
    assert_eq!(open(&windy), Some(Some(45_f64.to_radians())));
    let still = plane().replace("heading_deg: 45, ", "");
    let found = issues(&still);
    assert_eq!(found.len(), 1, "{found:#?}");
    assert_eq!(found[0].path, "vehicles[0].landing.heading_deg");
    assert_eq!(found[0].found, "missing field `heading_deg`", "{found:#?}");
    // A VTOL of version 1 comes from anywhere, as it did.
    let vtol = |version: u32, wind: &str| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("missions/vtol-ardupilot.yaml");
        let text = fs::read_to_string(path).expect("a mission");
        text.replace("sortie: 2", &format!("sortie: {version}")) + wind
    };
    let wind = "\nwind: {from_deg: 45, speed_mps: 3}\n";
    assert_eq!(open(&vtol(2, wind)), Some(None));
    assert_eq!(open(&vtol(1, wind)), None);
    assert_eq!(open(&vtol(2, "")), None);
}

#[test]
fn a_plane_to_whose_landing_no_course_is_free_is_an_error() {
    let windy = plane() + "wind: {from_deg: 45, speed_mps: 3}\n";
    let left_open = windy.replace("heading_deg: 45, ", "");
    world::load(&parse(&left_open).expect("good")).expect("free from the south-west");
    let watched = left_open.replace(
        "lat: 36.31, lon: -84.26, radius_m: 3000",
        "lat: 36.36, lon: -84.17, radius_m: 5500",
    );
    let found = over_ground(&watched);
    let of_landing = found
        .iter()
        .find(|issue| issue.path == "vehicles[0].landing");
    let of_landing = of_landing.unwrap_or_else(|| panic!("{found:#?}"));
    assert!(
        of_landing
            .found
            .contains("no course to the landing is free"),
        "{of_landing:?}"
    );
}
