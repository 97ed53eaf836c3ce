//! Specs that are well formed and make no sense.

use super::*;

#[test]
fn latitude_123_is_out_of_range() {
    let text = with("lat: 36.31,", "lat: 123,");
    let issue = &issues(&text)[0];
    assert_eq!(
        (issue.path.as_str(), issue.position),
        ("threats[0].lat", Some(place_of(&text, "123")))
    );
    let error = parse(&text).expect_err("123 degrees");
    let (line, column) = place_of(&text, "123");
    assert_eq!(
        error.to_string(),
        format!("mission.yaml:{line}:{column}: threats[0].lat: 123 (allowed: -90 to 90)")
    );
}

#[test]
fn several_problems_are_reported_at_once_in_file_order() {
    let text = with("lat: 36.31,", "lat: 123,")
        .replace("sysid: 2", "sysid: 1")
        .replace("max_load_factor: 1.2", "max_load_factor: 0.9")
        .replace("samples: 51", "samples: 5")
        .replace("sortie: 1", "sortie: 3")
        .replace("autopilot: px4", "autopilot: px4\n    loiter_radius_m: 50");
    let found = issues(&text);
    let paths: Vec<&str> = found.iter().map(|issue| issue.path.as_str()).collect();
    let expected = [
        "sortie",
        "threats[0].lat",
        "vehicles[0].max_load_factor",
        "vehicles[1].sysid",
        "vehicles[1].loiter_radius_m",
        "planner.samples",
    ];
    assert_eq!(paths, expected);
    let positions: Vec<_> = found.iter().map(|issue| issue.position).collect();
    assert!(
        positions.is_sorted() && positions.iter().all(Option::is_some),
        "{positions:?}"
    );
    assert_eq!(
        parse(&text)
            .expect_err("six problems")
            .to_string()
            .lines()
            .count(),
        6
    );
}

#[test]
fn a_number_that_is_none_is_out_of_range() {
    for none in [".nan", ".inf", "-.inf"] {
        assert_eq!(
            only("radius_m: 3000", &format!("radius_m: {none}")).0,
            "threats[0].radius_m"
        );
        assert_eq!(
            only("lat: 36.31", &format!("lat: {none}")).0,
            "threats[0].lat"
        );
    }
    assert_eq!(
        only("speed_mps: 12", "speed_mps: -12").0,
        "vehicles[1].speed_mps"
    );
    let (path, message) = only("threshold: 0.5", "threshold: .nan");
    assert_eq!(path, "planner.threshold");
    assert!(message.contains("a finite number"), "{message}");
    assert_eq!(
        only("evaluations: 5000", "evaluations: 100000001").0,
        "planner.evaluations"
    );
    assert_eq!(only("sysid: 2", "sysid: -1").0, "vehicles[1].sysid");
}

#[test]
fn a_start_in_a_threat_names_the_threat() {
    let (path, message) = only(
        "start: {lat: 36.39, lon: -84.39,",
        "start: {lat: 36.32, lon: -84.26,",
    );
    assert_eq!(path, "vehicles[1].start");
    assert!(
        message.contains("inside threat `radar-1`") && message.contains("more than 3000 m"),
        "{message}"
    );
}

#[test]
fn a_goal_outside_of_the_area_is_an_error() {
    let (path, message) = only(
        "goal: {lat: 36.21, lon: -84.12",
        "goal: {lat: 36.19, lon: -84.12",
    );
    assert_eq!(path, "vehicles[1].goal");
    assert!(
        message.contains("36.19") && message.contains("latitude 36.2 to 36.4"),
        "{message}"
    );
    // The other side of the earth does not fold back into the area.
    assert_eq!(
        only(
            "goal: {lat: 36.21, lon: -84.12",
            "goal: {lat: -36.30, lon: 95.75"
        )
        .0,
        "vehicles[1].goal"
    );
}

#[test]
fn a_home_or_rally_point_in_a_zone_is_an_error() {
    let zone = with(", below_amsl_m: 900", "");
    let inside = "lat: 36.357, lon: -84.199";
    let text = zone.replace(
        "rally:\n  - {lat: 36.22, lon: -84.38",
        &format!("rally:\n  - {{{inside}"),
    );
    assert_eq!(issues(&text)[0].path, "rally[0]");
    let text = zone.replace(
        "home: {lat: 36.21, lon: -84.39",
        &format!("home: {{{inside}"),
    );
    assert!(issues(&text)[0].found.contains("no-fly zone `town`"));
}

