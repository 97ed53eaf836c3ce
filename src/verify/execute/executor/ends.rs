//! How a flight ends: landed, at home again, or in the air for ever.

use super::Pilot;
use crate::autopilot::{Autopilot, Motion, SLOW_LANDING_M, command_row, parameter};
use crate::geodesy::{Amsl, LatLon, PlanPoint};
use crate::mission::{Item, VehicleMission, command};
use crate::path::heading_rad;
use crate::verify::execute::decode::Unknown;
use crate::verify::execute::flight::End;
use crate::verify::execute::item::Height;
use crate::verify::measure::segment::{Chord, Phase};
use crate::world::Terrain;

/// Places nearer than this are one, metres.
const SAME_M: f64 = 1.0;
/// `RTL_ALT_MIN` of ArduCopter, metres.
const LEAST_RETURN_M: f64 = 2.0;
/// `RTL_MIN_CONE_SLOPE` of ArduCopter: with less there is no cone.
const LEAST_CONE_SLOPE: f64 = 0.5;
/// `RTL_ABS_MIN_CLIMB` of ArduCopter, metres.
const LEAST_CLIMB_M: f64 = 2.5;

/// A parameter of the mission in SI units (angles in degrees), if it is given.
pub(crate) fn held(mission: &VehicleMission, name: &str) -> Option<f64> {
    let found = mission.params.iter().find(|param| param.name == name)?;
    let value = f64::from(found.value) / parameter(name)?.unit.per_si();
    value.is_finite().then_some(value)
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

impl Pilot<'_> {
    pub(crate) fn land(&mut self, row: usize, at: Option<LatLon>) -> Result<(), Unknown> {
        if let Some(place) = at {
            let last = self.last();
            let at = self.reach(row, place)?;
            let knot = self.knot(row, at, last.amsl_m, None);
            if self.vehicle.facts().stops.before_landing {
                self.stop()?;
            }
            self.append(knot)?;
        }
        let course_rad = self.course_rad();
        self.stop()?;
        self.phase = Phase::Finish;
        let top = self.here();
        let first = self.trajectory.chords.len();
        self.touch_down(row)?;
        self.drift_down(row, (first, top), course_rad);
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
        if self.vehicle.airframe.has_wing() {
            return self.return_on_wing(row, mission);
        }
        self.stop()?;
        let own_m = self.own_return_m(mission);
        let given_m = self.vehicle.return_amsl.map(|amsl| amsl.0);
        let Some(return_m) = given_m.or(own_m) else {
            return refuse(
                "NAV_RETURN_TO_LAUNCH, and no return altitude is given (return_amsl_m, --return-amsl)",
            );
        };
        self.phase = Phase::Finish;
        if self.last().amsl_m < return_m {
            self.climb(row, return_m);
        }
        let knot = self.knot(row, self.home.at, self.last().amsl_m, None);
        self.append(knot)?;
        self.stop()?;
        if given_m.is_none() {
            self.hold(row, held(mission, "RTL_LOIT_TIME").unwrap_or(0.0));
        }
        self.touch_down(row)
    }

    /// The altitude above the sea at which the autopilot returns from here by its own parameters,
    /// if those are given, metres: never below the present one, and lower near home
    /// (`ModeRTL::compute_return_target`; `RTL::calculate_return_alt_from_cone_half_angle`).
    fn own_return_m(&self, mission: &VehicleMission) -> Option<f64> {
        let (last, home_m) = (self.last(), self.home.amsl.0);
        let away_m = last.at.distance_m(self.home.at);
        let above_m = last.amsl_m - home_m;
        let climbed_m = match mission.autopilot {
            Autopilot::ArduPilot => {
                let full_m = held(mission, "RTL_ALT")?.max(LEAST_RETURN_M).max(above_m);
                let slope = held(mission, "RTL_CONE_SLOPE").unwrap_or(0.0);
                if slope >= LEAST_CONE_SLOPE {
                    full_m.min((away_m * slope).max(above_m + LEAST_CLIMB_M))
                } else {
                    full_m
                }
            }
            Autopilot::Px4 => {
                let full_m = held(mission, "RTL_RETURN_ALT")?;
                let half_deg = held(mission, "RTL_CONE_ANG").unwrap_or(0.0);
                let radius_m = self.accept_m;
                if half_deg <= 0.0 {
                    full_m
                } else if away_m <= radius_m {
                    full_m.min(2.0 * away_m)
                } else {
                    let cone_m = away_m / half_deg.to_radians().tan();
                    full_m.min(cone_m.max(2.0 * radius_m))
                }
            }
        };
        Some(home_m + climbed_m.max(above_m))
    }

    /// ArduPlane flies straight home, at once at `RTL_ALTITUDE` if it is below and along a slope if
    /// it is above, and circles there with `WP_LOITER_RAD` for ever.
    fn return_on_wing(&mut self, row: usize, mission: &VehicleMission) -> Result<(), Unknown> {
        let (Some(above_m), Some(radius_m)) = (
            held(mission, "RTL_ALTITUDE"),
            held(mission, "WP_LOITER_RAD"),
        ) else {
            return Unknown::err(
                row,
                "a return ends in a circle over home, and RTL_ALTITUDE and WP_LOITER_RAD are not known",
            );
        };
        if above_m < 0.0 {
            return Unknown::err(row, "a return at the present altitude (RTL_ALTITUDE -1)");
        }
        let (from, home) = (self.last(), self.home);
        let amsl = Amsl(home.amsl.0 + above_m);
        let place = self.world.frame.from_plan(home.at);
        self.phase = Phase::Finish;
        if from.amsl_m < amsl.0 {
            // How fast it climbs is its own affair.
            let level = PlanPoint {
                at: home.at,
                amsl: Amsl(from.amsl_m),
            };
            let t_s = self.trajectory.t_s;
            let chord = Chord::unflown((row, self.phase), (t_s, t_s), (from.point(), level));
            self.trajectory.chords.push(chord);
        }
        self.circle(row, place, Height::Sea(amsl), radius_m)
    }

    /// Repeats the chords from one on for ever, at no known time.
    pub(crate) fn repeat(&mut self, row: usize, first: usize) -> Result<(), Unknown> {
        if !self.airborne {
            return Unknown::err(row, "no takeoff");
        }
        let last_mps = match self.vehicle.airframe.has_wing() {
            true => self.last().speed_mps,
            false => 0.0,
        };
        self.fly_to_last(last_mps)?;
        let repeated = self.trajectory.chords.get(first..).unwrap_or_default();
        let points: Vec<PlanPoint> = repeated
            .iter()
            .flat_map(|chord| [chord.from, chord.to])
            .collect();
        let middle = middle(&points).unwrap_or_else(|| self.last().point());
        let reach_m = |chord: &Chord| {
            let ends = [chord.from, chord.to].map(|end| end.distance_m(middle));
            ends[0].max(ends[1]) + chord.error_m + chord.wide_m
        };
        let reach_m = repeated.iter().map(reach_m).fold(0.0, f64::max);
        self.flight.repetition = Some(self.trajectory.chords.len());
        let around = (middle, middle);
        self.trajectory
            .straight((row, self.phase), around, f64::INFINITY, false);
        if let Some(stay) = self.trajectory.chords.last_mut() {
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
        let slow_mps = self.vehicle.facts().behaviour.slow_landing_mps;
        let descent_mps = self.vehicle.descent_mps;
        let slow_m = ground_m + SLOW_LANDING_M;
        if self.last().amsl_m > slow_m {
            self.lift(row, slow_m, descent_mps, true);
        }
        self.lift(row, ground_m, descent_mps.min(slow_mps), true);
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
                let Some(radius_m) = held(mission, "NAV_LOITER_RAD") else {
                    let why = "the mission ends in a circle, and NAV_LOITER_RAD is not known";
                    return Unknown::err(row, why);
                };
                let place = self.world.frame.from_plan(last.at);
                self.fly_to_last(last.speed_mps)?;
                return self.circle(row, place, Height::Sea(Amsl(last.amsl_m)), radius_m);
            }
            return match held(mission, "RTL_ALTITUDE") {
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
