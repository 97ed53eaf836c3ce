//! Analytic hills that are narrower than the grid of the search.

use geo::{LineString, Polygon};
use sortie::geodesy::{Amsl, EastNorth, LatLon, LocalFrame};
use sortie::spec::Hill;
use sortie::world::{Ground, Terrain};

/// A square of 20 km: nodes are 20 m apart.
fn sampled(hills: Vec<Hill>) -> (Ground, LocalFrame) {
    let frame = LocalFrame::new(LatLon {
        lat_deg: 46.5,
        lon_deg: 8.0,
    });
    let corners = vec![(-1e4, -1e4), (1e4, -1e4), (1e4, 1e4), (-1e4, 1e4)];
    let area = Polygon::new(LineString::from(corners), vec![]);
    let base = Amsl(300.0);
    let terrain = Terrain::Analytic { base, hills };
    (Ground::sample(&terrain, &frame, &area), frame)
}

fn hill(east_m: f64, height_m: f64) -> Hill {
    Hill {
        place: LatLon {
            lat_deg: 46.5,
            lon_deg: 8.0 + east_m / 76_700.0,
        },
        height_m,
        radius_m: 1.0,
    }
}

#[test]
fn a_hill_narrower_than_the_grid_is_seen_wherever_it_stands_between_the_nodes() {
    for east_m in [0.0, 3.0, 9.8, 15.0] {
        let hill = hill(east_m, 100.0);
        let (ground, frame) = sampled(vec![hill]);
        let on_top_m = ground.height_m(frame.to_plan(hill.place));
        assert!((400.0..420.0).contains(&on_top_m), "{east_m}: {on_top_m}");
        let far = EastNorth {
            east_m: 500.0,
            north_m: 0.0,
        };
        assert!((ground.height_m(far) - 300.0).abs() < 1e-3);
    }
}

#[test]
fn many_narrow_hills_side_by_side_are_no_higher_than_the_ridge_that_they_make() {
    // A metre apart a ridge is 1.77 times as high as one of its hills.
    let hills: Vec<Hill> = (0..500).map(|at| hill(f64::from(at), 50.0)).collect();
    let middle = hills[250].place;
    let (ground, frame) = sampled(hills);
    let height_m = ground.height_m(frame.to_plan(middle));
    assert!((385.0..405.0).contains(&height_m), "{height_m}");
}
