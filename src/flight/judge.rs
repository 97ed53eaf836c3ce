//! What was flown against the plan and against the limits of the spec.

use super::craft::End;
use super::record::{Fix, Flown};
use super::reference::{Reference, to_segment};
use super::report::{FlightReport, Passage, Spread, VehicleReport};
use crate::geodesy::PlanPoint;
use crate::numeric::approach::{Motion, closest_approach, closest_horizontal, least_ratio};
use crate::spec::{MissionSpec, Separation};
use crate::verify::{Margin, Moment, Sense};
use crate::world::World;

/// Around home and the place of landing the minimum height does not hold, metres.
const COLUMN_M: f64 = 25.0;
/// Higher above the ground than this a vehicle is in the air and must keep its distance, metres.
const GROUNDED_M: f64 = 1.0;
/// Between two positions this far apart in time nothing is known, seconds.
const GAP_S: f64 = 5.0;

/// One vehicle's flight in planning coordinates.
struct Trail<'a> {
    id: &'a str,
    reference: &'a Reference,
    flown: &'a Flown,
    points: Vec<PlanPoint>,
}

/// Judges a flight. The vehicles come in the order of the spec, each with its plan and record.
#[must_use]
pub fn judge(
    spec: &MissionSpec,
    world: &World,
    flights: &[(&str, &Reference, &Flown)],
) -> FlightReport {
    let trails: Vec<Trail<'_>> = flights
        .iter()
        .map(|&(id, reference, flown)| Trail {
            id,
            reference,
            flown,
            points: flown
                .fixes
                .iter()
                .map(|fix| plan_point(world, fix))
                .collect(),
        })
        .collect();
    let mut margins: Vec<Margin> = trails
        .iter()
        .flat_map(|trail| trail.margins(spec, world))
        .collect();
    for (index, first) in trails.iter().enumerate() {
        for second in &trails[index + 1..] {
            margins.extend(separation(&spec.separation, world, first, second));
        }
    }
    FlightReport {
        vehicles: trails.iter().map(Trail::report).collect(),
        margins,
    }
}

fn plan_point(world: &World, fix: &Fix) -> PlanPoint {
    PlanPoint {
        at: world.frame.to_plan(fix.place),
        amsl: fix.amsl,
    }
}

fn moment(fix: &Fix) -> Moment {
    Moment {
        place: fix.place,
        amsl: fix.amsl,
        t_s: fix.t_s,
        item: fix.item,
    }
}

