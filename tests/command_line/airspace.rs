//! Airspace of files: what `check` lists, and what `convert` writes.

use std::fs;

use crate::support::command::{sortie, text};

const SPEC: &str = "sortie: 1
name: zones
area: {south_west: {lat: 36.2, lon: -84.4}, north_east: {lat: 36.4, lon: -84.1}, min_agl_m: 60, max_amsl_m: 1500}
terrain: {flat: {amsl_m: 400}}
airspace: [{file: feed.json}]
vehicles:
  - {id: alpha, sysid: 1, autopilot: ardupilot, link: sim, start: {lat: 36.25, lon: -84.35, agl_m: 80},
     goal: {lat: 36.35, lon: -84.15, agl_m: 80}, finish: land, speed_mps: 15}
";

/// A national feed of ED-269: 30 boxes in the area, the others in rows to the north of it.
fn feed(zones: usize) -> String {
    let zone = |index: usize| {
        let number = |value: usize| f64::from(u32::try_from(value).expect("a small number"));
        let (lat, lon) = match index {
            0..30 => (36.39, -84.39 + 0.009 * number(index)),
            _ => (
                40.0 + 0.02 * number(index / 40),
                -84.0 + 0.02 * number(index % 40),
            ),
        };
        let corners = [
            (0.0, 0.0),
            (0.005, 0.0),
            (0.005, 0.005),
            (0.0, 0.005),
            (0.0, 0.0),
        ];
        let corners = corners.map(|(x, y)| format!("[{}, {}]", lon + x, lat + y));
        format!(
            r#"{{"identifier": "Z{index}", "restriction": "PROHIBITED", "applicability": [{{"permanent": "YES"}}],
               "geometry": [{{"uomDimensions": "M", "lowerLimit": 0, "lowerVerticalReference": "AGL",
               "horizontalProjection": {{"type": "Polygon", "coordinates": [[{}]]}}}}]}}"#,
            corners.join(", ")
        )
    };
    let zones: Vec<String> = (0..zones).map(zone).collect();
    format!(r#"{{"features": [{}]}}"#, zones.join(",\n"))
}

#[test]
fn check_lists_what_a_feed_holds_and_what_its_fence_needs() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("zones.yaml"), SPEC).unwrap();
    fs::write(folder.path().join("feed.json"), feed(1200)).unwrap();
    let checked = sortie(folder.path(), &["check", "zones.yaml"]);
    let (out, err) = (text(&checked.stdout), text(&checked.stderr));
    assert_eq!(checked.status.code(), Some(0), "{err}");
    assert!(out.contains("30 no-fly zones"), "{out}");
    assert!(
        out.contains("feed.json: 30 zones, 1170 out of reach"),
        "{out}"
    );
    assert!(
        out.contains("\n    Z0\n") && out.contains("and 10 more"),
        "{out}"
    );
    // Four corners of the area, and four of each zone.
    assert!(
        out.contains("fence: needs 124 items, alpha keeps 70 (ArduCopter): zones"),
        "{out}"
    );
}

#[test]
fn a_zone_whose_ceiling_is_under_the_ground_is_warned_of_by_check_and_plan() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("feed.json"), feed(1)).unwrap();
    let of = |ceiling: &str| {
        let zone = format!(
            "zones:\n  - {{id: ctr, circle: {{lat: 36.30, lon: -84.20, radius_m: 400}}, ceiling: {{{ceiling}}}}}\n"
        );
        let spec = SPEC.replace("vehicles:", &format!("{zone}vehicles:"));
        fs::write(folder.path().join("zones.yaml"), spec).unwrap();
        let checked = sortie(folder.path(), &["check", "zones.yaml"]);
        assert_eq!(checked.status.code(), Some(0), "{}", text(&checked.stderr));
        text(&checked.stderr)
    };
    let warning = "warning: zone ctr closes nothing: its ceiling of 120 m above mean sea level is under the ground, which \
                   is at 400 m or more there; is it in feet, or above the ground (agl_m)?";
    assert!(!of("amsl_m: 401").contains("closes nothing"));
    assert!(!of("agl_m: 120").contains("closes nothing"));
    assert!(of("agl_m: 0").contains("closes nothing: its ceiling of 0 m above the ground"));
    let turned = "zone ctr closes nothing: its floor of 100 m above the ground, which is at 400 m or more there, is over \
                  its ceiling of 480 m above mean sea level";
    assert!(of("amsl_m: 480}, floor: {agl_m: 100").contains(turned));
    assert!(!of("amsl_m: 501}, floor: {agl_m: 100").contains("closes nothing"));
    assert!(of("amsl_m: 120").contains(warning));
    let planned = sortie(folder.path(), &["plan", "zones.yaml"]);
    assert!(
        text(&planned.stderr).contains(warning),
        "{}",
        text(&planned.stderr)
    );
}

