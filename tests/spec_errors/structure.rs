//! Files that are broken, and what a good one becomes.

use proptest::prelude::*;

use super::*;

#[test]
fn every_key_arrives_in_si_units() {
    let spec = good(FULL);
    assert_eq!(spec.name, "full");
    assert_eq!(
        (spec.area.min_agl, spec.area.max_amsl),
        (Agl(60.0), Amsl(1500.0))
    );
    assert!(
        matches!(&spec.terrain, TerrainSource::Analytic { base: Amsl(base), hills } if *base > 299.0 && hills.len() == 1)
    );
    assert_eq!(
        spec.no_fly[0].ceiling,
        Some(sortie::spec::Placement::Amsl(Amsl(900.0)))
    );
    let alpha = &spec.vehicles[0];
    assert_eq!(
        (alpha.autopilot, alpha.airframe, alpha.finish),
        (Autopilot::ArduPilot, Airframe::Copter, Finish::Land)
    );
    assert_eq!(alpha.link, Link::UdpOut("127.0.0.1:14550".to_owned()));
    assert_eq!(alpha.goal.altitude, Placement::Amsl(Amsl(700.0)));
    assert_eq!(alpha.max_climb_rad, Some(15_f64.to_radians()));
    assert_eq!(alpha.return_amsl, Some(Amsl(900.0)));
    let bravo = &spec.vehicles[1];
    assert_eq!(bravo.link, Link::Tcp("127.0.0.1:5760".to_owned()));
    assert_eq!(
        bravo.home, bravo.start.place,
        "without a home it stands under its start"
    );
    assert_eq!(bravo.max_climb_rad, None);
    let defaults = [bravo.climb_mps, bravo.descent_mps, bravo.accel_mps2];
    assert_eq!(
        defaults.map(f64::to_bits),
        [3.0, 1.5, 3.0].map(f64::to_bits),
        "those of PX4"
    );
    assert_eq!(spec.planner.algorithm, Algorithm::MsfoaDwindle);
    assert_eq!(spec.planner.weights.length.to_bits(), 2_f64.to_bits());
    assert_eq!(spec.mission.altitude, AltitudeReference::Relative);
    assert_eq!(spec.on_link_loss, OnLinkLoss::HoldAll);
    assert_eq!(
        spec.wind.map(|wind| wind.from_rad),
        Some(270_f64.to_radians())
    );
}

#[test]
fn without_an_origin_the_frame_lies_in_the_middle_of_the_area() {
    let spec = good(&with("origin: {lat: 36.30, lon: -84.25}\n", ""));
    let origin = spec.frame.origin();
    assert!((origin.lat_deg - 36.30).abs() < 1e-9 && (origin.lon_deg + 84.25).abs() < 1e-9);
}

#[test]
fn line_ends_of_windows_and_a_byte_order_mark_change_nothing() {
    let text = format!("\u{feff}{}", FULL.replace('\n', "\r\n"));
    assert_eq!(good(&text), good(FULL));
    let file = parse(&text).expect("good");
    assert_eq!(file.text, text, "the text stays as it was");
    let broken = text.replace("lat: 36.31,", "lat: 123,");
    assert_eq!(
        issues(&broken)[0].position,
        Some(place_of(&with("lat: 36.31,", "lat: 123,"), "123"))
    );
}

#[test]
fn a_file_of_another_kind_is_named_as_what_it_is() {
    let rows = "QGC WPL 110\n0\t1\t0\t16\t0\t0\t0\t0\t46.0\t8.0\t500\t1\n".repeat(300);
    for (text, kind) in [
        (
            rows.as_str(),
            "a mission file (QGC WPL), no spec: `sortie review` judges it",
        ),
        (
            "{\"fileType\": \"Plan\", \"version\": 1}",
            "a plan of QGroundControl, no spec: `sortie review` judges it",
        ),
        ("WPNAV_SPEED,1000\nRTL_ALT,3000\n", "\"WPNAV_SPEED,1000\""),
        ("- a\n- b\n", "a list"),
        ("", "nothing"),
    ] {
        let issues = issues(text);
        let message = format!("{}{}", issues[0].found, issues[0].allowed);
        assert_eq!(issues.len(), 1, "{issues:?}");
        assert!(message.contains(kind) && message.len() < 250, "{message}");
        assert!(
            message.contains("YAML that begins with `sortie: 2`"),
            "{message}"
        );
    }
}

#[test]
fn broken_yaml_names_its_line_and_column() {
    let text = with("  min_agl_m: 60\n", "  min_agl_m: [60\n");
    let issue = &issues(&text)[0];
    assert!(
        issue
            .position
            .is_some_and(|(line, _)| (7..=8).contains(&line)),
        "{issue:?}"
    );
}

