//! The first steps: a new spec, manual pages, and commands as README and guide write them.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use crate::support::command::{sortie, text};

#[test]
fn a_new_spec_plans_wherever_it_is() {
    let folder = tempfile::tempdir().unwrap();
    for (name, at) in [
        ("field", "47.39,8.54"),
        ("south", "-35.3633,149.1600"),
        ("far-north", "78.2,15.6"),
        ("near_the_line", "0.3,-179.5"),
    ] {
        let made = sortie(folder.path(), &["new", name, "--at", at]);
        assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
        assert!(text(&made.stdout).contains(&format!("sortie plan {name}.yaml")));
        assert!(text(&made.stderr).contains("taken as flat"));
        let planned = sortie(folder.path(), &["plan", &format!("{name}.yaml")]);
        assert_eq!(planned.status.code(), Some(0), "{}", text(&planned.stderr));
    }
}

#[test]
fn a_new_spec_is_refused_where_no_area_fits_and_the_answer_is_about_the_option() {
    let folder = tempfile::tempdir().unwrap();
    for (at, words) in [
        ("89.99,0", "latitudes between -85 and 85"),
        ("-33", "latitudes between -85 and 85"),
        (
            "0,180",
            "--at 0,180: an area of 3 km around it would cross the antimeridian (allowed at this latitude: longitudes from -179.9865 to 179.9865)",
        ),
        ("-60,-179.98", "longitudes from -179.973 to 179.973"),
    ] {
        let made = sortie(folder.path(), &["new", "place", "--at", at]);
        let errors = text(&made.stderr);
        assert_eq!(made.status.code(), Some(2), "{at}: {errors}");
        assert!(
            errors.contains(words) && errors.contains("--at"),
            "{errors}"
        );
    }
    for at in ["0,179.9865", "-33,151", "-60,-179.973"] {
        let made = sortie(folder.path(), &["new", "place", "--at", at]);
        assert_eq!(made.status.code(), Some(0), "{at}: {}", text(&made.stderr));
        fs::remove_file(folder.path().join("place.yaml")).unwrap();
    }
}

#[test]
fn a_negative_number_is_the_value_of_an_option_and_never_a_flag() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, words) in [
        (vec!["plan", "a.yaml", "--seed", "-5"], "'-5' for '--seed"),
        (
            vec!["fly", "a.yaml", "--speedup", "-5"],
            "'-5' for '--speedup",
        ),
        (
            vec!["vehicles", "a.yaml", "--loss", "-5"],
            "'-5' for '--loss",
        ),
        (
            vec!["terrain", "export", "a.yaml", "--spacing", "-5"],
            "'-5' for '--spacing",
        ),
        (
            vec!["review", "a.plan", "--terrain", "a.tif", "--min-agl", "-5"],
            "a.plan: cannot be read",
        ),
        (
            vec!["review", "a.plan", "--max-amsl", "-5"],
            "a.plan: cannot be read",
        ),
        (
            vec!["review", "a.plan", "--home", "-33,151,10"],
            "a.plan: cannot be read",
        ),
        (
            vec!["replan", "a.yaml", "--threat", "-33,151,100"],
            "a.yaml",
        ),
    ] {
        let output = sortie(folder.path(), &arguments);
        let errors = text(&output.stderr);
        assert!(errors.contains(words), "{arguments:?}: {errors}");
        assert!(!errors.contains("tip:"), "{arguments:?}: {errors}");
    }
}

#[test]
fn the_columns_of_the_table_of_a_plan_are_explained_by_its_help_and_the_guide() {
    let folder = tempfile::tempdir().unwrap();
    let help = text(&sortie(folder.path(), &["plan", "--help"]).stdout);
    let words: Vec<&str> = help.split_whitespace().collect();
    let help = words.join(" ");
    assert!(
        help.contains("time is from the start to the goal"),
        "{help}"
    );
    assert!(
        help.contains("without takeoff, climb to the start and landing"),
        "{help}"
    );
}

#[test]
fn a_folder_in_the_place_of_a_file_is_named_with_what_is_expected() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("empty")).unwrap();
    for command in [
        "check", "plan", "fly", "upload", "watch", "vehicles", "migrate",
    ] {
        let output = sortie(folder.path(), &[command, "empty"]);
        let errors = text(&output.stderr);
        assert_eq!(output.status.code(), Some(3), "{command}: {errors}");
        assert!(!errors.contains("os error"), "{command}: {errors}");
        let expected = ["upload", "watch"].contains(&command);
        let words = match expected {
            true => "`sortie plan`",
            false => "a mission spec",
        };
        assert!(errors.contains(words), "{command}: {errors}");
    }
    let arguments = ["convert", "empty", "out.plan"];
    let errors = text(&sortie(folder.path(), &arguments).stderr);
    assert!(
        errors.contains("it is a folder (allowed: a file)"),
        "{errors}"
    );
}

