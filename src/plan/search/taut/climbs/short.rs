//! Where a path is too short to climb or descend along it.

use crate::plan::altitude::Demand;

/// Missing altitudes below this are none, metres.
const TOLERANCE_M: f64 = 0.02;

/// Shorter steps are of a rest, metres.
const REST_M: f64 = 0.01;

/// A part of a path that is too short.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::plan::search) struct Short {
    /// Where it begins and ends, metres along the path to its end: what lies behind it stays as it is.
    pub from_m: f64,
    pub to_m: f64,
    /// How much longer it has to be, metres.
    pub by_m: f64,
}

/// Altitudes between which flights are at a sample, and where along the path they were last held down or up.
struct Reach {
    low_m: f64,
    high_m: f64,
    held_down_m: f64,
    held_up_m: f64,
}

/// The first place at which no flight along a path is over the floor and under the roof, with all that is missing behind
/// it as long as nothing holds flights; none where a roof is below the floor. `demand` was filled, `lengths_m` are those
/// of the steps between samples.
pub(super) fn short(
    demand: &Demand,
    (roofs_m, lengths_m): (&[f64], &[f64]),
    (from_m, to_m): (f64, f64),
) -> Option<Option<Short>> {
    let last = lengths_m.len();
    let whole_m: f64 = lengths_m.iter().sum();
    let mut reach = Reach {
        low_m: from_m,
        high_m: from_m,
        held_down_m: 0.0,
        held_up_m: 0.0,
    };
    let mut gone_m = 0.0;
    let mut first: Option<(bool, Short)> = None;
    // Metres along the path of one down and up, where it last went on.
    let mut takes_m = [0.0; 2];
    for (step, &length_m) in lengths_m.iter().enumerate() {
        gone_m += length_m;
        let steps_m = [demand.down_m[step], demand.up_m[step]];
        if length_m > REST_M {
            takes_m = steps_m.map(|step_m| length_m / step_m.max(1e-9));
        }
        // The raw floor, before slopes raised it.
        let (floor_m, roof_m) = match step + 1 == last {
            true => (to_m, to_m),
            false => (demand.ground_m[step + 1], roofs_m[step + 1]),
        };
        if roof_m < floor_m {
            return None;
        }
        if let Some((is_climb, missing_m)) = reach.onward(steps_m, (floor_m, roof_m)) {
            let by_m = missing_m * takes_m[usize::from(is_climb)];
            match &mut first {
                Some((of, first)) if *of == is_climb => first.by_m += by_m,
                Some(_) => break,
                None => {
                    let short = Short {
                        from_m: whole_m - reach.since_m(is_climb),
                        to_m: whole_m - gone_m,
                        by_m,
                    };
                    first = Some((is_climb, short));
                }
            }
        }
        let held = reach.hold((floor_m, roof_m), gone_m);
        if (first.as_ref()).is_some_and(|(is_climb, _)| held[usize::from(*is_climb)]) {
            break;
        }
    }
    Some(first.map(|(_, short)| short))
}

impl Reach {
    /// Flies a step on, at most so far down and up. Where no flight is over the floor and under the roof there: whether
    /// they do not climb enough, and the metres that are missing, from which on it goes on as if they were there.
    fn onward(
        &mut self,
        [down_m, up_m]: [f64; 2],
        (floor_m, roof_m): (f64, f64),
    ) -> Option<(bool, f64)> {
        self.high_m += up_m;
        self.low_m -= down_m;
        let (climb_m, descent_m) = (floor_m - self.high_m, self.low_m - roof_m);
        if climb_m > TOLERANCE_M {
            self.high_m = floor_m;
            return Some((true, climb_m));
        }
        (descent_m > TOLERANCE_M).then(|| {
            self.low_m = roof_m;
            (false, descent_m)
        })
    }

    /// From where on flights climb, or descend, as steeply as they may.
    fn since_m(&self, is_climb: bool) -> f64 {
        match is_climb {
            true => self.held_down_m,
            false => self.held_up_m,
        }
    }

    /// Holds flights over a floor and under a roof; whether that held the lowest up, and the highest down.
    fn hold(&mut self, (floor_m, roof_m): (f64, f64), gone_m: f64) -> [bool; 2] {
        let held = [floor_m > self.low_m, roof_m < self.high_m];
        if held[1] {
            (self.high_m, self.held_down_m) = (roof_m, gone_m);
        }
        if held[0] {
            (self.low_m, self.held_up_m) = (floor_m, gone_m);
        }
        held
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 100 steps of 10 m over a floor at 0 m, with a wall and a lid; 1 m up and 0.5 m down each step at most.
    fn short_of(wall: (usize, f64), lid: (usize, f64)) -> Option<Option<Short>> {
        let mut demand = Demand {
            ground_m: vec![0.0; 101],
            up_m: vec![1.0; 100],
            down_m: vec![0.5; 100],
            ..Demand::default()
        };
        let mut roofs_m = vec![200.0; 101];
        demand.ground_m[wall.0] = wall.1;
        roofs_m[lid.0] = lid.1;
        short(&demand, (&roofs_m, &[10.0; 100]), (5.0, 5.0))
    }

    #[test]
    fn a_path_is_too_short_by_what_the_missing_metres_take_at_the_steepest_slope() {
        // 25 m at the 20th step, where 5 + 20 are reached; at the end, 80 steps later, all is well.
        assert_eq!(short_of((20, 25.0), (1, 200.0)), Some(None));
        let climb = Short {
            from_m: 1000.0,
            to_m: 800.0,
            by_m: 100.0,
        };
        assert_eq!(short_of((20, 35.0), (1, 200.0)), Some(Some(climb)));
        // From the wall on it descends to 12.5 m at the lid.
        let descent = Short {
            from_m: 800.0,
            to_m: 550.0,
            by_m: 50.0,
        };
        assert_eq!(short_of((20, 25.0), (45, 10.0)), Some(Some(descent)));
        assert_eq!(short_of((20, 25.0), (20, 24.0)), None);
    }
}
