//! `sortie migrate`: version 1 to 2.

use std::fs;
use std::path::Path;

use assert_cmd::Command;

fn sortie() -> Command {
    Command::new(env!("CARGO_BIN_EXE_sortie"))
}

fn first() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("missions/first.yaml");
    let text = fs::read_to_string(path).expect("a spec");
    text.replace("sortie: 2", "sortie: 1")
}

#[test]
fn a_spec_becomes_version_2_and_keeps_every_other_byte() {
    let folder = tempfile::tempdir().expect("a folder");
    for text in [
        first(),
        first().replace('\n', "\r\n"),
        format!("\u{feff}{}", first()),
        first().replace("sortie: 1 ", "\"sortie\":    1   # ö "),
    ] {
        let path = folder.path().join("first.yaml");
        fs::write(&path, &text).expect("written");
        let shown = sortie().arg("migrate").arg(&path).assert().success();
        let shown = String::from_utf8_lossy(&shown.get_output().stdout).into_owned();
        let at = text
            .find("\nsortie")
            .or(text.find("\n\"sortie"))
            .expect("the version");
        let at = at + text[at..].find('1').expect("version 1");
        let expected = format!("{}2{}", &text[..at], &text[at + 1..]);
        assert!(shown == expected, "{shown}");
        sortie()
            .arg("migrate")
            .arg(&path)
            .arg("--in-place")
            .assert()
            .success();
        assert_eq!(fs::read_to_string(&path).expect("a spec"), shown);
        let again = sortie().arg("migrate").arg(&path).assert().success();
        assert_eq!(
            String::from_utf8_lossy(&again.get_output().stdout),
            shown,
            "once is enough"
        );
    }
}

#[cfg(unix)]
#[test]
fn in_place_the_file_that_a_link_points_to_is_migrated_and_the_link_stays() {
    let folder = tempfile::tempdir().expect("a folder");
    let (path, link) = (
        folder.path().join("first.yaml"),
        folder.path().join("link.yaml"),
    );
    fs::write(&path, first()).expect("written");
    std::os::unix::fs::symlink("first.yaml", &link).expect("a link");
    sortie()
        .args(["migrate", "--in-place"])
        .arg(&link)
        .assert()
        .success();
    assert!(fs::symlink_metadata(&link).expect("a link").is_symlink());
    let text = fs::read_to_string(&path).expect("a spec");
    assert!(text.contains("sortie: 2"), "{text}");
}

#[test]
fn a_spec_that_would_not_check_is_not_migrated_and_every_reason_is_listed() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("first.yaml");
    let text = first().replace("agl_m: 40", "agl_m: 35");
    fs::write(&path, &text).expect("written");
    let refused = sortie()
        .arg("migrate")
        .arg(&path)
        .arg("--in-place")
        .assert()
        .code(3);
    let why = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
    for part in [
        "vehicles[0].start",
        "vehicles[0].goal",
        "at least 40 m",
        "works here is 5 m",
    ] {
        assert!(why.contains(part), "{why}");
    }
    assert_eq!(fs::read_to_string(&path).expect("a spec"), text);
}
