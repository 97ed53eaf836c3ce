//! Fleets for which there is no path, or none was found: the verdict names what blocks them.

use crate::support;

use std::process::Output;

use sortie::dispatch::{Dispatched, dispatch};
use sortie::geodesy::{Agl, Amsl};
use sortie::plan::{BlockingElement, BlockingSets, Change, violations};
use sortie::spec::*;
use sortie::world::{Terrain, TerrainGrid, World};
use support::command::{sortie, text};
use support::plans::{EAST, SOUTH, WEST, plan};
use support::{copter, empty_spec, generated, place, plane, threat, vtol, world};
use tempfile::TempDir;

/// Planned, encoded and judged, as `sortie plan` does.
fn dispatched(spec: &MissionSpec, world: &World) -> Dispatched {
    dispatch(spec, world, spec.planner.seed, &|_| ())
}

/// What breaks the only vehicle of a spec, in words.
fn blocked(spec: &MissionSpec) -> Vec<String> {
    let (world, fleet) = plan(spec);
    let found = violations(spec, &world, &spec.vehicles[0], &fleet.vehicles[0]);
    assert_eq!(found.is_empty(), fleet.vehicles[0].terms.is_clean());
    found.into_iter().map(|block| block.what).collect()
}

#[test]
fn a_goal_behind_a_closed_ring_is_blocked_by_threats_of_the_ring_and_no_others() {
    let mut spec = empty_spec(vec![copter("alpha", 1, WEST, EAST)]);
    let metres_per_degree = 89_800.0;
    for k in 0..8 {
        let angle = f64::from(k) * std::f64::consts::FRAC_PI_4;
        let at = place(
            EAST.lat_deg + 1500.0 * angle.sin() / 111_000.0,
            EAST.lon_deg + 1500.0 * angle.cos() / metres_per_degree,
        );
        spec.threats.push(threat(&format!("ring-{k}"), at, 700.0));
    }
    spec.threats.push(threat("aside", SOUTH, 500.0));
    let found = blocked(&spec);
    assert!(!found.is_empty());
    assert!(
        found.iter().all(|what| what.starts_with("threat ring-")),
        "{found:?}"
    );
}

/// What closes every way from the start of a vehicle to its goal.
fn blocking_sets(world: &World, vehicle: usize) -> Vec<BlockingElement> {
    let sites = &world.sites[vehicle];
    BlockingSets::of(world).between(sites.start.at, sites.goal.at)
}

/// Whether it is proven that nobody can fly from the start of a vehicle to its goal.
fn is_blocked(world: &World, vehicle: usize) -> bool {
    !blocking_sets(world, vehicle).is_empty()
}

#[test]
fn a_closed_wall_is_proven_to_cut_a_goal_off_and_one_with_a_gap_is_not() {
    let walls = |gap: Option<u8>| {
        let mut spec = empty_spec(vec![copter("alpha", 1, WEST, EAST)]);
        for row in (0..=20).filter(|row| gap != Some(*row)) {
            let at = place(36.25 + 0.005 * f64::from(row), -84.25);
            spec.threats.push(threat(&format!("wall-{row}"), at, 300.0));
        }
        spec.area.south_west = place(36.249, -84.33);
        spec.area.north_east = place(36.351, -84.17);
        spec
    };
    assert!(is_blocked(&world(&walls(None)), 0));
    assert!(!is_blocked(&world(&walls(Some(3))), 0));
    // A zone in the gap closes it, unless it leaves room under the ceiling.
    let mut zoned = walls(Some(3));
    let corners = [
        (36.26, -84.27),
        (36.26, -84.23),
        (36.27, -84.23),
        (36.27, -84.27),
    ];
    zoned.no_fly.push(Zone {
        id: "gap".to_owned(),
        polygon: corners.map(|(lat, lon)| place(lat, lon)).to_vec(),
        ceiling: Some(sortie::spec::Placement::Amsl(Amsl(
            zoned.area.max_amsl.0 - 1.0,
        ))),
        ..Zone::default()
    });
    assert!(!is_blocked(&world(&zoned), 0));
    zoned.no_fly[0].ceiling = None;
    assert!(is_blocked(&world(&zoned), 0));
}

#[test]
fn of_the_generated_scenarios_those_that_nobody_can_fly_are_told_apart() {
    let is_proven = |seed: u64, difficulty: u8| {
        let file = generated(seed, difficulty);
        let world = sortie::world::load(&file).expect("the ground is analytic");
        (0..file.spec.vehicles.len()).all(|vehicle| is_blocked(&world, vehicle))
    };
    assert!(is_proven(108, 8) && is_proven(120, 10));
    assert!(!is_proven(107, 7) && !is_proven(110, 10) && !is_proven(118, 8));
}

