//! Pairwise separation, from takeoff to touchdown, at the worst allowed shift.

use std::collections::BTreeSet;

use rayon::prelude::*;

use crate::geodesy::LocalFrame;
use crate::numeric::tracks::{Nearness, Track, Tracks};
use crate::path::{max_shift_s, takeoff_shift_s, with_stops_s};
use crate::spec::{Separation, Span};

use crate::verify::measure::segment::Segment;
use crate::verify::measure::timeline::{
    Distance, Metric, Nearest, Timeline, come_nearer, motion, nearest,
};
use crate::verify::{Limit, Margin, Requirement, Shift};

/// Every pair of a fleet up to this size is listed; of a larger one, those that come near.
const LISTED_FLEET: usize = 16;
/// "Near", in separation distances.
const NEAR: f64 = 2.0;

/// The margin of a pair of timelines, by their positions.
type PairMargin = ((usize, usize), Margin);

/// The margins of all pairs (of a large fleet: of those that come near), but for those of two
/// that are known.
pub(crate) fn margins(
    timelines: &[Timeline<'_>],
    is_known: &[bool],
    separation: &Separation,
    frame: &LocalFrame,
) -> Vec<PairMargin> {
    let count = timelines.len();
    let changed: Vec<usize> = (0..count).filter(|&one| !is_known[one]).collect();
    let pair = |one: usize, other: usize| (one.min(other), one.max(other));
    if count <= LISTED_FLEET {
        let each = |&one: &usize| (0..count).map(move |other| pair(one, other));
        let pairs = changed.iter().flat_map(each).filter(|(a, b)| a != b);
        return margins_of(timelines, pairs.collect(), separation, frame, f64::INFINITY);
    }
    let below_m = NEAR * separation.distance_m;
    let near = Near::new(timelines, separation, below_m);
    let pairs = changed.par_iter().flat_map_iter(|&one| {
        let others = near.of(one).into_iter();
        others.map(move |other| pair(one, other))
    });
    let pairs = pairs.filter(|(a, b)| a != b);
    margins_of(timelines, pairs.collect(), separation, frame, below_m)
}

/// The margins of some pairs, in their order.
fn margins_of(
    timelines: &[Timeline<'_>],
    pairs: BTreeSet<(usize, usize)>,
    separation: &Separation,
    frame: &LocalFrame,
    below_m: f64,
) -> Vec<PairMargin> {
    let pairs = pairs.into_par_iter();
    let margins = pairs.filter_map(|(a, b)| {
        let margin = pair_margin(&timelines[a], &timelines[b], separation, frame, below_m)?;
        Some(((a, b), margin))
    });
    margins.collect()
}

/// Who comes near whom, by the index over the segments of all.
struct Near {
    tracks: Tracks,
    nearness: Nearness,
}

impl Near {
    /// For pairs that may have a margin below `below_m`, less the errors of their segments.
    fn new(timelines: &[Timeline<'_>], separation: &Separation, below_m: f64) -> Self {
        /// More than rounding may take from a distance, metres.
        const TOLERANCE_M: f64 = 1e-3;
        let segments = timelines.iter().flat_map(|timeline| &timeline.segments);
        let error_m = segments.map(|of| of.reach_m()).fold(0.0, f64::max);
        let fleet = timelines.iter().map(|timeline| {
            let (late_s, early_s) = timeline
                .span()
                .map_or((0.0, 0.0), |span| (span.late_s, span.early_s));
            let on_its_way = Span {
                least: 0.0 - early_s,
                most: late_s,
            };
            (timeline.of, on_its_way)
        });
        let late_s = max_shift_s(fleet);
        let allowed_m = 2.0 * error_m + TOLERANCE_M;
        let nearness = Nearness {
            distance_m: below_m + allowed_m,
            vertical_m: separation.vertical_m.map(|level_m| level_m + allowed_m),
            slack_s: separation.time_slack_s + late_s,
            clear_m: 0.0,
        };
        let mut tracks = Tracks::new(&nearness);
        tracks.extend(timelines.iter().map(|timeline| {
            Track::new(
                timeline
                    .segments
                    .iter()
                    .map(|segment| motion(segment))
                    .collect(),
            )
        }));
        Self { tracks, nearness }
    }

    /// Those that come near a vehicle, itself included.
    fn of(&self, one: usize) -> Vec<usize> {
        self.tracks.near(&self.tracks.all()[one], &self.nearness, 0)
    }
}

/// What a review says when it does not list every pair.
pub(crate) fn assumption(fleet: usize, separation: &Separation) -> Option<String> {
    (fleet > LISTED_FLEET).then(|| {
        format!(
            "pairs of vehicles that stay more than {} m apart are not listed",
            NEAR * separation.distance_m
        )
    })
}

/// Whether two flights break the separation: exactly where [`margins`] has a margin that is not
/// kept. A flight without segments breaks none.
pub(crate) fn are_in_conflict(
    a: &Timeline<'_, Segment>,
    b: &Timeline<'_, Segment>,
    separation: &Separation,
) -> bool {
    let metric = Metric {
        distance: separation
            .vertical_m
            .map_or(Distance::Space, Distance::Horizontal),
        shift_s: with_slack(takeoff_shift_s(a.of, b.of), separation.time_slack_s),
    };
    come_nearer(a, b, &metric, separation.distance_m)
}

fn pair_margin(
    a: &Timeline<'_>,
    b: &Timeline<'_>,
    separation: &Separation,
    frame: &LocalFrame,
    below_m: f64,
) -> Option<Margin> {
    let slack_s = separation.time_slack_s;
    let shift_s = takeoff_shift_s(a.of, b.of);
    let metric = |distance| Metric {
        distance,
        shift_s: with_slack(shift_s, slack_s),
    };
    let Some(level_m) = separation.vertical_m else {
        let found = nearest(a, b, &metric(Distance::Space), below_m);
        let limit = (separation.distance_m, slack_s);
        return match found {
            Some(found) => Some(judge((a, b), found, limit, frame, "")),
            None => never_together(a, b, separation, below_m),
        };
    };
    if let Some(found) = nearest(a, b, &metric(Distance::Horizontal(level_m)), below_m) {
        let how = "horizontal, where the vertical distance is too small";
        let limit = (separation.distance_m, slack_s);
        return Some(judge((a, b), found, limit, frame, how));
    }
    if below_m.is_finite() {
        return None;
    }
    match nearest(a, b, &metric(Distance::Vertical), f64::INFINITY) {
        Some(found) => Some(judge((a, b), found, (level_m, slack_s), frame, "vertical")),
        None => never_together(a, b, separation, below_m),
    }
}

/// A shift, and a slack either way.
fn with_slack(shift_s: Span, slack_s: f64) -> Span {
    Span {
        least: shift_s.least - slack_s,
        most: shift_s.most + slack_s,
    }
}

fn judge(
    (a, b): (&Timeline<'_>, &Timeline<'_>),
    found: Nearest,
    (limit_m, slack_s): (f64, f64),
    frame: &LocalFrame,
    how: &str,
) -> Margin {
    let (mine, other) = (a.segments[found.segments.0], b.segments[found.segments.1]);
    let moment = |segment: &Segment, t_s: f64| segment.moment(frame, segment.fraction_at(t_s));
    let there = moment(other, found.times_s.1);
    let shift_s = found.times_s.1 - found.times_s.0;
    let split = if how.is_empty() { "" } else { "; " };
    let alone_s = takeoff_shift_s(a.of, b.of);
    let alone_s = with_stops_s(
        alone_s,
        mine.late_s + other.early_s,
        other.late_s + mine.early_s,
    );
    let lateness = if alone_s.most > alone_s.least {
        format!(
            ", of it {:.1} to {:.1} s by what autopilots are late",
            alone_s.least, alone_s.most
        )
    } else {
        String::new()
    };
    let required = Requirement::at_least(Limit::Separation, limit_m, "m");
    let at = moment(mine, found.times_s.0);
    Margin {
        other: Some(b.of.vehicle.id.clone()),
        shift: Some(Shift {
            worst_s: shift_s,
            allowed_s: with_slack(alone_s, slack_s),
        }),
        note: format!(
            "{how}{split}{} at item {}, {:.1} s, a shift of {shift_s:.1} s{lateness}",
            b.of.vehicle.id, there.item, there.t_s
        ),
        ..required.margin(&a.of.vehicle.id, found.distance_m, Some(at))
    }
}

/// Two vehicles that are never in the air at the same time: how long one is down before the other takes off.
fn never_together(
    a: &Timeline<'_>,
    b: &Timeline<'_>,
    separation: &Separation,
    below_m: f64,
) -> Option<Margin> {
    let (p, q) = (a.span()?, b.span()?);
    let shift_s = takeoff_shift_s(a.of, b.of);
    let shift_s = with_stops_s(shift_s, p.late_s + q.early_s, q.late_s + p.early_s);
    let gap_s = (p.from_s - q.to_s + shift_s.least).max(q.from_s - p.to_s - shift_s.most);
    if below_m.is_finite() || gap_s <= 0.0 {
        return None;
    }
    let required = Requirement::at_least(Limit::Separation, separation.time_slack_s, "s");
    Some(Margin {
        other: Some(b.of.vehicle.id.clone()),
        note: "never in the air at the same time".to_owned(),
        ..required.margin(&a.of.vehicle.id, gap_s, None)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geodesy::{Amsl, LatLon, PlanPoint};
    use crate::path::Departing;
    use crate::spec::fixtures::copter;
    use crate::spec::{Airframe, Autopilot, Vehicle};
    use crate::verify::measure::segment::Phase;
    use proptest::prelude::*;

    fn segment(
        (from_s, from): (f64, PlanPoint),
        (to_s, to): (f64, PlanPoint),
        error_m: f64,
    ) -> Segment {
        Segment {
            error_m,
            flown: true,
            ..Segment::unflown((1, Phase::Route), (from_s, to_s), (from, to))
        }
    }

    fn vehicle(autopilot: Autopilot, airframe: Airframe) -> Vehicle {
        Vehicle {
            autopilot,
            airframe,
            ..copter()
        }
    }

    fn on_ground(vehicle: &Vehicle) -> Departing<'_> {
        Departing {
            vehicle,
            is_airborne: false,
        }
    }

    /// One along a line at 10 m/s, and one across it that is there 100 s later than it.
    fn crossing() -> [Vec<Segment>; 2] {
        let at = |east, north| PlanPoint::new(east, north, Amsl(100.0));
        [
            vec![segment(
                (0.0, at(-1000.0, 0.0)),
                (200.0, at(1000.0, 0.0)),
                0.0,
            )],
            vec![segment(
                (100.0, at(0.0, -1000.0)),
                (300.0, at(0.0, 1000.0)),
                0.0,
            )],
        ]
    }

    /// The shortest distance of the two that cross, metres, found with so much slack.
    fn crossed_m(vehicles: [&Vehicle; 2], late_s: [f64; 2], time_slack_s: f64) -> f64 {
        let [mut one, mut other] = crossing();
        one[0].late_s = late_s[0];
        other[0].late_s = late_s[1];
        let timelines = [
            Timeline::new(on_ground(vehicles[0]), &one),
            Timeline::new(on_ground(vehicles[1]), &other),
        ];
        let separation = Separation {
            distance_m: 50.0,
            vertical_m: None,
            time_slack_s,
        };
        let frame = LocalFrame::new(vehicles[0].home);
        margins(&timelines, &[false; 2], &separation, &frame)[0]
            .1
            .value
    }

    #[test]
    fn vehicles_that_are_late_alike_are_not_shifted_and_others_by_what_they_may_be_late() {
        let copter = vehicle(Autopilot::ArduPilot, Airframe::Copter);
        let other = vehicle(Autopilot::Px4, Airframe::Copter);
        let plane = vehicle(Autopilot::ArduPilot, Airframe::Plane);
        // 100 s apart at the crossing and 10 m/s: each second of shift takes 10 / sqrt(2) m.
        let expected = |shift_s: f64| (1000.0 - 10.0 * shift_s) / 2.0_f64.sqrt();
        let is = |found: f64, shift_s: f64| {
            let off_m = (found - expected(shift_s)).abs();
            assert!(off_m < 1e-6, "{found} m, not {} m", expected(shift_s));
        };
        is(crossed_m([&copter, &copter], [0.0, 0.0], 5.0), 5.0);
        is(crossed_m([&copter, &other], [0.0, 0.0], 5.0), 17.0);
        // The first may be 12 s late and the second 15 s early, and not the other way round.
        is(crossed_m([&copter, &plane], [0.0, 0.0], 5.0), 32.0);
        is(crossed_m([&plane, &copter], [0.0, 0.0], 5.0), 5.0);
        // A stop behind the first brings it nearer to the second; one behind the second does not.
        is(crossed_m([&copter, &copter], [4.5, 0.0], 5.0), 9.5);
        is(crossed_m([&copter, &copter], [0.0, 4.5], 5.0), 5.0);
    }

    /// A flight through some places; every third stays at the last for ever.
    fn flight() -> impl Strategy<Value = Vec<Segment>> {
        let place = (-900.0..900.0_f64, -900.0..900.0_f64, 0.0..80.0_f64)
            .prop_map(|(east, north, amsl)| PlanPoint::new(east, north, Amsl(amsl)));
        let way = prop::collection::vec((place, 1.0..60.0_f64, 0.0..3.0_f64), 2..7);
        (0.0..90.0_f64, way, 0..3_u8).prop_map(|(mut t_s, way, finish)| {
            let mut segments = Vec::new();
            for pair in way.windows(2) {
                let next_s = t_s + pair[1].1;
                segments.push(segment((t_s, pair[0].0), (next_s, pair[1].0), pair[1].2));
                t_s = next_s;
            }
            if let Some(last) = segments.last_mut() {
                // As after a stop.
                last.late_s = 2.0 * last.error_m;
            }
            if finish == 0 {
                let last = way[way.len() - 1].0;
                segments.push(segment((t_s, last), (f64::INFINITY, last), 0.0));
            }
            segments
        })
    }

    proptest! {
        #[test]
        fn two_flights_are_in_conflict_exactly_where_a_margin_of_the_verdict_is_broken(
            one in flight(),
            other in flight(),
            distance_m in 20.0..400.0_f64,
            vertical_m in prop::option::of(5.0..40.0_f64),
            time_slack_s in prop_oneof![Just(0.0), 0.0..8.0_f64],
        ) {
            let separation = Separation { distance_m, vertical_m, time_slack_s };
            let frame = LocalFrame::new(LatLon { lat_deg: 36.0, lon_deg: -84.0 });
            let copter = vehicle(Autopilot::ArduPilot, Airframe::Copter);
            let timelines = [&one, &other].map(|segments| Timeline::new(on_ground(&copter), segments));
            let margins = margins(&timelines, &[false; 2], &separation, &frame);
            let is_broken = margins.iter().any(|(_, margin)| !margin.ok && margin.unit == "m"
                && (margin.bound - distance_m).abs() < 1e-9);
            let [one, other] = [&one, &other].map(|segments| Timeline::of(on_ground(&copter), segments.clone()));
            prop_assert_eq!(are_in_conflict(&one, &other, &separation), is_broken);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]

        #[test]
        fn a_large_fleet_has_the_margins_that_all_its_pairs_have(
            fleet in prop::collection::vec(flight(), 17..24),
            distance_m in 20.0..120.0_f64,
            vertical_m in prop::option::of(5.0..40.0_f64),
            time_slack_s in prop_oneof![Just(0.0), 0.0..8.0_f64],
            is_mixed in any::<bool>(),
            known in 0..17_usize,
        ) {
            let separation = Separation { distance_m, vertical_m, time_slack_s };
            let frame = LocalFrame::new(LatLon { lat_deg: 36.0, lon_deg: -84.0 });
            let kinds = [
                vehicle(Autopilot::ArduPilot, Airframe::Copter),
                vehicle(Autopilot::Px4, Airframe::Plane),
            ];
            let timelines: Vec<Timeline<'_>> = fleet
                .iter()
                .enumerate()
                .map(|(index, segments)| Timeline::new(on_ground(&kinds[index % (1 + usize::from(is_mixed))]), segments))
                .collect();
            let all = 0..timelines.len();
            let all = all.flat_map(|first| (first + 1..timelines.len()).map(move |other| (first, other)));
            let by_all = margins_of(&timelines, all.collect(), &separation, &frame, NEAR * distance_m);
            let mut is_known = vec![false; timelines.len()];
            prop_assert_eq!(&margins(&timelines, &is_known, &separation, &frame), &by_all);
            is_known[known..].fill(true);
            let of_others = by_all.iter().filter(|((first, _), _)| *first < known);
            let found = margins(&timelines, &is_known, &separation, &frame);
            prop_assert_eq!(found, of_others.cloned().collect::<Vec<_>>());
        }
    }
}
