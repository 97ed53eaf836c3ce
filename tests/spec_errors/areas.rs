//! Surveys, corridors and search patterns: keys, what is absent, what cannot be flown.

use sortie::spec::SweepShape;

use super::{good, issues, said_of};

const HEAD: &str = "\
sortie: 2
name: areas
area:
  south_west: {lat: 36.20, lon: -84.40}
  north_east: {lat: 36.40, lon: -84.10}
  min_agl_m: 40
  max_amsl_m: 700
  max_agl_m: 150
terrain: {flat: {amsl_m: 400}}
threats:
  - {id: radar-1, lat: 36.31, lon: -84.26, radius_m: 100}
vehicles:
  - {id: alpha, sysid: 1, autopilot: px4, link: sim, start: {lat: 36.28, lon: -84.28, agl_m: 80}, goal: {lat: 36.28, lon: -84.285, agl_m: 80}, finish: land, speed_mps: 8}
tasks:
";

const POLYGON: &str =
    "polygon: [[36.29, -84.28], [36.29, -84.27], [36.295, -84.27], [36.295, -84.28]]";
const CAMERA: &str = "camera: {fov_deg: [60, 45]}";

fn spec(task: &str) -> String {
    format!("{HEAD}  - {task}\n")
}

#[test]
fn areas_corridors_and_patterns_are_read() {
    let text = format!(
        "{HEAD}  - {{id: north, survey: {{{POLYGON}, {CAMERA}, front_overlap: 0.8, side_overlap: 0.6, heading_deg: 90, agl_m: 80}}}}
  - {{id: line, corridor: {{line: [[36.29, -84.29], [36.30, -84.27]], width_m: 80, agl_m: 60}}}}
  - {{id: sar, search: {{pattern: expanding_square, at: {{lat: 36.29, lon: -84.27, agl_m: 60}}, leg_m: 120, legs: 16}}}}
"
    );
    let tasks = good(&text).tasks;
    let sweep = |task: usize| tasks[task].sweep.clone().expect("lines");
    let sensor = sweep(0).sensor.expect("a camera");
    assert_eq!((sensor.lines(), sensor.pictures()), (2, 5));
    assert!((sensor.swath_m(80.0) - 92.376).abs() < 1e-3);
    assert!(sweep(1).sensor.is_none());
    let SweepShape::Search(search) = sweep(2).shape else {
        panic!("{:?}", sweep(2));
    };
    assert_eq!(search.corners().len(), 17);
}

