//! Which slopes of a potential a price allows, where paths climb and descend no steeper than so.

use std::ops::RangeInclusive;

/// Slopes that a path may have, rise over run, from its descent (negative) to its climb.
pub(super) type Slopes = RangeInclusive<f64>;

/// The direction, as rise over run, in which a potential with slope `along` the ground (not
/// negative) and `up` rises most.
fn steepest(along: f64, up: f64, slopes: &Slopes) -> f64 {
    let free = if along > 0.0 {
        up / along
    } else if up > 0.0 {
        f64::INFINITY
    } else {
        f64::NEG_INFINITY
    };
    free.clamp(*slopes.start(), *slopes.end())
}

/// How much a potential rises at most per length of a path.
pub(super) fn rate(along: f64, up: f64, slopes: &Slopes) -> f64 {
    if along <= 0.0 && up.abs() <= 0.0 {
        return 0.0;
    }
    let slope = steepest(along, up, slopes);
    (along + up * slope) / (slope * slope + 1.0).sqrt()
}

/// The nearest potential slope (east, north, up) that rises by no more than `price`.
pub(super) fn project([east, north, up]: [f64; 3], price: f64, slopes: &Slopes) -> [f64; 3] {
    let along = east.hypot(north);
    if rate(along, up, slopes) <= price {
        return [east, north, up];
    }
    let slope = steepest(along, up, slopes);
    let is_free = slope > *slopes.start() && slope < *slopes.end();
    let (along_to, up_to) = if is_free {
        let size = along.hypot(up);
        (along * price / size, up * price / size)
    } else {
        onto_face((along, up), price, slope)
    };
    let share = if along > 0.0 { along_to / along } else { 0.0 };
    [east * share, north * share, up_to]
}

/// The nearest point of the face of one slope: from the axis to where the arc begins.
fn onto_face((along, up): (f64, f64), price: f64, slope: f64) -> (f64, f64) {
    let size = (slope * slope + 1.0).sqrt();
    let (run, rise) = (1.0 / size, slope / size);
    let over = along * run + up * rise - price;
    let (along, up) = (along - over * run, up - over * rise);
    if along < 0.0 {
        (0.0, price / rise)
    } else if (up - slope * along) * slope < 0.0 {
        (price * run, price * rise)
    } else {
        (along, up)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::{project, rate};

    proptest! {
        /// Against many directions, and against every allowed slope for the projection.
        #[test]
        fn the_rate_is_that_of_the_steepest_direction_and_the_projection_is_nearest(
            along in 0.0..3.0_f64, up in -8.0..8.0_f64, price in 0.5..2.0_f64,
            climb in 0.05..1.0_f64, descent in 0.05..1.0_f64,
            other_along in 0.0..3.0_f64, other_up in -8.0..8.0_f64,
        ) {
            let slopes = -descent..=climb;
            let directions = (0..=1000).map(|at| -descent + (climb + descent) * f64::from(at) / 1000.0);
            let most = directions.map(|slope| (along + up * slope) / slope.hypot(1.0)).fold(f64::MIN, f64::max);
            let found = rate(along, up, &slopes);
            prop_assert!(found >= most - 1e-12 && found <= most + 1e-5 * (1.0 + up.abs()));
            let [near, north, near_up] = project([along, 0.0, up], price, &slopes);
            prop_assert_eq!(north.to_bits(), 0.0_f64.to_bits());
            prop_assert!(rate(near.abs(), near_up, &slopes) <= price * (1.0 + 1e-12));
            if rate(other_along, other_up, &slopes) <= price {
                let distance = (near - along).hypot(near_up - up);
                prop_assert!(distance <= (other_along - along).hypot(other_up - up) + 1e-9);
            }
        }
    }
}
