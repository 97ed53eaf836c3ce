//! Files of every format, as their publishers lay them out.

mod lost;

use super::{Collection, Format, Geometry, Height, Shape, read, write, write_as};
use crate::geodesy::{LatLon, LocalFrame};

fn shapes(name: &str, text: &str) -> Collection {
    read(name, text.as_bytes()).expect("a file that can be read")
}

fn named<'c>(collection: &'c Collection, name: &str) -> &'c Shape {
    let mut shapes = collection.shapes.iter();
    let found = shapes.find(|shape| shape.name == name);
    found.unwrap_or_else(|| panic!("no {name} in {collection:#?}"))
}

fn refused(collection: &Collection) -> Vec<&str> {
    let names = collection.refused.iter().map(|of| of.name.as_str());
    names.collect()
}

/// Laid out as EUROCAE ED-269 has it: `geometry` is a list, limits have units and references.
const ED269: &str = r#"{"title": "zones", "features": [
  {"identifier": "LFR001", "country": "FRA", "name": "depot", "type": "COMMON", "restriction": "PROHIBITED",
   "applicability": [{"permanent": "NO", "startDateTime": "2026-12-01T08:00:00Z", "endDateTime": "2026-12-01T10:00:00Z"},
                     {"permanent": "NO", "startDateTime": "2026-12-03T08:00:00Z", "endDateTime": "2026-12-03T10:00:00Z"}],
   "geometry": [{"uomDimensions": "FT", "lowerLimit": 0, "lowerVerticalReference": "AGL", "upperLimit": 1000,
     "upperVerticalReference": "AMSL", "horizontalProjection": {"type": "Circle", "center": [2.5, 48.5], "radius": 1000}}]},
  {"identifier": "LFR002", "restriction": "REQ_AUTHORISATION", "applicability": [{"permanent": "YES"}],
   "geometry": [{"uomDimensions": "M", "lowerLimit": 50, "lowerVerticalReference": "AGL", "upperLimit": 150,
     "upperVerticalReference": "AGL", "horizontalProjection": {"type": "Polygon",
       "coordinates": [[[2.0, 48.0], [2.1, 48.0], [2.1, 48.1], [2.0, 48.0]]]}}]},
  {"identifier": "LFR003", "restriction": "NO_RESTRICTION", "geometry": []},
  {"identifier": "LFR004", "restriction": "PROHIBITED", "geometry": [{"uomDimensions": "M", "lowerLimit": 5,
     "horizontalProjection": {"type": "Circle", "center": [2.5, 48.5], "radius": 10}}]}
]}"#;

#[test]
fn ed_269_has_units_references_and_times_and_what_lacks_one_is_refused_by_name() {
    let found = shapes("zones.json", ED269);
    let depot = named(&found, "LFR001");
    assert_eq!(
        (depot.floor, depot.ceiling),
        (None, Some(Height::Amsl(304.8)))
    );
    let Geometry::Circle { radius_m, .. } = depot.geometry else {
        panic!("{depot:?}")
    };
    // Its unit is that of its limits.
    assert!((radius_m - 1000.0).abs() < 1e-9);
    let time = |text: &str| Some(text.parse().expect("a time"));
    // Two periods count as one that holds both.
    let active = (time("2026-12-01T08:00:00Z"), time("2026-12-03T10:00:00Z"));
    assert_eq!(depot.active, active);
    let other = named(&found, "LFR002");
    assert_eq!(
        (other.floor, other.ceiling),
        (Some(Height::Agl(50.0)), Some(Height::Agl(150.0)))
    );
    assert_eq!(other.active, (None, None));
    assert_eq!((found.unrestricted, refused(&found)), (1, vec!["LFR004"]));
}

