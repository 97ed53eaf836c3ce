//! Room around the takeoff of a vehicle that leaves it where its nose points.
//!
//! What is reported here fails on every path: the verdict judges the whole region. A path may climb
//! over ground there, and zones that follow the ground or the clock show only in the plan.

use std::f64::consts::TAU;

use super::{Check, within};
use crate::geodesy::{Agl, EastNorth, PlanPoint};
use crate::numeric::digits;
use crate::numeric::geometry::{self, Ring};
use crate::spec::{TakeoffRegion, Vehicle, Zone, zone_buffer_m};
use crate::world::PlanZone;

/// Places in the region over which the ground is looked at are no further apart, metres.
const APART_M: f64 = 15.0;

/// The region of one vehicle: the top of its takeoff, and how far it may be from that.
struct Around<'a> {
    vehicle: &'a Vehicle,
    path: String,
    /// What stands in the middle.
    what: &'static str,
    top: PlanPoint,
    region: TakeoffRegion,
}

impl Around<'_> {
    /// What is needed of a distance, with the part of it that no region has.
    fn allowed(&self, limit_m: f64, of: &str) -> String {
        let region = &self.region;
        let wind = match region.drift_m + region.carried_m {
            wind_m if wind_m > 0.0 => format!(", {wind_m:.0} m in this wind"),
            _ => String::new(),
        };
        format!(
            "at least {:.0} m: {of}, and {:.0} m in which {} may be before it is on its first leg \
             ({:.0} m to forward flight, {:.0} m for two turn radii{wind})",
            (limit_m + region.reach_m()).ceil(),
            region.reach_m().ceil(),
            self.vehicle.facts().firmware,
            region.transition_m,
            region.turn_m,
        )
    }
}

