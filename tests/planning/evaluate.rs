//! `sortie evaluate` and `sortie study scenario`, from outside.

use std::io::Write;
use std::process::Stdio;
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use assert_cmd::Command;

/// The real binary, run in the folder of the project.
fn sortie(arguments: &[&str]) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin("sortie"));
    command.args(arguments);
    command
}

/// Candidates of numbers that follow no pattern.
fn rows(count: usize, dimension: usize) -> Vec<f64> {
    let mut value: f64 = 0.0;
    (0..count * dimension)
        .map(|_| {
            value = (value + 0.618_033_988_75).fract();
            value
        })
        .collect()
}

/// What the candidates cost, asked in text.
fn costs<'a>(evaluate: &[&str], rows: impl Iterator<Item = &'a [f64]>) -> Vec<f64> {
    let lines: String = rows
        .map(|row| {
            let words: Vec<String> = row.iter().map(|value| format!("{value:e}")).collect();
            words.join(" ") + "\n"
        })
        .collect();
    let output = sortie(evaluate)
        .write_stdin(lines)
        .output()
        .expect("it runs");
    assert!(output.status.success(), "{output:?}");
    let costs = String::from_utf8(output.stdout).expect("text");
    costs
        .lines()
        .map(|line| line.parse().expect("a cost"))
        .collect()
}

fn dimension() -> usize {
    let arguments = [
        "evaluate",
        "missions/first.yaml",
        "--vehicle",
        "alpha",
        "--dimension",
    ];
    let output = sortie(&arguments).output().expect("sortie runs");
    let text = String::from_utf8(output.stdout).expect("text");
    text.trim().parse().expect("a number")
}

#[test]
fn costs_are_the_same_as_text_and_as_bytes_in_one_batch_and_in_many() {
    let dimension = dimension();
    let rows = rows(300, dimension);
    let lines: String = rows
        .chunks(dimension)
        .map(|row| {
            let words: Vec<String> = row.iter().map(f64::to_string).collect();
            words.join(" ") + "\n"
        })
        .collect();
    let evaluate = ["evaluate", "missions/first.yaml", "--vehicle", "alpha"];
    let text = sortie(&evaluate).write_stdin(lines).output().unwrap();
    assert!(text.status.success(), "{text:?}");
    let costs: Vec<f64> = String::from_utf8(text.stdout)
        .unwrap()
        .lines()
        .map(|line| line.parse().unwrap())
        .collect();
    assert_eq!(costs.len(), 300);
    assert!(costs.iter().all(|cost| cost.is_finite() && *cost > 0.0));

    let bytes: Vec<u8> = rows.iter().flat_map(|value| value.to_le_bytes()).collect();
    let binary = sortie(&evaluate)
        .arg("--binary")
        .write_stdin(bytes)
        .output()
        .unwrap();
    let expected: Vec<u8> = costs.iter().flat_map(|cost| cost.to_le_bytes()).collect();
    assert!(binary.stdout == expected, "bytes differ from text");
}

#[test]
fn a_map_of_the_paper_is_evaluated_under_the_operational_objective() {
    let evaluate = ["evaluate", "missions/paper/s1-8.yaml", "--vehicle", "uav1"];
    let asked = sortie(&evaluate).arg("--dimension").output().unwrap();
    assert_eq!(String::from_utf8(asked.stdout).unwrap().trim(), "24");
    let costs = costs(&evaluate, rows(50, 24).chunks(24));
    assert_eq!(costs.len(), 50);
    // From (5, 10) to (92, 88) km: no way is shorter than the straight one.
    let straight_km = 87.0_f64.hypot(78.0);
    assert!(costs.iter().all(|cost| *cost > straight_km), "{costs:?}");
}

#[test]
fn one_who_sends_all_candidates_before_it_reads_a_cost_is_answered_all_the_same() {
    // Costs of 160 kB, where a pipe holds 64.
    let (count, dimension) = (20_000, dimension());
    let bytes: Vec<u8> = rows(count, dimension)
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin("sortie"))
        .args(["evaluate", "missions/first.yaml", "--vehicle", "alpha"])
        .arg("--binary")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut input = child.stdin.take().unwrap();
    let (sender, sent) = mpsc::channel();
    thread::spawn(move || {
        let written = input.write_all(&bytes).is_ok();
        drop(input);
        let _ = sender.send(written);
    });
    let all_sent = sent.recv_timeout(Duration::from_secs(120));
    if all_sent != Ok(true) {
        let _ = child.kill();
    }
    assert_eq!(all_sent, Ok(true), "both sides wait");
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success());
    assert_eq!(output.stdout.len(), 8 * count);
}

