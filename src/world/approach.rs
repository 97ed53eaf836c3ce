//! On which course a wing comes to its landing where the spec leaves that open: into the wind, or on
//! the course nearest to that on which nothing is in the way.

use std::f64::consts::PI;

use super::{VehicleSites, World};
use crate::geodesy::{Amsl, EastNorth, PlanPoint};
use crate::numeric::geometry;
use crate::spec::{Airframe, ApproachLengths, Issue, MissionSpec, SpecFile, Vehicle, Wind};

/// Step from one course that is tried to the next, radians, to either side of the wind.
const STEP_RAD: f64 = 15.0 * PI / 180.0;
const STEPS: u8 = 12;
/// Places that are looked at are no further apart, metres.
const APART_M: f64 = 15.0;
/// On a glide the ground must stay this share of the height above the runway below the vehicle.
const SLOPE_SHARE: f64 = 0.5;

/// An approach to a landing on a course.
struct Candidate<'a> {
    vehicle: &'a Vehicle,
    touchdown: PlanPoint,
    /// The altitude at which it begins.
    from: Amsl,
    course_rad: f64,
    lengths: ApproachLengths,
}

impl Candidate<'_> {
    /// The place at a distance before the touchdown, and at one to the right of the course.
    fn at(&self, before_m: f64, aside_m: f64) -> EastNorth {
        let (sin, cos) = self.course_rad.sin_cos();
        EastNorth {
            east_m: self.touchdown.at.east_m - before_m * sin + aside_m * cos,
            north_m: self.touchdown.at.north_m - before_m * cos - aside_m * sin,
        }
    }

    /// Its altitude there, and the least height above ground, metres.
    fn altitude_m(&self, before_m: f64, min_agl_m: f64) -> (f64, f64) {
        let glides = self.vehicle.airframe == Airframe::Plane && before_m < self.lengths.straight_m;
        if !glides {
            return (self.from.0, min_agl_m);
        }
        let down_m = self.touchdown.amsl.0;
        let over_m = (self.from.0 - down_m) * before_m / self.lengths.straight_m;
        (down_m + over_m, min_agl_m.min(SLOPE_SHARE * over_m))
    }

    /// Whether it can be flown in a wind: a glide must not sink too fast, and the wind must not come
    /// from behind where that drives the vehicle off its landing.
    fn is_flyable(&self) -> bool {
        let Some(landing) = self.vehicle.wing.and_then(|wing| wing.landing) else {
            return false;
        };
        let vehicle = self.vehicle;
        let ground_mps = vehicle.ground_speed_mps(vehicle.speed_mps, self.from, self.course_rad);
        let Some(ground_mps) = ground_mps else {
            return false;
        };
        let sinks_mps = ground_mps * landing.glide_rad.tan();
        let is_steep = vehicle.airframe == Airframe::Plane && sinks_mps > vehicle.descent_mps;
        !is_steep && vehicle.landing_drift_m(Some(self.course_rad)) <= 0.0
    }
}

impl World {
    /// The same world with the courses of landings that the spec leaves open.
    pub(super) fn with_approaches(mut self, spec: &MissionSpec) -> Self {
        for (index, vehicle) in spec.vehicles.iter().enumerate() {
            let Some(wind) = vehicle.approach_wind() else {
                continue;
            };
            // A plane must land on some course, and the verdict says what is in its way.
            let is_plane = vehicle.airframe == Airframe::Plane;
            let free_rad = self.free_landing_rad(vehicle, &self.sites[index]);
            let landing_rad = free_rad.or(is_plane.then_some(wind.from_rad));
            let sites = &mut self.sites[index];
            sites.landing_rad = landing_rad;
            sites.goal = super::route_end(vehicle, landing_rad, sites.goal, sites.goal_ground);
        }
        self
    }

