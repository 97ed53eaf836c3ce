//! What was flown against the plan and against the limits of the spec.

pub(super) mod leg;
pub(super) mod limits;
mod missed;
pub(super) mod proof;
pub(super) mod reference;
pub(super) mod report;
pub(super) mod speed;
pub(super) mod takeoff;
#[cfg(test)]
mod tests;

use super::itinerary::progress::Progress;
use super::record::{Fix, Flight, Record};
use super::session::end::End;
use crate::geodesy::{EastNorth, PlanPoint};
use crate::spec::{Action, Airframe, MissionSpec, Vehicle};
use crate::verify::Margin;
use crate::world::{VehicleSites, World};
use leg::leg_at;
use limits::separation;
use proof::CROSS_TRACK_M;
use reference::{Deviation, ReferenceTrajectory, to_segment};
use report::{ErrorPercentiles, FlightReport, MadeStop, Passage, VehicleReport};
use speed::clock_off_s;
use takeoff::landing_column_m;

/// Around home and the place of landing the minimum height does not hold, metres.
pub(super) const COLUMN_M: f64 = 25.0;
/// Two waypoints this near each other have an upright leg between them, metres.
const UPRIGHT_M: f64 = 1.0;
/// So much further from a waypoint than before a vehicle has left it, metres.
const LEAVES_M: f64 = 5.0;
/// Between two positions this far apart in time nothing is known, seconds.
pub(super) const GAP_S: f64 = 5.0;

/// One vehicle's flight in planning coordinates.
pub(super) struct FlownTrack<'a> {
    pub(super) flight: &'a Flight,
    /// Of each position: which of the plans it was flown by.
    plan_of: Vec<usize>,
    /// How many positions are of its takeoff.
    risen: usize,
    /// The last position on the way to its landing.
    landed: Option<usize>,
    /// The first position of a descent that was ordered; their number if there was none.
    ordered_down: usize,
    pub(super) airframe: Airframe,
    /// As the spec has it; none for a stranger.
    pub(super) vehicle: Option<&'a Vehicle>,
    pub(super) sites: Option<VehicleSites>,
    pub(super) points: Vec<PlanPoint>,
}

/// One plan as far as it was flown.
pub(super) struct Part<'a> {
    pub(super) plan: &'a ReferenceTrajectory,
    /// The positions that were flown by it, of all.
    pub(super) fixes: std::ops::Range<usize>,
    /// Index of the first of its waypoints that was ahead.
    pub(super) ahead: usize,
}

/// Judges a flight by its record. The world is that of the spec; threats that came up on
/// the way are added to it.
#[must_use]
pub fn judge(spec: &MissionSpec, world: &World, record: &Record) -> FlightReport {
    let flights = record.flights.iter();
    let tracks: Vec<FlownTrack<'_>> = flights.map(|f| FlownTrack::new(f, spec, world)).collect();
    let plans = record.flights.iter().flat_map(|flight| &flight.plans);
    let ends_s = plans.map(|plan| plan.reference.end_s).fold(0.0, f64::max);
    let mut margins: Vec<Margin> = tracks
        .iter()
        .flat_map(|track| {
            let limits = track.margins(spec, world, record);
            let off_s = clock_off_s(record.speedup);
            let proof = track.proof(spec, world, (ends_s, off_s));
            let paces = track.paces(off_s);
            limits.into_iter().chain(proof).chain(paces)
        })
        .collect();
    for (index, first) in tracks.iter().enumerate() {
        for second in &tracks[index + 1..] {
            margins.extend(separation(&spec.separation, world, first, second));
        }
    }
    FlightReport {
        vehicles: tracks.iter().map(FlownTrack::report).collect(),
        margins,
    }
}

impl<'a> FlownTrack<'a> {
    pub(super) fn new(flight: &'a Flight, spec: &'a MissionSpec, world: &World) -> Self {
        let mut fleet = spec.vehicles.iter();
        let index = fleet.position(|vehicle| vehicle.id == flight.vehicle);
        let this = index.and_then(|index| spec.vehicles.get(index));
        let point = |fix: &Fix| PlanPoint {
            at: world.frame.to_plan(fix.place),
            amsl: fix.amsl,
        };
        let mut track = Self {
            flight,
            plan_of: flight.plan_of_each(),
            risen: 0,
            landed: None,
            ordered_down: flight.flown.fixes.len(),
            airframe: this.map_or(Airframe::Copter, |vehicle| vehicle.airframe),
            vehicle: this,
            sites: index.and_then(|index| world.sites.get(index).cloned()),
            points: flight.flown.fixes.iter().map(point).collect(),
        };
        track.risen = track.count_rising();
        track.landed = (0..track.points.len()).rfind(|&index| track.flies_to_landing(index));
        if matches!(flight.flown.end, End::LandedEarly | End::ReturnedToRally) {
            track.ordered_down = track.comes_down_from();
        }
        track
    }

