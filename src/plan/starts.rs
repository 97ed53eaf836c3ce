//! Where the sub-swarms of one course begin: a spline in every route class, with its
//! control points bunched in several ways.

use std::collections::BTreeMap;

use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::classes::{Guide, guides};
use super::course::Course;
use super::field::{Field, Grid, Reading, Relief};
use super::fit::{Fitter, Line, Warp};
use super::obstacles::Obstacles;
use super::problem::{Frame, Horizontal};
use super::swerve::{conflict_m, swerve};
use crate::geodesy::EastNorth;
use crate::optimize::{Evaluator, Start};
use crate::spec::Part;
use crate::world::World;

/// Slope limits of the three fields, in units of the vehicle's: one field is not
/// enough, because dilation raises valleys beside ridges as well.
const SLOPE_FACTORS: [f64; 3] = [1.0, 2.5, f64::INFINITY];
/// A gap between threats of fewer cells than this asks for a grid twice as fine.
const GAP_CELLS: f64 = 3.0;
/// Most guides that are fitted.
const MAX_GUIDES: usize = 60;
/// Warped fits of one class.
const WARPS: usize = 24;
/// Fits of one class that become starts.
const FITS_PER_CLASS: usize = 3;
/// What each further start of one class costs in the ranking.
const REPEAT: f64 = 0.04;
/// Unit of a start's steps, in distances between control points.
const STEP_UNIT: f64 = 0.3;
/// Share of the budget for fits.
const FIT_SHARE: usize = 20;
/// Classes that meet earlier flights and get swerves, the most promising ones.
const SWERVING: usize = 4;
/// Swerves of one class.
const SWERVES: usize = 72;
/// Costs that differ by a smaller share are the same.
const HAIR: f64 = 1e-9;
/// Nodes along a profile in which summits are looked for.
const PROFILE: usize = 65;

/// A fitted spline and how promising it is.
struct Fit {
    class: u64,
    cost: f64,
    score: f64,
    start: Start,
}

/// Starts, the most promising first. Evaluates fits on the way, all counted.
///
/// Classes are ranked as if the vehicle were alone: who meets others on a short way mostly
/// loses little by letting them pass. `alone` judges so, `among` with the earlier flights;
/// without `among` there is one judgement only.
pub(super) fn starts(
    course: &Course<'_>,
    fitter: &Fitter,
    alone: &mut Evaluator<'_, Horizontal<'_>>,
    among: Option<&mut Evaluator<'_, Horizontal<'_>>>,
    swarms: usize,
    rng: &mut ChaCha8Rng,
) -> Vec<Start> {
    let planner = &course.spec.planner;
    let lines: Vec<(Guide, Line)> = course_guides(course, alone.budget())
        .into_iter()
        .map(|guide| {
            let line = Line::new(guide.line.clone());
            (guide, line)
        })
        .collect();
    let even: Vec<_> = lines.iter().map(|pair| (pair, Warp::even())).collect();
    let mut fits = evaluate(course, fitter, alone, &even);
    let allowed = (alone.budget() / FIT_SHARE).saturating_sub(alone.spent());
    let best = best_of_classes(&fits, 2 * swarms);
    let each = match planner.has(Part::Warps) {
        true => (allowed / best.len().max(1)).min(WARPS),
        false => 0,
    };
    let mut warped = Vec::new();
    for &index in &best {
        let summits = summits(course, &lines[index].1);
        warped.extend((0..each).map(|_| (&lines[index], Warp::random(&summits, rng))));
    }
    fits.extend(evaluate(course, fitter, alone, &warped));
    if let Some(among) = among {
        give_way(course, fitter, among, &lines, &best, &mut fits, rng);
    }
    rank(fits)
}