impl Trail<'_> {
    /// Fixes on the route: neither in the column of the takeoff nor in that of the landing.
    fn on_route(&self) -> impl Iterator<Item = (&Fix, PlanPoint)> {
        let home = self.reference.waypoints.first().map(|w| w.point.at);
        let end = self.reference.waypoints.last().map(|w| w.point.at);
        let end = end.filter(|_| self.reference.lands);
        let takeoff = self.reference.waypoints.get(1).map_or(0, |w| w.item);
        let fixes = self.flown.fixes.iter().zip(self.points.iter().copied());
        fixes.filter(move |(fix, point)| {
            let near = |at: Option<_>| {
                at.is_some_and(|at: crate::geodesy::EastNorth| at.distance_m(point.at) < COLUMN_M)
            };
            fix.item > takeoff && !near(home) && !near(end)
        })
    }

    /// Where each waypoint was passed: the nearest of the ways between two positions,
    /// one waypoint after the other.
    fn passages(&self) -> Vec<Passage> {
        let fixes = &self.flown.fixes;
        let mut from = 0;
        let mut found = Vec::new();
        for (index, waypoint) in self.reference.waypoints.iter().enumerate().skip(1) {
            let items = &self.reference.waypoints;
            let next = items.get(index + 1).map_or(usize::MAX, |w| w.item);
            let mut best: Option<(f64, f64, usize)> = None;
            for at in from..fixes.len().saturating_sub(1) {
                if fixes[at].item > next {
                    break;
                }
                let (distance_m, share) =
                    to_segment(waypoint.point, self.points[at], self.points[at + 1]);
                if best.is_none_or(|(least, ..)| distance_m < least - 0.05) {
                    let t_s = fixes[at].t_s + share * (fixes[at + 1].t_s - fixes[at].t_s);
                    best = Some((distance_m, t_s, at));
                }
            }
            let was_reached = fixes.iter().any(|fix| fix.item > waypoint.item)
                || self
                    .flown
                    .reached
                    .iter()
                    .any(|(item, _)| *item == waypoint.item);
            if let Some((distance_m, flown_s, at)) = best.filter(|_| was_reached) {
                from = at;
                found.push(Passage {
                    item: waypoint.item,
                    planned_s: waypoint.t_s,
                    flown_s,
                    distance_m,
                });
            }
        }
        found
    }

    fn report(&self) -> VehicleReport {
        let deviations: Vec<(f64, f64)> = self
            .on_route()
            .filter_map(|(fix, point)| self.reference.deviation(fix.item, point))
            .map(|deviation| (deviation.cross_track_m, deviation.above_m.abs()))
            .collect();
        let end = &self.flown.end;
        let as_planned = match end {
            End::Landed => self.reference.lands,
            End::Loitering => !self.reference.lands,
            _ => false,
        };
        VehicleReport {
            vehicle: self.id.to_owned(),
            end: match end {
                End::Landed => "landed".to_owned(),
                End::Loitering => "loiters".to_owned(),
                End::Held => "held".to_owned(),
                End::LandedEarly => "landed early".to_owned(),
                End::LeftFlying => "left flying".to_owned(),
                End::NotFlown => "not flown".to_owned(),
                End::Failed(why) => why.clone(),
            },
            ended_as_planned: as_planned,
            fixes: self.flown.fixes.len(),
            cross_track_m: Spread::of(deviations.iter().map(|d| d.0).collect()),
            altitude_error_m: Spread::of(deviations.iter().map(|d| d.1).collect()),
            passages: self.passages(),
        }
    }

    fn margins(&self, spec: &MissionSpec, world: &World) -> Vec<Margin> {
        if self.flown.fixes.is_empty() {
            return vec![Margin::unjudged(
                self.id,
                "flight",
                "no position was recorded",
            )];
        }
        let mut margins = self.gaps();
        let clearance = self.on_route().map(|(fix, point)| {
            let ground = world.terrain.height(fix.place);
            (
                ground.map_or(f64::NAN, |g| point.amsl.above_ground(g).0),
                fix,
            )
        });
        let least = Bound {
            what: "terrain clearance".to_owned(),
            limit: spec.area.min_agl.0,
            sense: Sense::AtLeast,
            unit: "m",
        };
        margins.extend(self.worst(least, clearance));
        let ceiling = Bound {
            what: "ceiling".to_owned(),
            limit: spec.area.max_amsl.0,
            sense: Sense::AtMost,
            unit: "m AMSL",
        };
        margins.extend(self.worst(ceiling, self.flown.fixes.iter().map(|f| (f.amsl.0, f))));
        let all = || self.flown.fixes.iter().zip(self.points.iter().copied());
        for (threat, disc) in spec.threats.iter().zip(&world.threats) {
            let rim = Bound {
                what: format!("threat {}", threat.id),
                limit: 0.0,
                sense: Sense::AtLeast,
                unit: "m",
            };
            let outside = all().map(|(fix, p)| (disc.center.distance_m(p.at) - disc.radius_m, fix));
            margins.extend(self.worst(rim, outside));
        }
        let none = |what: String| Bound {
            what,
            limit: 0.0,
            sense: Sense::AtMost,
            unit: "positions",
        };
        for (zone, shape) in spec.no_fly.iter().zip(&world.zones) {
            let inside = all().filter(|(_, point)| shape.is_closed_at(*point));
            margins.push(self.count(none(format!("zone {}", zone.id)), inside.map(|(f, _)| f)));
        }
        let outside = all().filter(|(_, point)| !world.in_area(point.at));
        margins.push(self.count(none("outside the area".to_owned()), outside.map(|(f, _)| f)));
        margins
    }

    /// Times of which nothing is known.
    fn gaps(&self) -> Vec<Margin> {
        let pairs = self.flown.fixes.windows(2);
        let longest = pairs
            .map(|pair| (pair[1].t_s - pair[0].t_s, &pair[0]))
            .max_by(|a, b| a.0.total_cmp(&b.0));
        let bound = Bound {
            what: "longest time without a position".to_owned(),
            limit: GAP_S,
            sense: Sense::AtMost,
            unit: "s",
        };
        self.worst(bound, longest.into_iter()).into_iter().collect()
    }

    /// The worst of values; one that is not a number is the worst of all.
    fn worst<'f>(
        &self,
        bound: Bound,
        values: impl Iterator<Item = (f64, &'f Fix)>,
    ) -> Option<Margin> {
        let badness = |value: f64| match bound.sense {
            _ if value.is_nan() => f64::INFINITY,
            Sense::AtLeast => bound.limit - value,
            Sense::AtMost => value - bound.limit,
        };
        let (value, fix) = values.max_by(|a, b| badness(a.0).total_cmp(&badness(b.0)))?;
        let note = if value.is_nan() {
            "no elevation data there".to_owned()
        } else {
            String::new()
        };
        Some(Margin {
            ok: badness(value) <= 0.0,
            note,
            ..bound.margin(self.id, value, Some(moment(fix)))
        })
    }

    fn count<'f>(&self, bound: Bound, mut fixes: impl Iterator<Item = &'f Fix>) -> Margin {
        let first = fixes.next();
        let more = u32::try_from(fixes.count()).unwrap_or(u32::MAX);
        let value = first.map_or(0.0, |_| 1.0 + f64::from(more));
        Margin {
            ok: first.is_none(),
            ..bound.margin(self.id, value, first.map(moment))
        }
    }

    /// The motions in the air between two positions.
    fn motions(&self, world: &World) -> Vec<(Motion, usize)> {
        let axes = |p: &PlanPoint| [p.at.east_m, p.at.north_m, p.amsl.0];
        let is_up = |index: usize| {
            let fix = &self.flown.fixes[index];
            let ground = world.terrain.height(fix.place);
            ground.map_or(true, |ground| fix.amsl.above_ground(ground).0 > GROUNDED_M)
        };
        (1..self.points.len())
            .filter(|&index| is_up(index - 1) || is_up(index))
            .map(|index| {
                let (from, to) = (&self.flown.fixes[index - 1], &self.flown.fixes[index]);
                let motion = Motion::between(
                    (from.t_s, axes(&self.points[index - 1])),
                    (to.t_s, axes(&self.points[index])),
                );
                (motion, index)
            })
            .collect()
    }
}

