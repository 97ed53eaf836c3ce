//! Problems for which cost fields alone find no path: thin walls and mazes.

use crate::support;

use std::path::PathBuf;

use sortie::dispatch::dispatch;
use sortie::spec::SpecFile;
use support::world;

/// Plans a spec of `tests/data/hard` with few evaluations, and returns the cost of the plan that
/// passes verification.
fn passing_cost(name: &str) -> f64 {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data/hard")
        .join(name);
    let text = std::fs::read_to_string(&path).expect("a test spec");
    let mut spec = SpecFile::parse(&path, text).expect("a valid spec").spec;
    spec.planner.evaluations = 2000;
    let found = dispatch(&spec, &world(&spec), 1, &|_| ());
    let failed: Vec<String> = (found.review.margins.iter())
        .filter(|margin| !margin.ok)
        .map(|margin| format!("{margin:?}"))
        .collect();
    assert!(found.review.passes(), "{name}: {failed:?}");
    found.plan.vehicles[0].terms.total()
}

/// Walls 60 m thick from edge to edge of 6 km, each with a gap of 500 m at one of its ends by
/// turns. A string pulled around their corners, which knows no turn radius, is so long.
#[test]
fn serpentine_walls_with_gaps_at_their_ends_are_flown_around() {
    for (name, string_km) in [
        ("serpentine-3.yaml", 16.15),
        ("serpentine-5.yaml", 25.85),
        ("serpentine-9.yaml", 45.81),
    ] {
        let cost = passing_cost(name);
        let allowed = 0.995 * string_km..1.05 * string_km;
        assert!(allowed.contains(&cost), "{name}: {cost}");
    }
}

#[test]
fn a_maze_of_corridors_of_140_m_with_12_turns_is_flown_through() {
    let cost = passing_cost("maze.yaml");
    assert!(cost > 8.0 && cost < 9.5, "{cost}");
}
