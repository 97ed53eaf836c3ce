//! Fits drawn tight over the relaxed problem.
//!
//! The least squares that lay a spline along a polyline know nothing of what lies beside it:
//! a fit of few control points cuts into threats and over ridges, and its cost says little of
//! its class. A few steps of descent on what the way costs in the field, with threats as exact
//! discs, bring it to where its class is cheap, without one evaluation of the objective. The
//! steps are preconditioned by the stiffness of the spline (a Sobolev gradient), so that more
//! control points do not need more of them.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::fit::Fitter;
use crate::geodesy::EastNorth;
use crate::numeric::as_f64;
use crate::plan::classes::field::Field;
use crate::world::Disc;

/// Steps of one fit.
const STEPS: usize = 40;
/// A step that gains less than this share is the last.
const GAIN: f64 = 1e-4;
/// Tries with ever shorter steps before a fit is as tight as it gets.
const TRIES: usize = 12;
/// How much shorter the next try is, and how much longer the step after one that gained.
const SHORTER: f64 = 0.4;
const LONGER: f64 = 2.0;
/// Longest step, in those that would straighten a way where all costs the same.
const LONGEST: f64 = 1.5;
/// No control point moves further in one step, in distances between control points.
const FURTHEST: f64 = 0.25;
/// Width of the ramp outside of a threat's rim, in cells of the field: what has no slope
/// would not be felt.
const RAMP_CELLS: f64 = 0.25;
/// Keeps the stiffness definite, as a share of its trace.
const RIDGE: f64 = 1e-6;

/// What a way costs in the plane, everywhere and with its slopes.
pub(crate) struct FieldCost<'a> {
    /// Without threats.
    pub ground: &'a Field,
    pub threats: &'a [Disc],
    /// Added to the radius of each, metres.
    pub wider_m: f64,
    /// Cost per kilometre at the axis of a threat, and how much less at its rim.
    pub price: (f64, f64),
}

/// A cost per kilometre, and its slopes to the east and to the north, per metre.
#[derive(Clone, Copy)]
struct Sloped {
    cost: f64,
    east: f64,
    north: f64,
}

impl FieldCost<'_> {
    fn at(&self, at: EastNorth) -> Sloped {
        let mut sum = sloped(self.ground, at);
        let ramp_m = RAMP_CELLS * self.ground.grid.spacing_m;
        let (axis, fall) = self.price;
        for threat in self.threats {
            let radius_m = threat.radius_m + self.wider_m;
            if at.is_beyond(threat.center, radius_m + ramp_m) {
                continue;
            }
            let away_m = at.distance_m(threat.center);
            let (cost, slope) = if away_m < radius_m {
                (axis - fall * away_m / radius_m, -fall / radius_m)
            } else if away_m < radius_m + ramp_m {
                let share = (away_m - radius_m) / ramp_m;
                ((axis - fall) * (1.0 - share), -(axis - fall) / ramp_m)
            } else {
                continue;
            };
            let scale = slope / away_m.max(1e-6);
            sum = Sloped {
                cost: sum.cost + cost,
                east: sum.east + scale * (at.east_m - threat.center.east_m),
                north: sum.north + scale * (at.north_m - threat.center.north_m),
            };
        }
        sum
    }
}

/// Bilinear between the nodes of a field; outside of it as at its edge.
fn sloped(field: &Field, at: EastNorth) -> Sloped {
    let grid = &field.grid;
    let cell = |offset_m: f64, count: usize| {
        #[expect(clippy::cast_precision_loss, reason = "hundreds of nodes")]
        let at = (offset_m / grid.spacing_m).clamp(0.0, (count - 1) as f64);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to the grid"
        )]
        let low = (at as usize).min(count.saturating_sub(2));
        #[expect(clippy::cast_precision_loss, reason = "hundreds of nodes")]
        let part = at - low as f64;
        (low, part)
    };
    let (column, x) = cell(at.east_m - grid.south_west.east_m, grid.columns);
    let (row, y) = cell(at.north_m - grid.south_west.north_m, grid.rows);
    let cost = |right: usize, up: usize| field.cost[(row + up) * grid.columns + column + right];
    let mix = |a: f64, b: f64, part: f64| a + (b - a) * part;
    let (south, north) = (
        mix(cost(0, 0), cost(1, 0), x),
        mix(cost(0, 1), cost(1, 1), x),
    );
    let (west, east) = (
        mix(cost(0, 0), cost(0, 1), y),
        mix(cost(1, 0), cost(1, 1), y),
    );
    Sloped {
        cost: mix(south, north, y),
        east: (east - west) / grid.spacing_m,
        north: (north - south) / grid.spacing_m,
    }
}

