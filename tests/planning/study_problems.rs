//! The problems that the study makes.

use std::path::Path;

use sortie::spec::SpecFile;
use sortie::study::{Family, MAX_DIFFICULTY, scenario};
use sortie::world::{self, World};

/// A spec that checks, and its world.
fn loaded(what: &str, text: &str) -> (SpecFile, World) {
    let file = SpecFile::parse(Path::new("problem.yaml"), text.to_owned())
        .unwrap_or_else(|error| panic!("{what}: {error}\n{text}"));
    let world = world::load(&file).unwrap_or_else(|error| panic!("{what}: {error}\n{text}"));
    (file, world)
}

#[test]
fn every_problem_of_every_family_is_a_good_spec_and_its_own() {
    for family in Family::ALL {
        assert_eq!(Family::named(family.name()), Some(family));
        let texts: Vec<String> = (1..=6).map(|seed| family.problem(seed)).collect();
        assert_eq!(texts[0], family.problem(1));
        for (number, text) in texts.iter().enumerate() {
            assert!(!texts[..number].contains(text));
            loaded(&format!("{family:?} {}", number + 1), text);
        }
    }
}

#[test]
fn every_scenario_is_a_good_spec_of_the_promised_size() {
    for difficulty in 1..=MAX_DIFFICULTY {
        for seed in 0..4 {
            let text = scenario(seed, difficulty);
            let (file, world) = loaded(&format!("{seed} {difficulty}"), &text);
            let threats = file.spec.threats.len();
            assert!((5..=40).contains(&threats), "{threats}\n{text}");
            for sites in &world.sites {
                let km = sites.start.distance_m(sites.goal) / 1000.0;
                assert!((4.9..=205.0).contains(&km), "{km}");
            }
        }
    }
}
