//! Which leg of a way a vehicle is on.

use super::proof::CROSS_TRACK_M;
use super::reference::to_segment;
use crate::geodesy::PlanPoint;

/// A vehicle this near to several legs in a row is on the first of them, metres.
const ALIKE_M: f64 = 2.0;
/// A vehicle slower than this flies nowhere in particular, m/s.
const SLOW_MPS: f64 = 1.0;

/// The number of the leg that a vehicle is on, counted from 0, and how far it is beside that,
/// metres; none of a way without legs. `velocity_mps` is to the east and the north.
///
/// A way may lead past the same place again, there and back: so it is the first stretch of legs
/// that the vehicle is near to and does not fly against, and of that the nearest leg. Who is
/// near to none gets its distance to the nearest of all.
pub(crate) fn leg_at(
    way: &[PlanPoint],
    here: PlanPoint,
    velocity_mps: (f64, f64),
) -> Option<(usize, f64)> {
    let legs: Vec<(usize, f64, bool)> = way
        .windows(2)
        .enumerate()
        .map(|(number, leg)| {
            let (cross_track_m, _) = to_segment(here, leg[0], leg[1]);
            (number, cross_track_m, is_along(leg, velocity_mps))
        })
        .collect();
    let is_near = |leg: &&(usize, f64, bool)| leg.1 <= CROSS_TRACK_M;
    let first = legs.iter().position(|leg| is_near(&leg) && leg.2);
    let stretch = first.map(|first| legs[first..].iter().take_while(is_near));
    let Some(stretch) = stretch else {
        let nearest = legs.iter().min_by(|a, b| a.1.total_cmp(&b.1));
        return nearest.map(|leg| (leg.0, leg.1));
    };
    let stretch: Vec<_> = stretch.filter(|leg| leg.2).collect();
    let min_m = stretch
        .iter()
        .map(|leg| leg.1)
        .fold(f64::INFINITY, f64::min);
    let on = stretch.into_iter().find(|leg| leg.1 <= min_m + ALIKE_M);
    on.map(|leg| (leg.0, leg.1))
}

/// Whether a vehicle does not fly against a leg.
fn is_along(leg: &[PlanPoint], (east_mps, north_mps): (f64, f64)) -> bool {
    let (from, to) = (leg[0].at, leg[1].at);
    let along = (to.east_m - from.east_m) * east_mps + (to.north_m - from.north_m) * north_mps;
    along >= 0.0 || east_mps.hypot(north_mps) < SLOW_MPS
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geodesy::Amsl;

    fn at(east_m: f64, north_m: f64) -> PlanPoint {
        PlanPoint::new(east_m, north_m, Amsl(0.0))
    }

    /// There and back, three metres beside.
    fn way() -> Vec<PlanPoint> {
        vec![
            at(0.0, 0.0),
            at(200.0, 0.0),
            at(600.0, 0.0),
            at(1000.0, 0.0),
            at(600.0, 3.0),
            at(0.0, 3.0),
        ]
    }

    #[test]
    fn on_a_way_there_and_back_the_direction_and_then_the_order_tell_the_leg() {
        let leg = |here, velocity| leg_at(&way(), here, velocity).map(|leg| leg.0);
        // Nearer to the way back, but on the way there.
        assert_eq!(leg(at(100.0, 2.5), (12.0, 0.0)), Some(0));
        assert_eq!(leg(at(300.0, 3.0), (12.0, -0.5)), Some(1));
        assert_eq!(leg(at(300.0, 0.0), (-12.0, 0.5)), Some(4));
        // Where the way turns back.
        assert_eq!(leg(at(995.0, 1.0), (12.0, 0.0)), Some(2));
        assert_eq!(leg(at(990.0, 1.0), (-3.0, 0.1)), Some(3));
        // Just past a waypoint it is on the next leg, at it on either.
        assert_eq!(leg(at(205.0, 0.0), (12.0, 0.0)), Some(1));
        assert_eq!(leg(at(199.0, 0.0), (12.0, 0.0)), Some(0));
        // Standing, the first.
        assert_eq!(leg(at(400.0, 1.0), (0.0, 0.0)), Some(1));
    }

    #[test]
    fn a_point_far_from_every_leg_gets_its_distance_to_the_nearest() {
        let (leg, cross_track_m) = leg_at(&way(), at(1100.0, 0.0), (12.0, 0.0)).expect("a way");
        assert_eq!(leg, 2);
        assert!((cross_track_m - 100.0).abs() < 1e-9);
        assert_eq!(leg_at(&way()[..1], at(0.0, 0.0), (0.0, 0.0)), None);
    }
}
