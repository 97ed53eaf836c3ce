//! `sortie review` of missions without a spec: what is assumed, and what cannot be guessed.

use std::fs;

use crate::support::command::{sortie, text};

/// A row of a `.waypoints` file: command, frame, the four parameters, place and altitude.
pub(crate) struct Row(
    pub(crate) u16,
    pub(crate) u8,
    pub(crate) [f32; 4],
    pub(crate) f64,
    pub(crate) f64,
    pub(crate) f64,
);

/// A takeoff, or a waypoint, above home.
pub(crate) fn waypoint(lat: f64, lon: f64, above_home_m: f64) -> Row {
    Row(16, 3, [0.0; 4], lat, lon, above_home_m)
}
pub(crate) fn takeoff() -> Row {
    Row(22, 3, [0.0; 4], 0.0, 0.0, 50.0)
}
pub(crate) fn land(lat: f64, lon: f64) -> Row {
    Row(21, 3, [0.0; 4], lat, lon, 0.0)
}
pub(crate) fn command(number: u16, params: [f32; 4]) -> Row {
    Row(number, 3, params, 0.0, 0.0, 0.0)
}

pub(crate) const HOME: (f64, f64) = (46.0, 8.0);

/// A `.waypoints` file of rows, with a home.
pub(crate) fn file_of(home: (f64, f64), rows: &[Row]) -> String {
    let mut file = format!(
        "QGC WPL 110\n0\t1\t0\t16\t0\t0\t0\t0\t{}\t{}\t500\t1\n",
        home.0, home.1
    );
    for (index, Row(command, frame, [a, b, c, d], lat, lon, alt)) in rows.iter().enumerate() {
        let seq = index + 1;
        file +=
            &format!("{seq}\t0\t{frame}\t{command}\t{a}\t{b}\t{c}\t{d}\t{lat}\t{lon}\t{alt}\t1\n");
    }
    file
}

/// Exit code, standard output and standard error of a review of these rows.
pub(crate) fn review(
    home: (f64, f64),
    rows: &[Row],
    flags: &[&str],
) -> (Option<i32>, String, String) {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("m.waypoints"), file_of(home, rows)).expect("written");
    let mut arguments = vec!["review", "m.waypoints"];
    arguments.extend(flags);
    let output = sortie(folder.path(), &arguments);
    (
        output.status.code(),
        text(&output.stdout),
        text(&output.stderr),
    )
}

pub(crate) const COPTER: [&str; 3] = ["--no-terrain", "--airframe", "copter"];

#[test]
fn the_airframe_that_no_file_states_is_said() {
    let rows = [takeoff(), waypoint(46.001, 8.0, 50.0), land(46.001, 8.0)];
    let (code, out, errors) = review(HOME, &rows, &["--no-terrain"]);
    assert_eq!(code, Some(0), "{out}{errors}");
    assert!(
        errors.contains("judged as a copter (--airframe)"),
        "{errors}"
    );
    let (code, _, errors) = review(HOME, &rows, &COPTER);
    assert_eq!(code, Some(0), "{errors}");
    assert!(!errors.contains("--airframe"), "{errors}");
}

#[test]
fn items_of_wings_are_never_guessed_to_be_for_a_copter() {
    let to_alt = Row(31, 3, [0.0; 4], 46.002, 8.0, 60.0);
    let takeoff_vtol = Row(84, 3, [0.0; 4], 46.0, 8.0, 50.0);
    let land_vtol = Row(85, 3, [0.0; 4], 46.001, 8.0, 0.0);
    let way = || waypoint(46.001, 8.0, 50.0);
    let cases = [
        (
            vec![takeoff_vtol, way(), land(46.0, 8.0)],
            "item 1 (NAV_VTOL_TAKEOFF)",
        ),
        (vec![takeoff(), way(), land_vtol], "item 3 (NAV_VTOL_LAND)"),
        (
            vec![takeoff(), way(), command(189, [0.0; 4]), land(46.001, 8.0)],
            "item 3 (DO_LAND_START)",
        ),
        (
            vec![
                takeoff(),
                command(3000, [4.0, 0.0, 0.0, 0.0]),
                way(),
                land(46.001, 8.0),
            ],
            "item 2 (DO_VTOL_TRANSITION)",
        ),
        (
            vec![takeoff(), way(), to_alt, land(46.001, 8.0)],
            "item 3 (NAV_LOITER_TO_ALT before a landing) is one of planes and vtol, and of copters as well",
        ),
    ];
    for (rows, item) in cases {
        let (code, out, errors) = review(HOME, &rows, &["--no-terrain"]);
        assert_eq!(code, Some(4), "{item}: {out}{errors}");
        assert!(errors.contains(item), "{item}: {errors}");
        assert!(
            errors.contains("cannot be judged") && errors.contains("say --airframe"),
            "{errors}"
        );
    }
}

