//! Areas, corridors and search patterns: what the encoded items show of the ground, and which legs
//! they fly.

use super::MissionCheck;
use super::aim::Aim;
use crate::geodesy::{Amsl, EastNorth, PlanPoint};
use crate::mission::{self, command};
use crate::spec::{MissionSpec, Sensor, Sweep, SweepShape, Task};
use crate::tasks::{Cell, Cells, Gap, Pass, SweepLine, far_apart, gaps, lay_out, seen_by};
use crate::verify::measure::segment::{Phase, Segment};
use crate::verify::{Limit, Margin, Moment, Requirement};
use crate::world::World;

/// Least share of an area that is seen at the overlap asked for, percent.
const MIN_PERCENT: f64 = 99.5;
/// Gaps that are named.
const NAMED: usize = 3;
/// Motions that are shorter are none over the ground, metres.
const MIN_M: f64 = 1e-6;
/// Distance of the places of a leg that are looked for, metres.
const EVERY_M: f64 = 20.0;
/// A leg may be lower than the height asked for by this and the tolerance of paths, metres: whole
/// quarters of a metre.
const LOWER_M: f64 = 0.25;
/// A leg is not flown where the vehicle is higher than this many times the height asked for.
const MAX_ABOVE: f64 = 1.5;

/// The margins of all tasks with lines.
pub(crate) fn margins(
    spec: &MissionSpec,
    world: &World,
    contracts: &[MissionCheck<'_>],
) -> Vec<Margin> {
    let tasks = spec.tasks.iter();
    let with_lines = tasks.filter_map(|task| Some((task, task.sweep.as_ref()?)));
    let margins = with_lines.map(|(task, sweep)| match &sweep.sensor {
        Some(sensor) => covered(task, (sweep, sensor), (spec, world), contracts),
        None => flown(task, sweep, (spec, world), contracts),
    });
    margins.collect()
}

/// The share of an area that is seen as often as its overlaps ask for.
fn covered(
    task: &Task,
    (sweep, sensor): (&Sweep, &Sensor),
    (spec, world): (&MissionSpec, &World),
    contracts: &[MissionCheck<'_>],
) -> Margin {
    let limit = Limit::AreaCovered(task.id.clone());
    let Some(cells) = Cells::of(sweep, world) else {
        return Margin::unjudged("", limit, "no ground under a part of the area");
    };
    let able = contracts.iter().filter(|check| task.is_for(check.vehicle));
    let (mut passes, mut turned) = (Vec::new(), Vec::new());
    for check in able {
        let (of_one, by) = check.passes(sensor);
        passes.extend(of_one);
        turned.extend(by.map(|item| check.turned_away(item)));
    }
    let seen = seen_by(&cells, sensor, sweep.agl.0, &passes);
    // How often a place is seen says nothing of overlaps below one half, and little of those between
    // two counts.
    let apart = far_apart(&cells, sensor, sweep.agl.0, &passes);
    let missing: Vec<bool> = (seen.iter().zip(apart))
        .map(|(lines, is_apart)| *lines < sensor.lines() || is_apart)
        .collect();
    let share =
        count(missing.iter().filter(|missing| !**missing).count()) / count(missing.len().max(1));
    let gaps = gaps(&cells, &missing);
    let at = gaps.first().map(|gap| Moment {
        place: world.frame.from_plan(gap.at),
        amsl: world
            .terrain
            .height_at(&world.frame, gap.at)
            .unwrap_or(Amsl(0.0)),
        t_s: 0.0,
        item: 0,
    });
    let required = Requirement::at_least(limit, MIN_PERCENT, "%");
    let mut margin = required.margin("", 100.0 * share, at);
    let mut notes = match margin.ok {
        true => Vec::new(),
        false => turned,
    };
    notes.extend(named(&gaps, world));
    if !margin.ok {
        notes.extend(closed_over(&cells, sweep.agl.0, (spec, world)));
    }
    margin.note = notes.join("; ");
    margin
}

/// The zones that are always closed at the height of the lines over a part of an area.
fn closed_over(cells: &Cells, agl_m: f64, (spec, world): (&MissionSpec, &World)) -> Option<String> {
    let zones = spec.no_fly.iter().zip(&world.zones);
    let closed = zones.filter(|(_, zone)| {
        let is_closed = |cell: &Cell| {
            let (from_m, below_m) = zone.closed_m(cell.ground_m);
            (from_m..below_m).contains(&(cell.ground_m + agl_m)) && zone.holds(cell.at)
        };
        zone.active_s.is_none() && cells.cells.iter().any(is_closed)
    });
    let ids: Vec<String> = closed.map(|(zone, _)| format!("`{}`", zone.id)).collect();
    (!ids.is_empty()).then(|| {
        format!(
            "no-fly zone {} is closed {agl_m} m above ground over a part of the area (allowed: a hole around it, another agl_m, or another polygon)",
            ids.join(", ")
        )
    })
}

/// The largest gaps with place and size.
fn named(gaps: &[Gap], world: &World) -> Option<String> {
    let name = |gap: &Gap| {
        let place = world.frame.from_plan(gap.at);
        format!(
            "{:.0} m2 ({:.0} m east-west, {:.0} m north-south) at {:.5}, {:.5}",
            gap.area_m2, gap.size_m[0], gap.size_m[1], place.lat_deg, place.lon_deg
        )
    };
    let largest: Vec<String> = gaps.iter().take(NAMED).map(name).collect();
    match gaps.len() {
        0 => None,
        1 => Some(format!("gap of {}", largest[0])),
        count => Some(format!("{count} gaps, the largest: {}", largest.join("; "))),
    }
}

/// A motion before another one.
#[derive(Clone, Copy, Default)]
struct Before<'a> {
    segment: Option<&'a Segment>,
    /// Index of the item that set the distance of pictures.
    switch: Option<usize>,
    /// Whether the ground is seen on it.
    is_on: bool,
    /// Whether pictures were taken on it, of the ground below.
    takes_pictures: bool,
}

impl MissionCheck<'_> {
    /// The parts of the flight on which a sensor sees the ground, and the first item that
    /// turned it away where it would.
    fn passes(&self, sensor: &Sensor) -> (Vec<Pass>, Option<usize>) {
        let mut passes: Vec<Pass> = Vec::new();
        let mut before = Before::default();
        let (mut aim, mut first_turned) = (Aim::default(), None);
        let flown = |segment: &&Segment| {
            let length_m = segment.from.at.distance_m(segment.to.at);
            segment.flown && segment.phase == Phase::Route && length_m > MIN_M
        };
        for segment in self.flight.segments.iter().filter(flown) {
            let switch = self.switch_before(segment.row);
            let trigger_m = switch.and_then(|item| self.trigger_m(item));
            aim = self.aim_on(aim, segment.row);
            let would_see = sensor.along.is_none() || trigger_m.is_some();
            let turned = self.turned_by(&aim, segment).filter(|_| would_see);
            first_turned = first_turned.or(turned);
            let is_on = would_see && turned.is_none();
            let is_first = before.segment.is_none() || before.switch != switch;
            let goes_on = |last| !is_first && before.is_on && !self.rests_between(last, segment);
            let is_same = before.segment.is_some_and(goes_on);
            let takes_one = is_first && switch.is_some_and(|item| self.takes_one(item));
            // The picture with which a distance is ended or changed.
            let ended = passes
                .last_mut()
                .filter(|_| takes_one && before.takes_pictures);
            if let Some(pass) = ended {
                pass.ends[1] = true;
            }
            if is_on && !is_same {
                passes.push(Pass {
                    legs: Vec::new(),
                    trigger_m,
                    ends: [takes_one, false],
                });
            }
            if let (true, Some(pass)) = (is_on, passes.last_mut()) {
                pass.legs.push((segment.from, segment.to));
            }
            before = Before {
                segment: Some(segment),
                switch,
                is_on,
                takes_pictures: is_on && trigger_m.is_some(),
            };
        }
        (passes, first_turned)
    }

    /// Index of the last item before a row that sets the distance of pictures.
    fn switch_before(&self, row: usize) -> Option<usize> {
        let items = self.mission.items.get(..row.saturating_sub(1))?;
        items
            .iter()
            .rposition(|item| item.command == command::DO_SET_CAM_TRIGG_DIST)
    }

    /// The distance of pictures that an item sets; none where it ends them, or may not run.
    fn trigger_m(&self, item: usize) -> Option<f64> {
        if self.held_up_by(item).is_some() {
            return None;
        }
        let distance_m = f64::from(self.mission.items[item].params[0]);
        (distance_m > 0.0 && distance_m.is_finite()).then_some(distance_m)
    }

    /// Whether an item takes a picture at once.
    fn takes_one(&self, item: usize) -> bool {
        (self.mission.items[item].params[2] - 1.0).abs() < 0.5
    }

    /// Whether the vehicle rests between two motions.
    fn rests_between(&self, before: &Segment, after: &Segment) -> bool {
        let is_between = |from_s: f64| (before.to_s - 1e-6..=after.from_s + 1e-6).contains(&from_s);
        after.from_s > before.to_s + 1e-6
            || self.flight.rests.iter().any(|rest| is_between(rest.from_s))
    }
}

