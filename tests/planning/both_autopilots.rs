//! What a mission may ask for, planned, encoded and judged for both autopilots: limits of altitude,
//! endurance, zones with a shape, airspace and obstacles of files.

use std::fs;
use std::path::Path;

use sortie::geodesy::LatLon;
use sortie::mission::{Item, VehicleMission, command};
use sortie::verify::{Limit, review};
use sortie::{Mission, plan};

const AUTOPILOTS: [&str; 2] = ["ardupilot", "px4"];

const SPEC: &str = "
sortie: 2
name: both
area: {south_west: {lat: 47.17, lon: 8.45}, north_east: {lat: 47.23, lon: 8.55}, min_agl_m: 40, max_amsl_m: 600}
terrain: {flat: {amsl_m: 200}}
MORE
vehicles:
  - {id: alpha, sysid: 1, autopilot: AUTOPILOT, link: sim, speed_mps: 8, finish: land,
     start: {lat: 47.195, lon: 8.485, agl_m: 80}, goal: {lat: 47.205, lon: 8.515, agl_m: 80}OWN}
planner: {evaluations: 3000}
";

/// A mission that is planned, and the items of its vehicle.
fn planned(folder: &Path, autopilot: &str, more: &str, own: &str) -> (Mission, VehicleMission) {
    let text = SPEC
        .replace("AUTOPILOT", autopilot)
        .replace("MORE", more)
        .replace("OWN", own);
    let mission = Mission::parse(folder, text).unwrap_or_else(|error| panic!("{error}"));
    let done = plan(&mission);
    let items = done.missions[0].1.clone();
    assert!(
        done.review.passes(),
        "{autopilot}: {:?}",
        failed(&mission, &items)
    );
    (mission, items)
}

/// The limits that items break, by the spec of a mission.
fn failed(mission: &Mission, items: &VehicleMission) -> Vec<String> {
    let review = review(mission.spec(), mission.world(), &[(0, items)]);
    let broken = review.margins.iter().filter(|margin| !margin.ok);
    broken.map(|margin| margin.limit.to_string()).collect()
}

fn breaks(mission: &Mission, items: &VehicleMission, limit: &Limit) -> bool {
    failed(mission, items).contains(&limit.to_string())
}

/// The indices of the waypoints on the way.
fn waypoints(items: &[Item]) -> Vec<usize> {
    let is_waypoint = |index: &usize| items[*index].command == command::NAV_WAYPOINT;
    (0..items.len()).filter(is_waypoint).collect()
}

/// The same with a place that is visited in the middle of the way.
#[allow(clippy::cast_possible_truncation)]
fn through(items: &VehicleMission, place: LatLon) -> VehicleMission {
    let mut changed = items.clone();
    let way = waypoints(&changed.items);
    let at = way[way.len() / 2];
    let mut inserted = changed.items[at];
    inserted.x = (place.lat_deg * 1e7) as i32;
    inserted.y = (place.lon_deg * 1e7) as i32;
    changed.items.insert(at, inserted);
    changed
}

fn place(lat_deg: f64, lon_deg: f64) -> LatLon {
    LatLon::new(lat_deg, lon_deg).expect("on earth")
}

/// How many items of its fence have a command.
fn fence_items(items: &VehicleMission, command: u16) -> usize {
    let fence = items.fence.iter();
    fence.filter(|item| item.command == command).count()
}

#[test]
fn limits_of_altitude_hold_for_the_items_of_both() {
    for autopilot in AUTOPILOTS {
        let own = ", max_agl_m: 120, min_amsl_m: 250";
        let (mission, items) = planned(Path::new("."), autopilot, "", own);
        for (by_m, limit) in [(60.0, Limit::MaxHeight), (-25.0, Limit::MinAltitude)] {
            let mut moved = items.clone();
            for index in waypoints(&moved.items) {
                moved.items[index].z += by_m;
            }
            assert!(breaks(&mission, &moved, &limit), "{autopilot}: {limit}");
        }
    }
}

#[test]
fn an_endurance_holds_for_the_items_of_both() {
    for autopilot in AUTOPILOTS {
        let own = ", endurance: {time_s: 1200, reserve: 0.2}";
        let (_, items) = planned(Path::new("."), autopilot, "", own);
        for short in [
            ", endurance: {time_s: 300, reserve: 0.2}",
            ", endurance: {range_m: 2000, reserve: 0.0}",
            ", endurance: {energy: {wh: 10, hover_w: 300}}",
        ] {
            let text = SPEC
                .replace("AUTOPILOT", autopilot)
                .replace("MORE", "")
                .replace("OWN", short);
            let mission = Mission::parse(".", text).expect("a good spec");
            assert!(
                breaks(&mission, &items, &Limit::Endurance),
                "{autopilot}: {short}"
            );
        }
    }
}

