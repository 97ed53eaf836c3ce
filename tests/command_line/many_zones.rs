//! Hundreds of zones: what they cost in time, and what becomes of the fence.

use std::fs;
use std::path::Path;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};

use crate::support::command::{sortie, text};

/// Two copters across a city, on crossing ways of 25 km.
const SPEC: &str = "sortie: 2
name: city
area: {south_west: {lat: 47.30, lon: 8.40}, north_east: {lat: 47.50, lon: 8.70}, min_agl_m: 40, max_amsl_m: 700}
terrain: {flat: {amsl_m: 450}}
vehicles:
  - {id: alpha, sysid: 1, autopilot: ardupilot, link: sim, start: {lat: 47.32, lon: 8.43, agl_m: 80},
     goal: {lat: 47.48, lon: 8.66, agl_m: 80}, finish: land, speed_mps: 9}
  - {id: bravo, sysid: 2, autopilot: px4, link: sim, start: {lat: 47.32, lon: 8.66, agl_m: 80},
     goal: {lat: 47.48, lon: 8.43, agl_m: 80}, finish: land, speed_mps: 9}
separation: {distance_m: 60, time_slack_s: 5}
";
const AIRSPACE: &str = "airspace: [{file: zones.geojson}]\n";
const PADS: [[f64; 2]; 4] = [[47.32, 8.43], [47.48, 8.66], [47.32, 8.66], [47.48, 8.43]];
/// How far vehicles come in 60 s at 9 m/s.
const REACH_M: f64 = 540.0;

fn distance_m(a: [f64; 2], b: [f64; 2]) -> f64 {
    (111_320.0 * (a[0] - b[0])).hypot(75_300.0 * (a[1] - b[1]))
}

/// Polygons of these radii in a box of latitude and longitude, apart from each other and from the pads.
fn zones(
    count: usize,
    (south_west, north_east): ([f64; 2], [f64; 2]),
    radii_m: [f64; 2],
) -> String {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut placed: Vec<([f64; 2], f64)> = Vec::new();
    let mut features: Vec<Value> = Vec::new();
    while features.len() < count {
        let at = [0, 1].map(|axis| rng.random_range(south_west[axis]..north_east[axis]));
        let radius_m = rng.random_range(radii_m[0]..radii_m[1]);
        let is_clear = PADS
            .iter()
            .all(|pad| distance_m(*pad, at) > radius_m + 300.0)
            && (placed.iter())
                .all(|(other, wide_m)| distance_m(*other, at) > radius_m + wide_m + 40.0);
        if !is_clear {
            continue;
        }
        let corners = [4_u32, 5, 6, 8, 12][rng.random_range(0..5)];
        let turned = rng.random_range(0.0..std::f64::consts::TAU);
        let corner = |number: u32| {
            let angle =
                turned + std::f64::consts::TAU * f64::from(number % corners) / f64::from(corners);
            let (sin, cos) = angle.sin_cos();
            [
                at[1] + radius_m * cos / 75_300.0,
                at[0] + radius_m * sin / 111_320.0,
            ]
        };
        let ring: Vec<[f64; 2]> = (0..=corners).map(corner).collect();
        let id = format!("z{}", features.len());
        placed.push((at, radius_m));
        features.push(
            json!({"type": "Feature", "properties": {"id": id, "type": "PROHIBITED"},
            "geometry": {"type": "Polygon", "coordinates": [ring]}}),
        );
    }
    json!({"type": "FeatureCollection", "features": features}).to_string()
}

fn planned(folder: &Path, spec: &str, out: &str) -> (Value, Value) {
    fs::write(folder.join("city.yaml"), spec).expect("written");
    let done = sortie(folder, &["plan", "city.yaml", "--out", out]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stdout));
    let read = |name: &str| {
        let bytes = fs::read(folder.join(out).join(name)).expect("a file");
        serde_json::from_slice(&bytes).expect("JSON")
    };
    (read("plan.json"), read("timing.json"))
}

#[test]
fn a_national_feed_of_1200_zones_of_which_few_are_near_does_not_double_the_time_of_a_plan() {
    let folder = tempfile::tempdir().unwrap();
    let country = ([45.8, 6.0], [47.8, 10.5]);
    let feed = zones(1200, country, [300.0, 2500.0]);
    fs::write(folder.path().join("zones.geojson"), feed).unwrap();
    let (_, without) = planned(folder.path(), SPEC, "without");
    let (plan, with) = planned(folder.path(), &format!("{SPEC}{AIRSPACE}"), "with");
    assert_eq!(plan["verdict"], "pass");
    let cpu_s = |timing: &Value| timing["cpu_s"].as_f64().expect("seconds");
    let (without_s, with_s) = (cpu_s(&without), cpu_s(&with));
    assert!(
        with_s < 2.0 * without_s,
        "{with_s} s with zones, {without_s} s without"
    );
}

#[test]
fn the_fence_of_600_zones_fits_and_lists_what_it_leaves_out_with_its_distance() {
    let folder = tempfile::tempdir().unwrap();
    let feed = zones(600, ([47.305, 8.407], [47.495, 8.693]), [40.0, 200.0]);
    fs::write(folder.path().join("zones.geojson"), feed).unwrap();
    let (plan, _) = planned(folder.path(), &format!("{SPEC}{AIRSPACE}"), "with");
    assert_eq!(plan["verdict"], "pass");
    for (index, keeps) in [(0, 70), (1, 64)] {
        let vehicle = &plan["vehicles"][index];
        let id = vehicle["id"].as_str().unwrap();
        let left: &Vec<Value> = vehicle["left_out_of_fence"].as_array().expect("a list");
        assert!(left.len() > 300, "{id}: {}", left.len());
        let distance_m = |of: &Value| of["distance_m"].as_f64().expect("metres");
        assert!(
            left.iter().all(|of| distance_m(of) > REACH_M),
            "{id}: {left:?}"
        );
        let file = fs::read(folder.path().join(format!("with/{id}.plan"))).unwrap();
        let file: Value = serde_json::from_slice(&file).unwrap();
        let fence = &file["geoFence"];
        let polygons = fence["polygons"].as_array().unwrap().iter();
        let corners = polygons
            .map(|of| of["polygon"].as_array().unwrap().len())
            .sum::<usize>();
        let items = corners + fence["circles"].as_array().unwrap().len();
        assert!((5..=keeps).contains(&items), "{id}: {items} items");
    }
}