fn too_low(leg: usize, sweep: &Sweep, min_m: f64) -> String {
    format!(
        "leg {leg} is flown lower than {min_m:.1} m above ground (agl_m {} less mission.tolerance_m)",
        sweep.agl.0
    )
}

/// How near a place of a leg must be passed, and at which heights above ground, metres.
type Near = (f64, std::ops::RangeInclusive<f64>);

/// How many legs of a line one vehicle flies in order, and for which it is too far away.
fn flown(
    task: &Task,
    sweep: &Sweep,
    (spec, world): (&MissionSpec, &World),
    contracts: &[MissionCheck<'_>],
) -> Margin {
    let layout = lay_out(sweep, world);
    let lines = layout.lines.iter();
    let total: usize = lines.clone().map(|line| line.points.len() - 1).sum();
    let near_m = mission::corner_cut_m(&spec.mission).max(spec.mission.tolerance_m) + 1.0;
    let min_m = sweep.agl.0 - spec.mission.tolerance_m - LOWER_M;
    let best = contracts
        .iter()
        .filter(|check| task.is_for(check.vehicle))
        .map(|check| {
            let legs = |line: &SweepLine, min_m: f64| {
                let near = (near_m, min_m..=MAX_ABOVE * sweep.agl.0);
                let forwards = check.legs(&line.points, &near);
                let backwards = match line.is_reversible {
                    true => {
                        let turned: Vec<EastNorth> = line.points.iter().rev().copied().collect();
                        check.legs(&turned, &near)
                    }
                    false => 0,
                };
                forwards.max(backwards)
            };
            let from = |min_m: f64| lines.clone().map(|line| legs(line, min_m)).sum::<usize>();
            let flown = from(min_m);
            let at_any_height = if flown < total {
                from(f64::NEG_INFINITY)
            } else {
                flown
            };
            (flown, at_any_height, check)
        })
        .max_by_key(|(flown, at_any_height, _)| (*flown, *at_any_height));
    let required = Requirement::at_least(Limit::Task(task.id.clone()), count(total), "legs");
    let what = match sweep.shape {
        SweepShape::Search(_) => "the pattern",
        _ => "the corridor",
    };
    match best {
        Some((_, 0, _)) | None => Margin {
            note: format!("no vehicle flies {what}"),
            ..required.margin("", 0.0, None)
        },
        Some((legs, at_any_height, check)) => Margin {
            note: match (legs < total, at_any_height > legs) {
                (true, true) => too_low(legs + 1, sweep, min_m),
                (true, false) => format!(
                    "leg {} is not flown in order within {near_m:.0} m",
                    legs + 1
                ),
                (false, _) => String::new(),
            },
            ..required.margin(check.id(), count(legs), None)
        },
    }
}

impl MissionCheck<'_> {
    /// How many legs of a line are flown, each after the one before it.
    fn legs(&self, line: &[EastNorth], near: &Near) -> usize {
        let flown = |segment: &&Segment| segment.flown && segment.to_s.is_finite();
        let segments: Vec<&Segment> = self.flight.segments.iter().filter(flown).collect();
        let mut cursor = (0, 0.0);
        for (number, leg) in line.windows(2).enumerate() {
            let pieces = (leg[0].distance_m(leg[1]) / EVERY_M).ceil().max(1.0);
            let mut piece = 0.0;
            while piece <= pieces {
                let share = piece / pieces;
                let at = EastNorth {
                    east_m: leg[0].east_m + share * (leg[1].east_m - leg[0].east_m),
                    north_m: leg[0].north_m + share * (leg[1].north_m - leg[0].north_m),
                };
                match self.passed(&segments, cursor, at, near) {
                    Some(next) => cursor = next,
                    None => return number,
                }
                piece += 1.0;
            }
        }
        line.len() - 1
    }

    /// The first motion from a cursor on that passes a place, and where on it.
    fn passed(
        &self,
        segments: &[&Segment],
        (first, from): (usize, f64),
        at: EastNorth,
        (near_m, above_m): &Near,
    ) -> Option<(usize, f64)> {
        let height_m = |point: PlanPoint| {
            let ground = self.world.terrain.height_at(&self.world.frame, point.at);
            ground.map_or(f64::INFINITY, |ground| point.amsl.above_ground(ground).0)
        };
        (first..segments.len()).find_map(|index| {
            let segment = segments[index];
            let least = if index == first { from } else { 0.0 };
            let (from, to) = (segment.from.at, segment.to.at);
            let square = (to.east_m - from.east_m).powi(2) + (to.north_m - from.north_m).powi(2);
            let along = (at.east_m - from.east_m) * (to.east_m - from.east_m)
                + (at.north_m - from.north_m) * (to.north_m - from.north_m);
            let share = if square > 0.0 { along / square } else { 0.0 };
            let share = share.clamp(least, 1.0);
            let point = segment.at(share);
            let is_near = point.at.distance_m(at) <= *near_m && above_m.contains(&height_m(point));
            is_near.then_some((index, share))
        })
    }
}

fn count(number: usize) -> f64 {
    f64::from(u32::try_from(number).unwrap_or(u32::MAX))
}