#[test]
fn a_new_spec_over_elevation_has_a_ceiling_above_its_highest_ground() {
    let folder = tempfile::tempdir().unwrap();
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("missions/terrain/jacksboro.tif");
    fs::copy(source, folder.path().join("ground.tif")).unwrap();
    let arguments = [
        "new",
        "ridge",
        "--at",
        "36.30,-84.25",
        "--terrain",
        "ground.tif",
    ];
    let made = sortie(folder.path(), &arguments);
    assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
    let spec = fs::read_to_string(folder.path().join("ridge.yaml")).unwrap();
    let ceiling = spec
        .lines()
        .find_map(|line| line.trim().strip_prefix("max_amsl_m: "));
    let ceiling: f64 = ceiling
        .and_then(|rest| rest.split(' ').next())
        .and_then(|number| number.parse().ok())
        .expect("a ceiling");
    assert!((400.0..1100.0).contains(&ceiling), "{ceiling}");
    assert!(spec.contains("altitude: amsl"));
    // A file that is not there, or does not reach as far.
    let arguments = ["new", "x", "--at", "36.30,-84.25", "--terrain", "none.tif"];
    assert_eq!(sortie(folder.path(), &arguments).status.code(), Some(3));
    let arguments = ["new", "x", "--at", "47,8", "--terrain", "ground.tif"];
    assert_eq!(sortie(folder.path(), &arguments).status.code(), Some(3));
    assert!(!folder.path().join("x.yaml").exists());
}

#[test]
fn a_new_spec_replaces_no_file_and_needs_a_place_and_a_name() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("mine.yaml"), "precious").unwrap();
    let again = sortie(folder.path(), &["new", "mine", "--at", "47,8"]);
    assert_eq!(again.status.code(), Some(1));
    let message = text(&again.stderr);
    assert!(message.contains("mine.yaml is there already"), "{message}");
    let left = fs::read_to_string(folder.path().join("mine.yaml")).unwrap();
    assert_eq!(left, "precious");
    for (arguments, code) in [
        (["new", "a", "--at", "91,8"], 2),
        (["new", "a", "--at", "47;8"], 2),
        (["new", "a/b", "--at", "47,8"], 3),
        (["new", "..", "--at", "47,8"], 3),
        (["new", "", "--at", "47,8"], 3),
    ] {
        let refused = sortie(folder.path(), &arguments);
        assert_eq!(refused.status.code(), Some(code), "{arguments:?}");
    }
    assert_eq!(sortie(folder.path(), &["new", "a"]).status.code(), Some(2));
}

#[test]
fn every_command_has_a_manual_page() {
    let folder = tempfile::tempdir().unwrap();
    let made = sortie(folder.path(), &["man", "pages"]);
    assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
    for command in commands(&[]) {
        let page = folder.path().join(format!("pages/sortie-{command}.1"));
        let page = fs::read_to_string(page).unwrap_or_else(|_| panic!("no page of {command}"));
        assert!(page.contains(".SH NAME"), "{command}");
    }
}

/// The commands that a help page lists.
fn commands(of: &[&str]) -> Vec<String> {
    let help = sortie(Path::new("."), &[of, &["--help"]].concat());
    assert_eq!(help.status.code(), Some(0), "{of:?}");
    text(&help.stdout)
        .lines()
        .skip_while(|line| *line != "Commands:")
        .skip(1)
        .take_while(|line| !line.is_empty())
        .filter(|line| line.starts_with("  ") && !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next())
        .filter(|name| *name != "help")
        .map(str::to_owned)
        .collect()
}

/// Documents with command lines, by name.
fn documents() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let guide = fs::read_dir(root.join("src/guide")).expect("a folder");
    let pages = guide.map(|entry| entry.expect("an entry").path());
    let pages = pages.filter(|path| path.extension().is_some_and(|is| is == "md"));
    [root.join("README.md")]
        .into_iter()
        .chain(pages)
        .map(|path| {
            (
                path.display().to_string(),
                fs::read_to_string(path).expect("a page"),
            )
        })
        .collect()
}

/// Command lines in a document: lines of code blocks and spans in backticks.
fn command_lines(document: &str) -> BTreeSet<String> {
    let lines = document.lines().filter(|line| line.starts_with("sortie "));
    let spans = document
        .split('`')
        .filter(|span| span.starts_with("sortie "));
    lines
        .chain(spans)
        .map(|line| line.split(" #").next().unwrap_or(line))
        .map(|line| line.split_whitespace().collect::<Vec<_>>().join(" "))
        .collect()
}

