//! What goes wrong around a flight, and what has been tampered with before it.
#![cfg(unix)]

use crate::support::{command, in_flight};
use std::fs;
use std::path::Path;
use std::process::Command;

use assert_cmd::cargo::cargo_bin;
use command::{sortie, text};
use in_flight::{json, lanes, planned, take_off, wait_for};

/// The flight under a shell's limits and redirections.
fn fly_in_shell(folder: &Path, before: &str, after: &str) -> (Option<i32>, String, String) {
    let binary = cargo_bin("sortie");
    let script = format!(
        "{before} exec '{}' fly lanes.yaml --speedup 20 {after}",
        binary.display()
    );
    let output = Command::new("sh")
        .current_dir(folder)
        .args(["-c", &script])
        .output()
        .expect("a shell");
    (
        output.status.code(),
        text(&output.stdout),
        text(&output.stderr),
    )
}

#[test]
fn a_record_that_cannot_be_written_on_is_told_once_and_the_fleet_is_watched_to_its_end() {
    let (folder, runs) = planned("lanes", &lanes("-84.251"));
    let (code, told, errors) = fly_in_shell(folder.path(), "", "");
    assert_eq!(code, Some(0), "{told}{errors}");
    // No file may have more than 48 KiB: as a disk that is full in the middle of the flight.
    let limit = "trap '' XFSZ; ulimit -f 96;";
    let (code, told, errors) = fly_in_shell(folder.path(), limit, "");
    assert_eq!(code, Some(1), "{told}{errors}");
    let watched = errors.matches("the vehicles are still monitored").count();
    assert_eq!(watched, 1, "{errors}");
    assert!(errors.contains("cannot write"), "{errors}");
    assert!(errors.contains("the flight is not judged"), "{errors}");
    for line in ["alpha: landed, motors stopped", "bravo: loiters"] {
        assert!(told.contains(line), "{line} in {told}");
    }
    // The verdict of the flight before is not that of the newest one.
    for name in ["flight.json", "flight.html", "flight.jsonl", "links.json"] {
        assert!(!runs.join(name).exists(), "{name}");
    }
}

#[test]
fn a_flight_that_does_not_begin_leaves_alone_what_is_said_of_one_that_was_cut_off() {
    let (folder, runs) = planned("lanes", &lanes("-84.251"));
    fs::create_dir_all(&runs).expect("a folder");
    for name in ["links.json", "underway.jsonl", "flight.json"] {
        fs::write(runs.join(name), "{}\n").expect("written");
    }
    let dead = "--link=alpha=udpout:127.0.0.1:9";
    let output = sortie(folder.path(), &["fly", "lanes.yaml", dead]);
    let errors = text(&output.stderr);
    assert_eq!(output.status.code(), Some(5), "{errors}");
    assert!(errors.contains("none was started"), "{errors}");
    for name in ["links.json", "underway.jsonl", "flight.json"] {
        let kept = fs::read_to_string(runs.join(name)).expect("still there");
        assert_eq!(kept, "{}\n", "{name}");
    }
}

