//! The speed of legs that are lines of a task.

use super::{MissionCheck, SPEED_MPS};
use crate::geodesy::EastNorth;
use crate::numeric::geometry::point_segment_distance;
use crate::tasks::lay_out;
use crate::verify::measure::segment::Segment;
use crate::verify::measure::worst::Worst;

/// A leg is on a line within this, metres, where it is longer than that many times.
const NEAR_M: f64 = 2.0;
const LONGER: f64 = 5.0;

/// A leg of a line, and the speed on it, m/s.
pub(super) struct SpeedOfLine {
    ends: (EastNorth, EastNorth),
    speed_mps: f64,
}

impl MissionCheck<'_> {
    /// The legs of lines of tasks that have a speed of their own and that the vehicle may do.
    pub(super) fn lines_with_speeds(&self) -> Vec<SpeedOfLine> {
        let tasks = self.spec.tasks.iter();
        let tasks = tasks.filter(|task| task.is_for(self.vehicle));
        let sweeps = tasks.filter_map(|task| task.sweep.as_ref());
        let mut all = Vec::new();
        for (sweep, speed_mps) in sweeps.filter_map(|sweep| Some((sweep, sweep.speed_mps?))) {
            for line in lay_out(sweep, self.world).lines {
                let legs = line.points.windows(2);
                all.extend(legs.map(|leg| SpeedOfLine {
                    ends: (leg[0], leg[1]),
                    speed_mps,
                }));
            }
        }
        all
    }

    /// Holds the speed of a cruise, by its index, against that of the lines that are flown with it; whether there are some.
    pub(super) fn offer_lines(
        &self,
        worst: &mut Worst,
        (index, speed_mps): (usize, f64),
        lines: &[SpeedOfLine],
    ) -> bool {
        if lines.is_empty() {
            return false;
        }
        let (cruises, segments) = (&self.flight.cruises, &self.flight.segments);
        let end = cruises
            .get(index + 1)
            .map_or(segments.len(), |next| next.segment);
        let flown = segments
            .get(cruises[index].segment..end)
            .unwrap_or_default();
        let mut is_on_line = false;
        for segment in flown {
            if let Some(planned_mps) = Self::speed_on_line(segment, lines) {
                is_on_line = true;
                let off_mps = (speed_mps - planned_mps).abs();
                worst.at_most(off_mps, SPEED_MPS, || {
                    segment.moment(&self.world.frame, 0.0)
                });
            }
        }
        is_on_line
    }

    /// The speed of the line that a leg is on, m/s.
    fn speed_on_line(segment: &Segment, lines: &[SpeedOfLine]) -> Option<f64> {
        let (from, to) = (segment.from.at, segment.to.at);
        if from.distance_m(to) < LONGER * NEAR_M {
            return None;
        }
        let quarters = [0.25, 0.75].map(|share| segment.at(share).at);
        let point = |at: EastNorth| [at.east_m, at.north_m];
        let is_on = |line: &&SpeedOfLine| {
            let (from, to) = line.ends;
            let away_m =
                |at: &EastNorth| point_segment_distance(point(*at), point(from), point(to));
            quarters.iter().all(|at| away_m(at) < NEAR_M)
        };
        lines.iter().find(is_on).map(|line| line.speed_mps)
    }
}