#[test]
fn a_waypoint_that_is_not_above_home_fails_without_terrain() {
    for (above_home_m, passes) in [(-458.0, false), (-20.0, false), (-0.5, false), (1.0, true)] {
        let rows = [
            takeoff(),
            waypoint(46.001, 8.0, above_home_m),
            land(46.001, 8.0),
        ];
        let (code, out, errors) = review(HOME, &rows, &COPTER);
        assert_eq!(code == Some(0), passes, "{above_home_m}: {out}{errors}");
        let line = out
            .lines()
            .find(|line| line.contains("altitude above home"));
        let line = line.unwrap_or_else(|| panic!("{above_home_m}: {out}"));
        assert!(line.contains("FAIL") != passes, "{line}");
        assert!(passes || out.contains("--terrain"), "{out}");
    }
    // The same place above the sea.
    let low = Row(16, 0, [0.0; 4], 46.001, 8.0, 42.0);
    let (code, out, _) = review(HOME, &[takeoff(), low, land(46.001, 8.0)], &COPTER);
    assert_eq!(code, Some(4), "{out}");
    assert!(out.contains("-458.0 m"), "{out}");
}

#[test]
fn latitude_and_longitude_swapped_are_named_with_the_distance() {
    let home = (45.05, 43.30);
    let rows = [
        takeoff(),
        waypoint(43.301, 45.05, 50.0),
        land(43.301, 45.05),
    ];
    let (_, _, errors) = review(home, &rows, &COPTER);
    assert!(
        errors.contains("warning: m: items: 239 km from home"),
        "{errors}"
    );
    assert!(errors.contains("swapped it would be 0.1 km"), "{errors}");
    let rows = [
        takeoff(),
        waypoint(45.051, 43.30, 50.0),
        land(45.051, 43.30),
    ];
    let (_, _, errors) = review(home, &rows, &COPTER);
    assert!(!errors.contains("warning"), "{errors}");
}

/// `missions/first.yaml` lies elsewhere; a zone with swapped corners is no error, and is named.
#[test]
fn a_zone_of_a_spec_with_swapped_corners_is_named_by_check() {
    let folder = tempfile::tempdir().expect("a folder");
    let spec = "sortie: 1\nname: near-45\narea:\n  south_west: {lat: 45.00, lon: 43.20}\n  north_east: {lat: 45.10, lon: 43.40}\n  min_agl_m: 50\n  max_amsl_m: 2000\nterrain: {flat: {amsl_m: 300}}\nno_fly:\n  - {id: town, polygon: [[43.29, 45.04], [43.29, 45.05], [43.30, 45.05]]}\nvehicles:\n  - id: alpha\n    sysid: 1\n    autopilot: ardupilot\n    link: sim\n    start: {lat: 45.02, lon: 43.25, agl_m: 80}\n    goal: {lat: 45.08, lon: 43.35, agl_m: 80}\n    finish: land\n    speed_mps: 10\n";
    fs::write(folder.path().join("m.yaml"), spec).expect("written");
    let output = sortie(folder.path(), &["check", "m.yaml"]);
    let errors = text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{errors}");
    assert!(
        errors.contains("warning: zone town:") && errors.contains("swapped"),
        "{errors}"
    );
}

/// The greatest altitude of a review in metres above the sea, from its table.
fn top_m(out: &str) -> f64 {
    let line = out.lines().find(|line| line.contains("ceiling"));
    let line = line.unwrap_or_else(|| panic!("{out}"));
    let words: Vec<&str> = line.split_whitespace().collect();
    let name = words.iter().position(|word| *word == "ceiling");
    words[name.expect("a row") + 1].parse().expect("a number")
}