#[test]
fn a_rally_point_below_the_minimum_height_is_an_error() {
    let rally = |agl_m: u32| format!("rally:\n  - {{lat: 36.22, lon: -84.38, agl_m: {agl_m}}}");
    let (path, message) = only(&rally(80), &rally(59));
    assert_eq!(path, "rally[0].agl_m");
    assert!(
        message.contains("59 (allowed: at least area.min_agl_m, 60)"),
        "{message}"
    );
}

#[test]
fn two_vehicles_with_one_system_id_are_an_error() {
    let (path, message) = only("sysid: 2", "sysid: 1");
    assert_eq!(path, "vehicles[1].sysid");
    assert!(
        message.contains("already the system id of `alpha`"),
        "{message}"
    );
}

#[test]
fn system_ids_of_px4_end_at_250() {
    good(&with("sysid: 1", "sysid: 255"));
    assert_eq!(only("sysid: 2", "sysid: 251").0, "vehicles[1].sysid");
}

#[test]
fn ids_that_differ_only_in_case_are_an_error() {
    assert_eq!(only("id: bravo", "id: ALPHA").0, "vehicles[1].id");
}

#[test]
fn names_that_cannot_be_file_names_are_errors() {
    for name in [
        "\"\"",
        "a/b",
        "..",
        ".hidden",
        "a.b",
        "\"a\\0b\"",
        "-x",
        "'a b'",
    ] {
        assert_eq!(
            only("name: full", &format!("name: {name}")).0,
            "name",
            "{name}"
        );
        assert_eq!(
            only("id: bravo", &format!("id: {name}")).0,
            "vehicles[1].id",
            "{name}"
        );
    }
    assert_eq!(
        only("name: full", &format!("name: {}", "x".repeat(65))).0,
        "name"
    );
}

#[test]
fn ids_with_invisible_or_look_alike_characters_are_errors() {
    for (id, named) in [
        // Right-to-left override, zero width space, left-to-right mark.
        ("\"br\\u202Eavo\"", "U+202E"),
        ("\"br\\u200Bavo\"", "U+200B"),
        ("\"bravo\\u200E\"", "U+200E"),
        // Cyrillic a among Latin letters.
        ("br\u{430}vo", "`\u{430}` (U+0430)"),
        // Greek omicron.
        ("brav\u{3bf}", "`\u{3bf}` (U+03BF)"),
    ] {
        let (path, message) = only("id: bravo", &format!("id: {id}"));
        assert_eq!(path, "vehicles[1].id");
        assert!(message.contains(named), "{message}");
        let (path, message) = only("id: town", &format!("id: {id}"));
        assert_eq!(path, "no_fly[0].id");
        assert!(message.contains(named), "{message}");
    }
    for id in ["северный", "東京タワー", "übung-ß", "δοκιμή"] {
        good(&with("id: bravo", &format!("id: {id}")));
    }
    good(&with("id: town", "id: Town Север"));
    // All Cyrillic, and all Latin: two ids that look the same.
    let alike = with("id: bravo", "id: соре").replace("id: alpha", "id: cope");
    let found = issues(&alike);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].path, "vehicles[1].id");
    assert!(found[0].found.contains("looks like"), "{found:?}");
}

#[test]
fn keys_of_planes_do_not_stand_on_copters() {
    for key in [
        "takeoff_heading_deg: 90",
        "landing: {heading_deg: 90, glide_deg: 6}",
        "loiter_radius_m: 80",
    ] {
        let (path, message) = only(
            "    depart_s: 5\n",
            &format!("    depart_s: 5\n    {key}\n"),
        );
        assert_eq!(
            path,
            format!("vehicles[0].{}", key.split(':').next().expect("a key"))
        );
        assert!(message.contains("on a copter"), "{message}");
    }
}

#[test]
fn terrain_altitudes_are_not_for_px4() {
    let (path, message) = only("altitude: relative", "altitude: terrain");
    assert_eq!(path, "mission.altitude");
    assert!(message.contains("`bravo`"), "{message}");
}

