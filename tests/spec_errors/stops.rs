//! Stops: keys, what is absent, and what cannot be flown.

use sortie::spec::{MAX_STOPS, Order};

use super::ground::{everything, has};
use super::{good, issues, only, over_ground, with};

const ALPHA: &str = "    depart_s: 5\n";
const GOAL: &str = "    goal: {lat: 36.39, lon: -84.12, amsl_m: 700}\n";

fn stops(listed: &str) -> String {
    format!("{ALPHA}    stops: [{listed}]\n")
}

const GOOD: &str = "{id: t1, lat: 36.22, lon: -84.30, agl_m: 80, hold_s: 3}, {id: t2, lat: 36.22, lon: -84.20, amsl_m: 600}";

#[test]
fn stops_are_read_and_a_vehicle_without_a_goal_ends_at_its_start() {
    let text = with(ALPHA, &stops(GOOD));
    let alpha = &good(&text).vehicles[0];
    assert_eq!((alpha.stops.len(), alpha.order), (2, Order::Fixed));
    assert!(
        (alpha.stops[0].rest_s() - 3.0).abs() < 1e-9
            && (alpha.stops[1].rest_s() - 1.0).abs() < 1e-9
    );
    let round = text.replace(GOAL, "");
    let alpha = &good(&round).vehicles[0];
    assert_eq!(alpha.goal, alpha.start);
    let (path, text) = only(GOAL, "");
    assert_eq!(path, "vehicles[0].goal");
    assert!(
        text.contains("missing field `goal` (allowed: a goal at least"),
        "{text}"
    );
}

#[test]
fn what_is_wrong_with_a_stop_is_reported_at_its_place() {
    for (listed, path, found) in [
        (
            "{id: t1, lat: 36.22, lon: -84.30}",
            "vehicles[0].stops[0]",
            "no altitude",
        ),
        (
            "{lat: 36.22, lon: -84.30, agl_m: 80}",
            "vehicles[0].stops[0].id",
            "missing field",
        ),
        (
            "{id: t1, lat: 36.22, lon: -84.30, agl_m: 80, hold_s: -1}",
            "vehicles[0].stops[0].hold_s",
            "-1",
        ),
        // More than 65535 s do not fit into an item of ArduPilot.
        (
            "{id: t1, lat: 36.22, lon: -84.30, agl_m: 80, hold_s: 65536}",
            "vehicles[0].stops[0].hold_s",
            "65536 (allowed: 0 to 3600)",
        ),
        (
            "{id: t1, lat: 36.5, lon: -84.30, agl_m: 80}",
            "vehicles[0].stops[0]",
            "outside of the area",
        ),
        (
            "{id: t1, lat: 36.31, lon: -84.26, agl_m: 80}",
            "vehicles[0].stops[0]",
            "inside threat `radar-1`",
        ),
        (
            "{id: t1, lat: 36.21, lon: -84.38, agl_m: 80}",
            "vehicles[0].stops[0]",
            "0 m from start",
        ),
        (
            "{id: t1, lat: 36.22, lon: -84.30, agl_m: 80, acceptance_radius: 3}",
            "",
            "acceptance_radius_m",
        ),
    ] {
        let (at, text) = only(ALPHA, &stops(listed));
        assert!(at == path || path.is_empty(), "{at}: {text}");
        assert!(text.contains(found), "{text}");
    }
    let twice = GOOD.replace("t2", "T1");
    let (at, text) = only(ALPHA, &stops(&twice));
    assert_eq!(at, "vehicles[0].stops[1].id");
    assert!(text.contains("already the id"), "{text}");
}

#[test]
fn stops_near_each_other_are_too_near_in_the_order_in_which_they_may_be_visited() {
    let third = "{id: t3, lat: 36.22, lon: -84.30, agl_m: 90}";
    let listed = format!("{GOOD}, {third}");
    good(&with(ALPHA, &stops(&listed)));
    let free = format!("{}    order: free\n", stops(&listed));
    let (path, text) = only(ALPHA, &free);
    assert_eq!(path, "vehicles[0].stops[2]");
    assert!(text.contains("from stop `t1`"), "{text}");
}