#[test]
fn px4_starts_a_mission_without_a_takeoff_by_itself() {
    let rows = [
        waypoint(46.001, 8.0, 40.0),
        waypoint(46.002, 8.0, 60.0),
        land(46.002, 8.0),
    ];
    let flags = ["--no-terrain", "--airframe", "copter", "--autopilot", "px4"];
    let (code, out, errors) = review(HOME, &rows, &flags);
    assert_eq!(code, Some(0), "{out}{errors}");
}

#[test]
fn a_mission_without_a_takeoff_is_judged_from_its_first_place_on() {
    let rows = || [waypoint(46.001, 8.0, 50.0), land(46.001, 8.0)];
    let (code, out, _) = review(HOME, &rows(), &COPTER);
    assert_eq!(code, Some(4), "{out}");
    assert!(
        out.contains("takeoff first") && out.contains("--airborne"),
        "{out}"
    );
    assert!(!out.contains("cannot judge"), "{out}");
    let in_air = [COPTER.as_slice(), &["--airborne"]].concat();
    let (code, out, errors) = review(HOME, &rows(), &in_air);
    assert_eq!(code, Some(0), "{out}{errors}");
    assert!(errors.contains("begun in the air at item 1"), "{errors}");
    // What is below home is so in the air as well.
    let low = [
        waypoint(46.001, 8.0, -5.0),
        waypoint(46.002, 8.0, -5.0),
        land(46.002, 8.0),
    ];
    assert_eq!(review(HOME, &low, &in_air).0, Some(4));
}

/// `ModeRTL::compute_return_target`: `RTL_ALT` 15 m, `RTL_CONE_SLOPE` 3.
#[test]
fn a_return_without_its_altitude_is_flown_by_the_defaults_and_says_so() {
    let ceiling = [COPTER.as_slice(), &["--max-amsl", "900"]].concat();
    // 334 m from home: 15 m above it. 0.9 m from home, and above: stays.
    for (lat, above_home_m, top) in [
        (46.003, 10.0, 515.0),
        (46.000_008, 10.0, 510.0),
        (46.003, 40.0, 540.0),
    ] {
        let takeoff = Row(22, 3, [0.0; 4], 0.0, 0.0, above_home_m);
        let rows = [
            takeoff,
            waypoint(lat, 8.0, above_home_m),
            command(20, [0.0; 4]),
        ];
        let (code, out, errors) = review(HOME, &rows, &ceiling);
        assert_eq!(code, Some(0), "{out}{errors}");
        assert!((top_m(&out) - top).abs() < 0.06, "{top}: {out}");
        assert!(errors.contains("RTL_ALT 1500"), "{errors}");
    }
}

/// ArduCopter, `ModeAuto::loc_from_cmd`: 0 is the altitude, and 0, 0 the place, of the moment.
#[test]
fn an_altitude_of_zero_and_a_place_of_zeros_are_those_before() {
    let rows = [
        takeoff(),
        waypoint(46.001, 8.0, 70.0),
        waypoint(46.002, 8.0, 0.0),
        waypoint(0.0, 0.0, 0.0),
        land(46.003, 8.0),
    ];
    let ceiling = [COPTER.as_slice(), &["--max-amsl", "900"]].concat();
    let (code, out, errors) = review(HOME, &rows, &ceiling);
    assert_eq!(code, Some(0), "{out}{errors}");
    assert!((top_m(&out) - 570.0).abs() < 0.06, "{out}");
    let plane = ["--no-terrain", "--airframe", "plane"];
    let (_, out, _) = review(HOME, &rows[..3], &plane);
    assert!(
        out.contains("altitude above home: 0.0 m"),
        "to a plane 0 m is an altitude: {out}"
    );
}

