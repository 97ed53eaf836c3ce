//! No zone of a file is smaller than it is there, or lost without a word.

use std::f64::consts::TAU;

use super::{corner, named, read, refused, shapes};
use crate::geodesy::{EastNorth, LatLon, LocalFrame};
use crate::shapes::{Format, Geometry, Height, write_as};
use geo::Contains;
use proptest::prelude::*;

/// Whether places at these bearings and distances from a centre are in a zone.
fn holds(zone: &Geometry, centre: LatLon, at: impl IntoIterator<Item = (f64, f64)>) -> bool {
    let Geometry::Polygon { outer, .. } = zone else {
        panic!("{zone:?}")
    };
    let frame = LocalFrame::new(centre);
    let outline = frame.outline(outer);
    at.into_iter().all(|(bearing_rad, away_m)| {
        let (sin, cos) = bearing_rad.sin_cos();
        let place = frame.from_plan(EastNorth {
            east_m: away_m * sin,
            north_m: away_m * cos,
        });
        let EastNorth { east_m, north_m } = frame.to_plan(place);
        outline.contains(&geo::Point::new(east_m, north_m))
    })
}

proptest! {
    /// The inner arc bulges into the zone, the outer one out of it, whichever way around it is drawn.
    #[test]
    fn a_sector_between_two_arcs_is_no_smaller_than_it_is(
        inner_nm in 5.0_f64..40.0, wide_nm in 1.0_f64..20.0, from_deg in 0_u32..360, turn_deg in 5_u32..300, is_turned: bool,
    ) {
        let to_deg = (from_deg + turn_deg) % 360;
        let outer_nm = inner_nm + wide_nm;
        let centre = "V X=47:00:00 N 008:00:00 E";
        let text = match is_turned {
            false => format!("AC P\nAN S\nAL GND\nAH UNL\n{centre}\nV D=+\nDA {outer_nm:.3},{from_deg},{to_deg}\nV D=-\nDA {inner_nm:.3},{to_deg},{from_deg}\n"),
            true => format!("AC P\nAN S\nAL GND\nAH UNL\n{centre}\nV D=+\nDA {inner_nm:.3},{from_deg},{to_deg}\nV D=-\nDA {outer_nm:.3},{to_deg},{from_deg}\n"),
        };
        let found = shapes("a.txt", &text);
        let zone = &named(&found, "S").geometry;
        let near_rad = 1e-3 / inner_nm;
        let inside = (0..=200).flat_map(|step| {
            let share = f64::from(step) / 200.0;
            let turn_rad = f64::from(turn_deg) / 360.0 * TAU;
            let bearing_rad = f64::from(from_deg).to_radians() + near_rad + share * (turn_rad - 2.0 * near_rad);
            [inner_nm * 1852.0 + 2.0, outer_nm * 1852.0 - 2.0].map(|away_m| (bearing_rad, away_m))
        });
        prop_assert!(holds(zone, corner(47.0, 8.0), inside));
        prop_assert!(!holds(zone, corner(47.0, 8.0), [(f64::from(from_deg).to_radians() + 0.04, 0.99 * inner_nm * 1852.0)]));
    }
}

#[test]
fn an_arc_that_ends_where_it_begins_is_a_circle() {
    let head = "AC P\nAN S\nAL GND\nAH UNL\nV X=47:00:00 N 008:00:00 E\n";
    for arc in [
        "DA 2,90,90",
        "DB 47:02:00 N 008:00:00 E,47:02:00 N 008:00:00 E",
    ] {
        let found = shapes("a.txt", &format!("{head}{arc}\n"));
        let around = (0..100).map(|step| (f64::from(step) / 100.0 * TAU, 3700.0));
        let zone = &named(&found, "S").geometry;
        assert!(holds(zone, corner(47.0, 8.0), around), "{arc}");
    }
}

