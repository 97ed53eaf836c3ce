//! What the spec says of a mission besides where it may go: home, start, goal,
//! finish, departure, speed, slopes, turns, number of items.

mod actions;
mod aim;
pub(crate) mod coverage;
mod delayed_commands;
mod ends;
mod fence;
mod line_speed;
mod param_fence;
mod stops;
pub(crate) mod tasks;

use crate::autopilot::{Airframe, ParameterRow, command_row, name_in, parameter};
use crate::geodesy::{Amsl, LatLon, PlanPoint};
use crate::mission::{self, AcceptanceProblem, MissionType, VehicleMission, as_set, command};
use crate::numeric::digits::float32;
use crate::path::VehicleLimits;
use crate::spec::{Autopilot, Finish, MissionSpec, Vehicle};
use crate::world::{VehicleSites, World};

use super::fence::Fence;
use crate::verify::execute::executor::is_launched;
use crate::verify::execute::flight::{End, Flight, Last, Slope};
use crate::verify::execute::legs::RISE_M;
use crate::verify::measure::segment::{Phase, Segment};
use crate::verify::measure::worst::Worst;
use crate::verify::{Limit, Margin, Moment, Requirement};

/// A commanded speed may differ from the planned one by this, m/s.
const SPEED_MPS: f64 = 0.1;
/// An encoded departure may differ from the planned one by this, s.
const DEPARTURE_S: f64 = 0.5;

/// One vehicle's side of the contract.
pub(crate) struct MissionCheck<'a> {
    pub(crate) spec: &'a MissionSpec,
    pub(crate) world: &'a World,
    pub(crate) vehicle: &'a Vehicle,
    pub(crate) sites: &'a VehicleSites,
    pub(crate) mission: &'a VehicleMission,
    pub(crate) flight: &'a Flight,
}