#[test]
fn a_mission_that_repeats_for_ever_is_judged_with_one_lap_and_what_follows_is_never_flown() {
    let repeating = || {
        vec![
            takeoff(),
            waypoint(46.001, 8.0, 50.0),
            waypoint(46.001, 8.002, 50.0),
            waypoint(46.003, 8.002, 50.0),
            command(177, [2.0, -1.0, 0.0, 0.0]),
        ]
    };
    let (code, out, errors) = review(HOME, &repeating(), &COPTER);
    assert_eq!(code, Some(0), "{out}{errors}");
    let mut more = repeating();
    more.push(land(46.0, 8.0));
    let (code, out, _) = review(HOME, &more, &COPTER);
    assert_eq!(code, Some(4), "{out}");
    assert!(
        out.contains("repeats the mission at item 5: item 6 and all after it are never flown"),
        "{out}"
    );
    // The leg from the last item back to the second is flown too.
    for (lat, lon, passes) in [(46.002, 8.001, false), (46.002, 8.0, true)] {
        let mut fenced = repeating();
        fenced.push(Row(5004, 3, [5.0, 0.0, 0.0, 0.0], lat, lon, 0.0));
        let (code, out, _) = review(HOME, &fenced, &COPTER);
        assert_eq!(code == Some(0), passes, "{lat} {lon}: {out}");
    }
}

/// A vehicle that hovers within the repeated part of another mission is in its way at some time.
#[test]
fn a_lap_without_end_keeps_others_away_for_ever() {
    let folder = tempfile::tempdir().expect("a folder");
    let head = |lat: f64, lon: f64| {
        format!(
            "QGC WPL 110\n0\t1\t0\t16\t0\t0\t0\t0\t{lat}\t{lon}\t500\t1\n1\t0\t3\t22\t0\t0\t0\t0\t0\t0\t50\t1\n"
        )
    };
    let repeating = head(46.0, 8.0)
        + "2\t0\t3\t16\t0\t0\t0\t0\t46.0\t8.001\t50\t1\n3\t0\t3\t16\t0\t0\t0\t0\t46.002\t8.001\t50\t1\n4\t0\t3\t16\t0\t0\t0\t0\t46.002\t8.003\t50\t1\n5\t0\t3\t177\t2\t-1\t0\t0\t0\t0\t0\t1\n";
    let hover = |lat, lon| {
        head(lat, lon)
            + "2\t0\t3\t93\t4000\t0\t0\t0\t0\t0\t0\t1\n3\t0\t3\t21\t0\t0\t0\t0\t0\t0\t0\t1\n"
    };
    fs::write(folder.path().join("repeating.waypoints"), repeating).expect("written");
    let flags = [
        "review",
        "repeating.waypoints",
        "other.waypoints",
        "--no-terrain",
        "--airframe",
        "copter",
        "--separation",
        "30",
    ];
    for (lat, lon, passes) in [(46.0016, 8.0016, false), (46.02, 8.0016, true)] {
        fs::write(folder.path().join("other.waypoints"), hover(lat, lon)).expect("written");
        let output = sortie(folder.path(), &flags);
        let out = text(&output.stdout);
        assert_eq!(
            output.status.code() == Some(0),
            passes,
            "{out}{}",
            text(&output.stderr)
        );
    }
}

#[test]
fn after_a_landing_nothing_is_flown() {
    let to_land = || vec![takeoff(), waypoint(46.001, 8.0, 50.0), land(46.001, 8.0)];
    let mut harmless = to_land();
    harmless.push(command(20, [0.0; 4]));
    let (code, out, errors) = review(HOME, &harmless, &COPTER);
    assert_eq!(code, Some(0), "{out}{errors}");
    let said = "warning: m: the vehicle lands at item 3: those after it are never flown";
    assert!(errors.contains(said), "{errors}");
    let mut more = to_land();
    more.extend([takeoff(), waypoint(46.002, 8.0, 50.0), land(46.0, 8.0)]);
    let (code, out, _) = review(HOME, &more, &COPTER);
    assert_eq!(code, Some(4), "{out}");
    assert!(
        out.contains("lands at item 3: item 4 and all after it are never flown"),
        "{out}"
    );
}

#[test]
fn a_copter_goes_on_after_it_has_loitered_to_an_altitude() {
    let to_alt = Row(31, 3, [0.0; 4], 46.001, 8.0, 90.0);
    let rows = [
        takeoff(),
        to_alt,
        waypoint(46.002, 8.0, 50.0),
        land(46.002, 8.0),
    ];
    let ceiling = [COPTER.as_slice(), &["--max-amsl", "900"]].concat();
    let (code, out, errors) = review(HOME, &rows, &ceiling);
    assert_eq!(code, Some(0), "{out}{errors}");
    assert!((top_m(&out) - 590.0).abs() < 0.06, "{out}");
}