    pub(super) fn id(&self) -> &str {
        &self.flight.vehicle
    }

    pub(super) fn fixes(&self) -> &[Fix] {
        &self.flight.flown.fixes
    }

    fn plan(&self, fix: usize) -> Option<&ReferenceTrajectory> {
        let plan = *self.plan_of.get(fix)?;
        self.flight.plans.get(plan).map(|plan| &plan.reference)
    }

    /// Whether the plan of a position follows the ground.
    pub(super) fn follows_ground(&self, fix: usize) -> bool {
        self.plan(fix)
            .is_some_and(ReferenceTrajectory::follows_ground)
    }

    /// Indices of positions on the route: neither in the column of the takeoff nor in that
    /// of the landing, nor below a place where a load is put down; of a plane, neither on its
    /// climb-out nor on its glide.
    pub(super) fn on_route(&self) -> impl Iterator<Item = usize> {
        let first = self.flight.plans.first().map(|plan| &plan.reference);
        let home = first.and_then(|plan| plan.waypoints.first().map(|w| w.point.at));
        let columns = self.flight.plans.iter().map(|plan| {
            let column = |vehicle| landing_column_m(vehicle, &plan.reference);
            self.vehicle.map_or(COLUMN_M, column)
        });
        let columns: Vec<f64> = columns.collect();
        (0..self.points.len()).filter(move |&index| {
            let at = self.points[index].at;
            let near = |place: Option<EastNorth>, column_m: f64| {
                place.is_some_and(|place| place.distance_m(at) < column_m)
            };
            let plan = self.plan(index).filter(|plan| plan.lands);
            let end = plan.and_then(|plan| plan.waypoints.last().map(|w| w.point.at));
            let end_m = match self.flies_to_landing(index) {
                true => columns[self.plan_of[index]],
                false => COLUMN_M,
            };
            match self.airframe {
                Airframe::Plane => !self.rises(index) && !self.glides(index),
                Airframe::Copter | Airframe::Vtol => {
                    let item = self.fixes()[index].item;
                    let plan = self.plan(index);
                    let puts_down = plan.is_some_and(|plan| plan.dips_at(item, at));
                    let comes_down = near(home, COLUMN_M) || near(end, end_m);
                    !self.rises(index) && !comes_down && !puts_down && index < self.ordered_down
                }
            }
        })
    }

    /// The first position of the landing that was ordered, or of the descent where a return ended.
    fn comes_down_from(&self) -> usize {
        let flown = &self.flight.flown;
        let lands_s = flown.ordered_s.filter(|_| flown.ordered == Action::Land);
        if let Some(from_s) = lands_s {
            return self.fixes().partition_point(|fix| fix.t_s < from_s);
        }
        let last = self.points.last().map(|last| last.at);
        let is_far = |point: &PlanPoint| last.is_none_or(|at| at.distance_m(point.at) >= COLUMN_M);
        let farthest = self.points.iter().rposition(is_far);
        farthest.map_or(0, |index| index + 1)
    }

    /// Whether it is on its takeoff.
    pub(super) fn rises(&self, index: usize) -> bool {
        index < self.risen
    }

    /// How many of its positions are of its takeoff: until it flies to the next item or, whatever
    /// it says of that, is further from home than a takeoff leads.
    fn count_rising(&self) -> usize {
        let first = self.flight.plans.first().map(|plan| &plan.reference);
        let (home, top) = match first.map(|plan| plan.waypoints.as_slice()) {
            Some([home, top, ..]) => (home, top),
            _ => return 0,
        };
        let across_m = self.vehicle.map_or(CROSS_TRACK_M, proof::across_m);
        // A wind from behind may carry a plane as far again.
        let leads_m = 2.0 * home.point.at.distance_m(top.point.at) + across_m;
        let rises = |index: &usize| {
            self.plan_of[*index] == 0
                && self.fixes()[*index].item <= top.item
                && self.points[*index].at.distance_m(home.point.at) <= leads_m
        };
        (0..self.points.len()).take_while(rises).count()
    }

    /// Whether a plane is on the glide to its landing, or has landed: some then say that they
    /// begin again.
    pub(super) fn glides(&self, index: usize) -> bool {
        self.airframe == Airframe::Plane
            && (self.flies_to_landing(index) || self.landed.is_some_and(|landed| index > landed))
    }

