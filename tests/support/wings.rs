//! Planes and VTOL with stops.
#![allow(dead_code, unreachable_pub, missing_docs)]

use std::path::Path;

use sortie::spec::{MissionSpec, SpecFile};

/// Autopilots and airframes.
pub const KINDS: [(&str, &str); 4] = [
    ("ardupilot", "plane"),
    ("px4", "plane"),
    ("ardupilot", "vtol"),
    ("px4", "vtol"),
];

const SPEC: &str = "
sortie: 2
name: wings
area: {south_west: {lat: 47.35, lon: 8.43}, north_east: {lat: 47.45, lon: 8.60}, min_agl_m: 60, max_amsl_m: 900}
terrain: {flat: {amsl_m: 430}}
threats: [{id: mast, kind: mast, lat: 47.3815, lon: 8.5505, radius_m: 150}]
vehicles:
  - {id: heron, sysid: 1, autopilot: AUTOPILOT, airframe: AIRFRAME, link: sim, speed_mps: 18, max_load_factor: 1.2,
     ENDS
     start: {lat: 47.380, lon: 8.475, agl_m: 80}, goal: {lat: 47.430, lon: 8.480, agl_m: 80}, finish: land,
     max_climb_deg: 10, max_descent_deg: 8,
     stops: [{id: t1, lat: 47.400, lon: 8.520, agl_m: 90, actions: [{photo: {}}, {roi_none: {}}]},
             {id: t2, lat: 47.385, lon: 8.550, agl_m: 100}, {id: t3, lat: 47.410, lon: 8.500, agl_m: 80}]}
planner: {evaluations: 6000}
";

/// A wing that flies past three places and a mast.
pub fn wing_with_stops(autopilot: &str, airframe: &str) -> MissionSpec {
    let ends = match airframe {
        "plane" => {
            "home: {lat: 47.380, lon: 8.460}, takeoff_heading_deg: 90, landing: {heading_deg: 270, glide_deg: 6},"
        }
        _ => "",
    };
    let text = SPEC
        .replace("AUTOPILOT", autopilot)
        .replace("AIRFRAME", airframe)
        .replace("ENDS", ends);
    SpecFile::parse(Path::new("wings.yaml"), text)
        .expect("good")
        .spec
}
