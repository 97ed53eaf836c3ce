//! Gaussian hills under a line: what each of them can do within a piece of it, and no more.

use crate::geodesy::{LatLon, METRES_PER_DEG};
use crate::spec::Hill;

use super::outline::metres_per_degree;
use super::patch::{ERROR_M, Patch, SHARE};
use super::segment::DEVIATION_M;

/// What all hills that are left out of a piece may add together, metres.
const LEFT_OUT_M: f64 = 1e-6;
/// Halvings of a line: enough for centimetres on any of them.
const MAX_HALVINGS: u32 = 28;

/// A hill, measured in its own radii.
#[derive(Clone, Copy, Debug)]
struct Knoll {
    place: LatLon,
    height_m: f64,
    /// Radii in a degree of latitude and of longitude.
    north: f64,
    east: f64,
}

/// One hill over one line: `height exp(-(offset^2 + x^2))`, `x = from + way w`, in radii.
#[derive(Clone, Copy, Debug)]
struct Profile {
    height_m: f64,
    /// Radii in a metre.
    radii_per_m: f64,
    offset: f64,
    from: f64,
    way: f64,
}

/// What a hill can do within a piece.
#[derive(Clone, Copy, Debug)]
struct Reach {
    /// It is no higher (or deeper) than this, metres.
    top_m: f64,
    /// Its part of the parabola misses it by no more, metres.
    error_m: f64,
}

/// A piece of a line with the heights at its ends, metres.
#[derive(Clone, Copy, Debug)]
struct Piece {
    w: (f64, f64),
    height_m: (f64, f64),
    /// What the hills left out so far may change, metres.
    left_out_m: f64,
    halvings: u32,
}

/// Hills over a base.
#[derive(Clone, Debug)]
pub(crate) struct Hills {
    base_m: f64,
    knolls: Vec<Knoll>,
}

impl Hills {
    pub(crate) fn new(base_m: f64, hills: &[Hill]) -> Self {
        let knoll = |hill: &Hill| {
            let north = METRES_PER_DEG / hill.radius_m;
            Knoll {
                place: hill.place,
                height_m: hill.height_m,
                north,
                east: north * hill.place.lat_deg.to_radians().cos(),
            }
        };
        Self {
            base_m,
            knolls: hills.iter().map(knoll).collect(),
        }
    }

    /// The ground under the line between two places, straight in latitude and longitude:
    /// halved until a parabola through three points is within a millimetre.
    pub(crate) fn under(&self, from: LatLon, to: LatLon) -> Vec<Patch> {
        let profiles: Vec<Profile> = self.profiles(from, to).collect();
        let near = self.near(&profiles, (0.0, 1.0));
        let piece = Piece {
            w: (0.0, 1.0),
            height_m: (self.height_m(&near.0, 0.0), self.height_m(&near.0, 1.0)),
            left_out_m: near.1,
            halvings: 0,
        };
        let mut patches = Vec::new();
        self.cut(&near.0, piece, &mut patches);
        patches
    }

    /// A bound of the slope of the ground, rise over run, within `within_m` of the
    /// line between two places.
    pub(crate) fn steepest(&self, (from, to): (LatLon, LatLon), within_m: f64) -> f64 {
        self.profiles(from, to)
            .map(|profile| profile.steepest((0.0, 1.0), within_m))
            .sum()
    }

    fn profiles(&self, from: LatLon, to: LatLon) -> impl Iterator<Item = Profile> {
        let (north_m, east_m) = metres_per_degree(from.lat_deg);
        self.knolls
            .iter()
            .map(move |knoll| Profile::new(knoll, (from, to), (north_m, east_m)))
    }

    /// The profiles that matter within a piece, and what the others may change, metres: each
    /// of those is missing from the ground, and may be part of heights at the ends.
    fn near(&self, profiles: &[Profile], w: (f64, f64)) -> (Vec<Profile>, f64) {
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 hills")]
        let min_m = LEFT_OUT_M / self.knolls.len().max(1) as f64;
        let mut left_out_m = 0.0;
        let near = profiles.iter().filter(|profile| {
            let top_m = profile.reach(w).top_m;
            let matters = top_m > min_m;
            if !matters {
                left_out_m += 2.25 * top_m;
            }
            matters
        });
        let near = near.copied().collect();
        (near, left_out_m)
    }

    fn height_m(&self, profiles: &[Profile], w: f64) -> f64 {
        let sum_m: f64 = profiles.iter().map(|one| one.height_m(w)).sum();
        self.base_m + sum_m
    }