#[test]
fn names_of_skip_and_only_that_nothing_has_are_warned_of_with_what_was_meant() {
    let folder = tempfile::tempdir().unwrap();
    let feed = feed(3).replace("\"Z2\"", "\"STADIUM NORTH\"");
    fs::write(folder.path().join("feed.json"), feed).unwrap();
    let named = "airspace: [{file: feed.json, skip: [Z1, STADIUM NROTH, fair], only: {class: [PROHIBITD, prohibited]}}]";
    let spec = SPEC.replace("airspace: [{file: feed.json}]", named);
    fs::write(folder.path().join("zones.yaml"), spec).unwrap();
    let checked = sortie(folder.path(), &["check", "zones.yaml"]);
    let (out, err) = (text(&checked.stdout), text(&checked.stderr));
    assert!(
        out.contains("feed.json: 2 zones, 1 left out by only or skip"),
        "{out}"
    );
    for line in [
        "warning: feed.json: nothing in it is `STADIUM NROTH`: did you mean `STADIUM NORTH`?\n",
        "warning: feed.json: nothing in it is `fair`\n",
        "warning: feed.json: nothing in it is `PROHIBITD`: did you mean `PROHIBITED`?\n",
    ] {
        assert!(err.contains(line), "{err}");
    }
    assert_eq!(err.matches("nothing in it").count(), 3, "{err}");
}

#[test]
fn check_counts_a_dome_as_one_threat_and_two_vehicles_keep() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("feed.json"), feed(2)).unwrap();
    let spec = SPEC.replace(
        "vehicles:",
        "threats: [{id: radar, kind: radar, lat: 36.3, lon: -84.3, radius_m: 500, shape: dome},
  {id: crane, kind: mast, lat: 36.31, lon: -84.25, radius_m: 100}]
vehicles:
  - {id: bravo, sysid: 2, autopilot: ardupilot, link: sim, start: {lat: 36.27, lon: -84.35, agl_m: 80},
     goal: {lat: 36.37, lon: -84.15, agl_m: 80}, finish: land, speed_mps: 15}",
    );
    fs::write(folder.path().join("zones.yaml"), spec).unwrap();
    let checked = sortie(folder.path(), &["check", "zones.yaml"]);
    let out = text(&checked.stdout);
    assert!(
        out.contains("2 vehicles, 2 threats, 2 no-fly zones"),
        "{out}"
    );
    assert!(out.contains("bravo and 1 more keep 70"), "{out}");
}

/// A table of powers from 5 to 12 m/s.
#[test]
fn a_table_of_powers_that_does_not_cover_the_planned_speed_is_warned_of() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("feed.json"), feed(1)).unwrap();
    let with = |cruise: &str| {
        let energy =
            format!("speed_mps: 15, endurance: {{energy: {{wh: 500, hover_w: 300{cruise}}}}}}}");
        let spec = SPEC.replace("speed_mps: 15}", &energy);
        fs::write(folder.path().join("zones.yaml"), spec).unwrap();
        let checked = sortie(folder.path(), &["check", "zones.yaml"]);
        assert_eq!(checked.status.code(), Some(0), "{}", text(&checked.stderr));
        text(&checked.stderr)
    };
    let warning = "warning: alpha: 15 m/s is planned, and endurance.energy.cruise covers 0 to 12 m/s; power grows there \
                   with the cube of speed: state a power for it";
    let short = with(", cruise: [[5, 250], [12, 310]]");
    assert!(short.contains(warning), "{short}");
    for cruise in ["", ", cruise: [[5, 250], [15, 400]]"] {
        assert!(!with(cruise).contains("is planned, and"), "{cruise}");
    }
}

