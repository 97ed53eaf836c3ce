//! Where the sub-swarms of one course begin: a spline in every route class, drawn tight, with
//! its control points bunched in several ways.

use std::collections::BTreeMap;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::detour::{conflict_m, detour};
use super::fit::{Fitter, Line, Warp};
use super::problem::{Frame, Horizontal};
use super::route_context::Course;
use super::tighten::{Relaxed, Tightener};
use crate::geodesy::EastNorth;
use crate::optimize::{Evaluator, Start};
use crate::plan::classes::Guide;
use crate::plan::classes::routes::Routes;
use crate::spec::Part;

/// Warped fits of one class.
const WARPS: usize = 24;
/// Share of them with a control point at each of some extremes of the ground, where that pays.
const ONE_EACH: f64 = 0.75;
/// Fits of one class that become starts.
const FITS_PER_CLASS: usize = 3;
/// What each further start of one class costs in the ranking: drawn tight, they are much alike.
const REPEAT: f64 = 0.15;
/// What the fit of a class that meets earlier flights costs in the ranking, beside its detours.
const UNSWERVED: f64 = 0.04;
/// Unit of a start's steps, in distances between control points.
const STEP_UNIT: f64 = 0.3;
/// Share of the budget for fits.
const FIT_SHARE: usize = 20;
/// Classes that meet earlier flights and get detours, the most promising ones.
const SWERVING: usize = 4;
/// Detours of one class.
const DETOURS: usize = 72;
/// Costs that differ by a smaller share are the same.
const TOLERANCE: f64 = 1e-9;
/// Nodes along a profile in which extremes are looked for.
const PROFILE: usize = 65;

/// A fitted spline and how promising it is.
#[derive(Clone)]
struct Fit<'r> {
    guide: &'r Guide,
    class: u64,
    cost: f64,
    score: f64,
    start: Start,
}

/// A line to fit, and the guide that it stands for.
#[derive(Clone)]
struct Way<'r> {
    guide: &'r Guide,
    line: Line,
}

/// Starts, the most promising first. Evaluates fits on the way, all counted.
///
/// Classes are ranked as if the vehicle were alone: who meets others on a short way mostly
/// loses little by letting them pass. `alone` judges so, `among` with the earlier flights;
/// without `among` there is one judgement only.
pub(crate) fn starts(
    course: &Course<'_>,
    fitter: &Fitter,
    routes: &Routes,
    alone: &mut Evaluator<'_, Horizontal<'_>>,
    among: Option<&mut Evaluator<'_, Horizontal<'_>>>,
    swarms: usize,
    rng: &mut ChaCha8Rng,
) -> Vec<Start> {
    let planner = &course.spec.planner;
    let first = alone.spent();
    let guides: Vec<Way<'_>> = routes.guides.iter().map(Way::of).collect();
    let even: Vec<_> = guides.iter().map(|way| (way, Warp::even())).collect();
    let mut fits = evaluate(course, fitter, alone, &even);
    fits.extend(tightened(course, fitter, alone, routes, &fits));
    let allowed = (alone.budget() / FIT_SHARE).saturating_sub(alone.spent() - first);
    let best = best_of_classes(&fits, 2 * swarms);
    // The first fits are those of the guides.
    let ways: Vec<Way<'_>> = best
        .iter()
        .map(|&index| match guides.get(index) {
            Some(way) => way.clone(),
            // What is drawn tight may have left a gap for the wall beside it.
            None if routes.tight_m.is_some() => Way::of(fits[index].guide),
            None => fits[index].way(course, fitter),
        })
        .collect();
    let each = match planner.has(Part::Warps) {
        true => (allowed / best.len().max(1)).min(WARPS),
        false => 0,
    };
    let mut warped = Vec::new();
    for way in &ways {
        let mut summits = summits(course, &way.line);
        if let Some(tight_m) = routes.tight_m {
            summits.extend(way.line.corners(tight_m));
        }
        let extremes = extremes(course, &way.line);
        let is_one_each = pays_at_extremes(extremes.len(), fitter.peaks().len());
        warped.extend((0..each).map(|_| {
            let warp = match is_one_each && rng.random_bool(ONE_EACH) {
                true => Warp::at_extremes(fitter.peaks(), &extremes, rng),
                false => Warp::random(&summits, rng),
            };
            (way, warp)
        }));
    }
    fits.extend(evaluate(course, fitter, alone, &warped));
    let leading = leading(&fits);
    fits.extend(tightened(course, fitter, alone, routes, &leading));
    if let Some(among) = among {
        give_way(course, fitter, among, (&ways, &best), &mut fits, rng);
    }
    rank(fits)
}

impl<'r> Way<'r> {
    fn of(guide: &'r Guide) -> Self {
        Self {
            guide,
            line: Line::new(guide.line.clone()),
        }
    }
}

