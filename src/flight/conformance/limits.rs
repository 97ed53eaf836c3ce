//! The limits of the spec, held against what was flown.

use geo::{Contains, Point};

use super::{FlownTrack, GAP_S};
use crate::flight::record::{Fix, Record};
use crate::geodesy::{Amsl, EastNorth, PlanPoint};
use crate::numeric::approach::{Segment, closest_approach, closest_horizontal, min_ratio};
use crate::numeric::geometry::point_segment_distance;
use crate::spec::{Airframe, MissionSpec, Separation, Threat};
use crate::verify::{Flown, Limit, Margin, Moment, Requirement, Sense};
use crate::world::{Disc, PlanZone, World};

/// On a climb-out or glide the ground must stay this share of the height above the runway below
/// the vehicle, as in the verdict on the plan.
const SLOPE_SHARE: f64 = 0.5;
/// Higher above the ground than this a vehicle is in the air and must keep its distance, metres.
const GROUNDED_M: f64 = 1.0;

/// Between two positions a zone is looked for in steps of this length, metres, and in no more steps.
const STEP_M: f64 = 2.0;
const MAX_STEPS: f64 = 200.0;

pub(crate) fn moment(fix: &Fix) -> Moment {
    Moment {
        place: fix.place,
        amsl: fix.amsl,
        t_s: fix.t_s,
        item: fix.item,
    }
}

/// Whether nothing is known between two positions: that fails by itself, and no way is assumed there.
fn is_gap(from: &Fix, to: &Fix) -> bool {
    from.until_s(to) > GAP_S
}

/// Whether a zone is closed where and when a vehicle was.
fn is_closed(zone: &PlanZone, world: &World, t_s: f64, point: PlanPoint) -> bool {
    let ground = world.terrain.height_at(&world.frame, point.at);
    let ground_m = ground.map_or(f64::NAN, |ground| ground.0);
    zone.is_closed_at(point, ground_m, t_s)
}