    /// The course into the wind, or the nearest to it, on which nothing is in the way of the approach to
    /// a landing; none if there is no such course.
    fn free_landing_rad(&self, vehicle: &Vehicle, sites: &VehicleSites) -> Option<f64> {
        let wind = vehicle.approach_wind()?;
        let (touchdown, from) = sites.touchdown(vehicle.finish);
        let lengths = vehicle.approach_lengths(from.0 - touchdown.amsl.0)?;
        let turns_m = vehicle.wing?.loiter_radius_m;
        let is_free = |course_rad: &f64, aside_m: f64| {
            let candidate = Candidate {
                vehicle,
                touchdown,
                from,
                course_rad: *course_rad,
                lengths,
            };
            candidate.is_flyable() && self.is_clear(&candidate, aside_m)
        };
        // With space for the turns onto it, if there is such a course.
        let mut wide = courses(wind);
        wide.find(|course_rad| is_free(course_rad, turns_m))
            .or_else(|| courses(wind).find(|course_rad| is_free(course_rad, 0.0)))
    }

    /// Whether nothing is in the way of an approach, with as much to either side before its straight leg.
    fn is_clear(&self, of: &Candidate<'_>, aside_m: f64) -> bool {
        let (straight_m, turns_m) = (of.lengths.straight_m, of.lengths.gate_m);
        let straight = stations_along(0.0, straight_m).map(|before_m| (before_m, 0.0));
        let turns = stations_along(straight_m, straight_m + turns_m).flat_map(|before_m| {
            stations_along(-aside_m, aside_m).map(move |aside_m| (before_m, aside_m))
        });
        straight
            .chain(turns)
            .all(|place| self.is_clear_at(of, place))
    }

    fn is_clear_at(&self, of: &Candidate<'_>, (before_m, aside_m): (f64, f64)) -> bool {
        let at = of.at(before_m, aside_m);
        let (amsl_m, min_m) = of.altitude_m(before_m, self.min_agl.0);
        let amsl = Amsl(amsl_m);
        self.is_free_above(PlanPoint { at, amsl }, min_m)
    }

    /// Whether nothing is in the way at a point: it is in the area, high enough above the ground, and off threats and
    /// zones, whenever these are active.
    #[must_use]
    pub fn is_free(&self, point: PlanPoint) -> bool {
        self.is_free_above(point, self.min_agl.0)
    }

    /// The same with another least height above the ground, metres.
    fn is_free_above(&self, point: PlanPoint, min_agl_m: f64) -> bool {
        let PlanPoint { at, amsl } = point;
        let Ok(ground) = self.terrain.height_at(&self.frame, at) else {
            return false;
        };
        self.in_area(at)
            && amsl.0 - ground.0 >= min_agl_m
            && !self.threats.iter().any(|threat| threat.contains(at))
            && !(self.zones.iter()).any(|zone| zone.is_closed_at(point, ground.0, f64::NAN))
    }
}

/// Planes whose course to their landing is left open, where no course is free.
pub(super) fn blocked(file: &SpecFile, world: &World, paths: &[String]) -> Vec<Issue> {
    let vehicles = file.spec.vehicles.iter().zip(&world.sites).enumerate();
    let blocked = vehicles.filter(|(_, (vehicle, sites))| {
        let is_open = vehicle.airframe == Airframe::Plane && vehicle.approach_wind().is_some();
        is_open && world.free_landing_rad(vehicle, sites).is_none()
    });
    let issue = |(index, _): (usize, _)| {
        file.issue(
            &format!("{}.landing", paths[index]),
            "no course to the landing is free, whatever the wind".to_owned(),
            "one inside the area, off threats and zones, above the ground: by glide_deg, \
             loiter_radius_m or the height, or heading_deg"
                .to_owned(),
        )
    };
    blocked.map(issue).collect()
}

/// Courses from the one into the wind on, to either side.
fn courses(wind: Wind) -> impl Iterator<Item = f64> {
    let sides = (1..=STEPS).flat_map(|step| {
        let off_rad = STEP_RAD * f64::from(step);
        [off_rad, -off_rad]
    });
    let offs = std::iter::once(0.0).chain(sides);
    offs.map(move |off_rad| (wind.from_rad + off_rad).rem_euclid(2.0 * PI))
}

/// Distances from one to another, not far apart.
fn stations_along(from_m: f64, to_m: f64) -> impl Iterator<Item = f64> {
    let steps = geometry::steps(to_m - from_m, APART_M, (1, 10_000));
    (0..=steps).map(move |step| from_m + (to_m - from_m) * f64::from(step) / f64::from(steps))
}
