//! Tasks: keys, what is absent, and who may do them.

use super::{good, issues, over_ground, said_of};

const HEAD: &str = "\
sortie: 2
name: tasks
area:
  south_west: {lat: 36.20, lon: -84.40}
  north_east: {lat: 36.40, lon: -84.10}
  min_agl_m: 40
  max_amsl_m: 700
terrain: {flat: {amsl_m: 400}}
threats:
  - {id: radar-1, lat: 36.31, lon: -84.26, radius_m: 500}
vehicles:
  - {id: alpha, sysid: 1, autopilot: px4, link: sim, start: {lat: 36.28, lon: -84.28, agl_m: 80}, goal: {lat: 36.30, lon: -84.30, agl_m: 80}, finish: land, speed_mps: 8}
tasks:
";

const VISIT: &str = "  - {id: v1, visit: {lat: 36.29, lon: -84.27, agl_m: 80, hold_s: 5}}\n";

fn spec(tasks: &str) -> String {
    format!("{HEAD}{tasks}")
}

#[test]
fn visits_and_deliveries_are_read() {
    let deliver = "  - {id: d1, deliver: {from: {lat: 36.22, lon: -84.30, agl_m: 80}, to: {lat: 36.23, lon: -84.30, amsl_m: 500, actions: [{gripper: release}]}}}\n";
    let tasks = good(&spec(&format!("{VISIT}{deliver}"))).tasks;
    let ids: Vec<&str> = (tasks.iter().flat_map(|task| &task.stops))
        .map(|stop| stop.id.as_str())
        .collect();
    assert_eq!(ids, ["v1", "d1.from", "d1.to"]);
    assert!((tasks[0].stops[0].hold_s - 5.0).abs() < 1e-9);
}

#[test]
fn what_is_wrong_with_a_task_is_reported_at_its_place() {
    let to = "{lat: 36.23, lon: -84.30, agl_m: 80}";
    for (task, path, found) in [
        ("{id: t}", "tasks[0]", "no kind of task"),
        (
            "{visit: {lat: 36.29, lon: -84.27, agl_m: 80}}",
            "tasks[0].id",
            "missing field",
        ),
        (
            "{id: t, visit: {lat: 36.29, lon: -84.27}}",
            "tasks[0].visit",
            "no altitude",
        ),
        (
            "{id: t, visit: {lat: 36.31, lon: -84.26, agl_m: 80}}",
            "tasks[0].visit",
            "inside threat `radar-1`",
        ),
        (
            "{id: t, visit: {lat: 36.5, lon: -84.26, agl_m: 80}}",
            "tasks[0].visit",
            "outside of the area",
        ),
        (
            "{id: t, visit: {lat: 36.29, lon: -84.27, agl_m: 80, hold: 5}}",
            "",
            "hold_s",
        ),
        (
            "{id: t, vist: {lat: 36.29, lon: -84.27, agl_m: 80}}",
            "",
            "visit",
        ),
        (
            "{id: t, visit: {lat: 36.29, lon: -84.27, agl_m: 80, actions: [{servo: {channel: 9, pwm_us: 1900}}]}}",
            "tasks[0]",
            "actions that PX4 refuses",
        ),
        (
            "{id: t, visit: {lat: 36.29, lon: -84.27, agl_m: 80, window_s: {from: 9, to: 8}}}",
            "tasks[0].visit.window_s",
            "to not before from",
        ),
        (
            &format!("{{id: t, deliver: {{from: {to}}}}}"),
            "tasks[0].deliver.to",
            "missing field",
        ),
        (
            &format!("{{id: t, deliver: {{from: {to}, to: {to}}}}}"),
            "tasks[0].deliver.to",
            "from `from`",
        ),
        (
            &format!("{{id: t, visit: {to}, deliver: {{from: {to}, to: {to}}}}}"),
            "tasks[0]",
            "two kinds of task",
        ),
    ] {
        let all = issues(&spec(&format!("  - {task}\n")));
        assert_eq!(all.len(), 1, "{task}: {all:#?}");
        let text = said_of(&all);
        assert!(all[0].path == path || path.is_empty(), "{text}");
        assert!(text.contains(found), "{text}");
    }
}

#[test]
fn ids_of_tasks_are_unique_and_version_1_has_no_tasks() {
    let twice = issues(&spec(&format!("{VISIT}{VISIT}")));
    assert_eq!(twice.len(), 1, "{twice:#?}");
    assert_eq!(twice[0].path, "tasks[1].id");
    let old = issues(&spec(VISIT).replace("sortie: 2", "sortie: 1"));
    assert_eq!(old.len(), 1, "{old:#?}");
    assert!(old[0].found.contains("version 1"), "{}", old[0].found);
}

#[test]
fn wings_do_no_tasks_and_their_places_keep_the_height_of_a_start() {
    let wings = spec(VISIT).replace("autopilot: px4", "autopilot: px4, airframe: vtol");
    let wings = wings.replace("speed_mps: 8", "speed_mps: 18");
    let found = issues(&wings);
    assert!(
        found.iter().any(|issue| issue.path == "tasks"),
        "{found:#?}"
    );
    let low = over_ground(&spec(VISIT).replace("lon: -84.27, agl_m: 80", "lon: -84.27, agl_m: 45"));
    assert_eq!(low.len(), 1, "{low:?}");
    assert_eq!(low[0].path, "tasks[0].visit");
    assert!(low[0].found.contains("task is 45"), "{low:?}");
}

#[test]
fn holds_at_one_place_that_no_item_stores_are_reported_where_they_become_too_long() {
    let tasks = |count: usize| {
        let visit = "visit: {lat: 36.29, lon: -84.27, agl_m: 80, hold_s: 3600}";
        let tasks: String = (0..count)
            .map(|id| format!("  - {{id: t{id}, {visit}}}\n"))
            .collect();
        let other = "visit: {lat: 36.30, lon: -84.27, agl_m: 80, hold_s: 3600}";
        spec(&format!("{tasks}  - {{id: other, {other}}}\n"))
    };
    assert_eq!(good(&tasks(18)).tasks.len(), 19);
    let issues = issues(&tasks(20));
    assert_eq!(issues.len(), 1, "{issues:?}");
    assert_eq!(issues[0].path, "tasks[18].visit.hold_s");
    let said = said_of(&issues);
    let found =
        "68400 s with the tasks before it at this place (allowed: at most 65535 s at one place)";
    assert!(said.contains(found), "{said}");
}