#[test]
fn commands_and_flags_of_readme_and_guide_exist() {
    let top: BTreeSet<String> = commands(&[]).into_iter().collect();
    let mut nested = BTreeMap::new();
    for group in ["study", "terrain"] {
        nested.insert(
            group,
            commands(&[group]).into_iter().collect::<BTreeSet<_>>(),
        );
    }
    let mut checked = 0;
    for (name, document) in documents() {
        for line in command_lines(&document) {
            let words: Vec<&str> = line.split(' ').skip(1).collect();
            let Some(command) = words.first().map(|word| word.trim_matches(',')) else {
                continue;
            };
            if !top.contains(command) {
                assert!(
                    command.starts_with('-'),
                    "{name}: `{line}`: no such command"
                );
                continue;
            }
            let mut path = vec![command];
            let below = nested.get(command).zip(words.get(1));
            if let Some((names, second)) = below.filter(|(names, second)| names.contains(**second))
            {
                path.push(names.get(*second).unwrap());
            }
            let help = sortie(Path::new("."), &[&path[..], &["--help"]].concat());
            let help = text(&help.stdout);
            for flag in words.iter().filter(|word| word.starts_with("--")) {
                let flag = flag.trim_matches(|c: char| !c.is_ascii_alphanumeric() && c != '-');
                let flag = flag.split('=').next().unwrap_or(flag);
                assert!(
                    help.contains(flag),
                    "{name}: `{line}`: {path:?} has no {flag}"
                );
                checked += 1;
            }
        }
    }
    assert!(checked > 10, "{checked}");
}

#[test]
fn the_readme_names_every_command_and_stays_short() {
    let documents = documents();
    let (_, readme) = &documents[0];
    assert!(readme.lines().count() <= 150);
    for command in commands(&[]) {
        let named = readme.contains(&format!("`sortie {command}"))
            || readme.contains(&format!("`{command}`"));
        assert!(named, "{command}");
    }
}

#[test]
fn the_messages_of_the_troubleshooting_page_are_in_the_program() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let page = fs::read_to_string(root.join("guide/troubleshooting.md")).unwrap();
    let mut source = String::new();
    let mut folders = vec![root];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|is| is == "rs") {
                source += &fs::read_to_string(path).unwrap();
            }
        }
    }
    // The two forms of one message are made from `{are} in its way`.
    let source = source.replace("{are}", "is") + &source.replace("{are}", "are");
    let rows = page.lines().filter(|line| line.starts_with("| `"));
    let cells = rows.filter_map(|row| row.split('|').nth(1));
    let messages: Vec<&str> = cells
        .flat_map(|cell| cell.split('`').skip(1).step_by(2))
        .collect();
    assert!(messages.len() > 10);
    for message in messages {
        assert!(source.contains(message), "{message}");
    }
}

/// A printed table without rules, spaces and the time that planning took.
fn cells(printed: &str) -> Vec<String> {
    let is_rule = |line: &&str| line.chars().all(|c| "─═ ".contains(c));
    printed
        .lines()
        .filter(|line| !is_rule(line) && !line.starts_with("files in"))
        .map(|line| line.split(" in ").next().unwrap_or(line))
        .map(|line| line.split_whitespace().collect::<Vec<_>>().join(" "))
        .collect()
}

#[test]
fn the_mission_of_the_readme_prints_the_table_of_the_readme() {
    let (_, readme) = &documents()[0];
    let block = |language: &str| {
        let after = readme
            .split_once("## A first mission")
            .expect("a section")
            .1;
        let block = after
            .split_once(&format!("```{language}\n"))
            .expect("a block")
            .1;
        block.split_once("```").expect("its end").0.to_owned()
    };
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("hop.yaml"), block("yaml")).unwrap();
    let planned = sortie(folder.path(), &["plan", "hop.yaml"]);
    assert_eq!(planned.status.code(), Some(0), "{}", text(&planned.stderr));
    assert_eq!(cells(&text(&planned.stdout)), cells(&block("text")));
}

#[test]
fn the_whole_mission_of_the_page_on_tasks_plans() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let page = fs::read_to_string(root.join("guide/tasks.md")).unwrap();
    let mut blocks = page.split("```yaml\n").skip(1);
    let whole = blocks
        .find(|block| block.starts_with("sortie: 2"))
        .expect("a whole spec");
    let spec = whole.split("```").next().unwrap();
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("parcels.yaml"), spec).unwrap();
    let planned = sortie(folder.path(), &["plan", "parcels.yaml"]);
    assert_eq!(planned.status.code(), Some(0), "{planned:?}");
}