impl<'r> Fit<'r> {
    /// A spline and what it costs.
    fn new(guide: &'r Guide, start: Start, cost: f64) -> Self {
        Self {
            guide,
            class: guide.class,
            cost,
            score: 0.8 * cost + 0.2 * guide.cost,
            start,
        }
    }

    /// The way of its spline.
    fn way(&self, course: &Course<'_>, fitter: &Fitter) -> Way<'r> {
        let ends = (course.leg.from.at, course.leg.to.at);
        let free: Vec<EastNorth> = course.frame().places(&self.start.mean).collect();
        Way {
            guide: self.guide,
            line: Line::new(fitter.samples(ends, &free)),
        }
    }
}

/// The best fits of each class, as many as may become starts.
fn leading<'r>(fits: &[Fit<'r>]) -> Vec<Fit<'r>> {
    let mut order: Vec<&Fit<'r>> = fits.iter().filter(|fit| fit.score.is_finite()).collect();
    order.sort_by(|a, b| a.score.total_cmp(&b.score));
    let mut seen: BTreeMap<u64, usize> = BTreeMap::new();
    order.retain(|fit| {
        let count = seen.entry(fit.class).or_insert(0);
        *count += 1;
        *count <= FITS_PER_CLASS
    });
    order.into_iter().cloned().collect()
}

/// Fits drawn tight, and evaluated in one batch.
fn tightened<'r>(
    course: &Course<'_>,
    fitter: &Fitter,
    evaluator: &mut Evaluator<'_, Horizontal<'_>>,
    routes: &'r Routes,
    fits: &[Fit<'r>],
) -> Vec<Fit<'r>> {
    if routes.grounds.is_empty() || !course.spec.planner.has(Part::Tightening) {
        return Vec::new();
    }
    let (frame, price) = (course.frame(), course.prices().threat);
    let ends = (course.leg.from.at, course.leg.to.at);
    let tightener = Tightener::new(fitter, ends);
    let starts: Vec<Start> = fits
        .par_iter()
        .map(|fit| {
            let relaxed = Relaxed {
                ground: &routes.grounds[fit.guide.field],
                threats: &course.world.threats,
                wider_m: course.margins.threat_m,
                price,
            };
            let free: Vec<EastNorth> = frame.places(&fit.start.mean).collect();
            Start {
                mean: frame.shares(tightener.tighten(&relaxed, &free)),
                ..fit.start.clone()
            }
        })
        .collect();
    let costs = evaluator.evaluate(&rows(&starts));
    let guides = fits.iter().map(|fit| fit.guide);
    let fits = guides.zip(starts).zip(costs);
    fits.map(|((guide, start), cost)| Fit::new(guide, start, cost))
        .collect()
}

/// Starts as rows of a batch.
fn rows(starts: &[Start]) -> Vec<f64> {
    let means = starts.iter().flat_map(|start| &start.mean);
    means.copied().collect()
}

/// Adds detours to the classes that meet earlier flights, by their ways and best fits. Of what
/// was fitted to such a class only that fit stays, as a class beside it: mostly a detour beats
/// it, but it may yet pass before the others.
fn give_way<'r>(
    course: &Course<'_>,
    fitter: &Fitter,
    among: &mut Evaluator<'_, Horizontal<'_>>,
    (ways, best): (&[Way<'r>], &[usize]),
    fits: &mut Vec<Fit<'r>>,
    rng: &mut ChaCha8Rng,
) {
    let rows: Vec<f64> = best
        .iter()
        .flat_map(|&index| &fits[index].start.mean)
        .copied()
        .collect();
    let costs = among.evaluate(&rows);
    let met: Vec<(usize, &Way<'r>)> = best
        .iter()
        .zip(ways)
        .zip(costs)
        .filter(|&((&index, _), cost)| cost > fits[index].cost * (1.0 + TOLERANCE))
        .map(|((&index, way), _)| (index, way))
        .collect();
    let swerving = &met[..met.len().min(SWERVING)];
    let allowed = among.budget() / FIT_SHARE / swerving.len().max(1);
    let mut detours = Vec::new();
    for (_, way) in swerving {
        detours.extend(detours_of(course, way, allowed.min(DETOURS), rng));
    }
    let detours = detours.iter().map(|(way, warp)| (way, warp.clone()));
    let wanted: Vec<_> = detours.collect();
    let mut swerved = evaluate(course, fitter, among, &wanted);
    for &(index, _) in swerving {
        rank_as(&fits[index], &mut swerved);
    }
    let classes: Vec<u64> = met.iter().map(|&(index, _)| fits[index].class).collect();
    let kept: Vec<usize> = met.iter().map(|&(index, _)| index).collect();
    let mut index = 0;
    fits.retain(|fit| {
        index += 1;
        kept.contains(&(index - 1)) || !classes.contains(&fit.class)
    });
    for fit in fits.iter_mut().filter(|fit| classes.contains(&fit.class)) {
        fit.class = fit.class.wrapping_add(1);
        fit.start.class = fit.class;
        fit.score *= 1.0 + UNSWERVED;
    }
    fits.extend(swerved);
}

/// Detours of one way, half of them with control points bunched as well.
fn detours_of<'r>(
    course: &Course<'_>,
    way: &Way<'r>,
    count: usize,
    rng: &mut ChaCha8Rng,
) -> Vec<(Way<'r>, Warp)> {
    let at_m = conflict_m(course, &way.line);
    let has_warps = course.spec.planner.has(Part::Warps);
    (0..count)
        .map(|number| {
            let line = detour(course, &way.line, at_m, number % 2 == 0, rng);
            let warp = match has_warps && number % 4 > 1 {
                true => Warp::random(&summits(course, &line), rng),
                false => Warp::even(),
            };
            let guide = way.guide;
            (Way { guide, line }, warp)
        })
        .collect()
}

/// Ranks the best of a class's detours as its way would rank alone, and the others behind it.
fn rank_as(alone: &Fit<'_>, swerved: &mut [Fit<'_>]) {
    let of_class = || swerved.iter().filter(|fit| fit.class == alone.class);
    let least = of_class()
        .map(|fit| fit.score)
        .fold(f64::INFINITY, f64::min);
    for fit in swerved.iter_mut().filter(|fit| fit.class == alone.class) {
        fit.score *= alone.score / least;
    }
}