#[test]
fn zones_with_a_shape_hold_for_the_items_and_the_fence_of_both() {
    let zones = "
zones:
  - {id: mast, circle: {lat: 47.2, lon: 8.5, radius_m: 150}}
  - {id: shelf, polygon: [[47.19, 8.505], [47.21, 8.505], [47.21, 8.51], [47.19, 8.51]], floor: {amsl_m: 330}}
  - {id: wood, polygon: [[47.19, 8.49], [47.21, 8.49], [47.21, 8.493], [47.19, 8.493]], ceiling: {agl_m: 55}}
  - {id: frame, polygon: [[47.172, 8.452], [47.228, 8.452], [47.228, 8.548], [47.172, 8.548]],
     holes: [[[47.18, 8.46], [47.22, 8.46], [47.22, 8.54], [47.18, 8.54]]]}
  - {id: inside, keep_in: true, polygon: [[47.175, 8.46], [47.225, 8.46], [47.225, 8.54], [47.175, 8.54]]}";
    for autopilot in AUTOPILOTS {
        let (mission, items) = planned(Path::new("."), autopilot, zones, "");
        for (id, at) in [
            ("mast", place(47.2, 8.5)),
            ("frame", place(47.176, 8.5)),
            ("outside inside", place(47.2, 8.456)),
        ] {
            let limit = Limit::Zone(id.to_owned());
            let changed = through(&items, at);
            assert!(
                breaks(&mission, &changed, &limit),
                "{autopilot} {id}: {:?}",
                failed(&mission, &changed)
            );
        }
        for (id, by_m) in [("shelf", 70.0), ("wood", -30.0)] {
            let mut moved = items.clone();
            for index in waypoints(&moved.items) {
                moved.items[index].z += by_m;
            }
            let limit = Limit::Zone(id.to_owned());
            assert!(
                breaks(&mission, &moved, &limit),
                "{autopilot} {id}: {:?}",
                failed(&mission, &moved)
            );
        }
        // Zones with heights are in no fence; the others are, and the way lies in it.
        let (inclusions, polygons, circles) = (
            fence_items(&items, command::NAV_FENCE_POLYGON_VERTEX_INCLUSION),
            fence_items(&items, command::NAV_FENCE_POLYGON_VERTEX_EXCLUSION),
            fence_items(&items, command::NAV_FENCE_CIRCLE_EXCLUSION),
        );
        assert!(
            inclusions >= 4,
            "{autopilot}: {inclusions} {polygons} {circles}"
        );
        assert!(
            polygons + circles > 0,
            "{autopilot}: {inclusions} {polygons} {circles}"
        );
        let mut without = items.clone();
        without.fence.truncate(inclusions);
        assert!(
            breaks(&mission, &without, &Limit::FenceComplete),
            "{autopilot}: {:?}",
            failed(&mission, &without)
        );
    }
}

#[test]
fn airspace_and_obstacles_of_files_hold_for_the_items_of_both() {
    let folder = tempfile::tempdir().expect("a folder");
    let ring =
        "[[8.497, 47.198], [8.503, 47.198], [8.503, 47.202], [8.497, 47.202], [8.497, 47.198]]";
    let feature = format!(
        r#"{{"type": "FeatureCollection", "features": [{{"type": "Feature", "properties": {{"name": "prison"}},
            "geometry": {{"type": "Polygon", "coordinates": [{ring}]}}}}]}}"#
    );
    fs::write(folder.path().join("prison.geojson"), feature).expect("written");
    let masts = "id,lat,lon,height_m,radius_m\nturbine,47.2035,8.509,150,60\n";
    fs::write(folder.path().join("masts.csv"), masts).expect("written");
    let more = "airspace: [{file: prison.geojson, buffer_m: 40}]\nobstacles: [{file: masts.csv}]";
    for autopilot in AUTOPILOTS {
        let (mission, items) = planned(folder.path(), autopilot, more, "");
        for (id, at) in [
            ("prison", place(47.2, 8.5)),
            ("turbine", place(47.2035, 8.509)),
        ] {
            let limit = Limit::Zone(id.to_owned());
            let changed = through(&items, at);
            assert!(
                breaks(&mission, &changed, &limit),
                "{autopilot} {id}: {:?}",
                failed(&mission, &changed)
            );
        }
        // Within the buffer of the file alone.
        let near = through(&items, place(47.2023, 8.5));
        assert!(
            breaks(&mission, &near, &Limit::Zone("prison".to_owned())),
            "{autopilot}"
        );
        let zones = &mission.spec().no_fly;
        let source = zones[0].source.as_deref().unwrap_or_default();
        assert!(source.starts_with("prison.geojson"), "{source}");
        let exclusions = fence_items(&items, command::NAV_FENCE_POLYGON_VERTEX_EXCLUSION);
        assert_eq!(exclusions, 4, "{autopilot}");
    }
}