/// `Plane::exit_mission_callback`: RTL, at `RTL_ALTITUDE` 100 m, in circles of `WP_LOITER_RAD`.
#[test]
fn a_plane_whose_mission_ends_in_the_air_returns_and_circles_over_home() {
    let rows = [
        takeoff(),
        waypoint(46.01, 8.0, 60.0),
        waypoint(46.01, 8.01, 60.0),
    ];
    let flags = ["--no-terrain", "--airframe", "plane", "--max-amsl", "900"];
    let (code, out, errors) = review(HOME, &rows, &flags);
    assert_eq!(code, Some(0), "{out}{errors}");
    // 6 m over its circle, and 3.3 s of the climb by 40 m on the 1354 m to it at 12 m/s.
    let over_m = 6.0 + 3.3 * 40.0 * 12.0 / 1354.0;
    assert!((top_m(&out) - 600.0 - over_m).abs() < 0.06, "{out}");
    for assumed in [
        "RTL_ALTITUDE 100",
        "WP_LOITER_RAD 60",
        "takes off towards its first waypoint",
    ] {
        assert!(errors.contains(assumed), "{assumed}: {errors}");
    }
}

#[test]
fn flags_are_named_as_flags_and_a_folder_is_reviewed_as_its_files() {
    let rows = || [takeoff(), waypoint(46.001, 8.0, 50.0), land(46.001, 8.0)];
    let wrong = [COPTER.as_slice(), &["--max-climb", "95"]].concat();
    let (code, _, errors) = review(HOME, &rows(), &wrong);
    assert_eq!(code, Some(2), "{errors}");
    assert!(
        errors.contains("--max-climb: ") && !errors.contains("flags:"),
        "{errors}"
    );
    let folder = tempfile::tempdir().expect("a folder");
    let file = "QGC WPL 110\n0\t1\t0\t16\t0\t0\t0\t0\t46.0\t8.0\t500\t1\n1\t0\t3\t22\t0\t0\t0\t0\t0\t0\t50\t1\n2\t0\t3\t21\t0\t0\t0\t0\t0\t0\t0\t1\n";
    fs::create_dir(folder.path().join("missions")).expect("a folder");
    for name in ["a", "b", "c", "d"] {
        let path = folder
            .path()
            .join("missions")
            .join(format!("{name}.waypoints"));
        fs::write(path, file.replace("46.0", &format!("46.{}", name.len()))).expect("written");
    }
    let output = sortie(folder.path(), &["review", "missions", "--no-terrain"]);
    let (out, errors) = (text(&output.stdout), text(&output.stderr));
    for name in ["a", "b", "c", "d"] {
        assert!(
            out.lines().any(|line| line.contains(&format!(" {name} "))),
            "{name}: {out}{errors}"
        );
    }
    assert!(
        errors.contains("a, b, c and 1 more: the file does not say"),
        "{errors}"
    );
    assert_eq!(errors.matches("--autopilot").count(), 1, "{errors}");
}

#[test]
fn a_plane_that_lands_far_below_home_is_not_judged_without_terrain() {
    for (above_home_m, passes) in [(-100.0, false), (40.0, false), (0.0, true)] {
        let climb = Row(22, 3, [10.0, 0.0, 0.0, 0.0], 46.0, 8.0, 50.0);
        let way = [waypoint(46.01, 8.0, 50.0), waypoint(46.02, 8.0, 50.0)];
        let down = Row(21, 3, [0.0; 4], 46.03, 8.0, above_home_m);
        let mut rows = vec![climb];
        rows.extend(way);
        rows.push(down);
        let (code, out, errors) = review(HOME, &rows, &["--no-terrain", "--airframe", "plane"]);
        assert_eq!(code == Some(0), passes, "{above_home_m}: {out}{errors}");
    }
}