/// Draws splines of one parametrisation tight.
pub(crate) struct Tightener<'a> {
    fitter: &'a Fitter,
    ends: (EastNorth, EastNorth),
    stiffness: Option<Cholesky<f64, Dyn>>,
}

/// Free control points, samples of their spline, and what it costs.
struct Fit {
    free: Vec<EastNorth>,
    samples: Vec<EastNorth>,
    costs: Vec<Sloped>,
    /// In metres times the price of a kilometre.
    total: f64,
}

/// A piece of a way between two samples.
struct Piece {
    /// Index of the first of them.
    first: usize,
    length_m: f64,
    /// Its direction.
    unit: (f64, f64),
}

impl<'a> Tightener<'a> {
    /// For the splines of a fitter between two ends.
    pub(crate) fn new(fitter: &'a Fitter, ends: (EastNorth, EastNorth)) -> Self {
        let (rows, controls) = (fitter.rows(), fitter.controls());
        let free = controls - 2;
        let mut stiffness = DMatrix::zeros(free, free);
        for pair in rows.windows(2) {
            let mut steps = DVector::zeros(controls);
            for (sign, (first, weights)) in [(-1.0, pair[0]), (1.0, pair[1])] {
                for (i, weight) in weights.iter().enumerate() {
                    steps[first + i] += sign * weight;
                }
            }
            let steps = steps.rows(1, free);
            stiffness.ger(1.0, &steps, &steps, 1.0);
        }
        let ridge: f64 = RIDGE * stiffness.trace();
        stiffness += DMatrix::identity(free, free) * ridge;
        Self {
            fitter,
            ends,
            stiffness: stiffness.cholesky(),
        }
    }

    /// The free control points after the descent from those of a fit: they cost no more.
    pub(crate) fn tighten(&self, field_cost: &FieldCost<'_>, free: &[EastNorth]) -> Vec<EastNorth> {
        let mut here = self.fit(field_cost, free.to_vec());
        let mut reach = 1.0;
        for _ in 0..STEPS {
            let Some(there) = self.step(field_cost, &here, &mut reach) else {
                break;
            };
            let is_last = here.total - there.total < GAIN * here.total;
            here = there;
            if is_last {
                break;
            }
        }
        here.free
    }

    /// A way that costs less, one step further down; `None` if there is none near.
    fn step(&self, field_cost: &FieldCost<'_>, here: &Fit, reach: &mut f64) -> Option<Fit> {
        let stiffness = self.stiffness.as_ref()?;
        let (east, north) = self.slopes(here);
        let (east, north) = (stiffness.solve(&east), stiffness.solve(&north));
        let length_m: f64 = here.pieces().map(|piece| piece.length_m).sum();
        // The second derivative of an even way's length is the stiffness over a piece's length.
        let unit = length_m / as_f64(here.samples.len() - 1) / (here.total / length_m).max(1e-12);
        let furthest = east
            .iter()
            .zip(north.iter())
            .map(|(east, north)| unit * east.hypot(*north))
            .fold(1e-9, f64::max);
        *reach = reach.min(FURTHEST * length_m / as_f64(self.fitter.controls()) / furthest);
        for _ in 0..TRIES {
            let share = *reach * unit;
            let moves = east.iter().zip(north.iter());
            let free = here
                .free
                .iter()
                .zip(moves)
                .map(|(at, (east, north))| EastNorth {
                    east_m: at.east_m - share * east,
                    north_m: at.north_m - share * north,
                });
            let there = self.fit(field_cost, free.collect());
            if there.total < here.total {
                *reach = (LONGER * *reach).min(LONGEST);
                return Some(there);
            }
            *reach *= SHORTER;
        }
        None
    }

    /// Samples a spline and what it costs.
    fn fit(&self, field_cost: &FieldCost<'_>, free: Vec<EastNorth>) -> Fit {
        let samples = self.fitter.samples(self.ends, &free);
        let costs = samples.iter().map(|&at| field_cost.at(at)).collect();
        let mut fit = Fit {
            free,
            samples,
            costs,
            total: 0.0,
        };
        fit.total = fit
            .pieces()
            .map(|piece| fit.mean(&piece) * piece.length_m)
            .sum();
        fit
    }

