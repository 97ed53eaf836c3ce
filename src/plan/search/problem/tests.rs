//! Laws of a path's windows.

use std::path::Path;

use super::*;
use crate::cost::{EarlierFlights, RouteEnds};
use crate::optimize::Evaluator;
use crate::spec::SpecFile;
use crate::world::{Terrain, World};

/// Works with the search of the first shipped mission, over flat ground.
fn with_problem(windows: bool, act: impl FnOnce(&Horizontal<'_>)) {
    let text = include_str!("../../../../missions/first.yaml").to_owned();
    let file = SpecFile::parse(Path::new("first.yaml"), text).expect("a shipped mission");
    let world = World::new(&file.spec, Terrain::Flat(crate::geodesy::Amsl(584.0))).expect("ground");
    let sites = &world.sites[0];
    let context = RouteContext {
        world: &world,
        spec: &file.spec,
        index: 0,
        ends: RouteEnds {
            from: sites.start,
            to: sites.goal,
            start_s: 0.0,
        },
        earlier: EarlierFlights::none(),
        margins: Margins::default(),
        extra: &[],
        options: crate::plan::SearchOptions::default(),
        at_edges: false,
        cancel: None,
    };
    let parameters = context.parameters(context.samples());
    let sampled = Sampled::new(&context, Margins::default(), &parameters);
    act(&Horizontal::new(sampled, context.frame(), windows));
}

/// A way that winds a little, and the same with one control point moved.
fn lines(problem: &Horizontal<'_>, moved: usize) -> Vec<f64> {
    let sampled = &problem.sampled;
    let free = sampled.controls - 2;
    let mut shares = Vec::new();
    for j in 1..=free {
        #[expect(clippy::cast_precision_loss, reason = "few control points")]
        let along = j as f64 / (free + 1) as f64;
        let mix = |a: f64, b: f64| a + along * (b - a);
        let side_m = if j % 2 == 0 { 20.0 } else { -20.0 };
        shares.extend(problem.frame.shares([EastNorth {
            east_m: mix(sampled.from.at.east_m, sampled.to.at.east_m),
            north_m: mix(sampled.from.at.north_m, sampled.to.at.north_m) + side_m,
        }]));
    }
    let mut rows = shares.repeat(2);
    rows[2 * (free + moved)] += 0.01;
    rows
}

#[test]
fn costs_with_their_parts_are_the_same_costs_and_whole_paths_have_one_part() {
    for windows in [true, false] {
        with_problem(windows, |problem| {
            let rows = lines(problem, 7);
            let mut one = Evaluator::new(problem, 2, &|_| ());
            let mut other = Evaluator::new(problem, 2, &|_| ());
            let costs = one.evaluate(&rows);
            let dimension = problem.dimension();
            let make = |number: usize, line: &mut usize, row: &mut [f64]| {
                assert_eq!(number, *line);
                row.copy_from_slice(&rows[number * dimension..][..dimension]);
            };
            let mut made = vec![0.0; rows.len()];
            let (again, parts) = other.evaluate_generated(&mut made, &mut [0, 1], make, true);
            assert_eq!(made, rows);
            assert_eq!(costs, again);
            assert_eq!((one.spent(), other.spent()), (2, 2));
            if windows {
                assert_eq!(problem.groups(), problem.sampled.controls - 2);
            } else {
                assert_eq!(parts, costs);
            }
        });
    }
}

#[test]
fn a_control_point_changes_the_parts_of_those_near_it_and_no_others() {
    with_problem(true, |problem| {
        let moved = 7;
        let (groups, rows) = (problem.groups(), lines(problem, moved));
        let (mut costs, mut parts) = (vec![0.0; 2], vec![0.0; 2 * groups]);
        problem.evaluate_parts(&rows, &mut costs, &mut parts);
        let of = problem.windows[moved];
        let (was, is) = parts.split_at(groups);
        let mut apart = 0;
        for (group, window) in problem.windows.iter().enumerate() {
            let change = (is[group] - was[group]).abs();
            if window.1 < of.0 || window.0 > of.1 {
                apart += 1;
                assert!(change < 1e-9, "{group}: {change}");
            }
        }
        assert!(apart > groups / 3, "{apart}");
        let change = is[moved] - was[moved];
        assert!(change.abs() > 1e-4, "{change}");
        assert!((change - (costs[1] - costs[0])).abs() < 1e-9);
    });
}