#[test]
fn an_order_needs_stops_and_a_speed_from_a_stop_on_a_fixed_order() {
    let (path, _) = only(ALPHA, &format!("{ALPHA}    order: free\n"));
    assert_eq!(path, "vehicles[0].order");
    let fast = GOOD.replace("hold_s: 3", "speed_mps: 8");
    good(&with(ALPHA, &stops(&fast)));
    let (path, _) = only(ALPHA, &format!("{}    order: free\n", stops(&fast)));
    assert_eq!(path, "vehicles[0].stops[0].speed_mps");
    let range = format!(
        "{}    speed_range_mps: {{min: 10, max: 16}}\n",
        stops(&fast)
    );
    let (path, _) = only(ALPHA, &range);
    assert_eq!(path, "vehicles[0].stops[0].speed_mps");
}

#[test]
fn a_wing_does_not_hover_at_its_stops_and_has_them_far_apart() {
    let wing = |listed: &str| {
        let text = with("airframe: copter", "airframe: vtol").replace(ALPHA, &stops(listed));
        let text = text.replace("from_deg: 270, speed_mps: 5", "from_deg: 270, speed_mps: 4");
        text.replace("    return_amsl_m: 900\n", "")
    };
    let good_ones = GOOD.replace(", hold_s: 3", "");
    let alpha = good(&wing(&good_ones)).vehicles.remove(0);
    assert!(alpha.passes_after(0) && !alpha.passes_after(2));
    let alpha = good(&wing(GOOD)).vehicles.remove(0);
    assert!(!alpha.passes_after(0) && alpha.passes_after(1));
    assert!((alpha.stay_s(&alpha.stops[0]) - 3.0).abs() < 1e-9);
    for (key, path) in [
        ("heading_deg: 90", "heading_deg"),
        ("speed_mps: 8", "speed_mps"),
        (
            "actions: [{winch: {length_m: 5, rate_mps: 0.5}}]",
            "actions[0].winch",
        ),
    ] {
        let found = issues(&wing(&GOOD.replace("hold_s: 3", key)));
        let paths: Vec<&str> = found.iter().map(|issue| issue.path.as_str()).collect();
        assert_eq!(paths, [format!("vehicles[0].stops[0].{path}")]);
    }
    let near = good_ones.replace("lon: -84.20", "lon: -84.298");
    let found = issues(&wing(&near));
    assert_eq!(found[0].path, "vehicles[0].stops[1]");
    assert!(found[0].found.contains("m from stop `t1`"), "{found:?}");
}

#[test]
fn stops_are_not_too_many() {
    let many: Vec<String> = (0..=MAX_STOPS)
        .map(|n| {
            format!(
                "{{id: s{n}, lat: {}, lon: -84.30, agl_m: 80}}",
                36.21 + 0.0005 * f64::from(u32::try_from(n).expect("few"))
            )
        })
        .collect();
    let (path, text) = only(ALPHA, &stops(&many.join(", ")));
    assert_eq!(path, "vehicles[0].stops");
    assert!(text.contains("at most 100"), "{text}");
}

#[test]
fn a_stop_above_the_sea_or_on_a_wing_keeps_the_height_that_a_start_keeps() {
    let low = with(
        ALPHA,
        &stops("{id: t1, lat: 36.22, lon: -84.30, amsl_m: 340}"),
    );
    let found = over_ground(&low);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].path, "vehicles[0].stops[0]");
    assert!(found[0].found.contains("stop is 40"), "{found:?}");
    assert!(found[0].allowed.contains("a lower `agl_m`"), "{found:?}");
    for airframe in ["plane", "vtol"] {
        let own = stops("{id: t1, lat: 36.22, lon: -84.30, agl_m: 40}");
        let kind = format!("airframe: {airframe}");
        let low = with(ALPHA, &own).replacen("airframe: copter", &kind, 1);
        let found = everything(&low);
        has(&found, "vehicles[0].stops[0]", "stop is 40");
    }
}

#[test]
fn a_copter_comes_straight_down_to_a_stop_below_the_least_height() {
    let at = |agl_m: &str| {
        with(
            ALPHA,
            &stops(&format!(
                "{{id: t1, lat: 36.22, lon: -84.30, agl_m: {agl_m}, hold_s: 3}}"
            )),
        )
    };
    let vehicle = &good(&at("5")).vehicles[0];
    let stop = &vehicle.stops[0];
    assert!((stop.drop_m - 55.0).abs() < 1e-9, "{stop:?}");
    let down_s = 2.0 + 55.0 / vehicle.descent_mps + 55.0 / vehicle.climb_mps;
    assert!((vehicle.rest_after_s(0) - 3.0 - down_s).abs() < 1e-9);
    assert!(good(&at("60")).vehicles[0].stops[0].drop_m.abs() < 1e-12);
    let found = issues(&at("2.9"));
    assert_eq!(found[0].path, "vehicles[0].stops[0].agl_m");
    assert!(found[0].allowed.contains("at least 3 m"), "{found:?}");
}