    /// Patches of a piece, halved where one parabola is not enough.
    fn cut(&self, profiles: &[Profile], piece: Piece, patches: &mut Vec<Patch>) {
        let (near, left_out_m) = self.near(profiles, piece.w);
        let left_out_m = piece.left_out_m + left_out_m;
        let middle = 0.5 * (piece.w.0 + piece.w.1);
        let middle_m = self.height_m(&near, middle);
        let error_m: f64 = near.iter().map(|one| one.reach(piece.w).error_m).sum();
        if error_m > ERROR_M && piece.halvings < MAX_HALVINGS {
            let half = |w, height_m| Piece {
                w,
                height_m,
                left_out_m,
                halvings: piece.halvings + 1,
            };
            let first = half((piece.w.0, middle), (piece.height_m.0, middle_m));
            let second = half((middle, piece.w.1), (middle_m, piece.height_m.1));
            self.cut(&near, first, patches);
            self.cut(&near, second, patches);
            return;
        }
        // The flight itself is this far off the line.
        let aside_m: f64 = near
            .iter()
            .map(|one| DEVIATION_M * one.steepest(piece.w, DEVIATION_M))
            .sum();
        patches.push(Patch {
            w: piece.w,
            height_m: piece.height_m,
            bulge_m: middle_m - 0.5 * (piece.height_m.0 + piece.height_m.1),
            error_m: error_m + left_out_m + aside_m,
        });
    }
}

impl Profile {
    fn new(knoll: &Knoll, (from, to): (LatLon, LatLon), (north_m, east_m): (f64, f64)) -> Self {
        let radii = |place: LatLon| {
            (
                (place.lon_deg - knoll.place.lon_deg) * knoll.east,
                (place.lat_deg - knoll.place.lat_deg) * knoll.north,
            )
        };
        let (start, end) = (radii(from), radii(to));
        let (dx, dy) = (end.0 - start.0, end.1 - start.1);
        let way = dx.hypot(dy);
        let (ux, uy) = if way > 0.0 {
            (dx / way, dy / way)
        } else {
            (1.0, 0.0)
        };
        Self {
            height_m: knoll.height_m,
            // A hundredth more for what a degree changes along a line.
            radii_per_m: 1.01 * (knoll.north / north_m).max(knoll.east / east_m),
            offset: start.0 * uy - start.1 * ux,
            from: start.0 * ux + start.1 * uy,
            way,
        }
    }

    fn height_m(&self, w: f64) -> f64 {
        let x = self.from + self.way * w;
        self.height_m * (-(self.offset * self.offset + x * x)).exp()
    }

    /// The least `|x|` within a piece.
    fn nearest(&self, w: (f64, f64)) -> f64 {
        let (a, b) = (self.from + self.way * w.0, self.from + self.way * w.1);
        if a * b <= 0.0 {
            0.0
        } else {
            a.abs().min(b.abs())
        }
    }

    fn reach(&self, w: (f64, f64)) -> Reach {
        let nearest = self.nearest(w);
        let peak_m = self.height_m.abs() * (-self.offset * self.offset).exp();
        let top_m = peak_m * (-nearest * nearest).exp();
        // A parabola is nowhere further from 0 than 5/4 of what it goes through, so it misses
        // by at most 9/8 of the whole range, however long the piece.
        let length = self.way * (w.1 - w.0);
        let bent_m = peak_m * third_derivative(nearest) * length.powi(3) / SHARE;
        Reach {
            top_m,
            error_m: bent_m.min(1.125 * top_m),
        }
    }

    /// A bound of its slope within `within_m` of a piece.
    fn steepest(&self, w: (f64, f64), within_m: f64) -> f64 {
        let away = self.offset.hypot(self.nearest(w)) - within_m * self.radii_per_m;
        self.height_m.abs() * self.radii_per_m * first_derivative(away)
    }
}

/// A bound of `|d/dx exp(-x^2)|` from some `x` outwards.
fn first_derivative(x: f64) -> f64 {
    // The greatest is 0.8578, at 0.7071.
    if x < 0.7072 {
        0.858
    } else {
        2.0 * x * (-x * x).exp()
    }
}

