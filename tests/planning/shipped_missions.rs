//! The missions that ship with Sortie, and their schema.

use std::fs;
use std::path::{Path, PathBuf};

use sortie::geodesy::EastNorth;
use sortie::spec::{Finish, SpecFile, json_schema};
use sortie::world;

fn missions() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("missions")
}

fn specs() -> Vec<SpecFile> {
    let mut paths: Vec<PathBuf> = fs::read_dir(missions())
        .expect("missions")
        .map(|entry| entry.expect("a mission").path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "yaml"))
        .collect();
    paths.sort();
    assert!(paths.len() >= 3, "{paths:?}");
    paths
        .iter()
        .map(|path| SpecFile::read(path).unwrap_or_else(|error| panic!("{error}")))
        .collect()
}

#[test]
fn every_shipped_mission_is_good_and_its_ground_is_known() {
    for file in specs() {
        let world = world::load(&file).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(world.sites.len(), file.spec.vehicles.len());
        let name = file.path.file_stem().and_then(|stem| stem.to_str());
        assert_eq!(name, Some(file.spec.name.as_str()), "named as its file");
        assert!(
            file.text
                .starts_with("# yaml-language-server: $schema=schema.json\n"),
            "{name:?}"
        );
        for height_m in &world.ground.heights_m {
            assert!(height_m.is_finite(), "no hole in the ground of {name:?}");
        }
    }
}

/// On failure: `sortie schema > missions/schema.json`.
#[test]
fn the_shipped_schema_is_that_of_the_program() {
    let shipped = fs::read_to_string(missions().join("schema.json")).expect("a schema");
    assert!(
        shipped == json_schema(),
        "missions/schema.json is not what `sortie schema` prints"
    );
}

#[test]
fn every_threat_of_jacksboro_lies_on_a_straight_way() {
    let files = specs();
    let file = files
        .iter()
        .find(|file| file.spec.name == "jacksboro")
        .expect("jacksboro");
    let world = world::load(file).expect("a world");
    assert!(world.threats.len() >= 5);
    for (threat, disc) in file.spec.threats.iter().zip(&world.threats) {
        let matters = world.sites.iter().any(|sites| {
            let (start, goal) = (sites.start.at, sites.goal.at);
            (0..=1000).any(|step| {
                let t = f64::from(step) / 1000.0;
                disc.contains(EastNorth {
                    east_m: start.east_m + t * (goal.east_m - start.east_m),
                    north_m: start.north_m + t * (goal.north_m - start.north_m),
                })
            })
        });
        assert!(matters, "{} is in nobody's way", threat.id);
    }
    for finish in [Finish::Land, Finish::Loiter, Finish::Return] {
        assert!(
            file.spec
                .vehicles
                .iter()
                .any(|vehicle| vehicle.finish == finish),
            "{finish:?}"
        );
    }
}