/// Laid out as EUROCAE ED-318 has it: GeoJSON whose geometries have a layer, and circles an extent.
const ED318: &str = r#"{"type": "FeatureCollection", "features": [
  {"type": "Feature", "properties": {"identifier": "DAR0001", "country": "GEO", "type": "PROHIBITED",
     "name": [{"lang": "en-GB", "text": "Dynamic restriction"}],
     "limitedApplicability": [{"startDateTime": "2026-10-02T12:00:00Z", "endDateTime": "2026-10-02T14:00:00Z"}]},
   "geometry": {"type": "Point", "coordinates": [44.69, 41.70], "extent": {"subType": "Circle", "radius": 2000},
     "layer": {"lower": 0, "lowerReference": "AGL", "upper": 400, "upperReference": "AMSL", "uom": "ft"}}},
  {"type": "Feature", "properties": {"identifier": "ELL", "type": "CONDITIONAL"},
   "geometry": {"type": "Polygon", "coordinates": [[[149.16, -35.37], [149.17, -35.37], [149.17, -35.36], [149.16, -35.37]]],
     "layer": {"lower": 603.44, "lowerReference": "WGS84", "upper": 900, "upperReference": "QFE", "uom": "m"}}}
]}"#;

#[test]
fn ed_318_is_geojson_with_layers_and_extents() {
    let found = shapes("zones.geojson", ED318);
    let zone = named(&found, "DAR0001");
    let Geometry::Circle { center, radius_m } = zone.geometry else {
        panic!("{zone:?}")
    };
    assert_eq!(
        (center.lat_deg, center.lon_deg, radius_m),
        (41.70, 44.69, 2000.0)
    );
    assert_eq!(zone.ceiling, Some(Height::Amsl(121.92)));
    assert_eq!(zone.classes, ["PROHIBITED"]);
    assert!(zone.active.0.is_some());
    assert_eq!(refused(&found), ["ELL"]);
}

#[test]
fn openaip_and_plain_geojson_keep_their_heights_and_their_holes() {
    let text = r#"{"type": "FeatureCollection", "features": [
      {"type": "Feature", "properties": {"name": "CTR", "icaoClass": 3,
         "lowerLimit": {"value": 0, "unit": 1, "referenceDatum": 0}, "upperLimit": {"value": 65, "unit": 6, "referenceDatum": 2}},
       "geometry": {"type": "Polygon", "coordinates": [[[8, 47], [9, 47], [9, 48], [8, 48], [8, 47]],
         [[8.4, 47.4], [8.6, 47.4], [8.5, 47.6], [8.4, 47.4]]]}},
      {"type": "Feature", "properties": {"name": "plain"},
       "geometry": {"type": "MultiPolygon", "coordinates": [[[[8, 47], [9, 47], [9, 48], [8, 47]]], [[[1, 1], [2, 1], [2, 2], [1, 1]]]]}}
    ]}"#;
    let found = shapes("a.geojson", text);
    let zone = named(&found, "CTR");
    assert_eq!(
        (zone.floor, zone.ceiling),
        (None, Some(Height::FlightLevel(65.0)))
    );
    assert_eq!(zone.classes, ["D"]);
    let Geometry::Polygon { outer, holes } = &zone.geometry else {
        panic!("{zone:?}")
    };
    assert_eq!((outer.len(), holes.len(), holes[0].len()), (4, 1, 3));
    assert_eq!(named(&found, "plain polygon 2").ceiling, None);
}

/// Records as the OpenAir documents show them: a circle, an arc between two places, one by angles.
const OPENAIR: &str = "* a comment
AC D
AN BUOCHS CTR
AH 3000ft MSL
AL GND
V X=46:58:27 N 008:23:48 E
DC 2.5

AC R
AN LS-R1
AH FL 120
AL 1500ft AGL
V D=+
V X=47:00:00 N 008:00:00 E
DA 5,0,90
DP 47:00:00 N 008:00:00 E

AC C
AN BROKEN
AH 3000ft MSL
AL GND
DP 99:00:00 N 008:00:00 E

AC C
AN AFTER
AH UNL
AL 500m MSL
DP 47:00:00 N 008:00:00 E
DP 47:10:00 N 008:00:00 E
DP 47:10:00 N 008:10:00 E
";