/// `AP_Mission::get_next_cmd`: a jump to a tag is one to the first item of that tag.
#[test]
fn a_jump_to_a_tag_is_flown_as_one_to_its_row() {
    let north = |rows: u32| waypoint(46.0 + 0.001 * f64::from(rows), 8.0, 50.0);
    let by_row = [
        takeoff(),
        north(1),
        command(600, [7.0, 0.0, 0.0, 0.0]),
        north(2),
        north(3),
        command(177, [3.0, 2.0, 0.0, 0.0]),
        land(46.003, 8.0),
    ];
    let by_tag = |tag: f32| {
        let mut rows = vec![takeoff(), north(1), command(600, [7.0, 0.0, 0.0, 0.0])];
        rows.extend([north(2), north(3), command(601, [tag, 2.0, 0.0, 0.0])]);
        rows.push(land(46.003, 8.0));
        rows
    };
    let (code, out, errors) = review(HOME, &by_row, &COPTER);
    assert_eq!(code, Some(0), "{out}{errors}");
    let (code, tagged, errors) = review(HOME, &by_tag(7.0), &COPTER);
    assert_eq!(code, Some(0), "{tagged}{errors}");
    assert_eq!(tagged, out);
    let (code, out, _) = review(HOME, &by_tag(8.0), &COPTER);
    assert_eq!(code, Some(4), "{out}");
    assert!(out.contains("JUMP_TAG 8, which there is not"), "{out}");
}

/// A return goes to the nearest of the rally points, or home, by parameters that no file of a
/// mission holds.
#[test]
fn a_return_with_rally_points_is_named_and_never_passes() {
    let rally = "QGC WPL 110\n0\t0\t3\t5100\t0\t0\t0\t0\t46.0005\t8.0\t30\t1\n";
    let file = "QGC WPL 110\n0\t1\t0\t16\t0\t0\t0\t0\t46.0\t8.0\t500\t1\n1\t0\t3\t22\t0\t0\t0\t0\t0\t0\t50\t1\n2\t0\t3\t16\t0\t0\t0\t0\t46.01\t8.0\t50\t1\n3\t0\t3\t20\t0\t0\t0\t0\t0\t0\t0\t1\n";
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("m.waypoints"), file).expect("written");
    fs::write(folder.path().join("rally.txt"), rally).expect("written");
    for airframe in ["copter", "plane"] {
        let flags = [
            "--no-terrain",
            "--takeoff-heading",
            "0",
            "--airframe",
            airframe,
        ];
        let flags = if airframe == "copter" {
            &[&flags[..1], &flags[3..]].concat()[..]
        } else {
            &flags
        };
        let with = [&["review", "m.waypoints", "rally.txt"][..], flags].concat();
        let output = sortie(folder.path(), &with);
        let said = text(&output.stdout) + &text(&output.stderr);
        assert_eq!(output.status.code(), Some(4), "{said}");
        assert!(
            said.contains("item 3 on: NAV_RETURN_TO_LAUNCH with rally points"),
            "{said}"
        );
        let without = [&["review", "m.waypoints"][..], flags].concat();
        let output = sortie(folder.path(), &without);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stdout));
    }
}

/// Both autopilots keep to a steep leg, and fly it as slowly as they climb.
#[test]
fn when_copters_are_where_is_not_known_on_legs_that_they_cannot_climb_so_fast() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |lon: f64, above_m: u32| {
        format!(
            "QGC WPL 110\n0\t1\t0\t16\t0\t0\t0\t0\t46.0\t{lon}\t500\t1\n1\t0\t3\t22\t0\t0\t0\t0\t0\t0\t50\t1\n2\t0\t3\t16\t0\t0\t0\t0\t46.001\t{lon}\t50\t1\n3\t0\t3\t16\t0\t0\t0\t0\t46.002\t{lon}\t{above_m}\t1\n4\t0\t3\t21\t0\t0\t0\t0\t46.002\t{lon}\t0\t1\n"
        )
    };
    let judged = |above_m: u32, files: &[&str], flags: &[&str]| {
        fs::write(folder.path().join("a.waypoints"), file(8.0, above_m)).expect("written");
        fs::write(folder.path().join("b.waypoints"), file(8.01, 50)).expect("written");
        let output = sortie(
            folder.path(),
            &[&["review"], files, COPTER.as_slice(), flags].concat(),
        );
        (
            output.status.code(),
            text(&output.stdout) + &text(&output.stderr),
        )
    };
    let both = ["a.waypoints", "b.waypoints"];
    // 200 m up on 111 m: at 10 m/s that is 18 m/s upwards.
    let (code, said) = judged(250, &both, &["--separation", "30"]);
    assert_eq!(code, Some(4), "{said}");
    assert!(
        said.contains("slower than commanded: when it is where is not known"),
        "{said}"
    );
    let (code, said) = judged(70, &both, &["--separation", "30"]);
    assert_eq!(code, Some(0), "{said}");
    // Where it is does not depend on when.
    let (code, said) = judged(250, &both[..1], &[]);
    assert_eq!(code, Some(0), "{said}");
}

