//! Obstacles of files: lines between masts, and buildings.

use std::fs;

use sortie::geodesy::{Amsl, LatLon, PlanPoint};
use sortie::{Limit, Mission, Review};

fn failed(review: &Review) -> Vec<&Limit> {
    let margins = review.margins.iter();
    let failed = margins.filter(|margin| !margin.ok);
    failed.map(|margin| &margin.limit).collect()
}

/// A flight of 2.3 km to the east over flat ground, up to 20 m lower than its ends.
fn spec(agl_m: f64, obstacles: &str) -> String {
    let min_m = agl_m - 20.0;
    format!(
        "sortie: 2
name: line
area: {{south_west: {{lat: 46.99, lon: 7.97}}, north_east: {{lat: 47.01, lon: 8.03}}, min_agl_m: {min_m}, max_amsl_m: 700}}
terrain: {{flat: {{amsl_m: 400}}}}
{obstacles}
planner: {{evaluations: 1000}}
vehicles:
  - {{id: alpha, sysid: 1, autopilot: ardupilot, link: sim, speed_mps: 9, finish: land,
     start: {{lat: 47.0, lon: 7.985, agl_m: {agl_m}}}, goal: {{lat: 47.0, lon: 8.015, agl_m: {agl_m}}}}}
"
    )
}

/// The verdict on a straight flight, planned without the obstacles, against the spec that has them.
fn judged(agl_m: f64, features: &str) -> Review {
    let folder = tempfile::tempdir().expect("a folder");
    let collection = format!(r#"{{"type":"FeatureCollection","features":[{features}]}}"#);
    fs::write(folder.path().join("lines.geojson"), collection).expect("written");
    let straight = Mission::parse(folder.path(), spec(agl_m, "")).expect("a good spec");
    let planned = sortie::plan(&straight);
    assert!(planned.review.passes(), "{:?}", failed(&planned.review));
    let named = "obstacles: [{file: lines.geojson}]";
    let among = Mission::parse(folder.path(), spec(agl_m, named)).expect("a good spec");
    sortie::verify(&among, &planned.missions)
}

/// A line of 40 m from north to south across the flight; its masts stand 220 m to either side.
const LINE: &str = r#"{"type":"Feature","properties":{"id":"110 kV","heights_m":[35,40,30]},
  "geometry":{"type":"LineString","coordinates":[[8.0,47.006],[8.0,47.002],[8.0,46.998]]}}"#;

#[test]
fn a_flight_through_a_line_between_two_masts_fails_and_one_over_it_passes() {
    let through = judged(30.0, LINE);
    assert!(!through.passes());
    let found = failed(&through);
    let span = Limit::Zone("110 kV span 2".to_owned());
    assert!(found.contains(&&span), "{found:?}");
    assert_eq!(failed(&judged(80.0, LINE)), Vec::<&Limit>::new());
}

#[test]
fn a_flight_through_a_building_fails_and_one_over_it_passes() {
    let building = r#"{"type":"Feature","properties":{"name":"tower","height_m":40},"geometry":{"type":"Polygon",
      "coordinates":[[[7.999,46.9995],[8.001,46.9995],[8.001,47.0005],[7.999,47.0005],[7.999,46.9995]]]}}"#;
    let through = judged(30.0, building);
    let found = failed(&through);
    assert!(
        found.contains(&&Limit::Zone("tower".to_owned())),
        "{found:?}"
    );
    assert_eq!(failed(&judged(80.0, building)), Vec::<&Limit>::new());
}

