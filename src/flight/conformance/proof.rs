//! What the positions of a record prove: that the plan was flown, from home to its end. What a
//! verdict has proven of a plan holds near its way alone, and what a record says of an end
//! without positions that show it is no more than a word.

use super::takeoff::{TakeoffTube, at_its_fastest};
use super::{FlownTrack, GAP_S};
use crate::autopilot::{Airframe, Autopilot, ParameterRow, SLOPE_MIN, facts, parameter};
use crate::flight::launch::readiness::STANDS_M;
use crate::flight::record::Fix;
use crate::flight::session::arrival;
use crate::flight::session::arrival::{ARRIVED_M, STILL_MPS, TURNED_RAD};
use crate::flight::session::end::{End, may_last_s};
use crate::path::VehicleLimits;
use crate::spec::{AltitudeReference, Finish, MissionSpec, Vehicle};
use crate::verify::{Flown, Limit, Margin, Requirement};
use crate::world::World;

/// Farther than this from its way a copter has left what was verified, metres: corners are cut
/// by up to 10 m (`mission.tolerance_m` as the parameters have it), positions are some metres
/// off. Real ArduCopters were at most 1.5 m beside their way.
pub(crate) const CROSS_TRACK_M: f64 = 30.0;
/// Greatest cross-track error, in turn radii, of a wing that turns late by the whole corner. Real ArduPlane, 18 m/s: 0.6 at a right angle, 1.4 at 120 degrees, 2.2 at 150; and a
/// QuadPlane that the wind drove away as it climbed, 59 m or 1.1.
const TURNS: f64 = 2.0;
/// A vehicle that landed is not higher or lower than this over the ground of the elevation
/// data, metres: home may differ by 5 m, and a barometer drifts in flight. Real ones: 2.4 m.
const GROUND_M: f64 = 10.0;
/// Faster than this many times its greatest speed no vehicle gets from one place to another.
const FASTER: f64 = 2.0;

/// How far from its way a vehicle may be, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tube {
    pub(crate) across_m: f64,
    pub(crate) up_m: f64,
}

impl Tube {
    pub(crate) fn of(vehicle: &Vehicle) -> Self {
        if !vehicle.airframe.has_wing() {
            return Self {
                across_m: CROSS_TRACK_M,
                up_m: CROSS_TRACK_M,
            };
        }
        let turns_m = TURNS * VehicleLimits::of(&at_its_fastest(vehicle)).turn_radius_m;
        let slopes_mps = vehicle.climb_mps.max(vehicle.descent_mps);
        let slope_min_m = parameter(SLOPE_MIN[0]).map_or(0.0, ParameterRow::default_si);
        let lags = Autopilot::ALL.map(|autopilot| facts(autopilot, vehicle.airframe));
        let lags_s = lags.map(|facts| facts.behaviour.altitude_lag_s.value(None));
        let lag_s = lags_s.into_iter().fold(0.0, f64::max);
        Self {
            across_m: CROSS_TRACK_M.max(turns_m),
            up_m: CROSS_TRACK_M.max(slope_min_m + lag_s * slopes_mps),
        }
    }
}

/// How far beside its way a vehicle may be, metres.
pub(crate) fn across_m(vehicle: &Vehicle) -> f64 {
    Tube::of(vehicle).across_m
}

/// How a plane may leave its climb-out early.
#[derive(Clone, Copy, Debug, PartialEq)]
struct ClimbOut {
    /// When it has passed the place after it, seconds after T0.
    until_s: f64,
    /// By how much it may be off the legs until then, metres.
    wide_m: f64,
}

