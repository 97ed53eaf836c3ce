//! Seeds of the search: a spline for every homotopy class, drawn tight, with its control points
//! bunched in several ways, and detours around earlier flights.

use std::collections::BTreeMap;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::detour::{conflict_m, detour};
use super::fit::{Fitter, Line, Warp};
use super::problem::Horizontal;
use super::tighten::{FieldCost, Tightener};
use crate::geodesy::EastNorth;
use crate::optimize::{Evaluator, SearchSeed};
use crate::plan::classes::HomotopyClass;
use crate::plan::classes::routes::HomotopyClasses;
use crate::plan::route_context::RouteContext;
use crate::plan::spline::Frame;

/// Share of the warped fits with a control point at each of some extremes of the ground, where
/// that pays.
const ONE_EACH: f64 = 0.75;
/// Fits of one class that become seeds.
const FITS_PER_CLASS: usize = 3;
/// Handicap of each further seed of one class in the ranking: drawn tight, they are much alike.
const REPEAT: f64 = 0.15;
/// Handicap in the ranking of a fit that conflicts with earlier flights, against its detours.
const UNDETOURED: f64 = 0.04;
/// Unit of the steps from a seed, in distances between control points.
const STEP_UNIT: f64 = 0.3;
/// One part in this many of the budget is for fits.
const FIT_SHARE: usize = 20;
/// Classes with a conflict that get detours, the most promising ones.
const DETOURED_CLASSES: usize = 4;
/// Detours of one class.
const DETOURS: usize = 72;
/// Costs that differ by a smaller share are equal.
const TOLERANCE: f64 = 1e-9;
/// Nodes along a profile in which extremes are looked for.
const PROFILE: usize = 65;

/// The evaluator of fits.
type FitEvaluator<'a, 'b> = Evaluator<'a, Horizontal<'b>>;

/// Makes the seeds of one route.
#[derive(Clone, Copy)]
pub(crate) struct Seeder<'a> {
    pub context: &'a RouteContext<'a>,
    pub fitter: &'a Fitter,
    pub homotopy: &'a HomotopyClasses,
    /// Swarms to find seeds for.
    pub swarms: usize,
}

/// A fitted spline and how promising it is.
#[derive(Clone)]
struct Fit<'a> {
    class: &'a HomotopyClass,
    cost: f64,
    score: f64,
    seed: SearchSeed,
}

/// A line to fit, and the class that it belongs to.
#[derive(Clone)]
struct ClassLine<'a> {
    class: &'a HomotopyClass,
    line: Line,
}

impl<'a> ClassLine<'a> {
    fn of(class: &'a HomotopyClass) -> Self {
        Self {
            class,
            line: Line::new(class.line.clone()),
        }
    }
}

impl<'a> Seeder<'a> {
    /// Seeds, the most promising first; all evaluations are counted.
    ///
    /// Classes are ranked as if the vehicle were alone: letting others pass mostly costs little.
    /// `alone` evaluates without the earlier flights, `among` with them.
    pub(crate) fn seeds(
        &self,
        alone: &mut FitEvaluator<'_, '_>,
        among: Option<&mut FitEvaluator<'_, '_>>,
        rng: &mut ChaCha8Rng,
    ) -> Vec<SearchSeed> {
        let first = alone.spent();
        let classes = &self.homotopy.classes;
        let class_lines: Vec<ClassLine<'_>> = classes.iter().map(ClassLine::of).collect();
        let even: Vec<_> = class_lines
            .iter()
            .map(|line| (line, Warp::even()))
            .collect();
        let mut fits = self.evaluate(alone, &even);
        fits.extend(self.tightened(alone, &fits));
        let allowed = (alone.budget() / FIT_SHARE).saturating_sub(alone.spent() - first);
        let best = best_of_classes(&fits, 2 * self.swarms);
        // The first fits are those of the class lines.
        let lines: Vec<ClassLine<'_>> = best
            .iter()
            .map(|&index| match class_lines.get(index) {
                Some(line) => line.clone(),
                // A tightened fit may have left a gap for the wall next to it.
                None if self.homotopy.tight_m.is_some() => ClassLine::of(fits[index].class),
                None => self.line_of(&fits[index]),
            })
            .collect();
        let each = (allowed / best.len().max(1)).min(self.context.options.warps);
        fits.extend(self.evaluate(alone, &self.warped(&lines, each, rng)));
        fits.extend(self.tightened(alone, &leading(&fits)));
        if let Some(among) = among {
            self.give_way(among, (&lines, &best), &mut fits, rng);
        }
        rank(fits)
    }

