//! Zones with a shape: what is read, and what is refused with its position.

use std::fs;
use std::path::Path;

use sortie::geodesy::{Agl, Amsl};
use sortie::spec::{Placement, SpecFile, Zone};

const HEAD: &str = "sortie: 1
name: zones
area: {south_west: {lat: 36.2, lon: -84.4}, north_east: {lat: 36.4, lon: -84.1}, min_agl_m: 60, max_amsl_m: 1500}
terrain: {flat: {amsl_m: 400}}
vehicles:
  - {id: alpha, sysid: 1, autopilot: ardupilot, link: sim, start: {lat: 36.25, lon: -84.35, agl_m: 80},
     goal: {lat: 36.35, lon: -84.15, agl_m: 80}, finish: land, speed_mps: 15}
";

fn read(more: &str) -> Result<Vec<Zone>, Vec<String>> {
    let file = SpecFile::parse(Path::new("zones.yaml"), format!("{HEAD}{more}"));
    file.map(|file| file.spec.no_fly).map_err(|error| {
        error
            .issues
            .iter()
            .map(|of| format!("{}: {}", of.path, of.found))
            .collect()
    })
}

#[test]
fn zones_have_circles_holes_floors_ceilings_and_times() {
    let zones = read(
        "
t0: 2026-12-01T08:00:00Z
qnh_hpa: {min: 995, max: 1030}
zones:
  - {id: mast, circle: {lat: 36.3, lon: -84.2, radius_m: 40}, ceiling: {agl_m: 90}}
  - id: tma
    polygon: [[36.30, -84.30], [36.30, -84.28], [36.32, -84.28], [36.32, -84.30]]
    holes: [[[36.305, -84.295], [36.305, -84.285], [36.315, -84.29]]]
    floor: {amsl_m: 900}
    ceiling: {fl: 65}
    active: {from: 2026-12-01T08:10:00Z, to: 2026-12-01T11:00:00+01:00}
",
    )
    .expect("good");
    let (mast, tma) = (&zones[0], &zones[1]);
    assert_eq!(mast.ceiling, Some(Placement::Agl(Agl(90.0))));
    assert_eq!(mast.circle.map(|(_, radius_m)| radius_m), Some(40.0));
    assert_eq!(
        (tma.floor, tma.active_s),
        (Some(Placement::Amsl(Amsl(900.0))), Some((600.0, 7200.0)))
    );
    // 6500 ft, and as many metres more as 1030 hPa are below the sea of the standard atmosphere.
    let Some(Placement::Amsl(Amsl(top_m))) = tma.ceiling else {
        panic!("{tma:?}")
    };
    assert!((top_m - (1981.2 + 138.5)).abs() < 1.0, "{top_m}");
    assert_eq!(tma.outline().len(), 4 + 3 + 2);
}

#[test]
fn without_t0_a_zone_is_always_active() {
    let zones = read(
        "
zones:
  - {id: a, circle: {lat: 36.3, lon: -84.2, radius_m: 40}, active: {from: 2026-12-01T08:10:00Z}}
",
    );
    assert_eq!(zones.expect("good")[0].active_s, None);
}

