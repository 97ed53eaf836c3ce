//! Domes: half spheres around the ground at their centre, also over lower ground.

use sortie::Mission;
use sortie::geodesy::{Amsl, LatLon, PlanPoint};

const SPEC: &str = "
sortie: 2
name: dome
area: {south_west: {lat: 46.98, lon: 7.97}, north_east: {lat: 47.02, lon: 8.03}, min_agl_m: 30, max_amsl_m: 2000}
terrain: {analytic: {base_amsl_m: 100, hills: [{lat: 47, lon: 8, height_m: 300, radius_m: 150}]}}
threats: [{id: radar, kind: radar, lat: 47, lon: 8, radius_m: 500, shape: dome}]
planner: {evaluations: 1000}
vehicles:
  - {id: alpha, sysid: 1, autopilot: ardupilot, link: sim, speed_mps: 9, finish: land,
     start: {lat: 46.99, lon: 7.975, agl_m: 80}, goal: {lat: 46.99, lon: 8.025, agl_m: 80}}
";

#[test]
fn a_dome_on_a_hill_reaches_as_high_over_the_valley_as_over_the_hill() {
    let mission = Mission::parse(".", SPEC).expect("a good spec");
    let world = mission.world();
    let top = LatLon {
        lat_deg: 47.0,
        lon_deg: 8.0,
    };
    let center = world.frame.to_plan(top);
    let summit_m = world.terrain.height(top).expect("ground").0;
    assert!(summit_m > 395.0, "{summit_m}");
    for step in 0..90 {
        let (sin, cos) = f64::from(step).to_radians().sin_cos();
        for (share, is_inside) in [(0.999, true), (1.13, false)] {
            let mut at = center;
            at.east_m += share * 500.0 * cos;
            let amsl = Amsl(summit_m + share * 500.0 * sin);
            let ground = world.terrain.height(world.frame.from_plan(at));
            let ground_m = ground.expect("ground").0;
            let limits = world.without_buffers(mission.spec());
            let point = PlanPoint { at, amsl };
            let mut zones = limits.zones.iter();
            let is_closed = zones.any(|zone| zone.is_closed_at(point, ground_m, f64::NAN));
            assert_eq!(is_closed, is_inside, "{step} degrees, {share}, {point:?}");
        }
    }
}

#[test]
fn a_dome_that_a_fence_cannot_hold_is_told_once() {
    let mission = Mission::parse(".", SPEC).expect("a good spec");
    let planned = sortie::plan(&mission);
    let (_, alpha) = planned.missions.first().expect("planned");
    let told: Vec<&String> = alpha
        .notes
        .iter()
        .filter(|note| note.contains("not in the fence"))
        .collect();
    let sentence =
        "threat radar is a dome; a fence has no height and no time, so it is not in the fence";
    assert_eq!(told, [sentence]);
}

#[test]
fn a_dome_keeps_the_buffer_of_threats_and_not_that_of_zones() {
    for (threats_m, zones_m) in [(12.0, 40.0), (40.0, 12.0)] {
        let line = format!("buffer_m: {{threats: {threats_m}, zones: {zones_m}}}\nplanner:");
        let text = SPEC
            .replace("46.99, lon", "46.9975, lon")
            .replace("planner:", &line);
        let mission = Mission::parse(".", &text).expect("a good spec");
        let planned = sortie::plan(&mission);
        assert!(planned.review.passes(), "{:?}", planned.review.margins);
        let margins = planned.review.margins.iter();
        let of_dome = margins.filter(|margin| margin.limit.to_string().contains("radar"));
        let bounds: Vec<f64> = of_dome.map(|margin| margin.bound).collect();
        assert!(bounds.len() > 10, "{bounds:?}");
        let least_and_most = bounds
            .iter()
            .fold((f64::MAX, f64::MIN), |(least, most), &of| {
                (of.min(least), of.max(most))
            });
        assert_eq!(least_and_most, (threats_m, threats_m));
        // It is flown past as near as that allows.
        let mut margins = planned.review.margins.iter();
        let is_near = margins.any(|margin| {
            margin.limit.to_string().contains("radar") && margin.value < threats_m + 8.0
        });
        assert!(is_near, "threats {threats_m} m, zones {zones_m} m");
    }
}
