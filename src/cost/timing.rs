//! When a route is flown, and what follows it.

use super::RouteEnds;
use super::hazards::Piece;
use crate::numeric::SpeedProfile;
use crate::numeric::approach::Segment;
use crate::path::{ramp_stops_m, way_speed_mps};
use crate::spec::{Finish, MissionSpec};
use crate::world::World;

/// When the route is flown, and what follows it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Timing {
    pub(super) start_s: f64,
    pub(super) initial_mps: f64,
    pub(super) speed_mps: f64,
    pub(super) accel_mps2: f64,
    pub(super) after: After,
    /// Separation, the length for which the time after the route counts, km.
    pub(super) after_km: f64,
}

/// What follows the route.
#[derive(Clone, Copy, Debug)]
pub(super) enum After {
    Nothing,
    Loiter,
    Land { ground_m: f64, descent_mps: f64 },
}

impl Timing {
    pub(super) fn new(world: &World, spec: &MissionSpec, vehicle: usize, ends: &RouteEnds) -> Self {
        let (sites, vehicle) = (&world.sites[vehicle], &spec.vehicles[vehicle]);
        let land = |ground_m: f64| After::Land {
            ground_m,
            descent_mps: vehicle.descent_mps,
        };
        let is_homeward = ends.to.at.distance_m(sites.home.at) < 1.0;
        let is_to_stop = !sites.stops.is_empty() && ends.to != sites.goal;
        let after = match vehicle.finish {
            Finish::Land | Finish::Loiter if is_to_stop => After::Nothing,
            Finish::Loiter => After::Loiter,
            Finish::Land => land(sites.goal_ground.0),
            Finish::Return if is_homeward => land(sites.home.amsl.0),
            Finish::Return => After::Nothing,
        };
        Self {
            start_s: ends.start_s,
            initial_mps: sites.departure.speed_at_mps(ends.from),
            speed_mps: way_speed_mps(vehicle, ends.from, ends.to),
            accel_mps2: vehicle.accel_mps2,
            after,
            after_km: spec.buffered_separation().distance_m / 1000.0,
        }
    }

    /// Speed profile of a route of this length.
    pub(super) fn profile(&self, length_m: f64) -> SpeedProfile {
        SpeedProfile::from_speed(length_m, self.initial_mps, self.speed_mps, self.accel_mps2)
    }

    /// Calls `visit` with the motions of one piece of the route and their shares
    /// of it: one while cruising, several while the speed changes.
    pub(super) fn segments(
        &self,
        piece: &Piece,
        (from_m, to_m): (f64, f64),
        profile: &SpeedProfile,
        mut visit: impl FnMut(Segment, f64),
    ) {
        let length_m = to_m - from_m;
        let moment = |distance_m: f64, share: f64| {
            let mix = |a: f64, b: f64| a + share * (b - a);
            let position = [
                mix(piece.a[0], piece.b[0]),
                mix(piece.a[1], piece.b[1]),
                mix(piece.amsl_a_m, piece.amsl_b_m),
            ];
            (self.start_s + profile.time_at_s(distance_m), position)
        };
        let mut before = (0.0, moment(from_m, 0.0));
        for distance_m in ramp_stops_m(profile, from_m, to_m) {
            let share = (distance_m - from_m) / length_m;
            let next = moment(distance_m, share);
            visit(Segment::between(before.1, next), share - before.0);
            before = (share, next);
        }
        visit(
            Segment::between(before.1, moment(to_m, 1.0)),
            1.0 - before.0,
        );
    }

    /// The motion after a route that ends at `position` after `length_m`.
    pub(super) fn segment_after(&self, position: [f64; 3], length_m: f64) -> Option<Segment> {
        let end_s = self.start_s + self.profile(length_m).duration_s();
        match self.after {
            After::Nothing => None,
            After::Loiter => Some(Segment::between(
                (end_s, position),
                (f64::INFINITY, position),
            )),
            After::Land {
                ground_m,
                descent_mps,
            } => {
                let ground = [position[0], position[1], ground_m];
                let landed_s = end_s + ((position[2] - ground_m) / descent_mps).max(0.0);
                Some(Segment::between((end_s, position), (landed_s, ground)))
            }
        }
    }
}
