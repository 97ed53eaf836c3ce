//! Vehicles in a compact form: what they become, and where a mistake in them is found.

use super::*;

/// Three vehicles north of three others, by two grids.
const GRIDS: &str = "\
fleet:
  id: d{n:02}
  depart_every_s: 20
  start_grid: {south_west: {lat: 36.21, lon: -84.39}, rows: 1, columns: 3, spacing_m: 500}
  goal_grid: {south_west: {lat: 36.39, lon: -84.39}, rows: 1, columns: 3, spacing_m: 500}
  defaults:
    autopilot: ardupilot
    link: tcp:127.0.0.1:{5750+10*n}
    start: {agl_m: 80}
    goal: {agl_m: 90}
    finish: land
    speed_mps: 12
    depart_s: 100
";

/// The same defaults, and the rest in a table.
const TABLE: &str = "\
fleet:
  csv: fleet.csv
  defaults:
    autopilot: ardupilot
    link: sim
    start: {agl_m: 80}
    goal: {agl_m: 90}
    finish: land
    speed_mps: 12
";

/// The full spec without its vehicles, with others instead.
fn fleet(vehicles: &str) -> String {
    let (before, rest) = FULL.split_once("vehicles:\n").expect("vehicles");
    let (_, after) = rest.split_once("separation:").expect("separation");
    format!("{before}{vehicles}separation:{after}")
}

/// A spec beside a table, read.
fn beside(spec: &str, table: &str) -> Result<SpecFile, SpecError> {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("fleet.csv"), table).expect("written");
    fs::write(folder.path().join("mission.yaml"), spec).expect("written");
    SpecFile::read(&folder.path().join("mission.yaml"))
}

/// What a person reads, without the folder.
fn said(spec: &str, table: &str) -> Vec<String> {
    let error = beside(spec, table).expect_err("a problem");
    let lines = error.to_string();
    let short = |line: &str| {
        let at = line.find("mission.yaml").or(line.find("fleet.csv"));
        line[at.expect("a file")..].to_owned()
    };
    lines.lines().map(short).collect()
}

#[test]
fn grids_become_vehicles_row_by_row_after_those_that_are_listed() {
    let text = FULL.replace("separation:", &format!("{GRIDS}separation:"));
    let spec = good(&text);
    let ids: Vec<&str> = spec.vehicles.iter().map(|one| one.id.as_str()).collect();
    assert_eq!(ids, ["alpha", "bravo", "d01", "d02", "d03"]);
    let sysids: Vec<u8> = spec.vehicles.iter().map(|one| one.sysid).collect();
    assert_eq!(sysids, [1, 2, 3, 4, 5], "past those that are taken");
    let [_, _, first, second, third] = &spec.vehicles[..] else {
        panic!("five vehicles")
    };
    assert_eq!(second.link, Link::Tcp("127.0.0.1:5770".to_owned()));
    assert_eq!(third.depart_s.to_bits(), 140_f64.to_bits());
    assert_eq!(first.goal.altitude, Placement::Agl(Agl(90.0)));
    let apart_m = first.start.place.chord_m(third.start.place);
    assert!((apart_m - 1000.0).abs() < 1e-3, "{apart_m} m");
    assert!(first.start.place.lon_deg < third.start.place.lon_deg);
    let north_m = first.goal.place.chord_m(first.start.place);
    assert!((19_000.0..21_000.0).contains(&north_m), "{north_m} m");
}

#[test]
fn a_table_gives_any_key_of_a_vehicle_and_an_empty_cell_the_default() {
    let table = "\
# made by hand
id, start_lat, start_lon, goal_lat, goal_lon, goal_amsl_m, speed_mps, autopilot, sysid, home_lat, home_lon
x1,     36.21,    -84.38,    36.39,   -84.38,         700,          , px4,           9,         ,

\"x2\", 36.21,    -84.37,    36.39,   -84.37,            ,         7,    ,            ,    36.205, -84.37
";
    let file = beside(&fleet(TABLE), table).unwrap_or_else(|error| panic!("{error}"));
    let [one, two] = &file.spec.vehicles[..] else {
        panic!("two vehicles")
    };
    assert_eq!((one.id.as_str(), one.sysid), ("x1", 9));
    assert_eq!((two.id.as_str(), two.sysid), ("x2", 1));
    assert_eq!(
        (one.autopilot, two.autopilot),
        (Autopilot::Px4, Autopilot::ArduPilot)
    );
    assert_eq!(
        (one.goal.altitude, two.goal.altitude),
        (Placement::Amsl(Amsl(700.0)), Placement::Agl(Agl(90.0)))
    );
    assert_eq!(
        [one.speed_mps, two.speed_mps].map(f64::to_bits),
        [12.0, 7.0].map(f64::to_bits)
    );
    assert_eq!(one.home, one.start.place);
    assert!(two.home.lat_deg < two.start.place.lat_deg);
    let kept = file.table.expect("its table");
    assert_eq!(
        (kept.name.to_str(), kept.text.as_str()),
        (Some("fleet.csv"), table)
    );
}

