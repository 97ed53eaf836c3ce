//! Where and when a flight is in the heights and times at which a zone is closed.

use std::collections::HashMap;

use crate::geodesy::PlanPoint;
use crate::spec::{Placement, Span, Zone};
use crate::verify::execute::flight::{End, Flight};
use crate::verify::measure::patch::Patch;
use crate::verify::measure::segment::{Segment, Stretch};
use crate::verify::measure::surface::Surface;
use crate::world::floor_over;

/// When a flight may be on which of its segments.
pub(crate) struct Times<'a> {
    flight: &'a Flight,
    /// By row of the items: from when to when what is flown there lasts, as late and as early as it may be.
    rows: HashMap<usize, Lasts>,
    /// The end of the last motion, where the vehicle stays in the air for ever.
    stays_s: Option<f64>,
}

/// From when to when, and by how much later or earlier that may be, seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Lasts {
    from_s: f64,
    to_s: f64,
    late_s: f64,
    early_s: f64,
}

impl Lasts {
    fn of(segment: &Segment) -> Self {
        Self {
            from_s: segment.from_s,
            to_s: segment.to_s,
            late_s: segment.late_s,
            early_s: segment.early_s,
        }
    }

    fn and(self, other: Self) -> Self {
        Self {
            from_s: self.from_s.min(other.from_s),
            to_s: self.to_s.max(other.to_s),
            late_s: self.late_s.max(other.late_s),
            early_s: self.early_s.max(other.early_s),
        }
    }
}

impl<'a> Times<'a> {
    pub(crate) fn of(flight: &'a Flight) -> Self {
        let flown = || flight.segments.iter().filter(|segment| segment.flown);
        let last_s = flown().map(|segment| segment.to_s).reduce(f64::max);
        let stays = matches!(flight.end, Some(End::Stays(_)));
        let mut times = Self {
            flight,
            rows: HashMap::new(),
            stays_s: last_s.filter(|_| stays),
        };
        for segment in flown() {
            let lasts = times.lasts(segment);
            let row = times.rows.entry(segment.row).or_insert(lasts);
            *row = row.and(lasts);
        }
        times
    }

    /// From when to when a segment is flown. What is judged in space has no lateness of its own, and some of it no
    /// times: it stands for what is flown at any time on the way to its item.
    fn lasts(&self, segment: &Segment) -> Lasts {
        let own = Lasts::of(segment);
        if segment.flown {
            return match self.is_for_ever(segment) {
                true => Lasts {
                    to_s: f64::INFINITY,
                    ..own
                },
                false => own,
            };
        }
        let Some(row) = self.rows.get(&segment.row) else {
            return own;
        };
        match segment.to_s > segment.from_s {
            true => Lasts {
                from_s: own.from_s,
                to_s: own.to_s,
                ..own.and(*row)
            },
            false => own.and(*row),
        }
    }

    /// Whether the vehicle stays there for ever, or comes there again and again on its last circle.
    fn is_for_ever(&self, segment: &Segment) -> bool {
        /// The circle of a wing is this much wider in places, as a share of its radius.
        const WIDER: f64 = 0.05;
        if self.stays_s == Some(segment.to_s) {
            return true;
        }
        let circle = self.flight.circle.as_ref();
        let Some(stay) = circle.and_then(|of| self.flight.segments.get(of.segment)) else {
            return false;
        };
        let reach_m = (1.0 + WIDER) * stay.error_m;
        let is_on = |at: PlanPoint| at.at.distance_m(stay.from.at) <= reach_m;
        segment.row == stay.row && is_on(segment.from) && is_on(segment.to)
    }
}

/// Heights and times of a zone over the ground.
pub(crate) struct Closed<'a> {
    zone: &'a Zone,
    /// Its floor over the terrain of the surface.
    floor: Option<Placement>,
    surface: &'a Surface<'a>,
    times: &'a Times<'a>,
    shift_s: Span,
    /// Closed by so much more above and below, metres.
    buffer_m: f64,
}

/// Fractions of a stretch, from and to.
type Part = (f64, f64);

impl<'a> Closed<'a> {
    /// Of a zone; the flight may be shifted in time by `shift_s`.
    pub(crate) fn new(
        zone: &'a Zone,
        surface: &'a Surface<'a>,
        (times, shift_s): (&'a Times<'a>, Span),
    ) -> Self {
        Self {
            zone,
            floor: floor_over(zone, surface.terrain()),
            surface,
            times,
            shift_s,
            buffer_m: 0.0,
        }
    }

    /// The same with a buffer above and below the zone, metres.
    pub(crate) fn widened(self, buffer_m: f64) -> Self {
        Self { buffer_m, ..self }
    }

    /// The parts of a stretch at whose heights and times the zone is closed.
    pub(crate) fn parts(&self, segment: &Segment, part: &Stretch) -> Vec<Stretch> {
        if self.zone.is_closed_throughout() {
            return vec![*part];
        }
        let Some(active) = self.active(segment, part) else {
            return Vec::new();
        };
        let heights = match (self.zone.floor, self.zone.ceiling) {
            (Some(Placement::Agl(_)), _) | (_, Some(Placement::Agl(_))) => {
                self.over_ground(segment, part)
            }
            _ => self
                .between(segment, part, (0.0, 1.0), &Level::SEA)
                .into_iter()
                .collect(),
        };
        let common = |(from, to): Part| (from.max(active.0), to.min(active.1));
        let parts = heights.into_iter().map(common);
        parts
            .filter(|(from, to)| from <= to)
            .map(|(from, to)| Stretch {
                u: (part.along(from), part.along(to)),
                from: part.place(from),
                to: part.place(to),
            })
            .collect()
    }