#[test]
fn where_all_is_threat_the_threat_is_named() {
    let mut spec = empty_spec(vec![copter("alpha", 1, WEST, EAST)]);
    let middle = place(36.30, -84.25);
    spec.threats.push(threat("everywhere", middle, 6000.0));
    spec.area.south_west = place(36.28, -84.33);
    spec.area.north_east = place(36.32, -84.17);
    assert_eq!(blocked(&spec), ["threat everywhere"]);
}

#[test]
fn a_pass_that_no_turn_fits_into_is_named_by_what_stands_beside_it() {
    // Two walls of threats with passes far apart: through one, then at once through the other.
    let mut fast = copter("alpha", 1, WEST, EAST);
    fast.speed_mps = 40.0;
    fast.accel_mps2 = 1.0;
    let mut spec = empty_spec(vec![fast]);
    for row in 0..=20 {
        let lat = 36.25 + 0.005 * f64::from(row);
        for (wall, lon, open) in [("a", -84.26, 18), ("b", -84.245, 2)] {
            if row != open {
                spec.threats
                    .push(threat(&format!("{wall}-{row}"), place(lat, lon), 300.0));
            }
        }
    }
    spec.area.south_west = place(36.249, -84.33);
    spec.area.north_east = place(36.351, -84.17);
    let found = blocked(&spec);
    let named = |wall: &str| found.iter().any(|what| what.contains(wall));
    assert!(named(" a-") || named(" b-"), "{found:?}");
}

#[test]
fn a_ridge_above_the_ceiling_is_named_with_its_height() {
    let mut spec = empty_spec(vec![copter("alpha", 1, WEST, EAST)]);
    let hills = (0..25).map(|k| Hill {
        place: place(36.18 + 0.01 * f64::from(k), -84.25),
        height_m: 900.0,
        radius_m: 1500.0,
    });
    spec.terrain = TerrainSource::Analytic {
        base: Amsl(300.0),
        hills: hills.collect(),
    };
    spec.area.max_amsl = Amsl(800.0);
    let found = blocked(&spec);
    assert!(
        found
            .iter()
            .any(|what| what.starts_with("the ground") || what.starts_with("the ceiling")),
        "{found:?}"
    );
}

/// A copter from `WEST` to `EAST` over flat ground, in an area around them.
fn across() -> MissionSpec {
    let mut spec = empty_spec(vec![copter("alpha", 1, WEST, EAST)]);
    spec.area.south_west = place(36.249, -84.33);
    spec.area.north_east = place(36.351, -84.17);
    spec
}

/// A zone of some metres from west to east around a meridian, between two latitudes.
fn wall(id: &str, lon_deg: f64, (south_deg, north_deg): (f64, f64), width_m: f64) -> Zone {
    let half_deg = 0.5 * width_m / 89_800.0;
    let (west, east) = (lon_deg - half_deg, lon_deg + half_deg);
    Zone {
        id: id.to_owned(),
        polygon: vec![
            place(south_deg, west),
            place(north_deg, west),
            place(north_deg, east),
            place(south_deg, east),
        ],
        ..Zone::default()
    }
}

#[test]
fn a_wall_thinner_than_any_cell_is_passed_at_its_open_end_or_through_its_gap() {
    let passes = |zones: Vec<Zone>| {
        let spec = MissionSpec {
            no_fly: zones,
            ..across()
        };
        let found = dispatched(&spec, &world(&spec));
        let vehicle = &found.plan.vehicles[0];
        assert!(vehicle.terms.is_clean(), "{:?}", vehicle.terms);
        let ends = [spec.vehicles[0].start.place, spec.vehicles[0].goal.place];
        let [from, to] = ends.map(|end| spec.frame.to_plan(end));
        assert!(1000.0 * vehicle.terms.length > 1.01 * from.distance_m(to));
        assert!(vehicle.bound <= vehicle.terms.total());
        assert!(found.review.passes());
    };
    for width_m in [0.5, 2.0, 10.0, 60.0] {
        passes(vec![wall("wall", -84.25, (36.24, 36.315), width_m)]);
        passes(vec![
            wall("south", -84.25, (36.24, 36.275), width_m),
            wall("north", -84.25, (36.276, 36.36), width_m),
        ]);
    }
}