#[test]
fn an_unknown_key_is_named_with_the_known_ones() {
    let (path, message) = only("    speed_mps: 12\n", "    speed: 12\n");
    assert_eq!(path, "vehicles[1].speed");
    assert!(
        message.contains("unknown field `speed`") && message.contains("`speed_mps`"),
        "{message}"
    );
    let text = with("    speed_mps: 12\n", "    speed: 12\n");
    assert_eq!(
        issues(&text)[0].position,
        Some(place_of(&text, "speed: 12"))
    );
}

#[test]
fn a_key_in_another_unit_is_answered_with_the_known_key_and_its_unit() {
    for (from, to, meant) in [
        ("radius_m: 3000", "radius_km: 3", "`radius_m`, in metres?"),
        (
            "speed_mps:",
            "speed_kmh:",
            "`speed_mps`, in metres per second?",
        ),
        (
            "max_climb_deg:",
            "max_climb_percent:",
            "`max_climb_deg`, in degrees?",
        ),
    ] {
        // The value is in a unit that is not known: nothing more is said about it.
        let (_, message) = only(from, to);
        assert!(
            message.contains(&format!("did you mean {meant}")),
            "{message}"
        );
    }
}

#[test]
fn a_missing_key_is_named() {
    let (path, message) = only("    speed_mps: 12\n", "");
    assert_eq!(path, "vehicles[1].speed_mps");
    assert!(
        message.ends_with("vehicles[1].speed_mps: missing field `speed_mps` (allowed: 0.5 to 100)"),
        "{message}"
    );
}

#[test]
fn a_missing_key_says_what_is_allowed_for_it() {
    // The text that is removed, the path of its key, what is allowed there, and the place of the keys around it.
    for (old, path, allowed, around) in [
        ("sortie: 1\n", "sortie", "1 or 2", "name: full"),
        (
            "name: full\n",
            "name",
            "text of 1 to 64 characters",
            "sortie: 1",
        ),
        (
            "    finish: land\n",
            "vehicles[0].finish",
            "one of `land`, `loiter`, `return`",
            "id: alpha",
        ),
        (
            "    autopilot: px4\n",
            "vehicles[1].autopilot",
            "`ardupilot` or `px4`",
            "id: bravo",
        ),
        (
            "    sysid: 2\n",
            "vehicles[1].sysid",
            "1 to 255",
            "id: bravo",
        ),
        (
            "    link: tcp:127.0.0.1:5760\n",
            "vehicles[1].link",
            Link::ALLOWED,
            "id: bravo",
        ),
        (
            "  max_amsl_m: 1500\n",
            "area.max_amsl_m",
            "-500 to 20000",
            "south_west",
        ),
        (
            "  south_west: {lat: 36.20, lon: -84.40}\n",
            "area.south_west",
            "keys with values: `lat`, `lon`",
            "north_east",
        ),
        (
            ", radius_m: 3000",
            "threats[0].radius_m",
            "1 to 500000",
            "{id: radar-1",
        ),
        (
            " polygon: [[36.35, -84.20], [36.36, -84.20], [36.36, -84.18]],",
            "no_fly[0].polygon",
            "a list of at least 3 entries",
            "{id: town",
        ),
    ] {
        let text = with(old, "");
        let found = issues(&text);
        assert_eq!(found.len(), 1, "{path}: {found:#?}");
        assert_eq!(found[0].path, path);
        let key = path.rsplit('.').next().unwrap_or_default();
        assert_eq!(found[0].found, format!("missing field `{key}`"), "{path}");
        assert_eq!(found[0].allowed, allowed, "{path}");
        let position = Some(place_of(&text, around));
        assert_eq!(found[0].position, position, "{path}");
    }
    let text = with("sortie: 1\n", "");
    let error = parse(&text).expect_err("no version").to_string();
    assert!(
        error.ends_with(":1:1: sortie: missing field `sortie` (allowed: 1 or 2)"),
        "{error}"
    );
}

#[test]
fn a_wrong_type_is_named_with_its_place() {
    let text = with("radius_m: 3000", "radius_m: wide");
    let issue = &issues(&text)[0];
    assert_eq!(
        (issue.path.as_str(), issue.position),
        ("threats[0].radius_m", Some(place_of(&text, "wide")))
    );
    assert!(issue.found.contains("\"wide\""), "{issue:?}");
    let (path, _) = only("autopilot: px4", "autopilot: betaflight");
    assert_eq!(path, "vehicles[1].autopilot");
}