#[test]
fn openair_has_miles_feet_and_arcs_and_a_broken_airspace_spoils_no_other() {
    let found = shapes("airspace.txt", OPENAIR);
    assert_eq!(refused(&found), ["BROKEN"]);
    let Geometry::Circle { radius_m, center } = named(&found, "BUOCHS CTR").geometry else {
        panic!("{found:?}")
    };
    assert!((radius_m - 4630.0).abs() < 1e-3);
    assert!((center.lat_deg - (46.0 + 58.0 / 60.0 + 27.0 / 3600.0)).abs() < 1e-9);
    let sector = named(&found, "LS-R1");
    assert_eq!(
        (sector.floor, sector.ceiling),
        (
            Some(Height::Agl(1500.0 * 0.3048)),
            Some(Height::FlightLevel(120.0))
        )
    );
    let Geometry::Polygon { outer, .. } = &sector.geometry else {
        panic!("{sector:?}")
    };
    let frame = LocalFrame::new(LatLon {
        lat_deg: 47.0,
        lon_deg: 8.0,
    });
    let away: Vec<f64> = outer
        .iter()
        .map(|at| {
            let at = frame.to_plan(*at);
            assert!(at.east_m > -1.0 && at.north_m > -1.0, "{at:?}");
            at.east_m.hypot(at.north_m)
        })
        .collect();
    let corners = away.len();
    // A quarter of a circle of 5 miles, no corner inside of it, none far outside.
    assert!(
        corners > 20
            && away[..corners - 1]
                .iter()
                .all(|m| (9259.9..9265.0).contains(m)),
        "{away:?}"
    );
    let after = named(&found, "AFTER");
    assert_eq!(after.ceiling, None);
    let Some(Height::Amsl(floor_m)) = after.floor else {
        panic!("{after:?}")
    };
    // The crate keeps whole feet.
    assert!((floor_m - 500.0).abs() < 0.16, "{floor_m}");
}

#[test]
fn kml_polygons_reach_up_where_they_are_extruded() {
    let text = r#"<?xml version="1.0"?><kml xmlns="http://www.opengis.net/kml/2.2"><Document><Folder>
      <Placemark><name>box</name><Polygon><extrude>1</extrude><altitudeMode>relativeToGround</altitudeMode>
        <outerBoundaryIs><LinearRing><coordinates>8,47,120 9,47,120 9,48,120 8,47,120</coordinates></LinearRing></outerBoundaryIs>
        <innerBoundaryIs><LinearRing><coordinates>8.7,47.2,0 8.8,47.2,0 8.8,47.3,0 8.7,47.2,0</coordinates></LinearRing></innerBoundaryIs>
      </Polygon></Placemark>
      <Placemark><name>flat</name><Polygon><outerBoundaryIs><LinearRing><coordinates>8,47 9,47 9,48 8,47</coordinates></LinearRing></outerBoundaryIs></Polygon></Placemark>
      <Placemark><name>pin</name><Point><coordinates>8,47</coordinates></Point></Placemark>
    </Folder></Document></kml>"#;
    let found = shapes("a.kml", text);
    assert_eq!(named(&found, "box").ceiling, Some(Height::Agl(120.0)));
    let Geometry::Polygon { holes, .. } = &named(&found, "box").geometry else {
        panic!("{found:?}")
    };
    assert_eq!(holes.len(), 1);
    assert_eq!(named(&found, "flat").ceiling, None);
    assert!(matches!(named(&found, "pin").geometry, Geometry::Point(_)));
}

/// A good placemark, one above the sea floor, and a comment with the name of a placemark.
const SEA: &str = r#"<?xml version="1.0"?><kml xmlns="http://www.opengis.net/kml/2.2"><Document>
<!-- <Placemark> -->
<Placemark><name>sea</name><Polygon><gx:altitudeMode xmlns:gx="x">MODE</gx:altitudeMode><outerBoundaryIs><LinearRing>
<coordinates>8,47,5 8.01,47,5 8.01,47.01,5 8,47,5</coordinates></LinearRing></outerBoundaryIs></Polygon></Placemark>
<Placemark><name>good</name><Polygon><outerBoundaryIs><LinearRing>
<coordinates>8,47 8.01,47 8.01,47.01 8,47</coordinates></LinearRing></outerBoundaryIs></Polygon></Placemark>
</Document></kml>"#;

