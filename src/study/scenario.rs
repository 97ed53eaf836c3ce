//! Missions generated from a seed, which no planner was tuned on: ridges with narrow passes,
//! belts of threats with one gap, pockets that are dead ends.

use std::f64::consts::PI;
use std::fmt::Write;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::autopilot::{Airframe, Autopilot, facts};
use crate::geodesy::{EastNorth, LatLon, LocalFrame};
use crate::numeric::Seed;
use crate::numeric::as_f64;

/// The highest difficulty.
pub const MAX_DIFFICULTY: u8 = 10;

/// The middle of every generated area.
const ORIGIN: LatLon = LatLon {
    lat_deg: 46.5,
    lon_deg: 8.0,
};
/// Ground far from every hill, metres above the sea.
const BASE_AMSL_M: f64 = 300.0;
/// Gaussian hills this many radii apart along a ridge.
const HILL_SPACING: f64 = 0.8;
/// Height of such a ridge over that of one of its hills, sqrt(pi) / spacing.
const RIDGE_OVER_HILL: f64 = 2.2155;
/// Narrowest gap in a belt, metres: six times the turn radius at 15 m/s.
const MIN_GAP_M: f64 = 540.0;
/// Free control points: up to six gaps and passes, each with a turn before and behind it.
const CONTROL_POINTS: usize = 24;
/// Paths of scenarios up to this length fit into the items that a spec allows by itself.
const SHORT_M: f64 = 40_000.0;
/// Threats of a pocket.
const POCKET: usize = 6;

/// A threat or hill in the plane.
#[derive(Clone, Copy, Debug)]
struct Round {
    at: EastNorth,
    radius_m: f64,
    /// Of a hill, metres; 0 of a threat.
    height_m: f64,
}

/// An obstacle across the whole area.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Obstacle {
    Belt,
    Ridge,
}

/// A scenario being generated: start in the west, goal in the east, the middle at 0, 0.
struct Draft {
    rng: ChaCha8Rng,
    /// 0 for the easiest, 1 for the hardest.
    hardness: f64,
    length_m: f64,
    threats: Vec<Round>,
    hills: Vec<Round>,
    ends: Vec<(EastNorth, EastNorth)>,
}

/// The text of a mission spec of some difficulty, 1 to [`MAX_DIFFICULTY`]: 5 to 200 km
/// long, with 5 to 40 threats, one to three vehicles, and analytic ground so that it is
/// one file. The same numbers give the same text. No plan is known to exist.
#[must_use]
pub fn scenario(seed: u64, difficulty: u8) -> String {
    let difficulty = difficulty.clamp(1, MAX_DIFFICULTY);
    let mut rng = Seed(seed).stream("scenario", u64::from(difficulty));
    let hardness = f64::from(difficulty - 1) / f64::from(MAX_DIFFICULTY - 1);
    let size = (hardness + rng.random_range(-0.25..0.25)).clamp(0.0, 1.0);
    let mut draft = Draft {
        hardness,
        // 5 km times up to 40.
        length_m: 5000.0 * (size * 40.0_f64.ln()).exp(),
        rng,
        threats: Vec::new(),
        hills: Vec::new(),
        ends: Vec::new(),
    };
    draft.place_vehicles();
    draft.place_obstacles();
    draft.text(seed, difficulty)
}

impl Draft {
    fn at(&self, along: f64, across: f64) -> EastNorth {
        EastNorth {
            east_m: (along - 0.5) * self.length_m,
            north_m: across * self.length_m,
        }
    }

    fn place_vehicles(&mut self) {
        let count = self.rng.random_range(1..=3_u8);
        let lanes: Vec<f64> = (0..count)
            .map(|lane| (f64::from(lane) - 0.5 * f64::from(count - 1)) * 0.07)
            .collect();
        let shift = self.rng.random_range(0..lanes.len());
        for (lane, start) in lanes.iter().enumerate() {
            let goal = lanes[(lane + shift) % lanes.len()];
            let mut jitter = || self.rng.random_range(-0.015..0.015);
            let (from, to) = (jitter(), jitter());
            self.ends
                .push((self.at(0.0, start + from), self.at(1.0, goal + to)));
        }
    }

