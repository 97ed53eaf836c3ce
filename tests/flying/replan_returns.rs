//! New paths while another vehicle returns: nobody knows how fast it does.

use super::replan_trouble::{order, replan};
use crate::support::in_flight::{json, lines, planned, take_off, wait_for};

/// `RTL` of `ArduCopter`.
const RETURN: f32 = 6.0;

/// Alpha flies to the east; bravo, behind it, on a lane 280 m to the north. Bravo has three quarters of
/// a minute before it is where the threat will be, which a busy machine takes to plan. Where it comes 20 s
/// later alpha is past, and south of the threat nothing is in its way.
fn spec(closed: &str) -> String {
    format!(
        "
sortie: 1
name: lanes
area: {{south_west: {{lat: 36.28, lon: -84.30}}, north_east: {{lat: 36.33, lon: -84.20}}, min_agl_m: 30, max_amsl_m: 900}}
terrain: {{flat: {{amsl_m: 400}}}}
vehicles:
  - {{id: alpha, sysid: 1, autopilot: ardupilot, link: sim, speed_mps: 15, climb_mps: 5, descent_mps: 4, return_amsl_m: 460, depart_s: 5,
     start: {{lat: 36.300, lon: -84.265, agl_m: 40}}, goal: {{lat: 36.300, lon: -84.238, agl_m: 40}}, finish: land}}
  - {{id: bravo, sysid: 2, autopilot: px4, link: sim, speed_mps: 15, climb_mps: 5, descent_mps: 4,
     start: {{lat: 36.3025, lon: -84.2779, agl_m: 40}}, goal: {{lat: 36.3025, lon: -84.240, agl_m: 40}}, finish: loiter}}
separation: {{distance_m: 100, time_slack_s: 5}}
planner: {{algorithm: msfoa, seed: 1, evaluations: 6000}}
{closed}"
    )
}

/// Leaves bravo the way south of a threat alone, along that of alpha.
const CLOSED: &str = "no_fly:
  - {id: north, polygon: [[36.3035, -84.2625], [36.3035, -84.2540], [36.3290, -84.2540], [36.3290, -84.2625]]}
  - {id: south, polygon: [[36.2810, -84.2625], [36.2810, -84.2540], [36.2990, -84.2540], [36.2990, -84.2625]]}
";

/// How near the items of a new path come to the way on which alpha returns, metres.
fn nearest_m(items: &[serde_json::Value], east_deg: f64) -> f64 {
    let value = |item: &serde_json::Value, key: &str| item[key].as_f64().expect("a number");
    let keys = ["lat_deg", "lon_deg", "z_m"];
    let points = items.iter().map(|item| keys.map(|key| value(item, key)));
    let points: Vec<[f64; 3]> = points.collect();
    let mut nearest_m = f64::INFINITY;
    for pair in points.windows(2) {
        for step in 0..=200 {
            let share = f64::from(step) / 200.0;
            let [lat, lon, z] =
                [0, 1, 2].map(|at| pair[0][at] + share * (pair[1][at] - pair[0][at]));
            let beyond_deg = (-84.265 - lon).max(lon - east_deg).max(0.0);
            let flat_m = (111_000.0 * (lat - 36.3)).hypot(89_700.0 * beyond_deg);
            nearest_m = nearest_m.min(flat_m.hypot(z - 460.0));
        }
    }
    nearest_m
}

#[test]
fn a_new_path_keeps_from_the_way_on_which_another_vehicle_returns_or_is_refused() {
    // They wait for the clock.
    std::thread::scope(|scope| {
        for closed in ["", CLOSED] {
            scope.spawn(move || keeps_from_a_return(closed));
        }
    });
}

fn keeps_from_a_return(closed: &str) {
    let (folder, runs) = planned("lanes", &spec(closed));
    let flight = take_off(folder.path(), "lanes.yaml", "1");
    wait_for(&runs, "alpha", 68.0);
    order(&runs, "alpha", 1, RETURN);
    let (output, told, errors) = replan(folder.path(), "36.3029,-84.2583,250");
    let of_alpha = lines(&runs)
        .into_iter()
        .filter(|line| line["vehicle"] == "alpha");
    let east_deg = of_alpha.filter_map(|line| line["lon_deg"].as_f64());
    let east_deg = east_deg.fold(-85.0, f64::max);
    assert!(east_deg > -84.259, "{east_deg}");
    assert!(told.contains("alpha     returns"), "{told}");
    // Farther east alpha was long ago.
    let east_deg = east_deg.min(-84.2585);
    let is_led = told.contains("on its new path");
    if is_led {
        let done = json(&runs.join("replan.json"));
        let items = done["vehicles"][0]["items"].as_array().expect("items");
        let away_m = nearest_m(items, east_deg);
        assert!(away_m > 97.0, "{away_m} m: {told}");
    } else {
        assert_eq!(output.status.code(), Some(4), "{told}{errors}");
        let why = "m of the way on which alpha returns (at least 100 m)";
        assert!(
            errors.contains(why) && errors.contains("bravo cannot avoid"),
            "{told}{errors}"
        );
    }
    // Where it may go north it does.
    assert_eq!(is_led, closed.is_empty(), "{told}{errors}");
    drop(flight);
}