#[test]
fn what_was_laid_down_for_a_flight_that_was_cut_off_is_not_held_against_the_next() {
    let (folder, runs) = planned("lanes", &lanes("-84.251"));
    fs::create_dir_all(&runs).expect("a folder");
    let threat = "{\"t_s\":1.0,\"threat\":{\"id\":\"popup-1\",\"lat_deg\":36.3,\"lon_deg\":-84.258,\"radius_m\":200.0}}\n";
    fs::write(runs.join("underway.jsonl"), threat).expect("written");
    let output = sortie(folder.path(), &["fly", "lanes.yaml", "--speedup", "20"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let record = fs::read_to_string(runs.join("flight.jsonl")).expect("the record");
    assert!(!record.contains("popup-1"));
    assert!(!runs.join("underway.jsonl").exists());
}

#[test]
fn a_screen_that_takes_nothing_ends_no_flight_and_starts_none() {
    let (folder, runs) = planned("lanes", &lanes("-84.251"));
    // Full from the beginning: nobody is started blindly.
    let (code, _, errors) = fly_in_shell(folder.path(), "", "> /dev/full");
    assert_eq!(code, Some(1), "{errors}");
    assert!(errors.contains("none was started"), "{errors}");
    // Full in flight: a file that has 300 bytes left to its limit of 8 MiB.
    let told = fs::File::create(folder.path().join("told.txt")).expect("a file");
    told.set_len((8 << 20) - 300).expect("a long one");
    let limit = "trap '' XFSZ; ulimit -f 16384;";
    let (code, _, errors) = fly_in_shell(folder.path(), limit, ">> told.txt");
    assert_eq!(code, Some(1), "{errors}");
    let watched = errors.matches("the vehicles are still monitored").count();
    assert_eq!(watched, 1, "{errors}");
    assert_eq!(json(&runs.join("flight.json"))["verdict"], "pass");
}

#[test]
fn one_plan_is_flown_once_at_a_time_and_not_replaced_meanwhile() {
    let (folder, runs) = planned("lanes", &lanes("-84.251"));
    let mut flight = take_off(folder.path(), "lanes.yaml", "8");
    wait_for(&runs, "alpha", 1.0);
    let links = fs::read(runs.join("links.json")).expect("it says where they are");
    for arguments in [&["fly", "lanes.yaml"][..], &["plan", "lanes.yaml"]] {
        let output = sortie(folder.path(), arguments);
        let errors = text(&output.stderr);
        let code = if arguments[0] == "fly" { 5 } else { 1 };
        assert_eq!(output.status.code(), Some(code), "{errors}");
        let why = ["another `sortie fly` is at work", "is being flown"];
        assert!(why.iter().any(|why| errors.contains(why)), "{errors}");
    }
    assert_eq!(fs::read(runs.join("links.json")).expect("still"), links);
    let status = flight.0.wait().expect("it ends");
    assert!(status.success(), "{status}");
    assert_eq!(json(&runs.join("flight.json"))["verdict"], "pass");
    let output = sortie(folder.path(), &["plan", "lanes.yaml"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
}

#[test]
fn parameters_that_are_not_those_of_the_plan_start_nobody() {
    let (folder, _) = planned("lanes", &lanes("-84.251"));
    let path = folder.path().join("out/lanes/alpha.params");
    let good = fs::read_to_string(&path).expect("parameters");
    let spoilt = [
        (String::new(), "is missing"),
        (
            good.replace("WPNAV_SPEED,1500", "WPNAV_SPEED,99999"),
            "WPNAV_SPEED is 99999, the plan assumes 1500",
        ),
        (
            format!("{good}ARMING_CHECK,0\n"),
            "ARMING_CHECK = 0 is none of the plan's",
        ),
        (
            // Of a name that stands there twice the last counts.
            format!("{good}WPNAV_SPEED,900\n"),
            "WPNAV_SPEED is 900, the plan assumes 1500",
        ),
    ];
    for (text_of, why) in spoilt {
        fs::write(&path, text_of).expect("written");
        let output = sortie(folder.path(), &["fly", "lanes.yaml", "--set-params"]);
        let errors = text(&output.stderr);
        assert_eq!(output.status.code(), Some(4), "{why}: {errors}");
        assert!(errors.contains(why), "{why}: {errors}");
        assert!(errors.contains("alpha.params"), "{errors}");
    }
}

#[test]
fn a_plan_without_a_parameter_file_and_a_file_in_the_place_of_its_records_start_nobody() {
    let (folder, runs) = planned("lanes", &lanes("-84.251"));
    fs::write(&runs, "mine").expect("written");
    for command in ["fly", "upload"] {
        let what = if command == "fly" {
            "lanes.yaml"
        } else {
            "out/lanes"
        };
        let output = sortie(folder.path(), &[command, what]);
        let errors = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{errors}");
        let why = "lanes.runs is no folder, and one goes there for the records";
        assert!(errors.contains(why), "{errors}");
        assert!(errors.contains("nothing was sent or started"), "{errors}");
    }
    assert_eq!(fs::read_to_string(&runs).expect("still there"), "mine");
    fs::remove_file(&runs).expect("gone");
    let path = folder.path().join("out/lanes/bravo.params");
    fs::remove_file(path).expect("it was there");
    let output = sortie(folder.path(), &["fly", "lanes.yaml"]);
    let errors = text(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{errors}");
    let why = "bravo.params: is missing: `plan` writes one for each vehicle";
    assert!(errors.contains(why), "{errors}");
}

#[test]
fn a_record_that_is_a_link_is_replaced_and_what_it_leads_to_is_not_touched() {
    let (folder, runs) = planned("lanes", &lanes("-84.251"));
    fs::create_dir_all(&runs).expect("a folder");
    let diary = folder.path().join("diary.txt");
    fs::write(&diary, "mine").expect("written");
    for name in ["flight.jsonl", "flight.json", "links.json"] {
        std::os::unix::fs::symlink(&diary, runs.join(name)).expect("a link");
    }
    let output = sortie(folder.path(), &["fly", "lanes.yaml", "--speedup", "30"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(fs::read_to_string(&diary).expect("still there"), "mine");
    let record = fs::symlink_metadata(runs.join("flight.jsonl")).expect("a record");
    assert!(record.is_file());
}

#[test]
fn a_threat_that_is_told_too_late_to_go_around_is_still_held_against_the_flight() {
    let (folder, runs) = planned("lanes", &lanes("-84.251"));
    let mut flight = take_off(folder.path(), "lanes.yaml", "8");
    wait_for(&runs, "alpha", 30.0);
    // Over the last metres of alpha's way.
    let threat = "--threat=36.300,-84.2515,150";
    let output = sortie(folder.path(), &["replan", "lanes.yaml", threat]);
    let errors = text(&output.stderr);
    assert_eq!(output.status.code(), Some(4), "{errors}");
    assert!(errors.contains("nothing was sent"), "{errors}");
    let status = flight.0.wait().expect("it ends");
    assert_eq!(status.code(), Some(5));
    let flown = json(&runs.join("flight.json"));
    assert_eq!(flown["verdict"], "fail", "{flown:#}");
    let margins = flown["margins"].as_array().expect("margins");
    let popup = |vehicle: &str| {
        let mut of = margins.iter();
        let found = of.find(|m| m["what"] == "threat popup-1" && m["vehicle"] == vehicle);
        found.expect("a margin")["ok"].clone()
    };
    assert_eq!(
        (popup("alpha"), popup("bravo")),
        (false.into(), true.into())
    );
    // The operator reads it when it happens.
    let alarms = flown["alarms"].as_array().expect("alarms");
    let entered = alarms.iter().filter(|of| of["alarm"] == "threat");
    let entered: Vec<_> = entered.collect();
    assert_eq!(entered.len(), 1, "{flown:#}");
    assert_eq!(entered[0]["vehicle"], "alpha");
    let text = entered[0]["text"].as_str().expect("words");
    assert!(text.contains("m inside popup-1"), "{text}");
}

#[test]
fn a_second_threat_is_gone_around_without_forgetting_the_first() {
    let (folder, runs) = planned("lanes", &lanes("-84.251"));
    let far = lanes("-84.22");
    fs::write(folder.path().join("lanes.yaml"), far).expect("written");
    let output = sortie(folder.path(), &["plan", "lanes.yaml"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let mut flight = take_off(folder.path(), "lanes.yaml", "8");
    wait_for(&runs, "alpha", 30.0);
    // The first lies north of alpha's way, where the shorter way around the second would be.
    for threat in [
        "--threat=36.3037,-84.238,250",
        "--threat=36.3004,-84.238,150",
    ] {
        let output = sortie(folder.path(), &["replan", "lanes.yaml", threat]);
        let told = text(&output.stdout);
        assert!(output.status.success(), "{told}{}", text(&output.stderr));
    }
    let status = flight.0.wait().expect("it ends");
    let flown = json(&runs.join("flight.json"));
    assert!(status.success(), "{flown:#}");
    let margins = flown["margins"].as_array().expect("margins");
    for what in ["threat popup-1", "threat popup-2"] {
        let of = margins.iter().filter(|m| m["what"] == what);
        assert_eq!(of.count(), 2, "{what}");
    }
}

#[test]
fn a_new_path_that_cannot_keep_the_buffers_keeps_the_limits_and_a_warning_says_so() {
    // The goal is 8 m outside of the threat, and the buffer is 10 m.
    let second = lanes("-84.250")
        .replace("sortie: 1", "sortie: 2")
        .replace("speed_mps: 15", "speed_mps: 9");
    let (folder, runs) = planned("lanes", &second);
    // It plans twice, with the buffers and without: a third of the speed-up, so that a busy machine has the time.
    let mut flight = take_off(folder.path(), "lanes.yaml", "3");
    wait_for(&runs, "alpha", 30.0);
    let threat = "--threat=36.300,-84.251761,150";
    let output = sortie(folder.path(), &["replan", "lanes.yaml", threat]);
    let errors = text(&output.stderr);
    let told = text(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{told}{errors}");
    assert!(
        errors.contains("WARNING: no new path keeps the buffers"),
        "{errors}"
    );
    let status = flight.0.wait().expect("it ends");
    let flown = json(&runs.join("flight.json"));
    assert!(status.success(), "{flown:#}");
    let margins = flown["margins"].as_array().expect("margins");
    let mut popup = margins.iter().filter(|m| m["what"] == "threat popup-1");
    let away_m = popup.find(|m| m["vehicle"] == "alpha").expect("judged")["value"].as_f64();
    assert!(
        away_m.is_some_and(|m| (0.0..10.0).contains(&m)),
        "{flown:#}"
    );
}

#[test]
fn a_threat_that_cannot_be_is_refused_with_what_is_allowed() {
    let (folder, _) = planned("lanes", &lanes("-84.251"));
    for (threat, why) in [
        ("36.3,-84.25", "not of the form LAT,LON,RADIUS_M"),
        ("96.3,-84.25,100", "latitude \"96.3\" (allowed: -90 to 90)"),
        ("36.3,NaN,100", "longitude \"NaN\" (allowed: -180 to 180)"),
        ("36.3,-84.25,1e300", "(allowed: 1 to 500000)"),
        ("36.3,-84.25,0", "radius in metres \"0\""),
    ] {
        let threat = format!("--threat={threat}");
        let output = sortie(folder.path(), &["replan", "lanes.yaml", &threat]);
        let errors = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{errors}");
        assert!(errors.contains(why), "{why}: {errors}");
    }
}