#[test]
fn openair_opens_no_zone_by_what_it_does_not_read() {
    let corners = "AL GND\nAH UNL\nDP 50:00:00 N 010:40:00 E\nDP 50:01:00 N 010:40:00 E\nDP 50:01:00 N 010:41:00 E\n";
    let of = |times: &str| shapes("a.txt", &format!("AC P\nAN Z\n{times}\n{corners}"));
    let period = "2026-11-24T06:00Z/2026-11-24T07:00Z";
    let active = named(&of(&format!("AA {period}")), "Z").active;
    assert!(active.0.is_some() && active.1.is_some(), "{active:?}");
    for more in [
        ",2026-11-24T08:00Z/2026-11-24T12:00Z",
        " and daily 0800-2000",
        "; HX",
    ] {
        let found = of(&format!("AA {period}{more}"));
        let is_closed = !found.refused.is_empty() || named(&found, "Z").active == (None, None);
        assert!(is_closed, "{more}: {found:?}");
    }
    let twice = of(&format!(
        "AA {period}\nAA 2026-11-24T08:00Z/2026-11-24T12:00Z"
    ));
    assert!(!twice.refused.is_empty() || named(&twice, "Z").active == (None, None));
    // A block in small letters, and one without its first line.
    for before in ["ac P\nan LOST\n", "* title\nAN LOST\n"] {
        let text = format!("{before}{corners}AC P\nAN Z\n{corners}");
        let found = shapes("a.txt", &text);
        assert_eq!(found.refused.len(), 1, "{before}: {found:?}");
        assert_eq!(found.shapes.len(), 1);
    }
}

#[test]
fn what_follows_the_corners_of_a_zone_of_openair_is_not_dropped() {
    let near = "DP 50:00:00 N 010:40:00 E\nDP 50:01:00 N 010:40:00 E\nDP 50:01:00 N 010:41:00 E\n";
    let far = "V X=47:00:00 N 008:00:00 E\nDC 1\n";
    for (second, at) in [
        ("AN Y\nAL GND\nAH UNL\n", 7),
        ("AL GND\n", 7),
        ("AY CTR\n", 7),
    ] {
        let text = format!("AC P\nAN Z\nAL GND\nAH UNL\n{far}{second}{near}AC P\nAN last\n{near}");
        let found = shapes("a.txt", &text);
        assert_eq!(refused(&found), ["Z"]);
        let record = &second[..2];
        let why = format!("line {at}: {record} after corners: a zone begins with AC");
        assert_eq!(found.refused[0].why, why);
        assert_eq!(found.shapes.len(), 1);
    }
    // Where a label is placed may stand anywhere.
    let labelled = format!("AC P\nAN Z\nAL GND\nAH UNL\n{near}AT 50:00:00 N 010:40:00 E\n");
    assert_eq!(shapes("a.txt", &labelled).shapes.len(), 1);
}

#[test]
fn coordinates_of_openair_have_fewer_than_sixty_minutes_and_seconds() {
    let of = |corner: &str| {
        let corners =
            format!("DP {corner}\nDP 47:25:00 N 008:30:00 E\nDP 47:25:00 N 008:31:00 E\n");
        shapes(
            "a.txt",
            &format!("AC R\nAN Z 47:99\nAL GND\nAH UNL\n{corners}"),
        )
    };
    for (corner, is_read) in [
        ("47:20:59 N 008:59:59.9 E", true),
        ("47:20.5 N 008:30.5 E", true),
        ("47:20:99 N 008:30:00 E", false),
        ("47:20:00 N 008:75:00 E", false),
        ("47:75 N 008:30 E", false),
    ] {
        let found = of(corner);
        assert_eq!(found.refused.is_empty(), is_read, "{corner}: {found:?}");
    }
}

#[test]
fn names_of_openair_in_latin_1_are_read() {
    let text = "AC R\nAN Z\u{fc}rich\nAL GND\nAH UNL\nDP 47:24:00 N 008:30:00 E\nDP 47:25:00 N 008:30:00 E\nDP 47:25:00 N 008:31:00 E\n";
    let bytes: Vec<u8> = text.chars().map(|c| c as u8).collect();
    let found = read("a.txt", &bytes).expect("it is OpenAir");
    assert_eq!(found.shapes[0].name, "Z\u{fc}rich");
}