/// A bound of `|d^3/dx^3 exp(-x^2)|` from some `x` on, away from 0.
fn third_derivative(x: f64) -> f64 {
    // The greatest is 3.904, at 0.5247; the last extreme is at 1.6507.
    if x < 1.651 {
        4.0
    } else {
        (8.0 * x * x * x - 12.0 * x) * (-x * x).exp()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::{Hills, METRES_PER_DEG};
    use crate::geodesy::{Amsl, LatLon};
    use crate::spec::Hill;
    use crate::verify::measure::outline::metres_per_degree;
    use crate::world::Terrain;

    fn place((north_m, east_m): (f64, f64)) -> LatLon {
        let lat_deg = 46.5 + north_m / METRES_PER_DEG;
        let cos = 46.5_f64.to_radians().cos();
        LatLon {
            lat_deg,
            lon_deg: 8.0 + east_m / METRES_PER_DEG / cos,
        }
    }

    fn hill(at_m: (f64, f64), height_m: f64, radius_m: f64) -> Hill {
        Hill {
            place: place(at_m),
            height_m,
            radius_m,
        }
    }

    fn hills() -> impl Strategy<Value = Vec<Hill>> {
        let one = (
            (-300.0..300.0, -300.0..300.0),
            -200.0..400.0_f64,
            0.0..6.0_f64,
        );
        let one = one.prop_map(|(at_m, height_m, size)| hill(at_m, height_m, size.exp()));
        prop::collection::vec(one, 0..12)
    }

    fn at((a, b): (LatLon, LatLon), w: f64) -> LatLon {
        LatLon {
            lat_deg: a.lat_deg + (b.lat_deg - a.lat_deg) * w,
            lon_deg: a.lon_deg + (b.lon_deg - a.lon_deg) * w,
        }
    }

    fn truth_m(hills: &[Hill], place: LatLon) -> f64 {
        let base = Amsl(300.0);
        let hills = hills.to_vec();
        Terrain::Analytic { base, hills }.height(place).unwrap().0
    }

    proptest! {
        /// The parabolas with their errors hold every sample, and say so within centimetres.
        #[test]
        fn the_ground_is_within_its_error_of_every_parabola(
            hills in hills(),
            from in (-300.0..300.0, -300.0..300.0),
            to in (-300.0..300.0, -300.0..300.0),
        ) {
            let line = (place(from), place(to));
            let ground = Hills::new(300.0, &hills);
            let mut last = 0.0;
            for patch in ground.under(line.0, line.1) {
                prop_assert!((patch.w.0 - last).abs() < f64::EPSILON);
                last = patch.w.1;
                for part in 0..=16 {
                    let v = f64::from(part) / 16.0;
                    let w = patch.w.0 + (patch.w.1 - patch.w.0) * v;
                    let (h0, h1) = patch.height_m;
                    let parabola_m = h0 + (h1 - h0) * v + 4.0 * patch.bulge_m * v * (1.0 - v);
                    let off_m = (parabola_m - truth_m(&hills, at(line, w))).abs();
                    prop_assert!(off_m <= patch.error_m + 1e-8, "{off_m} {patch:?}");
                }
                let slope = ground.steepest(line, 0.0);
                prop_assert!(patch.error_m <= 1.1e-3 * (1.0 + slope), "{patch:?}");
            }
            prop_assert!((last - 1.0).abs() < f64::EPSILON);
        }

        #[test]
        fn near_a_line_the_ground_rises_by_no_more_than_the_bound_of_its_slope(
            hills in hills(),
            from in (-300.0..300.0, -300.0..300.0),
            way in (-20.0..20.0, -20.0..20.0),
            (share, aside) in (0.0..1.0_f64, (-5.0..5.0_f64, -5.0..5.0_f64)),
        ) {
            let line = (place(from), place((from.0 + way.0, from.1 + way.1)));
            let on = at(line, share);
            let (north_m, east_m) = metres_per_degree(on.lat_deg);
            let near = LatLon {
                lat_deg: on.lat_deg + aside.0 / north_m,
                lon_deg: on.lon_deg + aside.1 / east_m,
            };
            let away_m = aside.0.hypot(aside.1);
            let rise_m = (truth_m(&hills, near) - truth_m(&hills, on)).abs();
            let slope = Hills::new(300.0, &hills).steepest(line, away_m);
            prop_assert!(rise_m <= slope * away_m + 1e-8, "{rise_m} {slope} {away_m}");
        }
    }

    #[test]
    fn hills_far_from_a_line_neither_cut_it_nor_add_to_its_error() {
        let far: Vec<Hill> = (0..1600)
            .map(|index| {
                hill(
                    (40.0 + f64::from(index), 3.0 * f64::from(index)),
                    100.0,
                    1.0,
                )
            })
            .collect();
        let patches = Hills::new(300.0, &far).under(place((0.0, -9e3)), place((0.0, 9e3)));
        assert_eq!(patches.len(), 1);
        assert!(patches[0].error_m < 1e-5, "{patches:?}");
    }
}
