//! The surface that `ArduPilot` follows: bilinear between posts of its own, with the heights of the same source.

use crate::geodesy::LatLon;
use crate::world::Terrain;

use super::outline::metres_per_degree;

/// How far the surface of the posts may be from the ground at a place, metres, neither below 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Apart {
    /// By how much it may be below the ground.
    pub(crate) below_m: f64,
    /// By how much it may be above.
    pub(crate) above_m: f64,
}

impl Apart {
    /// Neither by more than this, metres.
    pub(crate) fn within(self, max_m: f64) -> Self {
        Self {
            below_m: self.below_m.min(max_m),
            above_m: self.above_m.min(max_m),
        }
    }

    /// The same where all of the surface is moved so that it is on the ground at home.
    pub(crate) fn moved(self, at_home: Self) -> Self {
        Self {
            below_m: self.below_m + at_home.above_m,
            above_m: self.above_m + at_home.below_m,
        }
    }

    pub(crate) fn max_m(self) -> f64 {
        self.below_m.max(self.above_m)
    }
}

/// In how many ways along each axis a place is taken to lie between two posts.
const WAYS: i32 = 4;

/// How far the two surfaces may be apart at a place. The positions of the posts are not known: the
/// worst of 16 counts. Voids are judged elsewhere.
pub(crate) fn apart(terrain: &Terrain, at: LatLon, spacing_m: f64) -> Apart {
    if matches!(terrain, Terrain::Flat(_) | Terrain::Unknown) {
        return Apart::default();
    }
    let (north, east) = metres_per_degree(at.lat_deg);
    let step_m = spacing_m / f64::from(WAYS);
    let ground_m = |right: i32, up: i32| {
        let place = LatLon {
            lat_deg: at.lat_deg + f64::from(up) * step_m / north,
            lon_deg: at.lon_deg + f64::from(right) * step_m / east,
        };
        terrain.height(place).ok().map(|amsl| amsl.0)
    };
    let Some(here_m) = ground_m(0, 0) else {
        return Apart::default();
    };
    // The place lies x and y quarters of a cell from the post in its south west.
    let between_m = |x: i32, y: i32| {
        let along = |low: f64, high: f64, quarters: i32| {
            low + (high - low) * f64::from(quarters) / f64::from(WAYS)
        };
        let south = along(ground_m(-x, -y)?, ground_m(WAYS - x, -y)?, x);
        let north = along(ground_m(-x, WAYS - y)?, ground_m(WAYS - x, WAYS - y)?, x);
        Some(along(south, north, y))
    };
    let ways = (0..WAYS).flat_map(|x| (0..WAYS).filter_map(move |y| between_m(x, y)));
    ways.fold(Apart::default(), |most, posts_m| Apart {
        below_m: most.below_m.max(here_m - posts_m),
        above_m: most.above_m.max(posts_m - here_m),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geodesy::Amsl;
    use crate::spec::Hill;

    fn ridge(height_m: f64, radius_m: f64) -> Terrain {
        let place = LatLon {
            lat_deg: 47.4,
            lon_deg: 8.5,
        };
        Terrain::Analytic {
            base: Amsl(400.0),
            hills: vec![Hill {
                place,
                height_m,
                radius_m,
            }],
        }
    }

    #[test]
    fn posts_of_no_more_than_the_size_of_a_hill_follow_it_and_wide_ones_miss_its_top() {
        let top = LatLon {
            lat_deg: 47.4,
            lon_deg: 8.5,
        };
        // Half of a cell away from all posts, 71 m of them at 100 m: exp(-2) of the hill is left there.
        let wide = apart(&ridge(50.0, 50.0), top, 100.0);
        assert!(
            (wide.below_m - 50.0 * (1.0 - (-2.0_f64).exp())).abs() < 1.0,
            "{wide:?}"
        );
        assert!(wide.above_m.abs() < 1e-9, "{wide:?}");
        let close = apart(&ridge(50.0, 50.0), top, 10.0);
        assert!(close.below_m < 1.5, "{close:?}");
        assert_eq!(
            apart(&Terrain::Flat(Amsl(400.0)), top, 100.0),
            Apart::default()
        );
    }
}