#[test]
fn actions_are_read_and_what_is_wrong_with_one_is_reported_at_its_place() {
    let at = |actions: &str| {
        stops(&format!(
            "{{id: t1, lat: 36.22, lon: -84.30, agl_m: 80, actions: [{actions}]}}"
        ))
    };
    let all = "{photo: {}}, {video: start}, {video: stop}, {gimbal: {pitch_deg: -45}}, \
               {roi: {lat: 36.22, lon: -84.31, agl_m: 0}}, {roi_none: {}}, {servo: {channel: 9, pwm_us: 1900}}, \
               {relay: {number: 0, closed: true}}, {gripper: release}, {winch: {length_m: 5, rate_mps: 0.5}}";
    let stop = &good(&with(ALPHA, &at(all))).vehicles[0].stops[0];
    assert_eq!(stop.actions.len(), 10);
    assert!((stop.rest_s() - 7.0).abs() < 1e-9);
    let own = "vehicles[0].stops[0].actions[0]";
    for (actions, path, found) in [
        ("{}", own, "0 actions"),
        ("{photo: {}, video: start}", own, "2 actions"),
        (
            "{gimbal: {yaw_deg: 3}}",
            ".gimbal.pitch_deg",
            "missing field",
        ),
        ("{gimbal: {pitch_deg: -91}}", ".gimbal.pitch_deg", "-91"),
        ("{servo: {channel: 9, pwm_us: 100}}", ".servo.pwm_us", "100"),
        ("{roi: {lat: 36.22, lon: -84.31}}", ".roi", "no altitude"),
        ("{video: begin}", "", "start"),
        ("{foto: {}}", "", "photo"),
    ] {
        let (at, text) = only(ALPHA, &at(actions));
        let is_there = path.is_empty() || at == path || at == format!("{own}{path}");
        assert!(is_there, "{at}: {text}");
        assert!(text.contains(found), "{text}");
    }
    let on_px4 = with(ALPHA, &at("{servo: {channel: 9, pwm_us: 1900}}")).replacen(
        "autopilot: ardupilot",
        "autopilot: px4",
        1,
    );
    let found = issues(&on_px4);
    let is_refused = |issue: &&sortie::spec::Issue| issue.path == format!("{own}.servo");
    let issue = found.iter().find(is_refused).expect("refused");
    assert!(issue.found.contains("DO_SET_SERVO"), "{}", issue.found);
}

#[test]
fn a_payload_is_placed_by_an_arducopter_from_a_height_above_ground() {
    let at = |place: &str, action: &str| {
        stops(&format!(
            "{{id: t1, lat: 36.22, lon: -84.30, {place}, actions: [{{payload_place: {action}}}]}}"
        ))
    };
    let spec = good(&with(ALPHA, &at("agl_m: 80", "{max_descent_m: 100}")));
    let vehicle = &spec.vehicles[0];
    let stop = &vehicle.stops[0];
    let max_descent_m = Some(100.0);
    assert_eq!(
        stop.actions,
        [sortie::spec::StopAction::PayloadPlace { max_descent_m }]
    );
    // Down at 0.5 m/s, up at 4 m/s, 5 s on the ground.
    let below_s = vehicle.stay_s(stop) - stop.rest_s();
    assert!(
        (below_s - (80.0 / 0.5 + 5.0 + 80.0 / 4.0)).abs() < 1e-9,
        "{below_s}"
    );
    let own = "vehicles[0].stops[0].actions[0].payload_place";
    let (path, text) = only(ALPHA, &at("amsl_m: 600", "{}"));
    assert!(path == own && text.contains("agl_m"), "{text}");
    let (path, text) = only(ALPHA, &at("agl_m: 80", "{max_descent_m: 60}"));
    assert!(
        path == format!("{own}.max_descent_m") && text.contains("80 m below"),
        "{text}"
    );
    for (old, new, part) in [
        (
            "autopilot: ardupilot",
            "autopilot: px4",
            "PX4 refuses NAV_PAYLOAD_PLACE in a mission",
        ),
        (
            "airframe: copter",
            "airframe: vtol",
            "on a wing, which does not hover",
        ),
    ] {
        let text = with(ALPHA, &at("agl_m: 80", "{}")).replacen(old, new, 1);
        let found = issues(&text);
        let is_it = |issue: &sortie::spec::Issue| issue.path == own && issue.found.contains(part);
        assert!(found.iter().any(is_it), "{found:?}");
    }
}