#[test]
fn plan_lists_what_the_fence_leaves_out_with_its_distance() {
    let folder = tempfile::tempdir().unwrap();
    let spec = SPEC.replace("speed_mps: 15", "speed_mps: 9, fence_points: 10");
    fs::write(folder.path().join("zones.yaml"), spec).unwrap();
    fs::write(folder.path().join("feed.json"), feed(30)).unwrap();
    let planned = sortie(folder.path(), &["plan", "zones.yaml", "--out", "o"]);
    let out = text(&planned.stdout);
    assert_eq!(planned.status.code(), Some(0), "{out}");
    assert!(
        out.contains("24 of 30 zones and threats are left out"),
        "{out}"
    );
    let plan = fs::read_to_string(folder.path().join("o/plan.json")).unwrap();
    let plan: serde_json::Value = serde_json::from_str(&plan).unwrap();
    let left_out = plan["vehicles"][0]["left_out_of_fence"].as_array().unwrap();
    assert_eq!(left_out.len(), 24);
    let distances: Vec<f64> = left_out
        .iter()
        .map(|zone| zone["distance_m"].as_f64().unwrap())
        .collect();
    assert!(
        distances.is_sorted() && distances[0] > 540.0,
        "{distances:?}"
    );
    let page = fs::read_to_string(folder.path().join("o/review.html")).unwrap();
    let what = left_out[0]["what"].as_str().unwrap();
    assert!(
        page.contains(&format!("{what} left out of the fence")),
        "{what}"
    );
}

#[test]
fn zones_are_converted_with_their_heights() {
    let folder = tempfile::tempdir().unwrap();
    let openair = "AC D\nAN CTR\nAH FL 65\nAL 1000ft AGL\nV X=36:20:00 N 084:12:00 W\nDC 1\n";
    fs::write(folder.path().join("a.txt"), openair).unwrap();
    let converted = sortie(folder.path(), &["convert", "a.txt", "a.geojson"]);
    assert_eq!(
        converted.status.code(),
        Some(0),
        "{}",
        text(&converted.stderr)
    );
    let written = fs::read_to_string(folder.path().join("a.geojson")).unwrap();
    let written: serde_json::Value = serde_json::from_str(&written).unwrap();
    let properties = &written["features"][0]["properties"];
    assert_eq!(properties["ceiling"]["fl"], 65.0);
    assert_eq!(properties["radius_m"], 1852.0);
    // KML has no floors and flight levels: what is lost makes the zone larger, and is said.
    let larger = sortie(folder.path(), &["convert", "a.geojson", "a.kml"]);
    let said = text(&larger.stderr);
    assert_eq!(larger.status.code(), Some(0), "{said}");
    assert!(said.contains("larger: CTR: from the ground"), "{said}");
    assert!(said.contains("larger: CTR: at all heights"), "{said}");
    let back = sortie(folder.path(), &["convert", "a.geojson", "b.txt"]);
    assert_eq!(back.status.code(), Some(0), "{}", text(&back.stderr));
    let again = sortie(folder.path(), &["convert", "b.txt", "b.geojson"]);
    assert_eq!(again.status.code(), Some(0), "{}", text(&again.stderr));
    let refused = sortie(folder.path(), &["convert", "a.txt", "a.shp"]);
    assert_eq!(refused.status.code(), Some(2), "{}", text(&refused.stderr));
}

#[test]
fn values_that_look_like_another_unit_are_warnings() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("feed.json"), feed(1)).unwrap();
    let warned = |spec: &str| {
        fs::write(folder.path().join("zones.yaml"), spec).unwrap();
        let checked = sortie(folder.path(), &["check", "zones.yaml"]);
        let err = text(&checked.stderr);
        assert_eq!(checked.status.code(), Some(0), "{err}");
        err
    };
    let usual = warned(SPEC);
    assert!(!usual.contains("is it in"), "{usual}");
    for (old, new, part) in [
        (
            "max_amsl_m: 1500",
            "max_amsl_m: 4000",
            "area.max_amsl_m: 4000 m is 3520 m above the highest start, goal or stop; is it in feet? Those are 1219 m",
        ),
        (
            "max_amsl_m: 1500",
            "max_amsl_m: 1500, max_agl_m: 400",
            "area.max_agl_m: 400 m; is it in feet? Those are 122 m",
        ),
        (
            "finish: land,",
            "finish: land, max_agl_m: 400,",
            "alpha: max_agl_m: 400 m; is it in feet?",
        ),
        (
            "finish: land,",
            "finish: land, max_climb_deg: 0.25,",
            "alpha: max_climb_deg: 0.25 degrees; is it in radians? Those are 14.3 degrees",
        ),
        (
            "finish: land,",
            "finish: land, max_descent_deg: 0.2,",
            "alpha: max_descent_deg: 0.2 degrees; is it in radians?",
        ),
        (
            "speed_mps: 15",
            "speed_mps: 54",
            "alpha: speed_mps: 54 m/s; is it in km/h? Those are 15.0 m/s",
        ),
    ] {
        let err = warned(&SPEC.replacen(old, new, 1));
        assert!(err.contains(&format!("warning: {part}")), "{part}: {err}");
        assert_eq!(err.matches("is it in").count(), 1, "{err}");
    }
    // Version 2 refuses such a speed, and asks the same.
    let second = SPEC
        .replace("sortie: 1", "sortie: 2")
        .replace("speed_mps: 15", "speed_mps: 54");
    fs::write(folder.path().join("zones.yaml"), second).unwrap();
    let refused = text(&sortie(folder.path(), &["check", "zones.yaml"]).stderr);
    assert!(
        refused.contains("54 m/s: is it in km/h? Those are 15.0 m/s"),
        "{refused}"
    );
}

