//! What is known of one vehicle's flight.

use std::ops::Range;

use crate::geodesy::{EastNorth, PlanPoint};

use super::decode::Unknown;
use super::legs::{Knot, Run};
use super::trajectory::AltitudeLine;
use crate::verify::measure::segment::{Followed, Phase, Segment};

/// How steep and how fast one leg is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Slope {
    /// Index of the segment where the leg begins, for the place and time.
    pub(crate) segment: usize,
    pub(crate) phase: Phase,
    /// Horizontal length; 0 for a vertical motion, metres.
    pub(crate) run_m: f64,
    /// Rise, negative down, metres.
    pub(crate) rise_m: f64,
    /// Highest ground speed, m/s.
    pub(crate) speed_mps: f64,
    /// Highest point, metres above the sea.
    pub(crate) top_m: f64,
}

/// The length of a leg that its fillets leave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Turn {
    pub(crate) segment: usize,
    pub(crate) left_m: f64,
}

/// The speed a leg is commanded to be flown with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cruise {
    pub(crate) segment: usize,
    /// `None`: neither the mission nor its parameters say.
    pub(crate) speed_mps: Option<f64>,
}

/// A point of the route and when the vehicle is there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mark {
    pub(crate) point: PlanPoint,
    pub(crate) row: usize,
    pub(crate) t_s: f64,
}

/// Where a vehicle in the air rests, and when, seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rest {
    pub(crate) point: PlanPoint,
    pub(crate) from_s: f64,
    pub(crate) until_s: f64,
    /// By how much it may be later than at its begin, besides what it may be from its takeoff on.
    pub(crate) late_s: f64,
    /// And earlier.
    pub(crate) early_s: f64,
    /// The first and the last row that it rests for.
    pub(crate) rows: (usize, usize),
}

/// The circle that a wing keeps for ever.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Circle {
    pub(crate) radius_m: f64,
    /// Index of the segment that stands for it.
    pub(crate) segment: usize,
}

/// A circle that a wing flies, once or more often.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Round {
    /// Index of its first segment.
    pub(crate) segment: usize,
    pub(crate) radius_m: f64,
    /// The least that it can turn at its speed and altitude, metres.
    pub(crate) min_m: f64,
}

/// A circle on rotors.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct OnRotors {
    pub(crate) segments: Range<usize>,
    /// Its own speed over the ground, m/s.
    pub(crate) speed_mps: f64,
}

/// Where a plane may have the height of its takeoff.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EarlyTop {
    pub(crate) point: PlanPoint,
    /// How far the wind may have carried it from there.
    pub(crate) off: EastNorth,
}

/// A circle that a wing leaves somewhere: on its way to the next place it is within the hull of both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hull {
    pub(crate) middle: PlanPoint,
    /// How far from the middle it may be as it leaves, metres.
    pub(crate) reach_m: f64,
    /// When it may be there, seconds.
    pub(crate) from_s: f64,
    pub(crate) until_s: f64,
    /// Whether it may come to the next place from anywhere in the hull, off the course of its leg.
    pub(crate) any_course: bool,
}

/// How the flight ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum End {
    /// Touches down here.
    Landed(EastNorth),
    /// Stays in the air for ever here.
    Stays(EastNorth),
    /// Flies the same items for ever again.
    Repeats,
}

/// The item after which a mission does not go on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Last {
    pub(crate) row: usize,
    /// What the vehicle does there, as the beginning of a sentence.
    pub(crate) why: &'static str,
    /// Whether the items after it would not move it elsewhere.
    pub(crate) is_harmless: bool,
}

/// The legs between two stops, once laid.
pub(crate) struct Legs<'a> {
    pub(crate) knots: &'a [Knot],
    /// Altitude along each leg.
    pub(crate) lines: &'a [AltitudeLine],
    pub(crate) run: &'a Run,
    /// The first segment of each leg.
    pub(crate) firsts: &'a [usize],
}

/// One vehicle's flight.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Flight {
    /// In order of time, but for segments that are not flown.
    pub(crate) segments: Vec<Segment>,
    pub(crate) slopes: Vec<Slope>,
    /// In order of time; what follows at once at the same place is one rest.
    pub(crate) rests: Vec<Rest>,
    pub(crate) turns: Vec<Turn>,
    pub(crate) cruises: Vec<Cruise>,
    /// Points of the route, from the first that can be the start to the last before the landing.
    pub(crate) route: Vec<Mark>,
    /// Delay before takeoff in the items, seconds.
    pub(crate) delay_s: Option<f64>,
    pub(crate) end: Option<End>,
    /// Course of a plane's takeoff, radians clockwise from north.
    pub(crate) takeoff_rad: Option<f64>,
    /// Course and angle of a plane's glide to its landing, radians.
    pub(crate) landing: Option<(f64, f64)>,
    /// The lowest place that it is sent to by its altitude above the sea, landings aside.
    pub(crate) low_point: Option<Mark>,
    /// How far above home a plane lands where the ground is not known, if it is not near home's height,
    /// metres.
    pub(crate) blind_landing_m: Option<f64>,
    /// How far from its place a descent on rotors may end, driven off by the wind, metres.
    pub(crate) landing_drift_m: f64,
    pub(crate) circle: Option<Circle>,
    /// All circles of a wing, that one too.
    pub(crate) rounds: Vec<Round>,
    pub(crate) on_rotors: Vec<OnRotors>,
    /// From where on the flight is not known.
    pub(crate) unknown: Option<Unknown>,
    /// The item after which none is flown, if others follow it.
    pub(crate) last: Option<Last>,
    /// Index of the segment that stands for all repetitions of a mission that repeats for ever: the
    /// vehicle is anywhere around it. For the separation alone.
    pub(crate) repetition: Option<usize>,
    /// Whether it begins in the air in its landing descent or in a drop: no route may be left of it.
    pub(crate) begins_in_column: bool,
    /// Whether the altitude above ground is the vehicle's own doing somewhere.
    pub(crate) follows_terrain: bool,
}