    /// Slopes of a way's cost with its free control points, to the east and to the north.
    fn slopes(&self, fit: &Fit) -> (DVector<f64>, DVector<f64>) {
        let mut by_sample = vec![(0.0, 0.0); fit.costs.len()];
        for piece in fit.pieces() {
            let mean = fit.mean(&piece);
            for (sign, k) in [(-1.0, piece.first), (1.0, piece.first + 1)] {
                let cost = &fit.costs[k];
                by_sample[k].0 += 0.5 * piece.length_m * cost.east + sign * mean * piece.unit.0;
                by_sample[k].1 += 0.5 * piece.length_m * cost.north + sign * mean * piece.unit.1;
            }
        }
        let free = fit.free.len();
        let (mut east, mut north) = (DVector::zeros(free), DVector::zeros(free));
        for ((first, weights), slope) in self.fitter.rows().iter().zip(&by_sample) {
            for (i, weight) in weights.iter().enumerate() {
                if (1..=free).contains(&(first + i)) {
                    east[first + i - 1] += weight * slope.0;
                    north[first + i - 1] += weight * slope.1;
                }
            }
        }
        (east, north)
    }
}

impl Fit {
    fn pieces(&self) -> impl Iterator<Item = Piece> + '_ {
        self.samples.windows(2).enumerate().map(|(first, pair)| {
            let length_m = pair[0].distance_m(pair[1]);
            let scale = 1.0 / length_m.max(1e-9);
            Piece {
                first,
                length_m,
                unit: (
                    scale * (pair[1].east_m - pair[0].east_m),
                    scale * (pair[1].north_m - pair[0].north_m),
                ),
            }
        })
    }

    /// Mean cost of a piece per kilometre.
    fn mean(&self, piece: &Piece) -> f64 {
        0.5 * (self.costs[piece.first].cost + self.costs[piece.first + 1].cost)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::Basis;
    use crate::numeric::bspline::uniform_parameters;
    use crate::plan::classes::grid::Grid;

    const CONTROLS: usize = 10;

    fn at(east_m: f64, north_m: f64) -> EastNorth {
        EastNorth { east_m, north_m }
    }

    fn fitter() -> Fitter {
        let parameters = uniform_parameters(101);
        let basis = Basis::new(CONTROLS, &parameters);
        let rows = (0..basis.samples()).map(|k| basis.row(k)).collect();
        Fitter::new(rows, parameters, CONTROLS)
    }

    fn flat() -> Field {
        let grid = Grid::over(at(0.0, 0.0), at(20_000.0, 20_000.0), 41);
        Field {
            cost: vec![1.0; grid.len()],
            grid,
            rises: None,
            climbs: None,
        }
    }

    /// Free control points along a line that swings out.
    fn swung(by_m: f64) -> Vec<EastNorth> {
        (1..=8)
            .map(|j| {
                let share = f64::from(j) / 9.0;
                at(
                    1000.0 + 18_000.0 * share,
                    10_000.0 + by_m * (share * std::f64::consts::PI).sin(),
                )
            })
            .collect()
    }

    fn tightened(ground: &Field, threats: &[Disc], by_m: f64) -> (Vec<EastNorth>, f64, f64) {
        let fitter = fitter();
        let ends = (at(1000.0, 10_000.0), at(19_000.0, 10_000.0));
        let tightener = Tightener::new(&fitter, ends);
        let field_cost = FieldCost {
            ground,
            threats,
            wider_m: 0.0,
            price: (110.0, 100.0),
        };
        let before = tightener.fit(&field_cost, swung(by_m));
        let tight = tightener.tighten(&field_cost, &swung(by_m));
        let after = tightener.fit(&field_cost, tight);
        (after.samples, before.total, after.total)
    }

    #[test]
    fn in_an_even_field_a_bend_is_drawn_straight() {
        let (_, before, after) = tightened(&flat(), &[], 4000.0);
        assert!(before > 19_500.0, "{before}");
        assert!(after < 18_002.0, "{after}");
    }

    #[test]
    fn a_fit_that_cuts_into_a_threat_is_drawn_around_it() {
        let threats = [Disc {
            center: at(10_000.0, 9000.0),
            radius_m: 3000.0,
        }];
        let (samples, before, after) = tightened(&flat(), &threats, 600.0);
        assert!(after < 0.15 * before, "{before} {after}");
        for sample in samples {
            assert!(sample.distance_m(threats[0].center) > 2990.0);
        }
    }

    #[test]
    fn a_fit_over_a_ridge_is_drawn_to_its_gap() {
        let mut ground = flat();
        for node in 0..ground.grid.len() {
            let position = ground.grid.at(node);
            let is_ridge = (position.east_m - 10_000.0).abs() < 1500.0;
            let gap = (position.north_m - 13_000.0).abs() / 1000.0;
            if is_ridge {
                ground.cost[node] += gap.min(8.0);
            }
        }
        let (samples, before, after) = tightened(&ground, &[], 0.0);
        assert!(after < 0.9 * before, "{before} {after}");
        assert!(samples[50].north_m > 12_000.0, "{}", samples[50].north_m);
    }
}