impl Check<'_> {
    /// Reports what is nearer to the takeoff than the region that the verdict judges.
    pub(super) fn takeoff_region(&mut self, path: &str, vehicle: &Vehicle) {
        let spec = &self.file.spec;
        // Without ground there that is reported already.
        let (Ok(ground), Ok(start)) = (
            self.terrain.height(vehicle.home),
            crate::world::resolve(&spec.frame, self.terrain, vehicle.start),
        ) else {
            return;
        };
        // The planner may choose the slowest of its speeds.
        let slowest = Vehicle {
            speed_mps: vehicle.speeds().least,
            ..vehicle.clone()
        };
        let Some(region) = slowest.takeoff_region(start.amsl.0 - ground.0) else {
            return;
        };
        let what = match vehicle.home == vehicle.start.place {
            true => "start",
            false => "home",
        };
        let around = Around {
            vehicle,
            path: format!("{path}.{what}"),
            what,
            top: PlanPoint {
                at: spec.frame.to_plan(vehicle.home),
                ..start
            },
            region,
        };
        self.region_in_area(&around);
        self.region_off_threats(&around);
        self.region_off_zones(&around);
        self.region_over_ground(&around);
    }

    fn region_in_area(&mut self, around: &Around<'_>) {
        let spec = &self.file.spec;
        let outline = spec.frame.outline(&spec.area.outline());
        let edge_m = Ring::around(&outline).boundary_distance(crate::world::point(around.top.at));
        let buffer_m = spec.buffers.area_m;
        // Outside of it that is reported already.
        let is_inside = crate::world::covers(&outline, around.top.at);
        let needed_m = buffer_m + around.region.reach_m();
        if is_inside && edge_m >= buffer_m && edge_m < needed_m {
            let is_m = digits::distinct_from(edge_m, needed_m, 0);
            let found = format!("{} is {is_m} m from the edge of the area", around.what);
            let of = format!("the edge{}", within(buffer_m));
            self.report(&around.path, found, around.allowed(buffer_m, &of));
        }
    }

    fn region_off_threats(&mut self, around: &Around<'_>) {
        let spec = &self.file.spec;
        let buffer_m = spec.buffers.threats_m;
        for threat in &spec.threats {
            let away_m = spec.frame.to_plan(threat.place).distance_m(around.top.at);
            let limit_m = threat.radius_m + buffer_m;
            let needed_m = limit_m + around.region.reach_m();
            // Nearer than the threat itself allows is reported already.
            if (limit_m..needed_m).contains(&away_m) {
                let is_m = digits::distinct_from(away_m, needed_m, 0);
                let found = format!(
                    "{} is {is_m} m from the axis of threat `{}`",
                    around.what, threat.id
                );
                let of = format!("its radius of {} m{}", threat.radius_m, within(buffer_m));
                self.report(&around.path, found, around.allowed(limit_m, &of));
            }
        }
    }

    fn region_off_zones(&mut self, around: &Around<'_>) {
        let spec = &self.file.spec;
        let always = spec.no_fly.iter().filter(|zone| zone.active_s.is_none());
        for zone in always {
            let buffer_m = zone_buffer_m(&spec.buffers, zone);
            let away_m = self.zone_away_m(zone, buffer_m, around.top);
            let needed_m = buffer_m + around.region.reach_m();
            let Some(away_m) = away_m.filter(|m| (buffer_m..needed_m).contains(m)) else {
                continue;
            };
            let is_m = digits::distinct_from(away_m, needed_m, 0);
            let found = format!("{} is {is_m} m from no-fly zone `{}`", around.what, zone.id);
            let of = format!("its outline{}", within(buffer_m));
            self.report(&around.path, found, around.allowed(buffer_m, &of));
        }
    }

    /// How far a point is from a zone that is closed at its altitude, whatever the ground, metres.
    fn zone_away_m(&self, zone: &Zone, buffer_m: f64, point: PlanPoint) -> Option<f64> {
        let outline = self.file.spec.frame.outline(&zone.outline());
        let is_inside = crate::world::covers(&outline, point.at);
        let away_m = Ring::around(&outline).boundary_distance(crate::world::point(point.at));
        let shape = PlanZone::new(outline, zone, 0.0, self.terrain);
        let (from_m, below_m) = shape.closed_m(f64::NAN);
        let is_closed = (from_m - buffer_m..below_m + buffer_m).contains(&point.amsl.0);
        (is_closed && !is_inside && !shape.follows_ground()).then_some(away_m)
    }

    /// The highest ground of the region, less what a path may climb on its way there.
    fn region_over_ground(&mut self, around: &Around<'_>) {
        let spec = &self.file.spec;
        let min_m = self.min_agl().buffered_m;
        let vehicle = around.vehicle;
        let by_speed = vehicle.climb_mps / vehicle.speed_mps;
        let slope = vehicle
            .max_climb_rad
            .map_or(by_speed, |rad| rad.tan().min(by_speed));
        let reach_m = around.region.reach_m();
        let over_m = |at: EastNorth| {
            let ground = self.terrain.height_at(&spec.frame, at).ok()?;
            let climbed_m = slope * (reach_m + at.distance_m(around.top.at));
            Some((around.top.amsl.above_ground(ground).0, climbed_m))
        };
        let heights = disc(around.top.at, reach_m).filter_map(|at| Some((at, over_m(at)?)));
        let worst = heights.min_by(|(_, a), (_, b)| (a.0 + a.1).total_cmp(&(b.0 + b.1)));
        let Some((at, (over_m, climbed_m))) = worst else {
            return;
        };
        if over_m + climbed_m < min_m {
            let place = spec.frame.from_plan(at);
            let over = digits::distinct_from(over_m, min_m, 0);
            let found = format!(
                "{over} m above the ground at {:.5}, {:.5}, {:.0} m from {}",
                place.lat_deg,
                place.lon_deg,
                at.distance_m(around.top.at),
                around.what
            );
            let Agl(limit_m) = spec.area.min_agl;
            let allowed = format!(
                "at least {min_m:.0} m (area.min_agl_m {limit_m}{}) within {:.0} m, where {} may be before it is \
                 on its first leg: a higher start, or one elsewhere",
                within(spec.buffers.terrain_m),
                reach_m.ceil(),
                vehicle.facts().firmware
            );
            self.report(&around.path, found, allowed);
        }
    }
}

/// Places of a disc.
fn disc(middle: EastNorth, radius_m: f64) -> impl Iterator<Item = EastNorth> {
    let rings = steps(radius_m);
    (0..=rings).flat_map(move |ring| {
        let ring_m = radius_m * f64::from(ring) / f64::from(rings);
        let count = steps(TAU * ring_m);
        (0..count).map(move |step| {
            let (sin, cos) = (TAU * f64::from(step) / f64::from(count)).sin_cos();
            EastNorth {
                east_m: middle.east_m + ring_m * sin,
                north_m: middle.north_m + ring_m * cos,
            }
        })
    })
}

/// Into how many steps a length is cut.
fn steps(length_m: f64) -> u16 {
    geometry::steps(length_m, APART_M, (1, 1000))
}