impl FlownTrack<'_> {
    /// Since when its positions are looked for, seconds after T0.
    pub(crate) fn since_s(&self) -> f64 {
        let heard_s = self.flight.flown.since_s;
        heard_s.unwrap_or_else(|| self.departs_s())
    }

    /// When it was to depart, seconds after T0.
    fn departs_s(&self) -> f64 {
        let first = self.flight.plans.first();
        let home = first.and_then(|plan| plan.reference.waypoints.first());
        home.map_or(0.0, |home| home.t_s)
    }

    /// Whether it ended as planned by its own word, and the last positions show it.
    pub(crate) fn ends_as_planned(&self) -> bool {
        let Some(part) = self.parts().last() else {
            return false;
        };
        match self.flight.flown.end {
            End::Landed => part.plan.lands,
            End::Loitering => !part.plan.lands,
            _ => false,
        }
    }

    /// Whether it was ordered to hold, to land or to return: it leaves its path, and does not end as planned.
    pub(super) fn leaves_as_ordered(&self) -> bool {
        let left = [
            End::Held,
            End::StoppedAfterHold,
            End::LandedEarly,
            End::Returned,
            End::ReturnedToRally,
        ];
        left.contains(&self.flight.flown.end)
    }

    /// What the positions must show of a flight besides the limits of the spec; `ends_s` is when
    /// the planned flight of the fleet ends, `off_s` what clocks may be off.
    pub(crate) fn proof(
        &self,
        spec: &MissionSpec,
        world: &World,
        (ends_s, off_s): (f64, f64),
    ) -> Vec<Margin> {
        let (Some(vehicle), false) = (self.vehicle, self.fixes().is_empty()) else {
            return Vec::new();
        };
        let tube = Tube::of(vehicle);
        let end = &self.flight.flown.end;
        let mut margins: Vec<Margin> = self.beginning(vehicle, world).into_iter().collect();
        margins.extend(self.leaps(vehicle, off_s));
        if !self.leaves_as_ordered() {
            margins.extend(self.off_the_way(spec, tube));
        }
        if matches!(end, End::Landed | End::Loitering) {
            margins.push(self.missed(tube));
            margins.extend(self.goal(vehicle, tube));
            margins.extend(self.ending(world));
            margins.extend(self.place_to_land(vehicle, spec));
            margins.extend(self.lateness(ends_s));
        }
        margins
    }

    /// The first position is at home, or no further than it has flown since its departure.
    fn beginning(&self, vehicle: &Vehicle, world: &World) -> Option<Margin> {
        let (first, at, home) = (
            self.fixes().first()?,
            self.points.first()?,
            self.sites.as_ref()?,
        );
        let ground = world.terrain.height(first.place);
        let up_m = ground.map_or(f64::NAN, |ground| first.amsl.above_ground(ground).0);
        let flown_s = (first.t_s - self.since_s()).clamp(0.0, GAP_S);
        let reach_m = STANDS_M + flown_s * fastest_mps(vehicle);
        let required = at_most(Flown::FirstPosition, reach_m, "m");
        let away_m = home.home.at.distance_m(at.at).hypot(up_m);
        self.worst(required, std::iter::once((away_m, first)))
    }

    /// Between two positions no vehicle is much faster than it can be, in its own time as far as
    /// that is not off by more than clocks are.
    fn leaps(&self, vehicle: &Vehicle, off_s: f64) -> Option<Margin> {
        let required = at_most(Flown::Leap, FASTER * fastest_mps(vehicle), "m/s");
        let pairs = self.fixes().windows(2).zip(self.points.windows(2));
        let speeds = pairs.map(|(fixes, points)| {
            // Positions are off by so much, not vehicles fast.
            let gone_m = (points[0].distance_m(points[1]) - CROSS_TRACK_M).max(0.0);
            let by_fleet_s = fixes[1].t_s - fixes[0].t_s;
            let own_s = fixes[0].passed_s(&fixes[1]);
            let took_s = by_fleet_s.max(own_s.min(by_fleet_s + off_s));
            (gone_m / took_s, &fixes[1])
        });
        self.worst(required, speeds)
    }

    /// How far it was beside its way, and over or under it, where that is worst.
    fn off_the_way(&self, spec: &MissionSpec, tube: Tube) -> Vec<Margin> {
        let climb_out = self.climb_out();
        let takeoff = self.takeoff_tube();
        let follows = spec.mission.altitude == AltitudeReference::Terrain;
        let mut aside = Vec::new();
        let mut up = Vec::new();
        for (index, of) in self.deviations() {
            let fix = &self.fixes()[index];
            let early = climb_out.filter(|climb| fix.t_s < climb.until_s);
            let wide_m = early.map_or(0.0, |climb| climb.wide_m) + of.circle_m;
            // Where the verdict judges a whole region it is beside no way.
            let is_within = takeoff
                .as_ref()
                .is_some_and(|takeoff| takeoff.holds(fix.item, self.points[index].at));
            let aside_m = if is_within { 0.0 } else { of.cross_track_m };
            aside.push((aside_m, tube.across_m + wide_m, fix));
            let level = early.is_none() && !follows && !self.follows_ground(index);
            if level {
                up.push((of.above_m.abs(), tube.up_m, fix));
            }
        }
        let [aside, up] = [(Flown::CrossTrack, aside), (Flown::Altitude, up)]
            .map(|(limit, values)| self.furthest(limit, values));
        aside.into_iter().chain(up).collect()
    }

    /// The region around its takeoff, of the first plan.
    fn takeoff_tube(&self) -> Option<TakeoffTube> {
        let first = self.flight.plans.first()?;
        TakeoffTube::of(self.vehicle?, &first.reference)
    }

    /// The worst of distances, each with its own limit.
    fn furthest(&self, limit: Flown, values: Vec<(f64, f64, &Fix)>) -> Option<Margin> {
        let over_m = |of: &(f64, f64, &Fix)| of.0 - of.1;
        let worst = values.into_iter();
        let worst = worst.max_by(|a, b| over_m(a).total_cmp(&over_m(b)));
        let (value, bound_m, fix) = worst?;
        self.worst(at_most(limit, bound_m, "m"), std::iter::once((value, fix)))
    }

    /// Until a plane has passed the place after its climb-out it may be on a way of its own there.
    fn climb_out(&self) -> Option<ClimbOut> {
        let part = self.parts().next()?;
        let (home, top) = (part.plan.waypoints.first()?, part.plan.waypoints.get(1)?);
        let next = part.plan.waypoints.get(2)?;
        if self.airframe != Airframe::Plane {
            return None;
        }
        let early_share = facts(Autopilot::ArduPilot, self.airframe)
            .behaviour
            .climb_out_share
            .value(None);
        let passages = self.passages(&part);
        let passed = passages.iter().find(|passage| passage.item == next.item);
        Some(ClimbOut {
            until_s: passed.map_or(f64::INFINITY, |passage| passage.flown_s),
            wide_m: (1.0 - early_share) * home.point.at.distance_m(top.point.at),
        })
    }

    /// It was where the spec has its goal.
    fn goal(&self, vehicle: &Vehicle, tube: Tube) -> Option<Margin> {
        let goal = self.sites.as_ref()?.goal.at;
        let circle_m = vehicle.wing.map_or(0.0, |wing| wing.loiter_radius_m);
        let away = self.points.iter().map(|point| point.at.distance_m(goal));
        let nearest = away.zip(self.fixes());
        let (away_m, fix) = nearest.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let required = at_most(Flown::Goal, tube.across_m + circle_m, "m");
        self.worst(required, std::iter::once((away_m, fix)))
    }

    /// It landed where the spec wants it to, whatever plan it was given.
    fn place_to_land(&self, vehicle: &Vehicle, spec: &MissionSpec) -> Option<Margin> {
        let (last, at, sites) = (
            self.fixes().last()?,
            self.points.last()?,
            self.sites.as_ref()?,
        );
        let place = match (vehicle.finish, &self.flight.flown.end) {
            (Finish::Land, End::Landed) => sites.landing,
            (Finish::Return, End::Landed) => sites.home.at,
            _ => return None,
        };
        let bound_m = arrival::landing_m(self.airframe) + spec.mission.tolerance_m;
        let required = at_most(Flown::Finish, bound_m, "m");
        self.worst(required, std::iter::once((place.distance_m(at.at), last)))
    }

    /// So late that `fly` would have given it up. A capture does not say when a vehicle had to
    /// start: one that was armed late started late.
    fn lateness(&self, ends_s: f64) -> Option<Margin> {
        let required = at_most(
            Flown::End,
            may_last_s(ends_s, self.flight.flown.slipped_s()),
            "s",
        );
        let last = self.fixes().last()?;
        let Some(until_s) = self.flight.flown.until_s else {
            let why = "the record does not say when it ended";
            return Some(Margin::unjudged(self.id(), required.limit, why));
        };
        let waited_s = (self.since_s() - self.departs_s()).max(0.0);
        self.worst(required, std::iter::once((until_s - waited_s, last)))
    }

    /// The last positions show the end that the record names.
    fn ending(&self, world: &World) -> Vec<Margin> {
        let (Some(last), Some(part)) = (self.fixes().last(), self.parts().last()) else {
            return Vec::new();
        };
        let away_m = arrival::away_m(part.plan, last.place);
        let one = |of: Requirement, value: f64| self.worst(of, std::iter::once((value, last)));
        let margins = match self.flight.flown.end {
            End::Landed => {
                let ground = world.terrain.height(last.place);
                let up_m = ground.map_or(f64::NAN, |ground| last.amsl.above_ground(ground).0);
                [
                    one(
                        at_most(Flown::PlannedEnd, arrival::landing_m(self.airframe), "m"),
                        away_m,
                    ),
                    one(at_most(Flown::Landed, GROUND_M, "m"), up_m.abs()),
                ]
            }
            _ if self.airframe.has_wing() => {
                let fixes = &self.fixes()[part.fixes.clone()];
                let turned_deg = arrival::circled_rad(part.plan, fixes).to_degrees();
                let limit = Limit::Flown(Flown::CircleTurned);
                let turned = Requirement::at_least(limit, TURNED_RAD.to_degrees(), "deg");
                [one(turned, turned_deg), None]
            }
            _ => [
                one(at_most(Flown::PlannedEnd, ARRIVED_M, "m"), away_m),
                one(at_most(Flown::LastSpeed, STILL_MPS, "m/s"), last.speed_mps),
            ],
        };
        margins.into_iter().flatten().collect()
    }
}

/// A limit of flown tracks alone, with its greatest value.
pub(crate) fn at_most(limit: Flown, bound: f64, unit: &'static str) -> Requirement {
    Requirement::at_most(Limit::Flown(limit), bound, unit)
}

/// The greatest speed in any direction, m/s.
fn fastest_mps(vehicle: &Vehicle) -> f64 {
    let upright_mps = vehicle.climb_mps.max(vehicle.descent_mps);
    at_its_fastest(vehicle).fastest_mps().hypot(upright_mps)
}
