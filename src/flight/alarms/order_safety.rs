//! What is closed: whether a vehicle is inside of it, and whether an order may be given: the circle
//! of a wing that holds, the way of a return.

use super::breach::{Depth, ERROR_M};
use super::future::{SLOW_MPS, nearest};
use super::{Alarms, Here, Watched};
use crate::autopilot::Autopilot;
use crate::flight::conformance::COLUMN_M;
use crate::geodesy::{Amsl, EastNorth, PlanPoint};
use crate::numeric::approach::Segment;
use crate::numeric::geometry::point_segment_distance;
use crate::spec::{Airframe, AlarmKind, Separation, Vehicle};
use crate::world::Disc;

/// The ground is looked at this often, metres.
const STEP_M: f64 = 10.0;
/// A circle is flown this share of its radius too wide, and this far, metres.
const WIDE_SHARE: f64 = 0.25;
const WIDE_M: f64 = 20.0;
/// An order takes effect after this time, seconds.
const DELAY_S: f64 = 2.0;
/// A rally point that is farther than home by more is none that an autopilot returns to, metres: which is
/// nearer is decided a moment later, somewhere else.
const RALLY_FARTHER_M: f64 = 100.0;
/// `RALLY_LIMIT_KM` of `ArduPlane`, metres.
const RALLY_REACH_M: f64 = 5000.0;
/// Two that return may come anywhere on their ways at any time, seconds.
const EVER_S: f64 = 10_000.0;
/// By how much a return may be off its times, seconds and a share of how long it takes.
const OFF_S: f64 = 30.0;
const OFF_SHARE: f64 = 0.5;
/// Others are looked at for this long, seconds.
const AHEAD_S: f64 = 600.0;

/// How a way is held against where others will be.
#[derive(Clone, Copy)]
enum Timing {
    /// At the same times; it is so much wider, metres.
    Within(f64),
    /// At about the same times: autopilots return faster or slower than planned, and others rest.
    About,
}

