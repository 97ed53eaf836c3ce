//! What a vehicle in flight has before it.

use super::look::Seen;
use crate::cli::fly::Sorties;
use crate::flight::{self, Reference, Waypoint};
use crate::geodesy::{Amsl, EastNorth, PlanPoint};
use crate::link::Position;
use crate::mission::{Home, Item, VehicleMission, command, frame};
use crate::verify::Track;

/// Lower above its home than this a vehicle stands on the ground, metres.
const AIRBORNE_M: f64 = 1.5;
/// A waypoint this near a goal is the goal, metres.
const GOAL_M: f64 = 2.0;

/// What one vehicle has before it.
#[derive(Clone, Debug)]
pub(super) struct Course {
    /// Its index in the spec.
    pub(super) vehicle: usize,
    /// What it holds; its home is that of the plan.
    pub(super) held: VehicleMission,
    /// Index of the item that it flies to.
    pub(super) at: usize,
    /// Where it is; for one that rises to its route, the top of that.
    pub(super) here: PlanPoint,
    /// How long it rises before it is there, seconds.
    pub(super) rises_s: f64,
    /// Whether its takeoff is not over: it must not be sent on from low down.
    pub(super) takes_off: bool,
    /// Where it was since the threat was told, as far as it is now.
    pub(super) behind: Vec<PlanPoint>,
    /// Whether it flies its mission; else it holds, or somebody flies it.
    pub(super) in_mission: bool,
    /// Where the leg to the item that it flies to begins.
    pub(super) origin: PlanPoint,
    /// The places ahead in the air, each with the index of its item.
    pub(super) ahead: Vec<(usize, PlanPoint)>,
    /// Whether it lands after the last of them.
    pub(super) lands: bool,
    /// Whether it still stands on the ground.
    pub(super) stands: bool,
    /// Index into `ahead` of a goal that it turns back at.
    pub(super) via: Option<usize>,
    /// A wing ends its way on a circle so wide, metres; 0 for who does not.
    pub(super) circle_m: f64,
}

/// Where a course is left for a new path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parting {
    /// Where.
    pub(super) point: PlanPoint,
    /// Places of `ahead` that lie before it.
    pub(super) kept: usize,
    /// The way to it, metres.
    pub(super) way_m: f64,
}

/// Since when a threat is held against the fleet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Since {
    /// Milliseconds since 1970.
    pub(super) unix_ms: u64,
    /// How much faster than the clock the time of the vehicles goes.
    pub(super) pace: f64,
}

impl Since {
    /// Where a vehicle was since then: before it was heard first, straight on as it flew then.
    fn behind(&self, sorties: &Sorties, seen: &Seen) -> Vec<PlanPoint> {
        let flown = seen.flown.iter().map(|(_, position)| position);
        let mut behind: Vec<PlanPoint> = flown.map(|at| point(sorties, at)).collect();
        if let (Some((heard_ms, first)), Some(from)) = (seen.flown.first(), behind.first()) {
            #[expect(clippy::cast_precision_loss, reason = "milliseconds of one command")]
            let before_s = heard_ms.saturating_sub(self.unix_ms) as f64 / 1000.0 * self.pace;
            let [north_m, east_m, _] = first
                .velocity_cmps
                .map(|cmps| f64::from(cmps) / 100.0 * before_s);
            let then = PlanPoint::new(
                from.at.east_m - east_m,
                from.at.north_m - north_m,
                from.amsl,
            );
            behind.insert(0, then);
        }
        behind
    }
}

