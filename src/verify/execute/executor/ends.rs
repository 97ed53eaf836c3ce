//! How a flight ends: landed, at home again, or in the air for ever.

use super::{Pilot, SAME_PLACE_M};
use crate::autopilot::{Autopilot, Motion, command_row};
use crate::geodesy::{Amsl, LatLon, PlanPoint};
use crate::mission::{Item, ParamFence, VehicleMission, command, first_speed_mps};
use crate::numeric::digits::float32;
use crate::path::{heading_rad, landing_shift_s};
use crate::verify::execute::decode::Unknown;
use crate::verify::execute::flight::End;
use crate::verify::execute::item::Height;
use crate::verify::measure::segment::{Column, Phase, Segment};
use crate::world::Terrain;

/// Places nearer than this are one, metres.
const SAME_M: f64 = 1.0;
/// `RTL_ALT_MIN` of ArduCopter, metres.
const MIN_RETURN_M: f64 = 2.0;
/// `RTL_MIN_CONE_SLOPE` of ArduCopter: with less there is no cone.
const MIN_CONE_SLOPE: f64 = 0.5;
/// `CLIMB_BEFORE_TURN` of `FLIGHT_OPTIONS` (`ArduPlane/defines.h`).
const CLIMB_FIRST: f64 = 16.0;
/// A return altitude that differs from the one of the spec by more is the one that is flown, metres.
const SAME_ALTITUDE_M: f64 = 0.1;
/// Speeds that differ by less are one, m/s.
const SAME_MPS: f64 = 1e-4;

/// A parameter in SI units, or its default.
fn param_si(mission: &VehicleMission, name: &str) -> f64 {
    mission.param_or_default_si(name).unwrap_or(0.0)
}

/// Why the parameters lead a return elsewhere than this verdict does, if they do.
fn other_return(mission: &VehicleMission) -> Option<String> {
    let mut known = mission.facts().returns_with.iter();
    known.find_map(|(name, value)| {
        let held = mission.param(name)?;
        let is_it = (held - value).abs() < 0.5;
        (!is_it).then(|| format!("a return with {name} {}", float32(held)))
    })
}

/// The altitude above home that `ArduCopter` does not return above, by the fence of its parameters,
/// metres (`ModeRTL::compute_return_target`).
fn below_fence_m(mission: &VehicleMission) -> f64 {
    let ceiling_m = ParamFence::of(mission).and_then(|fence| fence.ceiling_m);
    ceiling_m.map_or(f64::INFINITY, |ceiling_m| {
        ceiling_m - param_si(mission, "FENCE_MARGIN")
    })
}

/// The middle of the box around points.
fn middle(points: &[PlanPoint]) -> Option<PlanPoint> {
    let middle = |of: fn(&PlanPoint) -> f64| {
        let values = points.iter().map(of);
        let (low, high) = (
            values.clone().fold(f64::INFINITY, f64::min),
            values.fold(f64::NEG_INFINITY, f64::max),
        );
        0.5 * (low + high)
    };
    (!points.is_empty()).then(|| {
        PlanPoint::new(
            middle(|point| point.at.east_m),
            middle(|point| point.at.north_m),
            Amsl(middle(|point| point.amsl.0)),
        )
    })
}

/// Whether none of the items would move a landed vehicle elsewhere.
pub(crate) fn goes_nowhere(items: &[Item]) -> bool {
    items.iter().all(|item| {
        matches!(
            item.command,
            command::NAV_RETURN_TO_LAUNCH | command::NAV_LAND | command::NAV_VTOL_LAND
        ) || command_row(item.command).is_some_and(|row| row.motion == Motion::NoMotion)
    })
}

/// Whether the first motion of a mission is a landing.
pub(crate) fn lands_first(items: &[Item]) -> bool {
    let navigates =
        |item: &&Item| item.command <= command::NAV_LAST && item.command != command::NAV_DELAY;
    let lands = [command::NAV_LAND, command::NAV_VTOL_LAND];
    let first = items.iter().find(navigates);
    first.is_some_and(|item| lands.contains(&item.command))
}