#[test]
fn a_link_is_one_of_the_known_kinds() {
    for link in [
        "udp:1.2.3.4:5",
        "udpout:1.2.3.4",
        "udpout::14550",
        "udpin:0.0.0.0:0",
        "tcp:a:99999",
        "serial:/dev/x",
        "serial:/dev/x:fast",
        "udpout:a b:1",
        "udpout:::1:14550",
        "\"\"",
    ] {
        let (path, message) = only("link: udpout:127.0.0.1:14550", &format!("link: {link}"));
        assert_eq!(path, "vehicles[0].link", "{link}");
        assert!(message.contains("tcp:HOST:PORT"), "{message}");
    }
    for link in [
        "sim",
        "udpin:0.0.0.0:14550",
        "tcp:localhost:5760",
        "\"udpout:[::1]:14550\"",
    ] {
        good(&with(
            "link: udpout:127.0.0.1:14550",
            &format!("link: {link}"),
        ));
    }
}

#[test]
fn an_end_point_has_one_altitude() {
    assert_eq!(
        only("amsl_m: 700", "amsl_m: 700, agl_m: 80").0,
        "vehicles[0].goal"
    );
    assert_eq!(only(", amsl_m: 700", "").0, "vehicles[0].goal");
}

#[test]
fn terrain_has_one_source_beside_the_spec() {
    let terrain = "terrain:\n  analytic:\n    base_amsl_m: 300\n    hills:\n      - {lat: 36.30, lon: -84.25, height_m: 200, radius_m: 2000}\n";
    for file in [
        "/etc/dem.tif",
        "../dem.tif",
        "a/../dem.tif",
        "\"\"",
        "dem.gif",
        "'c:\\dem.tif'",
        "./dem.tif/..",
    ] {
        assert_eq!(
            only(terrain, &format!("terrain: {{file: {file}}}\n")).0,
            "terrain.file",
            "{file}"
        );
    }
    let file = good(&with(terrain, "terrain: {file: ./tiles/dem.tif}\n")).terrain;
    assert_eq!(file, TerrainSource::File("tiles/dem.tif".into()));
    assert_eq!(only(terrain, "terrain: {}\n").0, "terrain");
    assert_eq!(
        only(terrain, "terrain: {file: a.tif, flat: {amsl_m: 1}}\n").0,
        "terrain"
    );
}

#[test]
fn a_terrain_of_another_kind_names_the_command_that_converts_it() {
    let terrain = "terrain:\n  analytic:\n    base_amsl_m: 300\n    hills:\n      - {lat: 36.30, lon: -84.25, height_m: 200, radius_m: 2000}\n";
    for (file, command) in [
        (
            "tiles/my cloud.laz",
            "`pdal translate 'tiles/my cloud.laz' 'tiles/my cloud.tif' -w",
        ),
        (
            "quad.DEM",
            "`gdalwarp -t_srs EPSG:4326 -r bilinear quad.DEM quad.tif`",
        ),
        ("n36.dt2", "`gdal_translate n36.dt2 n36.tif`"),
    ] {
        let text = with(terrain, &format!("terrain: {{file: {file}}}\n"));
        let error = parse(&text).expect_err(file).to_string();
        assert!(
            error.contains("terrain.file") && error.contains(command),
            "{error}"
        );
    }
}

#[test]
fn a_polygon_is_a_polygon() {
    let polygon = "[[36.35, -84.20], [36.36, -84.20], [36.36, -84.18]]";
    for bad in [
        "[[36.35, -84.20], [36.36, -84.20]]",
        "[[36.35, -84.20], [36.36, -84.20], [36.35, -84.20]]",
        "[[36.35, -84.20], [36.36, -84.18], [36.36, -84.20], [36.35, -84.18]]",
        "[[36.35, -84.20], [36.36, -84.20], [36.37, -84.20]]",
        "[[36.35, -84.20], [36.35, -84.20], [36.36, -84.20], [36.36, -84.18]]",
        "[[36.35, -84.20], [36.36, -84.20], [36.36, -184.18]]",
        "[[-84.20, 36.35], [-84.20, 36.36], [-84.18, 36.36]]",
    ] {
        let text = with(polygon, bad);
        assert!(
            issues(&text)
                .iter()
                .all(|issue| issue.path.starts_with("no_fly[0].polygon")),
            "{bad}"
        );
    }
    let closed = "[[36.35, -84.20], [36.36, -84.20], [36.36, -84.18], [36.35, -84.20]]";
    assert_eq!(
        good(&with(polygon, closed)),
        good(FULL),
        "a repeated first corner closes it"
    );
    // A fence or a power line may be thin, but not thinner than what a margin is rounded to.
    let strip =
        |east: &str| format!("[[36.35, -84.2], [36.36, -84.2], [36.36, {east}], [36.35, {east}]]");
    good(&with(polygon, &strip("-84.199999")));
    let found = &issues(&with(polygon, &strip("-84.19999996")))[0];
    assert_eq!(found.path, "no_fly[0].polygon");
    assert!(found.found.ends_with("m wide"), "{found:?}");
}