/// Fits ways under warps and evaluates them in one batch.
fn evaluate<'r>(
    course: &Course<'_>,
    fitter: &Fitter,
    evaluator: &mut Evaluator<'_, Horizontal<'_>>,
    wanted: &[(&Way<'r>, Warp)],
) -> Vec<Fit<'r>> {
    let frame = course.frame();
    let starts: Vec<Start> = wanted
        .par_iter()
        .map(|(way, warp)| start(&frame, fitter, &way.line, warp, way.guide.class))
        .collect();
    let costs = evaluator.evaluate(&rows(&starts));
    let guides = wanted.iter().map(|(way, _)| way.guide);
    let fits = guides.zip(starts).zip(costs);
    fits.map(|((guide, start), cost)| Fit::new(guide, start, cost))
        .collect()
}

/// The spline nearest to a line under a warp as a start.
pub(crate) fn start(frame: &Frame, fitter: &Fitter, line: &Line, warp: &Warp, class: u64) -> Start {
    let mean = frame.shares(fitter.fit(line, warp));
    #[expect(clippy::cast_precision_loss, reason = "a number of control points")]
    let spacing_m = line.length_m() / (mean.len() / 2 + 1) as f64;
    Start {
        scale: frame.scale(STEP_UNIT * spacing_m, mean.len()),
        mean,
        class,
    }
}

/// Indices of the best fit of each class, best class first.
fn best_of_classes(fits: &[Fit<'_>], most: usize) -> Vec<usize> {
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
fn rank(mut fits: Vec<Fit<'_>>) -> Vec<Start> {
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

/// Whether control points pay at extremes of the ground, one at each: where there are too few for
/// all, a path that tops and dips with the ground is found by no other way; where there are two
/// for each and more, the others fill the gaps. In between those few that are left over do harm,
/// and flat ground has none.
fn pays_at_extremes(extremes: usize, free: usize) -> bool {
    extremes >= free || (1..=free / 2).contains(&extremes)
}

/// Shares of the length at which the ground under a line is highest nearby.
pub(crate) fn summits(course: &Course<'_>, line: &Line) -> Vec<f64> {
    let (shares, heights) = profile(course, line);
    (1..PROFILE - 1)
        .filter(|&k| heights[k] > heights[k - 1] && heights[k] >= heights[k + 1])
        .map(|k| shares[k])
        .collect()
}

/// Shares of the length at which the ground under a line is highest or lowest nearby, and how
/// high it is there.
fn extremes(course: &Course<'_>, line: &Line) -> Vec<(f64, f64)> {
    let (shares, heights) = profile(course, line);
    (1..PROFILE - 1)
        .filter(|&k| (heights[k] > heights[k - 1]) == (heights[k] >= heights[k + 1]))
        .map(|k| (shares[k], heights[k]))
        .collect()
}

/// Shares of the length of a line, and the heights of the ground there.
fn profile(course: &Course<'_>, line: &Line) -> (Vec<f64>, Vec<f64>) {
    #[expect(clippy::cast_precision_loss, reason = "a few dozen")]
    let share = |k: usize| k as f64 / (PROFILE - 1) as f64;
    let height_m = |share: &f64| course.world.ground.height_m(line.at(*share));
    let shares: Vec<f64> = (0..PROFILE).map(share).collect();
    let heights = shares.iter().map(height_m).collect();
    (shares, heights)
}