impl Course {
    /// From what a vehicle holds, the item it flies to, and where it is; or why nothing can
    /// be said of it.
    pub(super) fn new(
        sorties: &Sorties,
        vehicle: usize,
        planned: &VehicleMission,
        seen: &Seen,
        since: &Since,
    ) -> Result<Self, String> {
        let held = VehicleMission {
            items: seen.onboard.mission.clone(),
            ..planned.clone()
        };
        let returns = |item: &Item| item.command == command::NAV_RETURN_TO_LAUNCH;
        if held.items.iter().any(returns) {
            return Err("flies a NAV_RETURN_TO_LAUNCH, on a way of its own".to_owned());
        }
        let first = usize::from(planned.autopilot.first_row());
        let row = (usize::from(seen.seq) + first).max(1);
        let mut here = point(sorties, &seen.position);
        let nowhen = Track {
            vehicle: String::new(),
            moments: Vec::new(),
        };
        let reference = Reference::new(&held, &nowhen, &sorties.world);
        let waypoints = reference.waypoints;
        let ahead_from = waypoints.iter().position(|w| w.item >= row);
        let ahead_from = ahead_from.unwrap_or(waypoints.len());
        let in_air = waypoints.len() - usize::from(reference.lands).min(waypoints.len());
        let place_of = |w: &Waypoint| (w.item - 1, w.point);
        let mut ahead: Vec<(usize, PlanPoint)> = waypoints
            .get(ahead_from.max(1)..in_air)
            .unwrap_or_default()
            .iter()
            .map(place_of)
            .collect();
        let before = ahead_from.saturating_sub(1);
        // A mission that was given in the air does not begin at home.
        let origin = waypoints.get(before.max(1)).filter(|_| before > 0);
        let origin = origin.map_or(here, |w| w.point);
        let stands = seen.position.above_home_m() < AIRBORNE_M;
        let mut rises_s = 0.0;
        let rising = held.items.get(row - 1).is_some_and(is_takeoff);
        if let (true, Some(&(_, top))) = (rising, ahead.first()) {
            let climb_mps = sorties.file.spec.vehicles[vehicle].climb_mps;
            rises_s = (top.amsl.0 - here.amsl.0).max(0.0) / climb_mps;
            here = PlanPoint { at: here.at, ..top };
            ahead.remove(0);
        }
        let circle_m = waypoints.last().map_or(0.0, |last| last.radius_m);
        let station = sorties.world.stations.get(vehicle);
        let via = station.and_then(|station| {
            let is_goal = |(_, point): &(usize, PlanPoint)| point.distance_m(station.goal) < GOAL_M;
            let found = ahead.iter().position(is_goal)?;
            (found + 1 < ahead.len()).then_some(found)
        });
        Ok(Self {
            vehicle,
            held,
            at: row - 1,
            here,
            rises_s,
            takes_off: rising,
            behind: since.behind(sorties, seen),
            in_mission: flight::is_mission(planned, seen.beat.custom_mode),
            origin: if rising { here } else { origin },
            ahead,
            lands: reference.lands,
            stands,
            via,
            circle_m,
        })
    }

    /// Where it is and every place ahead.
    pub(super) fn points(&self) -> Vec<PlanPoint> {
        let ahead = self.ahead.iter().map(|(_, point)| *point);
        std::iter::once(self.here).chain(ahead).collect()
    }

    /// The length of the way ahead in the air, metres.
    pub(super) fn way_m(&self) -> f64 {
        let points = self.points();
        points
            .windows(2)
            .map(|pair| pair[0].distance_m(pair[1]))
            .sum()
    }

    /// Whether its way comes nearer than a distance to a place.
    pub(super) fn meets(&self, center: EastNorth, distance_m: f64) -> bool {
        comes_near(&self.points(), center, distance_m)
    }

    /// Whether it was nearer than a distance to a place since the threat was told.
    pub(super) fn was_near(&self, center: EastNorth, distance_m: f64) -> bool {
        comes_near(&self.behind, center, distance_m)
    }

    /// The same of its way as far as a parting.
    pub(super) fn meets_before(
        &self,
        parting: &Parting,
        center: EastNorth,
        distance_m: f64,
    ) -> bool {
        let mut points = self.points();
        points.truncate(parting.kept + 1);
        points.push(parting.point);
        comes_near(&points, center, distance_m)
    }

    /// Where it is after some metres of its way; `None` beyond the end, or where it comes
    /// to rest before.
    pub(super) fn after(&self, mut gone_m: f64) -> Option<Parting> {
        let way_m = gone_m;
        let points = self.points();
        for (kept, pair) in points.windows(2).enumerate() {
            let length_m = pair[0].distance_m(pair[1]);
            if gone_m < length_m {
                let share = gone_m / length_m;
                let mix = |a: f64, b: f64| a + (b - a) * share;
                let point = PlanPoint::new(
                    mix(pair[0].at.east_m, pair[1].at.east_m),
                    mix(pair[0].at.north_m, pair[1].at.north_m),
                    Amsl(mix(pair[0].amsl.0, pair[1].amsl.0)),
                );
                return Some(Parting { point, kept, way_m });
            }
            gone_m -= length_m;
        }
        None
    }

