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
    assert!((landing.heading_rad - 45_f64.to_radians()).abs() < 1e-12);
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
    let bare = with("    airframe: copter\n", "    airframe: vtol\n");
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