#[test]
fn what_is_no_candidate_is_refused_with_its_row() {
    let evaluate = ["evaluate", "missions/first.yaml", "--vehicle", "alpha"];
    let good = vec!["0.5"; dimension()].join(",");
    for (input, complaint) in [
        (format!("{good}\n0.5 0.5\n"), "row 2: 2 numbers"),
        (
            format!("{good}\n{}\n", good.replacen("0.5", "x", 1)),
            "row 2: number 1: x is no number",
        ),
        (format!("{good}\n\n{good}\n"), "row 2: a blank line"),
        (
            good.replacen("0.5", "\u{0}\u{1b}[2J", 1),
            "row 1: number 1: \\0\\u{1b}[2J is no number",
        ),
        (good.replacen("0.5", "inf", 1), "row 1: number 1 is inf"),
    ] {
        let output = sortie(&evaluate).write_stdin(input).output().unwrap();
        assert_eq!(output.status.code(), Some(3));
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(said.contains(complaint), "{said}");
    }
    let nobody = sortie(&["evaluate", "missions/first.yaml", "--vehicle", "zulu"])
        .output()
        .unwrap();
    assert_eq!(nobody.status.code(), Some(2));
    assert!(
        String::from_utf8(nobody.stderr)
            .unwrap()
            .contains("there are: alpha")
    );
}

#[test]
fn rows_before_a_bad_one_are_answered_however_they_come() {
    let evaluate = ["evaluate", "missions/first.yaml", "--vehicle", "alpha"];
    let dimension = dimension();
    let good = vec!["0.5"; dimension].join(" ");
    for bad in ["x", "", "0.5", &good.replacen("0.5", "nan", 1)] {
        let input = format!("{good}\n{good}\n{bad}\n{good}\n");
        let output = sortie(&evaluate).write_stdin(input).output().unwrap();
        assert_eq!(output.status.code(), Some(3));
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(said.contains("row 3: "), "{said}");
        let answers = String::from_utf8(output.stdout).unwrap();
        assert_eq!(answers.lines().count(), 2, "{bad:?}: {answers}");
    }
    let mut rows = vec![0.5_f64; 4 * dimension];
    rows[2 * dimension + 4] = f64::NAN;
    let bytes: Vec<u8> = rows.iter().flat_map(|value| value.to_le_bytes()).collect();
    let mut binary = sortie(&evaluate);
    let output = binary.arg("--binary").write_stdin(bytes).output().unwrap();
    assert_eq!((output.status.code(), output.stdout.len()), (Some(3), 16));
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("row 3: number 5 is NaN"), "{said}");
}

#[test]
fn a_path_however_far_out_has_a_cost_that_can_be_compared() {
    let evaluate = ["evaluate", "missions/first.yaml", "--vehicle", "alpha"];
    let dimension = dimension();
    let mut rows = Vec::new();
    for far in [1e3, 1e100, 1e153, 1e154, 1e200, f64::MAX] {
        for sign in [1.0, -1.0] {
            rows.push(vec![sign * far; dimension]);
            let mut one = vec![0.5; dimension];
            one[dimension / 2] = sign * far;
            rows.push(one);
            rows.push(
                (0..dimension)
                    .map(|at| [far, -far][at % 2] * sign)
                    .collect(),
            );
        }
    }
    let costs = costs(&evaluate, rows.iter().map(Vec::as_slice));
    assert_eq!(costs.len(), rows.len());
    assert!(costs.iter().all(|cost| *cost > 100.0), "{costs:?}");
}

#[test]
fn a_generated_scenario_is_a_spec_that_checks() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("made.yaml");
    let path = file.to_str().unwrap();
    let made = sortie(&[
        "study",
        "scenario",
        "--seed",
        "3",
        "--difficulty",
        "6",
        "-o",
        path,
    ])
    .output()
    .unwrap();
    assert!(made.status.success(), "{made:?}");
    let checked = sortie(&["check", path]).output().unwrap();
    assert!(checked.status.success(), "{checked:?}");
    let printed = sortie(&["study", "scenario", "--seed", "3", "--difficulty", "6"])
        .output()
        .unwrap();
    assert_eq!(printed.stdout, std::fs::read(&file).unwrap());
}