/// Where a vehicle may return to.
struct ReturnPlace {
    point: PlanPoint,
    /// Altitude of the way there, if it is not higher already.
    level_amsl: Amsl,
    /// The way, in words.
    way: String,
}

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

    /// What is wrong with the battery of a vehicle, in words.
    #[must_use]
    pub fn battery_problem(&self, vehicle: usize) -> Option<String> {
        self.vehicles.get(vehicle)?.health.battery()
    }

    /// What a vehicle has never reported, in words: nothing raises an alarm of that.
    #[must_use]
    pub fn unreported(&self, vehicle: usize) -> Option<String> {
        let what = self.vehicles.get(vehicle)?.health.unreported();
        (!what.is_empty()).then(|| {
            let what = what.join(" and ");
            format!("has not reported {what}: no alarm will come of that unless it does")
        })
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
        self.meets(t_s, vehicle, &[stays], Timing::Within(reach_m))
            .map(|why| format!("{circle} {why}"))
    }

    /// Why a return to launch from here is not verified, in words; none if it is: the climb to
    /// the altitude of the return, the straight leg, the descent; home, and to each rally point
    /// that the autopilot may return to instead.
    #[must_use]
    pub fn return_problem(&self, t_s: f64, vehicle: usize) -> Option<String> {
        let of = self.vehicles.get(vehicle)?;
        let Some(here) = of.here else {
            return Some("its place is not known".to_owned());
        };
        let Some(return_amsl) = of.vehicle.return_amsl else {
            return Some("no return_amsl_m is given".to_owned());
        };
        if let Some(why) = of.onboard.returns_elsewhere(t_s) {
            return Some(why);
        }
        let ends = self.return_ends(of, &here, return_amsl);
        let mut ends = ends.iter();
        ends.find_map(|place| self.return_problem_to(t_s, (vehicle, of), (&here, place)))
    }

    /// Takes in that a vehicle was ordered to return, or to do something else. How fast it returns is not
    /// known, so that others stay out of all of its way.
    pub fn ordered(&mut self, t_s: f64, vehicle: usize, returns: bool) {
        let way = self
            .vehicles
            .get(vehicle)
            .filter(|_| returns)
            .and_then(|of| {
                let (here, amsl) = (of.here?, of.vehicle.return_amsl?);
                let ends = self.return_ends(of, &here, amsl);
                let ways = ends.iter().flat_map(|place| {
                    let level_m = here.point.amsl.0.max(place.level_amsl.0);
                    way_of_return(of.vehicle, here.point, (level_m, place.point), t_s)
                });
                Some(ways.collect())
            });
        if let Some(of) = self.vehicles.get_mut(vehicle) {
            of.returns = way.unwrap_or_default();
        }
    }

    /// Home, and the rally points that it may return to instead.
    fn return_ends(&self, of: &Watched<'_>, here: &Here, level_amsl: Amsl) -> Vec<ReturnPlace> {
        let home = ReturnPlace {
            // The plan that it flies may begin in the air.
            point: of.mission.home_point(&self.world.frame),
            level_amsl,
            way: "its way home".to_owned(),
        };
        let rally = self.rally_ends(of, here, &home);
        std::iter::once(home).chain(rally).collect()
    }

    /// The rally points that the autopilot may return to from here, as `AP_Rally` and the returns of
    /// PX4 choose them: those that are not much farther than home, and of a wing of `ArduPilot`, which
    /// does not count home (`RALLY_INCL_HOME`), all within the reach of the parameter.
    fn rally_ends(&self, of: &Watched<'_>, here: &Here, home: &ReturnPlace) -> Vec<ReturnPlace> {
        let (frame, terrain) = (&self.world.frame, &self.world.terrain);
        let (autopilot, airframe) = (of.mission.autopilot, of.vehicle.airframe);
        let is_px4 = autopilot == Autopilot::Px4;
        let home_m = here.point.at.distance_m(home.point.at);
        let reach_m = rally_reach_m(autopilot, airframe, home_m);
        let mut ends = Vec::new();
        for (index, item) in of.mission.rally.iter().enumerate() {
            let Some(place) = item.place() else { continue };
            let at = frame.to_plan(place);
            if here.point.at.distance_m(at) > reach_m {
                continue;
            }
            // Without data the way is refused for that.
            let amsl = terrain.height(place).unwrap_or(home.point.amsl);
            // PX4 counts its return altitude from where it returns to.
            let higher_m = if is_px4 {
                amsl.0 - home.point.amsl.0
            } else {
                0.0
            };
            ends.push(ReturnPlace {
                point: PlanPoint { at, amsl },
                level_amsl: Amsl(home.level_amsl.0 + higher_m),
                way: format!(
                    "its way to rally point {}, which it may return to,",
                    index + 1
                ),
            });
        }
        ends
    }

    fn return_problem_to(
        &self,
        t_s: f64,
        (vehicle, of): (usize, &Watched<'_>),
        (here, place): (&Here, &ReturnPlace),
    ) -> Option<String> {
        let (to, way) = (place.point.at, &place.way);
        let level_m = here.point.amsl.0.max(place.level_amsl.0);
        // A wing climbs on its way.
        let amsl = Amsl(match of.vehicle.airframe {
            Airframe::Copter => level_m,
            Airframe::Plane | Airframe::Vtol => here.point.amsl.0.min(place.level_amsl.0),
        });
        if level_m > self.spec.area.max_amsl.0 {
            return Some(format!("{way} is above the ceiling"));
        }
        let from = here.point.at;
        let steps = count(from.distance_m(to) / STEP_M);
        let leg = (0..=steps).map(|step| {
            let share = f64::from(step) / f64::from(steps);
            EastNorth {
                east_m: from.east_m + share * (to.east_m - from.east_m),
                north_m: from.north_m + share * (to.north_m - from.north_m),
            }
        });
        for at in leg.clone() {
            // Over its end it comes down.
            if at.distance_m(to) > COLUMN_M
                && let Some(why) = self.place_problem(PlanPoint { at, amsl }, t_s)
            {
                return Some(format!("{way} {why}"));
            }
        }
        let columns = [
            (from, (here.point.amsl.0, level_m)),
            (to, (place.point.amsl.0, level_m)),
        ];
        let leg = leg.map(|at| (at, (amsl.0, level_m)));
        let mut columns = columns.into_iter().chain(leg);
        if let Some(id) = columns.find_map(|column| self.zone_in(column, t_s)) {
            return Some(format!("{way} leads into {id}"));
        }
        let flat = |at: EastNorth| [at.east_m, at.north_m];
        for (disc, id) in self.threats() {
            let away_m = point_segment_distance(flat(disc.center), flat(from), flat(to));
            // The way out of a threat that it is in may begin inside.
            let is_out = is_out_of(&disc, from, to);
            if away_m < disc.radius_m && !is_out {
                return Some(format!("{way} leads into {id}"));
            }
        }
        let flown = way_of_return(of.vehicle, here.point, (level_m, place.point), t_s);
        self.meets(t_s, vehicle, &flown, Timing::About)
            .map(|why| format!("{way} {why}"))
    }

    /// What is wrong with a place on the route.
    fn place_problem(&self, point: PlanPoint, t_s: f64) -> Option<String> {
        let place = self.world.frame.from_plan(point.at);
        let Ok(ground) = self.world.terrain.height(place) else {
            return Some("has no elevation data".to_owned());
        };
        let agl_m = point.amsl.above_ground(ground).0;
        let min_m = self.spec.area.min_agl.0;
        if agl_m < min_m {
            return Some(format!(
                "is {agl_m:.0} m over the ground (at least {min_m:.0} m)"
            ));
        }
        if !self.world.in_area(point.at) {
            return Some("leaves the area".to_owned());
        }
        let column = (point.at, (point.amsl.0, point.amsl.0));
        let id = self.zone_in(column, t_s)?;
        Some(format!("leads into {id}"))
    }

    /// The zone that is closed at a place from one altitude to another, metres above the sea.
    fn zone_in(&self, (at, (from_m, to_m)): (EastNorth, (f64, f64)), t_s: f64) -> Option<&str> {
        let place = self.world.frame.from_plan(at);
        let ground = self.world.terrain.height(place).ok()?;
        let (lower_m, upper_m) = (from_m.min(to_m), from_m.max(to_m));
        let mut zones = self.spec.no_fly.iter().zip(&self.world.zones);
        // It may come up while the vehicle is there.
        let closed = zones.find(|(_, shape)| {
            let is_closed =
                |at_s: f64| shape.is_closed_between(at, (lower_m, upper_m), ground.0, at_s);
            is_closed(t_s) || is_closed(t_s + AHEAD_S)
        });
        closed.map(|(zone, _)| zone.id.as_str())
    }

    /// Where a vehicle rests in the air: how long it stays there is not known.
    fn rests(&self, t_s: f64, vehicle: usize) -> Option<Segment> {
        let of = self.vehicles.get(vehicle).filter(|of| of.duty.is_up)?;
        let here = of.here.filter(|here| here.fix.speed_mps < SLOW_MPS)?;
        Some(Segment::between(
            (t_s, axes(&here)),
            (t_s + AHEAD_S, axes(&here)),
        ))
    }

    /// The vehicle that a way meets, in words.
    fn meets(&self, t_s: f64, vehicle: usize, way: &[Segment], timing: Timing) -> Option<String> {
        let mut limit = self.spec.separation;
        let lasts_s = way.last().map_or(0.0, |last| last.t1_s - t_s);
        let (wide_m, apart_s) = match timing {
            Timing::Within(wide_m) => (wide_m, 0.0),
            Timing::About => (0.0, off_s(lasts_s)),
        };
        limit.distance_m += wide_m;
        (0..self.vehicles.len()).find_map(|other| {
            let returns = &self.vehicles[other].returns;
            if other != vehicle
                && !returns.is_empty()
                && let Some((away_m, _)) = nearest(way, returns, &limit, EVER_S)
                && away_m < limit.distance_m
            {
                let id = &self.vehicles[other].vehicle.id;
                let left_m = (away_m - wide_m).max(0.0);
                return Some(format!(
                    "comes within {left_m:.0} m of the way on which {id} returns"
                ));
            }
            let future = (other != vehicle).then(|| self.future(t_s, other))??;
            let mut segments = future.segments;
            segments.extend(self.rests(t_s, other));
            let (away_m, at_s) = nearest(way, &segments, &limit, apart_s)?;
            let id = &self.vehicles[other].vehicle.id;
            (away_m < limit.distance_m).then(|| {
                let left_m = (away_m - wide_m).max(0.0);
                format!("comes within {left_m:.0} m of {id} at T0+{at_s:.0} s")
            })
        })
    }
}

