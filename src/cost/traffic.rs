//! The flights of earlier vehicles, found by time and place.

use std::ops::{Deref, Range};
use std::sync::{Arc, OnceLock};

use super::Margins;
use crate::numeric::approach::{
    Approach, Segment, Whole, closest_approach, closest_horizontal, least_ratio, may_be_near,
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
    runs: Vec<Run>,
    cells: Cells,
}

/// Motions of one flight, one after the other: all of them are passed over at once.
#[derive(Clone, Debug)]
struct Run {
    whole: Whole,
    segments: Range<usize>,
}

/// Most motions of a run.
const RUN: usize = 8;

/// How badly the separation is broken: 1 less distance over limit at the worst
/// allowed shift, 0 where it is kept; when, and the number of the other motion.
#[derive(Clone, Copy, Debug, Default)]
struct Severity {
    value: f64,
    t_s: f64,
    by: Option<usize>,
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

/// Mean over a motion of a severity that is known at any part of it.
fn mean(own: &Segment, mut severity: impl FnMut(&Segment) -> Severity) -> f64 {
    let worst = severity(own);
    let duration_s = own.t1_s - own.t0_s;
    if worst.value <= 0.0 || duration_s <= 0.0 || duration_s.is_infinite() {
        return worst.value;
    }
    let mut end = |t_s: f64| {
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
    ///
    /// `last` is the other motion that was worst before: mostly the next worst is near to it, and
    /// once that is known, few others need a closer look.
    pub(super) fn mean_severity(&self, own: &Segment, last: &mut Option<usize>) -> f64 {
        mean(own, |own| {
            let worst = self.severity(own, *last);
            *last = worst.by.or(*last);
            worst
        })
    }

    /// The same by looking at every motion.
    pub(super) fn mean_severity_by_all(&self, own: &Segment) -> f64 {
        mean(own, |own| {
            (0..self.index.segments.len())
                .map(|other| self.severity_of(own, other, 0.0))
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

    fn severity(&self, own: &Segment, first: Option<usize>) -> Severity {
        let mut worst =
            first.map_or_else(Severity::default, |first| self.severity_of(own, first, 0.0));
        let whole = Whole::of(own);
        let reach = extent(own, self.slack_s, self.distance_m);
        self.index.cells.each(&reach, |run| {
            let run = &self.index.runs[run];
            let within = self.within(worst.value);
            if run.whole.may_be_near(&whole, self.slack_s, within) {
                for other in run.segments.clone() {
                    worst = worst.worse(self.severity_of(own, other, worst.value));
                }
            }
        });
        worst
    }

    /// Distances in the plane and in height, metres, within which a severity may be above `worst`.
    fn within(&self, worst: f64) -> (f64, f64) {
        /// More than rounding may take from a ratio.
        const TOLERANCE: f64 = 1e-9;
        let most = (1.0 - worst + TOLERANCE).min(1.0);
        let distance_m = most * self.distance_m;
        let height_m = self.vertical_m.map_or(distance_m, |limit_m| most * limit_m);
        (distance_m, height_m)
    }

    /// The severity of one other motion; nothing, where it is surely below `worst`.
    fn severity_of(&self, own: &Segment, other: usize, worst: f64) -> Severity {
        let by = other;
        let other = &self.index.segments[other];
        let (distance_m, height_m) = self.within(worst);
        if !may_be_near(own, other, self.slack_s, distance_m, height_m) {
            return Severity::default();
        }
        let near = match self.vertical_m {
            None => closest_approach(own, other, self.slack_s).map(|near| Approach {
                value: near.value / self.distance_m,
                ..near
            }),
            Some(vertical_m) => closest_horizontal(own, other, self.slack_s, height_m)
                .filter(|near| near.value < distance_m)
                .and_then(|_| least_ratio(own, other, self.slack_s, self.distance_m, vertical_m)),
        };
        near.filter(|near| near.value < 1.0)
            .map_or(Severity::default(), |near| Severity {
                value: 1.0 - near.value,
                t_s: near.t_s,
                by: Some(by),
            })
    }
}

impl Index {
    fn new(separation: &Separation, earlier: &[Flight]) -> Self {
        let segments: Vec<Segment> = earlier.iter().flat_map(Flight::segments).collect();
        let runs = runs(earlier, &segments);
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
            runs,
            cells: Cells::new(&extents, least),
            segments,
        }
    }
}

/// The motions of each flight in runs.
fn runs(earlier: &[Flight], segments: &[Segment]) -> Vec<Run> {
    let mut runs = Vec::new();
    let mut first = 0;
    for flight in earlier {
        let end = first + flight.points.len().saturating_sub(1);
        for start in (first..end).step_by(RUN) {
            let members = start..(start + RUN).min(end);
            runs.push(Run {
                whole: Whole::over(&segments[members.clone()]),
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
