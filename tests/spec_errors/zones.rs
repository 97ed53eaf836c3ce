//! Zones with a shape: what is read, and what is refused with its position.

use std::path::Path;

use sortie::geodesy::{Agl, Amsl};
use sortie::spec::{Placement, SpecFile, Zone};

const HEAD: &str = "sortie: 1
name: zones
area: {south_west: {lat: 36.2, lon: -84.4}, north_east: {lat: 36.4, lon: -84.1}, min_agl_m: 60, max_amsl_m: 1500}
terrain: {flat: {amsl_m: 400}}
vehicles:
  - {id: alpha, sysid: 1, autopilot: ardupilot, link: sim, start: {lat: 36.25, lon: -84.35, agl_m: 80},
     goal: {lat: 36.35, lon: -84.15, agl_m: 80}, finish: land, speed_mps: 15}
";

fn read(more: &str) -> Result<Vec<Zone>, Vec<String>> {
    let file = SpecFile::parse(Path::new("zones.yaml"), format!("{HEAD}{more}"));
    file.map(|file| file.spec.no_fly).map_err(|error| {
        error
            .issues
            .iter()
            .map(|of| format!("{}: {}", of.path, of.found))
            .collect()
    })
}

#[test]
fn zones_have_circles_holes_floors_ceilings_and_times() {
    let zones = read(
        "
t0: 2026-12-01T08:00:00Z
qnh_hpa: {min: 995, max: 1030}
zones:
  - {id: mast, circle: {lat: 36.3, lon: -84.2, radius_m: 40}, ceiling: {agl_m: 90}}
  - id: tma
    polygon: [[36.30, -84.30], [36.30, -84.28], [36.32, -84.28], [36.32, -84.30]]
    holes: [[[36.305, -84.295], [36.305, -84.285], [36.315, -84.29]]]
    floor: {amsl_m: 900}
    ceiling: {fl: 65}
    active: {from: 2026-12-01T08:10:00Z, to: 2026-12-01T11:00:00+01:00}
",
    )
    .expect("good");
    let (mast, tma) = (&zones[0], &zones[1]);
    assert_eq!(mast.ceiling, Some(Placement::Agl(Agl(90.0))));
    assert_eq!(mast.circle.map(|(_, radius_m)| radius_m), Some(40.0));
    assert_eq!(
        (tma.floor, tma.active_s),
        (Some(Placement::Amsl(Amsl(900.0))), Some((600.0, 7200.0)))
    );
    // 6500 ft, and as many metres more as 1030 hPa are below the sea of the standard atmosphere.
    let Some(Placement::Amsl(Amsl(top_m))) = tma.ceiling else {
        panic!("{tma:?}")
    };
    assert!((top_m - (1981.2 + 138.5)).abs() < 1.0, "{top_m}");
    assert_eq!(tma.outline().len(), 4 + 3 + 2);
}

#[test]
fn without_t0_a_zone_is_always_active() {
    let zones = read(
        "
zones:
  - {id: a, circle: {lat: 36.3, lon: -84.2, radius_m: 40}, active: {from: 2026-12-01T08:10:00Z}}
",
    );
    assert_eq!(zones.expect("good")[0].active_s, None);
}

#[test]
fn what_is_wrong_with_a_zone_is_reported_where_it_stands() {
    let errors = read("
t0: noon
no_fly: [{id: b, polygon: [[36.30, -84.30], [36.30, -84.28], [36.32, -84.28]]}]
zones:
  - {id: a, circle: {lat: 36.3, lon: -84.2, radius_m: 40}, floor: {fl: 65}}
  - {id: b, circle: {lat: 36.3, lon: -84.2, radius_m: 40}, floor: {amsl_m: 900}, ceiling: {amsl_m: 800}}
  - {id: c}
  - {id: d, circle: {lat: 36.3, lon: -84.2, radius_m: 40}, floor: {amsl_m: 900, agl_m: 3}}
  - id: e
    polygon: [[36.30, -84.30], [36.30, -84.28], [36.32, -84.28], [36.32, -84.30]]
    holes: [[[36.305, -84.295], [36.305, -84.275], [36.315, -84.29]]]
")
    .expect_err("bad");
    for (path, part) in [
        ("t0", "`noon`"),
        ("zones[0].floor", "flight level 65 without qnh_hpa"),
        ("zones[1].id", "already the id of no_fly[0]"),
        (
            "zones[1].ceiling",
            "a ceiling at 800.0 m and a floor at 900.0 m",
        ),
        ("zones[2]", "none or both of polygon and circle"),
        ("zones[3].floor", "none or several of amsl_m, agl_m and fl"),
        ("zones[4].holes[0]", "a hole that is not inside the polygon"),
    ] {
        let found = errors
            .iter()
            .any(|error| error.contains(path) && error.contains(part));
        assert!(found, "{path}: {part}: {errors:#?}");
    }
    assert_eq!(errors.len(), 7, "{errors:#?}");
}