#[test]
fn zones_with_heights_that_no_fence_has_are_one_note_where_they_are_many() {
    let folder = tempfile::tempdir().unwrap();
    let low = feed(30).replace(
        "\"lowerLimit\": 0",
        "\"upperLimit\": 20, \"upperVerticalReference\": \"AGL\", \"lowerLimit\": 0",
    );
    fs::write(folder.path().join("feed.json"), low).unwrap();
    fs::write(
        folder.path().join("zones.yaml"),
        SPEC.replace("speed_mps: 15", "speed_mps: 9"),
    )
    .unwrap();
    let planned = sortie(folder.path(), &["plan", "zones.yaml", "--out", "o"]);
    let out = text(&planned.stdout);
    assert_eq!(planned.status.code(), Some(0), "{out}");
    assert!(
        out.contains("alpha: 30 zones have a height, a time or holes"),
        "{out}"
    );
    assert!(
        out.contains("not in the fence: Z0, Z1, ") && out.contains(", Z29"),
        "{out}"
    );
    assert_eq!(out.matches("not in the fence").count(), 1, "{out}");
}

/// What the spec itself has exchanged is refused; a feed may hold what is far away, so `plan` warns.
#[test]
fn a_feed_that_would_be_in_the_area_with_its_coordinates_exchanged_is_warned_of() {
    let folder = tempfile::tempdir().unwrap();
    let warned = |feed: &str| {
        fs::write(folder.path().join("zones.yaml"), SPEC).unwrap();
        fs::write(folder.path().join("feed.json"), feed).unwrap();
        let planned = sortie(
            folder.path(),
            &["plan", "zones.yaml", "--evaluations", "100"],
        );
        assert_eq!(planned.status.code(), Some(0));
        text(&planned.stderr)
    };
    let box_at = |corners: [[f64; 2]; 4]| {
        format!(
            r#"{{"type": "FeatureCollection", "features": [{{"type": "Feature", "properties": {{"id": "town"}},
               "geometry": {{"type": "Polygon", "coordinates": [[{:?}, {:?}, {:?}, {:?}, {:?}]]}}}}]}}"#,
            corners[0], corners[1], corners[2], corners[3], corners[0]
        )
    };
    let corners = [
        [-84.21, 36.39],
        [-84.2, 36.39],
        [-84.2, 36.395],
        [-84.21, 36.395],
    ];
    assert!(!warned(&box_at(corners)).contains("warning: feed.json"));
    let said = warned(&box_at(corners.map(|[lon, lat]| [lat, lon])));
    assert!(
        said.contains("warning: feed.json: 1 out of reach would be in the area with latitude and longitude exchanged"),
        "{said}"
    );
    let said = warned(r#"{"type": "FeatureCollection", "features": []}"#);
    assert!(
        said.contains("warning: feed.json: no zone or obstacle is in it"),
        "{said}"
    );
}