#[test]
fn what_is_wrong_with_an_area_is_reported_at_its_place() {
    let survey = |of: &str| format!("{{id: t, survey: {{{of}}}}}");
    let search = |of: &str| {
        format!("{{id: t, search: {{at: {{lat: 36.29, lon: -84.27, agl_m: 60}}, {of}}}}}")
    };
    let crossing =
        "polygon: [[36.29, -84.28], [36.296, -84.27], [36.29, -84.27], [36.294, -84.28]]";
    let outside = "polygon: [[36.39, -84.28], [36.39, -84.27], [36.41, -84.27]]";
    let around = "polygon: [[36.30, -84.27], [36.30, -84.25], [36.32, -84.25], [36.32, -84.27]]";
    for (task, path, found) in [
        (
            survey(&format!("{POLYGON}, agl_m: 80")),
            "tasks[0].survey",
            "neither camera nor swath_m",
        ),
        (
            survey(&format!("{POLYGON}, {CAMERA}, swath_m: 50, agl_m: 80")),
            "tasks[0].survey",
            "camera and swath_m",
        ),
        (
            survey(&format!("{POLYGON}, {CAMERA}")),
            "tasks[0].survey.agl_m",
            "missing field",
        ),
        (
            survey(&format!("{CAMERA}, agl_m: 80")),
            "tasks[0].survey.polygon",
            "missing field",
        ),
        (
            survey(&format!("{POLYGON}, {CAMERA}, agl_m: 45")),
            "tasks[0].survey.agl_m",
            "at least 50 m",
        ),
        (
            survey(&format!("{POLYGON}, {CAMERA}, agl_m: 145")),
            "tasks[0].survey.agl_m",
            "at most 140 m",
        ),
        (
            survey(&format!("{POLYGON}, {CAMERA}, agl_m: 80, side_overlap: 1")),
            "tasks[0].survey.side_overlap",
            "0 to 0.95",
        ),
        (
            survey(&format!(
                "{POLYGON}, {CAMERA}, agl_m: 80, front_overlap: 90"
            )),
            "tasks[0].survey.front_overlap",
            "did you mean 0.9",
        ),
        (
            survey(&format!(
                "{POLYGON}, swath_m: 50, agl_m: 80, front_overlap: 0.5"
            )),
            "tasks[0].survey.front_overlap",
            "camera alone",
        ),
        (
            survey(&format!(
                "{POLYGON}, camera: {{fov_deg: [60, 0]}}, agl_m: 80"
            )),
            "tasks[0].survey.camera.fov_deg[1]",
            "sees no ground",
        ),
        (
            survey(&format!("{POLYGON}, camera: {{}}, agl_m: 80")),
            "tasks[0].survey.camera.fov_deg",
            "missing field",
        ),
        (
            survey(&format!(
                "{POLYGON}, swath_m: 5, side_overlap: 0.9, agl_m: 80"
            )),
            "tasks[0].survey",
            "lines 0.50 m apart",
        ),
        (
            survey(&format!("{crossing}, {CAMERA}, agl_m: 80")),
            "tasks[0].survey.polygon[2]",
            "does not cross itself",
        ),
        (
            survey(&format!("{outside}, {CAMERA}, agl_m: 80")),
            "tasks[0].survey.polygon[2]",
            "outside of the area",
        ),
        (
            survey(&format!("{around}, {CAMERA}, agl_m: 80")),
            "tasks[0].survey.polygon",
            "threat `radar-1`",
        ),
        (
            survey(&format!("{POLYGON}, {CAMERA}, agl_m: 80, headin_deg: 3")),
            "",
            "did you mean `heading_deg`",
        ),
        (
            survey(&format!(
                "{POLYGON}, holes: [[[36.28, -84.28], [36.28, -84.27], [36.285, -84.27]]], {CAMERA}, agl_m: 80"
            )),
            "tasks[0].survey.holes[0]",
            "not inside",
        ),
        (
            "{id: t, corridor: {line: [[36.29, -84.29]], width_m: 80, agl_m: 60}}".to_owned(),
            "tasks[0].corridor.line",
            "1 corners",
        ),
        (
            "{id: t, corridor: {line: [[36.29, -84.29], [36.29, -84.29]], width_m: 80, agl_m: 60}}"
                .to_owned(),
            "tasks[0].corridor.line[1]",
            "from the corner before it",
        ),
        (
            search("pattern: square, leg_m: 100, legs: 4"),
            "",
            "expanding_square",
        ),
        (
            search("pattern: sector, leg_m: 100, legs: 4"),
            "tasks[0].search.legs",
            "multiple of 3",
        ),
        (
            search("pattern: parallel_track, leg_m: 100, legs: 4"),
            "tasks[0].search.spacing_m",
            "missing field",
        ),
        (
            search("pattern: expanding_square, leg_m: 5000, legs: 9"),
            "tasks[0].search",
            "outside of the area",
        ),
    ] {
        let all = issues(&spec(&task));
        let text = said_of(&all);
        assert_eq!(all.len(), 1, "{task}: {text}");
        assert!(all[0].path == path || path.is_empty(), "{task}: {text}");
        assert!(text.contains(found), "{task}: {text}");
    }
}

#[test]
fn everything_wrong_with_an_area_is_reported_at_once() {
    let task = "{id: t, survey: {polygon: [[36.29, -84.28], [36.41, -84.27], [36.295, -84.27]], camera: {fov_deg: [180, 45]}, side_overlap: 1.5, agl_m: 20}}";
    let paths: Vec<String> = issues(&spec(task))
        .into_iter()
        .map(|issue| issue.path)
        .collect();
    for path in ["polygon[1]", "camera.fov_deg[0]", "side_overlap", "agl_m"] {
        assert!(
            paths.iter().any(|found| found.ends_with(path)),
            "{path}: {paths:?}"
        );
    }
}

#[test]
fn pictures_of_a_survey_beside_those_along_the_way_of_every_copter_are_reported_at_the_camera() {
    let task = "{id: t, survey: {polygon: [[36.29, -84.28], [36.295, -84.27], [36.285, -84.27]], camera: {fov_deg: [60, 45]}, agl_m: 80}}";
    let good = spec(task);
    let with = good.replace("speed_mps:", "camera: {trigger_distance_m: 40}, speed_mps:");
    assert_ne!(good, with);
    let found = issues(&with);
    let at_camera = (found.iter()).find(|issue| issue.path == "tasks[0].survey.camera");
    let at_camera = at_camera.unwrap_or_else(|| panic!("{found:?}"));
    assert!(at_camera.found.contains("40 m"), "{at_camera:?}");
}