    /// The legs that are planned anew from a parting, end to end.
    pub(super) fn legs(&self, parting: &Parting) -> Vec<(PlanPoint, PlanPoint)> {
        let Some(&(_, last)) = self.ahead.last() else {
            return Vec::new();
        };
        let via = self.via.filter(|via| *via >= parting.kept);
        match via.and_then(|via| self.ahead.get(via)) {
            Some(&(_, via)) => vec![(parting.point, via), (via, last)],
            None => vec![(parting.point, last)],
        }
    }

    /// Items from the one at work on, with altitudes above the sea instead of above home,
    /// each with its row.
    pub(super) fn items_ahead(&self) -> Vec<(usize, Item)> {
        let items = self.held.items.iter().enumerate().skip(self.at);
        items
            .filter(|(_, item)| item.command != command::NAV_DELAY)
            .filter(|(_, item)| !is_takeoff(item))
            .map(|(index, item)| (index + 1, above_the_sea(item, &self.held.home)))
            .collect()
    }

    /// The same of the first places ahead.
    pub(super) fn items_kept(&self, parting: &Parting) -> Vec<Item> {
        let places = self.ahead.iter().take(parting.kept);
        let items = places.filter_map(|(index, _)| self.held.items.get(*index));
        items
            .map(|item| above_the_sea(item, &self.held.home))
            .collect()
    }

    /// Index of the first item that is not kept.
    pub(super) fn kept_end(&self, parting: &Parting) -> usize {
        let last = parting.kept.checked_sub(1);
        let last = last.and_then(|last| self.ahead.get(last));
        let none = || {
            // A takeoff that is under way is not begun again.
            let items = self.held.items.iter().skip(self.at);
            let takes_no_way = |item: &&Item| is_takeoff(item) || item.place().is_none();
            self.at + items.take_while(takes_no_way).count()
        };
        last.map_or_else(none, |(index, _)| index + 1)
    }
}

/// A position in planning coordinates.
fn point(sorties: &Sorties, position: &Position) -> PlanPoint {
    PlanPoint {
        at: sorties.world.frame.to_plan(position.place()),
        amsl: position.amsl(),
    }
}

/// Whether an item is a takeoff.
pub(super) fn is_takeoff(item: &Item) -> bool {
    [command::NAV_TAKEOFF, command::NAV_VTOL_TAKEOFF].contains(&item.command)
}

/// An item with an altitude above the sea, if it has one above home.
fn above_the_sea(item: &Item, home: &Home) -> Item {
    let mut item = *item;
    if item.place().is_some() && frame::canonical(item.frame) == frame::GLOBAL_RELATIVE_ALT {
        item.frame = frame::GLOBAL;
        item.z += home.amsl_m;
    }
    item
}

/// Whether a way comes nearer than a distance to a place.
fn comes_near(way: &[PlanPoint], center: EastNorth, distance_m: f64) -> bool {
    let pairs = way.windows(2).map(|pair| (pair[0].at, pair[1].at));
    let alone = way.last().map(|last| (last.at, last.at));
    pairs
        .chain(alone)
        .any(|(a, b)| away_m(center, a, b) < distance_m)
}

/// Distance of a point of the plane from a leg, metres.
fn away_m(from: EastNorth, a: EastNorth, b: EastNorth) -> f64 {
    let (east, north) = (b.east_m - a.east_m, b.north_m - a.north_m);
    let length_sq = east * east + north * north;
    let gone = (from.east_m - a.east_m) * east + (from.north_m - a.north_m) * north;
    let share = if length_sq > 0.0 {
        (gone / length_sq).clamp(0.0, 1.0)
    } else {
        0.0
    };
    from.distance_m(EastNorth {
        east_m: a.east_m + share * east,
        north_m: a.north_m + share * north,
    })
}