#[test]
fn a_point_of_geojson_whose_radius_is_not_read_is_refused_by_name() {
    let point = |radius: &str| {
        let text = format!(
            r#"{{"type": "FeatureCollection", "features": [{{"type": "Feature", "properties": {{"name": "mast"{radius}}},
            "geometry": {{"type": "Point", "coordinates": [8.51, 47.41]}}}}]}}"#
        );
        shapes("a.geojson", &text)
    };
    for radius in [
        r#", "radius": "200""#,
        r#", "Radius": 300"#,
        r#", "radius_km": 2"#,
        r#", "radius": {"value": 3}"#,
    ] {
        let found = point(radius);
        assert_eq!(refused(&found), ["mast"], "{radius}");
    }
    assert!(matches!(
        point(r#", "radius_m": 300"#).shapes[0].geometry,
        Geometry::Circle { .. }
    ));
    assert!(matches!(point("").shapes[0].geometry, Geometry::Point(_)));
}

#[test]
fn a_circle_wider_than_the_earth_is_refused() {
    let text = "AC R\nAN Z\nAL GND\nAH UNL\nV X=47:24:00 N 008:30:00 E\nDC 1000000000\n";
    assert_eq!(refused(&shapes("a.txt", text)), ["Z"]);
}

#[test]
fn openair_is_written_no_smaller_below_the_sea() {
    let deep = shapes(
        "a.geojson",
        r#"{"type": "Feature", "properties": {"name": "deep", "floor": {"amsl_m": -380}, "ceiling": {"amsl_m": -100}},
            "geometry": {"type": "Polygon", "coordinates": [[[35.4, 31.4], [35.5, 31.4], [35.5, 31.5], [35.4, 31.4]]]}}"#,
    );
    let written = write_as(Format::OpenAir, &deep.shapes);
    assert_eq!(written.enlarged.len(), 1, "{:?}", written.enlarged);
    let again = shapes("a.txt", &written.text);
    assert_eq!(named(&again, "deep").floor, None);
    assert_eq!(named(&again, "deep").ceiling, Some(Height::Amsl(0.0)));
}

const RING: &str = "<outerBoundaryIs><LinearRing><coordinates>8,47 8.01,47 8.01,47.01 8,47</coordinates></LinearRing></outerBoundaryIs>";

#[test]
fn a_comment_within_coordinates_cuts_nothing_off_and_what_else_is_in_them_is_refused() {
    let of = |inside: &str| {
        let ring = format!("<outerBoundaryIs><LinearRing>{inside}</LinearRing></outerBoundaryIs>");
        let text = format!(
            "<kml><Placemark><name>a<!-- x -->b</name><Polygon>{ring}</Polygon></Placemark></kml>"
        );
        shapes("a.kml", &text)
    };
    let whole = of("<coordinates>8,47 8.01,47 8.01,47.01 8,47.01 8,47</coordinates>");
    let cut = of(
        "<coordinates>8,47 8.01,47 8.01,47.01 <!-- north --> 8,47.01 <?x y?><![CDATA[8,47]]></coordinates>",
    );
    assert_eq!(named(&whole, "ab").geometry, named(&cut, "ab").geometry);
    let more = "8,47 8.01,47 8.01,47.01 8,47";
    for inside in [
        format!("<coordinates>{more}</coordinates><coordinates>{more}</coordinates>"),
        format!("<coordinates>8,47 8.01,47 <b/> {more}</coordinates>"),
    ] {
        assert_eq!(refused(&of(&inside)), ["ab"], "{inside}");
    }
}