#[test]
fn a_goal_at_the_start_leaves_nothing_to_plan() {
    let goal = "goal: {lat: 36.39, lon: -84.12, amsl_m: 700}";
    let (path, message) = only(goal, "goal: {lat: 36.21008, lon: -84.38, amsl_m: 700}");
    assert_eq!(path, "vehicles[0].goal");
    assert!(message.contains("8.9 m from start"), "{message}");
    good(&with(
        goal,
        "goal: {lat: 36.2101, lon: -84.38, amsl_m: 700}",
    ));
}

#[test]
fn names_of_devices_are_no_names_of_files() {
    for name in ["con", "NUL", "Prn", "aux", "com1", "LPT9"] {
        let (path, message) = only("name: full", &format!("name: {name}"));
        assert_eq!(path, "name");
        assert!(message.contains("Windows"), "{message}");
        let (path, _) = only("- id: alpha", &format!("- id: {name}"));
        assert_eq!(path, "vehicles[0].id");
    }
    for name in ["cone", "com0", "com10", "lpt", "null"] {
        good(&with("name: full", &format!("name: {name}")));
    }
}

#[test]
fn the_area_lies_between_its_corners() {
    assert_eq!(
        only("north_east: {lat: 36.40", "north_east: {lat: 36.10").0,
        "area.south_west"
    );
    assert_eq!(
        only("origin: {lat: 36.30", "origin: {lat: 46.30").0,
        "origin"
    );
}

#[test]
fn one_pad_needs_staggered_departures() {
    let home = |text: &str| {
        text.replace(
            "link: tcp:127.0.0.1:5760",
            "link: sim\n    home: {lat: 36.21, lon: -84.3901}",
        )
    };
    let text = home(FULL);
    let issue = &issues(&text)[0];
    assert_eq!(issue.path, "vehicles[1]");
    assert!(issue.found.contains("from `alpha`"), "{issue:?}");
    // 5 s against a departure at 15.1 s with a slack of 10 s.
    good(&text.replace("speed_mps: 12", "speed_mps: 12\n    depart_s: 15.1"));
    assert_eq!(
        issues(&text.replace("speed_mps: 12", "speed_mps: 12\n    depart_s: 14.9")).len(),
        1
    );
}

#[test]
fn a_place_on_the_edge_of_the_area_is_told_from_one_outside_of_it() {
    for (old, new, is) in [
        (
            "start: {lat: 36.21, lon: -84.38,",
            "start: {lat: 36.20, lon: -84.38,",
            "is on the edge of the area",
        ),
        (
            "start: {lat: 36.21, lon: -84.38,",
            "start: {lat: 36.19, lon: -84.38,",
            "is outside of the area",
        ),
    ] {
        let (path, said) = only(old, new);
        assert_eq!(path, "vehicles[0].start");
        assert!(said.contains(is), "{said}");
    }
}

#[test]
fn a_huge_number_is_said_in_few_digits() {
    for (old, new) in [
        ("speed_mps: 15", "speed_mps: 1e308"),
        ("max_amsl_m: 1500", "max_amsl_m: 1e308"),
        ("sysid: 2", "sysid: 1e308"),
    ] {
        let text = with(old, new);
        let found = issues(&text);
        assert!(
            found[0].found.contains("1e308") && found[0].found.len() < 60,
            "{found:?}"
        );
    }
}

#[test]
fn a_number_written_as_in_a_program_says_what_is_wrong_with_it() {
    let (path, said) = only("speed_mps: 15", "speed_mps: 0x10");
    assert_eq!(path, "vehicles[0].speed_mps");
    assert!(
        said.contains("16 in hexadecimal, octal or binary digits"),
        "{said}"
    );
    assert!(
        said.contains("(allowed: a number in decimal digits, such as 16)"),
        "{said}"
    );
}

