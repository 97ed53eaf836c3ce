//! The flights of earlier vehicles, found by time and place.

use std::ops::{Deref, Range};
use std::sync::{Arc, OnceLock};

use super::Margins;
use crate::numeric::approach::{
    Approach, Segment, are_surely_apart, closest_approach, closest_horizontal, min_ratio,
};
use crate::numeric::cells::{Cells, Extent};
use crate::path::Flight;
use crate::spec::Separation;

/// The flights that a vehicle has to keep apart from. Their index is made once, for all
/// objectives that read them.
#[derive(Clone, Debug, Default)]
pub struct EarlierFlights {
    flights: Vec<Flight>,
    index: OnceLock<Arc<Index>>,
}

impl EarlierFlights {
    /// No flight.
    #[must_use]
    pub fn none() -> &'static Self {
        static NONE: EarlierFlights = EarlierFlights {
            flights: Vec::new(),
            index: OnceLock::new(),
        };
        &NONE
    }

    fn index(&self, separation: &Separation) -> Arc<Index> {
        let made = self
            .index
            .get_or_init(|| Arc::new(Index::new(separation, &self.flights)));
        Arc::clone(made)
    }
}

impl From<Vec<Flight>> for EarlierFlights {
    fn from(flights: Vec<Flight>) -> Self {
        Self {
            flights,
            index: OnceLock::new(),
        }
    }
}

impl Deref for EarlierFlights {
    type Target = [Flight];

    fn deref(&self) -> &[Flight] {
        &self.flights
    }
}

/// Earlier flights as one objective keeps apart from them.
#[derive(Clone, Debug)]
pub(super) struct Traffic {
    distance_m: f64,
    vertical_m: Option<f64>,
    slack_s: f64,
    index: Arc<Index>,
}

/// All motions of earlier flights, and which runs of them are in which cell of time, east and
/// north.
#[derive(Debug)]
struct Index {
    segments: Vec<Segment>,
    /// Balls around the motions.
    balls: Vec<Ball>,
    runs: Vec<Run>,
    cells: Cells,
}

/// Motions of one flight, one after the other: all of them are passed over at once.
#[derive(Clone, Debug)]
struct Run {
    ball: Ball,
    /// When it is flown, seconds.
    times_s: (f64, f64),
    segments: Range<usize>,
}

/// Most motions of a run.
const RUN: usize = 8;

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
    fn around(segment: &Segment) -> Self {
        let duration_s = segment.t1_s - segment.t0_s;
        let half_s = if duration_s.is_finite() {
            0.5 * duration_s
        } else {
            0.0
        };
        let speed_sq: f64 = segment.velocity_mps.iter().map(|v| v * v).sum();
        Self {
            center_m: segment.at(segment.t0_s + half_s),
            radius_m: speed_sq.sqrt() * half_s,
        }
    }

    /// A ball that holds all of some.
    fn over(balls: &[Self]) -> Self {
        let axis = |axis: usize| {
            let sides = balls.iter().map(|ball| ball.center_m[axis]);
            let (low, high) = sides.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| {
                (low.min(at), high.max(at))
            });
            0.5 * (low + high)
        };
        let center_m = [0, 1, 2].map(axis);
        let reach_m = |ball: &Self| {
            let square: f64 = (0..3)
                .map(|axis| (ball.center_m[axis] - center_m[axis]).powi(2))
                .sum();
            square.sqrt() + ball.radius_m
        };
        Self {
            center_m,
            radius_m: balls.iter().map(reach_m).fold(0.0, f64::max),
        }
    }

    /// Whether two balls are further apart than `reach_m`, by more than rounding.
    fn is_apart(&self, other: &Self, reach_m: f64) -> bool {
        let touch_m = self.radius_m + other.radius_m + reach_m + 1e-6;
        self.away_sq(other) > touch_m * touch_m
    }

    /// Whether two balls are further apart in the plane or in height than some distances, by more
    /// than rounding.
    fn is_beyond(&self, other: &Self, horizontal_m: f64, vertical_m: f64) -> bool {
        let touch_m = self.radius_m + other.radius_m + 1e-6;
        let [east_m, north_m, up_m] = self.gap_m(other);
        let reach_m = touch_m + horizontal_m;
        up_m.abs() > touch_m + vertical_m || east_m * east_m + north_m * north_m > reach_m * reach_m
    }

    /// Distance of the middles of two, squared.
    fn away_sq(&self, other: &Self) -> f64 {
        let [east_m, north_m, up_m] = self.gap_m(other);
        east_m * east_m + north_m * north_m + up_m * up_m
    }

    fn gap_m(&self, other: &Self) -> [f64; 3] {
        let side = |axis: usize| self.center_m[axis] - other.center_m[axis];
        [side(0), side(1), side(2)]
    }
}

