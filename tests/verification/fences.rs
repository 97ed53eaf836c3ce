//! Fences that do not fit the autopilot: what they cover and leave out, measured by dense points.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "small positive counts"
)]

use sortie::geodesy::LatLon;
use sortie::mission::{Item, VehicleMission, command};
use sortie::verify::{Limit, Review};
use sortie::{Mission, plan, verify};

/// Metres of a degree at 47.2 degrees north (WGS84).
const NORTH_M: f64 = 111_178.0;
const EAST_M: f64 = 75_761.0;
/// 60 s at 9 m/s.
const REACH_M: f64 = 540.0;

type Flat = (f64, f64);

fn flat(at: LatLon) -> Flat {
    ((at.lon_deg - 8.5) * EAST_M, (at.lat_deg - 47.2) * NORTH_M)
}

fn away(a: Flat, b: Flat) -> f64 {
    (a.0 - b.0).hypot(a.1 - b.1)
}

fn to_edge(at: Flat, a: Flat, b: Flat) -> f64 {
    let (along, from) = ((b.0 - a.0, b.1 - a.1), (at.0 - a.0, at.1 - a.1));
    let share = (from.0 * along.0 + from.1 * along.1) / (along.0 * along.0 + along.1 * along.1);
    let share = share.clamp(0.0, 1.0);
    away(at, (a.0 + share * along.0, a.1 + share * along.1))
}

fn is_in(ring: &[Flat], at: Flat) -> bool {
    let ends = ring.iter().zip(ring.iter().cycle().skip(1));
    ends.filter(|(a, b)| {
        (a.1 > at.1) != (b.1 > at.1) && at.0 < a.0 + (b.0 - a.0) * (at.1 - a.1) / (b.1 - a.1)
    })
    .count()
        % 2
        == 1
}

/// Points along straight lines, no further apart than a step.
fn dense(line: &[Flat], step_m: f64) -> Vec<Flat> {
    let mut points = Vec::new();
    for pair in line.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let count = (away(a, b) / step_m).ceil().max(1.0) as u32;
        points.extend((0..=count).map(|k| {
            let share = f64::from(k) / f64::from(count);
            (a.0 + (b.0 - a.0) * share, a.1 + (b.1 - a.1) * share)
        }));
    }
    points
}

/// Numbers between 0 and 1 (Marsaglia's xorshift).
struct Draw(u64);