impl FlownTrack<'_> {
    pub(crate) fn margins(
        &self,
        spec: &MissionSpec,
        world: &World,
        record: &Record,
    ) -> Vec<Margin> {
        if self.fixes().is_empty() {
            return vec![Margin::unjudged(
                self.id(),
                Limit::Flown(Flown::Recorded),
                "no position was recorded",
            )];
        }
        let mut margins = self.gaps(&record.stops);
        let clearance = self.on_route().map(|index| {
            let fix = &self.fixes()[index];
            let ground = world.terrain.height(fix.place);
            (ground.map_or(f64::NAN, |g| fix.amsl.above_ground(g).0), fix)
        });
        let least = Requirement::at_least(Limit::TerrainClearance, spec.area.min_agl.0, "m");
        margins.extend(self.worst(least, clearance));
        margins.extend(self.layer(spec, world));
        margins.extend(self.slopes(spec, world));
        let ceiling = Requirement::at_most(Limit::Ceiling, spec.area.max_amsl.0, "m AMSL");
        margins.extend(self.worst(ceiling, self.fixes().iter().map(|f| (f.amsl.0, f))));
        let all = || self.fixes().iter().zip(self.points.iter().copied());
        // The limits of the spec: the world of the plan has their buffers.
        let disc = |threat: &Threat| Disc {
            center: world.frame.to_plan(threat.place),
            radius_m: threat.radius_m,
        };
        let there = spec.threats.iter();
        let there = there.map(|threat| (threat, disc(threat), f64::NEG_INFINITY));
        let came = record
            .popups
            .iter()
            .map(|popup| (&popup.threat, disc(&popup.threat), popup.from_s));
        for (threat, disc, from_s) in there.chain(came) {
            let rim = Requirement::at_least(Limit::Threat(threat.id.clone()), 0.0, "m");
            let known = all().skip_while(|(fix, _)| fix.t_s < from_s);
            let known: Vec<(&Fix, PlanPoint)> = known.collect();
            // Between two positions too; the last of them is alone, and so is one before a gap.
            let next = known.iter().skip(1).chain(known.last());
            let outside = known.iter().zip(next).map(|(&(fix, from), &(then, to))| {
                let flat = |at: EastNorth| [at.east_m, at.north_m];
                let to = if is_gap(fix, then) { from } else { to };
                let ends = (flat(from.at), flat(to.at));
                let away_m = point_segment_distance(flat(disc.center), ends.0, ends.1);
                (away_m - disc.radius_m, fix)
            });
            margins.extend(self.worst(rim, outside));
        }
        margins.extend(self.closed_space(spec, world));
        margins
    }

    /// The greatest height above ground, and the least altitude on the route.
    fn layer(&self, spec: &MissionSpec, world: &World) -> Vec<Margin> {
        let vehicle = spec.vehicles.iter().find(|vehicle| vehicle.id == self.id());
        let limits = vehicle.map(|vehicle| vehicle.altitudes).unwrap_or_default();
        let mut margins = Vec::new();
        if let Some(most) = limits.max_agl {
            let heights = self.fixes().iter().map(|fix| {
                let ground = world.terrain.height(fix.place);
                (ground.map_or(f64::NAN, |g| fix.amsl.above_ground(g).0), fix)
            });
            let required = Requirement::at_most(Limit::MaxHeight, most.0, "m");
            margins.extend(self.worst(required, heights));
        }
        if let Some(least) = limits.min_amsl {
            let route = self.on_route().map(|index| &self.fixes()[index]);
            let required = Requirement::at_least(Limit::MinAltitude, least.0, "m AMSL");
            margins.extend(self.worst(required, route.map(|fix| (fix.amsl.0, fix))));
        }
        margins
    }

    /// Positions in zones and outside of the area.
    fn closed_space(&self, spec: &MissionSpec, world: &World) -> Vec<Margin> {
        let mut margins = Vec::new();
        let all = || self.fixes().iter().zip(self.points.iter().copied());
        let none = |limit: Limit| Requirement::at_most(limit, 0.0, "positions");
        for zone in &spec.no_fly {
            let outline = world.frame.outline(&zone.outline());
            let slack_s = spec.separation.time_slack_s;
            let shape = PlanZone::new(outline, zone, slack_s, &world.terrain);
            let inside = (0..self.points.len()).filter(|&index| self.enters(&shape, world, index));
            let zone = none(Limit::Zone(zone.id.clone()));
            margins.push(self.count(zone, inside.map(|index| &self.fixes()[index])));
        }
        let outline = world.frame.outline(&spec.area.outline());
        let in_area = |at: EastNorth| outline.contains(&Point::new(at.east_m, at.north_m));
        let outside = all().filter(|(_, point)| !in_area(point.at));
        let area = none(Limit::Flown(Flown::OutsideArea));
        margins.push(self.count(area, outside.map(|(f, _)| f)));
        margins
    }

    /// Whether a zone is closed where a vehicle was, or straight on its way to the next position.
    fn enters(&self, zone: &PlanZone, world: &World, index: usize) -> bool {
        let (fix, from) = (&self.fixes()[index], self.points[index]);
        if is_closed(zone, world, fix.t_s, from) {
            return true;
        }
        let next = self.fixes().get(index + 1).zip(self.points.get(index + 1));
        let Some((then, &to)) = next.filter(|(then, _)| !is_gap(fix, then)) else {
            return false;
        };
        let mix = |a: f64, b: f64, share: f64| a + (b - a) * share;
        let is_closed_at = |share: f64| {
            let point = PlanPoint::new(
                mix(from.at.east_m, to.at.east_m, share),
                mix(from.at.north_m, to.at.north_m, share),
                Amsl(mix(from.amsl.0, to.amsl.0, share)),
            );
            is_closed(zone, world, mix(fix.t_s, then.t_s, share), point)
        };
        let steps = (from.distance_m(to) / STEP_M).ceil().min(MAX_STEPS);
        let mut step = 1.0;
        // The next position counts itself.
        while step < steps {
            if is_closed_at(step / steps) {
                return true;
            }
            step += 1.0;
        }
        false
    }

    /// On its climb-out and its glide a plane must be as high as the verdict wants it there:
    /// a share of its height above the runway, until that is the minimum height.
    fn slopes(&self, spec: &MissionSpec, world: &World) -> Option<Margin> {
        let ground = |fix: &Fix| world.terrain.height(fix.place).map_or(f64::NAN, |g| g.0);
        let is_down = |fix: &&Fix| fix.amsl.0 - ground(fix) <= GROUNDED_M;
        let on = |part: &dyn Fn(usize) -> bool| -> Vec<&Fix> {
            let all = (0..self.fixes().len()).filter(|&index| part(index));
            all.map(|index| &self.fixes()[index]).collect()
        };
        let parts = match self.airframe {
            Airframe::Plane => [
                on(&|index| self.rises(index)),
                on(&|index| self.glides(index)),
            ],
            Airframe::Copter | Airframe::Vtol => return None,
        };
        let [rises, glides] = &parts;
        let lift_off = rises.iter().rev().copied().find(is_down);
        let lift_off = lift_off.or(rises.first().copied());
        let touchdown = glides.iter().copied().find(is_down);
        let touchdown = touchdown.or(glides.last().copied());
        let spare = |part: &[&Fix], runway: Option<&Fix>| -> Vec<(f64, f64, Moment)> {
            let runway_m = runway.map_or(f64::NAN, ground);
            let required_m = |fix: &Fix| {
                let share_m = SLOPE_SHARE * (fix.amsl.0 - runway_m);
                share_m.min(spec.area.min_agl.0)
            };
            let up = part.iter().filter(|fix| !is_down(fix));
            up.map(|fix| (fix.amsl.0 - ground(fix), required_m(fix), moment(fix)))
                .collect()
        };
        let mut all = spare(rises, lift_off);
        all.extend(spare(glides, touchdown));
        let left_m = |of: &(f64, f64, Moment)| of.0 - of.1;
        // What is not a number is the worst of all.
        let badness = |of: &(f64, f64, Moment)| match left_m(of) {
            left_m if left_m.is_nan() => f64::INFINITY,
            left_m => -left_m,
        };
        let (value, bound_m, at) = all
            .into_iter()
            .max_by(|a, b| badness(a).total_cmp(&badness(b)))?;
        let required = Requirement::at_least(Limit::TakeoffLandingClearance, bound_m, "m");
        Some(required.margin(self.id(), value, Some(at)))
    }

    /// Times without any position. One that this program was stopped in is not the silence
    /// of the vehicle, and its note says so.
    fn gaps(&self, stops: &[(f64, f64)]) -> Vec<Margin> {
        let first = self.fixes().first();
        let before = first.map(|first| {
            let since_s = self.since_s();
            (first.t_s - since_s, since_s, first)
        });
        let until_s = self.flight.flown.until_s;
        let after = self.fixes().last().zip(until_s);
        let after = after.map(|(last, until_s)| (until_s - last.t_s, last.t_s, last));
        let pairs = self.fixes().windows(2);
        let longest = pairs
            .map(|pair| (pair[0].until_s(&pair[1]), pair[0].t_s, &pair[0]))
            .chain(before)
            .chain(after)
            .max_by(|a, b| a.0.total_cmp(&b.0));
        let Some((gap_s, from_s, fix)) = longest else {
            return Vec::new();
        };
        let to_s = from_s + gap_s;
        let share_s = |&(from, until): &(f64, f64)| until.min(to_s) - from.max(from_s);
        let stopped_s: f64 = stops.iter().map(share_s).map(|s| s.max(0.0)).sum();
        let required = Requirement::at_most(Limit::Flown(Flown::Gap), GAP_S, "s");
        let mut gap = required.margin(self.id(), gap_s, Some(moment(fix)));
        if stopped_s > 0.0 {
            gap.note = format!(
                "(the recording program was stopped for {stopped_s:.0} s of it; the vehicle was not heard)"
            );
        }
        vec![gap]
    }

    /// The worst of values; one that is not a number is the worst of all.
    pub(crate) fn worst<'f>(
        &self,
        required: Requirement,
        values: impl Iterator<Item = (f64, &'f Fix)>,
    ) -> Option<Margin> {
        let badness = |value: f64| match required.sense {
            _ if value.is_nan() => f64::INFINITY,
            Sense::AtLeast => required.bound - value,
            Sense::AtMost => value - required.bound,
        };
        let (value, fix) = values.max_by(|a, b| badness(a.0).total_cmp(&badness(b.0)))?;
        let note = if value.is_nan() {
            "no elevation data there".to_owned()
        } else {
            String::new()
        };
        Some(Margin {
            note,
            ..required.margin(self.id(), value, Some(moment(fix)))
        })
    }

    fn count<'f>(&self, required: Requirement, mut fixes: impl Iterator<Item = &'f Fix>) -> Margin {
        let first = fixes.next();
        let more = u32::try_from(fixes.count()).unwrap_or(u32::MAX);
        let value = first.map_or(0.0, |_| 1.0 + f64::from(more));
        required.margin(self.id(), value, first.map(moment))
    }

    /// The motions in the air between two positions; of a gap its ends alone.
    fn segments(&self, world: &World) -> Vec<(Segment, usize)> {
        let is_up = |index: usize| {
            let fix = &self.fixes()[index];
            let ground = world.terrain.height(fix.place);
            ground.map_or(true, |ground| fix.amsl.above_ground(ground).0 > GROUNDED_M)
        };
        (1..self.points.len())
            .filter(|&index| is_up(index - 1) || is_up(index))
            .flat_map(|index| {
                let (from, to) = (&self.fixes()[index - 1], &self.fixes()[index]);
                let first = (from.t_s, self.points[index - 1].axes_m());
                let last = (to.t_s, self.points[index].axes_m());
                let pieces = match is_gap(from, to) {
                    true => vec![(first, first), (last, last)],
                    false => vec![(first, last)],
                };
                let segments = pieces.into_iter().map(|(a, b)| Segment::between(a, b));
                segments
                    .map(move |segment| (segment, index))
                    .collect::<Vec<_>>()
            })
            .collect()
    }
}