    fn flies_to_landing(&self, index: usize) -> bool {
        let plan = self.plan(index).filter(|plan| plan.lands);
        let last = plan.and_then(|plan| plan.waypoints.last());
        last.is_some_and(|last| self.fixes()[index].item >= last.item)
    }

    /// The plans that were flown, one after the other.
    pub(super) fn parts(&self) -> impl Iterator<Item = Part<'a>> {
        let plans = self.flight.plans.iter().enumerate();
        plans.filter_map(|(number, plan)| {
            let from = self.plan_of.partition_point(|&of| of < number);
            let to = self.plan_of.partition_point(|&of| of <= number);
            (from < to).then(|| Part {
                plan: &plan.reference,
                fixes: from..to,
                ahead: self.ahead(&plan.reference, from),
            })
        })
    }

    /// Index of the first waypoint of a plan that is ahead at a position: what a plan that
    /// was taken up in flight has before that was passed by the plan before it.
    fn ahead(&self, plan: &ReferenceTrajectory, from: usize) -> usize {
        if from == 0 {
            return 1;
        }
        let way: Vec<PlanPoint> = plan
            .waypoints
            .iter()
            .map(|waypoint| waypoint.point)
            .collect();
        let on = leg_at(&way, self.points[from], self.velocity_mps(from));
        on.map_or(plan.waypoints.len(), |(leg, _)| leg + 1)
    }

    /// How fast it flies at a position, to the east and the north: towards the next one.
    fn velocity_mps(&self, at: usize) -> (f64, f64) {
        let Some(next) = self.fixes().get(at + 1) else {
            return (0.0, 0.0);
        };
        let (from, to) = (self.points[at].at, self.points[at + 1].at);
        let took_s = (next.t_s - self.fixes()[at].t_s).max(1e-3);
        (
            (to.east_m - from.east_m) / took_s,
            (to.north_m - from.north_m) / took_s,
        )
    }

    /// The nearest of the ways between two positions, one waypoint after the other.
    pub(super) fn passages(&self, part: &Part<'_>) -> Vec<Passage> {
        let (plan, mut from) = (part.plan, part.fixes.start);
        let fixes = &self.fixes()[..part.fixes.end];
        let reached = &self.flight.flown.reached;
        // What a plan before this one called by the same number is none of it.
        let begins_s = fixes.get(from).filter(|_| from > 0).map(|first| first.t_s);
        // Nor is what the next one calls so.
        let next_s = self.fixes().get(part.fixes.end).map(|next| next.t_s);
        let ends_s = fixes.last().map_or(0.0, |last| last.t_s);
        let flown_by_it = begins_s.unwrap_or(f64::NEG_INFINITY)..next_s.unwrap_or(ends_s + GAP_S);
        let mut found = Vec::new();
        for (index, waypoint) in plan.waypoints.iter().enumerate().skip(part.ahead) {
            let next = plan.waypoints.get(index + 1).map_or(usize::MAX, |w| w.item);
            let after = plan.waypoints.get(index + 1).map(|w| w.point.at);
            let is_upright = after.is_some_and(|at| at.distance_m(waypoint.point.at) < UPRIGHT_M);
            let mut best: Option<(f64, f64, usize)> = None;
            for at in from..fixes.len().saturating_sub(1) {
                if fixes[at].item > next {
                    break;
                }
                let (distance_m, share) =
                    to_segment(waypoint.point, self.points[at], self.points[at + 1]);
                if waypoint.radius_m > 0.0 && distance_m <= waypoint.radius_m {
                    // It comes to the rim of its circle here.
                    best = Some((0.0, fixes[at].t_s, at));
                    break;
                }
                let distance_m = (distance_m - waypoint.radius_m).max(0.0);
                let leaves = fixes[at].item > waypoint.item
                    && best.is_some_and(|(min_m, ..)| distance_m > min_m + LEAVES_M);
                if is_upright && leaves {
                    // Straight down or up to the next one, it may come past here once more.
                    break;
                }
                if best.is_none_or(|(least, ..)| distance_m < least - 0.05) {
                    let t_s = fixes[at].t_s + share * (fixes[at + 1].t_s - fixes[at].t_s);
                    best = Some((distance_m, t_s, at));
                }
            }
            let was_reached = fixes[from..].iter().any(|fix| fix.item > waypoint.item)
                || reached
                    .iter()
                    .any(|(item, t_s)| *item == waypoint.item && flown_by_it.contains(t_s));
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

    /// Each position on the route, by its index, and how far it was from the plan.
    pub(super) fn deviations(&self) -> impl Iterator<Item = (usize, Deviation)> {
        self.on_route().filter_map(|index| {
            let item = self.fixes()[index].item;
            let plan = self.plan(index)?;
            let of = plan.deviation(item, self.points[index])?;
            Some((index, self.with_early_climb(plan, index, of)))
        })
    }

    /// A plane may have the height of its takeoff anywhere on its climb-out: it is above that only where it
    /// exceeds it.
    fn with_early_climb(
        &self,
        plan: &ReferenceTrajectory,
        index: usize,
        of: Deviation,
    ) -> Deviation {
        let top = plan.waypoints.get(1).filter(|_| self.plan_of[index] == 0);
        let top = top.filter(|top| self.airframe == Airframe::Plane && of.t_s < top.t_s);
        match top {
            Some(top) if of.above_m > 0.0 => {
                let over_m = self.points[index].amsl.0 - top.point.amsl.0;
                let above_m = over_m.max(0.0);
                Deviation { above_m, ..of }
            }
            _ => of,
        }
    }

    fn report(&self) -> VehicleReport {
        let deviations: Vec<Deviation> = self.deviations().map(|(_, of)| of).collect();
        let spread =
            |of: fn(&Deviation) -> f64| ErrorPercentiles::of(deviations.iter().map(of).collect());
        VehicleReport {
            vehicle: self.id().to_owned(),
            end: match self.flight.flown.end {
                End::NotFlown if !self.fixes().is_empty() => "record breaks off".to_owned(),
                ref end => end.words().to_owned(),
            },
            ended_as_planned: self.ends_as_planned(),
            fixes: self.fixes().len(),
            cross_track_m: spread(|deviation| deviation.cross_track_m),
            altitude_error_m: spread(|deviation| deviation.above_m.abs()),
            passages: self.parts().flat_map(|part| self.passages(&part)).collect(),
            overdue_s: self.overdue_s(),
            stops: self.stops(),
            served: Progress::recorded(self.flight, self.airframe).served(),
        }
    }

    /// How late it was, at least, where it was last on its plan: for the first waypoint that it did not pass, and for
    /// the place on its path.
    fn overdue_s(&self) -> Option<f64> {
        let left_s = self.flight.flown.left_s;
        if self.ends_as_planned() || self.leaves_as_ordered() && left_s.is_none() {
            return None;
        }
        let count = left_s.map_or(self.fixes().len(), |left_s| {
            self.fixes().partition_point(|fix| fix.t_s <= left_s)
        });
        let index = count.checked_sub(1)?;
        let (part, last) = (self.parts().last()?, self.fixes().get(index)?);
        let passages = self.passages(&part);
        let mut ahead = part.plan.waypoints.iter().skip(part.ahead);
        let next = ahead.find(|next| !passages.iter().any(|passed| passed.item == next.item))?;
        let here_s = self
            .planned_s(index)
            .filter(|planned_s| *planned_s < next.t_s);
        let late_s = last.t_s - here_s.unwrap_or(next.t_s);
        (late_s > 0.0).then_some(late_s)
    }

    /// The latest time at which its plan has it where a position is, seconds after T0; none for one beside its path.
    fn planned_s(&self, index: usize) -> Option<f64> {
        let (plan, point) = (self.plan(index)?, self.points[index]);
        let item = self.fixes()[index].item;
        let across_m = self.vehicle.map_or(CROSS_TRACK_M, proof::across_m);
        let on_path = plan.deviations(item, point);
        let on_path = on_path.filter(|of| of.distance_m() <= across_m);
        on_path.map(|of| of.t_s).reduce(f64::max)
    }

    /// How near it came to each of its stops, and when.
    fn stops(&self) -> Vec<MadeStop> {
        let (Some(vehicle), Some(sites)) = (self.vehicle, &self.sites) else {
            return Vec::new();
        };
        let stops = vehicle.stops.iter().zip(&sites.stops);
        let made = stops.filter_map(|(stop, &end)| {
            let point = stop.below(end);
            let pairs = self.points.windows(2).zip(self.fixes().windows(2));
            let nearest = pairs.map(|(points, fixes)| {
                let (distance_m, share) = to_segment(point, points[0], points[1]);
                let t_s = fixes[0].t_s + share * (fixes[1].t_s - fixes[0].t_s);
                (distance_m, t_s)
            });
            let (distance_m, flown_s) = nearest.min_by(|a, b| a.0.total_cmp(&b.0))?;
            Some(MadeStop {
                id: stop.id.clone(),
                flown_s,
                distance_m,
            })
        });
        made.collect()
    }
}
