//! `sortie study fleet`: fleets of growing size, each planned by the whole command.

use crate::support::command;
use std::fs;
use std::path::Path;

use serde_json::Value;
use sortie::dispatch::dispatch;
use sortie::spec::SpecFile;
use sortie::study::{DELIVERY_TERRAIN, Deliveries, deliveries, delivery_ground};
use sortie::world::{self, World};

use command::{sortie, text};

/// The ground of the deliveries, by a mission in a folder with the terrain.
fn ground() -> World {
    let home = tempfile::tempdir().expect("a folder");
    let terrain = home.path().join(DELIVERY_TERRAIN.0);
    fs::create_dir_all(terrain.parent().expect("a folder")).expect("made");
    fs::write(&terrain, DELIVERY_TERRAIN.1).expect("written");
    let file = SpecFile::parse(&home.path().join("fleet.yaml"), delivery_ground());
    world::load(&file.unwrap_or_else(|error| panic!("{error}"))).expect("ground")
}

#[test]
fn each_fleet_is_the_beginning_of_every_larger_one_and_a_good_mission() {
    let world = ground();
    let large = deliveries(&world, 60, 1000);
    let small = deliveries(&world, 25, 1000);
    assert_eq!(large, deliveries(&world, 60, 1000));
    assert!(large.table.starts_with(&small.table));
    let home = tempfile::tempdir().expect("a folder");
    let Deliveries { spec, table } = large;
    fs::write(home.path().join("fleet-60.csv"), table).expect("written");
    let file = SpecFile::parse(&home.path().join("fleet-60.yaml"), spec)
        .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(file.spec.vehicles.len(), 60);
    for vehicle in &file.spec.vehicles {
        assert!(vehicle.start.place.chord_m(vehicle.goal.place) > 14_900.0);
    }
}

#[test]
fn the_shipped_fleet_is_that_of_the_study() {
    let missions = Path::new(env!("CARGO_MANIFEST_DIR")).join("missions");
    let shipped = |name: &str| fs::read_to_string(missions.join(name)).expect(name);
    let made = deliveries(&ground(), 100, 1000);
    assert!(made.spec == shipped("fleet-100.yaml"), "fleet-100.yaml");
    assert!(made.table == shipped("fleet-100.csv"), "fleet-100.csv");
}

/// All hundred take a debug build a while; the first of them already cross.
#[test]
fn the_beginning_of_the_shipped_fleet_keeps_every_limit() {
    let mission = Path::new(env!("CARGO_MANIFEST_DIR")).join("missions/fleet-100.yaml");
    let file = SpecFile::read(&mission).unwrap_or_else(|error| panic!("{error}"));
    let mut world = world::load(&file).expect("ground");
    let mut spec = file.spec;
    spec.vehicles.truncate(30);
    world.sites.truncate(30);
    let dispatched = dispatch(&spec, &world, 1, &|_| ());
    let failed: Vec<_> = dispatched
        .review
        .margins
        .iter()
        .filter(|margin| !margin.ok)
        .collect();
    assert!(dispatched.review.passes(), "{failed:?}");
    let plans = &dispatched.plan.vehicles;
    assert!(plans.iter().any(|plan| !plan.avoids.is_empty()));
}

#[test]
fn the_study_prints_a_row_for_each_size_and_keeps_what_it_made() {
    let home = tempfile::tempdir().expect("a folder");
    let asked = "study fleet --out kept --sizes 3,1 --evaluations 150 --compare-to 1 --json";
    let arguments: Vec<&str> = asked.split(' ').collect();
    let output = sortie(home.path(), &arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let printed: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let runs = printed["runs"].as_array().expect("runs");
    let sizes: Vec<_> = runs.iter().map(|run| run["vehicles"].as_u64()).collect();
    assert_eq!(sizes, [Some(1), Some(3)]);
    for run in runs {
        assert!(run["evaluations"].as_u64() >= run["vehicles"].as_u64().map(|n| 150 * n));
        assert!(run["cost"].as_f64() > Some(15.0));
        assert!(run["wall_s"].as_f64() > Some(0.0));
    }
    assert!(runs[0]["reference_cost"].as_f64() > Some(15.0));
    assert!(runs[1]["reference_cost"].is_null());
    let kept = home.path().join("kept");
    for name in [
        "fleet.md",
        "fleet-3.yaml",
        "fleet-3.csv",
        "fleet-3/plan.json",
    ] {
        assert!(kept.join(name).exists(), "{name}");
    }
    assert_eq!(
        fs::read_to_string(kept.join("fleet.json")).ok(),
        Some(text(&output.stdout))
    );
}