impl MissionCheck<'_> {
    pub(crate) fn margins(&self, home: Option<LatLon>, fence: &Fence) -> Vec<Margin> {
        let mut margins = vec![self.judged()];
        margins.extend(self.kind());
        margins.push(self.item_count());
        margins.extend(self.acceptance());
        margins.extend(self.home(home, fence));
        margins.extend(self.above_home());
        margins.extend(self.route());
        margins.extend(self.stops());
        margins.extend(self.camera());
        margins.extend(self.finish());
        margins.extend(self.departure());
        margins.extend(self.speed());
        margins.extend(self.flyable_speed());
        margins.extend(self.slopes());
        margins.extend(self.turns());
        margins.extend(self.wing());
        margins.extend(self.acceptance_radius());
        margins.extend(self.fence_margin());
        margins.extend(self.fence());
        margins.extend(self.endurance());
        margins
    }

    pub(crate) fn id(&self) -> &str {
        &self.vehicle.id
    }

    fn moment(&self, point: PlanPoint, t_s: f64, item: usize) -> Moment {
        Moment {
            place: self.world.frame.from_plan(point.at),
            amsl: point.amsl,
            t_s,
            item,
        }
    }

    /// How many items could be flown.
    fn judged(&self) -> Margin {
        let total = count(self.mission.items.len());
        if let (None, Some(last)) = (&self.flight.unknown, self.flight.last) {
            return self.judged_until(last, total);
        }
        let judged = self
            .flight
            .unknown
            .as_ref()
            .map_or(total, |unknown| count(unknown.row.saturating_sub(1)));
        let last = self.flight.segments.last();
        let at = self.flight.unknown.as_ref().zip(last);
        let at = at.map(|(unknown, segment)| Moment {
            item: unknown.row,
            ..segment.moment(&self.world.frame, 1.0)
        });
        let required = Requirement::at_least(Limit::ItemsJudged, total, "items");
        Margin {
            ok: self.flight.unknown.is_none() && total > 0.0,
            note: match &self.flight.unknown {
                _ if total <= 0.0 => "the mission is empty".to_owned(),
                Some(unknown) => {
                    format!("cannot judge from item {} on: {}", unknown.row, unknown.why)
                }
                None if self.flight.end == Some(End::Repeats) => {
                    "the mission repeats for ever: judged with one repetition more".to_owned()
                }
                None => String::new(),
            },
            ..required.margin(self.id(), judged, at)
        }
    }

    /// What a vehicle never flies, because it stays, repeats its mission or has landed before. That
    /// is no fault where the spec wants it to stay, nor where the rest would not move it elsewhere.
    fn judged_until(&self, last: Last, total: f64) -> Margin {
        let Last {
            row,
            why,
            is_harmless,
        } = last;
        let segment = self.flight.segments.last();
        let at = segment.map(|segment| segment.moment(&self.world.frame, 0.0));
        let required = Requirement::at_least(Limit::ItemsJudged, total, "items");
        let stays = matches!(self.flight.end, Some(End::Stays(_)));
        let ok = is_harmless || stays && self.vehicle.finish == Finish::Loiter;
        let item = row
            .checked_sub(1)
            .and_then(|index| self.mission.items.get(index));
        let command = item.and_then(|item| command_row(item.command));
        let how = match command.filter(|_| stays) {
            Some(command) => format!(" ({}) for ever", command.name),
            None => String::new(),
        };
        let note = match is_harmless {
            true => format!("the vehicle {why} item {row}: those after it are never flown"),
            false => format!(
                "the vehicle {why} item {row}{how}: item {} and all after it are never flown",
                row + 1
            ),
        };
        Margin {
            ok,
            note,
            ..required.margin(self.id(), count(row), at)
        }
    }

    /// A mission for another autopilot or airframe.
    fn kind(&self) -> Option<Margin> {
        let is = (self.mission.autopilot, self.mission.airframe);
        let spec = (self.vehicle.autopilot, self.vehicle.airframe);
        (is != spec).then(|| {
            let named = |(autopilot, airframe): (Autopilot, Airframe)| {
                format!("a {} of {}", airframe.name(), autopilot.name())
            };
            let (is, spec) = (named(is), named(spec));
            let why = format!("the mission is for {is}, the spec says {spec}");
            Margin::unjudged(self.id(), Limit::Autopilot, why)
        })
    }

    fn item_count(&self) -> Margin {
        let most = count(self.spec.mission.max_items);
        let required = Requirement::at_most(Limit::ItemCount, most, "items");
        required.margin(self.id(), count(self.mission.items.len()), None)
    }

    /// What the autopilot would refuse or misread: one margin for each problem.
    fn acceptance(&self) -> Vec<Margin> {
        let mut problems = if self.sites.departure.is_airborne() {
            mission::problems_in_flight(self.mission)
        } else {
            mission::problems(self.mission)
        };
        // The spec may know what this one keeps.
        problems.retain(|problem| !problem.is_fence_count());
        let capacity = self.vehicle.fence_capacity();
        problems.extend(AcceptanceProblem::fence_count(self.mission, capacity));
        let (problem, at_fence) = match self.comes_to_param_fence() {
            Some((problem, at)) if !problems.iter().any(AcceptanceProblem::is_param_fence) => {
                (Some(problem), Some(at))
            }
            _ => (None, None),
        };
        problems.extend(problem);
        let required = Requirement::at_most(Limit::Acceptance, 0.0, "problems");
        let margin = |at, note| Margin {
            note,
            ..required
                .clone()
                .margin(self.id(), count(problems.len()), at)
        };
        if problems.is_empty() {
            return vec![margin(None, String::new())];
        }
        let flown = |problem: &AcceptanceProblem| {
            let of_item = |segment: &&Segment| segment.row == problem.item;
            let in_mission = problem.list == MissionType::Mission;
            let segment = self.flight.segments.iter().find(of_item);
            segment
                .filter(|_| in_mission)
                .map(|segment| segment.moment(&self.world.frame, 1.0))
        };
        let at = |problem: &AcceptanceProblem| {
            at_fence
                .filter(|_| problem.is_param_fence())
                .or_else(|| flown(problem))
        };
        problems
            .iter()
            .map(|problem| margin(at(problem), problem.to_string()))
            .collect()
    }

    /// The delay before takeoff against `depart_s` or its window, where the autopilot keeps one.
    fn departure(&self) -> Option<Margin> {
        let first = self.flight.segments.first()?;
        let is_airborne = self.sites.departure.is_airborne();
        let is_launched = is_launched(self.vehicle, self.mission.autopilot);
        if is_airborne || self.flight.delay_s.is_none() && is_launched {
            return None;
        }
        let encoded_s = self.flight.delay_s.unwrap_or(0.0);
        let mut worst = Worst::default();
        worst.at_most(
            self.vehicle.departures().miss(encoded_s),
            DEPARTURE_S,
            || first.moment(&self.world.frame, 0.0),
        );
        let mut margin = worst.margin(self.id(), Limit::Departure, "s")?;
        let allowed = match self.vehicle.retiming.depart_s {
            Some(window) => format!("{} to {}", window.least, window.most),
            None => self.vehicle.depart_s.to_string(),
        };
        margin.note = format!("delay {encoded_s} s in the mission, {allowed} s in the spec");
        Some(margin)
    }

    /// Commanded speeds against the planned one or their range.
    fn speed(&self) -> Option<Margin> {
        let mut worst = Worst::default();
        let lines = self.lines_with_speeds();
        for (index, cruise) in self.flight.cruises.iter().enumerate() {
            let Some(segment) = self.flight.segments.get(cruise.segment) else {
                continue;
            };
            let at = || segment.moment(&self.world.frame, 0.0);
            match (cruise.speed_mps, self.mission.autopilot) {
                (Some(speed_mps), _) => {
                    if self.offer_lines(&mut worst, (index, speed_mps), &lines) {
                        continue;
                    }
                    let own_mps = match self.speed_since_stop(segment.from_s) {
                        Some(planned_mps) => (speed_mps - planned_mps).abs(),
                        None => self.vehicle.speeds().miss(speed_mps),
                    };
                    // Lines of tasks may have a speed of their own.
                    let on_lines = self
                        .spec
                        .tasks
                        .iter()
                        .filter_map(|task| task.sweep.as_ref()?.speed_mps);
                    let misses = on_lines.map(|planned_mps| (speed_mps - planned_mps).abs());
                    let miss_mps = misses.fold(own_mps, f64::min);
                    worst.at_most(miss_mps, SPEED_MPS, at)
                }
                // Its cruise parameter is assumed: PX4 misbehaved with speed items.
                (None, Autopilot::Px4) if self.vehicle.retiming.speed_mps.is_none() => {
                    worst.at_most(0.0, SPEED_MPS, at)
                }
                (None, _) => worst.unknown(SPEED_MPS, self.why_no_speed(), at()),
            }
        }
        let mut margin = worst.margin(self.id(), Limit::Speed, "m/s")?;
        let cruises = self.flight.cruises.iter();
        let is_held = |mps: f64| {
            let mut held = self.speed_limits().into_iter();
            held.any(|(_, held_mps)| (held_mps - mps).abs() < SPEED_MPS)
        };
        if !margin.ok
            && margin.note.is_empty()
            && cruises.filter_map(|cruise| cruise.speed_mps).any(is_held)
            && let Some(held) = self.held_speeds()
        {
            margin.note = format!("the parameters hold it within {held}");
        }
        Some(margin)
    }

    /// Why a speed is not known.
    fn why_no_speed(&self) -> String {
        let name = self.mission.facts().defaults.cruise_parameter;
        let name = name_in(name, self.mission.autopilot_version);
        let held = self.held_speeds();
        let beyond = held.map_or_else(String::new, |held| format!(" within {held}"));
        format!(
            "no DO_CHANGE_SPEED{beyond} before it and no {name}: the speed is the vehicle's own"
        )
    }

    /// The parameters between which the vehicle keeps its speed, with their values in m/s, if the
    /// mission has them.
    fn speed_limits(&self) -> Vec<(&'static str, f64)> {
        let names = self.mission.facts().defaults.speed_parameters;
        let held = |name: &'static str| Some((name, self.mission.param_si(name)?));
        names.into_iter().flatten().filter_map(held).collect()
    }

    /// The same in words.
    fn held_speeds(&self) -> Option<String> {
        let held = self.speed_limits().into_iter();
        let held: Vec<String> = held
            .map(|(name, mps)| format!("{name} {}", float32(mps)))
            .collect();
        (!held.is_empty()).then(|| held.join(" and "))
    }

    /// Climb and descent: the angle on the route, the vertical speed on every leg.
    ///
    /// A vehicle that departs in the air is somewhere on a leg that was judged from its begin: the
    /// few metres that are left of it are as steep as the vehicle is off its line.
    fn slopes(&self) -> Vec<Margin> {
        let mut angles = [Worst::default(), Worst::default()];
        let mut rates = [Worst::default(), Worst::default()];
        let is_airborne = self.sites.departure.is_airborne();
        let begun = self.flight.segments.first().filter(|_| is_airborne);
        let set = as_set(self.vehicle, self.mission);
        for slope in &self.flight.slopes {
            let Some(segment) = self.flight.segments.get(slope.segment) else {
                continue;
            };
            if begun.is_some_and(|begun| begun.row == segment.row) {
                continue;
            }
            let at = || segment.moment(&self.world.frame, 0.0);
            let way = usize::from(slope.rise_m < 0.0);
            let rise_m = (slope.rise_m.abs() - RISE_M).max(0.0);
            if slope.phase == Phase::Route {
                let angle_deg = rise_m.atan2(slope.run_m).to_degrees();
                let limit_deg = steepest(self.vehicle, slope).atan().to_degrees();
                angles[way].at_most(angle_deg, limit_deg, at);
            }
            if slope.run_m > 0.0 {
                let rate_mps = rise_m / slope.run_m * slope.speed_mps;
                let limit_mps = [set.climb_mps, set.descent_mps][way];
                rates[way].at_most(rate_mps, limit_mps, at);
            }
        }
        let [climb, descent] = angles;
        let [up, down] = rates;
        [
            climb.margin(self.id(), Limit::ClimbAngle, "deg"),
            descent.margin(self.id(), Limit::DescentAngle, "deg"),
            up.margin(self.id(), Limit::ClimbSpeed, "m/s"),
            down.margin(self.id(), Limit::DescentSpeed, "m/s"),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    /// What the fillets leave of each leg.
    fn turns(&self) -> Option<Margin> {
        let mut worst = Worst::default();
        for turn in &self.flight.turns {
            if let Some(segment) = self.flight.segments.get(turn.segment) {
                worst.at_least(turn.left_m, 0.0, || segment.moment(&self.world.frame, 0.0));
            }
        }
        worst.margin(self.id(), Limit::TurnFit, "m")
    }
}

impl MissionCheck<'_> {
    /// PX4 keeps a radius of its own for each waypoint, and goes on to the next one
    /// within it; 0 and NaN are that of its parameters (`Navigator::get_default_acceptance_radius`). ArduCopter keeps none.
    fn acceptance_radius(&self) -> Option<Margin> {
        if self.mission.autopilot != Autopilot::Px4 {
            return None;
        }
        let limit_m = mission::corner_cut_m(&self.spec.mission);
        // That of the parameters, where it is wider than the default of `navigator_params.c`, and than one that a plan
        // wrote as a float32.
        let name = "NAV_ACC_RAD";
        let default_m = parameter(name).map_or(0.0, ParameterRow::default_si);
        let widest_m = limit_m.max(default_m) * (1.0 + 1e-6);
        let of_all_m = (self.mission.param_si(name)).filter(|radius_m| *radius_m > widest_m);
        let mut worst = Worst::default();
        for (index, item) in self.mission.items.iter().enumerate() {
            let (row, own_m) = (index + 1, f64::from(item.params[1]));
            if item.command != command::NAV_WAYPOINT {
                continue;
            }
            let own_m = Some(own_m).filter(|own_m| *own_m > 0.0);
            let Some(radius_m) = own_m.or(of_all_m) else {
                continue;
            };
            let Some(segment) = self
                .flight
                .segments
                .iter()
                .rfind(|segment| segment.row == row)
            else {
                // Not flown as far as is known, which fails already.
                continue;
            };
            worst.at_most(radius_m, limit_m, || segment.moment(&self.world.frame, 1.0));
        }
        worst.margin(self.id(), Limit::AcceptanceRadius, "m")
    }
}

/// The steepest allowed rise over run of a slope. The polynomials of the paper
/// are concave in altitude, so an end is the tightest.
fn steepest(vehicle: &Vehicle, slope: &Slope) -> f64 {
    let limits = VehicleLimits::of(vehicle);
    let limit = if slope.rise_m < 0.0 {
        limits.descent
    } else {
        limits.climb
    };
    let at = |amsl_m: f64| limit.by_shape(Amsl(amsl_m));
    at(slope.top_m).min(at(slope.top_m - slope.rise_m.abs()))
}

fn count(items: usize) -> f64 {
    f64::from(u32::try_from(items).unwrap_or(u32::MAX))
}
