//! The fence of a mission against what the spec wants in it.
//!
//! A fence that does not fit the autopilot may hold wider boundaries, and leave far ones out. Both
//! are judged from the encoded items alone: that a wider boundary covers what it stands for and
//! stays away from what is flown, and how far from path and ways back the others are.

use rayon::prelude::*;

use super::{MissionCheck, count};
use crate::autopilot::Autopilot;
use crate::geodesy::LatLon;
use crate::mission::{self, FENCE_REACH_S, Item, command};
use crate::numeric::digits::float32;
use crate::verify::limits::fence::{Fence, boundaries, covers, holds};
use crate::verify::measure::outline::Part;
use crate::verify::measure::segment::{Segment, Stretch, stretches};
use crate::verify::measure::worst::{Worst, nearest_first};
use crate::verify::{Limit, Margin, Moment, Requirement};

/// Ways back begin this far apart along the path, metres.
const BACK_STEP_M: f64 = 50.0;

/// A boundary that the spec wants in the fence: its name and items.
type Piece = (String, Vec<Item>);

/// What of the spec's fence a mission's is.
struct Held<'a> {
    /// Boundaries that cover some piece that they are not.
    wider: Vec<&'a [Item]>,
    /// What no boundary covers.
    absent: Vec<Piece>,
    /// Items that the spec's own fence has.
    needs: usize,
}