impl Pilot<'_> {
    /// Lands at a place, which it flies to at the altitude that it has, or where it is: within a distance of where it is
    /// planned to be.
    pub(crate) fn land(
        &mut self,
        row: usize,
        at: Option<LatLon>,
        mission: &VehicleMission,
    ) -> Result<(), Unknown> {
        let around_m = match at {
            None if self.vehicle.airframe.has_wing() => self.lands_around_m(mission),
            _ => 0.0,
        };
        let keeps = self.present_height(&mission.items[row - 1]);
        if let Some(place) = at {
            let at = self.reach(row, place)?;
            let keeps = match at.distance_m(self.last().at) > SAME_PLACE_M {
                true => keeps,
                false => Height::Keep { follows: false },
            };
            let (amsl_m, agl_m) = self.resolve(row, place, keeps)?;
            let knot = self.knot(row, at, amsl_m, agl_m);
            if self.vehicle.facts().stops.before_landing {
                self.stop()?;
            }
            self.append(knot)?;
        }
        let course_rad = self.course_rad();
        self.stop()?;
        self.phase = Phase::Finish;
        let top = self.here();
        let first = self.trajectory.segments.len();
        self.touch_down(row)?;
        let drift_m = around_m + self.vehicle.landing_drift_m(course_rad);
        self.overshoot_landing(row, (first, top));
        self.drift_down(row, (first, top), drift_m);
        Ok(())
    }

    /// The course on which it comes to the last place of the legs that are gathered, if it has one.
    fn course_rad(&self) -> Option<f64> {
        let mut legs = self.knots.windows(2).rev();
        let leg = legs.find(|leg| leg[0].at.distance_m(leg[1].at) > SAME_M)?;
        Some(heading_rad(leg[0].at, leg[1].at))
    }

    pub(crate) fn return_home(
        &mut self,
        row: usize,
        mission: &VehicleMission,
    ) -> Result<(), Unknown> {
        let refuse = |why: &str| Unknown::err(row, why);
        if !mission.rally.is_empty() {
            return refuse("NAV_RETURN_TO_LAUNCH with rally points may end at one of them");
        }
        if let Some(why) = other_return(mission) {
            return refuse(&why);
        }
        if self.vehicle.airframe.has_wing() {
            return self.return_on_wing(row, mission);
        }
        self.stop()?;
        // What the parameters say is flown, whatever the spec says.
        let own_m = self.own_return_m(mission);
        let given_m = self.vehicle.return_amsl.map(|amsl| amsl.0);
        let is_same =
            |given_m: &f64| own_m.is_none_or(|own_m| (own_m - given_m).abs() <= SAME_ALTITUDE_M);
        let Some(return_m) = given_m.filter(is_same).or(own_m) else {
            return refuse(
                "NAV_RETURN_TO_LAUNCH, and no return altitude is given (return_amsl_m, --return-amsl)",
            );
        };
        self.phase = Phase::Finish;
        if self.last().amsl_m < return_m {
            self.climb(row, return_m);
        }
        self.forget_speed(mission);
        let knot = self.knot(row, self.home.at, self.last().amsl_m, None);
        self.append(knot)?;
        self.stop()?;
        self.end_over_home(row, mission)
    }

    /// Takes the speed of a return, whatever the mission commanded: its own, or that of the cruise, without parameters
    /// the planned one (`ModeRTL::init` calls `AC_WPNav::wp_and_spline_init`, PX4's `RtlDirect::on_activation`
    /// `Navigator::reset_cruising_speed`, and ArduPlane's `Mode::enter` clears `new_airspeed_cm`).
    fn forget_speed(&mut self, mission: &VehicleMission) {
        let own_mps = mission.param_si("RTL_SPEED").filter(|mps| *mps > 0.0);
        let held_mps = own_mps.or_else(|| first_speed_mps(mission, self.vehicle.speed_mps));
        let speed_mps = held_mps.unwrap_or(self.vehicle.speed_mps);
        // A float32 in centimetres is the commanded speed.
        let is_it = |mps: f64| (mps - speed_mps).abs() < SAME_MPS;
        if !self.speed_mps.is_some_and(is_it) {
            self.speed_mps = Some(speed_mps);
        }
    }

    /// Waits over home, and lands there or stays, by the parameters.
    fn end_over_home(&mut self, row: usize, mission: &VehicleMission) -> Result<(), Unknown> {
        let (wait, stays_m) = match mission.autopilot {
            Autopilot::ArduPilot => {
                let final_m = mission.param_si("RTL_ALT_FINAL").unwrap_or(0.0);
                let stays_m = (final_m > 0.0).then_some(self.home.amsl.0 + final_m);
                ("RTL_LOIT_TIME", stays_m)
            }
            // At `RTL_DESCEND_ALT`; above it as well as far as is known.
            Autopilot::Px4 => ("RTL_LAND_DELAY", None),
        };
        let wait_s = mission.param_si(wait).unwrap_or(0.0);
        if wait_s < 0.0 {
            return Unknown::err(row, "a return that stays over home (RTL_LAND_DELAY -1)");
        }
        self.hold(row, wait_s);
        let Some(stays_m) = stays_m else {
            return self.touch_down(row);
        };
        let descent_mps = self.vehicle.descent_mps;
        self.lift(row, stays_m, descent_mps, Some(Column::Ground));
        self.finish(row, mission)
    }

    /// The altitude above the sea at which the autopilot returns from here by its own parameters,
    /// if those are given, metres: never below the present one, and lower near home
    /// (`ModeRTL::compute_return_target`; `RTL::computeReturnAltitude`, whose cone ends at
    /// `RTL_MIN_DIST`).
    fn own_return_m(&self, mission: &VehicleMission) -> Option<f64> {
        let (last, home_m) = (self.last(), self.home.amsl.0);
        let away_m = last.at.distance_m(self.home.at);
        let above_m = last.amsl_m - home_m;
        let climbed_m = match mission.autopilot {
            Autopilot::ArduPilot => {
                let climbed_m = above_m + param_si(mission, "RTL_CLIMB_MIN").max(0.0);
                let min_m = climbed_m.max(MIN_RETURN_M);
                let full_m = mission.param_si("RTL_ALT")?.max(min_m);
                let slope = param_si(mission, "RTL_CONE_SLOPE");
                let target_m = if slope >= MIN_CONE_SLOPE {
                    full_m.min((away_m * slope).max(min_m))
                } else {
                    full_m
                };
                target_m.min(below_fence_m(mission))
            }
            Autopilot::Px4 => {
                let full_m = mission.param_si("RTL_RETURN_ALT")?;
                let half_deg = param_si(mission, "RTL_CONE_ANG");
                let cone_until_m = param_si(mission, "RTL_MIN_DIST");
                let radius_m = self.accept_m;
                if half_deg <= 0.0 {
                    full_m
                } else if away_m <= radius_m {
                    full_m.min(2.0 * away_m)
                } else if away_m <= cone_until_m {
                    let cone_m = away_m / half_deg.clamp(1.0, 89.0).to_radians().tan();
                    full_m.min(cone_m.max(2.0 * radius_m))
                } else {
                    full_m
                }
            }
        };
        Some(home_m + climbed_m.max(above_m))
    }

    /// ArduPlane flies straight home, at once at `RTL_ALTITUDE` if it is below and along a slope if
    /// it is above, and circles there with `WP_LOITER_RAD` for ever.
    fn return_on_wing(&mut self, row: usize, mission: &VehicleMission) -> Result<(), Unknown> {
        let own_m = mission
            .param_si("RTL_RADIUS")
            .filter(|radius_m| radius_m.abs() >= 1.0);
        let (Some(above_m), Some(radius_m)) = (
            mission.param_si("RTL_ALTITUDE"),
            own_m.or_else(|| mission.param_si("WP_LOITER_RAD")),
        ) else {
            return Unknown::err(
                row,
                "a return ends in a circle over home, and RTL_ALTITUDE and WP_LOITER_RAD are not known",
            );
        };
        let options = mission.param_si("FLIGHT_OPTIONS").unwrap_or(0.0);
        if options.rem_euclid(2.0 * CLIMB_FIRST) >= CLIMB_FIRST {
            return Unknown::err(row, "a return that climbs before it turns (FLIGHT_OPTIONS)");
        }
        if above_m < 0.0 {
            return Unknown::err(row, "a return at the present altitude (RTL_ALTITUDE -1)");
        }
        let (from, home) = (self.last(), self.home);
        let amsl = Amsl(home.amsl.0 + above_m);
        let place = self.world.frame.from_plan(home.at);
        self.phase = Phase::Finish;
        self.forget_speed(mission);
        if from.amsl_m < amsl.0 {
            // How fast it climbs is its own affair.
            let turned = self.turned_towards(home.at)?;
            let t_s = self.trajectory.t_s;
            for at in std::iter::once(from.at).chain(turned) {
                for amsl in [Amsl(from.amsl_m), amsl] {
                    let ends = [at, home.at].map(|at| PlanPoint { at, amsl });
                    let segment =
                        Segment::unflown((row, self.phase), (t_s, t_s), (ends[0], ends[1]));
                    self.trajectory.segments.push(segment);
                }
            }
        }
        self.circle(row, place, Height::Sea(amsl), radius_m)
    }

    /// Repeats the segments from one on for ever, at no known time.
    pub(crate) fn repeat(&mut self, row: usize, first: usize) -> Result<(), Unknown> {
        if !self.airborne {
            return Unknown::err(row, "no takeoff");
        }
        let last_mps = match self.vehicle.airframe.has_wing() {
            true => self.last().speed_mps,
            false => 0.0,
        };
        self.fly_to_last(last_mps)?;
        let repeated = self.trajectory.segments.get(first..).unwrap_or_default();
        let points: Vec<PlanPoint> = repeated
            .iter()
            .flat_map(|segment| [segment.from, segment.to])
            .collect();
        let middle = middle(&points).unwrap_or_else(|| self.last().point());
        let reach_m = |segment: &Segment| {
            let ends = [segment.from, segment.to].map(|end| end.distance_m(middle));
            ends[0].max(ends[1]) + segment.error_m + segment.wide_m
        };
        let reach_m = repeated.iter().map(reach_m).fold(0.0, f64::max);
        self.flight.repetition = Some(self.trajectory.segments.len());
        let around = (middle, middle);
        self.trajectory
            .straight((row, self.phase), around, f64::INFINITY, None);
        if let Some(stay) = self.trajectory.segments.last_mut() {
            stay.error_m = reach_m;
        }
        self.ended = true;
        self.flight.end = Some(End::Repeats);
        Ok(())
    }

    /// Descends to the ground.
    fn touch_down(&mut self, row: usize) -> Result<(), Unknown> {
        let at = self.last().at;
        let ground_m = match self.world.terrain {
            // Where it touches down is then not judged; when, well enough.
            Terrain::Unknown => self.home.amsl.0,
            _ => self
                .trajectory
                .ground_m(row, self.world.frame.from_plan(at))?,
        };
        let descent = self.descent;
        let slow_m = ground_m + descent.slow_below_m;
        let heights = [self.last().amsl_m, self.home.amsl.0, ground_m].map(Amsl);
        let speeds_mps = (descent.fast_mps, descent.slow_mps);
        let shift_s = landing_shift_s(heights.into(), descent.slow_below_m, speeds_mps);
        self.trajectory.late_s += shift_s.most;
        self.trajectory.early_s -= shift_s.least;
        if self.last().amsl_m > slow_m {
            self.lift(row, slow_m, descent.fast_mps, Some(Column::Ground));
        }
        self.lift(row, ground_m, descent.slow_mps, Some(Column::Ground));
        self.ended = true;
        self.flight.end = Some(End::Landed(at));
        Ok(())
    }

    /// Stays in the air for ever, unless it has landed.
    pub(crate) fn finish(&mut self, row: usize, mission: &VehicleMission) -> Result<(), Unknown> {
        if self.ended {
            return Ok(());
        }
        if !self.airborne {
            return Unknown::err(row, "no takeoff");
        }
        if self.vehicle.airframe.has_wing() {
            // ArduPlane returns then (`Plane::exit_mission_callback`).
            if mission.autopilot == Autopilot::Px4 {
                // It loiters around the place that it flew to last (`MissionBase::setEndOfMissionItems`).
                let last = self.last();
                let Some(radius_m) = mission.param_si("NAV_LOITER_RAD") else {
                    let why = "the mission ends in a circle, and NAV_LOITER_RAD is not known";
                    return Unknown::err(row, why);
                };
                let place = self.world.frame.from_plan(last.at);
                self.fly_to_last(last.speed_mps)?;
                return self.circle(row, place, Height::Sea(Amsl(last.amsl_m)), radius_m);
            }
            return match mission.param_si("RTL_ALTITUDE") {
                Some(_) => self.return_home(row, mission),
                None => Unknown::err(row, "the mission ends in the air, and a wing does not stay"),
            };
        }
        self.stop()?;
        self.hold(row, f64::INFINITY);
        self.ended = true;
        self.flight.end = Some(End::Stays(self.last().at));
        Ok(())
    }
}
