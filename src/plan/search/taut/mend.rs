//! A rounded line whose spline passes too near to a corner, or turns too tightly, mended there alone.
//!
//! Where corners are near to each other the control points of one turn pull at the next. A little more distance from
//! that corner, or a little wider a turn there, is enough, and costs less than wider turns everywhere.

use super::{MAX_CONTROLS, belt};
use crate::geodesy::EastNorth;
use crate::numeric::Basis;
use crate::plan::classes::taut_line::Bend;
use crate::plan::search::fit::Line;

/// Rounds of mending.
const ROUNDS: usize = 40;
/// Turns of the first round, and how much wider they become, times the least radius.
const FIRST: f64 = 1.05;
const WIDER: f64 = 1.04;
/// Moved further away than was missing by this share of it and at least so far, metres.
const MORE: f64 = 0.3;
const MIN_MORE_M: f64 = 0.02;
/// Turns are wider than need be by this share: samples lie otherwise where paths are judged.
const SPARE: f64 = 1.003;
/// Missing distances below this are none, metres.
const TOLERANCE_M: f64 = 0.01;
/// Distance of samples along the path, metres, and most of them.
const SAMPLE_M: f64 = 0.5;
const MAX_SAMPLES: f64 = 20_000.0;

/// A line, the same with more distance from corners where it needs it, and the radii of its turns.
#[derive(Clone)]
pub(super) struct Rounded {
    pub line: Vec<Bend>,
    pub tuned: Vec<Bend>,
    pub radii_m: Vec<f64>,
}

impl Rounded {
    /// With turns a little wider than a radius.
    pub(super) fn new(line: &[Bend], radius_m: f64) -> Self {
        Self {
            line: line.to_vec(),
            tuned: line.to_vec(),
            radii_m: vec![FIRST * radius_m; line.len()],
        }
    }

    /// Control points of its spline.
    pub(super) fn controls(&self, span_m: f64) -> Option<Vec<EastNorth>> {
        let free = belt::controls(&self.tuned, &self.radii_m, span_m)?;
        (free.len() <= MAX_CONTROLS).then_some(free)
    }

    /// Becomes a line whose spline keeps its distance from each corner and turns nowhere tighter than a radius, in the
    /// plane; its control points, or none where mending leads nowhere.
    pub(super) fn mend(&mut self, radius_m: f64, span_m: f64) -> Option<Vec<EastNorth>> {
        for _ in 0..ROUNDS {
            let free = self.controls(span_m)?;
            let path = sampled((self.line.first()?.at, self.line.last()?.at), &free);
            let too_near = move_away(&self.line, &mut self.tuned, &path);
            let too_tight = widen(&self.tuned, &mut self.radii_m, (&path, SPARE * radius_m));
            if !too_near && !too_tight {
                return Some(free);
            }
        }
        None
    }
}

/// Samples of the spline of some control points between two ends.
pub(super) fn sampled((first, last): (EastNorth, EastNorth), free: &[EastNorth]) -> Vec<EastNorth> {
    let all = [&[first], free, &[last]].concat();
    let length_m = Line::new(all.clone()).length_m();
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "limited to the range before"
    )]
    let samples = (length_m / SAMPLE_M).clamp(2001.0, MAX_SAMPLES) as usize;
    let basis = Basis::uniform(all.len(), samples);
    let of = |axis: fn(&EastNorth) -> f64| basis.sampled(&all.iter().map(axis).collect::<Vec<_>>());
    let (east, north) = (of(|at| at.east_m), of(|at| at.north_m));
    let at = |(east_m, north_m)| EastNorth { east_m, north_m };
    east.into_iter().zip(north).map(at).collect()
}

/// Asks for more distance from the corners that a path passes too near; whether there are any.
fn move_away(line: &[Bend], tuned: &mut [Bend], path: &[EastNorth]) -> bool {
    let mut any = false;
    for (bend, tuned) in line.iter().zip(tuned) {
        let (at, away_m) = bend.around;
        if away_m <= 0.0 {
            continue;
        }
        let nearest_m = path.iter().map(|point| point.distance_m(at));
        let missing_m = away_m - nearest_m.fold(f64::INFINITY, f64::min);
        if missing_m > TOLERANCE_M {
            tuned.around.1 += (MORE * missing_m).max(MIN_MORE_M) + missing_m;
            any = true;
        }
    }
    any
}

/// Widens the turns at which a path turns tighter than a radius; whether there are any.
fn widen(line: &[Bend], radii_m: &mut [f64], (path, min_m): (&[EastNorth], f64)) -> bool {
    let mut is_tight = vec![false; line.len()];
    for three in path.windows(3) {
        if radius_of(three) < min_m {
            let away_m = |bend: &Bend| (bend.around.0.distance_m(three[1]) - bend.around.1).abs();
            let away = line.iter().map(away_m).enumerate();
            if let Some((nearest, _)) = away.min_by(|a, b| a.1.total_cmp(&b.1)) {
                is_tight[nearest] = true;
            }
        }
    }
    // Bends around one circle are one turn.
    for index in 0..line.len() {
        let mut same = (0..line.len()).filter(|&other| line[other].around == line[index].around);
        if same.any(|other| is_tight[other]) {
            radii_m[index] *= WIDER;
        }
    }
    is_tight.contains(&true)
}

/// The radius of the turn at the middle one of three points, as the objective has it: by the shorter step, metres.
pub(super) fn radius_of(three: &[EastNorth]) -> f64 {
    let [a, b, c] = [0, 1, 2].map(|at| belt::vector(three[at]));
    let (into, out) = (b - a, c - b);
    into.norm().min(out.norm()) / belt::turn_rad(into, out).abs().max(1e-12)
}
