//! What is closed: whether a vehicle is inside of it, and whether an order may be given: the circle
//! of a wing that holds, the way of a return.

use super::breach::{Depth, ERROR_M};
use super::future::nearest;
use super::{Alarms, Here, Watched};
use crate::flight::conformance::COLUMN_M;
use crate::geodesy::{Amsl, EastNorth, PlanPoint};
use crate::numeric::approach::Segment;
use crate::numeric::geometry::point_segment_distance;
use crate::spec::{Airframe, AlarmKind};
use crate::world::Disc;

/// The ground is looked at this often, metres.
const STEP_M: f64 = 10.0;
/// A circle is flown this share of its radius too wide, and this far, metres.
const WIDE_SHARE: f64 = 0.25;
const WIDE_M: f64 = 20.0;
/// An order takes effect after this time, seconds.
const DELAY_S: f64 = 2.0;
/// Others are looked at for this long, seconds.
const AHEAD_S: f64 = 600.0;

impl Alarms<'_> {
    /// Threats and closed zones at a position: every vehicle is held against each, whatever it
    /// flies.
    pub(super) fn look_at_threats(&mut self, vehicle: usize, here: &Here) {
        let duty = self.vehicles[vehicle].duty;
        let is_due = duty.flies && duty.is_up;
        let inside_m = |disc: &Disc| disc.radius_m - disc.center.distance_m(here.point.at);
        let entered = self.threats().map(|(disc, id)| (inside_m(&disc), id));
        let deepest = entered.max_by(|a, b| a.0.total_cmp(&b.0));
        let threat = deepest.filter(|(deep_m, _)| is_due && *deep_m > 0.0);
        let (threat_depth, threat) = (
            Depth::of(
                threat.is_some(),
                threat.is_some_and(|(deep_m, _)| deep_m > ERROR_M),
            ),
            threat.map(|(deep_m, id)| format!("{deep_m:.0} m inside {id}")),
        );
        let ground_m = here.point.amsl.0 - here.agl_m;
        let mut zones = self.spec.no_fly.iter().zip(&self.world.zones);
        let zone = zones
            .find(|(_, shape)| is_due && shape.is_closed_at(here.point, ground_m, here.fix.t_s));
        let zone = zone.map(|(zone, _)| format!("inside {}", zone.id));
        let zone_depth = Depth::of(zone.is_some(), false);
        for (cause, depth, text) in [("threat", threat_depth, threat), ("zone", zone_depth, zone)] {
            let key = (AlarmKind::Threat, vehicle, None, cause);
            let is_alarm = self.breaches.take(here.fix.t_s, key, depth);
            self.set(here.fix.t_s, key, text.filter(|_| is_alarm));
        }
    }

    /// Why the circle on which a wing would hold here is not clear, in words; none if it is, and
    /// of a vehicle without a wing. `None` of a place that is not known is a reason, too.
    #[must_use]
    pub fn circle_problem(&self, t_s: f64, vehicle: usize) -> Option<String> {
        let of = self.vehicles.get(vehicle)?;
        let wing = of.vehicle.wing.filter(|_| of.vehicle.airframe.has_wing())?;
        let Some(here) = of.here else {
            return Some("its place is not known".to_owned());
        };
        let drift_m = here.fix.speed_mps * DELAY_S;
        let reach_m = (1.0 + WIDE_SHARE) * wing.loiter_radius_m + WIDE_M + drift_m;
        let circle = format!("its circle of {:.0} m", wing.loiter_radius_m);
        let rings = count(reach_m / STEP_M);
        for ring in 0..=rings {
            let radius_m = reach_m * f64::from(ring) / f64::from(rings);
            let steps = count(std::f64::consts::TAU * radius_m / STEP_M);
            for step in 0..steps {
                let (sin, cos) =
                    (std::f64::consts::TAU * f64::from(step) / f64::from(steps)).sin_cos();
                let at = EastNorth {
                    east_m: here.point.at.east_m + radius_m * sin,
                    north_m: here.point.at.north_m + radius_m * cos,
                };
                let amsl = here.point.amsl;
                if let Some(why) = self.place_problem(PlanPoint { at, amsl }, t_s) {
                    return Some(format!("{circle} {why}"));
                }
            }
        }
        let at = [here.point.at.east_m, here.point.at.north_m];
        for (disc, id) in self.threats() {
            let center = [disc.center.east_m, disc.center.north_m];
            let left_m = (center[0] - at[0]).hypot(center[1] - at[1]) - disc.radius_m - reach_m;
            if left_m < 0.0 {
                return Some(format!("{circle} leads into {id}"));
            }
        }
        let stays = Segment::between((t_s, axes(&here)), (t_s + AHEAD_S, axes(&here)));
        self.meets(t_s, vehicle, &[stays], reach_m)
            .map(|why| format!("{circle} {why}"))
    }

    /// Why a return to launch from here is not verified, in words; none if it is: the climb to
    /// the altitude of the return, the straight leg home, the descent.
    #[must_use]
    pub fn return_problem(&self, t_s: f64, vehicle: usize) -> Option<String> {
        let of = self.vehicles.get(vehicle)?;
        let (Some(here), Some(home)) = (of.here, of.plan.waypoints.first()) else {
            return Some("its place or its home is not known".to_owned());
        };
        let Some(return_amsl) = of.vehicle.return_amsl else {
            return Some("no return_amsl_m is given".to_owned());
        };
        let level_m = here.point.amsl.0.max(return_amsl.0);
        // A wing climbs on its way.
        let amsl = Amsl(match of.vehicle.airframe {
            Airframe::Copter => level_m,
            Airframe::Plane | Airframe::Vtol => here.point.amsl.0.min(return_amsl.0),
        });
        if level_m > self.spec.area.max_amsl.0 {
            return Some("its return is above the ceiling".to_owned());
        }
        let (from, to) = (here.point.at, home.point.at);
        let length_m = from.distance_m(to);
        let steps = count(length_m / STEP_M);
        for step in 0..=steps {
            let share = f64::from(step) / f64::from(steps);
            let at = EastNorth {
                east_m: from.east_m + share * (to.east_m - from.east_m),
                north_m: from.north_m + share * (to.north_m - from.north_m),
            };
            // Over its home it comes down.
            if at.distance_m(to) > COLUMN_M
                && let Some(why) = self.place_problem(PlanPoint { at, amsl }, t_s)
            {
                return Some(format!("its way home {why}"));
            }
        }
        let flat = |at: EastNorth| [at.east_m, at.north_m];
        for (disc, id) in self.threats() {
            let away_m = point_segment_distance(flat(disc.center), flat(from), flat(to));
            if away_m < disc.radius_m {
                return Some(format!("its way home leads into {id}"));
            }
        }
        let way = return_way(of, &here, (level_m, home.point), t_s);
        self.meets(t_s, vehicle, &way, 0.0)
            .map(|why| format!("its way home {why}"))
    }

    /// What is wrong with a place on the route.
    fn place_problem(&self, point: PlanPoint, t_s: f64) -> Option<String> {
        let place = self.world.frame.from_plan(point.at);
        let Ok(ground) = self.world.terrain.height(place) else {
            return Some("has no elevation data".to_owned());
        };
        let agl_m = point.amsl.above_ground(ground).0;
        let least_m = self.spec.area.min_agl.0;
        if agl_m < least_m {
            return Some(format!(
                "is {agl_m:.0} m over the ground (at least {least_m:.0} m)"
            ));
        }
        if !self.world.in_area(point.at) {
            return Some("leaves the area".to_owned());
        }
        let mut zones = self.spec.no_fly.iter().zip(&self.world.zones);
        // It may come up while the vehicle is there.
        let closed = zones.find(|(_, shape)| {
            let is_closed = |at_s: f64| shape.is_closed_at(point, ground.0, at_s);
            is_closed(t_s) || is_closed(t_s + AHEAD_S)
        });
        closed.map(|(zone, _)| format!("leads into {}", zone.id))
    }

    /// The vehicle that a way meets, in words.
    fn meets(&self, t_s: f64, vehicle: usize, way: &[Segment], wide_m: f64) -> Option<String> {
        let mut limit = self.spec.separation;
        limit.distance_m += wide_m;
        (0..self.vehicles.len()).find_map(|other| {
            let future = (other != vehicle).then(|| self.future(t_s, other))??;
            let (away_m, at_s) = nearest(way, &future.segments, &limit)?;
            let id = &self.vehicles[other].vehicle.id;
            (away_m < limit.distance_m).then(|| {
                let left_m = (away_m - wide_m).max(0.0);
                format!("comes within {left_m:.0} m of {id} at T0+{at_s:.0} s")
            })
        })
    }
}

