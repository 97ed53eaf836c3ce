use super::*;
use crate::flight::conformance::reference::Waypoint;
use crate::flight::itinerary::stops::Itinerary;
use crate::flight::record::{Flown, Plan};
use crate::geodesy::{Amsl, LatLon};
use crate::spec::SpecFile;

const TEXT: &str = "
sortie: 2
name: parts
area: {south_west: {lat: 36.28, lon: -84.30}, north_east: {lat: 36.32, lon: -84.22}, min_agl_m: 30, max_amsl_m: 900}
terrain: {flat: {amsl_m: 400}}
vehicles:
  - {id: alpha, sysid: 1, autopilot: ardupilot, link: sim, speed_mps: 10, finish: land,
     start: {lat: 36.30, lon: -84.28, agl_m: 80}, goal: {lat: 36.30, lon: -84.23, agl_m: 80}}
";

/// A way to the east by these longitudes, and how many items its mission has.
fn plan(world: &World, lons_deg: &[f64], (items, from_s): (usize, f64)) -> Plan {
    let waypoints = lons_deg
        .iter()
        .enumerate()
        .map(|(item, &lon_deg)| Waypoint {
            item,
            point: PlanPoint {
                at: world.frame.to_plan(at(lon_deg)),
                amsl: Amsl(480.0),
            },
            t_s: (lon_deg + 84.28) * 9000.0,
            radius_m: 0.0,
            late_s: 0.0,
        });
    Plan {
        items,
        reference: ReferenceTrajectory::of_waypoints(
            waypoints.collect(),
            (450.0, false),
            world.frame,
        ),
        from_s,
    }
}

fn at(lon_deg: f64) -> LatLon {
    LatLon {
        lat_deg: 36.30,
        lon_deg,
    }
}

#[test]
fn an_item_that_is_reached_after_the_change_of_the_plan_was_not_passed_by_the_plan_before() {
    let spec = SpecFile::parse(std::path::Path::new("parts.yaml"), TEXT.to_owned());
    let spec = spec.expect("a spec").spec;
    let terrain = crate::world::Terrain::Flat(Amsl(400.0));
    let world = World::new(&spec, terrain).expect("ground");
    let before = plan(&world, &[-84.28, -84.275, -84.27, -84.24], (4, 0.0));
    let after = plan(
        &world,
        &[-84.28, -84.275, -84.27, -84.265, -84.24],
        (5, 80.0),
    );
    // It takes the new plan at 100 s, and is at its third item 2 s after that.
    let fixes = (0..=130).map(|t_s| Fix {
        t_s: f64::from(t_s),
        place: at(-84.28 + f64::from(t_s) / 9000.0),
        amsl: Amsl(480.0),
        speed_mps: 10.0,
        item: if t_s < 50 { 1 } else { 2 },
        items: if t_s < 100 { 4 } else { 5 },
        boot_ms: None,
    });
    let flown = Flown {
        fixes: fixes.collect(),
        reached: vec![(1, 46.0), (2, 91.0), (3, 102.0)],
        ..Flown::default()
    };
    let flight = Flight {
        vehicle: "alpha".to_owned(),
        plans: vec![before, after],
        flown,
        itinerary: Itinerary::default(),
    };
    let track = FlownTrack::new(&flight, &spec, &world);
    let parts: Vec<Part<'_>> = track.parts().collect();
    let passed = |part: &Part<'_>| {
        let passages = track.passages(part).into_iter();
        passages.map(|of| of.item).collect::<Vec<_>>()
    };
    assert_eq!(passed(&parts[0]), [1, 2]);
    assert_eq!(passed(&parts[1]), [3]);
}