#[test]
fn everything_wrong_with_keys_and_types_is_reported_at_once_and_hides_no_meaning() {
    let text = FULL
        .replace("name: full\n", "")
        .replace("  min_agl_m: 60\n", "")
        .replace("radius_m: 3000", "radius: 3000")
        .replace("kind: radar,", "colour: red,")
        .replace("lat: 36.22,", "lat: north,")
        .replace("    finish: land\n", "    finish: crash\n")
        .replace("    speed_mps: 12\n", "")
        .replace("sysid: 2\n", "sysid: 1\n")
        .replace("from_deg: 270", "from_deg: 400");
    let found = issues(&text);
    let paths: Vec<&str> = found.iter().map(|issue| issue.path.as_str()).collect();
    let expected = [
        ("name", "missing field `name`"),
        ("area.min_agl_m", "missing field `min_agl_m`"),
        ("threats[0].colour", "unknown field `colour`"),
        ("threats[0].radius", "did you mean `radius_m`?"),
        ("rally[0].lat", "\"north\""),
        ("vehicles[0].finish", "crash"),
        ("vehicles[1].sysid", "1"),
        ("vehicles[1].speed_mps", "missing field `speed_mps`"),
        ("wind.from_deg", "400"),
    ];
    for (path, part) in expected {
        let is_it = |issue: &&Issue| issue.path == path && issue.found.contains(part);
        assert!(
            found.iter().any(|issue| is_it(&issue)),
            "{path} {part}: {found:#?}"
        );
    }
    assert_eq!(found.len(), expected.len(), "{paths:?}");
    assert!(
        found.iter().all(|issue| issue.position.is_some()),
        "{found:#?}"
    );
    assert!(found.is_sorted_by_key(|issue| issue.position), "{paths:?}");
    // Each unknown key is at itself, not at its value.
    let line = |at: usize| text.lines().nth(at - 1).unwrap_or_default();
    for issue in found
        .iter()
        .filter(|issue| issue.path.starts_with("threats"))
    {
        let (at, column) = issue.position.expect("a position");
        let key = issue.path.rsplit('.').next().unwrap_or_default();
        assert!(line(at)[column - 1..].starts_with(key), "{issue:?}");
    }
    // A key that means nothing hides no missing one.
    let text = FULL.replace("    finish: return\n", "    colour: red\n");
    let found: Vec<String> = issues(&text).into_iter().map(|issue| issue.found).collect();
    assert_eq!(found, ["missing field `finish`", "unknown field `colour`"]);
    let (_, text) = only(
        "origin: {lat: 36.30, lon: -84.25}",
        "orign: {lat: 36.30, lon: -84.25}",
    );
    assert!(text.contains("did you mean `origin`?"), "{text}");
}

#[test]
fn what_hangs_on_a_broken_value_is_not_reported_as_well() {
    // Without an area nothing is outside of it; without a corner of a polygon no edges cross.
    for (old, new) in [
        ("  south_west: {lat: 36.20, lon: -84.40}\n", ""),
        (
            "  south_west: {lat: 36.20, lon: -84.40}",
            "  south_west: {lat: south, lon: -84.40}",
        ),
        ("[36.36, -84.20]", "[36.36, east]"),
        (
            "  analytic:\n    base_amsl_m: 300\n",
            "  analytic:\n    base_amsl_m: low\n",
        ),
        ("sortie: 1\n", ""),
        // Nor is a place missing whose value is broken.
        ("goal: {lat: 36.21, lon: -84.12, agl_m: 80}", "goal: beside"),
    ] {
        only(old, new);
    }
    let missing = FULL.replace("origin:", "airspace: [{file: none.geojson}]\norigin:");
    let found = issues(&missing.replace("from_deg: 270", "from_deg: 400"));
    let paths: Vec<&str> = found.iter().map(|issue| issue.path.as_str()).collect();
    assert_eq!(paths, ["airspace[0].file", "wind.from_deg"]);
}

#[test]
fn a_key_given_twice_is_an_error_where_it_stands_again() {
    let text = with(
        "    speed_mps: 12\n",
        "    speed_mps: 12\n    speed_mps: 21\n",
    );
    let issue = &issues(&text)[0];
    assert_eq!(
        (issue.path.as_str(), issue.position),
        (
            "vehicles[1].speed_mps",
            Some(place_of(&text, "speed_mps: 21"))
        )
    );
}