/// The climb to the altitude of the return, the leg home, and the descent.
fn return_way(
    of: &Watched<'_>,
    here: &Here,
    (level_m, home): (f64, PlanPoint),
    t_s: f64,
) -> Vec<Segment> {
    let [east_m, north_m, up_m] = axes(here);
    let home_m = [home.at.east_m, home.at.north_m, home.amsl.0];
    let over_m = [home_m[0], home_m[1], level_m];
    let climbed = (
        [east_m, north_m, level_m],
        (level_m - up_m).abs() / of.vehicle.climb_mps,
    );
    let flown_s = here.point.at.distance_m(home.at) / of.vehicle.speed_mps;
    let sunk_s = (level_m - home_m[2]).abs() / of.vehicle.descent_mps;
    let mut way = Vec::new();
    let mut from = (t_s, axes(here));
    for (to_m, took_s) in [climbed, (over_m, flown_s), (home_m, sunk_s)] {
        let to = (from.0 + took_s.max(1e-3), to_m);
        way.push(Segment::between(from, to));
        from = to;
    }
    way
}

fn axes(here: &Here) -> [f64; 3] {
    [
        here.point.at.east_m,
        here.point.at.north_m,
        here.point.amsl.0,
    ]
}

/// A number of steps: at least one.
fn count(of: f64) -> u32 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "`as` saturates, and a distance is within the area"
    )]
    let count = of.ceil().max(1.0) as u32;
    count.min(100_000)
}