impl MissionCheck<'_> {
    /// How far a copter may be from the places of its waypoints in corners, against the margin
    /// of its fence. Wings turn before a waypoint, on a way that is judged by itself.
    pub(super) fn fence_margin(&self) -> Option<Margin> {
        let is_wing = self.vehicle.airframe.has_wing();
        if self.spec.buffers.is_none() || is_wing || self.mission.fence.is_empty() {
            return None;
        }
        let in_file_m = self.mission.param("FENCE_MARGIN");
        let margin_m = in_file_m.unwrap_or_else(|| self.spec.fence_margin_m());
        let mut worst = Worst::default();
        for (index, item) in self.mission.items.iter().enumerate() {
            let row = index + 1;
            let segment = self
                .flight
                .segments
                .iter()
                .rfind(|segment| segment.row == row);
            if let Some(segment) = segment.filter(|_| item.command == command::NAV_WAYPOINT) {
                let radius_m = mission::acceptance_m(self.mission, row);
                worst.at_most(radius_m, margin_m, || {
                    segment.moment(&self.world.frame, 1.0)
                });
            }
        }
        worst.margin(self.id(), Limit::FenceMargin, "m")
    }

    /// What of the spec's fence the mission's does not hold, where it could hold one; wider
    /// boundaries; what is left out.
    pub(super) fn fence(&self) -> Vec<Margin> {
        if !self.spec.mission.fence || !self.mission.is_fence_known {
            return Vec::new();
        }
        let held = self.held();
        // Where all of it fits, nothing may be left out, and the area never.
        let (left_out, missing): (Vec<Piece>, Vec<Piece>) =
            held.absent.into_iter().partition(|(_, items)| {
                let is_exclusion = items.first().is_some_and(is_exclusion);
                is_exclusion && held.needs > self.vehicle.fence_capacity()
            });
        let required = Requirement::at_most(Limit::FenceComplete, 0.0, "missing");
        let unwatched = self.unwatched();
        let problems = missing.len() + unwatched.len();
        let mut complete = required.margin(self.id(), count(problems), None);
        let names: Vec<String> = missing.into_iter().map(|(name, _)| name).collect();
        let absent = (!names.is_empty()).then(|| format!("not in the fence: {}", names.join(", ")));
        let notes: Vec<String> = absent.into_iter().chain(unwatched).collect();
        complete.note = notes.join("; ");
        let mut margins = vec![complete];
        margins.extend(self.wider(&held.wider));
        margins.extend(self.left_out(&left_out));
        margins
    }

    /// Why boundaries are in the fence and keep nobody in or out.
    fn unwatched(&self) -> Vec<String> {
        let pieces = mission::fence_pieces(self.spec);
        if pieces.is_empty() {
            return Vec::new();
        }
        let mut why = Vec::new();
        if self.mission.autopilot == Autopilot::Px4 {
            // It keeps inside of any one of its inclusions.
            let own = |boundary: &&&[Item]| pieces.iter().any(|(_, items)| holds(boundary, items));
            let found = boundaries(&self.mission.fence);
            let others = found.iter().filter(|boundary| {
                boundary.first().is_some_and(|item| {
                    !is_exclusion(item) && item.command != command::NAV_FENCE_RETURN_POINT
                }) && !own(boundary)
            });
            let others = others.count();
            if others > 0 {
                why.push(format!(
                    "{others} inclusions beside those of the spec: PX4 keeps the vehicle inside of any one of them"
                ));
            }
        }
        let value = |name: &str| self.mission.param(name);
        let (switch, kinds) = ("FENCE_ENABLE", "FENCE_TYPE");
        let is_armed_on = value("FENCE_AUTOENABLE").is_some_and(|value| value > 0.0);
        if value(switch).is_some_and(|value| value < 0.5) && !is_armed_on {
            why.push(format!("{switch} is 0: nothing watches it"));
        }
        // Bit 2: polygons and circles.
        let watches = |value: f64| (value / 4.0).floor().rem_euclid(2.0) >= 1.0;
        if let Some(other) = value(kinds).filter(|value| !watches(*value)) {
            why.push(format!(
                "{kinds} is {}: polygons and circles are not watched (4)",
                float32(other)
            ));
        }
        if value("GF_ACTION").is_some_and(|value| value < 0.5) {
            why.push("GF_ACTION is 0: nothing watches it".to_owned());
        }
        why
    }

    fn held(&self) -> Held<'_> {
        let found = boundaries(&self.mission.fence);
        let pieces = mission::fence_pieces(self.spec);
        let needs = pieces.iter().map(|(_, items)| items.len()).sum();
        let (mut wider, mut absent) = (Vec::new(), Vec::new());
        for (name, items) in pieces {
            if found.iter().any(|boundary| holds(boundary, &items)) {
                continue;
            }
            let is_exclusion = items.first().is_some_and(is_exclusion);
            let mut covering = found.iter().enumerate();
            let is_covered = |(_, boundary): &(usize, &&[Item])| covers(boundary, &items);
            match covering.find(is_covered).filter(|_| is_exclusion) {
                Some((index, _)) => wider.push(index),
                None => absent.push((name, items)),
            }
        }
        wider.sort_unstable();
        wider.dedup();
        Held {
            wider: wider.into_iter().map(|index| found[index]).collect(),
            absent,
            needs,
        }
    }

    /// How near the flight and the rally points come to boundaries that are wider than the spec's.
    fn wider(&self, boundaries: &[&[Item]]) -> Option<Margin> {
        let items: Vec<Item> = boundaries.concat();
        let fence = match Fence::read(&items) {
            Ok(fence) if !fence.is_empty() => fence,
            // What cannot be read fails as the fence itself.
            _ => return None,
        };
        let bound_m = self.spec.fence_margin_m();
        let mut worst = Worst::default();
        for (segment, parts) in self.flown() {
            for part in parts {
                // What is flown may be as far as its bow from the segment, to any side.
                let known_m = worst.room() + bound_m + segment.bow_m;
                let (away_m, w) = fence.margin_m(&part, known_m);
                let away_m = away_m - segment.bow_m;
                worst.at_least(away_m, bound_m, || self.moment_of(segment, &part, w));
            }
        }
        for place in self.mission.rally.iter().filter_map(Item::place) {
            let at = Moment {
                place,
                amsl: self.sites.home.amsl,
                t_s: 0.0,
                item: 0,
            };
            worst.at_least(fence.place_margin_m(place), bound_m, || at);
        }
        worst.margin(self.id(), Limit::FenceWider, "m")
    }

    /// How far what is left out is from the flight, and from the straight ways back from it.
    fn left_out(&self, pieces: &[Piece]) -> Vec<Margin> {
        if pieces.is_empty() {
            return Vec::new();
        }
        let bound_m = FENCE_REACH_S * self.vehicle.top_speed_mps();
        let home = self.mission.home;
        let home = LatLon::of_e7(home.x, home.y);
        let mut ways: Vec<Part<'_>> = Vec::new();
        let mut backs: Vec<Part<'_>> = Vec::new();
        for (segment, parts) in self.flown() {
            for part in parts {
                ways.push(Part::new(segment, part, segment.bow_m));
                // Another way back may be nearer by half of a step.
                let back = |back| Part::new(segment, back, 0.5 * BACK_STEP_M + segment.bow_m);
                backs.extend(ways_back(&part, home).map(back));
            }
        }
        ways.extend(backs);
        let margins = pieces.par_iter().map(|(name, items)| {
            let limit = Limit::FenceLeftOut(name.clone());
            let region = match Fence::read(items) {
                Ok(region) => region,
                Err(why) => return Margin::unjudged(self.id(), limit, why),
            };
            nearest_first(
                &ways,
                |way| region.bound_m(&way.around) - way.slack_m - bound_m,
                -bound_m,
                |way, worst| {
                    let (away_m, w) = region.margin_m(&way.stretch, f64::INFINITY);
                    worst.at_least(away_m - way.slack_m, bound_m, || {
                        self.moment_of(way.segment, &way.stretch, w)
                    });
                },
            )
            .margin(self.id(), limit.clone(), "m")
            .unwrap_or_else(|| Margin::unjudged(self.id(), limit, "nothing is flown"))
        });
        margins.collect()
    }

    /// The segments of the flight in parts that are straight on the earth.
    fn flown(&self) -> impl Iterator<Item = (&Segment, Vec<Stretch>)> {
        let segments = self.flight.segments.iter().enumerate();
        let once = segments.filter(|(index, _)| Some(*index) != self.flight.repetition);
        once.map(|(_, segment)| {
            let from = self.world.frame.from_plan(segment.from.at);
            let parts = stretches(&self.world.frame, (segment.from.at, from), segment.to.at);
            (segment, parts)
        })
    }

    fn moment_of(&self, segment: &Segment, part: &Stretch, w: f64) -> Moment {
        segment.moment(&self.world.frame, part.u.0 + (part.u.1 - part.u.0) * w)
    }
}

fn is_exclusion(item: &Item) -> bool {
    [
        command::NAV_FENCE_POLYGON_VERTEX_EXCLUSION,
        command::NAV_FENCE_CIRCLE_EXCLUSION,
    ]
    .contains(&item.command)
}

/// Straight ways home from points along a part of a flight.
fn ways_back(part: &Stretch, home: LatLon) -> impl Iterator<Item = Stretch> {
    let (part, length_m) = (*part, part.from.chord_m(part.to));
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to a small positive count"
    )]
    let steps = (length_m / BACK_STEP_M).ceil().clamp(1.0, 1e6) as u32;
    (1..=steps).map(move |step| {
        let share = f64::from(step) / f64::from(steps);
        let mix = |a: f64, b: f64| a + (b - a) * share;
        let u = mix(part.u.0, part.u.1);
        Stretch {
            u: (u, u),
            from: LatLon {
                lat_deg: mix(part.from.lat_deg, part.to.lat_deg),
                lon_deg: mix(part.from.lon_deg, part.to.lon_deg),
            },
            to: home,
        }
    })
}