impl Draw {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Zones of five to nine corners around the way of two copters, which stay clear of their ends.
fn zones(seed: u64, count: usize) -> Vec<Vec<LatLon>> {
    let mut draw = Draw(seed);
    let mut zones = Vec::new();
    let ends = [
        (-1500.0, -1000.0),
        (1500.0, 1000.0),
        (-1500.0, 1000.0),
        (1500.0, -1000.0),
    ];
    while zones.len() < count {
        let middle = (5200.0 * draw.next() - 2600.0, 4200.0 * draw.next() - 2100.0);
        let radius_m = 30.0 + 60.0 * draw.next();
        if ends.iter().any(|end| away(*end, middle) < radius_m + 60.0) {
            continue;
        }
        let corners = 5 + (draw.next() * 5.0) as u32;
        zones.push(
            (0..corners)
                .map(|corner| {
                    let turn = std::f64::consts::TAU * f64::from(corner) / f64::from(corners);
                    let reach_m = radius_m * (0.6 + 0.4 * draw.next());
                    LatLon {
                        lat_deg: 47.2 + (middle.1 + reach_m * turn.sin()) / NORTH_M,
                        lon_deg: 8.5 + (middle.0 + reach_m * turn.cos()) / EAST_M,
                    }
                })
                .collect(),
        );
    }
    zones
}

fn mission(zones: &[Vec<LatLon>], more: &str) -> Mission {
    let zones: Vec<String> = (zones.iter().enumerate())
        .map(|(index, zone)| {
            let corners = zone
                .iter()
                .map(|at| format!("[{}, {}]", at.lat_deg, at.lon_deg));
            let corners: Vec<String> = corners.collect();
            format!("  - {{id: z{index}, polygon: [{}]}}\n", corners.join(", "))
        })
        .collect();
    let vehicle = |id: &str, sysid: u32, from: Flat, to: Flat| {
        let end = |at: Flat| {
            format!(
                "{{lat: {}, lon: {}, agl_m: 60}}",
                47.2 + at.1 / NORTH_M,
                8.5 + at.0 / EAST_M
            )
        };
        format!(
            "  - {{id: {id}, sysid: {sysid}, autopilot: ardupilot, link: sim, speed_mps: 9, finish: land, start: {}, goal: {}{more}}}\n",
            end(from),
            end(to)
        )
    };
    let text = format!(
        "sortie: 2\nname: many\narea: {{south_west: {{lat: 47.17, lon: 8.45}}, north_east: {{lat: 47.23, lon: 8.55}}, \
         min_agl_m: 40, max_amsl_m: 600}}\nterrain: {{flat: {{amsl_m: 200}}}}\nno_fly:\n{}vehicles:\n{}{}\
         separation: {{distance_m: 50, time_slack_s: 5}}\nplanner: {{evaluations: 8000}}\n",
        zones.concat(),
        vehicle("alpha", 1, (-1500.0, -1000.0), (1500.0, 1000.0)),
        vehicle("bravo", 2, (-1500.0, 1000.0), (1500.0, -1000.0)),
    );
    Mission::parse(".", text).unwrap_or_else(|error| panic!("{error}"))
}

/// An exclusion of a fence: corners, or the middle and radius of a circle.
enum Exclusion {
    Polygon(Vec<Flat>),
    Circle(Flat, f64),
}

impl Exclusion {
    /// Signed distance, positive outside.
    fn away_m(&self, at: Flat) -> f64 {
        match self {
            Self::Circle(middle, radius_m) => away(*middle, at) - radius_m,
            Self::Polygon(ring) => {
                let edges = ring.iter().zip(ring.iter().cycle().skip(1));
                let edge_m = edges.map(|(a, b)| to_edge(at, *a, *b));
                let edge_m = edge_m.fold(f64::INFINITY, f64::min);
                if is_in(ring, at) { -edge_m } else { edge_m }
            }
        }
    }
}

fn exclusions(fence: &[Item]) -> Vec<Exclusion> {
    let mut found = Vec::new();
    let mut rest = fence;
    while let Some(first) = rest.first() {
        let count = match first.command {
            command::NAV_FENCE_CIRCLE_EXCLUSION => 1,
            _ => first.params[0] as usize,
        };
        let places: Vec<Flat> = rest[..count]
            .iter()
            .map(|item| flat(item.place().expect("a place")))
            .collect();
        match first.command {
            command::NAV_FENCE_CIRCLE_EXCLUSION => {
                found.push(Exclusion::Circle(places[0], f64::from(first.params[0])));
            }
            command::NAV_FENCE_POLYGON_VERTEX_EXCLUSION => found.push(Exclusion::Polygon(places)),
            _ => {}
        }
        rest = &rest[count..];
    }
    found
}

fn left_out(review: &Review, vehicle: &str, zone: usize) -> Option<f64> {
    let limit = Limit::FenceLeftOut(format!("zone z{zone}"));
    let mut margins = review.margins.iter();
    let found = margins.find(|margin| margin.vehicle == vehicle && margin.limit == limit)?;
    Some(found.value)
}

#[test]
fn every_zone_is_inside_of_a_fence_that_fits_or_far_from_what_is_flown() {
    for seed in [7, 11] {
        let zones = zones(seed, 220);
        let mission = mission(&zones, "");
        let planned = plan(&mission);
        let failed: Vec<_> = planned.review.margins.iter().filter(|m| !m.ok).collect();
        assert!(planned.review.passes(), "{failed:?}");
        for (index, built) in &planned.missions {
            let id = &mission.spec().vehicles[*index].id;
            assert!(built.fence.len() <= 70, "{}", built.fence.len());
            let exclusions = exclusions(&built.fence);
            let track = planned
                .review
                .tracks
                .iter()
                .find(|track| track.vehicle == *id);
            let track: Vec<Flat> = track
                .unwrap()
                .moments
                .iter()
                .map(|m| flat(m.place))
                .collect();
            // The path, and the ways back from points along it.
            let mut flown = dense(&track, 10.0);
            for from in dense(&track, 40.0) {
                flown.extend(dense(&[from, track[0]], 40.0));
            }
            let mut left = 0;
            for (number, zone) in zones.iter().enumerate() {
                let ring: Vec<Flat> = zone.iter().chain(&zone[..1]).map(|at| flat(*at)).collect();
                let edge = dense(&ring, 10.0);
                let covers =
                    |exclusion: &Exclusion| edge.iter().all(|at| exclusion.away_m(*at) <= 0.1);
                match left_out(&planned.review, id, number) {
                    None => assert!(
                        exclusions.iter().any(covers),
                        "seed {seed}, {id}: zone {number}"
                    ),
                    Some(said_m) => {
                        left += 1;
                        let of = |at: &Flat| {
                            edge.iter()
                                .map(|on| away(*on, *at))
                                .fold(f64::INFINITY, f64::min)
                        };
                        let really_m = flown.iter().map(of).fold(f64::INFINITY, f64::min);
                        assert!(
                            said_m >= REACH_M && said_m <= really_m + 8.0,
                            "{said_m} {really_m}"
                        );
                        assert!(said_m >= really_m - 60.0, "{said_m} {really_m}");
                    }
                }
            }
            assert!(left > 20 && left < zones.len(), "{left} left out");
            for at in dense(&track, 5.0) {
                let nearest = exclusions.iter().map(|exclusion| exclusion.away_m(at));
                let nearest_m = nearest.fold(f64::INFINITY, f64::min);
                assert!(
                    nearest_m >= 9.8,
                    "seed {seed}, {id}: {nearest_m} m at {at:?}"
                );
            }
        }
    }
}

/// Fails for a limit, and names what.
fn fails(mission: &Mission, built: &(usize, VehicleMission), limit: fn(&Limit) -> bool) -> bool {
    let review = verify(mission, std::slice::from_ref(built));
    let own = review
        .margins
        .iter()
        .filter(|margin| margin.vehicle == "alpha");
    own.filter(|margin| !margin.ok)
        .any(|margin| limit(&margin.limit))
}

#[test]
fn a_fence_that_misses_a_near_zone_or_comes_near_the_path_fails() {
    let zones = zones(7, 220);
    let mission = mission(&zones, "");
    let planned = plan(&mission);
    let good = planned
        .missions
        .into_iter()
        .find(|(index, _)| *index == 0)
        .unwrap();
    assert!(!fails(&mission, &good, |limit| *limit != Limit::Mission));
    let doctored = |change: &dyn Fn(&mut Vec<Item>)| {
        let mut doctored = good.clone();
        change(&mut doctored.1.fence);
        doctored
    };
    let smaller = doctored(&|fence| {
        for item in fence
            .iter_mut()
            .filter(|item| item.command == command::NAV_FENCE_CIRCLE_EXCLUSION)
        {
            item.params[0] *= 0.8;
        }
    });
    assert!(fails(&mission, &smaller, |limit| matches!(
        limit,
        Limit::FenceLeftOut(_)
    )));
    let wider = doctored(&|fence| {
        for item in fence
            .iter_mut()
            .filter(|item| item.command == command::NAV_FENCE_CIRCLE_EXCLUSION)
        {
            item.params[0] += 500.0;
        }
    });
    assert!(fails(&mission, &wider, |limit| *limit == Limit::FenceWider));
    let without_area = doctored(&|fence| drop(fence.drain(..4)));
    assert!(fails(&mission, &without_area, |limit| *limit
        == Limit::FenceComplete));
    let none = doctored(&|fence| fence.truncate(4));
    assert!(fails(&mission, &none, |limit| matches!(
        limit,
        Limit::FenceLeftOut(_)
    )));
}

#[test]
fn a_fence_that_fits_what_a_vehicle_keeps_holds_every_zone_as_it_is() {
    let zones = zones(3, 30);
    let needs = 4 + zones.iter().map(Vec::len).sum::<usize>();
    let mission = mission(&zones, ", fence_points: 400");
    let planned = plan(&mission);
    assert!(planned.review.passes() && needs > 70);
    let (_, built) = &planned.missions[0];
    assert_eq!(built.fence.len(), needs);
    // What would fit may not be left out.
    let mut less = (0, built.clone());
    less.1.fence.truncate(needs - zones[29].len());
    assert!(fails(&mission, &less, |limit| *limit == Limit::FenceComplete));
}

/// Over 90 km a line that is straight on the earth is 150 m north of one that is straight in
/// latitude and longitude. Masts at the middle of the way, beyond the reach of 540 m by 40 to 240 m.
#[test]
fn what_a_fence_leaves_out_along_a_way_of_90_km_is_far_by_the_verdict_too() {
    let masts: Vec<String> = (0..200)
        .map(|index| {
            let (side, away_m) = (
                if index % 2 == 0 { 1.0 } else { -1.0 },
                f64::from(index / 2),
            );
            let at = (f64::from(index % 5) * 400.0, side * (600.0 + 2.0 * away_m));
            let (lat, lon) = (47.2 + at.1 / NORTH_M, 8.5 + at.0 / EAST_M);
            format!("  - {{id: m{index}, lat: {lat}, lon: {lon}, radius_m: 20}}\n")
        })
        .collect();
    let text = format!(
        "sortie: 2\nname: far\narea: {{south_west: {{lat: 46.9, lon: 7.8}}, north_east: {{lat: 47.5, lon: 9.2}}, \
         min_agl_m: 40, max_amsl_m: 600}}\nterrain: {{flat: {{amsl_m: 200}}}}\nthreats:\n{}vehicles:\n  \
         - {{id: alpha, sysid: 1, autopilot: ardupilot, link: sim, speed_mps: 9, finish: land, \
         start: {{lat: 47.2, lon: 7.9, agl_m: 60}}, goal: {{lat: 47.2, lon: 9.1, agl_m: 60}}}}\n\
         planner: {{evaluations: 2000}}\n",
        masts.concat(),
    );
    let mission = Mission::parse(".", text).unwrap_or_else(|error| panic!("{error}"));
    let review = plan(&mission).review;
    let failed: Vec<String> = (review.margins.iter().filter(|margin| !margin.ok))
        .map(|margin| format!("{}: {}", margin.limit, margin.value))
        .collect();
    assert!(review.passes(), "{failed:?}");
}
