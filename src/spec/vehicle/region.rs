//! Where a QuadPlane may be between its climb on rotors and its first leg.

use crate::autopilot::Figure;

use super::{Finish, Vehicle, turn_radius_by_load_m};

/// How far a vehicle may be from the column of its takeoff, and around the top of it until it is on
/// its first leg. What is judged, checked and raised as an alarm is the same region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TakeoffRegion {
    /// The wind may drive it off so far to any side as it climbs, metres.
    pub drift_m: f64,
    /// After the climb the wind carries it so far, metres.
    pub carried_m: f64,
    /// From the top it flies on where its nose points, which nobody knows: so far, metres,
    pub transition_m: f64,
    /// and turns from there: two turn radii, metres.
    pub turn_m: f64,
    /// It may be later than along its first leg by this, seconds.
    pub late_s: f64,
}

impl TakeoffRegion {
    /// How far it may be from the top of its takeoff until it is on its first leg, metres.
    #[must_use]
    pub fn reach_m(&self) -> f64 {
        self.drift_m + self.carried_m + self.transition_m + self.turn_m
    }

    /// How far a place is outside of the hull of the disc around the top and the next place, metres;
    /// 0 within. The place is `along_m` from the middle towards the next place and `aside_m` beside
    /// that line; the next place is `next_m` from the middle.
    #[must_use]
    pub fn outside_m(&self, (along_m, aside_m): (f64, f64), next_m: f64) -> f64 {
        // The hull is all discs between the two, which shrink evenly. From the one that is nearest the
        // place lies square to the tangent of the hull.
        let reach_m = self.reach_m();
        let narrowing = reach_m / next_m.max(f64::MIN_POSITIVE);
        let middle_m = if narrowing < 1.0 {
            let back_m = aside_m.abs() * narrowing / (1.0 - narrowing * narrowing).sqrt();
            (along_m - back_m).clamp(0.0, next_m)
        } else {
            0.0
        };
        let radius_m = reach_m - (narrowing * middle_m).min(reach_m);
        ((along_m - middle_m).hypot(aside_m) - radius_m).max(0.0)
    }
}

impl Vehicle {
    /// The region after a climb of a height, metres; none for a vehicle that keeps its column.
    #[must_use]
    pub fn takeoff_region(&self, climb_m: f64) -> Option<TakeoffRegion> {
        let behaviour = &self.facts().behaviour;
        let value = |figure: Figure| figure.value(self.autopilot_version);
        let transition_m = value(behaviour.transition_m);
        if transition_m <= 0.0 {
            return None;
        }
        let wind_mps = self.carried_by().map_or(0.0, |wind| wind.speed_mps);
        let climb_s = climb_m.max(0.0) / self.climb_mps;
        let turn_m = 2.0 * turn_radius_by_load_m(self.fastest_mps(), self.max_load_factor);
        Some(TakeoffRegion {
            drift_m: wind_mps * value(behaviour.drift_share) * climb_s,
            carried_m: wind_mps * value(behaviour.drift_s),
            transition_m,
            turn_m,
            // It may have come so far away from its first leg, and back against the wind.
            late_s: (transition_m + turn_m) / (self.speed_mps - wind_mps).max(1.0),
        })
    }
}

impl Vehicle {
    /// How far to any side the wind may drive a vehicle that descends to its landing, metres. It does
    /// so from behind: with it from ahead or across a QuadPlane keeps over its place. `course_rad` is
    /// the one it comes on; none: not known.
    #[must_use]
    pub fn landing_drift_m(&self, course_rad: Option<f64>) -> f64 {
        let figure = self.facts().behaviour.landing_drift_s;
        let Some(wind) = self.carried_by() else {
            return 0.0;
        };
        let is_ahead =
            course_rad.is_some_and(|course_rad| (course_rad - wind.from_rad).cos() >= 0.0);
        match is_ahead {
            true => 0.0,
            false => wind.speed_mps * figure.value(self.autopilot_version),
        }
    }
}

impl Vehicle {
    /// A warning where a vehicle may come to its landing with the wind from behind, and what to state.
    /// `course_rad` is the one it comes on; none: not known.
    #[must_use]
    pub fn landing_note(&self, course_rad: Option<f64>) -> Option<String> {
        let wind = self.carried_by()?;
        let drift_m = self.landing_drift_m(course_rad);
        (self.finish != Finish::Loiter && drift_m > 0.0).then(|| {
            format!(
                "{}: with the wind from behind it may touch down {drift_m:.0} m from its place; landing.heading_deg {:.0} has it \
                 come into the wind",
                self.id,
                wind.from_rad.to_degrees()
            )
        })
    }

    /// Why the wind that carries it is more than it was flown in, and what to do: what the verdict
    /// assumes of a wing holds as far as it was measured.
    #[must_use]
    pub fn too_much_wind(&self) -> Option<String> {
        let facts = self.facts();
        let most = facts.behaviour.max_wind_mps.of(self.autopilot_version)?;
        let wind = self.carried_by()?;
        (wind.speed_mps > most.value).then(|| {
            format!(
                "what the verdict assumes of {} is not known to hold in more than {most} of wind ({}): \
                 plan for less wind, and fly only then",
                facts.firmware, most.source
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::TakeoffRegion;

    proptest! {
        /// Against the nearest of many discs between the middle and the next place.
        #[test]
        fn a_place_is_as_far_outside_as_from_the_nearest_of_all_discs(
            reach_m in 1.0..400.0_f64, next_m in 0.0..2000.0_f64,
            along_m in -900.0..2500.0_f64, aside_m in -900.0..900.0_f64,
        ) {
            let region = TakeoffRegion {
                drift_m: 0.1 * reach_m,
                carried_m: 0.2 * reach_m,
                transition_m: 0.3 * reach_m,
                turn_m: 0.4 * reach_m,
                late_s: 0.0,
            };
            let discs = (0..=20_000).map(|step| {
                let share = f64::from(step) / 20_000.0;
                (along_m - share * next_m).hypot(aside_m) - (1.0 - share) * reach_m
            });
            let nearest_m = discs.fold(f64::INFINITY, f64::min).max(0.0);
            let found_m = region.outside_m((along_m, aside_m), next_m);
            prop_assert!((found_m - nearest_m).abs() < 0.2, "{found_m} {nearest_m}");
        }
    }
}
