//! The flights of earlier vehicles, found by time and place.

use super::Margins;
use crate::numeric::approach::{
    Approach, Motion, are_surely_apart, closest_approach, closest_horizontal, least_ratio,
};
use crate::numeric::cells::{Cells, Extent};
use crate::path::Flight;
use crate::spec::Separation;

/// All motions of earlier flights, and which of them may matter in which cell of
/// time, east and north.
#[derive(Clone, Debug)]
pub(super) struct Traffic {
    distance_m: f64,
    vertical_m: Option<f64>,
    slack_s: f64,
    /// Motions further apart than this are in no conflict, metres.
    reach_m: f64,
    motions: Vec<Motion>,
    /// Balls around the motions.
    balls: Vec<Ball>,
    /// Where the motions may matter.
    cells: Cells,
}

/// How badly the separation is broken: 1 less distance over limit at the worst
/// allowed shift, 0 where it is kept; and when.
#[derive(Clone, Copy, Debug, Default)]
struct Severity {
    value: f64,
    t_s: f64,
}

impl Severity {
    /// The worse of two; of equals the earlier, so that the order in which motions
    /// are looked at does not matter.
    fn worse(self, other: Self) -> Self {
        let is_worse =
            other.value > self.value || (other.value >= self.value && other.t_s < self.t_s);
        if is_worse { other } else { self }
    }
}

/// A ball that holds a motion.
#[derive(Clone, Copy, Debug)]
struct Ball {
    center_m: [f64; 3],
    radius_m: f64,
}

impl Ball {
    fn around(motion: &Motion) -> Self {
        let duration_s = motion.t1_s - motion.t0_s;
        let half_s = if duration_s.is_finite() {
            0.5 * duration_s
        } else {
            0.0
        };
        let speed_sq: f64 = motion.velocity_mps.iter().map(|v| v * v).sum();
        Self {
            center_m: motion.at(motion.t0_s + half_s),
            radius_m: speed_sq.sqrt() * half_s,
        }
    }

    /// Whether two balls are further apart than `reach_m`, by more than rounding.
    fn is_apart(&self, other: &Self, reach_m: f64) -> bool {
        let gap_sq: f64 = (0..3)
            .map(|axis| self.center_m[axis] - other.center_m[axis])
            .map(|gap| gap * gap)
            .sum();
        let touch_m = self.radius_m + other.radius_m + reach_m + 1e-6;
        gap_sq > touch_m * touch_m
    }
}

/// Mean over a motion of a severity that is known at any part of it.
fn mean(own: &Motion, severity: impl Fn(&Motion) -> Severity) -> f64 {
    let worst = severity(own);
    let duration_s = own.t1_s - own.t0_s;
    if worst.value <= 0.0 || duration_s <= 0.0 || duration_s.is_infinite() {
        return worst.value;
    }
    let end = |t_s: f64| {
        let place = own.at(t_s);
        severity(&Motion::between((t_s, place), (t_s, place))).value
    };
    let share = ((worst.t_s - own.t0_s) / duration_s).clamp(0.0, 1.0);
    0.5 * (share * end(own.t0_s) + worst.value + (1.0 - share) * end(own.t1_s))
}

impl Traffic {
    pub(super) fn new(separation: &Separation, margins: &Margins, earlier: &[Flight]) -> Self {
        let motions: Vec<Motion> = earlier.iter().flat_map(Flight::motions).collect();
        let Separation {
            distance_m,
            vertical_m,
            time_slack_s: slack_s,
        } = margins.beyond(separation);
        let reach: Vec<Extent> = motions
            .iter()
            .map(|motion| extent(motion, slack_s, distance_m))
            .collect();
        let least = [
            4.0 * slack_s.max(5.0),
            4.0 * separation.distance_m,
            4.0 * separation.distance_m,
        ];
        Self {
            distance_m,
            vertical_m,
            reach_m: distance_m.hypot(vertical_m.unwrap_or(0.0)),
            slack_s,
            balls: motions.iter().map(Ball::around).collect(),
            cells: Cells::new(&reach, least),
            motions,
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.motions.is_empty()
    }

    /// Mean severity along a motion: the trapezoidal rule over its ends and its
    /// worst moment, so 0 only for a motion that keeps the separation throughout.
    pub(super) fn mean_severity(&self, own: &Motion) -> f64 {
        mean(own, |own| self.severity(own))
    }

    /// The same by looking at every motion.
    pub(super) fn mean_severity_by_all(&self, own: &Motion) -> f64 {
        mean(own, |own| {
            let ball = Ball::around(own);
            (0..self.motions.len())
                .map(|other| self.severity_of(own, &ball, other, 0.0))
                .fold(Severity::default(), Severity::worse)
        })
    }

    /// Whether no motion is near anything in a box of time, east and north.
    pub(super) fn is_clear(&self, extent: &Extent) -> bool {
        self.cells.is_clear(extent)
    }

    fn severity(&self, own: &Motion) -> Severity {
        let ball = Ball::around(own);
        let mut worst = Severity::default();
        self.cells.each(&extent(own, 0.0, 0.0), |other| {
            worst = worst.worse(self.severity_of(own, &ball, other, worst.value));
        });
        worst
    }

    /// The severity of one other motion; nothing, where it is surely below `worst`.
    fn severity_of(&self, own: &Motion, ball: &Ball, other: usize, worst: f64) -> Severity {
        /// More than rounding may take from a ratio.
        const HAIR: f64 = 1e-9;
        let most = (1.0 - worst + HAIR).min(1.0);
        if ball.is_apart(&self.balls[other], most * self.reach_m) {
            return Severity::default();
        }
        let other = &self.motions[other];
        let distance_m = most * self.distance_m;
        let height_m = self.vertical_m.map_or(distance_m, |limit_m| most * limit_m);
        if are_surely_apart(own, other, self.slack_s, distance_m, height_m) {
            return Severity::default();
        }
        let near = match self.vertical_m {
            None => closest_approach(own, other, self.slack_s).map(|near| Approach {
                value: near.value / self.distance_m,
                ..near
            }),
            Some(vertical_m) => closest_horizontal(own, other, self.slack_s, most * vertical_m)
                .filter(|near| near.value < most * self.distance_m)
                .and_then(|_| least_ratio(own, other, self.slack_s, self.distance_m, vertical_m)),
        };
        near.filter(|near| near.value < 1.0)
            .map_or(Severity::default(), |near| Severity {
                value: 1.0 - near.value,
                t_s: near.t_s,
            })
    }
}

/// Extent of a motion, widened.
fn extent(motion: &Motion, slack_s: f64, distance_m: f64) -> Extent {
    let end_s = if motion.t1_s.is_finite() {
        motion.t1_s
    } else {
        motion.t0_s
    };
    let (from, to) = (motion.from_m, motion.at(end_s));
    let side = |axis: usize| {
        (
            from[axis].min(to[axis]) - distance_m,
            from[axis].max(to[axis]) + distance_m,
        )
    };
    [
        (motion.t0_s - slack_s, motion.t1_s + slack_s),
        side(0),
        side(1),
    ]
}