#[test]
fn a_wall_from_edge_to_edge_is_named_with_the_edge_however_thin() {
    for width_m in [0.02, 1.0, 30.0] {
        let mut spec = across();
        spec.planner.evaluations = 2000;
        spec.no_fly = vec![wall("wall", -84.25, (36.24, 36.36), width_m)];
        let world = world(&spec);
        let found = dispatched(&spec, &world);
        let vehicle = &found.plan.vehicles[0];
        let mut named: Vec<String> = vehicle
            .blocking_set
            .iter()
            .map(|of| of.name(&spec))
            .collect();
        named.sort();
        assert_eq!(named, ["the edge of the area", "zone wall"], "{width_m} m");
        let broken = violations(&spec, &world, &spec.vehicles[0], vehicle);
        assert_eq!(broken.len(), 1, "{broken:?}");
        assert_eq!(broken[0].what, "zone wall");
        assert_eq!(vehicle.relaxations, None);
    }
}

#[test]
fn a_wall_with_heights_closes_the_way_where_it_leaves_no_room_over_or_under_it() {
    // The ground is at 400 m, the least height 60 m, the greatest 120 m.
    let agl = |agl_m: f64| Some(Placement::Agl(Agl(agl_m)));
    let amsl = |amsl_m: f64| Some(Placement::Amsl(Amsl(amsl_m)));
    for (floor, ceiling, closes) in [
        (None, agl(120.5), true),
        (None, agl(119.5), false),
        (None, amsl(520.5), true),
        (None, amsl(519.5), false),
        (agl(59.5), agl(125.0), true),
        (agl(60.5), agl(125.0), false),
        (amsl(459.5), None, true),
        (amsl(460.5), None, false),
    ] {
        let mut spec = across();
        spec.vehicles[0].altitudes.max_agl = Some(Agl(120.0));
        let wall = wall("wall", -84.25, (36.24, 36.36), 100.0);
        spec.no_fly = vec![Zone {
            floor,
            ceiling,
            ..wall
        }];
        assert_eq!(
            is_blocked(&world(&spec), 0),
            closes,
            "{floor:?} {ceiling:?}"
        );
        // Without a greatest height there is room over it, if it has a ceiling.
        spec.vehicles[0].altitudes.max_agl = None;
        let closes = closes && ceiling.is_none();
        assert_eq!(
            is_blocked(&world(&spec), 0),
            closes,
            "{floor:?} {ceiling:?}"
        );
        // In hills that no grid shows nothing is known of heights above the sea.
        spec.terrain = TerrainSource::Analytic {
            base: Amsl(400.0),
            hills: vec![Hill {
                place: WEST,
                height_m: 1.0,
                radius_m: 0.1,
            }],
        };
        let is_known = !matches!(floor, Some(Placement::Amsl(_)));
        assert_eq!(is_blocked(&world(&spec), 0), closes && is_known);
    }
}

#[test]
fn many_small_threats_in_a_row_close_the_way_together() {
    let mut spec = across();
    spec.planner.evaluations = 1000;
    for k in 0..1200 {
        let at = place(36.249 + 0.102 * f64::from(k) / 1199.0, -84.25);
        spec.threats.push(threat(&format!("post-{k}"), at, 6.0));
    }
    let world = world(&spec);
    let closed = blocking_sets(&world, 0);
    assert!(closed.contains(&BlockingElement::Edge));
    assert!(closed.len() > 500, "{}", closed.len());
    spec.threats.remove(600);
    spec.threats.remove(600);
    assert_eq!(blocking_sets(&support::world(&spec), 0), []);
}

/// Flat ground with nodes 90 m apart, and none where `is_void` says so of row and column.
fn with_voids(spec: &MissionSpec, is_void: impl Fn(usize, usize) -> bool) -> World {
    let (rows, columns) = (160, 200);
    let step_deg = 1.0 / 1200.0;
    let heights_m = (0..rows * columns)
        .map(|node| match is_void(node / columns, node % columns) {
            true => f32::NAN,
            false => 500.0,
        })
        .collect();
    let grid = TerrainGrid {
        raised_m: 0.0,
        north_west: place(36.36, -84.335),
        row_step_deg: step_deg,
        column_step_deg: step_deg,
        rows,
        columns,
        heights_m,
    };
    World::new(spec, Terrain::Grid(grid)).expect("there is ground under the ends")
}

#[test]
fn a_column_of_voids_closes_the_way_and_is_named() {
    let spec = across();
    let closed = with_voids(&spec, |_, column| column == 100);
    assert_eq!(blocking_sets(&closed, 0).len(), 2);
    assert!(blocking_sets(&closed, 0).contains(&BlockingElement::Void));
    let found = dispatched(&spec, &closed);
    let broken = violations(&spec, &closed, &spec.vehicles[0], &found.plan.vehicles[0]);
    assert!(
        broken
            .iter()
            .any(|of| of.what == "ground of unknown height"),
        "{broken:?}"
    );
    let open = with_voids(&spec, |row, column| column == 100 && row > 60);
    assert_eq!(blocking_sets(&open, 0), []);
    assert!(dispatched(&spec, &open).plan.vehicles[0].terms.is_clean());
}