    fn place_obstacles(&mut self) {
        let jitter = self.rng.random_range(-0.1..0.1);
        let threats = whole(5.0 + 35.0 * (self.hardness + jitter).clamp(0.0, 1.0));
        let belts = whole(1.0 + 2.0 * self.hardness);
        let ridges = whole(1.0 + 2.0 * self.hardness);
        let mut obstacles = vec![Obstacle::Belt; belts];
        obstacles.extend(vec![Obstacle::Ridge; ridges]);
        for last in (1..obstacles.len()).rev() {
            obstacles.swap(last, self.rng.random_range(0..=last));
        }
        let pockets = usize::from(threats >= 15) + usize::from(threats >= 30);
        let loose = threats / 10;
        let in_belts = threats - pockets * POCKET - loose;
        let mut belt = 0;
        let count = obstacles.len();
        for (index, obstacle) in obstacles.into_iter().enumerate() {
            let along = 0.12 + 0.76 * (as_f64(index) + 0.5) / as_f64(count);
            match obstacle {
                Obstacle::Belt => {
                    belt += 1;
                    let mine = in_belts * belt / belts - in_belts * (belt - 1) / belts;
                    self.place_belt(along, mine);
                }
                Obstacle::Ridge => self.place_ridge(along),
            }
        }
        for _ in 0..pockets {
            self.place_pocket();
        }
        for _ in 0..loose {
            let (along, across) = (
                self.rng.random_range(0.1..0.9),
                self.rng.random_range(-0.35..0.35),
            );
            let radius_m = self.rng.random_range(0.01..0.03) * self.length_m;
            self.add_threat(self.at(along, across), radius_m);
        }
    }

    /// Discs side by side from south to north, with one gap.
    fn place_belt(&mut self, along: f64, discs: usize) {
        let half_m = self.rng.random_range(0.3..0.45) * self.length_m;
        let share = self.rng.random_range(0.02..0.04) * (1.5 - self.hardness);
        let gap_m = (share * self.length_m).max(MIN_GAP_M);
        let middle_m = self.rng.random_range(-0.8..0.8) * (half_m - gap_m);
        let (south_m, north_m) = (
            half_m + middle_m - 0.5 * gap_m,
            half_m - middle_m - 0.5 * gap_m,
        );
        let in_south = whole(as_f64(discs) * south_m / (south_m + north_m)).min(discs);
        for (side, width_m, count) in [(-1.0, south_m, in_south), (1.0, north_m, discs - in_south)]
        {
            let spacing_m = width_m / as_f64(count.max(1));
            // A little overlap, so that discs out of line leave no gap.
            let radius_m = 0.53 * spacing_m;
            for disc in 0..count {
                let away_m = 0.5 * gap_m + radius_m + as_f64(disc) * spacing_m;
                let mut at = self.at(along, 0.0);
                at.north_m = middle_m + side * away_m;
                at.east_m += self.rng.random_range(-0.1..0.1) * spacing_m;
                self.add_threat(at, radius_m);
            }
        }
    }

    /// Hills in a row across the whole area, higher than the ceiling except at one pass.
    fn place_ridge(&mut self, along: f64) {
        let radius_m = self.rng.random_range(0.035..0.06) * self.length_m;
        let height_m = self.ridge_m() / RIDGE_OVER_HILL;
        let pass_m = self.rng.random_range(-0.3..0.3) * self.length_m;
        let half_pass_m = (1.9 - 0.5 * self.hardness) * radius_m;
        let hills = whole(1.1 * self.length_m / (HILL_SPACING * radius_m));
        for hill in 0..=hills {
            let north_m = (as_f64(hill) / as_f64(hills) - 0.5) * 1.1 * self.length_m;
            let low = if (north_m - pass_m).abs() < half_pass_m {
                0.25
            } else {
                1.0
            };
            let mut at = self.at(along, 0.0);
            at.north_m = north_m;
            at.east_m += self.rng.random_range(-0.15..0.15) * radius_m;
            self.hills.push(Round {
                at,
                radius_m,
                height_m: low * height_m * self.rng.random_range(0.95..1.1),
            });
        }
    }

    /// Discs on an arc that is open to the west: a dead end.
    fn place_pocket(&mut self) {
        let along = self.rng.random_range(0.2..0.7);
        let across = self.rng.random_range(-0.2..0.2);
        let middle = self.at(along, across);
        let reach_m = 0.06 * self.length_m;
        let step_rad = 200.0_f64.to_radians() / as_f64(POCKET - 1);
        for disc in 0..POCKET {
            let angle = as_f64(disc) * step_rad - 100.0_f64.to_radians();
            let at = EastNorth {
                east_m: middle.east_m + reach_m * angle.cos(),
                north_m: middle.north_m + reach_m * angle.sin(),
            };
            self.add_threat(at, 1.05 * reach_m * (0.5 * step_rad).min(0.5 * PI).sin());
        }
    }