#[test]
fn mistakes_in_a_table_are_told_by_row_and_column_all_at_once() {
    let table = "\
id,start_lat,start_lon,goal_lat,goal_lon,speed,autopilot
x1,123,-84.38,36.39,-84.38,3,
x2,36.21,fast,36.39,-84.37,,ardupilot
x1,36.21,-84.36,,-84.36,,betaflight
x4,36.21,-84.38,36.39,-84.35
x5,36.21,-84.38,36.39,-84.35,,
";
    // The number of cells comes first: what stands where is not sure before that.
    let found = said(&fleet(TABLE), table);
    assert_eq!(
        found,
        ["fleet.csv: row 5: 5 cells (allowed: 7, as in the row of names)"]
    );
    assert_eq!(said(&fleet(TABLE), &table.replace('\n', "\r\n")), found);
    let table = table.replace("x4,36.21,-84.38,36.39,-84.35\n", "");
    let found = said(&fleet(TABLE), &table);
    let starts = [
        "fleet.csv: row 1, column 6 (speed): an unknown column: did you mean `speed_mps`? (allowed: accel_mps2, airframe,",
        "fleet.csv: row 2, column 2 (start_lat): 123 (allowed: -90 to 90)",
        "fleet.csv: row 3, column 3 (start_lon): `fast` (allowed: a number)",
        "fleet.csv: row 3, column 3 (start_lon): an empty cell",
        "fleet.csv: row 4, column 1 (id): `x1`, already the id of row 2 of",
        "fleet.csv: row 4, column 4 (goal_lat): an empty cell (allowed: a value, or goal.lat",
        "fleet.csv: row 4, column 7 (autopilot): `betaflight` (allowed: `ardupilot` or `px4`)",
    ];
    assert!(found.len() >= 5, "{found:#?}");
    for line in &found {
        assert!(
            starts.iter().any(|start| line.starts_with(start)),
            "{line}\n{found:#?}"
        );
    }
}

#[test]
fn a_cell_in_hexadecimal_digits_says_what_is_wrong_with_it() {
    let table = "id,start_lat,start_lon,goal_lat,goal_lon\nx1,36.21,-84.38,36.39,-0x54\n";
    let start = "fleet.csv: row 2, column 5 (goal_lon): `-0x54` (allowed: a number in decimal";
    let found = said(&fleet(TABLE), table);
    assert!(
        found.iter().any(|line| line.starts_with(start)),
        "{found:#?}"
    );
}

#[test]
fn vehicles_of_a_table_meet_the_checks_of_all_vehicles() {
    let table = "\
id,start_lat,start_lon,goal_lat,goal_lon,sysid
x1,36.21,-84.38,36.39,-84.38,7
x1,36.21,-84.36,36.39,-84.36,7
x3,36.32,-84.26,36.39,-84.26,
x4,36.21,-84.30,36.10,-84.30,
x5,36.2101,-84.30,36.39,-84.30,
";
    let found = said(&fleet(TABLE), table);
    let starts = [
        "fleet.csv: row 3, column 1 (id): `x1`, already the id of",
        "fleet.csv: row 3, column 6 (sysid): 7, already the system id of `x1`",
        "fleet.csv: row 4, column 2 (start_lat): start is inside threat `radar-1`",
        "fleet.csv: row 5, column 4 (goal_lat): goal at 36.1, -84.3 is outside of the area",
        "fleet.csv: row 6: takeoff 11.1 m from `x4` and 0 s apart in time",
    ];
    assert_eq!(found.len(), starts.len(), "{found:#?}");
    for (line, start) in found.iter().zip(starts) {
        assert!(line.starts_with(start), "{line}\nnot {start}");
    }
}

#[test]
fn what_shows_over_the_ground_is_told_by_row_too() {
    let folder = tempfile::tempdir().expect("a folder");
    let table = "id,start_lat,start_lon,start_amsl_m,goal_lat,goal_lon\n\
                 x1,36.21,-84.38,350,36.39,-84.38\n";
    fs::write(folder.path().join("fleet.csv"), table).expect("written");
    fs::write(folder.path().join("m.yaml"), fleet(TABLE)).expect("written");
    let file = SpecFile::read(&folder.path().join("m.yaml")).expect("good so far");
    let message = world::load(&file).expect_err("too low").to_string();
    assert!(
        message.contains("fleet.csv: row 2, column 2 (start_lat): start is 50.0 m above ground"),
        "{message}"
    );
}