/// The ratio of distance and limit that a motion must be below to be worse than a severity.
fn most(severity: f64) -> f64 {
    /// More than rounding may take from a ratio.
    const TOLERANCE: f64 = 1e-9;
    (1.0 - severity + TOLERANCE).min(1.0)
}

/// A few numbers of runs, as long as they are few.
#[derive(Default)]
struct Few {
    numbers: [usize; Self::MAX],
    count: usize,
}

impl Few {
    const MAX: usize = 16;

    fn push(&mut self, number: usize) {
        if let Some(place) = self.numbers.get_mut(self.count) {
            *place = number;
        }
        self.count += 1;
    }

    /// All of them; none where they were too many.
    fn all(&self) -> Option<&[usize]> {
        self.numbers.get(..self.count)
    }
}

/// Mean over a motion of a severity that is known at any part of it.
fn mean(own: &Segment, severity: impl Fn(&Segment) -> Severity) -> f64 {
    let worst = severity(own);
    let duration_s = own.t1_s - own.t0_s;
    if worst.value <= 0.0 || duration_s <= 0.0 || duration_s.is_infinite() {
        return worst.value;
    }
    let end = |t_s: f64| {
        let position = own.at(t_s);
        severity(&Segment::between((t_s, position), (t_s, position))).value
    };
    let share = ((worst.t_s - own.t0_s) / duration_s).clamp(0.0, 1.0);
    0.5 * (share * end(own.t0_s) + worst.value + (1.0 - share) * end(own.t1_s))
}

impl Traffic {
    pub(super) fn new(
        separation: &Separation,
        margins: &Margins,
        earlier: &EarlierFlights,
    ) -> Self {
        let Separation {
            distance_m,
            vertical_m,
            time_slack_s: slack_s,
        } = margins.beyond(separation);
        Self {
            distance_m,
            vertical_m,
            slack_s,
            index: earlier.index(separation),
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.index.segments.is_empty()
    }

    /// Mean severity along a motion: the trapezoidal rule over its ends and its
    /// worst moment, so 0 only for a motion that keeps the separation throughout.
    pub(super) fn mean_severity(&self, own: &Segment) -> f64 {
        mean(own, |own| self.severity(own))
    }

    /// The same by looking at every motion.
    pub(super) fn mean_severity_by_all(&self, own: &Segment) -> f64 {
        mean(own, |own| {
            let ball = Ball::around(own);
            (0..self.index.segments.len())
                .map(|other| self.severity_of(own, &ball, other, 0.0))
                .fold(Severity::default(), Severity::worse)
        })
    }

    /// Whether no motion is near anything in a box of time, east and north.
    pub(super) fn is_clear(&self, &[times, easts, norths]: &Extent) -> bool {
        let wider = |(low, high): (f64, f64), by: f64| (low - by, high + by);
        self.index.cells.is_clear(&[
            wider(times, self.slack_s),
            wider(easts, self.distance_m),
            wider(norths, self.distance_m),
        ])
    }

    /// The worst of all motions that are near. The run whose middle is nearest is looked at first:
    /// most of the others are then surely better, which their balls show.
    fn severity(&self, own: &Segment) -> Severity {
        let ball = Ball::around(own);
        let reach = extent(own, self.slack_s, self.distance_m);
        let mut nearest = (f64::INFINITY, usize::MAX);
        let mut met = Few::default();
        self.index.cells.each(&reach, |number| {
            let run = &self.index.runs[number];
            if self.is_at_another_time(own, run) || self.are_apart(&ball, &run.ball, 1.0) {
                return;
            }
            met.push(number);
            let away_sq = ball.away_sq(&run.ball);
            if away_sq < nearest.0 {
                nearest = (away_sq, number);
            }
        });
        let Some(first) = self.index.runs.get(nearest.1) else {
            return Severity::default();
        };
        let mut worst = self.worse_in(own, &ball, first, Severity::default());
        let mut see = |number: usize| {
            let run = &self.index.runs[number];
            let is_other = number != nearest.1 && !self.is_at_another_time(own, run);
            if is_other && !self.are_apart(&ball, &run.ball, most(worst.value)) {
                worst = self.worse_in(own, &ball, run, worst);
            }
        };
        match met.all() {
            Some(numbers) => numbers.iter().copied().for_each(see),
            None => self.index.cells.each(&reach, &mut see),
        }
        worst
    }

    /// Whether two balls are surely further apart than a share of the limits: in the plane or in
    /// height, as the greater of both ratios counts.
    fn are_apart(&self, a: &Ball, b: &Ball, share: f64) -> bool {
        let distance_m = share * self.distance_m;
        match self.vertical_m {
            None => a.is_apart(b, distance_m),
            Some(vertical_m) => a.is_beyond(b, distance_m, share * vertical_m),
        }
    }

    fn is_at_another_time(&self, own: &Segment, run: &Run) -> bool {
        let (from_s, to_s) = run.times_s;
        to_s + self.slack_s < own.t0_s || from_s - self.slack_s > own.t1_s
    }

    /// The worst of the motions of a run and of what is known.
    fn worse_in(&self, own: &Segment, ball: &Ball, run: &Run, worst: Severity) -> Severity {
        let others = run.segments.clone();
        others.fold(worst, |worst, other| {
            worst.worse(self.severity_of(own, ball, other, worst.value))
        })
    }

    /// The severity of one other motion; nothing, where it is surely below `worst`.
    fn severity_of(&self, own: &Segment, ball: &Ball, other: usize, worst: f64) -> Severity {
        let most = most(worst);
        if self.are_apart(ball, &self.index.balls[other], most) {
            return Severity::default();
        }
        let other = &self.index.segments[other];
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
                .and_then(|_| min_ratio(own, other, self.slack_s, self.distance_m, vertical_m)),
        };
        near.filter(|near| near.value < 1.0)
            .map_or(Severity::default(), |near| Severity {
                value: 1.0 - near.value,
                t_s: near.t_s,
            })
    }
}