/// Adds swerves to the classes that meet earlier flights. Of what was fitted to such a class
/// only the even fit stays, as a class beside it: mostly a swerve beats it, but it may yet
/// pass before the others.
fn give_way(
    course: &Course<'_>,
    fitter: &Fitter,
    among: &mut Evaluator<'_, Horizontal<'_>>,
    lines: &[(Guide, Line)],
    best: &[usize],
    fits: &mut Vec<Fit>,
    rng: &mut ChaCha8Rng,
) {
    let rows: Vec<f64> = best
        .iter()
        .flat_map(|&index| &fits[index].start.mean)
        .copied()
        .collect();
    let costs = among.evaluate(&rows);
    let met: Vec<usize> = best
        .iter()
        .zip(costs)
        .filter(|&(&index, cost)| cost > fits[index].cost * (1.0 + HAIR))
        .map(|(&index, _)| index)
        .collect();
    let swerving = &met[..met.len().min(SWERVING)];
    let allowed = among.budget() / FIT_SHARE / swerving.len().max(1);
    let mut swerves: Vec<(Guide, Line)> = Vec::new();
    for &index in swerving {
        let (guide, line) = &lines[index];
        let at_m = conflict_m(course, line);
        swerves.extend((0..allowed.min(SWERVES)).map(|number| {
            let line = swerve(course, line, at_m, number % 2 == 0, rng);
            (guide.clone(), line)
        }));
    }
    let wanted: Vec<_> = swerves.iter().map(|pair| (pair, Warp::even())).collect();
    let swerved = evaluate(course, fitter, among, &wanted);
    let classes: Vec<u64> = met.iter().map(|&index| fits[index].class).collect();
    let mut index = 0;
    fits.retain(|fit| {
        index += 1;
        met.contains(&(index - 1)) || !classes.contains(&fit.class)
    });
    for fit in fits.iter_mut().filter(|fit| classes.contains(&fit.class)) {
        fit.class = fit.class.wrapping_add(1);
        fit.start.class = fit.class;
        fit.score *= 1.0 + REPEAT;
    }
    fits.extend(swerved);
}

/// Guides of all three fields, cheapest first, and the straight line.
fn course_guides(course: &Course<'_>, budget: usize) -> Vec<Guide> {
    let (start, goal) = (course.leg.from.at, course.leg.to.at);
    let planner = &course.spec.planner;
    if !planner.has(Part::Routes) {
        return vec![straight(start, goal, 0)];
    }
    let factors = match planner.has(Part::Fields) {
        true => &SLOPE_FACTORS[..],
        false => &SLOPE_FACTORS[..1],
    };
    let nodes = if budget >= 20_000 { 81 } else { 41 };
    let narrowest_m = narrowest_gap_m(course.world);
    let prices = course.prices();
    let (near, whole) = (course.near_box(), course.frame());
    let search = |south_west, north_east| {
        let mut grid = Grid::over(south_west, north_east, nodes);
        if narrowest_m < GAP_CELLS * grid.spacing_m {
            grid = Grid::over(south_west, north_east, 2 * nodes - 1);
        }
        let relief = Relief::new(course.world, grid, &prices, Reading::Wary);
        let fields: Vec<Field> = factors
            .par_iter()
            .map(|factor| relief.field(factor * course.slope(), &prices))
            .collect();
        let obstacles = Obstacles::of(&fields, start, goal);
        let mut found: Vec<Guide> = fields
            .par_iter()
            .map(|field| guides(field, &obstacles, start, goal))
            .collect::<Vec<_>>()
            .concat();
        found.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        found.truncate(MAX_GUIDES);
        let class = obstacles.signature(&[start, goal]);
        found.push(straight(start, goal, class));
        found
    };
    let found = search(near.south_west, near.north_east);
    // Where no way nearby is clean, one far around may be.
    if near != whole && found[0].cost > 2.0 * course.straight_km() {
        return search(whole.south_west, whole.north_east);
    }
    found
}

/// The least distance between the rims of two threats that do not touch, metres.
fn narrowest_gap_m(world: &World) -> f64 {
    let mut least_m = f64::INFINITY;
    for (index, one) in world.threats.iter().enumerate() {
        for other in &world.threats[..index] {
            let gap_m = one.center.distance_m(other.center) - one.radius_m - other.radius_m;
            if gap_m > 0.0 {
                least_m = least_m.min(gap_m);
            }
        }
    }
    least_m
}