/// How far a rally point is at most to which an autopilot may return instead of home, which is `home_m` away, metres.
pub(in crate::flight) fn rally_reach_m(
    autopilot: Autopilot,
    airframe: Airframe,
    home_m: f64,
) -> f64 {
    let reach_m = home_m + RALLY_FARTHER_M;
    match autopilot == Autopilot::ArduPilot && airframe.has_wing() {
        true => reach_m.max(RALLY_REACH_M),
        false => reach_m,
    }
}

/// Whether a way that begins in a disc leads straight out of it.
fn is_out_of(disc: &Disc, from: EastNorth, to: EastNorth) -> bool {
    let (east_m, north_m) = (
        from.east_m - disc.center.east_m,
        from.north_m - disc.center.north_m,
    );
    let outwards = east_m * (to.east_m - from.east_m) + north_m * (to.north_m - from.north_m);
    let is_in = east_m.hypot(north_m) < disc.radius_m;
    is_in && outwards >= 0.0 && disc.center.distance_m(to) >= disc.radius_m
}

/// The climb of a vehicle to the altitude of the return, the leg home, and the descent.
pub(in crate::flight) fn way_of_return(
    vehicle: &Vehicle,
    here: PlanPoint,
    (level_m, home): (f64, PlanPoint),
    t_s: f64,
) -> Vec<Segment> {
    let here_m = here.axes_m();
    let home_m = home.axes_m();
    let over_m = [home_m[0], home_m[1], level_m];
    let climbed = (
        [here_m[0], here_m[1], level_m],
        (level_m - here_m[2]).abs() / vehicle.climb_mps,
    );
    let flown_s = here.at.distance_m(home.at) / vehicle.speed_mps;
    let sunk_s = (level_m - home_m[2]).abs() / vehicle.descent_mps;
    let mut way = Vec::new();
    let mut from = (t_s, here_m);
    for (to_m, took_s) in [climbed, (over_m, flown_s), (home_m, sunk_s)] {
        let to = (from.0 + took_s.max(1e-3), to_m);
        way.push(Segment::between(from, to));
        from = to;
    }
    way
}

/// By how much a return that takes so long may be off its times, seconds.
pub(in crate::flight) fn off_s(lasts_s: f64) -> f64 {
    OFF_S + OFF_SHARE * lasts_s
}

/// How near a path comes to a way of return at about the same times, metres.
pub(in crate::flight) fn min_m(
    path: &[Segment],
    way: &[Segment],
    limit: &Separation,
) -> Option<f64> {
    let lasts_s = way.last()?.t1_s - way.first()?.t0_s;
    nearest(path, way, limit, off_s(lasts_s)).map(|(away_m, _)| away_m)
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