#[test]
fn lines_and_points_that_are_restrictions_are_not_missing_without_a_word() {
    let feature = |properties: &str, geometry: &str| {
        format!(
            r#"{{"type": "Feature", "properties": {{{properties}}}, "geometry": {{{geometry}}}}}"#
        )
    };
    let line =
        r#""type": "LineString", "coordinates": [[-84.3, 36.25], [-84.3, 36.35]]"#.to_owned();
    let point = |lat: f64| format!(r#""type": "Point", "coordinates": [-84.25, {lat}]"#);
    let features = [
        feature(r#""id": "LINE", "type": "PROHIBITED""#, &line),
        feature(r#""id": "PIN", "type": "prohibited""#, &point(36.3)),
        feature(r#""id": "HIGH", "ceiling": {"amsl_m": 500}"#, &line),
        feature(r#""id": "FAR", "type": "PROHIBITED""#, &point(37.3)),
        feature(r#""id": "ROAD", "type": "road""#, &line),
        feature(
            r#""id": "DISC", "type": "PROHIBITED", "radius": 300"#,
            &point(36.3),
        ),
    ];
    let features = features.join(",\n");
    let file = format!(r#"{{"type": "FeatureCollection", "features": [{features}]}}"#);
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("feed.json"), file).unwrap();
    fs::write(folder.path().join("zones.yaml"), SPEC).unwrap();
    let checked = sortie(folder.path(), &["check", "zones.yaml"]);
    let err = text(&checked.stderr);
    assert_eq!(checked.status.code(), Some(3), "{err}");
    let why = "cannot be a zone: a restriction that is a";
    for name in ["LINE", "PIN", "HIGH"] {
        assert!(err.contains(&format!("`{name}` {why}")), "{err}");
    }
    assert_eq!(err.matches("cannot be a zone").count(), 3, "{err}");
    let skip = "{file: feed.json, skip: [LINE, PIN, HIGH]}";
    let spec = SPEC.replace("{file: feed.json}", skip);
    fs::write(folder.path().join("zones.yaml"), spec).unwrap();
    let checked = sortie(folder.path(), &["check", "zones.yaml"]);
    let (out, err) = (text(&checked.stdout), text(&checked.stderr));
    assert_eq!(checked.status.code(), Some(0), "{err}");
    let listed =
        "feed.json: 1 zones, 1 out of reach, 3 left out by only or skip, 1 lines and points";
    assert!(out.contains(listed), "{out}");
    assert!(out.contains("DISC"), "{out}");
}

#[test]
fn a_symmetric_bow_tie_is_said_to_cross_itself() {
    let folder = tempfile::tempdir().unwrap();
    let zone = |polygon: &str| {
        let zones = format!("zones: [{{id: z, polygon: {polygon}}}]");
        fs::write(
            folder.path().join("zones.yaml"),
            SPEC.replace("airspace: [{file: feed.json}]", &zones),
        )
        .unwrap();
        text(&sortie(folder.path(), &["check", "zones.yaml"]).stderr)
    };
    let bow_tie = zone("[[36.30, -84.30], [36.31, -84.29], [36.30, -84.29], [36.31, -84.30]]");
    let why = "the edge from corner 2 to 3 meets the edge from corner 0 to 1";
    assert!(bow_tie.contains(why), "{bow_tie}");
    assert!(!bow_tie.contains("without area"), "{bow_tie}");
    let flat = zone("[[36.300, -84.30], [36.301, -84.30], [36.302, -84.30]]");
    assert!(flat.contains("a polygon without area"), "{flat}");
}

#[test]
fn every_row_of_obstacles_that_is_wrong_is_named_up_to_ten() {
    let folder = tempfile::tempdir().unwrap();
    let spec = SPEC.replace(
        "airspace: [{file: feed.json}]",
        "obstacles: [{file: masts.csv}]",
    );
    fs::write(folder.path().join("zones.yaml"), spec).unwrap();
    for (wrong, more) in [(7, None), (13, Some("3 more rows that are wrong"))] {
        let rows = "36.3,-84.2,high\n".repeat(wrong);
        let table = format!("lat,lon,height_m\n36.3,-84.2,40\n{rows}");
        let said = |table: &str| {
            fs::write(folder.path().join("masts.csv"), table).unwrap();
            text(&sortie(folder.path(), &["check", "zones.yaml"]).stderr)
        };
        let err = said(&table);
        assert_eq!(said(&table.replace('\n', "\r\n")), err);
        for line in 3..3 + wrong.min(10) {
            let named = format!("line {line}: `high` is no number");
            assert!(err.contains(&named), "{err}");
        }
        assert_eq!(err.matches("is no number").count(), wrong.min(10), "{err}");
        assert!(more.is_none_or(|more| err.contains(more)), "{err}");
    }
}
