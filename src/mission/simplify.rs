//! From a finely sampled path to as few waypoints as keep it.
//!
//! A copter rounds a waypoint on an arc of its turn radius `R` that touches both
//! legs. With a turn of `phi` the arc uses `R tan(phi/2)` of each leg and passes
//! the waypoint at `R (1/cos(phi/2) - 1)`. So waypoints must be far enough apart
//! for the arcs at both ends of a leg, and what an arc cuts off counts as leaving
//! the path, on top of what the legs themselves leave it.

use nalgebra::Vector3;

/// A point of the path: east, north, height, metres.
pub(super) type Point = Vector3<f64>;

/// What the waypoints have to keep.
#[derive(Clone, Copy, Debug)]
pub(super) struct Keep {
    /// Furthest from the path, metres, positive.
    pub tolerance_m: f64,
    /// Turn radius, metres.
    pub radius_m: f64,
}

/// Share of the tolerance spent on thinning the samples to candidates.
const THINNING: f64 = 0.05;
/// What a metre of misfit costs, in waypoints: a tenth of a millimetre weighs as much as one.
const MISFIT_COST: f64 = 1e4;
/// Candidates that one leg may pass: bounds the work on a path that is rough within
/// the tolerance, where nearly every pair of candidates makes a leg.
const REACH: usize = 128;
/// Beyond this a leg need not be: stands for the infinite arc of a full reversal, metres.
const FARTHEST_M: f64 = 1e7;

/// Indices of the samples that become waypoints, first and last included.
///
/// The fewest, among the samples that remain after thinning and with at most [`REACH`]
/// of them to a leg, whose legs and arcs keep the tolerance; where none do, those that miss it least, for the verdict to
/// refuse. The ends are flown from and to rest.
pub(super) fn waypoints(path: &[Point], keep: Keep) -> Vec<usize> {
    let slack_m = THINNING * keep.tolerance_m;
    let candidates = thin(path, slack_m);
    let points: Vec<Point> = candidates.iter().map(|&index| path[index]).collect();
    let legs = Legs::new(&points, slack_m, keep.tolerance_m);
    legs.fewest(keep)
        .into_iter()
        .map(|index| candidates[index])
        .collect()
}

/// Douglas-Peucker: indices of a subset that no sample leaves by more than `tolerance_m`.
fn thin(path: &[Point], tolerance_m: f64) -> Vec<usize> {
    let Some(last) = path.len().checked_sub(1) else {
        return Vec::new();
    };
    let mut kept = vec![0, last];
    let mut open = vec![(0, last)];
    while let Some((from, to)) = open.pop() {
        let farthest = (from + 1..to)
            .map(|index| (index, distance_m(path[index], path[from], path[to])))
            .max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((index, deviation_m)) = farthest
            && deviation_m > tolerance_m
        {
            kept.push(index);
            open.extend([(from, index), (index, to)]);
        }
    }
    kept.sort_unstable();
    kept.dedup();
    kept
}