#[test]
fn a_placemark_of_kml_that_cannot_be_read_is_refused_by_name_and_line_and_others_are_read() {
    for mode in ["clampToSeaFloor", "relativeToSeaFloor"] {
        let found = shapes("a.kml", &SEA.replace("MODE", mode));
        assert_eq!(found.refused.len(), 1, "{found:?}");
        assert_eq!(found.refused[0].name, "sea");
        assert!(found.refused[0].why.starts_with("line 3: "), "{found:?}");
        assert!(found.refused[0].why.contains(mode), "{found:?}");
        let names: Vec<&str> = found.shapes.iter().map(|of| of.name.as_str()).collect();
        assert_eq!(names, ["good"]);
    }
    // What is broken outside of placemarks is not guessed at.
    let broken = SEA
        .replace("MODE", "clampToSeaFloor")
        .replace("</Document>", "</Folder");
    assert!(read("a.kml", broken.as_bytes()).is_err());
}

#[test]
fn openair_without_a_height_is_closed_at_all_heights() {
    let corners =
        "DP 50:00:00 N 010:40:00 E\nDP 50:01:00 N 010:40:00 E\nDP 50:01:00 N 010:41:00 E\n";
    let text = format!(
        "AC P\nAN none\n{corners}AC P\nAN low\nAH 1000ft MSL\n{corners}AC P\nAN high\nAL FL 65\n{corners}"
    );
    let found = shapes("a.txt", &text);
    let heights = |name| (named(&found, name).floor, named(&found, name).ceiling);
    assert_eq!(heights("none"), (None, None));
    assert_eq!(heights("low"), (None, Some(Height::Amsl(304.8))));
    assert_eq!(heights("high"), (Some(Height::FlightLevel(65.0)), None));
}

#[test]
fn fences_of_plans_and_lists_are_inclusions_and_exclusions() {
    let plan = r#"{"geoFence": {"version": 2, "circles": [{"circle": {"center": [47, 8], "radius": 50}, "inclusion": false, "version": 1}],
      "polygons": [{"polygon": [[47, 8], [47.1, 8], [47.1, 8.1]], "inclusion": true, "version": 1}]}}"#;
    let found = shapes("a.plan", plan);
    assert!(named(&found, "fence polygon 1").keep_in);
    assert!(!named(&found, "fence circle 1").keep_in);
    let rows = "QGC WPL 110\n0\t1\t0\t5002\t3\t0\t0\t0\t47\t8\t0\t1\n1\t0\t0\t5002\t3\t0\t0\t0\t47.1\t8\t0\t1\n2\t0\t0\t5002\t3\t0\t0\t0\t47.1\t8.1\t0\t1\n3\t0\t0\t5004\t25\t0\t0\t0\t47\t8\t0\t1\n";
    let found = shapes("a.waypoints", rows);
    assert_eq!(found.shapes.len(), 2, "{found:?}");
    assert!(found.refused.is_empty());
}

#[test]
fn what_is_written_reads_as_the_same_shapes() {
    for (name, text) in [("a.json", ED269), ("a.geojson", ED318), ("a.txt", OPENAIR)] {
        let shapes = shapes(name, text).shapes;
        let again = read("b.geojson", write(&shapes).as_bytes()).expect("good");
        for (one, other) in shapes.iter().zip(&again.shapes) {
            let pair = (&one.name, &one.geometry, one.floor, one.ceiling, one.active);
            let read = (
                &other.name,
                &other.geometry,
                other.floor,
                other.ceiling,
                other.active,
            );
            assert_eq!(pair, read);
        }
        assert_eq!(shapes.len(), again.shapes.len());
    }
}

#[test]
fn a_file_of_another_kind_is_an_error() {
    for (name, text) in [
        ("a.png", "x"),
        ("a.json", "x"),
        ("a.kml", "<x"),
        ("a.txt", "hello"),
        ("a.kmz", "x"),
        ("a.plan", "{}"),
    ] {
        assert!(read(name, text.as_bytes()).is_err(), "{name}");
    }
}

fn corner(lat_deg: f64, lon_deg: f64) -> LatLon {
    LatLon { lat_deg, lon_deg }
}