#[test]
fn an_autopilot_version_is_one_whose_rules_are_known() {
    let version = |text: &str| format!("autopilot: ardupilot\n    autopilot_version: {text}");
    let spec = good(&with("autopilot: ardupilot", &version("\"4.7\"")));
    let found = spec.vehicles[0].autopilot_version.map(|v| v.to_string());
    assert_eq!(found.as_deref(), Some("4.7"));
    assert_eq!(spec.vehicles[1].autopilot_version, None);
    let (path, text) = only("autopilot: ardupilot", &version("\"3.6\""));
    assert_eq!(path, "vehicles[0].autopilot_version");
    assert!(
        text.contains("`3.6` (allowed: 4.6, 4.7 for ardupilot)"),
        "{text}"
    );
    let px4 = "autopilot: px4\n    autopilot_version: \"4.7\"";
    let (_, text) = only("autopilot: px4", px4);
    assert!(
        text.contains("(allowed: 1.17, 1.18, 1.19 for px4)"),
        "{text}"
    );
}

#[test]
fn a_place_with_latitude_and_longitude_exchanged_is_named_as_it_was_written_and_recognised() {
    // An area in which both orders are places on earth.
    let text = "\
sortie: 2
name: swapped
area: {south_west: {lat: 46.90, lon: 7.30}, north_east: {lat: 47.00, lon: 7.50}, min_agl_m: 30, max_amsl_m: 900}
terrain: {flat: {amsl_m: 500}}
zones: [{id: z, polygon: [[46.94, 7.38], [46.95, 7.38], [46.95, 7.40]], holes: []}]
vehicles:
  - {id: a, sysid: 1, autopilot: ardupilot, link: sim, start: {lat: 46.91, lon: 7.32, agl_m: 60},
     goal: {lat: 46.98, lon: 7.46, agl_m: 60}, finish: land, speed_mps: 8,
     stops: [{id: s, lat: 46.93, lon: 7.36, agl_m: 60, actions: [{roi: {lat: 46.93, lon: 7.37, agl_m: 0}}]}]}
tasks: [{id: t, survey: {polygon: [[46.96, 7.40], [46.962, 7.40], [46.962, 7.403]], swath_m: 50, agl_m: 60}}]
";
    good(text);
    for (old, new, path) in [
        ("[46.94, 7.38]", "[7.38, 46.94]", "zones[0].polygon[0]"),
        (
            "holes: []",
            "holes: [[[7.38, 46.94], [7.38, 46.95], [7.40, 46.95]]]",
            "zones[0].holes[0][0]",
        ),
        (
            "start: {lat: 46.91, lon: 7.32",
            "start: {lat: 7.32, lon: 46.91",
            "vehicles[0].start",
        ),
        (
            "lat: 46.93, lon: 7.36",
            "lat: 7.36, lon: 46.93",
            "vehicles[0].stops[0]",
        ),
        (
            "roi: {lat: 46.93, lon: 7.37",
            "roi: {lat: 7.37, lon: 46.93",
            "vehicles[0].stops[0].actions[0].roi",
        ),
        (
            "[46.962, 7.40]",
            "[7.40, 46.962]",
            "tasks[0].survey.polygon[1]",
        ),
    ] {
        assert!(text.contains(old), "{old}");
        let found = issues(&text.replacen(old, new, 1));
        assert_eq!(found[0].path, path, "{found:#?}");
        assert!(
            found
                .iter()
                .all(|issue| issue.allowed.contains("exchanged?")),
            "{found:#?}"
        );
        let written: Vec<&str> = new.split(|c: char| !"0123456789.".contains(c)).collect();
        let first = written
            .iter()
            .find(|part| part.len() > 3)
            .expect("a number");
        assert!(
            found[0].found.contains(first.trim_end_matches('0')),
            "{found:#?}"
        );
    }
}

#[test]
fn the_edges_of_a_large_polygon_that_crosses_itself_are_named_by_its_corners() {
    // Its edges of 40 km are drawn in pieces.
    let (path, text) = only(
        "[[36.35, -84.20], [36.36, -84.20], [36.36, -84.18]], below_amsl_m: 900",
        "[[36.0, -84.6], [36.4, -84.0], [36.4, -84.6], [36.0, -84.0]], below_amsl_m: 900",
    );
    assert_eq!(path, "no_fly[0].polygon[2]");
    assert!(
        text.contains("the edge from corner 2 to 3 meets the edge from corner 0 to 1"),
        "{text}"
    );
}