    /// Each line with `each` warps.
    fn warped<'l>(
        &self,
        lines: &'l [ClassLine<'a>],
        each: usize,
        rng: &mut ChaCha8Rng,
    ) -> Vec<(&'l ClassLine<'a>, Warp)> {
        let peaks = self.fitter.peaks();
        let mut warped = Vec::new();
        for line in lines {
            let mut summits = summits(self.context, &line.line);
            if let Some(tight_m) = self.homotopy.tight_m {
                summits.extend(line.line.corners(tight_m));
            }
            let extremes = extremes(self.context, &line.line);
            let is_one_each = pays_at_extremes(extremes.len(), peaks.len());
            warped.extend((0..each).map(|_| {
                let warp = match is_one_each && rng.random_bool(ONE_EACH) {
                    true => Warp::at_extremes(peaks, &extremes, rng),
                    false => Warp::random(&summits, rng),
                };
                (line, warp)
            }));
        }
        warped
    }

    /// The line of a fit's spline.
    fn line_of(&self, fit: &Fit<'a>) -> ClassLine<'a> {
        let free: Vec<EastNorth> = self.context.frame().positions(&fit.seed.mean).collect();
        ClassLine {
            class: fit.class,
            line: Line::new(self.fitter.samples(self.context.ends_at(), &free)),
        }
    }

    /// Fits drawn tight, and evaluated in one batch.
    fn tightened(&self, evaluator: &mut FitEvaluator<'_, '_>, fits: &[Fit<'a>]) -> Vec<Fit<'a>> {
        let context = self.context;
        if self.homotopy.grounds.is_empty() || !context.options.tightening {
            return Vec::new();
        }
        let (frame, price) = (context.frame(), context.prices().threat);
        let tightener = Tightener::new(self.fitter, context.ends_at());
        let tightened = fits.par_iter().map(|fit| {
            let field_cost = FieldCost {
                ground: &self.homotopy.grounds[fit.class.field],
                threats: &context.world.threats,
                wider_m: context.margins.threat_m,
                price,
            };
            let free: Vec<EastNorth> = frame.positions(&fit.seed.mean).collect();
            let seed = SearchSeed {
                mean: frame.shares(tightener.tighten(&field_cost, &free)),
                ..fit.seed.clone()
            };
            (fit.class, seed)
        });
        evaluated(evaluator, tightened.collect())
    }

    /// Fits lines under warps and evaluates them in one batch.
    fn evaluate(
        &self,
        evaluator: &mut FitEvaluator<'_, '_>,
        lines: &[(&ClassLine<'a>, Warp)],
    ) -> Vec<Fit<'a>> {
        let frame = self.context.frame();
        let seeds = lines.par_iter().map(|(line, warp)| {
            let class = line.class;
            let seed = search_seed(&frame, self.fitter, &line.line, warp, class.signature);
            (class, seed)
        });
        evaluated(evaluator, seeds.collect())
    }

    /// Adds detours to the classes that conflict with earlier flights, around their lines and
    /// best fits. Of the fits of such a class only that one stays, as a class of its own: mostly
    /// a detour beats it, but it may yet pass before the others.
    fn give_way(
        &self,
        among: &mut FitEvaluator<'_, '_>,
        (lines, best): (&[ClassLine<'a>], &[usize]),
        fits: &mut Vec<Fit<'a>>,
        rng: &mut ChaCha8Rng,
    ) {
        let costs = among.evaluate(&rows(best.iter().map(|&index| &fits[index].seed)));
        let met: Vec<(usize, &ClassLine<'a>)> = best
            .iter()
            .zip(lines)
            .zip(costs)
            .filter(|&((&index, _), cost)| cost > fits[index].cost * (1.0 + TOLERANCE))
            .map(|((&index, line), _)| (index, line))
            .collect();
        let detoured = &met[..met.len().min(DETOURED_CLASSES)];
        let allowed = among.budget() / FIT_SHARE / detoured.len().max(1);
        let mut detours = Vec::new();
        for (_, line) in detoured {
            detours.extend(self.detours_of(line, allowed.min(DETOURS), rng));
        }
        let detours: Vec<_> = detours
            .iter()
            .map(|(line, warp)| (line, warp.clone()))
            .collect();
        let mut detours = self.evaluate(among, &detours);
        for &(index, _) in detoured {
            rank_as(&fits[index], &mut detours);
        }
        let classes: Vec<u64> = met
            .iter()
            .map(|&(index, _)| fits[index].seed.class)
            .collect();
        let mut index = 0;
        fits.retain(|fit| {
            index += 1;
            met.iter().any(|met| met.0 == index - 1) || !classes.contains(&fit.seed.class)
        });
        for fit in fits
            .iter_mut()
            .filter(|fit| classes.contains(&fit.seed.class))
        {
            fit.seed.class = fit.seed.class.wrapping_add(1);
            fit.score *= 1.0 + UNDETOURED;
        }
        fits.extend(detours);
    }

    /// Detours of one line, half of them with control points bunched as well.
    fn detours_of(
        &self,
        line: &ClassLine<'a>,
        count: usize,
        rng: &mut ChaCha8Rng,
    ) -> Vec<(ClassLine<'a>, Warp)> {
        let (context, class) = (self.context, line.class);
        let at_m = conflict_m(context, &line.line);
        (0..count)
            .map(|number| {
                let line = detour(context, &line.line, at_m, number % 2 == 0, rng);
                let warp = match context.options.warps > 0 && number % 4 > 1 {
                    true => Warp::random(&summits(context, &line), rng),
                    false => Warp::even(),
                };
                (ClassLine { class, line }, warp)
            })
            .collect()
    }
}

/// Seeds with what they cost, evaluated in one batch.
fn evaluated<'a>(
    evaluator: &mut FitEvaluator<'_, '_>,
    seeds: Vec<(&'a HomotopyClass, SearchSeed)>,
) -> Vec<Fit<'a>> {
    let costs = evaluator.evaluate(&rows(seeds.iter().map(|(_, seed)| seed)));
    let fits = seeds.into_iter().zip(costs);
    fits.map(|((class, seed), cost)| Fit {
        class,
        cost,
        score: 0.8 * cost + 0.2 * class.cost,
        seed,
    })
    .collect()
}

/// Seeds as rows of a batch.
fn rows<'s>(seeds: impl Iterator<Item = &'s SearchSeed>) -> Vec<f64> {
    seeds.flat_map(|seed| &seed.mean).copied().collect()
}

/// The best fits of each class, as many as may become seeds.
fn leading<'a>(fits: &[Fit<'a>]) -> Vec<Fit<'a>> {
    let mut order: Vec<&Fit<'a>> = fits.iter().filter(|fit| fit.score.is_finite()).collect();
    order.sort_by(|a, b| a.score.total_cmp(&b.score));
    let mut seen: BTreeMap<u64, usize> = BTreeMap::new();
    order.retain(|fit| {
        let count = seen.entry(fit.seed.class).or_insert(0);
        *count += 1;
        *count <= FITS_PER_CLASS
    });
    order.into_iter().cloned().collect()
}

/// Ranks the best of a class's detours as its way would rank alone, and the others behind it.
fn rank_as(alone: &Fit<'_>, detoured: &mut [Fit<'_>]) {
    let of_class = || {
        detoured
            .iter()
            .filter(|fit| fit.seed.class == alone.seed.class)
    };
    let least = of_class()
        .map(|fit| fit.score)
        .fold(f64::INFINITY, f64::min);
    for fit in detoured
        .iter_mut()
        .filter(|fit| fit.seed.class == alone.seed.class)
    {
        fit.score *= alone.score / least;
    }
}