    /// The part that is flown while the zone is active, if any.
    fn active(&self, segment: &Segment, part: &Stretch) -> Option<Part> {
        let Some((from_s, to_s)) = self.zone.active_s else {
            return Some((0.0, 1.0));
        };
        let lasts = self.times.lasts(segment);
        let takes_s = lasts.to_s - lasts.from_s;
        let from_s = from_s - self.shift_s.most - lasts.late_s;
        let to_s = to_s - self.shift_s.least + lasts.early_s;
        if takes_s.is_infinite() || (lasts.from_s, lasts.to_s) != (segment.from_s, segment.to_s) {
            // It may be anywhere on it all the time.
            return (lasts.from_s <= to_s && lasts.to_s >= from_s).then_some((0.0, 1.0));
        }
        // What is not flown stands for what is flown somewhere in its time.
        let vague_s = if segment.flown { 0.0 } else { takes_s };
        let (from_s, to_s) = (from_s - vague_s, to_s + vague_s);
        let at_s = |w: f64| segment.time_s(part.along(w));
        let line = (at_s(0.0), at_s(1.0));
        let after = part_below((from_s - line.0, from_s - line.1))?;
        let before = part_below((line.0 - to_s, line.1 - to_s))?;
        Some((after.0.max(before.0), after.1.min(before.1)))
    }

    /// The parts between floor and ceiling where one of them is above the ground.
    fn over_ground(&self, segment: &Segment, part: &Stretch) -> Vec<Part> {
        let Ok(patches) = self.surface.under(part.from, part.to) else {
            // Over unknown ground the zone may be anywhere.
            return vec![(0.0, 1.0)];
        };
        let middle = |patch: &Patch| 0.5 * (patch.w.0 + patch.w.1);
        let bow_rise_m =
            |patch: &Patch| (self.surface).bow_rise_m(segment, part, (patch, middle(patch)));
        let level = |patch: &Patch| Level {
            ground_m: patch.height_m,
            // The ground is this near to the straight line between the ends of the patch.
            error_m: patch.bulge_m.abs() + patch.error_m + bow_rise_m(patch),
        };
        patches
            .iter()
            .filter_map(|patch| self.between(segment, part, patch.w, &level(patch)))
            .collect()
    }

    /// The part of `[w0, w1]` between floor and ceiling.
    fn between(
        &self,
        segment: &Segment,
        part: &Stretch,
        (w0, w1): Part,
        level: &Level,
    ) -> Option<Part> {
        let amsl_m = |w: f64| segment.at(part.along(w)).amsl.0;
        let of = |limit: Placement| match limit {
            Placement::Amsl(amsl) => (
                amsl_m(w0) - amsl.0,
                amsl_m(w1) - amsl.0,
                segment.error_m + segment.off_m() + self.buffer_m,
            ),
            Placement::Agl(agl) => (
                amsl_m(w0) - level.ground_m.0 - agl.0,
                amsl_m(w1) - level.ground_m.1 - agl.0,
                segment.error_m + segment.off_m() + level.error_m + self.buffer_m,
            ),
        };
        let mut part = (0.0, 1.0);
        if let Some(ceiling) = self.zone.ceiling {
            let (from_m, to_m, error_m) = of(ceiling);
            let below = part_below((from_m - error_m, to_m - error_m))?;
            part = (below.0.max(part.0), below.1.min(part.1));
        }
        if let Some(floor) = self.floor {
            let (from_m, to_m, error_m) = of(floor);
            let above = part_below((-from_m - error_m, -to_m - error_m))?;
            part = (above.0.max(part.0), above.1.min(part.1));
        }
        let along = |v: f64| w0 + (w1 - w0) * v;
        (part.0 <= part.1).then(|| (along(part.0), along(part.1)))
    }
}

/// The ground under part of a stretch: heights at its ends, metres, straight between them.
struct Level {
    ground_m: Part,
    error_m: f64,
}

impl Level {
    /// What needs no ground.
    const SEA: Self = Self {
        ground_m: (0.0, 0.0),
        error_m: 0.0,
    };
}

/// The part in which what goes straight from `a` to `b` is below 0; all of it where that is not
/// a number.
fn part_below((a, b): Part) -> Option<Part> {
    if a.is_nan() || b.is_nan() {
        return Some((0.0, 1.0));
    }
    match (a >= 0.0, b >= 0.0) {
        (true, true) => None,
        (true, false) => Some((a / (a - b), 1.0)),
        (false, true) => Some((0.0, a / (a - b))),
        (false, false) => Some((0.0, 1.0)),
    }
}

#[cfg(test)]
mod tests {
    use super::part_below;

    #[test]
    fn an_altitude_that_is_not_a_number_is_below_everything() {
        for ends in [(f64::NAN, 5.0), (5.0, f64::NAN), (f64::NAN, f64::NAN)] {
            let part = part_below(ends).expect("a part");
            assert!(part.0 <= 0.0 && part.1 >= 1.0, "{part:?}");
        }
        assert!(part_below((1.0, 2.0)).is_none());
        let (from, to) = part_below((1.0, -1.0)).expect("a part");
        assert!((from - 0.5).abs() < 1e-12 && to >= 1.0);
    }
}