#[test]
fn what_the_defaults_say_wrong_is_told_once() {
    let text = fleet(&GRIDS.replace("speed_mps: 12", "speed_mps: 200"));
    let error = parse(&text).expect_err("too fast");
    let (line, column) = place_of(&text, "200\n");
    assert_eq!(
        error.to_string(),
        format!(
            "mission.yaml:{line}:{column}: fleet.defaults.speed_mps: 200 (allowed: 0.5 to 100)"
        )
    );
    // What is wrong with many vehicles alike names the first and counts the others.
    let text = fleet(&GRIDS.replace("spacing_m: 500}\n  goal", "spacing_m: 50}\n  goal"))
        .replace("depart_every_s: 20", "depart_every_s: 0");
    let error = parse(&text).expect_err("one pad").to_string();
    assert_eq!(error.lines().count(), 1, "{error}");
    assert!(
        error.contains("fleet: `d02`: takeoff 50.0 m from `d01`") && error.contains("more like it"),
        "{error}"
    );
}

#[test]
fn a_fleet_without_what_it_needs_says_what() {
    for (from, to, path, words) in [
        ("  id: d{n:02}\n", "", "fleet", "no names"),
        ("d{n:02}", "d{m}", "fleet.id", "`d{m}`"),
        ("d{n:02}", "drone", "fleet.id", "{n}"),
        ("{5750+10*n}", "{n-1}", "fleet.defaults.link", "{14550+n}"),
        ("    finish: land\n", "", "fleet.defaults", "no finish"),
        (
            "goal: {agl_m: 90}",
            "goal: {}",
            "fleet.goal_grid",
            "no altitude",
        ),
        ("  goal_grid:", "  #", "fleet.defaults", "goal_grid"),
        (
            "columns: 3",
            "columns: 2",
            "fleet.goal_grid",
            "3 goals for 2 starts",
        ),
        (
            "columns: 3",
            "columns: 0",
            "fleet.start_grid.columns",
            "1 to 10000",
        ),
        (
            "spacing_m: 500",
            "spacing_m: .nan",
            "fleet.start_grid.spacing_m",
            "0.1 to",
        ),
        (
            "lat: 36.21",
            "lat: 100",
            "fleet.start_grid.south_west.lat",
            "-90 to 90",
        ),
        (
            "rows: 1, columns: 3",
            "rows: 5000, columns: 3",
            "fleet.start_grid",
            "15000 places",
        ),
        (
            "depart_every_s: 20",
            "depart_every_s: -1",
            "fleet.depart_every_s",
            "0 to",
        ),
        (
            "  depart_every",
            "  first_sysid: 0\n  depart_every",
            "fleet.first_sysid",
            "1 to 240",
        ),
        ("  id:", "  csv: a.txt\n  id:", "fleet.csv", "ends in .csv"),
        ("  id:", "  csv: ../a.csv\n  id:", "fleet.csv", "without .."),
        (
            "  id:",
            "  csv: /a.csv\n  id:",
            "fleet.csv",
            "relative to the spec",
        ),
        (
            "  id:",
            "  csv: none.csv\n  id:",
            "fleet.csv",
            "cannot be read",
        ),
        (
            "  id:",
            "  number: 3\n  id:",
            "fleet.number",
            "unknown field",
        ),
    ] {
        let found = issues(&fleet(&GRIDS.replacen(from, to, 1)));
        let issue = found.iter().find(|issue| issue.path == path);
        let issue = issue.unwrap_or_else(|| panic!("{from} -> {to}: {found:#?}"));
        assert!(issue.position.is_some(), "{issue:?}");
        let all = format!("{} {}", issue.found, issue.allowed);
        assert!(all.contains(words), "{from} -> {to}: {issue:?}");
    }
}