    /// A threat, smaller where it would come too near to a start or goal.
    fn add_threat(&mut self, at: EastNorth, radius_m: f64) {
        let free_m = self
            .ends
            .iter()
            .flat_map(|(start, goal)| [start.distance_m(at), goal.distance_m(at)])
            .fold(f64::INFINITY, f64::min)
            - 0.03 * self.length_m;
        if free_m > 50.0 {
            self.threats.push(Round {
                at,
                radius_m: radius_m.min(free_m),
                height_m: 0.0,
            });
        }
    }

    /// Height of the ridges over the plain, metres.
    fn ridge_m(&self) -> f64 {
        250.0 + 0.01125 * self.length_m
    }

    fn text(&self, seed: u64, difficulty: u8) -> String {
        let frame = LocalFrame::new(ORIGIN);
        let place = |at: EastNorth| {
            let place = frame.from_plan(at);
            format!("lat: {:.6}, lon: {:.6}", place.lat_deg, place.lon_deg)
        };
        let mut text = format!(
            "# Written by `sortie study scenario --seed {seed} --difficulty {difficulty}`:\n\
             # {:.0} km, {} threats, {} hills. Not known to be flyable.\n\
             sortie: 1\nname: scenario-{seed}-{difficulty}\n\
             origin: {{lat: {}, lon: {}}}\n\
             area:\n  south_west: {{{}}}\n  north_east: {{{}}}\n  min_agl_m: 60\n  max_amsl_m: {:.0}\n\
             terrain:\n  analytic:\n    base_amsl_m: {BASE_AMSL_M}\n    hills:\n",
            self.length_m / 1000.0,
            self.threats.len(),
            self.hills.len(),
            ORIGIN.lat_deg,
            ORIGIN.lon_deg,
            place(self.at(-0.12, -0.5)),
            place(self.at(1.12, 0.5)),
            BASE_AMSL_M + 0.75 * self.ridge_m(),
        );
        for hill in &self.hills {
            let _ = writeln!(
                text,
                "      - {{{}, height_m: {:.1}, radius_m: {:.1}}}",
                place(hill.at),
                hill.height_m,
                hill.radius_m
            );
        }
        text.push_str("threats:\n");
        for (index, threat) in self.threats.iter().enumerate() {
            let _ = writeln!(
                text,
                "  - {{id: threat-{}, kind: radar, {}, radius_m: {:.1}}}",
                index + 1,
                place(threat.at),
                threat.radius_m
            );
        }
        let _ = writeln!(text, "planner: {{control_points: {CONTROL_POINTS}}}");
        if self.length_m > SHORT_M {
            let most = facts(Autopilot::ArduPilot, Airframe::Copter).capacity.items;
            let _ = writeln!(text, "mission: {{max_items: {most}}}");
        }
        text.push_str(&self.vehicles(place));
        text
    }

    fn vehicles(&self, place: impl Fn(EastNorth) -> String) -> String {
        let speed_mps = if self.length_m > 20_000.0 { 25 } else { 15 };
        let mut text = "vehicles:\n".to_owned();
        for (index, (start, goal)) in self.ends.iter().enumerate() {
            let sysid = index + 1;
            let _ = writeln!(
                text,
                "  - id: uav{sysid}\n    sysid: {sysid}\n    autopilot: ardupilot\n    link: sim\n    \
                 start: {{{}, agl_m: 80}}\n    goal: {{{}, agl_m: 80}}\n    finish: land\n    \
                 speed_mps: {speed_mps}\n    max_climb_deg: 15\n    max_descent_deg: 12\n    \
                 climb_mps: 5\n    descent_mps: 4",
                place(*start),
                place(*goal)
            );
        }
        text
    }
}

/// The nearest whole number.
fn whole(value: f64) -> usize {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "small counts, not negative"
    )]
    let whole = value.round().max(0.0) as usize;
    whole
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{MAX_DIFFICULTY, scenario};
    use crate::spec::SpecFile;

    #[test]
    fn a_long_scenario_may_have_as_many_items_as_the_autopilot_keeps_and_no_other_line_changes() {
        for (difficulty, allowed) in [(1, 200), (MAX_DIFFICULTY, 649)] {
            let text = scenario(1, difficulty);
            let file = SpecFile::parse(Path::new("scenario.yaml"), text.clone()).expect("good");
            assert_eq!(file.spec.mission.max_items, allowed);
            let lines = text.lines().filter(|line| line.starts_with("mission:"));
            assert_eq!(lines.count(), usize::from(difficulty > 1), "{text}");
        }
    }

    #[test]
    fn the_same_numbers_give_the_same_scenario_and_others_another() {
        assert_eq!(scenario(7, 5), scenario(7, 5));
        assert_ne!(scenario(7, 5), scenario(8, 5));
        assert_ne!(scenario(7, 5), scenario(7, 6));
    }
}