/// A limit without its value.
struct Bound {
    what: String,
    limit: f64,
    sense: Sense,
    unit: &'static str,
}

impl Bound {
    fn margin(self, vehicle: &str, value: f64, at: Option<Moment>) -> Margin {
        Margin {
            vehicle: vehicle.to_owned(),
            other: None,
            what: self.what,
            value,
            limit: self.limit,
            sense: self.sense,
            unit: self.unit,
            at,
            ok: false,
            note: String::new(),
        }
    }
}

/// The least distance of two vehicles at the same time, both in the air.
fn separation(
    limit: &Separation,
    world: &World,
    first: &Trail<'_>,
    second: &Trail<'_>,
) -> Option<Margin> {
    let (a, b) = (first.motions(world), second.motions(world));
    let mut best: Option<(f64, f64, usize)> = None;
    let mut conflict = false;
    let mut from = 0;
    for (motion, index) in &a {
        while from < b.len() && b[from].0.t1_s < motion.t0_s {
            from += 1;
        }
        for (other, _) in b[from..].iter().take_while(|(o, _)| o.t0_s <= motion.t1_s) {
            let near = match limit.vertical_m {
                None => closest_approach(motion, other, 0.0),
                Some(vertical_m) => {
                    let least = least_ratio(motion, other, 0.0, limit.distance_m, vertical_m);
                    conflict |= least.is_some_and(|least| least.value < 1.0);
                    closest_horizontal(motion, other, 0.0, vertical_m)
                }
            };
            if let Some(near) = near
                && best.is_none_or(|(least, ..)| near.value < least)
            {
                best = Some((near.value, near.t_s, *index));
            }
        }
    }
    let (value, t_s, index) = best?;
    let at = Moment {
        t_s,
        ..moment(&first.flown.fixes[index])
    };
    let bound = Bound {
        what: "separation".to_owned(),
        limit: limit.distance_m,
        sense: Sense::AtLeast,
        unit: "m",
    };
    Some(Margin {
        other: Some(second.id.to_owned()),
        ok: match limit.vertical_m {
            None => value >= limit.distance_m,
            Some(_) => !conflict,
        },
        ..bound.margin(first.id, value, Some(at))
    })
}