/// The spline nearest to a line under a warp as a start.
pub(crate) fn search_seed(
    frame: &Frame,
    fitter: &Fitter,
    line: &Line,
    warp: &Warp,
    class: u64,
) -> SearchSeed {
    let mean = frame.shares(fitter.fit(line, warp));
    seed_at(frame, mean, line.length_m(), class)
}

/// A start at free control points, in shares of the frame, of a line so long.
pub(crate) fn seed_at(frame: &Frame, mean: Vec<f64>, length_m: f64, class: u64) -> SearchSeed {
    #[expect(clippy::cast_precision_loss, reason = "a number of control points")]
    let spacing_m = length_m / (mean.len() / 2 + 1) as f64;
    SearchSeed {
        scale: frame.scale(STEP_UNIT * spacing_m, mean.len()),
        mean,
        class,
    }
}

/// Indices of the best fit of each class, best class first.
fn best_of_classes(fits: &[Fit<'_>], most: usize) -> Vec<usize> {
    let mut best: BTreeMap<u64, usize> = BTreeMap::new();
    for (index, fit) in fits.iter().enumerate() {
        let entry = best.entry(fit.seed.class).or_insert(index);
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
fn rank(mut fits: Vec<Fit<'_>>) -> Vec<SearchSeed> {
    fits.retain(|fit| fit.score.is_finite());
    fits.sort_by(|a, b| a.score.total_cmp(&b.score));
    let mut seen: BTreeMap<u64, usize> = BTreeMap::new();
    let mut ranked = Vec::new();
    for fit in fits {
        let count = seen.entry(fit.seed.class).or_insert(0);
        if *count < FITS_PER_CLASS {
            #[expect(clippy::cast_precision_loss, reason = "at most FITS_PER_CLASS")]
            let handicap = 1.0 + REPEAT * *count as f64;
            ranked.push((fit.score * handicap, fit.seed));
        }
        *count += 1;
    }
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    ranked.into_iter().map(|(_, seed)| seed).collect()
}

/// Whether control points pay at extremes of the ground, one at each: where there are too few for
/// all, a path that tops and dips with the ground is found by no other way; where there are two
/// for each and more, the others fill the gaps. In between those few that are left over do harm,
/// and flat ground has none.
fn pays_at_extremes(extremes: usize, free: usize) -> bool {
    extremes >= free || (1..=free / 2).contains(&extremes)
}

/// Shares of the length at which the ground under a line is highest nearby.
pub(crate) fn summits(context: &RouteContext<'_>, line: &Line) -> Vec<f64> {
    let (shares, heights) = profile(context, line);
    (1..PROFILE - 1)
        .filter(|&k| heights[k] > heights[k - 1] && heights[k] >= heights[k + 1])
        .map(|k| shares[k])
        .collect()
}

/// Shares of the length at which the ground under a line is highest or lowest nearby, and how
/// high it is there.
fn extremes(context: &RouteContext<'_>, line: &Line) -> Vec<(f64, f64)> {
    let (shares, heights) = profile(context, line);
    (1..PROFILE - 1)
        .filter(|&k| (heights[k] > heights[k - 1]) == (heights[k] >= heights[k + 1]))
        .map(|k| (shares[k], heights[k]))
        .collect()
}

/// Shares of the length of a line, and the heights of the ground there.
fn profile(context: &RouteContext<'_>, line: &Line) -> (Vec<f64>, Vec<f64>) {
    #[expect(clippy::cast_precision_loss, reason = "a few dozen")]
    let share = |k: usize| k as f64 / (PROFILE - 1) as f64;
    let height_m = |share: &f64| context.world.ground.height_m(line.at(*share));
    let shares: Vec<f64> = (0..PROFILE).map(share).collect();
    let heights = shares.iter().map(height_m).collect();
    (shares, heights)
}