impl Flight {
    /// Keeps the lower of the lowest place so far and another.
    pub(crate) fn note_low(&mut self, mark: Mark) {
        if self
            .low_point
            .is_none_or(|low| mark.point.amsl.0 < low.point.amsl.0)
        {
            self.low_point = Some(mark);
        }
    }

    /// When the last motion that ends has ended, seconds.
    pub(crate) fn last_s(&self) -> f64 {
        self.segments
            .iter()
            .flat_map(|segment| [segment.from_s, segment.to_s])
            .filter(|time| time.is_finite())
            .fold(0.0, f64::max)
    }

    /// Whether it ends, as opposed to a stay in the air for ever.
    pub(crate) fn ends(&self) -> bool {
        self.segments.iter().all(|segment| segment.to_s.is_finite())
    }

    /// Ends every stay at `horizon_s`.
    pub(crate) fn stay_until(&mut self, horizon_s: f64) {
        for segment in &mut self.segments {
            if segment.to_s.is_infinite() {
                segment.to_s = horizon_s.max(segment.from_s);
            }
        }
    }

    /// Notes what the limits on whole legs need.
    pub(crate) fn take_stock(&mut self, legs: &Legs<'_>, segments: &[Segment], end_s: f64) {
        let Legs {
            knots,
            lines,
            run,
            firsts,
        } = *legs;
        for (leg, line) in lines.iter().enumerate() {
            let (from, to) = (&knots[leg], &knots[leg + 1]);
            let segment = firsts[leg];
            let end = firsts.get(leg + 1).copied().unwrap_or(segments.len());
            if line.follows {
                self.follows_terrain = true;
                self.slopes_over_ground(segments, segment..end, run.peak_mps[leg]);
            } else {
                self.slopes.push(Slope {
                    segment,
                    phase: to.phase,
                    run_m: from.at.distance_m(to.at),
                    rise_m: to.amsl_m - from.amsl_m,
                    speed_mps: run.peak_mps[leg],
                    top_m: to.amsl_m.max(from.amsl_m),
                });
            }
            self.cruises.push(Cruise {
                segment,
                speed_mps: to.speed_is_known.then_some(to.speed_mps),
            });
            if to.phase != Phase::Finish {
                let t_s = segments.get(end).map_or(end_s, |next| next.from_s);
                self.route.push(Mark {
                    point: to.point(),
                    row: to.row,
                    t_s,
                });
            }
        }
        for room in &run.rooms {
            self.turns.push(Turn {
                segment: firsts[room.leg],
                left_m: room.left_m,
            });
        }
    }

    /// Slopes of a leg that follows the terrain: segment by segment.
    fn slopes_over_ground(&mut self, segments: &[Segment], of_leg: Range<usize>, speed_mps: f64) {
        for segment in of_leg {
            let of = &segments[segment];
            if of.flown && of.followed.is_some() {
                self.slopes.push(Slope {
                    segment,
                    phase: of.phase,
                    run_m: of.from.at.distance_m(of.to.at),
                    rise_m: of.to.amsl.0 - of.from.amsl.0,
                    speed_mps,
                    top_m: of.to.amsl.0.max(of.from.amsl.0),
                });
            }
        }
    }

    /// Cuts the flight at the first number that is not finite and marks it unknown from there:
    /// later steps rely on finite numbers.
    pub(crate) fn cut_at_nan(mut self) -> Self {
        let is_known = |segment: &Segment| {
            let ends = [segment.from, segment.to];
            segment.from_s.is_finite()
                && !segment.to_s.is_nan()
                && segment.error_m.is_finite()
                && segment.followed.is_none_or(Followed::is_finite)
                && ends
                    .iter()
                    .all(|end| (end.at.east_m + end.at.north_m + end.amsl.0).is_finite())
        };
        if let Some(first) = self.segments.iter().position(|segment| !is_known(segment)) {
            self.unknown = Some(Unknown {
                row: self.segments[first].row,
                why: "the motion comes out as not a number".to_owned(),
            });
            self.segments.truncate(first);
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geodesy::Amsl;

    #[test]
    fn a_height_above_ground_that_is_not_a_number_ends_what_is_known() {
        let at = PlanPoint::new(0.0, 0.0, Amsl(500.0));
        let followed = |agl_m: (f64, f64)| Followed {
            agl_m,
            min_m: agl_m.0.min(agl_m.1),
            max_m: agl_m.0.max(agl_m.1),
            off_m: 0.0,
        };
        let segment = |agl_m| Segment {
            followed: Some(followed(agl_m)),
            flown: true,
            ..Segment::unflown((3, Phase::Route), (0.0, 1.0), (at, at))
        };
        for agl_m in [(f64::NAN, 50.0), (50.0, f64::NAN), (f64::INFINITY, 50.0)] {
            let flight = Flight {
                segments: vec![segment((50.0, 50.0)), segment(agl_m)],
                ..Flight::default()
            };
            let cut = flight.cut_at_nan();
            assert_eq!(cut.segments.len(), 1, "{agl_m:?}");
            assert_eq!(cut.unknown.map(|unknown| unknown.row), Some(3));
        }
    }
}