#[test]
fn a_hole_in_the_data_on_the_way_is_passed_without_a_penalty() {
    let spec = across();
    let is_hole = |row: usize, column: usize| row.abs_diff(72) < 6 && column.abs_diff(100) < 6;
    for hole in [|row, column| row == 72 && column == 100, is_hole] {
        let world = with_voids(&spec, hole);
        let found = dispatched(&spec, &world);
        let vehicle = &found.plan.vehicles[0];
        assert!(vehicle.terms.is_clean(), "{:?}", vehicle.terms);
        assert!(
            vehicle.terms.total() < 1.02 * vehicle.bound,
            "{:?}",
            vehicle.terms
        );
        assert!(found.review.passes());
    }
}

#[test]
fn ground_that_the_grid_does_not_show_proves_nothing() {
    let mut spec = across();
    spec.area.max_amsl = Amsl(450.0);
    // A plateau up to the ceiling, and a slot of hollows along the way.
    let slot = |radius_m: f64, apart_deg: f64, count: u32| {
        let hills = (0..count).map(|k| Hill {
            place: place(36.30, -84.32 + apart_deg * f64::from(k)),
            height_m: -300.0,
            radius_m,
        });
        TerrainSource::Analytic {
            base: Amsl(440.0),
            hills: hills.collect(),
        }
    };
    spec.terrain = slot(8.0, 0.0002, 701);
    assert_eq!(blocking_sets(&world(&spec), 0), []);
    spec.terrain = slot(400.0, 0.005, 29);
    assert_eq!(blocking_sets(&world(&spec), 0), []);
    // The same in two halves: high ground lies all around each of them.
    if let TerrainSource::Analytic { hills, .. } = &mut spec.terrain {
        hills.retain(|hill| (hill.place.lon_deg + 84.25).abs() > 0.02);
    }
    assert_eq!(blocking_sets(&world(&spec), 0), [BlockingElement::Ground]);
}

/// Two walls, each with a gap, and the gaps 4.4 km from each other.
fn offset_gaps(thick_m: f64, apart_m: f64, gap_deg: f64) -> MissionSpec {
    let mut spec = across();
    let half_deg = 0.5 * (thick_m + apart_m) / 89_800.0;
    let (a, b) = (-84.25 - half_deg, -84.25 + half_deg);
    spec.no_fly = vec![
        wall("a-south", a, (36.24, 36.32), thick_m),
        wall("a-north", a, (36.32 + gap_deg, 36.36), thick_m),
        wall("b-south", b, (36.24, 36.28), thick_m),
        wall("b-north", b, (36.28 + gap_deg, 36.36), thick_m),
    ];
    spec
}

#[test]
fn a_pass_narrower_than_a_turn_is_named_to_who_cannot_rest_in_it_and_one_that_fits_does_pass() {
    let mut spec = offset_gaps(400.0, 250.0, 0.001);
    spec.vehicles[0].speed_mps = 40.0;
    spec.planner.evaluations = 20_000;
    let of_copter = world(&spec);
    let rests = dispatched(&spec, &of_copter);
    assert!(rests.plan.vehicles[0].terms.is_clean());
    assert!(
        !rests.planned_spec(&spec, &of_copter).0.vehicles[0]
            .stops
            .is_empty()
    );
    spec.vehicles[0] = vtol(plane("alpha", 1, WEST, EAST));
    spec.vehicles[0].speed_mps = 40.0;
    let world = world(&spec);
    let found = dispatched(&spec, &world);
    let vehicle = &found.plan.vehicles[0];
    assert!(!vehicle.terms.is_clean());
    assert_eq!(vehicle.blocking_set, []);
    let relaxations = vehicle.relaxations.as_ref().expect("they were looked for");
    let turns = relaxations
        .iter()
        .find_map(|relaxation| match relaxation.0[..] {
            [Change::TurnRadius(radius_m), ref others @ ..] => {
                Some((relaxation, radius_m, others.to_vec()))
            }
            _ => None,
        });
    let (relaxation, radius_m, others) = turns.unwrap_or_else(|| panic!("{relaxations:?}"));
    let words = relaxation.words(&spec.vehicles[0]);
    assert!(words.starts_with("turns of "), "{words}");
    // What it says is so: as slow as that there is a path.
    let as_slow = radius_m / sortie::path::VehicleLimits::of(&spec.vehicles[0]).turn_radius_m;
    spec.vehicles[0].speed_mps *= as_slow.sqrt();
    for change in others {
        if let Change::ControlPoints(count) = change {
            spec.planner.control_points = count;
        }
    }
    let slow = dispatched(&spec, &world);
    assert!(slow.plan.vehicles[0].terms.is_clean());
}

