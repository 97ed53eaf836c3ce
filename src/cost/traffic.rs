//! The flights of earlier vehicles, found by time and place.

use super::Margins;
use crate::numeric::approach::{
    Approach, Motion, closest_approach, closest_horizontal, least_ratio,
};
use crate::path::Flight;
use crate::spec::Separation;

/// Cells along time and each side of the plane, at most.
const MOST_CELLS: [usize; 3] = [128, 64, 64];

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
    grid: Grid,
    /// `motions` of cell `c` are `members[starts[c]..starts[c + 1]]`.
    starts: Vec<u32>,
    members: Vec<u32>,
}

/// A box of time (s), east and north (m) in equal cells; what lies beyond it
/// falls into the outermost cells.
#[derive(Clone, Copy, Debug)]
struct Grid {
    low: [f64; 3],
    per_unit: [f64; 3],
    cells: [usize; 3],
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

/// Extent in time (s), east and north (m).
pub(super) type Extent = [(f64, f64); 3];

impl Traffic {
    pub(super) fn new(separation: &Separation, margins: &Margins, earlier: &[Flight]) -> Self {
        let motions: Vec<Motion> = earlier
            .iter()
            .flat_map(|flight| flight.points.windows(2))
            .map(|pair| {
                let place = |i: usize| {
                    let point = pair[i].point;
                    [point.at.east_m, point.at.north_m, point.amsl.0]
                };
                Motion::between((pair[0].t_s, place(0)), (pair[1].t_s, place(1)))
            })
            .collect();
        let distance_m = separation.distance_m + margins.separation_m;
        let vertical_m = separation
            .vertical_m
            .map(|vertical_m| vertical_m + margins.separation_m);
        let mut traffic = Self {
            distance_m,
            vertical_m,
            reach_m: distance_m.hypot(vertical_m.unwrap_or(0.0)),
            slack_s: separation.time_slack_s,
            grid: Grid::over(&motions, separation),
            balls: motions.iter().map(Ball::around).collect(),
            motions,
            starts: Vec::new(),
            members: Vec::new(),
        };
        traffic.sort_into_cells();
        traffic
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
                .map(|other| self.severity_of(own, &ball, other))
                .fold(Severity::default(), Severity::worse)
        })
    }

    /// Whether no motion is near anything in a box of time, east and north.
    pub(super) fn is_clear(&self, extent: &Extent) -> bool {
        let [times, easts, norths] = self.grid.cells_of(extent);
        (times.0..=times.1).all(|time| {
            (easts.0..=easts.1).all(|east| {
                // Cells along north follow each other, so one look covers them.
                let first = self.grid.index([time, east, norths.0]);
                let last = self.grid.index([time, east, norths.1]);
                self.starts[first] == self.starts[last + 1]
            })
        })
    }

    fn severity(&self, own: &Motion) -> Severity {
        let cells = self.grid.cells_of(&extent(own, 0.0, 0.0));
        let ball = Ball::around(own);
        let mut worst = Severity::default();
        for time in cells[0].0..=cells[0].1 {
            for east in cells[1].0..=cells[1].1 {
                for north in cells[2].0..=cells[2].1 {
                    let cell = self.grid.index([time, east, north]);
                    let members = self.starts[cell] as usize..self.starts[cell + 1] as usize;
                    for &member in &self.members[members] {
                        worst = worst.worse(self.severity_of(own, &ball, member as usize));
                    }
                }
            }
        }
        worst
    }

    fn severity_of(&self, own: &Motion, ball: &Ball, other: usize) -> Severity {
        if ball.is_apart(&self.balls[other], self.reach_m) {
            return Severity::default();
        }
        let other = &self.motions[other];
        let near = match self.vertical_m {
            None => closest_approach(own, other, self.slack_s).map(|near| Approach {
                value: near.value / self.distance_m,
                ..near
            }),
            Some(vertical_m) => closest_horizontal(own, other, self.slack_s, vertical_m)
                .filter(|near| near.value < self.distance_m)
                .and_then(|_| least_ratio(own, other, self.slack_s, self.distance_m, vertical_m)),
        };
        near.filter(|near| near.value < 1.0)
            .map_or(Severity::default(), |near| Severity {
                value: 1.0 - near.value,
                t_s: near.t_s,
            })
    }

    /// Counting sort of the motions into every cell they may matter in.
    fn sort_into_cells(&mut self) {
        let reach: Vec<[(usize, usize); 3]> = self
            .motions
            .iter()
            .map(|motion| {
                self.grid
                    .cells_of(&extent(motion, self.slack_s, self.distance_m))
            })
            .collect();
        let each_cell = |reach: &[(usize, usize); 3], act: &mut dyn FnMut(usize)| {
            for time in reach[0].0..=reach[0].1 {
                for east in reach[1].0..=reach[1].1 {
                    for north in reach[2].0..=reach[2].1 {
                        act(self.grid.index([time, east, north]));
                    }
                }
            }
        };
        let mut starts = vec![0_u32; self.grid.cells.iter().product::<usize>() + 1];
        for reach in &reach {
            each_cell(reach, &mut |cell| starts[cell + 1] += 1);
        }
        for cell in 1..starts.len() {
            starts[cell] += starts[cell - 1];
        }
        let mut next = starts.clone();
        let mut members = vec![0_u32; starts.last().map_or(0, |end| *end as usize)];
        for (motion, reach) in (0_u32..).zip(&reach) {
            each_cell(reach, &mut |cell| {
                members[next[cell] as usize] = motion;
                next[cell] += 1;
            });
        }
        self.starts = starts;
        self.members = members;
    }
}

impl Grid {
    /// Cells of some five separations and slacks, or larger where that would be too many.
    fn over(motions: &[Motion], separation: &Separation) -> Self {
        let least = [
            4.0 * separation.time_slack_s.max(5.0),
            4.0 * separation.distance_m,
            4.0 * separation.distance_m,
        ];
        let mut all = [(f64::INFINITY, f64::NEG_INFINITY); 3];
        for motion in motions {
            for (all, (low, high)) in all.iter_mut().zip(extent(motion, 0.0, 0.0)) {
                all.0 = all.0.min(low);
                all.1 = all.1.max(if high.is_finite() { high } else { low });
            }
        }
        let mut grid = Self {
            low: [0.0; 3],
            per_unit: [0.0; 3],
            cells: [1; 3],
        };
        for axis in 0..3 {
            let width = all[axis].1 - all[axis].0;
            if width > 0.0 && least[axis] > 0.0 {
                #[expect(clippy::cast_precision_loss, reason = "few cells")]
                let most = MOST_CELLS[axis] as f64;
                let count = (width / least[axis]).ceil().clamp(1.0, most);
                grid.low[axis] = all[axis].0;
                grid.per_unit[axis] = count / width;
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "clamped to the most cells"
                )]
                let cells = count as usize;
                grid.cells[axis] = cells;
            }
        }
        grid
    }

    fn index(&self, [time, east, north]: [usize; 3]) -> usize {
        (time * self.cells[1] + east) * self.cells[2] + north
    }

    fn cells_of(&self, extent: &Extent) -> [(usize, usize); 3] {
        [0, 1, 2].map(|axis| {
            let last = self.cells[axis] - 1;
            // Not a number (nothing times infinity) and what is negative become 0.
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a cast saturates, then the cell is clamped"
            )]
            let cell = |at: f64| (((at - self.low[axis]) * self.per_unit[axis]) as usize).min(last);
            (cell(extent[axis].0), cell(extent[axis].1))
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