#[test]
fn what_is_wrong_with_a_zone_is_reported_where_it_stands() {
    let errors = read("
t0: noon
no_fly: [{id: b, polygon: [[36.30, -84.30], [36.30, -84.28], [36.32, -84.28]]}]
zones:
  - {id: a, circle: {lat: 36.3, lon: -84.2, radius_m: 40}, floor: {fl: 65}}
  - {id: b, circle: {lat: 36.3, lon: -84.2, radius_m: 40}, floor: {amsl_m: 900}, ceiling: {amsl_m: 800}}
  - {id: c}
  - {id: d, circle: {lat: 36.3, lon: -84.2, radius_m: 40}, floor: {amsl_m: 900, agl_m: 3}}
  - id: e
    polygon: [[36.30, -84.30], [36.30, -84.28], [36.32, -84.28], [36.32, -84.30]]
    holes: [[[36.305, -84.295], [36.305, -84.275], [36.315, -84.29]]]
")
    .expect_err("bad");
    for (path, part) in [
        ("t0", "`noon`"),
        ("zones[0].floor", "flight level 65 without qnh_hpa"),
        ("zones[1].id", "already the id of no_fly[0]"),
        (
            "zones[1].ceiling",
            "a ceiling at 800.0 m and a floor at 900.0 m",
        ),
        ("zones[2]", "none or both of polygon and circle"),
        ("zones[3].floor", "none or several of amsl_m, agl_m and fl"),
        ("zones[4].holes[0]", "a hole that is not inside the polygon"),
    ] {
        let found = errors
            .iter()
            .any(|error| error.contains(path) && error.contains(part));
        assert!(found, "{path}: {part}: {errors:#?}");
    }
    assert_eq!(errors.len(), 7, "{errors:#?}");
}

#[test]
fn a_time_with_an_offset_of_a_day_or_more_is_refused_where_it_stands() {
    let errors = read("
t0: 2026-11-27T10:00:00+25:00
zones:
  - {id: a, circle: {lat: 36.3, lon: -84.2, radius_m: 40}, active: {from: 2026-12-01T08:10:00-24:00}}
")
    .expect_err("bad");
    for (path, part) in [("t0", "+25:00"), ("zones[0].active.from", "-24:00")] {
        let found = errors.iter();
        let found = found.filter(|error| error.contains(path) && error.contains(part));
        assert_eq!(found.count(), 1, "{path}: {part}: {errors:#?}");
    }
}

/// Reads a spec beside files.
fn read_beside(files: &[(&str, &str)], more: &str) -> Result<SpecFile, Vec<String>> {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        fs::write(folder.path().join(name), text).expect("writable");
    }
    let path = folder.path().join("zones.yaml");
    fs::write(&path, format!("{HEAD}{more}")).expect("writable");
    SpecFile::read(&path).map_err(|error| {
        let issues = error.issues.iter();
        issues
            .map(|of| format!("{}: {}", of.path, of.found))
            .collect()
    })
}

const OPENAIR: &str = "AC D
AN CTR NORTH
AH 3000ft MSL
AL GND
V X=36:20:00 N 084:12:00 W
DC 1

AC R
AN HIGH
AH FL 195
AL FL 100
V X=36:18:00 N 084:15:00 W
DC 1

AC C
AN FAR
AH FL 195
AL GND
V X=47:18:00 N 008:15:00 E
DC 1
";

#[test]
fn zones_of_files_are_zones_with_a_source_and_what_lies_out_of_reach_is_counted() {
    let files = [("a.txt", OPENAIR)];
    let spec = read_beside(
        &files,
        "qnh_hpa: {min: 995, max: 1030}\nairspace: [{file: a.txt, buffer_m: 30}]\n",
    );
    let file = spec.expect("good");
    let [zone] = &file.spec.no_fly[..] else {
        panic!("{:?}", file.spec.no_fly)
    };
    assert_eq!((zone.id.as_str(), zone.buffer_m), ("CTR NORTH", 30.0));
    assert_eq!(zone.source.as_deref(), Some("a.txt, CTR NORTH (D)"));
    let Some(Placement::Amsl(Amsl(top_m))) = zone.ceiling else {
        panic!("{zone:?}")
    };
    assert!((top_m - 914.4).abs() < 1e-6);
    // Above the ceiling of the area, and on another continent.
    let import = &file.imports[0];
    assert_eq!((import.zones.len(), import.out_of_reach), (1, 2));
    assert_eq!(file.attached[0].bytes, OPENAIR.as_bytes());
}

#[test]
fn a_zone_whose_buffer_reaches_the_area_is_not_out_of_reach() {
    // 3 km north of the area.
    let ring = "[[-84.30, 36.43], [-84.20, 36.43], [-84.20, 36.44], [-84.30, 36.43]]";
    let near = format!(
        r#"{{"type": "Feature", "properties": {{"name": "near"}}, "geometry": {{"type": "Polygon", "coordinates": [{ring}]}}}}"#
    );
    let files = [("near.geojson", near.as_str())];
    for (buffer_m, zones) in [(0, 0), (1000, 0), (2500, 1), (5000, 1)] {
        let more = format!("airspace: [{{file: near.geojson, buffer_m: {buffer_m}}}]\n");
        let file = read_beside(&files, &more).expect("good");
        assert_eq!(file.spec.no_fly.len(), zones, "{buffer_m}");
    }
}

#[test]
fn a_hole_as_large_as_its_zone_is_an_error() {
    let ring = "[[-84.25, 36.33], [-84.23, 36.33], [-84.23, 36.34], [-84.25, 36.33]]";
    let same = format!(
        r#"{{"type": "Feature", "properties": {{"name": "same"}}, "geometry": {{"type": "Polygon", "coordinates": [{ring}, {ring}]}}}}"#
    );
    let errors = read_beside(
        &[("same.geojson", &same)],
        "airspace: [{file: same.geojson}]\n",
    );
    let errors = errors.expect_err("nothing is closed");
    assert!(
        errors[0].contains("a hole that is as large as its outline"),
        "{errors:?}"
    );
}

#[test]
fn classes_choose_and_what_cannot_be_read_is_an_error_until_it_is_skipped() {
    let files = [("a.txt", OPENAIR)];
    let with = |more: &str| read_beside(&files, &format!("airspace: [{{file: a.txt{more}}}]\n"));
    let errors = with("").expect_err("flight levels need a pressure");
    assert!(
        errors[0]
            .contains("airspace[0].file: `HIGH` cannot be a zone: flight level 100 needs qnh_hpa"),
        "{errors:?}"
    );
    let skipped = with(", skip: [HIGH]").expect("good");
    assert_eq!(
        (skipped.imports[0].left_out, skipped.spec.no_fly.len()),
        (1, 1)
    );
    let only = with(", only: {class: [r]}, skip: [HIGH]").expect("good");
    assert_eq!((only.imports[0].left_out, only.spec.no_fly.len()), (3, 0));
    let missing = read_beside(&[], "airspace: [{file: b.kml}]\n").expect_err("no file");
    assert!(
        missing[0].starts_with("airspace[0].file:") && missing[0].contains("cannot be read"),
        "{missing:?}"
    );
    let outside = read_beside(&[], "airspace: [{file: ../b.kml}]\n").expect_err("outside");
    assert!(outside[0].contains("`../b.kml`"), "{outside:?}");
}

#[test]
fn obstacles_stand_on_the_ground() {
    let files = [
        (
            "masts.csv",
            "id,lat,lon,height_m,radius_m\nmast,36.30,-84.20,90,20\n,36.31,-84.20,40,\nfar,0,0,10,5\n",
        ),
        ("bad.csv", "lat,lon,height_m\n36.3,-84.2,high\n"),
    ];
    let file = read_beside(&files, "obstacles: [{file: masts.csv}]\n").expect("good");
    let ceilings: Vec<Option<Placement>> =
        file.spec.no_fly.iter().map(|zone| zone.ceiling).collect();
    assert_eq!(
        ceilings,
        [
            Some(Placement::Agl(Agl(90.0))),
            Some(Placement::Agl(Agl(40.0)))
        ]
    );
    assert_eq!(file.imports[0].out_of_reach, 1);
    let error = read_beside(&files, "obstacles: [{file: bad.csv}]\n").expect_err("bad");
    assert!(
        error[0].contains("line 2: `high` is no number"),
        "{error:?}"
    );
}

/// What GDAL writes for the same features as a table and as GeoJSON.
#[test]
fn a_table_of_well_known_text_is_read_as_its_twin_of_geojson() {
    let table = "\
WKT,id,height_m,radius_m,heights_m
POINT (-84.20 36.30),mast,90,20,
\"LINESTRING (-84.20 36.31,-84.21 36.31,-84.22 36.31)\",line,,15,\"(3:35,40,30)\"
\"POLYGON ((-84.25 36.30,-84.249 36.30,-84.249 36.301,-84.25 36.301,-84.25 36.30))\",house,30,,
\"MULTILINESTRING ((-84.20 36.32,-84.21 36.32),(-84.22 36.32,-84.23 36.32))\",wires,25,,
";
    let feature = |kind: &str, coordinates: &str, properties: &str| {
        format!(
            r#"{{"type":"Feature","properties":{{{properties}}},"geometry":{{"type":"{kind}","coordinates":{coordinates}}}}}"#
        )
    };
    let features = [
        feature(
            "Point",
            "[-84.20,36.30]",
            r#""id":"mast","height_m":90,"radius_m":20"#,
        ),
        feature(
            "LineString",
            "[[-84.20,36.31],[-84.21,36.31],[-84.22,36.31]]",
            r#""id":"line","heights_m":[35,40,30],"radius_m":15"#,
        ),
        feature(
            "Polygon",
            "[[[-84.25,36.30],[-84.249,36.30],[-84.249,36.301],[-84.25,36.301],[-84.25,36.30]]]",
            r#""id":"house","height_m":30"#,
        ),
        feature(
            "MultiLineString",
            "[[[-84.20,36.32],[-84.21,36.32]],[[-84.22,36.32],[-84.23,36.32]]]",
            r#""id":"wires","height_m":25"#,
        ),
    ];
    let twin = format!(
        r#"{{"type":"FeatureCollection","features":[{}]}}"#,
        features.join(",")
    );
    let (geometry, place) = (
        table.replace("WKT", "geometry"),
        "lat,lon,geometry,height_m\n36.3,-84.2,tower,90\n",
    );
    let files = [
        ("a.csv", table),
        ("b.geojson", twin.as_str()),
        ("c.csv", geometry.as_str()),
        ("place.csv", place),
    ];
    let zones = |name: &str| {
        let named = format!("obstacles: [{{file: {name}}}]\n");
        let mut zones = read_beside(&files, &named).expect(name).spec.no_fly;
        for zone in &mut zones {
            zone.source = None;
        }
        zones
    };
    let expected = zones("b.geojson");
    assert!(expected.len() >= 6, "{}", expected.len());
    assert_eq!(zones("a.csv"), expected);
    assert_eq!(zones("c.csv"), expected);
    assert_eq!(zones("place.csv").len(), 1);
}

#[test]
fn a_column_of_obstacles_that_stands_twice_is_refused() {
    for (names, twice) in [
        ("lat,lon,height_m,height_m", "height_m"),
        ("lat,lon,height_m,LAT", "LAT"),
    ] {
        let table = format!("{names}\n47.4,8.51,10,100\n");
        let files = [("masts.csv", table.as_str())];
        let error = read_beside(&files, "obstacles: [{file: masts.csv}]\n").expect_err(names);
        let said = format!("column `{twice}` stands twice");
        assert!(error.join("\n").contains(&said), "{error:?}");
    }
}

#[test]
fn a_table_whose_geometry_is_not_read_names_what_converts_it() {
    for (row, why) in [
        ("0101000000,90", "line 2, column wkt: `0101000000`"),
        ("POINT (2600000 1200000),90", "no such place"),
        ("SRID=2056;POINT (2600000 1200000),90", "not in EPSG:4326"),
    ] {
        let table = format!("wkt,height_m\n{row}\n");
        let files = [("my masts.csv", table.as_str())];
        let error = read_beside(&files, "obstacles: [{file: my masts.csv}]\n").expect_err(why);
        let command = "`ogr2ogr -f GeoJSON -lco RFC7946=YES -s_srs EPSG:CODE -t_srs EPSG:4326 'my masts.geojson' 'my masts.csv'`";
        assert!(
            error[0].contains(why) && error[0].contains(command),
            "{error:?}"
        );
    }
    let files = [("a.csv", "wkt,heigth_m\nPOINT (-84.2 36.3),90\n")];
    let error = read_beside(&files, "obstacles: [{file: a.csv}]\n").expect_err("misspelt");
    assert!(error[0].contains("did you mean `height_m`?"), "{error:?}");
}

#[test]
fn what_lies_outside_of_all_zones_to_stay_in_is_closed() {
    let pieces = "
zones:
  - {id: west, keep_in: true, polygon: [[36.22, -84.38], [36.22, -84.20], [36.30, -84.20], [36.30, -84.38]]}
  - {id: east, keep_in: true, polygon: [[36.22, -84.25], [36.22, -84.12], [36.38, -84.12], [36.38, -84.25]]}
";
    let zones = read(pieces).expect("good");
    let [zone] = &zones[..] else {
        panic!("{zones:?}")
    };
    assert_eq!(
        (zone.id.as_str(), zone.holes.len()),
        ("outside west and 1 more", 1)
    );
    // The union of two boxes that share their south has six corners.
    assert_eq!(zone.holes[0].len(), 6, "{:?}", zone.holes);
    // What both leave out stays closed, in whichever direction its corners go.
    let hole = [
        "[36.24, -84.17], [36.24, -84.14], [36.27, -84.14]",
        "[36.27, -84.14], [36.24, -84.14], [36.24, -84.17]",
    ];
    for corners in hole {
        let holed = pieces.replace("{id: east,", &format!("{{id: east, holes: [[{corners}]],"));
        let zones = read(&holed).expect("good");
        let ids: Vec<&str> = zones.iter().map(|zone| zone.id.as_str()).collect();
        assert_eq!(
            ids,
            ["outside west and 1 more", "outside west and 1 more, hole 1"]
        );
        assert_eq!(zones[1].polygon.len(), 3, "{:?}", zones[1].polygon);
    }
    // A start outside of both is an error, and so are heights.
    let one = "zones: [{id: west, keep_in: true, polygon: [[36.22, -84.38], [36.22, -84.30], [36.30, -84.30]]}]";
    let errors = read(one).expect_err("the goal is outside");
    assert!(
        errors
            .iter()
            .any(|of| of.contains("vehicles[0].goal") && of.contains("`outside west`")),
        "{errors:?}"
    );
    let high = pieces.replace("{id: west,", "{id: west, ceiling: {agl_m: 90},");
    let errors = read(&high).expect_err("a height");
    assert!(
        errors
            .iter()
            .any(|of| of.contains("zones[0]") && of.contains("to stay in")),
        "{errors:?}"
    );
}