#[test]
fn too_few_control_points_are_made_as_many_as_the_route_needs() {
    let mut spec = offset_gaps(18.0, 400.0, 0.002);
    spec.planner.control_points = 5;
    spec.planner.evaluations = 20_000;
    let world = world(&spec);
    let found = dispatched(&spec, &world);
    let vehicle = &found.plan.vehicles[0];
    assert!(vehicle.terms.is_clean(), "{:?}", vehicle.terms);
    assert!(found.review.passes());
    // Start and goal besides the five.
    assert!(vehicle.routes[0].control_points.len() > 7);
}

#[test]
fn plan_says_on_its_output_what_closes_every_way() {
    let (folder, out) = planned(CLOSED);
    let text = text(&out.stdout) + &text(&out.stderr);
    let plan = std::fs::read_to_string(folder.path().join("out/plan.json")).expect("a plan");
    assert_eq!(out.status.code(), Some(4), "{text}");
    assert!(
        text.contains("every way is closed by zone wall and the edge of the area"),
        "{text}"
    );
    assert!(
        plan.contains("\"is_proven_infeasible\": true")
            || plan.contains("\"is_proven_infeasible\":true")
    );
    assert!(plan.contains("\"blocking_set\""));
}

#[test]
fn the_page_of_a_failed_plan_says_what_the_terminal_says() {
    // The second is too low as well.
    for spec in [
        CLOSED.to_owned(),
        CLOSED.replace("max_amsl_m: 704", "max_amsl_m: 650"),
    ] {
        let (folder, out) = planned(&spec);
        assert_eq!(out.status.code(), Some(4));
        let said = text(&out.stdout);
        let page = folder.path().join("out/review.html");
        let page = std::fs::read_to_string(page).expect("a page");
        let reasons = said
            .lines()
            .filter_map(|line| line.strip_prefix("FAIL a: no path"));
        let reasons: Vec<&str> = reasons.collect();
        assert_eq!(reasons.len(), 1, "{said}");
        let reason = format!("a: no path{}", reasons[0]);
        assert!(page.contains(&format!("<li>{reason}</li>")), "{reason}");
        assert!(
            reason.contains("every way is closed by zone wall"),
            "{reason}"
        );
        // A cross on the map for each place that is named.
        let named = reason.matches("worst at").count();
        assert!(named > 0, "{reason}");
        assert_eq!(
            page.matches("class=\"violation\"").count(),
            named,
            "{reason}"
        );
    }
}

/// What `plan` says of a spec, and the folder with its `out`.
fn planned(spec: &str) -> (TempDir, Output) {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("closed.yaml"), spec).expect("a spec");
    let output = sortie(folder.path(), &["plan", "closed.yaml", "--out", "out"]);
    (folder, output)
}

/// A wall of a metre across the whole area.
const CLOSED: &str = "sortie: 1
name: closed
area: {south_west: {lat: -35.405, lon: 149.11}, north_east: {lat: -35.315, lon: 149.22}, min_agl_m: 40, max_amsl_m: 704}
terrain: {flat: {amsl_m: 584}}
no_fly:
  - {id: wall, polygon: [[-35.41, 149.165], [-35.41, 149.16501], [-35.31, 149.16501], [-35.31, 149.165]]}
vehicles:
  - {id: a, sysid: 1, autopilot: ardupilot, link: sim, finish: land, speed_mps: 10, start: {lat: -35.36, lon: 149.16, agl_m: 60}, goal: {lat: -35.36, lon: 149.172, agl_m: 60}}
planner: {evaluations: 1000}
";

/// Ends stand as high as the exact terrain asks; the grid of the objective is millimetres above it.
#[test]
fn a_fleet_that_passes_breaks_no_limit_in_its_cost_either() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("missions/harbour.yaml");
    let mut file = SpecFile::read(&path).expect("a shipped mission");
    file.spec.planner.evaluations = 2_000;
    let world = sortie::world::load(&file).expect("the ground is analytic");
    let found = dispatched(&file.spec, &world);
    assert!(found.review.passes());
    for plan in &found.plan.vehicles {
        assert!(plan.terms.is_clean(), "{:?}", plan.terms);
    }
}