/// TECS climbs no faster than `TECS_CLMB_MAX`: on a steeper leg a plane stays below it.
#[test]
fn a_wing_that_cannot_climb_or_descend_as_its_legs_do_fails() {
    let high = |from: f64, to: f64| {
        [
            takeoff(),
            waypoint(46.01, 8.0, from),
            waypoint(46.013, 8.0, to),
            waypoint(46.03, 8.0, to),
            command(20, [0.0; 4]),
        ]
    };
    let flags = ["--no-terrain", "--airframe", "plane"];
    for (from, to, speed) in [(60.0, 500.0, "climb speed"), (500.0, 60.0, "descent speed")] {
        let (code, out, errors) = review(HOME, &high(from, to), &flags);
        assert_eq!(code, Some(4), "{out}{errors}");
        assert!(out.contains(speed), "{out}");
        assert!(errors.contains("TECS_CLMB_MAX 5"), "{errors}");
    }
    let (code, out, errors) = review(HOME, &high(60.0, 100.0), &flags);
    assert_eq!(code, Some(0), "{out}{errors}");
    assert!(!out.contains("climb speed (--climb)"), "{out}");
}

#[test]
fn jumps_that_repeat_long_circles_or_many_items_fail_at_once_and_name_what_is_allowed() {
    let circles = Row(18, 3, [255.0, 0.0, 2500.0, 0.0], 46.02, 8.04, 60.0);
    let (code, said, why) = review(
        HOME,
        &[
            takeoff(),
            circles,
            command(177, [2.0, 300.0, 0.0, 0.0]),
            command(20, [0.0; 4]),
        ],
        &["--no-terrain"],
    );
    assert_eq!(code, Some(4), "{said}{why}");
    assert!(said.contains("(allowed: 300000)"), "{said}{why}");
    let (code, said, why) = review(
        HOME,
        &[
            takeoff(),
            waypoint(46.0, 8.04, 60.0),
            waypoint(46.01, 8.04, 60.0),
            command(177, [2.0, 30_000.0, 0.0, 0.0]),
            command(20, [0.0; 4]),
        ],
        &["--no-terrain"],
    );
    assert_eq!(code, Some(4), "{said}{why}");
    assert!(said.contains("(allowed: "), "{said}{why}");
}

#[test]
fn a_mission_without_a_home_says_from_where_it_was_judged() {
    let rows = [takeoff(), waypoint(46.001, 8.0, 50.0), land(46.001, 8.0)];
    let (code, out, errors) = review((0.0, 0.0), &rows, &COPTER);
    assert_eq!(code, Some(4), "{out}{errors}");
    let said = format!("{out}{errors}");
    assert!(!said.contains("the spec"), "{said}");
    assert!(
        said.contains("judged from home at 46.0010000, 8.0000000"),
        "{said}"
    );
    assert!(
        said.contains("judged from the ground under its first waypoint (--home LAT,LON,AMSL)"),
        "{said}"
    );
}

#[test]
fn an_empty_plan_is_called_empty() {
    let folder = tempfile::tempdir().expect("a folder");
    for (content, words) in [("", "an empty file"), ("hello", "\"hello\"")] {
        fs::write(folder.path().join("m.plan"), content).expect("written");
        let output = sortie(folder.path(), &["review", "m.plan"]);
        let errors = text(&output.stderr);
        assert_eq!(output.status.code(), Some(3), "{errors}");
        assert!(
            errors.contains(words) && errors.contains("a .plan (JSON)"),
            "{errors}"
        );
    }
}

#[test]
fn a_mission_at_a_pole_is_refused_with_what_is_allowed() {
    let rows = [takeoff(), waypoint(89.991, 8.0, 50.0), land(89.991, 8.0)];
    let (code, _, errors) = review((89.99, 8.0), &rows, &COPTER);
    assert_eq!(code, Some(3), "{errors}");
    let words = "m.waypoints: its places lie within 0.1 degrees of a pole";
    assert!(
        errors.contains(words) && !errors.contains("area"),
        "{errors}"
    );
}
