//! What altitude costs at least over level ground, between two ends above the lowest altitude.
//!
//! Where a km of a path costs `1 + w z` at the height `z` over the lowest altitude, a path of
//! `s` km in the plane from height `a` to height `b` costs at least
//! `S + g(s) b - g(0) a`, where `g` is any function of the way with `g' <= w` and `|g| <= 1`, and
//! `S` the integral of `sqrt(1 - g^2)`: the potential `S(x) + g(x) z` rises by
//! `(sqrt(1 - g^2) + g' z, g)`, which is no longer than `1 + w z`. The best `g` is nearly the sine of
//! the slope of the cheapest path: it descends, flies along the lowest altitude, and climbs. What is
//! proven is exact up to the square of that slope, and less than the least cost where it is steep.

/// Halvings of the range of slopes by a third of it.
const STEPS: usize = 100;

/// Cost of a km along the lowest altitude being 1, of a path of some length in the plane between
/// two heights over that altitude, km; `price` is what a km costs more for each km of height.
pub(super) fn least(length_km: f64, heights_km: (f64, f64), price: f64) -> f64 {
    let (from, to) = (heights_km.0.max(0.0), heights_km.1.max(0.0));
    let straight = length_km.hypot(to - from);
    let (down, up) = (sine(price * from), sine(price * to));
    let known = match down + up < price * length_km {
        true => length_km + gain(from, down, price) + gain(to, up, price),
        false => along_one_arc(length_km, (from, to), price),
    };
    straight.max(known)
}

/// Sine of the slope at which the cheapest descent to the lowest altitude begins.
fn sine(priced_height: f64) -> f64 {
    let cosine = (1.0 - priced_height).max(0.0);
    (1.0 - cosine * cosine).sqrt()
}

/// What a descent adds to the length in the plane.
fn gain(height_km: f64, sine: f64, price: f64) -> f64 {
    match sine > 0.0 {
        true => sine * height_km - (sine - area(sine)) / price,
        false => 0.0,
    }
}

/// Integral of `sqrt(1 - g^2)` from 0.
fn area(sine: f64) -> f64 {
    let sine = sine.clamp(-1.0, 1.0);
    0.5 * (sine * (1.0 - sine * sine).sqrt() + sine.asin())
}

/// The ways down and up meet above the lowest altitude.
fn along_one_arc(length_km: f64, (from, to): (f64, f64), price: f64) -> f64 {
    let turn = price * length_km;
    if turn <= 0.0 || turn > 2.0 {
        return length_km;
    }
    let value = |first: f64| {
        let last = first + turn;
        (area(last) - area(first)) / price + last * to - first * from
    };
    // It is concave.
    let (mut low, mut high) = (-1.0, 1.0 - turn);
    for _ in 0..STEPS {
        let third = (high - low) / 3.0;
        match value(low + third) < value(high - third) {
            true => low += third,
            false => high -= third,
        }
    }
    value(low)
}

#[cfg(test)]
mod tests {
    use super::least;

    /// Cost of a path by its heights at equal steps in the plane.
    fn cost(length_km: f64, heights_km: &[f64], price: f64) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "few")]
        let step = length_km / (heights_km.len() - 1) as f64;
        let piece =
            |two: &[f64]| step.hypot(two[1] - two[0]) * (1.0 + price * 0.5 * (two[0] + two[1]));
        heights_km.windows(2).map(piece).sum()
    }

    /// The cheapest path over some heights: by coordinate, until nothing gets cheaper.
    fn cheapest(length_km: f64, (from, to): (f64, f64), price: f64) -> f64 {
        let share = |step: usize| f64::from(u32::try_from(step).expect("few")) / 40.0;
        let mut heights: Vec<f64> = (0..=40)
            .map(|step| from + (to - from) * share(step))
            .collect();
        for _ in 0..2000 {
            for at in 1..40 {
                let (mut low, mut high) = (0.0, 1.0_f64);
                for _ in 0..60 {
                    let third: f64 = (high - low) / 3.0;
                    let near = |height: f64| {
                        let three = [heights[at - 1], height, heights[at + 1]];
                        cost(length_km / 20.0, &three, price)
                    };
                    match near(low + third) > near(high - third) {
                        true => low += third,
                        false => high -= third,
                    }
                }
                heights[at] = low;
            }
        }
        cost(length_km, &heights, price)
    }

    #[test]
    fn it_is_hardly_less_than_the_cheapest_path_costs_unless_that_is_steep() {
        for (length_km, heights_km, price, share) in [
            (0.07, (0.02, 0.02), 1.0, 0.9999),
            (0.1, (0.0, 0.05), 1.0, 0.996),
            (0.5, (0.3, 0.02), 2.0, 0.94),
            (1.2, (0.02, 0.04), 1.0, 0.9995),
        ] {
            let (proven, found) = (
                least(length_km, heights_km, price),
                cheapest(length_km, heights_km, price),
            );
            assert!(proven <= found + 1e-9, "{length_km}: {proven} {found}");
            assert!(proven > found * share, "{length_km}: {proven} {found}");
        }
    }

    #[test]
    fn without_a_price_it_is_the_straight_line() {
        assert!((least(3.0, (0.0, 4.0), 0.0) - 5.0).abs() < 1e-12);
        assert!((least(3.0, (0.5, 0.5), 0.0) - 3.0).abs() < 1e-12);
    }
}