/// A polygon with a hole, a circle, and a zone to stay in.
fn to_write() -> [Shape; 3] {
    let shape = |name: &str, geometry| Shape {
        name: name.to_owned(),
        classes: vec!["R".to_owned()],
        geometry,
        floor: Some(Height::Amsl(100.3)),
        ceiling: Some(Height::Agl(120.1)),
        active: (None, None),
        keep_in: false,
        numbers: Vec::new(),
        lists: Vec::new(),
    };
    let hole = [(47.06, -8.15), (47.07, -8.15), (47.07, -8.14)];
    let outer = [(47.0, -8.2), (47.1, -8.2), (47.1, -8.1)];
    let ring = |corners: [(f64, f64); 3]| corners.map(|(lat, lon)| corner(lat, lon)).to_vec();
    let polygon = Geometry::Polygon {
        outer: ring(outer),
        holes: vec![ring(hole)],
    };
    let circle = Geometry::Circle {
        center: corner(-33.9, 151.2),
        radius_m: 777.7,
    };
    let keep = Shape {
        keep_in: true,
        ..shape("stay", circle.clone())
    };
    [shape("a<b&c", polygon), shape("disc", circle), keep]
}

#[test]
fn heights_of_openair_in_metres_are_not_rounded_to_feet() {
    let text = "AC R\nAN low\nAL 152m AMSL\nAH 1501 M AGL\nDP 47:00:00 N 008:00:00 E\n\
                DP 47:10:00 N 008:00:00 E\nDP 47:10:00 N 008:10:00 E\n";
    let read = shapes("x.txt", text);
    let low = named(&read, "low");
    assert_eq!(low.floor, Some(Height::Amsl(152.0)));
    assert_eq!(low.ceiling, Some(Height::Agl(1501.0)));
}

#[test]
fn a_height_of_openair_that_cannot_be_read_is_quoted_as_it_stands() {
    let text = "AC D\nAN TMA\nAH 12 parsecs\nAL GND\nV X=47:00:00 N 008:00:00 E\nDC 1\n";
    let found = shapes("x.txt", text);
    assert_eq!(found.refused.len(), 1, "{found:?}");
    let why = "a height `12 parsecs` that cannot be read";
    assert_eq!(
        (
            found.refused[0].name.as_str(),
            found.refused[0].why.as_str()
        ),
        ("TMA", why)
    );
}

#[test]
fn zones_in_openair_are_no_smaller_and_what_is_lost_is_said() {
    let all = to_write();
    let openair = write_as(Format::OpenAir, &all);
    let lost = ("a<b&c".to_owned(), "without its holes: OpenAir has none");
    assert_eq!((openair.enlarged, openair.left_out.len()), (vec![lost], 1));
    let read_back = shapes("x.txt", &openair.text);
    let ring = named(&read_back, "a<b&c");
    assert_eq!(ring.floor, Some(Height::Amsl(329.0 * 0.3048)));
    assert_eq!(ring.ceiling, Some(Height::Agl(395.0 * 0.3048)));
    let (Geometry::Polygon { outer: was, .. }, Geometry::Polygon { outer: is, holes }) =
        (&all[0].geometry, &ring.geometry)
    else {
        panic!("{ring:?}")
    };
    assert!(holes.is_empty() && was.len() == is.len());
    for (was, is) in was.iter().zip(is) {
        assert!(was.chord_m(*is) < 0.03, "{was:?} {is:?}");
    }
    let Geometry::Circle { radius_m, center } = named(&read_back, "disc").geometry else {
        panic!("{read_back:?}")
    };
    assert!((777.7..778.0).contains(&radius_m), "{radius_m}");
    assert!(center.chord_m(corner(-33.9, 151.2)) < 0.03);
}

#[test]
fn zones_in_kml_are_no_smaller_and_what_is_lost_is_said() {
    let kml = write_as(Format::Kml, &to_write());
    assert_eq!((kml.enlarged.len(), kml.left_out.len()), (2, 1));
    let read_back = shapes("x.kml", &kml.text);
    let ring = named(&read_back, "a<b&c");
    assert_eq!((ring.floor, ring.ceiling), (None, Some(Height::Agl(120.1))));
    let Geometry::Polygon { holes, .. } = &ring.geometry else {
        panic!("{ring:?}")
    };
    assert_eq!(holes.len(), 1);
    let Geometry::Polygon { outer, .. } = &named(&read_back, "disc").geometry else {
        panic!("{read_back:?}")
    };
    for pair in outer.windows(2) {
        let middle = corner(
            0.5 * (pair[0].lat_deg + pair[1].lat_deg),
            0.5 * (pair[0].lon_deg + pair[1].lon_deg),
        );
        assert!(middle.chord_m(corner(-33.9, 151.2)) > 777.69, "{middle:?}");
    }
}