#[test]
fn a_missing_file_is_named() {
    let error = SpecFile::read(Path::new("/nowhere/mission.yaml")).expect_err("no such file");
    assert!(
        error
            .to_string()
            .starts_with("/nowhere/mission.yaml: cannot be read"),
        "{error}"
    );
    let error = SpecFile::read(Path::new("/")).expect_err("a folder");
    assert!(error.to_string().contains("cannot be read"), "{error}");
}

#[test]
fn what_is_no_mission_at_all_is_an_error_and_no_panic() {
    for text in [
        "",
        "\n",
        "# only a comment\n",
        "null",
        "[]",
        "42",
        "---\n---\n",
        "a: b: c",
        "\t",
        "? [a]\n: b\n",
        "!!binary x",
        "&a *a",
        "%YAML 9\n",
        "\u{0}",
    ] {
        issues(text);
    }
}

#[test]
fn files_that_are_not_text_or_too_large_are_errors() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("mission.yaml");
    fs::write(&path, [0xff, 0xfe, 0x00, 0x41]).expect("written");
    assert!(
        SpecFile::read(&path)
            .expect_err("binary")
            .to_string()
            .contains("UTF-8")
    );
    let file = fs::File::create(&path).expect("created");
    file.set_len(100 << 20).expect("a hole of 100 MiB");
    assert!(
        SpecFile::read(&path)
            .expect_err("huge")
            .to_string()
            .contains("too large")
    );
}

#[test]
fn bombs_end_in_an_error() {
    let mut bomb = String::from("a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n");
    for level in 1..12 {
        let list = vec![format!("*a{}", level - 1); 10].join(", ");
        bomb += &format!("a{level}: &a{level} [{list}]\n");
    }
    issues(&bomb);
    issues(&"[".repeat(1_000_000));
    issues(&"{a: ".repeat(1_000_000));
    issues(&"- ".repeat(1_000_000));
    issues(&format!("name: {}", "x".repeat(8 << 20)));
    issues(&"a\n".repeat(2 << 20));
}

#[test]
fn an_alias_may_stand_for_a_place() {
    let text = with(
        "start: {lat: 36.21, lon: -84.38, agl_m: 80}",
        "start: &pad {lat: 36.21, lon: -84.38, agl_m: 80}",
    )
    .replace("goal: {lat: 36.21, lon: -84.12, agl_m: 80}", "goal: *pad");
    assert_eq!(good(&text).vehicles[1].goal, good(&text).vehicles[0].start);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn a_damaged_spec_never_panics(
        damage in prop::collection::vec((any::<prop::sample::Index>(), "[ -~\n\t]{0,3}"), 1..5),
    ) {
        let mut text = FULL.to_owned();
        for (at, piece) in damage {
            let at = at.index(text.len());
            let end = (at + piece.len()).min(text.len());
            text.replace_range(at..end, &piece);
        }
        if let Err(error) = sortie::Mission::parse("", text) {
            prop_assert!(!error.issues.is_empty());
        }
    }
}

#[test]
fn a_corner_with_three_numbers_is_one_problem() {
    let (path, text) = only("[36.36, -84.20]", "[36.36, -84.20, 500]");
    assert_eq!(path, "no_fly[0].polygon[1]");
    assert!(text.contains("length 3"), "{text}");
}

#[test]
fn a_misspelt_word_of_a_list_names_the_one_that_was_meant() {
    for (old, new, meant) in [
        (
            "finish: land",
            "finish: lannd",
            "`lannd`: did you mean `land`?",
        ),
        (
            "airframe: copter",
            "airframe: coptre",
            "`coptre`: did you mean `copter`?",
        ),
        (
            "autopilot: ardupilot",
            "autopilot: Ardupilot",
            "`Ardupilot`: did you mean `ardupilot`?",
        ),
    ] {
        let error = parse(&with(old, new)).expect_err(new).to_string();
        assert!(
            error.contains(&format!("unknown variant {meant}")),
            "{error}"
        );
    }
    let stops = "speed_mps: 15\n    stops: [{id: t, lat: 36.3, lon: -84.2, agl_m: 80, actions: [{photos: {}}]}]";
    let text = format!(
        "{}on_alarm: {{battery: {{who: vehicle, do: retrun}}}}\n",
        with("speed_mps: 15", stops)
    );
    let error = parse(&text).expect_err("two words").to_string();
    assert!(
        error.contains("unknown field `photos`: did you mean `photo`?"),
        "{error}"
    );
    assert!(
        error.contains("unknown variant `retrun`: did you mean `return`?"),
        "{error}"
    );
    // What is like no word is not guessed at.
    let error = parse(&with("finish: land", "finish: hover"))
        .expect_err("hover")
        .to_string();
    assert!(!error.contains("did you mean"), "{error}");
}