impl Index {
    fn new(separation: &Separation, earlier: &[Flight]) -> Self {
        let segments: Vec<Segment> = earlier.iter().flat_map(Flight::segments).collect();
        let balls: Vec<Ball> = segments.iter().map(Ball::around).collect();
        let runs = runs(earlier, &segments, &balls);
        let extents: Vec<Extent> = runs
            .iter()
            .map(|run| {
                let segments = segments[run.segments.clone()].iter();
                let extents = segments.map(|segment| extent(segment, 0.0, 0.0));
                extents.reduce(both).unwrap_or_default()
            })
            .collect();
        let side_m = 4.0 * separation.distance_m;
        let least = [4.0 * separation.time_slack_s.max(5.0), side_m, side_m];
        Self {
            balls,
            runs,
            cells: Cells::new(&extents, least),
            segments,
        }
    }
}

/// The motions of each flight in runs.
fn runs(earlier: &[Flight], segments: &[Segment], balls: &[Ball]) -> Vec<Run> {
    let mut runs = Vec::new();
    let mut first = 0;
    for flight in earlier {
        let end = first + flight.segments().count();
        for start in (first..end).step_by(RUN) {
            let members = start..(start + RUN).min(end);
            let of_run = &segments[members.clone()];
            let from_s = of_run.iter().map(|segment| segment.t0_s);
            let to_s = of_run.iter().map(|segment| segment.t1_s);
            runs.push(Run {
                ball: Ball::over(&balls[members.clone()]),
                times_s: (
                    from_s.fold(f64::INFINITY, f64::min),
                    to_s.fold(f64::NEG_INFINITY, f64::max),
                ),
                segments: members,
            });
        }
        first = end;
    }
    runs
}

/// What holds both of two extents.
fn both(a: Extent, b: Extent) -> Extent {
    [0, 1, 2].map(|axis| (a[axis].0.min(b[axis].0), a[axis].1.max(b[axis].1)))
}

/// Extent of a motion, widened.
fn extent(segment: &Segment, slack_s: f64, distance_m: f64) -> Extent {
    let end_s = if segment.t1_s.is_finite() {
        segment.t1_s
    } else {
        segment.t0_s
    };
    let (from, to) = (segment.from_m, segment.at(end_s));
    let side = |axis: usize| {
        (
            from[axis].min(to[axis]) - distance_m,
            from[axis].max(to[axis]) + distance_m,
        )
    };
    [
        (segment.t0_s - slack_s, segment.t1_s + slack_s),
        side(0),
        side(1),
    ]
}