#[test]
fn every_geometry_of_a_placemark_is_read_whatever_others_it_has() {
    let model =
        "<Model><Location><longitude>8</longitude><latitude>47</latitude></Location></Model>";
    let polygon = format!("<Polygon>{RING}</Polygon>");
    for (inside, good, bad) in [
        (
            format!("<MultiGeometry>{polygon}{model}{polygon}</MultiGeometry>"),
            2,
            1,
        ),
        (
            format!("{polygon}<Point><coordinates>8,47</coordinates></Point>{polygon}"),
            3,
            0,
        ),
        (format!("<Polygon>{RING}{RING}</Polygon>"), 0, 1),
        (String::new(), 0, 1),
    ] {
        let text = format!(
            "<kml><Document><Placemark><name>a</name>{inside}</Placemark></Document></kml>"
        );
        let found = shapes("a.kml", &text);
        assert_eq!(
            (found.shapes.len(), found.refused.len()),
            (good, bad),
            "{found:?}"
        );
    }
    let both = format!("<kml><Placemark><name>a</name>{polygon}{model}</Placemark></kml>");
    assert_eq!(refused(&shapes("a.kml", &both)), ["a part 2"]);
    let link =
        "<kml><NetworkLink><name>more</name><Link><href>b.kml</href></Link></NetworkLink></kml>";
    assert_eq!(refused(&shapes("a.kml", link)), ["more"]);
}

#[test]
fn a_zone_of_ed_269_without_a_list_of_volumes_is_read_or_refused() {
    let volume = r#"{"uomDimensions": "M", "upperLimit": 120, "upperVerticalReference": "AGL", "lowerLimit": 0,
        "lowerVerticalReference": "AGL", "horizontalProjection": {"type": "Circle", "center": [8, 47], "radius": 100}}"#;
    let zone = |name: &str, more: &str| {
        format!(r#"{{"identifier": "{name}", "restriction": "PROHIBITED"{more}}}"#)
    };
    let text = format!(
        r#"{{"features": [{}, {}, {}, {}, {}]}}"#,
        zone("list", &format!(r#", "geometry": [{volume}]"#)),
        zone("object", &format!(r#", "geometry": {volume}"#)),
        zone("null", r#", "geometry": null"#),
        zone("empty", r#", "geometry": []"#),
        zone("none", ""),
    );
    let found = shapes("a.json", &text);
    assert_eq!(refused(&found), ["null", "empty", "none"]);
    assert_eq!(
        named(&found, "object").geometry,
        named(&found, "list").geometry
    );
}

#[test]
fn a_zone_that_is_permanent_is_so_whatever_dates_it_has() {
    let old = r#""startDateTime": "2020-01-01T00:00:00Z", "endDateTime": "2021-01-01T00:00:00Z"}"#;
    for (permanent, is_open) in [(r#""YES""#, true), ("true", true), (r#""NO""#, false)] {
        let text = format!(
            r#"[{{"identifier": "a", "applicability": [{{"permanent": {permanent}, {old}],
                "geometry": [{{"horizontalProjection": {{"type": "Circle", "center": [8, 47], "radius": 100}}}}]}}]"#
        );
        let found = shapes("a.json", &text);
        assert_eq!(
            named(&found, "a").active == (None, None),
            is_open,
            "{permanent}"
        );
    }
}

#[test]
fn heights_above_the_ellipsoid_are_the_widest_over_the_whole_shape() {
    // The Himalaya: the geoid is 28 m higher at its edge than at its centre.
    let text = r#"[{"identifier": "a", "geometry": [{"uomDimensions": "M", "upperLimit": 1000, "upperVerticalReference": "WGS84",
        "lowerLimit": 500, "lowerVerticalReference": "WGS84",
        "horizontalProjection": {"type": "Circle", "center": [86.0, 28.3], "radius": 143500}}]}]"#;
    let found = shapes("a.json", text);
    let zone = named(&found, "a");
    let at_m = |lat_deg, lon_deg| {
        let geoid = crate::geodesy::Geoid::egm96();
        geoid.undulation_m(corner(lat_deg, lon_deg))
    };
    let (Some(Height::Amsl(floor_m)), Some(Height::Amsl(ceiling_m))) = (zone.floor, zone.ceiling)
    else {
        panic!("{zone:?}")
    };
    for step in 0..400 {
        let (lat_deg, lon_deg) = (
            27.1 + 2.4 * f64::from(step / 20) / 20.0,
            84.6 + 2.8 * f64::from(step % 20) / 20.0,
        );
        let undulation_m = at_m(lat_deg, lon_deg);
        assert!(ceiling_m >= 1000.0 - undulation_m, "{lat_deg} {lon_deg}");
        assert!(floor_m <= 500.0 - undulation_m, "{lat_deg} {lon_deg}");
    }
}