/// Distance of a point from a segment, metres.
fn distance_m(point: Point, from: Point, to: Point) -> f64 {
    let along = to - from;
    let length_sq = along.norm_squared();
    let at = if length_sq > 0.0 {
        ((point - from).dot(&along) / length_sq).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (point - from - along * at).norm()
}

/// A leg that keeps the tolerance.
struct Leg {
    to: usize,
    /// Furthest that the path leaves it, metres.
    deviation_m: f64,
    /// In the plane, metres.
    length_m: f64,
    /// In the plane, radians from east.
    heading_rad: f64,
}

/// A way to the end of a leg, such that no other is both cheaper and leaves more of the leg.
#[derive(Clone, Copy)]
struct Way {
    cost: f64,
    /// How much of the leg the arc at its beginning uses, metres.
    used_m: f64,
    /// Where it came from: start, leg and way of the leg before; none at the path's start.
    before: Option<(usize, usize, usize)>,
}

/// All legs between candidates, by where they begin.
struct Legs {
    from: Vec<Vec<Leg>>,
}

impl Legs {
    fn new(points: &[Point], slack_m: f64, tolerance_m: f64) -> Self {
        let from = (0..points.len())
            .map(|from| {
                (from + 1..points.len().min(from + 1 + REACH))
                    .filter_map(|to| leg(points, from, to, slack_m, tolerance_m))
                    .collect()
            })
            .collect();
        Self { from }
    }

    /// Dynamic program over legs: the cost of a way is its number of waypoints plus its misfits.
    fn fewest(&self, keep: Keep) -> Vec<usize> {
        let last = self.from.len().saturating_sub(1);
        let mut ways: Vec<Vec<Vec<Way>>> = self
            .from
            .iter()
            .map(|legs| vec![Vec::new(); legs.len()])
            .collect();
        for way in ways.first_mut().into_iter().flatten() {
            way.push(Way {
                cost: 1.0,
                used_m: 0.0,
                before: None,
            });
        }
        let mut best: Option<(f64, (usize, usize, usize))> = None;
        for from in 0..last {
            for (index, leg) in self.from[from].iter().enumerate() {
                let here = std::mem::take(&mut ways[from][index]);
                for (number, way) in here.iter().enumerate() {
                    let name = (from, index, number);
                    if leg.to == last {
                        let cost = way.cost + MISFIT_COST * (way.used_m - leg.length_m).max(0.0);
                        if best.is_none_or(|(least, _)| cost < least) {
                            best = Some((cost, name));
                        }
                        continue;
                    }
                    for (next, onward) in self.from[leg.to].iter().enumerate() {
                        let corner = Corner::between(leg, onward, keep.radius_m);
                        let misfit_m = (way.used_m + corner.used_m - leg.length_m).max(0.0)
                            + (corner.cut_m + leg.deviation_m.max(onward.deviation_m)
                                - keep.tolerance_m)
                                .max(0.0);
                        offer(
                            &mut ways[leg.to][next],
                            Way {
                                cost: way.cost + 1.0 + MISFIT_COST * misfit_m,
                                used_m: corner.used_m,
                                before: Some(name),
                            },
                        );
                    }
                }
                ways[from][index] = here;
            }
        }
        let mut vertices = vec![last];
        let mut at = best.map(|(_, name)| name);
        while let Some((from, index, number)) = at {
            vertices.push(from);
            at = ways[from][index][number].before;
        }
        vertices.reverse();
        vertices
    }
}

/// The leg between two candidates, if it keeps the tolerance; neighbours always do.
fn leg(points: &[Point], from: usize, to: usize, slack_m: f64, tolerance_m: f64) -> Option<Leg> {
    let mut deviation_m = 0.0_f64;
    for between in from + 1..to {
        deviation_m = deviation_m.max(distance_m(points[between], points[from], points[to]));
        if deviation_m + slack_m > tolerance_m {
            return None;
        }
    }
    let along = points[to] - points[from];
    Some(Leg {
        to,
        deviation_m: deviation_m + slack_m,
        length_m: along.x.hypot(along.y),
        heading_rad: along.y.atan2(along.x),
    })
}

/// The arc at a waypoint.
struct Corner {
    /// How much of each leg it uses, metres.
    used_m: f64,
    /// How far it passes from the waypoint, metres.
    cut_m: f64,
}

impl Corner {
    fn between(leg: &Leg, onward: &Leg, radius_m: f64) -> Self {
        // A vertical leg has no heading: the vehicle stops in the plane, there is no arc.
        if leg.length_m <= 0.0 || onward.length_m <= 0.0 {
            return Self {
                used_m: 0.0,
                cut_m: 0.0,
            };
        }
        let turn_rad = (onward.heading_rad - leg.heading_rad)
            .sin()
            .atan2((onward.heading_rad - leg.heading_rad).cos());
        let half_rad = turn_rad.abs() / 2.0;
        Self {
            used_m: (radius_m * half_rad.tan()).clamp(0.0, FARTHEST_M),
            cut_m: (radius_m * (1.0 / half_rad.cos() - 1.0)).clamp(0.0, FARTHEST_M),
        }
    }
}

/// Keeps a way unless another is at least as good in both respects.
fn offer(ways: &mut Vec<Way>, new: Way) {
    let covers = |a: &Way, b: &Way| a.cost <= b.cost && a.used_m <= b.used_m;
    if ways.iter().any(|way| covers(way, &new)) {
        return;
    }
    ways.retain(|way| !covers(&new, way));
    ways.push(new);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const KEEP: Keep = Keep {
        tolerance_m: 5.0,
        radius_m: 90.0,
    };

    fn chosen(path: &[Point]) -> Vec<Point> {
        waypoints(path, KEEP)
            .into_iter()
            .map(|index| path[index])
            .collect()
    }

    /// Metres of leg that remain between the arcs, the least over all legs.
    fn least_room_m(points: &[Point]) -> f64 {
        let heading = |a: Point, b: Point| (b.y - a.y).atan2(b.x - a.x);
        let used = |index: usize| {
            if index == 0 || index + 1 == points.len() {
                return 0.0;
            }
            let turn = heading(points[index], points[index + 1])
                - heading(points[index - 1], points[index]);
            KEEP.radius_m * (turn.sin().atan2(turn.cos()).abs() / 2.0).tan()
        };
        (1..points.len())
            .map(|index| {
                let leg = points[index] - points[index - 1];
                leg.x.hypot(leg.y) - used(index - 1) - used(index)
            })
            .fold(f64::INFINITY, f64::min)
    }

    fn arc(radius_m: f64, turn_rad: f64, samples: u32) -> Vec<Point> {
        (0..=samples)
            .map(|index| {
                let at = turn_rad * f64::from(index) / f64::from(samples);
                Point::new(radius_m * at.sin(), radius_m * (1.0 - at.cos()), 500.0)
            })
            .collect()
    }

    #[test]
    fn a_straight_path_is_two_waypoints() {
        let path: Vec<Point> = (0..=100)
            .map(|i| Point::new(f64::from(i) * 10.0, f64::from(i) * 3.0, 500.0))
            .collect();
        assert_eq!(waypoints(&path, KEEP), [0, 100]);
    }

    #[test]
    fn a_bend_in_height_alone_gets_a_waypoint_at_the_bend() {
        let path: Vec<Point> = (0..=100)
            .map(|i| Point::new(f64::from(i) * 10.0, 0.0, 500.0 + f64::from((i - 50).max(0))))
            .collect();
        let kept = waypoints(&path, KEEP);
        assert_eq!(kept.len(), 3);
        assert!(kept[1].abs_diff(50) <= 10, "bend at {}", kept[1]);
    }

    #[test]
    fn an_arc_needs_about_as_many_legs_as_chord_and_cut_allow() {
        // Deviation plus cut is (r + R)(1 - cos(phi/2)) to second order: 5 m at phi = 18.3 degrees.
        let kept = chosen(&arc(300.0, std::f64::consts::PI, 2000));
        assert!((11..=13).contains(&kept.len()), "{} waypoints", kept.len());
        assert!(least_room_m(&kept) >= -1e-9);
    }

    #[test]
    fn an_arc_hardly_wider_than_the_turn_radius_is_refined_until_it_fits() {
        let kept = chosen(&arc(92.0, std::f64::consts::PI, 2000));
        assert!(least_room_m(&kept) >= -1e-6, "room {}", least_room_m(&kept));
    }

    #[test]
    fn a_turn_that_cannot_be_flown_still_yields_a_mission_through_both_ends() {
        let path = [
            Point::new(0.0, 0.0, 500.0),
            Point::new(30.0, 0.0, 500.0),
            Point::new(0.0, 1.0, 500.0),
        ];
        assert_eq!(waypoints(&path, KEEP), [0, 1, 2]);
    }

    #[test]
    fn no_shorter_choice_of_samples_keeps_the_same_limits() {
        // Every subset of a small path, one by one.
        let path: Vec<Point> = (0..12)
            .map(|i| {
                let at = f64::from(i) * 60.0;
                Point::new(
                    at,
                    25.0 * (at / 180.0).sin(),
                    500.0 + 8.0 * (at / 100.0).cos(),
                )
            })
            .collect();
        let fits = |subset: &[usize]| {
            let deviation = |a: usize, b: usize| {
                (a + 1..b)
                    .map(|i| distance_m(path[i], path[a], path[b]))
                    .fold(0.0, f64::max)
            };
            let points: Vec<Point> = subset.iter().map(|&i| path[i]).collect();
            let corners = subset.windows(3).all(|three| {
                let legs = Legs::new(&[path[three[0]], path[three[1]], path[three[2]]], 0.0, 1e9);
                let corner = Corner::between(&legs.from[0][0], &legs.from[1][0], KEEP.radius_m);
                let worst = deviation(three[0], three[1]).max(deviation(three[1], three[2]));
                corner.cut_m + worst <= KEEP.tolerance_m
            });
            corners
                && subset
                    .windows(2)
                    .all(|two| deviation(two[0], two[1]) <= KEEP.tolerance_m)
                && least_room_m(&points) >= 0.0
        };
        let fewest = (0_u32..1 << 10)
            .map(|bits| {
                let mut subset = vec![0];
                subset.extend((1..11).filter(|i| bits >> (i - 1) & 1 == 1));
                subset.push(11);
                subset
            })
            .filter(|subset| fits(subset))
            .map(|subset| subset.len())
            .min();
        // The thinning takes a twentieth of the tolerance; this path has no choice that close to it.
        assert_eq!(Some(waypoints(&path, KEEP).len()), fewest);
    }

    proptest! {
        #[test]
        fn no_sample_is_further_from_the_legs_than_the_tolerance(
            steps in prop::collection::vec((10.0..200.0_f64, -0.5..0.5_f64, -20.0..20.0_f64), 1..60)
        ) {
            let mut path = vec![Point::new(0.0, 0.0, 500.0)];
            let mut heading = 0.0_f64;
            for (length, turn, climb) in steps {
                heading += turn;
                let last = path[path.len() - 1];
                path.push(last + Point::new(length * heading.cos(), length * heading.sin(), climb));
            }
            let kept = waypoints(&path, KEEP);
            prop_assert_eq!((kept[0], kept[kept.len() - 1]), (0, path.len() - 1));
            for leg in kept.windows(2) {
                for index in leg[0]..=leg[1] {
                    prop_assert!(distance_m(path[index], path[leg[0]], path[leg[1]]) <= KEEP.tolerance_m);
                }
            }
        }
    }
}