/// Masts of 30 m on two summits of some 300 m over a valley, and a hill of 150 m between others.
#[test]
fn a_line_hangs_between_its_tops_over_a_valley_and_follows_a_hill() {
    let spec = "sortie: 2
name: valley
area: {south_west: {lat: 46.98, lon: 7.97}, north_east: {lat: 47.02, lon: 8.03}, min_agl_m: 10, max_amsl_m: 2000}
terrain: {analytic: {base_amsl_m: 100, hills: [{lat: 47.01, lon: 7.99, height_m: 300, radius_m: 300},
  {lat: 47.01, lon: 8.01, height_m: 200, radius_m: 300}, {lat: 46.985, lon: 8, height_m: 150, radius_m: 200}]}}
obstacles: [{file: lines.geojson}]
vehicles:
  - {id: alpha, sysid: 1, autopilot: ardupilot, link: sim, speed_mps: 9, finish: land,
     start: {lat: 46.995, lon: 7.975, agl_m: 80}, goal: {lat: 46.995, lon: 8.025, agl_m: 80}}
";
    let features = r#"{"type":"FeatureCollection","features":[
      {"type":"Feature","properties":{"id":"a","height_m":30,"radius_m":20},
       "geometry":{"type":"LineString","coordinates":[[7.99,47.01],[8.01,47.01]]}},
      {"type":"Feature","properties":{"id":"b","height_m":30},
       "geometry":{"type":"LineString","coordinates":[[7.99,46.985],[8.01,46.985]]}}]}"#;
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("lines.geojson"), features).expect("written");
    let mission = Mission::parse(folder.path(), spec).expect("a good spec");
    let world = mission.world();
    let limits = world.without_buffers(mission.spec());
    let is_closed = |lat_deg: f64, lon_deg: f64, amsl_m: f64| {
        let place = LatLon { lat_deg, lon_deg };
        let ground_m = world.terrain.height(place).expect("ground").0;
        let point = PlanPoint {
            at: world.frame.to_plan(place),
            amsl: Amsl(amsl_m),
        };
        let mut zones = limits.zones.iter();
        zones.any(|zone| zone.is_closed_at(point, ground_m, f64::NAN))
    };
    // Over the valley floor of 100 m, between tops of 430 and 330 m.
    assert!(is_closed(47.01, 8.0, 380.0));
    assert!(is_closed(47.01, 8.0, 429.0));
    assert!(!is_closed(47.01, 8.0, 431.0));
    // 20 m to a side, 30 m at the ends, not more.
    let metre_deg = 1.0 / 111_200.0;
    assert!(is_closed(47.01 + 19.0 * metre_deg, 8.0, 380.0));
    assert!(!is_closed(47.01 + 21.5 * metre_deg, 8.0, 380.0));
    // The summit between the masts of the other line is higher than both tops.
    assert!(is_closed(46.985, 8.0, 279.0));
    assert!(!is_closed(46.985, 8.0, 281.0));
    assert!(!is_closed(46.985, 7.992, 131.0));
}

#[test]
fn obstacles_that_cannot_be_read_are_refused_by_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let line = |properties: &str, coordinates: &str| {
        format!(
            r#"{{"type":"Feature","properties":{{"id":"x",{properties}}},"geometry":{{"type":"LineString","coordinates":[{coordinates}]}}}}"#
        )
    };
    let short = "[8.0,47.0],[8.0,47.001]";
    let square = r#"{"type":"Feature","properties":{"id":"y","height_m":20,"radius_m":5},"geometry":{"type":"Polygon",
      "coordinates":[[[8.0,47.0],[8.001,47.0],[8.001,47.001],[8.0,47.0]]]}}"#;
    let crossed = r#"{"type":"Feature","properties":{"id":"z","height_m":20},"geometry":{"type":"Polygon",
      "coordinates":[[[8.0,47.0],[8.002,47.001],[8.001,47.0],[8.0,47.003],[8.0,47.0]]]}}"#;
    for (feature, why) in [
        (line(r#""voltage":110"#, short), "x span 1: no height_m"),
        (
            line(r#""heights_m":[30]"#, short),
            "x: 1 heights_m of 2 vertices",
        ),
        (line(r#""heights_m":[30,0]"#, short), "x span 1: height_m 0"),
        (
            line(r#""height_m":30,"radius_m":0.5"#, short),
            "radius_m 0.5",
        ),
        (
            line(r#""height_m":30"#, "[8.0,47.0],[8.0,47.1]"),
            "x span 1: 11117 m long",
        ),
        (square.to_owned(), "radius_m of a polygon"),
        (crossed.to_owned(), "`z`: the edge"),
    ] {
        let collection = format!(r#"{{"type":"FeatureCollection","features":[{feature}]}}"#);
        fs::write(folder.path().join("lines.geojson"), collection).expect("written");
        let named = "obstacles: [{file: lines.geojson}]";
        let error = Mission::parse(folder.path(), spec(30.0, named)).expect_err(why);
        let error = error.to_string();
        assert!(
            error.contains("obstacles[0].file") && error.contains(why),
            "{why}: {error}"
        );
    }
}

#[test]
fn a_misspelt_column_of_a_table_names_the_one_that_was_meant() {
    let folder = tempfile::tempdir().expect("a folder");
    let named = "obstacles: [{file: masts.csv}]";
    let read = |table: &str| {
        fs::write(folder.path().join("masts.csv"), table).expect("written");
        Mission::parse(folder.path(), spec(60.0, named)).map_err(|error| error.to_string())
    };
    for (table, why) in [
        (
            "lat,lon,heigth_m\n47.005,8,30\n",
            "column `heigth_m`: did you mean `height_m`?",
        ),
        (
            "lat,lon,height_m,radius\n47.005,8,30,90\n",
            "column `radius`: did you mean `radius_m`?",
        ),
        ("lat,height_m\n47.005,30\n", "no column lon"),
    ] {
        let error = read(table).expect_err(why);
        assert!(error.contains(why), "{error}");
    }
    let fine = read("lat,lon,height_m,radius_m,height,voltage\n47.005,8,30,9,1,2\n");
    assert_eq!(fine.expect("a good table").spec().no_fly.len(), 1);
}