/// The straight line as a guide.
fn straight(start: EastNorth, goal: EastNorth, class: u64) -> Guide {
    Guide {
        class,
        cost: start.distance_m(goal) / 1000.0,
        line: vec![start, goal],
    }
}

/// Fits guides under warps and evaluates them in one batch.
fn evaluate(
    course: &Course<'_>,
    fitter: &Fitter,
    evaluator: &mut Evaluator<'_, Horizontal<'_>>,
    wanted: &[(&(Guide, Line), Warp)],
) -> Vec<Fit> {
    let frame = course.frame();
    let starts: Vec<Start> = wanted
        .par_iter()
        .map(|((guide, line), warp)| start(&frame, fitter, line, warp, guide.class))
        .collect();
    let rows: Vec<f64> = starts
        .iter()
        .flat_map(|start| &start.mean)
        .copied()
        .collect();
    let costs = evaluator.evaluate(&rows);
    starts
        .into_iter()
        .zip(costs)
        .zip(wanted)
        .map(|((start, cost), ((guide, _), _))| Fit {
            class: guide.class,
            cost,
            score: 0.8 * cost + 0.2 * guide.cost,
            start,
        })
        .collect()
}

/// The spline nearest to a line under a warp as a start.
pub(super) fn start(frame: &Frame, fitter: &Fitter, line: &Line, warp: &Warp, class: u64) -> Start {
    let mean: Vec<f64> = fitter
        .fit(line, warp)
        .into_iter()
        .flat_map(|at: EastNorth| {
            let (east, north) = frame.share(at);
            [east, north]
        })
        .collect();
    #[expect(clippy::cast_precision_loss, reason = "a number of control points")]
    let spacing_m = line.length_m() / (mean.len() / 2 + 1) as f64;
    Start {
        scale: frame.scale(STEP_UNIT * spacing_m, mean.len()),
        mean,
        class,
    }
}

/// Indices of the best fit of each class, best class first.
fn best_of_classes(fits: &[Fit], most: usize) -> Vec<usize> {
    let mut best: BTreeMap<u64, usize> = BTreeMap::new();
    for (index, fit) in fits.iter().enumerate() {
        let entry = best.entry(fit.class).or_insert(index);
        if fit.score < fits[*entry].score {
            *entry = index;
        }
    }
    let mut indices: Vec<usize> = best.into_values().collect();
    indices.sort_by(|&a, &b| fits[a].score.total_cmp(&fits[b].score).then(a.cmp(&b)));
    indices.truncate(most);
    indices
}

/// The best fits of each class, those of one class handicapped in turn.
fn rank(mut fits: Vec<Fit>) -> Vec<Start> {
    fits.retain(|fit| fit.score.is_finite());
    fits.sort_by(|a, b| a.score.total_cmp(&b.score));
    let mut seen: BTreeMap<u64, usize> = BTreeMap::new();
    let mut ranked = Vec::new();
    for fit in fits {
        let count = seen.entry(fit.class).or_insert(0);
        if *count < FITS_PER_CLASS {
            #[expect(clippy::cast_precision_loss, reason = "at most FITS_PER_CLASS")]
            let handicap = 1.0 + REPEAT * *count as f64;
            ranked.push((fit.score * handicap, fit.start));
        }
        *count += 1;
    }
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    ranked.into_iter().map(|(_, start)| start).collect()
}

/// Shares of the length at which the ground under a line is highest nearby.
pub(super) fn summits(course: &Course<'_>, line: &Line) -> Vec<f64> {
    #[expect(clippy::cast_precision_loss, reason = "a few dozen")]
    let share = |k: usize| k as f64 / (PROFILE - 1) as f64;
    let heights: Vec<f64> = (0..PROFILE)
        .map(|k| course.world.ground.height_m(line.at(share(k))))
        .collect();
    (1..PROFILE - 1)
        .filter(|&k| heights[k] > heights[k - 1] && heights[k] >= heights[k + 1])
        .map(share)
        .collect()
}