#[test]
fn windows_and_ranges_are_for_vehicles_whose_files_can_carry_them() {
    let window = "    depart_s: 5\n    depart_window_s: {from: 0, to: 60}\n";
    let range = "    depart_s: 5\n    speed_range_mps: {min: 10, max: 15}\n";
    let spec = good(&with(
        "    depart_s: 5\n",
        &format!("{window}{}", &range[16..]),
    ));
    let alpha = &spec.vehicles[0];
    assert_eq!(alpha.departures().most.to_bits(), 60_f64.to_bits());
    assert_eq!(alpha.speeds().least.to_bits(), 10_f64.to_bits());
    let opens = window
        .replace("depart_s: 5", "accel_mps2: 2")
        .replace("from: 0", "from: 7");
    let spec = good(&with("    accel_mps2: 2\n    depart_s: 5\n", &opens));
    assert_eq!(spec.vehicles[0].depart_s.to_bits(), 7_f64.to_bits());
    for (text, path, words) in [
        (
            window.replace("to: 60", "to: 4"),
            "depart_window_s",
            "without depart_s 5",
        ),
        (
            window.replace("from: 0", "from: 61"),
            "depart_window_s",
            "from at most to",
        ),
        (
            window.replace("from: 0", "from: -1"),
            "depart_window_s.from",
            "0 to 86400",
        ),
        (
            window.replace("to: 60", "to: .nan"),
            "depart_window_s.to",
            "0 to 86400",
        ),
        (
            range.replace("max: 15", "max: 14"),
            "speed_range_mps",
            "without speed_mps 15",
        ),
        (
            range.replace("min: 10", "min: 0"),
            "speed_range_mps.min",
            "0.5 to 100",
        ),
    ] {
        let (found, message) = only("    depart_s: 5\n", &text);
        assert_eq!(found, format!("vehicles[0].{path}"), "{message}");
        assert!(message.contains(words), "{message}");
    }
    // PX4 has its speed in a parameter.
    let (path, message) = only(
        "    speed_mps: 12\n",
        "    speed_mps: 12\n    speed_range_mps: {min: 10, max: 15}\n",
    );
    assert_eq!(path, "vehicles[1].speed_range_mps");
    assert!(message.contains("no mission file"), "{message}");
    // Nor has a file of a plane its departure.
    let plane = with("    airframe: copter\n", "    airframe: plane\n    takeoff_heading_deg: 90\n    landing: {heading_deg: 90, glide_deg: 6}\n")
        .replace("    return_amsl_m: 900\n", window.split_once('\n').expect("lines").1);
    let found = issues(&plane);
    assert!(
        found
            .iter()
            .any(|issue| issue.path == "vehicles[0].depart_window_s"),
        "{found:#?}"
    );
}

#[test]
fn takeoffs_from_one_pad_may_be_left_to_a_window() {
    let crowd = GRIDS
        .replace(
            "columns: 3, spacing_m: 500}\n  goal",
            "columns: 3, spacing_m: 50}\n  goal",
        )
        .replace("depart_every_s: 20", "depart_every_s: 0");
    assert!(issues(&fleet(&crowd))[0].found.contains("takeoff 50.0 m"));
    let text = crowd.replace(
        "    depart_s: 100\n",
        "    depart_window_s: {from: 0, to: 60}\n",
    );
    assert_eq!(good(&fleet(&text)).vehicles.len(), 3);
}

#[test]
fn a_table_without_vehicles_and_one_with_grids_are_errors() {
    assert!(said(&fleet(TABLE), "")[0].contains("an empty table"));
    assert!(said(&fleet(TABLE), "id,start_lat\n")[0].contains("no vehicle"));
    assert!(said(&fleet(TABLE), "id,id\na,b\n")[0].contains("a second time"));
    let both = GRIDS.replace("  id:", "  csv: fleet.csv\n  id:");
    assert!(said(&fleet(&both), "id\n1\n")[0].contains("either csv or grids"));
    let found = issues(&fleet(""));
    assert_eq!(
        (found[0].path.as_str(), found[0].found.as_str()),
        ("vehicles", "no vehicle")
    );
}

#[test]
fn more_vehicles_than_system_ids_have_one_each_on_their_link() {
    let many = GRIDS
        .replace(
            "rows: 1, columns: 3, spacing_m: 500",
            "rows: 5, columns: 60, spacing_m: 160",
        )
        .replace("lat: 36.39", "lat: 36.30")
        .replace("depart_every_s: 20", "depart_every_s: 0");
    let text = fleet(&many).replace("radius_m: 3000", "radius_m: 1");
    let spec = good(&text);
    assert_eq!(spec.vehicles.len(), 300);
    let sysids: Vec<u8> = spec.vehicles.iter().map(|one| one.sysid).collect();
    assert_eq!((sysids[0], sysids[239], sysids[240]), (1, 240, 1));
    good(&text.replace("tcp:127.0.0.1:{5750+10*n}", "sim"));
    // On one link the sixty-first id of a second round would be somebody else's.
    let found = issues(&text.replace("{5750+10*n}", "5760"));
    assert_eq!(found.len(), 1, "{found:#?}");
    assert!(
        found[0].allowed.contains("on a link") && found[0].found.contains("59 more"),
        "{found:?}"
    );
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig::with_cases(200))]

    #[test]
    fn no_table_makes_it_panic(table in "(id|start_lat|speed_mps|[0-9.,\"\n#;a-z -]){0,60}") {
        let _ = beside(&fleet(TABLE), &table);
    }
}
