//! Maps for others to read: KML and GeoJSON of a small fleet.

use crate::support;

use sortie::formats::{geojson, kml};
use sortie::geodesy::{Amsl, PlanPoint};
use sortie::path::TimedPoint;
use sortie::spec::*;
use sortie::world::World;
use support::{copter, empty_spec, peers, place, world};

fn fleet() -> (MissionSpec, World, Vec<TimedPoint>) {
    let mut spec = empty_spec(vec![copter(
        "alpha & <co>",
        1,
        place(36.25, -84.30),
        place(36.33, -84.20),
    )]);
    spec.threats = vec![Threat {
        id: "radar-1".to_owned(),
        kind: "radar".to_owned(),
        place: place(36.35, -84.32),
        radius_m: 900.0,
    }];
    // Clockwise on purpose.
    let triangle = vec![
        place(36.30, -84.28),
        place(36.31, -84.28),
        place(36.30, -84.27),
    ];
    spec.no_fly = vec![Zone {
        id: "town".to_owned(),
        polygon: triangle,
        ceiling: Some(sortie::spec::Placement::Amsl(Amsl(700.0))),
        ..Zone::default()
    }];
    let world = world(&spec);
    let (start, goal) = (world.sites[0].start, world.sites[0].goal);
    let middle = PlanPoint::new(100.0, 200.0, Amsl(555.5));
    let path = [(start, 16.0), (middle, 400.25), (goal, 800.0)]
        .map(|(point, t_s)| TimedPoint { point, t_s })
        .to_vec();
    (spec, world, path)
}

fn written_geojson() -> serde_json::Value {
    let (spec, world, path) = fleet();
    let text = geojson::write(&spec, &world, &[("alpha & <co>", &path)], 7);
    serde_json::from_str(&text).expect("JSON")
}

fn features(of: &serde_json::Value, kind: &str) -> Vec<serde_json::Value> {
    let all = of["features"].as_array().expect("features");
    all.iter()
        .filter(|feature| feature["properties"]["kind"] == kind)
        .cloned()
        .collect()
}

#[test]
fn geojson_has_heights_above_the_ellipsoid_and_altitudes_above_the_sea_as_a_property() {
    let json = written_geojson();
    assert_eq!(json["type"], "FeatureCollection");
    assert_eq!(features(&json, "area")[0]["properties"]["seed"], 7);
    let path = &features(&json, "path")[0];
    assert_eq!(path["geometry"]["type"], "LineString");
    assert_eq!(
        path["geometry"]["coordinates"][0],
        serde_json::json!([-84.3, 36.25, 449.07])
    );
    assert_eq!(
        path["properties"]["amsl_m"],
        serde_json::json!([480.0, 555.5, 480.0])
    );
    assert_eq!(
        path["properties"]["t_s"],
        serde_json::json!([16.0, 400.25, 800.0])
    );
    assert_eq!(features(&json, "home")[0]["properties"]["amsl_m"], 400.0);
    assert_eq!(
        features(&json, "no_fly")[0]["properties"]["below_amsl_m"],
        700.0
    );
}

#[test]
fn geojson_polygons_are_closed_and_counter_clockwise() {
    let json = written_geojson();
    for kind in ["area", "threat", "no_fly"] {
        let ring = &features(&json, kind)[0]["geometry"]["coordinates"][0];
        let ring: Vec<[f64; 2]> = serde_json::from_value(ring.clone()).expect("pairs");
        assert_eq!(ring.first(), ring.last(), "{kind}");
        let area: f64 = ring
            .windows(2)
            .map(|w| w[0][0] * w[1][1] - w[1][0] * w[0][1])
            .sum();
        assert!(area > 0.0, "{kind} is clockwise");
    }
}

#[test]
fn a_threat_is_drawn_no_smaller_than_it_is() {
    let (_, world, _) = fleet();
    let json = written_geojson();
    let ring = &features(&json, "threat")[0]["geometry"]["coordinates"][0];
    let ring: Vec<[f64; 2]> = serde_json::from_value(ring.clone()).expect("pairs");
    let corners: Vec<_> = ring
        .iter()
        .map(|&[lon, lat]| world.frame.to_plan(place(lat, lon)))
        .collect();
    for two in corners.windows(2) {
        let middle = sortie::geodesy::EastNorth {
            east_m: (two[0].east_m + two[1].east_m) / 2.0,
            north_m: (two[0].north_m + two[1].north_m) / 2.0,
        };
        let nearest_m = middle.distance_m(world.threats[0].center);
        assert!((899.98..901.0).contains(&nearest_m), "{nearest_m} m");
    }
}

#[test]
fn kml_is_escaped_absolute_and_longitude_first() {
    let (spec, world, path) = fleet();
    let text = kml::write(&spec, &world, &[("alpha & <co>", &path)], 7);
    assert!(text.starts_with("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<kml xmlns="));
    assert!(text.contains("<name>alpha &amp; &lt;co&gt; path</name>"));
    assert!(text.contains("<coordinates>-84.3000000,36.2500000,480.00 "));
    assert!(text.contains("<name>radar-1 (radar)</name>"));
    assert!(text.contains("<description>seed 7</description>"));
    let path = &text[text.find("<LineString>").expect("a line")..];
    let path = &path[..path.find("</LineString>").expect("its end")];
    assert!(path.contains("<extrude>1</extrude>") && path.contains("absolute"));
}

#[test]
fn the_schema_of_kml_accepts_it_and_another_reader_finds_the_same_in_it() {
    let Some(python) = peers::python() else {
        return;
    };
    let (spec, world, path) = fleet();
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("fleet.kml");
    std::fs::write(
        &file,
        kml::write(&spec, &world, &[("alpha & <co>", &path)], 7),
    )
    .expect("written");
    let found = peers::run(&python, "read_kml.py", &[&file.display().to_string()]);
    assert_eq!(
        found["folders"],
        serde_json::json!(["Airspace", "alpha & <co>"])
    );
    assert_eq!(
        found["placemarks"],
        serde_json::json!([
            ["area", "Polygon", 5],
            ["radar-1 (radar)", "Polygon", 73],
            ["town", "Polygon", 4],
            ["alpha & <co> path", "LineString", 3],
            ["alpha & <co> home", "Point", 1],
            ["alpha & <co> start", "Point", 1],
            ["alpha & <co> goal", "Point", 1],
        ])
    );
    let [raised, line] = &found["lines"][0].as_array().expect("a line")[..] else {
        panic!("{found:#}");
    };
    assert_eq!(raised, true);
    assert_eq!(line[0], serde_json::json!([-84.3, 36.25, 480.0]));
    assert_eq!(line[1][2], 555.5);
}

#[test]
fn another_reader_finds_rings_and_heights_in_the_geojson_as_its_standard_wants_them() {
    let Some(python) = peers::python() else {
        return;
    };
    let (spec, world, path) = fleet();
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("fleet.geojson");
    let text = geojson::write(&spec, &world, &[("alpha & <co>", &path)], 7);
    std::fs::write(&file, text).expect("written");
    let found = peers::run(&python, "read_geojson.py", &[&file.display().to_string()]);
    assert_eq!(
        found["geometries"],
        serde_json::json!({"Polygon": 3, "Point": 3, "LineString": 1})
    );
    // 480 m above the sea, less the 30.93 m that the geoid lies below the ellipsoid.
    assert_eq!(found["lines"][0][0], true);
    assert_eq!(
        found["lines"][0][1][0],
        serde_json::json!([-84.3, 36.25, 449.07])
    );
}