/// The least distance of two vehicles at the same time, both in the air.
pub(crate) fn separation(
    limit: &Separation,
    world: &World,
    first: &FlownTrack<'_>,
    second: &FlownTrack<'_>,
) -> Option<Margin> {
    let (a, b) = (first.segments(world), second.segments(world));
    let mut best: Option<(f64, f64, usize)> = None;
    let mut conflict = false;
    let mut from = 0;
    for (segment, index) in &a {
        while from < b.len() && b[from].0.t1_s < segment.t0_s {
            from += 1;
        }
        for (other, _) in b[from..].iter().take_while(|(o, _)| o.t0_s <= segment.t1_s) {
            let near = match limit.vertical_m {
                None => closest_approach(segment, other, 0.0),
                Some(vertical_m) => {
                    let least = min_ratio(segment, other, 0.0, limit.distance_m, vertical_m);
                    conflict |= least.is_some_and(|least| least.value < 1.0);
                    closest_horizontal(segment, other, 0.0, vertical_m)
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
        ..moment(&first.fixes()[index])
    };
    let required = Requirement::at_least(Limit::Separation, limit.distance_m, "m");
    Some(Margin {
        other: Some(second.id().to_owned()),
        ok: match limit.vertical_m {
            None => value >= limit.distance_m,
            Some(_) => !conflict,
        },
        ..required.margin(first.id(), value, Some(at))
    })
}
